"""Photometry between IES files and the intensity distributions of building models."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..photometry import Distribution

if TYPE_CHECKING:
    from .luminaires import Luminaire
    from .rooms import Room

#: Steps in degrees of the planes and of the angles in a plane. [convention]
PLANE_STEP, ANGLE_STEP = 15, 2.5

Table = tuple[list[float], list[float], NDArray[np.float64]]


def upright(points: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    """Points or directions of a scene, with z up."""
    p = np.asarray(points, float)
    return np.stack([p[..., 0], -p[..., 2], p[..., 1]], axis=-1)


def level(points: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    """Points or directions with z up in a scene, where y is up."""
    p = np.asarray(points, float)
    return np.stack([p[..., 0], p[..., 2], -p[..., 1]], axis=-1)


def table(room: Room, lamp: Luminaire) -> Table:
    """Planes C and angles gamma in degrees, and the intensities (planes, angles) in cd per 1000 lm."""
    planes = [float(c) for c in range(0, 360, PLANE_STEP)]
    angles = np.arange(0, 180 + ANGLE_STEP, ANGLE_STEP).tolist()
    product = lamp.product
    with Distribution.load_memory(room.scene.context, product.photometry, product.format) as found:
        flux = found.report.flux
        values = np.array([[found.intensity(c, g) for g in angles] for c in planes]) * 1000 / flux
    if np.ptp(values, axis=0).max() <= 1e-6 * values.max():  # alike all around  [rounding]
        return planes[:1], angles, values[:1]
    return planes, angles, values


def ies(planes: Sequence[float], angles: Sequence[float], values: NDArray[np.float64], size: Sequence[float]) -> bytes:
    """An IES file of planes C and angles gamma in degrees with intensities (planes, angles), for an opening of that
    length, width and height in metres."""
    order = np.argsort(np.asarray(planes, float) % 360)
    cs = [float(planes[i]) % 360 for i in order]
    rows = [np.asarray(values[i], float) for i in order]
    if not len(cs) or any(b - a < 1e-6 for a, b in zip(cs, cs[1:])):
        raise ValueError("its planes are not distinct")
    gammas = [float(g) for g in angles]
    if len(gammas) < 2 or any(b <= a for a, b in zip(gammas, gammas[1:])) or gammas[0] < 0 or gammas[-1] > 180 + 1e-6:
        raise ValueError("its angles do not rise from 0 to 180 degrees")
    if not all(np.isfinite(r).all() and (r >= 0).all() for r in rows) or not any(r.any() for r in rows):
        raise ValueError("its intensities are not all positive numbers")
    if gammas[0] > 0 and gammas[0] != 90:  # the format begins at 0 or 90: the first intensity goes on
        gammas, rows = [0.0, *gammas], [np.concatenate([r[:1], r]) for r in rows]
    if gammas[-1] < 180 and gammas[-1] != 90:  # and ends at 90 or 180: beyond is no light
        end = 90.0 if gammas[-1] < 90 else 180.0
        beyond = [min(gammas[-1] + 0.1, end - 0.01), end]
        gammas, rows = [*gammas, *beyond], [np.concatenate([r, [0.0, 0.0]]) for r in rows]
    if len(cs) > 1:
        if cs[0] > 0:
            raise ValueError("it has no plane C = 0")
        cs, rows = [*cs, 360.0], [*rows, rows[0]]
    length, width, height = (abs(float(v)) for v in size)
    numbers = lambda values: "\n".join(
        " ".join(f"{v:.7g}" for v in values[i : i + 12]) for i in range(0, len(values), 12)
    )  # noqa: E731
    body = "\n".join(numbers(r.tolist()) for r in rows)
    head = f"1 -1 1 {len(gammas)} {len(cs)} 1 2 {width:.6g} {length:.6g} {height:.6g}\n1 1 0"
    return f"IESNA:LM-63-2002\nTILT=NONE\n{head}\n{numbers(gammas)}\n{numbers(cs)}\n{body}\n".encode()


def flux(planes: Sequence[float], angles: Sequence[float], values: NDArray[np.float64]) -> float:
    """Flux in lumens of intensities in candela whose planes stand at equal distances, as a check of a model.

    >>> round(flux([0], [0, 90, 180], np.array([[100.0, 100.0, 100.0]])), 3) == round(400 * math.pi, 3)
    True
    """
    mean = np.asarray(values, float).mean(axis=0)
    cosines = np.cos(np.radians(np.asarray(angles, float)))
    return float(2 * math.pi * (0.5 * (mean[1:] + mean[:-1]) * (cosines[:-1] - cosines[1:])).sum())
