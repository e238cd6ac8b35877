// Simulates a machine without free memory: makes one allocation of the library fail, or all allocations from one on.
// The call or the job must return LUXFER_OUT_OF_MEMORY or do without the memory. The process survives, nothing is
// lost, and the next attempt gives the usual result.
#include "check.hpp"

#include <luxfer.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <vector>

#include <link.h>
#include <malloc.h>

// The second names of glibc's allocator, by which the replacements below call it.
extern "C" {
void *__libc_malloc(std::size_t);
void *__libc_calloc(std::size_t, std::size_t);
void *__libc_realloc(void *, std::size_t);
void *__libc_memalign(std::size_t, std::size_t);
}

namespace {

// Address range of the library's code: only allocations called from there may fail.
std::uintptr_t library_begin = UINTPTR_MAX, library_end = 0;

int find_library(dl_phdr_info *object, std::size_t, void *) {
    if (!std::strstr(object->dlpi_name, "libluxfer.so"))
        return 0;
    for (int i = 0; i < object->dlpi_phnum; ++i) {
        const std::uintptr_t begin = object->dlpi_addr + object->dlpi_phdr[i].p_vaddr;
        library_begin = std::min(library_begin, begin);
        library_end = std::max(library_end, begin + object->dlpi_phdr[i].p_memsz);
    }
    return 1;
}

// Bytes that Rust's standard library allocates when a thread starts or first panics. It aborts if this allocation
// fails, so allocations of this size never fail here.
constexpr std::size_t THREAD = 48;

// The smallest allocation that is counted, in bytes; the number of counted allocations so far; and the numbers of the
// first and the last allocation that fail.
std::atomic<std::size_t> least{SIZE_MAX};
std::atomic<long> asked{0}, first_denied{-1}, last_denied{-1};

bool is_denied(std::size_t size, const void *caller) {
    const auto address = reinterpret_cast<std::uintptr_t>(caller);
    if (size < least.load() || size == THREAD || address < library_begin || address >= library_end)
        return false;
    const long number = asked.fetch_add(1);
    return number >= first_denied.load() && number <= last_denied.load();
}

} // namespace

