"""Generates luxfer/_abi.py and luxfer/types.py from include/luxfer.h, so that both always agree with the library.

    python3 generate.py           rewrites both files
    python3 generate.py --check   if a file is out of date, names the first difference and exits with 1

cbindgen generates the header, so its form is regular: every item has one /** comment, a constant is a #define, and an
enumeration is a typedef of int32_t whose comment says "a LUXFER_X_ value". Anything in another form is an error and is
never skipped.
"""

from __future__ import annotations

import re
import sys
import textwrap
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
HEADER = HERE.parent.parent / "include" / "luxfer.h"

C_TYPES = {
    "int32_t": "c_int32",
    "uint32_t": "c_uint32",
    "uint64_t": "c_uint64",
    "size_t": "c_size_t",
    "float": "c_float",
    "double": "c_double",
}


@dataclass
class Field:
    """A member of a struct, or a parameter of a function."""

    name: str
    type: str  # without const and stars
    stars: int
    dims: list[int]
    doc: str = ""


@dataclass
class Header:
    """The declarations of the header, in their order."""

    constants: dict[str, int] = field(default_factory=dict)
    docs: dict[str, str] = field(default_factory=dict)
    sections: dict[str, str] = field(default_factory=dict)  # heading of each constant's section
    integers: list[str] = field(default_factory=list)  # typedefs of int32_t
    opaque: list[str] = field(default_factory=list)
    callbacks: dict[str, tuple[str, list[Field]]] = field(default_factory=dict)
    structs: dict[str, list[Field]] = field(default_factory=dict)
    functions: dict[str, tuple[str, list[Field]]] = field(default_factory=dict)

    @property
    def settings(self) -> dict[str, str]:
        """The structs that luxfer_init fills, and the constants of their types."""
        types = [name for name in self.constants if name.startswith("LUXFER_STRUCT_")]
        return {name.replace("LUXFER_STRUCT_", "luxfer_").lower(): name for name in types}


# ---------------------------------------------------------------------------------------------------------- reading


def uncomment(text: str) -> str:
    """The text of a /** comment, without the comment signs."""
    lines = [re.sub(r"^\s*\*? ?", "", line) for line in text.strip().removeprefix("/**").removesuffix("*/").split("\n")]
    return "\n".join(line.rstrip() for line in lines).strip()


def declaration(text: str, doc: str = "") -> Field:
    """Parses a declaration such as `const float *points` or `double corners[4][2]`."""
    match = re.fullmatch(r"(?:const )?(?:struct )?(\w+)\s*((?:\*\s*(?:const\s+)?)*)(\w+)((?:\[\d+\])*)", text.strip())
    if not match:
        raise SystemExit(f"cannot read the declaration {text!r}")
    kind, stars, name, dims = match.groups()
    return Field(name, kind, stars.count("*"), [int(n) for n in re.findall(r"\d+", dims)], doc)


def parameters(text: str) -> list[Field]:
    text = " ".join(text.split())
    declared = [] if text == "void" else [declaration(part) for part in text.split(",")]
    # An array as a parameter is a pointer.
    return [Field(f.name, f.type, f.stars + 1, []) if f.dims else f for f in declared]


def members(body: str) -> list[Field]:
    out = []
    for doc, text in re.findall(r"(?:/\*\*(.*?)\*/\s*)?([^;/]+);", body, re.S):
        out.append(declaration(" ".join(text.split()), uncomment(doc)))
    return out


ITEM = re.compile(
    r"/\* =+\n \* (?P<section>[^\n]+)\n.*?=+ \*/"
    r"|(?:/\*\*(?P<doc>(?:(?!\*/).)*)\*/\s*)?(?:"
    r"\#define (?P<constant>LUXFER_\w+) (?P<value>[^\n]+)"
    r"|typedef int32_t (?P<integer>\w+);"
    r"|typedef (?P<result>\w+) \(\*(?P<callback>\w+)\)\((?P<arguments>[^;]*)\);"
    r"|typedef struct (?P<opaque>\w+) \w+;"
    r"|typedef struct (?P<struct>\w+) \{(?P<body>.*?)\n\} \w+;"
    r"|(?:LUXFER_DEPRECATED\(\"[^\n]*\"\)\n)?(?P<returns>(?:const )?\w+ \**)(?P<function>luxfer_\w+)\((?P<parameters>[^;]*)\);)",
    re.S,
)


