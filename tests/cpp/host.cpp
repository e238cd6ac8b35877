// What hosts do to their processes: change the floating-point mode and the locale, give threads small stacks, fork, have two
// plug-ins with a context each, have threads of OpenMP and TBB of their own. None of it changes a result, and the library changes nothing of theirs.
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

#ifdef _OPENMP // not where every thread's accesses are watched (tests/sanitize.sh): these pools synchronise unseen
#include <omp.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#endif

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace {

// Results as they lie in memory: the host's own arithmetic would be in the host's mode.
using Bytes = std::vector<unsigned char>;

// An image with denormals, made before any mode is changed.
const std::vector<float> TINY = [] {
    std::vector<float> samples(30);
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = 1e-39f * float(i) + (i % 3 ? 0.1f : 0.0f);
    return samples;
}();

// Some of everything that computes, on the calling thread and on the library's: a photo of the generated office and what is
// read from it, a scene's light and a stylised picture, to be compared to the bit.
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

    // Arithmetic on the calling thread; denormals and roundings in every step.
    const double from[] = {0, 0, 1, 0, 1, 1, 0, 1}, to[] = {3, 1, 17.1, 2.3, 15.7, 13.9, 1e-3, 12.1};
    add(luxfer::homography_from_corners(context, from, to));
    const auto image = luxfer::Image::create(context, {TINY, 5, 2});
    const double shrink[] = {1.7, 0, 0.3, 0, 1.3, 0.1, 0, 0, 1};
    add_image(image);
    add_image(image.warp(shrink, 3, 2));

    // Jobs.
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

// Modes of the host's thread; the context's threads are started in them too.
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
    const unsigned standard = _mm_getcsr(), flush = 0x8040; // denormals to zero, in and out
    _mm_setcsr(standard | flush);
    const bool is_same = everything(luxfer::Context::create()) == expected;
    const bool is_kept = (_mm_getcsr() & flush) == flush;
    _mm_setcsr(standard);
    CHECK(is_same);
    CHECK(is_kept);

    // Traps: what divides by zero inside must not end a host that asks to be told of its own divisions.
    std::feclearexcept(FE_ALL_EXCEPT);
    _mm_setcsr(_mm_getcsr() & ~(_MM_MASK_DIV_ZERO | _MM_MASK_INVALID | _MM_MASK_OVERFLOW));
    const bool is_same_with_traps = everything(luxfer::Context::create()) == expected;
    _mm_setcsr(standard);
    CHECK(is_same_with_traps);
#endif
}

void locales(const luxfer::Context &context, const Bytes &expected) {
    for (const char *name : {"de_DE.UTF-8", "tr_TR.UTF-8", "C"}) {
        if (std::setlocale(LC_ALL, name) != nullptr) // not every machine has them
            CHECK(everything(context) == expected);
    }
}

// Plug-ins are called on threads whose stack is not theirs to choose.
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
// Hosts have pools of their own; the library is called from within them, on all of their threads at once, and leaves them
// as they are.
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

// A child that does not use the library may come and go, also while jobs run.
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
