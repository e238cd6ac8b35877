"""Runs work in the background. A work is a generator that yields jobs of the library; it continues when a job has
succeeded.

A timer of Blender polls the running job, so the user interface stays responsive; the panels show the progress, and Esc
or the button cancels. Blender's data is accessed only on the main thread, between two jobs.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any, Protocol

import bpy
import luxfer

POLL_SECONDS = 0.05

_context: luxfer.Context | None = None
_current: Work | None = None
message = ""


def context() -> luxfer.Context:
    """The context of the library, created on first use."""
    global _context
    if _context is None:
        _context = luxfer.Context()
    return _context


class Step(Protocol):
    """A job of the library, or an object with its methods."""

    @property
    def finished(self) -> bool: ...
    def poll(self) -> tuple[float, bool]: ...
    def wait(self) -> Any: ...
    def cancel(self) -> None: ...


class Work:
    """A generator of jobs, their number, and a title."""

    def __init__(self, title: str, steps: Generator[Step, Any, None], count: int):
        self.title, self.steps, self.count = title, steps, count
        self.done = 0
        self.job: Step = next(steps)

    @property
    def progress(self) -> float:
        return min(1.0, (self.done + self.job.poll()[0]) / self.count)

    def advance(self) -> bool:
        """Continues with the next job if the running one has ended; returns False after the last one. Raises
        exceptions of the job and of the steps."""
        if not self.job.finished:
            return True
        self.job.wait()
        self.done += 1
        try:
            self.job = next(self.steps)
        except StopIteration:
            return False
        return True

    def stop(self) -> None:
        """Cancels the running job and waits until it has ended."""
        self.job.cancel()
        try:
            self.job.wait()
        except Exception:
            pass
        self.steps.close()


def current() -> Work | None:
    return _current


def start(title: str, make: Callable[[], tuple[Generator[Step, Any, None], int]]) -> None:
    """Starts a work. An error of its first step is raised here; later errors become the message in the panel."""
    global _current, message
    if _current is not None:
        raise RuntimeError(f"{_current.title} is still running")
    message = ""
    _current = Work(title, *make())
    if not bpy.app.timers.is_registered(step):
        bpy.app.timers.register(step, first_interval=POLL_SECONDS)


def step() -> float | None:
    """Function of the timer: returns the seconds until its next call, or None when the work is over."""
    global _current, message
    if _current is None:
        return None
    try:
        goes_on = _current.advance()
    except luxfer.errors.Cancelled:
        goes_on, message = False, "Cancelled"
    except Exception as error:  # shown in the panel, because a timer cannot pass on an exception
        goes_on, message = False, str(error)
    if not goes_on:
        _current.steps.close()
        _current = None
    redraw()
    return POLL_SECONDS if goes_on else None


def wait_until_done() -> None:
    """Waits until the work has ended; for scripts and for Blender without a user interface. Raises the error of a
    failed work."""
    while _current is not None:
        try:
            _current.job.wait()
        except Exception:
            pass  # step() handles the error
        step()
    if message:
        raise RuntimeError(message)


def cancel() -> None:
    """Cancels the current work."""
    global _current, message
    if _current is not None:
        work, _current = _current, None
        work.stop()
        message = "Cancelled"
        redraw()


def redraw(pictures: bool = False) -> None:
    """Redraws the panels and, with pictures, the Image Editors; but no 3D view, because that may take long."""
    for window in getattr(bpy.context.window_manager, "windows", ()):
        for area in window.screen.areas:
            if area.type in ("VIEW_3D", "IMAGE_EDITOR"):
                for region in area.regions:
                    if region.type == "UI" or (pictures and region.type == "WINDOW" and area.type == "IMAGE_EDITOR"):
                        region.tag_redraw()


class Background:
    """Base class of operators whose work comes from make(). Started in the user interface, they run in the background
    as modal operators, which receive Esc. Called from scripts, they return when the work is done."""

    title: str

    def make(self, context: bpy.types.Context) -> tuple[Generator[Step, Any, None], int]:
        """Returns the steps and the number of their jobs. Reads all of Blender's data that the work needs, because an
        undo may replace the data while a job runs."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _current is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            start(self.title, lambda: self.make(context))
            wait_until_done()
        except Exception as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background:
            return self.execute(context)
        try:
            start(self.title, lambda: self.make(context))
        except Exception as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if _current is None:
            if message:
                self.report({"WARNING" if message == "Cancelled" else "ERROR"}, message)
            return {"CANCELLED" if message else "FINISHED", "PASS_THROUGH"}  # pass the event on: it may be Ctrl+Z
        if event.type == "ESC":
            cancel()
        return {"PASS_THROUGH"}


class LUXFER_OT_cancel(bpy.types.Operator):
    """End the running work"""

    bl_idname = "luxfer.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _current is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        cancel()
        return {"FINISHED"}


def register() -> None:
    bpy.utils.register_class(LUXFER_OT_cancel)


def unregister() -> None:
    global _context
    cancel()
    if bpy.app.timers.is_registered(step):
        bpy.app.timers.unregister(step)
    bpy.utils.unregister_class(LUXFER_OT_cancel)
    if _context is not None:
        _context.close()
        _context = None
