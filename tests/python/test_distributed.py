"""Tests work on a Dask cluster of two worker processes. One is killed while it works; the results must be the same."""

import os
import signal
import unittest

from support import Case, in_ci, luxfer, np

try:
    import distributed

    import luxfer.distributed
except ImportError:
    distributed = None

SIZE = {"width": 240, "height": 160, "samples": 64, "seed": 3}


def view(context):
    scene = luxfer.Scene.demo(context, "still-life")
    return luxfer.Render(context, scene, expressions={"direct": "LDE"}, aovs="depth|object")


def room(context):
    scene = luxfer.Scene.demo(context, "target-room")
    mesh, material = scene.place_emission("Ceiling", np.eye(8).repeat(3).reshape(8, 8, 3), (100, 100, 100))
    relight = luxfer.Relight(context)
    relight.set_scene(scene, material, mesh)
    return relight


def paint(context, shot):
    """Stylises two frames of a shot; the second continues the first."""
    size = {"width": 48, "height": 36, "samples": 4}
    ball = luxfer.Guides(context, luxfer.Scene.demo(context, "sphere-on-table")).run(**size)
    stylize, frames, before = luxfer.Stylize(context, ball.demo_artwork(shot)), [], None
    for seed in (1, 2):
        still = luxfer.Guides(context, luxfer.Scene.demo(context, "still-life")).run(seed=seed, **size)
        stylize.clear_guides()
        stylize.add_guides(ball, still)
        if before is not None:
            stylize.set_motion(still.motion(before))
        frames.append(stylize.run(preset="fast", levels=2).image().numpy())
        before = still
    return frames


@unittest.skipIf(distributed is None and not in_ci(), "distributed is not installed")
class Cluster(Case):
    @classmethod
    def setUpClass(cls):
        cls.cluster = distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs="CRITICAL"
        )
        cls.client = distributed.Client(cls.cluster)
        cls.addClassCleanup(cls.cluster.close)
        cls.addClassCleanup(cls.client.close)

    def setUp(self):
        super().setUp()
        self.client.wait_for_workers(2)

    def test_a_worker_is_killed_and_the_picture_is_the_same_to_the_bit(self):
        with luxfer.Context() as context:
            # For comparison, render in one part in this process.
            alone = view(context)
            whole = self.folder / "whole.exr"
            alone.start_part(whole, {}, **SIZE).wait()
            alone.start_merge([whole], **SIZE).wait()

            killed = []

            def kill(share):
                if share > 0.2 and not killed:
                    victim = next(iter(self.client.run(os.getpid).values()))
                    killed.append(victim)
                    os.kill(victim, signal.SIGKILL)  # without warning: its current and finished work is lost

            merged = luxfer.distributed.render(
                self.client, view, context, columns=4, rows=3, ranges=2, progress=kill, **SIZE
            )
            self.assertEqual(len(killed), 1)
            self.assertEqual(merged.report.samples, SIZE["samples"])
            for name in ("beauty", "variance", "paths"):
                np.testing.assert_array_equal(merged.image(name).numpy(), alone.image(name).numpy())
            self.assertEqual(list(merged.layers), ["direct", "Depth", "IndexOB"])
            for name, layer in merged.layers.items():
                np.testing.assert_array_equal(layer.numpy(), alone.layer(name).numpy())
            # Dask's nanny has replaced the killed worker.
            self.client.wait_for_workers(2)
            self.assertNotIn(killed[0], self.client.run(os.getpid).values())

    def test_giving_up(self):
        with luxfer.Context() as context, self.assertRaises(luxfer.errors.Cancelled):
            luxfer.distributed.render(self.client, view, context, progress=lambda share: False, **SIZE)

    def test_what_a_worker_refuses_is_an_error_here(self):
        with luxfer.Context() as context, self.assertRaisesRegex(luxfer.errors.InvalidArgument, "target_error"):
            luxfer.distributed.render(self.client, view, context, target_error=0.1, **SIZE)

    def test_shots(self):
        shots = ["pen", "paint"]
        painted = luxfer.distributed.stylise(self.client, paint, shots)
        with luxfer.Context() as context:
            for shot, frames in zip(shots, painted):
                np.testing.assert_array_equal(frames, paint(context, shot))

    def test_targets(self):
        targets = [(12, 10, 8), (3, 3, 3), (1, 5, 9)]
        reports = luxfer.distributed.relight(self.client, room, targets, paths=20_000)
        with luxfer.Context() as context:
            alone = room(context)
            for target, report in zip(targets, reports):
                alone.set_target(target)
                self.assertEqual(alone.run(paths=20_000).report, report)


if __name__ == "__main__":
    unittest.main()
