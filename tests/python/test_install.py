"""Tests that pip builds a wheel from the source tree, with the library inside, for any Python on this platform."""

import os
import shutil
import subprocess
import sys
import unittest
import zipfile
from pathlib import Path

from support import PACKAGE, ROOT, Case, in_ci

try:
    from setuptools.command.bdist_wheel import bdist_wheel  # noqa: F401
except ImportError:
    bdist_wheel = None


class Install(Case):
    def test_the_wheel(self):
        if bdist_wheel is None and not in_ci():
            self.skipTest("setuptools 70.1 or newer is not installed")
        pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet"]
        options = ["--no-deps", "--no-build-isolation"]
        subprocess.run([*pip, "wheel", *options, "--wheel-dir", self.folder, PACKAGE], check=True, stdin=subprocess.DEVNULL)
        (wheel,) = self.folder.glob("*.whl")
        self.assertRegex(wheel.name, r"^luxfer-\d+\.\d+\.\d+-py3-none-(?!any)\w+\.whl$")
        with zipfile.ZipFile(wheel) as archive:
            names = archive.namelist()
        self.assertIn("luxfer/py.typed", names)
        self.assertTrue(any(n.startswith("luxfer/libluxfer") or n == "luxfer/luxfer.dll" for n in names))
        self.assertTrue(any(n.endswith("LICENSE-MIT") for n in names))
        if sys.platform == "linux" and shutil.which("strip"):
            with zipfile.ZipFile(wheel) as archive:
                library = Path(archive.extract("luxfer/libluxfer.so", self.folder))
            sections = subprocess.run(["readelf", "-SW", library], check=True, capture_output=True, text=True).stdout
            self.assertIn(".dynsym", sections)
            for removed in (".symtab", ".debug_"):
                self.assertNotIn(removed, sections)
        page = PACKAGE / "luxfer" / "studio" / "static"
        built = {f"luxfer/studio/static/{p.relative_to(page)}" for p in page.rglob("*") if p.is_file()}
        self.assertLessEqual(built | {"luxfer/studio/app.py"}, set(names))

        target = self.folder / "site"
        subprocess.run([*pip, "install", "--no-deps", "--target", target, wheel], check=True)
        program = (
            "import luxfer, numpy; print(luxfer.__file__); print(luxfer.library._name);"
            "print(luxfer.Image(luxfer.Context(num_threads=1), numpy.ones((2, 3))).size)"
        )
        environment = {**os.environ, "PYTHONPATH": str(target)}
        environment.pop("LUXFER_LIBRARY", None)
        run = subprocess.run([sys.executable, "-c", program], cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        package, library, size = run.stdout.splitlines()
        self.assertTrue(package.startswith(str(target)) and library.startswith(str(target)), run.stdout)
        self.assertEqual(size, "(3, 2, 1)")

        # The command line that pip installs beside it.
        command = [sys.executable, target / "bin" / "luxfer", "surfaces", "demo:target-room"]
        run = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("Ceiling", run.stdout)

    def test_the_source_tree_itself(self):
        program = "import luxfer; print(luxfer.library._name)"
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE)}
        environment.pop("LUXFER_LIBRARY", None)
        out = subprocess.run([sys.executable, "-c", program], env=environment, check=True, capture_output=True, text=True)
        self.assertTrue(out.stdout.startswith(str(ROOT / "target" / "release")), out.stdout)


if __name__ == "__main__":
    unittest.main()
