"""The pattern of a photo's lamps on a ceiling, which can be scaled, turned and shifted.

Lamps in rows repeat along two vectors, the lattice; the lamps of one cell are the motif. Where the lamps repeat along
one vector only, or along none, the pattern as it fills the ceiling repeats as a whole. Lamps that the border of the
ceiling cuts count only if there are no others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .luminaires import Luminaire, Product
    from .rooms import Room

#: A lamp this close to the border of the ceiling may be cut by it, in metres. [convention]
BORDER = 0.05
#: A lamp at the border that has less than this share of the area of the largest lamp is cut. [convention]
WHOLE = 0.9
#: Two places are one if they differ by at most this share of the spacing. [convention]
SAME = 0.15
#: A vector belongs to the lattice if at least this share of the lamps have a neighbour at it. Only lamps count whose
#: neighbour would lie in the room. [convention]
REPEATS = 0.75
#: Smallest sine of the angle between the vectors of a lattice. [convention]
OPEN_ANGLE = 0.5
#: Cells of the lattice on each side of the middle that are looked at. [convention]
MAX_CELLS = 40


@dataclass(frozen=True)
class Placed:
    """Lamps of a pattern in the plan of a room."""

    places: NDArray[np.float64]
    """Middles (n, 2) in metres."""
    angles: NDArray[np.float64]
    """Angle of each long axis in the plan, in degrees in [0, 180)."""
    flux: NDArray[np.float64]
    """Relative flux of each lamp."""
    colours: NDArray[np.float64]
    """Linear colours (n, 3)."""
    sizes: NDArray[np.float64]
    """Length and width (n, 2) of the lamps in the photo, in metres."""

    def only(self, keep: NDArray) -> Placed:
        """Some of the lamps."""
        return Placed(*(v[keep] for v in (self.places, self.angles, self.flux, self.colours, self.sizes)))


@dataclass(frozen=True)
class Motif:
    """A pattern that repeats along two vectors."""

    anchor: NDArray[np.float64]
    """Corner of a cell in the plan, in metres."""
    lattice: NDArray[np.float64]
    """The two vectors, as columns."""
    cells: NDArray[np.float64]
    """Places of the lamps of a cell (n, 2) in shares of the two vectors."""
    lamps: Placed
    """These lamps in the plan."""
    regular: tuple[bool, bool]
    """Whether the lamps repeat along each vector; if not, it is as long as the room."""

    @property
    def spacing(self) -> float:
        """Side in metres of the square with the area that the pattern has for each lamp."""
        return math.sqrt(abs(float(np.linalg.det(self.lattice))) / len(self.cells))

    def placed(
        self, room: Room, scale: float = 1, turn: float = 0, offset: tuple[float, float] = (0, 0)
    ) -> Placed:
        """The lamps whose middles lie on the ceiling, if the pattern is shifted by shares of its two vectors, then
        scaled and turned about the middle of the ceiling; the turn is in degrees from along the room to across it."""
        middle = np.array([room.length, room.width]) / 2
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        moved = scale * np.array([[c, -s], [s, c]]) @ self.lattice
        cells = min(MAX_CELLS, 2 + math.ceil(math.hypot(room.length, room.width) / np.linalg.svd(moved)[1][-1]))
        steps = np.arange(-cells, cells + 1)
        grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 1, 2)
        shares = grid + self.cells[None] + np.asarray(offset) + np.linalg.solve(self.lattice, self.anchor - middle)
        places = middle + shares.reshape(-1, 2) @ moved.T
        which = np.tile(np.arange(len(self.cells)), len(grid))
        inside = ((places > 0) & (places < 2 * middle)).all(axis=1)
        lamps = self.lamps.only(which[inside])
        return Placed(places[inside], (lamps.angles + turn) % 180, lamps.flux, lamps.colours, lamps.sizes)


def find(room: Room, luminaires: Sequence[Luminaire]) -> Motif:
    """The pattern of luminaires on a ceiling."""
    lamps = whole(room, seen(room, luminaires))
    vectors = _repeats(room, lamps)
    first = vectors[0] if vectors else np.array([room.length, 0.0])
    across = np.array([-first[1], first[0]]) / np.linalg.norm(first)
    extent = float(abs(across) @ (room.length, room.width))
    second = vectors[1] if len(vectors) > 1 else across * extent
    lattice = np.stack([first, second], axis=1)
    shares = np.linalg.solve(lattice, lamps.places.T).T
    cells, groups = _cells(shares - shares[0])
    kinds = [
        Placed(
            lamps.places[g[:1]],
            lamps.angles[g[:1]],
            lamps.flux[g].mean(keepdims=True),
            lamps.colours[g].mean(axis=0, keepdims=True),
            lamps.sizes[g].mean(axis=0, keepdims=True),
        )
        for g in groups
    ]
    joined = Placed(*(np.concatenate([getattr(k, n) for k in kinds]) for n in Placed.__dataclass_fields__))
    return Motif(lamps.places[0], lattice, cells, joined, (len(vectors) > 0, len(vectors) > 1))


def seen(room: Room, luminaires: Sequence[Luminaire]) -> Placed:
    """Luminaires that shine, in the plan."""
    lit = [lamp for lamp in luminaires if lamp.flux > 0]
    if not lit:
        raise ValueError("no lamp of the photo shines: there is no pattern to keep")
    angles = [angle_of(room, lamp) for lamp in lit]
    sizes = [sorted((abs(v) for v in lamp.product.size[:2]), reverse=True) for lamp in lit]
    colours = np.array([lamp.colour for lamp in lit], float)
    flux = np.array([lamp.flux for lamp in lit])
    return Placed(room.plan([lamp.position for lamp in lit]), np.array(angles), flux, colours, np.array(sizes))


def angle_of(room: Room, lamp: Luminaire) -> float:
    """Angle of the long axis of a luminaire in the plan, in degrees in [0, 180)."""
    angle = math.degrees(math.atan2(float(np.dot(lamp.c0, room.across)), float(np.dot(lamp.c0, room.along))))
    return (angle + (90 if is_wide(lamp.product) else 0)) % 180


def is_wide(product: Product) -> bool:
    """Whether the opening of a product is longer across the plane C = 0 than along it."""
    return abs(product.size[1]) > abs(product.size[0]) * (1 + 1e-6)


def extents(angles: NDArray[np.float64], sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Half sides (n, 2) of the rectangles around lamps, along the room and across it."""
    c, s = np.abs(np.cos(np.radians(angles))), np.abs(np.sin(np.radians(angles)))
    length, width = sizes[:, 0], sizes[:, 1]
    return 0.5 * np.stack([c * length + s * width, s * length + c * width], axis=1)


