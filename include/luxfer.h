/* luxfer: lighting from one photo onto a 3D scene.
 *
 * tests/abi_header.rs generates this file from src/ffi. It needs C99 or C++11 and only the standard headers.
 *
 * In short: create a context, create objects in it, start a stage (this returns a job), wait for the job (optionally
 * with progress), read the results, and release everything in any order.
 *
 *     luxfer_context *context = NULL;
 *     luxfer_image *photo = NULL;
 *     if (luxfer_context_create(NULL, &context) != LUXFER_OK) return 1;
 *     if (luxfer_image_load(context, "photo.jpg", LUXFER_COLOUR_SRGB, &photo) != LUXFER_OK) {
 *         char message[512];
 *         luxfer_context_get_last_error(context, message, sizeof message, NULL);
 *         fprintf(stderr, "%s\n", message);
 *     }
 *     luxfer_release(photo);
 *     luxfer_release(context);
 *
 * Units: metres, radians, right-handed, Y up. Colours are scene-linear Rec.709; luminance is in cd/m², illuminance in
 * lux, luminous flux in lumens.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_H
#define LUXFER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ====================================================================================================================
 * Version
 *
 * The macros give the version of this header, the functions give the version of the loaded library. Before 1.0,
 * libraries with the same minor version are compatible (libluxfer.so.0.2); from 1.0 on, libraries with the same major
 * version.
 *
 * A program that loads the library at run time (dlopen, a folder of plug-ins) should check at its start that
 * luxfer_get_version() / 100 == LUXFER_VERSION / 100; from 1.0 on, that both are equal when divided by 10000 and that
 * the library is not older than the header. luxfer::Context::create of bindings/cpp checks this.
 * ==================================================================================================================== */

/** The version of this header. */
#define LUXFER_VERSION_MAJOR 0
#define LUXFER_VERSION_MINOR 2
#define LUXFER_VERSION_PATCH 0

/** The version of this header as one number, comparable with luxfer_get_version(). */
#define LUXFER_VERSION (10000 * LUXFER_VERSION_MAJOR + 100 * LUXFER_VERSION_MINOR + LUXFER_VERSION_PATCH)

/** The version of the loaded library, comparable with LUXFER_VERSION. Any thread. */
uint32_t luxfer_get_version(void);

/** The version of the loaded library as text, such as "0.2.0". The string is static: never free it. Any thread. */
const char *luxfer_get_version_string(void);

/* ====================================================================================================================
 * Status
 *
 * Every function that can fail returns a luxfer_status. Values are never changed or reused; new values may be added. A
 * function writes its outputs only when it returns LUXFER_OK. luxfer_context_get_last_error describes the failure in
 * words.
 * ==================================================================================================================== */

/** The result of a call: LUXFER_OK, or the reason for the failure. */
typedef int32_t luxfer_status;

/** Success. */
#define LUXFER_OK 0

/** An error that has no status value of its own. */
#define LUXFER_UNKNOWN 1

/** A parameter is NULL, out of range, of the wrong kind or from another context, or contradicts another. */
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

/** A file is truncated, corrupt, or not what it claims to be. */
#define LUXFER_FORMAT 8

/** A result was requested before its job has succeeded, or a wait timed out. */
#define LUXFER_NOT_READY 9

/** A bug in this library: please report it. */
#define LUXFER_INTERNAL 10

/** The input is well formed but has no answer: no lines, a plane seen edge-on, strokes of one class only. */
#define LUXFER_DEGENERATE 11

/** No surface, image or entry has the given name or index. */
#define LUXFER_NOT_FOUND 12

/**
 * No light can reach the target: there is no light path, a channel is fully absorbed, or negative light would be
 * needed.
 */
#define LUXFER_UNREACHABLE 13

/**
 * The name of a status, such as "LUXFER_FORMAT"; "LUXFER_UNKNOWN" for a number that is not a status. The string is
 * static: never free it. Any thread.
 */
const char *luxfer_status_get_name(luxfer_status status);

/* ====================================================================================================================
 * Context
 *
 * A context owns the worker threads, a memory budget and the error messages. All other objects are created in a
 * context and keep it alive, so objects may be released in any order. Objects of two contexts cannot be mixed
 * (LUXFER_INVALID_ARGUMENT).
 *
 * Structs: a function that fills a struct takes its size: the _init function of settings, and the functions that get
 * reports. Pass sizeof. These functions set struct_size, the first field; leave it as it is. So a program that was
 * built with an older header works with a newer library: fields that it does not know keep their defaults.
 *
 * Each call checks its handles: NULL and a handle of another kind give LUXFER_INVALID_ARGUMENT; so does a released
 * handle in most cases, but not if its memory has been reused.
 *
 * Threads: "Any thread" in a comment means that any thread may call the function, at any time. Different threads may
 * use different objects at the same time, and also the same object: calls that change an object wait for each other.
 * Only the release of the last reference must not overlap with another use of the object.
 *
 * The library prints nothing, not even the message of a defect (LUXFER_INTERNAL), reads no environment variables, does
 * not end the process on an error and installs no handlers of the system. All state belongs to a context, with one
 * exception: an emergency reserve of memory, shared by all contexts of the process. The library uses it for small
 * allocations when the system has no memory left; all running jobs of the process then end with LUXFER_OUT_OF_MEMORY.
 *
 * Fork: a child process has none of the threads of its parent. There, each call on an object that was created before
 * the fork returns LUXFER_INVALID_OPERATION at once, luxfer_context_get_last_error gives the reason, and
 * luxfer_release returns LUXFER_OK and frees nothing. A child may create contexts of its own.
 *
 * Stack: a thread of the host needs 128 KiB to read files and to make calls that return when their work is done.
 *
 * With equal inputs, parameters and seeds, results are equal to the bit on one machine, for any number of threads and
 * any floating-point mode (rounding, flush to zero) of the host: a call sets the standard mode on entry and restores
 * the mode of the host on return. Callbacks run in the standard mode.
 * ==================================================================================================================== */

/** A context: threads, memory budget and error messages. See luxfer_context_create. */
typedef struct luxfer_context luxfer_context;

/** Settings of a context. Fill it with luxfer_context_params_init. */
typedef struct luxfer_context_params {
    /** sizeof(luxfer_context_params), set by luxfer_context_params_init. */
    uint32_t struct_size;
    /**
     * Number of worker threads, in [0, 1024]; 0, the default: one for each core that the process may use. Jobs share
     * these threads. Calls that return when their work is done never wait for a job: they run on the calling thread,
     * or on as many further threads, which the context starts for the first of them.
     */
    uint32_t num_threads;
    /**
     * Limit in MiB for the pixels, meshes and textures of all objects that the caller creates in this context; a call
     * that would exceed it returns LUXFER_OUT_OF_MEMORY. 0, the default: no limit. What the decoder of a picture file
     * takes counts while the file is read. The working memory of jobs and their results do not count.
     */
    uint64_t memory_budget_mib;
} luxfer_context_params;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or no version of
 * the struct has this size.
 */
luxfer_status luxfer_context_params_init(luxfer_context_params *params,
                                         size_t size);

/**
 * Creates a context and its threads; params may be NULL for the defaults. The caller releases *context. Any thread.
 * LUXFER_INVALID_ARGUMENT if context is NULL, struct_size is wrong or num_threads exceeds 1024; LUXFER_OUT_OF_MEMORY
 * if the threads cannot be started.
 */
luxfer_status luxfer_context_create(const luxfer_context_params *params,
                                    luxfer_context **context);

/**
 * Copies the message of the calling thread's latest failure in this context into buffer, as zero-terminated UTF-8,
 * truncated to capacity bytes. *needed, unless NULL, receives the capacity that the whole message needs. If no call
 * has failed, the message is empty. A message stays until the thread's next failure; the messages of the 256 threads
 * that failed last are kept. buffer may be NULL if capacity is 0. A call that fails because its first handle is not
 * valid leaves no message. Any thread.
 */
luxfer_status luxfer_context_get_last_error(luxfer_context *context,
                                            char *buffer,
                                            size_t capacity,
                                            size_t *needed);

/* ====================================================================================================================
 * References
 *
 * Handles of every kind are reference counted: a create function returns one reference, luxfer_retain adds one,
 * luxfer_release removes one, and removing the last reference frees the object. Objects may be released in any order.
 * ==================================================================================================================== */

/**
 * Adds a reference to an object of any kind. Any thread.
 * LUXFER_INVALID_ARGUMENT if handle is NULL or not a live object; the failure leaves no message.
 */
luxfer_status luxfer_retain(void *handle);

/**
 * Removes a reference to an object of any kind; NULL does nothing. Any thread.
 *
 * An object may outlive the caller's references: a context lives as long as the objects created in it, and a stage as
 * long as its job, which continues. Two releases take time. The last reference to a job cancels the job and waits
 * until it has ended; the last reference to a context and all objects created in it waits until the worker threads
 * have ended.
 * LUXFER_INVALID_ARGUMENT if handle is not a live object; the failure leaves no message.
 */
luxfer_status luxfer_release(void *handle);

/* ====================================================================================================================
 * Image
 *
 * An image holds 32-bit floating-point samples: scene-linear Rec.709 colour (D65 white), or data. Rows run from top to
 * bottom. An image never changes after its creation, so results are shared and not copied. A view describes pixels in
 * the caller's memory; the library never keeps a pointer to them. Width and height are at most 65536 pixels.
 * ==================================================================================================================== */

/** Flag of a view: the first row in memory is the bottom one. */
#define LUXFER_VIEW_BOTTOM_UP 1

/** An image. See luxfer_image_create. */
typedef struct luxfer_image luxfer_image;

/** Storage type of a sample, in the machine's byte order: a LUXFER_SAMPLE_ value. */
typedef int32_t luxfer_sample;

/** Encoding of the values: a LUXFER_COLOUR_ value. */
typedef int32_t luxfer_colour_space;

/** An image in the caller's memory. Fill it with luxfer_image_view_init, then set size, sample and data. */
typedef struct luxfer_image_view {
    /** sizeof(luxfer_image_view), set by luxfer_image_view_init. */
    uint32_t struct_size;
    /** Samples per pixel in [1, 4]; default 3. */
    uint32_t channels;
    /** LUXFER_SAMPLE_ value; default LUXFER_SAMPLE_F32. */
    luxfer_sample sample;
    /** LUXFER_COLOUR_ value; default LUXFER_COLOUR_LINEAR. */
    luxfer_colour_space colour_space;
    /** Pixels in a row, in [1, 65536]; default 0, to be set. */
    uint32_t width;
    /** Rows, in [1, 65536]; default 0, to be set. */
    uint32_t height;
    /** LUXFER_VIEW_ flags, or 0, the default. Unknown flags are an error. */
    uint32_t flags;
    /** Must be 0. */
    uint32_t reserved;
    /** Bytes from one pixel to the next; at least the size of a pixel, or 0, the default: packed. */
    size_t pixel_stride;
    /** Bytes from one row to the next; at least the size of a row, or 0, the default: packed. */
    size_t row_stride;
    /** Size of the memory at data in bytes; LUXFER_INVALID_ARGUMENT if the layout needs more. To be set. */
    size_t byte_size;
    /** The pixels; any alignment. Bytes between pixels and rows are never touched. To be set. */
    void *data;
} luxfer_image_view;

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
 * Fills *view with the defaults; size is sizeof *view. LUXFER_INVALID_ARGUMENT if view is NULL or no version of the
 * struct has this size.
 */
luxfer_status luxfer_image_view_init(luxfer_image_view *view,
                                     size_t size);

/**
 * Creates an image from a copy of the caller's pixels. It decodes integers and sRGB, and keeps NaN and infinities. The
 * caller releases *image. Any thread.
 * LUXFER_INVALID_ARGUMENT if the view is inconsistent; LUXFER_OUT_OF_MEMORY beyond the context's memory budget.
 */
luxfer_status luxfer_image_create(luxfer_context *context,
                                  const luxfer_image_view *view,
                                  luxfer_image **image);

/**
 * Loads a JPEG, PNG, WebP, TIFF, BMP, GIF (its first frame), Radiance HDR or OpenEXR file, and rotates it upright by
 * its EXIF orientation. path is UTF-8. With LUXFER_COLOUR_SRGB, for pictures, colours are converted to linear Rec.709
 * from the colour space that the file states (ICC profile; cICP, sRGB, gAMA and cHRM of PNG; EXIF; chromaticities of
 * OpenEXR; PRIMARIES, EXPOSURE and COLORCORR of Radiance). Without such a statement, integer samples are sRGB and
 * floating-point samples linear. See luxfer_photo_metadata.colour. With LUXFER_COLOUR_LINEAR, for data such as masks
 * and depth, samples are not converted. An OpenEXR picture has the size of its display window. Grey with alpha
 * becomes RGBA, palettes and CMYK become RGB; colours are not multiplied by alpha. The caller releases *image. Any
 * thread.
 * LUXFER_IO if the file cannot be read, LUXFER_FORMAT if it is damaged or of no known format, LUXFER_UNSUPPORTED if
 * it is of a known format or kind that is not read, which the message names (AVIF, HEIC, JPEG XL, raw data of
 * cameras, a TIFF with JPEG compression, deep or luminance-chroma OpenEXR, an OpenEXR layer with neither R, G, B nor
 * a single channel), or larger than 2^28 pixels or 65536 on a side, LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_image_load(luxfer_context *context,
                                const char *path,
                                luxfer_colour_space colour_space,
                                luxfer_image **image);

/** Loads an image from a file in memory of size bytes; otherwise as luxfer_image_load. */
luxfer_status luxfer_image_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       luxfer_colour_space colour_space,
                                       luxfer_image **image);

/**
 * Saves an image; path is UTF-8 and its extension chooses the format. .png: 1, 3 or 4 channels, multiplied by
 * exposure (> 0, finite; 1 shows the value 1 as white), clamped to [0, 1] and encoded as 8-bit sRGB, which the file
 * states. .exr: up to 64 channels, unchanged, in 32-bit floating point, with the chromaticities of Rec.709; exposure
 * is not used. An existing file is replaced only once the new one is complete, and keeps its mode and owner. Symbolic
 * links are followed; devices, FIFOs and files with several names are written in place. All functions of this library
 * save files in this way. Any thread.
 * LUXFER_INVALID_ARGUMENT for another extension or number of channels; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_image_save(luxfer_image *image,
                                const char *path,
                                float exposure);

/** Gets width and height in pixels and the number of channels; any of the three may be NULL. Any thread. */
luxfer_status luxfer_image_get_size(luxfer_image *image,
                                    uint32_t *width,
                                    uint32_t *height,
                                    uint32_t *channels);

/**
 * Copies an image into the caller's pixels. The view must have the image's size. It receives view->channels channels
 * of the image, starting at first_channel. Integers are clamped to their range and rounded; NaN becomes 0 in integers.
 * Any thread.
 * LUXFER_INVALID_ARGUMENT if the view is inconsistent or does not fit the image.
 */
luxfer_status luxfer_image_read(luxfer_image *image,
                                uint32_t first_channel,
                                const luxfer_image_view *view);

/* ====================================================================================================================
 * Photo metadata
 *
 * The camera settings that the file of a loaded photo records in its EXIF tags (JPEG, PNG, WebP, TIFF), and how its
 * colours were understood. luxfer_image_load applies the orientation. luxfer_rectify and luxfer_transfer use the
 * focal length as a prior unless the caller sets one; the lines of the photo outweigh it where they determine it
 * better. The library does not use white_luminance by itself: to apply it, copy it to
 * luxfer_transfer_params.white_luminance.
 * ==================================================================================================================== */

/**
 * How the colours of an image were understood: a LUXFER_FILE_COLOUR_ value. Values are never changed or reused; new
 * ones may be added.
 */
typedef int32_t luxfer_file_colour;

