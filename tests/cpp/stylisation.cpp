// Tests stylisation through the C interface in the order of a plug-in: guides of two scenes, an artwork, the sheet
// that is printed and aligned, and frames of a sequence. At each step, wrong input must be refused with a message that
// says why.
#include "check.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace {

constexpr uint32_t WIDTH = 96, HEIGHT = 72;
const float NAN_F = std::numeric_limits<float>::quiet_NaN();

luxfer_context *context = nullptr;

struct Size {
    uint32_t width = 0, height = 0, channels = 0;
};

Size size_of(luxfer_image *image) {
    Size size;
    CHECK_OK(luxfer_image_get_size(image, &size.width, &size.height, &size.channels));
    return size;
}

luxfer_image_view packed(Size size, std::vector<float> &pixels) {
    luxfer_image_view view;
    CHECK_OK(luxfer_image_view_init(&view, sizeof view));
    view.width = size.width;
    view.height = size.height;
    view.channels = size.channels;
    view.data = pixels.data();
    view.byte_size = pixels.size() * sizeof(float);
    return view;
}

std::vector<float> pixels_of(luxfer_image *image) {
    const Size size = size_of(image);
    std::vector<float> pixels(size_t{size.width} * size.height * size.channels);
    const luxfer_image_view view = packed(size, pixels);
    CHECK_OK(luxfer_image_read(image, 0, &view));
    return pixels;
}

luxfer_image *flat(Size size, float value) {
    std::vector<float> pixels(size_t{size.width} * size.height * size.channels, value);
    const luxfer_image_view view = packed(size, pixels);
    luxfer_image *image = nullptr;
    CHECK_OK(luxfer_image_create(context, &view, &image));
    return image;
}

luxfer_status finish(luxfer_job *job) {
    luxfer_status outcome = LUXFER_UNKNOWN;
    CHECK_OK(luxfer_job_wait(job, -1, nullptr, nullptr, &outcome));
    CHECK_OK(luxfer_release(job));
    return outcome;
}

luxfer_guides_params small_guides() {
    luxfer_guides_params params;
    CHECK_OK(luxfer_guides_params_init(&params, sizeof params));
    params.width = WIDTH;
    params.height = HEIGHT;
    params.samples = 4;
    return params;
}

luxfer_guides *rendered(luxfer_demo which, const luxfer_guides_params &params) {
    luxfer_scene *scene = nullptr;
    luxfer_guides *guides = nullptr;
    luxfer_job *job = nullptr;
    CHECK_OK(luxfer_demo_create_scene(context, which, &scene));
    CHECK_OK(luxfer_guides_create(context, &guides));
    CHECK_OK(luxfer_guides_set_scene(guides, scene));
    CHECK_OK(luxfer_guides_start(guides, &params, &job));
    CHECK_OK(finish(job));
    CHECK_OK(luxfer_release(scene));
    return guides;
}

luxfer_image *guide(luxfer_guides *guides, luxfer_guides_image which) {
    luxfer_image *image = nullptr;
    CHECK_OK(luxfer_guides_get_image(guides, which, &image));
    return image;
}

