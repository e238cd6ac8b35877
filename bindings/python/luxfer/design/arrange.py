"""Finds places, product and dimmers of luminaires together: the design that stays closest to a photo's look and meets
all requirements.

1. Find the pattern of the photo's lamps (motif.py), and make candidates: each product, with the pattern scaled, turned
   and shifted. Lamps that do not fit on the ceiling, or lie in a keep-out rectangle, are left out.
2. Measure coefficients once (coefficients.py). With them, find the dimmers of each candidate that meet the
   requirements. Candidates are tried in the order of the distance that they have with the best dimmers without
   requirements; the search ends when no remaining candidate can be closer. Candidates that are too dark at full power
   are left out first.
3. Improve scale and offset of the closest candidates by small steps.
4. Solve for the dimmers of the closest candidate anew with its own paths, and check it with others (solve.py). If it
   does not pass, the next one is tried.

Only the paths are random, and their seeds are fixed: equal input gives an equal design.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..photometry import colour_of_temperature, colour_temperature
from . import areas as made
from . import coefficients, likeness, motif
from .explain import Relaxation, relaxations
from .likeness import Likeness
from .look import distance, objective
from .luminaires import dimmed
from .measure import dark_and_spread, measure
from .motif import Motif, Placed
from .solve import SEED_OFFSET, Solution, Wishes, first_margins, nearest, solve, start_of
from .standard import OF_AREAS

if TYPE_CHECKING:
    from ..scene import Scene
    from .areas import Area
    from .coefficients import Coefficients, Kind
    from .constraints import Model
    from .luminaires import Luminaire, Product
    from .project import Project
    from .rooms import Room
    from .standard import Requirement

#: Margins of the first choice in addition to the margins of the solution, as a share of the limit and in units of UGR,
#: because interpolated coefficients are uncertain. [convention]
MARGIN, GLARE_MARGIN = 0.01, 0.4
#: First step of the scale as a factor, and of the offset in shares of the lattice; each round halves them.
#: [convention]
SCALE_STEP, OFFSET_STEP, ROUNDS = 1.1, 0.125, 3
#: Smallest decrease of the total distance by a step, about the error of the coefficients. [convention]
MIN_GAIN = 0.003
#: Number of candidates that miss the requirements by the least and for which relaxed requirements are tried.
#: [convention]
EXPLAINED = 3
#: A requirement changes the look if the total distance without it is smaller by more than this. [convention]
PRICE = 0.002
#: Points of each area that measure the responses of the final dimmers, paths for each point that measure the surfaces.
#: [convention]
FINAL_POINTS, SURFACE_PATHS = 32, 256


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
class Search:
    """The allowed changes of the pattern."""

    scales: tuple[float, ...] = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.12, 1.25, 1.4, 1.6, 1.8, 2.0)
    """Factors of its size that are tried first."""
    turns: tuple[float, ...] = (0.0, 90.0)
    """Turns in degrees."""
    offsets: tuple[float, ...] = (0.0, 0.25, 0.5, 0.75)
    """Shifts along both vectors of the pattern, as shares of them, that are tried first."""
    max_lamps: int = 80
    """Largest number of luminaires."""
    keep_out: tuple[tuple[float, float, float, float], ...] = ()
    """Rectangles of the plan in metres, a0, b0, a1, b1, in which no luminaire may hang."""
    tries: int = 400
    """Largest number of candidates whose dimmers are solved for."""
    finalists: int = 3
    """Largest number of candidates that are solved for and checked with their own paths."""


@dataclass(frozen=True)
class Candidate:
    """A pattern with a product."""

    offer: int
    scale: float
    turn: float
    offset: tuple[float, float]
    lamps: Placed = field(repr=False)
    pattern: float
    """Change of the statistics of the pattern."""
    bound: float
    """Distance of the look that no dimmers can reduce."""


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
    """Number of patterns whose dimmers were solved for."""
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
    kinds: Sequence[Kind]
    table: Coefficients
    motif: Motif
    pattern: NDArray[np.float64]
    """Statistics of the photo's pattern."""
    surfaces: Sequence[Area]
    copy: NDArray[np.float64]
    """Illuminance of the surfaces by the photo's lamps, by coefficients or paths."""
    flux: float
    """Flux of the photo's lamps."""
    colours: Sequence[float]
    """Colour difference of each offer."""


