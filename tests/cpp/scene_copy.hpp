// A luxfer scene read back through the C functions into plain arrays, for the harnesses that trace it themselves.
#pragma once

#include "check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

struct Vec {
    double x = 0, y = 0, z = 0;
};
inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(Vec a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec operator*(Vec a, Vec b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec a) { return std::sqrt(dot(a, a)); }
inline Vec normalised(Vec a) { return a * (1 / length(a)); }
inline double largest(Vec a) { return std::max(a.x, std::max(a.y, a.z)); }
inline Vec vec(const float *p) { return {p[0], p[1], p[2]}; }

struct MeshCopy {
    std::string name;
    std::uint32_t material = 0;
    std::vector<float> positions, normals, uvs; // 3, 3 and 2 for each vertex
    std::vector<std::uint32_t> indices;

    std::size_t triangles() const { return indices.size() / 3; }
    const std::uint32_t *corners(std::size_t triangle) const { return &indices[3 * triangle]; }
    Vec corner(std::size_t triangle, int i) const { return vec(&positions[3 * std::size_t(corners(triangle)[i])]); }
};

struct TextureCopy {
    std::uint32_t width = 0, height = 0, channels = 0;
    std::vector<float> pixels;
};

struct MaterialCopy {
    luxfer_material_params params;
    luxfer_texture_use base_color;
};

struct SceneCopy {
    std::vector<MeshCopy> meshes;
    std::vector<MaterialCopy> materials;
    std::vector<TextureCopy> textures;
    luxfer_camera_params camera;
};

inline TextureCopy read_image(luxfer_image *image) {
    TextureCopy copy;
    CHECK_OK(luxfer_image_size(image, &copy.width, &copy.height, &copy.channels));
    copy.pixels.resize(std::size_t(copy.width) * copy.height * copy.channels);
    luxfer_image_view view;
    CHECK_OK(luxfer_image_view_init(&view, sizeof view));
    view.channels = copy.channels;
    view.width = copy.width;
    view.height = copy.height;
    view.byte_size = copy.pixels.size() * sizeof(float);
    view.data = copy.pixels.data();
    CHECK_OK(luxfer_image_read(image, 0, &view));
    return copy;
}

inline MeshCopy read_mesh(luxfer_scene *scene, std::uint32_t index) {
    luxfer_mesh_info info = {};
    info.struct_size = sizeof info;
    CHECK_OK(luxfer_scene_get_mesh(scene, index, &info));
    MeshCopy mesh;
    mesh.material = info.material;
    std::size_t needed = 0;
    CHECK_OK(luxfer_scene_get_mesh_name(scene, index, nullptr, 0, &needed));
    mesh.name.resize(needed);
    CHECK_OK(luxfer_scene_get_mesh_name(scene, index, &mesh.name[0], needed, nullptr));
    mesh.name.resize(needed - 1);
    mesh.positions.resize(3 * info.vertex_count);
    mesh.normals.resize(info.has_normals ? 3 * info.vertex_count : 0);
    mesh.indices.resize(3 * info.triangle_count);
    CHECK_OK(luxfer_scene_read_mesh(scene, index, info.vertex_count, mesh.positions.data(),
                                    info.has_normals ? mesh.normals.data() : nullptr, info.triangle_count,
                                    mesh.indices.data()));
    if (info.uv_sets & 1) {
        mesh.uvs.resize(2 * info.vertex_count);
        CHECK_OK(luxfer_scene_read_mesh_uvs(scene, index, 0, info.vertex_count, mesh.uvs.data()));
    }
    return mesh;
}

inline SceneCopy read_scene(luxfer_scene *scene) {
    luxfer_scene_counts counts = {};
    counts.struct_size = sizeof counts;
    CHECK_OK(luxfer_scene_get_counts(scene, &counts));
    SceneCopy copy;
    for (std::uint32_t i = 0; i < counts.meshes; ++i)
        copy.meshes.push_back(read_mesh(scene, i));
    for (std::uint32_t i = 0; i < counts.materials; ++i) {
        MaterialCopy material = {};
        material.params.struct_size = sizeof material.params;
        CHECK_OK(luxfer_scene_get_material(scene, i, &material.params));
        material.base_color.struct_size = sizeof material.base_color;
        CHECK_OK(luxfer_scene_get_material_texture(scene, i, LUXFER_TEXTURE_BASE_COLOR, &material.base_color));
        copy.materials.push_back(material);
    }
    for (std::uint32_t i = 0; i < counts.textures; ++i) {
        luxfer_image *image = nullptr;
        CHECK_OK(luxfer_scene_get_texture(scene, i, &image));
        copy.textures.push_back(read_image(image));
        CHECK_OK(luxfer_image_release(image));
    }
    copy.camera = {};
    copy.camera.struct_size = sizeof copy.camera;
    if (counts.cameras > 0)
        CHECK_OK(luxfer_scene_get_camera(scene, 0, &copy.camera));
    return copy;
}
