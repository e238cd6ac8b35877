"""Estimates normals with Open3D: reads lines `POINTS NORMALS K`.

POINTS is a file of float32 triples, K the number of neighbours; the normals are written to NORMALS, as float32 triples.
Prints a line of JSON for each: the seconds that `estimate_normals` took, including the construction of its tree.
"""

import json
import sys
import time

import numpy as np
import open3d

open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
print(json.dumps({"version": open3d.__version__}), flush=True)
for line in sys.stdin:
    points, normals, neighbours = line.split()
    cloud = open3d.geometry.PointCloud()
    cloud.points = open3d.utility.Vector3dVector(np.fromfile(points, np.float32).reshape(-1, 3).astype(np.float64))
    start = time.perf_counter()
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(int(neighbours)))
    seconds = time.perf_counter() - start
    cloud.orient_normals_towards_camera_location(np.zeros(3))
    np.asarray(cloud.normals).astype(np.float32).tofile(normals)
    print(json.dumps({"seconds": seconds}), flush=True)
