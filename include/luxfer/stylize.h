/* luxfer: stylisation by example.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_STYLIZE_H
#define LUXFER_STYLIZE_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Guides
 *
 * Renders the guide images of a stylisation: images of one scene, each of which shows one kind of its light, its
 * normals, its edges or its materials. A stylisation needs the guides of the exemplar scene and of the target scene.
 * Guides from another renderer do not need this object: see luxfer_stylize_add_guide.
 * ================================================================================================================== */

/** The guides of a scene. See luxfer_guides_create. */
typedef struct luxfer_guides luxfer_guides;

/** Settings of the guides. Fill them with luxfer_guides_params_init. */
typedef struct luxfer_guides_params {
    /** sizeof(luxfer_guides_params), set by luxfer_guides_params_init. */
    uint32_t struct_size;
    /** Width of the images in pixels, in [1, 32768]; default 800. */
    uint32_t width;
    /** Height of the images in pixels, in [1, 32768]; default 608. */
    uint32_t height;
    /** Paths per pixel, in [1, 1048576]; default 64. */
    uint32_t samples;
    /** Index of the camera in the scene; default 0. */
    uint32_t camera;
    /**
     * 1, the default: smooth the light along surfaces, so that the stylisation does not match noise; 0: keep the
     * noise.
     */
    uint32_t smooth;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_guides_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_guides_params_init(luxfer_guides_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_GUIDES_PARAMS, place, size);
}

/**
 * A guide image: a LUXFER_GUIDES_ value. Guide images of light are linear RGB in cd/m². The expressions in parentheses
 * describe their light paths: L is a light, D a diffuse reflection, S a reflection or transmission at a glossy
 * surface, mirror or clear pane, E the camera.
 */
typedef int32_t luxfer_guides_image;

/** All light (L.*E): lights that are seen directly, and light that is reflected or transmitted any number of times. */
#define LUXFER_GUIDES_FULL 0

/** Light reflected once, by a diffuse surface (LDE). */
#define LUXFER_GUIDES_DIRECT 1

/** Light reflected or transmitted once, at a glossy surface, mirror or clear pane (LSE). */
#define LUXFER_GUIDES_SPECULAR 2

/** Light whose last two reflections were diffuse (L.*DDE): it shows colour bleeding. */
#define LUXFER_GUIDES_INDIRECT 3

/** Light reflected once or twice, by diffuse surfaces (LD{1,2}E): unlike direct light, it shows detail in shadows. */
#define LUXFER_GUIDES_TWO_BOUNCES 4

/** Unit normals in camera space: x right, y up, z towards the camera; 0 where there is no surface; 3 channels. */
#define LUXFER_GUIDES_NORMALS 5

/**
 * Strength of the edges of shapes, in [0, 1]: changes of material, creases and jumps in depth; 1 on a clear edge, 0
 * away from edges; 1 channel.
 */
#define LUXFER_GUIDES_EDGES 6

/**
 * A colour for each material, derived from its name, so that materials of equal name match in all scenes; black where
 * there is no surface; 3 channels.
 */
#define LUXFER_GUIDES_MATERIALS 7

/**
 * Caustics: light that glossy surfaces, mirrors or clear panes (one or more of them) cast onto a diffuse surface,
 * which reflects it to the camera (LS+DE).
 */
#define LUXFER_GUIDES_CAUSTICS 8

/** Creates an object that renders guides. It has no inputs yet. The caller releases *guides. Any thread. */
luxfer_status luxfer_guides_create(luxfer_context *context, luxfer_guides **guides);

/** Sets the scene; each job renders the scene as it is when the job starts. Any thread. */
luxfer_status luxfer_guides_set_scene(luxfer_guides *guides, luxfer_scene *scene);

/**
 * Starts a job that renders the guides. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if smooth is not 0 or 1; LUXFER_INVALID_OPERATION if the scene is missing or a job is
 * already running; LUXFER_NOT_FOUND if the scene has no such camera. The job checks the scene and the other settings,
 * and may end with LUXFER_INVALID_ARGUMENT.
 */
