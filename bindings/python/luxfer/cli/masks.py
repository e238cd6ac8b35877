"""The photo with its masks, and the place where one more stroke would help most."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .console import percent

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..image import Image
    from ..strokes import Strokes
    from ..transfer import Transfer

    Pixels = NDArray[np.float32]

#: Colours as 8-bit sRGB values: the plane, the lamps, and the mark of the place.
GREEN, YELLOW, MARK = (70, 200, 90), (255, 225, 40), (255, 0, 200)
#: Opacity of the tint that shows a mask over the photo.
TINT = {"plane": 0.35, "lights": 0.75}
#: Cells along the longer side of the photo among which the place is chosen.
CELLS = 48
#: Mean doubt of a neighbourhood up to which no stroke is proposed.
MIN_DOUBT = 0.02


@dataclass(frozen=True)
class Masks:
    """The masks of a transfer whose stage LIGHTS has run."""

    photo: Image
    plane: Pixels
    lights: Pixels
    plane_error: float
    lights_error: float
    place: tuple[int, int] | None
    place_for: str
    is_proposed: bool

    @classmethod
    def of(cls, transfer: Transfer, photo: Image, strokes: Strokes | None) -> Masks:
        """Reads the masks and chooses the place of the next stroke."""
        report = transfer.report
        plane, lights = (transfer.image(f"{name}-mask").numpy()[:, :, 0] for name in ("plane", "lights"))
        place, place_for = next_stroke(transfer, strokes, plane)
        return cls(photo, plane, lights, report.plane_error, report.lights_error, place, place_for, strokes is None)

    def draw(self) -> Image:
        """Draws the photo in grey, the plane in green, lamps in yellow, and a ring around the place."""
        import numpy as np

        from .. import Image
        from .values import LUMINANCE

        linear = np.clip(self.photo.numpy()[:, :, :3], 0, 1)
        grey = linear @ np.array(LUMINANCE, np.float32) if linear.shape[2] == 3 else linear[:, :, 0]
        code = 255 * np.where(grey <= 0.0031308, 12.92 * grey, 1.055 * np.maximum(grey, 1e-6) ** (1 / 2.4) - 0.055)
        # Keep some of the photo's darkness under the tints, so that the photo can still be seen under a mask.
        shown = np.repeat((0.75 * code + 20)[:, :, None], 3, axis=2)
        for mask, colour, share in ((self.plane, GREEN, TINT["plane"]), (self.lights, YELLOW, TINT["lights"])):
            tint = share * (mask > 0.5)[:, :, None]
            shown = (1 - tint) * shown + tint * np.array(colour)
        if self.place is not None:
            self._ring(shown)
        return Image(self.photo.context, np.clip(shown, 0, 255).astype(np.uint8), "srgb")

    def _ring(self, shown: Pixels) -> None:
        import numpy as np

        height, width, _ = shown.shape
        assert self.place is not None
        y, x = np.mgrid[:height, :width]
        distance = np.hypot(x - self.place[0], y - self.place[1])
        radius = max(5.0, max(width, height) / 60)
        # White around the mark keeps it visible on any photo.
        for half, colour in ((0.24 * radius, (255, 255, 255)), (0.13 * radius, MARK)):
            shown[np.abs(distance - radius) <= half] = colour
        shown[distance <= 0.16 * radius] = MARK

    def facts(self) -> dict[str, Any]:
        """Returns the masks in the form in which JSON shows them."""
        return {
            "proposed": self.is_proposed,
            "plane_share": float((self.plane > 0.5).mean()),
            "plane_error": self.plane_error,
            "lights_share": float((self.lights > 0.5).mean()),
            "lights_error": self.lights_error,
            "next_stroke": None
            if self.place is None
            else {"x": self.place[0], "y": self.place[1], "for": self.place_for},
        }

    def words(self) -> list[str]:
        """Describes the masks in lines."""
        facts = self.facts()
        lines = [
            f"green: the plane, {percent(facts['plane_share'])} of the photo; wrong in {percent(self.plane_error)}",
            f"yellow: lamps, {percent(facts['lights_share'])} of the photo; wrong in {percent(self.lights_error)}",
        ]
        if self.place is not None:
            x, y = self.place
            lines.append(f"ring: one more stroke for the {self.place_for} would help most at pixel {x}, {y}")
        return lines


def next_stroke(transfer: Transfer, strokes: Strokes | None, plane: Pixels) -> tuple[tuple[int, int] | None, str]:
    """Returns the most doubtful pixel of the most doubtful neighbourhood (None if nothing is doubtful enough), and the
    mask for which a stroke is needed there. With strokes, the doubt of a pixel is how much it differs from all strokes;
    without strokes, how close its confidence is to one half."""
    import numpy as np

    if strokes is None:
        doubts = {}
        for name, mask in (("plane", "plane"), ("lights", "lights")):
            confidence = transfer.image(f"{mask}-confidence").numpy()[:, :, 0]
            doubts[name] = 1 - np.abs(2 * confidence - 1)
        doubts["lights"] = doubts["lights"] * (plane > 0.5)
    else:
        doubts = unseen(transfer, strokes, plane)
    found = {name: strangest(doubt) for name, doubt in doubts.items()}
    name = max(found, key=lambda key: found[key][0])
    doubt, place = found[name]
    return (place, name) if doubt > MIN_DOUBT else (None, name)


def unseen(transfer: Transfer, strokes: Strokes, plane: Pixels) -> dict[str, Pixels]:
    """For each mask, how much each pixel differs from all strokes; 0 for pixels that cannot belong to the mask."""
    from .. import Segment
    from ..errors import Error

    features, out = transfer.image("features"), {}
    # Use the settings of the transfer: it segments lamps by colour alone, within the plane.
    parts: Any = (("plane", {}), ("lights", {"channels": 7}))
    for name, settings in parts:
        segment = Segment(transfer.context, features)
        segment.set_strokes(name, strokes)
        if name == "lights":
            segment.set_region(plane)
        try:
            segment.run(**settings)
            out[name] = segment.image("unseen").numpy()[:, :, 0]
        except Error:  # a class has no strokes, so the library proposed this mask
            out[name] = 0 * plane
    out["plane"] = out["plane"] * (plane > 0.5)
    return out


def strangest(doubt: Pixels) -> tuple[float, tuple[int, int]]:
    """Returns the mean doubt of the most doubtful neighbourhood of 3 x 3 cells, and the most doubtful pixel of its
    central cell."""
    import numpy as np

    height, width = doubt.shape
    side = max(1, -(-max(height, width) // CELLS))
    rows, columns = -(-height // side), -(-width // side)
    padded = np.zeros((rows * side, columns * side), np.float32)
    padded[:height, :width] = doubt
    cells = np.pad(padded.reshape(rows, side, columns, side).mean((1, 3)), 1)
    around: Any = sum(cells[i : i + rows, j : j + columns] for i in range(3) for j in range(3)) / 9
    row, column = np.unravel_index(int(np.argmax(around * (cells[1:-1, 1:-1] > 0))), (rows, columns))
    part = doubt[row * side : (row + 1) * side, column * side : (column + 1) * side]
    y, x = np.unravel_index(int(np.argmax(part)), part.shape)
    return float(around[row, column]), (int(column * side + x), int(row * side + y))
