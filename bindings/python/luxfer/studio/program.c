/* Lights a room as in a photo: written by luxfer studio. It is C11, and C++17 too. Where luxfer is installed:
 *
 *     cc -ffp-contract=off FILE.c $(pkg-config --cflags --libs luxfer) -lm -o program
 *     ./program [PHOTO ROOM]
 *
 * It writes lit.glb, luminaires.csv, render.exr and render.png into the current folder.
 */
#include <luxfer.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* [data] */

static luxfer_context *context = NULL;

/* Ends the program with the library's message if a call has failed. */
static void check(luxfer_status status, const char *what) {
    char message[1024] = "";
    if (status == LUXFER_OK) return;
    if (context) luxfer_context_get_last_error(context, message, sizeof message, NULL);
    fprintf(stderr, "%s: %s (%s)\n", what, message, luxfer_status_get_name(status));
    exit(1);
}

/* Waits for a job and releases it. */
static void finish(luxfer_job *job, const char *what) {
    luxfer_status outcome = LUXFER_OK;
    check(luxfer_job_wait(job, -1, NULL, NULL, &outcome), what);
    check(outcome, what);
    check(luxfer_release(job), what);
}

static void run(luxfer_transfer *transfer, luxfer_stage first, luxfer_stage last, const luxfer_transfer_params *params,
                const char *what) {
    luxfer_job *job = NULL;
    check(luxfer_transfer_start(transfer, first, last, params, &job), what);
    finish(job, what);
}

static void set_strokes(luxfer_transfer *transfer, luxfer_image *photo) {
    luxfer_strokes *set = NULL;
    uint32_t width = 0, height = 0;
    size_t i;
    check(luxfer_image_get_size(photo, &width, &height, NULL), "photo");
    check(luxfer_strokes_create(context, width, height, &set), "strokes");
    for (i = 0; i < stroke_count; i++)
        check(luxfer_strokes_add(set, strokes[i].phase, points + 2 * strokes[i].first, strokes[i].count,
                                 strokes[i].radius, strokes[i].positive),
              "strokes");
    check(luxfer_transfer_set_strokes(transfer, set), "strokes");
    check(luxfer_release(set), "strokes");
}

/* [start pixels] */
static void *allocate(size_t count, size_t size) {
    void *place = calloc(count > 0 ? count : 1, size);
    if (place) return place;
    fprintf(stderr, "out of memory\n");
    exit(1);
}

/* Describes packed float pixels. */
static luxfer_image_view view_of(float *pixels, uint32_t width, uint32_t height, uint32_t channels) {
    luxfer_image_view view;
    check(luxfer_image_view_init(&view, sizeof view), "pixels");
    view.channels = channels;
    view.width = width;
    view.height = height;
    view.byte_size = sizeof(float) * channels * width * height;
    view.data = pixels;
    return view;
}

static luxfer_image *image_of(float *pixels, uint32_t width, uint32_t height, uint32_t channels) {
    const luxfer_image_view view = view_of(pixels, width, height, channels);
    luxfer_image *image = NULL;
    check(luxfer_image_create(context, &view, &image), "pixels");
    return image;
}

/* [end pixels] */
/* [start read] */
/* Returns a copy of the pixels of an image, which the caller frees. */
static float *pixels_of(luxfer_image *image, uint32_t *width, uint32_t *height, uint32_t *channels) {
    luxfer_image_view view;
    float *pixels;
    check(luxfer_image_get_size(image, width, height, channels), "image");
    pixels = (float *)allocate((size_t)*width * *height * *channels, sizeof(float));
    view = view_of(pixels, *width, *height, *channels);
    check(luxfer_image_read(image, 0, &view), "image");
    return pixels;
}
/* [end read] */
/* [start regions] */

/* Writes the number `label` on the region of pixels that are 1 in `is_lit`, joined by their sides, around `start`. */
static void fill(const unsigned char *is_lit, int *labels, int width, int height, int start, int label) {
    int *waiting = (int *)allocate((size_t)width * (size_t)height, sizeof(int));
    int count = 0;
    labels[start] = label;
    waiting[count++] = start;
    while (count > 0) {
        const int at = waiting[--count], x = at % width;
        const int beside[4] = {x > 0 ? at - 1 : -1, x < width - 1 ? at + 1 : -1, at - width, at + width};
        int i;
        for (i = 0; i < 4; i++) {
            const int next = beside[i];
            if (next < 0 || next >= width * height || !is_lit[next] || labels[next]) continue;
            labels[next] = label;
            waiting[count++] = next;
        }
    }
    free(waiting);
}
/* [end regions] */
/* [start nearest] */

