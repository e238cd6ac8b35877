// Contract of the C boundary for a C++ program that uses the header and the shared library as a plug-in does. Tests
// what needs a real C or C++ caller: linkage, macros, threads of the host, and callbacks that call the library. The
// rest is in tests/abi/contract.rs. The program calls the C functions, because bindings/cpp would prevent wrong
// handles and early releases.
#include "check.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <thread>
#include <vector>

namespace {

luxfer_context *new_context(std::uint32_t threads) {
    luxfer_context_params params;
    CHECK_OK(luxfer_context_params_init(&params, sizeof params));
    params.num_threads = threads;
    luxfer_context *context = nullptr;
    CHECK_OK(luxfer_context_create(&params, &context));
    return context;
}

luxfer_image *new_image(luxfer_context *context, std::uint32_t width, std::uint32_t height) {
    std::vector<float> pixels(std::size_t(width) * height * 3, 0.5f);
    luxfer_image_view view;
    CHECK_OK(luxfer_image_view_init(&view, sizeof view));
    view.width = width;
    view.height = height;
    view.data = pixels.data();
    view.byte_size = pixels.size() * sizeof(float);
    luxfer_image *image = nullptr;
    CHECK_OK(luxfer_image_create(context, &view, &image));
    return image;
}

// Creates a scene with a floor, a lamp above it and a camera.
luxfer_scene *new_scene(luxfer_context *context) {
    luxfer_scene *scene = nullptr;
    CHECK_OK(luxfer_scene_create(context, &scene));
    luxfer_material_params material;
    CHECK_OK(luxfer_material_params_init(&material, sizeof material));
    CHECK_OK(luxfer_scene_add_material(scene, &material, nullptr));
    for (float &channel : material.emission)
        channel = 100.0f;
    std::uint32_t glowing = 0;
    CHECK_OK(luxfer_scene_add_material(scene, &material, &glowing));

    const std::uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    for (int i = 0; i < 2; ++i) {
        const float y = i == 0 ? -1.0f : 2.0f, r = i == 0 ? 3.0f : 0.5f;
        const float corners[] = {-r, y, -r, -r, y, r, r, y, r, r, y, -r};
        luxfer_mesh_params mesh;
        CHECK_OK(luxfer_mesh_params_init(&mesh, sizeof mesh));
        mesh.name = i == 0 ? "Floor" : "Lamp";
        mesh.material = i == 0 ? 0 : glowing;
        mesh.vertex_count = 4;
        mesh.positions = corners;
        mesh.triangle_count = 2;
        mesh.indices = triangles;
        CHECK_OK(luxfer_scene_add_mesh(scene, &mesh, nullptr));
    }
    CHECK_OK(luxfer_scene_add_camera(scene, nullptr, nullptr));
    return scene;
}

luxfer_render *new_render(luxfer_context *context) {
    luxfer_scene *scene = new_scene(context);
    luxfer_render *render = nullptr;
    CHECK_OK(luxfer_render_create(context, &render));
    CHECK_OK(luxfer_render_set_scene(render, scene));
    CHECK_OK(luxfer_release(scene));
    return render;
}

luxfer_job *start(luxfer_render *render, std::uint32_t side, std::uint32_t samples) {
    luxfer_render_params params;
    CHECK_OK(luxfer_render_params_init(&params, sizeof params));
    params.width = params.height = side;
    params.samples = samples;
    luxfer_job *job = nullptr;
    CHECK_OK(luxfer_render_start(render, &params, &job));
    return job;
}

constexpr std::uint32_t endless = 1u << 20;

// An inline function of the header fills its struct with the defaults of this struct: the defaults of a larger struct
// would not fit, and a smaller struct could have one byte less.
template <class Struct> void check_initialiser(luxfer_status (*init)(Struct *, std::size_t)) {
    Struct settings;
    std::memset(&settings, 0xa5, sizeof settings);
    CHECK_OK(init(&settings, sizeof settings));
    CHECK(settings.struct_size == sizeof settings);
    CHECK_STATUS(init(&settings, sizeof settings - 1), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(init(nullptr, sizeof settings), LUXFER_INVALID_ARGUMENT);
}

void initialisers_fill_their_structs() {
    check_initialiser(luxfer_context_params_init);
    check_initialiser(luxfer_image_view_init);
    check_initialiser(luxfer_merge_params_init);
    check_initialiser(luxfer_scene_load_params_init);
    check_initialiser(luxfer_material_params_init);
    check_initialiser(luxfer_mesh_params_init);
    check_initialiser(luxfer_camera_params_init);
    check_initialiser(luxfer_light_params_init);
    check_initialiser(luxfer_luminaire_params_init);
    check_initialiser(luxfer_render_params_init);
    check_initialiser(luxfer_rectify_params_init);
    check_initialiser(luxfer_features_params_init);
    check_initialiser(luxfer_segment_params_init);
    check_initialiser(luxfer_emission_params_init);
    check_initialiser(luxfer_relight_params_init);
    check_initialiser(luxfer_pattern_params_init);
    check_initialiser(luxfer_transfer_params_init);
    check_initialiser(luxfer_illuminance_grid_init);
    check_initialiser(luxfer_illuminance_params_init);
    check_initialiser(luxfer_lamps_params_init);
    check_initialiser(luxfer_importance_params_init);
    check_initialiser(luxfer_placement_params_init);
    check_initialiser(luxfer_gonio_params_init);
    check_initialiser(luxfer_sun_params_init);
    check_initialiser(luxfer_sky_params_init);
    check_initialiser(luxfer_false_colour_params_init);
    check_initialiser(luxfer_pendants_params_init);
    check_initialiser(luxfer_guides_params_init);
    luxfer_stylize_params style;
    if (luxfer_stylize_params_init(&style, sizeof style) != LUXFER_UNSUPPORTED) // a build without stylisation
        check_initialiser(luxfer_stylize_params_init);
    check_initialiser(luxfer_sheet_params_init);
    check_initialiser(luxfer_plan_params_init);
    check_initialiser(luxfer_render_part_init);
    check_initialiser(luxfer_demo_photo_params_init);
}

void versions_agree() {
    CHECK(luxfer_get_version() == LUXFER_VERSION);
    const std::string text = std::to_string(LUXFER_VERSION_MAJOR) + "." + std::to_string(LUXFER_VERSION_MINOR) + "." +
                             std::to_string(LUXFER_VERSION_PATCH);
    CHECK(text == luxfer_get_version_string());
    CHECK(std::strcmp(luxfer_status_get_name(LUXFER_FORMAT), "LUXFER_FORMAT") == 0);
    CHECK(std::strcmp(luxfer_status_get_name(-5), "LUXFER_UNKNOWN") == 0);
}

void wrong_handles_are_errors() {
    luxfer_context *context = new_context(1);
    luxfer_image *image = new_image(context, 4, 4);
    CHECK_STATUS(luxfer_image_get_size(reinterpret_cast<luxfer_image *>(context), nullptr, nullptr, nullptr),
                 LUXFER_INVALID_ARGUMENT);
    std::uint64_t garbage[4] = {1, 2, 3, 4};
    CHECK_STATUS(luxfer_release(reinterpret_cast<luxfer_image *>(garbage)), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_retain(nullptr), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(luxfer_release(nullptr));
    CHECK_OK(luxfer_release(context));
    CHECK_OK(luxfer_release(image));
}

// Each host thread has its own latest error message.
void messages_belong_to_threads() {
    luxfer_context *context = new_context(1);
    std::vector<std::thread> hosts;
    std::atomic<int> wrong{0};
    for (int i = 0; i < 8; ++i)
        hosts.emplace_back([context, i, &wrong] {
            const std::string path = "/nonexistent/" + std::to_string(i) + ".png";
            for (int repeat = 0; repeat < 100; ++repeat) {
                luxfer_image *image = nullptr;
                if (luxfer_image_load(context, path.c_str(), LUXFER_COLOUR_SRGB, &image) != LUXFER_IO || image != nullptr ||
                    check::message(context).find(path) == std::string::npos)
                    ++wrong;
            }
        });
    for (std::thread &host : hosts)
        host.join();
    CHECK(wrong == 0);
    CHECK(check::message(context).empty());
    CHECK_OK(luxfer_release(context));
}

// Waits for a job; returns its outcome.
luxfer_status wait(luxfer_job *job, luxfer_progress_fn progress = nullptr, void *user = nullptr) {
    luxfer_status outcome = LUXFER_UNKNOWN;
    CHECK_OK(luxfer_job_wait(job, -1, progress, user, &outcome));
    return outcome;
}

// A progress callback may call any function, and may even release the job whose progress it receives.
struct Reentrant {
    luxfer_context *context;
    luxfer_render *render;
    luxfer_job *job;
    int calls;
};

std::int32_t reenter(void *user, double) {
    Reentrant &seen = *static_cast<Reentrant *>(user);
    ++seen.calls;
    double fraction = -1.0;
    luxfer_status outcome = -1;
    luxfer_image *image = nullptr;
    if (seen.calls == 1) {
        CHECK_OK(luxfer_job_get_progress(seen.job, &fraction));
        CHECK_OK(luxfer_job_wait(seen.job, 0, nullptr, nullptr, &outcome));
        CHECK(fraction >= 0.0 && fraction <= 1.0 && outcome >= LUXFER_OK);
        CHECK_STATUS(luxfer_image_load(seen.context, "/nonexistent", LUXFER_COLOUR_SRGB, &image), LUXFER_IO);
        CHECK_OK(luxfer_release(seen.render));
        CHECK_OK(luxfer_release(seen.context));
        CHECK_OK(luxfer_release(seen.job));
        return 1;
    }
    CHECK(false); // A callback must not be called again after it has asked to cancel.
    return 1;
}

void callbacks_may_call_back() {
    luxfer_context *context = new_context(2);
    luxfer_render *render = new_render(context);
    luxfer_job *job = start(render, 64, endless);
    Reentrant seen{context, render, job, 0};
    CHECK_STATUS(wait(job, reenter, &seen), LUXFER_CANCELLED);
    CHECK(seen.calls == 1);
}

// One thread releases a job while another thread, which has its own reference, cancels it.
void references_of_two_threads() {
    luxfer_context *context = new_context(2);
    for (int i = 0; i < 20; ++i) {
        luxfer_render *render = new_render(context);
        luxfer_job *job = start(render, 16, endless);
        CHECK_OK(luxfer_retain(job));
        std::thread other([job] {
            CHECK_OK(luxfer_job_cancel(job));
            CHECK_OK(luxfer_release(job));
        });
        CHECK_STATUS(wait(job), LUXFER_CANCELLED);
        CHECK_OK(luxfer_release(job));
        CHECK_OK(luxfer_release(render));
        other.join();
    }
    CHECK_OK(luxfer_release(context));
}

// Layers are requested by light path expressions and found by name. The message for a wrong expression states the
// column.
void layers_are_found_by_name() {
    luxfer_context *context = new_context(2);
    luxfer_render *render = new_render(context);
    CHECK_STATUS(luxfer_render_add_expression(render, "slip", "LDXE"), LUXFER_INVALID_ARGUMENT);
    char message[256];
    CHECK_OK(luxfer_context_get_last_error(context, message, sizeof message, nullptr));
    CHECK(std::strstr(message, "column 3") != nullptr);
    CHECK_OK(luxfer_render_add_expression(render, "direct", "C<RD>L"));
    CHECK_OK(luxfer_render_set_aovs(render, LUXFER_AOV_DEPTH));
    luxfer_job *job = start(render, 8, 4);
    CHECK_OK(wait(job));
    CHECK_OK(luxfer_release(job));
    std::uint32_t channels = 0;
    luxfer_image *image = nullptr;
    CHECK_OK(luxfer_render_get_layer(render, "Depth", &image));
    CHECK_OK(luxfer_image_get_size(image, nullptr, nullptr, &channels));
    CHECK(channels == 1);
    CHECK_OK(luxfer_release(image));
    CHECK_OK(luxfer_release(render));
    CHECK_OK(luxfer_release(context));
}

// A rendering with one thread and one with three threads are equal to the bit.
void threads_do_not_change_results() {
    std::vector<float> first;
    for (std::uint32_t threads : {1u, 3u}) {
        luxfer_context *context = new_context(threads);
        luxfer_render *render = new_render(context);
        luxfer_job *job = start(render, 32, 16);
        CHECK_OK(wait(job));
        luxfer_image *image = nullptr;
        CHECK_OK(luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &image));
        // The image keeps its pixels after everything else is released.
        CHECK_OK(luxfer_release(job));
        CHECK_OK(luxfer_release(render));
        CHECK_OK(luxfer_release(context));

        std::vector<float> pixels(32 * 32 * 3);
        luxfer_image_view view;
        CHECK_OK(luxfer_image_view_init(&view, sizeof view));
        view.width = view.height = 32;
        view.data = pixels.data();
        view.byte_size = pixels.size() * sizeof(float);
        CHECK_OK(luxfer_image_read(image, 0, &view));
        CHECK_OK(luxfer_release(image));
        if (first.empty())
            first = pixels;
        CHECK(std::memcmp(first.data(), pixels.data(), view.byte_size) == 0);
        CHECK(*std::max_element(pixels.begin(), pixels.end()) > 0.0f);
    }
}

} // namespace

int main() {
    initialisers_fill_their_structs();
    versions_agree();
    wrong_handles_are_errors();
    messages_belong_to_threads();
    callbacks_may_call_back();
    references_of_two_threads();
    layers_are_found_by_name();
    threads_do_not_change_results();
    return check::summary("abi_contract");
}
