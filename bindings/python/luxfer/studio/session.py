"""One user: the current project, its results, and the connections to the page.

The page sends its whole project at every change, so that nothing is lost if the page or the server ends. Two threads
work on it: one computes the masks while strokes are painted, the other lights the room. A third one stylises.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import luxfer

from . import measure, painting, pictures, results
from . import project as projects
from .files import Files
from .jobs import Latest
from .light import Light
from .live import LiveMasks
from .project import Project
from .room import bounds, rectangle

#: Maximum number of pixels of the photo that the page shows.
SHOWN_PIXELS = 2_000_000
#: Maximum side of a picture in pixels.
MAX_SIDE = 1600

Send = Callable[[dict[str, Any], bytes], None]


@dataclass
class Wanted:
    """A state of the page that the user wants to see computed."""

    project: Project
    version: int
    size: tuple[int, int]
    compare: str
    is_draft: bool
    arrived: float


class Session:
    """One user of the server."""

    def __init__(self, name: str, context: luxfer.Context, files: Files, saved: Path):
        self.name, self.context, self.files, self.saved = name, context, files, saved
        self.listeners: list[Send] = []
        self.used = time.monotonic()
        self.wanted: Wanted | None = None
        self._lock, self._saving = threading.Lock(), threading.Lock()
        self._photo: tuple[str, luxfer.Image] | None = None
        self._room: tuple[str, luxfer.Scene] | None = None
        self._opened: tuple[str, str] | None = None
        self.small: tuple[str, LiveMasks] | None = None
        self.light: Light | None = None
        self.live: Latest[Wanted] = Latest("studio-live", self._paint, self._failed)
        self.work: Latest[Wanted] = Latest("studio-work", self._work, self._failed)
        self.painter = painting.Painter(context, self.send, self._not_painted)

    def close(self) -> None:
        """Ends the threads and releases the library's objects."""
        self.live.close()
        self.work.close()
        self.painter.close()
        self.light = self.small = self._photo = self._room = None

    # -- the page

    def send(self, kind: str, payload: bytes = b"", **header: Any) -> None:
        """Sends a message to every page of this user."""
        for listener in list(self.listeners):
            listener({"type": kind, **header}, payload)

    def take(self, message: Any) -> None:
        """Handles a message of the page; raises an error, such as Invalid, if the message is wrong."""
        if not isinstance(message, dict):
            raise projects.Invalid("a message is an object")
        if message.get("type") == "expose":
            self.expose(message.get("exposure"))
        elif message.get("type") == "paint":
            self.painter.ask(message)
            self.work.stop()  # the processors are for the tab that is shown, which sends its state when it returns
        else:
            self.edit(message)

    def hello(self) -> None:
        """Handles the connection of a page: its next edit makes the server send everything again. Running work
        continues."""
        self._opened = None

    def edit(self, message: dict[str, Any]) -> None:
        """Handles a new state of the page."""
        self.used = time.monotonic()
        project = projects.checked(message.get("project"))
        width, height = (max(64, min(MAX_SIDE, int(side))) for side in message.get("size", (640, 400)))
        compare = message.get("compare", "off")
        if compare not in ("off", "own", "white"):
            raise projects.Invalid("compare is off, own or white")
        is_draft = bool(message.get("draft"))
        wanted = Wanted(
            project, int(message.get("version", 0)), (width, height), compare, is_draft, time.perf_counter()
        )
        before, self.wanted = self.wanted, wanted
        if not is_draft:
            self._save(wanted)
            self.send("saved", version=wanted.version, file=self.saved.name)
        is_painted = (
            before is None
            or before.project["strokes"] != project["strokes"]
            or before.project["photo"] != project["photo"]
        )
        if is_painted or self._opened is None:
            self.live.put(wanted)
        if is_draft:
            self.work.stop()  # the processors are for the masks while a stroke is painted
        else:
            self.work.put(wanted)

    def expose(self, exposure: Any) -> None:
        """Changes the exposure of the shown pictures; running work continues."""
        if self.wanted is not None and self.light is not None:
            self.wanted.project["exposure"] = projects.FIELDS["exposure"](exposure, "exposure")
            self._save(self.wanted)
            self.light.show_again(self.wanted.project)

    def _save(self, wanted: Wanted) -> None:
        """Saves the project in its file, unless there is a newer project."""
        with self._saving:
            if self.wanted is wanted:
                projects.save(self.saved, wanted.project)
                for file in filter(None, (wanted.project["photo"], wanted.project["room"])):
                    self.files.renew(file["sha256"])

    # -- work

    def photo(self, project: Project) -> luxfer.Image:
        """Returns the photo of a project."""
        with self._lock:
            sha256 = project["photo"]["sha256"]
            if self._photo is None or self._photo[0] != sha256:
                data = self.files.find(sha256, project["photo"]["name"]).read()
                self._photo = sha256, luxfer.Image.from_bytes(self.context, data)
            return self._photo[1]

    def room(self, project: Project) -> luxfer.Scene:
        """Returns the room of a project."""
        with self._lock:
            sha256 = project["room"]["sha256"] if project["room"] else "demo"
            if self._room is None or self._room[0] != sha256:
                self._room = sha256, self._load_room(project)
            return self._room[1]

    def _load_room(self, project: Project) -> luxfer.Scene:
        if not project["room"]:
            return luxfer.Scene.demo(self.context, "target-room")
        known = self.files.find(project["room"]["sha256"], project["room"]["name"])
        return luxfer.Scene.from_bytes(self.context, known.read(), known.path.parent)

    def _open(self, project: Project) -> Light:
        """Loads and sends photo and room if the page does not have them."""
        photo, room = self.photo(project), self.room(project)
        key = project["photo"]["sha256"], project["room"]["sha256"] if project["room"] else "demo"
        with self._lock:
            if self._opened == key and self.light is not None:
                return self.light
            self._opened = key
            light = self.light = Light(photo, room, self.work, self.send)
        shown = pictures.reduced(photo, SHOWN_PIXELS)
        width, height, _ = photo.size
        colours = {"width": shown.size[0], "height": shown.size[1]}
        self.send("photo", shown.numpy("u1", "srgb")[..., :3].tobytes(), **colours, full=[width, height])
        low, high = ([float(x) for x in corner] for corner in bounds(room))
        candidates = [
            {"name": c.name, "kind": c.kind.name.lower(), "score": c.score, "reason": c.reason, "height": c.height}
            | {"place": rectangle(room, c.name)}
            for c in room.candidates[:12]
        ]
        self.send(
            "room",
            candidates=candidates,
            surfaces=measure.surfaces(room),
            camera=light.camera({**project, "camera": None}),
            bounds=[low, high],
            warnings=[{"code": w.code.name, "message": w.message, "advice": w.advice} for w in room.warnings],
        )
        return light

    def _paint(self, wanted: Wanted) -> None:
        """Computes and sends the masks at a small size."""
        self._open(wanted.project)
        sha256 = wanted.project["photo"]["sha256"]
        if self.small is None or self.small[0] != sha256:
            self.small = sha256, LiveMasks(self.photo(wanted.project))
        live = self.small[1]
        live.follow(wanted.project, self.live, lambda masks: self.send_live(live, masks, wanted))
        if not wanted.is_draft:
            self.send("doubt", version=wanted.version, place=live.doubt())

    def send_live(self, live: LiveMasks, masks: dict[str, luxfer.Image], wanted: Wanted) -> None:
        parts = {phase: pictures.bits(mask) for phase, mask in masks.items()}
        self.send(
            "masks",
            b"".join(data for _, data in parts.values()),
            width=live.size[0],
            height=live.size[1],
            live=True,
            version=wanted.version,
            phases=list(parts),
            seconds=time.perf_counter() - wanted.arrived,
        )

    def _work(self, wanted: Wanted) -> None:
        self.live.wait_idle(self.work.check)
        self._open(wanted.project).follow(wanted.project, wanted.size, wanted.compare)
        self._save(wanted)  # with the settings that the plan has chosen
        self.send("idle", version=wanted.version)

    def _not_painted(self, failure: Exception) -> None:
        """Sends an error of the stylisation to the page."""
        self.send("not-painted", message=projects.message(failure))

    def _failed(self, failure: Exception) -> None:
        """Sends the error to the page, which asks for a missing file."""
        header = projects.failure(failure)
        self.send(header.pop("type"), **header)

    # -- results

    def out(self, kind: str, folder: Path) -> Path:
        """Writes a file of results into a folder and returns its path; raises NotReady if the results are missing or
        belong to an older state of the project."""
        if kind in painting.RESULTS:
            return self.painter.out(kind, folder)
        wanted, light = self.wanted, self.light
        if wanted is None or light is None:
            raise luxfer.errors.NotReady("there is no result yet")
        results.check_ready(kind, wanted, light)
        name = Path(wanted.project["photo"]["name"]).stem or "studio"
        path = folder / f"{name}.{results.ENDINGS[kind]}"
        results.write(kind, path, wanted, light)
        if self.wanted is not wanted:  # the page has changed it while the file was written
            raise luxfer.errors.NotReady("the project has been changed: try again in a moment")
        return path
