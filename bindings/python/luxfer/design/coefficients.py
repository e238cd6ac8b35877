"""Light by a luminaire wherever it may hang: coefficients on a grid of places under the ceiling, interpolated between
them.

One scene holds each product in each direction at each place of the grid, and one set of paths for each point measures
the light from all of these luminaires. Every pattern of luminaires is then a sum, and thousands can be compared without
tracing anything anew. Interpolation makes single points a few per cent uncertain, so a pattern that is chosen by these
numbers must be checked by its own paths (arrange.py does).

The glare of an observer has no smooth coefficients: its direct part follows from the intensities towards the eye in
closed form, for an opening that is small beside its distance and that nothing hides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..photometry import Distribution
from .areas import Area, Patch
from .constraints import Model
from .luminaires import Luminaire, Product
from .motif import extents, is_wide
from .responses import GlareResponse, Response, all_on, glare_parts, respond_lit

if TYPE_CHECKING:
    from .motif import Placed
    from .observers import Observers
    from .rooms import Room

#: Spacing of the places in metres, and maximum number of them along a side. [convention]
SPACING, MAX_PLACES = 0.5, 16
#: Points of an area at which its light is measured. [convention]
POINTS = 16
#: Paths for each eye: the light that is not direct is a difference, and so needs more of them. [convention]
EYE_PATHS = 1 << 15
#: Steps in degrees of the tables of intensities, around the axis and from it. [convention]
STEP_C, STEP_GAMMA = 10.0, 2.5
#: Relative difference of intensities below which a distribution is the same all around. [rounding]
ROUND = 1e-3
#: Smallest share of an eye's illuminance that is not direct, so that noise leaves the background above 0. [convention]
INDIRECT = 0.02


@dataclass(frozen=True)
class Kind:
    """A product in the form that patterns use."""

    product: Product
    colour: tuple[float, float, float]
    """Linear colour of its light."""
    sides: NDArray[np.float64]
    """Length and width of its opening in metres."""
    intensities: NDArray[np.float64]
    """Candela (around the axis, from the axis) at full power."""

    @cached_property
    def is_round(self) -> bool:
        """Whether a turn about the axis changes nothing."""
        same = np.ptp(self.intensities, axis=0).max() <= ROUND * max(float(self.intensities.max()), 1e-300)
        return bool(same) and abs(self.sides[0] - self.sides[1]) <= 0.01 * self.sides[0]

    def like(self, other: Kind) -> bool:
        """Whether the light of both differs by a factor only."""
        one, two = self.intensities / self.product.flux, other.intensities / other.product.flux
        same = one.shape == two.shape and np.abs(one - two).max() <= ROUND * one.max()
        return bool(same) and self.is_round == other.is_round and np.allclose(self.colour, other.colour)

    def key(self, angle: float) -> int:
        """The direction, in whole degrees, whose coefficients hold for an angle of the long axis."""
        return 0 if self.is_round else round(angle) % 180

    def towards(self, c: NDArray[np.float64], gamma: NDArray[np.float64]) -> NDArray[np.float64]:
        """Intensity in candela, interpolated."""
        x, y = (c % 360) / STEP_C, np.clip(gamma, 0, 180 - 1e-9) / STEP_GAMMA
        i, j = x.astype(int), y.astype(int)
        u, v, n = x - i, y - j, len(self.intensities)
        low, high = self.intensities[i % n], self.intensities[(i + 1) % n]
        take = lambda rows, k: np.take_along_axis(rows, k[..., None], -1)[..., 0]  # noqa: E731
        a, b = ((1 - u) * take(low, k) + u * take(high, k) for k in (j, j + 1))
        return (1 - v) * a + v * b


def kind(room: Room, product: Product, colour: tuple[float, float, float]) -> Kind:
    """A product with its table of intensities."""
    sides = np.array(sorted((abs(v) for v in product.size[:2]), reverse=True))
    with Distribution.load_memory(room.scene.context, product.photometry, product.format) as found:
        around, down = np.arange(0, 360, STEP_C), np.arange(0, 180 + STEP_GAMMA, STEP_GAMMA)
        table = np.array([[found.intensity(float(c), float(g)) for g in down] for c in around])
        return Kind(product, colour, sides, table * product.flux / found.report.flux)


def axis_of(room: Room, one: Kind, angle: float) -> NDArray[np.float64]:
    """The direction C = 0 of a product whose long axis has an angle in the plan."""
    t = math.radians(angle - (90 if is_wide(one.product) else 0))
    return math.cos(t) * room.along + math.sin(t) * room.across


def hung(room: Room, one: Kind, place: Sequence[float], angle: float, below: float, dimmer: float = 1) -> Luminaire:
    """A luminaire under the ceiling."""
    x, y, z = (float(v) for v in room.world([place], room.height - below)[0])
    c0 = axis_of(room, one, angle)
    return Luminaire(one.product, (x, y, z), dimmer, c0=(float(c0[0]), float(c0[1]), float(c0[2])), colour=one.colour)


@dataclass(frozen=True)
class Grid:
    """Places along both sides of the ceiling at which a product in a direction was measured."""

    along: NDArray[np.float64]
    across: NDArray[np.float64]
    first: int
    """Column of the first place among all luminaires of the scene."""
    measured: int
    """Number of the kind whose luminaires hang there."""

    @property
    def columns(self) -> slice:
        """The columns of its places."""
        return slice(self.first, self.first + len(self.along) * len(self.across))

    def weights(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Weights (places of the grid, n) by which the luminaires of the grid stand for luminaires at n places."""
        along, across = _cubic(self.along, places[:, 0]), _cubic(self.across, places[:, 1])
        return (along[:, None] * across[None]).reshape(-1, len(places))


