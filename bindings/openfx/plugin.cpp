// The entry points of the plug-in: what a host finds in the binary. No exception leaves them.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#include "effect.hpp"

#include <luxfer/stylize.hpp>

#include <new>

namespace openfx {

namespace {

/// Fetches the suites. Fails, so that the host does not offer the effect, if the library does not fit or is built
/// without stylisation.
OfxStatus load() {
    luxfer_stylize_params params;
    if (!luxfer::is_compatible(luxfer_get_version(), LUXFER_VERSION) ||
        luxfer_stylize_params_init(&params, sizeof params) != LUXFER_OK)
        return kOfxStatFailed;
    return suites().fetch() ? kOfxStatOK : kOfxStatErrMissingHostFeature;
}

OfxStatus run(const std::string &action, OfxImageEffectHandle effect, const Properties &arguments,
              const Properties &results) {
    if (action == kOfxActionLoad)
        return load();
    if (action == kOfxActionDescribe)
        return describe(effect);
    if (action == kOfxImageEffectActionDescribeInContext)
        return describe_in_context(effect, arguments);
    if (action == kOfxImageEffectActionGetClipPreferences)
        return get_clip_preferences(results);
    if (action == kOfxImageEffectActionGetRegionOfDefinition)
        return get_region_of_definition(effect, arguments, results);
    if (action == kOfxImageEffectActionGetRegionsOfInterest)
        return get_regions_of_interest(effect, arguments, results);
    if (action == kOfxImageEffectActionRender)
        return render(effect, arguments);
    return kOfxStatReplyDefault; // instances have no data of their own
}

OfxStatus main_entry(const char *action, const void *handle, OfxPropertySetHandle arguments,
                     OfxPropertySetHandle results) noexcept {
    const auto effect = static_cast<OfxImageEffectHandle>(const_cast<void *>(handle));
    try {
        try {
            return run(action, effect, Properties(arguments), Properties(results));
        } catch (const std::bad_alloc &) {
            return kOfxStatErrMemory;
        } catch (const std::exception &error) {
            if (suites().effect != nullptr && effect != nullptr)
                show_message(effect, kOfxMessageError, error.what());
            const auto *failure = dynamic_cast<const luxfer::Error *>(&error);
            return failure != nullptr && failure->status() == LUXFER_OUT_OF_MEMORY ? kOfxStatErrMemory : kOfxStatFailed;
        }
    } catch (...) { // no memory for the message, for example
        return kOfxStatFailed;
    }
}

void set_host(OfxHost *host) noexcept {
    suites().host = host;
}

} // namespace

} // namespace openfx

#if defined(__GNUC__)
#  define LUXFER_OPENFX_VISIBLE __attribute__((visibility("default")))
#else
#  define LUXFER_OPENFX_VISIBLE
#endif

LUXFER_OPENFX_VISIBLE int OfxGetNumberOfPlugins(void) {
    return 1;
}

LUXFER_OPENFX_VISIBLE OfxPlugin *OfxGetPlugin(int nth) {
    static OfxPlugin plugin = {kOfxImageEffectPluginApi,
                               kOfxImageEffectPluginApiVersion,
                               "luxfer.Stylise",
                               1,
                               0,
                               openfx::set_host,
                               openfx::main_entry};
    return nth == 0 ? &plugin : nullptr;
}
