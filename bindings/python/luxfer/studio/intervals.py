"""Intervals of the numbers that the page states about lamps and plans, from the errors that the library states."""

from __future__ import annotations

import math
from typing import Any

import luxfer
import numpy as np
from luxfer.photometry import colour_temperature

#: Standard deviations on each side of a 95 % interval.
WIDTH = 1.96
#: Samples of the colour of the solution.
SAMPLES = 200
#: Plans predict time and noise within this share, in more than nine of ten cases. [bench plan]
PLAN_SHARE = 0.25


def around(value: float, relative: float) -> list[float]:
    """Returns the 95 % interval of a positive value whose logarithm has the standard deviation `relative`."""
    factor = math.exp(WIDTH * relative)
    return [value / factor, value * factor]


def of_plan(value: float) -> list[float]:
    """Returns the bounds of a prediction of a plan."""
    return [value * (1 - PLAN_SHARE), value * (1 + PLAN_SHARE)]


def sizes(lamps: list[luxfer.types.Fixture], scale_error: float, texel: float) -> list[list[float]]:
    """Returns bounds of the length and of the width of lamps of one kind, in metres: all lamps lie within, with the
    95 % interval of the scale and one texel on each side."""
    out = []
    for k in (0, 1):
        values = [lamp.size[k] for lamp in lamps]
        out.append([max(0.0, around(min(values), scale_error)[0] - texel), around(max(values), scale_error)[1] + texel])
    return out


def kelvin(
    context: luxfer.Context, lamps: list[luxfer.types.Fixture], solution: luxfer.types.RelightReport
) -> list[float]:
    """Returns bounds of the colour temperature of lamps of one kind: all lamps lie within, with the 95 % interval of
    the noise of the solution. The library states the noise of each channel and not their correlation, so the channels
    are taken as independent. The paths of all channels are the same, so the true interval is narrower."""
    pairs = zip(solution.half_width, solution.scale)
    errors = np.array([half / scale / WIDTH if scale > 0 else 0.0 for half, scale in pairs])
    factors = np.exp(np.random.default_rng(1).standard_normal((SAMPLES, 3)) * errors)
    lit = [lamp for lamp in lamps if max(lamp.radiance) > 0]
    if not lit:  # dimmed to nothing
        return [min(lamp.cct for lamp in lamps), max(lamp.cct for lamp in lamps)]
    ends = min(lit, key=lambda lamp: lamp.cct), max(lit, key=lambda lamp: lamp.cct)
    found = [[colour_temperature(context, list(lamp.radiance * by))[0] for by in factors] for lamp in ends]
    return [float(np.quantile(found[0], 0.025)), float(np.quantile(found[1], 0.975))]


def of_kinds(
    context: luxfer.Context,
    lamps: list[luxfer.types.Fixture],
    solution: luxfer.types.RelightReport,
    scale_error: float,
    texel: float,
) -> dict[str, dict[str, Any]]:
    """Returns the bounds of size and colour temperature of each kind of lamp."""
    kinds: dict[int, list[luxfer.types.Fixture]] = {}
    for lamp in lamps:
        kinds.setdefault(lamp.kind, []).append(lamp)
    return {
        str(kind): {"size": sizes(of_kind, scale_error, texel), "cct": kelvin(context, of_kind, solution)}
        for kind, of_kind in kinds.items()
    }
