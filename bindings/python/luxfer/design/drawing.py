"""Drawings of lines, polygons and text, once as SVG for HTML and once for PDF. Lengths in points, y down."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from typing import Any

Point = tuple[float, float]
#: Colours of rising lightness for rising values: stops of viridis, by its authors in the public domain. [convention]
STOPS = ("#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725")


@dataclass
class Drawing:
    """Shapes in the order in which they are painted."""

    width: float
    height: float
    shapes: list[tuple[str, dict[str, Any]]] = field(default_factory=list)

    def polygon(
        self, points: list[Point], fill: str | None = None, stroke: str | None = None, width: float = 0.5
    ) -> None:
        """A closed polygon."""
        self.shapes.append(("polygon", {"points": points, "fill": fill, "stroke": stroke, "width": width}))

    def line(self, points: list[Point], stroke: str = "#000000", width: float = 0.5, dash: bool = False) -> None:
        """An open line."""
        self.shapes.append(("line", {"points": points, "stroke": stroke, "width": width, "dash": dash}))

    def text(self, at: Point, words: str, size: float = 7, anchor: str = "middle", fill: str = "#000000") -> None:
        """Text on a base line, anchored at its "start", "middle" or "end"."""
        self.shapes.append(("text", {"at": at, "words": words, "size": size, "anchor": anchor, "fill": fill}))

    def svg(self) -> str:
        """The drawing as an SVG element."""
        parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width:.2f} {self.height:.2f}" '
            f'width="{self.width * 4 / 3:.0f}" role="img" font-family="Helvetica, Arial, sans-serif">'
        ]
        for kind, s in self.shapes:
            if kind == "text":
                x, y = s["at"]
                parts.append(
                    f'<text x="{x:.2f}" y="{y:.2f}" font-size="{s["size"]}" text-anchor="{s["anchor"]}" '
                    f'fill="{s["fill"]}">{escape(s["words"])}</text>'
                )
                continue
            points = " ".join(f"{x:.2f},{y:.2f}" for x, y in s["points"])
            paint = f'fill="{s.get("fill") or "none"}" stroke="{s["stroke"] or "none"}" stroke-width="{s["width"]}"'
            dash = ' stroke-dasharray="3 2"' if s.get("dash") else ""
            parts.append(f'<{"polygon" if kind == "polygon" else "polyline"} points="{points}" {paint}{dash}/>')
        return "".join(parts) + "</svg>"

    def flowable(self) -> Any:
        """The drawing for reportlab."""
        from reportlab.graphics import shapes
        from reportlab.lib.colors import HexColor

        out = shapes.Drawing(self.width, self.height)
        colour = lambda c: HexColor(c) if c else None  # noqa: E731
        for kind, s in self.shapes:
            if kind == "text":
                x, y = s["at"]
                out.add(
                    shapes.String(
                        x,
                        self.height - y,
                        s["words"],
                        fontName="LuxferSans",
                        fontSize=s["size"],
                        textAnchor=s["anchor"],
                        fillColor=colour(s["fill"]),
                    )
                )
                continue
            flat = [v for x, y in s["points"] for v in (x, self.height - y)]
            made = shapes.Polygon if kind == "polygon" else shapes.PolyLine
            shape = made(flat, strokeColor=colour(s["stroke"]), strokeWidth=s["width"] if s["stroke"] else 0)
            if kind == "polygon":
                shape.fillColor = colour(s["fill"])
            elif s["dash"]:
                shape.strokeDashArray = [3, 2]
            out.add(shape)
        return out


def colour_of(share: float) -> str:
    """The colour of a value by its share of the range, clamped to [0, 1].

    >>> colour_of(0), colour_of(1)
    ('#440154', '#fde725')
    """
    place = min(max(share, 0.0), 1.0) * (len(STOPS) - 1)
    low = min(int(place), len(STOPS) - 2)
    a, b = (tuple(int(s[i : i + 2], 16) for i in (1, 3, 5)) for s in STOPS[low : low + 2])
    return "#" + "".join(f"{round(x + (place - low) * (y - x)):02x}" for x, y in zip(a, b))


def ink_on(share: float) -> str:
    """Black or white, whichever is easier to read on that colour."""
    return "#000000" if share > 0.55 else "#ffffff"
