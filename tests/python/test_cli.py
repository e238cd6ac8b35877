"""The command line: every subcommand from end to end, its exit codes, and that it writes only what was asked for."""

import atexit
import contextlib
import csv
import functools
import io
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import types
import unittest
from pathlib import Path
from unittest import mock

from support import PACKAGE, Case, context, demo, lit_room, luxfer, np

from luxfer.cli import files, main, program, values

SUBCOMMANDS = program.SUBCOMMANDS
#: A picture that is quickly rendered.
SMALL = ("--size", "64x36", "--error", "20%")

IES = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0.6 0.3 0\n1 1 30\n0 45 90\n0\n1000 707 0\n"


def environment():
    return {**os.environ, "LUXFER_LIBRARY": luxfer.library._name, "PYTHONPATH": str(PACKAGE), "COLUMNS": "100"}


@functools.lru_cache
def inputs() -> Path:
    """A folder with a photo, its strokes, a room without lights and a lit room."""
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder)
    photo, strokes = demo()
    photo.save(folder / "photo.png")
    strokes.save(folder / "strokes.png")
    luxfer.Scene.demo(context(), "target-room").export(folder / "room.glb")
    lit_room().export(folder / "lit.glb")
    (folder / "panel.ies").write_text(IES)
    return folder


class Cli(Case):
    def setUp(self):
        super().setUp()
        self.inputs = inputs()
        self.before = {path: path.read_bytes() for path in self.inputs.iterdir()}

    def tearDown(self):
        self.assertEqual(
            {path: path.read_bytes() for path in self.inputs.iterdir()}, self.before, "inputs were changed"
        )

    def path(self, name):
        return str(self.inputs / name)

    def call(self, *words, code=0):
        """Runs the program in the test's folder, and checks its exit code."""
        command = [sys.executable, "-m", "luxfer", *map(str, words)]
        done = subprocess.run(command, cwd=self.folder, env=environment(), capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, code, f"{words}\n{done.stdout}\n{done.stderr}")
        self.assertNotIn("Traceback", done.stderr)
        return done

    def json(self, *words, code=0):
        """What it prints with --json."""
        return json.loads(self.call(*words, "--json", code=code).stdout, parse_constant=self.fail)

    def error(self, code, *words):
        """The one line that a failure prints, in this process; nothing is written and nothing else is printed."""
        before, folder = self.written(), os.getcwd()
        out, errors = io.StringIO(), io.StringIO()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
                found = main(list(words))
        finally:
            os.chdir(folder)
        line = errors.getvalue()
        self.assertEqual((found, out.getvalue(), line.count("\n")), (code, "", 1), line)
        self.assertTrue(line.startswith("luxfer"), line)
        self.assertEqual(self.written(), before)
        return line

    def written(self):
        """All files and folders in the test's folder."""
        return {str(path.relative_to(self.folder)) for path in self.folder.rglob("*")}

    def rows(self, name):
        """The rows of a CSV file."""
        return list(csv.DictReader((self.folder / name).read_text().splitlines()))

    def pixels(self, name, **how):
        return luxfer.Image.load(context(), self.folder / name).numpy(**how)


class Help(Cli):
    def test_every_subcommand_explains_itself(self):
        listed = self.call("--help").stdout
        for name in SUBCOMMANDS:
            self.assertIn(f"    {name} ", listed)
            text = self.call(name, "--help").stdout
            self.assertIn(f"usage: luxfer {name}", text)
            if name != "studio":  # it has a command line of its own
                self.assertIn("exit codes: 0 fine", text)
                self.assertLessEqual(max(map(len, text.splitlines())), 100)
        for part in ("print", "read"):
            self.assertIn("--paper", self.call("sheet", part, "--help").stdout)
        self.assertEqual(self.written(), set())

    def test_every_option_is_described(self):
        for name, parser in program.parser()._subparsers._group_actions[0].choices.items():
            for action in parser._actions:
                self.assertTrue(action.help, f"{name} {action.dest}")

    def test_help_needs_neither_numpy_nor_the_library_and_is_quick(self):
        code = (
            "import sys\nfrom luxfer.cli import main\nassert main(['transfer', '--help']) == 0\n"
            "heavy = {'numpy', 'luxfer._library', 'luxfer._abi'} & set(sys.modules)\nassert not heavy, heavy"
        )
        subprocess.run([sys.executable, "-c", code], env=environment(), check=True, capture_output=True)

        def seconds(*words):
            began = time.perf_counter()
            subprocess.run([sys.executable, *words], env=environment(), check=True, capture_output=True)
            return time.perf_counter() - began

        # The best of a few, less what Python itself takes: other programs may run at the same time.
        own = min(seconds("-m", "luxfer", "--help") for _ in range(7)) - min(seconds("-c", "pass") for _ in range(7))
        self.assertLess(own, 0.2)

    def test_version(self):
        self.assertEqual(self.call("--version").stdout, f"luxfer {luxfer.__version__}\n")


