// The skeleton of a plug-in for Maya, Houdini and the like: what is the same for all of them, against a host of two arrays and
// a clock. Where a real host is called, a comment names its function.
#include <luxfer.hpp>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

// --8<-- [start:host]
// What the plug-in needs of its host.
struct HostMesh {
    std::string name;
    std::vector<float> points;            // Maya: MFnMesh::getRawPoints; Houdini: GU_Detail::getPos3 of each point
    std::vector<std::uint32_t> triangles; // Maya: MFnMesh::getTriangles; Houdini: its polygons, divided into triangles
    float colour[3] = {0.8f, 0.8f, 0.8f};
};

struct Host {
    double metres_per_unit = 1;               // Maya: 0.01, for its API is in centimetres; Houdini: 1
    std::vector<HostMesh> meshes;
    std::atomic<bool> is_interrupted{false}; // Maya: MComputation::isInterruptRequested; Houdini: UT_Interrupt::opInterrupt
    void show_progress(double) {}             // Maya: MProgressWindow::setProgress; Houdini: the same opInterrupt
    void report_error(const std::string &text) { std::fprintf(stderr, "%s\n", text.c_str()); } // MGlobal::displayError
};
// --8<-- [end:host]

// --8<-- [start:plugin]
// One context for the life of the plug-in: it owns the threads. Nothing of luxfer is global, so another plug-in of the same
// process may have its own, or another version of the library.
class Plugin {
public:
    // Maya: in initializePlugin; Houdini: in newSopOperator, or at the first cook. Leave the host a core for its interface.
    explicit Plugin(std::uint32_t threads) {
        luxfer::ContextParams params;
        params.num_threads = threads;
        context_ = luxfer::Context::create(params); // throws if the library that was found is not compatible
    }

    // The threads are joined when the last object goes; do it in uninitializePlugin, never in a static destructor.
    const luxfer::Context &context() const { return context_; }

private:
    luxfer::Context context_;
};
// --8<-- [end:plugin]

// --8<-- [start:scene]
// The host's meshes as a scene: in metres, Y up, with transforms applied. Arrays are copied during the call.
luxfer::Scene describe(const luxfer::Context &context, const Host &host) {
    const auto scene = luxfer::Scene::create(context);
    for (const HostMesh &mesh : host.meshes) {
        std::vector<float> points = mesh.points;
        for (float &x : points)
            x = float(x * host.metres_per_unit);
        luxfer::MaterialParams material;
        std::copy(mesh.colour, mesh.colour + 3, material.base_color);
        luxfer::MeshParams params(points, mesh.triangles, scene.add_material(material));
        params.name = mesh.name.c_str(); // surfaces are found by it
        scene.add_mesh(params);
    }
    return scene;
}
// --8<-- [end:scene]

// --8<-- [start:modal]
// Work that the user waits for: a command, or a cook. Progress comes on the waiting thread, so the host may be asked in it.
bool transfer_light(Host &host, const luxfer::Transfer &transfer, const luxfer::TransferParams &params) {
    try {
        transfer.start(params).wait([&](double fraction) {
            host.show_progress(fraction);
            return !host.is_interrupted; // false cancels; what is done by then can be read
        });
        return true;
    } catch (const luxfer::Error &error) {
        if (error.status() != LUXFER_CANCELLED)
            host.report_error(error.what()); // written for people: names the parameter, its value and what is allowed
        return false;
    }
}
// --8<-- [end:modal]

// --8<-- [start:background]
// Work behind the interface: the host's timer (Maya: MTimerMessage; Houdini: hou.ui.addEventLoopCallback) asks from time to
// time. Results grow while a rendering runs, so each tick may show a better picture.
class Background {
public:
    Background(luxfer::Render render, const luxfer::RenderParams &params) : render_(render), job_(render.start(params)) {}

    // True as soon as it has ended. Never waits.
    bool tick(Host &host) {
        const luxfer::JobState state = job_.poll();
        host.show_progress(state.fraction);
        show();
        return state.is_finished;
    }

    // Deleting the object does the same, and waits for the end, which takes a tenth of a second at most.
    void cancel() { job_.cancel(); }

