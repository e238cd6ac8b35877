"""The intervals that the studio states: what they should cover, over seeds. Runs where benches/peers/install.sh has
installed `studio`."""

import math
import unittest
from dataclasses import replace

from support import Case, context, lit_room, luxfer, np
from support_studio import StudioCase

from luxfer.studio import intervals

#: Sides of the square lamps of the generated photo, in metres.
PANEL = 0.56


def transfer_of(seed):
    """A transfer of a generated photo to the generated room, with its texture."""
    photo = luxfer.DemoPhoto(context()).run(width=360, height=240, samples=8, seed=seed)
    transfer = luxfer.Transfer(context(), photo.image("picture"), luxfer.Scene.demo(context(), "target-room"), "Ceiling")
    transfer.set_strokes(photo.image("strokes"))
    return transfer.run("view", "emission", max_texels=512)


def relight(transfer, seed, paths):
    transfer.run("relight", "relight", relight={"target_error": 1e-4, "paths": paths, "seed": seed})
    return transfer.solution, [lamp for lamp in transfer.fixtures if lamp.kind == 1]


class Covers(Case):
    """Over seeds, intervals hold what they should."""

    def test_kelvin(self):
        transfer = transfer_of(1)
        _, lamps = relight(transfer, 99, 1 << 18)
        truth = [lamp.cct for lamp in lamps]
        hits = {1.0: 0, 0.1: 0}
        for seed in range(1, 21):
            solution, lamps = relight(transfer, seed, 1 << 12)
            for share in hits:
                half = tuple(share * h for h in solution.half_width)
                low, high = intervals.kelvin(context(), lamps[:1], replace(solution, half_width=half))
                hits[share] += low <= truth[0] <= high
                self.assertLess(high / low, 1.6)  # it says something
        self.assertGreaterEqual(hits[1.0], 18)
        self.assertLess(hits[0.1], 15)  # and a tenth of the noise would not cover it

    def test_sizes(self):
        hits, ratios = 0, []
        for seed in range(1, 9):
            transfer = transfer_of(seed)
            _, lamps = relight(transfer, 1, 1 << 10)
            report = transfer.report
            bounds = intervals.sizes(lamps, report.plane_distance_error, report.texel_size)
            hits += all(low <= PANEL <= high for low, high in bounds)
            ratios.append(bounds[0][1] / bounds[0][0])
        self.assertGreaterEqual(hits, 7)
        self.assertLess(float(np.median(ratios)), 4)  # it says something

    def test_the_noise_that_a_plan_predicts(self):
        scene, hits = lit_room(), 0
        for goal in (0.5, 0.4, 0.3, 0.25):
            for width in (48, 64, 80):
                render = luxfer.Render(context(), scene)
                render.set_camera(**{k: v for k, v in scene.camera(0).items() if k != "up"})
                settings = {"width": width, "height": 2 * width // 3}
                plan = luxfer.Plan(context()).run_render(render, target_error=goal, settings=settings)
                chosen = {k: v for k, v in plan.render_params.items() if k in ("samples", "target_error", "seed")}
                low, high = intervals.of_plan(plan.report.error)
                hits += low <= render.run(**settings, **chosen).report.error <= high
        self.assertGreaterEqual(hits, 10, "of 12")


class Numbers(StudioCase):
    """What the page receives."""

    def test_bounds_hold_the_numbers(self):
        seen = {}
        self.edit(lambda header: seen.update({header["type"]: header}))
        lamps, kinds = seen["lamps"]["list"], seen["lamps"]["kinds"]
        self.assertEqual({str(lamp["kind"]) for lamp in lamps}, set(kinds))
        for lamp in lamps:
            bounds = kinds[str(lamp["kind"])]
            for (low, high), value in zip([*bounds["size"], bounds["cct"]], [*lamp["size"], lamp["cct"]]):
                self.assertLess(low, value)
                self.assertLess(value, high)
        low, high = seen["texture"]["distance_range"]
        self.assertTrue(low < seen["texture"]["distance"] < high)
        for name in ("seconds", "error"):
            low, high = seen["plan"][f"{name}_range"]
            self.assertTrue(low < seen["plan"][name] < high)
        # A size that the user states has no error of the photo's scale.
        wide = kinds["1"]["size"][0]
        pattern = {**self.project["pattern"], "scale": "lamp", "length": 0.6}
        self.edit(lambda header: seen.update({header["type"]: header}), pattern=pattern, until="lamps")
        narrow = seen["lamps"]["kinds"]["1"]["size"][0]
        self.assertLess(narrow[1] / narrow[0], 1.2)
        self.assertGreater(wide[1] / wide[0], 1.5)

    def test_the_interval_of_a_logarithm(self):
        low, high = intervals.around(2.0, 0.25)
        self.assertAlmostEqual(low * high, 4.0)
        self.assertAlmostEqual(math.log(high / low), 2 * 1.96 * 0.25)
        self.assertEqual(intervals.around(2.0, 0.0), [2.0, 2.0])


if __name__ == "__main__":
    unittest.main()
