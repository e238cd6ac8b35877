"""The surfaces of the room that receive lamps, and how the pattern lies on each.

The project's own entries describe the surface on which the user works; its list "others" has the same entries of the
other surfaces. The lamps of all surfaces come from one photo, and the library solves for their light together.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import luxfer

from .project import Project
from .room import pattern_of, texture_settings


class Layout(NamedTuple):
    """The lamps of one surface."""

    surface: str
    pattern: dict[str, Any]
    zones: list[list[float]]
    #: The factor of each kind of lamp that is dimmed.
    mix: dict[str, float]
    #: Added lamps: kind, u and v in metres.
    added: list[list[float]]

    @property
    def is_plain(self) -> bool:
        """Whether all lamps are as the transfer has made them."""
        return not self.added and all(value == 1 for value in self.mix.values())

    def factor(self, kind: int) -> float:
        """The factor of a kind of lamp; 1 if it is not dimmed."""
        return self.mix.get(str(kind), 1.0)


class Placed(NamedTuple):
    """The lamps of one surface after a transfer."""

    transfer: luxfer.Transfer
    surface: luxfer.types.Surface
    layout: Layout


def layouts(project: Project, surface: str) -> list[Layout]:
    """Returns the layouts of all surfaces, in the order of their names, so that the order does not depend on the
    surface on which the user works; `surface` is the one of a project that names none."""
    first = Layout(project["surface"] or surface, *(project[name] for name in Layout._fields[1:]))
    others = [Layout(*(other[name] for name in Layout._fields)) for other in project["others"]]
    return sorted([first, *others], key=lambda layout: layout.surface)


def active(project: Project, all_layouts: list[Layout], surface: str) -> int:
    """Returns the index of the layout on which the user works."""
    return [layout.surface for layout in all_layouts].index(project["surface"] or surface)


def settings_of(project: Project, layout: Layout, distance: tuple[float, float] | None) -> dict[str, Any]:
    """Returns the settings of a transfer for the texture of a surface."""
    return {**texture_settings(project, distance), "pattern": pattern_of(layout.pattern)}


def place_all(room: luxfer.Scene, transfers: list[luxfer.Transfer], all_layouts: list[Layout]) -> list[Placed]:
    """Joins transfers with the layouts of their surfaces."""
    return [
        Placed(transfer, room.find_surface(layout.surface), layout) for transfer, layout in zip(transfers, all_layouts)
    ]
