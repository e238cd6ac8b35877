/* luxfer: lighting from one photo onto a 3D scene.
 *
 * This file is generated from src/ffi by tests/abi_header.rs. It needs C99 or C++11 and nothing but the standard headers.
 *
 * In short: create a context; make objects in it; start a stage, which gives a job; wait for the job, which may report
 * progress to you; read the results; release everything, in any order.
 *
 *     luxfer_context *context = NULL;
 *     luxfer_image *photo = NULL;
 *     if (luxfer_context_create(NULL, &context) != LUXFER_OK) return 1;
 *     if (luxfer_image_load(context, "photo.jpg", LUXFER_COLOUR_SRGB, &photo) != LUXFER_OK) {
 *         char message[512];
 *         luxfer_context_last_error(context, message, sizeof message, NULL);
 *         fprintf(stderr, "%s\n", message);
 *     }
 *     luxfer_image_release(photo);
 *     luxfer_context_release(context);
 *
 * Units: metres, radians, right-handed, Y up. Colours are scene-linear Rec.709; where light is photometric its luminance
 * is in cd/m², illuminance in lux, flux in lumens.
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
 * The macros say what this header was made for, the functions what library is loaded. Before 1.0 libraries of one minor
 * version are compatible (libluxfer.so.0.1); from 1.0 on those of one major version.
 *
 * A program that meets its library at run time (dlopen, a folder of plug-ins) asks at its start whether
 * luxfer_version() / 100 == LUXFER_VERSION / 100; from 1.0 on, whether the two are equal when divided by 10000 and the
 * library is not the older one. luxfer::Context::create of bindings/cpp does.
 * ==================================================================================================================== */

/** The version of this header. */
#define LUXFER_VERSION_MAJOR 0
#define LUXFER_VERSION_MINOR 1
#define LUXFER_VERSION_PATCH 0

/** The version of this header as one number, comparable with luxfer_version(). */
#define LUXFER_VERSION (10000 * LUXFER_VERSION_MAJOR + 100 * LUXFER_VERSION_MINOR + LUXFER_VERSION_PATCH)

/** The version of the loaded library, comparable with LUXFER_VERSION. Any thread. */
uint32_t luxfer_version(void);

/** The version of the loaded library as text, such as "0.1.0". The string is static: never free it. Any thread. */
const char *luxfer_version_string(void);

/* ====================================================================================================================
 * Status
 *
 * Every function that can fail returns a luxfer_status. Values are never changed or reused; new ones may be added.
 * Outputs are written only when LUXFER_OK is returned. luxfer_context_last_error says in words what went wrong.
 * ==================================================================================================================== */

/** The result of a call: LUXFER_OK, or why it failed. */
typedef int32_t luxfer_status;

/** Success. */
#define LUXFER_OK 0

/** A cause that has no status of its own. */
#define LUXFER_UNKNOWN 1

/** A parameter is NULL, out of range, of the wrong kind or from another context, or contradicts another. */
#define LUXFER_INVALID_ARGUMENT 2

/** The call is not allowed in the object's present state: a job is still running on it, or an input is missing. */
#define LUXFER_INVALID_OPERATION 3

/** The memory budget of the context, or the machine, is used up. */
#define LUXFER_OUT_OF_MEMORY 4

/** The file or the request is valid, but uses something this library does not do. */
#define LUXFER_UNSUPPORTED 5

/** The job was cancelled by the caller. */
#define LUXFER_CANCELLED 6

/** The operating system could not read or write a file, or the caller's writer refused. */
#define LUXFER_IO 7

/** A file is truncated, corrupt, or not what it claims to be. */
#define LUXFER_FORMAT 8

/** A result was asked for before the job that makes it has succeeded, or a wait timed out. */
#define LUXFER_NOT_READY 9

/** A defect in this library: please report it. */
#define LUXFER_INTERNAL 10

/** The input is well formed but has no answer: no lines, a plane seen edge-on, strokes of one class only. */
#define LUXFER_DEGENERATE 11

/** No surface, image or entry has the given name or index. */
#define LUXFER_NOT_FOUND 12

/** No light can reach the target: no path, a channel fully absorbed, or negative light would be needed. */
#define LUXFER_UNREACHABLE 13

/**
 * The name of a status, such as "LUXFER_FORMAT"; "LUXFER_UNKNOWN" for a number that is none. The string is static:
 * never free it. Any thread.
 */
const char *luxfer_status_name(luxfer_status status);

/* ====================================================================================================================
 * Context
 *
 * A context owns the threads that do the work, a memory budget and the error messages. All other objects are made in a
 * context and keep it alive, so objects may be released in any order; objects of two contexts cannot be mixed
 * (LUXFER_INVALID_ARGUMENT).
 *
 * Handles, of every kind: X_retain adds a reference, X_release gives one back; the last one frees the object. Releasing
 * NULL does nothing. A handle is checked on entry: NULL, a handle of another kind or one released before is
 * LUXFER_INVALID_ARGUMENT, as far as the memory behind it still shows it.
 *
 * Threads: different objects may be used from different threads at the same time, and so may one object; calls that
 * change it take turns. Only the release of the last reference must not overlap any other use.
 *
 * The library has no global state, prints nothing, reads no environment variables, never ends the process and installs
 * no handlers. With equal inputs, parameters and seeds results are equal to the bit, whatever the number of threads and
 * whatever floating-point mode (rounding, flush to zero) the host is in: calls work in the standard mode, so do callbacks
 * they make, and hand the host's back.
 * ==================================================================================================================== */

/** A context: threads, memory budget and error messages. See luxfer_context_create. */
typedef struct luxfer_context luxfer_context;

/** How a context is set up. Fill it with luxfer_context_params_init. */
typedef struct luxfer_context_params {
    /** sizeof(luxfer_context_params), set by luxfer_context_params_init. */
    uint32_t struct_size;
    /** Number of worker threads in [0, 1024]; 0, the default, is one for each core the process may use. */
    uint32_t num_threads;
    /**
     * Limit in MiB for the pixels, meshes and textures of all objects the caller makes in this context; what exceeds it
     * is LUXFER_OUT_OF_MEMORY. 0, the default, is no limit. Working memory of a job and its results are not counted.
     */
    uint64_t memory_budget_mib;
} luxfer_context_params;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is not that
 * of any version of the struct.
 */
luxfer_status luxfer_context_params_init(luxfer_context_params *params,
                                         size_t size);

/**
 * Creates a context and its threads; params may be NULL for the defaults. The caller releases *context. Any thread.
 * LUXFER_INVALID_ARGUMENT if context is NULL, struct_size is wrong or num_threads exceeds 1024; LUXFER_OUT_OF_MEMORY if
 * the threads cannot be started.
 */
luxfer_status luxfer_context_create(const luxfer_context_params *params,
                                    luxfer_context **context);

/** Adds a reference. Any thread. */
luxfer_status luxfer_context_retain(luxfer_context *context);

/**
 * Gives a reference back. The threads end, and are waited for, when the context and everything made in it are released.
 * Any thread.
 */
luxfer_status luxfer_context_release(luxfer_context *context);

/**
 * Copies the message of the calling thread's latest failure in this context into buffer, as UTF-8 that ends with a zero,
 * cut if it does not fit into capacity bytes. *needed, unless NULL, becomes the capacity for all of it. Without a failure
 * the message is empty. Messages stay until the thread's next failure; those of the last 256 threads are kept. buffer may
 * be NULL if capacity is 0. A call that fails because its first handle is no handle leaves no message. Any thread.
 */
luxfer_status luxfer_context_last_error(luxfer_context *context,
                                        char *buffer,
                                        size_t capacity,
                                        size_t *needed);

/* ====================================================================================================================
 * Image
 *
 * An image holds 32-bit floating-point samples: scene-linear Rec.709 colour (D65 white), or data. Rows run downwards.
 * Images never change after they are made, so results are shared and not copied. The caller's pixels are described by a
 * view; the library never keeps a pointer to them. Sides are at most 65536 pixels.
 * ==================================================================================================================== */

/** Flag of a view: the first row in memory is the bottom one. */
#define LUXFER_VIEW_BOTTOM_UP 1

/** An image. See luxfer_image_create. */
typedef struct luxfer_image luxfer_image;

/** How a sample is stored: a LUXFER_SAMPLE_ value, in the machine's byte order. */
typedef int32_t luxfer_sample;

/** What the numbers mean: a LUXFER_COLOUR_ value. */
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
    /** LUXFER_VIEW_ flags, or 0, the default. Unknown flags are refused. */
    uint32_t flags;
    /** Must be 0. */
    uint32_t reserved;
    /** Bytes from a pixel to the next; at least the pixel's size, or 0, the default: packed. */
    size_t pixel_stride;
    /** Bytes from a row to the next; at least the row's size, or 0, the default: packed. */
    size_t row_stride;
    /** Bytes at data that may be accessed; what the layout needs beyond is LUXFER_INVALID_ARGUMENT. To be set. */
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

/** Scene-linear Rec.709, or data that is no colour. */
#define LUXFER_COLOUR_LINEAR 0

/** Colour encoded with the sRGB curve; the second of two and the fourth of four channels is alpha, which is linear. */
#define LUXFER_COLOUR_SRGB 1

/**
 * Fills *view with the defaults; size is sizeof *view. LUXFER_INVALID_ARGUMENT if view is NULL or size is not that of any
 * version of the struct.
 */
luxfer_status luxfer_image_view_init(luxfer_image_view *view,
                                     size_t size);

/**
 * Creates an image from a copy of the caller's pixels; integers and sRGB are decoded, NaN and infinities kept. The caller
 * releases *image. Any thread.
 * LUXFER_INVALID_ARGUMENT if the view contradicts itself; LUXFER_OUT_OF_MEMORY beyond the context's memory budget.
 */
luxfer_status luxfer_image_create(luxfer_context *context,
                                  const luxfer_image_view *view,
                                  luxfer_image **image);

/**
 * Loads a PNG, JPEG, Radiance HDR or OpenEXR file; path is UTF-8. colour_space says how integer samples are encoded:
 * LUXFER_COLOUR_SRGB for pictures, LUXFER_COLOUR_LINEAR for data such as masks and depth; files with floating-point
 * samples are linear. The caller releases *image. Any thread.
 * LUXFER_IO if the file cannot be read, LUXFER_FORMAT if it is damaged or of another format, LUXFER_UNSUPPORTED if an
 * OpenEXR file has neither R, G, B nor a single channel, LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_image_load(luxfer_context *context,
                                const char *path,
                                luxfer_colour_space colour_space,
                                luxfer_image **image);

/** Loads an image from the size bytes of a file held in memory, otherwise as luxfer_image_load. */
luxfer_status luxfer_image_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       luxfer_colour_space colour_space,
                                       luxfer_image **image);

/**
 * Saves an image; path is UTF-8 and its extension chooses the format. .png: 1, 3 or 4 channels, multiplied by exposure
 * (> 0, finite; 1 shows the value 1 as white), clamped to [0, 1] and encoded as 8-bit sRGB. .exr: up to 64 channels as
 * they are, in 32-bit floating point; exposure is not used. An existing file is replaced only by a complete one. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT for another extension or number of channels; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_image_save(luxfer_image *image,
                                const char *path,
                                float exposure);

/** Tells width and height in pixels and the number of channels; any of the three may be NULL. Any thread. */
luxfer_status luxfer_image_size(luxfer_image *image,
                                uint32_t *width,
                                uint32_t *height,
                                uint32_t *channels);

/**
 * Writes an image into the caller's pixels. The view must have the image's size; if the image has more channels than the
 * view, those from first_channel on are written. Integers are clamped to their range and rounded, NaN becomes 0 in them.
 * Any thread.
 * LUXFER_INVALID_ARGUMENT if the view contradicts itself or the image.
 */
luxfer_status luxfer_image_read(luxfer_image *image,
                                uint32_t first_channel,
                                const luxfer_image_view *view);

/** Adds a reference. Any thread. */
luxfer_status luxfer_image_retain(luxfer_image *image);

/** Gives a reference back. Any thread. */
luxfer_status luxfer_image_release(luxfer_image *image);

/* ====================================================================================================================
 * Job
 *
 * Long work is started with X_start, which returns a job at once; it runs on threads of the library. Inputs are taken as
 * they are at the start: changing or releasing them later does not affect the job. While a job runs its object refuses
 * changes and further jobs (LUXFER_INVALID_OPERATION). Results are read from the object after the job has succeeded.
 * Releasing the last reference to a job that runs cancels it and waits for it to end.
 * ==================================================================================================================== */

/** Work in progress. See luxfer_job_wait. */
typedef struct luxfer_job luxfer_job;

/**
 * Told how far a job is: fraction rises from 0, never falls, and is exactly 1 once, last, and only after success. Returns
 * 0 to go on, anything else to cancel the job. Called about 50 times a second, only on the thread that is inside
 * luxfer_job_wait and with no lock held, so any luxfer function may be called from it. Must not throw or jump out.
 */
typedef int32_t (*luxfer_progress_fn)(void *user, double fraction);

/**
 * Waits until a job has ended, or timeout_ms milliseconds have passed; a negative timeout_ms waits without limit. progress
 * may be NULL; user is handed to it. Any thread, several at once.
 *
 * Returns LUXFER_OK if the job has succeeded, else why it has not, with its message: LUXFER_CANCELLED after a cancel
 * request that came in time, LUXFER_NOT_READY only if it still runs (it goes on running).
 */
luxfer_status luxfer_job_wait(luxfer_job *job,
                              int32_t timeout_ms,
                              luxfer_progress_fn progress,
                              void *user);

/**
 * Asks how far a job is, without waiting. *fraction becomes its progress in [0, 1], *finished 1 if it has ended, well or
 * not, else 0; either may be NULL. Any thread.
 */
luxfer_status luxfer_job_poll(luxfer_job *job,
                              double *fraction,
                              int32_t *finished);

/** How a job has ended, as luxfer_job_wait returns it; LUXFER_NOT_READY while it runs. Any thread. */
luxfer_status luxfer_job_status(luxfer_job *job);

/**
 * Asks a job to end early, and returns at once; the work ends within about 100 ms. A request cannot be taken back; one
 * that comes after the end has no effect. Any thread.
 */
luxfer_status luxfer_job_cancel(luxfer_job *job);

/** Adds a reference. Any thread. */
luxfer_status luxfer_job_retain(luxfer_job *job);

/** Gives a reference back; the last one cancels a running job and waits for it to end. Any thread. */
luxfer_status luxfer_job_release(luxfer_job *job);

/* ====================================================================================================================
 * Scene
 *
 * A scene is what the host describes: meshes, materials, textures, lights, cameras. Metres, right-handed, Y up, all in
 * world space. Emission is in cd/m², punctual lights in candela and lux as in glTF 2.0. A job works on the scene as it
 * was at the start of the job. Calls that change a scene take turns; each either succeeds or leaves it as it was.
 * ==================================================================================================================== */

/** A scene. See luxfer_scene_load and luxfer_scene_create. */
typedef struct luxfer_scene luxfer_scene;

/**
 * Takes size bytes of a file that is being written; called one or more times, in order, on the calling thread with no
 * lock held. Returns 0 to go on, anything else to give up: the export then returns LUXFER_IO. Must not throw or jump out.
 */
typedef int32_t (*luxfer_write_fn)(void *user, const void *data, size_t size);

/** How much there is in a scene. Set struct_size before the call. */
typedef struct luxfer_scene_counts {
    /** sizeof(luxfer_scene_counts), set by the caller. */
    uint32_t struct_size;
    /** Number of meshes, whose indices are 0 to meshes - 1; so with what follows. */
    uint32_t meshes;
    /** Number of materials. */
    uint32_t materials;
    /** Number of textures. */
    uint32_t textures;
    /** Number of lights without a surface. */
    uint32_t lights;
    /** Number of cameras. */
    uint32_t cameras;
    /** Triangles of all meshes. */
    uint64_t triangles;
} luxfer_scene_counts;

/** A planar surface of a scene. Set struct_size before the call. */
typedef struct luxfer_surface {
    /** sizeof(luxfer_surface), set by the caller. */
    uint32_t struct_size;
    /** Number of its triangles. */
    uint32_t triangles;
    /** Corner of its bounding rectangle where u = v = 0, in metres. */
    float origin[3];
    /** Unit direction of u, along the first side of the rectangle. */
    float u_axis[3];
    /** Unit direction of v, along the second side. */
    float v_axis[3];
    /** Unit normal on the side that will emit: into the room. */
    float normal[3];
    /** Lengths of the sides along u and v, in metres. */
    float size[2];
    /** Area of the triangles in m². */
    float area;
    /**
     * Area of what was named besides and slopes from this plane by 5 to 75 degrees, in m²: as of a vault, which gets no light.
     */
    float bent;
} luxfer_surface;

/** Creates an empty scene. The caller releases *scene. Any thread. */
luxfer_status luxfer_scene_create(luxfer_context *context, luxfer_scene **scene);

/**
 * Loads a glTF 2.0 file, .glb or .gltf with the files it names; path is UTF-8. The caller releases *scene. Any thread.
 * LUXFER_IO if a file cannot be read, LUXFER_FORMAT if one is damaged or refers to what is not there, LUXFER_UNSUPPORTED
 * for a required extension this library does not know, LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_load(luxfer_context *context,
                                const char *path,
                                luxfer_scene **scene);

/**
 * Loads a scene from the size bytes of a GLB or glTF file held in memory. Other files that it names are looked up in the
 * folder base_path (UTF-8); NULL allows none. Otherwise as luxfer_scene_load.
 */
luxfer_status luxfer_scene_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       const char *base_path,
                                       luxfer_scene **scene);

/**
 * Saves a scene as a GLB file with all of its textures inside; path is UTF-8 and ends in .glb. An existing file is
 * replaced only by a complete one. Any thread.
 * LUXFER_INVALID_ARGUMENT for another ending; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_scene_export(luxfer_scene *scene,
                                  const char *path);

/**
 * Writes a scene as GLB through the caller's function, which gets user. Any thread.
 * LUXFER_IO if the function gives up.
 */
luxfer_status luxfer_scene_export_memory(luxfer_scene *scene, luxfer_write_fn write, void *user);

/** Tells how much there is in a scene. Any thread. */
luxfer_status luxfer_scene_get_counts(luxfer_scene *scene, luxfer_scene_counts *counts);

/**
 * Surrounds a scene with light of one colour from all directions, red, green and blue in cd/m², each finite and >= 0;
 * replaces any environment it had. Any thread.
 */
luxfer_status luxfer_scene_set_environment(luxfer_scene *scene,
                                           float red,
                                           float green,
                                           float blue);

/**
 * Surrounds a scene with the light of an equirectangular image, linear, times (red, green, blue), each finite and >= 0:
 * radiance in cd/m², chosen in proportion to its brightness while tracing. The image's centre lies towards -z, its top
 * towards +y, its right quarter towards +x; it is copied, and replaces any environment there was. Any thread.
 * LUXFER_INVALID_ARGUMENT if the image has values that are negative or not finite; LUXFER_OUT_OF_MEMORY beyond the memory
 * budget.
 */
luxfer_status luxfer_scene_set_environment_image(luxfer_scene *scene,
                                                 luxfer_image *image,
                                                 float red,
                                                 float green,
                                                 float blue);

/**
 * Sets the emission of a material, which multiplies its emission texture if it has one: red, green and blue in cd/m², each
 * finite and >= 0. Any thread.
 * LUXFER_NOT_FOUND if there is no such material.
 */
luxfer_status luxfer_scene_set_emission(luxfer_scene *scene,
                                        uint32_t material,
                                        float red,
                                        float green,
                                        float blue);

/**
 * Finds the planar surface, of the object or material of that name, that faces the room; name is UTF-8. Any thread.
 * LUXFER_NOT_FOUND if nothing has that name, the message lists names that exist; LUXFER_DEGENERATE if it has no plane.
 */
luxfer_status luxfer_scene_find_surface(luxfer_scene *scene,
                                        const char *name,
                                        luxfer_surface *found);

/**
 * Lays an emissive texture (linear, 1 or 3 channels) over the bounding rectangle of the surface that luxfer_scene_find_surface
 * finds by name. The surface becomes a mesh of its own, *mesh, with a copy of its material, *material, that emits
 * texture * (red, green, blue) in cd/m², each finite and >= 0. mesh and material may be NULL. Any thread.
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

/** Adds a reference. Any thread. */
luxfer_status luxfer_scene_retain(luxfer_scene *scene);

/** Gives a reference back. Any thread. */
luxfer_status luxfer_scene_release(luxfer_scene *scene);

/* ====================================================================================================================
 * Materials
 *
 * What surfaces are made of, as in glTF 2.0: metallic-roughness, with clear glass, cut-outs, emission, and textures that
 * multiply these. All can be read back and replaced; textures stay with the material when its numbers change.
 * ==================================================================================================================== */

/** What the alpha of a surface means: a LUXFER_ALPHA_ value. */
typedef int32_t luxfer_alpha_mode;

/** A material: metallic-roughness, as in glTF 2.0. Fill it with luxfer_material_params_init. */
typedef struct luxfer_material_params {
    /** sizeof(luxfer_material_params), set by luxfer_material_params_init. */
    uint32_t struct_size;
    /** Whether back faces reflect and emit as front faces do: 0 or 1, the default. */
    uint32_t double_sided;
    /** Name in UTF-8, copied; NULL, the default, is none. */
    const char *name;
    /** Linear colour of the surface, each in [0, 1]; default 0.8. */
    float base_color[3];
    /** In [0, 1]; default 0. */
    float metallic;
    /** Perceptual roughness in [0, 1]; default 1. */
    float roughness;
    /** Emitted luminance per channel in cd/m², >= 0; default 0. */
    float emission[3];
    /** Share of light that passes through instead of being reflected diffusely, in [0, 1]; default 0. */
    float transmission;
    /** Index of refraction in [1, 4]; default 1.5. */
    float ior;
    /** In [0, 1], multiplies the alpha of the base colour's texture; default 1. */
    float alpha;
    /** LUXFER_ALPHA_ value; default LUXFER_ALPHA_OPAQUE. */
    luxfer_alpha_mode alpha_mode;
    /** For LUXFER_ALPHA_MASK, >= 0; default 0.5. */
    float alpha_cutoff;
    /** How far the normal texture bends: multiplies its x and y; finite; default 1. */
    float normal_scale;
} luxfer_material_params;

