"""The server of the studio without a browser: who is let in, which files are read, and that projects give the same
result again. Runs where benches/peers/install.sh has installed `studio`."""

import asyncio
import json
import os
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request
from pathlib import Path

from support import PACKAGE, Case, context, demo, in_ci, luxfer, np

import websockets
import websockets.exceptions
from luxfer.studio import jobs, pictures, project, security

STATIC = PACKAGE / "luxfer" / "studio" / "static"
#: Pictures of the tests are small.
SIZE = [160, 104]
#: Strokes on the generated photo, as shares of its size.
STROKES = [
    ("plane", [(0.15, 0.25), (0.4, 0.14)]),
    ("not-plane", [(0.2, 0.95), (0.7, 0.93)]),
    ("light", [(0.5, 0.36), (0.62, 0.38)]),
]


class Server:
    """A studio in a process of its own."""

    def __init__(self, state, *arguments):
        command = [sys.executable, "-m", "luxfer.studio", "--no-browser", "--port", "0", "--state", str(state)]
        self.process = subprocess.Popen(
            [*command, *map(str, arguments)], cwd=PACKAGE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        line = self.process.stdout.readline()
        if "http" not in line:
            raise RuntimeError(self.process.communicate()[1])
        self.address = line.split()[-1]
        self.origin, self.token = self.address[:-1].rsplit("/", 1)

    def close(self):
        self.process.kill()
        self.process.communicate()

    def get(self, path="", data=None, **headers):
        """Status, headers and content of an answer."""
        request = urllib.request.Request(
            f"{self.origin}/{path}", data, {k.replace("_", "-"): v for k, v in headers.items()}
        )
        try:
            with urllib.request.urlopen(request) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as answer:
            return answer.code, answer.headers, answer.read()

    def json(self, path, data=None):
        """An answer under the token, which must be a good one."""
        status, _, content = self.get(f"{self.token}/{path}", data)
        assert status == 200, (status, content)
        return json.loads(content)

    def talk(self, session, edits, origin=None, until="idle"):
        """Sends one edit after the other, each when a message of type `until` has come; returns what came in by the
        last message of each type, for each edit."""
        return asyncio.run(self._talk(session, edits, self.origin if origin is None else origin, until))

    async def _talk(self, session, edits, origin, until):
        address = f"{self.address.replace('http', 'ws', 1)}ws?session={session}"
        out = []
        async with websockets.connect(address, origin=origin, max_size=None) as socket:
            for version, edit in enumerate(edits):
                await socket.send(
                    json.dumps({"type": "edit", "version": version, "size": SIZE, "compare": "off", **edit})
                )
                seen = {}
                while not {until, "failed"} & seen.keys():
                    message = await asyncio.wait_for(socket.recv(), 120)
                    length = struct.unpack_from("<I", message)[0]
                    header = json.loads(message[4 : 4 + length])
                    seen[header["type"]] = header
                out.append(seen)
        return out


def built(test):
    """Skips a test of the server where the page has not been built, but not in CI."""
    return unittest.skipUnless((STATIC / "index.html").exists() or in_ci(), "the page has not been built: run make studio")(test)


@built
class Door(Case):
    """Who is let in, and to which files."""

    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.place.cleanup)
        root = Path(cls.place.name)
        (root / "open").mkdir()
        (root / "secret").mkdir()
        demo()[0].save(root / "open" / "photo.png")
        demo()[0].save(root / "secret" / "other.png")
        (root / "open" / "link.png").symlink_to(root / "secret" / "other.png")
        cls.root = root
        cls.server = Server(root / "state", root / "open" / "photo.png", "--folder", root / "open")
        cls.addClassCleanup(cls.server.close)

    def test_the_page_is_there_with_its_policy(self):
        status, headers, page = self.server.get(f"{self.server.token}/")
        self.assertEqual(status, 200)
        self.assertIn(b"luxfer studio", page)
        self.assertIn("default-src 'none'", headers["content-security-policy"])
        self.assertEqual(headers["referrer-policy"], "no-referrer")
        self.assertEqual(headers["x-content-type-options"], "nosniff")

    def test_a_wrong_token_is_refused(self):
        for path in (
            "",
            "start",
            "wrong/start",
            self.server.token[:-1] + "/start",
            self.server.token + "x/start",
            "/start",
        ):
            self.assertEqual(self.server.get(path)[0], 403, path)

    def test_another_host_is_refused(self):
        port = self.server.origin.rsplit(":", 1)[1]
        for host in ("evil.example", f"evil.example:{port}", "127.0.0.1", f"127.0.0.1:{int(port) + 1}", ""):
            self.assertEqual(self.server.get(f"{self.server.token}/start", Host=host)[0], 403, host)
        self.assertEqual(self.server.get(f"{self.server.token}/start", Host=f"localhost:{port}")[0], 200)

    def test_another_origin_is_refused(self):
        for origin in (
            "http://evil.example",
            "null",
            "http://127.0.0.1:1",
            self.server.origin.replace("127.0.0.1", "localhost"),
        ):
            self.assertEqual(self.server.get(f"{self.server.token}/start", Origin=origin)[0], 403, origin)
        self.assertEqual(self.server.get(f"{self.server.token}/start", Sec_Fetch_Site="cross-site")[0], 403)
        self.assertEqual(self.server.get(f"{self.server.token}/start", Origin=self.server.origin)[0], 200)

    def test_a_socket_of_another_origin_is_refused(self):
        for origin in ("http://evil.example", "null"):
            with self.assertRaises(websockets.exceptions.InvalidStatus, msg=origin):
                self.server.talk("session01", [], origin)
        address = self.server.address.replace("http", "ws", 1)

        async def without_origin():
            async with websockets.connect(address + "ws?session=session01"):
                pass

        with self.assertRaises(websockets.exceptions.InvalidStatus):
            asyncio.run(without_origin())

    def test_only_named_files_are_read(self):
        good = self.server.json(f"files?open={self.root}/open/photo.png")
        self.assertEqual(good["name"], "photo.png")
        for path in (
            "/etc/passwd",
            f"{self.root}/secret/other.png",
            f"{self.root}/open/../secret/other.png",
            f"{self.root}/open/link.png",
        ):
            status, _, content = self.server.get(f"{self.server.token}/files?open={path}")
            self.assertEqual(status, 403, (path, content))
        for path in ("../../../../etc/passwd", "%2e%2e/%2e%2e/app.py", "..%2fapp.py", "assets/../../app.py"):
            self.assertIn(self.server.get(f"{self.server.token}/{path}")[0], (403, 404), path)
        self.assertEqual([f["name"] for f in self.server.json("files")["files"] if f["name"] == "other.png"], [])

    def test_bad_files_are_refused_with_a_reason(self):
        for name, content, reason in (
            ("photo.jpg", b"not a photo", "photo.jpg cannot be read"),
            ("photo.png", (self.root / "open" / "photo.png").read_bytes()[:200], "photo.png cannot be read"),
            ("room.glb", b"glTF nothing", "room.glb cannot be read"),
            ("notes.txt", b"hello", "is no photo"),
            ("IMG_1.HEIC", b"x", "save it as JPEG"),
            ("room.fbx", b"x", "export it as .glb"),
            ("room.usdz", b"x", "room.usdz cannot be read: USD needs one more package"),
            ("photo.jpg", b"", "is empty"),
        ):
            status, _, answer = self.server.get(f"{self.server.token}/files?name={name}", content)
            self.assertEqual(status, 400, name)
            self.assertIn(reason, json.loads(answer)["message"])
        status, _, answer = self.server.get(f"{self.server.token}/projects", b'{"luxfer_studio": 1, "photo": 3}')
        self.assertEqual(status, 400)
        self.assertIn("photo is an object", json.loads(answer)["message"])

    def test_names_of_uploads_stay_in_their_folder(self):
        data = (self.root / "open" / "photo.png").read_bytes()
        known = self.server.json("files?name=..%2F..%2Fhome%2Fevil.png", data)
        self.assertEqual(known["name"], "evil.png")
        self.assertFalse((self.root / "home").exists())

    def test_a_wrong_edit_is_answered(self):
        seen = self.server.talk("session02", [{"project": {"luxfer_studio": 1, "photo": None}}])
        self.assertIn("photo", seen[0]["failed"]["message"])