/* Returns the lit pixel nearest to a point, within `max_distance` pixels along each axis; -1 if no pixel is. */
static int nearest_lit(const unsigned char *is_lit, int width, int height, double x, double y, double max_distance) {
    const int x0 = (int)fmax(0, x - max_distance), x1 = (int)fmin(width, x + max_distance + 1);
    const int y0 = (int)fmax(0, y - max_distance), y1 = (int)fmin(height, y + max_distance + 1);
    double smallest = INFINITY;
    int i, j, found = -1;
    for (j = y0; j < y1; j++)
        for (i = x0; i < x1; i++) {
            const double dx = i + 0.5 - x, dy = j + 0.5 - y, distance = dx * dx + dy * dy;
            if (!is_lit[j * width + i] || distance >= smallest) continue;
            smallest = distance;
            found = j * width + i;
        }
    return found;
}
/* [end nearest] */
/* [start removed] */

/* Takes lamps of the photo out of the mask of the lights. */
static void take_out(luxfer_transfer **transfers) {
    luxfer_image *mask = NULL, *changed;
    uint32_t width, height, channels;
    float *values;
    unsigned char *is_lit;
    int *labels, i;
    size_t k;
    check(luxfer_transfer_get_image(transfers[0], LUXFER_TRANSFER_LIGHTS_MASK, &mask), "mask");
    values = pixels_of(mask, &width, &height, &channels);
    is_lit = (unsigned char *)allocate((size_t)width * height, 1);
    labels = (int *)allocate((size_t)width * height, sizeof(int));
    for (i = 0; i < (int)(width * height); i++) is_lit[i] = values[i] > 0.5f;
    for (k = 0; k < removed_lamp_count; k++) {
        const double *at = removed_lamps[k];
        const int start = nearest_lit(is_lit, (int)width, (int)height, at[0], at[1], max_lamp_distance * width);
        if (start >= 0 && !labels[start]) fill(is_lit, labels, (int)width, (int)height, start, 1);
    }
    for (i = 0; i < (int)(width * height); i++)
        if (labels[i]) values[i] = 0;
    changed = image_of(values, width, height, 1);
    for (k = 0; k < placement_count; k++)
        check(luxfer_transfer_use_mask(transfers[k], LUXFER_PHASE_LIGHTS, changed), "mask");
    free(labels), free(is_lit), free(values);
    luxfer_release(changed), luxfer_release(mask);
}
/* [end removed] */
/* [file reshape] */
/* [start grid] */

/* Draws a line in a cell of a picture, along (dx, dy) through the middle of the cell; `side` is the cell's length. */
static void draw_line(float *pixels, uint32_t width, const uint32_t box[4], const double middle[2], double dx,
                      double dy, double side) {
    uint32_t x, y, c;
    for (y = box[1]; y < box[3]; y++)
        for (x = box[0]; x < box[2]; x++) {
            const double px = x + 0.5 - middle[0], py = y + 0.5 - middle[1];
            const double along = (px * dx + py * dy) / (half_length * side), across = (py * dx - px * dy) / half_width;
            const double near_line = fmax(0, 1 - across * across), inside = fmax(0, 1 - along * along);
            for (c = 0; c < 3; c++)
                pixels[3 * ((size_t)y * width + x) + c] =
                    (float)(0.5 + contrast * across * near_line * near_line * inside);
        }
}

/* Draws lines to the vanishing points of the room axes, one in each cell: the library finds cameras from lines. */
static luxfer_image *draw(uint32_t width, uint32_t height) {
    const uint32_t longer = width > height ? width : height;
    const uint32_t cells = longer / cell < min_cells   ? min_cells
                           : longer / cell > max_cells ? max_cells
                                                       : longer / cell;
    const double side = (double)longer / cells;
    const uint32_t columns = (uint32_t)fmax(1, floor(width / side + 0.5));
    const uint32_t rows = (uint32_t)fmax(1, floor(height / side + 0.5));
    float *pixels = (float *)allocate(3 * (size_t)width * height, sizeof(float));
    luxfer_image *image;
    uint32_t i, j;
    size_t k;
    for (k = 0; k < 3 * (size_t)width * height; k++) pixels[k] = 0.5f;
    for (j = 0; j < rows; j++)
        for (i = 0; i < columns; i++) {
            const double middle[2] = {(i + 0.5) * width / columns, (j + 0.5) * height / rows};
            const double *axis = photo_axes[(i + j) % 3];
            const double dx = photo_focal * axis[0] + (width / 2.0 - middle[0]) * axis[2];
            const double dy = photo_focal * axis[1] + (height / 2.0 - middle[1]) * axis[2];
            const double length = sqrt(dx * dx + dy * dy);
            const uint32_t box[4] = {i * width / columns, j * height / rows, (i + 1) * width / columns,
                                     (j + 1) * height / rows};
            if (length <= side * fabs(axis[2])) continue; /* lines near a vanishing point run in all directions */
            draw_line(pixels, width, box, middle, dx / length, dy / length, side);
        }
    image = image_of(pixels, width, height, 3);
    free(pixels);
    return image;
}

