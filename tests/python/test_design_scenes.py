"""Light scenes of a design: emergency light and energy against sums by hand, intervals of extremes, modelling."""

import contextlib
import csv
import io
import math
import unittest
from dataclasses import replace

from support import Case, context, luxfer, np
from test_design import LENGTH, WIDTH, at_least, at_most, project

from luxfer import design
from luxfer.design import areas, emergency, fingerprint, schedule
from luxfer.design.energy import YEAR
from luxfer.design.intervals import Extremes, student


def point_lamp(albedo: float = 0.0) -> design.Project:
    """A box under one luminaire that shines from a point, with the intensity 3000 lm / pi times the cosine."""
    lit = project(albedo, 1, 16)
    point = design.Product.panel(context(), 0, 0, 3000.0, watts=30, rendering=80)
    return replace(lit, luminaires=design.layout(lit.room, point, 1, 1))


def rays(lit: design.Project, area: areas.Area) -> tuple[np.ndarray, np.ndarray]:
    """Cosine of the angle from the vertical, and distance, of the points of an area from its one luminaire."""
    points = area.patches[0].points[area.patches[0].keep]
    towards = np.array(lit.luminaires[0].position) - points
    distance = np.linalg.norm(towards, axis=1)
    return towards[:, 1] / distance, distance


def grouped() -> design.Project:
    """Two lamps, each a group."""
    lit = project(0.5, 2, 64)
    lamps = [replace(lamp, group=name) for lamp, name in zip(lit.luminaires, ("window", "door"))]
    return replace(lit, luminaires=lamps)


class ExtremesOfPoints(Case):
    """Against 200 repetitions with 16 batches, whose points have the truth 1, 1.1, ..., 2."""

    TRUTH = np.linspace(1, 2, 11)

    @classmethod
    def setUpClass(cls):
        batches = cls.TRUTH + 0.2 * np.random.default_rng(1).standard_normal((200, 16, len(cls.TRUTH)))
        cls.runs = [Extremes(b.mean(axis=0), b.std(axis=0, ddof=1) / 4) for b in batches]

    def test_intervals_contain_the_truth(self):
        """95 % of 200 less three standard deviations of the count. The intervals end where a limit is just decided."""
        for quantity, decided, truth, width in (
            ("smallest", "smallest_at_least", 1.0, 0.4),
            ("diversity", "diversity_at_most", 2.0, 0.8),
        ):
            confidences = [getattr(run, decided)(truth) for run in self.runs]
            self.assertGreaterEqual(sum(max(c) < 0.975 for c in confidences), 180, quantity)
            found = [getattr(run, f"interval_of_{quantity}")() for run in self.runs[:20]]
            self.assertLess(np.median([high - low for low, high in found]), width, "too wide to be of use")
            for (low, high), confidence in zip(found, confidences):
                self.assertEqual(low <= truth <= high, max(confidence) < 0.975)

    def test_a_limit_just_missed_is_rarely_passed(self):
        """2.5 % of 200 plus three standard deviations."""
        self.assertLessEqual(sum(run.smallest_at_least(1 + 1e-9)[0] >= 0.975 for run in self.runs), 12)
        self.assertLessEqual(sum(run.diversity_at_most(2 - 1e-9)[0] >= 0.975 for run in self.runs), 12)

    def test_what_is_clear_is_decided(self):
        for run in self.runs:
            self.assertGreater(run.smallest_at_least(0.6)[0], 0.975)
            self.assertGreater(run.smallest_at_least(1.6)[1], 0.975)
            self.assertGreater(run.diversity_at_most(5)[0], 0.975)
            self.assertGreater(run.diversity_at_most(1.1)[1], 0.975)

    def test_the_worst_pair_is_among_those_that_are_looked_at(self):
        """Against all pairs, for points of very different errors."""
        random = np.random.default_rng(2)
        for _ in range(50):
            values, errors = random.uniform(1, 2, 30), random.choice([0.0, 0.01, 0.1, 0.5], 30)
            for limit in (1.1, 1.5, 2.5):
                with np.errstate(divide="ignore"):
                    gaps = limit * values[:, None] - values[None]
                    all_pairs = gaps / np.hypot(limit * errors[:, None], errors[None])
                met = student(float(np.nanmin(all_pairs)), 15)
                self.assertAlmostEqual(Extremes(values, errors).diversity_at_most(limit)[0], met, places=12)

    def test_darkness_and_what_is_not_known(self):
        dark = Extremes(np.array([0.0, 1.0]), np.zeros(2))
        self.assertEqual((dark.diversity, dark.diversity_at_most(1e9)), (math.inf, (0.0, 1.0)))
        self.assertEqual(dark.interval_of_diversity(), (math.inf, math.inf))
        unknown = Extremes(np.array([1.0, math.nan]), np.ones(2))
        self.assertTrue(all(map(math.isnan, unknown.smallest_at_least(1))))


