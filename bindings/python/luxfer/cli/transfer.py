"""Light a scene as in a photo.

Strokes show where the plane with the lights and its lamps are: a drawing of the photo's size (green: plane, red: not
plane, yellow: lamp, blue: not lamp), or a text file with lines such as `light 3 310.5 30 320 31` (plane, not-plane,
light or not-light, radius, points). Without strokes both masks are proposed; look at them with --preview-masks.

Writes into --out, each as soon as it is finished: masks.png (the photo with its masks), emission.exr (the emissive
texture), lit.glb (the scene in its new light), luminaires.csv (every lamp in metres, cd/m² and lumens), render.exr
(cd/m²), render.png and report.json."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import bracket, options, values
from .console import Console, as_json, described_stages, percent
from .exits import Exit, usage

if TYPE_CHECKING:
    from ..context import Context
    from ..transfer import Transfer

SUMMARY = "light a scene as in a photo"

FILES = ("masks.png", "emission.exr", "lit.glb", "luminaires.csv", "render.exr", "render.png", "report.json")

#: Longest side of the texture in texels for each --quality.
TEXELS = {"draft": 1024, "good": 2048, "best": 4096}
#: Default luminance of the photo's white in cd/m²: the default of the library.
WHITE = 100.0


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("photo", metavar="PHOTO", help=f"{options.IMAGE}, or demo:photo")
    parser.add_argument("scene", metavar="SCENE", help=options.SCENE)
    bracket.add(parser)
    parser.add_argument("--strokes", metavar="FILE", help="a drawing, a text (.txt), or demo:strokes")
    parser.add_argument(
        "--surface", metavar="NAME", help="object or material that receives the lights; default: the likeliest ceiling"
    )
    parser.add_argument("--out", metavar="FOLDER", help="folder for the files; it is made if it is missing")
    parser.add_argument(
        "--preview-masks",
        metavar="FILE.png",
        help="only draw the photo with its masks and the place where one more stroke helps most",
    )
    options.add_camera(parser)
    options.add_units(parser)
    add_light(parser)
    options.add_quality(parser)
    options.add_common(parser)


def add_light(parser: argparse.ArgumentParser) -> None:
    """Adds the options of the new light."""
    group = parser.add_argument_group("light")
    group.add_argument(
        "--lux",
        type=values.number(0.1, 1e6, "a mean illuminance in lux"),
        help="dim all lamps together, so that a plane of desks has this mean illuminance: 0.75 m above the floor, "
        "0.5 m off the walls",
    )
    group.add_argument(
        "--colour",
        "--color",
        type=values.colour,
        metavar="COLOUR",
        help="colour of the lamps together, in place of the photo's: "
        "4000K, #RRGGBB (sRGB) or linear R,G,B; their luminous flux stays",
    )
    options.add_white(
        group, f"luminance of the photo's white in cd/m²; default {WHITE:g}; the light is proportional to it"
    )
    group.add_argument(
        "--distance",
        type=values.above_zero,
        metavar="LENGTH",
        help="from the photo's camera to the plane of its lamps, which sets "
        "the size of the pattern; default: by the size of the lamps",
    )


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Runs the stages and writes their results."""
    from . import files, masks

    if not args.out and not args.preview_masks:
        raise usage("--out is missing: nothing would be written; give --out FOLDER, or --preview-masks FILE.png")
    if args.out and args.preview_masks:
        raise usage("--preview-masks only draws the masks: leave --out out")
    inputs = files.shared_input(args.photo, args.scene, args.strokes, *(args.exposures or ()))
    out = files.check_folder("--out", args.out, inputs, FILES) if args.out else None
    preview = (
        files.check_file("--preview-masks", args.preview_masks, inputs, (".png",)) if args.preview_masks else None
    )

    context = files.context_of(args)
    transfer, start = prepare(context, args)
    transfer.run(last="lights", progress=console.step("finding plane and lamps"), **start.settings)
    masks_found = masks.Masks.of(transfer, start.photo, start.strokes)
    if preview:
        masks_found.draw().save(preview)
        console.wrote(preview)
        merged = {"bracket": bracket.facts(start.merge)} if start.merge else {}
        result = {"command": "transfer", "surface": start.surface, **masks_found.facts(), **merged}
        words = [*masks_found.words(), *([bracket.words(start.merge)] if start.merge else [])]
        return console.print_result(result, words, start.warnings + described_stages(transfer.warnings))
    assert out is not None
    out.mkdir(parents=True, exist_ok=True)
    masks_found.draw().save(out / "masks.png")
    console.wrote(out / "masks.png")
    return light(args, console, transfer, start, out, masks_found.facts())


class Start:
    """The input of a transfer."""

    def __init__(self, context: Context, args: argparse.Namespace) -> None:
        from . import files

        self.photo, self.merge = bracket.load(context, args.photo, args.exposures)
        self.scene = files.load_scene(context, args.scene, args.units)
        self.strokes = files.load_strokes(context, args.strokes, self.photo) if args.strokes else None
        self.surface, self.warnings = files.likeliest_surface(self.scene, args.surface)
        self.warnings = files.scene_warnings(self.scene) + self.warnings
        self.warnings += bracket.doubts(self.merge) if self.merge else []
        self.white = args.white or WHITE
        self.settings: dict[str, Any] = {
            "max_texels": TEXELS.get(args.quality if args.time is None and args.error is None else "good", 2048),
            "plane_distance": args.distance or 0.0,
            "white_luminance": self.white,
        }


