"""What the studio keeps, deletes and opens, and what it refuses. Runs where benches/peers/install.sh has installed
`studio`."""

import asyncio
import contextlib
import io
import json
import os
import re
import stat
import struct
import time
import unittest
from unittest import mock

from support import PACKAGE, Case, context, luxfer

from luxfer.studio import app, command, files, main, opening, outbox, project, security
from luxfer.studio.session import Wanted

MONTH = files.KEEP_SECONDS


class Start(Case):
    """Command lines that start nothing: the exit code, and one line that names the option."""

    def start(self, *words):
        err = io.StringIO()
        with mock.patch.object(app, "STATIC", self.folder), contextlib.redirect_stderr(err):
            (self.folder / "index.html").write_text("page")
            try:
                code = main(["--no-browser", *map(str, words)])
            except SystemExit as end:
                code = end.code
        return code, err.getvalue()

    def test_what_is_wrong_is_said_in_one_line(self):
        file = self.folder / "index.html"
        good = ("--state", self.folder / "state")
        for code, said, *words in (
            (2, "--port: 'many' is not a port", "--port", "many"),
            (2, "--port: '70000' is not a port in [0, 65535]", "--port", "70000"),
            (2, "unrecognized arguments: --fold", "--fold", self.folder),
            (3, "there is no file", *good, self.folder / "none.jpg"),
            (3, "--folder: there is no folder", *good, "--folder", self.folder / "none"),
            (3, "is not a project of luxfer studio", *good, "--project", file),
            (5, "cannot keep files", "--state", file / "below"),
        ):
            found, text = self.start(*words)
            self.assertEqual(found, code, text)
            self.assertIn(said, text)
            self.assertTrue(text.startswith("luxfer studio: ") and text.count("\n") == 1, text)


class State(Case):
    """The state folder, which may be a folder that holds the user's own files."""

    def put(self, name, content=b"x", age=MONTH + 60):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
        os.utime(path, (time.time() - age,) * 2)
        return path

    def start(self):
        return files.Files(self.folder, security.Allowed())

    def test_files_of_the_user_survive(self):
        own = [
            self.put(name)
            for name in (
                "package.json",
                "room.luxfer.json",
                "session-notes.json",
                "session-recording.json",
                "files/thesis.pdf",
                "files/notes.json",
                f"files/{'a' * 63}-short.png",
                f"files/{'g' * 64}-no hash.png",
                f"files/{'a' * 64}",
                ".hidden",
            )
        ]
        self.start()
        self.assertEqual([path.name for path in own if not path.exists()], [])

    def test_old_files_of_the_studio_are_forgotten(self):
        whole = json.dumps({"luxfer_studio": 1}).encode()
        old = [
            self.put("session-0123456789abcdef01234567.json", whole),
            self.put(f"files/{'a' * 64}-photo.png"),
            self.put(f"files/.{'b' * 64}"),
        ]
        new = [
            self.put("session-1123456789abcdef01234567.json", whole, MONTH - 60),
            self.put(f"files/{'c' * 64}-photo.png", age=MONTH - 60),
        ]
        state = self.start()
        self.assertEqual([path.name for path in old if path.exists()], [])
        self.assertEqual([path.name for path in new if not path.exists()], [])
        self.assertEqual(list(state.known), ["c" * 64])

    def test_files_in_use_are_kept(self):
        path = self.put("upload")
        known = self.start().upload("photo.png", path.read_bytes())
        for use in (lambda s: s.find(known.sha256, "photo.png"), lambda s: s.renew(known.sha256)):
            os.utime(known.path, (time.time() - MONTH + 60,) * 2)
            use(self.start())
            self.assertLess(time.time() - known.path.stat().st_mtime, 60)

    def test_files_outside_of_the_folder_keep_their_dates(self):
        path = self.put("photo.png", age=1000)
        state = files.Files(self.folder / "state", security.Allowed([path]))
        state.find(state.open(path).sha256, "photo.png")
        self.assertGreater(time.time() - path.stat().st_mtime, 900)