luxfer_status luxfer_guides_start(luxfer_guides *guides,
                                  const luxfer_guides_params *params,
                                  luxfer_job **job);

/**
 * Gets the guide image that a LUXFER_GUIDES_ value selects. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_guides_get_image(luxfer_guides *guides,
                                      luxfer_guides_image kind,
                                      luxfer_image **image);

/**
 * Computes the motion between two frames of a sequence, for luxfer_stylize_set_motion. The parameter guides holds the
 * current frame, previous the frame before it. The image motion has 2 channels: for each pixel of the current frame,
 * the offset x (right) and y (down), in pixels, to the position of the pixel's surface point in the previous frame. It
 * is NaN where the previous frame does not show the point. The caller releases *motion. Any thread.
 *
 * The frames may be rendered from different scenes. Camera, objects and single vertices may have moved. A mesh of the
 * current frame and a mesh of the previous frame are one object if they have equal names, numbers of vertices and
 * triangle indices. If several meshes of a frame are equal in all three, they correspond in their order, provided that
 * the other frame has as many of them. If an object has no counterpart in the previous frame, its motion is NaN, and
 * luxfer_get_warnings of guides has a warning. A pixel of a mirror or pane has the motion of the mirror or pane
 * itself, not of the objects that are seen in it.
 * LUXFER_NOT_READY before the guides of both frames are rendered; LUXFER_INVALID_ARGUMENT if their sizes differ.
 */
luxfer_status luxfer_guides_get_motion(luxfer_guides *guides,
                                       luxfer_guides *previous,
                                       luxfer_image **motion);

/* ==================================================================================================================
 * Settings of a stylisation
 *
 * Presets and settings. StyLit is the paper of Fiser et al. 2016, "StyLit: Illumination-Guided Example-Based
 * Stylization of 3D Renderings". As in StyLit, exemplar patches are matched with target patches in several passes. In
 * each pass, every exemplar patch finds the nearest target patch that has no match yet. The pairs are accepted,
 * smallest error first, until the sum of their errors reaches the error budget, which the library computes from the
 * errors of the pass. This prevents a few patches from being used everywhere, and bad matches from being forced. The
 * defaults were chosen from the curves of quality against time that benches/stylit.rs draws.
 * ================================================================================================================== */

/**
 * A preset of the settings, which trades quality for speed: a LUXFER_STYLIZE_ preset, that is, LUXFER_STYLIZE_FULL,
 * LUXFER_STYLIZE_FAST, LUXFER_STYLIZE_PREVIEW or LUXFER_STYLIZE_PAPER.
 */
typedef int32_t luxfer_stylize_preset;

/** The search for nearest patches: a LUXFER_STYLIZE_SEARCH_ value. */
typedef int32_t luxfer_stylize_search;

/** How a pixel is computed from overlapping patches: a LUXFER_STYLIZE_VOTE_ value. */
typedef int32_t luxfer_stylize_vote;

/**
 * Settings of a stylisation. Fill them with luxfer_stylize_params_init or luxfer_stylize_get_preset. The defaults
 * stated here belong to LUXFER_STYLIZE_FULL.
 */
