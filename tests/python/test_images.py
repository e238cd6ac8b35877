"""Tests images from and to arrays: every memory layout, no needless copies, and no access outside the image."""

import struct
import unittest

from support import Case, context, luxfer, np

from luxfer import _arrays, errors


def tiff(picture, pixels, camera=()):
    """A TIFF file with the entries (tag, type, value) of `picture`, and the EXIF entries of `camera`."""

    def directory(entries, fractions):
        out = struct.pack("<H", len(entries))
        for tag, kind, value in entries:
            if isinstance(value, tuple):
                fractions.append(struct.pack("<II", *value))
                value = 176 + 8 * len(fractions)
            out += struct.pack("<HHII", tag, kind, 1, value)
        return out

    fractions = []
    notes = directory(camera, fractions) if camera else b""
    head = (b"II*\0" + struct.pack("<I", 8) + directory(picture, [])).ljust(120, b"\0") + notes
    return (head.ljust(184, b"\0") + b"".join(fractions)).ljust(200, b"\0") + pixels


#: EXIF entries of exposure time, f-number and ISO speed, by which white has 240 cd/m².
EXPOSURE = [(0x829A, 5, (1, 50)), (0x829D, 5, (2, 1)), (0x8827, 3, 100)]


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
        """Only the library copies the pixels: numpy allocates nothing of the image's size."""
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

    def test_formats(self):
        """Reads a red and a blue pixel from files of formats that are simple enough to be written here."""
        red, blue = b"\xff\0\0", b"\0\0\xff"
        files = {
            "bmp": b"BM" + struct.pack("<IIIIiiHHIIiiII", 62, 0, 54, 40, 2, 1, 1, 24, 0, 8, 0, 0, 0, 0) + red[::-1] + blue[::-1] + b"\0\0",
            "gif": b"GIF89a" + struct.pack("<HHBBB", 2, 1, 0x80, 0, 0) + red + blue
            + b"\x2c" + struct.pack("<HHHHB", 0, 0, 2, 1, 0) + b"\x02\x02\x44\x0a\0;",
            "tif": tiff([(256, 3, 2), (257, 3, 1), (258, 3, 8), (262, 3, 2), (273, 4, 200), (277, 3, 3), (279, 4, 6)], red + blue),
        }
        for ending, data in files.items():
            with self.subTest(ending):
                (self.folder / f"a.{ending}").write_bytes(data)
                pixels = luxfer.Image.load(context(), self.folder / f"a.{ending}").numpy()
                np.testing.assert_array_equal(pixels[0, :, :3], [[1, 0, 0], [0, 0, 1]])
        for data, name in ((b"\0\0\0\x1cftypavif", "AVIF"), (b"\0\0\0\x18ftypheic", "HEIC"), (b"\xff\x0a", "JPEG XL")):
            with self.assertRaisesRegex(errors.Unsupported, f"{name}.*convert it to JPEG"):
                luxfer.Image.from_bytes(context(), data)

    def test_metadata(self):
        picture = [(256, 3, 2), (257, 3, 1), (258, 3, 8), (262, 3, 1), (273, 4, 200), (274, 3, 8), (279, 4, 2), (0x8769, 4, 120)]
        camera = [*EXPOSURE, (0xA405, 3, 36)]
        photo = luxfer.Image.from_bytes(context(), tiff(picture, b"\0\xff", camera))
        self.assertEqual(photo.numpy().tolist(), [[[1.0]], [[0.0]]])
        known = photo.metadata
        self.assertEqual((known.orientation, known.f_number, known.exposure_time, known.iso), (8, 2, 0.02, 100))
        self.assertAlmostEqual(known.focal, 36 * 5**0.5 / np.hypot(36, 24))
        self.assertAlmostEqual(known.white_luminance, 240)
        self.assertLess(known.white_luminance_low, 240)
        nothing = luxfer.Image(context(), np.zeros((2, 2))).metadata
        self.assertEqual((nothing.orientation, nothing.focal, nothing.white_luminance), (1, 0, 0))

    def test_the_focal_length_of_a_file_is_used_where_lines_do_not_tell_it(self):
        """The photo is a corridor seen along its axis: nested rectangles, and lines that meet in the middle."""
        width, height = 360, 240
        x, y = (np.arange(n) - (n - 1) / 2 for n in (width, height))
        depth = np.maximum(abs(x)[None] / width, abs(y)[:, None] / height)
        boxes = (np.log2(depth + 0.02) * 3).astype(int) % 2
        sides = (np.arctan2(y[:, None] * width, x[None] * height) * 12 / np.pi).astype(int) % 2
        pixels = (60 + 60 * boxes + 100 * sides).astype(np.uint8)
        picture = [(256, 3, width), (257, 3, height), (258, 3, 8), (262, 3, 1), (273, 4, 200), (279, 4, pixels.size), (0x8769, 4, 120)]
        photo = luxfer.Image.from_bytes(context(), tiff(picture, pixels.tobytes(), [*EXPOSURE, (0xA405, 3, 50)]))
        focal = photo.metadata.focal
        self.assertAlmostEqual(focal, 50 * np.hypot(width, height) / np.hypot(36, 24))
        scene = luxfer.Scene.demo(context(), "target-room")
        whole = luxfer.Transfer(context(), photo, scene, "Ceiling").run(last="view")
        self.assertAlmostEqual(whole.report.proposed_white, 240)
        self.assertTrue(whole.report.proposed_white_low < 240 < whole.report.proposed_white_high)
        bare = luxfer.Transfer(context(), photo.numpy(), scene, "Ceiling").run(last="view").report
        self.assertAlmostEqual(bare.proposed_white * np.pi, 500)
        self.assertAlmostEqual(bare.proposed_white_low * np.pi, 100)
        for view in (luxfer.Rectify(context(), photo).run().report, whole.view):
            self.assertEqual(view.focal_source, luxfer.types.FocalSource.FROM_METADATA)
            self.assertLess(abs(view.focal / focal - 1), 0.05)
        self.assertEqual(luxfer.Rectify(context(), photo.numpy()).run().report.focal_source, luxfer.types.FocalSource.ASSUMED)
        for view in (
            luxfer.Rectify(context(), photo).run(focal=300).report,
            luxfer.Transfer(context(), photo, scene, "Ceiling").run(last="view", rectify={"focal": 300}).view,
        ):
            self.assertEqual((view.focal, view.focal_source), (300, luxfer.types.FocalSource.GIVEN))

    def test_exposures_merge_into_the_photo_of_the_reference(self):
        """Three exposures of a view whose right half is a lamp, with the times that a camera writes."""
        height, width = 48, 64
        scene = np.random.default_rng(5).uniform(0.05, 0.5, (height, width))
        scene[:, 40:] *= 20

        def shot(time, exposure):
            linear = np.clip(scene * exposure, 0, 1)
            encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
            picture = [(256, 3, width), (257, 3, height), (258, 3, 8), (262, 3, 1), (273, 4, 200), (279, 4, scene.size), (0x8769, 4, 120)]
            camera = [(0x829A, 5, time), *EXPOSURE[1:]]
            file = tiff(picture, np.rint(encoded * 255).astype(np.uint8).tobytes(), camera)
            return luxfer.Image.from_bytes(context(), file)

        photos = [shot((1, 60), 0.0625), shot((1, 4), 1.0), shot((1, 15), 0.25)]
        merged, found = luxfer.merge_exposures(context(), photos, reference=1)
        self.assertEqual((found.reference, found.count, len(found.exposures)), (1, 3, 3))
        np.testing.assert_allclose(found.exposures, [1 / 16, 1, 1 / 4], rtol=5e-3)
        np.testing.assert_allclose(found.stated, [1 / 15, 1, 4 / 15], rtol=1e-6)
        self.assertEqual((found.shift_x, found.shift_y, found.clipped), ((0, 0, 0), (0, 0, 0), 0))
        ratios = merged.numpy()[:, :, 0] / scene
        self.assertLess(abs(ratios[:, 40:].mean() - 1), 0.01)
        self.assertLess(abs(ratios[:, :38].mean() - 1), 0.01)
        self.assertEqual(merged.metadata, photos[1].metadata)
        self.assertAlmostEqual(merged.metadata.white_luminance, 240 / 50 * 4)

        self.assertEqual(luxfer.merge_exposures(context(), photos[:1])[0].numpy().tobytes(), photos[0].numpy().tobytes())
        with self.assertRaisesRegex(errors.InvalidArgument, r"photos\[0\] and photos\[1\].*ratio 15.0000.*LUXFER_EXPOSURE_SOURCE_PIXELS"):
            luxfer.merge_exposures(context(), [photos[0], shot((1, 4), 0.25)])
        for count in (0, 17):
            with self.assertRaisesRegex(errors.InvalidArgument, f"count is {count}"):
                luxfer.merge_exposures(context(), [photos[0]] * count)
        with self.assertRaisesRegex(ValueError, "2 values for 3 photos"):
            luxfer.merge_exposures(context(), photos, exposures=[1, 2])
        with self.assertRaisesRegex(errors.InvalidArgument, r"photos\[1\] is 8 x 8 and photos\[0\] is 64 x 48"):
            luxfer.merge_exposures(context(), [photos[0], np.ones((8, 8, 1))])

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
