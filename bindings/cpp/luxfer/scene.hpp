// Scenes: creating, loading, building from arrays, queries, reading back.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "core.hpp"
#include "warning.hpp"

namespace luxfer {

using MaterialParams = Params<luxfer_material_params, LUXFER_STRUCT_MATERIAL_PARAMS>;
using CameraParams = Params<luxfer_camera_params, LUXFER_STRUCT_CAMERA_PARAMS>;
using LightParams = Params<luxfer_light_params, LUXFER_STRUCT_LIGHT_PARAMS>;
using SceneLoadParams = Params<luxfer_scene_load_params, LUXFER_STRUCT_SCENE_LOAD_PARAMS>;

/// A mesh of packed arrays, which must live until the mesh is added. For arrays with strides, set the fields of the C
/// struct.
struct MeshParams : Params<luxfer_mesh_params, LUXFER_STRUCT_MESH_PARAMS> {
    MeshParams() noexcept = default;

    /// Three numbers per vertex, three indices per triangle.
    MeshParams(Span<const float> positions_, Span<const std::uint32_t> indices_, std::uint32_t material_ = 0) noexcept {
        positions = positions_.data();
        vertex_count = positions_.size() / 3;
        indices = indices_.data();
        triangle_count = indices_.size() / 3;
        material = material_;
    }
};

/// The mesh and the material that place_emission has created.
struct PlacedEmission {
    std::uint32_t mesh = 0, material = 0;
};

/// Receives the next bytes of a file; returns false to stop. It may throw: the function that writes the file rethrows
/// the exception.
using Writer = std::function<bool(const void *data, std::size_t size)>;

/// The objects and materials of a scene as candidates for the ceiling. See luxfer_candidates.
class Candidates : public Handle<luxfer_candidates> {
public:
    using Handle::Handle;

    Result<std::uint32_t> count() const { return value<std::uint32_t>(luxfer_candidates_get_count); }

    /// Gets a candidate: name, kind, index, area, height, direction and score. Its strings live as long as the list.
    Result<luxfer_candidate> candidate(std::uint32_t index) const {
        return value<luxfer_candidate>(luxfer_candidates_get, index);
    }
};

/// Meshes, materials, textures, lights and cameras. See luxfer_scene.
class Scene : public Handle<luxfer_scene> {
public:
    using Handle::Handle;

    /// Creates an empty scene.
    static Result<Scene> create(const Context &context) { return make_in<Scene>(context, luxfer_scene_create); }

    /// Loads a .glb file, or a .gltf file with the files it names. The settings are the unit of its lengths, and
    /// whether it may name files outside its folder.
    static Result<Scene> load(const Context &context, Text path, const luxfer_scene_load_params &params = SceneLoadParams()) {
        return make_in<Scene>(context, luxfer_scene_load, path.get(), &params);
    }

    /// Loads a .glb or .gltf file from memory: any container of bytes. Files that it names are read from base_path.
    template <class Bytes>
    static Result<Scene> load_memory(const Context &context, const Bytes &file, Text base_path = nullptr,
                                     const luxfer_scene_load_params &params = SceneLoadParams()) {
        static_assert(sizeof *std::data(file) == 1, "a file consists of bytes");
        const void *data = std::data(file);
        return make_in<Scene>(context, luxfer_scene_load_memory, data, std::size(file), base_path.get(), &params);
    }

    /// The origin of the scene's positions in the coordinates of its file: x, y and z in metres.
    Result<std::array<double, 3>> origin() const {
        std::array<double, 3> at = {};
        const luxfer_status status = luxfer_scene_get_origin(get(), &at[0], &at[1], &at[2]);
        return detail::to_result(context().get(), status, at);
    }

    /// Warnings about the scene's file: an implausible size, and features that are not rendered.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }

    /// Lists objects and materials that may be the ceiling, with area, height and direction; the likeliest first.
    Result<Candidates> candidates() const { return make<Candidates>(luxfer_scene_get_candidates); }

    /// Generates a demonstration scene; `kind` is a LUXFER_DEMO_ value.
    static Result<Scene> demo(const Context &context, luxfer_demo kind) {
        return make_in<Scene>(context, luxfer_demo_create_scene, kind);
    }

    /// Saves a .glb file that contains all textures.
    Result<> save(Text path) const { return call(luxfer_scene_export, path.get()); }

    /// Writes a .glb through a function of the caller.
    Result<> write(const Writer &writer) const {
        Sink sink = {writer, {}};
        const luxfer_status status = luxfer_scene_export_memory(get(), take, &sink);
        sink.caught.rethrow();
        return detail::to_result(context().get(), status);
    }

    // Parts of a scene.

    Result<luxfer_scene_counts> counts() const { return value<luxfer_scene_counts>(luxfer_scene_get_counts); }

    /// Adds a material. Like the following functions, it returns the index of the new object.
    Result<std::uint32_t> add_material(const luxfer_material_params &params = MaterialParams()) const {
        return value<std::uint32_t>(luxfer_scene_add_material, &params);
    }
    Result<std::uint32_t> add_mesh(const luxfer_mesh_params &params) const {
        return value<std::uint32_t>(luxfer_scene_add_mesh, &params);
    }
    Result<std::uint32_t> add_camera(const luxfer_camera_params &params = CameraParams()) const {
        return value<std::uint32_t>(luxfer_scene_add_camera, &params);
    }
    Result<std::uint32_t> add_light(const luxfer_light_params &params = LightParams()) const {
        return value<std::uint32_t>(luxfer_scene_add_light, &params);
    }

    /// Replaces the values of a material; it keeps its textures. To change single values, start from material().
    Result<> set_material(std::uint32_t index, const luxfer_material_params &params) const {
        return call(luxfer_scene_set_material, index, &params);
    }

