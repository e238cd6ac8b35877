"""Measures how far the look of a design with lamps at other places is from the photo.

The copy is the ceiling with the lamps of the photo. The design is compared with the copy by parts, each of which is 0
for the copy itself:

- `pattern`: root mean square difference of five statistics of the pattern. Four are natural logarithms, so that 0.1 is
  a change by a tenth: luminous share of the ceiling; size of the lamps over their spacing; length over width of the
  lamps; spacing in the two directions of the rows. The fifth is the coefficient of variation of the spacing.
- `brightness`: the change of the brightness ratios of the lamps (look.py).
- `surfaces`: root mean square of the relative change of the mean illuminance of floor, walls and ceiling, after the one
  exposure that makes it smallest; `delta_e` is the largest colour difference (CIE 1976 L*a*b*) of these surfaces, as if
  they were a grey whose mean in the copy has the lightness 50.
- `colour`: the same difference between greys under the lamps' mean colours.
- `scale`, `turn`, `offset`, `exposure`: of the pattern as a factor, in degrees and in shares of its two vectors, and
  of all lamps in stops.

Changes of the pattern, of the surfaces and of the lamps' ratios up to a limit each hardly change the look. The search
adds the excess over these limits to the total, so that no part changes much for small gains of the others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .look import EXPOSURE_WEIGHT

if TYPE_CHECKING:
    from .motif import Placed

#: Weights in the total, whose square is the weighted sum of the squares of the parts: of the natural logarithm of the
#: scale, of a turn by 90 degrees, of a shift by a whole period, and of a colour difference of 1. [convention: doubling
#: the pattern, turning it and a colour difference of 17 count about as much as a change of a brightness ratio by 0.17;
#: a shift counts little, but enough that lamps do not move for nothing]
SCALE_WEIGHT, TURN_WEIGHT, SHIFT_WEIGHT, COLOUR_WEIGHT = 0.25, 0.17, 0.1, 0.01
#: Changes that hardly change the look: of the pattern, of the brightness ratios of the lamps, and the colour difference
#: of the surfaces. [convention]
SMALL_PATTERN, SMALL_BRIGHTNESS, SMALL_DELTA_E = 0.10, 0.20, 3.0
#: Luminance of a grey with the lightness L* = 50 beside white. [convention: CIE 1976 L*a*b*]
GREY = 0.1842
#: Linear Rec.709 to XYZ, and its white. [convention: BT.709]
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = TO_XYZ.sum(axis=1)


@dataclass(frozen=True)
class Likeness:
    """Distance of a design from the photo's copy, by parts."""

    pattern: float
    """Change of the statistics of the pattern."""
    brightness: float
    """Change of the brightness ratios of the lamps."""
    surfaces: float
    """Change of the brightness ratios of floor, walls and ceiling."""
    delta_e: float
    """Largest colour difference of these surfaces."""
    colour: float
    """Colour difference of the lamps' light."""
    scale: float
    """Factor of the pattern's size."""
    turn: float
    """Turn of the pattern in degrees."""
    offset: tuple[float, float]
    """Shift of the pattern in shares of its two vectors."""
    exposure: float
    """Change of the brightness of all lamps together, in stops."""

    @property
    def total(self) -> float:
        """All parts as one number."""
        shares = (self.pattern, self.brightness, self.surfaces, self.moved)
        change = 2**self.exposure - 1 if math.isfinite(self.exposure) else -1.0
        return math.sqrt(sum(s * s for s in shares) + EXPOSURE_WEIGHT * change * change)

    @property
    def cost(self) -> float:
        """The total and the excess over small changes, by which the search orders designs."""
        return self.total + excess(self.pattern, self.brightness, self.delta_e)

    @property
    def moved(self) -> float:
        """The part of scale, turn, offset and colour in the total."""
        return moved(self.scale, self.turn, self.offset, self.colour)

    def __str__(self) -> str:
        parts = (
            f"pattern changed by {100 * self.pattern:.1f} %",
            f"brightness ratios of the lamps by {100 * self.brightness:.1f} %",
            f"of the surfaces by {100 * self.surfaces:.1f} % (largest colour difference {self.delta_e:.1f})",
            f"colour of the light by {self.colour:.1f}",
            f"size by a factor of {self.scale:.2f}",
            f"turned by {self.turn:.0f} degrees",
            f"all lamps by {self.exposure:+.2f} stops",
        )
        return ", ".join(parts)