def arrange(
    project: Project, offers: Sequence[Offer | Product], wishes: Wishes = Wishes(), search: Search = Search()
) -> Arrangement:
    """The design closest to the look of the project's luminaires, which are the photo's lamps (see from_transfer)."""
    chosen = [o if isinstance(o, Offer) else Offer(o) for o in offers]
    if not chosen:
        raise ValueError("there is no product to design with: offers is empty")
    wishes = replace(wishes, points=wishes.points or FINAL_POINTS)
    found = motif.find(project.room, project.luminaires)
    candidates, kinds, colours = _candidates(project, chosen, search, found)
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
    table = coefficients.measure(
        project.room, kinds, angles, wanted, eyes, below, project.chosen.maintenance, seed
    )
    flux = sum(lamp.flux for lamp in project.luminaires)
    pattern = _statistics(project.room, found)
    task = _Task(project, chosen, search, wishes, kinds, table, found, pattern, surfaces, copy, flux, colours)
    return _best(task, candidates)


def _candidates(
    project: Project, offers: Sequence[Offer], search: Search, found: Motif
) -> tuple[list[Candidate], list[Kind], list[float]]:
    """All patterns, in the order of the closeness to the look that they can reach; the kinds of luminaires, and their
    colours."""
    room, context = project.room, project.room.scene.context
    photo = _mean_colour(project.luminaires)
    kinds, colours = [], []
    for offer in offers:
        light = _nearest_colour(context, photo, offer.kelvin)
        kinds.append(coefficients.kind(room, offer.product, light))
        colours.append(likeness.colour_difference(photo, np.array(light)))
    before = _statistics(room, found)
    out = []
    for number, (scale, turn) in itertools.product(range(len(offers)), itertools.product(search.scales, search.turns)):
        if offers[number].scale not in (None, scale):
            continue
        for offset in itertools.product(search.offsets, repeat=2):
            made_one = _candidate(
                project, found, before, search, kinds[number], number, scale, turn, offset, colours[number]
            )
            if made_one is not None:
                out.append(made_one)
    return sorted(out, key=lambda c: c.bound), kinds, colours


def _statistics(room: Room, found: Motif) -> NDArray[np.float64]:
    """Statistics of the photo's pattern on the ceiling."""
    return likeness.statistics(found.placed(room), room.length * room.width)


def _candidate(
    project: Project,
    found: Motif,
    before: NDArray[np.float64],
    search: Search,
    one: Kind,
    number: int,
    scale: float,
    turn: float,
    offset: tuple[float, float],
    colour: float,
) -> Candidate | None:
    """A pattern of a product, compared with the statistics before; None if no lamp fits, or if too many lamps fit."""
    room, ceiling = project.room, project.room.length * project.room.width
    lamps = found.placed(room, scale, turn, offset)
    lamps = replace(lamps, sizes=np.tile(one.sides, (len(lamps.places), 1)))
    half = motif.extents(lamps.angles, lamps.sizes)
    low, high = lamps.places - half, lamps.places + half
    fits = ((low >= -1e-9) & (high <= np.array([room.length, room.width]) + 1e-9)).all(axis=1)
    for a0, b0, a1, b1 in search.keep_out:
        fits &= ~((high > (a0, b0)) & (low < (a1, b1))).all(axis=1)
    lamps = lamps.only(fits)
    if not 1 <= len(lamps.places) <= search.max_lamps:
        return None
    change = likeness.pattern_distance(before, likeness.statistics(lamps, ceiling))
    bound = math.hypot(change, likeness.moved(scale, turn, offset, colour))
    return Candidate(number, scale, turn, offset, lamps, change, bound)


