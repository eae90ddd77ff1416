"""Pacing of the messages to the page: the newest state wins, and all widgets of the process share one budget."""

from __future__ import annotations

import atexit
import logging
import os
import threading
from typing import NamedTuple, Protocol

from ..runtime.clock import Scheduler, Ticket
from ..runtime.clock import scheduler as threads
from ..runtime.error_routing import ipython_shell
from ..runtime.platform_fixes import let_threads_print, shorten_switch_interval

log = logging.getLogger("robowidgets")

INTERVAL = 1 / 75
"""Seconds between two messages of one widget: slightly less than the time between two frames of a display, so that each
frame shows a new and recent message at any phase."""

MESSAGES_PER_SECOND = 240
"""Limit of all widgets together. JupyterLab's server drops messages beyond 1000 in 3 s on a connection, including
prints."""

BYTES_PER_SECOND = 20_000_000
"""Limit of all widgets together. A page cannot process more."""

REST = INTERVAL / 4
"""Shortest time in seconds from the end of a send, even a late one, to the next send of the same widget."""

FIRST_PAUSE = 1.0
"""Seconds from a send that failed, or was interrupted, to the next attempt. Each further failure doubles the pause."""

LONGEST_PAUSE = 30.0
"""The longest pause between two attempts, in seconds."""

BURST = 0.05
"""Seconds of budget that may be spent at once after a pause."""

PATIENCE = 1.0
"""Seconds for which the end of a cell waits for a send that hangs."""


class Sender(Protocol):
    """A widget, which the pacer calls. It may have a `send_interval` in seconds, which replaces `INTERVAL`."""

    def send_newest(self) -> int:
        """Send the newest state to the page; returns the number of bytes sent."""


class _Failure(NamedTuple):
    """The last failed send of a sender."""

    text: str
    at: float
    pause: float


