"""The programs that the studio writes: run without the studio, they give its room, schedule and picture to the bit.
Runs where benches/peers/install.sh has installed `studio`; the programs in C and C++ need compilers."""

import csv
import io
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from support import context, luxfer, np
from support_studio import StudioCase, inner_grid

from luxfer import _abi
from luxfer._library import library
from luxfer.studio import layout, program, program_c, program_cpp, project

ROOT = Path(__file__).resolve().parents[2]
CC, CXX = shutil.which("cc"), shutil.which("c++")
STRICT = ["-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-I", str(ROOT / "include")]
STRICT_CXX = ["-std=c++17", "-pedantic", "-Wconversion", "-Wno-float-conversion", "-Wshadow", *STRICT, "-I", str(ROOT / "bindings" / "cpp")]


class Programs(StudioCase):
    """Programs of projects."""

    def run_in(self, name, command):
        """Runs a program in a folder of its own and returns the folder."""
        place = self.folder / name
        place.mkdir()
        # Where the library has not been installed, there may be no file of its SONAME.
        (place / f"libluxfer.so.{_abi.LUXFER_VERSION_MAJOR}.{_abi.LUXFER_VERSION_MINOR}").symlink_to(library._name)
        paths = {"PYTHONPATH": str(ROOT / "bindings" / "python"), "LD_LIBRARY_PATH": str(place)}
        command = [*command, self.folder / "office.png"]
        environment = {**os.environ, **paths}
        ended = subprocess.run(command, cwd=place, env=environment, timeout=120, text=True, capture_output=True)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return place

    def compile(self, source, *options):
        """Compiles a C program, and checks that it is C++ too."""
        subprocess.run([CC, "-std=c11", "-pedantic", *STRICT, source, *options], check=True, timeout=120)
        if CXX:
            subprocess.run([CXX, "-x", "c++", "-std=c++17", "-fsyntax-only", *STRICT, source], check=True, timeout=120)

    def compile_cpp(self, source, *options):
        subprocess.run([CXX, *STRICT_CXX, source, *options], check=True, timeout=120)

    def check(self, place, studio):
        """Compares what a program has written with the files of the studio."""
        self.assertEqual((place / "lit.glb").read_bytes(), studio["glb"])
        pixels = luxfer.Image.load(context(), place / "render.exr").numpy()
        self.assertTrue(np.array_equal(pixels, studio["pixels"]), float(np.abs(pixels - studio["pixels"]).max()))
        rows, wanted = (
            list(csv.DictReader(io.StringIO(text))) for text in ((place / "luminaires.csv").read_text(), studio["csv"])
        )
        self.assertEqual(len(rows), len(wanted))
        for row, other in zip(rows, wanted):
            self.assertEqual(list(row), list(other))
            for name, value in other.items():
                if name == "surface":
                    self.assertEqual(row[name], value)
                    continue
                self.assertLess(abs(float(row[name]) - float(value)), 1e-5 * abs(float(value)) + 1e-6, name)

    def test_they_repeat_the_studio(self):
        strokes, seen = self.strokes(), {}
        on_lamp = strokes[2]["points"][:2]
        self.edit(lambda header: seen.update({header["type"]: header}), strokes=strokes, until="view")
        grid = inner_grid(seen["view"])
        grid[0] += 1.5
        wide = max(seen["shapes"]["list"], key=lambda lamp: lamp["at"][0])
        after = np.reshape(wide["corners"], (4, 2))
        after = (1.25 * (after - after.mean(0)) + after.mean(0) + (-3.0, 2.0)).ravel().tolist()
        twice = {"at": wide["at"], "before": wide["corners"], "after": after}
        self.edit(
            strokes=strokes,
            removed=[on_lamp],
            reshaped=[twice, {**twice, "at": [1.0, 1.0]}],  # there is no lamp in the corner
            grid=grid,
            zones=[[0.0, 0.0, 1.0, 1.5]],
            pattern={**self.project["pattern"], "offset": [0.25, 0.1], "rotation": 0.1},
            mix={"1": 0.375},
            added=[[1, 3.0, 2.0], [99, 1.0, 1.0]],  # there is no kind 99
            surface="Ceiling",
            others=[
                {
                    "surface": "Back wall",
                    "pattern": {**self.project["pattern"], "scale": "lamp", "length": 0.4, "rotation": 0.3},
                    "zones": [[0.5, 0.5, 1.0, 1.5]],
                    "mix": {"0": 0.5},
                    "added": [[1, 1.0, 1.0]],
                },
                {"surface": "Left wall", "pattern": self.project["pattern"], "zones": [], "mix": {}, "added": []},
            ],
            white=150.0,
            camera={"position": [1.0, 1.5, 0.5], "target": [0.0, 1.25, 0.0], "fov_y": 1.1},
        )
        light = self.session.light
        taken = [mask.numpy()[..., 0] > 0.5 for mask in (light.shot.lights, light.transfer.image("lights-mask"))]
        self.assertEqual([bool(mask[int(on_lamp[1]), int(on_lamp[0])]) for mask in taken], [True, False])
        picture = self.session.out("exr", self.folder)
        studio = {
            "glb": self.out("glb"),
            "csv": self.out("csv").decode(),
            "pixels": luxfer.Image.load(context(), picture).numpy(),
        }
        with self.subTest("Python"):
            script = self.session.out("program", self.folder)
            self.check(self.run_in("python", [sys.executable, script]), studio)
        with self.subTest("C"):
            if CC is None:
                self.skipTest("there is no C compiler")
            compiled = self.folder / "program"
            self.compile(self.session.out("program-c", self.folder), library._name, "-lm", "-o", compiled)
            self.check(self.run_in("c", [compiled]), studio)
        with self.subTest("C++"):
            if CXX is None:
                self.skipTest("there is no C++ compiler")
            compiled = self.folder / "program_cpp"
            self.compile_cpp(self.session.out("program-cpp", self.folder), library._name, "-o", compiled)
            self.check(self.run_in("cpp", [compiled]), studio)

    @unittest.skipUnless(CC and CXX, "there is no compiler")
    def test_a_program_has_only_the_parts_that_it_needs(self):
        camera = {"position": (0, 1, 2), "target": (0, 1, 0), "fov_y": 1.0}
        names = "B\u00fcro.png", "it's \"here\"??/.png", "back\\slash.png", "turned.png"
        square = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]
        reshaped = [{"at": [0.5, 0.5], "before": square, "after": square}]
        all_changes = {}, {"removed": [[1.0, 2.0]]}, {"mix": {"1": 0.5}}, {"reshaped": reshaped}
        for name, changes in zip(names, all_changes):
            named = {"name": name, "sha256": "0" * 64}
            whole = project.checked({"luxfer_studio": 1, "photo": named, "room": named, **changes})
            for language, compile, mark in ((program_c, self.compile, "/* ["), (program_cpp, self.compile_cpp, "// [")):
                text = language.program(whole, program.Chosen((72, 48), layout.layouts(whole, name), camera, 0.01))
                self.assertEqual("take_out" in text, "removed" in changes)
                self.assertEqual("reshape_lamps" in text, "reshaped" in changes)
                self.assertEqual("mix_lamps" in text, "mix" in changes)
                self.assertNotIn(mark, text)
                source = self.folder / f"small{language.SOURCE.suffix}"
                source.write_text(text, encoding="utf-8")
                compile(source, "-fsyntax-only")


if __name__ == "__main__":
    unittest.main()
