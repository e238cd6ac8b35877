"""The contents of a report as blocks, which html.py and pdf.py print."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Union

import numpy as np

from ..photometry import colour_temperature
from . import fingerprint, plans
from .check import Checked, Finding, percent
from .drawing import Drawing
from .luminaires import points
from .measure import mean_with_bias
from .energy import ENERGY
from .units import lux, shown

if TYPE_CHECKING:
    from .luminaires import Luminaire
    from .measure import Field
    from .project import Project
    from .radiance import Second
    from .scenes import LightScene
    from .solve import Solution


@dataclass(frozen=True)
class Heading:
    """A heading of level 1 to 2; a new page begins before it if asked."""

    text: str
    level: int = 1
    new_page: bool = False


@dataclass(frozen=True)
class Paragraph:
    """Text; `tone` is "", "good", "bad", "open" or "small"."""

    text: str
    tone: str = ""


@dataclass(frozen=True)
class Table:
    """Rows under a header; widths are shares. The last column is coloured by outcome where it has one."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    widths: tuple[float, ...]
    outcomes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Figure:
    """A drawing or the bytes of a PNG file, with a caption."""

    picture: Drawing | bytes
    caption: str


@dataclass(frozen=True)
class Code:
    """Text as it is."""

    text: str


@dataclass(frozen=True)
class Signature:
    """Lines for date, name and signature."""

    name: str


Block = Union[Heading, Paragraph, Table, Figure, Code, Signature]
OUTCOME_TONES = {"passes": "good", "fails": "bad", "undecided": "open", "unknown": "open"}


def contents(
    project: Project,
    checked: Checked,
    solution: Solution | None = None,
    pictures: dict[str, bytes] | None = None,
    scenes: Mapping[str, Checked] | None = None,
    second: Sequence[Second] = (),
) -> list[Block]:
    """All blocks of a report; `scenes` are the checks of the light scenes by name, and `second` the numbers of
    Radiance."""
    made_of = project.record()
    blocks: list[Block] = [Heading(project.name), *_summary(project, checked, solution, made_of, scenes or {})]
    blocks += [Heading("Requirements", 2), _requirements(checked)]
    blocks += [Paragraph(f"{note[0].upper()}{note[1:]}.", "open") for note in checked.notes]
    blocks.append(Paragraph(_reading(checked), "small"))
    blocks += [
        Heading("Plan", 1, True),
        Figure(
            plans.plan(project.room, project.luminaires, project.areas, project.observers, project.unit),
            _plan_caption(project),
        ),
    ]
    blocks += [Heading("Luminaires", 2), *_luminaires(project)]
    blocks += _glare(project, checked)
    blocks += _areas(project, checked)
    blocks += _scenes(project, scenes or {})
    if pictures:
        blocks.append(Heading("Pictures", 1, True))
        blocks += [Figure(data, caption) for caption, data in pictures.items()]
    blocks += [Heading("Basis of the calculation", 1, True), *_basis(project, checked)]
    blocks += _seconds(second)
    blocks += [Heading("To make this report again", 2), *_again(made_of)]
    blocks += [Heading("Signature", 2), Signature(project.author)]
    return blocks


def _summary(
    project: Project, checked: Checked, solution: Solution | None, made_of: dict, scenes: Mapping[str, Checked]
) -> list[Block]:
    room, lamps = project.room, project.luminaires
    tone = _tone(checked)
    verdict = checked.verdict()
    watts = [lamp.product.watts for lamp in lamps]
    power = sum(lamp.watts for lamp in lamps)
    known = all(w > 0 for w in watts)
    length = lambda v: f"{shown(v, project.unit)} {project.unit}"  # noqa: E731
    rows = [
        (
            "Room",
            f"{length(room.length)} × {length(room.width)} × {length(room.height)}, floor {room.floor_area:.1f} m²",
        ),
        ("Maintenance factor", f"{project.chosen.maintenance:g}"),
        ("Confidence of each result", percent(project.chosen.confidence)),
        (
            "Luminaires",
            f"{sum(1 for lamp in lamps if lamp.flux > 0)} in use, {sum(lamp.flux for lamp in lamps):,.0f} lm as dimmed",
        ),
        ("Power", f"{power:.0f} W, {power / room.floor_area:.2f} W/m²" if known else "not stated for all luminaires"),
    ]
    if solution is not None:
        rows.append(("Change of the look", str(solution.look)))
    rows.append(("Hash", fingerprint.digest(made_of)))
    said: list[Block] = [Paragraph(verdict[0].upper() + verdict[1:] + ".", tone)]
    if solution is not None and not solution.feasible:
        why = solution.explanation()
        closest = " The dimmers below come closest." if solution.contradictory else ""
        said.append(Paragraph(f"{why[0].upper()}{why[1:]}.{closest}", "bad" if solution.contradictory else "open"))
    for name, one in scenes.items():
        words = one.verdict()
        said.append(Paragraph(f"Light scene {name}: {words}.", _tone(one)))
    return [*said, Table(("", ""), tuple(rows), (0.28, 0.72))]


