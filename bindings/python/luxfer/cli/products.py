"""Find the luminaire files that are nearest to a lamp of a photo, and explain the distance.

  luxfer products catalogue --size 60x60cm --shape rectangle --flux 3600 --cct 4000

Unknown quantities are left out. The files are IES, EULUMDAT, TM-33 and GLDF files of the folder and its subfolders."""

from __future__ import annotations

import argparse
import dataclasses
from typing import TYPE_CHECKING, Any

from . import options, values
from .console import Console, doubt
from .exits import Exit, failed, unreadable, usage

if TYPE_CHECKING:
    from ..context import Context
    from ..design import Lamp
    from ..design.products import Match

SUMMARY = "the luminaire files nearest to a lamp"

#: The shapes of design.lamps. They are repeated here because the import of design.lamps takes a while.
SHAPES = ("rectangle", "round", "tube", "globe")


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("folder", metavar="FOLDER", help="folder with luminaire files")
    group = parser.add_argument_group("the lamp, as far as it is known")
    group.add_argument(
        "--size",
        type=values.sides,
        metavar="SIZE",
        help="luminous opening: a diameter, two sides, or two sides and a height, such as 0.3, 60x60cm or 1.2x0.3x0.08",
    )
    group.add_argument("--shape", choices=SHAPES, help="shape of the luminous opening")
    group.add_argument("--flux", type=values.number(1e-3, 1e9, "a flux in lumens"), metavar="LM", help="luminous flux")
    group.add_argument(
        "--cct",
        type=values.number(1000, 20000, "a colour temperature in kelvin"),
        metavar="K",
        help="correlated colour temperature of the light",
    )
    group.add_argument(
        "--like",
        metavar="FILE",
        help=f"luminaire with the distribution, and with what else it states and no option gives: {options.LUMINAIRE}",
    )
    parser.add_argument(
        "--count", type=values.whole(1, 10**6, "a number of files"), default=5, metavar="N", help="how many; default 5"
    )
    options.add_common(parser)


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Finds the files."""
    from . import files
    from ..design import find_products

    context = files.context_of(args)
    lamp = _lamp(context, args.like)
    try:
        found = find_products(
            context,
            args.folder,
            lamp,
            size=args.size,
            shape=args.shape,
            flux=args.flux,
            cct=args.cct,
            count=args.count,
        )
    except ValueError as error:
        raise usage(str(error)) from None
    advice = "look at the file, which was left out"
    warnings = [doubt("products", "unreadable", f"{path}: {reason}", advice) for path, reason in found.unreadable]
    if not found.matches:
        why = _why(found.unreadable, found.incomparable)
        raise failed(f"{args.folder} has no luminaire file that can be compared: {why}")
    result = {
        "command": "products",
        "lamp": {name: getattr(found.lamp, name) for name in found.lamp.known if name != "distribution"},
        "unknown": found.unknown,
        "compared": found.compared,
        "matches": [_values(match) for match in found.matches],
        "unreadable": [{"file": path, "reason": reason} for path, reason in found.unreadable],
        "incomparable": found.incomparable,
    }
    return console.print_result(result, [*found.lines(), *found.incomparable_lines()], warnings)


def _lamp(context: Context, like: str | None) -> Lamp | None:
    """The lamp of --like."""
    from .. import Distribution
    from ..design import Lamp
    from ..errors import Error

    if like is None:
        return None
    try:
        return Lamp.of_distribution(Distribution.load(context, like))
    except Error as error:
        raise unreadable(like, error) from None


def _values(match: Match) -> dict[str, Any]:
    return {
        "file": match.path,
        "variant": match.variant,
        "name": match.name,
        "distance": match.distance,
        "parts": [dataclasses.asdict(part) for part in match.parts],
        "left_out": match.left_out,
    }


def _why(unreadable_files: Any, incomparable: Any) -> str:
    path, reason = unreadable_files[0] if unreadable_files else (incomparable[0], "states nothing that the lamp states")
    more = len(unreadable_files) + len(incomparable) - 1
    return f"{path}: {reason}" + (f", and {more} more" if more else "")
