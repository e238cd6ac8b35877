"""The UGR table of a luminaire: glare in 19 standard rooms by the tabular method (CIE 117:1995, CIE 190:2010).

The luminaires of a room form an even array at the height H above the eyes. The observer sits in the middle of a wall
and looks level along the room. The direct part is the formula of the UGR with the luminance of each luminaire, its
intensity divided by the projected area of its opening. The background luminance is the mean indirect illuminance of
the walls between the heights of eyes and luminaires, divided by pi. It follows from three surfaces that exchange
light: ceiling, walls, and the plane at the height of the eyes. H cancels out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .openings import projected_area

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..photometry import Distribution

#: The standard rooms: width across the line of sight and depth along it, in units of H. [convention: CIE 190]
ROOMS: tuple[tuple[int, int], ...] = (
    *((2, depth) for depth in (2, 3, 4, 6, 8, 12)),
    *((4, depth) for depth in (2, 3, 4, 6, 8, 12)),
    *((8, depth) for depth in (4, 6, 8, 12)),
    *((12, depth) for depth in (4, 6, 8)),
)
#: Reflectances of ceiling, walls and the plane at the height of the eyes. [convention: CIE 190]
REFLECTANCES: tuple[tuple[float, float, float], ...] = (
    (0.7, 0.5, 0.2),
    (0.7, 0.3, 0.2),
    (0.5, 0.5, 0.2),
    (0.5, 0.3, 0.2),
    (0.3, 0.3, 0.2),
)
#: The views: the line of sight crosses the length of the luminaires, or runs along it.
VIEWS = ("crosswise", "endwise")
#: Lamp flux in lumens to which an uncorrected table refers. [convention: CIE 117]
TABLE_FLUX = 1000.0
#: Luminaires beyond are not in view: offset to the side and height, both over the distance ahead, and the angle from
#: straight down in degrees. [convention: CIE 117]
MAX_SIDE, MAX_RISE, MAX_GAMMA = 3.0, 1.9, 85.0
#: Smallest allowed spacing of the luminaires over H. [convention]
MIN_SPACING = 0.05
#: Steps in degrees of the integrals over gamma and over the directions around the axis. [convention]
GAMMA_STEP, TURN_STEP = 1.0, 5.0


@dataclass(frozen=True)
class UgrTable:
    """The UGR of a luminaire in 19 rooms, with five sets of reflectances, seen crosswise and endwise."""

    name: str
    """Name of the luminaire."""
    uncorrected: NDArray[np.float64]
    """UGR for a lamp flux of 1000 lm (19 rooms of ROOMS, 5 of REFLECTANCES, 2 of VIEWS); -infinity where no luminaire
    in view shines towards the eyes."""
    lamp_flux: float
    """Flux in lumens of the lamps of one luminaire, or of the luminaire if its photometry is absolute."""
    spacing: float
    """Spacing of the luminaires over H."""
    length_along: int
    """C plane in degrees, 0 or 90, along the luminaire's length; crosswise, the line of sight crosses this plane."""

    @property
    def corrected(self) -> NDArray[np.float64]:
        """UGR for the lamp flux of the luminaire: uncorrected + 8 log10(lamp_flux / 1000 lm)."""
        return self.uncorrected + 8 * math.log10(self.lamp_flux / TABLE_FLUX)

    def value(
        self, room: tuple[float, float], reflectances: Sequence[float] = REFLECTANCES[0], view: str = "crosswise"
    ) -> float:
        """The corrected UGR of one cell: the room's width and depth over H, the reflectances of ceiling, walls and
        plane, and the view."""
        place = []
        for name, value, known in (
            ("room", tuple(room), ROOMS),
            ("reflectances", tuple(reflectances), REFLECTANCES),
            ("view", view, VIEWS),
        ):
            found = [index for index, one in enumerate(known) if one == value]
            if not found:
                raise ValueError(f"{name} is {value!r}; it must be one of {', '.join(map(str, known))}")
            place += found
        return float(self.corrected[tuple(place)])

    def lines(self, corrected: bool = True) -> list[str]:
        """The table as lines of text."""
        values = self.corrected if corrected else self.uncorrected
        flux = self.lamp_flux if corrected else TABLE_FLUX
        heads = "".join(f"{'/'.join(f'{100 * r:.0f}' for r in row):>9}" for row in REFLECTANCES)
        lines = [
            f"UGR {'corrected to' if corrected else 'uncorrected, for'} a lamp flux of {flux:.0f} lm; luminaires at "
            f"{self.spacing:g} H",
            f"{'':8}" + "".join(f"  {view:>{len(heads)}}" for view in VIEWS),
            f"{'X  Y':8}" + "".join(f"  {heads}" for _ in VIEWS),
        ]
        for (width, depth), row in zip(ROOMS, values):
            cells = ("".join(f"{_shown(v):>9}" for v in row[:, view]) for view in range(len(VIEWS)))
            lines.append(f"{f'{width}H':<3}{f'{depth}H':<5}" + "".join(f"  {cell}" for cell in cells))
        return lines


