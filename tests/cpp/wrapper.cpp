// Tests the C++ wrapper: ownership, errors, callbacks that throw, and views of memory. Built twice, with exceptions
// and with LUXFER_NO_EXCEPTIONS. wrapper_is_complete.cmake checks that the wrapper lacks no function.
#include "check.hpp"

#include <luxfer.hpp>

#include <atomic>
#include <cmath>
#include <cstring>
#include <optional>
#include <thread>

namespace {

// Helpers with the same interface in both builds: the value of a call that must succeed, and the error of a call that
// must fail.
#ifndef LUXFER_NO_EXCEPTIONS

template <class T>
T ok(T value) {
    return value;
}

template <class Call>
luxfer::Error error_of(const Call &call) {
    try {
        call();
    } catch (const luxfer::Error &error) {
        return error;
    }
    return luxfer::Error(LUXFER_OK, "");
}

#define OK(call) (call)

#else

template <class T>
T ok(luxfer::Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "%s\n", result.error().what());
        std::abort();
    }
    return *std::move(result);
}

template <class Call>
luxfer::Error error_of(const Call &call) {
    const auto result = call();
    return result ? luxfer::Error(LUXFER_OK, "") : result.error();
}

#define OK(call) CHECK((call).has_value())

#endif

#define CHECK_ERROR(call, wanted) CHECK_STATUS(error_of([&] { return call; }).status(), wanted)

using luxfer::Context, luxfer::Image, luxfer::Scene, luxfer::Render, luxfer::Job;

constexpr std::uint32_t endless = 1u << 20;

Context new_context() {
    luxfer::ContextParams params;
    params.num_threads = 2;
    return ok(Context::create(params));
}

Image new_image(const Context &context) {
    const std::vector<float> pixels(4 * 3 * 3, 0.5f);
    return ok(Image::create(context, luxfer::ConstImageView(pixels, 4, 3)));
}

// Creates a scene with a floor, a lamp above it and a camera.
Scene new_scene(const Context &context) {
    const Scene scene = ok(Scene::create(context));
    luxfer::MaterialParams material;
    OK(scene.add_material(material));
    std::fill_n(material.emission, 3, 100.0f);
    const std::uint32_t glowing = ok(scene.add_material(material));
    CHECK(glowing == 1);
    const std::uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    const std::array<float, 12> floor = {-3, -1, -3, -3, -1, 3, 3, -1, 3, 3, -1, -3};
    const std::vector<float> lamp = {-1, 2, -1, -1, 2, 1, 1, 2, 1, 1, 2, -1};
    luxfer::MeshParams mesh(floor, indices);
    mesh.name = "Floor";
    OK(scene.add_mesh(mesh));
    mesh = luxfer::MeshParams(lamp, indices, glowing);
    mesh.name = "Lamp";
    OK(scene.add_mesh(mesh));
    OK(scene.add_camera());
    return scene;
}

Render new_render(const Context &context) {
    const Render render = ok(Render::create(context));
    OK(render.set_scene(new_scene(context)));
    return render;
}

Job start(const Render &render, std::uint32_t samples) {
    luxfer::RenderParams params;
    params.width = params.height = 16;
    params.samples = samples;
    return ok(render.start(params));
}

// Compatibility of a library (first argument) with a header: before 1.0, their minor versions must be equal; from 1.0
// on, their major versions, and the library must not be older than the header.
static_assert(luxfer::is_compatible(LUXFER_VERSION, LUXFER_VERSION));
static_assert(luxfer::is_compatible(103, 101) && luxfer::is_compatible(101, 103) && !luxfer::is_compatible(201, 101));
static_assert(!luxfer::is_compatible(10000, 101) && !luxfer::is_compatible(101, 10000));
static_assert(luxfer::is_compatible(10203, 10100) && !luxfer::is_compatible(10100, 10203) &&
              !luxfer::is_compatible(20000, 10000));

// A handle holds two pointers: its own and that of its context.
static_assert(sizeof(Image) == 2 * sizeof(void *) && sizeof(luxfer::RenderParams) == sizeof(luxfer_render_params));
static_assert(std::is_nothrow_move_constructible_v<Image> && std::is_nothrow_move_assignable_v<Image>);

