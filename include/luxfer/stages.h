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

/* ==================================================================================================================
 * Plane geometry
 *
 * Homographies map points between two views of a plane. They are 3 x 3 matrices of homogeneous coordinates, stored
 * row by row. Points are in pixels, x to the right, y down; the centre of the top-left pixel is (0.5, 0.5). These
 * calls are synchronous: they do their work before they return.
 * ================================================================================================================== */

/**
 * Computes the homography that maps four points to four other points. The array from holds x and y of the four points,
 * 8 doubles; the array to holds x and y of the points to which they are mapped, in the same order. homography receives
 * the nine entries of the matrix, row by row, scaled to unit Frobenius norm. Any thread.
 * LUXFER_DEGENERATE if three points of one array lie on one line or two coincide, or if a coordinate is not finite.
 */
luxfer_status luxfer_homography_from_corners(luxfer_context *context,
                                             const double *from,
                                             const double *to,
                                             double *homography);

/**
 * Warps an image by a homography into a new image of width x height pixels, each in [1, 65536]. to_source is the
 * homography from points of the new image to points of the source: nine matrix entries, row by row. Each pixel of the
 * new image takes the value of the source at the point to which its centre is mapped, or 0 if that point lies outside
 * the source. The source is interpolated where it is magnified, and averaged over the pixel's footprint where it is
 * minified. The call takes a few milliseconds per megapixel. The caller releases *warped. Any thread.
 * LUXFER_INVALID_ARGUMENT if an entry is not finite or a size is out of range; LUXFER_OUT_OF_MEMORY beyond the memory
 * budget.
 */
luxfer_status luxfer_image_warp(luxfer_image *source,
                                const double *to_source,
                                uint32_t width,
                                uint32_t height,
                                luxfer_image **warped);

/* ==================================================================================================================
 * Rectification
 *
 * Finds vanishing points and the camera from the straight lines of a photo. If a mask marks a plane, it also unwarps
 * that plane to a frontal view. Image points are in pixels, x to the right, y down; the centre of the top-left pixel
 * is (0.5, 0.5). The room axes are the three orthogonal directions of the room: axes 0 and 2 are horizontal, axis 1 is
 * vertical. Camera space is x to the right, y down, z forward. Some values name the paper "Lighting Style Transfer":
 * this is "Single-Exemplar Lighting Style Transfer via Emissive Texture Synthesis and Optimization".
 * ================================================================================================================== */

/** Lines, vanishing points and the unwarped plane of a photo. See luxfer_rectify_create. */
typedef struct luxfer_rectify luxfer_rectify;

/** The detector of lines: a LUXFER_LINES_ value. */
typedef int32_t luxfer_lines;

/** The search for vanishing points: a LUXFER_SEARCH_ value. */
typedef int32_t luxfer_search;

/** The distance of a vanishing point from a line, for LUXFER_SEARCH_SUCCESSIVE: a LUXFER_METRIC_ value. */
typedef int32_t luxfer_metric;

/** Settings of a rectification. Fill them with luxfer_rectify_params_init. */
typedef struct luxfer_rectify_params {
    /** sizeof(luxfer_rectify_params), set by luxfer_rectify_params_init. */
    uint32_t struct_size;
    /** Detector of lines: a LUXFER_LINES_ value; default LUXFER_LINES_REGIONS. */
    luxfer_lines detector;
    /** Search for vanishing points: a LUXFER_SEARCH_ value; default LUXFER_SEARCH_MANHATTAN. */
    luxfer_search search;
    /** Distance of a vanishing point from a line: a LUXFER_METRIC_ value; default LUXFER_METRIC_SEGMENT. */
    luxfer_metric metric;
    /**
     * For LUXFER_LINES_HOUGH: largest angle in radians between a pixel's gradient and the normal of a line for which
     * the pixel votes, in [1e-4, pi/2]; default 0.0436, which is 2.5 degrees.
     */
    double hough_band;
    /**
     * Focal length in pixels, in [1e-3, 1e9]; 0, the default: estimated from the lines, and from the photo's metadata
     * if it has any.
     */
    double focal;
    /** Principal point in pixels, x and y in [-1e9, 1e9]; NaN, the default: the image's centre. */
    double principal[2];
    /**
     * The two room axes that the plane spans, each 0, 1 or 2; -1, the default: estimated from the lines on the plane.
     */
    int32_t plane_axes[2];
    /**
     * Maximum length of the longer side of the unwarped image in pixels, in [16, 16384]; default 2048. The image is
     * smaller if the resolution of the photo does not support this size.
     */
    uint32_t max_side;
    /** Must be 0. */
    uint32_t reserved;
    /**
     * Limit of the magnification by unwarping, a ratio of lengths in (0, 1e6]; default 16. The farther a part of the
     * plane is from the camera, the more its photo pixels are magnified. Parts that are magnified more than this
     * factor times as much as the nearest part are cut off.
     */
    double max_magnification;
    /** Seed of the search; default 1. */
    uint64_t seed;
    /**
     * Radial distortion of the lens to undo: the outward shift of the corners of the photo, as a share of their
     * distance from its centre, in [-1, 0.2]; below 0 for barrel distortion, which wide-angle lenses have. NaN, the
     * default: the distortion is measured. It is undone if it lies between -0.1 and -0.02, if its absolute value is at
     * least two standard deviations, and if the lines meet better in vanishing points without it. 0: no distortion is
     * undone.
     */
    double distortion;
} luxfer_rectify_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_rectify_params_init(luxfer_rectify_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_RECTIFY_PARAMS, place, size);
}

/** An image of a rectification: a LUXFER_RECTIFY_ value. */
typedef int32_t luxfer_rectify_image;

/** The source of a focal length: a LUXFER_FOCAL_ value. */
typedef int32_t luxfer_focal_source;

