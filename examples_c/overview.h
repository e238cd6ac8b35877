/* Draws a sheet of pictures with the steps of a lighting transfer. Upper row: the photo, the mask of the plane, the
 * mask of the lights, the unwarped plane. Lower row: the emissive texture; the scene before the transfer, in white
 * light, and in the light of the photo. */
#ifndef OVERVIEW_H
#define OVERVIEW_H

#include "panels.h"

enum { COLUMNS = 4, ROWS = 2 };

/* Draws the sheet and saves it. */
static luxfer_status overview_save(luxfer_context *context, luxfer_transfer *transfer, luxfer_image *photo,
                                   luxfer_image *before, luxfer_image *white, luxfer_image *lit, float white_luminance,
                                   const char *file) {
    static const luxfer_transfer_image steps[4] = {LUXFER_TRANSFER_PLANE_CONFIDENCE, LUXFER_TRANSFER_LIGHTS_CONFIDENCE,
                                                   LUXFER_TRANSFER_UNWARPED, LUXFER_TRANSFER_EMISSION};
    luxfer_image *image = NULL;
    sheet s = panels_begin(COLUMNS, ROWS, 480, 320);
    int i;
    panels_add(&s, 0, 0, photo, 1);
    for (i = 0; i < 4; i++) {
        if (luxfer_transfer_get_image(transfer, steps[i], &image) != LUXFER_OK) continue;
        panels_add(&s, (i + 1) % COLUMNS, (i + 1) / COLUMNS, image, 1);
        luxfer_release(image);
    }
    panels_add(&s, 1, 1, before, 1 / white_luminance);
    panels_add(&s, 2, 1, white, 1 / white_luminance);
    panels_add(&s, 3, 1, lit, 1 / white_luminance);
    return panels_save(&s, context, file);
}

#endif
