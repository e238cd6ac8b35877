/* luxfer: the stages of a lighting transfer, one by one.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_STAGES_H
#define LUXFER_STAGES_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ====================================================================================================================
 * Plane geometry
 *
 * Homographies: maps between two views of a plane, as 3 x 3 matrices of homogeneous points in row-major order. Points
 * are in pixels, x to the right, y down; the centre of the top-left pixel is (0.5, 0.5). These calls return when their
 * work is done.
 * ==================================================================================================================== */

/**
 * Computes the homography that maps four points to four points: from and to hold x and y of each point, homography
 * receives the nine entries of the matrix, scaled to unit Frobenius norm. Any thread.
 * LUXFER_DEGENERATE if three of the points lie on one line, or if points coincide or are not finite.
 */
luxfer_status luxfer_homography_from_corners(luxfer_context *context,
                                             const double *from,
                                             const double *to,
                                             double *homography);

/**
 * Warps an image by a homography into a new image of width x height pixels, each in [1, 65536]: the pixel at p takes
 * the value of the source at to_source(p), where to_source holds the nine entries of the matrix. Pixels outside the
 * source become 0. The source is interpolated where it is magnified, and averaged over the pixel's footprint where it
 * is minified. Takes a few milliseconds per megapixel. The caller releases *warped. Any thread.
 * LUXFER_INVALID_ARGUMENT if an entry is not finite or a size is out of range; LUXFER_OUT_OF_MEMORY beyond the memory
 * budget.
 */
luxfer_status luxfer_image_warp(luxfer_image *source,
                                const double *to_source,
                                uint32_t width,
                                uint32_t height,
                                luxfer_image **warped);

/* ====================================================================================================================
 * Rectification
 *
 * Finds vanishing points and the camera from the straight lines of a photo and, if a mask marks a plane, unwarps that
 * plane to a frontal view. Image points are in pixels, x to the right, y down; the centre of the top-left pixel is
 * (0.5, 0.5). Room axes 0 and 2 are horizontal, axis 1 is vertical; camera space is x to the right, y down, z forward.
 * ==================================================================================================================== */

/** Lines, vanishing points and the unwarped plane of a photo. See luxfer_rectify_create. */
typedef struct luxfer_rectify luxfer_rectify;

/** Detector of lines: a LUXFER_LINES_ value. */
typedef int32_t luxfer_lines;

/** Search for vanishing points: a LUXFER_SEARCH_ value. */
typedef int32_t luxfer_search;

/** Distance of a vanishing point from a line, for LUXFER_SEARCH_SUCCESSIVE: a LUXFER_METRIC_ value. */
typedef int32_t luxfer_metric;

/** Settings of a rectification. Fill them with luxfer_rectify_params_init. */
typedef struct luxfer_rectify_params {
    /** sizeof(luxfer_rectify_params), set by luxfer_rectify_params_init. */
    uint32_t struct_size;
    /** LUXFER_LINES_ value; default LUXFER_LINES_REGIONS. */
    luxfer_lines detector;
    /** LUXFER_SEARCH_ value; default LUXFER_SEARCH_MANHATTAN. */
    luxfer_search search;
    /** LUXFER_METRIC_ value; default LUXFER_METRIC_SEGMENT. */
    luxfer_metric metric;
    /**
     * Half-width in radians of the band around the gradient's direction that votes for a line, in [1e-4, pi/2], for
     * LUXFER_LINES_HOUGH; default 0.0436, which is 2.5 degrees.
     */
    double hough_band;
    /**
     * Focal length in pixels, > 0; 0, the default: estimated from the lines, and from the photo's metadata if it has
     * any.
     */
    double focal;
    /** Principal point in pixels; NaN, the default: the image's centre. */
    double principal[2];
    /**
     * The two room axes that the plane spans, each 0, 1 or 2; -1, the default: estimated from the lines on the plane.
     */
    int32_t plane_axes[2];
    /**
     * Largest side of the unwarped image in pixels, in [16, 16384]; default 2048. The image is smaller if the
     * resolution of the photo does not support this size.
     */
    uint32_t max_side;
    /** Must be 0. */
    uint32_t reserved;
    /**
     * Largest magnification of the photo, > 0; default 16. Parts of the plane that are so far away that they would be
     * magnified more are cut off.
     */
    double max_magnification;
    /** Seed of the search; default 1. */
    uint64_t seed;
} luxfer_rectify_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_rectify_params_init(luxfer_rectify_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_RECTIFY_PARAMS, place, size);
}

/** An image of a rectification: a LUXFER_RECTIFY_ value. */
typedef int32_t luxfer_rectify_image;

/** Where a focal length came from: a LUXFER_FOCAL_ value. */
typedef int32_t luxfer_focal_source;

