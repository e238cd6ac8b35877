/* luxfer: the lighting transfer from end to end, and warnings.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_TRANSFER_H
#define LUXFER_TRANSFER_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Structs of parts that this part does not include. */
struct luxfer_emission_params;
struct luxfer_features;
struct luxfer_features_params;
struct luxfer_rectify;
struct luxfer_rectify_params;
struct luxfer_rectify_report;
struct luxfer_relight_params;
struct luxfer_relight_report;
struct luxfer_render_params;
struct luxfer_segment;
struct luxfer_segment_params;

/* ==================================================================================================================
 * Pattern
 *
 * Settings for the layout of a transfer's light pattern on the surface: its size, rotation and offset, and the areas
 * without lamps.
 * ================================================================================================================== */

/** Choice of the length that sets the size of the pattern on the surface: a LUXFER_PATTERN_ value. */
typedef int32_t luxfer_pattern_scale;

/**
 * Layout of the light pattern on a surface; luxfer_surface gives the corner and the axes u and v of the surface. Fill
 * it with luxfer_pattern_params_init.
 */
typedef struct luxfer_pattern_params {
    /** sizeof(luxfer_pattern_params), set by luxfer_pattern_params_init. */
    uint32_t struct_size;
    /** The length that sets the size of the pattern: a LUXFER_PATTERN_ value; default LUXFER_PATTERN_DISTANCE. */
    luxfer_pattern_scale scale;
    /**
     * Length of a lamp for LUXFER_PATTERN_LAMP, or spacing of the lamps for LUXFER_PATTERN_SPACING, in metres, in
     * [1e-6, 1e6]; default 1. Other values of scale do not use it.
     */
    double length;
    /**
     * Side of a texel in metres, in [0, 1e6]. 0, the default: the size of an unwarped pixel on the surface, or a
     * larger size if the texture would otherwise exceed max_texels of luxfer_transfer_params. With a size at which the
     * texture exceeds max_texels, the job ends with LUXFER_INVALID_ARGUMENT.
     */
    double texel_size;
    /** Rotation of the pattern from u towards v in radians, in [-2 pi, 2 pi]; default 0. */
    double rotation;
    /**
     * Shift of the pattern in metres, along u and v after their rotation by the field rotation; each in [-1e6, 1e6];
     * default 0. With LUXFER_LAW_FREE, the shift must be 0, unless luxfer_emission_params.offset allows another value.
     */
    double offset[2];
    /**
     * Minimum distance in metres of lamps from the edge of the surface and from the zones of
     * luxfer_transfer_set_zones, in [-1, 1e6]; lamps that are nearer are left out. With a value below 0, such as the
     * default -1, only lamps that touch a zone are left out, and the edge of the surface cuts lamps.
     */
    double margin;
} luxfer_pattern_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_pattern_params_init(luxfer_pattern_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_PATTERN_PARAMS, place, size);
}

/**
 * The distance of the photo's camera from the plane with the lights. It is plane_distance of luxfer_transfer_params,
 * or if that is 0, an estimate. The estimate comes from the size of the lamps if they are rectangular; otherwise it is
 * a usual distance with a large error.
 */
#define LUXFER_PATTERN_DISTANCE 0

/**
 * The length of the lamps: the pattern is scaled until the median of their longer sides is
 * luxfer_pattern_params.length.
 */
#define LUXFER_PATTERN_LAMP 1

/**
 * The spacing of the lamps: the pattern is scaled until this spacing is luxfer_pattern_params.length. The spacing is
 * the shorter period of the lamps' lattice or, without a lattice, the median distance from a lamp to its nearest
 * neighbour.
 */
#define LUXFER_PATTERN_SPACING 2

/** The width of the surface: as many lamps lie side by side on it as on the plane in the photo. */
#define LUXFER_PATTERN_ACROSS 3

/* ==================================================================================================================
 * Transfer
 *
 * The lighting transfer from end to end: lights a scene as in a photo, from the photo and a few strokes. It runs its
 * stages one after the other. You can read every result as soon as its stage has ended, replace it by a result of
 * your own, and continue from any stage.
 *
 * stages.h and render.h declare the structs of single stages. Include them, or luxfer.h, to change the settings of a
 * stage (luxfer_transfer_params), to read luxfer_rectify_report or luxfer_relight_report, or to run a stage alone.
 * ================================================================================================================== */

/** A lighting transfer. See luxfer_transfer_create. */
typedef struct luxfer_transfer luxfer_transfer;

/** A stage of the transfer: a LUXFER_STAGE_ value. The stages run in the order of their values. */
typedef int32_t luxfer_stage;

/** The part of the photo whose mean colour is matched: a LUXFER_TARGET_ value. */
typedef int32_t luxfer_target;

/**
 * Settings of a transfer. Fill them with luxfer_transfer_params_init. The library reads the structs to which the
 * pointers lead only during the call that gets the settings.
 */
