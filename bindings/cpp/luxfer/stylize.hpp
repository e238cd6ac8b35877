// Stylisation by example: guides, the synthesis, and sheets for artists who paint on paper.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "scene.hpp"

namespace luxfer {

using GuidesParams = Params<luxfer_guides_params, LUXFER_STRUCT_GUIDES_PARAMS>;
using SheetParams = Params<luxfer_sheet_params, LUXFER_STRUCT_SHEET_PARAMS>;

/// The settings of a stylisation; a LUXFER_STYLIZE_ preset sets them all.
struct StylizeParams : Params<luxfer_stylize_params, LUXFER_STRUCT_STYLIZE_PARAMS> {
    StylizeParams() noexcept = default;

    /// Fills the settings by a preset. If the value is no preset, every call with these settings fails.
    explicit StylizeParams(luxfer_stylize_preset preset) noexcept {
        if (luxfer_stylize_get_preset(preset, this, sizeof(luxfer_stylize_params)) != LUXFER_OK)
            struct_size = 0;
    }
};

/// Renders the guide images of a scene for a stylisation. See luxfer_guides.
class Guides : public Handle<luxfer_guides> {
public:
    using Handle::Handle;

    static Result<Guides> create(const Context &context) { return make_in<Guides>(context, luxfer_guides_create); }

    Result<> set_scene(const Scene &scene) const { return call(luxfer_guides_set_scene, scene.get()); }

    Result<Job> start(const luxfer_guides_params &params = GuidesParams()) const {
        return make<Job>(luxfer_guides_start, &params);
    }

    /// Gets an image of the results; `kind` is a LUXFER_GUIDES_ value.
    Result<Image> image(luxfer_guides_image kind) const { return make<Image>(luxfer_guides_get_image, kind); }

    /// Computes the motion of each pixel since the previous frame, whose guides are `before`: of camera, objects and
    /// deforming meshes.
    Result<Image> motion(const Guides &before) const { return make<Image>(luxfer_guides_get_motion, before.get()); }

    /// Gets the warnings about the latest motion.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }

    /// Draws an artwork of the scene in place of an artist; `style` is a LUXFER_ARTWORK_ value.
    Result<Image> demo_artwork(luxfer_artwork style) const { return make<Image>(luxfer_demo_create_artwork, style); }
};

/// Paints a target scene in the style in which an artist has painted an exemplar scene. See luxfer_stylize.
class Stylize : public Handle<luxfer_stylize> {
public:
    using Handle::Handle;

    /// Creates a stylisation. LUXFER_UNSUPPORTED if this build of the library has no stylisation.
    static Result<Stylize> create(const Context &context) { return make_in<Stylize>(context, luxfer_stylize_create); }

    // Inputs.

    Result<> set_artwork(const Image &artwork) const { return call(luxfer_stylize_set_artwork, artwork.get()); }

    /// Adds a guide: an image of the exemplar (source) and one of the target; an empty target means source.
    Result<> add_guide(Text name, const Image &source, const Image &target, float weight = 1.0f,
                       luxfer_guide_range range = LUXFER_GUIDE_LIGHT) const {
        return call(luxfer_stylize_add_guide, name.get(), source.get(), target.get(), weight, range);
    }

    /// Adds the guides of two scenes; extras are LUXFER_GUIDES_WITH_ flags. Without the flag of the normals, the
    /// artwork decides whether they are used.
    Result<> add_guides(const Guides &source, const Guides &target, std::uint32_t extras = 0,
                        float extra_weight = 1.0f) const {
        return call(luxfer_stylize_add_guides, source.get(), target.get(), extras, extra_weight);
    }
    Result<> clear_guides() const { return call(luxfer_stylize_clear_guides); }

    /// Sets the mask of the artwork's pixels that may be copied; empty means all.
    Result<> set_source_mask(const Image &mask) const { return call(luxfer_stylize_set_source_mask, mask.get()); }

    /// Sets the mask of the target's pixels to paint, and the known picture elsewhere; both may be empty.
    Result<> set_target_mask(const Image &mask, const Image &known = Image()) const {
        return call(luxfer_stylize_set_target_mask, mask.get(), known.get());
    }

    /// Sets the motion since the previous frame of an animation; if it is empty, each job starts from nothing.
    Result<> set_motion(const Image &motion) const { return call(luxfer_stylize_set_motion, motion.get()); }

    /// Lets the library paint the rest of a half-painted picture.
    Result<> set_painted(const Image &painted) const { return call(luxfer_stylize_set_painted, painted.get()); }

    Result<Job> start(const luxfer_stylize_params &params = StylizeParams()) const {
        return make<Job>(luxfer_stylize_start, &params);
    }

    /// Gets the warnings about the motion of the latest result.
    Result<Warnings> warnings() const { return make<Warnings>(luxfer_get_warnings); }

    /// Starts a job that updates the picture after a change of the artwork.
    Result<Job> update(const Image &artwork, const Image &changed) const {
        return make<Job>(luxfer_stylize_update, artwork.get(), changed.get());
    }

    // Results.

    /// Gets an image of the results; `kind` is a LUXFER_STYLIZE_IMAGE_ value.
    Result<Image> image(luxfer_stylize_image kind = LUXFER_STYLIZE_IMAGE_PICTURE) const {
        return make<Image>(luxfer_stylize_get_image, kind);
    }

    Result<luxfer_stylize_report> report() const { return value<luxfer_stylize_report>(luxfer_stylize_get_report); }
};

/// A sheet that an artist prints and paints over, with marks by which a photo of it is aligned. See
/// luxfer_sheet_params.
class Sheet {
public:
    /// Draws the sheet to print.
    static Result<Image> print(const Image &picture, const luxfer_sheet_params &params = SheetParams()) {
        luxfer_image *sheet = nullptr;
        const luxfer_status status = luxfer_sheet_print(picture.get(), &params, &sheet);
        return detail::to_result(picture.context().get(), status, Image(picture.context(), sheet));
    }

    /// The artwork from a photo of the painted sheet, and the quality of the alignment.
    struct Aligned {
        Image artwork;
        luxfer_sheet_report report;
    };

    /// Aligns a photo; the printed picture had width x height pixels.
    static Result<Aligned> align(const Image &photo, std::uint32_t width, std::uint32_t height,
                                 const luxfer_sheet_params &params = SheetParams()) {
        luxfer_image *artwork = nullptr;
        luxfer_sheet_report report = {};
        const luxfer_status status =
            luxfer_sheet_align(photo.get(), width, height, &params, &artwork, &report, sizeof report);
        return detail::to_result(photo.context().get(), status, Aligned{Image(photo.context(), artwork), report});
    }
};

} // namespace luxfer