/** How a texture continues beyond its edges: a LUXFER_WRAP_ value. */
typedef int32_t luxfer_wrap;

/** What a material uses a texture for: a LUXFER_TEXTURE_ value. */
typedef int32_t luxfer_texture_role;

/** A texture as a material uses it. Set struct_size before the call. */
typedef struct luxfer_texture_use {
    /** sizeof(luxfer_texture_use), set by the caller. */
    uint32_t struct_size;
    /** Index of the texture; LUXFER_NONE if there is none, and what follows is 0. */
    uint32_t texture;
    /** Which of the mesh's sets of texture coordinates it is looked up with, 0 or 1. */
    uint32_t uv_set;
    /** LUXFER_WRAP_ value, along u. */
    luxfer_wrap wrap_u;
    /** LUXFER_WRAP_ value, along v. */
    luxfer_wrap wrap_v;
    /** Two rows of three, applied to (u, v, 1) before the look-up. */
    float transform[6];
} luxfer_texture_use;

/** Nothing: it is there everywhere. */
#define LUXFER_ALPHA_OPAQUE 0

/** It is there where alpha is at least alpha_cutoff. */
#define LUXFER_ALPHA_MASK 1

/** That share of light meets it, the rest finds nothing in its way. */
#define LUXFER_ALPHA_BLEND 2

/** Multiplies the base colour; its alpha multiplies the material's. */
#define LUXFER_TEXTURE_BASE_COLOR 0

/** Green multiplies the roughness, blue the metallic share. */
#define LUXFER_TEXTURE_METALLIC_ROUGHNESS 1

/** Normals in tangent space. */
#define LUXFER_TEXTURE_NORMAL 2

/** Multiplies the emission; looked up without interpolation. */
#define LUXFER_TEXTURE_EMISSION 3

/** It repeats. */
#define LUXFER_WRAP_REPEAT 0

/** Its border goes on. */
#define LUXFER_WRAP_CLAMP 1

/** It repeats, every other one mirrored. */
#define LUXFER_WRAP_MIRROR 2

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_material_params_init(luxfer_material_params *params,
                                          size_t size);

/**
 * Adds a material; *index, unless NULL, becomes its index. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_material(luxfer_scene *scene,
                                        const luxfer_material_params *params,
                                        uint32_t *index);

/**
 * Replaces the numbers of a material; its textures stay, and so does its name if params->name is NULL. params may be NULL
 * for the defaults. To change some of them, read the material first. Any thread.
 * LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_set_material(luxfer_scene *scene,
                                        uint32_t index,
                                        const luxfer_material_params *params);

/**
 * Reads a material; set params->struct_size before the call. Its name becomes NULL. Any thread.
 * LUXFER_NOT_FOUND if there is no such material.
 */
luxfer_status luxfer_scene_get_material(luxfer_scene *scene,
                                        uint32_t index,
                                        luxfer_material_params *params);

/**
 * Adds a texture: an image in linear values of 1, 3 or 4 channels, the fourth alpha; wrap_u and wrap_v are LUXFER_WRAP_
 * values. It is copied. *index, unless NULL, becomes its index. Any thread.
 * LUXFER_INVALID_ARGUMENT if the image has 2 channels or values that are not finite; LUXFER_OUT_OF_MEMORY beyond the
 * memory budget.
 */
luxfer_status luxfer_scene_add_texture(luxfer_scene *scene,
                                       luxfer_image *image,
                                       luxfer_wrap wrap_u,
                                       luxfer_wrap wrap_v,
                                       uint32_t *index);

/**
 * Makes a material use a texture for a purpose; role is a LUXFER_TEXTURE_ value, texture an index, or LUXFER_NONE for no
 * texture. uv_set is 0 or 1: which of the mesh's sets of texture coordinates. transform is two rows of three, finite,
 * applied to (u, v, 1) before the look-up; NULL changes nothing. Any thread.
 * LUXFER_NOT_FOUND if there is no such material or texture; LUXFER_INVALID_ARGUMENT for another role or set, or if a
 * texture of emission has negative values.
 */
luxfer_status luxfer_scene_set_material_texture(luxfer_scene *scene,
                                                uint32_t material,
                                                luxfer_texture_role role,
                                                uint32_t texture,
                                                uint32_t uv_set,
                                                const float *transform);

/**
 * Tells which texture a material uses for a purpose, and how; role is a LUXFER_TEXTURE_ value. Any thread.
 * LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT for another role.
 */
luxfer_status luxfer_scene_get_material_texture(luxfer_scene *scene,
                                                uint32_t material_index,
                                                luxfer_texture_role role,
                                                luxfer_texture_use *texture_use);

/**
 * Gets a texture as an image, linear. The caller releases *image. Any thread.
 * LUXFER_NOT_FOUND if there is no such texture.
 */
luxfer_status luxfer_scene_get_texture(luxfer_scene *scene, uint32_t index, luxfer_image **image);

/* ====================================================================================================================
 * Scene description
 *
 * Scenes can be described by the host's own arrays: materials first, then the meshes that use them, then cameras. Arrays
 * are copied during the call, from any alignment and with any stride.
 * ==================================================================================================================== */

/** A triangle mesh in world space. Fill it with luxfer_mesh_params_init. */
typedef struct luxfer_mesh_params {
    /** sizeof(luxfer_mesh_params), set by luxfer_mesh_params_init. */
    uint32_t struct_size;
    /** Index of its material, as luxfer_scene_add_material has returned it; default 0. */
    uint32_t material;
    /** Name in UTF-8, copied; surfaces are found by it. NULL, the default, is none. */
    const char *name;
    /** Number of vertices in [3, 2^32 - 1]; to be set. */
    size_t vertex_count;
    /** Three floats for each vertex, in metres, in [-1e15, 1e15]; to be set. */
    const void *positions;
    /** Bytes from a position to the next; at least 12, or 0, the default: packed. */
    size_t position_stride;
    /** Three floats for each vertex, finite; NULL, the default: faces are flat. */
    const void *normals;
    /** Bytes from a normal to the next; at least 12, or 0, the default: packed. */
    size_t normal_stride;
    /** Two floats for each vertex, finite, (0, 0) the top-left corner of a texture; NULL, the default: none. */
    const void *uvs;
    /** Bytes from a pair of texture coordinates to the next; at least 8, or 0, the default: packed. */
    size_t uv_stride;
    /** Number of triangles, at least 1; to be set. */
    size_t triangle_count;
    /** Three uint32_t for each triangle, each below vertex_count, counter-clockwise seen from the front; to be set. */
    const void *indices;
    /** Bytes from a triangle to the next; at least 12, or 0, the default: packed. */
    size_t index_stride;
} luxfer_mesh_params;

