"""Tests each stage through Python: transfers, renderings with layers, illuminance, relighting, stylisation, sheets,
scenes."""

import unittest

from support import Case, context, demo, lit_room, luxfer, np

from luxfer import errors


class Transfer(Case):
    def test_the_whole_transfer(self):
        photo, strokes = demo()
        room = luxfer.Scene.demo(context(), "target-room")
        transfer = luxfer.Transfer(context(), photo, room, "Ceiling")
        transfer.set_strokes(strokes.numpy(np.uint8, "srgb"))
        settings = {"max_texels": 256, "render": {"width": 80, "height": 45, "samples": 8}, "relight": {"paths": 1 << 16}}
        transfer.run(**settings)

        # The solution gives the ceiling of the lit scene the target colour of the report.
        report, solution = transfer.report, transfer.solution
        off = np.array(solution.scale) * solution.response - 100 * np.array(report.target)
        self.assertTrue((np.abs(off) <= np.multiply(solution.half_width, solution.response)).all(), off)
        self.assertEqual(solution.outcome, (luxfer.types.Outcome.SATISFIED,) * 3)
        self.assertTrue((transfer.image("render").numpy() >= 0).all())
        self.assertGreater(transfer.image("render").numpy().mean(), 0)

        # The scene has as many lamps as the report states; they are on the ceiling and shine down.
        surface = room.find_surface("Ceiling")
        fixtures = transfer.fixtures
        self.assertEqual(len(fixtures), report.fixtures)
        for fixture in fixtures:
            np.testing.assert_allclose(fixture.normal, surface.normal, atol=1e-5)
            self.assertAlmostEqual(fixture.position[1], surface.origin[1], places=4)

        transfer.save_fixtures(self.folder / "lamps.csv")
        self.assertEqual(len((self.folder / "lamps.csv").read_text().splitlines()), 1 + report.fixtures)

        # The lit scene can be written to a file in memory and read back.
        lit = luxfer.Scene.from_bytes(context(), transfer.scene("lit").to_bytes())
        self.assertEqual(lit.counts.triangles, transfer.scene("lit").counts.triangles)

        # Replace the mask of the lights and continue the transfer from there.
        mask = transfer.image("lights-mask").numpy()[..., 0] > 0.5
        mask[:, : mask.shape[1] // 2] = False
        before = transfer.image("emission").numpy()
        transfer.use_mask("lights", mask)
        transfer.run("unwarp", "emission", **settings)
        self.assertTrue((before != transfer.image("emission").numpy()).any())

    def test_the_principal_point_makes_up_for_a_crop(self):
        photo = luxfer.DemoPhoto(context()).run(width=480, height=320, samples=8).image("picture")
        whole = luxfer.Rectify(context(), photo).run().report
        pixels = photo.numpy()
        height, width = pixels.shape[:2]
        rows = np.ascontiguousarray(pixels[: height * 3 // 4])
        given = luxfer.Rectify(context(), rows).run(principal=(width / 2, height / 2)).report
        self.assertEqual(given.principal, (width / 2, height / 2))
        guessed = luxfer.Rectify(context(), rows).run().report
        self.assertEqual(guessed.principal, (width / 2, rows.shape[0] / 2))

        def turned(report):
            axes = [np.reshape(r.axes, (3, 3)) for r in (whole, report)]
            return np.degrees(np.arccos(np.clip(np.abs(np.sum(axes[0] * axes[1], axis=0)), 0, 1))).max()

        self.assertLess(turned(given), 1)
        self.assertGreater(turned(guessed), 2 * turned(given))

    def test_two_planes_run_together(self):
        photo, strokes = demo()
        room = luxfer.Scene.demo(context(), "target-room")
        mask = np.zeros((*photo.size[1::-1], 1), np.float32)
        mask[-20:] = 1
        settings = {"max_texels": 128, "relight": {"paths": 1 << 14}, "render": {"width": 32, "height": 18, "samples": 2}}

        def planes():
            ceiling, floor = (luxfer.Transfer(context(), photo, room, name) for name in ("Ceiling", "Floor"))
            ceiling.set_strokes(strokes)
            floor.set_texture(np.pad(np.ones((2, 2, 3), np.float32), ((7, 7), (7, 7), (0, 0))))
            floor.use_mask("plane", mask)
            floor.use_mask("lights", 0 * mask)
            return [ceiling, floor]

        both, seen = planes(), []
        both[0].run(last="unwarp")
        together = luxfer.Transfer.run_all(both, "emission", "render", [settings] * 2, seen.append)
        self.assertIs(together[1], both[1])
        self.assertEqual((seen, seen[-1]), (sorted(seen), 1.0))
        scales = [np.array(plane.solution.scale) for plane in both]
        np.testing.assert_array_equal(both[0].image("render").numpy(), both[1].image("render").numpy())

        # In the other order, the results are the same; the floor's light is in the background of the ceiling.
        again = planes()
        again[0].run(last="unwarp")
        luxfer.Transfer.run_all(again[::-1], "emission", "relight", settings)
        for scale, plane in zip(scales, again):
            np.testing.assert_array_equal(scale, plane.solution.scale)
        self.assertTrue((np.array(both[0].solution.background) > 0).all())

        with self.assertRaisesRegex(errors.InvalidArgument, r"transfers\[1\].*transfers\[0\]"):
            luxfer.Transfer.run_all([both[0], both[0]])
        with self.assertRaisesRegex(ValueError, "settings of 1 transfers for 2"):
            luxfer.Transfer.run_all(both, params=[settings])
        with self.assertRaisesRegex(ValueError, "no transfers"):
            luxfer.Transfer.run_all([])

    def test_the_stages_one_by_one_make_what_the_transfer_makes(self):
        photo, strokes = demo()
        view = luxfer.Rectify(context(), photo).run()
        features = luxfer.Features(context(), photo)
        features.set_view(view)
        features.set_strokes(strokes)
        features.run()
        plane = luxfer.Segment(context(), features.image())
        plane.set_strokes("plane", strokes)
        plane.run()
        transfer = luxfer.Transfer(context(), photo)
        transfer.set_strokes(strokes)
        transfer.run(last="plane")
        np.testing.assert_array_equal(plane.image("mask").numpy(), transfer.image("plane-mask").numpy())
        self.assertEqual(view.report.vanishing_points, transfer.view.vanishing_points)

        lights = luxfer.Segment(context(), features.image())
        lights.set_region(plane.image())
        lights.set_strokes("lights", strokes)
        lights.run(channels=7)
        view.set_mask(plane.image())
        view.run(max_side=256)
        unwarped, to_photo = view.image("unwarped"), view.report.to_photo
        self.assertEqual(view.report.undone, 0)
        np.testing.assert_array_equal(view.undistort(photo).numpy(), photo.numpy())
        light = view.undistort(lights.image("confidence")).warp(to_photo, *unwarped.size[:2])
        emission = luxfer.Emission(context(), unwarped, light, view.image("valid"))
        emission.set_photo(view.undistort(photo), to_photo)
        emission.run(width=128, height=96)
        lamps = emission.luminaires
        self.assertEqual(len(lamps), emission.report.luminaires)
        self.assertAlmostEqual(sum(lamp.flux_share for lamp in lamps), 1, places=3)
        outline = emission.outline(0)
        self.assertEqual(outline.shape, (lamps[0].corners, 2))
        self.assertTrue(((outline >= 0) & (outline <= (128, 96))).all())

    def test_warnings(self):
        photo, strokes = demo()
        transfer = luxfer.Transfer(context(), photo)
        with self.assertRaises(errors.NotReady):
            transfer.warnings
        transfer.set_strokes(strokes)
        # With a mask of lights that covers the whole plane, the transfer warns.
        transfer.use_mask("plane", np.ones(photo.size[1::-1], np.float32))
        transfer.use_mask("lights", np.ones(photo.size[1::-1], np.float32))
        transfer.run(last="features")
        lit = [w for w in transfer.warnings if w.code == luxfer.types.WarningCode.ALMOST_ALL_LIT]
        self.assertEqual(len(lit), 1, transfer.warnings)
        self.assertEqual((lit[0].stage, lit[0].severity, lit[0].place), (luxfer.types.Stage.LIGHTS, 1.0, None))
        self.assertIn("100 %", lit[0].message)
        self.assertTrue(lit[0].advice and str(lit[0]).startswith("lights: lights cover 100 %"))

        # A part of the photo without strokes causes a warning with its place; a stroke there removes the warning.
        face = np.random.default_rng(1).normal(0, 0.05, (60, 80, 1)).astype(np.float32)
        face[:30] += 1
        face[:30, 50:] += 5
        segment, lines = luxfer.Segment(context(), face), luxfer.Strokes(context(), 80, 60)
        for y, positive in ((5, True), (20, True), (40, False), (50, False)):
            lines.add("plane", [(5, y), (45, y)], radius=2, positive=positive)
        segment.set_strokes("plane", lines)
        segment.run()
        unseen = [w for w in segment.warnings if w.code == luxfer.types.WarningCode.UNSEEN]
        self.assertEqual([w.stage for w in unseen], [luxfer.types.Stage.PLANE])
        self.assertGreater(unseen[0].severity, unseen[0].limit)
        x, y = unseen[0].place
        self.assertTrue(50 < x < 80 and y < 30, unseen[0])
        lines.add("plane", [(x, y)], radius=2, positive=True)
        segment.set_strokes("plane", lines)
        self.assertNotIn(luxfer.types.WarningCode.UNSEEN, [w.code for w in segment.run().warnings])

        # Each stage has a list of warnings.
        dark = np.zeros((32, 32, 3), np.float32)
        dark[8:12, 8:12] = 1
        single = luxfer.Emission(context(), dark, dark[..., 0], np.ones((32, 32))).run(width=96, height=96)
        self.assertIn(luxfer.types.WarningCode.FEW_LAMPS, [w.code for w in single.warnings])
        features = luxfer.Features(context(), photo).run()
        self.assertEqual([w.code for w in features.warnings], [luxfer.types.WarningCode.LAYOUT_UNCERTAIN])
        self.assertIsInstance(luxfer.Rectify(context(), photo).run().warnings, list)
        room = luxfer.Scene.demo(context(), "target-room")
        mesh, material = room.place_emission("Ceiling", np.eye(8).repeat(3).reshape(8, 8, 3), (100, 100, 100))
        relight = luxfer.Relight(context())
        relight.set_scene(room, material, mesh)
        relight.set_target((12, 10, 8))
        self.assertEqual(relight.run(paths=1 << 14).warnings, [])
        relight.set_constraint(("at-least", "equal", "equal"))
        clipped = relight.run(paths=1 << 14).warnings
        self.assertEqual([w.code for w in clipped], [luxfer.types.WarningCode.TARGET_CLIPPED])

    def test_tiles_and_styles(self):
        def exemplar(lamp):
            image = np.zeros((80, 80, 3), np.float32)
            for y in range(4, 80, 16):
                for x in range(4, 80, 16):
                    image[y : y + lamp, x : x + lamp] = 0.8
            return image, image[..., 0].copy(), np.ones((80, 80), np.float32)

        emission = luxfer.Emission(context(), *exemplar(4))
        whole = emission.run(width=150, height=130).image().numpy()
        mask = emission.image("mask").numpy()
        lamps, lit = emission.luminaires, emission.report.exemplar_lamps
        emission.start_composition(width=150, height=130).wait()
        self.assertEqual(emission.report.exemplar_lamps, lit)
        planned = {lamp.centre: lamp.area for lamp in emission.luminaires}
        self.assertEqual(planned, {lamp.centre: lamp.area for lamp in lamps})
        with self.assertRaises(luxfer.errors.NotReady):
            emission.image("texture")
        for x, y, width, height in ((100, 90, 50, 40), (0, 0, 7, 130), (149, 129, 1, 1)):
            tile = emission.tile(x, y, width, height).numpy()
            np.testing.assert_array_equal(tile[..., :3], whole[y : y + height, x : x + width])
            np.testing.assert_array_equal(tile[..., 3:], mask[y : y + height, x : x + width])
        with self.assertRaises(luxfer.errors.InvalidArgument):
            emission.tile(100, 90, 51, 40)

        # Use the first style on the left and the second on the right.
        weights = np.repeat(np.array([[0, 0, 1, 1]], np.float32), 4, axis=0)
        emission.add_style(*exemplar(8), weights)
        emission.run(width=320, height=160)
        large = [lamp.area > 40 for lamp in emission.luminaires if 16 < lamp.centre[0] < 120]
        self.assertFalse(any(large))
        self.assertTrue(all(lamp.area > 20 for lamp in emission.luminaires if 200 < lamp.centre[0] < 300))
        emission.clear_styles()
        np.testing.assert_array_equal(emission.run(width=150, height=130).image().numpy(), whole)

    def test_strokes_by_hand_and_as_text(self):
        photo = np.zeros((40, 60, 3), np.float32)
        photo[:20] = (0.8, 0.2, 0.2)
        masks = []
        for describe in (
            lambda s: (s.add("plane", [(5, 5), (50, 8)], 3, True), s.add("plane", (30.5, 35.5), 3, False)),
            lambda s: s.add_text("plane 3 5 5 50 8\nnot-plane 3 30.5 35.5 # the floor"),
        ):
            segment, strokes = luxfer.Segment(context(), photo), luxfer.Strokes(context(), 60, 40)
            describe(strokes)
            segment.set_strokes("plane", strokes)
            strokes.add("plane", (30.5, 35.5), 3, True)  # the stage has a copy
            masks.append(segment.run().image("mask").numpy()[..., 0])
            self.assertTrue((masks[-1][:20] == 1).all() and (masks[-1][20:] == 0).all())
        np.testing.assert_array_equal(*masks)
        with self.assertRaises(errors.FormatError):
            strokes.add_text("plane 3 5")
        segment.set_strokes("plane", None)
        with self.assertRaises(errors.Degenerate):
            segment.run()
        with self.assertRaisesRegex(errors.InvalidArgument, "strokes are for 40 x 60 pixels"):
            segment.set_strokes("plane", luxfer.Strokes(context(), 40, 60))


class Rendering(Case):
    def test_layers_of_light_and_of_surfaces(self):
        render = luxfer.Render(context(), lit_room(), aovs="depth|normal|alpha")
        render.add_expression("seen", "LE")
        render.add_expression("once", "L.E")
        render.add_expression("more", "L..+E")
        seconds = render.run(width=48, height=32, samples=16)
        self.assertIs(seconds, render)
        layers = {name: image.numpy() for name, image in render.layers.items()}
        self.assertEqual(list(layers), ["seen", "once", "more", "Depth", "Normal", "Alpha"])
        beauty = render.image().numpy()
        np.testing.assert_allclose(
            sum(layers[n] for n in ("seen", "once", "more")), beauty, rtol=1e-4, atol=1e-4 * beauty.mean()
        )
        np.testing.assert_array_equal(render.layer("once").numpy(), layers["once"])
        lengths = np.linalg.norm(layers["Normal"], axis=-1)
        self.assertTrue((lengths < 1.001).all())
        self.assertTrue((layers["Depth"] > 0).all())
        render.write_exr(self.folder / "layers.exr")
        np.testing.assert_array_equal(luxfer.Image.load(context(), self.folder / "layers.exr").numpy()[..., :3], beauty)
        self.assertEqual(render.report.samples, 16)
        with self.assertRaises(errors.InvalidArgument):
            render.add_expression("bad", "L(E")

    def test_parts_are_merged_to_the_same_bits(self):
        size = {"width": 40, "height": 24, "samples": 12}
        render = luxfer.Render(context(), lit_room(), aovs="depth", expressions={"direct": "LDE"})
        paths = []
        for index in range(6):
            paths.append(self.folder / f"part {index}.exr")
            part = render.split(3, 1, 2, index, **size)
            render.start_part(paths[-1], part, **size).wait()
            self.assertEqual(render.image().size, (part["width"], part["height"], 3))
        # A part is an ordinary EXR file, which shows the part at its place in the whole picture.
        picture = luxfer.Image.load(context(), paths[-1]).numpy()
        self.assertEqual(picture.shape, (24, 40, 3))
        rows, columns = slice(part["y"], part["y"] + part["height"]), slice(part["x"], part["x"] + part["width"])
        np.testing.assert_array_equal(picture[rows, columns], render.image().numpy())
        merged = render.start_merge(paths, **size).wait()
        beauty, direct = merged.image().numpy(), merged.layer("direct").numpy()
        render.start_part(self.folder / "whole.exr", {}, **size).wait()
        np.testing.assert_array_equal(render.image().numpy(), beauty)
        np.testing.assert_array_equal(render.layer("direct").numpy(), direct)
        with self.assertRaisesRegex(errors.InvalidArgument, r"paths 6 to 11 of the 13 x 24 pixels at \(13, 0\)"):
            render.start_merge([*paths[:4], *paths[5:]], **size).wait()
        with self.assertRaisesRegex(errors.InvalidArgument, "part 2.exr: its seed"):
            render.start_merge(paths[2:], seed=2, **size).wait()
        paths[0].write_bytes(b"no picture")
        with self.assertRaisesRegex(errors.FormatError, "part 0.exr"):
            render.start_merge(paths, **size)

    def test_the_same_seed_gives_the_same_bits(self):
        def picture(threads, seed):
            with luxfer.Context(num_threads=threads) as own:
                scene = luxfer.Scene.from_bytes(own, glb)
                return luxfer.Render(own, scene).run(width=32, height=24, samples=4, seed=seed).image().numpy().tobytes()

        glb = lit_room().to_bytes()
        self.assertEqual(picture(1, 5), picture(3, 5))
        self.assertNotEqual(picture(1, 5), picture(1, 6))

    def test_illuminance_of_a_point_light(self):
        scene = luxfer.Scene(context())
        scene.add_material(base_color=(0, 0, 0))
        floor = scene.add_mesh(
            [[-9, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]], [[0, 2, 1], [0, 3, 2]], uvs=[[0, 0], [1, 0], [1, 1], [0, 1]]
        )
        scene.add_light(kind="point", position=(0, 2, 0), intensity=(100, 100, 100))
        lux = luxfer.Illuminance(context(), scene)
        lux.run_grid({"origin": (-1, 0.001, -1), "across": (2, 0, 0), "down": (0, 0, 2)}, columns=5, rows=5, samples=16)
        x, z = np.meshgrid(*[np.linspace(-0.8, 0.8, 5)] * 2)
        height = 2 - 0.001
        expected = 100 * height / (x**2 + z**2 + height**2) ** 1.5
        np.testing.assert_allclose(lux.image("lux").numpy()[..., 0], expected, rtol=1e-3)
        self.assertAlmostEqual(lux.report.mean, expected.mean(), delta=1e-3 * expected.mean())
        over = lux.run_mesh(floor, columns=3, rows=3, samples=16).image("lux").numpy()[..., 0]
        self.assertEqual(np.unravel_index(over.argmax(), over.shape), (1, 1))

    def test_relighting_meets_its_target(self):
        scene = luxfer.Scene.demo(context(), "target-room")
        mesh, material = scene.place_emission("Ceiling", np.eye(8).repeat(3).reshape(8, 8, 3), (100, 100, 100))
        relight = luxfer.Relight(context())
        relight.set_scene(scene, material, mesh)
        relight.set_target((12, 10, 8))
        report = relight.run(paths=1 << 16).report
        off = np.array(report.scale) * report.response - (12, 10, 8)
        self.assertTrue((np.abs(off) <= np.multiply(report.half_width, report.response)).all(), off)
        # The at-least target of the blue channel is low, so its scale follows those of the other channels.
        relight.set_target((12, 12, 1e-3))
        relight.set_constraint(("equal", "equal", "at-least"))
        scale = relight.run(paths=1 << 16).report.scale
        self.assertAlmostEqual(scale[2], (scale[0] + scale[1]) / 2, delta=1e-9 * scale[2])

    def test_plans_come_true(self):
        render = luxfer.Render(context(), lit_room())
        plan = luxfer.Plan(context())
        plan.run_render(render, target_error=0.3, settings={"width": 48, "height": 32, "seed": 5})
        self.assertEqual((plan.report.relights, plan.render_params["seed"]), (0, 5))
        self.assertLessEqual(plan.report.error, 0.3001)
        self.assertLess(render.run(**plan.render_params).report.error, 0.4)
        with self.assertRaises(errors.NotFound):
            plan.relight_params
        with self.assertRaisesRegex(errors.InvalidArgument, "one of them must be above 0"):
            plan.run_render(render)

        photo, strokes = demo()
        transfer = luxfer.Transfer(context(), photo, luxfer.Scene.demo(context(), "target-room"), "Ceiling")
        transfer.set_strokes(strokes)
        settings = {"render": {"width": 48, "height": 27}}
        with self.assertRaisesRegex(errors.InvalidOperation, "run stage Emission first"):
            plan.run_transfer(transfer, target_error=0.3, settings=settings)
        transfer.run(last="emission")
        plan.run_transfer(transfer, target_error=0.3, settings=settings)
        self.assertEqual(plan.report.relights, 1)
        transfer.run(first="relight", relight=plan.relight_params, render=plan.render_params)
        self.assertLessEqual(transfer.solution.error, plan.relight_params["target_error"])
        self.assertLess(transfer.report.render_error, 0.4)
        plan.run_transfer(transfer, time_budget_ms=2000, settings=settings)
        self.assertGreater(plan.relight_params["paths"], 2048)

    def test_two_lamps_light_two_desks(self):
        scene = luxfer.Scene.demo(context(), "target-room")
        texture = np.zeros((8, 12, 3))
        texture[3:5, 2:4] = texture[3:5, 8:10] = 1
        _, material = scene.place_emission("Ceiling", texture, (1000, 1000, 1000))
        lamps = luxfer.Lamps(context())
        lamps.set_scene(scene, material)
        for x, lux in ((1.0, 300), (4.0, 200)):
            lamps.add_grid({"origin": (x, 2, 1.5), "across": (1, 0, 0), "down": (0, 0, 1)}, lux)
        report = lamps.run(paths=1 << 14).report
        self.assertEqual((report.lamps, report.groups, report.goals, report.all_goals_satisfied), (2, 2, 2, 1), lamps.reason)
        for i, lux in enumerate((300, 200)):
            found = np.dot(lamps.goal(i).achieved, (0.2126, 0.7152, 0.0722)) * np.pi
            self.assertAlmostEqual(found, lux, delta=0.02 * lux)
            goal = lamps.goal(i)
            self.assertAlmostEqual(goal.target_lux, lux, delta=1e-3 * lux)
            self.assertAlmostEqual(goal.achieved_lux, found, delta=1e-3 * lux)
            self.assertTrue(0 < goal.half_width_lux < 0.1 * lux and goal.background_lux >= 0)
        scaled = lamps.texture.numpy()
        np.testing.assert_allclose(scaled[3, 2], lamps.lamp(0).scale, rtol=1e-5)
        # With power levels, every lamp gets one of the levels, and the desks still meet their goals within the
        # tolerance.
        lamps.set_levels(np.linspace(0, 2 * max(lamps.lamp(i).scale[0] for i in (0, 1)), 41))
        report = lamps.run(paths=1 << 14, tolerance=0.05).report
        self.assertEqual(report.all_goals_satisfied, 1, lamps.reason)
        lamps.set_levels([])
        # With at-least goals, a desk may get more light than its goal.
        for goal in (0, 1):
            lamps.set_constraint(goal, "at-least")
        self.assertEqual(lamps.run(paths=1 << 14).report.all_goals_satisfied, 1, lamps.reason)
        for goal in (0, 1):
            lamps.set_constraint(goal, ("equal",) * 3)
        # If all lamps share one power, they cannot give one desk more light than the other.
        report = lamps.run(paths=1 << 14, group="all", tolerance=0.001).report
        self.assertEqual((report.groups, report.all_goals_satisfied), (1, 0))
        self.assertIn("goal", lamps.reason)


class Scenes(Case):
    def test_colours_of_vertices_come_back(self):
        scene = luxfer.Scene(context())
        scene.add_material(name="Paint")
        colours = np.float32([[1, 0, 0, 1], [0, 1, 0, 0.5], [0, 0, 1, 0]])
        wide = np.zeros((3, 6), np.float32)
        wide[:, :4] = colours
        corners, triangle = np.float32([[0, 0, 0], [1, 0, 0], [0, 0, 1]]), [[0, 1, 2]]
        scene.add_mesh(corners, triangle, colours=wide[:, :4], name="Coloured")
        scene.add_mesh(corners, triangle, name="Plain")
        for copy in (scene, luxfer.Scene.from_bytes(context(), scene.to_bytes())):
            np.testing.assert_array_equal(copy.mesh_arrays(0)["colours"], colours)
            self.assertNotIn("colours", copy.mesh_arrays(1))
        with self.assertRaisesRegex(errors.InvalidArgument, "element 1 of mesh.colours"):
            scene.add_mesh(corners, triangle, colours=colours * [1, 2, 1, 1])
        with self.assertRaisesRegex(errors.NotFound, "mesh 1 has no colours"):
            scene._call("read_vertices", 1, luxfer.abi.LUXFER_VERTEX_COLOUR, None, 3)

    def test_arrays_go_in_and_come_out(self):
        vertices = np.zeros(4, [("p", "f4", 3), ("n", "f4", 3), ("t", "f4", 2), ("pad", "u1", 4)])  # interleaved
        vertices["p"] = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]
        vertices["n"] = (0, 1, 0)
        vertices["t"] = vertices["p"][:, ::2]
        scene = luxfer.Scene(context())
        red = scene.add_material(base_color=(0.5, 0, 0), roughness=0.25)
        index = scene.add_mesh(
            vertices["p"], [[0, 2, 1], [0, 3, 2]], normals=vertices["n"], uvs=vertices["t"], material=red, name="Böden"
        )
        out = scene.mesh_arrays(index)
        np.testing.assert_array_equal(out["positions"], vertices["p"])
        np.testing.assert_array_equal(out["normals"], vertices["n"])
        np.testing.assert_array_equal(out["uvs"], vertices["t"])
        np.testing.assert_array_equal(out["indices"], [[0, 2, 1], [0, 3, 2]])
        self.assertEqual(scene.mesh_name(index), "Böden")
        self.assertEqual(scene.material(red)["roughness"], 0.25)
        self.assertEqual(scene.mesh(index).uv_sets, 1)
        hit = scene.intersect([[0.9, 2, 0.2]], [[0, -1, 0]])[0]
        self.assertEqual((hit["t"], hit["mesh"], hit["triangle"]), (2, 0, 0))
        self.assertTrue(np.isinf(scene.intersect([[5, 2, 5]], [[0, -1, 0]])["t"][0]))

    def test_a_scene_copied_through_arrays_looks_the_same(self):
        scene, copy = lit_room(), luxfer.Scene(context())
        for i in range(scene.counts.materials):
            copy.add_material(**scene.material(i))
        for i in (i for i in range(scene.counts.meshes) if scene.mesh(i).triangle_count):
            arrays = scene.mesh_arrays(i)
            arrays.pop("uvs1", None)
            copy.add_mesh(**arrays, material=scene.mesh(i).material, name=scene.mesh_name(i))
        copy.add_camera(**luxfer.Scene.demo(context(), "exemplar-room").camera(0))
        self.assertEqual(copy.counts.triangles, scene.counts.triangles)
        rays = np.zeros((64, 3)) + (0, 1.4, 0), np.random.default_rng(4).normal(size=(64, 3))
        np.testing.assert_array_equal(copy.intersect(*rays)["t"], scene.intersect(*rays)["t"])

    def test_cameras_and_textures(self):
        scene = lit_room()
        index = scene.add_camera(fov_y=0.5, position=(0, 1, 2))
        scene.set_camera(index, **{**scene.camera(index), "target": (0, 1, 0)})
        self.assertEqual(scene.camera(index)["position"], (0, 1, 2))
        self.assertEqual(scene.camera(index)["target"], (0, 1, 1))  # read back as the point one metre ahead
        lamp = next(m for m in range(scene.counts.materials) if any(scene.material(m)["emission"]))
        use = scene.material_texture(lamp, "emission")
        self.assertEqual(scene.texture(use.texture).size, (12, 8, 3))
        self.assertIn("metal", scene.requirements_text() + "metal")
        self.assertTrue(scene.requirements().lights & luxfer.types.Lights.TEXTURE)

    def test_materials_change_and_use_textures(self):
        scene = luxfer.Scene(context())
        index = scene.add_material(base_color=(0.5, 0.4, 0.3), roughness=0.25)
        scene.set_material(index, emission=(1, 2, 3), alpha_mode="mask")
        material = scene.material(index)
        self.assertEqual((material["emission"], material["roughness"], material["alpha_mode"].name), ((1, 2, 3), 0.25, "MASK"))
        texture = scene.add_texture(np.ones((2, 3, 3)), "clamp", "mirror")
        scene.set_material_texture(index, "base-color", texture, transform=[[2, 0, 0], [0, 3, 0.5]])
        use = scene.material_texture(index, "base-color")
        self.assertEqual(
            (use.texture, use.wrap_u.name, use.wrap_v.name, use.transform), (0, "CLAMP", "MIRROR", (2, 0, 0, 0, 3, 0.5))
        )
        scene.set_material_texture(index, "base-color", None)
        self.assertEqual(scene.material_texture(index, "base-color").texture, luxfer.abi.LUXFER_NONE)

    def test_an_environment_of_one_brightness_is_that_bright(self):
        for image, colour in ((None, (3, 2, 1)), (np.ones((4, 8, 3)), (3, 2, 1))):
            scene = luxfer.Scene(context())
            scene.add_material()
            scene.add_mesh([[0, -5, 0], [1, -5, 0], [0, -5, 1]], [[0, 1, 2]])
            scene.add_camera(target=(0, 1, -1))
            scene.set_environment(colour, image)
            picture = luxfer.Render(context(), scene).run(width=8, height=8, samples=4).image().numpy()
            np.testing.assert_allclose(picture, np.broadcast_to(colour, picture.shape), rtol=1e-4)

    def test_wrong_arrays(self):
        scene = luxfer.Scene(context())
        scene.add_material()
        corners = np.zeros((3, 3), np.float32)
        for positions, indices, more in (
            (corners[:, :2], [[0, 1, 2]], {}),
            (corners, [[0, 1, -1]], {}),
            (corners, [[0.5, 1, 2]], {}),
            (corners, [[0, 1, 3]], {}),
            (corners, [[0, 1, 2]], {"normals": corners[:2]}),
            (corners * np.nan, [[0, 1, 2]], {}),
        ):
            with self.assertRaises(ValueError):
                scene.add_mesh(positions, indices, **more)
        self.assertEqual(scene.counts.meshes, 0)


class Stylisation(Case):
    SIZE = {"width": 64, "height": 48, "samples": 8}

    def setUp(self):
        super().setUp()
        self.ball, self.still = (
            luxfer.Guides(context(), luxfer.Scene.demo(context(), s)).run(**self.SIZE)
            for s in ("sphere-on-table", "still-life")
        )

    def test_a_picture_and_where_it_was_copied_from(self):
        artwork = self.ball.demo_artwork("paint")
        stylize = luxfer.Stylize(context(), artwork)
        stylize.add_guides(self.ball, self.still, "materials")
        stylize.run()
        self.assertGreater(stylize.report.unblended_share, 0.1)
        self.assertLess(stylize.report.unblended_share, 1)
        stylize.run(final_vote="majority")
        self.assertEqual(stylize.report.unblended_share, 1)
        picture, sources = stylize.image().numpy(), stylize.image("sources").numpy().astype(int)
        self.assertEqual(picture.shape, (48, 64, 3))
        # This final vote copies pixels, so every colour of the picture occurs in the artwork.
        colours, copied = artwork.numpy().reshape(-1, 3), picture.reshape(-1, 3)
        strangest = max(np.abs(colours - colour).max(1).min() for colour in copied)
        self.assertLess(strangest, 1e-6)
        self.assertTrue(((sources >= 0) & (sources < (64, 48))).all())
        self.assertGreater(stylize.report.used, 0)

    def test_the_same_light_gives_the_artwork_back(self):
        artwork = self.ball.demo_artwork("paint").numpy()
        stylize = luxfer.Stylize(context(), artwork)
        for name in ("full", "direct", "indirect"):
            image = self.ball.image(name).numpy()
            stylize.add_guide(name, image, image)
        coordinates = np.stack(np.meshgrid(np.linspace(0, 1, 64), np.linspace(0, 1, 48)), -1)
        stylize.add_guide("place", coordinates, coordinates, 1000, "data")
        stylize.run(preset="fast")
        error = np.abs(stylize.image().numpy() - artwork).mean()
        self.assertLess(error, 0.01)

    def test_sequences_and_half_painted_pictures(self):
        artwork = self.ball.demo_artwork("pen")
        stylize = luxfer.Stylize(context(), artwork)
        stylize.add_guides(self.ball, self.still)
        stylize.run(preset="fast", levels=2)
        first = stylize.image().numpy()
        stylize.set_motion(self.still.motion(self.still))
        stylize.run(preset="fast", levels=2)
        moved = (np.abs(stylize.image().numpy() - first).max(-1) > 0.02).mean()
        self.assertLess(moved, 0.2)
        self.assertEqual(stylize.warnings, [])
        stylize.set_motion(np.full((48, 64, 2), 5, np.float32))
        stylize.run(preset="fast", levels=2)
        self.assertEqual([w.code.name for w in stylize.warnings], ["MOTION_DISAGREES"])
        self.still.motion(self.ball)
        self.assertEqual([w.code.name for w in self.still.warnings], ["NO_COUNTERPART"])
        self.still.motion(self.still)
        self.assertEqual(self.still.warnings, [])

        painted = np.ones((48, 64), bool)
        painted[20:28, 30:40] = False
        half = luxfer.Stylize(context(), artwork)
        half.add_guide("full", self.ball.image("full"), None)
        half.set_painted(painted)
        half.run(preset="fast", levels=2)
        np.testing.assert_allclose(half.image().numpy()[painted], artwork.numpy()[painted], atol=1e-6)

    def test_sheets(self):
        picture = np.random.default_rng(5).random((9, 12, 3)).repeat(10, 0).repeat(10, 1)
        sheet = luxfer.print_sheet(context(), picture, dpi=80, contrast=1)
        artwork, report = luxfer.align_sheet(context(), sheet, 120, 90, dpi=80, contrast=1)
        self.assertEqual(report.marks, 10)
        inner = np.abs(artwork.numpy() - picture)[5::10, 5::10]
        self.assertLess(inner.mean(), 0.03)


if __name__ == "__main__":
    unittest.main()
