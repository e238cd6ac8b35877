"""Converts Blender's images, scenes and cameras to luxfer's, and images back.

Blender has Z up and rows from the bottom; luxfer has Y up and rows from the top.
"""

from __future__ import annotations

import contextlib
import json
import logging
import math
import os
import struct
import tempfile
from collections.abc import Callable, Iterator
from typing import Any

import bpy
import luxfer
import numpy as np
from mathutils import Matrix, Vector

#: Converts Blender's axes to luxfer's: (x, y, z) becomes (x, z, -y).
TO_LUXFER = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
TO_BLENDER = TO_LUXFER.transposed()

#: Blender's names for the colour space of luxfer's pictures, and for the emission input of a Principled BSDF.
LINEAR, EMISSION = "Linear Rec.709", "Emission Color"


def pixels(image: bpy.types.Image) -> np.ndarray:
    """Copies the pixels of an image to an array (height, width, channels), top row first."""
    width, height = image.size
    if not width or not height:
        raise ValueError(f"the image {image.name} has no pixels")
    flat = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(height, width, image.channels)[::-1]


def image(context: luxfer.Context, source: bpy.types.Image) -> luxfer.Image:
    """Converts an image; decodes it to linear values if it is encoded."""
    encoded = not source.is_float and source.colorspace_settings.name == "sRGB"
    values = pixels(source)
    return luxfer.Image(context, values[..., : min(3, values.shape[2])], "srgb" if encoded else "linear")


def drawing(context: luxfer.Context, source: bpy.types.Image) -> luxfer.Image:
    """Converts the image of strokes without decoding: pure colours stay pure in any encoding."""
    return luxfer.Image(context, pixels(source)[..., :3])


def store(name: str, values: np.ndarray, linear: bool, pack: bool = True) -> bpy.types.Image:
    """Stores pixels (height, width, channels), top row first, as the Blender image of that name: floats if linear,
    else 8-bit sRGB. With pack, the image is packed into the .blend; not needed for images that will soon be
    replaced."""
    height, width, channels = values.shape
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = values[::-1] if channels == 3 else values[::-1, :, :1]
    out = bpy.data.images.get(name)
    if out is None or tuple(out.size) != (width, height) or out.is_float != linear:
        if out is not None:
            bpy.data.images.remove(out)
        out = bpy.data.images.new(name, width, height, alpha=False, float_buffer=linear)
    out.colorspace_settings.name = LINEAR if linear else "sRGB"
    out.pixels.foreach_set(rgba.ravel())
    out.update()
    if pack:
        out.pack()
    return out


