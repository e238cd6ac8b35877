"""Paint a scene in the style of an artwork.

ARTWORK is a painting of the exemplar scene, aligned with it, such as `luxfer sheet read` makes, or demo:NAME of pen,
stipple, paint. Both scenes need a camera."""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING, Any

from . import options, values
from .console import Console, doubt, percent
from .exits import Exit, usage

if TYPE_CHECKING:
    from ..context import Context
    from ..guides import Guides
    from ..image import Image
    from ..stylize import Stylize

SUMMARY = "paint a scene in the style of an artwork"

ARTWORKS = ("pen", "stipple", "paint")
EXTRAS = ("normals", "edges", "materials", "caustics")
PRESETS = ("full", "fast", "preview")
#: Maximum side of an artwork in pixels: the exemplar is rendered at the size of the artwork.
MAX_SIDE = 2048
#: Guide error above which a warning says that the exemplar hardly contains the light of the target.
#: [judged on 2 scenes]
POOR = 0.25


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("artwork", metavar="ARTWORK", help=f"{options.IMAGE}, or demo:pen, demo:stipple, demo:paint")
    parser.add_argument("target", metavar="TARGET", help=f"what to paint, {options.SCENE}")
    parser.add_argument(
        "--exemplar",
        default="demo:sphere-on-table",
        metavar="SCENE",
        help="the scene that was painted; default demo:sphere-on-table",
    )
    parser.add_argument("--out", metavar="FILE", help="the painting, .png or .exr")
    parser.add_argument(
        "--size", type=values.size, default=(640, 480), metavar="WxH", help="size of the painting; default 640x480"
    )
    parser.add_argument(
        "--camera", type=values.camera, metavar="CAMERA", help="camera of the target, as for `luxfer render`"
    )
    parser.add_argument(
        "--guides",
        type=extras,
        default=["materials"],
        metavar="NAME,...",
        help=f"besides light: {', '.join(EXTRAS)}, or none; default materials",
    )
    parser.add_argument(
        "--guide-weight",
        type=values.number(0, 1e6, "a weight"),
        default=1.0,
        metavar="W",
        help="weight of --guides; default 1",
    )
    parser.add_argument(
        "--samples", type=values.whole(1, 65536, "paths per pixel"), default=32, help="paths per pixel of the guides"
    )
    goal = parser.add_mutually_exclusive_group()
    goal.add_argument("--preset", choices=PRESETS, default="full", help="default full")
    goal.add_argument("--time", type=values.seconds, metavar="TIME", help="time for the painting, without its guides")
    goal.add_argument(
        "--error", type=values.share, metavar="SHARE", help="difference of patches in colours and guides to reach"
    )
    parser.add_argument(
        "--seed", type=values.whole(0, 2**32 - 1, "a seed"), default=1, metavar="N", help="seed of the search"
    )
    options.add_units(parser)
    options.add_common(parser)


def extras(text: str) -> list[str]:
    """Parses names of guides."""
    if text == "none":
        return []
    names = text.split(",")
    for name in names:
        if name not in EXTRAS:
            raise values.wrong(name, f"a guide: {', '.join(EXTRAS)}, or none")
    return names


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Stylises the scene and prints the result."""
    from .. import Stylize
    from . import files

    if not args.out:
        raise usage("--out is missing: nothing would be written; give --out painting.png")
    began = time.monotonic()
    inputs = files.shared_input(args.artwork, args.target, args.exemplar)
    out = files.check_file("--out", args.out, inputs, (".png", ".exr"))
    context = files.context_of(args)
    artwork, source = exemplar(context, args, console)
    target = guides(context, args.target, args, console, args.size, args.camera, "rendering the target")

    stylize = Stylize(context, artwork)
    stylize.add_guides(source, target, "|".join(args.guides) or 0, args.guide_weight)
    stylize.run(console.step("painting"), **settings(stylize, args, console))
    stylize.image().save(out)
    console.wrote(out)
    report = stylize.report
    width, height, _ = stylize.image().size
    result = {
        "command": "stylise",
        "width": width,
        "height": height,
        "guide_error": report.guide_error,
        "error": report.energy**0.5,
        "used": report.used,
        "seconds": time.monotonic() - began,
    }
    lines = [
        f"{width} x {height}; guides off by {percent(report.guide_error)}; {percent(report.used)} of the artwork used"
    ]
    doubts = []
    if report.guide_error > POOR:
        message = f"the guides of the painting are {percent(report.guide_error)} off the artwork's"
        doubts.append(
            doubt("stylise", "guides", message, "try an exemplar scene in light and materials like the target's")
        )
    return console.print_result(result, lines, doubts)


def exemplar(context: Context, args: argparse.Namespace, console: Console) -> tuple[Image, Guides]:
    """Returns the artwork, and the guides of the exemplar scene, rendered at the size of the artwork."""
    from . import files

    title = "rendering the exemplar"
    if args.artwork.startswith(files.DEMO):
        style = args.artwork.removeprefix(files.DEMO)
        if style not in ARTWORKS:
            raise usage(
                f"{args.artwork} is not generated input: there are {', '.join(files.DEMO + a for a in ARTWORKS)}"
            )
        source = guides(context, args.exemplar, args, console, args.size, None, title)
        return source.demo_artwork(style), source
    artwork = files.load_image(context, args.artwork)
    width, height, _ = artwork.size
    if max(width, height) > MAX_SIDE:
        raise usage(
            f"ARTWORK: {args.artwork} has {width} x {height} pixels; at most {MAX_SIDE} a side, so scale it down"
        )
    return artwork, guides(context, args.exemplar, args, console, (width, height), None, title)


def guides(
    context: Context,
    name: str,
    args: argparse.Namespace,
    console: Console,
    size: tuple[int, int],
    camera: Any,
    title: str,
) -> Guides:
    """Renders the guides of a scene."""
    from .. import Guides
    from . import files, picture

    scene = files.load_scene(context, name, args.units if name == args.target else None)
    index = 0
    if camera is not None:
        index = camera.index if camera.index is not None else scene.add_camera(**picture.camera_of(scene, camera))
    if index >= scene.counts.cameras:
        raise usage(f"--camera: {name} has no camera {index}, it has {scene.counts.cameras}")
    made = Guides(context, scene)
    return made.run(
        console.step(title), width=size[0], height=size[1], samples=args.samples, camera=index, seed=args.seed
    )


def settings(stylize: Stylize, args: argparse.Namespace, console: Console) -> dict[str, Any]:
    """Returns the settings of a preset, or of a plan for --time or --error."""
    from .. import Plan

    if args.time is None and args.error is None:
        return {"preset": args.preset, "seed": args.seed}
    goal = {"time_budget_ms": round(1000 * args.time)} if args.time else {"target_error": args.error}
    plan = Plan(stylize.context)
    plan.run_stylize(stylize, console.step("planning"), **goal)
    return {**plan.stylize_params, "seed": args.seed}
