"""Programs of calls to the C ABI as plain data, so that they can be saved, mutated, reduced and played again.

A program is a list of calls; a call is [function, argument...]. The arguments:

    ["number", n]              the number n, by value
    ["callback", name]         a callback of player.py
    ["null"]                   NULL
    ["object", k]              the handle with the number k; NULL if it was never created, or is released
    ["handles", [argument...]] pointer to handles, each an object or NULL
    ["new", k]                 pointer to where the call writes a new handle, which gets the number k
    ["bytes", hex]             pointer to these bytes (a text or a file), followed by a zero byte
    ["array", type, [n...]]    pointer to numbers of a ctypes type
    ["room", byte]             pointer to memory for results, filled with this byte
    ["struct", name, {field: argument}, base]   pointer to a struct; base is "init" (the defaults) or "raw" (zeros)
    ["junk", offset]           pointer to memory that holds no handle
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bindings" / "python"))

import generate  # noqa: E402

HEADER = generate.read(generate.header_text())
KINDS = set(HEADER.opaque)
STRUCTS = HEADER.structs
FUNCTIONS = {name: arguments for name, (_, arguments) in HEADER.functions.items()}
CALLBACKS = set(HEADER.callbacks)
#: The structs that luxfer_init fills, in the order of their types.
SETTINGS = list(HEADER.settings)

#: Bytes of memory behind every pointer to results, of arrays and of pixels: more than any call that is not a lie needs.
ROOM = 65536

Argument = list
Call = list


def plain(value) -> Argument:
    """Converts a Python value in a scenario to an argument."""
    if value is None:
        return ["null"]
    if isinstance(value, (int, float)):
        return ["number", value]
    if isinstance(value, str):
        return ["bytes", value.encode().hex()]
    if isinstance(value, bytes):
        return ["bytes", value.hex()]
    return value


def struct(kind: str, base: str = "init", /, **fields) -> Argument:
    return ["struct", f"luxfer_{kind}", {k: plain(v) for k, v in fields.items()}, base]


def report(kind: str) -> tuple[Argument, int]:
    """A struct for results, and a size larger than in any version, as a newer host may pass it."""
    return struct(kind, "raw"), 1024


def array(kind: str, *numbers) -> Argument:
    return ["array", kind, list(numbers)]


def view(width: int, height: int, channels: int = 3, fill: float = 0.5, **fields) -> Argument:
    """A view of a uniform image whose left half is darker."""
    pixels = [fill * (0.5 if 2 * x < width else 1) for y in range(height) for x in range(width) for _ in range(channels)]
    return struct(
        "image_view", width=width, height=height, channels=channels, byte_size=4 * len(pixels), data=array("float", *pixels), **fields
    )


def handles(*objects: Argument) -> Argument:
    return ["handles", list(objects)]


class Script:
    """Builds a program: `s.make("image_create", context, view)` adds a call and returns the object it creates."""

    def __init__(self) -> None:
        self.calls: list[Call] = []
        self.objects = 0

    def new(self) -> tuple[Argument, Argument]:
        self.objects += 1
        return ["new", self.objects], ["object", self.objects]

    def call(self, verb: str, *arguments) -> None:
        self.calls.append([f"luxfer_{verb}", *map(plain, arguments)])

    def make(self, verb: str, *arguments) -> Argument:
        place, thing = self.new()
        self.call(verb, *arguments, place)
        return thing

    def finish(self, job: Argument) -> None:
        """Adds calls that wait for a job and release it."""
        self.call("job_wait", job, 60_000, None, None, ["room", 0x5A])
        self.call("release", job)

    def run(self, verb: str, *arguments) -> None:
        self.finish(self.make(verb, *arguments))


def is_of_any_kind(field) -> bool:
    return field.type == "void" and field.name == "handle"


def is_handle(field) -> bool:
    return field.type in KINDS and field.stars == 1 or is_of_any_kind(field)


def makes(field) -> bool:
    return field.type in KINDS and field.stars == 2


def is_release(function: str) -> bool:
    return function == "luxfer_release"


def is_retain(function: str) -> bool:
    return function == "luxfer_retain"