def _cubic(values: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights (values, x) of cubic interpolation between evenly spaced values (Catmull and Rom 1974); beyond the first
    and the last one, the function continues straight."""
    count = len(values)
    if count == 1:
        return np.ones((1, len(x)))
    i = np.clip(np.searchsorted(values, x) - 1, 0, count - 2)
    u = np.clip((x - values[i]) / (values[i + 1] - values[i]), 0, 1)
    first, second = 1 - u * u * (2.5 - 1.5 * u), 1 - (1 - u) ** 2 * (1 + 1.5 * u)
    # One more value on each side; where the function continues straight, it is f(-1) = 2 f(0) - f(1).
    out = np.zeros((count + 2, len(x)))
    for step, weight in enumerate((u * (1 - u) ** 2 / -2, first, second, u * u * (1 - u) / -2)):
        out[i + step, np.arange(len(x))] = weight
    out[1] += 2 * out[0]
    out[2] -= out[0]
    out[-2] += 2 * out[-1]
    out[-3] -= out[-1]
    return out[1:-1]


@dataclass(frozen=True)
class Coefficients:
    """Light at points of areas and at eyes, by luminaires at the places of grids."""

    room: Room
    kinds: Sequence[Kind]
    grids: dict[tuple[int, int], Grid]
    """By number of the kind and its direction."""
    responses: dict[str, Response]
    """By the names of areas."""
    veils: dict[str, NDArray[np.float64]]
    """Luminance of the background (eyes, luminaires), by the names of observers."""
    others: dict[str, NDArray[np.float64]]
    """Glare sources and background of the room without luminaires (2, eyes), by the names of observers."""
    observers: Sequence[Observers]
    below: float
    maintenance: float

    def model(self, number: int, lamps: Placed) -> Model:
        """The responses with which requirements are evaluated, for a pattern of one kind of luminaire."""
        one, parts = self.kinds[number], self._parts(number, lamps)
        luminaires = [
            hung(self.room, one, (float(p[0]), float(p[1])), float(a), self.below)
            for p, a in zip(lamps.places, lamps.angles)
        ]
        responses = {n: replace(r, matrix=_mixed(r.matrix, parts)) for n, r in self.responses.items()}
        glare = {
            o.name: GlareResponse(
                o, _sources(self.room, one, luminaires, o)[0], _mixed(self.veils[o.name], parts), *self.others[o.name]
            )
            for o in self.observers
        }
        return Model(luminaires, responses, glare, self.maintenance, self.room.floor_area)

    def means(self, number: int, lamps: Placed) -> dict[str, NDArray[np.float64]]:
        """The mean illuminance of each area by each luminaire at full power."""
        if not self.responses:
            return {}
        return dict(zip(self.responses, _mixed(self._means, self._parts(number, lamps))))

    @cached_property
    def _means(self) -> NDArray[np.float64]:
        """The mean illuminance (areas, luminaires) by the luminaires at the places of the grids."""
        return np.array([r.area.weights @ r.matrix for r in self.responses.values()])

    def _parts(self, number: int, lamps: Placed) -> list[_Part]:
        """The luminaires of a pattern by their directions, as sums of those of the grids."""
        one = self.kinds[number]
        keys, out = np.array([one.key(float(a)) for a in lamps.angles]), []
        for key in dict.fromkeys(keys.tolist()):
            grid, which = self.grids[number, key], keys == key
            share = one.product.flux / self.kinds[grid.measured].product.flux
            out.append((which, grid.columns, share * grid.weights(lamps.places[which])))
        return out


#: Which luminaires of a pattern, the columns of a grid, and their weights (columns, luminaires).
_Part = tuple[NDArray[np.bool_], slice, NDArray[np.float64]]


def _mixed(matrix: NDArray[np.float64], parts: Sequence[_Part]) -> NDArray[np.float64]:
    """The columns of a matrix of the luminaires of grids, mixed for the luminaires of a pattern."""
    out = np.zeros((len(matrix), len(parts[0][0])))
    for which, columns, weights in parts:
        out[:, which] = matrix[:, columns] @ weights
    return out


def measure(
    room: Room,
    kinds: Sequence[Kind],
    angles: Sequence[Sequence[float]],
    areas: Sequence[Area],
    observers: Sequence[Observers],
    below: float,
    maintenance: float,
    seed: int,
    paths: int = 1024,
) -> Coefficients:
    """Measures the coefficients of each kind in its directions. Kinds whose light differs by a factor only share the
    places of the smallest one."""
    grids: dict[tuple[int, int], Grid] = {}
    luminaires: list[Luminaire] = []
    for number in sorted(range(len(kinds)), key=lambda n: kinds[n].sides.prod()):
        one = kinds[number]
        for key in dict.fromkeys(one.key(a) for a in angles[number]):
            known = [g for (n, k), g in grids.items() if k == key and one.like(kinds[n])]
            if known:
                grids[number, key] = known[0]
                continue
            half = extents(np.array([float(key)]), one.sides[None])[0]
            along, across = (_places(side, h) for side, h in zip((room.length, room.width), half))
            grids[number, key] = Grid(along, across, len(luminaires), number)
            luminaires += [hung(room, one, (a, b), key, below) for a in along for b in across]
    eyes = [_eyes(o) for o in observers]
    # Without bodies: openings at all places of the grid would cover the ceiling.
    lit = all_on(room.scene, luminaires, "point")
    responses = {a.name: respond_lit(lit, len(luminaires), a, paths, seed + i) for i, a in enumerate(areas)}
    light = [respond_lit(lit, len(luminaires), e, EYE_PATHS, seed + 1 + i) for i, e in enumerate(eyes)]
    veils = {}
    for o, seen in zip(observers, light):
        direct = np.zeros_like(seen.matrix)
        for grid in {g.first: g for g in grids.values()}.values():
            direct[:, grid.columns] = _sources(room, kinds[grid.measured], luminaires[grid.columns], o)[1]
        rest = np.maximum(seen.matrix - direct, INDIRECT * seen.matrix)
        veils[o.name] = np.maximum(rest, 1e-9) / math.pi
    others = {o.name: glare_parts(room.scene, o.positions, _views(o), seed + 2) for o in observers}
    return Coefficients(room, kinds, grids, responses, veils, others, observers, below, maintenance)


def _places(side: float, half: float) -> NDArray[np.float64]:
    """Places along a side at which an opening of that half length fits; the middle if it does not."""
    if side <= 2 * half:
        return np.array([side / 2])
    count = min(MAX_PLACES, max(2, 1 + math.ceil((side - 2 * half) / SPACING)))
    return np.linspace(half, side - half, count)


def _eyes(observers: Observers) -> Area:
    """The eyes of observers as points with vertical planes."""
    side = 1e-3 * np.array([0.0, 1.0, 0.0])
    patches = []
    for eye, view in zip(observers.positions, _views(observers)):
        level = 1e-3 * np.cross(side / 1e-3, view)
        corner = eye - 0.5 * (side + level)
        patches.append(Patch(corner, level, side, np.asarray(view, float), 1, 1, np.ones((1, 1), bool)))
    return Area(f"\0{observers.name}", "eyes", tuple(patches), 0.0, ())


def _views(observers: Observers) -> NDArray[np.float64]:
    """Unit vectors along which observers look."""
    return observers.directions / np.linalg.norm(observers.directions, axis=1, keepdims=True)


def _sources(
    room: Room, one: Kind, luminaires: Sequence[Luminaire], observers: Observers
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """L² ω / p² and direct illuminance in lux (observers, luminaires) at full power, in closed form."""
    places = np.array([lamp.position for lamp in luminaires])
    firsts = np.array([lamp.c0 for lamp in luminaires])
    to_lamp = places[None] - observers.positions[:, None]
    distance = np.linalg.norm(to_lamp, axis=2)
    to_lamp = to_lamp / distance[..., None]
    down = np.clip(to_lamp[..., 1], 0, 1)  # cosine at the luminaire, which shines down
    # C grows anticlockwise as seen from above, so C = 90 lies along up × c0.
    seconds = np.cross([0.0, 1.0, 0.0], firsts)
    c = np.degrees(np.arctan2(-(to_lamp * seconds).sum(axis=2), -(to_lamp * firsts).sum(axis=2)))
    candela = one.towards(c, np.degrees(np.arccos(down)))
    ahead = np.einsum("eld,ed->el", to_lamp, _views(observers))
    direct = candela * np.maximum(ahead, 0) / distance**2
    area = float(one.sides.prod())
    if area <= 0:
        return np.zeros_like(direct), direct
    seen = (ahead > 0) & (down > 1e-3)
    index = position_index(np.clip(ahead, 1e-6, 1), to_lamp[..., 1])
    # L = I / (A cos), ω = A cos / d².
    glare = candela**2 / (area * np.maximum(down, 1e-3) * distance**2 * index**2)
    return np.where(seen, glare, 0.0), direct


def position_index(ahead: NDArray[np.float64], above: NDArray[np.float64]) -> NDArray[np.float64]:
    """Guth's position index for sources above a level line of sight, whose unit vectors have these components along it
    and upwards. [convention: CIE 117]"""
    sigma = np.degrees(np.arccos(ahead))
    sine = np.sqrt(np.maximum(1 - ahead**2, 1e-12))
    tau = np.degrees(np.arccos(np.clip(above / sine, -1, 1)))
    first = (35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)) * 1e-3 * sigma
    return np.exp(first + (21 + 0.26667 * tau - 0.002963 * tau**2) * 1e-5 * sigma**2)
