/* Loads the seed files of the fuzz targets as the targets do, and what can be loaded it uses. A call may refuse a file,
 * but not with LUXFER_INTERNAL, and a handle is there exactly if the call has succeeded.
 *
 *   seeds FOLDER    FOLDER/TARGET/seed-000 and so on, as fuzz/seeds.py writes them
 *
 * A line is `seeds.TARGET HASH`: the hash of the statuses of all calls and of the pixels, scenes and intensities that
 * come of the files, to compare platforms.
 */
#include "../../examples_c/common.h"
#include "hash.h"

#include <string.h>

enum { LARGEST_FILE = 1 << 22, LARGEST_PATH = 4096, COLUMNS = 9, ROWS = 5 };

static hash_value hash;
static char path[LARGEST_PATH];

/* Adds a status to the hash; ends the program if no call may return it. Returns whether the call has succeeded. */
static int add_status(luxfer_status status) {
    if (status < LUXFER_OK || status > LUXFER_UNREACHABLE || status == LUXFER_INTERNAL || status == LUXFER_UNKNOWN) {
        fprintf(stderr, "%s: %s\n", path, luxfer_status_get_name(status));
        exit(1);
    }
    hash = hash_more(hash, &status, sizeof status);
    return status == LUXFER_OK;
}

static int is_made(luxfer_status status, const void *handle) {
    int succeeded = add_status(status);
    if (succeeded != (handle != NULL)) {
        fprintf(stderr, "%s: the handle is %p, although the status is %d\n", path, handle, (int)status);
        exit(1);
    }
    return succeeded;
}

static void add_image(luxfer_image *image) {
    luxfer_image_view view;
    uint32_t channels, c;
    check(luxfer_image_view_init(&view, sizeof view), path);
    check(luxfer_image_get_size(image, &view.width, &view.height, &channels), path);
    view.channels = 1;
    view.byte_size = (size_t)view.width * view.height * sizeof(float);
    view.data = malloc(view.byte_size);
    if (!view.data) exit(1);
    for (c = 0; c < channels; c++) {
        check(luxfer_image_read(image, c, &view), path);
        hash = hash_more(hash, view.data, view.byte_size);
    }
    free(view.data);
    luxfer_release(image);
}

static void load_image(const void *bytes, size_t size) {
    luxfer_image *image = NULL;
    luxfer_status status = luxfer_image_load_memory(context, bytes, size, LUXFER_COLOUR_SRGB, &image);
    if (is_made(status, image)) add_image(image);
}

static int add_bytes(void *user, const void *bytes, size_t size) {
    (void)user;
    hash = hash_more(hash, bytes, size);
    return 0;
}

static void load_scene(const void *bytes, size_t size) {
    const luxfer_ray ray = {{0.01f, 0.5f, 0.02f}, {0, -1, 0.1f}, 1e9f};
    luxfer_scene *scene = NULL;
    luxfer_hit hit;
    luxfer_status status = luxfer_scene_load_memory(context, bytes, size, NULL, NULL, &scene);
    if (!is_made(status, scene)) return;
    if (add_status(luxfer_scene_intersect(scene, &ray, 1, 0, &hit, 0))) hash = hash_more(hash, &hit.t, sizeof hit.t);
    add_status(luxfer_scene_export_memory(scene, add_bytes, NULL));
    luxfer_release(scene);
}

static void load_distribution(const void *bytes, size_t size, luxfer_distribution_format format) {
    luxfer_distribution *lamp = NULL;
    double intensity = 0;
    luxfer_status status = luxfer_distribution_load_memory(context, bytes, size, format, &lamp);
    if (!is_made(status, lamp)) return;
    add_status(luxfer_distribution_get_intensity(lamp, 0.3, 0.7, &intensity));
    hash = hash_more(hash, &intensity, sizeof intensity);
    luxfer_release(lamp);
}

static void load_ies(const void *bytes, size_t size) { load_distribution(bytes, size, LUXFER_DISTRIBUTION_IES); }
static void load_ldt(const void *bytes, size_t size) { load_distribution(bytes, size, LUXFER_DISTRIBUTION_LDT); }
static void load_tm33(const void *bytes, size_t size) { load_distribution(bytes, size, LUXFER_DISTRIBUTION_TM33); }
static void load_gldf(const void *bytes, size_t size) { load_distribution(bytes, size, LUXFER_DISTRIBUTION_GLDF); }

/* Waits for a job that a call should have started; its outcome may be any error. */
static int has_ended_well(luxfer_status started, luxfer_job *job) {
    luxfer_status outcome;
    if (!is_made(started, job)) return 0;
    check(luxfer_job_wait(job, -1, NULL, NULL, &outcome), path);
    luxfer_release(job);
    return add_status(outcome);
}