typedef struct luxfer_transfer_params {
    /** sizeof(luxfer_transfer_params), set by luxfer_transfer_params_init. */
    uint32_t struct_size;
    /** Maximum length of the longer side of the emissive texture in texels, in [1, 16384]; default 2048. */
    uint32_t max_texels;
    /**
     * Distance in metres of the photo's camera from the plane with the lights, in [0.01, 1e4]. With
     * LUXFER_PATTERN_DISTANCE, it sets the scale of the pattern. 0, the default: estimated from the size of the lamps,
     * which are mostly made to fit ceiling tiles. luxfer_transfer_report states the distance and its error.
     */
    double plane_distance;
    /**
     * Luminance in cd/m² of the photo's white (value 1), in [1e-6, 1e9]; default 100, the luminance of matt white
     * paper in 314 lux. The strength of the lamps is proportional to it. A photo alone does not determine this
     * luminance: see proposed_white of luxfer_transfer_report.
     */
    float white_luminance;
    /** Part of the photo whose mean colour is matched: a LUXFER_TARGET_ value; default LUXFER_TARGET_SURFACE. */
    luxfer_target target;
    /** Settings of the stages VIEW and UNWARP; NULL, the default: the defaults of luxfer_rectify_params. */
    const struct luxfer_rectify_params *rectify;
    /** Settings of the stage FEATURES; NULL, the default: the defaults of luxfer_features_params. */
    const struct luxfer_features_params *features;
    /** Settings of the stage PLANE; NULL, the default: the defaults of luxfer_segment_params. */
    const struct luxfer_segment_params *plane;
    /**
     * Settings of the stage LIGHTS; NULL, the default: the defaults of luxfer_segment_params, but channels = 7,
     * colour only.
     */
    const struct luxfer_segment_params *lights;
    /**
     * Settings of the stage EMISSION; NULL, the default: the defaults of luxfer_emission_params. The transfer sets
     * width, height, scale and offset itself.
     */
    const struct luxfer_emission_params *emission;
    /** Settings of the stage RELIGHT; NULL, the default: the defaults of luxfer_relight_params. */
    const struct luxfer_relight_params *relight;
    /** Settings of the stage RENDER; NULL, the default: the defaults of luxfer_render_params. */
    const struct luxfer_render_params *render;
    /** Layout of the lights on the surface; NULL, the default: the defaults of luxfer_pattern_params. */
    const luxfer_pattern_params *pattern;
} luxfer_transfer_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_transfer_params_init(luxfer_transfer_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_TRANSFER_PARAMS, place, size);
}

/** No stage of a transfer, but a stylisation or its guides: occurs only in warnings. */
#define LUXFER_STAGE_STYLIZE -2

/** No stage, but a luxfer_scene: occurs only in warnings. */
#define LUXFER_STAGE_SCENE -1

/** Finds lines, vanishing points and the camera of the photo. */
#define LUXFER_STAGE_VIEW 0

/** Computes the ten feature channels of each pixel of the photo. */
#define LUXFER_STAGE_FEATURES 1

/** Segments the plane that carries the lights. */
#define LUXFER_STAGE_PLANE 2

/** Segments the lights on the plane. */
#define LUXFER_STAGE_LIGHTS 3

/** Unwarps the plane to a frontal view. */
#define LUXFER_STAGE_UNWARP 4

/** Synthesises the emissive texture and maps it onto the scene's surface. */
#define LUXFER_STAGE_EMISSION 5

/** Solves for the colour and intensity of the emission. */
#define LUXFER_STAGE_RELIGHT 6

/** Renders the scene in its new light. */
#define LUXFER_STAGE_RENDER 7

/** The plane that carries the lights, without the lights and their halo. */
#define LUXFER_TARGET_SURFACE 0

/** The whole photo. */
#define LUXFER_TARGET_WHOLE_IMAGE 1

/** Creates a transfer. It has no inputs yet. The caller releases *transfer. Any thread. */
luxfer_status luxfer_transfer_create(luxfer_context *context, luxfer_transfer **transfer);

/** Sets the photo: linear RGB, 1 = display white. Strokes for a photo of another size are removed. Any thread. */
luxfer_status luxfer_transfer_set_photo(luxfer_transfer *transfer, luxfer_image *photo);

/** Sets a depth map of the photo; kind is a LUXFER_DEPTH_ value. depth may be NULL: no depth map. Any thread. */
luxfer_status luxfer_transfer_set_depth(luxfer_transfer *transfer,
                                        luxfer_image *depth,
                                        luxfer_depth_kind kind);

/**
 * Sets the scene to light, and the name (UTF-8) of the object or material whose surface receives the lights. The
 * transfer never changes the scene; each job uses the scene as it is when the job starts. Any thread.
 *
 * If the object or material has triangles in several planes, the transfer takes the plane from which most of the room
 * is visible. The parts of this plane, for example between the beams of a ceiling, share one pattern that continues
 * from part to part. Triangles in other planes stay unchanged; light them by another transfer with its own pattern.
 */
luxfer_status luxfer_transfer_set_scene(luxfer_transfer *transfer,
                                        luxfer_scene *scene,
                                        const char *surface);