void moved_from_handles_are_empty() {
    const Context context = new_context();
    Image image = new_image(context);
    luxfer_image *const c = image.get();
    Image moved = std::move(image);
    CHECK(moved.get() == c && moved && !image && image.get() == nullptr && !image.context());
    CHECK_ERROR(image.size(), LUXFER_INVALID_ARGUMENT);
    CHECK_ERROR(Image().size(), LUXFER_INVALID_ARGUMENT);
    CHECK(std::strstr(error_of([&] { return image.size(); }).what(), "empty") != nullptr);
    CHECK_ERROR(Image::create(Context(), luxfer::ConstImageView()), LUXFER_INVALID_ARGUMENT);
    image = std::move(moved);
    CHECK(image.get() == c && ok(image.size()).width == 4);
    Image &self = image;
    image = self;
    CHECK(image.get() == c && ok(image.size()).height == 3);
    image = Image();
    CHECK(!image);
}

// A memory budget of 1 MiB has room for one image only, so a failing call shows that the previous image is still
// alive.
void copies_share_and_the_last_one_releases() {
    luxfer::ContextParams params;
    params.memory_budget_mib = 1;
    const Context context = ok(Context::create(params));
    const std::vector<float> pixels(256 * 256 * 3);
    const auto fill = [&] { return Image::create(context, luxfer::ConstImageView(pixels, 256, 256)); };
    Image first = ok(fill());
    Image copy = first;
    CHECK(copy.get() == first.get());
    CHECK_ERROR(fill(), LUXFER_OUT_OF_MEMORY);
    first = Image();
    CHECK(ok(copy.size()).width == 256);
    CHECK_ERROR(fill(), LUXFER_OUT_OF_MEMORY);
    copy = Image();
    first = ok(fill());

    // The wrapper can take over a C handle of the caller.
    CHECK_OK(luxfer_retain(first.get()));
    Image adopted(context, first.get());
    first = Image();
    CHECK(ok(adopted.size()).width == 256);
    adopted = Image();
    OK(fill());
}

void any_order_of_release() {
    std::optional<Context> context = new_context();
    std::optional<Scene> scene = new_scene(*context);
    std::optional<Render> render = ok(Render::create(*context));
    OK(render->set_scene(*scene));
    context.reset();
    scene.reset();
    std::optional<Job> job = start(*render, 4);
    std::optional<Render> gone = std::move(render);
    OK(job->wait());
    const Image image = ok(gone->image());
    gone.reset();
    job.reset();
    CHECK(ok(image.samples()).size() == 16 * 16 * 3);
    // The image keeps the context alive, so errors still have messages.
    CHECK(std::strlen(error_of([&] { return image.save("picture.xyz"); }).what()) > 20);
    // Destroying the handle of a running job ends the job.
    const Render other = new_render(image.context());
    start(other, endless);
    start(other, 1);
}

void errors_have_status_and_words() {
    const Context context = new_context();
    const luxfer::Error error = error_of([&] { return Image::load(context, "/nonexistent/photo.png"); });
    CHECK_STATUS(error.status(), LUXFER_IO);
    CHECK(std::strcmp(error.name(), "LUXFER_IO") == 0);
    CHECK(std::strstr(error.what(), "/nonexistent/photo.png") != nullptr);
    CHECK(ok(context.last_error()) == error.what());

    // Each thread has its own latest error.
    std::thread([&] {
        CHECK(ok(context.last_error()).empty());
        CHECK(std::strstr(error_of([&] { return Scene::load(context, std::string("other.glb")); }).what(), "other.glb"));
    }).join();
    CHECK(ok(context.last_error()) == error.what());

    // The thread that waits for a job gets its error.
    const luxfer::Transfer transfer = ok(luxfer::Transfer::create(context));
    CHECK_ERROR(transfer.start(LUXFER_STAGE_VIEW, LUXFER_STAGE_VIEW), LUXFER_INVALID_OPERATION);
    OK(transfer.set_photo(new_image(context)));
    const Job job = ok(transfer.start(LUXFER_STAGE_VIEW, LUXFER_STAGE_VIEW));
    CHECK(std::strstr(error_of([&] { return job.wait(); }).what(), "lines") != nullptr);
    CHECK_STATUS(ok(job.poll()).outcome, LUXFER_DEGENERATE);
    CHECK_ERROR(job.wait_for(std::chrono::seconds(9)), LUXFER_DEGENERATE);

    // A job of several transfers names the transfer that fails.
    const std::array<luxfer::Transfer, 2> planes = {ok(luxfer::Transfer::create(context)),
                                                    ok(luxfer::Transfer::create(context))};
    CHECK_ERROR(luxfer::Transfer::start_all(context, {}), LUXFER_INVALID_ARGUMENT);
    OK(planes[0].set_photo(new_image(context)));
    const luxfer::Error unfit = error_of(
        [&] { return luxfer::Transfer::start_all(context, planes, LUXFER_STAGE_FEATURES, LUXFER_STAGE_FEATURES); });
    CHECK(std::strstr(unfit.what(), "transfers[1]") != nullptr);
    OK(planes[1].set_photo(new_image(context)));
    const std::array<luxfer::TransferParams, 2> settings;
    OK(ok(luxfer::Transfer::start_all(context, planes, LUXFER_STAGE_FEATURES, LUXFER_STAGE_FEATURES, settings)).wait());
    CHECK(ok(planes[1].image(LUXFER_TRANSFER_FEATURES)).get() != nullptr);

    luxfer::ContextParams bad;
    bad.num_threads = 5000;
    CHECK_ERROR(Context::create(bad), LUXFER_INVALID_ARGUMENT);
    CHECK_ERROR(ok(Scene::create(context)).intersect(luxfer::Span<const luxfer_ray>(nullptr, 1), {}), LUXFER_INVALID_ARGUMENT);
}

