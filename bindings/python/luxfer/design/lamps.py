"""What is known of a lamp in a photo, to find its product by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from ..photometry import Distribution, colour_temperature
from ..types import Body, Doubt, Fixture, Pendant
from ..types import Luminaire as TextureLamp
from .openings import SHAPES, shape_of, sides_of

if TYPE_CHECKING:
    from ..context import Context

#: Colour temperatures in kelvin that a lamp may have. [convention]
MIN_CCT, MAX_CCT = 1000.0, 20000.0
#: Shares of the rectangle around a lamp that it fills, above which it counts as a rectangle, and between which as
#: round; an ellipse fills pi / 4. [convention]
RECTANGLE_FILL, ROUND_FILL = 0.9, (0.7, 0.87)


@dataclass(frozen=True)
class Lamp:
    """A lamp, as far as it is known. None: unknown."""

    size: tuple[float, ...] | None = None
    """Longer and shorter side of the luminous opening in metres, and its height if that is known."""
    shape: str | None = None
    """ "rectangle", "round", "tube" or "globe"."""
    flux: float | None = None
    """Luminous flux in lumens."""
    cct: float | None = None
    """Correlated colour temperature of the light in kelvin."""
    distribution: Distribution | None = None
    """Luminous intensity distribution."""

    @classmethod
    def of(
        cls, lamp: Fixture | Pendant | TextureLamp, context: Context | None = None, metres: float | None = None
    ) -> Lamp:
        """What a photo tells about one of its lamps: of Transfer.fixtures, of find_pendants, or of
        Emission.luminaires. The colour of the last two needs a context, and the size of the last the metres of a
        texel. Emission textures are Lambertian by assumption, so the distribution stays unknown, as does a value that
        the photo does not determine: the size of a pendant that has the doubt SIZE, and the colour of a lamp that the
        photo clips."""
        if isinstance(lamp, Fixture):
            shape = _shape(lamp.area, lamp.size)
            return cls(_checked_size(lamp.size), shape, lamp.flux or None, lamp.cct or None)
        if isinstance(lamp, TextureLamp):
            size = None if metres is None else _checked_size([side * metres for side in lamp.size])
            return cls(size, _shape(lamp.area, lamp.size), cct=_cct(context, lamp.colour))
        size = None
        if not lamp.doubts & Doubt.SIZE:
            size = _checked_size((lamp.diameter[0], lamp.diameter[0], lamp.height[0]))
        shape = "globe" if lamp.kind in (Body.GLOBE, Body.SPHEROID) else "round"
        colour = [sum(band[channel] for band in lamp.radiance) for channel in range(3)]
        return cls(size, shape, cct=None if lamp.doubts & Doubt.CLIPPED else _cct(context, colour))

    @classmethod
    def of_distribution(cls, distribution: Distribution) -> Lamp:
        """The lamp of a luminaire file, or of a distribution that was measured."""
        report = distribution.report
        sides = sides_of(report.size)
        shape = shape_of(report.size)
        size = None if shape is None else sides if sides[2] > 0 else sides[:2]
        return cls(size, shape, report.flux or None, report.temperature or None, distribution)

    def replaced(self, **values: Any) -> Lamp:
        """The lamp with other values, which are checked."""
        if "size" in values:
            values["size"] = _checked_size(values["size"])
        shape = values.get("shape")
        if shape is not None and shape not in SHAPES:
            raise ValueError(f"shape is {shape!r}; it must be one of {', '.join(SHAPES)}")
        flux = values.get("flux")
        if flux is not None and not (math.isfinite(flux) and flux > 0):
            raise ValueError(f"flux is {flux:g} lm; it must be finite and above 0")
        cct = values.get("cct")
        if cct is not None and not MIN_CCT <= cct <= MAX_CCT:
            raise ValueError(f"cct is {cct:g} K; it must be in [{MIN_CCT:g}, {MAX_CCT:g}]")
        return replace(self, **values)

    @property
    def known(self) -> list[str]:
        """The names of the values that are known."""
        return [field.name for field in fields(self) if getattr(self, field.name) is not None]

    def __str__(self) -> str:
        words = [
            "" if self.size is None else " x ".join(f"{side:.3g}" for side in self.size) + " m",
            self.shape or "",
            "" if self.flux is None else f"{self.flux:.0f} lm",
            "" if self.cct is None else f"{self.cct:.0f} K",
            "" if self.distribution is None else "its distribution",
        ]
        return "a lamp of " + ", ".join(word for word in words if word)


def _checked_size(size: float | Sequence[float]) -> tuple[float, ...]:
    """Sides in metres, the longer one first; a single length is a diameter."""
    sides = [float(size)] * 2 if isinstance(size, (int, float)) else [float(side) for side in size]
    if len(sides) not in (2, 3) or not all(math.isfinite(side) and side > 0 for side in sides):
        raise ValueError(f"size is {size!r}; it must be a diameter, two sides, or two sides and a height, above 0 m")
    return (*sorted(sides[:2], reverse=True), *sides[2:])


def _shape(area: float, sides: Sequence[float]) -> str | None:
    """The shape of a lamp that fills this area of the rectangle around it; None if it is neither."""
    fill = area / max(sides[0] * sides[1], 1e-30)
    if fill >= RECTANGLE_FILL:
        return "rectangle"
    return "round" if ROUND_FILL[0] <= fill <= ROUND_FILL[1] else None


def _cct(context: Context | None, colour: Sequence[float]) -> float | None:
    """The colour temperature of a linear colour; None without a context, or for a lamp that is off."""
    if context is None or not max(colour) > 0:
        return None
    kelvin, _ = colour_temperature(context, colour)
    return kelvin
