"""Writes the list of the crates in the library as `cargo auditable` embeds it into programs: JSON packed by zlib, for
the section `.dep-v0`. `cargo audit bin`, trivy and other scanners find it there and look for known vulnerabilities.

    auditable.py BILL OUT    BILL is the bill of materials by sbom.py
    auditable.py LIBRARY     prints the list in a library (ELF) as names and versions
"""

from __future__ import annotations

import json
import sys
import zlib
from pathlib import Path

SECTION = ".dep-v0"


def packages(bill: dict) -> list[dict]:
    """The packages in the order of their names; dependencies are indices in this list."""
    own = bill["metadata"]["component"]
    crates = [own, *(c for c in bill["components"] if c["bom-ref"].startswith("pkg:cargo/"))]
    crates.sort(key=lambda crate: (crate["name"], crate["version"]))
    indices = {crate["bom-ref"]: k for k, crate in enumerate(crates)}
    needs = {edge["ref"]: edge["dependsOn"] for edge in bill["dependencies"]}
    out = []
    for crate in crates:
        entry = {"name": crate["name"], "version": crate["version"], "source": "local" if crate is own else "crates.io"}
        if found := sorted(indices[ref] for ref in needs.get(crate["bom-ref"], []) if ref in indices):
            entry["dependencies"] = found
        if crate is own:
            entry["root"] = True
        out.append(entry)
    return out


def read(library: Path) -> list[dict]:
    from elftools.elf.elffile import ELFFile  # auditwheel needs it too

    with open(library, "rb") as file:
        section = ELFFile(file).get_section_by_name(SECTION)
        if section is None:
            raise SystemExit(f"{library} has no section {SECTION}")
        return json.loads(zlib.decompress(section.data()))["packages"]


def main(arguments: list[str]) -> None:
    match arguments:
        case [bill, out]:
            content = {"packages": packages(json.loads(Path(bill).read_text()))}
            Path(out).write_bytes(zlib.compress(json.dumps(content, separators=(",", ":")).encode(), 9))
        case [library]:
            print("\n".join(f"{p['name']} {p['version']}" for p in read(Path(library))))
        case _:
            raise SystemExit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
