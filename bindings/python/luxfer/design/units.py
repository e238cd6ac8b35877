"""Lengths in the unit of a drawing. Everything inside the package is in metres."""

from __future__ import annotations

from collections.abc import Iterable

#: Metres in each unit. [convention]
METRES = {"m": 1.0, "mm": 0.001, "inch": 0.0254}


def factor(unit: str) -> float:
    """Metres in a unit.

    >>> factor("inch")
    0.0254
    >>> factor("foot")
    Traceback (most recent call last):
    ValueError: 'foot' is no unit of length: there are m, mm, inch
    """
    if unit not in METRES:
        raise ValueError(f"'{unit}' is no unit of length: there are {', '.join(METRES)}")
    return METRES[unit]


def metres(values: Iterable[float], unit: str) -> tuple[float, ...]:
    """Lengths in that unit, converted to metres.

    >>> metres((800, 1600), "mm")
    (0.8, 1.6)
    """
    scale = factor(unit)
    return tuple(float(v) * scale for v in values)


def shown(length: float, unit: str) -> str:
    """A length in metres, written in a unit to the millimetre.

    >>> shown(1.2345, "m"), shown(1.2345, "mm"), shown(0.0254, "inch")
    ('1.234', '1234', '1.00')
    """
    return f"{length / factor(unit):.{ {'m': 3, 'mm': 0, 'inch': 2}[unit] }f}"


def lux(value: float) -> str:
    """An illuminance as drawings and tables print it: with decimals where it is small, as emergency light is.

    >>> lux(512.3), lux(15.26), lux(0.517)
    ('512', '15.3', '0.52')
    """
    return f"{value:.{2 if abs(value) < 2 else 1 if abs(value) < 20 else 0}f}"