/** The camera found from the lines of a photo, and the unwarping of the plane. */
typedef struct luxfer_rectify_report {
    /** sizeof(luxfer_rectify_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of line segments found. */
    uint32_t segments;
    /**
     * Vanishing points of the room axes, in homogeneous pixel coordinates of unit length; the third coordinate is 0 at
     * infinity.
     */
    double vanishing_points[3][3];
    /** Standard deviations of the directions of the vanishing points in camera space, in radians. */
    double vanishing_errors[3];
    /** Number of segments that agree with each vanishing point; 0: derived from the other two. */
    uint32_t vanishing_support[3];
    /** LUXFER_FOCAL_ value. */
    luxfer_focal_source focal_source;
    /** Focal length in pixels. */
    double focal;
    /** Principal point in pixels. */
    double principal[2];
    /** Room axes as unit vectors in camera space. */
    double axes[3][3];
    /** 1 if the plane has been unwarped; 0 if not: the fields from to_photo to aspect_confidence are then 0. */
    uint32_t is_unwarped;
    /** Must be 0. */
    uint32_t reserved;
    /** Homography from unwarped pixels to photo pixels, row by row. */
    double to_photo[9];
    /** Corners of the unwarped rectangle in the photo, x and y in pixels. */
    double corners[4][2];
    /** Expected error of each corner, in unwarped pixels. */
    double corner_errors[4];
    /** Size of an unwarped pixel, divided by the camera's distance from the plane. */
    double pixel_size;
    /** Confidence of the aspect ratio, in [0, 1]: low if the focal length was assumed. */
    double aspect_confidence;
    /**
     * Lens distortion: the outward shift of the corners of the photo, as a share of their distance from its centre;
     * below 0 for barrel distortion, as of wide-angle lenses. It is estimated from the curvature of straight edges,
     * and not corrected. NaN if the photo has too few lines.
     */
    double distortion;
    /** Standard deviation of distortion; NaN if distortion is NaN. */
    double distortion_error;
    /**
     * For each axis, the deviation from 90 degrees, in radians, of the angle between the two other axes, each
     * estimated from its own lines alone. Oblique walls, pixels that are not square and a wrong principal point show
     * here; axes is orthogonal in any case. NaN if one of the two axes has no lines.
     */
    double squareness[3];
    /** Standard deviations of squareness; NaN where squareness is NaN. */
    double squareness_errors[3];
} luxfer_rectify_report;

/** Segments from regions of similar gradient direction, with sub-pixel end points. */
#define LUXFER_LINES_REGIONS 0

/** The paper's method: gradient-restricted Hough transform of Canny edges. */
#define LUXFER_LINES_HOUGH 1

/** Searches three orthogonal directions and the focal length together, then refines each direction freely. */
#define LUXFER_SEARCH_MANHATTAN 0

/** The paper's method: one group of lines after the other. */
#define LUXFER_SEARCH_SUCCESSIVE 1

/** The paper's measure, evaluated on the detected segment; finite for vanishing points at infinity. */
#define LUXFER_METRIC_SEGMENT 0

/** The measure as printed in the paper (Eq. 2), evaluated on the whole visible line. */
#define LUXFER_METRIC_VISIBLE_LINE 1

/** Set by the caller. */
#define LUXFER_FOCAL_GIVEN 0

/** Estimated from vanishing points of orthogonal directions. */
#define LUXFER_FOCAL_FROM_VANISHING_POINTS 1

/** Assumed: 0.85 times the width of the photo. */
#define LUXFER_FOCAL_ASSUMED 2

/** Mainly from the metadata of the photo's file; see luxfer_image_get_metadata. */
#define LUXFER_FOCAL_FROM_METADATA 3

/** Estimated so that lamps of one kind look alike when their plane is seen straight on (lighting transfer only). */
#define LUXFER_FOCAL_FROM_LAMPS 4

/** The plane in frontal view, linear RGB. */
#define LUXFER_RECTIFY_UNWARPED 0

/** 1 where the photo shows the plane, else 0; 1 channel. */
#define LUXFER_RECTIFY_VALID 1

/** Creates the stage. The caller releases *rectify. Any thread. */
luxfer_status luxfer_rectify_create(luxfer_context *context, luxfer_rectify **rectify);

/** Sets the photo: linear RGB. Any thread. */
luxfer_status luxfer_rectify_set_photo(luxfer_rectify *rectify, luxfer_image *photo);

/**
 * Sets the mask of the plane to unwarp: 1 on it, 0 elsewhere; 1 channel, the photo's size. mask may be NULL: then the
 * job finds only lines and vanishing points. Any thread.
 */
luxfer_status luxfer_rectify_set_mask(luxfer_rectify *rectify,
                                      luxfer_image *mask);

/**
 * Starts a job that finds lines, vanishing points and the camera, unless they are known for this photo from an earlier
 * job, and unwarps the plane if its mask is set. params may be NULL for the defaults. The caller releases *job. Any
 * thread.
 * LUXFER_INVALID_OPERATION if the photo is missing or a job runs already. The job may end with LUXFER_DEGENERATE if
 * there are no lines or the plane is seen edge-on, LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of
 * range.
 */
luxfer_status luxfer_rectify_start(luxfer_rectify *rectify,
                                   const luxfer_rectify_params *params,
                                   luxfer_job **job);

/**
 * Gets an image of the result; which is a LUXFER_RECTIFY_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job with a mask has succeeded.
 */
luxfer_status luxfer_rectify_get_image(luxfer_rectify *rectify,
                                       luxfer_rectify_image which,
                                       luxfer_image **image);

/**
 * Unwarps another image of the photo's size, such as the confidence of the lights, by the homography of the plane;
 * pixels outside the photo become 0. Returns when its work is done, after a few milliseconds per megapixel. The caller
 * releases *warped. Any thread.
 * LUXFER_NOT_READY before a job with a mask has succeeded; LUXFER_INVALID_ARGUMENT if the size differs.
 */
luxfer_status luxfer_rectify_warp(luxfer_rectify *rectify,
                                  luxfer_image *source,
                                  luxfer_image **warped);

/**
 * Gets the results and their errors. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_rectify_get_report(luxfer_rectify *rectify,
                                        luxfer_rectify_report *report,
                                        size_t size);

/* ====================================================================================================================
 * Features
 *
 * Computes the features of each pixel of a photo, for segmentation: ten channels, L*, a*, b* (CIELAB, D65), depth,
 * position x, y, z and normal x, y, z. The depth comes from one of four sources: a depth map that the caller
 * supplies; a network in an ONNX file that the caller supplies; a box-shaped room that is fitted to the lines found by
 * a luxfer_rectify and to strokes on one of the room's planes; or a fixed default that does not depend on the photo.
 * ==================================================================================================================== */

