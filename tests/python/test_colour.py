"""Compares the colours of files that have ICC profiles with those of LCMS (through Pillow); tolerance: one code of
255."""

import io
import itertools
import re
import struct
import tempfile
import unittest
from pathlib import Path

from support import Case, context, luxfer, np

try:
    from PIL import Image as Pillow
    from PIL import ImageCms
except ImportError:
    Pillow = None

RED_GREEN_BLUE = {
    "Display P3": [(0.680, 0.320), (0.265, 0.690), (0.150, 0.060)],
    "Adobe RGB": [(0.64, 0.33), (0.21, 0.71), (0.15, 0.06)],
    "Rec.2020": [(0.708, 0.292), (0.170, 0.797), (0.131, 0.046)],
}
#: Profiles of the Debian package libgs-common, if it is installed.
CMYK_PROFILES = [Path("/usr/share/color/icc/ghostscript") / f"{name}_cmyk.icc" for name in ("default", "ps")]
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def fixed(values):
    return b"".join(struct.pack(">i", round(v * 65536)) for v in values)


def xyz(x, y):
    return np.array([x, y, 1 - x - y]) / y


def colorants(primaries):
    """Matrix of the primaries' XYZ colours in its columns, for white D65, adapted to D50."""
    white, d50 = xyz(0.3127, 0.3290), np.array([0.9642, 1.0, 0.8249])
    columns = np.stack([xyz(*p) for p in primaries], axis=1)
    columns = columns * np.linalg.solve(columns, white)
    return np.linalg.inv(BRADFORD) @ np.diag(BRADFORD @ d50 / (BRADFORD @ white)) @ BRADFORD @ columns


def curve(kind, gamma):
    if kind == "parametric":
        return b"para\0\0\0\0" + struct.pack(">HH", 3, 0) + fixed([2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045])
    if kind == "table":
        codes = np.round(65535 * np.linspace(0, 1, 257) ** gamma).astype(">u2")
        return b"curv\0\0\0\0" + struct.pack(">I", len(codes)) + codes.tobytes()
    return b"curv\0\0\0\0" + struct.pack(">IH", 1, round(gamma * 256))


