"""The mix of the lamps: a factor for each kind, such as 0.5 for lamps that are dimmed to half.

The factors multiply the emission of the lit room, its luminaires, and thereby everything that is computed from them.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import luxfer
import numpy as np

from .pictures import regions

#: Columns of the schedule that are proportional to the light of a lamp.
LIGHT = ("red_cd_m2", "green_cd_m2", "blue_cd_m2", "flux_lm")
#: Number of points along each side of a lamp that find its texels.
POINTS = 5


def factor(mix: dict[str, float], kind: int) -> float:
    """Returns the factor of a kind of lamp; 1 if the mix does not name it."""
    return mix.get(str(kind), 1.0)


def apply(
    transfer: luxfer.Transfer, surface: luxfer.types.Surface, mix: dict[str, float], which: str = "lit"
) -> luxfer.Scene:
    """Returns the lit room of a transfer with its lamps mixed; "white" is the room in white light."""
    lit = transfer.scene(which)
    if all(value == 1 for value in mix.values()):
        return lit
    mesh = newest(lit)
    used = lit.material_texture(lit.mesh(mesh).material, "emission")
    values = lit.texture(used.texture).numpy().copy()
    labels, count = regions(values.max(axis=2) > 0)
    to_texture = texture_map(lit, surface)
    factors = np.ones(count + 1, np.float32)
    for lamp in transfer.fixtures:
        for label in labels_of(lamp, surface, to_texture, labels):
            factors[label] = factor(mix, lamp.kind)
    values *= factors[labels][..., None]
    index = lit.add_texture(luxfer.Image(lit.context, values), used.wrap_u, used.wrap_v)
    lit.set_material_texture(lit.mesh(mesh).material, "emission", index, used.uv_set, used.transform)
    return lit


def newest(lit: luxfer.Scene) -> int:
    """Returns the mesh with the lamps, which a transfer adds last."""
    return lit.counts.meshes - 1


def texture_map(lit: luxfer.Scene, surface: luxfer.types.Surface) -> np.ndarray[Any, Any]:
    """Returns the 2 x 3 matrix that maps u and v in metres on the surface to shares of the width and the height of the
    texture. If the pattern is turned, the texture covers a turned rectangle."""
    mesh = newest(lit)
    used = lit.material_texture(lit.mesh(mesh).material, "emission")
    arrays = lit.mesh_arrays(mesh)
    places = on_surface(arrays["positions"].astype(float), surface)
    known = np.column_stack((places, np.ones(len(places))))
    return np.linalg.lstsq(known, arrays["uvs1" if used.uv_set else "uvs"].astype(float), rcond=None)[0].T


def on_surface(positions: np.ndarray[Any, Any], surface: luxfer.types.Surface) -> np.ndarray[Any, Any]:
    """Returns u and v in metres of positions on a surface."""
    axes = np.column_stack((surface.u_axis, surface.v_axis))
    return np.asarray((positions - surface.origin) @ axes)


def labels_of(
    lamp: luxfer.types.Fixture,
    surface: luxfer.types.Surface,
    to_texture: np.ndarray[Any, Any],
    labels: np.ndarray[Any, Any],
) -> list[int]:
    """Returns the lit regions of the texture that a lamp covers."""
    axis = np.array(lamp.axis)
    across = np.cross(lamp.normal, axis)
    steps = (np.arange(POINTS) + 0.5) / POINTS - 0.5
    offsets = steps[:, None, None] * lamp.size[0] * axis + steps[None, :, None] * lamp.size[1] * across
    places = on_surface(np.array(lamp.position) + offsets.reshape(-1, 3), surface)
    x, y = to_texture[:, :2] @ places.T + to_texture[:, 2:]
    height, width = labels.shape
    found = labels[(y * height).astype(int).clip(0, height - 1), (x * width).astype(int).clip(0, width - 1)]
    return [int(label) for label in np.unique(found) if label]


def mix_schedule(path: Path, mix: dict[str, float]) -> None:
    """Multiplies the light of the lamps in a schedule, .csv or .json, that the library has written."""
    if all(value == 1 for value in mix.values()):
        return
    if path.suffix == ".json":
        whole = json.loads(path.read_text(encoding="utf-8"))
        for lamp in whole["fixtures"]:
            scale(lamp, factor(mix, int(lamp["kind"])))
        path.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")
        return
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        names, rows = list(reader.fieldnames or ()), list(reader)
    for row in rows:
        scale(row, factor(mix, int(row["kind"])))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def scale(lamp: dict[str, Any], by: float) -> None:
    """Multiplies the light of one lamp; numbers keep seven digits, as the library writes them."""
    for name in LIGHT:
        if name in lamp:
            value = float(f"{float(lamp[name]) * by:.7g}")
            lamp[name] = f"{value:.7g}" if isinstance(lamp[name], str) else value
