// The inputs of one frame, as pictures of a host and as images of the library; and what the library paints of them.
#pragma once

#include "../cpp/check.hpp"
#include "picture.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace shot {

using Bytes = std::vector<unsigned char>;
using Image = std::shared_ptr<luxfer_image>;

constexpr std::uint32_t width = 96, height = 72;                   // of the target
constexpr std::uint32_t exemplar_width = 80, exemplar_height = 64; // of the exemplar and its artwork

inline luxfer_context *context() {
    static luxfer_context *made = nullptr;
    if (made == nullptr)
        CHECK_OK(luxfer_context_create(nullptr, &made));
    return made;
}

inline Image adopt(luxfer_image *image) {
    return Image(image, [](luxfer_image *released) { luxfer_release(released); });
}

inline luxfer_image_view packed(Bytes &bytes, std::uint32_t w, std::uint32_t h, std::uint32_t channels,
                                luxfer_sample sample, luxfer_colour_space space) {
    luxfer_image_view view;
    CHECK_OK(luxfer_image_view_init(&view, sizeof view));
    view.width = w;
    view.height = h;
    view.channels = channels;
    view.sample = sample;
    view.colour_space = space;
    view.data = bytes.data();
    view.byte_size = bytes.size();
    return view;
}

// The image in samples of a depth, packed from the top left.
inline Bytes read(const Image &image, const Depth &depth, luxfer_colour_space space) {
    std::uint32_t w = 0, h = 0, channels = 0;
    CHECK_OK(luxfer_image_get_size(image.get(), &w, &h, &channels));
    Bytes bytes(std::size_t(w) * h * channels * depth.bytes);
    const luxfer_image_view view = packed(bytes, w, h, channels, depth.sample, space);
    CHECK_OK(luxfer_image_read(image.get(), 0, &view));
    return bytes;
}

inline Image make(Bytes &bytes, std::uint32_t w, std::uint32_t h, std::uint32_t channels, const Depth &depth,
                  luxfer_colour_space space) {
    const luxfer_image_view view = packed(bytes, w, h, channels, depth.sample, space);
    luxfer_image *image = nullptr;
    CHECK_OK(luxfer_image_create(context(), &view, &image));
    return adopt(image);
}

inline luxfer_status finish(luxfer_job *job) {
    luxfer_status outcome = LUXFER_UNKNOWN;
    CHECK_OK(luxfer_job_wait(job, -1, nullptr, nullptr, &outcome));
    CHECK_OK(luxfer_release(job));
    return outcome;
}

// The guides of a demonstration scene.
inline std::shared_ptr<luxfer_guides> render(luxfer_demo demo, std::uint32_t w, std::uint32_t h) {
    luxfer_scene *scene = nullptr;
    luxfer_guides *guides = nullptr;
    luxfer_guides_params params;
    luxfer_job *job = nullptr;
    CHECK_OK(luxfer_demo_create_scene(context(), demo, &scene));
    CHECK_OK(luxfer_guides_create(context(), &guides));
    CHECK_OK(luxfer_guides_set_scene(guides, scene));
    CHECK_OK(luxfer_guides_params_init(&params, sizeof params));
    params.width = w;
    params.height = h;
    params.samples = 4;
    CHECK_OK(luxfer_guides_start(guides, &params, &job));
    CHECK_OK(finish(job));
    CHECK_OK(luxfer_release(scene));
    return std::shared_ptr<luxfer_guides>(guides, [](luxfer_guides *released) { luxfer_release(released); });
}

// A guide in [0, 1]: light is divided by the luminance that shall be white.
inline Image guide(const std::shared_ptr<luxfer_guides> &guides, luxfer_guides_image kind) {
    luxfer_image *image = nullptr;
    CHECK_OK(luxfer_guides_get_image(guides.get(), kind, &image));
    const Image got = adopt(image);
    if (kind == LUXFER_GUIDES_NORMALS)
        return got;
    const Depth depth = {"", LUXFER_SAMPLE_F32, sizeof(float)};
    std::uint32_t w = 0, h = 0;
    CHECK_OK(luxfer_image_get_size(image, &w, &h, nullptr));
    Bytes bytes = read(got, depth, LUXFER_COLOUR_LINEAR);
    const float white = 450; // cd/m2 [convention]
    for (std::size_t i = 0; i < bytes.size(); i += sizeof white) {
        float value;
        std::memcpy(&value, &bytes[i], sizeof value);
        value /= white;
        std::memcpy(&bytes[i], &value, sizeof value);
    }
    return make(bytes, w, h, 3, depth, LUXFER_COLOUR_LINEAR);
}