/** The features of a photo. See luxfer_features_create. */
typedef struct luxfer_features luxfer_features;

/** Quantity that a depth map measures: a LUXFER_DEPTH_ value. */
typedef int32_t luxfer_depth_kind;

/**
 * How the photo's colours are normalised for a network, whose file does not state it: a LUXFER_NORMALISATION_ value.
 */
typedef int32_t luxfer_normalisation;

/** Settings of the features. Fill them with luxfer_features_params_init. */
typedef struct luxfer_features_params {
    /** sizeof(luxfer_features_params), set by luxfer_features_params_init. */
    uint32_t struct_size;
    /** Near plane of the paper's Eq. 1, in its own units, in [1e-3, 1e3]; default 1. */
    float near_plane;
    /** Far plane of Eq. 1, in [1.001, 1e6] times near_plane; default 10. */
    float far_plane;
    /**
     * Half-width in pixels of the window in which normals are fitted, in [0, 64]; default 0: chosen by the photo's
     * size.
     */
    uint32_t normal_radius;
} luxfer_features_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_features_params_init(luxfer_features_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_FEATURES_PARAMS, place, size);
}

/** An image of the features: a LUXFER_FEATURES_ value. */
typedef int32_t luxfer_features_image;

/** Source of the depth: a LUXFER_DEPTH_FROM_ value. */
typedef int32_t luxfer_depth_source;

/** Quality of the features. */
typedef struct luxfer_features_report {
    /** sizeof(luxfer_features_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** LUXFER_DEPTH_FROM_ value. */
    luxfer_depth_source depth_source;
    /** Mean confidence of the depth, in [0, 1]. */
    double depth_confidence;
    /**
     * Number of pixels of the photo that were NaN, infinite or negative and were replaced by values of their
     * neighbours.
     */
    uint64_t replaced_pixels;
} luxfer_features_report;

/** Distance along the viewing axis. */
#define LUXFER_DEPTH_ALONG_Z 0

/** Distance along the ray of each pixel. */
#define LUXFER_DEPTH_ALONG_RAY 1

/** The ten channels; luxfer_image_read reads up to four of them at a time. */
#define LUXFER_FEATURES_CHANNELS 0

/** Confidence of the depth of each pixel, in [0, 1]; 1 channel. */
#define LUXFER_FEATURES_DEPTH_CONFIDENCE 1

/**
 * The depth along z that a network has estimated, from near_plane to far_plane; 1 channel. Set it as the depth map of
 * later jobs, or of a luxfer_transfer, to avoid running the network again.
 */
#define LUXFER_FEATURES_NETWORK_DEPTH 2

/**
 * Chosen by the size of the network's input: LUXFER_NORMALISATION_IMAGENET for 256 x 256, else
 * LUXFER_NORMALISATION_HALF.
 */
#define LUXFER_NORMALISATION_BY_SIZE 0

/** (sRGB - (0.485, 0.456, 0.406)) / (0.229, 0.224, 0.225), for MiDaS 2.1, large and small. */
#define LUXFER_NORMALISATION_IMAGENET 1

/** (sRGB - 0.5) / 0.5, for DPT. */
#define LUXFER_NORMALISATION_HALF 2

/** No normalisation: sRGB in [0, 1]. */
#define LUXFER_NORMALISATION_NONE 3

/** The caller's depth map. */
#define LUXFER_DEPTH_FROM_CALLER 0

/** A box-shaped room fitted to the lines of the photo and to strokes. */
#define LUXFER_DEPTH_FROM_LAYOUT 1

/** A neutral guess that does not depend on the photo. */
#define LUXFER_DEPTH_FROM_NOTHING 2

/** The caller's network. */
#define LUXFER_DEPTH_FROM_NETWORK 3

/** Creates the stage. The caller releases *features. Any thread. */
luxfer_status luxfer_features_create(luxfer_context *context, luxfer_features **features);

/** Sets the photo: linear RGB, 1 = display white. Strokes for a photo of another size are removed. Any thread. */
luxfer_status luxfer_features_set_photo(luxfer_features *features, luxfer_image *photo);

/**
 * Sets a depth map of the photo's size, 1 channel, in any unit; values that are not positive and finite are holes.
 * kind is a LUXFER_DEPTH_ value. depth may be NULL: no depth map. Any thread.
 */
luxfer_status luxfer_features_set_depth(luxfer_features *features,
                                        luxfer_image *depth,
                                        luxfer_depth_kind kind);

/**
 * Sets a network in an ONNX file that estimates depth if there is no depth map; path is UTF-8. The network has one
 * input, the photo as a float tensor [1, 3, rows, columns] of any size up to 4096; its first output is a map of
 * relative inverse depth, as of MiDaS and DPT. The map is normalised by its extremes: the nearest pixel lies on
 * near_plane, the farthest on far_plane. normalisation is a LUXFER_NORMALISATION_ value. path may be NULL: no network.
 * The call reads the file, which is not needed afterwards. Any thread.
 * LUXFER_IO if the file cannot be read, LUXFER_FORMAT if it is damaged, LUXFER_UNSUPPORTED if it needs an operator
 * that the library does not support, or if the library was built without the Cargo feature onnx.
 */
luxfer_status luxfer_features_set_network(luxfer_features *features,
                                          const char *path,
                                          luxfer_normalisation normalisation);

/**
 * Sets the lines and the camera from the latest result of a luxfer_rectify of this photo. rectify may be NULL: no
 * lines. Any thread.
 * LUXFER_NOT_READY if rectify has no result yet.
 */
