"""Uses the add-on in a Blender that docs/screenshots.py has started, and takes pictures of its window.

What happens is a generator that yields what it waits for: seconds, or a function that says whether it is time. A timer of
Blender's goes on with it, so the interface draws and works as under a user's hands, whose pointer is simulated. Photo and
scenes are those that the library makes itself.
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Generator
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "bindings" / "python"), str(ROOT / "bindings" / "blender"), str(ROOT / "docs")]
import luxfer  # noqa: E402
import luxfer_lighting  # noqa: E402
from luxfer_lighting import convert, lighting, live, painting, panels, work  # noqa: E402

SCREEN, OUT = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1 :])
LIMIT = 900  # seconds for all of it
WHITE = 100.0  # cd/m² that 3D views show as white

Wait = float | Callable[[], bool]
Steps = Generator[Wait, None, None]

#: Strokes on the generated photo: from and to, as shares of its width and of its height from the top.
STROKES = {
    "PLANE": [((0.51, 0.51), (0.70, 0.55)), ((0.28, 0.63), (0.27, 0.70))],
    "NOT_PLANE": [((0.18, 0.81), (0.50, 0.89)), ((0.69, 0.79), (0.91, 0.68)), ((0.67, 0.97), (0.81, 0.81)), ((0.01, 0.73), (0.03, 0.85))],
    "LIGHT": [((0.08, 0.61), (0.15, 0.62)), ((0.44, 0.57), (0.51, 0.58)), ((0.37, 0.71), (0.41, 0.715))],
    "NOT_LIGHT": [((0.04, 0.41), (0.30, 0.465)), ((0.55, 0.68), (0.64, 0.60))],
}


def run() -> Steps:
    yield from lay_out_window()
    yield from paint_strokes()
    yield from transfer_light()
    yield from stylise()


def paint_strokes() -> Steps:
    """Strokes painted on the photo of an office while the masks follow them."""
    editor, view = areas()
    place("target-room")
    show_camera(view)
    settings = bpy.context.scene.luxfer
    photo = luxfer.DemoPhoto(work.context()).run(width=600, height=400, samples=8).image("picture")
    settings.photo = convert.store("Office", photo.numpy(np.uint8, "srgb")[..., :3] / np.float32(255), linear=False)
    settings.target = bpy.data.objects["Ceiling"]
    settings.guide_samples = 16
    bpy.ops.luxfer.new_strokes()
    yield from show_tab(editor)
    yield from show_image(editor, lighting.STROKES)
    bpy.context.scene.tool_settings.unified_paint_settings.size = 4
    for kind, lines in STROKES.items():
        with over(editor):
            bpy.ops.luxfer.paint(kind=kind)
        yield 0.3
        for line in lines:
            if bpy.context.tool_settings.image_paint.brush is None:  # Debian's Blender 4.3 comes without brushes
                draw_line(kind, *line)
            else:
                yield from drag(editor, *line)
    bpy.context.window_manager.luxfer_live = True
    yield lambda: live.preview is not None and live.preview.job is None and "lights" in live.preview.masks
    yield from take("strokes")
    bpy.context.window_manager.luxfer_live = False


def transfer_light() -> Steps:
    """The room in the light of the photo, and the material that gives it."""
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
    """A still life painted like a ball on a table."""
    left, right = areas()
    place("still-life")
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


def until_done() -> Steps:
    yield lambda: work.current() is None
    if work.message:
        raise RuntimeError(work.message)


# The window


def window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def areas() -> list[bpy.types.Area]:
    """From left to right, and then from the bottom up."""
    return sorted(window().screen.areas, key=lambda area: (area.x, area.y))


def region(area: bpy.types.Area, kind: str = "WINDOW") -> bpy.types.Region:
    return next(r for r in area.regions if r.type == kind)


def over(area: bpy.types.Area):
    """The context of an area, which a timer has none of."""
    return bpy.context.temp_override(window=window(), screen=window().screen, area=area, region=region(area))


def lay_out_window() -> Steps:
    """Nothing but an Image Editor on the left and a 3D view on the right."""
    preferences = bpy.context.preferences
    preferences.system.use_region_overlap = False  # sidebars stand beside pictures, not on them
    preferences.view.smooth_view = 0
    yield 0.5
    for area in areas():
        if area.type != "VIEW_3D":
            with over(area):
                bpy.ops.screen.area_close()
            yield 0.2
    (view,) = areas()
    with over(view):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.64)
    yield 0.2
    areas()[0].type = "IMAGE_EDITOR"
    yield 0.2


def place(demo: str) -> None:
    """A scene of the library's in place of what there is."""
    bpy.data.batch_remove(bpy.data.objects)
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, f"{demo}.glb")
        luxfer.Scene.demo(work.context(), demo).export(file)
        with over(areas()[0]):
            bpy.ops.import_scene.gltf(filepath=file)
    scene = bpy.context.scene
    scene.camera = next(thing for thing in bpy.data.objects if thing.type == "CAMERA")
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 480, 320, 100
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 64
    scene.cycles.use_denoising = False
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.exposure = math.log2(1 / WHITE)
    for thing in bpy.data.objects:
        thing.select_set(False)


