"""Several surfaces of a room receive the lamps of one photo. Runs where benches/peers/install.sh has installed
`studio`."""

import csv
import io
import json
import unittest
import zipfile

from support import Case, context, luxfer, np
from support_studio import StudioCase

from luxfer.studio import layout, mix, project

PATTERN = project.DEFAULTS["pattern"]
WALL = {"surface": "Back wall", "pattern": {**PATTERN, "rotation": 0.2}, "zones": [], "mix": {}, "added": []}


class Projects(Case):
    """The entry `others` of a project."""

    def checked(self, **changes):
        named = {"name": "a.png", "sha256": "0" * 64}
        return project.checked({"luxfer_studio": 1, "photo": named, **changes})

    def test_a_surface_is_named_once(self):
        self.assertEqual(len(self.checked(surface="Ceiling", others=[WALL])["others"]), 1)
        for surface, others in ((None, [WALL]), (WALL["surface"], [WALL]), ("Ceiling", [WALL, WALL])):
            with self.assertRaisesRegex(project.Invalid, "others"):
                self.checked(surface=surface, others=others)

    def test_the_order_does_not_depend_on_the_surface_on_which_the_user_works(self):
        one = self.checked(surface="Ceiling", others=[WALL])
        ceiling = {name: one[name] for name in WALL}
        two = self.checked(**WALL, others=[ceiling])
        self.assertEqual(layout.layouts(one, ""), layout.layouts(two, ""))
        found = [layout.active(p, layout.layouts(p, ""), "") for p in (one, two)]
        self.assertEqual(found, [1, 0])


class Surfaces(StudioCase):
    """A ceiling and a wall of the generated room."""

    def setUp(self):
        super().setUp()
        self.seen = {}

    def last(self, header):
        self.seen[header["type"]] = header

    def test_both_have_lamps_and_the_files_have_all(self):
        self.edit(self.last, until="lux")
        alone, lux = self.seen["lamps"], self.seen["lux"]["mean"]
        room = luxfer.Scene.demo(context(), "target-room")
        wall = room.find_surface(WALL["surface"])
        self.edit(self.last, until="lux", surface="Ceiling", others=[WALL])
        self.assertEqual(len(self.seen["lamps"]["list"]), len(alone["list"]))
        [other] = self.seen["lamps"]["others"]
        self.assertEqual(other["surface"], WALL["surface"])
        self.assertGreater(other["lamps"], 2)
        self.assertNotEqual(self.seen["lux"]["mean"], lux)
        rows = list(csv.DictReader(io.StringIO(self.out("csv").decode())))
        on_wall = [row for row in rows if row["surface"] == WALL["surface"]]
        self.assertEqual((len(on_wall), len(rows) - len(on_wall)), (other["lamps"], len(alone["list"])))
        places = np.array([[float(row[f"{k}_m"]) for k in "xyz"] for row in on_wall])
        self.assertLess(np.abs((places - wall.origin) @ wall.normal).max(), 0.01)  # they lie on the wall
        self.assertEqual({row["surface"] for row in json.loads(self.out("json"))["fixtures"]}, {"Ceiling", WALL["surface"]})
        names = zipfile.ZipFile(io.BytesIO(self.out("photometry"))).namelist()
        self.assertTrue(any(name.startswith("Ceiling kind A") for name in names), names)

        # The surface on which the user works changes what the page shows, and no result.
        before, digest = self.out("glb"), self.seen["texture"]["digest"]
        ceiling = {name: self.session.wanted.project[name] for name in WALL}
        self.edit(self.last, **WALL, others=[ceiling])
        self.assertEqual(self.seen["texture"]["surface"]["name"], WALL["surface"])
        self.assertNotEqual(self.seen["texture"]["digest"], digest)
        self.assertEqual(self.seen["lamps"]["others"][0]["surface"], "Ceiling")
        self.assertEqual(self.out("glb"), before)

        # A dimmer of the wall changes no lamp of the ceiling.
        dim = {**WALL, "mix": {str(kind): 0.0 for kind in range(20)}}
        self.edit(self.last, until="lux", **dim, others=[ceiling])
        rows = list(csv.DictReader(io.StringIO(self.out("csv").decode())))
        flux = {name: sum(float(row["flux_lm"]) for row in rows if row["surface"] == name) for name in ("Ceiling", "Back wall")}
        self.assertEqual(flux["Back wall"], 0)
        self.assertGreater(flux["Ceiling"], 100)

    def test_two_names_of_one_surface_are_an_error_with_advice(self):
        double = {**WALL, "surface": self.twin()}
        with self.assertRaisesRegex(AssertionError, "are one: choose another one"):
            self.edit(surface="Ceiling", others=[double])

    def twin(self):
        """The material that only the ceiling has."""
        room = luxfer.Scene.demo(context(), "target-room")
        return next(c.name for c in room.candidates if c.kind.name == "MATERIAL" and abs(c.area - room.candidates[0].area) < 0.1)


class Meshes(Case):
    """The mesh of each surface in the lit room."""

    def test_each_surface_finds_its_own_mesh(self):
        room = luxfer.Scene.demo(context(), "target-room")
        surfaces = [room.find_surface(name) for name in ("Back wall", "Ceiling")]
        lamps = np.zeros((8, 12, 3), np.float32)
        lamps[2::4, 3::6] = 1
        meshes = [room.place_emission(name, lamps, (100, 100, 100))[0] for name in ("Back wall", "Ceiling")]
        self.assertEqual([mix.mesh_of(room, surface, 2) for surface in surfaces], meshes)
        self.assertEqual([mix.mesh_of(room, surface, 2) for surface in surfaces[::-1]], meshes[::-1])


if __name__ == "__main__":
    unittest.main()
