// Compares homographies, warped images and CIELAB with OpenCV's.
//
// OpenCV places the centre of the top-left pixel at (0, 0), the library at (0.5, 0.5). This does not matter for
// homographies between points; homographies between images are shifted by half a pixel on both sides.
#include "check.hpp"

#include <luxfer.hpp>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace {

using Quad = std::vector<cv::Point2f>;

// A random convex quadrilateral: a rectangle whose corners are moved by up to 30 % of its sides. OpenCV's
// getPerspectiveTransform multiplies coordinates in f32, so they are rounded to twelve bits, which makes products
// exact.
Quad random_quad(std::mt19937_64 &random, double size) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto rounded = [size](double v) { return float(std::round(v / size * 1024) * size / 1024); };
    const double w = (0.5 + unit(random)) * size, h = (0.5 + unit(random)) * size;
    const double x = (unit(random) - 0.5) * size, y = (unit(random) - 0.5) * size;
    Quad quad;
    for (const auto &[u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
        quad.emplace_back(rounded(x + w * (u + 0.3 * (2 * unit(random) - 1))),
                          rounded(y + h * (v + 0.3 * (2 * unit(random) - 1))));
    return quad;
}

cv::Matx33d with_library(const luxfer::Context &context, const Quad &from, const Quad &to) {
    std::array<double, 8> a, b;
    for (std::size_t i = 0; i < 4; ++i) {
        a[2 * i] = from[i].x;
        a[2 * i + 1] = from[i].y;
        b[2 * i] = to[i].x;
        b[2 * i + 1] = to[i].y;
    }
    return cv::Matx33d(luxfer::homography_from_corners(context, a, b).data());
}

// Expresses a homography in units of the quadrilaterals' sizes, so that all entries have similar weight, and scales it
// to unit norm with a positive largest entry.
cv::Matx33d normalised(const cv::Matx33d &h, double from_size, double to_size) {
    const auto scale = [](double s) { return cv::Matx33d(s, 0, 0, 0, s, 0, 0, 0, 1); };
    const cv::Matx33d unit = scale(1 / to_size) * h * scale(from_size);
    const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
    return unit * (std::copysign(1.0, *std::max_element(unit.val, unit.val + 9, smaller)) / cv::norm(unit));
}

// In these units, the equations of the quadrilaterals have condition numbers up to 2300. findHomography squares the
// condition number, so its error is at most 1e-9; the error of getPerspectiveTransform is far smaller.
void check_homographies(const luxfer::Context &context) {
    constexpr double RELATIVE = 1e-9;
    std::mt19937_64 random(11);
    for (const auto &[from_size, to_size] : {std::pair{1.0, 1.0}, {1.0, 1024.0}, {1024.0, 1024.0}, {4096.0, 512.0}}) {
        double worst_exact = 0, worst_found = 0;
        for (int i = 0; i < 400; ++i) {
            const Quad from = random_quad(random, from_size), to = random_quad(random, to_size);
            const auto unit = [&](const cv::Matx33d &h) { return normalised(h, from_size, to_size); };
            const cv::Matx33d ours = unit(with_library(context, from, to));
            const cv::Matx33d exact = unit(cv::getPerspectiveTransform(from, to, cv::DECOMP_LU));
            const cv::Matx33d found = unit(cv::findHomography(from, to, 0));
            worst_exact = std::max(worst_exact, cv::norm(ours - exact));
            worst_found = std::max(worst_found, cv::norm(ours - found));
        }
        std::printf("400 homographies from quads of size %g to %g: getPerspectiveTransform within %.1e, "
                    "findHomography within %.1e\n",
                    from_size, to_size, worst_exact, worst_found);
        CHECK(worst_exact <= RELATIVE);
        CHECK(worst_found <= RELATIVE);
    }
    // Points without a homography are an error.
    const double square[8] = {0, 0, 1, 0, 1, 1, 0, 1}, line[8] = {0, 0, 1, 0, 2, 0, 0, 1};
    const double nowhere[8] = {0, 0, 1, 0, 1, 1, 0, std::numeric_limits<double>::quiet_NaN()};
    double h[9];
    luxfer_context *const c = context.get();
    CHECK_STATUS(luxfer_homography_from_corners(c, line, square, h), LUXFER_DEGENERATE);
    CHECK_STATUS(luxfer_homography_from_corners(c, square, nowhere, h), LUXFER_DEGENERATE);
    CHECK_STATUS(luxfer_homography_from_corners(c, nullptr, square, h), LUXFER_INVALID_ARGUMENT);
    CHECK_STATUS(luxfer_homography_from_corners(c, square, square, nullptr), LUXFER_INVALID_ARGUMENT);
}

// A smooth picture: two sine waves of amplitude 0.25, `length` pixels long, in different directions for each channel.
struct Waves {
    double length;
    // Upper bounds of the slope and the curvature along an axis, per pixel and per square pixel.
    double slope() const { return 2 * 0.25 * 2 * M_PI / length; }
    double curvature() const { return 2 * 0.25 * std::pow(2 * M_PI / length, 2); }

    float value(double x, double y, int channel) const {
        const double k = 2 * M_PI / length, turn = 0.7 * channel;
        const double s = x * std::cos(turn) + y * std::sin(turn), t = y * std::cos(turn) - x * std::sin(turn);
        return float(0.5 + 0.25 * std::sin(k * s) + 0.25 * std::cos(k * t));
    }
    cv::Mat image(int width, int height) const {
        cv::Mat image(height, width, CV_32FC3);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < 3; ++c)
                    image.at<cv::Vec3f>(y, x)[c] = value(x + 0.5, y + 0.5, c);
        return image;
    }
};

