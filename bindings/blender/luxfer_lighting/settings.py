"""What is stored with the scene: photo, strokes, target and the few numbers that matter."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty


def is_mesh(_: bpy.types.PropertyGroup, thing: bpy.types.Object) -> bool:
    return thing.type == "MESH"


class LuxferSettings(bpy.types.PropertyGroup):
    """Settings of the add-on, at scene.luxfer."""

    photo: PointerProperty(type=bpy.types.Image, name="Photo", description="Photo of a lit interior")
    strokes: PointerProperty(
        type=bpy.types.Image,
        name="Strokes",
        description="Paint on it in pure colours: green the plane of the lights, red off it, yellow lights, blue the plane beside them",
    )
    target: PointerProperty(
        type=bpy.types.Object, name="Surface", poll=is_mesh, description="Object whose flat side receives the lights"
    )
    scale: EnumProperty(
        name="Scale",
        items=(
            ("DISTANCE", "Distance", "The distance of the photo's camera from the plane of the lights sets how large they are"),
            ("LAMP", "Lamp Length", "Lamps are of this length"),
            ("SPACING", "Spacing", "Lamps are this far apart"),
            ("ACROSS", "Lamps Across", "The surface is as many lamps wide as the photo's plane"),
        ),
        default="DISTANCE",
    )
    length: FloatProperty(
        name="Length",
        default=0.6,
        min=1e-3,
        max=1e4,
        subtype="DISTANCE",
        unit="LENGTH",
        description="Length of a lamp, or distance from one to the nearest other",
    )
    keep_whole: BoolProperty(
        name="Whole Lamps Only", default=False, description="Leave out lamps that the surface's edge would cut"
    )
    margin: FloatProperty(
        name="Margin",
        default=0.0,
        min=0.0,
        max=1e4,
        subtype="DISTANCE",
        unit="LENGTH",
        description="Distance that whole lamps keep from the surface's edge",
    )
    distance: FloatProperty(
        name="Distance",
        default=1.2,
        min=0.01,
        max=1e4,
        subtype="DISTANCE",
        unit="LENGTH",
        description="Distance of the photo's camera from the plane of the lights: the scale of the pattern",
    )
    white: FloatProperty(
        name="White", default=100.0, min=1e-3, max=1e6, description="Luminance in cd/m² that the photo's white stands for"
    )
    texels: IntProperty(
        name="Texture Size", default=1024, min=16, max=16384, description="Longest side of the emissive texture"
    )
    apply_when_done: BoolProperty(name="Apply When Done", default=True, description="Give the surface its new material at once")

    artwork: PointerProperty(
        type=bpy.types.Image, name="Artwork", description="The exemplar ball, painted over; same size as the exemplar"
    )
    preset: EnumProperty(
        name="Quality",
        items=(
            ("FAST", "Fast", "Nearly as good in half the time"),
            ("FULL", "Full", "Full quality"),
            ("PREVIEW", "Preview", "Half resolution, for watching while painting"),
        ),
        default="FAST",
    )
    guides_by: EnumProperty(
        name="Guides",
        items=(
            ("LUXFER", "Luxfer", "What glTF can say of the scene, rendered by the library: exact light paths"),
            ("CYCLES", "Cycles", "The scene as Cycles sees it, rendered by a second Blender on a copy of the file"),
        ),
        default="LUXFER",
        description="Who renders what the light does in the scene",
    )
    guide_samples: IntProperty(name="Samples", default=32, min=1, max=65536, description="Paths per pixel of the guides")
    exemplar_width: IntProperty(name="Width", default=480, min=32, max=8192, description="Width of the exemplar in pixels")
    exemplar_height: IntProperty(name="Height", default=360, min=32, max=8192, description="Height of the exemplar in pixels")


def register() -> None:
    bpy.utils.register_class(LuxferSettings)
    bpy.types.Scene.luxfer = PointerProperty(type=LuxferSettings)


def unregister() -> None:
    del bpy.types.Scene.luxfer
    bpy.utils.unregister_class(LuxferSettings)
