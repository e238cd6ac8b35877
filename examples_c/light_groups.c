/* Light groups: renders the light of each lamp as a layer of its own, and mixes the layers without rendering again.
 *
 * Light path expressions select the light of a lamp by its name. Writes light_groups.png (all light, three groups, and
 * two mixtures of them) and light_groups.exr, which has every group as a layer that compositing programs can read.
 */
#include "common.h"
#include "panels.h"

enum { GROUPS = 3, MIXTURES = 2 };

/* Luminance in cd/m2 shown as white. */
#define WHITE 450.0f

/* A warm spot light from the left. */
static void add_spot(luxfer_scene *scene) {
    luxfer_light_params spot;
    check(luxfer_light_params_init(&spot, sizeof spot), "spot");
    spot.kind = LUXFER_LIGHT_SPOT;
    spot.position[0] = -0.6f, spot.position[1] = 0.5f, spot.position[2] = 0.4f;
    spot.direction[0] = 0.6f, spot.direction[1] = -0.45f, spot.direction[2] = -0.4f;
    spot.intensity[0] = 450, spot.intensity[1] = 260, spot.intensity[2] = 100; /* candela */
    spot.inner_angle = 0.15f, spot.outer_angle = 0.3f;
    check(luxfer_scene_add_light(scene, &spot, NULL), "spot");
}

int main(void) {
    /* --8<-- [start:expressions] */
    /* C is the camera, .* any events, <L.'name'> a light: a mesh or material of that name, light0 the first punctual
     * light, environment the environment. Every path ends at one light, so the sum of the groups is the picture. */
    static const char *const names[GROUPS] = {"lamp", "spot", "surroundings"};
    static const char *const expressions[GROUPS] = {"C.*<L.'Lamp'>", "C.*<L.'light0'>", "C.*<L.'environment'>"};
    /* --8<-- [end:expressions] */
    /* Factor of each group in a mixture, per channel. */
    static const float mixtures[MIXTURES][GROUPS][3] = {{{0.05f, 0.05f, 0.05f}, {1.6f, 1.6f, 1.6f}, {0.3f, 0.3f, 0.3f}},
                                                        {{0.5f, 0.7f, 1.2f}, {0, 0, 0}, {0.4f, 0.7f, 1.6f}}};
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    luxfer_render_params params;
    luxfer_render_report report;
    luxfer_image *image = NULL;
    luxfer_image_view view;
    luxfer_job *job = NULL;
    float *all, *group[GROUPS], *mixture;
    double worst = 0;
    size_t k, count;
    int g, m;
    sheet s = panels_begin(3, 2, 180, 135);

    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_STILL_LIFE, &scene), "scene");
    add_spot(scene);
    check(luxfer_render_create(context, &render), "render");
    check(luxfer_render_set_scene(render, scene), "render");
    for (g = 0; g < GROUPS; g++) check(luxfer_render_add_expression(render, names[g], expressions[g]), names[g]);
    check(luxfer_render_params_init(&params, sizeof params), "render");
    params.width = 180;
    params.height = 135;
    params.samples = 4096;
    params.target_error = 0.02f; /* layers of light are not filtered, so trace paths until the noise is low */
    check(luxfer_render_start(render, &params, &job), "render");
    wait_and_release(job, "rendering");
    check(luxfer_render_get_report(render, &report, sizeof report), "report");
    printf("the picture has a root mean square error of %.1f %% of its mean\n", 100 * report.error);

    /* --8<-- [start:layers] */
    /* Get the picture, then the groups by their names. */
    check(luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &image), "picture");
    panels_add(&s, 0, 0, image, 1 / WHITE);
    all = panels_pixels(image, &view);
    luxfer_release(image);
    for (g = 0; g < GROUPS; g++) {
        check(luxfer_render_get_layer(render, names[g], &image), names[g]);
        panels_add(&s, (g + 1) % 3, (g + 1) / 3, image, 1 / WHITE);
        group[g] = panels_pixels(image, &view);
        luxfer_release(image);
    }
    /* --8<-- [end:layers] */
    mixture = malloc(view.byte_size);
    if (!all || !group[0] || !group[1] || !group[2] || !mixture) return 1;

    count = view.byte_size / sizeof(float);
    for (k = 0; k < count; k++) worst = fmax(worst, fabs(all[k] - group[0][k] - group[1][k] - group[2][k]) / (1 + all[k]));
    printf("the groups add up to the picture within %.1e of its values\n", worst);

    view.data = mixture;
    for (m = 0; m < MIXTURES; m++) {
        for (k = 0; k < count; k++)
            for (mixture[k] = 0, g = 0; g < GROUPS; g++) mixture[k] += mixtures[m][g][k % 3] * group[g][k];
        check(luxfer_image_create(context, &view, &image), "mixture");
        panels_add(&s, 1 + m, 1, image, 1 / WHITE);
        luxfer_release(image);
    }
    check(panels_save(&s, context, "light_groups.png"), "light_groups.png");
    check(luxfer_render_write_exr(render, "light_groups.exr"), "light_groups.exr");

    for (g = 0; g < GROUPS; g++) free(group[g]);
    free(all);
    free(mixture);
    luxfer_release(render);
    luxfer_release(scene);
    luxfer_release(context);
    return worst < 1e-4 ? 0 : 1;
}
