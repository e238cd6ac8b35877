"""Computes a mask, with a confidence for each pixel, from a few strokes on a photo."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from . import _abi, _params
from .image import Image, image_of
from .job import Job, Progress, StageBase
from .strokes import set_strokes
from .types import Phase, SegmentImage, SegmentReport
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .strokes import Strokes
    from .types import SegmentParams


class Segment(StageBase):
    """Segments a photo by strokes. To improve the result, set more strokes and run again.

    >>> segment = Segment(context, Features(context, photo).run().image())
    >>> segment.set_strokes("plane", strokes)
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
        """Restricts the segmentation to pixels where the mask is 1. None means the whole image."""
        self._call("set_region", None if region is None else image_of(self._context, region))

    def set_strokes(self, phase: Phase | str, strokes: Strokes | ImageLike | None) -> None:
        """Sets the strokes for the mask of the "plane" or of the "lights". A drawing is converted by
        Strokes.from_image. None means no strokes."""
        set_strokes(self, strokes, _params.member(Phase, phase))

    def start(self, **params: Unpack[SegmentParams]) -> Job[Segment]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_segment_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[SegmentParams]) -> Segment:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    def image(self, which: SegmentImage | str = SegmentImage.MASK) -> Image:
        """An image of the results: "mask", "confidence" or "unseen"."""
        return self._get_image("get_image", _params.member(SegmentImage, which))

    @property
    def report(self) -> SegmentReport:
        """Quality of the segmentation."""
        return cast(SegmentReport, self._read("get_report", _abi.luxfer_segment_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the mask, checked against the current strokes."""
        return warnings_of(self)
