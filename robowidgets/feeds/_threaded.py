"""The base of the middlewares that have a thread of their own."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod

from .middleware import CLOSE_TIMEOUT, Listener


class ThreadedMiddleware(ABC):
    """The wanted topics of a `Middleware`, and its thread, which ends when it is closed."""

    def __init__(self) -> None:
        self._closed = threading.Event()
        self._lock = threading.Lock()
        self._wanted: frozenset[str] = frozenset()
        self._thread: threading.Thread | None = None

    def subscribe(self, topic: str) -> None:
        """See `Middleware`."""
        with self._lock:
            self._wanted |= {topic}
            self._wake()

    def unsubscribe(self, topic: str) -> None:
        """See `Middleware`."""
        with self._lock:
            self._wanted -= {topic}
            self._wake()

    def close(self) -> None:
        """See `Middleware`."""
        self._closed.set()
        with self._lock:
            self._wake()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(CLOSE_TIMEOUT)

    def _start(self, name: str, listener: Listener) -> None:
        self._thread = threading.Thread(target=self._run, args=(listener,), name=name, daemon=True)
        self._thread.start()

    @abstractmethod
    def _run(self, listener: Listener) -> None:
        """Run until `_closed` is set."""

    @abstractmethod
    def _wake(self) -> None:
        """Wake the thread after a change of the wanted topics, or to end it. Called with the lock held."""