/** The camera found from the lines of a photo, and the unwarping of the plane. */
typedef struct luxfer_rectify_report {
    /** sizeof(luxfer_rectify_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of line segments found. */
    uint32_t segments;
    /**
     * Vanishing points of the room axes, in homogeneous pixel coordinates of unit length; the third coordinate is 0
     * at infinity. If a distortion was undone, they lie in the photo that luxfer_rectify_undistort makes.
     */
    double vanishing_points[3][3];
    /** Standard deviation of the direction to each vanishing point in camera space, in radians. */
    double vanishing_errors[3];
    /**
     * Number of segments that run to each vanishing point; 0: no segment runs to the point, which is then derived from
     * the other vanishing points, or from the assumption that the camera is upright.
     */
    uint32_t vanishing_support[3];
    /** Source of the focal length: a LUXFER_FOCAL_ value. */
    luxfer_focal_source focal_source;
    /** Focal length in pixels. */
    double focal;
    /** Principal point in pixels. */
    double principal[2];
    /** Room axes as unit vectors in camera space: axis 0 points right, axis 1 down, axis 2 forward. */
    double axes[3][3];
    /** 1 if the plane has been unwarped; 0 if not: the fields from to_photo to aspect_confidence are then 0. */
    uint32_t is_unwarped;
    /** Reserved; always 0. */
    uint32_t reserved;
    /**
     * Homography from unwarped pixels to photo pixels: a 3 x 3 matrix, row by row. With it, luxfer_image_warp unwarps
     * other images of the photo's size, such as the confidence of the lights. If a distortion was undone, it leads to
     * the pixels of the photo that luxfer_rectify_undistort makes; undistort the other images first.
     */
    double to_photo[9];
    /** Corners of the unwarped rectangle in the photo, x and y in pixels: top left, then clockwise. */
    double corners[4][2];
    /** Expected error of each corner, in unwarped pixels. */
    double corner_errors[4];
    /** Length of an unwarped pixel's side on the plane, divided by the camera's distance from the plane. */
    double pixel_size;
    /**
     * Confidence of the aspect ratio, 1 / (1 + (s / 0.1)²), where s is its relative standard deviation; in [0, 1]. It
     * is low if the focal length was assumed.
     */
    double aspect_confidence;
    /**
     * Lens distortion: the outward shift of the corners of the photo, as a share of their distance from its centre;
     * below 0 for barrel distortion, which wide-angle lenses have. It is estimated from the curvature of straight
     * edges. NaN if the photo has too few lines.
     */
    double distortion;
    /** Standard deviation of the field distortion; NaN if distortion is NaN. */
    double distortion_error;
    /**
     * For each axis, the angle between the two other axes minus 90 degrees, in radians. For this angle, each of the
     * two axes is estimated only from the lines that run along that axis; the vectors of the field axes, in contrast,
     * are always orthogonal. The value differs from 0 if walls are oblique, pixels are not square or the principal
     * point is wrong. NaN if one of the two axes has no lines.
     */
    double squareness[3];
    /** Standard deviations of the field squareness; NaN where squareness is NaN. */
    double squareness_errors[3];
    /**
     * The distortion that was undone, in the unit of the field distortion; 0 if no distortion was undone. It equals
     * luxfer_rectify_params.distortion or, if that is NaN, the measured distortion.
     */
    double undone;
} luxfer_rectify_report;

/**
 * Fits segments with sub-pixel end points to regions of similar gradient direction (LSD, Grompone von Gioi et al.
 * 2010).
 */
#define LUXFER_LINES_REGIONS 0

/**
 * The method of Lighting Style Transfer (section 5.1): a Hough transform of Canny edges, in which an edge pixel votes
 * only for lines nearly perpendicular to its gradient.
 */
#define LUXFER_LINES_HOUGH 1

/**
 * Finds three orthogonal directions and the focal length together, then refines each direction with the lines that run
 * along it.
 */
#define LUXFER_SEARCH_MANHATTAN 0

/**
 * The method of Lighting Style Transfer, RANSAC: finds one vanishing point after the other, each from the lines that
 * do not run to an earlier vanishing point.
 */
#define LUXFER_SEARCH_SUCCESSIVE 1

/**
 * The distance of the detected segment's end points from the line through its midpoint and the vanishing point;
 * finite for vanishing points at infinity.
 */
#define LUXFER_METRIC_SEGMENT 0

/**
 * The distance by Eq. 2 of Lighting Style Transfer, which may be infinite: the smaller of d and d x / y. Here d is the
 * distance of the vanishing point from the line, x is half the length of the part of the line that the photo shows,
 * and y is the distance along the line from the middle of this part to the point nearest to the vanishing point.
 */
#define LUXFER_METRIC_VISIBLE_LINE 1

/** The caller has set the focal length. */
#define LUXFER_FOCAL_GIVEN 0

/** Estimated, mainly from the vanishing points of orthogonal directions. */
#define LUXFER_FOCAL_FROM_VANISHING_POINTS 1

/**
 * Mainly assumed: a usual value, 0.85 times the width of the photo, has a greater weight than the estimate from
 * vanishing points.
 */
#define LUXFER_FOCAL_ASSUMED 2

/** Mainly from the metadata of the photo's file; see luxfer_image_get_metadata. */
#define LUXFER_FOCAL_FROM_METADATA 3

/**
 * Estimated so that the lamps have equal sizes and shapes, or lie on a lattice, in the frontal view of their plane
 * (lighting transfer only).
 */
#define LUXFER_FOCAL_FROM_LAMPS 4

/** The plane in frontal view, linear RGB. */
#define LUXFER_RECTIFY_UNWARPED 0

/**
 * The mask of the plane in frontal view: 1 where the mask is set and the photo's values are finite, else 0; 1 channel.
 */
#define LUXFER_RECTIFY_VALID 1

/** Creates a rectification. It has no inputs yet. The caller releases *rectify. Any thread. */
luxfer_status luxfer_rectify_create(luxfer_context *context, luxfer_rectify **rectify);

/** Sets the photo: linear RGB. Any thread. */
luxfer_status luxfer_rectify_set_photo(luxfer_rectify *rectify, luxfer_image *photo);

/**
 * Sets the mask of the plane to unwarp: 1 on the plane, 0 elsewhere; 1 channel, the photo's size. mask may be NULL:
 * the job then finds only lines, vanishing points and the camera. Any thread.
 */
luxfer_status luxfer_rectify_set_mask(luxfer_rectify *rectify,
                                      luxfer_image *mask);

/**
 * Starts a job that finds lines, vanishing points and the camera, and unwarps the plane if its mask is set. If an
 * earlier job with equal settings has found the camera of this photo, the job uses that camera. params may be NULL
 * for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the photo is missing or a job is already running. The job may end with LUXFER_DEGENERATE
 * if there are no lines, the mask is empty or the plane is seen edge-on, LUXFER_INVALID_ARGUMENT if sizes differ or a
 * setting is out of range.
 */
luxfer_status luxfer_rectify_start(luxfer_rectify *rectify,
                                   const luxfer_rectify_params *params,
                                   luxfer_job **job);

/**
 * Gets the image that kind, a LUXFER_RECTIFY_ value, selects: the unwarped plane or its mask. The caller releases
 * *image. Any thread.
 * LUXFER_NOT_READY before a job with a mask has succeeded.
 */
luxfer_status luxfer_rectify_get_image(luxfer_rectify *rectify,
                                       luxfer_rectify_image kind,
                                       luxfer_image **image);

/**
 * Undoes the distortion of the lens in an image of the photo's size, such as the photo or a mask: makes the image that
 * an ideal lens would have taken, with the same size and principal point. Pixels beyond the image are 0. If no
 * distortion was undone, the new image equals the given image. The caller releases *undistorted. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_INVALID_ARGUMENT if the image has not the photo's size.
 */
luxfer_status luxfer_rectify_undistort(luxfer_rectify *rectify,
                                       luxfer_image *image,
                                       luxfer_image **undistorted);