/** Metadata of the file of a loaded photo. */
typedef struct luxfer_photo_metadata {
    /** sizeof(luxfer_photo_metadata), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * EXIF orientation of the stored photo, in [1, 8]; 1 = upright or not recorded. Loading has already applied it: 2
     * mirrors left to right, 3 rotates by 180 degrees, 4 mirrors top to bottom, 6 rotates clockwise by 90 degrees, 8
     * counter-clockwise, 5 and 7 rotate by 90 degrees and mirror.
     */
    uint32_t orientation;
    /**
     * Focal length in pixels of the loaded photo; 0 = unknown. Also 0 if the photo was cropped, which its aspect
     * ratio shows.
     */
    double focal;
    /** Standard deviation of focal, in pixels; 0 = unknown. */
    double focal_error;
    /** F-number N of the aperture; 0 = unknown. */
    double f_number;
    /** Exposure time t in seconds; 0 = unknown. */
    double exposure_time;
    /** ISO speed S; 0 = unknown. */
    double iso;
    /**
     * Scene luminance in cd/m² that the camera recorded as white (value 1): 78 N² / (0.65 t S), the saturation-based
     * speed of ISO 12232. 0 = unknown. Valid only for the image that the camera wrote: editors that change the
     * brightness keep these tags.
     */
    double white_luminance;
    /** Lower bound of white_luminance: 0.71 times it, if the camera states its standard output sensitivity instead. */
    double white_luminance_low;
    /** Upper bound of white_luminance: one stop above it, if the camera states a recommended exposure index. */
    double white_luminance_high;
    /** How the colours of the file were understood. */
    luxfer_file_colour colour;
    /** 0. */
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
 * A warning: the file states a colour space that the library cannot convert, such as a profile for CMYK or a damaged
 * profile. The colours were read as if the file stated none, so saturated colours may be wrong. Export the photo as
 * sRGB.
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

/* ====================================================================================================================
 * Job
 *
 * X_start starts long work and returns a job at once; the job runs on threads of the library. It works on the inputs
 * as they are at the start: changing or releasing them later does not affect the job. While a job runs, its object
 * refuses changes and further jobs (LUXFER_INVALID_OPERATION). Read the results from the object after the job has
 * succeeded. Releasing the last reference to a running job cancels the job and waits until it has ended.
 *
 * Jobs of one context share its threads, so a job may have to wait until another ends; cancelling it then ends it at
 * once. All other calls run at once, whatever the jobs do, also from a progress function.
 * ==================================================================================================================== */

/** Work in progress. See luxfer_job_wait. */
typedef struct luxfer_job luxfer_job;

/**
 * Receives the progress of a job: fraction starts at 0 and never falls. Only after success it is exactly 1, once, in
 * the last call. Return 0 to continue, any other value to cancel the job. luxfer_job_wait calls the function about 50
 * times a second, on the waiting thread and with no lock held, so it may call any luxfer function. It must not throw
 * an exception or leave by longjmp.
 */
typedef int32_t (*luxfer_progress_fn)(void *user, double fraction);

/**
 * Waits until a job has ended or timeout_ms milliseconds have passed; a negative timeout_ms waits without limit.
 * progress may be NULL; it receives user. Any thread; several threads may wait for one job.
 *
 * Returns LUXFER_OK if the job has succeeded, or its error status, with its message. LUXFER_CANCELLED if a cancel
 * request came in time; LUXFER_NOT_READY only if the wait timed out: the job continues.
 */
luxfer_status luxfer_job_wait(luxfer_job *job,
                              int32_t timeout_ms,
                              luxfer_progress_fn progress,
                              void *user);

/**
 * Gets the progress and the outcome of a job without waiting. *fraction receives the progress in [0, 1]; *outcome
 * receives the status with which the job has ended, as luxfer_job_wait returns it, or LUXFER_NOT_READY while the job
 * runs. The call itself succeeds whatever the outcome. Either pointer may be NULL. Any thread.
 */
luxfer_status luxfer_job_get_progress(luxfer_job *job,
                                      double *fraction,
                                      luxfer_status *outcome);

/**
 * Asks a job to end early and returns at once; the work ends within about 100 ms. A request cannot be withdrawn; a
 * request after the end has no effect. Any thread.
 */
luxfer_status luxfer_job_cancel(luxfer_job *job);

/* ====================================================================================================================
 * Scene
 *
 * A scene holds meshes, materials, textures, lights and cameras. Coordinates are in metres, right-handed, Y up, in
 * world space. Emission is in cd/m²; punctual lights are in candela and lux, as in glTF 2.0. A job works on the scene
 * as it was at the start of the job. Calls that change a scene wait for each other; a call that fails leaves the scene
 * unchanged.
 * ==================================================================================================================== */

/** A scene. See luxfer_scene_load and luxfer_scene_create. */
typedef struct luxfer_scene luxfer_scene;

/**
 * Receives the next size bytes of a file. The export calls it one or more times, in order, on the calling thread and
 * with no lock held. Return 0 to continue, any other value to stop: the export then returns LUXFER_IO. It must not
 * throw an exception or leave by longjmp.
 */
typedef int32_t (*luxfer_write_fn)(void *user, const void *data, size_t size);

/** Numbers of the objects in a scene. */
typedef struct luxfer_scene_counts {
    /** sizeof(luxfer_scene_counts), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of meshes; their indices are 0 to meshes - 1, and likewise for the objects below. */
    uint32_t meshes;
    /** Number of materials. */
    uint32_t materials;
    /** Number of textures. */
    uint32_t textures;
    /** Number of punctual lights: points, spots, directional lights and luminaires. */
    uint32_t lights;
    /** Number of cameras. */
    uint32_t cameras;
    /** Number of triangles in all meshes. */
    uint64_t triangles;
} luxfer_scene_counts;

/** A planar surface of a scene. */
typedef struct luxfer_surface {
    /** sizeof(luxfer_surface), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of triangles. */
    uint32_t triangles;
    /** Corner of the bounding rectangle where u = v = 0, in metres. */
    float origin[3];
    /** Unit vector of u, along the first side of the rectangle. */
    float u_axis[3];
    /** Unit vector of v, along the second side. */
    float v_axis[3];
    /** Unit normal on the side that will emit; it points into the room. */
    float normal[3];
    /** Lengths of the sides along u and v, in metres. */
    float size[2];
    /** Area of the triangles in m². */
    float area;
    /**
     * Area in m² of the other triangles of that name whose planes are inclined to this plane by 5 to 75 degrees, as
     * those of a vault; they receive no emission.
     */
    float sloped_area;
} luxfer_surface;

/** Creates an empty scene. The caller releases *scene. Any thread. */
luxfer_status luxfer_scene_create(luxfer_context *context, luxfer_scene **scene);

/**
 * Saves a scene as a GLB file that contains all textures; path is UTF-8 and ends in .glb. An existing file is replaced
 * only once the new one is complete. Any thread.
 * LUXFER_INVALID_ARGUMENT for another ending; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_scene_export(luxfer_scene *scene,
                                  const char *path);

/**
 * Writes a scene as GLB through the caller's function, which receives user. Any thread.
 * LUXFER_IO if the function returns anything but 0.
 */
luxfer_status luxfer_scene_export_memory(luxfer_scene *scene, luxfer_write_fn write, void *user);

/** Gets the numbers of the objects in a scene. size is sizeof *counts. Any thread. */
luxfer_status luxfer_scene_get_counts(luxfer_scene *scene,
                                      luxfer_scene_counts *counts,
                                      size_t size);

/**
 * Sets an environment that emits the radiance (red, green, blue) from all directions, in cd/m², each finite and >= 0;
 * or, unless image is NULL, an equirectangular image in linear values, multiplied by them. The renderer samples an
 * image in proportion to its brightness. The centre of the image is towards -z, its top towards +y, the centre of its
 * right half towards +x. The image is copied. The environment replaces any earlier one. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value of the image is negative or not finite; LUXFER_OUT_OF_MEMORY beyond the memory
 * budget.
 */
luxfer_status luxfer_scene_set_environment(luxfer_scene *scene,
                                           luxfer_image *image,
                                           float red,
                                           float green,
                                           float blue);

/**
 * Sets the emission of a material: red, green and blue in cd/m², each finite and >= 0. An emission texture of the
 * material is multiplied by it. Any thread.
 * LUXFER_NOT_FOUND if there is no such material.
 */
luxfer_status luxfer_scene_set_emission(luxfer_scene *scene,
                                        uint32_t material,
                                        float red,
                                        float green,
                                        float blue);

/**
 * Finds the planar surface that faces the room among the triangles of an object or material; name is UTF-8. size is
 * sizeof *found. Any thread.
 * LUXFER_NOT_FOUND if no object or material has that name: the message lists names that exist; LUXFER_DEGENERATE if
 * there is no planar surface.
 */
luxfer_status luxfer_scene_find_surface(luxfer_scene *scene,
                                        const char *name,
                                        luxfer_surface *found,
                                        size_t size);

/**
 * Maps an emissive texture (linear, 1 or 3 channels) onto the bounding rectangle of the surface that
 * luxfer_scene_find_surface finds by name. The surface becomes a separate mesh, index *mesh, with a copy of its
 * material, index *material, that emits texture * (red, green, blue) in cd/m², each finite and >= 0. mesh and material
 * may be NULL. Any thread.
 * As luxfer_scene_find_surface; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_place_emission(luxfer_scene *scene,
                                          const char *name,
                                          luxfer_image *texture,
                                          float red,
                                          float green,
                                          float blue,
                                          uint32_t *mesh,
                                          uint32_t *material);

/* ====================================================================================================================
 * Scene files
 *
 * Loads glTF 2.0 files. luxfer_get_warnings and luxfer_scene_get_requirements_text name the features of a file that
 * are not rendered.
 * ==================================================================================================================== */

/** Settings of reading a scene's file. Fill it with luxfer_scene_load_params_init. */
typedef struct luxfer_scene_load_params {
    /** sizeof(luxfer_scene_load_params), set by luxfer_scene_load_params_init. */
    uint32_t struct_size;
    /**
     * 1: the file may name files outside its folder, by .. or an absolute path, and they are read; 0, the default:
     * this gives LUXFER_UNSUPPORTED. Set it only for files that you trust. Only files are read, never devices or
     * addresses on a network.
     */
    uint32_t allow_external_files;
    /**
     * Length in metres of a unit of the file, in [1e-6, 1e6]; default 1, as glTF has it. It scales positions, and
     * leaves intensities and luminances as they are. 0.001: the file is in millimetres.
     */
    double unit;
} luxfer_scene_load_params;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or no version of
 * the struct has this size.
 */
luxfer_status luxfer_scene_load_params_init(luxfer_scene_load_params *params,
                                            size_t size);

/**
 * Loads a glTF 2.0 file, .glb or .gltf with the files it names, which must lie in its folder or below; path is UTF-8.
 * params may be NULL for the defaults. The caller releases *scene. Any thread.
 * LUXFER_IO if a file cannot be read, LUXFER_FORMAT if a file is damaged or refers to something that does not exist,
 * LUXFER_UNSUPPORTED for another version of glTF, for a required extension that this library does not know and for a
 * file outside the folder, LUXFER_OUT_OF_MEMORY beyond the memory budget, LUXFER_INVALID_ARGUMENT if a setting is out
 * of range.
 */
luxfer_status luxfer_scene_load(luxfer_context *context,
                                const char *path,
                                const luxfer_scene_load_params *params,
                                luxfer_scene **scene);

/**
 * Loads a scene from a GLB or glTF file in memory of size bytes. Other files that it names are read from the folder
 * base_path (UTF-8); with NULL it must not name any. Otherwise as luxfer_scene_load.
 */
luxfer_status luxfer_scene_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       const char *base_path,
                                       const luxfer_scene_load_params *params,
                                       luxfer_scene **scene);

/* ====================================================================================================================
 * Materials
 *
 * Materials of surfaces, as in glTF 2.0: metallic-roughness with clear glass, alpha cut-outs and emission, and
 * textures that multiply these values. Materials can be read back and replaced; a material keeps its textures when its
 * values change.
 * ==================================================================================================================== */

/** Meaning of a surface's alpha: a LUXFER_ALPHA_ value. */
typedef int32_t luxfer_alpha_mode;

/** A material: metallic-roughness, as in glTF 2.0. Fill it with luxfer_material_params_init. */
typedef struct luxfer_material_params {
    /** sizeof(luxfer_material_params), set by luxfer_material_params_init. */
    uint32_t struct_size;
    /** 1, the default: back faces reflect and emit as front faces do; 0: only front faces do. */
    uint32_t double_sided;
    /** Name in UTF-8, copied; NULL, the default: no name. */
    const char *name;
    /** Linear colour of the surface, each channel in [0, 1]; default 0.8. */
    float base_color[3];
    /** Share of the surface that is metal, in [0, 1]; default 0. */
    float metallic;
    /** Perceptual roughness in [0, 1]; default 1. */
    float roughness;
    /** Emitted luminance per channel in cd/m², >= 0; default 0. */
    float emission[3];
    /**
     * Share of the light that passes through the surface instead of being reflected diffusely, in [0, 1]; default 0.
     */
    float transmission;
    /** Index of refraction in [1, 4]; default 1.5. */
    float ior;
    /** Opacity in [0, 1]; multiplies the alpha of the base colour texture; default 1. */
    float alpha;
    /** LUXFER_ALPHA_ value; default LUXFER_ALPHA_OPAQUE. */
    luxfer_alpha_mode alpha_mode;
    /** Threshold of alpha for LUXFER_ALPHA_MASK, >= 0; default 0.5. */
    float alpha_cutoff;
    /** Strength of the normal texture: multiplies its x and y; finite; default 1. */
    float normal_scale;
} luxfer_material_params;

/** Continuation of a texture beyond its edges: a LUXFER_WRAP_ value. */
typedef int32_t luxfer_wrap;

/** Purpose of a material's texture: a LUXFER_TEXTURE_ value. */
typedef int32_t luxfer_texture_role;

/** The texture that a material uses for one purpose. */
typedef struct luxfer_texture_use {
    /** sizeof(luxfer_texture_use), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Index of the texture; LUXFER_NONE if the material has no such texture: the fields below are then 0. */
    uint32_t texture;
    /** Set of the mesh's texture coordinates that it uses, 0 or 1. */
    uint32_t uv_set;
    /** LUXFER_WRAP_ value along u. */
    luxfer_wrap wrap_u;
    /** LUXFER_WRAP_ value along v. */
    luxfer_wrap wrap_v;
    /** Affine map of the texture coordinates: two rows of three, applied to (u, v, 1) before the look-up. */
    float transform[6];
} luxfer_texture_use;

/** The alpha is ignored: the surface is opaque. */
#define LUXFER_ALPHA_OPAQUE 0

/** The surface is opaque where alpha is at least alpha_cutoff, and absent elsewhere. */
#define LUXFER_ALPHA_MASK 1

/** The surface stops the share alpha of the light; the rest passes straight through. */
#define LUXFER_ALPHA_BLEND 2

/** Multiplies the base colour; its alpha multiplies the material's. */
#define LUXFER_TEXTURE_BASE_COLOR 0

/** The green channel multiplies the roughness, the blue channel the metallic value. */
#define LUXFER_TEXTURE_METALLIC_ROUGHNESS 1

/** Normals in tangent space. */
#define LUXFER_TEXTURE_NORMAL 2

/** Multiplies the emission; looked up without interpolation. */
#define LUXFER_TEXTURE_EMISSION 3

/** The texture repeats. */
#define LUXFER_WRAP_REPEAT 0

/** The texels at the edge continue. */
#define LUXFER_WRAP_CLAMP 1

/** The texture repeats, mirrored every second time. */
#define LUXFER_WRAP_MIRROR 2

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_material_params_init(luxfer_material_params *params,
                                          size_t size);

/**
 * Adds a material; *index, unless NULL, receives its index. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_material(luxfer_scene *scene,
                                        const luxfer_material_params *params,
                                        uint32_t *index);

/**
 * Replaces the values of a material. It keeps its textures, and its name if params->name is NULL. params may be NULL
 * for the defaults. To change single values, read the material first. Any thread.
 * LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_set_material(luxfer_scene *scene,
                                        uint32_t index,
                                        const luxfer_material_params *params);

/**
 * Reads a material; set params->struct_size before the call. params->name becomes NULL. size is sizeof *params. Any
 * thread.
 * LUXFER_NOT_FOUND if there is no such material.
 */
luxfer_status luxfer_scene_get_material(luxfer_scene *scene,
                                        uint32_t index,
                                        luxfer_material_params *params,
                                        size_t size);

/**
 * Adds a texture: an image in linear values of 1, 3 or 4 channels, the fourth is alpha; wrap_u and wrap_v are
 * LUXFER_WRAP_ values. The image is copied. *index, unless NULL, receives the texture's index. Any thread.
 * LUXFER_INVALID_ARGUMENT if the image has 2 channels or a value that is not finite; LUXFER_OUT_OF_MEMORY beyond the
 * memory budget.
 */
luxfer_status luxfer_scene_add_texture(luxfer_scene *scene,
                                       luxfer_image *image,
                                       luxfer_wrap wrap_u,
                                       luxfer_wrap wrap_v,
                                       uint32_t *index);

/**
 * Sets the texture that a material uses for a purpose; role is a LUXFER_TEXTURE_ value, texture an index, or
 * LUXFER_NONE for no texture. uv_set, 0 or 1, chooses the mesh's set of texture coordinates. transform is two rows of
 * three, finite, applied to (u, v, 1) before the look-up; NULL is the identity. Any thread.
 * LUXFER_NOT_FOUND if there is no such material or texture; LUXFER_INVALID_ARGUMENT for another role or set, or if an
 * emission texture has negative values.
 */
luxfer_status luxfer_scene_set_material_texture(luxfer_scene *scene,
                                                uint32_t material,
                                                luxfer_texture_role role,
                                                uint32_t texture,
                                                uint32_t uv_set,
                                                const float *transform);

/**
 * Gets the texture that a material uses for a purpose; role is a LUXFER_TEXTURE_ value. size is sizeof *texture_use.
 * Any thread.
 * LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT for another role.
 */
luxfer_status luxfer_scene_get_material_texture(luxfer_scene *scene,
                                                uint32_t material_index,
                                                luxfer_texture_role role,
                                                luxfer_texture_use *texture_use,
                                                size_t size);

/**
 * Gets a texture as an image in linear values. The caller releases *image. Any thread.
 * LUXFER_NOT_FOUND if there is no such texture.
 */
luxfer_status luxfer_scene_get_texture(luxfer_scene *scene, uint32_t index, luxfer_image **image);

/* ====================================================================================================================
 * Scene description
 *
 * Describes a scene by arrays of the host: add materials first, then the meshes that use them, then cameras. The calls
 * copy the arrays, which may have any alignment and stride.
 * ==================================================================================================================== */

/** A triangle mesh in world space. Fill it with luxfer_mesh_params_init. */
typedef struct luxfer_mesh_params {
    /** sizeof(luxfer_mesh_params), set by luxfer_mesh_params_init. */
    uint32_t struct_size;
    /** Index of the mesh's material, from luxfer_scene_add_material; default 0. */
    uint32_t material;
    /** Name in UTF-8, copied; luxfer_scene_find_surface finds surfaces by it. NULL, the default: no name. */
    const char *name;
    /** Number of vertices in [3, 2^32 - 1]; to be set. */
    size_t vertex_count;
    /** Three floats per vertex, in metres, each in [-1e15, 1e15]; to be set. */
    const void *positions;
    /** Bytes from one position to the next; at least 12, or 0, the default: packed. */
    size_t position_stride;
    /** Three floats per vertex, finite; NULL, the default: flat faces. */
    const void *normals;
    /** Bytes from one normal to the next; at least 12, or 0, the default: packed. */
    size_t normal_stride;
    /**
     * Texture coordinates: two floats per vertex, finite; (0, 0) is the top-left corner of a texture. NULL, the
     * default: no texture coordinates.
     */
    const void *uvs;
    /** Bytes from one pair of texture coordinates to the next; at least 8, or 0, the default: packed. */
    size_t uv_stride;
    /** Number of triangles, at least 1; to be set. */
    size_t triangle_count;
    /** Three uint32_t per triangle, each less than vertex_count, counter-clockwise seen from the front; to be set. */
    const void *indices;
    /** Bytes from one triangle to the next; at least 12, or 0, the default: packed. */
    size_t index_stride;
    /**
     * Colours of the vertices: red, green, blue and alpha as four floats per vertex, linear, each in [0, 1]. They
     * multiply the material's base colour and alpha. NULL, the default: none.
     */
    const void *colours;
    /** Bytes from one colour to the next; at least 16, or 0, the default: packed. */
    size_t colour_stride;
} luxfer_mesh_params;

/** A pinhole camera. Fill it with luxfer_camera_params_init. */
typedef struct luxfer_camera_params {
    /** sizeof(luxfer_camera_params), set by luxfer_camera_params_init. */
    uint32_t struct_size;
    /** Full vertical angle of view in radians, in [0.001, 3.1]; default 1. */
    float fov_y;
    /** Position in metres, in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /** The point that it looks at, in metres, in [-1e15, 1e15], different from position; default (0, 0, -1). */
    float target[3];
    /** Up direction of the image, not parallel to the viewing direction; default (0, 1, 0). */
    float up[3];
    /** Must be 0. */
    uint32_t reserved;
} luxfer_camera_params;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_mesh_params_init(luxfer_mesh_params *params,
                                      size_t size);

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_camera_params_init(luxfer_camera_params *params,
                                        size_t size);

/**
 * Adds a mesh and copies its arrays; *index, unless NULL, receives its index. Any thread.
 * LUXFER_INVALID_ARGUMENT if an array is missing, a stride is too small, a number is not finite or an index is out of
 * range; LUXFER_NOT_FOUND if the scene has no such material; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_add_mesh(luxfer_scene *scene,
                                    const luxfer_mesh_params *params,
                                    uint32_t *index);

/**
 * Adds a camera; *index, unless NULL, receives its index. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_camera(luxfer_scene *scene,
                                      const luxfer_camera_params *params,
                                      uint32_t *index);

/**
 * Replaces a camera. params may be NULL for the defaults. Any thread.
 * LUXFER_NOT_FOUND if there is no such camera; LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_set_camera(luxfer_scene *scene,
                                      uint32_t index,
                                      const luxfer_camera_params *params);

/**
 * Reads a camera; set params->struct_size before the call. size is sizeof *params. Any thread.
 * LUXFER_NOT_FOUND if there is no such camera.
 */
luxfer_status luxfer_scene_get_camera(luxfer_scene *scene,
                                      uint32_t index,
                                      luxfer_camera_params *params,
                                      size_t size);

/* ====================================================================================================================
 * Luminous intensity distributions
 *
 * The luminous intensity of a luminaire by direction, read from and written to IES (LM-63) and EULUMDAT files. These
 * calls return when their work is done.
 * ==================================================================================================================== */

/** A luminous intensity distribution. See luxfer_distribution_load. */
typedef struct luxfer_distribution luxfer_distribution;

/** A file format of distributions: a LUXFER_DISTRIBUTION_ value. */
typedef int32_t luxfer_distribution_format;

/** Summary of a distribution. */
typedef struct luxfer_distribution_report {
    /** sizeof(luxfer_distribution_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of C planes. */
    uint32_t planes;
    /** Number of vertical angles in each plane. */
    uint32_t angles;
    /** 0. */
    uint32_t reserved;
    /** Luminous flux in lumens: the integral of the intensity over all directions. */
    double flux;
    /** Rated flux of the lamps in lumens; 0 if the file does not state it (absolute photometry). */
    double lamp_flux;
    /** Electric power in watts; 0 if unknown. */
    double watts;
    /** Length, width and height of the luminous opening in metres; negative for round ones. */
    double size[3];
} luxfer_distribution_report;

