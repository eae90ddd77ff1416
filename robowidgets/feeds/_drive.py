"""Driving: limits, the message that the robot listens to, and a zero when nobody renews a speed."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, fields
from typing import Any

from .._limits import is_past
from ..samples.numbers import OF_DEGREES, finite, is_angle
from .middleware import Advert, FeedError, Middleware

log = logging.getLogger("robowidgets")

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"

LATELY = 30.0
"""Seconds for which a connection may be dead before that is noticed, generously."""

AGAIN = 1.0
"""Seconds after which a zero that could not be sent is tried again."""


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
        ValueError: a limit that is not finite and above 0, or an empty topic.
    """

    topic: str = "/cmd_vel"
    max_linear: float = 0.5
    max_angular: float = 1.0
    hold: float = 0.5

    def __post_init__(self) -> None:
        if not isinstance(self.topic, str):
            raise TypeError(f"topic: expected the name of a topic as text, got {self.topic!r}")
        if not self.topic.strip():
            raise ValueError(f"topic: expected the name of a topic, such as /cmd_vel, got {self.topic!r}")
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

    def cut(self, linear: float, angular: float) -> str:
        """Words for what `within` cuts of a speed; empty when it is nothing."""
        given = ((linear, self.max_linear, "m/s"), (angular, self.max_angular, "rad/s"))
        words = [
            f"{value:g} {unit} is cut to {_cut(value, limit):g}"
            for value, limit, unit in given
            if is_past(value, (-limit, limit))
        ]
        if words and abs(angular) > self.max_angular and not is_angle(angular):
            words.append(f"in degrees? {OF_DEGREES}")
        return "; ".join(words)


class Twists:
    """Publishes speeds as Twist or TwistStamped, whichever is listened to; Twist where nobody is known to listen.

    Args:
        middleware: what publishes.
    """

    def __init__(self, middleware: Middleware) -> None:
        self._middleware = middleware
        self._heard: dict[str, list[str]] = {}
        """By topic, the types in which a speed was sent."""

    def send(self, topic: str, linear: float, angular: float, adverts: Sequence[Advert]) -> None:
        """Publish a speed in m/s and rad/s; zero in every type in which a speed was sent: who heard that must hear it.

        Raises:
            FeedError: the topic is of another type, and no speed was sent on it.
        """
        heard = self._heard.setdefault(topic, [])
        moves = bool(linear or angular)
        kinds = [] if moves else list(heard)
        try:
            newest = _type_to_send(topic, adverts)
        except FeedError:
            if not kinds:
                raise
        else:
            if newest not in kinds:
                kinds.append(newest)
            if moves and newest not in heard:
                heard.append(newest)
        with ExitStack() as each:  # each is sent, whatever another raises
            for kind in kinds:
                each.callback(self._middleware.publish, topic, kind, twist(kind, linear, angular))


def _type_to_send(topic: str, adverts: Sequence[Advert]) -> str:
    types = [a.type for a in sorted(adverts, key=lambda a: {True: 0, None: 1, False: 2}[a.wanted]) if a.name == topic]
    known = [kind for kind in types if kind in (TWIST, TWIST_STAMPED)]
    others = [kind for kind in types if kind]
    if others and not known:
        raise FeedError(f"cannot drive by {topic}: it is {others[0]}, expected {TWIST} or {TWIST_STAMPED}")
    return known[0] if known else TWIST


def twist(message_type: str, linear: float, angular: float) -> dict[str, Any]:
    """The fields of a Twist or TwistStamped, in m/s and rad/s.

    The stamp is 0, by which controllers that judge the age of a speed take the time of its arrival: by the clock of
    this machine, where it is ahead of the robot's, a speed would hold for too long when nothing comes any more.
    """
    fields_of_twist = {
        "linear": {"x": linear, "y": 0.0, "z": 0.0},
        "angular": {"x": 0.0, "y": 0.0, "z": angular},
    }
    if message_type == TWIST:
        return fields_of_twist
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
    return {"header": header, "twist": fields_of_twist}


