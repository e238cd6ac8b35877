/* Draws images of the library side by side on a sheet. */
#ifndef PANELS_H
#define PANELS_H

#include "luxfer.h"

#include <math.h>
#include <stdlib.h>

enum { GAP = 8 };

typedef struct sheet {
    float *pixels;
    int width, height, panel_width, panel_height;
} sheet;

/* Creates an empty sheet for columns x rows panels; its pixels are NULL if memory is short. */
static sheet panels_begin(int columns, int rows, int panel_width, int panel_height) {
    sheet s;
    size_t k, count;
    s.panel_width = panel_width, s.panel_height = panel_height;
    s.width = columns * (panel_width + GAP) + GAP;
    s.height = rows * (panel_height + GAP) + GAP;
    count = (size_t)s.width * s.height * 3;
    s.pixels = malloc(count * sizeof *s.pixels);
    for (k = 0; s.pixels && k < count; k++) s.pixels[k] = 0.05f;
    return s;
}

/* Reads all pixels of an image as packed floats; the caller frees them. */
static float *panels_pixels(luxfer_image *image, luxfer_image_view *view) {
    float *data = NULL;
    if (luxfer_image_view_init(view, sizeof *view) != LUXFER_OK) return NULL;
    if (luxfer_image_get_size(image, &view->width, &view->height, &view->channels) != LUXFER_OK) return NULL;
    view->byte_size = (size_t)view->width * view->height * view->channels * sizeof *data;
    data = malloc(view->byte_size);
    view->data = data;
    if (data && luxfer_image_read(image, 0, view) != LUXFER_OK) {
        free(data);
        return NULL;
    }
    return data;
}

/* Scales an image down into a panel of the sheet, keeping its aspect ratio. */
static void panels_add(sheet *s, int column, int row, luxfer_image *image, float exposure) {
    luxfer_image_view v;
    float *data = panels_pixels(image, &v);
    double scale;
    int x, y, c, w, h, left, top;
    if (!data || !s->pixels) {
        free(data);
        return;
    }
    scale = fmin((double)s->panel_width / v.width, (double)s->panel_height / v.height);
    w = (int)(v.width * scale), h = (int)(v.height * scale);
    left = GAP + column * (s->panel_width + GAP) + (s->panel_width - w) / 2;
    top = GAP + row * (s->panel_height + GAP) + (s->panel_height - h) / 2;
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

/* Saves the sheet and frees it. */
static luxfer_status panels_save(sheet *s, luxfer_context *context, const char *file) {
    luxfer_image_view view;
    luxfer_image *image = NULL;
    luxfer_status status = luxfer_image_view_init(&view, sizeof view);
    if (!s->pixels) return LUXFER_OUT_OF_MEMORY;
    view.width = (uint32_t)s->width;
    view.height = (uint32_t)s->height;
    view.byte_size = (size_t)s->width * s->height * 3 * sizeof *s->pixels;
    view.data = s->pixels;
    if (status == LUXFER_OK) status = luxfer_image_create(context, &view, &image);
    if (status == LUXFER_OK) status = luxfer_image_save(image, file, 1);
    luxfer_release(image);
    free(s->pixels);
    return status;
}

#endif
