"""A design recomputed by Radiance from the exported files; skipped without pyradiance."""

import argparse
import contextlib
import importlib.util
import io
import json
import math
import unittest
from dataclasses import replace
from unittest import mock

from support import Case, context, np
from test_design import HEIGHT, at_least, at_most, box, panel, project

from luxfer import design
from luxfer.cli.design import _recomputed
from luxfer.cli.exits import Failure
from luxfer.design import areas, radiance
from luxfer.design.measure import measure
from luxfer.design.reflectance import reflectance

#: Settings of rtrace for direct light alone, and for few reflections in a small room.
DIRECT = tuple("-ab 0 -ds 0.02 -dj 0 -dc 1 -dt 0".split())
ROUGH = tuple("-ab 20 -aa 0 -ad 128 -as 0 -lr -20 -lw 4e-3 -ds 0.1 -dj 0 -dc 1 -dt 0".split())
HAS_RADIANCE = importlib.util.find_spec("pyradiance") is not None


def lopsided() -> design.Product:
    """A luminaire of 0.4 by 0.2 m whose intensity is a cosine with a lobe around C = 90."""
    gammas, planes = range(0, 181, 5), range(0, 361, 10)
    light = lambda c, g: (
        max(0.0, math.cos(math.radians(g))) * (1 + math.sin(math.radians(g)) * math.sin(math.radians(c)))
    )  # noqa: E731
    rows = [" ".join(f"{900 * light(c, g):.6g}" for g in gammas) for c in planes]
    text = (
        f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {len(gammas)} {len(planes)} 1 2 0.2 0.4 0\n1 1 30\n"
        f"{' '.join(map(str, gammas))}\n{' '.join(map(str, planes))}\n" + "\n".join(rows) + "\n"
    )
    return design.Product.from_bytes(context(), text.encode(), "ies", "wall washer", rendering=80)


class Exported(Case):
    def test_the_files_hold_the_design(self):
        lit = project(0.5, 2, 16)
        lit = replace(
            lit, luminaires=design.dimmed(lit.luminaires, (1, 0.25)), areas=(*lit.areas, areas.cylindrical(lit.room))
        )
        folder = radiance.export(lit, self.folder / "out")
        listed = json.loads((folder / "index.json").read_text())
        self.assertEqual(
            [lamp["factor"] / listed["luminaires"][0]["factor"] for lamp in listed["luminaires"]], [1, 0.25]
        )
        self.assertEqual((folder / listed["luminaires"][0]["photometry"]).read_bytes(), panel().photometry)
        self.assertEqual(list(listed["areas"]), ["desk", "faces", "faces-up"])
        points = np.loadtxt(folder / listed["areas"]["desk"])
        self.assertEqual(points.shape, (lit.areas[0].count, 6))
        np.testing.assert_allclose(points[:, [2, 5]], [[0.75, 1.0]] * len(points))
        room = (folder / "room.rad").read_text()
        self.assertEqual(room.count("polygon"), lit.room.scene.counts.triangles)
        self.assertIn("void plastic m0 0 0 5 0.5 0.5 0.5 0 0", room)

    def test_what_is_left_out_is_named(self):
        scene = box()
        scene.add_material(emission=(5, 5, 5))
        scene.add_material(metallic=1, roughness=0)
        lit = replace(project(samples=16), room=design.Room.find(scene))
        notes = json.loads((radiance.export(lit, self.folder) / "index.json").read_text())["notes"]
        self.assertEqual([n.split(" ", 2)[0] for n in notes], ["light", "material"])

    def test_reflectances(self):
        """Matte paint keeps its colour. Of diffuse light Schlick's formula reflects f0 + (1 - f0) / 21."""
        scene = box(0.5)
        smooth = scene.add_material(base_color=(0, 0, 0), roughness=0)
        mirror = scene.add_material(base_color=(0.9, 0.9, 0.9), metallic=1, roughness=0)
        np.testing.assert_allclose(reflectance(scene, 0), 0.5, atol=1e-6)
        np.testing.assert_allclose(reflectance(scene, smooth), 0.04 + 0.96 / 21, atol=1e-3)
        np.testing.assert_allclose(reflectance(scene, mirror), 0.9 + 0.1 / 21, atol=1e-3)
        picture = np.zeros((2, 2, 3), np.float32)
        picture[0] = 0.8
        half = scene.add_material(base_color=(1, 1, 1), ior=1)
        scene.set_material_texture(half, "base-color", scene.add_texture(picture))
        np.testing.assert_allclose(reflectance(scene, half), 0.4, atol=1e-6)

    def test_a_verdict_is_confirmed_only_if_both_agree(self):
        finding = design.Finding(at_least("mean", 100), 105, 102, 108, 0.99, "passes", 64)
        self.assertTrue(radiance.Second(finding, 101).confirms)
        self.assertFalse(radiance.Second(finding, 99).confirms)
        self.assertIn("passes by luxfer, fails by Radiance", str(radiance.Second(finding, 99)))
        self.assertTrue(radiance.Second(replace(finding, outcome="fails"), 99).confirms)
        self.assertFalse(radiance.Second(replace(finding, outcome="undecided"), 101).confirms)

    def test_the_report_shows_both(self):
        lit = project(samples=16).requiring(at_least("mean", 1), at_least("uniformity", 0.1))
        found = lit.check()
        second = [radiance.Second(found.findings[0], 123.0), radiance.Second(found.findings[1], 0.09)]
        page = design.save(lit, self.folder / "report.html", found, images={}, second=second).read_text()
        section = page[page.index("Recomputed by Radiance") : page.index("To make this report again")]
        for words in ("123 lx", "0.09", '<td class="good"><b>confirmed', '<td class="bad"><b>not confirmed'):
            self.assertIn(words, section)
        self.assertNotIn("Recomputed", design.save(lit, self.folder / "a.html", found, images={}).read_text())

    def test_the_command_line_asks_radiance(self):
        box().export(self.folder / "box.glb")
        (self.folder / "lamp.ies").write_bytes(panel().photometry)
        words = [str(self.folder / "box.glb"), "--place", "corridors", "--product", str(self.folder / "lamp.ies")]
        words += ["--lamps", "2x1", "--maintenance", "0.8", "--task", "1.2,1,2.8,2,0", "--json"]
        words += ["--radiance", str(self.folder / "out")]

        def recomputed(lit, checked, folder):
            return [radiance.Second(checked.findings[0], 0.5)]

        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
            with mock.patch.object(radiance, "recompute", side_effect=recomputed):
                self.assertEqual(design.main(words), 6)
        found = json.loads(out.getvalue())["radiance"]
        self.assertEqual(found, [{"requirement": "mean of task 1 at least 100 lx", "value": 0.5, "confirmed": False}])
        with mock.patch.object(radiance, "recompute", side_effect=ImportError("rtrace was not found")):
            with self.assertRaisesRegex(Failure, "--radiance: rtrace was not found"):
                words = argparse.Namespace(radiance=str(self.folder / "out"))
                _recomputed(project(samples=16), project(samples=16).check(), words)
        self.assertTrue((self.folder / "out" / "room.rad").exists())

    def test_files_of_another_design_are_refused(self):
        lit = project(samples=16).requiring(at_least("mean", 1))
        radiance.export(replace(lit, luminaires=lit.luminaires[:1]), self.folder)
        with self.assertRaisesRegex(ValueError, "those of another design"):
            radiance.recompute(lit, lit.check(), self.folder)

    def test_a_missing_program_is_named(self):
        lit = project(samples=16).requiring(at_least("mean", 1))
        radiance.export(lit, self.folder)
        with mock.patch.object(importlib.util, "find_spec", return_value=None):
            with mock.patch.object(radiance.shutil, "which", return_value=None):
                with self.assertRaisesRegex(ImportError, r"ies2rad was not found: pip install 'luxfer\[radiance\]'"):
                    radiance.recompute(lit, lit.check(), self.folder)


