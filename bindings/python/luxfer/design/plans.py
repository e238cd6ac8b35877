"""Drawings of a design: its plan, and the illuminance of an area in false colours with isolux lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .drawing import Drawing, Point, colour_of, ink_on
from .isolux import levels, lines
from .units import shown

if TYPE_CHECKING:
    from .areas import Area, Patch
    from .luminaires import Luminaire
    from .measure import Field
    from .observers import Observers
    from .rooms import Room

#: Largest size of a drawing, and its border, in points. [convention]
WIDTH, HEIGHT, BORDER = 470.0, 300.0, 26.0
#: Smallest side of a cell, in points, in which its number is written. [convention]
READABLE = 17.0
#: Colours of lines: room, task, band, observers, lamps. [convention]
INK, TASK, BAND, EYE, LAMP = "#222222", "#b00020", "#b06000", "#00508f", "#c08a00"


class Scale:
    """Maps a rectangle in metres onto a drawing."""

    def __init__(self, length: float, width: float, extra: float = 0) -> None:
        room = (WIDTH - 2 * BORDER - extra) / length, (HEIGHT - 2 * BORDER) / width
        self.factor = min(room)
        self.drawing = Drawing(WIDTH, width * self.factor + 2 * BORDER)
        self.left = (WIDTH - extra - length * self.factor) / 2

    def at(self, point: Sequence[float]) -> Point:
        """A point in the drawing."""
        return self.left + float(point[0]) * self.factor, BORDER + float(point[1]) * self.factor


def plan(room: Room, luminaires: Sequence[Luminaire], areas: Sequence[Area], observers: Sequence[Observers], unit: str) -> Drawing:
    """The floor with areas, numbered luminaires and observers."""
    scale = Scale(room.length, room.width)
    drawing = scale.drawing
    _walls(scale, room, unit)
    for area in areas:
        if area.kind not in ("task", "surrounding", "background"):
            continue
        colour = {"task": TASK, "surrounding": BAND}.get(area.kind, "#888888")
        for a0, b0, a1, b1 in _hull(area):
            corners = [scale.at(p) for p in ((a0, b0), (a1, b0), (a1, b1), (a0, b1), (a0, b0))]
            drawing.line(corners, colour, 1.0 if area.kind == "task" else 0.7, area.kind != "task")
            # The name stands below the upper edge, except of the background, where it stands above the lower one.
            x, y = scale.at((a0, b1)) if area.kind == "background" else scale.at((a0, b0))
            drawing.text((x + 3, y - 3 if area.kind == "background" else y + 8), area.name, 6.5, "start", colour)
    for number, lamp in enumerate(luminaires, 1):
        _lamp(scale, room, lamp, number)
    for group in observers:
        for place, view in zip(room.plan(group.positions), group.directions):
            _eye(scale, place, np.array([view @ room.along, view @ room.across]))
    return drawing


def field(room: Room, found: Field, unit: str) -> Drawing:
    """The maintained illuminance of an area in false colours, with numbers where they can be read, and isolux lines."""
    wall = found.area.kind == "walls"
    frames = [_frame(room, p, wall) for p in (found.area.patches if wall else found.area.patches[: _once(found.area)])]
    if wall:
        gap = 0.3
        length = sum(f[1] for f in frames) + gap * (len(frames) - 1)
        scale = Scale(length, room.height, extra=40)
    else:
        scale = Scale(room.length, room.width, extra=40)
        _walls(scale, room, unit)
    low, high = float(found.values.min()), float(found.values.max())
    left = 0.0
    for index, (origin, across, down) in enumerate((f[0], f[1], f[2]) for f in frames):
        if wall:
            origin, along, up = np.array([left, room.height]), np.array([across, 0.0]), np.array([0.0, -room.height])
            left += across + 0.3
        else:
            along, up = across, down
        _cells(scale, found.image(index), origin, along, up, low, high)
    _bar(scale.drawing, low, high)
    return scale.drawing


def _once(area: Area) -> int:
    """Number of rectangles to draw: of the planes of cylindrical illuminance only one."""
    return 1 if area.kind == "cylindrical" else len(area.patches)


def _frame(room: Room, patch: Patch, wall: bool) -> tuple:
    """Origin, edge across and edge down of a rectangle in the plan; of a wall its length."""
    if wall:
        return None, float(np.linalg.norm(patch.across)), room.height
    origin = room.plan(patch.origin)[0]
    along = np.array([patch.across @ room.along, patch.across @ room.across])
    return origin, along, np.array([patch.down @ room.along, patch.down @ room.across])


def _cells(
    scale: Scale, values: NDArray, origin: NDArray, along: NDArray, down: NDArray, low: float, high: float
) -> None:
    """Coloured cells, their numbers, and isolux lines."""
    rows, columns = values.shape
    drawing = scale.drawing
    at = lambda c, r: scale.at(origin + along * (c / columns) + down * (r / rows))  # noqa: E731
    for r in range(rows):
        for c in range(columns):
            if np.isnan(values[r, c]):
                continue
            share = (values[r, c] - low) / (high - low) if high > low else 1.0
            corners = [at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)]
            drawing.polygon(corners, colour_of(share))
            xs, ys = [p[0] for p in corners], [p[1] for p in corners]
            if max(xs) - min(xs) >= READABLE and max(ys) - min(ys) >= 8:
                middle = (sum(xs) / 4, sum(ys) / 4 + 2.2)
                drawing.text(middle, f"{values[r, c]:.0f}", 6.5, "middle", ink_on(share))
    for level in levels(low, high):
        for (c0, r0), (c1, r1) in lines(values, level):
            drawing.line([at(c0 + 0.5, r0 + 0.5), at(c1 + 0.5, r1 + 0.5)], "#ffffff", 1.6)
            drawing.line([at(c0 + 0.5, r0 + 0.5), at(c1 + 0.5, r1 + 0.5)], "#000000", 0.7)


def _bar(drawing: Drawing, low: float, high: float) -> None:
    """The scale of colours, with the levels of the isolux lines marked."""
    x, top, bottom = drawing.width - 46, BORDER + 8, drawing.height - BORDER
    steps = 40
    for i in range(steps):
        y0, y1 = bottom - (bottom - top) * i / steps, bottom - (bottom - top) * (i + 1) / steps
        drawing.polygon([(x, y0), (x + 10, y0), (x + 10, y1), (x, y1)], colour_of((i + 0.5) / steps))
    drawing.text((x, top - 6), "lx", 7, "start")
    marks = [(low, True), (high, True)] + [(v, False) for v in levels(low, high)]
    used: list[float] = []
    for value, end in marks:
        y = bottom - (bottom - top) * ((value - low) / (high - low) if high > low else 1.0)
        if any(abs(y - u) < 7 for u in used):
            continue
        used.append(y)
        if not end:
            drawing.line([(x, y), (x + 10, y)], "#000000", 0.7)
        drawing.text((x + 13, y + 2.3), f"{value:.0f}", 6.5, "start")


def _walls(scale: Scale, room: Room, unit: str) -> None:
    """The outline of the floor with its sides."""
    corners = [scale.at(p) for p in ((0, 0), (room.length, 0), (room.length, room.width), (0, room.width))]
    scale.drawing.polygon(corners, None, INK, 1.4)
    x, y = scale.at((room.length / 2, 0))
    scale.drawing.text((x, y - 5), f"{shown(room.length, unit)} {unit}", 7, "middle", INK)
    x, y = scale.at((0, room.width / 2))
    scale.drawing.text((x - 4, y), f"{shown(room.width, unit)} {unit}", 7, "end", INK)


def _hull(area: Area) -> list[tuple[float, float, float, float]]:
    """The rectangle around all rectangles of an area."""
    boxes = np.array(area.outline)
    return [(boxes[:, 0].min(), boxes[:, 1].min(), boxes[:, 2].max(), boxes[:, 3].max())]


def _lamp(scale: Scale, room: Room, lamp: Luminaire, number: int) -> None:
    """The opening of a luminaire, at least as large as a readable mark, with its number."""
    a, b = room.plan(lamp.position)[0]
    length, width, _ = (max(abs(v), 6 / scale.factor) for v in lamp.product.size)
    u = np.array([np.dot(lamp.c0, room.along), np.dot(lamp.c0, room.across)])
    u = u / max(float(np.linalg.norm(u)), 1e-9)
    v = np.array([-u[1], u[0]])
    corners = [np.array([a, b]) + x * length / 2 * u + y * width / 2 * v for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    scale.drawing.polygon([scale.at(p) for p in corners], "#fff3c4" if lamp.dimmer > 0 else "#eeeeee", LAMP, 0.9)
    x, y = scale.at((a, b))
    scale.drawing.text((x, y + 2.5), str(number), 7, "middle", INK)


def _eye(scale: Scale, place: NDArray, view: NDArray) -> None:
    """An observer as an arrow head along the line of sight."""
    side = np.array([-view[1], view[0]])
    size = 5 / scale.factor
    corners = [place + size * view, place - 0.6 * size * view + 0.6 * size * side, place - 0.6 * size * view - 0.6 * size * side]
    scale.drawing.polygon([scale.at(p) for p in corners], EYE, EYE, 0.5)
