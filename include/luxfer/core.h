/* luxfer: version, status, settings, context, references, images, strokes and jobs.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_CORE_H
#define LUXFER_CORE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Version
 *
 * The macros give the version of this header; the functions give the version of the loaded library. Before 1.0,
 * libraries with equal minor versions are compatible (libluxfer.so.0.2); from 1.0 on, libraries with equal major
 * versions are compatible.
 *
 * A program that loads the library at run time (dlopen, a folder of plug-ins) should check at its start that
 * luxfer_get_version() / 100 == LUXFER_VERSION / 100. From 1.0 on it should check that both versions are equal when
 * divided by 10000 and that the library is not older than the header. luxfer::Context::create of bindings/cpp makes
 * this check.
 * ================================================================================================================== */

/** The version of this header. */
#define LUXFER_VERSION_MAJOR 0
#define LUXFER_VERSION_MINOR 2
#define LUXFER_VERSION_PATCH 0

/** The version of this header as one number, comparable with luxfer_get_version(). */
#define LUXFER_VERSION (10000 * LUXFER_VERSION_MAJOR + 100 * LUXFER_VERSION_MINOR + LUXFER_VERSION_PATCH)

/**
 * Marks a function that will leave the library with a later minor version: compilers warn where a program calls it, and
 * say what to call instead. Without such warnings, define LUXFER_NO_DEPRECATED before the first include.
 */
#if defined(LUXFER_NO_DEPRECATED)
#  define LUXFER_DEPRECATED(advice)
#elif defined(__GNUC__) || defined(__clang__)
#  define LUXFER_DEPRECATED(advice) __attribute__((deprecated(advice)))
#elif defined(_MSC_VER)
#  define LUXFER_DEPRECATED(advice) __declspec(deprecated(advice))
#else
#  define LUXFER_DEPRECATED(advice)
#endif

/** Returns the version of the loaded library as one number, comparable with LUXFER_VERSION. Any thread. */
uint32_t luxfer_get_version(void);

/**
 * Returns the version of the loaded library as text, such as "0.2.0". The string is static: never free it. Any
 * thread.
 */
const char *luxfer_get_version_string(void);

/* ==================================================================================================================
 * Status
 *
 * Every function that can fail returns a luxfer_status. Values are never changed or reused; new values may be added.
 * A function writes its outputs only if it returns LUXFER_OK. luxfer_context_get_last_error describes a failure in
 * words. The comment of a function lists its errors. Some errors hold for every function, even if its comment does not
 * name them: LUXFER_INVALID_ARGUMENT for a NULL pointer unless the comment allows NULL, and for an argument whose type
 * has constants and whose value is not one of them; LUXFER_OUT_OF_MEMORY if the memory budget of the context, or the
 * machine, is used up.
 * ================================================================================================================== */

/** The result of a call: LUXFER_OK, or the reason for the failure. */
typedef int32_t luxfer_status;

/** Success. */
#define LUXFER_OK 0

/** An error that has no status value of its own. */
#define LUXFER_UNKNOWN 1

/** A parameter is NULL, out of range, of the wrong kind or from another context, or contradicts another parameter. */
#define LUXFER_INVALID_ARGUMENT 2

/** The call is not allowed in the object's present state: a job is still running on it, or an input is missing. */
#define LUXFER_INVALID_OPERATION 3

/** The memory budget of the context, or the machine, is used up. */
#define LUXFER_OUT_OF_MEMORY 4

/** The file or the request is valid, but uses a feature that this library does not support. */
#define LUXFER_UNSUPPORTED 5

/** The job was cancelled by the caller. */
#define LUXFER_CANCELLED 6

/** The operating system could not read or write a file, or the caller's write function returned an error. */
#define LUXFER_IO 7

/** A file is truncated or corrupt, or does not have the format that it claims. */
#define LUXFER_FORMAT 8

/** A result was requested before its job has succeeded, or a wait timed out. */
#define LUXFER_NOT_READY 9

/** A bug in this library: please report it. */
#define LUXFER_INTERNAL 10

/**
 * The input is well formed but has no answer: for example a photo without lines, a plane seen edge-on, or strokes of
 * one class only.
 */
#define LUXFER_DEGENERATE 11

/** No surface, image or entry has the given name or index. */
#define LUXFER_NOT_FOUND 12

/** No solution exists: no emitted light reaches the target, or the other lights alone exceed the wanted value. */
#define LUXFER_UNREACHABLE 13

/**
 * Returns the name of a status, such as "LUXFER_FORMAT"; "LUXFER_UNKNOWN" for a number that is not a status. The
 * string is static: never free it. Any thread.
 */
const char *luxfer_status_get_name(luxfer_status status);

/* ==================================================================================================================
 * Settings
 *
 * Every struct of settings starts with its size, and luxfer_init fills it with the defaults. C and C++ programs call
 * the inline function that follows each struct, such as luxfer_render_params_init(&params, sizeof params), whose
 * argument the compiler checks; programs in other languages call luxfer_init.
 * ================================================================================================================== */

/** The type of a struct of settings: a LUXFER_STRUCT_ value. */
typedef int32_t luxfer_struct_type;

/** The luxfer_context_params. */
#define LUXFER_STRUCT_CONTEXT_PARAMS 0

/** The luxfer_image_view. */
#define LUXFER_STRUCT_IMAGE_VIEW 1

/** The luxfer_scene_load_params. */
#define LUXFER_STRUCT_SCENE_LOAD_PARAMS 2

