"""Child processes of a program that uses the library: forked, spawned and from a server, with pools and with exceptions."""

from __future__ import annotations

import gc
import multiprocessing
import os
import sys
import unittest
from concurrent.futures import ProcessPoolExecutor

from support import Case, context, demo

import luxfer

METHODS = [m for m in multiprocessing.get_all_start_methods() if m != "forkserver"]

#: Objects from before the fork; an imported copy of this module has none.
PARENT: dict[str, luxfer.Context | luxfer.Scene | luxfer.Job] = {}


def height_above(_: int) -> float:
    """A child's own work, with a context of its own."""
    with luxfer.Context(num_threads=2) as own:
        room = luxfer.Scene.demo(own, "target-room")
        return float(room.intersect([[2.7, 1.5, 4.0]], [[0, 1, 0]])[0]["t"])


def inherited() -> list[str]:
    """The exceptions of an inherited scene, context and job, which are then closed."""
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
    """What the C library itself says in a forked child, without the package's own check."""
    pointer = PARENT["room"]._pointer
    return [luxfer.library.luxfer_scene_retain(pointer), luxfer.library.luxfer_scene_release(pointer)]


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
        """Its interpreter closes them at the end."""
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