/**
 * Sets the triangles of the scene that receive the lights, instead of the named surface. The array triangles holds the
 * mesh index and the triangle index of each of count triangles. If the triangles lie in several planes, the transfer
 * takes the plane from which most of the room is visible, as for a named surface. These triangles replace the
 * triangles of an earlier call, and luxfer_transfer_set_scene removes them. If count is 0, triangles may be NULL, and
 * the named surface receives the lights again. Any thread.
 * A job ends with LUXFER_INVALID_ARGUMENT if the scene does not have these triangles.
 */
luxfer_status luxfer_transfer_set_triangles(luxfer_transfer *transfer,
                                            const uint32_t *triangles,
                                            size_t count);

/**
 * Sets an emissive texture: linear RGB, where 1 is the photo's white. The stage EMISSION then stretches it over the
 * surface instead of making a texture from the photo. Its values must be finite and >= 0, or else the job ends with
 * LUXFER_INVALID_ARGUMENT. texture may be NULL, the default: a texture is made from the photo. Any thread.
 */
luxfer_status luxfer_transfer_set_texture(luxfer_transfer *transfer,
                                          luxfer_image *texture);

/**
 * Sets the camera of the rendered picture. camera may be NULL, the default: the first camera of the scene, or a camera
 * in a corner of the room if the scene has no camera. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value of camera is out of range.
 */
luxfer_status luxfer_transfer_set_camera(luxfer_transfer *transfer,
                                         const luxfer_camera_params *camera);

/**
 * Sets the strokes on the photo, for the mask of the plane and the mask of the lights. Strokes on lights count as
 * strokes on the plane too. Strokes for the plane serve as negative strokes for the lights, except where they cross
 * lights. The call copies the strokes, which replace earlier strokes; strokes may be NULL: no strokes. Any thread.
 * LUXFER_INVALID_ARGUMENT if the strokes are for images of another size than the photo.
 */
luxfer_status luxfer_transfer_set_strokes(luxfer_transfer *transfer,
                                          luxfer_strokes *strokes);

/**
 * Sets rectangles of the surface that stay without lamps, for example at ducts and sprinklers. The array zones holds
 * u0, v0, u1 and v1 of each of count rectangles, in metres from the surface's corner along its axes (luxfer_surface),
 * with u0 <= u1 and v0 <= v1. The rectangles replace earlier rectangles; zones may be NULL if count is 0. Any thread.
 * LUXFER_INVALID_ARGUMENT if a number is not finite, or u0 > u1 or v0 > v1.
 */
luxfer_status luxfer_transfer_set_zones(luxfer_transfer *transfer,
                                        const double *zones,
                                        size_t count);

/**
 * Replaces the result of the stage VIEW by the lines and the camera of a luxfer_rectify. If that object has unwarped
 * a plane, this plane replaces the result of the stage UNWARP. The transfer then keeps this camera, even if the
 * photo's lamps suggest another camera. Any thread.
 * LUXFER_NOT_READY if rectify has no result yet.
 */
luxfer_status luxfer_transfer_use_rectify(luxfer_transfer *transfer,
                                          struct luxfer_rectify *rectify);

/**
 * Replaces the result of the stage FEATURES by the result of a luxfer_features. Any thread.
 * LUXFER_NOT_READY if features has no result yet.
 */
luxfer_status luxfer_transfer_use_features(luxfer_transfer *transfer, struct luxfer_features *features);

/**
 * Replaces the result of the stage PLANE or LIGHTS by the result of a luxfer_segment; phase, a LUXFER_PHASE_ value,
 * chooses the stage. Any thread.
 * LUXFER_NOT_READY if segment has no result yet.
 */
luxfer_status luxfer_transfer_use_segment(luxfer_transfer *transfer,
                                          luxfer_phase phase,
                                          struct luxfer_segment *segment);

/**
 * Replaces the result of the stage PLANE or LIGHTS by a mask of the photo's size, for example a mask drawn by hand;
 * phase, a LUXFER_PHASE_ value, chooses the stage. The mask has 1 channel, whose values are used as confidences in [0,
 * 1]. Any thread.
 * LUXFER_INVALID_ARGUMENT if the mask has more channels, or a value outside [0, 1].
 */
luxfer_status luxfer_transfer_use_mask(luxfer_transfer *transfer,
                                       luxfer_phase phase,
                                       luxfer_image *mask);

/**
 * Starts a job that runs all stages from the stage first to the stage last, LUXFER_STAGE_ values, both included.
 * Results of earlier stages that these stages use must exist, from an earlier job or from a luxfer_transfer_use_
 * function. Stages that have ended keep their results even if the job fails. params may be NULL for the defaults. The
 * caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if a job is already running, or if an input or the result of an earlier stage is missing;
 * LUXFER_INVALID_ARGUMENT if a setting of a stage is out of range. The job may end with any status with which a stage
 * may end; the message names the stage. If EMISSION is one of the stages and the scene lacks the surface, the job ends
 * before the first stage.
 */
luxfer_status luxfer_transfer_start(luxfer_transfer *transfer,
                                    luxfer_stage first,
                                    luxfer_stage last,
                                    const luxfer_transfer_params *params,
                                    luxfer_job **job);

