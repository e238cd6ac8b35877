"""Check the lighting of a room against the requirements of EN 12464-1, or solve for its dimmers, and write reports.

  luxfer design room.glb --place 34.2 --task-on Desk --product a.ies --maintenance 0.8 --out a.pdf
  luxfer design building.ifc --space Office --place 34.2 --maintenance 0.8 --out a.pdf

A building model brings its light fixtures, unless --product is given, and its lighting zones as task areas.

The exit code is 6 if the design is finished but a requirement fails or stays open."""

from __future__ import annotations

import argparse
import dataclasses
import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import options, values
from .console import Console, doubt
from .exits import Exit, failed, unreadable, usage

if TYPE_CHECKING:
    from ..context import Context
    from ..design import Checked, Product, Project, Solution
    from ..design.ifc import Building
    from ..design.radiance import Second
    from ..design.standard import Place
    from ..scene import Scene

SUMMARY = "check a lighting design against EN 12464-1, and write its report"

#: Distance of luminaires below the ceiling in metres. [convention]
BELOW = 0.01
#: Units of lengths in a report, as in luxfer.design.units. They are repeated here because --help must not need numpy.
UNITS = ("m", "mm", "inch")
#: Kinds of areas, besides the task, for which a place may have requirements.
KINDS = ("surrounding", "background", "walls", "ceiling", "cylindrical")
#: File types of reports.
REPORTS = (".html", ".pdf", ".json", ".csv", ".ifc")


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    room = parser.add_argument_group("the room and its tasks")
    parser.add_argument("scene", nargs="?", metavar="SCENE", help=options.SCENE)
    room.add_argument("--space", metavar="NAME", help="space of an .ifc file; one with a single space needs none")
    room.add_argument("--scene-unit", choices=list(values.UNITS), help="unit of the scene's file; default m")
    room.add_argument("--unit", choices=UNITS, default="m", help="unit of the lengths below and of the report")
    room.add_argument("--floor", metavar="NAME", help="object or material that is the floor")
    room.add_argument("--ceiling", metavar="NAME", help="object or material that is the ceiling")
    room.add_argument("--places", action="store_true", help="only list the places that --place knows")
    room.add_argument("--place", help="number or name of a place, such as 34.2")
    room.add_argument("--places-from", metavar="FILE", help="a .csv file with places of your own")
    corners = "A0,B0,A1,B1,HEIGHT"
    room.add_argument(
        "--task", action="append", default=[], metavar=corners, help="a task area in the plan; may be repeated"
    )
    room.add_argument("--task-on", action="append", default=[], metavar="OBJECT", help="a task area on an object")
    lamps = parser.add_argument_group("the luminaires")
    lamps.add_argument("--product", metavar="FILE", help="photometry of the luminaires, " + options.LUMINAIRE)
    lamps.add_argument("--watts", type=float, default=0, help="power of a luminaire; without it that of the file")
    lamps.add_argument("--rendering", type=float, default=0, metavar="RA", help="colour rendering index Ra")
    lamps.add_argument(
        "--lamps", default="4x3", metavar="CxR", help="luminaires along and across the room; default 4x3"
    )
    lamps.add_argument("--below", type=float, help="distance of the luminaires below the ceiling; default 10 mm")
    lamps.add_argument("--dimmer", type=float, default=1.0, help="share of the full flux; default 1")
    lamps.add_argument("--solve", action="store_true", help="solve for the dimmers")
    lamps.add_argument("--levels", type=float, nargs="+", metavar="SHARE", help="dimmers that the drivers can set")
    check = parser.add_argument_group("the check and its report")
    check.add_argument("--max-density", type=float, metavar="POWER", help="largest power in W/m²")
    check.add_argument("--maintenance", type=float, metavar="SHARE", help="maintenance factor, such as 0.8")
    check.add_argument("--confidence", type=float, default=0.975, help="at which a requirement passes; default 0.975")
    check.add_argument("--seed", type=int, default=1, help="seed of the paths; default 1")
    check.add_argument("--name", default="Lighting design", help="title of the report")
    check.add_argument(
        "--out", action="append", default=[], metavar="FILE", help=".html, .pdf, .json, .csv or .ifc; may be repeated"
    )
    check.add_argument(
        "--radiance", metavar="FOLDER", help="write Radiance's files into a folder, and have Radiance recompute them"
    )
    options.add_common(parser)


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Checks or solves the design."""
    if args.places:
        return _places(args, console)
    outs = _checked_options(args)
    from . import files

    context = files.context_of(args)
    building = _building(context, args)
    scene = building.room.scene if building else files.load_scene(context, args.scene, args.scene_unit)
    product = _product(context, args) if args.product else None
    try:
        project = _project(scene, product, args, building)
        solution, checked = _results(project, args)
    except (ValueError, KeyError) as error:  # an option that does not fit the room or the others
        raise usage(str(error.args[0] if error.args else error)) from None
    project = project.solved(solution) if solution else project
    second = _recomputed(project, checked, args)
    _save(project, checked, solution, outs, console, second)
    warnings = [*files.scene_warnings(scene), *_unchecked(project, checked)]
    warnings += [doubt("design", "building", text, "look at the plan of the report") for text in _notes(building)]
    lines = [*([solution.explanation()] if solution else []), *map(str, checked.findings), checked.verdict()]
    lines += [f"By Radiance: {one}" for one in second]
    code = console.print_result(_result(project, checked, solution, second), lines, warnings)
    return code if checked.passes else Exit.UNMET


def _places(args: argparse.Namespace, console: Console) -> Exit:
    known = _known_places(args)
    rows = [{"number": p.number, "name": p.name} for p in known]
    return console.print_result({"command": "design", "places": rows}, [f"{p.number:8}{p.name}" for p in known])


def _known_places(args: argparse.Namespace) -> Sequence[Place]:
    """Returns the places of the user's file, or the places that the package knows."""
    from ..design.standard import PLACES, places_from

    if args.places_from is None:
        return PLACES
    try:
        return places_from(args.places_from)
    except (ValueError, OSError) as error:
        raise unreadable(args.places_from, error) from None


