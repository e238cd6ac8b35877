"""Writes a design as an IFC 4 file (see ifc.py). Equal designs give equal files."""

from __future__ import annotations

import math
import os
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..photometry import colour_temperature
from . import fingerprint
from .ifc_photometry import table, upright

if TYPE_CHECKING:
    from .check import Checked, Finding
    from .luminaires import Luminaire, Product
    from .project import Project

#: Colour temperature in kelvin of light without a stated colour, which the format demands. [convention]
UNSTATED = 4000.0
#: Height in metres of the body of a lighting zone, and of a luminaire without height. [convention]
ZONE_HEIGHT, BODY_HEIGHT = 0.01, 0.05
#: Folder of the photometric files, beside the model.
FOLDER = "photometry"
#: Name space of the identifiers, which follow from the names of the parts.
SPACE = uuid.UUID("6f1d9c52-3a77-4c0e-9a4b-0d1f5a1c7e21")
#: Names of the property sets that only this package defines, for a fixture and for its type.
OWN, OWN_TYPE = "Luxfer_Luminaire", "Luxfer_LightFixture"
#: Types of values of results by their units.
VALUES = {"lx": "IfcIlluminanceMeasure", "lm": "IfcLuminousFluxMeasure"}


def save(project: Project, path: str | os.PathLike[str], checked: Checked | None = None) -> Path:
    """Writes a design, with the results of a check if there is one, and its photometric files in a folder beside it."""
    file = Path(path)
    if file.suffix.lower() != ".ifc":
        raise ValueError(f"a building model is an .ifc file, not {file.name!r}")
    model = _Writer(project)
    model.design(checked)
    folder = file.parent / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for product in {lamp.product.hash: lamp.product for lamp in project.luminaires}.values():
        (folder / _file(product)).write_bytes(product.photometry)
    part = file.with_name(f".{file.name}.part")
    try:
        part.write_text(model.file.to_string(), encoding="utf-8")
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)
    return file


def _file(product: Product) -> str:
    return f"{product.hash}.{product.format}"


