// An independent reference path tracer for the demonstration room, as simple as possible. It traces rays with Embree.
//
// It shares no code with the library, only the scene, which it reads back through the library. The library combines
// two sampling techniques (MIS), traces in f32 and samples texels by their emission. This tracer samples only points
// that are uniform on the lamps (known from the harness, not from the scene's texture), computes in f64, and continues
// all paths in cosine-distributed directions. It covers the materials of the demonstration room: Lambertian surfaces
// and rough metals (GGX with height-correlated Smith masking and Schlick's Fresnel term, glTF 2.0 appendix B), shading
// normals, and textured base colours.
#pragma once

#include "embree_scene.hpp"
#include "lit_room.hpp"
#include "random.hpp"

#include <algorithm>

class PathTracer {
public:
    PathTracer(const LitRoom &room, const SceneCopy &copy, double emission_scale)
        : copy(copy), embree(copy), ceiling(room.ceiling), light_mesh(room.light_mesh), scale(emission_scale) {
        double sum = 0;
        for (const Lamp &lamp : lamps())
            areas.push_back(sum += double(lamp.right - lamp.left) * (lamp.bottom - lamp.top));
        const double texel = double(ceiling.size[0]) / LAMP_COLUMNS * ceiling.size[1] / LAMP_ROWS;
        lit_area = sum * texel;
    }

    // Estimates the radiance at a point (x, y) of the image; (0, 0) is the top-left corner, (1, 1) the bottom-right
    // one.
    Vec radiance(double x, double y, double aspect, Random &random) const {
        const luxfer_camera_params &camera = copy.camera;
        const Vec position = vec(camera.position), forward = normalised(vec(camera.target) - position);
        const Vec right = normalised(cross(forward, vec(camera.up))), up = cross(right, forward);
        const double half = std::tan(camera.fov_y / 2.0);
        const Vec direction = normalised(forward + right * ((2 * x - 1) * half * aspect) + up * ((1 - 2 * y) * half));
        return trace(position, direction, random);
    }

private:
    // A point on a surface and its material there; both normals point to the viewer's side.
    struct Point {
        Vec position, normal, shading, colour, to_viewer;
        double metallic, alpha;
        std::uint32_t mesh;
    };

    const SceneCopy &copy;
    EmbreeScene embree;
    luxfer_surface ceiling;
    std::uint32_t light_mesh;
    double scale, lit_area;
    std::vector<double> areas;

