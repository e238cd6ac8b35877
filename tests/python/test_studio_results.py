"""What the studio gives back: files of results, the exported program, and the illuminance. Runs where
benches/peers/install.sh has installed `studio`."""

import ast
import csv
import importlib.util
import io
import json
import math
import threading
import unittest
import zipfile
from types import SimpleNamespace
from unittest import mock

from support import Case, context, demo, lit_room, luxfer, np
from support_studio import StudioCase

from luxfer.cli.plane import above_floor
from luxfer.studio import layout, measure, painting, pictures, program, project, results
from luxfer.studio.light import Light
from luxfer.studio.room import work_plane
from luxfer.studio.results import ENDINGS


HAS_USD = importlib.util.find_spec("pxr") is not None
KINDS = [kind for kind in ENDINGS if kind != "room" and (kind != "usd" or HAS_USD)]


class Results(StudioCase):
    """Results as files, without a server."""

    def test_the_light_to_compare_with_becomes_as_accurate_as_the_picture(self):
        pictures = []
        self.edit(lambda header: header["type"] == "picture" and pictures.append(header), compare="white", noise=0.5)
        before, after = ([p for p in pictures if p["which"] == which] for which in ("before", "after"))
        self.assertEqual([p["done"] for p in before], [False, True])  # a quick one first
        self.assertEqual([(p["done"], p["width"], p["height"]) for p in (before[-1], after[-1])], 2 * [(True, 160, 104)])
        self.assertLess(before[-1]["noise"], 1.5 * after[-1]["noise"])
        pictures.clear()
        self.edit(lambda header: header["type"] == "picture" and pictures.append(header), compare="own", noise=0.5)
        self.assertEqual({p["which"] for p in pictures}, {"before"})  # the lit room has not changed

    def test_results_belong_to_the_project_that_is_shown(self):
        early = {}

        def seen(header):  # in the thread of the work, before it goes on
            if header["type"] == "picture" and not header["done"]:
                for kind in KINDS:
                    early.setdefault(kind, self.out(kind))
            if header["type"] == "plan":  # the picture has its full size, and becomes better
                self.session.out("exr", self.folder).rename(self.folder / "early.exr")

        self.edit(seen)
        self.assertEqual([kind for kind, content in early.items() if content is None], ["exr", "png", "program", "program-c", "program-cpp"])
        self.assertEqual(luxfer.Image.load(context(), self.folder / "early.exr").size[:2], (160, 104))
        first = {kind: self.out(kind) for kind in KINDS}
        unlit = luxfer.Scene.from_bytes(context(), self.out("room"))
        self.assertEqual(unlit.counts, luxfer.Scene.demo(context(), "target-room").counts)
        self.assertEqual([kind for kind, content in first.items() if content is None], [])
        self.assertEqual(luxfer.Image.load(context(), self.folder / "office.exr").size[:2], (160, 104))

        # A change that nothing has followed yet: no result of the former project is given for it.
        self.edit(draft=True, white=200.0)
        later = {kind: self.out(kind) for kind in KINDS}
        self.assertEqual([kind for kind, content in later.items() if content is not None], ["project"])
        self.assertEqual(json.loads(later["project"])["white"], 200.0)
        self.edit(white=200.0)
        for kind, content in first.items():
            self.assertTrue(self.out(kind) not in (None, content), kind)

        self.check_mixed(first)

    def check_mixed(self, first):
        """Dimming every kind to a quarter dims schedule, photometry, room and illuminance, but not the exposure."""
        kinds = {row["kind"] for row in csv.DictReader(io.StringIO(first["csv"].decode()))}
        self.edit(mix=dict.fromkeys(kinds, 0.25), until="lux")
        for kind in ("csv", "json"):
            before, after = ([self.light_of(kind, data) for data in (first[kind], self.out(kind))])
            self.assertEqual(len(before), len(after))
            for one, other in zip(before, after):
                for name, value in one.items():
                    self.assertLess(abs(other[name] - value / 4), 1e-5 * value, name)
        files = zipfile.ZipFile(io.BytesIO(self.out("photometry")))
        whole = sorted({int(kind) for kind in kinds} - {0})
        names = [f"kind {chr(64 + k)}.{ending}" for k in whole for ending in ("ies", "ldt", "xml", "gldf")]
        self.assertEqual(sorted(files.namelist()), sorted(names))
        lamps = [row for row in csv.DictReader(io.StringIO(self.out("csv").decode())) if row["kind"] == "1"]
        mean = sum(float(row["flux_lm"]) for row in lamps) / len(lamps)
        for ending in ("ies", "ldt", "xml", "gldf"):
            flux = luxfer.Distribution.load_memory(context(), files.read(f"kind A.{ending}")).report.flux
            self.assertLess(abs(flux / mean - 1), 0.01, ending)
        full, dimmed = (self.mean_of(kind) for kind in ({}, dict.fromkeys(kinds, 0.25)))
        self.assertLess(abs(dimmed / full - 0.25), 0.01)

    def light_of(self, kind, data):
        """The light of each lamp of a schedule."""
        text = data.decode()
        lamps = list(csv.DictReader(io.StringIO(text))) if kind == "csv" else json.loads(text)["fixtures"]
        return [{name: float(lamp[name]) for name in ("flux_lm", "red_cd_m2")} for lamp in lamps]

    def mean_of(self, mix):
        """The mean illuminance of the work plane with a mix."""
        seen = []
        self.edit(lambda header: seen.append(header["mean"]) if header["type"] == "lux" else None, mix=mix, until="lux")
        return seen[-1]

    @unittest.skipIf(HAS_USD, "with the package, test_usd checks the file")
    def test_usd_without_its_package_says_what_to_install(self):
        with self.assertRaisesRegex(LookupError, "pip install 'luxfer\\[usd\\]'"):
            results.write("usd", self.folder / "room.usdz", None, SimpleNamespace(lit=None))

    def test_lux_goes_with_the_white_and_lies_where_it_is_asked_for(self):
        seen = {}

        def last(header):
            seen[header["type"]] = header

        self.edit(last, until="lux")
        mean = seen["lux"]["mean"]
        self.edit(last, white=200.0, until="lux")
        self.assertLess(abs(seen["lux"]["mean"] / mean - 2), 0.02)
        self.edit(last, white=200.0, lux_plane={"surface": None, "height": 0.0}, until="lux")
        self.assertEqual(seen["lux"]["height"], 0.0)
        self.edit(last, white=200.0, lux_plane={"surface": "Left wall", "height": 0.75}, until="lux")
        self.assertEqual(seen["lux"]["surface"], "Left wall")
        self.assertNotIn("height", seen["lux"])
        self.edit(last, white=200.0, lux_plane={"surface": "no such", "height": 0.75}, until="lux")
        self.assertIn("Choose another plane", seen["lux"]["problem"])

    def test_the_smallest_and_the_largest_illuminance_lie_in_their_intervals(self):
        scene = lit_room()
        plane = measure.chosen_plane(scene, "Ceiling", self.project)[0]

        def lux(samples, seed):
            job = luxfer.Illuminance(context(), scene).start_grid(
                plane.grid(), columns=12, rows=8, samples=samples, seed=seed
            )
            return measure.numbers(job.wait())

        sharp, inside = lux(4096, 99), 0
        for seed in range(1, 21):
            found = lux(64, seed)
            for name in ("minimum", "maximum"):
                low, high = found[f"{name}_range"]
                self.assertLess(low, found[name])
                self.assertLess(found[name], high)
                inside += low <= sharp[name] <= high
        self.assertGreaterEqual(inside, 38)  # 95 % of 40 intervals

    def test_an_added_lamp_is_in_the_room_and_in_its_schedule(self):
        seen = {}

        def last(header):
            seen[header["type"]] = header

        self.edit(last, until="lux")
        before, mean = seen["lamps"]["list"], seen["lux"]["mean"]
        plain = self.out("csv")
        kind = before[0]["kind"]
        place = self.session.light.room.find_surface("Ceiling")

        def on_ceiling(lamp):
            at = np.subtract(lamp["position"], place.origin)
            return [float(at @ np.array(axis)) for axis in (place.u_axis, place.v_axis)]

        # The added lamp hangs where it covers no other lamp.
        spots = [(u / 10, v / 10) for u in range(5, 56) for v in range(5, 36)]
        spot = max(spots, key=lambda spot: min(math.dist(spot, on_ceiling(lamp)) for lamp in before))
        added = [[kind, *spot], [99, 1.0, 1.0]]  # there is no kind 99
        self.edit(last, added=added, until="lux")
        after = seen["lamps"]["list"]
        self.assertEqual(after[: len(before)], before)
        self.assertEqual([lamp["added"] for lamp in after[len(before) :]], [0])
        model = max((lamp for lamp in before if lamp["kind"] == kind), key=lambda lamp: lamp["flux"])
        for found, wanted in zip(on_ceiling(after[-1]), spot, strict=True):
            self.assertAlmostEqual(found, wanted, places=4)
        total = sum(lamp["flux"] for lamp in before)
        self.assertGreater(seen["lux"]["mean"], mean * (1 + 0.5 * model["flux"] / total))
        rows = self.out("csv").decode().splitlines()
        self.assertEqual(rows[:-1], plain.decode().splitlines())
        self.assertAlmostEqual(float(rows[-1].split(",")[0]), after[-1]["position"][0], places=4)
        outlines = [lamp["outline_m"] for lamp in json.loads(self.out("json"))["fixtures"]]
        middle = np.mean(outlines[-1], axis=0)
        self.assertLess(float(np.abs(middle - after[-1]["position"]).max()), 0.1)

    def test_a_turned_texture_is_mapped_to_the_surface(self):
        seen = {}
        pattern = {**self.project["pattern"], "rotation": 0.5}
        self.edit(lambda header: seen.update({header["type"]: header}), pattern=pattern, until="lamps")
        matrix = np.array(seen["lamps"]["to_texture"])
        angle = np.arctan2(matrix[0, 1] / np.hypot(*matrix[0, :2]), matrix[0, 0] / np.hypot(*matrix[0, :2]))
        self.assertAlmostEqual(float(angle), 0.5, places=3)

    def test_a_page_that_connects_disturbs_no_work(self):
        seen = []

        def greet(header):
            if header["type"] == "room":  # photo and room are open, and the work is about to use them
                self.session.hello()
            seen.append(header["type"])

        self.edit(greet, until="picture")
        self.assertIn("picture", seen)