class Transfer(Cli):
    FILES = {"masks.png", "emission.exr", "lit.glb", "luminaires.csv", "render.exr", "render.png", "report.json"}

    def transfer(self, *words, code=0, strokes=True):
        painted = ("--strokes", self.path("strokes.png")) if strokes else ()
        return self.call("transfer", self.path("photo.png"), self.path("room.glb"), *painted, *words, code=code)

    def test_from_end_to_end(self):
        done = self.transfer("--out", "new/out", "--json", *SMALL)
        self.assertEqual(self.written(), {"new", "new/out"} | {f"new/out/{name}" for name in self.FILES})
        result = json.loads(done.stdout, parse_constant=self.fail)
        self.assertEqual(json.loads((self.folder / "new/out/report.json").read_text()), result)
        self.assertEqual({Path(name).name for name in result["files"]}, self.FILES)
        self.assertEqual(result["surface"], "Ceiling")
        self.assertLessEqual(result["picture"]["error"], 0.2)
        rows = self.rows("new/out/luminaires.csv")
        self.assertEqual(len(rows), result["lamps"])
        self.assertAlmostEqual(
            sum(float(row["flux_lm"]) for row in rows), result["flux_lm"], delta=0.01 * result["flux_lm"]
        )
        # The picture shows the white of the photo as white.
        png, exr = self.pixels("new/out/render.png"), self.pixels("new/out/render.exr")
        self.assertEqual(png.shape, (36, 64, 3))
        self.assertAlmostEqual(png.mean(), np.clip(exr / 100, 0, 1).mean(), delta=0.03)
        lit = luxfer.Scene.load(context(), self.folder / "new/out/lit.glb")
        self.assertEqual(lit.mesh_name(lit.counts.meshes - 1), "Ceiling (lights)")

    def test_what_it_says(self):
        done = self.transfer("--out", ".", *SMALL)
        self.assertEqual(self.written(), self.FILES)
        self.assertIn('surface "Ceiling"', done.stdout)
        self.assertIn("wrote render.png", done.stdout)
        self.assertNotIn("%  ", done.stderr)

    def test_without_strokes_the_last_lines_say_that_masks_are_proposed(self):
        done = self.transfer("--out", "out", "--strict", *SMALL, strokes=False, code=1)
        last = done.stderr.splitlines()
        self.assertTrue(all(line.startswith("warning: ") for line in last), last)
        self.assertTrue(any("proposal" in line and "try --preview-masks" in line for line in last), last)
        self.transfer("--out", "out", *SMALL, strokes=False, code=0)

    def test_preview_of_the_masks(self):
        result = json.loads(self.transfer("--preview-masks", "masks.png", "--json").stdout)
        self.assertEqual(self.written(), {"masks.png"})
        shown = self.pixels("masks.png", dtype=np.uint8, colour_space="srgb").astype(int)
        red, green, blue = np.moveaxis(shown, 2, 0)
        lamps, plane = (red > blue + 60) & (green > blue + 60), (green > red + 20) & (green > blue + 20)
        self.assertAlmostEqual(lamps.mean(), result["lights_share"], delta=0.01)
        self.assertAlmostEqual(plane.mean(), result["plane_share"] - result["lights_share"], delta=0.02)
        place = result["next_stroke"]
        marked = shown[place["y"], place["x"]]
        self.assertEqual(tuple(marked), (255, 0, 200))

    def test_further_exposures_of_the_photo(self):
        photo = luxfer.Image.load(context(), self.path("photo.png"))
        photo.save(str(self.folder / "dark.png"), 0.25)  # darker, but clipped no less: it is no shorter exposure
        words = ("transfer", self.path("photo.png"), self.path("room.glb"), "--exposures", str(self.folder / "dark.png"))
        result = self.json(*words, "--preview-masks", "m.png")
        self.assertEqual([w["code"] for w in result["warnings"] if w["stage"] == "exposures"], [])
        # The darker picture has a quarter of the photo's values.
        self.assertEqual(len(result["bracket"]["exposures"]), 2)
        self.assertAlmostEqual(result["bracket"]["exposures"][1], 0.25, delta=0.01)
        self.error(3, *words, "missing.png", "--preview-masks", "m.png")

    def test_strokes_as_text_and_a_surface(self):
        text = "plane 6 120 40 60 40\nnot-plane 6 120 150\n"
        (self.folder / "strokes.txt").write_text(text)
        words = ("transfer", self.path("photo.png"), self.path("room.glb"), "--surface", "White plaster")
        result = self.json(*words, "--strokes", "strokes.txt", "--preview-masks", "m.png")
        self.assertEqual(result["surface"], "White plaster")
        self.assertNotIn("proposed", [w["code"] for w in result["warnings"] if w["stage"] == "plane"])
        self.assertIn("proposed", [w["code"] for w in result["warnings"] if w["stage"] == "lights"])

    def test_target_in_lux_and_colour(self):
        said = self.transfer("--out", "out", "--lux", "300", "--colour", "3000K", *SMALL).stdout
        result = json.loads((self.folder / "out/report.json").read_text())
        # Two measurements of 0.5 % each, one that set the lamps and one that found what they give.
        self.assertAlmostEqual(result["lux"], 300, delta=4 * 2**0.5 * 0.005 * 300)
        self.assertNotEqual(result["lux"], 300, "what was reached is measured, not what was asked for")
        self.assertTrue(0 < result["lux_error"] < 2, result["lux_error"])
        self.assertEqual(result["lux_target"], 300)
        self.assertRegex(said, rf"{result['lux']:.1f} ± \d\.\d lux on .*, 300 asked for")
        self.assertAlmostEqual(result["cct_k"], 3000, delta=10)
        lux = self.json("lux", "out/lit.glb")
        self.assertAlmostEqual(lux["mean_lux"], 300, delta=6)
        flux = sum(float(row["flux_lm"]) for row in self.rows("out/luminaires.csv"))
        self.assertAlmostEqual(flux, result["flux_lm"], delta=0.001 * flux)
        # The light of the lamps in the scene is that of the list.
        lit = luxfer.Scene.load(context(), self.folder / "out/lit.glb")
        material = lit.counts.materials - 1
        use = lit.material_texture(material, "emission")
        texture = lit.texture(use.texture).numpy()[:, :, :3] * np.array(lit.material(material)["emission"])
        mean = texture[texture.max(axis=2) > 0].mean(axis=0)
        self.assertAlmostEqual(luxfer.colour_temperature(context(), mean)[0], 3000, delta=60)

    def test_a_colour_keeps_the_flux(self):
        kept, known = [], 0
        for name, words in (("a", ()), ("b", ("--colour", "1,0.5,0.2"))):
            self.transfer("--out", name, *SMALL, *words)
            result = json.loads((self.folder / name / "report.json").read_text())
            kept.append(result["flux_lm"])
            known += result["strength_error"]
        # Plans measure times, so the paths of two runs differ, and their strengths within the stated error.
        self.assertAlmostEqual(kept[0], kept[1], delta=known * kept[0])

    def test_a_time_is_kept(self):
        self.transfer("--out", "out", "--time", "6s", "--size", "160x90")
        result = json.loads((self.folder / "out/report.json").read_text())
        self.assertLess(result["seconds"], 9)
        self.assertTrue(result["picture"]["filtered"])
        # On a busy machine the time is enough for too few paths to state an error.
        if result["picture"]["paths_per_pixel"] >= 4:
            self.assertGreater(result["picture"]["filter_error"], 0)

    def test_progress_only_where_it_is_asked_for(self):
        done = self.transfer("--preview-masks", "m.png", "--progress")
        self.assertRegex(done.stderr, r"finding plane and lamps: 100 % in \d+ s")
        self.assertNotIn("finding", self.transfer("--preview-masks", "m.png").stderr)

    def cancelled_by(self, number):
        """A run that is interrupted once the lamps are written."""
        words = ["transfer", self.path("photo.png"), self.path("room.glb"), "--strokes", self.path("strokes.png")]
        command = [sys.executable, "-m", "luxfer", *words, "--time", "2min", "--out", "out"]
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        # A shell's background job ignores SIGINT; a program in a terminal does not.
        restore = functools.partial(signal.signal, signal.SIGINT, signal.default_int_handler)
        with subprocess.Popen(command, cwd=self.folder, env=environment(), preexec_fn=restore, **streams) as run:
            end = time.monotonic() + 120
            while not (self.folder / "out/luminaires.csv").exists() and time.monotonic() < end and run.poll() is None:
                time.sleep(0.02)
            time.sleep(0.5)
            run.send_signal(number)
            began = time.monotonic()
            out, errors = run.communicate(timeout=60)
        self.assertLess(time.monotonic() - began, 5)
        return run.returncode, out, errors

    def test_ctrl_c_keeps_the_files_of_finished_stages(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            code, out, errors = self.cancelled_by(number)
            self.assertEqual((code, out), (4, ""), errors)
            self.assertRegex(errors, r"^luxfer transfer: cancelled; kept out/masks.png, .*luminaires.csv\n$")
            finished = {"masks.png", "emission.exr", "lit.glb", "luminaires.csv"}
            self.assertEqual(self.written(), {"out"} | {f"out/{name}" for name in finished})
            for name in finished:
                (self.folder / "out" / name).unlink()


class Render(Cli):
    def test_png_and_exr_with_layers(self):
        words = ("--out", "a.png", "--out", "a.exr", "--layers", "depth,direct=LDE")
        result = self.json("render", self.path("lit.glb"), *words, *SMALL)
        self.assertEqual(self.written(), {"a.png", "a.exr"})
        self.assertEqual((result["width"], result["height"]), (64, 36))
        self.assertLessEqual(result["error"], 0.2)
        self.assertIn(b"Depth.Z", (self.folder / "a.exr").read_bytes()[:4000])
        self.assertIn(b"direct.R", (self.folder / "a.exr").read_bytes()[:4000])

    def test_the_picture_ends_clean(self):
        """A noisy PNG is filtered and says so: its typical pixel is nearer to the truth."""
        scene, size = self.path("lit.glb"), ("--size", "160x90", "--white", "100")
        words = ("--error", "30%", "--seed", "3", *size)
        self.assertTrue(self.json("render", scene, "--out", "filtered.png", *words)["filtered"])
        self.assertFalse(self.json("render", scene, "--out", "noisy.png", "--no-filter", *words)["filtered"])
        clean = self.json("render", scene, "--out", "clean.png", "--error", "2%", *size)
        self.assertLessEqual(clean["error"], 0.02)
        self.assertFalse(clean["filtered"])
        truth = self.pixels("clean.png")
        filtered, noisy = (np.median(np.abs(self.pixels(f"{name}.png") - truth)) for name in ("filtered", "noisy"))
        self.assertLess(filtered, 0.8 * noisy)

    def test_cameras_by_position(self):
        """The place is that of the option, also where it begins with a minus sign."""
        scene = luxfer.Scene(context())
        material = scene.add_material(base_color=(0, 0, 0), emission=(100, 0, 0))
        corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
        scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], name="Lamp", material=material)
        scene.export(self.folder / "lamp.glb")
        for camera, lit in (("0,0,3/0,0,0/20", 1.0), ("-9,0,3/-9,0,0/20", 0.0)):
            words = ("--camera", camera, "--white", "100", "--error", "50%", "--size", "8x8")
            self.call("render", "lamp.glb", "--out", "a.exr", "--out", "a.png", *words)
            red = self.pixels("a.exr")[:, :, 0]
            self.assertEqual((red > 50).mean(), lit)
        self.assertIn("has no camera", self.error(2, "render", "lamp.glb", "--out", "b.png"))

    def test_a_scene_without_light(self):
        done = self.call("render", self.path("room.glb"), "--out", "a.png", "--strict", *SMALL, code=1)
        self.assertIn("the picture is black", done.stderr.splitlines()[-1])
        noisy = ("--size", "64x36", "--error", "40%")
        self.call("render", self.path("room.glb"), "--out", "a.png", "--strict", "--sky", "100", *noisy)

    def test_a_time(self):
        result = self.json("render", self.path("lit.glb"), "--out", "a.png", "--time", "3s", "--size", "64x36")
        self.assertLess(result["seconds"], 6)


