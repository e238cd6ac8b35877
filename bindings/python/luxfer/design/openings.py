"""Luminous openings of luminaires, as the signs of their dimensions state them (LM-63)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray


#: Shapes of openings.
SHAPES = ("rectangle", "round", "tube", "globe")


def projected_area(size: Sequence[float], c: ArrayLike, gamma: ArrayLike) -> NDArray[np.float64]:
    """The area in m² of a luminous opening as seen from far away in the directions c, gamma in degrees. size is as in
    DistributionReport; all sides of a box are luminous over its whole height."""
    turn, tilt = np.radians(c), np.radians(gamma)
    u = np.abs(np.stack(np.broadcast_arrays(np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt))))
    x, y, z = completed(size)
    a, b, h = abs(x), abs(y), abs(z)
    if x < 0 and y < 0 and z < 0:  # an ellipsoid
        return np.asarray(np.pi / 4 * np.hypot(np.hypot(b * h * u[0], h * a * u[1]), a * b * u[2]))
    if x < 0 and y < 0:
        return _cylinder(u, 2, h, (a, b))
    if z < 0 and y <= 0 <= x:  # a tube along C = 0, with one diameter or two
        return _cylinder(u, 0, a, (b or h, h))
    if z < 0 and x <= 0 <= y:
        return _cylinder(u, 1, b, (h, a or h))
    if x < 0 or y < 0:
        return _cylinder(u, 2, h, (a, b))
    return np.asarray(a * b * u[2] + h * (b * u[0] + a * u[1]))


def completed(size: Sequence[float]) -> tuple[float, float, float]:
    """The size with both diameters of a round opening that states only one."""
    x, y, z = (float(v) for v in size)
    if x == 0 and y < 0:
        x = y
    elif y == 0 and x < 0:
        y = x
    return x, y, z


def is_round(size: Sequence[float]) -> bool:
    """Whether the opening is round as seen from below."""
    x, y, _ = completed(size)
    return x < 0 and y < 0


def shape_of(size: Sequence[float]) -> str | None:
    """The shape, one of SHAPES, of an opening; None if it states no size."""
    x, y, z = completed(size)
    if sum(v != 0 for v in (x, y, z)) < 2:
        return None
    if is_round(size):
        return "globe" if z < 0 else "round"
    if z < 0 and (x < 0 or y < 0 or x == 0 or y == 0):
        return "tube"
    return "round" if x < 0 or y < 0 else "rectangle"


def sides_of(size: Sequence[float]) -> tuple[float, float, float]:
    """The longer and the shorter horizontal side, and the height of an opening in metres."""
    x, y, z = (abs(v) for v in completed(size))
    # A tube that states one diameter is as wide as it is high.
    x, y = (x or z, y or z) if size[2] < 0 else (x, y)
    return max(x, y), min(x, y), z


def _cylinder(u: NDArray[np.float64], axis: int, length: float, diameters: tuple[float, float]) -> NDArray[np.float64]:
    a, b = diameters
    width = np.hypot(a * u[(axis + 2) % 3], b * u[(axis + 1) % 3])
    return np.asarray(np.pi / 4 * a * b * u[axis] + length * width)