def _best(task: _Task, candidates: Sequence[Candidate]) -> Arrangement:
    """Searches the candidates, and checks the closest ones."""
    margins = _margins(task.project.requirements, task.wishes.reserve)
    met: list[tuple[float, Candidate]] = []
    missed: list[tuple[float, Candidate]] = []
    solved = 0
    # For each candidate: a lower bound of its distance, whether this is the distance with the best dimmers, its number.
    queue = [(c.bound, False, number) for number, c in enumerate(candidates)]
    heapq.heapify(queue)
    while queue and solved < task.search.tries:
        least, with_dimmers, number = heapq.heappop(queue)
        worst = sorted(d for d, _ in met)[: task.search.finalists]
        if len(worst) == task.search.finalists and least >= worst[-1]:
            break
        candidate = candidates[number]
        model = task.table.model(candidate.offer, candidate.lamps)
        if not with_dimmers:
            if (dark := _darkness(task, model, margins)) > 0:
                missed.append((dark, candidate))
            else:
                heapq.heappush(queue, (max(least, _unlimited(task, candidate, model)), True, number))
            continue
        solved += 1
        total, violation = _rated(task, candidate, margins, model)
        (missed if total is None else met).append((violation if total is None else total, candidate))
    count = len(met) + len(missed)
    met.sort(key=lambda m: m[0])
    missed.sort(key=lambda m: m[0])
    if not met:
        return _failed(task, missed, margins, count)
    better = [_refined(task, one, margins) for one in met[: task.search.finalists]]
    final = None
    for _, candidate in sorted(better, key=lambda m: m[0]):
        solution = _solved(task, candidate)
        found = _result(task, candidate, solution, count, len(met))
        final = found if final is None or (found.feasible and not final.feasible) else final
        if found.feasible:
            return replace(found, prices=tuple(_prices(task, candidate, margins)))
    assert final is not None
    return replace(final, relaxations=final.solution.relaxations)


def _unlimited(task: _Task, candidate: Candidate, model: Model) -> float:
    """The total distance of a candidate with the dimmers that would be best without requirements."""
    photo, rows, hessian, gradient = _aim(task, candidate, model)
    dimmers = np.clip(np.linalg.solve(hessian, -gradient)[:-1], 0, task.wishes.max_dimmer)
    return _likeness(task, candidate, photo, dimmers, task.copy * (rows @ dimmers)).total


def _darkness(task: _Task, model: Model, margins: dict[Requirement, float]) -> float:
    """The share by which a candidate misses a mean illuminance with all lamps at their highest dimmers; 0 if it reaches
    all means. This excludes most patterns of too few lamps without solving for their dimmers."""
    full = np.full(len(model.luminaires), task.wishes.max_dimmer)
    wanted = [(r.at_least * (1 + m), r) for r, m in margins.items() if r.quantity == "mean" and r.is_minimum]
    return max([0.0, *(1 - model.value(r, full) / limit for limit, r in wanted if limit > 0)])


def _margins(requirements: Sequence[Requirement], reserve: float) -> dict[Requirement, float]:
    """Margins for coefficients that are interpolated."""
    more = {"glare": GLARE_MARGIN, "density": 0.0, "flux": 0.0}
    return {r: m + more.get(r.quantity, MARGIN) for r, m in first_margins(requirements, reserve).items()}


def _aim(task: _Task, candidate: Candidate, model: Model) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Wanted dimmers, brightness of the surfaces by each lamp as shares of the copy's, and the aim of the dimmers."""
    product = task.offers[candidate.offer].product
    photo = task.flux * candidate.lamps.flux / candidate.lamps.flux.sum() / product.flux
    responses = [model.responses[a.name] for a in task.surfaces]
    rows = np.array([task.table.maintenance * (r.area.weights @ r.matrix) for r in responses])
    rows = rows / task.copy[:, None]
    hessian, gradient = objective(photo, np.full(len(photo), product.flux), rows if len(rows) else None)
    return photo, rows, hessian, gradient


