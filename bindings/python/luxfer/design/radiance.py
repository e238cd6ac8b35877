"""A design as files of Radiance, and its recomputation from these files by Radiance as a second opinion.

`export` writes the room with matte surfaces, the luminaires by their IES files, and the points of all areas.
`recompute` runs Radiance's ies2rad, oconv and rtrace on the folder, which come with `pip install luxfer[radiance]` or
with an installed Radiance, and compares: a requirement is confirmed if both programs reach the same decision.

Not exported: mirror images of glossy surfaces, textures (their mean colour stands for them), light of the surroundings.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..photometry import Distribution
from . import fingerprint
from .areas import horizontal
from .check import Finding
from .measure import Field, modelling
from .reflectance import is_glossy, reflectance

if TYPE_CHECKING:
    from ..scene import Scene
    from .areas import Area
    from .check import Checked
    from .luminaires import Luminaire
    from .project import Project

#: Lumens per watt by which Radiance's units become photometric. [convention: Radiance, WHTEFFICACY]
EFFICACY = 179.0
#: Luminance of linear Rec.709 channels. [convention: BT.709]
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
#: Settings of rtrace: rays at each reflection, which end at random so that no light is lost, no interpolation between
#: points, subdivided luminaires, and a shadow ray to each luminaire, however weak. By default Radiance guesses the
#: light of luminaires that it takes for weak, which makes the means of an office floor up to 3 % too small.
#: [convention]
RTRACE = tuple("-ab 30 -aa 0 -ad 512 -as 0 -lr -30 -lw 1e-3 -ds 0.05 -dj 0 -dc 1 -dt 0".split())
#: Quantities of requirements that are recomputed.
RECOMPUTED = ("mean", "uniformity", "minimum", "diversity", "modelling")
#: Name of the file that lists what the folder holds.
INDEX = "index.json"
#: Name of the file of the compiled design, which `recompute` makes where it is missing.
OCTREE = "design.oct"


@dataclass(frozen=True)
class Second:
    """A requirement and the result of Radiance."""

    finding: Finding
    """The finding of luxfer."""
    value: float
    """The number by Radiance."""

    @property
    def difference(self) -> float:
        """Radiance's number over luxfer's, less 1."""
        return self.value / self.finding.value - 1 if self.finding.value else math.nan

    @property
    def holds(self) -> bool:
        """Whether the requirement holds by Radiance's number."""
        r = self.finding.requirement
        return self.value >= r.limit if r.is_minimum else self.value <= r.limit

    @property
    def confirms(self) -> bool:
        """Whether Radiance decides the requirement as luxfer does; never if luxfer has not decided it."""
        return self.finding.outcome == ("passes" if self.holds else "fails")

    def __str__(self) -> str:
        f = self.finding
        unit = f" {f.requirement.unit}" if f.requirement.unit else ""
        word = (
            "confirmed" if self.confirms else f"{f.outcome} by luxfer, {'holds' if self.holds else 'fails'} by Radiance"
        )
        change = f" ({100 * self.difference:+.1f} %)" if math.isfinite(self.difference) else ""
        return f"{f.requirement}: {f.value:.4g} and {self.value:.4g}{unit}{change}, {word}"


def export(project: Project, folder: str | os.PathLike[str]) -> Path:
    """Writes a design into a folder: room.rad, the IES file of each product, a file of points for each area, and
    index.json, which lists them with the luminaires. Returns the folder."""
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    notes = [f"light of material {i} is left out" for i in _emitting(project.room.scene)]
    notes += [f"material {i} is matte here, but mirrors in the scene" for i in _glossy(project.room.scene)]
    (place / "room.rad").write_text(_room(project.room.scene))
    (place / OCTREE).unlink(missing_ok=True)
    lamps = [_lamp(place, project, lamp) for lamp in project.luminaires if lamp.flux > 0]
    files = {}
    for number, area in enumerate(project.areas, 1):
        for kind, one in _grids(area):
            name = f"area{number}{kind}.pts"
            (place / name).write_text(_points(one))
            files[f"{area.name}{kind}"] = name
    made_of = fingerprint.digest(project.record())
    listed = {"design": made_of, "room": "room.rad", "luminaires": lamps, "areas": files, "notes": notes}
    (place / INDEX).write_text(json.dumps(listed, indent=1) + "\n")
    return place


