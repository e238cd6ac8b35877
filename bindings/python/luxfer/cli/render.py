"""Render a scene in cd/m²: a PNG to look at, or an OpenEXR file with its layers.

The PNG of a picture with more than 2 % of noise is filtered, and the error of the filter is stated."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

from . import options, values
from .console import Console
from .exits import Exit, usage

if TYPE_CHECKING:
    from ..scene import Scene

SUMMARY = "render a scene"

LAYERS = (
    "depth",
    "distance",
    "position",
    "normal",
    "geometric-normal",
    "albedo",
    "object",
    "material",
    "alpha",
    "luminance",
)


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("scene", metavar="SCENE", help=options.SCENE)
    parser.add_argument(
        "--out", action="append", metavar="FILE", help="the picture, .png or .exr; may be given for both"
    )
    options.add_camera(parser)
    options.add_units(parser)
    options.add_luminaires(parser)
    options.add_white(parser, "luminance shown as white in the PNG, in cd/m²; default: by the picture")
    parser.add_argument(
        "--sky",
        type=values.number(0, 1e9, "a luminance in cd/m²"),
        metavar="CD",
        help="add light from everywhere around, in cd/m²",
    )
    parser.add_argument(
        "--layers",
        type=layers,
        default=[],
        metavar="NAME,...",
        help=f"layers of the .exr: {', '.join(LAYERS)}, or light path expressions such as direct=LDE",
    )
    options.add_quality(parser)
    options.add_common(parser)


def layers(text: str) -> list[str]:
    """Parses names of layers and NAME=EXPRESSION."""
    found = [part.strip() for part in text.split(",")]
    for part in found:
        if part not in LAYERS and not ("=" in part and all(part.partition("=")[::2])):
            raise values.wrong(part, f"a layer: {', '.join(LAYERS)}, or NAME=EXPRESSION")
    return found


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Renders and prints the result."""
    from . import files

    if not args.out:
        raise usage("--out is missing: nothing would be written; give --out picture.png, or .exr")
    began = time.monotonic()
    inputs = files.shared_input(args.scene)
    outputs = [files.check_file("--out", name, inputs, (".png", ".exr")) for name in args.out]
    if args.layers and not any(path.suffix.lower() == ".exr" for path in outputs):
        raise usage("--layers needs an .exr among --out: a PNG has no layers")

    context = files.context_of(args)
    scene = files.load_scene(context, args.scene, args.units, args.luminaires)
    return render_scene(args, console, scene, outputs, began)


def render_scene(args: argparse.Namespace, console: Console, scene: Scene, outputs: list[Path], began: float) -> Exit:
    """Renders a scene and writes the files."""
    from .. import Render
    from . import files, picture

    if args.sky is not None:
        scene.set_environment((args.sky,) * 3)
    expressions = dict(part.split("=", 1) for part in args.layers if "=" in part)
    aovs = "|".join(part for part in args.layers if "=" not in part)
    render = Render(scene.context, scene, expressions=expressions, aovs=aovs or 0)
    render.set_camera(picture.camera_of(scene, args.camera))
    goal = picture.Goal.of(args)
    settings = picture.plan_render(render, args, goal, time.monotonic() - began, console)
    found = picture.run(render, settings, goal, console)

    white = args.white or picture.automatic_white(found)
    for path in outputs:
        if path.suffix.lower() == ".exr" and args.layers:
            render.write_exr(path)
        else:
            found.save(path, white)
        console.wrote(path)
    result = {
        "command": "render",
        "width": args.size[0],
        "height": args.size[1],
        "white_cd_m2": white,
        "seconds": time.monotonic() - began,
        **found.facts(),
    }
    lines = [found.words(), f"white is {white:g} cd/m²"]
    return console.print_result(result, lines, files.scene_warnings(scene) + found.doubts())
