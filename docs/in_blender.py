"""Uses the add-on in a Blender that docs/screenshots.py has started, and takes pictures of its window.

The library generates the photo and the scenes."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "blender"))

import bpy  # noqa: E402
import numpy as np  # noqa: E402
import window  # noqa: E402
from window import Steps, areas, click, load_photo, over, region, show_camera  # noqa: E402

import luxfer  # noqa: E402
from luxfer_lighting import lighting, live, painting, panels, work  # noqa: E402

SCREEN, OUT = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1 :])


def run() -> Steps:
    yield from window.lay_out_window()
    yield from paint_strokes()
    yield from transfer_light()
    yield from stylise()


def paint_strokes() -> Steps:
    """Takes the pictures of strokes on the photo of an office, with the masks that follow them."""
    editor, view = areas()
    window.place("target-room")
    show_camera(view)
    load_photo(600, 400)
    yield from show_tab(editor)
    yield from show_image(editor, lighting.STROKES)
    bpy.context.scene.tool_settings.unified_paint_settings.size = 4
    for kind, lines in window.STROKES.items():
        with over(editor):
            bpy.ops.luxfer.paint(kind=kind)
        yield 0.3
        for line in lines:
            if bpy.context.tool_settings.image_paint.brush is None:  # Debian's Blender 4.3 comes without brushes
                window.draw_line(kind, *line)
            else:
                yield from window.drag(editor, *line)
    bpy.context.window_manager.luxfer_live = True
    yield lambda: live.preview is not None and live.preview.job is None and "lights" in live.preview.masks
    yield from take("strokes")
    bpy.context.window_manager.luxfer_live = False


def transfer_light() -> Steps:
    """Takes the pictures of the room in the light of the photo, and of the emissive material."""
    left, right = areas()
    with over(left):
        bpy.ops.luxfer.transfer("INVOKE_DEFAULT")
    yield from until_done()
    yield from show_rendering(left)
    ceiling = bpy.data.objects["Ceiling"]
    bpy.context.view_layer.objects.active = ceiling
    ceiling.active_material_index = len(ceiling.data.materials) - 1
    right.ui_type = "ShaderNodeTree"
    right.spaces.active.show_region_ui = False
    for node in ceiling.active_material.node_tree.nodes:
        node.select = node.type in ("TEX_IMAGE", "BSDF_PRINCIPLED")
    yield 0.5
    with over(right):
        bpy.ops.node.view_selected()
        for _ in range(4):
            bpy.ops.view2d.zoom_in(zoomfacx=0.25, zoomfacy=0.25)
    yield from take("transfer")


def stylise() -> Steps:
    """Takes the pictures of a still life that is stylised by the example of a painted ball."""
    left, right = areas()
    window.place("still-life")
    bpy.context.scene.luxfer.guide_samples = 16
    with over(right):
        bpy.ops.screen.area_split(direction="HORIZONTAL", factor=0.5)
    yield 0.5
    left, below, above = areas()
    above.type, below.type = "IMAGE_EDITOR", "VIEW_3D"
    yield 0.5
    above.spaces.active.show_region_ui = below.spaces.active.show_region_ui = False
    show_camera(below)
    yield from show_second_panel(left)
    with over(left):
        bpy.ops.luxfer.sample_artwork("INVOKE_DEFAULT", style="paint")
    yield from until_done()
    yield from show_image(above, painting.ARTWORK)
    with over(left):
        bpy.ops.luxfer.stylise("INVOKE_DEFAULT")
    yield from until_done()
    yield from show_image(left, painting.PICTURE)
    yield from take("stylise")
    bpy.context.view_layer.objects.active = bpy.data.objects["Vase"]
    with over(left):
        bpy.ops.luxfer.sample_artwork("INVOKE_DEFAULT", style="pen", for_object=True)
    yield from until_done()
    with over(left):
        bpy.ops.luxfer.stylise("INVOKE_DEFAULT")
    yield from until_done()
    yield from show_image(left, painting.PICTURE)
    yield from take("artworks")


def until_done() -> Steps:
    yield lambda: work.current() is None
    if work.message:
        raise RuntimeError(work.message)


def show_image(area: bpy.types.Area, name: str) -> Steps:
    """Shows an image in an Image Editor, as large as it fits."""
    area.spaces.active.mode = "VIEW"
    area.spaces.active.image = bpy.data.images[name]
    yield 0.3
    with over(area):
        bpy.ops.image.view_all(fit_view=True)
    yield 0.3


def show_rendering(area: bpy.types.Area) -> Steps:
    """Renders the scene by Cycles and shows the result."""
    with over(area):
        bpy.ops.render.render()
    yield 0.5
    yield from show_image(area, "Render Result")


def show_tab(area: bpy.types.Area) -> Steps:
    """Opens the add-on's tab in an area's sidebar: clicks at one position after the other until the tab is shown."""
    area.spaces.active.show_region_ui = True
    yield 0.5
    sidebar, drawn = region(area, "UI"), []
    draw = panels.LightingPanel.draw

    def watched(self: bpy.types.Panel, context: bpy.types.Context) -> None:
        drawn.append(context.area)
        draw(self, context)

    panels.LightingPanel.draw = watched
    for below in range(15, sidebar.height, 30):
        yield from click((sidebar.x + sidebar.width - 10, sidebar.y + sidebar.height - below))
        yield 0.3
        if area in drawn:
            break
    panels.LightingPanel.draw = draw


def show_second_panel(area: bpy.types.Area) -> Steps:
    """Closes the first panel of a sidebar and opens the one below it."""
    sidebar = region(area, "UI")
    for below in (14, 40):
        yield from click((sidebar.x + 60, sidebar.y + sidebar.height - below))
        yield 0.5


def seen() -> np.ndarray:
    """Reads the screen (height, width, 3) from the file in X Window Dump format in which Xvfb keeps it."""
    data = SCREEN.read_bytes()
    head = np.frombuffer(data, ">u4", 25)
    length, width, height, line, colours = head[0], head[4], head[5], head[12], head[19]
    rows = np.frombuffer(data, np.uint8, height * line, length + 12 * colours).reshape(height, line)
    return rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]


def take(name: str, still: bool = True) -> Steps:
    """Saves a picture of the window; with `still`, once the window no longer changes."""
    before = None
    while still and not np.array_equal(before, now := seen()):
        before = now
        yield 2.0
    luxfer.Image(work.context(), np.ascontiguousarray(seen()), "srgb").save(OUT / f"{name}.png")


window.use(run(), seconds=900)
