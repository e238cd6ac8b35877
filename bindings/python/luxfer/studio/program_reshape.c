/* [start reshaped] */

/* Fills `m` with the map, row by row, of the unit square to four corners. */
static void square_to(const double corners[8], double m[9]) {
    const double x0 = corners[0], y0 = corners[1], x1 = corners[2], y1 = corners[3];
    const double x2 = corners[4], y2 = corners[5], x3 = corners[6], y3 = corners[7];
    const double dx1 = x1 - x2, dy1 = y1 - y2, dx2 = x3 - x2, dy2 = y3 - y2;
    const double sx = x0 - x1 + x2 - x3, sy = y0 - y1 + y2 - y3;
    const double below = dx1 * dy2 - dx2 * dy1;
    const double g = (sx * dy2 - dx2 * sy) / below, h = (dx1 * sy - sx * dy1) / below;
    m[0] = x1 - x0 + g * x1, m[1] = x3 - x0 + h * x3, m[2] = x0;
    m[3] = y1 - y0 + g * y1, m[4] = y3 - y0 + h * y3, m[5] = y0;
    m[6] = g, m[7] = h, m[8] = 1;
}

/* Fills `out` with the inverse of a map, up to a factor. */
static void invert(const double m[9], double out[9]) {
    const double a = m[0], b = m[1], c = m[2], d = m[3], e = m[4], f = m[5], g = m[6], h = m[7], i = m[8];
    out[0] = e * i - f * h, out[1] = c * h - b * i, out[2] = b * f - c * e;
    out[3] = f * g - d * i, out[4] = a * i - c * g, out[5] = c * d - a * f;
    out[6] = d * h - e * g, out[7] = b * g - a * h, out[8] = a * e - b * d;
}

static void map_to(const double m[9], double x, double y, double out[2]) {
    const double w = m[6] * x + m[7] * y + m[8];
    out[0] = (m[0] * x + m[1] * y + m[2]) / w;
    out[1] = (m[3] * x + m[4] * y + m[5]) / w;
}

/* The photo, the mask of its lights and that of its plane, before and after, and the lamp on each pixel, from 1. */
typedef struct edit {
    float *photo, *mask, *plane, *new_photo, *new_mask;
    unsigned char *is_lit;
    int *labels, width, height, channels;
} edit;

/* Fills the place of a lamp with the mean colour of the plane around it. */
static void cut_out(const edit *e, int label) {
    int x, y, c, x0 = e->width, x1 = 0, y0 = e->height, y1 = 0;
    double sums[4] = {0, 0, 0, 0}, count = 0;
    for (y = 0; y < e->height; y++)
        for (x = 0; x < e->width; x++) {
            if (e->labels[y * e->width + x] != label) continue;
            x0 = x < x0 ? x : x0, x1 = x + 1 > x1 ? x + 1 : x1;
            y0 = y < y0 ? y : y0, y1 = y + 1 > y1 ? y + 1 : y1;
        }
    for (y = y0 > y1 - y0 ? 2 * y0 - y1 : 0; y < e->height && y < 2 * y1 - y0; y++)
        for (x = x0 > x1 - x0 ? 2 * x0 - x1 : 0; x < e->width && x < 2 * x1 - x0; x++) {
            const int at = y * e->width + x;
            if (!(e->plane[at] > 0.5f) || e->is_lit[at]) continue;
            for (c = 0; c < e->channels; c++) sums[c] += e->photo[e->channels * at + c];
            count += 1;
        }
    for (y = y0; y < y1; y++)
        for (x = x0; x < x1; x++) {
            const int at = y * e->width + x;
            if (e->labels[at] != label) continue;
            e->new_mask[at] = 0;
            for (c = 0; c < e->channels; c++)
                e->new_photo[e->channels * at + c] = (float)(count > 0 ? sums[c] / count : 0);
        }
}

/* Returns the range of pixels around one coordinate of four corners. */
static void range_of(const double *corners, int limit, int range[2]) {
    double low = corners[0], high = corners[0], beyond;
    int i;
    for (i = 1; i < 4; i++) low = fmin(low, corners[2 * i]), high = fmax(high, corners[2 * i]);
    beyond = beyond_lamp * (high - low);
    range[0] = (int)fmax(0, floor(low - beyond));
    range[1] = (int)fmin(limit, floor(high + beyond) + 1);
}

