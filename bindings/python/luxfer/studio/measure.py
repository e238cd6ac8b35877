"""The plane on which the page shows the illuminance, and its numbers."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any

import luxfer
import numpy as np

from ..cli.exits import Failure
from ..cli.plane import Plane, above_floor, on_surface
from .project import Project
from .room import work_plane

#: Points of the calculation grid on its longer side, and paths for each.
LUX_POINTS, LUX_SAMPLES = 24, 64
#: Maximum number of names of surfaces that the page offers. [convention]
MAX_NAMES = 200


def surfaces(room: luxfer.Scene) -> list[str]:
    """Returns the names of the objects of a room, without doubles, in the order of the file."""
    names = (room.mesh_name(i) for i in range(room.counts.meshes))
    return list(dict.fromkeys(name for name in names if name))[:MAX_NAMES]


def chosen_plane(room: luxfer.Scene, ceiling: str, project: Project) -> tuple[Plane | None, str]:
    """Returns the plane that the project chooses, and an empty text; or no plane, and the reason."""
    wanted = project["lux_plane"]
    if wanted["surface"] is None:
        try:
            return above_floor(room, ceiling, wanted["height"]), ""
        except Failure:
            return None, work_plane(room, ceiling)[1]
    try:
        return on_surface(room, wanted["surface"]), ""
    except luxfer.Error as error:
        return None, f'There is no illuminance of "{wanted["surface"]}": {error}. Choose another plane.'


def points(plane: Plane) -> tuple[int, int]:
    """Returns the columns and rows of the calculation grid."""
    cell = max(plane.sides) / LUX_POINTS
    columns, rows = (max(1, round(side / cell)) for side in plane.sides)
    return columns, rows


def ranges(values: Any, errors: Any) -> dict[str, list[float]]:
    """Returns 95 % intervals of the smallest and of the largest of many values with standard errors. The noise of all
    values moves both, so all values lie within the bounds together with this probability (Šidák's correction)."""
    width = NormalDist().inv_cdf((1 + 0.95 ** (1 / len(values))) / 2) * errors
    low, high = np.maximum(values - width, 0), values + width
    pairs = {"minimum_range": (low.min(), high.min()), "maximum_range": (low.max(), high.max())}
    return {name: [float(bound) for bound in pair] for name, pair in pairs.items()}


def numbers(result: luxfer.Illuminance) -> dict[str, Any]:
    """Returns values and statistics of a calculation. No light at all reaches points inside of furniture, which
    therefore do not count."""
    report = result.report
    values = result.image("lux").numpy()[..., 0]
    lit, errors = values[values > 0], result.image("error").numpy()[..., 0][values > 0]
    scale = values.size / max(1, lit.size)
    return {
        "values": [[round(float(v), 1) for v in row] for row in values],
        "inside": values.size - lit.size,
        "minimum": float(lit.min()) if lit.size else 0.0,
        "mean": report.mean * scale,
        "maximum": report.maximum,
        "error": 1.96 * report.mean_error * scale,
        **(ranges(lit, errors) if lit.size else {"minimum_range": [0.0, 0.0], "maximum_range": [0.0, 0.0]}),
    }


def place(room: luxfer.Scene, ceiling: str, plane: Plane, project: Project) -> dict[str, Any]:
    """Returns where a plane lies, for the words of the page."""
    wanted = project["lux_plane"]
    if wanted["surface"] is not None:
        return {"size": plane.sides, "surface": wanted["surface"]}
    sides = room.find_surface(ceiling).size
    return {
        "size": plane.sides,
        "height": wanted["height"],
        "floor": plane.origin[1] - wanted["height"],
        "insets": [(whole - side) / 2 for whole, side in zip(sides, plane.sides)],
    }


def is_default(project: Project) -> bool:
    """Whether the project chooses the plane by which pictures get their exposure."""
    from ..cli.plane import DESK

    return project["lux_plane"] == {"surface": None, "height": DESK}
