"""Calling functions of a user, which may hang or raise, and which may be left behind."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, Protocol
from weakref import WeakMethod

from . import clock
from .clock import Left, Scheduler
from .user_function import line_of
from .user_threads import UserThread, frames_of

LINGER = 2.0
"""Seconds without anything to do after which the thread of a runner ends; the next wake starts another one."""


class Outcome(NamedTuple):
    """What a function returned, or raised."""

    value: Any
    error: BaseException | None


class Call(Protocol):
    """Calls a function of a user in a turn of a `Runner`; `of` becomes the runner's `current` meanwhile.

    Raises `Left` when the turn was left behind.
    """

    def __call__(self, function: Callable[..., Any], *args: Any, of: object) -> Outcome:
        """Call a function with arguments."""
        ...


class Runner:
    """Does one turn after another, in which functions of a user are called, one at a time.

    It has a thread while there is something to do. A function that does not return may be left: it goes on alone,
    another thread does the next turn, and whatever the function returns is not taken.

    Args:
        turn: does what is due, and calls functions by the `Call` that it gets; returns the time of the next turn, or
            None: when the runner is woken.
        lock: of the owner; it is held while the thread changes, not while functions run.
        name: of its threads.
        look: seconds between two looks at a turn that calls functions.
        on_look: called at each look, and once more when the turn is over.

    Attributes:
        current: what the running function belongs to; None while none runs.
    """

    def __init__(
        self,
        turn: Callable[[Call], float | None],
        lock: threading.RLock,
        name: str,
        *,
        look: float,
        on_look: Callable[[], object],
        scheduler: Scheduler | None = None,
    ) -> None:
        self._turn, self._lock, self._name = turn, lock, name
        self._look, self._on_look = look, on_look
        self._scheduler = scheduler or clock.scheduler
        self._now = self._scheduler.clock.now
        self._ticket: Any = None
        """Repeats the turn; None while there is nothing to do."""
        self._token: object = None
        """Changes with the ticket: a turn with another token was left."""
        self._is_woken = self._has_look = False
        self._began: float | None = None
        """When the first function of the turn that is under way was called."""
        self._idle_until = 0.0
        self.current: object = None

    @property
    def busy_for(self) -> float:
        """Seconds since the first function of the turn was called; 0 while none runs."""
        began = self._began
        return 0.0 if began is None else self._now() - began

    def where(self, function: Callable[..., Any]) -> str:
        """The line at which a running function is, as ``, line 12``; empty where it is not known."""
        ticket = self._ticket
        return line_of(function, frames_of(ticket)) if isinstance(ticket, threading.Thread) else ""

    def wake(self) -> None:
        """Have the next turn done."""
        with self._lock:
            self._is_woken = True
            if self._ticket is not None:
                self._ticket.wake()
                return
            self._idle_until = 0.0
            token = self._token = object()
            self._ticket = self._scheduler.start(partial(self._do, token), self._name)

    def leave(self) -> UserThread | None:
        """Go on without the turn that is under way; returns its thread if it is in a function, to be ended, else None.

        Called by a function in the turn itself, it does nothing: that turn goes on when the function returns.
        """
        with self._lock:
            left, is_in_function = self._ticket, self.current is not None
            if left is None or left is threading.current_thread():
                return None
            self._ticket = self._token = self._began = self.current = None
            left.leave()
            return left if is_in_function and isinstance(left, UserThread) else None

    def _do(self, token: object) -> float | None:
        """Do one turn; end the thread when there was none for a while."""
        self._is_woken = False
        try:
            when = self._turn(partial(self._call, token))
        finally:
            with self._lock:
                if self._token is token:
                    self._began = None
        with self._lock:
            if self._token is not token:
                raise Left
            if when is not None or self._is_woken:
                self._idle_until = 0.0
                return when if when is not None else self._now()
            now = self._now()
            self._idle_until = self._idle_until or now + LINGER
            if now < self._idle_until:
                return self._idle_until
            self._ticket = self._token = None
            raise Left

    def _call(self, token: object, function: Callable[..., Any], *args: Any, of: object) -> Outcome:
        with self._lock:
            if self._token is not token:
                raise Left
            if self._began is None:
                self._began = self._now()
                if not self._has_look:
                    self._has_look = True
                    self._look_later(self._began + self._look)
            self.current = of
        try:
            outcome = Outcome(function(*args), None)
        except BaseException as error:  # not even a SystemExit may end the thread that runs all functions
            outcome = Outcome(None, error)
        with self._lock:
            if self._token is not token:
                raise Left
            self.current = None
        return outcome

    def _look_later(self, when: float) -> None:
        """Look at a time, unless nobody refers to this runner any more: a timer keeps no closed feed alive."""
        look = WeakMethod(self._look_at)
        self._scheduler.call_at(when, lambda: (at := look()) and at())

    def _look_at(self) -> None:
        """Look at the turn that is under way. In the thread of the timers."""
        with self._lock:
            now, began = self._now(), self._began
            self._has_look = began is not None
            if began is not None:
                due = began + self._look
                self._look_later(due if due > now else now + self._look)
                if due > now:  # another turn than the one that the look was for
                    return
        self._on_look()
