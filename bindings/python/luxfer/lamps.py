"""Solves for lamp powers that come as near as possible to several goals."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from . import _abi, _params
from ._library import library
from .errors import error
from .image import Image
from .job import Job, Progress, StageBase
from .types import Lamp, LampsGoal, LampsReport, LampsResponse, Quantity, Constraint

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from .scene import Scene
    from .types import IlluminanceGrid, LampsParams


class Lamps(StageBase):
    """Traces one set of paths per goal, which measures the goal's response to every lamp; then solves for powers in
    bounds.

    >>> room = Scene.demo(context, "target-room")
    >>> mesh, material = room.place_emission("Ceiling", np.eye(4).repeat(3).reshape(4, 4, 3), (100, 100, 100))
    >>> lamps = Lamps(context)
    >>> lamps.set_scene(room, material)
    >>> lamps.add_grid({"origin": (1, 0.8, 1), "across": (2, 0, 0), "down": (0, 0, 1)}, 500)
    >>> report = lamps.run(paths=4096).report
    >>> report.lamps, report.all_goals_satisfied, lamps.reason
    (1, 1, '')
    """

    kind = "lamps"

    def set_scene(self, scene: Scene, material: int | None) -> None:
        """Sets the scene and the emitting material whose lamps are solved for; None means the scene's punctual lights,
        such as luminaires. Removes all goals."""
        self._call("set_scene", scene, _abi.LUXFER_NONE if material is None else material)

    def add_mesh(
        self, mesh: int, radiance: Sequence[float], quantity: Quantity | str = Quantity.OUTGOING, weight: float = 1
    ) -> None:
        """Adds a goal: the mean radiance that a mesh should have, in cd/m² per channel."""
        self._call("add_mesh", mesh, _params.member(Quantity, quantity), _params.rgb(radiance), weight)

    def add_grid(self, grid: IlluminanceGrid | Mapping[str, Any], lux: float, weight: float = 1) -> None:
        """Adds a goal: the mean illuminance that a calculation grid should have. Its origin, across and down (in
        metres) and normal define the grid."""
        self._call("add_grid", _params.fill(_abi.luxfer_illuminance_grid, grid, [], "grid."), lux, weight)

    def set_constraint(self, goal: int, constraint: Constraint | str | Sequence[Constraint | str]) -> None:
        """Makes a goal a limit, "at-least" or "at-most", in all channels or separately in each."""
        self._call("set_constraint", goal, _params.per_channel(Constraint, constraint))

    def set_levels(self, levels: Sequence[float]) -> None:
        """Sets the dimming levels of the lamps' drivers, as factors of the emission; empty means continuous
        dimming."""
        numbers = (ctypes.c_double * len(levels))(*(float(v) for v in levels))
        self._call("set_levels", numbers if len(levels) else None, len(levels))

    def clear_goals(self) -> None:
        """Removes all goals."""
        self._call("clear_goals")

    def start(self, **params: Unpack[LampsParams]) -> Job[Lamps]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_lamps_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[LampsParams]) -> Lamps:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    @property
    def report(self) -> LampsReport:
        """Summary of the result."""
        return cast(LampsReport, self._read("get_report", _abi.luxfer_lamps_report))

    @property
    def reason(self) -> str:
        """The reason why goals are not met; empty if all are met."""
        return self._get_text("get_reason")

    @property
    def texture(self) -> Image:
        """The emission texture with every lamp multiplied by its scale."""
        return self._get_image("get_texture")

    def lamp(self, index: int) -> Lamp:
        """The power of a lamp."""
        return cast(Lamp, self._read("get_lamp", _abi.luxfer_lamp, index))

    def goal(self, index: int) -> LampsGoal:
        """The light that a goal receives."""
        return cast(LampsGoal, self._read("get_goal", _abi.luxfer_lamps_goal, index))

    def response(self, goal: int, lamp: int) -> LampsResponse:
        """The light that a goal receives from a lamp."""
        return cast(LampsResponse, self._read("get_response", _abi.luxfer_lamps_response, goal, lamp))

    def responses(self, goals: int, lamps: int) -> NDArray[np.float64]:
        """The mean light (goals, lamps, 3) that each of the first goals receives from each of the first lamps."""
        out, found = np.empty((goals, lamps, 3)), _abi.luxfer_lamps_response()
        # This loop runs up to a million times: the function is called without the detours of _call.
        get, handle, into, size = library.luxfer_lamps_get_response, self.handle, ctypes.byref(found), ctypes.sizeof(found)
        mean = np.frombuffer(found.mean, np.float64)
        for goal in range(goals):
            for lamp in range(lamps):
                status = get(handle, goal, lamp, into, size)
                if status != _abi.LUXFER_OK:
                    raise error(status, self._context.last_error())
                out[goal, lamp] = mean
        return out
