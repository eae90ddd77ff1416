"""A call that many threads may request and one thread at a time carries out."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable

from . import clock
from .clock import Detached, Scheduler

log = logging.getLogger("robowidgets")


class CoalescedCall:
    """Runs a function in one thread at a time, without a lock, and again after every request.

    A thread that calls it while another thread runs the function leaves a request and returns at once; the running
    thread then runs the function again. So no caller ever waits for another, and the last run sees the newest state.

    Args:
        function: the function. Its exceptions reach the thread that runs it.
        thread: the name of a thread, for a function that takes long or runs code of a user. If the main thread calls
            the function, it runs there, so that a cell sees its result; else in a thread of this name, which ends with
            the run. If empty, the function runs in the thread that calls it.
        scheduler: starts that thread.
    """

    def __init__(self, function: Callable[[], object], *, thread: str = "", scheduler: Scheduler | None = None) -> None:
        self._function, self._thread, self._scheduler = function, thread, scheduler
        self._lock = threading.Lock()
        self._running = self._requested = False

    def __call__(self) -> None:
        """Run the function now, or again in the thread that is running it."""
        if self._thread and threading.current_thread() is not threading.main_thread():
            self.later()
        else:
            self.here()

    def here(self) -> None:
        """Run the function in the calling thread, which is the user's: marimo runs cells in threads of their own."""
        self._request(self._run)

    def later(self) -> None:
        """Run the function in a thread of its own, or again in the thread that is running it."""
        self._request(self._start)

    def _request(self, run: Callable[[], object]) -> None:
        runs = False
        try:
            with self._lock:
                self._requested = True
                if self._running:
                    return
                runs = self._running = True
            run()
        except BaseException:
            if runs:
                self._running = False
            raise

    def _run(self) -> None:
        while self._take_request():
            self._function()

    def _start(self) -> None:
        scheduler = self._scheduler or clock.scheduler
        scheduler.start(self._run_in_thread, self._thread, runs_user_code=True)

    def _run_in_thread(self) -> None:
        try:
            self._run()
        except BaseException as error:
            self._running = False
            if not isinstance(error, Exception):
                raise
            log.exception("robowidgets: error in %s", self._thread)
        raise Detached

    def _take_request(self) -> bool:
        with self._lock:
            self._running, self._requested = self._requested, False
            return self._running
