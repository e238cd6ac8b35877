"""Renders guides by Cycles in a second Blender, on a copy of the .blend, so that this Blender neither waits nor
changes.

The rendering has the methods of a job of the library, so that `work` can run it, show its progress and cancel it.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterable, Sequence
from pathlib import Path

import bpy
import luxfer
import numpy as np

from .parts import BALL, TABLE
from .render_passes import GUIDES

PROGRAM = Path(__file__).with_name("render_passes.py")
#: The number of each part of the exemplar in the rendered image of parts.
NUMBERS = {BALL: 1, TABLE: 2}


class Rendering:
    """A running rendering of guides for a scene's active camera. Only the constructor accesses Blender's data, and it
    only reads. After `light`, `parts` is an image of the NUMBERS of the parts of the exemplar, and `covers` are images
    of the share of each pixel that each of the groups of objects covers."""

    def __init__(
        self,
        scene: bpy.types.Scene,
        layer: bpy.types.ViewLayer,
        samples: int,
        parts: dict[str, str] | None = None,
        groups: Sequence[Iterable[str]] = (),
    ):
        numbers = {name: NUMBERS[part] for name, part in (parts or {}).items()}
        self._folder = tempfile.TemporaryDirectory(prefix="luxfer-")
        self._out = Path(self._folder.name) / "guides.npz"
        blend = os.path.join(self._folder.name, "scene.blend")
        bpy.ops.wm.save_as_mainfile(filepath=blend, copy=True, check_existing=False, compress=False)
        settings = {"blend": blend, "scene": scene.name, "layer": layer.name, "samples": samples}
        settings.update(parts=numbers, groups=[sorted(names) for names in groups], out=str(self._out))
        blender = [bpy.app.binary_path, "--background", "--python-exit-code", "1", "--python"]
        if not bpy.app.binary_path:  # bpy runs as a Python module
            blender = [sys.executable, "-P"]  # -P keeps Python from importing the files beside the program
        self._fraction, self._said, self._cancelled = 0.0, "", False
        self._process = subprocess.Popen(
            [*blender, str(PROGRAM), "--", json.dumps(settings)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        )
        self._reader = threading.Thread(target=self._listen, daemon=True)
        self._reader.start()

    def _listen(self) -> None:
        first = last = 0.0
        for line in self._process.stdout:
            if line.startswith("part "):
                first, last = (float(word) for word in line.split()[1:])
            elif sample := re.search(r"Sample (\d+)/([1-9]\d*)", line):
                done = int(sample[1]) / int(sample[2])
                if tiles := re.search(r"Rendered (\d+)/([1-9]\d*) Tiles", line):
                    done = (int(tiles[1]) + done) / int(tiles[2])
                self._fraction = max(self._fraction, first + min(done, 1.0) * (last - first))
            elif line.strip():
                self._said = line.strip()

    @property
    def finished(self) -> bool:
        return self._process.poll() is not None

    def poll(self) -> tuple[float, bool]:
        """Returns the finished share, and whether the rendering has ended, successfully or not."""
        return self._fraction, self.finished

    def cancel(self) -> None:
        self._cancelled = True
        self._process.kill()

    def wait(self) -> Rendering:
        """Waits for the end; raises the same exceptions as a job."""
        try:
            status = self._process.wait()
        except BaseException:  # Ctrl-C in a script
            self.close()
            raise
        self._reader.join()
        if self._cancelled:
            self.close()
            raise luxfer.errors.Cancelled("cancelled")
        if status != 0 or not self._out.exists():
            self.close()
            raise RuntimeError(f"Cycles could not render the guides: {self._said or f'it ended with {status}'}")
        return self

    def light(self) -> dict[str, np.ndarray]:
        """The guides by the names of GUIDES, (height, width, 3), rows from the top."""
        with np.load(self._out) as stored:
            out = {name: stored[name] for name in GUIDES}
            self.parts, self.covers = stored["parts"], list(stored["covers"])
        self.close()
        return out

    def close(self) -> None:
        if not self.finished:
            self._process.kill()
        self._process.wait()
        self._reader.join()
        self._process.stdout.close()
        self._folder.cleanup()


def light_of(guides: luxfer.Guides) -> dict[str, np.ndarray]:
    """Converts guides that the library has rendered to the form of Rendering.light."""
    return {name: guides.image(which).numpy() for name, which in GUIDES.items()}


def exposed(source: dict[str, np.ndarray], target: dict[str, np.ndarray]) -> list[dict[str, np.ndarray]]:
    """The light of two scenes at a common exposure, as Stylize.add_guides exposes it, whichever renderer made it. The
    exposure maps the luminance below which nine tenths of both full pictures lie to 0.8; values above 1 become 1."""
    luma = np.float32((0.2126, 0.7152, 0.0722))
    luminances = np.concatenate([(light["full"] @ luma).ravel() for light in (source, target)])
    luminances = luminances[np.isfinite(luminances)]
    rank = (max(luminances.size, 1) - 1) * 9 // 10
    bright = np.partition(luminances, rank)[rank] if luminances.size else 0.0
    exposure = np.float32(0.8 / bright if bright > 0 else 1)
    return [{name: np.minimum(light[name] * exposure, 1) for name in GUIDES} for light in (source, target)]


def add(stylize: luxfer.Stylize, source: dict[str, np.ndarray], target: dict[str, np.ndarray]) -> None:
    """Adds guides: the light at its exposure, and all others as data."""
    for name in source:
        kind = "light" if name in GUIDES else "data"
        stylize.add_guide(name, source[name], np.ascontiguousarray(target[name]), 1.0, kind)


def colours(codes: np.ndarray) -> dict[str, np.ndarray]:
    """The colours that the parts of the exemplar have in its image of materials. Most of the exemplar shows the table,
    and the rest of it the ball."""
    found, counts = np.unique(codes.reshape(-1, 3), axis=0, return_counts=True)
    table, ball = found[np.argsort(-counts)][:2]
    return {BALL: ball, TABLE: table}


def coded(colours: dict[str, np.ndarray], parts: np.ndarray) -> np.ndarray:
    """The image of materials for an image of the NUMBERS of parts."""
    out = np.zeros((*parts.shape, 3), np.float32)
    for part, colour in colours.items():
        out[np.round(parts) == NUMBERS[part]] = colour
    return out
