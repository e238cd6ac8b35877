"""Tests that OpenEXR's own Python module reads the files of luxfer, layer by layer, and the other way round."""

import unittest

import OpenEXR
from support import Case, context, luxfer, np

AOVS = "depth|distance|position|normal|geometric-normal|albedo|object|material|alpha|luminance"
CHANNELS = {1: "Z", 3: "XYZ"}
#: Layers whose channels are not named by their number.
NAMED = {"Albedo": "RGB", "IndexOB": "X", "IndexMA": "X", "Luminance": "Y"}


class Exr(Case):
    def test_layers_of_a_rendering(self):
        expressions = {"matt": "L.*DE", "lamp": "C.*<L.'Lamp'>"}
        scene = luxfer.Scene.demo(context(), "still-life")
        render = luxfer.Render(context(), scene, expressions=expressions, aovs=AOVS).run(width=40, height=30, samples=4)
        path = str(self.folder / "layers.exr")
        render.write_exr(path)

        expected = {c: render.image().numpy()[:, :, i] for i, c in enumerate("RGB")}
        for name, image in render.layers.items():
            pixels = image.numpy()
            if name == "Alpha":
                expected["A"] = pixels[:, :, 0]
                continue
            letters = "RGB" if name in expressions else NAMED.get(name) or CHANNELS[pixels.shape[2]]
            expected |= {f"{name}.{c}": pixels[:, :, i] for i, c in enumerate(letters)}
        expected["Z"] = expected["Depth.Z"]

        with OpenEXR.File(path, separate_channels=True) as file:
            found = {name: channel.pixels for name, channel in file.channels().items()}
            self.assertEqual(found.keys(), expected.keys())
            for name, pixels in found.items():
                self.assertEqual(pixels.dtype, np.float32, name)
                np.testing.assert_array_equal(pixels, expected[name], name)
            for name, expression in expressions.items():
                self.assertEqual(file.header()[f"luxfer.lpe.{name}"], expression)

    def test_an_image_there_and_back(self):
        pixels = np.random.default_rng(1).lognormal(0, 4, (20, 30, 3)).astype(np.float32)
        path = str(self.folder / "image.exr")
        luxfer.Image(context(), pixels).save(path)
        with OpenEXR.File(path) as file:
            np.testing.assert_array_equal(file.channels()["RGB"].pixels, pixels)
        for dtype in (np.float16, np.float32):
            for compression in (OpenEXR.NO_COMPRESSION, OpenEXR.ZIP_COMPRESSION, OpenEXR.PIZ_COMPRESSION):
                with self.subTest(dtype=dtype, compression=compression):
                    stored = np.minimum(pixels, 60000).astype(dtype)
                    header = {"compression": compression, "type": OpenEXR.scanlineimage}
                    OpenEXR.File(header, {"RGB": stored}).write(path)
                    np.testing.assert_array_equal(luxfer.Image.load(context(), path).numpy(), stored.astype(np.float32))
        OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, {"Z": pixels[:, :, 0].copy()}).write(path)
        np.testing.assert_array_equal(luxfer.Image.load(context(), path).numpy()[:, :, 0], pixels[:, :, 0])


if __name__ == "__main__":
    unittest.main()