/** The luxfer_material_params. */
#define LUXFER_STRUCT_MATERIAL_PARAMS 3

/** The luxfer_mesh_params. */
#define LUXFER_STRUCT_MESH_PARAMS 4

/** The luxfer_camera_params. */
#define LUXFER_STRUCT_CAMERA_PARAMS 5

/** The luxfer_light_params. */
#define LUXFER_STRUCT_LIGHT_PARAMS 6

/** The luxfer_luminaire_params. */
#define LUXFER_STRUCT_LUMINAIRE_PARAMS 7

/** The luxfer_render_params. */
#define LUXFER_STRUCT_RENDER_PARAMS 8

/** The luxfer_rectify_params. */
#define LUXFER_STRUCT_RECTIFY_PARAMS 9

/** The luxfer_features_params. */
#define LUXFER_STRUCT_FEATURES_PARAMS 10

/** The luxfer_segment_params. */
#define LUXFER_STRUCT_SEGMENT_PARAMS 11

/** The luxfer_emission_params. */
#define LUXFER_STRUCT_EMISSION_PARAMS 12

/** The luxfer_relight_params. */
#define LUXFER_STRUCT_RELIGHT_PARAMS 13

/** The luxfer_pattern_params. */
#define LUXFER_STRUCT_PATTERN_PARAMS 14

/** The luxfer_transfer_params. */
#define LUXFER_STRUCT_TRANSFER_PARAMS 15

/** The luxfer_illuminance_params. */
#define LUXFER_STRUCT_ILLUMINANCE_PARAMS 16

/** The luxfer_illuminance_grid. */
#define LUXFER_STRUCT_ILLUMINANCE_GRID 17

/** The luxfer_lamps_params. */
#define LUXFER_STRUCT_LAMPS_PARAMS 18

/** The luxfer_importance_params. */
#define LUXFER_STRUCT_IMPORTANCE_PARAMS 19

/** The luxfer_placement_params. */
#define LUXFER_STRUCT_PLACEMENT_PARAMS 20

/** The luxfer_false_colour_params. */
#define LUXFER_STRUCT_FALSE_COLOUR_PARAMS 21

/** The luxfer_guides_params. */
#define LUXFER_STRUCT_GUIDES_PARAMS 22

/** The luxfer_stylize_params. */
#define LUXFER_STRUCT_STYLIZE_PARAMS 23

/** The luxfer_sheet_params. */
#define LUXFER_STRUCT_SHEET_PARAMS 24

/** The luxfer_plan_params. */
#define LUXFER_STRUCT_PLAN_PARAMS 25

/** The luxfer_render_part. */
#define LUXFER_STRUCT_RENDER_PART 26

/** The luxfer_demo_photo_params. */
#define LUXFER_STRUCT_DEMO_PHOTO_PARAMS 27

/** The luxfer_pendants_params. */
#define LUXFER_STRUCT_PENDANTS_PARAMS 28

/** The luxfer_merge_params. */
#define LUXFER_STRUCT_MERGE_PARAMS 29

/** The luxfer_gonio_params. */
#define LUXFER_STRUCT_GONIO_PARAMS 30

/** The luxfer_glare_params. */
#define LUXFER_STRUCT_GLARE_PARAMS 31

/** The luxfer_sun_params. */
#define LUXFER_STRUCT_SUN_PARAMS 32

/** The luxfer_sky_params. */
#define LUXFER_STRUCT_SKY_PARAMS 33

/**
 * Fills the struct at place with the defaults of struct_type, a LUXFER_STRUCT_ value. The argument size is sizeof the
 * struct. If the program was built with an older header, in which the struct is smaller, only the fields of that
 * version are filled. Any thread.
 * LUXFER_INVALID_ARGUMENT if struct_type is another value, if place is NULL, or if no version of the struct has this
 * size; LUXFER_UNSUPPORTED for luxfer_stylize_params in a library without stylisation.
 */
luxfer_status luxfer_init(luxfer_struct_type struct_type,
                          void *place,
                          size_t size);

/* ==================================================================================================================
 * Context
 *
 * A context owns the worker threads, a memory budget and the error messages. All other objects are created in a
 * context and keep it alive, so objects may be released in any order. Objects of two contexts cannot be mixed
 * (LUXFER_INVALID_ARGUMENT).
 *
 * Structs: a function that fills a struct of the caller takes sizeof the struct as an argument, and stores it in the
 * first field, struct_size. Leave this field unchanged. It tells the library with which version of the header the
 * program was built. A program that was built with an older header therefore works with a newer library: settings that
 * its header lacks keep their defaults.
 *
 * Handles: each call checks its handles. NULL and a handle of another kind give LUXFER_INVALID_ARGUMENT. So does a
 * released handle, as long as its memory has not been reused; afterwards, the library cannot detect the mistake.
 *
 * Threads: "Any thread" in a comment means that any thread may call the function, at any time. Different threads may
 * use different objects at the same time, and also the same object: calls that change an object wait for each other.
 * Only the release of the last reference must not overlap with another use of the object.
 *
 * The library prints nothing, not even the message of a defect (LUXFER_INTERNAL). It reads no environment variables,
 * does not end the process on an error and installs no signal handlers. All state belongs to a context, except for
 * three things that exist once per process: tables of constants, a hook that suppresses the messages of panics inside
 * the library, and an emergency reserve of memory. The library uses the reserve for small allocations when the system
 * has no memory left; all running jobs of the process then end with LUXFER_OUT_OF_MEMORY.
 *
 * Fork: a child process does not have the threads of its parent. In the child, each call on an object that was created
 * before the fork returns LUXFER_INVALID_OPERATION at once, luxfer_context_get_last_error gives the reason, and
 * luxfer_release returns LUXFER_OK and frees nothing. A child may create contexts of its own.
 *
 * Stack: a thread of the host needs 128 KiB of stack for calls that load files or do other work before they return.
 *
 * Reproducibility: on one machine, equal inputs, parameters and seeds give results that are equal to the bit, for any
 * number of threads and any floating-point mode (rounding, flush to zero) of the host. A call sets the standard mode
 * on entry and restores the mode of the host on return. Callbacks run in the standard mode.
 * ================================================================================================================== */