def _tone(checked: Checked) -> str:
    """The tone of a verdict."""
    return "good" if checked.passes else "bad" if any(f.outcome == "fails" for f in checked.findings) else "open"


def _scenes(project: Project, scenes: Mapping[str, Checked]) -> list[Block]:
    """The light scenes with their energy, and for each with requirements its check and the light of its areas."""
    if not project.scenes:
        return []
    out: list[Block] = [Heading("Light scenes", 1, True), _states(project, scenes), *_leni(project)]
    for state in project.scenes:
        if state.name not in scenes:
            continue
        found, here = scenes[state.name], project.in_scene(state.name)
        out += [
            Heading(f"Light scene: {state.name}", 1, True),
            Paragraph(found.verdict()[0].upper() + found.verdict()[1:] + ".", _tone(found)),
            _requirements(found),
            *(Paragraph(f"{note[0].upper()}{note[1:]}.", "open") for note in found.notes),
            Paragraph(_state_basis(here, state), "small"),
            *_glare(here, found),
            *_areas(here, found, False),
        ]
    return out


def _seconds(second: Sequence[Second]) -> list[Block]:
    """The numbers of Radiance beside the numbers of this package."""
    if not second:
        return []
    rows = []
    for s in second:
        r = s.finding.requirement
        change = f"{100 * s.difference:+.1f} %" if math.isfinite(s.difference) else "–"
        ours, theirs = _found(s.finding), _number(s.value, r.unit)
        rows.append((str(r), ours, theirs, change, "confirmed" if s.confirms else "not confirmed"))
    header = ("Requirement", "Found [interval]", "By Radiance", "Difference", "Result")
    tones = tuple("passes" if s.confirms else "fails" for s in second)
    return [
        Heading("Recomputed by Radiance", 2),
        Table(header, tuple(rows), (0.36, 0.22, 0.14, 0.12, 0.16), tones),
        Paragraph(
            "Room, luminaires and points were written to files, from which Radiance (ies2rad, oconv, rtrace) computed "
            "the illuminance with matte surfaces of equal reflectance. A requirement is confirmed if Radiance's number "
            "decides it as this report does. Radiance's numbers are random, too.",
            "small",
        ),
    ]


def _state_basis(here: Project, state: LightScene) -> str:
    """The part of the light from which a light scene is computed."""
    light = "only the light straight from the luminaires counts, without reflections" if state.direct else ""
    factor = f"maintenance factor {here.chosen.maintenance:g}"
    text = "; ".join(part for part in (light, factor) if part)
    return f"{text[0].upper()}{text[1:]}."


def _states(project: Project, scenes: Mapping[str, Checked]) -> Table:
    """The light scenes with their dimmers, power and use."""
    rows, used = [], project.energy()
    energies = {u.name: u.energy for u in used.uses} if used else {}
    for state in project.scenes:
        lamps = state.lamps(project.luminaires)
        lit = [lamp for lamp in lamps if lamp.flux > 0]
        known = all(lamp.product.watts > 0 for lamp in lit)
        watts = sum(lamp.watts for lamp in lit)
        density = f"{watts / project.room.floor_area:.2f}"
        hours = f"{state.hours.day:g} + {state.hours.night:g}" if state.hours else "–"
        found = scenes.get(state.name)
        result = "–" if found is None else "passes" if found.passes else "does not pass"
        rows.append(
            (
                state.name,
                _dimmers(lamps),
                f"{sum(lamp.flux for lamp in lit):.0f}",
                f"{watts:.1f}" if known else "–",
                density if known else "–",
                hours,
                f"{energies[state.name]:.0f}" if known and state.name in energies else "–",
                result,
            )
        )
    header = ("Light scene", "Dimmers", "lm", "W", "W/m²", "Hours by day + night", "kWh a year", "Result")
    return Table(header, tuple(rows), (0.18, 0.26, 0.09, 0.08, 0.08, 0.12, 0.09, 0.1))


