"""Parses the values of options and checks their ranges. Each error names the value and the allowed range."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable
from dataclasses import dataclass

#: Length of each unit of --units in metres.
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "inch": 0.0254, "ft": 0.3048}

#: Weights of the channels in the luminance of linear Rec.709 colours.
LUMINANCE = (0.2126, 0.7152, 0.0722)


def wrong(text: str, allowed: str) -> argparse.ArgumentTypeError:
    """Creates the error for a wrong value."""
    return argparse.ArgumentTypeError(f"'{text}' is not {allowed}")


def real(text: str) -> float | None:
    """Parses a finite number; None if the text is something else."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def number(low: float, high: float, what: str) -> Callable[[str], float]:
    """Returns a parser of numbers in [low, high]."""

    def parse(text: str) -> float:
        value = real(text)
        if value is None or not low <= value <= high:
            raise wrong(text, f"{what} in [{low:g}, {high:g}]")
        return value

    return parse


def whole(low: int, high: int, what: str) -> Callable[[str], int]:
    """Returns a parser of whole numbers in [low, high]."""

    def parse(text: str) -> int:
        if not re.fullmatch(r"[+-]?\d{1,18}", text) or not low <= int(text) <= high:
            raise wrong(text, f"{what}, a whole number in [{low}, {high}]")
        return int(text)

    return parse


def size(text: str) -> tuple[int, int]:
    """Parses WIDTHxHEIGHT."""
    match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", text)
    if not match or not all(1 <= int(side) <= 65536 for side in match.groups()):
        raise wrong(text, "WIDTHxHEIGHT such as 640x360, each side in [1, 65536]")
    return int(match[1]), int(match[2])


def seconds(text: str) -> float:
    """Parses a time: 30s, 1.5min, 1h, 1:30."""
    allowed = "a time such as 30s, 2min, 1h or 1:30, from 0.1 s to 24 h"
    if match := re.fullmatch(r"(\d{1,4}):(\d\d)", text):
        value = 60.0 * int(match[1]) + int(match[2])
    elif match := re.fullmatch(r"([\d.]+)\s*(ms|s|sec|m|min|h)?", text):
        scale = {"ms": 0.001, None: 1, "s": 1, "sec": 1, "m": 60, "min": 60, "h": 3600}[match[2]]
        value = (real(match[1]) or 0.0) * scale
    else:
        raise wrong(text, allowed)
    if not 0.1 <= value <= 86400:
        raise wrong(text, allowed)
    return value


def share(text: str) -> float:
    """Parses an error relative to the mean: 2% or 0.02."""
    value = real(text.removesuffix("%"))
    value = value / 100 if value is not None and text.endswith("%") else value
    if value is None or not 1e-5 <= value <= 1:
        raise wrong(text, "an error such as 2% or 0.02, from 0.001% to 100%")
    return value


def length(text: str) -> float:
    """Parses a length and returns metres: 0.75, 75cm, 30inch."""
    match = re.fullmatch(r"([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(mm|cm|m|inch|ft)?", text)
    value = real(match[1]) if match else None
    if match is None or value is None or not abs(value) <= 1e6:
        raise wrong(text, "a length such as 0.75, 75cm or 30inch")
    return value * UNITS[match[2] or "m"]


def above_zero(text: str) -> float:
    """Parses a length above 0."""
    value = length(text)
    if value <= 0:
        raise wrong(text, "a length above 0, such as 0.25 or 25cm")
    return value


def one_over(text: str) -> float:
    """Parses 1/n, with a whole n in [1, 20]."""
    value = real(text)
    if value is None or not 0.05 <= value <= 1 or abs(1 / value - round(1 / value)) > 1e-9:
        raise wrong(text, "1/n with a whole n in [1, 20], such as 0.25 or 1")
    return value


def sides(text: str) -> tuple[float, ...]:
    """Parses a diameter, two sides, or two sides and a height, such as 60x60cm or 1.2x0.3x0.08."""
    unit = re.search(r"(mm|cm|m|inch|ft)?$", text)
    ending = unit[1] if unit and unit[1] else "m"
    parts = [real(part) for part in text.removesuffix(ending).split("x")]
    found = [part * UNITS[ending] for part in parts if part is not None and 0 < part <= 1e6]
    if len(found) != len(parts) or len(found) > 3:
        raise wrong(text, "a diameter, two sides, or two sides and a height, such as 0.3, 60x60cm or 1.2x0.3x0.08")
    return (found[0], found[0]) if len(found) == 1 else tuple(found)


def numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Parses numbers separated by commas; None if they are not `count` numbers."""
    parts = [real(part) for part in text.split(",")]
    return tuple(p for p in parts if p is not None) if len(parts) == count and None not in parts else None


def colour(text: str) -> float | tuple[float, ...]:
    """Parses a colour of light: a colour temperature in kelvin (a float), or linear red, green, blue."""
    allowed = "a colour of light: kelvin from 1000K to 20000K, #RRGGBB (sRGB), or linear R,G,B such as 1,0.9,0.7"
    if match := re.fullmatch(r"([\d.]+)\s*[kK]", text):
        kelvin = real(match[1])
        if kelvin is None or not 1000 <= kelvin <= 20000:
            raise wrong(text, allowed)
        return kelvin
    if match := re.fullmatch(r"#([0-9a-fA-F]{6})", text):
        codes = (int(match[1][i : i + 2], 16) / 255 for i in (0, 2, 4))
        found: tuple[float, ...] | None = tuple(
            c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in codes
        )
    else:
        found = numbers(text, 3)
    if found is None or min(found) < 0 or max(found) <= 0:
        raise wrong(text, allowed)
    return found


@dataclass(frozen=True)
class Camera:
    """The camera that --camera states: one of the scene by its number, or one by its position."""

    index: int | None = None
    position: tuple[float, ...] = ()
    target: tuple[float, ...] = ()
    fov_y: float | None = None


def camera(text: str) -> Camera:
    """Parses a number, or X,Y,Z/X,Y,Z with an optional /DEGREES."""
    allowed = "a number of a camera of the scene, or POSITION/TARGET[/DEGREES] such as 1,1.6,2/4,1,0/60"
    if re.fullmatch(r"\d{1,9}", text):
        return Camera(index=int(text))
    parts = text.split("/")
    points = [numbers(part, 3) for part in parts[:2]]
    degrees = real(parts[2]) if len(parts) == 3 else 60.0
    if (
        len(parts) not in (2, 3)
        or None in points
        or points[0] == points[1]
        or degrees is None
        or not 1 <= degrees <= 170
    ):
        raise wrong(text, allowed)
    return Camera(position=points[0] or (), target=points[1] or (), fov_y=math.radians(degrees))


def rectangle(text: str) -> tuple[float, ...]:
    """Parses X0,Z0,X1,Z1 in metres."""
    found = numbers(text, 4)
    if found is None or found[0] >= found[2] or found[1] >= found[3]:
        raise wrong(text, "X0,Z0,X1,Z1 in metres with X0 < X1 and Z0 < Z1")
    return found
