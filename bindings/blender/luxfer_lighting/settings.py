"""The settings that the .blend stores with each scene: photo, strokes, target and some numbers."""

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
            ("DISTANCE", "Distance", "Size of the lamps by the distance of the photo's camera from their plane"),
            ("LAMP", "Lamp Length", "Size of the lamps by the length of a lamp"),
            ("SPACING", "Spacing", "Size of the lamps by the distance between neighbours"),
            ("ACROSS", "Lamps Across", "Size of the lamps by the width of the surface: as many lamps across as in the photo"),
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
        description="Length of a lamp, or distance to its nearest neighbour",
    )
    keep_whole: BoolProperty(
        name="Whole Lamps Only", default=False, description="Leave out lamps that the edge of the surface would cut"
    )
    margin: FloatProperty(
        name="Margin",
        default=0.0,
        min=0.0,
        max=1e4,
        subtype="DISTANCE",
        unit="LENGTH",
        description="Minimum distance of whole lamps from the edge of the surface",
    )
    distance: FloatProperty(
        name="Distance",
        default=0,
        min=0,
        max=1e4,
        subtype="DISTANCE",
        unit="LENGTH",
        description="Distance of the photo's camera from the plane of the lights, which sets the scale of the "
        "pattern; 0: estimated from the size of the lamps",
    )
    white: FloatProperty(
        name="White", default=100.0, min=1e-3, max=1e6, description="Luminance of the photo's white in cd/m²"
    )
    texels: IntProperty(
        name="Texture Size", default=1024, min=16, max=16384, description="Longest side of the emissive texture"
    )
    apply_when_done: BoolProperty(
        name="Apply When Done", default=True, description="Assign the new material to the surface after the transfer"
    )

    artwork: PointerProperty(
        type=bpy.types.Image, name="Artwork", description="The exemplar after painting, of the size of the exemplar"
    )
    preset: EnumProperty(
        name="Quality",
        items=(
            ("FAST", "Fast", "Nearly full quality in half the time"),
            ("FULL", "Full", "Full quality"),
            ("PREVIEW", "Preview", "Half resolution, for feedback while painting"),
        ),
        default="FAST",
    )
    guides_by: EnumProperty(
        name="Guides",
        items=(
            ("LUXFER", "Luxfer", "Rendered by the library from a glTF export of the scene: exact light paths"),
            ("CYCLES", "Cycles", "Rendered by Cycles in a second Blender, on a copy of the file: all Blender features"),
        ),
        default="LUXFER",
        description="Renderer of the guides, which show the light in the scene",
    )
    guide_samples: IntProperty(name="Samples", default=32, min=1, max=65536, description="Paths per pixel of the guides")
    match_light: FloatProperty(
        name="Match Light",
        default=1,
        min=0,
        max=1,
        subtype="FACTOR",
        description="Maps the bright and dark places of the scene to the bright and dark places of the ball: 0 leaves "
        "the light as it is",
    )
    guide_parts: BoolProperty(
        name="Objects Like the Ball",
        default=True,
        description="Paints objects like the ball, and what surrounds them, such as walls and floors, like the table; "
        "otherwise light alone decides",
    )
    guide_edges: BoolProperty(name="Edges", default=True, description="Keeps edges of shapes finer than the strokes")
    exemplar_width: IntProperty(name="Width", default=480, min=32, max=8192, description="Width of the exemplar in pixels")
    exemplar_height: IntProperty(name="Height", default=360, min=32, max=8192, description="Height of the exemplar in pixels")


def register() -> None:
    bpy.utils.register_class(LuxferSettings)
    bpy.types.Scene.luxfer = PointerProperty(type=LuxferSettings)
    bpy.types.Object.luxfer_paint_as = EnumProperty(
        name="Paint",
        items=(
            ("AUTOMATIC", "Automatic", "Objects as large as walls and floors like the table, all others like the ball"),
            ("BALL", "Like the Ball", "With the paint of the ball"),
            ("TABLE", "Like the Table", "With the paint of the table"),
        ),
        description="Part of the artwork whose paint this object gets",
    )
    bpy.types.Object.luxfer_artwork = PointerProperty(
        type=bpy.types.Image,
        name="Artwork",
        description="The exemplar after painting for this object and for the objects parented to it, if it is not that of the scene",
    )


def unregister() -> None:
    del bpy.types.Object.luxfer_artwork
    del bpy.types.Object.luxfer_paint_as
    del bpy.types.Scene.luxfer
    bpy.utils.unregister_class(LuxferSettings)
