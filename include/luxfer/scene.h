/* luxfer: scenes: loading, building, reading and queries.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_SCENE_H
#define LUXFER_SCENE_H

#include "core.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Scene
 *
 * A scene holds meshes, materials, textures, lights and cameras. Coordinates are in metres, right-handed, Y up, in
 * world space. Emission is in cd/m²; punctual lights are in candela and lux, as in glTF 2.0. A job works on the scene
 * as it was at the start of the job. Calls that change a scene wait for each other; a call that fails leaves the scene
 * unchanged.
 *
 * Most limits are checked by the calls that set the values, but some depend on several calls. In a valid scene, all
 * light is at most 1e15: each emission times each texel of its emission texture, each texel of the environment, each
 * intensity, and the luminance of the faces of each luminaire. Calls and jobs that trace a scene which is not valid,
 * export it or list its candidates for the ceiling end with LUXFER_INVALID_ARGUMENT; the message names the object.
 * ================================================================================================================== */

/** A scene. See luxfer_scene_load and luxfer_scene_create. */
typedef struct luxfer_scene luxfer_scene;

/**
 * A function of the caller that receives an exported file in parts. The argument data points to the next part, size
 * is the part's length in bytes, and user is the pointer that the caller passed to the export. The export calls the
 * function one or more times, in the order of the bytes, on the calling thread and with no lock held. Return 0 to
 * continue, any other value to stop: the export then returns LUXFER_IO. The function must not throw an exception or
 * leave by longjmp.
 */
typedef int32_t (*luxfer_write_fn)(void *user, const void *data, size_t size);

/** Number of objects of each kind in a scene. */
typedef struct luxfer_scene_counts {
    /** sizeof(luxfer_scene_counts), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * Number of meshes. Their indices are 0 to meshes - 1; the objects that the fields below count are numbered in
     * this way too.
     */
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

/**
 * A planar surface of a scene: triangles in one plane, and their bounding rectangle. Seen from the room, u runs to the
 * right and v runs down, as in an image.
 */
typedef struct luxfer_surface {
    /** sizeof(luxfer_surface), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Reserved; always 0. */
    uint32_t reserved;
    /** Number of triangles in the plane. */
    uint64_t triangles;
    /** Corner of the bounding rectangle where u = v = 0, in metres. */
    float origin[3];
    /** Unit vector of u, along the first side of the rectangle. */
    float u_axis[3];
    /** Unit vector of v, along the second side of the rectangle. */
    float v_axis[3];
    /** Unit normal on the side that will emit; it points into the room. */
    float normal[3];
    /** Lengths of the rectangle's sides along u and v, in metres. */
    float size[2];
    /** Area of the triangles in m². */
    float area;
    /**
     * Area in m² of the other triangles of the object or material whose planes are inclined to this plane by 5 to 75
     * degrees, such as the sides of a vault; they receive no emission.
     */
    float sloped_area;
} luxfer_surface;

/** Creates an empty scene. The caller releases *scene. Any thread. */
luxfer_status luxfer_scene_create(luxfer_context *context, luxfer_scene **scene);

/**
 * Saves a scene as a GLB file that contains all textures, as PNG with 8 bits per channel; path is UTF-8 and ends in
 * .glb. The environment and meshes without triangles are left out. An existing file is replaced only once the new one
 * is complete. Any thread.
 * LUXFER_INVALID_ARGUMENT for another ending, or if the scene is not valid; LUXFER_UNSUPPORTED if a texture transform
 * has shear, or the file would exceed 4 GiB; LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_scene_export(luxfer_scene *scene,
                                  const char *path);

/**
 * Writes the GLB file of luxfer_scene_export without a path: write, a function of the caller, receives the bytes of
 * the file, and the pointer user. Any thread.
 * LUXFER_IO if the function returns anything but 0; LUXFER_INVALID_ARGUMENT and LUXFER_UNSUPPORTED as for
 * luxfer_scene_export.
 */
luxfer_status luxfer_scene_export_memory(luxfer_scene *scene,
                                         luxfer_write_fn write,
                                         void *user);

/** Gets the number of objects of each kind in a scene. size is sizeof *counts. Any thread. */
luxfer_status luxfer_scene_get_counts(luxfer_scene *scene,
                                      luxfer_scene_counts *counts,
                                      size_t size);

/**
 * Sets the environment, which emits light from all directions, and replaces an earlier environment. If image is NULL,
 * the radiance of the environment is rgb in cd/m², each channel in [0, 1e15], from every direction. Otherwise the
 * radiance is an equirectangular image in linear values, multiplied by rgb. An image with 3 or more channels starts
 * with red, green and blue; of an image with 1 or 2 channels, the first channel is taken as grey. A product above 1e15
 * makes the scene not valid. The centre of the image is towards -z, its top towards +y, the centre of its right half
 * towards +x. Light samples of the renderer are drawn in proportion to the brightness of the image. The image is
 * copied. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value of the image is negative or not finite; LUXFER_OUT_OF_MEMORY beyond the memory
 * budget.
 */
luxfer_status luxfer_scene_set_environment(luxfer_scene *scene,
                                           luxfer_image *image,
                                           const float rgb[3]);

/**
 * Finds a planar surface among the triangles of an object or material: of the planes in which these triangles lie, the
 * plane from which most of the room is visible. name is the name of the object or material, in UTF-8. The call looks
 * first for an equal name, then for a name that differs only in upper and lower case, then for a name that contains
 * name in any case, if there is exactly one. Each step looks at the objects first, then at the materials. size is
 * sizeof *found. Any thread.
 * LUXFER_NOT_FOUND if no name fits, or if name is only a part of several names: the message lists names that exist;
 * LUXFER_DEGENERATE if there is no planar surface.
 */
luxfer_status luxfer_scene_find_surface(luxfer_scene *scene,
                                        const char *name,
                                        luxfer_surface *found,
                                        size_t size);

/**
 * Maps an emissive texture (linear, 1 or 3 channels) onto the bounding rectangle of the surface that
 * luxfer_scene_find_surface finds for name. The surface becomes a separate mesh with a copy of its material. On the
 * side towards the room, this copy emits the texture times rgb, in cd/m². The values of the texture are >= 0 and
 * finite, the channels of rgb are in [0, 1e15]; a product above 1e15 makes the scene not valid. *mesh and *material
 * receive the indices of the new mesh and material; each pointer may be NULL. Any thread.
 * Errors: as for luxfer_scene_find_surface; LUXFER_INVALID_ARGUMENT if a value is negative or not finite;
 * LUXFER_OUT_OF_MEMORY if the memory budget would be exceeded.
 */
luxfer_status luxfer_scene_place_emission(luxfer_scene *scene,
                                          const char *name,
                                          luxfer_image *texture,
                                          const float rgb[3],
                                          uint32_t *mesh,
                                          uint32_t *material);

/* ==================================================================================================================
 * Scene files
 *
 * Loads glTF 2.0 files. luxfer_get_warnings and luxfer_scene_get_requirements_text name the features of a file that
 * are not rendered.
 * ================================================================================================================== */

/** From where a luminaire shines: a LUXFER_LUMINAIRE_ value. */
typedef int32_t luxfer_luminaire_shape;

/** Settings for loading a scene file. Fill them with luxfer_scene_load_params_init. */
typedef struct luxfer_scene_load_params {
    /** sizeof(luxfer_scene_load_params), set by luxfer_scene_load_params_init. */
    uint32_t struct_size;
    /**
     * 1: also read files outside the folder of the scene file if the scene file names them by .. or by an absolute
     * path; 0, the default: such a name gives LUXFER_UNSUPPORTED. Set it only for scene files that you trust. Only
     * files are read, never devices or addresses on a network.
     */
    uint32_t allow_external_files;
    /**
     * Length in metres of a unit of the file, in [1e-6, 1e6]; default 1, as glTF defines; 0.001 for a file in
     * millimetres. It scales positions, but not intensities and luminances.
     */
    double unit;
    /**
     * 0, the default: if a scene lies far from the origin of its file, as on a national grid, its positions are made
     * relative to an origin near the scene, which luxfer_scene_get_origin gives. 1: positions stay relative to the
     * origin of the file; in a scene far from that origin, the rounding of coordinates to floats visibly moves
     * vertices.
     */
    uint32_t keep_origin;
    /**
     * From where the luminaires of the file (EXT_lights_ies) shine: a LUXFER_LUMINAIRE_ value; default
     * LUXFER_LUMINAIRE_FACES.
     */
    luxfer_luminaire_shape luminaire_shape;
} luxfer_scene_load_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_scene_load_params_init(luxfer_scene_load_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_SCENE_LOAD_PARAMS, place, size);
}

