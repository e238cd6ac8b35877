"""The web application: its routes and its start. security.Guard checks every request first."""

from __future__ import annotations

import argparse
import asyncio
import json
import shutil
import socket
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

import luxfer
import uvicorn
from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from ..cli.exits import Exit
from . import project as projects
from . import rooms
from .files import MAX_UPLOAD, Files, Known, state_folder
from .opening import Opening
from .outbox import Outbox
from .security import Allowed, Guard, new_token
from .session import Session

STATIC = Path(__file__).resolve().parent / "static"
#: Maximum number of sessions. Beyond it, sessions without an open page are closed, the least recently used first.
MAX_SESSIONS = 8
#: Maximum size of a project file in bytes: 16 MiB hold over a million points of strokes. [convention]
MAX_PROJECT = 16 << 20
PHOTOS = {".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff", ".bmp", ".gif", ".hdr", ".exr"}
ROOMS = rooms.GLTF | rooms.USD
#: Advice about a file of another kind, by the ending of its name.
CONVERSIONS = {
    ending: what
    for endings, what in (
        (".heic .heif .avif", ": save it as JPEG (on an iPhone: Camera > Formats > Most Compatible)"),
        (".dng .cr2 .cr3 .nef .arw .raf", ": develop it to JPEG or TIFF in a photo program"),
        (
            ".blend .fbx .obj .skp .3ds .max .dae .stl .ifc .rvt",
            ": export it as .glb from the program that made it",
        ),
    )
    for ending in endings.split()
}


