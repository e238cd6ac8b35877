"""Synthesises an emissive texture of any size from the unwarped lights of a photo, with a list of its lamps."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, cast

import numpy as np

from . import _abi, _arrays, _params
from .image import Image, _matrix, image_of
from .job import Job, Progress, StageBase
from .types import EmissionImage, EmissionReport, Luminaire
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .types import EmissionParams


class Emission(StageBase):
    """Continues the pattern of the exemplar's lights over a texture of any size.

    >>> lamps = np.zeros((64, 64, 3), np.float32)
    >>> lamps[8::16, 8::16] = lamps[9::16, 8::16] = lamps[8::16, 9::16] = lamps[9::16, 9::16] = 1
    >>> emission = Emission(context, lamps, lamps[:, :, 0], np.ones((64, 64)))
    >>> emission.run(width=96, height=80).image("texture").size
    (96, 80, 3)
    >>> emission.report.luminaires == len(emission.luminaires)
    True
    """

    kind = "emission"

    def __init__(
        self,
        context: Context,
        unwarped: ImageLike | None = None,
        light: ImageLike | None = None,
        valid: ImageLike | None = None,
    ) -> None:
        super().__init__(context)
        if unwarped is not None and light is not None and valid is not None:
            self.set_exemplar(unwarped, light, valid)
        elif not (unwarped is None and light is None and valid is None):
            raise TypeError("an exemplar is three images: unwarped, light and valid")

    def set_exemplar(self, unwarped: ImageLike, light: ImageLike, valid: ImageLike) -> None:
        """Sets three images of one size: the unwarped photo, the unwarped confidence of the lights, and the mask where
        both are valid."""
        images = [image_of(self._context, image) for image in (unwarped, light, valid)]
        self._call("set_exemplar", *images)

    def set_photo(self, photo: ImageLike | None, to_photo: ArrayLike | None = None) -> None:
        """Sets the photo from which full detail is recovered, as Rectify.undistort makes it, and the 3 x 3 homography
        from unwarped to photo pixels (RectifyReport.to_photo). None means no photo."""
        if photo is None:
            return self._call("set_photo", None, None)
        if to_photo is None:
            raise TypeError("a photo needs to_photo, the map from unwarped to photo pixels")
        matrix = _matrix(to_photo, "to_photo", 9)
        return self._call("set_photo", image_of(self._context, photo), _arrays.pointer(matrix, ctypes.c_double))

    def add_style(
        self,
        unwarped: ImageLike,
        light: ImageLike,
        valid: ImageLike,
        weights: ImageLike,
        *,
        scale: float = 1.0,
        photo: ImageLike | None = None,
        to_photo: ArrayLike | None = None,
    ) -> None:
        """Adds an exemplar with scale unwarped pixels per texel. The image weights is stretched over the texture; its
        value at a lamp is the probability that the lamp is taken from this exemplar."""
        images = [image_of(self._context, image) for image in (unwarped, light, valid)]
        if (photo is None) != (to_photo is None):
            raise TypeError("a photo needs to_photo, the map from unwarped to photo pixels")
        matrix = None if to_photo is None else _arrays.pointer(_matrix(to_photo, "to_photo", 9), ctypes.c_double)
        source = None if photo is None else image_of(self._context, photo)
        self._call("add_style", *images, source, matrix, scale, image_of(self._context, weights))

    def clear_styles(self) -> None:
        """Removes all added exemplars."""
        self._call("clear_styles")

    def start_composition(self, **params: Unpack[EmissionParams]) -> Job[Emission]:
        """Starts a job that composes a texture; tile() then renders any part of it."""
        return self._job("start_composition", _params.fill(_abi.luxfer_emission_params, params, []))

    def tile(self, x: int, y: int, width: int, height: int) -> Image:
        """Renders a part of the composed texture: an image with four channels, RGB and a mask that is 1 on lamps."""
        return self._get_image("render_tile", x, y, width, height)

    def start(self, **params: Unpack[EmissionParams]) -> Job[Emission]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_emission_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[EmissionParams]) -> Emission:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    def image(self, which: EmissionImage | str = EmissionImage.TEXTURE) -> Image:
        """An image of the results: "texture", "mask", "exemplar-guides" or "guides"."""
        return self._get_image("get_image", _params.member(EmissionImage, which))

    @property
    def report(self) -> EmissionReport:
        """Quality of the texture."""
        return cast(EmissionReport, self._read("get_report", _abi.luxfer_emission_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the texture; for a composition the list is empty."""
        return warnings_of(self)

    @property
    def luminaires(self) -> list[Luminaire]:
        """The lamps of the texture."""
        count = self.report.luminaires
        return [cast(Luminaire, self._read("get_luminaire", _abi.luxfer_luminaire, i)) for i in range(count)]

    def outline(self, index: int) -> NDArray[np.float64]:
        """The corners (n, 2) of a lamp's outline, in texels."""
        luminaire = self._read("get_luminaire", _abi.luxfer_luminaire, index)
        out = np.empty((luminaire.corners, 2))
        for corner, point in enumerate(out):
            x, y = ctypes.c_double(), ctypes.c_double()
            self._call("get_corner", index, corner, x, y)
            point[:] = x.value, y.value
        return out
