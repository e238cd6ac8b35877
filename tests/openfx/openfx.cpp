// Runs the OpenFX plug-in in a host made with OpenFX's own library for hosts, and compares its pictures, to the bit,
// with those of the C interface.
//
//   openfx FOLDER HEADER    FOLDER contains luxfer.ofx.bundle; HEADER is luxfer/stylize.h, whose ranges and defaults
//                           the parameters must have
//   openfx FOLDER old       tests what differs in an old host
//   openfx FOLDER FILE.png  saves a picture
#include "description.hpp"
#include "host.hpp"
#include "shot.hpp"

#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

namespace {

const Depth BYTE = {kOfxBitDepthByte, LUXFER_SAMPLE_U8, 1}, SHORT = {kOfxBitDepthShort, LUXFER_SAMPLE_U16, 2},
            HALF = {kOfxBitDepthHalf, LUXFER_SAMPLE_F16, 2}, FLOAT = {kOfxBitDepthFloat, LUXFER_SAMPLE_F32, 4};
const Layout RGBA_FLOAT = {FLOAT, 4, false, {0, 0}, 0};

host::effect::ImageEffectPlugin *plugin = nullptr;

luxfer_stylize_params preset(luxfer_stylize_preset which) {
    luxfer_stylize_params params;
    CHECK_OK(luxfer_stylize_get_preset(which, &params, sizeof params));
    return params;
}

shot::Frame frame_of(const Layout &layout, luxfer_colour_space space = LUXFER_COLOUR_LINEAR) {
    shot::Frame frame;
    for (const auto &image : shot::images())
        frame.add(image.first, layout, space);
    return frame;
}

// A frame in the host: its clips, the output, and what has happened.
struct Scene {
    Scene(shot::Frame inputs, const Layout &layout)
        : frame(std::move(inputs)), output(layout, shot::width, shot::height) {
        session.parameters["quality"] = LUXFER_STYLIZE_FAST;
    }

    OfxStatus render(const char *context = kOfxImageEffectContextGeneral) { return render(output.bounds(), context); }

    std::unique_ptr<host::effect::Instance> make_instance(const char *context) {
        session.clips = {{"Output", &output}};
        for (auto &picture : frame.pictures)
            session.clips[picture.first] = &picture.second;
        std::unique_ptr<host::effect::Instance> instance(plugin->createInstance(context, &session));
        CHECK(instance != nullptr && instance->createInstanceAction() != kOfxStatFailed);
        CHECK(instance->getClipPreferences());
        return instance;
    }

    OfxStatus render(const OfxRectI &window, const char *context = kOfxImageEffectContextGeneral) {
        const auto instance = make_instance(context);
        CHECK(instance->getOutputPreMultiplication() == kOfxImageUnPreMultiplied);
        const OfxPointD scale = {1, 1};
        CHECK(instance->getRegionOfDefinitionAction(0, scale, region) == kOfxStatOK);
        instance->beginRenderAction(0, 1, 1, false, scale, false, false);
        const OfxStatus status = instance->renderAction(0, kOfxImageFieldNone, window, scale, false, false, false);
        instance->endRenderAction(0, 1, 1, false, scale, false, false);
        return status;
    }

    // Whether a render fails with a message that contains `words`, and leaves the output alone.
    bool fails_with(const std::string &words) {
        const OfxStatus status = render();
        const bool is_told = session.message.find(words) != std::string::npos;
        if (!is_told)
            std::fprintf(stderr, "the message is: %s\n", session.message.c_str());
        return status == kOfxStatFailed && is_told && session.message_type == kOfxMessageError && output.is_untouched();
    }

