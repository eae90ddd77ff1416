"""Logging each text once, and from threads that must not wait."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

log = logging.getLogger("robowidgets")

MOST_LOGGED = 50
"""The number of different texts that one logger writes. A faulty source must not fill the log."""


class LogOnce:
    """Logs each text once, and `MOST_LOGGED` texts at most.

    Args:
        log: writes a text, such as ``log.exception``.
    """

    def __init__(self, log: Callable[..., object]) -> None:
        self._log = log
        self._logged: set[str] = set()

    def __call__(self, text: str, key: str = "", **options: Any) -> None:
        """Log a text with options, such as ``exc_info=``, unless it, or one with the same key, was logged before."""
        if (key or text) not in self._logged and len(self._logged) < MOST_LOGGED:
            self._logged.add(key or text)
            self._log(text, **options)


def log_in_thread(text: str, error: BaseException | None = None) -> None:
    """Log a text, with the traceback of an error if there is one, in a thread of its own.

    For threads that carry speeds: a handler of the log may hang, and zero must be sent all the same.
    """
    call_in_thread(partial(log.error, text, exc_info=error))


def call_in_thread(write: Callable[[], object]) -> None:
    """Call a function that writes a line, and may hang, in a thread of its own."""
    try:
        threading.Thread(target=write, name="robowidgets-log", daemon=True).start()
    except RuntimeError:  # Python 3.12 starts no thread at the end of the process
        write()
