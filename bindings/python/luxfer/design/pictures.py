"""Pictures of a design: the room as a camera sees it, and its luminance in false colours."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..image import Image
from ..photometry import false_colour
from ..render import Render

if TYPE_CHECKING:
    from ..scene import Scene
    from .rooms import Room

#: Height of the eye of the picture without a camera, and its angle of view in radians. [convention]
EYE, FOV = 1.6, 1.1
#: The display's white shows this multiple of the median luminance. [convention]
WHITE = 3.0


def views(
    room: Room, lit: Scene, width: int = 560, height: int = 350, samples: int = 16, seed: int = 1
) -> dict[str, bytes]:
    """PNG files of the picture and of its luminance, by their captions."""
    render = Render(lit.context, lit)
    if lit.counts.cameras == 0:
        corner = room.world([(0.3, 0.3)], EYE)[0]
        middle = room.world([(0.6 * room.length, 0.6 * room.width)], 0.8)[0]
        render.set_camera(position=corner, target=middle, fov_y=FOV)
    render.run(width=width, height=height, samples=samples, seed=seed, preview=1.0)
    picture = render.image("preview")
    pixels = picture.numpy()
    luminance = pixels @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    white = WHITE * float(np.median(luminance[luminance > 0])) if (luminance > 0).any() else 1.0
    shown = Image(lit.context, _toned(pixels / white))
    falsely = false_colour(
        lit.context, picture, scale="logarithmic", maximum=float(np.percentile(luminance, 99.5)) or 1.0
    )
    return {
        "The room with the luminaires of this design, initial luminance.": _png(shown),
        "Initial luminance in cd/m² in false colours.": _png(falsely),
    }


def _toned(pixels: np.ndarray) -> np.ndarray:
    """Smoothly compresses values brighter than white, and keeps the colours."""
    peak = pixels.max(axis=2, keepdims=True)
    knee = 0.6
    over = np.maximum(peak - knee, 0)
    kept = np.where(peak > knee, knee + (1 - knee) * over / (over + (1 - knee)), peak)
    return (pixels * kept / np.maximum(peak, 1e-6)).astype(np.float32)


def _png(image: Image) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        image.save(path)
        return path.read_bytes()
