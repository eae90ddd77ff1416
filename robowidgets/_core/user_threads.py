"""Threads that run functions of the user, which may never return."""

from __future__ import annotations

import sys
import threading
import traceback
from types import FrameType
from weakref import WeakSet

_abandoned: WeakSet[threading.Thread] = WeakSet()


def abandon(thread: threading.Thread) -> None:
    """Note that nobody waits for a thread any more: the function that it runs may finish, but not drive."""
    _abandoned.add(thread)


def is_abandoned() -> bool:
    """Whether the calling thread is abandoned."""
    return threading.current_thread() in _abandoned


def frames_of(thread: threading.Thread | None) -> list[tuple[FrameType, int]]:
    """The frames of a thread with their lines, outermost first; none where it does not run."""
    frame = sys._current_frames().get(thread.ident or 0) if thread is not None else None
    return [*traceback.walk_stack(frame)][::-1] if frame is not None else []
