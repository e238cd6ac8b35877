"""Luminaire files in the formats IES, EULUMDAT, TM-33 and GLDF, which the library converts into each other.

`LUXFER_TEST_SCHEMAS` names a folder with the published schemas `gldf.xsd` (GLDF 1.0.0-rc.3) and `tm33.xsd` (TM-33-23);
docs/notes/luminaire-files.md lists their origins. Without it, or without the package `lxml`, files are not validated.
"""

from __future__ import annotations

import math
import os
import unittest
import zipfile
from pathlib import Path

from support import Case, context, luxfer

from luxfer.design import Product

SCHEMAS = os.environ.get("LUXFER_TEST_SCHEMAS", "")

#: Sizes in an IES file: width, length and height.
OPENINGS = ("0 0 0", "0.6 1.2 0", "0.6 1.2 0.1", "-0.4 -0.4 0", "-0.4 -0.4 0.2")


def ies(size: str = "0.6 1.2 0", planes: str = "0") -> bytes:
    """A cosine emitter of 1000 cd along its axis, with a point every 5 degrees."""
    angles = range(0, 91, 5)
    row = " ".join(f"{1000 * math.cos(math.radians(a)):.6f}" for a in angles)
    count = len(planes.split())
    values = "\n".join([row] * count)
    numbers = " ".join(map(str, angles))
    return (
        f"IESNA:LM-63-2002\n[MANUFAC] Works\n[LUMINAIRE] Panel <1> & 2\nTILT=NONE\n1 -1 1 {len(angles)} {count} 1 2 "
        f"{size}\n1 1 30\n{numbers}\n{planes}\n{values}\n"
    ).encode()


class LuminaireFiles(Case):
    def convert(self, data: bytes, ending: str) -> Path:
        path = self.folder / f"lamp.{ending}"
        luxfer.Distribution.load_memory(context(), data).save(path)
        return path

    def test_every_format_keeps_the_light(self):
        for size in OPENINGS:
            for planes in ("0", "0 90 200 360"):
                data = ies(size, planes)
                lamp = luxfer.Distribution.load_memory(context(), data)
                # A cosine emitter has pi times its intensity along the axis as flux.
                self.assertLess(abs(lamp.report.flux / (1000 * math.pi) - 1), 2e-3)
                for ending in ("ies", "ldt", "xml", "gldf"):
                    path = self.convert(data, ending)
                    for other in (luxfer.Distribution.load(context(), path), luxfer.Distribution.load_memory(context(), path.read_bytes())):
                        self.assertEqual((other.name, other.report.watts), (lamp.name, 30), ending)
                        self.assertLess(abs(other.report.flux / lamp.report.flux - 1), 1e-9, ending)
                        for one, two in zip(other.report.size, lamp.report.size):
                            self.assertAlmostEqual(one, two, places=9, msg=f"{ending} {size}")
                        for c, gamma in ((0, 0), (77, 33), (190, 80), (300, 95)):
                            self.assertAlmostEqual(other.intensity(c, gamma), lamp.intensity(c, gamma), places=6)

    def test_formats_are_recognised_by_content_and_variants_by_name(self):
        path = self.convert(ies(), "gldf")
        wrong = self.folder / "lamp.ies"
        wrong.write_bytes(path.read_bytes())
        for place, variant in ((path, None), (path, 0), (path, "variant"), (path, "Panel <1> & 2"), (wrong, None), (f"{path}#0", None)):
            report = luxfer.Distribution.load(context(), place, variant).report
            self.assertEqual((report.variants, report.emitters), (1, 1))
        with self.assertRaisesRegex(luxfer.Error, 'no variant has the name, id or index "white"; there are 1: "Panel'):
            luxfer.Distribution.load(context(), path, "white")
        with self.assertRaisesRegex(luxfer.Error, "ends in none of .ies, .ldt, .xml"):
            luxfer.Distribution.load(context(), self.folder / "lamp.pdf")
        with self.assertRaisesRegex(luxfer.Error, "damaged"):
            luxfer.Distribution.load_memory(context(), path.read_bytes()[:-30], "gldf")

    def test_designs_take_all_formats(self):
        want = Product.from_bytes(context(), ies(), "ies", "lamp")
        for ending in ("ldt", "xml", "gldf"):
            product = Product.load(context(), self.convert(ies(), ending), rendering=80)
            self.assertLess(abs(product.flux / want.flux - 1), 1e-9)
            self.assertEqual((product.watts, product.rendering), (30, 80))
        self.assertEqual((product.format, product.name, product.reference), ("ldt", "Panel <1> & 2", "lamp.gldf"))
        chosen = Product.load(context(), f"{self.folder / 'lamp.gldf'}#variant")
        self.assertEqual((chosen.photometry, chosen.reference), (product.photometry, "lamp.gldf#variant"))
        # Paths that are not in their normal form.
        folder = os.fspath(self.folder)
        for path in (f"{folder}//lamp.gldf#0", f"{folder}/./lamp.gldf#0", f"{folder}//./lamp.gldf"):
            want = "lamp.gldf" + path.partition("lamp.gldf")[2]
            self.assertEqual(Product.load(context(), path).reference, want, path)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder)
        self.assertEqual(Product.load(context(), "./lamp.gldf").reference, "lamp.gldf")
        self.assertEqual(Product.load(context(), "./lamp.gldf#0").reference, "lamp.gldf#0")
        with self.assertRaises(FileNotFoundError):
            Product.load(context(), self.folder / "missing.gldf")

    @unittest.skipUnless(SCHEMAS, "LUXFER_TEST_SCHEMAS names no folder")
    def test_written_files_are_valid(self):
        try:
            from lxml import etree
        except ImportError:
            self.skipTest("lxml is not installed")
        schemas = {}
        for ending, name in (("gldf", "gldf.xsd"), ("xml", "tm33.xsd")):
            schemas[ending] = etree.XMLSchema(etree.parse(Path(SCHEMAS, name)))
        for size in OPENINGS:
            for ending, schema in schemas.items():
                path = self.convert(ies(size, "0 90 200 360"), ending)
                data = path.read_bytes()
                if ending == "gldf":
                    with zipfile.ZipFile(path) as archive:
                        self.assertIsNone(archive.testzip())
                        data = archive.read("product.xml")
                schema.assertValid(etree.fromstring(data))


if __name__ == "__main__":
    unittest.main()