/**
 * A luminaire shines from the faces of its luminous opening, with the size that its file states: a rectangle, a disc,
 * a box, a cylinder or an ellipsoid. In each direction, all points of the faces have equal luminance: the intensity
 * divided by the projected area of the faces. The light is therefore right at any distance, and renderings show the
 * faces. A luminaire whose file states no size, or a size below 1 mm², shines from a point.
 */
#define LUXFER_LUMINAIRE_FACES 0

/**
 * A luminaire shines from its position as from a point, and is invisible in renderings. The light is right only at
 * distances of at least five times its size.
 */
#define LUXFER_LUMINAIRE_POINT 1

/**
 * Loads a scene from a glTF 2.0 file: .glb, or .gltf with the files that it names. These files must lie in its folder
 * or below, unless allow_external_files is 1. path is UTF-8. params may be NULL for the defaults. The caller releases
 * *scene. Any thread.
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
 * Loads a scene from a GLB or glTF file in memory, which has size bytes and starts at data. If this file names other
 * files, they are read from the folder base_path (UTF-8); if base_path is NULL, the file must not name other files.
 * Settings, ownership, threads and errors are as for luxfer_scene_load.
 */
luxfer_status luxfer_scene_load_memory(luxfer_context *context,
                                       const void *data,
                                       size_t size,
                                       const char *base_path,
                                       const luxfer_scene_load_params *params,
                                       luxfer_scene **scene);

/**
 * Gets the origin of a scene's positions in the coordinates of its file, x, y and z in metres. It is 0 for scenes
 * near the origin, for scenes that were created by luxfer_scene_create, and with keep_origin = 1. The library takes
 * and gives all positions relative to this origin: vertices, cameras, lights, rays and calculation grids. To convert
 * a position in the coordinates of the file, subtract the origin from it in doubles. An exported file has the
 * coordinates of the loaded file. Any thread.
 */
luxfer_status luxfer_scene_get_origin(luxfer_scene *scene,
                                      double *x,
                                      double *y,
                                      double *z);

/* ==================================================================================================================
 * Materials
 *
 * Materials of surfaces, as in glTF 2.0: metallic-roughness with panes, solid glass, alpha cut-outs and emission, and
 * textures that multiply these values. Materials can be read back and replaced; a material keeps its textures when
 * its values change.
 * ================================================================================================================== */

/** How a surface uses its alpha: a LUXFER_ALPHA_ value. */
typedef int32_t luxfer_alpha_mode;