luxfer_status luxfer_features_set_view(luxfer_features *features,
                                       luxfer_rectify *rectify);

/**
 * Sets strokes that guide the fit of a room to lines (luxfer_features_set_view); they have no effect if the depth
 * comes from another source. The fit prefers boxes that have a face, such as the ceiling with the lights, with these
 * two properties: it contains all positive strokes, those for LUXFER_PHASE_PLANE as well as those on lights; and it
 * contains no negative stroke for LUXFER_PHASE_PLANE. The stage copies the strokes, which replace earlier strokes;
 * NULL removes them. Any thread.
 * LUXFER_INVALID_ARGUMENT if they are for images of another size than the photo.
 */
luxfer_status luxfer_features_set_strokes(luxfer_features *features,
                                          luxfer_strokes *strokes);

/**
 * Starts a job that computes the features. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the photo is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT
 * if sizes differ or a setting is out of range, LUXFER_DEGENERATE if the depth map is all holes.
 */
luxfer_status luxfer_features_start(luxfer_features *features,
                                    const luxfer_features_params *params,
                                    luxfer_job **job);

/**
 * Gets an image of the result; which is a LUXFER_FEATURES_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, and for LUXFER_FEATURES_NETWORK_DEPTH if the job has not run a network.
 */
luxfer_status luxfer_features_get_image(luxfer_features *features,
                                        luxfer_features_image which,
                                        luxfer_image **image);

/**
 * Gets the quality of the features. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_features_get_report(luxfer_features *features,
                                         luxfer_features_report *report,
                                         size_t size);

/* ====================================================================================================================
 * Segmentation
 *
 * Computes a mask, with a confidence for each pixel, from a few strokes on a photo. The lighting transfer needs two
 * masks: the plane that carries the lights, then the lights on it. You may add strokes after a result and start again.
 * ==================================================================================================================== */

/** A segmentation by strokes. See luxfer_segment_create. */
typedef struct luxfer_segment luxfer_segment;

/** The subject of a segmentation: a LUXFER_SUBJECT_ value. */
typedef int32_t luxfer_subject;

/** Settings of a segmentation. Fill them with luxfer_segment_params_init. */
typedef struct luxfer_segment_params {
    /** sizeof(luxfer_segment_params), set by luxfer_segment_params_init. */
    uint32_t struct_size;
    /** Samples drawn from the strokes of each class, in [1, 1000000]; default 1000. */
    uint32_t samples_per_class;
    /**
     * Channels of the features to use, bit i for channel i. 0, the default: for the ten channels of luxfer_features,
     * the best of colour, colour and position, colour and normal, or all, as measured on held-out strokes; for another
     * number of channels, all of them. For lights use 7, colour only, since lights and plane have one geometry.
     */
    uint32_t channels;
    /**
     * Half-width in pixels, in [0, 1024], of the windows of an edge-aware refinement, which makes the mask follow the
     * edges of the photo: a guided filter with the first three channels of the features as guide. 0, the default: no
     * refinement.
     */
    uint32_t refine_radius;
    /** Strength of the prior (ridge regression) that keeps weights small, in [1e-9, 1e3]; default 1e-3. */
    double ridge;
    /** Seed of the samples; default 1. */
    uint64_t seed;
    /**
     * Difference of the first three channels, in their units (CIELAB units for colour), below which the refinement
     * treats neighbours as one surface, in [1e-3, 1e6]; default 8.
     */
    double refine_tolerance;
    /**
     * The subject of the positive strokes: a LUXFER_SUBJECT_ value; default LUXFER_SUBJECT_AUTO. For lamps the
     * settings above have no effect.
     */
    luxfer_subject subject;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_segment_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_segment_params_init(luxfer_segment_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_SEGMENT_PARAMS, place, size);
}

/** An image of a segmentation: a LUXFER_SEGMENT_ value. */
typedef int32_t luxfer_segment_image;

/** Quality of a segmentation. */
typedef struct luxfer_segment_report {
    /** sizeof(luxfer_segment_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Channels of the features that were used, bit i for channel i. */
    uint32_t channels;
    /** Expected share of wrong pixels, in [0, 1], estimated on strokes held out of the training. */
    double error;
    /** Number of samples of the negative class. */
    uint64_t negative_samples;
    /** Number of samples of the positive class. */
    uint64_t positive_samples;
    /** Number of pixels that strokes of both classes cover; the later stroke counts. */
    uint64_t contradictory_pixels;
} luxfer_segment_report;

/** 1 where the confidence is above one half, else 0; 1 channel. */
#define LUXFER_SEGMENT_MASK 0

/** Probability that a pixel is of the positive class, in [0, 1]; 1 channel. */
#define LUXFER_SEGMENT_CONFIDENCE 1

/**
 * Difference of a pixel from all pixels under strokes, in [0, 1]: where it is high, another stroke helps; 1 channel.
 */
#define LUXFER_SEGMENT_UNSEEN 2

/**
 * Lamps if luxfer_segment_set_region gave a mask and the features have ten channels, as luxfer_features makes them;
 * else a surface.
 */
#define LUXFER_SUBJECT_AUTO 0

/** A surface, such as the plane that carries the lamps: each pixel is judged by its features. */
#define LUXFER_SUBJECT_SURFACE 1

/**
 * Lamps: compact regions with a sharp contour, brighter than their surroundings. Each positive stroke marks one or
 * more; regions without a stroke that look like them and lie in the mask of luxfer_segment_set_region are found as
 * well. Negative strokes are not needed. The first three channels of the features must be CIELAB.
 */
#define LUXFER_SUBJECT_LAMPS 2

/** Creates the stage. The caller releases *segment. Any thread. */
luxfer_status luxfer_segment_create(luxfer_context *context, luxfer_segment **segment);

