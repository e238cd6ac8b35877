"""Filters pictures with Open Image Denoise: reads lines "INPUT OUTPUT WIDTH HEIGHT".

INPUT is a file with the picture, its albedo and its normals (three images of linear RGB, 32-bit floats); the result is
written to OUTPUT. Prints a line of JSON for each: the seconds of processor time.
"""

import json
import sys
import time

import numpy as np
import pyoidn

print(json.dumps({"version": pyoidn.__version__ if hasattr(pyoidn, "__version__") else "?"}), flush=True)
for line in sys.stdin:
    source, target, width, height = line.split()
    colour, albedo, normal = np.fromfile(source, np.float32).reshape(3, int(height), int(width), 3)
    start = time.process_time()
    pyoidn.denoise(colour, albedo=np.clip(albedo, 0, 1), normal=normal, hdr=True).astype(np.float32).tofile(target)
    print(json.dumps({"seconds": time.process_time() - start}), flush=True)