/**
 * Starts a job that runs the stages first to last of several transfers, one for each plane with lights that the photo
 * shows, such as a ceiling and a wall with sconces, or two levels of a ceiling. transfers holds count handles, in [1,
 * 16], each at most once; params holds count pointers to settings, each of which may be NULL for the defaults, or is
 * NULL for the defaults of all. The transfers must have the same photo and the same scene; each has strokes, a
 * surface, and other inputs of its own. With one transfer, the job is that of luxfer_transfer_start. The results do
 * not depend on the order of the transfers. The caller releases *job. Any thread.
 *
 * The stages VIEW and FEATURES run once for all transfers whose settings and inputs for them are equal, so that there
 * is one camera and one layout of the room: the layout with which the strokes of all planes agree best. Masks,
 * unwarped image, texture, warnings and reports are those of each transfer; seconds of luxfer_transfer_report is the
 * time that a stage took for all of them. The stage EMISSION places all textures in one scene, and the stage RELIGHT
 * solves for the light of all planes together, because the lamps of each plane also light the other planes. Each
 * transfer then has the same LUXFER_SCENE_LIT, with the light of all planes. In luxfer_transfer_get_solution,
 * background includes the light of the other planes; a plane that they alone make brighter than in the photo gets no
 * light, and a warning. The stage RENDER runs once for all transfers with equal cameras and settings.
 *
 * Each plane must be parallel to two of the room's three axes: a ceiling, a floor or a wall (plane_axes of
 * luxfer_rectify_params). Sloped planes are not unwarped. For a sloped plane, make the texture by luxfer_image_warp
 * and a luxfer_emission, and set it by luxfer_transfer_set_texture; the transfer then needs only its masks.
 *
 * As luxfer_transfer_start; also LUXFER_INVALID_ARGUMENT if photos or scenes differ, if two transfers are one, if
 * white_luminance or the settings of RELIGHT differ, or if several transfers ask for LUXFER_FIT_LEAST_SQUARES; the job
 * ends with it if two transfers light one triangle of the scene. LUXFER_INVALID_OPERATION if RELIGHT runs without
 * EMISSION on transfers whose textures were not placed by one job, or on some of the transfers of that job only, also
 * by luxfer_transfer_start. The message names the transfer by its index.
 */
luxfer_status luxfer_transfer_start_all(luxfer_context *context,
                                        luxfer_transfer *const *transfers,
                                        size_t count,
                                        luxfer_stage first,
                                        luxfer_stage last,
                                        const luxfer_transfer_params *const *params,
                                        luxfer_job **job);

/* ==================================================================================================================
 * Transfer results
 *
 * The results of a transfer. A result is available once its stage has ended; the rendering is available in its
 * current state while it runs.
 * ================================================================================================================== */

/** An image that a stage of the transfer has made: a LUXFER_TRANSFER_ value. */
typedef int32_t luxfer_transfer_image;

/** A scene that the transfer has made: a LUXFER_SCENE_ value. */
typedef int32_t luxfer_transfer_scene;

/** Time and error of each stage. The error of a stage without a result is NaN. */
typedef struct luxfer_transfer_report {
    /** sizeof(luxfer_transfer_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * Number of fixtures (lamps of the lit scene); see luxfer_transfer_get_fixture. 0 before the stage RELIGHT has
     * ended.
     */
    uint32_t fixtures;
    /** Duration of each stage's last run in seconds, 0 without a run; the index is the LUXFER_STAGE_ value. */
    double seconds[8];
    /** Largest standard deviation of the directions of the vanishing points, in radians. */
    double view_error;
    /** Mean confidence of the depth in the features, in [0, 1]. */
    double depth_confidence;
    /** Expected share of wrong pixels in the mask of the plane, in [0, 1]. */
    double plane_error;
    /** Expected share of wrong pixels in the mask of the lights, in [0, 1]. */
    double lights_error;
    /** Largest expected error of a corner of the unwarped image, in unwarped pixels. */
    double unwarp_error;
    /**
     * luxfer_emission_report.error: largest relative difference between texture and photo in the lit share, the size
     * or the spacing of their lamps.
     */
    double emission_error;
    /** luxfer_relight_report.error: largest relative half-width of the solution's 95 % confidence intervals. */
    double relight_error;
    /** luxfer_render_report.error: root mean square of the rendering's standard errors, divided by its mean. */
    double render_error;
    /** Length of a texel's side on the surface, in metres. */
    double texel_size;
    /** Mean colour that the surface should have: linear RGB, where 1 is the photo's white. */
    float target[3];
    /** Reserved; always 0. */
    uint32_t reserved;
    /**
     * Distance in metres of the photo's camera from the plane with the lights. Seen from this distance, the lamps on
     * the surface of the scene look as large as the lamps in the photo. NaN before the stage EMISSION has ended, and
     * if the caller gave the texture.
     */
    double plane_distance;
    /**
     * Relative standard deviation of plane_distance. If the distance is estimated from the size of the lamps, it is
     * about 0.25 for lamps of a usual size, and 0.6 if the lamps do not determine it. 0 if the settings determine the
     * distance.
     */
    double plane_distance_error;
    /**
     * Value proposed for luxfer_transfer_params.white_luminance in cd/m²: the white_luminance of
     * luxfer_photo_metadata if the photo's file states the exposure, else 159, the luminance of white paper in the
     * 500 lux of an office.
     */
    double proposed_white;
    /**
     * Lower bound of proposed_white in cd/m²: white_luminance_low if the photo's file states the exposure, else 32,
     * the luminance of white paper in the 100 lux of a corridor.
     */
    double proposed_white_low;
    /**
     * Upper bound of proposed_white in cd/m²: white_luminance_high if the photo's file states the exposure, else 318,
     * the luminance of white paper in 1000 lux.
     */
    double proposed_white_high;
    /**
     * luxfer_render_report.preview_error: estimated error of LUXFER_TRANSFER_RENDER_PREVIEW, divided by the image's
     * mean. NaN without this image.
     */
    double preview_error;
} luxfer_transfer_report;

