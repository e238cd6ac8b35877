// The host's side of OpenFX.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#include "host.hpp"

namespace openfx {

namespace {

template <class Suite>
void fetch(const Suite *&suite, const OfxHost &host, const char *name, int version) {
    suite = static_cast<const Suite *>(host.fetchSuite(host.host, name, version));
}

} // namespace

Suites &suites() {
    static Suites of_this_process;
    return of_this_process;
}

bool Suites::fetch() {
    if (host == nullptr || host->fetchSuite == nullptr)
        return false;
    openfx::fetch(property, *host, kOfxPropertySuite, 1);
    openfx::fetch(parameter, *host, kOfxParameterSuite, 1);
    openfx::fetch(effect, *host, kOfxImageEffectSuite, 1);
    openfx::fetch(message, *host, kOfxMessageSuite, 1);
    openfx::fetch(persistent, *host, kOfxMessageSuite, 2);
    openfx::fetch(progress, *host, kOfxProgressSuite, 1);
    return property != nullptr && parameter != nullptr && effect != nullptr;
}

void Properties::set(const char *name, int value, int index) const {
    suites().property->propSetInt(handle_, name, index, value);
}

void Properties::set(const char *name, double value, int index) const {
    suites().property->propSetDouble(handle_, name, index, value);
}

void Properties::set(const char *name, const char *value, int index) const {
    suites().property->propSetString(handle_, name, index, value);
}

void Properties::set(const char *name, const OfxRectD &rectangle) const {
    const double sides[] = {rectangle.x1, rectangle.y1, rectangle.x2, rectangle.y2};
    for (int i = 0; i < 4; i++)
        set(name, sides[i], i);
}

int Properties::integer(const char *name, int index) const {
    int value = 0;
    return suites().property->propGetInt(handle_, name, index, &value) == kOfxStatOK ? value : 0;
}

double Properties::number(const char *name, int index) const {
    double value = 0;
    return suites().property->propGetDouble(handle_, name, index, &value) == kOfxStatOK ? value : 0;
}

std::string Properties::text(const char *name) const {
    char *value = nullptr;
    const OfxStatus status = suites().property->propGetString(handle_, name, 0, &value);
    return status == kOfxStatOK && value != nullptr ? value : "";
}

void *Properties::pointer(const char *name) const {
    void *value = nullptr;
    return suites().property->propGetPointer(handle_, name, 0, &value) == kOfxStatOK ? value : nullptr;
}

OfxRectI Properties::rectangle(const char *name) const {
    return {integer(name, 0), integer(name, 1), integer(name, 2), integer(name, 3)};
}

Properties properties_of(OfxImageEffectHandle effect) {
    OfxPropertySetHandle properties = nullptr;
    suites().effect->getPropertySet(effect, &properties);
    return Properties(properties);
}

void show_message(OfxImageEffectHandle effect, const char *type, const std::string &text) {
    const bool is_error = std::string(type) == kOfxMessageError;
    if (suites().persistent != nullptr)
        suites().persistent->setPersistentMessage(effect, type, "", "%s", text.c_str());
    else if (suites().message != nullptr) // a window, which must not open for a warning at every frame
        suites().message->message(effect, is_error ? kOfxMessageError : kOfxMessageLog, "", "%s", text.c_str());
}

void clear_message(OfxImageEffectHandle effect) {
    if (suites().persistent != nullptr)
        suites().persistent->clearPersistentMessage(effect);
}

ProgressBar::ProgressBar(OfxImageEffectHandle effect, const char *label)
    : effect_(effect), is_shown_(suites().progress != nullptr &&
                                 suites().progress->progressStart(effect, label) == kOfxStatOK) {}

ProgressBar::~ProgressBar() {
    if (is_shown_)
        suites().progress->progressEnd(effect_);
}

bool ProgressBar::show(double fraction) const {
    return !is_shown_ || suites().progress->progressUpdate(effect_, fraction) != kOfxStatReplyNo;
}

} // namespace openfx
