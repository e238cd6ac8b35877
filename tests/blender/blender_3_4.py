"""Lets the add-on run in Blender 3.4, where some of the functions of Blender 4.2 that it uses have other names.

Only for taking pictures of the add-on.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
from luxfer_lighting import convert


def fill_in() -> None:
    """Adapts Blender and the add-on to each other."""
    np.bool = bool  # Blender's importer of glTF is older than numpy
    convert.LINEAR, convert.EMISSION = "Linear", "Emission"
    bpy.types.UILayout.progress = progress
    bpy.types.MeshUVLoopLayer.uv = property(Coordinates)
    bpy.ops.export_scene = SimpleNamespace(gltf=export)


def progress(layout: bpy.types.UILayout, factor: float, text: str) -> None:
    """Shows a text instead of a progress bar."""
    layout.label(text=text)


class Coordinates:
    """Provides `layer.uv[k].vector`, which is `layer.data[k].uv` in Blender 3.4."""

    def __init__(self, layer: bpy.types.MeshUVLoopLayer):
        self._layer = layer

    def __getitem__(self, k: int) -> Coordinate:
        return Coordinate(self._layer.data[k])


class Coordinate:
    def __init__(self, loop: bpy.types.MeshUVLoop):
        self._loop = loop

    @property
    def vector(self) -> Any:
        return self._loop.uv

    @vector.setter
    def vector(self, value: Any) -> None:
        self._loop.uv = value


gltf = bpy.ops.export_scene.gltf


def export(export_import_convert_lighting_mode: str, **options: Any) -> set[str]:
    return gltf(convert_lighting_mode=export_import_convert_lighting_mode, **options)
