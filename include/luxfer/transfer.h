/* luxfer: the lighting transfer from end to end, and warnings.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_TRANSFER_H
#define LUXFER_TRANSFER_H

#include "render.h"
#include "stages.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ====================================================================================================================
 * Pattern
 *
 * Size, rotation and offset of the light pattern of a transfer on the surface, and the areas without lamps.
 * ==================================================================================================================== */

/** The length that sets the size of the pattern on the surface: a LUXFER_PATTERN_ value. */
typedef int32_t luxfer_pattern_scale;

/**
 * Layout of the pattern on the surface. luxfer_surface has the corner and the axes u and v of the surface.
 * Fill it with luxfer_pattern_params_init.
 */
typedef struct luxfer_pattern_params {
    /** sizeof(luxfer_pattern_params), set by luxfer_pattern_params_init. */
    uint32_t struct_size;
    /** LUXFER_PATTERN_ value; default LUXFER_PATTERN_DISTANCE. */
    luxfer_pattern_scale scale;
    /**
     * Length of the lamp or the spacing, in metres, in [1e-6, 1e6]; default 1. Only LUXFER_PATTERN_LAMP and
     * LUXFER_PATTERN_SPACING use it.
     */
    double length;
    /**
     * Size of a texel in metres, in [0, 1e6]; 0, the default: as fine as the unwarped photo, as far as max_texels of
     * luxfer_transfer_params allows.
     */
    double texel_size;
    /** Rotation of the pattern from u towards v in radians, in [-2 pi, 2 pi]; default 0. */
    double rotation;
    /**
     * Shift of the pattern along its own axes in metres, each in [-1e6, 1e6]; default 0. It moves lattices only: lamps
     * without a lattice have no fixed places and are not shifted.
     */
    double offset[2];
    /**
     * Minimum distance in metres of lamps from the edge of the surface and from the zones of
     * luxfer_transfer_set_zones, in [-1, 1e6]; lamps that are nearer are left out. With a value below 0, such as the
     * default -1, lamps at the edge of the surface stay, cut by the edge.
     */
    double margin;
} luxfer_pattern_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_pattern_params_init(luxfer_pattern_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_PATTERN_PARAMS, place, size);
}

/**
 * The distance of the photo's camera from the plane with the lights: plane_distance of luxfer_transfer_params, or if
 * that is 0, the estimate from the size of the lamps.
 */
#define LUXFER_PATTERN_DISTANCE 0

/** The length of a lamp: the median of the longer sides of the photo's lamps. */
#define LUXFER_PATTERN_LAMP 1

/**
 * The shorter period of the lattice of lamps; without a lattice, the median distance from a lamp to its nearest
 * neighbour.
 */
#define LUXFER_PATTERN_SPACING 2

/** The width of the surface: it shows as many lamps across as the plane in the photo. */
#define LUXFER_PATTERN_ACROSS 3

/* ====================================================================================================================
 * Transfer
 *
 * The lighting transfer from end to end: lights a scene as in a photo, from the photo and a few strokes. It runs the
 * stages in order. You can read every result as soon as its stage has ended, replace it by your own, and continue from
 * any stage.
 * ==================================================================================================================== */

/** A lighting transfer. See luxfer_transfer_create. */
typedef struct luxfer_transfer luxfer_transfer;

/** A stage of the transfer: a LUXFER_STAGE_ value. The values are in the order in which the stages run. */
typedef int32_t luxfer_stage;

/** The part of the photo that gives the colour to match: a LUXFER_TARGET_ value. */
typedef int32_t luxfer_target;

/**
 * Settings of a transfer. Fill them with luxfer_transfer_params_init. The structs behind the pointers are read during
 * the call.
 */
