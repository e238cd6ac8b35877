"""Rooms in USD in the studio: opened, lit and exported. Runs where benches/peers/install.sh has installed `studio` and
`usd`."""

import unittest

from support import context, in_ci, luxfer
from support_studio import StudioCase

from luxfer.studio import rooms

try:
    from pxr import Usd, UsdGeom

    import luxfer.usd
except ImportError:
    Usd = None


@unittest.skipIf(Usd is None and not in_ci(), "usd-core is not installed")
class Rooms(StudioCase):
    """A room in USD, from the page and from a folder, and the lit room in USD."""

    def room(self, ending):
        """The generated room in a USD file."""
        path = self.folder / f"room{ending}"
        luxfer.usd.save(luxfer.Scene.demo(context(), "target-room"), path)
        return path

    def named(self, name, data):
        known = self.files.upload(name, data)
        return {"name": known.name, "sha256": known.sha256}

    def test_a_room_in_usd_is_lit_like_the_same_room_and_exported(self):
        seen = {}

        def last(header):
            seen[header["type"]] = header

        self.edit(last, until="lux")
        plain = {name: seen[name] for name in ("lamps", "lux", "texture")}
        name, data = rooms.given(context(), "My room.usdz", self.room(".usdz").read_bytes())
        self.assertEqual(name, "My room.glb")
        beside = [(ending, rooms.converted(context(), self.room(ending))) for ending in (".usdc", ".usda")]
        for ending, data in ((".usdz", data), *beside):
            self.edit(last, room=self.named(name, data))
            self.assertIn("Ceiling", [c["name"] for c in seen["room"]["candidates"]])
            self.assertEqual(seen["texture"]["surface"]["name"], "Ceiling")
            self.assertEqual(len(seen["lamps"]["list"]), len(plain["lamps"]["list"]), ending)
            # The strength of the lamps has the noise of two solutions.
            self.assertLess(abs(seen["lux"]["mean"] / plain["lux"]["mean"] - 1), 0.2, ending)

        written = self.session.out("usd", self.folder)
        self.assertEqual(written.suffix, ".usdz")
        stage = Usd.Stage.Open(str(written))
        self.assertEqual(UsdGeom.GetStageMetersPerUnit(stage), 1.0)
        again, lit = luxfer.usd.load(context(), written), self.session.light.lit
        lamps = [luxfer.Scene.from_bytes(context(), scene.to_bytes()) for scene in (again, lit)]
        flux = [self.light_of(scene) for scene in lamps]
        self.assertGreater(flux[1], 0)
        self.assertLess(abs(flux[0] / flux[1] - 1), 0.01)

    def light_of(self, scene):
        """The mean illuminance that a room has from its own lamps."""
        lux = luxfer.Illuminance(context(), scene)
        grid = {"origin": (1.0, 0.8, 1.0), "across": (3.0, 0.0, 0.0), "down": (0.0, 0.0, 2.0)}
        return lux.run_grid(grid, columns=6, rows=4, samples=256).report.mean

    def test_a_file_without_its_pictures_is_an_error_with_advice(self):
        data = self.room(".usdc").read_bytes()
        with self.assertRaisesRegex(ValueError, r"refers to \d\.png, which is not there: save the room as one \.usdz"):
            rooms.given(context(), "room.usdc", data)

    def test_what_is_no_usd_says_so(self):
        with self.assertRaisesRegex(ValueError, "no USD file"):
            rooms.given(context(), "room.usda", b"no room")


if __name__ == "__main__":
    unittest.main()
