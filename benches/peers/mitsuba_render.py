"""Renders a GLB with Mitsuba 3: mitsuba_render.py VARIANT SCENE.glb WIDTH HEIGHT OUT

Prints a line of JSON when it is ready. For each line "SPP SEED" of standard input it then renders an image, writes it
to OUT (rows of linear RGB, 32-bit floats) and prints a line of JSON: spp, seed, seconds. Before the first render with a
number of samples, it renders once without timing, to compile the kernels.
"""

import functools
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

# Maximum number of paths traced at once; it limits the memory of the vectorised back ends.
WAVEFRONT = 1 << 22


def bitmap(glb, reference):
    """Returns the image of a texture with linear values."""
    path = f"{out}.texture.png"
    with open(path, "wb") as file:
        file.write(glb.image(reference["index"]).read())
    return mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)


def coat_albedo(ior, alpha):
    """Returns the hemispherical albedo of a rough interface: GGX with Smith masking and Schlick's Fresnel term."""
    f0 = ((ior - 1) / (ior + 1)) ** 2
    random = np.random.default_rng(1)
    u, v, a, b = random.random((4, 1 << 16))
    wo = np.stack([np.sqrt(u), 0 * u, np.sqrt(1 - u)])
    # Sample microfacet normals in proportion to their projected area, and reflect the direction about them.
    z = np.sqrt((1 - a) / (1 + (alpha * alpha - 1) * a))
    r, angle = np.sqrt(1 - z * z), 2 * np.pi * b
    h = np.stack([r * np.cos(angle), r * np.sin(angle), z])
    cosine = (wo * h).sum(0)
    wi = 2 * cosine * h - wo
    masking = lambda w: (np.sqrt(1 + alpha * alpha * (1 / w[2] ** 2 - 1)) - 1) / 2
    valid = (cosine > 0) & (wi[2] > 0)
    fresnel = f0 + (1 - f0) * (1 - np.clip(cosine, 0, 1)) ** 5
    weight = fresnel * cosine / (wo[2] * h[2] * (1 + masking(wo) + masking(np.abs(wi))))
    return float(np.where(valid, weight, 0).mean())


def scaled(base, gain, offset=0):
    """Returns gain * base + offset for a colour or an image. The result is an image, because Mitsuba refuses colours
    above 1."""
    texels = np.array(base["bitmap"] if base["type"] == "bitmap" else [[base["value"]]], np.float32)
    return {"type": "bitmap", "bitmap": mi.Bitmap(texels * np.float32(gain) + np.float32(offset)), "raw": True}


def coated(ior, alpha, base):
    return {
        "type": "roughplastic", "distribution": "ggx", "alpha": alpha, "int_ior": ior, "nonlinear": False,
        "diffuse_reflectance": base,
    }


@functools.cache
def coated_albedo(ior, alpha):
    """Returns the hemispherical albedo of a white diffuse surface under Mitsuba's coat, without the coat's
    reflection."""
    random = np.random.default_rng(1).random((5, 1 << 16))
    context = mi.BSDFContext()
    albedos = []
    for white in (1.0, 0.0):
        white = mi.load_dict(coated(ior, alpha, {"type": "rgb", "value": white}))
        si = dr.zeros(mi.SurfaceInteraction3f, random.shape[1])
        u = [mi.Float(r) for r in random.astype(np.float32)]
        si.wi = mi.Vector3f(dr.sqrt(u[0]), 0, dr.sqrt(1 - u[0]))
        weights = white.sample(context, si, u[1], mi.Point2f(u[2], u[3]))[1]
        albedos.append(float(np.mean(np.nan_to_num(np.array(weights)))))
    return albedos[0] - albedos[1]


def is_solid(material):
    """Whether a material bounds solid glass, which refracts."""
    extensions = material.get("extensions", {})
    thickness = extensions.get("KHR_materials_volume", {}).get("thicknessFactor", 0)
    return thickness > 0 and extensions.get("KHR_materials_transmission", {}).get("transmissionFactor", 0) > 0


def solid(material, base, ior, alpha):
    """Builds the boundary of clear, solid glass. Both renderers have the microfacets of Walter et al. (2007); they
    differ in the shadowing of the light that microfacets reflect."""
    if material["extensions"]["KHR_materials_transmission"]["transmissionFactor"] != 1:
        raise ValueError("solid glass that is partly opaque has no counterpart here")
    common = {"int_ior": ior, "ext_ior": 1.0, "specular_transmittance": base}
    if alpha <= 1e-4:
        return {"type": "dielectric", **common}
    return {"type": "roughdielectric", "distribution": "ggx", "alpha": alpha, **common}


def interior(material):
    """Returns the absorbing medium inside solid glass, or None."""
    volume = material.get("extensions", {}).get("KHR_materials_volume", {})
    if not is_solid(material) or "attenuationDistance" not in volume:
        return None
    absorption = -np.log(volume.get("attenuationColor", [1, 1, 1])) / volume["attenuationDistance"]
    # Mitsuba refuses colours above 1.
    scale = max(float(absorption.max()), 1e-30)
    color = {"type": "rgb", "value": (absorption / scale).tolist()}
    return mi.load_dict({"type": "homogeneous", "albedo": 0.0, "sigma_t": color, "scale": scale})