typedef struct luxfer_transfer_params {
    /** sizeof(luxfer_transfer_params), set by luxfer_transfer_params_init. */
    uint32_t struct_size;
    /** Maximum side of the emissive texture in texels, in [1, 16384]; default 2048. */
    uint32_t max_texels;
    /**
     * Distance of the photo's camera from the plane with the lights in metres, in [0.01, 1e4]. It sets the scale of
     * the pattern. 0, the default: estimated from the size of the lamps, which are mostly made to fit ceiling tiles;
     * plane_distance and plane_distance_error of luxfer_transfer_report state it.
     */
    double plane_distance;
    /**
     * Luminance of the photo's white in cd/m², in [1e-6, 1e9]; default 100, as matt white paper has in 314 lux. The
     * strength of the lamps is proportional to it. A photo alone does not determine this luminance: see proposed_white
     * of luxfer_transfer_report.
     */
    float white_luminance;
    /** LUXFER_TARGET_ value; default LUXFER_TARGET_SURFACE. */
    luxfer_target target;
    /** Settings of the stages VIEW and UNWARP; NULL, the default: their defaults. */
    const luxfer_rectify_params *rectify;
    /** Settings of the stage FEATURES; NULL, the default: their defaults. */
    const luxfer_features_params *features;
    /** Settings of the stage PLANE; NULL, the default: their defaults. */
    const luxfer_segment_params *plane;
    /** Settings of the stage LIGHTS; NULL, the default: the defaults with channels = 7, colour only. */
    const luxfer_segment_params *lights;
    /**
     * Settings of the stage EMISSION; NULL, the default: their defaults. The transfer sets width, height, scale and
     * offset itself.
     */
    const luxfer_emission_params *emission;
    /** Settings of the stage RELIGHT; NULL, the default: their defaults. */
    const luxfer_relight_params *relight;
    /** Settings of the stage RENDER; NULL, the default: their defaults. */
    const luxfer_render_params *render;
    /** Layout of the lights on the surface; NULL, the default: the defaults. */
    const luxfer_pattern_params *pattern;
} luxfer_transfer_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_transfer_params_init(luxfer_transfer_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_TRANSFER_PARAMS, place, size);
}

/** No stage, but a scene that was loaded: only in warnings. */
#define LUXFER_STAGE_SCENE -1

/** Finds lines, vanishing points and the photo's camera. */
#define LUXFER_STAGE_VIEW 0

/** Computes the ten channels of the features. */
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

/** Renders the picture. */
#define LUXFER_STAGE_RENDER 7

/** The plane that carries the lights, without the lights and their halo. */
#define LUXFER_TARGET_SURFACE 0

/** The whole photo. */
#define LUXFER_TARGET_WHOLE_IMAGE 1

/** Creates a transfer. The caller releases *transfer. Any thread. */
luxfer_status luxfer_transfer_create(luxfer_context *context, luxfer_transfer **transfer);

/** Sets the photo: linear RGB, 1 = display white. Strokes for a photo of another size are removed. Any thread. */
luxfer_status luxfer_transfer_set_photo(luxfer_transfer *transfer, luxfer_image *photo);

/** Sets a depth map of the photo, as luxfer_features_set_depth. depth may be NULL: no depth map. Any thread. */
luxfer_status luxfer_transfer_set_depth(luxfer_transfer *transfer,
                                        luxfer_image *depth,
                                        luxfer_depth_kind kind);

/**
 * Sets the scene to light, and the name (UTF-8) of the object or material whose surface receives the lights. The
 * transfer never changes the scene; each job uses the scene as it is when the job starts. Among the triangles of that
 * name it takes the plane that faces most of the room. The parts of this plane, for example between the beams of a
 * ceiling, share one pattern that continues from part to part. Triangles in other planes stay unchanged; light them by
 * another transfer with its own pattern. Any thread.
 */
luxfer_status luxfer_transfer_set_scene(luxfer_transfer *transfer,
                                        luxfer_scene *scene,
                                        const char *surface);

/**
 * Sets the triangles of the scene that receive the lights, mesh index and triangle index of each, instead of the named
 * surface. If they lie in several planes, the transfer takes the plane that faces most of the room, as for a named
 * surface. They replace earlier triangles, and luxfer_transfer_set_scene removes them. If count is 0, triangles may be
 * NULL, and the named surface receives the lights again. Any thread.
 * A job ends with LUXFER_INVALID_ARGUMENT if the scene does not have these triangles.
 */
