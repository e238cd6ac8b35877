"""The plane on which lux is calculated: a surface, or a level plane above the floor of a room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .exits import usage

if TYPE_CHECKING:
    from ..scene import Scene
    from ..types import Surface

#: Height of a desk above the floor in metres. [convention]
DESK = 0.75
#: Width in metres of the border along the walls that EN 12464-1 leaves out. [convention]
BORDER = 0.5
#: Distance in metres of the points from a surface, so that rays start before it. [rounding]
LIFT = 1e-3
#: Number of rays along each side of the ceiling that find the floor.
RAYS = 16
#: Surfaces count as level up to a slope of 5 degrees; this is its cosine.
LEVEL = 0.996


@dataclass(frozen=True)
class Plane:
    """A rectangle with the side that receives the light."""

    origin: tuple[float, ...]
    across: tuple[float, ...]
    down: tuple[float, ...]
    normal: tuple[float, ...]
    words: str

    @property
    def sides(self) -> tuple[float, float]:
        """Lengths of its sides in metres."""
        return _norm(self.across), _norm(self.down)

    def grid(self) -> dict[str, Any]:
        """Returns the plane as the grid of an illuminance calculation."""
        return {"origin": self.origin, "across": self.across, "down": self.down, "normal": self.normal}

    def points(self, spacing: float) -> tuple[int, int]:
        """Returns the numbers of columns and rows of a grid whose points are about `spacing` metres apart."""
        across, down = (max(1, min(4096, round(side / spacing))) for side in self.sides)
        return across, down


def on_surface(scene: Scene, name: str) -> Plane:
    """Returns the plane of a surface's front."""
    found = scene.find_surface(name)
    u, v = found.size
    origin = tuple(o + LIFT * n for o, n in zip(found.origin, found.normal))
    across, down = tuple(u * a for a in found.u_axis), tuple(v * a for a in found.v_axis)
    return Plane(origin, across, down, found.normal, f'"{name}"')


def level(height: float, rectangle: tuple[float, ...]) -> Plane:
    """Returns the level rectangle X0, Z0, X1, Z1 at a height, in the coordinates of the scene."""
    x0, z0, x1, z1 = rectangle
    return Plane(
        (x0, height, z0), (x1 - x0, 0, 0), (0, 0, z1 - z0), (0, 1, 0), f"the level plane at y = {height:.2f} m"
    )


def above_floor(scene: Scene, ceiling: str, height: float = DESK, border: float = BORDER) -> Plane:
    """Returns the plane at a height above the floor, under a ceiling, without a border along the walls."""
    found = scene.find_surface(ceiling)
    if abs(found.normal[1]) < LEVEL:
        raise usage(f'--surface: "{ceiling}" is not level, so there is no plane of desks under it; give --rect')
    floor = floor_below(scene, found)
    # A room narrower than four borders keeps half of its width.
    insets = [min(border, side / 4) for side in found.size]
    u, v = ([a for a in axis] for axis in (found.u_axis, found.v_axis))
    across, down = (
        tuple((side - 2 * inset) * a for a in axis) for side, inset, axis in zip(found.size, insets, (u, v))
    )
    corner = [found.origin[i] + insets[0] * u[i] + insets[1] * v[i] for i in range(3)]
    origin = (corner[0], floor + height, corner[2])
    words = f'the plane {height:.2f} m above the floor (y = {floor:.2f} m) under "{ceiling}"'
    return Plane(origin, across, down, (0, 1, 0), words)


def floor_below(scene: Scene, surface: Surface) -> float:
    """Finds the height of the floor by rays that go down from a ceiling: the lowest tenth of the hits lies below it."""
    import numpy as np

    steps = (np.arange(RAYS) + 0.5) / RAYS
    u, v = (s * np.array(axis) for s, axis in zip(surface.size, (surface.u_axis, surface.v_axis)))
    start = np.array(surface.origin) + steps[:, None, None] * u + steps[None, :, None] * v
    start = (start - [0, 2 * LIFT, 0]).reshape(-1, 3)
    hits = scene.intersect(start, np.tile([0.0, -1.0, 0.0], (len(start), 1)))
    below = np.isfinite(hits["t"])
    if not below.any():
        raise usage(
            "--height: there is no floor under the ceiling; give --rect with --height in the scene's coordinates"
        )
    return float(np.quantile(start[below, 1] - hits["t"][below], 0.1))


def _norm(vector: tuple[float, ...]) -> float:
    return float(sum(v * v for v in vector) ** 0.5)
