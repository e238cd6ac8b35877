// The rendering of a frame, and the regions that it needs. A rendering has a context of the library of its own, so that
// nothing stays behind it: neither threads nor memory.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#include "effect.hpp"
#include "frame.hpp"
#include "inputs.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace openfx {

namespace {

OfxParamHandle parameter_of(OfxImageEffectHandle effect, const char *name) {
    OfxParamSetHandle set = nullptr;
    OfxParamHandle handle = nullptr;
    suites().effect->getParamSet(effect, &set);
    if (suites().parameter->paramGetHandle(set, name, &handle, nullptr) != kOfxStatOK)
        throw std::runtime_error(std::string("the host does not have the parameter ") + name);
    return handle;
}

/// The value of a parameter: an int of integers, choices and booleans, a double of numbers.
template <class T>
T value_of(OfxImageEffectHandle effect, const char *name, double time) {
    T value = T();
    if (suites().parameter->paramGetValueAtTime(parameter_of(effect, name), time, &value) != kOfxStatOK)
        throw std::runtime_error(std::string("the host does not give the value of the parameter ") + name);
    return value;
}

luxfer::StylizeParams settings_of(OfxImageEffectHandle effect, double time) {
    luxfer::StylizeParams settings(value_of<int>(effect, parameter::quality, time));
    if (const int vote = value_of<int>(effect, parameter::final_vote, time); vote > 0)
        settings.final_vote = vote - 1;
    settings.guide_weight = float(value_of<double>(effect, parameter::guide_weight, time));
    settings.match_appearance = float(value_of<double>(effect, parameter::match_appearance, time));
    settings.seed = std::uint64_t(std::max(0, value_of<int>(effect, parameter::seed, time)));
    return settings;
}

/// Fetches a frame of a clip that must be connected.
Frame fetch(OfxImageEffectHandle effect, const char *clip, double time, const char *advice) {
    std::optional<Frame> frame = Frame::fetch(effect, clip, time);
    if (!frame)
        throw std::runtime_error(std::string(clip) + " is not connected: connect " + advice);
    return std::move(*frame);
}

/// Checks that two frames have equal sizes and positions.
void check_areas(const Frame &frame, const Frame &first) {
    const OfxRectI &a = frame.area(), &b = first.area();
    if (a.x1 != b.x1 || a.y1 != b.y1 || a.x2 != b.x2 || a.y2 != b.y2)
        throw std::runtime_error(std::string(frame.clip()) + " has " + in_words(a) + ", but " + first.clip() + " has " +
                                 in_words(b) + ": they must be equal");
}

/// Adds a guide if its clips are connected.
void add_guide(const luxfer::Stylize &stylize, OfxImageEffectHandle effect, double time, Encoding encoding,
               const Guide &guide, const Frame &source, const Frame &first_exemplar) {
    const std::optional<Frame> target = Frame::fetch(effect, guide.target, time);
    const std::optional<Frame> exemplar = Frame::fetch(effect, guide.exemplar, time);
    if (!target && !exemplar)
        return;
    if (!target || !exemplar)
        throw std::runtime_error(std::string(target ? guide.target : guide.exemplar) + " is connected, but " +
                                 (target ? guide.exemplar : guide.target) + " is not: connect both or neither");
    check_areas(*target, source);
    check_areas(*exemplar, first_exemplar);
    const Encoding stored = guide.range == LUXFER_GUIDE_LIGHT ? encoding : Encoding::linear;
    const luxfer::Context &context = stylize.context();
    stylize.add_guide(guide.name, exemplar->colour(context, stored), target->colour(context, stored),
                      float(value_of<double>(effect, guide.weight, time)), guide.range);
}

/// What the output takes over from the source.
struct Canvas {
    OfxRectI area;
    luxfer::Image alpha;
};

/// Gives the library the pictures of all clips. The host may free them afterwards, while the library paints.
Canvas set_inputs(const luxfer::Stylize &stylize, OfxImageEffectHandle effect, double time, Encoding encoding) {
    const Frame source = fetch(effect, source_clip, time, "the rendering of the scene to paint");
    const Frame exemplar = fetch(effect, exemplar_clip, time, "the rendering that the artist has painted over");
    const Frame artwork = fetch(effect, artwork_clip, time, "the exemplar as painted by the artist");
    check_areas(artwork, exemplar);
    stylize.set_artwork(artwork.colour(stylize.context(), encoding));
    if (value_of<int>(effect, parameter::mask_by_alpha, time) != 0)
        stylize.set_source_mask(artwork.alpha(stylize.context()));
    for (const Guide &guide : guides)
        add_guide(stylize, effect, time, encoding, guide, source, exemplar);
    return {source.area(), source.alpha(stylize.context())};
}

/// The picture in the size of the target: that of the quality Preview is half as large.
luxfer::Image enlarge(const luxfer::Image &picture, const OfxRectI &area) {
    const luxfer::ImageSize size = picture.size();
    const auto width = std::uint32_t(area.x2 - area.x1), height = std::uint32_t(area.y2 - area.y1);
    if (size.width == width && size.height == height)
        return picture;
    const double x = double(size.width) / width, y = double(size.height) / height;
    return picture.warp(std::array<double, 9>{x, 0, 0, 0, y, 0, 0, 0, 1}, width, height);
}

/// Shows the library's warnings at the effect, or removes the message of an earlier frame.
void show_warnings(OfxImageEffectHandle effect, const luxfer::Warnings &warnings) {
    std::string text;
    for (std::uint32_t i = 0; i < warnings.count(); i++) {
        const luxfer_warning warning = warnings.warning(i);
        text += std::string(text.empty() ? "" : "\n") + warning.message + " " + warning.advice;
    }
    if (text.empty())
        clear_message(effect);
    else
        show_message(effect, kOfxMessageWarning, text);
}

/// Paints a frame. Throws luxfer::Error with LUXFER_CANCELLED if the host or the user ends the work.
void paint(OfxImageEffectHandle effect, const Properties &arguments) {
    const double time = arguments.number(kOfxPropTime);
    const auto encoding = Encoding(value_of<int>(effect, parameter::encoding, time));
    const auto context = luxfer::Context::create();
    const auto stylize = luxfer::Stylize::create(context);
    const Canvas canvas = set_inputs(stylize, effect, time, encoding);
    {
        const ProgressBar bar(effect, "luxfer Stylise");
        const auto job = stylize.start(settings_of(effect, time));
        job.wait([&](double fraction) { return suites().effect->abort(effect) == 0 && bar.show(fraction); });
    }
    const Frame output = fetch(effect, kOfxImageEffectOutputClipName, time, "another effect");
    output.write(enlarge(stylize.image(), canvas.area), canvas.alpha, encoding, canvas.area,
                 arguments.rectangle(kOfxImageEffectPropRenderWindow));
    show_warnings(effect, stylize.warnings());
}

/// Gets the region of definition of a clip; false if the clip is not connected.
bool get_region(OfxImageEffectHandle effect, const char *name, double time, OfxRectD &region) {
    OfxImageClipHandle clip = nullptr;
    OfxPropertySetHandle properties = nullptr;
    return suites().effect->clipGetHandle(effect, name, &clip, &properties) == kOfxStatOK &&
           Properties(properties).integer(kOfxImageClipPropConnected) != 0 &&
           suites().effect->clipGetRegionOfDefinition(clip, time, &region) == kOfxStatOK;
}

} // namespace

