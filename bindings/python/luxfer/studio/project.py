"""A project: all inputs that determine the result, as a JSON object that the page sends and files store."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

FORMAT = 1
KINDS = ("plane", "not-plane", "light", "not-light")
SCALES = ("distance", "lamp", "spacing", "across")
#: Minimum area in square pixels of a reshaped lamp. [convention]
MIN_AREA = 1e-3
#: The library's maximum of paths per pixel, up to which a plan may go.
MAX_SAMPLES = 1 << 20

Project = dict[str, Any]

#: A new project, without photo and room.
DEFAULTS: Project = {
    "luxfer_studio": FORMAT,
    "photo": None,  # {"name", "sha256"}
    "room": None,  # {"name", "sha256"}; None: the generated room
    "strokes": [],  # {"kind", "radius", "points": [x, y, x, y, ...]} in pixels of the photo
    "removed": [],  # [x, y] in the photo, on each lamp that was taken out of the mask
    "reshaped": [],  # {"at": [x, y] on a lamp, "before", "after": x, y of its corners on the plane} in the photo
    "grid": None,  # x, y in the photo of the corners of a rectangle on the plane, in turn; None: found by the library
    "zones": [],  # [u0, v0, u1, v1] in metres on the surface, on each lamp that was taken out of the room
    "surface": None,  # name of the surface that receives the lights; None: the likeliest ceiling
    "pattern": {"scale": "distance", "length": 1.2, "rotation": 0.0, "offset": [0.0, 0.0], "keep_whole": False},
    "mix": {},  # for each kind of lamp, the factor of its light; 1 for kinds that are not named
    "added": [],  # [kind, u, v] in metres on the surface: a copy of a lamp of this kind
    "others": [],  # {"surface", "pattern", "zones", "mix", "added"} of each further surface that receives lamps
    "lux_plane": {"surface": None, "height": 0.75},  # where the page shows lux: a surface, or a height above the floor
    "white": 100.0,  # luminance of the photo's white, cd/m²
    "camera": None,  # {"position", "target", "fov_y"}; None: the first camera of the room
    "exposure": None,  # value in the picture of 1 cd/m²; None: chosen by its brightness
    "noise": 0.1,  # error of the picture to plan for
    "plan": None,  # {"render"}: the settings that a plan has chosen for that noise
}


class Invalid(ValueError):
    """A value is not a valid project; the message names the wrong entry."""


def message(error: Exception) -> str:
    """Returns the message of an error; it is never empty, because the page takes an empty message for no error."""
    return str(error) or type(error).__name__


def failure(error: Exception) -> dict[str, Any]:
    """Returns the message to the page about an error. If a file is missing, the page asks for it."""
    missing = isinstance(error, FileNotFoundError)
    return {"type": "failed", "message": message(error), "missing": missing, "error": type(error).__name__}


def number(low: float, high: float) -> Callable[[Any, str], float]:
    def check(value: Any, name: str) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
            raise Invalid(f"{name} is a number in [{low:g}, {high:g}], not {value!r}")
        return float(value)

    return check


def text(value: Any, name: str) -> str:
    if not isinstance(value, str) or not value or len(value) > 500 or "\0" in value:
        raise Invalid(f"{name} is a text of up to 500 characters, not {value!r}")
    return value


def one_of(names: tuple[str, ...]) -> Callable[[Any, str], str]:
    def check(value: Any, name: str) -> str:
        if value not in names:
            raise Invalid(f"{name} is one of {', '.join(names)}, not {value!r}")
        return str(value)

    return check


def truth(value: Any, name: str) -> bool:
    if not isinstance(value, bool):
        raise Invalid(f"{name} is true or false, not {value!r}")
    return value


def many(
    check: Callable[[Any, str], Any], count: int | None = None, max_count: int = 100_000
) -> Callable[[Any, str], list[Any]]:
    def check_all(values: Any, name: str) -> list[Any]:
        if not isinstance(values, list) or (count is not None and len(values) != count) or len(values) > max_count:
            raise Invalid(f"{name} is a list of {f'up to {max_count}' if count is None else count} entries")
        return [check(value, f"{name}[{i}]") for i, value in enumerate(values)]

    return check_all


def record(**fields: Callable[[Any, str], Any]) -> Callable[[Any, str], dict[str, Any]]:
    def check(value: Any, name: str) -> dict[str, Any]:
        if not isinstance(value, dict) or set(value) != set(fields):
            raise Invalid(f"{name} is an object with {', '.join(fields)}")
        return {key: inner(value[key], f"{name}.{key}") for key, inner in fields.items()}

    return check


def optional(check: Callable[[Any, str], Any]) -> Callable[[Any, str], Any]:
    return lambda value, name: None if value is None else check(value, name)


def whole(low: int, high: int) -> Callable[[Any, str], int]:
    def check(value: Any, name: str) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise Invalid(f"{name} is a whole number in [{low}, {high}], not {value!r}")
        return value

    return check


def settings(**fields: Callable[[Any, str], Any]) -> Callable[[Any, str], dict[str, Any]]:
    """A check for settings of the library. It refuses all other fields, because a project may come from a stranger."""

    def check(value: Any, name: str) -> dict[str, Any]:
        if not isinstance(value, dict) or not set(value) <= set(fields):
            raise Invalid(f"{name} is an object with some of {', '.join(fields)}")
        return {key: fields[key](inner, f"{name}.{key}") for key, inner in value.items()}

    return check


def factors(low: float, high: float) -> Callable[[Any, str], dict[str, float]]:
    """A check for a factor for each kind of lamp."""

    def check(value: Any, name: str) -> dict[str, float]:
        if not isinstance(value, dict) or len(value) > 1000 or not all(str(key).isdecimal() for key in value):
            raise Invalid(f"{name} is an object with a factor for the number of each kind of lamp")
        return {key: number(low, high)(inner, f"{name}.{key}") for key, inner in value.items()}

    return check


PIXEL, METRE = number(-1e5, 1e5), number(-1e6, 1e6)


def corners(value: Any, name: str) -> list[float]:
    """A check for the corners of a rectangle seen in perspective, in turn."""
    numbers: list[float] = many(PIXEL, 8)(value, name)
    points = list(zip(numbers[::2], numbers[1::2]))
    turns = []
    for i in range(4):
        (x0, y0), (x1, y1), (x2, y2) = (points[(i + k) % 4] for k in range(3))
        turns.append((x1 - x0) * (y2 - y1) - (y1 - y0) * (x2 - x1))
    if not (min(turns) > MIN_AREA or max(turns) < -MIN_AREA):
        raise Invalid(f"{name} are not the corners of a rectangle seen in perspective")
    return numbers


FILE = record(name=text, sha256=text)
PATTERN = record(
    scale=one_of(SCALES),
    length=number(1e-3, 1e3),
    rotation=number(-math.tau, math.tau),
    offset=many(METRE, 2),
    keep_whole=truth,
)
ZONES = many(many(METRE, 4), max_count=5000)
ADDED = many(many(METRE, 3), max_count=1000)
#: A transfer of the library has up to 16 planes.
MAX_OTHERS = 15
FIELDS = {
    "photo": FILE,
    "room": optional(FILE),
    "strokes": many(record(kind=one_of(KINDS), radius=number(1e-3, 4096), points=many(PIXEL)), max_count=5000),
    "removed": many(many(PIXEL, 2), max_count=5000),
    "reshaped": many(record(at=many(PIXEL, 2), before=corners, after=corners), max_count=1000),
    "grid": optional(many(PIXEL, 8)),
    "zones": ZONES,
    "surface": optional(text),
    "pattern": PATTERN,
    "mix": factors(0, 4),
    "added": ADDED,
    "others": many(
        record(surface=text, pattern=PATTERN, zones=ZONES, mix=factors(0, 4), added=ADDED), max_count=MAX_OTHERS
    ),
    "lux_plane": record(surface=optional(text), height=number(0, 100)),
    "white": number(1e-3, 1e6),
    "camera": optional(record(position=many(METRE, 3), target=many(METRE, 3), fov_y=number(0.01, 3))),
    "exposure": optional(number(1e-9, 1e9)),
    "noise": number(1e-3, 1),
    "plan": optional(
        record(render=settings(samples=whole(1, MAX_SAMPLES), target_error=number(0, 1e9), seed=whole(0, 2**64 - 1)))
    ),
}


def checked(value: Any) -> Project:
    """Checks a project, and adds missing entries; raises Invalid if an entry is wrong."""
    if not isinstance(value, dict) or value.get("luxfer_studio") != FORMAT:
        raise Invalid("this is not a project of luxfer studio: open a file that Keep the result > Project has saved")
    if unknown := set(value) - set(DEFAULTS):
        raise Invalid(f"the project has an unknown entry: {min(unknown)}")
    merged = {**DEFAULTS, **value}
    out = {"luxfer_studio": FORMAT, **{name: check(merged[name], name) for name, check in FIELDS.items()}}
    for i, stroke in enumerate(out["strokes"]):
        if len(stroke["points"]) % 2 or not stroke["points"]:
            raise Invalid(f"strokes[{i}].points has an x and a y for each point")
    names = [out["surface"], *(other["surface"] for other in out["others"])]
    if out["others"] and (None in names or len(set(names)) < len(names)):
        raise Invalid("others names each further surface once, and surface is not one of them")
    return out


def load(path: Path) -> Project:
    """Loads the project in a file."""
    try:
        return checked(json.loads(path.read_text(encoding="utf-8")))
    except (UnicodeDecodeError, json.JSONDecodeError) as broken:
        raise Invalid(f"{path.name} is not a project of luxfer studio: {broken}") from None


def dumps(project: Project) -> str:
    """Formats a project as a file with one line per entry and per stroke, so that versions can be compared."""
    lines = []
    for name, value in project.items():
        body = json.dumps(value)
        if name == "strokes" and value:
            body = "[\n    " + ",\n    ".join(json.dumps(stroke) for stroke in value) + "\n  ]"
        lines.append(f"  {json.dumps(name)}: {body}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def save(path: Path, project: Project) -> None:
    """Writes a project file atomically: after a crash, either the old or the new file is there."""
    partial = path.with_name(f".{path.name}.partial")
    partial.write_text(dumps(project), encoding="utf-8")
    os.replace(partial, path)