class Lux(Cli):
    def test_under_an_even_sky(self):
        """Every point of an open plane gets pi times the luminance of the sky."""
        scene = luxfer.Scene(context())
        corners = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], np.float32)
        scene.add_material(name="grey")
        scene.add_mesh(corners, [[0, 2, 1], [0, 3, 2]], name="Floor")
        scene.export(self.folder / "floor.glb")
        words = ("--rect", "-1,-1,1,1", "--height", "50cm", "--sky", "100", "--spacing", "0.5")
        result = self.json("lux", "floor.glb", *words, "--csv", "a.csv", "--out", "a.png")
        self.assertEqual(self.written(), {"floor.glb", "a.csv", "a.png"})
        self.assertEqual(result["points"], 16)
        self.assertAlmostEqual(result["mean_lux"], 100 * math.pi, delta=4 * result["mean_error_lux"])
        self.assertLess(result["mean_error_lux"], 0.01 * result["mean_lux"])
        rows = self.rows("a.csv")
        self.assertEqual(len(rows), 16)
        first = [(float(row["x_m"]), float(row["y_m"])) for row in rows[:4]]
        self.assertEqual(first, [(x, 0.5) for x in (-0.75, -0.25, 0.25, 0.75)])
        self.assertAlmostEqual(np.mean([float(row["lux"]) for row in rows]), result["mean_lux"], delta=0.01)

    def test_the_plane_of_desks_and_surfaces(self):
        desks = self.json("lux", self.path("lit.glb"))
        floor = self.json("lux", self.path("lit.glb"), "--surface", "Floor")
        higher = self.json("lux", self.path("lit.glb"), "--height", "1.5")
        self.assertIn("0.75 m above the floor", desks["on"])
        self.assertGreater(desks["mean_lux"], floor["mean_lux"])
        self.assertIn("1.50 m above the floor", higher["on"])
        for result in (desks, floor, higher):
            self.assertLessEqual(result["mean_error_lux"], 0.012 * result["mean_lux"])
            self.assertLessEqual(result["minimum_lux"], result["mean_lux"])
            self.assertLessEqual(result["mean_lux"], result["maximum_lux"])

    def test_a_dark_plane_is_a_warning(self):
        done = self.call("lux", self.path("room.glb"), "--strict", code=1)
        self.assertIn("no light reaches the plane", done.stderr)


