"""Writes the bill of materials of the library for a target, as CycloneDX 1.5 in JSON, to standard output.

    sbom.py TRIPLE    such as x86_64-unknown-linux-gnu

It lists the crates that are linked into the library, with their versions, licences and checksums, and Rust's standard
library. Crates that only run while the library is built (macros, build scripts, tests) are not in it. Equal sources
and an equal compiler give an equal text: it has neither time nor serial number.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
CARGO = os.environ.get("CARGO", "cargo")


def metadata(triple: str) -> dict:
    command = [CARGO, "metadata", "--format-version", "1", "--locked", "--filter-platform", triple]
    return json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout)


def named_by_tree(triple: str) -> set[tuple[str, str]]:
    """Names and versions of the linked crates. Only `cargo tree` chooses features as a build without tests does."""
    command = [CARGO, "tree", "--locked", "--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}", "--target", triple]
    tree = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return set(re.findall(r"^(\S+) v(\S+)", tree, re.M))


def linked(data: dict, triple: str) -> dict[str, list[str]]:
    """The identifiers of the linked packages, and of the packages that each of them needs."""
    named = named_by_tree(triple)
    chosen = {package["id"] for package in data["packages"] if (package["name"], package["version"]) in named}
    needs = {}
    for node in data["resolve"]["nodes"]:
        if node["id"] in chosen:
            normal = (d["pkg"] for d in node["deps"] if any(kind["kind"] is None for kind in d["dep_kinds"]))
            needs[node["id"]] = sorted(i for i in normal if i in chosen)
    return needs


def checksums() -> dict[tuple[str, str], str]:
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text())
    return {(p["name"], p["version"]): p["checksum"] for p in lock["package"] if "checksum" in p}


def reference(package: dict) -> str:
    return f"pkg:cargo/{package['name']}@{package['version']}"


def component(package: dict, sums: dict[tuple[str, str], str]) -> dict:
    entry = {
        "type": "library",
        "bom-ref": reference(package),
        "name": package["name"],
        "version": package["version"],
        "purl": reference(package),
    }
    if licence := package["license"]:
        # Old packages write a slash, which SPDX spells OR.
        entry["licenses"] = [{"expression": re.sub(r"\s*/\s*", " OR ", licence)}]
    if checksum := sums.get((package["name"], package["version"])):
        entry["hashes"] = [{"alg": "SHA-256", "content": checksum}]
    return entry


def standard_library() -> dict:
    text = subprocess.run(["rustc", "--version", "--verbose"], check=True, capture_output=True, text=True).stdout
    version = re.search(r"^release: (\S+)$", text, re.M)[1]
    return {
        "type": "library",
        "bom-ref": f"rust-std@{version}",
        "name": "rust-std",
        "version": version,
        "licenses": [{"expression": "MIT OR Apache-2.0"}],
    }


def bill(triple: str) -> dict:
    data = metadata(triple)
    packages = {package["id"]: package for package in data["packages"]}
    needs, sums, std = linked(data, triple), checksums(), standard_library()
    root = data["resolve"]["root"]
    own = component(packages[root], sums)
    own["properties"] = [{"name": "target", "value": triple}]
    others = sorted((component(packages[i], sums) for i in needs if i != root), key=lambda entry: entry["bom-ref"])
    edges = [{"ref": reference(packages[i]), "dependsOn": sorted(reference(packages[j]) for j in needs[i])} for i in needs]
    next(edge for edge in edges if edge["ref"] == own["bom-ref"])["dependsOn"].append(std["bom-ref"])
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": own},
        "components": [*others, std],
        "dependencies": sorted(edges, key=lambda edge: edge["ref"]),
    }


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    print(json.dumps(bill(sys.argv[1]), indent=2))
