"""Patterns of luminaires as an unknown: motifs in closed form, coefficients against paths, and designs whose answer is
known."""

import unittest
from dataclasses import replace

from support import Case, context, luxfer, np
from test_design import HEIGHT, LENGTH, WIDTH, at_least, at_most, box, panel

from luxfer import design
from luxfer.design import areas, coefficients, likeness, motif, observers
from luxfer.design.measure import measure, rate


def room() -> design.Room:
    return design.Room.find(box())


def project(columns: int = 2, rows: int = 2, dimmer: float = 1.0) -> design.Project:
    """A box with rows of lamps, as if a photo had shown them, and a desk."""
    found = room()
    lamps = design.layout(found, panel(1000.0), columns, rows)
    desk = areas.task(found, "desk", (1.2, 1.0, 2.8, 2.0), 0.75)
    settings = design.Settings(maintenance=0.8, samples=64, max_samples=1024)
    return design.Project(found, design.dimmed(lamps, [dimmer] * len(lamps)), (desk,), settings=settings)


class Motifs(Case):
    def test_rows_of_lamps_repeat_along_both_sides(self):
        found = motif.find(room(), design.layout(room(), panel(), 4, 3))
        lengths = sorted(float(np.linalg.norm(v)) for v in found.lattice.T)
        np.testing.assert_allclose(lengths, sorted((LENGTH / 4, WIDTH / 3)), atol=1e-5)
        self.assertEqual((len(found.cells), found.regular), (1, (True, True)))
        self.assertAlmostEqual(found.spacing, np.sqrt(LENGTH * WIDTH / 12), places=5)

    def test_the_pattern_itself_gives_its_lamps_back(self):
        lamps = design.layout(room(), panel(), 4, 3)
        placed = motif.find(room(), lamps).placed(room())
        expected = room().plan([lamp.position for lamp in lamps])
        order = np.lexsort(np.round(placed.places, 3).T)
        np.testing.assert_allclose(placed.places[order], expected[np.lexsort(np.round(expected, 3).T)], atol=1e-5)

    def test_half_the_size_has_four_times_the_lamps(self):
        found = motif.find(room(), design.layout(room(), panel(), 4, 3))
        # Shifted by half a period along one of its vectors, no lamp lies on the border.
        shifted = [found.placed(room(), scale=0.5, offset=o) for o in ((0.5, 0.0), (0.0, 0.5))]
        smaller = max(shifted, key=lambda p: len(p.places))
        self.assertEqual(len(smaller.places), 48)
        photo, now = (likeness.statistics(p, LENGTH * WIDTH) for p in (found.placed(room()), smaller))
        # The luminous share grows by 4, the size over the spacing by 2; form, rows and regularity stay.
        np.testing.assert_allclose(now - photo, (np.log(4), np.log(2), 0, 0, 0), atol=1e-4)
        self.assertAlmostEqual(likeness.pattern_distance(photo, now), np.sqrt(5 / 5) * np.log(2), places=4)

    def test_a_turn_turns_the_lamps_too(self):
        lamp = design.Product.panel(context(), 1.2, 0.2, 3000.0)
        found = motif.find(room(), design.layout(room(), lamp, 1, 1))
        before, after = (found.placed(room(), turn=t).angles[0] for t in (0, 90))
        self.assertAlmostEqual((after - before) % 180, 90)

    def test_lamps_that_the_border_cuts_do_not_count(self):
        lamps = list(design.layout(room(), panel(), 2, 2))
        x, y, _ = lamps[0].position
        cut = replace(lamps[0], product=design.Product.panel(context(), 0.3, 0.1, 500.0), position=(x, y, 0.06))
        self.assertEqual(len(motif.find(room(), [*lamps, cut]).cells), 1)
        with self.assertRaisesRegex(ValueError, "no lamp of the photo shines"):
            motif.find(room(), design.dimmed(lamps, [0.0] * 4))


