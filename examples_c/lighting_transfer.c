/* Copies the lighting of a photo onto a 3D scene.
 *
 *   lighting_transfer [PHOTO SCENE --surface NAME --strokes FILE] [--distance M] [--size WxH] [--samples N] [--out DIR]
 *
 * Without arguments it generates its input: the photo of an office, and a living room. FILE holds the strokes: an image
 * of the photo's size (green: plane, red: not plane, yellow: light, blue: not light) or a text (.txt). Writes
 * overview.png, emission.exr, render.exr, render.png, lit.glb, luminaires.csv and report.json into DIR, and prints the
 * warnings about the result.
 */
#include "luxfer.h"
#include "common.h"
#include "overview.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    const char *photo, *scene, *surface, *strokes, *out;
    double distance;
    unsigned width, height, samples;
} options;

static const char *path(const options *o, const char *name) {
    static char buffer[4096];
    if (snprintf(buffer, sizeof buffer, "%s/%s", o->out, name) >= (int)sizeof buffer) exit(2);
    return buffer;
}

static options parse(int argc, char **argv) {
    options o = {NULL, NULL, "Ceiling", NULL, ".", 0, 640, 360, 12};
    int i;
    for (i = 1; i < argc; i++) {
        const char *arg = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strncmp(arg, "--", 2) == 0 && value) i++;
        if (strncmp(arg, "--", 2) != 0 && !o.photo) o.photo = arg;
        else if (strncmp(arg, "--", 2) != 0 && !o.scene) o.scene = arg;
        else if (!strcmp(arg, "--surface") && value) o.surface = value;
        else if (!strcmp(arg, "--strokes") && value) o.strokes = value;
        else if (!strcmp(arg, "--out") && value) o.out = value;
        else if (!strcmp(arg, "--distance") && value) o.distance = atof(value);
        else if (!strcmp(arg, "--samples") && value) o.samples = (unsigned)atoi(value);
        else if (!strcmp(arg, "--size") && value && sscanf(value, "%ux%u", &o.width, &o.height) == 2) continue;
        else {
            fprintf(stderr, "cannot use %s; see the head of lighting_transfer.c\n", arg);
            exit(2);
        }
    }
    if (o.photo && !(o.scene && o.strokes)) {
        fprintf(stderr, "a photo of your own needs a scene and --strokes\n");
        exit(2);
    }
    return o;
}

static int ends_with(const char *text, const char *end) {
    size_t n = strlen(text), m = strlen(end);
    return n >= m && !strcmp(text + n - m, end);
}

/* Reads a small text file into memory, zero-terminated. */
static char *read_text(const char *name) {
    FILE *file = fopen(name, "rb");
    char *text = calloc(1, 1 << 20);
    if (!file || !text || fread(text, 1, (1 << 20) - 1, file) == 0) {
        fprintf(stderr, "cannot read %s\n", name);
        exit(1);
    }
    fclose(file);
    return text;
}

/* Creates an empty set of strokes for a photo. */
static luxfer_strokes *strokes_for(luxfer_image *photo) {
    luxfer_strokes *strokes = NULL;
    uint32_t width, height;
    check(luxfer_image_get_size(photo, &width, &height, NULL), "photo");
    check(luxfer_strokes_create(context, width, height, &strokes), "strokes");
    return strokes;
}

/* Loads photo, strokes and scene from the user's files. */
static void load_input(const options *o, luxfer_transfer *transfer, luxfer_image **photo, luxfer_scene **scene) {
    luxfer_strokes *strokes;
    check(luxfer_image_load(context, o->photo, LUXFER_COLOUR_SRGB, photo), "photo");
    check(luxfer_transfer_set_photo(transfer, *photo), "photo");
    strokes = strokes_for(*photo);
    if (ends_with(o->strokes, ".txt")) {
        char *text = read_text(o->strokes);
        check(luxfer_strokes_add_text(strokes, text), "strokes");
        free(text);
    } else {
        luxfer_image *drawing = NULL;
        check(luxfer_image_load(context, o->strokes, LUXFER_COLOUR_SRGB, &drawing), "strokes");
        check(luxfer_strokes_add_image(strokes, drawing), "strokes");
        luxfer_release(drawing);
    }
    check(luxfer_transfer_set_strokes(transfer, strokes), "strokes");
    luxfer_release(strokes);
    check(luxfer_scene_load(context, o->scene, NULL, scene), "scene");
}

