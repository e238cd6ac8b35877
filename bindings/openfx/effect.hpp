// The actions of the effect. Each may throw; plugin.cpp turns exceptions into messages and statuses.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "host.hpp"

namespace openfx {

/// States what the effect is and can do.
OfxStatus describe(OfxImageEffectHandle effect);

/// Defines the clips and parameters in a context.
OfxStatus describe_in_context(OfxImageEffectHandle effect, const Properties &arguments);

/// States that the picture is not multiplied by its alpha, which is passed through.
OfxStatus get_clip_preferences(const Properties &results);

/// The picture is as large as the source.
OfxStatus get_region_of_definition(OfxImageEffectHandle effect, const Properties &arguments, const Properties &results);

/// Each part of the picture depends on the whole of every input.
OfxStatus get_regions_of_interest(OfxImageEffectHandle effect, const Properties &arguments, const Properties &results);

/// Paints a frame.
OfxStatus render(OfxImageEffectHandle effect, const Properties &arguments);

} // namespace openfx
