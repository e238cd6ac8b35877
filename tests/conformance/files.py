"""Loads damaged files: PNG, EXR, GLB, EULUMDAT, TM-33 and GLDF files and parts of renderings, all written by the
library, an IES file and a Radiance HDR, in which random bytes and numbers have been changed; and random texts made of
the symbols of light path expressions and strokes. Files that load are also used.

    python3 files.py FIRST COUNT JOURNAL   loads the files of COUNT seeds from FIRST in this process
    python3 files.py --seconds 600         loads files of new seeds for 600 seconds, in child processes
"""

from __future__ import annotations

import argparse
import copy
import ctypes
import json
import random
import resource
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import script  # noqa: F401: puts the package on the path

from luxfer import _abi as abi

MEMORY = 4 << 30
#: Longest that a damaged file may keep its reader busy, in seconds; generous, as machines may be busy.
PATIENCE = 20.0
LIARS = [-1, 0, 1, 2, 3, 7, 255, 65535, 65537, 2**31 - 1, 2**31, 2**32 - 1, 2**53, -(2**31), 0.5, 1e-40, 1e30, -1e308, "", "x", None, True, [], {}, [0], [1e30, 0, 0]]
WORDS = [0, 1, 2, 0x7F, 0x80, 0xFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7FC00000, 0x7F800000]


def radiance(width: int, height: int, rng: random.Random) -> bytes:
    """A random Radiance HDR picture without compression."""
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    return head + rng.randbytes(4 * width * height)


#: What texts are made of: the first for light path expressions, the second for strokes.
SYMBOLS = [
    [*"LDSGEOCX<>()[]|.*+?^'12 ", *["L", "D", "E", "."] * 5, "<RD>", "<L.>", "{1,2}", "{9999999999}", "[^S]", "\u00e9"],
    ["plane", "not-plane", "light", "not-light", *" \n\n#-.e", "0", "1", "7", "250", "-3", "1e9", "1e400", "nan", "inf", "\u00e9"],
]


def places(tree, path=()):
    """The paths of all values in a JSON tree."""
    found = [path] if path else []
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        found += places(value, (*path, key))
    return found


def damaged_json(tree, rng: random.Random):
    tree = copy.deepcopy(tree)
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        found = places(tree)
        if not found:
            break
        path = rng.choice(found)
        parent = tree
        for key in path[:-1]:
            parent = parent[key]
        dice = rng.random()
        if dice < 0.15:
            del parent[path[-1]]
        elif dice < 0.3 and isinstance(parent, list):
            parent.append(copy.deepcopy(parent[path[-1]]))
        elif isinstance(old := parent[path[-1]], (int, float)) and rng.random() < 0.7:
            parent[path[-1]] = rng.choice([old + 1, old - 1, -old, 0, 2 * old, old * 1e-20, old * 1e20, 1e-40, 3e38])
        else:
            parent[path[-1]] = copy.deepcopy(rng.choice(LIARS))
    return tree


def damaged_bytes(data: bytes, rng: random.Random) -> bytes:
    data = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 4, 16])):
        if not data:
            break
        at, dice = rng.randrange(len(data)), rng.random()
        # Half of the changes go to the header, where sizes and offsets are.
        at = rng.randrange(min(len(data), 200)) if rng.random() < 0.5 else at
        if dice < 0.3:
            data[at] ^= 1 << rng.randrange(8)
        elif dice < 0.6:
            data[at : at + 4] = struct.pack(rng.choice("<>") + "I", rng.choice(WORDS))
        elif dice < 0.7:
            del data[at:]
        elif dice < 0.8:
            del data[at : at + rng.randint(1, 64)]
        elif dice < 0.9:
            data[at:at] = data[: rng.randint(1, 64)]
        else:
            data[at : at + 8] = rng.randbytes(8)
    return bytes(data)


def damaged_glb(data: bytes, rng: random.Random) -> bytes:
    length = struct.unpack_from("<I", data, 12)[0]
    tree, rest = json.loads(data[20 : 20 + length]), data[20 + length :]
    text = json.dumps(damaged_json(tree, rng)).encode()
    text += b" " * (-len(text) % 4)
    out = struct.pack("<III", 0x46546C67, 2, 20 + len(text) + len(rest)) + struct.pack("<II", len(text), 0x4E4F534A) + text + rest
    return damaged_bytes(out, rng) if rng.random() < 0.1 else out