/** A metallic-roughness material, as in glTF 2.0. Fill it with luxfer_material_params_init. */
typedef struct luxfer_material_params {
    /** sizeof(luxfer_material_params), set by luxfer_material_params_init. */
    uint32_t struct_size;
    /**
     * 1, the default: back faces emit as front faces do; 0: only front faces emit. In both cases, back faces reflect
     * and block light as front faces do.
     */
    uint32_t double_sided;
    /** Name in UTF-8, copied; NULL, the default: no name. */
    const char *name;
    /** Linear RGB base colour, each channel in [0, 1]; default 0.8. */
    float base_color[3];
    /** Share of the surface that is metal, in [0, 1]; default 0. */
    float metallic;
    /** Perceptual roughness in [0, 1], as in glTF; default 1. */
    float roughness;
    /** Emission per channel in cd/m², each in [0, 1e15]; default 0. */
    float emission[3];
    /**
     * Share of the light entering the non-metallic part of the surface that passes through, instead of being reflected
     * diffusely, in [0, 1]; default 0. base_color tints this light. If thickness is 0, it passes straight through, as
     * through a thin clear pane, and roughness does not blur it.
     */
    float transmission;
    /** Index of refraction in [1, 4]; default 1.5. With 1, only metal reflects specularly. */
    float ior;
    /** Opacity in [0, 1]; multiplies the alpha of the base colour texture; default 1. */
    float alpha;
    /** Use of alpha: a LUXFER_ALPHA_ value; default LUXFER_ALPHA_OPAQUE. */
    luxfer_alpha_mode alpha_mode;
    /** Threshold of alpha for LUXFER_ALPHA_MASK, >= 0; default 0.5. */
    float alpha_cutoff;
    /** Strength of the normal texture: a factor for the x and y of its normals, finite; default 1. */
    float normal_scale;
    /**
     * If above 0, and transmission too, the meshes of this material are the surfaces of solid bodies, which refract
     * and absorb light: closed meshes whose front sides, from which the triangles wind counter-clockwise, face
     * outwards. base_color tints the light whenever it passes the surface, and roughness blurs it. If 0, the default,
     * the meshes are thin panes. The value itself does not matter: the mesh states how thick the body is. In metres,
     * finite.
     */
    float thickness;
    /**
     * Share of the light that is left after attenuation_distance inside a solid body, each channel in [0, 1];
     * default 1.
     */
    float attenuation_color[3];
    /** Distance in metres, > 0; infinite, the default: the body absorbs nothing. */
    float attenuation_distance;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_material_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_material_params_init(luxfer_material_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_MATERIAL_PARAMS, place, size);
}

/** How a texture continues beyond its edges: a LUXFER_WRAP_ value. */
typedef int32_t luxfer_wrap;

/** Purpose of a texture in a material: a LUXFER_TEXTURE_ value. */
typedef int32_t luxfer_texture_role;

/** The texture that a material uses for one purpose. */
typedef struct luxfer_texture_use {
    /** sizeof(luxfer_texture_use), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * Index of the texture; LUXFER_NONE if the material has no texture for this purpose: the fields below are then 0.
     */
    uint32_t texture;
    /** Set of the mesh's texture coordinates that the material uses for this texture: 0 or 1. */
    uint32_t uv_set;
    /** Continuation of the texture along u: a LUXFER_WRAP_ value. */
    luxfer_wrap wrap_u;
    /** Continuation of the texture along v: a LUXFER_WRAP_ value. */
    luxfer_wrap wrap_v;
    /**
     * Affine map that is applied to the texture coordinates (u, v, 1) before the look-up: two rows of three numbers.
     */
    float transform[6];
} luxfer_texture_use;

/** The alpha is ignored: the surface is opaque. */
#define LUXFER_ALPHA_OPAQUE 0

/** The surface is opaque where its alpha is at least alpha_cutoff, and absent elsewhere. */
#define LUXFER_ALPHA_MASK 1

/** The surface stops a share of the light that is equal to its alpha; the rest of the light passes straight through. */
#define LUXFER_ALPHA_BLEND 2

/** Base colour: the texture multiplies the material's base colour, and its alpha multiplies the material's alpha. */
#define LUXFER_TEXTURE_BASE_COLOR 0

/** Metallic-roughness: the green channel multiplies the roughness, the blue channel multiplies the metallic value. */
#define LUXFER_TEXTURE_METALLIC_ROUGHNESS 1

/**
 * Normals in tangent space, as in glTF 2.0: a channel value c in [0, 1] stands for 2 c - 1, and green points up in the
 * image (OpenGL convention). Load the map as data (LUXFER_COLOUR_LINEAR), not as sRGB.
 */
#define LUXFER_TEXTURE_NORMAL 2

/** Emission: the texture multiplies the emission; it is looked up without interpolation. */
#define LUXFER_TEXTURE_EMISSION 3

/** The texture repeats. */
#define LUXFER_WRAP_REPEAT 0

/** Beyond the edge, the texel at the edge is repeated. */
#define LUXFER_WRAP_CLAMP 1

/** The texture repeats, mirrored every second time. */
#define LUXFER_WRAP_MIRROR 2

/**
 * Adds a material to a scene; *index, unless NULL, receives its index. params may be NULL for the defaults. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_material(luxfer_scene *scene,
                                        const luxfer_material_params *params,
                                        uint32_t *index);

/**
 * Replaces the values of a material by params, or by the defaults if params is NULL. The material keeps its textures,
 * and what params do not state (KHR_materials_specular and _clearcoat), and also its name if params->name is NULL. To
 * change single values, read the material first. Any thread.
 * LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_set_material(luxfer_scene *scene,
                                        uint32_t index,
                                        const luxfer_material_params *params);

/**
 * Reads the values of a material; params->name becomes NULL. size is sizeof *params. Any thread.
 * LUXFER_NOT_FOUND if there is no such material.
 */
luxfer_status luxfer_scene_get_material(luxfer_scene *scene,
                                        uint32_t index,
                                        luxfer_material_params *params,
                                        size_t size);

