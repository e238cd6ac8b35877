"""List the surfaces of a scene that may receive the lights, the likeliest ceilings first.

`luxfer transfer --surface NAME` takes one of these names; without it, the first."""

from __future__ import annotations

import argparse
import dataclasses

from . import options, values
from .console import Console
from .exits import Exit

SUMMARY = "candidates for the ceiling of a scene"


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("scene", metavar="SCENE", help=options.SCENE)
    parser.add_argument(
        "--count",
        type=values.whole(1, 10**6, "a number of lines"),
        default=10,
        metavar="N",
        help="how many; default 10",
    )
    options.add_units(parser)
    options.add_common(parser)


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Lists the surfaces."""
    from . import files

    scene = files.load_scene(files.context_of(args), args.scene, args.units)
    candidates = scene.candidates
    shown = candidates[: args.count]
    result = {"command": "surfaces", "count": len(candidates), "surfaces": [dataclasses.asdict(c) for c in shown]}
    lines = [f"{c.score:4.2f}  {c.kind.name.lower():8}  {c.name}: {c.reason}" for c in shown]
    if len(candidates) > len(shown):
        lines.append(f"and {len(candidates) - len(shown)} more (--count)")
    return console.print_result(result, lines or ["no surface has an area"], files.scene_warnings(scene))
