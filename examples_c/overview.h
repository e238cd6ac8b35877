/* A sheet of all that a lighting transfer went through. Above: photo, mask of the plane, mask of the lights, the plane
 * unwarped. Below: emissive texture, scene before, in white light, in the light of the photo. */
#ifndef OVERVIEW_H
#define OVERVIEW_H

#include "luxfer.h"

#include <math.h>
#include <stdlib.h>

enum { PANEL_WIDTH = 480, PANEL_HEIGHT = 320, GAP = 8, COLUMNS = 4, ROWS = 2 };

typedef struct sheet {
    float *pixels;
    int width, height;
} sheet;

/* All pixels of an image as packed floats; the caller frees them. */
static float *overview_pixels(luxfer_image *image, luxfer_image_view *view) {
    float *data = NULL;
    if (luxfer_image_view_init(view, sizeof *view) != LUXFER_OK) return NULL;
    if (luxfer_image_size(image, &view->width, &view->height, &view->channels) != LUXFER_OK) return NULL;
    view->byte_size = (size_t)view->width * view->height * view->channels * sizeof *data;
    data = malloc(view->byte_size);
    view->data = data;
    if (data && luxfer_image_read(image, 0, view) != LUXFER_OK) {
        free(data);
        return NULL;
    }
    return data;
}

/* Averages an image into a panel of the sheet, keeping its shape. */
static void overview_panel(sheet *s, int column, int row, luxfer_image *image, float exposure) {
    luxfer_image_view v;
    float *data = overview_pixels(image, &v);
    double scale;
    int x, y, c, w, h, left, top;
    if (!data) return;
    scale = fmin((double)PANEL_WIDTH / v.width, (double)PANEL_HEIGHT / v.height);
    w = (int)(v.width * scale), h = (int)(v.height * scale);
    left = GAP + column * (PANEL_WIDTH + GAP) + (PANEL_WIDTH - w) / 2;
    top = GAP + row * (PANEL_HEIGHT + GAP) + (PANEL_HEIGHT - h) / 2;
    for (y = 0; y < h; y++)
        for (x = 0; x < w; x++)
            for (c = 0; c < 3; c++) {
                unsigned x0 = (unsigned)(x / scale), x1 = (unsigned)fmin(fmax((x + 1) / scale, x0 + 1.0), v.width);
                unsigned y0 = (unsigned)(y / scale), y1 = (unsigned)fmin(fmax((y + 1) / scale, y0 + 1.0), v.height);
                unsigned i, j, channel = v.channels >= 3 ? (unsigned)c : 0;
                double sum = 0;
                for (j = y0; j < y1; j++)
                    for (i = x0; i < x1; i++)
                        sum += fmin(data[((size_t)j * v.width + i) * v.channels + channel] * exposure, 1);
                s->pixels[((size_t)(top + y) * s->width + left + x) * 3 + c] = (float)(sum / ((x1 - x0) * (y1 - y0)));
            }
    free(data);
}

/* Draws the sheet and saves it. */
static luxfer_status overview_save(luxfer_context *context, luxfer_transfer *transfer, luxfer_image *photo,
                                   luxfer_image *before, luxfer_image *white, luxfer_image *lit, float white_luminance,
                                   const char *file) {
    static const luxfer_transfer_image steps[4] = {LUXFER_TRANSFER_PLANE_CONFIDENCE, LUXFER_TRANSFER_LIGHTS_CONFIDENCE,
                                                   LUXFER_TRANSFER_UNWARPED, LUXFER_TRANSFER_EMISSION};
    luxfer_image_view view;
    luxfer_image *image = NULL;
    luxfer_status status;
    sheet s;
    int i;
    size_t k, count;
    s.width = COLUMNS * (PANEL_WIDTH + GAP) + GAP;
    s.height = ROWS * (PANEL_HEIGHT + GAP) + GAP;
    count = (size_t)s.width * s.height * 3;
    s.pixels = malloc(count * sizeof *s.pixels);
    if (!s.pixels) return LUXFER_OUT_OF_MEMORY;
    for (k = 0; k < count; k++) s.pixels[k] = 0.05f;

    overview_panel(&s, 0, 0, photo, 1);
    for (i = 0; i < 4; i++) {
        if (luxfer_transfer_get_image(transfer, steps[i], &image) != LUXFER_OK) continue;
        overview_panel(&s, (i + 1) % COLUMNS, (i + 1) / COLUMNS, image, 1);
        luxfer_image_release(image);
    }
    overview_panel(&s, 1, 1, before, 1 / white_luminance);
    overview_panel(&s, 2, 1, white, 1 / white_luminance);
    overview_panel(&s, 3, 1, lit, 1 / white_luminance);

    status = luxfer_image_view_init(&view, sizeof view);
    view.width = (uint32_t)s.width;
    view.height = (uint32_t)s.height;
    view.byte_size = count * sizeof *s.pixels;
    view.data = s.pixels;
    if (status == LUXFER_OK) status = luxfer_image_create(context, &view, &image);
    if (status == LUXFER_OK) status = luxfer_image_save(image, file, 1);
    luxfer_image_release(image);
    free(s.pixels);
    return status;
}

#endif
