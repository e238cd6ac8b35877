"""Writes the figures that `make bench` printed (out/bench/figures.txt) into the table of README.md.

Each bench replaces its own lines, so that the table can be brought up to date bench by bench.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- figures: written by `make bench` -->\n", "<!-- end of figures -->"

figures = {}
for line in (ROOT / "out/bench/figures.txt").read_text().splitlines():
    match = re.fullmatch(r"figure (\S+) (\S+) (.+)", line)
    if match:
        figures[match[1]] = (match[2], match[3])

readme = ROOT / "README.md"
text = readme.read_text()
if BEGIN not in text or END not in text:
    sys.exit("README.md has no place for the table")
before, rest = text.split(BEGIN, 1)
old, after = rest.split(END, 1)
rows = dict(re.findall(r"\| `([^`]+)` (\|.*)", old))
rows.update({name: f"| {value} | {unit} |" for name, (value, unit) in figures.items()})
table = "".join(f"| `{name}` {row}\n" for name, row in sorted(rows.items()))
readme.write_text(f"{before}{BEGIN}| figure | value | unit |\n|---|---|---|\n{table}{END}{after}")