/* Puts the pixels of a lamp into its new rectangle. */
static void put_back(const edit *e, int label, const double before[8], const double after[8]) {
    double forward[9], of_after[9], inverse[9], uv[2];
    int x, y, xs[2], ys[2];
    square_to(before, forward);
    square_to(after, of_after);
    invert(of_after, inverse);
    range_of(after, e->width, xs);
    range_of(after + 1, e->height, ys);
    for (y = ys[0]; y < ys[1]; y++)
        for (x = xs[0]; x < xs[1]; x++) {
            const int to = y * e->width + x;
            int from;
            map_to(inverse, x + 0.5, y + 0.5, uv);
            map_to(forward, uv[0], uv[1], uv);
            if (!(uv[0] >= 0 && uv[0] < e->width && uv[1] >= 0 && uv[1] < e->height)) continue;
            from = (int)uv[1] * e->width + (int)uv[0];
            if (e->labels[from] != label) continue;
            memcpy(e->new_photo + e->channels * to, e->photo + e->channels * from, sizeof(float) * (size_t)e->channels);
            e->new_mask[to] = e->mask[from];
        }
}

/* Finds the lamps that are reshaped, and returns the number of each; 0 if it is not there. */
static int *find_reshaped(const edit *e) {
    int *found = (int *)allocate(reshaped_lamp_count, sizeof(int));
    size_t k;
    for (k = 0; k < reshaped_lamp_count; k++) {
        const double *at = reshaped_lamps[k];
        const int start = nearest_lit(e->is_lit, e->width, e->height, at[0], at[1], max_lamp_distance * e->width);
        if (start < 0) continue;
        if (!e->labels[start]) fill(e->is_lit, e->labels, e->width, e->height, start, (int)k + 1);
        found[k] = e->labels[start];
    }
    return found;
}

/* Moves, resizes and turns lamps in the photo and in the mask of its lights. */
static void reshape_lamps(luxfer_transfer **transfers, luxfer_image *photo) {
    luxfer_image *mask = NULL, *plane = NULL, *changed;
    uint32_t width, height, channels;
    size_t k, pixels;
    int *found, i;
    edit e;
    check(luxfer_transfer_get_image(transfers[0], LUXFER_TRANSFER_LIGHTS_MASK, &mask), "mask");
    check(luxfer_transfer_get_image(transfers[0], LUXFER_TRANSFER_PLANE_MASK, &plane), "mask");
    e.mask = pixels_of(mask, &width, &height, &channels);
    e.plane = pixels_of(plane, &width, &height, &channels);
    e.new_mask = pixels_of(mask, &width, &height, &channels);
    e.photo = pixels_of(photo, &width, &height, &channels);
    e.new_photo = pixels_of(photo, &width, &height, &channels);
    e.width = (int)width, e.height = (int)height, e.channels = (int)channels;
    pixels = (size_t)width * height;
    e.is_lit = (unsigned char *)allocate(pixels, 1);
    e.labels = (int *)allocate(pixels, sizeof(int));
    for (i = 0; i < (int)pixels; i++) e.is_lit[i] = e.mask[i] > 0.5f;
    found = find_reshaped(&e);
    for (k = 0; k < reshaped_lamp_count; k++)
        if (found[k]) cut_out(&e, found[k]);
    for (k = 0; k < reshaped_lamp_count; k++)
        if (found[k]) put_back(&e, found[k], reshaped_lamps[k] + 2, reshaped_lamps[k] + 10);
    changed = image_of(e.new_photo, width, height, channels);
    for (k = 0; k < placement_count; k++) check(luxfer_transfer_set_photo(transfers[k], changed), "photo");
    luxfer_release(changed);
    changed = image_of(e.new_mask, width, height, 1);
    for (k = 0; k < placement_count; k++)
        check(luxfer_transfer_use_mask(transfers[k], LUXFER_PHASE_LIGHTS, changed), "mask");
    luxfer_release(changed), luxfer_release(mask), luxfer_release(plane);
    free(found), free(e.labels), free(e.is_lit);
    free(e.new_photo), free(e.photo), free(e.new_mask), free(e.plane), free(e.mask);
}
/* [end reshaped] */