// The pixels of an OpenCV image as samples for the library.
luxfer::Span<float> samples(const cv::Mat &image) {
    return {reinterpret_cast<float *>(image.data), image.total() * std::size_t(image.channels())};
}

cv::Mat warp_with_library(const luxfer::Context &context, const cv::Mat &source, const cv::Matx33d &to_source, cv::Size size) {
    const luxfer::ConstImageView view(samples(source), std::uint32_t(source.cols), std::uint32_t(source.rows));
    const auto width = std::uint32_t(size.width), height = std::uint32_t(size.height);
    cv::Mat out(size, CV_32FC3);
    luxfer::Image::create(context, view).warp(to_source.val, width, height).read({samples(out), width, height});
    return out;
}

// Warps with OpenCV by the same homography, converted to OpenCV's pixel centres.
cv::Mat warp_with_opencv(const cv::Mat &source, const cv::Matx33d &to_source, cv::Size size, int interpolation) {
    const cv::Matx33d half(1, 0, 0.5, 0, 1, 0.5, 0, 0, 1);
    cv::Mat out;
    cv::warpPerspective(source, out, half.inv() * to_source * half, size, interpolation | cv::WARP_INVERSE_MAP);
    return out;
}

struct Difference {
    double mean = 0, most = 0;
};

Difference difference(const cv::Mat &a, const cv::Mat &b) {
    cv::Mat d;
    cv::absdiff(a, b, d);
    const cv::Scalar mean = cv::mean(d);
    Difference found;
    found.mean = (mean[0] + mean[1] + mean[2]) / 3;
    cv::minMaxLoc(d.reshape(1), nullptr, &found.most);
    return found;
}

void check_difference(double minification, const Difference &found, double bound) {
    std::printf("unwarps at %.2f source pixels for each: mean difference %.1e (bound %.1e), largest %.1e (bound %.1e)\n",
                minification, found.mean, bound / 2, found.most, bound);
    CHECK(found.mean <= bound / 2);
    CHECK(found.most <= bound);
}

