"""Observers for glare: people at a task area, and people who look along the room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .units import metres

if TYPE_CHECKING:
    from .areas import Area
    from .rooms import Room

#: Heights of the eyes above the floor of seated and standing people, in metres. [convention: CIE 117, EN 12464-1]
SEATED_EYE, STANDING_EYE = 1.2, 1.7
#: Distance of an observer from the edge of the task area, and from the wall behind, in metres. [convention]
SEAT, BEHIND = 0.2, 0.3
#: Share of the height above an eye up to the ceiling that must be free. [convention]
HEADROOM = 0.7


@dataclass(frozen=True)
class Observers:
    """Eyes with level lines of sight."""

    name: str
    """Name by which requirements refer to them."""
    positions: NDArray[np.float64]
    """Positions of the eyes in metres (n, 3)."""
    directions: NDArray[np.float64]
    """Lines of sight (n, 3)."""


def at_task(room: Room, area: Area, name: str | None = None, eye: float = SEATED_EYE) -> Observers:
    """People who sit at each side of a task area where there is room, and look across it."""
    ((a0, b0, a1, b1),) = area.outline
    a, b = (a0 + a1) / 2, (b0 + b1) / 2
    seats = [(a, b0 - SEAT), (a, b1 + SEAT), (a0 - SEAT, b), (a1 + SEAT, b)]
    views = [room.across, -room.across, room.along, -room.along]
    return _seen(room, name or f"people at {area.name}", seats, views, eye)


def along_room(room: Room, name: str = "people in the room", eye: float = SEATED_EYE) -> Observers:
    """People at the middle of each wall who look across the room."""
    a, b = room.length / 2, room.width / 2
    seats = [(BEHIND, b), (room.length - BEHIND, b), (a, BEHIND), (a, room.width - BEHIND)]
    return _seen(room, name, seats, [room.along, -room.along, room.across, -room.across], eye)


def at(
    room: Room,
    name: str,
    plan: Sequence[Sequence[float]],
    towards: Sequence[Sequence[float]],
    eye: float = SEATED_EYE,
    unit: str = "m",
) -> Observers:
    """People at points of the plan who look towards other points of it."""
    here = np.array([metres(p, unit) for p in plan])
    there = np.array([metres(p, unit) for p in towards])
    views = [d[0] * room.along + d[1] * room.across for d in there - here]
    return _seen(room, name, here, views, metres([eye], unit)[0])


def _seen(room: Room, name: str, seats: Sequence, views: Sequence, eye: float) -> Observers:
    """The observers whose eyes are free and in the room."""
    positions = room.world(seats, eye)
    plan = np.asarray(seats, float)
    inside = (plan > 0).all(axis=1) & (plan < (room.length, room.width)).all(axis=1)
    # Not under a table, nor in a cupboard.
    free = inside & room.free(positions, HEADROOM * (room.height - eye))
    if not free.any():
        raise ValueError(f"no observer of {name!r} has a free place in the room: give their places by observers.at()")
    return Observers(name, positions[free], np.asarray(views, float)[free])