    Vec trace(Vec origin, Vec direction, Random &random) const {
        Vec sum, throughput = {1, 1, 1};
        for (int bounce = 0;; ++bounce) {
            const float o[3] = {float(origin.x), float(origin.y), float(origin.z)};
            const float d[3] = {float(direction.x), float(direction.y), float(direction.z)};
            const RTCRayHit hit = embree.closest(o, d, 0, INFINITY);
            if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID)
                return sum; // the ray has left the room through a gap; outside it is dark
            const Point point = describe(hit, direction);
            // Add a lamp's emission only if the camera sees it directly; `direct` samples all other light.
            if (bounce == 0 && point.mesh == light_mesh && dot(direction, vec(ceiling.normal)) < 0)
                sum = sum + emission_at(point.position);
            sum = sum + throughput * direct(point, random);

            // Continue in a cosine-distributed direction about the shading normal; end below the surface.
            const Vec next = spread(point.shading, random);
            if (dot(next, point.normal) <= 0)
                return sum;
            throughput = throughput * (reflectance(point, next) * M_PI); // BRDF times cosine / pdf
            if (bounce >= 3) {
                const double survival = std::min(0.95, largest(throughput));
                if (!(random.next() < survival))
                    return sum;
                throughput = throughput * (1 / survival);
            }
            if (largest(throughput) == 0)
                return sum;
            origin = point.position + point.normal * CLEARANCE;
            direction = next;
        }
    }

    // Distance from the surface at which rays start, in metres.
    static constexpr double CLEARANCE = 2e-6;

    Point describe(const RTCRayHit &hit, Vec direction) const {
        const MeshCopy &mesh = copy.meshes[hit.hit.geomID];
        const std::uint32_t *corners = mesh.corners(hit.hit.primID);
        const double weight[3] = {1.0 - hit.hit.u - hit.hit.v, hit.hit.u, hit.hit.v};
        Point point = {};
        point.mesh = hit.hit.geomID;
        point.to_viewer = direction * -1;
        Vec smooth;
        double uv[2] = {};
        for (int i = 0; i < 3; ++i) {
            point.position = point.position + mesh.corner(hit.hit.primID, i) * weight[i];
            if (!mesh.normals.empty())
                smooth = smooth + vec(&mesh.normals[3 * std::size_t(corners[i])]) * weight[i];
            for (int axis = 0; axis < 2 && !mesh.uvs.empty(); ++axis)
                uv[axis] += mesh.uvs[2 * std::size_t(corners[i]) + axis] * weight[i];
        }
        const Vec a = mesh.corner(hit.hit.primID, 0);
        point.normal = normalised(cross(mesh.corner(hit.hit.primID, 1) - a, mesh.corner(hit.hit.primID, 2) - a));
        if (dot(point.normal, direction) > 0)
            point.normal = point.normal * -1;
        // A shading normal may point to either side: flip it to the side of the geometric normal. If the viewer would
        // then see it from behind, tilt it until it is seen edge-on.
        point.shading = mesh.normals.empty() ? point.normal : normalised(smooth);
        if (dot(point.shading, point.normal) < 0)
            point.shading = point.shading * -1;
        const double cosine = dot(point.shading, point.to_viewer);
        if (cosine < 1e-3)
            point.shading = normalised(point.shading + point.to_viewer * (1e-3 - cosine));

        const MaterialCopy &material = copy.materials[mesh.material];
        point.colour = vec(material.params.base_color);
        if (material.base_color.texture != LUXFER_NONE)
            point.colour = point.colour * bilinear(material.base_color, uv[0], uv[1]);
        point.metallic = material.params.metallic;
        point.alpha = double(material.params.roughness) * material.params.roughness;
        return point;
    }

    // Looks up a texture with bilinear interpolation; textures of the room repeat.
    Vec bilinear(const luxfer_texture_use &use, double u, double v) const {
        const TextureCopy &texture = copy.textures[use.texture];
        const float *m = use.transform;
        const double x = (m[0] * u + m[1] * v + m[2]) * texture.width - 0.5;
        const double y = (m[3] * u + m[4] * v + m[5]) * texture.height - 0.5;
        const double left = std::floor(x), top = std::floor(y);
        Vec sum;
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                const auto column = std::size_t(wrapped(left + i, texture.width));
                const auto row = std::size_t(wrapped(top + j, texture.height));
                const float *texel = &texture.pixels[(row * texture.width + column) * texture.channels];
                const double weight = (i == 0 ? 1 - (x - left) : x - left) * (j == 0 ? 1 - (y - top) : y - top);
                sum = sum + (texture.channels < 3 ? Vec{texel[0], texel[0], texel[0]} : vec(texel)) * weight;
            }
        return sum;
    }

    static double wrapped(double i, double size) { return i - size * std::floor(i / size); }

    // The BRDF, per steradian.
    static Vec reflectance(const Point &p, Vec to_light) {
        const Vec diffuse = p.colour * ((1 - p.metallic) / M_PI);
        if (p.metallic == 0)
            return diffuse;
        const double no = dot(p.shading, p.to_viewer), ni = dot(p.shading, to_light);
        const Vec h = normalised(p.to_viewer + to_light);
        const double nh = dot(p.shading, h), a2 = p.alpha * p.alpha, d = nh * nh * (a2 - 1) + 1;
        const double distribution = a2 / (M_PI * d * d);
        const double visibility =
            0.5 / (ni * std::sqrt(no * no * (1 - a2) + a2) + no * std::sqrt(ni * ni * (1 - a2) + a2));
        const double grazing = std::pow(1 - dot(p.to_viewer, h), 5);
        const Vec fresnel = p.colour * (1 - grazing) + Vec{grazing, grazing, grazing};
        return diffuse + fresnel * (p.metallic * distribution * visibility);
    }

    // Reflected light from one point that is sampled uniformly on the lamps.
    Vec direct(const Point &p, Random &random) const {
        const double pick = random.next() * areas.back();
        const std::size_t index = std::size_t(std::upper_bound(areas.begin(), areas.end(), pick) - areas.begin());
        const Lamp &lamp = lamps()[std::min(index, areas.size() - 1)];
        const double u = (lamp.left + random.next() * (lamp.right - lamp.left)) / LAMP_COLUMNS;
        const double v = (lamp.top + random.next() * (lamp.bottom - lamp.top)) / LAMP_ROWS;
        const Vec normal = vec(ceiling.normal);
        const Vec on_lamp = vec(ceiling.origin) + vec(ceiling.u_axis) * (u * ceiling.size[0]) +
                            vec(ceiling.v_axis) * (v * ceiling.size[1]) + normal * CLEARANCE;
        const Vec from = p.position + p.normal * CLEARANCE;
        const Vec way = on_lamp - from;
        const double distance2 = dot(way, way);
        const Vec to_light = way * (1 / std::sqrt(distance2));
        const double here = dot(p.shading, to_light), there = -dot(normal, to_light);
        if (here <= 0 || there <= 0 || dot(p.normal, to_light) <= 0 || embree.blocked(from, on_lamp))
            return {};
        return reflectance(p, to_light) * lamp.emission * (scale * here * there / distance2 * lit_area);
    }

    Vec emission_at(Vec position) const {
        const Vec from_origin = position - vec(ceiling.origin);
        const double u = dot(from_origin, vec(ceiling.u_axis)) / ceiling.size[0];
        const double v = dot(from_origin, vec(ceiling.v_axis)) / ceiling.size[1];
        const Lamp *lamp = lamp_at(std::uint32_t(u * LAMP_COLUMNS), std::uint32_t(v * LAMP_ROWS));
        return lamp ? lamp->emission * scale : Vec{};
    }

    static Vec spread(Vec normal, Random &random) {
        const double z2 = random.next(), angle = 2 * M_PI * random.next(), r = std::sqrt(1 - z2);
        const Vec aside = normalised(cross(std::abs(normal.x) < 0.7 ? Vec{1, 0, 0} : Vec{0, 1, 0}, normal));
        return normalised(aside * (r * std::cos(angle)) + cross(normal, aside) * (r * std::sin(angle)) +
                          normal * std::sqrt(z2));
    }
};
