"""Loads and saves scenes as USD files (.usda, .usdc, .usdz) by Pixar's own library: `pip install luxfer[usd]`.

load() reads the composed stage at the default time and converts it to metres and Y up:

| USD | luxfer |
|---|---|
| Mesh | triangles in world space, of the control cage; a mesh for each GeomSubset with a material |
| UsdPreviewSurface | base colour, metallic, roughness, ior, opacity, emission in cd/m²; the textures of both colours |
| RectLight, DiskLight | a surface that emits, towards -z, intensity · 2^exposure · colour in cd/m² |
| SphereLight | a point light of equal luminous intensity, or a spot if it has ShapingAPI's cone |
| DistantLight | a directional light of equal illuminance |
| DomeLight | the environment, of one colour |
| Camera | a camera |

load() ignores invisible prims, guides and proxies, curves, points, volumes, instances of a PointInstancer, skinning,
subdivision, other shaders, other textures, UsdTransform2d, the images of domes, other lights, light linking. save()
leaves out punctual lights and the environment, all textures except of base colour and emission, and texture transforms.
"""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .image import Image
from .scene import Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .context import Context

#: Wrap modes of textures: the names of USD and of luxfer.
WRAPS = {"repeat": "repeat", "mirror": "mirror", "clamp": "clamp", "black": "clamp", "useMetadata": "repeat"}


def load(context: Context, path: str | os.PathLike[str]) -> Scene:
    """Loads a USD file with all files that it refers to. Meshes have the names of their prims."""
    from pxr import Tf, Usd

    try:
        stage = Usd.Stage.Open(os.fspath(path))
    except Tf.ErrorException as error:
        raise ValueError(f"{os.fspath(path)} is no USD file: {error}") from None
    return from_stage(context, stage)


def from_stage(context: Context, stage: Any) -> Scene:
    """Converts a Usd.Stage to a scene."""
    return _Reader(context, stage).scene