class Painting(Cli):
    def test_stylise(self):
        words = ("demo:still-life", "--size", "96x72", "--samples", "4")
        result = self.json("stylise", "demo:paint", *words, "--preset", "preview", "--out", "a.png")
        self.assertEqual(self.written(), {"a.png"})
        self.assertEqual(self.pixels("a.png").shape[:2], (result["height"], result["width"]))
        self.assertLess(result["guide_error"], 0.2)
        result = self.json(
            "stylise", "demo:pen", *words, "--time", "1s", "--guides", "edges,materials", "--out", "b.png"
        )
        self.assertEqual(self.pixels("b.png").shape, (72, 96, 3))

    def test_a_sheet_comes_back(self):
        y, x = np.mgrid[:60, :80] / 80
        luxfer.Image(context(), np.stack([x, y, 0.5 + 0 * x], 2)).save(self.folder / "picture.png")
        common = ("--paper", "a5", "--dpi", "100")
        printed = self.json("sheet", "print", "picture.png", "--contrast", "1", "--out", "sheet.png", *common)
        self.assertEqual(printed["picture"], [80, 60])
        self.assertEqual(self.pixels("sheet.png").shape[:2], (printed["height"], printed["width"]))
        found = self.json("sheet", "read", "sheet.png", "--size", "80x60", "--out", "artwork.png", *common)
        self.assertEqual(found["marks"], 10)
        difference = np.abs(self.pixels("artwork.png") - self.pixels("picture.png"))[4:-4, 4:-4]
        self.assertLess(difference.mean(), 0.02)
        self.error(5, "sheet", "read", self.path("photo.png"), "--out", "x.png")

    def test_a_sheet_of_a_scene_becomes_a_painting(self):
        common = ("--paper", "a5", "--dpi", "72", "--size", "80x60")
        self.call("sheet", "print", "demo:sphere-on-table", "--samples", "4", "--out", "sheet.png", *common)
        self.call("sheet", "read", "sheet.png", "--out", "artwork.png", *common)
        words = ("--size", "80x60", "--samples", "4", "--preset", "fast")
        self.call("stylise", "artwork.png", "demo:still-life", "--out", "painting.png", *words)
        self.assertEqual(self.written(), {"sheet.png", "artwork.png", "painting.png"})


