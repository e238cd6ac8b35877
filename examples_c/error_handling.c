/* Error handling: statuses, messages, versions.
 *
 * Makes mistakes on purpose and prints the library's status and message for each. No mistake ends the program: the
 * library does not print or abort, and it writes outputs only on success.
 */
#include "luxfer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static luxfer_context *context;

/* --8<-- [start:report] */
/* Handles a failure: the program decides by the status, and people read the message. */
static void report(const char *attempt, luxfer_status status, luxfer_status expected) {
    char *message;
    size_t needed = 0;
    /* A message may have any length, so get its length first. The library keeps it until the thread's next failure. */
    luxfer_context_get_last_error(context, NULL, 0, &needed);
    message = malloc(needed);
    if (!message) exit(1);
    luxfer_context_get_last_error(context, message, needed, NULL);
    printf("%s\n  %s: %s\n", attempt, luxfer_status_get_name(status), message);
    free(message);
    if (status != expected) exit(1);
}
/* --8<-- [end:report] */

int main(void) {
    luxfer_image *image = NULL;
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    luxfer_job *job = NULL;
    luxfer_status outcome;
    luxfer_surface surface;
    luxfer_material_params material;
    luxfer_render_params params;
    luxfer_image_view view;
    float pixels[2 * 2 * 3] = {0};

    /* --8<-- [start:version] */
    /* Check that the loaded library is compatible with this header. Before 1.0 the minor versions must be equal. */
    if (luxfer_get_version() / 100 != LUXFER_VERSION / 100) {
        fprintf(stderr, "built for luxfer %d.%d, loaded %s\n", LUXFER_VERSION_MAJOR, LUXFER_VERSION_MINOR,
                luxfer_get_version_string());
        return 1;
    }
    /* --8<-- [end:version] */
    if (luxfer_context_create(NULL, &context) != LUXFER_OK) return 1;

    report("A file that is not there:", luxfer_image_load(context, "photo.jpg", LUXFER_COLOUR_SRGB, &image), LUXFER_IO);
    report("A file that is something else:",
           luxfer_scene_load_memory(context, "not a scene", 11, NULL, NULL, &scene), LUXFER_FORMAT);

    /* A view states the size of its memory, so that the library never accesses memory beyond it. */
    luxfer_image_view_init(&view, sizeof view);
    view.width = 2;
    view.height = 3;
    view.data = pixels;
    view.byte_size = sizeof pixels;
    report("2 x 2 pixels declared as 2 x 3:", luxfer_image_create(context, &view, &image),
           LUXFER_INVALID_ARGUMENT);

    if (luxfer_demo_create_scene(context, LUXFER_DEMO_TARGET_ROOM, &scene) != LUXFER_OK) return 1;
    report("A misspelt name:", luxfer_scene_find_surface(scene, "Ceilling", &surface, sizeof surface), LUXFER_NOT_FOUND);
    luxfer_material_params_init(&material, sizeof material);
    material.roughness = NAN;
    report("A parameter that is NaN:", luxfer_scene_add_material(scene, &material, NULL), LUXFER_INVALID_ARGUMENT);
    if (luxfer_render_create(context, &render) != LUXFER_OK) return 1;
    report("A rendering without a scene:", luxfer_render_start(render, NULL, &job), LUXFER_INVALID_OPERATION);
    report("An invalid light path expression:",
           luxfer_render_add_expression(render, "direct", "C<RD>L("), LUXFER_INVALID_ARGUMENT);

    /* The library checks settings when a job starts or runs. The wait for a job gives the status of the work as the
     * outcome, apart from the status of the call. */
    luxfer_render_params_init(&params, sizeof params);
    params.width = params.height = 16;
    luxfer_render_set_scene(render, scene);
    luxfer_render_add_expression(render, "lamp", "C.*<L.'No such lamp'>");
    if (luxfer_render_start(render, &params, &job) != LUXFER_OK) return 1;
    if (luxfer_job_wait(job, -1, NULL, NULL, &outcome) != LUXFER_OK) return 1;
    report("A label that nothing bears:", outcome, LUXFER_NOT_FOUND);
    report("The picture that it would have made:",
           luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &image), LUXFER_NOT_READY);

    /* The outputs are still unchanged. A handle of the wrong kind, or NULL, is an error like any other. */
    if (image != NULL || luxfer_job_wait(NULL, -1, NULL, NULL, &outcome) != LUXFER_INVALID_ARGUMENT) return 1;

    luxfer_release(job);
    luxfer_release(render);
    luxfer_release(scene);
    luxfer_release(context);
    return 0;
}
