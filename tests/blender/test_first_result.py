"""The DCC artist's way to a first result, of docs/guide/first-results.md: from a photo and a scene as files to the
scene in the light of the photo, by the operators that the buttons of the panel call. Runs in a Blender without a
window (bpy)."""

import re
import tempfile
import time
import unittest
from pathlib import Path

from room import bpy, cycles, np

import luxfer
import luxfer_lighting
from luxfer_lighting import convert, lighting

SIZE = {"width": 450, "height": 300}
GUIDE = Path(__file__).resolve().parents[2] / "docs" / "guide" / "first-results.md"
#: The clicks of the way in Blender's window, after the scene and the folder of the photo have been opened.
CLICKS = {"photo": 1, "New Strokes": 1, "brushes": 3, "strokes": 3, "menu of surfaces": 1, "Ceiling": 1, "Transfer Light": 1}


class FirstResult(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        with luxfer.Context() as context:
            demo = luxfer.DemoPhoto(context).run(**SIZE, samples=8)
            demo.image("picture").save(self.folder / "photo.png")
            self.painted = demo.image("strokes").numpy(np.uint8, "srgb") / np.float32(255)
            luxfer.Scene.demo(context, "target-room").export(self.folder / "room.glb")
        luxfer_lighting.register()
        self.addCleanup(luxfer_lighting.unregister)

    def paint(self, image):
        """Draws the strokes onto the copy of the photo, as the brushes would."""
        pixels = convert.pixels(image)[..., :3]
        is_painted = self.painted.max(-1, keepdims=True) > 0
        self.assertEqual(pixels.shape, self.painted.shape)
        return convert.store(lighting.STROKES, np.where(is_painted, self.painted, pixels), linear=False)

    def test_from_a_photo_and_a_scene_to_the_scene_in_its_light(self):
        bpy.ops.import_scene.gltf(filepath=str(self.folder / "room.glb"))
        scene = bpy.context.scene
        scene.camera = next(thing for thing in scene.objects if thing.type == "CAMERA")
        scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 64, 100
        dark = cycles(scene, 4)
        settings = scene.luxfer
        began = time.monotonic()
        settings.photo = bpy.data.images.load(str(self.folder / "photo.png"))
        bpy.ops.luxfer.new_strokes()
        settings.strokes = self.paint(settings.strokes)
        settings.target = bpy.data.objects["Ceiling"]
        self.assertEqual(bpy.ops.luxfer.transfer(), {"FINISHED"})
        seconds = time.monotonic() - began
        lamps = bpy.data.texts[lighting.LAMPS].as_string().strip().splitlines()
        self.assertGreater(len(lamps), 4)
        lit = cycles(scene, 16)
        self.assertGreater(lit.mean(), 10 * max(dark.mean(), 0.1))
        clicks = sum(CLICKS.values())
        print(f"DCC artist: {clicks} clicks, {seconds:.0f} s: {len(lamps) - 1} lamps, {lit.mean():.0f} cd/m2 on average")
        self.assertEqual(re.search(r"^\| DCC artist \|.*\| (\d+) clicks", GUIDE.read_text(), re.M)[1], str(clicks))


if __name__ == "__main__":
    unittest.main()
