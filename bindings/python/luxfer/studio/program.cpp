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
// [start removed]
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

/// Takes lamps of the photo out of the mask of the lights.
void take_out(const luxfer::Transfer &transfer) {
    const auto mask = transfer.image(LUXFER_TRANSFER_LIGHTS_MASK);
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
    transfer.use(LUXFER_PHASE_LIGHTS, luxfer::Image::create(transfer.context(), view));
}

// [end removed]
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
// [start mix]
using Lamps = std::vector<luxfer_fixture>;

/// A place on a surface: u and v in metres.
using Place = std::array<double, 2>;

double factor_of(std::uint32_t kind) {
    for (const Dimmer &dimmer : dimmers)
        if (dimmer.kind == kind)
            return dimmer.factor;
    return 1;
}

/// Returns the place on a surface of a position.
Place on_surface(const luxfer_surface &surface, const std::array<double, 3> &position) {
    Place place = {};
    for (std::size_t k = 0; k < 3; k++) {
        place[0] += (position[k] - surface.origin[k]) * surface.u_axis[k];
        place[1] += (position[k] - surface.origin[k]) * surface.v_axis[k];
    }
    return place;
}

/// The emissive texture of the lit room, its lit regions, and how the surface maps to it.
struct Texture {
    std::vector<float> values;
    Labels labels;
    int count; // of regions
    luxfer_surface surface;
    double map[2][3]; // u and v in metres, and 1, to shares of width and height
};

/// Fits the map from the surface to the texture to the vertices of the mesh that the transfer has added.
void fit_map(const luxfer::Scene &lit, std::uint32_t mesh, std::uint32_t uv_set, Texture &t) {
    const auto vertices = std::size_t(lit.mesh(mesh).vertex_count);
    std::vector<float> positions(3 * vertices), uvs(2 * vertices);
    lit.read_vertices(mesh, LUXFER_VERTEX_POSITION, positions);
    lit.read_vertices(mesh, uv_set != 0 ? LUXFER_VERTEX_UV_1 : LUXFER_VERTEX_UV_0, uvs);
    double m[3][5] = {};
    for (std::size_t i = 0; i < vertices; i++) { // sum up the normal equations
        const Place place = on_surface(t.surface, {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
        const double known[] = {place[0], place[1], 1};
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++)
                m[r][c] += known[r] * known[c];
            for (int c = 0; c < 2; c++)
                m[r][3 + c] += known[r] * uvs[2 * i + std::size_t(c)];
        }
    }
    for (int k = 0; k < 3; k++) // eliminate; the matrix is symmetric and positive definite
        for (int r = 0; r < 3; r++) {
            const double share = m[r][k] / m[k][k];
            for (int c = 0; r != k && c < 5; c++)
                m[r][c] -= share * m[k][c];
        }
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 2; c++)
            t.map[c][r] = m[r][3 + c] / m[r][r];
}

/// Returns the regions that a lamp covers.
std::set<int> regions_of(const luxfer_fixture &lamp, const Texture &t) {
    std::set<int> regions;
    double across[3];
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        across[k] = double(lamp.normal[a]) * lamp.axis[b] - double(lamp.normal[b]) * lamp.axis[a];
    }
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++) {
            std::array<double, 3> position;
            for (std::size_t k = 0; k < 3; k++)
                position[k] = lamp.position[k] + ((i + 0.5) / 5 - 0.5) * lamp.size[0] * lamp.axis[k] +
                              ((j + 0.5) / 5 - 0.5) * lamp.size[1] * across[k];
            const auto [u, v] = on_surface(t.surface, position);
            const int x = int((t.map[0][0] * u + t.map[0][1] * v + t.map[0][2]) * t.labels.width);
            const int y = int((t.map[1][0] * u + t.map[1][1] * v + t.map[1][2]) * t.labels.height);
            const int inside[] = {std::clamp(x, 0, t.labels.width - 1), std::clamp(y, 0, t.labels.height - 1)};
            regions.insert(t.labels.at[std::size_t(inside[1] * t.labels.width + inside[0])]);
        }
    regions.erase(0);
    return regions;
}