/**
 * Adds a texture to a scene: an image in linear values with 1, 3 or 4 channels, of which the fourth is alpha. wrap_u
 * and wrap_v are LUXFER_WRAP_ values. The image is copied. *index, unless NULL, receives the texture's index. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT if the image has another number of channels or a value that is not finite;
 * LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_add_texture(luxfer_scene *scene,
                                       luxfer_image *image,
                                       luxfer_wrap wrap_u,
                                       luxfer_wrap wrap_v,
                                       uint32_t *index);

/**
 * Sets the texture that a material uses for a purpose. role is a LUXFER_TEXTURE_ value; texture is the index of a
 * texture, or LUXFER_NONE for no texture. uv_set, 0 or 1, chooses the set of the mesh's texture coordinates.
 * transform, two rows of three finite numbers, is applied to (u, v, 1) before the look-up; NULL is the identity. Any
 * thread.
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

/* ==================================================================================================================
 * Scene description
 *
 * Builds a scene from arrays of the host: add materials first, then the meshes that use them, then cameras. The calls
 * copy the arrays, which may have any alignment and stride.
 * ================================================================================================================== */

/** A triangle mesh in world space. Fill it with luxfer_mesh_params_init. */
typedef struct luxfer_mesh_params {
    /** sizeof(luxfer_mesh_params), set by luxfer_mesh_params_init. */
    uint32_t struct_size;
    /** Index of the mesh's material, as luxfer_scene_add_material returns it; default 0. */
    uint32_t material;
    /** Name in UTF-8, copied; luxfer_scene_find_surface finds surfaces by it. NULL, the default: no name. */
    const char *name;
    /** Number of vertices in [3, 2^32 - 1]; default 0: the caller must set it. */
    size_t vertex_count;
    /** Positions: three floats per vertex, in metres, each in [-1e15, 1e15]; default NULL: the caller must set them. */
    const void *positions;
    /** Bytes from one position to the next; at least 12, or 0, the default: packed. */
    size_t position_stride;
    /** Normals: three floats per vertex, finite; NULL, the default: triangles are shaded flat. */
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
    /** Number of triangles, at least 1; default 0: the caller must set it. */
    size_t triangle_count;
    /**
     * Vertex indices: three uint32_t per triangle, each less than vertex_count, counter-clockwise seen from the
     * front; default NULL: the caller must set them.
     */
    const void *indices;
    /** Bytes from one triangle to the next; at least 12, or 0, the default: packed. */
    size_t index_stride;
    /**
     * Colours of the vertices: red, green, blue and alpha as four floats per vertex, linear, each in [0, 1]. They
     * multiply the material's base colour and alpha. NULL, the default: no colours.
     */
    const void *colours;
    /** Bytes from one colour to the next; at least 16, or 0, the default: packed. */
    size_t colour_stride;
} luxfer_mesh_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_mesh_params_init(luxfer_mesh_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_MESH_PARAMS, place, size);
}

/** A pinhole camera. Fill it with luxfer_camera_params_init. */
typedef struct luxfer_camera_params {
    /** sizeof(luxfer_camera_params), set by luxfer_camera_params_init. */
    uint32_t struct_size;
    /** Full vertical angle of view in radians, in [0.001, 3.1]; default 1. */
    float fov_y;
    /** Position of the eye in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /**
     * Point that the camera looks at, in metres, each coordinate in [-1e15, 1e15], different from position; default
     * (0, 0, -1).
     */
    float target[3];
    /** Up direction of the image, finite and not parallel to the viewing direction; default (0, 1, 0). */
    float up[3];
    /** Must be 0. */
    uint32_t reserved;
} luxfer_camera_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_camera_params_init(luxfer_camera_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_CAMERA_PARAMS, place, size);
}

/**
 * Adds a mesh to a scene and copies its arrays; *index, unless NULL, receives its index. Any thread.
 * LUXFER_INVALID_ARGUMENT if an array is missing, a stride is too small, a number is not finite or an index is out of
 * range; LUXFER_NOT_FOUND if the scene has no such material; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_scene_add_mesh(luxfer_scene *scene,
                                    const luxfer_mesh_params *params,
                                    uint32_t *index);

/**
 * Adds a camera to a scene; *index, unless NULL, receives its index. params may be NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_camera(luxfer_scene *scene,
                                      const luxfer_camera_params *params,
                                      uint32_t *index);

/**
 * Replaces a camera of a scene; the camera keeps its name. params may be NULL for the defaults. Any thread.
 * LUXFER_NOT_FOUND if there is no such camera; LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_set_camera(luxfer_scene *scene,
                                      uint32_t index,
                                      const luxfer_camera_params *params);

/**
 * Reads a camera of a scene; target becomes a point 1 m in front of the camera. size is sizeof *params. Any thread.
 * LUXFER_NOT_FOUND if there is no such camera.
 */
luxfer_status luxfer_scene_get_camera(luxfer_scene *scene,
                                      uint32_t index,
                                      luxfer_camera_params *params,
                                      size_t size);

/* ==================================================================================================================
 * Luminous intensity distributions
 *
 * A distribution gives the luminous intensity of a luminaire in each direction. It is read from IES (LM-63), EULUMDAT,
 * TM-33 or GLDF files, and can be written to all these formats. These calls are synchronous: they do their work before
 * they return.
 * ================================================================================================================== */

/** A luminous intensity distribution. See luxfer_distribution_load. */
typedef struct luxfer_distribution luxfer_distribution;

/** A file format of distributions: a LUXFER_DISTRIBUTION_ value. */
typedef int32_t luxfer_distribution_format;