@built
class Work(Case):
    """From strokes to results, and back from a project file."""

    def setUp(self):
        super().setUp()
        self.photo = self.folder / "office.png"
        demo()[0].save(self.photo)

    def serve(self, *arguments):
        server = Server(self.folder / "state", *arguments)
        self.addCleanup(server.close)
        return server

    def painted(self, server):
        width, height = demo()[0].size[:2]
        strokes = [
            {"kind": kind, "radius": 2.5, "points": [c for x, y in places for c in (x * width, y * height)]}
            for kind, places in STROKES
        ]
        lamps = {"mix": {"1": 0.5}, "added": [[1, 3, 2]]}
        return {**server.json("start")["project"], "strokes": strokes, "noise": 1.0, **lamps}

    def test_a_project_gives_the_same_again(self):
        server = self.serve(self.photo)
        started = server.json("start")["project"]
        proposed, first = server.talk(
            "session01", [{"project": {**started, "noise": 1.0}}, {"project": self.painted(server)}]
        )
        self.assertIn("PROPOSED", {w["code"] for w in proposed["warnings"]["list"]})
        self.assertNotIn("PROPOSED", {w["code"] for w in first["warnings"]["list"]})
        self.assertNotEqual(proposed["masks"]["digest"], first["masks"]["digest"])
        self.assertTrue(first["picture"]["done"])
        self.assertGreater(first["lux"]["mean"], 1)
        kept = {
            kind: server.get(f"{server.token}/out/{kind}?session=session01") for kind in ("csv", "png", "glb", "exr")
        }
        for kind, (status, _, content) in kept.items():
            self.assertEqual(status, 200, kind)
            self.assertGreater(len(content), 100, kind)
        file = self.folder / "saved.luxfer.json"
        file.write_bytes(server.get(f"{server.token}/out/project?session=session01")[2])
        server.close()

        again = self.serve(file)
        seen = again.talk("session01", [{"project": again.json("start")["project"]}])[0]
        self.assertEqual(seen["masks"]["digest"], first["masks"]["digest"])
        self.assertEqual(seen["texture"]["digest"], first["texture"]["digest"])
        for kind in ("csv", "png"):
            self.assertEqual(again.get(f"{again.token}/out/{kind}?session=session01")[2], kept[kind][2], kind)

    def test_lamps_are_taken_out_of_photo_and_room(self):
        server = self.serve(self.photo)
        painted = self.painted(server)
        first = server.talk("session01", [{"project": painted}], until="lamps")[0]
        box = first["masks"]["lamps"][0]["box"]
        removed = {**painted, "removed": [[(box[0] + box[2]) / 2, (box[1] + box[3]) / 2]]}
        surface, lamp = first["texture"]["surface"], first["lamps"]["list"][0]
        at = np.subtract(lamp["position"], surface["origin"])
        u, v = float(at @ np.array(surface["u_axis"])), float(at @ np.array(surface["v_axis"]))
        zone = {**painted, "zones": [[u - 0.35, v - 0.35, u + 0.35, v + 0.35]]}
        without, free, back = server.talk(
            "session01", [{"project": removed}, {"project": zone}, {"project": painted}], until="lamps"
        )
        self.assertEqual(len(without["masks"]["lamps"]), len(first["masks"]["lamps"]) - 1)
        self.assertLess(len(free["lamps"]["list"]), len(first["lamps"]["list"]))
        self.assertEqual(back["texture"]["digest"], first["texture"]["digest"])

    def test_two_users_and_their_files(self):
        kept = self.folder / "kept.json"
        server = self.serve(self.photo, "--project", kept)
        painted = self.painted(server)
        # The view follows the masks of the photo's own size.
        one = server.talk("userone00", [{"project": painted}], until="view")[0]
        two = server.talk("usertwo00", [{"project": {**painted, "strokes": painted["strokes"][:1]}}], until="view")[0]
        self.assertNotEqual(one["masks"]["digest"], two["masks"]["digest"])
        self.assertEqual(len(project.load(kept)["strokes"]), 3)
        self.assertEqual(one["saved"]["file"], "kept.json")
        self.assertEqual(len(project.load(self.folder / "state" / two["saved"]["file"])["strokes"]), 1)

    def test_a_killed_server_has_the_strokes_in_its_file(self):
        kept = self.folder / "kept.json"
        server = self.serve(self.photo, "--project", kept)
        painted = self.painted(server)

        async def paint():
            address = f"{server.address.replace('http', 'ws', 1)}ws?session=session01"
            async with websockets.connect(address, origin=server.origin, max_size=None) as socket:
                await socket.send(json.dumps({"type": "edit", "project": painted, "size": SIZE}))
                while b'"saved"' not in await socket.recv():
                    pass

        asyncio.run(paint())
        server.close()
        self.assertEqual(project.load(kept)["strokes"], painted["strokes"])

    def test_a_missing_photo_is_asked_for(self):
        server = self.serve(self.photo)
        lost = {**self.painted(server), "photo": {"name": "gone.png", "sha256": "0" * 64}}
        failed = server.talk("session01", [{"project": lost}])[0]["failed"]
        self.assertTrue(failed["missing"])
        self.assertIn("gone.png", failed["message"])


