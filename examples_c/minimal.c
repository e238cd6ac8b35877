/* The smallest program: renders a scene into a file.
 *
 *   minimal [SCENE.glb]
 *
 * Renders the first camera of a scene, or a room that the library generates, to minimal.png.
 */
#include "luxfer.h"

#include <stdio.h>

int main(int argc, char **argv) {
    luxfer_context *context = NULL;
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    luxfer_job *job = NULL;
    luxfer_image *picture = NULL;
    luxfer_render_params params;
    luxfer_render_report report;
    luxfer_status status, outcome;

    /* A context owns the threads. All objects are created in a context; NULL means default settings. */
    if (luxfer_context_create(NULL, &context) != LUXFER_OK) return 1;

    /* Fill settings with their defaults, then change some. */
    luxfer_render_params_init(&params, sizeof params);
    params.width = 300;
    params.height = 200;
    params.samples = 8;
    params.preview = 1; /* filter the noise of so few paths */

    /* Every call returns a status. A call whose input is missing fails too, so report the first failure. */
    status = argc > 1 ? luxfer_scene_load(context, argv[1], NULL, &scene)
                      : luxfer_demo_create_scene(context, LUXFER_DEMO_EXEMPLAR_ROOM, &scene);
    if (status == LUXFER_OK) status = luxfer_render_create(context, &render);
    if (status == LUXFER_OK) status = luxfer_render_set_scene(render, scene);

    /* Long work is a job that runs on the library's threads. Wait for it without a time limit (-1). The call succeeds
     * even if the work fails; the outcome is the status of the work. */
    if (status == LUXFER_OK) status = luxfer_render_start(render, &params, &job);
    if (status == LUXFER_OK) status = luxfer_job_wait(job, -1, NULL, NULL, &outcome);
    if (status == LUXFER_OK) status = outcome;

    /* Pictures are in cd/m2; the last argument is the exposure: with 0.005, 200 cd/m2 become white. */
    if (status == LUXFER_OK) status = luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, &picture);
    if (status == LUXFER_OK) status = luxfer_image_save(picture, "minimal.png", 0.005f);
    if (status == LUXFER_OK) status = luxfer_render_get_report(render, &report, sizeof report);

    if (status == LUXFER_OK) {
        printf("look at minimal.png; its root mean square error is %.0f %% of its mean\n", 100 * report.preview_error);
    } else {
        char message[512] = "";
        luxfer_context_get_last_error(context, message, sizeof message, NULL);
        fprintf(stderr, "%s: %s\n", luxfer_status_get_name(status), message);
    }

    /* Release in any order; releasing NULL does nothing. */
    luxfer_release(picture);
    luxfer_release(job);
    luxfer_release(render);
    luxfer_release(scene);
    luxfer_release(context);
    return status == LUXFER_OK ? 0 : 1;
}
