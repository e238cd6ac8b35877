// Lighting design: powers and bodies of lamps, maps of importance, luminaire files, colour temperature and glare.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "photo.hpp"
#include "render.hpp"

namespace luxfer {

using LampsParams = Params<luxfer_lamps_params, LUXFER_STRUCT_LAMPS_PARAMS>;
using ImportanceParams = Params<luxfer_importance_params, LUXFER_STRUCT_IMPORTANCE_PARAMS>;
using GonioParams = Params<luxfer_gonio_params, LUXFER_STRUCT_GONIO_PARAMS>;
using GlareParams = Params<luxfer_glare_params, LUXFER_STRUCT_GLARE_PARAMS>;
using SunParams = Params<luxfer_sun_params, LUXFER_STRUCT_SUN_PARAMS>;
using SkyParams = Params<luxfer_sky_params, LUXFER_STRUCT_SKY_PARAMS>;
using FalseColourParams = Params<luxfer_false_colour_params, LUXFER_STRUCT_FALSE_COLOUR_PARAMS>;
using LuminaireParams = Params<luxfer_luminaire_params, LUXFER_STRUCT_LUMINAIRE_PARAMS>;
using PendantsParams = Params<luxfer_pendants_params, LUXFER_STRUCT_PENDANTS_PARAMS>;
using PlacementParams = Params<luxfer_placement_params, LUXFER_STRUCT_PLACEMENT_PARAMS>;

/// Solves for lamp powers that come as near as possible to several goals. See luxfer_lamps.
class Lamps : public Handle<luxfer_lamps> {
public:
    using Handle::Handle;

    static Result<Lamps> create(const Context &context) { return make_in<Lamps>(context, luxfer_lamps_create); }

    /// Sets the scene and the emitting material whose lamps are solved for; removes all goals.
    Result<> set_scene(const Scene &scene, std::uint32_t material) const {
        return call(luxfer_lamps_set_scene, scene.get(), material);
    }

    /// Adds a goal: the mean radiance that a mesh should have, in cd/m²; quantity is a LUXFER_QUANTITY_ value.
    Result<> add_mesh(std::uint32_t mesh, luxfer_quantity quantity, Rgb target, double weight = 1) const {
        return call(luxfer_lamps_add_mesh, mesh, quantity, target.data(), weight);
    }

    /// Adds a goal: the mean illuminance that a calculation grid should have, in lux.
    Result<> add_grid(const luxfer_illuminance_grid &grid, float lux, double weight = 1) const {
        return call(luxfer_lamps_add_grid, &grid, lux, weight);
    }

    /// Makes a goal a limit, by one LUXFER_CONSTRAINT_ value for all channels, or one for each channel.
    Result<> set_constraint(std::uint32_t goal, luxfer_constraint constraint) const {
        return set_constraint(goal, {constraint, constraint, constraint});
    }
    Result<> set_constraint(std::uint32_t goal, const std::array<luxfer_constraint, 3> &constraint) const {
        return call(luxfer_lamps_set_constraint, goal, constraint.data());
    }

    /// Sets the dimming levels of the lamps' drivers, as factors of the emission; empty means continuous dimming.
    Result<> set_levels(const std::vector<double> &levels) const {
        return call(luxfer_lamps_set_levels, levels.data(), levels.size());
    }

    Result<> clear_goals() const { return call(luxfer_lamps_clear_goals); }

    Result<Job> start(const luxfer_lamps_params &params = LampsParams()) const {
        return make<Job>(luxfer_lamps_start, &params);
    }

    Result<luxfer_lamps_report> report() const { return value<luxfer_lamps_report>(luxfer_lamps_get_report); }
    Result<luxfer_lamp> lamp(std::uint32_t index) const { return value<luxfer_lamp>(luxfer_lamps_get_lamp, index); }
    Result<luxfer_lamps_goal> goal(std::uint32_t index) const {
        return value<luxfer_lamps_goal>(luxfer_lamps_get_goal, index);
    }
    Result<luxfer_lamps_response> response(std::uint32_t goal, std::uint32_t lamp) const {
        return value<luxfer_lamps_response>(luxfer_lamps_get_response, goal, lamp);
    }

    /// The reason why goals are not met; empty if all are met.
    Result<std::string> reason() const { return text(luxfer_lamps_get_reason); }

