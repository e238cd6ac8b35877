"""The stylisation: an artwork of the ball, the picture that is painted like it, and the sheet to paint on.

The page shows the artwork, which is an example, a file of the user or a painting that the user makes on the page. A
first picture appears by the preset `preview`, then a better one by the preset `fast`.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import luxfer
import numpy as np

from . import pictures
from .jobs import Latest
from .project import Invalid

#: Size of ball and picture in pixels; their guides are rendered with this number of paths per pixel.
SIZE, SAMPLES = (320, 240), 4
#: Size of the ball's picture on the printed sheet in pixels, the sheet's dots per inch, and its paper in millimetres.
SHEET_SIZE, DPI, PAPER = (640, 480), 150.0, (297.0, 210.0)
#: Paths per pixel of the ball on the sheet.
SHEET_SAMPLES = 4
#: The quantile of the ball's picture that becomes the white of the paper. [convention: highlights may be clipped]
PAPER_WHITE = 0.98
#: An artwork may differ from the ball's picture by this share in its ratio of width to height.
RATIO_TOLERANCE = 0.03
EXAMPLES = ("paint", "pen", "stipple")
OWN = "own"
#: The generated scenes: the ball, and the scene that is painted like it.
BALL, TARGET = "sphere-on-table", "still-life"


class Painter:
    """The stylisation of one user."""

    def __init__(self, context: luxfer.Context, send: Callable[..., None], failed: Callable[[Exception], None]):
        self.context, self.send = context, send
        self.work: Latest[str] = Latest("studio-paint", self._paint, failed)
        self.own: luxfer.Image | None = None
        self.painted: luxfer.Image | None = None
        self._guides: dict[str, luxfer.Guides] = {}

    def close(self) -> None:
        """Ends the thread and releases the library's objects."""
        self.work.close()
        self.own = self.painted = None
        self._guides.clear()

    def ask(self, message: dict[str, Any]) -> None:
        """Handles a wish of the page."""
        artwork = message.get("artwork")
        if artwork not in (*EXAMPLES, OWN):
            raise Invalid(f"artwork is one of {', '.join(EXAMPLES)} and {OWN}, not {artwork!r}")
        if artwork == OWN and self.own is None:
            raise Invalid("there is no artwork yet: open one, or paint on the ball")
        self.work.put(artwork)

    def take_artwork(self, data: bytes, is_sheet: bool) -> None:
        """Takes an artwork of the user: a picture of the ball's shape, or a photo of the painted sheet."""
        image = luxfer.Image.from_bytes(self.context, data)
        if is_sheet:
            sides = {"paper_width": PAPER[0], "paper_height": PAPER[1], "dpi": DPI}
            image, _ = luxfer.align_sheet(self.context, image, *SHEET_SIZE, **sides)
        width, height, _ = image.size
        if abs(width / height / (SIZE[0] / SIZE[1]) - 1) > RATIO_TOLERANCE:
            raise Invalid(
                f"the artwork has {width} x {height} pixels, but the ball's picture is {SIZE[0]} wide for "
                f"{SIZE[1]} high: crop it to this shape, or tick that it is a photo of the sheet"
            )
        scale = [[width / SIZE[0], 0, 0], [0, height / SIZE[1], 0], [0, 0, 1]]
        self.own = image if image.size[:2] == SIZE else image.warp(scale, *SIZE)

    # -- work

    def guides(self, name: str) -> luxfer.Guides:
        """Renders the guides of a scene, once."""
        if name not in self._guides:
            self.send("working", stage="guides")
            guides = luxfer.Guides(self.context, luxfer.Scene.demo(self.context, name))
            self.work.finish(guides.start(width=SIZE[0], height=SIZE[1], samples=SAMPLES))
            self._guides[name] = guides
        return self._guides[name]

    def _paint(self, wanted: str) -> None:
        began = time.perf_counter()
        ball = self.guides(BALL)
        artwork = self.own if wanted == OWN else ball.demo_artwork(wanted)
        assert artwork is not None
        if wanted != OWN:
            self.send("artwork", self.shown(artwork), width=SIZE[0], height=SIZE[1])
        target = self.guides(TARGET)
        self.send("working", stage="painting")
        for preset in ("preview", "fast"):
            stylize = luxfer.Stylize(self.context, artwork)
            stylize.add_guides(ball, target, "materials")
            self.work.finish(stylize.start(preset=preset))
            self.painted = stylize.image()
            width, height, _ = self.painted.size
            self.send(
                "painting",
                self.shown(self.painted),
                width=width,
                height=height,
                done=preset == "fast",
                guide_error=stylize.report.guide_error,
                used=stylize.report.used,
                seconds=time.perf_counter() - began,
                digest=pictures.digest(self.painted),
            )
        self.send("working", stage="")

    @staticmethod
    def shown(image: luxfer.Image) -> bytes:
        """Returns the sRGB bytes of a picture; a grey one gets three channels."""
        values = image.numpy("u1", "srgb")
        return bytes((values[..., :3] if values.shape[2] >= 3 else values.repeat(3, axis=2)).tobytes())

    # -- results

    def out(self, kind: str, folder: Path) -> Path:
        """Writes the painted picture or the sheet to paint on."""
        path = folder / f"{kind}.png"
        if kind == "painting":
            if self.painted is None:
                raise luxfer.errors.NotReady("nothing has been painted yet: try again in a moment")
            self.painted.save(path)
            return path
        scene = luxfer.Scene.demo(self.context, BALL)
        width, height = SHEET_SIZE
        render = luxfer.Render(self.context, scene)
        render.set_camera(**scene.camera(0))
        render.run(width=width, height=height, samples=SHEET_SAMPLES, preview=1.0)
        sides = {"paper_width": PAPER[0], "paper_height": PAPER[1], "dpi": DPI}
        values = render.image("preview").numpy()
        luxfer.print_sheet(self.context, values / np.quantile(values, PAPER_WHITE), **sides).save(path)
        return path


#: The results that a Painter writes.
RESULTS = ("painting", "sheet")
