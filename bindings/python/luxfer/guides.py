"""Renders the guide images of a scene for a stylisation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _abi, _params
from .image import Image, made
from .job import Job, Progress, StageBase
from .types import Artwork, GuidesImage
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .scene import Scene
    from .types import GuidesParams


class Guides(StageBase):
    """Renders the light of a scene by light path expressions, and its normals, edges and materials.

    >>> Guides(context, ball).run(width=48, height=36, samples=4).image("normals").size
    (48, 36, 3)
    """

    kind = "guides"

    def __init__(self, context: Context, scene: Scene | None = None) -> None:
        super().__init__(context)
        if scene is not None:
            self.set_scene(scene)

    def set_scene(self, scene: Scene) -> None:
        """Sets the scene; each job renders the scene as it is when the job starts."""
        self._call("set_scene", scene)

    def start(self, **params: Unpack[GuidesParams]) -> Job[Guides]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_guides_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[GuidesParams]) -> Guides:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    def image(self, which: GuidesImage | str = GuidesImage.FULL) -> Image:
        """A guide: "full", "direct", "specular", "indirect", "two-bounces", "normals", "edges", "materials" or
        "caustics"."""
        return self._get_image("get_image", _params.member(GuidesImage, which))

    def motion(self, before: Guides) -> Image:
        """The motion of each pixel since the previous frame, whose guides are `before`; for Stylize.set_motion. Camera,
        objects and single vertices may have moved."""
        return self._get_image("get_motion", before)

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the latest motion."""
        return warnings_of(self)

    def demo_artwork(self, style: Artwork | str) -> Image:
        """Draws an artwork of the scene in place of an artist: "pen", "stipple" or "paint"."""
        return made(self._context, "luxfer_demo_create_artwork", self, _params.member(Artwork, style))
