"""Generated input: a photo of a generated office, and strokes as a user would paint them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _abi, _params
from .image import Image
from .job import Job, Progress, StageBase
from .types import DemoPhotoImage

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .types import DemoPhotoParams


class DemoPhoto(StageBase):
    """Generates a photo and strokes on it; see also Scene.demo and Guides.demo_artwork.

    >>> demo = DemoPhoto(context).run(width=60, height=40, samples=2)
    >>> demo.image("picture").size, demo.image("strokes").size
    ((60, 40, 3), (60, 40, 3))
    """

    kind = "demo_photo"

    def start(self, **params: Unpack[DemoPhotoParams]) -> Job[DemoPhoto]:
        """Starts this stage as a job; the settings are keyword arguments."""
        return self._job("start", _params.fill(_abi.luxfer_demo_photo_params, params, []))

    def run(self, progress: Progress | None = None, **params: Unpack[DemoPhotoParams]) -> DemoPhoto:
        """Starts this stage and waits for it; the settings are keyword arguments."""
        return self.start(**params).wait(progress)

    def image(self, which: DemoPhotoImage | str = DemoPhotoImage.PICTURE) -> Image:
        """ "picture" or "strokes"."""
        return self._get_image("get_image", _params.member(DemoPhotoImage, which))
