"""Tests files of public collections: each must be read as by an independent reader, or be refused with the right
status.

`LUXFER_TEST_CORPORA` names a folder that has a subfolder for each collection (docs/notes/corpora.md lists their
origins). Without it the tests are skipped. Each test prints a line of counts for the table in the guide.

The independent readers: Pillow for PNG and BMP, OpenEXR's own module for EXR, the Khronos validator (`gltf-validator`
from npm, in a folder that `LUXFER_GLTF_VALIDATOR` names) for the validity of glTF, and trimesh for its geometry.
"""

from __future__ import annotations

import base64
import json
import os
import subprocess
import unittest
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from support import Case, context, luxfer, np

CORPORA = os.environ.get("LUXFER_TEST_CORPORA", "")
VALIDATOR = os.environ.get("LUXFER_GLTF_VALIDATOR", "")

#: JavaScript that reads file names from its input and prints the codes of each file's errors, as JSON.
VALIDATE = """
const validator = require(process.argv[1] + '/node_modules/gltf-validator');
const fs = require('fs'), path = require('path');
(async () => {
  for (const file of fs.readFileSync(0, 'utf8').split('\\n').filter(Boolean)) {
    const read = uri => new Promise((done, failed) => fs.readFile(
      path.resolve(path.dirname(file), decodeURIComponent(uri)), (e, data) => e ? failed(e.toString()) : done(new Uint8Array(data))));
    let codes = ['UNREADABLE'];
    try {
      const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)),
        { externalResourceFunction: read, maxIssues: 0 });
      codes = report.issues.messages.filter(m => m.severity === 0).map(m => m.code);
    } catch (e) { codes = ['' + e]; }
    console.log(JSON.stringify({ file, codes }));
  }
})();
"""


def files(collection: str, *endings: str) -> list[Path]:
    """The files of a collection with these endings; an empty list if the collection is missing."""
    found = (Path(CORPORA) / collection).rglob("*") if CORPORA else iter(())
    return sorted(path for path in found if path.suffix.lower() in endings and path.is_file())


def report(collection: str, counts: Counter[str]) -> None:
    print(f"\n{collection}: " + ", ".join(f"{n} {what}" for what, n in sorted(counts.items())))


def load(path: Path, colour_space: str = "linear") -> np.ndarray:
    return luxfer.Image.load(context(), path, colour_space).numpy()


@unittest.skipUnless(CORPORA, "LUXFER_TEST_CORPORA names no folder")
class Pictures(Case):
    def compare(self, path: Path, ours: np.ndarray, theirs: np.ndarray, tolerance: float) -> None:
        self.assertEqual(ours.shape[:2], theirs.shape[:2], path)
        if ours.shape[2] == 1 and theirs.shape[2] > 1:  # luxfer loads greys into one channel
            ours = np.repeat(ours, 3, axis=2)
        channels = min(ours.shape[2], theirs.shape[2])
        for a in (ours, theirs):  # an alpha that only one side has is 1
            self.assertTrue(a.shape[2] == channels or np.all(a[:, :, channels:] == 1), path)
        difference = np.abs(ours[:, :, :channels] - theirs[:, :, :channels])
        self.assertLessEqual(float(difference.max(initial=0)), tolerance, path)

    def pictures(self, collection: str, *endings: str) -> None:
        from PIL import Image, UnidentifiedImageError

        counts: Counter[str] = Counter()
        for path in files(collection, *endings):
            with self.subTest(path.name):
                try:
                    with Image.open(path) as picture:
                        picture.load()
                        wide = picture.mode.startswith("I;16") or picture.mode == "I"
                        theirs = np.asarray(picture if wide else picture.convert("RGBA"), np.float32)
                        theirs = theirs[:, :, None] / 65535 if wide else theirs / 255
                        # Pillow ignores transparency in greys of 4 or 16 bits; the suite also has the pixels as text.
                        text = path.parents[1] / "json" / f"{path.stem}.json"
                        if picture.mode in ("1", "L", "I;16") and "transparency" in picture.info and text.exists():
                            stored = np.array(json.loads(text.read_text()), np.float32)
                            theirs = stored.reshape(*theirs.shape[:2], 4) / (65535 if wide else 255)
                except (OSError, SyntaxError, ValueError, UnidentifiedImageError):
                    theirs = None
                try:
                    ours = load(path)
                except (luxfer.errors.FormatError, luxfer.errors.Unsupported) as error:
                    refused = type(error).__name__
                    counts[f"refused ({refused})"] += 1
                    # If the other reader loads the file, luxfer may refuse it as unsupported, but as damaged only if
                    # the file's name marks it as damaged.
                    if theirs is not None:
                        counts["of these read by Pillow"] += 1
                        self.assertTrue(path.name.startswith("x") or refused == "Unsupported", f"{path}: {error}")
                    continue
                if theirs is None:
                    counts["read, but not by Pillow"] += 1
                    continue
                # Pillow keeps only 8 of 16 bits of colours.
                self.compare(path, ours, theirs, 1 / 255)
                counts["equal"] += 1
        report(collection, counts)
        self.assertGreater(counts["equal"], 0, "the collection is not there")

    def test_png_suite(self) -> None:
        self.pictures("pngsuite", ".png")

    def test_bmp_suite(self) -> None:
        self.pictures("pngsuite", ".bmp")

    def test_openexr_images(self) -> None:
        import OpenEXR

        counts: Counter[str] = Counter()
        for path in files("openexr-images", ".exr"):
            with self.subTest(str(path.relative_to(CORPORA))):
                try:
                    with OpenEXR.File(str(path), separate_channels=True) as file:
                        header, part = file.header(), {n: c.pixels for n, c in file.channels().items()}
                        theirs = display(header, part)
                except Exception:  # OpenEXR raises exceptions of any type for damaged files
                    theirs = None
                try:
                    ours = load(path)
                except (luxfer.errors.FormatError, luxfer.errors.Unsupported) as error:
                    refused = type(error).__name__
                    counts[f"refused ({refused})"] += 1
                    if theirs is not None:
                        counts["of these read by OpenEXR"] += 1
                        self.assertEqual(refused, "Unsupported", f"{path}: {error}")
                    continue
                if theirs is None:
                    counts["read, but not as R, G, B by OpenEXR"] += 1
                    continue
                np.testing.assert_allclose(ours, theirs, rtol=1e-6, err_msg=str(path))
                counts["equal"] += 1
        report("openexr-images", counts)
        self.assertGreater(counts["equal"], 0, "the collection is not there")