/**
 * Sets the features of each pixel: LUXFER_FEATURES_CHANNELS, or any image of 1 to 16 channels. Strokes for another
 * size are removed. Any thread.
 */
luxfer_status luxfer_segment_set_features(luxfer_segment *segment,
                                          luxfer_image *features);

/**
 * Restricts the segmentation to the pixels where region is 1, such as the mask of the plane when you segment lights; 0
 * elsewhere; 1 channel, the size of the features. region may be NULL: no restriction. Any thread.
 */
luxfer_status luxfer_segment_set_region(luxfer_segment *segment,
                                        luxfer_image *region);

/**
 * Sets the strokes from which this mask is made. The stage copies those strokes that are for phase, a LUXFER_PHASE_
 * value; they replace all earlier strokes. strokes may be NULL: no strokes. Any thread.
 * LUXFER_INVALID_ARGUMENT if strokes is for images of another size than the features.
 */
luxfer_status luxfer_segment_set_strokes(luxfer_segment *segment,
                                         luxfer_strokes *strokes,
                                         luxfer_phase phase);

/**
 * Starts a job that segments. If strokes are missing and the features come from luxfer_features, the job proposes a
 * mask, with LUXFER_WARNING_PROPOSED. For a surface it proposes the face of the room under the positive strokes, or
 * else the ceiling; for lamps it proposes lamps among the brightest things of the region. params may be NULL for the
 * defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the features are missing or a job runs already. The job may end with LUXFER_DEGENERATE
 * if strokes are missing and there is nothing to propose, LUXFER_INVALID_ARGUMENT if sizes differ, a feature is not
 * finite or a setting is out of range.
 */
luxfer_status luxfer_segment_start(luxfer_segment *segment,
                                   const luxfer_segment_params *params,
                                   luxfer_job **job);

/**
 * Gets an image of the result; which is a LUXFER_SEGMENT_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_segment_get_image(luxfer_segment *segment,
                                       luxfer_segment_image which,
                                       luxfer_image **image);

/**
 * Gets the quality of the segmentation. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_segment_get_report(luxfer_segment *segment,
                                        luxfer_segment_report *report,
                                        size_t size);

/* ====================================================================================================================
 * Laws of an emission
 *
 * How an emissive texture continues the lights of its exemplar.
 * ==================================================================================================================== */

/** The law by which a texture continues the lights of its exemplar: a LUXFER_LAW_ value. */
typedef int32_t luxfer_emission_law;

/**
 * The law that predicts the lamps of the photo best: the law of LUXFER_LAW_CORRELATION, unless another law is clearly
 * better.
 */
#define LUXFER_LAW_BEST 0

/** The law that follows from the autocorrelation of the lights and from min_regularity. */
#define LUXFER_LAW_CORRELATION 1

/** The lamps form a lattice with two periods. */
#define LUXFER_LAW_LATTICE 2

/** The lamps form a row with one period; the extent of the exemplar serves as the other period. */
#define LUXFER_LAW_ROW 3

/** The exemplar repeats as a whole. */
#define LUXFER_LAW_WHOLE 4

/** The lights have no period: patches of the exemplar may lie anywhere. */
#define LUXFER_LAW_FREE 5

/** In results only: the texture is a part of the exemplar, or the caller gave it. */
#define LUXFER_LAW_COPY 6

/* ====================================================================================================================
 * Emission
 *
 * Synthesises an emissive texture of any size that continues the light pattern of an unwarped photo, and lists its
 * luminaires.
 * ==================================================================================================================== */

/** A synthesis of an emissive texture. See luxfer_emission_create. */
typedef struct luxfer_emission luxfer_emission;

/** Settings of the emission. Fill them with luxfer_emission_params_init. */
typedef struct luxfer_emission_params {
    /** sizeof(luxfer_emission_params), set by luxfer_emission_params_init. */
    uint32_t struct_size;
    /** Width of the texture in texels, in [1, 65536]; default 1024. */
    uint32_t width;
    /** Height of the texture in texels, in [1, 65536]; default 1024. */
    uint32_t height;
    /** Side of a patch in working pixels; 0, the default, chooses it from the spacing of the lights. */
    uint32_t block;
    /** Number of unwarped pixels per texel, in [1e-3, 1e3]; default 1. */
    double scale;
    /** Longest side of the exemplar during synthesis, in pixels, in [16, 2048]; default 256. */
    uint32_t working_side;
    /** Weight of the metadata channels relative to colour, in [0, 1e3]; default 1; 0 is plain image quilting. */
    float metadata_weight;
    /** Seed of the synthesis; default 1. */
    uint64_t seed;
    /**
     * Minimum autocorrelation at which the lights count as regular, in [0, 1]; default 0.6. At 0 any repetition is
     * continued exactly; at 1 no repetition is, and patches may lie anywhere.
     */
    float min_regularity;
    /** 1, the default: every lamp stays in one piece; 0: seams may cut lamps. */
    uint32_t whole_lamps;
    /**
     * Offset of the pattern from the texture's top-left corner, in texels to the right and down, each in [-1e6, 1e6];
     * default 0. Lights without a lattice have no origin: for them it must be 0 unless the texture is tileable, where
     * it shifts the lamps.
     */
    double offset[2];
    /**
     * Channel value from which on the photo counts as clipped, in [0, 1]; default 0.95. Clipped lamps get the colour
     * of their rims, as dark as the clipped channels allow. 0: no lamp counts as clipped.
     */
    float clip_level;
    /** 1: every lamp has its mean colour everywhere; 0, the default: as in the photo. */
    uint32_t even_lamps;
    /**
     * 1: the texture can be repeated without seams: lamps that leave it on one side continue on the opposite side, and
     * a lattice is stretched to fit, by less than half a period over the whole texture. Needs whole_lamps. Default 0.
     */
    uint32_t tileable;
    /**
     * 1: a lattice is centred on the texture and then shifted by offset: its middle is a lamp or the middle between
     * two lamps, so that the border cuts as few lamps as possible. Default 0.
     */
    uint32_t centred;
    /**
     * Maximum number of candidate patches that are compared for each block, without a lattice, in [1, 65536]; default
     * 192.
     */
    uint32_t candidates;
    /** Must be 0. */
    uint32_t reserved;
    /**
     * The law by which the texture continues the lights: a LUXFER_LAW_ value other than LUXFER_LAW_COPY; default
     * LUXFER_LAW_BEST.
     */
    luxfer_emission_law law;
    /**
     * 1, the default: all lamps of a kind get one size and an outline that is exact at any resolution, and lie exactly
     * at the sites of their lattice; this needs the photo and whole_lamps. 0: each lamp is shown with its outline in
     * the mask.
     */
    uint32_t clean_lamps;
    /**
     * Largest magnification at which parts of the exemplar are used, in [1, 1e6]: the factor in length by which the
     * photo is magnified at a pixel, relative to the pixel of the exemplar that is magnified least. Parts beyond it
     * count as not shown. Default 0: all parts are used.
     */
    double max_magnification;
} luxfer_emission_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_emission_params_init(luxfer_emission_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_EMISSION_PARAMS, place, size);
}