def moved(scale: float, turn: float, offset: tuple[float, float], colour: float) -> float:
    """The part of scale, turn, offset and colour difference in the total.

    >>> moved(1, 180, (1, 0), 0), round(moved(2, 90, (0.5, 0), 17), 2)
    (0.0, 0.3)
    """
    angle = min(turn % 180, 180 - turn % 180) / 90
    shift = math.hypot(*(v - round(v) for v in offset))
    parts = (SCALE_WEIGHT * math.log(scale), TURN_WEIGHT * angle, SHIFT_WEIGHT * shift, COLOUR_WEIGHT * colour)
    return math.sqrt(sum(v * v for v in parts))


def excess(pattern: float, brightness: float = 0, delta_e: float = 0) -> float:
    """The shares by which changes exceed small ones, together.

    >>> excess(0.1, 0.2, 3), round(excess(0.15, 0.2, 6), 3)
    (0.0, 1.5)
    """
    shares = (pattern / SMALL_PATTERN, brightness / SMALL_BRIGHTNESS, delta_e / SMALL_DELTA_E)
    return sum(max(0.0, s - 1) for s in shares)


def statistics(lamps: Placed, ceiling: float) -> NDArray[np.float64]:
    """The five statistics of a pattern on a ceiling of that area; NaN for a statistic that needs more lamps."""
    count = len(lamps.places)
    lengths, widths = np.maximum(lamps.sizes, 1e-3).T  # a point is as large as a millimetre
    area = (lengths * widths).sum()
    gaps, spacing, rows = math.nan, math.sqrt(ceiling / max(count, 1)), math.nan
    if count > 1:
        offsets = lamps.places[None] - lamps.places[:, None]
        distance = np.linalg.norm(offsets, axis=2)
        np.fill_diagonal(distance, np.inf)
        near = distance.min(axis=1)
        spacing, gaps = float(near.mean()), float(near.std() / near.mean())
        rows = _rows(offsets, distance)
    return np.array(
        [
            math.log(area / ceiling),
            math.log(math.sqrt(area / count) / spacing),
            float(np.log(lengths / widths).mean()),
            rows,
            gaps,
        ]
    )


def _rows(offsets: NDArray[np.float64], distance: NDArray[np.float64]) -> float:
    """Logarithm of the spacing across the direction of the nearest neighbour over that along it, on average."""
    out = []
    for vectors, lengths in zip(offsets, distance):
        first = vectors[lengths.argmin()]
        sine = np.abs(first[0] * vectors[:, 1] - first[1] * vectors[:, 0]) / np.linalg.norm(first)
        beside = np.where(sine >= 0.5 * np.where(np.isfinite(lengths), lengths, np.inf), lengths, np.inf)
        if np.isfinite(beside.min()):
            out.append(math.log(beside.min() / lengths.min()))
    return float(np.mean(out)) if out else math.nan


def pattern_distance(photo: NDArray[np.float64], now: NDArray[np.float64]) -> float:
    """Root mean square difference of the statistics that both patterns have."""
    gap = (photo - now)[~np.isnan(photo - now)]
    return float(np.sqrt((gap**2).mean()))


def surface_distance(copy: NDArray[np.float64], now: NDArray[np.float64]) -> float:
    """The distance of the brightness ratios of surfaces after the best exposure.

    >>> surface_distance(np.array([100.0, 50.0]), np.array([200.0, 100.0]))
    0.0
    """
    ratio = now / copy
    left = 1 - ratio.mean() ** 2 / (ratio**2).mean()
    return math.sqrt(left) if left > 1e-12 else 0.0  # [rounding]


def surface_delta_e(
    copy: NDArray[np.float64],
    now: NDArray[np.float64],
    copy_colour: NDArray[np.float64],
    colour: NDArray[np.float64],
) -> float:
    """Largest colour difference of surfaces with these illuminances, in the light of these mean colours."""
    ratio = now / copy
    exposure = float((ratio**2).mean() / ratio.mean())
    before = GREY * copy / copy.mean()
    after = before * ratio / exposure
    gaps = [lab(copy_colour, b) - lab(colour, a) for b, a in zip(before, after)]
    return float(max(np.linalg.norm(g) for g in gaps))


def colour_difference(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Colour difference of a grey in the light of two linear colours.

    >>> colour_difference(np.ones(3), 2 * np.ones(3)), round(colour_difference(np.ones(3), np.array([1, 0.9, 0.7])), 1)
    (0.0, 8.1)
    """
    return float(np.linalg.norm(lab(one, GREY) - lab(other, GREY)))


def lab(colour: Sequence[float] | NDArray[np.float64], luminance: float) -> NDArray[np.float64]:
    """L*, a*, b* of a linear colour, brought to a luminance beside a white of 1."""
    xyz = TO_XYZ @ np.asarray(colour, float)
    t = xyz / xyz[1] * luminance / WHITE
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)  # [convention: CIE 1976]
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])
