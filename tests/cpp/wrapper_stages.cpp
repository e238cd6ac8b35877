// Tests the methods of the C++ wrapper that wrapper.cpp does not reach: every stage, on small inputs that the library
// generates. Other tests check that results are right; this one checks that each method calls its C function with the
// arguments in the right places.
#include "check.hpp"

#include <luxfer.hpp>

#include <cmath>
#include <cstring>
#include <fstream>

namespace {

using luxfer::Context, luxfer::Image, luxfer::Scene;

// Returns a copy of a handle: it shares the object and keeps it alive after the original is gone.
template <class Object>
Object copied(Object object) {
    Object copy = object;
    CHECK(copy.get() == object.get());
    object = Object();
    return copy;
}

bool has_size(const Image &image, std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
    const luxfer::ImageSize size = image.size();
    return size.width == width && size.height == height && size.channels == channels;
}

// An image with one channel and one value everywhere.
Image filled(const Context &context, std::uint32_t width, std::uint32_t height, float value) {
    return Image::create(context, {std::vector<float>(std::size_t(width) * height, value), width, height, 1});
}

// From a photo to an emissive texture, stage by stage; then a transfer that uses these results.
void lighting_transfer(const Context &context) {
    const auto demo = copied(luxfer::DemoPhoto::create(context));
    luxfer::DemoPhotoParams size;
    size.width = 300;
    size.height = 200;
    size.samples = 4;
    demo.start(size).wait();
    const Image photo = demo.image(LUXFER_DEMO_PHOTO_PICTURE), strokes = demo.image(LUXFER_DEMO_PHOTO_STROKES);

    const auto rectify = copied(luxfer::Rectify::create(context));
    rectify.set_photo(photo);
    rectify.start().wait();
    CHECK(rectify.report().segments > 0 && rectify.report().is_unwarped == 0);

    luxfer::RectifyParams shifted;
    shifted.principal[0] = 160;
    shifted.principal[1] = 90;
    const auto given = luxfer::Rectify::create(context);
    given.set_photo(photo);
    given.start(shifted).wait();
    CHECK(given.report().principal[0] == 160 && given.report().principal[1] == 90);
    CHECK(rectify.report().principal[0] == 150 && rectify.report().principal[1] == 100);

    const auto features = copied(luxfer::Features::create(context));
    features.set_photo(photo);
    features.set_view(rectify);
    const auto painted = copied(luxfer::Strokes::create(context, 300, 200));
    const float ceiling[] = {150, 20, 250, 60};
    painted.add(LUXFER_PHASE_PLANE, ceiling, 2, true);
    painted.add(strokes);
    features.set_strokes(painted);
    features.start().wait();
    CHECK(features.report().depth_source == LUXFER_DEPTH_FROM_LAYOUT);
    const Image channels = features.image(LUXFER_FEATURES_CHANNELS);
    CHECK(has_size(channels, 300, 200, 10));

    const auto plane = copied(luxfer::Segment::create(context));
    plane.set_features(channels);
    const auto drawn = luxfer::Strokes::from_image(strokes);
    plane.set_strokes(LUXFER_PHASE_PLANE, drawn);
    plane.start().wait();
    CHECK(plane.report().positive_samples > 0);
    const auto lights = luxfer::Segment::create(context);
    lights.set_features(channels);
    lights.set_region(plane.image(LUXFER_SEGMENT_MASK));
    lights.set_strokes(LUXFER_PHASE_LIGHTS, drawn);
    luxfer::SegmentParams colour;
    colour.channels = 7;
    lights.start(colour).wait();

    rectify.set_mask(plane.image(LUXFER_SEGMENT_MASK));
    luxfer::RectifyParams small;
    small.max_side = 256;
    rectify.start(small).wait();
    const luxfer_rectify_report view = rectify.report();
    CHECK(view.is_unwarped == 1);
    const auto emission = copied(luxfer::Emission::create(context));
    const Image unwarped = rectify.image(LUXFER_RECTIFY_UNWARPED);
    const luxfer::ImageSize extent = unwarped.size();
    const Image sure = rectify.undistort(lights.image(LUXFER_SEGMENT_CONFIDENCE));
    const Image light = sure.warp(view.to_photo, extent.width, extent.height);
    emission.set_exemplar(unwarped, light, rectify.image(LUXFER_RECTIFY_VALID));
    emission.set_photo(rectify.undistort(photo), view.to_photo);
    luxfer::EmissionParams texture;
    texture.width = 96;
    texture.height = 64;
    texture.working_side = 64;
    texture.scale = 2;
    emission.start(texture).wait();
    CHECK(has_size(emission.image(LUXFER_EMISSION_TEXTURE), 96, 64, 3));
    const luxfer_emission_report made = emission.report();
    CHECK(made.luminaires > 0 && emission.luminaire(0).corners > 2);
    const std::array<double, 2> corner = emission.corner(0, 1);
    CHECK(corner[0] >= 0 && corner[0] <= 96 && corner[1] >= 0 && corner[1] <= 64);
    const Image whole = emission.image(LUXFER_EMISSION_TEXTURE);

    // Add a second style, whose weight is 0 everywhere; then plan the texture and render one tile of it.
    const float nothing[] = {0};
    const Image nowhere = Image::create(context, {nothing, 1, 1, 1});
    emission.add_style(unwarped, light, rectify.image(LUXFER_RECTIFY_VALID), 1, nowhere);
    emission.clear_styles();
    emission.add_style(unwarped, light, rectify.image(LUXFER_RECTIFY_VALID), photo, view.to_photo, 2, nowhere);
    emission.start_composition(texture).wait();
    const Image tile = emission.render_tile(40, 10, 30, 20);
    CHECK(has_size(tile, 30, 20, 4));

    // The same steps as one transfer, whose last stages use these results, and a texture of the caller instead of a
    // synthesised one.
    const auto transfer = copied(luxfer::Transfer::create(context));
    transfer.set_photo(photo);
    transfer.set_depth(filled(context, 300, 200, 3), LUXFER_DEPTH_ALONG_RAY);
    transfer.set_scene(Scene::demo(context, LUXFER_DEMO_TARGET_ROOM), "Ceiling");
    transfer.set_strokes(drawn);
    transfer.set_strokes(luxfer::Strokes());
    drawn.add("light 2 1 1 20 20");
    transfer.set_strokes(drawn);
    transfer.set_texture(whole);
    transfer.use(rectify);
    transfer.use(features);
    transfer.use(LUXFER_PHASE_PLANE, plane);
    transfer.use(LUXFER_PHASE_LIGHTS, lights.image(LUXFER_SEGMENT_CONFIDENCE));
    luxfer::CameraParams camera;
    std::copy_n(std::array<float, 3>{5.65f, 1.55f, 3.75f}.data(), 3, camera.position);
    std::copy_n(std::array<float, 3>{2.2f, 1.3f, 1.15f}.data(), 3, camera.target);
    transfer.set_camera(camera);
    luxfer::RelightParams rough;
    rough.paths = 1 << 12;
    luxfer::RenderParams tiny;
    tiny.width = 32;
    tiny.height = 18;
    tiny.samples = 2;
    luxfer::TransferParams params;
    params.relight = &rough;
    params.render = &tiny;
    transfer.start(LUXFER_STAGE_EMISSION, LUXFER_STAGE_RENDER, params).wait();
    CHECK(has_size(transfer.image(LUXFER_TRANSFER_RENDER), 32, 18, 3));
    CHECK(transfer.scene().counts().meshes == transfer.scene(LUXFER_SCENE_UNSOLVED).counts().meshes);
    CHECK(transfer.report().fixtures > 0 && transfer.fixture(0).area > 0);
    transfer.save_fixtures("wrapper_stages.csv");
    CHECK(std::ifstream("wrapper_stages.csv").good());
    CHECK(transfer.view().focal == view.focal && transfer.solution().scale[0] > 0);

    // Read all warnings of the transfer and of each stage; an index beyond the list is an error.
    const luxfer::Warnings lists[] = {transfer.warnings(), rectify.warnings(), features.warnings(), plane.warnings(),
                                      emission.warnings()};
    for (const luxfer::Warnings &list : lists) {
        const luxfer::Warnings warnings = copied(list);
        const std::uint32_t count = warnings.count();
        for (std::uint32_t i = 0; i < count; i++) {
            const luxfer_warning warning = warnings.warning(i);
            CHECK(warning.stage >= LUXFER_STAGE_VIEW && warning.stage <= LUXFER_STAGE_RENDER);
            CHECK(std::strcmp(luxfer::Warnings::name(warning.code), "LUXFER_WARNING_UNKNOWN") != 0);
            CHECK(std::strlen(warning.message) > 0 && std::strlen(warning.advice) > 0);
        }
        luxfer_status beyond = LUXFER_OK;
        try {
            warnings.warning(count);
        } catch (const luxfer::Error &error) {
            beyond = error.status();
        }
        CHECK_STATUS(beyond, LUXFER_NOT_FOUND);
    }
    CHECK(lists[4].count() == 0); // An emission that was only composed (start_composition) has no warnings.

    const auto plan = luxfer::Plan::create(context);
    luxfer::PlanParams budget;
    budget.time_budget_ms = 500;
    plan.start(transfer, budget, params).wait();
    const luxfer_plan_report expected = plan.report();
    CHECK(expected.relights == 1 && expected.relight_seconds > 0 && expected.error >= expected.render_error);
    CHECK(luxfer_render_params(plan.render_params()).time_budget_ms > 0);
    CHECK(luxfer_relight_params(plan.relight_params()).paths >= 2048);
}

// A plan chooses settings for a target error.
void plans(const Context &context) {
    const Scene scene = Scene::demo(context, LUXFER_DEMO_EXEMPLAR_ROOM);
    const auto render = luxfer::Render::create(context);
    render.set_scene(scene);
    const auto plan = copied(luxfer::Plan::create(context));
    luxfer::PlanParams goal;
    goal.target_error = 0.5f;
    luxfer::RenderParams tiny;
    tiny.width = 32;
    tiny.height = 18;
    plan.start(render, goal, tiny).wait();
    luxfer_plan_report expected = plan.report();
    CHECK(expected.relights == 0 && expected.seconds > 0 && expected.error <= 0.5001);
    const luxfer_render_params chosen = plan.render_params();
    CHECK(chosen.width == 32 && chosen.samples >= 4);
    render.start(chosen).wait();
    CHECK(luxfer_render_report(render.report()).error < 1);

    const auto transfer = luxfer::Transfer::create(context);
    bool is_early = false;
    try {
        plan.start(transfer, goal);
    } catch (const luxfer::Error &error) {
        is_early = error.status() == LUXFER_INVALID_OPERATION;
    }
    CHECK(is_early);
}

// A scene with a lamp, textures and an environment of the caller: solves for the lamp's strength and measures its
// light.
void light(const Context &context) {
    const Scene scene = copied(Scene::demo(context, LUXFER_DEMO_TARGET_ROOM));
    const Image white = Image::create(context, {std::vector<float>(2 * 2 * 3, 1.0f), 2, 2});
    scene.set_environment(white, {1, 2, 3});
    const std::uint32_t texture = scene.add_texture(white, LUXFER_WRAP_CLAMP, LUXFER_WRAP_MIRROR);
    const float transform[] = {2, 0, 0, 0, 2, 0};
    scene.set_material_texture(0, LUXFER_TEXTURE_BASE_COLOR, texture, 0, transform);
    const luxfer_texture_use use = scene.material_texture(0, LUXFER_TEXTURE_BASE_COLOR);
    CHECK(use.texture == texture && use.wrap_u == LUXFER_WRAP_CLAMP && use.wrap_v == LUXFER_WRAP_MIRROR);
    CHECK(use.transform[4] == 2 && has_size(scene.texture(texture), 2, 2, 3));
    luxfer_material_params material = scene.material(0);
    material.roughness = 0.25f;
    scene.set_material(0, material);
    CHECK(scene.material(0).roughness == 0.25f);
    scene.set_material_texture(0, LUXFER_TEXTURE_BASE_COLOR, LUXFER_NONE);
    CHECK(scene.material_texture(0, LUXFER_TEXTURE_BASE_COLOR).texture == LUXFER_NONE);

    std::vector<float> lit(4 * 4 * 3, 0.0f);
    std::fill_n(&lit[3 * 5], 3, 1.0f);
    const luxfer::PlacedEmission lamp =
        scene.place_emission("Ceiling", Image::create(context, {lit, 4, 4}), {100, 100, 100});
    const auto relight = copied(luxfer::Relight::create(context));
    relight.set_scene(scene, lamp);
    relight.set_target({50, 40, 30});
    luxfer::RelightParams rough;
    rough.paths = 1 << 12;
    relight.start(rough).wait();
    const luxfer_relight_report solution = relight.report();
    CHECK(solution.scale[0] > 0 && solution.paths > 0);

    const auto illuminance = copied(luxfer::Illuminance::create(context));
    illuminance.set_scene(scene);
    luxfer::IlluminanceParams few;
    few.columns = few.rows = 2;
    few.samples = 16;
    illuminance.start_mesh(lamp.mesh, false, few).wait();
    CHECK(has_size(illuminance.image(), 2, 2, 1) && has_size(illuminance.image(LUXFER_ILLUMINANCE_ERROR), 2, 2, 1));

    const auto render = copied(luxfer::Render::create(context));
    render.set_scene(scene);
    render.set_camera(luxfer::CameraParams());
    render.set_emitter_as(LUXFER_EMITTER_AS_OBJECT);
    render.add_expression("all", "C.*");
    render.clear_expressions();
    render.set_aovs(LUXFER_AOV_ALPHA | LUXFER_AOV_NORMAL);
    luxfer::RenderParams tiny;
    tiny.width = tiny.height = 8;
    tiny.samples = 2;
    const luxfer::Job job = copied(luxfer::Job(render.start(tiny)));
    job.wait();
    CHECK(render.layer_count() == 2);
    render.write_exr("wrapper_stages.exr");
    // Render in parts, the right half first.
    for (std::uint32_t index : {1u, 0u}) {
        const luxfer_render_part part = render.split(2, 1, 1, index, tiny);
        CHECK(part.x == 4 * index && part.width == 4 && part.height == 8 && part.samples == 2);
        const std::string name = "wrapper_stages_part" + std::to_string(index) + ".exr";
        render.start_part(name, part, tiny).wait();
        CHECK(has_size(render.image(), 4, 8, 3));
        render.add_part(name);
    }
    render.start_merge(tiny).wait();
    CHECK(has_size(render.image(), 8, 8, 3) && render.report().samples == 2);
    render.clear_parts();
    scene.save("wrapper_stages.glb");
    std::ifstream file("wrapper_stages.exr", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    CHECK(has_size(Image::load_memory(context, bytes), 8, 8, 4));
    CHECK(Scene::load(context, "wrapper_stages.glb").counts().triangles == scene.counts().triangles);
}

// The body of a globe, from its picture to a scene and to a luminaire.
void pendants(const Context &context) {
    std::vector<float> disc(96 * 96);
    for (std::size_t i = 0; i < disc.size(); ++i) {
        const auto x = static_cast<float>(i % 96), y = static_cast<float>(i / 96);
        disc[i] = std::hypot(x - 47.5f, y - 47.5f) < 24 ? 1.0f : 0.0f;
    }
    const Image globe = Image::create(context, {disc, 96, 96, 1});
    luxfer::PendantsParams params;
    params.focal = 200;
    params.ceiling = 1.5;
    const std::array<double, 2> hook[] = {{47.5, 5}};
    const auto lamps = luxfer::find_pendants(context, globe, globe, {}, hook, params);
    CHECK(lamps.size() == 1 && !(lamps[0].doubts & LUXFER_DOUBT_SIZE) && std::fabs(lamps[0].aspect[0] - 1) < 0.05);
    CHECK(lamps[0].drop[1] < lamps[0].drop[0] && lamps[0].drop[0] < lamps[0].drop[2]);
    const Scene scene = Scene::demo(context, LUXFER_DEMO_TARGET_ROOM);
    const std::uint32_t meshes = scene.counts().meshes;
    const std::array<double, 3> places[] = {{1, 2, 1}, {2, 2, 1}};
    const luxfer::PlacedPendants placed = luxfer::add_pendants(scene, lamps[0], places, 2000, 0.4f);
    CHECK(placed.first_mesh == meshes && scene.counts().meshes == meshes + 2);
    CHECK(placed.material + 1 == scene.counts().materials);
    luxfer::GonioParams directions;
    directions.planes = 4;
    const std::array<std::uint32_t, 1> body = {placed.first_mesh};
    const luxfer::MeasuredDistribution measured = luxfer::measure_distribution(scene, body, directions);
    CHECK(measured.report.flux > 0 && measured.distribution.report().planes == 4);
}

// The sun of a summer's noon, a clear sky with it, and a weather file that is missing.
void skies(const Context &context) {
    luxfer::SunParams noon;
    noon.year = 2026;
    noon.month = 6;
    noon.day = 21;
    noon.hour = 11.25;
    noon.latitude = 48.1;
    noon.longitude = 11.6;
    const luxfer_sun_position sun = luxfer::sun_position(context, noon);
    CHECK(std::fabs(sun.altitude - 1.1403) < 0.001);
    luxfer::SkyParams clear;
    clear.cie_type = 12;
    clear.sun_altitude = sun.altitude;
    clear.sun_azimuth = sun.azimuth;
    clear.direct_normal = 80000;
    const Scene scene = Scene::demo(context, LUXFER_DEMO_TARGET_ROOM);
    const luxfer_sky_report sky = luxfer::set_sky(scene, clear);
    CHECK(sky.sun + 1 == scene.counts().lights && sky.direct_normal == 80000 && sky.zenith_luminance > 0);
    luxfer_status missing = LUXFER_OK;
    try {
        luxfer::read_weather(context, "absent.epw", 0, 1);
    } catch (const luxfer::Error &error) {
        missing = error.status();
    }
    CHECK_STATUS(missing, LUXFER_IO);
}

luxfer::Guides guides_of(const Context &context, luxfer_demo which) {
    const auto guides = copied(luxfer::Guides::create(context));
    guides.set_scene(Scene::demo(context, which));
    luxfer::GuidesParams small;
    small.width = 48;
    small.height = 36;
    small.samples = 2;
    guides.start(small).wait();
    return guides;
}

void stylisation(const Context &context) {
    const luxfer::Guides source = guides_of(context, LUXFER_DEMO_SPHERE_ON_TABLE);
    const luxfer::Guides target = guides_of(context, LUXFER_DEMO_STILL_LIFE);
    const Image artwork = source.demo_artwork(LUXFER_ARTWORK_PEN), all = filled(context, 48, 36, 1);
    const auto stylize = copied(luxfer::Stylize::create(context));
    stylize.set_artwork(artwork);
    stylize.add_guide("height", filled(context, 48, 36, 0.5f), filled(context, 48, 36, 0.5f), 1, LUXFER_GUIDE_DATA);
    stylize.clear_guides();
    stylize.add_guides(source, target, LUXFER_GUIDES_WITH_NORMALS, 0.5f);
    stylize.set_source_mask(all);
    stylize.set_target_mask(all, artwork);
    luxfer::StylizeParams params(LUXFER_STYLIZE_FAST);
    params.keep_for_update = 1;
    stylize.start(params).wait();
    CHECK(has_size(stylize.image(), 48, 36, artwork.size().channels));
    const luxfer_stylize_report report = stylize.report();
    CHECK(report.is_complete == 1 && report.levels > 0);
    stylize.update(artwork, all).wait();
    CHECK(has_size(stylize.image(LUXFER_STYLIZE_IMAGE_SOURCES), 48, 36, 2));

    const auto plan = luxfer::Plan::create(context);
    luxfer::PlanParams goal;
    goal.target_error = 1;
    plan.start(stylize, goal, params).wait();
    const luxfer_stylize_params hurried = plan.stylize_params();
    CHECK(hurried.iterations > 0 && hurried.keep_for_update == 1 && hurried.seed == params.seed);
    const luxfer_plan_report expected = plan.report();
    CHECK(expected.seconds > 0 && expected.error > 0 && expected.error <= 1 && expected.render_seconds == 0);
    // With a target error that cannot be reached, the plan depends on errors alone, so the machine's load does not
    // matter.
    goal.target_error = 1e-5f;
    plan.start(stylize, goal, params).wait();
    const luxfer_stylize_params careful = plan.stylize_params();
    CHECK(careful.polish > 0 && careful.iterations > params.iterations && careful.keep_for_update == 1);
    CHECK(plan.report().error > 1e-5f && plan.report().error <= expected.error);

    stylize.set_motion(target.motion(target));
    stylize.set_motion(Image());
    stylize.set_painted(all);
    CHECK(has_size(target.image(LUXFER_GUIDES_EDGES), 48, 36, 1));

    // Print a sheet, and align the print itself as if it were a scan.
    luxfer::SheetParams paper;
    paper.dpi = 60;
    const luxfer::Sheet::Aligned aligned = luxfer::Sheet::align(luxfer::Sheet::print(artwork, paper), 48, 36, paper);
    CHECK(aligned.report.marks >= 6 && has_size(aligned.artwork, 48, 36, 3));
}

} // namespace

int main() {
    const Context context = Context::create();
    CHECK(std::strcmp(luxfer_get_version_string(), "") != 0);
    lighting_transfer(context);
    light(context);
    pendants(context);
    skies(context);
    plans(context);
    stylisation(context);
    return check::summary("wrapper_stages");
}
