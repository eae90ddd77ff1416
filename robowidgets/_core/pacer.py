"""The pace at which samples go to the page: newest wins, one budget for all widgets of the process."""

from __future__ import annotations

import atexit
import logging
import os
import sys
import threading
import time
from collections.abc import Callable
from typing import NamedTuple, Protocol

from .platform_fixes import shorten_switch_interval

log = logging.getLogger("robowidgets")

INTERVAL = 1 / 75
"""Seconds between two messages of one widget: a little less than between two frames of a display, so that each frame
has a new one, and a young one, however they meet."""

MESSAGES_PER_SECOND = 240
"""Of all widgets together. JupyterLab's server drops what exceeds 1000 in 3 s on a connection, prints included."""

BYTES_PER_SECOND = 20_000_000
"""Of all widgets together. A page takes no more."""

REST = INTERVAL / 4
"""Seconds between the end of a send and the next of the same widget, at least, however late the first one was."""

FIRST_PAUSE = 1.0
"""Seconds after a send that failed, or was interrupted, until the next try. Each further failure doubles the pause."""

LONGEST_PAUSE = 30.0
"""Seconds that no pause between two tries exceeds."""

BURST = 0.05
"""Seconds of budget that may be spent at once after a rest."""

PATIENCE = 1.0
"""Seconds that the end of a cell waits for a send that hangs."""


class Sender(Protocol):
    """What the pacer calls; a widget."""

    def send_newest(self) -> int:
        """Send what is newest to the page and return the bytes sent."""


class _Failure(NamedTuple):
    """The last failed send of a sender."""

    text: str
    at: float
    pause: float


