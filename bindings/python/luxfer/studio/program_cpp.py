"""Converts a project to a C++ program that needs no studio and gives bit-identical results.

program.cpp beside this file is its source without the values of the project; program_c fills it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from . import grid
from .layout import Layout
from .live import PHASES
from .program import Chosen, PhotoCamera
from .program_c import filled, floats, numbers, one_float, quoted
from .project import Project
from .reshape import BEYOND
from .room import pattern_of
from .shot import MAX_LAMP_DISTANCE

SOURCE = Path(__file__).with_name("program.cpp")


def rows(kind: str, name: str, values: list[str]) -> str:
    """Returns a vector with one line for each value."""
    body = "".join(f"    {value},\n" for value in values)
    return f"const std::vector<{kind}> {name} = {{{chr(10) + body if body else ''}}};\n"


def places(kind: str, name: str, values: Any) -> str:
    """Returns a vector of arrays of numbers."""
    return rows(kind, name, [numbers(value) for value in values])


def strokes_of(project: Project) -> str:
    values = []
    for stroke in project["strokes"]:
        phase, positive = PHASES[stroke["kind"]]
        radius, points = one_float(max(stroke["radius"], 0.5)), floats(stroke["points"])
        values.append(f"{{LUXFER_PHASE_{phase.upper()}, {str(positive).lower()}, {radius}, {points}}}")
    return (
        "/// A stroke on the photo: its mask, whether it is on it, its radius, and x and y of its points, in pixels.\n"
        "struct Stroke {\n    luxfer_phase phase;\n    bool is_positive;\n    float radius;\n"
        "    std::vector<float> points;\n};\n" + rows("Stroke", "strokes", values)
    )


def removed_of(project: Project) -> str:
    return (
        "\n// A pixel on each lamp of the photo that was taken out.\n"
        + places("std::array<double, 2>", "removed_lamps", project["removed"])
    )


def reshaped_of(project: Project) -> str:
    values = [
        f"{{{numbers(lamp['at'])}, {numbers(lamp['before'])}, {numbers(lamp['after'])}}}"
        for lamp in project["reshaped"]
    ]
    return (
        "\n/// A lamp of the photo that was moved, resized or turned: a pixel on it, and the corners of its rectangle\n"
        "/// before and after. Its pixels may lie outside of the box of its corners by a share.\n"
        "struct Reshaped {\n    std::array<double, 2> at;\n    std::array<double, 8> before, after;\n};\n"
        + rows("Reshaped", "reshaped_lamps", values)
        + f"constexpr double beyond_lamp = {BEYOND!r};\n"
    )


def distance_of() -> str:
    return (
        "/// A pixel may miss its lamp by this share of the width of the photo.\n"
        f"constexpr double max_lamp_distance = {MAX_LAMP_DISTANCE!r};\n"
    )


def grid_of(by_grid: PhotoCamera) -> str:
    return (
        "\n// The camera of the photo by the dragged grid: directions of the room axes, the first two along the plane,\n"
        "// and the focal length in pixels.\n"
        f"constexpr double photo_axes[3][3] = {{{', '.join(numbers(axis) for axis in by_grid[0])}}};\n"
        f"constexpr double photo_focal = {by_grid[1]!r};\n"
        "// Its drawing: the least side of a cell and the bounds of their number, and the lines.\n"
        f"constexpr std::uint32_t cell = {grid.CELL}, min_cells = {grid.MIN_CELLS}, max_cells = {grid.MAX_CELLS};\n"
        f"constexpr double half_width = {grid.HALF_WIDTH}, half_length = {grid.HALF_LENGTH};\n"
        f"constexpr double contrast = {grid.CONTRAST};\n"
    )


def placements_of(layouts: list[Layout]) -> str:
    values = []
    for one in layouts:
        pattern = pattern_of(one.pattern)
        dimmers = ", ".join(f"{{{int(kind)}u, {factor!r}}}" for kind, factor in one.mix.items())
        zones, added = (", ".join(map(numbers, values)) for values in (one.zones, one.added))
        zones, added = (f"{{{text}}}" if text else "" for text in (zones, added))
        values.append(
            f"{{{quoted(one.surface)}, LUXFER_PATTERN_{pattern['scale'].upper()}, {pattern['length']!r}, "
            f"{pattern['rotation']!r}, {numbers(pattern['offset'])}, {pattern['margin']!r},\n"
            f"     {{{zones}}}, {{{dimmers}}}, {{{added}}}}}"
        )
    return (
        "\n/// The factor of a kind of lamp.\nstruct Dimmer {\n    std::uint32_t kind;\n    double factor;\n};\n"
        "/// A surface that receives lamps: the pattern on it, places without lamps (u0, v0, u1, v1 in metres), dimmed\n"
        "/// kinds, and added lamps (kind, u and v in metres).\n"
        "struct Placement {\n    const char *surface;\n    luxfer_pattern_scale scale;\n    double length, rotation;\n"
        "    std::array<double, 2> offset;\n    double margin;\n    std::vector<std::array<double, 4>> zones;\n"
        "    std::vector<Dimmer> dimmers;\n    std::vector<std::array<double, 3>> added;\n};\n"
        + rows("Placement", "placements", values)
    )


def data_of(project: Project, chosen: Chosen) -> str:
    """Returns the values of a project as C++."""
    size, layouts, camera, exposure, by_grid, _ = chosen
    room = project["room"]["name"] if project["room"] else ""
    return "".join(
        [
            f"constexpr const char *photo_file = {quoted(project['photo']['name'])};\n",
            f"constexpr const char *room_file = {quoted(room)}; // empty: the generated room\n",
            "\n",
            strokes_of(project),
            placements_of(layouts),
            removed_of(project) if project["removed"] else "",
            reshaped_of(project) if project["reshaped"] else "",
            distance_of() if project["removed"] or project["reshaped"] else "",
            grid_of(by_grid) if by_grid else "",
            "\n// The picture.\n",
            f"constexpr std::uint32_t picture_width = {size[0]}, picture_height = {size[1]};\n",
            f"constexpr float camera_position[] = {floats(camera['position'])};\n",
            f"constexpr float camera_target[] = {floats(camera['target'])};\n",
            f"constexpr float camera_fov_y = {one_float(camera['fov_y'])};\n",
            f"constexpr float exposure = {one_float(project['exposure'] or exposure)}; // of 1 cd/m2\n",
        ]
    )


def program(project: Project, chosen: Chosen) -> str:
    """Returns the text of the program."""
    return filled(SOURCE, project, chosen, data_of(project, chosen), ("params", "parts.relight"))
