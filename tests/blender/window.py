"""Lets a program control a Blender with a window, by simulated pointer and keys.

Used by in_window.py and docs/in_blender.py; xvfb.py starts this Blender.

The program is a generator. It yields a number of seconds to wait, or a function that returns True when to continue. A
timer of Blender resumes the generator, so meanwhile the interface draws and works as usual.
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

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "bindings" / "python"), str(ROOT / "bindings" / "blender")]

import luxfer  # noqa: E402
import luxfer_lighting  # noqa: E402
from luxfer_lighting import convert, lighting, work  # noqa: E402

WHITE = 100.0  # luminance in cd/m² that is shown as white

Wait = float | Callable[[], bool]
Steps = Generator[Wait, None, None]

#: Strokes on the generated photo: from and to, as shares of its width and of its height from the top.
STROKES = {
    "PLANE": [((0.51, 0.51), (0.70, 0.55)), ((0.28, 0.63), (0.27, 0.70))],
    "NOT_PLANE": [((0.18, 0.81), (0.50, 0.89)), ((0.69, 0.79), (0.91, 0.68)), ((0.67, 0.97), (0.81, 0.81)), ((0.01, 0.73), (0.03, 0.85))],
    "LIGHT": [((0.08, 0.61), (0.15, 0.62)), ((0.44, 0.57), (0.51, 0.58)), ((0.37, 0.71), (0.41, 0.715))],
    "NOT_LIGHT": [((0.04, 0.41), (0.30, 0.465)), ((0.55, 0.68), (0.64, 0.60))],
}


def window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def areas() -> list[bpy.types.Area]:
    """The areas of the window, from left to right and then from the bottom up."""
    return sorted(window().screen.areas, key=lambda area: (area.x, area.y))


def region(area: bpy.types.Area, kind: str = "WINDOW") -> bpy.types.Region:
    return next(r for r in area.regions if r.type == kind)


def over(area: bpy.types.Area):
    """Sets an area as the context; the functions of a timer have no area in theirs."""
    return bpy.context.temp_override(window=window(), screen=window().screen, area=area, region=region(area))


def lay_out_window() -> Steps:
    """Arranges the window: only an Image Editor on the left and a 3D view on the right."""
    preferences = bpy.context.preferences
    preferences.system.use_region_overlap = False  # sidebars are beside the pictures instead of covering them
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
    """Replaces all objects by a demonstration scene of the library."""
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
    """Shows only the camera's picture in a 3D view."""
    space = area.spaces.active
    space.region_3d.view_perspective = "CAMERA"
    space.region_3d.view_camera_zoom = 29
    space.show_region_toolbar = space.overlay.show_overlays = space.show_gizmo = False
    bpy.context.scene.camera.data.passepartout_alpha = 1


def load_photo(width: int, height: int) -> None:
    """Sets the photo of the generated office as exemplar, and the room's ceiling as target."""
    settings = bpy.context.scene.luxfer
    photo = luxfer.DemoPhoto(work.context()).run(width=width, height=height, samples=8).image("picture")
    settings.photo = convert.store("Office", photo.numpy(np.uint8, "srgb")[..., :3] / np.float32(255), linear=False)
    settings.target = bpy.data.objects["Ceiling"]
    bpy.ops.luxfer.new_strokes()


def draw_line(kind: str, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Draws a stroke directly into the pixels of the strokes image, without a brush."""
    picture = convert.pixels(bpy.data.images[lighting.STROKES])[..., :3].copy()
    height, width, _ = picture.shape
    rows, columns = np.mgrid[:height, :width]
    for x, y in np.linspace(start, end, 200) * (width, height):
        picture[(columns - x) ** 2 + (rows - y) ** 2 < 9] = lighting.COLOURS[kind][0]
    convert.store(lighting.STROKES, picture, linear=False)


def at(area: bpy.types.Area, share: tuple[float, float]) -> tuple[int, int]:
    """The window position of a point of the picture in an Image Editor; the point is a share of width and height."""
    inside = region(area)
    x, y = inside.view2d.view_to_region(share[0], 1 - share[1], clip=False)
    return inside.x + x, inside.y + y


def pointer(kind: str, value: str, place: tuple[int, int]) -> None:
    window().event_simulate(type=kind, value=value, x=int(place[0]), y=int(place[1]))


def key(name: str, place: tuple[int, int], **modifiers: bool) -> None:
    for value in ("PRESS", "RELEASE"):
        window().event_simulate(type=name, value=value, x=int(place[0]), y=int(place[1]), **modifiers)


def click(place: tuple[int, int]) -> Steps:
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
        pointer(kind, value, place)
        yield 0.1


def drag(area: bpy.types.Area, start: tuple[float, float], end: tuple[float, float]) -> Steps:
    """Draws a line on the picture in an Image Editor with the simulated pointer."""
    path = np.linspace(at(area, start), at(area, end), 8)
    pointer("MOUSEMOVE", "NOTHING", path[0])
    yield 0.1
    pointer("LEFTMOUSE", "PRESS", path[0])
    for place in path:
        pointer("MOUSEMOVE", "NOTHING", place)
        yield 0.05
    pointer("LEFTMOUSE", "RELEASE", path[-1])
    yield 0.1


def use(steps: Steps, seconds: float) -> None:
    """Registers the add-on and runs the steps; then Blender exits, with status 1 if a step has failed."""
    end, waits = time.monotonic() + seconds, 0.0

    def step() -> float:
        nonlocal waits
        try:
            if time.monotonic() > end:
                raise TimeoutError(f"not done in {seconds} s")
            if callable(waits) and not waits():
                return 0.05
            waits = next(steps)
            return 0.05 if callable(waits) else waits
        except StopIteration:
            status = 0
        except BaseException:
            traceback.print_exc()
            status = 1
        sys.stdout.flush()
        os._exit(status)  # skip Blender's question whether to save

    if bpy.app.version < (4, 2):
        import blender_3_4

        blender_3_4.fill_in()
    bpy.context.preferences.view.show_splash = False
    luxfer_lighting.register()
    bpy.app.timers.register(step, first_interval=1.0)
