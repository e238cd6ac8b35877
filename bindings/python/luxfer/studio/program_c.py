"""Converts a project to a C program that needs no studio and gives bit-identical results.

program.c beside this file is its source without the values of the project. A part between "[start NAME]" and
"[end NAME]" is left out if the project does not need it.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from . import grid
from .light import RELIGHT
from .layout import Layout
from .live import PHASES
from .program import Chosen, is_plain_room
from .project import Project
from .reshape import BEYOND
from .shot import MAX_LAMP_DISTANCE
from .room import pattern_of, texture_settings

SOURCE = Path(__file__).with_name("program.c")
#: Parts of the source that lie in files of their own, here and in C++.
PARTS = ("mix", "reshape")
#: Numbers of an array on one line.
PER_LINE = 8


def quoted(text: str) -> str:
    """Returns a text as a C string in UTF-8. Bytes beyond ASCII, and a question mark, which could begin a trigraph,
    become octal escapes of three digits."""
    plain = set(range(0x20, 0x7F)) - set(b'"\\?')
    return '"' + "".join(chr(b) if b in plain else f"\\{b:03o}" for b in text.encode()) + '"'


def numbers(values: Any) -> str:
    """Returns numbers as a list in C, with all digits."""
    texts = [repr(float(value)) for value in values]
    lines = [", ".join(texts[at : at + PER_LINE]) for at in range(0, len(texts), PER_LINE)]
    return "{" + ",\n    ".join(lines) + "}"


def floats(values: Any) -> str:
    """As numbers, rounded to floats as the Python package rounds them."""
    return numbers(np.asarray(values, np.float32)).replace(",", "f,").replace("}", "f}")


def one_float(value: float) -> str:
    return floats([value])[1:-1]


def array(kind: str, name: str, rows: list[str], unused: str, width: str = "") -> str:
    """Returns the array NAMEs. An array in C has at least one row, so without rows it has `unused`."""
    body = ",\n    ".join(rows or [unused])
    return f"static const {kind} {name}s[]{width} = {{\n    {body}\n}};\n"


def counted(kind: str, name: str, rows: list[str], unused: str, width: str = "") -> str:
    """Returns the array NAMEs, and NAME_count, the number of its rows."""
    return f"{array(kind, name, rows, unused, width)}static const size_t {name}_count = {len(rows)};\n"


def strokes_of(project: Project) -> str:
    """Returns the strokes: all points in one array, and for each stroke its part of it."""
    points: list[float] = []
    rows = []
    for stroke in project["strokes"]:
        phase, positive = PHASES[stroke["kind"]]
        first, count = len(points) // 2, len(stroke["points"]) // 2
        points += stroke["points"]
        radius = one_float(max(stroke["radius"], 0.5))
        rows.append(f"{{LUXFER_PHASE_{phase.upper()}, {int(positive)}, {radius}, {first}, {count}}}")
    return (
        "/* Strokes on the photo: x and y of all points in pixels; then, for each stroke, its mask, whether it is on\n"
        " * it, its radius, its first point and the number of its points. */\n"
        f"static const float points[] = {floats(points or [0.0, 0.0])};\n"
        "typedef struct stroke {\n    luxfer_phase phase;\n    int32_t positive;\n    float radius;\n"
        "    size_t first, count;\n} stroke;\n" + counted("stroke", "stroke", rows, "{0, 0, 0.0f, 0, 0}")
    )


def placements_of(layouts: list[Layout]) -> str:
    """Returns the surfaces that receive lamps, and the places without lamps on them."""
    rows, first = [], [0, 0, 0]
    for one in layouts:
        pattern = pattern_of(one.pattern)
        counts = [len(one.zones), len(one.mix), len(one.added)]
        shares = ", ".join(f"{begin}, {count}" for begin, count in zip(first, counts))
        rows.append(
            f"{{{quoted(one.surface)}, LUXFER_PATTERN_{pattern['scale'].upper()}, {pattern['length']!r}, "
            f"{pattern['rotation']!r}, {numbers(pattern['offset'])}, {pattern['margin']!r}, {shares}}}"
        )
        first = [begin + count for begin, count in zip(first, counts)]
    return (
        "\n/* Each surface that receives lamps, and the pattern on it; then the first of its places without lamps,\n"
        " * of its dimmed kinds and of its added lamps, and their numbers. */\n"
        "typedef struct placement {\n    const char *surface;\n    luxfer_pattern_scale scale;\n"
        "    double length, rotation, offset[2], margin;\n"
        "    size_t first_zone, zone_count, first_dimmer, dimmer_count, first_added, added_count;\n} placement;\n"
        f"enum {{ placement_count = {len(layouts)} }};\n"
        + array("placement", "placement", rows, "")
        + "\n/* Places without lamps: u0, v0, u1, v1 in metres on the surface. */\n"
        + array("double", "zone", [numbers(zone) for one in layouts for zone in one.zones], "{0, 0, 0, 0}", "[4]")
    )


def mix_of(layouts: list[Layout]) -> str:
    """Returns the dimmed kinds and the added lamps of all surfaces; nothing if the library makes all lamps."""
    if is_plain_room(layouts):
        return ""
    dimmed = [f"{{{int(kind)}u, {factor!r}}}" for one in layouts for kind, factor in one.mix.items()]
    added = [numbers(lamp) for one in layouts for lamp in one.added]
    return (
        "\n/* The factor of each kind of lamp, and added lamps: kind, u and v in metres on the surface. */\n"
        "typedef struct dimmer {\n    uint32_t kind;\n    double factor;\n} dimmer;\n"
        + array("dimmer", "dimmer", dimmed, "{0u, 0.0}")
        + array("double", "added_lamp", added, "{0, 0, 0}", "[3]")
    )


def data_of(project: Project, chosen: Chosen) -> str:
    """Returns the values of a project as C."""
    size, layouts, camera, exposure, by_grid, _ = chosen
    room = project["room"]["name"] if project["room"] else ""
    out = [
        f"static const char *const photo_file = {quoted(project['photo']['name'])};\n",
        f"static const char *const room_file = {quoted(room)}; /* empty: the generated room */\n\n",
        strokes_of(project),
        placements_of(layouts),
        mix_of(layouts),
    ]
    if project["removed"]:
        out += [
            "\n/* A pixel on each lamp of the photo that was taken out. */\n",
            counted("double", "removed_lamp", [numbers(place) for place in project["removed"]], "{0, 0}", "[2]"),
        ]
    if project["reshaped"]:
        rows = [numbers([*lamp["at"], *lamp["before"], *lamp["after"]]) for lamp in project["reshaped"]]
        out += [
            "\n/* Each lamp of the photo that was moved, resized or turned: a pixel on it, and the corners of its\n"
            " * rectangle before and after. Its pixels may lie outside of the box of its corners by a share. */\n",
            counted("double", "reshaped_lamp", rows, "{0}", "[18]"),
            f"static const double beyond_lamp = {BEYOND!r};\n",
        ]
    if project["removed"] or project["reshaped"]:
        out += [
            "/* A pixel may miss its lamp by this share of the width of the photo. */\n",
            f"static const double max_lamp_distance = {MAX_LAMP_DISTANCE!r};\n",
        ]
    if by_grid:
        out += [
            "\n/* The camera of the photo by the dragged grid: directions of the room axes, the first two along the\n"
            " * plane, and the focal length in pixels. */\n",
            f"static const double photo_axes[3][3] = {{{', '.join(numbers(axis) for axis in by_grid[0])}}};\n",
            f"static const double photo_focal = {by_grid[1]!r};\n",
            "/* Its drawing: the least side of a cell and the bounds of their number, and the lines. */\n",
            f"static const uint32_t cell = {grid.CELL}, min_cells = {grid.MIN_CELLS}, max_cells = {grid.MAX_CELLS};\n",
            f"static const double half_width = {grid.HALF_WIDTH}, half_length = {grid.HALF_LENGTH};\n",
            f"static const double contrast = {grid.CONTRAST};\n",
        ]
    out += [
        "\n/* The picture. */\n",
        f"static const uint32_t picture_width = {size[0]}, picture_height = {size[1]};\n",
        f"static const float camera_position[3] = {floats(camera['position'])};\n",
        f"static const float camera_target[3] = {floats(camera['target'])};\n",
        f"static const float camera_fov_y = {one_float(camera['fov_y'])};\n",
        f"static const float exposure = {one_float(project['exposure'] or exposure)}; /* of 1 cd/m2 */\n",
    ]
    return "".join(out)


def assignments(place: str, settings: dict[str, Any]) -> str:
    """Returns lines that set fields of a struct."""
    lines = []
    for name, value in settings.items():
        if isinstance(value, (list, tuple)):
            lines += [f"    {place}.{name}[{i}] = {float(entry)!r};\n" for i, entry in enumerate(value)]
        elif isinstance(value, str):
            lines.append(f"    {place}.{name} = LUXFER_PATTERN_{value.upper()};\n")
        elif isinstance(value, int):
            lines.append(f"    {place}.{name} = {value}u;\n")
        else:
            lines.append(f"    {place}.{name} = {float(value)!r};\n")
    return "".join(lines)


def settings_of(project: Project, distance: tuple[float, float] | None, places: tuple[str, str]) -> str:
    """Returns the lines that set the settings of each transfer, in two structs."""
    texture = texture_settings(project, distance)
    return assignments(places[0], texture) + assignments(places[1], RELIGHT)


def filled(source: Path, project: Project, chosen: Chosen, data: str, places: tuple[str, str]) -> str:
    """Returns the text of a source in C or C++ with the values of a project, and without the parts that the project
    does not need."""
    is_plain = is_plain_room(chosen.layouts)
    is_needed = {name: bool(project[name]) for name in ("removed", "reshaped")}
    is_needed |= {"mix": not is_plain, "plain": is_plain, "grid": bool(chosen.by_grid)}
    is_needed["nearest"] = is_needed["removed"] or is_needed["reshaped"]
    is_needed["regions"] = is_needed["nearest"] or is_needed["mix"]
    is_needed["pixels"] = is_needed["regions"] or is_needed["grid"]
    is_needed["read"] = is_needed["regions"]
    text = source.read_text(encoding="utf-8")
    for part in PARTS:  # they lie in files of their own
        beside = source.with_name(f"{source.stem}_{part}{source.suffix}").read_text(encoding="utf-8")
        text = re.sub(mark(f"file {part}"), lambda _, beside=beside: beside, text)  # type: ignore[misc]
    for name, is_kept in is_needed.items():
        part = rf"{mark(f'start {name}')}(.*?){mark(f'end {name}')}"
        text = re.sub(part, r"\1" if is_kept else "", text, flags=re.DOTALL)
    render = (project["plan"] or {"render": {"target_error": project["noise"]}})["render"]
    settings = settings_of(project, chosen.distance, places)
    values = {"data": data, "settings": settings, "render": assignments("params", render)}
    for name, lines in values.items():
        text = re.sub(mark(name), lambda _, lines=lines: lines, text)  # type: ignore[misc]
    return text


def mark(name: str) -> str:
    """Returns the expression of a line that consists of a mark in a comment."""
    return rf" *(?:/\*|//) \[{name}\](?: \*/)?\n"


def program(project: Project, chosen: Chosen) -> str:
    """Returns the text of the program."""
    return filled(SOURCE, project, chosen, data_of(project, chosen), ("of->params", "of->relight"))
