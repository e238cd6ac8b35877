"""Tests which calls are refused, with which exceptions and messages."""

import gc
import unittest

from support import Case, context, lit_room, luxfer, np

from luxfer import errors


class Errors(Case):
    def test_a_scene_file_is_scaled_and_what_it_has_beyond_the_renderer_is_named(self):
        big = luxfer.Scene.from_bytes(context(), lit_room().to_bytes(), unit=100)
        self.assertEqual([w.code for w in big.warnings], [luxfer.types.WarningCode.IMPLAUSIBLE_SIZE])
        self.assertIn("unit = 0.01", str(big.warnings[0]))
        self.assertTrue(str(big.warnings[0]).startswith("scene: "))
        ceiling = lit_room().candidates[0]
        self.assertEqual((ceiling.name, ceiling.kind.name), ("Ceiling (lights)", "OBJECT"))
        self.assertAlmostEqual(ceiling.level_area, ceiling.area)
        self.assertIn("m² are level", ceiling.reason)
        file = self.folder / "room.gltf"
        file.write_text(
            '{"asset": {"version": "2.0"}, "buffers": [{"uri": "../room.bin", "byteLength": 1}],'
            ' "nodes": [{"name": "A", "extensions": {"VENDOR_x": {}}}]}'
        )
        with self.assertRaisesRegex(errors.Unsupported, "allow_external_files"):
            luxfer.Scene.load(context(), file)
        with self.assertRaisesRegex(errors.FileError, "room.bin"):
            luxfer.Scene.load(context(), file, allow_external_files=1)
        file.write_text(file.read_text().replace("../room.bin", "data:;base64,AA=="))
        scene = luxfer.Scene.load(context(), file)
        self.assertIn("VENDOR_x", scene.warnings[0].message)
        self.assertIn('node "A"', scene.requirements_text())

    def test_a_mistyped_setting_names_the_nearest(self):
        render = luxfer.Render(context(), lit_room())
        with self.assertRaisesRegex(TypeError, "no setting 'widht': did you mean 'width'"):
            render.start(widht=64)
        with self.assertRaisesRegex(TypeError, "no setting 'render.sampels': did you mean 'samples'"):
            luxfer.Transfer(context()).start(render={"sampels": 3})
        with self.assertRaisesRegex(ValueError, "did you mean 'manhattan'"):
            luxfer.Rectify(context(), np.zeros((8, 8, 3))).start(search="manhatan")
        with self.assertRaisesRegex(ValueError, "'depht' is no Aov|'depth|depht' is no Aov"):
            render.set_aovs("depth|depht")

    def test_messages_name_wrong_kinds_and_numbers(self):
        render = luxfer.Render(context(), lit_room())
        for params, kind, message in (
            ({"width": -1}, ValueError, "width = -1"),
            ({"width": 2**32}, ValueError, "width = 4294967296"),
            ({"width": 1.5}, TypeError, "width is a whole number"),
            ({"target_error": "small"}, TypeError, "target_error is a number"),
            ({"seed": None}, TypeError, "seed is a whole number"),
        ):
            with self.subTest(params), self.assertRaisesRegex(kind, message):
                render.start(**params)
        with self.assertRaisesRegex(ValueError, "principal is 2 numbers, not 3"):
            luxfer.Rectify(context(), np.zeros((8, 8, 3))).start(principal=(1, 2, 3))
        with self.assertRaisesRegex(TypeError, "render is a dict of settings"):
            luxfer.Transfer(context()).start(render=3)
        self.assertEqual(render.run(width=np.int64(8), height=np.uint8(8), samples=True).image().size, (8, 8, 3))

    def test_the_library_s_message_and_the_kind(self):
        scene = lit_room()
        cases = (
            (errors.InvalidArgument, ValueError, "width is 0", lambda: luxfer.Render(context(), scene).run(width=0)),
            (errors.InvalidOperation, RuntimeError, "", lambda: luxfer.Render(context()).start()),
            (errors.FileError, OSError, "nothing.png", lambda: luxfer.Image.load(context(), "nothing.png")),
            (errors.FormatError, ValueError, "", lambda: luxfer.Image.from_bytes(context(), b"not an image")),
            (errors.NotFound, LookupError, "Ceiling", lambda: scene.find_surface("Cieling")),
            (errors.NotReady, errors.Error, "", lambda: luxfer.Render(context(), scene).image()),
            (errors.Degenerate, errors.Error, "", lambda: luxfer.Segment(context(), np.zeros((9, 9, 3))).run()),
            (errors.InvalidOperation, RuntimeError, "stage View", lambda: luxfer.Transfer(context(), np.zeros((9, 9, 3))).run("unwarp")),
        )
        for kind, base, message, call in cases:
            with self.subTest(kind.__name__):
                with self.assertRaises(kind) as caught:
                    call()
                self.assertIsInstance(caught.exception, base)
                self.assertEqual(caught.exception.status, kind.status)
                self.assertIn(message, str(caught.exception))
                self.assertGreater(len(str(caught.exception)), 10)

    def test_the_memory_budget(self):
        with luxfer.Context(num_threads=1, memory_budget_mib=1) as small, self.assertRaises(MemoryError):
            luxfer.Image(small, np.zeros((600, 600, 3), np.float32))

    def test_objects_of_another_context(self):
        with luxfer.Context(num_threads=1) as other:
            image = luxfer.Image(other, np.zeros((4, 4, 3)))
            with self.assertRaises(errors.InvalidArgument):
                luxfer.Rectify(context()).set_photo(image)

    def test_closing(self):
        other = luxfer.Context(num_threads=1)
        image = luxfer.Image(other, np.zeros((4, 4, 3)))
        other.close()
        other.close()
        self.assertEqual(image.size, (4, 4, 3))  # an image keeps its context alive
        with self.assertRaises(errors.InvalidArgument):
            image.save("a.unknown")
        image.close()
        with self.assertRaisesRegex(errors.InvalidArgument, "this Image has been closed"):
            image.numpy()
        self.assertIn("closed", repr(image))

    def test_objects_are_freed_without_close(self):
        """Creates images of many times the memory budget in total: this fails unless each is freed."""
        with luxfer.Context(num_threads=1, memory_budget_mib=8) as small:
            for _ in range(40):
                luxfer.Image(small, np.zeros((512, 512, 3), np.float32))
        gc.collect()
        self.assertFalse([o for o in gc.get_objects() if isinstance(o, luxfer.Image) and o._context is small and o._pointer])


if __name__ == "__main__":
    unittest.main()
