"""Converts keyword arguments to structs of the library, and its structs to dataclasses. The error for an unknown name
suggests the most similar one."""

from __future__ import annotations

import ctypes
import difflib
import operator
from collections.abc import Mapping, Sequence
from enum import IntEnum, IntFlag
from typing import Any, TypeVar

from . import _abi
from ._library import library

E = TypeVar("E", IntEnum, IntFlag)

INTEGERS = {
    ctypes.c_int32: (-(2**31), 2**31 - 1),
    ctypes.c_uint32: (0, 2**32 - 1),
    ctypes.c_uint64: (0, 2**64 - 1),
    ctypes.c_size_t: (0, 2 ** (8 * ctypes.sizeof(ctypes.c_size_t)) - 1),
}


def nearest(name: str, names: list[str]) -> str:
    """A hint for a mistyped name: the most similar name, if any, and the list of all names."""
    close = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    return (f"did you mean '{close[0]}'? " if close else "") + "There are " + ", ".join(names)


def member(kind: type[E], value: E | str | int) -> E:
    """Finds the member of an enumeration for a member, a number, or a name in any case with - or _; for flags also
    'a|b'."""
    if isinstance(value, str):
        names = {name.lower().replace("_", "-"): m for name, m in kind.__members__.items()}
        parts = value.lower().replace("_", "-").split("|") if issubclass(kind, IntFlag) else [value.lower().replace("_", "-")]
        out = 0
        for part in (p.strip() for p in parts):
            if part not in names:
                raise ValueError(f"'{value}' is no {kind.__name__}: {nearest(part, list(names))}")
            out |= names[part]
        return kind(out)
    try:
        return kind(operator.index(value))
    except ValueError:
        listed = ", ".join(f"{name.lower()} = {m.value}" for name, m in kind.__members__.items())
        raise ValueError(f"{value} is no {kind.__name__}: there are {listed}") from None


def per_channel(kind: type[E], values: E | str | int | Sequence[E | str | int]) -> Any:
    """The C array of the members for red, green and blue, from one value for all channels or one for each."""
    red, green, blue = (values,) * 3 if isinstance(values, (str, int)) else values
    return (ctypes.c_int32 * 3)(member(kind, red), member(kind, green), member(kind, blue))


def rgb(values: Sequence[float]) -> Any:
    """A colour as the C array of its three channels."""
    red, green, blue = (float(v) for v in values)
    return (ctypes.c_float * 3)(red, green, blue)


def is_array(kind: type) -> bool:
    return isinstance(kind, type) and issubclass(kind, ctypes.Array)


def _convert(kind: Any, value: Any, name: str, keep: list[Any]) -> Any:
    """Converts a value for a field of a ctypes type; appends objects that the result points to, to `keep`."""
    if kind in INTEGERS:
        low, high = INTEGERS[kind]
        try:
            number = operator.index(value)
        except TypeError:
            raise TypeError(f"{name} is a whole number, not {value!r}") from None
        if not low <= number <= high:
            raise ValueError(f"{name} = {number} is not in [{low}, {high}]")
        return number
    if kind in (ctypes.c_float, ctypes.c_double):
        try:
            return float(value)
        except (TypeError, ValueError):
            raise TypeError(f"{name} is a number, not {value!r}") from None
    if kind is ctypes.c_char_p:
        return None if value is None else text(value, name)
    if is_array(kind):
        try:
            values = list(value)
        except TypeError:
            raise TypeError(f"{name} is {kind._length_} numbers, not {value!r}") from None
        if len(values) != kind._length_:
            raise ValueError(f"{name} is {kind._length_} numbers, not {len(values)}")
        return kind(*(_convert(kind._type_, v, f"{name}[{i}]", keep) for i, v in enumerate(values)))
    if kind is ctypes.c_void_p:
        return value
    # The remaining fields point to the settings of another stage.
    if value is None:
        return None
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} is a dict of settings, not {value!r}")
    inner = fill(kind._type_, value, keep, f"{name}.")
    keep.append(inner)
    return ctypes.pointer(inner)


def text(value: Any, name: str) -> bytes:
    """Encodes a string for the library: UTF-8."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is a str, not {value!r}")
    if "\0" in value:
        raise ValueError(f"{name} contains a zero character")
    return value.encode()


def fill(struct: type[ctypes.Structure], values: Mapping[str, Any], keep: list[Any], prefix: str = "") -> Any:
    """A struct with the library's defaults, replaced by `values`.

    Keep the list `keep` until the call that uses it ends.
    """
    params = struct()
    name = struct.__name__
    status = library.luxfer_init(vars(struct)["struct_type"], ctypes.byref(params), ctypes.sizeof(params))
    if status != _abi.LUXFER_OK:
        raise RuntimeError(f"{name}: the package and the library do not fit together")
    update(params, values, keep, prefix)
    return params


def update(params: ctypes.Structure, values: Mapping[str, Any], keep: list[Any], prefix: str = "") -> None:
    """Sets the fields of a struct that `values` names."""
    kinds = {f[0]: f[1] for f in params._fields_ if f[0] not in ("struct_size", "reserved")}
    enumerations: dict[str, Any] = getattr(params, "enumerations", {})
    for key, value in values.items():
        if key not in kinds:
            raise TypeError(f"there is no setting '{prefix}{key}': {nearest(key, list(kinds))}")
        if key in enumerations:
            value = member(enumerations[key], value)
        setattr(params, key, _convert(kinds[key], value, prefix + key, keep))


def settings(params: ctypes.Structure) -> dict[str, Any]:
    """The fields of a struct as a dict of settings; pointers are left out."""
    return {
        f[0]: plain(getattr(params, f[0]), params, f[0])
        for f in params._fields_
        if f[0] not in ("struct_size", "reserved")
        and (f[1] in INTEGERS or f[1] in (ctypes.c_float, ctypes.c_double) or is_array(f[1]))
    }


def defaults(struct: type[ctypes.Structure]) -> dict[str, Any]:
    """The default settings with which the library fills a struct."""
    return settings(fill(struct, {}, []))


def plain(value: Any, params: ctypes.Structure, name: str) -> Any:
    """A field's value: texts as str, arrays as tuples, enumerations as their members where the number is one."""
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, ctypes.Array):
        return tuple(plain(v, params, name) for v in value)
    kind = getattr(params, "enumerations", {}).get(name)
    if kind is None:
        return value
    try:
        return kind(value)
    except ValueError:
        return value


def report(struct: Any) -> Any:
    """Converts a struct that the library has filled to its dataclass."""
    names = [f[0] for f in struct._fields_ if f[0] not in ("struct_size", "reserved")]
    return struct.result(**{name: plain(getattr(struct, name), struct, name) for name in names})
