"""The options of `luxfer studio`; its help needs no package of the server."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NoReturn

from ..cli.exits import TABLE, Exit
from .files import state_folder

#: The port that is tried first.
PORT = 8717


class Parser(argparse.ArgumentParser):
    """A parser that prints errors in one line, as the other subcommands do."""

    def error(self, message: str) -> NoReturn:
        """Ends with the message."""
        self.exit(Exit.USAGE, f"{self.prog}: {message.removeprefix('argument ')} ({self.prog} --help)\n")


def port(text: str) -> int:
    """Parses a port."""
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is not a port in [0, 65535]")
    return int(text)


def parser() -> argparse.ArgumentParser:
    out = Parser(
        prog="luxfer studio",
        allow_abbrev=False,
        epilog=TABLE,
        description="A photo and a room side by side in the browser, on this machine alone.",
    )
    out.add_argument(
        "photo", nargs="?", type=Path, help="a photo, or a project file (.json); default: a generated office"
    )
    out.add_argument("scene", nargs="?", type=Path, help="a room, .glb, .gltf or USD; default: a generated one")
    out.add_argument(
        "--project", type=Path, help="the file that the project is kept in as you work; opened if it is there"
    )
    out.add_argument(
        "--folder", type=Path, action="append", default=[], help="a folder whose files the page may open"
    )
    out.add_argument("--port", type=port, default=PORT, help=f"default {PORT}, or the next free one; 0: any")
    out.add_argument(
        "--state", type=Path, default=None, help=f"folder for files that the next start needs; default {state_folder()}"
    )
    out.add_argument("--no-browser", action="store_true", help="only print the address")
    return out