/* Generates photo, strokes and scene. */
static void generate_input(luxfer_transfer *transfer, luxfer_image **photo, luxfer_scene **scene) {
    luxfer_demo_photo *demo = NULL;
    luxfer_job *job = NULL;
    luxfer_image *drawing = NULL;
    luxfer_strokes *strokes;
    check(luxfer_demo_photo_create(context, &demo), "demo");
    check(luxfer_demo_photo_start(demo, NULL, &job), "demo");
    wait_and_release(job, "photographing the office");
    check(luxfer_demo_photo_get_image(demo, LUXFER_DEMO_PHOTO_PICTURE, photo), "demo photo");
    check(luxfer_demo_photo_get_image(demo, LUXFER_DEMO_PHOTO_STROKES, &drawing), "demo strokes");
    check(luxfer_transfer_set_photo(transfer, *photo), "photo");
    strokes = strokes_for(*photo);
    check(luxfer_strokes_add_image(strokes, drawing), "strokes");
    check(luxfer_transfer_set_strokes(transfer, strokes), "strokes");
    luxfer_release(strokes);
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_TARGET_ROOM, scene), "demo scene");
    luxfer_release(drawing);
    luxfer_release(demo);
}

/* Adds a light at the camera to a scene without lights, so that its picture is not black. */
static void add_headlight(luxfer_scene *scene, const luxfer_camera_params *camera) {
    luxfer_scene_counts counts;
    luxfer_light_params light;
    int i;
    check(luxfer_scene_get_counts(scene, &counts, sizeof counts), "scene");
    if (counts.lights > 0) return;
    check(luxfer_light_params_init(&light, sizeof light), "light");
    for (i = 0; i < 3; i++) {
        light.position[i] = camera->position[i] + 1.5f * (camera->target[i] - camera->position[i]);
        light.intensity[i] = 400;
    }
    check(luxfer_scene_add_light(scene, &light, NULL), "light");
}

/* Renders a scene with few paths, and filters the noise. */
static luxfer_image *preview(const options *o, luxfer_scene *scene, const luxfer_camera_params *camera,
                             unsigned samples, const char *title) {
    luxfer_render *render = NULL;
    luxfer_render_params params;
    luxfer_job *job = NULL;
    luxfer_image *image = NULL;
    luxfer_render_report report;
    check(luxfer_render_params_init(&params, sizeof params), title);
    params.width = o->width / 2;
    params.height = o->height / 2;
    params.samples = samples;
    params.preview = 1;
    check(luxfer_render_create(context, &render), title);
    check(luxfer_render_set_scene(render, scene), title);
    check(luxfer_render_set_camera(render, camera), title);
    check(luxfer_render_start(render, &params, &job), title);
    wait_and_release(job, title);
    check(luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, &image), title);
    check(luxfer_render_get_report(render, &report, sizeof report), title);
    printf("%s: filtered, with an error of %.1f %%\n", title, 100 * report.preview_error);
    luxfer_release(render);
    return image;
}

/* Writes a number as JSON. NaN, which marks an unknown error, becomes null, because JSON has no NaN. */
static void write_number(FILE *file, double value) {
    if (value == value && value - value == 0) fprintf(file, "%.6g", value);
    else fprintf(file, "null");
}

/* Writes the warnings as JSON, with their names and figures. */
static void write_warnings(FILE *file, const char *const *stages, luxfer_warnings *warnings) {
    luxfer_warning w;
    uint32_t i, count = 0;
    check(luxfer_warnings_get_count(warnings, &count), "warnings");
    fprintf(file, "  \"warnings\": [");
    for (i = 0; i < count; i++) {
        check(luxfer_warnings_get(warnings, i, &w, sizeof w), "warning");
        fprintf(file, "%s\n    {\"stage\": \"%s\", \"code\": \"%s\", \"severity\": ", i ? "," : "", stages[w.stage],
                luxfer_warning_get_name(w.code));
        write_number(file, w.severity);
        fprintf(file, ", \"limit\": %.6g", w.limit);
        if (w.has_place) fprintf(file, ", \"place\": [%.1f, %.1f]", w.place[0], w.place[1]);
        fprintf(file, "}");
    }
    fprintf(file, "%s],\n", count ? "\n  " : "");
}

static void write_report(const options *o, const luxfer_transfer_report *r, const luxfer_relight_report *s,
                         luxfer_warnings *warnings) {
    static const char *stages[8] = {"view", "features", "plane", "lights", "unwarp", "emission", "relight", "render"};
    static const char *units[8] = {"radians",
                                   "1 - trust in depth",
                                   "share of wrong pixels",
                                   "share of wrong pixels",
                                   "unwarped pixels at a corner",
                                   "relative share of lit area",
                                   "relative 95 % half-width",
                                   "relative standard error"};
    double errors[8];
    FILE *file = fopen(path(o, "report.json"), "w");
    int i;
    if (!file) exit(1);
    errors[0] = r->view_error, errors[1] = 1 - r->depth_confidence, errors[2] = r->plane_error;
    errors[3] = r->lights_error, errors[4] = r->unwarp_error, errors[5] = r->emission_error;
    errors[6] = r->relight_error, errors[7] = r->render_error;
    fprintf(file, "{\n  \"luxfer\": \"%s\",\n  \"stages\": {\n", luxfer_get_version_string());
    for (i = 0; i < 8; i++) {
        fprintf(file, "    \"%s\": {\"seconds\": %.4f, \"error\": ", stages[i], r->seconds[i]);
        write_number(file, errors[i]);
        fprintf(file, ", \"error_is\": \"%s\"}%s\n", units[i], i < 7 ? "," : "");
    }
    fprintf(file, "  },\n");
    write_warnings(file, stages, warnings);
    fprintf(file, "  \"target\": [%.6g, %.6g, %.6g],\n", r->target[0], r->target[1], r->target[2]);
    fprintf(file, "  \"scale\": [%.6g, %.6g, %.6g],\n", s->scale[0], s->scale[1], s->scale[2]);
    fprintf(file, "  \"half_width\": [%.6g, %.6g, %.6g],\n", s->half_width[0], s->half_width[1], s->half_width[2]);
    fprintf(file, "  \"filtered_error\": ");
    write_number(file, r->preview_error);
    fprintf(file, ",\n  \"luminaires\": %u,\n  \"texel_m\": %.6g\n}\n", r->fixtures, r->texel_size);
    fclose(file);
}

