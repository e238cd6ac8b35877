"""Tests that whatever a host calls, it gets a status and a message and survives: every function of the C ABI with each
argument wrong in turn, and random programs. `play.py` plays more random programs, for any time."""

import unittest

import busy
import faults
import files
import scenarios
import soak
from play import play, report
from script import FUNCTIONS

USUAL = scenarios.programs()


class Conformance(unittest.TestCase):
    def check(self, programs, threads=1, seed="fault"):
        if failure := play(programs, threads):
            self.fail(report(programs[failure.program], failure, threads, seed))

    def test_scenarios_call_every_function(self):
        called = {call[0] for calls in USUAL.values() for call in calls}
        self.assertEqual(set(FUNCTIONS) - called, set(), "write scenarios for them")
        self.check(list(USUAL.values()))

    def test_every_argument_of_every_function_may_be_wrong(self):
        for name, calls in USUAL.items():
            with self.subTest(name):
                self.check([faults.every_fault(calls)], seed=name)

    def test_calls_may_come_in_any_order(self):
        self.check([faults.random_program(USUAL, seed) for seed in range(30)])

    def test_calls_may_come_from_several_threads(self):
        self.check([faults.random_program(USUAL, seed) for seed in range(1000, 1020)], threads=3)

    def test_calls_never_wait_for_a_job_that_runs(self):
        for seed in (3032, 3038, 3055, 3057, 3073):  # seeds of programs that seldom wait for jobs
            with self.subTest(seed):
                slowest = max(busy.delays(faults.random_program(USUAL, seed), seed))
                self.assertLess(slowest.seconds, busy.LIMIT, slowest)

    def test_damaged_files_are_errors(self):
        self.assertIsNone(files.run(1, 700))

    def test_long_use_leaves_nothing_behind(self):
        use = soak.Soak()
        for what, cycles in ((use.cancel, 500), (use.transfer, 40)):
            with self.subTest(what.__name__):
                self.assertIsNone(soak.growth(use.repeat(what, cycles)))


if __name__ == "__main__":
    unittest.main()