def _checked_options(args: argparse.Namespace) -> list[Path]:
    """Returns the paths of the reports. Fails before any work if an option is missing or a report cannot be written."""
    from . import files

    model = _is_model(args)
    for name in ("scene", "place", "product", "maintenance"):
        if name == "product" and model:
            continue
        if getattr(args, name) is None:
            raise usage(f"{'SCENE' if name == 'scene' else '--' + name} is missing (luxfer design --help)")
    if not args.task and not args.task_on and not model:
        raise usage(
            "--task or --task-on is missing: the place requires the illuminance of a task area; where the task may be "
            "anywhere, it is the whole floor (--task 0,0,LENGTH,WIDTH,HEIGHT)"
        )
    inputs = files.shared_input(args.scene, args.product, args.places_from)
    outs = [files.check_file("--out", n, inputs, REPORTS) for n in args.out]
    if any(path.suffix.lower() == ".pdf" for path in outs) and importlib.util.find_spec("reportlab") is None:
        raise failed("--out: a PDF file needs reportlab: pip install 'luxfer[report]'")
    if any(path.suffix.lower() == ".ifc" for path in outs) and importlib.util.find_spec("ifcopenshell") is None:
        raise failed("--out: a building model needs ifcopenshell: pip install 'luxfer[ifc]'")
    return outs


def _is_model(args: argparse.Namespace) -> bool:
    """Whether the scene is a building model."""
    return args.scene is not None and args.scene.lower().endswith(".ifc")


def _building(context: Context, args: argparse.Namespace) -> Building | None:
    """Reads a building model; None for other scenes."""
    from ..design import ifc

    if not _is_model(args):
        if args.space is not None:
            raise usage("--space names a space of an .ifc file, which SCENE is not")
        return None
    try:
        return ifc.load(context, args.scene, args.space)
    except ImportError as error:
        raise failed(f"{args.scene}: {error}") from None
    except (ValueError, OSError) as error:
        raise unreadable(args.scene, error) from None


def _notes(building: Building | None) -> tuple[str, ...]:
    return building.notes if building else ()


def _product(context: Context, args: argparse.Namespace) -> Product:
    from ..design import Product
    from ..errors import Error

    try:
        return Product.load(context, args.product, watts=args.watts, rendering=args.rendering)
    except (ValueError, OSError, Error) as error:
        raise unreadable(args.product, error) from None


