"""Tests child processes of a program that uses the library: forked, spawned, from a fork server, and in process
pools."""

from __future__ import annotations

import gc
import multiprocessing
import os
import subprocess
import sys
import unittest
from concurrent.futures import ProcessPoolExecutor

from support import PACKAGE, Case, context, demo

import luxfer

METHODS = [m for m in multiprocessing.get_all_start_methods() if m != "forkserver"]

#: Objects from before the fork; an imported copy of this module has none.
PARENT: dict[str, luxfer.Context | luxfer.Scene | luxfer.Job] = {}


def height_above(_: int) -> float:
    """Work of a child process with a context of its own: the height of the ceiling above a point."""
    with luxfer.Context(num_threads=2) as own:
        room = luxfer.Scene.demo(own, "target-room")
        return float(room.intersect([[2.7, 1.5, 4.0]], [[0, 1, 0]])[0]["t"])


def inherited() -> list[str]:
    """Uses a scene, a context and a job of the parent; returns the names of the exceptions, then closes the
    objects."""
    room, job, parent = PARENT["room"], PARENT["job"], PARENT["context"]
    assert isinstance(room, luxfer.Scene) and isinstance(job, luxfer.Job) and isinstance(parent, luxfer.Context)
    found = []
    for use in (room.requirements, job.wait, job.cancel, lambda: luxfer.Scene(parent), lambda: parent.last_error()):
        try:
            use()
            found.append("")
        except luxfer.errors.InvalidOperation as error:
            found.append(str(error))
    for thing in (room, job, parent):
        thing.close()
    PARENT.clear()
    gc.collect()
    return found


def below_the_package() -> list[int]:
    """The statuses of C functions for the parent's scene in a forked child, without the check of the package."""
    pointer = PARENT["room"]._pointer
    return [luxfer.library.luxfer_retain(pointer), luxfer.library.luxfer_release(pointer)]


#: Work of one interpreter. It uses only the C library, because numpy cannot be imported by a second interpreter.
SUBINTERPRETER = """
import ctypes
lib = ctypes.CDLL({library!r})
def pointer(kind, *arguments):
    made = ctypes.c_void_p()
    status = kind(*arguments, ctypes.byref(made))
    assert status == 0, (kind.__name__, status)
    return made
context = pointer(lib.luxfer_context_create, None)
scene = pointer(lib.luxfer_demo_create_scene, context, 0)
render = pointer(lib.luxfer_render_create, context)
assert lib.luxfer_render_set_scene(render, scene) == 0
calls = []
Progress = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_double)
for round in range({rounds}):
    job = pointer(lib.luxfer_render_start, render, None)
    progress = Progress(lambda user, fraction: calls.append(fraction) or len(calls) % 3 == 0)
    outcome = ctypes.c_int32()
    assert lib.luxfer_job_wait(job, ctypes.c_int32(-1), progress, None, ctypes.byref(outcome)) == 0
    assert outcome.value in (0, 6)
    assert lib.luxfer_job_cancel(job) == 0 and lib.luxfer_release(job) == 0
for handle in (render, scene, context):
    assert lib.luxfer_release(handle) == 0
"""

#: A program that runs three interpreters at once, each in its own thread.
INTERPRETERS = """
import sys, threading
import _xxsubinterpreters as interpreters
failed = []
def work(code):
    interpreter = interpreters.create()
    try:
        interpreters.run_string(interpreter, code)
    except Exception as error:
        failed.append(repr(error))
    interpreters.destroy(interpreter)
threads = [threading.Thread(target=work, args=(sys.argv[1],)) for _ in range(3)]
[t.start() for t in threads], [t.join() for t in threads]
exec(sys.argv[1])  # the first interpreter goes on
print(failed or "ended")
"""


class Subinterpreters(Case):
    def test_interpreters_of_one_process_use_the_library_at_once(self) -> None:
        try:
            __import__("_xxsubinterpreters")
        except ImportError:
            self.skipTest("this Python has no interpreters by that name")
        code = SUBINTERPRETER.format(library=luxfer.library._name, rounds=2)
        program = [sys.executable, "-c", INTERPRETERS, code]
        ended = subprocess.run(program, capture_output=True, text=True, timeout=300)
        self.assertEqual((ended.returncode, ended.stdout.strip(), ended.stderr), (0, "ended", ""))

    def test_the_package_in_a_second_interpreter(self) -> None:
        """The import works, or fails because of numpy; the process continues in both cases."""
        code = f"import sys; sys.path.insert(0, {str(PACKAGE)!r})\nimport luxfer\nluxfer.Context(num_threads=1).close()"
        program = f"""
import _xxsubinterpreters as interpreters
{code}
second = interpreters.create()
try:
    interpreters.run_string(second, {code!r})
    print("worked")
except interpreters.RunFailedError as error:
    print("ImportError" if "ImportError" in str(error) or "numpy" in str(error) else error)
interpreters.destroy(second)
luxfer.Context(num_threads=1).close()
"""
        environment = {**os.environ, "LUXFER_LIBRARY": luxfer.library._name}
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300, env=environment)
        if "_xxsubinterpreters" in ended.stderr:
            self.skipTest("this Python has no interpreters by that name")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertIn(ended.stdout.strip(), ("worked", "ImportError"))


class Processes(Case):
    def setUp(self) -> None:
        super().setUp()
        render = luxfer.Render(context(), luxfer.Scene.demo(context(), "target-room"))
        self.job = render.start(width=64, height=64, samples=1 << 20)
        PARENT.update(context=context(), room=luxfer.Scene.demo(context(), "target-room"), job=self.job)
        self.addCleanup(PARENT.clear)

    def tearDown(self) -> None:
        self.job.cancel()
        self.assertRaises(luxfer.errors.Cancelled, self.job.wait)

    def pool(self, method: str) -> ProcessPoolExecutor:
        pool = ProcessPoolExecutor(2, mp_context=multiprocessing.get_context(method))
        self.addCleanup(pool.shutdown)
        return pool

    def test_children_work_with_contexts_of_their_own(self) -> None:
        here = height_above(0)
        for method in METHODS:
            with self.subTest(method):
                self.assertEqual(list(self.pool(method).map(height_above, range(4), timeout=120)), [here] * 4)

    @unittest.skipUnless("fork" in METHODS, "this system cannot fork")
    def test_a_forked_child_cannot_use_objects_of_its_parent(self) -> None:
        found = self.pool("fork").submit(inherited).result(timeout=60)
        self.assertEqual(len(found), 5)
        for message in found:
            self.assertIn("before the process was forked", message)

    @unittest.skipUnless("fork" in METHODS, "this system cannot fork")
    def test_the_library_itself_refuses_in_a_forked_child(self) -> None:
        statuses = self.pool("fork").submit(below_the_package).result(timeout=60)
        self.assertEqual(statuses, [luxfer.types.Status.INVALID_OPERATION, luxfer.abi.LUXFER_OK])

    @unittest.skipUnless(hasattr(os, "fork"), "this system cannot fork")
    def test_a_forked_child_ends_quietly_with_objects_of_its_parent(self) -> None:
        """The child's interpreter closes the inherited objects when it exits."""
        path = self.folder / "stderr"
        sys.stderr.flush()
        child = os.fork()
        if child == 0:
            with path.open("wb") as file:
                os.dup2(file.fileno(), 2)
            PARENT.clear()
            demo.cache_clear()
            gc.collect()
            os._exit(0)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        self.assertEqual(path.read_bytes(), b"")


if __name__ == "__main__":
    unittest.main()
