"""Tests that Blender's compositor finds the layers of luxfer's OpenEXR files by name and reads the right values."""

import tempfile
import unittest
from pathlib import Path

from room import bpy, np

import luxfer

WIDTH, HEIGHT = 40, 30


class Layers(unittest.TestCase):
    def test_layers_by_name(self):
        context = luxfer.Context()
        scene = luxfer.Scene.demo(context, "still-life")
        render = luxfer.Render(context, scene, expressions={"matt": "L.*DE"}, aovs="depth|normal|albedo|object|alpha")
        render.run(width=WIDTH, height=HEIGHT, samples=2)
        layers = {name: image.numpy() for name, image in render.layers.items() if name != "Alpha"}
        layers["Combined"] = render.image().numpy()

        with tempfile.TemporaryDirectory() as folder:
            render.write_exr(Path(folder) / "layers.exr")
            bpy.ops.wm.read_factory_settings(use_empty=True)
            read = self.compositor(str(Path(folder) / "layers.exr"))
            self.assertEqual({socket.name for socket in read.outputs}, {*layers, "Alpha"})
            for name, expected in layers.items():
                found = self.composed(read.outputs[name], str(Path(folder) / f"{name}.exr"))
                channels = expected.shape[2]
                np.testing.assert_array_equal(found[:, :, :channels], expected, name)

    def compositor(self, path):
        """Builds a compositor that reads a file and outputs one of its layers."""
        scene = bpy.context.scene
        tree = bpy.data.node_groups.new("Layers", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group = tree
        scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        scene.collection.objects.link(scene.camera)
        scene.render.engine = "CYCLES"
        scene.cycles.samples = 1
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
        scene.view_settings.view_transform = "Raw"
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        read = tree.nodes.new("CompositorNodeImage")
        read.image = bpy.data.images.load(path)
        tree.nodes.new("NodeGroupOutput")
        return read

    def composed(self, socket, path):
        """The output of the compositor for a socket, top row first."""
        tree = socket.node.id_data
        tree.links.clear()
        tree.links.new(socket, tree.nodes["Group Output"].inputs[0])
        bpy.context.scene.render.filepath = path
        bpy.ops.render.render(write_still=True)
        pixels = np.empty(WIDTH * HEIGHT * 4, np.float32)
        bpy.data.images.load(path).pixels.foreach_get(pixels)
        return pixels.reshape(HEIGHT, WIDTH, 4)[::-1]


if __name__ == "__main__":
    unittest.main()
