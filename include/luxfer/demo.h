/* luxfer: generated scenes, photos and artworks.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_DEMO_H
#define LUXFER_DEMO_H

#include "stylize.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Demonstration
 *
 * Scenes and artworks for examples and tests. The library generates them without any files. Repeated calls give
 * results that are equal to the bit.
 * ================================================================================================================== */

/** A scene that the library generates: a LUXFER_DEMO_ value. */
typedef int32_t luxfer_demo;

/** The style of a generated artwork: a LUXFER_ARTWORK_ value. */
typedef int32_t luxfer_artwork;

/** A furnished room without lights; its ceiling is the object "Ceiling". */
#define LUXFER_DEMO_TARGET_ROOM 0

/** An office under a grid of luminaires; luxfer_demo_photo takes its photo with camera 0. */
#define LUXFER_DEMO_EXEMPLAR_ROOM 1

/**
 * A glossy red ball on a white table: the exemplar scene of a stylisation, of which an artist would paint a picture.
 */
#define LUXFER_DEMO_SPHERE_ON_TABLE 2

/**
 * A vase, a ring and two balls, on the table and under the lamp of LUXFER_DEMO_SPHERE_ON_TABLE: a target scene for a
 * stylisation.
 */
#define LUXFER_DEMO_STILL_LIFE 3

/** Pen: hatching in two inks. */
#define LUXFER_ARTWORK_PEN 0

/** Stipple: dots of two inks. */
#define LUXFER_ARTWORK_STIPPLE 1

/** Paint: oil on canvas. */
#define LUXFER_ARTWORK_PAINT 2

/**
 * Generates the scene that a LUXFER_DEMO_ value selects. The caller releases *scene. Any thread.
 * LUXFER_INVALID_ARGUMENT if kind is another value; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_demo_create_scene(luxfer_context *context, luxfer_demo kind, luxfer_scene **scene);

/**
 * Generates a picture of a scene as an artist would paint it. The parameter guides holds the rendered guide images of
 * the scene; the artwork has their size and is aligned with them. The styles are designed for
 * LUXFER_DEMO_SPHERE_ON_TABLE. style is a LUXFER_ARTWORK_ value. The call takes up to a few seconds. The caller
 * releases *image. Any thread.
 * LUXFER_INVALID_ARGUMENT if style is another value; LUXFER_NOT_READY before the guides are rendered.
 */
luxfer_status luxfer_demo_create_artwork(luxfer_guides *guides,
                                         luxfer_artwork style,
                                         luxfer_image **image);

/* ==================================================================================================================
 * Demonstration photo
 *
 * Generates a photo of LUXFER_DEMO_EXEMPLAR_ROOM, as a camera would take it, and strokes on the photo, as a user would
 * paint them. Examples and tests pass both to a lighting transfer, so that they need no files.
 * ================================================================================================================== */

/** A generator of the demonstration photo. See luxfer_demo_photo_create. */
typedef struct luxfer_demo_photo luxfer_demo_photo;

/** Settings of the demonstration photo. Fill them with luxfer_demo_photo_params_init. */
typedef struct luxfer_demo_photo_params {
    /** sizeof(luxfer_demo_photo_params), set by luxfer_demo_photo_params_init. */
    uint32_t struct_size;
    /** Width in pixels, in [16, 8192]; default 600. */
    uint32_t width;
    /** Height in pixels, in [16, 8192]; default 400. The camera is designed for an aspect ratio of 3:2. */
    uint32_t height;
    /** Paths per pixel, in [2, 1048576]; default 12, which leaves visible noise. */
    uint32_t samples;
    /** Seed of the paths and of the sensor noise; default 1. */
    uint64_t seed;
} luxfer_demo_photo_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_demo_photo_params_init(luxfer_demo_photo_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_DEMO_PHOTO_PARAMS, place, size);
}

/** An image of the demonstration photo: a LUXFER_DEMO_PHOTO_ value. */
typedef int32_t luxfer_demo_photo_image;

/** The photo: linear RGB, 1 = display white; lamps are clipped to white. */
#define LUXFER_DEMO_PHOTO_PICTURE 0

/** The strokes on the photo, as a drawing in the colours of luxfer_strokes_add_image. */
#define LUXFER_DEMO_PHOTO_STROKES 1

/** Creates a generator of the demonstration photo. The caller releases *demo. Any thread. */
luxfer_status luxfer_demo_photo_create(luxfer_context *context, luxfer_demo_photo **demo);

/**
 * Starts a job that renders the photo. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if a job is already running; LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_demo_photo_start(luxfer_demo_photo *demo,
                                      const luxfer_demo_photo_params *params,
                                      luxfer_job **job);

/**
 * Gets the image that a LUXFER_DEMO_PHOTO_ value selects: the photo or its strokes. The caller releases *image. Any
 * thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_INVALID_ARGUMENT if kind is another value.
 */
luxfer_status luxfer_demo_photo_get_image(luxfer_demo_photo *demo,
                                          luxfer_demo_photo_image kind,
                                          luxfer_image **image);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_DEMO_H */
