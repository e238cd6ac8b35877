"""Explains wishes that cannot be met together: the limit to which each requirement alone would have to be relaxed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .convex import Limits, min_violation

if TYPE_CHECKING:
    from .constraints import Model
    from .standard import Requirement

#: A requirement binds if relaxing it lets the others hold; violations below this share count as zero. [rounding]
NONE = 1e-4


@dataclass(frozen=True)
class Relaxation:
    """A requirement: if it alone is relaxed, the others can be met."""

    requirement: Requirement
    attainable: float
    """The best value of its quantity while all other requirements hold."""

    def __str__(self) -> str:
        r = self.requirement
        unit = f" {r.unit}" if r.unit else ""
        word = "at least" if r.is_minimum else "at most"
        return f"all others hold if '{r}' becomes {word} {self.attainable:.4g}{unit}"


def relaxations(
    model: Model,
    requirements: Sequence[Requirement],
    groups: NDArray[np.float64],
    hard: Limits,
    start: NDArray[np.float64],
) -> tuple[NDArray[np.float64], list[Relaxation]]:
    """The dimmers that miss all requirements by the least equal share, and for each requirement the limit to which it
    would have to be relaxed if only it were relaxed; requirements whose relaxation alone does not help are left out."""
    parts = [of_groups(model.limits(r), groups) for r in requirements]
    _, closest = min_violation(joined(parts), hard, start)
    out = []
    for index, r in enumerate(requirements):
        rest = [p for i, p in enumerate(parts) if i != index]
        limits, inside = hard, start
        if rest:
            violation, found = min_violation(joined(rest), hard, start)
            if violation > -NONE * 1e-2:
                continue  # the others contradict each other already
            limits, inside = joined(rest).joined(hard), found.x[:-1]
        violation, found = min_violation(parts[index], limits, inside)
        if violation > NONE:
            out.append(Relaxation(r, model.value(r, groups @ found.x[:-1])))
    return groups @ closest.x[:-1], out


def of_groups(limits: Limits, groups: NDArray[np.float64]) -> Limits:
    """Limits on luminaires as limits on the dimmers of groups."""
    return Limits(limits.quadratic @ groups**2, limits.linear @ groups, limits.constant)


def joined(parts: Sequence[Limits]) -> Limits:
    """All limits together."""
    out = parts[0]
    for part in parts[1:]:
        out = out.joined(part)
    return out