luxfer_status luxfer_transfer_set_triangles(luxfer_transfer *transfer,
                                            const uint32_t *triangles,
                                            size_t count);

/**
 * Sets an emissive texture, linear RGB relative to the photo's white, that the stage EMISSION stretches over the
 * surface instead of making one from the photo. texture may be NULL, the default: make one. Any thread.
 */
luxfer_status luxfer_transfer_set_texture(luxfer_transfer *transfer,
                                          luxfer_image *texture);

/**
 * Sets the camera of the picture. camera may be NULL, the default: the first camera of the scene, or a camera in a
 * corner of the room if the scene has none. Any thread.
 */
luxfer_status luxfer_transfer_set_camera(luxfer_transfer *transfer,
                                         const luxfer_camera_params *camera);

/**
 * Sets the strokes on the photo. Strokes on lights count as strokes on the plane too. The transfer copies the strokes;
 * they replace earlier strokes; strokes may be NULL: no strokes. Any thread.
 * LUXFER_INVALID_ARGUMENT if they are for images of another size than the photo.
 */
luxfer_status luxfer_transfer_set_strokes(luxfer_transfer *transfer,
                                          luxfer_strokes *strokes);

/**
 * Sets rectangles of the surface without lamps, for example behind ducts and sprinklers: u0, v0, u1 and v1 of each in
 * metres from the surface's corner along its axes (luxfer_surface), with u0 <= u1 and v0 <= v1. They replace earlier
 * rectangles; zones may be NULL if count is 0. Any thread.
 */
luxfer_status luxfer_transfer_set_zones(luxfer_transfer *transfer,
                                        const double *zones,
                                        size_t count);

/**
 * Replaces the result of the stage VIEW by the lines and the camera of a luxfer_rectify and, if it has unwarped a
 * plane, the result of the stage UNWARP by that plane. The transfer then keeps this camera, even if its lamps suggest
 * another one. Any thread.
 * LUXFER_NOT_READY if rectify has no result yet.
 */
luxfer_status luxfer_transfer_use_rectify(luxfer_transfer *transfer,
                                          luxfer_rectify *rectify);

/**
 * Replaces the result of the stage FEATURES by that of a luxfer_features. Any thread.
 * LUXFER_NOT_READY if features has no result yet.
 */
luxfer_status luxfer_transfer_use_features(luxfer_transfer *transfer, luxfer_features *features);

/**
 * Replaces the result of the stage PLANE or LIGHTS by that of a luxfer_segment; phase, a LUXFER_PHASE_ value, chooses
 * the stage. Any thread.
 * LUXFER_NOT_READY if segment has no result yet.
 */
luxfer_status luxfer_transfer_use_segment(luxfer_transfer *transfer,
                                          luxfer_phase phase,
                                          luxfer_segment *segment);

/**
 * Replaces the result of the stage PLANE or LIGHTS by a mask of the photo's size, for example one drawn by hand;
 * phase, a LUXFER_PHASE_ value, chooses the stage. The mask has 1 channel, used as a confidence in [0, 1]. Any thread.
 */
luxfer_status luxfer_transfer_use_mask(luxfer_transfer *transfer,
                                       luxfer_phase phase,
                                       luxfer_image *mask);

/**
 * Starts a job that runs the stages from first to last, LUXFER_STAGE_ values, both included; the stages before first
 * must have results. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if a job runs already, or if an input or the result of an earlier stage is missing;
 * LUXFER_INVALID_ARGUMENT if a setting of a stage is out of range. The job may end with the statuses of its stages'
 * jobs; the message names the stage. It ends at once if the scene does not have the surface. The results of finished
 * stages stay.
 */
luxfer_status luxfer_transfer_start(luxfer_transfer *transfer,
                                    luxfer_stage first,
                                    luxfer_stage last,
                                    const luxfer_transfer_params *params,
                                    luxfer_job **job);

/* ====================================================================================================================
 * Transfer results
 *
 * The results of a transfer. A result is available once its stage has ended; the rendering is available in its current
 * state while it runs.
 * ==================================================================================================================== */

