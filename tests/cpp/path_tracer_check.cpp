// Compares the library's renderer with the reference path tracer of path_tracer.hpp, in the furnished demonstration
// room under coloured lamps. renders.hpp describes the statistical tests.
//
// `path_tracer_check FACTOR` multiplies the reference tracer's lamps by FACTOR, to show that the check detects errors.
#include "path_tracer.hpp"
#include "renders.hpp"

#include <cstdlib>

namespace {

// Tests statistics.hpp against printed tables.
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
    const LitRoom room;
    const SceneCopy copy = read_scene(room.scene);
    const auto [library, variances] = render_with_library(room.scene);
    const PathTracer tracer(room, copy, factor);
    const std::vector<Picture> harness = render_with_harness(tracer);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        compare(library, harness, channel);
        compare_variances(library, variances, channel);
    }
    return check::summary("path_tracer_check");
}
