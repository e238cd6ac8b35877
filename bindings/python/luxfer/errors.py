"""One exception for each status of the library. All derive from luxfer.Error and have the library's message."""

from __future__ import annotations

from .types import Status


class Error(Exception):
    """A call of the library has failed; the message names the parameter, its value and its allowed range."""

    status: Status = Status.UNKNOWN
    """The status that the library returned."""


class InvalidArgument(Error, ValueError):
    """A parameter is missing, out of range, or contradicts another."""

    status = Status.INVALID_ARGUMENT


class InvalidOperation(Error, RuntimeError):
    """The call is not allowed now: a job is still running on the object, or an input is missing."""

    status = Status.INVALID_OPERATION


class OutOfMemory(Error, MemoryError):
    """The memory budget of the context, or the machine, is used up."""

    status = Status.OUT_OF_MEMORY


class Unsupported(Error):
    """The file or the request is valid, but uses a feature that this library does not support."""

    status = Status.UNSUPPORTED


class Cancelled(Error):
    """The job was cancelled."""

    status = Status.CANCELLED


class FileError(Error, OSError):
    """The operating system could not read or write a file."""

    status = Status.IO


class FormatError(Error, ValueError):
    """A file is truncated or corrupt, or does not have the format that it claims."""

    status = Status.FORMAT


class NotReady(Error):
    """A result was requested before its job has succeeded, or a wait timed out."""

    status = Status.NOT_READY


class InternalError(Error):
    """A bug in the library: please report it."""

    status = Status.INTERNAL


class Degenerate(Error):
    """The input is well formed but has no answer: no lines, a plane seen edge-on, strokes of one class only."""

    status = Status.DEGENERATE


class NotFound(Error, LookupError):
    """No surface, image or entry has the given name or index."""

    status = Status.NOT_FOUND


class Unreachable(Error):
    """No light can reach the target."""

    status = Status.UNREACHABLE


KINDS: list[type[Error]] = [Error, *Error.__subclasses__()]

BY_STATUS: dict[int, type[Error]] = {kind.status: kind for kind in KINDS}


def error(status: int, message: str) -> Error:
    """The exception for a status that is not OK."""
    return BY_STATUS.get(status, Error)(message or Status(status).name)