    shot::Frame frame;
    Picture output;
    host::Session session;
    OfxRectD region = {};
};

// A picture of the plug-in is the library's, to the bit, with the alpha of the source.
void paints_like_the_library(const Layout &layout, luxfer_colour_space space,
                             const char *context = kOfxImageEffectContextGeneral) {
    Scene scene(frame_of(layout, space), layout);
    CHECK(scene.render(context) == kOfxStatOK);
    const shot::Image picture = shot::paint(scene.frame, preset(LUXFER_STYLIZE_FAST));
    CHECK(scene.output.get(0, 3) == shot::read(picture, layout.depth, space));
    if (layout.channels == 4)
        CHECK(scene.output.get(3, 1) == scene.frame.pictures.at("Source").get(3, 1));
    CHECK(scene.output.is_padding_untouched());
    const OfxRectI b = scene.output.bounds();
    CHECK(scene.region.x1 == b.x1 && scene.region.y1 == b.y1 && scene.region.x2 == b.x2 && scene.region.y2 == b.y2);
    CHECK(scene.session.message_type != kOfxMessageError);
    CHECK(scene.session.progress_started == 1 && scene.session.progress_ended == 1 && scene.session.questions > 0);
}

void uses_parameters() {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    scene.session.parameters = {{"quality", LUXFER_STYLIZE_FAST},
                                {"finalVote", 1 + LUXFER_STYLIZE_VOTE_NEAREST},
                                {"guideWeight", 5},
                                {"matchAppearance", 0.5},
                                {"seed", 7},
                                {"weightDirect", 3},
                                {"encoding", 2}};
    CHECK(scene.render() == kOfxStatOK);
    shot::Frame encoded = frame_of(RGBA_FLOAT, LUXFER_COLOUR_LINEAR);
    for (auto &image : encoded.same) { // the same numbers, read as sRGB
        if (image.first.find("Normals") != std::string::npos)
            continue;
        Picture &picture = scene.frame.pictures.at(image.first);
        shot::Bytes bytes = picture.get(0, 3);
        image.second = shot::make(bytes, picture.width, picture.height, 3, FLOAT, LUXFER_COLOUR_SRGB);
    }
    luxfer_stylize_params params = preset(LUXFER_STYLIZE_FAST);
    params.final_vote = LUXFER_STYLIZE_VOTE_NEAREST;
    params.guide_weight = 5;
    params.match_appearance = 0.5f;
    params.seed = 7;
    CHECK(scene.output.get(0, 3) == shot::read(shot::paint(encoded, params, 3), FLOAT, LUXFER_COLOUR_SRGB));
}

// The alpha of the artwork serves as a mask if asked; if it leaves nothing, the library's message is shown.
void masks_the_artwork() {
    const float clear = 0.25f, opaque = 1;
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT), empty(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    scene.session.parameters["maskByAlpha"] = empty.session.parameters["maskByAlpha"] = 1;
    Picture &artwork = scene.frame.pictures.at("Artwork"), &hidden = empty.frame.pictures.at("Artwork");
    for (std::uint32_t y = 0; y < artwork.height; y++)
        for (std::uint32_t x = 0; x < artwork.width; x++) {
            std::memcpy(artwork.at(x, y) + 3 * sizeof(float), x < 20 ? &clear : &opaque, sizeof(float));
            std::memcpy(hidden.at(x, y) + 3 * sizeof(float), &clear, sizeof(float));
        }
    CHECK(scene.render() == kOfxStatOK);
    shot::Bytes alpha = artwork.get(3, 1);
    const shot::Image mask = shot::make(alpha, artwork.width, artwork.height, 1, FLOAT, LUXFER_COLOUR_LINEAR);
    const shot::Image masked = shot::paint(scene.frame, preset(LUXFER_STYLIZE_FAST), 1, mask);
    CHECK(scene.output.get(0, 3) == shot::read(masked, FLOAT, LUXFER_COLOUR_LINEAR));
    CHECK(empty.fails_with("mask"));
}

// An artwork of 8 bits with renderings of floats, and an output without alpha; then a source without alpha.
void mixes_kinds_of_pixels() {
    const Layout rgb = {FLOAT, 3, false, {0, 0}, 0}, byte = {BYTE, 4, false, {0, 0}, 0};
    Scene scene(frame_of(RGBA_FLOAT), rgb);
    scene.frame.add("Artwork", byte, LUXFER_COLOUR_SRGB);
    CHECK(scene.render() == kOfxStatOK);
    const shot::Image picture = shot::paint(scene.frame, preset(LUXFER_STYLIZE_FAST));
    CHECK(scene.output.get(0, 3) == shot::read(picture, FLOAT, LUXFER_COLOUR_LINEAR));

    Scene opaque(frame_of(rgb), RGBA_FLOAT);
    CHECK(opaque.render() == kOfxStatOK);
    const float one = 1;
    CHECK(std::memcmp(opaque.output.at(50, 20) + 3 * sizeof one, &one, sizeof one) == 0);
}

// Only the window is written. Where the output is larger than the source, it becomes black and transparent.
void keeps_to_the_window() {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    CHECK(scene.render() == kOfxStatOK);
    const shot::Bytes whole = scene.output.get(0, 4);
    const std::size_t pixel = 16, row = pixel * shot::width;

    Scene part(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    const int left = 10, top = 5, right = 60, bottom = 30; // from the top left
    CHECK(part.render(OfxRectI{left, int(shot::height) - bottom, right, int(shot::height) - top}) == kOfxStatOK);
    const shot::Bytes pixels = part.output.get(0, 4), none(pixel, Picture::untouched);
    bool is_right = true;
    for (int y = 0; y < int(shot::height); y++)
        for (int x = 0; x < int(shot::width); x++) {
            const std::size_t i = std::size_t(y) * row + std::size_t(x) * pixel;
            const bool is_inside = x >= left && x < right && y >= top && y < bottom;
            is_right &= std::memcmp(&pixels[i], is_inside ? &whole[i] : none.data(), pixel) == 0;
        }
    CHECK(is_right);

    Scene beside(frame_of(RGBA_FLOAT), {FLOAT, 4, false, {50, 0}, 0});
    CHECK(beside.render() == kOfxStatOK);
    CHECK(std::memcmp(beside.output.at(0, 0), &whole[50 * pixel], pixel) == 0);
    CHECK(std::memcmp(beside.output.at(46, 0), shot::Bytes(pixel).data(), pixel) == 0);
}

// A host may give more pixels than a clip defines: those beyond the region of definition are no part of the picture.
void ignores_pixels_beyond_the_region() {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT), larger(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    const int border = 3;
    for (auto &entry : larger.frame.pictures) {
        Picture &picture = entry.second;
        const std::uint32_t inner_width = picture.width, inner_height = picture.height;
        Picture around({FLOAT, 4, false, {-border, -border}, 0}, inner_width + 2 * border, inner_height + 2 * border);
        around.border = border;
        for (std::uint32_t y = 0; y < inner_height; y++)
            std::memcpy(around.at(border, y + border), picture.at(0, y), inner_width * 16);
        picture = around;
    }
    CHECK(scene.render() == kOfxStatOK && larger.render() == kOfxStatOK);
    CHECK(larger.region.x1 == 0 && larger.region.x2 == shot::width);
    CHECK(larger.output.memory == scene.output.memory);
}

// Every input is needed as a whole, however small the wanted part is. The host library asks this only of effects with
// tiles.
void demands_whole_inputs() {
    namespace property = OFX::Host::Property;
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    const auto instance = scene.make_instance(kOfxImageEffectContextGeneral);
    const property::PropSpec time[] = {{kOfxPropTime, property::eDouble, 1, true, "0"}, property::propSpecEnd};
    property::Set arguments(time), results;
    for (const char *clip : {"Source", "ExemplarNormals", "Artwork"}) {
        const std::string name = std::string("OfxImageClipPropRoI_") + clip;
        const property::PropSpec region = {name.c_str(), property::eDouble, 4, false, "0"};
        results.createProperty(region);
    }
    CHECK(instance->mainEntry(kOfxImageEffectActionGetRegionsOfInterest, instance->getHandle(), &arguments, &results) ==
          kOfxStatOK);
    CHECK(results.getDoubleProperty("OfxImageClipPropRoI_Source", 2) == shot::width);
    CHECK(results.getDoubleProperty("OfxImageClipPropRoI_ExemplarNormals", 3) == shot::exemplar_height);
    CHECK(results.getDoubleProperty("OfxImageClipPropRoI_Artwork", 2) == shot::exemplar_width);
}

void enlarges_the_preview() {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    scene.session.parameters["quality"] = LUXFER_STYLIZE_PREVIEW;
    CHECK(scene.render() == kOfxStatOK);
    const shot::Image half = shot::paint(scene.frame, preset(LUXFER_STYLIZE_PREVIEW));
    const double halves[] = {0.5, 0, 0, 0, 0.5, 0, 0, 0, 1};
    luxfer_image *enlarged = nullptr;
    CHECK_OK(luxfer_image_warp(half.get(), halves, shot::width, shot::height, &enlarged));
    CHECK(scene.output.get(0, 3) == shot::read(shot::adopt(enlarged), FLOAT, LUXFER_COLOUR_LINEAR));
}

void says_what_is_missing() {
    for (const char *clip : {"Exemplar", "Artwork"}) {
        Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
        scene.frame.pictures.erase(clip);
        CHECK(scene.fails_with(std::string(clip) + " is not connected"));
    }
    for (const char *clip : {"Source", "Direct", "Output"}) {
        Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
        scene.session.without_picture = clip;
        CHECK(scene.fails_with(std::string(clip) + " has no picture at this time"));
    }
    Scene half(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    half.frame.pictures.erase("ExemplarDirect");
    CHECK(half.fails_with("Direct is connected, but ExemplarDirect is not"));
}

// An exemplar without light: the picture has a warning, which is shown without a failure.
void passes_warnings_on() {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    for (const char *clip : {"Exemplar", "ExemplarDirect"})
        std::memset(scene.frame.pictures.at(clip).memory.data(), 0, scene.frame.pictures.at(clip).memory.size());
    CHECK(scene.render() == kOfxStatOK);
    CHECK(scene.session.message_type == kOfxMessageWarning && scene.session.message.find("light") != std::string::npos);
}

void refuses_what_does_not_fit() {
    const Layout moved = {FLOAT, 4, false, {3, 0}, 0};
    for (const char *clip : {"Direct", "ExemplarDirect", "Artwork"}) {
        Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
        scene.frame.add(clip, moved, LUXFER_COLOUR_LINEAR);
        CHECK(scene.fails_with("pixels at (3, 0), but"));
        scene.frame.pictures.at(clip) = Picture(RGBA_FLOAT, 50, 40);
        CHECK(scene.fails_with("50 x 40 pixels at (0, 0), but"));
    }
    for (const char *parameter : {"guideWeight", "weightDirect", "quality"}) {
        Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
        scene.session.parameters[parameter] = -1;
        CHECK(scene.fails_with("")); // with the library's message
        CHECK(!scene.session.message.empty());
    }
    Scene unknown(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    unknown.frame.pictures.at("Artwork").layout.depth.name = "OfxBitDepthDouble";
    CHECK(unknown.fails_with("OfxBitDepthDouble, which the effect does not support"));
    Scene no_data(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    no_data.session.has_bad_data = true;
    CHECK(no_data.fails_with("Source has no pixels"));
    Scene bad_rows(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    bad_rows.session.has_bad_rows = true;
    CHECK(bad_rows.fails_with("Source has rows of 1 bytes"));
}

// Values that are not finite are what they are to the library; in alpha they pass through.
void survives_bad_numbers() {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1e30f};
    for (const char *clip : {"Source", "Exemplar", "Artwork", "Normals"}) {
        Picture &picture = scene.frame.pictures.at(clip);
        for (std::uint32_t i = 0; i < 12; i++)
            std::memcpy(picture.at(5 * i, 4 * i) + i % 4 * sizeof(float), &bad[i % 3], sizeof(float));
        shot::Bytes bytes = picture.get(0, 3);
        scene.frame.same[clip] = shot::make(bytes, picture.width, picture.height, 3, FLOAT, LUXFER_COLOUR_LINEAR);
    }
    CHECK(scene.render() == kOfxStatOK);
    const shot::Image painted = shot::paint(scene.frame, preset(LUXFER_STYLIZE_FAST));
    CHECK(scene.output.get(0, 3) == shot::read(painted, FLOAT, LUXFER_COLOUR_LINEAR));
    CHECK(scene.output.get(3, 1) == scene.frame.pictures.at("Source").get(3, 1));
}

// The host aborts, or the user cancels at the progress bar: nothing is written, and no message is shown.
void ends_when_asked() {
    Scene aborted(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    aborted.session.parameters["quality"] = LUXFER_STYLIZE_FULL;
    aborted.session.aborts_after = 1;
    CHECK(aborted.render() == kOfxStatOK);
    CHECK(aborted.output.is_untouched() && aborted.session.message.empty());
    CHECK(aborted.session.progress_started == 1 && aborted.session.progress_ended == 1);

    Scene without(frame_of(RGBA_FLOAT), RGBA_FLOAT); // a host that aborts may give no pictures either
    without.frame.pictures.erase("Artwork");
    without.session.aborts_after = 0;
    CHECK(without.render() == kOfxStatOK && without.output.is_untouched() && without.session.message.empty());

    Scene cancelled(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    cancelled.session.cancels_after = 0;
    CHECK(cancelled.render() == kOfxStatFailed);
    CHECK(cancelled.output.is_untouched() && cancelled.session.message.empty());
}

// A message stays until a frame succeeds. Two instances that render at the same time paint what one paints alone.
void keeps_instances_apart() {
    Scene alone(frame_of(RGBA_FLOAT), RGBA_FLOAT), first = alone, second = alone;
    alone.session.message = "of an earlier frame", alone.session.message_type = kOfxMessageError;
    CHECK(alone.render() == kOfxStatOK && alone.session.message_type != kOfxMessageError);
    OfxStatus status = kOfxStatFailed;
    std::thread other([&] { status = second.render(); });
    CHECK(first.render() == kOfxStatOK);
    other.join();
    CHECK(status == kOfxStatOK);
    CHECK(first.output.memory == alone.output.memory && second.output.memory == alone.output.memory);
}

// Messages are windows, so warnings go to the host's log; there is no progress bar.
void works_in_old_hosts() {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT), dark = scene, incomplete = scene;
    CHECK(scene.render() == kOfxStatOK && scene.session.progress_started == 0);
    const shot::Image picture = shot::paint(scene.frame, preset(LUXFER_STYLIZE_FAST));
    CHECK(scene.output.get(0, 3) == shot::read(picture, FLOAT, LUXFER_COLOUR_LINEAR));
    for (const char *clip : {"Exemplar", "ExemplarDirect"})
        std::memset(dark.frame.pictures.at(clip).memory.data(), 0, dark.frame.pictures.at(clip).memory.size());
    CHECK(dark.render() == kOfxStatOK && dark.session.message_type == kOfxMessageLog);
    incomplete.frame.pictures.erase("Artwork");
    CHECK(incomplete.fails_with("Artwork is not connected"));
}

void save(const char *path) {
    Scene scene(frame_of(RGBA_FLOAT), RGBA_FLOAT);
    scene.session.parameters.clear();
    CHECK(scene.render() == kOfxStatOK);
    shot::Bytes bytes = scene.output.get(0, 3);
    const shot::Image picture = shot::make(bytes, shot::width, shot::height, 3, FLOAT, LUXFER_COLOUR_LINEAR);
    CHECK_OK(luxfer_image_save(picture.get(), path, 1));
}

void run(const std::string &header) {
    description::check_all(*plugin, header);
    paints_like_the_library(RGBA_FLOAT, LUXFER_COLOUR_LINEAR);
    paints_like_the_library(RGBA_FLOAT, LUXFER_COLOUR_LINEAR, kOfxImageEffectContextFilter);
    paints_like_the_library({FLOAT, 4, true, {-7, 5}, 0}, LUXFER_COLOUR_LINEAR);
    paints_like_the_library({BYTE, 4, true, {0, 0}, 13}, LUXFER_COLOUR_SRGB);
    paints_like_the_library({BYTE, 3, false, {4, -9}, 7}, LUXFER_COLOUR_SRGB);
    paints_like_the_library({SHORT, 4, false, {0, 0}, 0}, LUXFER_COLOUR_SRGB);
    paints_like_the_library({HALF, 4, true, {0, 0}, 6}, LUXFER_COLOUR_LINEAR);
    uses_parameters();
    masks_the_artwork();
    mixes_kinds_of_pixels();
    keeps_to_the_window();
    ignores_pixels_beyond_the_region();
    demands_whole_inputs();
    enlarges_the_preview();
    says_what_is_missing();
    passes_warnings_on();
    refuses_what_does_not_fit();
    survives_bad_numbers();
    ends_when_asked();
    keeps_instances_apart();
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 3)
        return 2;
    const std::string task = argv[2];
    std::ifstream file(task);
    auto &plugins = *OFX::Host::PluginCache::getPluginCache();
    host::Host application(task == "old");
    host::effect::PluginCache effects(application);
    effects.registerInCache(plugins);
    plugins.addFileToPath(argv[1]);
    plugins.scanPluginFiles();
    plugin = effects.getPluginById("luxfer.Stylise");
    CHECK(plugin != nullptr);
    if (plugin != nullptr && task == "old")
        works_in_old_hosts();
    else if (plugin != nullptr && task.find(".png") != std::string::npos)
        save(argv[2]);
    else if (plugin != nullptr)
        run({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
    OFX::Host::PluginCache::clearPluginCache(); // unloads the plug-in
    return check::summary("openfx");
}