class Folders(Case):
    """Files that the page may open."""

    def setUp(self):
        super().setUp()
        for name in ("photo.png", "other.png", "deep/below.png"):
            (self.folder / "here" / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / "here" / name).write_bytes(name.encode())
        (self.folder / "secret.png").write_bytes(b"secret")

    def start(self, photo, content):
        """The files of a studio that was started with a project."""
        named = {"luxfer_studio": 1, "photo": {"name": photo, "sha256": files.digest(content)}}
        kept = self.folder / "here" / "room.luxfer.json"
        kept.write_text(json.dumps(named))
        opened = files.Files(self.folder / "state", security.Allowed())
        app.first_project(command.parser().parse_args(["--project", str(kept)]), opened)
        return opened

    def test_a_project_opens_only_the_files_that_it_names(self):
        opened = self.start("photo.png", b"photo.png")
        self.assertEqual(opened.find(files.digest(b"photo.png"), "photo.png").read(), b"photo.png")
        for name in ("other.png", "deep/below.png", "room.luxfer.json", "../secret.png"):
            with self.assertRaises(PermissionError, msg=name):
                opened.open(self.folder / "here" / name)

    def test_two_projects_are_refused(self):
        self.start("photo.png", b"photo.png")
        kept = str(self.folder / "here" / "room.luxfer.json")
        opened = files.Files(self.folder / "state", security.Allowed())
        with self.assertRaises(project.Invalid):
            app.first_project(command.parser().parse_args([kept, "--project", kept + ".other"]), opened)

    def test_names_in_a_project_do_not_lead_out_of_its_folder(self):
        (self.folder / "here" / "link.png").symlink_to(self.folder / "secret.png")
        for name in ("../secret.png", str(self.folder / "secret.png"), "link.png"):
            opened = self.start(name, b"secret")
            self.assertEqual((opened.allowed.files, opened.known), (set(), {}), name)

    def test_a_file_of_the_name_with_another_content_is_not_opened(self):
        opened = self.start("photo.png", b"another")
        self.assertEqual(opened.allowed.files, set())

    def test_a_file_that_is_no_photo_is_not_known(self):
        opened = files.Files(self.folder / "state", security.Allowed([self.folder / "here"]))
        studio = app.Studio(opened, None, None)
        with self.assertRaises(luxfer.Error):
            opened.open(self.folder / "here" / "photo.png", studio.try_known)
        self.assertEqual(opened.known, {})

    def test_a_room_with_files_beside_it_is_opened_from_a_folder(self):
        room = self.folder / "here" / "room.gltf"
        with_buffer_beside(room)
        opened = files.Files(self.folder / "state", security.Allowed([self.folder / "here"]))
        studio = app.Studio(opened, None, None)
        status, answer = route(studio, f"/files?open={room}")
        self.assertEqual((status, json.loads(answer).get("name")), (200, "room.gltf"), answer)
        known = opened.find(json.loads(answer)["sha256"], "room.gltf")
        self.assertEqual(known.path, room.resolve())
        # Given to the page, it has no folder: what is missing is said.
        status, answer = route(studio, "/files?name=room.gltf", room.read_bytes())
        self.assertEqual(status, 400)
        self.assertIn("beside it", json.loads(answer)["message"])


