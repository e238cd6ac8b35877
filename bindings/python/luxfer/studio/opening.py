"""Opens the page in the browser without its address on a command line, which every user of the machine can read.

The browser is started with the path of a file that only its owner can read. The file redirects to an address with a
code that the server accepts once; the answer redirects to the address with the token.
"""

from __future__ import annotations

import html
import os
import secrets
import webbrowser
from pathlib import Path

PAGE = """<!doctype html>
<meta charset="utf-8">
<meta http-equiv="refresh" content="0; url={address}">
<title>luxfer studio</title>
<p><a href="{address}">Open luxfer studio</a></p>
"""


def leading_to(address: str) -> str:
    """Returns a page that redirects to an address."""
    return PAGE.format(address=html.escape(address))


class Opening:
    """A file that opens the studio; it works once."""

    def __init__(self, folder: Path, address: str):
        """The file is written into `folder`; `address` contains the code."""
        self.path = folder / f"open-studio-{secrets.token_hex(8)}.html"
        # O_EXCL: fail if somebody else has created a file or a link there.
        with os.fdopen(os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as out:
            out.write(leading_to(address))

    def show(self) -> None:
        """Starts the browser."""
        webbrowser.open(self.path.absolute().as_uri())

    def close(self) -> None:
        """Deletes the file."""
        self.path.unlink(missing_ok=True)
