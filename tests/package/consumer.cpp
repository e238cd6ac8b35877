// A C++ program that uses an installed luxfer.
#include <luxfer.hpp>

#include <cstdio>

int main() {
    const luxfer::Context context = luxfer::Context::create();
    const luxfer::Scene scene = luxfer::Scene::demo(context, LUXFER_DEMO_TARGET_ROOM);
    std::printf("C++: luxfer %s\n", luxfer_get_version_string());
    return scene.counts().meshes > 0 ? 0 : 1;
}
