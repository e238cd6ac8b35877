"""Finds dimmers of luminaires that stay closest to a photo's look and meet all requirements.

1. Measure once the linear responses of the quantities that the requirements limit.
2. Minimise the distance of the look (look.objective) under the requirements as convex limits. Nothing is traced again.
3. Check the result with independent paths. A requirement that does not pass with the wanted confidence gets a
   margin, and step 2 is repeated.

If no dimmers meet the requirements, explain.py states which requirements bind, and the result of relaxing each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .check import Checked, Settings, check
from .constraints import DIMMABLE, Model
from .convex import Contradictions, Limits, box, min_violation, minimise
from .explain import Relaxation, joined, of_groups, relaxations
from .look import Distance, distance, objective
from .luminaires import Luminaire, dimmed, lit_scene
from .measure import dark_and_spread
from .responses import respond_all, respond_glare
from .standard import OF_AREAS

if TYPE_CHECKING:
    from ..scene import Scene
    from .areas import Area
    from .check import Finding
    from .observers import Observers
    from .standard import Requirement

#: First margin of means and uniformities as a share of the limit, and of glare in units of UGR. [convention]
MARGIN, GLARE_MARGIN = 0.005, 0.1
#: Rounds of check and new margins. [convention]
ROUNDS = 5
#: Limits are kept by this share of their scale, so that the barrier has an inside. [rounding]
INSIDE = 1e-6
#: The responses are measured with seeds this far from the seeds of the check. [convention]
SEED_OFFSET = 100_003


@dataclass(frozen=True)
class Wishes:
    """The allowed dimmers."""

    max_dimmer: float = 1
    """Largest dimmer of a luminaire."""
    min_dimmer: float = 0
    """Smallest dimmer of a luminaire, also of the least in a group."""
    levels: tuple[float, ...] = ()
    """The dimmers that drivers can set; empty for drivers without steps. The luminaires of a group must then have
    equal dimmers, because unequal dimmers would be shares of a level."""
    paths: int = 1024
    """Paths for each point that measure the responses."""
    points: int = 0
    """Points of each area, at most about, that measure the responses, besides its darkest points in the light of the
    given dimmers; 0: all. Fewer are faster, and need more rounds if the darkest point is not among them. The check has
    all points."""
    reserve: float = 0
    """Share of the limits of illuminance and uniformity by which the design is aimed to exceed them, such as 0.02. The
    confidence covers the randomness of the calculation only: a reserve is for the reflectances, the photometry and the
    program of whoever recomputes the design."""


@dataclass(frozen=True)
class Solution:
    """A design, or the explanation why no design was found."""

    feasible: bool
    """Whether dimmers were found that are known to meet all requirements that dimmers can meet."""
    luminaires: tuple[Luminaire, ...]
    """The luminaires with their dimmers; if not feasible, the dimmers with the smallest worst violation that was found,
    as a share of its limit."""
    look: Distance
    """Distance from the photo's look."""
    checked: Checked
    """The requirements checked with independent paths."""
    relaxations: tuple[Relaxation, ...] = ()
    """If not feasible: the limit to which each requirement alone would have to be relaxed."""
    rounds: int = 1
    """Number of solutions until the check passed."""
    wishes: Wishes = Wishes()

    unknown: tuple[Finding, ...] = ()
    """If not feasible: the requirements that cannot be decided for any dimmers, such as a limit on the power of
    luminaires whose power is unknown."""
    contradictory: bool = False
    """If not feasible: whether the other requirements cannot be met together; if not, the dimmers meet them."""

    def explanation(self) -> str:
        """The result in sentences."""
        if self.feasible:
            return f"{self.checked.verdict()}; {self.look}"
        lines = [f"'{f.requirement}' cannot be decided: {f.note or 'its value is not known'}" for f in self.unknown]
        if self.contradictory:
            lines.append("no dimmers meet all requirements together")
            lines += [str(r) for r in self.relaxations] or ["relaxing any single one of them is not enough"]
        else:
            lines.append("the dimmers meet all other requirements that dimmers can meet")
        return "; ".join(lines)