typedef struct luxfer_stylize_params {
    /** sizeof(luxfer_stylize_params), set by luxfer_stylize_params_init. */
    uint32_t struct_size;
    /** Search for nearest patches: a LUXFER_STYLIZE_SEARCH_ value; default LUXFER_STYLIZE_SEARCH_PATCHMATCH. */
    luxfer_stylize_search search;
    /**
     * Width of a patch in pixels, odd, in [1, 33]; default 5. Patches are smaller if an image is smaller than one
     * patch.
     */
    uint32_t patch;
    /**
     * Weight of all guides together, relative to the weight of all colour channels of the artwork together, in [0,
     * 1e6]; default 2.
     */
    float guide_weight;
    /**
     * Factor for guide_weight on all levels but the finest, in [0, 1000]; default 4; StyLit has 1. With a larger
     * factor the picture follows the guides more closely, with smaller connected pieces of the artwork.
     */
    float coarse_guides;
    /**
     * Maximum number of resolution levels, each half as wide and high as the next finer one, in [1, 16]; default 6.
     * The coarsest level is at least 5 patches wide and high.
     */
    uint32_t levels;
    /** Rounds on the second finest level, in [1, 100]; default 6. A round is an EM iteration: matching, then voting. */
    uint32_t iterations;
    /** Rounds (EM iterations) on each level coarser than the second finest, in [1, 100]; default 24; StyLit has 6. */
    uint32_t coarse_iterations;
    /** Rounds (EM iterations) on the finest level, in [1, 100]; default 1. */
    uint32_t finest_iterations;
    /**
     * Additional rounds (EM iterations) on the finest level, in [0, 100]; default 3; StyLit has 0. In these rounds
     * each target patch takes its nearest exemplar patch, without the error budget.
     */
    uint32_t polish;
    /** Number of PatchMatch iterations in one search for nearest patches, in [1, 100]; default 1. */
    uint32_t search_iterations;
    /**
     * The passes under the error budget end once they have matched this share of the target patches, in [0, 1];
     * default 0.9. Each remaining target patch then takes its nearest exemplar patch.
     */
    float coverage;
    /**
     * Maximum number of matching passes under the error budget in one round (EM iteration), in [1, 1000]; default 6.
     */
    uint32_t passes;
    /**
     * Number of iterations after each matching, in [0, 100]; default 2; StyLit has 0. In such an iteration, a target
     * patch may take the exemplar patch that continues the match of its neighbour, which leaves fewer seams.
     */
    uint32_t settle;
    /**
     * Cost of a seam, as a share of the mean error of a match, in [0, 100]; default 0.2. A seam lies between two
     * neighbouring target patches whose matches are not neighbours in the exemplar. The cost applies to the iterations
     * after each matching; see settle.
     */
    float seam;
    /**
     * How a pixel is computed from overlapping patches in all rounds but the last: a LUXFER_STYLIZE_VOTE_ value;
     * default LUXFER_STYLIZE_VOTE_WEIGHTED.
     */
    luxfer_stylize_vote vote;
    /**
     * How a pixel of the final picture, after the last round, is computed from overlapping patches: a
     * LUXFER_STYLIZE_VOTE_ value; default LUXFER_STYLIZE_VOTE_ADAPTIVE.
     */
    luxfer_stylize_vote final_vote;
    /**
     * 1: work at half resolution, which makes the picture half as wide and high, with compressed guides: the few
     * principal components of all guides instead of the guides themselves. 0, the default: full resolution.
     */
    uint32_t preview;
    /**
     * 1: keep the data that luxfer_stylize_update needs, about as much memory as all guides; 0, the default: free it.
     */
    uint32_t keep_for_update;
    /**
     * Share of the previous frame's paint that is kept where it fits, in [0, 1]; default 1. Below 1 the paint changes
     * from frame to frame ("boils"), as in hand-painted animation, if each frame has its own seed. No effect without
     * luxfer_stylize_set_motion.
     */
    float coherence;
    /**
     * Degree to which the exemplar's light guides are adapted, in brightness and contrast, to the target's light
     * guides, in [0, 1]; 0, the default: not at all.
     */
    float match_appearance;
    /** Must be 0. */
    uint32_t reserved;
    /** Seed of the search; default 1. */
    uint64_t seed;
} luxfer_stylize_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_stylize_params_init(luxfer_stylize_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_STYLIZE_PARAMS, place, size);
}

/** Full quality, the default. */
#define LUXFER_STYLIZE_FULL 0

/** Nearly the quality of LUXFER_STYLIZE_FULL in half the time. */
#define LUXFER_STYLIZE_FAST 1

/** Half resolution with compressed guides (see luxfer_stylize_params.preview), for feedback while painting. */
#define LUXFER_STYLIZE_PREVIEW 2

/** The settings of StyLit (Fiser et al. 2016), for comparison. */
#define LUXFER_STYLIZE_PAPER 3

