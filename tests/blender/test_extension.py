"""Tests the extension as users get it: builds it, installs its .zip into a fresh Blender profile, and uses it."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

PROGRAM = """
import sys
import bpy
assert bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True) == {"FINISHED"}
import luxfer
assert bpy.utils.user_resource("EXTENSIONS") in luxfer.library._name, luxfer.library._name
bpy.context.scene.luxfer.exemplar_width, bpy.context.scene.luxfer.exemplar_height = 64, 48
bpy.ops.luxfer.exemplar()
print("size", *bpy.data.images["Luxfer exemplar"].size)
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.luxfer_lighting")
assert not hasattr(bpy.types.Scene, "luxfer")
"""


class Extension(unittest.TestCase):
    def test_the_zip_installs_and_works(self):
        builder = ROOT / "target" / "peers" / "python" / "bin" / "python"
        with tempfile.TemporaryDirectory() as folder:
            build = [builder if builder.exists() else sys.executable, ROOT / "bindings" / "blender" / "build.py", folder]
            made = subprocess.run(build, check=True, capture_output=True, text=True).stdout.strip()
            environment = {**os.environ, "BLENDER_USER_RESOURCES": folder + "/user"}
            for name in ("PYTHONPATH", "LUXFER_LIBRARY"):
                environment.pop(name, None)
            run = subprocess.run(
                [sys.executable, "-c", PROGRAM, made], cwd=folder, env=environment, capture_output=True, text=True
            )
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            self.assertIn("size 64 48", run.stdout)


if __name__ == "__main__":
    unittest.main()
