// Lights a room as in a photo: written by luxfer studio. It is C++17. Where luxfer is installed:
//
//     c++ -std=c++17 -ffp-contract=off FILE.cpp $(pkg-config --cflags --libs luxfer) -o program
//     ./program [PHOTO ROOM]
//
// It writes lit.glb, luminaires.csv, render.exr and render.png into the current folder.

#include <luxfer.hpp>

// [start pixels]
#include <algorithm>
// [end pixels]
#include <array>
// [start pixels]
#include <cmath>
// [end pixels]
#include <cstdio>
// [start mix]
#include <fstream>
#include <iomanip>
#include <optional>
#include <set>
// [end mix]
#include <string>
#include <vector>

namespace {

// [data]

luxfer::Strokes strokes_on(const luxfer::Image &photo) {
    const auto size = photo.size();
    auto set = luxfer::Strokes::create(photo.context(), size.width, size.height);
    for (const Stroke &stroke : strokes)
        set.add(stroke.phase, stroke.points, stroke.radius, stroke.is_positive);
    return set;
}

// [start regions]
/// A picture of numbers.
struct Labels {
    int width, height;
    std::vector<int> at;
};

/// Writes `label` on the region of pixels that are true in `is_lit`, joined by their sides, around `start`.
void fill(const std::vector<bool> &is_lit, Labels &labels, int start, int label) {
    std::vector<int> waiting = {start};
    labels.at[std::size_t(start)] = label;
    while (!waiting.empty()) {
        const int at = waiting.back(), x = at % labels.width;
        waiting.pop_back();
        const int beside[] = {x > 0 ? at - 1 : -1, x < labels.width - 1 ? at + 1 : -1, at - labels.width,
                              at + labels.width};
        for (const int next : beside) {
            if (next < 0 || next >= labels.width * labels.height)
                continue;
            const auto i = std::size_t(next);
            if (!is_lit[i] || labels.at[i] != 0)
                continue;
            labels.at[i] = label;
            waiting.push_back(next);
        }
    }
}

// [end regions]
// [start nearest]
/// Returns the lit pixel nearest to a point, within `max_distance` pixels along each axis; -1 if no pixel is.
int nearest_lit(const std::vector<bool> &is_lit, int width, int height, const std::array<double, 2> &point,
                double max_distance) {
    const auto [x, y] = point;
    const int x0 = int(std::max(0.0, x - max_distance)), x1 = int(std::min(double(width), x + max_distance + 1));
    const int y0 = int(std::max(0.0, y - max_distance)), y1 = int(std::min(double(height), y + max_distance + 1));
    double smallest = HUGE_VAL;
    int found = -1;
    for (int j = y0; j < y1; j++)
        for (int i = x0; i < x1; i++) {
            const double dx = i + 0.5 - x, dy = j + 0.5 - y, distance = dx * dx + dy * dy;
            if (!is_lit[std::size_t(j * width + i)] || distance >= smallest)
                continue;
            smallest = distance;
            found = j * width + i;
        }
    return found;
}

// [end nearest]
// [start removed]
/// Takes lamps of the photo out of the mask of the lights.
void take_out(const std::vector<luxfer::Transfer> &transfers) {
    const luxfer::Image mask = transfers[0].image(LUXFER_TRANSFER_LIGHTS_MASK);
    const auto size = mask.size();
    auto values = mask.samples();
    Labels labels = {int(size.width), int(size.height), std::vector<int>(values.size())};
    std::vector<bool> is_lit;
    for (const float value : values)
        is_lit.push_back(value > 0.5f);
    for (const auto &lamp : removed_lamps) {
        const int start = nearest_lit(is_lit, labels.width, labels.height, lamp, max_lamp_distance * labels.width);
        if (start >= 0 && labels.at[std::size_t(start)] == 0)
            fill(is_lit, labels, start, 1);
    }
    for (std::size_t i = 0; i < values.size(); i++)
        if (labels.at[i] != 0)
            values[i] = 0;
    const luxfer::ConstImageView view(values, size.width, size.height, 1);
    const luxfer::Image changed = luxfer::Image::create(mask.context(), view);
    for (const auto &transfer : transfers)
        transfer.use(LUXFER_PHASE_LIGHTS, changed);
}

// [end removed]
// [file reshape]
// [start grid]
/// Part of a picture: columns x0 to x1 and rows y0 to y1.
struct Box {
    std::uint32_t x0, y0, x1, y1;
};

/// Draws a line in a cell of a picture, along (dx, dy) through the middle of the cell; `side` is the cell's length.
void draw_line(std::vector<float> &pixels, std::uint32_t width, const Box &box, const std::array<double, 2> &middle,
               double dx, double dy, double side) {
    for (std::uint32_t y = box.y0; y < box.y1; y++)
        for (std::uint32_t x = box.x0; x < box.x1; x++) {
            const double px = x + 0.5 - middle[0], py = y + 0.5 - middle[1];
            const double along = (px * dx + py * dy) / (half_length * side), across = (py * dx - px * dy) / half_width;
            const double near_line = std::max(0.0, 1 - across * across), inside = std::max(0.0, 1 - along * along);
            for (std::size_t c = 0; c < 3; c++)
                pixels[3 * (std::size_t(y) * width + x) + c] =
                    float(0.5 + contrast * across * near_line * near_line * inside);
        }
}

/// Draws lines to the vanishing points of the room axes, one in each cell: the library finds cameras from lines.
luxfer::Image drawing(const luxfer::Context &context, std::uint32_t width, std::uint32_t height) {
    const std::uint32_t longer = std::max(width, height);
    const std::uint32_t cells = std::min(std::max(longer / cell, min_cells), max_cells);
    const double side = double(longer) / cells;
    const auto columns = std::uint32_t(std::max(1.0, std::floor(width / side + 0.5)));
    const auto rows = std::uint32_t(std::max(1.0, std::floor(height / side + 0.5)));
    std::vector<float> pixels(3 * std::size_t(width) * height, 0.5f);
    for (std::uint32_t j = 0; j < rows; j++)
        for (std::uint32_t i = 0; i < columns; i++) {
            const std::array<double, 2> middle = {(i + 0.5) * width / columns, (j + 0.5) * height / rows};
            const double *axis = photo_axes[(i + j) % 3];
            const double dx = photo_focal * axis[0] + (width / 2.0 - middle[0]) * axis[2];
            const double dy = photo_focal * axis[1] + (height / 2.0 - middle[1]) * axis[2];
            const double length = std::sqrt(dx * dx + dy * dy);
            const Box box = {i * width / columns, j * height / rows, (i + 1) * width / columns, (j + 1) * height / rows};
            if (length > side * std::fabs(axis[2])) // lines near a vanishing point run in all directions
                draw_line(pixels, width, box, middle, dx / length, dy / length, side);
        }
    return luxfer::Image::create(context, luxfer::ConstImageView(pixels, width, height));
}

/// Returns the index of the room axis of a camera that is nearest to a direction.
std::int32_t nearest_axis(const luxfer_rectify_report &found, const double (&direction)[3]) {
    double largest = -1;
    std::int32_t out = 0;
    for (std::int32_t i = 0; i < 3; i++) {
        const double *axis = found.axes[i];
        const double alike = std::fabs(axis[0] * direction[0] + axis[1] * direction[1] + axis[2] * direction[2]);
        if (alike > largest) {
            largest = alike;
            out = i;
        }
    }
    return out;
}

/// Replaces the camera of the photo, and returns settings with the axes that the plane spans.
luxfer::RectifyParams use_grid(const luxfer::Transfer &transfer, const luxfer::Image &photo) {
    const auto size = photo.size();
    const auto rectify = luxfer::Rectify::create(photo.context());
    rectify.set_photo(drawing(photo.context(), size.width, size.height));
    luxfer::RectifyParams params, plane;
    params.focal = photo_focal;
    params.distortion = 0;
    rectify.start(params).wait();
    transfer.use(rectify);
    const auto found = rectify.report();
    plane.plane_axes[0] = nearest_axis(found, photo_axes[0]);
    plane.plane_axes[1] = nearest_axis(found, photo_axes[1]);
    return plane;
}

// [end grid]
// [file mix]
/// Renders the lit room as the studio shows it.
void render_room(const luxfer::Scene &lit) {
    luxfer::CameraParams camera;
    for (int k = 0; k < 3; k++) {
        camera.position[k] = camera_position[k];
        camera.target[k] = camera_target[k];
    }
    camera.fov_y = camera_fov_y;
    luxfer::RenderParams params;
    params.width = picture_width;
    params.height = picture_height;
    params.preview = 1;
    // [render]
    const auto render = luxfer::Render::create(lit.context());
    render.set_scene(lit);
    render.set_camera(camera);
    render.start(params).wait();
    render.write_exr("render.exr");
    render.image(LUXFER_RENDER_PREVIEW).save("render.png", exposure);
}

/// Settings of a transfer.
struct Settings {
    luxfer::PatternParams pattern;
    luxfer::RelightParams relight;
    luxfer::RectifyParams plane;
};

/// Returns the settings of the transfer for a surface; they lead to `parts`.
luxfer::TransferParams params_of(const Placement &on, Settings &parts) {
    luxfer::TransferParams params;
    parts.pattern.scale = on.scale;
    parts.pattern.length = on.length;
    parts.pattern.rotation = on.rotation;
    parts.pattern.offset[0] = on.offset[0];
    parts.pattern.offset[1] = on.offset[1];
    parts.pattern.margin = on.margin;
    // [settings]
    params.pattern = &parts.pattern;
    params.relight = &parts.relight;
    return params;
}

/// Makes the texture of each surface from the photo, and solves for the strength of all.
void transfer_light(const std::vector<luxfer::Transfer> &transfers, [[maybe_unused]] const luxfer::Image &photo) {
    std::vector<Settings> parts(placements.size());
    std::vector<luxfer::TransferParams> params;
    for (std::size_t k = 0; k < placements.size(); k++) {
        params.push_back(params_of(placements[k], parts[k]));
        transfers[k].start(LUXFER_STAGE_VIEW, LUXFER_STAGE_LIGHTS).wait();
        std::vector<double> corners;
        for (const auto &zone : placements[k].zones)
            corners.insert(corners.end(), zone.begin(), zone.end());
        transfers[k].set_zones(corners);
    }
    // [start removed]
    take_out(transfers);
    // [end removed]
    // [start grid]
    for (std::size_t k = 0; k < placements.size(); k++) {
        parts[k].plane = use_grid(transfers[k], photo);
        params[k].rectify = &parts[k].plane;
    }
    // [end grid]
    // [start reshaped]
    reshape_lamps(transfers, photo);
    // [end reshaped]
    for (std::size_t k = 0; k < placements.size(); k++)
        transfers[k].start(LUXFER_STAGE_UNWARP, LUXFER_STAGE_UNWARP, params[k]).wait();
    const luxfer::Context &context = photo.context();
    luxfer::Transfer::start_all(context, transfers, LUXFER_STAGE_EMISSION, LUXFER_STAGE_RELIGHT, params).wait();
}

/// Writes the lit room, the schedule of its lamps, and the picture.
void write_results(const std::vector<luxfer::Transfer> &transfers, [[maybe_unused]] const luxfer::Scene &room) {
    const luxfer::Scene lit = transfers[0].scene();
    // [start mix]
    auto schedule = begin_schedule("luminaires.csv");
    // [end mix]
    for (std::size_t k = 0; k < placements.size(); k++) {
        std::vector<luxfer_fixture> lamps;
        for (std::uint32_t i = 0, count = transfers[k].report().fixtures; i < count; i++)
            lamps.push_back(transfers[k].fixture(i));
        // [start plain]
        transfers[k].save_fixtures("luminaires.csv");
        // [end plain]
        // [start mix]
        mix_lamps(room, lit, placements[k], lamps);
        mix_list(room, placements[k], lamps);
        write_lamps(schedule, placements[k], lamps);
        // [end mix]
        for (const auto &lamp : lamps)
            std::printf("kind %u: %.0f lm, %.0f K at [%.2f, %.2f, %.2f]\n", unsigned(lamp.kind), lamp.flux, lamp.cct,
                        double(lamp.position[0]), double(lamp.position[1]), double(lamp.position[2]));
    }
    lit.save("lit.glb");
    render_room(lit);
}

} // namespace

int main(int argc, char **argv) {
    try {
        const std::string photo_path = argc > 1 ? argv[1] : photo_file, room_path = argc > 2 ? argv[2] : room_file;
        const auto context = luxfer::Context::create();
        const auto photo = luxfer::Image::load(context, photo_path);
        const auto room = room_path.empty() ? luxfer::Scene::demo(context, LUXFER_DEMO_TARGET_ROOM) // the generated room
                                            : luxfer::Scene::load(context, room_path);
        std::vector<luxfer::Transfer> transfers;
        for (const Placement &on : placements) {
            transfers.push_back(luxfer::Transfer::create(context));
            transfers.back().set_photo(photo);
            transfers.back().set_scene(room, on.surface);
            transfers.back().set_strokes(strokes_on(photo));
        }
        transfer_light(transfers, photo);
        write_results(transfers, room);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
