"""The base of the middlewares that run a session in a thread of their own: DDS, ROS 1 and ROS 2."""

from __future__ import annotations

from abc import abstractmethod

from ._backoff import Backoff
from ._threaded import ThreadedMiddleware
from .middleware import Listener

LAST_DOMAIN = 232


class ReconnectLoop(ThreadedMiddleware):
    """Runs a session in a thread, and the next one after a growing pause."""

    def __init__(self) -> None:
        super().__init__()
        self._backoff = Backoff()

    def _run(self, listener: Listener) -> None:
        while not self._closed.is_set():
            reason = self._run_session(listener)
            if not self._closed.is_set():
                pause = self._backoff.next_pause()
                listener.on_lost(reason, pause)
                self._closed.wait(pause)

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
