// An independent reference path tracer for the gallery, as simple as possible. It traces rays with Embree and shares
// no code with the library.
//
// At each vertex it chooses uniformly among the surface's ways to scatter light: cosine-weighted scattering, mirror
// reflection, and straight transmission. It samples all lights except the sky at every vertex; the sky contributes
// when a path leaves the scene. The material model is the one that the library documents: glTF 2.0, appendix B, with
// height-correlated Smith masking, Schlick's Fresnel term, a diffuse layer that gets the light that the reflecting
// layer lets through on the way in and out (Kelemen and Szirmay-Kalos 2001), and clear transmission without
// refraction.
#pragma once

#include "embree_scene.hpp"
#include "gallery.hpp"
#include "random.hpp"

#include <array>

inline double schlick(double f0, double f90, double cosine) { return f0 + (f90 - f0) * std::pow(1 - cosine, 5); }

// Smith's function Λ of the GGX distribution, for the cosine between a direction and the normal.
inline double smith(double cosine, double alpha) {
    return (std::sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1) / 2;
}

// The albedo of a reflecting layer, for light from one direction and for uniform light from all directions (`mean`).
class Coat {
public:
    Coat(double f0, double roughness) : f0(f0), smooth(roughness == 0) {
        if (smooth) {
            mean = f0 + (1 - f0) / 21;
            return;
        }
        const double alpha = roughness * roughness;
        for (int i = 0; i <= STEPS; ++i)
            values.push_back(integrate(std::max(double(i) / STEPS, 1e-3), alpha));
        // The mean albedo is twice the integral of albedo times cosine, by Simpson's rule.
        mean = 0;
        for (int i = 0; i <= STEPS; ++i)
            mean += (i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2) * values[std::size_t(i)] * (double(i) / STEPS) * 2 / (3.0 * STEPS);
    }

    double at(double cosine) const {
        if (smooth)
            return schlick(f0, 1, cosine);
        const double x = std::min(cosine, 1.0) * STEPS;
        const std::size_t i = std::min(std::size_t(x), std::size_t(STEPS - 1));
        return values[i] + (values[i + 1] - values[i]) * (x - double(i));
    }

    // Factor of the diffuse reflection between two directions: the light that passes the reflecting layer on the way
    // in and out, normalised so that a white diffuse layer and the reflecting layer together reflect all light.
    double left(double one, double other) const { return (1 - at(one)) * (1 - at(other)) / (1 - mean); }

private:
    static constexpr int STEPS = 64;
    double f0, mean = 0;
    bool smooth;
    std::vector<double> values;

    // The albedo for one direction: integrates over the microfacets, weighted by projected area.
    double integrate(double cosine, double alpha) const {
        const int n = 200;
        const double sine = std::sqrt(1 - cosine * cosine);
        double sum = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double u = (i + 0.5) / n, angle = 2 * M_PI * (j + 0.5) / n;
                const double z = std::sqrt((1 - u) / (1 + (alpha * alpha - 1) * u)), r = std::sqrt(1 - z * z);
                const double oh = sine * r * std::cos(angle) + cosine * z, out = 2 * oh * z - cosine;
                if (oh > 0 && out > 0)
                    sum += schlick(f0, 1, oh) * oh / (cosine * z * (1 + smith(cosine, alpha) + smith(out, alpha)));
            }
        return sum / (double(n) * n);
    }
};

class GalleryTracer {
public:
    GalleryTracer(const Gallery &gallery, const SceneCopy &copy, double light_scale)
        : gallery(gallery), copy(copy), embree(copy), scale(light_scale) {
        for (const Panel &panel : panels()) {
            const double f0 = std::pow((panel.ior - 1) / (panel.ior + 1), 2);
            const double roughness = panel.layered ? 16 / 31.0 : panel.roughness;
            coats.emplace_back(f0, roughness);
        }
    }

