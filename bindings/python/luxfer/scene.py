"""Scenes: from files and arrays, read back, changed, and written."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from . import _abi, _arrays, _params
from ._handle import Handle, call
from ._pointers import POINTER
from .candidate import SurfaceCandidate, candidates_of
from .image import Image, image_of
from .types import (
    CameraParams,
    GonioReport,
    MaterialParams,
    MeshInfo,
    Pendant,
    Requirements,
    SceneCounts,
    SkyReport,
    Surface,
    TextureRole,
    TextureUse,
    Wrap,
)
from .warning import StageWarning, warnings_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import Unpack

    from .context import Context
    from .image import ImageLike
    from .photometry import Distribution
    from .types import GonioParams, LightParams, LuminaireParams, SceneLoadParams, SkyParams

#: The entry that intersect() returns for each ray; a miss has t = inf and mesh = triangle = 2**32 - 1.
HIT = np.dtype([("t", "f4"), ("mesh", "u4"), ("triangle", "u4"), ("u", "f4"), ("v", "f4")])

#: The entry that glare() returns for each observer; ugr is -inf if no rated light is in view.
GLARE = np.dtype(
    [(name, "f8") for name in ("ugr", "background", "background_error", "unrated_lux", "solid_angle")]
    + [("sources", "u4"), ("outside_range", "u4")]
)


class Scene(Handle):
    """Meshes, materials, textures, lights and cameras; metres, Y up, emission in cd/m².

    >>> scene = Scene(context)
    >>> lamp = scene.add_material(name="lamp", emission=(100, 90, 80))
    >>> corners = [[0, 2, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]]
    >>> scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], name="Lamp", material=lamp)
    0
    >>> scene.counts.triangles
    2
    """

    kind = "scene"

    def __init__(self, context: Context) -> None:
        self._create(context)

    # -- files

    @classmethod
    def load(cls, context: Context, path: str | os.PathLike[str], **params: Unpack[SceneLoadParams]) -> Scene:
        """Loads a glTF 2.0 file: a .glb, or a .gltf with the files that it names. unit is the length of the file's
        unit in metres."""
        settings = _params.fill(_abi.luxfer_scene_load_params, params, [])
        return cls._made(context, "luxfer_scene_load", _params.text(os.fspath(path), "path"), settings)

    @classmethod
    def from_bytes(
        cls,
        context: Context,
        data: bytes,
        base_path: str | os.PathLike[str] | None = None,
        **params: Unpack[SceneLoadParams],
    ) -> Scene:
        """Loads a glTF file from its bytes; files that it names are read from base_path."""
        base = None if base_path is None else _params.text(os.fspath(base_path), "base_path")
        settings = _params.fill(_abi.luxfer_scene_load_params, params, [])
        return cls._made(context, "luxfer_scene_load_memory", data, len(data), base, settings)

    @property
    def origin(self) -> tuple[float, float, float]:
        """The origin of the scene's positions in the coordinates of its file, in metres; 0 unless the scene is far
        away."""
        x, y, z = (ctypes.c_double() for _ in range(3))
        self._call("get_origin", x, y, z)
        return x.value, y.value, z.value

    @property
    def warnings(self) -> list[StageWarning]:
        """Warnings about the file: an implausible size, and features that are not rendered."""
        return warnings_of(self)

    @property
    def candidates(self) -> list[SurfaceCandidate]:
        """Objects and materials that may be the ceiling, with area, height and direction; the likeliest first."""
        return candidates_of(self)

    @classmethod
    def _made(cls, context: Context, name: str, *arguments: Any) -> Scene:
        handle = POINTER(_abi.luxfer_scene)()
        call(context, name, context, *arguments, handle)
        return cls._adopt(context, handle)

    def export(self, path: str | os.PathLike[str]) -> None:
        """Saves a GLB file that contains the textures."""
        self._call("export", _params.text(os.fspath(path), "path"))

    def to_bytes(self) -> bytes:
        """The scene as the bytes of a GLB file."""
        parts: list[bytes] = []

        def write(_: Any, data: int, size: int) -> int:
            parts.append(ctypes.string_at(data, size))
            return 0

        self._call("export_memory", _abi.luxfer_write_fn(write), None)
        return b"".join(parts)

    # -- description

    def add_material(self, **params: Unpack[MaterialParams]) -> int:
        """Adds a material; returns its index."""
        return self._add("add_material", _params.fill(_abi.luxfer_material_params, params, []))

    def add_mesh(
        self,
        positions: ArrayLike,
        indices: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        colours: ArrayLike | None = None,
        material: int = 0,
        name: str | None = None,
    ) -> int:
        """Adds a mesh; returns its index. positions (n, 3), indices (m, 3) and, if given, normals (n, 3), uvs (n, 2)
        and colours (n, 4) are read directly from their memory if they are float32 and uint32, with any stride between
        rows."""
        params = _params.fill(_abi.luxfer_mesh_params, {"material": material, "name": name}, [])
        arrays = []  # keeps the arrays alive until the call ends
        for field, stride, values, width, dtype in (
            ("positions", "position_stride", positions, 3, np.float32),
            ("normals", "normal_stride", normals, 3, np.float32),
            ("uvs", "uv_stride", uvs, 2, np.float32),
            ("colours", "colour_stride", colours, 4, np.float32),
            ("indices", "index_stride", indices, 3, np.uint32),
        ):
            if values is None:
                continue
            array = _rows(values, width, dtype, field)
            arrays.append(array)
            if field in ("normals", "uvs", "colours") and len(array) != params.vertex_count:
                raise ValueError(f"there are {len(array)} {field} for {params.vertex_count} positions")
            if field == "positions":
                params.vertex_count = len(array)
            elif field == "indices":
                params.triangle_count = len(array)
            setattr(params, field, array.ctypes.data)
            setattr(params, stride, array.strides[0] if len(array) > 1 else 0)
        return self._add("add_mesh", params)

    def add_camera(self, **params: Unpack[CameraParams]) -> int:
        """Adds a camera; returns its index."""
        return self._add("add_camera", _params.fill(_abi.luxfer_camera_params, params, []))

    def set_camera(self, index: int, **params: Unpack[CameraParams]) -> None:
        """Replaces a camera; missing settings get their defaults."""
        self._call("set_camera", index, _params.fill(_abi.luxfer_camera_params, params, []))

    def add_light(self, **params: Unpack[LightParams]) -> int:
        """Adds a punctual light: kind "point", "spot" or "directional"; returns its index."""
        return self._add("add_light", _params.fill(_abi.luxfer_light_params, params, []))

    def add_luminaire(self, distribution: Distribution, **params: Unpack[LuminaireParams]) -> int:
        """Adds a luminaire with a measured intensity distribution; returns its index among the lights.

        >>> panel = "IESNA:LM-63-2002\\nTILT=NONE\\n1 -1 1 2 1 1 2 0 0 0\\n1 1 30\\n0 180\\n0\\n100 100\\n"
        >>> hall = Scene(context)
        >>> hall.add_luminaire(Distribution.load_memory(context, panel.encode(), "ies"), position=(0, 3, 0), flux=2000)
        0
        """
        return self._add("add_luminaire", distribution, _params.fill(_abi.luxfer_luminaire_params, params, []))

    def _add(self, verb: str, *arguments: Any) -> int:
        index = ctypes.c_uint32()
        self._call(verb, *arguments, index)
        return index.value

    def set_material(self, index: int, **params: Unpack[MaterialParams]) -> None:
        """Changes the given settings of a material; its other settings, its textures and its name stay."""
        values = {**self.material(index), **params}
        self._call("set_material", index, _params.fill(_abi.luxfer_material_params, values, []))

    def add_texture(self, image: ImageLike, wrap: Wrap | str = Wrap.REPEAT, wrap_v: Wrap | str | None = None) -> int:
        """Adds a texture with linear values and 1, 3 or 4 channels; returns its index."""
        wraps = [_params.member(Wrap, w) for w in (wrap, wrap if wrap_v is None else wrap_v)]
        index = ctypes.c_uint32()
        self._call("add_texture", image_of(self._context, image), *wraps, index)
        return index.value

    def set_material_texture(
        self,
        material: int,
        role: TextureRole | str,
        texture: int | None,
        uv_set: int = 0,
        transform: ArrayLike | None = None,
    ) -> None:
        """Sets the texture of a material for "base-color", "metallic-roughness", "normal" or "emission"; None removes
        it. transform is a 2 x 3 matrix that is applied to (u, v, 1) before the look-up."""
        matrix = None if transform is None else np.ascontiguousarray(transform, np.float32)
        if matrix is not None and matrix.size != 6:
            raise ValueError(f"transform is 6 numbers, not {matrix.size}")
        number = _abi.LUXFER_NONE if texture is None else texture
        pointer = _arrays.pointer(matrix, ctypes.c_float)
        self._call("set_material_texture", material, _params.member(TextureRole, role), number, uv_set, pointer)

    # -- light

    def set_environment(self, colour: Sequence[float], image: ImageLike | None = None) -> None:
        """Sets an environment of uniform radiance colour, in cd/m²; or, with image, an equirectangular image
        multiplied by colour."""
        sky = None if image is None else image_of(self._context, image)
        self._call("set_environment", sky, _params.rgb(colour))

    def set_sky(self, **params: Unpack[SkyParams]) -> SkyReport:
        """Sets a sky as the environment, and the sun as a directional light: model "cie" with cie_type 1 to 16, or
        "perez"; unit "lux" or "watts" of direct_normal and diffuse_horizontal. The default is the overcast sky of type
        1 with 10,000 lx. sun_position() and Weather.sky() give settings for it.

        >>> scene = Scene(context)
        >>> sky = scene.set_sky(cie_type=12, sun_altitude=0.7, direct_normal=60_000, diffuse_horizontal=15_000)
        >>> round(sky.diffuse_horizontal), scene.counts.lights
        (15000, 1)
        """
        settings = _params.fill(_abi.luxfer_sky_params, params, [])
        return cast(SkyReport, self._read("set_sky", _abi.luxfer_sky_report, settings))

    def find_surface(self, name: str) -> Surface:
        """Finds the planar surface of an object or material that faces the room."""
        return cast(Surface, self._read("find_surface", _abi.luxfer_surface, _params.text(name, "name")))

    def place_emission(self, name: str, texture: ImageLike, scale: Sequence[float] = (1, 1, 1)) -> tuple[int, int]:
        """Maps an emissive texture onto a surface, which becomes a separate mesh that emits texture * scale in cd/m²;
        returns the indices of the mesh and of its material."""
        mesh, material = ctypes.c_uint32(), ctypes.c_uint32()
        image = image_of(self._context, texture)
        self._call("place_emission", _params.text(name, "name"), image, _params.rgb(scale), mesh, material)
        return mesh.value, material.value

    def add_pendants(
        self, pendant: Pendant, places: ArrayLike, *, luminance: float, diameter: float = 0
    ) -> tuple[int, int]:
        """Adds a mesh with the body of a lamp, found by find_pendants, at each of the places (n, 3): the middles of
        the upper ends, in metres. `luminance` in cd/m² belongs to a surface of value 1 in the photo; `diameter` 0 is
        the diameter found. Returns the indices of the first mesh and of the material."""
        lamp = _abi.luxfer_pendant(struct_size=ctypes.sizeof(_abi.luxfer_pendant))
        _params.update(lamp, vars(pendant), [])
        tops = _rows(places, 3, np.float64, "places")
        mesh, material = ctypes.c_uint32(), ctypes.c_uint32()
        place = _arrays.pointer(tops, ctypes.c_double)
        self._call("add_pendants", lamp, place, len(tops), diameter, luminance, mesh, material)
        return mesh.value, material.value

    # -- contents

    @property
    def counts(self) -> SceneCounts:
        """Numbers of meshes, materials, textures, lights, cameras and triangles."""
        return cast(SceneCounts, self._read("get_counts", _abi.luxfer_scene_counts))

    def camera(self, index: int = 0) -> CameraParams:
        """The settings of a camera, as for add_camera."""
        params = self._fill("get_camera", _abi.luxfer_camera_params, index)
        return cast(CameraParams, _params.settings(params))

    def material(self, index: int) -> MaterialParams:
        """The settings of a material, as for add_material, without its name."""
        params = self._fill("get_material", _abi.luxfer_material_params, index)
        return cast(MaterialParams, _params.settings(params))

    def material_texture(self, index: int, role: TextureRole | str) -> TextureUse:
        """The texture that a material uses for a purpose."""
        use = self._read("get_material_texture", _abi.luxfer_texture_use, index, _params.member(TextureRole, role))
        return cast(TextureUse, use)

    def texture(self, index: int) -> Image:
        """A texture of the scene, with linear values."""
        return self._get_image("get_texture", index)

    def mesh(self, index: int) -> MeshInfo:
        """Sizes and attributes of a mesh."""
        return cast(MeshInfo, self._read("get_mesh", _abi.luxfer_mesh_info, index))

    def mesh_name(self, index: int) -> str:
        """The name of a mesh."""
        return self._get_text("get_mesh_name", index)

    def mesh_arrays(self, index: int) -> dict[str, NDArray[Any]]:
        """Copies of a mesh's "positions", "indices" and, if it has them, "normals", "uvs", "uvs1" and "colours"."""
        info = self.mesh(index)
        attributes = {
            "positions": (_abi.LUXFER_VERTEX_POSITION, 3, True),
            "normals": (_abi.LUXFER_VERTEX_NORMAL, 3, info.has_normals),
            "uvs": (_abi.LUXFER_VERTEX_UV_0, 2, info.uv_sets & 1),
            "uvs1": (_abi.LUXFER_VERTEX_UV_1, 2, info.uv_sets & 2),
            "colours": (_abi.LUXFER_VERTEX_COLOUR, 4, info.has_colours),
        }
        out: dict[str, NDArray[Any]] = {"indices": np.empty((info.triangle_count, 3), np.uint32)}
        self._call("read_triangles", index, _arrays.pointer(out["indices"], ctypes.c_uint32), info.triangle_count)
        for name, (attribute, numbers, exists) in attributes.items():
            if exists:
                out[name] = np.empty((info.vertex_count, numbers), np.float32)
                pointer = _arrays.pointer(out[name], ctypes.c_float)
                self._call("read_vertices", index, attribute, pointer, info.vertex_count)
        return out

    # -- questions

    def intersect(self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike = np.inf) -> NDArray[Any]:
        """Finds the nearest hits of rays with origins (n, 3) and directions (n, 3). Returns a structured array with
        the fields t, mesh, triangle, u, v.

        >>> Scene.demo(context, "target-room").intersect([[0, 1.5, 0]], [[0, 1, 0]])["t"].round(2).item() > 0
        True
        """
        start, towards = _rows(origins, 3, np.float32, "origins"), _rows(directions, 3, np.float32, "directions")
        rays = np.empty((max(len(start), len(towards)), 7), np.float32)
        rays[:, :3], rays[:, 3:6], rays[:, 6] = start, towards, t_max
        hits = np.empty(len(rays), HIT)
        pointer = _arrays.pointer(rays, _abi.luxfer_ray)
        self._call("intersect", pointer, len(rays), 0, _arrays.pointer(hits, _abi.luxfer_hit), 0)
        return hits

    def glare(
        self, positions: ArrayLike, directions: ArrayLike, samples: int = 4096, seed: int = 1
    ) -> NDArray[Any]:
        """Rates the glare of the scene's luminaires and emissive meshes (UGR) for observers with positions (n, 3) and
        lines of sight (n, 3). Returns a structured array with the fields ugr, background, background_error,
        unrated_lux, solid_angle, sources, outside_range.

        >>> Scene.demo(context, "target-room").glare([[3, 1.2, 1]], [[0, 0, 1]], samples=16)["sources"].item()
        0
        """
        eyes, ahead = _rows(positions, 3, np.float32, "positions"), _rows(directions, 3, np.float32, "directions")
        observers = np.empty((max(len(eyes), len(ahead)), 6), np.float32)
        observers[:, :3], observers[:, 3:] = eyes, ahead
        ratings = np.empty(len(observers), GLARE)
        pointer = _arrays.pointer(observers, _abi.luxfer_observer)
        out = _arrays.pointer(ratings, _abi.luxfer_observer_glare)
        self._call("get_glare", pointer, len(observers), 0, samples, seed, out, 0)
        return ratings

    def distribution(
        self, meshes: ArrayLike | None = None, **params: Unpack[GonioParams]
    ) -> tuple[Distribution, GonioReport]:
        """Measures the luminous intensity of meshes far away from them, by their indices; without indices, of all
        meshes. Returns the distribution, and a report with its errors and the position of its luminaire.

        >>> scene = Scene(context)
        >>> lamp = scene.add_material(emission=(100, 100, 100))
        >>> corners = [[0, 2, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]]
        >>> mesh = scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], material=lamp)
        >>> distribution, report = scene.distribution([mesh], planes=4, angles=19, samples=64)
        >>> round(distribution.intensity(0, 0)), [round(p, 3) for p in report.position]
        (100, [0.5, 2.0, 0.5])
        """
        from .photometry import Distribution

        settings = _params.fill(_abi.luxfer_gonio_params, params, [])
        indices, place = np.empty((0, 1), np.uint32), None
        if meshes is not None:
            indices = np.ascontiguousarray(_rows(np.reshape(meshes, (-1, 1)), 1, np.uint32, "meshes"))
            if not indices.size:
                raise ValueError("meshes is empty; leave it out to measure all meshes")
            place = _arrays.pointer(indices, ctypes.c_uint32)
        pointer, report = POINTER(_abi.luxfer_distribution)(), _abi.luxfer_gonio_report()
        self._call("get_distribution", place, indices.size, settings, pointer, report, ctypes.sizeof(report))
        return Distribution._adopt(self.context, pointer), cast(GonioReport, _params.report(report))

    def requirements(self, error: float = 0.01) -> Requirements:
        """The features that the scene requires of a renderer. Its field bounces is the number of bounces beyond which
        at most the share error of all scattered light remains."""
        out = self._fill("get_requirements", _abi.luxfer_requirements, error)
        return cast(Requirements, _params.report(out))

    def requirements_text(self) -> str:
        """Describes the features that the renderer skips, one sentence per line."""
        return self._get_text("get_requirements_text")

    @classmethod
    def demo(cls, context: Context, which: Any) -> Scene:
        """A generated scene: "target-room", "exemplar-room", "sphere-on-table" or "still-life"."""
        from .types import Demo

        return cls._made(context, "luxfer_demo_create_scene", _params.member(Demo, which))


def _rows(values: ArrayLike, width: int, dtype: Any, name: str) -> NDArray[Any]:
    """Converts values to an array (n, width) with packed rows; copies only if they are not packed yet."""
    raw = np.asarray(values)
    if dtype == np.uint32 and raw.size and (raw.dtype.kind not in "iu" or raw.min() < 0):
        raise ValueError(f"{name} are whole numbers from 0 on")
    out = np.asarray(raw, dtype)
    if out.ndim != 2 or out.shape[1] != width:
        raise ValueError(f"{name} has the shape (n, {width}), not {out.shape}")
    packed = out.strides[1] == out.itemsize and (len(out) < 2 or out.strides[0] >= width * out.itemsize)
    return out if packed else np.ascontiguousarray(out)
