"""Tests that pip builds a wheel from the source tree, with the library inside, for any Python on this platform."""

import os
import subprocess
import sys
import unittest
import zipfile

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

    def test_the_source_tree_itself(self):
        program = "import luxfer; print(luxfer.library._name)"
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE)}
        environment.pop("LUXFER_LIBRARY", None)
        out = subprocess.run([sys.executable, "-c", program], env=environment, check=True, capture_output=True, text=True)
        self.assertTrue(out.stdout.startswith(str(ROOT / "target" / "release")), out.stdout)


if __name__ == "__main__":
    unittest.main()
