"""Encodes calls of the C ABI as bytes, for the fuzz target `calls`.

    python3 calls.py     prints the decoder's table of functions in Rust, which src/calls.rs includes

`table` makes this table from include/luxfer.h; `Program` encodes programs (tests/conformance/script.py) as bytes that
the decoder reads. A call is the index of its function in two bytes and then its arguments; src/calls.rs defines how
each kind of argument is read.
"""

from __future__ import annotations

import struct
import sys
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "conformance"))

import script  # noqa: E402

#: The fuzzed functions in the header's order: all that return a status.
NAMES = [name for name, (result, _) in script.HEADER.functions.items() if result == "luxfer_status"]
#: Formats of `struct` for the types of numbers; all other types are enumerations, which are int32_t.
FORMATS = {"float": "<f", "double": "<d", "uint64_t": "<Q", "size_t": "<Q"}
#: Exclusive upper bounds for parameters that state a size of memory, by the ends of their names: the library cannot
#: check these sizes, so the fuzzer must not overstate them.
BOUNDS = {"count": 257, "capacity": 257, "size": script.ROOM + 1, "stride": 256, "num_threads": 4}
#: Paths of the files that calls read and write, in the fuzzer's working folder.
PATHS = ["", "no/such/place/a.png", *(f"{name}.{ending}" for name in "ab" for ending in ("png", "exr", "glb", "ldt", "ies", "xml", "gldf", "csv"))]
PATHS += ["layers.exr", "part0.exr", "part1.exr", "lamps.csv", "a.gldf#0", "day.epw"]
#: Maximum number of bytes of an array in the encoded calls; the decoder repeats them to fill its memory.
MAX_BYTES = 192


def is_record(kind: str) -> bool:
    """Whether a type is a struct that begins with its size."""
    return kind in script.STRUCTS and script.STRUCTS[kind][0].name == "struct_size"


def bound(name: str) -> int:
    return next((limit for end, limit in BOUNDS.items() if name.endswith(end)), 0)


def width(kind: str) -> int:
    return struct.calcsize(FORMATS.get(kind, "<I"))


def number(kind: str, value: float) -> bytes:
    form = FORMATS.get(kind, "<I")
    return struct.pack(form, float(value) if form in ("<f", "<d") else int(value) % (1 << 8 * width(kind)))


@dataclass
class Program:
    """Encodes a program. `held` mirrors the state of the decoder: the references to each kind of handle, oldest
    first."""

    held: dict[str, list[int]] = field(default_factory=dict)

    def any_kind(self) -> list[tuple[str, int]]:
        """All references with their kinds, in the order of src/calls.rs."""
        return [(kind, n) for kind in sorted(self.held) for n in self.held[kind]]

    def encode(self, calls: list[script.Call]) -> bytes:
        out = b""
        for function, *arguments in calls:
            if function in NAMES:
                out += struct.pack("<H", NAMES.index(function))
                out += b"".join(self.argument(function, f, a) for f, a in zip(script.FUNCTIONS[function], arguments))
        return out

    def argument(self, function: str, f: script.generate.Field, given: script.Argument) -> bytes:
        kind, *rest = given
        if script.makes(f):
            self.held.setdefault(f.type, []).append(rest[0])
            return b""
        if script.is_handle(f):
            things = self.any_kind() if script.is_of_any_kind(f) else [(f.type, n) for n in self.held.get(f.type, [])]
            found = [i for i, (_, n) in enumerate(things) if kind != "null" and n == rest[0]]
            if not found:
                return bytes([250])
            held = self.held[things[found[0]][0]]
            if script.is_release(function):
                held.remove(rest[0])
            elif script.is_retain(function):
                held.append(rest[0])
            return bytes([found[0]])
        if f.type in script.CALLBACKS:
            return bytes([0 if kind == "null" else 1 if rest[0] in ("go", "write", "work") else 2])
        if not f.stars:
            return b"".join(number(f.type, n) for n in (rest[1] if kind == "array" else rest))
        if f.name == "path":
            return bytes([255 if kind == "null" else PATHS.index(bytes.fromhex(rest[0]).decode())])
        if is_record(f.type):
            return self.record(*rest) if kind == "struct" else bytes([0])
        if kind == "struct" and f.type == "void":  # a struct of any type, which the call fills
            return struct.pack("<H", 0)
        if kind == "struct":
            raise SystemExit(f"{function}: {f.name} has no struct_size")
        if kind in ("null", "room"):
            return struct.pack("<H", 0xFFFF if kind == "null" else 0)
        content = bytes.fromhex(rest[0]) if kind == "bytes" else b"".join(number(rest[0], n) for n in rest[1])[:MAX_BYTES]
        return struct.pack("<H", len(content)) + content

    def record(self, name: str, fields: dict, base: str) -> bytes:
        members = {f.name: (i, f) for i, f in enumerate(script.STRUCTS[name])}
        out = bytes([["null", "raw", "init"].index(base), len(fields)])
        for key, value in fields.items():
            at, member = members[key]
            out += bytes([at]) + self.argument(name, member, value)
        return out


# ------------------------------------------------------------------------------------------------------------ the table


def expression(function: str, f: script.generate.Field) -> str:
    """The Rust expression that reads an argument."""
    if script.makes(f):
        return f'a.made("{f.type}").cast()'
    if script.is_handle(f):
        if script.is_of_any_kind(f):
            return f"a.{'given_back' if script.is_release(function) else 'retained' if script.is_retain(function) else 'any'}().cast()"
        return f'a.handle("{f.type}").cast()'
    if f.type in script.CALLBACKS:
        return f"a.{f.type.removeprefix('luxfer_').removesuffix('_fn')}()"
    if not f.stars:
        return "a.patience()" if f.name == "timeout_ms" else f"a.below({bound(f.name)})" if bound(f.name) else "a.number()"
    if f.type == "char" and f.name != "buffer":
        return "a.path()" if f.name == "path" else "a.text()"
    return f"a.record(&{f.type.upper()}).cast()" if is_record(f.type) else "a.memory().cast()"


def member(f: script.generate.Field) -> str:
    """The Rust expression for a `Member` of a struct."""
    if not f.stars:
        count = 1
        for n in f.dims:
            count *= n
        return f"Member::Number({count * width(f.type)}, {bound(f.name) if not f.dims else 0})"
    if f.type == "char":
        return "Member::Text"
    return f"Member::Record(&{f.type.upper()})" if is_record(f.type) else "Member::Memory"


def table() -> str:
    out = ["use luxfer::ffi::*;"]
    for name, members in script.STRUCTS.items():
        if is_record(name):
            settings = script.HEADER.settings.get(name)
            init = f"Some(|p| unsafe {{ luxfer_init({settings}, p.cast(), size_of::<{name}>()) }})" if settings else "None"
            places = ", ".join(f"(offset_of!({name}, {f.name}), {member(f)})" for f in members)
            out.append(f"static {name.upper()}: Record = Record {{ size: size_of::<{name}>(), init: {init}, members: &[{places}] }};")
    out.append("static CALLS: &[(&str, fn(&mut Arguments) -> luxfer_status)] = &[")
    for name in NAMES:
        arguments = ", ".join(expression(name, f) for f in script.FUNCTIONS[name])
        out.append(f'    ("{name}", |a| unsafe {{ {name}({arguments}) }}),')
    paths = ", ".join(f'c"{path}"' for path in PATHS)
    return "\n".join([*out, "];", f"static PATHS: &[&CStr] = &[{paths}];"])


if __name__ == "__main__":
    print(table())
