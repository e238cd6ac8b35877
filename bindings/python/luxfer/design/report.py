"""Writes the report of a project as HTML or PDF, its schedules as CSV, and its building model as IFC."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from . import fingerprint, html, ifc_write, pdf, schedule
from .content import contents
from .pictures import views

if TYPE_CHECKING:
    from .check import Checked
    from .project import Project
    from .radiance import Second
    from .solve import Solution


def save(
    project: Project,
    path: str | os.PathLike[str],
    checked: Checked | None = None,
    solution: Solution | None = None,
    *,
    images: dict[str, bytes] | None = None,
    scenes: Mapping[str, Checked] | None = None,
    second: Sequence[Second] = (),
) -> Path:
    """Writes a report: .html, .pdf, or .json for the record alone; .csv for the schedule of luminaires, with one of the
    results beside it whose name ends in -results.csv; .ifc for a building model (see luxfer.design.ifc). Without
    `checked` the project is checked first, and without `scenes` its light scenes are (see Project.check_scenes).
    `second` is a recomputation by Radiance (see luxfer.design.radiance), which the report shows beside its own numbers.
    `images` are PNG files by their captions; without them they are rendered (see pictures.views), and an empty dict
    leaves them out."""
    file = Path(path)
    kind = file.suffix.lower()
    if kind not in (".html", ".pdf", ".json", ".csv", ".ifc"):
        raise ValueError(f"a report is an .html, .pdf, .json, .csv or .ifc file, not {file.name!r}")
    made_of = project.record()
    if kind == ".json":
        return _whole(file, (json.dumps(made_of, indent=1, sort_keys=True) + "\n").encode())
    if checked is None:
        checked = solution.checked if solution is not None else project.check()
    if kind == ".ifc":
        return ifc_write.save(project, file, checked)
    if scenes is None:
        scenes = project.check_scenes()
    if kind == ".csv":
        _whole(file.with_name(f"{file.stem}-results.csv"), schedule.results(checked, scenes).encode())
        return _whole(file, schedule.luminaires(project).encode())
    if images is None:
        images = views(project.room, project.lit(), seed=project.chosen.seed)
    blocks = contents(project, checked, solution, images, scenes, second)
    if kind == ".html":
        return _whole(file, html.page(project.name, blocks).encode())
    footer = f"{project.name}, luxfer {fingerprint.version()}, {fingerprint.digest(made_of)[:16]}"
    return _whole(file, pdf.document(project.name, blocks, footer))


def _whole(file: Path, data: bytes) -> Path:
    """Writes a file whole or not at all."""
    part = file.with_name(f".{file.name}.part")
    try:
        part.write_bytes(data)
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)
    return file
