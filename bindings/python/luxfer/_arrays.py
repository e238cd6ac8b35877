"""Describes numpy arrays as image views of the library, without a copy if two strides can describe the layout."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from . import _abi, _params
from ._pointers import POINTER
from .types import ColourSpace, Sample, View

SAMPLES = {np.dtype("u1"): Sample.U8, np.dtype("=u2"): Sample.U16, np.dtype("=f2"): Sample.F16, np.dtype("=f4"): Sample.F32}


def is_direct(array: np.ndarray[Any, Any]) -> bool:
    """Whether the library can use an array (rows, columns, channels) in place."""
    if array.dtype not in SAMPLES:
        return False
    rows, columns, channels = array.shape
    row, column, sample = array.strides
    pixel = channels * array.itemsize
    return (
        (channels == 1 or sample == array.itemsize)
        and (columns == 1 or column >= pixel)
        and (rows == 1 or abs(row) >= (columns - 1) * max(column, pixel) + pixel)
    )


def view(array: np.ndarray[Any, Any], colour_space: ColourSpace | str | int) -> tuple[Any, np.ndarray[Any, Any]]:
    """Returns a luxfer_image_view of an array, and the array whose memory the view describes: the given array, or a
    copy if no view can describe it. A view can describe rows in reverse order, as in array[::-1]."""
    if array.ndim == 2:
        array = array[:, :, None]
    if array.ndim != 3:
        raise ValueError(f"an image has the shape (height, width) or (height, width, channels), not {array.shape}")
    if array.dtype == bool or array.dtype.kind in "iu" and array.dtype not in SAMPLES:
        # Other integer types, such as bool masks, are data: convert them to float without scaling to [0, 1].
        array = array.astype(np.float32)
    elif array.dtype.kind == "f" and array.dtype not in SAMPLES:
        array = array.astype(np.float32)
    elif array.dtype not in SAMPLES and array.dtype.newbyteorder("=") not in SAMPLES:
        raise TypeError(f"an image is made of numbers, not of {array.dtype}")
    if not is_direct(array):
        array = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))
    rows, columns, channels = array.shape
    pixel = channels * array.itemsize
    column = array.strides[1] if columns > 1 else pixel
    row = array.strides[0] if rows > 1 else columns * column
    first = array.__array_interface__["data"][0]
    out = _params.fill(
        _abi.luxfer_image_view,
        {
            "channels": channels,
            "sample": SAMPLES[array.dtype],
            "colour_space": colour_space,
            "width": columns,
            "height": rows,
            "flags": View.BOTTOM_UP if row < 0 else 0,
            "pixel_stride": column,
            "row_stride": abs(row),
            "byte_size": (rows - 1) * abs(row) + (columns - 1) * column + pixel if rows and columns else 0,
            "data": first + (rows - 1) * row if row < 0 else first,
        },
        [],
    )
    return out, array


def pointer(array: np.ndarray[Any, Any] | None, kind: Any) -> Any:
    """A ctypes pointer to an array's first element."""
    return None if array is None else array.ctypes.data_as(POINTER(kind))
