"""Designs as building models and back, and models as other programs write them; skipped without ifcopenshell."""

import contextlib
import importlib.util
import io
import math
import unittest
from dataclasses import replace
from unittest import mock

from support import Case, context, luxfer, np
from test_design import HEIGHT, LENGTH, WIDTH, at_least, at_most, panel, project
from test_design_radiance import lopsided

from luxfer import design
from luxfer.design import ifc
from luxfer.design.ifc_photometry import ies

HAS_IFC = importlib.util.find_spec("ifcopenshell") is not None
if HAS_IFC:
    import ifcopenshell
    import ifcopenshell.guid
    import ifcopenshell.util.element
    import ifcopenshell.validate


def designed() -> design.Project:
    """A lamp that is dimmed, turned and coloured, one that is tilted, one that is off, and a desk."""
    lit = project(0.5, 2, 64)
    lamps = [
        replace(lit.luminaires[0], product=lopsided(), dimmer=0.25, c0=(0, 0, 1), colour=(1, 0.8, 0.5), group="wall"),
        replace(lit.luminaires[1], axis=(0.6, -0.8, 0), c0=(0.8, 0.6, 0)),
        replace(lit.luminaires[1], dimmer=0, position=(2.0, 2.5, 1.5)),
    ]
    return replace(lit, luminaires=lamps, name="Office 1").requiring(at_least("mean", 30), at_most("density", 9))


class Foreign:
    """A model in millimetres and radians, with a room of 5 by 4 by 3 m that is turned by 30 degrees about (2, 1)."""

    def __init__(self) -> None:
        self.file = ifcopenshell.file(schema="IFC4")
        add = self.file.create_entity
        units = [add("IfcSIUnit", UnitType="LENGTHUNIT", Prefix="MILLI", Name="METRE")]
        units += [add("IfcSIUnit", UnitType="PLANEANGLEUNIT", Name="RADIAN")]
        self.context = add("IfcGeometricRepresentationContext", None, "Model", 3, 1e-5, self.frame())
        top = self.root(
            "IfcProject",
            Name="p",
            RepresentationContexts=[self.context],
            UnitsInContext=add("IfcUnitAssignment", units),
        )
        self.storey = self.root("IfcBuildingStorey", Name="1", ObjectPlacement=self.place())
        turn = math.radians(30)
        x = (math.cos(turn), math.sin(turn), 0.0)
        self.at = add("IfcLocalPlacement", None, self.frame((2000.0, 1000.0, 0.0), x=x))
        shape = self.box(5000.0, 4000.0, 3000.0, (2500.0, 2000.0))
        self.space = self.root("IfcSpace", Name="101", LongName="Studio", ObjectPlacement=self.at, Representation=shape)
        for above, below in ((top, self.storey), (self.storey, self.space)):
            self.root("IfcRelAggregates", RelatingObject=above, RelatedObjects=[below])

    def root(self, kind, **values):
        return self.file.create_entity(kind, GlobalId=ifcopenshell.guid.new(), **values)

    def frame(self, at=(0.0, 0.0, 0.0), x=(1.0, 0.0, 0.0)):
        add = self.file.create_entity
        return add(
            "IfcAxis2Placement3D",
            add("IfcCartesianPoint", at),
            add("IfcDirection", (0.0, 0.0, 1.0)),
            add("IfcDirection", x),
        )

    def place(self, at=(0.0, 0.0, 0.0), x=(1.0, 0.0, 0.0)):
        return self.file.create_entity("IfcLocalPlacement", getattr(self, "at", None), self.frame(at, x))

    def shown(self, *items, name="Body", kind="SweptSolid"):
        return self.file.create_entity("IfcShapeRepresentation", self.context, name, kind, items)

    def box(self, length, width, height, centre=(0.0, 0.0)):
        add = self.file.create_entity
        middle = add("IfcAxis2Placement2D", add("IfcCartesianPoint", centre))
        profile = add("IfcRectangleProfileDef", "AREA", None, middle, length, width)
        solid = add("IfcExtrudedAreaSolid", profile, self.frame(), add("IfcDirection", (0.0, 0.0, 1.0)), height)
        return add("IfcProductDefinitionShape", None, None, [self.shown(solid)])

    def fixture(self, name, at, x=(1.0, 0.0, 0.0), kind=None, inside=True):
        shape = self.box(400.0, 200.0, 50.0)
        made = self.root("IfcLightFixture", Name=name, ObjectPlacement=self.place(at, x), Representation=shape)
        holder = self.space if inside else self.storey
        self.root("IfcRelContainedInSpatialStructure", RelatedElements=[made], RelatingStructure=holder)
        if kind is not None:
            self.root("IfcRelDefinesByType", RelatedObjects=[made], RelatingType=kind)
        return made

    def kind(self, curve="TYPE_C", source=None):
        """A type whose light is that of lopsided() in cd per lm, or comes from a source that is given."""
        add = self.file.create_entity
        if source is None:
            with luxfer.Distribution.load_memory(context(), lopsided().photometry, "ies") as found:
                angles = [float(g) for g in range(0, 95, 5)]
                rows = [
                    add(
                        "IfcLightDistributionData",
                        math.radians(c),
                        [math.radians(g) for g in angles],
                        [found.intensity(c, g) / found.report.flux for g in angles],
                    )
                    for c in range(0, 360, 30)
                ]
            source = add("IfcLightIntensityDistribution", curve, rows)
        white = add("IfcColourRgb", None, 1.0, 1.0, 1.0)
        light = add(
            "IfcLightSourceGoniometric",
            None,
            white,
            None,
            None,
            self.frame(),
            None,
            4000.0,
            2500.0,
            "LIGHTEMITTINGDIODE",
            source,
        )
        shown = self.shown(light, name="Lighting", kind="LightSource")
        maps = [add("IfcRepresentationMap", self.frame(), shown)]
        power = add("IfcPropertySingleValue", "TotalWattage", None, add("IfcPowerMeasure", 21.0), None)
        common = self.root("IfcPropertySet", Name="Pset_LightFixtureTypeCommon", HasProperties=[power])
        return self.root(
            "IfcLightFixtureType",
            Name="Washer",
            RepresentationMaps=maps,
            HasPropertySets=[common],
            PredefinedType="NOTDEFINED",
        )

    def load(self, folder, *words, **more):
        self.file.write(str(folder / "model.ifc"))
        return ifc.load(context(), folder / "model.ifc", *words, **more)