    Vec radiance(double x, double y, double aspect, Random &random) const {
        const luxfer_camera_params &camera = copy.camera;
        const Vec position = vec(camera.position), forward = normalised(vec(camera.target) - position);
        const Vec right = normalised(cross(forward, vec(camera.up))), up = cross(right, forward);
        const double half = std::tan(camera.fov_y / 2.0);
        return trace(position, normalised(forward + right * ((2 * x - 1) * half * aspect) + up * ((1 - 2 * y) * half)),
                     random);
    }

private:
    static constexpr std::uint32_t FLOOR = 0, LAMP = 1, FIRST_PANEL = 2;
    static constexpr double CLEARANCE = 4e-6;

    // A point on a surface and its material there; normals point to the viewer's side.
    struct Point {
        Vec position, normal, shading, to_viewer, diffuse, f0, transmission;
        double f90, roughness, dielectric_f0, opacity;
        const Coat *coat; // nullptr without a reflecting layer
        std::uint32_t mesh;
    };

    const Gallery &gallery;
    const SceneCopy &copy;
    EmbreeScene embree;
    double scale;
    std::vector<Coat> coats;

    RTCRayHit closest(Vec origin, Vec direction, double far = INFINITY) const {
        const float o[3] = {float(origin.x), float(origin.y), float(origin.z)};
        const float d[3] = {float(direction.x), float(direction.y), float(direction.z)};
        return embree.closest(o, d, 0, float(far));
    }