/** IES LM-63, type C. */
#define LUXFER_DISTRIBUTION_IES 0

/** EULUMDAT. */
#define LUXFER_DISTRIBUTION_LDT 1

/**
 * Loads an .ies or .ldt file; path is UTF-8. The caller releases *distribution. Any thread.
 * LUXFER_IO if the file cannot be read, LUXFER_FORMAT if it is malformed: the message names the line,
 * LUXFER_UNSUPPORTED for types A and B of IES, LUXFER_INVALID_ARGUMENT for another extension.
 */
luxfer_status luxfer_distribution_load(luxfer_context *context,
                                       const char *path,
                                       luxfer_distribution **distribution);

/**
 * Loads a distribution from a file in memory of size bytes; format is a LUXFER_DISTRIBUTION_ value. Otherwise as
 * luxfer_distribution_load.
 */
luxfer_status luxfer_distribution_load_memory(luxfer_context *context,
                                              const void *data,
                                              size_t size,
                                              luxfer_distribution_format format,
                                              luxfer_distribution **distribution);

/**
 * Saves a distribution to an .ies or .ldt file; path is UTF-8. An existing file is replaced only once the new one is
 * complete. Any thread.
 * LUXFER_INVALID_ARGUMENT for another extension, LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_distribution_save(luxfer_distribution *distribution,
                                       const char *path);

/** Gets the summary of a distribution. size is sizeof *report. Any thread. */
luxfer_status luxfer_distribution_get_report(luxfer_distribution *distribution,
                                             luxfer_distribution_report *report,
                                             size_t size);

/**
 * Copies the luminaire's name into buffer as zero-terminated text, truncated to capacity bytes. *needed, unless NULL,
 * receives the capacity that the whole name needs. Any thread.
 */
luxfer_status luxfer_distribution_get_name(luxfer_distribution *distribution,
                                           char *buffer,
                                           size_t capacity,
                                           size_t *needed);

/**
 * Gets the luminous intensity in candela in a direction. Angles are in degrees: c turns around the axis, gamma goes
 * from straight down at 0 to straight up at 180. Any thread.
 */
luxfer_status luxfer_distribution_get_intensity(luxfer_distribution *distribution,
                                                double c,
                                                double gamma,
                                                double *candela);

/* ====================================================================================================================
 * Lights of a scene
 *
 * Punctual lights: points, spots, directional lights (parallel light from far away) and luminaires with a measured
 * intensity distribution. Area lights are surfaces whose material emits.
 * ==================================================================================================================== */

/** A kind of light: a LUXFER_LIGHT_ value. */
typedef int32_t luxfer_light_kind;

/** A punctual light. Fill it with luxfer_light_params_init. */
typedef struct luxfer_light_params {
    /** sizeof(luxfer_light_params), set by luxfer_light_params_init. */
    uint32_t struct_size;
    /** LUXFER_LIGHT_ value; default LUXFER_LIGHT_POINT. */
    luxfer_light_kind kind;
    /** Position of a point or a spot, in metres, in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /** Direction in which a spot or a directional light shines; any length but 0; default (0, -1, 0). */
    float direction[3];
    /**
     * Luminous intensity per channel in cd, of a spot on its axis; for a directional light, the illuminance in lux on
     * a surface that faces it. Each channel >= 0; default (1, 1, 1).
     */
    float intensity[3];
    /** Half angle of the cone in which a spot has its full intensity, in radians, in [0, outer_angle]; default 0. */
    float inner_angle;
    /** Half angle of a spot's whole cone, in radians, in (0, pi / 2]; default pi / 4. */
    float outer_angle;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_light_params;

/** Flux, position, orientation and colour of a luminaire. Fill it with luxfer_luminaire_params_init. */
typedef struct luxfer_luminaire_params {
    /** sizeof(luxfer_luminaire_params), set by luxfer_luminaire_params_init. */
    uint32_t struct_size;
    /** Must be 0. */
    uint32_t reserved;
    /** Luminous flux in lumens, finite and >= 0; default 0: the flux of the distribution. */
    double flux;
    /** Position in metres, in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /** Direction of the axis, where gamma is 0; any length but 0; default (0, -1, 0): it shines down. */
    float axis[3];
    /**
     * Direction of the plane C = 0. Only its component perpendicular to axis counts, which must not be 0; default (1,
     * 0, 0). Seen from above a luminaire that shines down, C grows anticlockwise.
     */
    float c0[3];
    /**
     * Linear colour of the light, each channel >= 0 and not all 0; only the ratio of the channels counts; default (1,
     * 1, 1).
     */
    float colour[3];
} luxfer_luminaire_params;

/** A point light: equal intensity in every direction. */
#define LUXFER_LIGHT_POINT 0

/** A spot light: shines into a cone. */
#define LUXFER_LIGHT_SPOT 1

/** A directional light: shines from infinitely far away. */
#define LUXFER_LIGHT_DIRECTIONAL 2

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_light_params_init(luxfer_light_params *params,
                                       size_t size);

/**
 * Adds a light; *index, unless NULL, receives its index. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_light(luxfer_scene *scene,
                                     const luxfer_light_params *params,
                                     uint32_t *index);

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_luminaire_params_init(luxfer_luminaire_params *params,
                                           size_t size);

/**
 * Adds a luminaire: a point light whose intensity by direction is a distribution; *index, unless NULL, receives its
 * index among the lights. It is a good model only if the luminaire is at most a fifth as large as its distance from
 * the surfaces that it lights. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_luminaire(luxfer_scene *scene,
                                         luxfer_distribution *distribution,
                                         const luxfer_luminaire_params *params,
                                         uint32_t *index);

/* ====================================================================================================================
 * Scene queries
 *
 * Traces rays through a scene and finds their nearest hits, with the same code as the renderer. These calls return
 * when their work is done.
 * ==================================================================================================================== */

/** No index: no mesh, no triangle, no texture. */
#define LUXFER_NONE 4294967295

/** A ray. An element of arrays, so this struct never changes. */
typedef struct luxfer_ray {
    /** Start of the ray, in metres. */
    float origin[3];
    /** Direction; any length but 0. */
    float direction[3];
    /** Hits lie at distances in (0, t_max), in units of direction; may be infinite. */
    float t_max;
} luxfer_ray;

/** The nearest hit of a ray. An element of arrays, so this struct never changes. */
typedef struct luxfer_hit {
    /** Distance in units of the ray's direction; infinite for a miss. */
    float t;
    /** Index of the mesh; LUXFER_NONE for a miss. */
    uint32_t mesh;
    /** Index of the triangle in its mesh; LUXFER_NONE for a miss. */
    uint32_t triangle;
    /** Barycentric coordinate of the triangle's second corner. */
    float u;
    /** Barycentric coordinate of the triangle's third corner. */
    float v;
} luxfer_hit;

/**
 * Finds the nearest hits of count rays; all surfaces count as opaque and two-sided. Of hits at equal distance, the hit
 * with the lower index of mesh, then of triangle, is returned. Rays that are not finite or whose direction is 0 hit
 * nothing. The first call after a scene is loaded or changed prepares it for tracing, which takes longer. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid: the message names the place.
 */
luxfer_status luxfer_scene_intersect(luxfer_scene *scene,
                                     const luxfer_ray *rays,
                                     size_t count,
                                     luxfer_hit *hits);

/* ====================================================================================================================
 * Scene requirements
 *
 * The renderer analyses a scene before the first ray: which kinds of scattering and which lights can occur, and how
 * much light can remain after a bounce. It skips the code for everything that cannot occur, which does not change any
 * image. You need not call these functions: they only report what the renderer does by itself.
 * ==================================================================================================================== */

/** At least one surface scatters diffusely. */
#define LUXFER_SCATTERING_DIFFUSE 1

/** At least one surface has a rough specular reflection. */
#define LUXFER_SCATTERING_GLOSSY 2

/** At least one surface is a mirror. */
#define LUXFER_SCATTERING_MIRROR 4

/** At least one surface is a clear pane of glass. */
#define LUXFER_SCATTERING_GLASS 8

/** At least one surface is partly transparent by its alpha. */
#define LUXFER_SCATTERING_ALPHA 16

/** At least one surface emits. */
#define LUXFER_LIGHTS_SURFACE 1

/** At least one surface emits by a texture. */
#define LUXFER_LIGHTS_TEXTURE 2

/** At least one point light has an intensity above 0. */
#define LUXFER_LIGHTS_POINT 4

/** At least one spot light has an intensity above 0. */
#define LUXFER_LIGHTS_SPOT 8

/** At least one directional light has an illuminance above 0. */
#define LUXFER_LIGHTS_DIRECTIONAL 16

/** The environment emits. */
#define LUXFER_LIGHTS_ENVIRONMENT 32

/** Features that a scene requires of the renderer. */
typedef struct luxfer_requirements {
    /** sizeof(luxfer_requirements), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Kinds of scattering that can occur: LUXFER_SCATTERING_ flags. */
    uint32_t scattering;
    /** Kinds of lights that emit: LUXFER_LIGHTS_ flags. */
    uint32_t lights;
    /** Number of textures that change the scattering, the emission or the normals of surfaces. */
    uint32_t textures;
    /**
     * Number of bounces that matter: light that is scattered more often is at most the share error, given in the call,
     * of all light that surfaces scatter. 0 if the albedos give no bound. The renderer ends paths there only if
     * luxfer_render_params.bounce_error is set.
     */
    uint32_t bounces;
    /** Index of the material with the largest albedo; LUXFER_NONE if there are no surfaces. */
    uint32_t brightest_material;
    /**
     * Largest albedo of any surface, per channel, in [0, 1]: the share of the received light that it reflects and
     * transmits.
     */
    float albedo[3];
    /** Number of triangles with zero area, which are skipped. */
    uint32_t flat_triangles;
} luxfer_requirements;

/**
 * Gets the features that a scene requires of the renderer; error, in [0, 1), is the share of light for the field
 * bounces. The first call after a change of the scene prepares it for tracing. size is sizeof *requirements. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid or error is out of range.
 */
luxfer_status luxfer_scene_get_requirements(luxfer_scene *scene,
                                            float error,
                                            luxfer_requirements *requirements,
                                            size_t size);

/**
 * Describes in words what the renderer skips in a scene, and each extension and feature of its file that is not
 * rendered, with the objects that have it: one sentence per line, as zero-terminated UTF-8, truncated to capacity
 * bytes. *needed, unless NULL, receives the capacity that the whole text needs. buffer may be NULL if
 * capacity is 0. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid.
 */
luxfer_status luxfer_scene_get_requirements_text(luxfer_scene *scene,
                                                 char *buffer,
                                                 size_t capacity,
                                                 size_t *needed);

/* ====================================================================================================================
 * Scene read-back
 *
 * Reads the meshes of a scene. With luxfer_scene_get_counts and the functions that read materials, textures and
 * cameras, a host can copy a whole scene.
 * ==================================================================================================================== */

/** A mesh of a scene. */
typedef struct luxfer_mesh_info {
    /** sizeof(luxfer_mesh_info), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Index of the mesh's material. */
    uint32_t material;
    /** Number of vertices. */
    size_t vertex_count;
    /** Number of triangles. */
    size_t triangle_count;
    /** 1 if each vertex has a normal, 0 if the faces are flat. */
    uint32_t has_normals;
    /** Bit 0 is set if the mesh has the first set of texture coordinates, bit 1 if it has the second. */
    uint32_t uv_sets;
    /** 1 if each vertex has a colour, else 0. */
    uint32_t has_colours;
    /** 0. */
    uint32_t reserved;
} luxfer_mesh_info;

/**
 * Gets the sizes and attributes of a mesh. size is sizeof *info. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh.
 */
luxfer_status luxfer_scene_get_mesh(luxfer_scene *scene,
                                    uint32_t index,
                                    luxfer_mesh_info *info,
                                    size_t size);

/**
 * Copies the name of a mesh into buffer, as luxfer_context_get_last_error copies a message. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh.
 */
luxfer_status luxfer_scene_get_mesh_name(luxfer_scene *scene,
                                         uint32_t index,
                                         char *buffer,
                                         size_t capacity,
                                         size_t *needed);

/**
 * Copies a mesh into packed arrays of the caller: positions and normals with three floats per vertex, and indices with
 * three per triangle. Any of the arrays may be NULL. The capacities are numbers of vertices and of triangles. Any
 * thread.
 * LUXFER_NOT_FOUND if there is no such mesh, or if normals is given and the mesh has none; LUXFER_INVALID_ARGUMENT if
 * a capacity is too small.
 */
luxfer_status luxfer_scene_read_mesh(luxfer_scene *scene,
                                     uint32_t index,
                                     size_t vertex_capacity,
                                     float *positions,
                                     float *normals,
                                     size_t triangle_capacity,
                                     uint32_t *indices);

/**
 * Copies set uv_set, 0 or 1, of a mesh's texture coordinates into a packed array of the caller, two floats per vertex;
 * capacity is a number of vertices. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh or it has no such set; LUXFER_INVALID_ARGUMENT if the capacity is too
 * small.
 */
luxfer_status luxfer_scene_read_mesh_uvs(luxfer_scene *scene,
                                         uint32_t index,
                                         uint32_t uv_set,
                                         size_t capacity,
                                         float *uvs);

/**
 * Copies the colours of a mesh's vertices into a packed array of the caller, four floats per vertex; capacity is a
 * number of vertices. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh or it has no colours; LUXFER_INVALID_ARGUMENT if the capacity is too
 * small.
 */
luxfer_status luxfer_scene_read_mesh_colours(luxfer_scene *scene,
                                             uint32_t index,
                                             size_t capacity,
                                             float *colours);

/* ====================================================================================================================
 * Candidates for the ceiling
 *
 * The objects and materials of a scene with their area, height and direction, the likeliest ceilings first: for hosts
 * that let the user choose the surface with the lights. luxfer_scene_find_surface and luxfer_transfer_set_target take
 * the names. A list is a copy, which stays as it is when the scene changes.
 * ==================================================================================================================== */

/** A list of candidates. See luxfer_scene_get_candidates. */
typedef struct luxfer_candidates luxfer_candidates;

/** What a candidate is: a LUXFER_CANDIDATE_ value. */
typedef int32_t luxfer_candidate_kind;

/** An object or a material of a scene. */
typedef struct luxfer_candidate {
    /** sizeof(luxfer_candidate), set by the function that fills the struct. */
    uint32_t struct_size;
    /** LUXFER_CANDIDATE_ value. */
    luxfer_candidate_kind kind;
    /** Index of the object's first mesh, or of the material. */
    uint32_t index;
    /** Number of triangles with an area. */
    uint32_t triangles;
    /** Area in m². */
    float area;
    /** Area in m² of the triangles that are inclined by less than 15 degrees, on either side. */
    float level_area;
    /** Mean height of these triangles, or of all if there are none, in metres. */
    float height;
    /** Lowest point, in metres. */
    float low;
    /** Highest point, in metres. */
    float high;
    /** Mean direction of the front sides by area, a unit vector; 0 if they cancel, as for a box. */
    float normal[3];
    /**
     * Resemblance to a ceiling, in [0, 1]: the level share of the area, times the share of the scene's plan that it
     * covers, times the square of its height as a share of the scene's; a name such as "ceiling" counts too.
     */
    float score;
    /** 0. */
    uint32_t reserved;
    /** Its name, in zero-terminated UTF-8. The strings live as long as the luxfer_candidates. */
    const char *name;
    /** The reason for the score, in English and with its figures. */
    const char *reason;
} luxfer_candidate;

/** All meshes of one name. */
#define LUXFER_CANDIDATE_OBJECT 0

/** All triangles of one material. */
#define LUXFER_CANDIDATE_MATERIAL 1

/**
 * Lists the objects of a scene, and the materials in use, the likeliest ceilings first. It reads each triangle once.
 * The caller releases *candidates. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid.
 */
luxfer_status luxfer_scene_get_candidates(luxfer_scene *scene,
                                          luxfer_candidates **candidates);

/** Counts the candidates of a list. Any thread. */
luxfer_status luxfer_candidates_get_count(luxfer_candidates *candidates, uint32_t *count);

/**
 * Gets a candidate of a list. size is sizeof *candidate. Any thread.
 * LUXFER_NOT_FOUND if there is no such candidate.
 */
luxfer_status luxfer_candidates_get(luxfer_candidates *candidates,
                                    uint32_t index,
                                    luxfer_candidate *candidate,
                                    size_t size);

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
     * Largest magnification of the photo, > 0; default 16. Parts of the plane that are too far away for it are cut
     * off.
     */
    double max_magnification;
    /** Seed of the search; default 1. */
    uint64_t seed;
} luxfer_rectify_params;

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
    /** Standard deviations of their directions in camera space, in radians. */
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

/** Mainly from what the photo's file says; see luxfer_image_get_metadata. */
#define LUXFER_FOCAL_FROM_METADATA 3

/** The plane in frontal view, linear RGB. */
#define LUXFER_RECTIFY_UNWARPED 0

/** 1 where the photo shows the plane, else 0; 1 channel. */
#define LUXFER_RECTIFY_VALID 1

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_rectify_params_init(luxfer_rectify_params *params,
                                         size_t size);

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
 * Strokes
 *
 * What the user paints on a photo to show where the plane and the lights are. Add strokes point by point, as a drawing
 * or as a text, then hand them to a stage: luxfer_transfer_set_strokes, luxfer_segment_set_strokes or
 * luxfer_features_set_strokes. A stage copies the strokes; to show it later strokes, set them again.
 * ==================================================================================================================== */

/** Strokes for images of one size. See luxfer_strokes_create. */
typedef struct luxfer_strokes luxfer_strokes;

/** The mask that strokes are for: a LUXFER_PHASE_ value. */
typedef int32_t luxfer_phase;

/** The plane that carries the lights: positive strokes lie on the plane; strokes on lights count as positive too. */
#define LUXFER_PHASE_PLANE 0

/** The lights on the plane: positive strokes lie on lights, negative strokes on the plane beside them. */
#define LUXFER_PHASE_LIGHTS 1

/**
 * Creates an empty set of strokes for a photo, or features, of width x height pixels. The caller releases *strokes.
 * Any thread.
 * LUXFER_INVALID_ARGUMENT if width or height is not in [1, 65536].
 */
luxfer_status luxfer_strokes_create(luxfer_context *context,
                                    uint32_t width,
                                    uint32_t height,
                                    luxfer_strokes **strokes);

/**
 * Adds a stroke along a polyline. phase is a LUXFER_PHASE_ value; positive is 1 on the plane or on lights, 0 beside
 * them. points is an array of point_count pairs of float x, y in pixels (the centre of the top-left pixel is 0.5,
 * 0.5); radius is in pixels, in [0.001, 4096]. One point makes a dot. Where strokes of both classes overlap, the later
 * stroke counts. Any thread.
 */
luxfer_status luxfer_strokes_add(luxfer_strokes *strokes,
                                 luxfer_phase phase,
                                 const float *points,
                                 size_t point_count,
                                 float radius,
                                 int32_t positive);

/**
 * Adds the strokes of a drawing of the same size: green (0, 255, 0) is plane, red (255, 0, 0) not plane, yellow (255,
 * 255, 0) light, blue (0, 0, 255) not light; other colours and transparent pixels are ignored. Load drawings with
 * LUXFER_COLOUR_SRGB. Any thread.
 * LUXFER_INVALID_ARGUMENT if the size differs or the drawing has fewer than 3 channels.
 */
