// A scene with every kind of material and every kind of light, described by arrays.
//
// Panels of 1 x 1 m lie in rows above a matt floor; panels that transmit light hang 40 cm above it. The camera looks
// down on the panels. The lights are a lamp (an area light), a point light, a spot light, a distant light, and an
// environment image of a sky.
#pragma once

#include "scene_copy.hpp"

constexpr int PANEL_COLUMNS = 4;

struct Panel {
    const char *name;
    double metallic, roughness, transmission, ior, alpha;
    luxfer_alpha_mode alpha_mode;
    Vec colour;
    bool textured, bumpy, layered, hangs;
};

// Roughnesses are multiples of 1/31, because the library's table of the reflecting layer's albedo has its entries
// there: no interpolation error disturbs the comparison.
inline const std::vector<Panel> &panels() {
    static const std::vector<Panel> list = {
        {"coated", 0, 10 / 31.0, 0, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.6, 0.3, 0.1}, false, false, false, false},
        {"rough coat", 0, 1, 0, 2.0, 1, LUXFER_ALPHA_OPAQUE, {0.3, 0.5, 0.7}, false, false, false, false},
        {"smooth coat", 0, 0, 0, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.2, 0.6, 0.3}, false, false, false, false},
        {"metal", 1, 10 / 31.0, 0, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.9, 0.7, 0.4}, false, false, false, false},
        {"half metal", 0.5, 16 / 31.0, 0, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.7, 0.7, 0.8}, false, false, false, false},
        {"mirror", 1, 0, 0, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.9, 0.9, 0.8}, false, false, false, false},
        {"bumpy", 0, 16 / 31.0, 0, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.5, 0.5, 0.5}, true, true, false, false},
        {"layered", 1, 1, 0, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.8, 0.5, 0.4}, false, false, true, false},
        {"clear glass", 0, 0, 0.9, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.9, 0.6, 0.5}, false, false, false, true},
        {"milky glass", 0, 10 / 31.0, 0.5, 1.5, 1, LUXFER_ALPHA_OPAQUE, {0.5, 0.7, 0.9}, false, false, false, true},
        {"cut out", 0, 1, 0, 1.0, 0.9, LUXFER_ALPHA_MASK, {0.8, 0.8, 0.8}, true, false, false, true},
        {"veil", 0, 16 / 31.0, 0, 1.5, 0.4, LUXFER_ALPHA_BLEND, {0.8, 0.4, 0.4}, false, false, false, true},
    };
    return list;
}

constexpr float CUTOFF = 0.5f;
constexpr float NORMAL_SCALE = 0.7f;
constexpr std::uint32_t SKY_WIDTH = 16, SKY_HEIGHT = 8, PATTERN = 4;
constexpr float SKY_STRENGTH = 2.0f;

struct Gallery {
    luxfer::Context context = luxfer::Context::create();
    luxfer::Scene scene = luxfer::Scene::create(context);
    // The images and lights again as plain numbers, for a tracer that does not use the library.
    TextureCopy colours, normals, layers, sky;
    luxfer::LightParams point, spot, distant;
    Vec lamp_corner = {-1.0, 3.5, -0.5}, lamp_u = {1.5, 0, 0}, lamp_v = {0, 0, 1}, lamp_emission = {30, 25, 20};

