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
        self._ends = 0
        self._taken: list[bool] = []
        """One for each end that a handler took."""

    def run(self) -> None:
        """See `threading.Thread`."""
        ident = threading.get_ident()
        try:
            super().run()
        except SystemExit:  # of `end`: it may come when what it was to end is over
            pass
        finally:
            _raise_in(ident, _NOTHING)  # the other one of two may be still to come
            with self._ending:
                self._is_over = True

    def abandon(self) -> None:
        """Note that nobody waits for it any more. A signal handler may call it."""
        self.is_abandoned = True

    def end(self) -> None:
        """Raise SystemExit in it: that ends a loop, though not one call that waits for something outside Python.

        Called again when a handler has taken the last one, as a bare ``except:`` does, it raises two: the other one as
        soon as a handler takes the first.
        """
        with self._ending:  # another thread may get the identifier of one that is over
            if self._is_over or self.ident is None or len(self._taken) < self._ends:
                return
            error = _told_to(self._taken.append, True)
            # In a browser errors are raised between two lines of the user's alone: so some come outside of a `try`.
            if self._ends and sys.platform != "emscripten":
                error = _told_to(_raise_in, self.ident, error)
            self._ends += 1
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self.ident), ctypes.py_object(error))


_NOTHING: Any = ctypes.py_object()

if sys.platform == "emscripten":

    def _raise_in(ident: int, error: Any) -> None:
        """Never two: none is still to come."""
else:
    _raise_in: Any = ctypes.PYFUNCTYPE(None, ctypes.c_ulong, ctypes.py_object)(
        ("PyThreadState_SetAsyncExc", ctypes.pythonapi)
    )
    """Raises an error in a thread, without a step of Python, after which one that is still to come would come."""


def _told_to(call: Callable[..., None], *args: Any) -> type[SystemExit]:
    """A SystemExit that calls a function when a handler gets it; one in C, as no Python is to run then."""
    return type("SystemExit", (SystemExit,), {"__init__": staticmethod(partial(call, *args))})


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
