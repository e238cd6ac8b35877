"""The command line of lighting design: `luxfer.design.main(argv)`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from ..context import Context
from ..errors import Error
from ..scene import Scene
from . import areas, observers
from .areas import Area
from .check import Settings
from .luminaires import Product, dimmed, layout
from .observers import Observers
from .pictures import views
from .project import Project
from .report import save
from .rooms import Room
from .solve import Wishes
from .standard import PLACES, Requirement, place
from .units import METRES

#: Exit codes: all requirements pass; some fail or stay open; the input cannot be used.
PASSED, FAILED, UNUSABLE = 0, 1, 2
#: Distance of luminaires below the ceiling in metres. [convention]
BELOW = 0.01


def main(argv: Sequence[str] | None = None) -> int:
    """Checks a room with luminaires, or solves for their dimmers, and writes a report. Returns 0 if all requirements
    pass, 1 if not, 2 if the input cannot be used.

    >>> main(["--places"])
    34.2    office: writing, typing, reading, data processing
            school: entrance halls
            school: circulation areas, corridors
            school: stairs
            library: reading areas
    0
    """
    options = _parser().parse_args(argv)
    if options.places:
        print("\n".join(f"{p.number:8}{p.name}" for p in PLACES))
        return PASSED
    try:
        return _run(options)
    except (ValueError, KeyError, ImportError, OSError, Error) as error:
        print(f"luxfer design: {error.args[0] if isinstance(error, KeyError) else error}", file=sys.stderr)
        return UNUSABLE


def _run(options: argparse.Namespace) -> int:
    for name in ("scene", "place", "product", "maintenance"):
        if getattr(options, name) is None:
            raise ValueError(f"{'the scene' if name == 'scene' else '--' + name} is missing; see --help")
    if not options.task and not options.task_on:
        raise ValueError(
            "--task or --task-on is missing: the place requires the illuminance of a task area; where the task may be "
            "anywhere, it is the whole floor (--task 0,0,LENGTH,WIDTH,HEIGHT)"
        )
    context = Context()
    demo = options.scene == "demo"
    scene = (
        Scene.demo(context, "target-room")
        if demo
        else Scene.load(context, options.scene, unit=METRES[options.scene_unit])
    )
    room = Room.find(scene, options.floor, options.ceiling)
    found, eyes = _places(room, options)
    columns, rows = _pair(options.lamps)
    product = Product.load(context, options.product, watts=options.watts, rendering=options.rendering)
    lamps = layout(
        room, product, columns, rows, BELOW if options.below is None else options.below * METRES[options.unit]
    )
    lamps = dimmed(lamps, [options.dimmer] * len(lamps))
    settings = Settings(options.maintenance, options.confidence, seed=options.seed)
    project = Project(room, lamps, found, eyes, settings=settings, unit=options.unit, name=options.name)
    project = project.for_place(place(options.place))
    if options.max_density is not None:
        project = project.requiring(Requirement("density", at_most=options.max_density))
    solution = None
    if options.solve:
        solution = project.solve(Wishes(levels=tuple(options.levels or ())))
        project = project.solved(solution)
        print(solution.explanation())
    checked = solution.checked if solution else project.check()
    print("\n".join(str(f) for f in checked.findings))
    print(checked.verdict())
    drawn = any(not path.endswith(".json") for path in options.out)
    images = views(room, project.lit(), seed=options.seed) if drawn else {}
    for path in options.out:
        print(save(project, path, checked, solution, images=images))
    return PASSED if checked.passes else FAILED


def _places(room: Room, options: argparse.Namespace) -> tuple[list[Area], list[Observers]]:
    """The areas and observers that the options name."""
    tasks = [areas.task_on(room, name, name) for name in options.task_on]
    for number, text in enumerate(options.task, len(tasks) + 1):
        values = [float(v) for v in text.split(",")]
        if len(values) != 5:
            raise ValueError(f"--task is a0,b0,a1,b1,height, not {text!r}")
        tasks.append(areas.task(room, f"task {number}", values[:4], values[4], options.unit))
    found = [*tasks, *areas.around_tasks(room, tasks)]
    kinds = {area.kind for area in found}
    if absent := [k for k in ("surrounding", "background", "walls", "ceiling", "cylindrical") if k not in kinds]:
        print(f"not checked, because no points were found: {', '.join(absent)}", file=sys.stderr)
    eyes = [observers.at_task(room, t) for t in tasks] or [observers.along_room(room)]
    return found, eyes


def _pair(text: str) -> tuple[int, int]:
    columns, _, rows = text.partition("x")
    if not (columns.isdigit() and rows.isdigit()):
        raise ValueError(f"--lamps is such as 4x3, not {text!r}")
    return int(columns), int(rows)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "luxfer design", description="Checks or solves the lighting of a room by EN 12464-1."
    )
    add = parser.add_argument
    add("scene", nargs="?", help="a glTF file, or 'demo'")
    add("--scene-unit", choices=METRES, default="m", help="unit of the file's lengths")
    add("--unit", choices=METRES, default="m", help="unit of the lengths below and of the report")
    add("--floor", help="object or material that is the floor")
    add("--ceiling", help="object or material that is the ceiling")
    add("--places", action="store_true", help="lists the places that --place knows")
    add("--place", help="number or name of a place, such as 34.2")
    add("--task", action="append", default=[], metavar="A0,B0,A1,B1,H", help="a task area in the plan and its height")
    add("--task-on", action="append", default=[], metavar="OBJECT", help="a task area on top of an object")
    add("--product", help="photometry of the luminaires, .ies or .ldt")
    add("--watts", type=float, default=0, help="power of a luminaire; without it that of the file")
    add("--rendering", type=float, default=0, help="colour rendering index Ra")
    add("--lamps", default="4x3", metavar="CxR", help="luminaires along and across the room")
    add("--below", type=float, help="distance of the luminaires below the ceiling; 10 mm if not given")
    add("--dimmer", type=float, default=1.0, help="share of the full flux")
    add("--solve", action="store_true", help="solves for the dimmers")
    add("--levels", type=float, nargs="+", help="dimmers that the drivers can set")
    add("--max-density", type=float, help="largest power in W/m²")
    add("--maintenance", type=float, help="maintenance factor, such as 0.8")
    add("--confidence", type=float, default=0.975, help="confidence at which a requirement passes")
    add("--seed", type=int, default=1, help="seed of the paths")
    add("--name", default="Lighting design", help="title of the report")
    add("--out", action="append", default=[], help="a report to write: .html, .pdf or .json; may be repeated")
    return parser