/** A context: threads, memory budget and error messages. See luxfer_context_create. */
typedef struct luxfer_context luxfer_context;

/** Settings of a context. Fill them with luxfer_context_params_init. */
typedef struct luxfer_context_params {
    /** sizeof(luxfer_context_params), set by luxfer_context_params_init. */
    uint32_t struct_size;
    /**
     * Number of worker threads, in [0, 1024]; 0, the default: one for each core that the process may use. All jobs
     * share these threads. Synchronous calls, which do their work before they return, do not use them, and so never
     * wait for a job. A synchronous call runs on the calling thread, or on a set of num_threads other threads, which
     * it shares with no other call. The context keeps up to four idle sets for later calls.
     */
    uint32_t num_threads;
    /**
     * Limit in MiB on the memory of all pixels, meshes and textures that the caller creates in this context; 0, the
     * default: no limit. A call that would exceed the limit returns LUXFER_OUT_OF_MEMORY. While a picture file is
     * read, the memory of its decoder counts too. The working memory and the results of jobs do not count.
     */
    uint64_t memory_budget_mib;
} luxfer_context_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_context_params_init(luxfer_context_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_CONTEXT_PARAMS, place, size);
}

/**
 * Creates a context and its threads; params may be NULL for the defaults. The caller releases *context. Any thread.
 * LUXFER_INVALID_ARGUMENT if context is NULL, struct_size is wrong or num_threads exceeds 1024; LUXFER_OUT_OF_MEMORY
 * if the threads cannot be started.
 */
luxfer_status luxfer_context_create(const luxfer_context_params *params,
                                    luxfer_context **context);

/**
 * Gets the message of the calling thread's latest failed call in this context: copies it into buffer as
 * zero-terminated UTF-8, truncated to capacity bytes including the zero. *needed, unless NULL, receives the capacity
 * that the whole message needs. buffer may be NULL if capacity is 0. Any thread.
 *
 * If no call of this thread has failed, the message is empty. A message stays until the thread's next failure; the
 * context keeps the messages of the 256 threads that failed last. A call that fails because its first handle is not
 * valid leaves no message.
 */
luxfer_status luxfer_context_get_last_error(luxfer_context *context,
                                            char *buffer,
                                            size_t capacity,
                                            size_t *needed);

/* ==================================================================================================================
 * References
 *
 * Handles of every kind are reference counted: a create function returns one reference, luxfer_retain adds one,
 * luxfer_release removes one, and removing the last reference frees the object. Objects may be released in any order.
 * An object that is given an image, a scene or another object as an input holds a reference of its own, so the caller
 * may release the input at once.
 * ================================================================================================================== */

/**
 * Adds a reference to an object of any kind. Any thread.
 * LUXFER_INVALID_ARGUMENT if handle is NULL or not a live object; the failure leaves no message.
 */
luxfer_status luxfer_retain(void *handle);

/**
 * Removes a reference to an object of any kind; NULL does nothing. Any thread.
 *
 * An object may outlive the caller's references to it: a context lives until its last object is freed, and a stage
 * with a running job lives until the job has ended. Two kinds of release take time. Releasing the last reference to a
 * job cancels the job and waits until it has ended. The release that frees a context waits until the context's worker
 * threads have ended.
 * LUXFER_INVALID_ARGUMENT if handle is not a live object; the failure leaves no message.
 */
luxfer_status luxfer_release(void *handle);

/* ==================================================================================================================
 * Image
 *
 * An image holds 32-bit floating-point samples: scene-linear Rec.709 colour (D65 white), or data. It has up to 64
 * channels; width and height are at most 65536 pixels. Rows run from top to bottom. Points of an image are in pixels,
 * x to the right and y down; the centre of the top-left pixel is (0.5, 0.5). An image never changes after its
 * creation, so results are shared and not copied. A view describes pixels in the caller's memory; the library never
 * keeps a pointer to them.
 * ================================================================================================================== */

/** Flag of a view: the first row in memory is the bottom row of the image. */
#define LUXFER_VIEW_BOTTOM_UP 1

/** An image in the library's memory. See luxfer_image_create. */
typedef struct luxfer_image luxfer_image;

/** Storage type of a sample, in the machine's byte order: a LUXFER_SAMPLE_ value. */
typedef int32_t luxfer_sample;

/** Encoding of the values: a LUXFER_COLOUR_ value. */
typedef int32_t luxfer_colour_space;

/**
 * An image in the caller's memory. Fill it with luxfer_image_view_init, then set width, height, sample, byte_size and
 * data.
 */
