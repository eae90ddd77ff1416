"""The robot in real time."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import Any

from ..runtime.clock import Clock, scheduler
from .offers import MakeOffers
from .robot import Robot
from .wander import wander as wander_about

LET_GO = 3.0
"""Seconds without a command after which the robot wanders again."""

QUIET = 0.5
"""Seconds after a command in which the commanded speed is not passed on, because the sender of the command does so."""

_LATEST = 1.0


class RealTime:
    """A simulation of a robot in real time, in the thread that runs it.

    The robot obeys commanded speeds. Without commands it wanders about and backs off from obstacles, or stands still.
    Any thread may call each method.

    Args:
        robot: the robot. Nothing else may use it during the simulation.
        hz: rate of its speeds and bumpers, per second. Scans come at the rate of its scanner, or at this rate if it is
            lower.
        wander: True to wander without commands.
        offers: the functions that return its topics, one for each kind of sensor.
        clock: the clock of the simulation.
    """

    def __init__(
        self,
        robot: Robot,
        hz: float,
        wander: bool,
        offers: Sequence[MakeOffers],
        clock: Clock = scheduler.clock,
    ) -> None:
        self._robot, self._clock = robot, clock
        self._lock = threading.RLock()
        self._changed = clock.condition(self._lock)
        self._offers = [offer for make in offers for offer in make(robot)]
        self._step = 1 / hz
        self._wanders = wander
        self._wanted: frozenset[str] = frozenset()
        self._driven: tuple[float, float, float] | None = None if wander else (0.0, 0.0, 0.0)
        self._driven_at = 0.0
        self._stands = False
        self._is_ended = False

    def want(self, topics: Collection[str], each: Collection[str] = ()) -> None:  # noqa: ARG002  # it skips no sample
        """Pass on only the samples of these topics.

        For topics in ``each``, every sample is passed on. For others, the newest sample is enough.
        """
        self._wanted = frozenset(topics)

    def drive(self, linear: float, angular: float, lateral: float) -> None:
        """Command a speed; see `Robot.drive`."""
        self._driven_at = self._clock.now()
        self._driven = (linear, angular, lateral)

    def stand(self, stands: bool) -> None:
        """Stand still instead of wandering, or wander again some seconds later."""
        if self._stands and not stands:
            self._driven_at = self._clock.now()
        self._stands = stands

    def end(self) -> None:
        """End `run`."""
        with self._lock:
            self._is_ended = True
            self._changed.notify_all()

    def run(self, on_sample: Callable[[str, Any], object]) -> None:
        """Run until `end` is called.

        Args:
            on_sample: called with the topic of each sample and its message: see `Offer.message`.
        """
        ways = wander_about(self._robot)
        last: dict[str, Any] = {}
        due = self._clock.now()
        while self._await(due):
            # Catches up with time that a busy cell took from this thread, up to `_LATEST` seconds.
            due = max(due + self._step, self._clock.now() - _LATEST)
            ways = self._steer(ways)
            self._robot.step(self._step)
            obeys = self._clock.now() - self._driven_at <= QUIET
            for offer in self._offers:
                if offer.topic in self._wanted and not (offer.obeyed and obeys):
                    before, last[offer.topic] = last.get(offer.topic), offer.read()
                    if last[offer.topic] is not before:
                        on_sample(offer.topic, offer.message(last[offer.topic]))

    def _await(self, due: float) -> bool:
        """Wait until a time. Return False if `end` was called."""
        with self._lock:
            while not self._is_ended and self._changed.wait_until(due):
                pass
            return not self._is_ended

    def _steer(self, ways: Iterator[None]) -> Iterator[None]:
        if self._stands and self._driven is None:
            self._driven = (0.0, 0.0, 0.0)
        driven = self._driven
        if driven is None:
            next(ways)
            return ways
        if not self._wanders or self._stands or self._clock.now() - self._driven_at < LET_GO:
            self._robot.drive(*driven)
            return ways
        self._driven = None
        return wander_about(self._robot)
