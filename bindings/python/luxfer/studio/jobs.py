"""Threads that do the newest work and cancel outdated work."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import luxfer

T = TypeVar("T")

#: Interval in seconds at which a running job is polled.
POLL_SECONDS = 0.01


class OutOfDate(Exception):
    """A newer item has arrived while `work` ran."""


class Latest(Generic[T]):
    """A thread that calls `work` with the newest item; an item that is replaced while it waits is dropped.

    `work` must call `check` or `finish` often; they raise OutOfDate as soon as there is a newer item. All other
    exceptions of `work` are passed to `failed`.
    """

    def __init__(self, name: str, work: Callable[[T], None], failed: Callable[[Exception], None]):
        self._work, self._failed = work, failed
        self._item: T | None = None
        self._busy = self._closed = self._stopped = False
        self._job: luxfer.Job[Any] | None = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def put(self, item: T) -> None:
        """Passes on a new item. It replaces a waiting item and makes the running work outdated."""
        with self._changed:
            self._item = item
            if self._job is not None:
                self._job.cancel()
            self._changed.notify_all()

    def stop(self) -> None:
        """Discards a waiting item and makes the running work outdated; the next item is worked on as usual."""
        with self._changed:
            self._item, self._stopped = None, True
            if self._job is not None:
                self._job.cancel()

    def close(self) -> None:
        """Makes the running work outdated, waits until it has ended, and ends the thread."""
        with self._changed:
            self._closed = True
            if self._job is not None:
                self._job.cancel()
            self._changed.notify_all()
        self._thread.join()

    def wait_idle(self, check: Callable[[], None]) -> None:
        """Waits until no item waits or runs; calls `check` repeatedly meanwhile."""
        while True:
            check()
            with self._changed:
                if (self._item is None and not self._busy) or self._closed:
                    return
                self._changed.wait(POLL_SECONDS)

    @property
    def is_replaced(self) -> bool:
        """Whether the running work is outdated."""
        return self._item is not None or self._stopped or self._closed

    def check(self) -> None:
        """Raises OutOfDate if the running work is outdated."""
        if self.is_replaced:
            raise OutOfDate

    def finish(self, job: luxfer.Job[Any], seen: Callable[[float], None] | None = None) -> Any:
        """Waits for a job of the library and returns its result. Cancels the job and raises OutOfDate if the work
        becomes outdated. `seen` receives the finished share."""
        with self._changed:
            self._job = job
            if self.is_replaced:
                job.cancel()
        try:
            while True:
                try:
                    return job.wait(timeout=POLL_SECONDS)
                except luxfer.errors.NotReady:
                    if job.finished:
                        continue  # it has ended meanwhile: the next wait returns its outcome
                    if seen is not None:
                        seen(job.poll()[0])
        except luxfer.errors.Cancelled:
            raise OutOfDate from None
        finally:
            with self._changed:
                self._job = None

    def _run(self) -> None:
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._item is not None or self._closed)
                if self._closed:
                    return
                item, self._item, self._busy = self._item, None, True
                self._stopped = False
            try:
                self._work(item)  # type: ignore[arg-type]
            except OutOfDate:
                pass
            except Exception as failure:
                self._failed(failure)