// Replacements for the allocator. The dynamic linker searches the program first, so the library calls these.
extern "C" {

void *malloc(std::size_t size) {
    return is_denied(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}

void *calloc(std::size_t count, std::size_t size) {
    return is_denied(count * size, __builtin_return_address(0)) ? nullptr : __libc_calloc(count, size);
}

void *realloc(void *old, std::size_t size) {
    return is_denied(size, __builtin_return_address(0)) ? nullptr : __libc_realloc(old, size);
}

void *memalign(std::size_t alignment, std::size_t size) {
    return is_denied(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}

void *aligned_alloc(std::size_t alignment, std::size_t size) {
    return is_denied(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}

int posix_memalign(void **place, std::size_t alignment, std::size_t size) {
    void *found = is_denied(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
    if (!found)
        return ENOMEM;
    *place = found;
    return 0;
}
}

namespace {

using luxfer::Context, luxfer::Image, luxfer::Scene;

// Uses the library; returns a hash of the results.
using Use = std::function<std::uint64_t()>;

std::uint64_t hash(const Image &image) {
    const luxfer::ImageSize size = image.size();
    static std::vector<float> plane(1 << 20);
    std::uint64_t out = 1469598103934665603u;
    for (std::uint32_t channel = 0; channel < size.channels; ++channel) {
        image.read({plane, size.width, size.height, 1}, channel);
        const auto *bytes = reinterpret_cast<const unsigned char *>(plane.data());
        for (std::size_t i = 0; i < std::size_t(size.width) * size.height * sizeof(float); ++i)
            out = (out ^ bytes[i]) * 1099511628211u;
    }
    return out;
}

// Repeats a use of the library and makes another allocation of at least `bytes` bytes fail each time, at most `most`
// in total, evenly chosen; with `for_good`, all later allocations fail too.
void starve(const char *name, std::size_t bytes, bool for_good, const Use &use, std::uint64_t truth, long most) {
    least = bytes;
    asked = 0;
    CHECK(use() == truth);
    const long count = asked;
    CHECK(count > 0);
    long refused = 0;
    const long tries = count < most ? count : most;
    for (long i = 0; i < tries; ++i) {
        asked = 0;
        first_denied = i * count / tries;
        last_denied = for_good ? LONG_MAX : first_denied.load();
        try {
            // A use that does not need the memory may succeed, but only with the usual result.
            CHECK(use() == truth);
        } catch (const luxfer::Error &error) {
            ++refused;
            if (error.status() != LUXFER_OUT_OF_MEMORY)
                std::fprintf(stderr, "%s, allocation %ld: %s\n", name, first_denied.load(), error.what());
            CHECK(error.status() == LUXFER_OUT_OF_MEMORY);
        }
        first_denied = last_denied = -1;
    }
    least = SIZE_MAX;
    CHECK(use() == truth);
    std::printf("%-10s %7ld allocations of %7zu bytes and more, %s: %ld of %ld failures reported\n", name, count, bytes,
                for_good ? "all from one on" : "one at a time  ", refused, tries);
    std::fflush(stdout);
}

// Does this first for large allocations (of at least `kib` KiB, such as images), then for all allocations.
void starve(const char *name, std::size_t kib, const Use &use, long most) {
    const std::uint64_t truth = use();
    for (const std::size_t bytes : {kib << 10, std::size_t(1)})
        for (const bool for_good : {false, true})
            starve(name, bytes, for_good, use, truth, most);
}

} // namespace

int main() {
    dl_iterate_phdr(find_library, nullptr);
    CHECK(library_begin < library_end);
    const Context context = Context::create();
    static std::vector<float> samples(512 * 512 * 3, 0.25f);

    starve("image", 400, [&] {
        const Image image = Image::create(context, {samples, 512, 512, 3});
        const double half[] = {2, 0, 0, 0, 2, 0, 0, 0, 1};
        image.save("memory.png");
        return hash(image.warp(half, 300, 300)) ^ hash(Image::load(context, "memory.png"));
    }, 24);

    starve("context", 64, [&] {
        const Context other = Context::create();
        return hash(Image::create(other, {samples, 300, 300, 3}));
    }, 24);

    luxfer::DemoPhotoParams size;
    size.width = 480;
    size.height = 320;
    size.samples = 2;
    const auto demo = luxfer::DemoPhoto::create(context);
    demo.start(size).wait();
    const Image photo = demo.image(LUXFER_DEMO_PHOTO_PICTURE), strokes = demo.image(LUXFER_DEMO_PHOTO_STROKES);

    const auto rectify = luxfer::Rectify::create(context);
    const auto features = luxfer::Features::create(context);
    starve("features", 256, [&] {
        rectify.set_photo(photo);
        rectify.start().wait();
        features.set_photo(photo);
        features.set_view(rectify);
        features.start().wait();
        return hash(features.image(LUXFER_FEATURES_CHANNELS));
    }, 24);

    const auto plane = luxfer::Segment::create(context), lights = luxfer::Segment::create(context);
    const auto emission = luxfer::Emission::create(context);
    starve("texture", 192, [&] {
        plane.set_features(features.image(LUXFER_FEATURES_CHANNELS));
        plane.set_strokes(LUXFER_PHASE_PLANE, luxfer::Strokes::from_image(strokes));
        plane.start().wait();
        lights.set_features(features.image(LUXFER_FEATURES_CHANNELS));
        lights.set_region(plane.image(LUXFER_SEGMENT_MASK));
        lights.set_strokes(LUXFER_PHASE_LIGHTS, luxfer::Strokes::from_image(strokes));
        luxfer::SegmentParams colour;
        colour.channels = 7;
        lights.start(colour).wait();
        rectify.set_mask(plane.image(LUXFER_SEGMENT_MASK));
        rectify.start().wait();
        const luxfer_rectify_report view = rectify.report();
        const Image unwarped = rectify.image(LUXFER_RECTIFY_UNWARPED);
        const luxfer::ImageSize size = unwarped.size();
        const Image light = lights.image(LUXFER_SEGMENT_CONFIDENCE).warp(view.to_photo, size.width, size.height);
        emission.set_exemplar(unwarped, light, rectify.image(LUXFER_RECTIFY_VALID));
        emission.set_photo(photo, view.to_photo);
        luxfer::EmissionParams texture;
        texture.width = 400;
        texture.height = 300;
        emission.start(texture).wait();
        return hash(emission.image(LUXFER_EMISSION_TEXTURE));
    }, 24);

    Scene::demo(context, LUXFER_DEMO_TARGET_ROOM).save("memory.glb");
    std::vector<float> lamp(8 * 8 * 3, 0.0f);
    std::fill_n(&lamp[3 * 27], 3, 1.0f);
    const Image texture = Image::create(context, {lamp, 8, 8});
    starve("scene", 64, [&] {
        const Scene room = Scene::load(context, "memory.glb");
        const luxfer::PlacedEmission ceiling = room.place_emission("Ceiling", texture, {100, 100, 100});
        const auto relight = luxfer::Relight::create(context);
        relight.set_scene(room, ceiling);
        relight.set_target({50, 40, 30});
        luxfer::RelightParams rough;
        rough.paths = 1 << 12;
        relight.start(rough).wait();
        return std::uint64_t(1e6 * relight.report().scale[0]);
    }, 24);

    const auto render = luxfer::Render::create(context);
    render.set_scene(Scene::demo(context, LUXFER_DEMO_TARGET_ROOM));
    render.add_expression("direct", "LDE");
    render.set_aovs(LUXFER_AOV_ALPHA | LUXFER_AOV_NORMAL);
    starve("render", 16, [&] {
        luxfer::RenderParams small;
        small.width = 160;
        small.height = 120;
        small.samples = 2;
        small.preview = 1;
        render.start(small).wait();
        return hash(render.image());
    }, 24);
    starve("layers", 64, [&] {
        render.write_exr("memory.exr");
        return hash(render.image());
    }, 24);

    const auto guides = luxfer::Guides::create(context);
    guides.set_scene(Scene::demo(context, LUXFER_DEMO_SPHERE_ON_TABLE));
    const auto stylize = luxfer::Stylize::create(context);
    starve("stylize", 16, [&] {
        luxfer::GuidesParams small;
        small.width = 200;
        small.height = 140;
        small.samples = 2;
        guides.start(small).wait();
        stylize.set_artwork(guides.demo_artwork(LUXFER_ARTWORK_PEN));
        stylize.clear_guides();
        stylize.add_guides(guides, guides, LUXFER_GUIDES_WITH_NORMALS, 0.5f);
        stylize.start(luxfer::StylizeParams(LUXFER_STYLIZE_PREVIEW)).wait();
        return hash(stylize.image());
    }, 20);
    return check::summary("memory");
}
