"""Builds the extension into a folder: the add-on with the wheel of bindings/python inside.

    python3 bindings/blender/build.py [FOLDER, out/blender by default]     for this platform
    python3 bindings/blender/build.py FOLDER --wheel luxfer-....whl        for the platform of the wheel

Install the .zip in Blender by Edit > Preferences > Get Extensions > Install from Disk. numpy comes with Blender. Equal
sources and wheels give equal bytes: all files get the time SOURCE_DATE_EPOCH, as in bindings/dist/archive.py.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import re
import stat
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
ADD_ON = HERE / "luxfer_lighting"

#: Blender's names of platforms by the platform tags of wheels, and the library that a wheel for the system contains.
SYSTEMS = {"manylinux": "linux", "linux": "linux", "macosx": "macos", "win": "windows"}
MACHINES = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64", "arm64": "arm64"}
LIBRARIES = {"linux": "libluxfer.so", "macos": "libluxfer.dylib", "windows": "luxfer.dll"}


def platform_of(wheel: Path) -> str:
    """Blender's name of the platform of a wheel, such as windows-x64 for win_amd64."""
    match = re.fullmatch(r"luxfer-[\d.]+-py3-none-(manylinux|linux|macosx|win)_(?:\w+_)?(x86_64|amd64|aarch64|arm64)\.whl", wheel.name)
    if not match:
        raise SystemExit(f"{wheel.name}: Blender's platform does not follow from the name; luxfer-VERSION-py3-none-PLATFORM.whl is allowed")
    return f"{SYSTEMS[match[1]]}-{MACHINES[match[2]]}"


def build_wheel(folder: str) -> Path:
    """Builds the wheel of this platform."""
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "wheel", "--quiet", "--no-deps"]
    if importlib.util.find_spec("setuptools") and importlib.util.find_spec(
        "setuptools.command.bdist_wheel"
    ):  # the build tools are new enough: nothing to download
        pip.append("--no-build-isolation")
    subprocess.run([*pip, "--wheel-dir", folder, ROOT / "bindings" / "python"], check=True, stdin=subprocess.DEVNULL)
    (wheel,) = Path(folder).glob("*.whl")
    return wheel


def manifest(wheel: Path, platform: str) -> str:
    version = wheel.name.split("-")[1]
    text = (ADD_ON / "blender_manifest.toml").read_text()
    if f'version = "{version}"' not in text:
        raise SystemExit(f"blender_manifest.toml is not of version {version}, as the library is")
    head = text.split("\n# build.py")[0]
    return f'{head}\nplatforms = ["{platform}"]\nwheels = ["./wheels/{wheel.name}"]\n'


def check(wheel: Path, platform: str) -> None:
    """Checks that the wheel contains the library of its platform."""
    wanted = f"luxfer/{LIBRARIES[platform.split('-')[0]]}"
    with zipfile.ZipFile(wheel) as content:
        if wanted not in content.namelist():
            raise SystemExit(f"{wheel.name} is for {platform}, but does not contain {wanted}")


def pack(folder: Path, wheel: Path) -> Path:
    """Packs the add-on with a wheel."""
    platform = platform_of(wheel)
    check(wheel, platform)
    files = {"blender_manifest.toml": manifest(wheel, platform).encode()}
    for source in [*sorted(ADD_ON.glob("*.py")), *sorted(ROOT.glob("LICENSE-*"))]:
        files[source.name] = source.read_bytes()
    files[f"wheels/{wheel.name}"] = wheel.read_bytes()
    folder.mkdir(parents=True, exist_ok=True)
    out = folder / f"luxfer_lighting-{wheel.name.split('-')[1]}-{platform}.zip"
    when = time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", "1735689600")))[:6]
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, when)
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description="Builds the Blender extension.")
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "out" / "blender")
    parser.add_argument("--wheel", type=Path, help="a wheel of the Python package, for any platform; by default it is built for this one")
    options = parser.parse_args()
    if options.wheel:
        print(pack(options.folder, options.wheel))
        return
    with tempfile.TemporaryDirectory() as temporary:
        print(pack(options.folder, build_wheel(temporary)))


if __name__ == "__main__":
    main()
