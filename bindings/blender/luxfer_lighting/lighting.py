"""Operators of the lighting transfer: strokes, masks, the transfer itself, and the material that it creates."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import bpy
import luxfer
import numpy as np

from . import convert, work

STROKES, MASKS, TEXTURE, LAMPS = "Luxfer strokes", "Luxfer masks", "Luxfer light", "Luxfer luminaires"

#: For each kind of stroke, its colour, and its name and description in the interface.
COLOURS = {
    "PLANE": ((0.0, 1.0, 0.0), "Plane", "The plane that carries the lights"),
    "NOT_PLANE": ((1.0, 0.0, 0.0), "Not Plane", "Everything that is not on that plane"),
    "LIGHT": ((1.0, 1.0, 0.0), "Light", "Lights in the plane"),
    "NOT_LIGHT": ((0.0, 0.0, 1.0), "Not Light", "The plane beside the lights"),
}


@dataclass
class Result:
    """The result of a transfer, until it is applied."""

    object: str
    surface: luxfer.types.Surface
    texture: np.ndarray
    emission: tuple[float, float, float]  # cd/m² per channel where the texture is 1
    error: float


result: Result | None = None
#: Reasons to doubt the latest masks or transfer.
warnings: list[luxfer.StageWarning] = []


def prepared(scene: bpy.types.Scene) -> luxfer.Transfer:
    """Creates a transfer with the photo and the strokes of the scene."""
    settings = scene.luxfer
    if settings.photo is None:
        raise ValueError("choose a photo first")
    if settings.strokes is None:
        raise ValueError("paint strokes on the photo first")
    if tuple(settings.strokes.size) != tuple(settings.photo.size):
        raise ValueError("the strokes do not have the photo's size: use New Strokes")
    transfer = luxfer.Transfer(work.context(), convert.image(work.context(), settings.photo))
    transfer.set_strokes(convert.drawing(work.context(), settings.strokes))
    return transfer


def mask_steps(transfer: luxfer.Transfer, photo: np.ndarray) -> Generator[work.Step, Any, None]:
    yield from follow(transfer, transfer.start("view", "lights"))
    store_masks(photo, *masks(transfer))


def follow(transfer: luxfer.Transfer, job: work.Step) -> Generator[work.Step, Any, None]:
    """Waits for a job of a transfer and keeps its warnings, even if the job fails: they may explain the failure."""
    global warnings
    warnings = []
    try:
        yield job
    finally:
        try:
            warnings = transfer.warnings
        except luxfer.errors.NotReady:
            pass  # no stage has ended, so there are no warnings


def masks(transfer: luxfer.Transfer) -> tuple[np.ndarray, np.ndarray]:
    """The masks of the plane and of the lights, (height, width, 1)."""
    return transfer.image("plane-mask").numpy(), transfer.image("lights-mask").numpy()


def store_masks(photo: np.ndarray, plane: np.ndarray | None, lights: np.ndarray | None, pack: bool = True) -> None:
    """Stores the photo with the plane in green and the lights in yellow, if their masks are known, as an image."""
    tinted = photo.copy()
    if plane is not None:
        tinted += plane * (0.5 * (np.float32((0, 0.6, 0)) - tinted))
    if lights is not None:
        tinted += lights * (0.8 * (np.float32((1, 1, 0)) - tinted))
    convert.store(MASKS, tinted, linear=False, pack=pack)


def transfer_steps(
    transfer: luxfer.Transfer, photo: np.ndarray, room: luxfer.Scene, name: str, params: dict[str, Any], apply: bool
) -> Generator[work.Step, Any, None]:
    global result
    yield from follow(transfer, transfer.start("view", "relight", **params))
    store_masks(photo, *masks(transfer))
    lit = transfer.scene("lit")
    emission = lit.material(lit.counts.materials - 1)["emission"]  # the material of the lit surface is the last one
    texture = transfer.image("emission").numpy()
    result = Result(name, room.find_surface(name), texture, emission, transfer.solution.error)
    write_lamps(transfer.fixtures)
    if apply:
        bpy.ops.luxfer.apply("EXEC_DEFAULT", True)


def write_lamps(fixtures: list[luxfer.types.Fixture]) -> None:
    """Writes the lamps into a text of the .blend, in Blender's axes."""
    text = bpy.data.texts.get(LAMPS) or bpy.data.texts.new(LAMPS)
    lines = ["x_m,y_m,z_m,length_m,width_m,area_m2,red_cd_m2,green_cd_m2,blue_cd_m2,flux_lm"]
    for f in fixtures:
        x, y, z = f.position
        numbers = (x, -z, y, *f.size, f.area, *f.radiance, f.flux)
        lines.append(",".join(f"{n:.5g}" for n in numbers))
    text.from_string("\n".join(lines) + "\n")


