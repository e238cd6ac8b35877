"""Tests the add-on in a Blender without a window (bpy from PyPI): its operators on a test scene, with results by
Cycles."""

import contextlib
import io
import logging
import os
import time
import unittest
from types import SimpleNamespace

from room import SIZE, bpy, build, cycles, np, unbiased

import bmesh
import luxfer
import luxfer_lighting
from luxfer_lighting import convert, lighting, live, painting, panels, parts, passes, work

EXEMPLAR = {"width": 240, "height": 160, "samples": 8}


class AddOn(unittest.TestCase):
    def setUp(self):
        self.scene = build()
        luxfer_lighting.register()
        self.addCleanup(luxfer_lighting.unregister)

    def load_photo(self):
        """Loads the generated photo and its strokes into the add-on, as a user would."""
        demo = luxfer.DemoPhoto(work.context()).run(**EXEMPLAR)
        photo, strokes = (demo.image(which).numpy(np.uint8, "srgb") / np.float32(255) for which in ("picture", "strokes"))
        settings = self.scene.luxfer
        settings.photo = convert.store("photo", photo, linear=False)
        bpy.ops.luxfer.new_strokes()
        painted = strokes.max(-1) > 0  # strokes have pure colours, the rest is black
        pale = convert.pixels(settings.strokes)[..., :3]
        settings.strokes = convert.store(lighting.STROKES, np.where(painted[..., None], strokes, pale), linear=False)
        settings.target = bpy.data.objects["Ceiling"]
        settings.texels = 256

    def test_register_and_unregister_twice(self):
        luxfer_lighting.unregister()
        for _ in range(2):
            self.assertFalse(hasattr(bpy.types.Scene, "luxfer"))
            self.assertFalse([n for n in dir(bpy.types) if n.startswith("LUXFER_")])
            luxfer_lighting.register()
            self.assertIsNotNone(bpy.context.scene.luxfer)
            luxfer_lighting.unregister()
        luxfer_lighting.register()

    def test_the_transfer_lights_the_ceiling_as_our_own_renderer_sees_it(self):
        self.load_photo()
        self.assertEqual(bpy.ops.luxfer.transfer(), {"FINISHED"})
        found = lighting.result
        ceiling = bpy.data.objects["Ceiling"]
        lit = ceiling.data.materials[ceiling.data.polygons[0].material_index]
        self.assertEqual(lit["luxfer_base"], "White")
        self.assertGreater(len(bpy.data.texts[lighting.LAMPS].as_string().splitlines()), 2)

        # The emission strength, in cd/m², is that of the strongest channel; the emission texture is a float image.
        surface = next(n for n in lit.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        self.assertAlmostEqual(
            surface.inputs["Emission Strength"].default_value, max(found.emission), delta=1e-4 * max(found.emission)
        )
        self.assertTrue(bpy.data.images["Luxfer light Ceiling"].is_float)

        # Render the scene as it is exported now with luxfer; and with Cycles, in batches whose scatter gives the
        # error.
        room = convert.scene(work.context(), self.scene)
        render = luxfer.Render(work.context(), room)
        render.set_camera(**convert.camera(self.scene))
        width, height = convert.resolution(self.scene)
        render.run(width=width, height=height, samples=256)
        ours, variance = render.image().numpy(), render.image("variance").numpy()
        batches = []
        for seed in range(4):
            self.scene.cycles.seed = seed
            batches.append(cycles(self.scene, 32))
        theirs = np.mean(batches, 0)

        first = luxfer.Render(work.context(), room, aovs="object")
        first.set_camera(**convert.camera(self.scene))
        seen = first.run(width=width, height=height, samples=16).layer("IndexOB").numpy()[..., 0].astype(int) - 1
        names = [room.mesh_name(i) for i in range(room.counts.meshes)]
        far = []
        for name in ("Ceiling", "Floor"):
            where = seen == names.index("Ceiling (lights)" if name == "Ceiling" else name)
            where[1:-1, 1:-1] &= where[:-2, 1:-1] & where[2:, 1:-1] & where[1:-1, :-2] & where[1:-1, 2:]  # no edges
            self.assertGreater(where.sum(), 100)
            mine, other = ours[where].mean(0), theirs[where].mean(0)
            my_error = np.sqrt(variance[where].sum(0)) / where.sum()
            other_error = np.std([b[where].mean(0) for b in batches], axis=0, ddof=1) / 2
            print(
                f"{name}: ours {mine.round(3)} ± {1.96 * my_error.round(4)}, Cycles {other.round(3)} ± {3.18 * other_error.round(4)} cd/m²"
            )
            far.append((name, np.abs(mine - other) / (1.96 * my_error + 3.18 * other_error)))
        for name, shares in far:
            self.assertTrue((shares <= 1).all(), f"{name}: {shares} of the interval")

    def test_lamps_lie_as_far_apart_as_asked(self):
        self.load_photo()
        settings = self.scene.luxfer
        settings.scale, settings.length, settings.keep_whole, settings.margin = "SPACING", 0.5, True, 0.1
        self.assertEqual(bpy.ops.luxfer.transfer(), {"FINISHED"})
        rows = [line.split(",") for line in bpy.data.texts[lighting.LAMPS].as_string().splitlines()[1:]]
        places = np.array([[float(v) for v in row[:2]] for row in rows])
        self.assertGreater(len(places), 3)
        apart = np.linalg.norm(places[:, None] - places[None], axis=-1)
        apart[apart == 0] = np.inf
        self.assertAlmostEqual(np.median(apart.min(0)), 0.5, delta=0.05)
        self.assertTrue((places > 0.1).all() and (places < np.array(SIZE[:2]) - 0.1).all())

    def test_applying_can_be_undone(self):
        self.load_photo()
        bpy.ops.ed.undo_push(message="before")
        self.scene.luxfer.apply_when_done = False
        bpy.ops.luxfer.transfer()
        bpy.ops.ed.undo_push(message="transferred")
        self.assertEqual(len(bpy.data.objects["Ceiling"].data.materials), 1)
        bpy.ops.luxfer.apply("EXEC_DEFAULT", True)
        self.assertEqual(len(bpy.data.objects["Ceiling"].data.materials), 2)
        bpy.ops.ed.undo()
        self.assertEqual(len(bpy.data.objects["Ceiling"].data.materials), 1)

    def test_the_interface_stays_free_and_cancelling_ends_the_work(self):
        self.load_photo()
        before = len(bpy.data.materials)
        work.start("Transfer", lambda: lighting.transfer_work(self.scene))
        self.assertIsNotNone(work.step())
        self.assertTrue(bpy.app.timers.is_registered(work.step))
        self.assertTrue(bpy.ops.luxfer.cancel.poll())
        self.assertFalse(bpy.ops.luxfer.transfer.poll())
        progress = [work.current().progress]
        while work.current() and progress[-1] < 0.05:
            work.step()
            progress.append(work.current().progress)
        self.assertEqual(progress, sorted(progress))
        start = time.monotonic()
        bpy.ops.luxfer.cancel()
        self.assertLess(time.monotonic() - start, 1)
        self.assertIsNone(work.current())
        self.assertEqual(work.message, "Cancelled")
        self.assertIsNone(work.step())
        self.assertEqual(len(bpy.data.materials), before)

    def test_escape_ends_the_work(self):
        """The test passes events to the modal operator in place of Blender."""
        self.load_photo()
        reports = []
        operator = SimpleNamespace(report=lambda kind, text: reports.append(text))
        work.start("Transfer", lambda: lighting.transfer_work(self.scene))
        for key, ends in (("MOUSEMOVE", set()), ("ESC", set()), ("MOUSEMOVE", {"CANCELLED"})):
            answer = work.Background.modal(operator, bpy.context, SimpleNamespace(type=key))
            self.assertEqual(answer, ends | {"PASS_THROUGH"})
        self.assertIsNone(work.current())
        self.assertEqual(reports, ["Cancelled"])

    def test_panels_name_what_exists(self):
        """Draws the panels into a stub of a layout, which checks that every property, operator and icon exists."""
        icons = bpy.types.UILayout.bl_rna.functions["prop"].parameters["icon"].enum_items

        class Layout:
            def __getattr__(self, name):
                return lambda *arguments, **options: self.check(name, *arguments, **options)

            def check(self, name, *arguments, icon="NONE", **_):
                icons[icon]
                if name in ("prop", "template_ID"):
                    arguments[0].bl_rna.properties[arguments[1]]
                elif name in ("operator", "operator_menu_enum"):
                    module, verb = arguments[0].split(".")
                    getattr(getattr(bpy.ops, module), verb).get_rna_type()
                return self

        self.load_photo()
        bpy.context.view_layer.objects.active = bpy.data.objects["Ceiling"]
        work.start("Masks", lambda: (lighting.mask_steps(lighting.prepared(self.scene), lighting.photo_pixels(self.scene)), 1))
        for kind in panels.CLASSES:
            kind.draw(SimpleNamespace(layout=Layout()), bpy.context)
        work.cancel()
        for kind in panels.CLASSES:
            kind.draw(SimpleNamespace(layout=Layout()), bpy.context)
        self.assertEqual(panels.lines("a word too long for it all", 10), ["a word too", "long for", "it all"])

    def test_what_is_doubtful_is_shown_with_what_to_do(self):
        self.load_photo()
        self.assertEqual(bpy.ops.luxfer.preview_masks(), {"FINISHED"})
        self.assertTrue(all(isinstance(warning, luxfer.StageWarning) for warning in lighting.warnings))

        labels = []
        stub = SimpleNamespace(column=lambda **_: stub, box=lambda: stub, label=lambda text, **_: labels.append(text))
        code, stage = luxfer.types.WarningCode.UNSEEN, luxfer.types.Stage.PLANE
        warning = luxfer.StageWarning(code, stage, 0.3, 0.1, "a third of the mask is new", "paint there", (30.5, 12.5))
        panels.show_warnings(stub, bpy.context, [warning])
        self.assertEqual(labels[0], panels.STAGES["PLANE"])
        shown = " ".join(labels[1:])
        self.assertEqual(shown, "A third of the mask is new. Paint there, at 30, 12 from the photo's top left.")
        # A transfer has no stage STYLIZE.
        self.assertEqual({*panels.STAGES, "STYLIZE"}, set(luxfer.types.Stage.__members__))

    def test_masks(self):
        self.load_photo()
        bpy.ops.luxfer.preview_masks()
        masks = convert.pixels(bpy.data.images[lighting.MASKS])[..., :3]
        photo = convert.pixels(self.scene.luxfer.photo)[..., :3]
        self.assertEqual(masks.shape, photo.shape)
        self.assertGreater((masks != photo).any(-1).mean(), 0.05)

    def follow(self):
        """Calls the timer's function until the preview is up to date; returns the time in seconds."""
        start = time.monotonic()
        self.assertIsNotNone(live.step())
        while live.preview is not None and live.preview.job is not None:
            self.assertIsNotNone(live.step())
        return time.monotonic() - start

    def test_masks_follow_the_strokes(self):
        self.load_photo()
        strokes = self.scene.luxfer.strokes
        complete = convert.pixels(strokes)
        lights = (complete[..., :3] == (1, 1, 0)).all(-1)
        some = complete.copy()
        some[lights] = 0.5
        manager = bpy.context.window_manager

        def paint(values):
            strokes.pixels.foreach_set(np.ascontiguousarray(values[::-1]).ravel())

        paint(some)
        manager.luxfer_live = True
        self.assertTrue(bpy.app.timers.is_registered(live.step))
        self.follow()  # the photo
        self.follow()  # the strokes
        self.assertEqual(list(live.preview.shown), ["plane", "lights"], "lights are proposed")
        self.assertIn("A guess", live.preview.hint)
        self.assertIn("yellow", live.preview.hint)
        self.assertEqual(live.preview.overlay().shape, complete.shape)

        paint(complete)
        took = self.follow()
        self.assertEqual(list(live.preview.shown), ["plane", "lights"])
        self.assertEqual(live.preview.hint, "")
        self.assertLess(took, 1)
        shown = convert.pixels(bpy.data.images[lighting.MASKS])
        version = live.preview.version
        self.follow()
        self.assertEqual(live.preview.version, version, "nothing new was painted")
        bpy.ops.luxfer.preview_masks()  # the photo is not reduced, so the masks are the same
        np.testing.assert_array_equal(convert.pixels(bpy.data.images[lighting.MASKS]), shown)

        bpy.ops.luxfer.new_strokes()
        self.follow()
        self.assertEqual(list(live.preview.shown), ["plane", "lights"], "both are proposed")
        self.assertIn("A guess", live.preview.hint)
        self.assertIn("green", live.preview.hint)
        manager.luxfer_live = False
        self.assertIsNone(live.step())
        self.assertIsNone(live.preview)

    def test_live_masks_of_large_photos_are_reduced_and_give_way(self):
        self.load_photo()
        bpy.context.window_manager.luxfer_live = True
        pixels, live.PIXELS = live.PIXELS, 5_000
        self.addCleanup(setattr, live, "PIXELS", pixels)
        self.follow()
        self.follow()
        width, height = self.scene.luxfer.photo.size
        n = live.preview.reduction
        self.assertEqual(live.preview.shown["plane"].shape, (height // n, width // n, 1))
        self.assertLessEqual(width * height / n**2, 5_000)
        self.assertGreater(width * height / (n - 1) ** 2, 5_000)

        # Another photo gets a new preview; but no preview is computed while an operator needs the processors.
        work.start("Masks", lambda: (lighting.mask_steps(lighting.prepared(self.scene), lighting.photo_pixels(self.scene)), 1))
        before = live.preview
        self.scene.luxfer.photo = self.scene.luxfer.photo.copy()
        live.step()
        self.assertIs(live.preview, before)
        work.cancel()
        live.step()
        self.assertIsNot(live.preview, before)
        luxfer_lighting.unregister()  # while a job runs
        self.assertIsNone(live.preview)
        self.assertFalse(bpy.app.timers.is_registered(live.step))
        luxfer_lighting.register()

    def test_missing_input_is_reported(self):
        for message, prepare in (
            ("surface", lambda: None),
            ("photo", lambda: setattr(self.scene.luxfer, "target", bpy.data.objects["Ceiling"])),
            ("strokes", lambda: setattr(self.scene.luxfer, "photo", bpy.data.images.new("p", 8, 8))),
        ):
            prepare()
            with self.assertRaisesRegex(RuntimeError, message):
                bpy.ops.luxfer.transfer()
        with self.assertRaisesRegex(RuntimeError, "artwork"):
            bpy.ops.luxfer.stylise()

    def hang_lamp(self):
        light = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        light.data.energy, light.data.shadow_soft_size = 5000, 0
        light.location = (SIZE[0] / 2, SIZE[1] / 2, SIZE[2] - 0.3)
        self.scene.collection.objects.link(light)

    def test_stylising(self):
        settings = self.scene.luxfer
        settings.exemplar_width, settings.exemplar_height, settings.guide_samples = 96, 72, 8
        self.hang_lamp()
        bpy.ops.luxfer.exemplar()
        self.assertEqual(tuple(bpy.data.images[painting.EXEMPLAR].size), (96, 72))
        bpy.ops.luxfer.sample_artwork(style="paint")
        bpy.ops.luxfer.stylise()
        picture = convert.pixels(bpy.data.images[painting.PICTURE])[..., :3]
        self.assertEqual(picture.shape, (72, 96, 3))
        if folder := os.environ.get("LUXFER_LOOK"):
            luxfer.Image(work.context(), picture, "srgb").save(os.path.join(folder, "stylised.png"))
        self.assertGreater(picture.std(), 0.02)

        # With guides by Cycles instead, the picture differs, but uses similar paint.
        settings.guides_by = "CYCLES"
        before = {name: getattr(self.scene.render, name) for name in ("engine", "filepath", "use_compositing")}
        asked = self.scene.view_layers[0].use_pass_diffuse_direct
        bpy.ops.luxfer.stylise()
        other = convert.pixels(bpy.data.images[painting.PICTURE])[..., :3]
        if folder := os.environ.get("LUXFER_LOOK"):
            luxfer.Image(work.context(), other, "srgb").save(os.path.join(folder, "stylised_by_cycles.png"))
        self.assertTrue((picture != other).any())
        np.testing.assert_allclose(other.mean((0, 1)), picture.mean((0, 1)), atol=0.05)
        for name, value in before.items():
            self.assertEqual(getattr(self.scene.render, name), value)
        self.assertEqual(self.scene.view_layers[0].use_pass_diffuse_direct, asked)

    def test_the_exporter_is_quiet(self):
        text = io.StringIO()
        with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
            convert.scene(work.context(), self.scene)
        self.assertNotIn("INFO", text.getvalue())
        self.assertEqual(logging.root.manager.disable, 0)

    def test_objects_are_painted_like_the_ball_and_walls_like_the_table(self):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(3, 2.5, 1.2))
        ball = bpy.context.object
        ball.data.materials.append(bpy.data.materials["White"])  # which the walls have too
        found = parts.of(self.scene)
        self.assertEqual(found.pop(ball.name), parts.BALL)
        self.assertEqual(set(found.values()), {parts.TABLE})
        self.hang_lamp()
        settings = self.scene.luxfer
        settings.exemplar_width, settings.exemplar_height, settings.guide_samples = 96, 72, 8
        bpy.ops.luxfer.sample_artwork(style="paint")
        artwork = convert.pixels(settings.artwork)[..., :3]
        of_ball, of_table = artwork[30:42, 40:56].mean((0, 1)), artwork[:12].mean((0, 1))

        def is_ball(pixels):
            """Whether pixels are nearer to the colour of the ball than to the colour of the table."""
            return np.abs(pixels - of_ball).sum(-1) < np.abs(pixels - of_table).sum(-1)

        def painted():
            bpy.ops.luxfer.stylise()
            picture = convert.pixels(bpy.data.images[painting.PICTURE])[..., :3]
            if folder := os.environ.get("LUXFER_LOOK"):
                name = f"parts_{settings.guides_by}_{ball.luxfer_paint_as}.png".lower()
                luxfer.Image(work.context(), picture, "srgb").save(os.path.join(folder, name))
            return picture

        picture = painted()
        middle = np.s_[34:44, 43:53]
        self.assertGreater(is_ball(picture[middle]).mean(), 0.8)
        self.assertLess(is_ball(picture[:, :24]).mean(), 0.2)  # the left wall
        ball.luxfer_paint_as = "TABLE"
        self.assertLess(is_ball(painted()[middle]).mean(), 0.3)
        ball.luxfer_paint_as = "BALL"
        settings.guides_by = "CYCLES"
        picture = painted()
        self.assertGreater(is_ball(picture[middle]).mean(), 0.8)
        self.assertLess(is_ball(picture[:, :24]).mean(), 0.2)

    def test_cycles_can_be_cancelled_and_leaves_nothing(self):
        settings = self.scene.luxfer
        settings.exemplar_width, settings.exemplar_height, settings.guides_by = 64, 48, "CYCLES"
        settings.guide_samples = 65536
        self.hang_lamp()
        for seconds in (0.0, 4.0):  # while it starts, and while it renders
            rendering = passes.Rendering(self.scene, bpy.context.view_layer, 65536)

            def steps():
                yield rendering

            work.start("Guides", lambda: (steps(), 1))
            folder = rendering._folder.name
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                self.assertIsNotNone(work.step())
                time.sleep(work.POLL_SECONDS)
            start = time.monotonic()
            bpy.ops.luxfer.cancel()
            self.assertLess(time.monotonic() - start, 1)
            self.assertTrue(rendering.finished)
            self.assertFalse(os.path.exists(folder))
            self.assertEqual(work.message, "Cancelled")

    def test_the_reason_for_a_failure_of_cycles_is_shown(self):
        self.scene.camera = None
        rendering = passes.Rendering(self.scene, bpy.context.view_layer, 1)
        with self.assertRaisesRegex(RuntimeError, "Cycles could not render the guides: .*[Cc]amera"):
            rendering.wait()
        self.assertFalse(os.path.exists(rendering._folder.name))

    def test_guides_by_cycles_are_those_of_the_library(self):
        """In a room with a glossy ball, each light component has the same mean and the same shape in both renderers.

        Two differences are expected: Cycles' indirect pass has all light that reaches a matt surface after another
        bounce, and its glossy BSDF includes multiple scattering (Turquin).
        """
        self.hang_lamp()
        mesh = bpy.data.meshes.new("Ball")
        shape = bmesh.new()
        bmesh.ops.create_uvsphere(shape, u_segments=48, v_segments=24, radius=0.8)
        for face in shape.faces:
            face.smooth = True
        shape.to_mesh(mesh)
        shape.free()
        look = bpy.data.materials["Red"].copy()
        surface = next(n for n in look.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        surface.inputs["Metallic"].default_value, surface.inputs["Roughness"].default_value = 1, 0.4
        mesh.materials.append(look)
        ball = bpy.data.objects.new("Ball", mesh)
        ball.location = (SIZE[0] / 2, SIZE[1] - 1.2, 0.8)
        self.scene.collection.objects.link(ball)

        unbiased(self.scene)
        theirs = passes.Rendering(self.scene, bpy.context.view_layer, 128).wait().light()
        room = convert.scene(work.context(), self.scene)
        width, height = convert.resolution(self.scene)
        guides = luxfer.Guides(work.context(), room)
        guides.run(width=width, height=height, samples=128, camera=room.add_camera(**convert.camera(self.scene)))
        ours = passes.light_of(guides)
        wider = luxfer.Render(work.context(), room, expressions={"wider": "L.+DE"})
        wider.set_camera(**convert.camera(self.scene))
        wider.run(width=width, height=height, samples=128)
        if folder := os.environ.get("LUXFER_LOOK"):
            for name in ours:
                both = np.concatenate((ours[name], theirs[name]), 1)
                luxfer.Image(work.context(), both).save(os.path.join(folder, f"{name}.png"), exposure=0.4 / ours["full"].mean())
        self.assertEqual(list(ours), list(theirs))
        for name, light in ours.items():
            expected = wider.layer("wider").numpy() if name == "indirect" else light
            mine, mean, other = (image.mean((0, 1)) for image in (light, expected, theirs[name]))
            print(f"{name:12} luxfer {mine.round(3)}, as Cycles has it {mean.round(3)}, Cycles {other.round(3)} cd/m²")
            np.testing.assert_allclose(other, mean, rtol=0.05 if name == "specular" else 0.02, err_msg=name)
            self.assertGreater(np.corrcoef(light.ravel(), theirs[name].ravel())[0, 1], 0.95, name)

    def test_light_goes_in_as_the_library_puts_it_in(self):
        context, size = work.context(), {"width": 48, "height": 36, "samples": 4}
        ball, table = (luxfer.Guides(context, luxfer.Scene.demo(context, n)).run(**size) for n in ("sphere-on-table", "still-life"))
        pictures = []
        for by_hand in (False, True):
            stylize = luxfer.Stylize(context, ball.demo_artwork("paint"))
            if by_hand:
                passes.add(stylize, *passes.exposed(passes.light_of(ball), passes.light_of(table)))
            else:
                stylize.add_guides(ball, table)
            pictures.append(stylize.run(preset="fast").image().numpy())
        np.testing.assert_allclose(pictures[0], pictures[1], atol=1e-3)


class Conversion(unittest.TestCase):
    def test_the_camera_sees_what_blender_s_sees(self):
        """Compares the depth of a tilted view of the room in both renderers."""
        scene = build()
        scene.camera.rotation_euler = (1.2, 0.3, 0.4)
        room = convert.scene(context := luxfer.Context(), scene)
        render = luxfer.Render(context, room, aovs="distance")
        render.set_camera(**convert.camera(scene))
        width, height = convert.resolution(scene)
        ours = render.run(width=width, height=height, samples=64).layer("Distance").numpy()[..., 0]
        graph = bpy.context.evaluated_depsgraph_get()
        frame = [scene.camera.matrix_world @ corner for corner in scene.camera.data.view_frame(scene=scene)]
        right_top, right_bottom, left_bottom, left_top = frame
        origin = scene.camera.matrix_world.translation
        wrong = 0
        for row in range(4, height, 8):
            for column in range(4, width, 8):
                s, t = (column + 0.5) / width, (row + 0.5) / height
                point = left_top.lerp(right_top, s).lerp(left_bottom.lerp(right_bottom, s), t)
                hit, place, *_ = scene.ray_cast(graph, origin, (point - origin).normalized())
                self.assertTrue(hit)
                wrong += abs((place - origin).length - ours[row, column]) > 0.06
        self.assertEqual(wrong, 0)

    def test_lights_are_as_bright_as_in_cycles(self):
        """Compares the brightness of a floor straight below one light, for each kind of light and each shape of area
        light."""
        context = luxfer.Context()
        for kind, shape in (
            ("POINT", ""),
            ("SPOT", ""),
            ("SUN", ""),
            ("AREA", "SQUARE"),
            ("AREA", "RECTANGLE"),
            ("AREA", "DISK"),
            ("AREA", "ELLIPSE"),
        ):
            scene = build()
            for name in ("Ceiling", "Left", "Right", "Back", "Front"):
                bpy.data.objects.remove(bpy.data.objects[name])
            light = bpy.data.lights.new("Lamp", kind)
            light.energy, light.color = (3 if kind == "SUN" else 100), (1, 0.5, 0.25)
            if kind == "AREA":
                light.shape, light.size, light.size_y = shape, 0.4, 0.2
            elif kind == "SUN":
                light.angle = 0
            else:
                light.shadow_soft_size = 0
            lamp = bpy.data.objects.new("Lamp", light)
            lamp.location = (3, 2, 2)
            scene.collection.objects.link(lamp)
            scene.camera.location, scene.camera.rotation_euler, scene.camera.data.lens = (3, 2, 1.9), (0, 0, 0), 200
            scene.render.resolution_x = scene.render.resolution_y = 8
            render = luxfer.Render(context, convert.scene(context, scene))
            render.set_camera(**convert.camera(scene))
            ours = render.run(width=8, height=8, samples=256).image().numpy().mean((0, 1))
            with self.subTest(kind=kind, shape=shape):
                np.testing.assert_allclose(ours, cycles(scene, 64).mean((0, 1)), rtol=0.01)

    def test_images_go_there_and_back(self):
        context = luxfer.Context()
        values = np.random.default_rng(1).random((5, 7, 3)).astype(np.float32)
        stored = convert.store("there", values, linear=True)
        np.testing.assert_array_equal(convert.image(context, stored).numpy(), values)
        codes = np.round(values * 255) / np.float32(255)
        stored = convert.store("there", codes, linear=False)
        np.testing.assert_allclose(convert.pixels(stored)[..., :3], codes, atol=1e-6)
        np.testing.assert_array_equal(convert.image(context, stored).numpy(np.uint8, "srgb"), np.round(codes * 255))


if __name__ == "__main__":
    unittest.main()
