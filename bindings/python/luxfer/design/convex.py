"""Minimises a convex quadratic under convex quadratic limits, by a barrier method (Boyd and Vandenberghe, chapter 11).

Each limit j has the form `½ Σ D_ji x_i² + Σ G_ji x_i + h_j ≤ 0` with D ≥ 0: linear, or an ellipsoid along the axes.
The problems of a lighting design have up to a few hundred variables and a thousand limits, which dense matrices suit.

Not modelled: equations, sparse matrices, limits with mixed quadratic terms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Factor of the barrier's weight between its steps, and number of Newton steps at each. [convention]
GROWTH, NEWTON = 20.0, 60
#: The barrier ends when the gap is below this share of the objective's scale. [rounding]
GAP = 1e-9
#: Share of the decrease that the line search wants, and its shrinking. [convention: Boyd and Vandenberghe]
ARMIJO, SHRINK = 0.05, 0.5

Array = NDArray[np.float64]

#: Limits that hold by this share leave room for a barrier method to start. [convention]
CLEAR = 1e-3
#: Number of reasons of contradictions that are kept. [convention]
REASONS = 16


@dataclass(frozen=True)
class Limits:
    """Limits of a problem."""

    quadratic: Array
    """D (limits, variables), not negative."""
    linear: Array
    """G (limits, variables)."""
    constant: Array
    """h (limits)."""

    def values(self, x: Array) -> Array:
        """The left sides; at most 0 where the limit holds."""
        return 0.5 * (self.quadratic @ (x * x)) + self.linear @ x + self.constant

    def gradients(self, x: Array) -> Array:
        """Their gradients (limits, variables)."""
        return self.quadratic * x + self.linear

    def joined(self, other: Limits) -> Limits:
        """Both sets of limits."""
        both = ((self.quadratic, other.quadratic), (self.linear, other.linear), (self.constant, other.constant))
        return Limits(*(np.concatenate(pair) for pair in both))

    def relaxed(self, weights: Array) -> Limits:
        """The limits with one more variable r at the end: left side ≤ weight * r."""
        zero = np.zeros((len(self.constant), 1))
        return Limits(np.hstack([self.quadratic, zero]), np.hstack([self.linear, -weights[:, None]]), self.constant)


def box(low: Array, high: Array) -> Limits:
    """Limits low ≤ x ≤ high; infinite ones are left out."""
    eye = np.eye(len(low))
    rows = [(-eye[i], low[i]) for i in np.flatnonzero(np.isfinite(low))]
    rows += [(eye[i], -high[i]) for i in np.flatnonzero(np.isfinite(high))]
    linear = np.array([r for r, _ in rows]).reshape(-1, len(low))
    return Limits(np.zeros_like(linear), linear, np.array([h for _, h in rows], float))


@dataclass(frozen=True)
class Optimum:
    """A solution."""

    x: Array
    value: float
    multipliers: Array
    """Change of the objective per unit by which a limit is relaxed; 0 where it does not bind."""


def minimise(
    hessian: Array,
    gradient: Array,
    limits: Limits,
    start: Array,
    enough: Callable[[float, float], bool] = lambda value, gap: False,
) -> Optimum:
    """The minimum of ½ x'Hx + g'x from a start strictly inside the limits. It ends early where the present value, which
    is above the minimum by at most a gap, is enough.

    >>> limits = box(np.array([1.0, -1.0]), np.array([3.0, 1.0]))
    >>> nearest = minimise(np.eye(2), np.zeros(2), limits, np.array([2.0, 0.5]))
    >>> print(nearest.x.round(6) + 0.0, nearest.multipliers.round(4))
    [1. 0.] [1. 0. 0. 0.]
    """
    x, weight = start.astype(float), 1.0
    if (limits.values(x) >= 0).any():
        raise ValueError("the start lies outside the limits")
    scale = max(1.0, abs(0.5 * x @ hessian @ x + gradient @ x))
    while True:
        x = _centre(weight, hessian, gradient, limits, x)
        gap = len(limits.constant) / weight
        if gap < GAP * scale or enough(float(0.5 * x @ hessian @ x + gradient @ x), gap):
            break
        weight *= GROWTH
    multipliers = 1 / (weight * -limits.values(x))
    return Optimum(x, float(0.5 * x @ hessian @ x + gradient @ x), np.where(multipliers > 1e-6, multipliers, 0.0))


def _centre(weight: float, hessian: Array, gradient: Array, limits: Limits, x: Array) -> Array:
    """Newton's method for the objective times the weight plus the barrier."""

    def cost(y: Array) -> float:
        left = limits.values(y)
        return np.inf if (left >= 0).any() else weight * (0.5 * y @ hessian @ y + gradient @ y) - np.log(-left).sum()

    for _ in range(NEWTON):
        left, slopes = limits.values(x), limits.gradients(x)
        barrier = -1 / left
        down = weight * (hessian @ x + gradient) + slopes.T @ barrier
        curve = weight * hessian + (slopes * barrier[:, None] ** 2).T @ slopes + np.diag(limits.quadratic.T @ barrier)
        curve += 1e-12 * np.trace(curve) / len(x) * np.eye(len(x))  # [rounding]
        step = -np.linalg.solve(curve, down)
        decrease, now, length = -(down @ step), cost(x), 1.0
        if decrease < max(1e-10, 1e-14 * abs(now)):  # [rounding: the cost cannot tell how good the last step is]
            return x if (limits.values(x + step) >= 0).any() else x + step
        while cost(x + length * step) > now - ARMIJO * length * decrease:
            length *= SHRINK
            if length < 1e-12:  # [rounding]
                return x
        x = x + length * step
    return x