/** One lamp of the lit scene. */
typedef struct luxfer_fixture {
    /** sizeof(luxfer_fixture), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Centre of the lamp in metres. */
    float position[3];
    /** Unit vector of the direction in which the lamp shines. */
    float normal[3];
    /** Unit vector along the lamp's long axis. */
    float axis[3];
    /** Mean emission of the lamp: linear RGB in cd/m². */
    float radiance[3];
    /** Number of the lamp's kind, from 1, as in luxfer_luminaire.kind; 0 if the border of the texture cuts the lamp. */
    uint32_t kind;
    /** Lengths of the lamp along its long axis and across it, in metres. */
    double size[2];
    /** Area in m². */
    double area;
    /** Luminous flux in lumens: pi * luminance * area, since the lamp is Lambertian. */
    double flux;
    /** Correlated colour temperature of the light in kelvin; 0 for a lamp that is off. */
    double cct;
    /**
     * Signed distance of the light from the blackbody locus in the CIE 1960 diagram: positive for greenish light,
     * negative for pinkish light.
     */
    double duv;
} luxfer_fixture;

/** The ten channels of the features, as LUXFER_FEATURES_CHANNELS. */
#define LUXFER_TRANSFER_FEATURES 0

/** The mask of the plane in the photo: 1 on the plane, else 0; 1 channel. */
#define LUXFER_TRANSFER_PLANE_MASK 1

/** Probability that a pixel of the photo is on the plane, in [0, 1]; 1 channel. */
#define LUXFER_TRANSFER_PLANE_CONFIDENCE 2

/** The mask of the lights in the photo: 1 on lights, else 0; 1 channel. */
#define LUXFER_TRANSFER_LIGHTS_MASK 3

/** Confidence that a pixel of the photo is a light, in [0, 1], as LUXFER_SEGMENT_CONFIDENCE; 1 channel. */
#define LUXFER_TRANSFER_LIGHTS_CONFIDENCE 4

/** The unwarped image: the plane in frontal view, linear RGB. */
#define LUXFER_TRANSFER_UNWARPED 5

/**
 * The mask of the plane in frontal view: 1 where the mask is set and the photo's values are finite, else 0; 1 channel.
 */
#define LUXFER_TRANSFER_UNWARPED_VALID 6

/** The emissive texture: linear RGB, where 1 is the photo's white. */
#define LUXFER_TRANSFER_EMISSION 7

/** The mask of the emissive texture: 1 on lamps, else 0; 1 channel. */
#define LUXFER_TRANSFER_EMISSION_MASK 8

/** The scene in its new light: linear RGB in cd/m²; while the rendering runs, the picture so far. */
#define LUXFER_TRANSFER_RENDER 9

/** Variance of the rendering, as LUXFER_RENDER_VARIANCE; 3 channels. */
#define LUXFER_TRANSFER_RENDER_VARIANCE 10

/**
 * The rendering after a noise filter, if the settings of the stage RENDER ask for a preview; see
 * LUXFER_RENDER_PREVIEW.
 */
#define LUXFER_TRANSFER_RENDER_PREVIEW 11

/**
 * The scene with the emission before the stage RELIGHT solves for its factor: the texture times white_luminance of
 * luxfer_transfer_params, as bright as the lamps in the photo.
 */
#define LUXFER_SCENE_UNSOLVED 0

/** The scene with the solved emission: the result. */
#define LUXFER_SCENE_LIT 1

/** As LUXFER_SCENE_LIT, but the emission is white, at unchanged luminance; for comparison. */
#define LUXFER_SCENE_WHITE 2

/**
 * Gets the image that kind, a LUXFER_TRANSFER_ value, selects; a stage has made it. The caller releases *image. Any
 * thread.
 * LUXFER_NOT_READY before the stage that makes the image has ended; LUXFER_NOT_FOUND for a preview if
 * luxfer_render_params.preview was 0.
 */
luxfer_status luxfer_transfer_get_image(luxfer_transfer *transfer,
                                        luxfer_transfer_image kind,
                                        luxfer_image **image);

/**
 * Gets the scene that kind, a LUXFER_SCENE_ value, selects; the transfer has made it. The scene is independent of the
 * transfer. The caller releases *scene. Any thread.
 * LUXFER_NOT_READY if the stage that makes the scene has not ended: EMISSION for LUXFER_SCENE_UNSOLVED, RELIGHT for
 * the other scenes.
 */
