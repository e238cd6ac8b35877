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
 * no handlers. With equal inputs, parameters and seeds results are equal to the bit, whatever the number of threads.
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
luxfer_status luxfer_context_params_init(struct luxfer_context_params *params,
                                         size_t size);

/**
 * Creates a context and its threads; params may be NULL for the defaults. The caller releases *context. Any thread.
 * LUXFER_INVALID_ARGUMENT if context is NULL, struct_size is wrong or num_threads exceeds 1024; LUXFER_OUT_OF_MEMORY if
 * the threads cannot be started.
 */
luxfer_status luxfer_context_create(const struct luxfer_context_params *params,
                                    struct luxfer_context **context);

/** Adds a reference. Any thread. */
luxfer_status luxfer_context_retain(struct luxfer_context *context);

/**
 * Gives a reference back. The threads end, and are waited for, when the context and everything made in it are released.
 * Any thread.
 */
luxfer_status luxfer_context_release(struct luxfer_context *context);

/**
 * Copies the message of the calling thread's latest failure in this context into buffer, as UTF-8 that ends with a zero,
 * cut if it does not fit into capacity bytes. *needed, unless NULL, becomes the capacity for all of it. Without a failure
 * the message is empty. Messages stay until the thread's next failure; those of the last 256 threads are kept. buffer may
 * be NULL if capacity is 0. A call that fails because its first handle is no handle leaves no message. Any thread.
 */
luxfer_status luxfer_context_last_error(struct luxfer_context *context,
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
luxfer_status luxfer_image_view_init(struct luxfer_image_view *view,
                                     size_t size);

/**
 * Creates an image from a copy of the caller's pixels; integers and sRGB are decoded, NaN and infinities kept. The caller
 * releases *image. Any thread.
 * LUXFER_INVALID_ARGUMENT if the view contradicts itself; LUXFER_OUT_OF_MEMORY beyond the context's memory budget.
 */
luxfer_status luxfer_image_create(luxfer_context *context,
                                  const struct luxfer_image_view *view,
                                  struct luxfer_image **image);

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
                                struct luxfer_image **image);

/** Loads an image from the size bytes of a file held in memory, otherwise as luxfer_image_load. */
luxfer_status luxfer_image_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       luxfer_colour_space colour_space,
                                       struct luxfer_image **image);

/**
 * Saves an image; path is UTF-8 and its extension chooses the format. .png: 1, 3 or 4 channels, multiplied by exposure
 * (> 0, finite; 1 shows the value 1 as white), clamped to [0, 1] and encoded as 8-bit sRGB. .exr: up to 64 channels as
 * they are, in 32-bit floating point; exposure is not used. An existing file is replaced only by a complete one. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT for another extension or number of channels; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_image_save(struct luxfer_image *image,
                                const char *path,
                                float exposure);

/** Tells width and height in pixels and the number of channels; any of the three may be NULL. Any thread. */
luxfer_status luxfer_image_size(struct luxfer_image *image,
                                uint32_t *width,
                                uint32_t *height,
                                uint32_t *channels);

/**
 * Writes an image into the caller's pixels. The view must have the image's size; if the image has more channels than the
 * view, those from first_channel on are written. Integers are clamped to their range and rounded, NaN becomes 0 in them.
 * Any thread.
 * LUXFER_INVALID_ARGUMENT if the view contradicts itself or the image.
 */
luxfer_status luxfer_image_read(struct luxfer_image *image,
                                uint32_t first_channel,
                                const struct luxfer_image_view *view);

/** Adds a reference. Any thread. */
luxfer_status luxfer_image_retain(struct luxfer_image *image);

/** Gives a reference back. Any thread. */
luxfer_status luxfer_image_release(struct luxfer_image *image);

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
 * request that came in time, LUXFER_NOT_READY if it still runs (it goes on running).
 */
luxfer_status luxfer_job_wait(struct luxfer_job *job,
                              int32_t timeout_ms,
                              luxfer_progress_fn progress,
                              void *user);

/**
 * Asks how far a job is, without waiting. *fraction becomes its progress in [0, 1], *finished 1 if it has ended, well or
 * not, else 0; either may be NULL. Any thread.
 */
luxfer_status luxfer_job_poll(struct luxfer_job *job,
                              double *fraction,
                              int32_t *finished);

/** How a job has ended, as luxfer_job_wait returns it; LUXFER_NOT_READY while it runs. Any thread. */
luxfer_status luxfer_job_status(struct luxfer_job *job);

/**
 * Asks a job to end early, and returns at once; the work ends within about 100 ms. A request cannot be taken back; one
 * that comes after the end has no effect. Any thread.
 */
luxfer_status luxfer_job_cancel(struct luxfer_job *job);

/** Adds a reference. Any thread. */
luxfer_status luxfer_job_retain(struct luxfer_job *job);

/** Gives a reference back; the last one cancels a running job and waits for it to end. Any thread. */
luxfer_status luxfer_job_release(struct luxfer_job *job);

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
    uint32_t meshes;
    uint32_t materials;
    uint32_t textures;
    uint32_t lights;
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
    /** 0. */
    uint32_t reserved;
} luxfer_surface;

/** Creates an empty scene. The caller releases *scene. Any thread. */
luxfer_status luxfer_scene_create(luxfer_context *context, struct luxfer_scene **scene);