typedef struct luxfer_image_view {
    /** sizeof(luxfer_image_view), set by luxfer_image_view_init. */
    uint32_t struct_size;
    /** Samples per pixel in [1, 4]; default 3. */
    uint32_t channels;
    /** Storage type of the samples: a LUXFER_SAMPLE_ value; default LUXFER_SAMPLE_F32. */
    luxfer_sample sample;
    /** Encoding of the samples: a LUXFER_COLOUR_ value; default LUXFER_COLOUR_LINEAR. */
    luxfer_colour_space colour_space;
    /** Width in pixels, in [1, 65536]; default 0: the caller must set it. */
    uint32_t width;
    /** Height in pixels, in [1, 65536]; default 0: the caller must set it. */
    uint32_t height;
    /** LUXFER_VIEW_ flags, or 0, the default. Unknown flags give LUXFER_INVALID_ARGUMENT. */
    uint32_t flags;
    /** Must be 0. */
    uint32_t reserved;
    /** Bytes from one pixel to the next, at least the size of a pixel; 0, the default: pixels are packed. */
    size_t pixel_stride;
    /** Bytes from one row to the next, at least the size of a row; 0, the default: rows are packed. */
    size_t row_stride;
    /**
     * Size of the memory at data in bytes; default 0: the caller must set it. LUXFER_INVALID_ARGUMENT if the pixels
     * and the strides need more.
     */
    size_t byte_size;
    /**
     * The pixels, at any alignment; default NULL: the caller must set it. The library neither reads nor writes the
     * bytes between pixels or rows.
     */
    void *data;
} luxfer_image_view;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_image_view_init(luxfer_image_view *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_IMAGE_VIEW, place, size);
}

/** 8-bit unsigned integer that stands for [0, 1]. */
#define LUXFER_SAMPLE_U8 0

/** 16-bit unsigned integer that stands for [0, 1]. */
#define LUXFER_SAMPLE_U16 1

/** 16-bit floating point (IEEE 754 half). */
#define LUXFER_SAMPLE_F16 2

/** 32-bit floating point. */
#define LUXFER_SAMPLE_F32 3

/** Scene-linear Rec.709, or data that is not colour. */
#define LUXFER_COLOUR_LINEAR 0

/** Colour with the sRGB curve; alpha, the second of two or the fourth of four channels, is linear. */
#define LUXFER_COLOUR_SRGB 1

/**
 * Creates an image from a copy of the caller's pixels. Integers are mapped to [0, 1], and sRGB is decoded to linear
 * values; NaN and infinities are kept. The caller releases *image. Any thread.
 * LUXFER_INVALID_ARGUMENT if the view is inconsistent; LUXFER_OUT_OF_MEMORY beyond the context's memory budget.
 */
luxfer_status luxfer_image_create(luxfer_context *context,
                                  const luxfer_image_view *view,
                                  luxfer_image **image);

/**
 * Loads an image file and turns the picture upright by its EXIF orientation; path is UTF-8. The caller releases
 * *image. Any thread.
 *
 * The formats are JPEG, PNG, WebP, TIFF, BMP, GIF (its first frame), Radiance HDR and OpenEXR (its display window).
 * Grey with alpha becomes RGBA; palettes and CMYK become RGB. Colours are not premultiplied by alpha, except in
 * OpenEXR files, whose samples stay as stored.
 *
 * Load pictures with LUXFER_COLOUR_SRGB. Their colours are converted to linear Rec.709 from the colour space that the
 * file states (ICC profile; cICP, sRGB, gAMA and cHRM of PNG; EXIF; chromaticities of OpenEXR; PRIMARIES, EXPOSURE and
 * COLORCORR of Radiance). If the file states no colour space, integer samples are taken as sRGB and floating-point
 * samples as linear. luxfer_photo_metadata.colour tells which of these cases applied.
 *
 * Load data such as masks and depth with LUXFER_COLOUR_LINEAR. Their samples are not converted.
 * LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is damaged or of no known format; LUXFER_OUT_OF_MEMORY
 * beyond the memory budget.
 * LUXFER_UNSUPPORTED if the picture is larger than 2^28 pixels or 65536 on a side, or if the library recognises the
 * format but does not read it. The message then names the format, such as AVIF, HEIC, JPEG XL, raw data of cameras,
 * TIFF with JPEG compression, deep or luminance-chroma OpenEXR, or an OpenEXR layer with neither R, G, B nor a single
 * channel.
 */
luxfer_status luxfer_image_load(luxfer_context *context,
                                const char *path,
                                luxfer_colour_space colour_space,
                                luxfer_image **image);

/**
 * Loads an image from a file in memory of size bytes at data. Formats, colours, ownership, threads and errors are as
 * for luxfer_image_load.
 */
luxfer_status luxfer_image_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       luxfer_colour_space colour_space,
                                       luxfer_image **image);

/**
 * Saves an image to a file; path is UTF-8, and its extension chooses the format. Any thread.
 * - .png: 1, 3 or 4 channels. The colours are multiplied by exposure (> 0, finite; 1 shows the value 1 as white),
 *   clamped to [0, 1] and encoded as 8-bit sRGB, which the file states. The fourth channel is alpha; it is only
 *   clamped.
 * - .exr: up to 64 channels, unchanged, in 32-bit floating point, with the chromaticities of Rec.709. exposure is not
 *   used.
 *
 * All functions of this library write files as follows. An existing file is replaced only once the new one is
 * complete, and keeps its mode and owner. Symbolic links are followed. Devices, FIFOs, files with several hard links,
 * and files in folders that accept no new files are written in place.
 * LUXFER_INVALID_ARGUMENT if the file has another extension, the number of channels is not allowed, or exposure is out
 * of range for a .png; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_image_save(luxfer_image *image,
                                const char *path,
                                float exposure);

/**
 * Gets the width and height of an image in pixels and its number of channels; any of the three pointers may be NULL.
 * Any thread.
 */
