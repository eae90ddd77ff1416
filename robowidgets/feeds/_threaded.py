"""The base of the middlewares: a thread that runs one session after another."""

from __future__ import annotations

import logging
import threading
from abc import ABC, abstractmethod

from ..runtime.clock import Clock, scheduler
from ..runtime.log_once import LogOnce
from ..runtime.platform_fixes import run_beside_debugger
from .middleware import CLOSE_TIMEOUT, Listener

log = logging.getLogger("robowidgets")

FIRST = 0.5
"""The first pause between two sessions, in seconds."""

LONGEST = 8.0
"""The longest pause between two sessions, in seconds."""


class Backoff:
    """The pauses between attempts: half a second, then twice as long each time, up to eight."""

    def __init__(self) -> None:
        self._pause = FIRST

    def next_pause(self) -> float:
        """Return the seconds to wait before the next attempt."""
        pause, self._pause = self._pause, min(2 * self._pause, LONGEST)
        return pause

    def reset(self) -> None:
        """Start with the shortest pause after the next loss."""
        self._pause = FIRST


class ThreadedMiddleware(ABC):
    """A `Middleware` with its wanted topics and a thread that runs a session, and after a pause the next one.

    Args:
        clock: the clock of its waits, or None for the clock of the computer.
    """

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock: Clock = clock or scheduler.clock
        self._closed = threading.Event()
        self._lock = threading.RLock()
        self._changed = self._clock.condition(self._lock)
        self._wanted: frozenset[str] = frozenset()
        self._each: frozenset[str] = frozenset()
        """The wanted topics whose every message is passed on."""
        self._asks_for_nodes = False
        self._backoff = Backoff()
        """Reset by a session that has reached the robot."""
        self._thread: threading.Thread | None = None
        self._is_hurried = False
        """True if the next session need not wait for the end of the pause."""
        self._is_over = False
        """True once the thread has ended, except for its last step."""

    def follow(self, topics: frozenset[str], each: frozenset[str] = frozenset()) -> None:
        """See `Middleware`."""
        with self._lock:
            if (topics, each) != (self._wanted, self._each):
                self._wanted, self._each = topics, each
                self._wake_session()

    def ask_for_nodes(self, wanted: bool) -> None:
        """See `Middleware`."""
        self._asks_for_nodes = wanted

    def retry(self) -> None:
        """End the pause before the next session, because the robot can be reached again."""
        with self._lock:
            self._is_hurried = True
            self._changed.notify_all()

    def close(self) -> None:
        """See `Middleware`."""
        with self._lock:
            if not self._closed.is_set():
                self._closed.set()
                self._changed.notify_all()
                self._wake_session()
            if self._thread is None or self._thread is threading.current_thread():
                return
            until = self._clock.now() + CLOSE_TIMEOUT
            while not self._is_over and self._changed.wait_until(until):
                pass
        if self._is_over:
            self._thread.join()

    def _start_thread(self, name: str, listener: Listener) -> None:
        self._thread = threading.Thread(target=self._run, args=(listener,), name=name, daemon=True)
        run_beside_debugger(self._thread)
        self._clock.began(self._thread)
        self._thread.start()

    def _run(self, listener: Listener) -> None:
        try:
            self._run_sessions(listener)
        finally:
            with self._lock:
                self._is_over = True
                self._changed.notify_all()

    def _run_sessions(self, listener: Listener) -> None:
        log_once = LogOnce(log.exception)
        while not self._closed.is_set():
            try:
                reason = self._run_session(listener)
            except Exception as error:  # the next session may work; without it, a moving robot gets no zero
                reason = f"{type(error).__name__}: {error}"
                log_once(f"the thread of a feed failed: {reason}")
            if not self._closed.is_set():
                pause = self._backoff.next_pause()
                listener.on_lost(reason, pause)
                self._pause(pause)

    def _pause(self, seconds: float) -> None:
        """Wait for some seconds, or until it is closed or hurried."""
        until = self._clock.now() + seconds
        with self._lock:
            self._is_hurried = False
            while not (self._closed.is_set() or self._is_hurried) and self._changed.wait_until(until):
                pass

    @abstractmethod
    def _run_session(self, listener: Listener) -> str:
        """Run a session until `_closed` is set or it fails. Return the reason of the failure."""

    @abstractmethod
    def _wake_session(self) -> None:
        """Wake the session after a change of the wanted topics, or to end it. Called with the lock held."""
