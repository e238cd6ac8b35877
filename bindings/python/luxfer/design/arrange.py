"""Finds places, product and dimmers of luminaires together: the design that stays closest to a photo's look and meets
all requirements.

1. Find the pattern of the photo's lamps (motif.py), and make candidates: each product, with the pattern scaled, turned
   and shifted. Lamps that do not fit on the ceiling, or lie in a keep-out rectangle, are left out.
2. Measure coefficients once (coefficients.py). With them, find the dimmers of each candidate that meet the
   requirements. Candidates are tried in the order of the cost (likeness.py) that they have with the best dimmers
   without requirements; the search ends when no remaining candidate can be closer. Candidates that are too dark at
   full power are left out first, then those that cannot meet the requirements for the same reason as an earlier one.
3. Improve scale and offset of the closest candidates by small steps; luminaires that are made to measure for one scale
   keep it.
4. Solve for the dimmers of the closest candidates anew with their own paths, and check them with others (solve.py).
   The closest one that passes is the design; the others are solved for only if they may still be closer. The checks
   have few paths first, which wide margins make up for, and all paths only if no candidate passes.

Only the paths are random, and their seeds are fixed: equal input gives an equal design.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..photometry import colour_of_temperature, colour_temperature
from . import areas as made
from . import coefficients, likeness, motif
from .candidates import Candidate, Patterns, Search
from .convex import Contradictions
from .explain import Relaxation, relaxations
from .likeness import Likeness
from .look import distance, objective
from .luminaires import dimmed
from .measure import dark_and_spread, measure
from .solve import SEED_OFFSET, Solution, Wishes, first_margins, measured_model, nearest, solve, start_of
from .standard import OF_AREAS

if TYPE_CHECKING:
    from ..scene import Scene
    from .areas import Area
    from .check import Settings
    from .coefficients import Coefficients, Kind
    from .luminaires import Luminaire, Product
    from .project import Project
    from .standard import Requirement

#: Margins of the first choice in addition to the margins of the solution, as a share of the limit of means, of single
#: points, and in units of UGR, because interpolated coefficients are uncertain. [convention]
MARGIN, POINT_MARGIN, GLARE_MARGIN = 0.01, 0.03, 0.4
#: First step of the scale as a factor, and of the offset in shares of the lattice; each round halves them.
#: [convention]
SCALE_STEP, OFFSET_STEP, ROUNDS = 1.1, 0.125, 3
#: Smallest decrease of the total distance by a step, about the error of the coefficients. [convention]
MIN_GAIN = 0.003
#: Number of candidates that miss the requirements by the least and for which relaxed requirements are tried.
#: [convention]
EXPLAINED = 3
#: Number of candidates that are solved for to find those. [convention]
EXAMINED = 40
#: A requirement changes the look if the total distance without it is smaller by more than this. [convention]
PRICE = 0.002
#: A limit with more room than this share does not bind: the error of the solution is far below. [rounding]
SLACK = 1e-3
#: Points of each area that measure the responses of the final dimmers, paths for each point that measure the surfaces.
#: [convention]
FINAL_POINTS, SURFACE_PATHS = 32, 256
#: Paths for each point at which the first check of a candidate ends. [convention]
FEW_PATHS = 1024


@dataclass(frozen=True)
class Offer:
    """A product that a design may use."""

    product: Product
    kelvin: tuple[float, float] | None = None
    """Lowest and highest colour temperature of its light; None: any colour, as luminaires with coloured LEDs have."""
    scale: float | None = None
    """The only scale of the pattern for which it is used; None: any."""

    @classmethod
    def to_measure(
        cls, make: Callable[[float], Product], scales: Sequence[float], kelvin: tuple[float, float] | None = None
    ) -> list[Offer]:
        """Luminaires that are made to measure: `make` returns the product for a pattern of a scale."""
        return [cls(make(scale), kelvin, scale) for scale in scales]


@dataclass(frozen=True)
class Arrangement:
    """A design with its places, or the explanation why no design was found."""

    project: Project
    """The project with the luminaires of the design."""
    solution: Solution
    """Their dimmers and the check."""
    look: Likeness
    """Distance from the photo's copy, with surfaces measured by independent paths."""
    offer: Offer
    scale: float
    turn: float
    offset: tuple[float, float]
    tried: int
    """Number of patterns that were tried."""
    met: int
    """Number of them that meet the requirements by the coefficients."""
    prices: tuple[tuple[Requirement, float], ...] = ()
    """Requirements that keep the design from the look: the decrease of the total distance without each of them."""
    relaxations: tuple[Relaxation, ...] = ()
    """If not feasible: the limit to which each requirement alone would have to be relaxed, with the patterns that come
    closest."""

    @property
    def feasible(self) -> bool:
        """Whether all requirements that the design can meet are met."""
        return self.solution.feasible

    def explanation(self) -> str:
        """The result in sentences."""
        count = len(self.project.luminaires)
        head = f"{count} luminaires '{self.offer.product.name}': {self.look}"
        if self.feasible:
            kept = ", ".join(f"'{r}' ({100 * p:.1f} %)" for r, p in self.prices)
            cost = f"; most of the change is due to {kept}" if kept else ""
            return f"{self.solution.checked.verdict()}; {head}{cost}"
        lines = [f"none of {self.tried} patterns meets all requirements together"]
        lines += [str(r) for r in self.relaxations] or [self.solution.explanation()]
        return "; ".join([*lines, f"closest comes the design with {head}"])