/** An image of the emission: a LUXFER_EMISSION_ value. */
typedef int32_t luxfer_emission_image;

/** Quality of the texture. */
typedef struct luxfer_emission_report {
    /** sizeof(luxfer_emission_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of luminaires; see luxfer_emission_get_luminaire. */
    uint32_t luminaires;
    /**
     * Largest relative difference between texture and exemplar in three statistics: the share of lit area, the area of
     * whole lamps, and the distance from a lamp to its nearest neighbour. It is only as reliable as exemplar_lamps
     * allows. NaN for a plan, which has no texture yet.
     */
    double error;
    /**
     * Regularity of the lights, in [0, 1]: their autocorrelation at the periods of the lattice; 0 without a lattice.
     */
    double regularity;
    /**
     * Number of whole lamps in the exemplars. Fewer than six describe a design poorly, because the border then cuts a
     * large part of the lamps. If there is no whole lamp, the texture shows the lamps that the border cuts.
     */
    uint32_t exemplar_lamps;
    /**
     * Estimated sampling error of the exemplar's statistics: the root mean square of the difference, as defined for
     * error, between the whole texture and parts of it that are as large as the exemplar. If error is at most twice
     * this value, it does not indicate a bad texture. 0 if the texture shows only a part of the exemplar, for blended
     * exemplars, and for a plan.
     */
    float sampling_error;
    /** The law by which the texture continues the lights: a LUXFER_LAW_ value. */
    luxfer_emission_law law;
    /** The best of the other laws: a LUXFER_LAW_ value. */
    luxfer_emission_law runner_up;
    /**
     * How well the law predicts each lamp of the photo from the other lamps, in [0, 1]; lamps weigh in proportion to
     * their pixels in the photo. NaN if laws were not compared, for example because too few of the lights are whole
     * lamps.
     */
    double law_score;
    /**
     * law_score minus the score of runner_up. Negative if the law was kept although another law scores slightly
     * better.
     */
    double margin;
} luxfer_emission_report;

/** A lamp of the texture. */
typedef struct luxfer_luminaire {
    /** sizeof(luxfer_luminaire), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of corners of the outline. */
    uint32_t corners;
    /** Centre in texels, x and y. */
    double centre[2];
    /** Lengths of the principal axes in texels, the longer first. */
    double size[2];
    /** Angle of the long axis from x towards y, in radians, in (-pi/2, pi/2]. */
    double orientation;
    /** Area in texels; texels at the edge count with the share that the lamp covers. */
    double area;
    /** Share of the luminous flux of all lamps of the texture, in [0, 1]. */
    double flux_share;
    /** Mean linear colour, relative to the photo's white. */
    float colour[3];
    /**
     * Number of the lamp's kind, from 1: lamps of about equal size and shape are of one kind, and kinds are sorted by
     * the number of their lamps, the largest first. 0 if the border cuts the lamp.
     */
    uint32_t kind;
} luxfer_luminaire;

/** The texture: linear RGB relative to the photo's white; 0 outside lamps. */
#define LUXFER_EMISSION_TEXTURE 0

/** 1 on lamps, else 0; 1 channel. */
#define LUXFER_EMISSION_MASK 1

/**
 * Metadata of the exemplar at working size: confidence, and signed x and y distance to the nearest light; 3 channels.
 */
#define LUXFER_EMISSION_EXEMPLAR_METADATA 2

/** Metadata of the result, with the channels of LUXFER_EMISSION_EXEMPLAR_METADATA. */
#define LUXFER_EMISSION_METADATA 3

/** Creates the stage. The caller releases *emission. Any thread. */
luxfer_status luxfer_emission_create(luxfer_context *context, luxfer_emission **emission);

/**
 * Sets the exemplar, three images of one size: the unwarped photo (linear RGB), the unwarped confidence of the lights
 * (1 channel, in [0, 1]) and the mask of the pixels where both images are valid (1 channel, 1 or 0).
 * luxfer_emission_add_style adds more exemplars. Any thread.
 */
luxfer_status luxfer_emission_set_exemplar(luxfer_emission *emission,
                                           luxfer_image *unwarped,
                                           luxfer_image *light,
                                           luxfer_image *valid);

