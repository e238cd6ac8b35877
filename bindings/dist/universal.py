"""Universal libraries for macOS: one file with the code for several kinds of processors.

    universal.py join OUT LIBRARY...    joins libraries, each for one kind of processor, as Apple's `lipo` does
    universal.py show LIBRARY           prints a line for each part: the processor, the name by which programs look for
                                        the library, and the libraries that it needs
"""

from __future__ import annotations

import struct
import sys
from pathlib import Path

#: The first bytes of a 64-bit Mach-O file, and of a universal file, whose numbers are big-endian.
MACH_O, UNIVERSAL = 0xFEEDFACF, 0xCAFEBABE
#: Each part begins at a multiple of 2^14, the size of a page on ARM.
ALIGNMENT = 14
#: Lengths of the header of a Mach-O file, and of the header of a universal file and of its entry for each part.
HEADER, TABLE, ENTRY = 32, 8, 20
PROCESSORS = {0x01000007: "x86_64", 0x0100000C: "arm64"}
#: Load commands: a needed library, and the library's own name.
LOAD_DYLIB, ID_DYLIB = 0xC, 0xD


def join(libraries: list[bytes]) -> bytes:
    entries, parts = b"", bytearray(TABLE + ENTRY * len(libraries))
    for library in libraries:
        magic, processor, version = struct.unpack_from("<III", library)
        if magic != MACH_O:
            raise SystemExit("not a 64-bit Mach-O file")
        offset = -(-len(parts) >> ALIGNMENT << ALIGNMENT)
        parts = parts.ljust(offset, b"\0") + library
        entries += struct.pack(">5I", processor, version, offset, len(library), ALIGNMENT)
    return struct.pack(">II", UNIVERSAL, len(libraries)) + entries + bytes(parts[TABLE + len(entries) :])


def split(library: bytes) -> list[bytes]:
    magic, count = struct.unpack_from(">II", library)
    if magic != UNIVERSAL:
        raise SystemExit("not a universal file")
    places = [struct.unpack_from(">5I", library, TABLE + ENTRY * k)[2:4] for k in range(count)]
    return [library[offset : offset + length] for offset, length in places]


def show(library: bytes) -> str:
    """The line for one part."""
    _, processor, _, _, commands, *_ = struct.unpack_from("<8I", library)
    names: dict[int, list[str]] = {LOAD_DYLIB: [], ID_DYLIB: []}
    at = HEADER
    for _ in range(commands):
        kind, length = struct.unpack_from("<II", library, at)
        if kind in names:
            (start,) = struct.unpack_from("<I", library, at + 8)
            names[kind].append(library[at + start : at + length].rstrip(b"\0").decode())
        at += length
    return " ".join([PROCESSORS.get(processor, "unknown"), *names[ID_DYLIB], "needs", *sorted(names[LOAD_DYLIB])])


def main(arguments: list[str]) -> None:
    match arguments:
        case ["join", out, *libraries] if libraries:
            Path(out).write_bytes(join([Path(path).read_bytes() for path in libraries]))
            Path(out).chmod(0o755)
        case ["show", library]:
            print("\n".join(show(part) for part in split(Path(library).read_bytes())))
        case _:
            raise SystemExit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
