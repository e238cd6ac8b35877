"""The hooks of mkdocs.yml: they add the pictures and the reference, and replace these tags on the pages of the guide:

    {{ settings luxfer_x_params }}, {{ fields luxfer_x_report }}    the fields of a struct with their comments
    {{ limits stage }}                  what a stage does not model, from its source
    {{ constant stage NAME }}           a threshold of a stage's warnings, from its source
    {{ figure name }}                   a figure of `make bench`
    {{ figures prefix ... }}            a table of the figures whose names begin so
    {{ plot name }}                     a plot that a bench has drawn
    {{ table name bench }}              a table that a bench has written
    {{ front name }}                    the Pareto front of a plot of error against time
    {{ test name }}                     the name of a test, which must exist
    {{ screenshot name caption }}       a picture by docs/screenshots.py or tests/studio/screenshot.js

Names of the C interface in code spans become links; an unknown name is an error.
"""

from __future__ import annotations

import csv
import os
import re
import sys
from fnmatch import fnmatch
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import reference  # noqa: E402
from mkdocs.exceptions import PluginError  # noqa: E402
from mkdocs.structure.files import File  # noqa: E402

ROOT = reference.ROOT
BENCH = ROOT / "out" / "bench"
#: Folders with the pictures of docs/blocks.py and of the C examples; each page and each example has a subfolder.
PICTURES = Path(os.environ.get("LUXFER_DOCS_PICTURES", ROOT / "target" / "docs" / "pictures"))
EXAMPLES = Path(os.environ.get("LUXFER_DOCS_EXAMPLES", ROOT / "target" / "docs" / "examples"))

#: Names that look like names of the C interface but are options of a build or of a binding.
OPTIONS = re.findall(
    r"\bLUXFER_\w+",
    "LUXFER_DEPRECATED LUXFER_NO_DEPRECATED "
    + "".join((ROOT / f).read_text() for f in ("CMakeLists.txt", "bindings/cpp/luxfer/result.hpp", "bindings/python/luxfer/_library.py")),
)

#: The files in which tests are looked up.
SOURCES = [file.read_text() for folder in ("src", "tests") for file in sorted((ROOT / folder).rglob("*.rs"))]

header = reference.Header()
python = reference.python_pages()


#: Maximum number of entries of the navigation: more are a list to search, not a guide.
MAX_ENTRIES = 30


def on_config(config):
    config.nav += [{"C reference": "reference/c/index.md"}, {"Python reference": "reference/python/index.md"}]
    if (count := entries(config.nav)) > MAX_ENTRIES:
        raise PluginError(f"the navigation has {count} entries, more than {MAX_ENTRIES}: let a page lead to another")
    return config


def entries(nav) -> int:
    """Returns the number of pages in a part of the navigation."""
    return sum(entries(value) if isinstance(value, list) else 1 for entry in nav for value in entry.values())


def on_files(files, config):
    files.append(File.generated(config, "reference/c/index.md", content=header.index()))
    for title in header.sections:
        path = f"reference/c/{reference.slug(title)}.md"
        files.append(File.generated(config, path, content=header.page(title)))
    for path, (_, text) in python.items():
        files.append(File.generated(config, path, content=text))
    for picture in sorted(PICTURES.rglob("*.png")):
        files.append(File.generated(config, str(picture.relative_to(PICTURES)), abs_src_path=str(picture)))
    for picture in sorted(EXAMPLES.glob("*/*.png")):
        files.append(File.generated(config, f"pictures/{picture.name}", abs_src_path=str(picture)))
    for plot in sorted(BENCH.glob("*.svg")):
        files.append(File.generated(config, f"plots/{plot.name}", abs_src_path=str(plot)))
    return files


def on_page_markdown(markdown, page, config, files):
    path = page.file.src_uri
    if path.startswith("reference/"):
        return markdown
    check_symptoms(markdown, path)
    parts = re.split(r"(^```.*?^```$)", markdown, flags=re.S | re.M)  # every other part is a block of code
    parts[::2] = [written(part, path, files) for part in parts[::2]]
    return "".join(parts)


def check_symptoms(markdown: str, path: str) -> None:
    """Checks that each symptom of a wrong result has a picture."""
    for table in re.findall(r'^<div class="symptoms".*?^</div>', markdown, re.S | re.M):
        for row in re.findall(r"^\|.*", table, re.M)[2:]:
            if not re.match(r"\| !\[\]\(\S+\.png\) \|", row):
                raise PluginError(f"{path}: a symptom has no picture: {row[:80]}")


def written(text: str, path: str, files) -> str:
    """Replaces the tags in a piece of prose."""
    text = re.sub(r"\{\{ (\w+) (.*?) \}\}", lambda m: value(m[1], m[2].split(), path, files), text)

    def link(match: re.Match) -> str:
        name = match[1]
        known = name in header.pages or name in OPTIONS or "_X_" in name
        if not known and not any(other.startswith(name) for other in header.pages):
            raise PluginError(f"{path}: luxfer.h has no {name}")
        return header.link(name, path)

    return re.sub(r"(?<!\[)`((?:luxfer|LUXFER)_\w+)`", link, text)


