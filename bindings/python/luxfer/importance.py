"""A map of the light that each point of an emitting surface would send to a target."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

from . import _abi, _params
from .image import Image, image_of
from .job import Job, Progress, StageBase
from .types import ImportanceReport, Placement, RelightReport

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .image import ImageLike
    from .scene import Scene
    from .types import ImportanceParams, PlacementParams


class Importance(StageBase):
    """Traces paths once; then computes the light of any texture on the surface, at any placement, within milliseconds.

    >>> room = Scene.demo(context, "target-room")
    >>> mesh, material = room.place_emission("Ceiling", np.zeros((1, 1, 3)), (1, 1, 1))
    >>> importance = Importance(context)
    >>> importance.set_scene(room, material, mesh)
    >>> lamps = np.zeros((8, 8, 3)); lamps[3:5, 3:5] = 100
    >>> response = importance.run(width=8, height=8, paths=4096).respond(lamps).response
    >>> scale = importance.solve(lamps, (12, 10, 8)).scale
    >>> round(response[0] * scale[0] / 12, 1)
    1.0
    >>> importance.place(lamps).response[0] >= response[0]
    True
    """

    kind = "importance"

    def set_scene(self, scene: Scene, material: int, mesh: int) -> None:
        """Sets the scene, the material of the surfaces that will emit, and the mesh that is the target."""
        self._call("set_scene", scene, material, mesh)

    def start(self, **params: Unpack[ImportanceParams]) -> Job[Importance]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_importance_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[ImportanceParams]) -> Importance:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    @property
    def image(self) -> Image:
        """The map. The value of a cell is the mean radiance of the target if only this cell emitted, with 1 cd/m²."""
        return self._get_image("get_image")

    def respond(self, texture: ImageLike, placement: Sequence[float] | None = None) -> ImportanceReport:
        """Computes the light that the target receives from a texture in cd/m². The matrix placement (nine numbers, row
        by row) maps texture coordinates of the surface to texture coordinates of the texture."""
        image = image_of(self._context, texture)
        out = self._read("respond", _abi.luxfer_importance_report, image, _nine(placement))
        return cast(ImportanceReport, out)

    def solve(
        self, texture: ImageLike, radiance: Sequence[float], placement: Sequence[float] | None = None
    ) -> RelightReport:
        """Solves for the factor of a texture that gives the target a mean radiance, in cd/m² per channel."""
        image, wanted = image_of(self._context, texture), _params.rgb(radiance)
        out = self._read("solve", _abi.luxfer_relight_report, image, _nine(placement), wanted)
        return cast(RelightReport, out)

    def start_placement(self, texture: ImageLike, **params: Unpack[PlacementParams]) -> Job[Importance]:
        """Starts a job that finds the best placement of a texture in cd/m²; then read placement."""
        settings = _params.fill(_abi.luxfer_placement_params, params, [])
        return self._job("start_placement", image_of(self._context, texture), settings)

    def place(
        self, texture: ImageLike, progress: Progress | None = None, **params: Unpack[PlacementParams]
    ) -> Placement:
        """Finds the best placement of a texture in cd/m². By default, it varies the offset so that the target gets the
        most light."""
        return self.start_placement(texture, **params).wait(progress).placement

    @property
    def placement(self) -> Placement:
        """The placement that the job of start_placement has found."""
        return cast(Placement, self._read("get_placement", _abi.luxfer_placement))


def _nine(placement: Sequence[float] | None) -> Any:
    return None if placement is None else (ctypes.c_double * 9)(*(float(v) for v in placement))
