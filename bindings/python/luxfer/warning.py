"""Warnings: reasons to doubt the result of a job that has succeeded, each with a remedy."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import cast

from . import _abi
from ._handle import Handle, call
from ._pointers import POINTER
from .types import Stage, Warning, WarningCode


@dataclass(frozen=True)
class StageWarning:
    """A reason to doubt the result of a stage. The package never prints one: show it to the user.

    >>> warning = StageWarning(WarningCode.UNSEEN, Stage.PLANE, 0.2, 0.1, "a part is new", "paint there", (30.5, 12.5))
    >>> str(warning)
    'plane: a part is new: paint there (at 30, 12)'
    """

    code: WarningCode
    """The kind of the warning."""
    stage: Stage
    """The stage whose result is in doubt. For a Segment, it is LIGHTS if a region is set, else PLANE;
    for Guides and Stylize it is STYLIZE."""
    severity: float
    """The figure that caused the warning; its meaning depends on the code."""
    limit: float
    """The limit that the figure has passed."""
    message: str
    """The defect, with its figure."""
    advice: str
    """The remedy."""
    place: tuple[float, float] | None
    """The place in the photo, x and y in pixels; None without a place."""

    def __str__(self) -> str:
        at = "" if self.place is None else f" (at {int(self.place[0])}, {int(self.place[1])})"
        return f"{self.stage.name.lower()}: {self.message}: {self.advice}{at}"


class Warnings(Handle):
    """A list of warnings, owned by the library."""

    kind = "warnings"

    def read(self) -> list[StageWarning]:
        """Reads all warnings."""
        count = ctypes.c_uint32()
        self._call("get_count", count)
        return [self._at(index) for index in range(count.value)]

    def _at(self, index: int) -> StageWarning:
        found = cast(Warning, self._read("get", _abi.luxfer_warning, index))
        place = (found.place[0], found.place[1]) if found.has_place else None
        return StageWarning(found.code, found.stage, found.severity, found.limit, found.message, found.advice, place)


def warnings_of(stage: Handle) -> list[StageWarning]:
    """The warnings of a stage, a transfer or a scene."""
    pointer = POINTER(_abi.luxfer_warnings)()
    call(stage.context, "luxfer_get_warnings", stage, pointer)
    with Warnings._adopt(stage.context, pointer) as warnings:
        return warnings.read()