luxfer_status luxfer_image_get_size(luxfer_image *image,
                                    uint32_t *width,
                                    uint32_t *height,
                                    uint32_t *channels);

/**
 * Copies an image into the caller's pixels. The view must have the image's width and height. It receives
 * view->channels channels of the image, starting at first_channel, counted from 0; with LUXFER_COLOUR_SRGB, the
 * library encodes them with the sRGB curve. For integer samples, values are clamped to [0, 1] and rounded, and NaN
 * becomes 0. Any thread.
 * LUXFER_INVALID_ARGUMENT if the view is inconsistent or does not fit the image.
 */
luxfer_status luxfer_image_read(luxfer_image *image,
                                uint32_t first_channel,
                                const luxfer_image_view *view);

/* ==================================================================================================================
 * Photo metadata
 *
 * The camera settings that the file of a loaded photo records in its EXIF tags (JPEG, PNG, WebP, TIFF), and how its
 * colours were interpreted. luxfer_image_load applies the orientation. luxfer_rectify and luxfer_transfer use the
 * focal length as a prior, unless the caller sets a focal length; the lines of the photo outweigh the prior where
 * they determine the focal length better. The library does not use white_luminance by itself: to apply it, copy it to
 * luxfer_transfer_params.white_luminance.
 * ================================================================================================================== */

/**
 * How the colours of an image were interpreted: a LUXFER_FILE_COLOUR_ value. Values are never changed or reused; new
 * values may be added.
 */
typedef int32_t luxfer_file_colour;

/** Metadata of the file of a loaded photo. */
typedef struct luxfer_photo_metadata {
    /** sizeof(luxfer_photo_metadata), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * EXIF orientation of the stored photo, in [1, 8]; 1 = upright or not recorded. Loading has already applied it: 2
     * mirrors left to right, 3 rotates by 180 degrees, 4 mirrors top to bottom, 6 rotates clockwise by 90 degrees, 8
     * counter-clockwise, 5 mirrors about the diagonal from top left to bottom right, 7 about the other diagonal.
     */
    uint32_t orientation;
    /**
     * Focal length in pixels of the loaded photo; 0 if it is unknown, or if the aspect ratio shows that the photo was
     * cropped.
     */
    double focal;
    /** Standard deviation of the field focal, in pixels; 0 = unknown. */
    double focal_error;
    /** F-number N of the aperture; 0 = unknown. */
    double f_number;
    /** Exposure time t in seconds; 0 = unknown. */
    double exposure_time;
    /** ISO speed S; 0 = unknown. */
    double iso;
    /**
     * Scene luminance in cd/m² that the camera recorded as white (value 1): 78 N² / (0.65 t S), from the definition of
     * the saturation-based speed in ISO 12232. N, t and S are the three fields above. 0 = unknown. Valid only for the
     * image that the camera wrote: an editor that changes the brightness keeps the tags, so the value is then wrong.
     */
    double white_luminance;
    /**
     * Lower bound of white_luminance: 0.71 times white_luminance. This is the value for a camera whose ISO speed is a
     * standard output sensitivity (ISO 12232) instead of a saturation-based speed.
     */
    double white_luminance_low;
    /**
     * Upper bound of white_luminance: twice white_luminance. It allows for an ISO speed that is a recommended exposure
     * index (ISO 12232), with which the manufacturer chooses the luminance at which the camera clips.
     */
    double white_luminance_high;
    /** How the colours of the file were interpreted: a LUXFER_FILE_COLOUR_ value. */
    luxfer_file_colour colour;
    /** Reserved; always 0. */
    uint32_t reserved;
} luxfer_photo_metadata;

/** The image was not loaded from a file. */
#define LUXFER_FILE_COLOUR_NONE 0

/**
 * The file states no colour space. Integers were decoded as sRGB, and floating-point samples taken as linear Rec.709.
 */
#define LUXFER_FILE_COLOUR_ASSUMED 1

/** The file states sRGB (integers) or linear Rec.709 (floating point). */
#define LUXFER_FILE_COLOUR_STATED 2

/** The file states another colour space. The colours were converted to linear Rec.709. */
#define LUXFER_FILE_COLOUR_CONVERTED 3

/**
 * The library cannot convert the colours of the file, for example because its profile is damaged, or because it is in
 * CMYK without a profile. The colours were read as if the file stated no colour space, so saturated colours may be
 * wrong. Warn the user, and ask for an export of the photo as sRGB.
 */
#define LUXFER_FILE_COLOUR_UNCONVERTED 4

/** The image was loaded with LUXFER_COLOUR_LINEAR. Its samples are unchanged. */
#define LUXFER_FILE_COLOUR_DATA 5

/**
 * Gets the metadata of the file that an image was loaded from. All values are unknown if the image was not loaded
 * from a file, or if the file has no metadata. size is sizeof *metadata. Any thread.
 */
luxfer_status luxfer_image_get_metadata(luxfer_image *image,
                                        luxfer_photo_metadata *metadata,
                                        size_t size);

