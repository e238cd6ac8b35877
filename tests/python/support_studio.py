"""What the tests of the studio share: a session without a server, on the generated photo and room."""

import threading
from unittest import mock

from support import Case, context, demo, luxfer

from luxfer.studio import files, light, program, program_c, project, security
from luxfer.studio.session import Session

#: Saves time: these tests do not need many paths for the strength of the lamps.
RELIGHT = {"target_error": 0.1, "paths": 1 << 13}


class StudioCase(Case):
    """A session of the studio without a server."""

    def setUp(self):
        super().setUp()
        self.files = files.Files(self.folder / "state", security.Allowed())
        demo()[0].save(self.folder / "office.png")
        photo = self.files.upload("office.png", (self.folder / "office.png").read_bytes())
        named = {"name": photo.name, "sha256": photo.sha256}
        self.project = project.checked({"luxfer_studio": 1, "photo": named, "noise": 1.0, "exposure": 1e-3})
        self.session = Session("session01", context(), self.files, self.folder / "kept.json")
        self.addCleanup(self.session.close)
        # Save time: these tests do not need a good first picture either.
        settings = [(module, "RELIGHT", RELIGHT) for module in (light, program, program_c)]
        for module, name, value in [*settings, (light, "FIRST_MS", 50)]:
            patch = mock.patch.object(module, name, value)
            patch.start()
            self.addCleanup(patch.stop)

    def edit(self, seen=lambda header: None, draft=False, until="idle", **changes):
        """Sends a state of the project, and waits for a message: the last one comes when the work is done."""
        ended, failures = threading.Event(), []

        def listen(header, payload):
            seen(header)
            if header["type"] == "failed":
                failures.append(header["message"])
            if header["type"] in (until, "failed"):
                ended.set()

        self.session.listeners[:] = [listen]
        whole = {**self.project, **changes}
        self.session.edit({"project": whole, "size": [160, 104], "draft": draft})
        if not draft:
            self.assertTrue(ended.wait(120))
            self.assertEqual(failures, [])

    def out(self, kind):
        """The content of a file; None if it is not ready."""
        try:
            return self.session.out(kind, self.folder).read_bytes()
        except luxfer.errors.NotReady:
            return None
