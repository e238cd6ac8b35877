"""Images: from files and arrays, and back."""

from __future__ import annotations

import ctypes
import dataclasses
import os
from typing import TYPE_CHECKING, Any, Union, cast

import numpy as np

from . import _abi, _arrays, _params
from ._handle import Handle, call
from ._pointers import POINTER
from .types import ColourSpace, MergeReport, PhotoMetadata

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, DTypeLike, NDArray

    from typing_extensions import Unpack

    from .context import Context
    from .types import MergeParams

    ImageLike = Union["Image", ArrayLike]


#: Number of elements of the arrays about the photos that merge_exposures merges, at most.
MAX_EXPOSURES = 16


class Image(Handle):
    """An image of 32-bit floats: scene-linear Rec.709 colours, or data. It never changes.

    `pixels` is an array of the shape (height, width) or (height, width, channels), of uint8, uint16, float16 or
    float32, copied directly from its memory; integers represent [0, 1]. `colour_space` is the encoding of the values:
    "linear" or "srgb".

    >>> image = Image(context, np.full((4, 6, 3), 128, np.uint8), "srgb")
    >>> image.size
    (6, 4, 3)
    >>> print(np.asarray(image)[0, 0].round(3))
    [0.216 0.216 0.216]
    """

    kind = "image"

    def __init__(self, context: Context, pixels: ArrayLike, colour_space: ColourSpace | str = ColourSpace.LINEAR) -> None:
        self._context = context
        view, _keep = _arrays.view(_floats(pixels), colour_space)
        handle = POINTER(_abi.luxfer_image)()
        call(context, "luxfer_image_create", context, view, handle)
        self._pointer = handle

    @classmethod
    def load(cls, context: Context, path: str | os.PathLike[str], colour_space: ColourSpace | str = ColourSpace.SRGB) -> Image:
        """Loads a JPEG, PNG, WebP, TIFF, BMP, GIF, Radiance HDR or OpenEXR file, upright. Use "srgb" for pictures,
        "linear" for data such as masks."""
        space = _params.member(ColourSpace, colour_space)
        return made(context, "luxfer_image_load", context, _params.text(os.fspath(path), "path"), space)

    @classmethod
    def from_bytes(cls, context: Context, data: bytes, colour_space: ColourSpace | str = ColourSpace.SRGB) -> Image:
        """Loads an image file from its bytes, as load does."""
        space = _params.member(ColourSpace, colour_space)
        return made(context, "luxfer_image_load_memory", context, data, len(data), space)

    def save(self, path: str | os.PathLike[str], exposure: float = 1.0) -> None:
        """Saves the image as .png, multiplied by exposure and encoded as sRGB, or unchanged as .exr."""
        self._call("save", _params.text(os.fspath(path), "path"), exposure)

    @property
    def size(self) -> tuple[int, int, int]:
        """Width, height and the number of channels."""
        numbers = [ctypes.c_uint32() for _ in range(3)]
        self._call("get_size", *numbers)
        return numbers[0].value, numbers[1].value, numbers[2].value

    @property
    def metadata(self) -> PhotoMetadata:
        """Metadata of a loaded photo's file, and how its colours were converted; 0 means unknown."""
        return cast(PhotoMetadata, self._read("get_metadata", _abi.luxfer_photo_metadata))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width and number of channels: the shape of numpy()."""
        width, height, channels = self.size
        return height, width, channels

    def read(
        self, out: NDArray[Any], first_channel: int = 0, colour_space: ColourSpace | str = ColourSpace.LINEAR
    ) -> NDArray[Any]:
        """Writes the channels from first_channel on into an array of uint8, uint16, float16 or float32; returns the
        array. It may be a part of a larger array, but the channels of a pixel must be contiguous.

        >>> frame = np.zeros((2, 4, 4), np.float32)
        >>> _ = Image(context, [[0.25, 1.0]]).read(frame[1:, 2:, 3])
        >>> print(frame[1, :, 3])
        [0.   0.   0.25 1.  ]
        """
        if not isinstance(out, np.ndarray):
            raise TypeError("out is a numpy array")
        if not out.flags.writeable:
            raise ValueError("out is read-only")
        if out.ndim not in (2, 3) or not _arrays.is_direct(out if out.ndim == 3 else out[:, :, None]):
            raise ValueError(
                f"out, {out.dtype} {out.shape} with strides {out.strides}, cannot be written where it lies: it must be of "
                "uint8, uint16, float16 or float32, and the channels of a pixel must be neighbours"
            )
        view, _ = _arrays.view(out, colour_space)
        self._call("read", first_channel, view)
        return out

    def numpy(self, dtype: DTypeLike = np.float32, colour_space: ColourSpace | str = ColourSpace.LINEAR) -> NDArray[Any]:
        """A new array of the shape (height, width, channels). For a display, use uint8 and "srgb". Images with more
        than 4 channels are always float32."""
        height, width, channels = self.shape
        out = np.empty((height, width, channels), dtype)
        for first in range(0, channels, 4):  # read 4 channels at a time, because a view has at most 4
            self.read(out[:, :, first : first + 4], first, colour_space)
        return out

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False:
            raise ValueError("the pixels of an Image are always copied into a numpy array")
        out = self.numpy()
        return out if dtype is None else out.astype(dtype, copy=False)

    def warp(self, to_source: ArrayLike, width: int, height: int) -> Image:
        """Creates an image whose pixel at p is the pixel of this image at to_source p; to_source is a 3 x 3
        homography."""
        matrix = _matrix(to_source, "to_source", 9)
        return self._get_image("warp", _arrays.pointer(matrix, ctypes.c_double), width, height)

    def __repr__(self) -> str:
        if not self._pointer:
            return "<luxfer.Image, closed>"
        width, height, channels = self.size
        return f"<luxfer.Image {width} x {height}, {channels} channels>"


def homography(context: Context, source: ArrayLike, target: ArrayLike) -> NDArray[np.float64]:
    """The 3 x 3 matrix that maps four points to four points; each array has x and y of each point.

    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> m = homography(context, square, np.multiply(square, 10))
    >>> print((m / m[2, 2]).round(6) + 0.0)
    [[10.  0.  0.]
     [ 0. 10.  0.]
     [ 0.  0.  1.]]
    """
    points = _matrix(source, "source", 8), _matrix(target, "target", 8)
    out = np.empty((3, 3))
    pointers = [_arrays.pointer(a, ctypes.c_double) for a in (*points, out)]
    call(context, "luxfer_homography_from_corners", context, *pointers)
    return out


def merge_exposures(
    context: Context, photos: Sequence[ImageLike], **params: Unpack[MergeParams]
) -> tuple[Image, MergeReport]:
    """Merges photos of one view with different exposures into one image, whose lamps are not clipped. Returns the image
    and the report of the merge, whose arrays have an element for each photo. `exposures` states the exposure of each
    photo, in any unit; without it, the exposures come from the metadata and the pixels.

    >>> photo = np.random.default_rng(1).uniform(0.01, 0.9, (64, 64, 1)).repeat(3, 2).astype(np.float32)
    >>> merged, report = merge_exposures(context, [photo, photo / 4], exposures=[4, 1])
    >>> merged.size, report.exposures[1] / report.exposures[0]
    ((64, 64, 3), 0.25)
    """
    exposures = list(params.get("exposures", ()))
    if exposures and len(exposures) != len(photos):
        raise ValueError(f"exposures has {len(exposures)} values for {len(photos)} photos")
    padded = {**params, "exposures": exposures + [0.0] * (MAX_EXPOSURES - len(exposures))}
    if len(photos) > MAX_EXPOSURES:
        padded["exposures"] = [0.0] * MAX_EXPOSURES  # the library refuses so many photos
    settings = _params.fill(_abi.luxfer_merge_params, padded, [])
    images = [image_of(context, photo) for photo in photos]
    handles = (POINTER(_abi.luxfer_image) * max(1, len(images)))(*(image.handle for image in images))
    handle, report = POINTER(_abi.luxfer_image)(), _abi.luxfer_merge_report()
    call(
        context, "luxfer_image_merge_exposures", context, handles, len(images), settings, handle, report,
        ctypes.sizeof(report),
    )  # fmt: skip
    found = cast(MergeReport, _params.report(report))
    arrays = ("exposures", "errors", "stated", "shift_x", "shift_y")
    short = {name: getattr(found, name)[: found.count] for name in arrays}
    return Image._adopt(context, handle), dataclasses.replace(found, **short)


def made(context: Context, name: str, *arguments: Any) -> Image:
    """Calls a function of the library that creates an image; returns the image."""
    handle = POINTER(_abi.luxfer_image)()
    call(context, name, *arguments, handle)
    return Image._adopt(context, handle)


def image_of(context: Context, value: ImageLike, colour_space: ColourSpace | str = ColourSpace.LINEAR) -> Image:
    """Converts an array to an Image; an Image is returned as it is."""
    return value if isinstance(value, Image) else Image(context, value, colour_space)


def _floats(pixels: ArrayLike) -> NDArray[Any]:
    array = np.asarray(pixels)
    return array.astype(np.float32) if not isinstance(pixels, np.ndarray) and array.dtype.kind in "iuf" else array


def _matrix(values: ArrayLike, name: str, count: int) -> NDArray[np.float64]:
    out = np.ascontiguousarray(values, np.float64)
    if out.size != count:
        raise ValueError(f"{name} is {count} numbers, not {out.size}")
    return out