def min_violation(
    soft: Limits, hard: Limits, start: Array, weights: Array | None = None, decide: bool = False
) -> tuple[float, Optimum]:
    """The smallest r such that all soft limits hold up to weight * r (weights of 1 if not given), and where; the start
    is strictly inside the hard limits. A weight of 0 makes a limit hard, and the start must then be inside it too. To
    decide only whether all limits can hold together, it ends as soon as this is known, with an r that is larger than
    the smallest one, at most twice as large if it is above 0."""
    weights = np.ones(len(soft.constant)) if weights is None else weights
    both = soft.relaxed(weights).joined(hard.relaxed(np.zeros(len(hard.constant))))
    worst = float(soft.values(start)[weights > 0].max(initial=0.0))
    count = len(start)
    # r needs no bound from below: how far inside the limits can be is of interest too, but not without end.
    floor = Limits(np.zeros((1, count + 1)), -np.eye(count + 1)[-1:], np.array([-10.0]))
    gradient = np.zeros(count + 1)
    gradient[-1] = 1.0

    def enough(value: float, gap: float) -> bool:
        return decide and (value < -CLEAR or value > 2 * gap)

    begin = np.append(start, worst + 1.0)
    found = minimise(np.zeros((count + 1, count + 1)), gradient, both.joined(floor), begin, enough)
    return float(found.x[-1]), found


def violation_bound(limits: Limits, low: Array, high: Array, weights: Array) -> float:
    """A lower bound of the largest left side where low ≤ x ≤ high, by weights of the limits that are not negative and
    have the sum 1: the minimum of the weighted mean of the left sides (Lagrange duality, Boyd and Vandenberghe, section
    5.1). If it is above 0, the limits contradict each other.

    >>> apart = Limits(np.zeros((2, 1)), np.array([[1.0], [-1.0]]), np.array([0.0, 1.0]))  # x ≤ 0 and x ≥ 1
    >>> violation_bound(apart, np.array([-9.0]), np.array([9.0]), np.array([0.5, 0.5]))
    0.5
    """
    curve, slope = weights @ limits.quadratic, weights @ limits.linear
    flat = curve <= 0
    lowest = np.where(flat, np.where(slope > 0, low, high), -slope / np.where(flat, 1.0, curve))
    x = np.clip(lowest, low, high)
    return float((0.5 * curve * x + slope) @ x + weights @ limits.constant)


class Contradictions:
    """The reasons why limits contradicted each other, as weights of the limits. Similar problems mostly have the same
    reason, and one product of matrices per reason proves it, without solving anything."""

    def __init__(self) -> None:
        self._weights: list[Array] = []
        self.decided = 0
        """Number of problems that were found contradictory for a known reason."""

    def bound(self, limits: Limits, low: Array, high: Array) -> float:
        """The largest lower bound of the violation by the known reasons; -inf without one."""
        known = [w for w in self._weights if len(w) == len(limits.constant)]
        found = max((violation_bound(limits, low, high, w) for w in known), default=-np.inf)
        self.decided += found > 0
        return found

    def add(self, weights: Array) -> None:
        """Adds the multipliers of limits whose violation was minimised."""
        if weights.sum() > 0:
            self._weights = [weights / weights.sum(), *self._weights[: REASONS - 1]]
