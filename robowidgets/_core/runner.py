"""Calling functions of a user, which may hang or raise, and which may be left behind."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from functools import partial
from math import inf
from typing import Any, NamedTuple, Protocol
from weakref import WeakMethod

from . import clock
from .clock import Left, Scheduler
from .policies import Policy
from .user_function import line_of
from .user_threads import UserThread, frames_of

log = logging.getLogger("robowidgets")

LINGER = 2.0
"""Seconds without anything to do after which the thread of a runner ends; the next wake starts another one."""

_ENDS = 20
"""How often a function that was left is ended at most, once a look: a bare ``except:`` in it may take one."""

_ROUNDING = 1e-6
"""Seconds by which a sum of times may differ from the time that is meant."""


class Outcome(NamedTuple):
    """What a function returned, or raised; and the seconds for which it was not looked at."""

    value: Any
    error: BaseException | None
    unseen: float = 0.0


class Call(Protocol):
    """Calls a function of a user in a turn of a `Runner`; `of` becomes the runner's `current` meanwhile.

    Raises `Left` when the turn was left behind.
    """

    def __call__(self, function: Callable[..., Any], *args: Any, of: object) -> Outcome:
        """Call a function with arguments."""
        ...


class _Counted(NamedTuple):
    """The time of the last look, and the sums, from look to look, of the seconds that count and of those that do not.

    As one value it is read without a lock.
    """

    at: float
    seen: float
    unseen: float


class _LeftThread(NamedTuple):
    thread: UserThread
    until: float
    """The time of looks at which it is ended, or forgotten."""
    ends: int
    """How often it is still to be ended."""


class Runner:
    """Does one turn after another, in which functions of a user are called, one at a time.

    It has a thread while there is something to do. A function that does not return may be left: it goes on alone,
    another thread does the next turn, and whatever the function returns is not taken.

    Args:
        turn: does what is due, and calls functions by the `Call` that it gets; returns the time of the next turn, or
            None: when the runner is woken.
        lock: of the owner; it is held while the thread changes, not while functions run.
        name: of its threads.
        policy: how long functions may take.
        on_look: called at each look at a turn that calls functions, and once more when the turn is over.
        looks: the name of a thread that looks all the time, from the first turn until the runner is at rest. Empty: the
            timer of the process looks, while functions are called.

    Attributes:
        current: what the running function belongs to; None while none runs.
        run: another object whenever turns begin in another thread; None while there is none.
        is_interrupted: whether `interrupt` was called, and `leave` is still to be.
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
        """Repeats the turn; None while there is nothing to do."""
        self.run: object = None
        self.is_interrupted = False
        self._is_woken = self._has_look = False
        self._counted = _Counted(self._now(), 0.0, 0.0)
        self._began: float | None = None
        """When, in seconds that count, the first function of the turn that is under way was called."""
        self._left: list[_LeftThread] = []
        self._idle_until = 0.0
        self.current: object = None

    @property
    def is_at_work(self) -> bool:
        """Whether turns are done, or waited for."""
        return self._ticket is not None

    @property
    def busy_for(self) -> float:
        """Seconds that count since the first function of the turn was called; 0 while none runs."""
        began = self._began
        return 0.0 if began is None else self._count_on().seen - began

    @property
    def is_late(self) -> bool:
        """Whether the turn takes longer than its functions may."""
        return self.busy_for >= self._policy.late - _ROUNDING

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
            self._idle_until, self.is_interrupted = 0.0, False
            if self._looks:
                self._begin_looks()
            run = self.run = object()
            try:
                self._ticket = self._scheduler.start(partial(self._do, run), self._name, runs_user_code=True)
            except BaseException:  # an interrupt, after which nobody could leave what was started
                self.run = None
                raise

    def leave(self, *, itself: bool = False) -> UserThread | None:
        """Go on without the turn that is under way; returns its thread if it is in a function, else None.

        Called by a function in the turn itself, it does nothing: that turn goes on when the function returns. With
        ``itself``, that turn is left, too.
        """
        with self._lock:
            left, is_in_function = self._ticket, self.current is not None
            by_itself = left is threading.current_thread()
            if by_itself and not itself:
                return None
            self._ticket = self.run = self._began = self.current = None
            self.is_interrupted = False
            if left is None:
                return None
            left.leave()
            if not isinstance(left, UserThread):
                return None
            if self._policy.grace < inf:
                until = self._count().seen + self._policy.grace
                self._left.append(_LeftThread(left, until, _ENDS if is_in_function and not by_itself else 0))
                self._begin_looks()
            return left if is_in_function else None

    def interrupt(self) -> bool:
        """Have the turn that is under way drive no more, and no other one done; returns whether there is one.

        For a signal handler: it takes no lock. The owner calls `leave` at the next look.
        """
        ticket = self._ticket
        if ticket is None:
            return False
        self.is_interrupted = True
        ticket.leave()
        return True

    # -- turns ---------------------------------------------------------------------------------------------------------

    def _do(self, run: object) -> float | None:
        """Do one turn; end the thread when there was none for a while."""
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
            raise Left

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
        """Raise `Left` in a turn that is not wanted any more."""
        if self.run is not run or self.is_interrupted:
            raise Left

    # -- looks ---------------------------------------------------------------------------------------------------------

    def _count_on(self) -> _Counted:
        """What a look would count now."""
        before, now, most = self._counted, self._now(), self._policy.most
        gap = now - before.at
        return _Counted(now, before.seen + min(gap, most), before.unseen + max(0.0, gap - most))

    def _count(self) -> _Counted:
        """Look, and count on from here. Called with the lock held."""
        self._counted = self._count_on()
        return self._counted

    def _begin_looks(self) -> None:
        """Look from now on, if nobody does. Called with the lock held."""
        if not self._has_look:
            if self._looks:
                self._scheduler.start(self._look_in_thread, self._looks)
            else:
                self._look_later(self._now() + self._policy.look)
            self._has_look = True

    def _look_later(self, when: float) -> None:
        """Look at a time, unless nobody refers to this runner any more: a timer keeps no closed feed alive."""
        look = WeakMethod(self._look_by_timer)
        self._scheduler.call_at(when, lambda: (at := look()) and at())

    def _look_by_timer(self) -> None:
        when = self._look_at()
        if when is not None:
            self._look_later(when)

    def _look_in_thread(self) -> float:
        when = self._look_at()
        if when is None:
            raise Left
        return when

    def _look_at(self) -> float | None:
        """Look at what runs, and end what was left for long; returns the time of the next look, None if there is none.

        In the thread of the looks, or in that of the timers.
        """
        policy = self._policy
        with self._lock:
            now, seen, _ = self._count()
            over = [one for one in self._left if one.until <= seen + _ROUNDING or not one.thread.is_alive()]
            self._left = [one for one in self._left if one not in over]
            for one in over:
                if one.ends and one.thread.is_alive():
                    one.thread.end()
                    self._left.append(one._replace(until=seen + policy.look, ends=one.ends - 1))
            busy = policy.late if self._began is None else seen - self._began
            due = [policy.look, *(one.until - seen for one in self._left)]
            if busy < policy.late - _ROUNDING:
                due.append(policy.late - busy)
            is_busy = self.is_at_work if self._looks else self._began is not None
            self._has_look = is_busy or bool(self._left)
            goes_on = self._has_look
        if self._looks or busy >= policy.look - _ROUNDING:  # else it is another turn than the one the look was for
            try:
                self._on_look()
            except Exception:  # the looks go on
                log.exception("robowidgets: error in a look at user code")
        return now + min(due) if goes_on else None
