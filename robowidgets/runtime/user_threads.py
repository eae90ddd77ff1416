"""Threads that run functions of the user, which may never return."""

from __future__ import annotations

import ctypes
import sys
import threading
import traceback
from collections.abc import Callable
from functools import partial
from types import FrameType
from typing import Any


class MayDrive:
    """A function of the user that may drive robots.

    Attributes:
        driven: the senders of speeds to the robots that it drove, or tried to.
        refused: the reason why it may not drive, or empty if it may.
    """

    def __init__(self) -> None:
        self.driven: tuple[Any, ...] = ()
        self.refused = ""

    def drive_by(self, call: Callable[..., Any], *args: Any) -> Any:
        """Call a function; `why_refused` attributes its speeds to this object."""
        _here.function = self
        try:
            return call(*args)
        finally:
            _here.function = None


_here = threading.local()
"""The ``function`` that each thread runs."""


class UserThread(threading.Thread):
    """A thread that runs functions of the user.

    Args:
        target: the function to run.
        name: its name.

    Attributes:
        is_abandoned: True once nothing waits for it any more. Its function may finish, but not drive.
    """

    def __init__(self, target: Callable[[], None], name: str) -> None:
        super().__init__(target=target, name=name, daemon=True)
        self.is_abandoned = False
        self._ending = threading.Lock()
        self._is_over = False
        self._ends = 0
        self._taken: list[bool] = []
        """One item for each SystemExit that a handler caught."""

    def run(self) -> None:
        """See `threading.Thread`."""
        ident = threading.get_ident()
        try:
            super().run()
        except SystemExit:  # from `end`: it may come after the function is over
            pass
        finally:
            _raise_in(ident, _NOTHING)  # the second of two may still be pending
            with self._ending:
                self._is_over = True

    def abandon(self) -> None:
        """Note that nothing waits for it any more. A signal handler may call this."""
        self.is_abandoned = True

    def end(self) -> None:
        """Raise SystemExit in it. That ends a loop, but not a call that waits outside Python.

        If a handler has caught the last one, as a bare ``except:`` does, the next call raises two: the second as soon
        as a handler catches the first.
        """
        with self._ending:  # a new thread may reuse the identifier of a thread that is over
            if self._is_over or self.ident is None or len(self._taken) < self._ends:
                return
            error = _told_to(self._taken.append, True)
            # In a browser errors are raised only between two lines of the user, so some come outside of a `try`.
            if self._ends and sys.platform != "emscripten":
                error = _told_to(_raise_in, self.ident, error)
            self._ends += 1
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self.ident), ctypes.py_object(error))


_NOTHING: Any = ctypes.py_object()

if sys.platform == "emscripten":

    def _raise_in(ident: int, error: Any) -> None:
        """Do nothing: there are never two, so the second is never pending."""
else:
    _raise_in: Any = ctypes.PYFUNCTYPE(None, ctypes.c_ulong, ctypes.py_object)(
        ("PyThreadState_SetAsyncExc", ctypes.pythonapi)
    )
    """Raises an error in a thread without a step of Python, after which a pending error would be raised."""


def _told_to(call: Callable[..., None], *args: Any) -> type[SystemExit]:
    """Return a SystemExit that calls a function when a handler catches it. It is in C: no Python may run then."""
    return type("SystemExit", (SystemExit,), {"__init__": staticmethod(partial(call, *args))})


def is_abandoned() -> bool:
    """Return True if the calling thread is abandoned."""
    thread = threading.current_thread()
    return isinstance(thread, UserThread) and thread.is_abandoned


def why_refused(driven: Any) -> str:
    """Return why the calling thread may not drive a robot, or empty if it may; note that its function drives the robot.

    Args:
        driven: the sender of speeds to the robot.
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
    """Return the frames of a thread with their lines, outermost first; an empty list if it does not run."""
    frame = sys._current_frames().get(thread.ident or 0) if thread is not None else None
    return [*traceback.walk_stack(frame)][::-1] if frame is not None else []