luxfer_status luxfer_strokes_add_image(luxfer_strokes *strokes,
                                       luxfer_image *drawing);

/**
 * Adds the strokes of a text in UTF-8. Each line has a class, a radius, and x and y of the points in pixels, such as
 * "light 3 310.5 30 320 31". The classes are plane, not-plane, light and not-light; # starts a comment. Any thread.
 * LUXFER_FORMAT, naming the line, if the text is malformed.
 */
luxfer_status luxfer_strokes_add_text(luxfer_strokes *strokes,
                                      const char *description);

/** Removes all strokes. Stages keep their copies. Any thread. */
luxfer_status luxfer_strokes_clear(luxfer_strokes *strokes);

/* ====================================================================================================================
 * Features
 *
 * Computes the features of each pixel of a photo, for segmentation: ten channels, L*, a*, b* (CIELAB, D65), depth,
 * position x, y, z and normal x, y, z. The depth is a depth map of the caller, or that of a network in an ONNX file of
 * the caller, or that of a box-shaped room fitted to the lines of a luxfer_rectify and to strokes on one of its
 * planes, or a neutral guess.
 * ==================================================================================================================== */

/** The features of a photo. See luxfer_features_create. */
typedef struct luxfer_features luxfer_features;

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

/** Quantity that a depth map measures: a LUXFER_DEPTH_ value. */
typedef int32_t luxfer_depth_kind;

/** Normalisation of the photo's colours for a network, which its file does not state: a LUXFER_NORMALISATION_ value. */
typedef int32_t luxfer_normalisation;

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

/** The ten channels; luxfer_image_read reads some of them. */
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

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_features_params_init(luxfer_features_params *params,
                                          size_t size);

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
 * LUXFER_NOT_READY if it has no result yet.
 */
luxfer_status luxfer_features_set_view(luxfer_features *features,
                                       luxfer_rectify *rectify);

/**
 * Sets strokes on the photo, of which the fit of a room takes those for LUXFER_PHASE_PLANE and the positive strokes on
 * lights: on one plane of the room, such as the ceiling that carries the lights, or off this plane. They affect only a
 * room that is fitted to lines (luxfer_features_set_view): the fit prefers boxes that have all positive strokes on one
 * face and all others off this face. The stage copies the strokes; they replace earlier strokes; strokes may be NULL:
 * no strokes. Any thread.
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
     * Difference of these channels, in their units (CIELAB units for colour), below which the refinement treats
     * neighbours as one surface, in [1e-3, 1e6]; default 8.
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

/** Lamps if luxfer_segment_set_region gave a mask and the features are those of luxfer_features; else a surface. */
#define LUXFER_SUBJECT_AUTO 0

/** A surface, such as the plane that carries the lamps: each pixel is judged by its features. */
#define LUXFER_SUBJECT_SURFACE 1

/**
 * Lamps: compact regions with a sharp contour, brighter than their surroundings. Each positive stroke marks one or
 * more; regions without a stroke that look like them and lie in the mask of luxfer_segment_set_region are found as
 * well. Negative strokes are not needed. The first three channels of the features must be CIELAB.
 */
#define LUXFER_SUBJECT_LAMPS 2

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_segment_params_init(luxfer_segment_params *params,
                                         size_t size);

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
 * Sets the strokes for phase, a LUXFER_PHASE_ value, of this mask: the stage copies them. They replace earlier
 * strokes; strokes may be NULL: no strokes. Any thread.
 * LUXFER_INVALID_ARGUMENT if they are for images of another size than the features.
 */
luxfer_status luxfer_segment_set_strokes(luxfer_segment *segment,
                                         luxfer_strokes *strokes,
                                         luxfer_phase phase);

/**
 * Starts a job that segments. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the features are missing or a job runs already. The job may end with LUXFER_DEGENERATE
 * if one class has no strokes, LUXFER_INVALID_ARGUMENT if sizes differ, a feature is not finite or a setting is out of
 * range.
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
 * Emission
 *
 * Synthesises an emissive texture of any size that continues the light pattern of an unwarped photo, and lists its
 * luminaires.
 * ==================================================================================================================== */

/** A synthesis of an emissive texture. See luxfer_emission_create. */
typedef struct luxfer_emission luxfer_emission;

/** How the lights of an exemplar go on: a LUXFER_LAW_ value. */
typedef int32_t luxfer_emission_law;

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
    /** How the lights go on: a LUXFER_LAW_ value other than LUXFER_LAW_COPY; default LUXFER_LAW_BEST. */
    luxfer_emission_law law;
    /**
     * With 1, the default, lamps of a kind have one size and an outline that is exact at any resolution, and lie at
     * the sites of their lattice. Needs the photo and whole_lamps. With 0 each lamp is shown with the outline of the
     * mask.
     */
    uint32_t clean_lamps;
    /**
     * Magnification of the photo up to which the exemplar is used, against its sharpest pixel and in length, in [1,
     * 1e6]: what is magnified more counts as not shown. Default 0: all of it is used.
     */
    double max_magnification;
} luxfer_emission_params;

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
     * large part of the lamps. Without a whole lamp the texture shows the cut ones.
     */
    uint32_t exemplar_lamps;
    /**
     * Estimated sampling error of the exemplar's statistics: the root mean square of the difference, as defined for
     * error, between the whole texture and parts of it that are as large as the exemplar. If error is at most twice
     * this value, it does not indicate a bad texture. 0 if the texture shows only a part of the exemplar, for blended
     * exemplars, and for a plan.
     */
    float sampling_error;
    /** How the lights go on: a LUXFER_LAW_ value. */
    luxfer_emission_law law;
    /** The law that would have been next best: a LUXFER_LAW_ value. */
    luxfer_emission_law runner_up;
    /**
     * How well the law predicts the lamps of the photo from each other, in [0, 1], each weighed by its photo pixels;
     * NaN where too few of the lights are whole lamps to tell.
     */
    double law_score;
    /**
     * By how much that exceeds the score of the runner-up; below 0 where the law was kept though another scores
     * slightly better.
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
    /** Share of the luminous flux of the whole texture, in [0, 1]. */
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

/** Metadata of the result, with these channels. */
#define LUXFER_EMISSION_METADATA 3

/** The law that predicts the lamps of the photo best: that of their correlation, unless another is clearly better. */
#define LUXFER_LAW_BEST 0

/** The law that the correlation of the lights tells, by min_regularity. */
#define LUXFER_LAW_CORRELATION 1

/** A lattice of two periods. */
#define LUXFER_LAW_LATTICE 2

/** A row of one period; the extent of the exemplar serves as the other. */
#define LUXFER_LAW_ROW 3

/** The exemplar repeats as a whole. */
#define LUXFER_LAW_WHOLE 4

/** Patches go anywhere. */
#define LUXFER_LAW_FREE 5

/** Of results only: the texture is a part of the exemplar, or was given. */
#define LUXFER_LAW_COPY 6

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is
 * wrong.
 */
luxfer_status luxfer_emission_params_init(luxfer_emission_params *params,
                                          size_t size);

/** Creates the stage. The caller releases *emission. Any thread. */
luxfer_status luxfer_emission_create(luxfer_context *context, luxfer_emission **emission);

/**
 * Sets the exemplar, three images of one size: the unwarped photo (linear RGB), the unwarped confidence of the lights
 * (1 channel, in [0, 1]) and the mask where both are valid (1 channel, 1 or 0). luxfer_emission_add_style adds more
 * exemplars. Any thread.
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
 * Describes a luminaire of the texture. A plan has no texels yet, so its luminaires are described as the exemplar
 * shows them, cut at the edges of the texture; only lights that cross their whole exemplar are described as in the
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
 * The outline is where the lamp would cover half of a texel. If the confidence of the lights has values between 0 and
 * 1, it is accurate to a quarter of a texel (or of an unwarped pixel, if that is larger), at corners of the lamp to
 * 0.71. It follows the sides of texels for lamps up to two texels wide, for masks of only 0 and 1, and for lights of a
 * plan that follow its patches. LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such
 * luminaire or corner.
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
 * Adds an exemplar whose lights replace those of the first exemplar according to weights. unwarped, light and valid
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
 * Rendering
 *
 * A path tracer that renders a scene in cd/m². The image improves pass by pass: while the job runs, and after a
 * cancel, the current image can be read with an estimate of its error.
 * ==================================================================================================================== */

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
    /** Paths per pixel, in [1, 1048576]; default 64. With a target error it is the largest mean over the image. */
    uint32_t samples;
    /**
     * Stop when the field error of the report falls to this value, >= 0; paths go to the pixels where they reduce the
     * error most. Default 0: no target.
     */
    float target_error;
    /** Stop after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** Seed of the paths; default 1. */
    uint64_t seed;
    /**
     * Stop when the error of every block of 8 x 8 pixels is at most this value, >= 0. The error of a block is the root
     * mean square over its pixels of half the width of the 95 % confidence interval of the luminance, divided by that
     * luminance or by a tenth of the image's mean, whichever is larger. 0.1 means: within 10 % of the value, 19 times
     * out of 20. A block receives at most 64 times samples paths per pixel, even if it then misses the target. Default
     * 0: no target.
     */
    float pixel_error;
    /**
     * Limit the number of bounces so that the remaining light is at most this share, in [0, 1), of all light that
     * surfaces scatter: the image is too dark by up to that share. luxfer_scene_get_requirements gives the number of
     * bounces. Default 0: no limit; paths end by Russian roulette only, and the image is unbiased.
     */
    float bounce_error;
    /**
     * Strength of the noise filter for LUXFER_RENDER_PREVIEW, in [0, 10]; 1 is usual, larger values blur more. Default
     * 0: no preview, as for final images. It does not change the other images.
     */
    float preview;
    /**
     * Stop when the field relative_error of the report falls to this value, >= 0; paths go to the pixels where they
     * reduce it most. It weighs noise as the eye sees it, in dark areas as in bright ones. Default 0: no target. With
     * several targets, rendering stops when all are reached.
     */
    float relative_error;
} luxfer_render_params;

/** An image of a rendering: a LUXFER_RENDER_ value. */
typedef int32_t luxfer_render_image;

/** Quality of a rendering. */
typedef struct luxfer_render_report {
    /** sizeof(luxfer_render_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Mean number of paths per pixel so far. */
    uint32_t samples;
    /**
     * Root mean square over the pixels of the standard error, divided by the image's mean; infinite while a pixel has
     * fewer than two paths.
     */
    double error;
    /** Number of paths that were discarded because their radiance was not finite. */
    uint64_t discarded;
    /**
     * Estimated bias of the preview: the difference between its expected value and the true image, as root mean square
     * over blocks of 8 x 8 pixels, divided by the image's mean. 0 without a preview.
     */
    double preview_bias;
    /**
     * Root mean square over the pixels of the standard error, divided by the pixel's value (the mean of its channels,
     * but at least a hundredth of the image's mean); infinite while a pixel has fewer than two paths. With few paths
     * it overestimates: with 8 by about a quarter.
     */
    double relative_error;
} luxfer_render_report;

/** Mean radiance of each pixel, linear RGB in cd/m². */
#define LUXFER_RENDER_BEAUTY 0

/**
 * Variance of that mean; 3 channels. Groups of eight pixels share the results of their paths, so their errors are
 * correlated: the variance of a sum over pixels is up to eight times the sum of their variances.
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
 * The beauty image after a noise filter guided by the surfaces. The filter blurs features that the surfaces do not
 * show, such as soft shadows; preview_bias of the report estimates the error. Only if luxfer_render_params.preview is
 * not 0.
 */
#define LUXFER_RENDER_PREVIEW 4

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_render_params_init(luxfer_render_params *params,
                                        size_t size);

/** Creates the stage. The caller releases *render. Any thread. */
luxfer_status luxfer_render_create(luxfer_context *context, luxfer_render **render);

/** Sets the scene; each job renders the scene as it is when the job starts. Any thread. */
luxfer_status luxfer_render_set_scene(luxfer_render *render, luxfer_scene *scene);

/**
 * Sets the camera, such as one that luxfer_scene_get_camera has written. camera may be NULL, the default: the first
 * camera of the scene. Any thread.
 */
luxfer_status luxfer_render_set_camera(luxfer_render *render,
                                       const luxfer_camera_params *camera);

/**
 * Starts a job that renders. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera. The job may end with LUXFER_INVALID_ARGUMENT if the scene is not valid or a setting is out of range.
 */
luxfer_status luxfer_render_start(luxfer_render *render,
                                  const luxfer_render_params *params,
                                  luxfer_job **job);

/**
 * Gets an image of the rendering in its current state; which is a LUXFER_RENDER_ value. The caller releases *image.
 * Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND for a preview if luxfer_render_params.preview was
 * 0.
 */
luxfer_status luxfer_render_get_image(luxfer_render *render,
                                      luxfer_render_image which,
                                      luxfer_image **image);

/**
 * Gets the current quality of the rendering. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before the first pass of a job.
 */
luxfer_status luxfer_render_get_report(luxfer_render *render,
                                       luxfer_render_report *report,
                                       size_t size);

/* ====================================================================================================================
 * Outputs of a rendering
 *
 * Additional images from the same paths as the main image: light selected by light path expressions, and properties of
 * the visible surfaces (AOVs). Request them before luxfer_render_start, and read them as layers while the job runs or
 * afterwards: first the layers of the expressions in the order in which they were added, then the AOVs in the order of
 * their flags. The main image is equal to the bit with and without them.
 *
 * An expression is a regular expression over the events of a path. It starts at the light (L) and ends at the eye (E),
 * as in "LDE", "LSE", "L.*DDE", "LD{1,2}E", "LS*DE" (here S is every event that is not diffuse), or it starts at the
 * camera (C), as in Open Shading Language: "C<RD>L", "C[GS]+.*<L.'Lamp'>". Event types are R T V, scattering modes D G
 * S s (a clear pane is both S and s), lights L O B; . [..] [^..] * + ? {n,m} | ( ) have their usual meaning in regular
 * expressions. A label in quotes is the name of a mesh or of its material; Name#0, Name#1, ... are the patches of its
 * emission texture, numbered as luxfer_lamps numbers them; light0, light1, ... are the scene's punctual lights in
 * their order, environment is the scene's environment. Arnold's built-in names work too: direct, indirect, emission,
 * background, and diffuse, specular, transmission, each alone or with _direct or _indirect.
 * ==================================================================================================================== */

/** Distance along the viewing direction, in metres; infinite where there is no surface. Layer Depth, channel Z. */
#define LUXFER_AOV_DEPTH 1

/** Distance along the ray, in metres; infinite where there is no surface. Layer Distance, channel Z. */
#define LUXFER_AOV_DISTANCE 2

/** Position in world space, in metres. Layer Position, channels X Y Z. */
#define LUXFER_AOV_POSITION 4

/** Shading normal in world space, towards the camera; 0 where there is no surface. Layer Normal, channels X Y Z. */
#define LUXFER_AOV_NORMAL 8

/**
 * Normal of the triangle in world space, towards the camera; 0 where there is no surface. Layer GeometricNormal,
 * channels X Y Z.
 */
#define LUXFER_AOV_GEOMETRIC_NORMAL 16

/** Albedo at normal incidence. Layer Albedo, channels R G B. */
#define LUXFER_AOV_ALBEDO 32

/**
 * Index of the mesh plus 1, or 0 where there is no surface; the mesh that most samples of the pixel hit. Layer
 * IndexOB, channel X.
 */
#define LUXFER_AOV_OBJECT 64

/**
 * Index of the material plus 1, or 0 where there is no surface; the material that most samples of the pixel hit. Layer
 * IndexMA, channel X.
 */
#define LUXFER_AOV_MATERIAL 128

/** Share of the pixel that surfaces cover. Layer Alpha, channel A. */
#define LUXFER_AOV_ALPHA 256

/** Luminance of the main image, in cd/m². Layer Luminance, channel Y. */
#define LUXFER_AOV_LUMINANCE 512

/** Letters that match emissive surfaces and the environment in camera-first expressions: a LUXFER_EMITTER_AS_ value. */
typedef int32_t luxfer_emitter_as;

/** Surfaces match L and O, the environment matches L and B: C<RD>L is all direct light. The default. */
#define LUXFER_EMITTER_AS_BOTH 0

/** Every light matches L only. */
#define LUXFER_EMITTER_AS_LIGHT 1

/** As in Open Shading Language: surfaces match O, the environment matches B. */
#define LUXFER_EMITTER_AS_OBJECT 2

/**
 * Adds a layer with the light that an expression selects. name is the name of the layer: 1 to 64 bytes in UTF-8,
 * without dots, quotes or control characters, and different from the names of the other layers. Any thread.
 * LUXFER_INVALID_ARGUMENT if the name is not valid, or if the expression is malformed: the message gives the column.
 * LUXFER_INVALID_OPERATION while a job runs. The job ends with LUXFER_NOT_FOUND if no object in the scene has a label
 * of the expression, and with LUXFER_INVALID_ARGUMENT if no path can match the expression.
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
 * Sets the letters that match emissive surfaces and the environment; a LUXFER_EMITTER_AS_ value. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_set_emitter_as(luxfer_render *render, luxfer_emitter_as emitter_as);

/**
 * Sets which AOVs are rendered: LUXFER_AOV_ flags combined with |, or 0, the default, for none. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_set_aovs(luxfer_render *render, uint32_t flags);

/**
 * Gets the number of layers of the rendering. Any thread.
 * LUXFER_NOT_READY before the first pass of a job.
 */
luxfer_status luxfer_render_get_layer_count(luxfer_render *render, uint32_t *count);

/**
 * Copies a layer's name into buffer as zero-terminated text, truncated to capacity bytes. *needed, unless NULL,
 * receives the capacity that the whole name needs. Any thread.
 * LUXFER_NOT_FOUND if there is no such layer.
 */
luxfer_status luxfer_render_get_layer_name(luxfer_render *render,
                                           uint32_t index,
                                           char *buffer,
                                           size_t capacity,
                                           size_t *needed);

/**
 * Finds a layer by its name. Any thread.
 * LUXFER_NOT_FOUND if no layer has that name.
 */
luxfer_status luxfer_render_find_layer(luxfer_render *render, const char *name, uint32_t *index);

/**
 * Gets a layer in its current state: 3 channels of light in cd/m², or the channels of an AOV. The caller releases
 * *image. Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND if there is no such layer.
 */
luxfer_status luxfer_render_get_layer(luxfer_render *render,
                                      uint32_t index,
                                      luxfer_image **image);

/**
 * Writes the image and all layers into one OpenEXR file of 32-bit floating-point channels: R, G, B of the image, A if
 * LUXFER_AOV_ALPHA is set, and layer.channel for each layer, as Blender and Nuke read them; Depth.Z also as plain Z.
 * The header holds the expression of each layer of light in the attribute luxfer.lpe.NAME. path is UTF-8; an existing
 * file is replaced only once the new one is complete. Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_render_write_exr(luxfer_render *render,
                                      const char *path);

/* ====================================================================================================================
 * Renderings in parts
 *
 * Renders an image on several machines: each machine renders parts, rectangles of the image and ranges of its paths,
 * into files, and one machine merges the files. The result equals the image that one machine renders as a single part,
 * for any parts in any order, except for the rounding of sums in double precision. A lost part can be rendered again
 * and is equal to the bit.
 *
 * Parts have a fixed number of paths: target_error, relative_error, pixel_error and time_budget_ms must be 0. All
 * parts and the merge must use the same scene, camera, layers and luxfer_render_params; the merge checks this.
 *
 * The files are OpenEXR: R, G, B show the part at its place in the image, and integer channels store its sums.
 * ==================================================================================================================== */

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
    /** Index of the first path of each pixel; default 0. */
    uint32_t first_sample;
    /** Paths per pixel; default 0: all paths from first_sample up to luxfer_render_params.samples. */
    uint32_t samples;
} luxfer_render_part;

