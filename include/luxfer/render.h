/* luxfer: rendering, and its layers and images.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_RENDER_H
#define LUXFER_RENDER_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Rendering
 *
 * A path tracer that renders a scene in cd/m². The image improves pass by pass. While the job runs, and after a
 * cancel, the current image can be read with an estimate of its error.
 * ================================================================================================================== */

/** A rendering of a scene. See luxfer_render_create. */
typedef struct luxfer_render luxfer_render;

/** Settings of a rendering. Fill them with luxfer_render_params_init. */
typedef struct luxfer_render_params {
    /** sizeof(luxfer_render_params), set by luxfer_render_params_init. */
    uint32_t struct_size;
    /** Width of the image in pixels, in [1, 65536]; default 1280. */
    uint32_t width;
    /** Height of the image in pixels, in [1, 65536]; default 720. */
    uint32_t height;
    /**
     * Paths per pixel, in [1, 1048576]; default 64. With a target error, rendering stops at the latest when the mean
     * number of paths per pixel reaches this value.
     */
    uint32_t samples;
    /**
     * Stop when luxfer_render_report.error is at most this value, >= 0. With this target, paths go to the pixels
     * where they reduce the error most. Default 0: no target.
     */
    float target_error;
    /** Stop after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** Seed of the paths; default 1. */
    uint64_t seed;
    /**
     * Stop when the relative error of every block of 8 x 8 pixels is at most this value, >= 0; 0.1 means within 10 %
     * of the value, 19 times out of 20. Default 0: no target. A block receives at most 64 * samples paths per pixel
     * (the field samples), even if it then misses the target.
     *
     * The relative error of a pixel is e / max(Y, m / 10). Here e is half the width of the 95 % confidence interval of
     * the pixel's luminance Y, and m is the mean of the image. The relative error of a block is the root mean square
     * over its pixels.
     */
    float pixel_error;
    /** Must be 0. */
    uint32_t reserved;
    /**
     * Strength of the noise filter for LUXFER_RENDER_PREVIEW, in [0, 10]; 1 is usual, larger values blur more.
     * Default 0: no preview, as for final images. The preview does not change the other images. After a cancel, a
     * rendering with a preview keeps all images of the last preview, because one more preview would take too long.
     */
    float preview;
    /**
     * Stop when luxfer_render_report.relative_error is at most this value, >= 0. With this target, paths go to the
     * pixels where they reduce this error most. In this error, noise in dark areas counts as much as noise in bright
     * areas, as for the eye. Default 0: no target. With several targets, rendering stops when all targets are reached.
     */
    float relative_error;
} luxfer_render_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_render_params_init(luxfer_render_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, place, size);
}

/** An image of a rendering: a LUXFER_RENDER_ value. */
typedef int32_t luxfer_render_image;

/** Quality of a rendering. */
typedef struct luxfer_render_report {
    /** sizeof(luxfer_render_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Mean number of paths per pixel so far. */
    uint32_t samples;
    /**
     * Root mean square of the standard errors of all pixels, divided by the image's mean; infinite while a pixel has
     * fewer than two paths.
     */
    double error;
    /** Number of paths that were discarded because their radiance was not finite. */
    uint64_t discarded;
    /**
     * Estimated bias of the preview. The bias of a block of 8 x 8 pixels is the expected value of the block's mean
     * minus its true mean. This field is the root mean square of the bias over all blocks, divided by the image's
     * mean. 0 without a preview.
     */
    double preview_bias;
    /**
     * Root mean square, over all pixels, of the standard error divided by the pixel's value. The value is the mean of
     * the pixel's channels, but at least a hundredth of the image's mean. Infinite while a pixel has fewer than two
     * paths. With few paths this estimate is too high: with 8 paths by about a quarter.
     */
    double relative_error;
    /**
     * Estimated error of the preview, remaining noise and bias together: root mean square over pixels and channels,
     * divided by the image's mean. Compare it with the field error, the error of the unfiltered image. Infinite
     * while a pixel has fewer than four paths; 0 without a preview.
     */
    double preview_error;
} luxfer_render_report;

