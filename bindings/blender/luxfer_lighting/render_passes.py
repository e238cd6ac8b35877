"""A program for a Blender of its own: renders a .blend by Cycles, and stores its passes as the guides of a stylisation.

    blender --background --python render_passes.py -- SETTINGS     (or a Python that has bpy: render_passes.py -- SETTINGS)

SETTINGS is JSON: "blend", "scene", "layer" (of views), "samples", "out" (an .npz file). Lines "progress SHARE" tell how far it
is. What the passes are as light path expressions, in the notation of luxfer's guides:

    full        L.*E       Combined
    direct      LDE        diffuse direct
    specular    LSE        glossy direct
    indirect    L.*DDE     diffuse indirect: L.+DE. Cycles does not tell matt after matt from caustics, glossy after matt.
    two bounces LD{1,2}E   diffuse direct and indirect of a second rendering that ends after two bounces and has no caustics

Translucent surfaces and subsurface scattering are matt in Cycles, and its lamps without shape are seen in glossy things.
The light is smoothed along surfaces as luxfer smooths its own (src/guides/smooth.rs).
"""

from __future__ import annotations

import json
import re
import struct
import sys
import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np

#: In the order in which luxfer has them: its name, and that of the image in luxfer.Guides.
GUIDES = {"full": "full", "direct": "direct", "specular": "specular", "indirect": "indirect", "two bounces": "two-bounces"}
PASSES = ("combined", "diffuse_direct", "diffuse_indirect", "diffuse_color", "glossy_direct", "glossy_color", "normal", "material_index")
#: Blender's own names of passes before 5.0.
LONG = {
    "DiffDir": "Diffuse Direct",
    "DiffInd": "Diffuse Indirect",
    "DiffCol": "Diffuse Color",
    "GlossDir": "Glossy Direct",
    "GlossCol": "Glossy Color",
    "IndexMA": "Material Index",
}
#: Of Cycles' work, what the second rendering takes.
SECOND = 0.3


def read_exr(path: Path) -> dict[str, np.ndarray]:
    """The layers of an OpenEXR file as Blender writes it uncompressed, of floats, in one part: name of the pass -> (height,
    width, channels), channels in the order RGBA or XYZ."""
    data = path.read_bytes()
    at = 8  # behind magic number and version
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
        channels = rest[16:]  # kind of number, sampling
    line = 8 + 4 * width * len(names)  # each begins with its number and its size
    rows = np.frombuffer(data, np.uint8, line * height, at + 1 + 8 * height).reshape(height, line)
    values = rows[:, 8:].copy().view(np.float32).reshape(height, len(names), width)
    layers: dict[str, dict[str, np.ndarray]] = {}
    for i, full in enumerate(names):
        _, layer, channel = full.rsplit(".", 2)
        layers.setdefault(layer, {})[channel] = values[:, i]
    return {LONG.get(name, name): np.stack([c[k] for k in "RGBXYZVA" if k in c], -1) for name, c in layers.items()}


def smooth(light: np.ndarray, normals: np.ndarray, material: np.ndarray) -> np.ndarray:
    """The light averaged over neighbours of the same material, of like normal and of like brightness: three passes of
    edge-avoiding à-trous wavelets (Dammertz et al. 2010)."""
    luma = np.float32((0.2126, 0.7152, 0.0722))
    floor = 0.02 * float((light @ luma).mean())
    kernel = np.float32((1 / 16, 1 / 4, 3 / 8, 1 / 4, 1 / 16))
    height, width = material.shape
    nothing = (normals == 0).all(-1)

    def average(values: np.ndarray, brightness: np.ndarray | None, step: int) -> np.ndarray:
        total, sums = np.zeros((height, width), np.float32), np.zeros_like(values)
        for i, j in np.ndindex(5, 5):
            dy, dx = (i - 2) * step, (j - 2) * step
            if abs(dy) >= height or abs(dx) >= width:
                continue
            here = slice(max(0, -dy), height - max(0, dy)), slice(max(0, -dx), width - max(0, dx))
            there = slice(max(0, dy), height + min(0, dy)), slice(max(0, dx), width + min(0, dx))
            facing = np.einsum("ijk,ijk->ij", normals[here], normals[there]).clip(0) ** 16
            facing[nothing[here]] = 1
            weight = kernel[i] * kernel[j] * facing * (material[here] == material[there])
            if brightness is not None:
                a, b = brightness[here], brightness[there]
                apart = (a - b) / np.maximum(0.25 * (0.5 * (a + b) + floor), np.finfo(np.float32).tiny)
                weight *= np.exp(-apart * apart)
            total[here] += weight
            sums[here] += weight[..., None] * values[there]
        return np.where(total[..., None] > 0, sums / np.maximum(total, 1e-30)[..., None], values)

    for step in (1, 2, 4):
        light = average(light, average(light, None, 1) @ luma, step)
    return light


def told(first: float, share: float) -> Any:
    """A handler that tells the progress of one rendering, from `first` on."""

    def stats(text: Any, *_: Any) -> None:
        found = re.search(r"(?:Rendered|Sample) (\d+)/(\d+)", str(text))
        if found and int(found[2]):
            print(f"progress {first + share * int(found[1]) / int(found[2]):.4f}", flush=True)

    return stats


def set_up(scene: bpy.types.Scene, layer: str, samples: int) -> None:
    """One layer of views with the passes, no compositing, no denoising, one view of the whole picture."""
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
    settings = scene.render.image_settings
    for name, value in (
        ("media_type", "MULTI_LAYER_IMAGE"),  # from Blender 5.0 on, as is the next but two
        ("file_format", "OPEN_EXR_MULTILAYER"),
        ("exr_codec", "NONE"),
        ("color_depth", "32"),
        ("use_exr_interleave", True),
    ):
        if hasattr(settings, name):
            setattr(settings, name, value)


def render(scene: bpy.types.Scene, first: float, share: float) -> dict[str, np.ndarray]:
    handler = told(first, share)
    bpy.app.handlers.render_stats.append(handler)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "passes.exr")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        bpy.app.handlers.render_stats.remove(handler)
        return read_exr(Path(scene.render.filepath))


def guides(scene: bpy.types.Scene, layer: str, samples: int) -> dict[str, np.ndarray]:
    """The guides, in Blender's units of radiance, (height, width, 3)."""
    set_up(scene, layer, samples)
    found = render(scene, 0.0, 0.9 * (1 - SECOND))
    normals, material = found["Normal"], found["Material Index"][..., 0]
    light = {
        "full": found["Combined"][..., :3],
        "direct": found["Diffuse Direct"] * found["Diffuse Color"],
        "specular": found["Glossy Direct"] * found["Glossy Color"],
        "indirect": found["Diffuse Indirect"] * found["Diffuse Color"],
    }
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 1
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    found = render(scene, 0.9 * (1 - SECOND), 0.9 * SECOND)
    light["two bounces"] = (found["Diffuse Direct"] + found["Diffuse Indirect"]) * found["Diffuse Color"]
    return {name: smooth(values.astype(np.float32), normals, material) for name, values in light.items()}


def main() -> None:
    settings = json.loads(sys.argv[sys.argv.index("--") + 1])
    import addon_utils  # known once there is bpy

    addon_utils.enable("cycles")  # the user may have put it away
    bpy.ops.wm.open_mainfile(filepath=settings["blend"], load_ui=False)
    np.savez(settings["out"], **guides(bpy.data.scenes[settings["scene"]], settings["layer"], settings["samples"]))
    print("progress 1", flush=True)


if __name__ == "__main__":
    main()
