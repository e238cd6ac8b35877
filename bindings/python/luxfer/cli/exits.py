"""Exit codes, and the failures that end a subcommand with a message of one line."""

from __future__ import annotations

from enum import IntEnum


class Exit(IntEnum):
    """The exit codes of `luxfer`."""

    FINE = 0
    """Finished."""
    DOUBTFUL = 1
    """Finished, with warnings that doubt the result; only with --strict."""
    USAGE = 2
    """The command line is wrong: an option, its value, or a name that the scene does not have."""
    UNREADABLE = 3
    """An input file cannot be read."""
    CANCELLED = 4
    """Cancelled by Ctrl-C or SIGTERM; files of finished stages are kept."""
    FAILED = 5
    """The work failed, or a result could not be written."""
    UNMET = 6
    """A design is finished, but a requirement fails or stays open; only of `design`."""


#: The text of `--help` about the exit codes.
TABLE = (
    "exit codes: 0 fine, 1 finished with warnings that doubt the result (only with --strict), 2 wrong command line, "
    "3 an input file cannot be read, 4 cancelled (finished files are kept), 5 failed, 6 a requirement of the design is "
    "not met (only design)"
)


class Failure(Exception):
    """Ends the program with an exit code and one line."""

    def __init__(self, code: Exit, message: str) -> None:
        super().__init__(message)
        self.code = code


def usage(message: str) -> Failure:
    """A failure of the command line."""
    return Failure(Exit.USAGE, message)


def unreadable(path: str, reason: object) -> Failure:
    """A failure to read an input file; the message names the file once, also if the reason names it."""
    stated = getattr(reason, "strerror", None)
    text = f"{path}: {stated}" if stated else str(reason)
    return Failure(Exit.UNREADABLE, text if path in text else f"{path} cannot be read: {text}")


def failed(message: str) -> Failure:
    """A failure of the work."""
    return Failure(Exit.FAILED, message)
