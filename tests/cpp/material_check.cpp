// Compares the library's renderer with the reference path tracer of gallery_tracer.hpp, for every kind of material
// under every kind of light. renders.hpp describes the statistical tests.
//
// `material_check FACTOR` multiplies the reference tracer's lights by FACTOR, to show that the check detects errors.
#include "gallery_tracer.hpp"
#include "renders.hpp"

#include <cstdlib>

int main(int argc, char **argv) {
    const double factor = argc > 1 ? std::atof(argv[1]) : 1.0;
    const Gallery gallery;
    const SceneCopy copy = read_scene(gallery.scene);
    const auto [library, variances] = render_with_library(gallery.scene);
    const GalleryTracer tracer(gallery, copy, factor);
    const std::vector<Picture> harness = render_with_harness(tracer);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        compare(library, harness, channel);
        compare_variances(library, variances, channel);
    }
    return check::summary("material_check");
}
