"""Illuminance in lux on a calculation grid or a mesh."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

from . import _abi, _params
from .image import Image
from .job import Job, Progress, StageBase
from .types import IlluminanceImage, IlluminanceReport

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .scene import Scene
    from .types import IlluminanceGrid, IlluminanceParams


class Illuminance(StageBase):
    """Computes the illuminance in lux, with the standard error, at every point.

    >>> desk = {"origin": (-1, 0.8, -1), "across": (2, 0, 0), "down": (0, 0, 2)}
    >>> lux = Illuminance(context, lit_room).run_grid(desk, columns=4, rows=3)
    >>> lux.image("lux").size
    (4, 3, 1)
    >>> lux.report.minimum <= lux.report.mean <= lux.report.maximum
    True
    """

    kind = "illuminance"

    def __init__(self, context: Context, scene: Scene | None = None) -> None:
        super().__init__(context)
        if scene is not None:
            self.set_scene(scene)

    def set_scene(self, scene: Scene) -> None:
        """Sets the scene; each job uses the scene as it is when the job starts."""
        self._call("set_scene", scene)

    def start_grid(
        self, grid: IlluminanceGrid | Mapping[str, Any] | None = None, **params: Unpack[IlluminanceParams]
    ) -> Job[Illuminance]:
        """Starts a calculation on a grid, which origin, across and down (in metres) and normal define."""
        rectangle = _params.fill(_abi.luxfer_illuminance_grid, grid or {}, [], "grid.")
        return self._job("start_grid", rectangle, _params.fill(_abi.luxfer_illuminance_params, params, []))

    def run_grid(
        self,
        grid: IlluminanceGrid | Mapping[str, Any] | None = None,
        progress: Progress | None = None,
        **params: Unpack[IlluminanceParams],
    ) -> Illuminance:
        """Starts it and waits for it."""
        return self.start_grid(grid, **params).wait(progress)

    def start_mesh(self, mesh: int, back: bool = False, **params: Unpack[IlluminanceParams]) -> Job[Illuminance]:
        """Starts a calculation on a mesh, at points that its texture coordinates define. back=True is the back side;
        the winding of the triangles defines the front side."""
        return self._job("start_mesh", mesh, int(back), _params.fill(_abi.luxfer_illuminance_params, params, []))

    def run_mesh(
        self, mesh: int, back: bool = False, progress: Progress | None = None, **params: Unpack[IlluminanceParams]
    ) -> Illuminance:
        """Starts it and waits for it."""
        return self.start_mesh(mesh, back, **params).wait(progress)

    def image(self, which: IlluminanceImage | str = IlluminanceImage.LUX) -> Image:
        """An image of the results: "lux" or "error"."""
        return self._get_image("get_image", _params.member(IlluminanceImage, which))

    @property
    def report(self) -> IlluminanceReport:
        """Summary of the illuminance, in lux."""
        return cast(IlluminanceReport, self._read("get_report", _abi.luxfer_illuminance_report))