class Emergency(Case):
    def test_only_the_light_straight_from_the_luminaires_counts(self):
        lit = point_lamp(0.7)
        line, band = emergency.escape_route(lit.room, "way out", (0.2, 1.0, 3.8, 2.0))
        limits = tuple(emergency.requirements([line, band]))
        state = design.LightScene("emergency", [0.05], limits, direct=True)
        lit = replace(lit, areas=(line, band), scenes=(state,))
        found = lit.check_scenes()["emergency"]
        cosine, distance = rays(lit, line)
        expected = 0.8 * 0.05 * 3000 / math.pi * cosine**2 / distance**2
        np.testing.assert_allclose(found.fields[line.name].values, expected, rtol=2e-3)
        values = {(f.requirement.quantity, f.requirement.area): f.value for f in found.findings}
        np.testing.assert_allclose(values["minimum", line.name], expected.min(), rtol=2e-3)
        np.testing.assert_allclose(values["diversity", line.name], expected.max() / expected.min(), rtol=4e-3)
        self.assertTrue(found.passes, found.verdict())
        bright = replace(lit, scenes=(replace(state, direct=False),)).check_scenes()["emergency"]
        self.assertGreater(bright.fields[line.name].values.min(), 1.3 * expected.min())

    def test_too_little_light_fails(self):
        lit = point_lamp()
        line, _ = emergency.escape_route(lit.room, "way out", (0.2, 1.0, 3.8, 2.0))
        limits = tuple(emergency.requirements([line]))
        lit = replace(lit, areas=(line,), scenes=(design.LightScene("emergency", [0.003], limits, direct=True),))
        outcomes = [f.outcome for f in lit.check_scenes()["emergency"].findings]
        self.assertEqual(outcomes, ["fails", "passes", "passes"])

    def test_the_line_and_the_band_of_a_route(self):
        room = project().room
        for rectangle, across in (((0.2, 1.0, 3.8, 2.2), 1), ((1.0, 0.2, 2.2, 2.8), 0)):
            line, band = emergency.escape_route(room, "way out", rectangle)
            lanes = [room.plan(a.patches[0].points.reshape(-1, 3))[:, across] for a in (line, band)]
            middle = rectangle[across] + 0.6
            np.testing.assert_allclose(lanes[0], middle)
            self.assertTrue((np.abs(lanes[1] - middle) < 0.3).all())
            self.assertGreater(np.ptp(lanes[1]), 0.3)
            runs = room.plan(line.patches[0].points.reshape(-1, 3))[:, 1 - across]
            self.assertLessEqual(np.diff(np.sort(runs)).max(), emergency.STEP + 1e-6)

    def test_routes_that_are_none(self):
        room = project().room
        with self.assertRaisesRegex(ValueError, "is 2.5 m wide: one up to 2 m has a centre line"):
            emergency.escape_route(room, "hall", (0, 0, 4, 2.5))
        with self.assertRaisesRegex(ValueError, "leaves the room"):
            emergency.escape_route(room, "way out", (0, 1, 5000, 2000), "mm")
        with self.assertRaisesRegex(ValueError, "EN 1838 has no requirement"):
            emergency.requirements([areas.walls(room)])

    def test_a_task_of_high_risk(self):
        lit = project()
        for maintained, level in ((100, 15), (500, 50)):
            found = emergency.requirements(lit.areas, maintained)
            self.assertEqual(
                [(r.quantity, r.limit) for r in found], [("mean", level), ("uniformity", 0.1), ("rendering", 40)]
            )
        with self.assertRaisesRegex(ValueError, "give its maintained illuminance"):
            emergency.requirements(lit.areas)

    def test_a_black_copy_has_no_light_of_its_own(self):
        scene = luxfer.Scene.demo(context(), "target-room")
        scene.set_environment((5, 5, 5))
        copy = emergency.black(scene)
        self.assertEqual(copy.counts.triangles, scene.counts.triangles)
        desk = areas.task_on(design.Room.find(scene), "desk", "Table")
        self.assertEqual(luxfer.design.measure.measure(copy, desk, 16).values.max(), 0)


