"""The distance of a design's look from the photo's: the brightness ratios of the lamps, and the brightness of all lamps
together.

The lamps keep the photo's places and colours, so their look changes by their dimmers alone:

- `pattern`: root mean square of the relative change of the lamps' flux, weighted by the photo's flux, after the one
  exposure that makes it smallest. 0: all brightness ratios are the photo's; 0.1: they are off by a tenth.
- `exposure`: this factor for all lamps, in stops. The eye adapts to it, so it counts less.

Where the lamps may move (arrange.py), likeness.py compares their pattern, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Weight of the squared relative exposure against the pattern's weight. [convention: a change of all lamps by a tenth
#: counts as much as a change of single lamps by a hundredth]
EXPOSURE_WEIGHT = 0.01
#: A lamp that the photo shows off counts as this share of the brightest. [convention]
DARKEST = 1e-3


@dataclass(frozen=True)
class Distance:
    """Distance of a look from the photo's."""

    pattern: float
    """Relative change of the brightness ratios of the lamps; 0: no change."""
    exposure: float
    """Change of the brightness of all lamps together, in stops; 0: no change."""

    def __str__(self) -> str:
        ratios = f"brightness ratios of the lamps changed by {100 * self.pattern:.1f} %"
        return f"{ratios}, all lamps by {self.exposure:+.2f} stops"


def distance(
    photo: Sequence[float] | NDArray, now: Sequence[float] | NDArray, flux: Sequence[float] | NDArray
) -> Distance:
    """The distance between two sets of dimmers of lamps with these fluxes at full power.

    >>> distance([0.5, 0.5], [1, 1], [100, 100])
    Distance(pattern=0.0, exposure=1.0)
    >>> round(distance([1, 1], [0.9, 1.1], [100, 100]).pattern, 3)
    0.1
    """
    before, after = _at_least(photo), np.asarray(now, float)
    weights = before * np.asarray(flux, float)
    weights = weights / weights.sum()
    ratio = after / before
    exposure, square = float(weights @ ratio), float(weights @ ratio**2)
    if exposure <= 0:
        return Distance(1.0, -math.inf)
    # The k with the smallest mean of (ratio / k - 1)² is the mean of squares over the mean; its minimum is below.
    pattern = math.sqrt(max(0.0, 1 - exposure**2 / square))
    return Distance(pattern if pattern > 1e-9 else 0.0, math.log2(square / exposure))  # [rounding]


def objective(photo: NDArray, flux: NDArray, surfaces: NDArray | None = None) -> tuple[NDArray, NDArray]:
    """Hessian and gradient over the dimmers and the exposure k of `Σ w (s / p - k)² + EXPOSURE_WEIGHT (k - 1)²`,
    where w is the share of a lamp in the photo's flux, s its dimmer and p its dimmer in the photo. With surfaces, also
    the mean of `(Σ r s - k)²` over them, where r is the brightness of a surface by a lamp at full power as a share of
    its brightness by the photo's lamps."""
    before = _at_least(photo)
    weights = before * flux
    weights = weights / weights.sum()
    count = len(before)
    hessian = np.zeros((count + 1, count + 1))
    hessian[:count, :count] = np.diag(2 * weights / before**2)
    hessian[:count, count] = hessian[count, :count] = -2 * weights / before
    hessian[count, count] = 2 * (weights.sum() + EXPOSURE_WEIGHT)
    if surfaces is not None:
        rows = np.hstack([surfaces, -np.ones((len(surfaces), 1))])
        hessian += 2 * rows.T @ rows / len(rows)
    gradient = np.zeros(count + 1)
    gradient[count] = -2 * EXPOSURE_WEIGHT
    return hessian, gradient


def _at_least(photo: Sequence[float] | NDArray) -> NDArray[np.float64]:
    """The photo's dimmers; lamps that are off count as nearly off."""
    values = np.asarray(photo, float)
    brightest = values.max(initial=0.0)
    if brightest <= 0:
        raise ValueError("no lamp of the photo shines: there is no look to keep")
    return np.maximum(values, DARKEST * brightest)
