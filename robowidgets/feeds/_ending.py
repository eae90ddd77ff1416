"""Closing what is open when the process ends: a robot may be driving."""

from __future__ import annotations

import atexit
import os
from typing import Protocol


class Closable(Protocol):
    """What can be closed; a feed."""

    def close(self) -> None:
        """Close it."""


still_open: set[Closable] = set()
"""What is closed at the end. A process that was forked off has none of it: the threads stay behind."""


def _close_all() -> None:
    for one in list(still_open):
        one.close()


atexit.register(_close_all)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=still_open.clear)
