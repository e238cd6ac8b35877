/* Functions that all examples share: they end the program with the library's message on an error, and wait for
 * jobs. */
#ifndef COMMON_H
#define COMMON_H

#include "luxfer.h"

#include <stdio.h>
#include <stdlib.h>
#ifdef _WIN32
#include <io.h>
#define isatty _isatty
#else
int isatty(int file);
#endif

static luxfer_context *context;

/* Ends the program with the library's message if a call has failed. */
static inline void check(luxfer_status status, const char *what) {
    char message[1024] = "";
    if (status == LUXFER_OK) return;
    if (context) luxfer_context_get_last_error(context, message, sizeof message, NULL);
    fprintf(stderr, "\n%s: %s (%s)\n", what, message, luxfer_status_get_name(status));
    exit(1);
}

static inline int show_progress(void *title, double fraction) {
    char bar[41];
    int i, filled = (int)(fraction * 40);
    for (i = 0; i < 40; i++) bar[i] = i < filled ? '#' : '.';
    bar[40] = 0;
    fprintf(stderr, "\r%-24s [%s] %3d %%%s", (const char *)title, bar, (int)(fraction * 100), fraction == 1 ? "\n" : "");
    return 0;
}

/* Waits for a job, with a progress bar in a terminal, and releases it. */
static inline void wait_and_release(luxfer_job *job, const char *title) {
    luxfer_status outcome;
    check(luxfer_job_wait(job, -1, isatty(2) ? show_progress : NULL, (void *)title, &outcome), title);
    check(outcome, title);
    check(luxfer_release(job), title);
}

/* --8<-- [start:warnings] */
/* Prints each warning with its remedy, its place in the photo and its code, and releases the list. */
static inline void print_warnings(luxfer_warnings *warnings) {
    static const char *stages[] = {"view", "features", "plane", "lights", "unwarp", "emission", "relight", "render"};
    luxfer_warning warning;
    uint32_t i, count = 0;
    check(luxfer_warnings_get_count(warnings, &count), "warnings");
    for (i = 0; i < count; i++) {
        check(luxfer_warnings_get(warnings, i, &warning, sizeof warning), "warning");
        fprintf(stderr, "%s: %s\n    %s", stages[warning.stage], warning.message, warning.advice);
        if (warning.has_place) fprintf(stderr, " (at %.0f, %.0f)", warning.place[0], warning.place[1]);
        fprintf(stderr, " [%s]\n", luxfer_warning_get_name(warning.code));
    }
    check(luxfer_release(warnings), "warnings");
}
/* --8<-- [end:warnings] */

/* Takes a photo of the generated office. To load your own photo, use luxfer_image_load. */
static inline luxfer_image *take_photo(uint32_t width, uint32_t height, uint32_t samples) {
    luxfer_demo_photo_params params;
    luxfer_demo_photo *demo = NULL;
    luxfer_image *photo = NULL;
    luxfer_job *job = NULL;
    check(luxfer_demo_photo_params_init(&params, sizeof params), "photo");
    params.width = width;
    params.height = height;
    params.samples = samples;
    check(luxfer_demo_photo_create(context, &demo), "photo");
    check(luxfer_demo_photo_start(demo, &params, &job), "photo");
    wait_and_release(job, "taking the photo");
    check(luxfer_demo_photo_get_image(demo, LUXFER_DEMO_PHOTO_PICTURE, &photo), "photo");
    check(luxfer_release(demo), "photo");
    return photo;
}

#endif