/**
 * Gets the camera and the unwarping, with their errors. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_rectify_get_report(luxfer_rectify *rectify,
                                        luxfer_rectify_report *report,
                                        size_t size);

/* ==================================================================================================================
 * Features
 *
 * Computes ten values for each pixel of a photo, its features, by which segmentation compares pixels: colour, depth,
 * position and normal. The depth comes from the first source that is available: (1) a depth map of the caller; (2) a
 * network in an ONNX file; (3) a box-shaped room, which is fitted to the lines that a luxfer_rectify has found and to
 * strokes on one plane of the room; (4) a fixed default that does not depend on the photo.
 * ================================================================================================================== */

/** The features of a photo. See luxfer_features_create. */
typedef struct luxfer_features luxfer_features;

/**
 * Normalisation of the colours that a network expects as its input: a LUXFER_NORMALISATION_ value. The library first
 * clamps the linear photo to [0, 1] and encodes it as sRGB. An ONNX file does not state the normalisation, so the
 * caller must.
 */
typedef int32_t luxfer_normalisation;

/** Settings of the features. Fill them with luxfer_features_params_init. */
typedef struct luxfer_features_params {
    /** sizeof(luxfer_features_params), set by luxfer_features_params_init. */
    uint32_t struct_size;
    /**
     * Distance of the near plane, where the depth channel is 0, in [1e-3, 1e3]; default 1. All depths are multiplied
     * by one factor, so that the nearest part of the photo (the 2 % quantile of its depths) lies on this plane. The
     * unit of length is therefore arbitrary.
     */
    float near_plane;
    /**
     * Distance of the far plane, where the depth channel is 1, in the unit of near_plane and in [1.001, 1e6] times
     * near_plane; default 10.
     */
    float far_plane;
    /**
     * Half the width, in pixels, of the square window around a pixel in which a plane is fitted to find the normal of
     * the pixel; in [0, 64]. 0, the default: 1 % of the photo's width, but at least 2 and at most 64.
     */
    uint32_t normal_radius;
} luxfer_features_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_features_params_init(luxfer_features_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_FEATURES_PARAMS, place, size);
}

/** An image of the features: a LUXFER_FEATURES_ value. */
typedef int32_t luxfer_features_image;

/** The source of the depth: a LUXFER_DEPTH_FROM_ value. */
typedef int32_t luxfer_depth_source;

/** Quality of the features. */
typedef struct luxfer_features_report {
    /** sizeof(luxfer_features_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Source of the depth: a LUXFER_DEPTH_FROM_ value. */
    luxfer_depth_source depth_source;
    /** Mean confidence of the depth, in [0, 1]. */
    double depth_confidence;
    /**
     * Number of pixels of the photo that were NaN, infinite or negative and were replaced by values of their
     * neighbours.
     */
    uint64_t replaced_pixels;
} luxfer_features_report;

/**
 * The ten features, one channel each: L*, a*, b* (CIELAB, D65); depth; position x, y, z; unit normal x, y, z, towards
 * the camera. The depth is (1/near - 1/z) / (1/near - 1/far), where z is the distance along the viewing axis, near is
 * near_plane and far is far_plane. Positions are relative to the camera, in the unit of near_plane. The axes are x
 * right, y down, z forward: the axes of the camera or, after luxfer_features_set_view, of the room. luxfer_image_read
 * reads up to four channels at a time.
 */
#define LUXFER_FEATURES_CHANNELS 0

/** Confidence of the depth of each pixel, in [0, 1]; 1 channel. */
#define LUXFER_FEATURES_DEPTH_CONFIDENCE 1

/**
 * The distance along the viewing axis that a network has estimated, in [near_plane, far_plane]; 1 channel. Set it as
 * the depth map of later jobs, or of a luxfer_transfer, to avoid running the network again.
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

/** No source: a fixed depth that does not depend on the photo. */
#define LUXFER_DEPTH_FROM_NOTHING 2

/** The caller's network. */
#define LUXFER_DEPTH_FROM_NETWORK 3

/** Creates an object that computes features. It has no inputs yet. The caller releases *features. Any thread. */
luxfer_status luxfer_features_create(luxfer_context *context, luxfer_features **features);

/** Sets the photo: linear RGB, 1 = display white. Strokes for a photo of another size are removed. Any thread. */
luxfer_status luxfer_features_set_photo(luxfer_features *features, luxfer_image *photo);

/** Sets a depth map of the photo; kind is a LUXFER_DEPTH_ value. depth may be NULL: no depth map. Any thread. */
luxfer_status luxfer_features_set_depth(luxfer_features *features,
                                        luxfer_image *depth,
                                        luxfer_depth_kind kind);

/**
 * Sets a network in an ONNX file, which estimates the depth if there is no depth map; path is UTF-8. The network has
 * one input: the photo as a float tensor [1, 3, rows, columns], with up to 4096 rows and columns. Its first output is
 * a map of relative inverse depth, as MiDaS and DPT compute it. The library converts the map to depths in
 * [near_plane, far_plane]: the nearest pixel gets near_plane, the farthest far_plane (LUXFER_FEATURES_NETWORK_DEPTH).
 * These depths then serve as a depth map, which the setting near_plane scales once more. normalisation is a
 * LUXFER_NORMALISATION_ value. path may be NULL: no network. The call reads the file, which is not needed afterwards.
 * Any thread.
 * LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is damaged; LUXFER_UNSUPPORTED if it needs an operator
 * that the library does not support, or if the library was built without the Cargo feature onnx.
 */
luxfer_status luxfer_features_set_network(luxfer_features *features,
                                          const char *path,
                                          luxfer_normalisation normalisation);

/**
 * Sets the lines and the camera that a luxfer_rectify has found in this photo; the call copies its latest result.
 * rectify may be NULL: no lines. Any thread.
 * LUXFER_NOT_READY if rectify has no result yet.
 */
luxfer_status luxfer_features_set_view(luxfer_features *features,
                                       luxfer_rectify *rectify);

/**
 * Sets strokes that guide the fit of a box-shaped room to the lines that luxfer_features_set_view has set. The fit
 * prefers rooms in which one surface, such as the ceiling, contains all positive strokes (of both phases,
 * LUXFER_PHASE_PLANE and LUXFER_PHASE_LIGHTS) and no negative stroke of LUXFER_PHASE_PLANE. The strokes have no effect
 * if the depth comes from another source. The call copies the strokes, which replace earlier strokes; NULL removes
 * them. Any thread.
 * LUXFER_INVALID_ARGUMENT if the strokes are for images of another size than the photo.
 */
luxfer_status luxfer_features_set_strokes(luxfer_features *features,
                                          luxfer_strokes *strokes);

/**
 * Starts a job that computes the features. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the photo is missing or a job is already running. The job may end with
 * LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of range, LUXFER_DEGENERATE if the depth map is all
 * holes.
 */
luxfer_status luxfer_features_start(luxfer_features *features,
                                    const luxfer_features_params *params,
                                    luxfer_job **job);

