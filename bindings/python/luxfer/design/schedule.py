"""Schedules of a design as CSV files: its luminaires, and its results, for spreadsheets and other programs."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..photometry import colour_temperature
from .units import factor

if TYPE_CHECKING:
    from .check import Checked
    from .project import Project


def luminaires(project: Project) -> str:
    """One row for each luminaire: product with its reference (such as a GLDF file) and photometry, place, direction,
    dimmer, flux and power, and its dimmer in each light scene. Lengths are in the unit of the project, along the room,
    across it and above the floor; angles are in degrees: of C = 0 in the plan from its horizontal axis clockwise, and
    of the axis from straight down."""
    room, unit = project.room, project.unit
    states = {s.name: [lamp.dimmer for lamp in s.lamps(project.luminaires)] for s in project.scenes}
    head = [
        "number",
        "product",
        "reference",
        "photometry",
        "group",
        f"along_{unit}",
        f"across_{unit}",
        f"height_{unit}",
    ]
    head += ["turn_deg", "tilt_deg", "dimmer", "flux_lm", "power_w", "full_flux_lm", "full_power_w", "ra", "cct_k"]
    rows: list[list[object]] = [[*head, *(f"dimmer in {name}" for name in states)]]
    for index, lamp in enumerate(project.luminaires):
        a, b = (float(v) / factor(unit) for v in room.plan(lamp.position)[0])
        height = (lamp.position[1] - float(room.origin[1])) / factor(unit)
        turn = math.degrees(math.atan2(_dot(lamp.c0, room.across), _dot(lamp.c0, room.along))) % 360
        size = math.sqrt(_dot(lamp.axis, lamp.axis))
        tilt = math.degrees(math.acos(max(-1.0, min(1.0, -lamp.axis[1] / size))))
        p = lamp.product
        kelvin = "" if lamp.colour == (1, 1, 1) else f"{colour_temperature(room.scene.context, lamp.colour)[0]:.0f}"
        place = [f"{v:.6g}" for v in (a, b, height, turn, tilt)]
        light = [f"{lamp.dimmer:.6g}", f"{lamp.flux:.6g}", _known(lamp.watts), f"{p.flux:.6g}", _known(p.watts)]
        row = [index + 1, p.name, p.reference, p.hash, lamp.group, *place, *light, _known(p.rendering), kelvin]
        rows.append([*row, *(f"{shares[index]:.6g}" for shares in states.values())])
    return _text(rows)


def results(checked: Checked, scenes: Mapping[str, Checked] | None = None) -> str:
    """One row for each requirement, with limit, value, interval, confidence and outcome; the requirements of the light
    scenes come after the requirements of the design."""
    rows: list[list[object]] = [
        ["light scene", "area", "quantity", "side", "limit", "value", "low", "high", "unit", "confidence", "outcome"]
        + ["reference", "note"]
    ]
    for name, one in {"": checked, **(scenes or {})}.items():
        for f in one.findings:
            r = f.requirement
            side = "at least" if r.is_minimum else "at most"
            numbers = [f"{v:.6g}" if math.isfinite(v) else "" for v in (f.value, f.low, f.high)]
            row = [name, r.area, r.quantity, side, f"{r.limit:g}", *numbers, r.unit, f"{f.probability:.4g}"]
            rows.append([*row, f.outcome, r.reference, f.note])
    return _text(rows)


def _known(value: float) -> str:
    """A number as text; empty if it is 0, which stands for unknown."""
    return f"{value:.6g}" if value else ""


def _dot(a: tuple[float, float, float], b: object) -> float:
    return float(sum(x * y for x, y in zip(a, b)))  # type: ignore[call-overload]


def _text(rows: list[list[object]]) -> str:
    """CSV by RFC 4180. A text that a spreadsheet would take for a formula gets a space before it."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\r\n")
    writer.writerows([[f" {v}" if isinstance(v, str) and _is_formula(v) else v for v in row] for row in rows])
    return out.getvalue()


def _is_formula(text: str) -> bool:
    """Whether a spreadsheet would compute a text."""
    if not text or text[0] not in "=+-@\t\r":
        return False
    try:
        float(text)
    except ValueError:
        return True
    return False