class Scenes(Case):
    def test_dimmers_by_group_and_by_number(self):
        lamps = grouped().luminaires
        shares = lambda dimmers: [lamp.dimmer for lamp in design.LightScene("a", dimmers).lamps(lamps)]  # noqa: E731
        self.assertEqual(shares(None), [1, 1])
        self.assertEqual(shares({"door": 0.3}), [0, 0.3])
        self.assertEqual(shares({"door": 0.3, "*": 0.5}), [0.5, 0.3])
        self.assertEqual(shares([0.1, 0.2]), [0.1, 0.2])
        for wrong, words in (({"wall": 1}, "names the group 'wall': there are door, window"), ({"door": 1.5}, "1.5")):
            with self.assertRaisesRegex(ValueError, words):
                shares(wrong)
        with self.assertRaisesRegex(ValueError, "there are 3 dimmers for 2 luminaires"):
            shares([1, 1, 1])

    def test_each_state_is_checked_by_its_own_requirements(self):
        states = (
            design.LightScene("work", None, (at_least("mean", 100),)),
            design.LightScene("slides", {"*": 0.25}, (at_least("mean", 100),), maintenance=0.4),
            design.LightScene("off", {"*": 0.0}),
        )
        lit = replace(grouped(), scenes=states)
        found = lit.check_scenes()
        self.assertEqual(list(found), ["work", "slides"])
        work, slides = (found[n].findings[0] for n in ("work", "slides"))
        self.assertEqual((work.outcome, slides.outcome), ("passes", "fails"))
        self.assertAlmostEqual(slides.value / work.value, 0.25 * 0.4 / 0.8, delta=0.01)
        with self.assertRaisesRegex(ValueError, "no light scene is called 'party': there are work, slides, off"):
            lit.in_scene("party")

    def test_the_smallest_illuminance_is_solved_for(self):
        lit = replace(project(0.0, 2, 16), luminaires=design.dimmed(project().luminaires, (0.2, 0.2)))
        found = lit.requiring(at_least("minimum", 90)).solve()
        self.assertTrue(found.feasible, found.explanation())
        self.assertAlmostEqual(found.checked.findings[0].value, 90, delta=2)
        self.assertAlmostEqual(found.look.pattern, 0, places=3)


class Modelling(Case):
    def test_one_source_by_hand(self):
        """The cylindrical illuminance of one source is its horizontal part divided by pi."""
        lit = point_lamp()
        faces = areas.cylindrical(lit.room)
        found = replace(lit, areas=(faces,)).requiring(at_least("modelling", 0.1, "faces")).check().findings[0]
        cosine, distance = rays(lit, faces)
        light = cosine / distance**2
        expected = (light * np.sqrt(1 - cosine**2)).sum() / math.pi / (light * cosine).sum()
        self.assertAlmostEqual(found.value, expected, delta=expected * (areas.PLANES_ERROR + 2e-3))
        self.assertLessEqual(found.low, expected)
        self.assertGreaterEqual(found.high, expected)
        self.assertIn("single points", found.note)

    def test_it_needs_a_cylindrical_area(self):
        with self.assertRaisesRegex(ValueError, "'desk' is no cylindrical area"):
            project(samples=16).requiring(at_least("modelling", 0.3)).check()


