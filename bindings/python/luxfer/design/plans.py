"""Drawings of a design: its plan, and the illuminance of an area in false colours with isolux lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .drawing import Drawing, Point, colour_of, ink_on
from .isolux import levels, lines
from .units import lux, shown

if TYPE_CHECKING:
    from .areas import Area
    from .luminaires import Luminaire
    from .measure import Field
    from .observers import Observers
    from .rooms import Room

#: Largest width of a drawing, largest heights of a plan and of an area, and the borders, in points. [convention]
WIDTH, HEIGHT, FIELD_HEIGHT, BORDER, TOP = 480.0, 300.0, 245.0, 42.0, 16.0
#: Smallest side of a cell, in points, in which its number is written. [convention]
READABLE = 17.0
#: Colours of lines: room, task, band, observers, lamps. [convention]
INK, TASK, BAND, EYE, LAMP = "#222222", "#b00020", "#b06000", "#00508f", "#c08a00"
#: Kinds of areas that the plan shows, and the colours of their outlines; green is emergency light. [convention]
OUTLINES = {
    "task": TASK,
    "surrounding": BAND,
    "background": "#888888",
    "escape line": "#007a3d",
    "escape band": "#007a3d",
    "open area": "#007a3d",
}


class Scale:
    """Maps a rectangle in metres onto a drawing."""

    def __init__(
        self, length: float, width: float, extra: float = 0, height: float = HEIGHT, corner: Point = (0, 0)
    ) -> None:
        self.factor = min((WIDTH - 2 * BORDER - extra) / length, (height - 2 * TOP) / width)
        self.drawing = Drawing(WIDTH, width * self.factor + 2 * TOP)
        self.left = (WIDTH - extra - length * self.factor) / 2
        self.corner = corner

    def at(self, point: Sequence[float]) -> Point:
        """A point in the drawing."""
        a, b = float(point[0]) - self.corner[0], float(point[1]) - self.corner[1]
        return self.left + a * self.factor, TOP + b * self.factor


def plan(
    room: Room, luminaires: Sequence[Luminaire], areas: Sequence[Area], observers: Sequence[Observers], unit: str
) -> Drawing:
    """The floor with areas, numbered luminaires and observers."""
    scale = Scale(room.length, room.width)
    drawing = scale.drawing
    _walls(scale, room, unit)
    for number, lamp in enumerate(luminaires, 1):
        _lamp(scale, room, lamp, number)
    for area in areas:
        if area.kind not in OUTLINES:
            continue
        colour, low = OUTLINES[area.kind], area.kind in ("background", "open area")
        for a0, b0, a1, b1 in _hull(area):
            corners = [scale.at(p) for p in ((a0, b0), (a1, b0), (a1, b1), (a0, b1), (a0, b0))]
            drawing.line(corners, colour, 1.0 if area.kind == "task" else 0.7, area.kind != "task")
            if area.kind == "escape line":  # its band stands around it
                continue
            # The name stands below the upper edge, except that the name of the background stands above its lower edge.
            x, y = scale.at((a0, b1)) if low else scale.at((a0, b0))
            # That of an open area stands at the other end, because it may coincide with the background.
            if area.kind == "open area":
                drawing.text((scale.at((a1, b1))[0] - 3, y - 3), area.name, 6.5, "end", colour)
            else:
                drawing.text((x + 3, y - 3 if low else y + 8), area.name, 6.5, "start", colour)
    for group in observers:
        for place, view in zip(room.plan(group.positions), group.directions):
            _eye(scale, place, np.array([view @ room.along, view @ room.across]))
    return drawing


def field(room: Room, found: Field, unit: str) -> Drawing:
    """The maintained illuminance of an area in false colours, with numbers where they can be read, and isolux
    lines."""
    low, high = float(found.values.min()), float(found.values.max())
    if found.area.kind == "walls":
        scale = _unrolled(room, found, low, high)
    else:
        a0, b0, a1, b1 = _hull(found.area)[0]
        scale = Scale(a1 - a0, b1 - b0, 40, FIELD_HEIGHT, (a0, b0))
        for index, patch in enumerate(found.area.patches[: _once(found.area)]):
            along = np.array([patch.across @ room.along, patch.across @ room.across])
            down = np.array([patch.down @ room.along, patch.down @ room.across])
            _cells(scale, found.image(index), room.plan(patch.origin)[0], along, down, low, high)
        _sides(scale, a1 - a0, b1 - b0, unit)
    _bar(scale.drawing, low, high)
    return scale.drawing


def _unrolled(room: Room, found: Field, low: float, high: float) -> Scale:
    """The walls seen from inside, each with its floor below: walls along the room above, walls across it below."""
    lengths = [float(np.linalg.norm(p.across)) for p in found.area.patches]
    gap = 0.35
    half = (len(lengths) + 1) // 2
    rows = [list(range(half)), list(range(half, len(lengths)))]
    rows = [r for r in rows if r]
    longest = max(sum(lengths[i] for i in r) + gap * (len(r) - 1) for r in rows)
    scale = Scale(longest, len(rows) * room.height + gap * (len(rows) - 1), 40, FIELD_HEIGHT)
    for number, row in enumerate(rows):
        left, top = 0.0, number * (room.height + gap)
        for index in row:
            origin, up = np.array([left, top + room.height]), np.array([0.0, -room.height])
            _cells(scale, found.image(index), origin, np.array([lengths[index], 0.0]), up, low, high)
            corners = [
                (left, top),
                (left + lengths[index], top),
                (left + lengths[index], top + room.height),
                (left, top + room.height),
            ]
            scale.drawing.polygon([scale.at(p) for p in corners], None, INK, 0.6)
            left += lengths[index] + gap
    return scale


def _once(area: Area) -> int:
    """Number of rectangles to draw: of the planes of cylindrical illuminance only one."""
    return 1 if area.kind == "cylindrical" else len(area.patches)


def _cells(
    scale: Scale, values: NDArray, origin: NDArray, along: NDArray, down: NDArray, low: float, high: float
) -> None:
    """Coloured cells, their numbers, and isolux lines."""
    rows, columns = values.shape
    drawing = scale.drawing
    at = lambda c, r: scale.at(origin + along * (c / columns) + down * (r / rows))  # noqa: E731
    filled = [(r, c) for r in range(rows) for c in range(columns) if not np.isnan(values[r, c])]
    share = lambda v: (v - low) / (high - low) if high > low else 1.0  # noqa: E731
    boxes = {(r, c): [at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)] for r, c in filled}
    for place, corners in boxes.items():
        drawing.polygon(corners, colour_of(share(values[place])))
    for level in levels(low, high):
        for (c0, r0), (c1, r1) in lines(values, level):
            ends = [at(c0 + 0.5, r0 + 0.5), at(c1 + 0.5, r1 + 0.5)]
            drawing.line(ends, "#ffffff", 1.6)
            drawing.line(ends, "#000000", 0.7)
    for place, corners in boxes.items():
        xs, ys = [p[0] for p in corners], [p[1] for p in corners]
        if max(xs) - min(xs) >= READABLE and max(ys) - min(ys) >= 8:
            middle = (sum(xs) / 4, sum(ys) / 4 + 2.2)
            drawing.text(middle, lux(values[place]), 6.5, "middle", ink_on(share(values[place])))


def _bar(drawing: Drawing, low: float, high: float) -> None:
    """The scale of colours, with the levels of the isolux lines marked."""
    x, top, bottom = drawing.width - 46, 20, drawing.height - 12
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
        drawing.text((x + 13, y + 2.3), lux(value), 6.5, "start")


def _walls(scale: Scale, room: Room, unit: str) -> None:
    """The outline of the floor with its sides."""
    corners = [scale.at(p) for p in ((0, 0), (room.length, 0), (room.length, room.width), (0, room.width))]
    scale.drawing.polygon(corners, None, INK, 1.4)
    _sides(scale, room.length, room.width, unit)


def _sides(scale: Scale, length: float, width: float, unit: str) -> None:
    """The lengths of the upper and the left side."""
    a, b = scale.corner
    x, y = scale.at((a + length / 2, b))
    scale.drawing.text((x, y - 5), f"{shown(length, unit)} {unit}", 7, "middle", INK)
    x, y = scale.at((a, b + width / 2))
    scale.drawing.text((x - 4, y), f"{shown(width, unit)} {unit}", 7, "end", INK)


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
    corners = [
        np.array([a, b]) + x * length / 2 * u + y * width / 2 * v for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    scale.drawing.polygon([scale.at(p) for p in corners], "#fff3c4" if lamp.dimmer > 0 else "#eeeeee", LAMP, 0.9)
    x, y = scale.at((a, b))
    scale.drawing.text((x, y + 2.5), str(number), 7, "middle", INK)


def _eye(scale: Scale, place: NDArray, view: NDArray) -> None:
    """An observer as an arrow head along the line of sight."""
    side = np.array([-view[1], view[0]])
    size = 5 / scale.factor
    corners = [
        place + size * view,
        place - 0.6 * size * view + 0.6 * size * side,
        place - 0.6 * size * view - 0.6 * size * side,
    ]
    scale.drawing.polygon([scale.at(p) for p in corners], EYE, EYE, 0.5)