/* A network, which runs on a small photo. */
static void load_network(const void *bytes, size_t size) {
    enum { SIDE = 64, NUMBERS = SIDE * SIDE * 3 };
    luxfer_features *features = NULL;
    luxfer_image *photo = NULL, *depth = NULL;
    luxfer_image_view view;
    luxfer_job *job = NULL;
    luxfer_status status;
    float pixels[NUMBERS];
    size_t k;
    (void)bytes, (void)size;
    check(luxfer_features_create(context, &features), path);
    if (add_status(luxfer_features_set_network(features, path, LUXFER_NORMALISATION_BY_SIZE))) {
        for (k = 0; k < NUMBERS; k++) pixels[k] = (float)(k % 7) / 7;
        check(luxfer_image_view_init(&view, sizeof view), path);
        view.width = view.height = SIDE, view.byte_size = sizeof pixels, view.data = pixels;
        check(luxfer_image_create(context, &view, &photo), path);
        check(luxfer_features_set_photo(features, photo), path);
        luxfer_release(photo);
        status = luxfer_features_start(features, NULL, &job);
        if (has_ended_well(status, job)) {
            status = luxfer_features_get_image(features, LUXFER_FEATURES_NETWORK_DEPTH, &depth);
            if (is_made(status, depth)) add_image(depth);
        }
    }
    luxfer_release(features);
}

/* A small rendering of the scene of fuzz/seeds.py: with a light path expression, or merged from a file. */
static void render_small(const char *expression) {
    luxfer_render_params params;
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    luxfer_image *image = NULL;
    luxfer_job *job = NULL;
    luxfer_status status;
    check(luxfer_render_params_init(&params, sizeof params), path);
    params.width = COLUMNS, params.height = ROWS, params.samples = 4;
    check(luxfer_render_create(context, &render), path);
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_SPHERE_ON_TABLE, &scene), path);
    check(luxfer_render_set_scene(render, scene), path);
    status = expression ? luxfer_render_add_expression(render, "layer", expression) : luxfer_render_add_part(render, path);
    if (add_status(status)) {
        status = expression ? luxfer_render_start(render, &params, &job) : luxfer_render_start_merge(render, &params, &job);
        if (has_ended_well(status, job)) {
            check(luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &image), path);
            add_image(image);
        }
    }
    luxfer_release(scene);
    luxfer_release(render);
}

static void load_part(const void *bytes, size_t size) {
    (void)bytes, (void)size;
    render_small(NULL);
}

/* The bytes of a file are followed by a zero. */
static void load_expression(const void *bytes, size_t size) {
    (void)size;
    render_small(bytes);
}

static void load_strokes(const void *bytes, size_t size) {
    luxfer_strokes *strokes = NULL;
    (void)size;
    check(luxfer_strokes_create(context, 48, 32, &strokes), path);
    add_status(luxfer_strokes_add_text(strokes, bytes));
    luxfer_release(strokes);
}

/* Loads all seed files of a target, and returns their number. */
static int load_all(const char *folder, const char *target, void (*load)(const void *, size_t), char *bytes) {
    char name[64];
    int number;
    for (number = 0;; number++) {
        FILE *file;
        size_t size;
        if (snprintf(path, sizeof path, "%s/%s/seed-%03d", folder, target, number) >= (int)sizeof path) exit(2);
        if (!(file = fopen(path, "rb"))) break;
        size = fread(bytes, 1, LARGEST_FILE - 1, file);
        bytes[size] = 0;
        fclose(file);
        load(bytes, size);
    }
    if (number == 0) {
        fprintf(stderr, "there is no %s\n", path);
        exit(1);
    }
    snprintf(name, sizeof name, "seeds.%s", target);
    print_hash(name, hash);
    hash = hash_of_nothing;
    return number;
}

int main(int argc, char **argv) {
    static const struct { const char *target; void (*load)(const void *, size_t); } targets[] = {
        {"image", load_image}, {"exr", load_image},    {"gltf", load_scene},     {"ies", load_ies},         {"ldt", load_ldt}, {"tm33", load_tm33},
        {"gldf", load_gldf},   {"onnx", load_network}, {"lpe", load_expression}, {"strokes", load_strokes}, {"part", load_part},
    };
    char *bytes = malloc(LARGEST_FILE);
    size_t k;
    int count = 0;
    if (argc != 2 || !bytes) {
        fprintf(stderr, "usage: seeds FOLDER\n");
        return 2;
    }
    check(luxfer_context_create(NULL, &context), "context");
    hash = hash_of_nothing;
    for (k = 0; k < sizeof targets / sizeof *targets; k++) count += load_all(argv[1], targets[k].target, targets[k].load, bytes);
    printf("%d files were loaded\n", count);
    luxfer_release(context);
    free(bytes);
    return 0;
}