/* ==================================================================================================================
 * Exposures of one view
 *
 * Merges a bracket: photos of one view with different exposures. Photos of lit rooms clip at the lamps, so the colours
 * and luminances of the lamps are lost; the merged image takes them from the shorter exposures. Use the merged image
 * as the photo of a transfer.
 *
 * One of the photos is the reference. The merged image has its frame, its scale (the value 1 is its white) and its
 * metadata, so that luxfer_photo_metadata.white_luminance holds for the merged image too. Values above 1 are light
 * that the reference clips.
 *
 * Developed raw files and photos with the sRGB curve are linear once they are loaded. Where a camera applied another
 * tone curve, the ratio of two exposures depends on the brightness, and lamps would become too bright or too dark. If
 * the exposures are known, the library recovers this curve from the photos and undoes it; the report states the curve
 * and its error. If the exposures are unknown, the photos must be linear: they determine a curve only up to an
 * exponent.
 * ================================================================================================================== */

/** Where the exposures of photos come from: a LUXFER_EXPOSURE_SOURCE_ value. */
typedef int32_t luxfer_exposure_source;

/** The tone curve with which photos were taken: a LUXFER_TONE_CURVE_ value. */
typedef int32_t luxfer_tone_curve;

/** Settings for merging exposures. Fill them with luxfer_merge_params_init. */
typedef struct luxfer_merge_params {
    /** sizeof(luxfer_merge_params), set by luxfer_merge_params_init. */
    uint32_t struct_size;
    /**
     * Where the exposures come from, unless the field exposures states them: a LUXFER_EXPOSURE_SOURCE_ value; default
     * LUXFER_EXPOSURE_SOURCE_BOTH.
     */
    luxfer_exposure_source source;
    /** Index of the reference; -1, the default: the photo with the most pixels that are well exposed. */
    int32_t reference;
    /**
     * Treatment of pixels at which the exposures differ by more than noise explains, because something moved. 0, the
     * default: a pixel is averaged only over the exposures that agree with the reference or, where the reference is
     * clipped, with the next shorter exposure that is not clipped. 1: all exposures are averaged.
     */
    uint32_t keep_moving;
    /**
     * Largest shift between photos that are neighbours in exposure, as a part of the longer side of a photo, in [0,
     * 0.25]; default 0.03. 0: the photos are not aligned, as for a camera on a tripod.
     */
    double max_shift;
    /**
     * Value in [0.1, 1] from which on a channel counts as clipped; default 0.95. A photo with any value above 2 counts
     * as a photo of high dynamic range, in which no pixel is clipped.
     */
    double saturation;
    /**
     * Exposure of each photo in any unit, such as seconds, in [1e-9, 1e9]; all 0, the default: see the field source.
     * Elements beyond the number of photos must be 0.
     */
    double exposures[16];
    /** Tone curve of the photos: a LUXFER_TONE_CURVE_ value; default LUXFER_TONE_CURVE_RECOVERED. */
    luxfer_tone_curve tone_curve;
    /** Reserved; always 0. */
    uint32_t reserved;
} luxfer_merge_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_merge_params_init(luxfer_merge_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_MERGE_PARAMS, place, size);
}

/**
 * The exposures and shifts that luxfer_image_merge_exposures found. Arrays have an element for each photo, in the
 * order of the photos; further elements are 0.
 */
typedef struct luxfer_merge_report {
    /** sizeof(luxfer_merge_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of photos. */
    uint32_t count;
    /** Index of the reference. */
    uint32_t reference;
    /** Reserved; always 0. */
    uint32_t reserved;
    /**
     * Part of the pixels that are clipped in every photo that shows them, in [0, 1]. Their values come from the
     * shortest exposure and are lower bounds.
     */
    double clipped;
    /**
     * Part of the pixels at which neighbouring exposures differ by more than noise explains, in [0, 1]; 0 if
     * keep_moving is 1.
     */
    double moved;
    /**
     * Exposure of each photo divided by the exposure of the reference: a ratio of amounts of light, not of stops;
     * above 1 for a photo with more light, 1 for the reference.
     */
    double exposures[16];
    /** Relative standard error of each exposure; 0 for exposures that luxfer_merge_params.exposures states. */
    double errors[16];
    /** Exposure of each photo divided by the exposure of the reference, as the metadata state it; 0 = unknown. */
    double stated[16];
    /**
     * Column of each photo that shows the part of the view that column 0 of the reference shows; below 0 if the photo
     * does not show that part.
     */
    int32_t shift_x[16];
    /**
     * Row of each photo that shows the part of the view that row 0 of the reference shows; below 0 if the photo does
     * not show that part.
     */
    int32_t shift_y[16];
    /**
     * The tone curve that the photos were taken to have: LUXFER_TONE_CURVE_RECOVERED if another curve than that of
     * sRGB was recovered and undone, else LUXFER_TONE_CURVE_SRGB.
     */
    luxfer_tone_curve tone_curve;
    /**
     * 1 if the photos contradict the tone curve of sRGB and no other curve was recovered, because the exposures are
     * unknown, the levels of the photos determine no curve, or the settings say so: the light of the merged image is
     * then wrong by more than noise, and you should state the exposures. 0 otherwise.
     */
    uint32_t contradicts_srgb;
    /**
     * Largest error of the recovered curve, as a share of the light, over the codes that two photos show: of the light
     * at a code, relative to the light at the brightest of these codes. For brighter codes, which one photo shows at
     * most, the curve of sRGB is assumed. 0 without a recovered curve.
     */
    double tone_curve_error;
    /**
     * Light at the codes 0, 1/16, ... 1 of the photos' files, relative to white: of the recovered curve, or else of
     * sRGB.
     */
    double tone_curve_light[17];
} luxfer_merge_report;