/**
 * Fills *part with the whole rendering; size is sizeof *part. LUXFER_INVALID_ARGUMENT if part is NULL or size is
 * wrong.
 */
luxfer_status luxfer_render_part_init(luxfer_render_part *part,
                                      size_t size);

/**
 * Gets part number index of a rendering that is split into columns x rows rectangles and ranges of paths, all of
 * about equal size; index is less than columns * rows * ranges. The rectangles are numbered row by row, and all
 * rectangles of one range come before the next range. params may be NULL for the defaults; set part->struct_size
 * before the call. size is sizeof *part. Any thread.
 * LUXFER_INVALID_ARGUMENT if there is no such part, or if there are more parts than pixels or paths, so that some
 * would be empty.
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
 * Starts a job that renders a part, or the whole if part is NULL, and writes it into a file; path is UTF-8, and an
 * existing file is replaced only once the new one is complete. Afterwards the images of the rendering show this part
 * alone. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera. The job may end with LUXFER_INVALID_ARGUMENT if a setting is out of range, if a setting leaves the number of
 * paths open, or if the part exceeds the image; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_render_start_part(luxfer_render *render,
                                       const luxfer_render_params *params,
                                       const luxfer_render_part *part,
                                       const char *path,
                                       luxfer_job **job);

/**
 * Adds a file of luxfer_render_start_part to the files to merge; path is UTF-8. The call reads only the header of the
 * file; the merge reads the rest. Any thread.
 * LUXFER_IO if it cannot be read; LUXFER_FORMAT if it is not a part of a rendering; LUXFER_INVALID_OPERATION while a
 * job runs.
 */
luxfer_status luxfer_render_add_part(luxfer_render *render,
                                     const char *path);

/**
 * Removes all files to merge. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_clear_parts(luxfer_render *render);

/**
 * Starts a job that merges the files, added in any order; afterwards the rendering has its images and layers as after
 * luxfer_render_start. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera. The job may end with LUXFER_INVALID_ARGUMENT if a file belongs to another rendering or another scene, if
 * parts overlap, or if parts are missing: the message names them; LUXFER_IO or LUXFER_FORMAT if a file cannot be read.
 */
luxfer_status luxfer_render_start_merge(luxfer_render *render,
                                        const luxfer_render_params *params,
                                        luxfer_job **job);

/* ====================================================================================================================
 * Illuminance
 *
 * Computes the illuminance in lux on a calculation grid, or on a mesh by its texture coordinates, with the standard
 * error of every point, and with mean and extremes for reports.
 * ==================================================================================================================== */

/** A calculation of illuminance. See luxfer_illuminance_create. */
typedef struct luxfer_illuminance luxfer_illuminance;

