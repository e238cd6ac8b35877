"""Parses the command line, runs a subcommand, and returns its exit code."""

from __future__ import annotations

import argparse
import difflib
import importlib
import os
import re
import signal
import sys
from collections.abc import Sequence
from types import FrameType
from typing import Any, NoReturn

from . import studio
from .console import Console
from .exits import TABLE, Exit, Failure

#: The subcommands in the order of --help; each is a module of this folder.
SUBCOMMANDS = (
    "transfer",
    "render",
    "lux",
    "stylise",
    "sheet",
    "inspect",
    "surfaces",
    "plan",
    "design",
    "products",
    "studio",
)

DESCRIPTION = """Lighting from one photo onto a 3D scene, rendering, lux, and pictures in the style of an artwork.

`luxfer SUBCOMMAND --help` explains each. Names such as demo:photo stand for input that the library makes itself:

  luxfer transfer demo:photo demo:target-room --strokes demo:strokes --out out"""


class Paragraphs(argparse.HelpFormatter):
    """Wraps each paragraph of a description, but keeps the lines of commands, which are indented."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        fill = super()._fill_text
        return "\n\n".join(p if p.startswith("  ") else fill(p, width, indent) for p in text.split("\n\n"))


class Parser(argparse.ArgumentParser):
    """A parser that prints errors in one line and does not accept abbreviated options."""

    def __init__(self, **settings: Any) -> None:
        settings.setdefault("formatter_class", Paragraphs)
        super().__init__(allow_abbrev=False, **settings)

    def error(self, message: str) -> NoReturn:
        """Ends with the message in one line."""
        raise Failure(Exit.USAGE, f"{message.removeprefix('argument ')} ({self.prog} --help)")


class Version(argparse.Action):
    """The option --version. It loads the library, whose version it prints, only when it is used."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        import luxfer

        print(f"luxfer {luxfer.__version__}")
        parser.exit()


def parser() -> Parser:
    """Creates the parser of all subcommands."""
    top = Parser(prog="luxfer", description=DESCRIPTION, epilog=TABLE)
    top.add_argument("--version", action=Version, nargs=0, help="print the version and end")
    commands = top.add_subparsers(dest="command", metavar="SUBCOMMAND", required=True, parser_class=Parser)
    for name in SUBCOMMANDS:
        module = importlib.import_module(f".{name}", __package__)
        own = commands.add_parser(name, help=module.SUMMARY, description=module.__doc__, epilog=TABLE)
        module.add(own)
        own.set_defaults(run=module.run, parser=own)
    return top


def joined(argv: Sequence[str]) -> list[str]:
    """Joins options with values that begin with a minus sign, such as `--camera -1,2,3/0,0,0`, so that argparse does
    not take the values for options."""
    out: list[str] = []
    for word in argv:
        if out and re.match(r"-[\d.]", word) and re.fullmatch(r"--[a-z][a-z-]*", out[-1]):
            out[-1] += f"={word}"
        else:
            out.append(word)
    return out


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """Parses a command line. The error for an unknown option names the most similar one."""
    args, unknown = parser().parse_known_args(joined(argv))
    if unknown:
        word = unknown[0].partition("=")[0]
        known = [option for action in args.parser._actions for option in action.option_strings]
        near = difflib.get_close_matches(word, known, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        args.parser.error(f"there is no option or argument {unknown[0]}{hint}")
    return args


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command line and returns its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    console = Console()
    console.is_json = "--json" in words
    console.name = f"luxfer {words[0]}" if words and words[0] in SUBCOMMANDS else "luxfer"
    handler = _stop_on_terminate()
    try:
        if words[:1] == ["studio"]:
            return studio.start(words[1:])
        args = parse(words)
        console.configure(args)
        return int(args.run(args, console))
    except SystemExit as end:  # --help and --version
        return int(end.code or 0)
    except Failure as failure:
        return console.fail(failure.code, str(failure))
    except KeyboardInterrupt:
        return console.fail(Exit.CANCELLED, "cancelled" + console.kept())
    except BrokenPipeError:  # the reader of the output, such as head, has ended
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return int(Exit.FINE)
    except Exception as error:
        return console.fail(*_reason(error))
    finally:
        if handler is not None:
            signal.signal(signal.SIGTERM, handler)


def _reason(error: Exception) -> tuple[Exit, str]:
    """Returns the exit code and the message of an error of the library or of Python."""
    if isinstance(error, ImportError):
        if error.name == "numpy":
            return Exit.FAILED, "numpy is not installed: pip install numpy, or apt install python3-numpy"
        return Exit.FAILED, str(error).replace("\n", " ")
    from .. import errors

    message = str(error) or type(error).__name__
    if isinstance(error, errors.Cancelled):
        return Exit.CANCELLED, message
    if isinstance(error, (errors.InvalidArgument, errors.NotFound)):
        return Exit.USAGE, message
    if isinstance(error, (errors.Error, OSError, MemoryError)):
        return Exit.FAILED, message
    if os.environ.get("LUXFER_TRACEBACK"):
        raise error
    return Exit.FAILED, f"{type(error).__name__}: {message} (a bug; LUXFER_TRACEBACK=1 shows where)"


def _stop_on_terminate() -> Any:
    """Makes SIGTERM end the work as Ctrl-C does. Returns the previous handler, for restoring it."""

    def stop(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    try:
        return signal.signal(signal.SIGTERM, stop)
    except ValueError:  # not the main thread
        return None