/** Summary of a luminous intensity distribution. */
typedef struct luxfer_distribution_report {
    /** sizeof(luxfer_distribution_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * Number of C planes, the half-planes through the axis in which the intensities are given. Planes that the file
     * leaves out because of symmetry are included. A single plane holds for all directions around the axis.
     */
    uint32_t planes;
    /** Number of vertical angles gamma in each C plane. */
    uint32_t angles;
    /** Reserved; always 0. */
    uint32_t reserved;
    /** Luminous flux in lumens: the integral of the intensity over all directions. */
    double flux;
    /** Rated flux of the lamps in lumens; 0 if the file does not state it (absolute photometry). */
    double lamp_flux;
    /** Electric power in watts; 0 if unknown. */
    double watts;
    /**
     * Size of the luminous opening in metres: along C = 0°, along C = 90° and along the axis. As in IES files,
     * negative values stand for a round opening: the absolute value is the diameter. IES files name the three values
     * length, width and height; EULUMDAT and TM-33 files name them width, length and height.
     */
    double size[3];
    /** Correlated colour temperature of the lamps in kelvin; 0 if unknown. */
    double temperature;
    /** General colour rendering index Ra of the lamps; 0 if unknown. */
    double rendering;
    /** Number of variants of the product in a GLDF container; 1 for all other formats. */
    uint32_t variants;
    /**
     * Number of emitters whose distributions were added up. For TM-33, it counts the emitters of the file; for GLDF,
     * the emitters of the variant that was read. 1 for IES and EULUMDAT.
     */
    uint32_t emitters;
} luxfer_distribution_report;

/**
 * IES LM-63 (.ies) with photometry of type C. Files with photometry of type B are converted to type C when they are
 * loaded.
 */
#define LUXFER_DISTRIBUTION_IES 0

/** EULUMDAT (.ldt). */
#define LUXFER_DISTRIBUTION_LDT 1

/** ANSI/IES TM-33-18 and TM-33-23 (.xml). The distributions of all emitters are added up. Saved files are TM-33-23. */
#define LUXFER_DISTRIBUTION_TM33 2

/** GLDF container (.gldf): a product with variants, of which one is read. */
#define LUXFER_DISTRIBUTION_GLDF 3

/** Any of these formats; the library recognises the format by the content of the file. */
#define LUXFER_DISTRIBUTION_ANY 4

/**
 * Loads a distribution from an .ies, .ldt, .xml (TM-33) or .gldf file; path is UTF-8. TM-33 and GLDF are recognised by
 * their content, whichever of these extensions the path has. After .gldf, the path may go on with # and the name, the
 * id or the index from 0 of a variant, such as "lamp.gldf#black"; without such an addition, the first variant is read.
 * The caller releases *distribution. Any thread.
 * LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is malformed (the message names the line);
 * LUXFER_UNSUPPORTED for photometry of type A, for photometry of type B in TM-33 files, for a GLDF container that
 * gives only the web address of its photometry, and for files without luminous intensities, for example with radiant
 * intensities only;
 * LUXFER_NOT_FOUND if a container lacks the variant or a file; LUXFER_INVALID_ARGUMENT if the path has another
 * extension.
 */
luxfer_status luxfer_distribution_load(luxfer_context *context,
                                       const char *path,
                                       luxfer_distribution **distribution);

/**
 * Loads a distribution from a file in memory of size bytes at data; format is a LUXFER_DISTRIBUTION_ value. Of a GLDF
 * container, the first variant is read. Ownership, threads and errors are as for luxfer_distribution_load.
 */
luxfer_status luxfer_distribution_load_memory(luxfer_context *context,
                                              const void *data,
                                              size_t size,
                                              luxfer_distribution_format format,
                                              luxfer_distribution **distribution);

/**
 * Saves a distribution to an .ies, .ldt, .xml (TM-33) or .gldf file; path is UTF-8. A GLDF container has one variant,
 * with the photometry as EULUMDAT and the opening as a simple geometry. An existing file is replaced only once the new
 * one is complete. Any thread.
 * LUXFER_INVALID_ARGUMENT if the path has another extension, LUXFER_IO if the file cannot be written.
 */
luxfer_status luxfer_distribution_save(luxfer_distribution *distribution,
                                       const char *path);

/** Gets the summary of a distribution. size is sizeof *report. Any thread. */
luxfer_status luxfer_distribution_get_report(luxfer_distribution *distribution,
                                             luxfer_distribution_report *report,
                                             size_t size);

/**
 * Copies the luminaire's name into buffer as zero-terminated UTF-8, truncated to capacity bytes including the zero.
 * *needed, unless NULL, receives the capacity that the whole name needs. buffer may be NULL if capacity is 0. Any
 * thread.
 */
luxfer_status luxfer_distribution_get_name(luxfer_distribution *distribution,
                                           char *buffer,
                                           size_t capacity,
                                           size_t *needed);

/**
 * Gets the luminous intensity in candela in one direction. Both angles are in degrees and finite: c is the angle of
 * the C plane, which turns around the axis of the luminaire; gamma is the angle from straight down (0) to straight up
 * (180). The intensity is interpolated linearly between the angles of the file, and is 0 if gamma lies outside the
 * angles of the file. Any thread.
 * LUXFER_INVALID_ARGUMENT if an angle is not finite.
 */
luxfer_status luxfer_distribution_get_intensity(luxfer_distribution *distribution,
                                                double c,
                                                double gamma,
                                                double *candela);

/* ==================================================================================================================
 * Lights of a scene
 *
 * Adds punctual lights to a scene: point lights, spot lights, directional lights (light from infinitely far away) and
 * luminaires with a measured intensity distribution. Area lights are surfaces whose material emits.
 * ================================================================================================================== */

/** A kind of punctual light: a LUXFER_LIGHT_ value. */
typedef int32_t luxfer_light_kind;

