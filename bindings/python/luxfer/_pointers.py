"""Types of pointers, each made once.

ctypes keeps such types too, but the interpreters of a process share its store, and the first to end empties it for all.
A pointer type that is made anew is another type, which functions declared before refuse.
"""

from __future__ import annotations

import ctypes
from functools import cache

POINTER = cache(ctypes.POINTER)