    /// The emission texture with every lamp multiplied by its scale.
    Result<Image> texture() const { return make<Image>(luxfer_lamps_get_texture); }
};

/// A map of the light that each point of an emitting surface would send to a target. See luxfer_importance.
class Importance : public Handle<luxfer_importance> {
public:
    using Handle::Handle;

    static Result<Importance> create(const Context &context) {
        return make_in<Importance>(context, luxfer_importance_create);
    }

    /// Sets the scene, the material of the surfaces that will emit, and the mesh that is the target.
    Result<> set_scene(const Scene &scene, std::uint32_t material, std::uint32_t mesh) const {
        return call(luxfer_importance_set_scene, scene.get(), material, mesh);
    }

    Result<Job> start(const luxfer_importance_params &params = ImportanceParams()) const {
        return make<Job>(luxfer_importance_start, &params);
    }

    Result<Image> image() const { return make<Image>(luxfer_importance_get_image); }

    /// Computes the light that the target receives from an emissive texture, in cd/m².
    Result<luxfer_importance_report> respond(const Image &texture) const {
        return value<luxfer_importance_report>(luxfer_importance_respond, texture.get(), nullptr);
    }

    /// Computes the light that the target receives from a placed texture. The matrix placement (row by row) maps the
    /// texture coordinates of the surface to texture coordinates of the texture.
    Result<luxfer_importance_report> respond(const Image &texture, Numbers<9> placement) const {
        return value<luxfer_importance_report>(luxfer_importance_respond, texture.get(), placement.data());
    }

    /// Solves for the factor of a texture that gives the target a mean radiance, in cd/m².
    Result<luxfer_relight_report> solve(const Image &texture, Rgb target) const {
        return value<luxfer_relight_report>(luxfer_importance_solve, texture.get(), nullptr, target.data());
    }
    Result<luxfer_relight_report> solve(const Image &texture, Numbers<9> placement, Rgb target) const {
        return value<luxfer_relight_report>(luxfer_importance_solve, texture.get(), placement.data(),
                                            target.data());
    }

    /// Starts a job that finds the best placement of a texture in cd/m².
    Result<Job> start_placement(const Image &texture, const luxfer_placement_params &params = PlacementParams()) const {
        return make<Job>(luxfer_importance_start_placement, texture.get(), &params);
    }

    /// The placement that the job of start_placement has found.
    Result<luxfer_placement> placement() const { return value<luxfer_placement>(luxfer_importance_get_placement); }
};

/// A luminous intensity distribution from an IES, EULUMDAT, TM-33 or GLDF file. See luxfer_distribution.
class Distribution : public Handle<luxfer_distribution> {
public:
    using Handle::Handle;

    static Result<Distribution> load(const Context &context, Text path) {
        return make_in<Distribution>(context, luxfer_distribution_load, path.get());
    }

    /// Loads a text file in memory; format is a LUXFER_DISTRIBUTION_ value.
    static Result<Distribution> load(const Context &context, Text file, luxfer_distribution_format format) {
        const void *data = file.get();
        return make_in<Distribution>(context, luxfer_distribution_load_memory, data, std::strlen(file.get()), format);
    }

    /// Loads a file of any format from memory: any container of bytes.
    template <class Bytes>
    static Result<Distribution> load_memory(const Context &context, const Bytes &file,
                                            luxfer_distribution_format format = LUXFER_DISTRIBUTION_ANY) {
        static_assert(sizeof *std::data(file) == 1, "a file consists of bytes");
        const void *data = std::data(file);
        return make_in<Distribution>(context, luxfer_distribution_load_memory, data, std::size(file), format);
    }

    /// Saves to an .ies, .ldt, .xml or .gldf file.
    Result<> save(Text path) const { return call(luxfer_distribution_save, path.get()); }

    Result<luxfer_distribution_report> report() const {
        return value<luxfer_distribution_report>(luxfer_distribution_get_report);
    }
    Result<std::string> name() const { return text(luxfer_distribution_get_name); }