def solve(
    scene: Scene,
    luminaires: Sequence[Luminaire],
    requirements: Sequence[Requirement],
    areas: Sequence[Area],
    observers: Sequence[Observers] = (),
    *,
    floor_area: float,
    settings: Settings,
    wishes: Wishes = Wishes(),
    model: Model | None = None,
    surfaces: NDArray | None = None,
) -> Solution:
    """Solves for the dimmers; the dimmers of the given luminaires are the photo's look. With the model of an earlier
    solution for the same luminaires and areas (see measured_model) only the check traces light. With surfaces, their
    brightness ratios belong to the look, too (see look.objective)."""
    if model is None:
        model = measured_model(scene, luminaires, requirements, areas, observers, floor_area, settings, wishes)
    groups = _groups(luminaires)
    if wishes.levels and not (groups.sum(axis=1) == 1).all():
        raise ValueError("levels need equal dimmers within each group: other luminaires would get shares of a level")
    photo, flux = np.array([lamp.dimmer for lamp in luminaires]), np.array([lamp.product.flux for lamp in luminaires])
    margins = first_margins(requirements, wishes.reserve)
    solvable, aim = list(margins), objective(photo, flux, surfaces)
    tried: list[tuple[NDArray, Checked]] = []
    unknown: tuple[Finding, ...] = ()
    for turn in range(1, ROUNDS + 1):
        dimmers, _ = nearest(model, margins, aim, groups, wishes)
        if dimmers is None:
            break
        checked = _checked(scene, luminaires, dimmers, requirements, areas, observers, floor_area, settings)
        tried.append((dimmers, checked))
        found = [f for f in checked.findings if f.requirement in margins and f.outcome != "passes"]
        unknown = tuple(f for f in found if f.outcome == "unknown")  # no margin makes them known
        missed = [f for f in found if f.outcome != "unknown"]
        if not missed:
            final, look = tuple(dimmed(luminaires, dimmers)), distance(photo, dimmers, flux)
            return Solution(not unknown, final, look, checked, (), turn, wishes, unknown)
        for finding in missed:
            margins[finding.requirement] += _more(finding)
    known = [r for r in solvable if r not in {f.requirement for f in unknown}]
    hard, start = start_of(groups, wishes)
    closest, eased = relaxations(model, known, groups, hard, start)
    if not tried:
        dimmers = np.clip(closest, *(groups @ end for end in _range(groups, wishes)))
        if wishes.levels:
            levels = np.array(wishes.levels)
            dimmers = levels[np.abs(levels[None] - dimmers[:, None]).argmin(axis=1)]
        checked = _checked(scene, luminaires, dimmers, requirements, areas, observers, floor_area, settings)
        tried.append((dimmers, checked))
        unknown = tuple(f for f in checked.findings if f.requirement in margins and f.outcome == "unknown")
    dimmers, checked = min(tried, key=lambda one: _worst_miss(one[1]))
    final, look = tuple(dimmed(luminaires, dimmers)), distance(photo, dimmers, flux)
    return Solution(False, final, look, checked, tuple(eased), turn, wishes, unknown, True)


def _worst_miss(checked: Checked) -> float:
    """The largest share of its limit by which the near end of an interval misses it."""
    ends = [(f, f.low if f.requirement.is_minimum else f.high) for f in checked.findings if f.outcome != "unknown"]
    misses = [replace(f, value=end).reserve for f, end in ends]
    return max((-m for m in misses if np.isfinite(m)), default=0.0)


