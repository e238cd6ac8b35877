"""Helpers for the tests of the Python package: imports the package of this source tree, and creates small inputs
once."""

from __future__ import annotations

import os
import sys
import tempfile
import unittest
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "bindings" / "python"
sys.path.insert(0, str(PACKAGE))

import numpy as np  # noqa: E402

import luxfer  # noqa: E402


@lru_cache
def context() -> luxfer.Context:
    return luxfer.Context()


@lru_cache
def demo() -> tuple[luxfer.Image, luxfer.Image]:
    """The photo of the generated office, and an image with the strokes for it."""
    stage = luxfer.DemoPhoto(context()).run(width=240, height=160, samples=8)
    return stage.image("picture"), stage.image("strokes")


def lit_room() -> luxfer.Scene:
    """The demonstration room with four lamps in its ceiling."""
    scene = luxfer.Scene.demo(context(), "target-room")
    lamps = np.zeros((8, 12, 3), np.float32)
    lamps[2::4, 3::6] = 1
    scene.place_emission("Ceiling", lamps, (2000, 1800, 1500))
    return scene


class Case(unittest.TestCase):
    """A test case with a temporary folder, `self.folder`."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


def in_ci() -> bool:
    return bool(os.environ.get("CI"))
