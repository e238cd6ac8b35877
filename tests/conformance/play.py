"""Plays programs in child processes, and reduces a program that fails to the calls that are needed for the failure.

    python3 play.py --seconds 600 --seed 1     plays random programs for 600 s, writes failures to failure-SEED.json
    python3 play.py --replay failure-1.json    plays a failed program again
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import faults
import scenarios
from script import Call

HERE = Path(__file__).resolve().parent
#: Seconds after which a process that plays programs is taken to hang.
HANG = 600


@dataclass
class Failure:
    """How a process failed, and in which call of which program."""

    program: int
    call: int
    why: str


def play(programs: list[list[Call]], threads: int = 1, hang: float = HANG) -> Failure | None:
    with tempfile.TemporaryDirectory() as folder:
        file, journal = Path(folder, "programs"), Path(folder, "journal")
        scenarios.write_files(folder)
        with open(file, "w") as out:
            for calls in programs:
                out.write(json.dumps({"threads": threads, "calls": calls}) + "\n")
        player = [sys.executable, HERE / "player.py", file, journal]
        environment = {**os.environ, "PYTHONPATH": str(HERE)}
        try:
            run = subprocess.run(player, cwd=folder, capture_output=True, text=True, timeout=hang, env=environment)
            if run.returncode == 0:
                return None
            why = f"the process ended with {run.returncode}: {run.stderr[-2000:]}"
        except subprocess.TimeoutExpired:
            why = f"the process hung for {hang} s"
        lines = journal.read_text().split("\n") if journal.exists() else []
        places = [line.split() for line in lines[:threads]]
        program, call = next(((int(p[0]), int(p[1])) for p in places if len(p) == 2 and p[0].isdigit()), (0, 0))
        said = "\n".join(line for line in lines[threads:] if line.strip())
        return Failure(program, call, f"{why}{said}")


def minimise(calls: list[Call], threads: int, patience: float = 60) -> list[Call]:
    """Removes calls, in ever smaller pieces, while the program still fails (ddmin: Zeller and Hildebrandt 2002)."""
    end = time.monotonic() + patience
    size = len(calls) // 2
    while size and time.monotonic() < end:
        start = 0
        while start < len(calls) and time.monotonic() < end:
            shorter = calls[:start] + calls[start + size :]
            if play([shorter], threads, 60):
                calls = shorter
            else:
                start += size
        size //= 2
    return calls


def report(calls: list[Call], failure: Failure, threads: int, seed: object) -> str:
    """Reduces the failed program, writes it to a file, and returns a text that describes the failure."""
    calls = minimise(calls, threads)
    again = play([calls], threads) or failure
    name = f"failure-{seed}.json"
    Path(name).write_text(json.dumps({"threads": threads, "calls": calls}))
    last = calls[min(again.call, len(calls) - 1)]
    return f"{again.why}\nin {json.dumps(last)[:600]}\nafter {len(calls)} calls: {name}"


def main() -> int:
    parser = argparse.ArgumentParser(description="plays random programs against the library")
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--replay")
    asked = parser.parse_args()
    if asked.replay:
        program = json.loads(Path(asked.replay).read_text())
        failure = play([program["calls"]], program["threads"])
        print(failure.why if failure else "it passes")
        return failure is not None
    usual, end, seed, found = scenarios.programs(), time.monotonic() + asked.seconds, asked.seed, 0
    while time.monotonic() < end:
        batch = [faults.random_program(usual, seed + i) for i in range(20)]
        if failure := play(batch, asked.threads):
            found += 1
            print(f"seed {seed + failure.program}: {report(batch[failure.program], failure, asked.threads, seed + failure.program)}", flush=True)
            seed += failure.program + 1
        else:
            seed += len(batch)
    print(f"{seed - asked.seed} programs, {found} failures")
    return found > 0


if __name__ == "__main__":
    sys.exit(main())
