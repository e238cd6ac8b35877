"""Requirements of EN 12464-1:2021 for a few well-known places, and requirements of one's own.

The table is short on purpose: it has only rows that manufacturers of luminaires quote publicly with equal values. Only
the text of the standard is binding: check each row against it before you sign. Rules that hold for all places
(surrounding and background areas, uniformities, grids) cite the subject of their clause, because the numbers of clauses
differ between editions.
"""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

STANDARD = "EN 12464-1:2021"

#: Relation of the immediate surrounding area to the task area: mean illuminance of the task from which on a row holds,
#: and the mean illuminance of the surrounding area, both in lux. [convention: EN 12464-1]
SURROUNDING_STEPS = ((750.0, 500.0), (500.0, 300.0), (300.0, 200.0), (200.0, 150.0))
#: Smallest uniformity of surrounding areas; of backgrounds, walls and ceilings. [convention: EN 12464-1]
SURROUNDING_UNIFORMITY, BACKGROUND_UNIFORMITY = 0.4, 0.1
#: Share of the surrounding area's illuminance that its background needs. [convention: EN 12464-1]
BACKGROUND_SHARE = 1 / 3
#: Smallest uniformity of the mean cylindrical illuminance. [convention: EN 12464-1]
CYLINDRICAL_UNIFORMITY = 0.1

#: Fields of a place that may be missing: without them nothing is required.
OPTIONAL = ("cylindrical", "walls", "ceiling", "modified")

#: Quantities that a requirement may limit, with their units.
QUANTITIES = {
    "mean": "lx",
    "uniformity": "",
    "minimum": "lx",
    "diversity": "",
    "modelling": "",
    "glare": "",
    "rendering": "",
    "density": "W/m²",
    "flux": "lm",
    "energy": "kWh/(m² a)",
}
#: Quantities that follow from the light of an area.
OF_AREAS = ("mean", "uniformity", "minimum", "diversity", "modelling")
#: Quantities that a requirement limits on one side only.
ONE_SIDED = {"glare": "at_most", "minimum": "at_least", "diversity": "at_most"}


@dataclass(frozen=True)
class Requirement:
    """A limit for a quantity of an area, a set of observers or the whole design.

    >>> Requirement("mean", "desk", at_least=500, reference="client's brief").limit
    500
    >>> Requirement("lux", "desk", at_least=500)
    Traceback (most recent call last):
    ValueError: 'lux' is no quantity: there are mean, uniformity, minimum, diversity, modelling, glare, ...
    """

    quantity: str
    """What is limited: "mean" illuminance in lux, "uniformity" (smallest over mean illuminance), "minimum"
    (illuminance of the darkest point in lux), "diversity" (largest over smallest illuminance), "modelling" (mean
    cylindrical over mean horizontal illuminance of the same points), "glare" (UGR), "rendering" (Ra of each luminaire),
    "density" (W/m² of the floor), "flux" (lumens of each luminaire) or "energy" (LENI in kWh/m² of a year)."""
    area: str = ""
    """Name of the area or group of observers; empty for limits of the whole design."""
    at_least: float | None = None
    """Lower limit; either this or at_most."""
    at_most: float | None = None
    """Upper limit."""
    reference: str = "own requirement"
    """Source of the limit, as the report prints it."""

    def __post_init__(self) -> None:
        if self.quantity not in QUANTITIES:
            raise ValueError(f"'{self.quantity}' is no quantity: there are {', '.join(QUANTITIES)}")
        if (self.at_least is None) == (self.at_most is None):
            raise ValueError(f"the requirement of {self.quantity} needs either at_least or at_most")
        if not 0 < self.limit < float("inf"):
            raise ValueError(f"the limit of {self.quantity} is {self.limit}; it must be finite and above 0")
        side = ONE_SIDED.get(self.quantity)
        if side and self.is_minimum != (side == "at_least"):
            sides = {"at_least": "no upper limit", "at_most": "no lower limit"}
            raise ValueError(f"a requirement of {self.quantity} has {sides[side]}: use {side}")

    @property
    def limit(self) -> float:
        """The limit, whichever side it bounds."""
        return self.at_most if self.at_least is None else self.at_least  # type: ignore[return-value]

    @property
    def is_minimum(self) -> bool:
        """Whether the quantity must not fall below the limit."""
        return self.at_least is not None

    @property
    def unit(self) -> str:
        """Unit of the limit; empty for numbers without one."""
        return QUANTITIES[self.quantity]

    def __str__(self) -> str:
        sign = "at least" if self.is_minimum else "at most"
        where = f" of {self.area}" if self.area else ""
        return f"{self.quantity}{where} {sign} {self.limit:g} {self.unit}".strip()


