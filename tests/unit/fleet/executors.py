"""Executors of the tests' own."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any


class Here:
    """Runs tasks in this process, and counts them.

    Args:
        breaks_after: number of tasks after which it breaks.
        gives_up: part of the path of a task that it gives up, as a cluster does if the task killed its workers.
    """

    def __init__(self, breaks_after: int | None = None, gives_up: str = "") -> None:
        self.ran: list[str] = []
        self._gives_up = gives_up
        self._breaks_after = breaks_after

    def submit(self, function: Callable[..., Any], task: bytes, path: str, longest: float) -> Future[Any]:
        future: Future[Any] = Future()
        if self._breaks_after is not None and len(self.ran) >= self._breaks_after:
            future.set_exception(BrokenProcessPool("a process ended abruptly"))
            return future
        if self._gives_up and self._gives_up in path:
            future.set_exception(RuntimeError("attempted to run it on 4 workers, which all died"))
            return future
        self.ran.append(path)
        future.set_result(function(task, path, longest))
        return future
