/* Uses the depth map of a depth camera or a network instead of the library's guess.
 *
 *   rgbd_input [PHOTO DEPTH]
 *
 * Without arguments it renders a photo of the generated office and its depth. DEPTH has one channel, in any unit;
 * values that are not positive are holes. Writes rgbd_input.png: the photo and its depth; the normals without and with
 * the depth.
 */
#include "common.h"
#include "panels.h"

enum { WIDTH = 300, HEIGHT = 200 };

/* Measures the depth of each pixel along the viewing axis, in metres, as a layer of a rendering with the photo's
 * camera. */
static luxfer_image *measure_depth(void) {
    luxfer_scene *office = NULL;
    luxfer_render *render = NULL;
    luxfer_render_params params;
    luxfer_image *depth = NULL;
    luxfer_job *job = NULL;
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_EXEMPLAR_ROOM, &office), "depth");
    check(luxfer_render_create(context, &render), "depth");
    check(luxfer_render_set_scene(render, office), "depth");
    check(luxfer_render_set_aovs(render, LUXFER_AOV_DEPTH), "depth");
    check(luxfer_render_params_init(&params, sizeof params), "depth");
    params.width = WIDTH;
    params.height = HEIGHT;
    params.samples = 2;
    check(luxfer_render_start(render, &params, &job), "depth");
    wait_and_release(job, "measuring the depth");
    check(luxfer_render_get_layer(render, "Depth", &depth), "depth");
    luxfer_release(render);
    luxfer_release(office);
    return depth;
}

/* Shows the normals, channels 7 to 9 of the features: maps their range [-1, 1] to [0, 1]. */
static void show_normals(luxfer_features *features, const char *title, sheet *s, int column) {
    luxfer_features_report report;
    luxfer_image *channels = NULL, *shown = NULL;
    luxfer_image_view view;
    luxfer_job *job = NULL;
    float *pixels;
    size_t k;
    check(luxfer_features_start(features, NULL, &job), title);
    wait_and_release(job, title);
    check(luxfer_features_get_report(features, &report, sizeof report), title);
    printf("%-14s trust in the depth %.2f\n", title, report.depth_confidence);
    check(luxfer_features_get_image(features, LUXFER_FEATURES_CHANNELS, &channels), title);
    check(luxfer_image_view_init(&view, sizeof view), title);
    check(luxfer_image_get_size(channels, &view.width, &view.height, NULL), title);
    view.byte_size = (size_t)view.width * view.height * 3 * sizeof *pixels;
    view.data = pixels = malloc(view.byte_size);
    if (!pixels) exit(1);
    check(luxfer_image_read(channels, 7, &view), title);
    for (k = 0; k < view.byte_size / sizeof *pixels; k++) pixels[k] = 0.5f + 0.5f * pixels[k];
    check(luxfer_image_create(context, &view, &shown), title);
    panels_add(s, column, 1, shown, 1);
    luxfer_release(shown);
    luxfer_release(channels);
    free(pixels);
}

int main(int argc, char **argv) {
    luxfer_features *features = NULL;
    luxfer_image *photo = NULL, *depth = NULL;
    sheet s = panels_begin(2, 2, WIDTH, HEIGHT);
    check(luxfer_context_create(NULL, &context), "context");
    if (argc == 3) {
        check(luxfer_image_load(context, argv[1], LUXFER_COLOUR_SRGB, &photo), argv[1]);
        check(luxfer_image_load(context, argv[2], LUXFER_COLOUR_LINEAR, &depth), argv[2]); /* Data, not colour. */
    } else {
        photo = take_photo(WIDTH, HEIGHT, 4);
        depth = measure_depth();
    }
    panels_add(&s, 0, 0, photo, 1);
    panels_add(&s, 1, 0, depth, 0.1f);

    /* --8<-- [start:features] */
    check(luxfer_features_create(context, &features), "features");
    check(luxfer_features_set_photo(features, photo), "photo");
    show_normals(features, "without depth", &s, 0);
    check(luxfer_features_set_depth(features, depth, LUXFER_DEPTH_ALONG_Z), "depth");
    show_normals(features, "with depth", &s, 1);
    /* --8<-- [end:features] */
    check(panels_save(&s, context, "rgbd_input.png"), "rgbd_input.png");
    /* For a whole transfer, use luxfer_transfer_set_depth. */

    luxfer_release(features);
    luxfer_release(depth);
    luxfer_release(photo);
    luxfer_release(context);
    return 0;
}
