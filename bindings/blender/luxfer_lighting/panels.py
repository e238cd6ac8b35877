"""Three panels in the sidebar of the 3D view and the Image Editor."""

from __future__ import annotations

import bpy
import luxfer

from . import artworks, lighting, live, painting, work


#: Icons in the colours of the strokes: icons of bone colour sets, which every version of Blender has.
ICONS = {"PLANE": "COLORSET_03_VEC", "NOT_PLANE": "COLORSET_01_VEC", "LIGHT": "COLORSET_09_VEC", "NOT_LIGHT": "COLORSET_04_VEC"}


#: Titles of the stages of a transfer.
STAGES = {
    "SCENE": "Scene",
    "VIEW": "Camera",
    "FEATURES": "Depth",
    "PLANE": "Plane",
    "LIGHTS": "Lights",
    "UNWARP": "Plane Seen Straight On",
    "EMISSION": "Texture",
    "RELIGHT": "Strength",
    "RENDER": "Picture",
}


def show_progress(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The progress of the running work and a button to cancel it, or the message of the last work."""
    running = work.current()
    if running is not None:
        row = layout.row(align=True)
        row.progress(factor=running.progress, text=f"{running.title} {running.progress:.0%}")
        row.operator("luxfer.cancel", text="", icon="X")
    elif work.message:
        draw_text(layout, context, work.message, alert=work.message != "Cancelled")


def draw_text(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, alert: bool = False) -> None:
    """Shows a text, broken into lines that fit the width of the sidebar."""
    column = layout.column(align=True)
    column.alert = alert
    width = 280
    if context.region is not None:
        width = context.region.width / context.preferences.system.ui_scale
    for line in lines(text, max(16, int((width - 60) / 6))):  # pixels: 6 per letter, 60 for tabs and margins
        column.label(text=line)


def lines(text: str, width: int) -> list[str]:
    """Breaks a text into lines of less than `width` letters; a longer word gets a line of its own."""
    out = [""]
    for word in text.split():
        if len(out[-1]) + len(word) >= width:
            out.append("")
        out[-1] = f"{out[-1]} {word}".strip()
    return out


def show_warnings(layout: bpy.types.UILayout, context: bpy.types.Context, warnings: list[luxfer.StageWarning]) -> None:
    """Shows the warnings of a result, each with its remedy and its place in the photo."""
    for warning in warnings:
        box = layout.box()
        box.label(text=STAGES[warning.stage.name], icon="ERROR")
        draw_text(box, context, f"{warning.message[:1].upper()}{warning.message[1:]}.")
        at = "" if warning.place is None else f", at {warning.place[0]:.0f}, {warning.place[1]:.0f} from the photo's top left"
        draw_text(box, context, f"{warning.advice[:1].upper()}{warning.advice[1:]}{at}.")


def show_object(box: bpy.types.UILayout, thing: bpy.types.Object, has_parts: bool) -> None:
    """Shows how the active object is painted: like which part, and by which artwork."""
    box.label(text=thing.name, icon="OBJECT_DATA")
    if has_parts:
        box.prop(thing, "luxfer_paint_as")
    box.label(text="Artwork of its own")
    box.template_ID(thing, "luxfer_artwork", open="image.open")
    box.operator_menu_enum("luxfer.sample_artwork", "style").for_object = True
    inherited = artworks.of(thing)
    if inherited is not None and thing.luxfer_artwork is None:
        box.label(text=f"From its parent: {inherited.name}")


class Sidebar:
    bl_region_type = "UI"
    bl_category = "Luxfer"


class LightingPanel(Sidebar):
    bl_label = "Lighting from a Photo"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.luxfer
        layout.template_ID(settings, "photo", open="image.open")
        box = layout.column(align=True)
        box.operator("luxfer.new_strokes", icon="BRUSH_DATA")
        grid = box.grid_flow(columns=2, align=True)
        for kind, (_, label, _) in lighting.COLOURS.items():
            grid.operator("luxfer.paint", text=label, icon=ICONS[kind]).kind = kind
        row = box.row(align=True)
        row.operator("luxfer.preview_masks", text="Masks", icon="MOD_MASK")
        row.prop(context.window_manager, "luxfer_live", toggle=True, icon="HIDE_OFF")
        if live.preview is not None and live.preview.hint:
            draw_text(box, context, live.preview.hint)
        layout.prop(settings, "target", text="On")
        column = layout.column(align=True)
        column.prop(settings, "scale")
        if settings.scale == "DISTANCE":
            column.prop(settings, "distance")
        elif settings.scale != "ACROSS":
            column.prop(settings, "length")
        column.prop(settings, "keep_whole")
        if settings.keep_whole:
            column.prop(settings, "margin")
        column = layout.column(align=True)
        column.prop(settings, "white")
        column.prop(settings, "texels")
        layout.prop(settings, "apply_when_done")
        layout.operator("luxfer.transfer", icon="LIGHT")
        if lighting.result is not None:
            layout.operator("luxfer.apply", icon="MATERIAL")
            draw_text(layout, context, f"Strength known to {lighting.result.error:.1%}; see the text {lighting.LAMPS}")
        show_warnings(layout, context, lighting.warnings)
        show_progress(layout, context)


class PaintingPanel(Sidebar):
    bl_label = "Paint by Example"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.luxfer
        column = layout.column(align=True)
        column.prop(settings, "exemplar_width")
        column.prop(settings, "exemplar_height")
        column.operator("luxfer.exemplar", icon="SHADING_RENDERED")
        layout.template_ID(settings, "artwork", open="image.open")
        layout.operator_menu_enum("luxfer.sample_artwork", "style")
        layout.prop(settings, "preset")
        column = layout.column(align=True)
        column.label(text="Guides by")
        column.row(align=True).prop(settings, "guides_by", expand=True)
        column.prop(settings, "guide_samples")
        layout.prop(settings, "match_light")
        column = layout.column(align=True)
        row = column.row(align=True)
        row.enabled = settings.guides_by == "LUXFER"
        row.prop(settings, "guide_edges")
        column.prop(settings, "guide_parts")
        if context.object is not None:
            show_object(layout.box(), context.object, settings.guide_parts)
        layout.operator("luxfer.stylise", icon="BRUSH_DATA")
        draw_text(layout, context, f"The picture is the image {painting.PICTURE}")
        show_progress(layout, context)


class LUXFER_PT_lighting(LightingPanel, bpy.types.Panel):
    bl_space_type = "VIEW_3D"


class LUXFER_PT_lighting_image(LightingPanel, bpy.types.Panel):
    bl_space_type = "IMAGE_EDITOR"


class LUXFER_PT_painting(PaintingPanel, bpy.types.Panel):
    bl_space_type = "VIEW_3D"


class LUXFER_PT_painting_image(PaintingPanel, bpy.types.Panel):
    bl_space_type = "IMAGE_EDITOR"


CLASSES = (LUXFER_PT_lighting, LUXFER_PT_lighting_image, LUXFER_PT_painting, LUXFER_PT_painting_image)


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