def recompute(
    project: Project, checked: Checked, folder: str | os.PathLike[str], settings: Sequence[str] = RTRACE
) -> list[Second]:
    """Recomputes the illuminance requirements of a check by Radiance from the files that `export` wrote into the
    folder; `settings` are the settings of rtrace."""
    place = Path(folder)
    listed = json.loads((place / INDEX).read_text())
    if listed.get("design") != fingerprint.digest(project.record()):
        raise ValueError(
            f"the files in {place} are those of another design, or of this one before a change: export it anew"
        )
    if not (place / OCTREE).exists():
        _compile(place, listed)
    names = {a.name: a for a in project.areas}
    factor, known, out = checked.settings.maintenance, {}, []
    for finding in checked.findings:
        r = finding.requirement
        if r.quantity not in RECOMPUTED:
            continue
        for kind, area in _grids(names[r.area]):
            key = r.area + kind
            if key not in known:
                values = _traced(place / listed["areas"][key], settings)
                known[key] = _field(area, values * factor)
        out.append(Second(finding, _value(r.quantity, known[r.area], known.get(f"{r.area}-up"))))
    return out


def _value(quantity: str, field: Field, up: Field | None) -> float:
    """The number that a requirement limits."""
    if quantity == "modelling" and up is not None:
        return modelling(field, up)[0].value
    if quantity == "mean":
        return field.mean.value
    if quantity == "uniformity":
        return field.uniformity.value
    return field.extremes.smallest if quantity == "minimum" else field.extremes.diversity


def _grids(area: Area) -> list[tuple[str, Area]]:
    """The grids of an area by the ends of their names: cylindrical areas also have a grid on the horizontal plane."""
    return [("", area), ("-up", horizontal(area))] if area.kind == "cylindrical" else [("", area)]


def _field(area: Area, values: NDArray[np.float64]) -> Field:
    """Illuminance without errors; of cylindrical areas the mean over the planes."""
    if area.kind == "cylindrical":
        values = values.reshape(len(area.patches), -1).mean(axis=0)
    return Field(area, values, np.zeros(len(values)))


def _upright(points: Any) -> NDArray[np.float64]:
    """Points or directions with z up, as Radiance's programs expect them."""
    p = np.asarray(points, float)
    return np.stack([p[..., 0], -p[..., 2], p[..., 1]], axis=-1)


def _points(area: Area) -> str:
    """Positions and directions of an area's points, one a line."""
    lines = []
    for patch in area.patches:
        n = " ".join(f"{v:.9g}" for v in _upright(patch.normal))
        lines += [" ".join(f"{v:.9g}" for v in p) + f" {n}" for p in _upright(patch.points[patch.keep])]
    return "\n".join(lines) + "\n"


def _emitting(scene: Scene) -> list[int]:
    return [i for i in range(scene.counts.materials) if any(scene.material(i)["emission"])]


def _glossy(scene: Scene) -> list[int]:
    return [i for i in range(scene.counts.materials) if is_glossy(scene, i)]


def _room(scene: Scene) -> str:
    """Materials and triangles."""
    parts = ["# Room of a lighting design, in metres, z up"]
    for index in range(scene.counts.materials):
        r, g, b = reflectance(scene, index)
        through = float(scene.material(index)["transmission"]) * (1 - float(scene.material(index)["metallic"]))
        if through > 0:
            parts.append(
                f"void trans m{index} 0 0 7 {r + through:.6g} {g + through:.6g} {b + through:.6g} 0 0 {through:.6g} 1"
            )
        else:
            parts.append(f"void plastic m{index} 0 0 5 {r:.6g} {g:.6g} {b:.6g} 0 0")
    for mesh in range(scene.counts.meshes):
        arrays, material = scene.mesh_arrays(mesh), scene.mesh(mesh).material
        corners = _upright(arrays["positions"])[arrays["indices"]]
        sizes = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        for number, corner in enumerate(corners[sizes > 1e-12]):
            numbers = " ".join(f"{v:.9g}" for v in corner.reshape(-1))
            parts.append(f"m{material} polygon o{mesh}.{number} 0 0 9 {numbers}")
    return "\n".join(parts) + "\n"


