"""Writes the initial corpora of the fuzz targets, small files of every format, and a dictionary for each target.

    python3 seeds.py FOLDER     writes FOLDER/TARGET/* and FOLDER/TARGET.dict
"""

from __future__ import annotations

import base64
import json
import struct
import sys
import tempfile
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests" / part) for part in ("conformance", "python")]

import calls  # noqa: E402
import files  # noqa: E402
import onnx_file  # noqa: E402
import scenarios  # noqa: E402

import luxfer  # noqa: E402
from luxfer.image import np  # noqa: E402

# --------------------------------------------------------------------------------------------------------------- images


def png(depth: int, colour: int, interlaced: int = 0, size: int = 4) -> bytes:
    """A PNG file of a colour type: 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGB and alpha."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    row = bytes(range(-(-size * channels * depth // 8)))
    # Use every row filter. Interlaced pictures are black, with enough zero bytes for the rows of all seven passes.
    data = bytes(300) if interlaced else b"".join(bytes([y % 5]) + row for y in range(size))
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, depth, colour, 0, 0, interlaced))
    palette = chunk(b"PLTE", bytes(range(48))) + chunk(b"tRNS", bytes(9)) if colour == 3 else b""
    return b"\x89PNG\r\n\x1a\n" + head + palette + chunk(b"IDAT", zlib.compress(data)) + chunk(b"IEND", b"")


def jpeg(channels: int) -> bytes:
    """A JPEG file of 16 x 16 pixels; each block has one colour, which takes two bits."""

    def segment(marker: int, content: bytes) -> bytes:
        return struct.pack(">BBH", 0xFF, marker, len(content) + 2) + content

    parts = b"".join(bytes([c + 1, 0x11, 0]) for c in range(channels))
    frame = segment(0xC0, struct.pack(">BHHB", 8, 16, 16, channels) + parts)
    # Each Huffman table has one code of one bit: a difference of 0, and the end of a block.
    tables = b"".join(segment(0xC4, bytes([which, 1, *[0] * 15, 0])) for which in (0x00, 0x10))
    scan = bytes([channels]) + b"".join(bytes([c + 1, 0]) for c in range(channels)) + bytes([0, 63, 0])
    return b"\xff\xd8" + segment(0xDB, bytes([0, *[1] * 64])) + frame + tables + segment(0xDA, scan) + bytes(3 * channels) + b"\xff\xd9"


def notes(orientation: int) -> bytes:
    """EXIF metadata: an orientation (a photo taken in portrait format) and an exposure."""
    camera = [(0x829A, 5, 68), (0x829D, 5, 76), (0x8827, 3, 100), (0xA405, 3, 26)]
    picture = [(0x0112, 3, orientation), (0x8769, 4, 84)]
    first, second = (struct.pack("<H", len(e)) + b"".join(struct.pack("<HHII", t, k, 1, v) for t, k, v in e) for e in (picture, camera))
    return (b"II*\0\x08\0\0\0" + first).ljust(68, b"\0") + struct.pack("<IIII", 1, 50, 28, 10) + second


def tiff(samples: int, bits: int, photometric: int, compression: int = 1, predictor: int = 1, tile: int = 0, planar: int = 1) -> bytes:
    """A TIFF file of 4 x 4 pixels, in strips of two rows or in tiles; with a palette if the photometric interpretation
    asks for one; of floating-point samples if they have 32 bits."""
    row = bytes(range(-(-4 * samples * bits // 8 // (samples if planar == 2 else 1))))
    rows = tile or 2
    pixels = row * rows * (tile // 4 if tile else 1)
    literal = b"".join(bytes([len(pixels[i : i + 99]) - 1]) + pixels[i : i + 99] for i in range(0, len(pixels), 99))
    # LZW: a clear code, a code for each byte, and the end code, all of nine bits.
    codes = "".join(f"{code:09b}" for code in (256, *pixels[:200], 257))
    lzw = int(codes.ljust(-(-len(codes) // 8) * 8, "0"), 2).to_bytes(-(-len(codes) // 8), "big")
    packed = {1: pixels, 5: lzw, 8: zlib.compress(pixels), 32773: literal}[compression]
    count = (1 if tile else 2) * (samples if planar == 2 else 1)
    fields = {256: 4, 257: 4, 258: bits, 259: compression, 262: photometric, 274: 6, 277: samples, 284: planar, 317: predictor}
    fields |= {322: tile, 323: tile} if tile else {278: rows}
    fields |= {339: 3 if bits == 32 else 1} | ({338: 2} if samples in (2, 4) and photometric != 5 else {})
    # Values that are too long for a directory entry follow the directory; the pixels come last.
    tail = 8 + 2 + 12 * (len(fields) + 2 + (photometric == 3)) + 4
    start = tail + (8 * count if count > 1 else 0) + (6 << bits if photometric == 3 else 0)
    lists = {
        324 if tile else 273: (4, [start + k * len(packed) for k in range(count)]),
        325 if tile else 279: (4, [len(packed)] * count),
    } | ({320: (3, range(0, 3 << bits))} if photometric == 3 else {})
    entries, more = {tag: struct.pack("<HHIHxx", tag, 3, 1, value) for tag, value in fields.items()}, b""
    for tag, (kind, values) in lists.items():
        content = b"".join(struct.pack("<I" if kind == 4 else "<H", value) for value in values)
        is_inline = len(content) <= 4
        place = content if is_inline else struct.pack("<I", tail + len(more))
        entries[tag] = struct.pack("<HHI", tag, kind, len(values)) + place
        more += b"" if is_inline else content
    directory = struct.pack("<H", len(entries)) + b"".join(entries[tag] for tag in sorted(entries)) + bytes(4)
    return b"II*\0\x08\0\0\0" + directory + more + packed * count


def bmp(bits: int) -> bytes:
    palette = bytes(4 << bits) if bits <= 8 else b""
    row = -(-4 * bits // 32) * 4
    head = struct.pack("<IiiHHIIiiII", 40, 4, 4, 1, bits, 0, 4 * row, 0, 0, 0, 0)
    return b"BM" + struct.pack("<III", 54 + len(palette) + 4 * row, 0, 54 + len(palette)) + head + palette + bytes(range(4 * row))


def gif(interlaced: int = 0) -> bytes:
    """A GIF file with a comment and two pixels of two colours."""
    head = b"GIF89a" + struct.pack("<HHBBB", 2, 1, 0x80, 0, 0) + bytes(range(6)) + b"\x21\xfe\x01a\0\x21\xf9\x04\x01\0\0\1\0"
    return head + b"\x2c" + struct.pack("<HHHHB", 0, 0, 2, 1, interlaced << 6) + b"\x02\x02\x44\x0a\0;"


def webp(extended: bool) -> bytes:
    """A lossless WebP file of one black pixel; every prefix code has one symbol."""
    pixel = b"\x2f\0\0\0\x10\x07\x10\x11\x11\x88\x88\xfe\x07"

    def chunk(name: bytes, content: bytes) -> bytes:
        return name + struct.pack("<I", len(content)) + content + bytes(len(content) % 2)

    chunks = chunk(b"VP8L", pixel)
    if extended:
        chunks = chunk(b"VP8X", b"\x08\0\0\0" + bytes(6)) + chunks + chunk(b"EXIF", notes(8))
    return b"RIFF" + struct.pack("<I", len(chunks) + 4) + b"WEBP" + chunks


def profile(space: bytes, tables: dict[bytes, bytes]) -> bytes:
    """An ICC profile with the given tags."""
    start, entries, content = 132 + 12 * len(tables), b"", b""
    for name, table in tables.items():
        entries += name + struct.pack(">II", start + len(content), len(table))
        content += table
    head = struct.pack(">I4sI4s4s4s", start + len(content), b"\0" * 4, 2 << 24, b"mntr", space, b"Lab ").ljust(36, b"\0") + b"acsp"
    return head.ljust(128, b"\0") + struct.pack(">I", len(tables)) + entries + content


def inks() -> list[bytes]:
    """JPEG files of four inks and of three colours, with ICC profiles whose tables have two grid points per axis."""
    out = []
    for channels, space in ((4, b"CMYK"), (3, b"RGB ")):
        one = struct.pack(">i", 65536)
        matrix = (one + bytes(12)) * 2 + one
        ramps = struct.pack(">HH", 0, 65535)
        head = b"mft2\0\0\0\0" + bytes([channels, 3, 2, 0]) + matrix + struct.pack(">HH", 2, 2)
        points = bytes(v % 256 for v in range(6 * 2**channels))
        icc = profile(space, {b"A2B0": head + ramps * channels + points + ramps * 3})
        plain, segment = jpeg(channels), b"ICC_PROFILE\0\1\1" + icc
        out.append(plain[:2] + struct.pack(">BBH", 0xFF, 0xE2, len(segment) + 2) + segment + plain[2:])
    adobe = b"Adobe\0\x64\0\0\0\0\2"
    return [*out, out[0][:2] + struct.pack(">BBH", 0xFF, 0xEE, len(adobe) + 2) + adobe + out[0][2:]]


def photos() -> list[bytes]:
    """Pictures with the metadata of a camera, and picture formats besides PNG and JPEG."""
    exif = b"Exif\0\0" + notes(6)
    plain = jpeg(3)
    camera = plain[:2] + struct.pack(">BBH", 0xFF, 0xE1, len(exif) + 2) + exif + plain[2:]
    kinds = [(1, 1, 0), (1, 4, 3), (1, 8, 1), (3, 8, 2), (4, 8, 5), (4, 16, 2), (3, 32, 2)]
    tiffs = [tiff(*kind, compression) for kind in kinds for compression in (1, 5, 8, 32773)]
    tiffs += [tiff(3, 8, 2, 8, 2, 16), tiff(3, 16, 2, 5, 2), tiff(3, 32, 2, 8, 3), tiff(3, 8, 2, 1, 1, 0, 2), tiff(3, 16, 2, 1, 1, 16, 2)]
    return [camera, *inks(), *tiffs, *map(bmp, (1, 4, 8, 16, 24, 32)), gif(), gif(1), webp(False), webp(True)]


def rasters() -> list[bytes]:
    kinds = [(1, 0), (8, 0), (16, 0), (8, 2), (16, 2), (2, 3), (8, 3), (8, 4), (16, 4), (8, 6), (16, 6)]
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n"
    packed = b"".join(b"\x02\x02\x00\x08" + b"\x88\x70" * 4 for _ in range(2))
    pngs = [png(depth, colour, interlaced) for depth, colour in kinds for interlaced in (0, 1)]
    return [*pngs, jpeg(1), jpeg(3), head + packed, head + bytes(range(64))]


def saved(thing, ending: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"a.{ending}")
        thing.save(path)
        return path.read_bytes()


def layered(context: luxfer.Context) -> list[bytes]:
    """OpenEXR files with one, three and four channels, and with many layers."""
    plain = [saved(luxfer.Image(context, np.linspace(0, 1, 6 * 4 * n, dtype=np.float32).reshape(4, 6, n)), "exr") for n in (1, 3, 4)]
    render = luxfer.Render(context, luxfer.Scene.demo(context, "sphere-on-table"), expressions={"direct": "LDE"}, aovs=0x7F)
    render.run(width=9, height=5, samples=1)
    with tempfile.TemporaryDirectory() as folder:
        render.write_exr(path := Path(folder, "a.exr"))
        return [*plain, path.read_bytes()]


# --------------------------------------------------------------------------------------------------------------- scenes


def scene(context: luxfer.Context) -> bytes:
    """A GLB file with one of each thing that the library exports."""
    out = luxfer.Scene(context)
    out.add_material(name="Paint", base_color=(0.5, 0.4, 0.3), roughness=0.5, metallic=0.5)
    out.add_material(name="Lamp", emission=(50, 40, 30), double_sided=1)
    out.add_material(name="Glass", transmission=0.9, ior=1.4, thickness=0.1, attenuation_color=(1, 0.5, 0), attenuation_distance=2)
    corners = np.float32([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
    triangles = np.uint32([[0, 2, 1], [0, 3, 2]])
    for material, height in ((0, 0), (1, 2), (2, 1)):
        place = corners + np.float32([0, height, 0])
        out.add_mesh(place, triangles, uvs=corners[:, ::2].copy(), material=material, name=f"Plane {height}")
    for role in ("base-color", "metallic-roughness", "normal", "emission"):
        texture = out.add_texture(np.full((2, 2, 3), 0.5, np.float32), wrap="mirror")
        out.set_material_texture(0, role, texture, transform=(1, 0, 0, 0, 1, 0.5))
    out.add_camera(position=(0, 1, 4), target=(0, 1, 0))
    for kind in ("point", "spot", "directional"):
        out.add_light(kind=kind, position=(0, 1, 0))
    return out.to_bytes()


def as_text(glb: bytes) -> bytes:
    """Converts a GLB file to a .gltf file with an embedded buffer."""
    length = struct.unpack_from("<I", glb, 12)[0]
    tree = json.loads(glb[20 : 20 + length])
    tree["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(glb[28 + length :]).decode()
    return json.dumps(tree, separators=(",", ":")).encode()


#: Draco streams of two triangles: one with sequential encoding, one with edgebreaker encoding.
DRACO = [
    "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgABAQEBgAJVFQEQARD////vrQoFooQ0UqsAAAAA/wAAAAAAAAAAAAAAAAAAAAAAgD8I",
    "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgEBAQAJAwEgARATARADADCQSgAC/gEAAAAA/wAAAAAAAAAAAAAAAAAAAAAAgD8I",
]


def compressed(stream: str) -> bytes:
    """A glTF file whose mesh is a Draco stream."""
    size, name = len(base64.b64decode(stream)), "KHR_draco_mesh_compression"
    settings = {"bufferView": 0, "attributes": {"POSITION": 0}}
    tree = {
        "asset": {"version": "2.0"},
        "extensionsRequired": [name],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "extensions": {name: settings}}]}],
        "accessors": [{"count": 4, "componentType": 5126, "type": "VEC3"}, {"count": 6, "componentType": 5125, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": size}],
        "buffers": [{"uri": f"data:;base64,{stream}", "byteLength": size}],
    }
    return json.dumps(tree, separators=(",", ":")).encode()


def posed() -> bytes:
    """A glTF file with a skin, a morph target and vertex colours."""
    numbers = np.float32([0, 0, 0, 1, 0, 0, 0, 1, 0, *np.eye(4).ravel(), *[0, 0, 0, 0] * 3, *[1, 0, 0, 0] * 3, *np.linspace(0, 1, 12)])
    uri = "data:;base64," + base64.b64encode(numbers.tobytes()).decode()
    places = (("VEC3", 3, 0), ("MAT4", 1, 36), ("VEC4", 3, 100), ("VEC4", 3, 148), ("VEC4", 3, 196))
    attributes = {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3, "COLOR_0": 4}
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0, "skin": 0, "weights": [0.5]}, {"translation": [0, 0, 1]}],
        "skins": [{"joints": [1], "inverseBindMatrices": 1}],
        "meshes": [{"primitives": [{"attributes": attributes, "targets": [{"POSITION": 0}]}], "weights": [1]}],
        "accessors": [{"bufferView": 0, "byteOffset": at, "count": n, "componentType": 5126, "type": kind} for kind, n, at in places],
        "bufferViews": [{"buffer": 0, "byteLength": numbers.nbytes}],
        "buffers": [{"uri": uri, "byteLength": numbers.nbytes}],
    }
    return json.dumps(tree, separators=(",", ":")).encode()


def words(tree) -> set[str]:
    """All keys of a JSON tree, at any depth."""
    below = tree.values() if isinstance(tree, dict) else tree if isinstance(tree, list) else ()
    return set(tree if isinstance(tree, dict) else ()).union(*map(words, below))


# ------------------------------------------------------------------------------------------------- luminaires, networks

SHAPE = "1 1000 1 3 2 1 2 0.5 0.5 0\n1 1 50\n0 45 90\n0 180\n100 80 0\n100 90 10\n"
IES = [
    f"IESNA:LM-63-2002\n[LUMINAIRE] Lamp\n[MORE] of two\nTILT=NONE\n{SHAPE}",
    f"IESNA:LM-63-1995\nTILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8\n{SHAPE}",
    "IESNA91\nTILT=NONE\n1 -1 0.5 2 1 1 1 0 0 0 1 1 50 0 90 0 7 7",
]


def networks() -> list[bytes]:
    """ONNX files: one for each operator, and one network like those that frameworks export."""

    def of(kind: str, *more, opset: int = 13, outputs: int = 1, **attributes) -> bytes:
        n = onnx_file.Network([1, 3, 8, 8], opset)
        made = n.add(kind, "input", *(n.constant(values) if values is not None else "" for values in more), outputs=outputs, **attributes)
        return n.file(made if outputs == 1 else made[0], rank=4)

    real = np.float32
    singles = "Relu LeakyRelu Elu HardSigmoid Sigmoid Tanh Erf Sqrt Exp Log Neg Abs Reciprocal Floor Ceil Identity Softplus Gelu".split()
    doubles = "Add Sub Mul Div Pow Max Min Equal Less Greater PRelu".split()
    kernel = np.ones((3, 3, 3, 3), real)
    out = [of(kind) for kind in [*singles, "GlobalAveragePool", "Softmax", "Shape", "Transpose", "Flatten"]]
    out += [of(kind, real([[[[0.5]]]])) for kind in doubles]
    out += [of("Conv", kernel, real([1, 2, 3]), pads=[1, 1, 1, 1], strides=[2, 2]), of("Conv", kernel[:, :1], group=3, dilations=[2, 2])]
    out += [of("ConvTranspose", kernel, strides=[2, 2], output_padding=[1, 1]), of("MatMul", np.ones((8, 2), real))]
    out += [of(kind, kernel_shape=[3, 3], strides=[2, 2], pads=[1, 1, 0, 0]) for kind in ("MaxPool", "AveragePool")]
    out += [of("BatchNormalization", *[np.ones(3, real)] * 4), of("InstanceNormalization", *[np.ones(3, real)] * 2)]
    out += [of("LayerNormalization", np.ones(8, real), opset=17), of("ReduceMean", axes=[1], keepdims=0), of("Clip", real(0), real(1))]
    for mode in ("nearest", "linear", "cubic"):
        out += [of("Resize", None, real([1, 1, 2, 2]), mode=mode), of("Resize", None, None, [1, 3, 5, 5], mode=mode)]
    out += [of("Upsample", real([1, 1, 2, 2]), opset=9), of("Pad", [0, 0, 1, 1, 0, 0, 1, 1], mode="reflect"), of("Cast", to=7)]
    out += [of("Reshape", [0, -1, 4]), of("Squeeze", [0]), of("Unsqueeze", [0]), of("Concat", np.ones((1, 1, 8, 8), real), axis=1)]
    out += [of("Split", axis=1, outputs=3), of("Slice", [0], [-1], [2], [2]), of("Gather", [0, 2], axis=1), of("Expand", [2, 3, 8, 8])]
    out += [of("Tile", [1, 1, 2, 2]), of("Transpose", perm=[0, 2, 3, 1]), of("ReduceMax", axes=[2, 3])]
    n = onnx_file.Network([1, 3, "h", "w"], 11)
    x = n.add("Relu", n.add("Conv", "input", n.noise(4, 3, 3, 3), n.noise(4), strides=[2, 2], pads=[1, 1, 1, 1]))
    x = n.add("Add", x, n.add("Mul", x, n.add("Sigmoid", n.add("GlobalAveragePool", x))))
    x = n.add("Resize", x, n.constant(np.zeros(0, real)), n.constant(real([1, 1, 2, 2])), mode="linear")
    return [*out, n.file(n.add("Squeeze", n.add("Conv", x, n.noise(1, 4, 1, 1)), axes=[1]))]


# ---------------------------------------------------------------------------------------------------------------- texts

#: Words of glTF that the seed files do not contain, for the dictionary.
MORE = {"sparse", "matrix", "children", "KHR_materials_unlit", "EXT_lights_ies", "byteStride", "normalized", "extras", "minVersion", "COLOR_0"}
MORE |= {"EXT_mesh_gpu_instancing", "TRANSLATION", "ROTATION", "SCALE", "EXT_texture_webp", "KHR_materials_clearcoat", "weights", "skin"}
MORE |= {"EXT_meshopt_compression", "fallback", "mode", "filter", "ATTRIBUTES", "TRIANGLES", "INDICES", "OCTAHEDRAL", "EXPONENTIAL"}
#: 1, infinity and NaN as floats of 32 and 64 bits, for the dictionaries of binary formats.
NUMBERS = [rf"\x00\x00{end}" for end in (r"\x80\x3f", r"\x80\x7f", r"\xc0\x7f", r"\xf0\x3f", r"\xf0\x7f", r"\xf8\x7f")]

PNG_WORDS = ["IHDR", "PLTE", "tRNS", "IDAT", "IEND", "gAMA", "iCCP", "fdAT", "eXIf"]
JPEG_WORDS = ["\\xff\\xc4", "\\xff\\xdb", "\\xff\\xdd", "\\xff\\xe1", "Exif"]
RIFF_WORDS = ["VP8 ", "VP8L", "VP8X", "ALPH", "ANIM", "ANMF", "EXIF"]
IMAGE_WORDS = [*PNG_WORDS, *JPEG_WORDS, *RIFF_WORDS, "II*", "MM", "BM", "GIF89a", "NETSCAPE2.0"]

EXPRESSIONS = ["L.*E", "LDE", "L<.D>E", "C<RS>[DG]*L", "L(D|S){1,2}E", "L[^S]+E", "C.*<L.>", "L<RD'Floor'>?E", "(L|O).*E"]
STROKES = ["plane 2 5 5 9 9\nnot-plane 1.5 40 2 42 20\n", "light 2 5 5\n# a remark\nnot-light 3 1e1 -3 7 7 250 9\n"]


def parts(context: luxfer.Context) -> list[bytes]:
    """Files of rendering parts, for the rendering that the target `part` merges."""
    render, size = luxfer.Render(context, luxfer.Scene.demo(context, "sphere-on-table")), {"width": 9, "height": 5, "samples": 4}
    with tempfile.TemporaryDirectory() as folder:
        paths = [str(Path(folder, name)) for name in "abc"]
        for path, part in zip(paths, [render.split(1, 1, 1, 0, **size), *(render.split(1, 1, 2, k, **size) for k in range(2))]):
            render.start_part(path, part, **size).wait()
        return [Path(path).read_bytes() for path in paths]


def seeds() -> dict[str, tuple[list[bytes], list[str]]]:
    """For each target, its seed files and the words of its dictionary."""
    context = luxfer.Context(num_threads=1)
    glb = scene(context)
    tree = json.loads(glb[20 : 20 + struct.unpack_from("<I", glb, 12)[0]])
    lamp = luxfer.Distribution.load_memory(context, IES[0].encode(), "ies")
    nets = networks()
    programs = [calls.Program().encode(program) for program in scenarios.programs().values()]
    return {
        "image": (rasters() + photos(), IMAGE_WORDS),
        "exr": (layered(context), ["channels", "compression", "dataWindow", "tiles", "chunkCount", "box2i", "scanlineimage", "tiledesc"]),
        "gltf": ([glb, as_text(glb), posed(), *map(compressed, DRACO)], [f'\\"{word}\\"' for word in sorted(words(tree) | MORE)]),
        "ies": ([text.encode() for text in IES], ["TILT=NONE", "TILT=INCLUDE", "IESNA:LM-63-1986", "[LUMCAT]"]),
        "ldt": ([saved(lamp, "ldt")], [" 90", "-1", "1e30"]),
        "tm33": ([saved(lamp, "xml")], ["IESTM33", "<Emitter>", "Symm_Bi_90", "BottomArea", "Circular", "<!DOCTYPE", "&#38;"]),
        "gldf": ([saved(lamp, "gldf")], ["PK\\x03\\x04", "product.xml", "ldc/", "Variant"]),
        "onnx": (nets, ["align_corners", "pytorch_half_pixel", "asymmetric", "auto_pad", "SAME_UPPER", "ceil_mode", "CRD"]),
        "lpe": ([text.encode() for text in EXPRESSIONS], [s.replace("\u00e9", "\\xc3\\xa9") for s in files.SYMBOLS[0]]),
        "strokes": ([text.encode() for text in STROKES], ["plane", "not-plane", "light", "not-light", "nan", "1e308"]),
        "part": (parts(context), ["luxfer.part.", "first_path", "paths", "discarded", "displayWindow"]),
        "calls": (programs, NUMBERS),
    }


def main() -> None:
    for target, (contents, dictionary) in seeds().items():
        folder = Path(sys.argv[1], target)
        folder.mkdir(parents=True, exist_ok=True)
        for index, content in enumerate(contents):
            (folder / f"seed-{index:03}").write_bytes(content)
        folder.with_suffix(".dict").write_text("".join(f'"{word}"\n' for word in dictionary if word))
        print(f"{target:8} {len(contents):3} seeds, {max(map(len, contents))} bytes at most")


if __name__ == "__main__":
    main()