/** An image of the transfer: a LUXFER_TRANSFER_ value. */
typedef int32_t luxfer_transfer_image;

/** A scene of the transfer: a LUXFER_SCENE_ value. */
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
    /** Duration of each stage's last run in seconds, by LUXFER_STAGE_ value. */
    double seconds[8];
    /** Largest standard deviation of a vanishing point's direction, in radians. */
    double view_error;
    /** Mean confidence of the features' depth, in [0, 1]. */
    double depth_confidence;
    /** Expected share of wrong pixels in the mask of the plane. */
    double plane_error;
    /** Expected share of wrong pixels in the mask of the lights. */
    double lights_error;
    /** Largest expected error of a corner of the unwarped image, in unwarped pixels. */
    double unwarp_error;
    /**
     * As the field error of luxfer_emission_report: largest relative difference between texture and photo in three
     * statistics of their lamps.
     */
    double emission_error;
    /** Largest relative half-width of the solution's 95 % confidence intervals. */
    double relight_error;
    /**
     * As the field error of luxfer_render_report: root mean square of the rendering's standard errors, divided by its
     * mean.
     */
    double render_error;
    /** Size of a texel of the emission in metres. */
    double texel_size;
    /** Mean colour that the surface should have, relative to the photo's white. */
    float target[3];
    /** 0. */
    uint32_t reserved;
    /**
     * Distance in metres of the photo's camera from the plane that corresponds to the size of the pattern on the
     * surface; NaN before the stage EMISSION has ended, and if the caller gave the texture.
     */
    double plane_distance;
    /**
     * Relative standard deviation of plane_distance if it is estimated from the size of the lamps: about 0.25 for
     * lamps of a usual size, 0.6 if the lamps do not determine it. 0 if the settings determine the distance.
     */
    double plane_distance_error;
    /**
     * Value proposed for luxfer_transfer_params.white_luminance in cd/m²: the white_luminance of luxfer_photo_metadata
     * if the photo's file states the exposure, else 159, the luminance of white paper in the 500 lux of an office.
     */
    double proposed_white;
    /**
     * Lower bound of proposed_white: white_luminance_low if the photo's file states the exposure, else 32, for the 100
     * lux of a corridor.
     */
    double proposed_white_low;
    /**
     * Upper bound of proposed_white: white_luminance_high if the photo's file states the exposure, else 318, for 1000
     * lux.
     */
    double proposed_white_high;
} luxfer_transfer_report;

/** One lamp of the lit scene. */
typedef struct luxfer_fixture {
    /** sizeof(luxfer_fixture), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Centre in metres. */
    float position[3];
    /** Unit vector of the direction in which the lamp shines. */
    float normal[3];
    /** Unit vector of the long axis. */
    float axis[3];
    /** Mean luminance per channel in cd/m². */
    float radiance[3];
    /** Number of the lamp's kind, as in luxfer_luminaire. */
    uint32_t kind;
    /** Length along the long axis and across it, in metres. */
    double size[2];
    /** Area in m². */
    double area;
    /** Luminous flux in lumens. */
    double flux;
    /** Correlated colour temperature in kelvin; 0 for a lamp that is off. */
    double cct;
    /** Distance from the blackbody locus in the CIE 1960 diagram. */
    double duv;
} luxfer_fixture;

/** The ten channels of the features. */
#define LUXFER_TRANSFER_FEATURES 0

/** 1 on the plane, else 0; 1 channel. */
#define LUXFER_TRANSFER_PLANE_MASK 1

/** Probability that a pixel is on the plane; 1 channel. */
#define LUXFER_TRANSFER_PLANE_CONFIDENCE 2

/** 1 on lights, else 0; 1 channel. */
#define LUXFER_TRANSFER_LIGHTS_MASK 3

/** Probability that a pixel is a light; 1 channel. */
#define LUXFER_TRANSFER_LIGHTS_CONFIDENCE 4

/** The plane seen straight on, linear RGB. */
#define LUXFER_TRANSFER_UNWARPED 5

/** 1 where the photo shows the plane, else 0; 1 channel. */
#define LUXFER_TRANSFER_UNWARPED_VALID 6

