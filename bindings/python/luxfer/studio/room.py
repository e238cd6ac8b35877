"""What follows from a room alone: its corners, its work plane, and a brightness for its pictures."""

from __future__ import annotations

import math
from typing import Any

import luxfer
import numpy as np

from ..cli.exits import Failure
from ..cli.plane import Plane, above_floor, level
from .project import Project

#: What the mean of a picture's surfaces becomes of display white [convention: half a stop over middle grey], and their
#: reflectance [convention: between the 0.2 to 0.7 of EN 12464-1 for floors and ceilings].
KEY, REFLECTANCE = 0.25, 0.45


def exposure_for(lux: float) -> float:
    """What to multiply a picture in cd/m² with, so that a room with that mean illuminance has a usual brightness."""
    return KEY * math.pi / (REFLECTANCE * lux) if lux > 1e-6 else 1.0


def pattern_of(project: Project) -> dict[str, Any]:
    """The settings of the library for the pattern of a project."""
    pattern = project["pattern"]
    return {
        "scale": pattern["scale"],
        "length": pattern["length"],
        "rotation": pattern["rotation"],
        "offset": pattern["offset"],
        "margin": 0.0 if pattern["keep_whole"] else -1.0,
    }


def bounds(room: luxfer.Scene) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """The lowest and the highest corner of a room."""
    points = [room.mesh_arrays(i)["positions"] for i in range(room.counts.meshes)]
    return np.min([p.min(0) for p in points if len(p)], 0), np.max([p.max(0) for p in points if len(p)], 0)


def work_plane(room: luxfer.Scene, surface: str) -> tuple[Plane, str]:
    """The plane of desks above the floor below a surface, as `luxfer lux` has it, and an empty text. Where there is no
    such plane, the reason, and a level plane halfway up, by which the brightness of pictures can be chosen."""
    try:
        return above_floor(room, surface), ""
    except Failure:
        low, high = ([float(x) for x in corner] for corner in bounds(room))
        reason = f'There is no plane of desks: "{surface}" is not level, or there is no floor below it.'
        return level((low[1] + high[1]) / 2, (low[0], low[2], high[0], high[2])), reason