def header_text() -> str:
    """Reads luxfer.h and its parts, without the inline functions, which the library does not export."""
    text = re.sub(r'#include "(luxfer/\w+\.h)"', lambda m: (HEADER.parent / m[1]).read_text(), HEADER.read_text())
    return re.sub(r"\n/\*\* [^\n]* \*/\nstatic inline [^}]*\}\n", "", text)



def read(text: str) -> Header:
    header, section = Header(), ""
    for match in ITEM.finditer(text):
        item = match.groupdict()
        if item["section"]:
            section = item["section"]
            continue
        doc = uncomment(item["doc"] or "")
        if item["constant"] and item["value"].strip().lstrip("-").isdigit():
            header.constants[item["constant"]] = int(item["value"])
            header.sections[item["constant"]] = section
        elif item["integer"]:
            header.integers.append(item["integer"])
        elif item["callback"]:
            header.callbacks[item["callback"]] = item["result"], parameters(item["arguments"])
        elif item["opaque"]:
            header.opaque.append(item["opaque"])
        elif item["struct"]:
            header.structs[item["struct"]] = members(item["body"])
        elif item["function"]:
            header.functions[item["function"]] = item["returns"].strip(), parameters(item["parameters"])
        name = next((item[k] for k in ("constant", "integer", "callback", "opaque", "struct", "function") if item[k]), None)
        if name:
            header.docs[name] = doc
    declared = set(re.findall(r"^(?:luxfer_status|uint32_t|const char \*) ?\*?(luxfer_\w+)\(", text, re.M))
    if declared != set(header.functions):
        raise SystemExit(f"functions that were not understood: {declared ^ set(header.functions)}")
    return header


# ----------------------------------------------------------------------------------------------------- enumerations


def camel(name: str) -> str:
    return "".join(word.capitalize() for word in name.removeprefix("luxfer_").lower().strip("_").split("_"))


@dataclass
class Enumeration:
    """An enumeration, or a set of flags that has no type of its own."""

    name: str
    prefix: str
    is_flags: bool
    doc: str
    members: dict[str, str] = field(default_factory=dict)  # Python name: C name


def enumerations(header: Header) -> dict[str, Enumeration]:
    """The enumerations by C type, or by prefix for flags. A constant belongs to its longest matching prefix."""
    out = {"luxfer_status": Enumeration("Status", "LUXFER_", False, header.docs["luxfer_status"])}
    for name in header.integers[1:]:
        if name == "luxfer_struct_type":
            continue  # The package fills structs of settings itself.
        match = re.search(r"a\s+(LUXFER_\w+_)\s+(?:value|preset)", header.docs[name])
        if not match:
            raise SystemExit(f"the comment of {name} does not say which values it takes")
        out[name] = Enumeration(camel(name), match[1], False, header.docs[name])
    prose = "\n".join(list(header.docs.values()) + [f.doc for s in header.structs.values() for f in s])
    for prefix in sorted(set(re.findall(r"(LUXFER_[A-Z_]+_) flags", prose))):
        out[prefix] = Enumeration(
            camel(prefix.removeprefix("LUXFER_")), prefix, True, f"{prefix} flags, to be combined with |."
        )
    by_length = sorted(out.values(), key=lambda e: -len(e.prefix))
    for constant in header.constants:
        for e in by_length:
            if constant.startswith(e.prefix) and (e.name != "Status" or header.sections[constant] == "Status"):
                e.members[constant.removeprefix(e.prefix)] = constant
                break
    for e in out.values():
        if not e.members:
            raise SystemExit(f"{e.name} has no members")
    return out