def value(kind: str, words: list[str], path: str, files) -> str:
    if kind in ("settings", "fields"):
        if words[0] not in header.fields:
            raise PluginError(f"{path}: luxfer.h has no struct {words[0]}")
        head = f"Fields of `{words[0]}`, with the defaults that `{words[0]}_init` sets:\n\n" if kind == "settings" else ""
        return head + header.table(words[0], path, ("struct_size", "reserved"))
    if kind == "limits":
        return limits(words[0], path)
    if kind == "constant":
        return constant(*words, path)
    if kind == "figure":
        number, unit = found(words, path)[0][1:]
        return f"{number} {unit}"
    if kind == "figures":
        rows = "".join(f"| `{name}` | {number} | {unit} |\n" for name, number, unit in found(words, path))
        return f"| figure | value | unit |\n|---|---|---|\n{rows}"
    if kind == "front":
        return front(words[0], path)
    if kind == "screenshot":
        name, *caption = words
        if files.get_file_from_path(f"screenshots/{name}.png") is None:
            return "*(`make docs` takes the picture that belongs here, where there are the programs for it: Blender and Xvfb, or Chromium.)*"
        return f"![{' '.join(caption)}]({reference.relative(f'screenshots/{name}.png', path)})"
    if kind == "test":
        if not any(f"fn {words[0]}(" in source for source in SOURCES):
            raise PluginError(f"{path}: there is no test {words[0]}")
        return f"`{words[0]}`"
    if kind == "table":
        return table(*words)
    if kind == "plot":
        name, bench = words
        if files.get_file_from_path(f"plots/{name}.svg") is None:
            return f"*(`make bench ONLY={bench}` draws the plot that belongs here.)*"
        return f"![{name}]({reference.relative(f'plots/{name}.svg', path)})"
    raise PluginError(f"{path}: what is {{{{ {kind} }}}}?")


def front(name: str, path: str) -> str:
    """The Pareto front of a plot of error against time. If the curves are named "problem: method", each problem has a
    front of its own."""
    if not (BENCH / f"{name}.csv").exists():
        return ""
    with open(BENCH / f"{name}.csv", newline="") as file:
        (_, seconds, error), *rows = csv.reader(file)
    if seconds != "seconds":
        raise PluginError(f"{path}: {name} is no plot against time")
    problems: dict[str, list[tuple[float, float, str]]] = {}
    for series, x, y in rows:
        problems.setdefault(series.rpartition(": ")[0], []).append((float(x), float(y), series))
    table = f"| {seconds} | {error} | of |\n|---|---|---|\n"
    for points in problems.values():
        best = float("inf")
        for x, y, series in sorted(points):
            if y < best:
                best = y
                table += f"| {x:.3g} | {y:.3g} | {series} |\n"
    return table


def table(name: str, bench: str) -> str:
    """Returns a table that a bench has written."""
    if not (BENCH / f"{name}.csv").exists():
        return f"*(`make bench ONLY={bench}` prints the table that belongs here.)*"
    with open(BENCH / f"{name}.csv", newline="") as file:
        head, *rows = csv.reader(file)
    return "".join(f"| {' | '.join(row)} |\n" for row in (head, ["---"] * len(head), *rows))


def limits(stage: str, path: str) -> str:
    """Returns the paragraphs of a stage's overview that begin with "Not modelled" or "Known weaknesses"."""
    lines = re.findall(r"^//! ?(.*)$", (ROOT / "src" / stage / "mod.rs").read_text(), re.M)
    text = " ".join(re.sub(r"\[(`[^`]+`)\](?:\(\w+\))?", r"\1", line) or "\n" for line in lines)
    out = re.findall(r"(?:Known weaknesses|Not modelled)[^\n]*", text)
    if not out:
        raise PluginError(f"{path}: src/{stage}/mod.rs does not say what it leaves out")
    return "\n\n".join(part.strip() for part in out)


def constant(stage: str, name: str, path: str) -> str:
    """Returns the value of a constant of a stage's warnings, from the source: of src/STAGE/warnings.rs, or of
    src/STAGE.rs."""
    source = ROOT / "src" / stage / "warnings.rs"
    source = source if source.exists() else ROOT / "src" / f"{stage}.rs"
    found = re.search(rf"const {name}: \w+ = ([\d.]+);", source.read_text())
    if not found:
        raise PluginError(f"{path}: {source.relative_to(ROOT)} has no limit {name}")
    return f"{float(found[1]):g}"


def figures() -> dict[str, tuple[str, str]]:
    """Returns the figures of docs/figures.md, replaced by the newer ones of this machine's `make bench` if there are
    any."""
    rows = re.findall(r"^\| `([^`]+)` \| (\S+) \| (.+) \|$", (ROOT / "docs" / "figures.md").read_text(), re.M)
    out = {name: (number, unit) for name, number, unit in rows}
    if (BENCH / "figures.txt").exists():
        for line in (BENCH / "figures.txt").read_text().splitlines():
            if match := re.fullmatch(r"figure (\S+) (\S+) (.+)", line):
                out[match[1]] = match[2], match[3]
    return out


def found(patterns: list[str], path: str) -> list[tuple[str, str, str]]:
    known = figures()
    out = []
    for pattern in patterns:
        names = [name for name in sorted(known) if fnmatch(name, pattern)]
        if not names:
            raise PluginError(f"{path}: `make bench` prints no figure {pattern}")
        out += [(name, *known[name]) for name in names]
    return out
