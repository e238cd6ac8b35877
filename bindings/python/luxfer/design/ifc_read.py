"""Reads spaces and light fixtures of IFC files (see ifc.py)."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..photometry import LUMINAIRES
from ..scene import Scene
from . import areas
from .ifc_photometry import flux, ies, level
from .ifc_write import OWN, OWN_TYPE
from .luminaires import Luminaire, Product
from .rooms import Room

if TYPE_CHECKING:
    from ..context import Context
    from .areas import Area

#: Reflectances of ceilings, walls, floors and furniture, if none are given. [convention: EN 12464-1]
REFLECTANCES = (0.7, 0.5, 0.2, 0.4)
#: A face whose normal has at least this vertical share is a floor or a ceiling. [convention]
FLAT = 0.9
#: Fixtures of a storey belong to a space if they lie in its box, up to this distance in metres: ceilings hide some.
#: [convention]
NEAR = 0.3
#: Luminaires lie at least this far below the ceiling, in metres, so that it does not hide their light. [convention]
BELOW = 0.005


@dataclass(frozen=True)
class Building:
    """The data read from a space."""

    room: Room
    """The space, with its furniture."""
    luminaires: tuple[Luminaire, ...]
    """Its light fixtures that have photometry, as dimmed by a design of this package, otherwise at full flux."""
    areas: tuple[Area, ...]
    """Its lighting zones as task areas."""
    name: str
    """Name of the space."""
    illuminance: float
    """Required illuminance of the space in lux; 0 if the file states none."""
    notes: tuple[str, ...]
    """Notes on data that were left out or assumed."""


def load(
    context: Context,
    path: str | os.PathLike[str],
    space: str | None = None,
    reflectances: Sequence[float] = REFLECTANCES,
) -> Building:
    """Reads a space of a file by its name, long name or identifier; a file with one space needs no name. `reflectances`
    are given for the ceiling, the walls, the floor and the furniture."""
    if len(reflectances) != 4 or not all(0 <= r <= 1 for r in reflectances):
        raise ValueError("reflectances are four numbers in [0, 1]: of ceiling, walls, floor and furniture")
    model = _Model(Path(path))
    chosen = model.space(space)
    scene, notes = Scene(context), []
    shell = model.mesh(chosen)
    if shell is None:
        raise ValueError(f"the space {_title(chosen)!r} of {model.name} has no body, so it has no room")
    _add_shell(scene, *shell, reflectances)
    low, high = shell[0].min(axis=0), shell[0].max(axis=0)
    missing = _add_furniture(scene, model, low, high, reflectances[3])
    notes += [f"{count} objects of furniture have no body" for count in (missing,) if count]
    room = Room.find(scene, "Floor", "Ceiling")
    fixtures = model.fixtures(chosen, low, high)
    lamps = []
    for fixture in fixtures:
        try:
            lamps.append(model.luminaire(context, fixture, float(high[1])))
        except ValueError as error:
            notes.append(f"light fixture {_title(fixture)!r} is left out: {error}")
    zones = []
    for zone in model.zones(chosen):
        try:
            zones.append(model.task(room, zone))
        except ValueError as error:
            notes.append(f"lighting zone {_title(zone)!r} is left out: {error}")
    openings = [e for kind in ("IfcWindow", "IfcDoor") for e in model.file.by_type(kind)]
    if openings:
        notes.append(f"{len(openings)} windows and doors count as walls")
    found = model.values(chosen).get("Illuminance", 0.0)
    return Building(room, tuple(lamps), tuple(zones), _title(chosen), float(found or 0.0), tuple(notes))


def _title(entity: Any) -> str:
    """The name that people know of an entity."""
    return getattr(entity, "LongName", None) or entity.Name or entity.GlobalId


def _add_shell(scene: Scene, points: NDArray, triangles: NDArray, reflectances: Sequence[float]) -> None:
    """The faces of a space, from inside, by their direction."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normals, axis=1)
    up = np.divide(normals[:, 1], size, out=np.zeros(len(size)), where=size > 0)
    # Normals of a body point outwards; a lower face whose normals point up shows that they point inwards here.
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    up = up if volume > 0 else -up
    inside = triangles[:, ::-1] if volume > 0 else triangles
    for name, faces, value in (
        ("Ceiling", up > FLAT, reflectances[0]),
        ("Wall", np.abs(up) <= FLAT, reflectances[1]),
        ("Floor", up < -FLAT, reflectances[2]),
    ):
        if not faces.any():
            raise ValueError(f"the space has no {name.lower()}: no face of its body looks there")
        material = scene.add_material(name=name, base_color=(value,) * 3, ior=1)
        used, numbers = np.unique(inside[faces], return_inverse=True)
        scene.add_mesh(points[used], numbers.reshape(-1, 3), name=name, material=material)


