/* Paints a scene in the style of an artwork, for three artworks.
 *
 *   stylize [--size WxH] [--samples N] [--out DIR]
 *
 * The exemplar is the sphere on a table that comes with the library, painted by three programs in place of artists; the
 * target is a still life. Writes stylize.png (above: the exemplar and its artworks; below: the target, stylised) and
 * each result as stylize_<style>.png into DIR, and sheet.png, the exemplar to be printed on A4 and painted by hand.
 * luxfer_sheet_align makes an artwork from a photo of the painted sheet that luxfer_image_load has loaded.
 */
#include "common.h"
#include "panels.h"

#include <string.h>

enum { STYLES = 3 };

/* Luminance in cd/m2 shown as white. */
#define EXPOSURE 450.0f

/* Renders the guides of a demonstration scene. */
static luxfer_guides *render(luxfer_demo which, const luxfer_guides_params *params, const char *title) {
    luxfer_scene *scene = NULL;
    luxfer_guides *guides = NULL;
    luxfer_job *job = NULL;
    check(luxfer_demo_create_scene(context, which, &scene), title);
    check(luxfer_guides_create(context, &guides), title);
    check(luxfer_guides_set_scene(guides, scene), title);
    check(luxfer_guides_start(guides, params, &job), title);
    wait_and_release(job, title);
    luxfer_release(scene);
    return guides;
}

/* Gets the guide with all light, which is the complete picture of the scene. */
static luxfer_image *full(luxfer_guides *guides) {
    luxfer_image *image = NULL;
    check(luxfer_guides_get_image(guides, LUXFER_GUIDES_FULL, &image), "guides");
    return image;
}

/* Saves the sheet to print: the exemplar in pale colours between alignment marks. */
static void print_sheet(luxfer_image *radiance, const char *out) {
    luxfer_sheet_params params;
    luxfer_image_view view;
    luxfer_image *picture = NULL, *page = NULL;
    char file[4096];
    size_t k;
    float *pixels = panels_pixels(radiance, &view);
    if (!pixels) return;
    for (k = 0; k < view.byte_size / sizeof *pixels; k++) pixels[k] /= EXPOSURE;
    check(luxfer_image_create(context, &view, &picture), "sheet");
    check(luxfer_sheet_params_init(&params, sizeof params), "sheet");
    params.dpi = 150;
    check(luxfer_sheet_print(picture, &params, &page), "sheet");
    if (snprintf(file, sizeof file, "%s/sheet.png", out) >= (int)sizeof file) exit(2);
    check(luxfer_image_save(page, file, 1), file);
    luxfer_release(page);
    luxfer_release(picture);
    free(pixels);
}

int main(int argc, char **argv) {
    static const char *const names[STYLES] = {"pen", "stipple", "paint"};
    luxfer_guides_params params;
    luxfer_guides *source, *target;
    luxfer_stylize *stylize = NULL;
    luxfer_image *image;
    const char *out = ".";
    char file[4096];
    sheet s;
    int i;

    check(luxfer_guides_params_init(&params, sizeof params), "guides");
    params.width = 480;
    params.height = 360;
    params.samples = 24;
    for (i = 1; i < argc; i += 2) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (!strcmp(argv[i], "--out") && *value) out = value;
        else if (!strcmp(argv[i], "--samples") && *value) params.samples = (uint32_t)atoi(value);
        else if (strcmp(argv[i], "--size") || sscanf(value, "%ux%u", &params.width, &params.height) != 2) {
            fprintf(stderr, "cannot use %s; see the head of stylize.c\n", argv[i]);
            return 2;
        }
    }

    /* Render the guides of the exemplar and of the target. */
    check(luxfer_context_create(NULL, &context), "context");
    if (luxfer_stylize_create(context, &stylize) == LUXFER_UNSUPPORTED) {
        fprintf(stderr, "this build of luxfer has no stylisation\n");
        return 0;
    }
    /* --8<-- [start:guides] */
    source = render(LUXFER_DEMO_SPHERE_ON_TABLE, &params, "exemplar");
    target = render(LUXFER_DEMO_STILL_LIFE, &params, "target");
    /* All objects have the same red, so only edges separate a ball from the ring behind it: give edges more weight
     * than the light guides. */
    check(luxfer_stylize_add_guides(stylize, source, target, LUXFER_GUIDES_WITH_EDGES, 2.5f), "guides");
    /* --8<-- [end:guides] */
    s = panels_begin(1 + STYLES, 2, 480, 360);
    image = full(source);
    panels_add(&s, 0, 0, image, 1 / EXPOSURE);
    print_sheet(image, out);
    luxfer_release(image);
    image = full(target);
    panels_add(&s, 0, 1, image, 1 / EXPOSURE);
    luxfer_release(image);

    /* Paint the target in the style of each artwork. */
    for (i = 0; i < STYLES; i++) {
        luxfer_stylize_report report;
        luxfer_image *artwork = NULL;
        luxfer_job *job = NULL;
        /* --8<-- [start:paint] */
        check(luxfer_demo_create_artwork(source, LUXFER_ARTWORK_PEN + i, &artwork), names[i]);
        check(luxfer_stylize_set_artwork(stylize, artwork), names[i]);
        check(luxfer_stylize_start(stylize, NULL, &job), names[i]);
        wait_and_release(job, names[i]);
        check(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_PICTURE, &image), names[i]);
        check(luxfer_stylize_get_report(stylize, &report, sizeof report), names[i]);
        /* --8<-- [end:paint] */
        printf("%-8s guide error %.3f, %.0f %% of the artwork used\n", names[i], report.guide_error, 100 * report.used);
        panels_add(&s, 1 + i, 0, artwork, 1);
        panels_add(&s, 1 + i, 1, image, 1);
        if (snprintf(file, sizeof file, "%s/stylize_%s.png", out, names[i]) >= (int)sizeof file) return 2;
        check(luxfer_image_save(image, file, 1), file);
        luxfer_release(image);
        luxfer_release(artwork);
    }
    if (snprintf(file, sizeof file, "%s/stylize.png", out) >= (int)sizeof file) return 2;
    check(panels_save(&s, context, file), file);
    luxfer_release(source);
    luxfer_release(target);
    luxfer_release(stylize);
    luxfer_release(context);
    return 0;
}