class Stylised(Case):
    """The stylisation, at a small size."""

    def setUp(self):
        super().setUp()
        for name, value in (("SIZE", (80, 60)), ("SHEET_SIZE", (160, 120)), ("SAMPLES", 2), ("SHEET_SAMPLES", 1)):
            patch = mock.patch.object(painting, name, value)
            patch.start()
            self.addCleanup(patch.stop)
        self.messages, self.failures, self.done = [], [], threading.Event()
        self.painter = painting.Painter(context(), self.take, self.fail_later)
        self.addCleanup(self.painter.close)

    def take(self, kind, payload=b"", **header):
        self.messages.append((kind, header, payload))
        if kind == "painting" and header["done"]:
            self.done.set()

    def fail_later(self, failure):
        self.failures.append(failure)
        self.done.set()

    def paint(self, artwork):
        """Waits for the picture and returns its header."""
        self.done.clear()
        self.painter.ask({"artwork": artwork})
        self.assertTrue(self.done.wait(120))
        self.assertEqual(self.failures, [])
        return self.messages[-2][1]

    def test_the_picture_follows_the_artwork(self):
        first = self.paint("pen")
        self.assertEqual([kind for kind, _, _ in self.messages if kind != "working"], ["artwork", *["painting"] * 2])
        self.assertNotEqual(first["digest"], self.paint("paint")["digest"])
        # The printed sheet, photographed, is the ball again: grey and pale, in the shape of the picture.
        sheet = self.painter.out("sheet", self.folder)
        self.painter.take_artwork(sheet.read_bytes(), True)
        self.assertEqual(self.painter.own.size[:2], (80, 60))
        self.assertGreater(float(self.painter.own.numpy().min()), 0.2)
        own = self.paint("own")
        picture = luxfer.Image.load(context(), self.painter.out("painting", self.folder))
        self.assertEqual(pictures.digest(self.painter.painted), own["digest"])
        self.assertEqual(picture.size[:2], (80, 60))

    def test_what_is_no_artwork_says_what_to_do(self):
        for message, text in (({"artwork": "own"}, "open one"), ({"artwork": "oil"}, "'oil'"), ({}, "None")):
            with self.assertRaisesRegex(project.Invalid, text):
                self.painter.ask(message)
        square = self.folder / "square.png"
        luxfer.Image(context(), np.ones((50, 50, 3), np.float32)).save(square)
        with self.assertRaisesRegex(project.Invalid, "crop it to this shape"):
            self.painter.take_artwork(square.read_bytes(), False)
        with self.assertRaises(luxfer.Error):  # a picture without the marks of a sheet
            self.painter.take_artwork(square.read_bytes(), True)
        with self.assertRaises(luxfer.errors.NotReady):
            self.painter.out("painting", self.folder)
        self.assertIsNone(self.painter.own)