def _dimmers(lamps: Sequence[Luminaire]) -> str:
    """The dimmers by group, or by number where luminaires have none."""
    shares: dict[str, list[float]] = {}
    for number, lamp in enumerate(lamps, 1):
        shares.setdefault(lamp.group or f"No. {number}", []).append(lamp.dimmer)
    if len({lamp.dimmer for lamp in lamps}) == 1:
        return f"all {100 * lamps[0].dimmer:.3g} %"
    parts = []
    for name, values in shares.items():
        low, high = min(values), max(values)
        parts.append(f"{name} {100 * low:.3g} %" if low == high else f"{name} {100 * low:.3g} to {100 * high:.3g} %")
    return ", ".join(parts)


def _leni(project: Project) -> list[Block]:
    """The energy of a year."""
    used = project.energy()
    if used is None:
        return []
    if math.isnan(used.leni):
        return [Heading("Energy", 2), Paragraph("LENI is unknown: luminaires have no stated power.", "open")]
    rows = [
        (u.name, f"{u.watts:.1f}", *(f"{v:g}" for v in (u.hours.day, u.hours.night)))
        + tuple(f"{v:g}" for v in (u.hours.daylight, u.hours.occupancy, u.hours.constant))
        + (f"{u.energy:.1f}",)
        for u in used.uses
    ]
    rows.append(("standby and charging", "", "", "", "", "", "", f"{used.parasitic:.1f}"))
    rows.append(("all", "", "", "", "", "", "", f"{used.lighting + used.parasitic:.1f}"))
    header = ("Light scene", "W", "t_D in h", "t_N in h", "F_D", "F_O", "F_C", "kWh a year")
    total = f"LENI = {used.leni:.2f} kWh/(m² a) for {used.floor_area:.1f} m², by {ENERGY}."
    return [
        Heading("Energy", 2),
        Paragraph(total),
        Table(header, tuple(rows), (0.24, 0.1, 0.11, 0.11, 0.09, 0.09, 0.09, 0.17)),
        Paragraph(
            "W F_C F_O (t_D F_D + t_N) / 1000 for each light scene; the design's author states the hours and factors.",
            "small",
        ),
    ]


def _number(value: float, unit: str) -> str:
    if math.isnan(value):
        return "unknown"
    if math.isinf(value):
        return "none" if value < 0 else "unlimited"
    digits = 1 if unit in ("", "lx") and abs(value) >= 2 else 2
    if abs(value) >= 100 or unit == "lx" and value == round(value):
        digits = 0
    return f"{value:.{digits}f} {unit}".strip()


def _found(f: Finding) -> str:
    unit = f.requirement.unit
    if f.high > f.low:
        return f"{_number(f.value, unit)} [{_number(f.low, '')}, {_number(f.high, '')}]"
    return _number(f.value, unit)


def _requirements(checked: Checked) -> Table:
    rows = []
    for f in checked.findings:
        r = f.requirement
        quantity = {
            "mean": "Em",
            "uniformity": "U0",
            "minimum": "smallest E",
            "diversity": "largest over smallest E",
            "modelling": "modelling Ez / Eh",
            "glare": "UGR",
            "rendering": "Ra",
            "density": "power per area",
            "flux": "flux per luminaire",
            "energy": "LENI",
        }[r.quantity]
        if r.quantity != "modelling" and r.area in checked.fields and checked.fields[r.area].area.kind == "cylindrical":
            quantity += " cylindrical"
        limit = f"{'≥' if r.is_minimum else '≤'} {_number(r.limit, r.unit)}"
        result = {
            "passes": f"passes, {percent(f.probability, f.samples == 0)}",
            "fails": f"fails{f.missed_by(' by ')}",
        }
        note = f" ({f.note})" if f.note else ""
        rows.append(
            (r.area or "design", quantity, limit, _found(f), r.reference + note, result.get(f.outcome, f.outcome))
        )
    header = ("Area", "Quantity", "Required", "Found [interval]", "Reference", "Result")
    return Table(header, tuple(rows), (0.16, 0.1, 0.12, 0.22, 0.24, 0.16), tuple(f.outcome for f in checked.findings))


