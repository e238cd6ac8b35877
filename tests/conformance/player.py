"""Plays programs (script.py) in this process and checks for every call what the header promises for all calls:

- The call returns a status other than LUXFER_INTERNAL and LUXFER_UNKNOWN.
- If the call fails, its outputs are unchanged and the context has a message.
- If the call succeeds, every handle that it creates is set.
- The call returns soon, unless it is asked to wait.

    python3 player.py FILE JOURNAL

Each line of FILE is a program: {"threads": n, "calls": [...]}. Before each call, the player writes the numbers of the
program and the call to JOURNAL, so that after a crash the call is known. The exit code is 0, or 3 for a broken
promise, which is then in the last line of JOURNAL.
"""

from __future__ import annotations

import ctypes
import json
import os
import resource
import sys
import threading
import time

from script import CALLBACKS, FUNCTIONS, ROOM, STRUCTS, is_handle, is_release, is_retain, makes

from luxfer import _abi as abi
from luxfer._library import library as typed

#: The library again, with types of its own: the package's functions in this process keep theirs.
library = ctypes.CDLL(typed._name)

TYPES = {
    "float": ctypes.c_float,
    "double": ctypes.c_double,
    "uint32_t": ctypes.c_uint32,
    "int32_t": ctypes.c_int32,
    "uint64_t": ctypes.c_uint64,
    "size_t": ctypes.c_size_t,
    "char": ctypes.c_char,
    "void": ctypes.c_char,
}

#: Bytes looked at behind arguments for results.
RESULTS = {"new": ctypes.sizeof(ctypes.c_void_p), "room": 4096}

#: Longest that a call which does not wait may take, in seconds; generous, as machines may be busy.
PATIENCE = 20.0

#: Address space in bytes: what asks for more has to be refused, not to end the process or the machine.
MEMORY = 6 << 30

for name, (result, arguments) in abi.FUNCTIONS.items():
    # Pass pointers as plain addresses, without conversion by ctypes.
    is_pointer = [hasattr(t, "contents") or t is ctypes.c_char_p for _, t in arguments]
    function = getattr(library, name)
    function.restype = result
    function.argtypes = [ctypes.c_void_p if p else t for p, (_, t) in zip(is_pointer, arguments)]


class Broken(Exception):
    """A promise of the header that was not kept."""


def address(thing) -> int:
    return ctypes.addressof(thing)


