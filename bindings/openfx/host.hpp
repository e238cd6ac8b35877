// The host's side of OpenFX: its suites of functions, properties, messages and progress bar.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include <ofxImageEffect.h>
#include <ofxMessage.h>
#include <ofxParam.h>
#include <ofxProgress.h>

#include <string>

namespace openfx {

/// The functions of the host. OpenFX gives them to the binary and not to an instance, so they are the only state that
/// the plug-in shares between its instances. They do not change after kOfxActionLoad.
struct Suites {
    OfxHost *host = nullptr;
    const OfxPropertySuiteV1 *property = nullptr;
    const OfxParameterSuiteV1 *parameter = nullptr;
    const OfxImageEffectSuiteV1 *effect = nullptr;
    const OfxMessageSuiteV1 *message = nullptr;    // not every host has this one and those below
    const OfxMessageSuiteV2 *persistent = nullptr;
    const OfxProgressSuiteV1 *progress = nullptr;

    /// Fetches the suites from the host; false if one is missing that the plug-in needs.
    bool fetch();
};

/// The suites of this process.
Suites &suites();

/// A set of properties of the host, such as the description of a clip or the arguments of an action.
class Properties {
public:
    explicit Properties(OfxPropertySetHandle handle) : handle_(handle) {}

    /// Sets a property. A host refuses properties of later versions of OpenFX than its own, which does no harm.
    void set(const char *name, int value, int index = 0) const;
    void set(const char *name, double value, int index = 0) const;
    void set(const char *name, const char *value, int index = 0) const;

    /// Gets a property; 0 or an empty text if the host does not have it.
    int integer(const char *name, int index = 0) const;
    double number(const char *name, int index = 0) const;
    std::string text(const char *name) const;
    void *pointer(const char *name) const;

    /// Gets a rectangle of four integers.
    OfxRectI rectangle(const char *name) const;

    /// Sets a rectangle of four numbers.
    void set(const char *name, const OfxRectD &rectangle) const;

private:
    OfxPropertySetHandle handle_;
};

/// The properties of an effect: of its description, or of an instance.
Properties properties_of(OfxImageEffectHandle effect);

/// Shows a message at the effect, where it stays until the next message; type is kOfxMessageError or
/// kOfxMessageWarning.
void show_message(OfxImageEffectHandle effect, const char *type, const std::string &text);

/// Removes the message of the effect.
void clear_message(OfxImageEffectHandle effect);

/// The host's progress bar, shown as long as this object lives; without effect in hosts that have none.
class ProgressBar {
public:
    ProgressBar(OfxImageEffectHandle effect, const char *label);
    ProgressBar(const ProgressBar &) = delete;
    ProgressBar &operator=(const ProgressBar &) = delete;
    ~ProgressBar();

    /// Shows a fraction in [0, 1]; false if the user cancels.
    bool show(double fraction) const;

private:
    OfxImageEffectHandle effect_;
    bool is_shown_;
};

} // namespace openfx