/**
 * Gets the image of the result that a LUXFER_FEATURES_ value selects. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, and for LUXFER_FEATURES_NETWORK_DEPTH if the job has not run a
 * network.
 */
luxfer_status luxfer_features_get_image(luxfer_features *features,
                                        luxfer_features_image kind,
                                        luxfer_image **image);

/**
 * Gets the quality of the features. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_features_get_report(luxfer_features *features,
                                         luxfer_features_report *report,
                                         size_t size);

/* ==================================================================================================================
 * Segmentation
 *
 * Computes a mask, with a confidence for each pixel, from a few strokes on a photo. A lighting transfer needs two
 * masks: the plane that carries the lights, then the lights on it. You may add strokes after a result and start
 * again.
 * ================================================================================================================== */

/** A segmentation by strokes. See luxfer_segment_create. */
typedef struct luxfer_segment luxfer_segment;

/** The subject of a segmentation: a LUXFER_SUBJECT_ value. */
typedef int32_t luxfer_subject;

/** Settings of a segmentation. Fill them with luxfer_segment_params_init. */
typedef struct luxfer_segment_params {
    /** sizeof(luxfer_segment_params), set by luxfer_segment_params_init. */
    uint32_t struct_size;
    /**
     * Maximum number of pixels that are drawn as samples from the strokes of each class, in [1, 1000000]; default
     * 1000.
     */
    uint32_t samples_per_class;
    /**
     * Channels of the features to use, bit i for channel i; default 0. With the ten channels of luxfer_features, 0
     * tries four sets (colour; colour and position; colour and normal; all channels) and uses the set with the
     * smallest error on held-out strokes. Sets with position are left out if the mask will be restricted to a wall,
     * floor or ceiling of a room that was fitted as a box. With another number of channels, 0 uses all channels. If
     * you segment lights as LUXFER_SUBJECT_SURFACE, use 7 (colour only), since lights and their plane have the same
     * geometry.
     */
    uint32_t channels;
    /**
     * Half-width in pixels of the windows of an edge-aware refinement, in [0, 1024]; 0, the default: no refinement.
     * The refinement makes the mask follow the edges of the photo: it is a guided filter with the first three
     * channels of the features as guide.
     */
    uint32_t refine_radius;
    /**
     * Strength of the prior that keeps the weights of the classifier small (ridge regression), in [1e-9, 1e3];
     * default 1e-3.
     */
    double ridge;
    /** Seed of the samples that are drawn; default 1. */
    uint64_t seed;
    /**
     * Smallest contrast that the refinement by refine_radius follows. In windows in which the standard deviation of
     * the first three channels is below this value, the refinement smooths the mask; in other windows, the mask
     * follows the edges. In the unit of these channels (CIELAB units for colour), in [1e-3, 1e6]; default 8. No effect
     * if refine_radius is 0.
     */
    double refine_tolerance;
    /**
     * Kind of object that the positive strokes mark: a LUXFER_SUBJECT_ value; default LUXFER_SUBJECT_AUTO. If the
     * subject is lamps, the settings above have no effect.
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
    /** Channels of the features that the segmentation has used, bit i for channel i. */
    uint32_t channels;
    /**
     * Expected share of wrong pixels, in [0, 1]. For a surface, it is estimated on strokes held out of the training.
     * For lamps, it is the area of the lamps, times the share of wrong pixels that is usual in such lamps, divided by
     * the area of the mask of luxfer_segment_set_region or, without this mask, of the photo.
     */
    double error;
    /** Number of samples of the negative class. */
    uint64_t negative_samples;
    /** Number of samples of the positive class. */
    uint64_t positive_samples;
    /** Number of pixels that strokes of both classes cover. Such a pixel belongs to the later stroke. */
    uint64_t contradictory_pixels;
} luxfer_segment_report;

/** The mask: 1 where the confidence is above one half, else 0; 1 channel. */
#define LUXFER_SEGMENT_MASK 0

/**
 * The confidence that a pixel is of the positive class, in [0, 1]; 1 channel. For a surface: the probability. For
 * lamps: 1 inside a lamp, 0 outside, 0.5 on its contour; it changes from 1 to 0 within about two pixels.
 */
#define LUXFER_SEGMENT_CONFIDENCE 1

/**
 * How much a pixel differs from all pixels under strokes, in [0, 1]; 1 channel. For lamps: 1 in regions that resemble
 * the painted lamps but not closely enough for the mask, else 0. Another stroke helps where the value is high.
 */
#define LUXFER_SEGMENT_UNSEEN 2

/**
 * Chooses the subject: lamps if luxfer_segment_set_region gave a mask and the features have ten channels, as
 * luxfer_features makes them; else a surface.
 */
#define LUXFER_SUBJECT_AUTO 0

/**
 * A surface, such as the plane that carries the lamps: each pixel is classified by its features. With the ten channels
 * of luxfer_features and without luxfer_segment_set_region, the mask is then restricted to the wall, the floor or the
 * ceiling that the positive strokes lie on. If the positive strokes lie on several of these surfaces, the mask keeps
 * only its connected parts that positive strokes touch.
 */
#define LUXFER_SUBJECT_SURFACE 1

/**
 * Lamps: compact regions with a sharp contour, brighter than their surroundings. Each positive stroke marks one lamp
 * or more. Regions without a stroke that resemble the marked lamps and lie in the mask of luxfer_segment_set_region
 * count as lamps too. Negative strokes are not needed. The first three channels of the features must be CIELAB.
 */
#define LUXFER_SUBJECT_LAMPS 2

/** Creates a segmentation. It has no inputs yet. The caller releases *segment. Any thread. */
luxfer_status luxfer_segment_create(luxfer_context *context, luxfer_segment **segment);

/**
 * Sets the features of each pixel: the image LUXFER_FEATURES_CHANNELS, or any image of 1 to 16 channels. Strokes for
 * images of another size are removed. Any thread.
 */
luxfer_status luxfer_segment_set_features(luxfer_segment *segment,
                                          luxfer_image *features);

/**
 * Restricts the segmentation to the pixels where region is 1. region is a mask with 1 channel, values of 0 and 1, and
 * the size of the features; for a segmentation of lights, it is the mask of the plane. NULL: no restriction. Any
 * thread.
 */
luxfer_status luxfer_segment_set_region(luxfer_segment *segment,
                                        luxfer_image *region);

/**
 * Sets the strokes from which the mask is made. The call copies the strokes for phase, a LUXFER_PHASE_ value; they
 * replace all earlier strokes. strokes may be NULL: no strokes. Any thread.
 * LUXFER_INVALID_ARGUMENT if the strokes are for images of another size than the features.
 */
luxfer_status luxfer_segment_set_strokes(luxfer_segment *segment,
                                         luxfer_phase phase,
                                         luxfer_strokes *strokes);

