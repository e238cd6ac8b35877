"""Requirements as limits on the dimmers, and their values for given dimmers, from linear responses.

Each limit is divided by its own scale, so that the violation of each is a share: 0.1 means that a tenth is missing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .convex import Limits
from .measure import UGR_FACTOR
from .responses import UGR_SCALE, GlareResponse, Response

if TYPE_CHECKING:
    from .luminaires import Luminaire
    from .standard import Requirement

#: Quantities that dimmers change; the others are only checked.
DIMMABLE = ("mean", "uniformity", "minimum", "glare", "density", "flux")


@dataclass(frozen=True)
class Model:
    """The responses with which requirements are evaluated. Each dimmer belongs to a luminaire and lies in [0, 1]."""

    luminaires: Sequence[Luminaire]
    responses: Mapping[str, Response]
    glare: Mapping[str, GlareResponse]
    maintenance: float
    floor_area: float

    def value(self, r: Requirement, dimmers: NDArray[np.float64]) -> float:
        """The number that a requirement limits."""
        if r.quantity in ("mean", "uniformity", "minimum"):
            lux = self.maintenance * self.responses[r.area].values(dimmers)
            if r.quantity == "minimum":
                return float(lux.min())
            mean = float(self.responses[r.area].area.weights @ lux)
            return mean if r.quantity == "mean" else float(lux.min()) / max(mean, 1e-300)
        if r.quantity == "glare":
            return float(self.glare[r.area].ugr(dimmers).max())
        if r.quantity == "density":
            return float(np.array([lamp.product.watts for lamp in self.luminaires]) @ dimmers / self.floor_area)
        if r.quantity == "flux":
            fluxes = np.array([lamp.product.flux for lamp in self.luminaires]) * dimmers
            return float(fluxes.min() if r.is_minimum else fluxes.max())
        return min((lamp.product.rendering for lamp in self.luminaires), default=math.nan)

    def limits(self, r: Requirement, margin: float = 0) -> Limits:
        """The limits of a requirement; the margin is a share of the limit, or of 1 in units of UGR."""
        count = len(self.luminaires)
        if r.quantity == "mean":
            response = self.responses[r.area]
            sign = -1.0 if r.is_minimum else 1.0
            goal = r.limit * (1 - sign * margin)
            weights = response.area.weights
            row = sign * self.maintenance * (weights @ response.matrix)
            constant = -sign * goal + sign * self.maintenance * (weights @ response.other)
            return _linear(row[None] / r.limit, np.array([constant / r.limit]))
        if r.quantity == "minimum":
            response, share = self.responses[r.area], self.maintenance / r.limit
            return _linear(-share * response.matrix, 1 + margin - share * response.other)
        if r.quantity == "uniformity":
            return self._uniformity(r, margin)
        if r.quantity == "glare":
            return self._glare(r, margin)
        if r.quantity == "density":
            watts = np.array([lamp.product.watts for lamp in self.luminaires])
            return _linear(watts[None] / self.floor_area / r.limit, np.array([-1.0]))
        if r.quantity == "flux" and not r.is_minimum:
            fluxes = np.array([lamp.product.flux for lamp in self.luminaires])
            return _linear(np.diag(fluxes / r.limit), -np.ones(count))
        raise ValueError(f"'{r}' is not a convex limit for dimmers: it can be checked, but not be solved for")

    def _uniformity(self, r: Requirement, margin: float) -> Limits:
        if not r.is_minimum:
            raise ValueError(f"'{r}' is not a convex limit for dimmers: it can be checked, but not be solved for")
        response, goal = self.responses[r.area], r.limit * (1 + margin)
        mean, other = response.area.weights @ response.matrix, response.area.weights @ response.other
        scale = max(r.limit * (mean.sum() + other), 1e-300)
        return _linear((goal * mean - response.matrix) / scale, (goal * other - response.other) / scale)

    def _glare(self, r: Requirement, margin: float) -> Limits:
        response = self.glare[r.area]
        bound = 10 ** ((r.limit - margin) / UGR_FACTOR)
        seen = (response.sources > 0).any(axis=1) | (response.other_sources > 0)
        most = response.background.sum(axis=1) + response.other_background
        scale = bound * np.maximum(most, 1e-300)
        constant = UGR_SCALE * response.other_sources - bound * response.other_background
        # Observers who see no source keep their row, so that the limits of other luminaires have the same order.
        return Limits(
            2 * UGR_SCALE * response.sources / scale[:, None],
            -bound * response.background / scale[:, None],
            np.where(seen, constant / scale, -1.0),
        )


def _linear(rows: NDArray[np.float64], constants: NDArray[np.float64]) -> Limits:
    return Limits(np.zeros_like(rows), rows, constants)
