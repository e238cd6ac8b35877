"""Finds and loads the library, and gives its functions their types."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path

from . import _abi

NAME = {"darwin": "libluxfer.dylib", "win32": "luxfer.dll"}.get(sys.platform, "libluxfer.so")


def _candidates() -> list[str]:
    """The paths at which to look for the library: LUXFER_LIBRARY if it is set, else wheel, source tree and system."""
    if named := os.environ.get("LUXFER_LIBRARY"):
        return [named]
    here = Path(__file__).resolve().parent
    places = [here / NAME]
    if (here.parents[2] / "include" / "luxfer.h").exists():
        places.append(here.parents[2] / "target" / "release" / NAME)
    return [str(p) for p in places if p.exists()] + [f"libluxfer.so.{_abi.LUXFER_VERSION_MAJOR}.{_abi.LUXFER_VERSION_MINOR}"]


def _load() -> ctypes.CDLL:
    failures = []
    for path in _candidates():
        try:
            library = ctypes.CDLL(path)  # CDLL releases the interpreter's lock during every call
        except OSError as error:
            failures.append(f"{path}: {error}")
            continue
        missing = [name for name in _abi.FUNCTIONS if not hasattr(library, name)]
        if missing:
            failures.append(f"{path}: lacks {missing[0]}; it is of another version than this package")
            continue
        for name, (result, arguments) in _abi.FUNCTIONS.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, [kind for _, kind in arguments]
        version = library.luxfer_get_version()
        if version // 100 != (10000 * _abi.LUXFER_VERSION_MAJOR + 100 * _abi.LUXFER_VERSION_MINOR) // 100:
            failures.append(f"{path}: is version {library.luxfer_get_version_string().decode()}")
            continue
        return library
    raise ImportError(
        "the luxfer library could not be loaded; build it with `cargo build --release`, or name it in LUXFER_LIBRARY.\n"
        + "\n".join(failures)
    )


library = _load()
