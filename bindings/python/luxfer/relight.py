"""Solves for the colour and intensity of an emission so that a surface gets a given colour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from . import _abi, _params
from .job import Job, Progress, StageBase
from .types import RelightReport, Constraint
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .scene import Scene
    from .types import RelightParams


class Relight(StageBase):
    """Finds the factor for an emission, per channel, with a 95 % confidence interval.

    >>> room = Scene.demo(context, "target-room")
    >>> mesh, material = room.place_emission("Ceiling", np.eye(8).repeat(3).reshape(8, 8, 3), (100, 100, 100))
    >>> relight = Relight(context)
    >>> relight.set_scene(room, material, mesh)
    >>> relight.set_target((12, 10, 8))
    >>> [round(ours / other, 2) for ours, other in zip(relight.run().report.scale, (12, 10, 8))][0] > 0
    True
    """

    kind = "relight"

    def set_scene(self, scene: Scene, material: int, mesh: int) -> None:
        """Sets the scene, the emitting material to solve for, and the mesh whose mean colour should match, as
        Scene.place_emission returns them."""
        self._call("set_scene", scene, material, mesh)

    def set_target(self, radiance: Sequence[float]) -> None:
        """Sets the mean radiance that the mesh should have, in cd/m² per channel."""
        self._call("set_target", _params.rgb(radiance))

    def set_constraint(self, constraint: Constraint | str | Sequence[Constraint | str]) -> None:
        """Makes the target a limit, "at-least" or "at-most", in all channels or separately in each."""
        self._call("set_constraint", _params.per_channel(Constraint, constraint))

    def start(self, **params: Unpack[RelightParams]) -> Job[Relight]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_relight_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[RelightParams]) -> Relight:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    @property
    def report(self) -> RelightReport:
        """The solution and its confidence."""
        return cast(RelightReport, self._read("get_report", _abi.luxfer_relight_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the solution."""
        return warnings_of(self)
