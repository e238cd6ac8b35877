"""The lighting transfer from end to end: lights a scene as in a photo, from the photo and a few strokes."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from . import _abi, _params
from ._handle import call
from ._pointers import POINTER
from .image import Image, image_of
from .job import Job, Progress, StageBase
from .scene import Scene
from .strokes import set_strokes
from .types import DepthKind, Fixture, Phase, RectifyReport, RelightReport, Stage, TransferImage, TransferReport, TransferScene
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from .context import Context
    from .features import Features
    from .image import ImageLike
    from .rectify import Rectify
    from .segment import Segment
    from .strokes import Strokes
    from .types import CameraParams, TransferParams


class Transfer(StageBase):
    """Runs the stages in order. You can read every result as soon as its stage has ended, replace it by your own, and
    continue from any stage. Settings of the stages are dicts: run(render={"width": 640}, rectify={"max_side": 1024}).

    >>> transfer = Transfer(context, photo, room, "Ceiling")
    >>> transfer.set_strokes(strokes)
    >>> transfer.run(last="lights").image("lights-mask").size == photo.size[:2] + (1,)
    True
    """

    kind = "transfer"

    def __init__(
        self, context: Context, photo: ImageLike | None = None, scene: Scene | None = None, surface: str | None = None
    ) -> None:
        super().__init__(context)
        if photo is not None:
            self.set_photo(photo)
        if scene is not None and surface is not None:
            self.set_scene(scene, surface)
        elif not (scene is None and surface is None):
            raise TypeError("scene and surface, the name of the object or material that receives the lights, go together")

    # -- inputs

    def set_photo(self, photo: ImageLike) -> None:
        """Sets the photo: linear RGB, 1 = display white."""
        self._call("set_photo", image_of(self._context, photo))

    def set_depth(self, depth: ImageLike | None, kind: DepthKind | str = DepthKind.ALONG_Z) -> None:
        """Sets a depth map of the photo, "along-z" or "along-ray". None means no depth map."""
        image = None if depth is None else image_of(self._context, depth)
        self._call("set_depth", image, _params.member(DepthKind, kind))

    def set_scene(self, scene: Scene, surface: str) -> None:
        """Sets the scene to light, which is never changed, and the object or material of the surface that receives the
        lights."""
        self._call("set_scene", scene, _params.text(surface, "surface"))

    def set_texture(self, texture: ImageLike | None) -> None:
        """Sets an emissive texture that replaces the one made from the photo. None means to make it from the photo."""
        self._call("set_texture", None if texture is None else image_of(self._context, texture))

    def set_camera(self, camera: CameraParams | None = None, **params: Unpack[CameraParams]) -> None:
        """Sets the camera of the picture; without arguments, selects the first camera of the scene or, without
        cameras, one in a corner of the room."""
        values = {**(camera or {}), **params}
        self._call("set_camera", _params.fill(_abi.luxfer_camera_params, values, []) if values else None)

    def set_strokes(self, strokes: Strokes | ImageLike | None) -> None:
        """Sets the strokes on the photo; a drawing is converted by Strokes.from_image. None means no strokes."""
        set_strokes(self, strokes)

    def set_zones(self, zones: ArrayLike) -> None:
        """Sets rectangles (n, 4) of the surface that stay without lamps: u0, v0, u1, v1 in metres from the surface's
        corner along its axes. They replace the zones of earlier calls."""
        values = np.ascontiguousarray(zones, np.float64).reshape(-1, 4)
        self._call("set_zones", values.ctypes.data_as(POINTER(ctypes.c_double)), len(values))

    def set_triangles(self, triangles: ArrayLike) -> None:
        """Sets the triangles that receive the lights, instead of the named surface: an array (n, 2) with mesh and
        triangle index. An empty array selects the named surface again."""
        values = np.ascontiguousarray(triangles, np.uint32).reshape(-1, 2)
        self._call("set_triangles", values.ctypes.data_as(POINTER(ctypes.c_uint32)), len(values))

    # -- results of the caller's own

    def use_rectify(self, rectify: Rectify) -> None:
        """Replaces the results of the stages VIEW and UNWARP."""
        self._call("use_rectify", rectify)

    def use_features(self, features: Features) -> None:
        """Replaces the result of the stage FEATURES."""
        self._call("use_features", features)

    def use_segment(self, phase: Phase | str, segment: Segment) -> None:
        """Replaces the result of the stage PLANE or LIGHTS."""
        self._call("use_segment", _params.member(Phase, phase), segment)

    def use_mask(self, phase: Phase | str, mask: ImageLike) -> None:
        """Replaces the result of the stage PLANE or LIGHTS by a mask of the photo's size."""
        self._call("use_mask", _params.member(Phase, phase), image_of(self._context, mask))

    # -- work

    def start(
        self, first: Stage | str = Stage.VIEW, last: Stage | str = Stage.RENDER, **params: Unpack[TransferParams]
    ) -> Job[Transfer]:
        """Starts the stages from first to last, both included: "view", "features", "plane", "lights", "unwarp",
        "emission", "relight", "render"."""
        keep: list[Any] = []
        settings = _params.fill(_abi.luxfer_transfer_params, params, keep)
        return self._job("start", _params.member(Stage, first), _params.member(Stage, last), settings)

    def run(
        self,
        first: Stage | str = Stage.VIEW,
        last: Stage | str = Stage.RENDER,
        progress: Progress | None = None,
        **params: Unpack[TransferParams],
    ) -> Transfer:
        """Runs the stages from first to last and waits for them; see start."""
        return self.start(first, last, **params).wait(progress)

    @staticmethod
    def start_all(
        transfers: Sequence[Transfer],
        first: Stage | str = Stage.VIEW,
        last: Stage | str = Stage.RENDER,
        params: TransferParams | Sequence[TransferParams] | None = None,
    ) -> Job[list[Transfer]]:
        """Starts the stages from first to last of several transfers, one for each plane with lights that a photo shows,
        such as a ceiling and a wall with sconces. They have one photo and one scene; camera and features are computed
        once, and the light of all planes is solved for together. params are the settings of all transfers, or a list
        with the settings of each."""
        transfers = list(transfers)
        if not transfers:
            raise ValueError("there are no transfers; give one for each plane")
        each = [params or {}] * len(transfers) if params is None or isinstance(params, Mapping) else list(params)
        if len(each) != len(transfers):
            raise ValueError(f"there are settings of {len(each)} transfers for {len(transfers)}")
        keep: list[Any] = []
        settings = [_params.fill(_abi.luxfer_transfer_params, dict(one), keep) for one in each]
        context, count = transfers[0]._context, len(transfers)
        handles = (POINTER(_abi.luxfer_transfer) * count)(*(transfer.handle for transfer in transfers))
        pointers = (POINTER(_abi.luxfer_transfer_params) * count)(*(ctypes.pointer(one) for one in settings))
        job = POINTER(_abi.luxfer_job)()
        stages = _params.member(Stage, first), _params.member(Stage, last)
        call(context, "luxfer_transfer_start_all", context, handles, count, *stages, pointers, job)
        return Job._of(transfers, context, job)

    @staticmethod
    def run_all(
        transfers: Sequence[Transfer],
        first: Stage | str = Stage.VIEW,
        last: Stage | str = Stage.RENDER,
        params: TransferParams | Sequence[TransferParams] | None = None,
        progress: Progress | None = None,
    ) -> list[Transfer]:
        """Runs the stages of several transfers together and waits for them; see start_all.

        >>> transfer = Transfer(context, photo, room, "Ceiling")
        >>> [same] = Transfer.run_all([transfer], last="view")
        >>> same is transfer and same.view.focal > 0
        True
        """
        return Transfer.start_all(transfers, first, last, params).wait(progress)

    # -- results

    def image(self, which: TransferImage | str = TransferImage.RENDER) -> Image:
        """An image of the results: "features", "plane-mask", "plane-confidence", "lights-mask", "lights-confidence",
        "unwarped", "unwarped-valid", "emission", "emission-mask", "render", "render-variance" or "render-preview"."""
        return self._get_image("get_image", _params.member(TransferImage, which))

    def scene(self, which: TransferScene | str = TransferScene.LIT) -> Scene:
        """A scene of the results: "lit" is the result, "unsolved" the scene before relighting, and "white" the scene
        in white light of equal luminance."""
        pointer = POINTER(_abi.luxfer_scene)()
        self._call("get_scene", _params.member(TransferScene, which), pointer)
        return Scene._adopt(self._context, pointer)

    @property
    def report(self) -> TransferReport:
        """Time and error of each stage."""
        return cast(TransferReport, self._read("get_report", _abi.luxfer_transfer_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the results so far, in the order of the stages."""
        return warnings_of(self)

    @property
    def view(self) -> RectifyReport:
        """The camera found from the lines of the photo, and the unwarping of the plane."""
        return cast(RectifyReport, self._read("get_view", _abi.luxfer_rectify_report))

    @property
    def solution(self) -> RelightReport:
        """The solved colour and intensity, and their confidence."""
        return cast(RelightReport, self._read("get_solution", _abi.luxfer_relight_report))

    @property
    def fixtures(self) -> list[Fixture]:
        """The lamps of the lit scene, in metres, cd/m² and lumens."""
        count = self.report.fixtures
        return [cast(Fixture, self._read("get_fixture", _abi.luxfer_fixture, i)) for i in range(count)]

    def save_fixtures(self, path: str | os.PathLike[str]) -> None:
        """Writes the lamps to a .csv or .json file. The names of the columns contain the units. A .json file also has
        the outlines of the lamps."""
        self._call("save_fixtures", _params.text(os.fspath(path), "path"))
