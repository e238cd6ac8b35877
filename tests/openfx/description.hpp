// What the plug-in says of itself: its clips; and its parameters, which must have the ranges, defaults and options that
// luxfer/stylize.h states.
#pragma once

#include "../cpp/check.hpp"
#include "host.hpp"

#include <regex>
#include <string>
#include <vector>

namespace description {

// The names of the clips that are optional, or of the others, in their order.
inline std::vector<std::string> names_of(const host::effect::Descriptor &descriptor, bool is_optional) {
    std::vector<std::string> names;
    for (const auto *clip : descriptor.getClipsByOrder())
        if (clip->isOptional() == is_optional)
            names.push_back(clip->getName());
    return names;
}

// The minimum, maximum and default that the header states in the comment above a field.
inline void check_range(const OFX::Host::Property::Set &of, const std::string &header, const std::string &field) {
    const std::size_t end = header.find(" " + field + ";"), begin = header.rfind("/**", end);
    std::string comment = header.substr(begin, end - begin);
    comment = std::regex_replace(comment, std::regex("\\s*\n\\s*\\*\\s*"), " ");
    std::smatch range, value;
    CHECK(std::regex_search(comment, range, std::regex("in \\[([^,]+), ([^\\]]+)\\]")));
    CHECK(std::regex_search(comment, value, std::regex("default ([0-9.]*[0-9])|([0-9.]+), the default")));
    const std::string found = value[1].str() + value[2].str();
    CHECK(of.getDoubleProperty(kOfxParamPropMin) == std::stod(range[1]));
    CHECK(of.getDoubleProperty(kOfxParamPropMax) == std::stod(range[2]));
    CHECK(of.getDoubleProperty(kOfxParamPropDefault) == std::stod(found));
}

// The options from `first` on have the names of the header's constants, in their order.
inline void check_options(const OFX::Host::Property::Set &of, int first, const std::string &header,
                          const std::string &prefix) {
    const std::regex constant("#define " + prefix + "([A-Z]+) ([0-9]+)\n");
    int count = 0;
    for (std::sregex_iterator it(header.begin(), header.end(), constant), end; it != end; ++it, count++) {
        std::string option = of.getStringProperty(kOfxParamPropChoiceOption, first + std::stoi((*it)[2]));
        for (char &c : option)
            c = char(std::toupper(c));
        CHECK(option == (*it)[1]);
    }
    CHECK(count > 0 && of.getDimension(kOfxParamPropChoiceOption) == first + count);
}

inline void check_all(host::effect::ImageEffectPlugin &plugin, const std::string &header) {
    host::effect::Descriptor &general = *plugin.getContext(kOfxImageEffectContextGeneral);
    host::effect::Descriptor &filter = *plugin.getContext(kOfxImageEffectContextFilter);
    CHECK((names_of(general, false) == std::vector<std::string>{"Source", "Exemplar", "Artwork", "Output"}));
    CHECK((names_of(filter, false) == std::vector<std::string>{"Source", "Output"}));
    CHECK(names_of(general, true).size() == 16 && names_of(filter, true).size() == 18);
    CHECK(!general.supportsTiles() && general.supportsMultiResolution() && !general.getHostFrameThreading());

    const auto properties = [&](const char *name) -> const OFX::Host::Property::Set & {
        return general.getParams().at(name)->getProperties();
    };
    check_range(properties("guideWeight"), header, "guide_weight");
    check_range(properties("matchAppearance"), header, "match_appearance");
    check_options(properties("quality"), 0, header, "LUXFER_STYLIZE_");
    check_options(properties("finalVote"), 1, header, "LUXFER_STYLIZE_VOTE_");
    CHECK(properties("seed").getIntProperty(kOfxParamPropDefault) == 1);
    CHECK(header.find("weight, in [0, 1e6], is relative to the other guides") != std::string::npos);
    CHECK(properties("weightNormals").getDoubleProperty(kOfxParamPropMax) == 1e6);
}

} // namespace description