class Limits(Case):
    """How much a page may send, and leave lying."""

    def setUp(self):
        super().setUp()
        self.studio = app.Studio(files.Files(self.folder / "state", security.Allowed()), None, None)

    def test_a_project_has_a_largest_size(self):
        good = json.dumps({"luxfer_studio": 1, "photo": {"name": "a.png", "sha256": "0" * 64}}).encode()
        with mock.patch.object(app, "MAX_PROJECT", len(good)):
            self.assertEqual(route(self.studio, "/projects", good)[0], 200)
            parts = [good, b" ", b"never read"]
            self.assertEqual(route(self.studio, "/projects", parts)[0], 413)
            self.assertEqual(parts, [b"never read"])
            parts = [b"never read"]
            self.assertEqual(route(self.studio, "/projects", parts, content_length=str(len(good) + 1))[0], 413)
            self.assertEqual(parts, [b"never read"])

    def test_an_upload_has_a_largest_size(self):
        with mock.patch.object(app, "MAX_UPLOAD", 3):
            self.assertEqual(route(self.studio, "/files?name=a.png", [b"ab", b"c"])[0], 400)
            parts = [b"ab", b"cd", b"never read"]
            self.assertEqual(route(self.studio, "/files?name=a.png", parts)[0], 413)
            parts = [b"never read"]
            self.assertEqual(route(self.studio, "/files?name=a.png", parts, content_length="4")[0], 413)
            self.assertEqual(parts, [b"never read"])
        self.assertEqual(list((self.folder / "state" / "files").iterdir()), [])

    def test_users_without_a_page_make_room(self):
        for i in range(app.MAX_SESSIONS + 3):
            session = self.studio.session(f"session{i:02}")
            session.used = i
            if i in (0, 4):
                session.listeners.append(lambda header, payload: None)
        self.addCleanup(self.studio.close)
        named = sorted(self.studio.sessions)
        self.assertEqual(len(named), app.MAX_SESSIONS)
        self.assertEqual(named, [f"session{i:02}" for i in (0, 4, 5, 6, 7, 8, 9, 10)])

    def test_a_project_nested_too_deeply_is_refused(self):
        self.assertEqual(route(self.studio, "/projects", b"[" * 200_000)[0], 400)

    def test_a_sleeping_page_gets_the_newest_picture_alone(self):
        async def work():
            waiting = outbox.Outbox()
            for i in range(100):
                for which in ("before", "after"):
                    waiting.put({"type": "picture", "which": which, "i": i}, bytes(1000))
            for kind in ("texture", "failed", "failed"):
                waiting.put({"type": kind}, b"")
            count, size = len(waiting), waiting.size
            return count, size, [await waiting.get() for _ in range(count)], waiting.size

        count, size, messages, after = asyncio.run(work())
        self.assertEqual(count, 5)
        self.assertLess(size, 2500)
        self.assertEqual(after, 0)
        headers = [json.loads(m[4 : 4 + struct.unpack_from("<I", m)[0]]) for m in messages]
        self.assertEqual([h["type"] for h in headers], ["picture", "picture", "texture", "failed", "failed"])
        self.assertEqual([(h["which"], h["i"]) for h in headers[:2]], [("before", 99), ("after", 99)])

    def test_a_page_that_lets_too_much_wait_is_cut_off(self):
        async def work():
            waiting = outbox.Outbox(max_size=2000)
            for _ in range(3):
                waiting.put({"type": "texture"}, bytes(900))
            return await waiting.get(), waiting.size

        self.assertEqual(asyncio.run(work()), (None, 0))

    def test_a_waiting_page_gets_what_comes(self):
        async def work():
            waiting = outbox.Outbox()
            asyncio.get_running_loop().call_later(0.05, waiting.put, {"type": "idle"}, b"bytes")
            return await asyncio.wait_for(waiting.get(), 5)

        self.assertTrue(asyncio.run(work()).endswith(b"bytes"))


