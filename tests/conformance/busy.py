"""Tests that quick calls, which finish their work before they return, never wait for a running job.

Plays programs twice, with and without a long job in each context, and compares the time of each call.

    python3 busy.py --seconds 600 --seed 1     plays random programs for 600 seconds, and prints the slowest calls
"""

from __future__ import annotations

import argparse
import ctypes
import os
import sys
import tempfile
import time
from dataclasses import dataclass

import faults
import scenarios
from player import Player, library
from script import Call, is_release

from luxfer import _abi as abi

#: Most rounds of a program. The least delay of a call counts: other programs may keep the processors busy.
ROUNDS = 24

#: Seconds by which a job may delay a call.
LIMIT = 0.05


class Busy(Player):
    """Plays a program and times its calls; if `is_busy`, each context has an endless rendering meanwhile."""

    def __init__(self, journal: int, is_busy: bool) -> None:
        super().__init__(journal)
        self.is_busy = is_busy
        self.endless: dict[int, tuple[int, int]] = {}  # a render and its job for each context
        self.seconds: list[float] = []

    def call(self, call: Call, may_release: bool = True) -> None:
        known = len(self.contexts)
        # End the endless job first: a job for which the program waits runs only after it.
        waits = call[0] == "luxfer_job_wait"
        if waits:
            self.end()
        start = time.monotonic()
        super().call(call, may_release)
        taken = time.monotonic() - start
        # Do not time releases: releasing the last reference may end a job or the threads of a context, which is real
        # work.
        self.seconds.append(0.0 if waits or is_release(call[0]) else taken)
        if self.is_busy and (waits or len(self.contexts) > known):
            self.start()

    def start(self) -> None:
        """Starts an endless job on each context that has none, and waits until it runs."""
        for context in self.contexts:
            if context in self.endless:
                continue
            scene, render, job = (ctypes.c_void_p() for _ in range(3))
            check(library.luxfer_demo_create_scene(context, abi.LUXFER_DEMO_TARGET_ROOM, ctypes.addressof(scene)))
            check(library.luxfer_render_create(context, ctypes.addressof(render)))
            check(library.luxfer_render_set_scene(render, scene))
            check(library.luxfer_release(scene))
            params = abi.luxfer_render_params()
            check(library.luxfer_init(abi.LUXFER_STRUCT_RENDER_PARAMS, ctypes.addressof(params), ctypes.sizeof(params)))
            params.width, params.height, params.samples = 64, 64, 1 << 20
            check(library.luxfer_render_start(render, ctypes.addressof(params), ctypes.addressof(job)))
            self.endless[context] = (render.value, job.value)
            fraction, patience = ctypes.c_double(), time.monotonic() + 5
            # Another job of the program may run before the endless one.
            while fraction.value == 0 and time.monotonic() < patience:
                check(library.luxfer_job_get_progress(job, ctypes.addressof(fraction)))
                time.sleep(0.001)

    def end(self) -> None:
        for render, job in self.endless.values():
            check(library.luxfer_job_cancel(job))
            check(library.luxfer_job_wait(job, -1, abi.luxfer_progress_fn(), None, ctypes.addressof(ctypes.c_int32())))
            check(library.luxfer_release(job))
            check(library.luxfer_release(render))
        self.endless.clear()

    def release(self) -> None:
        self.end()
        super().release()


def check(status: int) -> None:
    if status != abi.LUXFER_OK:
        raise RuntimeError(f"the endless job: status {status}")


@dataclass(frozen=True, order=True)
class Delay:
    """By how much a running job delays a call of a program."""

    seconds: float
    function: str
    program: object


def times(calls: list[Call], is_busy: bool) -> list[float]:
    with tempfile.TemporaryDirectory() as folder:
        before = os.getcwd()
        os.chdir(folder)  # programs write files
        scenarios.write_files(folder)
        journal = os.open("journal", os.O_RDWR | os.O_CREAT)
        try:
            player = Busy(journal, is_busy)
            try:
                player.play(calls, 1, 0)
            except BaseException:
                player.end()
                raise
            return player.seconds
        finally:
            os.close(journal)
            os.chdir(before)


def delays(calls: list[Call], program: object) -> list[Delay]:
    """The smallest delay of each call in up to ROUNDS rounds; stops when all delays are below the limit."""
    idle = [min(rounds) for rounds in zip(*(times(calls, False) for _ in range(2)))]
    busy = times(calls, True)
    for _ in range(1, ROUNDS):
        if max(b - a for a, b in zip(idle, busy)) <= LIMIT:
            break
        busy = [min(rounds) for rounds in zip(busy, times(calls, True))]
    return [Delay(b - a, call[0], program) for call, a, b in zip(calls, idle, busy)]


def main() -> int:
    parser = argparse.ArgumentParser(description="times calls beside a job that always runs")
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    usual, end, seed, count, slowest = scenarios.programs(), time.monotonic() + asked.seconds, asked.seed, 0, []
    while time.monotonic() < end:
        found = delays(faults.random_program(usual, seed), seed)
        count += len(found)
        slowest = sorted([*slowest, *found], reverse=True)[:10]
        seed += 1
    print(f"{count} calls of {seed - asked.seed} programs; the slowest beside a job, less their time without it:")
    for delay in slowest:
        print(f"{1000 * delay.seconds:8.1f} ms  {delay.function} of program {delay.program}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
