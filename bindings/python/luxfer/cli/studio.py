"""Start the studio: photo, strokes, scene and picture in a window."""

from __future__ import annotations

import argparse

from .console import Console
from .exits import Exit

SUMMARY = "start the studio, where masks and lamps can be seen and changed"


def add(parser: argparse.ArgumentParser) -> None:
    """All words are handed on."""
    parser.add_argument("arguments", nargs="*", help="see `luxfer studio --help`")


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Starts it."""
    return Exit(start(args.arguments))


def start(argv: list[str]) -> int:
    """Hands the words on to `luxfer.studio`; returns its exit code."""
    from ..studio import main

    return main(argv)
