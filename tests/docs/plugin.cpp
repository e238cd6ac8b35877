// The skeleton of a plug-in for Maya, Houdini and similar hosts, with a simulated host of two arrays and a clock.
// Comments name the functions of the real hosts.
#include <luxfer.hpp>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

// --8<-- [start:host]
// A simulated host. The comments name the functions of real hosts.
struct HostMesh {
    std::string name;
    std::vector<float> points;            // Maya: MFnMesh::getRawPoints; Houdini: GU_Detail::getPos3 of each point
    std::vector<std::uint32_t> triangles; // Maya: MFnMesh::getTriangles; Houdini: its polygons, triangulated
    float colour[3] = {0.8f, 0.8f, 0.8f};
};

struct Host {
    double metres_per_unit = 1;               // Maya: 0.01, as its API uses centimetres; Houdini: 1
    std::vector<HostMesh> meshes;
    std::atomic<bool> is_interrupted{false}; // Maya: MComputation::isInterruptRequested; Houdini: UT_Interrupt::opInterrupt
    void show_progress(double) {}             // Maya: MProgressWindow::setProgress; Houdini: the same opInterrupt
    void report_error(const std::string &text) { std::fprintf(stderr, "%s\n", text.c_str()); } // MGlobal::displayError
};
// --8<-- [end:host]

// --8<-- [start:plugin]
// One context for the lifetime of the plug-in: it owns the threads. Another plug-in in this process may have its own
// context, or another version of the library.
class Plugin {
public:
    // Maya: in initializePlugin; Houdini: in newSopOperator, or at the first cook. Leave one core to the host for its
    // user interface.
    explicit Plugin(std::uint32_t threads) {
        luxfer::ContextParams params;
        params.num_threads = threads;
        context_ = luxfer::Context::create(params); // throws if the loaded library is not compatible
    }

    // Releasing the last object joins the threads; do it in uninitializePlugin, never in a static destructor.
    const luxfer::Context &context() const { return context_; }

private:
    luxfer::Context context_;
};
// --8<-- [end:plugin]

// --8<-- [start:scene]
// Describes the host's meshes as a scene: in metres, Y up, with transforms applied. The call copies the arrays.
luxfer::Scene describe(const luxfer::Context &context, const Host &host) {
    const auto scene = luxfer::Scene::create(context);
    for (const HostMesh &mesh : host.meshes) {
        std::vector<float> points = mesh.points;
        for (float &x : points)
            x = float(x * host.metres_per_unit);
        luxfer::MaterialParams material;
        std::copy(mesh.colour, mesh.colour + 3, material.base_color);
        luxfer::MeshParams params(points, mesh.triangles, scene.add_material(material));
        params.name = mesh.name.c_str(); // surfaces are found by this name
        scene.add_mesh(params);
    }
    return scene;
}
// --8<-- [end:scene]

// --8<-- [start:modal]
// A modal job, in a command or a cook: the host waits. The progress callback runs on the waiting thread, so it may
// call the host.
bool transfer_light(Host &host, const luxfer::Transfer &transfer, const luxfer::TransferParams &params) {
    try {
        transfer.start(params).wait([&](double fraction) {
            host.show_progress(fraction);
            return !host.is_interrupted; // false cancels; finished results stay readable
        });
        return true;
    } catch (const luxfer::Error &error) {
        if (error.status() != LUXFER_CANCELLED)
            host.report_error(error.what()); // for people: names the parameter, its value and its allowed range
        return false;
    }
}
// --8<-- [end:modal]

// --8<-- [start:background]
// A background job, which a timer of the host polls (Maya: MTimerMessage; Houdini: hou.ui.addEventLoopCallback). The
// image improves while a rendering runs, so each tick may show a better picture.
class Background {
public:
    Background(luxfer::Render render, const luxfer::RenderParams &params) : render_(render), job_(render.start(params)) {}

    // Returns true if the job has ended, without waiting.
    bool tick(Host &host) {
        const luxfer::JobState state = job_.poll();
        host.show_progress(state.fraction);
        show();
        return state.is_finished();
    }

    // Deleting the object also cancels; it waits until the job has ended, which takes at most about a tenth of a
    // second.
    void cancel() { job_.cancel(); }

    const std::vector<float> &pixels() const { return pixels_; }

private:
    void show() {
        try {
            pixels_ = render_.image().samples(); // linear, cd/m2
        } catch (const luxfer::Error &error) {
            if (error.status() != LUXFER_NOT_READY) // there is no picture before the first pass
                throw;
        }
    }

    luxfer::Render render_;
    luxfer::Job job_;
    std::vector<float> pixels_;
};
// --8<-- [end:background]

// --8<-- [start:result]
// The result for the host: the emissive texture, and the factor by which to multiply it, in cd/m2.
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

// A rectangle with a corner at (x, y, z) and edges u and v, in centimetres as in Maya.
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

    // In a real plug-in, the user provides the photo and the strokes.
    const auto demo = luxfer::DemoPhoto::create(context);
    luxfer::DemoPhotoParams photo;
    photo.width = 300;
    photo.height = 200;
    demo.start(photo).wait();
    const auto transfer = luxfer::Transfer::create(context);
    transfer.set_photo(demo.image(LUXFER_DEMO_PHOTO_PICTURE));
    transfer.set_scene(room, "Ceiling");
    transfer.set_strokes(luxfer::Strokes::from_image(demo.image(LUXFER_DEMO_PHOTO_STROKES)));

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

    // The user interrupts: the plug-in reports no error, and finished results remain.
    host.is_interrupted = true;
    if (transfer_light(host, transfer, params))
        return fail("an interrupted transfer is no success");

    // A background job shows pictures while it runs, and is cancelled.
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