/* Returns the index of the room axis of a camera that is nearest to a direction. */
static int32_t nearest_axis(const luxfer_rectify_report *found, const double direction[3]) {
    double largest = -1;
    int32_t i, out = 0;
    for (i = 0; i < 3; i++) {
        const double *axis = found->axes[i];
        const double alike = fabs(axis[0] * direction[0] + axis[1] * direction[1] + axis[2] * direction[2]);
        if (alike <= largest) continue;
        largest = alike;
        out = i;
    }
    return out;
}

/* Replaces the camera of the photo, and sets the axes that the plane spans. */
static void use_grid(luxfer_transfer *transfer, luxfer_image *photo, luxfer_rectify_params *plane) {
    luxfer_rectify *rectify = NULL;
    luxfer_rectify_params params;
    luxfer_rectify_report found;
    luxfer_image *drawing;
    luxfer_job *job = NULL;
    uint32_t width = 0, height = 0;
    check(luxfer_image_get_size(photo, &width, &height, NULL), "photo");
    drawing = draw(width, height);
    check(luxfer_rectify_params_init(&params, sizeof params), "grid");
    params.focal = photo_focal;
    params.distortion = 0;
    check(luxfer_rectify_create(context, &rectify), "grid");
    check(luxfer_rectify_set_photo(rectify, drawing), "grid");
    check(luxfer_rectify_start(rectify, &params, &job), "grid");
    finish(job, "grid");
    check(luxfer_rectify_get_report(rectify, &found, sizeof found), "grid");
    check(luxfer_transfer_use_rectify(transfer, rectify), "grid");
    check(luxfer_rectify_params_init(plane, sizeof *plane), "grid");
    plane->plane_axes[0] = nearest_axis(&found, photo_axes[0]);
    plane->plane_axes[1] = nearest_axis(&found, photo_axes[1]);
    luxfer_release(rectify), luxfer_release(drawing);
}
/* [end grid] */
/* [file mix] */

/* Renders the lit room as the studio shows it. */
static void render_room(luxfer_scene *lit) {
    luxfer_camera_params camera;
    luxfer_render_params params;
    luxfer_render *render = NULL;
    luxfer_image *picture = NULL;
    luxfer_job *job = NULL;
    check(luxfer_camera_params_init(&camera, sizeof camera), "camera");
    memcpy(camera.position, camera_position, sizeof camera.position);
    memcpy(camera.target, camera_target, sizeof camera.target);
    camera.fov_y = camera_fov_y;
    check(luxfer_render_params_init(&params, sizeof params), "picture");
    params.width = picture_width;
    params.height = picture_height;
    params.preview = 1;
    /* [render] */
    check(luxfer_render_create(context, &render), "picture");
    check(luxfer_render_set_scene(render, lit), "picture");
    check(luxfer_render_set_camera(render, &camera), "picture");
    check(luxfer_render_start(render, &params, &job), "picture");
    finish(job, "picture");
    check(luxfer_render_write_exr(render, "render.exr"), "render.exr");
    check(luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, &picture), "picture");
    check(luxfer_image_save(picture, "render.png", exposure), "render.png");
    luxfer_release(picture), luxfer_release(render);
}

/* Returns the lamps of a surface, with room for the added ones; the caller frees them. */
static luxfer_fixture *lamps_of(luxfer_transfer *transfer, const placement *on, size_t *count) {
    luxfer_transfer_report report;
    luxfer_fixture *lamps;
    size_t i;
    check(luxfer_transfer_get_report(transfer, &report, sizeof report), "report");
    *count = report.fixtures;
    lamps = (luxfer_fixture *)calloc(*count + on->added_count + 1, sizeof(luxfer_fixture));
    if (!lamps) exit(1);
    for (i = 0; i < *count; i++)
        check(luxfer_transfer_get_fixture(transfer, (uint32_t)i, &lamps[i], sizeof lamps[i]), "lamps");
    return lamps;
}