def measured_model(
    scene: Scene,
    luminaires: Sequence[Luminaire],
    requirements: Sequence[Requirement],
    areas: Sequence[Area],
    observers: Sequence[Observers],
    floor_area: float,
    settings: Settings,
    wishes: Wishes,
) -> Model:
    """The linear responses of the quantities that the requirements limit."""
    if not luminaires:
        raise ValueError("a design without luminaires cannot be solved for")
    wanted = {r.area for r in requirements if r.quantity in OF_AREAS and r.quantity in DIMMABLE}
    rated = {r.area for r in requirements if r.quantity == "glare"}
    missing = (wanted - {a.name for a in areas}) | (rated - {o.name for o in observers})
    if missing:
        raise ValueError(f"requirements name {', '.join(sorted(missing))}, which is no area and no group of observers")
    chosen = [a for a in areas if a.name in wanted]
    groups = [o for o in observers if o.name in rated]
    seed = settings.seed + SEED_OFFSET
    if wishes.points:
        lit = lit_scene(scene, luminaires)
        chosen = [dark_and_spread(lit, a, wishes.points, seed) for a in chosen]
    responses = respond_all(scene, luminaires, chosen, wishes.paths, seed) if chosen else []
    glare = respond_glare(scene, luminaires, groups, seed) if groups else []
    return Model(
        luminaires,
        {r.area.name: r for r in responses},
        {g.observers.name: g for g in glare},
        settings.maintenance,
        floor_area,
    )


def _groups(luminaires: Sequence[Luminaire]) -> NDArray[np.float64]:
    """Matrix (luminaires, dimmers): luminaires of one group share a dimmer relative to their look."""
    keys = [lamp.group or f"\0{index}" for index, lamp in enumerate(luminaires)]
    names = list(dict.fromkeys(keys))
    out = np.zeros((len(keys), len(names)))
    for row, key in enumerate(keys):
        column = names.index(key)
        peak = max(lamp.dimmer for lamp, k in zip(luminaires, keys) if k == key)
        out[row, column] = luminaires[row].dimmer / peak if peak > 0 else 1.0
    return out


def _range(groups: NDArray, wishes: Wishes) -> tuple[NDArray, NDArray]:
    """The smallest and the largest dimmer of each group, so that each of its luminaires is within the wishes."""
    if not 0 <= wishes.min_dimmer < wishes.max_dimmer:
        raise ValueError(f"min_dimmer = {wishes.min_dimmer} is not in [0, max_dimmer = {wishes.max_dimmer})")
    high = np.full(groups.shape[1], float(wishes.max_dimmer))
    if wishes.min_dimmer == 0:
        return np.zeros(groups.shape[1]), high
    if not groups.any(axis=1).all():
        raise ValueError(f"min_dimmer = {wishes.min_dimmer}, but a luminaire of a group is off, and stays so")
    least = np.where(groups > 0, groups, np.inf).min(axis=0)
    if (wishes.min_dimmer >= wishes.max_dimmer * least).any():
        raise ValueError(
            f"min_dimmer = {wishes.min_dimmer} is too large for a group whose least luminaire has {least.min():.3g} of "
            f"the dimmer of its brightest, which is at most {wishes.max_dimmer}"
        )
    return wishes.min_dimmer / least, high


def start_of(groups: NDArray, wishes: Wishes) -> tuple[Limits, NDArray]:
    """The range of the dimmers of groups, and a point inside."""
    low, high = _range(groups, wishes)
    return box(low - INSIDE, high + INSIDE), 0.5 * (low + high)


def first_margins(requirements: Sequence[Requirement], reserve: float = 0) -> dict[Requirement, float]:
    """The requirements that dimmers can meet, with their first margins."""
    if not 0 <= reserve < 1:
        raise ValueError(f"reserve = {reserve} is not in [0, 1)")
    solvable = [r for r in requirements if r.quantity in DIMMABLE and not (r.quantity == "flux" and r.is_minimum)]
    return {
        r: GLARE_MARGIN
        if r.quantity == "glare"
        else 0.0
        if r.quantity in ("density", "flux")
        else max(MARGIN, reserve)
        for r in solvable
    }


