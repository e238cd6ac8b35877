"""Which product is this? Files are generated; the lamp is one of them, or a changed one."""

import contextlib
import io
import json
import math
import re
import tempfile
import time
import unittest
import zipfile
from pathlib import Path
from types import SimpleNamespace

from support import Case, context, luxfer, np

from luxfer.cli import products as command
from luxfer.cli.program import main
from luxfer.design import Lamp, find_products, openings
from luxfer.design.products import COLOUR_WEIGHT
from luxfer.types import Body, Doubt, Fixture, Pendant
from luxfer.types import Luminaire as TextureLamp

ANGLES = range(0, 91, 15)


def ies(size=(0.6, 0.6, 0.0), flux=3000.0, power=1.0, name="Lamp") -> bytes:
    """An IES file of a lamp with an intensity of cos^power and about this flux; size along C = 90, C = 0, and the
    axis."""
    peak = flux * (power + 1) / (2 * math.pi)
    candela = " ".join(f"{peak * max(0.0, math.cos(math.radians(a))) ** power:.6f}" for a in ANGLES)
    sides = " ".join(f"{side:.5f}" for side in size)
    return (
        f"IESNA:LM-63-2002\n[LUMINAIRE] {name}\nTILT=NONE\n1 -1 1 {len(ANGLES)} 1 1 2 {sides}\n1 1 30\n"
        f"{' '.join(map(str, ANGLES))}\n0\n{candela}\n"
    ).encode()