    Vec trace(Vec origin, Vec direction, Random &random) const {
        Vec sum, throughput = {1, 1, 1};
        bool sees_lamps = true; // whether a hit on the lamp adds its emission: not if `direct` sampled it
        for (int bounce = 0;;) {
            const RTCRayHit hit = closest(origin, direction);
            if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID)
                return sum + throughput * sky(direction) * scale;
            const Point p = describe(hit, direction);
            const auto leave = [&](Vec towards) {
                origin = p.position + p.normal * (dot(towards, p.normal) > 0 ? CLEARANCE : -CLEARANCE);
                direction = towards;
            };
            if (random.next() >= p.opacity) {
                leave(direction);
                continue;
            }
            if (p.mesh == LAMP && sees_lamps && direction.y > 0)
                sum = sum + throughput * gallery.lamp_emission * scale;
            sum = sum + throughput * direct(p, random);

            // Continue by cosine-weighted scattering, mirror reflection or straight transmission.
            const bool mirrors = p.coat && p.roughness == 0, passes = largest(p.transmission) > 0;
            const int ways = 1 + mirrors + passes, way = std::min(int(random.next() * ways), ways - 1);
            const double cosine = dot(p.shading, p.to_viewer);
            if (way == 0) {
                const Vec next = spread(p.shading, random);
                throughput = throughput * (scattered(p, next) * (M_PI * ways));
                sees_lamps = false;
                if (dot(next, p.normal) <= 0)
                    return sum;
                leave(next);
            } else if (way == 1 && mirrors) {
                const Vec next = p.shading * (2 * cosine) - p.to_viewer;
                if (dot(next, p.normal) <= 0)
                    return sum;
                throughput = throughput * (fresnel(p, cosine) * double(ways));
                sees_lamps = true;
                leave(next);
            } else {
                const double lost = p.coat ? schlick(p.dielectric_f0, p.f90, dot(p.normal, p.to_viewer)) : 0;
                throughput = throughput * (p.transmission * ((1 - lost) * ways));
                leave(direction);
            }
            if (++bounce > 3) {
                const double survival = std::min(0.95, largest(throughput));
                if (!(random.next() < survival))
                    return sum;
                throughput = throughput * (1 / survival);
            }
            if (largest(throughput) == 0)
                return sum;
        }
    }

    Point describe(const RTCRayHit &hit, Vec direction) const {
        const std::uint32_t index = hit.hit.geomID;
        const MeshCopy &mesh = copy.meshes[index];
        const double weight[3] = {1.0 - hit.hit.u - hit.hit.v, hit.hit.u, hit.hit.v};
        Point p = {};
        p.mesh = index;
        p.to_viewer = direction * -1;
        double u = 0, v = 0;
        for (int i = 0; i < 3; ++i) {
            p.position = p.position + mesh.corner(hit.hit.primID, i) * weight[i];
            u += mesh.uvs[2 * std::size_t(mesh.corners(hit.hit.primID)[i])] * weight[i];
            v += mesh.uvs[2 * std::size_t(mesh.corners(hit.hit.primID)[i]) + 1] * weight[i];
        }
        // All quads are horizontal, with u along z and v along x; only the lamp faces down.
        const Vec up = index == LAMP ? Vec{0, -1, 0} : Vec{0, 1, 0};
        const double side = dot(up, direction) > 0 ? -1 : 1;
        p.normal = up * side;
        p.shading = p.normal;
        p.opacity = 1;
        if (index < FIRST_PANEL) {
            const double grey = index == FLOOR ? 0.5 : 0.0;
            p.diffuse = {grey, grey, grey};
            return p;
        }
        const Panel &panel = panels()[index - FIRST_PANEL];
        Vec colour = panel.colour;
        double metallic = panel.metallic, alpha = panel.alpha;
        p.roughness = panel.roughness;
        if (panel.textured) {
            const auto texel = bilinear(gallery.colours, u, v);
            colour = colour * Vec{texel[0], texel[1], texel[2]};
            alpha *= texel[3];
        }
        if (panel.layered) {
            const auto texel = bilinear(gallery.layers, u, v);
            p.roughness *= texel[1];
            metallic *= texel[2];
        }
        if (panel.alpha_mode == LUXFER_ALPHA_MASK)
            p.opacity = alpha >= CUTOFF ? 1 : 0;
        if (panel.alpha_mode == LUXFER_ALPHA_BLEND)
            p.opacity = alpha;
        if (panel.bumpy) {
            const auto texel = bilinear(gallery.normals, u, v);
            // Red tilts the normal along u, which is +z; green tilts it up in the picture, against v, which is +x.
            p.shading = normalised(Vec{0, 0, 1} * ((2 * texel[0] - 1) * NORMAL_SCALE) +
                                   Vec{-1, 0, 0} * ((2 * texel[1] - 1) * NORMAL_SCALE) + up * (2 * texel[2] - 1)) *
                        side;
        }
        const double seen = dot(p.shading, p.to_viewer);
        if (seen < 1e-3)
            p.shading = normalised(p.shading + p.to_viewer * (1e-3 - seen));
        p.dielectric_f0 = std::pow((panel.ior - 1) / (panel.ior + 1), 2);
        p.f90 = panel.ior > 1 ? 1 : metallic;
        p.diffuse = colour * ((1 - metallic) * (1 - panel.transmission));
        p.transmission = colour * ((1 - metallic) * panel.transmission);
        const double base = p.dielectric_f0 * (1 - metallic);
        p.f0 = Vec{base, base, base} + colour * metallic;
        p.coat = p.f90 > 0 ? &coats[index - FIRST_PANEL] : nullptr;
        return p;
    }

    static std::array<double, 4> bilinear(const TextureCopy &texture, double u, double v) {
        const double x = u * texture.width - 0.5, y = v * texture.height - 0.5, left = std::floor(x), top = std::floor(y);
        std::array<double, 4> sum = {0, 0, 0, texture.channels < 4 ? 1.0 : 0.0};
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                const auto column = std::size_t(left + i + texture.width) % texture.width;
                const auto row = std::size_t(top + j + texture.height) % texture.height;
                const float *texel = &texture.pixels[(row * texture.width + column) * texture.channels];
                const double weight = (i == 0 ? 1 - (x - left) : x - left) * (j == 0 ? 1 - (y - top) : y - top);
                for (std::size_t c = 0; c < texture.channels; ++c)
                    sum[c] += texel[c] * weight;
            }
        return sum;
    }

    // The sky image wraps around horizontally and is clamped at the poles.
    Vec sky(Vec direction) const {
        const double u = 0.5 + std::atan2(direction.x, -direction.z) / (2 * M_PI), v = std::acos(direction.y) / M_PI;
        const double y = std::min(std::max(v * SKY_HEIGHT, 0.5), SKY_HEIGHT - 0.5) / SKY_HEIGHT;
        const auto texel = bilinear(gallery.sky, u, y);
        return Vec{texel[0], texel[1], texel[2]} * SKY_STRENGTH;
    }

    static Vec fresnel(const Point &p, double cosine) {
        return {schlick(p.f0.x, p.f90, cosine), schlick(p.f0.y, p.f90, cosine), schlick(p.f0.z, p.f90, cosine)};
    }

    // The BSDF (per steradian) without mirror reflection and transmission.
    Vec scattered(const Point &p, Vec to_light) const {
        const double no = dot(p.shading, p.to_viewer), ni = dot(p.shading, to_light);
        if (ni <= 0 || no <= 0 || dot(p.normal, to_light) <= 0)
            return {};
        if (!p.coat)
            return p.diffuse * (1 / M_PI);
        Vec sum = p.diffuse * (p.coat->left(no, ni) / M_PI);
        if (p.roughness > 0) {
            const Vec h = normalised(p.to_viewer + to_light);
            const double alpha = p.roughness * p.roughness, nh = dot(p.shading, h), d = nh * nh * (alpha * alpha - 1) + 1;
            const double distribution = alpha * alpha / (M_PI * d * d);
            sum = sum + fresnel(p, dot(p.to_viewer, h)) *
                            (distribution / (4 * no * ni * (1 + smith(no, alpha) + smith(ni, alpha))));
        }
        return sum;
    }

    // Reflected light from all lights except the sky.
    Vec direct(const Point &p, Random &random) const {
        Vec sum;
        for (const luxfer_light_params *light : {&gallery.point, &gallery.spot}) {
            const Vec way = vec(light->position) - p.position, towards = normalised(way);
            double share = 1;
            if (light->kind == LUXFER_LIGHT_SPOT) {
                const double outer = std::cos(light->outer_angle), inner = std::cos(light->inner_angle);
                const double x = (-dot(towards, normalised(vec(light->direction))) - outer) / (inner - outer);
                share = std::pow(std::min(std::max(x, 0.0), 1.0), 2);
            }
            sum = sum + received(p, towards, length(way)) * vec(light->intensity) * (share / dot(way, way));
        }
        const Vec towards = normalised(vec(gallery.distant.direction)) * -1;
        sum = sum + received(p, towards, 100) * vec(gallery.distant.intensity);
        const Vec on_lamp = gallery.lamp_corner + gallery.lamp_u * random.next() + gallery.lamp_v * random.next();
        const Vec way = on_lamp - p.position, to_lamp = normalised(way);
        if (p.mesh != LAMP && to_lamp.y > 0) {
            const double area = length(gallery.lamp_u) * length(gallery.lamp_v);
            sum = sum + received(p, to_lamp, length(way) * (1 - 1e-5)) * gallery.lamp_emission *
                            (to_lamp.y * area / dot(way, way));
        }
        return sum * scale;
    }

    // The BSDF times the cosine for light from a direction, times the share that reaches the point through panels on
    // the way.
    Vec received(const Point &p, Vec towards, double distance) const {
        const Vec value = scattered(p, towards) * dot(p.shading, towards);
        if (!(largest(value) > 0))
            return {};
        Vec share = {1, 1, 1}, from = p.position + p.normal * CLEARANCE;
        for (double left = distance - CLEARANCE;;) {
            const RTCRayHit hit = closest(from, towards, left);
            if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID)
                return value * share;
            const Point pane = describe(hit, towards);
            const double lost = pane.coat ? schlick(pane.dielectric_f0, pane.f90, dot(pane.normal, pane.to_viewer)) : 0;
            const double beside = 1 - pane.opacity;
            share = share * (Vec{beside, beside, beside} + pane.transmission * ((1 - lost) * pane.opacity));
            if (largest(share) == 0)
                return {};
            left -= hit.ray.tfar + CLEARANCE;
            from = pane.position + towards * CLEARANCE;
        }
    }

    static Vec spread(Vec normal, Random &random) {
        const double z2 = random.next(), angle = 2 * M_PI * random.next(), r = std::sqrt(1 - z2);
        const Vec aside = normalised(cross(std::abs(normal.x) < 0.7 ? Vec{1, 0, 0} : Vec{0, 1, 0}, normal));
        return normalised(aside * (r * std::cos(angle)) + cross(normal, aside) * (r * std::sin(angle)) +
                          normal * std::sqrt(z2));
    }
};
