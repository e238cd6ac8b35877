"""Five rooms with the requirements of their tasks, for design_photos.py.

Demonstration room, office floor and corridor have rows of EN 12464-1. The package knows no row for a kitchen or a flat,
so these two have requirements of their own. Kitchen and flat are those of the test data (LUXFER_TEST_DATA).
"""

import os
from pathlib import Path

import luxfer
import numpy as np
from design_radiance import CONTEXT, hall

from luxfer import design
from luxfer.design import areas, observers

SETTINGS = design.Settings(maintenance=0.8, samples=64)
#: Mean illuminance, uniformity, glare and colour rendering of a worktop, and of a flat's worktop.
KITCHEN = design.Place("", "kitchen: worktop", "own requirements", 500, 0.6, 22, 80, 0, 0, 0)
FLAT = design.Place("", "flat: worktop", "own requirements", 300, 0.6, 22, 80, 0, 0, 0)
#: Plan of the flat's living room between its walls, and of its worktop, in metres: x0, z0, x1, z1. Height of both.
LIVING, WORKTOP = (6.71, -7.66, 12.35, -2.67), (8.2, -5.2, 10.8, -4.1)
CEILING_HEIGHT, WORKTOP_HEIGHT = 2.68, 0.93


def demonstration() -> design.Project:
    """The demonstration room, with textures, gloss and furniture: an office around its table."""
    room = design.Room.find(luxfer.Scene.demo(CONTEXT, "target-room"))
    desk = areas.task_on(room, "desk", "Table")
    return project(room, [desk], [observers.at_task(room, desk)], design.place("34.2"))


def kitchen() -> design.Project:
    """A kitchen of 260,000 triangles and its worktop."""
    scene = luxfer.Scene.load(CONTEXT, _scene("kitchen/country_kitchen.glb"))
    room = design.Room.find(scene, "Floor", "Ceiling")
    top = areas.task_on(room, "worktop", "SmallWorktop", lift=0.03)
    cooks = observers.at_task(room, top, eye=observers.STANDING_EYE)
    return project(room, [top], [cooks], KITCHEN)


def flat() -> design.Project:
    """The living room of a flat of 180,000 triangles, whose model has no ceiling: a white one lies on its walls."""
    scene = luxfer.Scene.load(CONTEXT, _scene("apartment/dream_apartment.glb"))
    paint = scene.add_material(name="Ceiling", base_color=(0.8,) * 3, ior=1)
    x0, z0, x1, z1 = LIVING
    corners = [[x, CEILING_HEIGHT, z] for x, z in ((x0, z0), (x1, z0), (x1, z1), (x0, z1))]
    scene.add_mesh(np.array(corners), [[0, 1, 2], [0, 2, 3]], name="Ceiling", material=paint)
    origin, along, across = np.array([x0, 0.0, z0]), np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
    sides = (x1 - x0, z1 - z0)
    floor = "Wood_Floor_Light"
    room = design.Room(scene, floor, "Ceiling", origin, along, across, *sides, CEILING_HEIGHT, sides[0] * sides[1])
    a0, b0, a1, b1 = (WORKTOP[0] - x0, WORKTOP[1] - z0, WORKTOP[2] - x0, WORKTOP[3] - z0)
    top = areas.task(room, "worktop", (a0, b0, a1, b1), WORKTOP_HEIGHT + 0.01)
    cooks = observers.at_task(room, top, eye=observers.STANDING_EYE)
    return project(room, [top], [cooks], FLAT)


def office() -> design.Project:
    """An office floor of 12 by 8 m with twelve desks, of which one in the middle and one in a corner are checked."""
    room = hall(12, 8, 2.8, [(x, z) for z in (2.0, 4.0, 6.0) for x in (1.5, 4.5, 7.5, 10.5)])
    middle = areas.task(room, "desk", (3.7, 3.6, 5.3, 4.4), 0.73)
    corner = areas.task(room, "desk in a corner", (0.7, 1.6, 2.3, 2.4), 0.73)
    people = [observers.at_task(room, middle), observers.at_task(room, corner)]
    return project(room, [middle, corner], people, design.place("34.2"))


def corridor() -> design.Project:
    """A corridor of 12 by 2 m, whose task area is its floor."""
    room = hall(12, 2, 2.6)
    floor = areas.task(room, "floor", (0, 0, 12, 2), 0)
    people = [observers.along_room(room, eye=observers.STANDING_EYE)]
    return project(room, [floor], people, design.place("corridors"))


def project(room: design.Room, tasks: list, people: list, row: design.Place) -> design.Project:
    """A room with all areas around its tasks and the requirements of a place, without luminaires."""
    made = [*tasks, *areas.around_tasks(room, tasks)]
    return design.Project(room, (), made, people, settings=SETTINGS).for_place(row)


def _scene(name: str) -> Path:
    return Path(os.environ["LUXFER_TEST_DATA"]) / "scenes" / name


ROOMS = {"demo": demonstration, "kitchen": kitchen, "flat": flat, "office": office, "corridor": corridor}
