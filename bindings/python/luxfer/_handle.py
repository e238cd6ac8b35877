"""The base class of all objects of the library: they are released once, by close(), `with`, or the garbage
collector."""

from __future__ import annotations

import ctypes
import os
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from . import _abi, _params
from ._library import library
from ._pointers import POINTER
from .errors import InvalidArgument, InvalidOperation, error

if TYPE_CHECKING:
    from .context import Context
    from .image import Image

H = TypeVar("H", bound="Handle")

_forks = 0
"""Number of forks between the process that loaded the package and this one."""


def _count_fork() -> None:
    global _forks
    _forks += 1


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_count_fork)


def call(context: Context, name: str, *arguments: Any) -> None:
    """Calls a function of the library that returns a status; a failure becomes an exception. Pass objects themselves
    and not their handles, so that they live until the call ends."""
    status = getattr(library, name)(*(a.handle if isinstance(a, Handle) else a for a in arguments))
    if status != _abi.LUXFER_OK:
        raise error(status, context.last_error())


class Handle:
    """An object of the library. It may be closed twice; using it after that is an error. A forked child process cannot
    use an object of its parent; closing the object there does nothing."""

    kind: ClassVar[str]
    _pointer: Any = None
    _context: Context
    _forks: int

    def __new__(cls: type[H], *_arguments: Any, **_params: Any) -> H:
        out = super().__new__(cls)
        out._forks = _forks
        return out

    def close(self) -> None:
        """Releases the object. A job that runs on it continues; a job without references is cancelled."""
        pointer, self._pointer = self._pointer, None
        if pointer and self._forks == _forks:
            library.luxfer_release(pointer)

    @property
    def context(self) -> Context:
        """The context of the object."""
        return self._context

    @property
    def handle(self) -> Any:
        """The C handle, for luxfer.library."""
        if not self._pointer:
            raise InvalidArgument(f"this {type(self).__name__} has been closed")
        if self._forks != _forks:
            raise InvalidOperation(
                f"this {type(self).__name__} was created before the process was forked, and its threads did not come along; "
                "create a Context and its objects in the child process"
            )
        return self._pointer

    def __enter__(self: H) -> H:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __del__(self) -> None:
        if library is not None:  # it is None while the interpreter shuts down
            self.close()

    def __copy__(self: H) -> H:
        raise TypeError(f"a {type(self).__name__} cannot be copied")

    def _call(self, verb: str, *arguments: Any) -> None:
        """Calls luxfer_<kind>_<verb> with this object as first argument."""
        call(self._context, f"luxfer_{self.kind}_{verb}", self, *arguments)

    def _read(self, verb: str, struct: Any, *arguments: Any) -> Any:
        """Calls a function that fills a report; returns the report as its dataclass."""
        return _params.report(self._fill(verb, struct, *arguments))

    def _fill(self, verb: str, struct: Any, *arguments: Any) -> Any:
        """Calls a function that fills a struct; returns the struct."""
        out = struct()
        self._call(verb, *arguments, out, ctypes.sizeof(out))
        return out

    def _get_image(self, verb: str, *arguments: Any) -> Image:
        from .image import Image

        pointer = POINTER(_abi.luxfer_image)()
        self._call(verb, *arguments, pointer)
        return Image._adopt(self._context, pointer)

    def _get_text(self, verb: str, *arguments: Any) -> str:
        needed = ctypes.c_size_t()
        self._call(verb, *arguments, None, 0, needed)
        buffer = ctypes.create_string_buffer(needed.value)
        self._call(verb, *arguments, buffer, needed.value, None)
        return buffer.value.decode()

    @classmethod
    def _adopt(cls: type[H], context: Context, pointer: Any) -> H:
        """Creates an object that owns a handle returned by the library."""
        out = cls.__new__(cls)
        out._context, out._pointer = context, pointer
        return out

    def _create(self, context: Context) -> None:
        """Creates the C object by luxfer_<kind>_create."""
        self._context = context
        pointer = POINTER(getattr(_abi, f"luxfer_{self.kind}"))()
        call(context, f"luxfer_{self.kind}_create", context, pointer)
        self._pointer = pointer
