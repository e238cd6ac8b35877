"""The room of a scene: its floor as a rectangle, its height, and which points lie free in it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import Error

if TYPE_CHECKING:
    from ..candidate import SurfaceCandidate
    from ..scene import Scene
    from ..types import Surface

#: A floor lies at least this much below the ceiling, in metres. [convention]
MIN_HEIGHT = 1.5
#: Smallest score of a candidate for the ceiling that is taken without being named; real rooms have 0.9 and more.
#: [convention]
MIN_SCORE = 0.2
#: A floor has at least this share of the ceiling's level area. [convention]
MIN_FLOOR_SHARE = 0.3
#: Rays that look for a surface around a point reach this far, in metres. [convention]
MAX_SOLID_DISTANCE = 0.5
UP = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Room:
    """A room with a rectangular floor. Its plan has the coordinates (a, b): metres along the unit vectors `along` and
    `across` from the corner `origin`. In a room that is aligned with the axes these are x and z."""

    scene: Scene
    floor: str
    """Name of the object or material that is the floor."""
    ceiling: str
    """Name of the object or material that is the ceiling."""
    origin: NDArray[np.float64]
    """Corner of the floor, in metres."""
    along: NDArray[np.float64]
    """Unit vector of a."""
    across: NDArray[np.float64]
    """Unit vector of b."""
    length: float
    """Length of the floor along a, in metres."""
    width: float
    """Length of the floor along b, in metres."""
    height: float
    """Height of the ceiling above the floor, in metres."""
    floor_area: float
    """Area of the floor's surface in m²."""
    _normals: dict[int, NDArray[np.float64]] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def find(cls, scene: Scene, floor: str | None = None, ceiling: str | None = None) -> Room:
        """Finds the room of a scene by its floor and ceiling, given by name or by their form.

        >>> from luxfer.design import Room
        >>> room = Room.find(luxfer_scene)
        >>> room.floor, room.ceiling, round(room.length, 2), round(room.width, 2), round(room.height, 2)
        ('Floor', 'Ceiling', 6.0, 4.0, 2.8)
        """
        level = sorted((c for c in scene.candidates if c.kind.name == "OBJECT"), key=lambda c: -c.score)
        top = ceiling or (level[0].name if level and level[0].score >= MIN_SCORE else None)
        if top is None:
            raise ValueError("the scene has no level surface that could be a ceiling: name one by ceiling=")
        above = _surface(scene, top, "ceiling")
        bottom = floor or _likely_floor(level, above)
        below = _surface(scene, bottom, "floor")
        height = above.origin[1] - below.origin[1]
        if height < MIN_HEIGHT:
            raise ValueError(f"{top!r} lies {height:.2f} m above {bottom!r}: they are no ceiling and floor of a room")
        origin, along, across, length, width = _plan(below)
        return cls(scene, bottom, top, origin, along, across, length, width, float(height), below.area)

    def world(self, plan: ArrayLike, height: float = 0) -> NDArray[np.float64]:
        """Points of the plan (n, 2) at a height above the floor, in the scene's coordinates (n, 3)."""
        points = np.asarray(plan, float).reshape(-1, 2)
        return self.origin + points[:, :1] * self.along + points[:, 1:] * self.across + height * UP

    def plan(self, points: ArrayLike) -> NDArray[np.float64]:
        """Points of the scene (n, 3) in the plan (n, 2)."""
        offset = np.asarray(points, float).reshape(-1, 3) - self.origin
        return np.stack([offset @ self.along, offset @ self.across], axis=1)

    def free(self, points: ArrayLike, clearance: float = 0) -> NDArray[np.bool_]:
        """Whether points (n, 3) lie in the room: something is above and below them, they are not inside a closed
        object, and nothing is above them within the clearance in metres."""
        start = np.asarray(points, float).reshape(-1, 3)
        distance, leaves = self._cast(start, UP)
        inside = leaves & (distance < MAX_SOLID_DISTANCE)
        below, _ = self._cast(start, -UP)
        return np.isfinite(distance) & np.isfinite(below) & ~inside & (distance >= clearance)

    def _cast(self, start: NDArray[np.float64], direction: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
        """Distance of the first hit, and whether the ray meets the back of a surface there."""
        hits = self.scene.intersect(start, np.broadcast_to(direction, start.shape))
        leaves = np.zeros(len(start), bool)
        for i, hit in enumerate(hits):
            if np.isfinite(hit["t"]):
                leaves[i] = self._normal(int(hit["mesh"]), int(hit["triangle"])) @ direction > 0
        return hits["t"].astype(float), leaves

    def _normal(self, mesh: int, triangle: int) -> NDArray[np.float64]:
        """Front normal of a triangle by its winding."""
        if mesh not in self._normals:
            arrays = self.scene.mesh_arrays(mesh)
            a, b, c = (arrays["positions"].astype(float)[arrays["indices"][:, k]] for k in range(3))
            self._normals[mesh] = np.cross(b - a, c - a)
        return self._normals[mesh][triangle]


def _surface(scene: Scene, name: str, role: str) -> Surface:
    """The surface of a name, with a reason in the room's words if there is none."""
    try:
        return scene.find_surface(name)
    except Error as error:
        raise ValueError(f"{name!r} cannot be the {role} of the room: {error}") from error


def _likely_floor(level: list[SurfaceCandidate], above: Surface) -> str:
    """The largest level object well below the ceiling."""
    needed = MIN_FLOOR_SHARE * above.area
    found = [c for c in level if c.height < above.origin[1] - MIN_HEIGHT and c.level_area >= needed]
    if not found:
        raise ValueError(
            f"the room has no floor: no object has {needed:.1f} m² of level surface at least {MIN_HEIGHT} m below "
            f"the ceiling "
            f"at {above.origin[1]:.2f} m; name one by floor=, or add one to the scene"
        )
    return min(found, key=lambda c: (round(c.height, 2), -c.level_area)).name


def _plan(below: Surface) -> tuple[NDArray, NDArray, NDArray, float, float]:
    """The corner and axes of the floor's rectangle that come nearest to x and z."""
    u, v = np.array(below.u_axis, float), np.array(below.v_axis, float)
    size = [float(below.size[0]), float(below.size[1])]
    if abs(u[0]) < abs(v[0]):
        u, v, size = v, u, size[::-1]
    origin = np.array(below.origin, float)
    axes = []
    for axis, main, length in ((u, 0, size[0]), (v, 2, size[1])):
        if axis[main] < 0:
            origin, axis = origin + axis * length, -axis
        axes.append(axis)
    return origin, axes[0], axes[1], size[0], size[1]