def ugr_table(
    distribution: Distribution,
    spacing: float = 0.25,
    size: Sequence[float] | None = None,
    floor_spacing: float = 1.0,
) -> UgrTable:
    """Computes the UGR table of a luminaire.

    spacing is the distance of the luminaires over H, a fraction 1/n in [0.05, 1]; 0.25 is usual in catalogues. size is
    the luminous opening in metres as in DistributionReport; by default that of the file. Its longer horizontal side is
    the length of the luminaire, which lies along C = 90 if the sides are equal; the planes C = 0 and C = 90 are those
    that face the observer crosswise and endwise, or the other way round if the length lies along C = 0.

    floor_spacing, a fraction 1/n too, is the spacing by which the direct flux on walls and floor is computed. The
    multipliers of CIE 190 are those of 1, the default, which they use at every spacing. The same value as spacing
    gives the flux of the real array: the UGR of narrow beams in small rooms is then lower by up to 0.3.

    A luminaire without luminous opening, without flux, or without flux downwards has no table: ValueError.
    """
    for name, value in (("spacing", spacing), ("floor_spacing", floor_spacing)):
        _check_spacing(name, value)
    report = distribution.report
    who = repr(distribution.name or "(no name)")
    if not report.flux > 0:
        raise ValueError(f"the flux of {who} is {report.flux:g} lm; a UGR table needs a flux above 0")
    extent = _checked_size(size, report.size, who)
    down, up = _zones(distribution)
    if not down.sum() > 0:
        raise ValueError(
            f"the flux of {who} below the horizontal is 0 lm of {report.flux:.0f} lm; a UGR table needs a luminaire "
            f"that shines downwards"
        )
    lamp_flux = report.lamp_flux or report.flux
    along = 0 if abs(extent[0]) > abs(extent[1]) else 90
    # Fluxes per lumen of the lamps.
    scale = report.flux / (down.sum() + up.sum()) / lamp_flux
    background = np.array([_wall_luminance(room, down * scale, up.sum() * scale, floor_spacing) for room in ROOMS])
    count = np.array([width * depth / spacing**2 for width, depth in ROOMS])
    background *= count[:, None] * TABLE_FLUX
    sums = np.stack([_direct_sums(distribution, extent, c, spacing) for c in (90 - along, along)], axis=-1)
    sums *= (TABLE_FLUX / lamp_flux) ** 2
    with np.errstate(divide="ignore"):
        ugr = 8 * np.log10(0.25 * sums[:, None, :] / background[:, :, None])
    return UgrTable(distribution.name, ugr, lamp_flux, spacing, along)


