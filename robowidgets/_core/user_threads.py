"""Threads that run functions of the user, which may never return."""

from __future__ import annotations

import ctypes
import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Any


class MayDrive:
    """A function of the user, as far as it drives robots.

    Attributes:
        driven: what sends speeds to the robots that it drove, or tried to.
        refused: why it may not drive; empty if it may.
    """

    def __init__(self) -> None:
        self.driven: tuple[Any, ...] = ()
        self.refused = ""

    def drive_by(self, call: Callable[..., Any], *args: Any) -> Any:
        """Call a function, whose speeds `why_refused` takes for those of this one."""
        _here.function = self
        try:
            return call(*args)
        finally:
            _here.function = None


_here = threading.local()
"""By thread: the ``function`` that it runs."""


class UserThread(threading.Thread):
    """A thread that runs functions of the user.

    Args:
        target: what it runs.
        name: its name.

    Attributes:
        is_abandoned: whether nobody waits for it any more: what it runs may finish, but not drive.
    """

    def __init__(self, target: Callable[[], None], name: str) -> None:
        super().__init__(target=target, name=name, daemon=True)
        self.is_abandoned = False
        self._ending = threading.Lock()
        self._is_over = False

    def run(self) -> None:
        """See `threading.Thread`."""
        try:
            with suppress(SystemExit):  # of `end`: it may come when what it was to end is over
                super().run()
        finally:
            with self._ending:
                self._is_over = True

    def abandon(self) -> None:
        """Note that nobody waits for it any more. A signal handler may call it."""
        self.is_abandoned = True

    def end(self) -> None:
        """Raise SystemExit in it: that ends a loop, though not one call that waits for something outside Python."""
        with self._ending:  # another thread may get the identifier of one that is over
            if not self._is_over and self.ident is not None:
                ident, error = ctypes.c_ulong(self.ident), ctypes.py_object(SystemExit)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ident, error)


def is_abandoned() -> bool:
    """Whether the calling thread is abandoned."""
    thread = threading.current_thread()
    return isinstance(thread, UserThread) and thread.is_abandoned


def why_refused(driven: Any) -> str:
    """Why the calling thread may not drive a robot, empty if it may; the function that it runs is known to drive then.

    Args:
        driven: what sends speeds to the robot.
    """
    if is_abandoned():
        return "this function was disconnected, replaced or ended while it was at work"
    function: MayDrive | None = getattr(_here, "function", None)
    if function is None:
        return ""
    if driven not in function.driven:
        function.driven = (*function.driven, driven)
    return function.refused


def frames_of(thread: threading.Thread | None) -> list[tuple[FrameType, int]]:
    """The frames of a thread with their lines, outermost first; none where it does not run."""
    frame = sys._current_frames().get(thread.ident or 0) if thread is not None else None
    return [*traceback.walk_stack(frame)][::-1] if frame is not None else []