/** A punctual light. Fill it with luxfer_light_params_init. */
typedef struct luxfer_light_params {
    /** sizeof(luxfer_light_params), set by luxfer_light_params_init. */
    uint32_t struct_size;
    /** Kind of the light: a LUXFER_LIGHT_ value; default LUXFER_LIGHT_POINT. */
    luxfer_light_kind kind;
    /** Position of a point or spot light, in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0). */
    float position[3];
    /** Direction in which a spot or directional light shines; any length but 0; default (0, -1, 0). */
    float direction[3];
    /**
     * Strength of the light per channel, each in [0, 1e15]; default (1, 1, 1). For a point light it is the luminous
     * intensity in cd; for a spot light, the luminous intensity in cd on its axis; for a directional light, the
     * illuminance in lux on a surface that faces the light.
     */
    float intensity[3];
    /**
     * Half angle of the cone in which a spot light has its full intensity, in radians, in [0, outer_angle]; default
     * 0.
     */
    float inner_angle;
    /**
     * Half angle of the whole cone of a spot light, in radians, in (0, pi / 2]; default pi / 4. From inner_angle to
     * outer_angle, the intensity falls smoothly to 0, as in glTF.
     */
    float outer_angle;
    /** Must be 0. */
    uint32_t reserved;
    /**
     * Angle in radians under which the disc of a directional light is seen, in [0, pi / 2]; for the sun it is 0.0093.
     * The disc has uniform luminance; it casts soft shadows, and pictures and mirrors show it. 0, the default:
     * parallel rays.
     */
    float angular_diameter;
} luxfer_light_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_light_params_init(luxfer_light_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_LIGHT_PARAMS, place, size);
}

/** Flux, position, orientation, colour and shape of a luminaire. Fill it with luxfer_luminaire_params_init. */
typedef struct luxfer_luminaire_params {
    /** sizeof(luxfer_luminaire_params), set by luxfer_luminaire_params_init. */
    uint32_t struct_size;
    /** From where the luminaire shines: a LUXFER_LUMINAIRE_ value; default LUXFER_LUMINAIRE_FACES. */
    luxfer_luminaire_shape shape;
    /** Luminous flux in lumens, finite and >= 0; 0, the default: the flux of the distribution. */
    double flux;
    /**
     * Position of the centre of the luminous opening in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0).
     * Flat faces are moved outwards by at least 0.2 mm, so that a ceiling in the same plane does not hide them.
     */
    float position[3];
    /** Direction of the luminaire's axis, in which gamma is 0; any length but 0; default (0, -1, 0): it shines down. */
    float axis[3];
    /**
     * Direction of the half-plane C = 0; it must not be parallel to axis, and only its component perpendicular to
     * axis counts. Default (1, 0, 0). For a luminaire that shines down, C grows anticlockwise as seen from above.
     */
    float c0[3];
    /**
     * Linear RGB colour of the light, each channel in [0, 1e15] and not all 0; only the ratio of the channels counts;
     * default (1, 1, 1).
     */
    float colour[3];
} luxfer_luminaire_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_luminaire_params_init(luxfer_luminaire_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_LUMINAIRE_PARAMS, place, size);
}

/** A point light: equal intensity in every direction. */
#define LUXFER_LIGHT_POINT 0

/** A spot light: it shines into a cone. */
#define LUXFER_LIGHT_SPOT 1

/** A directional light: it shines from infinitely far away, with parallel rays or as a disc. */
#define LUXFER_LIGHT_DIRECTIONAL 2

/**
 * Adds a punctual light to a scene; *index, unless NULL, receives its index among the punctual lights. params may be
 * NULL for the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_light(luxfer_scene *scene,
                                     const luxfer_light_params *params,
                                     uint32_t *index);

/**
 * Adds a luminaire to a scene: a light whose luminous intensity in each direction is given by the argument
 * distribution. *index, unless NULL, receives its index among the punctual lights. The luminaire shines from the faces
 * of its luminous opening. Faces that do not emit are black: they block light and do not reflect it. If the file of
 * the distribution states no size, or if params selects LUXFER_LUMINAIRE_POINT, the luminaire shines from a point
 * instead, and the scene gets the warning LUXFER_WARNING_NOT_IN_PICTURE (luxfer_get_warnings). params may be NULL for
 * the defaults. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_scene_add_luminaire(luxfer_scene *scene,
                                         luxfer_distribution *distribution,
                                         const luxfer_luminaire_params *params,
                                         uint32_t *index);

/* ==================================================================================================================
 * Scene queries
 *
 * Traces rays through a scene and finds their nearest hits, with the same code as the renderer. These calls are
 * synchronous: they do their work before they return.
 * ================================================================================================================== */

/** No index: stands for no mesh, no triangle, no texture or no material. */
#define LUXFER_NONE 4294967295

/** A ray. Callers pass arrays of this struct, so its size and fields never change in later versions. */
typedef struct luxfer_ray {
    /** Start of the ray, in metres. */
    float origin[3];
    /** Direction of the ray; any length but 0. Its length is the unit of distances along the ray. */
    float direction[3];
    /**
     * Maximum distance of a hit, in units of the length of direction; may be infinite. Only hits at distances in (0,
     * t_max) count.
     */
    float t_max;
} luxfer_ray;

/**
 * The nearest hit of a ray. Callers pass arrays of this struct, so its size and fields never change in later versions.
 */
typedef struct luxfer_hit {
    /** Distance of the hit in units of the length of the ray's direction; infinite for a miss. */
    float t;
    /** Index of the mesh; LUXFER_NONE for a miss. */
    uint32_t mesh;
    /** Index of the triangle in its mesh; LUXFER_NONE for a miss. */
    uint32_t triangle;
    /** Barycentric coordinate of the hit for the triangle's second corner; 0 for a miss. */
    float u;
    /** Barycentric coordinate of the hit for the triangle's third corner; 0 for a miss. */
    float v;
} luxfer_hit;

