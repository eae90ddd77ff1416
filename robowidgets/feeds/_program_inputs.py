"""The robot of a feed, as its program sees it: the newest samples, and driving."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from itertools import chain, pairwise
from typing import Any

import numpy as np

from ..behaviors.odometer import Odometer
from ..behaviors.robot import ODOMETRY, POSE, NotReadyError
from ..kinds import (
    Gathered,
    Kind,
    by_namespace,
    kind_of_parameter,
    kind_of_sample,
    namespace_of,
    sensor_of,
)
from ..path.row import PATH
from ..runtime.clock import RealClock
from ..samples import Pose, Speed
from ..samples.staleness import STEPS, TO_DRIVE_BY, TO_DRIVE_BY_NAMED, SilenceRule, is_steady
from ..speed.row import SPEED
from ._probes import Probes
from ._subscription import Target
from ._subscriptions import Subscriptions
from ._topics import queue_length, sample_of

_CLOCK = RealClock()

MOST_POSES = 1000
"""The number of odometry messages that may wait for a step. Each of them counts for the distance."""


class _Latest:
    """The newest message of a topic, decoded when the program reads it."""

    def __init__(
        self,
        connection: Subscriptions,
        topic: str,
        on_message: Callable[[], None],
        odometer: Odometer | None,
        silence: SilenceRule | None,
    ) -> None:
        self.odometer = odometer
        """The odometer that gets each pose of the topic, or None if only the newest message counts."""
        self._connection, self.topic, self._on_message, self._silence = connection, topic, on_message, silence
        self._lock = threading.Lock()
        self._messages: deque[Any] = deque()
        self._times: deque[float] = deque(maxlen=STEPS)
        self._slept = 0.0
        """Seconds for which the computer had slept in total when the newest message came."""
        self._sample: Any = None
        self._unread = ""
        """The reason why the newest message could not be read, or empty."""
        self._kind: Kind | None = None
        """The kind of its samples, or None if no widget shows them. Then the meaning of its silence is unknown."""
        self._gathered: Gathered | None = None
        self._target: Target = connection.attach(topic, self._put)

    def close(self) -> None:
        """Stop receiving messages."""
        self._connection.detach(self.topic, self._target)

    @property
    def came_at(self) -> float:
        """The time of the newest message on the monotonic clock."""
        return self._times[-1]

    def decode(self, name: str) -> None:
        """Decode the new messages. Raise NotReadyError if the newest sample is missing, too old or unreadable."""
        self.decode_new()
        if why := self.why_not_ready(name):
            raise NotReadyError(why)

    def read(self) -> Any:
        """Return the newest sample, after `decode`."""
        return self._sample if self._gathered is None else self._gathered.take()

    def why_not_ready(self, name: str) -> str:
        """Return why the newest sample is missing, unreadable or too old, or empty if it is ready."""
        with self._lock:
            times, slept = list(self._times), _CLOCK.slept() - self._slept
        if not times:
            return self._connection.status_of(self.topic) or f"waiting for {self.topic}"
        kind = self._kind
        if kind is not None and kind.parameter != name and (wanted := kind_of_parameter(name)):
            return f"{name}={self.topic!r}: expected a topic of {wanted.noun}, got one of {kind.noun}"
        rule = TO_DRIVE_BY if self._kind else TO_DRIVE_BY_NAMED
        step = min((later - earlier for earlier, later in pairwise(times[-3:])), default=0.0)
        is_silent = time.monotonic() + slept - times[-1] > (self._silence or rule).after(step)
        if is_silent and (self._kind.goes_stale if self._kind else is_steady(np.array(times))):
            return self._connection.status_of(self.topic) or f"no {name} comes on {self.topic} any more"
        return self._unread

    def decode_new(self) -> None:
        """Decode the messages that came since the last call, and skip unreadable ones."""
        with self._lock:
            messages, self._messages = self._messages, deque()
        if not messages:
            return
        topic = self._connection.topic_of(self.topic)
        for message in messages:
            try:
                sample = self._connection.mounted(sample_of(message, topic))
            except (TypeError, ValueError) as error:
                self._unread = f"a message of {self.topic} cannot be read: {error}"
                continue
            self._sample, self._unread = sample, ""
            if self.odometer is not None and isinstance(sample, Speed) and sample.pose is not None:
                self.odometer.add(sample.pose)
            self._kind = kind = kind_of_sample(sample)
            if kind is not None and kind.gathered is not None:
                self._gathered = self._gathered or kind.gathered()
                self._gathered.add(sample)

    def _put(self, message: Any) -> None:
        """Store a message, or every message for some kinds. It runs in the thread of the transport."""
        with self._lock:
            if not self._messages:
                kept = queue_length(self._connection.topic_of(self.topic).type)
                self._messages = deque(maxlen=kept if self.odometer is None else MOST_POSES)
            self._messages.append(message)
            self._times.append(time.monotonic())
            self._slept = _CLOCK.slept()
        self._on_message()


class FeedInputs:
    """The newest samples of a feed that a program reads. See `robowidgets.behaviors.robot.Inputs`.

    Args:
        connection: the connection of the feed.
        wake: called on each message of the topic ``on``.
        silence: the rule for samples that are too old, or None for the rule of programs, which drive by samples.
        wakes_each: True to call `wake` on each message of any of its topics.
    """

    def __init__(
        self,
        connection: Subscriptions,
        wake: Callable[[], None],
        *,
        silence: SilenceRule | None = None,
        wakes_each: bool = False,
    ) -> None:
        self._connection, self._wake_reader, self._wakes_each = connection, wake, wakes_each
        self._silence = silence
        self._lock = threading.RLock()
        """Held by the thread that chooses and by the program's thread, never by a thread of the transport."""
        self._wanted: dict[str, str | None] = {}
        self._on: str | None = None
        self._latest: dict[str, _Latest] = {}
        """The newest messages, by topic."""
        self._chosen: dict[str, Sequence[str]] = {}
        """The topics of each parameter."""
        self._probes = Probes(connection)
        self._odometer = Odometer()

    def choose(self, wanted: Mapping[str, str | None], on: str | None) -> None:
        """See `Inputs`."""
        self._connection.check_open()
        with self._lock:
            self._wanted, self._on, self._chosen = dict(wanted), on, {}
            self._find()
            self._prune()

    def take(self) -> dict[str, Any]:
        """See `Inputs`."""
        with self._lock:
            if len(self._chosen) < len(self._wanted) or any(_combine(name) for name in self._wanted):
                self._find()
            for name in self._wanted:
                if name not in self._chosen:
                    raise NotReadyError(self._missing(name))
            for name, topics in self._chosen.items():  # all, before a touch is read, which only one step gets
                for topic in topics:
                    self._latest[topic].decode(_kind(name).sample_name if _combine(name) else name)
            odometry = {name: self._odometry(name) for name in self._chosen if name in ODOMETRY}
            return {
                name: odometry[name] if name in odometry else self._read(name, topics)
                for name, topics in self._chosen.items()
            }

    def _read(self, name: str, topics: Sequence[str]) -> Any:
        """Return the newest sample of a parameter."""
        latest = {topic: self._latest[topic] for topic in topics}
        if (combine := _combine(name)) is None:
            return latest[topics[0]].read()
        samples = {sensor_of(topic): one.read() for topic, one in latest.items()}
        return combine(samples, {sensor_of(topic): one.came_at for topic, one in latest.items()})

    def why_not_ready(self) -> str:
        """Return why a sample is missing or too old, or empty if all are ready. It consumes no sample."""
        with self._lock:
            for name in self._wanted:
                if name not in self._chosen:
                    return self._missing(name)
                for topic in self._chosen[name]:
                    if why := self._latest[topic].why_not_ready(name):
                        return why
        return ""

    @property
    def topics(self) -> tuple[str, ...]:
        """See `Inputs`."""
        chosen = chain.from_iterable(dict(self._chosen).values())
        return tuple(dict.fromkeys((*chosen, *([self._on] if self._on else []))))

    def why_silent(self, on: str) -> str:
        """See `Inputs`."""
        return self._connection.status_of(on) or f"waiting for {on}"

    def put_to(self, pose: Pose) -> None:
        """See `Inputs`."""
        with self._lock:
            for latest in self._latest.values():
                if latest.odometer is not None:
                    latest.decode_new()
            self._odometer.put_to(pose)

    def close(self) -> None:
        """See `Inputs`."""
        with self._lock:
            self._wanted, self._on, self._chosen = {}, None, {}
            self._prune()
            self._probes.close()

    def _find(self) -> None:
        """Find the topics that are not chosen yet, because they may appear at any time."""
        for name, topic in self._wanted.items():
            if name in self._chosen and not _combine(name):
                continue
            found = [[topic]] if topic and not _combine(name) else self._candidates(name)
            if len(found) == 1:
                for one in found[0]:
                    self._attach(one, is_odometry=name in ODOMETRY)
                self._chosen[name] = found[0]
        if self._on is not None:
            self._attach(self._on)

    def _attach(self, topic: str, *, is_odometry: bool = False) -> None:
        def wake() -> None:
            if self._wakes_each or self._on == topic:
                self._wake_reader()

        if topic not in self._latest:
            self._latest[topic] = _Latest(self._connection, topic, wake, None, self._silence)
        if is_odometry and self._latest[topic].odometer is None:
            self._odometer.leave_out()
            for latest in self._latest.values():
                latest.odometer = None
            self._latest[topic].odometer = self._odometer

    def _odometry(self, name: str) -> Any:
        """Return a value of the odometer. Raise NotReadyError before its first pose."""
        if self._odometer.pose is None:
            raise NotReadyError(f"no pose comes on {self._chosen[name][0]}: is it odometry?")
        return self._odometer.pose if name == POSE else getattr(self._odometer, name)

    def _prune(self) -> None:
        used = {self._on, *chain.from_iterable(self._chosen.values())}
        for topic in [topic for topic in self._latest if topic not in used]:
            self._latest.pop(topic).close()

    def _candidates(self, name: str) -> list[list[str]]:
        """Return the topics with a kind of sample, grouped if a parameter gets all topics of a namespace.

        A group with the topic that wakes the program comes alone.
        """
        kind, named = _kind(name), self._wanted[name]
        self._probes.add(topic for topic in self._connection.topics if topic.type in kind.undecided)
        topics = [topic for topic in self._connection.topics if topic.widget == kind.name and not topic.commanded]
        if name in ODOMETRY:
            if odometry := next((topic for other, topic in self._wanted.items() if other in ODOMETRY and topic), None):
                return [[odometry]]
            topics = [topic for topic in topics if not PATH.types.isdisjoint(topic.type.split(", "))]
        found = [topic.name for topic in topics]
        if _combine(name):
            found = [topic for topic in found if named is None or named in (topic, namespace_of(topic))]
            groups = list(by_namespace(found).values())
        else:
            groups = [[topic] for topic in found]
        return [group for group in groups if self._on in group] or groups

    def _missing(self, name: str) -> str:
        if self._connection.status:
            return self._connection.status
        found = [namespace_of(group[0]) if _combine(name) else group[0] for group in self._candidates(name)]
        if found:
            what = f"namespaces have {name}" if _combine(name) else f"topics have a {name}"
            return f"{len(found)} {what}: {', '.join(found)}; name one: program({name}={found[0]!r})"
        noun = "odometry" if name in ODOMETRY else _kind(name).noun
        return f"waiting for a topic with {noun}" + (f" in {self._wanted[name]}" if self._wanted[name] else "")


def _kind(name: str) -> Kind:
    kind = SPEED if name in ODOMETRY else kind_of_parameter(name)
    assert kind is not None  # the parameters of a program were checked before
    return kind


def _combine(name: str) -> Callable[..., Any] | None:
    """Return the function that combines all topics of a namespace for a parameter, or None for one topic."""
    kind = kind_of_parameter(name)
    return None if kind is None else kind.roles[0].combine