/** PatchMatch (Barnes et al. 2009), the default. */
#define LUXFER_STYLIZE_SEARCH_PATCHMATCH 0

/** A k-d tree over the mean colours and guides of patches. */
#define LUXFER_STYLIZE_SEARCH_KD_TREE 1

/** The mean of the colours that the overlapping patches have at the pixel. */
#define LUXFER_STYLIZE_VOTE_PLAIN 0

/**
 * The mean of the colours that the overlapping patches have at the pixel, weighted so that closer matches count more.
 */
#define LUXFER_STYLIZE_VOTE_WEIGHTED 1

/**
 * Of the overlapping patches' colours, the colour that is nearest to their mean, so that every colour occurs in the
 * artwork.
 */
#define LUXFER_STYLIZE_VOTE_NEAREST 2

/**
 * The artwork pixel that the largest number of overlapping patches put at this pixel. Where two pieces of the artwork
 * meet, each stays whole up to the seam.
 */
#define LUXFER_STYLIZE_VOTE_MAJORITY 3

/**
 * A blend of LUXFER_STYLIZE_VOTE_PLAIN and LUXFER_STYLIZE_VOTE_MAJORITY. The proportion varies, so that each place of
 * the picture has as much fine detail as the place of the artwork from which it was painted. The blend thus copies
 * pixels of the artwork unchanged in rough paint, has soft transitions in smooth paint, and has edges as sharp as in
 * the artwork. luxfer_stylize_report.unblended_share is the share of unchanged pixels.
 */
#define LUXFER_STYLIZE_VOTE_ADAPTIVE 4

/**
 * Fills *params with a preset: LUXFER_STYLIZE_FULL, LUXFER_STYLIZE_FAST, LUXFER_STYLIZE_PREVIEW or
 * LUXFER_STYLIZE_PAPER. size is sizeof *params. Any thread.
 * LUXFER_INVALID_ARGUMENT if preset is another value.
 */
luxfer_status luxfer_stylize_get_preset(luxfer_stylize_preset preset,
                                        luxfer_stylize_params *params,
                                        size_t size);

/* ==================================================================================================================
 * Stylisation
 *
 * Paints a target scene in the style in which an artist has painted an exemplar scene (StyLit). Set the artwork, add
 * the guides (pairs of images that show the light in the exemplar and in the target) and start a job. Or set a
 * half-painted picture and let the library paint the rest. While the job runs, and after a cancel, the picture of the
 * finest finished resolution level can be read.
 *
 * Patents cover some of the methods in some countries, so a build of the library may leave stylisation out. Its
 * functions still exist in such a build, but luxfer_stylize_create returns LUXFER_UNSUPPORTED.
 * ================================================================================================================== */

/**
 * Flag of luxfer_stylize_add_guides: add the normals. Without this flag, the normals are used only if the strokes of
 * the artwork follow the shapes.
 */
#define LUXFER_GUIDES_WITH_NORMALS 1

/** Flag of luxfer_stylize_add_guides: add the edges, for shapes finer than the brush strokes. */
#define LUXFER_GUIDES_WITH_EDGES 2

/**
 * Flag of luxfer_stylize_add_guides: add the colour code of materials, so that objects of one material are painted
 * from objects of that material.
 */
#define LUXFER_GUIDES_WITH_MATERIALS 4

/**
 * Flag of luxfer_stylize_add_guides: add a guide of the caustics, at the same exposure as the other guides of light.
 * Use it for scenes in which glossy objects reflect light onto others.
 */
#define LUXFER_GUIDES_WITH_CAUSTICS 8

/** A stylisation. See luxfer_stylize_create. */
typedef struct luxfer_stylize luxfer_stylize;

/** How the values of a guide are compared: a LUXFER_GUIDE_ value. */
typedef int32_t luxfer_guide_range;

/**
 * Linear light >= 0, such as a rendering. Its values are clipped at white (1) and compared in the sRGB encoding. If
 * the 99.9th percentile of source and target together exceeds 1, all values are divided by this percentile first.
 */
#define LUXFER_GUIDE_LIGHT 0

