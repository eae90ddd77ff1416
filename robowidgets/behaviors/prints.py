"""What the threads of programs print."""

from __future__ import annotations

import sys
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

KEPT = 3
"""Lines that are kept."""

LONGEST = 200
"""Characters of a line that are kept."""


class Prints:
    """The last lines that a program printed, with their times.

    Attributes:
        lines: (seconds, text), oldest first.
    """

    def __init__(self) -> None:
        self.lines: deque[tuple[float, str]] = deque(maxlen=KEPT)
        self._rest = ""

    def add(self, text: str, seconds: float) -> None:
        """Add printed text, of which only whole lines are kept."""
        *whole, rest = (self._rest + text).split("\n")
        self._rest = rest[:LONGEST]
        self.lines.extend((seconds, line[:LONGEST]) for line in whole)


class _Router:
    """Stands in for ``sys.stdout``: passes on what is printed, and shows it to the program of the thread as well."""

    def __init__(self, inner: Any) -> None:
        self.inner = inner

    def write(self, text: str) -> int:
        """Write a text."""
        take = _takes.get(threading.get_ident())
        if take is not None and take(text):
            return len(text)
        written: int = self.inner.write(text)
        return written

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)


_takes: dict[int, Callable[[str], bool]] = {}
"""By thread: what takes its prints."""
_routers: deque[_Router] = deque(maxlen=50)
"""The last that were made, one for each stream. They stay, because ``print`` may hold no reference to ``sys.stdout``
while it writes there: one that went away meanwhile, when the last program ended, would take the process with it."""
_lock = threading.Lock()


def capture(take: Callable[[str], bool]) -> None:
    """Pass what the calling thread prints to a function; it returns whether nothing else is to show it.

    IPython and pytest replace ``sys.stdout`` at any time; so this looks again each time that it is called.
    """
    with _lock:
        _takes[threading.get_ident()] = take
        if not isinstance(sys.stdout, _Router):
            sys.stdout = _router_of(sys.stdout)


def release() -> None:
    """Pass on nothing of the calling thread any more. After the last thread, ``sys.stdout`` is what it was."""
    with _lock:
        _takes.pop(threading.get_ident(), None)
        if not _takes and isinstance(sys.stdout, _Router):
            sys.stdout = sys.stdout.inner


def _router_of(stream: Any) -> _Router:
    for router in _routers:
        if router.inner is stream:
            return router
    _routers.append(_Router(stream))
    return _routers[-1]
