// Computes the light in a scene: pictures with layers, illuminance, and relighting.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "scene.hpp"
#include "warning.hpp"

namespace luxfer {

using RenderParams = Params<luxfer_render_params, LUXFER_STRUCT_RENDER_PARAMS>;
using RenderPart = Params<luxfer_render_part, LUXFER_STRUCT_RENDER_PART>;
using IlluminanceParams = Params<luxfer_illuminance_params, LUXFER_STRUCT_ILLUMINANCE_PARAMS>;
using IlluminanceGrid = Params<luxfer_illuminance_grid, LUXFER_STRUCT_ILLUMINANCE_GRID>;
using RelightParams = Params<luxfer_relight_params, LUXFER_STRUCT_RELIGHT_PARAMS>;

/// A path tracer; its current image can be read while its job runs. See luxfer_render.
class Render : public Handle<luxfer_render> {
public:
    using Handle::Handle;

    static Result<Render> create(const Context &context) { return make_in<Render>(context, luxfer_render_create); }

    Result<> set_scene(const Scene &scene) const { return call(luxfer_render_set_scene, scene.get()); }

    /// Sets the camera; the default is the first camera of the scene.
    Result<> set_camera(const luxfer_camera_params &camera) const { return call(luxfer_render_set_camera, &camera); }
    Result<> clear_camera() const { return call(luxfer_render_set_camera, nullptr); }

    // Additional layers from the paths of the picture.

    /// Adds a layer of the light that a light path expression selects, such as "C<RD>L".
    Result<> add_expression(Text name, Text expression) const {
        return call(luxfer_render_add_expression, name.get(), expression.get());
    }
    Result<> clear_expressions() const { return call(luxfer_render_clear_expressions); }

    /// Sets the letters that match emissive surfaces and the environment in expressions: a LUXFER_EMITTER_AS_ value.
    Result<> set_emitter_as(luxfer_emitter_as emitter_as) const { return call(luxfer_render_set_emitter_as, emitter_as); }

    /// Sets the layers of surface properties: LUXFER_AOV_ flags.
    Result<> set_aovs(std::uint32_t flags) const { return call(luxfer_render_set_aovs, flags); }

    Result<Job> start(const luxfer_render_params &params = RenderParams()) const {
        return make<Job>(luxfer_render_start, &params);
    }

    // Rendering in parts, on many machines.

    /// Gets part number index, if the image is divided into columns x rows rectangles and the paths into ranges.
    Result<luxfer_render_part> split(std::uint32_t columns, std::uint32_t rows, std::uint32_t ranges, std::uint32_t index,
                                     const luxfer_render_params &params = RenderParams()) const {
        return value<luxfer_render_part>(luxfer_render_split, &params, columns, rows, ranges, index);
    }

    /// Starts a job that renders a part into a file.
    Result<Job> start_part(Text path, const luxfer_render_part &part = RenderPart(),
                           const luxfer_render_params &params = RenderParams()) const {
        return make<Job>(luxfer_render_start_part, &params, &part, path.get());
    }

    /// Adds the file of a part that start_merge will merge.
    Result<> add_part(Text path) const { return call(luxfer_render_add_part, path.get()); }
    Result<> clear_parts() const { return call(luxfer_render_clear_parts); }

    Result<Job> start_merge(const luxfer_render_params &params = RenderParams()) const {
        return make<Job>(luxfer_render_start_merge, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_RENDER_ value.
    Result<Image> image(luxfer_render_image kind = LUXFER_RENDER_BEAUTY) const {
        return make<Image>(luxfer_render_get_image, kind);
    }

    Result<luxfer_render_report> report() const { return value<luxfer_render_report>(luxfer_render_get_report); }

    /// Describes the parts of the scene that the rendering skips, one sentence per line, with the number of lamps that
    /// cannot be reached.
    Result<std::string> requirements_text() const { return text(luxfer_render_get_requirements_text); }

    Result<std::uint32_t> layer_count() const { return value<std::uint32_t>(luxfer_render_get_layer_count); }
    Result<std::string> layer_name(std::uint32_t index) const { return text(luxfer_render_get_layer_name, index); }
    Result<Image> layer(Text name) const { return make<Image>(luxfer_render_get_layer, name.get()); }

    /// Writes the picture and all layers into one file.
    Result<> write_exr(Text path) const { return call(luxfer_render_write_exr, path.get()); }
};

/// Illuminance in lux, on a grid or a mesh. See luxfer_illuminance.
class Illuminance : public Handle<luxfer_illuminance> {
public:
    using Handle::Handle;

    static Result<Illuminance> create(const Context &context) {
        return make_in<Illuminance>(context, luxfer_illuminance_create);
    }

    Result<> set_scene(const Scene &scene) const { return call(luxfer_illuminance_set_scene, scene.get()); }

    Result<Job> start_grid(const luxfer_illuminance_grid &grid,
                           const luxfer_illuminance_params &params = IlluminanceParams()) const {
        return make<Job>(luxfer_illuminance_start_grid, &grid, &params);
    }

    /// Starts a job for a mesh: for its front side, which the winding of the triangles defines, or for its back side.
    Result<Job> start_mesh(std::uint32_t mesh, bool back = false,
                           const luxfer_illuminance_params &params = IlluminanceParams()) const {
        const std::uint32_t side = back;
        return make<Job>(luxfer_illuminance_start_mesh, mesh, side, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_ILLUMINANCE_ value.
    Result<Image> image(luxfer_illuminance_image kind = LUXFER_ILLUMINANCE_LUX) const {
        return make<Image>(luxfer_illuminance_get_image, kind);
    }

    Result<luxfer_illuminance_report> report() const {
        return value<luxfer_illuminance_report>(luxfer_illuminance_get_report);
    }
};

/// Solves for the colour and intensity of an emission. See luxfer_relight.
class Relight : public Handle<luxfer_relight> {
public:
    using Handle::Handle;

    static Result<Relight> create(const Context &context) { return make_in<Relight>(context, luxfer_relight_create); }

    /// Sets the scene, and the emission to solve for, from Scene::place_emission; its mesh is the surface to match.
    Result<> set_scene(const Scene &scene, PlacedEmission emission) const {
        return call(luxfer_relight_set_scene, scene.get(), emission.material, emission.mesh);
    }

    /// Sets the mean radiance that the surface should have, in cd/m².
    Result<> set_target(Rgb target) const { return call(luxfer_relight_set_target, target.data()); }

    /// Makes the target a limit, by a LUXFER_CONSTRAINT_ value for each channel.
    Result<> set_constraint(const std::array<luxfer_constraint, 3> &constraint) const {
        return call(luxfer_relight_set_constraint, constraint.data());
    }

    Result<Job> start(const luxfer_relight_params &params = RelightParams()) const {
        return make<Job>(luxfer_relight_start, &params);
    }

    Result<luxfer_relight_report> report() const { return value<luxfer_relight_report>(luxfer_relight_get_report); }

    /// Reasons to doubt the solution.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }
};

} // namespace luxfer
