"""Warps images by homographies with OpenCV: reads lines of JSON, {"image", "width", "height", "map", "out_width",
"out_height", "interpolation", "out"}.

Files hold float32 RGB. `map` is the homography from pixels of the result to pixels of the image, row by row; pixel
centres have integer coordinates. Prints a line of JSON for each: the wall-clock and the processor seconds of the warp.
"""

import json
import sys
import time

import cv2
import numpy as np

INTERPOLATIONS = {"linear": cv2.INTER_LINEAR, "cubic": cv2.INTER_CUBIC, "area": cv2.INTER_AREA}

cv2.setNumThreads(2)
print(json.dumps({"opencv": cv2.__version__}), flush=True)
for line in sys.stdin:
    job = json.loads(line)
    image = np.fromfile(job["image"], np.float32).reshape(job["height"], job["width"], 3)
    matrix = np.array(job["map"]).reshape(3, 3)
    size = (job["out_width"], job["out_height"])
    flags = INTERPOLATIONS[job["interpolation"]] | cv2.WARP_INVERSE_MAP
    start, busy = time.perf_counter(), time.process_time()
    out = cv2.warpPerspective(image, matrix, size, flags=flags)
    seconds, busy = time.perf_counter() - start, time.process_time() - busy
    out.tofile(job["out"])
    print(json.dumps({"seconds": seconds, "busy": busy}), flush=True)
