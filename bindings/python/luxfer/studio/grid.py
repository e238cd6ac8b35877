"""The grid of the plane as the user has dragged it: four corners of a rectangle on the plane, in the photo.

They determine the vanishing points of the two directions along the plane, and with them the camera. The library finds
cameras only from lines, so it gets a drawing whose lines run to these vanishing points.
"""

from __future__ import annotations

import math
from typing import Any

import luxfer
import numpy as np

from .project import Invalid

#: A focal length that the corners determine is used within these bounds, as shares of the photo's longer side: a full
#: angle of view of 120 to 7 degrees. Otherwise the focal length that the library found stays. [convention: lenses of
#: photos of rooms]
FOCAL = 0.29, 8.0
#: Corners are dragged to within this share of the longer side. If the focal length then remains uncertain by more than
#: the second number, relatively, the focal length that the library found stays. [convention: 2 pixels of a picture that
#: is 800 pixels wide on screen]
DRAG_ERROR, MAX_SPREAD = 1 / 400, 0.1
#: Side of the cells of the drawing in pixels, and the bounds of their number along the longer side. In each cell, one
#: line runs to one of the three points. From more, shorter lines the library finds less exact directions.
CELL, MIN_CELLS, MAX_CELLS = 60, 5, 10
#: Half of the width of a line in pixels, its half length as a share of the cell, and its contrast.
HALF_WIDTH, HALF_LENGTH, CONTRAST = 3.0, 0.48, 1.5
#: Directions that the library finds in the drawing may differ from the wanted ones by this angle in radians.
MAX_DIFFERENCE = 0.03


def camera_of(corners: list[float], size: tuple[int, int], found_focal: float) -> tuple[np.ndarray[Any, Any], float]:
    """Returns the directions of the room axes in camera space, one in each row, and the focal length in pixels. The
    first two run along the sides of the rectangle."""
    points = np.column_stack((np.reshape(corners, (4, 2)), np.ones(4)))
    sides = np.roll(points, -1, axis=0) - points
    turns = [float(np.cross(sides[i], sides[(i + 1) % 4])[2]) for i in range(4)]
    if not (min(turns) > 0 or max(turns) < 0):
        raise Invalid("the corners of the grid do not form a rectangle seen in perspective: drag one of them back")
    first, second = vanishing_points(points)
    centre = np.array(size) / 2
    focal = focal_of(points, centre, max(size)) or found_focal
    directions = [np.array([*(p[:2] - p[2] * centre), focal * p[2]]) for p in (first, second)]
    a, b = (d / np.linalg.norm(d) for d in directions)
    if abs(a @ b) > math.cos(math.radians(20)):
        raise Invalid("the grid is seen too much edge-on: drag its corners apart")
    # The nearest orthogonal directions, each turned by the same angle.
    sum_, difference = a + b, a - b
    sum_, difference = sum_ / np.linalg.norm(sum_), difference / np.linalg.norm(difference)
    a, b = (sum_ + difference) / math.sqrt(2), (sum_ - difference) / math.sqrt(2)
    return np.array([a, b, np.cross(a, b)]), focal


def vanishing_points(points: np.ndarray[Any, Any]) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Returns the homogeneous points in which opposite sides of a rectangle meet."""
    lines = [np.cross(points[i], points[(i + 1) % 4]) for i in range(4)]
    return np.cross(lines[0], lines[2]), np.cross(lines[1], lines[3])


def focal_of(points: np.ndarray[Any, Any], centre: np.ndarray[Any, Any], longer: int) -> float | None:
    """Returns the focal length with which the sides of a rectangle are orthogonal; None if small changes of its corners
    change it much, as in a photo taken straight on."""

    def logarithm(places: np.ndarray[Any, Any]) -> float:
        first, second = vanishing_points(places)
        product = (first[:2] - first[2] * centre) @ (second[:2] - second[2] * centre)
        weight = first[2] * second[2]
        square = -product / weight if weight else math.nan
        return math.log(square) / 2 if square > 0 else math.nan

    found, spread = logarithm(points), 0.0
    for i in range(4):
        for k in range(2):
            changed = points.copy()
            changed[i, k] += DRAG_ERROR * longer
            spread += (logarithm(changed) - found) ** 2
    if not (spread <= MAX_SPREAD**2 and FOCAL[0] * longer <= math.exp(found) <= FOCAL[1] * longer):
        return None
    return math.exp(found)


def drawing(axes: list[list[float]], focal: float, width: int, height: int) -> np.ndarray[Any, Any]:
    """Returns a grey picture of lines to the vanishing points of three directions in camera space. Its values come from
    +, -, * and / alone, and square roots, so that a program in C draws the same picture."""
    cells = min(max(max(width, height) // CELL, MIN_CELLS), MAX_CELLS)
    side = max(width, height) / cells
    columns, rows = max(1, int(width / side + 0.5)), max(1, int(height / side + 0.5))
    out = np.full((height, width), 0.5)
    for j in range(rows):
        for i in range(columns):
            x, y = (i + 0.5) * width / columns, (j + 0.5) * height / rows
            axis = axes[(i + j) % 3]
            dx = focal * axis[0] + (width / 2 - x) * axis[2]
            dy = focal * axis[1] + (height / 2 - y) * axis[2]
            length = math.sqrt(dx * dx + dy * dy)
            if length <= side * abs(axis[2]):
                continue  # lines near a vanishing point run in all directions
            dx, dy = dx / length, dy / length
            left, right = i * width // columns, (i + 1) * width // columns
            top, bottom = j * height // rows, (j + 1) * height // rows
            px = np.arange(left, right) + 0.5 - x
            py = np.arange(top, bottom)[:, None] + 0.5 - y
            along = (px * dx + py * dy) / (HALF_LENGTH * side)
            across = (py * dx - px * dy) / HALF_WIDTH
            near, inside = np.maximum(0, 1 - across * across), np.maximum(0, 1 - along * along)
            out[top:bottom, left:right] = 0.5 + CONTRAST * across * near * near * inside
    return np.repeat(out[..., None].astype(np.float32), 3, axis=2)


def rectify_of(
    context: luxfer.Context, axes: list[list[float]], focal: float, size: tuple[int, int]
) -> tuple[luxfer.Rectify, list[int]]:
    """Returns the library's camera for given directions of the room axes, whose first two span the plane, and the
    indices of these two in it."""
    rectify = luxfer.Rectify(context, drawing(axes, focal, *size)).run(focal=focal, distortion=0)
    alike = np.abs(np.array(axes) @ np.array(rectify.report.axes).T)
    if alike.max(axis=1).min() < math.cos(MAX_DIFFERENCE) or len(set(alike.argmax(axis=1))) < 3:
        raise Invalid("the grid does not fit a camera: drag its corners so that it lies on the plane as tiles would")
    return rectify, [int(i) for i in alike.argmax(axis=1)[:2]]


def use(transfer: luxfer.Transfer, axes: list[list[float]], focal: float, size: tuple[int, int]) -> list[int]:
    """Replaces the camera of a transfer, and returns the setting `plane_axes` for its stage "unwarp"."""
    rectify, plane_axes = rectify_of(transfer.context, axes, focal, size)
    transfer.use_rectify(rectify)
    return plane_axes