/** A pinhole camera. Fill it with luxfer_camera_params_init. */
typedef struct luxfer_camera_params {
    /** sizeof(luxfer_camera_params), set by luxfer_camera_params_init. */
    uint32_t struct_size;
    /** Full vertical angle of view in radians, in [0.001, 3.1]; default 1. */
    float fov_y;
    /** Where it stands, in metres, in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /** What it looks at, another point, in [-1e15, 1e15]; default (0, 0, -1). */
    float target[3];
    /** Direction that is up in the image, not along the view; default (0, 1, 0). */
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
 * Adds a mesh, copying its arrays; *index, unless NULL, becomes its index. Any thread.
 * LUXFER_INVALID_ARGUMENT if an array is missing, a stride too small, a number not finite or an index out of range;
 * LUXFER_NOT_FOUND if the scene has no such material; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_add_mesh(luxfer_scene *scene,
                                    const luxfer_mesh_params *params,
                                    uint32_t *index);

/**
 * Adds a camera; *index, unless NULL, becomes its index. params may be NULL for the defaults. Any thread.
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
 * Reads a camera; set params->struct_size before the call. Any thread.
 * LUXFER_NOT_FOUND if there is no such camera.
 */
luxfer_status luxfer_scene_get_camera(luxfer_scene *scene,
                                      uint32_t index,
                                      luxfer_camera_params *params);

/* ====================================================================================================================
 * Luminous intensity distributions
 *
 * What a luminaire sends out in which direction, from and to IES (LM-63) and EULUMDAT files. These calls return when they
 * are done.
 * ==================================================================================================================== */

/** A luminous intensity distribution. See luxfer_distribution_load. */
typedef struct luxfer_distribution luxfer_distribution;

/** A file format of distributions: a LUXFER_DISTRIBUTION_ value. */
typedef int32_t luxfer_distribution_format;

/** A distribution on the whole. Set struct_size before the call. */
typedef struct luxfer_distribution_report {
    /** sizeof(luxfer_distribution_report), set by the caller. */
    uint32_t struct_size;
    /** C planes. */
    uint32_t planes;
    /** Vertical angles of each plane. */
    uint32_t angles;
    /** 0. */
    uint32_t reserved;
    /** Luminous flux in lumens: the intensity over all directions. */
    double flux;
    /** Rated flux of its lamps in lumens; 0 if the file states none (absolute photometry). */
    double lamp_flux;
    /** Electric power in watts; 0 if not known. */
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
 * LUXFER_IO if the file cannot be read, LUXFER_FORMAT, with the line, if it is malformed, LUXFER_UNSUPPORTED for types A and
 * B of IES, LUXFER_INVALID_ARGUMENT for another extension.
 */
luxfer_status luxfer_distribution_load(luxfer_context *context,
                                       const char *path,
                                       luxfer_distribution **distribution);

/**
 * Loads from the size bytes of a file held in memory; format is a LUXFER_DISTRIBUTION_ value. Otherwise as
 * luxfer_distribution_load.
 */
luxfer_status luxfer_distribution_load_memory(luxfer_context *context,
                                              const void *data,
                                              size_t size,
                                              luxfer_distribution_format format,
                                              luxfer_distribution **distribution);

/**
 * Saves to an .ies or .ldt file; path is UTF-8. An existing file is replaced only by a complete one. Any thread.
 * LUXFER_INVALID_ARGUMENT for another extension, LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_distribution_save(luxfer_distribution *distribution,
                                       const char *path);

/** Tells the distribution on the whole. Any thread. */
luxfer_status luxfer_distribution_get_report(luxfer_distribution *distribution,
                                             luxfer_distribution_report *report);

/**
 * Copies the luminaire's name, zero-terminated, into buffer of capacity bytes, cut if it is longer. *needed, unless NULL,
 * receives the capacity for all of it. Any thread.
 */
luxfer_status luxfer_distribution_get_name(luxfer_distribution *distribution,
                                           char *buffer,
                                           size_t capacity,
                                           size_t *needed);

/**
 * Tells the luminous intensity in candela in a direction, in degrees: c around the axis, gamma from straight down at 0 to
 * straight up at 180. Any thread.
 */
luxfer_status luxfer_distribution_get_intensity(luxfer_distribution *distribution,
                                                double c,
                                                double gamma,
                                                double *candela);

/** Adds a reference. Any thread. */
luxfer_status luxfer_distribution_retain(luxfer_distribution *distribution);

/** Gives a reference back. Any thread. */
luxfer_status luxfer_distribution_release(luxfer_distribution *distribution);

/* ====================================================================================================================
 * Lights of a scene
 *
 * Lights without a surface: points, spots, the parallel light of something far away, and luminaires that were measured.
 * Lights with a surface are materials that emit.
 * ==================================================================================================================== */

/** A kind of light: a LUXFER_LIGHT_ value. */
typedef int32_t luxfer_light_kind;

/** A light without a surface. Fill it with luxfer_light_params_init. */
typedef struct luxfer_light_params {
    /** sizeof(luxfer_light_params), set by luxfer_light_params_init. */
    uint32_t struct_size;
    /** LUXFER_LIGHT_ value; default LUXFER_LIGHT_POINT. */
    luxfer_light_kind kind;
    /** Where a point or a spot stands, in metres, in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /** Where a spot or a directional light shines; any length but 0; default (0, -1, 0). */
    float direction[3];
    /**
     * Luminous intensity per channel in cd, on the axis of a spot; of a directional light the illuminance in lux on a
     * surface that faces it. Each >= 0; default (1, 1, 1).
     */
    float intensity[3];
    /** Half the angle of a spot's cone of full intensity, in radians, in [0, outer_angle]; default 0. */
    float inner_angle;
    /** Half the angle of a spot's whole cone, in radians, in (0, pi / 2]; default pi / 4. */
    float outer_angle;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_light_params;

/** How a luminaire hangs. Fill it with luxfer_luminaire_params_init. */
typedef struct luxfer_luminaire_params {
    /** sizeof(luxfer_luminaire_params), set by luxfer_luminaire_params_init. */
    uint32_t struct_size;
    /** Must be 0. */
    uint32_t reserved;
    /** Luminous flux in lumens, finite and >= 0; default 0: that of the distribution. */
    double flux;
    /** Where it hangs, in metres, in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /** The direction of its axis, where gamma is 0; any length but 0; default (0, -1, 0): it shines down. */
    float axis[3];
    /**
     * About where C is 0: what of it is at right angles to the axis counts, which must not be 0; default (1, 0, 0). C grows
     * anticlockwise as seen from above a luminaire that shines down.
     */
    float c0[3];
    /** Linear colour of its light, each >= 0 and not all 0; its brightness does not count; default (1, 1, 1). */
    float colour[3];
} luxfer_luminaire_params;

/** Shines the same in every direction. */
#define LUXFER_LIGHT_POINT 0

/** Shines in a cone. */
#define LUXFER_LIGHT_SPOT 1

/** Shines from infinitely far away. */
#define LUXFER_LIGHT_DIRECTIONAL 2

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_light_params_init(luxfer_light_params *params,
                                       size_t size);

/**
 * Adds a light; *index, unless NULL, becomes its index. params may be NULL for the defaults. Any thread.
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
 * Adds a luminaire: a light at a point, as strong in each direction as a distribution says; *index, unless NULL, becomes its
 * index among the lights. A luminaire must be small beside how far it is from what it lights: a fifth of that at most. params
 * may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_luminaire(luxfer_scene *scene,
                                         luxfer_distribution *distribution,
                                         const luxfer_luminaire_params *params,
                                         uint32_t *index);

/* ====================================================================================================================
 * Scene queries
 *
 * What the library itself sees in a scene: the nearest hits of rays. These calls return when they are done.
 * ==================================================================================================================== */

/** No mesh, no texture. */
#define LUXFER_NONE 4294967295

/** A half-line. An element of arrays, so it will never change. */
typedef struct luxfer_ray {
    /** Where it starts, in metres. */
    float origin[3];
    /** Where it goes; need not be of unit length, but not 0. */
    float direction[3];
    /** Hits lie at distances in (0, t_max), in units of direction; may be infinite. */
    float t_max;
} luxfer_ray;

/** Where a ray meets a scene. An element of arrays, so it will never change. */
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
 * Finds the nearest hits of count rays, all surfaces taken as opaque and two-sided; equal distances are decided by the
 * lower mesh and triangle. Rays that are not finite or have no direction hit nothing. The first call after a change of the
 * scene, and after it was loaded, makes it ready for tracing. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid, the message tells where.
 */
luxfer_status luxfer_scene_intersect(luxfer_scene *scene,
                                     const luxfer_ray *rays,
                                     size_t count,
                                     luxfer_hit *hits);

/* ====================================================================================================================
 * Scene requirements
 *
 * What the renderer finds out about a scene before the first ray: which ways of scattering and which lights can occur, and
 * how much light a bounce can leave. What cannot occur is left out of tracing, which changes no image. Nothing here has to
 * be called: it tells what is done anyway.
 * ==================================================================================================================== */

/** Some surface scatters diffusely. */
#define LUXFER_SCATTERING_DIFFUSE 1

/** Some surface has a rough reflecting layer. */
#define LUXFER_SCATTERING_GLOSSY 2

/** Some surface reflects as a mirror. */
#define LUXFER_SCATTERING_MIRROR 4

/** Some surface is a clear pane. */
#define LUXFER_SCATTERING_GLASS 8

/** Some surface is partly not there. */
#define LUXFER_SCATTERING_ALPHA 16

/** Some surface emits. */
#define LUXFER_LIGHTS_SURFACE 1

/** Some surface emits by a texture. */
#define LUXFER_LIGHTS_TEXTURE 2

/** There is a point light that shines. */
#define LUXFER_LIGHTS_POINT 4

/** There is a spot light that shines. */
#define LUXFER_LIGHTS_SPOT 8

/** There is a directional light that shines. */
#define LUXFER_LIGHTS_DIRECTIONAL 16

/** The environment shines. */
#define LUXFER_LIGHTS_ENVIRONMENT 32

/** What a scene requires of the renderer. Set struct_size before the call. */
typedef struct luxfer_requirements {
    /** sizeof(luxfer_requirements), set by the caller. */
    uint32_t struct_size;
    /** Ways of scattering that can occur: LUXFER_SCATTERING_ flags. */
    uint32_t scattering;
    /** Lights that can shine: LUXFER_LIGHTS_ flags. */
    uint32_t lights;
    /** Textures that vary what surfaces scatter, emit, or how they are bent. */
    uint32_t textures;
    /**
     * How many times light can scatter and still matter: light that was scattered more often is at most the share error,
     * given in the call, of all light that surfaces scatter. 0 if albedos set no bound. Rendering ends paths there only if
     * luxfer_render_params.bounce_error asks for it.
     */
    uint32_t bounces;
    /** Index of the material that sends on most of the light it receives; LUXFER_NONE if there are no surfaces. */
    uint32_t brightest_material;
    /** The most that any surface sends on, per channel, in [0, 1]. */
    float albedo[3];
    /** Triangles without an area, which are left out. */
    uint32_t flat_triangles;
} luxfer_requirements;

/**
 * Tells what a scene requires of the renderer; error, in [0, 1), is the share of light for *requirements' bounces. The
 * first call after a change of the scene makes it ready for tracing. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid or error is out of range.
 */
luxfer_status luxfer_scene_requirements(luxfer_scene *scene,
                                        float error,
                                        luxfer_requirements *requirements);

/**
 * Tells in words what rendering a scene leaves out: one sentence per line, as UTF-8 that ends with a zero, cut if it does
 * not fit into capacity bytes. *needed, unless NULL, becomes the capacity for all of it. buffer may be NULL if capacity is
 * 0. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid.
 */
luxfer_status luxfer_scene_requirements_text(luxfer_scene *scene,
                                             char *buffer,
                                             size_t capacity,
                                             size_t *needed);

/* ====================================================================================================================
 * Scene read-back
 *
 * The meshes a scene holds, element by element. Together with the counts of luxfer_scene_get_counts, and with its
 * materials, textures and cameras, a host can copy a whole scene.
 * ==================================================================================================================== */

/** A mesh of a scene. Set struct_size before the call. */
typedef struct luxfer_mesh_info {
    /** sizeof(luxfer_mesh_info), set by the caller. */
    uint32_t struct_size;
    /** Index of its material. */
    uint32_t material;
    /** Number of vertices. */
    size_t vertex_count;
    /** Number of triangles. */
    size_t triangle_count;
    /** 1 if it has a normal for each vertex, 0 if its faces are flat. */
    uint32_t has_normals;
    /** Sum of 1 if it has the first set of texture coordinates and 2 if it has the second. */
    uint32_t uv_sets;
} luxfer_mesh_info;

/**
 * Tells what a mesh has. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh.
 */
luxfer_status luxfer_scene_get_mesh(luxfer_scene *scene, uint32_t index, luxfer_mesh_info *info);

/**
 * Copies the name of a mesh into buffer, as luxfer_context_last_error does a message. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh.
 */
luxfer_status luxfer_scene_get_mesh_name(luxfer_scene *scene,
                                         uint32_t index,
                                         char *buffer,
                                         size_t capacity,
                                         size_t *needed);

/**
 * Copies a mesh into the caller's packed arrays, of which any may be NULL: positions and normals, three floats for each
 * vertex, and indices, three for each triangle. The capacities are in vertices and triangles. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh, or it has no normals where they are asked for; LUXFER_INVALID_ARGUMENT if a
 * capacity is too small.
 */
luxfer_status luxfer_scene_read_mesh(luxfer_scene *scene,
                                     uint32_t index,
                                     size_t vertex_capacity,
                                     float *positions,
                                     float *normals,
                                     size_t triangle_capacity,
                                     uint32_t *indices);

/**
 * Copies a set of texture coordinates, 0 or 1, into the caller's packed array of two floats for each vertex; capacity is
 * in vertices. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh or it has no such set; LUXFER_INVALID_ARGUMENT if the capacity is too small.
 */
luxfer_status luxfer_scene_read_mesh_uvs(luxfer_scene *scene,
                                         uint32_t index,
                                         uint32_t uv_set,
                                         size_t capacity,
                                         float *uvs);

/* ====================================================================================================================
 * Plane geometry
 *
 * Maps between two views of a plane, as 3 x 3 matrices of homogeneous points, row by row. Points are in pixels, x right,
 * y down, the top-left pixel's centre at (0.5, 0.5). These calls return when they are done.
 * ==================================================================================================================== */

/**
 * Finds the map that takes four points to four points: from and to hold x and y of each, homography receives its nine
 * entries, of unit Frobenius norm. Any thread.
 * LUXFER_DEGENERATE if three of the points lie on one line, coincide or are not finite.
 */
luxfer_status luxfer_homography_from_corners(luxfer_context *context,
                                             const double *from,
                                             const double *to,
                                             double *homography);

/**
 * Makes an image of width x height pixels, each in [1, 65536], whose pixel at p is that of the source at to_source(p), nine
 * entries; 0 where that is outside the source. Interpolated where the source is magnified, averaged over the pixel's
 * footprint where it is minified. Takes some milliseconds for each megapixel. The caller releases *warped. Any thread.
 * LUXFER_INVALID_ARGUMENT if an entry is not finite or a size out of range; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_image_warp(luxfer_image *source,
                                const double *to_source,
                                uint32_t width,
                                uint32_t height,
                                luxfer_image **warped);

/* ====================================================================================================================
 * Rectification
 *
 * From the straight lines of a photo to vanishing points and the camera, and, where a mask marks a plane, to that plane
 * seen straight on. Image points are in pixels, x right, y down, the top-left pixel's centre at (0.5, 0.5). Room axes 0 and
 * 2 are horizontal, axis 1 is vertical; camera space is x right, y down, z forward.
 * ==================================================================================================================== */

/** Lines, vanishing points and the unwarped plane of a photo. See luxfer_rectify_create. */
typedef struct luxfer_rectify luxfer_rectify;

/** How lines are found: a LUXFER_LINES_ value. */
typedef int32_t luxfer_lines;

/** How vanishing points are found: a LUXFER_SEARCH_ value. */
typedef int32_t luxfer_search;

/** How far a vanishing point is from a line, in LUXFER_SEARCH_SUCCESSIVE: a LUXFER_METRIC_ value. */
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
     * Half-width in radians of the band around the gradient's direction that votes for a line, in [1e-4, pi/2]; default
     * 0.0436, which is 2.5 degrees.
     */
    double hough_band;
    /** Focal length in pixels, > 0, or 0, the default: unknown. */
    double focal;
    /** Principal point in pixels; NaN, the default: the image's centre. */
    double principal[2];
    /** The two room axes that the plane spans, each 0, 1 or 2; -1, the default: found from the lines in it. */
    int32_t plane_axes[2];
    /**
     * Longest side of the unwarped image in pixels, in [16, 16384]; default 2048. The photo's own density decides below.
     */
    uint32_t max_side;
    /** Must be 0. */
    uint32_t reserved;
    /** Largest magnification of the photo, > 0; default 16. What is further away is cut off. */
    double max_magnification;
    /** Seed of the search; default 1. */
    uint64_t seed;
} luxfer_rectify_params;

/** An image of a rectification: a LUXFER_RECTIFY_ value. */
typedef int32_t luxfer_rectify_image;

/** Where a focal length came from: a LUXFER_FOCAL_ value. */
typedef int32_t luxfer_focal_source;

/** What the lines of a photo say about its camera, and how the plane was unwarped. Set struct_size before the call. */
typedef struct luxfer_rectify_report {
    /** sizeof(luxfer_rectify_report), set by the caller. */
    uint32_t struct_size;
    /** Number of line segments found. */
    uint32_t segments;
    /** Vanishing points of the room axes, homogeneous pixels of unit length; the third coordinate is 0 at infinity. */
    double vanishing_points[3][3];
    /** Standard deviation of their directions in camera space, in radians. */
    double vanishing_errors[3];
    /** Number of segments that agree with each; 0 = derived from the other two. */
    uint32_t vanishing_support[3];
    /** LUXFER_FOCAL_ value. */
    luxfer_focal_source focal_source;
    /** Focal length in pixels. */
    double focal;
    /** Principal point in pixels. */
    double principal[2];
    /** Room axes as unit vectors in camera space. */
    double axes[3][3];
    /** 1 if the plane has been unwarped, else 0, and what follows is 0. */
    uint32_t is_unwarped;
    /** Must be 0. */
    uint32_t reserved;
    /** The map from unwarped pixels to photo pixels, row by row. */
    double to_photo[9];
    /** Corners of the unwarped rectangle in the photo, x and y. */
    double corners[4][2];
    /** Expected error of each corner, in unwarped pixels. */
    double corner_errors[4];
    /** Size of an unwarped pixel as a share of the camera's distance from the plane. */
    double pixel_size;
    /** Trust in the aspect ratio, in [0, 1]: low where the focal length had to be assumed. */
    double aspect_confidence;
    /**
     * How far outwards the lens moves what it shows in the corners of the photo, as a share of their distance from its centre:
     * below 0 for a barrel, as of wide angles. It is measured by how far straight lines are bent, and not undone. NaN where the
     * photo has too few lines to tell.
     */
    double distortion;
    /** Its standard deviation; NaN where it is. */
    double distortion_error;
    /**
     * For each axis how far the angle between the two others is from a right one, in radians, by the lines of these two alone:
     * walls that meet at other angles, pixels that are not square and a principal point elsewhere show here. The axes are made
     * orthogonal all the same. NaN where an axis has no lines.
     */
    double squareness[3];
    /** Standard deviation of each; NaN where it is. */
    double squareness_errors[3];
} luxfer_rectify_report;

/** Regions of like gradient direction, with sub-pixel end points. */
#define LUXFER_LINES_REGIONS 0

/** The paper's: gradient-restricted Hough transform of Canny edges. */
#define LUXFER_LINES_HOUGH 1

/** Three orthogonal directions and the focal length at once, then each refined freely. */
#define LUXFER_SEARCH_MANHATTAN 0

/** The paper's: one group of lines after the other. */
#define LUXFER_SEARCH_SUCCESSIVE 1

/** The paper's measure on the segment that was detected, finite for vanishing points at infinity. */
#define LUXFER_METRIC_SEGMENT 0

/** As printed in the paper (Eq. 2), on the whole visible line. */
#define LUXFER_METRIC_VISIBLE_LINE 1

/** The caller gave it. */
#define LUXFER_FOCAL_GIVEN 0

/** From vanishing points of orthogonal directions. */
#define LUXFER_FOCAL_FROM_VANISHING_POINTS 1

/** A guess, 0.85 of the image's width. */
#define LUXFER_FOCAL_ASSUMED 2

/** The plane seen straight on, linear RGB. */
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
 * Sets the mask of the plane to unwarp, 1 on it and 0 elsewhere; 1 channel, the photo's size. mask may be NULL: then only
 * lines and vanishing points are found. Any thread.
 */
luxfer_status luxfer_rectify_set_mask(luxfer_rectify *rectify,
                                      luxfer_image *mask);

/**
 * Starts a job that finds lines, vanishing points and the camera, unless the same photo's are known from before, and
 * unwarps the plane if its mask is set. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the photo is missing or a job runs already. The job may end with LUXFER_DEGENERATE if there
 * are no lines or the plane is seen edge-on, LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of range.
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
 * Unwarps another image of the photo's size, such as the confidence of the lights, as the plane was; outside the photo it
 * becomes 0. Returns when it is done, which takes some milliseconds for each megapixel. The caller releases *warped. Any
 * thread.
 * LUXFER_NOT_READY before a job with a mask has succeeded; LUXFER_INVALID_ARGUMENT if the size differs.
 */
luxfer_status luxfer_rectify_warp(luxfer_rectify *rectify,
                                  luxfer_image *source,
                                  luxfer_image **warped);

/**
 * Tells what was found and how sure it is. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_rectify_get_report(luxfer_rectify *rectify, luxfer_rectify_report *report);

/** Adds a reference. Any thread. */
luxfer_status luxfer_rectify_retain(luxfer_rectify *rectify);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_rectify_release(luxfer_rectify *rectify);

/* ====================================================================================================================
 * Features
 *
 * What segmentation knows of each pixel of a photo: ten channels, L*, a*, b* (CIELAB, D65), depth, position x, y, z and
 * normal x, y, z. Depth comes from the caller, or from a network that the caller has as an ONNX file, or is laid out as a
 * room from the lines that luxfer_rectify has found and strokes on one of its planes, or is a neutral guess.
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
    /** Half-width of the window the normals are fitted in, in pixels, in [0, 64]; default 0: from the photo's size. */
    uint32_t normal_radius;
} luxfer_features_params;

/** What a depth map measures: a LUXFER_DEPTH_ value. */
typedef int32_t luxfer_depth_kind;

/**
 * What the colours of a photo become before a network sees them: a LUXFER_NORMALISATION_ value. The file does not say it.
 */
typedef int32_t luxfer_normalisation;

/** An image of the features: a LUXFER_FEATURES_ value. */
typedef int32_t luxfer_features_image;

/** Where the depth came from: a LUXFER_DEPTH_FROM_ value. */
typedef int32_t luxfer_depth_source;

/** How good the features are. Set struct_size before the call. */
typedef struct luxfer_features_report {
    /** sizeof(luxfer_features_report), set by the caller. */
    uint32_t struct_size;
    /** LUXFER_DEPTH_FROM_ value. */
    luxfer_depth_source depth_source;
    /** Mean trust in the depth, in [0, 1]. */
    double depth_confidence;
    /** Pixels of the photo that were NaN, infinite or negative and have been replaced from their neighbours. */
    uint64_t replaced_pixels;
} luxfer_features_report;

/** Distance along the viewing axis. */
#define LUXFER_DEPTH_ALONG_Z 0

/** Distance along the ray of each pixel. */
#define LUXFER_DEPTH_ALONG_RAY 1

/** The ten channels; luxfer_image_read takes them apart. */
#define LUXFER_FEATURES_CHANNELS 0

/** Trust in the depth of each pixel, in [0, 1]; 1 channel. */
#define LUXFER_FEATURES_DEPTH_CONFIDENCE 1

/**
 * The depth along z that a network has estimated, from near_plane to far_plane; 1 channel. It can be set as the depth map of a
 * further run, or of luxfer_transfer, without running the network again.
 */
#define LUXFER_FEATURES_NETWORK_DEPTH 2

/** By the size of the network's input: LUXFER_NORMALISATION_IMAGENET for 256 x 256, else LUXFER_NORMALISATION_HALF. */
#define LUXFER_NORMALISATION_BY_SIZE 0

/** sRGB less (0.485, 0.456, 0.406), over (0.229, 0.224, 0.225): MiDaS 2.1, large and small. */
#define LUXFER_NORMALISATION_IMAGENET 1

/** sRGB less 0.5, over 0.5: DPT. */
#define LUXFER_NORMALISATION_HALF 2

/** sRGB in [0, 1]. */
#define LUXFER_NORMALISATION_NONE 3

/** The caller's depth map. */
#define LUXFER_DEPTH_FROM_CALLER 0

/** A room laid out from the lines of the photo, and strokes. */
#define LUXFER_DEPTH_FROM_LAYOUT 1

/** A guess that knows nothing of the photo. */
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

/** Sets the photo: linear RGB, 1 = display white. Strokes set for a photo of another size are dropped. Any thread. */
luxfer_status luxfer_features_set_photo(luxfer_features *features,
                                        luxfer_image *photo);

/**
 * Sets a depth map of the photo's size, 1 channel, in any unit; what is not positive and finite is a hole. kind is a
 * LUXFER_DEPTH_ value. depth may be NULL: none. Any thread.
 */
luxfer_status luxfer_features_set_depth(luxfer_features *features,
                                        luxfer_image *depth,
                                        luxfer_depth_kind kind);

/**
 * Sets a network that estimates depth where there is no depth map: an ONNX file; path is UTF-8. Its one input is a photo, a float
 * tensor [1, 3, rows, columns] of any size up to 4096; its first output is a map of relative inverse depth, as those of MiDaS
 * and DPT are. The map is normalised by its extremes: the nearest pixel is on near_plane, the farthest on far_plane.
 * normalisation is a LUXFER_NORMALISATION_ value. path may be NULL: none. The file is read now and not needed afterwards.
 * Any thread.
 * LUXFER_IO if the file cannot be read, LUXFER_FORMAT if it is damaged, LUXFER_UNSUPPORTED if it needs what the library does not
 * do, or if the library was built without the Cargo feature onnx.
 */
luxfer_status luxfer_features_set_network(luxfer_features *features,
                                          const char *path,
                                          luxfer_normalisation normalisation);

/**
 * Takes the lines and the camera that a luxfer_rectify has found in the same photo, as they are now. rectify may be NULL:
 * none. Any thread.
 * LUXFER_NOT_READY if it has found none yet.
 */
luxfer_status luxfer_features_set_view(luxfer_features *features,
                                       luxfer_rectify *rectify);

/**
 * Adds a stroke on the photo as luxfer_segment_add_stroke does: positive is 1 on one plane of the room, such as the ceiling that
 * carries the lights, and 0 elsewhere. They are heard where the room is laid out from lines (luxfer_features_set_view): of its
 * boxes those are preferred that have all positive strokes on one face, whichever it is, and no other there. Any thread.
 * LUXFER_INVALID_OPERATION before the photo is set.
 */
luxfer_status luxfer_features_add_stroke(luxfer_features *features,
                                         const float *points,
                                         size_t point_count,
                                         float radius,
                                         int32_t positive);

/**
 * Adds the strokes of a drawing of the photo's size that concern the plane, as luxfer_segment_add_strokes_image does with
 * LUXFER_PHASE_PLANE. Any thread.
 * LUXFER_INVALID_OPERATION before the photo is set; LUXFER_INVALID_ARGUMENT if the size differs.
 */
luxfer_status luxfer_features_add_strokes_image(luxfer_features *features,
                                                luxfer_image *drawing);

/**
 * Adds the strokes of a text in UTF-8 that concern the plane, as luxfer_segment_add_strokes_text does with LUXFER_PHASE_PLANE. Any
 * thread.
 * LUXFER_INVALID_OPERATION before the photo is set; LUXFER_FORMAT, naming the line, if the text is malformed.
 */
luxfer_status luxfer_features_add_strokes_text(luxfer_features *features,
                                               const char *description);

/** Removes all strokes. Any thread. */
luxfer_status luxfer_features_clear_strokes(luxfer_features *features);

/**
 * Starts a job that computes the features. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the photo is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT if
 * sizes differ or a setting is out of range, LUXFER_DEGENERATE if the depth map is all holes.
 */
luxfer_status luxfer_features_start(luxfer_features *features,
                                    const luxfer_features_params *params,
                                    luxfer_job **job);

/**
 * Gets an image of the result; which is a LUXFER_FEATURES_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, and for LUXFER_FEATURES_NETWORK_DEPTH where no network was run.
 */
luxfer_status luxfer_features_get_image(luxfer_features *features,
                                        luxfer_features_image which,
                                        luxfer_image **image);

/**
 * Tells how good the features are. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_features_get_report(luxfer_features *features,
                                         luxfer_features_report *report);

/** Adds a reference. Any thread. */
luxfer_status luxfer_features_retain(luxfer_features *features);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_features_release(luxfer_features *features);

/* ====================================================================================================================
 * Segmentation
 *
 * From a few strokes on a photo to a mask with a confidence for each pixel. The transfer needs two: the plane that carries
 * the lights, then the lights within it. Strokes may be added after a result, and the stage started again.
 * ==================================================================================================================== */

/** A segmentation by strokes. See luxfer_segment_create. */
typedef struct luxfer_segment luxfer_segment;

/** Settings of a segmentation. Fill them with luxfer_segment_params_init. */
typedef struct luxfer_segment_params {
    /** sizeof(luxfer_segment_params), set by luxfer_segment_params_init. */
    uint32_t struct_size;
    /** Samples drawn from the strokes of each class, in [1, 1000000]; default 1000. */
    uint32_t samples_per_class;
    /**
     * Which channels of the features to use, bit i for channel i. 0, the default: of the ten of luxfer_features colour, colour
     * and position, colour and normal, or all, whichever does best on strokes held out; of any other number all. For lights
     * 7, colour only, is best: they share the plane's geometry.
     */
    uint32_t channels;
    /**
     * Half-width in pixels, in [0, 1024], of the windows of an edge-aware refinement, which makes the mask follow the edges of
     * the photo: the guided filter, with the first three channels of the features as its guide. 0, the default: none.
     */
    uint32_t refine_radius;
    /** Strength of the prior that keeps weights small, in [1e-9, 1e3]; default 1e-3. */
    double ridge;
    /** Seed of the samples; default 1. */
    uint64_t seed;
    /**
     * Differences of those channels, in their own units (for colour those of CIELAB), below which neighbours are taken for one
     * surface by the refinement, in [1e-3, 1e6]; default 8.
     */
    double refine_tolerance;
} luxfer_segment_params;

/** What strokes are about: a LUXFER_PHASE_ value. */
typedef int32_t luxfer_phase;

/** An image of a segmentation: a LUXFER_SEGMENT_ value. */
typedef int32_t luxfer_segment_image;

/** How good a segmentation is. Set struct_size before the call. */
typedef struct luxfer_segment_report {
    /** sizeof(luxfer_segment_report), set by the caller. */
    uint32_t struct_size;
    /** The channels of the features that were used, bit i for channel i. */
    uint32_t channels;
    /** Expected share of wrong pixels, in [0, 1], from strokes held out of the training. */
    double error;
    /** Samples used of the negative class. */
    uint64_t negative_samples;
    /** Samples used of the positive class. */
    uint64_t positive_samples;
    /** Pixels that strokes of both classes cover; the later stroke counts. */
    uint64_t contradictory_pixels;
} luxfer_segment_report;

/** The plane that carries the lights; its positive strokes lie on the plane, those of lights count as well. */
#define LUXFER_PHASE_PLANE 0

/** The lights in the plane; its positive strokes lie on lights, the others on the plane beside them. */
#define LUXFER_PHASE_LIGHTS 1

/** 1 where the confidence is above one half, else 0; 1 channel. */
#define LUXFER_SEGMENT_MASK 0

/** Probability that a pixel is of the positive class, in [0, 1]; 1 channel. */
#define LUXFER_SEGMENT_CONFIDENCE 1

/**
 * How far a pixel is from anything that strokes have shown, in [0, 1]: where it is high one more stroke helps; 1 channel.
 */
#define LUXFER_SEGMENT_UNSEEN 2

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_segment_params_init(luxfer_segment_params *params,
                                         size_t size);

/** Creates the stage. The caller releases *segment. Any thread. */
luxfer_status luxfer_segment_create(luxfer_context *context, luxfer_segment **segment);

/**
 * Sets what is known of each pixel: LUXFER_FEATURES_CHANNELS, or any image of 1 to 16 channels. Strokes set for another
 * size are dropped. Any thread.
 */
luxfer_status luxfer_segment_set_features(luxfer_segment *segment,
                                          luxfer_image *features);

/**
 * Sets where to look, 1, and where not, 0, such as the mask of the plane when lights are sought; 1 channel, the size of
 * the features. within may be NULL: everywhere. Any thread.
 */
luxfer_status luxfer_segment_set_within(luxfer_segment *segment,
                                        luxfer_image *within);

/**
 * Adds a stroke along a polyline: points is an array of point_count pairs of float x, y in pixels (the top-left pixel's
 * centre is 0.5, 0.5), radius is in pixels, in [0.001, 4096], and positive is 1 for what is sought and 0 for what is not.
 * One point makes a dot. Any thread.
 * LUXFER_INVALID_OPERATION before the features are set.
 */
luxfer_status luxfer_segment_add_stroke(luxfer_segment *segment,
                                        const float *points,
                                        size_t point_count,
                                        float radius,
                                        int32_t positive);

/**
 * Adds the strokes of a drawing of the features' size, those that concern phase (a LUXFER_PHASE_ value): green (0, 255, 0)
 * plane, red (255, 0, 0) not plane, yellow (255, 255, 0) light, blue (0, 0, 255) not light; other colours and transparent
 * pixels are unpainted. Load drawings with LUXFER_COLOUR_SRGB. Any thread.
 * LUXFER_INVALID_OPERATION before the features are set; LUXFER_INVALID_ARGUMENT if the size differs.
 */
luxfer_status luxfer_segment_add_strokes_image(luxfer_segment *segment,
                                               luxfer_image *drawing,
                                               luxfer_phase phase);

/**
 * Adds the strokes that a text in UTF-8 describes, those that concern phase (a LUXFER_PHASE_ value). Each line is a class,
 * a radius and the points' x and y in pixels, as "light 3 310.5 30 320 31"; classes are plane, not-plane, light and
 * not-light; from # on a line is a comment. Any thread.
 * LUXFER_INVALID_OPERATION before the features are set; LUXFER_FORMAT, naming the line, if the text is malformed.
 */
luxfer_status luxfer_segment_add_strokes_text(luxfer_segment *segment,
                                              const char *description,
                                              luxfer_phase phase);

/** Removes all strokes. Any thread. */
luxfer_status luxfer_segment_clear_strokes(luxfer_segment *segment);

/**
 * Starts a job that segments. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the features are missing or a job runs already. The job may end with LUXFER_DEGENERATE if
 * there are no strokes of one class, LUXFER_INVALID_ARGUMENT if sizes differ, a feature is not finite or a setting is out
 * of range.
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
 * Tells how good the segmentation is. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_segment_get_report(luxfer_segment *segment, luxfer_segment_report *report);

/** Adds a reference. Any thread. */
luxfer_status luxfer_segment_retain(luxfer_segment *segment);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_segment_release(luxfer_segment *segment);

/* ====================================================================================================================
 * Emission
 *
 * From the unwarped lights of a photo to an emissive texture of any size that carries their pattern on, and the list
 * of its luminaires.
 * ==================================================================================================================== */

/** An emissive texture in the making. See luxfer_emission_create. */
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
    /** Unwarped pixels per texel, in [1e-3, 1e3]; default 1. */
    double scale;
    /** Longest side of the exemplar during synthesis, in pixels, in [16, 2048]; default 256. */
    uint32_t working_side;
    /** Weight of the metadata channels against colour, in [0, 1e3]; default 1; 0 is plain quilting. */
    float metadata_weight;
    /** Seed of the synthesis; default 1. */
    uint64_t seed;
    /**
     * Correlation of the lights with themselves from which they are taken for regular, in [0, 1]; default 0.6. At 0
     * any repetition is held to exactly, at 1 none is, and patches go anywhere.
     */
    float least_regularity;
    /** 1, the default, shows every lamp as one piece; with 0 seams may cut lamps. */
    uint32_t whole_lamps;
    /**
     * Where the pattern begins, in texels right of and below the texture's corner, each in [-1e6, 1e6]; default 0.
     * Lights without a lattice begin nowhere: of these it shifts lamps of a texture that is tileable, and must be 0
     * in others.
     */
    double offset[2];
    /**
     * Channel value from which the photo is clipped, in [0, 1]; default 0.95. Lamps it shows so get the colour of
     * their rims, as dark as the clipped channels allow. With 0 nothing is taken for clipped.
     */
    float clip_level;
    /** With 1 every lamp shines evenly, in its mean colour; default 0: as in the photo. */
    uint32_t even_lamps;
    /**
     * With 1 the texture may be repeated: what leaves it on one side comes in on the other, and a lattice is
     * stretched, by less than half a period over the whole, to fit. Needs whole_lamps. Default 0.
     */
    uint32_t tileable;
    /**
     * With 1 a lattice lies evenly between the sides of the texture, shifted by offset from there: a lamp or the
     * middle between two in its middle, so that the border cuts as few lamps as it can. Default 0.
     */
    uint32_t centred;
    /**
     * Patches that are compared for each block, at most, where none is held to a lattice, in [1, 65536]; default 192.
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

/** How good the texture is. Set struct_size before the call. */
typedef struct luxfer_emission_report {
    /** sizeof(luxfer_emission_report), set by the caller. */
    uint32_t struct_size;
    /** Number of luminaires; see luxfer_emission_get_luminaire. */
    uint32_t luminaires;
    /**
     * The largest relative difference between texture and exemplar in the share that is lit, the area of whole lamps,
     * and the distance from each to the nearest other. It weighs as much as exemplar_lamps. NaN of a plan, which is
     * no texture yet.
     */
    double error;
    /**
     * How regular the lights are, in [0, 1]: correlation with themselves shifted by the lattice that was found, 0
     * without.
     */
    double regularity;
    /**
     * Number of lamps that the exemplars show whole. Fewer than six tell little about a design: what the border cuts
     * off is a large part of what there is, and without a whole lamp the texture shows the cut ones.
     */
    uint32_t exemplar_lamps;
    /**
     * By how much the exemplar's own statistics are off, as far as can be told: the root mean square of the same
     * difference between parts of the texture as large as the exemplar, and the whole. An error of up to twice this
     * says nothing against the texture. 0 where the texture shows nothing else than the exemplar does, of blended
     * exemplars, and of a plan.
     */
    float sampling_error;
    /** How the lights go on, and the law that would have been next best: LUXFER_LAW_ values. */
    luxfer_emission_law law;
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

/** One lamp of the texture. Set struct_size before the call. */
typedef struct luxfer_luminaire {
    /** sizeof(luxfer_luminaire), set by the caller. */
    uint32_t struct_size;
    /** Number of corners of its outline. */
    uint32_t corners;
    /** Centre in texels, x and y. */
    double centre[2];
    /** Lengths of the principal axes in texels, the long one first. */
    double size[2];
    /** Angle of the long axis from x towards y, in radians, in (-pi/2, pi/2]. */
    double orientation;
    /** Area in texels, of those at the edge what is light. */
    double area;
    /** Share of the light of the whole texture, in [0, 1]. */
    double flux_share;
    /** Mean linear colour, relative to the photo's white. */
    float colour[3];
    /**
     * Number of its kind, from 1, those with most lamps first: lamps of about the same size and shape. 0 if the
     * border cuts it.
     */
    uint32_t kind;
} luxfer_luminaire;

/** The texture: linear RGB relative to the photo's white, 0 where there is no lamp. */
#define LUXFER_EMISSION_TEXTURE 0

/** 1 on lamps, else 0; 1 channel. */
#define LUXFER_EMISSION_MASK 1

/**
 * What synthesis started from, at working size: confidence, signed x and y distance to the nearest light; 3 channels.
 */
#define LUXFER_EMISSION_EXEMPLAR_METADATA 2

/** The same of its result. */
#define LUXFER_EMISSION_METADATA 3

/** The law that predicts the lamps of the photo best: that of their correlation, unless another is clearly better. */
#define LUXFER_LAW_BEST 0

/** The law that the correlation of the lights tells, by least_regularity. */
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
 * (1 channel, in [0, 1]) and where both are valid (1 channel, 1 or 0). Further ones are added by
 * luxfer_emission_add_style. Any thread.
 */
luxfer_status luxfer_emission_set_exemplar(luxfer_emission *emission,
                                           luxfer_image *unwarped,
                                           luxfer_image *light,
                                           luxfer_image *valid);

/**
 * Sets the photo from which full detail is recovered, and the map from unwarped to photo pixels, 9 doubles row by row
 * (luxfer_rectify_report.to_photo). photo may be NULL: the unwarped image is the finest there is. Any thread.
 */
luxfer_status luxfer_emission_set_photo(luxfer_emission *emission,
                                        luxfer_image *photo,
                                        const double *to_photo);

/**
 * Starts a job that makes the texture as a whole; luxfer_emission_start_plan does without its memory. params may be
 * NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the exemplar is missing or a job runs already. The job may end with LUXFER_DEGENERATE
 * if there are no lights in the exemplar, LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of range.
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
 * Tells how good the texture is, or what a plan consists of. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_emission_get_report(luxfer_emission *emission,
                                         luxfer_emission_report *report);

/**
 * Describes a luminaire of the texture. Of a plan, which has no texel yet, it is as the exemplar shows it, cut where
 * the texture ends; lights that run through their exemplar are as the texture shows them. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such luminaire.
 */
luxfer_status luxfer_emission_get_luminaire(luxfer_emission *emission,
                                            uint32_t index,
                                            luxfer_luminaire *luminaire);

/**
 * Tells a corner of a luminaire's outline, in texels. Any thread.
 *
 * The outline lies where half of a texel would be light, finer than texels where the confidence of the lights is:
 * within a quarter of a texel, or of an unwarped pixel where that is larger; corners of the lamp within 0.71 of one.
 * Of lamps up to two texels wide, of a mask that is all or nothing and of lights of a plan that follow its patches it
 * follows the sides of texels. LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such
 * luminaire or corner.
 */
luxfer_status luxfer_emission_get_corner(luxfer_emission *emission,
                                         uint32_t index,
                                         uint32_t corner,
                                         double *x,
                                         double *y);

/** Adds a reference. Any thread. */
luxfer_status luxfer_emission_retain(luxfer_emission *emission);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_emission_release(luxfer_emission *emission);

/* ====================================================================================================================
 * Styles and tiles
 *
 * Several exemplars in one texture, and textures that are too large to be made as a whole: luxfer_emission_start_plan decides
 * where every lamp goes, and luxfer_emission_render_tile renders any part. Beside the exemplars a plan holds a place for each
 * lamp and the outlines of the patches, but no texel.
 * ==================================================================================================================== */

/**
 * Adds an exemplar, whose lights take the place of the first one's as its weights say. unwarped, light and valid are as for
 * luxfer_emission_set_exemplar; photo, which may be NULL, and to_photo as for luxfer_emission_set_photo. scale is its unwarped
 * pixels per texel, in [1e-3, 1e3]. weights has 1 channel and values in [0, 1], and is stretched over the texture; where several
 * exemplars are added their weights are images of one size and add up to 1 at most. What they leave is the first exemplar's.
 *
 * No lamp is a mixture: each is taken from an exemplar with the probability of its weight there, so that light per area blends
 * linearly. Lattices keep their own period and phase. Any thread.
 */
luxfer_status luxfer_emission_add_style(luxfer_emission *emission,
                                        luxfer_image *unwarped,
                                        luxfer_image *light,
                                        luxfer_image *valid,
                                        luxfer_image *photo,
                                        const double *to_photo,
                                        double scale,
                                        luxfer_image *weights);

/** Takes all exemplars that were added away; the first stays. Any thread. */
luxfer_status luxfer_emission_clear_styles(luxfer_emission *emission);

/**
 * Starts a job that plans the texture, in the place of luxfer_emission_start, whose results go. params and what the call and
 * the job return are the same. luxfer_emission_get_report and luxfer_emission_get_luminaire tell the lamps of the plan.
 * The caller releases *job. Any thread.
 */
luxfer_status luxfer_emission_start_plan(luxfer_emission *emission,
                                         const luxfer_emission_params *params,
                                         luxfer_job **job);

/**
 * Renders the part of a planned texture that begins x texels right of and y below its corner: 4 channels, linear RGB, and 1 on
 * lamps, else 0. The bits are those of the texture and mask that luxfer_emission_start makes, whatever the tiles and their
 * order. Takes up to a second for each megapixel. The caller releases *tile. Any thread, several at once.
 * LUXFER_NOT_READY before a job of luxfer_emission_start_plan has succeeded; LUXFER_INVALID_ARGUMENT for a part that is empty or
 * reaches beyond the texture; LUXFER_OUT_OF_MEMORY beyond the memory budget.
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
 * A path tracer of a scene's light, in cd/m². It gets better pass by pass: while its job runs, and after a cancel, the
 * image so far can be read with its own error estimate.
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
    /** Paths per pixel, in [1, 1048576]; default 64. With a target this is the most on the average over the image. */
    uint32_t samples;
    /**
     * Stop when the error of the report falls to this, >= 0, and give paths to where they lower it most; default 0: never.
     */
    float target_error;
    /** Stop after this many milliseconds; default 0: never. */
    uint32_t time_budget_ms;
    /** Seed of the paths; default 1. */
    uint64_t seed;
    /**
     * Stop when every part of the image (8 x 8 pixels, root mean square) is known to this, >= 0: half the width of the 95 %
     * interval of a pixel's luminance, relative to that luminance or to a tenth of the image's mean, whichever is more.
     * 0.1 means within 10 % of its value, 19 times out of 20. A part gets at most 64 times samples, though it may miss the
     * target. Default 0: never.
     */
    float pixel_error;
    /**
     * End every path where what is left is at most this share of all light that surfaces scatter, in [0, 1): the image is
     * too dark by up to that share. After how many bounces, luxfer_scene_requirements tells. Default 0: never; paths end by
     * chance alone, and the image is right on the average.
     */
    float bounce_error;
    /**
     * Strength of the filter for LUXFER_RENDER_PREVIEW, in [0, 10]; 1 is usual, more blurs more. Default 0: no preview, as
     * final images are made. The other images are the same with and without it.
     */
    float preview;
    /**
     * Stop when the relative_error of the report falls to this, >= 0, and give paths to where they lower it most: as noise is
     * seen, in the shade as in the light. Default 0: never. With several targets all are reached.
     */
    float relative_error;
} luxfer_render_params;

/** An image of a rendering: a LUXFER_RENDER_ value. */
typedef int32_t luxfer_render_image;

/** How good a rendering is. Set struct_size before the call. */
typedef struct luxfer_render_report {
    /** sizeof(luxfer_render_report), set by the caller. */
    uint32_t struct_size;
    /** Paths per pixel so far, on the average. */
    uint32_t samples;
    /**
     * Root mean square over the pixels of the standard error, relative to the image's mean; infinite while a pixel has less
     * than two paths.
     */
    double error;
    /** Paths that were left out because their radiance was no finite number. */
    uint64_t discarded;
    /**
     * How far the mean of such previews is from the truth: root mean square over squares of 8 x 8 pixels, relative to the
     * image's mean, estimated. 0 without a preview.
     */
    double preview_bias;
    /**
     * Root mean square over the pixels of the standard error, relative to the pixel itself (the mean of its channels, but at
     * least a hundredth of the image's mean); infinite while a pixel has less than two paths. Of few paths it states rather
     * too much, of 8 about a quarter.
     */
    double relative_error;
} luxfer_render_report;

/** Mean radiance of each pixel, linear RGB in cd/m². */
#define LUXFER_RENDER_BEAUTY 0

/**
 * Variance of that mean; 3 channels. Pixels in blocks of eight share what their paths find, so that the error of a mean over
 * pixels is up to the root of eight times what their variances add up to.
 */
#define LUXFER_RENDER_VARIANCE 1

/** Number of paths of each pixel; 1 channel. */
#define LUXFER_RENDER_PATHS 2

/**
 * Half the width of the interval around each pixel of the beauty that holds the true radiance with a probability of 95 %,
 * in cd/m²; 3 channels; infinite where a pixel has less than two paths.
 */
#define LUXFER_RENDER_INTERVAL 3

/**
 * The beauty with its noise filtered out, guided by surfaces: what it does not see, such as soft shadows, it blurs. How
 * far, the report tells as preview_bias. Only if luxfer_render_params.preview is not 0.
 */
#define LUXFER_RENDER_PREVIEW 4

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_render_params_init(luxfer_render_params *params,
                                        size_t size);

/** Creates the stage. The caller releases *render. Any thread. */
luxfer_status luxfer_render_create(luxfer_context *context, luxfer_render **render);

/** Sets the scene; each start renders it as it is then. Any thread. */
luxfer_status luxfer_render_set_scene(luxfer_render *render, luxfer_scene *scene);

/** Renders from a camera of the scene; the default is camera 0. Any thread. */
luxfer_status luxfer_render_set_camera_index(luxfer_render *render, uint32_t camera);

/** Renders from a camera of its own. camera may be NULL for the defaults of luxfer_camera_params. Any thread. */
luxfer_status luxfer_render_set_camera(luxfer_render *render, const luxfer_camera_params *camera);

/**
 * Starts a job that renders. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera. The job may end with LUXFER_INVALID_ARGUMENT if the scene is not valid or a setting is out of range.
 */
luxfer_status luxfer_render_start(luxfer_render *render,
                                  const luxfer_render_params *params,
                                  luxfer_job **job);

/**
 * Gets an image of the rendering, as far as it is; which is a LUXFER_RENDER_ value. The caller releases *image. Any
 * thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND for a preview that was not asked for.
 */
luxfer_status luxfer_render_get_image(luxfer_render *render,
                                      luxfer_render_image which,
                                      luxfer_image **image);

/**
 * Tells how good the rendering is so far. Any thread.
 * LUXFER_NOT_READY before the first pass of a job.
 */
luxfer_status luxfer_render_get_report(luxfer_render *render, luxfer_render_report *report);

/** Adds a reference. Any thread. */
luxfer_status luxfer_render_retain(luxfer_render *render);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_render_release(luxfer_render *render);

/* ====================================================================================================================
 * Outputs of a rendering
 *
 * Images beside the main one, made of the same paths: light that came by certain ways, chosen by light path expressions,
 * and what the camera sees of surfaces. They are asked for before luxfer_render_start, and read as layers, while the job
 * runs as well as after it: first those of the expressions in the order they were added, then those of surfaces in the
 * order of their flags. The main image is the same bits with and without them.
 *
 * An expression is a regular expression over the events of a path, light first with L and E at its ends, as in
 * "LDE", "LSE", "L.*DDE", "LD{1,2}E", "LS*DE" (S is all that is not diffuse), or camera first with C, as in Open Shading
 * Language: "C<RD>L", "C[GS]+.*<L.'Lamp'>". Types are R T V, modes D G S s (a clear pane is both S and s), lights L O B;
 * . [..] [^..] * + ? {n,m} | ( ) are what they are in regular expressions. Labels in quotes are names of meshes or of
 * their materials; Name#0, Name#1, ... are the patches of its emission texture, numbered as luxfer_lamps numbers them;
 * light0, light1, ... are the scene's lights in their order, environment is what surrounds it. Arnold's built-in names are
 * known: direct, indirect, emission, background, and diffuse, specular, transmission, each alone or with _direct or
 * _indirect.
 * ==================================================================================================================== */

/** Distance along the viewing direction, in metres; infinite where nothing is. Layer Depth, channel Z. */
#define LUXFER_AOV_DEPTH 1

/** Distance along the ray, in metres; infinite where nothing is. Layer Distance, channel Z. */
#define LUXFER_AOV_DISTANCE 2

/** Place in the world, in metres. Layer Position, channels X Y Z. */
#define LUXFER_AOV_POSITION 4

/** Shading normal in the world, towards the viewer; 0 where nothing is. Layer Normal, channels X Y Z. */
#define LUXFER_AOV_NORMAL 8

/** Normal of the triangle itself, likewise. Layer GeometricNormal, channels X Y Z. */
#define LUXFER_AOV_GEOMETRIC_NORMAL 16

/** Colour at normal incidence. Layer Albedo, channels R G B. */
#define LUXFER_AOV_ALBEDO 32

/** Index of the mesh plus 1, 0 where nothing is; of what most samples met. Layer IndexOB, channel X. */
#define LUXFER_AOV_OBJECT 64

/** Index of the material plus 1, likewise. Layer IndexMA, channel X. */
#define LUXFER_AOV_MATERIAL 128

/** Share of the pixel that is covered by surfaces. Layer Alpha, channel A. */
#define LUXFER_AOV_ALPHA 256

/** Luminance of the main image, in cd/m². Layer Luminance, channel Y. */
#define LUXFER_AOV_LUMINANCE 512

/**
 * How emissive surfaces and the environment answer to the lights of camera-first expressions: a LUXFER_EMITTER_AS_ value.
 */
typedef int32_t luxfer_emitter_as;

/** Surfaces are both L and O, the environment is both L and B: C<RD>L is all direct light. The default. */
#define LUXFER_EMITTER_AS_BOTH 0

/** Every light is L only. */
#define LUXFER_EMITTER_AS_LIGHT 1

/** As in Open Shading Language: surfaces are O, the environment is B. */
#define LUXFER_EMITTER_AS_OBJECT 2

/**
 * Adds a layer of the light that an expression describes. name is what the layer is called: 1 to 64 bytes in UTF-8
 * without dots, quotes or control characters, and not the name of another layer. Any thread.
 * LUXFER_INVALID_ARGUMENT if the name is not such a name, or the expression is none: the message tells the column. A label
 * that nothing in the scene bears ends the job with LUXFER_NOT_FOUND, an expression that no path can match ends it with
 * LUXFER_INVALID_ARGUMENT. LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_add_expression(luxfer_render *render,
                                           const char *name,
                                           const char *expression);

/**
 * Forgets all expressions. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_clear_expressions(luxfer_render *render);

/**
 * Says which letters emissive surfaces and the environment answer to; a LUXFER_EMITTER_AS_ value. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_set_emitter_as(luxfer_render *render, luxfer_emitter_as emitter_as);

/**
 * Says which layers of surfaces are made: LUXFER_AOV_ flags together, or 0, the default. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_set_aovs(luxfer_render *render, uint32_t flags);

/**
 * Tells how many layers the rendering has. Any thread.
 * LUXFER_NOT_READY before the first pass of a job.
 */
luxfer_status luxfer_render_get_layer_count(luxfer_render *render, uint32_t *count);

/**
 * Copies a layer's name into capacity bytes with a zero at its end, cut if need be; *needed receives the capacity for all
 * of it, unless NULL. Any thread.
 * LUXFER_NOT_FOUND if there is no such layer.
 */
luxfer_status luxfer_render_get_layer_name(luxfer_render *render,
                                           uint32_t index,
                                           char *buffer,
                                           size_t capacity,
                                           size_t *needed);

/**
 * Finds a layer by its name. Any thread.
 * LUXFER_NOT_FOUND if there is none of that name.
 */
luxfer_status luxfer_render_find_layer(luxfer_render *render, const char *name, uint32_t *index);

/**
 * Gets a layer as far as it is: 3 channels of light in cd/m², or those of a surface's output. The caller releases *image.
 * Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND if there is no such layer.
 */
luxfer_status luxfer_render_get_layer(luxfer_render *render,
                                      uint32_t index,
                                      luxfer_image **image);

/**
 * Writes the image and all layers into one OpenEXR file of 32-bit floating-point channels: R, G, B of the image, A if its
 * coverage was asked for, and layer.channel of each layer, as Blender and Nuke read them; Depth.Z also as plain Z. The
 * header tells the expression of each layer of light as luxfer.lpe.NAME. path is UTF-8; an existing file is replaced only
 * by a complete one. Any thread.
 * LUXFER_NOT_READY before the first pass of a job; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_render_write_exr(luxfer_render *render,
                                      const char *path);

/* ====================================================================================================================
 * Renderings in parts
 *
 * A rendering on many machines: each renders parts, rectangles of the image and ranges of its paths, into files, and one
 * merges the files. The image is that of one machine which renders all of it in a single part, but for the rounding of sums in
 * double precision, whatever the parts and their order. A part that was lost is rendered again, to the same bits.
 *
 * Parts have a fixed number of paths: target_error, relative_error, pixel_error and time_budget_ms must be 0. The scene,
 * the camera, the layers and luxfer_render_params must be the same for all parts and for the merge, which checks it.
 *
 * The files are OpenEXR: R, G, B show the part in its place in the image, and integer channels keep its sums.
 * ==================================================================================================================== */

/**
 * A part of a rendering. Fill it with luxfer_render_part_init, which makes it the whole, or with luxfer_render_split.
 */
typedef struct luxfer_render_part {
    /** sizeof(luxfer_render_part), set by luxfer_render_part_init. */
    uint32_t struct_size;
    /** Column of its first pixel; default 0. */
    uint32_t x;
    /** Row of its first pixel, from the top; default 0. */
    uint32_t y;
    /** Width in pixels; default 0: as far as the image goes. */
    uint32_t width;
    /** Height in pixels; default 0: as far as the image goes. */
    uint32_t height;
    /** Number of its first path in each pixel; default 0. */
    uint32_t first_sample;
    /** Paths per pixel; default 0: all that follow, of luxfer_render_params.samples. */
    uint32_t samples;
} luxfer_render_part;

/**
 * Fills *part with the whole rendering; size is sizeof *part. LUXFER_INVALID_ARGUMENT if part is NULL or size is wrong.
 */
luxfer_status luxfer_render_part_init(luxfer_render_part *part,
                                      size_t size);

/**
 * Tells what part number index is if a rendering with these params is split into columns x rows rectangles and ranges of
 * its paths, all of about the same size; columns * rows * ranges are all of it. Rectangles go on row by row, and all of one
 * range come before the next. params may be NULL for the defaults; set part->struct_size before the call. Any thread.
 * LUXFER_INVALID_ARGUMENT if there is no such part, or parts without a pixel or a path would have to be made.
 */
luxfer_status luxfer_render_split(luxfer_render *render,
                                  const luxfer_render_params *params,
                                  uint32_t columns,
                                  uint32_t rows,
                                  uint32_t ranges,
                                  uint32_t index,
                                  luxfer_render_part *part);

/**
 * Starts a job that renders a part, NULL for the whole, and writes it into a file; path is UTF-8, and an existing file is
 * replaced only by a complete one. Then the images of the rendering are those of the part alone. params may be NULL for the
 * defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera. The job may end with LUXFER_INVALID_ARGUMENT if a setting is out of range or would not fix the paths, or the part
 * is none of the image's; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_render_start_part(luxfer_render *render,
                                       const luxfer_render_params *params,
                                       const luxfer_render_part *part,
                                       const char *path,
                                       luxfer_job **job);

/**
 * Adds a file of luxfer_render_start_part to those to be merged; path is UTF-8. It is read when they are merged, its header
 * also now. Any thread.
 * LUXFER_IO if it cannot be read; LUXFER_FORMAT if it is no part of a rendering; LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_add_part(luxfer_render *render,
                                     const char *path);

/**
 * Forgets all files to be merged. Any thread.
 * LUXFER_INVALID_OPERATION while a job runs.
 */
luxfer_status luxfer_render_clear_parts(luxfer_render *render);

/**
 * Starts a job that merges the files that were added, in any order; then the rendering has its images and layers as after
 * luxfer_render_start. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such
 * camera. The job may end with LUXFER_INVALID_ARGUMENT if a file is of another rendering, or of another scene, if parts
 * overlap, or if some are missing: the message tells which; LUXFER_IO or LUXFER_FORMAT if a file cannot be read.
 */
luxfer_status luxfer_render_start_merge(luxfer_render *render,
                                        const luxfer_render_params *params,
                                        luxfer_job **job);

/* ====================================================================================================================
 * Illuminance
 *
 * Illuminance in lux on a calculation grid, or over a mesh by its texture coordinates, with the standard error of every
 * point, and mean, extremes and their error for reports.
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
 * A calculation grid. Fill it with luxfer_illuminance_grid_init, then set what differs: the defaults are a square metre
 * at the origin that faces up.
 */
typedef struct luxfer_illuminance_grid {
    /** sizeof(luxfer_illuminance_grid), set by luxfer_illuminance_grid_init. */
    uint32_t struct_size;
    /** A corner, in metres; default (0, 0, 0). */
    float origin[3];
    /** The edge along which columns count, in metres; default (1, 0, 0). Points are the centres of the cells. */
    float across[3];
    /** The edge along which rows count, in metres; default (0, 0, 1). */
    float down[3];
    /** The side from which light counts, of any length but 0; default (0, 1, 0). */
    float normal[3];
    /** Must be 0. */
    uint32_t reserved;
} luxfer_illuminance_grid;

/** An image of the calculation: a LUXFER_ILLUMINANCE_ value. */
typedef int32_t luxfer_illuminance_image;

/** The illuminance on the whole, in lux. Set struct_size before the call. */
typedef struct luxfer_illuminance_report {
    /** sizeof(luxfer_illuminance_report), set by the caller. */
    uint32_t struct_size;
    /** Points that there are: of a mesh, the texels with a surface. */
    uint32_t points;
    /** Smallest illuminance; least / mean is the uniformity U0. */
    double least;
    /** Mean illuminance. */
    double mean;
    /** Largest illuminance. */
    double largest;
    /** Standard error of the mean. */
    double mean_error;
} luxfer_illuminance_report;

/** Illuminance in lux; 1 channel, NaN where a mesh has no point. */
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

/** Sets the scene; each start calculates with it as it is then. Any thread. */
luxfer_status luxfer_illuminance_set_scene(luxfer_illuminance *illuminance, luxfer_scene *scene);

/**
 * Starts a job that calculates a grid. grid and params may be NULL for their defaults. The caller releases *job. Any
 * thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT
 * if the scene is not valid, the grid has no normal, or a setting is out of range.
 */
luxfer_status luxfer_illuminance_start_grid(luxfer_illuminance *illuminance,
                                            const luxfer_illuminance_grid *grid,
                                            const luxfer_illuminance_params *params,
                                            luxfer_job **job);

/**
 * Starts a job that maps a mesh by its first set of texture coordinates: columns along u, rows along v. back is 0 for the
 * side that its triangles' winding faces, 1 for the other. params may be NULL for the defaults. The caller releases *job.
 * Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT
 * if the scene is not valid, has no such mesh, the mesh has no texture coordinates, or a setting is out of range.
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
 * Tells the illuminance on the whole. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_illuminance_get_report(luxfer_illuminance *illuminance,
                                            luxfer_illuminance_report *report);

/** Adds a reference. Any thread. */
luxfer_status luxfer_illuminance_retain(luxfer_illuminance *illuminance);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_illuminance_release(luxfer_illuminance *illuminance);

/* ====================================================================================================================
 * Relighting
 *
 * Solves for the colour and intensity of an emission, so that a surface of the scene gets the colour it has in the photo:
 * what to multiply the emission with, per channel, with a confidence interval.
 * ==================================================================================================================== */

/** A relighting of a scene. See luxfer_relight_create. */
typedef struct luxfer_relight luxfer_relight;

/** What should match the photo: a LUXFER_QUANTITY_ value. */
typedef int32_t luxfer_quantity;

/** What of the target counts: a LUXFER_FIT_ value. */
typedef int32_t luxfer_fit;

/** Settings of a relighting. Fill them with luxfer_relight_params_init. */
typedef struct luxfer_relight_params {
    /** sizeof(luxfer_relight_params), set by luxfer_relight_params_init. */
    uint32_t struct_size;
    /** LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING. */
    luxfer_quantity quantity;
    /** Most paths to trace, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /**
     * Stop when the half-width of the widest 95 % interval is below this share of its answer, in [0, 1]; default 0.01; 0 =
     * never.
     */
    float target_error;
    /** Stop after this many milliseconds; default 0: never. */
    uint32_t time_budget_ms;
    /** LUXFER_FIT_ value; default LUXFER_FIT_MEAN. */
    luxfer_fit fit;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_relight_params;

/** On which side of its value light should be: a LUXFER_SENSE_ value. */
typedef int32_t luxfer_sense;

/** How far the answer goes to meet the target in one colour channel: a LUXFER_REACH_ value. */
typedef int32_t luxfer_reach;

/** The solution and how sure it is. Set struct_size before the call. */
typedef struct luxfer_relight_report {
    /** sizeof(luxfer_relight_report), set by the caller. */
    uint32_t struct_size;
    /** Paths traced. */
    uint32_t paths;
    /** What to multiply the emission with, per channel, >= 0. */
    double scale[3];
    /** Half-widths of the 95 % confidence intervals of scale. */
    double half_width[3];
    /** Mean radiance of the target under the emission at scale 1, in cd/m². */
    double response[3];
    /** Mean radiance of the target under all other light, in cd/m². */
    double background[3];
    /** LUXFER_REACH_ value of each channel. */
    luxfer_reach reach[3];
    /** 0. */
    uint32_t reserved;
    /** The widest relative half-width among the channels that met their target. */
    double error;
    /**
     * How far the target's colour may be off: 95 % of errors are below this CIEDE2000 difference, seen at the exposure
     * that shows the target as a middle grey.
     */
    double delta_e;
} luxfer_relight_report;

/** The light the target surface sends back, its albedo included: what a photo shows of it. */
#define LUXFER_QUANTITY_OUTGOING 0

/** The light that arrives at it, as if it were white. */
#define LUXFER_QUANTITY_INCIDENT 1

/** Its mean. */
#define LUXFER_FIT_MEAN 0

/**
 * Every point of it, by least squares: what gradient descent on texels comes to. Bright points count more, so the answer is
 * dimmer than that of the mean, by 1 / (1 + CV²) without other light, where CV is the spread of the response over the target
 * relative to its mean.
 */
#define LUXFER_FIT_LEAST_SQUARES 1

/** At it. */
#define LUXFER_SENSE_EXACTLY 0

/** At it or above: what a standard asks of a desk, or what a clipped channel of a photo says. */
#define LUXFER_SENSE_AT_LEAST 1

/** At it or below: a limit against glare. */
#define LUXFER_SENSE_AT_MOST 2

/** The target is met. */
#define LUXFER_REACH_MET 0

/** Other lights alone exceed the target: the emission is off in this channel. */
#define LUXFER_REACH_TOO_BRIGHT 1

/** No light of this channel reaches the target: the emission keeps the mean scale of the other channels. */
#define LUXFER_REACH_DARK 2

/** All lamps at their largest power do not suffice, or one goal asks for what another forbids. */
#define LUXFER_REACH_TOO_DIM 3

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_relight_params_init(luxfer_relight_params *params,
                                         size_t size);

/** Creates the stage. The caller releases *relight. Any thread. */
luxfer_status luxfer_relight_create(luxfer_context *context, luxfer_relight **relight);

/**
 * Sets the scene, the emitting material to solve for, and the mesh whose mean colour is to match: both as
 * luxfer_scene_place_emission has told them. The emission has the strength that the solution will multiply. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material or mesh.
 */
luxfer_status luxfer_relight_set_scene(luxfer_relight *relight,
                                       luxfer_scene *scene,
                                       uint32_t material,
                                       uint32_t mesh);

/**
 * Sets the mean radiance the mesh should have, in cd/m² per channel, each finite and >= 0; for LUXFER_QUANTITY_INCIDENT
 * that of a white surface in the same light, illuminance / pi. Any thread.
 */
luxfer_status luxfer_relight_set_target(luxfer_relight *relight,
                                        float red,
                                        float green,
                                        float blue);

/**
 * Makes the target a limit, in each channel for itself: LUXFER_SENSE_ values. What a photo clips is "at least". A limited
 * channel keeps the mean scale of those that are to be at their target, as far as that is on its side, and goes to its
 * limit if not. Any thread. LUXFER_INVALID_ARGUMENT if a value is none of them.
 */
luxfer_status luxfer_relight_set_sense(luxfer_relight *relight,
                                       luxfer_sense red,
                                       luxfer_sense green,
                                       luxfer_sense blue);

/**
 * Starts a job that solves. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene or the target is missing or a job runs already. The job may end with
 * LUXFER_UNREACHABLE if no light of the emission can reach the target, LUXFER_INVALID_ARGUMENT if the scene is not valid or
 * a setting is out of range.
 */
luxfer_status luxfer_relight_start(luxfer_relight *relight,
                                   const luxfer_relight_params *params,
                                   luxfer_job **job);

/**
 * Tells the solution and how sure it is. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_relight_get_report(luxfer_relight *relight, luxfer_relight_report *report);

/** Adds a reference. Any thread. */
luxfer_status luxfer_relight_retain(luxfer_relight *relight);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_relight_release(luxfer_relight *relight);

/* ====================================================================================================================
 * Lamps
 *
 * Powers of the lamps of an emission, within bounds, that come nearest to several goals: surfaces and calculation grids
 * that should have a given light. One set of paths per goal measures its response to every lamp, thousands of them at
 * once.
 * ==================================================================================================================== */

/** A calculation of lamps. See luxfer_lamps_create. */
typedef struct luxfer_lamps luxfer_lamps;

/**
 * Which lamps share their power: a LUXFER_GROUP_ value. A lamp is a connected patch of the emission's texture, or, where it
 * has none, a connected piece of its meshes.
 */
typedef int32_t luxfer_group;

/** Settings of the calculation. Fill them with luxfer_lamps_params_init. */
typedef struct luxfer_lamps_params {
    /** sizeof(luxfer_lamps_params), set by luxfer_lamps_params_init. */
    uint32_t struct_size;
    /** LUXFER_GROUP_ value; default LUXFER_GROUP_EACH. */
    luxfer_group group;
    /** Centres agree whose neighbours along the coordinate are closer than this, >= 0; default 0.01. */
    float row_tolerance;
    /** 1: each channel of a group is solved for itself, for goals of colour only; 0: its power alone; default 0. */
    uint32_t free_colour;
    /** Largest multiplier of a group, >= 0; default infinity. */
    double most;
    /** How much lamps that differ weigh against missing the goals, in [1e-9, 1e3]; default 1e-6. */
    double evenness;
    /**
     * A goal is met when it is missed by no more than this share of itself, in [1e-6, 1], or its noise; default 0.01.
     */
    double tolerance;
    /** Most paths to trace for a goal, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /** Stop when a goal's response to all lamps together is known to this share, in [0, 1]; default 0.01; 0 = never. */
    float target_error;
    /** Stop after this many milliseconds; default 0: never. */
    uint32_t time_budget_ms;
    /** Must be 0. */
    uint32_t reserved;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_lamps_params;

/** All lamps. */
#define LUXFER_GROUP_ALL 0

/** Every lamp for itself. */
#define LUXFER_GROUP_EACH 1

/** Those whose centres agree in their first coordinate: u of a texture, x of meshes. */
#define LUXFER_GROUP_FIRST 2

/** Those whose centres agree in their second coordinate: v of a texture, y of meshes. */
#define LUXFER_GROUP_SECOND 3

/** Those whose centres agree in their third coordinate: z of meshes. */
#define LUXFER_GROUP_THIRD 4

/**
 * Those of a type: of about the same area; of lights without a surface points, spots, and luminaires by their distribution.
 */
#define LUXFER_GROUP_TYPE 5

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_lamps_params_init(luxfer_lamps_params *params,
                                       size_t size);

/** Creates the stage. The caller releases *lamps. Any thread. */
luxfer_status luxfer_lamps_create(luxfer_context *context, luxfer_lamps **lamps);

/**
 * Sets the scene and the emitting material whose lamps are solved for, at the strength that the solution will multiply, or
 * LUXFER_NONE: then the lamps are the scene's lights without a surface, by their index, as luxfer_scene_add_luminaire hangs
 * them. Forgets the goals. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material.
 */
luxfer_status luxfer_lamps_set_scene(luxfer_lamps *lamps,
                                     luxfer_scene *scene,
                                     uint32_t material);

/**
 * Starts a job that measures and solves. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene or a goal is missing or a job runs already. Goals that cannot be met are no
 * error: the powers then are the nearest that the bounds allow. The job may end with LUXFER_UNREACHABLE if no goal gets
 * light from any lamp, LUXFER_INVALID_ARGUMENT if the scene is not valid, the emission has no lamp, or a setting is out of
 * range.
 */
luxfer_status luxfer_lamps_start(luxfer_lamps *lamps,
                                 const luxfer_lamps_params *params,
                                 luxfer_job **job);

/** Adds a reference. Any thread. */
luxfer_status luxfer_lamps_retain(luxfer_lamps *lamps);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_lamps_release(luxfer_lamps *lamps);

/* ====================================================================================================================
 * Goals of lamps
 *
 * What lamps are for: surfaces and calculation grids that should have a given light, just that or as a limit, and the steps that
 * their drivers have.
 * ==================================================================================================================== */

/**
 * Adds a goal: the mean radiance a mesh should have, in cd/m² per channel, each finite and >= 0; quantity is a
 * LUXFER_QUANTITY_ value; weight, >= 0, is what missing it weighs beside the other goals. Any thread.
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
 * Adds a goal: the mean illuminance in lux that a calculation grid should have, of whatever colour; weight as above. grid may
 * be NULL for its default. Any thread.
 * LUXFER_INVALID_ARGUMENT if lux is not finite or negative, LUXFER_INVALID_OPERATION before luxfer_lamps_set_scene.
 */
luxfer_status luxfer_lamps_add_grid(luxfer_lamps *lamps,
                                    const luxfer_illuminance_grid *grid,
                                    float lux,
                                    double weight);

/**
 * Makes a goal a limit, in each channel for itself: LUXFER_SENSE_ values; those of a goal in lux must be the same. Goals are
 * counted from 0 as they were added, and ask for just their value until then. Any thread.
 * LUXFER_NOT_FOUND if there is no such goal.
 */
luxfer_status luxfer_lamps_set_sense(luxfer_lamps *lamps,
                                     uint32_t goal,
                                     luxfer_sense red,
                                     luxfer_sense green,
                                     luxfer_sense blue);

/**
 * Sets the multipliers that the lamps' drivers can be dimmed to, each finite and >= 0, in any order; count is at most 4096, 0
 * for drivers that have no steps. The groups then get the levels that together are best for the goals, and half-widths
 * stay those of powers without steps. Any thread.
 * LUXFER_INVALID_ARGUMENT if a level is not finite or negative, or there are too many.
 */
luxfer_status luxfer_lamps_set_levels(luxfer_lamps *lamps,
                                      const double *levels,
                                      uint32_t count);

/** Forgets the goals. Any thread. */
luxfer_status luxfer_lamps_clear_goals(luxfer_lamps *lamps);

/* ====================================================================================================================
 * Results of lamps
 *
 * The powers found, what each goal gets, and what each lamp means to it.
 * ==================================================================================================================== */

/** The result on the whole. Set struct_size before the call. */
typedef struct luxfer_lamps_report {
    /** sizeof(luxfer_lamps_report), set by the caller. */
    uint32_t struct_size;
    /** Number of lamps. */
    uint32_t lamps;
    /** Number of groups. */
    uint32_t groups;
    /** Number of goals. */
    uint32_t goals;
    /** Paths traced for each goal. */
    uint32_t paths;
    /** 1 if all goals are met; 0 if not: luxfer_lamps_get_reason tells why. */
    uint32_t met;
} luxfer_lamps_report;

/** One lamp. Set struct_size before the call. */
typedef struct luxfer_lamp {
    /** sizeof(luxfer_lamp), set by the caller. */
    uint32_t struct_size;
    /** The group it is in. */
    uint32_t group;
    /** Its centre: texture coordinates and 0, or metres. */
    double centre[3];
    /** What to multiply its emission with, per channel, >= 0. */
    double scale[3];
    /** Half-widths of the 95 % confidence intervals of scale. */
    double half_width[3];
} luxfer_lamp;

/** What a goal gets. Set struct_size before the call. */
typedef struct luxfer_lamps_goal {
    /** sizeof(luxfer_lamps_goal), set by the caller. */
    uint32_t struct_size;
    /** LUXFER_REACH_ value of each channel. */
    luxfer_reach reach[3];
    /** Mean radiance asked for, in cd/m²; illuminance / pi for a grid. */
    double target[3];
    /** Mean radiance under the powers found. */
    double achieved[3];
    /** Half-widths of the 95 % confidence intervals of achieved. */
    double half_width[3];
    /** Mean radiance under all other light. */
    double background[3];
} luxfer_lamps_goal;

/** What one lamp means to one goal. Set struct_size before the call. */
typedef struct luxfer_lamps_response {
    /** sizeof(luxfer_lamps_response), set by the caller. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /** Mean radiance of the goal under the lamp as it is, in cd/m² per channel. */
    double mean[3];
    /** Half-widths of the 95 % confidence intervals of mean. */
    double half_width[3];
} luxfer_lamps_response;

/**
 * Tells the result on the whole. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_lamps_get_report(luxfer_lamps *lamps, luxfer_lamps_report *report);

/**
 * Tells the power of a lamp. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such lamp.
 */
luxfer_status luxfer_lamps_get_lamp(luxfer_lamps *lamps, uint32_t index, luxfer_lamp *lamp);

/**
 * Tells what a goal gets. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal.
 */
luxfer_status luxfer_lamps_get_goal(luxfer_lamps *lamps, uint32_t index, luxfer_lamps_goal *goal);

/**
 * Tells what a lamp means to a goal, for hosts that mix the light themselves. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal or lamp.
 */
luxfer_status luxfer_lamps_get_response(luxfer_lamps *lamps,
                                        uint32_t goal,
                                        uint32_t lamp,
                                        luxfer_lamps_response *response);

/**
 * Copies the reason why the goals are not all met, zero-terminated, into buffer of capacity bytes, cut if it is longer;
 * empty if they are. *needed, unless NULL, receives the capacity for all of it. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_lamps_get_reason(luxfer_lamps *lamps,
                                      char *buffer,
                                      size_t capacity,
                                      size_t *needed);

/**
 * Gets the emission's texture with every lamp multiplied by its scale; linear RGB. The caller releases *texture. Any
 * thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if the emission has no texture.
 */
luxfer_status luxfer_lamps_get_texture(luxfer_lamps *lamps,
                                       luxfer_image **texture);

/* ====================================================================================================================
 * Importance
 *
 * What each point of an emission's surface means to a target: traced once, after which the light of any texture there,
 * however it is scaled, turned and shifted, is told at once, with a confidence interval.
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
    /** Most paths to trace, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /** Stop when the response to an even emission is known to this share, in [0, 1]; default 0.01; 0 = never. */
    float target_error;
    /** Stop after this many milliseconds; default 0: never. */
    uint32_t time_budget_ms;
    /** Must be 0. */
    uint32_t reserved;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_importance_params;

/** What a texture means to the target. Set struct_size before the call. */
typedef struct luxfer_importance_report {
    /** sizeof(luxfer_importance_report), set by the caller. */
    uint32_t struct_size;
    /** Paths behind the map. */
    uint32_t paths;
    /** Mean radiance of the target under the texture, in cd/m² per channel as the texture's values are. */
    double response[3];
    /** Half-widths of the 95 % confidence intervals of response. */
    double half_width[3];
    /** What cells of twice the side change, noise included; the cells themselves are off by about a third of it. */
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
 * Sets the scene, the material of the surfaces that will emit, which need texture coordinates, and the mesh that is the
 * target; what of it emits in the scene as it is is left out. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material or mesh.
 */
luxfer_status luxfer_importance_set_scene(luxfer_importance *importance,
                                          luxfer_scene *scene,
                                          uint32_t material,
                                          uint32_t mesh);

/**
 * Starts a job that traces the map; a placement that was found is forgotten. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already. The job may end with LUXFER_INVALID_ARGUMENT if
 * the scene is not valid, the surfaces have no texture coordinates, or a setting is out of range.
 */
luxfer_status luxfer_importance_start(luxfer_importance *importance,
                                      const luxfer_importance_params *params,
                                      luxfer_job **job);

/**
 * Gets the map: what the target's mean radiance would be, per channel, if a cell emitted 1 cd/m² and nothing else did. The
 * caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_importance_get_image(luxfer_importance *importance,
                                          luxfer_image **image);

/**
 * Tells what a texture (linear, in cd/m²; it repeats) means to the target. placement leads from the surface's texture
 * coordinates to those of the texture: 3 x 3, row by row, the last row 0 0 1; NULL for where they are the same. Takes some
 * milliseconds. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_INVALID_ARGUMENT if placement is not finite.
 */
luxfer_status luxfer_importance_respond(luxfer_importance *importance,
                                        luxfer_image *texture,
                                        const double *placement,
                                        luxfer_importance_report *report);

/**
 * Solves for what to multiply a texture with, so that the target has a mean radiance, in cd/m² per channel, each finite and
 * >= 0, as luxfer_relight does it by tracing; texture and placement as above. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_UNREACHABLE if no light of the texture can reach the target.
 */
luxfer_status luxfer_importance_solve(luxfer_importance *importance,
                                      luxfer_image *texture,
                                      const double *placement,
                                      float red,
                                      float green,
                                      float blue,
                                      luxfer_relight_report *report);

/** Adds a reference. Any thread. */
luxfer_status luxfer_importance_retain(luxfer_importance *importance);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_importance_release(luxfer_importance *importance);

/* ====================================================================================================================
 * Placement
 *
 * Where a texture should lie on a surface, so that its target gets most light, least, or just as much as it should: found by
 * gradient on the map of luxfer_importance, without tracing a path.
 * ==================================================================================================================== */

/** What a placement should do: a LUXFER_AIM_ value. */
typedef int32_t luxfer_aim;

/**
 * What may be, and what is best. A texture is scaled and then turned about the centre of the surface's texture coordinates,
 * and shifted. Fill it with luxfer_placement_params_init.
 */
typedef struct luxfer_placement_params {
    /** sizeof(luxfer_placement_params), set by luxfer_placement_params_init. */
    uint32_t struct_size;
    /** LUXFER_AIM_ value; default LUXFER_AIM_MOST. */
    luxfer_aim aim;
    /** The radiance to aim at, in cd/m² per channel, each finite and >= 0; default 0. */
    float radiance[3];
    /** Places the search starts from, in [1, 4096]; default 64. */
    uint32_t starts;
    /** Smallest offset along u and v of the texture, which has period 1, in [-16, 16]; default -0.5. */
    double least_offset[2];
    /** Largest; default 0.5. Where smallest and largest are the same, here and below, nothing changes. */
    double most_offset[2];
    /** How often the texture repeats along the surface's u and v, at least, in [1/64, 64]; default 1. */
    double least_scale[2];
    /** At most; default 1. */
    double most_scale[2];
    /** Smallest rotation in radians, in [-2 pi, 2 pi]; default 0. */
    double least_rotation;
    /** Largest; default 0. */
    double most_rotation;
    /** Seed of the places; default 1. */
    uint64_t seed;
} luxfer_placement_params;

/** The best placement, and what it means to the target. Set struct_size before the call. */
typedef struct luxfer_placement {
    /** sizeof(luxfer_placement), set by the caller. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /** From the surface's texture coordinates to those of the texture, as luxfer_importance_respond takes it. */
    double placement[9];
    /** Its offset along u and v. */
    double offset[2];
    /** Its scale along u and v. */
    double scale[2];
    /** Its rotation in radians. */
    double rotation;
    /** Mean radiance of the target under the texture alone, in cd/m² per channel. */
    double response[3];
    /** Half-widths of the 95 % confidence intervals of response. */
    double half_width[3];
    /** What cells of twice the side change, noise included; the cells themselves are off by about a third of it. */
    double band_error[3];
} luxfer_placement;

/** As much luminance for the target as possible. */
#define LUXFER_AIM_MOST 0

/** As little. */
#define LUXFER_AIM_LEAST 1

/** The mean radiance of the target that is given, all other light included. */
#define LUXFER_AIM_RADIANCE 2

/**
 * Fills *params with the defaults: any offset, at the scale and rotation there are; size is sizeof *params.
 * LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_placement_params_init(luxfer_placement_params *params, size_t size);

/**
 * Starts a job that finds the placement of a texture (linear, in cd/m²; it repeats) that is best for the target. params may
 * be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_NOT_READY before a map has been traced, LUXFER_INVALID_OPERATION if a job runs already. The job may end with
 * LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_importance_start_placement(luxfer_importance *importance,
                                                luxfer_image *texture,
                                                const luxfer_placement_params *params,
                                                luxfer_job **job);

/**
 * Gets the placement that was found. Any thread.
 * LUXFER_NOT_READY before a job of luxfer_importance_start_placement has succeeded, and again when another map is traced.
 */
luxfer_status luxfer_importance_get_placement(luxfer_importance *importance,
                                              luxfer_placement *placement);

/* ====================================================================================================================
 * Photometry
 *
 * What lighting design calls a light: its correlated colour temperature, and the glare of a view. These calls return when
 * they are done.
 * ==================================================================================================================== */

/** The glare of a view. Set struct_size before the call. */
typedef struct luxfer_glare_report {
    /** sizeof(luxfer_glare_report), set by the caller. */
    uint32_t struct_size;
    /** Sources of glare. */
    uint32_t sources;
    /** Unified glare rating (CIE 117): below 10 means none, 19 is what offices may have; -infinity without sources. */
    double ugr;
    /** Luminance of the background in cd/m². */
    double background;
    /** Luminance from which on a pixel counted as glare, in cd/m². */
    double threshold;
    /** Solid angle of all sources in steradian. */
    double solid_angle;
} luxfer_glare_report;

/**
 * Names a linear colour by the blackbody nearest to it: *kelvin receives the correlated colour temperature, in [1000, 20000],
 * *duv the distance from it in the CIE 1960 diagram, positive where it is greenish. Any thread.
 * LUXFER_DEGENERATE if the colour is black or not finite.
 */
luxfer_status luxfer_colour_temperature(luxfer_context *context,
                                        double red,
                                        double green,
                                        double blue,
                                        double *kelvin,
                                        double *duv);

/**
 * Fills rgb, three numbers, with the linear colour of luminance 1 of a temperature in [1000, 20000] kelvin, at a distance
 * duv, in [-0.05, 0.05], from the blackbody; a channel is negative where the colour is out of gamut. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_colour_of_temperature(luxfer_context *context,
                                           double kelvin,
                                           double duv,
                                           double *rgb);

/**
 * Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB): what a level view sees whose vertical
 * angle is fov_y, in radians. Sources are the connected patches from a luminance of threshold on; 0 = five times the mean.
 * The wider the image, the truer its background. Any thread.
 * LUXFER_INVALID_ARGUMENT if the image is not finite or a value is out of range.
 */
luxfer_status luxfer_image_glare(luxfer_image *image,
                                 double fov_y,
                                 double threshold,
                                 luxfer_glare_report *report);

/* ====================================================================================================================
 * False colour
 *
 * A luminance or illuminance image as colours whose order the eye sees, with a scale bar.
 * ==================================================================================================================== */

/** How values are spread over the colours: a LUXFER_SCALE_ value. */
typedef int32_t luxfer_scale;

/** What the values of an image are: a LUXFER_UNIT_ value. */
typedef int32_t luxfer_unit;

/** Settings of a false colour image. Fill them with luxfer_false_colour_params_init. */
typedef struct luxfer_false_colour_params {
    /** sizeof(luxfer_false_colour_params), set by luxfer_false_colour_params_init. */
    uint32_t struct_size;
    /** LUXFER_SCALE_ value; default LUXFER_SCALE_LINEAR. */
    luxfer_scale scale;
    /** LUXFER_UNIT_ value, written above the bar; default LUXFER_UNIT_LUMINANCE. */
    luxfer_unit unit;
    /** 1: draw the scale bar beside the image, which then is wider; 0: none; default 1. */
    uint32_t bar;
    /**
     * Value of the darkest colour, >= 0; on a logarithmic scale 0 stands for a thousandth of the largest; default 0.
     */
    double least;
    /** Value of the lightest colour, more than least; 0 stands for the largest value of the image; default 0. */
    double most;
} luxfer_false_colour_params;

/** Evenly. */
#define LUXFER_SCALE_LINEAR 0

/** Decades are equally wide. */
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
 * Shows an image (1 channel, or linear RGB, of which the luminance counts) in false colour: linear RGB, grey where a value is
 * NaN. params may be NULL for the defaults. Takes some milliseconds for each megapixel. The caller releases *shown. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT if the range is none, or the image has no light to take it from; LUXFER_OUT_OF_MEMORY beyond the
 * memory budget.
 */
luxfer_status luxfer_image_false_colour(luxfer_image *image,
                                        const luxfer_false_colour_params *params,
                                        luxfer_image **shown);

/* ====================================================================================================================
 * Lighting design
 *
 * What luminaires can make of a light that was found: the drives of their LEDs, the blackbody that comes nearest; what it takes
 * in power; and what a standard asks for. These calls return when they are done.
 * ==================================================================================================================== */

/** A light mixed from primaries. Set struct_size before the call. */
typedef struct luxfer_mixture {
    /** sizeof(luxfer_mixture), set by the caller. */
    uint32_t struct_size;
    /** 1 if it is the colour asked for; 0 if that is out of reach, and this the nearest. */
    uint32_t reached;
    /** The linear colour it is. */
    double colour[3];
    /** CIEDE2000 difference from the colour asked for, seen at the exposure that shows that as a middle grey. */
    double delta_e;
} luxfer_mixture;

/** The blackbody light that suits a target. Set struct_size before the call. */
typedef struct luxfer_temperature_fit {
    /** sizeof(luxfer_temperature_fit), set by the caller. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /** Correlated colour temperature, in [1000, 20000] kelvin. */
    double kelvin;
    /** Luminance of the emission, >= 0, where responses are those to 1 cd/m² of white. */
    double luminance;
    /** Mean radiance of the target under it and all other light, in cd/m². */
    double achieved[3];
    /** CIEDE2000 difference of that from the target, seen at the exposure that shows the target as a middle grey. */
    double delta_e;
} luxfer_temperature_fit;

/**
 * What EN 12464-1 asks of a place, as makers of luminaires quote it. The standard itself is what counts.
 * Set struct_size before the call.
 */
typedef struct luxfer_preset {
    /** sizeof(luxfer_preset), set by the caller. */
    uint32_t struct_size;
    /** Year of the edition of the standard. */
    uint32_t edition;
    /** Least mean illuminance of the task area, in lux. */
    double illuminance;
    /** Largest unified glare rating. */
    double glare;
    /** Least uniformity U0 of the task area. */
    double uniformity;
    /** Least colour rendering index. */
    double rendering;
    /** Least mean illuminance of the walls, in lux; 0 where none is asked for. */
    double walls;
    /** Least mean illuminance of the ceiling, in lux; 0 where none is asked for. */
    double ceiling;
} luxfer_preset;

/**
 * Mixes a linear RGB colour, three numbers that are finite and >= 0, from the LEDs of a luminaire: primaries holds the linear RGB
 * of each at a drive of 1, negative where it is out of gamut; count is in [1, 64]. drives receives count numbers in
 * [0, most]; most may be infinite. Of several mixtures it is the one of least squared drives. Any thread.
 * LUXFER_DEGENERATE if all primaries are black, LUXFER_INVALID_ARGUMENT if a number is out of range.
 */
luxfer_status luxfer_mix_primaries(luxfer_context *context,
                                   const double *primaries,
                                   uint32_t count,
                                   double most,
                                   const double *colour,
                                   double *drives,
                                   luxfer_mixture *mixture);

/**
 * Finds the temperature and strength of blackbody light that bring a target nearest to a mean radiance. response, background
 * and target hold three channels each: what luxfer_relight_get_report or luxfer_importance_respond tell for a white
 * emission, what other lights bring, and what is wanted. Any thread.
 * LUXFER_UNREACHABLE if no channel responds, LUXFER_INVALID_ARGUMENT if a number is not finite.
 */
luxfer_status luxfer_fit_temperature(luxfer_context *context,
                                     const double *response,
                                     const double *background,
                                     const double *target,
                                     luxfer_temperature_fit *fit);

/**
 * Tells the electric power per floor area, in W/m², that a luminous flux takes: flux in lumens, >= 0, efficacy of the
 * luminaires in lumens per watt and area in m², both > 0. Any thread.
 * LUXFER_INVALID_ARGUMENT if a number is out of range.
 */
luxfer_status luxfer_power_density(luxfer_context *context,
                                   double flux,
                                   double efficacy,
                                   double area,
                                   double *density);

/** Tells the number of presets. Any thread. */
luxfer_status luxfer_preset_count(luxfer_context *context, uint32_t *count);

/**
 * Tells what a preset asks for. Any thread.
 * LUXFER_NOT_FOUND if there is no such preset.
 */
luxfer_status luxfer_preset_get(luxfer_context *context, uint32_t index, luxfer_preset *preset);

/**
 * Copies the name of a preset, such as "office: filing, copying", zero-terminated, into buffer of capacity bytes, cut if it is
 * longer. *needed, unless NULL, receives the capacity for all of it. Any thread.
 * LUXFER_NOT_FOUND if there is no such preset.
 */
luxfer_status luxfer_preset_name(luxfer_context *context,
                                 uint32_t index,
                                 char *buffer,
                                 size_t capacity,
                                 size_t *needed);

/* ====================================================================================================================
 * Pattern
 *
 * How the lights of a transfer lie on the surface: how large, how turned, from where on, and where not.
 * ==================================================================================================================== */

/** What sets the size of the pattern on the surface: a LUXFER_PATTERN_ value. */
typedef int32_t luxfer_pattern_scale;

/**
 * How the pattern lies on the surface, whose axes u and v and corner are those of luxfer_surface. Fill it with
 * luxfer_pattern_params_init.
 */
typedef struct luxfer_pattern_params {
    /** sizeof(luxfer_pattern_params), set by luxfer_pattern_params_init. */
    uint32_t struct_size;
    /** LUXFER_PATTERN_ value; default LUXFER_PATTERN_DISTANCE. */
    luxfer_pattern_scale scale;
    /** What the lamp or the spacing measures, in metres, in [1e-6, 1e6]; default 1. The other scales do not read it. */
    double length;
    /**
     * Metres per texel, in [0, 1e6]; 0, the default, is as fine as the unwarped photo, where max_texels of
     * luxfer_transfer_params allows it.
     */
    double texel_size;
    /** Turn of the pattern from u towards v in radians, in [-2 pi, 2 pi]; default 0. */
    double rotation;
    /**
     * Shift of the pattern along its own axes in metres, each in [-1e6, 1e6]; default 0. Lamps without a lattice go anywhere,
     * and are not shifted.
     */
    double offset[2];
    /**
     * Distance in metres that lamps keep from the edge of the surface and from the zones of luxfer_transfer_set_zones, in
     * [-1, 1e6]; those that do not are left
     * out. Below 0 the edge of the surface cuts lamps; default -1.
     */
    double margin;
} luxfer_pattern_params;

/** The distance of the photo's camera from the lit plane: plane_distance of luxfer_transfer_params. */
#define LUXFER_PATTERN_DISTANCE 0

/** The length of a lamp: the longer side of the photo's, of which the median counts. */
#define LUXFER_PATTERN_LAMP 1

/**
 * The shorter period of the lattice of lamps; without a lattice, the median distance from a lamp to the nearest other.
 */
#define LUXFER_PATTERN_SPACING 2

/** The width of the surface: it becomes as many lamps wide as the photo's plane. */
#define LUXFER_PATTERN_ACROSS 3

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_pattern_params_init(luxfer_pattern_params *params,
                                         size_t size);

/* ====================================================================================================================
 * Transfer
 *
 * The lighting transfer from end to end: from a photo, a few strokes and a scene to that scene lit as in the photo. It
 * runs the stages in order. Every result can be read as soon as its stage has ended, replaced by the caller's own, and the
 * run taken up again from any stage.
 * ==================================================================================================================== */

/** A lighting transfer. See luxfer_transfer_create. */
typedef struct luxfer_transfer luxfer_transfer;

/** What part of the photo gives the colour to match: a LUXFER_TARGET_ value. */
typedef int32_t luxfer_target;

/**
 * Settings of a transfer. Fill them with luxfer_transfer_params_init. The structs pointed to are read during the call.
 */
typedef struct luxfer_transfer_params {
    /** sizeof(luxfer_transfer_params), set by luxfer_transfer_params_init. */
    uint32_t struct_size;
    /** Longest side of the emissive texture in texels, in [1, 16384]; default 2048. */
    uint32_t max_texels;
    /**
     * Distance of the photo's camera from the lit plane in metres, in [0.01, 1e4]; default 1.2. It sets the scale of the
     * pattern.
     */
    double plane_distance;
    /** Luminance that the photo's white stands for, in cd/m², in [1e-6, 1e9]; default 100. */
    float white_luminance;
    /** LUXFER_TARGET_ value; default LUXFER_TARGET_SURFACE. */
    luxfer_target target;
    /** Settings of the stages VIEW and UNWARP; NULL, the default, for their defaults. */
    const luxfer_rectify_params *rectify;
    /** Settings of the stage FEATURES; NULL, the default, for their defaults. */
    const luxfer_features_params *features;
    /** Settings of the stage PLANE; NULL, the default, for their defaults. */
    const luxfer_segment_params *plane;
    /** Settings of the stage LIGHTS; NULL, the default, for those of luxfer_segment with channels = 7, colour only. */
    const luxfer_segment_params *lights;
    /**
     * Settings of the stage EMISSION, whose width, height, scale and offset the transfer sets; NULL, the default, for their
     * defaults.
     */
    const luxfer_emission_params *emission;
    /** Settings of the stage RELIGHT; NULL, the default, for their defaults. */
    const luxfer_relight_params *relight;
    /** Settings of the stage RENDER; NULL, the default, for their defaults. */
    const luxfer_render_params *render;
    /** How the lights lie on the surface; NULL, the default, for the defaults. */
    const luxfer_pattern_params *pattern;
} luxfer_transfer_params;

/** A stage of the transfer: a LUXFER_STAGE_ value, in the order they run. */
typedef int32_t luxfer_stage;

/** Lines, vanishing points and the photo's camera. */
#define LUXFER_STAGE_VIEW 0

/** Ten channels for each pixel. */
#define LUXFER_STAGE_FEATURES 1

/** The mask of the plane that carries the lights. */
#define LUXFER_STAGE_PLANE 2

/** The mask of the lights in it. */
#define LUXFER_STAGE_LIGHTS 3

/** The plane seen straight on. */
#define LUXFER_STAGE_UNWARP 4

/** The emissive texture, laid onto the scene's surface. */
#define LUXFER_STAGE_EMISSION 5

/** Its colour and intensity. */
#define LUXFER_STAGE_RELIGHT 6

/** The picture. */
#define LUXFER_STAGE_RENDER 7

/** The plane that carries the lights, without them and their halo. */
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

/** Sets the photo: linear RGB, 1 = display white. Strokes set for a photo of another size are dropped. Any thread. */
luxfer_status luxfer_transfer_set_photo(luxfer_transfer *transfer,
                                        luxfer_image *photo);

/** Sets a depth map of the photo, as luxfer_features_set_depth. depth may be NULL: none. Any thread. */
luxfer_status luxfer_transfer_set_depth(luxfer_transfer *transfer,
                                        luxfer_image *depth,
                                        luxfer_depth_kind kind);

/**
 * Sets the scene to light, and the name (UTF-8) of the object or material of its surface that receives the lights. The
 * scene itself is never changed; each start takes it as it is then. Of all the triangles of that name the plane is taken that
 * faces most of the room: its parts, as between the beams of a ceiling, share one pattern that goes on from part to part. What
 * lies in other planes is left as it is; another transfer lights it, with a pattern of its own. Any thread.
 */
luxfer_status luxfer_transfer_set_scene(luxfer_transfer *transfer,
                                        luxfer_scene *scene,
                                        const char *surface);

/**
 * Sets the triangles of the scene, mesh and triangle of each, that receive the lights instead of those of a name; of these too
 * the plane is taken that faces most of the room. They replace those set before, and luxfer_transfer_set_scene takes them away;
 * triangles may be NULL if count is 0: none, the name counts again. Any thread.
 * A run ends with LUXFER_INVALID_ARGUMENT if the scene does not have them.
 */
luxfer_status luxfer_transfer_set_triangles(luxfer_transfer *transfer,
                                            const uint32_t *triangles,
                                            size_t count);

/**
 * Sets an emissive texture, linear RGB relative to the photo's white, that the stage EMISSION stretches over the surface
 * as it is instead of making one from the photo. texture may be NULL, the default: one is made. Any thread.
 */
luxfer_status luxfer_transfer_set_texture(luxfer_transfer *transfer,
                                          luxfer_image *texture);

/**
 * Sets the camera of the picture. camera may be NULL, the default: the scene's first, or one chosen in a corner
 * of the room if it has none. Any thread.
 */
luxfer_status luxfer_transfer_set_camera(luxfer_transfer *transfer,
                                         const luxfer_camera_params *camera);

/**
 * Adds a stroke on the photo that concerns phase, a LUXFER_PHASE_ value; otherwise as luxfer_segment_add_stroke. Strokes on
 * lights are examples of the plane as well. Any thread.
 * LUXFER_INVALID_OPERATION before the photo is set.
 */
luxfer_status luxfer_transfer_add_stroke(luxfer_transfer *transfer,
                                         luxfer_phase phase,
                                         const float *points,
                                         size_t point_count,
                                         float radius,
                                         int32_t positive);

/**
 * Adds the strokes of both phases from a drawing of the photo's size, as luxfer_segment_add_strokes_image. Any thread.
 * LUXFER_INVALID_OPERATION before the photo is set.
 */
luxfer_status luxfer_transfer_add_strokes_image(luxfer_transfer *transfer,
                                                luxfer_image *drawing);

/**
 * Adds the strokes of both phases from a text, as luxfer_segment_add_strokes_text. Any thread.
 * LUXFER_INVALID_OPERATION before the photo is set.
 */
luxfer_status luxfer_transfer_add_strokes_text(luxfer_transfer *transfer, const char *description);

/**
 * Sets rectangles of the surface that lamps keep away from, as behind ducts and sprinklers: u0, v0, u1 and v1 of each in
 * metres from the surface's corner along its axes (luxfer_surface), with u0 <= u1 and v0 <= v1. They replace those set
 * before; zones may be NULL if count is 0. Any thread.
 */
luxfer_status luxfer_transfer_set_zones(luxfer_transfer *transfer,
                                        const double *zones,
                                        size_t count);

/** Removes all strokes. Any thread. */
luxfer_status luxfer_transfer_clear_strokes(luxfer_transfer *transfer);

/**
 * Puts the lines and the camera that a luxfer_rectify has found, and the plane if it has unwarped one, in the place of the
 * results of the stages VIEW and UNWARP. Any thread.
 * LUXFER_NOT_READY if it has found none yet.
 */
luxfer_status luxfer_transfer_use_rectify(luxfer_transfer *transfer,
                                          luxfer_rectify *rectify);

/**
 * Puts the result of a luxfer_features in the place of that of the stage FEATURES. Any thread.
 * LUXFER_NOT_READY if it has none yet.
 */
luxfer_status luxfer_transfer_use_features(luxfer_transfer *transfer, luxfer_features *features);

/**
 * Puts the result of a luxfer_segment in the place of that of the stage PLANE or LIGHTS, as phase, a LUXFER_PHASE_ value,
 * says. Any thread.
 * LUXFER_NOT_READY if it has none yet.
 */
luxfer_status luxfer_transfer_use_segment(luxfer_transfer *transfer,
                                          luxfer_phase phase,
                                          luxfer_segment *segment);

/**
 * Puts a mask of the photo's size, such as one drawn by hand, in the place of the result of the stage PLANE or LIGHTS, as
 * phase, a LUXFER_PHASE_ value, says; 1 channel, taken as a confidence in [0, 1]. Any thread.
 */
luxfer_status luxfer_transfer_use_mask(luxfer_transfer *transfer,
                                       luxfer_phase phase,
                                       luxfer_image *mask);

/**
 * Starts a job that runs the stages first to last, LUXFER_STAGE_ values, both included; those before must have results.
 * params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if a job runs already, or an input or the result of an earlier stage is missing;
 * LUXFER_INVALID_ARGUMENT for a setting of one of the stages that is out of range. The job may end as the jobs of its
 * stages may, the message naming the stage, and ends at once if the scene has no such surface; the results of the stages
 * before stay.
 */
luxfer_status luxfer_transfer_start(luxfer_transfer *transfer,
                                    luxfer_stage first,
                                    luxfer_stage last,
                                    const luxfer_transfer_params *params,
                                    luxfer_job **job);

/** Adds a reference. Any thread. */
luxfer_status luxfer_transfer_retain(luxfer_transfer *transfer);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_transfer_release(luxfer_transfer *transfer);

/* ====================================================================================================================
 * Transfer results
 *
 * What a transfer has made so far. Results appear when their stage has ended; the picture grows while it is rendered.
 * ==================================================================================================================== */

/** An image of the transfer: a LUXFER_TRANSFER_ value. */
typedef int32_t luxfer_transfer_image;

/** A scene of the transfer: a LUXFER_SCENE_ value. */
typedef int32_t luxfer_transfer_scene;

/**
 * What each stage took and how good its result is. Set struct_size before the call. Errors of stages without a result are
 * NaN.
 */
typedef struct luxfer_transfer_report {
    /** sizeof(luxfer_transfer_report), set by the caller. */
    uint32_t struct_size;
    /** Number of fixtures; see luxfer_transfer_get_fixture. 0 before the stage RELIGHT has ended. */
    uint32_t fixtures;
    /** Seconds each stage took when it last ran, by LUXFER_STAGE_ value. */
    double seconds[8];
    /** Largest standard deviation of a vanishing point's direction, in radians. */
    double view_error;
    /** Mean trust in the depth of the features, in [0, 1]. */
    double depth_confidence;
    /** Expected share of wrong pixels in the mask of the plane. */
    double plane_error;
    /** Expected share of wrong pixels in the mask of the lights. */
    double lights_error;
    /** Largest expected error of a corner of the unwarped image, in unwarped pixels. */
    double unwarp_error;
    /** Relative difference between texture and photo in the share of lit area. */
    double emission_error;
    /** Widest relative half-width of the solution's 95 % intervals. */
    double relight_error;
    /**
     * As the error of luxfer_render_report: root mean square of the picture's standard errors, relative to its mean.
     */
    double render_error;
    /** Size of a texel of the emission in metres. */
    double texel_size;
    /** Mean colour the surface is to have, relative to the photo's white. */
    float target[3];
    /** 0. */
    uint32_t reserved;
} luxfer_transfer_report;

/** One lamp of the lit scene. Set struct_size before the call. */
typedef struct luxfer_fixture {
    /** sizeof(luxfer_fixture), set by the caller. */
    uint32_t struct_size;
    /** Centre in metres. */
    float position[3];
    /** Unit direction the lamp shines in. */
    float normal[3];
    /** Unit direction of its long axis. */
    float axis[3];
    /** Mean luminance per channel in cd/m². */
    float radiance[3];
    /** Number of its kind, as of luxfer_luminaire. */
    uint32_t kind;
    /** Lengths along and across the axis in metres. */
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

/** The scene in its new light, linear RGB in cd/m²; while it is being rendered, as far as it is. */
#define LUXFER_TRANSFER_RENDER 9

/** Variance of the rendering; 3 channels. */
#define LUXFER_TRANSFER_RENDER_VARIANCE 10

/**
 * The picture with its noise filtered out, if the settings of the stage RENDER have a preview; see LUXFER_RENDER_PREVIEW.
 */
#define LUXFER_TRANSFER_RENDER_PREVIEW 11

/** With the emission at the photo's own strength, before it is solved for. */
#define LUXFER_SCENE_UNSOLVED 0

/** With the solved emission: the result. */
#define LUXFER_SCENE_LIT 1

/** As LUXFER_SCENE_LIT, the light's colour taken away and its luminance kept. */
#define LUXFER_SCENE_WHITE 2

/**
 * Gets an image; which is a LUXFER_TRANSFER_ value. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before the stage that makes it has ended; LUXFER_NOT_FOUND for a preview that was not asked for.
 */
luxfer_status luxfer_transfer_get_image(luxfer_transfer *transfer,
                                        luxfer_transfer_image which,
                                        luxfer_image **image);

/**
 * Gets a scene; which is a LUXFER_SCENE_ value. The caller releases *scene, which is independent of the transfer. Any
 * thread.
 * LUXFER_NOT_READY before the stage EMISSION, for LUXFER_SCENE_UNSOLVED, or RELIGHT has ended.
 */
luxfer_status luxfer_transfer_get_scene(luxfer_transfer *transfer,
                                        luxfer_transfer_scene which,
                                        luxfer_scene **scene);

/**
 * Tells what each stage took and how good its result is. Any thread.
 * LUXFER_NOT_READY before the first stage has ended.
 */
luxfer_status luxfer_transfer_get_report(luxfer_transfer *transfer, luxfer_transfer_report *report);

/**
 * Tells what the lines of the photo say about its camera, and how the plane is unwarped. Any thread.
 * LUXFER_NOT_READY before the stage VIEW has ended.
 */
luxfer_status luxfer_transfer_get_view(luxfer_transfer *transfer, luxfer_rectify_report *view);

/**
 * Tells the solved colour and intensity and how sure they are. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended.
 */
luxfer_status luxfer_transfer_get_solution(luxfer_transfer *transfer, luxfer_relight_report *solution);

/**
 * Describes a lamp of the lit scene. Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_NOT_FOUND if there is no such fixture.
 */
luxfer_status luxfer_transfer_get_fixture(luxfer_transfer *transfer,
                                          uint32_t index,
                                          luxfer_fixture *fixture);

/**
 * Writes the luminaire schedule, every lamp of the lit scene, to a file whose name ends in .csv or .json: position, normal,
 * axis, size, area, luminance, flux and colour temperature, their units in the names of the columns; in .json also the corners of the outline
 * in metres, as "outline_m". Any thread.
 * LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_INVALID_ARGUMENT for another ending; LUXFER_IO if
 * the file cannot be written.
 */
luxfer_status luxfer_transfer_save_fixtures(luxfer_transfer *transfer,
                                            const char *path);

/* ====================================================================================================================
 * Planning
 *
 * Settings for an error or a time, before anything is rendered: state either, and a plan tells with which settings
 * relighting and rendering, or a stylisation, come to it, how long each should take, and what error should be left. What a
 * path costs and how much light scatters depends on the scene, so a plan measures it on a small part of the very work, which
 * takes some tenths of a second beside making the scene ready. It assumes that the machine stays as quiet as it is meanwhile.
 *
 * Errors are those of a picture: the root mean square over its pixels, relative to its mean, of noise and of what the
 * solution of the emission makes too bright or too dark; that of a stylisation is told by luxfer_plan_start_stylize.
 * ==================================================================================================================== */

/** A plan. See luxfer_plan_create. */
typedef struct luxfer_plan luxfer_plan;

/** What a plan is made for: one of its fields must be set. Fill it with luxfer_plan_params_init. */
typedef struct luxfer_plan_params {
    /** sizeof(luxfer_plan_params), set by luxfer_plan_params_init. */
    uint32_t struct_size;
    /** Milliseconds for all that is planned; default 0: the error counts. */
    uint32_t time_budget_ms;
    /**
     * Error of the picture, root mean square over its pixels relative to its mean, in [1e-5, 1]; default 0: the time counts.
     */
    float target_error;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_plan_params;

/** What a plan expects. Set struct_size before the call. */
typedef struct luxfer_plan_report {
    /** sizeof(luxfer_plan_report), set by the caller. */
    uint32_t struct_size;
    /** 1 if the plan relights, as that of a transfer; 0 if it is of a rendering or a stylisation. */
    uint32_t relights;
    /** Seconds for all that is planned. */
    double seconds;
    /** Error of the picture. */
    double error;
    /** Seconds for relighting, which makes the scene ready first; 0 in other plans than that of a transfer. */
    double relight_seconds;
    /** The error that luxfer_relight_report should state, half the width of its interval; 0 in other plans. */
    double relight_error;
    /** Seconds for rendering; in a plan of a transfer it makes the scene ready first; 0 in a plan of a stylisation. */
    double render_seconds;
    /** The error that luxfer_render_report should state; 0 in a plan of a stylisation. */
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
 * Starts a job that plans a rendering with the scene and the camera of render. settings gives the size of the picture and
 * all that is no matter of quality; NULL for the defaults. params says what for. The caller releases *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if params is NULL, or has not one of its fields set, or a setting is out of range;
 * LUXFER_INVALID_OPERATION if the scene is missing or a job runs already; LUXFER_NOT_FOUND if the scene has no such camera.
 */
luxfer_status luxfer_plan_start_render(luxfer_plan *plan,
                                       luxfer_render *render,
                                       const luxfer_render_params *settings,
                                       const luxfer_plan_params *params,
                                       luxfer_job **job);

/**
 * Starts a job that plans the stages RELIGHT and RENDER of a transfer, with the lamps that its stage EMISSION has made.
 * settings are those the transfer will be started with, of which luxfer_plan_get_relight_params and _get_render_params
 * replace what is a matter of quality; NULL for the defaults. params says what for. The caller releases *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if params is NULL, or has not one of its fields set, or a setting is out of range;
 * LUXFER_INVALID_OPERATION before the stage EMISSION has a result, or if a job runs already. The job may end with
 * LUXFER_UNREACHABLE if no light of the lamps comes back to their surface.
 */
luxfer_status luxfer_plan_start_transfer(luxfer_plan *plan,
                                         luxfer_transfer *transfer,
                                         const luxfer_transfer_params *settings,
                                         const luxfer_plan_params *params,
                                         luxfer_job **job);

/**
 * Tells what the plan expects. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_plan_get_report(luxfer_plan *plan, luxfer_plan_report *report);

/**
 * Gets the settings to render with: those given, with what the plan has chosen. With an error as goal rendering stops when it
 * is reached; with a time the number of paths is chosen, and time_budget_ms is a quarter more than they should take, so
 * that the picture is the same every time unless the machine is slower than it was. Set params->struct_size before. Any
 * thread. LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND in a plan of a stylisation.
 */
luxfer_status luxfer_plan_get_render_params(luxfer_plan *plan,
                                            luxfer_render_params *params);

/**
 * Gets the settings to relight with, likewise. Set params->struct_size before. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND in other plans than that of a transfer.
 */
luxfer_status luxfer_plan_get_relight_params(luxfer_plan *plan, luxfer_relight_params *params);

/** Adds a reference. Any thread. */
luxfer_status luxfer_plan_retain(luxfer_plan *plan);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_plan_release(luxfer_plan *plan);

/* ====================================================================================================================
 * Guides
 *
 * What the light does in a scene, as images for a stylisation: rendered once for the exemplar, once for the target. Guides
 * from another renderer need none of this: see luxfer_stylize_add_guide.
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
    /** 1: smooth the light along surfaces, so that noise is not matched; default 1. */
    uint32_t smooth;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_guides_params;

/** An image of guides: a LUXFER_GUIDES_ value. Light is linear RGB in cd/m². */
typedef int32_t luxfer_guides_image;

/** All light. */
#define LUXFER_GUIDES_FULL 0

/** Light reflected once, by something matt (LDE). */
#define LUXFER_GUIDES_DIRECT 1

/** Light reflected once, by something glossy (LSE). */
#define LUXFER_GUIDES_SPECULAR 2

/** Light whose last two reflections were matt (L.*DDE): where colours bleed. */
#define LUXFER_GUIDES_INDIRECT 3

/** Light reflected once or twice, by matt things (LD{1,2}E): what is in the shadow. */
#define LUXFER_GUIDES_TWO_BOUNCES 4

/** Normals as the camera has them: x right, y up, z towards it; 3 channels. */
#define LUXFER_GUIDES_NORMALS 5

/** Edges of shapes, in [0, 1]; 1 channel. */
#define LUXFER_GUIDES_EDGES 6

/** A colour for each material, made from its name; 3 channels. */
#define LUXFER_GUIDES_MATERIALS 7

/** Light that glossy things throw onto matt ones (LS+DE). */
#define LUXFER_GUIDES_CAUSTICS 8

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_guides_params_init(luxfer_guides_params *params,
                                        size_t size);

/** Creates the stage. The caller releases *guides. Any thread. */
luxfer_status luxfer_guides_create(luxfer_context *context, luxfer_guides **guides);

/** Sets the scene; each start renders it as it is then. Any thread. */
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
 * Makes the motion between two frames of one scene seen by a camera that moves, for luxfer_stylize_set_motion: where each
 * pixel of this frame was in the frame before, relative to where it is, x and y in pixels, NaN where it was not to be seen. The
 * caller releases *motion. Any thread.
 * LUXFER_NOT_READY before both are rendered; LUXFER_INVALID_ARGUMENT if their sizes differ.
 */
luxfer_status luxfer_guides_motion(luxfer_guides *guides,
                                   luxfer_guides *before,
                                   luxfer_image **motion);

/** Adds a reference. Any thread. */
luxfer_status luxfer_guides_retain(luxfer_guides *guides);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_guides_release(luxfer_guides *guides);

/* ====================================================================================================================
 * Settings of a stylisation
 *
 * Presets, and every knob. The defaults are chosen on the curves of quality against time that benches/stylit.rs draws.
 * ==================================================================================================================== */

/** How matches between exemplar and target are made: a LUXFER_STYLIZE_MODE_ value. */
typedef int32_t luxfer_stylize_mode;

/** How nearest patches are searched for: a LUXFER_STYLIZE_SEARCH_ value. */
typedef int32_t luxfer_stylize_search;

/** How patches that overlap make a pixel: a LUXFER_STYLIZE_VOTE_ value. */
typedef int32_t luxfer_stylize_vote;

/**
 * Settings of a stylisation. Fill them with luxfer_stylize_params_init or luxfer_stylize_params_preset; the defaults given
 * here are those of LUXFER_STYLIZE_FULL.
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
    /** Weight of all guides together against the artwork's colours together, in [0, 1e6]; default 2. */
    float guide_weight;
    /** Most resolution levels, each half of the next, in [1, 16]; default 6. */
    uint32_t levels;
    /** Rounds of matching and painting on the level before the finest, in [1, 100]; default 6. */
    uint32_t iterations;
    /** Rounds on the finest level, in [1, 100]; default 1. */
    uint32_t finest_iterations;
    /**
     * Rounds after those, without the budget, in which each place takes its nearest match, in [0, 100]; default 3; 0 is the
     * paper's. Modes without a budget do as many more of their own.
     */
    uint32_t polish;
    /** Sweeps of a search, in [1, 100]; default 1. */
    uint32_t sweeps;
    /**
     * Share of the target that is matched under the budget before the rest is matched without, in [0, 1]; default 0.9.
     */
    float coverage;
    /** Most passes of matching under the budget in a round, in [1, 1000]; default 6. */
    uint32_t passes;
    /**
     * Sweeps in which places may continue their neighbours' matches, for fewer seams, in [0, 100]; default 2; 0 is the
     * paper's.
     */
    uint32_t settle;
    /** What a seam between neighbours costs in those sweeps, as a share of the mean error, in [0, 100]; default 0.2. */
    float seam;
    /** LUXFER_STYLIZE_VOTE_ value; default LUXFER_STYLIZE_VOTE_WEIGHTED. */
    luxfer_stylize_vote vote;
    /** LUXFER_STYLIZE_VOTE_ value for the final picture; default LUXFER_STYLIZE_VOTE_MOST. */
    luxfer_stylize_vote final_vote;
    /** 1: work at half resolution with compressed guides, so the picture is half as wide and high; default 0. */
    uint32_t preview;
    /** 1: keep what luxfer_stylize_update needs, about as much memory as all guides take; default 0. */
    uint32_t keep_for_update;
    /**
     * Share of the paint of the frame before that is kept where it fits, in [0, 1]; default 1. Below 1 it boils, as
     * hand-painted frames do, if each frame has its own seed. Without luxfer_stylize_set_motion it has no effect.
     */
    float coherence;
    /** How far the exemplar's light is changed to the brightness and contrast of the target's, in [0, 1]; default 0. */
    float match_appearance;
    /** Seed of the search; default 1. */
    uint64_t seed;
    /**
     * How many times as much the guides weigh on all levels but the finest, in [0, 1000]; default 4; 1 is the paper's. More
     * follows the guides more closely, in smaller pieces.
     */
    float coarse_guides;
    /** Rounds on each level coarser than the one before the finest, in [1, 100]; default 24; 6 is the paper's. */
    uint32_t coarse_iterations;
    /**
     * Weight of usage in LUXFER_STYLIZE_MODE_OCCURRENCE, lambda, in [0, 10]; default 0.1, which Fiser et al. found best by
     * hand (Fig. 10n). What a match to a patch that is used as often as all on average costs beside its distance, both in the
     * unit of Eq. 1: squared differences of channels in [0, 1], summed over a patch. 0 is LUXFER_STYLIZE_MODE_NEAREST.
     */
    float occurrence;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_stylize_params;

/** How good and how fast: a LUXFER_STYLIZE_ preset. */
typedef int32_t luxfer_stylize_preset;

/** Full quality, the default. */
#define LUXFER_STYLIZE_FULL 0

/** Nearly as good in half the time. */
#define LUXFER_STYLIZE_FAST 1

/** Half resolution, guides compressed: for watching while painting. */
#define LUXFER_STYLIZE_PREVIEW 2

/** The settings of the paper, for comparison. */
#define LUXFER_STYLIZE_PAPER 3

/** Exemplar patches look for their places under an error budget (Fiser et al. 2016), the default. */
#define LUXFER_STYLIZE_MODE_BUDGET 0

/** Every exemplar patch is used equally often (Jamriska et al. 2015). */
#define LUXFER_STYLIZE_MODE_UNIFORM 1

/** Each place takes its nearest exemplar patch (Wexler et al. 2007). */
#define LUXFER_STYLIZE_MODE_NEAREST 2

/** One pass in scan order (Hertzmann et al. 2001); on one thread. */
#define LUXFER_STYLIZE_MODE_GREEDY 3

/**
 * Each pixel takes the exemplar pixel whose guides are nearest; with normals as guides the Lit Sphere (Sloan et al. 2001).
 */
#define LUXFER_STYLIZE_MODE_LIT_SPHERE 4

/**
 * Each place takes its nearest exemplar patch, and one that is used often counts as farther (Kaspar et al. 2015): see
 * occurrence. On one thread, and by LUXFER_STYLIZE_SEARCH_PATCHMATCH only.
 */
#define LUXFER_STYLIZE_MODE_OCCURRENCE 5

/** PatchMatch, the default. */
#define LUXFER_STYLIZE_SEARCH_PATCHMATCH 0

/** A k-d tree over the means of patches: not PatchMatch. */
#define LUXFER_STYLIZE_SEARCH_TABLE 1

/** Their mean. */
#define LUXFER_STYLIZE_VOTE_PLAIN 0

/** Their mean, closer matches counting more. */
#define LUXFER_STYLIZE_VOTE_WEIGHTED 1

/** The one nearest to their mean, so that no colour is made that is not in the artwork. */
#define LUXFER_STYLIZE_VOTE_NEAREST 2

/** The one that most of them put there, so that pieces of the artwork stay whole up to their seams. */
#define LUXFER_STYLIZE_VOTE_MOST 3

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_stylize_params_init(luxfer_stylize_params *params,
                                         size_t size);

/**
 * Sets *params, filled before by luxfer_stylize_params_init, to a preset: LUXFER_STYLIZE_FULL, _FAST, _PREVIEW or _PAPER.
 * LUXFER_INVALID_ARGUMENT for another value.
 */
luxfer_status luxfer_stylize_params_preset(luxfer_stylize_params *params,
                                           luxfer_stylize_preset preset);

/* ====================================================================================================================
 * Stylisation
 *
 * Paints a target scene as an artist has painted an exemplar scene (StyLit). Give the artwork, pairs of images that show
 * what the light does in the exemplar and in the target (the guides), and start; or give a half-painted picture and have
 * the rest painted. While its job runs, and after a cancel, the picture of the finest level done can be read.
 *
 * Some of its methods are covered by patents in some countries, so a build of the library may leave it out: its
 * functions are there all the same, and luxfer_stylize_create then returns LUXFER_UNSUPPORTED.
 * ==================================================================================================================== */

/** Flag of luxfer_stylize_add_guides: normals too. */
#define LUXFER_GUIDES_WITH_NORMALS 1

/** Flag: edges too, for shapes finer than the strokes. */
#define LUXFER_GUIDES_WITH_EDGES 2

/** Flag: the colour code of materials too, so that things of one material are painted from things of the same. */
#define LUXFER_GUIDES_WITH_MATERIALS 4

/** Flag: caustics too, light at the common exposure, for scenes in which glossy things throw light onto others. */
#define LUXFER_GUIDES_WITH_CAUSTICS 8

/** A stylisation. See luxfer_stylize_create. */
typedef struct luxfer_stylize luxfer_stylize;

/** What the numbers of a guide mean: a LUXFER_GUIDE_ value. */
typedef int32_t luxfer_guide_range;

/** Linear light >= 0, such as renderings; compared as it would look on a screen. */
#define LUXFER_GUIDE_LIGHT 0

/**
 * Numbers without a curve, such as normals, object codes and edges; the range of both images together becomes [0, 1].
 */
#define LUXFER_GUIDE_DATA 1

/**
 * Creates the stage. The caller releases *stylize. Any thread.
 * LUXFER_UNSUPPORTED if stylisation was left out of this build.
 */
luxfer_status luxfer_stylize_create(luxfer_context *context, luxfer_stylize **stylize);

/**
 * Sets the artwork: the exemplar scene as the artist has painted it, linear colour, 1, 3 or 4 channels, aligned with the
 * sources of the guides and of their size. Any thread.
 */
luxfer_status luxfer_stylize_set_artwork(luxfer_stylize *stylize,
                                         luxfer_image *artwork);

/**
 * Adds a guide, or replaces the one of the same name: source shows the exemplar and target what is to be painted, with as
 * many channels (60 at most in all guides). target may be NULL: the same image as source, for a picture that is
 * half painted (luxfer_stylize_set_painted). weight, in [0, 1e6], is relative to the other guides'; range is a
 * LUXFER_GUIDE_ value. All sources have one size, and all targets. Samples that are no numbers count as 0 in the target; the
 * exemplar's pixels that have any are not used. Any thread.
 * LUXFER_INVALID_ARGUMENT if the channels differ, are too many, or a value is out of range.
 */
luxfer_status luxfer_stylize_add_guide(luxfer_stylize *stylize,
                                       const char *name,
                                       luxfer_image *source,
                                       luxfer_image *target,
                                       float weight,
                                       luxfer_guide_range range);

/**
 * Adds the guides of two scenes, both rendered: the five of light at a common exposure, named after LUXFER_GUIDES_FULL to
 * LUXFER_GUIDES_TWO_BOUNCES "full", "direct", "specular", "indirect" and "two bounces", each with weight 1; and for each of
 * the LUXFER_GUIDES_WITH_ flags in extras the one it names ("caustics", "normals", "edges", "materials"), with weight
 * extra_weight. Any thread.
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
 * Sets where the artwork may be copied from: above 0.5; 1 channel, the artwork's size. mask may be NULL: everywhere. Any
 * thread.
 */
luxfer_status luxfer_stylize_set_source_mask(luxfer_stylize *stylize,
                                             luxfer_image *mask);

/**
 * Sets which pixels of the target to paint: above 0.5; 1 channel, the size of the guides' targets. The others are those of
 * known (linear, as many channels as the artwork), to which what is painted is joined, or black if known is NULL. mask
 * may be NULL: everything is painted. Any thread.
 */
luxfer_status luxfer_stylize_set_target_mask(luxfer_stylize *stylize,
                                             luxfer_image *mask,
                                             luxfer_image *known);

/**
 * Makes each start go on from the result before, the last frame of a sequence: motion (2 channels, the size of the guides'
 * targets) tells where each pixel was in that frame, relative to where it is now, x and y in pixels, NaN where it was not
 * to be seen. What was painted there moves along and stays where it fits; see luxfer_stylize_params.coherence. motion may
 * be NULL: each start begins anew. Any thread.
 */
luxfer_status luxfer_stylize_set_motion(luxfer_stylize *stylize,
                                        luxfer_image *motion);

/**
 * Starts a job that stylises. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if artwork or guides are missing or a job runs already; LUXFER_INVALID_ARGUMENT if a setting is
 * out of range; LUXFER_NOT_READY if motion is set and there is no result before. The job may end with LUXFER_INVALID_ARGUMENT if sizes differ or a side is above 32768 pixels,
 * LUXFER_DEGENERATE if a mask is empty or leaves no exemplar patch.
 */
luxfer_status luxfer_stylize_start(luxfer_stylize *stylize,
                                   const luxfer_stylize_params *params,
                                   luxfer_job **job);

/**
 * Starts a job that follows a change of the artwork: where the 1-channel image changed is above 0.5, artwork (of the first
 * one's size and channels) has new paint, and what was painted from there is painted anew. Takes a fraction of the time
 * of luxfer_stylize_start. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION unless a job was started with keep_for_update = 1 and has succeeded, or if one runs. The job may
 * end with LUXFER_INVALID_ARGUMENT if sizes differ; after a cancel the next update makes up for what was left.
 */
luxfer_status luxfer_stylize_update(luxfer_stylize *stylize,
                                    luxfer_image *artwork,
                                    luxfer_image *changed,
                                    luxfer_job **job);

/**
 * Has the rest of a half-painted picture painted: the artwork is the picture, painted (1 channel, its size) is above 0.5
 * where it is done, and the guides' sources show its scene, with NULL as target. Same as painted as the source mask, its
 * opposite as the target mask and the artwork as known. Any thread.
 * LUXFER_INVALID_OPERATION before the artwork is set; LUXFER_INVALID_ARGUMENT if painted has not its size or not 1 channel.
 */
luxfer_status luxfer_stylize_set_painted(luxfer_stylize *stylize,
                                         luxfer_image *painted);

/** Adds a reference. Any thread. */
luxfer_status luxfer_stylize_retain(luxfer_stylize *stylize);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_stylize_release(luxfer_stylize *stylize);

/* ====================================================================================================================
 * Results of a stylisation
 *
 * The picture, where it was copied from, how well it follows the guides, and what the run did level by level.
 * ==================================================================================================================== */

/** An image of a stylisation: a LUXFER_STYLIZE_IMAGE_ value. */
typedef int32_t luxfer_stylize_image;

/** How good a stylisation is. Set struct_size before the call. */
typedef struct luxfer_stylize_report {
    /** sizeof(luxfer_stylize_report), set by the caller. */
    uint32_t struct_size;
    /** 1 if the run ended, 0 if only `levels` levels are done: then the fields from `used` on are 0. */
    uint32_t finished;
    /** Number of levels done; see luxfer_stylize_get_level. */
    uint32_t levels;
    /** How often the sides of the picture are half those of the target. */
    uint32_t halvings;
    /** Width of patches that was used. */
    uint32_t patch;
    /** Most uses of one exemplar patch. */
    uint32_t most_used;
    /**
     * Mean squared difference of the channels in [0, 1] of matched patches (Eq. 3), last round; the artwork's channels
     * count 1 together, the guides guide_weight.
     */
    double energy;
    /** Share of the exemplar's patches that were used. */
    double used;
    /** Entropy of their usage in bits. */
    double entropy;
    /** Root mean square of LUXFER_STYLIZE_IMAGE_GUIDE_ERROR. */
    double guide_error;
    /** Exemplar pixels left out because they are no numbers. */
    uint64_t broken_source;
    /** Pixels of the target's guides taken as 0 for it. */
    uint64_t broken_target;
} luxfer_stylize_report;

/** One round of matching and painting. Set struct_size before the call. */
typedef struct luxfer_stylize_round {
    /** sizeof(luxfer_stylize_round), set by the caller. */
    uint32_t struct_size;
    /** Passes of matching under the budget; see luxfer_stylize_get_pass. */
    uint32_t passes;
    /** As luxfer_stylize_report.energy, after this round. */
    double energy;
} luxfer_stylize_round;

/** One pass of matching under the budget. Set struct_size before the call. */
typedef struct luxfer_stylize_pass {
    /** sizeof(luxfer_stylize_pass), set by the caller. */
    uint32_t struct_size;
    /** 0. */
    uint32_t reserved;
    /** Share of the exemplar's patches that fitted well enough, in [0, 1]. */
    double knee;
    /** Share of the target with a match after this pass, in [0, 1]. */
    double coverage;
    /** Target patches that were given a match in this pass. */
    uint64_t gained;
} luxfer_stylize_pass;

/**
 * The stylised target, linear, with the artwork's channels. Before the last level, in preview and after a cancel its sides
 * are those of the target halved luxfer_stylize_report.halvings times, rounded down.
 */
#define LUXFER_STYLIZE_IMAGE_PICTURE 0

/**
 * How far the guides at each pixel are from those where its paint was taken, in [0, 1]; 1 channel. High where the exemplar
 * has nothing that fits.
 */
#define LUXFER_STYLIZE_IMAGE_GUIDE_ERROR 1

/**
 * Where in the artwork the paint of each pixel was taken, x and y in pixels, -1 where nothing was painted; 2 channels.
 */
#define LUXFER_STYLIZE_IMAGE_SOURCES 2

/**
 * Gets an image of the result; which is a LUXFER_STYLIZE_IMAGE_ value. After an update (luxfer_stylize_update) picture and
 * sources are its; the rest is that of the last full run. The caller releases *image. Any thread.
 * LUXFER_NOT_READY before the first level of a job is done, and, but for the picture, before the last one is.
 */
luxfer_status luxfer_stylize_get_image(luxfer_stylize *stylize,
                                       luxfer_stylize_image which,
                                       luxfer_image **image);

/**
 * Tells how good the result is so far. Any thread.
 * LUXFER_NOT_READY before the first level of a job is done.
 */
luxfer_status luxfer_stylize_get_report(luxfer_stylize *stylize, luxfer_stylize_report *report);

/**
 * Tells the size of a level, the coarsest being level 0, and the number of its rounds; any of the three may be NULL. Any
 * thread.
 * LUXFER_NOT_READY before the first level of a job is done; LUXFER_NOT_FOUND if there is no such level.
 */
luxfer_status luxfer_stylize_get_level(luxfer_stylize *stylize,
                                       uint32_t level,
                                       uint32_t *width,
                                       uint32_t *height,
                                       uint32_t *rounds);

/**
 * Describes a round of a level. Any thread.
 * LUXFER_NOT_READY before the first level of a job is done; LUXFER_NOT_FOUND if there is no such level or round.
 */
luxfer_status luxfer_stylize_get_round(luxfer_stylize *stylize,
                                       uint32_t level,
                                       uint32_t index,
                                       luxfer_stylize_round *round);

/**
 * Describes a pass of a round. Any thread.
 * LUXFER_NOT_READY before the first level of a job is done; LUXFER_NOT_FOUND if there is no such level, round or pass.
 */
luxfer_status luxfer_stylize_get_pass(luxfer_stylize *stylize,
                                      uint32_t level,
                                      uint32_t round,
                                      uint32_t index,
                                      luxfer_stylize_pass *pass);

/* ====================================================================================================================
 * Planning of stylisations
 *
 * How careful a stylisation can be in a time, or has to be for an error. A plan tries settings from quick to careful on the very
 * input at a part of its resolution, which takes a small part of the time of LUXFER_STYLIZE_FULL, less of larger targets.
 * ==================================================================================================================== */

/**
 * Starts a job that plans a stylisation, of all of the target, with the artwork, guides and masks that stylize has now.
 * settings give all that is kept, the preset's resolution with it: only numbers of rounds and sweeps are chosen; NULL for the
 * defaults. params says what for; the error is the root of luxfer_stylize_report.energy: how far matched patches differ,
 * root mean square, in colours and guides in [0, 1]. A goal out of reach gives the settings nearest to it. The caller
 * releases *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if params is NULL, or has not one of its fields set, or a setting is out of range;
 * LUXFER_INVALID_OPERATION if artwork or guides are missing or a job runs already. The job may end as that of
 * luxfer_stylize_start.
 */
luxfer_status luxfer_plan_start_stylize(luxfer_plan *plan,
                                        luxfer_stylize *stylize,
                                        const luxfer_stylize_params *settings,
                                        const luxfer_plan_params *params,
                                        luxfer_job **job);

/**
 * Gets the settings to stylise with: those given, with what the plan has chosen. Set params->struct_size before. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND in a plan of something else.
 */
luxfer_status luxfer_plan_get_stylize_params(luxfer_plan *plan,
                                             luxfer_stylize_params *params);

/* ====================================================================================================================
 * Print sheets
 *
 * For artists who paint on paper: the exemplar printed pale between alignment marks, and a photo or scan of the painted sheet
 * brought back onto the exemplar by its marks. These calls return when they are done.
 * ==================================================================================================================== */

/** Settings of a print sheet. Fill them with luxfer_sheet_params_init; the same for printing and for aligning. */
typedef struct luxfer_sheet_params {
    /** sizeof(luxfer_sheet_params), set by luxfer_sheet_params_init. */
    uint32_t struct_size;
    /** 1: even out the light of the photo by the white of the marks, so that paper is 1; default 1. */
    uint32_t even_light;
    /** Width of the paper in millimetres, in [60, 2000]; default 297. */
    double paper_width;
    /** Height of the paper in millimetres, in [60, 2000]; default 210. */
    double paper_height;
    /** Dots per inch of the sheet, in [20, 1200]; default 300. */
    double dpi;
    /** Distance of the marks from the edge of the paper in millimetres, in [0, 50]; default 8. */
    double margin;
    /** Contrast of the printed picture, in [0, 1]; default 0.25; 1 prints it as it is. */
    double contrast;
} luxfer_sheet_params;

/** How well a photo was aligned. Set struct_size before the call. */
typedef struct luxfer_sheet_report {
    /** sizeof(luxfer_sheet_report), set by the caller. */
    uint32_t struct_size;
    /** Marks found, of 10; 6 are enough. */
    uint32_t marks;
    /**
     * Root mean square distance between marks and where the map puts them, in pixels of the photo; more than a pixel or two
     * means paper that is not flat, or a lens that bends lines.
     */
    double residual;
    /** Expected alignment error in pixels of the picture. */
    double error;
    /** From pixels of the picture to pixels of the photo, 3 x 3, row by row. */
    double to_photo[9];
} luxfer_sheet_report;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_sheet_params_init(luxfer_sheet_params *params,
                                       size_t size);

/**
 * Draws the sheet to print for a picture (linear, 1 is white; 1, 3 or 4 channels): as large as fits on the paper, pale, with
 * ten marks around it. params may be NULL for the defaults. Save it as PNG and print it at params->dpi without scaling. The
 * caller releases *sheet. Any thread.
 * LUXFER_INVALID_ARGUMENT if a setting is out of range or the paper has no room; LUXFER_OUT_OF_MEMORY beyond the memory
 * budget.
 */
luxfer_status luxfer_sheet_print(luxfer_image *picture,
                                 const luxfer_sheet_params *params,
                                 luxfer_image **sheet);

/**
 * Finds the marks in a photo or scan (linear RGB) of a sheet that was printed with the same params for a picture of
 * width x height pixels, whichever way up and in perspective, and resamples it onto that picture: the artwork, linear
 * RGB. params may be NULL for the defaults, report may be NULL. Takes up to some seconds. The caller releases *artwork. Any
 * thread.
 * LUXFER_DEGENERATE if fewer than six marks are found; LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_sheet_align(luxfer_image *photo,
                                 uint32_t width,
                                 uint32_t height,
                                 const luxfer_sheet_params *params,
                                 luxfer_image **artwork,
                                 luxfer_sheet_report *report);

/* ====================================================================================================================
 * Demonstration
 *
 * Input that the library makes itself, for examples and tests: the same bits every time, nothing loaded from files.
 * ==================================================================================================================== */

/** A generated scene: a LUXFER_DEMO_ value. */
typedef int32_t luxfer_demo;

/** How an artwork is drawn: a LUXFER_ARTWORK_ value. */
typedef int32_t luxfer_artwork;

/** A furnished room without any light; its ceiling is the object "Ceiling". */
#define LUXFER_DEMO_TARGET_ROOM 0

/** An office under a grid of luminaires; camera 0 takes the photo. */
#define LUXFER_DEMO_EXEMPLAR_ROOM 1

/** A glossy red ball on a white table, for artists to paint: the exemplar of a stylisation. */
#define LUXFER_DEMO_SPHERE_ON_TABLE 2

/** A vase, a ring and two balls on the same table under the same lamp: a target for a stylisation. */
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
luxfer_status luxfer_demo_scene(luxfer_context *context, luxfer_demo which, luxfer_scene **scene);

/**
 * Draws an artwork of a scene in place of an artist, aligned with its guides and of their size: made for
 * LUXFER_DEMO_SPHERE_ON_TABLE; style is a LUXFER_ARTWORK_ value. Takes up to some seconds. The caller releases *image. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT for another value; LUXFER_NOT_READY before the guides are rendered.
 */
luxfer_status luxfer_demo_artwork(luxfer_guides *guides,
                                  luxfer_artwork style,
                                  luxfer_image **image);

/* ====================================================================================================================
 * Demonstration photo
 *
 * A photo of the generated office, as a camera would take it, and the strokes a user would paint on it: what a lighting
 * transfer needs, without a file.
 * ==================================================================================================================== */

/** A photo in the making. See luxfer_demo_photo_create. */
typedef struct luxfer_demo_photo luxfer_demo_photo;

/** Settings of the photo. Fill them with luxfer_demo_photo_params_init. */
typedef struct luxfer_demo_photo_params {
    /** sizeof(luxfer_demo_photo_params), set by luxfer_demo_photo_params_init. */
    uint32_t struct_size;
    /** Width in pixels, in [16, 8192]; default 600. */
    uint32_t width;
    /** Height in pixels, in [16, 8192]; default 400. The camera is made for 3:2. */
    uint32_t height;
    /** Paths per pixel, in [2, 1048576]; default 12: few enough to leave some noise. */
    uint32_t samples;
    /** Seed of paths and noise; default 1. */
    uint64_t seed;
} luxfer_demo_photo_params;

/** An image of the demonstration: a LUXFER_DEMO_PHOTO_ value. */
typedef int32_t luxfer_demo_photo_image;

/** The photo: linear RGB, 1 = display white; its lamps are clipped. */
#define LUXFER_DEMO_PHOTO_PICTURE 0

/** The strokes on it, in the colours of luxfer_segment_add_strokes_image. */
#define LUXFER_DEMO_PHOTO_STROKES 1

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_demo_photo_params_init(luxfer_demo_photo_params *params,
                                            size_t size);

/** Creates the stage. The caller releases *demo. Any thread. */
luxfer_status luxfer_demo_photo_create(luxfer_context *context, luxfer_demo_photo **demo);

/**
 * Starts a job that takes the photo. params may be NULL for the defaults. The caller releases *job. Any thread.
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

/** Adds a reference. Any thread. */
luxfer_status luxfer_demo_photo_retain(luxfer_demo_photo *demo);

/** Gives a reference back; a job that runs goes on. Any thread. */
luxfer_status luxfer_demo_photo_release(luxfer_demo_photo *demo);
#ifdef __cplusplus
}
#endif

#endif /* LUXFER_H */
