/* luxfer: renderings in parts, for many machines.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_FARM_H
#define LUXFER_FARM_H

#include "render.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Renderings in parts
 *
 * Renders an image on several machines. A part is a rectangle of the image and a range of its paths. Each machine
 * renders parts into files, and one machine merges the files. The result equals the image that one machine renders as
 * a single part, for any division into parts and any order, except for the rounding of sums in double precision. A
 * lost part can be rendered again; the new part equals the lost part to the bit. An image of luxfer_render_start has
 * equal expected values, but different noise.
 *
 * A part has a fixed number of paths: target_error, relative_error, pixel_error and time_budget_ms must be 0. All
 * parts and the merge must use the same scene, camera, layers and luxfer_render_params; the merge checks this.
 *
 * The files are OpenEXR: R, G, B show the part at its place in the image, and integer channels store its sums.
 * ================================================================================================================== */

/**
 * A part of a rendering. Fill it with luxfer_render_part_init, which sets it to the whole rendering, or with
 * luxfer_render_split.
 */
typedef struct luxfer_render_part {
    /** sizeof(luxfer_render_part), set by luxfer_render_part_init. */
    uint32_t struct_size;
    /** Column of the first pixel; default 0. */
    uint32_t x;
    /** Row of the first pixel, from the top; default 0. */
    uint32_t y;
    /** Width in pixels; default 0: up to the right edge of the image. */
    uint32_t width;
    /** Height in pixels; default 0: up to the bottom edge of the image. */
    uint32_t height;
    /** Index of the first path of each pixel, from 0; default 0. */
    uint32_t first_sample;
    /** Paths per pixel; default 0: all paths from first_sample up to luxfer_render_params.samples. */
    uint32_t samples;
} luxfer_render_part;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_render_part_init(luxfer_render_part *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_RENDER_PART, place, size);
}

/**
 * Gets one part of a rendering. The image is split into columns x rows rectangles, and the paths of each pixel are
 * split into a number of ranges; all parts have about equal size. index is less than columns * rows * ranges. It
 * numbers first the parts with the first range of paths, rectangle by rectangle and row by row, then the parts with
 * the second range, and so on. params may be NULL for the defaults. size is sizeof *part. Any thread.
 * LUXFER_INVALID_ARGUMENT if there is no such part, or if some parts would be empty because there are more columns,
 * rows or ranges than pixels or paths to split.
 */
luxfer_status luxfer_render_split(luxfer_render *render,
                                  const luxfer_render_params *params,
                                  uint32_t columns,
                                  uint32_t rows,
                                  uint32_t ranges,
                                  uint32_t index,
                                  luxfer_render_part *part,
                                  size_t size);

/**
 * Starts a job that renders a part, or the whole image if part is NULL, and writes it into a file. path is UTF-8, and
 * an existing file is replaced only once the new one is complete. Afterwards the images of the rendering show this
 * part alone. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
 * and the scene has no camera. The job may end with LUXFER_INVALID_ARGUMENT if a setting is out of range, if the
 * settings have an error target or a time budget, or if the part exceeds the image; LUXFER_IO if the file cannot be
 * written.
 */
luxfer_status luxfer_render_start_part(luxfer_render *render,
                                       const luxfer_render_params *params,
                                       const luxfer_render_part *part,
                                       const char *path,
                                       luxfer_job **job);

/**
 * Adds a file that luxfer_render_start_part has written to the list of files to merge. path is UTF-8. The call reads
 * only the header of the file; the merge reads the pixels. Any thread.
 * LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is not a part of a rendering; LUXFER_INVALID_OPERATION
 * while a job runs.
 */
luxfer_status luxfer_render_add_part(luxfer_render *render,
                                     const char *path);

/**
 * Empties the list of files to merge, which luxfer_render_add_part fills. The files stay on the disk. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_clear_parts(luxfer_render *render);

/**
 * Starts a job that merges the files of luxfer_render_add_part. Afterwards the merged images and layers can be read by
 * the functions that read the results of luxfer_render_start. params may be NULL for the defaults. The caller releases
 * *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
 * and the scene has no camera. The job may end with LUXFER_INVALID_ARGUMENT if a file belongs to another rendering or
 * another scene, if parts overlap, or if paths are missing: the message names the first gap; LUXFER_IO or
 * LUXFER_FORMAT if a file cannot be read.
 */
luxfer_status luxfer_render_start_merge(luxfer_render *render,
                                        const luxfer_render_params *params,
                                        luxfer_job **job);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_FARM_H */
