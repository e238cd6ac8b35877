// Bad input through the C interface: each call ends with a status and with a message that gives a remedy, writes no
// output and leaks nothing, and the objects stay usable. The program calls the C functions and not bindings/cpp, so
// that it sees every status and every output.
#include "check.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace {

luxfer_context *context = nullptr;

// Whether the latest error message contains each of these words.
bool says(std::initializer_list<const char *> words) {
    const std::string text = check::message(context);
    for (const char *word : words)
        if (text.find(word) == std::string::npos) {
            std::fprintf(stderr, "  message: %s (no \"%s\")\n", text.c_str(), word);
            return false;
        }
    return !text.empty();
}

luxfer_image *picture(uint32_t width, uint32_t height, float (*value)(uint32_t, uint32_t)) {
    std::vector<float> pixels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) pixels.push_back(value(x, y));
    luxfer_image_view view;
    luxfer_image *image = nullptr;
    CHECK_OK(luxfer_image_view_init(&view, sizeof view));
    view.width = width;
    view.height = height;
    view.byte_size = pixels.size() * sizeof(float);
    view.data = pixels.data();
    CHECK_OK(luxfer_image_create(context, &view, &image));
    return image;
}

luxfer_status run(luxfer_transfer *transfer, luxfer_stage first, luxfer_stage last) {
    luxfer_job *job = nullptr;
    const luxfer_status started = luxfer_transfer_start(transfer, first, last, nullptr, &job);
    if (started != LUXFER_OK) return started;
    luxfer_status ended = LUXFER_UNKNOWN;
    CHECK_OK(luxfer_job_wait(job, -1, nullptr, nullptr, &ended));
    CHECK_OK(luxfer_release(job));
    return ended;
}

// Writing function for luxfer_scene_export_memory: appends the data to a vector of bytes.
int32_t append(void *user, const void *data, size_t size) {
    auto *bytes = static_cast<std::vector<unsigned char> *>(user);
    const auto *start = static_cast<const unsigned char *>(data);
    bytes->insert(bytes->end(), start, start + size);
    return 0;
}

void files() {
    luxfer_image *image = nullptr;
    CHECK_STATUS(luxfer_image_load(context, "no such file.png", LUXFER_COLOUR_SRGB, &image), LUXFER_IO);
    CHECK(says({"no such file.png"}));
    const unsigned char png[] = {0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a, 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0x7f, 0xff,
                                 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff, 8, 2, 0, 0, 0, 0, 0, 0, 0};
    // A width of 2^31 - 1 pixels exceeds the limit, whatever the rest of the file contains.
    CHECK_STATUS(luxfer_image_load_memory(context, png, sizeof png, LUXFER_COLOUR_SRGB, &image), LUXFER_UNSUPPORTED);
    CHECK_STATUS(luxfer_image_load_memory(context, "text", 4, LUXFER_COLOUR_SRGB, &image), LUXFER_FORMAT);
    CHECK(image == nullptr);

    // A valid GLB, truncated at many places, and with a wrong length in its header.
    luxfer_scene *room = nullptr, *scene = nullptr;
    std::vector<unsigned char> glb;
    CHECK_OK(luxfer_demo_create_scene(context, LUXFER_DEMO_TARGET_ROOM, &room));
    CHECK_OK(luxfer_scene_export_memory(room, append, &glb));
    for (size_t cut : {size_t{0}, size_t{1}, size_t{12}, size_t{19}, glb.size() / 4, glb.size() / 2, glb.size() - 1})
        CHECK_STATUS(luxfer_scene_load_memory(context, glb.data(), cut, nullptr, nullptr, &scene), LUXFER_FORMAT);
    std::vector<unsigned char> lying = glb;
    std::memset(&lying[12], 0xff, 4);
    CHECK_STATUS(luxfer_scene_load_memory(context, lying.data(), lying.size(), nullptr, nullptr, &scene), LUXFER_FORMAT);
    CHECK(scene == nullptr);
    CHECK_OK(luxfer_scene_load_memory(context, glb.data(), glb.size(), nullptr, nullptr, &scene));
    CHECK_OK(luxfer_release(scene));
    CHECK_OK(luxfer_release(room));
}

void vertices() {
    luxfer_scene *scene = nullptr;
    CHECK_OK(luxfer_scene_create(context, &scene));
    CHECK_OK(luxfer_scene_add_material(scene, nullptr, nullptr));
    float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t indices[3] = {0, 1, 2};
    luxfer_mesh_params mesh;
    CHECK_OK(luxfer_mesh_params_init(&mesh, sizeof mesh));
    mesh.vertex_count = 3;
    mesh.positions = positions;
    mesh.triangle_count = 1;
    mesh.indices = indices;
    for (float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
        positions[4] = bad;
        CHECK_STATUS(luxfer_scene_add_mesh(scene, &mesh, nullptr), LUXFER_INVALID_ARGUMENT);
        CHECK(says({"position"}));
    }
    positions[4] = 0;
    indices[2] = 3;
    CHECK_STATUS(luxfer_scene_add_mesh(scene, &mesh, nullptr), LUXFER_INVALID_ARGUMENT);
    indices[2] = 2;
    CHECK_OK(luxfer_scene_add_mesh(scene, &mesh, nullptr));
    CHECK_OK(luxfer_release(scene));
}

