"""Computes masks from strokes with OpenCV's grabCut, and with scikit-learn's random forest and RBF support vector
machine.

Reads lines of JSON: {"method", "features" or "photo", "width", "height", "channels", "use", "strokes", "within",
"out"}. Files hold float32 features, 8-bit BGR, and bytes for strokes (0 none, 1 negative, 2 positive) and masks. Prints
a line of JSON for each: the seconds that training and inference took. Like ours, the classifiers draw at most 1000
samples per class.
"""

import json
import sys
import time

import cv2
import numpy as np
from sklearn.ensemble import RandomForestClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

SAMPLES = 1000


def grabcut(job, strokes):
    photo = np.fromfile(job["photo"], np.uint8).reshape(*strokes.shape, 3)
    start = time.perf_counter()
    mask = np.choose(strokes, [cv2.GC_PR_BGD, cv2.GC_BGD, cv2.GC_FGD]).astype(np.uint8)
    cv2.grabCut(photo, mask, None, np.zeros((1, 65)), np.zeros((1, 65)), 5, cv2.GC_INIT_WITH_MASK)
    out = (mask == cv2.GC_FGD) | (mask == cv2.GC_PR_FGD)
    return time.perf_counter() - start, out


def classify(job, strokes, model):
    features = np.fromfile(job["features"], np.float32).reshape(-1, job["channels"])
    start = time.perf_counter()
    features = np.ascontiguousarray(features[:, job["use"]])
    random = np.random.default_rng(1)
    drawn = []
    for value in (1, 2):
        pixels = np.flatnonzero(strokes.ravel() == value)
        drawn.append(random.choice(pixels, min(SAMPLES, len(pixels)), replace=False))
    pixels = np.concatenate(drawn)
    model.fit(features[pixels], strokes.ravel()[pixels] == 2)
    out = np.zeros(strokes.size, bool)
    look = np.flatnonzero(np.fromfile(job["within"], np.uint8)) if job.get("within") else slice(None)
    out[look] = model.predict(features[look])
    return time.perf_counter() - start, out.reshape(strokes.shape)


def run(job):
    strokes = np.fromfile(job["strokes"], np.uint8).reshape(job["height"], job["width"])
    if job["method"] == "grabcut":
        return grabcut(job, strokes)
    if job["method"] == "rf":
        return classify(job, strokes, RandomForestClassifier(100, n_jobs=2, random_state=1))
    return classify(job, strokes, make_pipeline(StandardScaler(), SVC()))


cv2.setNumThreads(2)
print(json.dumps({"opencv": cv2.__version__}), flush=True)
for line in sys.stdin:
    job = json.loads(line)
    seconds, out = run(job)
    out.astype(np.uint8).tofile(job["out"])
    print(json.dumps({"seconds": seconds}), flush=True)