def check(seed: int, status: int, start: float) -> None:
    taken = time.monotonic() - start
    if not 0 <= status <= 13 or status in (abi.LUXFER_INTERNAL, abi.LUXFER_UNKNOWN) or taken > PATIENCE:
        raise SystemExit(f"seed {seed}: status {status} after {taken:.1f} s")


class Loader:
    """Loads damaged files in one context, which must survive them all."""

    def __init__(self) -> None:
        import luxfer
        from luxfer import library

        self.library = library
        self.context = luxfer.Context(num_threads=1)
        rng = random.Random(0)
        folder = tempfile.TemporaryDirectory()
        self.images = [radiance(9, 5, rng)]
        with folder:
            numpy = luxfer.image.np
            for channels in (1, 3, 4):
                for name in ("a.png", "a.exr"):
                    path = str(Path(folder.name, name))
                    luxfer.Image(self.context, numpy.full((5, 7, channels), 0.3, numpy.float32)).save(path)
                    self.images.append(Path(path).read_bytes())
        scene = luxfer.Scene.demo(self.context, "still-life")
        self.scenes = [scene.to_bytes()]
        lit = luxfer.Scene.demo(self.context, "sphere-on-table")
        self.scenes.append(lit.to_bytes())
        empty = luxfer.Scene(self.context)
        photo = luxfer.Image(self.context, numpy.zeros((9, 9, 3), numpy.float32))
        shape = "1 1000 1 3 2 1 2 0.5 0.5 0\n1 1 50\n0 45 90\n0 180\n100 80 0\n100 90 10\n"
        ies = f"IESNA:LM-63-2002\n[LUMINAIRE] Lamp\nTILT=NONE\n{shape}".encode()
        self.distributions = [(ies, 0)]
        with tempfile.TemporaryDirectory() as folder:
            for kind, ending in enumerate(("ldt", "xml", "gldf"), 1):
                path = Path(folder, f"a.{ending}")
                luxfer.Distribution.load_memory(self.context, ies, "ies").save(path)
                self.distributions.append((path.read_bytes(), kind))
        # Two parts of a rendering: one stays intact, the other gets damaged.
        self.halves = tempfile.TemporaryDirectory()
        self.whole, self.other = (str(Path(self.halves.name, name)) for name in ("whole.part", "other.part"))
        self.size = {"width": 9, "height": 5, "samples": 4}
        self.merge = luxfer.Render(self.context, lit, expressions={"direct": "LDE"})
        for index, path in enumerate((self.whole, self.other)):
            part = self.merge.split(1, 1, 2, index, **self.size)
            self.merge.start_part(path, part, **self.size).wait()
        self.part = Path(self.other).read_bytes()
        self.stages = [luxfer.Render(self.context, empty), luxfer.Strokes(self.context, *photo.size[:2])]

    def load(self, seed: int) -> None:
        rng = random.Random(seed)
        if rng.random() < 0.3:
            self.parse_text(seed, rng)
            return
        if rng.random() < 0.2:
            self.shine(seed, rng)
            return
        if rng.random() < 0.2:
            self.add_up(seed, rng)
            return
        is_scene = rng.random() < 0.6
        data = damaged_glb(rng.choice(self.scenes), rng) if is_scene else damaged_bytes(rng.choice(self.images), rng)
        out = ctypes.POINTER(abi.luxfer_scene if is_scene else abi.luxfer_image)()
        start = time.monotonic()
        if is_scene:
            status = self.library.luxfer_scene_load_memory(self.context.handle, data, len(data), None, None, ctypes.byref(out))
        else:
            status = self.library.luxfer_image_load_memory(self.context.handle, data, len(data), 1, ctypes.byref(out))
        check(seed, status, start)
        if status == abi.LUXFER_OK:
            self.use(out, is_scene, seed)

    def shine(self, seed: int, rng: random.Random) -> None:
        """Loads a luminaire file in which bytes or numbers have been changed."""
        data, kind = rng.choice(self.distributions)
        if rng.random() < 0.5:
            words = data.split(b" ")
            words[rng.randrange(len(words))] = rng.choice([b"-1", b"0", b"1e400", b"nan", b"99999999999", b"7", b"x", b"1\n2", b""])
            data = b" ".join(words)
        else:
            data = damaged_bytes(data, rng)
        out, start = ctypes.POINTER(abi.luxfer_distribution)(), time.monotonic()
        status = self.library.luxfer_distribution_load_memory(self.context.handle, data, len(data), kind, ctypes.byref(out))
        check(seed, status, start)
        if status == abi.LUXFER_OK:
            self.library.luxfer_release(out)

    def add_up(self, seed: int, rng: random.Random) -> None:
        """Merges a damaged part of a rendering with an intact one."""
        from luxfer import _params

        Path(self.other).write_bytes(damaged_bytes(self.part, rng))
        handle, start = self.merge.handle, time.monotonic()
        for path in (self.whole, self.other):
            status = self.library.luxfer_render_add_part(handle, path.encode())
            check(seed, status, start)
        if status == abi.LUXFER_OK:
            job = ctypes.POINTER(abi.luxfer_job)()
            settings = _params.fill(abi.luxfer_render_params, self.size, [])
            status = self.library.luxfer_render_start_merge(handle, ctypes.byref(settings), ctypes.byref(job))
            check(seed, status, start)
            if status == abi.LUXFER_OK:
                outcome = ctypes.c_int32()
                wait = self.library.luxfer_job_wait
                check(seed, wait(job, -1, abi.luxfer_progress_fn(), None, ctypes.byref(outcome)), start)
                check(seed, outcome.value, start)
                self.library.luxfer_release(job)
        self.library.luxfer_render_clear_parts(handle)

    def parse_text(self, seed: int, rng: random.Random) -> None:
        which = rng.randrange(2)
        text = "".join(rng.choice(SYMBOLS[which]) + " " * (which and rng.random() < 0.5) for _ in range(rng.randint(0, 30)))
        start, handle = time.monotonic(), self.stages[which].handle
        if which == 0:
            self.library.luxfer_render_clear_expressions(handle)
            check(seed, self.library.luxfer_render_add_expression(handle, b"text", text.encode()), start)
        else:
            check(seed, self.library.luxfer_strokes_add_text(handle, text.encode()), start)

    def use(self, thing, is_scene: bool, seed: int) -> None:
        """Uses an object that was loaded from a damaged file, and releases it."""
        library = self.library
        if not is_scene:
            library.luxfer_release(thing)
            return
        rays = (abi.luxfer_ray * 2)()
        for ray, axis in zip(rays, (1, 2)):
            ray.origin[:] = (0.01, 0.5, 0.02)
            ray.direction[axis] = -1
            ray.t_max = 1e9
        needs = abi.luxfer_requirements()
        # A scene that loads may still be unfit for tracing: the calls may fail, but only with a status.
        start = time.monotonic()
        check(seed, library.luxfer_scene_intersect(thing, rays, 2, 0, (abi.luxfer_hit * 2)(), 0), start)
        check(seed, library.luxfer_scene_get_requirements(thing, 0.01, ctypes.byref(needs), ctypes.sizeof(needs)), start)
        check(seed, library.luxfer_scene_export_memory(thing, abi.luxfer_write_fn(lambda user, data, size: 0), None), start)
        library.luxfer_release(thing)


