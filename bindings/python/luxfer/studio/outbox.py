"""Messages that wait to be sent to one page.

A sleeping page, such as one in a hidden tab, reads no messages. A newer picture, mask or report of progress therefore
replaces a waiting message of its kind.
"""

from __future__ import annotations

import asyncio
import json
import struct
from collections import OrderedDict
from typing import Any

#: Maximum number of waiting bytes. If more wait, the page is disconnected; when it connects again, it gets everything
#: again. The largest message is a photo of session.SHOWN_PIXELS. [convention]
MAX_WAITING = 64 << 20
#: Kinds of messages of which the page needs only the newest; messages that differ in these fields are separate kinds.
REPLACED = {"picture": ("which",), "masks": ("live",), "progress": (), "step": ("name",), "painting": ()}


class Outbox:
    """The waiting messages of one page. Only the event loop may use it."""

    def __init__(self, max_size: int = MAX_WAITING) -> None:
        self.max_size, self.size, self.is_full = max_size, 0, False
        self._waiting: OrderedDict[object, bytes] = OrderedDict()
        self._changed = asyncio.Event()

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, header: dict[str, Any], payload: bytes) -> None:
        """Adds a message: the length of the header, the header as JSON, and the bytes."""
        text = json.dumps(header, default=float).encode()
        message = struct.pack("<I", len(text)) + text + payload
        kind = header["type"]
        key: object = (kind, *(header.get(f) for f in REPLACED[kind])) if kind in REPLACED else object()
        self.size += len(message) - len(self._waiting.pop(key, b""))
        self._waiting[key] = message
        if self.size > self.max_size:
            self._waiting.clear()
            self.size, self.is_full = 0, True
        self._changed.set()

    async def get(self) -> bytes | None:
        """Waits for the oldest message and returns it; None if too many bytes were waiting."""
        while not self._waiting and not self.is_full:
            self._changed.clear()
            await self._changed.wait()
        if self.is_full:
            return None
        _, message = self._waiting.popitem(last=False)
        self.size -= len(message)
        return message
