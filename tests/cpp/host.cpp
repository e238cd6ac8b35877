// Tests the library in hosts that change the floating-point mode or the locale, give threads small stacks, fork, load
// two plug-ins with a context each, or use threads of OpenMP and TBB. None of these may change a result, and the
// library may not change the host's settings.
#include "check.hpp"

#include <luxfer.hpp>

#include <atomic>
#include <cfenv>
#include <clocale>
#include <cstdint>
#include <thread>
#include <vector>

#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef _OPENMP // not under ThreadSanitizer (tests/sanitize.sh), which does not see how these thread pools synchronise
#include <omp.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#endif

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace {

// Results are compared as bytes: arithmetic of this program would itself run in the changed floating-point mode.
using Bytes = std::vector<unsigned char>;

// Samples with denormals, computed before any mode is changed.
const std::vector<float> TINY = [] {
    std::vector<float> samples(30);
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = 1e-39f * float(i) + (i % 3 ? 0.1f : 0.0f);
    return samples;
}();

// Runs computations of every kind, on the calling thread and on the library's threads, and returns their results,
// which must be equal to the bit: a homography, a warp, a photo of the generated office, its vanishing points and
// features.
Bytes everything(const luxfer::Context &context) {
    Bytes out;
    const auto add = [&out](const auto &numbers) {
        const auto *bytes = reinterpret_cast<const unsigned char *>(std::data(numbers));
        out.insert(out.end(), bytes, bytes + std::size(numbers) * sizeof *std::data(numbers));
    };
    const auto add_image = [&add](const luxfer::Image &image) {
        const luxfer::ImageSize size = image.size();
        std::vector<float> plane(std::size_t(size.width) * size.height);
        for (std::uint32_t channel = 0; channel < size.channels; ++channel) {
            image.read({plane, size.width, size.height, 1}, channel);
            add(plane);
        }
    };

    // Arithmetic on the calling thread, with denormals and rounding in every step.
    const double from[] = {0, 0, 1, 0, 1, 1, 0, 1}, to[] = {3, 1, 17.1, 2.3, 15.7, 13.9, 1e-3, 12.1};
    add(luxfer::homography_from_corners(context, from, to));
    const auto image = luxfer::Image::create(context, {TINY, 5, 2});
    const double shrink[] = {1.7, 0, 0.3, 0, 1.3, 0.1, 0, 0, 1};
    add_image(image);
    add_image(image.warp(shrink, 3, 2));

    // Jobs, which run on the library's threads.
    luxfer::DemoPhotoParams small;
    small.width = 150;
    small.height = 100;
    small.samples = 4;
    const auto office = luxfer::DemoPhoto::create(context);
    office.start(small).wait();
    const luxfer::Image photo = office.image(LUXFER_DEMO_PHOTO_PICTURE);
    add_image(photo);
    const auto rectify = luxfer::Rectify::create(context);
    rectify.set_photo(photo);
    rectify.start().wait();
    const luxfer_rectify_report view = rectify.report();
    for (const auto &point : view.vanishing_points)
        add(point);
    const auto features = luxfer::Features::create(context);
    features.set_photo(photo);
    features.set_view(rectify);
    features.start().wait();
    add_image(features.image(LUXFER_FEATURES_CHANNELS));
    return out;
}

// Changes the floating-point mode of the host's thread. The threads of a new context start in that mode too.
void floating_point_modes(const Bytes &expected) {
    for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        std::fesetround(rounding);
        const bool is_same = everything(luxfer::Context::create()) == expected;
        const bool is_kept = std::fegetround() == rounding;
        std::fesetround(FE_TONEAREST);
        CHECK(is_same);
        CHECK(is_kept);
    }
#ifdef __SSE__
    const unsigned standard = _mm_getcsr(), flush = 0x8040; // treat denormal inputs and results as zero
    _mm_setcsr(standard | flush);
    const bool is_same = everything(luxfer::Context::create()) == expected;
    const bool is_kept = (_mm_getcsr() & flush) == flush;
    _mm_setcsr(standard);
    CHECK(is_same);
    CHECK(is_kept);

    // Enable traps: a division by zero inside the library must not end a host that traps its own divisions.
    std::feclearexcept(FE_ALL_EXCEPT);
    _mm_setcsr(_mm_getcsr() & ~(_MM_MASK_DIV_ZERO | _MM_MASK_INVALID | _MM_MASK_OVERFLOW));
    const bool is_same_with_traps = everything(luxfer::Context::create()) == expected;
    _mm_setcsr(standard);
    CHECK(is_same_with_traps);
#endif
}

void locales(const luxfer::Context &context, const Bytes &expected) {
    for (const char *name : {"de_DE.UTF-8", "tr_TR.UTF-8", "C"}) {
        if (std::setlocale(LC_ALL, name) != nullptr) // not every machine has these locales
            CHECK(everything(context) == expected);
    }
}

// Hosts call plug-ins on threads with small stacks.
void small_stack(const luxfer::Context &context, const Bytes &expected) {
    struct Work {
        const luxfer::Context &context;
        const Bytes &expected;
        bool is_same;
    } work{context, expected, false};
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, 64 << 10);
    pthread_t thread;
    const auto run = [](void *given) -> void * {
        Work &its = *static_cast<Work *>(given);
        its.is_same = everything(its.context) == its.expected;
        return nullptr;
    };
    CHECK(pthread_create(&thread, &attributes, run, &work) == 0);
    pthread_join(thread, nullptr);
    pthread_attr_destroy(&attributes);
    CHECK(work.is_same);
}

void two_contexts(const Bytes &expected) {
    bool same_in[2] = {false, false};
    std::thread plug_ins[2];
    for (int i = 0; i < 2; ++i)
        plug_ins[i] = std::thread([&expected, &is_same = same_in[i]] { is_same = everything(luxfer::Context::create()) == expected; });
    for (std::thread &plug_in : plug_ins)
        plug_in.join();
    CHECK(same_in[0] && same_in[1]);
}

#ifdef _OPENMP
// Hosts have thread pools of their own. They call the library on all threads of a pool at once, and it must leave the
// pools as they are.
void other_pools(const luxfer::Context &context, const Bytes &expected) {
    const int threads = omp_get_max_threads();
    int same = 0;
#pragma omp parallel for num_threads(3) reduction(+ : same)
    for (int i = 0; i < 3; ++i)
        same += everything(context) == expected;
    CHECK(same == 3);
    CHECK(omp_get_max_threads() == threads);

    const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    std::atomic<int> also{0};
    tbb::parallel_for(0, 3, [&](int) { also += everything(context) == expected; });
    CHECK(also == 3);
    CHECK(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) == allowed);
}
#endif

// The process may fork a child that does not use the library, even while jobs run.
void forks(const luxfer::Context &context, const Bytes &expected) {
    luxfer::DemoPhotoParams endless;
    endless.samples = 100000;
    const auto office = luxfer::DemoPhoto::create(context);
    const luxfer::Job job = office.start(endless);
    for (int i = 0; i < 10; ++i) {
        const pid_t child = fork();
        if (child == 0)
            _exit(7);
        int status = 0;
        CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 7);
    }
    job.cancel();
    CHECK(everything(context) == expected);
}

} // namespace

int main() {
    const auto context = luxfer::Context::create();
    const Bytes expected = everything(context);
    CHECK(expected.size() > 150 * 100 * 13 * sizeof(float));
    floating_point_modes(expected);
    locales(context, expected);
    small_stack(context, expected);
    two_contexts(expected);
#ifdef _OPENMP
    other_pools(context, expected);
#endif
    forks(context, expected);
    return check::summary("host");
}
