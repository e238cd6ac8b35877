"""Decides which requests the server accepts, and which files it may read.

The server listens on the loopback address, where every program and every web page of this machine can reach it.
Therefore each address begins with a random token, and three headers are checked: Host (against names that resolve to
this machine), Origin and Sec-Fetch-Site (against pages of other servers). A file is read only if the user named it or
its folder.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .opening import leading_to

#: Scripts, styles and connections of the page come from this server alone; three.js reads textures from blob:
#: addresses.
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self' blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

HEADERS = [
    (b"content-security-policy", POLICY.encode()),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
    (b"cache-control", b"no-store"),
]


def new_token() -> str:
    """Returns a token of 192 random bits."""
    return secrets.token_urlsafe(24)


class Guard:
    """Wraps an ASGI application: refuses requests that do not come from the page, and removes the token from paths."""

    def __init__(self, app: Any, token: str, port: int):
        self.app, self.token = app, token
        self.hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}
        self.code = ""

    def new_code(self) -> str:
        """Returns the path of a page that redirects to the address with the token; it works once."""
        self.code = new_token()
        return f"open/{self.code}"

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if self.is_opened(scope):
            await show(send, 200, b"text/html; charset=utf-8", leading_to(f"/{self.token}/"))
            return
        if reason := self.refusal(scope):
            await refuse(scope, receive, send, reason)
            return
        inner = {**scope, "path": scope["path"][len(self.token) + 1 :], "root_path": ""}
        inner["raw_path"] = inner["path"].encode()
        await self.app(inner, receive, sender(send) if scope["type"] == "http" else send)

    def is_opened(self, scope: Any) -> bool:
        """Whether a request has the code, which then becomes invalid. The request may come from another site, because
        browsers treat the file that redirects here as another site."""
        headers = headers_of(scope)
        if not self.code or scope["type"] != "http" or scope["method"] != "GET":
            return False
        if headers.get("host", "") not in self.hosts or "origin" in headers:
            return False
        if not hmac.compare_digest(scope["path"].encode(), f"/open/{self.code}".encode()):
            return False
        self.code = ""
        return True

    def refusal(self, scope: Any) -> str:
        """Returns why a request is refused; an empty text if it is accepted."""
        headers = headers_of(scope)
        host, origin = headers.get("host", ""), headers.get("origin")
        if host not in self.hosts:
            return "the Host header names another server"
        if origin is not None and origin != f"http://{host}":
            return "the request comes from a page of another origin"
        if origin is None and scope["type"] == "websocket":
            return "a WebSocket states its origin"
        if headers.get("sec-fetch-site", "none") not in ("none", "same-origin"):
            return "the request comes from another site"
        given = scope["path"][1:].partition("/")[0]  # the path of `OPTIONS *` has no slash
        if not hmac.compare_digest(given.encode(), self.token.encode()):
            return "the token of the address is wrong: open the address that the studio printed when it started"
        return ""


def headers_of(scope: Any) -> dict[str, str]:
    """Returns the headers of a request."""
    return {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}


def sender(send: Any) -> Any:
    """Returns a send function that adds the headers above to each answer."""

    async def with_headers(message: Any) -> None:
        if message["type"] == "http.response.start":
            message = {**message, "headers": [*message.get("headers", []), *HEADERS]}
        await send(message)

    return with_headers


async def refuse(scope: Any, receive: Any, send: Any, reason: str) -> None:
    """Answers with status 403, or closes a WebSocket before it is accepted."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008})
        return
    await show(send, 403, b"text/plain; charset=utf-8", f"Refused: {reason}.\n")


async def show(send: Any, status: int, kind: bytes, text: str) -> None:
    """Answers with a text."""
    await send({"type": "http.response.start", "status": status, "headers": [(b"content-type", kind), *HEADERS]})
    await send({"type": "http.response.body", "body": text.encode()})


class Allowed:
    """The files that may be read: files that the user has named, and files in folders that the user has named."""

    def __init__(self, paths: Iterable[Path] = ()):
        self.files: set[Path] = set()
        self.folders: set[Path] = set()
        for path in paths:
            self.add(path)

    def add(self, path: Path) -> None:
        """Allows a file, or a folder with all its files."""
        real = path.resolve(strict=True)
        (self.folders if real.is_dir() else self.files).add(real)

    def check(self, path: Path) -> Path:
        """Returns the path with symbolic links resolved if it may be read; raises PermissionError if not."""
        real = path.resolve()
        if real in self.files or any(real.is_relative_to(folder) for folder in self.folders):
            return real
        raise PermissionError(f"{path.name}: the studio reads only files and folders named when it was started")