/** The emissive texture, linear RGB relative to the photo's white. */
#define LUXFER_TRANSFER_EMISSION 7

/** 1 on lamps of the texture, else 0; 1 channel. */
#define LUXFER_TRANSFER_EMISSION_MASK 8

/** The scene in its new light, linear RGB in cd/m²; in its current state while the rendering runs. */
#define LUXFER_TRANSFER_RENDER 9

/** Variance of the rendering; 3 channels. */
#define LUXFER_TRANSFER_RENDER_VARIANCE 10

/**
 * The rendering after a noise filter, if the settings of the stage RENDER have a preview; see LUXFER_RENDER_PREVIEW.
 */
#define LUXFER_TRANSFER_RENDER_PREVIEW 11

/** The scene with the emission as bright as in the photo, before the stage RELIGHT solves for its factor. */
#define LUXFER_SCENE_UNSOLVED 0

/** The scene with the solved emission: the result. */
#define LUXFER_SCENE_LIT 1

/** As LUXFER_SCENE_LIT, with white light of equal luminance. */
#define LUXFER_SCENE_WHITE 2

/**
 * Gets an image; which is a LUXFER_TRANSFER_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before the stage that makes it has ended; LUXFER_NOT_FOUND for a preview if
 * luxfer_render_params.preview was 0.
 */
luxfer_status luxfer_transfer_get_image(luxfer_transfer *transfer,
                                        luxfer_transfer_image which,
                                        luxfer_image **image);

/**
 * Gets a scene; which is a LUXFER_SCENE_ value. The caller releases *scene, which is independent of the transfer. Any
 * thread.
 * LUXFER_NOT_READY before the stage EMISSION has ended, for LUXFER_SCENE_UNSOLVED, or the stage RELIGHT, for the
 * others.
 */
luxfer_status luxfer_transfer_get_scene(luxfer_transfer *transfer,
                                        luxfer_transfer_scene which,
                                        luxfer_scene **scene);

/**
 * Gets time and error of each stage. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before the first stage has ended.
 */
luxfer_status luxfer_transfer_get_report(luxfer_transfer *transfer,
                                         luxfer_transfer_report *report,
                                         size_t size);

/**
 * Gets the camera that was found from the lines of the photo, and the unwarping of the plane. size is sizeof *view.
 * Any thread.
 * LUXFER_NOT_READY before the stage VIEW has ended.
 */
luxfer_status luxfer_transfer_get_view(luxfer_transfer *transfer,
                                       luxfer_rectify_report *view,
                                       size_t size);

/**
 * Gets the solved colour and intensity and their confidence. size is sizeof *solution. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended.
 */
luxfer_status luxfer_transfer_get_solution(luxfer_transfer *transfer,
                                           luxfer_relight_report *solution,
                                           size_t size);

/**
 * Describes a lamp of the lit scene. size is sizeof *fixture. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_NOT_FOUND if there is no such fixture.
 */
luxfer_status luxfer_transfer_get_fixture(luxfer_transfer *transfer,
                                          uint32_t index,
                                          luxfer_fixture *fixture,
                                          size_t size);

/**
 * Writes the luminaire schedule, a list of all lamps of the lit scene, to a .csv or .json file: position, normal,
 * axis, size, area, luminance, flux and colour temperature; the names of the columns contain the units. In .json,
 * "outline_m" holds the corners of the outline in metres. path is UTF-8. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_INVALID_ARGUMENT for another extension; LUXFER_IO if the
 * file cannot be written.
 */
luxfer_status luxfer_transfer_save_fixtures(luxfer_transfer *transfer,
                                            const char *path);

/* ====================================================================================================================
 * Warnings
 *
 * Reasons to doubt the result of a job that has succeeded, or a scene that was loaded. A warning names the defect, its
 * figure and limit, the place in the photo, and the remedy. Each stage that reads the photo has a list, a transfer has
 * the lists of all its stages, and a scene has one. A list is a copy, which stays as it is when the stage is started
 * again. An empty list does not prove a result right.
 * ==================================================================================================================== */

