// Statistical tests for comparing two renderers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace statistics {

// Continued fraction of the incomplete beta function (Lentz's method; Press et al., Numerical Recipes, 6.4).
inline double beta_fraction(double a, double b, double x) {
    const double tiny = 1e-300;
    double c = 1, d = 1 / std::max(1 - (a + b) * x / (a + 1), tiny), result = d;
    for (int m = 1; m < 500; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double step = 1;
        for (double term : {even, odd}) {
            d = 1 / (1 + term * d);
            c = 1 + term / c;
            step = c * d;
            result *= step;
        }
        if (std::abs(step - 1) < 1e-14)
            break;
    }
    return result;
}

inline double incomplete_beta(double a, double b, double x) {
    if (x <= 0 || x >= 1)
        return x <= 0 ? 0 : 1;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

// Two-sided p-value: the probability that |T| exceeds |t| for Student's t distribution.
inline double student_p(double t, double degrees) {
    return incomplete_beta(degrees / 2, 0.5, degrees / (degrees + t * t));
}

struct Sample {
    double count = 0, mean = 0, squares = 0; // squared distances from the mean (Welford 1962)

    void add(double value) {
        ++count;
        const double before = value - mean;
        mean += before / count;
        squares += before * (value - mean);
    }
    double variance_of_mean() const { return squares / (count - 1) / count; }
};

// Welch's t-test: the probability of a difference at least this large if both samples have the same true mean.
inline double welch_p(const Sample &a, const Sample &b) {
    const double va = a.variance_of_mean(), vb = b.variance_of_mean(), difference = a.mean - b.mean;
    // Without any scatter (a pixel that sees only a lamp, or nothing), the means may differ only by rounding.
    const double rounding = 1e-6 * (std::abs(a.mean) + std::abs(b.mean));
    if (std::sqrt(va + vb) <= rounding)
        return std::abs(difference) <= 4 * rounding ? 1 : 0;
    const double degrees = (va + vb) * (va + vb) / (va * va / (a.count - 1) + vb * vb / (b.count - 1));
    return student_p(difference / std::sqrt(va + vb), degrees);
}

// Interval of the number of successes in n trials of probability p that leaves out the probability `outside`.
inline std::pair<std::size_t, std::size_t> binomial_interval(std::size_t n, double p, double outside) {
    std::size_t low = 0, high = n;
    double sum = 0;
    for (std::size_t k = 0; k <= n; ++k) {
        sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(double(n - k) + 1.0) +
                        double(k) * std::log(p) + double(n - k) * std::log1p(-p));
        if (sum < outside / 2)
            low = k + 1;
        if (sum >= 1 - outside / 2) {
            high = k;
            break;
        }
    }
    return {low, high};
}

} // namespace statistics
