// Measures the time from dlopen to the first result, as a host sees it that loads the library when a user first needs
// it: load, create a context, copy in an image of 64 x 64 pixels, turn it by half a turn, read it back, release all.
// Each measurement takes a fresh process, whose files are in the memory of the system after the first one. Prints the
// median and the range; only a bound that a loaded machine keeps too makes the test fail, or a wrong pixel.
//
//   start_up LIBRARY [PROCESSES, 11 by default]
#include <luxfer.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t SIZE = 64;
// Milliseconds that no machine should need.
constexpr double BOUND = 2000;

struct Times {
    double load, context, result;
};

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

template <class Function>
Function *find(void *library, const char *name) {
    auto *found = reinterpret_cast<Function *>(dlsym(library, name));
    if (found == nullptr) {
        std::fprintf(stderr, "%s\n", dlerror());
        _exit(1);
    }
    return found;
}

// Reports a failure and ends the process.
void expect(bool holds, const char *what) {
    if (!holds) {
        std::fprintf(stderr, "start_up: %s\n", what);
        _exit(1);
    }
}

float sample(std::uint32_t i) { return static_cast<float>(i % 251); }

// Turns an image by half a turn, which maps the centre of each pixel to the centre of another.
void turn_an_image(void *library, luxfer_context *context) {
    std::vector<float> pixels(SIZE * SIZE), turned(SIZE * SIZE);
    for (std::uint32_t i = 0; i < SIZE * SIZE; ++i)
        pixels[i] = sample(i);
    luxfer_image_view view;
    expect(find<decltype(luxfer_init)>(library, "luxfer_init")(LUXFER_STRUCT_IMAGE_VIEW, &view, sizeof view) == LUXFER_OK, "luxfer_init");
    view.channels = 1;
    view.width = view.height = SIZE;
    view.byte_size = SIZE * SIZE * sizeof(float);
    view.data = pixels.data();
    luxfer_image *image = nullptr, *warped = nullptr;
    const double half_turn[9] = {-1, 0, SIZE, 0, -1, SIZE, 0, 0, 1};
    expect(find<decltype(luxfer_image_create)>(library, "luxfer_image_create")(context, &view, &image) == LUXFER_OK, "luxfer_image_create");
    expect(find<decltype(luxfer_image_warp)>(library, "luxfer_image_warp")(image, half_turn, SIZE, SIZE, &warped) == LUXFER_OK,
           "luxfer_image_warp");
    view.data = turned.data();
    expect(find<decltype(luxfer_image_read)>(library, "luxfer_image_read")(warped, 0, &view) == LUXFER_OK, "luxfer_image_read");
    auto *release = find<decltype(luxfer_release)>(library, "luxfer_release");
    expect(release(warped) == LUXFER_OK && release(image) == LUXFER_OK, "luxfer_release");
    for (std::uint32_t i = 0; i < SIZE * SIZE; ++i)
        expect(std::abs(turned[i] - sample(SIZE * SIZE - 1 - i)) < 1e-3F, "a pixel is wrong");
}

Times measure(const char *path) {
    Times times{};
    const auto start = Clock::now();
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        std::fprintf(stderr, "%s\n", dlerror());
        _exit(1);
    }
    times.load = milliseconds_since(start);
    luxfer_context *context = nullptr;
    expect(find<decltype(luxfer_context_create)>(library, "luxfer_context_create")(nullptr, &context) == LUXFER_OK, "luxfer_context_create");
    times.context = milliseconds_since(start);
    turn_an_image(library, context);
    times.result = milliseconds_since(start);
    expect(find<decltype(luxfer_release)>(library, "luxfer_release")(context) == LUXFER_OK, "luxfer_release");
    return times;
}

// Measures in a process of its own; returns whether it has ended well.
bool measure_in_a_process(const char *path, Times &times) {
    int ends[2];
    if (pipe(ends) != 0)
        return false;
    const pid_t child = fork();
    if (child == 0) {
        const Times measured = measure(path);
        _exit(write(ends[1], &measured, sizeof measured) == static_cast<ssize_t>(sizeof measured) ? 0 : 1);
    }
    close(ends[1]);
    const bool read_all = read(ends[0], &times, sizeof times) == static_cast<ssize_t>(sizeof times);
    close(ends[0]);
    int status = 1;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0 && read_all;
}

} // namespace

int main(int count, char **arguments) {
    if (count < 2) {
        std::fprintf(stderr, "start_up LIBRARY [PROCESSES]\n");
        return 2;
    }
    const int processes = std::max(count > 2 ? std::atoi(arguments[2]) : 11, 1);
    std::vector<Times> all(static_cast<std::size_t>(processes));
    for (Times &times : all) {
        if (!measure_in_a_process(arguments[1], times))
            return 1;
    }
    std::sort(all.begin(), all.end(), [](const Times &a, const Times &b) { return a.result < b.result; });
    const Times &middle = all[all.size() / 2];
    std::printf("start-up: %.2f ms from dlopen to the first result (median of %zu processes; %.2f to %.2f ms): load %.2f ms, "
                "context %.2f ms, image %.2f ms\n",
                middle.result, all.size(), all.front().result, all.back().result, middle.load, middle.context - middle.load,
                middle.result - middle.context);
    if (middle.result > BOUND) {
        std::fprintf(stderr, "more than %.0f ms\n", BOUND);
        return 1;
    }
    return 0;
}
