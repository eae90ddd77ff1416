"""Time in tests: waiting for a condition, for events in other threads, and a clock that stands still."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from types import SimpleNamespace


class Clock(SimpleNamespace):
    """Replaces the module `time`: a clock that stands still until it is set."""

    def __init__(self) -> None:
        super().__init__(now=100.0, monotonic=lambda: self.now)


def wait_for(condition: Callable[[], object], what: str, seconds: float = 240.0, *, every: float = 0.002) -> None:
    """Return once the condition holds; fail by name if it never does. An expensive condition is tried less often."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"waited {seconds:g} s in vain until {what}"
        time.sleep(every)


def threads_named(name: str) -> int:
    """The number of living threads of this name. The count of all also falls when another test's thread ends."""
    return sum(thread.name == name for thread in threading.enumerate())
