"""The plane's grid, dragged by its corners: the camera that they determine, and the way through the library. Runs where
benches/peers/install.sh has installed `studio`."""

import unittest

from support import Case, context, np
from support_studio import StudioCase, inner_grid

from luxfer.studio import grid
from luxfer.studio.project import Invalid

SIZE = (600, 400)


def turned(tilt, pan):
    """Room axes in the space of a camera that is tilted and panned, one in each row."""
    ct, st, cp, sp = np.cos(tilt), np.sin(tilt), np.cos(pan), np.sin(pan)
    tilted = np.array([[1, 0, 0], [0, ct, -st], [0, st, ct]])
    return (tilted @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])).T


def corners_of(axes, focal, first=0, second=2):
    """A rectangle of 4 by 5 on a plane that the camera's axis meets at a distance of 5, in the photo."""
    middle = 5 * np.array([0, 0, 1])
    sides = [(-2, -2.5), (2, -2.5), (2, 2.5), (-2, 2.5)]
    points = np.array([middle + u * axes[first] + v * axes[second] for u, v in sides])
    return (focal * points[:, :2] / points[:, 2:] + np.array(SIZE) / 2).ravel().tolist()


class Cameras(Case):
    """Cameras from corners."""

    def test_the_corners_determine_the_camera(self):
        axes, focal = turned(0.7, 0.6), 450.0
        found, length = grid.camera_of(corners_of(axes, focal), SIZE, 999.0)
        self.assertAlmostEqual(length / focal, 1, places=9)
        for one, wanted in zip(found, (axes[0], axes[2], axes[1])):
            self.assertAlmostEqual(abs(float(one @ wanted)), 1, places=9)

    def test_straight_on_the_found_focal_length_stays(self):
        axes, focal = turned(0.0, 0.01), 450.0
        found, length = grid.camera_of(corners_of(axes, focal, 0, 1), SIZE, 470.0)
        self.assertEqual(length, 470.0)
        self.assertLess(np.abs(found @ found.T - np.eye(3)).max(), 1e-12)

    def test_corners_that_are_no_rectangle_say_what_to_do(self):
        for corners in ((0, 0, 10, 0, 0, 10, 10, 10), (0, 0, 5, 0, 10, 0, 0, 10), (1, 1) * 4):
            with self.assertRaisesRegex(Invalid, "drag one of them back"):
                grid.camera_of([float(c) for c in corners], SIZE, 500.0)

    def test_the_library_finds_the_camera_that_was_drawn(self):
        for size, limit in (((240, 160), 0.5), (SIZE, 0.1)):
            for tilt, pan in ((0.3, 0.6), (-0.2, 0.1), (0.5, -0.9), (0.0, 0.0)):
                axes, focal = turned(tilt, pan), 0.75 * size[0]
                rectify, plane = grid.rectify_of(context(), axes.tolist(), focal, size)
                found = np.array(rectify.report.axes)
                for one, wanted in zip(found[plane], axes):
                    angle = np.degrees(np.arccos(min(1, abs(one @ wanted))))
                    self.assertLess(angle, limit, (size, tilt, pan))
                self.assertEqual(rectify.report.focal, focal)


class Dragged(StudioCase):
    """A session in which the grid is dragged."""

    def test_the_plane_follows_the_grid_and_comes_back(self):
        strokes, seen = self.strokes(), {}

        def last(header):
            seen[header["type"]] = header

        self.edit(last, strokes=strokes, until="lamps")
        found, masks, texture = seen["view"], seen["masks"]["digest"], seen["texture"]["digest"]
        self.assertFalse(found["dragged"])
        # A grid that lies where the library has put it changes nothing but by the drawing's error.
        corners = inner_grid(found)
        self.edit(last, strokes=strokes, grid=corners, until="lamps")
        self.assertTrue(seen["view"]["dragged"])
        self.assertEqual(seen["masks"]["digest"], masks)
        self.assertLess(self.angle(found, seen["view"]), 0.02)
        # A corner elsewhere turns the plane: its sides run through the corners.
        moved = [corners[0] + 6, *corners[1:]]
        self.edit(last, strokes=strokes, grid=moved, until="lamps")
        self.assertGreater(self.angle(found, seen["view"]), 0.03)
        self.assertEqual(seen["masks"]["digest"], masks)
        self.assertNotEqual(seen["texture"]["digest"], texture)
        # Other strokes with the grid, and everything without it, are as they would be without the detour.
        self.edit(last, strokes=strokes[:2], grid=moved, until="lamps")
        fewer = seen["masks"]["digest"]
        self.edit(last, strokes=strokes, until="lamps")
        self.assertEqual([seen[m]["digest"] for m in ("masks", "texture")], [masks, texture])
        self.edit(last, strokes=strokes[:2], until="lamps")
        self.assertEqual(seen["masks"]["digest"], fewer)

    def angle(self, one, other):
        """The largest angle between the directions to the vanishing points of two messages."""
        out = []
        for view in (one, other):
            points = np.array(view["vanishing"])
            points[:, :2] -= points[:, 2:] * np.array(self.session.light.photo.size[:2]) / 2
            points[:, 2] *= view["focal"]
            out.append(points / np.linalg.norm(points, axis=1)[:, None])
        return float(np.arccos(np.minimum(1, np.abs(out[0] @ out[1].T).max(axis=1))).max())


if __name__ == "__main__":
    unittest.main()
