"""Packs the library into the wheel, which therefore fits one platform and any Python; builds the library if it is
missing.

The version and the licences come from the library's source tree, which contains this folder. LUXFER_WHEEL_LIBRARY names
a library without debug symbols, of any platform, to be packed instead (bindings/dist); the option --plat-name of
bdist_wheel then names the platform.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
GIVEN = os.environ.get("LUXFER_WHEEL_LIBRARY")
NAME = {"darwin": "libluxfer.dylib", "win32": "luxfer.dll"}.get(sys.platform, "libluxfer.so")
if GIVEN:
    NAME = re.sub(r"\.so\..*", ".so", Path(GIVEN).name)
LIBRARY = Path(GIVEN) if GIVEN else ROOT / "target" / "release" / NAME
PAGE = HERE / "luxfer" / "studio" / "static" / "index.html"


def version() -> str:
    header = (ROOT / "include" / "luxfer" / "core.h").read_text()
    return ".".join(re.search(rf"#define LUXFER_VERSION_{part} (\d+)", header)[1] for part in ("MAJOR", "MINOR", "PATCH"))


class BuildPy(build_py):
    """Copies the modules and the library. An editable installation finds the library in target/release instead."""

    def run(self) -> None:
        if not LIBRARY.exists():
            subprocess.run(["cargo", "build", "--release", "--lib"], cwd=ROOT, check=True)
        if not PAGE.exists():
            print("luxfer.studio will have no page, because it has not been built: run `make studio` first", file=sys.stderr)
        super().run()
        if not self.editable_mode:
            self.copied().parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(LIBRARY, self.copied())
            strip = None if GIVEN else shutil.which("strip")
            if strip:  # nine tenths of the file are debug information; the exported names stay
                subprocess.run([strip, "-S" if sys.platform == "darwin" else "--strip-all", self.copied()], check=True)

    def copied(self) -> Path:
        return Path(self.build_lib) / "luxfer" / NAME

    def get_outputs(self, include_bytecode: bool = True) -> list:
        return super().get_outputs(include_bytecode) + ([] if self.editable_mode else [str(self.copied())])


class Wheel(bdist_wheel):
    """Tags the wheel py3-none-<platform>, because no part of it is compiled for one version of Python."""

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


class HasLibrary(Distribution):
    """Marks the distribution as specific to a platform."""

    def has_ext_modules(self) -> bool:
        return True


setup(version=version(), cmdclass={"build_py": BuildPy, "bdist_wheel": Wheel}, distclass=HasLibrary)
