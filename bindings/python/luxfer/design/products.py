"""Which product is this? Finds the luminaire files of a folder that are nearest to a lamp of a photo.

The distance has up to five parts, each of which is 0 for the same lamp:

- `size`: root mean square of the natural logarithms of the ratios of the sides of the luminous opening, the longer
  horizontal side first, and the height if it is known; 0.1 is a difference of a tenth.
- `shape`: 0 for the same shape, 0.5 for shapes of the same outline from below, 1 for others.
- `flux`: natural logarithm of the ratio of the fluxes in lumens.
- `cct`: difference of the colour temperatures in reciprocal megakelvin, times COLOUR_WEIGHT.
- `distribution`: share of the flux that one lamp sends into other directions than the other lamp, in [0, 1].

The distance is the root mean square of the parts. Parts that the lamp or the file does not state are left out.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import Error
from ..photometry import LUMINAIRES, Distribution
from .lamps import Lamp
from .openings import shape_of, sides_of

if TYPE_CHECKING:
    from ..context import Context

#: Part of a difference of one reciprocal megakelvin. [convention: 25 of them, such as between 3000 K and 3243 K, count
#: as much as a tenth of the flux]
COLOUR_WEIGHT = 0.004
#: Steps in degrees of the directions in which distributions are compared. [convention]
TURN_STEP, GAMMA_STEP = 15, 5
#: Sides whose ratio is below count as equal, so that a lamp may be turned by 90 degrees. [convention]
EQUAL_SIDES = 1.1
#: Distance of two shapes that have the same outline from below. [convention]
SAME_OUTLINE = 0.5
#: The shapes whose outline from below is round.
ROUND = ("round", "globe")


@dataclass(frozen=True)
class Part:
    """A part of the distance between a lamp and a product."""

    name: str
    """ "size", "shape", "flux", "cct" or "distribution"."""
    distance: float
    """The part; 0 for the same lamp."""
    text: str
    """The values of the product and of the lamp in words."""

    def __str__(self) -> str:
        return f"{self.text} ({self.distance:.3f})"


@dataclass(frozen=True)
class Match:
    """A luminaire file, and its distance from the lamp."""

    path: Path
    """The file."""
    variant: int | None
    """Number of the variant, from 0, in a GLDF file that has several; else None."""
    name: str
    """Name of the luminaire."""
    distance: float
    """Root mean square of the parts."""
    parts: tuple[Part, ...]
    """The parts that were compared."""
    left_out: tuple[str, ...]
    """What the lamp states but the file does not, so that it was not compared."""

    def __str__(self) -> str:
        place = self.path.name if self.variant is None else f"{self.path.name}#{self.variant}"
        absent = f"; not stated by the file: {', '.join(self.left_out)}" if self.left_out else ""
        return f"{self.distance:.3f}  {place} ({self.name or 'no name'}): {', '.join(map(str, self.parts))}{absent}"


@dataclass(frozen=True)
class Found:
    """The products nearest to a lamp."""

    matches: tuple[Match, ...]
    """The nearest first."""
    lamp: Lamp
    """The lamp that was looked for."""
    compared: int
    """Number of luminaires that were compared; variants of a GLDF file count each."""
    unknown: tuple[str, ...]
    """Parts that were not compared because the lamp does not state them."""
    unreadable: tuple[tuple[Path, str], ...]
    """Files, or variants of files, that could not be read, with the reason."""
    incomparable: tuple[Path, ...]
    """Files that state nothing of what the lamp states."""

    def lines(self) -> list[str]:
        """The matches in lines of text, after a line that says what was compared."""
        lines = [f"{self.compared} luminaires compared with {self.lamp}"]
        if self.unknown:
            lines.append(f"left out, because unknown of the lamp: {', '.join(self.unknown)}")
        return [*lines, *map(str, self.matches)]

    def incomparable_lines(self) -> list[str]:
        """The files that state nothing to compare, in lines of text."""
        return [f"states nothing to compare: {path}" for path in self.incomparable]

    def explanation(self) -> str:
        """The result in lines of text."""
        unreadable = [f"cannot be read: {path}: {reason}" for path, reason in self.unreadable]
        return "\n".join([*self.lines(), *unreadable, *self.incomparable_lines()])


def find_products(
    context: Context,
    folder: str | os.PathLike[str],
    lamp: Lamp | None = None,
    *,
    size: float | Sequence[float] | None = None,
    shape: str | None = None,
    flux: float | None = None,
    cct: float | None = None,
    distribution: Distribution | None = None,
    count: int = 5,
) -> Found:
    """Finds the luminaire files (IES, EULUMDAT, TM-33 and GLDF) in a folder and its subfolders that are nearest to a
    lamp.

    The lamp is given by its size in metres (a diameter, two sides of the luminous opening, or two sides and a height),
    its shape ("rectangle", "round", "tube" or "globe"), its flux in lumens, the colour temperature of its light in
    kelvin, and its luminous intensity distribution, as far as they are known; or as a Lamp, such as Lamp.of(fixture)
    of a lamp in a photo, whose values the other arguments replace. Files that cannot be read are listed.

    ValueError if a value is out of range, if nothing is given, or if the folder has no luminaire file.
    """
    given = {"size": size, "shape": shape, "flux": flux, "cct": cct, "distribution": distribution}
    wanted = (lamp or Lamp()).replaced(**{name: value for name, value in given.items() if value is not None})
    if not wanted.known:
        raise ValueError("there is nothing to compare: give size, shape, flux, cct or distribution of the lamp")
    if count < 1:
        raise ValueError(f"count is {count}; it must be at least 1")
    own = _sampled(wanted.distribution) if wanted.distribution is not None else None
    matches, incomparable, unreadable = [], [], list[tuple[Path, str]]()
    for path in _files(Path(folder)):
        for variant, product in _variants(context, path, unreadable):
            with product:
                match = _compared(wanted, own, path, variant, product)
            if match.parts:
                matches.append(match)
            else:
                incomparable.append(path)
    matches.sort(key=lambda match: (match.distance, -len(match.parts), match.path, match.variant or 0))
    unknown = tuple(field.name for field in fields(Lamp) if field.name not in wanted.known)
    return Found(
        tuple(matches[:count]), wanted, len(matches), unknown, tuple(unreadable), tuple(dict.fromkeys(incomparable))
    )


def _files(folder: Path) -> list[Path]:
    """The luminaire files of a folder, in the order of their names."""
    if not folder.is_dir():
        raise ValueError(f"folder is {os.fspath(folder)!r}; it must be an existing folder")
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in LUMINAIRES and path.is_file())
    if not found:
        raise ValueError(f"folder {os.fspath(folder)!r} has no luminaire file; names end in {', '.join(LUMINAIRES)}")
    return found


def _variants(
    context: Context, path: Path, unreadable: list[tuple[Path, str]]
) -> Iterator[tuple[int | None, Distribution]]:
    """Loads a file, or all variants of a GLDF file; reasons why one cannot be read go into unreadable."""
    count, index = 1, 0
    while index < count:
        try:
            product = Distribution.load(context, path, index if index else None)
        except Error as error:
            unreadable.append((path, str(error).removeprefix(f"{path}: ")))
        else:
            count = product.report.variants if index == 0 else count
            yield (index if count > 1 else None), product
        index += 1


def _compared(
    lamp: Lamp, own: NDArray[np.float64] | None, path: Path, variant: int | None, product: Distribution
) -> Match:
    """Compares a product with the lamp, part by part."""
    report = product.report
    parts, left_out = [], []
    sides = sides_of(report.size)
    if lamp.size is not None:
        parts += _size_part(lamp.size, sides) if sides[0] > 0 else []
    kind = shape_of(report.size)
    if lamp.shape is not None and kind is not None:
        parts.append(Part("shape", _shape_distance(kind, lamp.shape), _instead(kind, lamp.shape)))
    if lamp.flux is not None and report.flux > 0:
        text = _instead(f"{report.flux:.4g} lm", f"{lamp.flux:.4g} lm")
        parts.append(Part("flux", abs(math.log(report.flux / lamp.flux)), text))
    if lamp.cct is not None and report.temperature > 0:
        difference = COLOUR_WEIGHT * abs(1e6 / report.temperature - 1e6 / lamp.cct)
        text = _instead(f"{report.temperature:.0f} K", f"{lamp.cct:.0f} K")
        parts.append(Part("cct", difference, text))
    if own is not None and lamp.distribution is not None and report.flux > 0:
        share = _elsewhere(own, lamp.distribution.report.size, _sampled(product), report.size)
        parts.append(Part("distribution", share, f"{100 * share:.0f} % of the flux in other directions"))
    compared = {part.name for part in parts}
    left_out = [name for name in lamp.known if name not in compared]
    total = math.sqrt(sum(part.distance**2 for part in parts) / len(parts)) if parts else math.inf
    return Match(path, variant, product.name, total, tuple(parts), tuple(left_out))


def _shape_distance(one: str, other: str) -> float:
    if one == other:
        return 0.0
    return SAME_OUTLINE if (one in ROUND) == (other in ROUND) else 1.0


def _size_part(wanted: Sequence[float], sides: Sequence[float]) -> list[Part]:
    """Compares sides; a height is compared only if both are above 0. Empty if nothing can be compared."""
    pairs = [(a, b) for a, b in zip(wanted, sides) if a > 0 and b > 0]
    if not pairs:
        return []
    distance = math.sqrt(sum(math.log(b / a) ** 2 for a, b in pairs) / len(pairs))
    found, asked = (" x ".join(f"{pair[which]:.3g}" for pair in pairs) + " m" for which in (1, 0))
    return [Part("size", distance, _instead(found, asked))]


def _instead(found: str, asked: str) -> str:
    return found if found == asked else f"{found} instead of {asked}"


def _sampled(product: Distribution) -> NDArray[np.float64]:
    """The shares of the flux by directions (C, gamma)."""
    gammas = np.arange(GAMMA_STEP / 2, 180, GAMMA_STEP)
    turns = range(0, 360, TURN_STEP)
    planes = turns if product.report.planes > 1 else (0,)
    intensity = product.intensity
    candela = np.array([[intensity(c, gamma) for gamma in gammas.tolist()] for c in planes])
    flux = np.broadcast_to(candela * np.sin(np.radians(gammas)), (len(turns), len(gammas)))
    return np.asarray(flux / max(flux.sum(), np.finfo(float).tiny))


def _elsewhere(
    own: NDArray[np.float64], size: Sequence[float], other: NDArray[np.float64], other_size: Sequence[float]
) -> float:
    """The share of the flux in other directions, for the best turn of the product about its axis that lays the longer
    sides side by side."""
    quarter = 90 // TURN_STEP
    turns: Sequence[int] = range(4)
    if _is_long(size) and _is_long(other_size):
        crossed = (abs(size[0]) > abs(size[1])) != (abs(other_size[0]) > abs(other_size[1]))
        turns = (1, 3) if crossed else (0, 2)
    return min(float(np.abs(own - np.roll(other, turn * quarter, axis=0)).sum()) / 2 for turn in turns)


def _is_long(size: Sequence[float]) -> bool:
    longer, shorter, _ = sides_of(size)
    return longer > EQUAL_SIDES * shorter > 0