@dataclass(frozen=True)
class Place:
    """A row of the standard's tables."""

    number: str
    """Number of the row, such as "34.2"; empty where this package does not state one."""
    name: str
    """Kind of place, task or activity."""
    table: str
    """Number and title of the table."""
    illuminance: float
    """Maintained mean illuminance of the task area in lux (required value)."""
    uniformity: float
    """Uniformity U0 of the task area."""
    glare: float
    """Limit of the unified glare rating."""
    rendering: float
    """Colour rendering index Ra."""
    cylindrical: float
    """Maintained mean cylindrical illuminance in lux, with a uniformity of 0.1."""
    walls: float
    """Maintained mean illuminance of walls in lux, with a uniformity of 0.1."""
    ceiling: float
    """Maintained mean illuminance of the ceiling in lux, with a uniformity of 0.1."""
    modified: float = 0
    """Maintained mean illuminance under the context modifiers of the standard; 0: not stated here."""

    @property
    def reference(self) -> str:
        """The row as a report cites it."""
        row = f", row {self.number}" if self.number else ""
        return f"{STANDARD}, {self.table}{row}"


_OFFICES = "Table 34 (offices)"
_EDUCATION = "Table 44 (educational buildings)"
_LIBRARIES = "table of libraries"

#: The rows that this package knows, all as Glamox publishes them of the edition of 2021. The row of bookshelves is
#: not among them: its 200 lx are vertical illuminance on the shelves, and task areas here are horizontal.
PLACES = (
    Place("34.2", "office: writing, typing, reading, data processing", _OFFICES, 500, 0.6, 19, 80, 150, 150, 100, 1000),
    Place("", "school: entrance halls", _EDUCATION, 200, 0.4, 22, 80, 75, 75, 50, 300),
    Place("", "school: circulation areas, corridors", _EDUCATION, 100, 0.4, 25, 80, 50, 50, 30, 150),
    Place("", "school: stairs", _EDUCATION, 150, 0.4, 25, 80, 50, 50, 30, 200),
    Place("", "library: reading areas", _LIBRARIES, 500, 0.6, 19, 80, 100, 100, 50, 750),
)


def places_from(path: str | os.PathLike[str]) -> tuple[Place, ...]:
    """Rows of a CSV file of your own, for places that this package does not know: its columns have the names of the
    fields of Place, in any order. `name`, `table`, `illuminance`, `uniformity`, `glare` and `rendering` are required.
    The other columns may be missing; their fields are then 0 or empty, which means that nothing is required."""
    file = Path(path)
    with file.open(newline="", encoding="utf-8-sig") as opened:
        rows = list(csv.DictReader(opened))
    known = {f.name: f.default for f in fields(Place)}
    needed = [n for n in known if n not in ("number", *OPTIONAL)]
    found = set(rows[0]) if rows else set()
    unknown, missing = found - set(known), [n for n in needed if n not in found]
    if unknown or missing:
        listed = ", ".join(sorted(map(str, unknown)) or missing)
        what = "columns that are no fields of a place" if unknown else "no column"
        raise ValueError(f"{file.name} has {what}: {listed}; there are {', '.join(known)}")
    out = []
    for number, row in enumerate(rows, 2):
        values: dict[str, Any] = {n: (row.get(n) or "").strip() for n in known}
        for name in [n for n in known if n not in ("number", "name", "table")]:
            try:
                values[name] = float(values[name] or "0")
            except ValueError:
                raise ValueError(
                    f"line {number} of {file.name}: {name} is {values[name]!r}, which is no number"
                ) from None
            if not 0 <= values[name] < math.inf or (values[name] == 0 and name in needed):
                raise ValueError(
                    f"line {number} of {file.name}: {name} is {values[name]:g}; it must be finite and above 0"
                )
        if not values["name"]:
            raise ValueError(f"line {number} of {file.name} has no name")
        out.append(Place(**values))
    return tuple(out)


