"""Results as files: the room, pictures, schedules of the lamps, their photometry, the project and its programs."""

from __future__ import annotations

import math
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import luxfer

from ..design.luminaires import Product
from . import mix, program, program_c, program_cpp
from . import project as projects

if TYPE_CHECKING:
    from .light import Light
    from .session import Wanted

#: The endings of the files of results.
ENDINGS = {
    "glb": "glb",
    "room": "room.glb",
    "usd": "usdz",
    "exr": "exr",
    "png": "png",
    "csv": "csv",
    "json": "lamps.json",
    "photometry": "zip",
    "project": "luxfer.json",
    "program": "py",
    "program-c": "c",
    "program-cpp": "cpp",
}
#: The step of Light after which each file can be written: pictures need full size, the programs need exposure and plan.
NEEDS = {
    "glb": "mix",
    "usd": "mix",
    "csv": "mix",
    "json": "mix",
    "photometry": "mix",
    "exr": "second",
    "png": "second",
    "program": "plan",
    "program-c": "plan",
    "program-cpp": "plan",
}


def check_ready(kind: str, wanted: Wanted, light: Light) -> None:
    """Raises NotReady if the results for a file are missing or belong to an older state of the project. A project file
    and the unlit room need no results."""
    if kind not in ENDINGS:
        raise LookupError(f"there is no result {kind}")
    if kind in NEEDS and light.done.get(NEEDS[kind]) is not wanted.project:
        raise luxfer.errors.NotReady("the room follows the latest change: try again in a moment")


def write(kind: str, path: Path, wanted: Wanted, light: Light) -> None:
    """Writes one file of results."""
    writers: dict[str, Callable[[Path, Wanted, Light], None]] = {
        "glb": lambda path, wanted, light: light.lit.export(path),
        "room": lambda path, wanted, light: light.room.export(path),
        "usd": _usd,
        "exr": _exr,
        "png": _png,
        "csv": _schedule,
        "json": _schedule,
        "photometry": _photometry,
        "project": lambda path, wanted, light: _text(path, projects.dumps(wanted.project)),
        "program": lambda path, wanted, light: _program(path, wanted, light, program.program),
        "program-c": lambda path, wanted, light: _program(path, wanted, light, program_c.program),
        "program-cpp": lambda path, wanted, light: _program(path, wanted, light, program_cpp.program),
    }
    writers[kind](path, wanted, light)


def _text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def _program(path: Path, wanted: Wanted, light: Light, written: Callable[..., str]) -> None:
    camera = light.camera(wanted.project)
    shot = light.shot
    chosen = program.Chosen(wanted.size, light.layouts, camera, light.exposure, shot.camera_by_grid, shot.kept_distance)
    _text(path, written(wanted.project, chosen))


def _usd(path: Path, wanted: Wanted, light: Light) -> None:
    try:
        import pxr  # noqa: F401
    except ImportError:
        what = "USD needs one more package: pip install 'luxfer[usd]', then start the studio again"
        raise LookupError(what) from None
    from .. import usd

    usd.save(light.lit, path)


def _exr(path: Path, wanted: Wanted, light: Light) -> None:
    assert light.render is not None
    light.render.write_exr(path)


def _png(path: Path, wanted: Wanted, light: Light) -> None:
    assert light.render is not None
    light.render.image("preview").save(path, wanted.project["exposure"] or light.exposure)


def _schedule(path: Path, wanted: Wanted, light: Light) -> None:
    mix.write_schedule(path, light.placed())


def _photometry(path: Path, wanted: Wanted, light: Light) -> None:
    """Writes an IES, LDT, TM-33 and GLDF file of each kind of whole lamp, with the means of its lamps. The opening is
    flat and diffuse, like the lamps of the lit room."""
    kinds: dict[str, tuple[float, list[luxfer.types.Fixture]]] = {}
    all_placed = light.placed()
    for placed in all_placed:
        of_surface = f"{placed.layout.surface} " if len(all_placed) > 1 else ""
        for lamp in placed.transfer.fixtures:
            by = placed.layout.factor(lamp.kind)
            if lamp.kind and by > 0:
                name = re.sub(r"[^\w .-]", "_", f"{of_surface}kind {letter(lamp.kind)}")
                kinds.setdefault(name, (by, []))[1].append(lamp)
    if not kinds:
        raise LookupError("there is no whole lamp: move the pattern until a lamp is not cut by the edge of the ceiling")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as out:
        for name, (by, lamps) in sorted(kinds.items()):
            numbers = [(*lamp.size, lamp.flux) for lamp in lamps]
            length, width, flux = (math.fsum(values) / len(lamps) for values in zip(*numbers))
            product = Product.panel(light.context, length, width, by * flux, name)
            out.writestr(f"{name}.ies", product.photometry)
            with luxfer.Distribution.load_memory(light.context, product.photometry, "ies") as distribution:
                for ending in ("ldt", "xml", "gldf"):
                    beside = path.with_name(f"one.{ending}")
                    distribution.save(beside)
                    out.writestr(f"{name}.{ending}", beside.read_bytes())


def letter(kind: int) -> str:
    """Returns the name of a kind on the page."""
    return chr(64 + kind) if kind <= 26 else str(kind)