/**
 * From the metadata and the pixels, weighted by their errors; where one of the two sources is missing, from the other
 * source alone. If the two contradict each other by more than a third of a stop, luxfer_image_merge_exposures returns
 * LUXFER_INVALID_ARGUMENT.
 */
#define LUXFER_EXPOSURE_SOURCE_BOTH 0

/** From the exposure time, ISO speed and f-number in the files. */
#define LUXFER_EXPOSURE_SOURCE_METADATA 1

/** From pixels that two neighbouring exposures both show well. */
#define LUXFER_EXPOSURE_SOURCE_PIXELS 2

/**
 * That of sRGB, unless the exposures are known and the photos agree significantly better with another curve, which is
 * then undone. Exposures are known from the field exposures, or from the metadata.
 */
#define LUXFER_TONE_CURVE_RECOVERED 0

/** That of sRGB: the photos are linear as they are. */
#define LUXFER_TONE_CURVE_SRGB 1

/**
 * Merges count photos of one view, in [1, 16], in any order, into one image. The photos have one size and one number
 * of channels (1, 3 or 4; the result has the alpha of the reference). They may be shifted by whole pixels, as handheld
 * photos are. Where a photo is rotated against the reference, or something moves, fewer exposures are used. params may
 * be NULL for the defaults. size is sizeof *report; report may be NULL, then size does not matter. The call is
 * synchronous. The caller releases *image. Any thread.
 *
 * The estimate of a pixel is the sum of its values divided by the sum of their exposures, which has the least noise
 * that photons allow. The weight of a value falls from 1 at 80 % of the clipping value to 0 at the clipping value. A
 * single photo is returned as it is.
 * LUXFER_INVALID_ARGUMENT if a setting or a photo is not as stated, if samples are NaN or infinite, or if metadata and
 * pixels contradict each other (the message states both); LUXFER_DEGENERATE if exposures are unknown and cannot be
 * measured, because too few pixels are well exposed in two neighbours; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_image_merge_exposures(luxfer_context *context,
                                           luxfer_image *const *photos,
                                           size_t count,
                                           const luxfer_merge_params *params,
                                           luxfer_image **image,
                                           luxfer_merge_report *report,
                                           size_t size);

/* ==================================================================================================================
 * Depth map
 *
 * A depth map of a photo is an image of the photo's size with 1 channel, in any unit of length. Pixels whose value is
 * not positive and finite are holes, which are filled from their surroundings. luxfer_transfer_set_depth and
 * luxfer_features_set_depth take a depth map.
 * ================================================================================================================== */

/** Quantity that a depth map measures: a LUXFER_DEPTH_ value. */
typedef int32_t luxfer_depth_kind;

/** Distance from the camera along the viewing axis (depth z). */
#define LUXFER_DEPTH_ALONG_Z 0

/** Distance from the camera along the ray of each pixel. */
#define LUXFER_DEPTH_ALONG_RAY 1

/* ==================================================================================================================
 * Strokes
 *
 * Strokes that a user paints on a photo to show where the plane and the lights are. Add strokes point by point, as a
 * drawing or as a text, then hand them to a stage: luxfer_transfer_set_strokes, luxfer_segment_set_strokes or
 * luxfer_features_set_strokes. A stage copies the strokes; if you add strokes later, hand them to the stage again.
 * ================================================================================================================== */

/** A set of strokes for images of one size. See luxfer_strokes_create. */
typedef struct luxfer_strokes luxfer_strokes;

/** The mask for which strokes are painted: a LUXFER_PHASE_ value. */
typedef int32_t luxfer_phase;

/**
 * The mask of the plane that carries the lights: positive strokes lie on the plane; strokes on lights count as
 * positive strokes too.
 */
#define LUXFER_PHASE_PLANE 0

/** The mask of the lights on the plane: positive strokes lie on lights, negative strokes on the plane beside them. */
#define LUXFER_PHASE_LIGHTS 1

/**
 * Creates an empty set of strokes for a photo, or for features, of width x height pixels. The caller releases
 * *strokes. Any thread.
 * LUXFER_INVALID_ARGUMENT if width or height is not in [1, 65536].
 */
luxfer_status luxfer_strokes_create(luxfer_context *context,
                                    uint32_t width,
                                    uint32_t height,
                                    luxfer_strokes **strokes);

/**
 * Adds a stroke along a polyline; one point makes a dot. phase is a LUXFER_PHASE_ value. The parameter positive is 1
 * for a stroke on the plane or on lights, 0 for a stroke beside them. The array points holds point_count pairs of
 * floats, x and y in pixels; the centre of the top-left pixel is (0.5, 0.5). radius is in pixels, in [0.001, 4096]. A
 * pixel that several strokes cover belongs to the last of these strokes. Any thread.
 * LUXFER_INVALID_ARGUMENT if there is no point, a coordinate is not finite, or radius or positive is out of range.
 */
luxfer_status luxfer_strokes_add(luxfer_strokes *strokes,
                                 luxfer_phase phase,
                                 const float *points,
                                 size_t point_count,
                                 float radius,
                                 int32_t positive);

/**
 * Adds the strokes of a drawing, an image of the size given to luxfer_strokes_create. Green (0, 255, 0) is plane, red
 * (255, 0, 0) not plane, yellow (255, 255, 0) light, blue (0, 0, 255) not light; other colours and pixels with an
 * alpha below 0.5 are ignored. Each sRGB channel of a pixel may differ from the colour by 30 % of its range. Connected
 * regions of one colour with fewer than 4 pixels are ignored. Load drawings with LUXFER_COLOUR_SRGB. Any thread.
 * LUXFER_INVALID_ARGUMENT if the size differs or the drawing has fewer than 3 channels.
 */