def _reading(checked: Checked) -> str:
    s = checked.settings
    return (
        f"Illuminances are maintained values, those at the start times {s.maintenance:g}; glare is rated at the "
        f"start. Intervals contain the computed quantity with {100 * (2 * s.look_confidence - 1):.1f} %. "
        f"A requirement passes if it holds with at least {percent(s.confidence)} over all looks at the paths; the "
        "percentage is the confidence of the deciding look. They cover the randomness of the calculation, not errors "
        "of the model: geometry, reflectances, photometry and maintenance are taken as given."
    )


def _plan_caption(project: Project) -> str:
    return (
        "Luminaires with their numbers, areas with their names, observers of glare as arrows along their lines of "
        "sight. "
        f"Lengths in {project.unit}."
    )


def _luminaires(project: Project) -> list[Block]:
    names: dict[str, str] = {}
    for lamp in project.luminaires:
        if (key := _key(lamp)) not in names:
            names[key] = chr(ord("A") + len(names)) if len(names) < 26 else f"P{len(names) + 1}"
    return [
        _products(project, names),
        _positions(project, names),
        Paragraph(
            "Positions are along the room, across it, and above the floor, from the corner at the top left of the "
            "plan. Flux and power are as dimmed, power in proportion to flux. K: colour temperature where the design "
            "gives the light a colour, such as that of a photo.",
            "small",
        ),
    ]


def _key(lamp: Luminaire) -> str:
    """Properties that the luminaires of one product share."""
    return f"{lamp.product.name}\0{lamp.product.hash}\0{lamp.product.flux}"


def _products(project: Project, names: Mapping[str, str]) -> Table:
    """The products, each once, by the names that the positions refer to."""
    products = {_key(lamp): lamp.product for lamp in reversed(project.luminaires)}
    rows = []
    for key, name in names.items():
        p = products[key]
        power = f"{p.watts:.1f} W, {p.flux / p.watts:.0f} lm/W" if p.watts > 0 else "not stated"
        size = " × ".join(shown(abs(v), project.unit) for v in p.size) + f" {project.unit}"
        rendering = f"{p.rendering:g}" if p.rendering else "not stated"
        title = f"{p.name} ({p.reference})" if p.reference else p.name
        rows.append((name, title, f"{p.flux:.0f} lm", power, rendering, size, p.hash))
    header = ("", "Product", "Flux", "Power", "Ra", "Opening", "Photometry")
    return Table(header, tuple(rows), (0.05, 0.25, 0.1, 0.2, 0.1, 0.18, 0.12))


def _positions(project: Project, names: Mapping[str, str]) -> Table:
    """The luminaires one by one, with their sums."""
    unit, room, lamps = project.unit, project.room, project.luminaires
    rows = []
    for number, lamp in enumerate(lamps, 1):
        a, b = room.plan(lamp.position)[0]
        height = lamp.position[1] - room.origin[1]
        place = ", ".join(shown(v, unit) for v in (float(a), float(b), float(height)))
        kelvin = "–" if lamp.colour == (1, 1, 1) else f"{colour_temperature(room.scene.context, lamp.colour)[0]:.0f}"
        watts = f"{lamp.watts:.1f}" if lamp.product.watts > 0 else "–"
        rows.append(
            (str(number), names[_key(lamp)], place, f"{100 * lamp.dimmer:.1f} %", f"{lamp.flux:.0f}", watts, kelvin)
        )
    flux, power = sum(lamp.flux for lamp in lamps), sum(lamp.watts for lamp in lamps)
    rows.append(("", "all", "", "", f"{flux:.0f}", f"{power:.1f}", ""))
    header = ("No.", "Product", f"Position in {unit}", "Dimmer", "lm", "W", "K")
    return Table(header, tuple(rows), (0.08, 0.12, 0.34, 0.13, 0.12, 0.11, 0.1))


def _areas(project: Project, checked: Checked, new_page: bool = True) -> list[Block]:
    out: list[Block] = []
    for index, (name, found) in enumerate(checked.fields.items()):
        first = index == 0 and new_page
        out.append(Heading(f"Area: {name}", 1 if first else 2, first))
        out.append(_area_table(project, found, checked))
        if found.area.kind == "escape line":  # its row of points is too thin to draw
            continue
        title = "Maintained cylindrical illuminance" if found.area.kind == "cylindrical" else "Maintained illuminance"
        where = (
            "of the walls: those along the upper and lower side of the plan above, those along its left and right "
            "side below"
            if found.area.kind == "walls"
            else f"{shown(found.area.height, project.unit)} {project.unit} above the floor"
        )
        out.append(
            Figure(
                plans.field(project.room, found, project.unit),
                f"{title} in lx, {where}. Black lines join points of equal illuminance, as marked on the scale.",
            )
        )
    return out


