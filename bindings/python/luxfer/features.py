"""The features of each pixel of a photo, for segmentation: colour, depth, position and normal."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, cast

from . import _abi, _params
from .image import Image, image_of
from .job import Job, Progress, StageBase
from .strokes import set_strokes
from .types import DepthKind, FeaturesImage, FeaturesReport, Normalisation
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .rectify import Rectify
    from .strokes import Strokes
    from .types import FeaturesParams


class Features(StageBase):
    """Ten channels for each pixel: L*, a*, b*, depth, position x, y, z and normal x, y, z.

    >>> Features(context, photo).run().image("channels").size[2]
    10
    """

    kind = "features"

    def __init__(self, context: Context, photo: ImageLike | None = None) -> None:
        super().__init__(context)
        if photo is not None:
            self.set_photo(photo)

    def set_photo(self, photo: ImageLike) -> None:
        """Sets the photo: linear RGB, 1 = display white."""
        self._call("set_photo", image_of(self._context, photo))

    def set_depth(self, depth: ImageLike | None, kind: DepthKind | str = DepthKind.ALONG_Z) -> None:
        """Sets a depth map of the photo's size in any unit, "along-z" or "along-ray". None means no depth map."""
        image = None if depth is None else image_of(self._context, depth)
        self._call("set_depth", image, _params.member(DepthKind, kind))

    def set_network(
        self, path: str | os.PathLike[str] | None, normalisation: Normalisation | str = Normalisation.BY_SIZE
    ) -> None:
        """Sets an ONNX file, such as MiDaS or DPT, that estimates depth if there is no depth map. None means no
        network.

        normalisation is the normalisation of its input colours: "by-size", "imagenet", "half" or "none".
        """
        name = None if path is None else _params.text(os.fspath(path), "path")
        self._call("set_network", name, _params.member(Normalisation, normalisation))

    def set_view(self, rectify: Rectify | None) -> None:
        """Takes the lines and the camera that a Rectify has found in this photo. None means no lines."""
        self._call("set_view", None if rectify is None else rectify)

    def set_strokes(self, strokes: Strokes | ImageLike | None) -> None:
        """Sets the strokes on the photo, which help to fit the room layout: strokes for the plane show where one of
        its planes is and where it is not, and lights lie on this plane. A drawing is converted by Strokes.from_image.
        None means no strokes."""
        set_strokes(self, strokes)

    def start(self, **params: Unpack[FeaturesParams]) -> Job[Features]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_features_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[FeaturesParams]) -> Features:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    def image(self, which: FeaturesImage | str = FeaturesImage.CHANNELS) -> Image:
        """An image of the results: "channels", "depth-confidence" or "network-depth"."""
        return self._get_image("get_image", _params.member(FeaturesImage, which))

    @property
    def report(self) -> FeaturesReport:
        """Quality of the features."""
        return cast(FeaturesReport, self._read("get_report", _abi.luxfer_features_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the features."""
        return warnings_of(self)
