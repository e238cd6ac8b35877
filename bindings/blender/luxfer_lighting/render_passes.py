"""A program for a second Blender: renders a .blend by Cycles, and stores its passes as the guides of a stylisation.

    blender --background --python render_passes.py -- SETTINGS
    python render_passes.py -- SETTINGS                             with a Python that has bpy

SETTINGS is JSON: "blend", "scene", "layer" (a view layer), "samples", "parts" (a number for each name of an object; the
file has the image "parts" of these numbers, 0 elsewhere), "groups" (lists of names of objects; the file has in "covers"
an image for each group, the share of each pixel that it covers), "out" (an .npz file). Before each rendering, the
program prints a line "part FIRST LAST": the range of the whole work's progress that the rendering covers. Cycles
prints its own progress. The passes as light path expressions, in the notation of luxfer's guides:

    full        L.*E       Combined
    direct      LDE        diffuse direct
    specular    LSE        glossy direct
    indirect    L.*DDE     diffuse indirect: L.+DE. It includes caustics.
    two bounces LD{1,2}E   diffuse direct and indirect of a second rendering, of two bounces and without caustics

Translucent surfaces and subsurface scattering are diffuse in Cycles, and its punctual lamps are visible in glossy
reflections. The light is smoothed along surfaces as luxfer smooths its guides (src/guides/smooth.rs).
"""

from __future__ import annotations

import json
import os
import struct
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import bpy
import numpy as np

#: The guides in luxfer's order: the name of each guide, and of its image in luxfer.Guides.
GUIDES = {"full": "full", "direct": "direct", "specular": "specular", "indirect": "indirect", "two bounces": "two-bounces"}
LIGHT_PASSES = ("combined", "diffuse_direct", "diffuse_indirect", "diffuse_color", "glossy_direct", "glossy_color")
PASSES = (*LIGHT_PASSES, "normal", "material_index", "object_index", "cryptomatte_object")
#: The layers of Cryptomatte, each with two numbers of objects and their shares of the pixel.
CRYPTOMATTE = "CryptoObject"
#: The names of passes before Blender 5.0.
LONG = {
    "DiffDir": "Diffuse Direct",
    "DiffInd": "Diffuse Indirect",
    "DiffCol": "Diffuse Color",
    "GlossDir": "Glossy Direct",
    "GlossCol": "Glossy Color",
    "IndexMA": "Material Index",
    "IndexOB": "Object Index",
}


def read_exr(path: Path) -> dict[str, np.ndarray]:
    """Reads the layers of an uncompressed OpenEXR file of floats in one part, as Blender writes it. Returns an array
    (channels, height, width) by the name of each pass; the channels are in the order RGBA or XYZ. Adds the number of
    each object of Cryptomatte as "number of NAME"."""
    data = path.read_bytes()
    at = 8  # after magic number and version
    attributes: dict[str, bytes] = {}
    while data[at]:
        name, kind, _ = data[at : at + 512].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    names, channels = [], attributes["channels"]
    while channels[0]:
        name, rest = channels.split(b"\0", 1)
        names.append(name.decode())
        channels = rest[16:]  # skip type and sampling
    line = 8 + 4 * width * len(names)  # each line begins with its number and its size
    rows = np.frombuffer(data, np.uint8, line * height, at + 1 + 8 * height).reshape(height, line)
    values = rows[:, 8:].copy().view(np.float32).reshape(height, len(names), width)
    layers: dict[str, dict[str, np.ndarray]] = {}
    for i, full in enumerate(names):
        _, layer, channel = full.rsplit(".", 2)
        layers.setdefault(layer, {})[channel.upper()] = values[:, i]
    out = {LONG.get(name, name): np.stack([c[k] for k in "RGBXYZVA" if k in c]) for name, c in layers.items()}
    return {**out, **{f"number of {name}": number for name, number in numbers_of(attributes).items()}}


def numbers_of(attributes: dict[str, bytes]) -> dict[str, np.ndarray]:
    """The number that Cryptomatte gives to each object, from the attributes of its file."""
    for name, text in attributes.items():
        if name.startswith("cryptomatte/") and name.endswith("/manifest"):
            numbers = json.loads(text)
            return {key: np.uint32(int(code, 16)).reshape(1).view(np.float32)[0] for key, code in numbers.items()}
    return {}


def cover(passes: dict[str, np.ndarray], names: list[str]) -> np.ndarray:
    """The share of each pixel that the named objects cover."""
    numbers = {float(passes[f"number of {name}"]) for name in names if f"number of {name}" in passes}
    out = np.zeros(passes["Combined"].shape[1:], np.float32)
    for layer, values in passes.items():
        if layer.startswith(CRYPTOMATTE):
            for number, share in ((values[0], values[1]), (values[2], values[3])):
                out += np.where(np.isin(number, list(numbers)), share, 0)
    return np.minimum(out, 1)


def smooth(lights: list[np.ndarray], normals: np.ndarray, material: np.ndarray) -> list[np.ndarray]:
    """Averages the lights over neighbours with equal material, similar normal and similar brightness: three passes of
    edge-avoiding à-trous wavelets (Dammertz et al. 2010). All but the material are (3, height, width)."""
    floors = [0.02 * float(brightness(light).mean()) for light in lights]
    for step in (1, 2, 4):
        means = [brightness(mean) for mean in averages(lights, None, floors, normals, material, 1)]
        lights = averages(lights, means, floors, normals, material, step)
    return lights


def brightness(light: np.ndarray) -> np.ndarray:
    return np.float32(0.2126) * light[0] + np.float32(0.7152) * light[1] + np.float32(0.0722) * light[2]


