// A host for one effect, made with the host support library of OpenFX. Its clips are pictures of the test; it records
// what the effect says, and can abort.
#pragma once

#include "picture.hpp"

#include <ofxCore.h>
#include <ofxImageEffect.h>
#include <ofxPixels.h>
// The headers of the library use each other without including each other.
#include <ofxhBinary.h>
#include <ofxhPropertySuite.h>
#include <ofxhClip.h>
#include <ofxhParam.h>
#include <ofxhMemory.h>
#include <ofxhImageEffect.h>
#include <ofxhPluginAPICache.h>
#include <ofxhPluginCache.h>
#include <ofxhHost.h>
#include <ofxhImageEffectAPI.h>

#include <cstdarg>
#include <cstdio>
#include <map>
#include <string>

namespace host {

namespace effect = OFX::Host::ImageEffect;

// What a test connects to the effect, and what the effect has done.
struct Session {
    std::map<std::string, Picture *> clips;
    std::map<std::string, double> parameters; // others have their defaults
    int aborts_after = 1 << 30;               // number of questions after which the host aborts
    int cancels_after = 1 << 30;              // number of updates after which the user cancels at the progress bar
    std::string message, message_type;
    int progress_started = 0, progress_ended = 0, progress_updates = 0, questions = 0;
    std::string without_picture; // a clip that is connected, but has no picture at this time
    bool has_bad_data = false, has_bad_rows = false; // defects of the pictures that the host gives
};

class Image : public effect::Image {
public:
    Image(effect::ClipInstance &clip, Picture &picture, const Session &session)
        : effect::Image(clip, 1, 1, session.has_bad_data ? nullptr : lower_left(picture), picture.bounds(),
                        picture.defined(), session.has_bad_rows ? 1 : sign(picture) * picture.row_bytes,
                        kOfxImageFieldNone, "") {
        setStringProperty(kOfxImageEffectPropPixelDepth, picture.layout.depth.name);
        setStringProperty(kOfxImageEffectPropComponents,
                          picture.layout.channels == 4 ? kOfxImageComponentRGBA : kOfxImageComponentRGB);
    }

private:
    static int sign(const Picture &picture) { return picture.layout.is_top_down ? -1 : 1; }
    static void *lower_left(Picture &picture) { return picture.at(0, picture.height - 1); }
};

class Clip : public effect::ClipInstance {
public:
    Clip(effect::Instance *effect, effect::ClipDescriptor &descriptor, Session &session)
        : effect::ClipInstance(effect, descriptor), session_(session) {
        const auto found = session.clips.find(descriptor.getName());
        picture_ = found == session.clips.end() ? nullptr : found->second;
        depth_ = picture_ ? picture_->layout.depth.name : kOfxBitDepthNone;
        components_ = !picture_                       ? kOfxImageComponentNone
                      : picture_->layout.channels == 4 ? kOfxImageComponentRGBA
                                                       : kOfxImageComponentRGB;
    }

    const std::string &getUnmappedBitDepth() const override { return depth_; }
    const std::string &getUnmappedComponents() const override { return components_; }
    const std::string &getPremult() const override { return premultiplied_; }
    const std::string &getFieldOrder() const override { return no_field_; }
    double getAspectRatio() const override { return 1; }
    double getFrameRate() const override { return 25; }
    double getUnmappedFrameRate() const override { return 25; }
    void getFrameRange(double &start, double &end) const override { start = 0, end = 10; }
    void getUnmappedFrameRange(double &start, double &end) const override { start = 0, end = 10; }
    bool getContinuousSamples() const override { return false; }
    bool getConnected() const override { return picture_ != nullptr && !isOutput(); } // no other effect uses the output
    OfxRectD getRegionOfDefinition(OfxTime) const override {
        const OfxRectI b = picture_ ? picture_->defined() : OfxRectI{0, 0, 0, 0};
        return {double(b.x1), double(b.y1), double(b.x2), double(b.y2)};
    }
    effect::Image *getImage(OfxTime, const OfxRectD *) override {
        return picture_ && session_.without_picture != getName() ? new Image(*this, *picture_, session_) : nullptr;
    }

private:
    Session &session_;
    Picture *picture_;
    std::string depth_, components_, premultiplied_ = kOfxImagePreMultiplied, no_field_ = kOfxImageFieldNone;
};

// A parameter that does not change with time: Base is the class of its type in the library, T the type of its value.
template <class Base, class T>
class Value : public Base {
public:
    Value(OFX::Host::Param::Descriptor &descriptor, OFX::Host::Param::SetInstance *set, T value)
        : Base(descriptor, set), value_(value) {}
    OfxStatus get(T &value) override { return value = value_, kOfxStatOK; }
    OfxStatus get(OfxTime, T &value) override { return value = value_, kOfxStatOK; }
    OfxStatus set(T value) override { return value_ = value, kOfxStatOK; }
    OfxStatus set(OfxTime, T value) override { return value_ = value, kOfxStatOK; }

private:
    T value_;
};

class Number : public Value<OFX::Host::Param::DoubleInstance, double> {
public:
    using Value::Value;
    OfxStatus derive(OfxTime, double &) override { return kOfxStatErrMissingHostFeature; }
    OfxStatus integrate(OfxTime, OfxTime, double &) override { return kOfxStatErrMissingHostFeature; }
};

class Instance : public effect::Instance {
public:
    Instance(effect::ImageEffectPlugin *plugin, effect::Descriptor &descriptor, const std::string &context,
             Session &session)
        : effect::Instance(plugin, descriptor, context, false), session_(session) {}

