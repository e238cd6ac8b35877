// The clips and parameters of the effect, as tables that the description and the rendering share.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include <luxfer/stylize.hpp>

namespace openfx {

/// The rendering of the target, under the name that OpenFX demands for the main input; the rendering of the exemplar;
/// and the exemplar as painted by the artist.
constexpr char source_clip[] = "Source", exemplar_clip[] = "Exemplar", artwork_clip[] = "Artwork";

/// A pair of clips that shows one kind of light, or one property of surfaces, of the target and of the exemplar.
struct Guide {
    const char *name;     // in the library
    const char *target;   // the clip that shows the target
    const char *exemplar; // the clip that shows the exemplar
    const char *label;    // of the clip of the target
    const char *weight;   // the parameter of its weight
    const char *hint;
    luxfer_guide_range range;
};

/// The guides of luxfer_guides. The first pair is mandatory, the others are optional.
constexpr Guide guides[] = {
    {"full", source_clip, exemplar_clip, "Source", "weightFull", "all light", LUXFER_GUIDE_LIGHT},
    {"direct", "Direct", "ExemplarDirect", "Direct", "weightDirect",
     "light reflected once, by a diffuse surface (LDE)", LUXFER_GUIDE_LIGHT},
    {"specular", "Specular", "ExemplarSpecular", "Specular", "weightSpecular",
     "light reflected or transmitted once, at a glossy surface, mirror or pane (LSE)", LUXFER_GUIDE_LIGHT},
    {"indirect", "Indirect", "ExemplarIndirect", "Indirect", "weightIndirect",
     "light whose last two reflections were diffuse (L.*DDE): colour bleeding", LUXFER_GUIDE_LIGHT},
    {"two bounces", "TwoBounces", "ExemplarTwoBounces", "Two Bounces", "weightTwoBounces",
     "light reflected once or twice, by diffuse surfaces (LD{1,2}E)", LUXFER_GUIDE_LIGHT},
    {"caustics", "Caustics", "ExemplarCaustics", "Caustics", "weightCaustics",
     "light that glossy objects cast onto others (LS+DE)", LUXFER_GUIDE_LIGHT},
    {"normals", "Normals", "ExemplarNormals", "Normals", "weightNormals",
     "normals in camera space, for strokes that follow the shapes", LUXFER_GUIDE_DATA},
    {"edges", "Edges", "ExemplarEdges", "Edges", "weightEdges",
     "edges of shapes, for shapes finer than the strokes", LUXFER_GUIDE_DATA},
    {"materials", "Materials", "ExemplarMaterials", "Materials", "weightMaterials",
     "a colour for each material, so that objects are painted from objects of their material", LUXFER_GUIDE_DATA},
};

/// The maximum of all weights, as luxfer_stylize_add_guide and luxfer_stylize_params state it.
constexpr double max_weight = 1e6; // [convention]

/// Names of the parameters; guides[].weight are names too.
namespace parameter {
constexpr char quality[] = "quality", final_vote[] = "finalVote", guide_weight[] = "guideWeight",
               match_appearance[] = "matchAppearance", mask_by_alpha[] = "maskByAlpha", seed[] = "seed",
               encoding[] = "encoding";
} // namespace parameter

/// The encoding of colours in clips: the value of the parameter `encoding`.
enum class Encoding {
    by_depth, // linear for floating-point samples, sRGB for integers
    linear,
    srgb,
};

} // namespace openfx
