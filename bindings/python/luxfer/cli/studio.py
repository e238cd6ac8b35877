"""Start the studio: photo, strokes, scene and picture in a window."""

from __future__ import annotations

import argparse

from .console import Console
from .exits import Exit

SUMMARY = "start the studio, where masks and lamps can be seen and changed"


def add(parser: argparse.ArgumentParser) -> None:
    """Adds one option that takes all arguments."""
    parser.add_argument("arguments", nargs="*", help="see `luxfer studio --help`")


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Starts the studio."""
    return Exit(start(args.arguments))


def start(argv: list[str]) -> int:
    """Passes the arguments to `luxfer.studio` and returns its exit code."""
    from ..studio import main

    return main(argv)