class Questions(Cli):
    def test_inspect(self):
        scene = self.json("inspect", self.path("room.glb"))
        self.assertEqual((scene["kind"], scene["likeliest_ceiling"], scene["cameras"]), ("scene", "Ceiling", 1))
        self.assertAlmostEqual(scene["high_m"][1], 2.8, places=5)
        smaller = self.json("inspect", self.path("room.glb"), "--units", "inch")
        self.assertAlmostEqual(smaller["high_m"][1], 2.8 * 0.0254, places=5)
        self.assertEqual([w["code"] for w in smaller["warnings"]], ["implausible-size"])
        photo = self.json("inspect", self.path("photo.png"))
        self.assertEqual((photo["width"], photo["height"], photo["metadata"]["colour"]), (240, 160, "stated"))
        panel = self.json("inspect", self.path("panel.ies"))
        self.assertEqual((panel["kind"], panel["watts"], panel["intensity_down_cd"]), ("luminaire", 30, 1000))
        lamp = luxfer.Distribution.load(context(), self.path("panel.ies"))
        for name in ("panel.xml", "panel.gldf"):
            lamp.save(self.folder / name)
            found = self.json("inspect", str(self.folder / name))
            self.assertEqual((found["watts"], found["variants"], found["emitters"]), (30, 1, 1), name)
            self.assertAlmostEqual(found["intensity_down_cd"], 1000, places=9)
            (self.folder / name).unlink()
        for name in ("room.glb", "photo.png", "panel.ies", "lit.glb"):
            self.assertGreater(len(self.call("inspect", self.path(name)).stdout), 60)
        self.assertEqual(self.written(), set())

    def test_surfaces(self):
        result = self.json("surfaces", self.path("room.glb"), "--count", "2")
        self.assertEqual([s["name"] for s in result["surfaces"]], ["Ceiling", "White plaster"])
        text = self.call("surfaces", self.path("room.glb"), "--count", "2").stdout
        self.assertIn(f"and {result['count'] - 2} more", text)

    def test_plan(self):
        table = self.json("plan", self.path("lit.glb"), "--size", "64x36")["plans"]
        self.assertEqual(len(table), 4)
        self.assertEqual([p["error"] for p in table], sorted((p["error"] for p in table), reverse=True))
        self.assertEqual([p["seconds"] for p in table], sorted(p["seconds"] for p in table))
        (one,) = self.json("plan", self.path("lit.glb"), "--size", "64x36", "--time", "20s")["plans"]
        self.assertLess(one["error"], table[0]["error"])
        words = ("--photo", self.path("photo.png"), "--strokes", self.path("strokes.png"), "--error", "10%")
        (one,) = self.json("plan", self.path("room.glb"), "--size", "64x36", *words)["plans"]
        self.assertGreater(one["relight_seconds"], 0)
        self.assertEqual(self.written(), set())


