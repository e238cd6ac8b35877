"""Candidates of a design: the pattern of a photo's lamps with a product, scaled, turned and shifted."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import likeness, motif

if TYPE_CHECKING:
    from .coefficients import Kind
    from .motif import Motif, Placed
    from .rooms import Room


@dataclass(frozen=True)
class Search:
    """The allowed changes of the pattern."""

    scales: tuple[float, ...] = (0.5, 0.56, 0.63, 0.71, 0.79, 0.89, 1.0, 1.12, 1.26, 1.41, 1.59, 1.78, 2.0)
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
    """Cost of the look (likeness.py) that no dimmers can reduce."""


class Patterns:
    """Makes the candidates of a room. Products with equal openings share their layouts."""

    def __init__(
        self, room: Room, found: Motif, search: Search, kinds: Sequence[Kind], colours: Sequence[float]
    ) -> None:
        self._room, self._motif, self._search = room, found, search
        self._kinds, self._colours = kinds, colours
        self._ceiling = room.length * room.width
        self._photo = likeness.statistics(found.placed(room), self._ceiling)
        self._known: dict[tuple, tuple[Placed, float] | None] = {}

    def all(self, scales: Sequence[float | None]) -> list[Candidate]:
        """All patterns of the search, in the order of the closeness to the look that they can reach. `scales` holds the
        only scale of each kind; None: any."""
        search, out = self._search, []
        offsets = [(u, v) for u in search.offsets for v in search.offsets]
        for number, only in enumerate(scales):
            for scale, turn, offset in itertools.product(search.scales, search.turns, offsets):
                one = self.made(number, scale, turn, offset) if only in (None, scale) else None
                if one is not None:
                    out.append(one)
        return sorted(out, key=lambda c: c.bound)

    def made(self, number: int, scale: float, turn: float, offset: tuple[float, float]) -> Candidate | None:
        """A pattern of a kind of luminaires; None if no lamp fits, or if too many lamps fit."""
        sides = self._kinds[number].sides
        key = (scale, turn, offset, *np.round(sides, 6))
        if key not in self._known:
            self._known[key] = self._laid_out(sides, scale, turn, offset)
        known = self._known[key]
        if known is None:
            return None
        lamps, change = known
        bound = math.hypot(change, likeness.moved(scale, turn, offset, self._colours[number]))
        return Candidate(number, scale, turn, offset, lamps, change, bound + likeness.excess(change))

    def _laid_out(
        self, sides: NDArray[np.float64], scale: float, turn: float, offset: tuple[float, float]
    ) -> tuple[Placed, float] | None:
        """The lamps that fit on the ceiling outside the keep-out rectangles, and the change of the statistics."""
        room, search = self._room, self._search
        lamps = self._motif.placed(room, scale, turn, offset)
        lamps = replace(lamps, sizes=np.tile(sides, (len(lamps.places), 1)))
        half = motif.extents(lamps.angles, lamps.sizes)
        low, high = lamps.places - half, lamps.places + half
        fits = ((low >= -1e-9) & (high <= np.array([room.length, room.width]) + 1e-9)).all(axis=1)
        for a0, b0, a1, b1 in search.keep_out:
            fits &= ~((high > (a0, b0)) & (low < (a1, b1))).all(axis=1)
        lamps = lamps.only(fits)
        if not 1 <= len(lamps.places) <= search.max_lamps:
            return None
        return lamps, likeness.pattern_distance(self._photo, likeness.statistics(lamps, self._ceiling))
