"""Lamps of the photo that the user has moved, resized or turned on their plane.

Such a lamp is an entry {"at", "before", "after"} of the project: a pixel on the lamp, and the corners of its rectangle
on the plane before and after, in the photo. The lamp is cut out of the photo and of the mask of the lights, the plane
beside it fills its place, and its pixels are put into the new rectangle. So a round lamp becomes an ellipse, and a lamp
keeps its light where the photo shows a dark ceiling. apply() uses only +, -, * and /, in an order that the programs in
C and C++ repeat to the bit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from .pictures import nearest, regions

if TYPE_CHECKING:
    import luxfer

    Array = np.ndarray[Any, Any]

#: Pixels of a lamp may lie outside of its rectangle by this share of the box around the rectangle.
BEYOND = 0.1
#: A lamp's rectangle follows the room axes unless a turned one is smaller than this share of it. [convention]
TURNED = 0.9


# -- the lamps, for the page


def rectangles(mask: Array, view: luxfer.types.RectifyReport, size: tuple[int, int]) -> list[dict[str, Any]]:
    """Returns for each lamp of a mask a pixel on it, and the corners, in the photo, of its rectangle on the plane."""
    labels, count = regions(mask > 0.5)
    out = []
    for label in range(1, count + 1):
        ys, xs = np.nonzero(labels == label)
        i = int(np.argmin((xs - xs.mean()) ** 2 + (ys - ys.mean()) ** 2))
        corners = rectangle(on_plane(outline(xs, ys), view, size))
        if corners is None:
            continue
        photo = in_photo(corners, view, size)
        if np.isfinite(photo).all() and np.abs(photo).max() < 1e5:
            out.append({"at": [float(xs[i]) + 0.5, float(ys[i]) + 0.5], "corners": photo.ravel().round(2).tolist()})
    return out


def outline(xs: Array, ys: Array) -> Array:
    """Returns the corners of the first and the last pixel of each row of a region."""
    rows = np.unique(ys)
    first = np.array([xs[ys == row].min() for row in rows])
    last = np.array([xs[ys == row].max() + 1 for row in rows])
    pairs = [(x, y) for x in (first, last) for y in (rows, rows + 1)]
    return np.concatenate([np.column_stack(pair) for pair in pairs]).astype(float)


def bend(view: luxfer.types.RectifyReport, size: tuple[int, int]) -> float:
    """Returns the radial distortion of the lens per square pixel."""
    return 4 * view.undone / (size[0] ** 2 + size[1] ** 2)


def on_plane(points: Array, view: luxfer.types.RectifyReport, size: tuple[int, int]) -> Array:
    """Returns the places of pixels of the photo on the unwarped plane."""
    centre = np.array(view.principal)
    away = points - centre
    ideal = centre + away * (1 - bend(view, size) * (away**2).sum(axis=1, keepdims=True))
    return through(np.linalg.inv(np.reshape(view.to_photo, (3, 3))), ideal)


def in_photo(points: Array, view: luxfer.types.RectifyReport, size: tuple[int, int]) -> Array:
    """Returns the pixels of the photo that show places of the unwarped plane; geometry.ts does the same."""
    centre = np.array(view.principal)
    away = through(np.reshape(view.to_photo, (3, 3)), points) - centre
    t = np.minimum(bend(view, size) * (away**2).sum(axis=1, keepdims=True), 4 / 27)
    s = np.where(t < 0, 1 / (1 - t), 1 + t + 3 * t * t)
    for _ in range(7):  # Newton's method for the root of s (1 - t s²) = 1
        s = s - (s * (1 - t * s * s) - 1) / (1 - 3 * t * s * s)
    return np.asarray(centre + away * s)


def through(matrix: Array, points: Array) -> Array:
    mapped = np.column_stack((points, np.ones(len(points)))) @ matrix.T
    return np.asarray(mapped[:, :2] / mapped[:, 2:])


def rectangle(points: Array) -> Array | None:
    """Returns the corners of the smallest rectangle around points, in turn; None if it has no area. It follows the axes
    unless a turned one is clearly smaller."""
    hull = convex_hull(points)
    if len(hull) < 3:
        return None
    sides = np.roll(hull, -1, axis=0) - hull
    found = [box_along(hull, float(angle)) for angle in [0.0, *np.arctan2(sides[:, 1], sides[:, 0])]]
    smallest = min(found, key=lambda box: box[0])
    area, corners = smallest if smallest[0] < TURNED * found[0][0] else found[0]
    return corners if area > 0 else None


def box_along(points: Array, angle: float) -> tuple[float, Array]:
    """Returns the area and the corners of the box around points whose sides are turned by an angle."""
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    turned = points @ turn.T
    low, high = turned.min(0), turned.max(0)
    return float(np.prod(high - low)), np.array([low, (high[0], low[1]), high, (low[0], high[1])]) @ turn


def convex_hull(points: Array) -> Array:
    """Returns the corners of the convex hull of points, in turn (Andrew's monotone chain)."""
    ordered = sorted(set(map(tuple, points.tolist())))

    def half(line: list[tuple[float, float]]) -> list[tuple[float, float]]:
        out: list[tuple[float, float]] = []
        for p in line:
            while len(out) > 1 and turn_of(out[-2], out[-1], p) <= 0:
                out.pop()
            out.append(p)
        return out[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def turn_of(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


# -- the change


def apply(
    photo: Array, mask: Array, plane: Array, reshaped: list[dict[str, Any]], max_distance: float
) -> tuple[Array, Array]:
    """Returns photo and mask of the lights after the changes. `plane` is the mask of the plane; max_distance, in
    pixels, is how far `at` may lie from its lamp."""
    is_lit = mask > 0.5
    labels, _ = regions(is_lit)
    found = [nearest(labels, lamp["at"], max_distance) for lamp in reshaped]
    out_photo, out_mask = photo.copy(), mask.copy()
    for label in found:
        if label:
            is_lamp = labels == label
            out_photo[is_lamp] = beside(photo, is_lamp, (plane > 0.5) & ~is_lit)
            out_mask[is_lamp] = 0
    for label, lamp in zip(found, reshaped):
        if label:
            put(photo, mask, labels == label, lamp["before"], lamp["after"], out_photo, out_mask)
    return out_photo, out_mask


def beside(photo: Array, is_lamp: Array, is_plane: Array) -> Array:
    """Returns the mean colour of the plane in a box three times as wide and as high as a lamp; black without plane. The
    sums are taken in the order of the pixels."""
    ys, xs = np.nonzero(is_lamp)
    x0, x1, y0, y1 = int(xs.min()), int(xs.max()) + 1, int(ys.min()), int(ys.max()) + 1
    window = np.s_[max(0, 2 * y0 - y1) : 2 * y1 - y0, max(0, 2 * x0 - x1) : 2 * x1 - x0]
    colours = photo[window][is_plane[window]].astype(float)
    if not len(colours):
        return np.zeros(photo.shape[2], np.float32)
    return np.asarray((np.add.accumulate(colours, axis=0)[-1] / len(colours)).astype(np.float32))


def put(
    photo: Array,
    mask: Array,
    is_lamp: Array,
    before: list[float],
    after: list[float],
    out_photo: Array,
    out_mask: Array,
) -> None:
    """Puts the pixels of a lamp from one quadrilateral of the photo into another."""
    height, width = mask.shape
    inverse = inverse_of(square_to(after))
    forward = square_to(before)
    xs, ys = after[0::2], after[1::2]
    across, down = BEYOND * (max(xs) - min(xs)), BEYOND * (max(ys) - min(ys))
    x0, x1 = max(0, math.floor(min(xs) - across)), min(width, math.floor(max(xs) + across) + 1)
    y0, y1 = max(0, math.floor(min(ys) - down)), min(height, math.floor(max(ys) + down) + 1)
    if x0 >= x1 or y0 >= y1:
        return
    x, y = np.arange(x0, x1)[None, :] + 0.5, np.arange(y0, y1)[:, None] + 0.5
    with np.errstate(all="ignore"):
        u, v = mapped(forward, *mapped(inverse, x, y))
        inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
    i, j = np.where(inside, u, 0).astype(int), np.where(inside, v, 0).astype(int)
    inside &= is_lamp[j, i]
    out_photo[y0:y1, x0:x1][inside] = photo[j[inside], i[inside]]
    out_mask[y0:y1, x0:x1][inside] = mask[j[inside], i[inside]]


def square_to(corners: list[float]) -> list[float]:
    """Returns the map, row by row, of the unit square to four corners (Heckbert 1989)."""
    x0, y0, x1, y1, x2, y2, x3, y3 = corners
    dx1, dy1, dx2, dy2 = x1 - x2, y1 - y2, x3 - x2, y3 - y2
    sx, sy = x0 - x1 + x2 - x3, y0 - y1 + y2 - y3
    below = dx1 * dy2 - dx2 * dy1
    g, h = (sx * dy2 - dx2 * sy) / below, (dx1 * sy - sx * dy1) / below
    return [x1 - x0 + g * x1, x3 - x0 + h * x3, x0, y1 - y0 + g * y1, y3 - y0 + h * y3, y0, g, h, 1.0]


def inverse_of(m: list[float]) -> list[float]:
    """Returns the adjugate of a map, which is its inverse up to a factor."""
    a, b, c, d, e, f, g, h, i = m
    first = [e * i - f * h, c * h - b * i, b * f - c * e]
    second = [f * g - d * i, a * i - c * g, c * d - a * f]
    return [*first, *second, d * h - e * g, b * g - a * h, a * e - b * d]


def mapped(m: list[float], x: Any, y: Any) -> tuple[Any, Any]:
    w = m[6] * x + m[7] * y + m[8]
    return (m[0] * x + m[1] * y + m[2]) / w, (m[3] * x + m[4] * y + m[5]) / w