def whole(room: Room, lamps: Placed) -> Placed:
    """The lamps that the border of the ceiling does not cut; all lamps if it cuts all."""
    half_sides = extents(lamps.angles, lamps.sizes)
    far = lamps.places + half_sides > np.array([room.length, room.width]) - BORDER
    at_border = (far | (lamps.places - half_sides < BORDER)).any(axis=1)
    area = lamps.sizes.prod(axis=1)
    cut = at_border & (area < WHOLE * area.max(initial=0))
    return lamps if cut.all() else lamps.only(~cut)


def _repeats(room: Room, lamps: Placed) -> list[NDArray[np.float64]]:
    """Up to two shortest vectors along which the lamps repeat."""
    places, box = lamps.places, np.array([room.length, room.width])
    found: list[tuple[float, NDArray[np.float64]]] = []
    for i in range(len(places)):
        for vector in places - places[i]:
            length = float(np.linalg.norm(vector))
            # One of the two opposite directions is enough.
            if length < 1e-6 or vector[0] < -1e-6 or (abs(vector[0]) <= 1e-6 and vector[1] < 0):
                continue
            refined = _matched(places, vector, box, SAME * length)
            if refined is not None:
                found.append((length, refined))
    out: list[NDArray[np.float64]] = []
    for _, vector in sorted(found, key=lambda f: (round(f[0], 3), tuple(np.round(f[1], 3)))):
        sine = abs(out[0][0] * vector[1] - out[0][1] * vector[0]) if out else math.inf
        if sine >= OPEN_ANGLE * (np.linalg.norm(out[0]) * np.linalg.norm(vector) if out else 1):
            out.append(vector)
        if len(out) == 2:
            break
    return out


def _matched(
    places: NDArray[np.float64], vector: NDArray[np.float64], box: NDArray[np.float64], tolerance: float
) -> NDArray[np.float64] | None:
    """The mean of the differences near a vector, if enough lamps have a neighbour there."""
    aims = places + vector
    distance = np.linalg.norm(aims[:, None] - places[None], axis=2)
    hit = distance.min(axis=1) <= tolerance
    inside = ((aims > 0) & (aims < box)).all(axis=1)
    if not hit.any() or hit.sum() < REPEATS * (inside | hit).sum():
        return None
    return (places[distance.argmin(axis=1)] - places)[hit].mean(axis=0)


def _cells(shares: NDArray[np.float64]) -> tuple[NDArray[np.float64], list[list[int]]]:
    """Lamps at one place of the cell, as lists of their numbers, and the places."""
    groups: list[list[int]] = []
    cells: list[NDArray[np.float64]] = []
    for index, share in enumerate(shares):
        for group, cell in zip(groups, cells):
            gap = share - cell
            if np.abs(gap - np.round(gap)).max() <= SAME:
                group.append(index)
                break
        else:
            groups.append([index])
            cells.append(share - np.floor(share + 1e-9))
    return np.array(cells), groups
