// What the effect tells the host about itself: its abilities, clips and parameters.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#include "effect.hpp"
#include "host.hpp"
#include "inputs.hpp"

#include <limits>

namespace openfx {

namespace {

void set_label(const Properties &of, const char *label) {
    of.set(kOfxPropLabel, label);
    of.set(kOfxPropShortLabel, label);
    of.set(kOfxPropLongLabel, label);
}

void define_clip(OfxImageEffectHandle effect, const char *name, const std::string &label, bool is_optional) {
    OfxPropertySetHandle handle = nullptr;
    suites().effect->clipDefine(effect, name, &handle);
    const Properties clip(handle);
    set_label(clip, label.c_str());
    clip.set(kOfxImageEffectPropSupportedComponents, kOfxImageComponentRGBA, 0);
    clip.set(kOfxImageEffectPropSupportedComponents, kOfxImageComponentRGB, 1);
    clip.set(kOfxImageClipPropOptional, is_optional ? 1 : 0);
    clip.set(kOfxImageEffectPropSupportsTiles, 0);
    clip.set(kOfxImageEffectPropTemporalClipAccess, 0);
}

/// Defines a parameter; `parent` is the name of a group, or nullptr.
Properties define_parameter(OfxParamSetHandle set, const char *type, const char *name, const char *label,
                            const std::string &hint, const char *parent = nullptr) {
    OfxPropertySetHandle handle = nullptr;
    suites().parameter->paramDefine(set, type, name, &handle);
    const Properties defined(handle);
    set_label(defined, label);
    defined.set(kOfxParamPropHint, hint.c_str());
    defined.set(kOfxParamPropScriptName, name);
    if (parent != nullptr)
        defined.set(kOfxParamPropParent, parent);
    return defined;
}

void define_choice(OfxParamSetHandle set, const char *name, const char *label, const std::string &hint,
                   std::initializer_list<const char *> options) {
    const Properties choice = define_parameter(set, kOfxParamTypeChoice, name, label, hint);
    int index = 0;
    for (const char *option : options)
        choice.set(kOfxParamPropChoiceOption, option, index++);
    choice.set(kOfxParamPropDefault, 0);
}

/// Defines a number in [0, max]; the slider goes to slider_max.
void define_number(OfxParamSetHandle set, const char *name, const char *label, const std::string &hint, double value,
                   double max, double slider_max, const char *parent = nullptr) {
    const Properties number = define_parameter(set, kOfxParamTypeDouble, name, label, hint, parent);
    number.set(kOfxParamPropDefault, value);
    number.set(kOfxParamPropMin, 0.0);
    number.set(kOfxParamPropMax, max);
    number.set(kOfxParamPropDisplayMin, 0.0);
    number.set(kOfxParamPropDisplayMax, slider_max);
}

void define_clips(OfxImageEffectHandle effect, bool is_general) {
    // A filter has one input that must be connected; the rendering of a frame reports the others if they are missing.
    define_clip(effect, source_clip, source_clip, false);
    define_clip(effect, exemplar_clip, exemplar_clip, !is_general);
    define_clip(effect, artwork_clip, artwork_clip, !is_general);
    for (const Guide *guide = std::begin(guides) + 1; guide != std::end(guides); guide++) {
        define_clip(effect, guide->target, guide->label, true);
        define_clip(effect, guide->exemplar, std::string("Exemplar ") + guide->label, true);
    }
    define_clip(effect, kOfxImageEffectOutputClipName, kOfxImageEffectOutputClipName, false);
}

void define_parameters(OfxParamSetHandle set) {
    const luxfer::StylizeParams defaults;
    define_choice(set, parameter::quality, "Quality",
                  "Full; Fast: nearly the quality of Full in half the time; Preview: half the resolution, enlarged; "
                  "Paper: the settings of StyLit (Fiser et al. 2016), for comparison.",
                  {"Full", "Fast", "Preview", "Paper"});
    define_choice(set, parameter::final_vote, "Final Vote",
                  "How a pixel of the picture is computed from overlapping patches of the artwork.",
                  {"As in Quality", "Plain", "Weighted", "Nearest", "Majority", "Adaptive"});
    define_number(set, parameter::guide_weight, "Guide Weight",
                  "Weight of all guides together, relative to the weight of the artwork.",
                  double(defaults.guide_weight), max_weight, 10);
    define_number(set, parameter::match_appearance, "Match Light",
                  "Degree to which the light of the exemplar is adapted, in brightness and contrast, to the light of "
                  "the scene to paint.",
                  double(defaults.match_appearance), 1, 1);
    define_parameter(set, kOfxParamTypeBoolean, parameter::mask_by_alpha, "Mask by Alpha",
                     "Only pixels of the artwork whose alpha is above 0.5 are copied: without the margins of the "
                     "paper, for example.")
        .set(kOfxParamPropDefault, 0);
    const Properties seed = define_parameter(set, kOfxParamTypeInteger, parameter::seed, "Seed", "Seed of the search.");
    seed.set(kOfxParamPropDefault, int(defaults.seed));
    seed.set(kOfxParamPropMin, 0);
    seed.set(kOfxParamPropMax, std::numeric_limits<int>::max());
    seed.set(kOfxParamPropDisplayMin, 0);
    seed.set(kOfxParamPropDisplayMax, 100);
    define_choice(set, parameter::encoding, "Encoding",
                  "How colours are encoded in the clips of light, in the artwork and in the output. By Depth: "
                  "floating-point samples are linear, integers are sRGB. Normals, edges and materials are never "
                  "encoded.",
                  {"By Depth", "Linear", "sRGB"});

    constexpr char weights[] = "weights";
    define_parameter(set, kOfxParamTypeGroup, weights, "Weights of Single Guides", "Relative to each other.")
        .set(kOfxParamPropGroupOpen, 0);
    for (const Guide &guide : guides)
        define_number(set, guide.weight, guide.label, std::string("Weight of the guide: ") + guide.hint + ".", 1,
                      max_weight, 10, weights);
}

} // namespace

OfxStatus describe(OfxImageEffectHandle effect) {
    const Properties properties = properties_of(effect);
    set_label(properties, "luxfer Stylise");
    properties.set(kOfxImageEffectPluginPropGrouping, "luxfer");
    properties.set(kOfxPropPluginDescription,
                   "Paints a rendered scene in the style in which an artist has painted another rendered scene, the "
                   "exemplar. Further renderings of both scenes, by light path, guide the paint.");
    properties.set(kOfxImageEffectPropSupportedContexts, kOfxImageEffectContextGeneral, 0);
    properties.set(kOfxImageEffectPropSupportedContexts, kOfxImageEffectContextFilter, 1);
    int index = 0;
    for (const char *depth : {kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort, kOfxBitDepthByte})
        properties.set(kOfxImageEffectPropSupportedPixelDepths, depth, index++);
    // A picture is painted as a whole, from whole images, which may differ in size and depth.
    properties.set(kOfxImageEffectPropSupportsTiles, 0);
    properties.set(kOfxImageEffectPropSupportsMultiResolution, 1);
    properties.set(kOfxImageEffectPropSupportsMultipleClipDepths, 1);
    properties.set(kOfxImageEffectPropSupportsMultipleClipPARs, 0);
    properties.set(kOfxImageEffectPropTemporalClipAccess, 0);
    // The library uses all processors for one frame.
    properties.set(kOfxImageEffectPluginRenderThreadSafety, kOfxImageEffectRenderInstanceSafe);
    properties.set(kOfxImageEffectPluginPropHostFrameThreading, 0);
    properties.set(kOfxImageEffectPluginPropSingleInstance, 0);
    return kOfxStatOK;
}

OfxStatus describe_in_context(OfxImageEffectHandle effect, const Properties &arguments) {
    define_clips(effect, arguments.text(kOfxImageEffectPropContext) == kOfxImageEffectContextGeneral);
    OfxParamSetHandle set = nullptr;
    suites().effect->getParamSet(effect, &set);
    define_parameters(set);
    return kOfxStatOK;
}

} // namespace openfx
