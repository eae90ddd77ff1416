"""Calls of functions of the user, which may hang or raise, and which can be detached."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from functools import partial
from math import inf
from typing import Any, NamedTuple, Protocol
from weakref import WeakMethod

from . import clock
from .clock import Detached, Scheduler
from .policies import Policy
from .user_function import line_of
from .user_threads import UserThread, frames_of

log = logging.getLogger("robowidgets")

LINGER = 2.0
"""Seconds without work after which the thread of a runner ends. The next wake starts another one."""

_ENDS = 20
"""The most attempts to end a detached function, one at each check: a bare ``except:`` in it may catch one."""

_ROUNDING = 1e-6
"""The rounding error of a sum of times, in seconds."""


class Outcome(NamedTuple):
    """The result of a function, or the error that it raised; and the seconds that do not count as run time."""

    value: Any
    error: BaseException | None
    unseen: float = 0.0


class Call(Protocol):
    """Calls a function of the user in a turn of a `Runner`; `of` is the runner's `current` meanwhile.

    Raises `Detached` if the turn was detached.
    """

    def __call__(self, function: Callable[..., Any], *args: Any, of: object) -> Outcome:
        """Call a function with arguments."""
        ...


class _Counted(NamedTuple):
    """The time of the last check, and the sums of the seconds that count as run time and of the other seconds.

    It is one value, so it can be read without a lock.
    """

    at: float
    seen: float
    unseen: float


class _DetachedThread(NamedTuple):
    thread: UserThread
    until: float
    """The run time at which it is ended, or forgotten."""
    ends: int
    """The number of attempts to end it that are left."""


class Runner:
    """Does one turn after another, in which functions of the user are called, one at a time.

    It has a thread while there is work. A function that does not return can be detached: it goes on alone, another
    thread does the next turn, and the result of the function is dropped.

    Args:
        turn: does the work that is due, and calls functions by the `Call` that it gets. It returns the time of the next
            turn, or None to wait until the runner is woken.
        lock: the lock of the owner. It is held while the thread changes, not while functions run.
        name: the name of its threads.
        policy: the time limits of the functions.
        on_look: called at each check of a turn that calls functions, and once more when the turn is over.
        looks: the name of a thread that checks all the time, from the first turn until the runner is at rest. If empty,
            the timer of the process checks while functions are called.

    Attributes:
        current: the owner of the running function, or None while no function runs.
        run: a new object for each thread of turns, or None without a thread.
        is_interrupted: True after `interrupt`, until `detach` is called.
    """

    def __init__(
        self,
        turn: Callable[[Call], float | None],
        lock: threading.RLock,
        name: str,
        policy: Policy,
        *,
        on_look: Callable[[], object],
        looks: str = "",
        scheduler: Scheduler | None = None,
    ) -> None:
        self._turn, self._lock, self._name, self._policy = turn, lock, name, policy
        self._on_look, self._looks = on_look, looks
        self._scheduler = scheduler or clock.scheduler
        self._now = self._scheduler.clock.now
        self._ticket: Any = None
        """Repeats the turn; None without work."""
        self.run: object = None
        self.is_interrupted = False
        self._is_woken = self._has_look = False
        self._counted = _Counted(self._now(), 0.0, 0.0)
        self._began: float | None = None
        """The run time at which the first function of the current turn was called."""
        self._detached: list[_DetachedThread] = []
        self._idle_until = 0.0
        self.current: object = None

    @property
    def is_at_work(self) -> bool:
        """True while turns are done, or awaited."""
        return self._ticket is not None

    @property
    def busy_for(self) -> float:
        """Seconds of run time since the first function of the turn was called; 0 while no function runs."""
        began = self._began
        return 0.0 if began is None else self._count_on().seen - began

    @property
    def is_late(self) -> bool:
        """True while the turn takes longer than its functions may."""
        return self.busy_for >= self._policy.late - _ROUNDING

    def where(self, function: Callable[..., Any]) -> str:
        """Return the line that a running function is at, as ``, line 12``; empty if it is not known."""
        ticket = self._ticket
        return line_of(function, frames_of(ticket)) if isinstance(ticket, threading.Thread) else ""

    def wake(self) -> None:
        """Do the next turn."""
        with self._lock:
            self._is_woken = True
            if self._ticket is not None:
                self._ticket.wake()
                return
            self._idle_until, self.is_interrupted = 0.0, False
            if self._looks:
                self._begin_looks()
            run = self.run = object()
            try:
                self._ticket = self._scheduler.start(partial(self._do, run), self._name, runs_user_code=True)
            except BaseException:  # an interrupt, after which the started turn could not be detached
                self.run = None
                raise

    def detach(self, *, even_if_current: bool = False) -> UserThread | None:
        """Detach the current turn; return its thread if it is in a function, else None.

        A call from a function in the turn itself does nothing: the turn goes on when the function returns. With
        ``even_if_current``, that turn is detached, too.
        """
        with self._lock:
            ticket, is_in_function = self._ticket, self.current is not None
            by_itself = ticket is threading.current_thread()
            if by_itself and not even_if_current:
                return None
            self._ticket = self.run = self._began = self.current = None
            self.is_interrupted = False
            if ticket is None:
                return None
            ticket.detach()
            if not isinstance(ticket, UserThread):
                return None
            if self._policy.grace < inf:
                until = self._count().seen + self._policy.grace
                self._detached.append(_DetachedThread(ticket, until, _ENDS if is_in_function and not by_itself else 0))
                self._begin_looks()
            return ticket if is_in_function else None

    def interrupt(self) -> bool:
        """Keep the current turn from driving, and do no further turn; return True if there is a current turn.

        For a signal handler: it takes no lock. The owner calls `detach` at the next check.
        """
        ticket = self._ticket
        if ticket is None:
            return False
        self.is_interrupted = True
        ticket.detach()
        return True

    # -- turns ---------------------------------------------------------------------------------------------------------

    def _do(self, run: object) -> float | None:
        """Do one turn; end the thread after a while without work."""
        with self._lock:
            self._check(run)
            self._is_woken = False
        try:
            when = self._turn(partial(self._call, run))
        finally:
            with self._lock:
                if self.run is run:
                    self._began = None
        with self._lock:
            self._check(run)
            if when is not None or self._is_woken:
                self._idle_until = 0.0
                return when if when is not None else self._now()
            now = self._now()
            self._idle_until = self._idle_until or now + LINGER
            if now < self._idle_until:
                return self._idle_until
            self._ticket = self.run = None
            raise Detached

    def _call(self, run: object, function: Callable[..., Any], *args: Any, of: object) -> Outcome:
        with self._lock:
            self._check(run)
            before = self._count()
            if self._began is None:
                self._began = before.seen
                self._begin_looks()
            self.current = of
        value, error = None, None
        try:
            value = function(*args)
        except BaseException as raised:  # not even a SystemExit may end the thread that runs all functions
            error = raised
        with self._lock:
            if self.run is run:
                self.current = None
            self._check(run)
            return Outcome(value, error, self._count().unseen - before.unseen)

    def _check(self, run: object) -> None:
        """Raise `Detached` in a turn that is detached."""
        if self.run is not run or self.is_interrupted:
            raise Detached

    # -- looks ---------------------------------------------------------------------------------------------------------

    def _count_on(self) -> _Counted:
        """Return the sums that a check would note now."""
        before, now, max_gap = self._counted, self._now(), self._policy.max_gap
        gap = now - before.at
        return _Counted(now, before.seen + min(gap, max_gap), before.unseen + max(0.0, gap - max_gap))

    def _count(self) -> _Counted:
        """Note and return the sums up to now. Called with the lock held."""
        self._counted = self._count_on()
        return self._counted

    def _begin_looks(self) -> None:
        """Start the checks unless they run. Called with the lock held."""
        if not self._has_look:
            if self._looks:
                self._scheduler.start(self._look_in_thread, self._looks)
            else:
                self._look_later(self._now() + self._policy.look)
            self._has_look = True

    def _look_later(self, when: float) -> None:
        """Check at a time, unless this runner is freed before: a timer must not keep a closed feed alive."""
        look = WeakMethod(self._look_by_timer)
        self._scheduler.call_at(when, lambda: (at := look()) and at())

    def _look_by_timer(self) -> None:
        when = self._look_at()
        if when is not None:
            self._look_later(when)

    def _look_in_thread(self) -> float:
        when = self._look_at()
        if when is None:
            raise Detached
        return when

    def _look_at(self) -> float | None:
        """Check the running functions, end long detached ones, and return the time of the next check, or None.

        Called in the thread of the checks or of the timers.
        """
        policy = self._policy
        with self._lock:
            now, seen, _ = self._count()
            over = [one for one in self._detached if one.until <= seen + _ROUNDING or not one.thread.is_alive()]
            self._detached = [one for one in self._detached if one not in over]
            for one in over:
                if one.ends and one.thread.is_alive():
                    one.thread.end()
                    self._detached.append(one._replace(until=seen + policy.look, ends=one.ends - 1))
            busy = policy.late if self._began is None else seen - self._began
            due = [policy.look, *(one.until - seen for one in self._detached)]
            if busy < policy.late - _ROUNDING:
                due.append(policy.late - busy)
            is_busy = self.is_at_work if self._looks else self._began is not None
            self._has_look = is_busy or bool(self._detached)
            goes_on = self._has_look
        if self._looks or busy >= policy.look - _ROUNDING:  # else the check was for an earlier turn
            try:
                self._on_look()
            except Exception:  # the checks go on
                log.exception("robowidgets: error in a look at user code")
        return now + min(due) if goes_on else None
