"""Threads that do the newest work and give up what is out of date."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import luxfer

T = TypeVar("T")

#: How often the progress of a running job is looked at.
POLL_SECONDS = 0.01


class OutOfDate(Exception):
    """Newer work has arrived while this was being done."""


class Latest(Generic[T]):
    """A thread that calls `work` with the newest item; an item that is replaced before its turn is never seen.

    `work` calls `check` or `finish` now and then, which raise OutOfDate as soon as there is a newer item. What `work`
    raises otherwise is given to `failed`.
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
        """Replaces what waits or runs."""
        with self._changed:
            self._item = item
            if self._job is not None:
                self._job.cancel()
            self._changed.notify_all()

    def stop(self) -> None:
        """Gives up what waits or runs; the next item goes on."""
        with self._changed:
            self._item, self._stopped = None, True
            if self._job is not None:
                self._job.cancel()

    def close(self) -> None:
        """Ends the thread, after what runs has given up."""
        with self._changed:
            self._closed = True
            if self._job is not None:
                self._job.cancel()
            self._changed.notify_all()
        self._thread.join()

    def wait_idle(self, check: Callable[[], None]) -> None:
        """Waits until nothing waits or runs here; calls `check` meanwhile."""
        while True:
            check()
            with self._changed:
                if (self._item is None and not self._busy) or self._closed:
                    return
                self._changed.wait(POLL_SECONDS)

    @property
    def is_replaced(self) -> bool:
        """Whether what runs is out of date."""
        return self._item is not None or self._stopped or self._closed

    def check(self) -> None:
        """Raises OutOfDate if what runs is out of date."""
        if self.is_replaced:
            raise OutOfDate

    def finish(self, job: luxfer.Job[Any], seen: Callable[[float], None] | None = None) -> Any:
        """Waits for a job of the library and returns its result; cancels it if it gets out of date. `seen` gets the
        finished share."""
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
                        continue  # meanwhile: the next wait tells how
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