class Tables(Case):
    def test_angles_that_end_early_have_no_light_beyond(self):
        product = design.Product.from_bytes(
            context(), ies([0], [10, 30, 60], np.array([[100.0, 100, 100]]), (0.1, 0.2, 0)), "ies", "spot"
        )
        with luxfer.Distribution.load_memory(context(), product.photometry, "ies") as found:
            seen = [found.intensity(0, g) for g in (0, 30, 60, 61, 90)]
        np.testing.assert_allclose(seen, [100, 100, 100, 0, 0], atol=1e-3)
        np.testing.assert_allclose(product.size[:2], (0.1, 0.2), atol=1e-6)

    def test_tables_that_are_none(self):
        good = np.ones((2, 3))
        for planes, angles, values, words in (
            ([0, 0], [0, 45, 90], good, "planes are not distinct"),
            ([0, 90], [0, 45, 45], good, "angles do not rise"),
            ([0, 90], [0, 45, 90], -good, "not all positive"),
            ([0, 90], [0, 45, 90], 0 * good, "not all positive"),
            ([30, 90], [0, 45, 90], good, "no plane C = 0"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                ies(planes, angles, values, (0, 0, 0))

    def test_without_ifcopenshell_the_package_is_named(self):
        with mock.patch.dict("sys.modules", {"ifcopenshell": None}):
            for call in (lambda: ifc.load(context(), "a.ifc"), lambda: ifc.save(project(), self.folder / "a.ifc")):
                with self.assertRaisesRegex(ImportError, r"pip install 'luxfer\[ifc\]'"):
                    call()


@unittest.skipUnless(HAS_IFC, "ifcopenshell is not installed")
class RoundTrip(Case):
    def test_a_design_comes_back(self):
        lit = designed()
        found = lit.check()
        path = ifc.save(lit, self.folder / "out.ifc", found)
        back = ifc.load(context(), path, reflectances=(0.5, 0.5, 0.5, 0.5))
        self.assertEqual((back.name, back.illuminance, back.notes), ("Office 1", 30, ()))
        np.testing.assert_allclose(
            (back.room.length, back.room.width, back.room.height), (LENGTH, WIDTH, HEIGHT), rtol=1e-6
        )
        np.testing.assert_allclose(back.areas[0].outline, lit.areas[0].outline, atol=1e-6)
        self.assertAlmostEqual(back.areas[0].height, 0.75, places=6)
        for ours, theirs in zip(lit.luminaires, back.luminaires):
            for name in ("position", "axis", "c0"):
                np.testing.assert_allclose(getattr(theirs, name), getattr(ours, name), atol=1e-6)
            np.testing.assert_allclose(theirs.colour, ours.colour, atol=1e-6)
            self.assertEqual((theirs.group, theirs.dimmer), (ours.group, ours.dimmer))
            self.assertEqual(theirs.product.photometry, ours.product.photometry)
            np.testing.assert_allclose((theirs.flux, theirs.watts), (ours.flux, ours.watts), rtol=1e-6)
            self.assertAlmostEqual(theirs.product.flux, ours.product.flux, places=3)
            self.assertEqual(
                (theirs.product.name, theirs.product.rendering), (ours.product.name, ours.product.rendering)
            )
        again = replace(lit, room=back.room, luminaires=back.luminaires, areas=back.areas).check()
        self.assertAlmostEqual(again.findings[0].value, found.findings[0].value, delta=0.01 * found.findings[0].value)

    def test_the_distribution_alone_is_enough(self):
        """Another program may move the model without the photometric files beside it."""
        lit = designed()
        path = ifc.save(lit, self.folder / "out.ifc")
        for file in (self.folder / "photometry").iterdir():
            file.unlink()
        back = ifc.load(context(), path)
        for ours, theirs in zip(lit.luminaires, back.luminaires):
            with (
                luxfer.Distribution.load_memory(context(), ours.product.photometry, "ies") as a,
                luxfer.Distribution.load_memory(context(), theirs.product.photometry, "ies") as b,
            ):
                one = [a.intensity(c, g) / a.report.flux for c in (0, 40, 100, 260) for g in (0, 20, 57, 80, 100)]
                two = [b.intensity(c, g) / b.report.flux for c in (0, 40, 100, 260) for g in (0, 20, 57, 80, 100)]
            np.testing.assert_allclose(two, one, atol=0.01 * max(one))
            self.assertAlmostEqual(theirs.flux, ours.flux, delta=0.01)
            np.testing.assert_allclose(theirs.product.size[:2], ours.product.size[:2], atol=1e-6)

    def test_the_file_is_valid_and_the_same_every_time(self):
        lit, files = designed(), []
        for name in ("one", "two"):
            (self.folder / name).mkdir()
            files.append(ifc.save(lit, self.folder / name / "out.ifc", lit.check()))
        self.assertEqual(*(f.read_bytes() for f in files))
        log = ifcopenshell.validate.json_logger()
        ifcopenshell.validate.validate(ifcopenshell.open(str(files[0])), log)
        self.assertEqual(log.statements, [])

    def test_results_have_intervals_and_outcomes(self):
        lit = designed()
        found = lit.check()
        model = ifcopenshell.open(str(ifc.save(lit, self.folder / "out.ifc", found)))
        (zone,) = model.by_type("IfcSpatialZone")
        (results,) = [r.RelatingPropertyDefinition for r in zone.IsDefinedBy]
        value, outcome = results.HasProperties
        mean = found.findings[0]
        self.assertEqual((results.Name, value.Name), ("Luxfer_Results desk", "mean of desk at least 30 lx"))
        ends = (value.LowerBoundValue, value.SetPointValue, value.UpperBoundValue)
        self.assertEqual([e.wrappedValue for e in ends], [mean.low, mean.value, mean.high])
        self.assertTrue(ends[0].is_a("IfcIlluminanceMeasure"))
        self.assertEqual(outcome.NominalValue.wrappedValue, "passes")
        space = ifcopenshell.util.element.get_psets(model.by_type("IfcSpace")[0])
        self.assertEqual(space["Luxfer_LightingDesign"]["Hash"], luxfer.design.fingerprint.digest(lit.record()))
        self.assertEqual(space["Pset_SpaceLightingRequirements"]["Illuminance"], 30)


@unittest.skipUnless(HAS_IFC, "ifcopenshell is not installed")
class OtherPrograms(Case):
    def test_a_turned_room_in_millimetres(self):
        model = Foreign()
        kind = model.kind()
        model.fixture("in the room", (1000.0, 3000.0, 2900.0), (0.0, 1.0, 0.0), kind)
        model.fixture("of the storey", (2000.0, 1000.0, 3100.0), kind=kind, inside=False)
        model.fixture("next door", (9000.0, 1000.0, 2900.0), kind=kind, inside=False)
        model.fixture("dark", (1000.0, 1000.0, 2900.0))
        model.root(
            "IfcFurniture",
            Name="Desk",
            ObjectPlacement=model.place((2500.0, 2000.0, 0.0)),
            Representation=model.box(1600.0, 800.0, 740.0),
        )
        model.root("IfcWindow", Name="Window")
        found = model.load(self.folder)
        room = found.room
        np.testing.assert_allclose(sorted((room.length, room.width)), (4, 5), rtol=1e-5)
        self.assertAlmostEqual(room.height, 3, places=5)
        self.assertEqual(len(found.luminaires), 2)
        self.assertIn("'dark' is left out: it has no intensity distribution", found.notes[0])
        self.assertEqual(found.notes[1:], ("1 windows and doors count as walls",))
        turn = np.radians(30)
        across = np.array([np.cos(turn), 0, -np.sin(turn)]), np.array([-np.sin(turn), 0, -np.cos(turn)])
        lamp, storey = found.luminaires
        np.testing.assert_allclose(lamp.position, np.array([2, 2.9, -1]) + across[0] + 3 * across[1], atol=1e-5)
        np.testing.assert_allclose(lamp.c0, across[1], atol=1e-6)
        np.testing.assert_allclose(lamp.axis, (0, -1, 0), atol=1e-6)
        self.assertLess(storey.position[1], 3)
        self.assertEqual((lamp.product.name, lamp.product.flux, lamp.product.watts), ("Washer", 2500, 21))
        np.testing.assert_allclose(lamp.product.size[:2], (0.4, 0.2), atol=1e-6)
        with luxfer.Distribution.load_memory(context(), lopsided().photometry, "ies") as a:
            with luxfer.Distribution.load_memory(context(), lamp.product.photometry, "ies") as b:
                scale = b.report.flux / a.report.flux
                for c, g in ((0, 0), (90, 45), (270, 60), (180, 90)):
                    self.assertAlmostEqual(b.intensity(c, g) / scale, a.intensity(c, g), delta=0.02 * a.intensity(0, 0))
        desk = design.areas.task_on(room, "desk", "Desk")
        settings = design.Settings(maintenance=0.8, samples=16, max_samples=16)
        lit = design.Project(room, found.luminaires, (desk,), settings=settings).requiring(at_least("mean", 1))
        self.assertTrue(lit.check().passes)

    def test_the_command_line_reads_and_writes_models(self):
        model = Foreign()
        model.fixture("a", (2500.0, 2000.0, 2900.0), kind=model.kind())
        model.file.write(str(self.folder / "in.ifc"))
        words = [str(self.folder / "in.ifc"), "--place", "corridors", "--maintenance", "0.8"]
        out, wrong = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(wrong):
            self.assertEqual(design.main(words), 2)
            task = ["--task", "1,1,3,3,0.75", "--out", str(self.folder / "out.ifc")]
            self.assertEqual(design.main([*words, *task]), 6)
            self.assertEqual(design.main([*words, *task, "--space", "9"]), 3)
            self.assertEqual(
                design.main(["demo:target-room", *words[1:], "--product", "x.ies", *task, "--space", "9"]), 2
            )
        self.assertIn("no lighting zone in this space", wrong.getvalue())
        self.assertIn("has 0 spaces called '9'", wrong.getvalue())
        self.assertIn("--space names a space of an .ifc file", wrong.getvalue())
        back = ifc.load(context(), self.folder / "out.ifc")
        self.assertEqual((back.illuminance, len(back.luminaires), len(back.areas)), (100, 1, 1))

    def test_a_type_that_refers_to_a_file(self):
        model = Foreign()
        reference = model.file.create_entity("IfcDocumentReference", "lamps/washer.ies")
        kind = model.kind()
        model.root("IfcRelAssociatesDocument", RelatedObjects=[kind], RelatingDocument=reference)
        model.fixture("a", (1000.0, 3000.0, 2900.0), kind=kind)
        (self.folder / "lamps").mkdir()
        (self.folder / "lamps" / "washer.ies").write_bytes(panel().photometry)
        self.assertEqual(model.load(self.folder).luminaires[0].product.photometry, panel().photometry)
        # A file outside the model's folder is not opened.
        (self.folder / "model").mkdir()
        reference.Location = "../lamps/washer.ies"
        found = model.load(self.folder / "model").luminaires[0].product
        self.assertNotEqual(found.photometry, panel().photometry)

    def test_distributions_of_another_type(self):
        model = Foreign()
        model.fixture("flood", (1000.0, 3000.0, 2900.0), kind=model.kind("TYPE_B"))
        found = model.load(self.folder)
        self.assertEqual(found.luminaires, ())
        self.assertIn("'flood' is left out: its distribution is of TYPE_B, and only TYPE_C", found.notes[0])

    def test_spaces_that_are_none(self):
        model = Foreign()
        with self.assertRaisesRegex(ValueError, "has 0 spaces called '102': there are 'Studio'"):
            model.load(self.folder, "102")
        self.assertEqual(model.load(self.folder, "101").name, "Studio")
        other = model.root("IfcSpace", Name="102", ObjectPlacement=model.place())
        with self.assertRaisesRegex(ValueError, "has 2 spaces, and none was named: there are 'Studio', '102'"):
            model.load(self.folder)
        with self.assertRaisesRegex(ValueError, "the space '102' .* has no body"):
            model.load(self.folder, other.GlobalId)
        (self.folder / "text.ifc").write_text("a room")
        with self.assertRaisesRegex(ValueError, "text.ifc is no building model that can be read"):
            ifc.load(context(), self.folder / "text.ifc")
        with self.assertRaisesRegex(FileNotFoundError, "there is no building model"):
            ifc.load(context(), self.folder / "none.ifc")
        with self.assertRaisesRegex(ValueError, "an .ifc file, not 'a.dwg'"):
            ifc.save(project(), self.folder / "a.dwg")


if __name__ == "__main__":
    unittest.main()