/**
 * Starts a job that computes the mask. If strokes are missing and the features come from luxfer_features, the job
 * proposes a mask, with LUXFER_WARNING_PROPOSED. For a surface it proposes the wall, the floor or the ceiling under
 * the positive strokes; without positive strokes it proposes the ceiling. For lamps it proposes lamps among the
 * brightest regions of the mask of luxfer_segment_set_region. params may be NULL for the defaults. The caller
 * releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the features are missing or a job is already running. The job may end with
 * LUXFER_DEGENERATE if strokes are missing and there is nothing to propose, LUXFER_INVALID_ARGUMENT if sizes differ,
 * a feature is not finite or a setting is out of range.
 */
luxfer_status luxfer_segment_start(luxfer_segment *segment,
                                   const luxfer_segment_params *params,
                                   luxfer_job **job);

/**
 * Gets the image of the result that kind, a LUXFER_SEGMENT_ value, selects, for example the mask. The caller releases
 * *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_segment_get_image(luxfer_segment *segment,
                                       luxfer_segment_image kind,
                                       luxfer_image **image);

/**
 * Gets the quality of the segmentation. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_segment_get_report(luxfer_segment *segment,
                                        luxfer_segment_report *report,
                                        size_t size);

/* ==================================================================================================================
 * Laws of an emission
 *
 * A law is the rule by which an emissive texture continues the lights of its exemplar, for example on a lattice.
 * ================================================================================================================== */

/** The law, that is, the rule by which a texture continues the lights of its exemplar: a LUXFER_LAW_ value. */
typedef int32_t luxfer_emission_law;

/**
 * In settings only: the law that predicts the lamps of the photo best. The law of LUXFER_LAW_CORRELATION is kept
 * unless another law predicts the lamps clearly better. If luxfer_emission_report.error of the texture then exceeds 1,
 * and there is a single exemplar, the other laws are tried, and the texture with the smallest error is kept. The
 * emission has the warning LUXFER_WARNING_NO_PATTERN even if another law gives a better texture.
 */
#define LUXFER_LAW_BEST 0

/**
 * In settings only: the law follows from the periods in the autocorrelation of the lights. Two periods give
 * LUXFER_LAW_LATTICE, one period gives LUXFER_LAW_ROW. Without a period, the law is LUXFER_LAW_WHOLE if the exemplar
 * shows few lamps or one isolated group of lamps, and otherwise LUXFER_LAW_FREE. A period counts only if the
 * correlation after a shift by this period is at least the setting min_regularity.
 */
#define LUXFER_LAW_CORRELATION 1

/** The lamps form a lattice with two periods. */
#define LUXFER_LAW_LATTICE 2

/** The lamps form a row with one period. Across the row, the strip that the exemplar shows is repeated edge to edge. */
#define LUXFER_LAW_ROW 3

/** The exemplar repeats as a whole, edge to edge, in both directions. */
#define LUXFER_LAW_WHOLE 4

/** The lights have no period: patches of the exemplar are placed anywhere in the texture. */
#define LUXFER_LAW_FREE 5

/** In results only: the texture is a copied part of the exemplar, or the caller supplied the texture. */
#define LUXFER_LAW_COPY 6

/* ==================================================================================================================
 * Emission
 *
 * Synthesises an emissive texture of any size and lists its luminaires. The texture continues the light pattern of an
 * exemplar: an unwarped photo of a plane with lamps, as luxfer_rectify makes it.
 * ================================================================================================================== */

/** A synthesis of an emissive texture. See luxfer_emission_create. */
typedef struct luxfer_emission luxfer_emission;

/** Settings of an emissive texture. Fill them with luxfer_emission_params_init. */
typedef struct luxfer_emission_params {
    /** sizeof(luxfer_emission_params), set by luxfer_emission_params_init. */
    uint32_t struct_size;
    /** Width of the texture in texels, in [1, 65536]; default 1024. */
    uint32_t width;
    /** Height of the texture in texels, in [1, 65536]; default 1024. */
    uint32_t height;
    /**
     * Side of the square patches that are copied from the exemplar, in [0, 65536], in pixels of the exemplar after its
     * reduction to working_side. 0, the default: with LUXFER_LAW_LATTICE, 1.5 times the longer period, but at most
     * half of the exemplar's shorter side; with other laws, a quarter of the shorter side.
     */
    uint32_t block;
    /** Number of unwarped pixels per texel, along one side, in [1e-3, 1e3]; default 1. */
    double scale;
    /**
     * Length in pixels to which the longest side of the exemplar is reduced for the synthesis, in [16, 2048]; default
     * 256.
     */
    uint32_t working_side;
    /**
     * Weight of the guide channels (LUXFER_EMISSION_EXEMPLAR_GUIDES) relative to colour when patches are compared,
     * in [0, 1e3]; default 1. 0: patches are compared by colour only, as in image quilting.
     */
    float guide_weight;
    /** Seed of the synthesis; default 1. */
    uint64_t seed;
    /**
     * Threshold of LUXFER_LAW_CORRELATION, in [0, 1]; default 0.6. A shift counts as a period of the lights if their
     * autocorrelation after this shift is at least this value. At 0, even a poor repetition counts. LUXFER_LAW_BEST
     * also tries periods with a lower autocorrelation. At 1, both choose LUXFER_LAW_FREE.
     */
    float min_regularity;
    /** 1, the default: every lamp of the texture stays in one piece; 0: seams between patches may cut lamps. */
    uint32_t whole_lamps;
    /**
     * Offset of the pattern from the texture's top-left corner, in texels to the right and down, each in [-1e6, 1e6];
     * default 0. LUXFER_LAW_FREE has no lattice that an offset could shift: with this law, an offset other than 0 ends
     * the job with LUXFER_INVALID_ARGUMENT. There are two exceptions. If the texture is tileable and no light is
     * copied patch by patch (luxfer_emission_get_luminaire says which lights are), the offset shifts all lamps. With
     * whole_lamps = 0, the offset has no effect.
     */
    double offset[2];
    /**
     * A channel of the photo counts as clipped if it is at least this value, in [0, 1]; default 0.95. The clipped
     * core of a lamp gets the colour of the lamp's rim, at the lowest brightness that is consistent with the clipped
     * channels. 0: no lamp counts as clipped.
     */
    float clip_level;
    /** 1: every lamp has its mean colour over its whole area; 0, the default: lamps look as in the photo. */
    uint32_t even_lamps;
    /**
     * 1: the texture can be repeated without seams. Lamps that cross an edge of the texture continue at the opposite
     * edge. Lights with periods are stretched so that a whole number of periods fits; the width and the height of the
     * pattern change by less than half a period. Needs whole_lamps = 1, or else the job ends with
     * LUXFER_INVALID_ARGUMENT. Default 0.
     */
    uint32_t tileable;
    /**
     * Whether the pattern is centred on the texture. A lamp, or the middle between two or four neighbouring lamps,
     * then lies at the texture's centre, whichever lets the border cut the fewest lamps, and the field offset shifts
     * the pattern from there. 0: not centred. 1: centred. 2, the default: centred if the texture is larger than what
     * the photo shows of the plane; but not if it is tileable, or if the photo shows both ends of a row of lamps.
     * No effect with LUXFER_LAW_FREE.
     */
    uint32_t centred;
    /**
     * For LUXFER_LAW_FREE: number of patches, drawn at random from the exemplar, that are compared for each patch of
     * the texture; in [1, 65536]; default 192. Patches of the exemplar that continue the neighbours already placed in
     * the texture are compared in addition.
     */
    uint32_t candidates;
    /** Must be 0. */
    uint32_t reserved;
    /**
     * The law: the rule by which the texture continues the lights of the exemplar, a LUXFER_LAW_ value other than
     * LUXFER_LAW_COPY; default LUXFER_LAW_BEST.
     */
    luxfer_emission_law law;
    /**
     * 1, the default: all lamps of one kind (of about equal size and shape) that resemble rectangles or ellipses, or
     * frames or rings, are drawn with one size and one outline, which stays sharp at any resolution. They lie exactly
     * on their lattice. This needs the photo and whole_lamps. 0: each lamp has the outline that the mask gives.
     */
    uint32_t clean_lamps;
    /**
     * Maximum relative magnification of the exemplar's pixels, in [1, 1e6]; 0, the default: no limit. Unwarping
     * magnifies distant parts of the plane more than near parts. The magnification of a pixel is its length in the
     * unwarped photo divided by its length in the photo; the relative magnification is the magnification of the pixel
     * divided by the magnification of the least magnified pixel of the exemplar. Pixels beyond the limit are left out,
     * as if the photo did not show them.
     */
    double max_magnification;
} luxfer_emission_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_emission_params_init(luxfer_emission_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_EMISSION_PARAMS, place, size);
}

