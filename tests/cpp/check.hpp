// A small test framework for the harnesses: a failed check prints its place, is counted, and does not end the program.
#pragma once

#include <luxfer.h>

#include <cstdio>
#include <string>

namespace check {

inline int failures = 0;

inline void that(bool ok, const char *what, const char *file, int line) {
    if (!ok) {
        std::fprintf(stderr, "%s:%d: failed: %s\n", file, line, what);
        ++failures;
    }
}

inline void status(luxfer_status got, luxfer_status want, const char *what, const char *file, int line) {
    if (got != want) {
        std::fprintf(stderr, "%s:%d: %s is %s, expected %s\n", file, line, what, luxfer_status_get_name(got),
                     luxfer_status_get_name(want));
        ++failures;
    }
}

inline std::string message(luxfer_context *context) {
    char text[1024] = "";
    luxfer_context_get_last_error(context, text, sizeof text, nullptr);
    return text;
}

// Prints whether all checks passed; returns the exit code for main.
inline int summary(const char *name) {
    std::printf("%s: %s\n", name, failures == 0 ? "all checks passed" : "FAILED");
    return failures == 0 ? 0 : 1;
}

} // namespace check

#define CHECK(condition) check::that((condition), #condition, __FILE__, __LINE__)
#define CHECK_STATUS(call, want) check::status((call), (want), #call, __FILE__, __LINE__)
#define CHECK_OK(call) CHECK_STATUS(call, LUXFER_OK)
