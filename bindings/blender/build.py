"""Builds the extension for this platform into a folder: the add-on with the wheel of bindings/python inside.

    python3 bindings/blender/build.py [FOLDER, out/blender by default]

Install the .zip in Blender by Edit > Preferences > Get Extensions > Install from Disk. numpy comes with Blender.
"""

import importlib.util
import platform
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
ADD_ON = HERE / "luxfer_lighting"


def blender_platform() -> str:
    system = {"linux": "linux", "darwin": "macos", "win32": "windows"}[sys.platform]
    machine = {"x86_64": "x64", "AMD64": "x64", "aarch64": "arm64", "arm64": "arm64"}[platform.machine()]
    return f"{system}-{machine}"


def build(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "wheel", "--quiet", "--no-deps"]
        if importlib.util.find_spec("setuptools") and importlib.util.find_spec(
            "setuptools.command.bdist_wheel"
        ):  # the build tools are new enough: nothing to download
            pip.append("--no-build-isolation")
        subprocess.run([*pip, "--wheel-dir", temporary, ROOT / "bindings" / "python"], check=True, stdin=subprocess.DEVNULL)
        (wheel,) = Path(temporary).glob("*.whl")
        version = wheel.name.split("-")[1]
        manifest = (ADD_ON / "blender_manifest.toml").read_text()
        if f'version = "{version}"' not in manifest:
            raise SystemExit(f"blender_manifest.toml is not of version {version}, as the library is")
        head = manifest.split("\n# build.py")[0]
        manifest = f'{head}\nplatforms = ["{blender_platform()}"]\nwheels = ["./wheels/{wheel.name}"]\n'
        out = folder / f"luxfer_lighting-{version}-{blender_platform()}.zip"
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("blender_manifest.toml", manifest)
            for source in sorted(ADD_ON.glob("*.py")):
                archive.write(source, source.name)
            for licence in sorted(ROOT.glob("LICENSE-*")):
                archive.write(licence, licence.name)
            archive.write(wheel, f"wheels/{wheel.name}")
    return out


if __name__ == "__main__":
    print(build(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out" / "blender"))
