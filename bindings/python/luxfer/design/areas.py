"""Areas of a room by the rules of EN 12464-1, and their measuring grids: task, immediate surrounding, background,
walls, ceiling, and cylindrical illuminance in the room.

A grid has cells that are nearly square, with a point at the centre of each. Their size follows the standard's
`p = 0.2 · 5^log10(d)`, where d is the longer side of the area, or the shorter side if the longer one is at least twice
as long.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .units import metres

if TYPE_CHECKING:
    from .rooms import Room

#: Largest spacing of points, width of the surrounding band, and strip along the walls that is left out, in metres.
#: [convention: EN 12464-1]
MAX_SPACING, BAND, BORDER = 10.0, 0.5, 0.5
#: Height in metres at which the cylindrical illuminance of seated people counts. [convention: EN 12464-1]
SEATED = 1.2
#: Points of the background need this height free above them, in metres: people can walk there. [convention]
WALKING = 1.5
#: Distance of the points from the wall or ceiling that they lie on, and depth that still counts as this wall, in
#: metres.
#: [convention]
OFFSET, DEPTH = 0.01, 0.05
#: Height in metres of points on the floor, so that a carpet does not hide them. [convention]
CARPET = 0.03
#: A wall is looked for from this distance, in metres, so that furniture in front of it hides it. [convention]
LOOK = 1.0
#: Smallest share of the rays that must meet a plane for the plane to count as the wall. [convention]
WALL_SHARE = 0.15
#: Darkest points that a thinned area keeps, as a share of its other points. [convention]
DARK_SHARE = 0.5
#: Number of vertical planes around a point. Their mean illuminance stands for the cylindrical illuminance. An odd
#: number gives the accuracy of twice this number.
#: [convention]
PLANES = 9
#: Largest relative error of the mean over these planes, 1.02 %: one small source in the worst direction has this error.
PLANES_ERROR = 1 - math.pi / (2 * PLANES) / math.tan(math.pi / (2 * PLANES))
#: Places of the four walls in the plan, in the order of `walls`.
WALLS = ("along the upper side of the plan", "along its lower side", "along its left side", "along its right side")


def spacing(length: float, width: float) -> float:
    """Largest spacing in metres of the points of a rectangle.

    >>> [round(spacing(d, d), 2) for d in (0.4, 1, 2, 5, 10, 25, 50, 100)]
    [0.11, 0.2, 0.32, 0.62, 1.0, 1.9, 3.08, 5.0]
    >>> spacing(10, 1) == spacing(1, 1)
    True
    """
    longer, shorter = max(length, width), min(length, width)
    if shorter <= 0:
        raise ValueError(f"an area of {length} by {width} m has no points: both sides must be above 0")
    d = shorter if longer >= 2 * shorter else longer
    return min(0.2 * 5 ** math.log10(d), MAX_SPACING)


def counts(length: float, width: float, largest: float | None = None) -> tuple[int, int]:
    """Numbers of points along both sides.

    >>> counts(2, 1), counts(6, 4)
    ((10, 5), (9, 6))
    """
    p = min(spacing(length, width), largest or math.inf)
    return max(1, round(length / p)), max(1, round(width / p))


class NoPoints(ValueError):
    """An area has no point in the room."""


@dataclass(frozen=True)
class Patch:
    """A rectangle of points."""

    origin: NDArray[np.float64]
    """Corner in metres."""
    across: NDArray[np.float64]
    """Edge along which columns are counted."""
    down: NDArray[np.float64]
    """Edge along which rows are counted."""
    normal: NDArray[np.float64]
    """Side that receives the light."""
    columns: int
    """Points along the first edge."""
    rows: int
    """Points along the second edge."""
    keep: NDArray[np.bool_]
    """Points (rows, columns) that belong to the area."""
    extra: NDArray[np.bool_] | None = None
    """Those of them that do not count for the mean; None: all count."""

    @property
    def points(self) -> NDArray[np.float64]:
        """Centres of the cells (rows, columns, 3)."""
        x = (np.arange(self.columns) + 0.5)[None, :, None] / self.columns
        y = (np.arange(self.rows) + 0.5)[:, None, None] / self.rows
        return self.origin + x * self.across + y * self.down


@dataclass(frozen=True)
class Area:
    """An area with its grid."""

    name: str
    """Name by which requirements refer to it."""
    kind: str
    """ "task", "surrounding", "background", "walls", "ceiling", "cylindrical", or, of emergency light, "escape line",
    "escape band" or "open area"."""
    patches: tuple[Patch, ...]
    """Its rectangles; of cylindrical illuminance one for each plane, all with equal points."""
    height: float
    """Height above the floor in metres; of walls the height of their lower edge."""
    outline: tuple[tuple[float, float, float, float], ...]
    """Rectangles of the plan, a0, b0, a1, b1 in metres, for drawings; empty for walls."""
    dropped: tuple[Patch, ...] = ()
    """Rectangles without a point that belongs to the area; nothing is computed for them."""
    notes: tuple[str, ...] = ()
    """A note about the area, such as that a wall has no points."""

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """Share of the area that each point stands for, because rectangles differ in the spacing of their points."""
        patches = self.patches[:1] if self.kind == "cylindrical" else self.patches
        cells = [np.linalg.norm(np.cross(p.across, p.down)) / p.keep.size for p in patches]
        counts = [p.keep[p.keep] if p.extra is None else ~p.extra[p.keep] for p in patches]
        out = np.concatenate([c * v for c, v in zip(cells, counts)])
        return out / out.sum()

    @property
    def count(self) -> int:
        """Number of points at which illuminance is computed."""
        planes = PLANES if self.kind == "cylindrical" else 1
        return sum(int(p.keep.sum()) for p in self.patches) // planes

    @property
    def left_out(self) -> int:
        """Number of points of the rectangles that do not belong to the area."""
        planes = PLANES if self.kind == "cylindrical" else 1
        return sum(p.keep.size for p in (*self.patches, *self.dropped)) // planes - self.count


def task(room: Room, name: str, rectangle: Sequence[float], height: float, unit: str = "m") -> Area:
    """A horizontal task area: a0, b0, a1, b1 in the room's plan and its height above the floor, in that unit. A task
    area on the floor lies as high above it as the background does."""
    a0, b0, a1, b1, level = metres([*rectangle, height], unit)
    level = CARPET if 0 <= level < CARPET else level
    if not (a1 > a0 and b1 > b0):
        raise ValueError(
            f"the task area {name!r} has the corners ({a0:g}, {b0:g}) and ({a1:g}, {b1:g}) m: the second must lie "
            "beyond the first along both axes"
        )
    if a0 < -1e-6 or b0 < -1e-6 or a1 > room.length + 1e-6 or b1 > room.width + 1e-6 or not 0 <= level < room.height:
        raise ValueError(
            f"the task area {name!r} ({a0:g}, {b0:g}) to ({a1:g}, {b1:g}) m at {level:g} m leaves the room of "
            f"{room.length:g} by {room.width:g} by {room.height:g} m"
        )
    return _made(name, "task", room, [(a0, b0, a1, b1)], level)


def task_on(room: Room, name: str, objects: str, lift: float = 0.01) -> Area:
    """The task area on top of the objects of the scene that have this name, such as "Desk": their bounding rectangle in
    the plan, at their highest point plus `lift` metres."""
    scene = room.scene
    meshes = [m for m in range(scene.counts.meshes) if scene.mesh_name(m) == objects]
    if not meshes:
        raise ValueError(f"the scene has no object called {objects!r} for the task area {name!r}")
    points = np.concatenate([scene.mesh_arrays(m)["positions"] for m in meshes]).astype(float)
    plan = np.clip(room.plan(points), 0, (room.length, room.width))
    level = float(points[:, 1].max() - room.origin[1]) + lift
    return task(room, name, (*plan.min(axis=0), *plan.max(axis=0)), level)


def surrounding(room: Room, of: Area, name: str | None = None, band: float = BAND) -> Area:
    """The band around a task area, at its height, as far as the room reaches."""
    ((a0, b0, a1, b1),) = of.outline
    left, low = max(0.0, a0 - band), max(0.0, b0 - band)
    right, high = min(room.length, a1 + band), min(room.width, b1 + band)
    strips = [(left, low, right, b0), (left, b1, right, high), (left, b0, a0, b1), (a1, b0, right, b1)]
    strips = [s for s in strips if s[2] - s[0] > 1e-6 and s[3] - s[1] > 1e-6]
    if not strips:
        raise NoPoints(f"{of.name!r} fills the room: it has no surrounding area")
    return _made(name or f"around {of.name}", "surrounding", room, strips, of.height, largest=band / 2)


def background(room: Room, tasks: Sequence[Area] = (), name: str = "background", border: float = BORDER) -> Area:
    """The part of the floor where people can walk, without a strip along the walls and without task and surrounding
    areas."""
    rectangle = _within(room, border)
    area = _made(name, "background", room, [rectangle], CARPET, clearance=WALKING)
    patch = area.patches[0]
    plan = room.plan(patch.points.reshape(-1, 3))
    keep = patch.keep.copy().reshape(-1)
    for a0, b0, a1, b1 in (r for t in tasks for r in t.outline):
        keep &= ~((plan[:, 0] > a0) & (plan[:, 0] < a1) & (plan[:, 1] > b0) & (plan[:, 1] < b1))
    return _filled(area, [keep.reshape(patch.keep.shape)])


def ceiling(room: Room, name: str = "ceiling") -> Area:
    """The whole ceiling, seen from below."""
    return _made(name, "ceiling", room, [(0, 0, room.length, room.width)], room.height - OFFSET, normal=(0, -1, 0))


def cylindrical(room: Room, name: str = "faces", height: float = SEATED, border: float = BORDER) -> Area:
    """Points at the height of faces, each with vertical planes all around."""
    base = _made(name, "cylindrical", room, [_within(room, border)], height).patches[0]
    angles = 2 * np.pi * np.arange(PLANES) / PLANES
    around = [np.cos(t) * room.along + np.sin(t) * room.across for t in angles]
    patches = tuple(Patch(base.origin, base.across, base.down, n, base.columns, base.rows, base.keep) for n in around)
    return Area(name, "cylindrical", patches, height, (_within(room, border),))


def horizontal(area: Area) -> Area:
    """The points of a cylindrical area with the plane that looks up, for modelling."""
    if area.kind != "cylindrical":
        raise ValueError(
            f"modelling compares cylindrical with horizontal illuminance: {area.name!r} is no cylindrical area"
        )
    return replace(area, kind="horizontal", patches=(replace(area.patches[0], normal=np.array([0.0, 1.0, 0.0])),))


def walls(
    room: Room, name: str = "walls", without: Sequence[str] = ("window", "glass", "frame", "door", "curtain")
) -> Area:
    """The four walls, without the parts that lie behind or in front of them, such as windows, pictures and cupboards,
    and without objects whose name contains one of these words."""
    sides = (
        (room.world([(0, 0)])[0], room.along * room.length, room.across),
        (room.world([(0, room.width)])[0], room.along * room.length, -room.across),
        (room.world([(0, 0)])[0], room.across * room.width, room.along),
        (room.world([(room.length, 0)])[0], room.across * room.width, -room.along),
    )
    found = [_wall(room, np.asarray(corner), edge, inwards, without) for corner, edge, inwards in sides]
    notes = tuple(
        f"{name}: the wall {where} has no point, and is not checked"
        for where, (_, keep) in zip(WALLS, found)
        if not keep.any()
    )
    area = Area(name, "walls", tuple(patch for patch, _ in found), 0.0, (), notes=notes)
    return _filled(area, [keep for _, keep in found])


def thinned(area: Area, count: int, lux: NDArray[np.float64] | None = None) -> Area:
    """The area with at most about this number of its points, evenly spread, from which means are estimated. With the
    illuminance of its points in a similar light, the darkest ones are kept too, as points that only count for the
    smallest illuminance."""
    if area.count <= count:
        return area
    # Multiples of the golden ratio, or of its generalisation to two dimensions, are evenly spread. [convention:
    # Roberts' R2 sequence]
    share, patches, start = count / area.count, [], 0
    dark = np.zeros(area.count, bool)
    if lux is not None:
        dark[np.argsort(lux, kind="stable")[: max(1, round(DARK_SHARE * count))]] = True
    for patch in area.patches:
        rows, columns = np.indices(patch.keep.shape)
        some = patch.keep & ((0.7549 * rows + 0.5698 * columns) % 1 < share)
        some = some if some.any() else patch.keep
        also = np.zeros_like(some)
        if lux is not None:
            stop = start + int(patch.keep.sum())
            also[patch.keep] = dark[start:stop]
            start = 0 if area.kind == "cylindrical" else stop
        patches.append(replace(patch, keep=some | also, extra=also & ~some))
    return replace(area, patches=tuple(patches))


def around_tasks(room: Room, tasks: Sequence[Area]) -> list[Area]:
    """The surrounding areas of tasks, the background, walls, ceiling and cylindrical illuminance, as far as they have
    space in the room: a task that fills the room has no surrounding area, and a small room has no background."""
    out: list[Area] = []
    for make in (
        *(lambda of=t: surrounding(room, of) for t in tasks),
        lambda: background(room, [*tasks, *out]),
        lambda: walls(room),
        lambda: ceiling(room),
        lambda: cylindrical(room),
    ):
        try:
            out.append(make())
        except NoPoints:
            continue
    return out


def _wall(
    room: Room,
    corner: NDArray[np.float64],
    edge: NDArray[np.float64],
    inwards: NDArray[np.float64],
    without: Sequence[str],
) -> tuple[Patch, NDArray[np.bool_]]:
    """The grid of a wall near an edge of the floor, and the points where the wall is seen from a step inside."""
    columns, rows = counts(float(np.linalg.norm(edge)), room.height)
    up = np.array([0.0, room.height, 0.0])
    step = min(LOOK, 0.5 * min(room.length, room.width))
    whole = np.ones((rows, columns), bool)
    look = Patch(corner + step * inwards, edge, up, inwards, columns, rows, whole)
    start = look.points.reshape(-1, 3)
    hits = room.scene.intersect(start, np.broadcast_to(-inwards, start.shape))
    distance = hits["t"].astype(float)
    names = {m: room.scene.mesh_name(m).lower() for m in set(hits["mesh"][np.isfinite(distance)].tolist())}
    wanted = [m in names and not any(w in names[m] for w in without) for m in hits["mesh"].tolist()]
    distance[~np.array(wanted)] = np.inf
    # The wall is the farthest plane that a sufficient share of the rays meets; furniture and pictures lie in front of
    # it.
    bins = np.round(distance[distance < 2 * step] / OFFSET)
    planes = [
        v * OFFSET for v in sorted(set(bins), reverse=True) if (abs(bins - v) <= 1).sum() >= WALL_SHARE * whole.size
    ]
    if not planes:
        return look, np.zeros_like(whole)
    seen = distance[np.abs(distance - planes[0]) <= 1.5 * OFFSET]
    wall = float(np.median(seen))
    near = (distance > wall - 0.9 * OFFSET) & (distance <= wall + DEPTH)
    moved = corner + (step - wall + OFFSET) * inwards
    return Patch(moved, edge, up, inwards, columns, rows, whole), near.reshape(rows, columns)


def _within(room: Room, border: float) -> tuple[float, float, float, float]:
    """The floor without a strip along the walls, or the whole floor if the room is too narrow for the strip."""
    a = border if room.length > 3 * border else 0.0
    b = border if room.width > 3 * border else 0.0
    return a, b, room.length - a, room.width - b


def _made(
    name: str,
    kind: str,
    room: Room,
    rectangles: Sequence[tuple[float, float, float, float]],
    height: float,
    normal: Sequence[float] = (0, 1, 0),
    largest: float | None = None,
    clearance: float = 0,
) -> Area:
    """A horizontal area of rectangles of the plan, without points that are not free."""
    patches, keeps = [], []
    for a0, b0, a1, b1 in rectangles:
        columns, rows = counts(a1 - a0, b1 - b0, largest)
        corner = room.world([(a0, b0)], height)[0]
        patch = Patch(
            corner,
            room.along * (a1 - a0),
            room.across * (b1 - b0),
            np.array(normal, float),
            columns,
            rows,
            np.ones((rows, columns), bool),
        )
        patches.append(patch)
        keeps.append(room.free(patch.points.reshape(-1, 3), clearance).reshape(rows, columns))
    outline = tuple((float(a), float(b), float(c), float(d)) for a, b, c, d in rectangles)
    return _filled(Area(name, kind, tuple(patches), float(height), outline), keeps)


def fine(
    name: str,
    kind: str,
    room: Room,
    rectangle: tuple[float, float, float, float],
    height: float,
    steps: tuple[int, int],
    clearance: float = 0,
) -> Area:
    """A horizontal rectangle of the plan with that number of points along and across the room, without the points that
    are not free up to the clearance above them."""
    a0, b0, a1, b1 = rectangle
    patch = Patch(
        room.world([(a0, b0)], height)[0],
        room.along * (a1 - a0),
        room.across * (b1 - b0),
        np.array([0.0, 1.0, 0.0]),
        max(1, steps[0]),
        max(1, steps[1]),
        np.ones((max(1, steps[1]), max(1, steps[0])), bool),
    )
    keep = room.free(patch.points.reshape(-1, 3), clearance).reshape(patch.keep.shape)
    return _filled(Area(name, kind, (patch,), float(height), (rectangle,)), [keep])


def _filled(area: Area, keeps: Sequence[NDArray[np.bool_]]) -> Area:
    """The area with other points; an area without points is an error."""
    if not any(k.any() for k in keeps):
        raise NoPoints(f"the area {area.name!r} has no point that lies free in the room")
    patches = [replace(p, keep=k) for p, k in zip(area.patches, keeps)]
    filled, empty = [p for p in patches if p.keep.any()], [p for p in patches if not p.keep.any()]
    said = f"{area.name}: {len(empty)} of its {len(patches)} rectangles have no free point, and are not checked"
    notes = area.notes or ((said,) if empty else ())
    return replace(area, patches=tuple(filled), dropped=(*area.dropped, *empty), notes=notes)