/**
 * Finds the nearest hits of count rays; the array hits receives count elements. ray_stride and hit_stride are the
 * distances between elements in bytes; 0: sizeof(luxfer_ray), sizeof(luxfer_hit). Rays and hits may be fields of one
 * struct. All surfaces count as opaque and two-sided. Of hits at equal distance, the hit with the lower index of mesh,
 * then of triangle, is returned. Rays whose origin or direction is not finite, or whose direction is 0, hit nothing.
 * The first call after a scene is loaded or changed prepares the scene for tracing, which takes longer. Any thread.
 * LUXFER_INVALID_ARGUMENT if a stride is too small or the scene is not valid: the message names the part that is not
 * valid.
 */
luxfer_status luxfer_scene_intersect(luxfer_scene *scene,
                                     const luxfer_ray *rays,
                                     size_t count,
                                     size_t ray_stride,
                                     luxfer_hit *hits,
                                     size_t hit_stride);

/* ==================================================================================================================
 * Scene requirements
 *
 * The renderer analyses a scene before the first ray: which kinds of scattering and which lights can occur, and how
 * much light can remain after a bounce. It skips the code for everything that cannot occur, which does not change any
 * image. You need not call these functions: they only report what the renderer does by itself.
 * ================================================================================================================== */

/** At least one surface scatters diffusely. */
#define LUXFER_SCATTERING_DIFFUSE 1

/** At least one surface has a rough specular reflection. */
#define LUXFER_SCATTERING_GLOSSY 2

/** At least one surface is a mirror. */
#define LUXFER_SCATTERING_MIRROR 4

/** At least one surface is a clear pane of glass. */
#define LUXFER_SCATTERING_GLASS 8

/** At least one surface is partly transparent because of its alpha. */
#define LUXFER_SCATTERING_ALPHA 16

/** At least one body is solid glass, which refracts. */
#define LUXFER_SCATTERING_REFRACTION 32

/** At least one surface has a clear coat (KHR_materials_clearcoat). */
#define LUXFER_SCATTERING_CLEAR_COAT 64

/** At least one surface emits; the luminous openings of luminaires count. */
#define LUXFER_LIGHTS_SURFACE 1

/** At least one emitting surface has an emission texture. */
#define LUXFER_LIGHTS_TEXTURE 2

/** At least one point light, or luminaire that shines from a point, has an intensity above 0. */
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
     * Number n of bounces that matter: the smallest positive integer with a^n <= error. Here a is the largest channel
     * of the field albedo, and error is the argument of luxfer_scene_get_requirements. With error = 0.01, for example,
     * light with more than n bounces is at most 1 % of all scattered light. 0 if there is no such n. For information
     * only: no rendering ends paths at this number.
     */
    uint32_t bounces;
    /** Index of the material with the largest albedo; LUXFER_NONE if there are no surfaces. */
    uint32_t brightest_material;
    /**
     * Upper bound of the albedo of all surfaces, per channel, in [0, 1]. The albedo is the share of the received light
     * that a surface reflects or transmits.
     */
    float albedo[3];
    /** Number of triangles with zero area, which are skipped. */
    uint32_t flat_triangles;
} luxfer_requirements;

/**
 * Gets the features that a scene requires of the renderer. error, in [0, 1), is the share of the scattered light that
 * the count of bounces (luxfer_requirements.bounces) may neglect. The first call after a change of the scene prepares
 * the scene for tracing. size is sizeof *requirements. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid or error is out of range.
 */
luxfer_status luxfer_scene_get_requirements(luxfer_scene *scene,
                                            float error,
                                            luxfer_requirements *requirements,
                                            size_t size);

/**
 * Describes in words what the renderer skips in a scene. It also names each extension and feature of the scene's file
 * that is not rendered, with the objects that have it. The text has one sentence per line and is zero-terminated
 * UTF-8, truncated to capacity bytes including the zero. *needed, unless NULL, receives the capacity that the whole
 * text needs. buffer may be NULL if capacity is 0. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid.
 */
luxfer_status luxfer_scene_get_requirements_text(luxfer_scene *scene,
                                                 char *buffer,
                                                 size_t capacity,
                                                 size_t *needed);

/* ==================================================================================================================
 * Scene read-back
 *
 * Reads the meshes of a scene back. With luxfer_scene_get_counts and the functions that read materials, textures and
 * cameras, a host can copy these parts of a scene. Lights and the environment cannot be read back.
 * ================================================================================================================== */

/** Sizes and attributes of a mesh. */
typedef struct luxfer_mesh_info {
    /** sizeof(luxfer_mesh_info), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Index of the mesh's material. */
    uint32_t material;
    /** Number of vertices. */
    uint64_t vertex_count;
    /** Number of triangles. */
    uint64_t triangle_count;
    /** 1 if each vertex has a normal, 0 if triangles are shaded flat. */
    uint32_t has_normals;
    /** Bit 0 is set if the mesh has the first set of texture coordinates, bit 1 if it has the second set. */
    uint32_t uv_sets;
    /** 1 if each vertex has a colour, else 0. */
    uint32_t has_colours;
    /** Reserved; always 0. */
    uint32_t reserved;
} luxfer_mesh_info;

/** An attribute of the vertices of a mesh: a LUXFER_VERTEX_ value. */
typedef int32_t luxfer_vertex_attribute;

/** Positions in metres, three floats per vertex. */
#define LUXFER_VERTEX_POSITION 0

/** Normals, three floats per vertex. */
#define LUXFER_VERTEX_NORMAL 1

/** The first set of texture coordinates, two floats per vertex; (0, 0) is the top-left corner of a texture. */
#define LUXFER_VERTEX_UV_0 2

/** The second set of texture coordinates, two floats per vertex. */
#define LUXFER_VERTEX_UV_1 3