class Programs(Case):
    """The exported program, as a text."""

    def text(self, **changes):
        named = {"name": "photo.png", "sha256": "0" * 64}
        whole = project.checked({"luxfer_studio": 1, "photo": named, **changes})
        camera = {"position": (0, 1, 2), "target": (0, 1, 0), "fov_y": 1.0}
        return program.program(whole, program.Chosen((72, 48), layout.layouts(whole, "Ceiling"), camera, 0.01))

    def test_names_are_those_of_the_files(self):
        for name in ("😀.png", "Büro.png", "it's \"here\".png", "back\\slash.png", "a\nb.png", "{brace}.png"):
            file = {"name": name, "sha256": "0" * 64}
            tree = ast.parse(self.text(photo=file, room=file, surface=name).encode())
            values = {
                node.targets[0].id: node.value for node in tree.body if isinstance(node, ast.Assign) and node.targets
            }
            found = [values[n].orelse.value for n in ("photo_file", "room_file")] + [values["surfaces"].elts[0].elts[0].value]
            self.assertEqual(found, [name] * 3)

    def test_what_was_taken_out_stays_out(self):
        zones, removed = [[0.0, 0.5, 1.0, 1.5]], [[12.0, 34.0]]
        text = self.text(zones=zones, removed=removed)
        ast.parse(text)
        self.assertIn(f", {zones}),\n", text)
        self.assertIn(f"without(mask, {removed}, ", text)
        self.assertNotIn("without(", self.text(zones=zones))
        for changes in ({"mix": {"1": 0.5}}, {"added": [[1, 2.0, 3.0]]}):
            text = self.text(**changes)
            ast.parse(text)
            self.assertIn("mix.apply(placed)", text)
        self.assertNotIn("mix", self.text(mix={"1": 1.0}))

    def test_a_plan_has_only_the_settings_of_a_plan(self):
        good = {"samples": 64, "target_error": 0.1, "seed": 0}
        self.assertIn("**{'samples': 64, 'target_error': 0.1, 'seed': 0}", self.text(plan={"render": good}))
        for wrong in (
            {**good, "time_budget_ms": 10},
            {"width": 10},
            {"target_error": float("nan")},
            {"target_error": float("inf")},
            {"samples": 1.5},
            {"samples": 0},
            {"seed": -1},
            {"samples": True},
        ):
            with self.assertRaises(project.Invalid, msg=str(wrong)):
                self.text(plan={"render": wrong})


