"""Writes the table of docs/guide/platforms.md from the results of `make dist-check` (out/dist/check/*.txt), and prints
it.

A target without results there keeps its row.
"""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
CHECKS = ROOT / "out" / "dist" / "check"
PAGE = ROOT / "docs" / "guide" / "platforms.md"
BEGIN, END = "<!-- platforms: written by `make dist-check` -->", "<!-- end of platforms -->"
HEAD = ["target", "builds", "runs here", "results bit-identical to linux-x86_64", "test programs passed", "size of the library", "wheel", "needs"]
ORDER = ["linux-x86_64", "linux-aarch64", "linux-musl-x86_64", "windows-x86_64", "macos-universal"]


def row(found: dict[str, str]) -> list[str]:
    runs = found.get("runs", "no")
    tool = {"no": "built, not run", "natively": "natively"}.get(runs, f"under {runs}")
    unknown = "built, not run"
    return [
        found["target"],
        found["builds"],
        tool,
        found.get("same_bits", unknown),
        found.get("passed", unknown),
        f"{int(found['bytes']) / 1e6:.1f} MB",
        found.get("wheel", "-"),
        found.get("needs", "-"),
    ]


def line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def main() -> None:
    page = PAGE.read_text()
    before, rest = page.split(BEGIN)
    old, after = rest.split(END)
    rows = {m[1]: m[0] for m in re.finditer(r"^\| ([\w-]+) \|.*$", old, re.M) if m[1] in ORDER}
    for file in CHECKS.glob("*.txt"):
        found = dict(text.split(" ", 1) for text in file.read_text().splitlines())
        rows[found["target"]] = line(row(found))
    table = "\n".join([line(HEAD), line(["---"] * len(HEAD)), *(rows[t] for t in ORDER if t in rows)])
    PAGE.write_text(f"{before}{BEGIN}\n{table}\n{END}{after}")
    print(table)


if __name__ == "__main__":
    main()
