"""The part of the exemplar whose paint each object gets: the ball's, or the table's.

Objects such as furniture are painted like the ball, and what surrounds them, such as walls, floor and ceiling, like the
table. The guide of materials compares materials by their names, so each object gets materials that have the name of the
material of its part of the exemplar.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Vector

#: The names of the materials of LUXFER_DEMO_SPHERE_ON_TABLE.
BALL, TABLE = "Red", "White"
NAMES = {"BALL": BALL, "TABLE": TABLE}
#: Share of the size of the scene from which on an object counts as large along an axis. [convention]
LARGE = 0.5
#: Share of its largest side up to which the smallest side of an object counts as flat. [convention]
FLAT = 0.1


def extent(thing: bpy.types.Object) -> np.ndarray:
    """Returns the lower and the upper corner of an object's bounding box along the axes of the world."""
    corners = np.array([thing.matrix_world @ Vector(corner) for corner in thing.bound_box])
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def is_seen(thing: bpy.types.Object) -> bool:
    """Whether an object has surfaces that are rendered."""
    return thing.type in ("MESH", "CURVE", "SURFACE", "META", "FONT") and not thing.hide_render


def of(source: bpy.types.Scene) -> dict[str, str]:
    """Returns the name of the material of the exemplar for each object of a scene. Without a choice by the user, an
    object belongs to the surroundings if it is large along at least two axes, and is flat or has the camera in it."""
    extents = {thing.name: extent(thing) for thing in source.objects if is_seen(thing)}
    if not extents:
        return {}
    every = np.array(list(extents.values()))
    size = np.maximum(every[:, 1].max(axis=0) - every[:, 0].min(axis=0), 1e-6)
    eye = None if source.camera is None else np.array(source.camera.matrix_world.translation)
    out = {}
    for name, (low, high) in extents.items():
        sides = high - low
        is_large = (sides / size >= LARGE).sum() >= 2
        is_around = sides.min() <= FLAT * sides.max() or (eye is not None and bool(((low < eye) & (eye < high)).all()))
        found = "TABLE" if is_large and is_around else "BALL"
        chosen = source.objects[name].luxfer_paint_as
        out[name] = NAMES[found if chosen == "AUTOMATIC" else chosen]
    return out


class Renaming:
    """Gives the objects of a glTF document materials with the names of their parts."""

    def __init__(self, parts: dict[str, str]) -> None:
        self.parts = parts

    def __call__(self, document: dict[str, Any]) -> None:
        materials, meshes = document.setdefault("materials", []), document.get("meshes", [])
        made: dict[tuple[int | None, str], int] = {}

        def named(index: int | None, part: str) -> int:
            """Returns the index of the copy of a material that has the name of a part."""
            if (index, part) not in made:
                made[index, part] = len(materials)
                materials.append({**({} if index is None else materials[index]), "name": part})
            return made[index, part]

        for node in document.get("nodes", ()):
            part = self.parts.get(node.get("name", ""))
            if part is None or "mesh" not in node:
                continue
            mesh = meshes[node["mesh"]]  # objects may share it
            primitives = [{**p, "material": named(p.get("material"), part)} for p in mesh["primitives"]]
            node["mesh"] = len(meshes)
            meshes.append({**mesh, "primitives": primitives})
