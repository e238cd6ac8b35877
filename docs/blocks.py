"""Checks and runs the code blocks of the guide, so that all code shown there works.

    blocks.py check
        checks that each block is part of a program that a test compiles or runs, or can be run itself
    blocks.py list
        prints the pages that have blocks to run, each with the language of the blocks
    blocks.py run FOLDER LIBRARY [--short] [LANGUAGE...] [PAGE...]
        runs the Python and shell blocks page by page; their pictures go into FOLDER

A block consists either of `--8<--` lines only, which name parts of programs, or of Python or shell code. The Python
blocks of a page form one program, and so do its shell blocks. Python runs in FOLDER/PAGE/, with copies of the photos
(.jpg) of the page's folder in the guide. Shell runs in a tree of links that looks like the source tree after a build,
so that it leaves no files in the source tree; `luxfer` is on its path as if the wheel were installed.

A comment `<!-- short run: CODE -->` on a line of its own in a page is Python that only `--short` runs, at its place: it
leaves out a part of what the page repeats, as tests need one example of it.
"""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
GUIDE = ROOT / "docs" / "guide"
#: Programs that tests compile and run (tests/CMakeLists.txt).
TESTED = re.compile(r"examples_c/\w+\.[ch]|tests/docs/\w+\.(cpp|hpp|c|py)|tests/package/(CMakeLists\.txt|consumer\.(c|cpp)|check\.sh)")
RUN = {"python": "python", "sh": "sh"}
SHORT = re.compile(r"^<!-- short run: (.*) -->$", re.M)
FENCE = re.compile(r"^([ \t]*)(`{3,}|~{3,})([^\n]*)\n(.*?)^\1\2[ \t]*$", re.S | re.M)


def pages() -> list[Path]:
    return sorted(GUIDE.rglob("*.md"))


def blocks(page: Path) -> list[tuple[int, str, str]]:
    """Returns line number, language and text of each code block of a page."""
    text = page.read_text()
    found = [(text.count("\n", 0, m.start()) + 1, m[3].strip(), m[4]) for m in FENCE.finditer(text)]
    if len(re.findall(r"^[ \t]*(?:```|~~~)", text, re.M)) != 2 * len(found):
        raise SystemExit(f"{page}: a block of code is not closed")
    return found


def parts(text: str) -> list[str] | None:
    """Returns the parts of programs that a block names; None if the block is not made of such names."""
    lines = [line.strip() for line in text.strip().split("\n")]
    names = [re.fullmatch(r'--8<-- "([^"]+)"', line) for line in lines]
    return [name[1] for name in names if name] if all(names) else None


def check() -> list[str]:
    problems = []
    for page in pages():
        if re.search(r"<pre|<code", page.read_text()):
            problems.append(f"{page}: code as HTML, which nothing tests")
        for line, language, text in blocks(page):
            place = f"{page.relative_to(ROOT)}, line {line}"
            names = parts(text)
            if names is None:
                if language not in RUN:
                    problems.append(f"{place}: a block of {language or 'no language'} that is no part of a tested program")
                continue
            for name in names:
                file, _, section = name.partition(":")
                if not TESTED.fullmatch(file) or not (ROOT / file).exists():
                    problems.append(f"{place}: {file} is no program that a test compiles or runs")
                elif section and f"[start:{section}]" not in (ROOT / file).read_text():
                    problems.append(f"{place}: {file} has no part {section}")
    return problems


def run_python(page: Path, short: bool, folder: Path, environment: dict[str, str]) -> int:
    """Runs a page's Python blocks as one program; error messages have the line numbers of the page."""
    code = [(line + 1, text) for line, language, text in blocks(page) if language == "python" and parts(text) is None]
    if short:
        text = page.read_text()
        code = sorted(code + [(text.count("\n", 0, m.start()) + 1, m[1] + "\n") for m in SHORT.finditer(text)])
    source, at = "", 1
    for line, text in code:
        source += "\n" * (line - at) + text
        at = line + text.count("\n")
    if not source:
        return 0
    work = folder / page.relative_to(GUIDE).with_suffix("")
    work.mkdir(parents=True, exist_ok=True)
    for photo in page.with_suffix("").glob("*.jpg"):
        shutil.copy(photo, work)
    code = f"exec(compile(open(0).read(), {str(page)!r}, 'exec'), {{'__name__': '__main__'}})"
    return quiet([sys.executable, "-c", code], source, work, environment)


def run_sh(page: Path, library: Path, environment: dict[str, str]) -> int:
    """Runs the shell blocks of a page as one script."""
    script = "\n".join(text for _, language, text in blocks(page) if language == "sh" and parts(text) is None)
    if not script:
        return 0
    with tempfile.TemporaryDirectory() as scratch:
        tree, home = Path(scratch) / "luxfer", Path(scratch) / "home"
        tree.mkdir()
        home.mkdir()
        for item in ROOT.iterdir():
            if item.name not in ("target", "out", "build", ".git"):
                (tree / item.name).symlink_to(item)
        (tree / "target").mkdir()
        (tree / "target" / "release").symlink_to(library.parent)
        program = home / "bin" / "luxfer"
        program.parent.mkdir()
        program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m luxfer "$@"\n')
        program.chmod(0o755)
        path = f"{program.parent}{os.pathsep}{environment.get('PATH', os.defpath)}"
        return quiet(["sh", "-eu"], script, tree, {**environment, "HOME": str(home), "PATH": path})


def quiet(command: list[str], program: str, folder: Path, environment: dict[str, str]) -> int:
    """Runs a program; prints its output if it fails."""
    done = subprocess.run(command, input=program, capture_output=True, text=True, cwd=folder, env=environment)
    if done.returncode != 0:
        print(done.stdout, done.stderr, sep="", file=sys.stderr)
    return done.returncode


def runnable() -> list[tuple[Path, str]]:
    """Returns the pages that have blocks to run, each with the language of the blocks."""
    found = []
    for page in pages():
        languages = {language for _, language, text in blocks(page) if language in RUN and parts(text) is None}
        found += [(page, language) for language in sorted(languages)]
    return found


def run(folder: Path, library: Path, asked: list[str]) -> list[str]:
    environment = {**os.environ, "LUXFER_LIBRARY": str(library), "PYTHONPATH": str(ROOT / "bindings" / "python")}
    languages = [word for word in asked if word in RUN] or list(RUN)
    short = "--short" in asked
    names = [word for word in asked if word not in RUN and word != "--short"]
    problems, ran = [], set()
    for page, language in runnable():
        name = str(page.relative_to(GUIDE))
        if language not in languages or names and name not in names:
            continue
        ran.add(name)
        began = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        code = run_python(page, short, folder, environment) if language == "python" else run_sh(page, library, environment)
        took = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - began
        if code != 0:
            problems.append(f"{page.relative_to(ROOT)}: its blocks of {language} fail")
        print(f"{took:6.1f} s of processors  {name}, {language}", flush=True)
    return problems + [f"{name} is no page with blocks of {' or '.join(languages)}" for name in names if name not in ran]


def main(arguments: list[str]) -> int:
    if arguments == ["check"]:
        problems = check()
    elif arguments == ["list"]:
        problems = []
        for page, language in runnable():
            print(page.relative_to(GUIDE), language)
    elif len(arguments) >= 3 and arguments[0] == "run":
        problems = run(Path(arguments[1]).resolve(), Path(arguments[2]).resolve(), arguments[3:])
    else:
        print(__doc__, file=sys.stderr)
        return 2
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