// The pictures that all tests use, by the names of clips: a still life to paint, and a painted ball.
inline const std::map<std::string, Image> &images() {
    static std::map<std::string, Image> made;
    if (!made.empty())
        return made;
    const auto ball = render(LUXFER_DEMO_SPHERE_ON_TABLE, exemplar_width, exemplar_height);
    const auto still_life = render(LUXFER_DEMO_STILL_LIFE, width, height);
    luxfer_image *artwork = nullptr;
    CHECK_OK(luxfer_demo_create_artwork(ball.get(), LUXFER_ARTWORK_PAINT, &artwork));
    made = {{"Source", guide(still_life, LUXFER_GUIDES_FULL)},
            {"Exemplar", guide(ball, LUXFER_GUIDES_FULL)},
            {"Artwork", adopt(artwork)},
            {"Direct", guide(still_life, LUXFER_GUIDES_DIRECT)},
            {"ExemplarDirect", guide(ball, LUXFER_GUIDES_DIRECT)},
            {"Normals", guide(still_life, LUXFER_GUIDES_NORMALS)},
            {"ExemplarNormals", guide(ball, LUXFER_GUIDES_NORMALS)}};
    return made;
}

// A frame in the pixels of a host, and the library's images of these pixels.
struct Frame {
    std::map<std::string, Picture> pictures;
    std::map<std::string, Image> same;

    void add(const std::string &clip, const Layout &layout, luxfer_colour_space space) {
        const luxfer_colour_space stored = clip.find("Normals") == std::string::npos ? space : LUXFER_COLOUR_LINEAR;
        const bool is_target = clip == "Source" || clip == "Direct" || clip == "Normals";
        Bytes bytes = read(images().at(clip), layout.depth, stored);
        Picture picture(layout, is_target ? width : exemplar_width, is_target ? height : exemplar_height);
        picture.set(bytes, 0, 3);
        if (layout.channels == 4) {
            Bytes alpha(std::size_t(picture.width) * picture.height * layout.depth.bytes);
            for (std::size_t i = 0; i < alpha.size(); i++)
                alpha[i] = (unsigned char)(7 * (i / layout.depth.bytes) % 60); // any finite numbers
            picture.set(alpha, 3, 1);
        }
        same[clip] = make(bytes, picture.width, picture.height, 3, layout.depth, stored);
        pictures.erase(clip);
        pictures.emplace(clip, std::move(picture));
    }
};

// What the library paints of a frame, called as a program in C would call it.
inline Image paint(const Frame &frame, const luxfer_stylize_params &params, float direct_weight = 1,
                   const Image &mask = nullptr) {
    luxfer_stylize *stylize = nullptr;
    luxfer_job *job = nullptr;
    luxfer_image *picture = nullptr;
    const auto image = [&](const char *clip) { return frame.same.at(clip).get(); };
    CHECK_OK(luxfer_stylize_create(context(), &stylize));
    CHECK_OK(luxfer_stylize_set_artwork(stylize, image("Artwork")));
    CHECK_OK(luxfer_stylize_set_source_mask(stylize, mask.get()));
    CHECK_OK(luxfer_stylize_add_guide(stylize, "full", image("Exemplar"), image("Source"), 1, LUXFER_GUIDE_LIGHT));
    if (frame.same.count("Direct") != 0)
        CHECK_OK(luxfer_stylize_add_guide(stylize, "direct", image("ExemplarDirect"), image("Direct"), direct_weight,
                                          LUXFER_GUIDE_LIGHT));
    if (frame.same.count("Normals") != 0)
        CHECK_OK(luxfer_stylize_add_guide(stylize, "normals", image("ExemplarNormals"), image("Normals"), 1,
                                          LUXFER_GUIDE_DATA));
    CHECK_OK(luxfer_stylize_start(stylize, &params, &job));
    CHECK_OK(finish(job));
    CHECK_OK(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_PICTURE, &picture));
    CHECK_OK(luxfer_release(stylize));
    return adopt(picture);
}

} // namespace shot
