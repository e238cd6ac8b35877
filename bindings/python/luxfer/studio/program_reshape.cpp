// [start reshaped]
/// A map of the plane, row by row.
using Map = std::array<double, 9>;

/// Returns the map of the unit square to four corners.
Map square_to(const std::array<double, 8> &corners) {
    const auto [x0, y0, x1, y1, x2, y2, x3, y3] = corners;
    const double dx1 = x1 - x2, dy1 = y1 - y2, dx2 = x3 - x2, dy2 = y3 - y2;
    const double sx = x0 - x1 + x2 - x3, sy = y0 - y1 + y2 - y3;
    const double below = dx1 * dy2 - dx2 * dy1;
    const double g = (sx * dy2 - dx2 * sy) / below, h = (dx1 * sy - sx * dy1) / below;
    return {x1 - x0 + g * x1, x3 - x0 + h * x3, x0, y1 - y0 + g * y1, y3 - y0 + h * y3, y0, g, h, 1};
}

/// Returns the inverse of a map, up to a factor.
Map inverse_of(const Map &map) {
    const auto [a, b, c, d, e, f, g, h, i] = map;
    return {e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g,
            c * d - a * f, d * h - e * g, b * g - a * h, a * e - b * d};
}

std::array<double, 2> map_to(const Map &m, const std::array<double, 2> &at) {
    const double w = m[6] * at[0] + m[7] * at[1] + m[8];
    return {(m[0] * at[0] + m[1] * at[1] + m[2]) / w, (m[3] * at[0] + m[4] * at[1] + m[5]) / w};
}

/// The photo, the mask of its lights and that of its plane, before and after, and the lamp on each pixel, from 1.
struct Edit {
    std::vector<float> photo, mask, plane, new_photo, new_mask;
    std::vector<bool> is_lit;
    Labels labels;
    int channels;
};

/// Columns x0 to x1 and rows y0 to y1 of pixels.
struct Pixels {
    int x0, y0, x1, y1;
};

Pixels box_of(const Edit &e, int label) {
    Pixels box = {e.labels.width, e.labels.height, 0, 0};
    for (int y = 0; y < e.labels.height; y++)
        for (int x = 0; x < e.labels.width; x++)
            if (e.labels.at[std::size_t(y * e.labels.width + x)] == label)
                box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
    return box;
}

/// Fills the place of a lamp with the mean colour of the plane around it.
void cut_out(Edit &e, int label) {
    const auto [x0, y0, x1, y1] = box_of(e, label);
    const int width = e.labels.width, height = e.labels.height;
    std::array<double, 4> sums = {};
    double count = 0;
    for (int y = std::max(0, 2 * y0 - y1); y < std::min(height, 2 * y1 - y0); y++)
        for (int x = std::max(0, 2 * x0 - x1); x < std::min(width, 2 * x1 - x0); x++) {
            const auto at = std::size_t(y * width + x);
            if (!(e.plane[at] > 0.5f) || e.is_lit[at])
                continue;
            for (std::size_t c = 0; c < std::size_t(e.channels); c++)
                sums[c] += double(e.photo[std::size_t(e.channels) * at + c]);
            count += 1;
        }
    for (std::size_t at = 0; at < e.mask.size(); at++) {
        if (e.labels.at[at] != label)
            continue;
        e.new_mask[at] = 0;
        for (std::size_t c = 0; c < std::size_t(e.channels); c++)
            e.new_photo[std::size_t(e.channels) * at + c] = float(count > 0 ? sums[c] / count : 0);
    }
}

/// Returns the pixels around four corners.
Pixels pixels_around(const std::array<double, 8> &corners, int width, int height) {
    const auto [x0, x1] = std::minmax({corners[0], corners[2], corners[4], corners[6]});
    const auto [y0, y1] = std::minmax({corners[1], corners[3], corners[5], corners[7]});
    const double across = beyond_lamp * (x1 - x0), down = beyond_lamp * (y1 - y0);
    return {int(std::max(0.0, std::floor(x0 - across))), int(std::max(0.0, std::floor(y0 - down))),
            int(std::min(double(width), std::floor(x1 + across) + 1)),
            int(std::min(double(height), std::floor(y1 + down) + 1))};
}

/// Puts the pixels of a lamp into its new rectangle.
void put_back(Edit &e, int label, const Reshaped &lamp) {
    const Map forward = square_to(lamp.before), inverse = inverse_of(square_to(lamp.after));
    const int width = e.labels.width, height = e.labels.height;
    const Pixels box = pixels_around(lamp.after, width, height);
    for (int y = box.y0; y < box.y1; y++)
        for (int x = box.x0; x < box.x1; x++) {
            const auto [u, v] = map_to(forward, map_to(inverse, {x + 0.5, y + 0.5}));
            if (!(u >= 0 && u < width && v >= 0 && v < height))
                continue;
            const auto from = std::size_t(int(v) * width + int(u)), to = std::size_t(y * width + x);
            if (e.labels.at[from] != label)
                continue;
            const auto channels = std::size_t(e.channels);
            std::copy_n(&e.photo[channels * from], channels, &e.new_photo[channels * to]);
            e.new_mask[to] = e.mask[from];
        }
}

/// Finds the lamps that are reshaped, and returns the number of each; 0 if it is not there.
std::vector<int> find_reshaped(Edit &e) {
    std::vector<int> found;
    for (const Reshaped &lamp : reshaped_lamps) {
        const double distance = max_lamp_distance * e.labels.width;
        const int start = nearest_lit(e.is_lit, e.labels.width, e.labels.height, lamp.at, distance);
        if (start >= 0 && e.labels.at[std::size_t(start)] == 0)
            fill(e.is_lit, e.labels, start, int(found.size()) + 1);
        found.push_back(start >= 0 ? e.labels.at[std::size_t(start)] : 0);
    }
    return found;
}

/// Moves, resizes and turns lamps in the photo and in the mask of its lights.
void reshape_lamps(const std::vector<luxfer::Transfer> &transfers, const luxfer::Image &photo) {
    const auto size = photo.size();
    Edit e;
    e.photo = e.new_photo = photo.samples();
    e.mask = e.new_mask = transfers[0].image(LUXFER_TRANSFER_LIGHTS_MASK).samples();
    e.plane = transfers[0].image(LUXFER_TRANSFER_PLANE_MASK).samples();
    e.channels = int(size.channels);
    e.labels = {int(size.width), int(size.height), std::vector<int>(e.mask.size())};
    for (const float value : e.mask)
        e.is_lit.push_back(value > 0.5f);
    const auto found = find_reshaped(e);
    for (const int label : found)
        if (label != 0)
            cut_out(e, label);
    for (std::size_t k = 0; k < found.size(); k++)
        if (found[k] != 0)
            put_back(e, found[k], reshaped_lamps[k]);
    const luxfer::ConstImageView pixels(e.new_photo, size.width, size.height, size.channels);
    const luxfer::ConstImageView mask(e.new_mask, size.width, size.height, 1);
    const luxfer::Image new_photo = luxfer::Image::create(photo.context(), pixels);
    const luxfer::Image new_mask = luxfer::Image::create(photo.context(), mask);
    for (const auto &transfer : transfers) {
        transfer.set_photo(new_photo);
        transfer.use(LUXFER_PHASE_LIGHTS, new_mask);
    }
}

// [end reshaped]
