"""Lighting design: luminaire files, colour temperature, glare, LED primaries, false colours, presets of standards."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

from . import _abi, _params
from ._handle import Handle, call
from ._pointers import POINTER
from .image import Image, image_of, made
from .types import DistributionFormat, DistributionReport, GlareReport, Mixture, Preset, Projection, TemperatureFit

if TYPE_CHECKING:
    from .context import Context
    from typing_extensions import Unpack

    from .image import ImageLike
    from .types import FalseColourParams


#: Endings of the names of luminaire files.
LUMINAIRES = (".ies", ".ldt", ".xml", ".iesxml", ".tm33", ".gldf")


def luminaire_path(name: str | os.PathLike[str]) -> Path:
    """The path of a luminaire file, without the variant that may follow the name of a .gldf file, as in
    lamp.gldf#black."""
    text = os.fspath(name)
    mark = text.lower().find(".gldf#")
    return Path(text if mark < 0 else text[: mark + len(".gldf")])


class Distribution(Handle):
    """A luminous intensity distribution; loads and saves IES, EULUMDAT, TM-33 and GLDF files.

    >>> panel = "IESNA:LM-63-2002\\nTILT=NONE\\n1 -1 1 3 1 1 2 0.6 0.6 0\\n1 1 30\\n0 45 90\\n0\\n1000 707 0\\n"
    >>> distribution = Distribution.load_memory(context, panel.encode(), "ies")
    >>> distribution.report.watts, distribution.intensity(90, 0)
    (30.0, 1000.0)
    """

    kind = "distribution"

    @classmethod
    def load(cls, context: Context, path: str | os.PathLike[str], variant: str | int | None = None) -> Distribution:
        """Loads an .ies, .ldt, .xml (TM-33) or .gldf file; variant is the name, the id or the index of a variant in a
        .gldf file, whose first variant is read otherwise."""
        pointer = POINTER(_abi.luxfer_distribution)()
        name = os.fspath(path) + ("" if variant is None else f"#{variant}")
        call(context, "luxfer_distribution_load", context, name.encode(), pointer)
        return cls._adopt(context, pointer)

    @classmethod
    def load_memory(cls, context: Context, data: bytes, format: DistributionFormat | str = "any") -> Distribution:
        """Loads a distribution from the bytes of a file in the format "ies", "ldt", "tm33" or "gldf"; "any" tells the
        format by the content."""
        pointer = POINTER(_abi.luxfer_distribution)()
        kind = _params.member(DistributionFormat, format)
        call(context, "luxfer_distribution_load_memory", context, data, len(data), kind, pointer)
        return cls._adopt(context, pointer)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Saves the distribution as an .ies, .ldt, .xml (TM-33) or .gldf file."""
        self._call("save", os.fspath(path).encode())

    @property
    def report(self) -> DistributionReport:
        """Summary of the distribution."""
        return cast(DistributionReport, self._read("get_report", _abi.luxfer_distribution_report))

    @property
    def name(self) -> str:
        """The luminaire's name."""
        return self._get_text("get_name")

    def intensity(self, c: float, gamma: float) -> float:
        """The luminous intensity in candela in a direction. Angles in degrees: c around the vertical axis, gamma from
        straight down."""
        out = ctypes.c_double()
        self._call("get_intensity", c, gamma, out)
        return out.value


def colour_temperature(context: Context, colour: Sequence[float]) -> tuple[float, float]:
    """The correlated colour temperature in kelvin of a linear colour, and its signed distance Duv from the blackbody.

    >>> [round(v, 3) for v in colour_temperature(context, (1, 1, 1))][1]
    0.003
    """
    kelvin, duv = ctypes.c_double(), ctypes.c_double()
    call(context, "luxfer_colour_to_temperature", context, _three(colour), kelvin, duv)
    return kelvin.value, duv.value


