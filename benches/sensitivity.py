"""Measures how the figures of benches depend on constants of `src`, and prints a Markdown table.

    python3 benches/sensitivity.py CONSTANT ... --bench NAME[:SECTION...] ... [--factors 0.5,1,2]

A CONSTANT is `FILE:NAME`, such as `src/features/score.rs:SEAM`, or one element of an array or a tuple,
`src/rectify/manhattan.rs:FOCALS[0]`. It is multiplied by each of the factors, or takes the values of
`FILE:NAME=0.9,0.99`. Floats and whole numbers can be measured, alone and in arrays and tuples.
Constants that stand in patterns or lengths of arrays, or that are borrowed for more than a statement, cannot: the copy
does not compile.

The tool copies the tracked files into `target/sensitivity` and changes only this copy: there, a constant becomes a
function that reads its factor or its value from the environment variable LUXFER_CONSTANTS, once, and a constant that
uses it becomes a function too. So one build serves all constants and all factors, and constants that an earlier call
has replaced stay replaced. The copy leaves out `src/ffi`, which no bench uses.

At first, each bench runs twice with the values of `src`. Figures that differ between the two runs depend on time or on
chance and are left out; so are lines of the output that differ. The column "lines" counts the other lines of the output
that change. With `--untouched FOLDER`, in which the benches of the unchanged tree have been built as `FOLDER/NAME`,
the tool also checks that their figures are equal to the figures of the copy.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COPY, BUILD = ROOT / "target/sensitivity", ROOT / "target/sensitivity-build"
REPLACED = COPY / "replaced.json"
READER = '''//! Values of constants from the environment; written by benches/sensitivity.py.

/// The value of a constant: `given`, unless LUXFER_CONSTANTS has `NAME*FACTOR` or `NAME=VALUE`.
pub fn value(name: &str, given: f64) -> f64 {
    let all = std::env::var("LUXFER_CONSTANTS").unwrap_or_default();
    let number = |text: &str| text.parse::<f64>().ok();
    let of = |entry: &str| {
        let rest = entry.strip_prefix(name)?;
        rest.strip_prefix('*').and_then(number).map(|f| given * f).or_else(|| rest.strip_prefix('=').and_then(number))
    };
    all.split(';').find_map(of).unwrap_or(given)
}
'''


def code_replaced(text: str, name: str, by: str) -> str:
    """Replaces a name in the code of a file, but neither in comments nor where it is imported or defined."""
    lines = []
    for line in text.split("\n"):
        code, mark, comment = line.partition("//")
        if not re.match(r"\s*(pub(\([^)]*\))? )?(use|fn) ", code):
            code = re.sub(rf"(?<![\w`]){name}\b(?!\()", by, code)
        lines.append(code + mark + comment)
    return "\n".join(lines)


def elements(kind: str) -> list[tuple[str, str]]:
    """The elements of a type of constants, as suffixes of its name in Rust, and the types of the elements."""
    if match := re.fullmatch(r"\[(\w+); (\d+)\]", kind):
        return [(f"[{i}]", match[1]) for i in range(int(match[2]))]
    if match := re.fullmatch(r"\((.*)\)", kind):
        return [(f".{i}", part.strip()) for i, part in enumerate(match[1].split(","))]
    return [("", kind)]


def as_function(path: str, match: re.Match, measured: bool) -> str:
    """The function that takes the place of a constant."""
    public, name, kind, value = match[1] or "", match[2], match[3], match[4]
    lines = [f"#[allow(non_snake_case)] {public}fn {name}() -> {kind} {{"]
    lines += [f"static VALUE: std::sync::OnceLock<{kind}> = std::sync::OnceLock::new();", "*VALUE.get_or_init(|| {"]
    lines.append(f"#[allow(unused_mut)] let mut value: {kind} = {value};")
    for suffix, scalar in elements(kind) if measured else []:
        if scalar not in ("f32", "f64", "usize", "isize", "u32", "i32"):
            sys.exit(f"{path}: {name} has the type {kind}, which cannot be measured")
        rounded = ".round()" if scalar[0] != "f" else ""
        key = f"{path}:{name}" + re.sub(r"\.(\d)", r"[\1]", suffix)
        lines.append(f'value{suffix} = crate::sensitivity::value("{key}", value{suffix} as f64){rounded} as {scalar};')
    return "\n".join([*lines, "value", "})", "}"])


def replace(files: dict[str, str], constant: str, measured: bool = True) -> None:
    """Replaces a constant by a function in all files, and constants that use it by functions as well."""
    path, name = constant.split(":")
    if path not in files:
        sys.exit(f"there is no file {path}")
    form = rf"^((?:pub(?:\([^)]*\))? )?)const ({name}): ([^=]+?) =\s+(.*?);$"
    match = re.search(form, files[path], re.M | re.S)
    if not match:
        if re.search(rf"fn {name}\(\)", files[path]):
            return
        sys.exit(f"{path} has no constant {name}")
    # A private constant is used in its own file only, and in its child modules.
    users = [path] if not match[1] else [p for p in files if p.startswith("src/") and name in files[p]]
    if match[1] and sum(bool(re.search(rf"const {name}:", files[p])) for p in users) > 1:
        sys.exit(f"{name} is defined in several files")
    before, after = files[path][: match.start()], files[path][match.end() :]
    mark = "\0"
    files[path] = before + mark + after
    for user in users:
        files[user] = code_replaced(files[user], name, f"{name}()")
    files[path] = files[path].replace(mark, as_function(path, match, measured))
    for user in users:
        for other in re.findall(rf"const (\w+): [^=]+ =[^;]*\b{name}\(\)[^;]*;$", files[user], re.M):
            replace(files, f"{user}:{other}", measured=False)


def code_of(content: bytes) -> list[bytes]:
    """The lines of a file without comment lines of Rust."""
    return [line for line in content.split(b"\n") if not line.lstrip().startswith(b"//")]


def write_copy(constants: list[str]) -> None:
    """Writes the copy of the tree with its constants replaced. Files whose code stays equal keep their times."""
    listed = subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).splitlines()
    kept = ("src/", "benches/", "tests/strokes/", "tests/truth/", "Cargo.", "build.rs")
    binary, files = {}, {}
    for path in filter(lambda p: p.startswith(kept) and not p.startswith("src/ffi"), listed):
        content = (ROOT / path).read_bytes()
        if path.endswith((".rs", ".toml")):
            files[path] = content.decode()
        else:
            binary[path] = content
    for constant in constants:
        replace(files, constant)
    files["src/sensitivity.rs"] = READER
    # Only Rust programs use the copy, so it needs neither a C interface nor a shared library.
    files["src/lib.rs"] = re.sub(r"^pub mod ffi;$", "pub mod sensitivity;", files["src/lib.rs"], flags=re.M)
    files["Cargo.toml"] = files["Cargo.toml"].replace('["cdylib", "staticlib", "rlib"]', '["rlib"]')
    files["Cargo.toml"] += "\n[profile.release.package.luxfer]\ndebug = false\n"
    for path, content in (binary | {path: text.encode() for path, text in files.items()}).items():
        file = COPY / path
        if not file.exists() or code_of(file.read_bytes()) != code_of(content):
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)


def build(benches: set[str]) -> dict[str, str]:
    """Builds benches of the copy, and returns the paths of their programs."""
    command = ["cargo", "bench", "--no-run", "--message-format=json"]
    for name in sorted(benches):
        command += ["--bench", name]
    done = subprocess.run(
        command, cwd=COPY, env=os.environ | {"CARGO_TARGET_DIR": str(BUILD)}, stdout=subprocess.PIPE, text=True
    )
    if done.returncode:
        for line in done.stdout.splitlines():
            message = json.loads(line).get("message") or {}
            if message.get("level") == "error":
                print(message["rendered"], file=sys.stderr)
        sys.exit("the copy does not compile")
    found = (json.loads(line) for line in done.stdout.splitlines())
    return {m["target"]["name"]: m["executable"] for m in found if m.get("executable")}


def run(program: str, bench: str, changed: str) -> list[str]:
    """Lines that a bench prints, with constants changed."""
    environment = os.environ | {"LUXFER_CONSTANTS": changed}
    environment.setdefault("LUXFER_TEST_DATA", str(ROOT / "../shared/data"))
    command = [program, *bench.split(":")[1:]]
    done = subprocess.run(command, cwd=COPY, env=environment, stdout=subprocess.PIPE, text=True)
    failed = [f"figure failed {done.returncode} code"] if done.returncode else []
    return done.stdout.splitlines() + failed


def figures(lines: list[str]) -> dict[str, str]:
    found = (re.fullmatch(r"figure (\S+) (\S+) .+", line) for line in lines)
    return {match[1]: match[2] for match in found if match}


def settings(constant: str, factors: list[str]) -> list[tuple[str, str]]:
    """The runs of a constant: the entry of the table, and the entry of the environment variable."""
    name, is_given, values = constant.partition("=")
    if is_given:
        return [(f"= {value}", f"{name}={value}") for value in values.split(",")]
    return [(f"× {factor}", f"{name}*{factor}") for factor in factors]


def measure(bench: str, program: str, untouched: pathlib.Path | None, constants: list[str], factors: list[str]) -> None:
    """Prints the table of one bench."""
    first, second = run(program, bench, ""), run(program, bench, "")
    stable = {n: v for n, v in figures(first).items() if figures(second).get(n) == v and v != "absent"}
    text = set(first) & set(second)
    if untouched:
        theirs = figures(run(str(untouched / bench.split(":")[0]), bench, ""))
        if different := [n for n, v in stable.items() if theirs.get(n) != v]:
            sys.exit(f"{bench}: figures of the copy differ from those of the untouched tree: {different}")
        print(f"{bench}: {len(stable)} figures are equal to those of the untouched tree")
    print(f"\n### `{bench}`\n\n| constant | changed | " + " | ".join(f"`{n}`" for n in stable) + " | lines |")
    print("|---|---|" + "---|" * (len(stable) + 1))
    print("| none | | " + " | ".join(stable.values()) + f" | 0 of {len(text)} |", flush=True)
    for constant in constants:
        for shown, entry in settings(constant, factors):
            lines = run(program, bench, entry)
            found = figures(lines)
            cells = ["=" if found.get(n) == v else found.get(n, "absent") for n, v in stable.items()]
            cells.append(str(len(text - set(lines))))
            name = constant.split("=")[0].removeprefix("src/")
            print(f"| `{name}` | {shown} | " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("constants", nargs="*", metavar="CONSTANT")
    parser.add_argument("--bench", action="append", default=[], metavar="NAME[:SECTION...]")
    parser.add_argument("--factors", default="0.5,2")
    parser.add_argument("--untouched", type=pathlib.Path, metavar="FOLDER")
    asked = parser.parse_args()
    names = [re.sub(r"\[\d+\]$", "", constant.split("=")[0]) for constant in asked.constants]
    earlier = json.loads(REPLACED.read_text()) if REPLACED.exists() else []
    replaced = list(dict.fromkeys([*earlier, *names]))
    write_copy(replaced)
    REPLACED.write_text(json.dumps(replaced))
    programs = build({bench.split(":")[0] for bench in asked.bench})
    for bench in asked.bench:
        measure(bench, programs[bench.split(":")[0]], asked.untouched, asked.constants, asked.factors.split(","))


main()
