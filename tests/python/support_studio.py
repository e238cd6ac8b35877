"""What the tests of the studio share: a session without a server, on the generated photo and room."""

import threading
from unittest import mock

from support import Case, context, demo, luxfer, np

from luxfer.studio import files, light, program, program_c, project, security
from luxfer.studio.session import Session

#: Saves time: these tests do not need many paths for the strength of the lamps.
RELIGHT = {"target_error": 0.1, "paths": 1 << 13}


def inner_grid(view, share=0.25):
    """The corners, in the photo, of the middle part of the plane that a message "view" describes."""
    width, height = view["unwarped"]
    low, high = 0.5 - share / 2, 0.5 + share / 2
    corners = np.array([(low, low), (high, low), (high, high), (low, high)]) * (width, height)
    mapped = np.column_stack((corners, np.ones(4))) @ np.reshape(view["to_photo"], (3, 3)).T
    return (mapped[:, :2] / mapped[:, 2:]).ravel().tolist()


class StudioCase(Case):
    """A session of the studio without a server."""

    FIRST_MS = 50

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
        for module, name, value in [*settings, (light, "FIRST_MS", self.FIRST_MS or light.FIRST_MS)]:
            patch = mock.patch.object(module, name, value)
            patch.start()
            self.addCleanup(patch.stop)

    def edit(self, seen=lambda header: None, draft=False, until="idle", compare="off", **changes):
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
        self.session.edit({"project": whole, "size": [160, 104], "draft": draft, "compare": compare})
        if not draft:
            self.assertTrue(ended.wait(120))
            self.assertEqual(failures, [])

    def strokes(self):
        """Strokes on the generated photo."""
        size = luxfer.Image.load(context(), self.folder / "office.png").size[:2]
        return [
            {"kind": kind, "radius": 3.0, "points": [share * side for share, side in zip(at, size * 2)]}
            for kind, at in (
                ("plane", (0.15, 0.25, 0.4, 0.14)),
                ("not-plane", (0.2, 0.95, 0.7, 0.93)),
                ("light", (0.5, 0.39, 0.62, 0.41)),
            )
        ]

    def out(self, kind):
        """The content of a file; None if it is not ready."""
        try:
            return self.session.out(kind, self.folder).read_bytes()
        except luxfer.errors.NotReady:
            return None