/** Mean radiance of each pixel, linear RGB in cd/m². */
#define LUXFER_RENDER_BEAUTY 0

/**
 * Variance of the mean radiance of each pixel; 3 channels, in (cd/m²)². Infinite where a pixel has fewer than two
 * paths. Blocks of eight neighbouring pixels share parts of their paths, so the errors of these pixels are correlated:
 * the variance of a sum over pixels is up to eight times the sum of their variances.
 */
#define LUXFER_RENDER_VARIANCE 1

/** Number of paths of each pixel; 1 channel. */
#define LUXFER_RENDER_PATHS 2

/**
 * Half the width of the 95 % confidence interval of each pixel's radiance, in cd/m²; 3 channels; infinite where a
 * pixel has fewer than two paths.
 */
#define LUXFER_RENDER_INTERVAL 3

/**
 * The beauty image after a noise filter that follows the edges of the visible surfaces. The filter averages a pixel
 * with neighbours that differ from it by no more than the noise. A pixel keeps its unfiltered value if this value is
 * estimated to be more accurate than the filtered value. The filter never changes a pixel by more than three standard
 * errors. Details that come from the light alone, such as soft shadows, can be blurred;
 * luxfer_render_report.preview_error estimates the remaining error. The image exists only if
 * luxfer_render_params.preview is not 0.
 */
#define LUXFER_RENDER_PREVIEW 4

/**
 * Half the width of the 95 % interval of each pixel of the preview, in cd/m²; 3 channels. The interval includes the
 * bias of the filter. It is infinite where a pixel has fewer than four paths. Measured in rooms with 4 to 256 paths
 * per pixel, the intervals contain the true value of 93 % to 98 % of the pixels; along edges of surfaces, they contain
 * it less often. The image exists only if luxfer_render_params.preview is not 0.
 */
#define LUXFER_RENDER_PREVIEW_INTERVAL 5

/** Creates a rendering. It has no inputs yet. The caller releases *render. Any thread. */
luxfer_status luxfer_render_create(luxfer_context *context, luxfer_render **render);

/** Sets the scene; each job renders the scene as it is when the job starts. Any thread. */
luxfer_status luxfer_render_set_scene(luxfer_render *render, luxfer_scene *scene);

/**
 * Sets the camera. camera may be a struct that luxfer_scene_get_camera has filled, or NULL, the default: the first
 * camera of the scene. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value of camera is out of range.
 */
luxfer_status luxfer_render_set_camera(luxfer_render *render,
                                       const luxfer_camera_params *camera);

/**
 * Starts a job that renders the scene. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
 * and the scene has no camera. The job may end with LUXFER_INVALID_ARGUMENT if the scene is not valid or a setting is
 * out of range.
 */
luxfer_status luxfer_render_start(luxfer_render *render,
                                  const luxfer_render_params *params,
                                  luxfer_job **job);

/**
 * Gets the image of the rendering that kind, a LUXFER_RENDER_ value, selects, in its current state. The caller
 * releases *image. Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND for a preview if luxfer_render_params.preview was
 * 0.
 */
luxfer_status luxfer_render_get_image(luxfer_render *render,
                                      luxfer_render_image kind,
                                      luxfer_image **image);

/**
 * Describes in words what the rendering skips in its scene. In addition to the contents of
 * luxfer_scene_get_requirements_text, the text tells how many lamps of the scene are hidden, for example by walls,
 * from all surfaces that the paths of the image reach. The rendering learns from its first paths which lamps are
 * hidden. Later paths hardly ever sample these lamps, which does not change the expected image. Any thread.
 *
 * The text has one sentence per line and is zero-terminated UTF-8, truncated to capacity bytes including the zero.
 * *needed, unless NULL, receives the capacity that the whole text needs. buffer may be NULL if capacity is 0.
 * LUXFER_NOT_READY before the first pass of a job.
 */
luxfer_status luxfer_render_get_requirements_text(luxfer_render *render,
                                                  char *buffer,
                                                  size_t capacity,
                                                  size_t *needed);

