"""Measures only the quantities that requirements limit in a lit scene: illuminance of areas, and glare of observers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..illuminance import Illuminance
from .areas import PLANES, PLANES_ERROR, thinned
from .intervals import Estimate, Extremes, Uniformity, mean_of, quantile

if TYPE_CHECKING:
    from ..scene import Scene
    from .areas import Area, Patch
    from .observers import Observers

#: UGR is this factor times the logarithm of its sum. [convention: CIE 117]
UGR_FACTOR = 8.0
#: Paths for each point that find the darkest points of an area. [convention]
LOOK_SAMPLES = 64


@dataclass(frozen=True)
class Field:
    """Illuminance of the points of an area, in lux."""

    area: Area
    values: NDArray[np.float64]
    """Illuminance of each point."""
    errors: NDArray[np.float64]
    """Standard errors."""
    bias: float = 0
    """Largest relative error that the standard errors leave out, due to the finite number of planes of cylindrical
    illuminance."""

    @property
    def mean(self) -> Estimate:
        """Mean illuminance of the area, in which each point counts by the part that it stands for."""
        return mean_of(self.values, self.errors, self.area.weights)

    @property
    def extremes(self) -> Extremes:
        """Smallest illuminance, and largest over smallest."""
        return Extremes(self.values, self.errors)

    @property
    def uniformity(self) -> Uniformity:
        """Smallest over mean illuminance."""
        return Uniformity(self.values, self.errors, self.area.weights)

    def scaled(self, factor: float) -> Field:
        """The field of a multiple of the light, as by a maintenance factor."""
        return Field(self.area, self.values * factor, self.errors * factor, self.bias)

    def image(self, patch: int = 0) -> NDArray[np.float64]:
        """The values of a rectangle (rows, columns), NaN at points that do not belong to the area."""
        keeps = [p.keep for p in self.area.patches]
        start = sum(int(k.sum()) for k in keeps[:patch])
        out = np.full(keeps[patch].shape, np.nan)
        out[keeps[patch]] = self.values[start : start + int(keeps[patch].sum())]
        return out


@dataclass(frozen=True)
class Rating:
    """The glare of one observer."""

    ugr: float
    """Unified glare rating; -inf without a glare source in view."""
    background: Estimate
    """Luminance of the background in cd/m²."""
    unrated: float
    """Direct illuminance at the eye, in lux, by lights that the rating leaves out."""
    outside_range: int
    """Number of sources in view that are too small or too large for CIE 117."""

    def probability_at_most(self, limit: float) -> float:
        """Confidence that the rating is at most the limit. It falls as the background grows."""
        if math.isinf(self.ugr):
            return float(self.ugr < 0)
        needed = self.background.value * 10 ** ((self.ugr - limit) / UGR_FACTOR)
        return self.background.probability_at_least(needed)

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """The two-sided interval of that confidence."""
        if math.isinf(self.ugr):
            return self.ugr, self.ugr
        low, high = self.background.interval(confidence)
        return self._at(high), self._at(low)

    def _at(self, background: float) -> float:
        """The rating before another background."""
        if background <= 0:
            return math.inf
        return self.ugr + UGR_FACTOR * math.log10(self.background.value / background)


def measure(scene: Scene, area: Area, samples: int = 1024, seed: int = 1) -> Field:
    """Illuminance of the points of an area, by that number of paths for each."""
    stage = Illuminance(scene.context, scene)
    values, errors = [], []
    for index, patch in enumerate(area.patches):
        lux, error = _patch(stage, patch, samples, seed * 1000 + index)
        values.append(lux[patch.keep])
        errors.append(error[patch.keep])
    if area.kind != "cylindrical":
        return Field(area, np.concatenate(values), np.concatenate(errors))
    # The mean over the planes around each point.
    means = np.mean(values, axis=0)
    spread = np.sqrt(np.sum(np.square(errors), axis=0)) / PLANES
    return Field(area, means, spread, PLANES_ERROR)


def dark_and_spread(scene: Scene, area: Area, count: int, seed: int) -> Area:
    """At most about this number of the points of an area, and its darkest points in the light of a scene."""
    if area.count <= count or area.kind == "cylindrical":
        return thinned(area, count)
    return thinned(area, count, measure(scene, area, LOOK_SAMPLES, seed).values)


def rate(scene: Scene, observers: Observers, samples: int = 1024, seed: int = 1) -> list[Rating]:
    """The glare of each observer."""
    found = scene.glare(observers.positions, observers.directions, samples, seed)
    return [
        Rating(
            float(r["ugr"]),
            Estimate(float(r["background"]), float(r["background_error"])),
            float(r["unrated_lux"]),
            int(r["outside_range"]),
        )
        for r in found
    ]


def worst(ratings: Sequence[Rating]) -> Rating:
    """The rating of the observer with the most glare."""
    return max(ratings, key=lambda r: r.ugr)


def _patch(stage: Illuminance, patch: Patch, samples: int, seed: int) -> tuple[NDArray, NDArray]:
    """Illuminance and standard errors of a rectangle; rows and columns at its ends without points are not computed."""
    rows, columns = np.flatnonzero(patch.keep.any(axis=1)), np.flatnonzero(patch.keep.any(axis=0))
    top, bottom, left, right = rows[0], rows[-1] + 1, columns[0], columns[-1] + 1
    across, down = patch.across / patch.columns, patch.down / patch.rows
    grid = {
        "origin": patch.origin + across * left + down * top,
        "across": across * (right - left),
        "down": down * (bottom - top),
        "normal": patch.normal,
    }
    stage.run_grid(grid, columns=int(right - left), rows=int(bottom - top), samples=samples, seed=seed)
    out = []
    for which in ("lux", "error"):
        full = np.full(patch.keep.shape, np.nan)
        full[top:bottom, left:right] = stage.image(which).numpy()[:, :, 0]
        out.append(full)
    return out[0], out[1]


def mean_with_bias(field: Field) -> tuple[Estimate, float]:
    """The mean, and the absolute error that its standard error leaves out."""
    mean = field.mean
    return mean, mean.value * field.bias


def modelling(cylindrical: Field, horizontal: Field) -> tuple[Estimate, float]:
    """Mean cylindrical over mean horizontal illuminance of the same points by independent paths, and the absolute error
    that its standard error leaves out."""
    above, below = cylindrical.mean, horizontal.mean
    if below.value <= 0:
        return Estimate(math.nan, math.nan), 0.0
    ratio = above.value / below.value
    relative = math.hypot(above.error / max(above.value, 1e-300), below.error / below.value)
    return Estimate(ratio, ratio * relative, min(above.freedom, below.freedom)), ratio * cylindrical.bias


def paths_needed(field: Field, limit: float, confidence: float, samples: int) -> float:
    """Paths for each point after which the mean would be decided against a limit, if it stays as it is."""
    mean, bias = mean_with_bias(field)
    gap = abs(mean.value - limit) - bias
    if gap <= 0:
        return math.inf
    return samples * (mean.error * quantile(confidence, mean.freedom) / gap) ** 2