def _lamp(place: Path, project: Project, lamp: Luminaire) -> dict[str, Any]:
    """Writes the photometry of a luminaire; returns its place, and the factor from the file's flux to its own."""
    name = f"{lamp.product.hash}.ies"
    with Distribution.load_memory(project.room.scene.context, lamp.product.photometry, lamp.product.format) as found:
        factor = lamp.flux / found.report.flux
        if not (place / name).exists():
            if lamp.product.format == "ies":
                (place / name).write_bytes(lamp.product.photometry)
            else:
                found.save(place / name)
    colour = np.asarray(lamp.colour, float)
    return {
        "product": lamp.product.name,
        "photometry": name,
        "factor": factor,
        "colour": (colour / (LUMINANCE @ colour)).tolist(),
        "turns": _turns(lamp),
        "position": _upright(lamp.position).tolist(),
    }


def _turns(lamp: Luminaire) -> list[float]:
    """Angles in degrees about x, y and z, in this order, that turn a luminaire which shines along -z, with C = 0 along
    x, to its place."""
    up, first = -_upright(lamp.axis), _upright(lamp.c0)
    up = up / np.linalg.norm(up)
    first = first - (first @ up) * up
    first = first / np.linalg.norm(first)
    m = np.stack([first, np.cross(up, first), up], axis=1)
    y = math.asin(max(-1.0, min(1.0, -m[2, 0])))
    if abs(m[2, 0]) > 1 - 1e-9:  # x points up or down: one angle is free  [rounding]
        x, z = math.atan2(-m[1, 2], m[1, 1]), 0.0
    else:
        x, z = math.atan2(m[2, 1], m[2, 2]), math.atan2(m[1, 0], m[0, 0])
    return [math.degrees(v) for v in (x, y, z)]


def _compile(place: Path, listed: dict[str, Any]) -> None:
    """Compiles the room with its luminaires into one file that holds all of them, so that no text is read again."""
    parts = [(place / listed["room"]).read_text()]
    made: dict[tuple, str] = {}
    for lamp in listed["luminaires"]:
        key = (lamp["photometry"], lamp["factor"], *lamp["colour"])
        if key not in made:
            made[key] = f"lamp{len(made) + 1}"
            colour = [f"{v:.9g}" for v in lamp["colour"]]
            words = ["-c", *colour, "-m", f"{lamp['factor']:.9g}", "-o", made[key], lamp["photometry"]]
            _run("ies2rad", words, place)
        x, y, z = (f"{v:.9g}" for v in lamp["turns"])
        to = " ".join(f"{v:.9g}" for v in lamp["position"])
        parts.append(f"!xform -rx {x} -ry {y} -rz {z} -t {to} {made[key]}.rad")
    (place / "design.rad").write_text("\n".join(parts) + "\n")
    (place / OCTREE).write_bytes(_run("oconv", ["-f", "design.rad"], place))


def _traced(points: Path, settings: Sequence[str]) -> NDArray[np.float64]:
    """Illuminance of points in lux."""
    printed = _run("rtrace", ["-h", "-I", *settings, OCTREE], points.parent, given=points.read_bytes())
    rgb = np.array([[float(v) for v in line.split()[:3]] for line in printed.decode().splitlines() if line.strip()])
    return EFFICACY * (rgb @ LUMINANCE)


def _run(program: str, words: Sequence[str], place: Path, given: bytes = b"") -> bytes:
    """Runs a program of Radiance in a folder; returns its output."""
    path, library = _program(program)
    env = dict(os.environ)
    env["PATH"] = os.pathsep.join([str(path.parent), env.get("PATH", "")])
    if library:
        env["RAYPATH"] = os.pathsep.join([".", str(library)])
    done = subprocess.run([str(path), *words], cwd=place, env=env, input=given, capture_output=True)
    if done.returncode != 0:
        raise RuntimeError(f"Radiance's {program} failed: {done.stderr.decode(errors='replace').strip()[-500:]}")
    return done.stdout


def _program(name: str) -> tuple[Path, Path | None]:
    """A program of Radiance; if it belongs to the package pyradiance, also the folder of its library."""
    spec = importlib.util.find_spec("pyradiance")
    if spec is not None and spec.origin:
        home = Path(spec.origin).parent
        if (home / "bin" / name).exists():
            return home / "bin" / name, home / "lib"
    found = shutil.which(name)
    if found is None:
        raise ImportError(f"Radiance's {name} was not found: pip install 'luxfer[radiance]', or install Radiance")
    return Path(found), None
