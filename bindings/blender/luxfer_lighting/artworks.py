"""Objects with an artwork of their own.

The whole picture is painted with the artwork of the scene first, whose surfaces go on behind these objects. Then each
group of objects with a common artwork is painted alone, as if its surfaces went on beyond its outline, and is laid
over the picture by the share of each pixel that the group covers. So no paint of one artwork shows in the other, and
the outline of the group is as smooth as in a rendering.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import bpy
import luxfer
import numpy as np

from . import convert, parts, passes, work

#: Pixels around a group that are painted too, so that the edge of this rectangle does not show. [convention]
MARGIN = 16
#: Share of a pixel up to which it counts as free of a group, and from which on as covered by it. [convention]
FREE, COVERED = 0.01, 0.99
#: Number of samples along each side of a pixel that find the share which a group covers. [convention]
FINER = 3
#: Pixels beyond an outline to which its edge reaches. [convention]
EDGE = 2
#: The ranges of brightness of two scenes are compared from this to that percentile, as the library does. [convention]
DARK, BRIGHT = 5, 95
#: Range of brightness up to which the contrast is left as it is, as in the library. [convention]
FLAT = 0.02
#: The ending of the name of a mesh that has received lights, and that is a part of its object.
LIGHTS = " (lights)"


@dataclass
class Group:
    """Objects with a common artwork, of which they get the paint of one part, or of both if the part is None."""

    artwork: luxfer.Image
    part: str | None
    names: set[str]


def of(thing: bpy.types.Object | None) -> bpy.types.Image | None:
    """The artwork of an object: its own, or else that of the object to which it is parented."""
    while thing is not None and thing.luxfer_artwork is None:
        thing = thing.parent
    return None if thing is None else thing.luxfer_artwork


def groups(source: bpy.types.Scene, like: dict[str, str] | None) -> list[Group]:
    """The groups of a scene. `like` has the part of the exemplar for each object, as parts.of finds it."""
    found: dict[tuple[str, str | None], Group] = {}
    for thing in source.objects:
        artwork, part = of(thing), None if like is None else like.get(thing.name)
        if artwork is None or artwork == source.luxfer.artwork or not parts.is_seen(thing):
            continue
        if (artwork.name, part) not in found:
            found[artwork.name, part] = Group(convert.image(work.context(), artwork), part, set())
        found[artwork.name, part].names.add(thing.name)
    return list(found.values())


class Covers:
    """Renders, by the library, the share of each pixel that each group covers."""

    def __init__(self, scene: luxfer.Scene, view: dict[str, Any], width: int, height: int, found: list[Group]) -> None:
        names = [scene.mesh_name(i).removesuffix(LIGHTS) for i in range(scene.counts.meshes)]
        self._numbers = [[i + 1 for i, name in enumerate(names) if name in group.names] for group in found]
        self._size = height, FINER, width, FINER
        self._render = luxfer.Render(work.context(), scene, aovs="object")
        self._render.set_camera(**view)
        self.job = self._render.start(width=FINER * width, height=FINER * height, samples=1)

    def arrays(self) -> list[np.ndarray]:
        seen = self._render.layer("IndexOB").numpy()[..., 0]
        return [np.isin(seen, numbers).reshape(self._size).mean((1, 3), np.float32) for numbers in self._numbers]


def nearest(inside: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For each pixel, the row and the column of the nearest pixel that is inside, and the distance from it in steps
    along rows and columns."""
    height, width = inside.shape
    column, row = np.arange(width)[None], np.arange(height)[:, None]
    far = height + width
    before = np.maximum.accumulate(np.where(inside, column, -far), 1)
    after = np.minimum.accumulate(np.where(inside, column, 2 * far)[:, ::-1], 1)[:, ::-1]
    in_row = np.where(column - before <= after - column, before, after)
    steps = np.minimum(np.abs(column - in_row), far)

    def above(steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The least distance by way of a row above or the own row, and this row."""
        least = np.minimum.accumulate(steps - row, 0)
        return least + row, np.maximum.accumulate(np.where(steps - row == least, row, 0), 0)

    (up, up_row), (down, down_row) = above(steps), (found[::-1] for found in above(steps[::-1]))
    rows = np.where(up <= down, up_row, height - 1 - down_row)
    return rows, np.clip(np.take_along_axis(in_row, rows, 0), 0, width - 1), np.minimum(up, down)


def extended(guides: dict[str, np.ndarray], inside: np.ndarray) -> dict[str, np.ndarray]:
    """Continues guides (height, width, channels) beyond the pixels that are inside. Edges end at the outline."""
    if inside.all() or not inside.any():
        return guides
    rows, columns, steps = nearest(inside)
    out = {name: values[rows, columns] for name, values in guides.items() if name != "edges"}
    if "edges" in guides:
        out["edges"] = guides["edges"] * (steps <= EDGE)[..., None]
    return out


def encoded(light: np.ndarray) -> np.ndarray:
    """Linear values in [0, 1] as sRGB has them."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0) ** (1 / 2.4) - 0.055)


def decoded(values: np.ndarray) -> np.ndarray:
    """Linear values of sRGB values in [0, 1]."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def matched(source: dict[str, np.ndarray], target: dict[str, np.ndarray], strength: float) -> dict[str, np.ndarray]:
    """Maps the brightness of the ball to that of the whole picture, as the library does for the whole picture: so
    objects with different artworks look equally bright in equal light."""
    out = dict(source)
    for name in passes.GUIDES:
        ours, theirs = encoded(source[name]), encoded(target[name])
        low, high = np.percentile(ours, (DARK, BRIGHT), (0, 1), method="lower")
        new_low, new_high = np.percentile(theirs, (DARK, BRIGHT), (0, 1), method="lower")
        gain = np.where(high - low > FLAT, (new_high - new_low) / np.maximum(high - low, FLAT), 1)
        changed = np.clip((ours - low) * gain + new_low, 0, 1)
        out[name] = decoded(ours + strength * (changed - ours)).astype(np.float32)
    return out


class Painted:
    """The picture, onto which groups are painted one after the other."""

    def __init__(self, picture: np.ndarray, halvings: int) -> None:
        self.picture = picture
        self._step = 2**halvings

    def box(self, cover: np.ndarray) -> tuple[slice, slice] | None:
        """Rows and columns of the rectangle around a group, in pixels of the guides; None if it is not in view."""
        out = []
        for axis, size in ((1, self.picture.shape[0]), (0, self.picture.shape[1])):
            (at,) = np.nonzero((cover > FREE).any(axis))
            if at.size == 0:
                return None
            first, last = (at[0] - MARGIN) // self._step, math.ceil((at[-1] + 1 + MARGIN) / self._step)
            out.append(slice(max(first, 0) * self._step, min(last, size) * self._step))
        return out[0], out[1]

    def lay(self, paint: np.ndarray, cover: np.ndarray, box: tuple[slice, slice]) -> None:
        """Lays the paint of a rectangle over the picture."""
        n = self._step
        height, width = paint.shape[:2]
        share = cover[box][: height * n, : width * n].reshape(height, n, width, n).mean((1, 3))[..., None]
        top, left = box[0].start // n, box[1].start // n
        below = self.picture[top : top + height, left : left + width]
        below += share * (paint[..., :3] - below)