class _Writer:
    """A file that grows."""

    def __init__(self, project: Project) -> None:
        try:
            import ifcopenshell
            import ifcopenshell.guid
        except ImportError as error:
            raise ImportError("building models need ifcopenshell: pip install 'luxfer[ifc]'") from error
        self.compress = ifcopenshell.guid.compress
        self.file = ifcopenshell.file(schema="IFC4")
        self.project = project
        header = self.file.header
        # Without the time, equal designs give equal files.
        header.file_name.time_stamp, header.file_name.name = "1970-01-01T00:00:00", project.name
        header.file_name.originating_system = f"luxfer {fingerprint.version()}"
        header.file_name.author = (project.author,)

    def add(self, kind: str, **values: Any) -> Any:
        """Adds an entity."""
        return self.file.create_entity(kind, **values)

    def root(self, kind: str, key: str, **values: Any) -> Any:
        """Adds an entity with an identifier that follows from its key."""
        return self.add(
            kind, GlobalId=self.compress(uuid.uuid5(SPACE, f"{self.project.name}/{kind}/{key}").hex), **values
        )

    def design(self, checked: Checked | None) -> None:
        """Adds everything."""
        self._context()
        room = self.project.room
        space = self._space()
        self._requirement(space)
        zones = [self._zone(a) for a in self.project.areas if a.kind == "task"]
        types = self._types()
        fixtures = [self._fixture(n, lamp, types) for n, lamp in enumerate(self.project.luminaires, 1)]
        if fixtures:
            self.root(
                "IfcRelContainedInSpatialStructure", "fixtures", RelatedElements=fixtures, RelatingStructure=space
            )
            for key, kind in types.items():
                of = [f for f, lamp in zip(fixtures, self.project.luminaires) if _key(lamp.product) == key]
                self.root("IfcRelDefinesByType", key, RelatedObjects=of, RelatingType=kind)
        if zones:
            self.root("IfcRelReferencedInSpatialStructure", "zones", RelatedElements=zones, RelatingStructure=space)
        areas = {z.Name: z for z in zones}
        if checked is not None:
            for name in dict.fromkeys(f.requirement.area for f in checked.findings):
                rows = [f for f in checked.findings if f.requirement.area == name]
                self._results(areas.get(name, space), name, rows)
            made = {
                "Hash": ("IfcText", fingerprint.digest(self.project.record())),
                "Verdict": ("IfcText", checked.verdict()),
            }
            made["MaintenanceFactor"] = ("IfcReal", checked.settings.maintenance)
            self._properties(space, "Luxfer_LightingDesign", made)
        self._properties(
            space,
            "Luxfer_Room",
            {"FloorArea": ("IfcAreaMeasure", room.floor_area), "Height": ("IfcLengthMeasure", room.height)},
        )

    def _context(self) -> None:
        """Project, units, building and storey."""
        si = lambda kind, name: self.add("IfcSIUnit", UnitType=kind, Name=name)  # noqa: E731
        units = [si("LENGTHUNIT", "METRE"), si("AREAUNIT", "SQUARE_METRE"), si("POWERUNIT", "WATT")]
        units += [si("LUMINOUSFLUXUNIT", "LUMEN"), si("ILLUMINANCEUNIT", "LUX"), si("LUMINOUSINTENSITYUNIT", "CANDELA")]
        units += [si("THERMODYNAMICTEMPERATUREUNIT", "KELVIN")]
        radian = si("PLANEANGLEUNIT", "RADIAN")
        per = self.add(
            "IfcMeasureWithUnit",
            ValueComponent=self._typed("IfcPlaneAngleMeasure", math.pi / 180),
            UnitComponent=radian,
        )
        none = self.file.create_entity("IfcDimensionalExponents", 0, 0, 0, 0, 0, 0, 0)
        units.append(
            self.add(
                "IfcConversionBasedUnit",
                Dimensions=none,
                UnitType="PLANEANGLEUNIT",
                Name="DEGREE",
                ConversionFactor=per,
            )
        )
        self.context = self.add(
            "IfcGeometricRepresentationContext",
            ContextType="Model",
            CoordinateSpaceDimension=3,
            Precision=1e-6,
            WorldCoordinateSystem=self._frame((0, 0, 0)),
        )
        self.top = self.root(
            "IfcProject",
            "project",
            Name=self.project.name,
            RepresentationContexts=[self.context],
            UnitsInContext=self.add("IfcUnitAssignment", Units=units),
        )
        place = self._placed(self._frame((0, 0, 0)))
        site = self.root("IfcSite", "site", Name="Site", ObjectPlacement=place)
        building = self.root("IfcBuilding", "building", Name="Building", ObjectPlacement=place)
        self.storey = self.root("IfcBuildingStorey", "storey", Name="Storey", ObjectPlacement=place)
        for above, below in ((self.top, site), (site, building), (building, self.storey)):
            self._within(above, [below])

    def _within(self, above: Any, below: Sequence[Any]) -> None:
        self.root("IfcRelAggregates", f"{above.is_a()}", RelatingObject=above, RelatedObjects=list(below))

    def _typed(self, kind: str, value: Any) -> Any:
        return self.file.create_entity(kind, value)

    def _point(self, p: Sequence[float] | NDArray) -> Any:
        return self.add("IfcCartesianPoint", Coordinates=tuple(float(v) for v in p))

    def _direction(self, d: Sequence[float] | NDArray) -> Any:
        return self.add("IfcDirection", DirectionRatios=tuple(float(v) for v in d))

    def _frame(self, at: Sequence[float] | NDArray, z: Any = (0, 0, 1), x: Any = (1, 0, 0)) -> Any:
        return self.add(
            "IfcAxis2Placement3D", Location=self._point(at), Axis=self._direction(z), RefDirection=self._direction(x)
        )

    def _placed(self, frame: Any) -> Any:
        return self.add("IfcLocalPlacement", RelativePlacement=frame)

    def _box(self, a: tuple[float, float], b: tuple[float, float], low: float, height: float) -> Any:
        """A box over a rectangle of the plan, in the frame of its placement."""
        centre = self.add("IfcAxis2Placement2D", Location=self._point(((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)))
        sides = {"XDim": abs(b[0] - a[0]), "YDim": abs(b[1] - a[1])}
        profile = self.add("IfcRectangleProfileDef", ProfileType="AREA", Position=centre, **sides)
        solid = self.add(
            "IfcExtrudedAreaSolid",
            SweptArea=profile,
            Position=self._frame((0, 0, low)),
            ExtrudedDirection=self._direction((0, 0, 1)),
            Depth=height,
        )
        return self._shown("Body", "SweptSolid", solid)

    def _shown(self, name: str, kind: str, item: Any) -> Any:
        return self.add(
            "IfcShapeRepresentation",
            ContextOfItems=self.context,
            RepresentationIdentifier=name,
            RepresentationType=kind,
            Items=[item],
        )

    def _shape(self, *shown: Any) -> Any:
        return self.add("IfcProductDefinitionShape", Representations=list(shown))

    def _plan_frame(self) -> Any:
        """The frame of the room's plan: x along the room, y against its across axis, z up."""
        room = self.project.room
        return self._placed(self._frame(upright(room.origin), (0, 0, 1), upright(room.along)))

    def _space(self) -> Any:
        room = self.project.room
        space = self.root(
            "IfcSpace",
            "space",
            Name=self.project.name,
            ObjectPlacement=self._plan_frame(),
            Representation=self._shape(self._box((0, -room.width), (room.length, 0), 0, room.height)),
            CompositionType="ELEMENT",
            PredefinedType="INTERNAL",
        )
        self._within(self.storey, [space])
        return space

    def _requirement(self, space: Any) -> None:
        """The largest required mean illuminance of a task area, in the standard's property set."""
        tasks = {a.name for a in self.project.areas if a.kind == "task"}
        asked = [
            r.limit for r in self.project.requirements if r.quantity == "mean" and r.is_minimum and r.area in tasks
        ]
        values = {"ArtificialLighting": ("IfcBoolean", True)}
        if asked:
            values["Illuminance"] = ("IfcIlluminanceMeasure", float(max(asked)))
        self._properties(space, "Pset_SpaceLightingRequirements", values)

    def _zone(self, area: Any) -> Any:
        ((a0, b0, a1, b1),) = area.outline
        return self.root(
            "IfcSpatialZone",
            area.name,
            Name=area.name,
            ObjectPlacement=self._plan_frame(),
            Representation=self._shape(self._box((a0, -b1), (a1, -b0), area.height, ZONE_HEIGHT)),
            PredefinedType="LIGHTING",
        )

    def _types(self) -> dict[str, Any]:
        """A type for each product, with its power, flux and photometric file."""
        out = {}
        for product in {_key(lamp.product): lamp.product for lamp in self.project.luminaires}.values():
            key = _key(product)
            kind = self.root("IfcLightFixtureType", key, Name=product.name, PredefinedType="NOTDEFINED")
            kind.Tag = product.reference or None
            document = self.add(
                "IfcDocumentReference",
                Location=f"{FOLDER}/{_file(product)}",
                Identification=product.hash,
                Name="photometry",
            )
            self.root("IfcRelAssociatesDocument", key, RelatedObjects=[kind], RelatingDocument=document)
            values: dict[str, tuple[str, Any]] = {"LuminousFlux": ("IfcLuminousFluxMeasure", product.flux)}
            if product.rendering:
                values["ColourRenderingIndex"] = ("IfcReal", product.rendering)
            sets = [self._set(f"{key} luxfer", OWN_TYPE, values)]
            if product.watts:
                power = {"TotalWattage": ("IfcPowerMeasure", product.watts)}
                sets.append(self._set(f"{key} common", "Pset_LightFixtureTypeCommon", power))
            kind.HasPropertySets = sets
            out[key] = kind
        return out

    def _fixture(self, number: int, lamp: Luminaire, types: Mapping[str, Any]) -> Any:
        up, first = -upright(lamp.axis), upright(lamp.c0)
        first = first - (first @ up) * up / (up @ up)
        frame = self._frame(upright(lamp.position), up / np.linalg.norm(up), first / np.linalg.norm(first))
        length, width, height = (abs(v) for v in lamp.product.size)
        length, width = length or width or 2 * BODY_HEIGHT, width or length or 2 * BODY_HEIGHT
        body = self._box((-length / 2, -width / 2), (length / 2, width / 2), 0, height or BODY_HEIGHT)
        light = self._shown("Lighting", "LightSource", self._source(lamp))
        fixture = self.root(
            "IfcLightFixture",
            str(number),
            Name=f"{number}",
            ObjectType=lamp.product.name,
            ObjectPlacement=self._placed(frame),
            Representation=self._shape(body, light),
        )
        values = {
            "Dimmer": ("IfcReal", float(lamp.dimmer)),
            "LuminousFlux": ("IfcLuminousFluxMeasure", float(lamp.flux)),
        }
        if lamp.group:
            values["Group"] = ("IfcLabel", lamp.group)
        self._properties(fixture, OWN, values)
        return fixture

    def _source(self, lamp: Luminaire) -> Any:
        """The light of a luminaire as dimmed, which shines along -z with C = 0 along x."""
        planes, angles, values = table(self.project.room, lamp)
        rows = [
            self.add(
                "IfcLightDistributionData", MainPlaneAngle=c, SecondaryPlaneAngle=angles, LuminousIntensity=row.tolist()
            )
            for c, row in zip(planes, values)
        ]
        data = self.add("IfcLightIntensityDistribution", LightDistributionCurve="TYPE_C", DistributionData=rows)
        white = tuple(lamp.colour) == (1, 1, 1)
        kelvin = UNSTATED if white else colour_temperature(self.project.room.scene.context, lamp.colour)[0]
        peak = max(lamp.colour)
        names = zip(("Red", "Green", "Blue"), lamp.colour)
        return self.add(
            "IfcLightSourceGoniometric",
            LightColour=self.add("IfcColourRgb", **{n: float(v) / peak for n, v in names}),
            Position=self._frame((0, 0, 0)),
            ColourTemperature=float(kelvin),
            LuminousFlux=float(lamp.flux),
            LightEmissionSource="NOTDEFINED",
            LightDistributionDataSource=data,
        )

    def _set(self, key: str, name: str, values: Mapping[str, tuple[str, Any]]) -> Any:
        """A property set."""
        rows = [
            self.add("IfcPropertySingleValue", Name=n, NominalValue=self._typed(k, v)) for n, (k, v) in values.items()
        ]
        return self.root("IfcPropertySet", f"{key}/{name}", Name=name, HasProperties=rows)

    def _properties(self, of: Any, name: str, values: Mapping[str, tuple[str, Any]]) -> None:
        made = self._set(of.GlobalId, name, values)
        self.root(
            "IfcRelDefinesByProperties", f"{of.GlobalId}/{name}", RelatedObjects=[of], RelatingPropertyDefinition=made
        )

    def _results(self, of: Any, name: str, findings: Sequence[Finding]) -> None:
        """The results of an area: each with its interval, limit and outcome."""
        rows = []
        for f in findings:
            kind = VALUES.get(f.requirement.unit, "IfcReal")
            ends = {"SetPointValue": f.value, "LowerBoundValue": f.low, "UpperBoundValue": f.high}
            known = {k: self._typed(kind, float(v)) for k, v in ends.items() if math.isfinite(v)}
            label = f"{f.requirement}"
            if known:
                rows.append(
                    self.add("IfcPropertyBoundedValue", Name=label, Description=f.requirement.reference, **known)
                )
            outcome = self._typed("IfcLabel", f.outcome)
            rows.append(self.add("IfcPropertySingleValue", Name=f"{label}: outcome", NominalValue=outcome))
        key = f"{name or 'design'}: lighting results"
        made = self.root("IfcPropertySet", key, Name=f"Luxfer_Results {name}".strip(), HasProperties=rows)
        self.root("IfcRelDefinesByProperties", key, RelatedObjects=[of], RelatingPropertyDefinition=made)


def _key(product: Product) -> str:
    """Properties that the luminaires of one product share."""
    return f"{product.name}/{product.hash}/{product.flux:g}"