def _rated(
    task: _Task, candidate: Candidate, margins: dict[Requirement, float], model: Model | None = None
) -> tuple[float | None, float]:
    """The total distance of a candidate by the coefficients, or None, and the share by which it misses requirements."""
    model = model or task.table.model(candidate.offer, candidate.lamps)
    photo, rows, hessian, gradient = _aim(task, candidate, model)
    coarse = replace(task.wishes, levels=())
    dimmers, violation = nearest(model, margins, (hessian, gradient), np.eye(len(photo)), coarse)
    if dimmers is None:
        return None, violation
    return _likeness(task, candidate, photo, dimmers, task.copy * (rows @ dimmers)).total, violation


def _likeness(
    task: _Task, candidate: Candidate, photo: NDArray, dimmers: NDArray, surfaces: NDArray
) -> Likeness:
    """The distance of a candidate with dimmers and its light on the surfaces."""
    change = distance(photo, dimmers, np.ones(len(photo)))
    light = np.array(task.kinds[candidate.offer].colour)
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


def _refined(
    task: _Task, start: tuple[float, Candidate], margins: dict[Requirement, float]
) -> tuple[float, Candidate]:
    """A candidate that is at least as close as the given one, found near it by steps of scale and offset that are
    halved."""
    best, now = start
    for turn in range(ROUNDS):
        factor, step = SCALE_STEP ** (0.5**turn), OFFSET_STEP * 0.5**turn
        u, v = now.offset
        moves = [(now.scale * f, (u, v)) for f in (1 / factor, factor)]
        moves += [(now.scale, (u + a, v + b)) for a, b in ((-step, 0), (step, 0), (0, -step), (0, step))]
        for scale, offset in moves:
            kind, colour = task.kinds[now.offer], task.colours[now.offer]
            one = _candidate(
                task.project, task.motif, task.pattern, task.search, kind, now.offer, scale, now.turn, offset, colour
            )
            if one is None or one.bound >= best - MIN_GAIN:
                continue
            total, _ = _rated(task, one, margins)
            if total is not None and total < best - MIN_GAIN:
                best, now = total, one
    return best, now


def _solved(task: _Task, candidate: Candidate) -> Solution:
    """The dimmers of a candidate by its own paths, checked."""
    model = task.table.model(candidate.offer, candidate.lamps)
    photo, rows, _, _ = _aim(task, candidate, model)
    project, below = task.project, task.table.below
    kind, placed = task.kinds[candidate.offer], zip(candidate.lamps.places, candidate.lamps.angles)
    hung = [coefficients.hung(project.room, kind, place, float(angle), below) for place, angle in placed]
    lamps = dimmed(hung, photo.tolist())
    return solve(
        project.room.scene,
        lamps,
        project.requirements,
        project.areas,
        project.observers,
        floor_area=project.room.floor_area,
        settings=project.chosen,
        wishes=task.wishes,
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


def _failed(
    task: _Task, missed: Sequence[tuple[float, Candidate]], margins: dict[Requirement, float], tried: int
) -> Arrangement:
    """The candidate that misses the requirements by the least share, and the result of relaxing each requirement
    alone."""
    best: dict[Requirement, Relaxation] = {}
    for _, candidate in missed[:EXPLAINED]:
        model = task.table.model(candidate.offer, candidate.lamps)
        groups = np.eye(len(candidate.lamps.places))
        hard, start = start_of(groups, replace(task.wishes, levels=()))
        _, eased = relaxations(model, list(margins), groups, hard, start)
        for one in eased:
            r, known = one.requirement, best.get(one.requirement)
            nearer = known is None or (one.attainable - known.attainable) * (1 if r.is_minimum else -1) > 0
            best[r] = one if nearer else known
    candidate = missed[0][1]
    found = _result(task, candidate, _solved(task, candidate), tried, 0)
    return replace(found, relaxations=tuple(best[r] for r in margins if r in best))


def _prices(
    task: _Task, candidate: Candidate, margins: dict[Requirement, float]
) -> list[tuple[Requirement, float]]:
    """The decrease of a candidate's total distance without each requirement, by the coefficients; the largest first."""
    whole, _ = _rated(task, candidate, margins)
    out = []
    for r in margins:
        total, _ = _rated(task, candidate, {k: m for k, m in margins.items() if k is not r})
        if whole is not None and total is not None and whole - total > PRICE:
            out.append((r, whole - total))
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
