"""Start the studio: photo, strokes, scene and picture in a window."""

from __future__ import annotations

import argparse
import importlib.util

from .console import Console
from .exits import Exit, failed

SUMMARY = "start the studio, where masks and lamps can be seen and changed"


def add(parser: argparse.ArgumentParser) -> None:
    """All words are handed on."""
    parser.add_argument("arguments", nargs="*", help="see `luxfer studio --help`")


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Starts it."""
    return Exit(start(args.arguments))


def is_there() -> bool:
    """Whether this installation has a studio."""
    return importlib.util.find_spec("luxfer.studio") is not None


def start(argv: list[str]) -> int:
    """Hands the words on to the studio; returns its exit code."""
    if not is_there():
        raise failed("this installation has no studio (the module luxfer.studio is missing)")
    from importlib import import_module

    return int(import_module("luxfer.studio").main(argv) or 0)
