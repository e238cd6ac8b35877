"""Converts a project to a Python program that needs no studio and gives bit-identical results."""

from __future__ import annotations

from typing import Any, NamedTuple

from . import mix
from .light import MAX_LAMP_DISTANCE, RELIGHT
from .live import PHASES
from .project import Project
from .room import texture_settings

HEAD = '''"""Lights a room as in a photo: written by luxfer studio. It needs the package luxfer."""

import sys

import luxfer

photo_file = sys.argv[1] if len(sys.argv) > 1 else {photo}
room_file = sys.argv[2] if len(sys.argv) > 2 else {room}

context = luxfer.Context()
photo = luxfer.Image.load(context, photo_file)
room = luxfer.Scene.load(context, room_file) if room_file else luxfer.Scene.demo(context, "target-room")
surface = {surface}

# Strokes on the photo: mask, points in pixels, radius, and whether they are on it or off it.
strokes = luxfer.Strokes(context, *photo.size[:2])
for phase, points, radius, positive in {strokes}:
    strokes.add(phase, points, radius, positive)

transfer = luxfer.Transfer(context, photo, room, surface)
transfer.set_strokes(strokes)
transfer.run("view", "lights")
'''

REMOVED = """
# Lamps of the photo that were taken out.
from luxfer.studio.pictures import without

mask = transfer.image("lights-mask").numpy()[..., 0]
transfer.use_mask("lights", without(mask, {removed}, {max_distance} * mask.shape[1]))
"""

GRID = """
# The camera by the grid that was dragged: directions of the room axes, the first two along the plane, and the focal
# length in pixels.
from luxfer.studio import grid

plane = {{"plane_axes": grid.use(transfer, {axes}, {focal!r}, photo.size[:2])}}
"""

RESHAPED = """
# Lamps of the photo that were moved, resized or turned: a pixel on each, and its corners before and after.
from luxfer.studio import reshape

lights, mask_of_plane = (transfer.image(name).numpy()[..., 0] for name in ("lights-mask", "plane-mask"))
pixels, lights = reshape.apply(
    photo.numpy(), lights, mask_of_plane, {reshaped}, {max_distance} * lights.shape[1]
)
transfer.set_photo(pixels)
transfer.use_mask("lights", lights)
"""

#: The lit room and its schedule, as they are and with lamps that are dimmed or added.
PLAIN = 'transfer.scene("lit")', 'transfer.save_fixtures("luminaires.csv")'
MIXED = "mix.apply(transfer, *lamps)", 'mix.write_schedule(Path("luminaires.csv"), transfer, *lamps)'
MIX_HEAD = """
# The factor of each kind of lamp, and added lamps: kind, u and v in metres.
from pathlib import Path

from luxfer.studio import mix

lamps = (room.find_surface(surface), {mix}, {added})
"""

TAIL = """
# The pattern on the surface, and places without lamps: u0, v0, u1, v1 in metres.
transfer.set_zones({zones})
transfer.run("unwarp", "emission", {plane}**{texture})
transfer.run("relight", "relight", white_luminance={white}, relight={relight})
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
    #: Name of the surface that gets the lamps.
    surface: str
    camera: dict[str, Any]
    exposure: float
    #: The camera of the photo by the dragged grid, if it was dragged.
    by_grid: PhotoCamera | None = None
    #: Distance from the plane and its error before lamps were reshaped, if they were.
    distance: tuple[float, float] | None = None


def program(project: Project, chosen: Chosen) -> str:
    """Returns the text of the program."""
    size, surface, camera, exposure, by_grid, distance = chosen
    strokes = []
    for stroke in project["strokes"]:
        phase, positive = PHASES[stroke["kind"]]
        points = list(zip(stroke["points"][::2], stroke["points"][1::2]))
        strokes.append(f"    ({phase!r}, {points!r}, {max(stroke['radius'], 0.5)!r}, {positive!r}),\n")
    out = HEAD.format(
        photo=repr(project["photo"]["name"]),
        room=repr(project["room"]["name"]) if project["room"] else "None",
        surface=repr(surface),
        strokes="[\n" + "".join(strokes) + "]" if strokes else "[]",
    )
    if project["removed"]:
        out += REMOVED.format(removed=project["removed"], max_distance=MAX_LAMP_DISTANCE)
    if by_grid:
        out += GRID.format(axes=by_grid[0], focal=by_grid[1])
    if project["reshaped"]:
        out += RESHAPED.format(reshaped=project["reshaped"], max_distance=MAX_LAMP_DISTANCE)
    is_plain = mix.is_plain(project["mix"], project["added"])
    if not is_plain:
        out += MIX_HEAD.format(mix=project["mix"], added=project["added"])
    lit, schedule = PLAIN if is_plain else MIXED
    fixtures = "transfer.fixtures" if is_plain else "(lamp for lamp, _ in mix.lamps(transfer.fixtures, *lamps))"
    return out + TAIL.format(
        zones=project["zones"],
        plane="rectify=plane, " if by_grid else "",
        texture=texture_settings(project, distance),
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