@dataclass(frozen=True)
class _Task:
    """The data that all candidates share."""

    project: Project
    offers: Sequence[Offer]
    search: Search
    wishes: Wishes
    table: Coefficients
    patterns: Patterns
    surfaces: Sequence[Area]
    copy: NDArray[np.float64]
    """Illuminance of the surfaces by the photo's lamps, by coefficients or paths."""
    flux: float
    """Flux of the photo's lamps."""
    colours: Sequence[float]
    """Colour difference of each offer."""
    margins: dict[Requirement, float]
    """The requirements that dimmers can meet, with margins for coefficients that are interpolated."""
    known: Contradictions = field(default_factory=Contradictions)
    """Reasons why patterns cannot meet the requirements."""


@dataclass(frozen=True)
class _Rated:
    """A candidate by the coefficients."""

    candidate: Candidate
    violation: float
    """A share by which it misses the requirements."""
    look: Likeness | None = None
    """Its look with the best dimmers that meet the requirements; None if none do."""
    dimmers: NDArray[np.float64] | None = None

    @property
    def cost(self) -> float:
        """The cost of its look; infinite if it misses the requirements."""
        return math.inf if self.look is None else self.look.cost


def arrange(
    project: Project, offers: Sequence[Offer | Product], wishes: Wishes = Wishes(), search: Search = Search()
) -> Arrangement:
    """The design closest to the look of the project's luminaires, which are the photo's lamps (see from_transfer)."""
    chosen = [o if isinstance(o, Offer) else Offer(o) for o in offers]
    if not chosen:
        raise ValueError("there is no product to design with: offers is empty")
    wishes = replace(wishes, points=wishes.points or FINAL_POINTS)
    found = motif.find(project.room, project.luminaires)
    kinds, colours = _kinds(project, chosen)
    patterns = Patterns(project.room, found, search, kinds, colours)
    candidates = patterns.all([o.scale for o in chosen])
    if not candidates:
        raise ValueError(
            "no pattern has a luminaire that fits on the ceiling outside the keep-out rectangles, with at most "
            f"max_lamps = {search.max_lamps}: allow other scales or smaller products"
        )
    surfaces = _surfaces(project)
    lit = project.lit()
    copy = _brightness(lit, surfaces, project)
    angles: list[list[float]] = [[] for _ in chosen]
    for c in candidates:
        angles[c.offer] += c.lamps.angles.tolist()
    wanted = [*_wanted(project, lit), *surfaces]
    rated = {r.area for r in project.requirements if r.quantity == "glare"}
    eyes = [o for o in project.observers if o.name in rated]
    seed, below = project.chosen.seed + SEED_OFFSET, _below(project)
    table = coefficients.measure(project.room, kinds, angles, wanted, eyes, below, project.chosen.maintenance, seed)
    flux = sum(lamp.flux for lamp in project.luminaires)
    margins = _margins(project.requirements, wishes.reserve)
    task = _Task(project, chosen, search, wishes, table, patterns, surfaces, copy, flux, colours, margins)
    return _best(task, candidates)


def _kinds(project: Project, offers: Sequence[Offer]) -> tuple[list[Kind], list[float]]:
    """The kinds of luminaires, and the colour difference of each."""
    photo = _mean_colour(project.luminaires)
    lights = [_nearest_colour(project.room.scene.context, photo, o.kelvin) for o in offers]
    kinds = [coefficients.kind(project.room, o.product, light) for o, light in zip(offers, lights)]
    return kinds, [likeness.colour_difference(photo, np.array(light)) for light in lights]


