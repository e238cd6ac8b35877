"""Runs networks with the structure of MiDaS and DPT and random weights; compares with onnxruntime and numpy
processing."""

import unittest

import numpy as np
import onnxruntime
from onnx_file import Network
from support import Case, context, luxfer

from luxfer import errors


def midas(shape=(1, 3, 256, 256), opset: int = 11) -> bytes:
    """A network like MiDaS small: inverted residuals with ReLU6, and upsampling by bilinear resizing with aligned
    corners."""
    n = Network(list(shape), opset)
    x = n.add("Pad", "input", n.constant([0, 0, 0, 0, 0, 0, 1, 1]))
    x = n.add("Conv", x, n.noise(16, 3, 3, 3), n.noise(16), strides=[2, 2], kernel_shape=[3, 3])
    x = n.add("Clip", x, n.constant(np.float32(0)), n.constant(np.float32(6)))
    levels = []
    for channels in (24, 32, 48):
        wide = channels * 2
        before = {24: 16, 32: 24, 48: 32}[channels]
        y = n.add("Conv", x, n.noise(wide, before, 1, 1), n.noise(wide))
        y = n.add("Clip", y, n.constant(np.float32(0)), n.constant(np.float32(6)))
        y = n.add("Conv", y, n.noise(wide, 1, 3, 3), n.noise(wide), group=wide, strides=[2, 2], pads=[1, 1, 1, 1])
        y = n.add("BatchNormalization", y, *(n.constant(n.random.uniform(0.5, 2, wide).astype(np.float32)) for _ in range(4)))
        y = n.add("LeakyRelu", y, alpha=0.1)
        x = n.add("Conv", y, n.noise(channels, wide, 1, 1), n.noise(channels))
        levels.append(x)
    pooled = n.add("MaxPool", levels[0], kernel_shape=[3, 3], strides=[2, 2], pads=[1, 1, 1, 1])
    squeezed = n.add("Sigmoid", n.add("Conv", n.add("GlobalAveragePool", pooled), n.noise(24, 24, 1, 1)))
    levels[1] = n.add("Add", levels[1], n.add("Conv", n.add("Mul", pooled, squeezed), n.noise(32, 24, 1, 1)))
    y = n.add("Conv", levels[2], n.noise(32, 48, 1, 1))
    for level in (levels[1], levels[0]):
        # Compute the size of the level to which the result is added by nodes of the graph, as exporters do.
        size = n.add("Slice", n.add("Shape", level), n.constant([2]), n.constant([4]), n.constant([0]))
        size = n.add("Cast", n.add("Unsqueeze", n.add("Squeeze", n.add("Cast", size, to=1)), axes=[0]), to=7)
        front = n.add("Slice", n.add("Shape", y), n.constant([0]), n.constant([2]), n.constant([0]))
        size = n.add("Concat", front, n.add("Reshape", size, n.constant([-1])), axis=0)
        none = n.constant(np.zeros(0, np.float32))
        up = n.add("Resize", y, none, none, size, mode="linear", coordinate_transformation_mode="align_corners")
        y = n.add("Add", up, n.add("Conv", level, n.noise(32, 32 if level == levels[1] else 24, 3, 3), pads=[1, 1, 1, 1]))
        y = n.add("Relu", y)
    none = n.constant(np.zeros(0, np.float32))
    y = n.add("Resize", y, none, n.constant(np.float32([1, 1, 4, 4])), mode="linear")
    y = n.add("Conv", y, n.noise(1, 32, 3, 3), pads=[1, 1, 1, 1])
    return n.file(n.add("Squeeze", n.add("Add", n.add("Relu", y), y), axes=[1]))