def prepare(context: Context, args: argparse.Namespace) -> tuple[Transfer, Start]:
    """Creates a transfer with its inputs; no stage has run yet."""
    from .. import Transfer
    from . import picture

    start = Start(context, args)
    transfer = Transfer(context, start.photo, start.scene, start.surface)
    if start.strokes is not None:
        transfer.set_strokes(start.strokes)
    if args.camera is not None:
        transfer.set_camera(picture.camera_of(start.scene, args.camera))
    return transfer, start


def light(
    args: argparse.Namespace, console: Console, transfer: Transfer, start: Start, out: Path, masks: dict[str, Any]
) -> Exit:
    """Runs the stages from the texture on and writes their results."""
    from . import picture, target

    transfer.run(first="unwarp", last="emission", progress=console.step("making the texture"), **start.settings)
    transfer.image("emission").save(out / "emission.exr")
    console.wrote(out / "emission.exr")

    goal = picture.Goal.of(args)
    settings = solve(args, console, transfer, start, goal)
    lit = target.Lit.of(transfer, start.white)
    if args.colour is not None:
        lit.recolour(args.colour)
    if args.lux is not None:
        lit.dim_to(args.lux, start.surface, console)
    lit.scene.export(out / "lit.glb")
    console.wrote(out / "lit.glb")
    lit.save_lamps(out / "luminaires.csv")
    console.wrote(out / "luminaires.csv")

    warnings = start.warnings + described_stages(transfer.warnings)
    result = facts(transfer, start, lit, masks)
    if goal.is_budget:  # the rest of the time, after --lux too
        left = goal.seconds - (time.monotonic() - console.began)
        settings["time_budget_ms"] = max(200, round(1000 * left))
    found = render(args, console, lit, settings, goal)
    for name in ("render.exr", "render.png"):
        found.save(out / name, lit.white)
        console.wrote(out / name)
    result["picture"] = {"width": args.size[0], "height": args.size[1], "white_cd_m2": lit.white, **found.facts()}
    result["seconds"] = time.monotonic() - console.began
    warnings += found.doubts()
    console.wrote(out / "report.json")
    write_report(out / "report.json", {**result, "files": console.files, "warnings": warnings})
    return console.print_result(result, words(transfer, start, lit) + [found.words()], warnings)


def solve(args: argparse.Namespace, console: Console, transfer: Transfer, start: Start, goal: Any) -> dict[str, Any]:
    """Plans relighting and rendering, and relights; returns the settings of the rendering."""
    from .. import Plan
    from . import picture

    settings = {**start.settings, "render": picture.base_settings(args)}
    passed = time.monotonic() - console.began
    plan = Plan(transfer.context)
    plan.run_transfer(transfer, console.step("planning"), settings=settings, **goal.for_plan(passed))
    transfer.run(
        first="relight",
        last="relight",
        progress=console.step("solving for the light"),
        **{**start.settings, "relight": plan.relight_params},
    )
    found: dict[str, Any] = goal.settings(plan.render_params, args)
    return found


def render(args: argparse.Namespace, console: Console, lit: Any, settings: dict[str, Any], goal: Any) -> Any:
    """Renders the lit scene."""
    from .. import Render
    from . import picture

    job = Render(lit.scene.context, lit.scene)
    if args.camera is not None:
        job.set_camera(picture.camera_of(lit.scene, args.camera))
    return picture.run(job, settings, goal, console)


def facts(transfer: Transfer, start: Start, lit: Any, masks: dict[str, Any]) -> dict[str, Any]:
    """Returns the results in the form in which JSON shows them."""
    report = transfer.report
    return {
        "command": "transfer",
        "surface": start.surface,
        "masks": {key: value for key, value in masks.items() if key != "next_stroke"},
        **({"bracket": bracket.facts(start.merge)} if start.merge else {}),
        "plane_distance_m": report.plane_distance,
        "plane_distance_error": report.plane_distance_error,
        "texture_error": report.emission_error,
        "texel_m": report.texel_size,
        "strength_error": report.relight_error,
        "proposed_white_cd_m2": [report.proposed_white_low, report.proposed_white, report.proposed_white_high],
        **lit.facts(),
    }


def words(transfer: Transfer, start: Start, lit: Any) -> list[str]:
    """Describes the results in lines."""
    report = transfer.report
    distance = f"the photo's camera {report.plane_distance:.2f} m from the plane"
    if report.plane_distance_error > 0:
        distance += f" (estimated, ± {percent(report.plane_distance_error)}; --distance sets it)"
    return [
        *([bracket.words(start.merge)] if start.merge else []),
        f'surface "{start.surface}", {distance}',
        f"texture off the photo's lamps by {percent(report.emission_error)}; "
        f"strength known to {percent(report.relight_error)}",
        *lit.words(),
    ]


def write_report(path: Path, result: dict[str, Any]) -> None:
    """Writes report.json, the same object as --json prints."""
    from . import files

    files.write_text(path, as_json(result) + "\n")