/** An image of the emission: a LUXFER_EMISSION_ value. */
typedef int32_t luxfer_emission_image;

/**
 * Description of a texture: its lamps, the law (rule) by which it continues the exemplar's lights, and its quality. A
 * composition (luxfer_emission_start_composition) has no texels yet, so its error is NaN and its sampling_error is 0.
 * If there are several exemplars, the fields regularity, law, runner_up, law_score and margin describe the first
 * exemplar.
 */
typedef struct luxfer_emission_report {
    /** sizeof(luxfer_emission_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of luminaires in the texture; see luxfer_emission_get_luminaire. */
    uint32_t luminaires;
    /**
     * Largest relative difference between texture and exemplar in three statistics: the share of lit area, the mean
     * area of a whole lamp, and the mean distance from a whole lamp to its nearest neighbour. The value 0.1 stands for
     * 10 %. It means little if exemplar_lamps is small. NaN for a composition.
     */
    double error;
    /**
     * Regularity of the lights, in [0, 1]: their autocorrelation after a shift by one period. If there are two
     * periods, it is the lower of their two autocorrelations. 0 if the lights have no period, or if the period was
     * found from the distances between lamps.
     */
    double regularity;
    /**
     * Number of whole lamps in the exemplars. If it is below six, the statistics in the field error are unreliable,
     * because the border then cuts a large share of the lamps. If there is no whole lamp, the texture is made from the
     * lamps that the border cuts; with clean_lamps, they are completed to rectangles unless the photo contradicts
     * this.
     */
    uint32_t exemplar_lamps;
    /**
     * Estimate of the value that the field error takes by chance, because the exemplar shows only a part of its
     * ceiling. It is the root mean square difference between the three statistics of the whole texture and the
     * statistics of parts of the texture that are as large as the exemplar. If error is at most twice this value, it
     * does not indicate a bad texture. 0 for LUXFER_LAW_WHOLE and LUXFER_LAW_COPY, for several exemplars, for a
     * composition, and if the texture is too small to hold parts as large as the exemplar at clearly different places.
     */
    float sampling_error;
    /** The law (rule) by which the texture continues the lights: a LUXFER_LAW_ value. */
    luxfer_emission_law law;
    /**
     * The law with the best score among the laws that were not chosen: a LUXFER_LAW_ value. It equals the field law if
     * the two laws differ only in their periods, or if no other law was compared.
     */
    luxfer_emission_law runner_up;
    /**
     * Score of the chosen law, in [0, 1]: how well it predicts the position of each lamp of the photo from the other
     * lamps. Lamps weigh in proportion to their pixels in the photo. LUXFER_LAW_WHOLE and LUXFER_LAW_FREE predict
     * nothing and have a fixed score. NaN if no score was computed, for example because too few of the lights are
     * whole lamps.
     */
    double law_score;
    /**
     * law_score minus the score of runner_up; law_score alone if no other law was compared; NaN if law_score is NaN.
     * LUXFER_LAW_BEST prefers the law that LUXFER_LAW_CORRELATION would choose, and lattices along the axes of the
     * room. If it has kept a preferred law although runner_up scores slightly better, the value is negative.
     */
    double margin;
} luxfer_emission_report;

/** A luminaire: one lamp of the texture. */
typedef struct luxfer_luminaire {
    /** sizeof(luxfer_luminaire), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of corners of the outer outline. */
    uint32_t corners;
    /** Centre in texels, x to the right and y down; the texture's top-left corner is (0, 0). */
    double centre[2];
    /** Extents of the lamp along its two principal axes, in texels, the longer one first. */
    double size[2];
    /** Angle of the long axis, measured from x (right) towards y (down), in radians, in (-pi/2, pi/2]. */
    double orientation;
    /**
     * Area in square texels, without the hole of a ring. A texel at the edge of the lamp counts with the share that
     * the lamp covers.
     */
    double area;
    /** This lamp's share of the luminous flux of all lamps of the texture, in [0, 1]. */
    double flux_share;
    /** Mean linear RGB colour, where 1 is the photo's white. */
    float colour[3];
    /**
     * Number of the lamp's kind, from 1. Lamps of about equal size and shape, whose areas and sides differ by at most
     * 25 %, are of one kind; kind 1 has the most lamps. 0 if the border of the texture cuts the lamp.
     */
    uint32_t kind;
} luxfer_luminaire;

/** The texture: linear RGB, where 1 is the photo's white; 0 outside lamps. */
#define LUXFER_EMISSION_TEXTURE 0

/** The mask of the texture: 1 on lamps, else 0; 1 channel. */
#define LUXFER_EMISSION_MASK 1

/**
 * The guide channels of the exemplar, by which patches are compared in addition to colour; 3 channels, at the reduced
 * resolution that working_side gives. Channel 0 is the confidence, in [0, 1], that the pixel shows a light. Channels 1
 * and 2 are the x and y offsets from the pixel to the nearest lit pixel, positive to the right and down, divided by a
 * length L and clamped to [-1, 1]; both are 1 if no pixel is lit. L is the side of a patch, but at most half the
 * longer period if the lights repeat.
 */
#define LUXFER_EMISSION_EXEMPLAR_GUIDES 2