class Studio:
    """The state that all users share."""

    def __init__(self, files: Files, first: projects.Project | None, project_file: Path | None):
        self.files, self.first, self.project_file = files, first, project_file
        self.context = luxfer.Context()
        self.sessions: dict[str, Session] = {}
        self.lock = threading.Lock()

    def start(self) -> projects.Project:
        """Returns the project of a new page; generates the demonstration photo if no photo was named."""
        first = self.first or projects.DEFAULTS
        if first["photo"] is None:
            known = self.files.demo(self.context)
            first = {**first, "photo": {"name": known.name, "sha256": known.sha256}}
        return projects.checked(first)

    def session(self, name: str) -> Session:
        """Returns the session of this name, and creates it if there is none."""
        with self.lock:
            if name not in self.sessions:
                self._make_room()
                saved = self.files.state / f"session-{name}.json"
                if self.project_file is not None and all(
                    s.saved != self.project_file for s in self.sessions.values()
                ):
                    saved = self.project_file
                self.sessions[name] = Session(name, self.context, self.files, saved)
            return self.sessions[name]

    def _make_room(self) -> None:
        idle = sorted((s for s in self.sessions.values() if not s.listeners), key=lambda s: s.used)
        for session in idle[: max(0, len(self.sessions) - MAX_SESSIONS + 1)]:
            del self.sessions[session.name]
            session.close()

    def close(self) -> None:
        for session in self.sessions.values():
            session.close()
        self.sessions.clear()

    # -- routes

    async def get_start(self, request: Request) -> Response:
        """GET start: sends the first project and the names of the sessions that have an open page."""
        project = await run_in_threadpool(self.start)
        live = [name for name, session in list(self.sessions.items()) if session.listeners]
        named = self.first is not None and self.first["photo"] is not None
        return JSONResponse({"project": project, "open": live, "named": named, "version": luxfer.__version__})

    async def put_file(self, request: Request) -> Response:
        """POST files?name=: receives a photo or a room from the page."""
        data = await body(request, MAX_UPLOAD)
        if data is None:
            return problem(f"the file is larger than {MAX_UPLOAD >> 20} MiB", 413)
        name = request.query_params.get("name", "file")
        if not data:
            return problem(f"{name} is empty: copy it anew from where it comes from, and open it again")
        suffix = Path(name).suffix.lower()
        if suffix not in PHOTOS | ROOMS:
            return problem(
                f"{name} is no photo (JPEG, PNG, WebP, TIFF, BMP, GIF, HDR, EXR) and no room (.glb, .gltf, USD)"
                f"{CONVERSIONS.get(suffix, '')}"
            )
        try:
            name, data = await run_in_threadpool(rooms.given, self.context, name, data)
            await run_in_threadpool(self.try_file, data, Path(name).suffix.lower())
        except (luxfer.Error, ValueError) as error:
            return problem(f"{name} cannot be read: {error}")
        known = await run_in_threadpool(self.files.upload, name, data)
        return JSONResponse({"name": known.name, "sha256": known.sha256, "is_room": suffix in ROOMS})

    def try_known(self, known: Known, data: bytes) -> None:
        """As try_file, for a file on disk, which may name files in its folder. USD is read when it is converted."""
        if not rooms.is_usd(known.name):
            self.try_file(data, known.path.suffix.lower(), known.path.parent)

    def try_file(self, data: bytes, suffix: str, folder: Path | None = None) -> None:
        """Reads a file by the library, and raises its error if that fails."""
        if suffix in ROOMS:
            scene = luxfer.Scene.from_bytes(self.context, data, folder)
            if not scene.candidates:
                what = "it has no surface that could receive lights: model its ceiling as a flat object"
                raise luxfer.errors.Degenerate(what)
        else:
            luxfer.Image.from_bytes(self.context, data)

    async def get_files(self, request: Request) -> Response:
        """GET files: lists the files in the folders that the user named; open=PATH opens one of them."""
        if wanted := request.query_params.get("open"):
            try:
                known = await run_in_threadpool(self.files.open, Path(wanted), self.try_known)
                known = await run_in_threadpool(rooms.opened, self.context, self.files, known)
            except (OSError, ValueError, luxfer.Error) as error:
                return problem(str(error), 403 if isinstance(error, PermissionError) else 400)
            return JSONResponse(
                {"name": known.name, "sha256": known.sha256, "is_room": known.path.suffix.lower() in ROOMS}
            )
        found = [*self.files.allowed.files]
        for folder in self.files.allowed.folders:
            found += [p for p in sorted(folder.iterdir()) if p.is_file()]
        listed = [
            {"path": str(p), "name": p.name, "is_room": p.suffix.lower() in ROOMS}
            for p in found[:500]
            if p.suffix.lower() in PHOTOS | ROOMS
        ]
        return JSONResponse({"files": listed})

    async def put_project(self, request: Request) -> Response:
        """POST projects: receives the text of a project file; sends its project, or the error in it."""
        data = await body(request, MAX_PROJECT)
        if data is None:
            return problem(f"the project is larger than {MAX_PROJECT >> 20} MiB", 413)
        try:
            return JSONResponse({"project": projects.checked(json.loads(data))})
        except (projects.Invalid, UnicodeDecodeError, json.JSONDecodeError) as error:
            return problem(str(error))
        except RecursionError:
            return problem("the project is nested too deeply")

    async def put_artwork(self, request: Request) -> Response:
        """POST artwork?session=&sheet=: receives an artwork of the ball, or with sheet=1 a photo of the painted sheet;
        sends it as it lies on the ball."""
        session = self.sessions.get(request.query_params.get("session", ""))
        if session is None:
            return problem("there is no such session", 404)
        data = await body(request, MAX_UPLOAD)
        if data is None:
            return problem(f"the artwork is larger than {MAX_UPLOAD >> 20} MiB", 413)
        try:
            is_sheet = request.query_params.get("sheet") == "1"
            await run_in_threadpool(session.painter.take_artwork, data, is_sheet)
        except (luxfer.Error, projects.Invalid) as error:
            return problem(f"the artwork cannot be used: {projects.message(error)}")
        assert session.painter.own is not None
        return Response(session.painter.shown(session.painter.own), media_type="application/octet-stream")

    async def get_room(self, request: Request) -> Response:
        """GET room.glb?session=: sends the room before it is lit, for the page's own 3D view."""
        session = self.sessions.get(request.query_params.get("session", ""))
        if session is None or session.wanted is None:
            return problem("there is no such session", 404)
        try:
            room = await run_in_threadpool(session.room, session.wanted.project)
            data = await run_in_threadpool(room.to_bytes)
        except (OSError, ValueError, luxfer.Error) as error:
            return problem(projects.message(error), 404 if isinstance(error, FileNotFoundError) else 409)
        return Response(data, media_type="model/gltf-binary")

    async def get_out(self, request: Request) -> Response:
        """GET out/KIND?session=: sends a result as a file to download."""
        session = self.sessions.get(request.query_params.get("session", ""))
        if session is None:
            return problem("there is no such session", 404)
        folder = Path(tempfile.mkdtemp(prefix="luxfer-studio-"))
        done = BackgroundTask(shutil.rmtree, folder, ignore_errors=True)
        try:
            path = await run_in_threadpool(session.out, request.path_params["kind"], folder)
        except (luxfer.Error, LookupError, OSError) as error:
            shutil.rmtree(folder, ignore_errors=True)
            return problem(projects.message(error), 409)
        return FileResponse(path, filename=path.name, background=done)

    async def talk(self, socket: WebSocket) -> None:
        """WebSocket ws?session=: receives edits, and sends results, each as a JSON header and bytes."""
        name = socket.query_params.get("session", "")
        if not (8 <= len(name) <= 64 and name.isascii() and name.isalnum()):
            await socket.close(1008)
            return
        session = await run_in_threadpool(self.session, name)  # before the page can ask for anything of it
        await socket.accept()
        loop, outbox = asyncio.get_running_loop(), Outbox()

        def listen(header: dict[str, Any], payload: bytes) -> None:
            loop.call_soon_threadsafe(outbox.put, header, payload)

        async def speak() -> None:
            while (message := await outbox.get()) is not None:
                await socket.send_bytes(message)
            await socket.close(1013)  # "try again later": the page connects anew

        session.hello()
        session.listeners.append(listen)
        speaker = asyncio.create_task(speak())
        try:
            while True:
                message = await socket.receive_json()
                try:
                    await run_in_threadpool(session.take, message)
                except (projects.Invalid, TypeError, ValueError, ArithmeticError, OSError, luxfer.Error) as error:
                    listen(projects.failure(error), b"")
        except (WebSocketDisconnect, json.JSONDecodeError, RecursionError, KeyError):  # KeyError: bytes, not a text
            pass
        finally:
            session.listeners.remove(listen)
            if not session.listeners:
                session.work.stop()  # nobody looks at it
                session.painter.work.stop()
            speaker.cancel()

    def app(self) -> Starlette:
        return Starlette(
            routes=[
                Route("/start", self.get_start),
                Route("/files", self.put_file, methods=["POST"]),
                Route("/files", self.get_files, methods=["GET"]),
                Route("/projects", self.put_project, methods=["POST"]),
                Route("/artwork", self.put_artwork, methods=["POST"]),
                Route("/room.glb", self.get_room),
                Route("/out/{kind}", self.get_out),
                WebSocketRoute("/ws", self.talk),
                Mount("/", StaticFiles(directory=STATIC, html=True)),
            ]
        )


