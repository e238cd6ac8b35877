/* Renders a picture in a given time, or of a given quality: a plan chooses the settings and predicts time and error.
 *
 * Renders the generated office twice: first with at most 10 % of noise, then within a second. Prints the predicted and
 * the actual time and error, and writes plan.png.
 */
#include "common.h"

int main(void) {
    const char *goals[] = {"one second", "10 % of noise"};
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    luxfer_plan *plan = NULL;
    luxfer_image *picture = NULL;
    luxfer_job *job = NULL;
    luxfer_render_params settings;
    luxfer_render_report report;
    int i;

    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_EXEMPLAR_ROOM, &scene), "scene");
    check(luxfer_render_create(context, &render), "render");
    check(luxfer_render_set_scene(render, scene), "render");

    for (i = 0; i < 2; i++) {
        /* --8<-- [start:plan] */
        luxfer_plan_params params;
        luxfer_plan_report expected;
        check(luxfer_plan_params_init(&params, sizeof params), "plan");
        if (i == 1) params.target_error = 0.1f; /* error of the picture, relative to its mean */
        else params.time_budget_ms = 1000;

        /* Set the settings that do not affect quality yourself: the size of the picture, the seed. */
        check(luxfer_render_params_init(&settings, sizeof settings), "settings");
        settings.width = 160;
        settings.height = 90;

        check(luxfer_plan_create(context, &plan), "plan");
        check(luxfer_plan_start_render(plan, render, &settings, &params, &job), "plan");
        wait_and_release(job, "planning");
        check(luxfer_plan_get_report(plan, &expected, sizeof expected), "plan");
        check(luxfer_plan_get_render_params(plan, &settings, sizeof settings), "plan");
        luxfer_release(plan);
        /* --8<-- [end:plan] */
        settings.preview = 1; /* also filter the noise of the picture */

        check(luxfer_render_start(render, &settings, &job), "render");
        wait_and_release(job, "rendering");
        check(luxfer_render_get_report(render, &report, sizeof report), "report");
        printf("%s: %.2f s and an error of %.1f %% expected; it is %.1f %% with %u paths per pixel\n", goals[i],
               expected.seconds, 100 * expected.error, 100 * report.error, report.samples);
        /* The rendering stops when it reaches the target error. */
        if (i == 1 && report.error > 0.15) return 1;
    }

    check(luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, &picture), "picture");
    check(luxfer_image_save(picture, "plan.png", 0.005f), "picture");
    printf("look at plan.png; after filtering, its error is %.1f %%\n", 100 * report.preview_error);
    luxfer_release(picture);
    luxfer_release(render);
    luxfer_release(scene);
    luxfer_release(context);
    return 0;
}