def _add_furniture(scene: Scene, model: _Model, low: NDArray, high: NDArray, value: float) -> int:
    """Furniture whose middle lies in the space; returns the number of objects without a body."""
    material, missing = None, 0
    for piece in model.file.by_type("IfcFurnishingElement"):
        body = model.mesh(piece)
        if body is None:
            missing += 1
            continue
        middle = (body[0].min(axis=0) + body[0].max(axis=0)) / 2
        if (middle < low).any() or (middle > high).any():
            continue
        if material is None:
            material = scene.add_material(name="Furniture", base_color=(value,) * 3, ior=1)
        scene.add_mesh(body[0], body[1], name=_title(piece), material=material)
    return missing


class _Model:
    """An open file."""

    def __init__(self, path: Path) -> None:
        try:
            import ifcopenshell
            import ifcopenshell.geom
            import ifcopenshell.util.element
            import ifcopenshell.util.placement
            import ifcopenshell.util.unit
        except ImportError as error:
            raise ImportError("building models need ifcopenshell: pip install 'luxfer[ifc]'") from error
        if not path.exists():
            raise FileNotFoundError(f"there is no building model {path}")
        try:
            self.file = ifcopenshell.open(str(path))
        except Exception as error:  # it has errors of several kinds
            raise ValueError(f"{path.name} is no building model that can be read: {error}") from error
        self.name, self.folder, self.lib = path.name, path.parent, ifcopenshell
        self.unit = ifcopenshell.util.unit.calculate_unit_scale(self.file)
        # Angles are in this many degrees.
        angle = ifcopenshell.util.unit.calculate_unit_scale(self.file, "PLANEANGLEUNIT")
        self.degrees = math.degrees(angle)
        self.settings = ifcopenshell.geom.settings()
        self.settings.set("use-world-coords", True)

    def space(self, name: str | None) -> Any:
        """The space of a name, or the only one."""
        spaces = self.file.by_type("IfcSpace")
        found = [s for s in spaces if name is None or name in (s.Name, s.LongName, s.GlobalId)]
        if len(found) != 1:
            listed = ", ".join(repr(_title(s)) for s in spaces) or "none"
            asked = f"spaces called {name!r}" if name is not None else "spaces, and none was named"
            raise ValueError(f"{self.name} has {len(found)} {asked}: there are {listed}")
        return found[0]

    def mesh(self, product: Any) -> tuple[NDArray[np.float64], NDArray[np.uint32]] | None:
        """The body of a product in the scene's coordinates, in metres; None without one."""
        if product.Representation is None:
            return None
        try:
            shape = self.lib.geom.create_shape(self.settings, product)
        except RuntimeError:
            return None
        points = np.asarray(shape.geometry.verts, float).reshape(-1, 3)
        triangles = np.asarray(shape.geometry.faces, np.uint32).reshape(-1, 3)
        return (level(points), triangles) if len(triangles) else None

    def matrix(self, product: Any) -> NDArray[np.float64]:
        """The placement of a product, in metres, with z up."""
        out = np.array(self.lib.util.placement.get_local_placement(product.ObjectPlacement), float)
        out[:3, 3] *= self.unit
        return out

    def fixtures(self, space: Any, low: NDArray, high: NDArray) -> list[Any]:
        """The light fixtures of a space: fixtures that it contains, and fixtures of other places that lie in it."""
        out = []
        for fixture in self.file.by_type("IfcLightFixture"):
            holder = self.lib.util.element.get_container(fixture)
            if holder is not None and holder.is_a("IfcSpace"):
                if holder == space:
                    out.append(fixture)
                continue
            place = level(self.matrix(fixture)[:3, 3])
            if (place >= low - NEAR).all() and (place <= high + NEAR).all():
                out.append(fixture)
        return out

    def values(self, product: Any) -> dict[str, Any]:
        """All properties by their names. Properties of the product precede properties of its type."""
        sets = self.lib.util.element.get_psets(product)
        return {name: value for properties in sets.values() for name, value in properties.items()}

    def zones(self, space: Any) -> list[Any]:
        """The lighting zones that a space refers to."""
        out = []
        for relation in self.file.by_type("IfcRelReferencedInSpatialStructure"):
            if relation.RelatingStructure == space:
                out += [
                    p for p in relation.RelatedElements if p.is_a("IfcSpatialZone") and p.PredefinedType == "LIGHTING"
                ]
        return out

    def task(self, room: Room, zone: Any) -> Area:
        """The task area of a lighting zone: the rectangle around its body in the plan, at its lower face."""
        body = self.mesh(zone)
        if body is None:
            raise ValueError("it has no body")
        plan = np.clip(room.plan(body[0]), 0, (room.length, room.width))
        height = float(body[0][:, 1].min() - room.origin[1])
        return areas.task(room, _title(zone), (*plan.min(axis=0), *plan.max(axis=0)), height)

    def luminaire(self, context: Context, fixture: Any, ceiling: float) -> Luminaire:
        """A light fixture as a luminaire, below the ceiling."""
        kind = self.lib.util.element.get_type(fixture)
        values = self.values(fixture)
        source, within = self._source(fixture, kind)
        frame = self.matrix(fixture) @ within
        name = (kind.Name if kind is not None else None) or fixture.ObjectType or "light fixture"
        size = self._size(fixture)
        product = self._product(context, name, kind, source, values, size)
        full = float(source.LuminousFlux) if source is not None and source.LuminousFlux else product.flux
        sets = self.lib.util.element.get_psets(fixture)
        own = sets.get(OWN, {})
        dimmer = float(own.get("Dimmer", 1.0))
        if OWN_TYPE in sets:  # a design of this package, whose sources state the flux as dimmed
            full = float(sets[OWN_TYPE].get("LuminousFlux") or full)
        place = level(frame[:3, 3])
        place[1] = min(place[1], ceiling - BELOW)
        colour = (1.0, 1.0, 1.0)
        if source is not None and source.LightColour is not None:
            c = source.LightColour
            peak = max(c.Red, c.Green, c.Blue)
            colour = (c.Red / peak, c.Green / peak, c.Blue / peak) if peak > 0 else colour
        return Luminaire(
            replace(product, flux=full, reference=str(getattr(kind, "Tag", None) or "")),
            _three(place),
            dimmer,
            _three(level(-frame[:3, 2])),
            _three(level(frame[:3, 0])),
            colour,
            str(own.get("Group") or ""),
        )

    def _source(self, fixture: Any, kind: Any) -> tuple[Any, NDArray[np.float64]]:
        """The goniometric light source of a fixture or of its type, and its frame in the frame of the fixture."""
        shown = list(fixture.Representation.Representations) if fixture.Representation is not None else []
        if kind is not None and kind.RepresentationMaps:
            shown += [m.MappedRepresentation for m in kind.RepresentationMaps]
        for representation in shown:
            for item in representation.Items:
                if item.is_a("IfcMappedItem"):
                    item = next(iter(item.MappingSource.MappedRepresentation.Items), item)
                if item.is_a("IfcLightSourceGoniometric"):
                    within = np.array(self.lib.util.placement.get_axis2placement(item.Position), float)
                    within[:3, 3] *= self.unit
                    return item, within
        return None, np.eye(4)

    def _size(self, fixture: Any) -> tuple[float, float, float]:
        """Length, width and height of the body of a fixture in its own frame."""
        local = self.lib.geom.settings()
        try:
            shape = self.lib.geom.create_shape(local, fixture)
        except RuntimeError:
            return 0.0, 0.0, 0.0
        points = np.asarray(shape.geometry.verts, float).reshape(-1, 3)
        return _three(np.ptp(points, axis=0)) if len(points) else (0.0, 0.0, 0.0)

    def _product(
        self, context: Context, name: str, kind: Any, source: Any, values: dict[str, Any], size: Sequence[float]
    ) -> Product:
        """The product of a fixture: from the file that it refers to, otherwise from its distribution."""
        watts = float(values.get("TotalWattage") or 0.0)
        rendering = float(values.get("ColourRenderingIndex") or 0.0)
        data = source.LightDistributionDataSource if source is not None else None
        for location in [*self._documents(kind), getattr(data, "Location", None)]:
            path = self._beside(location)
            if path is not None:
                return Product.load(context, path, name, watts, rendering)
        if data is None or not data.is_a("IfcLightIntensityDistribution"):
            missing = [d for d in self._documents(kind) if d]
            why = f"its file {missing[0]!r} is not there" if missing else "it has no intensity distribution"
            raise ValueError(why)
        if data.LightDistributionCurve != "TYPE_C":
            raise ValueError(f"its distribution is of {data.LightDistributionCurve}, and only TYPE_C can be used")
        planes, angles, values_of = self._table(data)
        found = ies(planes, angles, values_of, (size[0], size[1], 0))
        product = Product.from_bytes(context, found, "ies", name, watts, rendering)
        total = float(source.LuminousFlux or 0) or product.flux
        if flux(planes, angles, values_of) <= 0:
            raise ValueError("its distribution has no flux")
        return replace(product, flux=total)

    def _table(self, data: Any) -> tuple[list[float], list[float], NDArray[np.float64]]:
        """Planes, angles and intensities of a distribution, on the angles of its first plane."""
        rows = list(data.DistributionData)
        angles = [float(v) * self.degrees for v in rows[0].SecondaryPlaneAngle]
        values = []
        for row in rows:
            own = [float(v) * self.degrees for v in row.SecondaryPlaneAngle]
            values.append(np.interp(angles, own, [float(v) for v in row.LuminousIntensity]))
        return [float(r.MainPlaneAngle) * self.degrees for r in rows], angles, np.array(values)

    def _documents(self, kind: Any) -> list[str]:
        """Places of the documents that a type refers to."""
        out = []
        for relation in getattr(kind, "HasAssociations", None) or []:
            if relation.is_a("IfcRelAssociatesDocument"):
                document = relation.RelatingDocument
                out.append(getattr(document, "Location", None) or getattr(document, "Identification", None) or "")
        return out

    def _beside(self, location: str | None) -> Path | None:
        """A photometric file in the folder of the model or below; files elsewhere are not opened."""
        if not location or Path(location).suffix.lower() not in LUMINAIRES or "://" in location:
            return None
        home = self.folder.resolve()
        path = (home / location.replace("\\", "/")).resolve()
        return path if path.is_relative_to(home) and path.is_file() else None


def _three(values: Sequence[float] | NDArray) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
