"""What waits to be sent to one page.

A page that sleeps, such as one in a tab behind others, takes nothing. What it would get in vain is not kept: a newer
picture, mask or report of progress replaces the one that waits.
"""

from __future__ import annotations

import asyncio
import json
import struct
from collections import OrderedDict
from typing import Any

#: Bytes that wait for one page at most; a page that lets more wait is cut off, and gets everything again when it
#: connects anew. The largest message is a photo of session.SHOWN_PIXELS. [convention]
MAX_WAITING = 64 << 20
#: Kinds of messages of which the page needs only the newest, and the fields by which they differ.
REPLACED = {"picture": ("which",), "masks": ("live",), "progress": (), "step": ("name",)}


class Outbox:
    """Messages to one page, used by the event loop alone."""

    def __init__(self, most: int = MAX_WAITING) -> None:
        self.most, self.size, self.is_full = most, 0, False
        self._waiting: OrderedDict[object, bytes] = OrderedDict()
        self._changed = asyncio.Event()

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, header: dict[str, Any], payload: bytes) -> None:
        """Adds a message: a header as JSON behind its length, and bytes."""
        text = json.dumps(header, default=float).encode()
        message = struct.pack("<I", len(text)) + text + payload
        kind = header["type"]
        key: object = (kind, *(header.get(f) for f in REPLACED[kind])) if kind in REPLACED else object()
        self.size += len(message) - len(self._waiting.pop(key, b""))
        self._waiting[key] = message
        if self.size > self.most:
            self._waiting.clear()
            self.size, self.is_full = 0, True
        self._changed.set()

    async def get(self) -> bytes | None:
        """The oldest message, as soon as there is one; None if too much has waited."""
        while not self._waiting and not self.is_full:
            self._changed.clear()
            await self._changed.wait()
        if self.is_full:
            return None
        _, message = self._waiting.popitem(last=False)
        self.size -= len(message)
        return message