def _project(
    scene: Scene, product: Product | None, args: argparse.Namespace, building: Building | None = None
) -> Project:
    """Creates the design that the options and, if there is one, the building model describe."""
    from ..design import Project, Requirement, Room, Settings, areas, dimmed, layout, observers, place
    from ..design.units import factor

    room = building.room if building else Room.find(scene, args.floor, args.ceiling)
    tasks = [areas.task_on(room, name, name) for name in args.task_on]
    for number, text in enumerate(args.task, len(tasks) + 1):
        corners = _numbers(text)
        tasks.append(areas.task(room, f"task {number}", corners[:4], corners[4], args.unit))
    if building and not tasks:
        tasks = list(building.areas)
    if not tasks:
        raise ValueError(f"{args.scene} has no lighting zone in this space: give its tasks by --task or --task-on")
    if product is not None:
        columns, rows = _pair(args.lamps)
        lamps = layout(room, product, columns, rows, BELOW if args.below is None else args.below * factor(args.unit))
        lamps = dimmed(lamps, [args.dimmer] * len(lamps))
    else:
        lamps = list(building.luminaires if building else ())
        if not lamps:
            raise ValueError(f"{args.scene} has no light fixture with photometry in this space: give --product")
        lamps = dimmed(lamps, [args.dimmer * lamp.dimmer for lamp in lamps])
    settings = Settings(args.maintenance, args.confidence, seed=args.seed)
    found, eyes = [*tasks, *areas.around_tasks(room, tasks)], [observers.at_task(room, t) for t in tasks]
    project = Project(room, lamps, found, eyes, settings=settings, unit=args.unit, name=args.name)
    project = project.for_place(place(args.place, _known_places(args)))
    if args.max_density is not None:
        project = project.requiring(Requirement("density", at_most=args.max_density))
    return project


def _results(project: Project, args: argparse.Namespace) -> tuple[Solution | None, Checked]:
    from ..design import Wishes

    if not args.solve:
        return None, project.check()
    solution = project.solve(Wishes(levels=tuple(args.levels or ())))
    return solution, solution.checked


def _recomputed(project: Project, checked: Checked, args: argparse.Namespace) -> list[Second]:
    """Has Radiance recompute the design, if it is asked for."""
    from ..design import radiance

    if args.radiance is None:
        return []
    try:
        radiance.export(project, args.radiance)
        return radiance.recompute(project, checked, args.radiance)
    except OSError as error:
        raise failed(f"--radiance: {args.radiance} cannot be written: {error.strerror}") from None
    except (ImportError, RuntimeError) as error:
        raise failed(f"--radiance: {error}") from None


def _save(
    project: Project,
    checked: Checked,
    solution: Solution | None,
    outs: list[Path],
    console: Console,
    second: Sequence[Second] = (),
) -> None:
    """Writes the reports; the formats that can hold pictures get them."""
    from ..design import save
    from ..design.pictures import views

    drawn = any(path.suffix.lower() in (".html", ".pdf") for path in outs)
    images = views(project.room, project.lit(), seed=project.chosen.seed) if drawn else {}
    for path in outs:
        try:
            save(project, path, checked, solution, images=images, second=second)
        except OSError as error:
            raise failed(f"{path} cannot be written: {error.strerror}") from None
        console.wrote(path)


def _unchecked(project: Project, checked: Checked) -> list[dict[str, Any]]:
    """Returns warnings about requirements that were not checked."""
    kinds = {area.kind for area in project.areas}
    absent = [kind for kind in KINDS if kind not in kinds]
    said = [*checked.notes, *([f"not checked, because no points were found: {', '.join(absent)}"] if absent else [])]
    return [doubt("design", "unchecked", text, "check it by hand, or name --floor and --ceiling") for text in said]


def _result(
    project: Project, checked: Checked, solution: Solution | None, second: Sequence[Second] = ()
) -> dict[str, Any]:
    """Returns the result that --json prints."""
    findings = []
    for f in checked.findings:
        own = {field.name: getattr(f, field.name) for field in dataclasses.fields(f) if field.name != "requirement"}
        findings.append({**dataclasses.asdict(f.requirement), **own})
    return {
        "command": "design",
        "passes": checked.passes,
        "verdict": checked.verdict(),
        "explanation": solution.explanation() if solution else None,
        "dimmers": [lamp.dimmer for lamp in project.luminaires],
        "findings": findings,
        "radiance": [
            {"requirement": str(s.finding.requirement), "value": s.value, "confirmed": s.confirms} for s in second
        ],
    }


def _numbers(text: str) -> list[float]:
    try:
        found = [float(v) for v in text.split(",")]
    except ValueError:
        found = []
    if len(found) != 5:
        raise usage(f"--task is A0,B0,A1,B1,HEIGHT, not {text!r}")
    return found


def _pair(text: str) -> tuple[int, int]:
    columns, _, rows = text.partition("x")
    if not (columns.isdigit() and rows.isdigit()):
        raise usage(f"--lamps is such as 4x3, not {text!r}")
    return int(columns), int(rows)
