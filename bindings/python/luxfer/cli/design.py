"""Check the lighting of a room against the requirements of a standard, solve for its dimmers, and write a report."""

from __future__ import annotations

import argparse

from .console import Console
from .exits import Exit

SUMMARY = "check a lighting design against EN 12464-1, and write its report"


def add(parser: argparse.ArgumentParser) -> None:
    """All words are handed on."""
    parser.add_argument("arguments", nargs="*", help="see `luxfer design --help`")


def run(args: argparse.Namespace, console: Console) -> Exit:
    """Runs it."""
    return Exit(start(args.arguments))


def start(argv: list[str]) -> int:
    """Hands the words on to `luxfer.design`; returns its exit code."""
    from ..design import main

    return main(argv)
