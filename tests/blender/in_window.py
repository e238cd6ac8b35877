"""Runs in a Blender with a window, started by test_window.py, and prints results that test_window.py checks.

The transfer runs while the interface stays usable, Esc cancels it, Ctrl+Z removes the light and Shift+Ctrl+Z restores
it.
"""

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy  # noqa: E402
from window import STROKES, Steps, areas, draw_line, key, lay_out_window, load_photo, over, place, pointer, use  # noqa: E402

from luxfer_lighting import work  # noqa: E402


def run() -> Steps:
    yield from lay_out_window()
    _, view = areas()
    place("target-room")
    load_photo(300, 200)
    bpy.context.scene.luxfer.texels = 256
    for kind, lines in STROKES.items():
        for line in lines:
            draw_line(kind, *line)
    middle = view.x + view.width // 2, view.y + view.height // 2
    pointer("MOUSEMOVE", "NOTHING", middle)
    with over(view):
        bpy.ops.ed.undo_push(message="ready")
        bpy.ops.luxfer.transfer("INVOKE_DEFAULT")
    yield lambda: work.current().progress > 0
    began = time.monotonic()
    key("ESC", middle)
    yield lambda: work.current() is None
    print("cancelled", time.monotonic() - began, work.message, materials(), flush=True)

    yield 0.5  # time for the operator to notice the key
    with over(view):
        bpy.ops.luxfer.transfer("INVOKE_DEFAULT")
    longest, last = 0.0, time.monotonic()
    while work.current() is not None:
        yield 0.02
        now = time.monotonic()
        longest, last = max(longest, now - last), now
    print("pause", longest, work.message, flush=True)
    print("lit", materials(), flush=True)
    for name, shift in (("undone", False), ("redone", True), ("undone", False)):
        yield 0.5
        before = materials()
        key("Z", middle, ctrl=True, shift=shift)
        yield lambda: materials() != before
        print(name, materials(), flush=True)


def materials() -> int:
    return len(bpy.data.objects["Ceiling"].data.materials)


use(run(), seconds=240)