def load(first: int, count: int, journal: str) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    loader = Loader()
    with open(journal, "w") as out:
        for seed in range(first, first + count):
            out.seek(0)
            out.write(f"{seed:12}\n")
            out.flush()
            loader.load(seed)


def run(first: int, count: int) -> str | None:
    """Loads the files of `count` seeds from `first` in a child process; returns a description of the failure, or
    None."""
    with tempfile.TemporaryDirectory() as folder:
        journal = Path(folder, "journal")
        command = [sys.executable, Path(__file__).resolve(), str(first), str(count), journal]
        ran = subprocess.run(command, capture_output=True, text=True, cwd=folder)
        if ran.returncode == 0:
            return None
        seed = journal.read_text().strip() if journal.exists() else "none"
        return f"seed {seed}: the process ended with {ran.returncode}: {ran.stderr[-2000:]}"


def main() -> int:
    parser = argparse.ArgumentParser(description="loads damaged files")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("rest", nargs="*")
    asked = parser.parse_args()
    if asked.seconds is None:
        load(int(asked.rest[0]), int(asked.rest[1]), asked.rest[2])
        return 0
    end, seed, found = time.monotonic() + asked.seconds, 1, 0
    while time.monotonic() < end:
        if why := run(seed, 500):
            found += 1
            print(why, flush=True)
        seed += 500
    print(f"{seed - 1} files, {found} failures")
    return found > 0


if __name__ == "__main__":
    sys.exit(main())
