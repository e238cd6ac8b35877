// The stages from a photo to an emissive texture: rectification, features, segmentation, emission.
//
// All stages work alike: create the stage, set its inputs, start a job, read images and a report. For an input that
// may be NULL in C, pass an empty Image (or Rectify).
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "warning.hpp"

namespace luxfer {

using RectifyParams = Params<luxfer_rectify_params, LUXFER_STRUCT_RECTIFY_PARAMS>;
using FeaturesParams = Params<luxfer_features_params, LUXFER_STRUCT_FEATURES_PARAMS>;
using SegmentParams = Params<luxfer_segment_params, LUXFER_STRUCT_SEGMENT_PARAMS>;
using EmissionParams = Params<luxfer_emission_params, LUXFER_STRUCT_EMISSION_PARAMS>;

/// Finds lines, vanishing points and the camera, and unwarps a plane to a frontal view. See luxfer_rectify.
class Rectify : public Handle<luxfer_rectify> {
public:
    using Handle::Handle;

    static Result<Rectify> create(const Context &context) { return make_in<Rectify>(context, luxfer_rectify_create); }

    Result<> set_photo(const Image &photo) const { return call(luxfer_rectify_set_photo, photo.get()); }

    /// Sets the mask of the plane to unwarp; if it is empty, the stage finds only lines and camera.
    Result<> set_mask(const Image &mask) const { return call(luxfer_rectify_set_mask, mask.get()); }