int main(int argc, char **argv) {
    options o = parse(argc, argv);
    luxfer_transfer *transfer = NULL;
    luxfer_transfer_params params;
    luxfer_render_params render;
    luxfer_transfer_report report;
    luxfer_relight_report solution;
    luxfer_image *photo = NULL, *lit = NULL, *filtered = NULL, *emission = NULL, *before, *white;
    luxfer_scene *scene = NULL, *lit_scene = NULL, *white_scene = NULL;
    luxfer_warnings *warnings = NULL;
    luxfer_job *job = NULL;
    luxfer_camera_params camera;
    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_transfer_create(context, &transfer), "transfer");
    if (o.photo) load_input(&o, transfer, &photo, &scene);
    else generate_input(transfer, &photo, &scene);
    check(luxfer_transfer_set_scene(transfer, scene, o.surface), "surface");

    /* Run the whole transfer. */
    check(luxfer_transfer_params_init(&params, sizeof params), "params");
    check(luxfer_render_params_init(&render, sizeof render), "params");
    render.width = o.width;
    render.height = o.height;
    render.samples = o.samples;
    render.preview = 1;
    params.render = &render;
    params.plane_distance = o.distance;
    check(luxfer_transfer_start(transfer, LUXFER_STAGE_VIEW, LUXFER_STAGE_RENDER, &params, &job), "transfer");
    wait_and_release(job, "transferring the lighting");

    /* Get its results. */
    check(luxfer_transfer_get_image(transfer, LUXFER_TRANSFER_RENDER, &lit), "render");
    check(luxfer_transfer_get_image(transfer, LUXFER_TRANSFER_RENDER_PREVIEW, &filtered), "filtered render");
    check(luxfer_transfer_get_image(transfer, LUXFER_TRANSFER_EMISSION, &emission), "emission");
    check(luxfer_transfer_get_scene(transfer, LUXFER_SCENE_LIT, &lit_scene), "lit scene");
    check(luxfer_transfer_get_scene(transfer, LUXFER_SCENE_WHITE, &white_scene), "white scene");
    check(luxfer_transfer_get_report(transfer, &report, sizeof report), "report");
    check(luxfer_transfer_get_solution(transfer, &solution, sizeof solution), "solution");
    check(luxfer_image_save(lit, path(&o, "render.exr"), 1), "render.exr");
    check(luxfer_image_save(filtered, path(&o, "render.png"), 1 / params.white_luminance), "render.png");
    check(luxfer_image_save(emission, path(&o, "emission.exr"), 1), "emission.exr");
    check(luxfer_scene_export(lit_scene, path(&o, "lit.glb")), "lit.glb");
    check(luxfer_transfer_save_fixtures(transfer, path(&o, "luminaires.csv")), "luminaires.csv");
    check(luxfer_get_warnings(transfer, &warnings), "warnings");
    write_report(&o, &report, &solution, warnings);

    /* For comparison, render the scene before the transfer (with its own lights or a light at the camera), and in
     * white light. */
    check(luxfer_camera_params_init(&camera, sizeof camera), "camera");
    check(luxfer_scene_get_camera(lit_scene, 0, &camera, sizeof camera), "camera");
    add_headlight(scene, &camera);
    before = preview(&o, scene, &camera, 8, "rendering it before");
    white = preview(&o, white_scene, &camera, o.samples / 2 + 1, "rendering it in white");
    check(overview_save(context, transfer, photo, before, white, filtered, params.white_luminance, path(&o, "overview.png")),
          "overview.png");
    printf("%u luminaires; colour and intensity to +-%.2f %%; see %s\n", report.fixtures, 100 * report.relight_error,
           path(&o, "overview.png"));
    printf("the picture is filtered, with an error of %.1f %%\n", 100 * report.preview_error);
    print_warnings(warnings);

    luxfer_release(white);
    luxfer_release(before);
    luxfer_release(emission);
    luxfer_release(filtered);
    luxfer_release(lit);
    luxfer_release(white_scene);
    luxfer_release(lit_scene);
    luxfer_release(transfer);
    luxfer_release(scene);
    luxfer_release(photo);
    luxfer_release(context);
    return 0;
}