void settings_start_with_the_defaults() {
    luxfer_render_params c;
    CHECK_OK(luxfer_render_params_init(&c, sizeof c));
    const luxfer::RenderParams params;
    CHECK(std::memcmp(&c, static_cast<const luxfer_render_params *>(&params), sizeof c) == 0);
    CHECK(luxfer::StylizeParams(LUXFER_STYLIZE_PREVIEW).preview == 1 && luxfer::StylizeParams().preview == 0);
    CHECK(luxfer::StylizeParams(-1).struct_size == 0);
}

void jobs_report_and_are_cancelled() {
    const Context context = new_context();
    const Render render = new_render(context);
    double last = -1;
    OK(start(render, 4).wait([&](double fraction) {
        CHECK(fraction >= last);
        last = fraction;
        return true;
    }));
    CHECK(last == 1.0);

    const Job job = start(render, endless);
    CHECK(!ok(job.wait_for(std::chrono::milliseconds(1))));
    CHECK(!ok(job.poll()).is_finished() && ok(job.poll()).outcome == LUXFER_NOT_READY);
    CHECK_ERROR(render.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(job.wait([](double) { return false; }), LUXFER_CANCELLED);
    CHECK(ok(job.poll()).is_finished() && ok(job.poll()).outcome == LUXFER_CANCELLED);
    CHECK_ERROR(job.wait_for(std::chrono::milliseconds(-1)), LUXFER_CANCELLED);

    // Run functions of the caller as jobs: check their results and errors, and that cancelling the job also cancels
    // the job for which its function waits.
    std::atomic<int> runs{0};
    OK(ok(Job::start(context, [&]() -> luxfer::Result<> {
        ++runs;
        return ok(render.start()).wait();
    })).cancel());
    const Job fails = ok(Job::start(context, [&]() -> luxfer::Result<> {
        ++runs;
        return luxfer::detail::to_result(context.get(), luxfer_image_save(nullptr, "no.png", 1));
    }));
    CHECK_ERROR(fails.wait(), LUXFER_INVALID_ARGUMENT);
    CHECK(runs >= 1);

    const Job other = start(render, endless);
    OK(other.cancel());
    CHECK_ERROR(other.wait(), LUXFER_CANCELLED);
    CHECK(ok(start(render, 1).wait_for(std::chrono::hours(1000))));
}

#ifndef LUXFER_NO_EXCEPTIONS

struct Interrupted {
    int code;
};

void exceptions_cross_the_callbacks() {
    const Context context = new_context();
    const Render render = new_render(context);
    const Job job = start(render, endless);
    // Two threads wait for one job. The exception reaches the thread whose callback threw it; the other thread gets
    // LUXFER_CANCELLED.
    std::thread other([&] { CHECK_ERROR(job.wait(), LUXFER_CANCELLED); });
    int calls = 0, code = 0;
    try {
        job.wait([&](double) -> bool { throw Interrupted{++calls}; });
    } catch (const Interrupted &interrupted) {
        code = interrupted.code;
    }
    other.join();
    CHECK(calls == 1 && code == 1);
    CHECK(ok(job.poll()).outcome == LUXFER_CANCELLED);

    const Scene scene = new_scene(context);
    code = 0;
    try {
        scene.write([](const void *, std::size_t) -> bool { throw Interrupted{7}; });
    } catch (const Interrupted &interrupted) {
        code = interrupted.code;
    }
    CHECK(code == 7);
}

#endif

/// A TIFF with one row of two grey pixels. Its metadata: camera rotated by 90 degrees, 36 mm equivalent focal length,
/// f/2, 1/50 s, ISO 100.
std::vector<std::uint8_t> turned_photo() {
    std::vector<std::uint8_t> file = {'I', 'I', 42, 0, 8, 0, 0, 0};
    const auto put = [&](std::uint32_t value, int bytes) {
        for (int k = 0; k < bytes; ++k)
            file.push_back(static_cast<std::uint8_t>(value >> 8 * k));
    };
    // Entries of tag, type and value: those of the picture, then those of the camera (EXIF), whose fractions follow.
    const std::uint32_t picture[][3] = {{256, 3, 2}, {257, 3, 1}, {258, 3, 8},   {262, 3, 1},
                                        {273, 4, 200}, {274, 3, 6}, {279, 4, 2}, {0x8769, 4, 120}};
    const std::uint32_t camera[][3] = {{0x829a, 5, 184}, {0x829d, 5, 192}, {0x8827, 3, 100}, {0xa405, 3, 36}};
    const auto directory = [&](const auto &entries) {
        put(static_cast<std::uint32_t>(std::size(entries)), 2);
        for (const auto &entry : entries) {
            put(entry[0], 2), put(entry[1], 2), put(1, 4), put(entry[2], 4);
        }
    };
    directory(picture);
    file.resize(120);
    directory(camera);
    file.resize(184);
    put(1, 4), put(50, 4), put(2, 4), put(1, 4);
    put(0, 1), put(255, 1);
    return file;
}

void photos_say_what_their_cameras_wrote() {
    const Context context = new_context();
    const Image photo = ok(Image::load_memory(context, turned_photo()));
    const luxfer::ImageSize size = ok(photo.size());
    CHECK(size.width == 1 && size.height == 2 && ok(photo.samples())[1] == 1.0f);
    const luxfer_photo_metadata known = ok(photo.metadata());
    CHECK(known.orientation == 6 && known.f_number == 2 && known.exposure_time == 0.02 && known.iso == 100);
    CHECK(std::abs(known.focal - 36 * std::sqrt(5) / std::hypot(36, 24)) < 1e-9 && known.focal_error < 0.1 * known.focal);
    CHECK(std::abs(known.white_luminance - 240) < 1e-9);
    CHECK(known.white_luminance_low < 240 && known.white_luminance_high > 240);

    const luxfer_photo_metadata nothing = ok(new_image(context).metadata());
    CHECK(known.colour == LUXFER_FILE_COLOUR_ASSUMED && nothing.colour == LUXFER_FILE_COLOUR_NONE);
    CHECK(nothing.orientation == 1 && nothing.focal == 0 && nothing.white_luminance == 0);
}

void views_of_memory() {
    const Context context = new_context();
    std::uint8_t bytes[2 * 2] = {0, 255, 128, 64};
    const Image image = ok(Image::create(context, luxfer::ConstImageView(bytes, 2, 2, 1)));
    const std::vector<float> samples = ok(image.samples());
    CHECK(samples.size() == 4 && samples[1] == 1.0f && std::abs(samples[2] - 128.0f / 255.0f) < 1e-6f);
    std::array<std::uint16_t, 4> wide = {};
    OK(image.read(luxfer::ImageView(wide, 2, 2, 1)));
    CHECK(wide[0] == 0 && wide[1] == 65535 && wide[3] == 64 * 257);

    // Read with the lower row first, into the first byte of every four.
    std::uint8_t strided[16] = {};
    luxfer::ImageView view(strided, 2, 2, 1);
    view.flags = LUXFER_VIEW_BOTTOM_UP;
    view.pixel_stride = 4;
    OK(image.read(view));
    CHECK(strided[0] == 128 && strided[4] == 64 && strided[12] == 255 && strided[1] == 0);
    CHECK_ERROR(image.read(luxfer::ImageView(luxfer::Span<float>(nullptr, 4), 2, 2, 1)), LUXFER_INVALID_ARGUMENT);
    CHECK_ERROR(Image::create(context, luxfer::ConstImageView(samples, 2, 3, 1)), LUXFER_INVALID_ARGUMENT);

    const std::array<double, 8> square = {0, 0, 1, 0, 1, 1, 0, 1};
    const std::array<double, 9> identity = ok(luxfer::homography_from_corners(context, square, square));
    CHECK(std::abs(identity[0] - identity[8]) < 1e-12 && std::abs(identity[1]) < 1e-12);
    CHECK(ok(ok(image.warp(identity, 2, 2)).samples()) == samples);
}

// Merges two exposures of one view: what the long one clips comes from the short one.
void exposures_merge() {
    const Context context = new_context();
    const std::vector<float> bright = {0.2f, 0.4f, 1.0f, 0.1f}, dark = {0.05f, 0.1f, 0.5f, 0.025f};
    const std::array<Image, 2> photos = {ok(Image::create(context, luxfer::ConstImageView(bright, 2, 2, 1))),
                                         ok(Image::create(context, luxfer::ConstImageView(dark, 2, 2, 1)))};
    luxfer::MergeParams params;
    params.exposures[0] = 4;
    params.exposures[1] = 1;
    params.reference = 0;
    const Image::Merged merged = ok(Image::merge_exposures(context, photos, params));
    const std::vector<float> samples = ok(merged.image.samples());
    CHECK(std::abs(samples[0] - 0.2f) < 1e-6f && std::abs(samples[2] - 2.0f) < 1e-6f);
    CHECK(merged.report.count == 2 && merged.report.exposures[1] == 0.25 && merged.report.clipped == 0);
    CHECK(merged.report.tone_curve == LUXFER_TONE_CURVE_SRGB && merged.report.tone_curve_light[16] == 1);
    CHECK_ERROR(Image::merge_exposures(context, {}), LUXFER_INVALID_ARGUMENT);
}

// Writes a scene to a file in memory and reads it back.
void scenes_come_back() {
    const Context context = new_context();
    const Scene scene = new_scene(context);
    std::vector<unsigned char> file;
    OK(scene.write([&](const void *data, std::size_t size) {
        const auto *first = static_cast<const unsigned char *>(data);
        file.insert(file.end(), first, first + size);
        return true;
    }));
    CHECK_ERROR(scene.write([](const void *, std::size_t) { return false; }), LUXFER_IO);
    const Scene copy = ok(Scene::load_memory(context, file));
    CHECK(ok(ok(copy.warnings()).count()) == 0);
    luxfer::SceneLoadParams in_hundreds;
    in_hundreds.unit = 100;
    const Scene large = ok(Scene::load_memory(context, file, nullptr, in_hundreds));
    CHECK(ok(ok(large.warnings()).warning(0)).code == LUXFER_WARNING_IMPLAUSIBLE_SIZE);
    const luxfer::Candidates candidates = ok(copy.candidates());
    CHECK(ok(candidates.count()) > 2);
    const luxfer_candidate likeliest = ok(candidates.candidate(0));
    CHECK(std::string(likeliest.name) == "Lamp" && likeliest.kind == LUXFER_CANDIDATE_OBJECT && likeliest.index == 1);
    CHECK(likeliest.level_area == likeliest.area && likeliest.score > 0);
    CHECK(std::string(likeliest.reason).find("level") != std::string::npos);
    CHECK_ERROR(candidates.candidate(99), LUXFER_NOT_FOUND);
    const luxfer_scene_counts counts = ok(copy.counts());
    CHECK(counts.meshes == 2 && counts.cameras == 1 && counts.triangles == 4);
    CHECK(ok(copy.mesh_name(0)) == "Floor" && ok(copy.mesh_name(1)) == "Lamp");
    CHECK(ok(copy.material(ok(copy.mesh(1)).material)).emission[0] == 100.0f);
    std::vector<float> positions(12);
    std::vector<std::uint32_t> indices(6);
    OK(copy.read_vertices(0, LUXFER_VERTEX_POSITION, positions));
    OK(copy.read_triangles(0, indices));
    CHECK(positions[1] == -1.0f && indices[5] == 3);
    for (const luxfer_vertex_attribute lacking : {LUXFER_VERTEX_NORMAL, LUXFER_VERTEX_UV_0, LUXFER_VERTEX_COLOUR})
        CHECK_ERROR(copy.read_vertices(0, lacking, positions), LUXFER_NOT_FOUND);
    CHECK_ERROR(copy.read_triangles(2, indices), LUXFER_NOT_FOUND);
    CHECK(ok(copy.mesh(0)).has_colours == 0);
    CHECK(ok(copy.material_texture(0, LUXFER_TEXTURE_NORMAL)).texture == LUXFER_NONE);
    CHECK_ERROR(copy.texture(0), LUXFER_NOT_FOUND);

    const luxfer_surface floor = ok(copy.find_surface("Floor"));
    CHECK(std::abs(floor.area - 36) < 1e-4f && floor.normal[1] > 0.99f);
    const luxfer_ray down[] = {{{2, 1, 2}, {0, -1, 0}, 10}};
    luxfer_hit hit[1];
    OK(copy.intersect(down, hit));
    CHECK(hit[0].mesh == 0 && hit[0].t == 2.0f);
    CHECK(ok(copy.requirements()).lights == LUXFER_LIGHTS_SURFACE);
    OK(copy.requirements_text());
    OK(copy.set_environment({1, 2, 3}));
    CHECK((ok(copy.requirements()).lights & LUXFER_LIGHTS_ENVIRONMENT) != 0);
    luxfer_material_params lamp = ok(copy.material(1));
    lamp.emission[0] = 2;
    OK(copy.set_material(1, lamp));
    CHECK(ok(copy.material(1)).emission[0] == 2.0f);
    OK(copy.add_light());
    OK(copy.set_camera(0, luxfer::CameraParams()));
    CHECK(ok(copy.camera(0)).fov_y == 1.0f);
}

void layers_have_names() {
    const Context context = new_context();
    const Render render = new_render(context);
    CHECK(std::strstr(error_of([&] { return render.add_expression("slip", "LDXE"); }).what(), "column 3") != nullptr);
    OK(render.add_expression("direct", "C<RD>L"));
    OK(render.set_aovs(LUXFER_AOV_DEPTH));
    OK(render.clear_camera());
    OK(start(render, 4).wait());
    CHECK(ok(render.layer_count()) == 2 && ok(render.layer_name(0)) == "direct" && ok(render.layer_name(1)) == "Depth");
    CHECK(ok(ok(render.layer("Depth")).size()).channels == 1);
    CHECK_ERROR(render.layer("depth"), LUXFER_NOT_FOUND);
    CHECK(ok(render.report()).samples == 4);

    const luxfer::Illuminance illuminance = ok(luxfer::Illuminance::create(context));
    OK(illuminance.set_scene(new_scene(context)));
    luxfer::IlluminanceGrid grid;
    luxfer::IlluminanceParams few;
    few.columns = few.rows = 4;
    OK(ok(illuminance.start_grid(grid, few)).wait());
    CHECK(ok(illuminance.report()).points == 16 && ok(illuminance.report()).mean > 0);
}

void lights_have_names() {
    const Context context = new_context();
    const auto white = ok(luxfer::colour_temperature(context, {1, 1, 1}));
    CHECK(white.kelvin > 6480 && white.kelvin < 6530);
    const auto rgb = ok(luxfer::colour_of_temperature(context, white));
    CHECK(rgb[0] > 0.99 && rgb[0] < 1.01 && rgb[2] > 0.99 && rgb[2] < 1.01);
    CHECK_ERROR(luxfer::colour_temperature(context, {0, 0, 0}), LUXFER_DEGENERATE);
    CHECK(ok(luxfer::glare(new_image(context), 1)).threshold >= 0);
    luxfer::GlareParams fisheye;
    fisheye.projection = LUXFER_PROJECTION_ANGULAR;
    fisheye.vertical_illuminance = 2000;
    CHECK(ok(luxfer::glare(new_image(context), fisheye)).dgp > 0.27);
    fisheye.projection = 7;
    CHECK_ERROR(luxfer::glare(new_image(context), fisheye), LUXFER_INVALID_ARGUMENT);
    const std::array<luxfer_observer, 2> observers = {{{{0, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {1, 0, 0}}}};
    const luxfer::Scene dark = ok(luxfer::Scene::create(context));
    const std::vector<luxfer_observer_glare> ratings = ok(luxfer::glare(dark, observers, 16));
    CHECK(ratings.size() == 2 && ratings[0].sources == 0 && ratings[1].ugr < 0);
    CHECK_ERROR(luxfer::measure_distribution(dark), LUXFER_DEGENERATE);
    const auto mixture = ok(luxfer::mix_primaries(context, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0.5, 0.25, 2}, 1));
    CHECK(mixture.light.in_gamut == 0 && mixture.drives.size() == 3 && mixture.drives[2] == 1);
    CHECK_ERROR(luxfer::mix_primaries(context, {}, {1, 1, 1}), LUXFER_INVALID_ARGUMENT);
    const auto fit = ok(luxfer::fit_temperature(context, {1, 1, 1}, {0, 0, 0}, {9, 9, 9}));
    CHECK(fit.kelvin > 6000 && fit.kelvin < 7000 && fit.luminance > 8 && fit.delta_e < 5);
    CHECK(ok(luxfer::preset_count(context)) > 1 && ok(luxfer::preset(context, 0)).illuminance == 500);
    CHECK(std::strstr(ok(luxfer::preset(context, 0)).name, "office") != nullptr);
    CHECK_ERROR(luxfer::preset(context, 1000), LUXFER_NOT_FOUND);
    luxfer::FalseColourParams range;
    range.maximum = 10;
    CHECK(ok(ok(luxfer::false_colour(new_image(context), range)).size()).width > ok(new_image(context).size()).width);
    const char *panel = "IESNA:LM-63-2002\n[LUMINAIRE] Panel\nTILT=NONE\n"
                        "1 -1 1 3 1 1 2 0.6 0.6 0\n1 1 30\n0 45 90\n0\n1000 707 0\n";
    const auto file = ok(luxfer::Distribution::load(context, panel, LUXFER_DISTRIBUTION_IES));
    CHECK(ok(file.name()) == "Panel" && ok(file.report()).watts == 30 && ok(file.intensity(90, 0)) == 1000);
    const auto again = ok(luxfer::Distribution::load_memory(context, std::string(panel)));
    CHECK(ok(again.report()).flux == ok(file.report()).flux && ok(again.report()).variants == 1);
    CHECK_ERROR(luxfer::Distribution::load_memory(context, std::string("PK\x03\x04")), LUXFER_FORMAT);
    CHECK_ERROR(luxfer::Distribution::load(context, "no such.ies"), LUXFER_IO);
    const Scene hall = ok(Scene::create(context));
    CHECK(ok(luxfer::add_luminaire(hall, file)) == 0);
    luxfer::LuminaireParams along;
    along.axis[0] = along.c0[0];
    along.axis[1] = 0;
    CHECK_ERROR(luxfer::add_luminaire(hall, file, along), LUXFER_INVALID_ARGUMENT);
}

// Asks each stage for results before it has any: the error shows that each method calls its C function.
void stages_say_what_they_lack() {
    const Context context = new_context();
    const auto rectify = ok(luxfer::Rectify::create(context));
    const auto features = ok(luxfer::Features::create(context));
    const auto segment = ok(luxfer::Segment::create(context));
    const auto emission = ok(luxfer::Emission::create(context));
    const auto relight = ok(luxfer::Relight::create(context));
    const auto lamps = ok(luxfer::Lamps::create(context));
    const auto importance = ok(luxfer::Importance::create(context));
    const auto transfer = ok(luxfer::Transfer::create(context));
    const auto guides = ok(luxfer::Guides::create(context));
    const auto demo = ok(luxfer::DemoPhoto::create(context));
    CHECK_ERROR(rectify.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(features.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(segment.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(emission.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(relight.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(lamps.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(lamps.add_mesh(0, LUXFER_QUANTITY_OUTGOING, {1, 1, 1}), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(lamps.set_constraint(0, LUXFER_CONSTRAINT_AT_LEAST), LUXFER_NOT_FOUND);
    CHECK_ERROR(lamps.set_levels({0, 0.5, -1}), LUXFER_INVALID_ARGUMENT);
    CHECK_ERROR(importance.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(guides.start(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(rectify.report(), LUXFER_NOT_READY);
    CHECK_ERROR(features.set_view(rectify), LUXFER_NOT_READY);
    CHECK_ERROR(segment.image(LUXFER_SEGMENT_MASK), LUXFER_NOT_READY);
    CHECK_ERROR(emission.corner(0, 0), LUXFER_NOT_READY);
    CHECK_ERROR(emission.start_composition(), LUXFER_INVALID_OPERATION);
    CHECK_ERROR(emission.render_tile(0, 0, 1, 1), LUXFER_NOT_READY);
    CHECK_ERROR(emission.add_style(Image(), Image(), Image(), 1, Image()), LUXFER_INVALID_ARGUMENT);
    OK(emission.clear_styles());
    OK(transfer.set_triangles({0, 0}));
    CHECK_ERROR(relight.report(), LUXFER_NOT_READY);
    CHECK_ERROR(lamps.report(), LUXFER_NOT_READY);
    CHECK_ERROR(lamps.texture(), LUXFER_NOT_READY);
    CHECK_ERROR(lamps.reason(), LUXFER_NOT_READY);
    CHECK_ERROR(importance.respond(new_image(context)), LUXFER_NOT_READY);
    CHECK_ERROR(importance.start_placement(new_image(context)), LUXFER_NOT_READY);
    CHECK_ERROR(importance.placement(), LUXFER_NOT_READY);
    CHECK_ERROR(transfer.scene(), LUXFER_NOT_READY);
    CHECK_ERROR(transfer.use(LUXFER_PHASE_PLANE, segment), LUXFER_NOT_READY);
    CHECK_ERROR(transfer.use(features), LUXFER_NOT_READY);
    CHECK_ERROR(guides.demo_artwork(LUXFER_ARTWORK_PEN), LUXFER_NOT_READY);
    CHECK_ERROR(demo.image(LUXFER_DEMO_PHOTO_PICTURE), LUXFER_NOT_READY);
    CHECK_ERROR(luxfer::Sheet::align(new_image(context), 8, 8), LUXFER_DEGENERATE);

    // An empty object is passed as NULL: it removes optional input, and is an error where an object is required.
    OK(rectify.set_mask(Image()));
    OK(features.set_depth(Image()));
    OK(features.clear_network());
    OK(features.set_strokes(luxfer::Strokes()));
    CHECK_ERROR(features.set_network("absent.onnx"), LUXFER_IO);
    CHECK_ERROR(features.set_network("absent.onnx", 9), LUXFER_INVALID_ARGUMENT);
    OK(emission.clear_photo());
    OK(transfer.clear_camera());
    CHECK_ERROR(rectify.set_photo(Image()), LUXFER_INVALID_ARGUMENT);
    CHECK_ERROR(transfer.set_scene(Scene(), "Ceiling"), LUXFER_INVALID_ARGUMENT);

    const float points[] = {0.5f, 0.5f, 3.5f, 2.5f};
    const luxfer::Strokes strokes = ok(luxfer::Strokes::create(context, 5, 7));
    OK(strokes.add(LUXFER_PHASE_PLANE, points, 1, true));
    CHECK_ERROR(strokes.add(2, points, 1, true), LUXFER_INVALID_ARGUMENT);
    CHECK_ERROR(strokes.add("plane one"), LUXFER_FORMAT);
    CHECK_ERROR(luxfer::Strokes::create(context, 0, 7), LUXFER_INVALID_ARGUMENT);
    CHECK_ERROR(luxfer::Strokes::from_image(Image()), LUXFER_INVALID_ARGUMENT);
    OK(segment.set_strokes(LUXFER_PHASE_PLANE, strokes));
    OK(segment.set_features(new_image(context)));
    CHECK_ERROR(segment.set_strokes(LUXFER_PHASE_PLANE, strokes), LUXFER_INVALID_ARGUMENT);
}

} // namespace

int main() {
    moved_from_handles_are_empty();
    copies_share_and_the_last_one_releases();
    any_order_of_release();
    errors_have_status_and_words();
    settings_start_with_the_defaults();
    jobs_report_and_are_cancelled();
#ifndef LUXFER_NO_EXCEPTIONS
    exceptions_cross_the_callbacks();
#endif
    photos_say_what_their_cameras_wrote();
    views_of_memory();
    exposures_merge();
    scenes_come_back();
    layers_have_names();
    lights_have_names();
    stages_say_what_they_lack();
    return check::summary("wrapper");
}
