"""Driving: limits, the message that the robot listens to, and a zero when nobody renews a speed."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

from ..samples.scan import finite
from .middleware import Advert, FeedError

log = logging.getLogger("robowidgets")

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"


@dataclass(frozen=True)
class Driving:
    """How a feed drives the robot.

    Args:
        topic: where speeds are published.
        max_linear: m/s, forward and backward; more is cut.
        max_angular: rad/s, both ways; more is cut.
        hold: seconds after which a speed that was not renewed is followed by zero.

    Raises:
        TypeError: something is not a number, or the topic no text.
        ValueError: a limit that is not finite and above 0.
    """

    topic: str = "/cmd_vel"
    max_linear: float = 0.5
    max_angular: float = 1.0
    hold: float = 0.5

    def __post_init__(self) -> None:
        if not isinstance(self.topic, str):
            raise TypeError(f"topic: expected the name of a topic as text, got {self.topic!r}")
        for field in fields(self)[1:]:
            value = finite(field.name, getattr(self, field.name), "SI units")
            if value <= 0:
                raise ValueError(f"{field.name}: expected a limit above 0, got {value!r}")

    def within(self, linear: float, angular: float) -> tuple[float, float]:
        """A speed in m/s and rad/s, cut to the limits. ValueError for NaN and infinity."""
        return (
            _cut(finite("linear", linear, "m/s"), self.max_linear),
            _cut(finite("angular", angular, "rad/s"), self.max_angular),
        )


def type_to_send(topic: str, adverts: Sequence[Advert]) -> str:
    """Twist or TwistStamped, whichever is listened to; Twist where nobody is known to listen.

    Raises:
        FeedError: the topic is of another type.
    """
    types = [a.type for a in sorted(adverts, key=lambda a: {True: 0, None: 1, False: 2}[a.wanted]) if a.name == topic]
    known = [kind for kind in types if kind in (TWIST, TWIST_STAMPED)]
    others = [kind for kind in types if kind]
    if others and not known:
        raise FeedError(f"cannot drive by {topic}: it is {others[0]}, expected {TWIST} or {TWIST_STAMPED}")
    return known[0] if known else TWIST


def twist(message_type: str, linear: float, angular: float) -> dict[str, Any]:
    """The fields of a Twist or TwistStamped, in m/s and rad/s."""
    fields_of_twist = {
        "linear": {"x": linear, "y": 0.0, "z": 0.0},
        "angular": {"x": 0.0, "y": 0.0, "z": angular},
    }
    if message_type == TWIST:
        return fields_of_twist
    seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
    header = {"stamp": {"sec": seconds, "nanosec": nanoseconds}, "frame_id": "base_link"}
    return {"header": header, "twist": fields_of_twist}


class Driver:
    """Sends speeds, and zero when a speed has not been renewed in time; from a thread of its own, while it moves.

    Args:
        send: publishes a linear and an angular speed.
        reachable: says whether what is published arrives. A zero that is due waits until it does.
    """

    def __init__(self, send: Callable[[float, float], None], reachable: Callable[[], bool]) -> None:
        self._send = send
        self._reachable = reachable
        self._sending = threading.Lock()
        self._wake = threading.Event()
        self._thread: threading.Thread | None = None
        self._moving = False
        self._until = 0.0

    def drive(self, linear: float, angular: float, hold: float) -> None:
        """Send a speed that holds for so many seconds."""
        with self._sending:
            self._send(linear, angular)
            self._moving, self._until = bool(linear or angular), time.monotonic() + hold
            if self._moving and self._thread is None:
                self._thread = threading.Thread(target=self._run, name="robowidgets-drive", daemon=True)
                self._thread.start()

    def stop(self) -> None:
        """Send zero now; where the robot cannot be reached, as soon as it can, if it was left driving."""
        with self._sending:
            self._until = 0.0
            if self._reachable():
                self._moving = False
                self._send(0.0, 0.0)
        self._wake.set()

    def nudge(self) -> None:
        """Look again whether a zero that is due can be sent. Waits for nothing."""
        self._wake.set()

    def halt(self) -> None:
        """Send zero if a speed still holds, and end the thread, until the next speed."""
        with self._sending:
            thread = self._thread
            if self._moving:
                self._moving = False
                if self._reachable():
                    self._send_zero()
        self._wake.set()
        if thread is not None and thread is not threading.current_thread():
            thread.join()

    def _run(self) -> None:
        while True:
            with self._sending:
                if self._moving and self._until <= time.monotonic() and self._reachable():
                    self._moving = False
                    self._send_zero()
                if not self._moving:
                    self._thread = None
                    return
                # Overdue is what cannot be sent: whoever reaches the robot again gives a nudge.
                left = self._until - time.monotonic()
            self._wake.wait(left if left > 0 else None)
            self._wake.clear()

    def _send_zero(self) -> None:
        try:
            self._send(0.0, 0.0)
        except FeedError as error:
            log.error("the robot could not be told to stop: %s", error)


def _cut(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
