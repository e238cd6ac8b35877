"""Print a picture as a sheet to paint on, and read a photo of the painted sheet.

`luxfer sheet print SOURCE --out sheet.png` draws the exemplar pale, between marks: print it without scaling, and paint
over it. `luxfer sheet read PHOTO --out artwork.png` aligns a photo or scan of it; `luxfer stylise artwork.png` then
paints with it. Give both the same --paper, --dpi and --size."""

from __future__ import annotations

import argparse
import re
from typing import Any

from . import options, values
from .console import Console, doubt
from .exits import Exit, usage

SUMMARY = "print a sheet to paint on, read a photo of it"

#: Width and height of papers in landscape format, in millimetres.
PAPERS = {"a5": (210.0, 148.0), "a4": (297.0, 210.0), "a3": (420.0, 297.0), "letter": (279.4, 215.9)}
#: A warning says that the alignment is not exact if its stated error is more than this, in pixels of the picture.
UNEVEN = 0.5


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parts = parser.add_subparsers(
        dest="part",
        metavar="print|read",
        required=True,
        parser_class=type(parser),
        help="print the sheet, or read a photo of it",
    )
    for name, text in (("print", "draw a sheet"), ("read", "align a photo of a painted sheet")):
        own = parts.add_parser(name, help=text, description=f"{text.capitalize()}.")
        what = f"what to paint: {options.SCENE}; or {options.IMAGE}" if name == "print" else options.IMAGE
        own.add_argument("source", metavar="SOURCE" if name == "print" else "PHOTO", help=what)
        own.add_argument("--out", metavar="FILE.png", help="the sheet, or the artwork")
        own.add_argument(
            "--paper", type=paper, default=PAPERS["a4"], metavar="PAPER", help="a5, a4, a3, letter, or WxH in mm"
        )
        own.add_argument("--dpi", type=values.number(20, 1200, "dots per inch"), default=300.0, help="default 300")
        own.add_argument(
            "--size", type=values.size, default=(640, 480), metavar="WxH", help="of the picture; default 640x480"
        )
        if name == "print":
            own.add_argument(
                "--contrast", type=values.number(0, 1, "a contrast"), default=0.25, help="of the picture; default 0.25"
            )
            options.add_white(own, "luminance of a scene that is shown as paper white; default: by the picture")
            own.add_argument(
                "--samples", type=values.whole(1, 65536, "paths per pixel"), default=64, help="of a scene; default 64"
            )
            options.add_units(own)
        options.add_common(own)
        own.set_defaults(parser=own)


def paper(text: str) -> tuple[float, float]:
    """Parses the name of a paper size, or WxH in millimetres."""
    if text.lower() in PAPERS:
        return PAPERS[text.lower()]
    match = re.fullmatch(r"([\d.]+)x([\d.]+)", text)
    sides = [values.real(side) or 0 for side in match.groups()] if match else [0]
    if not all(60 <= side <= 2000 for side in sides):
        raise values.wrong(text, f"a paper: {', '.join(PAPERS)}, or WxH in mm, each in [60, 2000]")
    return sides[0], sides[1]


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Draws or reads a sheet."""
    from . import files

    if not args.out:
        raise usage("--out is missing: nothing would be written; give --out FILE.png")
    args.out = files.check_file("--out", args.out, files.shared_input(args.source), (".png",))
    return draw(args, console) if args.part == "print" else read(args, console)


def settings(args: argparse.Namespace) -> dict[str, Any]:
    """Returns the settings that must be equal for printing and reading."""
    return {"paper_width": args.paper[0], "paper_height": args.paper[1], "dpi": args.dpi}


def draw(args: argparse.Namespace, console: Console) -> Exit:
    """Draws the sheet."""
    from .. import Render, print_sheet
    from . import files, picture

    context = files.context_of(args)
    width, height = args.size
    if files.is_scene(args.source):
        scene = files.load_scene(context, args.source, args.units)
        render = Render(context, scene)
        render.set_camera(picture.camera_of(scene, None))
        found = picture.run(
            render,
            {"width": width, "height": height, "samples": args.samples, "preview": picture.FILTER},
            picture.Goal(),
            console,
        )
        image = found.shown.numpy() / (args.white or picture.automatic_white(found))
    else:
        image = files.load_image(context, args.source).numpy()
        height, width, _ = image.shape
    sheet = print_sheet(context, image, contrast=args.contrast, **settings(args))
    sheet.save(args.out)
    console.wrote(args.out)
    pixels = sheet.size[:2]
    result = {
        "command": "sheet",
        "width": pixels[0],
        "height": pixels[1],
        "picture": [width, height],
        **settings(args),
    }
    lines = [
        f"{pixels[0]} x {pixels[1]} pixels: print it at {args.dpi:g} dpi, without scaling, "
        f"on {args.paper[0]:g} x {args.paper[1]:g} mm",
        f"read it with --size {width}x{height}",
    ]
    return console.print_result(result, lines)


def read(args: argparse.Namespace, console: Console) -> Exit:
    """Aligns the photo of a sheet."""
    from .. import align_sheet
    from . import files

    context = files.context_of(args)
    artwork, report = align_sheet(context, files.load_image(context, args.source), *args.size, **settings(args))
    artwork.save(args.out)
    console.wrote(args.out)
    result = {
        "command": "sheet",
        "width": args.size[0],
        "height": args.size[1],
        "marks": report.marks,
        "error_pixels": report.error,
        "residual_pixels": report.residual,
        "dots": report.dots,
        "bend_pixels": report.bend,
    }
    doubts = []
    if report.error > UNEVEN:
        message = (
            f"the alignment may be {1.96 * report.error:.1f} pixels wrong: the paper has waves or creases, or marks "
            "are covered"
        )
        doubts.append(doubt("sheet", "uneven", message, "try a scanner, or flatten the paper"))
    return console.print_result(result, [f"{report.marks} of 10 marks; aligned within {report.error:.2f} pixels"], doubts)
