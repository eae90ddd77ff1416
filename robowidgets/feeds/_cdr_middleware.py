"""The common part of DDS and Zenoh: a session that is looked at in a thread, and publishes CDR in any other."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from ..messages.twist import encode_twist
from ..runtime.clock import Clock
from ._threaded import ThreadedMiddleware
from ._twist import is_zero
from .middleware import FeedError, Listener

_TURN = 0.01
"""Seconds for which every message of one topic is passed on before other topics get their turn."""


class CdrSession(Protocol):
    """A session. Only the thread that made it may use it, except for `wake` and `publish`."""

    @property
    def wishes(self) -> Sequence[Any]:
        """The subscriptions, each with its ``topic``, and ``each`` if every message is wanted."""

    def look(self) -> None:
        """Report the topics, and repeat zeros. Raise an exception if the session is over."""

    def follow(self, topics: frozenset[str], each: frozenset[str]) -> None:
        """Subscribe to these topics, to every message if wanted, and to nothing else."""

    def pass_on(self, wish: Any) -> bool:
        """Pass on the next message of a subscription. Return False if it has none."""

    def wait(self) -> None:
        """Wait for a message, a change of the topics, or `wake`."""

    def wake(self) -> None:
        """Make `wait` return."""

    def publish(self, topic: str, type_name: str, raw: bytes, *, is_zero: bool) -> None:
        """Write a message."""

    def close(self) -> None:
        """End the session."""


class CdrMiddleware(ThreadedMiddleware):
    """A `Middleware` whose thread passes messages on; `publish` writes in the thread that calls it.

    Args:
        clock: the clock of its waits.
    """

    def __init__(self, clock: Clock | None = None) -> None:
        super().__init__(clock)
        self._session: CdrSession | None = None

    @property
    @abstractmethod
    def where(self) -> str:
        """See `Middleware`."""

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        raw = encode_twist("cdr", message_type, message)
        with self._lock:
            session = self._session
        if session is None:
            raise FeedError(f"{self.where} is not connected")
        session.publish(topic, message_type, raw, is_zero=is_zero(message))

    def _wake_session(self) -> None:
        if self._session is not None:
            self._session.wake()

    def _serve(self, session: CdrSession, listener: Listener) -> None:
        """Pass on the messages of a session until the middleware is closed or the session is over, and end it."""
        try:
            with self._lock:
                self._session = session
            listener.on_connected()
            self._backoff.reset()
            while not self._closed.is_set():
                self._step(session)
        finally:
            with self._lock:
                self._session = None
            session.close()

    def _step(self, session: CdrSession) -> None:
        session.look()
        session.follow(self._wanted, self._each)
        for wish in session.wishes:
            until = self._clock.now() + _TURN
            while wish.topic in self._wanted and not self._closed.is_set() and session.pass_on(wish):
                if not wish.each or self._clock.now() >= until:
                    break
        if not self._closed.is_set():
            session.wait()
