"""Converts a project to a Python program that needs no studio and gives bit-identical results."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from .layout import Layout, settings_of
from .light import RELIGHT
from .live import PHASES
from .project import Project
from .shot import MAX_LAMP_DISTANCE

HEAD = '''"""Lights a room as in a photo: written by luxfer studio. It needs the package luxfer."""

import sys

import luxfer

photo_file = sys.argv[1] if len(sys.argv) > 1 else {photo}
room_file = sys.argv[2] if len(sys.argv) > 2 else {room}

context = luxfer.Context()
photo = luxfer.Image.load(context, photo_file)
room = luxfer.Scene.load(context, room_file) if room_file else luxfer.Scene.demo(context, "target-room")

# Each surface that receives lamps, its texture with its pattern, and places without lamps: u0, v0, u1, v1 in metres.
surfaces = {surfaces}

# Strokes on the photo: mask, points in pixels, radius, and whether they are on it or off it.
strokes = luxfer.Strokes(context, *photo.size[:2])
for phase, points, radius, positive in {strokes}:
    strokes.add(phase, points, radius, positive)

transfers = []
for surface, _, zones in surfaces:
    transfer = luxfer.Transfer(context, photo, room, surface)
    transfer.set_strokes(strokes)
    transfer.set_zones(zones)
    transfers.append(transfer.run("view", "lights"))
'''

REMOVED = """
# Lamps of the photo that were taken out.
from luxfer.studio.pictures import without

mask = transfer.image("lights-mask").numpy()[..., 0]
mask = without(mask, {removed}, {max_distance} * mask.shape[1])
for transfer in transfers:
    transfer.use_mask("lights", mask)
"""

GRID = """
# The camera by the grid that was dragged: directions of the room axes, the first two along the plane, and the focal
# length in pixels.
from luxfer.studio import grid

for transfer in transfers:
    plane = {{"plane_axes": grid.use(transfer, {axes}, {focal!r}, photo.size[:2])}}
"""

RESHAPED = """
# Lamps of the photo that were moved, resized or turned: a pixel on each, and its corners before and after.
from luxfer.studio import reshape

lights, mask_of_plane = (transfer.image(name).numpy()[..., 0] for name in ("lights-mask", "plane-mask"))
pixels, lights = reshape.apply(
    photo.numpy(), lights, mask_of_plane, {reshaped}, {max_distance} * lights.shape[1]
)
changed = luxfer.Image(context, pixels)
for transfer in transfers:
    transfer.set_photo(changed)
    transfer.use_mask("lights", lights)
"""

#: The lit room and its schedule, as they are and with lamps that are dimmed or added.
PLAIN = 'transfer.scene("lit")', 'transfer.save_fixtures("luminaires.csv")'
MIXED = "mix.apply(placed)", 'mix.write_schedule(Path("luminaires.csv"), placed)'
MIX_HEAD = """
# For each surface, the factor of each kind of lamp, and added lamps: kind, u and v in metres.
from pathlib import Path

from luxfer.studio import layout, mix

changes = {changes}
layouts = [layout.Layout(name, {{}}, zones, *change) for (name, _, zones), change in zip(surfaces, changes)]
placed = layout.place_all(room, transfers, layouts)
"""

TAIL = """
for transfer in transfers:
    transfer.run("unwarp", "unwarp"{plane})
luxfer.Transfer.run_all(transfers, "emission", "emission", [texture for _, texture, _ in surfaces])
light = {{"white_luminance": {white}, "relight": {relight}}}
luxfer.Transfer.run_all(transfers, "relight", "relight", light)
{mix}
lit = {lit}
render = luxfer.Render(context, lit)
render.set_camera(**{camera})
render.run(width={width}, height={height}, preview=1.0, **{render})

for lamp in {fixtures}:
    print(f"kind {{lamp.kind}}: {{lamp.flux:.0f}} lm, {{lamp.cct:.0f}} K at", [round(x, 2) for x in lamp.position])
lit.export("lit.glb")
{schedule}
render.write_exr("render.exr")
render.image("preview").save("render.png", {exposure})
"""


#: Directions of the room axes of the photo, the first two along the plane, and focal length in pixels.
PhotoCamera = tuple[list[list[float]], float]


class Chosen(NamedTuple):
    """What the studio has chosen for a project that does not state it."""

    #: Width and height of the picture.
    size: tuple[int, int]
    #: The surfaces that receive lamps, and how.
    layouts: list[Layout]
    camera: dict[str, Any]
    exposure: float
    #: The camera of the photo by the dragged grid, if it was dragged.
    by_grid: PhotoCamera | None = None
    #: Distance from the plane and its error before lamps were reshaped, if they were.
    distance: tuple[float, float] | None = None


def is_plain_room(layouts: list[Layout]) -> bool:
    """Whether the library alone makes the lit room and its schedule: one surface, and no lamp is dimmed or added."""
    return len(layouts) == 1 and layouts[0].is_plain


def listed(values: Iterable[Any]) -> str:
    """Returns a list with one value on each line."""
    lines = "".join(f"    {value!r},\n" for value in values)
    return f"[\n{lines}]" if lines else "[]"


def program(project: Project, chosen: Chosen) -> str:
    """Returns the text of the program."""
    size, layouts, camera, exposure, by_grid, distance = chosen
    strokes = []
    for stroke in project["strokes"]:
        phase, positive = PHASES[stroke["kind"]]
        points = list(zip(stroke["points"][::2], stroke["points"][1::2]))
        strokes.append((phase, points, max(stroke["radius"], 0.5), positive))
    out = HEAD.format(
        photo=repr(project["photo"]["name"]),
        room=repr(project["room"]["name"]) if project["room"] else "None",
        surfaces=listed((one.surface, settings_of(project, one, distance), one.zones) for one in layouts),
        strokes=listed(strokes),
    )
    if project["removed"]:
        out += REMOVED.format(removed=project["removed"], max_distance=MAX_LAMP_DISTANCE)
    if by_grid:
        out += GRID.format(axes=by_grid[0], focal=by_grid[1])
    if project["reshaped"]:
        out += RESHAPED.format(reshaped=project["reshaped"], max_distance=MAX_LAMP_DISTANCE)
    is_plain = is_plain_room(layouts)
    lit, schedule = PLAIN if is_plain else MIXED
    fixtures = "transfer.fixtures" if is_plain else "(lamp for one in placed for lamp, _ in mix.lamps(one))"
    return out + TAIL.format(
        mix="" if is_plain else MIX_HEAD.format(changes=listed((one.mix, one.added) for one in layouts)),
        plane=", rectify=plane" if by_grid else "",
        white=project["white"],
        relight=RELIGHT,
        lit=lit,
        schedule=schedule,
        fixtures=fixtures,
        camera=camera,
        width=size[0],
        height=size[1],
        render=(project["plan"] or {"render": {"target_error": project["noise"]}})["render"],
        exposure=project["exposure"] or exposure,
    )
