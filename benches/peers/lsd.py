"""Detects line segments with OpenCV's `LineSegmentDetector`: reads lines of JSON, {"image", "width", "height", "out"}.

"image" is a file of 8-bit grey pixels. For each segment, four float32 (the coordinates of its ends; pixel centres have
integer coordinates) are written to "out". Prints a line of JSON for each image: the seconds that the detection took.
"""

import json
import sys
import time

import cv2
import numpy as np

cv2.setNumThreads(2)
detector = cv2.createLineSegmentDetector()
print(json.dumps({"opencv": cv2.__version__}), flush=True)
for line in sys.stdin:
    job = json.loads(line)
    image = np.fromfile(job["image"], np.uint8).reshape(job["height"], job["width"])
    start = time.perf_counter()
    lines = detector.detect(image)[0]
    seconds = time.perf_counter() - start
    (np.empty(0) if lines is None else lines).astype(np.float32).tofile(job["out"])
    print(json.dumps({"seconds": seconds}), flush=True)
