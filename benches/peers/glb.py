"""Reads the GLB files that luxfer writes: meshes, materials, images and the first camera, as plain arrays."""

import io
import json
import struct

import numpy as np

TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    def __init__(self, path):
        data = open(path, "rb").read()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + length])
        self.binary = data[20 + length + 8 :]

    def view(self, index):
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self.binary[start : start + view["byteLength"]]

    def accessor(self, index):
        accessor = self.json["accessors"][index]
        width = WIDTHS[accessor["type"]]
        start = accessor.get("byteOffset", 0)
        values = np.frombuffer(self.view(accessor["bufferView"])[start:], TYPES[accessor["componentType"]])
        return values[: accessor["count"] * width].reshape(accessor["count"], width)

    def image(self, texture):
        """Returns the bytes of the encoded image of a texture."""
        source = self.json["textures"][texture]["source"]
        return io.BytesIO(self.view(self.json["images"][source]["bufferView"]))

    def primitives(self):
        """Yields material index, positions, normals or None, two sets of texture coordinates or None, and triangles of
        each primitive. Of the transforms of nodes, only translations are applied."""
        for node in self.json["nodes"]:
            if "mesh" not in node:
                continue
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                attributes = primitive["attributes"]
                get = lambda name: self.accessor(attributes[name]) if name in attributes else None
                positions = get("POSITION") + np.float32(node.get("translation", (0, 0, 0)))
                triangles = self.accessor(primitive["indices"]).reshape(-1, 3).astype(np.uint32)
                yield primitive["material"], positions, get("NORMAL"), [get("TEXCOORD_0"), get("TEXCOORD_1")], triangles

    def camera(self):
        """Returns position, forward, up and vertical field of view in radians of the first camera."""
        node = next(n for n in self.json["nodes"] if "camera" in n)
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        up = np.array([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)])
        back = np.array([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)])
        fov = self.json["cameras"][node["camera"]]["perspective"]["yfov"]
        return np.array(node.get("translation", (0, 0, 0)), float), -back, up, fov