def tables(size=17):
    """An ICC lut16Type (version 2) from RGB to PCS Lab, with the tone curve of sRGB and less chroma."""
    codes = np.stack(np.meshgrid(*[np.linspace(0, 1, size)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    t = (linear @ colorants([(0.60, 0.33), (0.30, 0.57), (0.16, 0.09)]).T) / [0.9642, 1.0, 0.8249]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t * (841 / 108) + 4 / 29)
    lab = np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)
    lab = np.stack([lab[:, 0] * 652.8, (lab[:, 1] + 128) * 256, (lab[:, 2] + 128) * 256], axis=1)
    stored = np.round(np.clip(lab, 0, 65535))
    ends = np.array([0, 65535] * 3, ">u2").tobytes()
    head = b"mft2\0\0\0\0" + bytes([3, 3, size, 0]) + fixed([1, 0, 0, 0, 1, 0, 0, 0, 1]) + struct.pack(">HH", 2, 2)
    return head + ends + stored.astype(">u2").tobytes() + ends


def ink_tables(size):
    """An ICC lut16Type (version 2) from CMYK to PCS Lab: inks that filter the colour of paper, with input and output
    curves."""
    inks = np.stack(np.meshgrid(*[np.linspace(0, 1, size)] * 4, indexing="ij"), axis=-1).reshape(-1, 4)
    c, m, y, k = inks.T
    lightness = 95 * (1 - 0.4 * c) * (1 - 0.5 * m) * (1 - 0.1 * y) * (1 - 0.85 * k)
    a, b = (70 * m - 35 * c) * (1 - k), (80 * y - 45 * c) * (1 - k)
    lab = np.stack([lightness * 652.8, (a + 128) * 256, (b + 128) * 256], axis=1)
    stored = np.round(np.clip(lab, 0, 65535)).astype(">u2")
    codes = np.linspace(0, 1, 256)
    gain = np.round(65535 * (0.7 * codes + 0.3 * codes**2)).astype(">u2").tobytes() * 4
    ends = np.array([0, 65535] * 3, ">u2").tobytes()
    head = b"mft2\0\0\0\0" + bytes([4, 3, size, 0]) + fixed([1, 0, 0, 0, 1, 0, 0, 0, 1]) + struct.pack(">HH", 256, 2)
    return head + gain + stored.tobytes() + ends


def profile(tags, space=b"RGB ", pcs=b"XYZ ", version=2):
    offset, table, data = 128 + 4 + 12 * len(tags), b"", b""
    for name, content in tags.items():
        content += bytes(-len(content) % 4)
        table += name.encode() + struct.pack(">II", offset + len(data), len(content))
        data += content
    size = offset + len(data)
    head = struct.pack(">I4sI4s4s4s", size, b"\0" * 4, version << 24, b"mntr", space, pcs)
    head += struct.pack(">6H", 2026, 1, 1, 0, 0, 0) + b"acsp" + b"\0" * 28 + fixed([0.9642, 1.0, 0.8249])
    return head.ljust(128, b"\0") + struct.pack(">I", len(tags)) + table + data


def described(tags):
    text = b"desc\0\0\0\0" + struct.pack(">I", 5) + b"test\0" + bytes(78)
    white = b"XYZ \0\0\0\0" + fixed([0.9642, 1.0, 0.8249])
    return {"desc": text, "wtpt": white, "cprt": b"text\0\0\0\0none\0", **tags}


def matrix_profile(primaries, kind, gamma=2.2):
    columns = colorants(primaries)
    tags = {f"{c}XYZ": b"XYZ \0\0\0\0" + fixed(columns[:, i]) for i, c in enumerate("rgb")}
    return profile(described({**tags, **{f"{c}TRC": curve(kind, gamma) for c in "rgb"}}))


def by_lcms(pixels, icc):
    source, target = ImageCms.ImageCmsProfile(io.BytesIO(icc)), ImageCms.createProfile("sRGB")
    intent = ImageCms.Intent.RELATIVE_COLORIMETRIC
    made = ImageCms.profileToProfile(Pillow.fromarray(pixels), source, target, intent, outputMode="RGB")
    return np.asarray(made).astype(float)


def codes_of(linear):
    linear = np.clip(linear, 0, 1)
    return np.round(255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))


def file_of(pixels, kind, icc):
    out = io.BytesIO()
    options = {"lossless": True} if kind == "WebP" else {"quality": 100, "subsampling": 0} if kind == "JPEG" else {}
    Pillow.fromarray(pixels).save(out, kind, icc_profile=icc, **options)
    return out.getvalue()