    const std::vector<float> &pixels() const { return pixels_; }

private:
    void show() {
        try {
            pixels_ = render_.image().samples(); // linear, cd/m2
        } catch (const luxfer::Error &error) {
            if (error.status() != LUXFER_NOT_READY) // before the first pass there is nothing to show
                throw;
        }
    }

    luxfer::Render render_;
    luxfer::Job job_;
    std::vector<float> pixels_;
};
// --8<-- [end:background]

// --8<-- [start:result]
// Back into the host: the texture, and what to multiply it with, in cd/m2.
struct Light {
    luxfer::Image texture;
    double strength[3];
};

Light light_of(const luxfer::Transfer &transfer, float white_luminance) {
    Light light = {transfer.image(LUXFER_TRANSFER_EMISSION), {}};
    const luxfer_relight_report solution = transfer.solution();
    for (int c = 0; c < 3; c++)
        light.strength[c] = white_luminance * solution.scale[c];
    return light;
}
// --8<-- [end:result]

namespace {

// A room without a front: floor, walls and ceiling, in centimetres as Maya has them.
HostMesh quad(const char *name, float x, float y, float z, const float (&u)[3], const float (&v)[3]) {
    HostMesh mesh;
    mesh.name = name;
    for (int corner = 0; corner < 4; corner++)
        for (int c = 0; c < 3; c++) {
            const float origin[3] = {x, y, z};
            mesh.points.push_back(origin[c] + float(corner == 1 || corner == 2) * u[c] + float(corner >= 2) * v[c]);
        }
    mesh.triangles = {0, 1, 2, 0, 2, 3};
    return mesh;
}

void furnish(Host &host) {
    host.metres_per_unit = 0.01;
    host.meshes = {quad("Floor", 0, 0, 500, {400, 0, 0}, {0, 0, -500}), quad("Ceiling", 0, 260, 0, {400, 0, 0}, {0, 0, 500}),
                   quad("Back", 0, 0, 0, {400, 0, 0}, {0, 260, 0}), quad("Left", 0, 0, 0, {0, 260, 0}, {0, 0, 500}),
                   quad("Right", 400, 0, 500, {0, 260, 0}, {0, 0, -500})};
}

int fail(const char *what) {
    std::fprintf(stderr, "failed: %s\n", what);
    return 1;
}

} // namespace

int main() {
    Host host;
    furnish(host);
    const Plugin plugin(2);
    const luxfer::Context &context = plugin.context();
    const auto room = describe(context, host);

    // The photo and the strokes would be the user's.
    const auto demo = luxfer::DemoPhoto::create(context);
    luxfer::DemoPhotoParams photo;
    photo.width = 300;
    photo.height = 200;
    demo.start(photo).wait();
    const auto transfer = luxfer::Transfer::create(context);
    transfer.set_photo(demo.image(LUXFER_DEMO_PHOTO_PICTURE));
    transfer.set_scene(room, "Ceiling");
    transfer.add_strokes(demo.image(LUXFER_DEMO_PHOTO_STROKES));

    luxfer::RenderParams picture;
    picture.width = 120;
    picture.height = 80;
    picture.samples = 4;
    luxfer::TransferParams params;
    params.render = &picture;
    if (!transfer_light(host, transfer, params))
        return fail("the transfer");
    const Light light = light_of(transfer, params.white_luminance);
    if (!(light.strength[0] > 0 && light.texture.size().channels == 3))
        return fail("the light");

    // Interrupted: no error is reported, and nothing is lost.
    host.is_interrupted = true;
    if (transfer_light(host, transfer, params))
        return fail("an interrupted transfer is no success");

    // In the background: pictures while it runs, and an early end.
    const auto render = luxfer::Render::create(context);
    render.set_scene(transfer.scene());
    picture.samples = 1 << 20;
    luxfer_camera_params camera = luxfer::CameraParams();
    camera.position[0] = 2, camera.position[1] = 1.4f, camera.position[2] = 4.8f;
    camera.target[0] = 2, camera.target[1] = 1.2f, camera.target[2] = 0;
    render.set_camera(camera);
    Background work(render, picture);
    int ticks = 0;
    while (!work.tick(host)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(16)); // a host draws its interface here
        if (!work.pixels().empty() && ++ticks == 3)
            work.cancel();
    }
    if (work.pixels().size() != 120 * 80 * 3)
        return fail("the picture in the background");
    std::printf("plugin: all checks passed\n");
    return 0;
}