/** Settings of the calculation. Fill them with luxfer_illuminance_params_init. */
typedef struct luxfer_illuminance_params {
    /** sizeof(luxfer_illuminance_params), set by luxfer_illuminance_params_init. */
    uint32_t struct_size;
    /** Points along the first edge or texture coordinate, in [1, 65536]; default 32. */
    uint32_t columns;
    /** Points along the second, in [1, 65536]; default 32. */
    uint32_t rows;
    /** Paths per point, in [16, 16777216], rounded up to a multiple of 16; default 1024. */
    uint32_t samples;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_illuminance_params;

/**
 * A calculation grid. Fill it with luxfer_illuminance_grid_init; the default is a square metre at the origin that
 * faces up.
 */
typedef struct luxfer_illuminance_grid {
    /** sizeof(luxfer_illuminance_grid), set by luxfer_illuminance_grid_init. */
    uint32_t struct_size;
    /** Corner of the grid, in metres; default (0, 0, 0). */
    float origin[3];
    /**
     * Edge of the grid along which the columns are counted, in metres; default (1, 0, 0). The points are the centres
     * of the cells.
     */
    float across[3];
    /** Edge of the grid along which the rows are counted, in metres; default (0, 0, 1). */
    float down[3];
    /** Normal of the side that receives the light; any length but 0; default (0, 1, 0). */
    float normal[3];
    /** Must be 0. */
    uint32_t reserved;
} luxfer_illuminance_grid;

/** An image of the calculation: a LUXFER_ILLUMINANCE_ value. */
typedef int32_t luxfer_illuminance_image;

/** Summary of the illuminance, in lux. */
typedef struct luxfer_illuminance_report {
    /** sizeof(luxfer_illuminance_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of points; on a mesh, the texels that the surface covers. */
    uint32_t points;
    /** Smallest illuminance; minimum / mean is the uniformity U0. */
    double minimum;
    /** Mean illuminance. */
    double mean;
    /** Largest illuminance. */
    double maximum;
    /** Standard error of the mean. */
    double mean_error;
} luxfer_illuminance_report;

/** Illuminance in lux; 1 channel; NaN in texels that the mesh does not cover. */
#define LUXFER_ILLUMINANCE_LUX 0

/** Standard error of each value, in lux; 1 channel. */
#define LUXFER_ILLUMINANCE_ERROR 1

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_illuminance_params_init(luxfer_illuminance_params *params,
                                             size_t size);

/** Fills *grid with the defaults; size is sizeof *grid. LUXFER_INVALID_ARGUMENT if grid is NULL or size is wrong. */
luxfer_status luxfer_illuminance_grid_init(luxfer_illuminance_grid *grid,
                                           size_t size);

/** Creates the stage. The caller releases *illuminance. Any thread. */
luxfer_status luxfer_illuminance_create(luxfer_context *context, luxfer_illuminance **illuminance);

/** Sets the scene; each job uses the scene as it is when the job starts. Any thread. */
luxfer_status luxfer_illuminance_set_scene(luxfer_illuminance *illuminance, luxfer_scene *scene);

/**
 * Starts a job that computes the illuminance on a grid. grid and params may be NULL for their defaults. The caller
 * releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT
 * if the scene is not valid, the grid has no normal, or a setting is out of range.
 */
luxfer_status luxfer_illuminance_start_grid(luxfer_illuminance *illuminance,
                                            const luxfer_illuminance_grid *grid,
                                            const luxfer_illuminance_params *params,
                                            luxfer_job **job);

/**
 * Starts a job that computes the illuminance on a mesh by its first set of texture coordinates: columns along u, rows
 * along v. back is 0 for the front side of the triangles (by their winding), 1 for the back side. params may be NULL
 * for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT
 * if the scene is not valid or has no such mesh, if the mesh has no texture coordinates, or if a setting is out of
 * range.
 */
luxfer_status luxfer_illuminance_start_mesh(luxfer_illuminance *illuminance,
                                            uint32_t mesh,
                                            uint32_t back,
                                            const luxfer_illuminance_params *params,
                                            luxfer_job **job);

/**
 * Gets an image of the calculation; which is a LUXFER_ILLUMINANCE_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_illuminance_get_image(luxfer_illuminance *illuminance,
                                           luxfer_illuminance_image which,
                                           luxfer_image **image);

/**
 * Gets the summary of the illuminance. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_illuminance_get_report(luxfer_illuminance *illuminance,
                                            luxfer_illuminance_report *report,
                                            size_t size);

/* ====================================================================================================================
 * Relighting
 *
 * Solves for the colour and intensity of an emission so that a surface of the scene has the same colour as in the
 * photo. The solution is a factor for the emission, per channel, with a confidence interval.
 * ==================================================================================================================== */

/** A relighting of a scene. See luxfer_relight_create. */
typedef struct luxfer_relight luxfer_relight;

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

/** Whether light should equal its target value, or stay above or below it: a LUXFER_CONSTRAINT_ value. */
typedef int32_t luxfer_constraint;

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

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_relight_params_init(luxfer_relight_params *params,
                                         size_t size);

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
 * Makes the target a limit, separately in each channel: LUXFER_CONSTRAINT_ values. A channel that the photo clips
 * should be LUXFER_CONSTRAINT_AT_LEAST. A limited channel uses the mean scale of the channels that should equal their
 * target if this respects the limit, else the scale that reaches the limit. Any thread.
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

/* ====================================================================================================================
 * Lamps
 *
 * Solves for the powers of the lamps of an emission, within bounds, that come nearest to several goals: surfaces and
 * calculation grids that should receive a given light. One set of paths per goal measures its response to all lamps at
 * once, even to thousands.
 * ==================================================================================================================== */

/** A solver for the powers of lamps. See luxfer_lamps_create. */
typedef struct luxfer_lamps luxfer_lamps;

/**
 * Which lamps share one power: a LUXFER_GROUP_ value. A lamp is a connected region of the emission texture, or a
 * connected piece of the meshes if the emission has no texture.
 */
typedef int32_t luxfer_group;

/** Settings of the calculation. Fill them with luxfer_lamps_params_init. */
typedef struct luxfer_lamps_params {
    /** sizeof(luxfer_lamps_params), set by luxfer_lamps_params_init. */
    uint32_t struct_size;
    /** LUXFER_GROUP_ value; default LUXFER_GROUP_EACH. */
    luxfer_group group;
    /**
     * Largest gap between the sorted coordinates of neighbouring lamps in one row, >= 0; a larger gap starts a new
     * row; default 0.01.
     */
    float row_tolerance;
    /**
     * 1: solve for each colour channel of a group separately, which needs goals of colour only; 0, the default: solve
     * for the power only.
     */
    uint32_t free_colour;
    /** Largest factor for the emission of a group, >= 0; default infinity. */
    double max_scale;
    /**
     * Weight of equal powers against the goals, in [1e-9, 1e3]: small values meet the goals, large values keep the
     * powers equal; default 1e-6.
     */
    double regularisation;
    /**
     * A goal counts as met if the error is at most this share of the goal, in [1e-6, 1], or within its noise; default
     * 0.01.
     */
    double tolerance;
    /** Maximum number of paths for each goal, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /**
     * Stop tracing a goal when the relative error of its response to all lamps together is below this value, in [0,
     * 1]; default 0.01; 0: no target.
     */
    float target_error;
    /** Stop after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** Must be 0. */
    uint32_t reserved;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_lamps_params;

/** All lamps form one group. */
#define LUXFER_GROUP_ALL 0

/** Each lamp is a group of its own. */
#define LUXFER_GROUP_EACH 1

/** Lamps whose centres agree in their first coordinate form a group: u of a texture, x of meshes. */
#define LUXFER_GROUP_BY_X 2

/** Lamps whose centres agree in their second coordinate form a group: v of a texture, y of meshes. */
#define LUXFER_GROUP_BY_Y 3

/** Lamps whose centres agree in their third coordinate form a group: z of meshes. */
#define LUXFER_GROUP_BY_Z 4

/**
 * Lamps of one type form a group: lamps of about equal area; of punctual lights all points, all spots, and all
 * luminaires of one distribution.
 */
#define LUXFER_GROUP_BY_TYPE 5

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_lamps_params_init(luxfer_lamps_params *params,
                                       size_t size);

/** Creates the stage. The caller releases *lamps. Any thread. */
luxfer_status luxfer_lamps_create(luxfer_context *context, luxfer_lamps **lamps);

/**
 * Sets the scene and the emitting material whose lamps are solved for; the solution is a factor for the emission that
 * they have in the scene. With LUXFER_NONE as material the lamps are the scene's punctual lights, by their index, as
 * luxfer_scene_add_light and luxfer_scene_add_luminaire add them. Removes all goals. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material.
 */
luxfer_status luxfer_lamps_set_scene(luxfer_lamps *lamps,
                                     luxfer_scene *scene,
                                     uint32_t material);

/**
 * Starts a job that measures the responses and solves for the powers. If the goals cannot be met, the job succeeds
 * with the powers that come nearest within the bounds. params may be NULL for the defaults. The caller releases *job.
 * Any thread.
 * LUXFER_INVALID_OPERATION if the scene or a goal is missing or a job runs already. The job may end with
 * LUXFER_UNREACHABLE if no goal receives light from any lamp, LUXFER_INVALID_ARGUMENT if the scene is not valid, the
 * emission has no lamp, or a setting is out of range.
 */
luxfer_status luxfer_lamps_start(luxfer_lamps *lamps,
                                 const luxfer_lamps_params *params,
                                 luxfer_job **job);

/* ====================================================================================================================
 * Goals of lamps
 *
 * Goals for the lamps: surfaces and calculation grids that should receive a given light, exactly or as a limit, and
 * the dimming levels of the lamps' drivers.
 * ==================================================================================================================== */

/**
 * Adds a goal: the mean radiance that a mesh should have, in cd/m² per channel, each finite and >= 0; quantity is a
 * LUXFER_QUANTITY_ value; weight, >= 0, is relative to the other goals. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such mesh, LUXFER_INVALID_OPERATION before luxfer_lamps_set_scene.
 */
luxfer_status luxfer_lamps_add_mesh(luxfer_lamps *lamps,
                                    uint32_t mesh,
                                    luxfer_quantity quantity,
                                    float red,
                                    float green,
                                    float blue,
                                    double weight);

/**
 * Adds a goal: the mean illuminance in lux that a calculation grid should have, for light of any colour; weight, >= 0,
 * is relative to the other goals. grid may be NULL for its default. Any thread.
 * LUXFER_INVALID_ARGUMENT if lux is negative or not finite, LUXFER_INVALID_OPERATION before luxfer_lamps_set_scene.
 */
luxfer_status luxfer_lamps_add_grid(luxfer_lamps *lamps,
                                    const luxfer_illuminance_grid *grid,
                                    float lux,
                                    double weight);

/**
 * Makes a goal a limit, separately in each channel: LUXFER_CONSTRAINT_ values. The three values of a goal in lux must
 * be equal. Goals are numbered from 0 in the order in which they were added; a new goal has LUXFER_CONSTRAINT_EQUAL.
 * Any thread.
 * LUXFER_NOT_FOUND if there is no such goal.
 */
luxfer_status luxfer_lamps_set_constraint(luxfer_lamps *lamps,
                                          uint32_t goal,
                                          luxfer_constraint red,
                                          luxfer_constraint green,
                                          luxfer_constraint blue);

/**
 * Sets the dimming levels of the lamps' drivers, as factors for the emission, each finite and >= 0, in any order;
 * count is at most 4096, or 0 for drivers without steps. The solution then chooses for each group one of the levels,
 * so that together they are best for the goals; the half-widths remain those of powers without steps. Any thread.
 * LUXFER_INVALID_ARGUMENT if a level is negative or not finite, or if there are too many.
 */
luxfer_status luxfer_lamps_set_levels(luxfer_lamps *lamps,
                                      const double *levels,
                                      uint32_t count);

/** Removes all goals. Any thread. */
luxfer_status luxfer_lamps_clear_goals(luxfer_lamps *lamps);

/* ====================================================================================================================
 * Results of lamps
 *
 * The powers found, the light that each goal receives, and the contribution of each lamp to each goal.
 * ==================================================================================================================== */

/** Summary of the result. */
typedef struct luxfer_lamps_report {
    /** sizeof(luxfer_lamps_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of lamps. */
    uint32_t lamps;
    /** Number of groups. */
    uint32_t groups;
    /** Number of goals. */
    uint32_t goals;
    /** Number of paths traced for each goal. */
    uint32_t paths;
    /** 1 if all goals are met; 0 if not: luxfer_lamps_get_reason gives the reason. */
    uint32_t all_goals_met;
} luxfer_lamps_report;

/** One lamp. */
typedef struct luxfer_lamp {
    /** sizeof(luxfer_lamp), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Index of its group. */
    uint32_t group;
    /** Centre: texture coordinates and 0, or, without a texture, the position in metres. */
    double centre[3];
    /** Factor for its emission, per channel, >= 0. */
    double scale[3];
    /** Half-widths of the 95 % confidence intervals of scale. */
    double half_width[3];
} luxfer_lamp;

/** The light that a goal receives. */
typedef struct luxfer_lamps_goal {
    /** sizeof(luxfer_lamps_goal), set by the function that fills the struct. */
    uint32_t struct_size;
    /** LUXFER_OUTCOME_ value of each channel. */
    luxfer_outcome outcome[3];
    /** Mean radiance of the goal, in cd/m²; illuminance / pi for a grid. */
    double target[3];
    /** Mean radiance with the powers found, in cd/m². */
    double achieved[3];
    /** Half-widths of the 95 % confidence intervals of achieved. */
    double half_width[3];
    /** Mean radiance from all other light, in cd/m². */
    double background[3];
    /**
     * For goals of illuminance, which are those of grids and of LUXFER_QUANTITY_INCIDENT: target in lux, pi times the
     * luminance of target; 0 for other goals, and likewise for the fields below.
     */
    double target_lux;
    /** Illuminance with the powers found, in lux. */
    double achieved_lux;
    /** Half-width of the 95 % confidence interval of achieved_lux, in lux, if all channels err to one side. */
    double half_width_lux;
    /** Illuminance from all other light, in lux. */
    double background_lux;
} luxfer_lamps_goal;

/** The light that one goal receives from one lamp. */
typedef struct luxfer_lamps_response {
    /** sizeof(luxfer_lamps_response), set by the function that fills the struct. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /** Mean radiance of the goal from the lamp at scale 1, in cd/m² per channel. */
    double mean[3];
    /** Half-widths of the 95 % confidence intervals of mean. */
    double half_width[3];
} luxfer_lamps_response;

/**
 * Gets the summary of the result. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_lamps_get_report(luxfer_lamps *lamps, luxfer_lamps_report *report, size_t size);

/**
 * Gets the power of a lamp. size is sizeof *lamp. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such lamp.
 */
luxfer_status luxfer_lamps_get_lamp(luxfer_lamps *lamps,
                                    uint32_t index,
                                    luxfer_lamp *lamp,
                                    size_t size);

/**
 * Gets the light that a goal receives. size is sizeof *goal. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal.
 */
luxfer_status luxfer_lamps_get_goal(luxfer_lamps *lamps,
                                    uint32_t index,
                                    luxfer_lamps_goal *goal,
                                    size_t size);

/**
 * Gets the light that a goal receives from a lamp, for hosts that mix the light themselves. size is sizeof *response.
 * Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal or lamp.
 */
luxfer_status luxfer_lamps_get_response(luxfer_lamps *lamps,
                                        uint32_t goal,
                                        uint32_t lamp,
                                        luxfer_lamps_response *response,
                                        size_t size);

/**
 * Copies the reason why goals are not met into buffer as zero-terminated text, truncated to capacity bytes; the text
 * is empty if all goals are met. *needed, unless NULL, receives the capacity that the whole text needs. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_lamps_get_reason(luxfer_lamps *lamps,
                                      char *buffer,
                                      size_t capacity,
                                      size_t *needed);

/**
 * Gets the emission texture with every lamp multiplied by its scale; linear RGB. The caller releases *texture. Any
 * thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if the emission has no texture.
 */
luxfer_status luxfer_lamps_get_texture(luxfer_lamps *lamps,
                                       luxfer_image **texture);

/* ====================================================================================================================
 * Importance
 *
 * A map of the light that each point of an emitting surface would send to a target. It is traced once; then it gives
 * the light of any emissive texture on that surface, at any scale, rotation and offset, within milliseconds and with a
 * confidence interval.
 * ==================================================================================================================== */

/** A map of importance. See luxfer_importance_create. */
typedef struct luxfer_importance luxfer_importance;

/** Settings of the map. Fill them with luxfer_importance_params_init. */
typedef struct luxfer_importance_params {
    /** sizeof(luxfer_importance_params), set by luxfer_importance_params_init. */
    uint32_t struct_size;
    /** Cells along u of the surface, in [1, 512]; default 64. */
    uint32_t width;
    /** Cells along v, in [1, 512]; default 64. */
    uint32_t height;
    /** LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING. */
    luxfer_quantity quantity;
    /** Maximum number of paths, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /**
     * Stop when the relative error of the response to a uniform emission is below this value, in [0, 1]; default 0.01;
     * 0: no target.
     */
    float target_error;
    /** Stop after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** Must be 0. */
    uint32_t reserved;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_importance_params;

/** The light that the target receives from a texture. */
typedef struct luxfer_importance_report {
    /** sizeof(luxfer_importance_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of paths of the map. */
    uint32_t paths;
    /** Mean radiance of the target from the texture, in cd/m² per channel, as the values of the texture. */
    double response[3];
    /** Half-widths of the 95 % confidence intervals of response. */
    double half_width[3];
    /**
     * Change of response if the cells of the map were twice as wide and high, noise included. The error due to the
     * cells is about a third of it.
     */
    double band_error[3];
} luxfer_importance_report;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_importance_params_init(luxfer_importance_params *params,
                                            size_t size);

/** Creates the stage. The caller releases *importance. Any thread. */
luxfer_status luxfer_importance_create(luxfer_context *context, luxfer_importance **importance);

/**
 * Sets the scene, the material of the surfaces that will emit, which need texture coordinates, and the mesh that is
 * the target. The current emission of the material does not count. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material or mesh.
 */
luxfer_status luxfer_importance_set_scene(luxfer_importance *importance,
                                          luxfer_scene *scene,
                                          uint32_t material,
                                          uint32_t mesh);

/**
 * Starts a job that traces the map and removes an earlier placement. params may be NULL for the defaults. The caller
 * releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT
 * if the scene is not valid, the surfaces have no texture coordinates, or a setting is out of range.
 */
luxfer_status luxfer_importance_start(luxfer_importance *importance,
                                      const luxfer_importance_params *params,
                                      luxfer_job **job);

/**
 * Gets the map: for each cell, the mean radiance of the target, per channel, if only this cell emitted, with 1 cd/m².
 * The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_importance_get_image(luxfer_importance *importance,
                                          luxfer_image **image);

/**
 * Computes the light that the target receives from a texture (linear, in cd/m²; it repeats). placement maps the
 * surface's texture coordinates to those of the texture: 3 x 3, row by row, the last row 0 0 1; NULL for the
 * identity. Takes a few milliseconds. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_INVALID_ARGUMENT if placement is not finite.
 */
luxfer_status luxfer_importance_respond(luxfer_importance *importance,
                                        luxfer_image *texture,
                                        const double *placement,
                                        luxfer_importance_report *report,
                                        size_t size);

/**
 * Solves for the factor of a texture that gives the target a mean radiance of (red, green, blue) in cd/m², each
 * finite and >= 0, as luxfer_relight does by tracing; texture and placement are as for luxfer_importance_respond.
 * size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_UNREACHABLE if no light of the texture can reach the target.
 */
luxfer_status luxfer_importance_solve(luxfer_importance *importance,
                                      luxfer_image *texture,
                                      const double *placement,
                                      float red,
                                      float green,
                                      float blue,
                                      luxfer_relight_report *report,
                                      size_t size);

/* ====================================================================================================================
 * Placement
 *
 * Finds the position of a texture on a surface that gives a target the most light, the least light, or a given
 * radiance, by gradient descent on the map of luxfer_importance, without tracing more paths.
 * ==================================================================================================================== */

/** Objective of a placement: a LUXFER_AIM_ value. */
typedef int32_t luxfer_aim;

/**
 * Objective and bounds of a placement. The texture coordinates of the surface are scaled and then rotated about their
 * centre (0.5, 0.5), and then shifted. Fill it with luxfer_placement_params_init.
 */
typedef struct luxfer_placement_params {
    /** sizeof(luxfer_placement_params), set by luxfer_placement_params_init. */
    uint32_t struct_size;
    /** LUXFER_AIM_ value; default LUXFER_AIM_MAX_LUMINANCE. */
    luxfer_aim aim;
    /** Mean radiance of the target for LUXFER_AIM_RADIANCE, in cd/m² per channel, each finite and >= 0; default 0. */
    float radiance[3];
    /** Number of placements at which the search starts, in [1, 4096]; default 64. */
    uint32_t starts;
    /** Smallest offset along u and v of the texture, whose period is 1, in [-16, 16]; default -0.5. */
    double min_offset[2];
    /**
     * Largest offset, in [-16, 16]; default 0.5. If smallest and largest are equal, here and below, the value is
     * fixed.
     */
    double max_offset[2];
    /** Smallest number of repetitions of the texture along the surface's u and v, in [1/64, 64]; default 1. */
    double min_scale[2];
    /** Largest number of repetitions, in [1/64, 64]; default 1. */
    double max_scale[2];
    /** Smallest rotation in radians, in [-2 pi, 2 pi]; default 0. */
    double min_rotation;
    /** Largest rotation in radians, in [-2 pi, 2 pi]; default 0. */
    double max_rotation;
    /** Seed of the starting placements; default 1. */
    uint64_t seed;
} luxfer_placement_params;

/** The best placement, and the light that the target then receives. */
typedef struct luxfer_placement {
    /** sizeof(luxfer_placement), set by the function that fills the struct. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /** The map from the surface's texture coordinates to those of the texture, as for luxfer_importance_respond. */
    double placement[9];
    /** Offset along u and v. */
    double offset[2];
    /** Scale along u and v. */
    double scale[2];
    /** Rotation in radians. */
    double rotation;
    /** Mean radiance of the target from the texture alone, in cd/m² per channel. */
    double response[3];
    /** Half-widths of the 95 % confidence intervals of response. */
    double half_width[3];
    /**
     * Change of response if the cells of the map were twice as wide and high, noise included. The error due to the
     * cells is about a third of it.
     */
    double band_error[3];
} luxfer_placement;

/** The largest luminance of the target. */
#define LUXFER_AIM_MAX_LUMINANCE 0

/** The smallest luminance of the target. */
#define LUXFER_AIM_MIN_LUMINANCE 1

/** The mean radiance of the target that is nearest to luxfer_placement_params.radiance, all other light included. */
#define LUXFER_AIM_RADIANCE 2

/**
 * Fills *params with the defaults: any offset, with fixed scale 1 and rotation 0; size is sizeof *params.
 * LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_placement_params_init(luxfer_placement_params *params, size_t size);

/**
 * Starts a job that finds the best placement of a texture (linear, in cd/m²; it repeats) for the target. params may be
 * NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_NOT_READY before a map has been traced, LUXFER_INVALID_OPERATION if a job runs already. The job may end with
 * LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_importance_start_placement(luxfer_importance *importance,
                                                luxfer_image *texture,
                                                const luxfer_placement_params *params,
                                                luxfer_job **job);

/**
 * Gets the placement that was found. size is sizeof *placement. Any thread.
 * LUXFER_NOT_READY before a job of luxfer_importance_start_placement has succeeded, and after another map has been
 * started.
 */
luxfer_status luxfer_importance_get_placement(luxfer_importance *importance,
                                              luxfer_placement *placement,
                                              size_t size);

/* ====================================================================================================================
 * Photometry
 *
 * Photometric quantities of lighting design: the correlated colour temperature of a light, and the glare of a view.
 * These calls return when their work is done.
 * ==================================================================================================================== */

/** The glare of a view. */
typedef struct luxfer_glare_report {
    /** sizeof(luxfer_glare_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of glare sources. */
    uint32_t sources;
    /**
     * Unified glare rating (CIE 117): below 10 there is no glare, 19 is the limit for offices; -infinity without
     * sources.
     */
    double ugr;
    /** Luminance of the background in cd/m². */
    double background;
    /** Luminance in cd/m² above which a pixel counted as a glare source. */
    double threshold;
    /** Solid angle of all sources in steradians. */
    double solid_angle;
} luxfer_glare_report;

/**
 * Gets the correlated colour temperature of a linear colour: *kelvin receives the temperature of the nearest
 * blackbody, in [1000, 20000], *duv the distance from the blackbody in the CIE 1960 diagram, positive for greenish
 * colours. Any thread.
 * LUXFER_DEGENERATE if the colour is black or not finite.
 */
luxfer_status luxfer_colour_to_temperature(luxfer_context *context,
                                           double red,
                                           double green,
                                           double blue,
                                           double *kelvin,
                                           double *duv);

/**
 * Writes the linear colour, with luminance 1, of a colour temperature into rgb, three numbers: kelvin is in [1000,
 * 20000], duv, the distance from the blackbody, in [-0.05, 0.05]. A channel is negative if the colour is out of gamut.
 * Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_temperature_to_colour(luxfer_context *context,
                                           double kelvin,
                                           double duv,
                                           double *rgb);

/**
 * Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB), seen by a level camera with
 * the vertical angle of view fov_y, in radians. Glare sources are the connected patches with a luminance of at least
 * threshold; 0: five times the mean luminance. A wider angle of view gives a better estimate of the background
 * luminance. size is sizeof *report. Any thread.
 * LUXFER_INVALID_ARGUMENT if the image is not finite or a value is out of range.
 */
luxfer_status luxfer_image_get_glare(luxfer_image *image,
                                     double fov_y,
                                     double threshold,
                                     luxfer_glare_report *report,
                                     size_t size);

/* ====================================================================================================================
 * False colour
 *
 * Shows a luminance or illuminance image in false colours of rising brightness, with a scale bar.
 * ==================================================================================================================== */

/** The scale from values to colours: a LUXFER_SCALE_ value. */
typedef int32_t luxfer_scale;

/** The quantity of an image's values: a LUXFER_UNIT_ value. */
typedef int32_t luxfer_unit;

/** Settings of a false colour image. Fill them with luxfer_false_colour_params_init. */
typedef struct luxfer_false_colour_params {
    /** sizeof(luxfer_false_colour_params), set by luxfer_false_colour_params_init. */
    uint32_t struct_size;
    /** LUXFER_SCALE_ value; default LUXFER_SCALE_LINEAR. */
    luxfer_scale scale;
    /** LUXFER_UNIT_ value, written above the bar; default LUXFER_UNIT_LUMINANCE. */
    luxfer_unit unit;
    /** 1, the default: draw a scale bar beside the image, which makes it wider; 0: no bar. */
    uint32_t bar;
    /**
     * Value of the darkest colour, >= 0; on a logarithmic scale 0 means a thousandth of the value of the lightest
     * colour; default 0.
     */
    double minimum;
    /** Value of the lightest colour, greater than minimum; 0, the default, means the largest value of the image. */
    double maximum;
} luxfer_false_colour_params;

/** Linear: equal differences of the value have equal width. */
#define LUXFER_SCALE_LINEAR 0

/** Logarithmic: decades have equal width. */
#define LUXFER_SCALE_LOGARITHMIC 1

/** Luminance in cd/m². */
#define LUXFER_UNIT_LUMINANCE 0

/** Illuminance in lux. */
#define LUXFER_UNIT_ILLUMINANCE 1

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_false_colour_params_init(luxfer_false_colour_params *params,
                                              size_t size);

/**
 * Converts an image (1 channel, or linear RGB, whose luminance is used) to false colours: linear RGB, grey where a
 * value is NaN. params may be NULL for the defaults. Takes a few milliseconds per megapixel. The caller releases
 * *shown. Any thread.
 * LUXFER_INVALID_ARGUMENT if the range of values is empty, or if it should come from the image and the image is black;
 * LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_image_false_colour(luxfer_image *image,
                                        const luxfer_false_colour_params *params,
                                        luxfer_image **shown);

/* ====================================================================================================================
 * Lighting design
 *
 * Realises a solved light with real luminaires: the drive levels of LED primaries, the nearest blackbody light, the
 * electric power, and the requirements of a standard. These calls return when their work is done.
 * ==================================================================================================================== */

/** A colour mixed from primaries. */
typedef struct luxfer_mixture {
    /** sizeof(luxfer_mixture), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * 1 if the mixture equals the requested colour; 0 if the primaries cannot reach it and this is the nearest
     * mixture.
     */
    uint32_t in_gamut;
    /** Linear colour of the mixture. */
    double colour[3];
    /**
     * CIEDE2000 difference from the requested colour, at the exposure that shows the requested colour as middle grey.
     */
    double delta_e;
} luxfer_mixture;

/** The blackbody light that fits a target best. */
typedef struct luxfer_temperature_fit {
    /** sizeof(luxfer_temperature_fit), set by the function that fills the struct. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /** Correlated colour temperature, in [1000, 20000] kelvin. */
    double kelvin;
    /** Luminance of the emission in cd/m², >= 0, if response was measured for a white emission of 1 cd/m². */
    double luminance;
    /** Mean radiance of the target from this light and all other light, in cd/m². */
    double achieved[3];
    /** CIEDE2000 difference of achieved from the target, at the exposure that shows the target as middle grey. */
    double delta_e;
} luxfer_temperature_fit;

/**
 * Requirements of EN 12464-1 for a kind of room, as manufacturers of luminaires quote them. Only the standard itself
 * is binding.
 */
typedef struct luxfer_preset {
    /** sizeof(luxfer_preset), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Year of the edition of the standard. */
    uint32_t edition;
    /** Minimum mean illuminance of the task area, in lux. */
    double illuminance;
    /** Maximum unified glare rating. */
    double glare;
    /** Minimum uniformity U0 of the task area. */
    double uniformity;
    /** Minimum colour rendering index. */
    double rendering;
    /** Minimum mean illuminance of the walls, in lux; 0 if there is no requirement. */
    double walls;
    /** Minimum mean illuminance of the ceiling, in lux; 0 if there is no requirement. */
    double ceiling;
} luxfer_preset;

/**
 * Mixes a linear RGB colour, three numbers that are finite and >= 0, from the LEDs of a luminaire. primaries holds
 * the linear RGB of count LEDs at drive level 1, with negative channels for colours out of gamut; count is in [1,
 * 64]. drives receives count drive levels in [0, max_drive]; max_drive may be infinite. If several mixtures give the
 * colour, the one with the smallest sum of squared drive levels is returned. size is sizeof *mixture. Any thread.
 * LUXFER_DEGENERATE if all primaries are black, LUXFER_INVALID_ARGUMENT if a number is out of range.
 */
luxfer_status luxfer_mix_primaries(luxfer_context *context,
                                   const double *primaries,
                                   uint32_t count,
                                   double max_drive,
                                   const double *colour,
                                   double *drives,
                                   luxfer_mixture *mixture,
                                   size_t size);

/**
 * Finds the temperature and luminance of the blackbody light that brings a target nearest to a mean radiance. Each
 * array holds three channels: response is the response to a white emission, from luxfer_relight_get_report or
 * luxfer_importance_respond; background is the radiance from other lights; target is the wanted radiance. size is
 * sizeof *fit. Any thread.
 * LUXFER_UNREACHABLE if no channel responds, LUXFER_INVALID_ARGUMENT if a number is not finite.
 */
luxfer_status luxfer_fit_temperature(luxfer_context *context,
                                     const double *response,
                                     const double *background,
                                     const double *target,
                                     luxfer_temperature_fit *fit,
                                     size_t size);

/** Gets the number of presets. Any thread. */
luxfer_status luxfer_preset_get_count(luxfer_context *context, uint32_t *count);

/**
 * Gets the requirements of a preset. size is sizeof *preset. Any thread.
 * LUXFER_NOT_FOUND if there is no such preset.
 */
luxfer_status luxfer_preset_get(luxfer_context *context,
                                uint32_t index,
                                luxfer_preset *preset,
                                size_t size);

/**
 * Copies the name of a preset, such as "office: filing, copying", into buffer as zero-terminated text, truncated to
 * capacity bytes. *needed, unless NULL, receives the capacity that the whole name needs. Any thread.
 * LUXFER_NOT_FOUND if there is no such preset.
 */
luxfer_status luxfer_preset_get_name(luxfer_context *context,
                                     uint32_t index,
                                     char *buffer,
                                     size_t capacity,
                                     size_t *needed);

/* ====================================================================================================================
 * Pattern
 *
 * Size, rotation and offset of the light pattern of a transfer on the surface, and the areas without lamps.
 * ==================================================================================================================== */

/** The length that sets the size of the pattern on the surface: a LUXFER_PATTERN_ value. */
typedef int32_t luxfer_pattern_scale;

/**
 * Layout of the pattern on the surface; the corner and the axes u and v of the surface are those of luxfer_surface.
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
     * luxfer_transfer_set_zones, in [-1, 1e6]; lamps that are nearer are left out. A value below 0, such as the
     * default -1, keeps the lamps at the edge of the surface, which cuts them.
     */
    double margin;
} luxfer_pattern_params;

/**
 * The distance of the photo's camera from the plane with the lights: plane_distance of luxfer_transfer_params, or the
 * estimate from the lamps where that is 0.
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

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_pattern_params_init(luxfer_pattern_params *params,
                                         size_t size);

/* ====================================================================================================================
 * Transfer
 *
 * The lighting transfer from end to end: lights a scene as in a photo, from the photo and a few strokes. It runs the
 * stages in order. You can read every result as soon as its stage has ended, replace it by your own, and continue from
 * any stage.
 * ==================================================================================================================== */

/** A lighting transfer. See luxfer_transfer_create. */
typedef struct luxfer_transfer luxfer_transfer;

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
     * strength of the lamps is proportional to it. One photo does not show it: see proposed_white of
     * luxfer_transfer_report.
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

/** A stage of the transfer: a LUXFER_STAGE_ value. The values are in the order in which the stages run. */
typedef int32_t luxfer_stage;

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

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_transfer_params_init(luxfer_transfer_params *params,
                                          size_t size);

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
 * surface. Among them, too, the transfer takes the plane that faces most of the room. They replace earlier triangles,
 * and luxfer_transfer_set_scene removes them. triangles may be NULL if count is 0: the name counts again. Any thread.
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
 * plane, the result of the stage UNWARP by that plane. Any thread.
 * LUXFER_NOT_READY if it has no result yet.
 */
luxfer_status luxfer_transfer_use_rectify(luxfer_transfer *transfer,
                                          luxfer_rectify *rectify);

/**
 * Replaces the result of the stage FEATURES by that of a luxfer_features. Any thread.
 * LUXFER_NOT_READY if it has no result yet.
 */
luxfer_status luxfer_transfer_use_features(luxfer_transfer *transfer, luxfer_features *features);

/**
 * Replaces the result of the stage PLANE or LIGHTS by that of a luxfer_segment; phase, a LUXFER_PHASE_ value, chooses
 * the stage. Any thread.
 * LUXFER_NOT_READY if it has no result yet.
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
    /** Relative difference between texture and photo in the share of the lit area. */
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
     * Distance of the photo's camera from the plane in metres that the size of the pattern amounts to; NaN before the
     * stage EMISSION has ended, and for a given texture.
     */
    double plane_distance;
    /**
     * Relative standard deviation of plane_distance where it is estimated from the size of the lamps: about 0.25
     * for lamps of a usual size, 0.6 where they do not tell. 0 where the settings determine the distance.
     */
    double plane_distance_error;
    /**
     * Value proposed for luxfer_transfer_params.white_luminance in cd/m²: by the exposure that the photo's file
     * states, as luxfer_photo_metadata has it; else 159, which white paper has in the 500 lux of an office.
     */
    double proposed_white;
    /** Lower bound of proposed_white: by the exposure; else 32, for the 100 lux of a corridor. */
    double proposed_white_low;
    /** Upper bound of proposed_white: by the exposure; else 318, for 1000 lux. */
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
    /** Distance from the blackbody in the CIE 1960 diagram. */
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
     * The stage whose result is in doubt, a LUXFER_STAGE_ value. Of a luxfer_segment it is LIGHTS with a mask to look
     * within, PLANE without; of a luxfer_scene it is SCENE.
     */
    luxfer_stage stage;
    /** 1 if the warning has a place in the photo, else 0. */
    uint32_t has_place;
    /** The figure that raised it; each code has its own. */
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
 * The vanishing points do not determine the focal length, which was assumed; the severity is its relative standard
 * deviation.
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
 * The room was laid out from its lines with little trust, and there is no depth map; the severity is that trust,
 * below the limit.
 */
#define LUXFER_WARNING_LAYOUT_UNCERTAIN 5

/**
 * Much of a mask is unlike every stroke, or regions are left out that resemble the painted lamps in part; the
 * severity is their share of the mask and these regions. The place is the pixel where one more stroke helps most.
 */
#define LUXFER_WARNING_UNSEEN 6

/** Strokes of both classes cover the same pixels; the severity is their number per sample. */
#define LUXFER_WARNING_CONTRADICTORY_STROKES 7

/** Strokes lie outside the photo; the severity is the number of these pixels per sample. */
#define LUXFER_WARNING_OFF_IMAGE_STROKES 8

/** A mask is uncertain; the severity is the expected share of wrong pixels. */
#define LUXFER_WARNING_UNCERTAIN_MASK 9

/** A mask has no pixel; the severity is 0, below the limit. */
#define LUXFER_WARNING_EMPTY_MASK 10

/**
 * A mask of a transfer contradicts its strokes; the severity is the share of their pixels. The place is one of them.
 */
#define LUXFER_WARNING_MISSED_STROKES 11

/** Lights cover much of their plane; the severity is its share. */
#define LUXFER_WARNING_ALMOST_ALL_LIT 12

/** Much of the unwarped plane is magnified; the severity is its share. The place is the one that is magnified most. */
#define LUXFER_WARNING_MAGNIFIED 13

/**
 * The camera sees the plane nearly edge-on; the severity is the sine of the angle for half of the plane, below the
 * limit. The place is the flattest.
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

/** The photo clips the target, which is a lower bound; the severity is the number of these channels. */
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
 * Gets the warnings about the result of an object. handle is one of:
 * - a luxfer_transfer: the warnings of all stages that have a result, in their order;
 * - a luxfer_rectify: about the camera, and about the plane if it has been unwarped;
 * - a luxfer_features;
 * - a luxfer_segment: its mask, compared with the strokes and with the region as they are now;
 * - a luxfer_emission: about the texture; a plan has no warnings;
 * - a luxfer_relight;
 * - a luxfer_scene: an implausible size, and features of its file that are not rendered.
 *
 * The caller releases *warnings. Any thread.
 * LUXFER_NOT_READY before a job has succeeded (of a transfer: before the first stage has ended);
 * LUXFER_INVALID_ARGUMENT if handle is of another kind.
 */
luxfer_status luxfer_get_warnings(void *handle, luxfer_warnings **warnings);

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
 * Planning
 *
 * Chooses settings for a given error or a given time before anything is rendered: of relighting and rendering, or of a
 * stylisation. A plan also predicts the time and the error of each. The cost of a path and the noise depend on the
 * scene, so a plan measures them on a small part of the actual work; this takes a few tenths of a second, besides the
 * preparation of the scene. It assumes that the load of the machine by other programs does not change.
 *
 * The error of a picture is the root mean square error over its pixels, divided by its mean; it includes the noise and
 * the error in brightness that comes from the solution of the emission. luxfer_plan_start_stylize defines the error of
 * a stylisation.
 * ==================================================================================================================== */

/** A plan. See luxfer_plan_create. */
typedef struct luxfer_plan luxfer_plan;

/** Goal of a plan: set exactly one of time_budget_ms and target_error. Fill it with luxfer_plan_params_init. */
typedef struct luxfer_plan_params {
    /** sizeof(luxfer_plan_params), set by luxfer_plan_params_init. */
    uint32_t struct_size;
    /** Time for all planned work in milliseconds; default 0: the goal is target_error. */
    uint32_t time_budget_ms;
    /**
     * Error of the picture, root mean square over its pixels divided by its mean, in [1e-5, 1]; default 0: the goal is
     * time_budget_ms.
     */
    float target_error;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_plan_params;

/** Times and errors that a plan predicts. */
typedef struct luxfer_plan_report {
    /** sizeof(luxfer_plan_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** 1 if the plan includes relighting (plan of a transfer); 0 for a plan of a rendering or a stylisation. */
    uint32_t relights;
    /** Seconds for all planned work. */
    double seconds;
    /** Error of the picture. */
    double error;
    /** Seconds for relighting, including the preparation of the scene; 0 unless the plan is of a transfer. */
    double relight_seconds;
    /**
     * Predicted field error of luxfer_relight_report, half the width of its interval; 0 unless the plan is of a
     * transfer.
     */
    double relight_error;
    /**
     * Seconds for rendering; in a plan of a transfer including the preparation of the scene; 0 in a plan of a
     * stylisation.
     */
    double render_seconds;
    /** Predicted field error of luxfer_render_report; 0 in a plan of a stylisation. */
    double render_error;
} luxfer_plan_report;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_plan_params_init(luxfer_plan_params *params,
                                      size_t size);

/** Creates a plan. The caller releases *plan. Any thread. */
luxfer_status luxfer_plan_create(luxfer_context *context, luxfer_plan **plan);

/**
 * Starts a job that plans a rendering with the scene and the camera of render. settings gives the size of the picture
 * and the other settings that do not affect quality; NULL for the defaults. params gives the goal. The caller releases
 * *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera.
 */
luxfer_status luxfer_plan_start_render(luxfer_plan *plan,
                                       luxfer_render *render,
                                       const luxfer_render_params *settings,
                                       const luxfer_plan_params *params,
                                       luxfer_job **job);

/**
 * Starts a job that plans the stages RELIGHT and RENDER of a transfer, with the lamps that its stage EMISSION has
 * made. settings are the settings with which the transfer will be started; NULL for the defaults. Afterwards replace
 * its relight and render by luxfer_plan_get_relight_params and luxfer_plan_get_render_params, which change the
 * settings that affect quality. params gives the goal. The caller releases *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
 * LUXFER_INVALID_OPERATION before the stage EMISSION has a result, or if a job runs already. The job may end with
 * LUXFER_UNREACHABLE if no light of the lamps is reflected back to their surface.
 */
luxfer_status luxfer_plan_start_transfer(luxfer_plan *plan,
                                         luxfer_transfer *transfer,
                                         const luxfer_transfer_params *settings,
                                         const luxfer_plan_params *params,
                                         luxfer_job **job);

/**
 * Gets the predictions of the plan. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_plan_get_report(luxfer_plan *plan,
                                     luxfer_plan_report *report,
                                     size_t size);

/**
 * Gets the settings to render with: the given settings with the choices of the plan. If the goal is an error,
 * rendering stops when it is reached. If the goal is a time, the plan chooses the number of paths and sets
 * time_budget_ms to a quarter more than they should take, so that every run gives an equal picture unless the machine
 * becomes slower. Set params->struct_size before the call. size is sizeof *params. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND in a plan of a stylisation.
 */
luxfer_status luxfer_plan_get_render_params(luxfer_plan *plan,
                                            luxfer_render_params *params,
                                            size_t size);

/**
 * Gets the settings to relight with: the given settings with the choices of the plan. Set params->struct_size before
 * the call. size is sizeof *params. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND unless the plan is of a transfer.
 */
luxfer_status luxfer_plan_get_relight_params(luxfer_plan *plan,
                                             luxfer_relight_params *params,
                                             size_t size);

/* ====================================================================================================================
 * Guides
 *
 * Renders the guide images of a stylisation, which show different kinds of light in a scene: once for the exemplar
 * scene and once for the target scene. Guides from another renderer do not need this object: see
 * luxfer_stylize_add_guide.
 * ==================================================================================================================== */

/** The guides of a scene. See luxfer_guides_create. */
typedef struct luxfer_guides luxfer_guides;

/** Settings of guides. Fill them with luxfer_guides_params_init. */
typedef struct luxfer_guides_params {
    /** sizeof(luxfer_guides_params), set by luxfer_guides_params_init. */
    uint32_t struct_size;
    /** Width of the images in pixels, in [1, 32768]; default 800. */
    uint32_t width;
    /** Height of the images in pixels, in [1, 32768]; default 608. */
    uint32_t height;
    /** Paths per pixel, in [1, 1048576]; default 64. */
    uint32_t samples;
    /** Index of the scene's camera; default 0. */
    uint32_t camera;
    /**
     * 1, the default: smooth the light along surfaces, so that the stylisation does not match noise; 0: keep the
     * noise.
     */
    uint32_t smooth;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_guides_params;

/** An image of guides: a LUXFER_GUIDES_ value. Light is linear RGB in cd/m². */
typedef int32_t luxfer_guides_image;

/** All light, reflected any number of times. */
#define LUXFER_GUIDES_FULL 0

/** Light reflected once, by a diffuse surface (LDE). */
#define LUXFER_GUIDES_DIRECT 1

/** Light reflected once, by a glossy surface (LSE). */
#define LUXFER_GUIDES_SPECULAR 2

/** Light whose last two reflections were diffuse (L.*DDE): it shows colour bleeding. */
#define LUXFER_GUIDES_INDIRECT 3

/** Light reflected once or twice, by diffuse surfaces (LD{1,2}E): it shows shadows. */
#define LUXFER_GUIDES_TWO_BOUNCES 4

/** Normals in camera space: x right, y up, z towards the camera; 3 channels. */
#define LUXFER_GUIDES_NORMALS 5

/** Edges of shapes, in [0, 1]; 1 channel. */
#define LUXFER_GUIDES_EDGES 6

/** A colour code for each material, derived from its name; 3 channels. */
#define LUXFER_GUIDES_MATERIALS 7

/** Caustics: light that glossy surfaces reflect onto diffuse surfaces (LS+DE). */
#define LUXFER_GUIDES_CAUSTICS 8

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_guides_params_init(luxfer_guides_params *params,
                                        size_t size);

/** Creates the stage. The caller releases *guides. Any thread. */
luxfer_status luxfer_guides_create(luxfer_context *context, luxfer_guides **guides);

/** Sets the scene; each job renders the scene as it is when the job starts. Any thread. */
luxfer_status luxfer_guides_set_scene(luxfer_guides *guides, luxfer_scene *scene);

/**
 * Starts a job that renders the guides. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera. The job may end with LUXFER_INVALID_ARGUMENT if the scene is not valid or a setting is out of range.
 */
luxfer_status luxfer_guides_start(luxfer_guides *guides,
                                  const luxfer_guides_params *params,
                                  luxfer_job **job);

/**
 * Gets a guide; which is a LUXFER_GUIDES_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_guides_get_image(luxfer_guides *guides,
                                      luxfer_guides_image which,
                                      luxfer_image **image);

/**
 * Computes the motion between two frames of one scene under a moving camera, for luxfer_stylize_set_motion: for each
 * pixel of this frame, the offset to its position in the frame before, x and y in pixels; NaN where it was not
 * visible. The caller releases *motion. Any thread.
 * LUXFER_NOT_READY before both are rendered; LUXFER_INVALID_ARGUMENT if their sizes differ.
 */
luxfer_status luxfer_guides_get_motion(luxfer_guides *guides,
                                       luxfer_guides *before,
                                       luxfer_image **motion);

/* ====================================================================================================================
 * Settings of a stylisation
 *
 * Presets and settings. The defaults were chosen on the curves of quality against time that benches/stylit.rs draws.
 * ==================================================================================================================== */

/** How exemplar patches are assigned to the target: a LUXFER_STYLIZE_MODE_ value. */
typedef int32_t luxfer_stylize_mode;

/** Search for nearest patches: a LUXFER_STYLIZE_SEARCH_ value. */
typedef int32_t luxfer_stylize_search;

/** How a pixel is computed from overlapping patches: a LUXFER_STYLIZE_VOTE_ value. */
typedef int32_t luxfer_stylize_vote;

/**
 * Settings of a stylisation. Fill them with luxfer_stylize_params_init or luxfer_stylize_params_preset. The defaults
 * stated here are those of LUXFER_STYLIZE_FULL.
 */
typedef struct luxfer_stylize_params {
    /** sizeof(luxfer_stylize_params), set by luxfer_stylize_params_init. */
    uint32_t struct_size;
    /** LUXFER_STYLIZE_MODE_ value; default LUXFER_STYLIZE_MODE_BUDGET. */
    luxfer_stylize_mode mode;
    /** LUXFER_STYLIZE_SEARCH_ value; default LUXFER_STYLIZE_SEARCH_PATCHMATCH. */
    luxfer_stylize_search search;
    /** Width of a patch in pixels, odd, in [1, 33]; default 5. */
    uint32_t patch;
    /** Weight of all guides together, relative to the artwork's colours together, in [0, 1e6]; default 2. */
    float guide_weight;
    /** Maximum number of resolution levels, each half as wide and high as the next, in [1, 16]; default 6. */
    uint32_t levels;
    /** Rounds of matching and painting on the second finest level, in [1, 100]; default 6. */
    uint32_t iterations;
    /** Rounds of matching and painting on the finest level, in [1, 100]; default 1. */
    uint32_t finest_iterations;
    /**
     * Additional rounds on the finest level without the error budget, in which each target patch takes its nearest
     * match, in [0, 100]; default 3; the paper has 0. In other modes than LUXFER_STYLIZE_MODE_BUDGET these are
     * additional rounds of that mode.
     */
    uint32_t polish;
    /** PatchMatch sweeps of a search, in [1, 100]; default 1. */
    uint32_t sweeps;
    /**
     * Share of the target that is matched under the error budget before the rest is matched without it, in [0, 1];
     * default 0.9.
     */
    float coverage;
    /** Maximum number of matching passes under the error budget in a round, in [1, 1000]; default 6. */
    uint32_t passes;
    /**
     * Sweeps in which a target patch may continue the match of its neighbour, for fewer seams, in [0, 100]; default 2;
     * the paper has 0.
     */
    uint32_t settle;
    /**
     * Cost of a seam between neighbouring patches in those sweeps, as a share of the mean error, in [0, 100]; default
     * 0.2.
     */
    float seam;
    /** LUXFER_STYLIZE_VOTE_ value; default LUXFER_STYLIZE_VOTE_WEIGHTED. */
    luxfer_stylize_vote vote;
    /** LUXFER_STYLIZE_VOTE_ value for the final picture; default LUXFER_STYLIZE_VOTE_MOST. */
    luxfer_stylize_vote final_vote;
    /**
     * 1: work at half resolution with compressed guides, which makes the picture half as wide and high; 0, the
     * default: full resolution.
     */
    uint32_t preview;
    /**
     * 1: keep the data that luxfer_stylize_update needs, about as much memory as all guides; 0, the default: free it.
     */
    uint32_t keep_for_update;
    /**
     * Share of the previous frame's paint that is kept where it fits, in [0, 1]; default 1. Below 1 the paint changes
     * from frame to frame ("boils"), as in hand-painted animation, if each frame has its own seed. It needs
     * luxfer_stylize_set_motion; without it, it has no effect.
     */
    float coherence;
    /**
     * How far the light guides of the exemplar are adapted to the brightness and contrast of the target's, in [0, 1];
     * default 0.
     */
    float match_appearance;
    /** Seed of the search; default 1. */
    uint64_t seed;
    /**
     * Factor of guide_weight on all levels but the finest, in [0, 1000]; default 4; the paper has 1. A larger factor
     * follows the guides more closely, with smaller connected pieces of the artwork.
     */
    float coarse_guides;
    /** Rounds on each level coarser than the second finest, in [1, 100]; default 24; the paper has 6. */
    uint32_t coarse_iterations;
    /**
     * Weight lambda of the usage of a patch in LUXFER_STYLIZE_MODE_OCCURRENCE, in [0, 10]; default 0.1, which Fiser et
     * al. found best by hand (Fig. 10n). It is the cost, in addition to the distance, of a match to a patch of average
     * usage. Both are in the unit of Eq. 1: squared differences of channels in [0, 1], summed over a patch. 0 is
     * LUXFER_STYLIZE_MODE_NEAREST.
     */
    float occurrence;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_stylize_params;

/** Presets between quality and speed: a LUXFER_STYLIZE_ preset. */
typedef int32_t luxfer_stylize_preset;

/** Full quality, the default. */
#define LUXFER_STYLIZE_FULL 0

/** Nearly the quality of LUXFER_STYLIZE_FULL in half the time. */
#define LUXFER_STYLIZE_FAST 1

/** Half resolution with compressed guides, for feedback while painting. */
#define LUXFER_STYLIZE_PREVIEW 2

/** The settings of the paper, for comparison. */
#define LUXFER_STYLIZE_PAPER 3

/** Exemplar patches are assigned to target patches under an error budget (Fiser et al. 2016), the default. */
#define LUXFER_STYLIZE_MODE_BUDGET 0

/** Every exemplar patch is used equally often (Jamriska et al. 2015). */
#define LUXFER_STYLIZE_MODE_UNIFORM 1

/** Each target patch takes its nearest exemplar patch (Wexler et al. 2007). */
#define LUXFER_STYLIZE_MODE_NEAREST 2

/** One pass in scan order (Hertzmann et al. 2001); runs on one thread. */
#define LUXFER_STYLIZE_MODE_GREEDY 3

/**
 * Each pixel takes the exemplar pixel with the nearest guides; with normals as guides this is the Lit Sphere (Sloan et
 * al. 2001).
 */
#define LUXFER_STYLIZE_MODE_LIT_SPHERE 4

/**
 * Each target patch takes its nearest exemplar patch, with a cost for patches that are used often (Kaspar et al.
 * 2015): see the field occurrence. Runs on one thread, and with LUXFER_STYLIZE_SEARCH_PATCHMATCH only.
 */
#define LUXFER_STYLIZE_MODE_OCCURRENCE 5

/** PatchMatch, the default. */
#define LUXFER_STYLIZE_SEARCH_PATCHMATCH 0

/** A k-d tree over the means of patches instead of PatchMatch. */
#define LUXFER_STYLIZE_SEARCH_TABLE 1

/** The mean of the overlapping patches. */
#define LUXFER_STYLIZE_VOTE_PLAIN 0

/** The mean of the overlapping patches, weighted so that closer matches count more. */
#define LUXFER_STYLIZE_VOTE_WEIGHTED 1

/** The colour of the patch that is nearest to the mean, so that every colour occurs in the artwork. */
#define LUXFER_STYLIZE_VOTE_NEAREST 2

/**
 * The artwork pixel that most of the overlapping patches place there, so that pieces of the artwork stay whole up to
 * their seams.
 */
#define LUXFER_STYLIZE_VOTE_MOST 3

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_stylize_params_init(luxfer_stylize_params *params,
                                         size_t size);

/**
 * Fills *params with a preset instead: LUXFER_STYLIZE_FULL, _FAST, _PREVIEW or _PAPER; size is sizeof *params.
 * LUXFER_INVALID_ARGUMENT for another value.
 */
luxfer_status luxfer_stylize_params_preset(luxfer_stylize_params *params,
                                           luxfer_stylize_preset preset,
                                           size_t size);

/* ====================================================================================================================
 * Stylisation
 *
 * Paints a target scene in the style in which an artist has painted an exemplar scene (StyLit). Set the artwork, add
 * the guides (pairs of images that show the light in the exemplar and in the target) and start. Or set a half-painted
 * picture and let the library paint the rest. While the job runs, and after a cancel, the picture of the finest
 * finished level can be read.
 *
 * Patents cover some of the methods in some countries, so a build of the library may leave stylisation out. Its
 * functions still exist in such a build, but luxfer_stylize_create returns LUXFER_UNSUPPORTED.
 * ==================================================================================================================== */

/** Flag of luxfer_stylize_add_guides: add the normals. */
#define LUXFER_GUIDES_WITH_NORMALS 1

/** Flag: add the edges, for shapes finer than the strokes. */
#define LUXFER_GUIDES_WITH_EDGES 2

/** Flag: add the colour code of materials, so that objects of a material are painted from objects of that material. */
#define LUXFER_GUIDES_WITH_MATERIALS 4

/** Flag: add the caustics, at the common exposure, for scenes in which glossy objects reflect light onto others. */
#define LUXFER_GUIDES_WITH_CAUSTICS 8

/** A stylisation. See luxfer_stylize_create. */
typedef struct luxfer_stylize luxfer_stylize;

/** Meaning of the values of a guide: a LUXFER_GUIDE_ value. */
typedef int32_t luxfer_guide_range;

/** Linear light >= 0, such as renderings; it is compared as it would look on a screen. */
#define LUXFER_GUIDE_LIGHT 0

/** Data, such as normals, object codes and edges; the common range of both images is scaled to [0, 1]. */
#define LUXFER_GUIDE_DATA 1

/**
 * Creates the stage. The caller releases *stylize. Any thread.
 * LUXFER_UNSUPPORTED if stylisation was left out of this build.
 */
luxfer_status luxfer_stylize_create(luxfer_context *context, luxfer_stylize **stylize);

/**
 * Sets the artwork: the exemplar scene as painted by the artist, in linear colour, 1, 3 or 4 channels, of the size of
 * the guides' sources and aligned with them. Any thread.
 */
luxfer_status luxfer_stylize_set_artwork(luxfer_stylize *stylize,
                                         luxfer_image *artwork);

/**
 * Adds a guide, or replaces the guide of that name. source shows the exemplar and target the scene to paint; both have
 * the same number of channels, at most 60 in all guides together. target may be NULL to use source for both, for a
 * half-painted picture (luxfer_stylize_set_painted). weight, in [0, 1e6], is relative to the other guides; range is a
 * LUXFER_GUIDE_ value. All sources must have one size, and all targets one size. Values that are not finite count as 0
 * in the target; pixels of the exemplar with such values are not used. Any thread.
 * LUXFER_INVALID_ARGUMENT if the channels differ, are too many, or a value is out of range.
 */
luxfer_status luxfer_stylize_add_guide(luxfer_stylize *stylize,
                                       const char *name,
                                       luxfer_image *source,
                                       luxfer_image *target,
                                       float weight,
                                       luxfer_guide_range range);

/**
 * Adds the rendered guides of two scenes. It adds the five light guides LUXFER_GUIDES_FULL to
 * LUXFER_GUIDES_TWO_BOUNCES at a common exposure, under the names "full", "direct", "specular", "indirect" and "two
 * bounces", each with weight 1. For each of the LUXFER_GUIDES_WITH_ flags in extras it adds the guide "caustics",
 * "normals", "edges" or "materials" with weight extra_weight. Any thread.
 * LUXFER_NOT_READY before both are rendered; LUXFER_INVALID_ARGUMENT if an argument is out of range.
 */
luxfer_status luxfer_stylize_add_guides(luxfer_stylize *stylize,
                                        luxfer_guides *source,
                                        luxfer_guides *target,
                                        uint32_t extras,
                                        float extra_weight);

/** Removes all guides. Any thread. */
luxfer_status luxfer_stylize_clear_guides(luxfer_stylize *stylize);

/**
 * Sets the pixels of the artwork that may be copied: those where mask is above 0.5; 1 channel, the artwork's size.
 * mask may be NULL: all pixels. Any thread.
 */
luxfer_status luxfer_stylize_set_source_mask(luxfer_stylize *stylize,
                                             luxfer_image *mask);

/**
 * Sets the pixels of the target to paint: those where mask is above 0.5; 1 channel, the size of the guides' targets.
 * The other pixels are taken from known (linear, with the number of channels of the artwork), and the new paint is
 * fitted to them; if known is NULL they are black. mask may be NULL: all pixels are painted. Any thread.
 */
luxfer_status luxfer_stylize_set_target_mask(luxfer_stylize *stylize,
                                             luxfer_image *mask,
                                             luxfer_image *known);

/**
 * Makes each job start from the previous result, for the frames of an animation. motion (2 channels, the size of the
 * guides' targets) holds for each pixel the offset to its position in the previous frame, x and y in pixels; NaN where
 * it was not visible. The paint of the previous frame moves along and stays where it fits; see
 * luxfer_stylize_params.coherence. motion may be NULL: each job starts from nothing. Any thread.
 */
luxfer_status luxfer_stylize_set_motion(luxfer_stylize *stylize,
                                        luxfer_image *motion);

/**
 * Starts a job that stylises. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if artwork or guides are missing or a job runs already; LUXFER_INVALID_ARGUMENT if a
 * setting is out of range; LUXFER_NOT_READY if motion is set and there is no previous result. The job may end with
 * LUXFER_INVALID_ARGUMENT if sizes differ or a side is above 32768 pixels, LUXFER_DEGENERATE if a mask is empty or
 * leaves no exemplar patch.
 */
luxfer_status luxfer_stylize_start(luxfer_stylize *stylize,
                                   const luxfer_stylize_params *params,
                                   luxfer_job **job);

/**
 * Starts a job that updates the picture after a change of the artwork. artwork has the size and channels of the first
 * artwork, and new paint where the 1-channel image changed is above 0.5; the pixels of the picture that were painted
 * from there are painted again. Takes a fraction of the time of luxfer_stylize_start. The caller releases *job. Any
 * thread.
 * LUXFER_INVALID_OPERATION unless a job with keep_for_update = 1 has succeeded, or if a job runs. The job may end with
 * LUXFER_INVALID_ARGUMENT if sizes differ. If an update is cancelled, the next update does the remaining work too.
 */
luxfer_status luxfer_stylize_update(luxfer_stylize *stylize,
                                    luxfer_image *artwork,
                                    luxfer_image *changed,
                                    luxfer_job **job);

/**
 * Lets the library paint the rest of a half-painted picture. The artwork is the picture; painted (1 channel, its size)
 * is above 0.5 where it is finished; the sources of the guides show its scene, and their targets are NULL. It is a
 * shorthand for painted as the source mask, its inverse as the target mask, and the artwork as known. Any thread.
 * LUXFER_INVALID_OPERATION before the artwork is set; LUXFER_INVALID_ARGUMENT if painted does not have its size or has
 * more than 1 channel.
 */
luxfer_status luxfer_stylize_set_painted(luxfer_stylize *stylize,
                                         luxfer_image *painted);

/* ====================================================================================================================
 * Results of a stylisation
 *
 * The picture, the source of each pixel in the artwork, the error of the guides, and statistics of the run level by
 * level.
 * ==================================================================================================================== */

/** An image of a stylisation: a LUXFER_STYLIZE_IMAGE_ value. */
typedef int32_t luxfer_stylize_image;

/** Quality of a stylisation. */
typedef struct luxfer_stylize_report {
    /** sizeof(luxfer_stylize_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** 1 if the run is complete; 0 if only `levels` levels are finished: then the fields from `used` on are 0. */
    uint32_t is_complete;
    /** Number of finished levels; see luxfer_stylize_get_level. */
    uint32_t levels;
    /** Number of times that the sides of the target were halved to get the size of the picture. */
    uint32_t halvings;
    /** Width of the patches, in pixels. */
    uint32_t patch;
    /** Largest number of uses of an exemplar patch. */
    uint32_t max_uses;
    /**
     * Mean squared difference of the channels, in [0, 1], of matched patches after the last round (Eq. 3). The
     * channels of the artwork have the weight 1 together, the guides guide_weight.
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
} luxfer_stylize_report;

/** One round of matching and painting. */
typedef struct luxfer_stylize_round {
    /** sizeof(luxfer_stylize_round), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of matching passes under the error budget; see luxfer_stylize_get_pass. */
    uint32_t passes;
    /** Energy after this round, as luxfer_stylize_report.energy. */
    double energy;
} luxfer_stylize_round;

/** One matching pass under the error budget. */
typedef struct luxfer_stylize_pass {
    /** sizeof(luxfer_stylize_pass), set by the function that fills the struct. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /**
     * Share of the exemplar patches whose match is within the error budget, in [0, 1]. The budget ends at the knee of
     * the error curve.
     */
    double knee;
    /** Share of the target with a match after this pass, in [0, 1]. */
    double coverage;
    /** Number of target patches that received a match in this pass. */
    uint64_t new_matches;
} luxfer_stylize_pass;

/**
 * The stylised target, linear, with the artwork's channels. Before the last level, in preview and after a cancel it is
 * smaller: the sides of the target are halved luxfer_stylize_report.halvings times, rounded down.
 */
#define LUXFER_STYLIZE_IMAGE_PICTURE 0

/**
 * Difference between the guides at each pixel and at the place in the exemplar from which it was painted, in [0, 1]; 1
 * channel. It is high where nothing in the exemplar fits.
 */
#define LUXFER_STYLIZE_IMAGE_GUIDE_ERROR 1

/**
 * Position in the artwork from which each pixel was painted, x and y in pixels; -1 where nothing was painted; 2
 * channels.
 */
#define LUXFER_STYLIZE_IMAGE_SOURCES 2

/**
 * Gets an image of the result; which is a LUXFER_STYLIZE_IMAGE_ value. luxfer_stylize_update changes the picture and
 * the sources only; the guide error remains that of the last full run. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before the first level of a job is finished; for images other than the picture, before the last
 * level is finished.
 */
luxfer_status luxfer_stylize_get_image(luxfer_stylize *stylize,
                                       luxfer_stylize_image which,
                                       luxfer_image **image);

/**
 * Gets the current quality of the result. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before the first level of a job is finished.
 */
luxfer_status luxfer_stylize_get_report(luxfer_stylize *stylize,
                                        luxfer_stylize_report *report,
                                        size_t size);

/**
 * Gets the size of a level and the number of its rounds; level 0 is the coarsest. width, height and rounds may be
 * NULL. Any thread.
 * LUXFER_NOT_READY before the first level of a job is finished; LUXFER_NOT_FOUND if there is no such level.
 */
luxfer_status luxfer_stylize_get_level(luxfer_stylize *stylize,
                                       uint32_t level,
                                       uint32_t *width,
                                       uint32_t *height,
                                       uint32_t *rounds);

/**
 * Describes a round of a level. size is sizeof *round. Any thread.
 * LUXFER_NOT_READY before the first level of a job is finished; LUXFER_NOT_FOUND if there is no such level or round.
 */
luxfer_status luxfer_stylize_get_round(luxfer_stylize *stylize,
                                       uint32_t level,
                                       uint32_t index,
                                       luxfer_stylize_round *round,
                                       size_t size);

/**
 * Describes a pass of a round. size is sizeof *pass. Any thread.
 * LUXFER_NOT_READY before the first level of a job is finished; LUXFER_NOT_FOUND if there is no such level, round or
 * pass.
 */
luxfer_status luxfer_stylize_get_pass(luxfer_stylize *stylize,
                                      uint32_t level,
                                      uint32_t round,
                                      uint32_t index,
                                      luxfer_stylize_pass *pass,
                                      size_t size);

/* ====================================================================================================================
 * Planning of stylisations
 *
 * Chooses the settings of a stylisation for a given time or error. A plan tries settings from fast to slow on the
 * actual input at reduced resolution, which takes a small part of the time of LUXFER_STYLIZE_FULL; the larger the
 * target, the smaller the part.
 * ==================================================================================================================== */

/**
 * Starts a job that plans a stylisation of the whole target with the current artwork, guides and masks of stylize. The
 * plan chooses only the numbers of rounds and sweeps; all other values, also the resolution, come from settings, or
 * the defaults if it is NULL. params gives the goal; the error is the square root of luxfer_stylize_report.energy: the
 * root mean square difference of matched patches in colours and guides, whose values are in [0, 1]. If the goal cannot
 * be reached, the plan gives the settings that come nearest. The caller releases *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if params is NULL, or has not one of its fields set, or a setting is out of range;
 * LUXFER_INVALID_OPERATION if artwork or guides are missing or a job runs already. The job may end with the statuses
 * of luxfer_stylize_start's job.
 */
luxfer_status luxfer_plan_start_stylize(luxfer_plan *plan,
                                        luxfer_stylize *stylize,
                                        const luxfer_stylize_params *settings,
                                        const luxfer_plan_params *params,
                                        luxfer_job **job);

/**
 * Gets the settings to stylise with: the given settings with the choices of the plan. Set params->struct_size before
 * the call. size is sizeof *params. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND unless the plan is of a stylisation.
 */
luxfer_status luxfer_plan_get_stylize_params(luxfer_plan *plan,
                                             luxfer_stylize_params *params,
                                             size_t size);

/* ====================================================================================================================
 * Print sheets
 *
 * For artists who paint on paper: prints the exemplar in pale colours between alignment marks, and aligns a photo or
 * scan of the painted sheet with the exemplar by these marks. These calls return when their work is done.
 * ==================================================================================================================== */

/** Settings of a print sheet. Fill them with luxfer_sheet_params_init; use equal settings for printing and aligning. */
typedef struct luxfer_sheet_params {
    /** sizeof(luxfer_sheet_params), set by luxfer_sheet_params_init. */
    uint32_t struct_size;
    /**
     * 1, the default: correct uneven lighting of the photo by the white of the marks, so that paper becomes 1; 0: no
     * correction.
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

/** Quality of the alignment of a photo. */
typedef struct luxfer_sheet_report {
    /** sizeof(luxfer_sheet_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of marks found, of 10; at least 6 are needed. */
    uint32_t marks;
    /**
     * Root mean square distance between the marks and their positions by to_photo, in pixels of the photo. More than
     * one or two pixels mean that the paper is not flat or that the lens distorts.
     */
    double residual;
    /** Expected alignment error in pixels of the picture. */
    double error;
    /** Homography from pixels of the picture to pixels of the photo, 3 x 3, row by row. */
    double to_photo[9];
} luxfer_sheet_report;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_sheet_params_init(luxfer_sheet_params *params,
                                       size_t size);

/**
 * Draws the sheet to print for a picture (linear, 1 is white; 1, 3 or 4 channels): in pale colours, as large as the
 * paper allows, with ten marks around it. Save it as PNG and print it at params->dpi without scaling. params may be
 * NULL for the defaults. The caller releases *sheet. Any thread.
 * LUXFER_INVALID_ARGUMENT if a setting is out of range or the paper is too small; LUXFER_OUT_OF_MEMORY beyond the
 * memory budget.
 */
luxfer_status luxfer_sheet_print(luxfer_image *picture,
                                 const luxfer_sheet_params *params,
                                 luxfer_image **sheet);

/**
 * Finds the marks in a photo or scan (linear RGB) of a sheet that was printed with equal params for a picture of
 * width x height pixels, and resamples it to that picture: the artwork, linear RGB. The photo may be rotated and in
 * perspective. params may be NULL for the defaults. size is sizeof *report; report may be NULL, then size does not
 * matter. Takes up to a few seconds. The caller releases *artwork. Any thread.
 * LUXFER_DEGENERATE if fewer than six marks are found; LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_sheet_align(luxfer_image *photo,
                                 uint32_t width,
                                 uint32_t height,
                                 const luxfer_sheet_params *params,
                                 luxfer_image **artwork,
                                 luxfer_sheet_report *report,
                                 size_t size);

/* ====================================================================================================================
 * Demonstration
 *
 * Scenes and artworks that the library generates itself, for examples and tests: equal to the bit every time, without
 * files.
 * ==================================================================================================================== */

/** A generated scene: a LUXFER_DEMO_ value. */
typedef int32_t luxfer_demo;

/** The style of a generated artwork: a LUXFER_ARTWORK_ value. */
typedef int32_t luxfer_artwork;

/** A furnished room without lights; its ceiling is the object "Ceiling". */
#define LUXFER_DEMO_TARGET_ROOM 0

/** An office under a grid of luminaires; camera 0 takes the photo. */
#define LUXFER_DEMO_EXEMPLAR_ROOM 1

/** A glossy red ball on a white table, for artists to paint: the exemplar of a stylisation. */
#define LUXFER_DEMO_SPHERE_ON_TABLE 2

/**
 * A vase, a ring and two balls on the table of LUXFER_DEMO_SPHERE_ON_TABLE under its lamp: a target for a stylisation.
 */
#define LUXFER_DEMO_STILL_LIFE 3

/** Hatching with a pen and two inks. */
#define LUXFER_ARTWORK_PEN 0

/** Dots of two inks. */
#define LUXFER_ARTWORK_STIPPLE 1

/** Oil on canvas. */
#define LUXFER_ARTWORK_PAINT 2

/**
 * Generates a scene; which is a LUXFER_DEMO_ value. The caller releases *scene. Any thread.
 * LUXFER_INVALID_ARGUMENT for another value; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_demo_create_scene(luxfer_context *context, luxfer_demo which, luxfer_scene **scene);

/**
 * Draws an artwork of a scene in place of an artist, of the size of its guides and aligned with them; designed for
 * LUXFER_DEMO_SPHERE_ON_TABLE; style is a LUXFER_ARTWORK_ value. Takes up to a few seconds. The caller releases
 * *image. Any thread.
 * LUXFER_INVALID_ARGUMENT for another value; LUXFER_NOT_READY before the guides are rendered.
 */
luxfer_status luxfer_demo_create_artwork(luxfer_guides *guides,
                                         luxfer_artwork style,
                                         luxfer_image **image);

/* ====================================================================================================================
 * Demonstration photo
 *
 * A photo of the generated office, as a camera would take it, and strokes on it, as a user would paint them: the input
 * of a lighting transfer without files.
 * ==================================================================================================================== */

/** A generator of the demonstration photo. See luxfer_demo_photo_create. */
typedef struct luxfer_demo_photo luxfer_demo_photo;

/** Settings of the photo. Fill them with luxfer_demo_photo_params_init. */
typedef struct luxfer_demo_photo_params {
    /** sizeof(luxfer_demo_photo_params), set by luxfer_demo_photo_params_init. */
    uint32_t struct_size;
    /** Width in pixels, in [16, 8192]; default 600. */
    uint32_t width;
    /** Height in pixels, in [16, 8192]; default 400. The camera is designed for an aspect ratio of 3:2. */
    uint32_t height;
    /** Paths per pixel, in [2, 1048576]; default 12, which leaves some noise. */
    uint32_t samples;
    /** Seed of the paths and the noise; default 1. */
    uint64_t seed;
} luxfer_demo_photo_params;

/** An image of the demonstration photo: a LUXFER_DEMO_PHOTO_ value. */
typedef int32_t luxfer_demo_photo_image;

/** The photo: linear RGB, 1 = display white; its lamps are clipped. */
#define LUXFER_DEMO_PHOTO_PICTURE 0

/** The strokes on it, in the colours of luxfer_strokes_add_image. */
#define LUXFER_DEMO_PHOTO_STROKES 1

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_demo_photo_params_init(luxfer_demo_photo_params *params,
                                            size_t size);

/** Creates the stage. The caller releases *demo. Any thread. */
luxfer_status luxfer_demo_photo_create(luxfer_context *context, luxfer_demo_photo **demo);

/**
 * Starts a job that renders the photo. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if a job runs already; LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_demo_photo_start(luxfer_demo_photo *demo,
                                      const luxfer_demo_photo_params *params,
                                      luxfer_job **job);

/**
 * Gets an image; which is a LUXFER_DEMO_PHOTO_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_demo_photo_get_image(luxfer_demo_photo *demo,
                                          luxfer_demo_photo_image which,
                                          luxfer_image **image);
#ifdef __cplusplus
}
#endif

#endif /* LUXFER_H */