def bsdf(glb, material):
    """Builds a metallic-roughness material from Mitsuba's BSDFs.

    Mitsuba's `principled` is another model: its diffuse part is retro-reflective and does not lose the light that the
    coat reflects. glTF's dielectric is `roughplastic`, whose coat attenuates the light of the diffuse part on its way
    in and out. `roughplastic` loses more energy the rougher it is (9 % at an alpha of 0.1), so the base colour is
    brightened by as much. At full roughness the coat looks almost like a diffuse surface, and the material is
    `diffuse` with the albedo of both. Metals are conductors that reflect the base colour.
    """
    pbr = material.get("pbrMetallicRoughness", {})
    color = pbr.get("baseColorFactor", [1, 1, 1, 1])
    base = {"type": "rgb", "value": color[:3]}
    if "baseColorTexture" in pbr:
        texels = np.array(bitmap(glb, pbr["baseColorTexture"])) * np.float32(color[:3])
        base = {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": True}
    metallic, roughness = pbr.get("metallicFactor", 1.0), pbr.get("roughnessFactor", 1.0)
    ior = material.get("extensions", {}).get("KHR_materials_ior", {}).get("ior", 1.5)
    alpha = max(roughness * roughness, 1e-4)
    if is_solid(material) and metallic == 0:
        return solid(material, base, ior, alpha)
    if ior == 1.0:
        dielectric = {"type": "diffuse", "reflectance": base}
    elif roughness >= 0.7:
        coat = coat_albedo(ior, alpha)
        dielectric = {"type": "diffuse", "reflectance": scaled(base, 1 - coat, coat)}
    else:
        dielectric = coated(ior, alpha, scaled(base, (1 - coat_albedo(ior, alpha)) / coated_albedo(ior, alpha)))
    # Compute the index of refraction n and the absorption k of a conductor whose reflectance at normal incidence is the
    # base colour (Gulbrandsen 2014).
    f0 = np.clip(np.array(color[:3]), 0, 0.999)
    n = (1 - f0) / (1 + f0)
    k = np.sqrt(np.maximum(f0 * (n + 1) ** 2 - (n - 1) ** 2, 0) / (1 - f0))
    metal = {
        "type": "roughconductor", "distribution": "ggx", "alpha": alpha,
        "eta": {"type": "rgb", "value": n.tolist()}, "k": {"type": "rgb", "value": k.tolist()},
    }
    if metallic in (0.0, 1.0):
        inner = metal if metallic else dielectric
    else:
        inner = {"type": "blendbsdf", "weight": metallic, "first": dielectric, "second": metal}
    inner = {"type": "twosided", "bsdf": inner}
    if material.get("alphaMode") == "BLEND" and color[3] < 1:
        inner = {"type": "mask", "opacity": color[3], "bsdf": inner}
    return inner


def emitter(glb, material):
    """Returns the emitter of a material, or None."""
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


def both_sides(glb):
    """Yields the primitives. A lamp that shines on both sides gets a second, reversed primitive, because emitters of
    Mitsuba shine on one side."""
    for index, positions, normals, uvs, triangles in glb.primitives():
        yield index, positions, normals, uvs, triangles
        material = glb.json["materials"][index]
        if material.get("doubleSided") and max(material.get("emissiveFactor", [0])) > 0:
            a, b, c = (positions[triangles[:, k]] for k in range(3))
            facing = np.cross(b - a, c - a).sum(0)
            behind = positions - np.float32(1e-4 / max(np.linalg.norm(facing), 1e-30)) * facing
            back = None if normals is None else -normals
            yield index, behind.astype(np.float32), back, uvs, np.ascontiguousarray(triangles[:, ::-1])


def build(attach=lambda index, properties: None):
    """Builds the scene; `attach` may add properties to the mesh of a material."""
    glb = Glb(scene_path)
    position, forward, up, fov = glb.camera()
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath" if any(map(interior, glb.json["materials"])) else "path", "max_depth": -1},
        "sensor": {
            "type": "perspective",
            "fov": np.degrees(fov),
            "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(position, position + forward, up),
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"},
        },
    }
    for i, (index, positions, normals, uvs, triangles) in enumerate(both_sides(glb)):
        material = glb.json["materials"][index]
        properties = mi.Properties()
        properties["mesh_bsdf"] = mi.load_dict(bsdf(glb, material))
        light = emitter(glb, material)
        # Mitsuba's meshes have one set of texture coordinates; use the set of the emissive texture if there is one.
        uvs = uvs[material.get("emissiveTexture", {}).get("texCoord", 0)]
        if light is not None:
            properties["mesh_emitter"] = light
        medium = interior(material)
        if medium is not None:
            properties["interior"] = medium
        attach(index, properties)
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


if __name__ == "__main__":
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