OfxStatus get_clip_preferences(const Properties &results) {
    results.set(kOfxImageEffectPropPreMultiplication, kOfxImageUnPreMultiplied);
    return kOfxStatOK;
}

OfxStatus get_region_of_definition(OfxImageEffectHandle effect, const Properties &arguments,
                                   const Properties &results) {
    OfxRectD region = {};
    if (!get_region(effect, source_clip, arguments.number(kOfxPropTime), region))
        return kOfxStatReplyDefault;
    results.set(kOfxImageEffectPropRegionOfDefinition, region);
    return kOfxStatOK;
}

OfxStatus get_regions_of_interest(OfxImageEffectHandle effect, const Properties &arguments, const Properties &results) {
    const auto demand_all = [&](const char *clip) {
        OfxRectD region = {};
        if (get_region(effect, clip, arguments.number(kOfxPropTime), region))
            results.set((std::string("OfxImageClipPropRoI_") + clip).c_str(), region);
    };
    demand_all(artwork_clip);
    for (const Guide &guide : guides) {
        demand_all(guide.target);
        demand_all(guide.exemplar);
    }
    return kOfxStatOK;
}

OfxStatus render(OfxImageEffectHandle effect, const Properties &arguments) {
    try {
        paint(effect, arguments);
        return kOfxStatOK;
    } catch (const std::exception &error) {
        // A host that aborts may give no pictures either. It expects success, and drops the frame.
        if (suites().effect->abort(effect) != 0)
            return kOfxStatOK;
        const auto *failure = dynamic_cast<const luxfer::Error *>(&error);
        if (failure != nullptr && failure->status() == LUXFER_CANCELLED) // at the progress bar: not worth a message
            return kOfxStatFailed;
        throw;
    }
}

} // namespace openfx
