"""Calculate illuminance in lux on a surface, or on a plane at the height of a desk.

Prints mean, minimum, maximum and the uniformity U0 = minimum / mean. Without --surface and --rect the plane lies above
the floor under the likeliest ceiling, 0.5 m off its walls."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import options, values
from .console import Console, doubt, percent
from .exits import Exit, usage

if TYPE_CHECKING:
    from ..illuminance import Illuminance
    from ..scene import Scene
    from .plane import Plane

SUMMARY = "illuminance in lux on a surface or a plane"

#: Paths per point in the first calculation (FIRST), and their maximum (MAX_PATHS).
FIRST, MAX_PATHS = 256, 65536
#: Minimum side, in pixels, of the square that shows a point (SQUARE), and the side that the picture should have.
SQUARE, PICTURE = 4, 640


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("scene", metavar="SCENE", help=options.SCENE)
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--surface", metavar="NAME", help="the front of this object or material, which must be planar")
    where.add_argument("--rect", type=values.rectangle, metavar="X0,Z0,X1,Z1", help="a level rectangle, in metres")
    parser.add_argument(
        "--height",
        type=values.length,
        metavar="LENGTH",
        help="height of the plane above the floor; default 0.75 m; with --rect it is y in the scene's coordinates",
    )
    parser.add_argument(
        "--spacing", type=values.above_zero, default=0.25, metavar="LENGTH", help="between points; default 0.25 m"
    )
    parser.add_argument(
        "--error",
        type=values.share,
        default=0.01,
        metavar="SHARE",
        help="standard error of the mean, relative to it; default 1%%",
    )
    parser.add_argument("--out", metavar="FILE.png", help="draw the values in false colours")
    parser.add_argument(
        "--csv", metavar="FILE.csv", help="write x, y, z in metres, lux and its standard error for each point"
    )
    parser.add_argument(
        "--sky", type=values.number(0, 1e9, "a luminance in cd/m²"), metavar="CD", help="add light from everywhere"
    )
    parser.add_argument(
        "--seed", type=values.whole(0, 2**32 - 1, "a seed"), default=1, metavar="N", help="seed of the paths"
    )
    options.add_units(parser)
    options.add_luminaires(parser)
    options.add_common(parser)


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Calculates and prints the illuminance."""
    from . import files

    began = time.monotonic()
    inputs = files.shared_input(args.scene)
    picture = files.check_file("--out", args.out, inputs, (".png",)) if args.out else None
    table = files.check_file("--csv", args.csv, inputs, (".csv",)) if args.csv else None
    scene = files.load_scene(files.context_of(args), args.scene, args.units, args.luminaires)
    if args.sky is not None:
        scene.set_environment((args.sky,) * 3)
    plane, warnings = plane_of(scene, args)
    found = measure(scene, plane, args.spacing, args.error, console, args.seed)

    if picture:
        draw(found, picture)
        console.wrote(picture)
    if table:
        files.write_text(table, rows(found, plane))
        console.wrote(table)
    report = found.report
    uniformity = report.minimum / report.mean if report.mean > 0 else float("nan")
    columns, rows_, _ = found.image("lux").size
    result = {
        "command": "lux",
        "on": plane.words,
        "points": report.points,
        "columns": columns,
        "rows": rows_,
        "mean_lux": report.mean,
        "mean_error_lux": report.mean_error,
        "minimum_lux": report.minimum,
        "maximum_lux": report.maximum,
        "uniformity": uniformity,
        "seconds": time.monotonic() - began,
    }
    lines = [
        f"{plane.words}: {report.points} points, {columns} x {rows_}",
        f"mean {report.mean:.4g} lux ± {2 * report.mean_error:.2g}, minimum {report.minimum:.4g}, "
        f"maximum {report.maximum:.4g}, U0 {uniformity:.2f}",
    ]
    return console.print_result(result, lines, files.scene_warnings(scene) + warnings + doubts(found, args.error))


def plane_of(scene: Scene, args: argparse.Namespace) -> tuple[Plane, list[dict[str, Any]]]:
    """Returns the plane that the options describe, with a warning if parts of it were guessed."""
    from . import files, plane

    if args.surface:
        if args.height is not None:
            raise usage("--height goes with a level plane, not with --surface")
        files.check_surface(scene, args.surface)
        return plane.on_surface(scene, args.surface), []
    if args.rect:
        if args.height is None:
            raise usage("--rect needs --height: y of the plane in the scene's coordinates")
        return plane.level(args.height, args.rect), []
    ceiling, warnings = files.likeliest_surface(scene, None)
    return plane.above_floor(scene, ceiling, plane.DESK if args.height is None else args.height), warnings


def measure(scene: Scene, plane: Plane, spacing: float, error: float, console: Console, seed: int = 1) -> Illuminance:
    """Calculates the illuminance. A first calculation predicts how many paths the wanted error of the mean needs."""
    from .. import Illuminance

    columns, rows = plane.points(spacing)
    found, samples = Illuminance(scene.context, scene), FIRST
    for title in ("measuring", "measuring exactly", "measuring exactly"):
        found.run_grid(plane.grid(), console.step(title), columns=columns, rows=rows, samples=samples, seed=seed)
        report = found.report
        if report.mean <= 0 or report.mean_error <= error * report.mean or samples >= MAX_PATHS:
            break
        # The error is inversely proportional to the square root of the number of paths. Trace 20 % more paths, because
        # the error of the first calculation is itself uncertain.
        samples = min(MAX_PATHS, int(1.2 * samples * (report.mean_error / (error * report.mean)) ** 2) + 16)
    return found


def doubts(found: Illuminance, error: float) -> list[dict[str, Any]]:
    """Returns reasons to doubt the figures."""
    report = found.report
    if report.mean <= 0:
        return [doubt("lux", "dark", "no light reaches the plane", "try another --height, or a scene with lamps")]
    if report.mean_error > 1.2 * error * report.mean:
        message = f"the mean is known to {percent(report.mean_error / report.mean)} instead of {percent(error)}"
        return [doubt("lux", "noise", message, "try a smaller --spacing")]
    return []


def draw(found: Illuminance, path: Path) -> None:
    """Draws the values in false colours with a scale; each point is a square."""
    import numpy as np

    from .. import false_colour

    values_ = found.image("lux").numpy()[:, :, 0]
    side = max(SQUARE, round(PICTURE / max(values_.shape)))
    large = np.repeat(np.repeat(np.nan_to_num(values_), side, axis=0), side, axis=1)
    false_colour(found.context, large, unit="illuminance").save(path)


def rows(found: Illuminance, plane: Plane) -> str:
    """Formats the points as CSV."""
    import numpy as np

    lux, error = (found.image(name).numpy()[:, :, 0] for name in ("lux", "error"))
    height, width = lux.shape
    origin, across, down = (np.array(v, float) for v in (plane.origin, plane.across, plane.down))
    lines = ["x_m,y_m,z_m,lux,standard_error_lux"]
    for row in range(height):
        for column in range(width):
            x, y, z = origin + across * (column + 0.5) / width + down * (row + 0.5) / height
            lines.append(f"{x:.4f},{y:.4f},{z:.4f},{lux[row, column]:.6g},{error[row, column]:.3g}")
    return "\n".join(lines) + "\n"