/**
 * The guide channels of the texture, at the resolution of LUXFER_EMISSION_EXEMPLAR_GUIDES: pixels of that image,
 * copied with the patches that give the texture its colours.
 */
#define LUXFER_EMISSION_GUIDES 3

/** Creates a synthesis of an emissive texture. It has no inputs yet. The caller releases *emission. Any thread. */
luxfer_status luxfer_emission_create(luxfer_context *context,
                                     luxfer_emission **emission);

/**
 * Sets the exemplar: three images of one size. unwarped is the unwarped photo (linear RGB). light is the unwarped mask
 * of the lights: the confidence that a pixel shows a light (1 channel, in [0, 1]). valid is 1 at the pixels where both
 * other images are valid, else 0 (1 channel). luxfer_emission_add_style adds more exemplars. Any thread.
 */
luxfer_status luxfer_emission_set_exemplar(luxfer_emission *emission,
                                           luxfer_image *unwarped,
                                           luxfer_image *light,
                                           luxfer_image *valid);

/**
 * Sets the photo, from which the texture takes its full detail, and the homography from unwarped pixels to photo
 * pixels: 9 doubles row by row (luxfer_rectify_report.to_photo). If the rectification has undone a distortion, photo
 * must be the image that luxfer_rectify_undistort makes from your photo. photo may be NULL: the detail then comes from
 * the unwarped image only. Any thread.
 */
luxfer_status luxfer_emission_set_photo(luxfer_emission *emission,
                                        luxfer_image *photo,
                                        const double *to_photo);

/**
 * Starts a job that makes the whole texture in memory. For textures that are too large for the memory, use
 * luxfer_emission_start_composition. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the exemplar is missing or a job is already running. The job may end with
 * LUXFER_DEGENERATE if the exemplar has no lights, or if the setting law asks for a lattice or a row that the lights
 * do not form; LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of range.
 */
luxfer_status luxfer_emission_start(luxfer_emission *emission,
                                    const luxfer_emission_params *params,
                                    luxfer_job **job);

/**
 * Gets the image that a LUXFER_EMISSION_ value selects. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job of luxfer_emission_start has succeeded, or if a later composition has replaced its
 * texture.
 */
luxfer_status luxfer_emission_get_image(luxfer_emission *emission,
                                        luxfer_emission_image kind,
                                        luxfer_image **image);

/**
 * Gets the description of the texture, or of the composition after luxfer_emission_start_composition. size is sizeof
 * *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_emission_get_report(luxfer_emission *emission,
                                         luxfer_emission_report *report,
                                         size_t size);

/**
 * Describes a luminaire of the texture; index starts at 0. size is sizeof *luminaire. Any thread.
 *
 * A composition (luxfer_emission_start_composition) has no texels yet. Its luminaires are measured in the exemplar,
 * and cut at the edges of the texture. Lights that are copied patch by patch are the exception: they are measured as
 * the texture will show them. These are lights that run through the whole exemplar, such as light bands, and all
 * lights if whole_lamps is 0.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such luminaire.
 */
luxfer_status luxfer_emission_get_luminaire(luxfer_emission *emission,
                                            uint32_t index,
                                            luxfer_luminaire *luminaire,
                                            size_t size);

/**
 * Gets a corner of a luminaire's outline, x and y in texels as in luxfer_luminaire.centre; index and corner start at
 * 0. Any thread.
 *
 * The outline runs where the lamp covers half of a texel. If the confidence of the lights has values between 0 and 1,
 * the sides of the outline are accurate to a quarter of a texel, and its corners to 0.71 texels. If unwarped pixels
 * are larger than texels, both limits are in unwarped pixels.
 *
 * In three cases the outline follows the sides of texels instead: for lamps up to two texels wide, for masks of only 0
 * and 1, and for lights of a composition that are copied patch by patch (see luxfer_emission_get_luminaire).
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such luminaire or corner.
 */
luxfer_status luxfer_emission_get_corner(luxfer_emission *emission,
                                         uint32_t index,
                                         uint32_t corner,
                                         double *x,
                                         double *y);

/* ==================================================================================================================
 * Styles and tiles
 *
 * luxfer_emission_add_style adds exemplars, whose lights are then mixed in one texture. Textures that are too large to
 * make as a whole are made in tiles: luxfer_emission_start_composition decides where every lamp lies, and
 * luxfer_emission_render_tile renders any rectangle of the texture. A composition holds the exemplars, the place of
 * each lamp and the outlines of the patches, but no texels.
 * ================================================================================================================== */

/**
 * Adds an exemplar. The texture then mixes the lights of all exemplars: for each place of the texture, the image
 * weights states the share of the lamps that come from the added exemplar. The arguments unwarped, light and valid
 * have the meanings that they have for luxfer_emission_set_exemplar; photo, which may be NULL, and to_photo have the
 * meanings that they have for luxfer_emission_set_photo. scale is the number of unwarped pixels of this exemplar per
 * texel, in [1e-3, 1e3]. Any thread.
 *
 * The image weights has 1 channel with values in [0, 1] and is stretched over the texture. If several exemplars are
 * added, their weights are images of one size, and the sum of the weights of a pixel is at most 1; the first exemplar
 * gets the remaining weight.
 *
 * Each lamp of the texture comes from one exemplar, chosen at random with the weights at the lamp's centre as
 * probabilities. On average, the light per area is therefore the weighted mean of the exemplars. Lights that run
 * beyond the border of their exemplar are not chosen at random; they are dimmed by their exemplar's weight instead.
 * The lattice of each exemplar keeps its own period and phase.
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
 * Starts a job that composes the texture: it decides where every lamp lies, but makes no texels. The composition
 * replaces a texture that luxfer_emission_start has made. params and all errors are as for luxfer_emission_start.
 * With LUXFER_LAW_BEST, a composition never tries other laws, because that needs the texels.
 * luxfer_emission_get_report and luxfer_emission_get_luminaire describe the composition and its lamps. The caller
 * releases *job. Any thread.
 */
luxfer_status luxfer_emission_start_composition(luxfer_emission *emission,
                                                const luxfer_emission_params *params,
                                                luxfer_job **job);

/**
 * Renders a rectangle (a tile) of a composed texture: width x height texels, whose top-left texel is texel (x, y) of
 * the texture. The tile has 4 channels: linear RGB, and a mask that is 1 on lamps, else 0. Tiles of any sizes,
 * rendered in any order, equal to the bit the texture and the mask that luxfer_emission_start makes with these
 * settings, unless LUXFER_LAW_BEST makes luxfer_emission_start try other laws, which a composition never does. The
 * call takes up to a second per megapixel. The caller releases *tile. Any thread; several threads may render tiles at
 * the same time.
 * LUXFER_NOT_READY before a job of luxfer_emission_start_composition has succeeded; LUXFER_INVALID_ARGUMENT if the
 * rectangle is empty or exceeds the texture; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_emission_render_tile(luxfer_emission *emission,
                                          uint32_t x,
                                          uint32_t y,
                                          uint32_t width,
                                          uint32_t height,
                                          luxfer_image **tile);

/* ==================================================================================================================
 * Relighting
 *
 * Solves for the colour and intensity of an emission with which a surface of the scene, the target, has the same
 * colour as in the photo. The solution is a factor for the emission, per channel, with a confidence interval.
 * ================================================================================================================== */