/** A list of warnings. See luxfer_get_warnings. */
typedef struct luxfer_warnings luxfer_warnings;

/** The code of a warning: a LUXFER_WARNING_ value. Values are never changed or reused; new ones may be added. */
typedef int32_t luxfer_warning_code;

/** A reason to doubt a result. */
typedef struct luxfer_warning {
    /** sizeof(luxfer_warning), set by the function that fills the struct. */
    uint32_t struct_size;
    /** LUXFER_WARNING_ value. */
    luxfer_warning_code code;
    /**
     * The stage whose result is in doubt, a LUXFER_STAGE_ value. For a luxfer_segment it is LIGHTS if
     * luxfer_segment_set_region gave a mask, else PLANE; for a luxfer_scene it is SCENE.
     */
    luxfer_stage stage;
    /** 1 if the warning has a place in the photo, else 0. */
    uint32_t has_place;
    /** The figure that caused the warning; its meaning depends on the code. */
    double severity;
    /** The limit that the figure has passed. */
    double limit;
    /** The place in the photo, x and y in pixels; 0 without one. */
    double place[2];
    /**
     * The defect, in English and with its figure: zero-terminated UTF-8. The strings live as long as the
     * luxfer_warnings.
     */
    const char *message;
    /** The remedy. */
    const char *advice;
} luxfer_warning;

/**
 * The vanishing points do not determine the focal length, which was assumed; the severity is the relative standard
 * deviation of the focal length.
 */
#define LUXFER_WARNING_FOCAL_ASSUMED 1

/** The directions of the room axes are uncertain; the severity is the largest standard deviation in radians. */
#define LUXFER_WARNING_VIEW_UNCERTAIN 2

/** The lens bends straight lines; the severity is the distortion of luxfer_rectify_report without its sign. */
#define LUXFER_WARNING_LENS_DISTORTION 3

/**
 * The walls do not meet at right angles, or the pixels are not square; the severity is the largest deviation in
 * radians.
 */
#define LUXFER_WARNING_NOT_SQUARE 4

/**
 * There is no depth map, and the room that was fitted to the lines of the photo is uncertain; the severity is the
 * confidence of the fit, below the limit.
 */
#define LUXFER_WARNING_LAYOUT_UNCERTAIN 5

/**
 * Much of a mask is unlike every stroke, or the mask leaves out regions that partly resemble the painted lamps; the
 * severity is the share of these pixels in the mask and these regions. The place is the pixel where one more stroke
 * helps most.
 */
#define LUXFER_WARNING_UNSEEN 6

/**
 * Strokes of both classes cover the same pixels; the severity is the number of these pixels, divided by the number of
 * samples drawn from the strokes.
 */
#define LUXFER_WARNING_CONTRADICTORY_STROKES 7

/**
 * Pixels of strokes lie outside the photo; the severity is the number of these pixels, divided by the number of
 * samples drawn from the strokes.
 */
#define LUXFER_WARNING_OFF_IMAGE_STROKES 8

/** A mask is uncertain; the severity is the expected share of wrong pixels. */
#define LUXFER_WARNING_UNCERTAIN_MASK 9

/** A mask has no pixel; the severity is 0, below the limit. */
#define LUXFER_WARNING_EMPTY_MASK 10

/**
 * A mask contradicts the strokes that it was made from; the severity is the share of the painted pixels that it
 * contradicts. The place is one of these pixels.
 */
#define LUXFER_WARNING_MISSED_STROKES 11

/** Lights cover much of their plane; the severity is the share of the plane that they cover. */
#define LUXFER_WARNING_ALMOST_ALL_LIT 12

/**
 * Much of the unwarped plane is strongly magnified from the photo; the severity is the share of the plane that is
 * strongly magnified. The place is the point with the largest magnification.
 */
#define LUXFER_WARNING_MAGNIFIED 13

/**
 * The camera sees the plane nearly edge-on; the severity is the median over the plane of the sine of the angle between
 * the plane and the viewing ray, below the limit. The place is the point with the smallest angle.
 */
#define LUXFER_WARNING_PLANE_NEAR_HORIZON 14

