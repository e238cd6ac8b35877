// The library's furnished demonstration room with lamps on its ceiling: the scene of the cross-checks.
#pragma once

#include "scene_copy.hpp"

// Size of the ceiling's emission texture. The ceiling has 6 x 4 m, so a texel has 12.5 cm; lamps cover whole texels.
constexpr std::uint32_t LAMP_COLUMNS = 48, LAMP_ROWS = 32;

struct Lamp {
    std::uint32_t left, top, right, bottom; // in texels, right and bottom excluded
    Vec emission;                           // cd/m²
};

inline const std::vector<Lamp> &lamps() {
    static const std::vector<Lamp> list = {
        {4, 4, 12, 8, {900, 820, 700}},     {20, 3, 24, 13, {400, 600, 1000}}, {33, 5, 43, 9, {900, 820, 700}},
        {5, 22, 9, 26, {1200, 500, 250}},   {18, 20, 32, 22, {800, 800, 800}}, {38, 19, 42, 29, {500, 900, 450}},
    };
    return list;
}

inline const Lamp *lamp_at(std::uint32_t column, std::uint32_t row) {
    for (const Lamp &lamp : lamps())
        if (column >= lamp.left && column < lamp.right && row >= lamp.top && row < lamp.bottom)
            return &lamp;
    return nullptr;
}

struct LitRoom {
    luxfer::Context context = luxfer::Context::create();
    luxfer::Scene scene = luxfer::Scene::demo(context, LUXFER_DEMO_TARGET_ROOM);
    luxfer_surface ceiling = scene.find_surface("Ceiling");
    std::uint32_t light_mesh = 0;

    LitRoom() {
        constexpr float SCALE = 500.0f; // not 1, so that a missing factor is noticed
        std::vector<float> pixels(std::size_t(LAMP_COLUMNS) * LAMP_ROWS * 3, 0.0f);
        for (std::uint32_t row = 0; row < LAMP_ROWS; ++row)
            for (std::uint32_t column = 0; column < LAMP_COLUMNS; ++column)
                if (const Lamp *lamp = lamp_at(column, row)) {
                    float *pixel = &pixels[3 * (std::size_t(row) * LAMP_COLUMNS + column)];
                    pixel[0] = float(lamp->emission.x / SCALE);
                    pixel[1] = float(lamp->emission.y / SCALE);
                    pixel[2] = float(lamp->emission.z / SCALE);
                }
        const auto texture = luxfer::Image::create(context, {pixels, LAMP_COLUMNS, LAMP_ROWS});
        light_mesh = scene.place_emission("Ceiling", texture, {SCALE, SCALE, SCALE}).mesh;
    }
};
