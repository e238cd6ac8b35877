// Reads a luxfer scene back into plain arrays, for the reference path tracers.
#pragma once

#include "check.hpp"

#include <luxfer.hpp>

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
    std::vector<float> positions, normals, uvs; // 3, 3 and 2 floats per vertex
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
    luxfer_camera_params camera = luxfer::CameraParams();
};

inline TextureCopy read_texture(const luxfer::Image &image) {
    const luxfer::ImageSize size = image.size();
    return {size.width, size.height, size.channels, image.samples()};
}

inline MeshCopy read_mesh(const luxfer::Scene &scene, std::uint32_t index) {
    const luxfer_mesh_info info = scene.mesh(index);
    MeshCopy mesh;
    mesh.name = scene.mesh_name(index);
    mesh.material = info.material;
    const auto vertices = static_cast<std::size_t>(info.vertex_count);
    mesh.positions.resize(3 * vertices);
    mesh.normals.resize(info.has_normals ? 3 * vertices : 0);
    mesh.indices.resize(3 * static_cast<std::size_t>(info.triangle_count));
    scene.read_vertices(index, LUXFER_VERTEX_POSITION, mesh.positions);
    scene.read_triangles(index, mesh.indices);
    if (info.has_normals)
        scene.read_vertices(index, LUXFER_VERTEX_NORMAL, mesh.normals);
    if (info.uv_sets & 1) {
        mesh.uvs.resize(2 * vertices);
        scene.read_vertices(index, LUXFER_VERTEX_UV_0, mesh.uvs);
    }
    return mesh;
}

inline SceneCopy read_scene(const luxfer::Scene &scene) {
    const luxfer_scene_counts counts = scene.counts();
    SceneCopy copy;
    for (std::uint32_t i = 0; i < counts.meshes; ++i)
        copy.meshes.push_back(read_mesh(scene, i));
    for (std::uint32_t i = 0; i < counts.materials; ++i)
        copy.materials.push_back({scene.material(i), scene.material_texture(i, LUXFER_TEXTURE_BASE_COLOR)});
    for (std::uint32_t i = 0; i < counts.textures; ++i)
        copy.textures.push_back(read_texture(scene.texture(i)));
    if (counts.cameras > 0)
        copy.camera = scene.camera(0);
    return copy;
}