class Talk(Case):
    """Messages that no page of the studio sends."""

    def setUp(self):
        super().setUp()
        self.studio = app.Studio(files.Files(self.folder / "state", security.Allowed()), None, None)
        self.addCleanup(self.studio.close)

    def talk(self, *messages):
        """What comes back through a socket, and how it is closed."""
        waiting = [{"type": "websocket.connect"}, *messages, {"type": "websocket.disconnect", "code": 1000}]
        sent = []

        async def receive():
            await asyncio.sleep(0.05)  # answers are sent meanwhile
            return waiting.pop(0)

        async def send(message):
            sent.append(message)

        scope = {"type": "websocket", "path": "/ws", "query_string": b"session=session01", "headers": []}
        with mock.patch.object(app, "STATIC", PACKAGE):
            asyncio.run(self.studio.app()({**scope, "root_path": "", "scheme": "ws"}, receive, send))
        answers = [m["bytes"] for m in sent if m["type"] == "websocket.send"]
        return [json.loads(a[4 : 4 + struct.unpack_from("<I", a)[0]]) for a in answers]

    def test_wrong_messages_are_answered(self):
        good = {"luxfer_studio": 1, "photo": {"name": "a.png", "sha256": "0" * 64}}
        wrong = [
            "[1, 2]",
            "3",
            "null",
            '{"project": 3}',
            f'{{"project": {json.dumps(good)}, "size": [1e999, 1]}}',
            f'{{"project": {json.dumps(good)}, "size": 3}}',
            f'{{"project": {json.dumps(good)}, "version": 1e999}}',
        ]
        answers = self.talk(*({"type": "websocket.receive", "text": text} for text in wrong))
        self.assertEqual([a["type"] for a in answers], ["failed"] * len(wrong), answers)
        for answer in answers:
            self.assertGreater(len(answer["message"]), 5)

    def test_what_is_no_message_ends_the_connection(self):
        for last in ({"bytes": b"abc"}, {"text": "{"}, {"text": "[" * 200_000}):
            self.assertEqual(self.talk({"type": "websocket.receive", **last}), [])

    def test_an_error_without_a_message_is_reported_by_its_name(self):
        messages = []
        session = self.studio.session("session01")
        session.listeners.append(lambda header, payload: messages.append(header))
        for failure in (MemoryError(), AssertionError(), FileNotFoundError("gone")):
            session._failed(failure)
        self.assertEqual([t["message"] for t in messages], ["MemoryError", "AssertionError", "gone"])
        self.assertEqual([t["missing"] for t in messages], [False, False, True])

    def test_a_room_that_is_missing_is_said(self):
        session = self.studio.session("session01")
        file = {"name": "gone.glb", "sha256": "1" * 64}
        whole = project.checked({"luxfer_studio": 1, "photo": file, "room": file})
        session.wanted = Wanted(whole, 1, (64, 64), "off", False, 0.0)
        status, answer = route(self.studio, "/room.glb?session=session01")
        self.assertEqual(status, 404)
        self.assertIn("gone.glb", json.loads(answer)["message"])


def with_buffer_beside(path):
    """Writes the generated room as a .gltf with its buffer in a file beside it."""
    data = luxfer.Scene.demo(context(), "target-room").to_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    whole = json.loads(data[20 : 20 + length])
    whole["buffers"][0]["uri"] = "room.bin"
    path.write_text(json.dumps(whole))
    path.with_name("room.bin").write_bytes(data[28 + length :])


def route(studio, path, body=None, **headers):
    """Status and content of an answer of the application, without a server and its guard. A body of several parts is a
    list."""
    parts = body if isinstance(body, list) else [body or b""]
    sent = []

    async def receive():
        part = parts.pop(0)
        return {"type": "http.request", "body": part, "more_body": bool(parts)}

    async def send(message):
        sent.append(message)

    place, _, query = path.partition("?")
    scope = {
        "type": "http",
        "http_version": "1.1",
        "method": "GET" if body is None else "POST",
        "path": place,
        "root_path": "",
        "scheme": "http",
        "server": ("127.0.0.1", 1),
        "query_string": query.encode(),
        "headers": [(k.replace("_", "-").encode(), v.encode()) for k, v in headers.items()],
    }
    with mock.patch.object(app, "STATIC", PACKAGE):
        asyncio.run(studio.app()(scope, receive, send))
    return sent[0]["status"], b"".join(message.get("body", b"") for message in sent[1:])


