"""Pictures of the Blender add-on, by a Blender that draws its window into the memory of a virtual screen.

    screenshots.py FOLDER LIBRARY

It takes Xvfb, xvfb-run and `blender` (or what BLENDER names), 3.4 or newer; where they are missing it says so and all is well.
What is done in Blender is docs/in_blender.py.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SIZE = "1280", "800"
PROGRAM = Path(__file__).with_name("in_blender.py")


def missing(blender: str) -> str | None:
    """Why there will be no pictures."""
    for program in (blender, "xvfb-run", "Xvfb"):
        if shutil.which(program) is None:
            return f"there is no {program}"
    said = subprocess.run([blender, "--version"], capture_output=True, text=True).stdout
    version = re.search(r"Blender (\d+)\.(\d+)", said)
    if version is None or (int(version[1]), int(version[2])) < (3, 4):
        return f"{blender} is not Blender 3.4 or newer"
    return None


def take(blender: str, folder: Path, library: Path) -> subprocess.CompletedProcess:
    """Has Blender take all pictures. The light is drawn by Mesa's software, so that it is the same on any machine."""
    with tempfile.TemporaryDirectory() as scratch:
        environment = {**os.environ, "LUXFER_LIBRARY": str(library), "LIBGL_ALWAYS_SOFTWARE": "1", "TMPDIR": scratch}
        screen = f"-screen 0 {'x'.join(SIZE)}x24 -fbdir {scratch}"
        window = ["--factory-startup", "--enable-event-simulate", "--window-geometry", "0", "0", *SIZE]
        command = ["xvfb-run", "-a", "-s", screen, blender, *window, "--python", PROGRAM, "--", f"{scratch}/Xvfb_screen0", folder]
        return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)


def main(folder: str, library: str) -> int:
    blender = os.environ.get("BLENDER", "blender")
    if reason := missing(blender):
        print(f"the guide has no pictures of the Blender add-on: {reason}")
        return 0
    out = Path(folder).resolve()
    out.mkdir(parents=True, exist_ok=True)
    done = take(blender, out, Path(library).resolve())
    if done.returncode != 0:
        print(done.stdout, done.stderr, f"{blender} could not take the pictures of the add-on", sep="\n", file=sys.stderr)
    return done.returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
