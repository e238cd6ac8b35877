/* A library without its optional parts (`make light`): each of them is refused with LUXFER_UNSUPPORTED and a message
 * that names the Cargo feature, and the rest works.
 *
 *   light    writes into the current folder
 */
#include "../../examples_c/common.h"

#include <string.h>

static int failures;

/* A call must fail because its part of the library is missing. */
static void expect_left_out(luxfer_status status, const char *feature) {
    char message[1024] = "", end[64];
    luxfer_context_get_last_error(context, message, sizeof message, NULL);
    snprintf(end, sizeof end, "Cargo feature %s", feature);
    if (status == LUXFER_UNSUPPORTED && strstr(message, end)) return;
    fprintf(stderr, "failed: %s: %s (%s)\n", feature, message, luxfer_status_get_name(status));
    failures++;
}

static void load(const char *bytes, size_t size, const char *feature) {
    luxfer_image *image = NULL;
    expect_left_out(luxfer_image_load_memory(context, bytes, size, LUXFER_COLOUR_SRGB, &image), feature);
}

/* A triangle whose vertices are in a compressed stream. */
static void load_compressed(void) {
    static const char file[] =
        "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"nodes\":[{\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"
        "\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}]}],"
        "\"accessors\":[{\"count\":3,\"componentType\":5126,\"type\":\"VEC3\"},{\"count\":3,\"componentType\":5125,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":6}],\"buffers\":[{\"uri\":\"data:;base64,RFJBQ08C\",\"byteLength\":6}]}";
    luxfer_scene *scene = NULL;
    expect_left_out(luxfer_scene_load_memory(context, file, sizeof file - 1, NULL, NULL, &scene), "mesh-compression");
}

static void refuse_luminaires(void) {
    static const char file[] = "<?xml version=\"1.0\"?><IESTM33-22/>";
    luxfer_distribution *lamp = NULL;
    expect_left_out(luxfer_distribution_load_memory(context, file, sizeof file - 1, LUXFER_DISTRIBUTION_TM33, &lamp), "xml-luminaires");
    expect_left_out(luxfer_distribution_load_memory(context, "PK\3\4", 4, LUXFER_DISTRIBUTION_GLDF, &lamp), "xml-luminaires");
}

static void refuse_stages(void) {
    luxfer_stylize *stylize = NULL;
    luxfer_features *features = NULL;
    expect_left_out(luxfer_stylize_create(context, &stylize), "stylize");
    check(luxfer_features_create(context, &features), "features");
    expect_left_out(luxfer_features_set_network(features, "no.onnx", LUXFER_NORMALISATION_BY_SIZE), "onnx");
    luxfer_release(features);
}

/* A rendering, as a PNG that is read again, but not as an OpenEXR file. */
static void render(void) {
    luxfer_scene *scene = NULL;
    luxfer_render *stage = NULL;
    luxfer_render_params params;
    luxfer_image *image = NULL, *again = NULL;
    luxfer_job *job = NULL;
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_EXEMPLAR_ROOM, &scene), "render");
    check(luxfer_render_params_init(&params, sizeof params), "render");
    params.width = 48, params.height = 32, params.samples = 4;
    check(luxfer_render_create(context, &stage), "render");
    check(luxfer_render_set_scene(stage, scene), "render");
    check(luxfer_render_start(stage, &params, &job), "render");
    wait_and_release(job, "render");
    check(luxfer_render_get_image(stage, LUXFER_RENDER_BEAUTY, &image), "render");
    check(luxfer_image_save(image, "light.png", 0.001f), "light.png");
    check(luxfer_image_load(context, "light.png", LUXFER_COLOUR_SRGB, &again), "light.png");
    expect_left_out(luxfer_image_save(image, "light.exr", 1), "exr");
    luxfer_release(again);
    luxfer_release(image);
    luxfer_release(stage);
    luxfer_release(scene);
}

int main(void) {
    check(luxfer_context_create(NULL, &context), "context");
    load("\x76\x2f\x31\x01 and the rest", 17, "exr");
    load("RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\0\0\0\x10\x07\x10\x11\x11\x88\x88\xfe\x07", 33, "webp");
    load_compressed();
    refuse_luminaires();
    refuse_stages();
    render();
    luxfer_release(context);
    if (!failures) puts("light: what was left out says so, and the rest works");
    return failures > 0;
}
