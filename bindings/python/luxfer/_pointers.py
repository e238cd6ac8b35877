"""Pointer types, each created once per interpreter.

The cache of ctypes does not suffice: all interpreters of a process share it, and the first interpreter that ends
empties it. A pointer type that is created again is a different type, and functions that were declared with the first
one refuse it.
"""

from __future__ import annotations

import ctypes
from functools import cache

POINTER = cache(ctypes.POINTER)
