"""Prints what fills a library: the sizes of its sections, and of its functions and tables by crate.

    sizes.py LIBRARY [ROWS]    a library with its symbol table, such as target/release/libluxfer.so; ROWS crates, 20 by
                               default

A generic function counts for the crate whose name its symbol begins with, so most of `core` and `alloc` are sorts,
vectors and the like for types of luxfer.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter


def output(*command: str) -> list[str]:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def sections(library: str) -> Counter[str]:
    """Sizes in bytes of the sections that a stripped library keeps, without `.bss`, which is not in the file."""
    sizes: Counter[str] = Counter()
    for line in output("size", "-A", library):
        match = re.match(r"(\.\S+)\s+(\d+)", line)
        if match and not match[1].startswith((".debug", ".bss", ".tbss", ".comment")):
            sizes[match[1]] += int(match[2])
    return sizes


def crates(library: str) -> Counter[str]:
    """Sizes in bytes of functions and constants (nm's letters t, r and d) by crate."""
    sizes: Counter[str] = Counter()
    for line in output("nm", "-S", "--size-sort", "--radix=d", "-C", library):
        _, size, kind, name = line.split(" ", 3)
        if kind.lower() in "trdw":
            # `<alloc::vec::Vec<T> as ...>::f` and `luxfer_image_load` begin with the crate, behind any punctuation.
            crate = re.search(r"[A-Za-z]\w*", re.sub(r"\b(mut|dyn|const) ", "", name))
            sizes[re.sub(r"^luxfer_.*", "luxfer", crate[0]) if crate else "?"] += int(size)
    return sizes


def table(title: str, sizes: Counter[str], rows: int) -> None:
    total = sum(sizes.values())
    print(f"{title}: {total / 1e6:.2f} MB")
    for name, size in sizes.most_common(rows):
        print(f"  {name:24} {size / 1e6:6.2f} MB {100 * size / total:5.1f} %")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        raise SystemExit(__doc__)
    rows = int(sys.argv[2]) if len(sys.argv) == 3 else 20
    table("sections", sections(sys.argv[1]), rows)
    table("crates", crates(sys.argv[1]), rows)
