"""Emergency escape lighting by EN 1838: escape routes, open areas and tasks of high risk, with their requirements.

The standard counts the light that comes straight from the luminaires, without reflections, so emergency light is
checked in a black copy of the room (`LightScene.direct`). Its dimmers are the shares of the luminaires' flux on the
emergency supply.

Not modelled: signs, the time until the light is there, and the glare limits of the intensity of single luminaires.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ..scene import Scene
from .areas import BORDER, CARPET, WALKING, Area, fine
from .standard import Requirement
from .units import metres

if TYPE_CHECKING:
    from .rooms import Room

EMERGENCY = "EN 1838:2013"

#: Widest escape route that counts as one strip, in metres. [convention: EN 1838, 4.2]
WIDEST = 2.0
#: Illuminance in lux of the centre line of an escape route, of its central band, and of open areas.
#: [convention: EN 1838, 4.2 and 4.3]
LINE, BAND, OPEN = 1.0, 0.5, 0.5
#: Largest over smallest illuminance of a centre line or an open area. [convention: EN 1838, 4.2 and 4.3]
DIVERSITY = 40.0
#: Share of the maintained illuminance that a task of high risk keeps, its least illuminance in lux, and its uniformity.
#: [convention: EN 1838, 4.4]
RISK_SHARE, RISK, RISK_UNIFORMITY = 0.1, 15.0, 0.1
#: Colour rendering index of emergency light. [convention: EN 1838, 4.2 to 4.4]
RENDERING = 40.0
#: Largest distance in metres of the points of a centre line or band, and of an open area. [convention]
STEP, OPEN_STEP = 0.25, 0.5


def escape_route(room: Room, name: str, rectangle: Sequence[float], unit: str = "m") -> tuple[Area, Area]:
    """The centre line of an escape route, along the longer side of its rectangle a0, b0, a1, b1 of the plan, and its
    central band of half its width, both on the floor."""
    a0, b0, a1, b1 = metres(rectangle, unit)
    along, wide = (a1 - a0, b1 - b0) if a1 - a0 >= b1 - b0 else (b1 - b0, a1 - a0)
    if not 0 < wide <= WIDEST:
        raise ValueError(
            f"the escape route {name!r} is {wide:g} m wide: one up to {WIDEST:g} m has a centre line; give a wider "
            "one as several routes side by side, or as an open area"
        )
    _inside(room, name, (a0, b0, a1, b1))
    if a1 - a0 >= b1 - b0:
        band, middle = (a0, b0 + wide / 4, a1, b1 - wide / 4), (b0 + b1) / 2
        line = (a0, middle - STEP / 20, a1, middle + STEP / 20)
    else:
        band, middle = (a0 + wide / 4, b0, a1 - wide / 4, b1), (a0 + a1) / 2
        line = (middle - STEP / 20, b0, middle + STEP / 20, b1)
    steps = math.ceil(along / STEP), math.ceil(wide / 2 / STEP)
    turned = a1 - a0 < b1 - b0
    return (
        fine(f"{name}, centre line", "escape line", room, line, CARPET, _order((steps[0], 1), turned)),
        fine(f"{name}, central band", "escape band", room, band, CARPET, _order(steps, turned)),
    )


def open_area(room: Room, name: str = "open area", border: float = BORDER) -> Area:
    """The part of the floor where people can walk, without a strip along the walls."""
    a, b = (border if side > 3 * border else 0.0 for side in (room.length, room.width))
    rectangle = (a, b, room.length - a, room.width - b)
    steps = (math.ceil((room.length - 2 * a) / OPEN_STEP), math.ceil((room.width - 2 * b) / OPEN_STEP))
    return fine(name, "open area", room, rectangle, CARPET, steps, WALKING)


def requirements(areas: Sequence[Area], maintained: float = 0) -> list[Requirement]:
    """The requirements of EN 1838 for escape lines and bands, open areas, and task areas, which are taken as tasks of
    high risk with that maintained illuminance in lux.

    >>> from luxfer.design import Room, emergency
    >>> room = Room.find(luxfer_scene)
    >>> for r in emergency.requirements([emergency.open_area(room)]): print(r)
    minimum of open area at least 0.5 lx
    diversity of open area at most 40
    rendering at least 40
    """
    out: list[Requirement] = []
    for area in areas:
        if area.kind == "escape line":
            out += _least(area.name, LINE, "4.2, escape route", True)
        elif area.kind == "escape band":
            out += _least(area.name, BAND, "4.2, escape route", False)
        elif area.kind == "open area":
            out += _least(area.name, OPEN, "4.3, open area", True)
        elif area.kind == "task":
            if maintained <= 0:
                raise ValueError(f"{area.name!r} is a task of high risk: give its maintained illuminance in lux")
            clause = f"{EMERGENCY}, 4.4, task of high risk"
            level = max(RISK, RISK_SHARE * maintained)
            out.append(Requirement("mean", area.name, at_least=level, reference=clause))
            out.append(Requirement("uniformity", area.name, at_least=RISK_UNIFORMITY, reference=clause))
        else:
            raise ValueError(f"{area.name!r} is of the kind {area.kind!r}, for which EN 1838 has no requirement")
    return [*out, Requirement("rendering", at_least=RENDERING, reference=f"{EMERGENCY}, 4.2 to 4.4")]


def black(scene: Scene) -> Scene:
    """A copy of a scene that reflects and emits nothing, so that only the light straight from luminaires counts."""
    copy = Scene.from_bytes(scene.context, scene.to_bytes(), keep_origin=1)
    for index in range(copy.counts.materials):
        for role in ("base-color", "metallic-roughness", "emission"):
            copy.set_material_texture(index, role, None)
        # With an index of refraction of 1 there is no gloss.
        copy.set_material(index, base_color=(0, 0, 0), emission=(0, 0, 0), metallic=0, transmission=0, ior=1)
    copy.set_environment((0, 0, 0))
    return copy


def dark(room: Room) -> Room:
    """The room with its black scene."""
    return replace(room, scene=black(room.scene))


def _least(name: str, lux: float, clause: str, even: bool) -> list[Requirement]:
    """The smallest illuminance of an area and, if asked, its diversity."""
    reference = f"{EMERGENCY}, {clause}"
    out = [Requirement("minimum", name, at_least=lux, reference=reference)]
    return [*out, Requirement("diversity", name, at_most=DIVERSITY, reference=reference)] if even else out


def _order(steps: tuple[int, int], turned: bool) -> tuple[int, int]:
    return (steps[1], steps[0]) if turned else steps


def _inside(room: Room, name: str, rectangle: Sequence[float]) -> None:
    """Refuses a rectangle that leaves the room."""
    a0, b0, a1, b1 = rectangle
    if a0 < -1e-6 or b0 < -1e-6 or a1 > room.length + 1e-6 or b1 > room.width + 1e-6:
        raise ValueError(
            f"{name!r} ({a0:g}, {b0:g}) to ({a1:g}, {b1:g}) m leaves the room of {room.length:g} by {room.width:g} m"
        )