def nearest(
    model: Model,
    margins: dict[Requirement, float],
    aim: tuple[NDArray, NDArray],
    groups: NDArray,
    wishes: Wishes,
    known: Contradictions | None = None,
) -> tuple[NDArray | None, float]:
    """The dimmers that minimise the aim (see look.objective) within the limits and margins, or None if no dimmers are
    within them, and a share by which all limits can be missed together, at most twice the smallest one, negative if
    they can be met. If the limits contradict each other for a known reason, nothing is solved, and the share is a lower
    bound; a new reason is added to the known ones."""
    hard, start = start_of(groups, wishes)
    parts = [of_groups(model.limits(r, margin), groups) for r, margin in margins.items()]
    limits, violation = hard, -1.0
    if parts:
        soft = joined(parts)
        bound = known.bound(soft, *_range(groups, wishes)) if known else -np.inf
        if bound > 0:
            return None, bound
        violation, inside = min_violation(soft, hard, start, decide=True)
        if violation > -INSIDE:
            if known:
                known.add(inside.multipliers[: len(soft.constant)])
            return None, violation
        start, limits = inside.x[:-1], soft.joined(hard)
    # One more variable: the exposure.
    hessian, gradient = aim
    wide = np.zeros((len(hessian), groups.shape[1] + 1))
    wide[:-1, :-1], wide[-1, -1] = groups, 1.0
    extended = limits.relaxed(np.zeros(len(limits.constant)))
    found = minimise(wide.T @ hessian @ wide, wide.T @ gradient, extended, np.append(start, 1.0))
    dimmers = np.clip(found.x[:-1], *_range(groups, wishes))
    if wishes.levels:
        stepped = _in_steps(dimmers, limits, hessian, gradient, groups, wishes)
        return (None if stepped is None else groups @ stepped), violation
    return groups @ dimmers, violation


def _in_steps(
    dimmers: NDArray, limits: Limits, hessian: NDArray, gradient: NDArray, groups: NDArray, wishes: Wishes
) -> NDArray | None:
    """Dimmers among the drivers' levels: the next level above, then changes of single dimmers as long as the limits
    hold and the look improves. This is a heuristic; it does not search for the optimum."""
    levels = np.array(sorted(v for v in wishes.levels if wishes.min_dimmer <= v <= wishes.max_dimmer))
    if not len(levels):
        raise ValueError(f"no level of {wishes.levels} is in [{wishes.min_dimmer}, {wishes.max_dimmer}]")

    def cost(x: NDArray) -> float:
        if (limits.values(x) > INSIDE).any():
            return np.inf
        s = groups @ x
        k = -(hessian[-1, :-1] @ s + gradient[-1]) / hessian[-1, -1]  # the best exposure
        y = np.append(s, k)
        return float(0.5 * y @ hessian @ y + gradient @ y)

    nearest = levels[np.abs(levels[None] - dimmers[:, None]).argmin(axis=1)]
    above = levels[np.minimum(np.searchsorted(levels, dimmers - 1e-9), len(levels) - 1)]
    candidates = [x for x in (nearest, above, *(np.full(len(dimmers), v) for v in levels)) if np.isfinite(cost(x))]
    if not candidates:
        return None
    x = min(candidates, key=cost)
    while True:
        moves = [np.where(np.arange(len(x)) == i, v, x) for i in range(len(x)) for v in levels if v != x[i]]
        better = min(moves, key=cost, default=x)
        if cost(better) >= cost(x) - 1e-12:  # [rounding]
            return x
        x = better


def _checked(
    scene: Scene,
    luminaires: Sequence[Luminaire],
    dimmers: NDArray,
    requirements: Sequence[Requirement],
    areas: Sequence[Area],
    observers: Sequence[Observers],
    floor_area: float,
    settings: Settings,
) -> Checked:
    final = dimmed(luminaires, dimmers)
    lit = lit_scene(scene, final)
    return check(lit, final, requirements, areas, observers, floor_area=floor_area, settings=settings)


def _more(finding: Finding) -> float:
    """The margin that a finding lacks: slightly more than the distance from the near end of its interval to the
    limit."""
    r = finding.requirement
    near = finding.low if r.is_minimum else finding.high
    lack = (r.limit - near) if r.is_minimum else (near - r.limit)
    if r.quantity == "glare":
        return max(0.1, lack) if np.isfinite(lack) else 1.0
    return max(0.002, lack / r.limit * 1.1)