def display(header: dict, channels: dict[str, np.ndarray]) -> np.ndarray | None:
    """The pixels of the display window: R, G, B (and A), or a single channel; None for other channels."""
    names = [n for n in "RGBA" if n in channels] if {"R", "G", "B"} <= channels.keys() else list(channels)
    if names[:3] != ["R", "G", "B"] and len(names) != 1:
        return None
    (low, high), (left, right) = header["displayWindow"], header["dataWindow"]
    size, start = high - low + 1, left - low
    out = np.zeros((size[1], size[0], len(names)), np.float32)
    stored = np.stack([np.asarray(channels[n], np.float32) for n in names], axis=2)
    x0, y0 = max(start[0], 0), max(start[1], 0)
    x1, y1 = min(start[0] + stored.shape[1], size[0]), min(start[1] + stored.shape[0], size[1])
    if x1 > x0 and y1 > y0:
        out[y0:y1, x0:x1] = stored[y0 - start[1] : y1 - start[1], x0 - start[0] : x1 - start[0]]
    return out


def validated(paths: list[Path]) -> Iterator[tuple[Path, list[str]]]:
    """Each file and the codes of its errors, from the Khronos validator."""
    script = ["node", "-e", VALIDATE, VALIDATOR]
    listed = "\n".join(map(str, paths))
    lines = subprocess.run(script, input=listed, capture_output=True, text=True, check=True).stdout.splitlines()
    for line in lines:
        found = json.loads(line)
        yield Path(found["file"]), found["codes"]


@unittest.skipUnless(CORPORA and VALIDATOR, "LUXFER_TEST_CORPORA or LUXFER_GLTF_VALIDATOR names no folder")
class Gltf(Case):
    def validity(self, collection: str) -> None:
        counts: Counter[str] = Counter()
        for path, codes in validated(files(collection, ".gltf", ".glb")):
            with self.subTest(str(path.relative_to(CORPORA))):
                word = "invalid" if codes else "valid"
                try:
                    with luxfer.Scene.load(context(), path) as scene:
                        scene.requirements_text()
                    counts[f"{word}, read"] += 1
                except luxfer.Error as error:
                    refused = type(error).__name__
                    counts[f"{word}, refused ({refused})"] += 1
                    if not codes:
                        self.assertEqual(refused, "Unsupported", f"{path}: {error}")
                    else:
                        self.assertIn(refused, ("FormatError", "Unsupported", "FileError"), f"{path}: {codes}: {error}")
        report(collection, counts)
        self.assertGreater(counts["valid, read"], 0, "the collection is not there")

    def geometry(self, collection: str) -> None:
        """Compares the triangles of whole scenes with trimesh: number, total area and bounding box."""
        import trimesh

        counts: Counter[str] = Counter()
        for path in files(collection, ".gltf", ".glb"):
            with self.subTest(str(path.relative_to(CORPORA))):
                try:
                    with luxfer.Scene.load(context(), path) as scene:
                        ours = triangles(scene)
                        posed = posing(path)
                except luxfer.Error:
                    continue
                try:
                    theirs = trimesh.load_scene(str(path), process=False).to_mesh().triangles
                except Exception:  # trimesh cannot read every valid file
                    counts["not read by trimesh"] += 1
                    continue
                if posed or b'"sparse"' in path.read_bytes():
                    counts["posed or sparse, which trimesh does not do"] += 1
                    continue
                if len(ours) != len(theirs):
                    counts["of another number of triangles: strips, lines or several scenes"] += 1
                    continue
                if len(ours):
                    size = float(np.ptp(theirs, axis=(0, 1)).max())
                    for extreme in (np.min, np.max):
                        a, b = extreme(ours, axis=(0, 1)), extreme(theirs, axis=(0, 1))
                        np.testing.assert_allclose(a, b, atol=1e-4 * size, err_msg=str(path))
                    np.testing.assert_allclose(area(ours), area(theirs), rtol=1e-3, atol=1e-12, err_msg=str(path))
                counts["equal"] += 1
        report(f"{collection}, geometry", counts)

    def test_samples(self) -> None:
        for collection in ("gltf-samples-2017", "gltf-rs", "gltf-blender-io", "gltf-validator"):
            with self.subTest(collection):
                self.validity(collection)

    def test_geometry_of_samples(self) -> None:
        for collection in ("gltf-samples-2017", "gltf-rs", "gltf-blender-io"):
            with self.subTest(collection):
                self.geometry(collection)