/// Returns the largest lamp of a kind, if the room has one.
std::optional<luxfer_fixture> model_of(const Lamps &lamps, std::uint32_t kind) {
    std::optional<luxfer_fixture> out;
    for (const auto &lamp : lamps)
        if (lamp.kind == kind && (!out || lamp.area > out->area))
            out = lamp;
    return out;
}

/// Returns the step in metres along u and v from a lamp to the place of an added lamp.
Place step_to(const luxfer_fixture &lamp, const luxfer_surface &surface, const std::array<double, 3> &added) {
    const auto [u, v] = on_surface(surface, {lamp.position[0], lamp.position[1], lamp.position[2]});
    return {added[1] - u, added[2] - v};
}

/// Copies the texels of a lamp to another place; what lies beyond the texture is cut.
void copy_lamp(const luxfer_fixture &lamp, Texture &t, const std::array<double, 3> &added) {
    const auto [u, v] = step_to(lamp, t.surface, added);
    const int dx = int(std::rint((t.map[0][0] * u + t.map[0][1] * v) * t.labels.width));
    const int dy = int(std::rint((t.map[1][0] * u + t.map[1][1] * v) * t.labels.height));
    const auto regions = regions_of(lamp, t);
    const auto before = t.values;
    for (int y = 0; y < t.labels.height; y++)
        for (int x = 0; x < t.labels.width; x++) {
            const int x1 = x + dx, y1 = y + dy;
            const auto from = std::size_t(y * t.labels.width + x), to = std::size_t(y1 * t.labels.width + x1);
            const bool is_inside = x1 >= 0 && x1 < t.labels.width && y1 >= 0 && y1 < t.labels.height;
            if (is_inside && regions.count(t.labels.at[from]) > 0)
                std::copy_n(&before[3 * from], 3, &t.values[3 * to]);
        }
}

/// Gives each kind of lamp its share of the light in the texture, and adds lamps to it.
void mix_texture(Texture &t, const Lamps &lamps) {
    const std::size_t pixels = t.labels.at.size();
    std::vector<bool> is_lit;
    for (std::size_t i = 0; i < pixels; i++)
        is_lit.push_back(t.values[3 * i] > 0 || t.values[3 * i + 1] > 0 || t.values[3 * i + 2] > 0);
    for (std::size_t i = 0; i < pixels; i++)
        if (is_lit[i] && t.labels.at[i] == 0)
            fill(is_lit, t.labels, int(i), ++t.count);
    std::vector<float> factors(std::size_t(t.count) + 1, 1.0f);
    for (const auto &lamp : lamps)
        for (const int region : regions_of(lamp, t))
            factors[std::size_t(region)] = float(factor_of(lamp.kind));
    for (std::size_t i = 0; i < 3 * pixels; i++)
        t.values[i] *= factors[std::size_t(t.labels.at[i / 3])];
    for (const auto &added : added_lamps)
        if (const auto model = model_of(lamps, std::uint32_t(added[0])))
            copy_lamp(*model, t, added);
}

/// Changes the lamps of the lit room.
void mix_lamps(const luxfer::Scene &room, const luxfer::Scene &lit, const Lamps &lamps) {
    const std::uint32_t mesh = lit.counts().meshes - 1, material = lit.mesh(mesh).material;
    const auto use = lit.material_texture(material, LUXFER_TEXTURE_EMISSION);
    const auto image = lit.texture(use.texture);
    const auto size = image.size();
    Texture t = {};
    t.values = image.samples();
    t.labels = {int(size.width), int(size.height), std::vector<int>(std::size_t(size.width) * size.height)};
    t.surface = room.find_surface(surface_name);
    fit_map(lit, mesh, use.uv_set, t);
    mix_texture(t, lamps);
    const luxfer::ConstImageView view(t.values, size.width, size.height, size.channels);
    const auto changed = luxfer::Image::create(lit.context(), view);
    const auto index = lit.add_texture(changed, use.wrap_u, use.wrap_v);
    lit.set_material_texture(material, LUXFER_TEXTURE_EMISSION, index, use.uv_set, use.transform);
}