class Planes(Case):
    """Where the illuminance of the studio is calculated."""

    def room(self, rise=3.0):
        """A room of 5 x 4 x 2.8 m whose floor is at y = `rise`, over a terrain that lies 3 m below the floor."""
        scene = luxfer.Scene(context())
        black = scene.add_material(name="Black", base_color=(0, 0, 0))
        for name, y, side, face in (
            ("Ceiling", rise + 2.8, (5.0, 4.0), (0, 1, 2, 0, 2, 3)),
            ("Floor", rise, (5.0, 4.0), (0, 2, 1, 0, 3, 2)),
            ("Terrain", rise - 3.0, (50.0, 40.0), (0, 2, 1, 0, 3, 2)),
        ):
            x, z = side[0] / 2, side[1] / 2
            corners = [(-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z)]
            triangles = np.array(face, np.uint32).reshape(2, 3)
            scene.add_mesh(np.array(corners, np.float32), triangles, material=black, name=name)
        return scene

    def test_the_plane_is_above_the_floor_below_the_ceiling(self):
        plane, problem = work_plane(self.room(), "Ceiling")
        self.assertEqual(problem, "")
        self.assertAlmostEqual(plane.origin[1], 3.75, places=4)
        self.assertEqual([round(side, 4) for side in sorted(plane.sides)], [3.0, 4.0])
        self.assertEqual(plane, above_floor(self.room(), "Ceiling"))

    def test_a_surface_without_a_floor_is_said(self):
        plane, problem = work_plane(self.room(), "Terrain")
        self.assertIn('"Terrain"', problem)
        self.assertAlmostEqual(plane.origin[1], 2.9, places=4)

    def measured(self, surface):
        """The message about the illuminance that the page receives."""
        messages = []
        room = self.room()
        thread = SimpleNamespace(finish=lambda job: job.wait())
        studio = Light(demo()[0], room, thread, lambda kind, **header: messages.append(header))
        room.add_light(kind="point", position=(0, 5, 0), intensity=(100, 100, 100))
        studio.lit = room
        studio.shots[0].transfer = SimpleNamespace(scene=lambda which: room)
        whole = project.checked({"luxfer_studio": 1, "photo": {"name": "a.png", "sha256": "0" * 64}})
        studio.layouts = layout.layouts(whole, surface)
        studio.choose_exposure(whole)
        studio.measure(whole)
        return messages[-1], studio.exposure

    def test_the_page_receives_the_height_above_the_floor(self):
        message, _ = self.measured("Ceiling")
        self.assertAlmostEqual(message["height"], 0.75)
        self.assertAlmostEqual(message["floor"], 3.0, places=4)
        self.assertEqual([round(inset, 4) for inset in message["insets"]], [0.5, 0.5])
        # 100 cd at 1.25 m above the plane: 64 lx below it, and less elsewhere.
        self.assertLess(abs(message["maximum"] - 64), 3)

    def test_without_a_plane_pictures_have_a_brightness(self):
        message, exposure = self.measured("Terrain")
        self.assertIn("no plane of desks", message["problem"])
        self.assertNotIn("mean", message)
        self.assertTrue(np.isfinite(exposure) and exposure > 0)


if __name__ == "__main__":
    unittest.main()
