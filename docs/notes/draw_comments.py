"""Draws comment blocks of the library at random for a reader's test (docs/notes/plain-words.md).

    python3 docs/notes/draw_comments.py SEED TODAY EARLIER COMMIT FOLDER

Writes TODAY blocks of the working tree and EARLIER blocks of COMMIT, shuffled and without the names of their files,
into FOLDER/blocks.txt, and where each block comes from into FOLDER/key.txt.
"""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Lines shown above and below a block.
ABOVE, BELOW = 3, 15


def git(*words: str) -> str:
    return subprocess.run(["git", "-C", ROOT, *words], check=True, capture_output=True, text=True).stdout


def blocks(name: str, text: str) -> list[tuple[str, str]]:
    """Returns the place and the text of each comment block of a file; `>>>` marks its lines."""
    lines, found, at = text.split("\n"), [], 0
    while at < len(lines):
        end = at
        while end < len(lines) and lines[end].lstrip().startswith("//"):
            end += 1
        if end > at:
            marked = [">>> " + line for line in lines[at:end]]
            shown = lines[max(0, at - ABOVE) : at] + marked + lines[end : end + BELOW]
            found.append((f"{name}:{at + 1}", "\n".join(shown)))
        at = max(end, at + 1)
    return found


def main(arguments: list[str]) -> int:
    if len(arguments) != 5:
        print(__doc__, file=sys.stderr)
        return 2
    seed, today, earlier, commit, folder = arguments
    random.seed(int(seed))
    now, before = [], []
    for name in git("ls-files", "src/*.rs").split():
        now += blocks(name, (ROOT / name).read_text())
    for name in git("ls-tree", "-r", "--name-only", commit, "src").split():
        if name.endswith(".rs"):
            before += blocks(name, git("show", f"{commit}:{name}"))
    drawn = [("today", *block) for block in random.sample(now, int(today))]
    drawn += [(commit, *block) for block in random.sample(before, int(earlier))]
    random.shuffle(drawn)
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    (out / "blocks.txt").write_text("".join(f"===== block {n}\n{b[2]}\n\n" for n, b in enumerate(drawn, 1)))
    (out / "key.txt").write_text("".join(f"{n} {b[0]} {b[1]}\n" for n, b in enumerate(drawn, 1)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