/**
 * Data, such as normals, object codes and edges. The range of values that all channels of source and target have
 * together is scaled to [0, 1].
 */
#define LUXFER_GUIDE_DATA 1

/**
 * Creates a stylisation. It has no inputs yet. The caller releases *stylize. Any thread.
 * LUXFER_UNSUPPORTED if stylisation was left out of this build.
 */
luxfer_status luxfer_stylize_create(luxfer_context *context, luxfer_stylize **stylize);

/**
 * Sets the artwork: the exemplar scene as painted by the artist. It is an image in linear colour with 1, 3 or 4
 * channels, of the size of the guides' sources and aligned with them. Any thread.
 */
luxfer_status luxfer_stylize_set_artwork(luxfer_stylize *stylize,
                                         luxfer_image *artwork);

/**
 * Adds a guide, or replaces the guide that has this name. The image source shows the exemplar scene, and the image
 * target shows the scene to paint; both have equal numbers of channels. If target is NULL, source serves as the target
 * too; use this for a picture of which one part is painted already (luxfer_stylize_set_painted). name is UTF-8.
 * weight, in [0, 1e6], is relative to the other guides; range is a LUXFER_GUIDE_ value. Any thread.
 *
 * All sources must have one size, and all targets one size. All guides together have at most 60 channels. In a
 * target, values that are not finite count as 0; pixels of a source with such values are not used.
 * LUXFER_INVALID_ARGUMENT if the numbers of channels differ or are too large, or a value is out of range.
 */
luxfer_status luxfer_stylize_add_guide(luxfer_stylize *stylize,
                                       const char *name,
                                       luxfer_image *source,
                                       luxfer_image *target,
                                       float weight,
                                       luxfer_guide_range range);

/**
 * Adds the rendered guides of two scenes: source holds the guides of the exemplar scene, target the guides of the
 * scene to paint. Any thread.
 *
 * The call adds the five guides of light, from LUXFER_GUIDES_FULL to LUXFER_GUIDES_TWO_BOUNCES, at a common exposure:
 * the 90th percentile of luminance over both scenes becomes 0.8. They have the names "full", "direct", "specular",
 * "indirect" and "two bounces", and each has weight 1. For each of the LUXFER_GUIDES_WITH_ flags in extras it adds the
 * guide "caustics", "normals", "edges" or "materials", each with weight extra_weight, in [0, 1e6].
 *
 * If there is no guide of the name "normals", each job examines the artwork. If its strokes follow the shapes, the
 * normals guide the picture too, so that its strokes follow the shapes of the target; see the field normals_weight of
 * luxfer_stylize_report. In a sequence, the first frame decides. To overrule this, add the normals with a weight of
 * your own by LUXFER_GUIDES_WITH_NORMALS or luxfer_stylize_add_guide; with weight 0 they are not used.
 * LUXFER_NOT_READY before the guides of both scenes are rendered; LUXFER_INVALID_ARGUMENT if extras has unknown flags
 * or extra_weight is out of range.
 */
luxfer_status luxfer_stylize_add_guides(luxfer_stylize *stylize,
                                        luxfer_guides *source,
                                        luxfer_guides *target,
                                        uint32_t extras,
                                        float extra_weight);

/** Removes all guides. Any thread. */
luxfer_status luxfer_stylize_clear_guides(luxfer_stylize *stylize);

/**
 * Sets the pixels of the artwork that may be copied: the pixels where mask is above 0.5. mask has 1 channel and the
 * artwork's size; NULL stands for all pixels. Any thread.
 */
luxfer_status luxfer_stylize_set_source_mask(luxfer_stylize *stylize,
                                             luxfer_image *mask);

/**
 * Sets the pixels of the target to paint: the pixels where mask is above 0.5. mask has 1 channel and the size of the
 * guides' targets; if it is NULL, all pixels are painted. known is an image that shows the other pixels, linear, with
 * the artwork's number of channels; the new paint is fitted to them. If known is NULL, the other pixels are black.
 * Any thread.
 */
