"""Starts a Blender with a window on a virtual screen: Xvfb draws into memory."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

BLENDER = os.environ.get("BLENDER", "blender")
SIZE = "1280", "800"


def missing() -> str | None:
    """The reason why no window can be opened; None if it can."""
    for program in (BLENDER, "xvfb-run", "Xvfb"):
        if shutil.which(program) is None:
            return f"there is no {program}"
    said = subprocess.run([BLENDER, "--version"], capture_output=True, text=True).stdout
    version = re.search(r"Blender (\d+)\.(\d+)", said)
    if version is None or (int(version[1]), int(version[2])) < (3, 4):
        return f"{BLENDER} is not Blender 3.4 or newer"
    return None


def run(program: Path, library: Path, *arguments: Path) -> subprocess.CompletedProcess:
    """Runs a program in Blender. Its arguments are the file with the contents of the screen, then `arguments`.

    Mesa draws in software, so the pictures are the same on any machine.
    """
    with tempfile.TemporaryDirectory() as scratch:
        environment = {**os.environ, "LUXFER_LIBRARY": str(library), "LIBGL_ALWAYS_SOFTWARE": "1", "TMPDIR": scratch}
        screen = f"-nocursor -screen 0 {'x'.join(SIZE)}x24 -fbdir {scratch}"
        window = ["--factory-startup", "--enable-event-simulate", "--window-geometry", "0", "0", *SIZE]
        script = ["--python-exit-code", "1", "--python", program]  # otherwise the window stays open after an error
        command = ["xvfb-run", "-a", "-s", screen, BLENDER, *window, *script, "--", f"{scratch}/Xvfb_screen0", *arguments]
        return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
