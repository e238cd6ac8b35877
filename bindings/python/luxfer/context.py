"""The context: threads, memory budget and error messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _abi, _params
from ._handle import Handle
from ._library import library
from ._pointers import POINTER
from .errors import error

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .types import ContextParams


class Context(Handle):
    """Owns the worker threads. All other objects are created in a context and keep it alive.

    >>> with Context(num_threads=2) as context:
    ...     Image(context, [[0.25, 1.0]]).size
    (2, 1, 1)
    """

    kind = "context"
    _context = property(lambda self: self)

    def __init__(self, **params: Unpack[ContextParams]) -> None:
        pointer = POINTER(_abi.luxfer_context)()
        status = library.luxfer_context_create(_params.fill(_abi.luxfer_context_params, params, []), pointer)
        if status != _abi.LUXFER_OK:
            raise error(status, f"a context cannot be created with {params}")
        self._pointer = pointer

    def last_error(self) -> str:
        """The message of this thread's latest failure in this context; exceptions contain it too."""
        return self._get_text("get_last_error") if self._pointer else ""
