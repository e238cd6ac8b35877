// The lighting transfer in C++ that the guide shows, with generated input.
#include <luxfer.hpp>

#include <cstdio>

namespace {

// A photo of the generated office and the strokes on it, instead of files.
void take_photo(const luxfer::Context &context, luxfer::Image &photo, luxfer::Image &strokes) {
    const auto demo = luxfer::DemoPhoto::create(context);
    luxfer::DemoPhotoParams params;
    params.width = 300;
    params.height = 200;
    demo.start(params).wait();
    photo = demo.image(LUXFER_DEMO_PHOTO_PICTURE);
    strokes = demo.image(LUXFER_DEMO_PHOTO_STROKES);
}

} // namespace

// --8<-- [start:program]
int main() try {
    const auto context = luxfer::Context::create();
    luxfer::Image photo, strokes; // from a file: luxfer::Image::load(context, "photo.jpg")
    take_photo(context, photo, strokes);
    const auto room = luxfer::Scene::demo(context, LUXFER_DEMO_TARGET_ROOM); // luxfer::Scene::load(context, "room.glb")

    const auto transfer = luxfer::Transfer::create(context);
    transfer.set_photo(photo);
    transfer.set_scene(room, "Ceiling");
    transfer.set_strokes(luxfer::Strokes::from_image(strokes));

    luxfer::RenderParams picture;
    picture.width = 240;
    picture.height = 135;
    picture.samples = 8;
    luxfer::TransferParams params;
    params.render = &picture;
    transfer.start(params).wait([](double fraction) {
        return std::printf("\r%3.0f %%", 100 * fraction) > 0; // false would cancel
    });

    transfer.image(LUXFER_TRANSFER_RENDER).save("lit.png", 0.01f); // 100 cd/m2 is white
    transfer.scene().save("lit.glb");
    std::printf("\n%u lamps, strength known to %.1f %%\n", transfer.report().fixtures, 100 * transfer.solution().error);
} catch (const luxfer::Error &error) {
    std::fprintf(stderr, "%s: %s\n", error.name(), error.what());
    return 1;
}
// --8<-- [end:program]
