"""List the contents of a scene, a picture or a luminaire file (.ies, .ldt, .xml, .gldf)."""

from __future__ import annotations

import argparse
import dataclasses
import math
from typing import TYPE_CHECKING, Any

from . import options, values
from .console import Console
from .exits import Exit, usage

if TYPE_CHECKING:
    from ..context import Context
    from ..design import UgrTable
    from ..scene import Scene

SUMMARY = "contents of a scene, a picture or a luminaire file"

#: Number of cameras, meshes and surfaces that are listed in words; JSON lists all.
LISTED = 8


def add(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("file", metavar="FILE", help=f"{options.SCENE}; {options.IMAGE}; or a luminaire, {options.LUMINAIRE}")
    options.add_units(parser)
    parser.add_argument(
        "--ugr-table",
        action="store_true",
        help="print the table of the unified glare rating of a luminaire in the 19 standard rooms of CIE 190",
    )
    parser.add_argument(
        "--spacing",
        type=values.one_over,
        default=0.25,
        metavar="S",
        help="of --ugr-table: distance of the luminaires over their height above the eyes; default 0.25",
    )
    options.add_common(parser)


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Prints what the file contains."""
    from . import files
    from ..photometry import LUMINAIRES, luminaire_path

    context = files.context_of(args)
    is_luminaire = luminaire_path(args.file).suffix.lower() in LUMINAIRES
    if args.ugr_table and not is_luminaire:
        raise usage(f"--ugr-table: {args.file} is no luminaire; its name must end in {', '.join(LUMINAIRES)}")
    if files.is_scene(args.file):
        scene = files.load_scene(context, args.file, args.units)
        result = of_scene(scene)
        return console.print_result({"command": "inspect", **result}, scene_words(result), files.scene_warnings(scene))
    if is_luminaire:
        result = of_luminaire(context, args.file)
        words = luminaire_words(result)
        if args.ugr_table:
            table = table_of(context, args.file, args.spacing)
            result["ugr_table"] = table_values(table)
            words += ["", *table.lines(corrected=False), "", *table.lines()]
        return console.print_result({"command": "inspect", **result}, words)
    result = of_image(context, args.file)
    return console.print_result({"command": "inspect", **result}, image_words(result))


def of_scene(scene: Scene) -> dict[str, Any]:
    """Returns the contents of a scene."""
    import numpy as np

    counts = scene.counts
    meshes, low, high = [], np.full(3, np.inf), np.full(3, -np.inf)
    for index in range(counts.meshes):
        positions = scene.mesh_arrays(index)["positions"]
        if len(positions):
            low, high = np.minimum(low, positions.min(0)), np.maximum(high, positions.max(0))
        info = scene.mesh(index)
        meshes.append({"name": scene.mesh_name(index), "triangles": info.triangle_count, "material": info.material})
    emitters = [i for i in range(counts.materials) if max(scene.material(i)["emission"]) > 0]
    candidates = scene.candidates
    return {
        "kind": "scene",
        **dataclasses.asdict(counts),
        "low_m": low if counts.triangles else None,
        "high_m": high if counts.triangles else None,
        "origin_m": scene.origin,
        "emitting_materials": len(emitters),
        "camera_list": [scene.camera(i) for i in range(counts.cameras)],
        "mesh_list": meshes,
        "likeliest_ceiling": candidates[0].name if candidates else None,
        "renderer": scene.requirements_text().splitlines(),
    }


def scene_words(found: dict[str, Any]) -> list[str]:
    """Describes a scene in lines."""
    lines = [
        f"scene: {found['triangles']} triangles in {found['meshes']} meshes, {found['materials']} materials, "
        f"{found['textures']} textures"
    ]
    if found["low_m"] is not None:
        size = found["high_m"] - found["low_m"]
        lines.append(
            f"size {size[0]:.2f} x {size[1]:.2f} x {size[2]:.2f} m (x, y up, z), "
            f"from {point(found['low_m'])} to {point(found['high_m'])}"
        )
    lines.append(
        f"light: {found['lights']} punctual lights and luminaires, {found['emitting_materials']} emitting materials"
    )
    for index, camera in enumerate(found["camera_list"][:LISTED]):
        degrees = math.degrees(camera["fov_y"])
        lines.append(f"camera {index}: {point(camera['position'])}/{point(camera['target'])}/{degrees:.4g}")
    if not found["camera_list"]:
        lines.append("no camera: give --camera POSITION/TARGET to render it")
    if found["likeliest_ceiling"]:
        lines.append(f'likeliest ceiling: "{found["likeliest_ceiling"]}" (`luxfer surfaces` lists all)')
    largest = sorted(found["mesh_list"], key=lambda mesh: -mesh["triangles"])[:LISTED]
    lines.append(
        "largest meshes: " + ", ".join(f"{mesh['name'] or '(no name)'} ({mesh['triangles']})" for mesh in largest)
    )
    return lines


def point(values: Any) -> str:
    """Formats a point as --camera expects it."""
    return ",".join(f"{round(float(v), 3) + 0.0:g}" for v in values)


def of_image(context: Context, name: str) -> dict[str, Any]:
    """Returns the contents of a picture."""
    import numpy as np

    from . import files

    image = files.load_image(context, name)
    width, height, channels = image.size
    pixels = image.numpy()
    finite = pixels[np.isfinite(pixels)]
    return {
        "kind": "image",
        "width": width,
        "height": height,
        "channels": channels,
        "minimum": float(finite.min()) if finite.size else None,
        "mean": float(finite.mean()) if finite.size else None,
        "maximum": float(finite.max()) if finite.size else None,
        "not_finite": int(pixels.size - finite.size),
        "clipped_share": float((pixels[:, :, :3].max(axis=2) >= 1).mean()),
        "metadata": dataclasses.asdict(image.metadata),
    }


def image_words(found: dict[str, Any]) -> list[str]:
    """Describes a picture in lines."""
    data = found["metadata"]
    colours = {
        "none": "generated",
        "assumed": "not stated, taken as sRGB",
        "stated": "as stated",
        "converted": "converted to Rec.709",
        "unconverted": "in a colour space that cannot be converted: export it as sRGB",
        "data": "taken as data",
    }
    lines = [
        f"picture: {found['width']} x {found['height']}, {found['channels']} channels; colours "
        f"{colours.get(data['colour'].name.lower(), data['colour'].name.lower())}",
    ]
    if found["mean"] is not None:
        lines.append(
            f"linear values from {found['minimum']:.4g} to {found['maximum']:.4g}, mean {found['mean']:.4g}; "
            f"{100 * found['clipped_share']:.1f} % of the pixels are 1 or more"
        )
    if data["focal"] > 0:
        degrees = 2 * math.degrees(math.atan(found["height"] / 2 / data["focal"]))
        lines.append(f"focal length {data['focal']:.0f} pixels ± {data['focal_error']:.0f}: {degrees:.0f}° high")
    if data["white_luminance"] > 0:
        lines.append(
            f"white is {data['white_luminance']:.0f} cd/m² by its exposure, {data['white_luminance_low']:.0f} to "
            f"{data['white_luminance_high']:.0f} (--white of `luxfer transfer`)"
        )
    return lines


def of_luminaire(context: Context, name: str) -> dict[str, Any]:
    """Returns the contents of a luminaire file."""
    from .. import Distribution
    from ..errors import Error
    from .exits import unreadable

    try:
        luminaire = Distribution.load(context, name)
    except Error as error:
        raise unreadable(name, error) from None
    report = luminaire.report
    down = luminaire.intensity(0, 0)
    directions = ((c, gamma) for c in range(0, 360, 15) for gamma in range(0, 181, 5))
    peak = max(((luminaire.intensity(c, gamma), c, gamma) for c, gamma in directions), key=lambda found: found[0])
    return {
        "kind": "luminaire",
        "name": luminaire.name,
        "variant_names": variants_of(context, name, report.variants),
        **dataclasses.asdict(report),
        "intensity_down_cd": down,
        "peak_cd": peak[0],
        "peak_c_degrees": peak[1],
        "peak_gamma_degrees": peak[2],
        "lm_per_watt": report.flux / report.watts if report.watts > 0 else None,
    }


def table_of(context: Context, name: str, spacing: float) -> UgrTable:
    """Computes the UGR table of a luminaire file."""
    from .. import Distribution
    from ..design import ugr_table
    from .exits import unreadable

    try:
        with Distribution.load(context, name) as luminaire:
            return ugr_table(luminaire, spacing)
    except ValueError as error:  # the luminaire has no table
        raise unreadable(name, error) from None


def table_values(table: UgrTable) -> dict[str, Any]:
    """Returns a UGR table for JSON; its values are those corrected to the lamp flux."""
    from ..design.glare_table import REFLECTANCES, ROOMS, VIEWS

    return {
        "spacing": table.spacing,
        "lamp_flux_lm": table.lamp_flux,
        "length_along_c": table.length_along,
        "rooms_h": ROOMS,
        "reflectances": REFLECTANCES,
        **{view: table.corrected[:, :, index] for index, view in enumerate(VIEWS)},
        **{f"uncorrected_{view}": table.uncorrected[:, :, index] for index, view in enumerate(VIEWS)},
    }


def variants_of(context: Context, name: str, count: int) -> list[str | None]:
    """Returns the names of the variants in a GLDF file; None for variants that cannot be read."""
    from .. import Distribution
    from ..errors import Error
    from ..photometry import luminaire_path

    names: list[str | None] = []
    for index in range(count if count > 1 else 0):
        try:
            with Distribution.load(context, luminaire_path(name), index) as variant:
                names.append(variant.name)
        except Error:
            names.append(None)
    return names


def luminaire_words(found: dict[str, Any]) -> list[str]:
    """Describes a luminaire in lines."""
    power = f", {found['watts']:g} W, {found['lm_per_watt']:.0f} lm/W" if found["lm_per_watt"] else ""
    size = " x ".join(f"{abs(side):.3g}" for side in found["size"])
    lines = [
        f"luminaire: {found['name'] or '(no name)'}",
        f"{found['flux']:.0f} lm{power}; lamps {found['lamp_flux']:.0f} lm"
        if found["lamp_flux"]
        else f"{found['flux']:.0f} lm{power}",
        f"{found['planes']} planes of {found['angles']} angles; luminous opening {size} m",
        f"{found['intensity_down_cd']:.0f} cd straight down, {found['peak_cd']:.0f} cd at C "
        f"{found['peak_c_degrees']}, gamma {found['peak_gamma_degrees']} degrees",
    ]
    if found["temperature"] or found["rendering"]:
        colours = [f"{found['temperature']:.0f} K"] if found["temperature"] else []
        colours += [f"Ra {found['rendering']:.0f}"] if found["rendering"] else []
        lines.append(f"lamps: {', '.join(colours)}")
    if found["variant_names"]:
        lines.append(f"{found['variants']} variants, chosen by #INDEX, #ID or #NAME after the file's name:")
        for index, name in enumerate(found["variant_names"][:LISTED]):
            lines.append(f"  #{index} {name if name is not None else '(cannot be read)'}")
    return lines