class Parts(Case):
    """The parts of the server, without one."""

    def test_projects_are_checked(self):
        good = {"luxfer_studio": 1, "photo": {"name": "a.png", "sha256": "0" * 64}}
        whole = project.checked(good)
        self.assertEqual(project.checked(json.loads(project.dumps(whole))), whole)
        for wrong in (
            {"luxfer_studio": 2},
            {"colour": 1},
            {"white": -1},
            {"white": True},
            {"strokes": [{"kind": "plane", "radius": 1, "points": [1]}]},
            {"strokes": [{"kind": "wall", "radius": 1, "points": [1, 2]}]},
            {"removed": [[1, float("nan")]]},
            {"pattern": {"scale": "distance"}},
            {"mix": {"A": 1}},
            {"mix": {"1": -0.1}},
            {"added": [[1, 2]]},
            {"lux_plane": {"surface": None, "height": -1}},
        ):
            with self.assertRaises(project.Invalid, msg=str(wrong)):
                project.checked({**good, **wrong})

    def test_regions_are_those_of_a_flood_fill(self):
        mask = np.random.default_rng(3).random((40, 57)) > 0.45
        labels, count = pictures.regions(mask)
        self.assertEqual((labels > 0).tolist(), mask.tolist())
        slow = np.zeros(mask.shape, int)
        found = 0
        for start in zip(*np.nonzero(mask)):
            if slow[start]:
                continue
            found += 1
            stack = [start]
            while stack:
                y, x = stack.pop()
                if 0 <= y < 40 and 0 <= x < 57 and mask[y, x] and not slow[y, x]:
                    slow[y, x] = found
                    stack += [(y + 1, x), (y - 1, x), (y, x + 1), (y, x - 1)]
        self.assertEqual(count, found)
        self.assertEqual(len(set(zip(labels[mask].tolist(), slow[mask].tolist()))), found)

    def test_taking_out_a_region_leaves_the_others(self):
        mask = np.zeros((20, 30), np.float32)
        mask[2:6, 3:9] = mask[10:15, 20:28] = 1
        out = pictures.without(mask, [[10.0, 4.0]], 3)
        self.assertEqual(out[2:6, 3:9].sum(), 0)
        self.assertEqual(out[10:15, 20:28].sum(), 40)
        self.assertEqual(pictures.without(mask, [[15.0, 8.0]], 2).sum(), mask.sum())

    def test_newer_work_replaces_older_work(self):
        seen, failures = [], []

        def work(item):
            if item < 3:
                thread.finish(luxfer.Task(context(), lambda: luxfer.DemoPhoto(context()).run(width=1200, height=800)))
            seen.append(item)
            if item == 4:
                raise ValueError("four")

        thread = jobs.Latest("test", work, failures.append)
        self.addCleanup(thread.close)
        thread.put(1)
        time.sleep(0.1)
        start = time.perf_counter()
        thread.put(2)
        thread.put(3)
        thread.wait_idle(lambda: None)
        self.assertLess(time.perf_counter() - start, 2)
        thread.put(4)
        thread.wait_idle(lambda: None)
        self.assertEqual(seen, [3, 4])
        self.assertEqual([str(f) for f in failures], ["four"])

    def test_allowed_files(self):
        (self.folder / "in").mkdir()
        for name in ("in/a.png", "b.png"):
            (self.folder / name).write_bytes(b"x")
        allowed = security.Allowed([self.folder / "in"])
        self.assertTrue(allowed.check(self.folder / "in" / "a.png").exists())
        for path in ("b.png", "in/../b.png", "inside.png"):
            with self.assertRaises(PermissionError):
                allowed.check(self.folder / path)
        allowed.add(self.folder / "b.png")
        allowed.check(self.folder / "b.png")


if __name__ == "__main__":
    unittest.main()