class Driver:
    """Sends speeds, and zero when a speed has not been renewed in time; from a thread of its own, while a zero is owed.

    Args:
        send: publishes on a topic a linear and an angular speed.
        reachable: says whether what is published arrives. A zero is sent all the same, for a robot may hear it though
            its master is gone; it is owed until it was sent to one that can be reached.
    """

    def __init__(self, send: Callable[[str, float, float], None], reachable: Callable[[], bool]) -> None:
        self._send = send
        self._reachable = reachable
        self._sending = threading.Lock()
        self._wake = threading.Event()
        self._thread: threading.Thread | None = None
        self._due: dict[str, float] = {}
        """The topics to which a zero is owed, and when it is due."""
        self._moved: dict[str, float] = {}
        """The topics to which a speed was sent, and when it was sent last."""
        self._said = ""
        self._closed = False

    def drive(self, topic: str, linear: float, angular: float, hold: float) -> None:
        """Send a speed that holds for so many seconds."""
        with self._sending:
            before = self._due.get(topic)
            if linear or angular:
                self._due[topic] = time.monotonic() + hold
            try:
                self._send(topic, linear, angular)
                if linear or angular:
                    self._moved[topic] = time.monotonic()
                else:
                    self._due.pop(topic, None)
            except Exception:  # nothing was sent; of what a person interrupts, that is not known
                self._due.pop(topic, None)
                if before is not None:
                    self._due[topic] = before
                raise
            finally:
                if self._due:
                    self._look_after()
                self._wake.set()

    def stop(self, topic: str) -> bool:
        """Send zero now; says whether it is still owed, as the robot was left driving and cannot be reached."""
        with self._sending:
            if topic in self._due:
                self._due[topic] = 0.0
            self._wake.set()
            reached = self._reachable()
            self._send(topic, 0.0, 0.0)
            if reached:
                self._due.pop(topic, None)
            return topic in self._due

    def nudge(self) -> None:
        """Look again whether a zero that is due can be sent. Waits for nothing."""
        self._wake.set()

    def lost(self) -> None:
        """Owe a zero to every topic that was driven lately: what was sent since may not have arrived."""
        with self._sending:
            since = time.monotonic() - LATELY
            for topic in [topic for topic, at in self._moved.items() if at > since and not self._closed]:
                self._due.setdefault(topic, 0.0)
                self._look_after()

    def halt(self) -> None:
        """Send zero wherever a speed still holds."""
        with self._sending:
            for topic in list(self._due):
                self._due[topic] = 0.0
                self._send_zero(topic)
        self._wake.set()

    def close(self) -> None:
        """Send zero wherever a speed still holds, owe none any more, and end the thread."""
        self._closed = True
        self.halt()
        with self._sending:
            self._due.clear()
            thread = self._thread
        self._wake.set()
        if thread is not None and thread is not threading.current_thread():
            thread.join()

    def _look_after(self) -> None:
        if self._thread is None:
            thread = threading.Thread(target=self._run, name="robowidgets-drive", daemon=True)
            thread.start()
            self._thread = thread

    def _run(self) -> None:
        while True:
            with self._sending:
                now = time.monotonic()
                for topic in [topic for topic, due in self._due.items() if due <= now]:
                    self._send_zero(topic)
                if not self._due:
                    self._thread = None
                    return
                # Overdue is what did not arrive: whoever reaches the robot again gives a nudge.
                left = min((due - now for due in self._due.values() if due > now), default=None)
            self._wake.wait(left)
            self._wake.clear()

    def _send_zero(self, topic: str) -> None:
        reached = self._reachable()
        try:
            self._send(topic, 0.0, 0.0)
        except Exception as error:  # whatever it is, the next zero must not be kept from being sent
            if str(error) != self._said:
                self._said = str(error)
                log.error("the robot could not be told to stop: %s", error, exc_info=not isinstance(error, FeedError))
            self._due[topic] = time.monotonic() + AGAIN
        else:
            self._said = ""
            if reached:
                del self._due[topic]


def _cut(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