void strokes_and_surfaces() {
    luxfer_transfer *transfer = nullptr;
    luxfer_scene *room = nullptr;
    CHECK_OK(luxfer_transfer_create(context, &transfer));
    CHECK_STATUS(run(transfer, LUXFER_STAGE_VIEW, LUXFER_STAGE_VIEW), LUXFER_INVALID_OPERATION);
    CHECK(says({"photo"}));

    // A uniform photo, in which no lines can be found.
    luxfer_image *grey = picture(96, 64, [](uint32_t, uint32_t) { return 0.5f; });
    CHECK_OK(luxfer_transfer_set_photo(transfer, grey));
    CHECK_STATUS(run(transfer, LUXFER_STAGE_VIEW, LUXFER_STAGE_VIEW), LUXFER_DEGENERATE);
    CHECK(says({"line"}));

    // NaN pixels are ignored.
    luxfer_image *noisy = picture(96, 64, [](uint32_t x, uint32_t y) {
        return x % 7 == 3 && y % 5 == 1 ? std::nanf("") : x > 48 ? 0.8f : 0.1f + 0.002f * float(y);
    });
    CHECK_OK(luxfer_transfer_set_photo(transfer, noisy));
    CHECK_OK(run(transfer, LUXFER_STAGE_FEATURES, LUXFER_STAGE_FEATURES));

    // Segment without strokes, then with strokes of one class only, then of both classes.
    CHECK_STATUS(run(transfer, LUXFER_STAGE_PLANE, LUXFER_STAGE_PLANE), LUXFER_DEGENERATE);
    CHECK(says({"stroke"}));
    const float right[] = {60, 10, 90, 50}, left[] = {10, 10, 40, 50};
    luxfer_strokes *strokes = nullptr;
    CHECK_OK(luxfer_strokes_create(context, 96, 64, &strokes));
    CHECK_OK(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, right, 2, 3, 1));
    CHECK_OK(luxfer_transfer_set_strokes(transfer, strokes));
    CHECK_STATUS(run(transfer, LUXFER_STAGE_PLANE, LUXFER_STAGE_PLANE), LUXFER_DEGENERATE);
    CHECK(says({"stroke"}));
    CHECK_OK(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, left, 2, 3, 0));
    CHECK_OK(luxfer_transfer_set_strokes(transfer, strokes));
    CHECK_OK(luxfer_release(strokes));
    CHECK_OK(run(transfer, LUXFER_STAGE_PLANE, LUXFER_STAGE_PLANE));

    // A misspelt surface name, and results that are requested too early.
    CHECK_OK(luxfer_demo_create_scene(context, LUXFER_DEMO_TARGET_ROOM, &room));
    luxfer_surface surface;
    CHECK_STATUS(luxfer_scene_find_surface(room, "Ceilling", &surface, sizeof surface), LUXFER_NOT_FOUND);
    CHECK(says({"Ceilling", "Ceiling"}));
    CHECK_OK(luxfer_transfer_set_scene(transfer, room, "Ceiling"));
    CHECK_STATUS(run(transfer, LUXFER_STAGE_RELIGHT, LUXFER_STAGE_RENDER), LUXFER_INVALID_OPERATION);
    CHECK(says({"Relight", "first"}));
    luxfer_image *early = nullptr;
    CHECK_STATUS(luxfer_transfer_get_image(transfer, LUXFER_TRANSFER_RENDER, &early), LUXFER_NOT_READY);

    // A relighting without a scene, and so without an emitter to solve for.
    luxfer_relight *relight = nullptr;
    luxfer_job *job = nullptr;
    CHECK_OK(luxfer_relight_create(context, &relight));
    CHECK_STATUS(luxfer_relight_start(relight, nullptr, &job), LUXFER_INVALID_OPERATION);
    CHECK(says({"luxfer_relight_set_scene"}));
    CHECK(job == nullptr && early == nullptr);

    CHECK_OK(luxfer_release(relight));
    CHECK_OK(luxfer_release(room));
    CHECK_OK(luxfer_release(transfer));
    CHECK_OK(luxfer_release(noisy));
    CHECK_OK(luxfer_release(grey));
}

} // namespace

int main() {
    CHECK_OK(luxfer_context_create(nullptr, &context));
    files();
    vertices();
    strokes_and_surfaces();
    CHECK_OK(luxfer_release(context));
    return check::summary("bad_input");
}