class _Reader:
    """Traverses a stage and adds its prims to a scene."""

    def __init__(self, context: Context, stage: Any):
        from pxr import Usd, UsdGeom, UsdLux

        self.context, self.scene = context, Scene(context)
        self.cache = UsdGeom.XformCache(Usd.TimeCode.Default())
        self.world = np.eye(4) * UsdGeom.GetStageMetersPerUnit(stage)
        self.world[3, 3] = 1
        if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
            self.world = self.world @ np.array(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
        self.materials: dict[str, int] = {}
        self.uv_names: dict[int, str] = {}  # the texture coordinates of each material with textures
        self.textures: dict[tuple[Any, ...], int] = {}
        seen = UsdGeom.Tokens.default_, UsdGeom.Tokens.render
        prims = iter(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
        for prim in prims:
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()  # prototypes of an instancer are not objects themselves
                continue
            if (shown := UsdGeom.Imageable(prim)) and (
                shown.ComputeVisibility() == UsdGeom.Tokens.invisible or shown.ComputePurpose() not in seen
            ):
                continue
            if prim.IsA(UsdGeom.Mesh):
                self.add_mesh(UsdGeom.Mesh(prim))
            elif prim.IsA(UsdGeom.Camera):
                self.add_camera(UsdGeom.Camera(prim))
            elif prim.HasAPI(UsdLux.LightAPI):
                self.add_light(prim)

    def matrix(self, prim: Any) -> NDArray[np.float64]:
        """The matrix from a prim to world space in metres; it is applied to row vectors, as in USD."""
        return np.array(self.cache.GetLocalToWorldTransform(prim)) @ self.world

    # -- meshes

    def add_mesh(self, mesh: Any) -> None:
        from pxr import UsdGeom, UsdShade

        points = np.array(mesh.GetPointsAttr().Get() or (), np.float64).reshape(-1, 3)
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get() or (), np.int64)
        corners = np.array(mesh.GetFaceVertexIndicesAttr().Get() or (), np.int64)
        prim, name = mesh.GetPrim(), mesh.GetPrim().GetName()
        if (counts < 0).any() or counts.sum() != len(corners) or (corners < 0).any() or (corners >= len(points)).any():
            raise ValueError(f"the faces of {prim.GetPath()} do not fit its {len(points)} points")
        matrix = self.matrix(prim)
        turned = (np.linalg.det(matrix[:3, :3]) < 0) != (mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded)
        faces, triangles = fans(counts, turned)
        if not len(triangles):
            return
        # Make one mesh of the faces of each subset that has its own material, and one of the remaining faces.
        binding = UsdShade.MaterialBindingAPI(prim)
        rest = np.ones(len(counts), bool)
        groups = []
        for subset in binding.GetMaterialBindSubsets():
            chosen = np.zeros(len(counts), bool)
            chosen[[i for i in subset.GetIndicesAttr().Get() or () if 0 <= i < len(counts)]] = True
            groups.append((chosen & rest, subset.GetPrim()))
            rest &= ~chosen
        two_sided = bool(mesh.GetDoubleSidedAttr().Get())
        parts = [(chosen[faces], owner) for chosen, owner in [*groups, (rest, prim)]]
        parts = [(chosen, self.material(owner, two_sided)) for chosen, owner in parts if chosen.any()]

        normals = self.primvar(mesh, "normals", 3)
        if normals is None and mesh.GetNormalsAttr().HasAuthoredValue():
            normals = np.array(mesh.GetNormalsAttr().Get(), np.float64), mesh.GetNormalsInterpolation()
        names = [self.uv_names[material] for _, material in parts if material in self.uv_names]
        uvs = self.primvar(mesh, names[0] if names else "st", 2)

        # Use one vertex per point or, if normals or texture coordinates differ between faces, one per corner of a
        # face.
        apart = any(found is not None and found[1] == "faceVarying" for found in (normals, uvs))
        vertices = np.arange(len(points)) if not apart else corners
        triangles = triangles if apart else corners[triangles]
        places = points[vertices] @ matrix[:3, :3] + matrix[3, :3]
        normals, uvs = (None if v is None else spread(*v, vertices, len(points), len(corners)) for v in (normals, uvs))
        if normals is not None:
            normals = normals @ np.linalg.inv(matrix[:3, :3]).T
            lengths = np.linalg.norm(normals, axis=1, keepdims=True)
            normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
        if uvs is not None:
            uvs = np.stack((uvs[:, 0], 1 - uvs[:, 1]), 1)  # in USD, t points up

        for chosen, material in parts:
            kept, indices = np.unique(triangles[chosen], return_inverse=True)
            self.scene.add_mesh(
                places[kept],
                indices.reshape(-1, 3).astype(np.uint32),
                normals=None if normals is None else normals[kept],
                uvs=None if uvs is None else uvs[kept],
                material=material,
                name=name,
            )

    def primvar(self, mesh: Any, name: str, width: int) -> tuple[NDArray[Any], str] | None:
        """The values of a primvar of a mesh, and their interpolation; None if the mesh lacks it."""
        from pxr import UsdGeom

        found = UsdGeom.PrimvarsAPI(mesh.GetPrim()).FindPrimvarWithInheritance(name)
        if not found or not found.HasValue():
            return None
        values = np.array(found.ComputeFlattened(), np.float64)
        return (values, found.GetInterpolation()) if values.ndim == 2 and values.shape[1] == width else None

    # -- materials

    def material(self, prim: Any, two_sided: bool) -> int:
        from pxr import UsdShade

        bound, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        key = f"{bound.GetPath() if bound else ''} {two_sided}"
        if key in self.materials:
            return self.materials[key]
        shader = bound.ComputeSurfaceSource()[0] if bound else None
        if shader is None or not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
            index = self.scene.add_material(name=bound.GetPrim().GetName() if bound else None, double_sided=int(two_sided))
            self.materials[key] = index
            return index

        def number(name: str, default: Any) -> tuple[Any, Any]:
            """The value of an input, and the texture to which it is connected, if any."""
            given = shader.GetInput(name)
            if not given:
                return default, None
            source = given.GetConnectedSources()[0] if given.HasConnectedSource() else []
            if source and (node := UsdShade.Shader(source[0].source.GetPrim())) and node.GetIdAttr().Get() == "UsdUVTexture":
                return default, node
            attributes = given.GetValueProducingAttributes()
            value = attributes[0].Get() if attributes else given.Get()
            return default if value is None else value, None

        colour, picture = number("diffuseColor", (0.18, 0.18, 0.18))
        emission, glow = number("emissiveColor", (0.0, 0.0, 0.0))
        opacity, threshold = number("opacity", 1.0)[0], number("opacityThreshold", 0.0)[0]
        index = self.scene.add_material(
            name=bound.GetPrim().GetName(),
            double_sided=int(two_sided),
            base_color=(1, 1, 1) if picture else tuple(np.clip(colour, 0, 1)),
            metallic=0.0 if number("useSpecularWorkflow", 0)[0] else float(np.clip(number("metallic", 0.0)[0], 0, 1)),
            roughness=float(np.clip(number("roughness", 0.5)[0], 0, 1)),
            ior=float(np.clip(number("ior", 1.5)[0], 1, 4)),
            emission=(1, 1, 1) if glow else tuple(np.maximum(emission, 0)),
            alpha=float(np.clip(opacity, 0, 1)),
            alpha_mode="mask" if threshold > 0 else "blend" if opacity < 1 else "opaque",
            alpha_cutoff=float(max(0.0, threshold)),
        )
        if picture and (texture := self.texture(picture)) is not None:
            self.scene.set_material_texture(index, "base-color", texture)
        if glow and (texture := self.texture(glow)) is not None:
            self.scene.set_material_texture(index, "emission", texture)
            scale = glow.GetInput("scale").Get() if glow.GetInput("scale") else None
            if scale is not None:
                self.scene.set_material(index, emission=tuple(scale)[:3])
        for node in filter(None, (picture, glow)):  # the emission decides if they differ
            self.uv_names[index] = self.coordinates(node)
        self.materials[key] = index
        return index

    @staticmethod
    def coordinates(node: Any) -> str:
        """The primvar with the texture coordinates of a UsdUVTexture."""
        from pxr import UsdShade

        given = node.GetInput("st")
        source = given.GetConnectedSources()[0] if given and given.HasConnectedSource() else []
        name = UsdShade.Shader(source[0].source.GetPrim()).GetInput("varname") if source else None
        values = name.GetValueProducingAttributes() if name else ()
        return str(values[0].Get()) if values and values[0].Get() else "st"

    def texture(self, node: Any) -> int | None:
        """Adds the image of a UsdUVTexture; returns its index, or None if it has no image."""
        from pxr import Ar

        def word(name: str, default: str) -> str:
            return (node.GetInput(name).Get() if node.GetInput(name) else None) or default

        file = node.GetInput("file").Get() if node.GetInput("file") else None
        if file is None or not file.resolvedPath:
            return None
        wraps = [WRAPS.get(word(name, "useMetadata"), "repeat") for name in ("wrapS", "wrapT")]
        raw = word("sourceColorSpace", "auto") == "raw"
        key = (file.resolvedPath, *wraps, raw)
        if key not in self.textures:
            asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(file.resolvedPath))  # also finds files inside a .usdz
            data = bytes(memoryview(asset.GetBuffer()))
            image = Image.from_bytes(self.context, data, "linear" if raw else "srgb")
            self.textures[key] = self.scene.add_texture(image, *wraps)
        return self.textures[key]

    # -- cameras and lights

    def add_camera(self, camera: Any) -> None:
        from pxr import Gf, Usd

        matrix = self.matrix(camera.GetPrim())
        up, back = (axis / np.linalg.norm(axis) for axis in matrix[1:3, :3])
        seen = camera.GetCamera(Usd.TimeCode.Default()).GetFieldOfView(Gf.Camera.FOVVertical)
        self.scene.add_camera(
            fov_y=math.radians(seen), position=tuple(matrix[3, :3]), target=tuple(matrix[3, :3] - back), up=tuple(up)
        )

    def add_light(self, prim: Any) -> None:
        from pxr import UsdLux

        light, matrix = UsdLux.LightAPI(prim), self.matrix(prim)
        colour = np.array(light.GetColorAttr().Get(), np.float64)
        if light.GetEnableColorTemperatureAttr().Get():
            colour *= np.array(UsdLux.BlackbodyTemperatureAsRgb(light.GetColorTemperatureAttr().Get()))
        luminance = np.maximum(colour * light.GetIntensityAttr().Get() * 2.0 ** light.GetExposureAttr().Get(), 0)
        normalised = bool(light.GetNormalizeAttr().Get())
        place, towards = matrix[3, :3], -matrix[2, :3]
        if prim.IsA(UsdLux.RectLight) or prim.IsA(UsdLux.DiskLight):
            if prim.IsA(UsdLux.RectLight):
                rect = UsdLux.RectLight(prim)
                x, y = rect.GetWidthAttr().Get() / 2, rect.GetHeightAttr().Get() / 2
                outline = np.array(((x, y, 0), (x, -y, 0), (-x, -y, 0), (-x, y, 0)))
            else:
                turns = np.linspace(0, -2 * np.pi, 64, endpoint=False)
                radius = UsdLux.DiskLight(prim).GetRadiusAttr().Get()
                outline = radius * np.stack((np.cos(turns), np.sin(turns), 0 * turns), 1)
            corners = outline @ matrix[:3, :3] + place
            fan = np.array([(0, k, k + 1) for k in range(1, len(corners) - 1)], np.uint32)
            a, b = corners[fan[:, 1]] - corners[0], corners[fan[:, 2]] - corners[0]
            area = np.linalg.norm(np.cross(a, b), axis=1).sum() / 2
            if area > 0:
                emission = tuple(luminance / (area if normalised else 1))
                material = self.scene.add_material(
                    name=prim.GetName(), base_color=(0, 0, 0), emission=emission, double_sided=0
                )
                self.scene.add_mesh(corners, fan, material=material, name=prim.GetName())
        elif prim.IsA(UsdLux.SphereLight):
            radius = UsdLux.SphereLight(prim).GetRadiusAttr().Get() * abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3)
            intensity = luminance / 4 if normalised else luminance * math.pi * radius**2
            shaping = UsdLux.ShapingAPI(prim) if prim.HasAPI(UsdLux.ShapingAPI) else None
            angle = math.radians(shaping.GetShapingConeAngleAttr().Get()) if shaping else math.pi
            if angle <= math.pi / 2:
                inner = angle * (1 - min(max(shaping.GetShapingConeSoftnessAttr().Get(), 0), 1))
                self.scene.add_light(
                    kind="spot", position=tuple(place), direction=tuple(towards), intensity=tuple(intensity), inner_angle=inner,
                    outer_angle=max(angle, 1e-4),
                )  # fmt: skip
            else:
                self.scene.add_light(kind="point", position=tuple(place), intensity=tuple(intensity))
        elif prim.IsA(UsdLux.DistantLight):
            angle = math.radians(UsdLux.DistantLight(prim).GetAngleAttr().Get())
            share = 1.0 if normalised or angle == 0 else math.pi * math.sin(angle / 2) ** 2
            self.scene.add_light(kind="directional", direction=tuple(towards), intensity=tuple(luminance * share))
        elif prim.IsA(UsdLux.DomeLight) and not prim.GetAttribute("inputs:texture:file").Get():
            self.scene.set_environment(tuple(luminance))


