"""Work on a Dask cluster, as the guide shows it."""

# --8<-- [start:program]
import numpy as np
from distributed import Client, LocalCluster

import luxfer
import luxfer.distributed


def view(context: luxfer.Context) -> luxfer.Render:
    """Is called once on each worker, so each worker loads the scene itself."""
    scene = luxfer.Scene.demo(context, "still-life")       # luxfer.Scene.load(context, "/shared/room.glb")
    return luxfer.Render(context, scene, expressions={"direct": "LDE"})


def room(context: luxfer.Context) -> luxfer.Relight:
    scene = luxfer.Scene.demo(context, "target-room")
    lamps = np.eye(8).repeat(3).reshape(8, 8, 3)           # eight lamps in a diagonal
    mesh, material = scene.place_emission("Ceiling", lamps, (100, 100, 100))
    relight = luxfer.Relight(context)
    relight.set_scene(scene, material, mesh)
    return relight


def main() -> None:
    # Two processes on this machine; Client("scheduler:8786") connects to a real cluster.
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        with luxfer.Context() as context:
            render = luxfer.distributed.render(client, view, context, columns=3, rows=2, width=96, height=72, samples=16)
            render.write_exr("still_life.exr")

        targets = [(12, 10, 8), (6, 6, 6)]
        reports = luxfer.distributed.relight(client, room, targets, paths=20_000)
        for target, report in zip(targets, reports):
            print(target, "needs", report.scale)


if __name__ == "__main__":
    main()
# --8<-- [end:program]
