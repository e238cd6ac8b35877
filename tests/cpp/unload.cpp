// Loads the library with dlopen, uses it and unloads it, again and again, as a host does with plug-ins: nothing may
// remain that would call unloaded code. The first argument is the path of the library.
#include <luxfer.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include <dlfcn.h>

namespace {

std::size_t threads_of_this_process() {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto &thread : std::filesystem::directory_iterator("/proc/self/task"))
        ++count;
    return count;
}

// Whether this thread becomes the only one within a second. A joined thread has run all its code, but the kernel lists
// it for a moment longer.
bool is_alone() {
    for (int tries = 0; threads_of_this_process() != 1; ++tries) {
        if (tries == 1000)
            return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

template <class Function>
Function *find(void *library, const char *name) {
    return reinterpret_cast<Function *>(dlsym(library, name));
}

// Starts, cancels and releases a job; returns whether every call succeeded.
bool use(void *library) {
    luxfer_context *context = nullptr;
    luxfer_demo_photo *photo = nullptr;
    luxfer_job *job = nullptr;
    luxfer_status outcome = LUXFER_UNKNOWN;
    return find<decltype(luxfer_context_create)>(library, "luxfer_context_create")(nullptr, &context) == LUXFER_OK &&
           find<decltype(luxfer_demo_photo_create)>(library, "luxfer_demo_photo_create")(context, &photo) == LUXFER_OK &&
           find<decltype(luxfer_demo_photo_start)>(library, "luxfer_demo_photo_start")(photo, nullptr, &job) == LUXFER_OK &&
           find<decltype(luxfer_job_wait)>(library, "luxfer_job_wait")(job, 5, nullptr, nullptr, &outcome) == LUXFER_OK &&
           outcome == LUXFER_NOT_READY &&
           find<decltype(luxfer_release)>(library, "luxfer_release")(job) == LUXFER_OK &&
           find<decltype(luxfer_release)>(library, "luxfer_release")(photo) == LUXFER_OK &&
           find<decltype(luxfer_release)>(library, "luxfer_release")(context) == LUXFER_OK;
}

} // namespace

int main(int, char **arguments) {
    for (int round = 0; round < 20; ++round) {
        void *library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr) {
            std::fprintf(stderr, "%s\n", dlerror());
            return 1;
        }
        if (!use(library) || dlclose(library) != 0) {
            std::fprintf(stderr, "round %d: the library could not be used\n", round);
            return 1;
        }
        if (!is_alone()) {
            std::fprintf(stderr, "round %d: %zu threads are left\n", round, threads_of_this_process());
            return 1;
        }
    }
    std::printf("unload: loaded and unloaded 20 times\n");
    return 0;
}
