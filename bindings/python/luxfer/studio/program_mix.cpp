// [start mix]
using Lamps = std::vector<luxfer_fixture>;

/// A place on a surface: u and v in metres.
using Place = std::array<double, 2>;

double factor_of(const Placement &on, std::uint32_t kind) {
    for (const Dimmer &dimmer : on.dimmers)
        if (dimmer.kind == kind)
            return dimmer.factor;
    return 1;
}

/// Whether all lamps of a surface are as the transfer has made them.
bool is_plain(const Placement &on) {
    const auto is_full = [](const Dimmer &dimmer) { return dimmer.factor == 1; };
    return on.added.empty() && std::all_of(on.dimmers.begin(), on.dimmers.end(), is_full);
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

/// Returns the largest distance in metres of the bounds of a mesh from those of a surface.
double misfit(const luxfer::Scene &lit, std::uint32_t mesh, const luxfer_surface &surface) {
    std::vector<float> positions(3 * std::size_t(lit.mesh(mesh).vertex_count));
    lit.read_vertices(mesh, LUXFER_VERTEX_POSITION, positions);
    Place low = {HUGE_VAL, HUGE_VAL}, high = {-HUGE_VAL, -HUGE_VAL};
    double out = 0;
    for (std::size_t i = 0; i < positions.size(); i += 3) {
        const std::array<double, 3> position = {positions[i], positions[i + 1], positions[i + 2]};
        const Place place = on_surface(surface, position);
        double away = 0;
        for (std::size_t k = 0; k < 3; k++)
            away += (position[k] - surface.origin[k]) * surface.normal[k];
        for (std::size_t k = 0; k < 2; k++) {
            low[k] = std::min(low[k], place[k]);
            high[k] = std::max(high[k], place[k]);
        }
        out = std::max(out, std::fabs(away));
    }
    for (std::size_t k = 0; k < 2; k++)
        out = std::max({out, std::fabs(low[k]), std::fabs(high[k] - surface.size[k])});
    return out;
}

/// Returns the mesh with the lamps of a surface. A transfer adds the meshes of its surfaces last; that of a surface
/// fills its rectangle best.
std::uint32_t mesh_of(const luxfer::Scene &lit, const luxfer_surface &surface) {
    const std::uint32_t end = lit.counts().meshes;
    std::uint32_t best = 0;
    double smallest = HUGE_VAL;
    for (std::uint32_t mesh = end - std::uint32_t(placements.size()); mesh < end; mesh++) {
        const double distance = misfit(lit, mesh, surface);
        if (distance >= smallest)
            continue;
        smallest = distance;
        best = mesh;
    }
    return best;
}

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
void mix_texture(Texture &t, const Placement &on, const Lamps &lamps) {
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
            factors[std::size_t(region)] = float(factor_of(on, lamp.kind));
    for (std::size_t i = 0; i < 3 * pixels; i++)
        t.values[i] *= factors[std::size_t(t.labels.at[i / 3])];
    for (const auto &added : on.added)
        if (const auto model = model_of(lamps, std::uint32_t(added[0])))
            copy_lamp(*model, t, added);
}

/// Changes the lamps of a surface in the lit room.
void mix_lamps(const luxfer::Scene &room, const luxfer::Scene &lit, const Placement &on, const Lamps &lamps) {
    if (is_plain(on))
        return;
    const luxfer_surface surface = room.find_surface(on.surface);
    const std::uint32_t mesh = mesh_of(lit, surface), material = lit.mesh(mesh).material;
    const auto use = lit.material_texture(material, LUXFER_TEXTURE_EMISSION);
    const auto image = lit.texture(use.texture);
    const auto size = image.size();
    Texture t = {};
    t.values = image.samples();
    t.labels = {int(size.width), int(size.height), std::vector<int>(std::size_t(size.width) * size.height)};
    t.surface = surface;
    fit_map(lit, mesh, use.uv_set, t);
    mix_texture(t, on, lamps);
    const luxfer::ConstImageView view(t.values, size.width, size.height, size.channels);
    const auto changed = luxfer::Image::create(lit.context(), view);
    const auto index = lit.add_texture(changed, use.wrap_u, use.wrap_v);
    lit.set_material_texture(material, LUXFER_TEXTURE_EMISSION, index, use.uv_set, use.transform);
}

/// Appends the added lamps to the list of lamps, and gives each lamp its share of the light.
void mix_list(const luxfer::Scene &room, const Placement &on, Lamps &lamps) {
    const auto surface = room.find_surface(on.surface);
    const Lamps found = lamps;
    for (const auto &added : on.added) {
        auto lamp = model_of(found, std::uint32_t(added[0]));
        if (!lamp)
            continue;
        const auto [u, v] = step_to(*lamp, surface, added);
        for (int k = 0; k < 3; k++)
            lamp->position[k] += float(u * surface.u_axis[k] + v * surface.v_axis[k]);
        lamps.push_back(*lamp);
    }
    for (auto &lamp : lamps) {
        const double factor = factor_of(on, lamp.kind);
        lamp.flux *= factor;
        for (float &value : lamp.radiance)
            value = float(factor * value);
    }
}

/// Begins a schedule with the columns of luxfer_transfer_save_fixtures and, if there are several, the surface.
std::ofstream begin_schedule(const char *path) {
    std::ofstream out(path);
    if (!out)
        throw std::runtime_error(std::string(path) + " cannot be written");
    out << "x_m,y_m,z_m,normal_x,normal_y,normal_z,axis_x,axis_y,axis_z,length_m,width_m,area_m2,"
           "red_cd_m2,green_cd_m2,blue_cd_m2,flux_lm,cct_k,duv,kind"
        << (placements.size() > 1 ? ",surface\n" : "\n") << std::setprecision(7);
    return out;
}

/// Writes the lamps of a surface.
void write_lamps(std::ofstream &out, const Placement &on, const Lamps &lamps) {
    for (const auto &l : lamps) {
        for (const auto *numbers : {l.position, l.normal, l.axis})
            out << numbers[0] << ',' << numbers[1] << ',' << numbers[2] << ',';
        out << l.size[0] << ',' << l.size[1] << ',' << l.area << ',' << l.radiance[0] << ',' << l.radiance[1] << ','
            << l.radiance[2] << ',' << l.flux << ',' << l.cct << ',' << l.duv << ',' << l.kind;
        if (placements.size() > 1)
            out << ',' << std::quoted(std::string(on.surface), '"', '"');
        out << '\n';
    }
}

// [end mix]