luxfer_status luxfer_transfer_get_scene(luxfer_transfer *transfer,
                                        luxfer_transfer_scene kind,
                                        luxfer_scene **scene);

/**
 * Gets the time and the error of each stage. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before the first stage has ended.
 */
luxfer_status luxfer_transfer_get_report(luxfer_transfer *transfer,
                                         luxfer_transfer_report *report,
                                         size_t size);

/**
 * Gets the camera of the photo, and the unwarping of the plane. The camera was found from the lines and the lamps of
 * the photo, or set by luxfer_transfer_use_rectify. If view->undone is not 0, view->to_photo leads to pixels of the
 * undistorted photo. To make this photo, run a luxfer_rectify with luxfer_rectify_params.distortion = view->undone,
 * then call luxfer_rectify_undistort.
 * size is sizeof *view. Any thread.
 * LUXFER_NOT_READY before the stage VIEW has ended.
 */
luxfer_status luxfer_transfer_get_view(luxfer_transfer *transfer,
                                       struct luxfer_rectify_report *view,
                                       size_t size);

/**
 * Gets the solved colour and intensity of the emission and their confidence. size is sizeof *solution. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended.
 */
luxfer_status luxfer_transfer_get_solution(luxfer_transfer *transfer,
                                           struct luxfer_relight_report *solution,
                                           size_t size);

/**
 * Describes a lamp of the lit scene; index starts at 0. size is sizeof *fixture. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_NOT_FOUND if there is no such fixture.
 */
luxfer_status luxfer_transfer_get_fixture(luxfer_transfer *transfer,
                                          uint32_t index,
                                          luxfer_fixture *fixture,
                                          size_t size);

/**
 * Writes a list of all lamps of the lit scene (luminaire schedule) to a .csv or .json file: position, normal, axis,
 * size, area, luminance, flux and colour temperature. The names of the columns contain the units. In .json,
 * "outline_m" holds the corners of each outline in metres. path is UTF-8. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_INVALID_ARGUMENT for another extension; LUXFER_IO if
 * the file cannot be written.
 */
luxfer_status luxfer_transfer_save_fixtures(luxfer_transfer *transfer,
                                            const char *path);

/* ==================================================================================================================
 * Warnings
 *
 * Reasons to doubt the result of a job that has succeeded, or a scene that was loaded. A warning names the defect, a
 * measure of it (the severity) with the limit that it has passed, the place in the photo, and the remedy. Each stage
 * that has warnings has a list of them, a transfer has the lists of all its stages, and a scene has a list. A list is
 * a copy: it does not change when the stage is started again. An empty list does not prove that a result is right.
 * ================================================================================================================== */

/** A list of warnings. See luxfer_get_warnings. */
typedef struct luxfer_warnings luxfer_warnings;

/** The code of a warning: a LUXFER_WARNING_ value. Values are never changed or reused; new values may be added. */
typedef int32_t luxfer_warning_code;

/** A warning: a reason to doubt a result. */
typedef struct luxfer_warning {
    /** sizeof(luxfer_warning), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Kind of the warning: a LUXFER_WARNING_ value. */
    luxfer_warning_code code;
    /**
     * The stage whose result is in doubt: a LUXFER_STAGE_ value. For a luxfer_segment it is LUXFER_STAGE_LIGHTS if
     * luxfer_segment_set_region gave a mask, else LUXFER_STAGE_PLANE; for a luxfer_scene, and for the scene of a
     * luxfer_transfer, it is LUXFER_STAGE_SCENE; for a luxfer_guides or a luxfer_stylize it is LUXFER_STAGE_STYLIZE.
     */
    luxfer_stage stage;
    /** 1 if the warning points to a place, else 0. */
    uint32_t has_place;
    /**
     * The number that caused the warning; the comment of the LUXFER_WARNING_ value in the field code says what this
     * number measures.
     */
    double severity;
    /**
     * The limit that the severity has passed: an upper limit, unless the comment of the LUXFER_WARNING_ value says
     * that the severity is below the limit.
     */
    double limit;
    /**
     * The place, x and y in pixels of the photo; for a luxfer_guides or a luxfer_stylize, in pixels of the target or,
     * where the comment of the LUXFER_WARNING_ value says so, of the artwork. 0 if the warning has no place.
     */
    double place[2];
    /**
     * The defect: an English sentence, which for most warnings states the value of severity, in zero-terminated UTF-8.
     * The string lives as long as the luxfer_warnings.
     */
    const char *message;
    /** The remedy: an English sentence in zero-terminated UTF-8. The string lives as long as the luxfer_warnings. */
    const char *advice;
} luxfer_warning;

/**
 * The vanishing points determine the focal length poorly, so it was mainly assumed; the severity is the relative
 * standard deviation of the focal length, or the limit if the limit is larger.
 */
#define LUXFER_WARNING_FOCAL_ASSUMED 1

/** The directions of the room axes are uncertain; the severity is the largest standard deviation in radians. */
#define LUXFER_WARNING_VIEW_UNCERTAIN 2

/** The lens bends straight lines; the severity is the distortion of luxfer_rectify_report without its sign. */
#define LUXFER_WARNING_LENS_DISTORTION 3