/// Appends the added lamps to the list of lamps, and gives each lamp its share of the light.
void mix_list(const luxfer::Scene &room, Lamps &lamps) {
    const auto surface = room.find_surface(surface_name);
    const Lamps found = lamps;
    for (const auto &added : added_lamps) {
        auto lamp = model_of(found, std::uint32_t(added[0]));
        if (!lamp)
            continue;
        const auto [u, v] = step_to(*lamp, surface, added);
        for (int k = 0; k < 3; k++)
            lamp->position[k] += float(u * surface.u_axis[k] + v * surface.v_axis[k]);
        lamps.push_back(*lamp);
    }
    for (auto &lamp : lamps) {
        const double factor = factor_of(lamp.kind);
        lamp.flux *= factor;
        for (float &value : lamp.radiance)
            value = float(factor * value);
    }
}

/// Writes the schedule with the columns of luxfer_transfer_save_fixtures.
void write_schedule(const char *path, const Lamps &lamps) {
    std::FILE *file = std::fopen(path, "w");
    if (file == nullptr)
        throw std::runtime_error(std::string(path) + " cannot be written");
    std::fprintf(file, "x_m,y_m,z_m,normal_x,normal_y,normal_z,axis_x,axis_y,axis_z,length_m,width_m,area_m2,"
                       "red_cd_m2,green_cd_m2,blue_cd_m2,flux_lm,cct_k,duv,kind\n");
    for (const auto &l : lamps) {
        for (const auto *numbers : {l.position, l.normal, l.axis})
            std::fprintf(file, "%.7g,%.7g,%.7g,", double(numbers[0]), double(numbers[1]), double(numbers[2]));
        std::fprintf(file, "%.7g,%.7g,%.7g,", l.size[0], l.size[1], l.area);
        std::fprintf(file, "%.7g,%.7g,%.7g,", double(l.radiance[0]), double(l.radiance[1]), double(l.radiance[2]));
        std::fprintf(file, "%.7g,%.7g,%.7g,%u\n", l.flux, l.cct, l.duv, unsigned(l.kind));
    }
    std::fclose(file);
}

// [end mix]
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

/// Makes the texture of the surface from the photo, and solves for its strength.
void transfer_light(const luxfer::Transfer &transfer, [[maybe_unused]] const luxfer::Image &photo) {
    luxfer::TransferParams params;
    luxfer::PatternParams pattern;
    luxfer::RelightParams relight;
    params.pattern = &pattern;
    params.relight = &relight;
    // [settings]
    transfer.start(LUXFER_STAGE_VIEW, LUXFER_STAGE_LIGHTS).wait();
    // [start removed]
    take_out(transfer);
    // [end removed]
    // [start grid]
    const auto plane = use_grid(transfer, photo);
    params.rectify = &plane;
    // [end grid]
    std::vector<double> corners;
    for (const auto &zone : zones)
        corners.insert(corners.end(), zone.begin(), zone.end());
    transfer.set_zones(corners);
    transfer.start(LUXFER_STAGE_UNWARP, LUXFER_STAGE_RELIGHT, params).wait();
}

/// Writes the lit room, the schedule of its lamps, and the picture.
void write_results(const luxfer::Transfer &transfer, [[maybe_unused]] const luxfer::Scene &room) {
    const auto lit = transfer.scene();
    std::vector<luxfer_fixture> lamps;
    for (std::uint32_t i = 0, count = transfer.report().fixtures; i < count; i++)
        lamps.push_back(transfer.fixture(i));
    // [start plain]
    transfer.save_fixtures("luminaires.csv");
    // [end plain]
    // [start mix]
    mix_lamps(room, lit, lamps);
    mix_list(room, lamps);
    write_schedule("luminaires.csv", lamps);
    // [end mix]
    for (const auto &lamp : lamps)
        std::printf("kind %u: %.0f lm, %.0f K at [%.2f, %.2f, %.2f]\n", unsigned(lamp.kind), lamp.flux, lamp.cct,
                    double(lamp.position[0]), double(lamp.position[1]), double(lamp.position[2]));
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
        const auto transfer = luxfer::Transfer::create(context);
        transfer.set_photo(photo);
        transfer.set_scene(room, surface_name);
        transfer.set_strokes(strokes_on(photo));
        transfer_light(transfer, photo);
        write_results(transfer, room);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