class Failures(Cli):
    def test_wrong_command_lines_name_option_value_and_what_is_allowed(self):
        room, photo = self.path("room.glb"), self.path("photo.png")
        for words, parts in (
            ((), ("SUBCOMMAND",)),
            (("trasnfer",), ("trasnfer", "transfer")),
            (("render", room), ("--out",)),
            (("render", room, "--out", "a.jpg"), ("--out", "a.jpg", ".png", ".exr")),
            (("render", room, "--out", "no/a.png"), ("--out", "no")),
            (("render", room, "--out", "a.png", "--size", "640"), ("--size", "640", "WIDTHxHEIGHT")),
            (("render", room, "--out", "a.png", "--size", "0x9"), ("--size", "0x9", "65536")),
            (("render", room, "--out", "a.png", "--error", "200%"), ("--error", "200%", "100%")),
            (("render", room, "--out", "a.png", "--time", "soon"), ("--time", "soon", "30s")),
            (("render", room, "--out", "a.png", "--time", "9s", "--error", "1%"), ("--error", "--time")),
            (("render", room, "--out", "a.png", "--quality", "nice"), ("--quality", "nice", "draft", "best")),
            (("render", room, "--out", "a.png", "--camera", "7"), ("--camera", "7", "1")),
            (("render", room, "--out", "a.png", "--camera", "1,2/3,4"), ("--camera", "1,2/3,4", "POSITION")),
            (("render", room, "--out", "a.png", "--layers", "depth"), ("--layers", ".exr")),
            (("render", room, "--out", "a.png", "--layers", "dept"), ("--layers", "dept", "depth")),
            (("render", room, "--sise", "9x9", "--out", "a.png"), ("--sise", "--size")),
            (("render", room, "--units", "furlong"), ("--units", "furlong", "mm")),
            (("render", "demo:nothing", "--out", "a.png"), ("demo:nothing", "demo:target-room")),
            (("transfer", photo, room), ("--out", "--preview-masks")),
            (("transfer", photo, room, "--out", "o", "--preview-masks", "m.png"), ("--preview-masks", "--out")),
            (("transfer", photo, room, "--out", photo), ("--out", photo, "not a folder")),
            (("transfer", photo, room, "--out", "o", "--surface", "Celing"), ("--surface", "Celing", "Ceiling")),
            (("transfer", photo, room, "--out", "o", "--lux", "-5"), ("--lux", "-5", "0.1")),
            (("transfer", photo, room, "--out", "o", "--colour", "blue"), ("--colour", "blue", "1000K")),
            (("transfer", photo, room, "--out", "o", "--colour", "500K"), ("--colour", "500K", "20000K")),
            (("transfer", photo, room, "--preview-masks", photo), ("--preview-masks", "overwritten")),
            (("lux", room, "--rect", "0,0,1,1"), ("--rect", "--height")),
            (("lux", room, "--rect", "1,0,0,1", "--height", "1"), ("--rect", "1,0,0,1", "X0 < X1")),
            (("lux", room, "--surface", "Celing"), ("--surface", "Celing", "Ceiling")),
            (("stylise", "demo:oil", "demo:still-life", "--out", "a.png"), ("demo:oil", "demo:paint")),
            (("sheet", "print", room, "--out", "a.png", "--paper", "a9"), ("--paper", "a9", "a4")),
            (("plan", room, "--strokes", "s.png"), ("--strokes", "--photo")),
        ):
            with self.subTest(words):
                line = self.error(2, *words)
                for part in parts:
                    self.assertIn(part, line)

    def test_input_that_cannot_be_read(self):
        (self.folder / "broken.glb").write_bytes(b"glTF\2\0\0\0")
        (self.folder / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\n")
        (self.folder / "broken.ies").write_text("no luminaire")
        (self.folder / "broken.txt").write_text("plane six 1 1")
        room, photo = self.path("room.glb"), self.path("photo.png")
        for words, name in (
            (("render", "missing.glb", "--out", "a.png"), "missing.glb"),
            (("render", "broken.glb", "--out", "a.png"), "broken.glb"),
            (("transfer", "broken.png", room, "--out", "o"), "broken.png"),
            (("transfer", photo, "missing.glb", "--out", "o"), "missing.glb"),
            (("transfer", photo, room, "--out", "o", "--strokes", "broken.txt"), "broken.txt"),
            (("transfer", photo, room, "--out", "o", "--strokes", "missing.txt"), "missing.txt"),
            (("inspect", "broken.ies"), "broken.ies"),
            (("inspect", "missing.png"), "missing.png"),
            (("surfaces", str(self.folder)), str(self.folder)),
            (("stylise", "missing.png", "demo:still-life", "--out", "a.png"), "missing.png"),
            (("sheet", "read", "broken.png", "--out", "a.png"), "broken.png"),
        ):
            with self.subTest(words):
                self.assertEqual(self.error(3, *words).count(name), 1)

    def test_with_json_a_failure_is_an_object(self):
        for code, words in ((2, ("render", "a.glb")), (3, ("surfaces", "missing.glb"))):
            result = self.json(*words, code=code)
            self.assertEqual((result["error"]["exit"], result["files"]), (code, []))

    def test_where_nothing_can_be_written(self):
        if os.geteuid() == 0:
            self.skipTest("root may write anywhere")
        closed = self.folder / "closed"
        closed.mkdir(0o500)
        self.error(5, "render", self.path("lit.glb"), "--out", "closed/a.png", *SMALL)
        self.error(5, "transfer", self.path("photo.png"), self.path("room.glb"), "--out", "closed/new")

    def test_a_reader_that_has_seen_enough(self):
        command = f"{sys.executable} -m luxfer surfaces {self.path('room.glb')} --count 1000000 | head -1"
        done = subprocess.run(
            ["bash", "-o", "pipefail", "-c", command], env=environment(), capture_output=True, text=True
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_missing_numpy_is_one_line(self):
        code = (
            "import sys\nsys.modules['numpy'] = None\nfrom luxfer.cli import main\n"
            "sys.exit(main(['surfaces', 'demo:target-room']))"
        )
        done = subprocess.run([sys.executable, "-c", code], env=environment(), capture_output=True, text=True)
        self.assertEqual(done.returncode, 5)
        self.assertRegex(done.stderr, r"^luxfer surfaces: numpy is not installed: pip install numpy[^\n]*\n$")


class InProcess(Cli):
    def test_main_can_be_called_again_and_again(self):
        words = ["transfer", "demo:photo", "demo:target-room", "--strokes", "demo:strokes", "--preview-masks"]
        small = mock.patch.dict(files.DEMO_PHOTO, width=300, height=200, samples=8)
        with small, contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual([main([*words, str(self.folder / name)]) for name in ("a.png", "b.png")], [0, 0])
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())


class Design(Cli):
    """Lighting design from end to end."""

    def words(self, *more, task=("--task-on", "Table"), scene="demo:target-room"):
        lamp = ("--product", self.path("panel.ies"), "--watts", "10", "--rendering", "80", "--lamps", "3x2")
        return ("design", scene, "--place", "corridors", *lamp, *task, "--maintenance", "0.8", *more)

    def test_a_dark_room_fails_and_its_reports_are_written(self):
        outs = ("--out", "a.html", "--out", "a.json")
        result = self.json(*self.words(*outs, "--dimmer", "0.01"), code=6)
        self.assertEqual(self.written(), {"a.html", "a.json"})
        self.assertEqual((result["passes"], result["files"]), (False, ["a.html", "a.json"]))
        self.assertIn("requirements fail", result["verdict"])
        mean = next(f for f in result["findings"] if (f["quantity"], f["area"]) == ("mean", "Table"))
        self.assertEqual((mean["at_least"], mean["outcome"]), (100, "fails"))
        self.assertTrue(mean["low"] <= mean["value"] <= mean["high"] < 100)
        self.assertTrue((self.folder / "a.html").read_text().rstrip().endswith("</html>"))
        self.assertEqual(json.loads((self.folder / "a.json").read_text())["form"], 2)

    def test_it_says_what_it_found(self):
        done = self.call(*self.words("--dimmer", "0.01"), code=6)
        self.assertIn("mean of Table at least 100 lx:", done.stdout)
        self.assertIn("requirements fail", done.stdout.splitlines()[-1])
        self.assertIn("34.2", self.call("design", "--places").stdout)

    def test_wrong_words_and_files(self):
        (self.folder / "broken.glb").write_bytes(b"glTF\2\0\0\0")
        (self.folder / "broken.ies").write_text("no luminaire")
        for code, words, parts in (
            (2, self.words(task=()), ("--task", "--task-on")),
            (2, self.words(task=("--task", "1,2,3")), ("--task", "1,2,3", "HEIGHT")),
            (2, self.words("--task-on", "Desk"), ("Desk",)),
            (2, self.words("--lamps", "many"), ("--lamps", "many", "4x3")),
            (2, self.words("--place", "theatre"), ("theatre", "34.2")),
            (2, self.words("--maintenance", "2"), ("maintenance", "2")),
            (2, self.words("--out", "report.txt"), ("--out", "report.txt", ".html")),
            (2, self.words("--out", "no/report.html"), ("--out", "no")),
            (2, self.words(scene="demo:nothing"), ("demo:nothing", "demo:target-room")),
            (2, self.words("--taks", "1"), ("--taks", "--task")),
            (2, ("design", "demo:target-room"), ("--place", "missing")),
            (3, self.words(scene="missing.glb"), ("missing.glb",)),
            (3, self.words(scene="broken.glb"), ("broken.glb",)),
            (3, self.words("--product", "broken.ies"), ("broken.ies",)),
            (3, self.words("--product", "missing.ies"), ("missing.ies",)),
        ):
            with self.subTest(words):
                line = self.error(code, *words)
                for part in parts:
                    self.assertIn(part, line)
        result = self.json(*self.words(task=()), code=2)
        self.assertEqual((result["error"]["exit"], result["files"]), (2, []))

    def test_a_report_that_cannot_be_finished_leaves_the_old_one(self):
        from luxfer.design import report

        old = self.folder / "report.html"
        old.write_text("the last one")
        with mock.patch.object(Path, "replace", side_effect=OSError(28, "No space left on device")):
            with self.assertRaises(OSError):
                report._whole(old, b"new")
        self.assertEqual((old.read_text(), self.written()), ("the last one", {"report.html"}))


class Studio(Case):
    def test_words_are_handed_on(self):
        seen = []
        studio = types.ModuleType("luxfer.studio")
        studio.main = lambda argv: seen.append(argv) or 3
        with mock.patch.dict(sys.modules, {"luxfer.studio": studio}):
            self.assertEqual(main(["studio", "photo.png", "--port", "0"]), 3)
            self.assertEqual(main(["studio", "--help"]), 3)
        self.assertEqual(seen, [["photo.png", "--port", "0"], ["--help"]])

    def test_its_exit_codes_are_those_of_the_table(self):
        with mock.patch.dict(sys.modules, {"uvicorn": None}), contextlib.redirect_stderr(io.StringIO()) as said:
            sys.modules.pop("luxfer.studio.app", None)
            self.assertEqual(main(["studio", "missing.png"]), 5)
        self.assertIn("pip install 'luxfer[studio]'", said.getvalue())
        try:
            from luxfer.studio import app
        except ImportError:
            self.skipTest("the packages of the studio are not installed")
        page = self.folder / "page"
        for code in (5, 3):  # without a page, and with one
            with mock.patch.object(app, "STATIC", page), contextlib.redirect_stderr(io.StringIO()) as said:
                words = ["studio", str(self.folder / "missing.png"), "--no-browser", "--state", str(self.folder / "s")]
                self.assertEqual(main(words), code, said.getvalue())
            page.mkdir(exist_ok=True)
            (page / "index.html").write_text("")
        self.assertIn("missing.png", said.getvalue())


class Values(unittest.TestCase):
    def test_times_errors_lengths_and_colours(self):
        for text, seconds in (
            ("30", 30),
            ("30s", 30),
            ("1.5min", 90),
            ("2m", 120),
            ("1h", 3600),
            ("1:30", 90),
            ("500ms", 0.5),
        ):
            self.assertEqual(values.seconds(text), seconds)
        self.assertEqual([values.share(t) for t in ("2%", "0.02", "100%")], [0.02, 0.02, 1])
        for text, metres in (("0.75", 0.75), ("75cm", 0.75), ("30inch", 0.762), ("-1m", -1)):
            self.assertAlmostEqual(values.length(text), metres)
        self.assertEqual(values.colour("4000K"), 4000)
        self.assertEqual(values.colour("#ffffff"), (1, 1, 1))
        self.assertAlmostEqual(values.colour("#808080")[0], 0.2158605, places=6)
        self.assertEqual(values.size("640x360"), (640, 360))
        for parse, wrong in (
            (values.seconds, ("0", "-3s", "1e9", "nan", "25h", "1..5s")),
            (values.share, ("0", "-1%", "nan", "two", "101%")),
            (values.length, ("", "one", "1km", "1e9", "..")),
            (values.colour, ("0,0,0", "-1,1,1", "1,1", "#12345", "nan,1,1")),
            (values.size, ("640", "70000x1", "-1x5", "6.4x3")),
            (values.camera, ("-1", "0,0,0/0,0,0", "0,0,0", "0,0,0/1,0,0/0", "a,b,c/d,e,f")),
        ):
            for text in wrong:
                with self.assertRaises(program.argparse.ArgumentTypeError, msg=text):
                    parse(text)


if __name__ == "__main__":
    unittest.main()