def colour_of_temperature(context: Context, kelvin: float, duv: float = 0) -> tuple[float, float, float]:
    """The linear colour, with luminance 1, of a colour temperature."""
    rgb = (ctypes.c_double * 3)()
    call(context, "luxfer_temperature_to_colour", context, kelvin, duv, rgb)
    return rgb[0], rgb[1], rgb[2]


def glare(
    context: Context,
    image: ImageLike,
    fov_y: float,
    threshold: float = 0,
    projection: Projection | str = Projection.PERSPECTIVE,
    vertical_illuminance: float = 0,
) -> GlareReport:
    """The unified glare rating and the daylight glare probability of a luminance image in cd/m². Pixels above
    threshold are glare sources; 0 means five times the mean luminance. projection is "perspective" or "angular", a
    fisheye whose height shows the angle fov_y. The daylight glare probability needs an image of the half-space ahead,
    or the vertical_illuminance at the eye in lux.

    >>> sky = np.full((100, 100), 1000, np.float32)
    >>> report = glare(context, sky, np.pi, projection="angular")
    >>> round(report.vertical_illuminance), round(report.dgp, 3)
    (3142, 0.344)
    """
    settings = {"fov_y": fov_y, "threshold": threshold, "projection": projection}
    params = _params.fill(
        _abi.luxfer_glare_params, {**settings, "vertical_illuminance": vertical_illuminance}, []
    )
    report = _abi.luxfer_glare_report()
    call(context, "luxfer_image_rate_glare", image_of(context, image), params, report, ctypes.sizeof(report))
    return cast(GlareReport, _params.report(report))


def false_colour(context: Context, image: ImageLike, **params: Unpack[FalseColourParams]) -> Image:
    """Shows an image of luminance or illuminance in false colours of rising brightness, with a scale bar."""
    settings = _params.fill(_abi.luxfer_false_colour_params, params, [])
    return made(context, "luxfer_image_false_colour", image_of(context, image), settings)


def mix_primaries(
    context: Context, primaries: Sequence[Sequence[float]], colour: Sequence[float], max_drive: float = 1
) -> tuple[list[float], Mixture]:
    """Finds the drive levels of a luminaire's LEDs for a linear colour; returns them and a report on the mixture.

    >>> drives, light = mix_primaries(context, [(1, 0, 0), (0, 1, 0), (0, 0, 1)], (0.5, 0.25, 0.75))
    >>> [round(drive, 3) for drive in drives], light.in_gamut
    ([0.5, 0.25, 0.75], 1)
    """
    flat = [float(v) for primary in primaries for v in primary]
    drives = (ctypes.c_double * len(primaries))()
    report = _abi.luxfer_mixture()
    leds, wanted = (ctypes.c_double * len(flat))(*flat), _three(colour)
    call(context, "luxfer_mix_primaries", context, leds, len(primaries), max_drive, wanted, drives, report, ctypes.sizeof(report))
    return list(drives), cast(Mixture, _params.report(report))


def fit_temperature(
    context: Context, response: Sequence[float], target: Sequence[float], background: Sequence[float] = (0, 0, 0)
) -> TemperatureFit:
    """Finds the blackbody light that brings the mean radiance of a target nearest to a given one. response is the
    target's radiance for white light of 1 cd/m²."""
    report = _abi.luxfer_temperature_fit()
    vectors = (_three(v) for v in (response, background, target))
    call(context, "luxfer_fit_temperature", context, *vectors, report, ctypes.sizeof(report))
    return cast(TemperatureFit, _params.report(report))


def presets(context: Context) -> dict[str, Preset]:
    """The requirements of EN 12464-1 for kinds of rooms, by name."""
    count = ctypes.c_uint32()
    call(context, "luxfer_preset_get_count", context, count)
    found = {}
    for index in range(count.value):
        report = _abi.luxfer_preset()
        call(context, "luxfer_preset_get", context, index, report, ctypes.sizeof(report))
        row = cast(Preset, _params.report(report))
        found[row.name] = row
    return found


def _three(values: Sequence[float]) -> ctypes.Array[ctypes.c_double]:
    return (ctypes.c_double * 3)(*(float(v) for v in values))