async def body(request: Request, max_bytes: int) -> bytes | None:
    """Reads the body of a request; stops and returns None if it is longer than `max_bytes`."""
    stated = request.headers.get("content-length", "")
    if stated.isdecimal() and int(stated) > max_bytes:
        return None
    data = bytearray()
    async for part in request.stream():
        data += part
        if len(data) > max_bytes:
            return None
    return bytes(data)


def problem(message: str, status: int = 400) -> Response:
    """An answer with an error message."""
    return JSONResponse({"message": message}, status)


def convert(files: Files, known: Known) -> Known:
    """Converts a room in USD that the command line names."""
    try:
        with luxfer.Context() as context:
            return rooms.opened(context, files, known)
    except (ValueError, luxfer.Error) as error:
        raise projects.Invalid(f"{known.name} cannot be read: {error}") from None


def first_project(asked: argparse.Namespace, files: Files) -> tuple[projects.Project | None, Path | None]:
    """Returns the project that the command line names, and the file in which it is saved."""
    project: projects.Project | None = None
    kept, photo = asked.project, asked.photo
    if photo is not None and photo.suffix.lower() == ".json":
        if kept is not None:
            raise projects.Invalid(f"there are two projects: {photo} and --project {kept}")
        kept, photo = photo, None
        if not kept.exists():
            raise FileNotFoundError(f"there is no file {kept}")
    if kept is not None and kept.exists():
        project = projects.load(kept)
        files.open_named(project, kept.resolve().parent)
    for path, entry in ((photo, "photo"), (asked.scene, "room")):
        if path is not None:
            if not path.exists():
                raise FileNotFoundError(f"there is no file {path}")
            files.allowed.add(path)
            known = files.open(path)
            if rooms.is_usd(known.name):
                known = convert(files, known)
            project = {**(project or projects.DEFAULTS), entry: {"name": known.name, "sha256": known.sha256}}
    return project, kept.resolve() if kept is not None else None


def bind(port: int) -> socket.socket:
    """Opens a socket on the loopback address. It uses the same port at each start if that is free, because the browser
    stores strokes by port."""
    for candidate in [port, *range(port + 1, port + 20), 0] if port else [0]:
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        if sys.platform == "win32":  # there, another program could otherwise bind the same port over it
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        else:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind(("127.0.0.1", candidate))
            listener.listen(64)  # from here on, requests to the printed address are answered
            return listener
        except OSError:
            listener.close()
    raise OSError("no port is free")


def serve(asked: argparse.Namespace) -> int:
    """Runs the server until it is interrupted."""
    if not (STATIC / "index.html").exists():
        print(
            f"the page of the studio has not been built ({STATIC} is empty): run `make studio` first", file=sys.stderr
        )
        return Exit.FAILED
    for folder in asked.folder:
        if not folder.is_dir():
            print(f"luxfer studio: --folder: there is no folder {folder}", file=sys.stderr)
            return Exit.UNREADABLE
    state = asked.state or state_folder()
    try:
        files = Files(state, Allowed(asked.folder))
    except OSError as error:
        print(
            f"luxfer studio: --state: {state} cannot keep files: {error.strerror or error}; name another folder",
            file=sys.stderr,
        )
        return Exit.FAILED
    try:
        first, kept = first_project(asked, files)
    except (OSError, projects.Invalid) as error:
        print(f"luxfer studio: {error}", file=sys.stderr)
        return Exit.UNREADABLE
    studio, listener, token = Studio(files, first, kept), bind(asked.port), new_token()
    port = listener.getsockname()[1]
    address = f"http://127.0.0.1:{port}/{token}/"
    guarded = Guard(studio.app(), token, port)
    # Do not compress results: they are masks and pixels, for which compression only costs time.
    config = uvicorn.Config(
        guarded, log_level="warning", ws="websockets-sansio", ws_per_message_deflate=False, lifespan="off"
    )
    print(f"luxfer studio: {address}", flush=True)
    opening = None
    if not asked.no_browser:
        opening = Opening(files.state, f"http://127.0.0.1:{port}/{guarded.new_code()}")
        threading.Timer(0.5, opening.show).start()
    try:
        uvicorn.Server(config).run(sockets=[listener])
    except KeyboardInterrupt:
        pass
    finally:
        if opening is not None:
            opening.close()
    studio.close()
    return 0