luxfer_status luxfer_stylize_set_target_mask(luxfer_stylize *stylize,
                                             luxfer_image *mask,
                                             luxfer_image *known);

/**
 * Makes each job start from the previous result, for the frames of an animation. The paint of the previous frame moves
 * with the surfaces and stays where it fits; see luxfer_stylize_params.coherence. The paint is found anew where the
 * light has changed, at silhouettes that have moved, and on places that come into view. Any thread.
 *
 * The image motion has 2 channels and the size of the guides' targets. For each pixel it holds the offset to the
 * position that the pixel's surface point had in the previous frame, x (right) and y (down) in pixels; NaN where the
 * point was not visible. luxfer_guides_get_motion computes it; a pass of motion vectors of another renderer serves
 * too. If motion is NULL, each job starts from nothing. If the motion contradicts the guides, luxfer_get_warnings of
 * stylize has a warning after the job.
 */
luxfer_status luxfer_stylize_set_motion(luxfer_stylize *stylize,
                                        luxfer_image *motion);

/**
 * Starts a job that paints the target. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if artwork or guides are missing or a job is already running; LUXFER_INVALID_ARGUMENT if a
 * setting is out of range; LUXFER_NOT_READY if motion is set and there is no previous result. The job may end with
 * LUXFER_INVALID_ARGUMENT if sizes differ or a side is above 32768 pixels, LUXFER_DEGENERATE if a mask is empty or
 * leaves no exemplar patch.
 */
luxfer_status luxfer_stylize_start(luxfer_stylize *stylize,
                                   const luxfer_stylize_params *params,
                                   luxfer_job **job);

/**
 * Starts a job that updates the picture after the artist has changed the artwork. artwork is the new artwork, with
 * the size and channels of the old one. changed_mask has 1 channel, above 0.5 where the new artwork differs from the
 * old artwork. The pixels of the picture that were painted from these places are painted again, in a fraction of the
 * time of luxfer_stylize_start. Pixels outside the target mask stay as luxfer_stylize_start has left them, even if the
 * artwork changes there. At the border of these pixels, luxfer_stylize_start continues strokes, and lets a step in
 * colour fade out into the new paint; an update only lets the step fade out. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if no job with keep_for_update = 1 has succeeded, or while a job runs. The job may end
 * with LUXFER_INVALID_ARGUMENT if sizes differ. If an update is cancelled, the next update does the remaining work
 * too.
 */
luxfer_status luxfer_stylize_update(luxfer_stylize *stylize,
                                    luxfer_image *artwork,
                                    luxfer_image *changed_mask,
                                    luxfer_job **job);

/**
 * Lets the library paint the rest of a half-painted picture, which is the artwork. painted is a mask with 1 channel
 * and the artwork's size, above 0.5 where the picture is finished. Use guides whose sources show the scene of the
 * picture, and whose targets are NULL. Any thread.
 *
 * The call sets three inputs at once that must fit together: the source mask to this mask, and the target mask to the
 * inverse mask with the artwork as the known picture. The painted pixels stay as they are. The new paint continues
 * strokes across the border of the painted part, and this border is hardly visible. To avoid visible copies, the
 * library hardly ever uses a patch of the artwork more than 100 times as often as the average patch. If the painted
 * part lacks light that the unpainted part shows, the result has the warning LUXFER_WARNING_LIGHT_NOT_PAINTED, with a
 * place where the artist should paint.
 * LUXFER_INVALID_OPERATION before the artwork is set; LUXFER_INVALID_ARGUMENT if painted does not have the artwork's
 * size or has more than 1 channel.
 */
luxfer_status luxfer_stylize_set_painted(luxfer_stylize *stylize,
                                         luxfer_image *painted);

/* ==================================================================================================================
 * Results of a stylisation
 *
 * The picture, the place in the artwork from which each pixel was painted, and the error of the guides.
 * ================================================================================================================== */

/** An image of a stylisation: a LUXFER_STYLIZE_IMAGE_ value. */
typedef int32_t luxfer_stylize_image;