void guides_refuse() {
    luxfer_guides_params params = small_guides();
    luxfer_guides *guides = nullptr;
    luxfer_scene *scene = nullptr;
    luxfer_image *image = nullptr;
    luxfer_job *job = nullptr;
    CHECK_STATUS(luxfer_guides_params_init(nullptr, sizeof params), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_guides_params_init(&params, 3), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_guides_create(nullptr, &guides), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_guides_create(context, nullptr), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(luxfer_guides_create(context, &guides));
    CHECK_STATUS(luxfer_guides_set_scene(guides, nullptr), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_guides_start(guides, &params, &job), LUXFER_INVALID_OPERATION);
    CHECK_STATUS(luxfer_guides_get_image(guides, LUXFER_GUIDES_FULL, &image), LUXFER_NOT_READY);
    CHECK_STATUS(luxfer_guides_get_motion(guides, guides, &image), LUXFER_NOT_READY);
    CHECK_STATUS(luxfer_demo_create_artwork(guides, LUXFER_ARTWORK_PEN, &image), LUXFER_NOT_READY);

    CHECK_OK(luxfer_demo_create_scene(context, LUXFER_DEMO_SPHERE_ON_TABLE, &scene));
    CHECK_OK(luxfer_guides_set_scene(guides, scene));
    params.camera = 7;
    CHECK_STATUS(luxfer_guides_start(guides, &params, &job), LUXFER_NOT_FOUND);
    params = small_guides();
    params.smooth = 2;
    CHECK_STATUS(luxfer_guides_start(guides, &params, &job), LUXFER_INVALID_ARGUMENT);
    for (uint32_t *field : {&params.width, &params.height, &params.samples}) {
        params = small_guides();
        *field = 0;
        const luxfer_status started = luxfer_guides_start(guides, &params, &job);
        CHECK_STATUS(started == LUXFER_OK ? finish(job) : started, LUXFER_INVALID_ARGUMENT);
    }
    CHECK_STATUS(luxfer_demo_create_scene(context, 9, &scene), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(luxfer_release(scene));
    CHECK_OK(luxfer_release(guides));
    CHECK_OK(luxfer_release(nullptr));
}

void guides_tell_light_apart(luxfer_guides *guides) {
    for (luxfer_guides_image which = LUXFER_GUIDES_FULL; which <= LUXFER_GUIDES_CAUSTICS; ++which) {
        luxfer_image *image = guide(guides, which);
        const Size size = size_of(image);
        CHECK(size.width == WIDTH && size.height == HEIGHT);
        CHECK(size.channels == (which == LUXFER_GUIDES_EDGES ? 1u : 3u));
        float most = 0;
        for (float v : pixels_of(image)) {
            CHECK(std::isfinite(v));
            most = std::fmax(most, v);
        }
        CHECK(most > 0);
        CHECK_OK(luxfer_release(image));
    }
    luxfer_image *image = nullptr;
    CHECK_STATUS(luxfer_guides_get_image(guides, LUXFER_GUIDES_CAUSTICS + 1, &image), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_guides_get_image(guides, -1, &image), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_guides_get_image(guides, LUXFER_GUIDES_FULL, nullptr), LUXFER_INVALID_ARGUMENT);
    CHECK(image == nullptr);

    // Both guides have the same camera, so the motion is 0.
    luxfer_image *motion = nullptr;
    CHECK_OK(luxfer_guides_get_motion(guides, guides, &motion));
    size_t seen = 0;
    const std::vector<float> still = pixels_of(motion);
    for (float v : still) {
        if (std::isfinite(v)) {
            ++seen;
            CHECK(std::fabs(v) < 0.05f);
        }
    }
    CHECK(seen > still.size() * 9 / 10);
    CHECK_OK(luxfer_release(motion));
    luxfer_guides_params params = small_guides();
    params.width = 2 * WIDTH;
    params.samples = 1;
    luxfer_guides *wider = rendered(LUXFER_DEMO_SPHERE_ON_TABLE, params);
    CHECK_STATUS(luxfer_guides_get_motion(guides, wider, &motion), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_guides_get_motion(guides, nullptr, &motion), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(luxfer_release(wider));
}

// The three generated artworks, which stand in for an artist's work: they differ, have the guides' size, and are white
// paper where nothing is painted.
void artworks(luxfer_guides *guides) {
    std::vector<float> before;
    for (luxfer_artwork style = LUXFER_ARTWORK_PEN; style <= LUXFER_ARTWORK_PAINT; ++style) {
        luxfer_image *image = nullptr;
        CHECK_OK(luxfer_demo_create_artwork(guides, style, &image));
        const Size size = size_of(image);
        CHECK(size.width == WIDTH && size.height == HEIGHT && size.channels == 3);
        std::vector<float> paint = pixels_of(image);
        for (float v : paint) CHECK(v >= 0 && v <= 1);
        CHECK(paint != before);
        before = paint;
        CHECK_OK(luxfer_release(image));
    }
    luxfer_image *image = nullptr;
    CHECK_STATUS(luxfer_demo_create_artwork(guides, LUXFER_ARTWORK_PAINT + 1, &image), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_demo_create_artwork(nullptr, LUXFER_ARTWORK_PEN, &image), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_demo_create_artwork(guides, LUXFER_ARTWORK_PEN, nullptr), LUXFER_INVALID_ARGUMENT);
}

void sheets() {
    luxfer_sheet_params params;
    CHECK_STATUS(luxfer_sheet_params_init(&params, 1), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(luxfer_sheet_params_init(&params, sizeof params));
    params.dpi = 60;
    std::vector<float> pixels(size_t{WIDTH} * HEIGHT * 3);
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = float(i / 3 % WIDTH) / WIDTH;
    const luxfer_image_view view = packed({WIDTH, HEIGHT, 3}, pixels);
    luxfer_image *picture = nullptr, *sheet = nullptr, *artwork = nullptr;
    CHECK_OK(luxfer_image_create(context, &view, &picture));

    // Align the printed sheet itself instead of a scan: the result is the pale picture as printed.
    CHECK_OK(luxfer_sheet_print(picture, &params, &sheet));
    const Size paper = size_of(sheet);
    CHECK(std::fabs(paper.width / (297 / 25.4 * 60) - 1) < 0.01 && std::fabs(paper.height / (210 / 25.4 * 60) - 1) < 0.01);
    luxfer_sheet_report report = {};
    CHECK_OK(luxfer_sheet_align(sheet, WIDTH, HEIGHT, &params, &artwork, &report, sizeof report));
    CHECK(report.marks == 10 && report.residual < 0.5 && report.error < 0.5);
    const std::vector<float> aligned = pixels_of(artwork);
    CHECK(aligned.size() == pixels.size());
    auto at = [&](uint32_t x, uint32_t y) { return aligned[3 * (size_t{y} * WIDTH + x)]; };
    CHECK(at(10, 36) < at(48, 36) && at(48, 36) < at(86, 36));
    CHECK_OK(luxfer_release(artwork));
    CHECK_OK(luxfer_sheet_align(sheet, WIDTH, HEIGHT, &params, &artwork, nullptr, 0));
    CHECK_OK(luxfer_release(artwork));

    // Impossible arguments are refused.
    artwork = nullptr;
    CHECK_STATUS(luxfer_sheet_align(sheet, 0, HEIGHT, &params, &artwork, nullptr, 0), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_sheet_align(sheet, WIDTH, 1u << 31, &params, &artwork, nullptr, 0), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_sheet_align(nullptr, WIDTH, HEIGHT, &params, &artwork, nullptr, 0), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_sheet_align(sheet, WIDTH, HEIGHT, &params, nullptr, nullptr, 0), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_sheet_align(sheet, WIDTH, HEIGHT, &params, &artwork, &report, 5), LUXFER_INVALID_ARGUMENT);
    for (float blank : {0.0f, 1.0f, NAN_F}) {
        luxfer_image *photo = flat({200, 150, 3}, blank);
        CHECK_STATUS(luxfer_sheet_align(photo, WIDTH, HEIGHT, &params, &artwork, nullptr, 0), LUXFER_DEGENERATE);
        CHECK(!check::message(context).empty());
        CHECK_OK(luxfer_release(photo));
    }
    for (double luxfer_sheet_params::*field :
         {&luxfer_sheet_params::dpi, &luxfer_sheet_params::margin, &luxfer_sheet_params::contrast,
          &luxfer_sheet_params::paper_width, &luxfer_sheet_params::paper_height}) {
        for (double value : {-1.0, 1e9, std::nan("")}) {
            luxfer_sheet_params bad = params;
            bad.*field = value;
            CHECK_STATUS(luxfer_sheet_print(picture, &bad, &artwork), LUXFER_INVALID_ARGUMENT);
            CHECK_STATUS(luxfer_sheet_align(sheet, WIDTH, HEIGHT, &bad, &artwork, nullptr, 0), LUXFER_INVALID_ARGUMENT);
        }
    }
    luxfer_sheet_params bad = params;
    bad.even_light = 2;
    CHECK_STATUS(luxfer_sheet_print(picture, &bad, &artwork), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_sheet_print(nullptr, &params, &artwork), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_sheet_print(picture, &params, nullptr), LUXFER_INVALID_ARGUMENT);
    CHECK(artwork == nullptr);
    CHECK_OK(luxfer_release(sheet));
    CHECK_OK(luxfer_release(picture));
}

// The codes of an object's warnings.
std::vector<luxfer_warning_code> codes_of(void *object) {
    luxfer_warnings *warnings = nullptr;
    uint32_t count = 0;
    CHECK_OK(luxfer_get_warnings(object, &warnings));
    CHECK_OK(luxfer_warnings_get_count(warnings, &count));
    std::vector<luxfer_warning_code> codes;
    for (uint32_t i = 0; i < count; ++i) {
        luxfer_warning warning;
        CHECK_OK(luxfer_warnings_get(warnings, i, &warning, sizeof warning));
        CHECK(warning.stage == LUXFER_STAGE_STYLIZE && warning.has_place && warning.severity > warning.limit);
        codes.push_back(warning.code);
    }
    CHECK_OK(luxfer_release(warnings));
    return codes;
}

luxfer_status paint(luxfer_stylize *stylize, const luxfer_stylize_params *params) {
    luxfer_job *job = nullptr;
    const luxfer_status started = luxfer_stylize_start(stylize, params, &job);
    return started == LUXFER_OK ? finish(job) : started;
}

// Stylises with all guides, then a sequence of two frames, then with extreme masks.
void stylise(luxfer_guides *source, luxfer_guides *target) {
    // The still life lacks the ball, and has other objects instead: their motion is unknown.
    luxfer_image *between = nullptr;
    CHECK_OK(luxfer_guides_get_motion(source, source, &between));
    CHECK(codes_of(source).empty());
    CHECK_OK(luxfer_release(between));
    CHECK_OK(luxfer_guides_get_motion(source, target, &between));
    CHECK(codes_of(source) == std::vector<luxfer_warning_code>{LUXFER_WARNING_NO_COUNTERPART});
    CHECK_OK(luxfer_release(between));
    luxfer_stylize *stylize = nullptr;
    luxfer_image *artwork = nullptr, *picture = nullptr, *motion = nullptr;
    CHECK_OK(luxfer_stylize_create(context, &stylize));
    CHECK_OK(luxfer_demo_create_artwork(source, LUXFER_ARTWORK_PEN, &artwork));
    CHECK_STATUS(paint(stylize, nullptr), LUXFER_INVALID_OPERATION);
    CHECK_STATUS(luxfer_stylize_set_artwork(stylize, nullptr), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(luxfer_stylize_set_artwork(stylize, artwork));
    const uint32_t all = LUXFER_GUIDES_WITH_NORMALS | LUXFER_GUIDES_WITH_EDGES | LUXFER_GUIDES_WITH_MATERIALS |
                         LUXFER_GUIDES_WITH_CAUSTICS;
    CHECK_STATUS(luxfer_stylize_add_guides(stylize, source, target, 2 * all, 1), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_stylize_add_guides(stylize, source, target, all, NAN_F), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_stylize_add_guides(stylize, source, nullptr, all, 1), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(paint(stylize, nullptr), LUXFER_INVALID_OPERATION);
    CHECK_OK(luxfer_stylize_add_guides(stylize, source, target, all, 0.5f));
    luxfer_stylize_params params;
    CHECK_OK(luxfer_stylize_params_init(&params, sizeof params));
    params.coverage = NAN_F;
    CHECK_STATUS(paint(stylize, &params), LUXFER_INVALID_ARGUMENT);
    CHECK(check::message(context).find("coverage") != std::string::npos);
    CHECK_OK(luxfer_stylize_params_init(&params, sizeof params));
    CHECK_OK(paint(stylize, &params));
    CHECK_OK(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_PICTURE, &picture));
    const std::vector<float> first = pixels_of(picture);
    CHECK(first.size() == size_t{WIDTH} * HEIGHT * 3);
    for (float v : first) CHECK(v >= 0 && v <= 1);
    CHECK_OK(luxfer_release(picture));
    luxfer_image *sources = nullptr;
    CHECK_OK(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_SOURCES, &sources));
    const std::vector<float> places = pixels_of(sources);
    CHECK_OK(luxfer_release(sources));

    // The next frame, with a still camera: all paint stays where it is.
    CHECK_OK(luxfer_guides_get_motion(target, target, &motion));
    CHECK_OK(luxfer_stylize_set_motion(stylize, motion));
    params.seed = 2;
    CHECK_OK(paint(stylize, &params));
    CHECK_OK(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_SOURCES, &sources));
    const std::vector<float> later = pixels_of(sources);
    CHECK_OK(luxfer_release(sources));
    size_t same = 0;
    for (size_t i = 0; i < places.size(); ++i) same += places[i] == later[i];
    CHECK(places.size() == size_t{WIDTH} * HEIGHT * 2 && same > places.size() * 9 / 10);
    // Where a few patches have changed, the pixels that they share with others are blended anew.
    CHECK_OK(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_PICTURE, &picture));
    const std::vector<float> second = pixels_of(picture);
    CHECK_OK(luxfer_release(picture));
    double change = 0;
    for (size_t i = 0; i < first.size(); ++i) change += std::fabs(first[i] - second[i]);
    CHECK(change < 0.02 * static_cast<double>(first.size()));

    CHECK(codes_of(stylize).empty());

    // Motion that contradicts the scenes is painted, but causes a warning.
    luxfer_image *wrong = flat({WIDTH, HEIGHT, 2}, 5);
    CHECK_OK(luxfer_stylize_set_motion(stylize, wrong));
    CHECK_OK(paint(stylize, &params));
    CHECK(codes_of(stylize) == std::vector<luxfer_warning_code>{LUXFER_WARNING_MOTION_DISAGREES});
    CHECK_OK(luxfer_release(wrong));

    // Refuse a motion with the wrong number of channels, and a motion without a previous frame.
    luxfer_image *mask = flat({WIDTH, HEIGHT, 1}, 1);
    CHECK_OK(luxfer_stylize_set_motion(stylize, mask));
    CHECK_STATUS(paint(stylize, &params), LUXFER_INVALID_ARGUMENT);
    luxfer_stylize *fresh = nullptr;
    CHECK_OK(luxfer_stylize_create(context, &fresh));
    CHECK_OK(luxfer_stylize_set_artwork(fresh, artwork));
    CHECK_OK(luxfer_stylize_add_guides(fresh, source, target, 0, 0));
    CHECK_OK(luxfer_stylize_set_motion(fresh, motion));
    CHECK_STATUS(paint(fresh, nullptr), LUXFER_NOT_READY);
    CHECK_OK(luxfer_stylize_set_motion(fresh, nullptr));

    // Refuse masks that leave nothing, of the exemplar or of the target; masks that leave everything are fine.
    luxfer_image *nothing = flat({WIDTH, HEIGHT, 1}, 0);
    CHECK_OK(luxfer_stylize_set_source_mask(fresh, nothing));
    CHECK_STATUS(paint(fresh, nullptr), LUXFER_DEGENERATE);
    CHECK_OK(luxfer_stylize_set_source_mask(fresh, mask));
    CHECK_OK(luxfer_stylize_set_target_mask(fresh, nothing, nullptr));
    CHECK_STATUS(paint(fresh, nullptr), LUXFER_DEGENERATE);
    CHECK_OK(luxfer_stylize_set_target_mask(fresh, nullptr, nullptr));
    CHECK_OK(paint(fresh, nullptr));

    // Complete a half-painted picture: the painted half stays unchanged to the bit.
    std::vector<float> half(size_t{WIDTH} * HEIGHT);
    for (size_t i = 0; i < half.size(); ++i) half[i] = i % WIDTH < WIDTH / 2;
    const luxfer_image_view view = packed({WIDTH, HEIGHT, 1}, half);
    luxfer_image *painted = nullptr, *full = guide(source, LUXFER_GUIDES_FULL);
    CHECK_OK(luxfer_image_create(context, &view, &painted));
    CHECK_OK(luxfer_stylize_clear_guides(fresh));
    CHECK_OK(luxfer_stylize_add_guide(fresh, "full", full, nullptr, 1, LUXFER_GUIDE_LIGHT));
    CHECK_STATUS(luxfer_stylize_add_guide(fresh, nullptr, full, full, 1, LUXFER_GUIDE_LIGHT), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_stylize_add_guide(fresh, "odd", full, mask, 1, LUXFER_GUIDE_LIGHT), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(luxfer_stylize_set_painted(fresh, painted));
    CHECK_STATUS(luxfer_stylize_set_painted(fresh, full), LUXFER_INVALID_ARGUMENT);
    CHECK_OK(paint(fresh, nullptr));
    CHECK_OK(luxfer_stylize_get_image(fresh, LUXFER_STYLIZE_IMAGE_PICTURE, &picture));
    const std::vector<float> completed = pixels_of(picture), original = pixels_of(artwork);
    for (size_t i = 0; i < completed.size(); ++i)
        if (half[i / 3] > 0) CHECK(completed[i] == original[i]);
    for (luxfer_image *image : {picture, painted, full, nothing, mask, motion, artwork}) CHECK_OK(luxfer_release(image));
    CHECK_OK(luxfer_release(fresh));
    CHECK_OK(luxfer_release(stylize));
}

} // namespace

int main() {
    CHECK_OK(luxfer_context_create(nullptr, &context));
    guides_refuse();
    luxfer_guides *source = rendered(LUXFER_DEMO_SPHERE_ON_TABLE, small_guides());
    luxfer_guides *target = rendered(LUXFER_DEMO_STILL_LIFE, small_guides());
    guides_tell_light_apart(source);
    artworks(source);
    sheets();
    luxfer_stylize *stylize = nullptr;
    if (luxfer_stylize_create(context, &stylize) != LUXFER_UNSUPPORTED) {
        CHECK_OK(luxfer_release(stylize));
        stylise(source, target);
    }
    CHECK_OK(luxfer_release(source));
    CHECK_OK(luxfer_release(target));
    CHECK_OK(luxfer_release(context));
    return check::summary("stylisation");
}