@unittest.skipUnless(Pillow, "needs Pillow")
class Colours(Case):
    def setUp(self):
        self.pixels = np.random.default_rng(7).integers(0, 256, (64, 64, 3), np.uint8)
        self.pixels[0, :8] = [[255 * (i >> c & 1) for c in range(3)] for i in range(8)]

    def assert_like_lcms(self, data, pixels, icc):
        image = luxfer.Image.from_bytes(context(), data)
        self.assertEqual(image.metadata.colour, luxfer.types.FileColour.CONVERTED)
        difference = np.abs(codes_of(np.asarray(image)) - by_lcms(pixels, icc))
        self.assertLessEqual(difference.max(), 1)

    def test_profiles_of_curves_and_a_matrix(self):
        for name, primaries in RED_GREEN_BLUE.items():
            for kind in ("parametric", "table", "gamma"):
                icc = matrix_profile(primaries, kind)
                for file in ("PNG", "WebP", "TIFF"):
                    with self.subTest(name, kind=kind, file=file):
                        self.assert_like_lcms(file_of(self.pixels, file, icc), self.pixels, icc)

    def test_profile_of_a_jpeg(self):
        icc = matrix_profile(RED_GREEN_BLUE["Display P3"], "parametric")
        data = file_of(self.pixels, "JPEG", icc)
        plain = luxfer.Image.from_bytes(context(), file_of(self.pixels, "JPEG", None))
        decoded = codes_of(np.asarray(plain)).astype(np.uint8)
        self.assert_like_lcms(data, decoded, icc)

    def test_profiles_of_tables(self):
        icc = profile(described({"A2B0": tables()}), pcs=b"Lab ")
        self.assert_like_lcms(file_of(self.pixels, "PNG", icc), self.pixels, icc)

    def test_profiles_for_greys(self):
        icc = profile(described({"kTRC": curve("table", 1.8)}), b"GRAY")
        grey = self.pixels[..., 0]
        image = luxfer.Image.from_bytes(context(), file_of(grey, "PNG", icc))
        difference = np.abs(codes_of(np.asarray(image)[..., :1]) - by_lcms(grey, icc)[..., :1])
        self.assertLessEqual(difference.max(), 1)

    def test_masks_are_not_converted(self):
        icc = matrix_profile(RED_GREEN_BLUE["Rec.2020"], "gamma")
        image = luxfer.Image.from_bytes(context(), file_of(self.pixels, "PNG", icc), "linear")
        self.assertEqual(image.metadata.colour, luxfer.types.FileColour.DATA)
        self.assertTrue(np.array_equal(np.round(np.asarray(image) * 255), self.pixels))

    def inks(self):
        """A CMYK image of random and extreme amounts, in squares of 8 pixels, which JPEG preserves."""
        inks = np.random.default_rng(8).integers(0, 256, (32, 32, 4), np.uint8)
        inks[0, :16] = [[255 * (i >> c & 1) for c in range(4)] for i in range(16)]
        return Pillow.fromarray(inks.repeat(8, axis=0).repeat(8, axis=1), "CMYK")

    def test_profiles_for_inks(self):
        profiles = {f"{size} points": profile(described({"A2B0": ink_tables(size)}), b"CMYK", b"Lab ") for size in (5, 9, 11, 16)}
        for path in CMYK_PROFILES:
            if path.exists():
                profiles[path.name] = path.read_bytes()
        for (name, icc), kind in itertools.product(profiles.items(), ("TIFF", "JPEG", "YCCK")):
            with self.subTest(name, kind=kind):
                out = io.BytesIO()
                options = {} if kind == "TIFF" else {"quality": 100, "subsampling": 0}
                self.inks().save(out, "TIFF" if kind == "TIFF" else "JPEG", icc_profile=icc, **options)
                if kind == "YCCK":  # the same numbers, but marked as YCbCr and black
                    out = io.BytesIO(re.sub(rb"(?s)(Adobe.{6})\0", lambda found: found[1] + b"\2", out.getvalue(), count=1))
                with Pillow.open(out) as stored:
                    stored.load()
                image = luxfer.Image.from_bytes(context(), out.getvalue())
                self.assertEqual(image.metadata.colour, luxfer.types.FileColour.CONVERTED)
                self.assertEqual(image.size[2], 3)
                # NOOPTIMIZE keeps LCMS from resampling the tables of the profile.
                source, target = ImageCms.ImageCmsProfile(io.BytesIO(icc)), ImageCms.createProfile("sRGB")
                intent, exact = ImageCms.Intent.RELATIVE_COLORIMETRIC, ImageCms.Flags.NOOPTIMIZE
                transform = ImageCms.buildTransform(source, target, "CMYK", "RGB", intent, exact)
                wanted = np.asarray(ImageCms.applyTransform(stored, transform)).astype(float)
                self.assertLessEqual(np.abs(codes_of(np.asarray(image)) - wanted).max(), 1)

    def test_inks_without_a_profile_are_named(self):
        damaged, display = profile(described({}), b"CMYK", b"Lab "), matrix_profile(RED_GREEN_BLUE["Display P3"], "gamma")
        for icc, kind in itertools.product((None, damaged, display), ("TIFF", "JPEG")):
            out = io.BytesIO()
            self.inks().save(out, kind, icc_profile=icc)
            image = luxfer.Image.from_bytes(context(), out.getvalue())
            self.assertEqual(image.metadata.colour, luxfer.types.FileColour.UNCONVERTED)

    def test_written_files_state_their_colours(self):
        image = luxfer.Image(context(), np.full((2, 2, 3), 0.5, np.float32))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "stated.png"
            image.save(path)
            with Pillow.open(path) as png:
                self.assertEqual(png.info.get("srgb"), 1)


if __name__ == "__main__":
    unittest.main()