def scene(
    context: luxfer.Context, source: bpy.types.Scene, change: Callable[[dict[str, Any]], None] | None = None
) -> luxfer.Scene:
    """Converts the current scene with modifiers applied, through a temporary glTF file, whose JSON document `change`
    may edit. Adds area lights and the world's colour, which glTF cannot store. One unit of strength becomes one
    cd/m²."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.glb")
        with without_log():
            bpy.ops.export_scene.gltf(
                filepath=path,
                export_format="GLB",
                export_apply=True,
                export_yup=True,
                export_cameras=True,
                export_lights=True,
                export_import_convert_lighting_mode="COMPAT",
                export_animations=False,
                use_active_scene=True,
                use_renderable=True,
            )
        with open(path, "rb") as file:
            out = luxfer.Scene.from_bytes(context, edited(file.read(), specular_levels, change))
    for thing in source.objects:
        if thing.type == "LIGHT" and thing.data.type == "AREA" and not thing.hide_render:
            add_area_light(out, thing)
        elif thing.type == "MESH" and not thing.hide_render:
            place_light(context, out, thing)
    colour = world_colour(source)
    if any(colour):
        out.set_environment(colour)
    return out


@contextlib.contextmanager
def without_log() -> Iterator[None]:
    """Keeps the exporter from writing a line for every object into the terminal. Its warnings and errors remain."""
    before = logging.root.manager.disable
    logging.disable(max(before, logging.INFO))
    try:
        yield
    finally:
        logging.disable(before)


def edited(glb: bytes, *changes: Callable[[dict[str, Any]], None] | None) -> bytes:
    """Returns a GLB file after changes of its JSON document."""
    length, _ = struct.unpack_from("<II", glb, 12)
    document = json.loads(glb[20 : 20 + length])
    for change in filter(None, changes):
        change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = glb[20 + length :]
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    return head + text + rest


def specular_levels(document: dict[str, Any]) -> None:
    """Replaces the specular factors (KHR_materials_specular) by the index of refraction with equal reflectance at
    normal incidence, as Cycles does: at grazing angles, the reflectance then stays 1. The colours of the reflections
    remain."""
    for material in document.get("materials", ()):
        extensions = material.get("extensions", {})
        specular = extensions.get("KHR_materials_specular", {})
        if "specularFactor" not in specular or "specularTexture" in specular:
            continue
        factor = specular.pop("specularFactor")
        ior = extensions.get("KHR_materials_ior", {}).get("ior", 1.5)
        root = abs(ior - 1) / (ior + 1) * math.sqrt(factor)
        extensions["KHR_materials_ior"] = {"ior": (1 + root) / (1 - root)}
    used = document.setdefault("extensionsUsed", [])
    if "KHR_materials_ior" not in used:
        used.append("KHR_materials_ior")


def place_light(context: luxfer.Context, out: luxfer.Scene, thing: bpy.types.Object) -> None:
    """Adds the emission that the add-on has put on an object, from its floating-point image; glTF would round it to 8
    bits."""
    for slot in thing.material_slots:
        if slot.material is None or "luxfer_base" not in slot.material:
            continue
        nodes = slot.material.node_tree.nodes
        surface = next((n for n in nodes if n.type == "BSDF_PRINCIPLED" and n.inputs[EMISSION].is_linked), None)
        texture = surface.inputs[EMISSION].links[0].from_node if surface else None
        if texture is not None and texture.type == "TEX_IMAGE" and texture.image is not None:
            nits = surface.inputs["Emission Strength"].default_value
            out.place_emission(thing.name, image(context, texture.image), (nits, nits, nits))


def add_area_light(out: luxfer.Scene, thing: bpy.types.Object) -> None:
    """Adds an area light as a mesh with the radiance that the light has in Cycles: power / (pi area)."""
    light = thing.data
    width = light.size
    height = light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else light.size
    if light.shape in ("DISK", "ELLIPSE"):
        turns = np.linspace(0, -2 * np.pi, 64, endpoint=False)
        outline = [(math.cos(t) / 2, math.sin(t) / 2) for t in turns]
        share = math.pi / 4
    else:
        outline = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)]
        share = 1.0
    matrix = TO_LUXFER @ thing.matrix_world
    corners = [matrix @ Vector((x * width, y * height, 0)) for x, y in outline]
    sides = matrix.to_3x3() @ Vector((width, 0, 0)), matrix.to_3x3() @ Vector((0, height, 0))
    area = share * sides[0].cross(sides[1]).length
    if area > 0:
        emission = [light.energy * c / (math.pi * area) for c in light.color]
        material = out.add_material(name=thing.name, base_color=(0, 0, 0), emission=emission, double_sided=0)
        fan = [[0, k, k + 1] for k in range(1, len(corners) - 1)]
        out.add_mesh(np.array(corners, np.float32), fan, material=material, name=thing.name)


def world_colour(source: bpy.types.Scene) -> tuple[float, float, float]:
    """The background of the world if it is a uniform colour, else black."""
    world = source.world
    if world is None:
        return 0.0, 0.0, 0.0
    if world.use_nodes and world.node_tree:
        for node in world.node_tree.nodes:
            if node.type == "BACKGROUND" and not node.inputs["Color"].is_linked:
                strength = node.inputs["Strength"].default_value
                return tuple(strength * c for c in node.inputs["Color"].default_value[:3])
        return 0.0, 0.0, 0.0
    return tuple(world.color)


def camera(source: bpy.types.Scene) -> dict[str, Any] | None:
    """The active camera as camera settings of luxfer; None without a camera."""
    thing = source.camera
    if thing is None or thing.type != "CAMERA":
        return None
    frame = thing.data.view_frame(scene=source)
    top, distance = max(corner.y for corner in frame), -frame[0].z
    matrix = TO_LUXFER @ thing.matrix_world
    position = matrix.translation
    return {
        "fov_y": 2 * math.atan2(top, distance),
        "position": tuple(position),
        "target": tuple(position - matrix.to_3x3() @ Vector((0, 0, 1))),
        "up": tuple((matrix.to_3x3() @ Vector((0, 1, 0))).normalized()),
    }


def resolution(source: bpy.types.Scene) -> tuple[int, int]:
    """Width and height of the scene's renderings."""
    share = source.render.resolution_percentage / 100
    return max(1, round(source.render.resolution_x * share)), max(1, round(source.render.resolution_y * share))
