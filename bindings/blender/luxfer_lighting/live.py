"""Updates the masks while strokes are painted: a timer checks whether the strokes have changed, and then a job
computes new masks.

The Image Editor shows the masks over the photo, and the image "Luxfer masks" stores them. Large photos are reduced
here; *Preview Masks* and the transfer use the full size.
"""

from __future__ import annotations

import math
import time
from typing import Any

import bpy
import luxfer
import numpy as np

from . import convert, lighting, work

POLL_SECONDS = 0.2
#: Largest share of the time that checking the strokes may take.
SHARE = 0.1
#: Number of pixels above which photos are reduced.
PIXELS = 1_500_000

#: For each stage, the message that is shown if its strokes are missing. The mask is then missing too, or a guess.
HINTS = {
    "plane": "Paint a stroke on the plane of the lights (green) and one off it (red)",
    "lights": "Paint a stroke on a light (yellow)",
}


class Preview:
    """Keeps the features of one photo and the masks of the latest strokes."""

    def __init__(self, scene: bpy.types.Scene):
        photo = scene.luxfer.photo
        self.of = identity(scene)
        self.reduction = max(1, math.ceil(math.sqrt(photo.size[0] * photo.size[1] / PIXELS)))
        self.photo = self.reduced(convert.pixels(photo)[..., :3], smooth=True)
        encoded = not photo.is_float and photo.colorspace_settings.name == "sRGB"
        self.transfer = luxfer.Transfer(work.context(), luxfer.Image(work.context(), self.photo, "srgb" if encoded else "linear"))
        self.job: luxfer.Job[luxfer.Transfer] | None = self.transfer.start("view", "view")
        self.stage = "view"
        self.strokes: np.ndarray | None = None
        self.masks: dict[str, np.ndarray] = {}  # by stage
        self.shown: dict[str, np.ndarray] = {}  # the last complete masks, which are shown
        self.hint = ""
        self.version = 0

    def reduced(self, values: np.ndarray, smooth: bool = False) -> np.ndarray:
        """Reduces an image: every n-th pixel or, if smooth, means over n x n pixels."""
        n = self.reduction
        height, width = (size // n * n for size in values.shape[:2])
        if smooth and n > 1:
            return np.ascontiguousarray(values[:height, :width].reshape(height // n, n, width // n, n, -1).mean((1, 3)))
        return np.ascontiguousarray(values[n // 2 : height : n, n // 2 : width : n])

    def follow(self, scene: bpy.types.Scene) -> None:
        """Reads the result of the job if it has ended; without a job, starts one if the strokes have changed."""
        if self.job is not None:
            if self.job.finished:
                job, self.job = self.job, None
                self.read(job)
            return
        strokes = self.reduced(convert.pixels(scene.luxfer.strokes)[..., :3])
        if self.strokes is not None and np.array_equal(strokes, self.strokes):
            return
        self.strokes = strokes
        self.transfer.set_strokes(luxfer.Image(work.context(), strokes))
        self.masks, self.hint = {}, ""
        self.begin("plane")

    def begin(self, stage: str) -> None:
        # Strokes on the plane change the room layout and so the features, so start with the features.
        first = "features" if stage == "plane" else stage
        self.stage, self.job = stage, self.transfer.start(first, stage)

    def read(self, job: luxfer.Job[luxfer.Transfer]) -> None:
        """Reads the mask of a stage, if there is one; then starts the next stage or shows the masks."""
        has_failed = False
        try:
            job.wait()
        except luxfer.errors.Degenerate as error:
            self.hint, has_failed = HINTS.get(self.stage, str(error)), True
        if self.stage == "view":
            return
        if not has_failed:
            self.masks[self.stage] = self.transfer.image(f"{self.stage}-mask").numpy()
            if not self.hint and self.is_guess():
                self.hint = f"A guess. {HINTS[self.stage]}"
            if self.stage == "plane":
                self.begin("lights")
                return
        lighting.store_masks(self.photo, *(self.masks.get(stage) for stage in HINTS), pack=False)
        self.shown = dict(self.masks)
        self.version += 1
        work.redraw(pictures=True)

    def is_guess(self) -> bool:
        """Whether the library has proposed the mask of the current stage, because its strokes are missing."""
        found = ((warning.code.name, warning.stage.name.lower()) for warning in self.transfer.warnings)
        return ("PROPOSED", self.stage) in found

    def overlay(self) -> np.ndarray | None:
        """The masks as colours to lay over the photo: (height, width, 4), rows from the top."""
        if not self.shown:
            return None
        out = np.zeros((*self.photo.shape[:2], 4), np.float32)
        for stage, colour in (("plane", (0.0, 0.8, 0.1, 0.4)), ("lights", (1.0, 0.9, 0.0, 0.7))):
            if stage in self.shown:
                out += self.shown[stage] * (np.float32(colour) - out)
        return out


preview: Preview | None = None
_texture: Any = None
_texture_of: tuple[int, int] | None = None
_handler: Any = None


def identity(scene: bpy.types.Scene) -> tuple[Any, ...]:
    """The inputs of a preview; if they change, a new preview is needed."""
    photo = scene.luxfer.photo
    return scene.name, photo.name, tuple(photo.size)


def step() -> float | None:
    """Function of the timer: returns the seconds until its next call, or None to end the timer."""
    global preview
    scene, settings = bpy.context.scene, bpy.context.scene.luxfer
    if not bpy.context.window_manager.luxfer_live:
        forget()
        return None
    if work.current() is not None:  # an operator uses the processors
        return POLL_SECONDS
    if settings.photo is None or settings.strokes is None or tuple(settings.strokes.size) != tuple(settings.photo.size):
        forget()
        return POLL_SECONDS
    start = time.perf_counter()
    try:
        if preview is None or preview.of != identity(scene):
            forget()
            preview = Preview(scene)
        preview.follow(scene)
    except Exception as error:  # a timer cannot pass on an exception
        bpy.context.window_manager.luxfer_live = False
        work.message = str(error)
        forget()
        return None
    return work.POLL_SECONDS if preview.job is not None else max(POLL_SECONDS, (time.perf_counter() - start) / SHARE)


def forget() -> None:
    """Cancels the running job and discards the preview."""
    global preview, _texture, _texture_of
    if preview is not None and preview.job is not None:
        preview.job.cancel()
        preview.job.close()
    preview = _texture = _texture_of = None
    work.redraw(pictures=True)


def toggled(manager: bpy.types.WindowManager, _: bpy.types.Context) -> None:
    if manager.luxfer_live and not bpy.app.timers.is_registered(step):
        bpy.app.timers.register(step, first_interval=0.0, persistent=True)


def draw() -> None:
    """Draws the masks over the picture in an Image Editor that shows the strokes."""
    global _texture, _texture_of
    space, region, settings = bpy.context.space_data, bpy.context.region, bpy.context.scene.luxfer
    if preview is None or not preview.shown or space.image is None or space.image != settings.strokes:
        return
    import gpu
    from gpu_extras.presets import draw_texture_2d

    if _texture_of != (id(preview), preview.version):
        colours = preview.overlay()[::-1]
        height, width = colours.shape[:2]
        buffer = gpu.types.Buffer("FLOAT", colours.size, np.ascontiguousarray(colours).ravel())
        _texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
        _texture_of = id(preview), preview.version
    left, bottom = region.view2d.view_to_region(0, 0, clip=False)
    right, top = region.view2d.view_to_region(1, 1, clip=False)
    gpu.state.blend_set("ALPHA")
    draw_texture_2d(_texture, (left, bottom), right - left, top - bottom)
    gpu.state.blend_set("NONE")


def register() -> None:
    global _handler
    bpy.types.WindowManager.luxfer_live = bpy.props.BoolProperty(
        name="Live", description="Show the masks while strokes are painted", default=False, update=toggled
    )
    _handler = bpy.types.SpaceImageEditor.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    global _handler
    if bpy.app.timers.is_registered(step):
        bpy.app.timers.unregister(step)
    forget()
    if _handler is not None:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handler, "WINDOW")
        _handler = None
    del bpy.types.WindowManager.luxfer_live
