"""What the studio keeps, deletes and opens, and what it refuses. Runs where benches/peers/install.sh has installed
`studio`."""

import json
import os
import time
import unittest

from support import Case

from luxfer.studio import files, security

MONTH = files.KEEP_SECONDS


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


if __name__ == "__main__":
    unittest.main()