/** A relighting: a solver for the emission of one material. See luxfer_relight_create. */
typedef struct luxfer_relight luxfer_relight;

/** Whether light should equal its target value, or stay above or below it: a LUXFER_CONSTRAINT_ value. */
typedef int32_t luxfer_constraint;

/** The quantity of the target surface that should match the photo: a LUXFER_QUANTITY_ value. */
typedef int32_t luxfer_quantity;

/** How the light of the target surface is compared with its target value: a LUXFER_FIT_ value. */
typedef int32_t luxfer_fit;

/** Settings of a relighting. Fill them with luxfer_relight_params_init. */
typedef struct luxfer_relight_params {
    /** sizeof(luxfer_relight_params), set by luxfer_relight_params_init. */
    uint32_t struct_size;
    /** Quantity to match: a LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING. */
    luxfer_quantity quantity;
    /** Maximum number of paths, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /**
     * Stop when luxfer_relight_report.error is at most this value, in [0, 1]; default 0.01; 0: do not stop for this
     * reason.
     */
    float target_error;
    /** Stop after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** How the light of the target is compared with its target value: a LUXFER_FIT_ value; default LUXFER_FIT_MEAN. */
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

/** The solution of a relighting and its confidence. */
typedef struct luxfer_relight_report {
    /** sizeof(luxfer_relight_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of traced paths. */
    uint32_t paths;
    /** Factor for the emission, per channel, >= 0. */
    double scale[3];
    /** Half-widths of the 95 % confidence intervals of the field scale. */
    double half_width[3];
    /** Mean radiance of the target from the emission at scale 1, in cd/m² per channel. */
    double response[3];
    /** Mean radiance of the target from all other light, in cd/m² per channel. */
    double background[3];
    /** Whether each channel meets its target: a LUXFER_OUTCOME_ value. */
    luxfer_outcome outcome[3];
    /** Reserved; always 0. */
    uint32_t reserved;
    /**
     * The largest relative half-width (half_width / scale) among the channels that meet their target; 0 without such
     * channels.
     */
    double error;
    /**
     * Uncertainty of the target's colour under the solution. With a probability of 95 %, the CIEDE2000 difference
     * between the actual and the wanted colour is below this value. Both colours are taken at the exposure that shows
     * the target as middle grey.
     */
    double delta_e;
} luxfer_relight_report;

/**
 * Light that the target surface reflects diffusely, its albedo included: the radiance that a photo shows of a matt
 * surface.
 */
#define LUXFER_QUANTITY_OUTGOING 0

/** Light that arrives at the target surface, as the radiance of a white surface in this light: illuminance / pi. */
#define LUXFER_QUANTITY_INCIDENT 1

/** The mean of the light over the target surface should equal the target value. */
#define LUXFER_FIT_MEAN 0

/**
 * The sum, over all points of the target surface, of the squared difference between light and target value should be
 * smallest. A gradient descent on the texels of the emission would minimise this sum too. Bright points count more, so
 * the emission is dimmer than with LUXFER_FIT_MEAN. Without other light it is dimmer by the factor 1/(1+CV²), where CV
 * is the coefficient of variation (standard deviation divided by mean) of the light over the target surface.
 */
#define LUXFER_FIT_LEAST_SQUARES 1

/** The light should equal its target value. */
#define LUXFER_CONSTRAINT_EQUAL 0

/**
 * The light should be at least its target value, for example because a standard requires it on a desk, or because the
 * photo clips this channel.
 */
#define LUXFER_CONSTRAINT_AT_LEAST 1

/** The light should be at most its target value, for example to limit glare. */
#define LUXFER_CONSTRAINT_AT_MOST 2

/** The target, or its limit, is met. */
#define LUXFER_OUTCOME_SATISFIED 0

/**
 * The other lights alone exceed the target, so the emission is 0 in this channel; or, for a luxfer_lamps and for
 * luxfer_transfer_start_all, two targets contradict each other.
 */
#define LUXFER_OUTCOME_TOO_BRIGHT 1

/**
 * No light of this channel reaches the target: the channel gets the mean scale of the channels that meet the target.
 */
#define LUXFER_OUTCOME_DARK 2

/**
 * All lamps at their largest power are too weak, or two goals contradict each other. Occurs only for a luxfer_lamps,
 * and for transfers whose light luxfer_transfer_start_all solves for together.
 */
#define LUXFER_OUTCOME_TOO_DIM 3

/** Creates a relighting. It has no inputs yet. The caller releases *relight. Any thread. */
luxfer_status luxfer_relight_create(luxfer_context *context, luxfer_relight **relight);

/**
 * Sets the scene, the emitting material to solve for, and the target mesh, whose mean colour should match. Points of
 * the mesh that emit light are left out. The solution is a factor for the emission that the material has in the scene.
 * luxfer_scene_place_emission returns the index of such a material, and the index of a mesh that can serve as the
 * target. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material or mesh.
 */
luxfer_status luxfer_relight_set_scene(luxfer_relight *relight,
                                       luxfer_scene *scene,
                                       uint32_t material,
                                       uint32_t mesh);

/**
 * Sets rgb, the mean radiance that the target mesh should have, in cd/m² per channel, each in [0, 1e15]. For
 * LUXFER_QUANTITY_INCIDENT, rgb is the radiance that a white surface would have in place of the target: illuminance /
 * pi. Any thread.
 * LUXFER_INVALID_ARGUMENT if a channel is out of range.
 */
luxfer_status luxfer_relight_set_target(luxfer_relight *relight,
                                        const float rgb[3]);

/**
 * Makes the target a lower or upper limit; constraint holds a LUXFER_CONSTRAINT_ value for each channel: red, green,
 * blue. A channel that the photo clips should be LUXFER_CONSTRAINT_AT_LEAST. A channel with a limit gets the mean
 * scale of the channels without a limit, if this scale respects the limit; else the scale that just reaches the limit.
 * Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is not a LUXFER_CONSTRAINT_ value.
 */
luxfer_status luxfer_relight_set_constraint(luxfer_relight *relight,
                                            const luxfer_constraint constraint[3]);

/**
 * Starts a job that solves for the factor by which to multiply the emission. params may be NULL for the defaults. The
 * caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene or the target is missing or a job is already running; LUXFER_INVALID_ARGUMENT
 * if a setting is out of range. The job may end with LUXFER_UNREACHABLE if no channel has a solution: no emitted light
 * of the channel reaches the target, or the other lights alone exceed it; LUXFER_DEGENERATE if the target has no area;
 * LUXFER_INVALID_ARGUMENT if the scene is not valid.
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
