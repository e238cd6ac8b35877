"""Finds vanishing points and the camera from the straight lines of a photo, and unwarps a plane to a frontal view."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from . import _abi, _params
from .image import Image, image_of
from .job import Job, Progress, StageBase
from .types import RectifyImage, RectifyReport
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .types import RectifyParams


class Rectify(StageBase):
    """Finds lines, vanishing points and the camera; with a mask, also unwarps the plane that the mask marks.

    >>> rectify = Rectify(context, photo).run(max_side=256)
    >>> [len(axis) for axis in rectify.report.vanishing_points]
    [3, 3, 3]
    """

    kind = "rectify"

    def __init__(self, context: Context, photo: ImageLike | None = None, mask: ImageLike | None = None) -> None:
        super().__init__(context)
        if photo is not None:
            self.set_photo(photo)
        if mask is not None:
            self.set_mask(mask)

    def set_photo(self, photo: ImageLike) -> None:
        """Sets the photo: linear RGB."""
        self._call("set_photo", image_of(self._context, photo))

    def set_mask(self, mask: ImageLike | None) -> None:
        """Sets the mask of the plane to unwarp: of the photo's size, 1 on the plane, 0 elsewhere. With None, only
        lines and vanishing points are found."""
        self._call("set_mask", None if mask is None else image_of(self._context, mask))

    def start(self, **params: Unpack[RectifyParams]) -> Job[Rectify]:
        """Starts this stage as a job; the settings are keyword arguments."""
        keep: list[object] = []
        return self._job("start", _params.fill(_abi.luxfer_rectify_params, params, keep))

    def run(self, progress: Progress | None = None, **params: Unpack[RectifyParams]) -> Rectify:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    def image(self, which: RectifyImage | str) -> Image:
        """An image of the results: "unwarped" or "valid"."""
        return self._get_image("get_image", _params.member(RectifyImage, which))

    def undistort(self, image: ImageLike) -> Image:
        """An image of the photo's size as a lens without distortion would show it; a copy if no distortion was
        undone."""
        return self._get_image("undistort", image_of(self._context, image))

    @property
    def report(self) -> RectifyReport:
        """The results and their errors."""
        return cast(RectifyReport, self._read("get_report", _abi.luxfer_rectify_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the camera, and the plane if it has been unwarped."""
        return warnings_of(self)