def _best(task: _Task, candidates: Sequence[Candidate]) -> Arrangement:
    """Searches the candidates, and checks the closest ones."""
    met: list[_Rated] = []
    missed: list[_Rated] = []
    solved = 0
    # For each candidate: a lower bound of its cost, whether this is the cost with the best dimmers, its number.
    queue = [(c.bound, False, number) for number, c in enumerate(candidates)]
    heapq.heapify(queue)
    while queue and solved - task.known.decided < task.search.tries:
        least, with_dimmers, number = heapq.heappop(queue)
        worst = sorted(one.cost for one in met)[: task.search.finalists]
        if len(worst) == task.search.finalists and least >= worst[-1]:
            break
        candidate = candidates[number]
        if not with_dimmers:
            least, dark = _bounds(task, candidate)
            if dark > 0:
                missed.append(_Rated(candidate, dark))
            else:
                heapq.heappush(queue, (least, True, number))
            continue
        one = _rated(task, candidate, task.margins, task.known)
        solved += 1
        (met if one.look else missed).append(one)
    count = len(met) + len(missed)
    met.sort(key=lambda one: one.cost)
    if not met:
        return _failed(task, missed, count)
    better = sorted((_refined(task, one) for one in met[: task.search.finalists]), key=lambda one: one.cost)
    settings = task.project.chosen
    few = replace(settings, max_samples=max(settings.samples, min(settings.max_samples, FEW_PATHS)))
    found, best = _checked(task, better, few, count, len(met))
    if not found.solution.checked.passes:
        found, best = _checked(task, better, settings, count, len(met))
    if found.feasible:
        return replace(found, prices=tuple(_prices(task, best)))
    return replace(found, relaxations=found.solution.relaxations)


def _checked(
    task: _Task, closest: Sequence[_Rated], settings: Settings, tried: int, met: int
) -> tuple[Arrangement, _Rated]:
    """The closest of the candidates that passes, or the first one if none does."""
    best: tuple[Arrangement, _Rated] | None = None
    for one in closest:
        if best and best[0].feasible and best[0].look.cost <= one.cost:
            break
        found = _result(task, one.candidate, _solved(task, one.candidate, settings), tried, met)
        if best is None or (found.feasible and not (best[0].feasible and best[0].look.cost <= found.look.cost)):
            best = found, one
    assert best is not None
    return best


def _bounds(task: _Task, candidate: Candidate) -> tuple[float, float]:
    """The cost of a candidate with the dimmers that would be best without requirements, and the share by which it
    misses a mean illuminance with all lamps at their highest dimmers, 0 if it reaches all means. The latter excludes
    most patterns of too few lamps without solving for their dimmers."""
    means = task.table.means(candidate.offer, candidate.lamps)
    dark = 0.0
    for r, margin in task.margins.items():
        if r.quantity == "mean" and r.is_minimum and r.limit > 0:
            full = task.wishes.max_dimmer * means[r.area].sum() + task.table.responses[r.area].mean_other
            dark = max(dark, 1 - task.table.maintenance * full / (r.limit * (1 + margin)))
    if dark > 0:
        return math.inf, dark
    photo, rows, hessian, gradient = _aim(task, candidate, means)
    dimmers = np.clip(np.linalg.solve(hessian, -gradient)[:-1], 0, task.wishes.max_dimmer)
    return max(candidate.bound, _likeness(task, candidate, photo, dimmers, task.copy * (rows @ dimmers)).cost), 0.0


def _margins(requirements: Sequence[Requirement], reserve: float) -> dict[Requirement, float]:
    """Margins for coefficients that are interpolated."""
    more = {"uniformity": POINT_MARGIN, "minimum": POINT_MARGIN, "glare": GLARE_MARGIN, "density": 0.0, "flux": 0.0}
    return {r: m + more.get(r.quantity, MARGIN) for r, m in first_margins(requirements, reserve).items()}


