"""Jobs: long work with progress, timeouts and cancelling, also by Ctrl-C."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

from . import _abi
from ._handle import Handle, call
from ._pointers import POINTER
from .errors import Error, error
from .types import Status

if TYPE_CHECKING:
    from .context import Context

T = TypeVar("T")

#: A progress function. It receives the finished share, which rises from 0 and is exactly 1 after success. If it
#: returns False, the job is cancelled.
Progress = Callable[[float], Any]

#: Milliseconds of each call that waits for a job; between calls, Python handles its signals, such as Ctrl-C.
SLICE_MS = 20

NO_PROGRESS = _abi.luxfer_progress_fn()


class Job(Handle, Generic[T]):
    """Work in progress. wait() returns the object on which the job runs. Closing the last reference to a job cancels
    it.

    >>> seen = []
    >>> stage = DemoPhoto(context).start(width=48, height=32, samples=2).wait(seen.append)
    >>> seen == sorted(seen) and seen[-1] == 1.0
    True
    """

    kind = "job"
    _owner: T

    @classmethod
    def _of(cls, owner: T, context: Context, pointer: Any) -> Job[T]:
        out = cls._adopt(context, pointer)
        out._owner = owner
        return out

    def wait(self, progress: Progress | None = None, timeout: float | None = None) -> T:
        """Waits until the job has ended; other Python threads run meanwhile. After `timeout` seconds it raises
        NotReady, and the job continues. An exception during the wait, from progress or by Ctrl-C, cancels the job,
        waits until it has ended, and is raised again."""
        end = None if timeout is None else time.monotonic() + timeout
        last_reported = -1.0
        try:
            while True:
                left = SLICE_MS if end is None else max(0, min(SLICE_MS, round(1000 * (end - time.monotonic()))))
                outcome = self._wait(left)
                if outcome != Status.NOT_READY:
                    break
                if end is not None and time.monotonic() >= end:
                    break
                fraction = min(self._progress(), 1 - 2.0**-52)  # only success is exactly 1
                if progress is not None and fraction > last_reported:
                    last_reported = fraction
                    if progress(fraction) is False:
                        self.cancel()
        except BaseException:
            self._stop()
            raise
        if outcome == Status.NOT_READY:
            raise error(outcome, f"the job still runs after {timeout} seconds; wait for it again")
        if outcome != Status.OK:
            raise error(outcome, self._context.last_error())
        if progress is not None:
            progress(1.0)
        return self._result()

    def _result(self) -> T:
        return self._owner

    def _stop(self) -> None:
        """Cancels the job and waits for its end, so that it does not keep running after an exception."""
        if not self._pointer:
            return
        self.cancel()
        while not self.finished:
            time.sleep(0.002)

    def poll(self) -> tuple[float, bool]:
        """The finished share, and whether the job has ended, with or without success."""
        fraction, outcome = self._progress(), self.outcome
        # It may have succeeded since the first call.
        return 1.0 if outcome == Status.OK else fraction, outcome != Status.NOT_READY

    def _progress(self) -> float:
        fraction = ctypes.c_double()
        self._call("get_progress", fraction)
        return fraction.value

    def _wait(self, milliseconds: int) -> Status:
        """Waits for at most a time; returns the outcome."""
        outcome = ctypes.c_int32()
        self._call("wait", milliseconds, NO_PROGRESS, None, outcome)
        return Status(outcome.value)

    @property
    def finished(self) -> bool:
        """Whether the job has ended, with or without success."""
        return self.outcome != Status.NOT_READY

    @property
    def outcome(self) -> Status:
        """The status with which the job has ended; Status.NOT_READY while it runs."""
        return self._wait(0)

    def cancel(self) -> None:
        """Asks the job to end early, which takes at most about 100 ms. Any thread may call it."""
        self._call("cancel")

    def __exit__(self, *_: Any) -> None:
        self._stop()
        self.close()


class _Outcome(Generic[T]):
    """Stores the value that a function returned, or the exception that it raised."""

    returned: T
    raised: BaseException | None = None

    def take(self, work: Callable[[], T]) -> int:
        try:
            self.returned = work()
        except BaseException as raised:
            self.raised = raised
            return int(raised.status if isinstance(raised, Error) else Status.UNKNOWN)
        return int(Status.OK)


class Task(Job[T]):
    """Runs a function of yours as a job: for calls that have no job of their own, such as reading and writing files.

    When the job is cancelled, the calls of the library that the function makes with objects of the context end early.
    wait() returns the value that the function returns, or raises the exception that it raises.

    >>> task = Task(context, lambda: Image(context, [[0.25, 1.0]]).size)
    >>> task.wait()
    (2, 1, 1)
    """

    def __init__(self, context: Context, work: Callable[[], T]) -> None:
        outcome = _Outcome[T]()
        # The callback refers to the outcome and not to this job: a cycle of references would delay the job's end until
        # the garbage collector runs.
        self._outcome, self._run = outcome, _abi.luxfer_work_fn(lambda _: outcome.take(work))
        pointer = POINTER(_abi.luxfer_job)()
        call(context, "luxfer_job_start", context, self._run, None, pointer)
        self._context, self._pointer = context, pointer

    def wait(self, progress: Progress | None = None, timeout: float | None = None) -> T:
        """Waits for the function, as Job.wait."""
        try:
            return super().wait(progress, timeout)
        except Error:
            if self._outcome.raised is not None and self.finished:
                raise self._outcome.raised from None
            raise

    def _result(self) -> T:
        return self._outcome.returned


class StageBase(Handle):
    """The base class of the stages: start() starts a job, run() also waits for it."""

    def __init__(self, context: Context) -> None:
        self._create(context)

    def _job(self: T, verb: str, *arguments: Any) -> Job[T]:
        handle = cast(Handle, self)
        pointer = POINTER(_abi.luxfer_job)()
        handle._call(verb, *arguments, pointer)
        return Job._of(self, handle._context, pointer)
