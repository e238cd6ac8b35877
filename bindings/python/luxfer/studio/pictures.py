"""Converts images to bytes for the page, and finds the lamps of a mask."""

from __future__ import annotations

import hashlib
from typing import Any

import luxfer
import numpy as np

#: Masks with more pixels than this are reduced for the display.
DISPLAY_PIXELS = 600_000


def reduced(image: luxfer.Image, pixels: int) -> luxfer.Image:
    """Reduces an image, with a filter, to at most `pixels` pixels."""
    width, height, _ = image.size
    share = (pixels / (width * height)) ** 0.5
    if share >= 1:
        return image
    w, h = max(1, round(width * share)), max(1, round(height * share))
    return image.warp([[width / w, 0, 0], [0, height / h, 0], [0, 0, 1]], w, h)


def rgb(values: np.ndarray[Any, Any], exposure: float) -> bytes:
    """Converts linear values (height, width, 3) to sRGB bytes."""
    linear = np.clip(values[..., :3] * np.float32(exposure), 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, np.float32(1 / 2.4)) - 0.055)
    return (255 * encoded + 0.5).astype(np.uint8).tobytes()


def bits(mask: luxfer.Image) -> tuple[dict[str, Any], bytes]:
    """Packs a mask into one bit per pixel, with rows padded to bytes; returns its size and the bytes."""
    values = mask.numpy()[..., 0]
    step = max(1, int(np.ceil((values.size / DISPLAY_PIXELS) ** 0.5)))
    shown = values[step // 2 :: step, step // 2 :: step] > 0.5
    return {"width": shown.shape[1], "height": shown.shape[0]}, np.packbits(shown, axis=1).tobytes()


def digest(*images: luxfer.Image) -> str:
    """Returns a hash of images, by which two results can be tested for equality."""
    out = hashlib.sha256()
    for image in images:
        out.update(image.numpy().tobytes())
    return out.hexdigest()[:16]


def regions(mask: np.ndarray[Any, Any]) -> tuple[np.ndarray[Any, Any], int]:
    """Finds the 4-connected regions of a mask. Returns for each pixel the number of its region, from 1, and the number
    of regions."""
    padded = np.zeros((mask.shape[0], mask.shape[1] + 2), np.int8)
    padded[:, 1:-1] = mask
    edges = np.diff(padded, axis=1)
    rows, starts = np.nonzero(edges == 1)
    ends = np.nonzero(edges == -1)[1]
    parent = list(range(len(rows)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    # Join each run of a row with the runs of the row above that it touches.
    first: list[int] = np.searchsorted(rows, np.arange(mask.shape[0] + 1)).tolist()
    for row in range(1, mask.shape[0]):
        above, here = first[row - 1], first[row]
        while above < first[row] and here < first[row + 1]:
            if starts[above] < ends[here] and starts[here] < ends[above]:
                parent[root(here)] = root(above)
            if ends[above] < ends[here]:
                above += 1
            else:
                here += 1
    roots = np.array([root(i) for i in range(len(rows))], int)
    names, numbers = np.unique(roots, return_inverse=True)
    labels = np.zeros(mask.shape, np.int32)
    for i, n in enumerate(numbers + 1):
        labels[rows[i], starts[i] : ends[i]] = n
    return labels, len(names)


def boxes(labels: np.ndarray[Any, Any], count: int) -> list[dict[str, Any]]:
    """Returns box, centre and area of each region, in pixels."""
    ys, xs = np.nonzero(labels)
    numbers = labels[ys, xs] - 1
    area = np.bincount(numbers, minlength=count)
    low, high = np.full((count, 2), 1 << 30), np.zeros((count, 2), int)
    for axis, values in enumerate((xs, ys)):
        np.minimum.at(low[:, axis], numbers, values)
        np.maximum.at(high[:, axis], numbers, values + 1)
    return [{"box": [*map(int, low[i]), *map(int, high[i])], "area": int(area[i])} for i in range(count)]


def without(mask: np.ndarray[Any, Any], points: list[list[float]], max_distance: float) -> np.ndarray[Any, Any]:
    """Removes from a mask the region at each point, or else the nearest region within `max_distance` pixels of it."""
    labels, count = regions(mask > 0.5)
    if not count or not points:
        return mask
    out = mask.copy()
    for point in points:
        if label := nearest(labels, point, max_distance):
            out[labels == label] = 0
    return out


def nearest(labels: np.ndarray[Any, Any], point: list[float], max_distance: float) -> int:
    """Returns the number of the region at a point, or else of the nearest region within `max_distance` pixels of it
    along each axis; 0 if there is none."""
    height, width = labels.shape
    x, y = point
    x0, x1 = int(max(0, x - max_distance)), int(min(width, x + max_distance + 1))
    y0, y1 = int(max(0, y - max_distance)), int(min(height, y + max_distance + 1))
    window = labels[y0:y1, x0:x1]
    ys, xs = np.nonzero(window)
    if not len(xs):
        return 0
    i = np.argmin((xs + x0 + 0.5 - x) ** 2 + (ys + y0 + 0.5 - y) ** 2)
    return int(window[ys[i], xs[i]])