/** The texture differs from the photo in its statistics; the severity is the error of luxfer_emission_report. */
#define LUXFER_WARNING_PATTERN_UNCERTAIN 15

/** The photo shows too few whole lamps for a pattern; the severity is their number, below the limit. */
#define LUXFER_WARNING_FEW_LAMPS 16

/** The lamps lie on no lattice that could be found; the severity is the error of luxfer_emission_report. */
#define LUXFER_WARNING_NO_LATTICE 17

/** Colour channels do not meet their target; the severity is their number. */
#define LUXFER_WARNING_UNREACHABLE 18

/**
 * The photo clips channels of the target, which are then lower bounds; the severity is the number of these channels.
 */
#define LUXFER_WARNING_TARGET_CLIPPED 19

/**
 * A scene is so high, so wide or so small that its unit is hardly the metre; the severity is this extent in metres,
 * below the limit if the scene is too small. The message names the likely unit.
 */
#define LUXFER_WARNING_IMPLAUSIBLE_SIZE 20

/**
 * The file of a scene has a feature or an extension that is not rendered, which the message names with the first
 * objects that have it; the severity is their number.
 */
#define LUXFER_WARNING_NOT_RENDERED 21

/**
 * The painted lamps are hardly brighter than the plane: they are off, or face away; the severity is the probability
 * that a pixel painted as light is brighter than one painted as plane, below the limit. The place is on the darkest
 * lamp.
 */
#define LUXFER_WARNING_DIM_LAMPS 22

/**
 * A texture without light would differ less from the photo than this one; the severity is the error of
 * luxfer_emission_report. It takes the place of LUXFER_WARNING_PATTERN_UNCERTAIN.
 */
#define LUXFER_WARNING_NO_PATTERN 23

/**
 * A mask is a proposal, because strokes of one class for the plane, or positive strokes for the lights, are missing;
 * the severity is the share of the mask that is expected to be wrong.
 */
#define LUXFER_WARNING_PROPOSED 24

/**
 * A scene lies far from the origin. If its positions are relative to an origin of its own (luxfer_scene_get_origin),
 * the severity is the distance of that origin in metres, above a limit of 0; if coordinates of its vertices are so
 * large that floats have rounded them, it is the step of the rounding in metres.
 */
#define LUXFER_WARNING_FAR_FROM_ORIGIN 25

/**
 * Luminaires of a scene shine from points: no picture shows them, and luxfer_image_get_glare does not rate them; the
 * severity is their number, and the message lists the first ones with their positions.
 */
#define LUXFER_WARNING_NOT_IN_PICTURE 26

/** Counts the warnings of a list. Any thread. */
luxfer_status luxfer_warnings_get_count(luxfer_warnings *warnings, uint32_t *count);

/**
 * Gets a warning of a list. size is sizeof *warning. Any thread.
 * LUXFER_NOT_FOUND if there is no such warning.
 */
luxfer_status luxfer_warnings_get(luxfer_warnings *warnings,
                                  uint32_t index,
                                  luxfer_warning *warning,
                                  size_t size);

/**
 * The name of a warning's code, such as "LUXFER_WARNING_UNSEEN"; "LUXFER_WARNING_UNKNOWN" for another number. The
 * string is static: never free it. Any thread.
 */
const char *luxfer_warning_get_name(luxfer_warning_code code);

/* ====================================================================================================================
 * Warnings of an object
 *
 * Stages, transfers and scenes have warnings.
 * ==================================================================================================================== */

/**
 * Gets the warnings about the result of an object. handle is one of:
 * - a luxfer_transfer: the warnings of all stages that have a result, in their order;
 * - a luxfer_rectify: about the camera, and about the plane if it has been unwarped;
 * - a luxfer_features;
 * - a luxfer_segment: its mask, compared with the strokes and with the region as they are now;
 * - a luxfer_emission: about the texture; a plan has no warnings;
 * - a luxfer_relight;
 * - a luxfer_scene: an implausible size, a place far from the origin, luminaires that no picture shows, and features
 *   of its file that are not rendered.
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
