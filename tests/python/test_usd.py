"""Tests USD files with usd-core: luxfer reads its files with their full meaning, and it reads the files of luxfer."""

import json
import math
import struct
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from support import in_ci

import luxfer

try:
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade

    import luxfer.usd
except ImportError:
    Usd = None


def lights(scene):
    """The punctual lights of a scene, as its GLB file lists them."""
    data = scene.to_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length]).get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])


@unittest.skipIf(Usd is None and not in_ci(), "usd-core is not installed")
class Files(unittest.TestCase):
    def setUp(self):
        self.context = luxfer.Context()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def stage(self, up="Y", metres=1.0):
        stage = Usd.Stage.CreateInMemory()
        UsdGeom.SetStageUpAxis(stage, up)
        UsdGeom.SetStageMetersPerUnit(stage, metres)
        return stage

    def square(self, stage, path, **values):
        """A square with sides of length 2 in the xy plane, facing +z."""
        mesh = UsdGeom.Mesh.Define(stage, path)
        mesh.CreatePointsAttr([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
        mesh.CreateFaceVertexCountsAttr([4])
        mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
        for name, value in values.items():
            getattr(mesh, f"Create{name}Attr")(value)
        return mesh

    def test_there_and_back_in_each_format(self):
        scene = luxfer.Scene.demo(self.context, "still-life")
        gradient = np.random.default_rng(1).random((4, 8, 3)).astype(np.float32)
        material = scene.add_material(name="lamp", base_color=(0, 0, 0))
        corners = [[-1, 3, -1], [1, 3, -1], [1, 3, 1], [-1, 3, 1]]
        uvs = [[0, 0], [1, 0], [1, 1], [0, 1]]
        scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], uvs=uvs, name="Lamp 1", material=material)
        scene.set_material_texture(material, "emission", scene.add_texture(gradient, "clamp"))
        scene.set_material(material, emission=(900, 800, 700))
        for suffix in (".usda", ".usdc", ".usdz"):
            with self.subTest(suffix):
                path = self.folder / f"scene{suffix}"
                luxfer.usd.save(scene, path)
                stage = Usd.Stage.Open(str(path))
                self.assertTrue(stage.GetDefaultPrim())
                back = luxfer.usd.load(self.context, path)
                self.assertEqual(back.counts.meshes, scene.counts.meshes)
                self.assertEqual(back.counts.triangles, scene.counts.triangles)
                for i in range(scene.counts.meshes):
                    mine, other = scene.mesh_arrays(i), back.mesh_arrays(i)
                    self.assertEqual(mine.keys(), other.keys())
                    for name, values in mine.items():
                        corners = values[mine["indices"]] if name != "indices" else 0
                        theirs = other[name][other["indices"]] if name != "indices" else 0
                        np.testing.assert_allclose(theirs, corners, atol=1e-5, err_msg=name)
                    first, second = (s.material(s.mesh(i).material) for s in (scene, back))
                    for name in ("base_color", "metallic", "roughness", "ior", "emission", "double_sided"):
                        np.testing.assert_allclose(second[name], first[name], rtol=1e-6, err_msg=name)
                lamp = back.mesh(back.counts.meshes - 1).material
                use = back.material_texture(lamp, "emission")
                np.testing.assert_array_equal(back.texture(use.texture).numpy(), gradient)
                self.assertEqual(use.wrap_u, luxfer.types.Wrap.CLAMP)
                self.assertEqual(back.mesh_name(back.counts.meshes - 1), "Lamp_1")
                first, second = scene.camera(0), back.camera(0)
                self.assertAlmostEqual(first["fov_y"], second["fov_y"], places=5)
                np.testing.assert_allclose(second["position"], first["position"], atol=1e-5)
                directions = [np.subtract(c["target"], c["position"]) for c in (first, second)]
                np.testing.assert_allclose(*(s / np.linalg.norm(s) for s in directions), atol=1e-5)

    def test_axes_units_and_transforms(self):
        stage = self.stage("Z", 0.01)
        mesh = self.square(stage, "/World/Floor")
        UsdGeom.Xformable(stage.DefinePrim("/World", "Xform")).AddTranslateOp().Set(Gf.Vec3d(100, 200, 300))
        mesh.AddScaleOp().Set(Gf.Vec3f(100, 100, 100))
        camera = UsdGeom.Camera.Define(stage, "/World/Camera")  # looks along -z, which is down
        camera.CreateVerticalApertureAttr(20)
        camera.CreateFocalLengthAttr(10)
        scene = luxfer.usd.from_stage(self.context, stage)
        arrays = scene.mesh_arrays(0)
        expected = [[0, 3, -1], [2, 3, -1], [2, 3, -3], [0, 3, -3]]
        np.testing.assert_allclose(arrays["positions"], expected, atol=1e-6)
        hit = scene.intersect([[1, 5, -2]], [[0, -1, 0]])[0]
        self.assertAlmostEqual(float(hit["t"]), 2, places=5)
        a, b, c = arrays["positions"][arrays["indices"][0]]
        self.assertGreater(np.cross(b - a, c - a)[1], 0, "it faces up")
        settings = scene.camera(0)
        self.assertAlmostEqual(settings["fov_y"], math.pi / 2, places=5)
        np.testing.assert_allclose(settings["position"], (1, 3, -2), atol=1e-6)
        np.testing.assert_allclose(np.subtract(settings["target"], settings["position"]), (0, -1, 0), atol=1e-6)

    def test_what_turns_faces_round(self):
        for scale, orientation, up in ((1, "rightHanded", 1), (-1, "rightHanded", 1), (1, "leftHanded", -1), (-1, "leftHanded", -1)):
            stage = self.stage()
            mesh = self.square(stage, "/Floor", Orientation=orientation)
            mesh.AddScaleOp().Set(Gf.Vec3f(scale, 1, 1))  # a mirrored face keeps its side
            arrays = luxfer.usd.from_stage(self.context, stage).mesh_arrays(0)
            a, b, c = arrays["positions"][arrays["indices"][0]]
            self.assertEqual(np.sign(np.cross(b - a, c - a)[2]), up, (scale, orientation))

    def test_values_of_corners_and_parts_of_meshes(self):
        stage = self.stage()
        mesh = UsdGeom.Mesh.Define(stage, "/Two")
        mesh.CreatePointsAttr([(x, y, 0) for y in (0, 1) for x in (0, 1, 2)])
        mesh.CreateFaceVertexCountsAttr([4, 4])
        mesh.CreateFaceVertexIndicesAttr([0, 1, 4, 3, 1, 2, 5, 4])
        st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
        st.Set([(0, 0), (1, 0), (1, 1), (0, 1)] * 2)
        for name, faces in (("Left", [0]), ("Right", [1])):
            subset = UsdShade.MaterialBindingAPI(mesh).CreateMaterialBindSubset(name, faces)
            shader = UsdShade.Shader.Define(stage, f"/{name}/Shader")
            shader.CreateIdAttr("UsdPreviewSurface")
            shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.25 if name == "Left" else 0.75)
            look = UsdShade.Material.Define(stage, f"/{name}")
            look.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
            UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(look)
        hidden = self.square(stage, "/Hidden")
        hidden.MakeInvisible()
        self.square(stage, "/Proxy", Purpose="proxy")
        UsdGeom.PointInstancer.Define(stage, "/Many")
        self.square(stage, "/Many/Prototype")
        scene = luxfer.usd.from_stage(self.context, stage)
        self.assertEqual(scene.counts.meshes, 2)
        for i, roughness in enumerate((0.25, 0.75)):
            arrays = scene.mesh_arrays(i)
            self.assertEqual(len(arrays["positions"]), 4)
            self.assertAlmostEqual(scene.material(scene.mesh(i).material)["roughness"], roughness)
            left = arrays["positions"][:, 0] == i
            np.testing.assert_array_equal(arrays["uvs"][left, 0], 0)
            np.testing.assert_array_equal(arrays["uvs"][:, 1], 1 - arrays["positions"][:, 1])

    def test_lights_have_the_strength_that_usd_says(self):
        stage = self.stage()
        rect = UsdLux.RectLight.Define(stage, "/Rect")
        rect.CreateWidthAttr(2), rect.CreateHeightAttr(0.5), rect.CreateIntensityAttr(10), rect.CreateExposureAttr(1)
        rect.CreateColorAttr((1, 0.5, 0.25))
        disk = UsdLux.DiskLight.Define(stage, "/Disk")
        disk.CreateIntensityAttr(7), disk.CreateNormalizeAttr(True), disk.CreateRadiusAttr(2)
        sphere = UsdLux.SphereLight.Define(stage, "/Sphere")
        sphere.CreateRadiusAttr(0.5), sphere.CreateIntensityAttr(8)
        spot = UsdLux.SphereLight.Define(stage, "/Spot")
        spot.CreateIntensityAttr(8), spot.CreateNormalizeAttr(True)
        shaping = UsdLux.ShapingAPI.Apply(spot.GetPrim())
        shaping.CreateShapingConeAngleAttr(30), shaping.CreateShapingConeSoftnessAttr(0.5)
        sun = UsdLux.DistantLight.Define(stage, "/Sun")
        sun.CreateIntensityAttr(1000), sun.CreateAngleAttr(60)
        scene = luxfer.usd.from_stage(self.context, stage)
        np.testing.assert_allclose(scene.material(scene.mesh(0).material)["emission"], (20, 10, 5))
        np.testing.assert_allclose(scene.material(scene.mesh(1).material)["emission"], [7 / (4 * math.pi)] * 3, rtol=2e-3)
        # The light shines towards -z, so it is visible from there and not from behind.
        self.assertLess(scene.intersect([[0, 0, -5]], [[0, 0, 1]])["t"][0], 6)
        arrays = scene.mesh_arrays(0)
        a, b, c = arrays["positions"][arrays["indices"][0]]
        self.assertLess(np.cross(b - a, c - a)[2], 0)
        point, cone, directional = lights(scene)
        self.assertAlmostEqual(point["intensity"], 8 * math.pi * 0.25, places=4)
        self.assertEqual(cone["type"], "spot")
        self.assertAlmostEqual(cone["intensity"], 2, places=5)
        self.assertAlmostEqual(cone["spot"]["outerConeAngle"], math.radians(30), places=5)
        self.assertAlmostEqual(cone["spot"]["innerConeAngle"], math.radians(15), places=5)
        self.assertAlmostEqual(directional["intensity"], 1000 * math.pi * 0.25, places=2)

    def test_a_dome_is_the_environment(self):
        stage = self.stage()
        dome = UsdLux.DomeLight.Define(stage, "/Dome")
        dome.CreateIntensityAttr(3), dome.CreateColorAttr((1, 0.5, 0))
        self.square(stage, "/Behind")
        render = luxfer.Render(self.context, luxfer.usd.from_stage(self.context, stage))
        render.set_camera(position=(0, 0, 5), target=(0, 0, 9))
        picture = render.run(width=4, height=4, samples=4).image().numpy()
        np.testing.assert_allclose(picture, np.broadcast_to((3, 1.5, 0), (4, 4, 3)), rtol=1e-6)

    def test_the_studio_saves_its_lit_room(self):
        from luxfer.studio import results

        room = luxfer.Scene.demo(self.context, "target-room")
        room.place_emission("Ceiling", np.ones((4, 4, 3), np.float32), (300, 200, 100))
        path = self.folder / "room.usdz"
        results.write("usd", path, None, SimpleNamespace(lit=room))
        again = luxfer.usd.load(self.context, path)
        self.assertEqual(again.counts.triangles, room.counts.triangles)
        brightest = max(again.material(i)["emission"][0] for i in range(again.counts.materials))
        self.assertAlmostEqual(brightest, 300, places=2)

    def test_the_studio_reads_a_room_in_usd(self):
        from luxfer.studio import files, rooms, security

        room = luxfer.Scene.demo(self.context, "target-room")
        luxfer.usd.save(room, self.folder / "room.usdz")
        name, data = rooms.given(self.context, "my room.usdz", (self.folder / "room.usdz").read_bytes())
        self.assertEqual(name, "my room.glb")
        read = luxfer.Scene.from_bytes(self.context, data)
        self.assertEqual(read.counts.triangles, room.counts.triangles)
        self.assertEqual(read.candidates[0].name, "Ceiling")
        # A project names rooms by hash, so a room that is given again is the same one.
        self.assertEqual(rooms.given(self.context, "b.usdz", (self.folder / "room.usdz").read_bytes())[1], data)
        # On disk, a file may refer to others, but only to those in its folder.
        luxfer.usd.save(room, self.folder / "inside.usdc")
        kept = files.Files(self.folder / "state", security.Allowed([self.folder]))
        for folder, is_good in ((self.folder, True), (self.folder / "deeper", False)):
            folder.mkdir(exist_ok=True)
            path = folder / "whole.usda"
            path.write_text(f"#usda 1.0\n(subLayers = [@{self.folder / 'inside.usdc'}@])\n")
            if is_good:
                known = rooms.opened(self.context, kept, kept.open(path))
                self.assertEqual((known.name, known.path.parent), ("whole.glb", self.folder / "state" / "files"))
            else:
                with self.assertRaisesRegex(ValueError, "inside.usdc, which lies outside"):
                    rooms.opened(self.context, kept, kept.open(path))
        with self.assertRaisesRegex(ValueError, "no USD file"):
            rooms.given(self.context, "room.usda", b"#usda nothing")

    def test_what_is_wrong_is_an_error(self):
        stage = self.stage()
        self.square(stage, "/Broken", FaceVertexIndices=[0, 1, 2, 9])
        with self.assertRaisesRegex(ValueError, "/Broken"):
            luxfer.usd.from_stage(self.context, stage)
        whole = self.folder / "a.usdc"
        luxfer.usd.save(luxfer.Scene.demo(self.context, "still-life"), whole)
        short = self.folder / "short.usdc"
        short.write_bytes(whole.read_bytes()[:500])
        for path in (short, self.folder / "missing.usda"):
            with self.assertRaisesRegex(ValueError, path.name):
                luxfer.usd.load(self.context, path)
        with self.assertRaisesRegex(ValueError, "usdz"):
            luxfer.usd.save(luxfer.Scene(self.context), self.folder / "scene.obj")


if __name__ == "__main__":
    unittest.main()
