"""Arrays in and out: every layout, no copies where none is needed, nothing touched that is not part of the image."""

import unittest

from support import Case, context, luxfer, np

from luxfer import _arrays


class Images(Case):
    def test_float_arrays_come_back_to_the_bit(self):
        pixels = np.random.default_rng(1).normal(size=(7, 5, 3)).astype(np.float32)
        for layout in (
            pixels,
            pixels[::-1],
            pixels[::2],
            pixels[:, ::2],
            pixels[1:6, 1:4],
            pixels[:, ::-1],
            pixels[..., ::-1],
            np.asfortranarray(pixels),
            pixels[..., 1],
            pixels[..., :2],
            pixels.astype(">f4"),
        ):
            with self.subTest(shape=layout.shape, strides=layout.strides):
                image = luxfer.Image(context(), layout)
                self.assertEqual(image.numpy().tobytes(), np.ascontiguousarray(layout, np.float32).tobytes())

    def test_arrays_are_read_where_they_lie(self):
        pixels = np.zeros((6, 8, 4), np.float32)
        for layout in (pixels, pixels[::-1], pixels[1::2, 2:7], pixels[:, ::2, :3], pixels[..., 3], pixels[0], pixels[:1, :1]):
            described = _arrays.view(layout, "linear")[1]
            self.assertTrue(np.shares_memory(described, pixels), layout.strides)
        for layout in (pixels[..., ::-1], pixels[:, ::-1], pixels.transpose(2, 0, 1)[:3].transpose(1, 0, 2)[:, :, ::2]):
            self.assertFalse(np.shares_memory(_arrays.view(layout, "linear")[1], pixels))

    def test_large_arrays_cost_one_copy(self):
        """The library's own: beside it nothing of the image's size is allocated by numpy."""
        import tracemalloc

        pixels = np.zeros((1000, 1000, 3), np.float32)
        tracemalloc.start()
        image = luxfer.Image(context(), pixels[::2, ::2])
        image.read(pixels[1::2, 1::2])
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        self.assertLess(peak, 100_000)

    def test_reading_writes_the_image_and_nothing_else(self):
        image = luxfer.Image(context(), np.arange(12, dtype=np.float32).reshape(3, 4) / 11)
        for dtype in (np.uint8, np.uint16, np.float16, np.float32):
            frame = np.full((9, 9, 4), 7, dtype)
            image.read(frame[1:7:2, 2:6, 1])
            inside = frame[1:7:2, 2:6, 1].astype(float)
            scale = np.iinfo(dtype).max if np.issubdtype(dtype, np.integer) else 1
            np.testing.assert_allclose(inside / scale, image.numpy()[..., 0], atol=0.51 / 255)
            frame[1:7:2, 2:6, 1] = 7
            self.assertTrue((frame == 7).all())
        upside_down = np.empty((3, 4), np.float32)
        image.read(upside_down[::-1])
        np.testing.assert_array_equal(upside_down[::-1], image.numpy()[..., 0])

    def test_colour_spaces(self):
        codes = np.arange(256, dtype=np.uint8).reshape(16, 16)
        image = luxfer.Image(context(), codes, "srgb")
        x = codes / 255
        np.testing.assert_allclose(
            image.numpy()[..., 0], np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4), atol=2e-6
        )
        np.testing.assert_array_equal(image.numpy(np.uint8, "srgb")[..., 0], codes)

    def test_masks_and_lists(self):
        mask = np.eye(3, dtype=bool)
        np.testing.assert_array_equal(luxfer.Image(context(), mask).numpy()[..., 0], mask)
        np.testing.assert_array_equal(luxfer.Image(context(), [[1, 2], [3, 4]]).numpy()[..., 0], [[1, 2], [3, 4]])
        np.testing.assert_array_equal(np.asarray(luxfer.Image(context(), mask))[..., 0], mask)

    def test_files(self):
        pixels = np.random.default_rng(2).random((4, 6, 3)).astype(np.float32)
        image = luxfer.Image(context(), pixels)
        image.save(self.folder / "a.exr")
        np.testing.assert_array_equal(luxfer.Image.load(context(), self.folder / "a.exr").numpy(), pixels)
        image.save(self.folder / "a.png")
        again = luxfer.Image.from_bytes(context(), (self.folder / "a.png").read_bytes())
        np.testing.assert_array_equal(again.numpy(np.uint8, "srgb"), image.numpy(np.uint8, "srgb"))

    def test_many_channels(self):
        photo = luxfer.Image(context(), np.random.default_rng(3).random((24, 32, 3)))
        channels = luxfer.Features(context(), photo).run().image().numpy()
        self.assertEqual(channels.shape, (24, 32, 10))
        self.assertTrue(np.isfinite(channels).all())
        lengths = np.linalg.norm(channels[..., 7:], axis=-1)
        np.testing.assert_allclose(lengths, 1, atol=1e-4)

    def test_warp(self):
        picture = np.zeros((20, 20), np.float32)
        picture[5, 9] = 1
        image = luxfer.Image(context(), picture)
        square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        shift = luxfer.homography(context(), square, square + (3, 2))
        warped = image.warp(shift, 20, 20).numpy()[..., 0]
        self.assertEqual(np.unravel_index(warped.argmax(), warped.shape), (3, 6))

    def test_what_is_no_image(self):
        for wrong, kind in (
            (np.zeros(3), ValueError),
            (np.zeros((2, 2, 2, 2)), ValueError),
            (np.zeros((2, 2), complex), TypeError),
            (np.array([["a"]]), TypeError),
            (np.zeros((2, 2, 5)), ValueError),
            (np.zeros((0, 4, 3), np.float32), ValueError),
        ):
            with self.subTest(shape=wrong.shape), self.assertRaises(kind):
                luxfer.Image(context(), wrong)
        image = luxfer.Image(context(), np.zeros((2, 2)))
        for out in (np.zeros((2, 2)), np.zeros((2, 3), np.float32), np.zeros((2, 2), np.float32)[:, ::-1]):
            with self.assertRaises(ValueError):
                image.read(out)
        constant = np.zeros((2, 2), np.float32)
        constant.flags.writeable = False
        with self.assertRaises(ValueError):
            image.read(constant)
        with self.assertRaisesRegex(ValueError, "did you mean 'srgb'"):
            luxfer.Image(context(), np.zeros((2, 2)), "sRGBA")


if __name__ == "__main__":
    unittest.main()