/**
 * Sets the photo from which full detail is recovered, and the homography from unwarped to photo pixels, 9 doubles row
 * by row (luxfer_rectify_report.to_photo). photo may be NULL: the detail then comes from the unwarped image only. Any
 * thread.
 */
luxfer_status luxfer_emission_set_photo(luxfer_emission *emission,
                                        luxfer_image *photo,
                                        const double *to_photo);

/**
 * Starts a job that makes the whole texture in memory; for very large textures use luxfer_emission_start_plan. params
 * may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the exemplar is missing or a job runs already. The job may end with LUXFER_DEGENERATE if
 * the exemplar has no lights, LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of range.
 */
luxfer_status luxfer_emission_start(luxfer_emission *emission,
                                    const luxfer_emission_params *params,
                                    luxfer_job **job);

/**
 * Gets an image of the result; which is a LUXFER_EMISSION_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_emission_get_image(luxfer_emission *emission,
                                        luxfer_emission_image which,
                                        luxfer_image **image);

/**
 * Gets the quality of the texture, or the contents of a plan. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_emission_get_report(luxfer_emission *emission,
                                         luxfer_emission_report *report,
                                         size_t size);

/**
 * Describes a luminaire of the texture. A plan has no texels yet, so it describes each luminaire as the exemplar shows
 * it, cut at the edges of the texture; only lights that cross their whole exemplar are described as they are in the
 * texture. size is sizeof *luminaire. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such luminaire.
 */
luxfer_status luxfer_emission_get_luminaire(luxfer_emission *emission,
                                            uint32_t index,
                                            luxfer_luminaire *luminaire,
                                            size_t size);

/**
 * Gets a corner of a luminaire's outline, in texels. Any thread.
 *
 * The outline runs where the lamp would cover half of a texel. If the confidence of the lights has values between 0
 * and 1, the outline is accurate to a quarter of a texel, or to 0.71 texels at corners of the lamp; if unwarped pixels
 * are larger than texels, these figures are in unwarped pixels. The outline follows the sides of texels instead for
 * lamps up to two texels wide, for masks of only 0 and 1, and for lights of a plan that follow its patches.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such luminaire or corner.
 */
luxfer_status luxfer_emission_get_corner(luxfer_emission *emission,
                                         uint32_t index,
                                         uint32_t corner,
                                         double *x,
                                         double *y);

/* ====================================================================================================================
 * Styles and tiles
 *
 * Textures from several exemplars, and textures that are too large to make as a whole: luxfer_emission_start_plan
 * decides where every lamp lies, and luxfer_emission_render_tile renders any rectangle of the texture. A plan holds
 * the exemplars, the place of each lamp and the outlines of the patches, but no texels.
 * ==================================================================================================================== */

/**
 * Adds an exemplar whose lights replace lights of the first exemplar according to weights. unwarped, light and valid
 * are as for luxfer_emission_set_exemplar; photo, which may be NULL, and to_photo are as for
 * luxfer_emission_set_photo. scale is the number of its unwarped pixels per texel, in [1e-3, 1e3]. weights has 1
 * channel with values in [0, 1] and is stretched over the texture. The weights of several added exemplars are images
 * of one size whose sum is at most 1; the first exemplar has the rest of the weight.
 *
 * Each lamp comes from one exemplar, chosen with the probability of its weight there, so that the light per area
 * blends linearly. Each lattice keeps its own period and phase. Any thread.
 */
luxfer_status luxfer_emission_add_style(luxfer_emission *emission,
                                        luxfer_image *unwarped,
                                        luxfer_image *light,
                                        luxfer_image *valid,
                                        luxfer_image *photo,
                                        const double *to_photo,
                                        double scale,
                                        luxfer_image *weights);

/** Removes all exemplars added by luxfer_emission_add_style; the first exemplar stays. Any thread. */
luxfer_status luxfer_emission_clear_styles(luxfer_emission *emission);

/**
 * Starts a job that plans the texture instead of making it as luxfer_emission_start does, and removes the results of
 * that function. params, and the statuses of the call and the job, are as for luxfer_emission_start.
 * luxfer_emission_get_report and luxfer_emission_get_luminaire describe the lamps of the plan. The caller releases
 * *job. Any thread.
 */
luxfer_status luxfer_emission_start_plan(luxfer_emission *emission,
                                         const luxfer_emission_params *params,
                                         luxfer_job **job);

/**
 * Renders the rectangle of width x height texels of a planned texture whose top-left texel is (x, y): 4 channels,
 * linear RGB, and a mask that is 1 on lamps, else 0. The values are equal to the bit to the texture and mask of
 * luxfer_emission_start, for any size and order of the tiles. Takes up to a second per megapixel. The caller releases
 * *tile. Any thread; several threads may render tiles at the same time.
 * LUXFER_NOT_READY before a job of luxfer_emission_start_plan has succeeded; LUXFER_INVALID_ARGUMENT if the rectangle
 * is empty or exceeds the texture; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_emission_render_tile(luxfer_emission *emission,
                                          uint32_t x,
                                          uint32_t y,
                                          uint32_t width,
                                          uint32_t height,
                                          luxfer_image **tile);

/* ====================================================================================================================
 * Relighting
 *
 * Solves for the colour and intensity of an emission so that a surface of the scene has the same colour as in the
 * photo. The solution is a factor for the emission, per channel, with a confidence interval.
 * ==================================================================================================================== */

/** A relighting of a scene. See luxfer_relight_create. */
typedef struct luxfer_relight luxfer_relight;

/** Whether light should equal its target value, or stay above or below it: a LUXFER_CONSTRAINT_ value. */
typedef int32_t luxfer_constraint;