/** Quality of a stylisation. */
typedef struct luxfer_stylize_report {
    /** sizeof(luxfer_stylize_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * 1 if the run is complete; 0 if only some levels are finished: then all fields but levels, halvings and energy
     * are 0.
     */
    uint32_t is_complete;
    /** Number of finished resolution levels. */
    uint32_t levels;
    /** Number of times that the target's sides were halved to get the size of the picture. */
    uint32_t halvings;
    /** Width of the patches, in pixels. */
    uint32_t patch;
    /** Number of uses of the exemplar patch that was used most often. */
    uint32_t max_uses;
    /**
     * Mean squared difference of matched patches after the last round (Fiser et al. 2016, Eq. 3), with channels in [0,
     * 1]. All channels of the artwork together have the weight 1. All guides together have the weight guide_weight;
     * before the finest level is finished, they have guide_weight * coarse_guides.
     */
    double energy;
    /** Share of the exemplar patches that were used, in [0, 1]. */
    double used;
    /** Entropy of the usage of exemplar patches, in bits. */
    double entropy;
    /** Root mean square of LUXFER_STYLIZE_IMAGE_GUIDE_ERROR. */
    double guide_error;
    /** Number of exemplar pixels that were not used because a value is not finite. */
    uint64_t broken_source;
    /** Number of target pixels with a guide value that is not finite and was taken as 0. */
    uint64_t broken_target;
    /**
     * Share of the painted pixels that are unchanged copies of artwork pixels, in [0, 1]; the other painted pixels are
     * blends of several artwork pixels. LUXFER_STYLIZE_VOTE_ADAPTIVE gives rough paint a larger share than smooth
     * paint. luxfer_stylize_update leaves this value as the last full run has set it.
     */
    double unblended_share;
    /**
     * Weight of the normals as a guide, where each guide of light has 1; 0: the normals are not used. Unless the
     * caller has given this weight, it is above 0 only if the strokes of the artwork follow the shapes; see
     * luxfer_stylize_add_guides.
     */
    double normals_weight;
} luxfer_stylize_report;

/**
 * The stylised target, linear, with the artwork's channels. Before the last level, in preview and after a cancel it
 * is smaller than the target: the target's sides are halved luxfer_stylize_report.halvings times, rounded down.
 */
#define LUXFER_STYLIZE_IMAGE_PICTURE 0

/**
 * Weighted root mean square difference, in [0, 1], between the guides at a pixel and the guides at the place in the
 * exemplar from which the pixel was painted; 1 channel. It is high where nothing in the exemplar fits.
 */
#define LUXFER_STYLIZE_IMAGE_GUIDE_ERROR 1

/**
 * Position in the artwork from which each pixel was painted, x and y in pixels of the artwork, (0.5, 0.5) for the
 * top-left pixel; -1 where nothing was painted; 2 channels.
 */
#define LUXFER_STYLIZE_IMAGE_SOURCES 2

/**
 * Gets the image of the result that kind, a LUXFER_STYLIZE_IMAGE_ value, selects, for example the picture.
 * luxfer_stylize_update changes the picture and the sources only; the guide error stays as the last full run has left
 * it. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before the first level of a job is finished; for images other than the picture, before the last
 * level is finished.
 */
luxfer_status luxfer_stylize_get_image(luxfer_stylize *stylize,
                                       luxfer_stylize_image kind,
                                       luxfer_image **image);

/**
 * Gets the current quality of the result. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before the first level of a job is finished.
 */
luxfer_status luxfer_stylize_get_report(luxfer_stylize *stylize,
                                        luxfer_stylize_report *report,
                                        size_t size);

/* ==================================================================================================================
 * Print sheets
 *
 * For artists who paint on paper: draws a sheet to print, which shows the exemplar in pale colours between alignment
 * marks, and aligns a photo or scan of the painted sheet with the exemplar by these marks. The paper may be bent, and
 * the lens may distort. These calls are synchronous: they do their work before they return.
 * ================================================================================================================== */

/**
 * Settings of a print sheet. Fill them with luxfer_sheet_params_init; use equal settings for printing and for
 * aligning.
 */
