"""Helpers for the tests of the add-on: paths, a closed room in Blender, and renderings by Cycles."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "bindings" / "python"), str(ROOT / "bindings" / "blender")]

import bpy  # noqa: E402
import numpy as np  # noqa: E402

SIZE = (6.0, 4.0, 2.8)  # metres


def material(name: str, colour: tuple[float, float, float]) -> bpy.types.Material:
    """A matt material: roughness 1, no specular layer."""
    out = bpy.data.materials.new(name)
    out.use_nodes = True
    surface = next(n for n in out.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    surface.inputs["Base Color"].default_value = (*colour, 1)
    surface.inputs["Roughness"].default_value = 1
    surface.inputs["Specular IOR Level"].default_value = 0
    return out


def plane(name: str, corners: list[tuple[float, float, float]], look: bpy.types.Material) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.materials.append(look)
    out = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(out)
    return out


def build() -> bpy.types.Scene:
    """Builds a closed room in an empty .blend: coloured walls, a box, a camera that sees the floor and the ceiling."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    x, y, z = SIZE
    white, red, green = (
        material("White", (0.7, 0.7, 0.7)),
        material("Red", (0.6, 0.2, 0.15)),
        material("Green", (0.2, 0.5, 0.25)),
    )
    plane("Floor", [(0, 0, 0), (x, 0, 0), (x, y, 0), (0, y, 0)], white)
    plane("Ceiling", [(0, 0, z), (0, y, z), (x, y, z), (x, 0, z)], white)
    plane("Left", [(0, 0, 0), (0, y, 0), (0, y, z), (0, 0, z)], red)
    plane("Right", [(x, 0, 0), (x, 0, z), (x, y, z), (x, y, 0)], green)
    plane("Back", [(0, y, 0), (x, y, 0), (x, y, z), (0, y, z)], white)
    plane("Front", [(0, 0, 0), (0, 0, z), (x, 0, z), (x, 0, 0)], white)
    for wall in ("Back", "Front"):  # visible from both sides, as double-sided glTF materials
        bpy.data.objects[wall].data.materials[0].use_backface_culling = False
    lens = bpy.data.cameras.new("Camera")
    lens.lens = 14
    camera = bpy.data.objects.new("Camera", lens)
    camera.location = (x / 2, 0.05, z / 2)
    camera.rotation_euler = (np.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 72, 100
    return scene


def unbiased(scene: bpy.types.Scene) -> None:
    """Makes Cycles unbiased: removes the limits on light that it sets by default, and uses the pixel filter of
    luxfer."""
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = 64
    scene.cycles.sample_clamp_indirect = scene.cycles.sample_clamp_direct = 0
    scene.cycles.blur_glossy = 0
    scene.cycles.pixel_filter_type = "BOX"


def cycles(scene: bpy.types.Scene, samples: int) -> np.ndarray:
    """Renders the scene with Cycles; returns linear values, top row first."""
    unbiased(scene)
    scene.cycles.samples = samples
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "out.exr")
        bpy.ops.render.render(write_still=True)
        loaded = bpy.data.images.load(scene.render.filepath)
        loaded.colorspace_settings.name = "Linear Rec.709"
        width, height = loaded.size
        flat = np.empty(width * height * 4, np.float32)
        loaded.pixels.foreach_get(flat)
        bpy.data.images.remove(loaded)
    return flat.reshape(height, width, 4)[::-1, :, :3].copy()
