"""What follows from a room alone: its corners, its work plane, and a brightness for its pictures."""

from __future__ import annotations

import math
from typing import Any

import luxfer
import numpy as np

from .project import Project

#: Height of the work plane over the floor, and its distance from the walls, in metres [convention: EN 12464-1].
WORK_PLANE, WALL_ZONE = 0.8, 0.5
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


def work_plane(room: luxfer.Scene, surface: str) -> tuple[dict[str, Any], tuple[float, float]]:
    """The calculation grid below a surface, and its sides in metres."""
    placed = room.find_surface(surface)
    low, high = bounds(room)
    inset = min(WALL_ZONE, 0.2 * min(placed.size))
    u, v = np.array(placed.u_axis), np.array(placed.v_axis)
    metres = (placed.size[0] - 2 * inset, placed.size[1] - 2 * inset)
    origin = np.array(placed.origin) + inset * (u + v)
    origin[1] = low[1] + min(WORK_PLANE, 0.4 * (high[1] - low[1]))
    return {"origin": tuple(origin), "across": tuple(u * metres[0]), "down": tuple(v * metres[1])}, metres