def dpt(side: int = 64, opset: int = 17, width: int = 48, heads: int = 4) -> bytes:
    """A network like DPT: patches, a class token, attention with layer norms and GELU, and a head that reassembles
    patches."""
    n = Network([1, 3, side, side], opset)
    tokens = (side // 16) ** 2
    x = n.add("Conv", "input", n.noise(width, 3, 16, 16), n.noise(width), strides=[16, 16])
    x = n.add("Transpose", n.add("Reshape", x, n.constant([0, 0, -1])), perm=[0, 2, 1])
    token = n.add("Expand", n.noise(1, 1, width), n.constant([1, 1, 1]))
    x = n.add("Add", n.add("Concat", token, x, axis=1), n.noise(1, tokens + 1, width))

    def norm_by_parts(x: str) -> str:
        centred = n.add("Sub", x, n.add("ReduceMean", x, axes=[-1]))
        variance = n.add("ReduceMean", n.add("Pow", centred, n.constant(np.float32(2))), axes=[-1])
        return n.add("Div", centred, n.add("Sqrt", n.add("Add", variance, n.constant(np.float32(1e-6)))))

    for block in range(2):
        y = norm_by_parts(x) if block == 0 else n.add("LayerNormalization", x, n.noise(width), n.noise(width), axis=-1)
        y = n.add("Add", n.add("MatMul", y, n.noise(width, 3 * width)), n.noise(3 * width))
        y = n.add("Transpose", n.add("Reshape", y, n.constant([1, -1, 3, heads, width // heads])), perm=[2, 0, 3, 1, 4])
        if block == 0:
            q, k, v = (n.add("Gather", y, n.constant(np.int64(i)), axis=0) for i in range(3))
        else:
            parts = n.add("Split", y, outputs=3, axis=0)
            q, k, v = (n.add("Squeeze", part, n.constant([0])) for part in parts)
        weight = n.add("Mul", n.add("MatMul", q, n.add("Transpose", k, perm=[0, 1, 3, 2])), n.constant(np.float32(0.3)))
        y = n.add("MatMul", n.add("Softmax", weight, axis=-1), v)
        y = n.add("Reshape", n.add("Transpose", y, perm=[0, 2, 1, 3]), n.constant([1, -1, width]))
        x = n.add("Add", x, n.add("MatMul", y, n.noise(width, width)))
        one, zero = (n.constant(np.full(tokens + 1, value, np.float32)) for value in (1, 0))
        y = n.add("MatMul", n.add("InstanceNormalization", x, one, zero), n.noise(width, 2 * width))
        erf = n.add("Erf", n.add("Div", y, n.constant(np.float32(np.sqrt(2)))))
        y = n.add("Mul", n.add("Mul", y, n.add("Add", erf, n.constant(np.float32(1)))), n.constant(np.float32(0.5)))
        x = n.add("Add", x, n.add("MatMul", y, n.noise(2 * width, width)))

    first = n.add("Gather", x, n.constant([0]), axis=1)
    rest = n.add("Slice", x, n.constant([1]), n.constant([2**63 - 1]), n.constant([1]))
    count = n.add("Gather", n.add("Shape", rest), n.constant([1]), axis=0)
    shape = n.add("Concat", n.constant([1]), count, n.constant([width]), axis=0)
    ones = n.add("ConstantOfShape", n.constant([3]), value=np.int64([1]))
    shape = n.add("Where", n.add("Equal", shape, n.constant([-1, -1, -1])), ones, shape)
    read = n.add("Expand", first, shape)
    y = n.add("Concat", rest, read, axis=2)
    y = n.add("MatMul", y, n.noise(2 * width, width))
    y = n.add("Transpose", y, perm=[0, 2, 1])
    y = n.add("Reshape", y, n.constant([1, width, side // 16, side // 16]))
    y = n.add("ConvTranspose", y, n.noise(width, 24, 4, 4), n.noise(24), strides=[4, 4])
    none, twice = "", n.constant(np.float32([1, 1, 2, 2]))
    y = n.add("Resize", y, none, twice, mode="linear", coordinate_transformation_mode="align_corners")
    y = n.add("Relu", n.add("Conv", y, n.noise(16, 24, 3, 3), n.noise(16), pads=[1, 1, 1, 1]))
    y = n.add("Resize", y, none, twice, mode="cubic", cubic_coeff_a=-0.75)
    y = n.add("Conv", y, n.noise(1, 16, 1, 1), n.noise(1))
    return n.file(n.add("Squeeze", y, n.constant([1])))


def cubic(image: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Resizes planes by cubic convolution with the parameter -0.75, as OpenCV does."""

    def weights(size: int, to: int) -> np.ndarray:
        out = np.zeros((to, size))
        for k in range(to):
            x = (k + 0.5) * size / to - 0.5
            for i in range(int(np.floor(x)) - 1, int(np.floor(x)) + 3):
                t, a = abs(x - i), -0.75
                w = (a + 2) * t**3 - (a + 3) * t**2 + 1 if t <= 1 else a * t**3 - 5 * a * t**2 + 8 * a * t - 4 * a
                out[k, min(max(i, 0), size - 1)] += w
        return out

    return weights(image.shape[-2], rows) @ image @ weights(image.shape[-1], columns).T


def expected(file: bytes, photo: np.ndarray, size: tuple[int, int], mean, deviation, near=1.0, far=10.0) -> np.ndarray:
    """The expected depth: runs onnxruntime with the published pre-processing, and applies Eq. 1 of the paper to its
    output."""
    encoded = np.where(photo <= 0.0031308, 12.92 * photo, 1.055 * np.maximum(photo, 1e-9) ** (1 / 2.4) - 0.055)
    planes = cubic(np.moveaxis(encoded, -1, 0).astype(np.float64), *size)
    planes = (planes - np.reshape(mean, (3, 1, 1))) / np.reshape(deviation, (3, 1, 1))
    session = onnxruntime.InferenceSession(file, providers=["CPUExecutionProvider"])
    (answer,) = session.run(None, {"input": planes[None].astype(np.float32)})
    answer = cubic(answer.reshape(answer.shape[-2:]).astype(np.float64), *photo.shape[:2])
    m = (answer - answer.min()) / (answer.max() - answer.min())
    return 1 / (1 / far + m * (1 / near - 1 / far))


IMAGENET = ((0.485, 0.456, 0.406), (0.229, 0.224, 0.225))
HALF = ((0.5,) * 3, (0.5,) * 3)


class Networks(Case):
    def setUp(self) -> None:
        super().setUp()
        y, x = np.mgrid[0:90, 0:140]
        waves = [0.5 + 0.5 * np.sin(x / (9 + c) + y / (7 - c)) for c in range(3)]
        self.photo = np.stack(waves, -1).astype(np.float32)

    def depth(self, file: bytes, normalisation: str = "by-size", **settings) -> np.ndarray:
        path = self.folder / "network.onnx"
        path.write_bytes(file)
        features = luxfer.Features(context(), self.photo)
        features.set_network(path, normalisation)
        features.run(**settings)
        self.assertEqual(features.report.depth_source, luxfer.types.DepthSource.NETWORK)
        return features.image("network-depth").numpy()[..., 0]

    def check(self, file: bytes, size: tuple[int, int], normalised, normalisation: str = "by-size", **settings) -> None:
        want = expected(file, self.photo, size, *normalised, settings.get("near_plane", 1), settings.get("far_plane", 10))
        got = self.depth(file, normalisation, **settings)
        self.assertGreater(want.std(), 0.1)
        np.testing.assert_allclose(1 / got, 1 / want, atol=2e-4)

    def test_midas_small(self):
        self.check(midas(), (256, 256), IMAGENET)
        self.check(midas(), (256, 256), HALF, "half", near_plane=2.0, far_plane=50.0)

    def test_dpt(self):
        self.check(dpt(), (64, 64), HALF)
        self.check(dpt(384, width=32, heads=2), (384, 384), ((0,) * 3, (1,) * 3), "none")

    def test_open_sizes_keep_the_shape_of_the_photo(self):
        self.check(midas((1, 3, "height", "width")), (256, 384), IMAGENET, "imagenet")

    def test_the_depth_can_be_used_again(self):
        path = self.folder / "network.onnx"
        path.write_bytes(midas((1, 3, 64, 64)))
        features = luxfer.Features(context(), self.photo)
        with self.assertRaises(errors.NotReady):
            features.run().image("network-depth")
        features.set_network(path)
        path.unlink()
        first = features.run().image().numpy()
        features.set_depth(features.image("network-depth"))
        np.testing.assert_array_equal(features.run().image().numpy(), first)
        self.assertEqual(features.report.depth_source, luxfer.types.DepthSource.CALLER)

    def test_files_that_cannot_be_used(self):
        features = luxfer.Features(context(), self.photo)
        path = self.folder / "network.onnx"
        file = midas((1, 3, 64, 64))

        def refused(error, content: bytes) -> str:
            path.write_bytes(content)
            with self.assertRaises(error) as raised:
                features.set_network(path)
            return str(raised.exception)

        with self.assertRaises(errors.FileError):
            features.set_network(self.folder / "absent.onnx")
        refused(errors.FormatError, b"")
        refused(errors.FormatError, b"no network at all")
        refused(errors.FormatError, file[: len(file) // 2])
        grey = Network([1, 1, 64, 64], 13)
        self.assertIn("[1, 1, 64, 64]", refused(errors.Unsupported, grey.file(grey.add("Relu", "input"))))
        loop = Network([1, 3, 64, 64], 13)
        self.assertIn("Loop", refused(errors.Unsupported, loop.file(loop.add("Loop", "input"))))
        path.write_bytes(file)
        with self.assertRaises(errors.InvalidArgument):
            features._call("set_network", str(path).encode(), 9)
        # The refused files have not set a network, so the depth still comes from no source.
        self.assertEqual(features.run().report.depth_source, luxfer.types.DepthSource.NOTHING)

        # Refuse a network whose output is no depth map, and one that divides by zero.
        photo = Network([1, 3, 64, 64], 13)
        path.write_bytes(photo.file(photo.add("Relu", "input"), 4))
        features.set_network(path)
        with self.assertRaises(errors.Unsupported):
            features.run()
        zero = Network([1, 3, 64, 64], 13)
        mean = zero.add("ReduceMean", "input", axes=[1])
        path.write_bytes(zero.file(zero.add("Div", mean, zero.add("Sub", mean, mean))))
        features.set_network(path)
        with self.assertRaises(errors.Degenerate):
            features.run()


if __name__ == "__main__":
    unittest.main()
