"""Options that several subcommands share."""

from __future__ import annotations

import argparse

from . import values

#: For each --quality, the noise of the picture and the maximum time in seconds; 0 stands for no limit.
QUALITIES = {"draft": (0.10, 30.0), "good": (0.04, 180.0), "best": (0.01, 0.0)}

#: Noise above which a PNG is filtered unless --no-filter is given.
CLEAN = 0.02

SCENE = "a scene: .glb, .gltf, .usd, or demo:NAME of target-room, exemplar-room, sphere-on-table, still-life"
IMAGE = "a picture: JPEG, PNG, WebP, TIFF, BMP, GIF, Radiance HDR or OpenEXR"
LUMINAIRE = ".ies, .ldt, .xml (TM-33), or .gldf (#VARIANT after it chooses a variant)"


def add_common(parser: argparse.ArgumentParser) -> None:
    """Adds --json, --strict and --progress."""
    group = parser.add_argument_group("output")
    group.add_argument("--json", action="store_true", help="print one JSON object on stdout, and nothing else there")
    group.add_argument("--strict", action="store_true", help="exit code 1 if a warning doubts the result")
    group.add_argument(
        "--progress",
        action=argparse.BooleanOptionalAction,
        help="show progress and the time left on stderr; by default only in a terminal",
    )
    group.add_argument(
        "--threads",
        type=values.whole(0, 1024, "a number of threads"),
        default=0,
        metavar="N",
        help="default: one for each core",
    )


def add_units(parser: argparse.ArgumentParser) -> None:
    """Adds --units, the unit of a scene's file."""
    parser.add_argument(
        "--units",
        choices=list(values.UNITS),
        help="unit of the scene's file, if it is not in metres as glTF prescribes; USD files state theirs",
    )


def add_luminaires(parser: argparse.ArgumentParser) -> None:
    """Adds --luminaires, the shape of the luminaires of a scene's file."""
    parser.add_argument(
        "--luminaires",
        choices=["faces", "point"],
        default="faces",
        help="from where the luminaires of a glTF file shine: from the faces of their openings, which are in the picture, "
        "if they state a size, or from points; default faces",
    )


def add_camera(parser: argparse.ArgumentParser) -> None:
    """Adds --camera and --size."""
    parser.add_argument(
        "--camera",
        type=values.camera,
        metavar="CAMERA",
        help="number of a camera of the scene, from 0, or POSITION/TARGET[/DEGREES] in metres, such as "
        "1,1.6,2/4,1,0/60; default: the first camera",
    )
    parser.add_argument(
        "--size",
        type=values.size,
        default=(640, 360),
        metavar="WxH",
        help="size of the picture in pixels; default 640x360",
    )


def add_quality(parser: argparse.ArgumentParser) -> None:
    """Adds --quality, --error, --time and --no-filter."""
    group = parser.add_argument_group("quality of the picture")
    goal = group.add_mutually_exclusive_group()
    listed = "; ".join(
        f"{name}: {100 * error:g} %%" + (f" within {seconds:g} s" if seconds else "")
        for name, (error, seconds) in QUALITIES.items()
    )
    goal.add_argument(
        "--quality", choices=list(QUALITIES), default="good", help=f"noise of the picture; default good ({listed})"
    )
    goal.add_argument(
        "--error", type=values.share, metavar="SHARE", help="noise of the picture relative to its mean, such as 2%%"
    )
    goal.add_argument(
        "--time", type=values.seconds, metavar="TIME", help="time for all of the work, such as 30s, 2min or 1:30"
    )
    group.add_argument(
        "--no-filter",
        action="store_true",
        help=f"do not filter a PNG with more than {100 * CLEAN:g} %% of noise; EXR files are never filtered",
    )
    group.add_argument(
        "--seed",
        type=values.whole(0, 2**32 - 1, "a seed"),
        default=1,
        metavar="N",
        help="seed of the paths; default 1",
    )


def add_white(parser: argparse._ActionsContainer, text: str) -> None:
    """Adds --white."""
    parser.add_argument("--white", type=values.number(1e-6, 1e9, "a luminance in cd/m²"), metavar="CD", help=text)