def _area_table(project: Project, found: Field, checked: Checked) -> Table:
    level = 2 * checked.settings.look_confidence - 1
    mean, bias = mean_with_bias(found)
    low, high = mean.interval(level)
    u = found.uniformity
    ulow, uhigh = u.interval(level)
    patch = found.area.patches[0]
    steps = [float(np.linalg.norm(patch.across)) / patch.columns, float(np.linalg.norm(patch.down)) / patch.rows]
    spacing = " × ".join(shown(v, project.unit) for v in steps) + f" {project.unit}"
    row = (
        str(found.area.count),
        str(found.area.left_out),
        spacing,
        f"{lux(mean.value)} [{lux(low - bias)}, {lux(high + bias)}]",
        f"{lux(found.values.min())} ± {lux(found.errors[found.values.argmin()] * 1.96)}",
        lux(found.values.max()),
        f"{u.value:.2f} [{ulow:.2f}, {uhigh:.2f}]",
    )
    header = ("Points", "Left out", "Spacing", "Mean in lx", "Least in lx", "Most in lx", "U0")
    return Table(header, (row,), (0.09, 0.1, 0.22, 0.2, 0.13, 0.11, 0.15))


def _glare(project: Project, checked: Checked) -> list[Block]:
    if not checked.ratings:
        return []
    level, unit, room = 2 * checked.settings.look_confidence - 1, project.unit, project.room
    rows = []
    groups = {o.name: o for o in project.observers}
    for name, ratings in checked.ratings.items():
        for eye, view, rating in zip(groups[name].positions, groups[name].directions, ratings):
            a, b = room.plan(eye)[0]
            angle = math.degrees(math.atan2(view @ room.across, view @ room.along)) % 360
            low, high = rating.interval(level)
            place = ", ".join(shown(v, unit) for v in (float(a), float(b), float(eye[1] - room.origin[1])))
            rows.append(
                (
                    name,
                    place,
                    f"{angle:.0f}°",
                    f"{rating.background.value:.1f}",
                    f"{_number(rating.ugr, '')} [{_number(low, '')}, {_number(high, '')}]"
                    if math.isfinite(rating.ugr)
                    else "none in view",
                )
            )
    header = ("Observers", f"Eye in {unit}", "Towards", "Background in cd/m²", "UGR")
    return [
        Heading("Glare", 2),
        Table(header, tuple(rows), (0.25, 0.27, 0.12, 0.18, 0.18)),
        Paragraph(
            "Unified glare rating of CIE 117 with initial flux; directions are angles in the plan from its "
            "horizontal axis "
            "clockwise.",
            "small",
        ),
    ]


def _basis(project: Project, checked: Checked) -> list[Block]:
    s = checked.settings
    said = [
        "Light is computed by path tracing of the whole scene with furniture, all reflections included; without "
        "daylight.",
        f"Each point has {s.samples} to {s.max_samples} paths, in up to {s.looks} looks; each look spends an equal "
        f"share of the error of "
        f"{100 * (1 - s.confidence):.3g} %. A uniformity passes if each of its points does.",
        "Grids follow EN 12464-1: spacing 0.2 · 5^log10(d), at most 10 m. Points inside objects, under furniture "
        "(of the background) and "
        "on windows and objects at walls are left out; the tables count them.",
        "Cylindrical illuminance is the mean of 9 vertical planes around each point, within 1.02 %, which its "
        "interval includes.",
        "Rows of the standard are an excerpt: check them against its text. Ra is the manufacturer's statement.",
    ]
    said.append(
        "Luminaires shine from the faces of their luminous openings, with their measured distribution; the faces "
        "reflect no light."
    )
    said += points(project.luminaires)
    return [Paragraph(text) for text in said]


def _again(made_of: dict) -> list[Block]:
    keep = {
        k: v
        for k, v in made_of.items()
        if k in ("form", "luxfer", "scene", "settings", "areas", "observers", "standby")
    }
    lamps: Sequence[dict] = made_of["luminaires"]
    keep["photometry"] = sorted({lamp["photometry"] for lamp in lamps})
    return [
        Paragraph(
            "The same scene, photometry, settings and version of the library give the same numbers to the bit on "
            "one kind of "
            "processor. The hash on the first page is that of the whole record, of which this is the part that is "
            "not in the "
            "tables."
        ),
        Code(json.dumps(keep, indent=1)),
    ]
