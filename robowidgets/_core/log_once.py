"""Logging each text once."""

from __future__ import annotations

from collections.abc import Callable

MOST_LOGGED = 50
"""Different texts that one logger writes; a faulty source must not fill the log."""


class LogOnce:
    """Logs each text once, and `MOST_LOGGED` texts at most.

    Args:
        log: writes a text, such as ``log.exception``.
    """

    def __init__(self, log: Callable[[str], object]) -> None:
        self._log = log
        self._logged: set[str] = set()

    def __call__(self, text: str, key: str = "") -> None:
        """Log a text, unless it, or another one with the same key, was logged before."""
        if (key or text) not in self._logged and len(self._logged) < MOST_LOGGED:
            self._logged.add(key or text)
            self._log(text)
