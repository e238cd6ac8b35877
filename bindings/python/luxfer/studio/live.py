"""Masks while strokes are painted, at a small size, and the pixel where one more stroke would help most.

Strokes may change the layout of the room, and with it the features of the small photo. They rarely do, so the masks by
the former features come first; then the features are computed again, and the masks only if the features have changed.
When the user pauses, light.py computes the masks at full size.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import luxfer
import numpy as np

from . import pictures
from .jobs import Latest
from .project import Project

#: Number of pixels of the small photo, chosen so that masks need less than 50 ms of processor time.
PIXELS = 150_000
#: Side of the window over which doubt is averaged, as a share of the photo's width.
WINDOW = 0.06
#: Mean doubt in the window below which no stroke is proposed.
MIN_DOUBT = 0.5
#: For each kind of stroke, the library's name of its mask, and whether the stroke belongs to the mask.
PHASES = {
    "plane": ("plane", True),
    "not-plane": ("plane", False),
    "light": ("lights", True),
    "not-light": ("lights", False),
}


def strokes_of(
    context: luxfer.Context, project: Project, size: tuple[int, int], share: float = 1.0
) -> luxfer.Strokes:
    """Converts the strokes of a project to strokes on a photo of `size` pixels, scaled by `share` from the
    project's."""
    out = luxfer.Strokes(context, *size)
    for stroke in project["strokes"]:
        phase, positive = PHASES[stroke["kind"]]
        points = np.array(stroke["points"], np.float32).reshape(-1, 2) * share
        out.add(phase, points, max(stroke["radius"] * share, 0.5), positive)
    return out


class LiveMasks:
    """The small photo of one session."""

    def __init__(self, photo: luxfer.Image):
        self.context = (
            luxfer.Context()
        )  # threads of its own, which do not wait for a rendering
        self.photo = luxfer.Image(self.context, pictures.reduced(photo, PIXELS).numpy())
        self.size = self.photo.size[:2]
        self.share = self.size[0] / photo.size[0]
        self.transfer = luxfer.Transfer(self.context, self.photo)
        self.is_viewed = False
        #: The features by the latest strokes that were looked at, and their values.
        self.features: tuple[luxfer.Image, np.ndarray[Any, Any]] | None = None
        self.segments: dict[str, luxfer.Segment] = {}

    def follow(self, project: Project, thread: Latest[Any], show: Callable[[dict[str, luxfer.Image]], None]) -> None:
        """Computes the masks from the strokes of a project, and passes them to `show`; masks that cannot be computed
        are missing. First come the masks by the features of the strokes before, then, if the new strokes have changed
        the features, the masks by these."""
        strokes = strokes_of(self.context, project, self.size, self.share)
        if self.features is not None:
            show(self.segment(self.features[0], strokes, thread))
        features = self.features_of(strokes, thread)
        values = features.numpy()
        if self.features is None or not np.array_equal(values, self.features[1]):
            self.features = features, values
            show(self.segment(features, strokes, thread))

    def features_of(self, strokes: luxfer.Strokes, thread: Latest[Any]) -> luxfer.Image:
        if not self.is_viewed:
            thread.finish(self.transfer.start("view", "view"))
            self.is_viewed = True
        self.transfer.set_strokes(strokes)
        thread.finish(self.transfer.start("features", "features"))
        return self.transfer.image("features")

    def segment(self, features: luxfer.Image, strokes: luxfer.Strokes, thread: Latest[Any]) -> dict[str, luxfer.Image]:
        """Returns the masks by given features."""
        self.segments = {}
        masks: dict[str, luxfer.Image] = {}
        for phase in ("plane", "lights"):
            segment = luxfer.Segment(self.context, features)
            segment.set_strokes(phase, strokes)
            if phase == "lights":
                segment.set_region(masks["plane"])
            try:
                thread.finish(segment.start())
            except luxfer.errors.Degenerate:
                break
            masks[phase] = segment.image("mask")
            self.segments[phase] = segment
        return masks

    def doubt(self) -> dict[str, Any] | None:
        """Returns the position, in pixels of the project's photo, where one more stroke helps most, and its mask."""
        best: dict[str, Any] | None = None
        for phase, segment in self.segments.items():
            unseen = segment.image("unseen").numpy()[..., 0]
            side = max(3, int(WINDOW * unseen.shape[1]) | 1)
            mean = box_mean(unseen, side)
            y, x = divmod(int(np.argmax(mean)), mean.shape[1])
            score = float(mean[y, x])
            if score >= MIN_DOUBT and (best is None or score > best["score"]):
                at = [(x + 0.5) / self.share, (y + 0.5) / self.share]
                best = {"phase": phase, "score": score, "at": at, "radius": side / 2 / self.share}
        return best


def box_mean(values: np.ndarray[Any, Any], side: int) -> np.ndarray[Any, Any]:
    """Means over windows of side x side pixels; pixels beyond the border count as 0."""
    half = side // 2
    sums = np.zeros((values.shape[0] + side, values.shape[1] + side))
    sums[half + 1 : half + 1 + values.shape[0], half + 1 : half + 1 + values.shape[1]] = values
    sums = sums.cumsum(0).cumsum(1)
    total = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    return np.asarray(total / side**2)