class Pacer:
    """Calls `send_newest` of each marked sender as soon as the pace allows, from a thread of its own.

    Marking only stores and never waits for a send, so any thread may mark at any rate. The queue holds marked senders,
    not their states, and the last state of each sender is always sent in the end.
    """

    def __init__(self, scheduler: Scheduler = threads) -> None:
        self._scheduler = scheduler
        self.clock = scheduler.clock
        self._hooked = False
        self.reset()

    def reset(self) -> None:
        """Reset to nothing marked. A forked process inherits held locks, but not the threads that hold them."""
        # RLock: the garbage collector may close a widget, and call `forget()`, while this thread holds it.
        self._lock = threading.RLock()
        self._turn = threading.RLock()  # a thread that did not get it cannot release it
        self._due: dict[Sender, float] = {}
        # Keyed by id(), which is faster to look up; `forget` removes the entries.
        self._earliest: dict[int, float] = {}
        self._failures: dict[int, _Failure] = {}
        self._timers: dict[Sender, float] = {}
        self._held: set[Sender] = set()
        self.is_flushing = False
        """True while the last state of a cell, or of the process, is sent."""
        self._free_at = 0.0
        self._thread: Ticket | None = None

    def mark(self, sender: Sender) -> None:
        """Note that a sender has a newer state to send."""
        if sender in self._due:
            return
        with self._lock:
            self._due[sender] = max(self.clock.now(), self._earliest.get(id(sender), 0.0))
            self._wake()

    def mark_at(self, sender: Sender, when: float | None) -> None:
        """Mark a sender at a later time of the monotonic clock; None cancels that."""
        with self._lock:
            if when is None:
                self._timers.pop(sender, None)
                return
            self._timers[sender] = when
            self._wake()

    def hold(self, sender: Sender) -> None:
        """Note that a sender has held something back: `flush` asks it once more."""
        with self._lock:
            self._held.add(sender)

    def forget(self, sender: Sender) -> None:
        """Send nothing more for a sender."""
        with self._lock:
            self._held.discard(sender)
            for table in (self._due, self._timers):
                table.pop(sender, None)
            for numbers in (self._earliest, self._failures):
                numbers.pop(id(sender), None)

    def flush(self) -> None:
        """Send everything that is marked now in the caller's thread, after a send that is under way.

        If that send hangs, nothing is sent.
        """
        try:
            # Within the `try`, because an interrupt may come as soon as the lock is taken.
            if self._turn.acquire(timeout=PATIENCE):
                self._flush()
        finally:
            # An interrupt comes only after a call, so it cannot come before this one.
            try:  # noqa: SIM105  # `suppress` would be such a call
                self._turn.release()
            except RuntimeError:  # this thread did not get it
                pass

    def _flush(self) -> None:
        """Send everything that is marked now. Called in a turn."""
        with self._lock:
            waiting = [*dict.fromkeys((*self._due, *self._held))]
        self.is_flushing = True
        try:
            for sender in waiting:
                with self._lock:
                    marked = self._due.pop(sender, None) is not None or sender in self._held
                    self._earliest[id(sender)] = self.clock.now() + _interval(sender)
                if marked:
                    self._send(sender)
        finally:
            self.is_flushing = False

    def _wake(self) -> None:
        if self._thread is None:
            self._start()
        else:
            self._thread.wake()

    def _start(self) -> None:
        shorten_switch_interval()
        let_threads_print()
        self._thread = self._scheduler.start(self._send_due, "robowidgets-pacer")
        if not self._hooked:
            self._hooked = True
            atexit.register(self.flush)
            shell = ipython_shell()
            if shell is not None:
                # So that a notebook saved or exported after its last cell contains the state that the cell left.
                shell.events.register("post_execute", self.flush)

    def _send_due(self) -> float | None:
        """Do a turn of the thread, and return the time of the next one."""
        try:
            wait = self._send_one()
        except BaseException:  # a SystemExit ends this thread; the next mark starts another
            self._thread = None
            raise
        if wait is None or (wait == 0 and not self._due and not self._timers):
            # Sleep without re-checking: that would hold the GIL while the I/O thread is sending, and make the send
            # take half as long again.
            return None
        return self.clock.now() + wait

    def _send_one(self) -> float | None:
        """Send for one due sender and return 0, or the seconds until one is due, or None if nothing is marked."""
        # `_turn` is held for both steps, so no send is under way once another thread acquires it.
        with self._turn:
            with self._lock:
                sender, wait = self._next()
            if sender is not None:
                self._send(sender)
        return wait

    def _next(self) -> tuple[Sender | None, float | None]:
        """Take the sender that has been due for longest if the budget allows, else return the seconds until it does."""
        now = self.clock.now()
        if self._timers:
            for sender in [s for s, when in self._timers.items() if when <= now]:
                del self._timers[sender]
                self._due.setdefault(sender, max(now, self._earliest.get(id(sender), 0.0)))
        times = [*self._timers.values()]
        if self._due:
            sender = min(self._due, key=self._due.__getitem__)
            when = max(self._due[sender], self._free_at)
            if when <= now:
                # Removed before the send, so that a newer state marks it again. The interval starts at the time it was
                # due, not at the time of sending: delays by a busy cell must not add up.
                self._earliest[id(sender)] = self._due.pop(sender) + _interval(sender)
                return sender, 0.0
            times.append(when)
        return None, min(times) - now if times else None

    def _send(self, sender: Sender) -> None:
        size, pause, failed = 0, FIRST_PAUSE, True
        self._held.discard(sender)
        try:
            size, pause, failed = sender.send_newest(), REST, False
        except Exception as error:
            pause = self._on_failure(sender, error)
        finally:
            now = self.clock.now()
            with self._lock:
                if not failed and id(sender) in self._failures:
                    self._failures[id(sender)] = self._failures[id(sender)]._replace(pause=0.0)
                self._earliest[id(sender)] = max(self._earliest.get(id(sender), 0.0), now + pause)
                if sender in self._due or failed:
                    self._due[sender] = max(self._due.get(sender, 0.0), self._earliest[id(sender)])
                self._free_at = max(self._free_at, now - BURST) + max(1 / MESSAGES_PER_SECOND, size / BYTES_PER_SECOND)

    def _on_failure(self, sender: Sender, error: Exception) -> float:
        """Log the error unless the last one was the same and recent, and return the pause before the next attempt."""
        now, text = self.clock.now(), f"{type(error).__name__}: {error}"
        last = self._failures.get(id(sender), _Failure("", now, 0.0))
        # Consecutive failures are at most one pause and the wait for the budget apart. The time decides, not a success
        # in between: a sender that fails now and then would log each time.
        if text != last.text or now - last.at > 2 * LONGEST_PAUSE:
            log.error(
                "robowidgets: could not send to the page; trying again, and not logging this error again",
                exc_info=error,
            )
        pause = min(2 * last.pause, LONGEST_PAUSE) or FIRST_PAUSE
        self._failures[id(sender)] = _Failure(text, now, pause)
        return pause


def _interval(sender: Sender) -> float:
    seconds: float = getattr(sender, "send_interval", INTERVAL)
    return seconds


pacer = Pacer()
"""The one pacer of this process."""

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=pacer.reset)
