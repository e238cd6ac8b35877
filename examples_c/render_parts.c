/* Renders on many machines: each machine renders parts into files, and one machine merges the files.
 *
 *   render_parts part INDEX FILE      renders part INDEX of PARTS into FILE: a task of a farm
 *   render_parts merge FILE...        merges the parts, in any order, into render_parts.exr and render_parts.png
 *   render_parts                      does both, and compares the result with a rendering in one part
 */
#include "common.h"

#include <string.h>

/* The rendering is divided into 3 x 2 rectangles with 2 ranges of paths each. */
enum { COLUMNS = 3, ROWS = 2, RANGES = 2, PARTS = COLUMNS * ROWS * RANGES };

/* Sets up the rendering. Scene, camera, layers and settings must be equal in every task; the merge checks this. */
static luxfer_render *describe(luxfer_render_params *params) {
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_STILL_LIFE, &scene), "scene"); /* luxfer_scene_load(context, file, NULL, &scene) */
    check(luxfer_render_create(context, &render), "render");
    check(luxfer_render_set_scene(render, scene), "render");
    check(luxfer_render_add_expression(render, "direct", "LDE"), "layer");
    check(luxfer_render_set_aovs(render, LUXFER_AOV_DEPTH | LUXFER_AOV_OBJECT), "layers");
    check(luxfer_render_params_init(params, sizeof *params), "settings");
    params->width = 240;
    params->height = 180;
    params->samples = 16;
    params->preview = 1; /* filter the noise after merging */
    luxfer_release(scene);
    return render;
}

/* --8<-- [start:part] */
/* A task: renders one part into a file, which appears only when it is complete. */
static void render_part(luxfer_render *render, const luxfer_render_params *params, uint32_t index, const char *file) {
    luxfer_render_part part;
    luxfer_job *job = NULL;
    check(luxfer_render_split(render, params, COLUMNS, ROWS, RANGES, index, &part, sizeof part), "part");
    check(luxfer_render_start_part(render, params, &part, file, &job), file);
    wait_and_release(job, file);
}
/* --8<-- [end:part] */

/* --8<-- [start:merge] */
/* Merges the files after all tasks have ended. The result is as if this machine had rendered everything. */
static void merge(luxfer_render *render, const luxfer_render_params *params, char **files, int count) {
    luxfer_job *job = NULL;
    int i;
    check(luxfer_render_clear_parts(render), "merge");
    for (i = 0; i < count; i++) check(luxfer_render_add_part(render, files[i]), files[i]);
    check(luxfer_render_start_merge(render, params, &job), "merge");
    wait_and_release(job, "merging");
    check(luxfer_render_write_exr(render, "render_parts.exr"), "render_parts.exr");
}
/* --8<-- [end:merge] */

/* Reads the pixels of the picture and saves the filtered picture; the caller frees the pixels. */
static float *pixels(luxfer_render *render, luxfer_image_view *view) {
    luxfer_image *image = NULL;
    luxfer_render_report report;
    check(luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &image), "picture");
    check(luxfer_image_view_init(view, sizeof *view), "picture");
    check(luxfer_image_get_size(image, &view->width, &view->height, &view->channels), "picture");
    view->byte_size = (size_t)view->width * view->height * view->channels * sizeof(float);
    view->data = malloc(view->byte_size);
    if (!view->data) exit(1);
    check(luxfer_image_read(image, 0, view), "picture");
    luxfer_release(image);
    check(luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, &image), "picture");
    check(luxfer_image_save(image, "render_parts.png", 1 / 450.0f), "render_parts.png");
    luxfer_release(image);
    check(luxfer_render_get_report(render, &report, sizeof report), "report");
    printf("look at render_parts.png; its root mean square error is %.1f %% of its mean\n", 100 * report.preview_error);
    return view->data;
}

/* Renders and merges all parts, the last part first; then renders the whole image in one part, and checks that both
 * are equal to the bit. */
static int demonstrate(luxfer_render *render, const luxfer_render_params *params) {
    char names[PARTS][32], *files[PARTS], *whole = "whole.part.exr";
    luxfer_image_view view;
    float *merged, *at_once;
    luxfer_job *job = NULL;
    int i, differs;
    for (i = 0; i < PARTS; i++) {
        files[i] = names[i];
        sprintf(names[i], "part%02d.exr", PARTS - 1 - i);
        render_part(render, params, (uint32_t)(PARTS - 1 - i), names[i]);
    }
    merge(render, params, files, PARTS);
    merged = pixels(render, &view);

    check(luxfer_render_start_part(render, params, NULL, whole, &job), whole);
    wait_and_release(job, whole);
    merge(render, params, &whole, 1);
    at_once = pixels(render, &view);
    differs = memcmp(merged, at_once, view.byte_size) != 0;
    printf("%d parts and one give %s\n", PARTS, differs ? "different pictures" : "the same picture to the bit");
    free(merged);
    free(at_once);
    return differs;
}

int main(int argc, char **argv) {
    luxfer_render_params params;
    luxfer_render *render;
    int status = 0;
    check(luxfer_context_create(NULL, &context), "context");
    render = describe(&params);
    if (argc == 4 && strcmp(argv[1], "part") == 0)
        render_part(render, &params, (uint32_t)atoi(argv[2]), argv[3]);
    else if (argc > 2 && strcmp(argv[1], "merge") == 0)
        merge(render, &params, argv + 2, argc - 2);
    else if (argc == 1)
        status = demonstrate(render, &params);
    else
        status = 2;
    luxfer_release(render);
    luxfer_release(context);
    return status;
}
