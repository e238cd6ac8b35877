"""Work for many machines, on a Dask cluster: renderings by part, stylised animations by shot, relighting by target.

Needs `distributed` from PyPI (pip install luxfer[distributed]), here and on the workers. If a worker dies, Dask runs
its tasks again on other workers; the results are equal to the bit.

Scenes are not sent to the workers; each worker creates them itself. For this, the caller passes `prepare`: a function
of a module that the workers have too, or a functools.partial of one. It receives a Context and sets up the work in it,
once on each worker. `params` are the settings of the work, as keyword arguments.

    client = distributed.Client("scheduler:8786")
    with luxfer.Context() as context:
        size = {"width": 1920, "height": 1080}
        render = luxfer.distributed.render(client, view, context, columns=8, rows=4, samples=256, **size)
        render.write_exr("view.exr")
"""

from __future__ import annotations

import tempfile
import threading
import uuid
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from .context import Context
from .errors import Cancelled

if TYPE_CHECKING:
    from distributed import Client
    from typing_extensions import Unpack

    from .job import Progress
    from .relight import Relight
    from .render import Render
    from .types import RelightParams, RelightReport, RenderParams, RenderPart

Item = TypeVar("Item")
Result = TypeVar("Result")


def render(
    client: Client,
    prepare: Callable[[Context], Render],
    context: Context,
    *,
    columns: int = 4,
    rows: int = 4,
    ranges: int = 1,
    progress: Progress | None = None,
    **params: Unpack[RenderParams],
) -> Render:
    """Renders a view on the workers: divides the image into columns x rows rectangles, and the paths of each into
    ranges, then merges all parts here. The result equals a rendering on one machine. Use a few times more parts than
    workers. prepare returns a Render with its scene, camera and layers; if progress returns False, the work ends with
    errors.Cancelled."""
    here = prepare(context)
    parts = [here.split(columns, rows, ranges, index, **params) for index in range(columns * rows * ranges)]
    with tempfile.TemporaryDirectory() as folder:
        # Fetch each finished part at once, so that it is not lost if its worker dies.
        paths = [Path(folder, f"{index}.exr") for index in range(len(parts))]
        task = _Part(prepare, params)
        for done, (index, data) in enumerate(_as_completed(client, task, parts), 1):
            paths[index].write_bytes(data)
            if progress is not None and progress(done / (len(parts) + 1)) is False:
                raise Cancelled("the rendering was cancelled")
        here.start_merge(paths, **params).wait()
    if progress is not None:
        progress(1.0)
    return here


def stylise(client: Client, paint: Callable[[Context, Item], Result], shots: Iterable[Item]) -> list[Result]:
    """Paints shots on the workers. One worker paints all frames of a shot, as each frame continues the previous one.
    paint(context, shot) paints a shot and returns its result: arrays, or the names of the files that it has
    written."""
    return _all(client, _Shot(paint), list(shots))


def relight(
    client: Client,
    prepare: Callable[[Context], Relight],
    targets: Iterable[Sequence[float]],
    **params: Unpack[RelightParams],
) -> list[RelightReport]:
    """Solves a relighting for each target on the workers; a target is a mean radiance in cd/m² per channel. prepare
    returns a Relight with its scene. Returns the reports in the order of the targets."""
    return _all(client, _Target(prepare, params), [tuple(float(v) for v in target) for target in targets])


class _Task:
    """A task that is sent to a worker. Its result does not depend on the worker."""

    def __init__(self, work: Callable[..., Any], params: Any = None) -> None:
        self.work, self.params, self.key = work, params, uuid.uuid4().hex

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Task) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


class _Part(_Task):
    def __call__(self, part: RenderPart) -> bytes:
        stage, free = _prepared(self)
        with free, tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "part.exr")
            stage.start_part(path, part, **self.params).wait()
            return path.read_bytes()


class _Shot(_Task):
    def __call__(self, shot: Any) -> Any:
        return self.work(_context(), shot)


class _Target(_Task):
    def __call__(self, target: tuple[float, ...]) -> RelightReport:
        stage, free = _prepared(self)
        with free:
            stage.set_target(target)
            return cast("RelightReport", stage.run(**self.params).report)


@lru_cache(maxsize=1)
def _context() -> Context:
    """The context of a worker: one for all its tasks, with the number of threads of the worker."""
    from distributed import get_worker

    return Context(num_threads=get_worker().state.nthreads)


@lru_cache(maxsize=2)
def _prepared(task: _Task) -> tuple[Any, threading.Lock]:
    """The objects of a task, prepared once per worker. The worker processes one item at a time, with all threads."""
    return task.work(_context()), threading.Lock()


def _as_completed(client: Client, task: _Task, items: Sequence[Any]) -> Iterable[tuple[int, Any]]:
    """Results as they arrive, with their indices. If the caller stops, tasks that have not started are cancelled."""
    from distributed import as_completed

    futures = {client.submit(task, item, pure=False): index for index, item in enumerate(items)}
    try:
        for future, result in as_completed(list(futures), with_results=True):
            yield futures[future], result
            future.release()
    finally:
        client.cancel(list(futures))


def _all(client: Client, task: _Task, items: Sequence[Any]) -> list[Any]:
    results: list[Any] = [None] * len(items)
    for index, result in _as_completed(client, task, items):
        results[index] = result
    return results
