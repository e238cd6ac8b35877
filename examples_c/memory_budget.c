/* A memory budget: the limit for images and scenes that a host creates in a context.
 *
 * Creates images in a context of 8 MiB until one does not fit, releases one, and continues.
 */
#include "luxfer.h"

#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 512, MAX_IMAGES = 16 };

/* Creates a grey image of 512 x 512 pixels. It takes 3 MiB, because the library stores all samples as 32-bit
 * floats. */
static luxfer_status load(luxfer_context *context, luxfer_image **image) {
    luxfer_image_view view;
    luxfer_status status = luxfer_image_view_init(&view, sizeof view);
    unsigned char *pixels = calloc(SIDE * SIDE, 3);
    if (!pixels) return LUXFER_OUT_OF_MEMORY;
    view.width = view.height = SIDE;
    view.sample = LUXFER_SAMPLE_U8;
    view.colour_space = LUXFER_COLOUR_SRGB;
    view.data = pixels;
    view.byte_size = (size_t)SIDE * SIDE * 3;
    if (status == LUXFER_OK) status = luxfer_image_create(context, &view, image);
    free(pixels); /* The library has copied the pixels. */
    return status;
}

int main(void) {
    luxfer_context_params params;
    luxfer_context *context = NULL;
    luxfer_image *images[MAX_IMAGES] = {NULL};
    luxfer_status status = luxfer_context_params_init(&params, sizeof params);
    int count = 0, i;

    /* Set the budget and the number of threads; 0 threads means one for each core. */
    params.memory_budget_mib = 8;
    params.num_threads = 1;
    if (status == LUXFER_OK) status = luxfer_context_create(&params, &context);
    if (status != LUXFER_OK) return 1;

    /* --8<-- [start:budget] */
    while (count < MAX_IMAGES && (status = load(context, &images[count])) == LUXFER_OK) count++;
    if (status == LUXFER_OUT_OF_MEMORY) {
        /* The message gives the memory in use. The context remains usable. */
        char message[512] = "";
        luxfer_context_get_last_error(context, message, sizeof message, NULL);
        printf("after %d pictures: %s\n", count, message);
    }
    if (count == 0 || status != LUXFER_OUT_OF_MEMORY) return 1;

    /* A host with a cache would release the least recently used image. */
    luxfer_release(images[0]);
    images[0] = NULL;
    status = load(context, &images[0]);
    printf("after letting go of one: %s\n", luxfer_status_get_name(status));
    /* --8<-- [end:budget] */

    for (i = 0; i < MAX_IMAGES; i++) luxfer_release(images[i]);
    luxfer_release(context);
    return status == LUXFER_OK ? 0 : 1;
}