def place(name: str, among: Sequence[Place] = PLACES) -> Place:
    """The row with a number or a part of a name, of the rows that this package knows or of others (see places_from).

    >>> place("34.2").illuminance, place("writing").glare
    (500, 19)
    >>> place("operating theatre")
    Traceback (most recent call last):
    KeyError: "no place is called 'operating theatre'; give requirements of your own, or one of: 34.2 ...
    """
    found = [p for p in among if p.number == name] or [p for p in among if name.lower() in p.name.lower()]
    if len(found) != 1:
        listed = "; ".join(f"{p.number} {p.name}".strip() for p in (found or among))
        count = "several places are" if found else "no place is"
        raise KeyError(f"{count} called {name!r}; give requirements of your own, or one of: {listed}")
    return found[0]


def surrounding_illuminance(task: float) -> float:
    """Mean illuminance in lux that the immediate surrounding of a task area needs.

    >>> [surrounding_illuminance(lux) for lux in (1000, 750, 500, 300, 200, 150, 100)]
    [500.0, 500.0, 300.0, 200.0, 150.0, 150, 100]
    """
    return next((lux for step, lux in SURROUNDING_STEPS if task >= step), task)


def requirements(row: Place, areas: dict[str, str], modified: bool = False) -> list[Requirement]:
    """The requirements of a place for areas by name and kind: "task", "surrounding", "background", "walls", "ceiling",
    "cylindrical" and "observers". A kind without an area has no requirement, so nothing is computed for it.

    >>> for r in requirements(place("34.2"), {"desk": "task", "around the desk": "surrounding"}): print(r)
    mean of desk at least 500 lx
    uniformity of desk at least 0.6
    mean of around the desk at least 300 lx
    uniformity of around the desk at least 0.4
    rendering at least 80
    """
    if modified and not row.modified:
        raise ValueError(f"no modified illuminance is known here for {row.name!r}")
    task = row.modified if modified else row.illuminance
    around = surrounding_illuminance(task)
    levels = {  # kind: mean illuminance, uniformity, reference
        "task": (task, row.uniformity, row.reference),
        "surrounding": (around, SURROUNDING_UNIFORMITY, f"{STANDARD}, immediate surrounding area"),
        "background": (BACKGROUND_SHARE * around, BACKGROUND_UNIFORMITY, f"{STANDARD}, background area"),
        "walls": (row.walls, BACKGROUND_UNIFORMITY, row.reference),
        "ceiling": (row.ceiling, BACKGROUND_UNIFORMITY, row.reference),
        "cylindrical": (row.cylindrical, CYLINDRICAL_UNIFORMITY, row.reference),
    }
    out = []
    for name, kind in areas.items():
        if kind == "observers":
            out.append(Requirement("glare", name, at_most=row.glare, reference=row.reference))
            continue
        if kind not in levels:
            raise ValueError(f"{name!r} is of the kind {kind!r}: there are {', '.join([*levels, 'observers'])}")
        mean, uniformity, reference = levels[kind]
        if mean == 0:
            continue
        out.append(Requirement("mean", name, at_least=mean, reference=reference))
        out.append(Requirement("uniformity", name, at_least=uniformity, reference=reference))
    return [*out, Requirement("rendering", at_least=row.rendering, reference=row.reference)]