/** Colours: linear red, green, blue and alpha, four floats per vertex. */
#define LUXFER_VERTEX_COLOUR 4

/**
 * Gets the sizes and attributes of a mesh. size is sizeof *info. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh.
 */
luxfer_status luxfer_scene_get_mesh(luxfer_scene *scene,
                                    uint32_t index,
                                    luxfer_mesh_info *info,
                                    size_t size);

/**
 * Copies the name of a mesh into buffer as zero-terminated UTF-8, truncated to capacity bytes including the zero.
 * *needed, unless NULL, receives the capacity that the whole name needs. buffer may be NULL if capacity is 0. Any
 * thread.
 * LUXFER_NOT_FOUND if there is no such mesh.
 */
luxfer_status luxfer_scene_get_mesh_name(luxfer_scene *scene,
                                         uint32_t index,
                                         char *buffer,
                                         size_t capacity,
                                         size_t *needed);

/**
 * Copies an attribute of a mesh's vertices into the array values, a packed array of the caller with room for capacity
 * vertices. attribute is a LUXFER_VERTEX_ value. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh or it lacks the attribute; LUXFER_INVALID_ARGUMENT if the attribute is
 * unknown, the capacity is too small, or values is NULL though the mesh has vertices.
 */
luxfer_status luxfer_scene_read_vertices(luxfer_scene *scene,
                                         uint32_t index,
                                         luxfer_vertex_attribute attribute,
                                         float *values,
                                         size_t capacity);

/**
 * Copies the triangles of a mesh into the array indices, a packed array of the caller with room for capacity
 * triangles: three vertex indices per triangle. Any thread.
 * LUXFER_NOT_FOUND if there is no such mesh; LUXFER_INVALID_ARGUMENT if the capacity is too small, or indices is
 * NULL though the mesh has triangles.
 */
luxfer_status luxfer_scene_read_triangles(luxfer_scene *scene,
                                          uint32_t index,
                                          uint32_t *indices,
                                          size_t capacity);

/* ==================================================================================================================
 * Candidates for the ceiling
 *
 * Lists the objects and the materials of a scene with their area, height and direction, sorted so that the likeliest
 * ceiling comes first. A host can show this list to let the user choose the surface that will carry the lights. Pass
 * the name of the chosen candidate to luxfer_scene_find_surface or luxfer_transfer_set_scene. A list is a copy: later
 * changes of the scene do not change it.
 * ================================================================================================================== */

/** A list of candidates for the ceiling. See luxfer_scene_get_candidates. */
typedef struct luxfer_candidates luxfer_candidates;

/** Whether a candidate is an object or a material: a LUXFER_CANDIDATE_ value. */
typedef int32_t luxfer_candidate_kind;

/** A candidate for the ceiling: an object or a material of a scene. */
typedef struct luxfer_candidate {
    /** sizeof(luxfer_candidate), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Whether the candidate is an object or a material: a LUXFER_CANDIDATE_ value. */
    luxfer_candidate_kind kind;
    /** Index of the object's first mesh in the scene, or index of the material. */
    uint32_t index;
    /** Area of all triangles in m². */
    float area;
    /**
     * Area in m² of the level triangles. A triangle is level if it faces up or down and is inclined by at most 15
     * degrees to the horizontal.
     */
    float level_area;
    /**
     * Mean height (y coordinate) in metres, weighted by area, of the level triangles, or of all triangles if no
     * triangle is level.
     */
    float height;
    /** Height (y coordinate) of the lowest point, in metres. */
    float low;
    /** Height (y coordinate) of the highest point, in metres. */
    float high;
    /**
     * Mean normal of the front sides of all triangles, weighted by area: a unit vector, or 0 if the normals cancel,
     * as for a closed box.
     */
    float normal[3];
    /**
     * Resemblance to a ceiling: s = (level_area / area) * min(1, level_area / F) * h², in [0, 1]. F is the floor area
     * of the scene's bounding box in m², and h = (height - lowest y of the scene) / (height of the scene). A name with
     * a word for a ceiling, such as "ceiling" or "Decke", raises the score to (1 + s) / 2, unless level_area is 0.
     */
    float score;
    /** Number of triangles whose area is not 0. */
    uint64_t triangles;
    /** Name of the object or material, in zero-terminated UTF-8. The string lives as long as the luxfer_candidates. */
    const char *name;
    /**
     * The reason for the score: an English sentence that states area, level_area and height, and in percent the
     * factors min(1, level_area / F) and h of the formula of the score; or that no triangle is level. It is
     * zero-terminated UTF-8. The string lives as long as the luxfer_candidates.
     */
    const char *reason;
} luxfer_candidate;

/** An object: all meshes with one name. */
#define LUXFER_CANDIDATE_OBJECT 0

/** A material: all triangles that use it. */
#define LUXFER_CANDIDATE_MATERIAL 1

/**
 * Creates a list of the candidates for the ceiling: all objects of a scene and all materials that its triangles use,
 * the likeliest ceiling first. The time of the call is proportional to the number of triangles. The caller releases
 * *candidates. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid.
 */
luxfer_status luxfer_scene_get_candidates(luxfer_scene *scene,
                                          luxfer_candidates **candidates);

/** Gets the number of candidates in a list. Any thread. */
luxfer_status luxfer_candidates_get_count(luxfer_candidates *candidates, uint32_t *count);

/**
 * Gets one candidate of a list; index starts at 0. size is sizeof *candidate. Any thread.
 * LUXFER_NOT_FOUND if index is beyond the end of the list.
 */
luxfer_status luxfer_candidates_get(luxfer_candidates *candidates,
                                    uint32_t index,
                                    luxfer_candidate *candidate,
                                    size_t size);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_SCENE_H */
