"""Strokes that a user paints on a photo to show where the plane and the lights are."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _abi, _arrays, _params
from ._handle import Handle, call
from ._pointers import POINTER
from .image import image_of
from .types import Phase

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .context import Context
    from .image import ImageLike


class Strokes(Handle):
    """Strokes for images of width x height pixels. A stage copies them: after a change, set them again.

    >>> strokes = Strokes(context, 60, 40)
    >>> strokes.add("plane", [(5, 5), (50, 8)], 3, True)
    >>> strokes.add_text("not-plane 3 30.5 35.5  # the floor")
    """

    kind = "strokes"

    def __init__(self, context: Context, width: int, height: int) -> None:
        self._context = context
        pointer = POINTER(_abi.luxfer_strokes)()
        call(context, "luxfer_strokes_create", context, width, height, pointer)
        self._pointer = pointer

    @classmethod
    def from_image(cls, context: Context, drawing: ImageLike) -> Strokes:
        """Creates the strokes of a drawing (see add_image), for images of its size."""
        image = image_of(context, drawing, "srgb")
        out = cls(context, *image.size[:2])
        out.add_image(image)
        return out

    def add(self, phase: Phase | str, points: ArrayLike, radius: float, positive: bool) -> None:
        """Adds a stroke along points (n, 2), for the "plane" or the "lights"; points and radius are in pixels. It
        marks the plane (or lights) if positive, else its surroundings."""
        array = np.ascontiguousarray(points, np.float32)
        if array.ndim == 1 and array.size == 2:
            array = array[None]
        if array.ndim != 2 or array.shape[1] != 2:
            raise ValueError(f"points has the shape (n, 2), not {array.shape}")
        place = _arrays.pointer(array, ctypes.c_float)
        self._call("add", _params.member(Phase, phase), place, len(array), radius, int(bool(positive)))

    def add_image(self, drawing: ImageLike) -> None:
        """Adds the strokes of a drawing of the same size: green is plane, red not plane, yellow light, blue not light.
        An array of uint8 is sRGB."""
        self._call("add_image", image_of(self._context, drawing, "srgb"))

    def add_text(self, description: str) -> None:
        """Adds the strokes of a text, one per line: kind, radius, and x and y of each point, as in
        "light 3 310.5 30 320 31"."""
        self._call("add_text", _params.text(description, "description"))


def set_strokes(stage: Handle, strokes: Strokes | ImageLike | None, *arguments: Any) -> None:
    """Calls luxfer_<stage>_set_strokes; converts a drawing to strokes first. The strokes are the last argument."""
    if strokes is not None and not isinstance(strokes, Strokes):
        strokes = Strokes.from_image(stage.context, strokes)
    stage._call("set_strokes", *arguments, strokes)
