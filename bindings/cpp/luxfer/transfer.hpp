// The lighting transfer from end to end, and the demonstration photo to try it with.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "photo.hpp"
#include "render.hpp"

#include <vector>

namespace luxfer {

/// The settings of a transfer. It points to the settings of the stages, which must live until start() returns.
using TransferParams = Params<luxfer_transfer_params, LUXFER_STRUCT_TRANSFER_PARAMS>;
using PatternParams = Params<luxfer_pattern_params, LUXFER_STRUCT_PATTERN_PARAMS>;
using DemoPhotoParams = Params<luxfer_demo_photo_params, LUXFER_STRUCT_DEMO_PHOTO_PARAMS>;

/// Lights a scene as in a photo, from the photo and a few strokes. See luxfer_transfer.
class Transfer : public Handle<luxfer_transfer> {
public:
    using Handle::Handle;

    static Result<Transfer> create(const Context &context) { return make_in<Transfer>(context, luxfer_transfer_create); }

    // Inputs.

    Result<> set_photo(const Image &photo) const { return call(luxfer_transfer_set_photo, photo.get()); }

    /// Sets the depth map; empty removes it.
    Result<> set_depth(const Image &depth, luxfer_depth_kind kind = LUXFER_DEPTH_ALONG_Z) const {
        return call(luxfer_transfer_set_depth, depth.get(), kind);
    }

    /// Sets the scene to light, and the object or material that receives the lights.
    Result<> set_scene(const Scene &scene, Text surface) const {
        return call(luxfer_transfer_set_scene, scene.get(), surface.get());
    }

    /// Sets an emissive texture that replaces the one made from the photo; empty means to make it from the photo.
    Result<> set_texture(const Image &texture) const { return call(luxfer_transfer_set_texture, texture.get()); }

    /// Sets the camera of the picture; the default is the first camera of the scene, or one in a corner of the room.
    Result<> set_camera(const luxfer_camera_params &camera) const { return call(luxfer_transfer_set_camera, &camera); }
    Result<> clear_camera() const { return call(luxfer_transfer_set_camera, nullptr); }

    /// Sets the strokes on the photo; empty removes all strokes.
    Result<> set_strokes(const Strokes &strokes) const { return call(luxfer_transfer_set_strokes, strokes.get()); }

    /// Sets rectangles of the surface that stay without lamps: u0, v0, u1 and v1 of each, in metres. They replace
    /// the rectangles of earlier calls.
    Result<> set_zones(Span<const double> zones) const {
        return call(luxfer_transfer_set_zones, zones.data(), zones.size() / 4);
    }

    /// Sets the triangles that receive the lights, mesh and triangle index of each, instead of the named surface;
    /// empty: use the name again.
    Result<> set_triangles(Span<const std::uint32_t> triangles) const {
        return call(luxfer_transfer_set_triangles, triangles.data(), triangles.size() / 2);
    }

    // Results of the caller that replace results of the transfer's own stages.

    Result<> use(const Rectify &rectify) const { return call(luxfer_transfer_use_rectify, rectify.get()); }
    Result<> use(const Features &features) const { return call(luxfer_transfer_use_features, features.get()); }
    Result<> use(luxfer_phase phase, const Segment &segment) const {
        return call(luxfer_transfer_use_segment, phase, segment.get());
    }
    Result<> use(luxfer_phase phase, const Image &mask) const { return call(luxfer_transfer_use_mask, phase, mask.get()); }

    /// Runs the stages first to last, LUXFER_STAGE_ values.
    Result<Job> start(luxfer_stage first, luxfer_stage last, const luxfer_transfer_params &params = TransferParams()) const {
        return make<Job>(luxfer_transfer_start, first, last, &params);
    }

    /// Runs all stages.
    Result<Job> start(const luxfer_transfer_params &params = TransferParams()) const {
        return start(LUXFER_STAGE_VIEW, LUXFER_STAGE_RENDER, params);
    }

    /// Runs the stages first to last of several transfers, one for each plane with lights in one photo, and solves for
    /// their light together; see luxfer_transfer_start_all. `params` holds the settings of each transfer, or is empty
    /// for the defaults.
    static Result<Job> start_all(const Context &context, Span<const Transfer> transfers,
                                 luxfer_stage first = LUXFER_STAGE_VIEW, luxfer_stage last = LUXFER_STAGE_RENDER,
                                 Span<const TransferParams> params = {}) {
        std::vector<luxfer_transfer *> handles;
        for (const Transfer &transfer : transfers)
            handles.push_back(transfer.get());
        std::vector<const luxfer_transfer_params *> settings;
        for (const TransferParams &of_transfer : params)
            settings.push_back(&of_transfer);
        settings.resize(settings.empty() ? 0 : handles.size(), nullptr);
        luxfer_job *job = nullptr;
        const luxfer_status status =
            luxfer_transfer_start_all(context.get(), handles.data(), handles.size(), first, last,
                                      settings.empty() ? nullptr : settings.data(), &job);
        return detail::to_result(context.get(), status, Job(context, job));
    }

    // Results, available as soon as their stage has ended.

    /// Gets an image of the results; `kind` is a LUXFER_TRANSFER_ value.
    Result<Image> image(luxfer_transfer_image kind) const { return make<Image>(luxfer_transfer_get_image, kind); }

    /// Gets a scene of the results; `kind` is a LUXFER_SCENE_ value.
    Result<Scene> scene(luxfer_transfer_scene kind = LUXFER_SCENE_LIT) const {
        return make<Scene>(luxfer_transfer_get_scene, kind);
    }

    Result<luxfer_transfer_report> report() const { return value<luxfer_transfer_report>(luxfer_transfer_get_report); }
    Result<luxfer_rectify_report> view() const { return value<luxfer_rectify_report>(luxfer_transfer_get_view); }
    Result<luxfer_relight_report> solution() const {
        return value<luxfer_relight_report>(luxfer_transfer_get_solution);
    }
    Result<luxfer_fixture> fixture(std::uint32_t index) const {
        return value<luxfer_fixture>(luxfer_transfer_get_fixture, index);
    }

    /// Reasons to doubt the results so far, in the order of the stages.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }

    /// Writes all fixtures to a .csv or .json file.
    Result<> save_fixtures(Text path) const { return call(luxfer_transfer_save_fixtures, path.get()); }
};

/// A photo of a generated office, and strokes as a user would paint them. See luxfer_demo_photo.
class DemoPhoto : public Handle<luxfer_demo_photo> {
public:
    using Handle::Handle;

    static Result<DemoPhoto> create(const Context &context) {
        return make_in<DemoPhoto>(context, luxfer_demo_photo_create);
    }

    Result<Job> start(const luxfer_demo_photo_params &params = DemoPhotoParams()) const {
        return make<Job>(luxfer_demo_photo_start, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_DEMO_PHOTO_ value.
    Result<Image> image(luxfer_demo_photo_image kind) const { return make<Image>(luxfer_demo_photo_get_image, kind); }
};

} // namespace luxfer
