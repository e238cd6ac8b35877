"""Designs recomputed by Radiance from their exported files.

    LUXFER_LIBRARY=target/release/libluxfer.so target/peers/exchange/bin/python benches/peers/design_radiance.py

Three rooms, each checked by luxfer.design and by Radiance: the demonstration room, an office floor of 12 by 8 m with
twelve desks, and a corridor of 12 by 2 m with emergency light. Prints both numbers of each requirement with luxfer's
interval, and the time of both. Further words are settings of rtrace, such as -dt 0.05, its own default.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bindings" / "python"))

import luxfer  # noqa: E402
from luxfer import design  # noqa: E402
from luxfer.design import areas, emergency, radiance  # noqa: E402

CONTEXT = luxfer.Context()
SETTINGS = design.Settings(maintenance=0.8, samples=256, max_samples=4096)
REFLECTANCES = {"Floor": 0.2, "Ceiling": 0.7, "Wall": 0.5}


def hall(length: float, width: float, height: float, tables: list[tuple[float, float]] = ()) -> design.Room:
    """A closed room with matte surfaces, and tables of 1.6 by 0.8 m with their middles at points of the plan."""
    scene = luxfer.Scene(CONTEXT)
    corners = np.array([[x, y, z] for y in (0, height) for x, z in ((0, 0), (length, 0), (length, width), (0, width))])
    faces = {"Floor": (3, 2, 1, 0), "Ceiling": (4, 5, 6, 7)}
    faces |= {f"Wall {i}": (i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)}
    for name, ids in faces.items():
        value = REFLECTANCES[name.split()[0]]
        paint = scene.add_material(name=name, base_color=(value,) * 3, ior=1)
        scene.add_mesh(corners[list(ids)], [[0, 1, 2], [0, 2, 3]], name=name, material=paint)
    wood = scene.add_material(name="wood", base_color=(0.4,) * 3, ior=1)
    for x, z in tables:
        top = np.array([[x + a, 0.72, z + b] for a, b in ((-0.8, 0.4), (0.8, 0.4), (0.8, -0.4), (-0.8, -0.4))])
        scene.add_mesh(top, [[0, 1, 2], [0, 2, 3]], name="Desk", material=wood)
    return design.Room.find(scene, "Floor", "Ceiling")


def at_least(quantity: str, area: str, limit: float) -> design.Requirement:
    return design.Requirement(quantity, area, at_least=limit)


def demonstration() -> design.Project:
    """The demonstration room, with textures, gloss and furniture."""
    room = design.Room.find(luxfer.Scene.demo(CONTEXT, "target-room"))
    panel = design.Product.panel(CONTEXT, 0.6, 0.6, 4600, watts=36, rendering=80)
    desk, faces = areas.task_on(room, "desk", "Table"), areas.cylindrical(room)
    lit = design.Project(room, design.layout(room, panel, 3, 2), (desk, faces, areas.ceiling(room)), settings=SETTINGS)
    limits = (("mean", "desk", 500), ("uniformity", "desk", 0.6), ("mean", "faces", 150), ("modelling", "faces", 0.3))
    return lit.requiring(*(at_least(*r) for r in limits), at_least("mean", "ceiling", 100))


def office() -> design.Project:
    """An office floor."""
    places = [(x, z) for z in (2.0, 4.0, 6.0) for x in (1.5, 4.5, 7.5, 10.5)]
    room = hall(12, 8, 2.8, places)
    panel = design.Product.panel(CONTEXT, 1.2, 0.3, 4000, watts=28, rendering=80)
    desk = areas.task(room, "desk", (3.7, 3.6, 5.3, 4.4), 0.73)
    corner = areas.task(room, "desk in a corner", (0.7, 1.6, 2.3, 2.4), 0.73)
    band = areas.surrounding(room, desk)
    lit = design.Project(room, design.layout(room, panel, 6, 4), (desk, corner, band), settings=SETTINGS)
    limits = (("mean", "desk", 500), ("uniformity", "desk", 0.6), ("mean", "desk in a corner", 500))
    return lit.requiring(*(at_least(*r) for r in limits), at_least("mean", "around desk", 300))


def corridor() -> design.Project:
    """A corridor with emergency light."""
    room = hall(12, 2, 2.6)
    spot = design.Product.panel(CONTEXT, 0.15, 0.15, 1500, watts=12, rendering=80)
    route = emergency.escape_route(room, "way out", (0, 0.2, 12, 1.8))
    state = design.LightScene(
        "emergency", [0.05, 0, 0.05, 0, 0.05, 0], tuple(emergency.requirements(route)), direct=True
    )
    lit = design.Project(room, design.layout(room, spot, 6, 1), route, settings=SETTINGS, scenes=(state,))
    return lit.in_scene("emergency")


def main() -> None:
    """Prints the table."""
    agreed, differences = [], []
    for name, make in (("demonstration room", demonstration), ("office floor", office), ("corridor", corridor)):
        lit = make()
        begun = time.perf_counter()
        checked = lit.check()
        ours = time.perf_counter() - begun
        with tempfile.TemporaryDirectory() as folder:
            begun = time.perf_counter()
            radiance.export(lit, folder)
            second = radiance.recompute(lit, checked, folder, (*radiance.RTRACE, *sys.argv[1:]))
            theirs = time.perf_counter() - begun
        print(f"{name}: {ours:.1f} s by luxfer, {theirs:.1f} s by Radiance")
        for s in second:
            f = s.finding
            print(f"  {s} [{f.low:.4g}, {f.high:.4g}]")
            agreed.append(s.confirms)
            if f.requirement.quantity == "mean":
                differences.append(abs(s.difference))
    print(f"{sum(agreed)} of {len(agreed)} confirmed; means differ by up to {100 * max(differences):.1f} %")


if __name__ == "__main__":
    main()
