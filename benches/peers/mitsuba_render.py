"""Renders a GLB with Mitsuba 3: mitsuba_render.py VARIANT SCENE.glb WIDTH HEIGHT OUT

Prints a line of JSON when ready. Then each line "SPP SEED" of standard input makes an image, written to OUT (rows of
linear RGB, 32-bit floats), and is answered by a line of JSON: spp, seed, seconds. The first render of each number of
samples is preceded by one that compiles its kernels and is not counted.
"""

import json
import os
import sys
import time

for name in ("libLLVM.so.19.1", "libLLVM-19.so"):
    if os.path.exists("/usr/lib/x86_64-linux-gnu/" + name):
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", "/usr/lib/x86_64-linux-gnu/" + name)
import mitsuba as mi
import numpy as np

variant, scene_path, width, height, out = sys.argv[1:6]
width, height = int(width), int(height)
mi.set_variant(variant)
import drjit as dr

from glb import Glb

# Paths traced at once: bounds the memory of the vectorised back ends.
WAVEFRONT = 1 << 22


def bitmap(glb, reference):
    """The image of a texture in linear light."""
    path = f"{out}.texture.png"
    with open(path, "wb") as file:
        file.write(glb.image(reference["index"]).read())
    return mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)


def bsdf(glb, material):
    pbr = material.get("pbrMetallicRoughness", {})
    color = pbr.get("baseColorFactor", [1, 1, 1, 1])
    base = {"type": "rgb", "value": color[:3]}
    if "baseColorTexture" in pbr:
        texels = np.array(bitmap(glb, pbr["baseColorTexture"])) * np.float32(color[:3])
        base = {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": True}
    metallic, roughness = pbr.get("metallicFactor", 1.0), pbr.get("roughnessFactor", 1.0)
    no_interface = material.get("extensions", {}).get("KHR_materials_ior", {}).get("ior", 1.5) == 1.0
    if no_interface and metallic == 0.0:
        inner = {"type": "diffuse", "reflectance": base}
    else:
        inner = {"type": "principled", "base_color": base, "metallic": metallic, "roughness": max(roughness, 1e-3)}
    return {"type": "twosided", "bsdf": inner}


def emitter(glb, material):
    """Emission of a material, or None."""
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
    radiance = [strength * e for e in material.get("emissiveFactor", [0, 0, 0])]
    if max(radiance) == 0:
        return None
    if "emissiveTexture" in material:
        texels = np.array(bitmap(glb, material["emissiveTexture"])) * np.float32(radiance)
        value = {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": True, "filter_type": "nearest"}
    else:
        value = {"type": "rgb", "value": radiance}
    return mi.load_dict({"type": "area", "radiance": value})


def build():
    glb = Glb(scene_path)
    position, forward, up, fov = glb.camera()
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1},
        "sensor": {
            "type": "perspective",
            "fov": np.degrees(fov),
            "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(position, position + forward, up),
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"},
        },
    }
    for i, (index, positions, normals, uvs, triangles) in enumerate(glb.primitives()):
        material = glb.json["materials"][index]
        properties = mi.Properties()
        properties["mesh_bsdf"] = mi.load_dict(bsdf(glb, material))
        light = emitter(glb, material)
        # Mitsuba's meshes have one set: that of the emission, where there is any.
        uvs = uvs[material.get("emissiveTexture", {}).get("texCoord", 0)]
        if light is not None:
            properties["mesh_emitter"] = light
        mesh = mi.Mesh(
            f"mesh{i}", len(positions), len(triangles), properties, normals is not None, uvs is not None
        )
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = np.ravel(positions)
        parameters["faces"] = np.ravel(triangles)
        if normals is not None:
            parameters["vertex_normals"] = np.ravel(normals)
        if uvs is not None:
            parameters["vertex_texcoords"] = np.ravel(uvs)
        parameters.update()
        scene[f"mesh{i}"] = mesh
    return mi.load_dict(scene)


def render(scene, spp, seed):
    total = np.zeros((height, width, 3))
    done = 0
    while done < spp:
        part = min(spp - done, max(1, WAVEFRONT // (width * height)))
        total += np.array(mi.render(scene, spp=part, seed=(seed * 1_000_003 + done) % 2**31), dtype=np.float64)[:, :, :3] * part
        done += part
    return total / spp


scene = build()
dr.set_thread_count(2)
print(json.dumps({"ready": mi.__version__}), flush=True)
compiled = set()
for job in sys.stdin:
    spp, seed = map(int, job.split())
    part = min(spp, max(1, WAVEFRONT // (width * height)))
    if part not in compiled:
        render(scene, part, 10**6)
        compiled.add(part)
    start = time.perf_counter()
    image = render(scene, spp, seed)
    seconds = time.perf_counter() - start
    image.astype(np.float32).tofile(out)
    print(json.dumps({"spp": spp, "seed": seed, "seconds": seconds}), flush=True)
