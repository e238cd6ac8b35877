"""Computes a mask, with a confidence for each pixel, from a few strokes on a photo."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from . import _abi, _arrays, _params
from .image import Image, image_of
from .job import Job, Progress, StageBase
from .types import Phase, SegmentImage, SegmentReport
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .types import SegmentParams


def stroke_arguments(points: ArrayLike, radius: float, positive: bool) -> tuple[Any, ...]:
    """The tail of luxfer_segment_add_stroke and its like."""
    array = np.ascontiguousarray(points, np.float32)
    if array.ndim == 1 and array.size == 2:
        array = array[None]
    if array.ndim != 2 or array.shape[1] != 2:
        raise ValueError(f"points has the shape (n, 2), not {array.shape}")
    return _arrays.pointer(array, ctypes.c_float), len(array), radius, int(bool(positive))


class Segment(StageBase):
    """Segmentation by strokes; add strokes after a result and run again.

    >>> segment = Segment(context, Features(context, photo).run().image())
    >>> segment.add_strokes_image(strokes, "plane")
    >>> segment.run(seed=3).image("mask").size[2]
    1
    """

    kind = "segment"

    def __init__(self, context: Context, features: ImageLike | None = None) -> None:
        super().__init__(context)
        if features is not None:
            self.set_features(features)

    def set_features(self, features: ImageLike) -> None:
        """Sets the channels of Features, or any image of 1 to 16 channels."""
        self._call("set_features", image_of(self._context, features))

    def set_region(self, region: ImageLike | None) -> None:
        """Restricts the segmentation to pixels where the mask is 1; None: everywhere."""
        self._call("set_region", None if region is None else image_of(self._context, region))

    def add_stroke(self, points: ArrayLike, radius: float, positive: bool) -> None:
        """Adds a stroke along points (n, 2) in pixels; positive on the class that is sought."""
        self._call("add_stroke", *stroke_arguments(points, radius, positive))

    def add_strokes_image(self, drawing: ImageLike, phase: Phase | str) -> None:
        """Adds the strokes of a drawing that concern the phase "plane" or "lights": green plane, red not plane, yellow light,
        blue not light. An array of uint8 is taken as sRGB."""
        drawing = image_of(self._context, drawing, "srgb")
        self._call("add_strokes_image", drawing, _params.member(Phase, phase))

    def add_strokes_text(self, description: str, phase: Phase | str) -> None:
        """Adds the strokes that a text describes, one a line: "light 3 310.5 30 320 31"."""
        self._call("add_strokes_text", _params.text(description, "description"), _params.member(Phase, phase))

    def clear_strokes(self) -> None:
        """Removes all strokes."""
        self._call("clear_strokes")

    def start(self, **params: Unpack[SegmentParams]) -> Job[Segment]:
        """Starts the work."""
        return self._job("start", _params.fill(_abi.luxfer_segment_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[SegmentParams]) -> Segment:
        """Starts the work and waits for it."""
        return self.start(**params).wait(progress)

    def image(self, which: SegmentImage | str = SegmentImage.MASK) -> Image:
        """ "mask", "confidence" or "unseen"."""
        return self._get_image("get_image", _params.member(SegmentImage, which))

    @property
    def report(self) -> SegmentReport:
        """Quality of the segmentation."""
        return cast(SegmentReport, self._read("get_report", _abi.luxfer_segment_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the mask, held against the strokes as they are now."""
        return warnings_of(self)
