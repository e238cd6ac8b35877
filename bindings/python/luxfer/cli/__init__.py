"""The command line: `luxfer SUBCOMMAND`, one module for each subcommand.

A module of a subcommand has `SUMMARY`, `add(parser)`, which adds its options, and `run(args, console)`, which returns
the exit code. These modules import the package's classes where they use them, so that `luxfer --help` needs neither
numpy nor the library.
"""

from __future__ import annotations

from .program import main

__all__ = ["main"]