class Page:
    """An ASGI application that stands for the page, and a guard around it."""

    def __init__(self):
        self.guard, self.paths = security.Guard(self, "token", 1), []

    async def __call__(self, scope, receive, send):
        self.paths.append(scope["path"])
        await send({"type": "http.response.start", "status": 200, "headers": []})

    def ask(self, path, method="GET", **headers):
        """Status and text of an answer."""
        sent = []

        async def send(message):
            sent.append(message)

        given = {"host": "127.0.0.1:1", **{k.replace("_", "-"): v for k, v in headers.items()}}
        scope = {
            "type": "http",
            "method": method,
            "path": path,
            "headers": [(k.encode(), v.encode()) for k, v in given.items()],
        }
        asyncio.run(self.guard(scope, None, send))
        return sent[0]["status"], sent[-1].get("body", b"").decode()


class Door(Case):
    """How the page is opened, and requests that no browser sends."""

    def test_the_browser_is_started_without_the_token(self):
        page, given = Page(), []
        address = f"http://127.0.0.1:1/{page.guard.new_code()}"
        made = opening.Opening(self.folder, address)
        with mock.patch("webbrowser.open", given.append):
            made.show()
        self.assertEqual(given, [made.path.as_uri()])
        self.assertNotIn(page.guard.code, given[0])
        self.assertEqual(stat.S_IMODE(made.path.stat().st_mode), 0o600)
        text = made.path.read_text()
        self.assertIn(f'content="0; url={address}"', text)
        self.assertNotIn("token", text)
        made.close()
        self.assertFalse(made.path.exists())

    def test_the_server_starts_the_browser_by_that_file(self):
        given = []
        asked = command.parser().parse_args(["--port", "0", "--state", str(self.folder / "state")])

        def run(server, sockets):
            time.sleep(1)  # the browser is started half a second after the server
            given.extend(path.name for path in (self.folder / "state").glob("*.html"))
            sockets[0].close()

        with (
            mock.patch("webbrowser.open", lambda address: given.append(address)),
            mock.patch("uvicorn.Server.run", run),
            mock.patch("builtins.print") as said,
            mock.patch.object(app, "STATIC", self.folder),
        ):
            (self.folder / "index.html").write_text("page")
            self.assertEqual(app.serve(asked), 0)
        token = re.search(r"127.0.0.1:\d+/([^/]+)/", said.call_args.args[0])[1]
        self.assertTrue(given[0].startswith("file:"), given)
        self.assertEqual(given[0].rsplit("/", 1)[1], given[1])
        self.assertNotIn(token, given[0])
        self.assertEqual(list((self.folder / "state").glob("*.html")), [])

    def test_the_code_is_taken_once(self):
        page = Page()
        path = f"/{page.guard.new_code()}"
        for refused in (
            page.ask(path + "x"),
            page.ask("/open/"),
            page.ask(path, "POST"),
            page.ask(path, host="evil.example"),
            page.ask(path, origin="http://evil.example"),
        ):
            self.assertEqual(refused[0], 403)
        status, text = page.ask(path, sec_fetch_site="cross-site")
        self.assertEqual(status, 200)
        self.assertIn("url=/token/", text)
        self.assertEqual(page.ask(path, sec_fetch_site="cross-site")[0], 403)
        self.assertEqual(page.ask("/open/")[0], 403)
        self.assertEqual(page.ask("/token/", sec_fetch_site="cross-site")[0], 403)
        self.assertEqual(page.ask("/token/", sec_fetch_site="same-origin")[0], 200)
        self.assertEqual(page.paths, ["/"])

    def test_paths_without_the_token(self):
        page = Page()
        for path in ("*", "", "/", "//", "//token/", "/token2/", "token"):
            self.assertEqual(page.ask(path, "OPTIONS")[0], 403, path)
        self.assertEqual(page.ask("/token")[0], 200)
        self.assertEqual(page.paths, [""])


if __name__ == "__main__":
    unittest.main()
