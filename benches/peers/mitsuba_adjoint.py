"""Computes gradients with Mitsuba 3's `prb`: mitsuba_adjoint.py VARIANT SCENE.glb WIDTH HEIGHT OUT TARGET SPP SEEDS

An irradiance meter measures the mean irradiance of the surface whose material has the index TARGET. The program
differentiates it twice: with respect to each texel of the lamp, whose texture has WIDTH x HEIGHT texels of one value;
and, with a smooth pattern (`pattern` below) as the texture, with respect to the five numbers of the pattern's
placement: its offset along u and v, its scale along both and its rotation, all about the centre. For each of SEEDS
seeds, a row of 32-bit floats is written to OUT: the gradients of the texels (rows, columns, channels), then those of
the five numbers, channel by channel.
"""

import json
import sys

import numpy as np

target_material, spp, seeds = (int(v) for v in sys.argv[6:9])
del sys.argv[6:]
import mitsuba_render
from mitsuba_render import dr, mi

OFFSET, SCALE, ROTATION = (0.15, -0.2), (1.0, 1.0), 0.4


def attach(index, properties):
    if index == target_material:
        film = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        properties["mesh_sensor"] = mi.load_dict({"type": "irradiancemeter", "film": film})


def pattern(u, v):
    """Returns the pattern's value at a point: positive, with period 1 along both coordinates."""
    return 1 + 0.6 * dr.sin(dr.two_pi * u) + 0.3 * dr.cos(dr.two_pi * v)


def placed(numbers, width, height):
    """Returns the placed pattern's values at the centres of texels."""
    x, y = dr.meshgrid(dr.arange(mi.Float, width), dr.arange(mi.Float, height))
    u, v = ((x + 0.5) / width - 0.5) * numbers[2], ((y + 0.5) / height - 0.5) * numbers[3]
    sine, cosine = dr.sincos(numbers[4])
    return pattern(cosine * u - sine * v + 0.5 + numbers[0], sine * u + cosine * v + 0.5 + numbers[1])


def main():
    scene = mitsuba_render.build(attach)
    dr.set_thread_count(2)
    sensor = next(i for i, s in enumerate(scene.sensors()) if tuple(s.film().size()) == (1, 1))
    parameters = mi.traverse(scene)
    key = next(k for k in parameters.keys() if k.endswith("emitter.radiance.data"))
    height, width = parameters[key].shape[:2]
    integrator = mi.load_dict({"type": "prb", "max_depth": -1, "rr_depth": 5})

    def gradients(texels, leaves, channels, seed):
        """Returns the gradients of the mean irradiance in some channels with respect to `leaves`."""
        parameters[key] = texels
        parameters.update()
        image = mi.render(scene, parameters, sensor=sensor, integrator=integrator, spp=spp, seed=seed, seed_grad=seed + 500)
        dr.backward(sum(dr.sum(image[..., c].array) for c in channels))
        return np.concatenate([np.array(dr.grad(leaf), np.float64).ravel() for leaf in leaves])

    rows = []
    for seed in range(1, seeds + 1):
        texels = mi.TensorXf(np.ones((height, width, 3), np.float32))
        dr.enable_grad(texels)
        # A channel of the irradiance depends only on the same channel of the texels, so one pass gives all channels.
        row = [gradients(texels, [texels], range(3), seed)]
        for c in range(3):
            numbers = [mi.Float(v) for v in (*OFFSET, *SCALE, ROTATION)]
            dr.enable_grad(*numbers)
            grey = placed(numbers, width, height)
            colour = dr.ravel(mi.Color3f(grey))
            row.append(gradients(mi.TensorXf(colour, (height, width, 3)), numbers, [c], 1000 * (c + 1) + seed))
        rows.append(np.concatenate([row[0], np.array(row[1:]).T.ravel()]))
    np.array(rows, np.float32).tofile(mitsuba_render.out)
    print(json.dumps({"width": width, "height": height, "seeds": seeds}), flush=True)


main()