class Pacer:
    """Calls `send_newest` of each marked sender, as soon as the pace allows, from a thread of its own.

    Marking only stores, never waits for a send, and may be done from any thread at any rate. What was marked last is
    always sent in the end: nothing queues but the set of those who have something to say.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._hooked = False
        self.reset()

    def reset(self) -> None:
        """Begin anew with nothing marked: a forked process has the locks, but not the threads that hold them."""
        # Held, it may be asked for again: the collector closes widgets at any moment, which forgets them here.
        self._lock = threading.RLock()
        # Rung by letting it go: a lock alone costs a caller less than half of what a condition does.
        self._bell = threading.Lock()
        self._bell.acquire()
        self._turn = threading.Lock()
        self._due: dict[Sender, float] = {}
        # By identity: looked up several times for each send, and the numbers of those gone are few.
        self._earliest: dict[int, float] = {}
        self._failures: dict[int, _Failure] = {}
        self._timers: dict[Sender, float] = {}
        self._free_at = 0.0
        self._thread: threading.Thread | None = None

    def mark(self, sender: Sender) -> None:
        """Note that a sender has something newer to send."""
        if sender in self._due:
            return
        with self._lock:
            self._due[sender] = max(self._clock(), self._earliest.get(id(sender), 0.0))
            self._wake()

    def mark_at(self, sender: Sender, when: float | None) -> None:
        """Mark a sender at a time of the monotonic clock; None takes the appointment back."""
        with self._lock:
            if when is None:
                self._timers.pop(sender, None)
                return
            self._timers[sender] = when
            self._wake()

    def forget(self, sender: Sender) -> None:
        """Send nothing more for a sender."""
        with self._lock:
            for table in (self._due, self._timers):
                table.pop(sender, None)
            for numbers in (self._earliest, self._failures):
                numbers.pop(id(sender), None)

    def flush(self) -> None:
        """Send at once, in the caller's thread, whatever is marked, and see what is being sent to its end."""
        if not self._turn.acquire(timeout=PATIENCE):
            return
        try:
            with self._lock:
                waiting = list(self._due)
            for sender in waiting:
                with self._lock:
                    marked = self._due.pop(sender, None) is not None
                    self._earliest[id(sender)] = self._clock() + INTERVAL
                if marked:
                    self._send(sender)
        finally:
            self._turn.release()

    def _wake(self) -> None:
        if self._bell.locked():
            self._bell.release()
        if self._thread is None:
            self._start()

    def _start(self) -> None:
        shorten_switch_interval()
        self._thread = threading.Thread(target=self._run, name="robowidgets-pacer", daemon=True)
        self._thread.start()
        if not self._hooked:
            self._hooked = True
            atexit.register(self.flush)
            ipython = sys.modules.get("IPython")
            shell = ipython.get_ipython() if ipython else None
            if shell is not None:
                # A notebook that is saved or exported after its last cell holds what that cell showed.
                shell.events.register("post_execute", self.flush)

    def _run(self) -> None:
        try:
            while True:
                wait = self._send_one()
                if wait == 0 and not self._due and not self._timers:
                    # Without another look, which would hold the interpreter: the thread that carries the message out
                    # of the process is awake by now, and takes half as much again when it has to wait.
                    wait = None
                if wait != 0:
                    self._bell.acquire(timeout=-1 if wait is None else min(wait, threading.TIMEOUT_MAX))
        finally:
            self._thread = None

    def _send_one(self) -> float | None:
        """Send for whoever is due, 0; else seconds until somebody may be, None when nothing is marked."""
        # Taken and sent in one turn: who waits for the turn knows that nothing is under way.
        with self._turn:
            with self._lock:
                sender, wait = self._next()
            if sender is not None:
                self._send(sender)
        return wait

    def _next(self) -> tuple[Sender | None, float | None]:
        """Take the sender that has been due for longest, if the budget allows; else the seconds until it does."""
        now = self._clock()
        if self._timers:
            for sender in [s for s, when in self._timers.items() if when <= now]:
                del self._timers[sender]
                self._due.setdefault(sender, max(now, self._earliest.get(id(sender), 0.0)))
        times = [*self._timers.values()]
        if self._due:
            sender = min(self._due, key=self._due.__getitem__)
            when = max(self._due[sender], self._free_at)
            if when <= now:
                # Out of the table before it is sent: what comes meanwhile marks it again. The pace is kept from beat
                # to beat: the milliseconds by which a busy cell delays this thread must not add up.
                self._earliest[id(sender)] = self._due.pop(sender) + INTERVAL
                return sender, 0.0
            times.append(when)
        return None, min(times) - now if times else None

    def _send(self, sender: Sender) -> None:
        size, pause, failed = 0, FIRST_PAUSE, True
        try:
            size, pause, failed = sender.send_newest(), REST, False
        except Exception as error:
            pause = self._on_failure(sender, error)
        finally:
            now = self._clock()
            with self._lock:
                if not failed and id(sender) in self._failures:
                    self._failures[id(sender)] = self._failures[id(sender)]._replace(pause=0.0)
                self._earliest[id(sender)] = max(self._earliest.get(id(sender), 0.0), now + pause)
                if sender in self._due or failed:
                    self._due[sender] = max(self._due.get(sender, 0.0), self._earliest[id(sender)])
                self._free_at = max(self._free_at, now - BURST) + max(1 / MESSAGES_PER_SECOND, size / BYTES_PER_SECOND)

    def _on_failure(self, sender: Sender, error: Exception) -> float:
        """Log the error, unless the sender's last failure was the same a short time ago; return the pause to make."""
        now, text = self._clock(), f"{type(error).__name__}: {error}"
        last = self._failures.get(id(sender), _Failure("", now, 0.0))
        # Two failures without a success between them are at most one pause and the wait for the budget apart. A sender
        # that fails now and then would log each time if a success alone ended its failure.
        if text != last.text or now - last.at > 2 * LONGEST_PAUSE:
            log.error(
                "robowidgets: could not send to the page; trying again, and not logging this error again",
                exc_info=error,
            )
        pause = min(2 * last.pause, LONGEST_PAUSE) or FIRST_PAUSE
        self._failures[id(sender)] = _Failure(text, now, pause)
        return pause


pacer = Pacer()
"""The one pacer of this process."""

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=pacer.reset)
