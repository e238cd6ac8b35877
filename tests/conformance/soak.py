"""Tests long use in one process: jobs are started, cancelled and released, contexts created and released, and small
transfers run. Memory, threads and open files of the process must not grow.

    python3 soak.py [--cycles 10000] [--transfers 1000]    prints the growth; the exit code is 1 if the process grows
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import os
import sys
from pathlib import Path

import script  # noqa: F401: puts the package on the path

import luxfer
from luxfer import errors
from luxfer.image import np

#: Growth in MiB that is not counted: the memory that a context or a job that is about to end still holds.
SLACK = 1.0


class MallocInfo(ctypes.Structure):
    """The struct mallinfo2 of glibc: statistics of its allocator."""

    _fields_ = [(name, ctypes.c_size_t) for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()]


libc = ctypes.CDLL(None)
libc.mallinfo2.restype = MallocInfo


def held() -> tuple[float, int, int]:
    """Allocated MiB, number of threads, and number of open files.

    Resident memory would be useless, because the memory that the allocator keeps in reserve varies by tens of MiB.
    """
    gc.collect()
    heap = libc.mallinfo2()
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return (heap.uordblks + heap.hblkhd) / 2**20, int(status["Threads"]), len(os.listdir("/proc/self/fd"))


def room(context: luxfer.Context) -> luxfer.Scene:
    scene = luxfer.Scene.demo(context, "sphere-on-table")
    scene.set_environment((1, 1, 1))
    return scene


class Soak:
    """The work that is repeated, in a permanent context and in temporary ones."""

    def __init__(self) -> None:
        self.context = luxfer.Context(num_threads=2)
        self.scene = room(self.context)
        photo = luxfer.DemoPhoto(self.context).run(width=150, height=100, samples=2)
        self.photo, self.strokes = photo.image("picture"), photo.image("strokes")
        self.target = luxfer.Scene.demo(self.context, "target-room")
        # Render once first, because a scene then keeps its acceleration structure.
        luxfer.Render(self.context, self.scene).run(width=8, height=8, samples=1)

    def cancel(self, cycle: int) -> None:
        """Starts a job; then closes or cancels it, or lets it end, after a time that varies from cycle to cycle."""
        render = luxfer.Render(self.context, self.scene)
        job = render.start(width=48, height=32, samples=1 + (cycle % 5) * 1000)
        try:
            job.wait(timeout=(cycle % 7) * 1e-4)
        except errors.NotReady:
            if cycle % 3:
                job.cancel()
        job.close()
        if cycle % 10 == 0:
            with luxfer.Context(num_threads=1 + cycle % 3) as own:
                luxfer.Image(own, np.zeros((8, 8, 3), np.float32)).close()

    def transfer(self, cycle: int) -> None:
        stage = luxfer.Transfer(self.context, self.photo, self.target, "Ceiling")
        stage.set_strokes(self.strokes)
        try:
            stage.run(max_texels=64, target="whole-image", relight={"paths": 1024, "seed": cycle}, render={"width": 24, "height": 16, "samples": 2})
        except errors.Error as error:
            # For so small a photo these two errors are possible results; any other error is a failure.
            if not isinstance(error, (errors.Degenerate, errors.Unreachable)):
                raise

    def repeat(self, what, cycles: int, rounds: int = 5) -> list[tuple[float, int, int]]:
        """Runs the cycles in `rounds` equal parts; returns the resources of the process after each part."""
        out = []
        for part in range(rounds):
            for cycle in range(part * cycles // rounds, (part + 1) * cycles // rounds):
                what(cycle)
            out.append(held())
        return out


def growth(seen: list[tuple[float, int, int]]) -> str | None:
    """Describes growth since half-time, or returns None. In the first half, permanent resources are still set up."""
    (memory, threads, files), last = seen[len(seen) // 2], seen[-1]
    if last[0] > memory + SLACK:
        return f"memory grew from {memory:.2f} to {last[0]:.2f} MiB"
    if last[1] > threads or last[2] > files:
        return f"threads grew from {threads} to {last[1]}, open files from {files} to {last[2]}"
    return None


def main() -> int:
    parser = argparse.ArgumentParser(description="uses the library for long in one process")
    parser.add_argument("--cycles", type=int, default=10_000)
    parser.add_argument("--transfers", type=int, default=1_000)
    asked = parser.parse_args()
    soak, failed = Soak(), False
    for what, cycles in ((soak.cancel, asked.cycles), (soak.transfer, asked.transfers)):
        seen = soak.repeat(what, cycles)
        for memory, threads, files in seen:
            print(f"{what.__name__:9} {memory:8.2f} MiB {threads:4} threads {files:4} open files")
        if why := growth(seen):
            failed = True
            print(f"{what.__name__}: {why}")
    return failed


if __name__ == "__main__":
    sys.exit(main())
