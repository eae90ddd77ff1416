"""A call that many threads may request and one thread at a time carries out."""

from __future__ import annotations

import threading
from collections.abc import Callable


class CoalescedCall:
    """Runs a function in one thread at a time, without a lock, and once more after every request.

    A thread that calls it while another thread runs the function leaves a request and returns at once; the running
    thread then runs the function again. So no caller ever waits for another, and the last run sees the newest state.

    Args:
        function: the function; an exception reaches the thread that runs it.
    """

    def __init__(self, function: Callable[[], object]) -> None:
        self._function = function
        self._lock = threading.Lock()
        self._running = self._requested = False

    def __call__(self) -> None:
        """Run the function now, or have the thread that is running it do so again."""
        runs = False
        try:
            with self._lock:
                self._requested = True
                if self._running:
                    return
                runs = self._running = True
            while self._take_request():
                self._function()
        except BaseException:
            if runs:
                self._running = False
            raise

    def _take_request(self) -> bool:
        with self._lock:
            self._running, self._requested = self._requested, False
            return self._running
