"""Properties of a room: its corners, its work plane, and an exposure for its pictures."""

from __future__ import annotations

import math
from typing import Any

import luxfer
import numpy as np

from ..cli.exits import Failure
from ..cli.plane import Plane, above_floor, level
from .project import Project

#: KEY: the value, relative to display white, of a surface with the room's mean illuminance [convention: half a stop
#: above middle grey]. REFLECTANCE: the assumed reflectance of this surface [convention: between floors (0.2)
#: and ceilings (0.7) in EN 12464-1].
KEY, REFLECTANCE = 0.25, 0.45
#: Maximum side of the emissive texture in texels.
MAX_TEXELS = 1024


def exposure_for(lux: float) -> float:
    """Returns the factor for a picture in cd/m² by which a room of this mean illuminance gets the usual brightness."""
    return KEY * math.pi / (REFLECTANCE * lux) if lux > 1e-6 else 1.0


def pattern_of(pattern: dict[str, Any]) -> dict[str, Any]:
    """Returns a pattern of a project as settings of the library."""
    return {
        "scale": pattern["scale"],
        "length": pattern["length"],
        "rotation": pattern["rotation"],
        "offset": pattern["offset"],
        "margin": 0.0 if pattern["keep_whole"] else -1.0,
    }


def texture_settings(project: Project, distance: tuple[float, float] | None = None) -> dict[str, Any]:
    """Returns the settings of a transfer's texture but its pattern; `distance` is that from the plane, if lamps have
    been reshaped."""
    kept = {} if distance is None else {"plane_distance": distance[0]}
    return {"max_texels": MAX_TEXELS, **kept, "white_luminance": project["white"]}


def rectangle(room: luxfer.Scene, name: str) -> dict[str, Any] | None:
    """Returns the bounding rectangle of a planar surface, as the page draws it; None if no such plane is found."""
    try:
        found = room.find_surface(name)
    except luxfer.Error:
        return None
    return {k: getattr(found, k) for k in ("origin", "u_axis", "v_axis", "normal", "size")}


def bounds(room: luxfer.Scene) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Returns the lowest and the highest corner of the bounding box of a room."""
    points = [room.mesh_arrays(i)["positions"] for i in range(room.counts.meshes)]
    return np.min([p.min(0) for p in points if len(p)], 0), np.max([p.max(0) for p in points if len(p)], 0)


def work_plane(room: luxfer.Scene, surface: str) -> tuple[Plane, str]:
    """Returns the plane of desks above the floor below a surface, as `luxfer lux` chooses it, and an empty text. If
    there is no such plane, returns a level plane at half the height of the room, for the choice of the exposure, and
    the reason."""
    try:
        return above_floor(room, surface), ""
    except Failure:
        low, high = ([float(x) for x in corner] for corner in bounds(room))
        reason = f'There is no plane of desks: "{surface}" is not level, or there is no floor below it.'
        return level((low[1] + high[1]) / 2, (low[0], low[2], high[0], high[2])), reason