def show_camera(area: bpy.types.Area) -> None:
    """What the camera sees, and nothing else, in a 3D view."""
    space = area.spaces.active
    space.region_3d.view_perspective = "CAMERA"
    space.region_3d.view_camera_zoom = 29
    space.show_region_toolbar = space.overlay.show_overlays = space.show_gizmo = False
    bpy.context.scene.camera.data.passepartout_alpha = 1


def show_image(area: bpy.types.Area, name: str) -> Steps:
    """An image, as large as an Image Editor can show it."""
    area.spaces.active.mode = "VIEW"
    area.spaces.active.image = bpy.data.images[name]
    yield 0.3
    with over(area):
        bpy.ops.image.view_all(fit_view=True)
    yield 0.3


def show_rendering(area: bpy.types.Area) -> Steps:
    """The scene, by Cycles."""
    with over(area):
        bpy.ops.render.render()
    yield 0.5
    yield from show_image(area, "Render Result")


def show_tab(area: bpy.types.Area) -> Steps:
    """The add-on's tab in an area's sidebar: the pointer tries one place after the other."""
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
    """Closes the first panel of a sidebar, and opens the one below it."""
    sidebar = region(area, "UI")
    for below in (14, 40):
        yield from click((sidebar.x + 60, sidebar.y + sidebar.height - below))
        yield 0.5


def at(area: bpy.types.Area, share: tuple[float, float]) -> tuple[int, int]:
    """Where in the window a place of an Image Editor's picture is."""
    inside = region(area)
    x, y = inside.view2d.view_to_region(share[0], 1 - share[1], clip=False)
    return inside.x + x, inside.y + y


def pointer(kind: str, value: str, place: tuple[int, int]) -> None:
    window().event_simulate(type=kind, value=value, x=int(place[0]), y=int(place[1]))


def click(place: tuple[int, int]) -> Steps:
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
        pointer(kind, value, place)
        yield 0.1


def drag(area: bpy.types.Area, start: tuple[float, float], end: tuple[float, float]) -> Steps:
    """Draws a line on an Image Editor's picture."""
    path = np.linspace(at(area, start), at(area, end), 8)
    pointer("MOUSEMOVE", "NOTHING", path[0])
    yield 0.1
    pointer("LEFTMOUSE", "PRESS", path[0])
    for place in path:
        pointer("MOUSEMOVE", "NOTHING", place)
        yield 0.05
    pointer("LEFTMOUSE", "RELEASE", path[-1])
    yield 0.1


def draw_line(kind: str, start: tuple[float, float], end: tuple[float, float]) -> None:
    """The same without a brush."""
    picture = convert.pixels(bpy.data.images[lighting.STROKES])[..., :3].copy()
    height, width, _ = picture.shape
    rows, columns = np.mgrid[:height, :width]
    for x, y in np.linspace(start, end, 200) * (width, height):
        picture[(columns - x) ** 2 + (rows - y) ** 2 < 9] = lighting.COLOURS[kind][0]
    convert.store(lighting.STROKES, picture, linear=False)


def seen() -> np.ndarray:
    """What the screen shows, (height, width, 3): Xvfb keeps it in a file of the X Window Dump format."""
    data = SCREEN.read_bytes()
    head = np.frombuffer(data, ">u4", 25)
    length, width, height, line, colours = head[0], head[4], head[5], head[12], head[19]
    rows = np.frombuffer(data, np.uint8, height * line, length + 12 * colours).reshape(height, line)
    return rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]


def take(name: str, still: bool = True) -> Steps:
    """A picture of the window, when it stands still."""
    before = None
    while still and not np.array_equal(before, now := seen()):
        before = now
        yield 2.0
    luxfer.Image(work.context(), np.ascontiguousarray(seen()), "srgb").save(OUT / f"{name}.png")


steps, waits_for, end = run(), 0.0, time.monotonic() + LIMIT


def step() -> float:
    """What the timer calls: seconds until it wants to be called again."""
    global waits_for
    try:
        if time.monotonic() > end:
            raise TimeoutError(f"not done in {LIMIT} s")
        if callable(waits_for) and not waits_for():
            return 0.1
        waits_for = next(steps)
        return 0.1 if callable(waits_for) else waits_for
    except StopIteration:
        status = 0
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    os._exit(status)  # Blender would ask whether to save


if bpy.app.version < (4, 2):
    import blender_3_4

    blender_3_4.fill_in()
bpy.context.preferences.view.show_splash = False
luxfer_lighting.register()
bpy.app.timers.register(step, first_interval=1.0)