    Result<Job> start(const luxfer_rectify_params &params = RectifyParams()) const {
        return make<Job>(luxfer_rectify_start, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_RECTIFY_ value.
    Result<Image> image(luxfer_rectify_image kind) const { return make<Image>(luxfer_rectify_get_image, kind); }

    /// Undoes the distortion of the lens in an image of the photo's size. See luxfer_rectify_undistort.
    Result<Image> undistort(const Image &image) const { return make<Image>(luxfer_rectify_undistort, image.get()); }

    Result<luxfer_rectify_report> report() const { return value<luxfer_rectify_report>(luxfer_rectify_get_report); }

    /// Reasons to doubt the camera, and the plane if it has been unwarped.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }
};

/// Strokes for images of one size. A stage copies them: after a change, set them again. See luxfer_strokes.
class Strokes : public Handle<luxfer_strokes> {
public:
    using Handle::Handle;

    static Result<Strokes> create(const Context &context, std::uint32_t width, std::uint32_t height) {
        return make_in<Strokes>(context, luxfer_strokes_create, width, height);
    }

    /// Creates the strokes of a drawing, for images of its size.
    static Result<Strokes> from_image(const Image &drawing) {
        luxfer_strokes *made = nullptr;
        std::uint32_t width = 0, height = 0;
        luxfer_status status = luxfer_image_get_size(drawing.get(), &width, &height, nullptr);
        if (status == LUXFER_OK)
            status = luxfer_strokes_create(drawing.context().get(), width, height, &made);
        Strokes strokes(drawing.context(), made);
        if (status == LUXFER_OK)
            status = luxfer_strokes_add_image(made, drawing.get());
        return detail::to_result(drawing.context().get(), status, std::move(strokes));
    }

    /// Adds a stroke along a polyline: points holds x and y of each point, in pixels, and radius is in pixels; phase
    /// is a
    /// LUXFER_PHASE_ value.
    Result<> add(luxfer_phase phase, Span<const float> points, float radius, bool is_positive) const {
        const std::int32_t positive = is_positive;
        return call(luxfer_strokes_add, phase, points.data(), points.size() / 2, radius, positive);
    }

    /// Adds the strokes of a drawing of the same size.
    Result<> add(const Image &drawing) const { return call(luxfer_strokes_add_image, drawing.get()); }

    /// Adds the strokes that a text describes.
    Result<> add(Text description) const { return call(luxfer_strokes_add_text, description.get()); }
};

/// The features of each pixel of a photo, for segmentation. See luxfer_features.
class Features : public Handle<luxfer_features> {
public:
    using Handle::Handle;

    static Result<Features> create(const Context &context) { return make_in<Features>(context, luxfer_features_create); }

    Result<> set_photo(const Image &photo) const { return call(luxfer_features_set_photo, photo.get()); }

    /// Sets the depth map; empty removes it.
    Result<> set_depth(const Image &depth, luxfer_depth_kind kind = LUXFER_DEPTH_ALONG_Z) const {
        return call(luxfer_features_set_depth, depth.get(), kind);
    }

    /// Sets an ONNX file that estimates depth if there is no depth map.
    Result<> set_network(Text path, luxfer_normalisation normalisation = LUXFER_NORMALISATION_BY_SIZE) const {
        return call(luxfer_features_set_network, path.get(), normalisation);
    }
    Result<> clear_network() const { return call(luxfer_features_set_network, nullptr, LUXFER_NORMALISATION_BY_SIZE); }

    /// Takes the current lines and camera of a Rectify; empty means no lines.
    Result<> set_view(const Rectify &rectify) const { return call(luxfer_features_set_view, rectify.get()); }

    /// Sets the strokes on the photo; the fit of the room layout uses the strokes for the plane. Empty removes all
    /// strokes.
    Result<> set_strokes(const Strokes &strokes) const { return call(luxfer_features_set_strokes, strokes.get()); }

    Result<Job> start(const luxfer_features_params &params = FeaturesParams()) const {
        return make<Job>(luxfer_features_start, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_FEATURES_ value.
    Result<Image> image(luxfer_features_image kind) const { return make<Image>(luxfer_features_get_image, kind); }

    Result<luxfer_features_report> report() const { return value<luxfer_features_report>(luxfer_features_get_report); }

    /// Reasons to doubt the features.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }
};

/// Computes a mask from strokes. See luxfer_segment.
class Segment : public Handle<luxfer_segment> {
public:
    using Handle::Handle;

    static Result<Segment> create(const Context &context) { return make_in<Segment>(context, luxfer_segment_create); }

    Result<> set_features(const Image &features) const { return call(luxfer_segment_set_features, features.get()); }

    /// Restricts the segmentation to a mask; empty means the whole image.
    Result<> set_region(const Image &region) const { return call(luxfer_segment_set_region, region.get()); }

    /// Sets the strokes for phase, a LUXFER_PHASE_ value; empty removes all strokes.
    Result<> set_strokes(luxfer_phase phase, const Strokes &strokes) const {
        return call(luxfer_segment_set_strokes, phase, strokes.get());
    }

    Result<Job> start(const luxfer_segment_params &params = SegmentParams()) const {
        return make<Job>(luxfer_segment_start, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_SEGMENT_ value.
    Result<Image> image(luxfer_segment_image kind) const { return make<Image>(luxfer_segment_get_image, kind); }

    Result<luxfer_segment_report> report() const { return value<luxfer_segment_report>(luxfer_segment_get_report); }

    /// Reasons to doubt the mask.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }
};

/// Synthesises an emissive texture of any size from unwarped lights. See luxfer_emission.
class Emission : public Handle<luxfer_emission> {
public:
    using Handle::Handle;

    static Result<Emission> create(const Context &context) { return make_in<Emission>(context, luxfer_emission_create); }

    Result<> set_exemplar(const Image &unwarped, const Image &light, const Image &valid) const {
        return call(luxfer_emission_set_exemplar, unwarped.get(), light.get(), valid.get());
    }

    /// Sets the photo from which full detail is recovered, as luxfer_rectify_undistort makes it, and the map from
    /// unwarped to photo pixels (luxfer_rectify_report.to_photo).
    Result<> set_photo(const Image &photo, Numbers<9> to_photo) const {
        return call(luxfer_emission_set_photo, photo.get(), to_photo.data());
    }
    Result<> clear_photo() const { return call(luxfer_emission_set_photo, nullptr, nullptr); }

    /// Adds an exemplar, with scale unwarped pixels per texel. The image weights, stretched over the texture, has the
    /// probability that a lamp at that place is taken from this exemplar.
    Result<> add_style(const Image &unwarped, const Image &light, const Image &valid, double scale, const Image &weights) const {
        return call(luxfer_emission_add_style, unwarped.get(), light.get(), valid.get(), nullptr, nullptr, scale,
                    weights.get());
    }
    /// Adds an exemplar together with its photo and map, as in set_photo.
    Result<> add_style(const Image &unwarped, const Image &light, const Image &valid, const Image &photo,
                       Numbers<9> to_photo, double scale, const Image &weights) const {
        return call(luxfer_emission_add_style, unwarped.get(), light.get(), valid.get(), photo.get(), to_photo.data(),
                    scale, weights.get());
    }
    Result<> clear_styles() const { return call(luxfer_emission_clear_styles); }

    /// Starts a job that composes a texture; render_tile then renders any part of it.
    Result<Job> start_composition(const luxfer_emission_params &params = EmissionParams()) const {
        return make<Job>(luxfer_emission_start_composition, &params);
    }
    /// Renders a part of the composed texture. The image has four channels: RGB, and a mask that is 1 on lamps.
    Result<Image> render_tile(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height) const {
        return make<Image>(luxfer_emission_render_tile, x, y, width, height);
    }

    Result<Job> start(const luxfer_emission_params &params = EmissionParams()) const {
        return make<Job>(luxfer_emission_start, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_EMISSION_ value.
    Result<Image> image(luxfer_emission_image kind) const { return make<Image>(luxfer_emission_get_image, kind); }

    Result<luxfer_emission_report> report() const { return value<luxfer_emission_report>(luxfer_emission_get_report); }

    /// Reasons to doubt the texture.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }

    Result<luxfer_luminaire> luminaire(std::uint32_t index) const {
        return value<luxfer_luminaire>(luxfer_emission_get_luminaire, index);
    }

    /// A corner of a luminaire's outline, x and y in texels.
    Result<std::array<double, 2>> corner(std::uint32_t luminaire, std::uint32_t corner) const {
        std::array<double, 2> point = {};
        const luxfer_status status = luxfer_emission_get_corner(get(), luminaire, corner, &point[0], &point[1]);
        return detail::to_result(context().get(), status, point);
    }
};

} // namespace luxfer