class Coefficients(Case):
    """What is interpolated, against paths of its own."""

    @classmethod
    def setUpClass(cls):
        cls.room = room()
        cls.desk = areas.task(cls.room, "desk", (1.2, 1.0, 2.8, 2.0), 0.75)
        cls.eyes = observers.at(cls.room, "eye", [(0.4, 1.5)], [(3.0, 1.5)])
        cls.kind = coefficients.kind(cls.room, panel(), (1.0, 1.0, 1.0))
        angles = [[0.0]]
        cls.table = coefficients.measure(cls.room, [cls.kind], angles, [cls.desk], [cls.eyes], 0.01, 0.8, 5)
        # Places between those of the grid, where interpolation has its largest error.
        places = np.array([[1.13, 0.83], [2.61, 2.07]])
        ones = np.ones((2, 3))
        cls.lamps = motif.Placed(places, np.zeros(2), np.ones(2), ones, np.tile(cls.kind.sides, (2, 1)))
        cls.hung = [coefficients.hung(cls.room, cls.kind, p, 0.0, 0.01) for p in places]
        cls.model = cls.table.model(0, cls.lamps)

    def test_the_mean_of_an_area(self):
        true = 0.8 * measure(design.lit_scene(self.room.scene, self.hung), self.desk, 1024).mean.value
        found = self.model.value(at_least("mean", 1), np.ones(2))
        self.assertLess(abs(found / true - 1), 0.03)

    def test_glare(self):
        true = rate(design.lit_scene(self.room.scene, self.hung), self.eyes, 1 << 14)[0].ugr
        found = self.model.value(at_most("glare", 19, "eye"), np.ones(2))
        self.assertLess(abs(found - true), 0.5, "UGR")

    def test_the_position_index_of_guth(self):
        # The first column of Guth's table (CIE 117): sources straight above the line of sight, by height over distance.
        for height, expected in ((0.0, 1.0), (0.5, 2.86), (1.0, 7.0)):
            ahead, above = np.array([1.0, height]) / np.hypot(1.0, height)
            found = float(coefficients.position_index(ahead, above))
            self.assertLess(abs(found / expected - 1), 0.05, f"H / R = {height}: {found}")


