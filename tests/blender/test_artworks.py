"""Tests that objects with an artwork of their own get its paint, and that no other object does."""

import os
import unittest

from room import SIZE, bpy, build, np

import luxfer
import luxfer_lighting
from luxfer_lighting import artworks, convert, painting, parts, work

GREEN, MAGENTA = (0.1, 0.8, 0.1), (0.9, 0.05, 0.8)


class Artworks(unittest.TestCase):
    def setUp(self):
        self.scene = build()
        luxfer_lighting.register()
        self.addCleanup(luxfer_lighting.unregister)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(3, 2.5, 1.2))
        self.ball = bpy.context.object
        self.ball.data.materials.append(bpy.data.materials["White"])
        light = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        light.data.energy, light.data.shadow_soft_size = 5000, 0
        light.location = (SIZE[0] / 2, SIZE[1] / 2, SIZE[2] - 0.3)
        self.scene.collection.objects.link(light)
        settings = self.scene.luxfer
        settings.exemplar_width, settings.exemplar_height, settings.guide_samples = 96, 72, 8
        bpy.ops.luxfer.sample_artwork(style="paint")

    def two_colours(self, name, width, height):
        """An artwork whose ball has one plain colour and whose table has another one."""
        guides, job = painting.ball(width, height, 4)
        job.wait()
        codes = guides.image("materials").numpy()
        is_ball = (codes == codes[height // 2, width // 2]).all(-1, keepdims=True)
        drawn = np.where(is_ball, GREEN, MAGENTA).astype(np.float32)
        return convert.store(name, drawn, linear=False)

    def painted(self, look=""):
        bpy.ops.luxfer.stylise()
        picture = convert.pixels(bpy.data.images[painting.PICTURE])[..., :3]
        if folder := os.environ.get("LUXFER_LOOK"):
            luxfer.Image(work.context(), picture, "srgb").save(os.path.join(folder, f"artworks_{look}.png"))
        return picture

    def cover(self):
        """The share of each pixel that the ball covers, by the library."""
        group = artworks.Group(None, None, {self.ball.name})
        room, (width, height) = convert.scene(work.context(), self.scene), convert.resolution(self.scene)
        covers = artworks.Covers(room, convert.camera(self.scene), width, height, [group])
        covers.job.wait()
        return covers.arrays()[0]

    def share(self, picture, colour):
        """For each pixel, whether it is nearly of a colour."""
        return np.abs(picture - colour).max(-1) < 0.2

    def test_an_object_gets_the_paint_of_its_own_artwork_and_no_other_object_does(self):
        cover = self.cover()

        def around(pick, fill):
            """The largest or least cover of the neighbours: Cycles filters over more than one pixel."""
            padded = np.pad(cover, 2, constant_values=fill)
            return pick([padded[y : y + 72, x : x + 96] for y in range(5) for x in range(5)], 0)

        places = {"LUXFER": (cover > 0.999, cover == 0), "CYCLES": (around(np.min, 1) > 0.999, around(np.max, 0) == 0)}
        self.assertFalse(self.share(self.painted("before"), GREEN).any())
        self.ball.luxfer_artwork = self.two_colours("own", 64, 48)  # of another size
        for renderer, (inside, outside) in places.items():
            self.assertGreater(inside.sum(), 100)
            self.scene.luxfer.guides_by = renderer
            with self.subTest(renderer):
                picture = self.painted(renderer.lower())
                self.assertTrue(self.share(picture, GREEN)[inside].all())
                self.assertFalse(self.share(picture, GREEN)[outside].any())
                self.assertFalse(self.share(picture, MAGENTA).any())

    def test_like_the_table_and_in_a_preview(self):
        self.ball.luxfer_artwork = self.two_colours("own", 96, 72)
        self.ball.luxfer_paint_as = "TABLE"
        self.scene.luxfer.preset = "PREVIEW"
        picture, cover = self.painted("preview"), self.cover()
        self.assertEqual(picture.shape, (36, 48, 3))
        inside = cover.reshape(36, 2, 48, 2).min((1, 3)) > 0.999
        self.assertTrue(self.share(picture, MAGENTA)[inside].all())
        self.assertFalse(self.share(picture, GREEN).any())

    def test_an_object_has_the_artwork_of_its_parent(self):
        group = bpy.data.objects.new("Group", None)
        self.scene.collection.objects.link(group)
        self.ball.parent = group
        self.assertIsNone(artworks.of(self.ball))
        self.assertEqual(artworks.groups(self.scene, None), [])
        bpy.context.view_layer.objects.active = group
        bpy.ops.luxfer.sample_artwork(style="pen", for_object=True)
        drawn = group.luxfer_artwork
        self.assertEqual(drawn.name, f"{painting.ARTWORK} of Group")
        self.assertNotEqual(self.scene.luxfer.artwork, drawn)
        self.assertEqual(artworks.of(self.ball), drawn)
        (found,) = artworks.groups(self.scene, parts.of(self.scene))
        self.assertIn(self.ball.name, found.names)
        self.assertEqual(found.part, parts.BALL)
        self.ball.luxfer_artwork = self.scene.luxfer.artwork  # the scene's: so it needs no group
        self.assertNotIn(self.ball.name, set().union(*(g.names for g in artworks.groups(self.scene, None))))

    def test_an_object_out_of_view_changes_nothing(self):
        before = self.painted()
        bpy.ops.mesh.primitive_cube_add(size=0.2, location=(3, -1, 1.2))  # behind the camera
        bpy.context.object.luxfer_artwork = self.two_colours("own", 96, 72)
        self.scene.camera.data.clip_start = 0.01
        picture = self.painted()
        self.assertFalse(self.share(picture, GREEN).any())
        self.assertLess(np.abs(picture - before).mean(), 0.1)


class Pixels(unittest.TestCase):
    def test_nearest_pixels(self):
        inside = np.random.default_rng(3).random((17, 23)) > 0.93
        at = np.argwhere(inside)
        rows, columns, steps = artworks.nearest(inside)
        self.assertTrue(inside[rows, columns].all())
        for y, x in np.ndindex(inside.shape):
            least = np.abs(at - (y, x)).sum(1).min()
            self.assertEqual(abs(rows[y, x] - y) + abs(columns[y, x] - x), least)
            self.assertEqual(steps[y, x], least)

    def test_guides_go_on_and_edges_end(self):
        guides = {"full": np.arange(20, dtype=np.float32).reshape(4, 5, 1), "edges": np.ones((4, 5, 1), np.float32)}
        inside = np.zeros((4, 5), bool)
        inside[:, 0] = True
        out = artworks.extended(guides, inside)
        np.testing.assert_array_equal(out["full"][..., 0], np.repeat(guides["full"][:, :1, 0], 5, 1))
        np.testing.assert_array_equal(out["edges"][..., 0], np.repeat([[1, 1, 1, 0, 0]], 4, 0))
        self.assertIs(artworks.extended(guides, ~np.zeros((4, 5), bool)), guides)

    def test_brightness_is_matched_as_in_the_library(self):
        with luxfer.Context() as context:
            size = {"width": 48, "height": 36, "samples": 4}
            ball = luxfer.Guides(context, luxfer.Scene.demo(context, "sphere-on-table")).run(**size)
            still = luxfer.Guides(context, luxfer.Scene.demo(context, "still-life")).run(**size)
            target = artworks.passes.exposed(artworks.passes.light_of(ball), artworks.passes.light_of(still))
            pictures = []
            for by_hand in (False, True):
                ours = artworks.matched(*target, 1.0) if by_hand else target[0]
                stylize = luxfer.Stylize(context, ball.demo_artwork("paint"))
                artworks.passes.add(stylize, ours, target[1])
                stylize.run(preset="fast", match_appearance=0 if by_hand else 1)
                pictures.append(stylize.image().numpy())
            self.assertLess(np.abs(pictures[0] - pictures[1]).mean(), 0.01)


if __name__ == "__main__":
    unittest.main()
