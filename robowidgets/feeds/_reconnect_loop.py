"""The base of the middlewares that run a session in a thread of their own: DDS, ROS 1 and ROS 2."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod

from ._backoff import Backoff
from .middleware import CLOSE_TIMEOUT, Listener

LAST_DOMAIN = 232


class ReconnectLoop(ABC):
    """Runs a session in a thread, and the next one after a growing pause; stores the wanted topics."""

    def __init__(self) -> None:
        self._backoff = Backoff()
        self._lock = threading.Lock()
        self._wanted: set[str] = set()
        self._thread: threading.Thread | None = None

    def subscribe(self, topic: str) -> None:
        """See `Middleware`."""
        with self._lock:
            self._wanted.add(topic)
            self._wake()

    def unsubscribe(self, topic: str) -> None:
        """See `Middleware`."""
        with self._lock:
            self._wanted.discard(topic)
            self._wake()

    def close(self) -> None:
        """See `Middleware`."""
        self._backoff.close()
        with self._lock:
            self._wake()
        thread = self._thread
        if thread is not None and thread is not threading.current_thread():
            thread.join(CLOSE_TIMEOUT)

    def _start(self, name: str, listener: Listener) -> None:
        self._thread = threading.Thread(target=self._run, args=(listener,), name=name, daemon=True)
        self._thread.start()

    def _run(self, listener: Listener) -> None:
        while not self._backoff.closed:
            reason = self._run_session(listener)
            if not self._backoff.closed:
                pause = self._backoff.next_pause()
                listener.on_lost(reason, pause)
                self._backoff.wait(pause)

    @abstractmethod
    def _wake(self) -> None:
        """Wake the thread after a change of the wanted topics, or to end it. Called with the lock held."""

    @abstractmethod
    def _run_session(self, listener: Listener) -> str:
        """Run a session until it is closed or fails; returns the reason of the failure."""


def checked_domain(name: str, domain: object) -> int:
    """The domain itself; TypeError or ValueError, with the name of the argument, if it is invalid."""
    if not isinstance(domain, int) or isinstance(domain, bool):
        raise TypeError(f"{name}: expected a whole number, as in ROS_DOMAIN_ID, got {domain!r}")
    if not 0 <= domain <= LAST_DOMAIN:
        raise ValueError(f"{name}: expected 0 to {LAST_DOMAIN}, as in ROS_DOMAIN_ID, got {domain}")
    return domain