    Gallery() {
        // Patterns: some alphas of the colours are below the cutoff; normals are tilted by up to about 20 degrees.
        colours = make(PATTERN, PATTERN, 4, [](std::uint32_t x, std::uint32_t y, int c) {
            return c == 3 ? ((x + y) % 3 == 0 ? 0.1f : 1.0f) : 0.4f + 0.15f * float((x * 3 + y * 5 + c) % 4);
        });
        normals = make(PATTERN, PATTERN, 4, [](std::uint32_t x, std::uint32_t y, int c) {
            return c == 0 ? 0.35f + 0.1f * float(x) : c == 1 ? 0.6f - 0.08f * float(y) : 1.0f;
        });
        // Green is roughness, blue metalness. The roughness is constant, so that no value lies between two entries of
        // the albedo table.
        layers = make(PATTERN, PATTERN, 4, [](std::uint32_t x, std::uint32_t y, int c) {
            return c == 1 ? float(16 / 31.0) : c == 2 ? float((x + y) % 2) : 1.0f;
        });
        sky = make(SKY_WIDTH, SKY_HEIGHT, 3, [](std::uint32_t x, std::uint32_t y, int c) {
            return y < SKY_HEIGHT / 2 ? 0.5f + 0.1f * float(c) + 0.2f * float(x % 5) : 0.1f;
        });
        scene.set_environment(upload(sky), {SKY_STRENGTH, SKY_STRENGTH, SKY_STRENGTH});
        const std::uint32_t pattern = add(colours), bumps = add(normals), mixture = add(layers);

        luxfer::MaterialParams matt;
        matt.ior = 1;
        matt.base_color[0] = matt.base_color[1] = matt.base_color[2] = 0.5f;
        const std::uint32_t floor = scene.add_material(matt);
        matt.base_color[0] = matt.base_color[1] = matt.base_color[2] = 0;
        matt.double_sided = 0;
        store(lamp_emission, matt.emission);
        const std::uint32_t black = scene.add_material(matt);
        quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, floor);
        quad(lamp_corner, lamp_u, lamp_v, black);
        for (std::size_t i = 0; i < panels().size(); ++i) {
            const Panel &panel = panels()[i];
            luxfer::MaterialParams params;
            params.metallic = float(panel.metallic);
            params.roughness = float(panel.roughness);
            params.transmission = float(panel.transmission);
            params.ior = float(panel.ior);
            params.alpha = float(panel.alpha);
            params.alpha_mode = panel.alpha_mode;
            params.alpha_cutoff = CUTOFF;
            params.normal_scale = NORMAL_SCALE;
            store(panel.colour, params.base_color);
            const std::uint32_t material = scene.add_material(params);
            const auto use = [&](bool wanted, luxfer_texture_role role, std::uint32_t texture) {
                if (wanted)
                    scene.set_material_texture(material, role, texture);
            };
            use(panel.textured, LUXFER_TEXTURE_BASE_COLOR, pattern);
            use(panel.bumpy, LUXFER_TEXTURE_NORMAL, bumps);
            use(panel.layered, LUXFER_TEXTURE_METALLIC_ROUGHNESS, mixture);
            const double column = double(i % PANEL_COLUMNS), row = double(i / PANEL_COLUMNS);
            quad({1.2 * column - 2.3, panel.hangs ? 0.4 : 0.01, 1.2 * row - 1.7}, {0, 0, 1}, {1, 0, 0}, material);
        }
        light(point, LUXFER_LIGHT_POINT, {2.5, 2, 0.5}, {}, {12, 10, 8});
        light(spot, LUXFER_LIGHT_SPOT, {-2.5, 2.5, 1}, {2, -2.5, -0.6}, {30, 30, 40});
        light(distant, LUXFER_LIGHT_DIRECTIONAL, {}, {0.3, -1, -0.4}, {3, 3, 2});
        luxfer::CameraParams camera;
        store({0.1, 4.4, 3.6}, camera.position);
        store({0, 0, 0}, camera.target);
        camera.fov_y = 0.65f;
        scene.add_camera(camera);
    }

private:
    static void store(Vec v, float *to) {
        to[0] = float(v.x);
        to[1] = float(v.y);
        to[2] = float(v.z);
    }

    template <class F> static TextureCopy make(std::uint32_t width, std::uint32_t height, std::uint32_t channels, F value) {
        TextureCopy copy;
        copy.width = width;
        copy.height = height;
        copy.channels = channels;
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                for (std::uint32_t c = 0; c < channels; ++c)
                    copy.pixels.push_back(value(x, y, int(c)));
        return copy;
    }

    luxfer::Image upload(const TextureCopy &copy) const {
        return luxfer::Image::create(context, {copy.pixels, copy.width, copy.height, copy.channels});
    }

    std::uint32_t add(const TextureCopy &copy) const { return scene.add_texture(upload(copy)); }

    void quad(Vec corner, Vec u, Vec v, std::uint32_t material) const {
        float positions[12];
        const Vec corners[4] = {corner, corner + u, corner + u + v, corner + v};
        for (int i = 0; i < 4; ++i)
            store(corners[i], positions + 3 * i);
        const float uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
        const std::uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
        luxfer::MeshParams mesh(positions, indices, material);
        mesh.uvs = uvs;
        scene.add_mesh(mesh);
    }

    void light(luxfer::LightParams &params, luxfer_light_kind kind, Vec position, Vec direction, Vec intensity) const {
        params.kind = kind;
        store(position, params.position);
        if (length(direction) > 0)
            store(direction, params.direction);
        store(intensity, params.intensity);
        params.inner_angle = 0.2f;
        params.outer_angle = 0.5f;
        scene.add_light(params);
    }
};
