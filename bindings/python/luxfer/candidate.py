"""Objects and materials of a scene as candidates for the ceiling."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from . import _abi
from ._handle import Handle
from ._pointers import POINTER
from .types import Candidate, CandidateKind

if TYPE_CHECKING:
    from .scene import Scene


@dataclass(frozen=True)
class SurfaceCandidate:
    """An object or a material of a scene, and how much it resembles a ceiling.

    >>> best = room.candidates[0]
    >>> best.name, best.kind.name, round(best.height, 1)
    ('Ceiling', 'OBJECT', 2.8)
    """

    kind: CandidateKind
    """Whether the candidate is an object or a material."""
    name: str
    """Name of the candidate, by which a transfer finds the surface."""
    index: int
    """Index of the object's first mesh, or of the material."""
    triangles: int
    """Number of triangles with an area."""
    area: float
    """Area in m²."""
    level_area: float
    """Area in m² of the triangles that are inclined by less than 15 degrees."""
    height: float
    """Mean height in metres of these nearly horizontal triangles, or of all triangles if no triangle is nearly
    horizontal."""
    low: float
    """Lowest point, in metres."""
    high: float
    """Highest point, in metres."""
    normal: tuple[float, float, float]
    """Mean direction of the front sides by area; 0 if they cancel."""
    score: float
    """Resemblance to a ceiling, in [0, 1]."""
    reason: str
    """The reasons for the score, in words."""


class Candidates(Handle):
    """A list of candidates, owned by the library."""

    kind = "candidates"

    def read(self) -> list[SurfaceCandidate]:
        """Reads all candidates."""
        count = ctypes.c_uint32()
        self._call("get_count", count)
        return [self._at(index) for index in range(count.value)]

    def _at(self, index: int) -> SurfaceCandidate:
        c = cast(Candidate, self._read("get", _abi.luxfer_candidate, index))
        return SurfaceCandidate(
            kind=CandidateKind(c.kind),
            name=c.name,
            index=c.index,
            triangles=c.triangles,
            area=c.area,
            level_area=c.level_area,
            height=c.height,
            low=c.low,
            high=c.high,
            normal=(c.normal[0], c.normal[1], c.normal[2]),
            score=c.score,
            reason=c.reason,
        )


def candidates_of(scene: Scene) -> list[SurfaceCandidate]:
    """The candidates of a scene."""
    pointer = POINTER(_abi.luxfer_candidates)()
    scene._call("get_candidates", pointer)
    with Candidates._adopt(scene.context, pointer) as candidates:
        return candidates.read()
