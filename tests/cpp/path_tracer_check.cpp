// The library's renderer against the harness's own path tracer (path_tracer.hpp), on the furnished demonstration room
// under coloured lamps.
//
// Both render REPLICATES independent images of the same view, so that the scatter of a pixel among them gives the variance
// of its mean, whatever stratification does inside one. For each channel:
// - each pixel, Welch's t-test: at 1 % corrected for the number of pixels (Šidák), 99.75 % of the pixels are accepted;
// - the share of pixels rejected at an uncorrected 1 % lies in its binomial 99.9 % interval: not more than chance rejects
//   (a small error everywhere would), and not fewer (a variance that is stated too large would hide one);
// - the mean of the image, Welch's t-test at 0.1 %: sees a common factor that no single pixel does.
// The seeds are fixed, so a pass is a pass every time.
//
// `path_tracer_check FACTOR` makes the harness's lamps brighter by a factor, for seeing that the check notices.
#include "path_tracer.hpp"
#include "statistics.hpp"

#include <atomic>
#include <cstdlib>
#include <thread>

namespace {

constexpr std::uint32_t WIDTH = 64, HEIGHT = 36, REPLICATES = 24;
constexpr std::uint32_t SAMPLES = 64;
constexpr std::size_t PIXELS = std::size_t(WIDTH) * HEIGHT;

// One image: three channels for each pixel.
using Picture = std::vector<float>;

std::vector<Picture> render_with_library(const LitRoom &room) {
    luxfer_render *render = nullptr;
    CHECK_OK(luxfer_render_create(room.context, &render));
    CHECK_OK(luxfer_render_set_scene(render, room.scene));
    std::vector<Picture> pictures;
    for (std::uint32_t i = 0; i < REPLICATES; ++i) {
        luxfer_render_params params;
        CHECK_OK(luxfer_render_params_init(&params, sizeof params));
        params.width = WIDTH;
        params.height = HEIGHT;
        params.samples = SAMPLES;
        params.seed = 1000 + i;
        luxfer_job *job = nullptr;
        CHECK_OK(luxfer_render_start(render, &params, &job));
        CHECK_OK(luxfer_job_wait(job, -1, nullptr, nullptr));
        CHECK_OK(luxfer_job_release(job));
        luxfer_image *image = nullptr;
        CHECK_OK(luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, &image));
        pictures.push_back(read_image(image).pixels);
        CHECK_OK(luxfer_image_release(image));
    }
    CHECK_OK(luxfer_render_release(render));
    return pictures;
}

std::vector<Picture> render_with_harness(const PathTracer &tracer) {
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

void compare(const std::vector<Picture> &library, const std::vector<Picture> &harness, std::size_t channel) {
    const auto [low, high] = statistics::binomial_interval(PIXELS, 0.01, 0.001);
    const double sidak = 1 - std::pow(1 - 0.01, 1.0 / PIXELS);
    std::size_t rejected = 0, rejected_uncorrected = 0;
    double relative_error = 0, least_p = 1;
    for (std::size_t i = 0; i < PIXELS; ++i) {
        statistics::Sample a, b;
        for (std::uint32_t r = 0; r < REPLICATES; ++r) {
            a.add(library[r][3 * i + channel]);
            b.add(harness[r][3 * i + channel]);
        }
        const double p = statistics::welch_p(a, b);
        rejected += p < sidak;
        rejected_uncorrected += p < 0.01;
        least_p = std::min(least_p, p);
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
                "RGB"[channel], rejected, PIXELS, least_p, rejected_uncorrected, low, high, 100 * relative_error);
    std::printf("   image means %.4f and %.4f cd/m2, ratio %.5f +- %.5f, p %.3f\n", image_a.mean, image_b.mean,
                image_a.mean / image_b.mean,
                std::sqrt(image_a.variance_of_mean() + image_b.variance_of_mean()) / image_b.mean, image_p);
    CHECK(double(PIXELS - rejected) >= 0.9975 * double(PIXELS));
    CHECK(rejected_uncorrected >= low && rejected_uncorrected <= high);
    CHECK(image_p >= 0.001);
}

// Quantiles from printed tables.
void check_statistics() {
    CHECK(std::abs(statistics::student_p(2.0687, 23) - 0.05) < 1e-5);
    CHECK(std::abs(statistics::student_p(-12.7062, 1) - 0.05) < 1e-5);
    CHECK(std::abs(statistics::student_p(4.0150, 40) / 0.000254158 - 1) < 1e-4);
    CHECK(statistics::binomial_interval(20, 0.5, 0.05) == std::make_pair(std::size_t(6), std::size_t(14)));
}

} // namespace

int main(int argc, char **argv) {
    const double factor = argc > 1 ? std::atof(argv[1]) : 1.0;
    check_statistics();
    LitRoom room;
    const SceneCopy copy = read_scene(room.scene);
    const std::vector<Picture> library = render_with_library(room);
    const PathTracer tracer(room, copy, factor);
    const std::vector<Picture> harness = render_with_harness(tracer);
    for (std::size_t channel = 0; channel < 3; ++channel)
        compare(library, harness, channel);
    return check::summary("path_tracer_check");
}