/**
 * Gets the current quality of the rendering. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before the first pass of a job.
 */
luxfer_status luxfer_render_get_report(luxfer_render *render,
                                       luxfer_render_report *report,
                                       size_t size);

/* ==================================================================================================================
 * Outputs of a rendering
 *
 * Additional images (layers) from the same paths as the main image: light that light path expressions select, and
 * properties of the visible surfaces (AOVs). Request layers before luxfer_render_start, and read them while the job
 * runs or afterwards. The layers of expressions come first, in the order in which they were added, then the AOVs in
 * the order of their flags. Layers do not change the main image by a single bit.
 *
 * AOVs describe the first surface that a path from the camera meets; clear panes and mirrors count as surfaces. Depth,
 * distance, position and normals are means over the samples of the pixel that meet a surface; a mean normal is scaled
 * to unit length. The comment of each LUXFER_AOV_ flag names the layer and its channels.
 *
 * A light path expression is a regular expression over the events of a path; the characters . [..] [^..] * + ? {n,m}
 * | ( ) have their usual meaning. It has one of two forms.
 *
 * The first form runs from a light (L) to the eye (E), for example "LDE", "LSE", "L.*DDE", "LD{1,2}E", "LS*DE". L is
 * any light, D is a diffuse event, S is every other scattering event.
 *
 * The second form runs from the camera (C) to a light, as in Open Shading Language, for example "C<RD>L",
 * "C[GS]+.*<L.'Lamp'>". An event has a type and a scattering mode: <RD> is a diffuse reflection. A letter alone, such
 * as G, matches any event with this type or mode. The types are R (reflection), T (transmission) and V (volume, never
 * occurs here). The modes are D (diffuse), G (glossy, also rough solid glass), S (mirror, clear pane or smooth solid
 * glass) and s (clear pane only). Lights are L, O and B; see luxfer_emitter_as.
 *
 * A label in quotes restricts an event to an object or a light. The label is the name of a mesh or of its material.
 * Name#0, Name#1, ... are the lamps (connected regions) in the emission texture of the mesh or material Name, numbered
 * as luxfer_lamps numbers them. light0, light1, ... are the scene's punctual lights in their order, and environment is
 * the scene's environment.
 *
 * Arnold's built-in names work too: beauty, direct, indirect, emission, background, and diffuse, specular,
 * transmission, each alone or with _direct or _indirect.
 * ================================================================================================================== */

/**
 * Distance of the surface from the camera along the viewing direction (depth z), in metres; infinite where there is no
 * surface. Layer Depth, channel Z.
 */
#define LUXFER_AOV_DEPTH 1

/**
 * Distance of the surface from the camera along the pixel's ray, in metres; infinite where there is no surface. Layer
 * Distance, channel Z.
 */
#define LUXFER_AOV_DISTANCE 2

/** Position in world space, in metres; 0 where there is no surface. Layer Position, channels X Y Z. */
#define LUXFER_AOV_POSITION 4

/** Shading normal in world space, towards the camera; 0 where there is no surface. Layer Normal, channels X Y Z. */
#define LUXFER_AOV_NORMAL 8

/**
 * Normal of the triangle in world space, towards the camera; 0 where there is no surface. Layer GeometricNormal,
 * channels X Y Z.
 */
#define LUXFER_AOV_GEOMETRIC_NORMAL 16

/**
 * Reflectance plus transmittance at normal incidence: the mean over all samples of the pixel, where samples that meet
 * no surface count as 0. Layer Albedo, channels R G B.
 */
#define LUXFER_AOV_ALBEDO 32

/**
 * 1 + index of the mesh on which more than half of the pixel's hits lie. Without such a majority: 1 + index of any
 * mesh that was hit. 0 where there is no surface. The luminous opening of the luminaire with index i among the
 * punctual lights has the value m + i + 1, where m is the number of meshes. Layer IndexOB, channel X.
 */
#define LUXFER_AOV_OBJECT 64

/**
 * 1 + index of the material on which more than half of the pixel's hits lie. Without such a majority: 1 + index of any
 * material that was hit. 0 where there is no surface. The luminous openings of luminaires have the value n + 1, where
 * n is the number of materials. Layer IndexMA, channel X.
 */
