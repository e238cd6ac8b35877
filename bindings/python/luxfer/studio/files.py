"""Photos, scenes and project files, by the hash of their content.

A project names its files by hash, so it does not depend on where they lie. Files that a user drops on the page are
stored in the state folder, so that they are still there after a restart of the server.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import luxfer

from .project import Project
from .security import Allowed

#: Size of the photo that the library generates if there is none: a few seconds of work.
DEMO_SIZE = (600, 400)
DEMO_NAME = "generated office.png"
#: Maximum size of an upload in bytes.
MAX_UPLOAD = 1 << 30
#: Files of the studio in its state folder are deleted if they have not been used for this time.
KEEP_SECONDS = 30 * 24 * 3600.0
#: Patterns of the studio's own names in the state folder: projects of sessions (SESSION), pages that open the studio
#: (OPENING), uploaded files (KEPT: hash and name), and files that are being written (PARTIAL).
#: Files with other names belong to the user.
SESSION = re.compile(r"session-[A-Za-z0-9]{8,64}\.json")
OPENING = re.compile(r"open-studio-[0-9a-f]{16}\.html")
KEPT = re.compile(r"([0-9a-f]{64})-(.+)", re.DOTALL)
PARTIAL = re.compile(r"\.[0-9a-f]{64}")


@dataclass(frozen=True)
class Known:
    """A file that the server may read."""

    name: str
    sha256: str
    path: Path

    def read(self) -> bytes:
        """Reads the content. Raises an error if it no longer has this hash."""
        data = self.path.read_bytes()
        if digest(data) != self.sha256:
            raise ValueError(f"{self.name} has been changed since it was opened: open it again")
        return data


def digest(data: bytes) -> str:
    """Returns the hash by which projects name files."""
    return hashlib.sha256(data).hexdigest()


def is_project(path: Path) -> bool:
    """Whether a file is a project of the studio."""
    try:
        value = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(value, dict) and "luxfer_studio" in value


def state_folder() -> Path:
    """Returns the studio's folder at the system's place for the state of programs."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "luxfer-studio"
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "luxfer-studio"


class Files:
    """The files of one server."""

    def __init__(self, state: Path, allowed: Allowed):
        self.state, self.allowed = state, allowed
        self.known: dict[str, Known] = {}
        self._demo_lock = threading.Lock()
        for folder in (state, state / "files"):
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._forget_old()
        for path in sorted((state / "files").iterdir()):
            if (named := KEPT.fullmatch(path.name)) and path.is_file():
                self.known[named[1]] = Known(named[2], named[1], path)

    def _forget_old(self) -> None:
        """Deletes the studio's own files that have not been used for a month."""
        sessions = [p for p in self.state.iterdir() if SESSION.fullmatch(p.name) and is_project(p)]
        openings = [p for p in self.state.iterdir() if OPENING.fullmatch(p.name)]
        inside = (self.state / "files").iterdir()
        given = [p for p in inside if KEPT.fullmatch(p.name) or PARTIAL.fullmatch(p.name)]
        for path in sessions + openings + given:
            if path.is_file() and time.time() - path.stat().st_mtime > KEEP_SECONDS:
                path.unlink()

    def renew(self, sha256: str) -> None:
        """Marks an uploaded file as used, so that it is kept for another month."""
        known = self.known.get(sha256)
        if known is not None and known.path.parent == self.state / "files" and known.path.exists():
            os.utime(known.path)

    def open(self, path: Path, check: Callable[[Known, bytes], None] | None = None) -> Known:
        """Opens a file that the user has named, or that lies in a folder that the user has named. `check` raises an
        error if the content is wrong."""
        real = self.allowed.check(path)
        data = real.read_bytes()
        known = Known(real.name, digest(data), real)
        if check is not None:
            check(known, data)
        self.known[known.sha256] = known
        return known

    def open_named(self, project: Project, folder: Path) -> None:
        """Opens the files of a project that lie in its folder and have the hashes that the project states. A project
        may come from a stranger, so its file names must not lead out of the folder."""
        folder = folder.resolve()
        for file in filter(None, (project["photo"], project["room"])):
            path = (folder / file["name"]).resolve()
            if path.parent == folder and path.is_file() and digest(path.read_bytes()) == file["sha256"]:
                self.allowed.add(path)
                self.open(path)

    def upload(self, name: str, data: bytes) -> Known:
        """Stores a file that the user has given to the page."""
        safe = (
            "".join(c if c.isalnum() or c in " ._-" else "_" for c in Path(name.replace("\\", "/")).name)[-80:]
            or "file"
        )
        sha256 = digest(data)
        path = self.state / "files" / f"{sha256}-{safe}"
        if not path.exists():
            partial = path.with_name(f".{sha256}")
            partial.write_bytes(data)
            partial.replace(path)
        os.utime(path)
        self.known[sha256] = Known(safe, sha256, path)
        return self.known[sha256]

    def find(self, sha256: str, name: str) -> Known:
        """Returns a file that a project names; raises FileNotFoundError, upon which the page asks the user for the
        file."""
        if sha256 in self.known:
            self.renew(sha256)
            return self.known[sha256]
        for folder in self.allowed.folders:
            path = folder / name
            if path.is_file() and path.resolve().is_relative_to(folder) and digest(path.read_bytes()) == sha256:
                return self.open(path)
        raise FileNotFoundError(f"the project needs the file {name}")

    def demo(self, context: luxfer.Context) -> Known:
        """Returns the demonstration photo, which is generated once and then kept."""
        with self._demo_lock:
            width, height = DEMO_SIZE
            path = self.state / f"demo-{luxfer.__version__}-{width}.png"
            if not path.exists():
                partial = path.with_name("demo-partial.png")
                luxfer.DemoPhoto(context).run(width=width, height=height).image("picture").save(partial)
                partial.replace(path)
            return self.upload(DEMO_NAME, path.read_bytes())