class Arrangements(Case):
    def test_a_design_that_may_stay_stays(self):
        lit = project().requiring(at_least("mean", 20), at_most("density", 20))
        found = lit.arrange([panel(1000.0)])
        self.assertTrue(found.feasible, found.explanation())
        self.assertEqual((found.scale, found.turn, found.offset, len(found.project.luminaires)), (1, 0, (0, 0), 4))
        self.assertLess(found.look.total, 0.02, str(found.look))
        np.testing.assert_allclose([lamp.dimmer for lamp in found.project.luminaires], 1, atol=0.02)
        self.assertEqual(found.prices, ())

    def test_more_light_than_the_lamps_have_needs_more_lamps(self):
        lit = project().requiring(at_least("mean", 600))
        offers = [panel(1000.0), panel(1500.0)]
        search = design.Search(keep_out=((0.0, 0.0, 1.0, WIDTH),))
        found = lit.arrange(offers, design.Wishes(max_dimmer=1), search)
        self.assertTrue(found.feasible, found.explanation())
        lamps = found.project.luminaires
        self.assertGreater(sum(lamp.product.flux for lamp in lamps), 4000)
        corners = np.array([found.project.room.plan([lamp.position])[0] for lamp in lamps])
        self.assertGreaterEqual(corners[:, 0].min(), 1.15 - 1e-6, "0.15 m is half a panel")
        self.assertTrue((corners[:, 0] <= LENGTH - 0.15 + 1e-6).all())
        self.assertTrue(all(HEIGHT - 0.1 < lamp.position[1] < HEIGHT for lamp in lamps))
        self.assertEqual(found.prices[0][0].quantity, "mean")
        self.assertIn("due to 'mean of desk at least 600 lx'", found.explanation())
        # The design is the same again.
        again = lit.arrange(offers, design.Wishes(max_dimmer=1), search)
        self.assertEqual([lamp.dimmer for lamp in again.project.luminaires], [lamp.dimmer for lamp in lamps])
        self.assertEqual([lamp.position for lamp in again.project.luminaires], [lamp.position for lamp in lamps])

    def test_luminaires_to_measure_scale_with_the_pattern(self):
        made = lambda scale: design.Product.panel(context(), 0.3 * scale, 0.3 * scale, 1000.0)  # noqa: E731
        lit = project().requiring(at_least("mean", 400))
        search = design.Search(scales=(0.5, 1.0), turns=(0.0,))
        found = lit.arrange(design.Offer.to_measure(made, search.scales), search=search)
        self.assertTrue(found.feasible, found.explanation())
        self.assertGreater(len(found.project.luminaires), 4)
        self.assertAlmostEqual(found.offer.product.size[0], 0.15, places=5, msg="half the pattern, half the opening")
        self.assertLess(found.look.pattern, 0.1, "as a made-to-measure luminaire keeps the luminous share")
        # Refinement does not move luminaires closer together than they were made for.
        self.assertIn(found.scale, search.scales)
        # One size for all scales changes the statistics.
        fixed = lit.arrange([made(1.0)], search=search)
        self.assertGreater(fixed.look.pattern, 2 * found.look.pattern)

    def test_large_changes_of_one_part_cost_more(self):
        look = lambda pattern, delta_e: likeness.Likeness(pattern, 0, 0.1, delta_e, 0, 1, 0, (0, 0), 0)  # noqa: E731
        small, large = look(0.1, 3.0), look(0.1, 6.0)
        self.assertEqual(small.cost, small.total)
        self.assertEqual((large.total, large.cost), (small.total, small.total + 1), "twice the small difference")
        self.assertLess(look(0.1, 3.0).cost, look(0.0, 6.0).cost)
        self.assertGreater(look(0.0, 6.0).cost, look(0.0, 3.1).cost)

    def test_cubic_weights_are_exact_for_straight_lines(self):
        x = np.array([-0.5, 0.0, 0.3, 1.0, 1.9, 2.0, 7.0])
        for count in (1, 2, 3, 6):
            values = np.linspace(0, 2, count) if count > 1 else np.array([1.0])
            weights = coefficients._cubic(values, x)
            np.testing.assert_allclose(weights.sum(axis=0), 1, atol=1e-12)
            # Places outside the grid count as its border.
            line = 3 * np.clip(x, 0, 2) - 1 if count > 1 else 2.0
            np.testing.assert_allclose((3 * values - 1) @ weights, line, atol=1e-12)

    def test_equal_light_shares_its_coefficients(self):
        kinds = [coefficients.kind(room(), panel(f), (1.0, 1.0, 1.0)) for f in (1000.0, 1500.0)]
        narrow = replace(kinds[0], intensities=kinds[0].intensities ** 2)
        self.assertEqual([kinds[0].like(k) for k in (kinds[1], narrow)], [True, False])
        desk = areas.task(room(), "desk", (1.2, 1.0, 2.8, 2.0), 0.75)
        table = coefficients.measure(room(), kinds, [[0.0], [0.0]], [desk], [], 0.01, 0.8, 5)
        lamps = motif.Placed(np.array([[1.5, 1.5]]), np.zeros(1), np.ones(1), np.ones((1, 3)), np.ones((1, 2)))
        one, more = (table.model(n, lamps).value(at_least("mean", 1), np.ones(1)) for n in (0, 1))
        self.assertAlmostEqual(more / one, 1.5, places=6)

    def test_a_reserve_is_kept(self):
        exact = design.Settings(maintenance=0.8, samples=4096)
        lit = replace(project(dimmer=0.1), settings=exact).requiring(at_least("mean", 50))
        for reserve in (0.0, 0.1):
            solution = lit.solve(design.Wishes(reserve=reserve))
            value = solution.checked.findings[0].value
            self.assertLess(abs(value / 50 - max(reserve, 0.005) - 1), 0.02, f"{value} lx with a reserve of {reserve}")
        with self.assertRaisesRegex(ValueError, "reserve = 1"):
            lit.solve(design.Wishes(reserve=1.0))

    def test_the_darkest_points_are_measured(self):
        desk = areas.task(room(), "desk", (0.2, 0.2, 3.8, 2.8), 0.75)
        lux = np.linspace(100, 200, desk.count)
        lux[7] = 1.0
        few = areas.thinned(desk, 8, lux)
        points = few.patches[0].points[few.patches[0].keep]
        self.assertIn(desk.patches[0].points[desk.patches[0].keep][7].tolist(), points.tolist())
        # They count for the smallest value, but not for the mean, which stays that of the spread points.
        spread = areas.thinned(desk, 8)
        self.assertEqual(few.weights.shape, (few.count,))
        self.assertEqual(int((few.weights > 0).sum()), spread.count)
        self.assertAlmostEqual(few.weights.sum(), 1)

    def test_what_no_pattern_meets_is_explained(self):
        lit = project().requiring(at_least("mean", 60), at_most("density", 0.5))
        small = design.Search(scales=(0.7, 1.0), turns=(0.0,), offsets=(0.0,))
        found = lit.arrange([panel(1000.0)], design.Wishes(max_dimmer=1), small)
        self.assertFalse(found.feasible)
        relaxed = r"none of 2 patterns .*'density at most 0.5 W/m²' becomes at most [\d.]+"
        self.assertRegex(found.explanation(), relaxed)

    def test_wrong_wishes_are_named(self):
        lit = project().requiring(at_least("mean", 20))
        with self.assertRaisesRegex(ValueError, "offers is empty"):
            lit.arrange([])
        with self.assertRaisesRegex(ValueError, "keep-out.*max_lamps = 80"):
            lit.arrange([panel()], search=design.Search(keep_out=((0, 0, LENGTH, WIDTH),)))
        with self.assertRaisesRegex(ValueError, "kelvin = "):
            lit.arrange([design.Offer(panel(), (4000, 3000))])


if __name__ == "__main__":
    unittest.main()