    /// The luminous intensity in candela in a direction, given by its angles C and gamma in degrees.
    Result<double> intensity(double c, double gamma) const {
        return value<double>(luxfer_distribution_get_intensity, c, gamma);
    }
};

/// Adds a luminaire to a scene; returns its index among the lights.
inline Result<std::uint32_t> add_luminaire(const Scene &scene, const Distribution &distribution,
                                           const luxfer_luminaire_params &params = LuminaireParams()) {
    std::uint32_t index = 0;
    const luxfer_status status = luxfer_scene_add_luminaire(scene.get(), distribution.get(), &params, &index);
    return detail::to_result(scene.context().get(), status, index);
}

/// The position of the sun at a place and a time.
inline Result<luxfer_sun_position> sun_position(const Context &context, const luxfer_sun_params &params) {
    luxfer_sun_position position = {};
    const luxfer_status status = luxfer_sun_get_position(context.get(), &params, &position, sizeof position);
    return detail::to_result(context.get(), status, position);
}

/// Sets the sky and the sun of a scene.
inline Result<luxfer_sky_report> set_sky(const Scene &scene, const luxfer_sky_params &params = SkyParams()) {
    luxfer_sky_report report = {};
    const luxfer_status status = luxfer_scene_set_sky(scene.get(), &params, &report, sizeof report);
    return detail::to_result(scene.context().get(), status, report);
}

/// The place and the hours of a weather file.
struct Weather {
    luxfer_weather_report place = {};
    std::vector<luxfer_weather_hour> hours;
};

/// Reads a weather file of EnergyPlus (.epw): count hours from index first on.
inline Result<Weather> read_weather(const Context &context, Text path, std::size_t first, std::size_t count) {
    Weather weather;
    weather.hours.resize(count);
    const luxfer_status status = luxfer_weather_read(context.get(), path.get(), first, count, weather.hours.data(), 0,
                                                     &weather.place, sizeof weather.place);
    return detail::to_result(context.get(), status, std::move(weather));
}

/// A distribution measured from meshes, its errors, and the place of its luminaire.
struct MeasuredDistribution {
    Distribution distribution;
    luxfer_gonio_report report = {};
};

/// Measures the distribution of meshes of a scene, given by their indices; of all meshes if no indices are given.
inline Result<MeasuredDistribution> measure_distribution(const Scene &scene, Span<const std::uint32_t> meshes = {},
                                                         const luxfer_gonio_params &params = GonioParams()) {
    luxfer_distribution *made = nullptr;
    luxfer_gonio_report report = {};
    const luxfer_status status = luxfer_scene_get_distribution(scene.get(), meshes.data(), meshes.size(), &params,
                                                               &made, &report, sizeof report);
    return detail::to_result(scene.context().get(), status,
                             MeasuredDistribution{Distribution(scene.context(), made), report});
}

/// Finds the bodies of the lamps that a mask marks, numbered from the top. If `view` is empty, `params` gives the
/// camera. `suspensions` has x and y of the pixels where suspensions meet the ceiling.
inline Result<std::vector<luxfer_pendant>> find_pendants(const Context &context, const Image &photo, const Image &mask,
                                                         const Rectify &view = {},
                                                         Span<const std::array<double, 2>> suspensions = {},
                                                         const luxfer_pendants_params &params = PendantsParams()) {
    std::vector<luxfer_pendant> lamps(LUXFER_MAX_PENDANTS);
    const double *places = suspensions.empty() ? nullptr : suspensions.data()->data();
    std::size_t count = 0;
    const luxfer_status status = luxfer_pendants_find(
        context.get(), photo.get(), mask.get(), view.get(), places, suspensions.size(), &params, lamps.data(),
        sizeof(luxfer_pendant), lamps.size(), &count);
    lamps.resize(count);
    return detail::to_result(context.get(), status, std::move(lamps));
}

/// The meshes and the material that add_pendants has created.
struct PlacedPendants {
    std::uint32_t first_mesh = 0, material = 0;
};

/// Adds a mesh with the body of a lamp at each place, which is the middle of its upper end. `luminance`, in cd/m², is
/// the luminance of a surface of value 1 in the photo; a `diameter` of 0 is the diameter found.
inline Result<PlacedPendants> add_pendants(const Scene &scene, const luxfer_pendant &pendant,
                                           Span<const std::array<double, 3>> places, float luminance,
                                           float diameter = 0) {
    PlacedPendants placed;
    const double *tops = places.empty() ? nullptr : places.data()->data();
    const luxfer_status status =
        luxfer_scene_add_pendants(scene.get(), &pendant, tops, places.size(), diameter, luminance,
                                  &placed.first_mesh, &placed.material);
    return detail::to_result(scene.context().get(), status, placed);
}

/// The correlated colour temperature in kelvin, and the signed distance Duv from the blackbody locus.
struct ColourTemperature {
    double kelvin, duv;
};

inline Result<ColourTemperature> colour_temperature(const Context &context, const std::array<double, 3> &rgb) {
    ColourTemperature found = {};
    const luxfer_status status =
        luxfer_colour_to_temperature(context.get(), rgb.data(), &found.kelvin, &found.duv);
    return detail::to_result(context.get(), status, found);
}

/// The linear colour, with luminance 1, of a colour temperature.
inline Result<std::array<double, 3>> colour_of_temperature(const Context &context, ColourTemperature temperature) {
    std::array<double, 3> rgb = {};
    const luxfer_status status =
        luxfer_temperature_to_colour(context.get(), temperature.kelvin, temperature.duv, rgb.data());
    return detail::to_result(context.get(), status, rgb);
}

/// The unified glare rating of each observer in a scene, from its luminaires and emissive meshes.
inline Result<std::vector<luxfer_observer_glare>> glare(const Scene &scene, Span<const luxfer_observer> observers,
                                                        std::uint32_t samples = 4096, std::uint64_t seed = 1) {
    std::vector<luxfer_observer_glare> ratings(observers.size());
    const luxfer_status status =
        luxfer_scene_get_glare(scene.get(), observers.data(), observers.size(), 0, samples, seed, ratings.data(), 0);
    return detail::to_result(scene.context().get(), status, std::move(ratings));
}

/// The unified glare rating of a luminance image. Pixels above `threshold` (cd/m²) are glare sources; 0 means five
/// times the mean luminance.
inline Result<luxfer_glare_report> glare(const Image &image, double fov_y, double threshold = 0) {
    return detail::get_value<luxfer_glare_report>(image.context().get(), luxfer_image_get_glare, image.get(), fov_y,
                                                  threshold);
}

/// The unified glare rating and the daylight glare probability of a luminance image, perspective or fisheye.
inline Result<luxfer_glare_report> glare(const Image &image, const luxfer_glare_params &params) {
    return detail::get_value<luxfer_glare_report>(image.context().get(), luxfer_image_rate_glare, image.get(), &params);
}

/// Shows an image in false colours, with a scale bar.
inline Result<Image> false_colour(const Image &image, const luxfer_false_colour_params &params = FalseColourParams()) {
    luxfer_image *shown = nullptr;
    const luxfer_status status = luxfer_image_false_colour(image.get(), &params, &shown);
    return detail::to_result(image.context().get(), status, Image(image.context(), shown));
}

/// A colour mixed from primaries, and their drive levels.
struct Mixture {
    std::vector<double> drives;
    luxfer_mixture light;
};

/// Mixes a linear colour from the primaries (LEDs) of a luminaire, with drive levels of at most `max_drive`.
inline Result<Mixture> mix_primaries(const Context &context, const std::vector<std::array<double, 3>> &primaries,
                                     std::array<double, 3> colour, double max_drive = 1) {
    std::vector<double> flat;
    for (const auto &primary : primaries) flat.insert(flat.end(), primary.begin(), primary.end());
    Mixture mixture = {std::vector<double>(primaries.size()), {}};
    const luxfer_status status =
        luxfer_mix_primaries(context.get(), flat.data(), primaries.size(), max_drive, colour.data(),
                             mixture.drives.data(), &mixture.light, sizeof mixture.light);
    return detail::to_result(context.get(), status, std::move(mixture));
}

/// Finds the blackbody light that brings the mean radiance of a target nearest to a given one.
inline Result<luxfer_temperature_fit> fit_temperature(const Context &context, std::array<double, 3> response,
                                                      std::array<double, 3> background, std::array<double, 3> target) {
    return detail::get_value<luxfer_temperature_fit>(context.get(), luxfer_fit_temperature, context.get(),
                                                     response.data(), background.data(), target.data());
}

inline Result<std::uint32_t> preset_count(const Context &context) {
    std::uint32_t count = 0;
    const luxfer_status status = luxfer_preset_get_count(context.get(), &count);
    return detail::to_result(context.get(), status, count);
}

/// The requirements of EN 12464-1 for a kind of room.
inline Result<luxfer_preset> preset(const Context &context, std::uint32_t index) {
    return detail::get_value<luxfer_preset>(context.get(), luxfer_preset_get, context.get(), index);
}

} // namespace luxfer
