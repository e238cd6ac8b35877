"""Energy of lighting by EN 15193-1: the lighting energy numeric indicator LENI of a design from its light scenes.

    LENI = (W_L + W_P) / A
    W_L = sum over light scenes of P F_C F_O (t_D F_D + t_N) / 1000
    W_P = (P_pc (t_y - t_D - t_N) + P_em t_em) / 1000

P is the power of a light scene in watts, t_D and t_N its hours with and without daylight, and F_C, F_O and F_D the
factors of constant illuminance, occupancy and daylight, which depend on sensors and the building; the standard's
annexes have values for them. P_pc is the power of the controls while the light is off, t_y the 8760 hours of a year,
and P_em the power that charges the batteries of emergency light during t_em hours.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .luminaires import Luminaire
    from .scenes import LightScene

ENERGY = "EN 15193-1:2017"
#: Hours of a year. [convention: EN 15193-1]
YEAR = 8760.0


@dataclass(frozen=True)
class Hours:
    """Use of a light scene in a year. The factors are 1 without sensors."""

    day: float
    """Hours with daylight, t_D."""
    night: float
    """Hours without daylight, t_N."""
    occupancy: float = 1
    """Occupancy factor F_O: share of the hours in which the light is on."""
    daylight: float = 1
    """Daylight factor F_D: share of the power that is used by daylight."""
    constant: float = 1
    """Constant illuminance factor F_C: below 1 if the surplus of a new installation is dimmed."""

    def __post_init__(self) -> None:
        if self.day < 0 or self.night < 0 or not self.day + self.night <= YEAR:
            raise ValueError(f"{self.day:g} hours by day and {self.night:g} by night are no part of {YEAR:g} hours")
        for name in ("occupancy", "daylight", "constant"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"the factor {name} = {getattr(self, name):g} is not in [0, 1]")

    @property
    def effective(self) -> float:
        """Hours at the power of the light scene that use as much energy.

        >>> Hours(2250, 250, occupancy=0.9, daylight=0.8).effective
        1845.0
        """
        return self.constant * self.occupancy * (self.day * self.daylight + self.night)


@dataclass(frozen=True)
class Standby:
    """Power that flows beside the light."""

    controls: float = 0
    """Power in watts of all controls while the light is off, P_pc."""
    charging: float = 0
    """Power in watts that charges the batteries of emergency light, P_em."""
    charging_hours: float = YEAR
    """Hours of charging in a year."""

    def __post_init__(self) -> None:
        if min(self.controls, self.charging) < 0 or not 0 <= self.charging_hours <= YEAR:
            raise ValueError(
                f"standby of {self.controls:g} W and {self.charging:g} W for {self.charging_hours:g} hours: powers are "
                f"at least 0, and hours at most {YEAR:g}"
            )


@dataclass(frozen=True)
class Use:
    """The energy of one light scene in a year."""

    name: str
    """Name of the light scene."""
    watts: float
    """Its power; NaN if a luminaire in use states none."""
    hours: Hours
    """Its use."""

    @property
    def energy(self) -> float:
        """Energy in kWh."""
        return self.watts * self.hours.effective / 1000


@dataclass(frozen=True)
class Energy:
    """The energy of a design in a year."""

    uses: tuple[Use, ...]
    """The light scenes that have hours of use."""
    standby: Standby
    floor_area: float

    @property
    def lighting(self) -> float:
        """Energy of the light in kWh, W_L."""
        return sum(u.energy for u in self.uses)

    @property
    def parasitic(self) -> float:
        """Energy beside the light in kWh, W_P."""
        s, used = self.standby, sum(u.hours.day + u.hours.night for u in self.uses)
        return (s.controls * (YEAR - used) + s.charging * s.charging_hours) / 1000

    @property
    def leni(self) -> float:
        """LENI in kWh per m² and year."""
        return (self.lighting + self.parasitic) / self.floor_area


def energy(
    luminaires: Sequence[Luminaire], scenes: Sequence[LightScene], floor_area: float, standby: Standby
) -> Energy | None:
    """The energy of a design; None if no light scene has hours of use."""
    uses = []
    for scene in scenes:
        if scene.hours is None:
            continue
        lit = [lamp for lamp in scene.lamps(luminaires) if lamp.flux > 0]
        watts = math.nan if any(lamp.product.watts == 0 for lamp in lit) else sum(lamp.watts for lamp in lit)
        uses.append(Use(scene.name, watts, scene.hours))
    total = sum(u.hours.day + u.hours.night for u in uses)
    if total > YEAR:
        raise ValueError(f"the light scenes are used {total:g} hours a year, which has {YEAR:g}")
    return Energy(tuple(uses), standby, floor_area) if uses else None
