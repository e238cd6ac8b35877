"""Print sheets: prints the exemplar in pale colours between marks, and aligns a photo of the painted sheet with it."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, cast

from . import _abi, _params
from ._handle import call
from ._pointers import POINTER
from .image import Image, image_of, made
from .types import SheetReport

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .types import SheetParams


def print_sheet(context: Context, picture: ImageLike, **params: Unpack[SheetParams]) -> Image:
    """Draws the sheet to print for a picture (linear, 1 is white). Save it as PNG and print it at `dpi` without
    scaling.

    >>> sheet = print_sheet(context, np.full((90, 120, 3), 0.5), dpi=60)
    >>> artwork, report = align_sheet(context, sheet, 120, 90, dpi=60)
    >>> artwork.size, report.marks
    ((120, 90, 3), 10)
    """
    settings = _params.fill(_abi.luxfer_sheet_params, params, [])
    return made(context, "luxfer_sheet_print", image_of(context, picture), settings)


def align_sheet(
    context: Context, photo: ImageLike, width: int, height: int, **params: Unpack[SheetParams]
) -> tuple[Image, SheetReport]:
    """Aligns a photo of a painted sheet: finds the marks and resamples the photo to the printed picture, which had
    width x height pixels. The settings must equal the settings of the print. Returns the artwork and the quality of
    the alignment."""
    pointer = POINTER(_abi.luxfer_image)()
    settings = _params.fill(_abi.luxfer_sheet_params, params, [])
    report = _abi.luxfer_sheet_report()
    call(context, "luxfer_sheet_align", image_of(context, photo), width, height, settings, pointer, report, ctypes.sizeof(report))
    return Image._adopt(context, pointer), cast(SheetReport, _params.report(report))
