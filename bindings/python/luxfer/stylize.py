"""Paints a target scene in the style in which an artist has painted an exemplar scene (StyLit)."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, cast

from . import _abi, _params
from ._library import library
from .image import Image, image_of
from .job import Job, Progress, StageBase
from .types import GuideRange, GuidesWith, StylizeImage, StylizePreset, StylizeReport
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .context import Context
    from .guides import Guides
    from .image import ImageLike
    from .types import StylizeParams


class Stylize(StageBase):
    """Paints a picture from an artwork and guides.

    >>> exemplar = Guides(context, ball).run(width=48, height=36, samples=4)
    >>> target = Guides(context, still_life).run(width=48, height=36, samples=4)
    >>> stylize = Stylize(context, exemplar.demo_artwork("pen"))
    >>> stylize.add_guides(exemplar, target, "materials")
    >>> stylize.run(preset="fast", levels=2).image().size
    (48, 36, 3)
    """

    kind = "stylize"

    def __init__(self, context: Context, artwork: ImageLike | None = None) -> None:
        super().__init__(context)
        if artwork is not None:
            self.set_artwork(artwork)

    # -- inputs

    def set_artwork(self, artwork: ImageLike) -> None:
        """Sets the artwork, the painted exemplar scene: linear, with 1, 3 or 4 channels, and aligned with the source
        images of the guides."""
        self._call("set_artwork", image_of(self._context, artwork))

    def add_guide(
        self,
        name: str,
        source: ImageLike,
        target: ImageLike | None,
        weight: float = 1.0,
        range: GuideRange | str = GuideRange.LIGHT,
    ) -> None:
        """Adds a guide of "light" or "data": source shows the exemplar, target the scene to paint. With None as
        target, source is used for both, as for a half-painted picture."""
        first = image_of(self._context, source)
        second = None if target is None else image_of(self._context, target)
        self._call("add_guide", _params.text(name, "name"), first, second, weight, _params.member(GuideRange, range))

    def add_guides(self, source: Guides, target: Guides, extras: GuidesWith | str | int = 0, extra_weight: float = 1.0) -> None:
        """Adds the guides of two scenes: the five light guides, and extras such as
        "normals|edges|materials|caustics". Without "normals", the artwork decides whether they are used."""
        self._call("add_guides", source, target, _params.member(GuidesWith, extras), extra_weight)

    def clear_guides(self) -> None:
        """Removes all guides."""
        self._call("clear_guides")

    def set_source_mask(self, mask: ImageLike | None) -> None:
        """Sets the mask of the artwork: pixels above 0.5 may be copied. None means all pixels."""
        self._call("set_source_mask", None if mask is None else image_of(self._context, mask))

    def set_target_mask(self, mask: ImageLike | None, known: ImageLike | None = None) -> None:
        """Sets the mask of the target: pixels above 0.5 are painted; the others come from known, or are black. None
        means that all pixels are painted."""
        images = [None if image is None else image_of(self._context, image) for image in (mask, known)]
        self._call("set_target_mask", *images)

    def set_motion(self, motion: ImageLike | None) -> None:
        """Sets the motion since the previous frame (Guides.motion), so that each job starts from the previous result.
        With None, each job starts from nothing."""
        self._call("set_motion", None if motion is None else image_of(self._context, motion))

    def set_painted(self, painted: ImageLike) -> None:
        """Lets the library complete a half-painted picture, which is the artwork. The mask painted is above 0.5 where
        the picture is finished."""
        self._call("set_painted", image_of(self._context, painted))

    # -- work

    def start(self, preset: StylizePreset | str = StylizePreset.FULL, **params: Unpack[StylizeParams]) -> Job[Stylize]:
        """Starts the stylisation with a preset, "full", "fast", "preview" or "paper"; keyword arguments replace some
        of its settings."""
        settings = _preset(preset)
        _params.update(settings, params, [])
        return self._job("start", settings)

    def run(
        self,
        progress: Progress | None = None,
        preset: StylizePreset | str = StylizePreset.FULL,
        **params: Unpack[StylizeParams],
    ) -> Stylize:
        """Starts the stylisation and waits for it; see start."""
        return self.start(preset, **params).wait(progress)

    def update(self, artwork: ImageLike, changed: ImageLike) -> Job[Stylize]:
        """Starts a job that updates the picture after the artwork was repainted where changed is above 0.5. The
        previous run must have had keep_for_update=1."""
        images = [image_of(self._context, image) for image in (artwork, changed)]
        return self._job("update", *images)

    # -- results

    def image(self, which: StylizeImage | str = StylizeImage.PICTURE) -> Image:
        """An image of the results: "picture", "guide-error" or "sources"."""
        return self._get_image("get_image", _params.member(StylizeImage, which))

    @property
    def report(self) -> StylizeReport:
        """Current quality of the result."""
        return cast(StylizeReport, self._read("get_report", _abi.luxfer_stylize_report))

    @property
    def warnings(self) -> list[StageWarning]:
        """Reasons to doubt the motion of the latest result."""
        return warnings_of(self)


def preset(which: StylizePreset | str) -> StylizeParams:
    """All settings of a preset.

    >>> preset("preview")["preview"]
    1
    """
    return cast("StylizeParams", _params.settings(_preset(which)))


def _preset(which: StylizePreset | str) -> Any:
    settings = _abi.luxfer_stylize_params()
    which = _params.member(StylizePreset, which)
    library.luxfer_stylize_get_preset(which, settings, ctypes.sizeof(settings))  # cannot fail for a member
    return settings
