// The library's renderer against the harness's own path tracer (gallery_tracer.hpp), on every kind of material under every
// kind of light. How they are compared: see renders.hpp.
//
// `material_check FACTOR` makes the harness's lights brighter by a factor, for seeing that the check notices.
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