class LUXFER_OT_new_strokes(bpy.types.Operator):
    """Make a pale copy of the photo to paint strokes on; replaces earlier strokes"""

    bl_idname = "luxfer.new_strokes"
    bl_label = "New Strokes"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.scene.luxfer.photo is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        photo = np.clip(convert.pixels(context.scene.luxfer.photo)[..., :3], 0, 1)
        # Keep all channels between 0.2 and 0.8, so that no pixel of the photo is mistaken for a stroke.
        context.scene.luxfer.strokes = convert.store(STROKES, 0.2 + 0.6 * photo, linear=False)
        return {"FINISHED"}


class LUXFER_OT_paint(bpy.types.Operator):
    """Paint strokes of this kind in the Image Editor"""

    bl_idname = "luxfer.paint"
    bl_label = "Paint"

    kind: bpy.props.EnumProperty(name="Kind", items=[(key, label, tip) for key, (_, label, tip) in COLOURS.items()])

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.scene.luxfer.strokes is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        for area in context.screen.areas if context.screen else ():
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = context.scene.luxfer.strokes
                area.spaces.active.mode = "PAINT"
                area.spaces.active.ui_mode = "PAINT"
        tools = context.tool_settings
        shared = getattr(tools.image_paint, "unified_paint_settings", None) or tools.unified_paint_settings
        brush = tools.image_paint.brush
        for target in (shared, brush):
            if target is not None:
                target.color = COLOURS[self.kind][0]
        if brush is not None:  # use a hard edge, because mixed colours are no strokes
            brush.blend = "MIX"
            brush.strength = 1
            for name in ("curve_distance_falloff_preset", "curve_preset"):
                if hasattr(brush, name):
                    setattr(brush, name, "CONSTANT")
                    break
        return {"FINISHED"}


class LUXFER_OT_preview_masks(work.Background, bpy.types.Operator):
    """Compute the masks of plane and lights from the strokes, as the image "Luxfer masks\""""

    bl_idname = "luxfer.preview_masks"
    bl_label = "Preview Masks"
    title = "Masks"

    def make(self, context: bpy.types.Context) -> tuple[Generator[work.Step, Any, None], int]:
        return mask_steps(prepared(context.scene), photo_pixels(context.scene)), 1


class LUXFER_OT_transfer(work.Background, bpy.types.Operator):
    """Put the lamps of the photo on the surface, with the strength that gives the surface the photo's colour"""

    bl_idname = "luxfer.transfer"
    bl_label = "Transfer Light"
    title = "Transfer"

    def make(self, context: bpy.types.Context) -> tuple[Generator[work.Step, Any, None], int]:
        return transfer_work(context.scene)


def transfer_work(scene: bpy.types.Scene) -> tuple[Generator[work.Step, Any, None], int]:
    """Reads all inputs of a transfer from Blender; returns its steps and their number."""
    settings = scene.luxfer
    if settings.target is None:
        raise ValueError("choose the surface that receives the lights first")
    transfer = prepared(scene)
    room, name = convert.scene(work.context(), scene), settings.target.name
    transfer.set_scene(room, name)
    pattern = {
        "scale": settings.scale.lower(),
        "length": settings.length,
        "margin": settings.margin if settings.keep_whole else -1.0,
    }
    params = {
        "max_texels": settings.texels,
        "plane_distance": settings.distance,
        "white_luminance": settings.white,
        "pattern": pattern,
    }
    return transfer_steps(transfer, photo_pixels(scene), room, name, params, settings.apply_when_done), 1


def photo_pixels(scene: bpy.types.Scene) -> np.ndarray:
    return convert.pixels(scene.luxfer.photo)[..., :3]


