"""Lamps of the photo that the user moves, resizes or turns. Runs where benches/peers/install.sh has installed
`studio`."""

import csv
import io
import unittest

from support import Case, np
from support_studio import StudioCase

from luxfer.studio import project, reshape

SQUARE = [20.0, 10.0, 40.0, 10.0, 40.0, 30.0, 20.0, 30.0]


def moved(corners, dx=0.0, dy=0.0, sx=1.0, sy=1.0):
    """Corners after a move and a change of size about their middle."""
    points = np.reshape(corners, (4, 2))
    middle = points.mean(0)
    return ((points - middle) * (sx, sy) + middle + (dx, dy)).ravel().tolist()


class Pixels(Case):
    """The change of photo and mask."""

    def setUp(self):
        super().setUp()
        ys, xs = np.mgrid[:60, :100] + 0.5
        self.disk = (xs - 30) ** 2 + (ys - 20) ** 2 < 100
        self.mask = self.disk.astype(np.float32)
        self.photo = np.where(self.disk[..., None], (5.0, 4.0, 3.0), (0.2, 0.3, 0.4)).astype(np.float32)
        self.plane = np.ones((60, 100), np.float32)

    def change(self, after, at=(30.5, 20.5)):
        lamp = {"at": list(at), "before": SQUARE, "after": after}
        return reshape.apply(self.photo, self.mask, self.plane, [lamp], 5.0)

    def test_the_same_rectangle_changes_nothing(self):
        photo, mask = self.change(SQUARE)
        self.assertTrue(np.array_equal(photo, self.photo) and np.array_equal(mask, self.mask))

    def test_a_round_lamp_becomes_an_ellipse_at_its_new_place(self):
        photo, mask = self.change(moved(SQUARE, dx=30.0, dy=15.0, sx=2.0))
        ys, xs = np.nonzero(mask)
        self.assertEqual((xs.min(), xs.max() + 1, ys.min(), ys.max() + 1), (40, 80, 25, 45))
        self.assertLess(abs(mask.sum() / (2 * self.mask.sum()) - 1), 0.02)
        self.assertTrue((photo[mask > 0] == np.float32((5, 4, 3))).all())
        self.assertTrue(np.allclose(photo[self.disk & (mask == 0)], (0.2, 0.3, 0.4)))  # the plane fills its place

    def test_a_lamp_that_is_not_there_changes_nothing(self):
        photo, mask = self.change(moved(SQUARE, dx=30.0), at=(80.0, 50.0))
        self.assertTrue(np.array_equal(photo, self.photo) and np.array_equal(mask, self.mask))

    def test_the_smallest_rectangle_follows_a_turned_lamp(self):
        turn = np.array([[0.8, 0.6], [-0.6, 0.8]])
        corners = np.array([(0, 0), (10, 0), (10, 2), (0, 2)]) @ turn + (50, 50)
        found = reshape.rectangle(corners)
        self.assertLess(np.abs(np.sort(found, axis=0) - np.sort(corners, axis=0)).max(), 1e-9)
        upright = np.array([(0, 1), (3, 0), (4, 3), (1, 4)], float)  # turned by less than it gains
        self.assertGreater(np.ptp(reshape.rectangle(upright), axis=0).min(), 0)

    def test_corners_that_cross_are_refused(self):
        named = {"name": "a.png", "sha256": "0" * 64}
        crossed = [0.0, 0.0, 10.0, 10.0, 10.0, 0.0, 0.0, 10.0]
        for wrong in (crossed, [1.0] * 8, SQUARE[:6]):
            lamp = {"at": [1.0, 1.0], "before": SQUARE, "after": wrong}
            with self.assertRaisesRegex(project.Invalid, r"reshaped\[0\]\.after"):
                project.checked({"luxfer_studio": 1, "photo": named, "reshaped": [lamp]})


class Room(StudioCase):
    """The room follows."""

    def change_of(self, lamp, **change):
        """A reshaped lamp: `change` happens on the plane, in the unwarped image."""
        light = self.session.light
        view, size = light.transfer.view, light.photo.size[:2]
        place = reshape.on_plane(np.reshape(lamp["corners"], (4, 2)), view, size).ravel().tolist()
        after = reshape.in_photo(np.reshape(moved(place, **change), (4, 2)), view, size)
        return {"at": lamp["at"], "before": lamp["corners"], "after": after.ravel().tolist()}

    def test_lamps_made_longer_are_longer_in_the_room_and_in_its_files(self):
        seen, strokes = {}, self.strokes()

        def last(header):
            seen[header["type"]] = header

        self.edit(last, strokes=strokes, until="lamps")
        first, before, shapes = seen["texture"], seen["lamps"]["list"], seen["shapes"]["list"]
        self.assertEqual(len(shapes), len(seen["masks"]["lamps"]))
        changes = [self.change_of(lamp, sx=0.6) for lamp in shapes]
        self.edit(last, strokes=strokes, reshaped=changes, until="lamps")
        self.assertEqual(seen["texture"]["distance"], first["distance"])  # the lamps have changed, and not the room
        narrow = [lamp["size"] for lamp in seen["lamps"]["list"] if lamp["kind"]]
        whole = [lamp["size"] for lamp in before if lamp["kind"]]
        self.assertTrue(narrow and whole)
        ratios = np.median(narrow, axis=0) / np.median(whole, axis=0)
        self.assertLess(np.abs(ratios - (1.0, 0.6)).max(), 0.08, ratios)
        rows = list(csv.DictReader(io.StringIO(self.out("csv").decode())))
        self.assertEqual([float(row["width_m"]) for row in rows], [float(f"{l['size'][1]:.7g}") for l in seen["lamps"]["list"]])

        # One lamp alone, then none: everything is as before.
        self.edit(last, strokes=strokes, reshaped=[self.change_of(shapes[2], dx=40.0)], until="lamps")
        self.assertNotEqual(seen["texture"]["digest"], first["digest"])
        self.edit(last, strokes=strokes, until="lamps")
        self.assertEqual(seen["texture"]["digest"], first["digest"])

    def test_a_lamp_that_is_moved_out_of_the_photo_is_an_error_with_advice(self):
        seen = {}
        self.edit(lambda header: seen.update({header["type"]: header}), strokes=self.strokes(), until="lamps")
        away = [self.change_of(lamp, dx=1e5) for lamp in seen["shapes"]["list"]]
        away = [{**lamp, "after": moved(SQUARE, dx=-500.0)} for lamp in away]
        with self.assertRaisesRegex(AssertionError, "no reshaped lamp lies in the photo: undo one"):
            self.edit(strokes=self.strokes(), reshaped=away)


if __name__ == "__main__":
    unittest.main()
