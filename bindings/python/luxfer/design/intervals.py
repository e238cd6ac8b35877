"""Estimates with their intervals, and the probability that a limit is met.

An estimate of the path tracer comes with the standard error of 16 independent batches, so it follows Student's t with
15 degrees of freedom; sums of points have more (Welch-Satterthwaite). Probabilities are read in the sense of
confidence: "passes with 97.5 %" means that the one-sided 97.5 % confidence interval of the quantity lies within the
limit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Degrees of freedom of the standard error of one point: 16 batches less one.
POINT_FREEDOM = 15
#: Steps of the bisections that invert distributions; each halves the bracket. [rounding]
BISECTIONS = 80


@dataclass(frozen=True)
class Estimate:
    """A number with its standard error.

    >>> e = Estimate(510.0, 5.0)
    >>> round(e.probability_at_least(500), 3), [round(x, 1) for x in e.interval()]
    (0.968, [499.3, 520.7])
    """

    value: float
    """The estimate."""
    error: float = 0
    """Its standard error; 0 for exact numbers."""
    freedom: float = POINT_FREEDOM
    """Degrees of freedom of the standard error."""

    def probability_at_least(self, limit: float) -> float:
        """Confidence that the true number is at least the limit; NaN if the number or its error is not known."""
        if any(math.isnan(v) for v in (self.value, self.error, limit)):
            return math.nan
        if not self.error > 0:
            return float(self.value >= limit)
        return student((self.value - limit) / self.error, self.freedom)

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """The two-sided interval of that confidence."""
        half = self.error * quantile(0.5 + confidence / 2, self.freedom)
        return self.value - half, self.value + half

    def scaled(self, factor: float) -> Estimate:
        """The estimate of a multiple."""
        return Estimate(self.value * factor, self.error * abs(factor), self.freedom)


def student(t: float, freedom: float) -> float:
    """Distribution function of Student's t.

    >>> round(student(2.131, 15), 4), round(student(1.959964, 1e9), 4)
    (0.975, 0.975)
    """
    if math.isinf(t):
        return float(t > 0)
    if freedom > 1e6:
        return 0.5 * math.erfc(-t / math.sqrt(2))
    tail = 0.5 * _incomplete_beta(freedom / 2, 0.5, freedom / (freedom + t * t))
    return 1 - tail if t > 0 else tail


def quantile(probability: float, freedom: float) -> float:
    """Inverse of student, by bisection.

    >>> round(quantile(0.975, 15), 3)
    2.131
    """
    if not 0 < probability < 1:
        return math.inf if probability >= 1 else -math.inf
    high = 1.0
    while student(high, freedom) < max(probability, 1 - probability):
        high *= 2
    return bisect(lambda t: student(t, freedom) >= probability, -high, high)


def bisect(holds: Callable[[float], bool], low: float, high: float) -> float:
    """The point where a condition begins to hold, between low, where it does not hold, and high, where it does."""
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return 0.5 * (low + high)


def mean_of(values: ArrayLike, errors: ArrayLike, weights: ArrayLike | None = None) -> Estimate:
    """The mean of independent estimates, weighted by the given weights, or equally without weights.

    >>> e = mean_of([100, 102, 98, 104], [2, 2, 2, 2])
    >>> e.value, e.error, e.freedom
    (101.0, 1.0, 60.0)
    """
    values, errors = np.asarray(values, float), np.asarray(errors, float)
    shares = _shares(len(values), weights)
    variances = (shares * errors) ** 2
    total = variances.sum()
    freedom = POINT_FREEDOM if total == 0 else total**2 / (variances**2 / POINT_FREEDOM).sum()
    return Estimate(float(shares @ values), float(np.sqrt(total)), float(freedom))


def _shares(count: int, weights: ArrayLike | None) -> NDArray[np.float64]:
    """The weights scaled to the sum 1; without weights, equal weights."""
    raw = np.ones(count) if weights is None else np.asarray(weights, float)
    return raw / raw.sum()


@dataclass(frozen=True)
class Uniformity:
    """U0, the smallest over the mean illuminance of independent points.

    The smallest of noisy values is too small on average, so no interval is centred on it. Instead each point is
    compared with U0 times the mean. U0 is at least a limit if every point passes, with the confidence of the worst
    point (intersection-union test). U0 is below the limit if any point fails. With more points, it is likelier that one
    of them fails by chance, so the error of the worst point counts once for each point (Bonferroni).
    """

    values: NDArray[np.float64]
    """Illuminance of the points in lux."""
    errors: NDArray[np.float64]
    """Their standard errors."""
    weights: NDArray[np.float64] | None = None
    """Weight of each point in the mean; without weights, all points count equally."""

    @property
    def mean(self) -> float:
        """The mean illuminance in lux."""
        return float(_shares(len(self.values), self.weights) @ self.values)

    @property
    def value(self) -> float:
        """Smallest over mean illuminance, 0 in darkness."""
        mean = self.mean
        return 0.0 if mean <= 0 else float(self.values.min() / mean)

    def at_least(self, limit: float) -> tuple[float, float]:
        """Confidence that U0 is at least the limit, and that it is below."""
        shares, variances = _shares(len(self.values), self.weights), self.errors**2
        gap = self.values - limit * self.mean
        # The point itself is a part of the mean.
        spread = np.sqrt(np.maximum(variances * (1 - 2 * limit * shares) + limit**2 * (shares**2 @ variances), 0))
        return _all_of(_z(gap, spread), len(self.values))

    def probability_at_least(self, limit: float) -> float:
        """Confidence that U0 is at least the limit."""
        return self.at_least(limit)[0]

    def probability_below(self, limit: float) -> float:
        """Confidence that U0 is below the limit."""
        return self.at_least(limit)[1]

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """The two-sided interval of that confidence."""
        sure = (1 + confidence) / 2
        low = bisect(lambda u: self.probability_at_least(u) < sure, 0.0, 1.0)
        high = bisect(lambda u: self.probability_below(u) >= sure, 0.0, 1.0)
        return (0.0, 0.0) if self.mean <= 0 else (low, max(low, high))


@dataclass(frozen=True)
class Extremes:
    """The smallest illuminance of independent points, and the largest over the smallest one (diversity).

    As with the uniformity, no interval is centred on them. The smallest is at least a limit if every point is; the
    diversity is at most a limit if every pair of points keeps to it. A limit fails if any point or pair fails, so the
    error of the worst point or pair counts once for each of them.
    """

    values: NDArray[np.float64]
    """Illuminance of the points in lux."""
    errors: NDArray[np.float64]
    """Their standard errors."""

    @property
    def smallest(self) -> float:
        """The smallest illuminance in lux."""
        return float(self.values.min())

    @property
    def diversity(self) -> float:
        """Largest over smallest illuminance; infinite if a point is dark."""
        return float(self.values.max()) / self.smallest if self.smallest > 0 else math.inf

    def smallest_at_least(self, limit: float) -> tuple[float, float]:
        """Confidence that the smallest illuminance is at least the limit, and that it is below.

        >>> Extremes(np.array([1.2, 2.0]), np.zeros(2)).smallest_at_least(1.0)
        (1.0, 0.0)
        """
        return _all_of(_z(self.values - limit, self.errors), len(self.values))

    def diversity_at_most(self, limit: float) -> tuple[float, float]:
        """Confidence that the diversity is at most the limit, and that it is above.

        >>> Extremes(np.array([1.0, 41.0]), np.zeros(2)).diversity_at_most(40)
        (0.0, 1.0)
        """
        if self.smallest <= 0 and not self.errors.any():
            return 0.0, 1.0
        dark, bright = _front(self.values, self.errors), _front(-self.values, self.errors)
        gaps = limit * self.values[dark, None] - self.values[None, bright]
        spreads = np.hypot(limit * self.errors[dark, None], self.errors[None, bright])
        return _all_of(_z(gaps, spreads).reshape(-1), len(self.values) ** 2)

    def interval_of_smallest(self, confidence: float = 0.95) -> tuple[float, float]:
        """The two-sided interval of the smallest illuminance."""
        sure, top = (1 + confidence) / 2, float((self.values + 10 * self.errors).max())
        low = bisect(lambda v: self.smallest_at_least(v)[0] < sure, 0.0, top)
        high = bisect(lambda v: self.smallest_at_least(v)[1] >= sure, 0.0, top)
        return low, max(low, high)

    def interval_of_diversity(self, confidence: float = 0.95) -> tuple[float, float]:
        """The two-sided interval of the diversity; without upper end if a point may be dark."""
        sure = (1 + confidence) / 2
        if not self.diversity < math.inf:
            return self.diversity, self.diversity
        # The inverse, smallest over largest, lies between 0 and 1.
        high = bisect(lambda u: self.diversity_at_most(1 / u)[0] < sure, 0.0, 1.0)
        low = bisect(lambda u: self.diversity_at_most(1 / u)[1] >= sure, 0.0, 1.0)
        return 1 / max(low, high), 1 / high if high > 1e-9 else math.inf  # [rounding]


def _z(gaps: NDArray[np.float64], spreads: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gaps in standard errors; infinite for exact numbers."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(spreads == 0, np.where(gaps >= 0, np.inf, -np.inf), gaps / spreads)


def _front(values: NDArray[np.float64], errors: NDArray[np.float64]) -> NDArray[np.intp]:
    """The points of which one has the smallest gap in standard errors to any limit: the points whose error is larger or
    smaller than the errors of all points of smaller value. All points if a value or an error is not known."""
    if np.isnan(values).any() or np.isnan(errors).any():
        return np.arange(len(values))
    order = np.lexsort((errors, values))
    sorted_ = errors[order]
    above = np.concatenate([[-np.inf], np.maximum.accumulate(sorted_)[:-1]])
    below = np.concatenate([[np.inf], np.minimum.accumulate(sorted_)[:-1]])
    return order[(sorted_ > above) | (sorted_ < below)]


def _all_of(gaps: NDArray[np.float64], count: int) -> tuple[float, float]:
    """Confidence that all gaps, in standard errors, are at least 0 (intersection-union test), and confidence that one
    of that number of gaps is below 0 (Bonferroni)."""
    if np.isnan(gaps).any():
        return math.nan, math.nan
    met = student(float(gaps.min()), POINT_FREEDOM)
    return met, max(0.0, 1 - count * met)


def _incomplete_beta(a: float, b: float, x: float) -> float:
    """Regularised incomplete beta function by its continued fraction (Lentz's method)."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):  # where the fraction converges slowly
        return 1 - _incomplete_beta(b, a, 1 - x)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    tiny, d = 1e-300, 1 - (a + b) * x / (a + 1)  # [rounding]
    d = 1 / (d if abs(d) > tiny else tiny)
    c, out = 1.0, d
    for m in range(1, 500):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        for step in (even, odd):
            d, c = 1 + step * d, 1 + step / c
            d, c = 1 / (d if abs(d) > tiny else tiny), c if abs(c) > tiny else tiny
            out *= d * c
        if abs(d * c - 1) < 1e-15:  # [rounding]
            break
    return front * out
