"""Predict how long a rendering takes, or how much noise it has, before it is made.

Without a goal, prints the time of several errors. With --photo the plan covers relighting and rendering of a transfer,
whose earlier stages it runs."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from . import options, values
from .console import Console, clock, percent
from .exits import Exit, usage

if TYPE_CHECKING:
    from ..plan import Plan

SUMMARY = "predicted time for an error, or error for a time"

#: Errors of the table.
ERRORS = (0.1, 0.05, 0.02, 0.01)


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("scene", metavar="SCENE", help=options.SCENE)
    parser.add_argument("--photo", metavar="PHOTO", help="plan a transfer of this photo's light")
    parser.add_argument("--strokes", metavar="FILE", help="strokes on the photo, as for `luxfer transfer`")
    parser.add_argument(
        "--surface", metavar="NAME", help="surface that receives the lights; default: the likeliest ceiling"
    )
    goal = parser.add_mutually_exclusive_group()
    goal.add_argument(
        "--error", type=values.share, metavar="SHARE", help="noise of the picture, such as 2%%: how long?"
    )
    goal.add_argument("--time", type=values.seconds, metavar="TIME", help="time such as 30s: how much noise?")
    parser.add_argument(
        "--seed", type=values.whole(0, 2**32 - 1, "a seed"), default=1, metavar="N", help="seed of the paths"
    )
    options.add_camera(parser)
    options.add_units(parser)
    options.add_common(parser)
    parser.set_defaults(white=None, distance=None, quality="good", exposures=None)


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Prints the predictions."""
    if args.photo is None and (args.strokes or args.surface):
        raise usage(f"--{'strokes' if args.strokes else 'surface'} goes with --photo")
    goals: list[dict[str, Any]] = [{"target_error": error} for error in ERRORS]
    if args.error is not None:
        goals = [{"target_error": args.error}]
    elif args.time is not None:
        goals = [{"time_budget_ms": round(1000 * args.time)}]
    plans, warnings = of_transfer(args, console, goals) if args.photo else of_render(args, console, goals)
    rows = [row(plan) for plan in plans]
    result = {"command": "plan", "width": args.size[0], "height": args.size[1], "plans": rows}
    lines = [f"{args.size[0]} x {args.size[1]} pixels"]
    lines += [
        f"{percent(r['error']):>8} of noise in {clock(r['seconds']):>8}, {r['paths_per_pixel']} paths per pixel"
        for r in rows
    ]
    return console.print_result(result, lines, warnings)


def row(plan: Plan) -> dict[str, Any]:
    """Returns a plan in the form in which JSON shows it."""
    report = plan.report
    return {
        "seconds": report.seconds,
        "error": report.error,
        "relight_seconds": report.relight_seconds,
        "render_seconds": report.render_seconds,
        "paths_per_pixel": plan.render_params["samples"],
    }


def of_render(
    args: argparse.Namespace, console: Console, goals: list[dict[str, Any]]
) -> tuple[list[Plan], list[dict[str, Any]]]:
    """Plans a rendering, once for each goal."""
    from .. import Plan, Render
    from . import files, picture

    context = files.context_of(args)
    scene = files.load_scene(context, args.scene, args.units)
    render = Render(context, scene)
    render.set_camera(picture.camera_of(scene, args.camera))
    settings = picture.base_settings(args)
    plans = [Plan(context).run_render(render, console.step("planning"), settings=settings, **goal) for goal in goals]
    return plans, files.scene_warnings(scene)


def of_transfer(
    args: argparse.Namespace, console: Console, goals: list[dict[str, Any]]
) -> tuple[list[Plan], list[dict[str, Any]]]:
    """Plans relighting and rendering of a transfer, after its stages up to the texture have run."""
    from .. import Plan
    from . import files, picture, transfer
    from .console import described_stages

    context = files.context_of(args)
    stages, start = transfer.prepare(context, args)
    stages.run(last="emission", progress=console.step("making the texture"), **start.settings)
    settings = {**start.settings, "render": picture.base_settings(args)}
    plans = [Plan(context).run_transfer(stages, console.step("planning"), settings=settings, **goal) for goal in goals]
    return plans, start.warnings + described_stages(stages.warnings)