def _aim(
    task: _Task, candidate: Candidate, means: Mapping[str, NDArray] | None = None
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Wanted dimmers, brightness of the surfaces by each lamp as shares of the copy's, and the aim of the dimmers."""
    means = means or task.table.means(candidate.offer, candidate.lamps)
    product = task.offers[candidate.offer].product
    photo = task.flux * candidate.lamps.flux / candidate.lamps.flux.sum() / product.flux
    rows = np.array([task.table.maintenance * means[a.name] for a in task.surfaces]).reshape(-1, len(photo))
    rows = rows / task.copy[:, None]
    hessian, gradient = objective(photo, np.full(len(photo), product.flux), rows if len(rows) else None)
    return photo, rows, hessian, gradient


def _rated(
    task: _Task, candidate: Candidate, margins: dict[Requirement, float], known: Contradictions | None = None
) -> _Rated:
    """A candidate by the coefficients."""
    photo, rows, hessian, gradient = _aim(task, candidate)
    model = task.table.model(candidate.offer, candidate.lamps)
    coarse = replace(task.wishes, levels=())
    dimmers, violation = nearest(model, margins, (hessian, gradient), np.eye(len(photo)), coarse, known)
    if dimmers is None:
        return _Rated(candidate, violation)
    look = _likeness(task, candidate, photo, dimmers, task.copy * (rows @ dimmers))
    return _Rated(candidate, violation, look, dimmers)


def _likeness(
    task: _Task, candidate: Candidate, photo: NDArray, dimmers: NDArray, surfaces: NDArray
) -> Likeness:
    """The distance of a candidate with dimmers and its light on the surfaces."""
    change = distance(photo, dimmers, np.ones(len(photo)))
    light = np.array(task.table.kinds[candidate.offer].colour)
    before = _mean_colour(task.project.luminaires)
    ratios = likeness.surface_distance(task.copy, surfaces) if len(surfaces) else 0.0
    tones = likeness.surface_delta_e(task.copy, surfaces, before, light) if len(surfaces) else 0.0
    return Likeness(
        candidate.pattern,
        change.pattern,
        ratios,
        tones,
        task.colours[candidate.offer],
        candidate.scale,
        candidate.turn,
        candidate.offset,
        change.exposure,
    )


def _refined(task: _Task, start: _Rated) -> _Rated:
    """A candidate that is at least as close as the given one, found near it by steps of scale and offset that are
    halved."""
    best = start
    for turn in range(ROUNDS):
        factor, step = SCALE_STEP ** (0.5**turn), OFFSET_STEP * 0.5**turn
        now = best.candidate
        u, v = now.offset
        made_for_one = task.offers[now.offer].scale is not None
        moves = [] if made_for_one else [(now.scale * f, (u, v)) for f in (1 / factor, factor)]
        moves += [(now.scale, (u + a, v + b)) for a, b in ((-step, 0), (step, 0), (0, -step), (0, step))]
        for scale, offset in moves:
            one = task.patterns.made(now.offer, scale, now.turn, offset)
            if one is None or max(one.bound, _bounds(task, one)[0]) >= best.cost - MIN_GAIN:
                continue
            found = _rated(task, one, task.margins, task.known)
            best = found if found.cost < best.cost - MIN_GAIN else best
    return best


def _solved(task: _Task, candidate: Candidate, settings: Settings) -> Solution:
    """The dimmers of a candidate by its own paths, checked."""
    photo, rows, _, _ = _aim(task, candidate)
    project, coarse = task.project, task.table.model(candidate.offer, candidate.lamps)
    lamps = dimmed(coarse.luminaires, photo.tolist())
    model = measured_model(
        project.room.scene,
        lamps,
        [r for r in project.requirements if r.quantity != "glare"],
        project.areas,
        (),
        project.room.floor_area,
        settings,
        task.wishes,
    )
    return solve(
        project.room.scene,
        lamps,
        project.requirements,
        project.areas,
        project.observers,
        floor_area=project.room.floor_area,
        settings=settings,
        wishes=task.wishes,
        # Measuring the glare of each luminaire would take a scene for each; the check has its own glare anyway.
        model=replace(model, glare=coarse.glare),
        surfaces=rows if len(rows) else None,
    )


def _result(task: _Task, candidate: Candidate, solution: Solution, tried: int, met: int) -> Arrangement:
    """A candidate with its solution; the surfaces are measured."""
    project = task.project.solved(solution)
    product = task.offers[candidate.offer].product
    photo = task.flux * candidate.lamps.flux / candidate.lamps.flux.sum() / product.flux
    dimmers = np.array([lamp.dimmer for lamp in solution.luminaires])
    look = _likeness(task, candidate, photo, dimmers, _brightness(project.lit(), task.surfaces, project))
    offer = task.offers[candidate.offer]
    return Arrangement(
        project, solution, look, offer, candidate.scale, candidate.turn, candidate.offset, tried, met
    )


def _failed(task: _Task, missed: Sequence[_Rated], tried: int) -> Arrangement:
    """The candidate that misses the requirements by the least share, and the result of relaxing each requirement
    alone."""
    best: dict[Requirement, Relaxation] = {}
    closest = _closest(task, missed)
    for candidate in closest:
        model = task.table.model(candidate.offer, candidate.lamps)
        groups = np.eye(len(candidate.lamps.places))
        hard, start = start_of(groups, replace(task.wishes, levels=()))
        _, eased = relaxations(model, list(task.margins), groups, hard, start)
        for one in eased:
            r, known = one.requirement, best.get(one.requirement)
            nearer = known is None or (one.attainable - known.attainable) * (1 if r.is_minimum else -1) > 0
            best[r] = one if nearer else known
    found = _result(task, closest[0], _solved(task, closest[0], task.project.chosen), tried, 0)
    return replace(found, relaxations=tuple(best[r] for r in task.margins if r in best))


def _closest(task: _Task, missed: Sequence[_Rated]) -> list[Candidate]:
    """The candidates that miss the requirements by the least shares. For most of them only a lower bound is known, so
    those with the least bounds are solved for."""
    queue = [(one.violation, False, number) for number, one in enumerate(missed)]
    heapq.heapify(queue)
    out: list[Candidate] = []
    solved = 0
    while queue and len(out) < EXPLAINED:
        violation, exact, number = heapq.heappop(queue)
        candidate = missed[number].candidate
        if exact or solved == EXAMINED:
            out.append(candidate)
        else:
            solved += 1
            heapq.heappush(queue, (max(violation, _rated(task, candidate, task.margins).violation), True, number))
    return out


def _prices(task: _Task, chosen: _Rated) -> list[tuple[Requirement, float]]:
    """The decrease of a candidate's total distance without each requirement, by the coefficients; the largest first.
    Requirements that do not bind cost nothing."""
    assert chosen.look is not None and chosen.dimmers is not None
    model = task.table.model(chosen.candidate.offer, chosen.candidate.lamps)
    out = []
    for r, margin in task.margins.items():
        if model.limits(r, margin).values(chosen.dimmers).max() < -SLACK:
            continue
        without = _rated(task, chosen.candidate, {k: m for k, m in task.margins.items() if k is not r})
        gain = chosen.look.total - without.look.total if without.look else 0.0
        if gain > PRICE:
            out.append((r, gain))
    return sorted(out, key=lambda p: -p[1])


def _surfaces(project: Project) -> list[Area]:
    """Floor, walls and ceiling of a room, with few points; surfaces without points are left out."""
    out = []
    for make in (made.background, made.walls, made.ceiling):
        try:
            area = make(project.room)
        except made.NoPoints:
            continue
        out.append(replace(made.thinned(area, coefficients.POINTS), name=f"\0{area.name}"))
    return out


def _brightness(lit: Scene, surfaces: Sequence[Area], project: Project) -> NDArray[np.float64]:
    """Mean maintained illuminance of surfaces."""
    seed, factor = project.chosen.seed, project.chosen.maintenance
    return np.array([measure(lit, a, SURFACE_PATHS, seed + i).mean.value * factor for i, a in enumerate(surfaces)])


def _wanted(project: Project, lit: Scene) -> list[Area]:
    """The areas whose light decides something, with few points: evenly spread ones, and the darkest ones in the light
    of the photo's lamps, such as those behind furniture."""
    names = {r.area for r in project.requirements if r.quantity in OF_AREAS}
    chosen = [a for a in project.areas if a.name in names]
    return [dark_and_spread(lit, a, coefficients.POINTS, project.chosen.seed) for a in chosen]


def _below(project: Project) -> float:
    """Distance of the photo's lamps below the ceiling, in metres: the median over the lamps."""
    room = project.room
    gaps = [room.height - (lamp.position[1] - room.origin[1]) for lamp in project.luminaires if lamp.flux > 0]
    return max(0.005, float(np.median(gaps)))


def _mean_colour(luminaires: Sequence[Luminaire]) -> NDArray[np.float64]:
    """Colour of the light of all luminaires together, with a luminance of 1."""
    colours = np.array([lamp.colour for lamp in luminaires], float)
    luminance = colours @ likeness.TO_XYZ[1]
    flux = np.array([lamp.flux for lamp in luminaires])
    return (flux / flux.sum()) @ (colours / luminance[:, None])


def _nearest_colour(context, photo: NDArray, kelvin: tuple[float, float] | None) -> tuple[float, float, float]:
    """The colour of an offer that is nearest to the photo's."""
    if kelvin is None:
        r, g, b = (float(v) for v in photo)
        return r, g, b
    low, high = kelvin
    if not 0 < low <= high:
        raise ValueError(f"kelvin = {kelvin}: the lowest colour temperature must be above 0 and not above the highest")
    found, _ = colour_temperature(context, tuple(photo))
    return colour_of_temperature(context, min(max(found, low), high))