KERNEL = (1 / 16, 1 / 4, 3 / 8, 1 / 4, 1 / 16)
#: Number of rows that are processed at a time, so that they fit into the processor's caches.
BAND = 16


def averages(
    lights: list[np.ndarray],
    guides: list[np.ndarray] | None,
    floors: list[float],
    normals: np.ndarray,
    material: np.ndarray,
    step: int,
) -> list[np.ndarray]:
    """Computes weighted means over 5 x 5 pixels `step` apart; with guides, pixels of similar brightness weigh more."""
    height, width = material.shape
    tiny = np.finfo(np.float32).tiny
    nothing = (normals == 0).all(0)
    out = [np.empty_like(light) for light in lights]

    def band(top: int) -> None:
        bottom = min(top + BAND, height)
        totals = [np.zeros((bottom - top, width), np.float32) for _ in lights]
        sums = [np.zeros((3, bottom - top, width), np.float32) for _ in lights]
        for i, j in np.ndindex(5, 5):
            dy, dx = (i - 2) * step, (j - 2) * step
            first, last = max(top, -dy), min(bottom, height - dy)
            if first >= last or abs(dx) >= width:
                continue
            left, right = max(0, -dx), width - max(0, dx)
            here = ..., slice(first, last), slice(left, right)
            there = ..., slice(first + dy, last + dy), slice(left + dx, right + dx)
            inside = ..., slice(first - top, last - top), slice(left, right)
            facing = (normals[here] * normals[there]).sum(0)
            np.maximum(facing, 0, out=facing)
            for _ in range(4):
                facing *= facing
            facing[nothing[here]] = 1
            facing *= material[here] == material[there]
            facing *= np.float32(KERNEL[i] * KERNEL[j])
            for k, light in enumerate(lights):
                weight = facing
                if guides is not None:
                    a, b = guides[k][here], guides[k][there]
                    apart = (a - b) / np.maximum(np.float32(0.125) * (a + b) + np.float32(0.25 * floors[k]), tiny)
                    weight = facing * np.exp(-apart * apart)
                totals[k][inside] += weight
                sums[k][inside] += weight * light[there]
        for k, light in enumerate(lights):
            out[k][:, top:bottom] = np.where(totals[k] > 0, sums[k] / np.maximum(totals[k], tiny), light[:, top:bottom])

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(band, range(0, height, BAND)))
    return out


def print_progress(text: Any, *_: Any) -> None:
    """Handler that prints the progress of Cycles, for versions of Blender that do not print it."""
    if isinstance(text, str):
        print(text, flush=True)


def set_up(scene: bpy.types.Scene, layer: str, samples: int, parts: dict[str, int]) -> None:
    """Sets up a scene: one view layer with the passes, no compositing, no denoising, the whole picture."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    for name in ("compositing", "sequencer", "border", "multiview", "motion_blur", "file_extension"):
        setattr(scene.render, f"use_{name}", False)
    for view in scene.view_layers:
        view.use = view.name == layer
    for name in PASSES:
        setattr(scene.view_layers[layer], f"use_pass_{name}", True)
    for number, material in enumerate(bpy.data.materials):
        material.pass_index = number + 1
    for thing in scene.objects:
        thing.pass_index = parts.get(thing.name, 0)
    settings = scene.render.image_settings
    for name, value in (
        ("media_type", "MULTI_LAYER_IMAGE"),  # exists from Blender 5.0 on
        ("file_format", "OPEN_EXR_MULTILAYER"),
        ("exr_codec", "NONE"),
        ("color_depth", "32"),
        ("use_exr_interleave", True),
    ):
        if hasattr(settings, name):
            setattr(settings, name, value)


def render(scene: bpy.types.Scene, first: float, last: float) -> dict[str, np.ndarray]:
    """Renders and reads the passes; this covers the range from `first` to `last` of the whole progress."""
    print(f"part {first} {last}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "passes.exr")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        return read_exr(Path(scene.render.filepath))


def guides(
    scene: bpy.types.Scene, layer: str, samples: int, parts: dict[str, int], groups: list[list[str]]
) -> dict[str, np.ndarray]:
    """Renders the guides: arrays (height, width, 3) in Blender's units of radiance; and the images "parts" and
    "covers"."""
    set_up(scene, layer, samples, parts)
    bpy.app.handlers.render_stats.append(print_progress)
    found = render(scene, 0.0, 0.6)
    light = {
        "full": found["Combined"][:3],
        "direct": found["Diffuse Direct"] * found["Diffuse Color"],
        "specular": found["Glossy Direct"] * found["Glossy Color"],
        "indirect": found["Diffuse Indirect"] * found["Diffuse Color"],
    }
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 1
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    short = render(scene, 0.6, 0.9)
    light["two bounces"] = (short["Diffuse Direct"] + short["Diffuse Indirect"]) * short["Diffuse Color"]
    smoothed = smooth(list(light.values()), found["Normal"], found["Material Index"][0])
    out = {name: np.moveaxis(values, 0, 2) for name, values in zip(light, smoothed)}
    covers = np.array([cover(found, names) for names in groups])
    return {**out, "parts": found["Object Index"][0], "covers": covers}


def main() -> None:
    settings = json.loads(sys.argv[sys.argv.index("--") + 1])
    import addon_utils  # can be imported only after bpy

    addon_utils.enable("cycles")  # the user may have disabled it
    bpy.ops.wm.open_mainfile(filepath=settings["blend"], load_ui=False)
    scene = bpy.data.scenes[settings["scene"]]
    found = guides(scene, settings["layer"], settings["samples"], settings["parts"], settings["groups"])
    np.savez(settings["out"], **found)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # the module bpy 4.2.0 crashes while Python ends in the usual way