class LUXFER_OT_apply(bpy.types.Operator):
    """Assign the material of the last transfer to the surface"""

    bl_idname = "luxfer.apply"
    bl_label = "Apply Light"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return result is not None and result.object in bpy.data.objects

    def execute(self, context: bpy.types.Context) -> set[str]:
        thing = bpy.data.objects[result.object]
        faces = lay_out(thing, result.surface)
        if not faces:
            self.report({"ERROR"}, f"no face of {thing.name} lies in the surface any more: run the transfer again")
            return {"CANCELLED"}
        nits = max(*result.emission, 1e-9)
        colour = np.array(result.emission, np.float32) / nits
        image = convert.store(f"{TEXTURE} {thing.name}", result.texture * colour, linear=True)
        material = emissive(base_material(thing), image, nits)
        slot = next((i for i, s in enumerate(thing.material_slots) if s.material and "luxfer_base" in s.material), None)
        if slot is None:
            thing.data.materials.append(material)
            slot = len(thing.data.materials) - 1
        else:
            thing.data.materials[slot] = material
        for face in faces:
            thing.data.polygons[face].material_index = slot
        thing.data.update()
        return {"FINISHED"}


def lay_out(thing: bpy.types.Object, surface: luxfer.types.Surface) -> list[int]:
    """Finds the faces of an object that lie in a surface, and gives them the UV map "Luxfer", which covers the
    surface's rectangle. Returns the indices of the faces."""
    if thing.data.users > 1:
        thing.data = thing.data.copy()
    mesh = thing.data
    if not mesh.materials:
        mesh.materials.append(None)  # otherwise the new material would apply to all faces
    matrix = np.array(convert.TO_LUXFER @ thing.matrix_world)
    points = np.empty((len(mesh.vertices), 3))
    mesh.vertices.foreach_get("co", flat := np.empty(points.size, np.float32))
    points = flat.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    relative = points - surface.origin
    off = np.abs(relative @ surface.normal)
    inside = off < 1e-3 * max(surface.size)
    faces = [p.index for p in mesh.polygons if inside[list(p.vertices)].all()]

    layer = mesh.uv_layers.get("Luxfer") or mesh.uv_layers.new(name="Luxfer", do_init=False)
    u = relative @ surface.u_axis / surface.size[0]
    v = 1 - relative @ surface.v_axis / surface.size[1]  # in Blender, v points up
    for face in faces:
        for loop in mesh.polygons[face].loop_indices:
            vertex = mesh.loops[loop].vertex_index
            layer.uv[loop].vector = u[vertex], v[vertex]
    return faces


def base_material(thing: bpy.types.Object) -> bpy.types.Material | None:
    """The material that the surface had before it was lit."""
    materials = [slot.material for slot in thing.material_slots if slot.material is not None]
    lit = next((m for m in materials if "luxfer_base" in m), None)
    return bpy.data.materials.get(lit["luxfer_base"]) if lit else next(iter(materials), None)


def emissive(base: bpy.types.Material | None, image: bpy.types.Image, nits: float) -> bpy.types.Material:
    """Creates a copy of a material that emits image * nits."""
    material = base.copy() if base is not None else bpy.data.materials.new("Luxfer")
    material.name = f"{base.name if base is not None else 'Surface'} lit by Luxfer"
    material["luxfer_base"] = base.name if base is not None else ""
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    surface = next((n for n in nodes if n.type == "BSDF_PRINCIPLED"), None)
    if surface is None:
        surface = nodes.new("ShaderNodeBsdfPrincipled")
        output = next((n for n in nodes if n.type == "OUTPUT_MATERIAL"), None) or nodes.new("ShaderNodeOutputMaterial")
        links.new(surface.outputs["BSDF"], output.inputs["Surface"])

    uv = nodes.new("ShaderNodeUVMap")
    uv.uv_map = "Luxfer"
    texture = nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation, texture.extension = image, "Closest", "EXTEND"
    links.new(uv.outputs["UV"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], surface.inputs[convert.EMISSION])
    surface.inputs["Emission Strength"].default_value = nits
    uv.location = surface.location.x - 520, surface.location.y - 300
    texture.location = surface.location.x - 300, surface.location.y - 300
    return material


CLASSES = (LUXFER_OT_new_strokes, LUXFER_OT_paint, LUXFER_OT_preview_masks, LUXFER_OT_transfer, LUXFER_OT_apply)


def register() -> None:
    global warnings
    warnings = []
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    global result
    result = None
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