typedef struct luxfer_sheet_params {
    /** sizeof(luxfer_sheet_params), set by luxfer_sheet_params_init. */
    uint32_t struct_size;
    /**
     * 1, the default: correct uneven lighting of the photo by the brightness of the white in the marks, so that paper
     * gets the value 1; 0: no correction.
     */
    uint32_t even_light;
    /** Width of the paper in millimetres, in [60, 2000]; default 297. */
    double paper_width;
    /** Height of the paper in millimetres, in [60, 2000]; default 210. */
    double paper_height;
    /** Dots per inch of the sheet, in [20, 1200]; default 300. */
    double dpi;
    /** Distance of the marks from the edge of the paper in millimetres, in [0, 50]; default 8. */
    double margin;
    /** Contrast of the printed picture, in [0, 1]; default 0.25; 1 prints the picture unchanged. */
    double contrast;
} luxfer_sheet_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_sheet_params_init(luxfer_sheet_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_SHEET_PARAMS, place, size);
}

/** Quality of the alignment of a photo with its picture. */
typedef struct luxfer_sheet_report {
    /** sizeof(luxfer_sheet_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of marks found, of 10; at least 6 are needed. */
    uint32_t marks;
    /**
     * Root mean square distance, in pixels of the photo, between the marks and dots found and the positions that the
     * model of the sheet predicts for them: paper that is flat or bent in one direction, and a lens with radial
     * distortion. If it is more than about half a pixel, the paper has waves or creases, or is bent in two directions.
     */
    double residual;
    /**
     * Standard deviation of the alignment in pixels of the picture: the root mean square distance, over the picture,
     * between true and found positions is below 1.96 times this value with a probability of about 95 %. It grows with
     * what the model of the sheet does not hold.
     */
    double error;
    /**
     * The homography from pixels of the picture to pixels of the photo that is nearest to the alignment, 3 x 3, row by
     * row. The alignment itself also follows the bent paper and the distortion of the lens.
     */
    double to_photo[9];
    /**
     * Root mean square distance, in pixels of the picture, between the alignment and to_photo: the error that an
     * alignment by a homography would have. It is 0 for flat paper and a lens without distortion.
     */
    double bend;
    /** Number of dots found between the marks. Sheets printed by versions before 0.2 have none. */
    uint32_t dots;
    /** 0. */
    uint32_t reserved;
} luxfer_sheet_report;

/**
 * Draws the sheet to print for a picture (linear, 1 is white; 1, 3 or 4 channels). The sheet shows the picture in
 * pale colours, as large as the paper allows, with ten marks and small dots around it. Save it as PNG and print it at
 * params->dpi without scaling. params may be NULL for the defaults. The caller releases *sheet. Any thread.
 * LUXFER_INVALID_ARGUMENT if a setting is out of range or the paper is too small; LUXFER_OUT_OF_MEMORY beyond the
 * memory budget.
 */
luxfer_status luxfer_sheet_print(luxfer_image *picture,
                                 const luxfer_sheet_params *params,
                                 luxfer_image **sheet);

/**
 * Aligns a photo or scan (linear RGB) of a painted sheet with the picture of width x height pixels for which the
 * sheet was printed. The call finds the marks in the photo and resamples the photo to the pixels of the picture: the
 * result is the artwork, in linear RGB. params must be equal to the settings given to luxfer_sheet_print; NULL stands
 * for the defaults. The photo may be rotated and in perspective, the paper may be bent, and the lens may have radial
 * distortion about the centre of the photo. Sheets without dots, printed by versions before 0.2, are aligned too, less
 * exactly if they are bent. size is sizeof *report; report may be NULL, then size does not matter. The call takes up
 * to a few seconds. The caller releases *artwork. Any thread.
 * LUXFER_DEGENERATE if fewer than six marks are found; LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_sheet_align(luxfer_image *photo,
                                 uint32_t width,
                                 uint32_t height,
                                 const luxfer_sheet_params *params,
                                 luxfer_image **artwork,
                                 luxfer_sheet_report *report,
                                 size_t size);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_STYLIZE_H */
