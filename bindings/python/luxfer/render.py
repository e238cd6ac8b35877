"""A path tracer: renders the light of a scene in cd/m², with layers of light (by light path expressions) and of
surfaces."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, cast

from . import _abi, _params
from .image import Image
from .job import Job, Progress, StageBase
from .types import Aov, EmitterAs, RenderImage, RenderReport

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .scene import Scene
    from .types import CameraParams, RenderParams, RenderPart


class Render(StageBase):
    """Renders a scene in passes. The current image can be read while the job runs, and after a cancel.

    >>> render = Render(context, lit_room, expressions={"direct": "LDE"}, aovs="depth|normal")
    >>> render.run(width=32, height=24, samples=4).image().size
    (32, 24, 3)
    >>> sorted(render.layers)
    ['Depth', 'Normal', 'direct']
    """

    kind = "render"

    def __init__(
        self,
        context: Context,
        scene: Scene | None = None,
        *,
        expressions: Mapping[str, str] | None = None,
        aovs: Aov | str | int = 0,
    ) -> None:
        super().__init__(context)
        if scene is not None:
            self.set_scene(scene)
        for name, expression in (expressions or {}).items():
            self.add_expression(name, expression)
        if aovs:
            self.set_aovs(aovs)

    def set_scene(self, scene: Scene) -> None:
        """Sets the scene; each job renders the scene as it is when the job starts."""
        self._call("set_scene", scene)

    def set_camera(self, camera: CameraParams | None = None, **params: Unpack[CameraParams]) -> None:
        """Sets the camera, such as scene.camera(1); without arguments, selects the first camera of the scene."""
        values = {**(camera or {}), **params}
        self._call("set_camera", _params.fill(_abi.luxfer_camera_params, values, []) if values else None)

    def add_expression(self, name: str, expression: str) -> None:
        """Adds a layer of the light that a light path expression selects, such as "LDE" or "C<RD>L"."""
        self._call("add_expression", _params.text(name, "name"), _params.text(expression, "expression"))

    def clear_expressions(self) -> None:
        """Removes all expressions."""
        self._call("clear_expressions")

    def set_emitter_as(self, emitter_as: EmitterAs | str) -> None:
        """Sets the letters that match emissive surfaces and the environment: "both", "light" or "object"."""
        self._call("set_emitter_as", _params.member(EmitterAs, emitter_as))

    def set_aovs(self, flags: Aov | str | int) -> None:
        """Sets the layers of surface properties (AOVs), such as "depth|normal|albedo"."""
        self._call("set_aovs", _params.member(Aov, flags))

    def start(self, **params: Unpack[RenderParams]) -> Job[Render]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_render_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[RenderParams]) -> Render:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    # -- in parts, on many machines

    def split(self, columns: int, rows: int, ranges: int, index: int, **params: Unpack[RenderParams]) -> RenderPart:
        """Gets part number index of a rendering that is divided into columns x rows rectangles, with ranges of paths
        for each; index is below columns * rows * ranges.

        >>> Render(context).split(2, 1, 4, 3, width=64, height=32, samples=16)["x"]
        32
        """
        settings = _params.fill(_abi.luxfer_render_params, params, [])
        part = self._fill("split", _abi.luxfer_render_part, settings, columns, rows, ranges, index)
        return cast("RenderPart", _params.settings(part))

    def start_part(self, path: str | os.PathLike[str], part: RenderPart, **params: Unpack[RenderParams]) -> Job[Render]:
        """Starts a job that renders a part into a file; afterwards the images show this part."""
        settings = _params.fill(_abi.luxfer_render_params, params, [])
        which = _params.fill(_abi.luxfer_render_part, part, [])
        return self._job("start_part", settings, which, _params.text(os.fspath(path), "path"))

    def start_merge(self, paths: Iterable[str | os.PathLike[str]], **params: Unpack[RenderParams]) -> Job[Render]:
        """Starts a job that merges the files of all parts, in any order, into the whole rendering. Scene, camera,
        layers and settings must equal the scene, camera, layers and settings of the parts."""
        self._call("clear_parts")
        for path in paths:
            self._call("add_part", _params.text(os.fspath(path), "path"))
        return self._job("start_merge", _params.fill(_abi.luxfer_render_params, params, []))

    def image(self, which: RenderImage | str = RenderImage.BEAUTY) -> Image:
        """The current image: "beauty", "variance", "paths", "interval" or, if its setting is not 0, "preview" or
        "preview-interval"."""
        return self._get_image("get_image", _params.member(RenderImage, which))

    @property
    def layers(self) -> dict[str, Image]:
        """The current layers by name; the layers of the expressions come first."""
        count = ctypes.c_uint32()
        self._call("get_layer_count", count)
        names = [self._get_text("get_layer_name", i) for i in range(count.value)]
        return {name: self.layer(name) for name in names}

    def layer(self, name: str) -> Image:
        """The layer of that name."""
        return self._get_image("get_layer", _params.text(name, "name"))

    def write_exr(self, path: str | os.PathLike[str]) -> None:
        """Writes the image and all layers into one OpenEXR file; Blender and Nuke recognise the names of its
        channels."""
        self._call("write_exr", _params.text(os.fspath(path), "path"))

    def requirements_text(self) -> str:
        """Describes the parts of the scene that the rendering skips, one sentence per line, with the number of
        unreachable lamps."""
        return self._get_text("get_requirements_text")

    @property
    def report(self) -> RenderReport:
        """Current quality of the rendering."""
        return cast(RenderReport, self._read("get_report", _abi.luxfer_render_report))