@unittest.skipUnless(HAS_RADIANCE, "pyradiance is not installed")
class Recomputed(Case):
    def test_luminaires_shine_the_same_way(self):
        """Direct light of an uneven luminaire, turned about all axes."""
        base = project(0.0, 1, 16)
        centre, slant = (2.0, HEIGHT - 0.3, 1.5), math.sqrt(0.5)
        for axis, c0 in (
            ((0, -1, 0), (1, 0, 0)),
            ((0, -1, 0), (0, 0, 1)),
            ((0.3, -1, 0.2), (0.6, 0, -0.8)),
            ((slant, -slant, 0), (slant, slant, 0)),
        ):
            lamp = design.Luminaire(lopsided(), centre, 0.7, axis, c0)
            lit = replace(base, luminaires=[lamp])
            radiance.export(lit, self.folder)
            radiance._compile(self.folder, json.loads((self.folder / "index.json").read_text()))
            theirs = radiance._traced(self.folder / "area1.pts", DIRECT)
            ours = measure(lit.lit(), lit.areas[0], 4096).values
            np.testing.assert_allclose(theirs, ours, rtol=0.01, atol=0.003 * ours.max(), err_msg=f"{axis} {c0}")

    def test_a_room_with_reflections(self):
        lit = project(0.6, 2, 256)
        lamps = [replace(lit.luminaires[0], colour=(1, 0.8, 0.5)), lit.luminaires[1]]
        desk = areas.task(lit.room, "desk", (1.2, 1.0, 2.8, 2.0), 0.75)
        lit = replace(lit, luminaires=lamps, areas=(desk, areas.cylindrical(lit.room, border=1.2)))
        lit = lit.requiring(
            at_least("mean", 100),
            at_least("uniformity", 0.5),
            at_most("modelling", 0.9, "faces"),
            at_most("density", 9),
        )
        found = lit.check()
        radiance.export(lit, self.folder)
        second = radiance.recompute(lit, found, self.folder, ROUGH)
        compiled = self.folder / radiance.OCTREE
        made = compiled.stat().st_mtime_ns
        again = radiance.recompute(lit, replace(found, findings=found.findings[:1]), self.folder, DIRECT)
        self.assertEqual(made, compiled.stat().st_mtime_ns, "an exported design is compiled once")
        self.assertLess(again[0].value, second[0].value, "direct light alone")
        radiance.export(lit, self.folder)
        self.assertFalse(compiled.exists(), "files that are written anew must be compiled anew")
        self.assertEqual([s.finding.requirement.quantity for s in second], ["mean", "uniformity", "modelling"])
        self.assertTrue(all(s.confirms for s in second), "\n".join(map(str, second)))
        for s, tolerance in zip(second, (0.015, 0.03, 0.03)):
            self.assertLess(abs(s.difference), tolerance, str(s))

    def test_a_broken_file_is_explained(self):
        lit = project(samples=16).requiring(at_least("mean", 1))
        radiance.export(lit, self.folder)
        (self.folder / "room.rad").write_text("void plastic m0 0 0 5 0.5\n")
        with self.assertRaisesRegex(RuntimeError, "Radiance's oconv failed"):
            radiance.recompute(lit, lit.check(), self.folder, DIRECT)


if __name__ == "__main__":
    unittest.main()