/**
 * The walls do not meet at right angles, or the pixels are not square; the severity is the largest deviation of an
 * angle between two room axes from a right angle, in radians.
 */
#define LUXFER_WARNING_NOT_SQUARE 4

/**
 * There is no depth map, and the room that was fitted to the lines of the photo is uncertain. The severity is the
 * confidence of the fit, in [0, 1], which is below the limit; 0 if no room could be fitted.
 */
#define LUXFER_WARNING_LAYOUT_UNCERTAIN 5

/**
 * Much of the mask of a surface is unlike every stroke, or the mask of lamps leaves out regions that partly resemble
 * the painted or proposed lamps. The severity is the area of these doubtful pixels, divided by the area of the mask
 * and the doubtful pixels together. The warning points to the pixel where one more stroke helps most.
 */
#define LUXFER_WARNING_UNSEEN 6

/**
 * Positive and negative strokes cover the same pixels, where the later strokes count. The severity is the number of
 * these pixels, divided by the number of painted pixels that the segmentation learns from.
 */
#define LUXFER_WARNING_CONTRADICTORY_STROKES 7

/**
 * Pixels of strokes lie outside the photo and are ignored. The severity is the number of these pixels, divided by the
 * number of painted pixels that the segmentation learns from.
 */
#define LUXFER_WARNING_OFF_IMAGE_STROKES 8

/** A mask is uncertain; the severity is the expected share of wrong pixels. */
#define LUXFER_WARNING_UNCERTAIN_MASK 9

/** A mask has no pixel; the severity is 0, which is below the limit. */
#define LUXFER_WARNING_EMPTY_MASK 10

/**
 * A mask contradicts the strokes that it was made from; the severity is the share of the painted pixels that it
 * contradicts. The warning points to one of these pixels.
 */
#define LUXFER_WARNING_MISSED_STROKES 11

/** Lights cover much of their plane; the severity is the share of the plane that they cover. */
#define LUXFER_WARNING_ALMOST_ALL_LIT 12

/**
 * Much of the unwarped plane is magnified more than 4 times from the photo; the severity is the share of the plane
 * that is magnified so much. The warning points to the point with the largest magnification.
 */
#define LUXFER_WARNING_MAGNIFIED 13

/**
 * The camera sees the plane nearly edge-on. The severity is the median, over the plane, of the sine of the angle
 * between the plane and the viewing ray; it is below the limit. The warning points to the point with the smallest
 * angle.
 */
#define LUXFER_WARNING_PLANE_NEAR_HORIZON 14

/** The texture and the photo differ in the statistics of their lamps; the severity is luxfer_emission_report.error. */
#define LUXFER_WARNING_PATTERN_UNCERTAIN 15

/**
 * The photo shows too few whole lamps for a pattern; the severity is the number of whole lamps, which is below the
 * limit.
 */
#define LUXFER_WARNING_FEW_LAMPS 16

/**
 * No lattice was found on which the lamps lie, and the texture differs from the photo; the severity is
 * luxfer_emission_report.error.
 */
#define LUXFER_WARNING_NO_LATTICE 17

/** Colour channels do not meet their target; the severity is the number of these channels. */
#define LUXFER_WARNING_UNREACHABLE 18

/**
 * Channels of the target colour are only lower bounds (LUXFER_CONSTRAINT_AT_LEAST). A transfer sets such a bound if
 * the photo clips the channel in most pixels that the target colour is computed from. The severity is the number of
 * these channels.
 */
#define LUXFER_WARNING_TARGET_CLIPPED 19

/**
 * A scene is so high, so wide or so small that its unit is probably not the metre. The severity is the implausible
 * height or width in metres. For a scene that is too small, it is the larger of height and width, and is below the
 * limit. The message names the likely unit.
 */
#define LUXFER_WARNING_IMPLAUSIBLE_SIZE 20

/**
 * The file of a scene has a feature or an extension that is not rendered. The message names the feature and the first
 * objects that have it; the severity is the number of these objects.
 */
#define LUXFER_WARNING_NOT_RENDERED 21

/**
 * The painted lamps are hardly brighter than the plane: they are off, or face away. The severity is the probability
 * that a pixel painted as light is brighter than a pixel painted as plane; it is below the limit. The warning points
 * to the darkest lamp.
 */
#define LUXFER_WARNING_DIM_LAMPS 22

/**
 * A texture without any light would differ less from the photo than the texture that was synthesised first. The
 * severity is the error of that first texture. If LUXFER_LAW_BEST has then found a better texture by another law,
 * luxfer_emission_report.error is smaller than the severity. This warning replaces LUXFER_WARNING_PATTERN_UNCERTAIN.
 */
#define LUXFER_WARNING_NO_PATTERN 23

/**
 * A mask is only a proposal, because strokes are missing: for the plane, positive or negative strokes, or both; for
 * the lights, positive strokes. The severity is the expected share of wrong pixels.
 */
#define LUXFER_WARNING_PROPOSED 24

