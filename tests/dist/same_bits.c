/* Prints a hash of each result of luxfer, to compare platforms: a room, its lux, a whole lighting transfer with all
 * images between photo and rendering, the lit scene and its luminaires, and a stylisation.
 *
 *   same_bits FOLDER    writes the scene and the luminaires into FOLDER, which must exist, to hash them
 *
 * A line is `NAME HASH`: FNV-1a over the bytes of the pixels, as 32-bit floats, or of the file. The sizes are small,
 * so that an emulated processor is done in minutes.
 */
#include "../../examples_c/common.h"
#include "hash.h"

#include <string.h>

enum { LARGEST_FILE = 1 << 26 };

/* Hashes all pixels of an image, one channel after the other, and releases it. */
static void hash_image(const char *name, luxfer_image *image) {
    luxfer_image_view view;
    uint32_t channels, c;
    size_t plane;
    char *pixels;
    check(luxfer_image_view_init(&view, sizeof view), name);
    check(luxfer_image_get_size(image, &view.width, &view.height, &channels), name);
    plane = (size_t)view.width * view.height * sizeof(float);
    pixels = malloc(plane * channels);
    if (!pixels) exit(1);
    view.channels = 1;
    view.byte_size = plane;
    for (c = 0; c < channels; c++) {
        view.data = pixels + c * plane;
        check(luxfer_image_read(image, c, &view), name);
    }
    print_hash(name, hash_more(hash_of_nothing, pixels, plane * channels));
    free(pixels);
    luxfer_release(image);
}

static void hash_file(const char *name, const char *path) {
    FILE *file = fopen(path, "rb");
    char *bytes = malloc(LARGEST_FILE);
    size_t size;
    if (!file || !bytes || (size = fread(bytes, 1, LARGEST_FILE, file)) == 0) {
        fprintf(stderr, "cannot read %s\n", path);
        exit(1);
    }
    fclose(file);
    print_hash(name, hash_more(hash_of_nothing, bytes, size));
    free(bytes);
}

/* A room with every kind of material, and the light on its floor. */
static void hash_rendering(void) {
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    luxfer_illuminance *illuminance = NULL;
    luxfer_illuminance_grid grid;
    luxfer_illuminance_params lux;
    luxfer_render_params params;
    luxfer_image *image = NULL;
    luxfer_job *job = NULL;
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_EXEMPLAR_ROOM, &scene), "room");
    check(luxfer_render_params_init(&params, sizeof params), "room");
    params.width = 96, params.height = 64, params.samples = 8;
    check(luxfer_render_create(context, &render), "room");
    check(luxfer_render_set_scene(render, scene), "room");
    check(luxfer_render_start(render, &params, &job), "room");
    wait_and_release(job, "room");
    check(luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &image), "room");
    hash_image("room", image);

    check(luxfer_illuminance_create(context, &illuminance), "lux");
    check(luxfer_illuminance_set_scene(illuminance, scene), "lux");
    check(luxfer_illuminance_grid_init(&grid, sizeof grid), "lux");
    grid.origin[0] = 0.5f, grid.origin[1] = 1.5f, grid.origin[2] = 0.5f;
    grid.across[0] = 4.4f, grid.down[2] = 8;
    check(luxfer_illuminance_params_init(&lux, sizeof lux), "lux");
    lux.columns = 11, lux.rows = 20, lux.samples = 16;
    check(luxfer_illuminance_start_grid(illuminance, &grid, &lux, &job), "lux");
    wait_and_release(job, "lux");
    check(luxfer_illuminance_get_image(illuminance, LUXFER_ILLUMINANCE_LUX, &image), "lux");
    hash_image("lux", image);
    luxfer_release(illuminance);
    luxfer_release(render);
    luxfer_release(scene);
}

/* Takes a small photo of the generated office, and gives it to the transfer with its strokes. */
static void set_photo(luxfer_transfer *transfer) {
    luxfer_demo_photo_params params;
    luxfer_demo_photo *demo = NULL;
    luxfer_strokes *strokes = NULL;
    luxfer_image *photo = NULL, *drawing = NULL;
    luxfer_job *job = NULL;
    uint32_t width, height;
    check(luxfer_demo_photo_params_init(&params, sizeof params), "photo");
    params.width = 300, params.height = 200, params.samples = 4;
    check(luxfer_demo_photo_create(context, &demo), "photo");
    check(luxfer_demo_photo_start(demo, &params, &job), "photo");
    wait_and_release(job, "photo");
    check(luxfer_demo_photo_get_image(demo, LUXFER_DEMO_PHOTO_PICTURE, &photo), "photo");
    check(luxfer_demo_photo_get_image(demo, LUXFER_DEMO_PHOTO_STROKES, &drawing), "photo");
    check(luxfer_image_get_size(photo, &width, &height, NULL), "photo");
    check(luxfer_strokes_create(context, width, height, &strokes), "photo");
    check(luxfer_strokes_add_image(strokes, drawing), "photo");
    check(luxfer_transfer_set_photo(transfer, photo), "photo");
    check(luxfer_transfer_set_strokes(transfer, strokes), "photo");
    hash_image("photo", photo);
    luxfer_release(drawing);
    luxfer_release(strokes);
    luxfer_release(demo);
}

