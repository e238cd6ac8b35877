// Compares the library's nearest hits with Embree's, in the furnished demonstration room with lamps on its ceiling.
//
// Both use watertight triangle tests in f32, but round differently. They agree on a ray if they name the same
// triangle, or if the distances differ by at most 1e-5 of the distance: at a shared edge, either triangle is right.
// The few remaining rays start within millimetres or centimetres of two coplanar surfaces (such as a skirting board on
// its wall), where the rounding of coordinates alone exceeds 1e-5 of the distance.
#include "embree_scene.hpp"
#include "lit_room.hpp"

#include <algorithm>
#include <limits>
#include <random>

namespace {

constexpr std::size_t RAYS = 1000000;

// Random rays: origins are uniform in the room, directions uniform on the sphere.
std::vector<luxfer_ray> make_rays() {
    std::mt19937_64 random(20240607);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<luxfer_ray> rays(RAYS);
    for (luxfer_ray &ray : rays) {
        const double size[3] = {6.0, 2.8, 4.0};
        for (int axis = 0; axis < 3; ++axis)
            ray.origin[axis] = float(unit(random) * size[axis]);
        const double z = 2 * unit(random) - 1, angle = 6.283185307179586 * unit(random), r = std::sqrt(1 - z * z);
        ray.direction[0] = float(r * std::cos(angle));
        ray.direction[1] = float(r * std::sin(angle));
        ray.direction[2] = float(z);
        ray.t_max = std::numeric_limits<float>::infinity();
    }
    return rays;
}

} // namespace

int main() {
    const LitRoom room;
    const SceneCopy copy = read_scene(room.scene);
    const EmbreeScene embree(copy);
    const std::vector<luxfer_ray> rays = make_rays();
    std::vector<luxfer_hit> hits(RAYS);
    room.scene.intersect(rays, hits);

    std::size_t same_triangle = 0, same_distance = 0, misses = 0, disagreed = 0, outside = 0;
    double worst_weight = 0;
    for (std::size_t i = 0; i < RAYS; ++i) {
        const luxfer_ray &ray = rays[i];
        const luxfer_hit &hit = hits[i];
        const RTCRayHit other = embree.closest(ray.origin, ray.direction, 0, ray.t_max);
        if (hit.mesh == LUXFER_NONE && other.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
            ++misses;
            continue;
        }
        const bool both = hit.mesh != LUXFER_NONE && other.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        if (both && hit.mesh == other.hit.geomID && hit.triangle == other.hit.primID) {
            ++same_triangle;
            // If the triangles are equal, distances and barycentric coordinates must agree too.
            const double off = std::abs(double(hit.t) - other.ray.tfar);
            outside += off > 1e-5 * std::max(1.0, double(hit.t));
            worst_weight = std::max(worst_weight, double(std::abs(hit.u - other.hit.u)));
            worst_weight = std::max(worst_weight, double(std::abs(hit.v - other.hit.v)));
        } else if (both && std::abs(double(hit.t) - other.ray.tfar) <= 1e-5 * other.ray.tfar) {
            ++same_distance;
        } else {
            ++disagreed;
        }
    }
    std::printf("%zu rays: %zu same triangle, %zu same distance, %zu both missed, %zu disagreed\n", RAYS, same_triangle,
                same_distance, misses, disagreed);
    std::printf("on the same triangle: %zu distances differ by more than 1e-5 m or 1e-5 of themselves, barycentric "
                "coordinates by at most %.1e\n",
                outside, worst_weight);
    CHECK(same_triangle + same_distance + disagreed > RAYS * 9 / 10); // the room is closed except for gaps
    CHECK(disagreed * 10000 <= RAYS);
    CHECK(outside * 10000 <= RAYS);
    return check::summary("embree_cross_check");
}