class EnergyOfAYear(Case):
    def lit(self, **more):
        day = design.Hours(2000, 300, occupancy=0.9, daylight=0.6, constant=0.95)
        states = (
            design.LightScene("work", {"*": 0.8}, hours=day),
            design.LightScene("slides", {"door": 0.5}, hours=design.Hours(100, 0)),
            design.LightScene("emergency", {"door": 0.1}),
        )
        return replace(grouped(), scenes=states, standby=design.Standby(controls=2, charging=3), **more)

    def test_leni_by_hand(self):
        """Two luminaires of 30 W each in 12 m²."""
        work = 2 * 30 * 0.8 * 0.95 * 0.9 * (2000 * 0.6 + 300) / 1000
        slides = 30 * 0.5 * 100 / 1000
        beside = (2 * (8760 - 2400) + 3 * 8760) / 1000
        found = self.lit().energy()
        self.assertAlmostEqual(found.lighting, work + slides)
        self.assertAlmostEqual(found.parasitic, beside)
        self.assertAlmostEqual(found.leni, (work + slides + beside) / (LENGTH * WIDTH), places=5)

    def test_a_limit_of_the_energy(self):
        for limit, outcome in ((9, "passes"), (8, "fails")):
            lit = self.lit().requiring(at_most("energy", limit))
            self.assertEqual(lit.check().findings[0].outcome, outcome)
        solved = self.lit().requiring(at_most("energy", 9), at_least("mean", 20)).solve()
        self.assertEqual([f.outcome for f in solved.checked.findings], ["passes", "passes"])

    def test_what_is_unknown_does_not_pass(self):
        lit = self.lit().requiring(at_most("energy", 100))
        dark = [replace(lamp, product=replace(lamp.product, watts=0)) for lamp in lit.luminaires]
        for unknown, note in (
            (replace(lit, scenes=()), "no light scene has hours of use"),
            (replace(lit, luminaires=dark), "no stated power"),
        ):
            found = unknown.check().findings[0]
            self.assertEqual(found.outcome, "unknown")
            self.assertIn(note, found.note)

    def test_hours_that_no_year_has(self):
        for make, words in (
            (lambda: design.Hours(8000, 1000), "no part of 8760 hours"),
            (lambda: design.Hours(1, 1, daylight=1.2), "daylight = 1.2"),
            (lambda: design.Standby(charging_hours=YEAR + 1), "at most 8760"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                make()
        twice = [design.LightScene(n, hours=design.Hours(4000, 1000)) for n in "ab"]
        with self.assertRaisesRegex(ValueError, "used 10000 hours a year"):
            replace(grouped(), scenes=twice).energy()


class OwnPlaces(Case):
    HEAD = "name,table,illuminance,uniformity,glare,rendering,walls\n"

    def read(self, text):
        path = self.folder / "places.csv"
        path.write_text(text)
        return design.places_from(path)

    def test_rows_of_a_file(self):
        rows = self.read(self.HEAD + "Workshop: fine work,Table 99,750,0.7,19,90,\nStore,Table 99,100,0.4,25,80,30\n")
        row = design.place("fine work", rows)
        self.assertEqual((row.illuminance, row.rendering, row.walls, row.number), (750, 90, 0, ""))
        found = design.requirements(row, {"bench": "task", "walls": "walls"})
        self.assertEqual(
            [(r.quantity, r.limit) for r in found], [("mean", 750), ("uniformity", 0.7), ("rendering", 90)]
        )
        self.assertEqual(found[0].reference, "EN 12464-1:2021, Table 99")
        with self.assertRaisesRegex(KeyError, "no place is called '34.2'.*one of: Workshop: fine work; Store"):
            design.place("34.2", rows)

    def test_the_command_line_takes_them(self):
        self.read(self.HEAD + "Workshop,Table 99,750,0.7,19,90,\n")
        out, wrong = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(wrong):
            self.assertEqual(design.main(["--places", "--places-from", str(self.folder / "places.csv")]), 0)
            self.assertEqual(design.main(["--places", "--places-from", str(self.folder / "none.csv")]), 3)
        self.assertEqual(out.getvalue().split(), ["Workshop"])
        self.assertIn("none.csv", wrong.getvalue())

    def test_rows_that_are_none(self):
        for text, words in (
            ("name,lux\na,500\n", "columns that are no fields of a place: lux; there are number, name, table"),
            ("name,table,illuminance\na,b,500\n", "no column: uniformity, glare, rendering"),
            (self.HEAD + "a,b,500,0.6,19,80,\nc,d,much,0.6,19,80,\n", "line 3 .*: illuminance is 'much'"),
            (self.HEAD + "a,b,500,,19,80,\n", "line 2 .*: uniformity is 0; it must be finite and above 0"),
            (self.HEAD + ",b,500,0.6,19,80,\n", "line 2 .* has no name"),
            ("", "no column: name"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                self.read(text)


class Schedules(Case):
    def test_the_luminaires_and_their_light_scenes(self):
        lit = grouped()
        product = replace(lit.luminaires[0].product, reference="panel.gldf", name='=cmd|"x"')
        lamps = [replace(lit.luminaires[0], product=product, dimmer=0.5, c0=(0, 0, 1)), lit.luminaires[1]]
        states = (design.LightScene("slides", {"door": 0.2}),)
        lit = replace(lit, luminaires=lamps, scenes=states, unit="mm")
        one, two = csv.DictReader(io.StringIO(schedule.luminaires(lit), newline=""))
        place = [float(one[n]) for n in ("along_mm", "across_mm", "height_mm", "turn_deg", "tilt_deg")]
        np.testing.assert_allclose(place, (1000, 1500, 2790, 90, 0), atol=1e-3)
        self.assertEqual([one[n] for n in ("reference", "group", "dimmer")], ["panel.gldf", "window", "0.5"])
        self.assertEqual((one["flux_lm"], one["full_flux_lm"], one["power_w"]), ("1500", "3000", "15"))
        self.assertEqual([row["dimmer in slides"] for row in (one, two)], ["0", "0.2"])
        self.assertEqual(one["product"], ' =cmd|"x"', "a spreadsheet must not compute it")

    def test_the_results_of_all_light_scenes(self):
        state = design.LightScene("slides", {"*": 0.1}, (at_least("mean", 1000),))
        lit = replace(grouped(), scenes=(state,)).requiring(at_least("mean", 1), at_most("density", 9))
        path = design.save(lit, self.folder / "lamps.csv", found := lit.check())
        self.assertEqual(path.read_bytes().decode(), schedule.luminaires(lit))
        text = (self.folder / "lamps-results.csv").read_bytes().decode()
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
        self.assertEqual([r["light scene"] for r in rows], ["", "", "slides"])
        self.assertEqual([r["outcome"] for r in rows], ["passes", "passes", "fails"])
        self.assertAlmostEqual(float(rows[0]["value"]), found.findings[0].value, delta=0.01)
        self.assertLess(float(rows[0]["low"]), float(rows[0]["value"]))


class Reported(Case):
    def test_the_report_has_each_light_scene(self):
        lit = grouped()
        line, band = emergency.escape_route(lit.room, "way out", (0.2, 1.0, 3.8, 2.0))
        states = (
            design.LightScene("work", None, (at_least("mean", 1),), hours=design.Hours(1000, 0)),
            design.LightScene("blackout", {"door": 0.1}, tuple(emergency.requirements([line, band])), direct=True),
        )
        lit = replace(lit, areas=(*lit.areas, line, band), scenes=states).requiring(at_most("energy", 30))
        page = design.save(lit, self.folder / "report.html", images={}).read_text()
        found = lit.check_scenes()
        for words in (
            "Light scene: blackout",
            "EN 1838:2013, 4.2, escape route",
            "without reflections",
            f"LENI = {lit.energy().leni:.2f} kWh/(m² a)",
            *(f"Light scene {name}: {one.verdict()}" for name, one in found.items()),
        ):
            self.assertIn(words, page)

    def test_the_hash_follows_the_light_scenes(self):
        lit = grouped()
        states = [
            (),
            (design.LightScene("a", {"door": 0.5}),),
            (design.LightScene("a", {"door": 0.4}),),
            (design.LightScene("a", {"door": 0.4}, direct=True),),
            (design.LightScene("a", {"door": 0.4}, (at_least("mean", 5),)),),
            (design.LightScene("a", {"door": 0.4}, hours=design.Hours(1, 1)),),
        ]
        hashes = {fingerprint.digest(replace(lit, scenes=s).record()) for s in states}
        hashes.add(fingerprint.digest(replace(lit, standby=design.Standby(1)).record()))
        self.assertEqual(len(hashes), len(states) + 1)
        named = replace(lit, scenes=(design.LightScene("a", [0, 0.4]),))
        self.assertEqual(
            fingerprint.digest(named.record()), fingerprint.digest(replace(lit, scenes=states[2]).record())
        )


if __name__ == "__main__":
    unittest.main()