/**
 * Loads a glTF 2.0 file, .glb or .gltf with the files it names; path is UTF-8. The caller releases *scene. Any thread.
 * LUXFER_IO if a file cannot be read, LUXFER_FORMAT if one is damaged or refers to what is not there, LUXFER_UNSUPPORTED
 * for a required extension this library does not know, LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_load(luxfer_context *context,
                                const char *path,
                                struct luxfer_scene **scene);

/**
 * Loads a scene from the size bytes of a GLB or glTF file held in memory. Other files that it names are looked up in the
 * folder base_path (UTF-8); NULL allows none. Otherwise as luxfer_scene_load.
 */
luxfer_status luxfer_scene_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       const char *base_path,
                                       struct luxfer_scene **scene);

/**
 * Saves a scene as a GLB file with all of its textures inside; path is UTF-8. An existing file is replaced only by a
 * complete one. Any thread.
 * LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_scene_export(struct luxfer_scene *scene,
                                  const char *path);

/**
 * Writes a scene as GLB through the caller's function, which gets user. Any thread.
 * LUXFER_IO if the function gives up.
 */
luxfer_status luxfer_scene_export_memory(struct luxfer_scene *scene, luxfer_write_fn write, void *user);

/** Tells how much there is in a scene. Any thread. */
luxfer_status luxfer_scene_get_counts(struct luxfer_scene *scene, struct luxfer_scene_counts *counts);

/**
 * Surrounds a scene with light of one colour from all directions, red, green and blue in cd/m², each finite and >= 0;
 * replaces any environment it had. Any thread.
 */
luxfer_status luxfer_scene_set_environment(struct luxfer_scene *scene,
                                           float red,
                                           float green,
                                           float blue);

/**
 * Sets the emission of a material, which multiplies its emission texture if it has one: red, green and blue in cd/m², each
 * finite and >= 0. Any thread.
 * LUXFER_NOT_FOUND if there is no such material.
 */
luxfer_status luxfer_scene_set_emission(struct luxfer_scene *scene,
                                        uint32_t material,
                                        float red,
                                        float green,
                                        float blue);

/**
 * Finds the planar surface, of the object or material of that name, that faces the room; name is UTF-8. Any thread.
 * LUXFER_NOT_FOUND if nothing has that name, the message lists names that exist; LUXFER_DEGENERATE if it has no plane.
 */
luxfer_status luxfer_scene_find_surface(struct luxfer_scene *scene,
                                        const char *name,
                                        struct luxfer_surface *found);

/**
 * Lays an emissive texture (linear, 3 channels) over the bounding rectangle of the surface that luxfer_scene_find_surface
 * finds by name. The surface becomes a mesh of its own, *mesh, with a copy of its material, *material, that emits
 * texture * (red, green, blue) in cd/m², each finite and >= 0. mesh and material may be NULL. Any thread.
 * As luxfer_scene_find_surface; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_place_emission(struct luxfer_scene *scene,
                                          const char *name,
                                          luxfer_image *texture,
                                          float red,
                                          float green,
                                          float blue,
                                          uint32_t *mesh,
                                          uint32_t *material);

/** Adds a reference. Any thread. */
luxfer_status luxfer_scene_retain(struct luxfer_scene *scene);

/** Gives a reference back. Any thread. */
luxfer_status luxfer_scene_release(struct luxfer_scene *scene);

/* ====================================================================================================================
 * Scene description
 *
 * Scenes can be described by the host's own arrays: materials first, then the meshes that use them, then cameras. Arrays
 * are copied during the call, from any alignment and with any stride.
 * ==================================================================================================================== */

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
} luxfer_material_params;

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
    /** Three floats for each vertex, in metres, finite; to be set. */
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
    /** Where it stands, in metres; default (0, 0, 0). */
    float position[3];
    /** What it looks at, another point; default (0, 0, -1). */
    float target[3];
    /** Direction that is up in the image, not along the view; default (0, 1, 0). */
    float up[3];
    /** Must be 0. */
    uint32_t reserved;
} luxfer_camera_params;

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_material_params_init(struct luxfer_material_params *params,
                                          size_t size);

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_mesh_params_init(struct luxfer_mesh_params *params,
                                      size_t size);

/**
 * Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
 */
luxfer_status luxfer_camera_params_init(struct luxfer_camera_params *params,
                                        size_t size);

/**
 * Adds a material; *index, unless NULL, becomes its index. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_material(luxfer_scene *scene,
                                        const struct luxfer_material_params *params,
                                        uint32_t *index);

/**
 * Adds a mesh, copying its arrays; *index, unless NULL, becomes its index. Any thread.
 * LUXFER_INVALID_ARGUMENT if an array is missing, a stride too small, a number not finite or an index out of range;
 * LUXFER_NOT_FOUND if the scene has no such material; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_add_mesh(luxfer_scene *scene,
                                    const struct luxfer_mesh_params *params,
                                    uint32_t *index);

/**
 * Adds a camera; *index, unless NULL, becomes its index. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_camera(luxfer_scene *scene,
                                      const struct luxfer_camera_params *params,
                                      uint32_t *index);

/**
 * Replaces a camera. params may be NULL for the defaults. Any thread.
 * LUXFER_NOT_FOUND if there is no such camera; LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_set_camera(luxfer_scene *scene,
                                      uint32_t index,
                                      const struct luxfer_camera_params *params);

/**
 * Reads a camera; set params->struct_size before the call. Any thread.
 * LUXFER_NOT_FOUND if there is no such camera.
 */
luxfer_status luxfer_scene_get_camera(luxfer_scene *scene,
                                      uint32_t index,
                                      struct luxfer_camera_params *params);
#ifdef __cplusplus
}
#endif

#endif /* LUXFER_H */
