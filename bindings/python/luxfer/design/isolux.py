"""Isolux lines by marching squares, and levels for them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

#: Steps of levels within a decade. [convention]
STEPS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.5)
Point = tuple[float, float]


def levels(low: float, high: float, most: int = 6) -> list[float]:
    """Round levels between two illuminances.

    >>> levels(180, 620)
    [200.0, 300.0, 500.0]
    """
    if not 0 < high < math.inf or high <= low:
        return []
    first = math.floor(math.log10(max(low, high / 1000)))
    every = [s * 10.0**d for d in range(first, math.floor(math.log10(high)) + 1) for s in STEPS]
    found = [v for v in every if low < v < high]
    if len(found) < 2:  # nearly even light: equal steps
        step = 10 ** math.floor(math.log10((high - low) / 2)) or 1.0
        step *= next((k for k in (1, 2, 5) if (high - low) / (k * step) <= most), 10)
        found = [k * step for k in range(math.ceil(low / step), math.floor(high / step) + 1)]
    return found[:: max(1, math.ceil(len(found) / most))]


def lines(grid: NDArray[np.float64], level: float) -> list[tuple[Point, Point]]:
    """Segments where the values of a grid (rows, columns) cross a level, as (column, row) of the points; squares with a
    point that is NaN have no segments.

    >>> lines(np.array([[0.0, 2.0], [0.0, 2.0]]), 1)
    [((0.5, 0.0), (0.5, 1.0))]
    """
    out = []
    for row in range(grid.shape[0] - 1):
        for column in range(grid.shape[1] - 1):
            corners = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)]
            values = [float(grid[r, c]) for c, r in corners]
            if any(math.isnan(v) for v in values):
                continue
            found = [
                _cross(corners[i], corners[(i + 1) % 4], values[i], values[(i + 1) % 4], level)
                for i in range(4)
                if (values[i] < level) != (values[(i + 1) % 4] < level)
            ]
            # A saddle: lines cut off the corners that the middle does not belong to.
            if len(found) == 4 and (sum(values) / 4 < level) != (values[0] < level):
                found = [found[3], *found[:3]]
            out += list(zip(found[::2], found[1::2]))
    return [tuple(sorted(pair)) for pair in out]  # type: ignore[misc]


def _cross(a: tuple[int, int], b: tuple[int, int], low: float, high: float, level: float) -> Point:
    t = (level - low) / (high - low)
    return a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])
