"""The lamps as the user wants them: a factor for each kind, such as 0.5 for half of the light, and added lamps.

An added lamp is [kind, u, v]: a copy of the largest lamp of its kind, at a place in metres on the surface. Both change
the texture of the lit room and the schedule of its lamps, and thereby all results that are computed from them.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import luxfer
import numpy as np

from .layout import Placed
from .pictures import regions

#: Columns of the schedule that are proportional to the light of a lamp.
LIGHT = ("red_cd_m2", "green_cd_m2", "blue_cd_m2", "flux_lm")
#: Number of points along each side of a lamp that find its texels.
POINTS = 5


def models(fixtures: list[luxfer.types.Fixture]) -> dict[int, int]:
    """Returns for each kind the index of its largest lamp."""
    out: dict[int, int] = {}
    for i, lamp in enumerate(fixtures):
        if lamp.kind not in out or lamp.area > fixtures[out[lamp.kind]].area:
            out[lamp.kind] = i
    return out


def lamps(placed: Placed) -> list[tuple[luxfer.types.Fixture, int | None]]:
    """Returns the lamps of a surface, each with the number of its addition or None. Additions of a kind that the room
    no longer has are left out."""
    fixtures = placed.transfer.fixtures
    known = models(fixtures)
    out: list[tuple[luxfer.types.Fixture, int | None]] = [(lamp, None) for lamp in fixtures]
    for i, (kind, u, v) in enumerate(placed.layout.added):
        if int(kind) in known:
            model = fixtures[known[int(kind)]]
            position = np.array(model.position) + step_to(model, placed.surface, u, v)
            out.append((replace(model, position=tuple(float(x) for x in position)), i))
    for at, (lamp, number) in enumerate(out):
        by = placed.layout.factor(lamp.kind)
        radiance = tuple(by * x for x in lamp.radiance)
        out[at] = replace(lamp, flux=by * lamp.flux, radiance=radiance), number
    return out


def step_to(
    lamp: luxfer.types.Fixture, surface: luxfer.types.Surface, u: float, v: float
) -> np.ndarray[Any, Any]:
    """Returns the vector from a lamp to a place on the surface."""
    du, dv = np.array((u, v)) - on_surface(np.array(lamp.position), surface)
    return np.asarray(du * np.array(surface.u_axis) + dv * np.array(surface.v_axis))


def apply(all_placed: list[Placed], which: str = "lit") -> luxfer.Scene:
    """Returns the lit room with its lamps as the user wants them; "white" is the room in white light."""
    lit = all_placed[0].transfer.scene(which)
    for placed in all_placed:
        if not placed.layout.is_plain:
            change_texture(lit, placed, len(all_placed))
    return lit


def change_texture(lit: luxfer.Scene, placed: Placed, count: int) -> None:
    """Changes the lamps of one of `count` surfaces in the lit room."""
    surface, fixtures, layout = placed.surface, placed.transfer.fixtures, placed.layout
    mesh = mesh_of(lit, surface, count)
    used = lit.material_texture(lit.mesh(mesh).material, "emission")
    values = lit.texture(used.texture).numpy().copy()
    labels, found = regions(values.max(axis=2) > 0)
    to_texture = texture_map(lit, surface, count)
    factors = np.ones(found + 1, np.float32)
    for lamp in fixtures:
        for label in labels_of(lamp, surface, to_texture, labels):
            factors[label] = layout.factor(lamp.kind)
    values *= factors[labels][..., None]
    known = models(fixtures)
    for kind, u, v in layout.added:
        if int(kind) in known:
            copy_lamp(values, labels, fixtures[known[int(kind)]], surface, to_texture, (u, v))
    index = lit.add_texture(luxfer.Image(lit.context, values), used.wrap_u, used.wrap_v)
    lit.set_material_texture(lit.mesh(mesh).material, "emission", index, used.uv_set, used.transform)


def copy_lamp(
    values: np.ndarray[Any, Any],
    labels: np.ndarray[Any, Any],
    lamp: luxfer.types.Fixture,
    surface: luxfer.types.Surface,
    to_texture: np.ndarray[Any, Any],
    place: tuple[float, float],
) -> None:
    """Copies the texels of a lamp to another place; texels beyond the texture are cut off."""
    height, width = labels.shape
    step = to_texture[:, :2] @ (np.array(place) - on_surface(np.array(lamp.position), surface))
    dx, dy = round(step[0] * width), round(step[1] * height)
    ys, xs = np.nonzero(np.isin(labels, labels_of(lamp, surface, to_texture, labels)))
    inside = (ys + dy >= 0) & (ys + dy < height) & (xs + dx >= 0) & (xs + dx < width)
    ys, xs = ys[inside], xs[inside]
    values[ys + dy, xs + dx] = values[ys, xs]


def mesh_of(lit: luxfer.Scene, surface: luxfer.types.Surface, count: int) -> int:
    """Returns the mesh with the lamps of a surface. A transfer adds the meshes of its `count` surfaces last; that of a
    surface fills its rectangle best."""
    meshes = range(lit.counts.meshes - count, lit.counts.meshes)
    return min(meshes, key=lambda mesh: misfit(lit.mesh_arrays(mesh)["positions"].astype(float), surface))


def misfit(positions: np.ndarray[Any, Any], surface: luxfer.types.Surface) -> float:
    """Returns the largest distance in metres of the bounds of positions from those of a surface."""
    low, high = (f(on_surface(positions, surface), axis=0) for f in (np.min, np.max))
    away = np.abs((positions - surface.origin) @ surface.normal).max()
    return float(max(away, *np.abs(low), *np.abs(high - surface.size)))


def texture_map(lit: luxfer.Scene, surface: luxfer.types.Surface, count: int) -> np.ndarray[Any, Any]:
    """Returns the 2 x 3 matrix that maps u and v in metres on the surface to shares of the width and the height of the
    texture. If the pattern is turned, the texture covers a turned rectangle."""
    mesh = mesh_of(lit, surface, count)
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


def write_schedule(path: Path, all_placed: list[Placed]) -> None:
    """Writes the schedule of the lamps, .csv or .json, as the library does, with the lamps as the user wants them. If
    several surfaces have lamps, a column names the surface."""
    all_rows: list[dict[str, Any]] = []
    for placed in all_placed:
        placed.transfer.save_fixtures(path)
        if len(all_placed) == 1 and placed.layout.is_plain:
            return
        rows, save = read_rows(path)
        change_rows(rows, placed)
        name = {"surface": placed.layout.surface} if len(all_placed) > 1 else {}
        all_rows += [{**row, **name} for row in rows]
    save(all_rows)


def change_rows(rows: list[dict[str, Any]], placed: Placed) -> None:
    """Changes the lamps of a schedule, and appends the added ones."""
    fixtures = placed.transfer.fixtures
    known = models(fixtures)
    for kind, u, v in placed.layout.added:
        if int(kind) in known:
            index = known[int(kind)]
            rows.append(moved(rows[index], step_to(fixtures[index], placed.surface, u, v)))
    for row in rows if not placed.layout.is_plain else ():
        by = placed.layout.factor(int(row["kind"]))
        for name in LIGHT:
            put(row, name, float(row[name]) * by)


def read_rows(path: Path) -> tuple[list[dict[str, Any]], Callable[[list[dict[str, Any]]], None]]:
    """Returns the lamps of a schedule, and a function that writes them again."""
    if path.suffix == ".json":
        whole = json.loads(path.read_text(encoding="utf-8"))

        def save_json(rows: list[dict[str, Any]]) -> None:
            lines = ",\n  ".join(json.dumps(row) for row in rows)
            path.write_text(f'{{"fixtures": [\n  {lines}\n]}}\n', encoding="utf-8")

        return whole["fixtures"], save_json
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        names, rows = list(reader.fieldnames or ()), list(reader)

    def save_csv(rows: list[dict[str, Any]]) -> None:
        with path.open("w", newline="", encoding="utf-8") as out:
            surface = ["surface"] if rows and "surface" in rows[0] else []
            writer = csv.DictWriter(out, [*names, *surface], lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)

    return rows, save_csv


def moved(row: dict[str, Any], step: np.ndarray[Any, Any]) -> dict[str, Any]:
    """Returns a copy of a lamp at another place."""
    out = dict(row)
    for name, by in zip(("x_m", "y_m", "z_m"), step):
        put(out, name, float(row[name]) + float(by))
    if "outline_m" in row:
        out["outline_m"] = [[round(x + float(by), 6) for x, by in zip(corner, step)] for corner in row["outline_m"]]
    return out


def put(row: dict[str, Any], name: str, value: float) -> None:
    """Sets a number of a lamp, with seven digits as the library writes them."""
    text = f"{value:.7g}"
    row[name] = text if isinstance(row[name], str) else float(text)
