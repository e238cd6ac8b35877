"""The bodies of hanging lamps in a photo."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, cast

import numpy as np

from . import _abi, _arrays, _params
from ._handle import call
from .image import image_of
from .types import Pendant

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .rectify import Rectify
    from .types import PendantsParams


def find_pendants(
    context: Context,
    photo: ImageLike,
    mask: ImageLike,
    view: Rectify | None = None,
    suspensions: ArrayLike = (),
    **params: Unpack[PendantsParams],
) -> list[Pendant]:
    """Finds the bodies of the lamps that a mask marks: each connected region is a lamp, numbered from the top. `view`
    is a rectification of the photo; without it, the settings focal, principal and axes are the camera. `suspensions`
    (n, 2) are pixels where suspensions meet the ceiling. Scene.add_pendants adds a lamp to a scene.

    >>> y, x = np.mgrid[:120, :160] + 0.5
    >>> globe = (np.hypot(x - 80, y - 60) < 30).astype(np.float32)
    >>> lamp, = find_pendants(context, globe, globe, focal=400, known="diameter", known_length=0.4)
    >>> lamp.kind.name, round(lamp.diameter[0], 3)
    ('GLOBE', 0.4)
    >>> mesh, material = Scene.demo(context, "target-room").add_pendants(lamp, [(2, 2.5, 2)], luminance=2000)
    """
    settings = _params.fill(_abi.luxfer_pendants_params, params, [])
    hooks = np.ascontiguousarray(suspensions, np.float64)
    if hooks.size and (hooks.ndim != 2 or hooks.shape[1] != 2):
        raise ValueError(f"suspensions has the shape (n, 2), not {hooks.shape}")
    place = _arrays.pointer(hooks, ctypes.c_double) if hooks.size else None
    capacity, count = _abi.LUXFER_MAX_PENDANTS, ctypes.c_size_t()
    lamps = (_abi.luxfer_pendant * capacity)()
    images = image_of(context, photo), image_of(context, mask)
    size = ctypes.sizeof(_abi.luxfer_pendant)
    call(
        context, "luxfer_pendants_find", context, *images, view, place, hooks.size // 2, settings, lamps, size, capacity, count
    )
    return [cast(Pendant, _params.report(lamp)) for lamp in lamps[: count.value]]
