/* Illuminance on a calculation grid.
 *
 * Computes the illuminance in the generated office 1.5 m above the floor, higher than the screens between desks.
 * Prints the mean, the extremes and the uniformity with their error, and writes lux_map.png: dark blue is 0 lux, red
 * is 1500 lux.
 */
#include "common.h"

enum { COLUMNS = 22, ROWS = 40, SCALE = 6 }; /* One point every 20 cm, drawn as SCALE x SCALE pixels. */

/* Colour for t in [0, 1]: from dark blue through green and yellow to red. */
static void false_colour(float t, unsigned char *rgb) {
    static const float stops[5][3] = {{20, 20, 90}, {20, 110, 190}, {60, 180, 90}, {240, 220, 60}, {210, 40, 30}};
    const float at = (t < 0 ? 0 : t > 1 ? 1 : t) * 4;
    const int i = at < 4 ? (int)at : 3;
    int c;
    for (c = 0; c < 3; c++) rgb[c] = (unsigned char)(stops[i][c] + (at - (float)i) * (stops[i + 1][c] - stops[i][c]));
}

int main(void) {
    static float lux[ROWS][COLUMNS];
    static unsigned char map[ROWS * SCALE][COLUMNS * SCALE][3];
    luxfer_scene *scene = NULL;
    luxfer_illuminance *illuminance = NULL;
    luxfer_illuminance_grid grid;
    luxfer_illuminance_params params;
    luxfer_illuminance_report report;
    luxfer_image_view view;
    luxfer_image *image = NULL;
    luxfer_job *job = NULL;
    int x, y;

    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_demo_create_scene(context, LUXFER_DEMO_EXEMPLAR_ROOM, &scene), "scene");
    check(luxfer_illuminance_create(context, &illuminance), "illuminance");
    check(luxfer_illuminance_set_scene(illuminance, scene), "illuminance");

    /* --8<-- [start:grid] */
    /* A corner, two edges, and the normal of the side that receives the light define the grid. Its points are the
     * centres of the cells. */
    check(luxfer_illuminance_grid_init(&grid, sizeof grid), "grid");
    grid.origin[0] = 0.5f, grid.origin[1] = 1.5f, grid.origin[2] = 0.5f;
    grid.across[0] = 4.4f;
    grid.down[2] = 8;
    check(luxfer_illuminance_params_init(&params, sizeof params), "grid");
    params.columns = COLUMNS;
    params.rows = ROWS;
    params.samples = 256;
    check(luxfer_illuminance_start_grid(illuminance, &grid, &params, &job), "grid");
    wait_and_release(job, "measuring");

    check(luxfer_illuminance_get_report(illuminance, &report, sizeof report), "report");
    /* --8<-- [end:grid] */
    printf("mean %.0f lux (+- %.1f, 95 %%), least %.0f, largest %.0f, uniformity %.2f\n", report.mean, 1.96 * report.mean_error,
           report.minimum, report.maximum, report.minimum / report.mean);

    /* Read the values, which have one channel, into an array. */
    check(luxfer_illuminance_get_image(illuminance, LUXFER_ILLUMINANCE_LUX, &image), "lux");
    check(luxfer_image_view_init(&view, sizeof view), "lux");
    view.width = COLUMNS;
    view.height = ROWS;
    view.channels = 1;
    view.data = lux;
    view.byte_size = sizeof lux;
    check(luxfer_image_read(image, 0, &view), "lux");
    check(luxfer_release(image), "lux");

    for (y = 0; y < ROWS * SCALE; y++)
        for (x = 0; x < COLUMNS * SCALE; x++) false_colour(lux[y / SCALE][x / SCALE] / 1500, map[y][x]);
    view.width = COLUMNS * SCALE;
    view.height = ROWS * SCALE;
    view.channels = 3;
    view.sample = LUXFER_SAMPLE_U8;
    view.colour_space = LUXFER_COLOUR_SRGB;
    view.data = map;
    view.byte_size = sizeof map;
    check(luxfer_image_create(context, &view, &image), "map");
    check(luxfer_image_save(image, "lux_map.png", 1), "map");

    luxfer_release(image);
    luxfer_release(illuminance);
    luxfer_release(scene);
    luxfer_release(context);
    return 0;
}
