"""The command line of lighting design: `luxfer.design.main(argv)`."""

from __future__ import annotations

from collections.abc import Sequence


def main(argv: Sequence[str]) -> int:
    """Checks a room with luminaires, or solves for their dimmers, and writes reports, as `luxfer design` does with the
    same words. Returns its exit code: 0 if all requirements pass, 6 if not.

    >>> main(["--places"])
    34.2    office: writing, typing, reading, data processing
            school: entrance halls
            school: circulation areas, corridors
            school: stairs
            library: reading areas
    0
    """
    from ..cli import main as luxfer

    return luxfer(["design", *argv])
