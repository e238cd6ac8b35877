"""Solves for the colour of a lamp with Mitsuba 3's `prb` and Adam.

    mitsuba_relight.py VARIANT SCENE.glb WIDTH HEIGHT OUT TARGET

TARGET is the index of a material. An irradiance meter measures the mean irradiance of the surface with this material;
its gradient is computed directly, without an image. The lamp starts white. The solution is known: 0.8, 1 and 1.25 times
the initial red, green and blue; the irradiance wanted is the one that this colour gives, rendered first with many
samples. The learning rate decreases with the iterations so that noise does not keep the solution moving. Prints a line
of JSON for each number of samples per iteration: seconds until the worst channel stays within 1 % for five iterations
(null if it never does), and seconds per iteration. The time of compiling kernels is not counted.
"""

import json
import sys
import time

import numpy as np

target_material = int(sys.argv.pop())
import mitsuba_render
from mitsuba_render import dr, mi

TRUTH = np.array([0.8, 1.0, 1.25])
ITERATIONS = 80
RATE, DECAY = 0.08, 0.95
SAMPLES = [1 << 12, 1 << 14, 1 << 16]


def attach(index, properties):
    if index == target_material:
        film = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        properties["mesh_sensor"] = mi.load_dict({"type": "irradiancemeter", "film": film})


def measure(scene, sensor, passes):
    """Measures the mean irradiance per channel."""
    render = lambda seed: np.array(mi.render(scene, sensor=sensor, spp=1 << 18, seed=seed), np.float64).ravel()
    return np.mean([render(1000 + i) for i in range(passes)], axis=0)


def solve(scene, sensor, keys, start, target, spp):
    """Returns, after each iteration, the seconds and the colour of the lamp relative to its initial colour."""
    parameters = mi.traverse(scene)
    integrator = mi.load_dict({"type": "prb", "max_depth": -1, "rr_depth": 5})
    optimiser = mi.ad.Adam(lr=RATE)
    optimiser["colour"] = mi.Color3f(1, 1, 1)
    goal = mi.Color3f(*map(float, target))
    path = []
    for iteration in range(-1, ITERATIONS):
        if iteration == 0:
            begin = time.perf_counter()
        for key in keys:
            parameters[key] = optimiser["colour"] * mi.Color3f(*map(float, start))
        parameters.update()
        image = mi.render(scene, parameters, sensor=sensor, integrator=integrator, spp=spp, seed=iteration + 1)
        light = mi.Color3f(*(dr.sum(image[..., c].array) for c in range(3)))
        loss = dr.sum(dr.square(light / goal - 1))
        dr.backward(loss)
        if iteration < 0:
            # Discard the gradient of the first iteration, which only compiled the kernels.
            optimiser["colour"] = mi.Color3f(1, 1, 1)
            continue
        optimiser.set_learning_rate(RATE * DECAY**iteration)
        optimiser.step()
        colour = np.array(optimiser["colour"]).ravel()
        path.append((time.perf_counter() - begin, colour))
    return path


def main():
    scene = mitsuba_render.build(attach)
    dr.set_thread_count(2)
    sensor = next(i for i, s in enumerate(scene.sensors()) if tuple(s.film().size()) == (1, 1))
    # A lamp that shines on both sides consists of two emitters.
    keys = [k for k in mi.traverse(scene).keys() if k.endswith("emitter.radiance.value")]
    start = np.array(mi.traverse(scene)[keys[0]]).ravel()
    target = measure(scene, sensor, 16) * TRUTH
    for spp in SAMPLES:
        path = solve(scene, sensor, keys, start, target, spp)
        good = [np.abs(colour / TRUTH - 1).max() <= 0.01 for _, colour in path]
        first = next((i for i in range(len(good) - 4) if all(good[i : i + 5])), None)
        seconds = None if first is None else path[first][0]
        answer = {"spp": spp, "seconds": seconds, "per_iteration": path[-1][0] / len(path)}
        print(json.dumps(answer), flush=True)


main()