class Player:
    """State of a program that is played: its objects, and the memory that its calls use."""

    def __init__(self, journal) -> None:
        self.journal = journal
        self.handles: dict[int, tuple[str, int, int]] = {}  # number: kind, address, references
        self.contexts: list[int] = []
        self.kept: list = []  # memory that calls have used; it is kept as long as the program runs
        self.ticks = 0
        self.callbacks = {
            "go": abi.luxfer_progress_fn(lambda user, fraction: 0),
            "cancel": abi.luxfer_progress_fn(lambda user, fraction: 1),
            "later": abi.luxfer_progress_fn(self.cancel_later),
            "again": abi.luxfer_progress_fn(self.call_again),
            "write": abi.luxfer_write_fn(lambda user, data, size: 0),
            "refuse": abi.luxfer_write_fn(lambda user, data, size: 1),
            "work": abi.luxfer_work_fn(lambda user: abi.LUXFER_OK),
            "fail": abi.luxfer_work_fn(lambda user: abi.LUXFER_FORMAT),
        }

    # ------------------------------------------------------------------------------------------------- callbacks

    def cancel_later(self, user, fraction) -> int:
        self.ticks += 1
        return int(self.ticks % 3 == 0)

    def call_again(self, user, fraction) -> int:
        """Progress callback that calls the library: a callback may call any function."""
        self.ticks += 1
        for kind, handle, _ in list(self.handles.values()):
            if kind == "luxfer_job":
                library.luxfer_job_get_progress(handle, ctypes.addressof(ctypes.c_double()))
            elif kind == "luxfer_image":
                library.luxfer_image_get_size(handle, None, None, None)
        return int(self.ticks > 50)

    # -------------------------------------------------------------------------------------------------- arguments

    def memory(self, thing):
        self.kept.append(thing)
        return address(thing)

    def struct(self, name: str, fields: dict, base: str) -> int:
        kind = getattr(abi, name)
        # More memory than the struct, because its size field may state more.
        room = ctypes.create_string_buffer(ROOM)
        value = kind.from_buffer(room)
        if base == "init":
            library.luxfer_init(kind.struct_type, address(value), ctypes.sizeof(kind))
        self.kept.append((room, value))
        members = {f.name: f for f in STRUCTS[name]}
        for field, argument in fields.items():
            member = members[field]
            if member.stars:
                # Write the address itself, whatever type ctypes has for the member.
                at = getattr(kind, field).offset
                ctypes.c_void_p.from_buffer(room, at).value = self.value(argument)
            elif member.dims:
                element, numbers = type(getattr(value, field)), argument[2]
                while issubclass(element, ctypes.Array):
                    element = element._type_
                place = (element * len(numbers)).from_buffer(room, getattr(kind, field).offset)
                place[:] = numbers
            else:
                setattr(value, field, argument[1])
        return address(value)

    def value(self, argument):
        """Converts an argument of a program to the value that is passed to the C function."""
        kind, *rest = argument
        if kind == "number":
            return rest[0]
        if kind == "null":
            return None
        if kind == "callback":
            return self.callbacks[rest[0]]
        if kind == "object":
            known = self.handles.get(rest[0])
            return known[1] if known else None
        if kind == "handles":
            handles = (ctypes.c_void_p * (ROOM // ctypes.sizeof(ctypes.c_void_p)))()
            handles[: len(rest[0])] = [self.value(handle) for handle in rest[0]]
            return self.memory(handles)
        if kind == "new":
            return self.memory(ctypes.c_void_p(0))
        if kind == "bytes":
            return self.memory(ctypes.create_string_buffer(bytes.fromhex(rest[0])))
        if kind == "array":
            numbers = (TYPES[rest[0]] * max(ROOM // ctypes.sizeof(TYPES[rest[0]]), len(rest[1])))()
            numbers[: len(rest[1])] = rest[1]
            return self.memory(numbers)
        if kind == "room":
            return self.memory(ctypes.create_string_buffer(bytes([rest[0]]) * ROOM, ROOM))
        if kind == "struct":
            return self.struct(*rest)
        if kind == "junk":
            return self.memory(ctypes.create_string_buffer(b"\xde\xad\xbe\xef" * 64, 256)) + rest[0]
        raise ValueError(f"no such argument: {argument}")

    # ------------------------------------------------------------------------------------------------------ calls

    def message(self, context: int) -> bytes:
        buffer = ctypes.create_string_buffer(4096)
        library.luxfer_context_get_last_error(context, address(buffer), 4096, None)
        return buffer.value

    def call(self, call, may_release: bool = True) -> None:
        function, *arguments = call
        fields = FUNCTIONS[function]
        releases = is_release(function)
        if releases and not may_release:
            return
        values = [self.value(a) for a in arguments]
        # ctypes needs a null function pointer, not None, for a missing callback.
        handed = [
            getattr(abi, f.type)() if f.type in CALLBACKS and v is None else v
            for v, f in zip(values, fields)
        ]
        results = [(v, ctypes.string_at(v, RESULTS[a[0]])) for v, a in zip(values, arguments) if a[0] in RESULTS]
        owner = self.handles.get(arguments[0][1]) if arguments and values[0] and arguments[0][0] == "object" else None
        start = time.monotonic()
        status = getattr(library, function)(*handed)
        taken = time.monotonic() - start
        if not isinstance(status, int) or function == "luxfer_get_version":
            return
        if not 0 <= status <= 13 or status in (abi.LUXFER_INTERNAL, abi.LUXFER_UNKNOWN):
            raise Broken(f"{function} returned {status}: {[self.message(c) for c in self.contexts]}")
        # A cancelled job ends within about 100 ms, so no call except waiting takes long.
        if taken > PATIENCE and function != "luxfer_job_wait":
            raise Broken(f"{function} took {taken:.1f} s")
        first = fields[0] if fields else None
        if status != abi.LUXFER_OK:
            for v, before in results:
                if ctypes.string_at(v, len(before)) != before:
                    raise Broken(f"{function} returned {status} and wrote a result")
            asks = function == "luxfer_context_get_last_error"
            if owner and owner[0] == first.type and not asks and not any(self.message(c) for c in self.contexts):
                raise Broken(f"{function} returned {status} without a message")
            return
        for v, a, f in zip(values, arguments, fields):
            if makes(f) and a[0] == "new":
                handle = ctypes.c_void_p.from_address(v).value
                if not handle:
                    raise Broken(f"{function} succeeded and made nothing")
                self.handles[a[1]] = (f.type, handle, 1)
                if f.type == "luxfer_context":
                    self.contexts.append(handle)
        if first and is_handle(first) and arguments[0][0] == "object" and arguments[0][1] in self.handles:
            kind, handle, count = self.handles[arguments[0][1]]
            count += is_retain(function) - releases
            self.handles[arguments[0][1]] = (kind, handle, count)
            if not count:
                del self.handles[arguments[0][1]]
                if kind == "luxfer_context":
                    self.contexts.remove(handle)

    def play(self, calls, threads: int, number: int) -> None:
        """Plays the calls, distributed over `threads` threads; with several threads, objects are released only at the
        end."""
        failures: list[BaseException] = []

        def some(thread: int) -> None:
            try:
                for i in range(thread, len(calls), threads):
                    os.pwrite(self.journal, f"{number:8} {i:8}\n".encode(), 18 * thread)
                    self.call(calls[i], may_release=threads == 1)
            except BaseException as failure:  # noqa: BLE001: the main thread raises it
                failures.append(failure)

        if threads == 1:
            some(0)
        else:
            workers = [threading.Thread(target=some, args=(t,)) for t in range(threads)]
            for worker in workers:
                worker.start()
            for worker in workers:
                worker.join()
        if failures:
            raise failures[0]
        self.release()

    def release(self) -> None:
        for kind, handle, count in sorted(self.handles.values(), key=lambda h: h[0] != "luxfer_job"):
            for _ in range(count):
                if library.luxfer_release(handle):
                    raise Broken(f"luxfer_release of a {kind} failed at the end")
        self.handles.clear()
        self.contexts.clear()
        self.kept.clear()


def main(file: str, journal: str) -> int:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    out = os.open(journal, os.O_RDWR | os.O_CREAT | os.O_TRUNC)
    with open(file) as lines:
        for number, line in enumerate(lines):
            program = json.loads(line)
            try:
                Player(out).play(program["calls"], program.get("threads", 1), number)
            except Broken as broken:
                os.lseek(out, 0, os.SEEK_END)
                os.write(out, f"{broken}\n".encode())
                return 3
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
