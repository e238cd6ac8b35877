"""Programs of calls to the C ABI as plain data, so that they can be written to a file, mutated, cut and played again.

A program is a list of calls, a call [function, argument...]. Arguments:

    ["number", n]              by value; also for callbacks: ["callback", name], see player.py
    ["null"]                   NULL
    ["object", k]              the handle that was made under the number k; NULL if it was not, or is released
    ["new", k]                 where a handle is to be put, which then has the number k
    ["bytes", hex]             text or a file: these bytes, and a zero behind them
    ["array", type, [n...]]    numbers of a ctypes type
    ["room", byte]             memory for results, filled with that byte
    ["struct", name, {field: argument}, base]   base is "init" (the defaults) or "raw" (zeros)
    ["junk", offset]           memory that holds no handle
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
    """What a scenario writes, as an argument."""
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
    """A struct for results, and its size: more than any version has, as a newer host may pass."""
    return struct(kind, "raw"), 1024


def array(kind: str, *numbers) -> Argument:
    return ["array", kind, list(numbers)]


def view(width: int, height: int, channels: int = 3, fill: float = 0.5, **fields) -> Argument:
    """An image of one colour, its left half darker."""
    pixels = [fill * (0.5 if 2 * x < width else 1) for y in range(height) for x in range(width) for _ in range(channels)]
    return struct(
        "image_view", width=width, height=height, channels=channels, byte_size=4 * len(pixels), data=array("float", *pixels), **fields
    )


class Script:
    """Writes a program: `s.make("image_create", context, view)` adds the call, and gives the object."""

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
        """Waits for a job, and lets go of it."""
        self.call("job_wait", job, 60_000, None, None)
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