/* Writes the lit room, the schedule of its lamps, and the picture. */
static void write_results(luxfer_transfer **transfers, luxfer_scene *room) {
    luxfer_scene *lit = NULL;
    size_t count, i, k;
    /* [start mix] */
    FILE *file = begin_schedule("luminaires.csv");
    /* [end mix] */
    check(luxfer_transfer_get_scene(transfers[0], LUXFER_SCENE_LIT, &lit), "lit room");
    for (k = 0; k < placement_count; k++) {
        const placement *on = &placements[k];
        luxfer_fixture *lamps = lamps_of(transfers[k], on, &count);
        /* [start plain] */
        (void)room;
        check(luxfer_transfer_save_fixtures(transfers[k], "luminaires.csv"), "luminaires.csv");
        /* [end plain] */
        /* [start mix] */
        mix_lamps(room, lit, on, lamps, count);
        count = mix_list(room, on, lamps, count);
        write_lamps(file, on, lamps, count);
        /* [end mix] */
        for (i = 0; i < count; i++)
            printf("kind %u: %.0f lm, %.0f K at [%.2f, %.2f, %.2f]\n", (unsigned)lamps[i].kind, lamps[i].flux,
                   lamps[i].cct, lamps[i].position[0], lamps[i].position[1], lamps[i].position[2]);
        free(lamps);
    }
    /* [start mix] */
    fclose(file);
    /* [end mix] */
    check(luxfer_scene_export(lit, "lit.glb"), "lit.glb");
    render_room(lit);
    luxfer_release(lit);
}

/* Settings of a transfer. */
typedef struct settings {
    luxfer_transfer_params params;
    luxfer_pattern_params pattern;
    luxfer_relight_params relight;
    luxfer_rectify_params plane;
} settings;

static void fill_settings(settings *of, const placement *on) {
    check(luxfer_transfer_params_init(&of->params, sizeof of->params), "settings");
    check(luxfer_pattern_params_init(&of->pattern, sizeof of->pattern), "settings");
    check(luxfer_relight_params_init(&of->relight, sizeof of->relight), "settings");
    of->pattern.scale = on->scale;
    of->pattern.length = on->length;
    of->pattern.rotation = on->rotation;
    memcpy(of->pattern.offset, on->offset, sizeof on->offset);
    of->pattern.margin = on->margin;
    /* [settings] */
    of->params.pattern = &of->pattern;
    of->params.relight = &of->relight;
}

/* Makes the texture of each surface from the photo, and solves for the strength of all. */
static void transfer_light(luxfer_transfer **transfers, luxfer_image *photo) {
    settings all[placement_count];
    const luxfer_transfer_params *params[placement_count];
    luxfer_job *job = NULL;
    size_t k;
    (void)photo;
    for (k = 0; k < placement_count; k++) {
        fill_settings(&all[k], &placements[k]);
        params[k] = &all[k].params;
        run(transfers[k], LUXFER_STAGE_VIEW, LUXFER_STAGE_LIGHTS, NULL, "masks");
        check(luxfer_transfer_set_zones(transfers[k], zones[placements[k].first_zone], placements[k].zone_count),
              "zones");
    }
    /* [start removed] */
    take_out(transfers);
    /* [end removed] */
    /* [start grid] */
    for (k = 0; k < placement_count; k++) {
        use_grid(transfers[k], photo, &all[k].plane);
        all[k].params.rectify = &all[k].plane;
    }
    /* [end grid] */
    /* [start reshaped] */
    reshape_lamps(transfers, photo);
    /* [end reshaped] */
    for (k = 0; k < placement_count; k++)
        run(transfers[k], LUXFER_STAGE_UNWARP, LUXFER_STAGE_UNWARP, params[k], "plane");
    check(luxfer_transfer_start_all(context, transfers, placement_count, LUXFER_STAGE_EMISSION, LUXFER_STAGE_RELIGHT,
                                    params, &job), "light");
    finish(job, "light");
}

int main(int argc, char **argv) {
    const char *photo_path = argc > 1 ? argv[1] : photo_file, *room_path = argc > 2 ? argv[2] : room_file;
    luxfer_transfer *transfers[placement_count];
    luxfer_image *photo = NULL;
    luxfer_scene *room = NULL;
    size_t k;
    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_image_load(context, photo_path, LUXFER_COLOUR_SRGB, &photo), photo_path);
    if (*room_path) check(luxfer_scene_load(context, room_path, NULL, &room), room_path);
    else check(luxfer_demo_create_scene(context, LUXFER_DEMO_TARGET_ROOM, &room), "room"); /* the generated room */
    for (k = 0; k < placement_count; k++) {
        check(luxfer_transfer_create(context, &transfers[k]), "transfer");
        check(luxfer_transfer_set_photo(transfers[k], photo), "photo");
        check(luxfer_transfer_set_scene(transfers[k], room, placements[k].surface), "surface");
        set_strokes(transfers[k], photo);
    }
    transfer_light(transfers, photo);
    write_results(transfers, room);
    for (k = 0; k < placement_count; k++) luxfer_release(transfers[k]);
    luxfer_release(room), luxfer_release(photo), luxfer_release(context);
    return 0;
}