class Draco(Case):
    """Reads streams of Google's own Draco encoder."""

    def test_streams_of_the_c_library(self) -> None:
        try:
            import DracoPy
        except ImportError:
            self.skipTest("DracoPy is not installed")
        rng = np.random.default_rng(1)
        grid = np.stack(np.meshgrid(np.arange(40), np.arange(30), indexing="ij"), axis=2).reshape(-1, 2)
        points = np.column_stack([grid / 10, rng.random(len(grid))]).astype(np.float32)[:, [0, 2, 1]]
        corner = np.arange(40 * 30).reshape(40, 30)[:-1, :-1].ravel()
        faces = np.concatenate([[[c, c + 1, c + 30], [c + 1, c + 31, c + 30]] for c in corner]).astype(np.uint32)
        uvs = grid / 40
        for level in range(11):
            with self.subTest(level):
                stream = DracoPy.encode(
                    points, faces, quantization_bits=12, compression_level=level, tex_coord=uvs, preserve_order=level == 0
                )
                theirs = DracoPy.decode(stream)
                with luxfer.Scene.from_bytes(context(), gltf_of(stream, theirs)) as scene:
                    ours = scene.mesh_arrays(0)
                np.testing.assert_allclose(
                    ordered(ours["positions"][ours["indices"]]), ordered(theirs.points[theirs.faces]), atol=1e-6
                )
                np.testing.assert_allclose(
                    ordered(ours["uvs"][ours["indices"]]), ordered(theirs.tex_coord[theirs.faces]), atol=1e-6
                )


def ordered(corners: np.ndarray) -> np.ndarray:
    """Sorts triangles, so that sets of triangles in different order can be compared."""
    rows = corners.reshape(len(corners), -1)
    return rows[np.lexsort(rows.T[::-1])]


def gltf_of(stream: bytes, decoded) -> bytes:
    """A glTF file that contains a Draco stream."""
    ids = {a["attribute_type"]: a["unique_id"] for a in decoded.attributes}
    vertices = {"count": len(decoded.points), "componentType": 5126}
    attributes, primitive = {"POSITION": ids[0], "TEXCOORD_0": ids[3]}, {"POSITION": 0, "TEXCOORD_0": 2}
    uri = "data:application/octet-stream;base64," + base64.b64encode(stream).decode()
    settings = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": attributes}}
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "extensionsRequired": ["KHR_draco_mesh_compression"],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": primitive, "indices": 1, "extensions": settings}]}],
            "accessors": [
                {**vertices, "type": "VEC3"},
                {"count": decoded.faces.size, "componentType": 5125, "type": "SCALAR"},
                {**vertices, "type": "VEC2"},
            ],
            "bufferViews": [{"buffer": 0, "byteLength": len(stream)}],
            "buffers": [{"uri": uri, "byteLength": len(stream)}],
        }
    ).encode()


def triangles(scene: luxfer.Scene) -> np.ndarray:
    """The corners of all triangles of a scene."""
    parts = [scene.mesh_arrays(i) for i in range(scene.counts.meshes)]
    corners = [part["positions"][part["indices"]] for part in parts]
    return np.concatenate(corners) if corners else np.zeros((0, 3, 3), np.float32)


def area(corners: np.ndarray) -> float:
    corners = corners.astype(np.float64)
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(sides, axis=1).sum() / 2)


def posing(path: Path) -> bool:
    """Whether a file has skins or morph weights, according to its text."""
    text = path.read_bytes()
    return b'"skins"' in text or b'"weights"' in text


if __name__ == "__main__":
    unittest.main()