# ---------------------------------------------------------------------------------------------------------- writing

BANNER = '''# Generated from include/luxfer.h by generate.py: do not edit.
"""{title}"""

from __future__ import annotations

'''


class Writer:
    """Writes the declarations of a header as Python code."""

    def __init__(self, header: Header):
        self.header = header
        self.enums = enumerations(header)
        self.is_output = set(header.structs) - set(header.settings)

    def prose(self, text: str) -> str:
        """Translates a comment of the header to the names of Python."""
        for e in self.enums.values():
            for name, constant in e.members.items():
                text = re.sub(rf"\b{constant}\b", f"{e.name}.{name}", text)
        for e in self.enums.values():
            if e.prefix != "LUXFER_":
                text = re.sub(rf"\b(?:a )?{e.prefix} (?:values?|flags|preset)\b", e.name, text)
        for struct in self.header.structs:
            text = re.sub(rf"\b{struct}\b", camel(struct), text)
        return text.replace("\\", "\\\\").replace("NULL", "None")

    def comment(self, text: str, indent: str) -> str:
        """Formats a comment of the header as a wrapped docstring."""
        text = re.sub(r"\s*Fill (it|them) [^.]*\.(?=$|\s)", "", " ".join(self.prose(text).split()))
        if not text:
            return ""
        return (
            textwrap.fill(f'"""{text}"""', 112, initial_indent=indent, subsequent_indent=indent, break_long_words=False) + "\n"
        )

    # -- _abi.py

    def c_type(self, f: Field) -> str:
        if f.type in C_TYPES or f.type in self.header.integers:
            base = C_TYPES.get(f.type, "c_int32")
        elif f.type == "char" and f.stars == 1:
            return "c_char_p"
        elif f.type == "void" and f.stars == 1:
            return "c_void_p"
        elif f.type in self.header.structs or f.type in self.header.opaque or f.type in self.header.callbacks:
            base = f.type
        else:
            raise SystemExit(f"there is no ctypes type for {f.type} of {f.name}")
        for _ in range(f.stars):
            base = f"POINTER({base})"
        for n in reversed(f.dims):
            base = f"{base} * {n}" if "*" not in base else f"({base}) * {n}"
        return base

    def abi(self) -> str:
        h, out = self.header, [BANNER.format(title="The C functions, structs and constants of luxfer.h, for ctypes.")]
        imports = "CFUNCTYPE, Structure, c_char_p, c_double, c_float, c_int32, c_size_t, c_uint32, c_uint64, c_void_p"
        out.append(f"from ctypes import {imports}\nfrom typing import Any\n\nfrom . import types\nfrom ._pointers import POINTER\n\n")
        out += [f"{name} = {value}\n" for name, value in h.constants.items()]
        out.append("\n")
        for name in h.opaque:
            out.append(f"\nclass {name}(Structure):\n{self.comment(h.docs[name], '    ')}\n")
        for name, (result, arguments) in h.callbacks.items():
            types = ", ".join([C_TYPES[result]] + [self.c_type(a) for a in arguments])
            out.append(f"\n{name} = CFUNCTYPE({types})\n")
        for name, fields in h.structs.items():
            out.append(f"\n\nclass {name}(Structure):\n{self.comment(h.docs[name], '    ')}\n    _fields_ = [\n")
            out += [f'        ("{f.name}", {self.c_type(f)}),\n' for f in fields]
            out.append("    ]\n")
            enums = [f'"{f.name}": types.{self.enums[f.type].name}' for f in fields if f.type in self.enums]
            enums += [f'"{f.name}": types.{e.name}' for f in fields for e in self.enums.values() if self.takes_flags(f, e)]
            if enums:
                out.append(f"    enumerations: dict[str, type] = {{{', '.join(enums)}}}\n")
            if name in self.is_output:
                out.append(f"    result = types.{camel(name)}\n")
            else:
                out.append(f"    struct_type = {h.settings[name]}\n")
        out.append(
            "\n\n#: What each function returns, and takes: names and types.\nFUNCTIONS: dict[str, tuple[Any, list[tuple[str, Any]]]] = {\n"
        )
        for name, (returns, arguments) in h.functions.items():
            result = "c_char_p" if "*" in returns else C_TYPES.get(returns, "c_int32")
            types = ", ".join(f'("{a.name}", {self.c_type(a)})' for a in arguments)
            out.append(f'    "{name}": ({result}, [{types}]),\n')
        out.append("}\n")
        return "".join(out)

    @staticmethod
    def takes_flags(f: Field, e: Enumeration) -> bool:
        return e.is_flags and f"{e.prefix} flags" in f.doc

    # -- types.py

    def annotation(self, f: Field) -> str:
        if f.type in self.enums and not f.stars:
            base = self.enums[f.type].name
        elif flags := [e.name for e in self.enums.values() if self.takes_flags(f, e)]:
            base = flags[0]
        elif f.type == "char":
            base = "str"
        elif f.type in self.header.structs:
            base = camel(f.type)
        elif f.type == "void":
            base = "int"
        else:
            base = "float" if f.type in ("float", "double") else "int"
        for n in reversed(f.dims):
            base = f"tuple[{', '.join([base] * n)}]" if n <= 4 else f"tuple[{base}, ...]"
        return base

    def input_annotation(self, f: Field) -> str:
        """The annotation of a setting: enumerations are also accepted by name, and arrays as any sequence."""
        base = self.annotation(f)
        if f.type in self.enums or any(self.takes_flags(f, e) for e in self.enums.values()):
            base = f"{base} | str | int"
        return f"Sequence[{self.annotation(Field(f.name, f.type, 0, []))}]" if f.dims else base

    def types(self) -> str:
        h = self.header
        title = "Enumerations, settings and reports of the library: what the functions of this package take and return."
        out = [BANNER.format(title=title)]
        out.append("from collections.abc import Sequence\nfrom dataclasses import dataclass\n")
        out.append("from enum import IntEnum, IntFlag\nfrom typing import TypedDict\n")
        for e in self.enums.values():
            out.append(
                f"\n\nclass {e.name}({'IntFlag' if e.is_flags else 'IntEnum'}):\n{self.comment(e.doc.split(': a LUXFER')[0].rstrip('.') + '.', '    ')}\n"
            )
            for name, constant in e.members.items():
                safe = name if name.isidentifier() else f"_{name}"
                out.append(f"    {safe} = {h.constants[constant]}\n{self.comment(h.docs[constant], '    ')}")
        for struct, fields in h.structs.items():
            fields = [f for f in fields if f.name not in ("struct_size", "reserved")]
            doc = self.comment(h.docs[struct], "    ")
            if struct in self.is_output:
                out.append(f"\n\n@dataclass(frozen=True)\nclass {camel(struct)}:\n{doc}\n")
                out += [f"    {f.name}: {self.annotation(f)}\n{self.comment(f.doc, '    ')}" for f in fields]
            else:
                out.append(f"\n\nclass {camel(struct)}(TypedDict, total=False):\n{doc}\n")
                out += [f"    {f.name}: {self.input_annotation(f)}\n{self.comment(f.doc, '    ')}" for f in fields]
        return "".join(out)


def main() -> int:
    writer = Writer(read(header_text()))
    status = 0
    for name, text in (("_abi.py", writer.abi()), ("types.py", writer.types())):
        path = HERE / "luxfer" / name
        if "--check" not in sys.argv:
            path.write_text(text)
        elif not path.exists() or path.read_text() != text:
            old = path.read_text().splitlines() if path.exists() else []
            new = text.splitlines()
            line = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), min(len(old), len(new)))
            print(f"{path.name}, line {line + 1}, is not what include/luxfer.h says; run generate.py", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
