"""Draws comments and texts at random for a reader's test (docs/notes/plain-words.md).

    python3 docs/notes/draw_comments.py SEED TODAY EARLIER COMMIT FOLDER
    python3 docs/notes/draw_comments.py SEED COUNT headers|guide FOLDER

The first form draws TODAY comment blocks of the library's source code, and EARLIER ones of COMMIT. The second form
draws COUNT comment blocks of the C headers, or COUNT paragraphs of the guide and the README. The drawn blocks are
written to FOLDER/blocks.txt, shuffled and without the names of their files, and the place of each to FOLDER/key.txt.
"""

from __future__ import annotations

import random
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Lines shown above and below a block.
ABOVE, BELOW = 3, 15


def git(*words: str) -> str:
    return subprocess.run(["git", "-C", ROOT, *words], check=True, capture_output=True, text=True).stdout


def blocks(name: str, text: str, starts: tuple[str, ...] = ("//",)) -> list[tuple[str, str]]:
    """Returns the place and the text of each comment block of a file; `>>>` marks its lines."""
    lines, found, at = text.split("\n"), [], 0
    while at < len(lines):
        end = at
        while end < len(lines) and lines[end].lstrip().startswith(starts):
            end += 1
        if end > at:
            marked = [">>> " + line for line in lines[at:end]]
            shown = lines[max(0, at - ABOVE) : at] + marked + lines[end : end + BELOW]
            found.append((f"{name}:{at + 1}", "\n".join(shown)))
        at = max(end, at + 1)
    return found


def paragraphs(name: str, text: str) -> list[tuple[str, str]]:
    """Returns the place and the text of each paragraph of a page: no headings, tables, code or short lines."""
    found, line = [], 1
    for paragraph in re.sub(r"```.*?```", "[code]", text, flags=re.DOTALL).split("\n\n"):
        if len(paragraph) > 80 and not paragraph.startswith(("#", "|")) and "[code]" not in paragraph:
            found.append((f"{name}:{line}", f"({Path(name).name})\n{paragraph}"))
        line += paragraph.count("\n") + 2
    return found


def of_code(today: str, earlier: str, commit: str) -> list[tuple[str, str, str]]:
    """Draws comment blocks of the source code of today and of a commit."""
    now, before = [], []
    for name in git("ls-files", "src/*.rs").split():
        now += blocks(name, (ROOT / name).read_text())
    for name in git("ls-tree", "-r", "--name-only", commit, "src").split():
        if name.endswith(".rs"):
            before += blocks(name, git("show", f"{commit}:{name}"))
    drawn = [("today", *block) for block in random.sample(now, int(today))]
    return drawn + [(commit, *block) for block in random.sample(before, int(earlier))]


def of_texts(count: str, kind: str) -> list[tuple[str, str, str]]:
    """Draws comment blocks of the headers, or paragraphs of the guide and the README."""
    found = []
    files = ["include/luxfer/*.h"] if kind == "headers" else ["docs/guide/*.md", "README.md"]
    for name in git("ls-files", *files).split():
        text = (ROOT / name).read_text()
        found += blocks(name, text, ("/**", "*", "*/")) if kind == "headers" else paragraphs(name, text)
    return [("today", *block) for block in random.sample(found, int(count))]


def main(arguments: list[str]) -> int:
    is_of_texts = len(arguments) == 4 and arguments[2] in ("headers", "guide")
    if not is_of_texts and len(arguments) != 5:
        print(__doc__, file=sys.stderr)
        return 2
    random.seed(int(arguments[0]))
    drawn = of_texts(*arguments[1:3]) if is_of_texts else of_code(*arguments[1:4])
    random.shuffle(drawn)
    out = Path(arguments[-1])
    out.mkdir(parents=True, exist_ok=True)
    (out / "blocks.txt").write_text("".join(f"===== block {n}\n{b[2]}\n\n" for n, b in enumerate(drawn, 1)))
    (out / "key.txt").write_text("".join(f"{n} {b[0]} {b[1]}\n" for n, b in enumerate(drawn, 1)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
