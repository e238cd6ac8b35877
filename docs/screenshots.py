"""Takes pictures of the Blender add-on for the guide.

    screenshots.py FOLDER LIBRARY

It needs Xvfb, xvfb-run and `blender` (or the program that BLENDER names) from version 3.4 on. If one is missing, it
prints which and succeeds. docs/in_blender.py is the program that runs in Blender.
"""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS.parent / "tests" / "blender"))

import xvfb  # noqa: E402


def main(folder: str, library: str) -> int:
    if reason := xvfb.missing():
        print(f"the guide has no pictures of the Blender add-on: {reason}")
        return 0
    out = Path(folder).resolve()
    out.mkdir(parents=True, exist_ok=True)
    done = xvfb.run(DOCS / "in_blender.py", Path(library).resolve(), out)
    if done.returncode != 0:
        print(done.stdout, done.stderr, f"{xvfb.BLENDER} could not take the pictures of the add-on", sep="\n", file=sys.stderr)
    return done.returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
