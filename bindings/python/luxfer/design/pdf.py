"""A report as a PDF file of A4 pages, by reportlab (`pip install luxfer[report]`). Equal contents give equal files."""

from __future__ import annotations

import io
from collections.abc import Sequence
from html import escape
from typing import Any

from .content import OUTCOME_TONES, Block, Code, Figure, Heading, Paragraph, Signature, Table
from .drawing import Drawing

#: Margin of the pages in points, and the largest height of a picture. [convention]
MARGIN, PICTURE = 54.0, 310.0
TONES = {"good": "#0a6b2d", "bad": "#b00020", "open": "#8a5a00", "small": "#555555", "": "#222222"}


def document(title: str, blocks: Sequence[Block], footer: str) -> bytes:
    """The bytes of the PDF file; the footer stands on every page beside its number."""
    try:
        from reportlab.lib.pagesizes import A4
        from reportlab.platypus import BaseDocTemplate, Frame, PageTemplate
    except ImportError as error:
        raise ImportError("a PDF report needs reportlab: pip install 'luxfer[report]'; HTML reports do not") from error
    _fonts()
    width = A4[0] - 2 * MARGIN

    def edge(canvas: Any, page: Any) -> None:
        canvas.saveState()
        canvas.setFont("LuxferSans", 6.5)
        canvas.setFillGray(0.35)
        canvas.drawString(MARGIN, 30, footer)
        canvas.drawRightString(A4[0] - MARGIN, 30, f"page {page.page}")
        canvas.restoreState()

    out = io.BytesIO()
    made = BaseDocTemplate(
        out,
        pagesize=A4,
        title=title,
        author="luxfer",
        invariant=1,
        leftMargin=MARGIN,
        rightMargin=MARGIN,
        topMargin=MARGIN,
        bottomMargin=MARGIN,
    )
    frame = Frame(MARGIN, MARGIN, width, A4[1] - 2 * MARGIN, 0, 0, 0, 0)
    made.addPageTemplates([PageTemplate(frames=[frame], onPage=edge)])
    made.build(_story(blocks, width))
    return out.getvalue()


def _fonts() -> None:
    """The fonts that come with reportlab, which contain the characters of the report."""
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.ttfonts import TTFont

    if "LuxferSans" not in pdfmetrics.getRegisteredFontNames():
        pdfmetrics.registerFont(TTFont("LuxferSans", "Vera.ttf"))
        pdfmetrics.registerFont(TTFont("LuxferSans-Bold", "VeraBd.ttf"))


def _style(size: float, tone: str = "", bold: bool = False, before: float = 0, after: float = 3) -> Any:
    from reportlab.lib.styles import ParagraphStyle

    font = "LuxferSans-Bold" if bold else "LuxferSans"
    return ParagraphStyle(
        f"{size}{tone}{bold}",
        fontName=font,
        fontSize=size,
        leading=size * 1.32,
        textColor=TONES[tone],
        spaceBefore=before,
        spaceAfter=after,
    )


def _story(blocks: Sequence[Block], width: float) -> list[Any]:
    """Flowables; a heading stays with what follows it."""
    from reportlab.platypus import CondPageBreak, PageBreak
    from reportlab.platypus import Paragraph as Text

    out: list[Any] = []
    for index, block in enumerate(blocks):
        if isinstance(block, Heading):
            if block.new_page:
                out.append(PageBreak())
            else:
                out.append(CondPageBreak(_needed(blocks[index + 1 :])))
            size = 15.0 if block.level == 1 else 11.0
            out.append(Text(escape(block.text), _style(size, bold=True, before=8, after=5)))
        else:
            out += _flow(block, width)
    return out


def _needed(following: Sequence[Block]) -> float:
    """Height that a heading's section needs on its page: up to its first figure, so that a table keeps its drawing."""
    height = 40.0
    for block in following[:3]:
        if isinstance(block, Heading):
            break
        if isinstance(block, Figure):
            return height + (block.picture.height if isinstance(block.picture, Drawing) else PICTURE) + 40
        height += 50 if isinstance(block, Table) else 40
    return min(height, 140.0)


def _flow(block: Block, width: float) -> list[Any]:
    from reportlab.lib.colors import HexColor
    from reportlab.platypus import KeepTogether, Spacer, XPreformatted
    from reportlab.platypus import Paragraph as Text
    from reportlab.platypus import Table as Grid

    if isinstance(block, Paragraph):
        strong = block.tone in ("good", "bad", "open")
        return [
            Text(
                escape(block.text),
                _style(9.5 if strong else 7 if block.tone == "small" else 8, block.tone, strong, 2, 4),
            )
        ]
    if isinstance(block, Table):
        return [_grid(block, width), Spacer(1, 5)]
    if isinstance(block, Figure):
        return [
            KeepTogether([_picture(block.picture, width), Text(escape(block.caption), _style(7, "small", after=6))])
        ]
    if isinstance(block, Code):
        style = _style(6)
        style.fontName = "Courier"
        return [XPreformatted(escape(block.text), style)]
    assert isinstance(block, Signature)
    cells = [[Text(t, _style(7)) for t in ("Date", "", escape(block.name or "Name"), "", "Signature")]]
    line = [("LINEABOVE", (c, 0), (c, 0), 0.6, HexColor("#222222")) for c in (0, 2, 4)]
    return [
        KeepTogether([Spacer(1, 42), Grid(cells, [width * w for w in (0.28, 0.06, 0.28, 0.06, 0.32)], style=line)])
    ]


def _picture(picture: Drawing | bytes, width: float) -> Any:
    from reportlab.lib.utils import ImageReader
    from reportlab.platypus import Image

    if isinstance(picture, Drawing):
        return picture.flowable()
    across, down = ImageReader(io.BytesIO(picture)).getSize()
    scale = min(width / across, PICTURE / down)
    return Image(io.BytesIO(picture), across * scale, down * scale, hAlign="LEFT")


def _grid(table: Table, width: float) -> Any:
    from reportlab.lib.colors import HexColor
    from reportlab.platypus import Paragraph as Text
    from reportlab.platypus import Table as Grid

    rows = [[Text(escape(h), _style(7, bold=True, after=0)) for h in table.header]] if any(table.header) else []
    top = len(rows)
    for index, row in enumerate(table.rows):
        tone = OUTCOME_TONES[table.outcomes[index]] if table.outcomes else ""
        cells = [Text(_breakable(c), _style(7, after=0)) for c in row]
        if tone:
            cells[-1] = Text(escape(row[-1]), _style(7, tone, True, after=0))
        rows.append(cells)
    style = [
        ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("TOPPADDING", (0, 0), (-1, -1), 2),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 2),
        ("LEFTPADDING", (0, 0), (-1, -1), 2),
        ("RIGHTPADDING", (0, 0), (-1, -1), 4),
        ("LINEBELOW", (0, top), (-1, -1), 0.25, HexColor("#cccccc")),
    ]
    if top:
        style.append(("LINEBELOW", (0, 0), (-1, 0), 0.8, HexColor("#222222")))
    return Grid(rows, [width * w for w in table.widths], style=style, repeatRows=top, hAlign="LEFT")


def _breakable(text: str) -> str:
    """Long words, such as hashes, with places to break them."""
    return " ".join(
        escape(w) if len(w) <= 64 else " ".join(escape(w[i : i + 64]) for i in range(0, len(w), 64))
        for w in text.split(" ")
    )