def position_index(side: NDArray[np.float64], rise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Guth's position index above a level line of sight; offset to the side and height over the distance ahead. Sources
    that are not in view have an infinite index."""
    side = np.abs(side)
    tau = np.degrees(np.arctan2(side, rise))
    sigma = np.degrees(np.arctan(np.hypot(side, rise)))
    first = (35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)) * 1e-3 * sigma
    second = (21 + 0.26667 * tau - 0.002963 * tau**2) * 1e-5 * sigma**2
    in_view = (side <= MAX_SIDE) & (rise <= MAX_RISE)
    return np.asarray(np.where(in_view, np.exp(first + second), np.inf))


def flux_transfer(room: tuple[float, float], reflectances: Sequence[float]) -> NDArray[np.float64]:
    """The flux that ceiling, walls and floor receive (rows) for each unit of flux that they receive directly (columns),
    with all reflections, in a room of that width and depth over its height."""
    x, y = room
    a, b = math.sqrt(1 + x * x), math.sqrt(1 + y * y)
    # Form factor of two equal parallel rectangles at the distance 1.
    across = math.log(a * b / math.sqrt(1 + x * x + y * y)) - x * math.atan(x) - y * math.atan(y)
    across += x * b * math.atan(x / b) + y * a * math.atan(y / a)
    across *= 2 / (math.pi * x * y)
    of_wall = (1 - across) * x * y / (2 * (x + y))
    form = np.array([[0, 1 - across, across], [of_wall, 1 - 2 * of_wall, of_wall], [across, 1 - across, 0]])
    return np.linalg.inv(np.eye(3) - form.T * np.asarray(reflectances))


def floor_share(room: tuple[float, float], gamma: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """The share of the light at these angles gamma in degrees, below 90, that meets the floor directly, as a mean over
    the luminaires of the array and over the directions around the axis."""
    turns = np.radians(np.arange(0.5, 90))
    distance = np.tan(np.radians(gamma))[:, None]
    share = np.ones((len(gamma), len(turns)))
    for side, offset in zip(room, (distance * np.cos(turns), distance * np.sin(turns))):
        count = side / spacing
        # Luminaires of a row whose light at this offset stays inside the room.
        share *= np.clip(count - np.floor(offset / spacing + 0.5), 0, None) / count
    return share.mean(axis=1)


def _direct_sums(distribution: Distribution, size: Sequence[float], facing: int, spacing: float) -> NDArray[np.float64]:
    """The sums of L² w / p² of each room, for H = 1 m; the plane C = facing is turned towards the observer's wall."""
    width, depth = (max(room[axis] for room in ROOMS) for axis in (0, 1))
    side = (np.arange(round(width / spacing)) + 0.5) * spacing - width / 2
    ahead = (np.arange(round(depth / spacing)) + 0.5) * spacing
    across, along = np.meshgrid(side, ahead, indexing="ij")
    gamma = np.degrees(np.arctan(np.hypot(across, along)))
    c = (facing + np.degrees(np.arctan2(across, along))) % 360
    weight = position_index(across / along, 1 / along) ** -2.0
    weight[gamma > MAX_GAMMA] = 0
    area = projected_area(size, c, gamma)
    seen = (weight > 0) & (area > 0)
    terms = np.zeros_like(gamma)
    candela = np.array([distribution.intensity(float(a), float(b)) for a, b in zip(c[seen], gamma[seen])])
    terms[seen] = candela**2 / area[seen] / (1 + across[seen] ** 2 + along[seen] ** 2) * weight[seen]
    inside = [(np.abs(side) < x / 2, ahead < y) for x, y in ROOMS]
    return np.array([terms[np.ix_(*pair)].sum() for pair in inside])


def _zones(distribution: Distribution) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The flux in lumens of zones of GAMMA_STEP below and above the horizontal, in order of gamma."""
    turns = np.arange(0, 360, TURN_STEP) if distribution.report.planes > 1 else np.zeros(1)
    gammas = np.arange(GAMMA_STEP / 2, 180, GAMMA_STEP)
    means = np.array([np.mean([distribution.intensity(float(c), float(g)) for c in turns]) for g in gammas])
    flux = 2 * math.pi * means * np.sin(np.radians(gammas)) * math.radians(GAMMA_STEP)
    return flux[gammas < 90], flux[gammas > 90]


def _wall_luminance(
    room: tuple[float, float], down: NDArray[np.float64], up: float, spacing: float
) -> NDArray[np.float64]:
    """The background luminance in cd/m² for each of REFLECTANCES, of one luminaire in a room of the height 1 m, whose
    fluxes in lumens these are."""
    gammas = np.arange(GAMMA_STEP / 2, 90, GAMMA_STEP)
    floor = float((down * floor_share(room, gammas, spacing)).sum())
    direct = np.array([up, down.sum() - floor, floor])
    walls = 2.0 * (room[0] + room[1])
    # Of the flux of the walls, only what has been reflected counts.
    indirect = [(flux_transfer(room, reflectances) @ direct)[1] - direct[1] for reflectances in REFLECTANCES]
    return np.array(indirect) / walls / math.pi


def _check_spacing(name: str, value: float) -> None:
    """Refuses spacings that do not fit the rooms, whose sides are whole multiples of H."""
    if not (MIN_SPACING <= value <= 1 and abs(1 / value - round(1 / value)) < 1e-9):
        raise ValueError(f"{name} is {value!r}; it must be 1/n with a whole n in [1, 20], such as 0.25 or 1")


def _checked_size(size: Sequence[float] | None, stated: Sequence[float], who: str) -> tuple[float, ...]:
    """The size of the opening; refuses a size without area."""
    found = tuple(float(v) for v in (stated if size is None else size))
    if len(found) != 3 or not all(map(math.isfinite, found)):
        raise ValueError(f"size is {size!r}; it must be three finite lengths in m: along C = 0, C = 90 and the axis")
    if not max(float(projected_area(found, c, g)) for c, g in ((0, 0), (0, 90), (90, 90))) > 0:
        raise ValueError(
            f"size of {who} is {' x '.join(f'{v:g}' for v in found)} m, an opening without area; a UGR table needs its "
            f"luminance: give size=(along C = 0, along C = 90, height) in metres, a negative length for a diameter"
        )
    return found


def _shown(value: float) -> str:
    return f"{value:.1f}" if math.isfinite(value) else "-"