def ldt(data: bytes, kelvin: str) -> bytes:
    """The bytes of an EULUMDAT file with this colour temperature."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "lamp.ldt")
        luxfer.Distribution.load_memory(context(), data).save(path)
        lines = path.read_text().split("\n")
    lines[29] = kelvin  # the line after the lamp flux
    return "\n".join(lines).encode()


class Products(Case):
    def write(self, name: str, data: bytes) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)

    def load(self, name: str) -> luxfer.Distribution:
        return luxfer.Distribution.load(context(), self.folder / name)

    def find(self, *arguments, **values):
        return find_products(context(), self.folder, *arguments, **values)

    def test_a_thousand_files(self):
        """The exact file has the distance 0, and a perturbed lamp is nearest to its origin, in seconds."""
        rng = np.random.default_rng(1)
        count = 1000
        sides = np.exp(rng.uniform(math.log(0.1), math.log(1.5), (count, 2)))
        fluxes = np.exp(rng.uniform(math.log(300), math.log(10000), count))
        powers = rng.uniform(0.5, 6, count)
        for i in range(count):
            data = ies((*sides[i], 0.0), fluxes[i], powers[i], f"Product {i}")
            if i % 10:
                self.write(f"{i:04}.ies", data)
            else:
                luxfer.Distribution.load_memory(context(), data).save(self.folder / f"{i:04}.{('ldt', 'xml', 'gldf')[i // 10 % 3]}")
        began = time.process_time()
        for i in (17, 250, 310, 500):
            (path,) = self.folder.glob(f"{i:04}.*")
            found = self.find(Lamp.of_distribution(self.load(path.name)))
            self.assertEqual((found.compared, found.matches[0].path, len(found.matches)), (count, path, 5))
            self.assertLess(found.matches[0].distance, 1e-6)
            self.assertGreater(found.matches[1].distance, 1e-3)
            for part in found.matches[0].parts:
                self.assertLess(part.distance, 1e-6, part)
        right = 0
        for i in range(0, count, 50):
            changed = ies((*(sides[i] * np.exp(rng.normal(0, 0.01, 2))), 0.0), fluxes[i] * 1.02, powers[i] + 0.05)
            lamp = Lamp.of_distribution(luxfer.Distribution.load_memory(context(), changed))
            found = self.find(lamp)
            right += found.matches[0].name == f"Product {i}"
            self.assertIn(f"Product {i}", [match.name for match in found.matches])
        self.assertGreaterEqual(right, 19)
        self.assertLess((time.process_time() - began) / 24, 10)

    def test_the_parts_are_as_documented(self):
        self.write("a.ldt", ldt(ies((0.3, 1.2, 0.05), 3000), "4000"))
        flux = self.load("a.ldt").report.flux
        (match,) = self.find(size=(0.33, 1.32), flux=1.1 * flux, cct=3000, shape="tube").matches
        parts = {part.name: part.distance for part in match.parts}
        self.assertAlmostEqual(parts["size"], math.log(1.1), places=6)
        self.assertAlmostEqual(parts["flux"], math.log(1.1), places=6)
        self.assertAlmostEqual(parts["cct"], COLOUR_WEIGHT * (1e6 / 3000 - 1e6 / 4000), places=6)
        self.assertEqual(parts["shape"], 0.5)
        self.assertAlmostEqual(match.distance, math.sqrt(sum(v * v for v in parts.values()) / 4), places=9)
        self.assertIn("1.2 x 0.3 m instead of 1.32 x 0.33 m (0.095)", str(match))
        self.assertIn("4000 K instead of 3000 K", str(match))
        # The height counts if both state it.
        (match,) = self.find(size=(1.2, 0.3, 0.1)).matches
        self.assertAlmostEqual(match.distance, math.log(2) / math.sqrt(3), places=6)
        (match,) = self.find(size=0.6).matches
        self.assertAlmostEqual(match.distance, math.log(2), places=6)

    def test_distributions(self):
        """Of two distributions, the share of the flux that has to be moved; a lamp may be turned."""

        def lopsided(size, *lobes):
            rows = [
                " ".join(f"{1000 * math.cos(math.radians(a)) * lobe * math.sin(math.radians(2 * a)) + 10:.5f}" for a in ANGLES)
                for lobe in lobes
            ]
            turns = "0 90 180 270 360"
            text = "\n".join([*rows, rows[0]])
            return (
                f"IESNA:LM-63-2002\n[LUMINAIRE] L\nTILT=NONE\n1 -1 1 {len(ANGLES)} 5 1 2 {size}\n1 1 30\n"
                f"{' '.join(map(str, ANGLES))}\n{turns}\n{text}\n"
            ).encode()

        self.write("square.ies", lopsided("0.6 0.6 0", 1, 0, 0, 0))
        self.write("along.ies", lopsided("0.6 0.3 0", 1, 0, 0, 0))
        self.write("even.ies", ies(power=1))

        def distances(data):
            found = self.find(distribution=luxfer.Distribution.load_memory(context(), data))
            return {match.path.stem: match.distance for match in found.matches}

        # A square lamp may be turned by 90 degrees; a long one only so that the long sides lie side by side.
        self.assertLess(distances(lopsided("0.6 0.6 0", 0, 1, 0, 0))["square"], 1e-6)
        self.assertGreater(distances(lopsided("0.6 0.3 0", 0, 1, 0, 0))["along"], 0.3)
        self.assertLess(distances(lopsided("0.6 0.3 0", 0, 0, 1, 0))["along"], 1e-6)
        self.assertLess(distances(lopsided("0.3 0.6 0", 0, 1, 0, 0))["along"], 1e-6)
        # For cos^n, the shares of the flux below an angle are 1 - cos^(n+1): between 1 and 3 at most 0.25 apart.
        self.assertAlmostEqual(distances(ies(power=3))["even"], 0.25, delta=0.03)

    def test_unknown_values_are_left_out_and_said(self):
        self.write("sub/white.ldt", ldt(ies(flux=3000), "4000"))
        self.write("point.ies", ies((0, 0, 0), 3000))
        self.write("dark.ies", ies((0, 0, 0), 0))
        self.write("broken.ldt", b"nothing")
        self.write("other.xml", b"<page/>")
        self.write("notes.txt", b"not a luminaire")
        found = self.find(size=(0.6, 0.6), cct=4000, flux=3000)
        self.assertEqual((found.compared, found.unknown), (2, ("shape", "distribution")))
        by_name = {match.path.name: match for match in found.matches}
        self.assertEqual(by_name["point.ies"].left_out, ("size", "cct"))
        self.assertEqual(by_name["white.ldt"].left_out, ())
        self.assertEqual([path.name for path in found.incomparable], ["dark.ies"])
        self.assertEqual(sorted(path.name for path, _ in found.unreadable), ["broken.ldt", "other.xml"])
        self.assertTrue(all(reason and not reason.startswith(str(self.folder)) for _, reason in found.unreadable))
        text = found.explanation()
        for words in ("left out, because unknown of the lamp: shape, distribution", "broken.ldt: ", "dark.ies", "not stated by the file: size, cct"):
            self.assertIn(words, text)

    def test_shapes(self):
        for size, shape in (
            ((0.6, 0.3, 0), "rectangle"),
            ((0.6, 0.3, 0.1), "rectangle"),
            ((-0.4, -0.4, 0), "round"),
            ((-0.4, 0, 0), "round"),
            ((-0.4, -0.4, 0.2), "round"),
            ((-0.3, -0.3, -0.3), "globe"),
            ((1.2, 0, -0.04), "tube"),
            ((1.2, -0.04, -0.04), "tube"),
            ((0, 0, 0), None),
            ((0, 0, 0.5), None),
        ):
            self.assertEqual(openings.shape_of(size), shape, size)
        self.assertEqual(openings.sides_of((0, 1.2, -0.04)), (1.2, 0.04, 0.04))
        self.assertEqual(command.SHAPES, openings.SHAPES)

    def test_lamps_of_photos(self):
        fixture = SimpleNamespace(size=(1.2, 0.3), area=0.36, flux=3000.0, cct=4000.0)
        lamp = Lamp.of(self.as_type(Fixture, fixture))
        self.assertEqual((lamp.size, lamp.shape, lamp.flux, lamp.cct), ((1.2, 0.3), "rectangle", 3000.0, 4000.0))
        self.assertEqual(lamp.known, ["size", "shape", "flux", "cct"])
        off = SimpleNamespace(size=(0.4, 0.4), area=0.1257, flux=0.0, cct=0.0)
        self.assertEqual(Lamp.of(self.as_type(Fixture, off)).known, ["size", "shape"])
        texels = SimpleNamespace(size=(40.0, 20.0), area=500.0, colour=(1.0, 1.0, 1.0))
        lamp = Lamp.of(self.as_type(TextureLamp, texels), context(), metres=0.01)
        self.assertEqual((lamp.size, lamp.shape), ((0.4, 0.2), None))
        self.assertAlmostEqual(lamp.cct, 6504, delta=30)
        self.assertEqual(Lamp.of(self.as_type(TextureLamp, texels)).known, [])
        band = (1.0, 0.75, 0.45)
        globe = dict(kind=Body.GLOBE, diameter=(0.4, 0.38, 0.42), height=(0.4, 0.38, 0.42), radiance=(band,) * 16)
        lamp = Lamp.of(self.as_type(Pendant, SimpleNamespace(doubts=Doubt(0), **globe)), context())
        self.assertEqual((lamp.size, lamp.shape), ((0.4, 0.4, 0.4), "globe"))
        self.assertAlmostEqual(lamp.cct, luxfer.colour_temperature(context(), band)[0], delta=1)
        unsure = Lamp.of(self.as_type(Pendant, SimpleNamespace(doubts=Doubt.SIZE | Doubt.CLIPPED, **globe)), context())
        self.assertEqual(unsure.known, ["shape"])
        self.write("globe.ies", ies((-0.4, -0.4, -0.4), 800))
        self.write("panel.ies", ies((0.4, 0.4, 0), 800))
        self.assertEqual([match.path.stem for match in self.find(lamp).matches], ["globe", "panel"])

    def as_type(self, kind, values):
        """A report with these fields only."""
        made = object.__new__(kind)
        made.__dict__.update(vars(values))
        return made

    def test_variants_of_a_container(self):
        self.write("a.ies", ies())
        self.load("a.ies").save(self.folder / "b.gldf")
        with zipfile.ZipFile(self.folder / "b.gldf") as archive:
            parts = {name: archive.read(name) for name in archive.namelist()}
        # A second variant of three times the size, and a third one whose geometry is missing.
        text = parts["product.xml"].decode()
        for tag, number, old, new in (
            ("SimpleGeometry", "large", ">600<", ">1800<"),
            ("Variant", "large", 'geometryId="geometry"', 'geometryId="large"'),
            ("Variant", "lost", 'geometryId="geometry"', 'geometryId="nowhere"'),
        ):
            one = re.search(rf"<{tag} id=.*?</{tag}>", text, re.S)[0]
            other = re.sub('id="[a-z]*"', f'id="{number}"', one, count=1).replace(old, new)
            end = "</Variants>" if tag == "Variant" else "</Geometries>"
            text = text.replace(end, other + end)
        with zipfile.ZipFile(self.folder / "b.gldf", "w") as archive:
            for name, data in {**parts, "product.xml": text.encode()}.items():
                archive.writestr(name, data)
        found = self.find(size=1.8)
        listed = [(match.path.name, match.variant) for match in found.matches]
        self.assertEqual((listed[0], sorted(listed[1:], key=str)), (("b.gldf", 1), [("a.ies", None), ("b.gldf", 0)]))
        self.assertEqual([path.name for path, _ in found.unreadable], ["b.gldf"])
        self.assertIn("b.gldf#1", str(found.matches[0]))

    def test_bad_values_are_named(self):
        self.write("a.ies", ies())
        for values, message in (
            ({}, "there is nothing to compare: give size, shape, flux, cct or distribution"),
            ({"flux": 0}, "flux is 0 lm; it must be finite and above 0"),
            ({"flux": math.nan}, "flux is nan lm; it must be finite and above 0"),
            ({"cct": 500}, r"cct is 500 K; it must be in \[1000, 20000\]"),
            ({"shape": "star"}, "shape is 'star'; it must be one of rectangle, round, tube, globe"),
            ({"size": (1, 2, 3, 4)}, r"size is \(1, 2, 3, 4\); it must be a diameter, two sides"),
            ({"size": (1, 0)}, r"size is \(1, 0\); it must be"),
            ({"size": -1}, "size is -1; it must be"),
            ({"flux": 100, "count": 0}, "count is 0; it must be at least 1"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                self.find(**values)
        with self.assertRaisesRegex(ValueError, "folder is '.*nowhere'; it must be an existing folder"):
            find_products(context(), self.folder / "nowhere", flux=100)
        (self.folder / "empty").mkdir()
        with self.assertRaisesRegex(ValueError, r"has no luminaire file; names end in \.ies, \.ldt"):
            find_products(context(), self.folder / "empty", flux=100)

    def test_command_line(self):
        self.write("a.ies", ies((0.3, 1.2, 0), 3600, name="Batten"))
        self.write("b.ies", ies((0.6, 0.6, 0), 3600, name="Panel"))
        self.write("c.ldt", b"nothing")
        code, out, err = self.run_it(str(self.folder), "--size", "60x60cm", "--flux", "3500", "--count", "1")
        self.assertEqual(code, 0, err)
        self.assertIn("b.ies (Panel): 0.6 x 0.6 m", out)
        self.assertNotIn("Batten", out)
        self.assertIn("c.ldt", err)
        code, out, _ = self.run_it(str(self.folder), "--like", str(self.folder / "a.ies"), "--json")
        found = json.loads(out)
        self.assertEqual((found["compared"], found["unknown"], len(found["unreadable"])), (2, ["cct"], 1))
        self.assertEqual((found["matches"][0]["name"], found["matches"][0]["distance"]), ("Batten", 0))
        code, _, err = self.run_it(str(self.folder), "--size", "big")
        self.assertEqual(code, 2)
        self.assertIn("'big' is not a diameter, two sides", err)
        code, _, err = self.run_it(str(self.folder))
        self.assertEqual((code, err.count("\n")), (2, 1))
        code, _, err = self.run_it(str(self.folder), "--like", str(self.folder / "c.ldt"))
        self.assertEqual(code, 3)

    def run_it(self, *arguments):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main(["products", *arguments])
        return code, out.getvalue(), err.getvalue()


if __name__ == "__main__":
    unittest.main()