// A random homography from an output image of `size` into the interior of a source, which minifies by about
// `minification`.
cv::Matx33d random_map(const luxfer::Context &context, std::mt19937_64 &random, cv::Size size, cv::Size source,
                       double minification) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const double w = size.width * minification, h = size.height * minification;
    Quad to;
    for (const auto &[u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
        to.emplace_back(float(source.width / 2.0 + w * (u + 0.05 * unit(random))),
                        float(source.height / 2.0 + h * (v + 0.05 * unit(random))));
    const float right = float(size.width), bottom = float(size.height);
    return with_library(context, {{0, 0}, {right, 0}, {right, bottom}, {0, bottom}}, to);
}

// For magnification, the library interpolates cubically, and OpenCV linearly at positions rounded to 1/32 pixel. So on
// a smooth picture they may differ by the error of linear interpolation (curvature / 8 along each axis) and by the
// effect of a shift of 1/64 pixel along each axis; the error of cubic interpolation is of fourth order. The mean
// difference is less than half of this maximum: the interpolation error has the shape of a parabola, with a mean of
// 2/3, times a wave, with a mean of 2/pi.
void check_magnified(const luxfer::Context &context) {
    std::mt19937_64 random(12);
    const Waves waves{64};
    const cv::Mat source = waves.image(480, 360);
    const double bound = 2 * waves.curvature() / 8 + 2 * waves.slope() / 64;
    for (double minification : {0.3, 0.6, 0.95}) {
        const cv::Size size(int(300 / minification), int(220 / minification));
        Difference worst;
        for (int i = 0; i < 4; ++i) {
            const cv::Matx33d map = random_map(context, random, size, source.size(), minification);
            const Difference found = difference(warp_with_library(context, source, map, size),
                                                warp_with_opencv(source, map, size, cv::INTER_LINEAR));
            worst.mean = std::max(worst.mean, found.mean);
            worst.most = std::max(worst.most, found.most);
        }
        check_difference(minification, worst, bound);
    }
}

// For minification by m, a pixel is the mean over its footprint, a box of variance m² / 12 (square source pixels)
// along each axis. The library adds 1/12 for the samples cut by the ends of the footprint if it reads the source
// itself, and 4/12 + 1/4 if it reads the pyramid level of half the size. The reference is a linear warp by OpenCV to
// four times the resolution, which is then averaged: linear interpolation adds at most 1/4, and averaging four steps
// has a sixteenth less variance than a box. Averages of a smooth picture differ by half the curvature times the
// difference of the variances, along each axis. In addition, samples of side s that are cut by the ends of a footprint
// of length m count as constant, which shifts the footprint's centre by up to s² / 8m.
void check_minified(const luxfer::Context &context) {
    std::mt19937_64 random(13);
    const Waves waves{120};
    const cv::Mat source = waves.image(1300, 1000);
    constexpr int FINE = 4;
    for (double m : {2.0, 3.5}) {
        const cv::Size size(int(1000 / m), int(760 / m));
        const double longest = 1.25 * m; // the footprint's length varies, because the corners are moved
        const double variances = 4.0 / 12 + 0.25 + longest * longest / 12 / 16;
        const double side = m > 3 ? 2 : 1, shortest = 0.8 * m;
        const double bound = waves.curvature() * variances + 2 * waves.slope() * (1.0 / 64 + side * side / 8 / shortest);
        Difference worst;
        for (int i = 0; i < 2; ++i) {
            const cv::Matx33d map = random_map(context, random, size, source.size(), m);
            const cv::Matx33d finer = map * cv::Matx33d(1.0 / FINE, 0, 0, 0, 1.0 / FINE, 0, 0, 0, 1);
            const cv::Mat fine = warp_with_opencv(source, finer, size * FINE, cv::INTER_LINEAR);
            cv::Mat averaged;
            cv::resize(fine, averaged, size, 0, 0, cv::INTER_AREA);
            const Difference found = difference(warp_with_library(context, source, map, size), averaged);
            worst.mean = std::max(worst.mean, found.mean);
            worst.most = std::max(worst.most, found.most);
        }
        check_difference(m, worst, bound);
    }
}

// Random colours of the whole gamut, most of them dark. OpenCV's matrix and white point have six digits, which causes
// differences of hundredths.
void check_lab(const luxfer::Context &context) {
    std::mt19937_64 random(14);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    cv::Mat colours(120, 160, CV_32FC3), expected;
    for (int y = 0; y < colours.rows; ++y)
        for (int x = 0; x < colours.cols; ++x)
            for (int c = 0; c < 3; ++c)
                colours.at<cv::Vec3f>(y, x)[c] = float(std::pow(unit(random), 3));
    cv::cvtColor(colours, expected, cv::COLOR_LRGB2Lab);

    const auto features = luxfer::Features::create(context);
    const luxfer::ConstImageView view(samples(colours), std::uint32_t(colours.cols), std::uint32_t(colours.rows));
    features.set_photo(luxfer::Image::create(context, view));
    features.start().wait();
    cv::Mat found(colours.size(), CV_32FC3), difference;
    features.image(LUXFER_FEATURES_CHANNELS)
        .read({samples(found), std::uint32_t(found.cols), std::uint32_t(found.rows)});
    cv::absdiff(found, expected, difference);
    double most = 0;
    cv::minMaxLoc(difference.reshape(1), nullptr, &most);
    std::printf("CIELAB: largest difference %.1e (bound 5.0e-02)\n", most);
    CHECK(most <= 0.05);
}

} // namespace

int main() {
    const luxfer::Context context = luxfer::Context::create();
    check_lab(context);
    check_homographies(context);
    check_magnified(context);
    check_minified(context);
    return check::summary("opencv_cross_check");
}