    effect::ClipInstance *newClipInstance(effect::Instance *, effect::ClipDescriptor *descriptor, int) override {
        return new Clip(this, *descriptor, session_);
    }

    OFX::Host::Param::Instance *newParam(const std::string &name, OFX::Host::Param::Descriptor &descriptor) override {
        namespace param = OFX::Host::Param;
        const std::string type = descriptor.getType();
        const auto &properties = descriptor.getProperties();
        const auto found = session_.parameters.find(name);
        const bool is_set = found != session_.parameters.end();
        if (type == kOfxParamTypeGroup)
            return new param::GroupInstance(descriptor, this);
        if (type == kOfxParamTypeDouble) {
            const double initial = properties.getDoubleProperty(kOfxParamPropDefault);
            return new Number(descriptor, this, is_set ? found->second : initial);
        }
        const int integer = is_set ? int(found->second) : properties.getIntProperty(kOfxParamPropDefault);
        if (type == kOfxParamTypeBoolean)
            return new Value<param::BooleanInstance, bool>(descriptor, this, integer != 0);
        if (type == kOfxParamTypeChoice)
            return new Value<param::ChoiceInstance, int>(descriptor, this, integer);
        return new Value<param::IntegerInstance, int>(descriptor, this, integer);
    }

    int abort() override { return session_.questions++ >= session_.aborts_after; }
    void progressStart(const std::string &, const std::string &) override { session_.progress_started++; }
    void progressEnd() override { session_.progress_ended++; }
    bool progressUpdate(double) override { return session_.progress_updates++ < session_.cancels_after; }

    OfxStatus vmessage(const char *type, const char *, const char *format, va_list arguments) override {
        char text[2048];
        std::vsnprintf(text, sizeof text, format, arguments);
        session_.message = text;
        session_.message_type = type;
        return kOfxStatOK;
    }
    OfxStatus setPersistentMessage(const char *type, const char *id, const char *format, va_list arguments) override {
        return vmessage(type, id, format, arguments);
    }
    OfxStatus clearPersistentMessage() override {
        session_.message.clear();
        session_.message_type.clear();
        return kOfxStatOK;
    }

    const std::string &getDefaultOutputFielding() const override { return no_field_; }
    void getProjectSize(double &x, double &y) const override { x = 1920, y = 1080; }
    void getProjectOffset(double &x, double &y) const override { x = 0, y = 0; }
    void getProjectExtent(double &x, double &y) const override { x = 1920, y = 1080; }
    double getProjectPixelAspectRatio() const override { return 1; }
    double getEffectDuration() const override { return 10; }
    double getFrameRate() const override { return 25; }
    double getFrameRecursive() const override { return 0; }
    void getRenderScaleRecursive(double &x, double &y) const override { x = 1, y = 1; }
    OfxStatus editBegin(const std::string &) override { return kOfxStatErrMissingHostFeature; }
    OfxStatus editEnd() override { return kOfxStatErrMissingHostFeature; }
    double timeLineGetTime() override { return 0; }
    void timeLineGotoTime(double) override {}
    void timeLineGetBounds(double &first, double &last) override { first = 0, last = 10; }

private:
    Session &session_;
    std::string no_field_ = kOfxImageFieldNone;
};

class Host : public effect::Host {
public:
    // An old host has neither messages that stay nor a progress bar.
    explicit Host(bool is_old) : is_old_(is_old) {
        _properties.setStringProperty(kOfxPropName, "luxfer.test");
        for (const char *context : {kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral})
            _properties.setStringProperty(kOfxImageEffectPropSupportedContexts, context, contexts_++);
        _properties.setStringProperty(kOfxImageEffectPropSupportedComponents, kOfxImageComponentRGBA, 0);
        _properties.setStringProperty(kOfxImageEffectPropSupportedComponents, kOfxImageComponentRGB, 1);
        _properties.setIntProperty(kOfxImageEffectPropSupportsMultiResolution, 1);
        _properties.setIntProperty(kOfxImageEffectPropSupportsMultipleClipDepths, 1);
        _properties.setIntProperty(kOfxImageEffectPropSupportsTiles, 1);
    }

    const void *fetchSuite(const char *name, int version) override {
        const std::string suite = name;
        const bool is_new = (suite == kOfxMessageSuite && version == 2) || suite == kOfxProgressSuite;
        return is_old_ && is_new ? nullptr : effect::Host::fetchSuite(name, version);
    }

    effect::Instance *newInstance(void *session, effect::ImageEffectPlugin *plugin, effect::Descriptor &descriptor,
                                  const std::string &context) override {
        return new Instance(plugin, descriptor, context, *static_cast<Session *>(session));
    }
    effect::Descriptor *makeDescriptor(effect::ImageEffectPlugin *plugin) override {
        return new effect::Descriptor(plugin);
    }
    effect::Descriptor *makeDescriptor(const effect::Descriptor &root, effect::ImageEffectPlugin *plugin) override {
        return new effect::Descriptor(root, plugin);
    }
    effect::Descriptor *makeDescriptor(const std::string &bundle, effect::ImageEffectPlugin *plugin) override {
        return new effect::Descriptor(bundle, plugin);
    }
    OfxStatus vmessage(const char *, const char *, const char *, va_list) override { return kOfxStatOK; }
    OfxStatus setPersistentMessage(const char *, const char *, const char *, va_list) override { return kOfxStatOK; }
    OfxStatus clearPersistentMessage() override { return kOfxStatOK; }

private:
    bool is_old_;
    int contexts_ = 0;
};

} // namespace host