def fans(counts: NDArray[Any], turned: bool) -> tuple[NDArray[Any], NDArray[Any]]:
    """Triangulates faces with the given numbers of corners: returns the face and the three corners of each triangle.

    >>> fans(np.array([4, 3]), False)[1].tolist()
    [[0, 1, 2], [0, 2, 3], [4, 5, 6]]
    """
    each = np.maximum(counts - 2, 0)
    faces = np.repeat(np.arange(len(counts)), each)
    starts = np.concatenate(([0], np.cumsum(counts)))[:-1][faces]
    which = np.arange(len(faces)) - np.concatenate(([0], np.cumsum(each)))[:-1][faces]
    triangles = np.stack((starts, starts + which + 1, starts + which + 2), 1)
    return faces, triangles[:, ::-1] if turned else triangles


def spread(
    values: NDArray[Any], interpolation: str, vertices: NDArray[Any], points: int, corners: int
) -> NDArray[Any] | None:
    """Converts values per point, per corner (if the vertices are the corners) or for the whole mesh to values per
    vertex. None for other interpolations, or if the lengths do not match."""
    if interpolation in ("vertex", "varying") and len(values) == points:
        return values[vertices]
    if interpolation == "faceVarying" and len(values) == corners == len(vertices):
        return values
    if interpolation == "constant" and len(values) == 1:
        return np.repeat(values, len(vertices), 0)
    return None


