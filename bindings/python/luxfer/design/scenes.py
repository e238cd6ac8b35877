"""Light scenes: named states of the dimmers, each with requirements and hours of use of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Union

from .luminaires import Luminaire, dimmed

if TYPE_CHECKING:
    from .energy import Hours
    from .standard import Requirement

Dimmers = Union[Mapping[str, float], Sequence[float], None]


@dataclass(frozen=True)
class LightScene:
    """A state of the dimmers.

    >>> LightScene("slides", {"board": 0.0, "seats": 0.2}).name
    'slides'
    """

    name: str
    """Name as the report prints it."""
    dimmers: Dimmers = None
    """Shares of the full flux: one for each luminaire, or by the name of its group, where "*" stands for all groups
    that are not named; without "*" the unnamed groups are off. None: the dimmers of the design."""
    requirements: tuple[Requirement, ...] = ()
    """Requirements of this state."""
    hours: Hours | None = None
    """Its use in a year, for the energy of the design."""
    direct: bool = False
    """Whether only the light straight from the luminaires counts, as for emergency light."""
    maintenance: float | None = None
    """Its maintenance factor, if it differs from the factor of the design, as for light from batteries."""

    def __post_init__(self) -> None:
        if not self.name:
            raise ValueError("a light scene needs a name")

    def lamps(self, luminaires: Sequence[Luminaire]) -> list[Luminaire]:
        """The luminaires in this state."""
        if self.dimmers is None:
            return list(luminaires)
        if not isinstance(self.dimmers, Mapping):
            shares = list(self.dimmers)
        else:
            groups = {lamp.group for lamp in luminaires if lamp.group}
            unknown = [g for g in self.dimmers if g != "*" and g not in groups]
            if unknown:
                raise ValueError(
                    f"the light scene {self.name!r} names the group {unknown[0]!r}: there are "
                    f"{', '.join(sorted(groups)) or 'none'}"
                )
            rest = self.dimmers.get("*", 0.0)
            shares = [self.dimmers.get(lamp.group, rest) if lamp.group else rest for lamp in luminaires]
        wrong = [s for s in shares if not 0 <= s <= 1]
        if wrong:
            raise ValueError(f"the light scene {self.name!r} has the dimmer {wrong[0]:g}, which is not in [0, 1]")
        return dimmed(luminaires, shares)


def find(scenes: Sequence[LightScene], name: str) -> LightScene:
    """The light scene of a name."""
    found = [s for s in scenes if s.name == name]
    if len(found) != 1:
        count = "several light scenes are" if found else "no light scene is"
        raise ValueError(f"{count} called {name!r}: there are {', '.join(s.name for s in scenes) or 'none'}")
    return found[0]