static void hash_transfer(const char *folder) {
    static const struct { const char *name; luxfer_transfer_image which; } images[] = {
        {"features", LUXFER_TRANSFER_FEATURES},
        {"plane", LUXFER_TRANSFER_PLANE_CONFIDENCE},
        {"lights", LUXFER_TRANSFER_LIGHTS_CONFIDENCE},
        {"unwarped", LUXFER_TRANSFER_UNWARPED},
        {"emission", LUXFER_TRANSFER_EMISSION},
        {"render", LUXFER_TRANSFER_RENDER},
    };
    luxfer_transfer *transfer = NULL;
    luxfer_transfer_params params;
    luxfer_render_params render;
    luxfer_scene *scene = NULL, *lit = NULL;
    luxfer_image *image = NULL;
    luxfer_job *job = NULL;
    char path[4096];
    size_t k;
    check(luxfer_transfer_create(context, &transfer), "transfer");
    set_photo(transfer);
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_TARGET_ROOM, &scene), "scene");
    check(luxfer_transfer_set_scene(transfer, scene, "Ceiling"), "scene");
    check(luxfer_transfer_params_init(&params, sizeof params), "transfer");
    check(luxfer_render_params_init(&render, sizeof render), "transfer");
    render.width = 96, render.height = 54, render.samples = 4;
    params.render = &render;
    check(luxfer_transfer_start(transfer, LUXFER_STAGE_VIEW, LUXFER_STAGE_RENDER, &params, &job), "transfer");
    wait_and_release(job, "transfer");
    for (k = 0; k < sizeof images / sizeof *images; k++) {
        check(luxfer_transfer_get_image(transfer, images[k].which, &image), images[k].name);
        hash_image(images[k].name, image);
    }
    check(luxfer_transfer_get_scene(transfer, LUXFER_SCENE_LIT, &lit), "lit.glb");
    if (snprintf(path, sizeof path, "%s/lit.glb", folder) >= (int)sizeof path) exit(2);
    check(luxfer_scene_export(lit, path), "lit.glb");
    hash_file("lit.glb", path);
    if (snprintf(path, sizeof path, "%s/luminaires.csv", folder) >= (int)sizeof path) exit(2);
    check(luxfer_transfer_save_fixtures(transfer, path), "luminaires.csv");
    hash_file("luminaires.csv", path);
    luxfer_release(lit);
    luxfer_release(scene);
    luxfer_release(transfer);
}

static luxfer_guides *guides_of(luxfer_demo which) {
    luxfer_guides_params params;
    luxfer_guides *guides = NULL;
    luxfer_scene *scene = NULL;
    luxfer_job *job = NULL;
    check(luxfer_guides_params_init(&params, sizeof params), "guides");
    params.width = 120, params.height = 90, params.samples = 4;
    check(luxfer_demo_create_scene(context, which, &scene), "guides");
    check(luxfer_guides_create(context, &guides), "guides");
    check(luxfer_guides_set_scene(guides, scene), "guides");
    check(luxfer_guides_start(guides, &params, &job), "guides");
    wait_and_release(job, "guides");
    luxfer_release(scene);
    return guides;
}

static void hash_stylisation(void) {
    luxfer_guides *source, *target;
    luxfer_stylize *stylize = NULL;
    luxfer_image *image = NULL;
    luxfer_job *job = NULL;
    if (luxfer_stylize_create(context, &stylize) == LUXFER_UNSUPPORTED) return;
    source = guides_of(LUXFER_DEMO_SPHERE_ON_TABLE);
    target = guides_of(LUXFER_DEMO_STILL_LIFE);
    check(luxfer_stylize_add_guides(stylize, source, target, LUXFER_GUIDES_WITH_EDGES, 2.5f), "stylised");
    check(luxfer_demo_create_artwork(source, LUXFER_ARTWORK_PEN, &image), "artwork");
    check(luxfer_stylize_set_artwork(stylize, image), "artwork");
    hash_image("artwork", image);
    check(luxfer_stylize_start(stylize, NULL, &job), "stylised");
    wait_and_release(job, "stylised");
    check(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_PICTURE, &image), "stylised");
    hash_image("stylised", image);
    luxfer_release(stylize);
    luxfer_release(target);
    luxfer_release(source);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: same_bits FOLDER\n");
        return 2;
    }
    check(luxfer_context_create(NULL, &context), "context");
    hash_rendering();
    hash_transfer(argv[1]);
    hash_stylisation();
    luxfer_release(context);
    return 0;
}
