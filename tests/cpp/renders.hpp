// Compares independent images of one view by two renderers.
//
// Each renderer makes several images that differ only in their seeds. The scatter of a pixel among these images gives
// the variance of its mean, even though samples inside an image are stratified. The tests, for each channel:
// - Pixels: Welch's t-test at 1 %, corrected for the number of pixels (Šidák), accepts at least 99.75 % of the pixels.
// - Share of rejections: without the correction, the share of pixels rejected at 1 % lies in its binomial 99.9 %
// interval.
//   A small error everywhere would cause more rejections, and an overestimated variance fewer.
// - Image mean: Welch's t-test at 0.1 % detects a common factor that is too small to be seen in single pixels.
// - Stated variance: the variance that the library states for each pixel and the scatter among its images differ, over
// all
//   pixels, only by chance (at 0.1 %).
// The seeds are fixed, so the outcome is reproducible.
#pragma once

#include "random.hpp"
#include "scene_copy.hpp"
#include "statistics.hpp"

#include <atomic>
#include <thread>

constexpr std::uint32_t WIDTH = 64, HEIGHT = 36, REPLICATES = 24;
constexpr std::uint32_t SAMPLES = 64;
constexpr std::size_t PIXELS = std::size_t(WIDTH) * HEIGHT;

// An image with three channels per pixel, interleaved.
using Picture = std::vector<float>;

// Renders the replicates with the library; returns the images and the variances that the library states for them.
inline std::pair<std::vector<Picture>, std::vector<Picture>> render_with_library(const luxfer::Scene &scene) {
    const auto render = luxfer::Render::create(scene.context());
    render.set_scene(scene);
    luxfer::RenderParams params;
    params.width = WIDTH;
    params.height = HEIGHT;
    params.samples = SAMPLES;
    std::vector<Picture> pictures, variances;
    for (std::uint32_t i = 0; i < REPLICATES; ++i) {
        params.seed = 1000 + i;
        render.start(params).wait();
        pictures.push_back(render.image(LUXFER_RENDER_BEAUTY).samples());
        variances.push_back(render.image(LUXFER_RENDER_VARIANCE).samples());
    }
    return {pictures, variances};
}

template <class Tracer> std::vector<Picture> render_with_harness(const Tracer &tracer) {
    std::vector<Picture> pictures(REPLICATES, Picture(3 * PIXELS));
    std::atomic<std::uint32_t> next_row{0};
    const auto work = [&] {
        for (std::uint32_t task; (task = next_row++) < REPLICATES * HEIGHT;) {
            const std::uint32_t replicate = task / HEIGHT, y = task % HEIGHT;
            for (std::uint32_t x = 0; x < WIDTH; ++x) {
                Random random((std::uint64_t(replicate) << 40) + (std::uint64_t(y) << 20) + x);
                Vec sum;
                for (std::uint32_t s = 0; s < SAMPLES; ++s) {
                    const double u = (x + random.next()) / WIDTH, v = (y + random.next()) / HEIGHT;
                    sum = sum + tracer.radiance(u, v, double(WIDTH) / HEIGHT, random);
                }
                float *pixel = &pictures[replicate][3 * (std::size_t(y) * WIDTH + x)];
                pixel[0] = float(sum.x / SAMPLES);
                pixel[1] = float(sum.y / SAMPLES);
                pixel[2] = float(sum.z / SAMPLES);
            }
        }
    };
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
        threads.emplace_back(work);
    for (std::thread &thread : threads)
        thread.join();
    return pictures;
}

inline void compare(const std::vector<Picture> &library, const std::vector<Picture> &harness, std::size_t channel) {
    const auto [low, high] = statistics::binomial_interval(PIXELS, 0.01, 0.001);
    const double sidak = 1 - std::pow(1 - 0.01, 1.0 / PIXELS);
    std::size_t rejected = 0, rejected_uncorrected = 0;
    double relative_error = 0, min_p = 1;
    for (std::size_t i = 0; i < PIXELS; ++i) {
        statistics::Sample a, b;
        for (std::uint32_t r = 0; r < REPLICATES; ++r) {
            a.add(library[r][3 * i + channel]);
            b.add(harness[r][3 * i + channel]);
        }
        const double p = statistics::welch_p(a, b);
        rejected += p < sidak;
        rejected_uncorrected += p < 0.01;
        min_p = std::min(min_p, p);
        relative_error += std::sqrt(a.variance_of_mean() + b.variance_of_mean()) / std::max(b.mean, 1e-9) / PIXELS;
    }
    statistics::Sample image_a, image_b;
    for (std::uint32_t r = 0; r < REPLICATES; ++r) {
        double sum_a = 0, sum_b = 0;
        for (std::size_t i = 0; i < PIXELS; ++i) {
            sum_a += library[r][3 * i + channel] / double(PIXELS);
            sum_b += harness[r][3 * i + channel] / double(PIXELS);
        }
        image_a.add(sum_a);
        image_b.add(sum_b);
    }
    const double image_p = statistics::welch_p(image_a, image_b);
    std::printf("%c: %zu of %zu pixels rejected at the corrected 1 %% (least p %.1e), %zu at the uncorrected 1 %% "
                "(allowed %zu to %zu); standard error of a pixel's difference %.1f %%\n",
                "RGB"[channel], rejected, PIXELS, min_p, rejected_uncorrected, low, high, 100 * relative_error);
    std::printf("   image means %.4f and %.4f cd/m2, ratio %.5f +- %.5f, p %.3f\n", image_a.mean, image_b.mean,
                image_a.mean / image_b.mean,
                std::sqrt(image_a.variance_of_mean() + image_b.variance_of_mean()) / image_b.mean, image_p);
    CHECK(double(PIXELS - rejected) >= 0.9975 * double(PIXELS));
    CHECK(rejected_uncorrected >= low && rejected_uncorrected <= high);
    CHECK(image_p >= 0.001);
}

inline void compare_variances(const std::vector<Picture> &pictures, const std::vector<Picture> &variances, std::size_t channel) {
    statistics::Sample difference, scattered;
    for (std::size_t i = 0; i < PIXELS; ++i) {
        statistics::Sample value, stated;
        for (std::uint32_t r = 0; r < REPLICATES; ++r) {
            value.add(pictures[r][3 * i + channel]);
            stated.add(variances[r][3 * i + channel]);
        }
        // Divide by the pixel's squared brightness, so that bright pixels do not dominate the sum.
        const double square = std::max(value.mean * value.mean, 1e-12);
        const double scatter = value.variance_of_mean() * REPLICATES;
        difference.add((stated.mean - scatter) / square);
        scattered.add(scatter / square);
    }
    const double z = difference.mean / std::sqrt(difference.variance_of_mean());
    std::printf("%c: variances stated by the library are %.3f +- %.3f of the scatter, z %.2f\n", "RGB"[channel],
                1 + difference.mean / scattered.mean, std::sqrt(difference.variance_of_mean()) / scattered.mean, z);
    CHECK(std::abs(z) < 3.29);
}
