"""Tests the add-on in a Blender with a window; skipped without Xvfb or Blender (BLENDER names its program; default:
`blender`)."""

import os
import unittest
from pathlib import Path

import xvfb

#: Seconds: a user would call it a hang. What other programs do at the same time is in it.
HANG = 2


class Window(unittest.TestCase):
    def test_the_interface_stays_free_and_keys_cancel_and_undo(self):
        if reason := xvfb.missing():
            self.skipTest(reason)
        done = xvfb.run(Path(__file__).with_name("in_window.py"), Path(os.environ["LUXFER_LIBRARY"]))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        said = [line.split() for line in done.stdout.splitlines()]
        said = [words for words in said if words and words[0] in ("cancelled", "pause", "lit", "undone", "redone")]
        self.assertEqual([words[0] for words in said], ["cancelled", "pause", "lit", "undone", "redone", "undone"])
        (_, seconds, *cancelled), (_, pause, *message), *counts = said
        print(f"cancelled after {float(seconds):.2f} s, longest pause of the interface {float(pause):.2f} s")
        self.assertLess(float(seconds), HANG)
        self.assertEqual(cancelled, ["Cancelled", "1"])
        self.assertLess(float(pause), HANG)
        self.assertEqual(message, [])
        self.assertEqual([count for _, count in counts], ["2", "1", "2", "1"])


if __name__ == "__main__":
    unittest.main()
