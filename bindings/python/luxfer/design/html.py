"""A report as one HTML file without links to others."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape

from .content import OUTCOME_TONES, Block, Code, Figure, Heading, Paragraph, Signature, Table
from .drawing import Drawing

STYLE = """
body{font:15px/1.45 Helvetica,Arial,sans-serif;color:#222;max-width:56rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.5rem;border-bottom:2px solid #222;margin-top:2.5rem}h2{font-size:1.15rem;margin-top:1.8rem}
table{border-collapse:collapse;width:100%;margin:.6rem 0;font-size:.86rem}
th{text-align:left;border-bottom:1px solid #222}td,th{padding:.25rem .4rem;vertical-align:top;overflow-wrap:anywhere}
tr:nth-child(even) td{background:#f5f5f5}figure{margin:1rem 0}figure img,figure svg{max-width:100%;height:auto}
figcaption,.small{font-size:.82rem;color:#555}.good{color:#0a6b2d}.bad{color:#b00020}.open{color:#8a5a00}
p.good,p.bad,p.open{font-weight:bold;font-size:1.05rem}
pre{background:#f5f5f5;padding:.6rem;font-size:.75rem;white-space:pre-wrap;overflow-wrap:anywhere}
.sign{display:flex;gap:2rem;margin-top:3rem}
.sign div{flex:1;border-top:1px solid #222;padding-top:.2rem;font-size:.8rem}
@media print{h1{break-before:page}h1:first-child{break-before:auto}figure,table{break-inside:avoid}}
"""


def page(title: str, blocks: Sequence[Block]) -> str:
    """The HTML of a report.

    >>> "<h2>Plan</h2>" in page("A & B", [Heading("Plan", 2)])
    True
    """
    body = "\n".join(_block(b) for b in blocks)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{STYLE}</style></head>\n<body>\n{body}\n</body></html>\n"
    )


def _block(block: Block) -> str:
    if isinstance(block, Heading):
        return f"<h{block.level}>{escape(block.text)}</h{block.level}>"
    if isinstance(block, Paragraph):
        return f'<p class="{block.tone}">{escape(block.text)}</p>' if block.tone else f"<p>{escape(block.text)}</p>"
    if isinstance(block, Table):
        return _table(block)
    if isinstance(block, Figure):
        return f"<figure>{_picture(block.picture)}<figcaption>{escape(block.caption)}</figcaption></figure>"
    if isinstance(block, Code):
        return f"<pre>{escape(block.text)}</pre>"
    assert isinstance(block, Signature)
    return f'<div class="sign"><div>Date</div><div>{escape(block.name or "Name")}</div><div>Signature</div></div>'


def _picture(picture: Drawing | bytes) -> str:
    if isinstance(picture, Drawing):
        return picture.svg()
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(picture).decode()}">'


def _table(table: Table) -> str:
    columns = "".join(f'<col style="width:{100 * w:.0f}%">' for w in table.widths)
    head = "".join(f"<th>{escape(h)}</th>" for h in table.header) if any(table.header) else ""
    rows = []
    for index, row in enumerate(table.rows):
        tone = OUTCOME_TONES[table.outcomes[index]] if table.outcomes else ""
        cells = [f"<td>{escape(c)}</td>" for c in row]
        if tone:
            cells[-1] = f'<td class="{tone}"><b>{escape(row[-1])}</b></td>'
        rows.append("<tr>" + "".join(cells) + "</tr>")
    top = f"<thead><tr>{head}</tr></thead>" if head else ""
    return f"<table><colgroup>{columns}</colgroup>{top}<tbody>{''.join(rows)}</tbody></table>"