#define LUXFER_AOV_MATERIAL 128

/** Share of the pixel that surfaces cover, in [0, 1]. Layer Alpha, channel A. */
#define LUXFER_AOV_ALPHA 256

/** Luminance of the main image, in cd/m². Layer Luminance, channel Y. */
#define LUXFER_AOV_LUMINANCE 512

/**
 * Letters that match emissive surfaces and the environment in expressions that start at the camera: a
 * LUXFER_EMITTER_AS_ value. Punctual lights always match L.
 */
typedef int32_t luxfer_emitter_as;

/**
 * Emissive surfaces match L and O, the environment matches L and B, so C<RD>L is all direct light that is reflected
 * diffusely. The default.
 */
#define LUXFER_EMITTER_AS_BOTH 0

/** Emissive surfaces and the environment match L only. */
#define LUXFER_EMITTER_AS_LIGHT 1

/** As in Open Shading Language: surfaces match O, the environment matches B. */
#define LUXFER_EMITTER_AS_OBJECT 2

/**
 * Adds a layer with the light that an expression selects. name is the name of the layer: 1 to 64 bytes in UTF-8,
 * without dots, quotes or control characters. It must differ from the names of the other layers and of all AOVs, and
 * from Combined and Variance. Any thread.
 * LUXFER_INVALID_ARGUMENT if the name is not valid, or if the expression is malformed: the message gives the column.
 * LUXFER_INVALID_OPERATION while a job runs. The rendering's job ends with LUXFER_NOT_FOUND if no object of the scene
 * has a label that the expression names, and with LUXFER_INVALID_ARGUMENT if no path can match the expression.
 */
luxfer_status luxfer_render_add_expression(luxfer_render *render,
                                           const char *name,
                                           const char *expression);

/**
 * Removes all expressions. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_clear_expressions(luxfer_render *render);

/**
 * Sets the letters that match emissive surfaces and the environment; emitter_as is a LUXFER_EMITTER_AS_ value. Any
 * thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_set_emitter_as(luxfer_render *render,
                                           luxfer_emitter_as emitter_as);

/**
 * Sets which AOVs are rendered: LUXFER_AOV_ flags combined with |, or 0, the default, for no AOV. Any thread.
 * LUXFER_INVALID_ARGUMENT for unknown flags; LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_set_aovs(luxfer_render *render, uint32_t flags);

/**
 * Gets the number of layers of the rendering. Any thread.
 * LUXFER_NOT_READY before the first pass of a job.
 */
luxfer_status luxfer_render_get_layer_count(luxfer_render *render, uint32_t *count);

/**
 * Copies a layer's name into buffer as zero-terminated UTF-8, truncated to capacity bytes including the zero; index
 * starts at 0. *needed, unless NULL, receives the capacity that the whole name needs. buffer may be NULL if capacity
 * is 0. Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND if there is no such layer.
 */
luxfer_status luxfer_render_get_layer_name(luxfer_render *render,
                                           uint32_t index,
                                           char *buffer,
                                           size_t capacity,
                                           size_t *needed);

/**
 * Gets the layer with a name, in its current state: light in cd/m² with 3 channels, or an AOV with its channels. The
 * caller releases *image. Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND if no layer has that name.
 */
luxfer_status luxfer_render_get_layer(luxfer_render *render,
                                      const char *name,
                                      luxfer_image **image);

/**
 * Writes the image and all layers into one OpenEXR file of 32-bit floating-point channels; path is UTF-8. An existing
 * file is replaced only once the new one is complete. Any thread.
 *
 * The image has the channels R, G, B, and A if LUXFER_AOV_ALPHA is set. The channels of each layer are named
 * layer.channel, as Blender and Nuke read them; the depth, Depth.Z, is also stored as Z. For each layer of light, the
 * attribute luxfer.lpe.NAME of the header holds its expression.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_render_write_exr(luxfer_render *render,
                                      const char *path);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_RENDER_H */