/** Quantity that should match the photo: a LUXFER_QUANTITY_ value. */
typedef int32_t luxfer_quantity;

/** How the target surface is compared: a LUXFER_FIT_ value. */
typedef int32_t luxfer_fit;

/** Settings of a relighting. Fill them with luxfer_relight_params_init. */
typedef struct luxfer_relight_params {
    /** sizeof(luxfer_relight_params), set by luxfer_relight_params_init. */
    uint32_t struct_size;
    /** LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING. */
    luxfer_quantity quantity;
    /** Maximum number of paths, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /**
     * Stop when the half-width of each channel's 95 % confidence interval is below this share of its scale, in [0, 1];
     * default 0.01; 0: no target.
     */
    float target_error;
    /** Stop after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** LUXFER_FIT_ value; default LUXFER_FIT_MEAN. */
    luxfer_fit fit;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_relight_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_relight_params_init(luxfer_relight_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_RELIGHT_PARAMS, place, size);
}

/** Whether the target is met in a colour channel, and if not, the reason: a LUXFER_OUTCOME_ value. */
typedef int32_t luxfer_outcome;

/** The solution and its confidence. */
typedef struct luxfer_relight_report {
    /** sizeof(luxfer_relight_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of traced paths. */
    uint32_t paths;
    /** Factor for the emission, per channel, >= 0. */
    double scale[3];
    /** Half-widths of the 95 % confidence intervals of scale. */
    double half_width[3];
    /** Mean radiance of the target from the emission at scale 1, in cd/m². */
    double response[3];
    /** Mean radiance of the target from all other light, in cd/m². */
    double background[3];
    /** LUXFER_OUTCOME_ value of each channel. */
    luxfer_outcome outcome[3];
    /** 0. */
    uint32_t reserved;
    /** The largest relative half-width among the channels that meet their target. */
    double error;
    /**
     * Uncertainty of the target's colour: with a probability of 95 % the CIEDE2000 difference is below this value, at
     * the exposure that shows the target as middle grey.
     */
    double delta_e;
} luxfer_relight_report;

/** Light that the target surface reflects, its albedo included: the radiance that a photo shows. */
#define LUXFER_QUANTITY_OUTGOING 0

/** Light that arrives at the target surface, as if the surface were white. */
#define LUXFER_QUANTITY_INCIDENT 1

/** The mean over the target surface. */
#define LUXFER_FIT_MEAN 0

/**
 * Every point of the target surface, by least squares, as gradient descent on texels does. Bright points count more,
 * so the emission is dimmer than with LUXFER_FIT_MEAN: by the factor 1 / (1 + CV²) without other light, where CV is
 * the coefficient of variation of the response over the target.
 */
#define LUXFER_FIT_LEAST_SQUARES 1

/** The light should equal the value. */
#define LUXFER_CONSTRAINT_EQUAL 0

/**
 * The light should be at least the value, as a standard requires on a desk, or as a clipped channel of a photo shows.
 */
#define LUXFER_CONSTRAINT_AT_LEAST 1

/** The light should be at most the value, as a limit against glare. */
#define LUXFER_CONSTRAINT_AT_MOST 2

/** The target is met. */
#define LUXFER_OUTCOME_MET 0

/** The other lights alone exceed the target: the emission is 0 in this channel. */
#define LUXFER_OUTCOME_TOO_BRIGHT 1

/** No light of this channel reaches the target: the emission uses the mean scale of the other channels. */
#define LUXFER_OUTCOME_DARK 2

/** All lamps at their largest power are too weak, or two goals contradict each other. */
#define LUXFER_OUTCOME_TOO_DIM 3

/** Creates the stage. The caller releases *relight. Any thread. */
luxfer_status luxfer_relight_create(luxfer_context *context, luxfer_relight **relight);

/**
 * Sets the scene, the emitting material to solve for, and the mesh whose mean colour should match;
 * luxfer_scene_place_emission returns both indices. The solution is a factor for the emission that the material has in
 * the scene. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material or mesh.
 */
luxfer_status luxfer_relight_set_scene(luxfer_relight *relight,
                                       luxfer_scene *scene,
                                       uint32_t material,
                                       uint32_t mesh);

/**
 * Sets the mean radiance that the mesh should have, in cd/m² per channel, each finite and >= 0; for
 * LUXFER_QUANTITY_INCIDENT the radiance of a white surface in the same light, illuminance / pi. Any thread.
 */
luxfer_status luxfer_relight_set_target(luxfer_relight *relight, float red, float green, float blue);

/**
 * Makes the target a lower or upper limit; red, green and blue are the LUXFER_CONSTRAINT_ values of the three
 * channels. A channel that the photo clips should be LUXFER_CONSTRAINT_AT_LEAST. A limited channel uses the mean scale
 * of the channels that should equal their target if this scale respects the limit, else the scale that just reaches
 * the limit. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is not a LUXFER_CONSTRAINT_ value.
 */
luxfer_status luxfer_relight_set_constraint(luxfer_relight *relight,
                                            luxfer_constraint red,
                                            luxfer_constraint green,
                                            luxfer_constraint blue);

/**
 * Starts a job that solves. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene or the target is missing or a job runs already. The job may end with
 * LUXFER_UNREACHABLE if no light of the emission can reach the target, LUXFER_INVALID_ARGUMENT if the scene is not
 * valid or a setting is out of range.
 */
luxfer_status luxfer_relight_start(luxfer_relight *relight,
                                   const luxfer_relight_params *params,
                                   luxfer_job **job);

/**
 * Gets the solution and its confidence. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_relight_get_report(luxfer_relight *relight,
                                        luxfer_relight_report *report,
                                        size_t size);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_STAGES_H */