def save(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Saves a scene as .usda, .usdc or .usdz. Textures go into a folder beside it, or into the .usdz."""
    from pxr import UsdUtils

    out = Path(path)
    if out.suffix not in (".usda", ".usdc", ".usd", ".usdz"):
        raise ValueError(f"path is {str(path)!r}; it must end in .usda, .usdc, .usd or .usdz")
    if out.suffix != ".usdz":
        _write(scene, out)
        return
    with tempfile.TemporaryDirectory() as folder:
        inside = Path(folder, "scene.usdc")
        _write(scene, inside)
        if not UsdUtils.CreateNewUsdzPackage(str(inside), str(out.absolute())):
            raise OSError(f"{out} could not be written")


def _write(scene: Scene, path: Path) -> None:
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, Vt

    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/Scene").GetPrim())
    textures: dict[tuple[int, str], str] = {}

    def file(number: int, kind: str) -> str:
        """Writes a texture beside the file; returns its relative path."""
        if (number, kind) not in textures:
            folder = path.with_name(f"{path.stem}_textures")
            folder.mkdir(exist_ok=True)
            scene.texture(number).save(folder / f"{number}.{kind}")
            textures[number, kind] = f"./{folder.name}/{number}.{kind}"
        return textures[number, kind]

    def surface(index: int) -> UsdShade.Material:
        settings = scene.material(index)
        material = UsdShade.Material.Define(stage, f"/Scene/Materials/Material{index}")
        shader = UsdShade.Shader.Define(stage, material.GetPath().AppendChild("Surface"))
        shader.CreateIdAttr("UsdPreviewSurface")
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        kinds = Sdf.ValueTypeNames

        def put(name: str, kind: Any, value: Any, role: str = "", suffix: str = "") -> None:
            given = shader.CreateInput(name, kind)
            use = scene.material_texture(index, role) if role else None
            if use is None or use.texture >= scene.counts.textures:
                given.Set(value)
                return
            node = UsdShade.Shader.Define(stage, material.GetPath().AppendChild(f"{name}Texture"))
            node.CreateIdAttr("UsdUVTexture")
            node.CreateInput("file", kinds.Asset).Set(file(use.texture, suffix))
            node.CreateInput("scale", kinds.Float4).Set(Gf.Vec4f(*map(float, value), 1))
            node.CreateInput("sourceColorSpace", kinds.Token).Set("sRGB" if suffix == "png" else "raw")
            for word, wrap in (("wrapS", use.wrap_u), ("wrapT", use.wrap_v)):
                node.CreateInput(word, kinds.Token).Set(wrap.name.lower())
            reader = UsdShade.Shader.Define(stage, material.GetPath().AppendChild(f"{name}Reader"))
            reader.CreateIdAttr("UsdPrimvarReader_float2")
            reader.CreateInput("varname", kinds.String).Set(st_name(use.uv_set, sets[index]))
            node.CreateInput("st", kinds.Float2).ConnectToSource(reader.ConnectableAPI(), "result")
            given.ConnectToSource(node.ConnectableAPI(), "rgb")

        put("diffuseColor", kinds.Color3f, tuple(settings["base_color"]), "base-color", "png")
        put("emissiveColor", kinds.Color3f, tuple(settings["emission"]), "emission", "exr")
        for name, key in (("metallic", "metallic"), ("roughness", "roughness"), ("ior", "ior")):
            put(name, kinds.Float, float(settings[key]))
        if settings["alpha_mode"]:
            put("opacity", kinds.Float, float(settings["alpha"]))
        if settings["alpha_mode"] == 1:
            put("opacityThreshold", kinds.Float, float(settings["alpha_cutoff"]))
        return material

    sets = [_uv_sets(scene, i) for i in range(scene.counts.materials)]
    materials = [surface(i) for i in range(scene.counts.materials)]
    for index, (name, used) in enumerate(_names(scene)):
        arrays = scene.mesh_arrays(index)
        mesh = UsdGeom.Mesh.Define(stage, f"/Scene/{name}")
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(arrays["positions"]))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(arrays["indices"]), 3))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(arrays["indices"].astype(np.int32).ravel()))
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        primvars = UsdGeom.PrimvarsAPI(mesh.GetPrim())
        if "normals" in arrays:
            mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(arrays["normals"]))
            mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
        for uv_set in sets[used]:
            uvs = arrays.get("uvs1" if uv_set else "uvs")
            if uvs is None:
                continue
            flipped = np.ascontiguousarray(np.stack((uvs[:, 0], 1 - uvs[:, 1]), 1), np.float32)
            name = st_name(uv_set, sets[used])
            st = primvars.CreatePrimvar(name, Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex)
            st.Set(Vt.Vec2fArray.FromNumpy(flipped))
        mesh.CreateDoubleSidedAttr(bool(scene.material(used)["double_sided"]))
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(materials[used])
    for index in range(scene.counts.cameras):
        _write_camera(stage, f"/Scene/Camera{index}", scene.camera(index))
    if not stage.GetRootLayer().Export(str(path)):
        raise OSError(f"{path} could not be written")


def _uv_sets(scene: Scene, material: int) -> list[int]:
    """The sets of texture coordinates that the written textures of a material use; the first set without textures."""
    uses = [scene.material_texture(material, role) for role in ("base-color", "emission")]
    return sorted({use.uv_set for use in uses if use.texture < scene.counts.textures}) or [0]


def st_name(uv_set: int, sets: list[int]) -> str:
    """The primvar of a set of texture coordinates: st, and st1 beside it if the material uses two sets."""
    return "st" if uv_set == sets[0] else "st1"


def _names(scene: Scene) -> Iterator[tuple[str, int]]:
    """A valid and unique USD name for each mesh, and the index of the mesh's material."""
    from pxr import Tf

    taken = {"Materials"}
    for index in range(scene.counts.meshes):
        name = base = Tf.MakeValidIdentifier(scene.mesh_name(index) or "Mesh")
        number = 1
        while name in taken or name.startswith("Camera"):
            number += 1
            name = f"{'_' * base.startswith('Camera')}{base}_{number}"
        taken.add(name)
        yield name, scene.mesh(index).material


def _write_camera(stage: Any, path: str, settings: Any) -> None:
    from pxr import Gf, UsdGeom

    camera = UsdGeom.Camera.Define(stage, path)
    position, target, up = (Gf.Vec3d(*map(float, settings[key])) for key in ("position", "target", "up"))
    camera.AddTransformOp().Set(Gf.Matrix4d().SetLookAt(position, target, up).GetInverse())
    height = 24.0
    camera.CreateVerticalApertureAttr(height)
    camera.CreateFocalLengthAttr(height / 2 / math.tan(settings["fov_y"] / 2))
