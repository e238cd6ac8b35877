/* Long work in a responsive program: progress, cancelling, and intermediate results.
 *
 * Starts a rendering that would take hours, twice: first it waits inside the library, with a progress function that
 * cancels after a second; then it waits in its own loop, as a user interface does. Writes progress_and_cancel.png.
 */
#include "common.h"

/* --8<-- [start:progress] */
/* Progress function. The library calls it about 50 times a second, on the waiting thread, so it may call any function
 * of the library and of the host. */
typedef struct watch {
    luxfer_render *render;
    int calls;
} watch;

static int32_t on_progress(void *user, double fraction) {
    watch *w = user;
    luxfer_render_report report;
    w->calls++;
    /* Results improve while the job runs. The error is unknown before the second path of each pixel. */
    if (w->calls % 10 == 0 && luxfer_render_get_report(w->render, &report, sizeof report) == LUXFER_OK && report.samples > 1)
        printf("%7.3f %%: %u paths per pixel, standard error %.0f %%\n", 100 * fraction, report.samples, 100 * report.error);
    /* A value other than 0 cancels. */
    return w->calls >= 50;
}
/* --8<-- [end:progress] */

/* --8<-- [start:work] */
/* The function of a job: runs on a thread of the library. Its status becomes the status of the job. */
static luxfer_status save(void *user) {
    return luxfer_image_save(user, "progress_and_cancel.png", 1 / 450.0f);
}
/* --8<-- [end:work] */

int main(void) {
    luxfer_scene *scene = NULL;
    luxfer_render *render = NULL;
    luxfer_render_params params;
    luxfer_render_report report;
    luxfer_job *job = NULL;
    luxfer_image *picture = NULL;
    luxfer_status outcome;
    double fraction = 0;
    int frames = 0;
    watch w = {NULL, 0};

    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_STILL_LIFE, &scene), "scene");
    check(luxfer_render_create(context, &render), "render");
    check(luxfer_render_set_scene(render, scene), "render");
    check(luxfer_render_params_init(&params, sizeof params), "render");
    params.width = 200;
    params.height = 150;
    params.samples = 1 << 20;

    /* 1. Waiting inside the library. */
    /* --8<-- [start:wait] */
    w.render = render;
    check(luxfer_render_start(render, &params, &job), "start");
    check(luxfer_job_wait(job, -1, on_progress, &w, &outcome), "wait");
    printf("the job ended with %s\n", luxfer_status_get_name(outcome));
    /* --8<-- [end:wait] */
    luxfer_release(job);
    if (outcome != LUXFER_CANCELLED) return 1;

    /* The passes before the cancel give a picture, with its error. */
    check(luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &picture), "picture");
    check(luxfer_render_get_report(render, &report, sizeof report), "report");
    /* --8<-- [start:start] */
    check(luxfer_job_start(context, save, picture, &job), "start");
    check(luxfer_job_wait(job, -1, NULL, NULL, &outcome), "wait");
    check(outcome, "picture");
    luxfer_release(job);
    /* --8<-- [end:start] */
    printf("%u paths per pixel are in progress_and_cancel.png, with a standard error of %.1f %%\n", report.samples,
           100 * report.error);
    luxfer_release(picture);

    /* 2. Waiting in a loop of the program: wait at most 16 ms, then draw a frame of the user interface. */
    check(luxfer_render_start(render, &params, &job), "start");
    /* --8<-- [start:loop] */
    for (;;) {
        check(luxfer_job_wait(job, 16, NULL, NULL, &outcome), "wait");
        if (outcome != LUXFER_NOT_READY) break;
        check(luxfer_job_get_progress(job, &fraction), "progress");
        /* Any thread may cancel; the work ends within about 100 ms. Releasing the job cancels it too. */
        if (++frames == 20) check(luxfer_job_cancel(job), "cancel");
    }
    /* --8<-- [end:loop] */
    printf("%d frames were drawn until it ended with %s\n", frames, luxfer_status_get_name(outcome));
    luxfer_release(job);

    luxfer_release(render);
    luxfer_release(scene);
    luxfer_release(context);
    return outcome == LUXFER_CANCELLED ? 0 : 1;
}