luxfer_status luxfer_strokes_add_image(luxfer_strokes *strokes,
                                       luxfer_image *drawing);

/**
 * Adds the strokes of a text in UTF-8. Each line has a class, a radius in pixels, and x and y of the points in
 * pixels, such as "light 3 310.5 30 320 31". The classes are plane, not-plane, light and not-light; # starts a
 * comment. Any thread.
 * LUXFER_FORMAT if the text is malformed, LUXFER_INVALID_ARGUMENT if a radius or a coordinate is out of range: the
 * message names the line.
 */
luxfer_status luxfer_strokes_add_text(luxfer_strokes *strokes,
                                      const char *description);

/* ==================================================================================================================
 * Job
 *
 * Functions with _start in their names, and luxfer_stylize_update, start long work and return a job at once; the job
 * runs on threads of the library. The job works on the inputs as they are at its start: changing or releasing them
 * later does not affect the job. A function that sets an input makes only the checks that its comment names. The job
 * checks whether all inputs are valid and fit together, and otherwise ends with LUXFER_INVALID_ARGUMENT. While a job
 * runs, its object refuses changes and further jobs (LUXFER_INVALID_OPERATION). Read the results from the object after
 * the job has succeeded. Releasing the last reference to a running job cancels the job and waits until it has ended.
 *
 * Jobs of one context share its threads, so a job may have to wait until another job ends; a cancel request ends a
 * waiting job at once. Only two calls wait for a job: luxfer_job_wait, and luxfer_release of the last reference to a
 * running job.
 * ================================================================================================================== */

/** A job: work in progress. See luxfer_job_wait. */
typedef struct luxfer_job luxfer_job;

/**
 * Receives the progress of a job: fraction is in [0, 1] and never falls. It is 1 only in the last call, after the job
 * has succeeded. Return 0 to continue, any other value to cancel the job. luxfer_job_wait calls the function about 50
 * times a second, on the waiting thread and with no lock held, so it may call any luxfer function. The function must
 * not throw an exception or leave by longjmp.
 */
typedef int32_t (*luxfer_progress_fn)(void *user, double fraction);

/**
 * Waits until a job has ended or timeout_ms milliseconds have passed; a negative timeout_ms waits without limit, and 0
 * does not wait. During the wait, the call passes the progress and the pointer user to the function progress, which
 * may be NULL. Any thread; several threads may wait for one job.
 *
 * *outcome receives the status of the work: LUXFER_OK if the job has succeeded, LUXFER_CANCELLED if a cancel request
 * came in time, LUXFER_NOT_READY if the job still runs, and otherwise the error with which the job has ended. For an
 * error, luxfer_context_get_last_error then gives the message of the job. The call itself returns LUXFER_OK for every
 * outcome. If the function of another job (luxfer_job_start) waits for this job, a cancel request to the other job
 * also cancels this job.
 * LUXFER_INVALID_ARGUMENT if outcome is NULL; LUXFER_INVALID_OPERATION if the function of a job waits for its own job.
 */
luxfer_status luxfer_job_wait(luxfer_job *job,
                              int32_t timeout_ms,
                              luxfer_progress_fn progress,
                              void *user,
                              luxfer_status *outcome);

/**
 * Gets the progress of a job without waiting, in [0, 1]; it is 1 only after success. The call succeeds whether the job
 * runs, has succeeded or has failed; luxfer_job_wait says which. Any thread.
 */
luxfer_status luxfer_job_get_progress(luxfer_job *job,
                                      double *fraction);

/**
 * Asks a job to end early and returns at once; the job ends within about 100 ms. A request cannot be withdrawn. A
 * request after the end of the job has no effect. Any thread.
 */
luxfer_status luxfer_job_cancel(luxfer_job *job);

/* ==================================================================================================================
 * Functions of the caller as jobs
 *
 * Synchronous calls, such as loading a file, warping an image or getting an image of a result, may take long for
 * large inputs. luxfer_job_start runs any sequence of calls as a job, so that a user interface can show its progress
 * and cancel it.
 * ================================================================================================================== */

/**
 * A function of the caller that runs as a job; it receives the pointer given to luxfer_job_start and returns the
 * status with which the job ends. It must not throw an exception or leave by longjmp.
 */
typedef int32_t (*luxfer_work_fn)(void *user);

/**
 * Starts a job that runs work, a function of the caller, on a thread of its own with 4 MiB of stack. The function
 * receives the pointer user, and may call any function of the library. The job reports the progress of the calls that
 * the function makes in this context, and of the jobs that it waits for; the reported progress never falls. The caller
 * releases *job. Any thread.
 *
 * A cancel request to this job also cancels the jobs that the function waits for, and makes the function's calls in
 * this context end with LUXFER_CANCELLED. A call that loads a file then ends before the next mesh or picture.
 *
 * If the function returns an error, the job ends with this error. The message of the job is the message of the last
 * call that failed on the job's thread, or of the last job that failed while the function waited for it. The error
 * LUXFER_NOT_READY is replaced by LUXFER_INVALID_OPERATION, because LUXFER_NOT_READY is the outcome of a job that
 * still runs.
 * LUXFER_INVALID_ARGUMENT if work is NULL.
 */
luxfer_status luxfer_job_start(luxfer_context *context,
                               luxfer_work_fn work,
                               void *user,
                               luxfer_job **job);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_CORE_H */
