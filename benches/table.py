"""Writes the figures that `make bench` printed (out/bench/figures.txt) into docs/figures.md, and ten of them into
README.md.

Each bench replaces its own lines only, so the benches need not all be run. Without new figures, the table of README.md
is written from docs/figures.md.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PRINTED, FIGURES, README = ROOT / "out/bench/figures.txt", ROOT / "docs/figures.md", ROOT / "README.md"
ALL = "<!-- figures: written by `make bench` -->\n", "<!-- end of figures -->"
TEN = "<!-- headlines: written by `make bench` -->\n", "<!-- end of headlines -->"

#: The figures of the README: name, meaning, and how the value is shown.
HEADLINES = [
    ("transfer.demo.seconds", "a whole lighting transfer at final quality, 640 x 360 pixels, two threads", "{:.1f} s"),
    ("peak.transfer_demo.mb", "peak memory of this transfer", "{:.0f} MB"),
    ("segment.iou.ours", "overlap of masks from strokes with the true masks (IoU; 1 is perfect)", "{:.2f}"),
    ("vp.yud_dev.auc10", "share of directions (of walls, streets) found in the York Urban photos, mean over tolerances up to 10 degrees", "{:.0f} %"),
    ("emission.2048.seconds", "synthesis of an emissive texture of 2048 x 2048 texels", "{:.2f} s"),
    ("relight.to_1pct.seconds", "solving for the strength of the lights, to 1 %", "{:.2f} s"),
    ("render.time_to_1pct.kitchen.vs_cycles", "time in which Cycles renders a kitchen down to 1 % noise, as a multiple of luxfer's time", "{:.1f}"),
    ("render.time_to_1pct.kitchen.vs_mitsuba_llvm", "time in which Mitsuba 3 (LLVM) does this, as a multiple of luxfer's time", "{:.1f}"),
    ("render.interval_coverage", "pixels whose true brightness lies within the error that luxfer states for them (95 % is promised)", "{:.1f} %"),
    ("stylit.full.seconds", "a stylisation of 1200 x 912 pixels with four guides", "{:.1f} s"),
]


def replaced(path: pathlib.Path, marks: tuple[str, str], table: str) -> None:
    """Replaces the table between two marks of a file."""
    text = path.read_text()
    begin, end = marks
    if begin not in text or end not in text:
        sys.exit(f"{path.name} has no place for the table")
    before, rest = text.split(begin, 1)
    path.write_text(f"{before}{begin}{table}{end}{rest.split(end, 1)[1]}")


rows = dict(re.findall(r"^\| `([^`]+)` \| (.*) \|$", FIGURES.read_text(), re.M))
for line in PRINTED.read_text().splitlines() if PRINTED.exists() else []:
    if match := re.fullmatch(r"figure (\S+) (\S+) (.+)", line):
        rows[match[1]] = f"{match[2]} | {match[3]}"
every = "".join(f"| `{name}` | {row} |\n" for name, row in sorted(rows.items()))
replaced(FIGURES, ALL, f"| figure | value | unit |\n|---|---|---|\n{every}")


def shown(name: str, form: str) -> str:
    value = rows[name].split(" | ")[0]
    return value if value == "absent" else form.format(float(value))


ten = "".join(f"| {meaning} | {shown(name, form)} |\n" for name, meaning, form in HEADLINES)
replaced(README, TEN, f"| figure | value |\n|---|---|\n{ten}")