/**
 * A scene lies far from the origin. There are two cases. If luxfer_scene_get_origin is not 0, positions are relative
 * to that origin; the severity is its distance from the origin of the file in metres, and the limit is 0. Otherwise
 * coordinates of vertices are so large that floats round them; the severity is the step of the rounding in metres.
 */
#define LUXFER_WARNING_FAR_FROM_ORIGIN 25

/**
 * A scene has luminaires that shine from points: they are invisible in renderings, and luxfer_image_get_glare does not
 * rate them. The severity is the number of these luminaires; the message lists the first few with their positions.
 */
#define LUXFER_WARNING_NOT_IN_PICTURE 26

/**
 * Objects that this frame of a sequence shows are missing in the previous frame, or have other triangles there. Their
 * motion is unknown and therefore NaN. The severity is the share of the picture that shows these objects; the message
 * names them. The warning points to a pixel of the largest of these objects.
 */
#define LUXFER_WARNING_NO_COUNTERPART 27

/**
 * The motion of a stylisation contradicts the guides: at the end of a pixel's motion, the previous frame shows another
 * surface. If the targets of both frames come from luxfer_stylize_add_guides, the motion is compared with the exact
 * motion of their scenes. Otherwise the LUXFER_GUIDE_DATA guides, such as object codes or normals, of the pixel and of
 * the end of its motion are compared. Previews, and stylisations without such guides, skip this comparison of guides.
 * If nothing was compared, the warning does not occur. The severity is the share of pixels with wrong motion among the
 * pixels that were compared. The warning points to the pixel with the largest error.
 */
#define LUXFER_WARNING_MOTION_DISAGREES 28

/**
 * The target of a stylisation shows light that no usable place of the exemplar shows, for example a cast shadow if the
 * painted part of a half-painted picture has no shadow. The new paint there is a guess. The severity is the share of
 * such pixels among the pixels to paint; LUXFER_STYLIZE_IMAGE_GUIDE_ERROR shows them. The warning points to the place
 * of the target where most of them lie.
 */
#define LUXFER_WARNING_LIGHT_NOT_PAINTED 29

/**
 * Places of the exemplar with equal guides are painted in two ways, which a stylisation mixes. The severity is the
 * share of the exemplar that such places cover. The warning points to one of them in the artwork.
 */
#define LUXFER_WARNING_AMBIGUOUS_PAINT 30

/**
 * A small place of the artwork, such as a stain, is painted unlike all places with similar guides. The severity is the
 * difference in paint from this place that all but 5 % of the places with similar guides exceed, divided by the
 * typical difference in paint between places with equal guides. The warning points to the place in the artwork.
 */
#define LUXFER_WARNING_BLEMISH 31

/**
 * The sizes of the lamps in the photo contradict the perspective of the plane: the lamps hang or lie on several
 * planes, the mask of the lights shows other things, or the camera is wrong. Where the photo shows the plane k times
 * as large, it would show lamps on the plane k times as large, but shows these lamps k^severity times as large. Only
 * luxfer_transfer compares them, because luxfer_rectify does not know the lamps.
 */
#define LUXFER_WARNING_OFF_PLANE 32

/** Gets the number of warnings in a list. Any thread. */
luxfer_status luxfer_warnings_get_count(luxfer_warnings *warnings, uint32_t *count);

/**
 * Gets one warning of a list; index starts at 0. size is sizeof *warning. Any thread.
 * LUXFER_NOT_FOUND if index is beyond the end of the list.
 */
luxfer_status luxfer_warnings_get(luxfer_warnings *warnings,
                                  uint32_t index,
                                  luxfer_warning *warning,
                                  size_t size);

/**
 * Returns the name of a warning's code, such as "LUXFER_WARNING_UNSEEN"; "LUXFER_WARNING_UNKNOWN" for another number.
 * The string is static: never free it. Any thread.
 */
const char *luxfer_warning_get_name(luxfer_warning_code code);

/* ==================================================================================================================
 * Warnings of an object
 *
 * Gets the warnings of stages, transfers and scenes.
 * ================================================================================================================== */

/**
 * Gets the warnings about the result of an object. handle is one of:
 * - a luxfer_transfer: an implausible size of its scene, then the warnings of all stages that have a result, in their
 *   order;
 * - a luxfer_rectify: about the camera, and about the plane if it has been unwarped;
 * - a luxfer_features;
 * - a luxfer_segment: its mask, compared with the strokes and with the region as they are now;
 * - a luxfer_emission: about the texture; no warnings if luxfer_emission_start_composition has only composed a
 *   texture;
 * - a luxfer_relight;
 * - a luxfer_guides: about the latest motion that luxfer_guides_get_motion has computed for it;
 * - a luxfer_stylize: about the exemplar, the light and the motion of its latest result;
 * - a luxfer_scene: an implausible size, a place far from the origin, luminaires that are invisible in renderings,
 *   and features of its file that are not rendered.
 *
 * The caller releases *warnings. Any thread.
 * LUXFER_NOT_READY before a job has succeeded (of a transfer: before the first stage has ended);
 * LUXFER_INVALID_ARGUMENT if handle is of another kind.
 */
luxfer_status luxfer_get_warnings(void *handle,
                                  luxfer_warnings **warnings);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_TRANSFER_H */
