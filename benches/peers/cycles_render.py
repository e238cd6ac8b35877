"""Renders a GLB with Cycles (bpy): cycles_render.py SCENE.glb WIDTH HEIGHT OUT

Prints a line of JSON when it is ready. For each line "SPP SEED" of standard input it then renders an image, writes it
to OUT (rows of linear RGB, 32-bit floats) and prints a line of JSON: spp, seed, seconds. Clamping, denoising, adaptive
sampling and light thresholds are off, so that the estimate is as unbiased as Cycles allows.
"""

import json
import sys
import time

import bpy
import numpy as np

scene_path, width, height, out = sys.argv[1:5]
width, height = int(width), int(height)

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=scene_path)
scene = bpy.context.scene
scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
scene.world = bpy.data.worlds.new("black")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0

render = scene.render
render.engine = "CYCLES"
render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
render.threads_mode, render.threads = "FIXED", 2
render.use_persistent_data = True
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_depth = "32"
render.image_settings.exr_codec = "NONE"
render.filepath = out + ".exr"
# The glTF camera states the vertical field of view.
scene.camera.data.sensor_fit = "VERTICAL"

cycles = scene.cycles
cycles.device = "CPU"
cycles.use_adaptive_sampling = False
cycles.use_denoising = False
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
cycles.light_sampling_threshold = 0.0
cycles.blur_glossy = 0.0
cycles.pixel_filter_type = "BOX"
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 1024
cycles.transparent_max_bounces = 1024


def run(spp, seed):
    cycles.samples, cycles.seed = spp, seed
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - start
    image = bpy.data.images.load(render.filepath, check_existing=False)
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return seconds, pixels.reshape(height, width, 4)[::-1, :, :3]


# Exclude the time for preparing the scene and writing the file: it is estimated by a render of one sample.
run(1, 0)
base, _ = run(1, 1)
print(json.dumps({"ready": bpy.app.version_string}), flush=True)
for job in sys.stdin:
    spp, seed = map(int, job.split())
    seconds, image = run(spp, seed)
    np.ascontiguousarray(image).tofile(out)
    print(json.dumps({"spp": spp, "seed": seed, "seconds": max(seconds - base, 1e-6)}), flush=True)