    /// Adds a copy of an image as texture, for set_material_texture; the wraps are LUXFER_WRAP_ values. Returns its
    /// index.
    Result<std::uint32_t> add_texture(const Image &image, luxfer_wrap wrap_u = LUXFER_WRAP_REPEAT,
                                      luxfer_wrap wrap_v = LUXFER_WRAP_REPEAT) const {
        return value<std::uint32_t>(luxfer_scene_add_texture, image.get(), wrap_u, wrap_v);
    }

    /// Sets the texture of a material for a purpose, a LUXFER_TEXTURE_ value; LUXFER_NONE removes it.
    Result<> set_material_texture(std::uint32_t material, luxfer_texture_role role, std::uint32_t texture,
                                  std::uint32_t uv_set = 0) const {
        return call(luxfer_scene_set_material_texture, material, role, texture, uv_set, nullptr);
    }

    /// Sets a texture with a transform: a matrix of two rows and three columns, applied to (u, v, 1) before the
    /// look-up.
    Result<> set_material_texture(std::uint32_t material, luxfer_texture_role role, std::uint32_t texture,
                                  std::uint32_t uv_set, Numbers<6, float> transform) const {
        return call(luxfer_scene_set_material_texture, material, role, texture, uv_set, transform.data());
    }

    Result<> set_camera(std::uint32_t index, const luxfer_camera_params &params) const {
        return call(luxfer_scene_set_camera, index, &params);
    }

    /// Sets an environment of uniform radiance, in cd/m².
    Result<> set_environment(Rgb light) const {
        return call(luxfer_scene_set_environment, nullptr, light.data());
    }

    /// Sets an environment from an equirectangular image, multiplied by scale.
    Result<> set_environment(const Image &image, Rgb scale) const {
        return call(luxfer_scene_set_environment, image.get(), scale.data());
    }

    // Surfaces.

    /// Finds the planar surface of an object or material that faces the room.
    Result<luxfer_surface> find_surface(Text name) const {
        return value<luxfer_surface>(luxfer_scene_find_surface, name.get());
    }

    /// Maps an emissive texture onto the surface of that name; it then emits `texture * scale`, in cd/m².
    Result<PlacedEmission> place_emission(Text name, const Image &texture, Rgb scale) const {
        PlacedEmission placed;
        const luxfer_status status =
            luxfer_scene_place_emission(get(), name.get(), texture.get(), scale.data(), &placed.mesh, &placed.material);
        return detail::to_result(context().get(), status, placed);
    }

    // Queries.

    /// Finds the nearest hit of each ray; hits has the length of rays.
    Result<> intersect(Span<const luxfer_ray> rays, Span<luxfer_hit> hits) const {
        if (rays.size() != hits.size())
            return detail::fail<void>(Error(LUXFER_INVALID_ARGUMENT, "there must be as many hits as rays"));
        return call(luxfer_scene_intersect, rays.data(), rays.size(), sizeof(luxfer_ray), hits.data(), sizeof(luxfer_hit));
    }

    /// The features that the scene requires of a renderer. Its field bounces is the number of bounces beyond
    /// which at most the share error of all scattered light remains.
    Result<luxfer_requirements> requirements(float error = 0.01f) const {
        return value<luxfer_requirements>(luxfer_scene_get_requirements, error);
    }

    /// Describes the features that the renderer skips, one sentence per line.
    Result<std::string> requirements_text() const { return text(luxfer_scene_get_requirements_text); }

    // Reading back, by index.

    Result<luxfer_camera_params> camera(std::uint32_t index) const {
        return value<luxfer_camera_params>(luxfer_scene_get_camera, index);
    }
    Result<luxfer_mesh_info> mesh(std::uint32_t index) const {
        return value<luxfer_mesh_info>(luxfer_scene_get_mesh, index);
    }
    Result<std::string> mesh_name(std::uint32_t index) const { return text(luxfer_scene_get_mesh_name, index); }

    /// Copies an attribute of the vertices into a packed array: two numbers per vertex for texture coordinates, four
    /// for colours, else three.
    Result<> read_vertices(std::uint32_t index, luxfer_vertex_attribute attribute, Span<float> values) const {
        const bool is_uv = attribute == LUXFER_VERTEX_UV_0 || attribute == LUXFER_VERTEX_UV_1;
        const std::size_t numbers = is_uv ? 2 : attribute == LUXFER_VERTEX_COLOUR ? 4 : 3;
        return call(luxfer_scene_read_vertices, index, attribute, values.data(), values.size() / numbers);
    }

    /// Copies the vertex indices of the triangles, three per triangle.
    Result<> read_triangles(std::uint32_t index, Span<std::uint32_t> indices) const {
        return call(luxfer_scene_read_triangles, index, indices.data(), indices.size() / 3);
    }

    Result<luxfer_material_params> material(std::uint32_t index) const {
        return value<luxfer_material_params>(luxfer_scene_get_material, index);
    }

    /// The texture that a material uses for a purpose, a LUXFER_TEXTURE_ value.
    Result<luxfer_texture_use> material_texture(std::uint32_t material, luxfer_texture_role role) const {
        return value<luxfer_texture_use>(luxfer_scene_get_material_texture, material, role);
    }
    Result<Image> texture(std::uint32_t index) const { return make<Image>(luxfer_scene_get_texture, index); }

private:
    struct Sink {
        const Writer &writer;
        detail::Caught caught;
    };

    static std::int32_t take(void *user, const void *data, std::size_t size) {
        Sink &sink = *static_cast<Sink *>(user);
        return sink.caught.run([&] { return sink.writer(data, size); });
    }
};

} // namespace luxfer
