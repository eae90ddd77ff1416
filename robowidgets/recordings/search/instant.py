"""The moments of a recording for which functions of one moment are called."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

from ...kinds import KINDS, Kind, by_namespace, kind_of_parameter, kind_of_sample, sample_names, sensor_of
from ...samples import Ranges, Scan, Speed, Touch
from ..topics import Topic, UnknownTopicError, UnnamedTopicError, only

if TYPE_CHECKING:
    from .. import RecordingData

TIME = ""
"""Stands for the time in the set of topics that a function has read."""

Make = Callable[[], Any]


class NoSampleYetError(LookupError):
    """A topic has no sample yet, so the condition is unknown."""


class Now:
    """The time of an `Instant`, with the samples up to it, and the topics that a function reads.

    Attributes:
        time_ns: the time.
        samples: the last sample of each topic, or a function that makes it.
        seconds_of: the time of that sample, in seconds from the start of the recording.
        read: the topics that the function has read, and `TIME` if it read the time.
    """

    def __init__(self, start_ns: int) -> None:
        self._start_ns = self.time_ns = start_ns
        self.samples: dict[str, Any] = {}
        self.seconds_of: dict[str, float] = {}
        self.read: set[str] = set()

    def put(self, time_ns: int, samples: dict[str, Make]) -> None:
        """Advance to a time at which these topics have a sample."""
        self.time_ns = time_ns
        self.samples.update(samples)
        self.seconds_of.update(dict.fromkeys(samples, self.seconds))

    @property
    def seconds(self) -> float:
        """The time in seconds from the start of the recording."""
        return (self.time_ns - self._start_ns) / 1e9


class Instant:
    """The last sample of each topic at one time.

    ``moment.scan``, ``moment.speed`` and ``moment.touch`` are the samples of the only topic of their kind (for speeds,
    the only measured one); samples of other kinds are named by `Kind.sample_name`. ``moment.sonars`` contains the
    samples of all sonars of the only namespace with sonars, once each has one. ``moment["/cmd_vel"]`` is the sample of
    any topic, and ``moment["/imu"]`` the message of a topic without a widget, if ``topics`` names it.
    ``moment.seconds`` counts from the start of the recording, ``moment.time_ns`` is by its clock.

    Raises:
        UnknownTopicError: the recording has several topics of a kind, so one must be named.
    """

    scan: Scan
    """The last scan."""
    speed: Speed
    """The last measured speed."""
    touch: Touch
    """The last known state of the touch sensors."""
    sonars: Ranges
    """The last range of each sonar."""

    def __init__(self, name: str, topics: list[Topic], now: Now, preferred: Collection[str] = ()) -> None:
        self._name = name
        self._preferred = preferred
        self._topics = topics
        self._names = [topic.name for topic in topics]
        self._topic_of: dict[str, str] = {}
        """The only topic of each kind."""
        self._now = now

    @property
    def time_ns(self) -> int:
        """Nanoseconds since the epoch."""
        self._now.read.add(TIME)
        return self._now.time_ns

    @property
    def seconds(self) -> float:
        """Seconds from the start of the recording."""
        self._now.read.add(TIME)
        return self._now.seconds

    def __getattr__(self, name: str) -> Any:
        kind = next((kind for kind in KINDS.values() if kind.sample_name == name), None)
        if kind is None and (joined := kind_of_parameter(name)):
            return self._of_all(joined)
        if kind is None:
            raise AttributeError(f"no {name!r} here: there are {', '.join(self._attributes())} and moment[topic]")
        if kind.name not in self._topic_of:
            self._topic_of[kind.name] = self._only(kind)
        return self[self._topic_of[kind.name]]

    def __dir__(self) -> list[str]:
        return self._attributes()

    def __getitem__(self, topic: str) -> Any:
        if topic not in self._names:
            raise KeyError(f"topic {topic!r} is not read here; topics that are read: {', '.join(self._names)}")
        self._now.read.add(topic)
        samples = self._now.samples
        if topic not in samples:
            raise NoSampleYetError(topic)
        sample = samples[topic]
        if callable(sample):
            sample = samples[topic] = sample()
        return sample

    @staticmethod
    def _attributes() -> list[str]:
        return [*sample_names(), "seconds", "time_ns"]

    def _of_all(self, kind: Kind) -> Any:
        """Return the sample of all topics of the only namespace with this kind."""
        combine = kind.roles[0].combine
        assert combine is not None  # its name is the name of such a sample
        found = by_namespace(topic.name for topic in self._topics if topic.widget == kind.name)
        if not found:
            raise AttributeError(f"{self._name} has no {kind.noun} among the topics that are read")
        if len(found) > 1:
            first, *_ = found.values()
            there = f"{self._name} has {kind.noun} in several namespaces ({', '.join(found)})"
            raise UnnamedTopicError(there, first, kind.name, f"choose one, as in topics={first!r}")
        (topics,) = found.values()
        samples = {sensor_of(topic): self[topic] for topic in topics}
        return combine(samples, {sensor_of(topic): self._now.seconds_of[topic] for topic in topics})

    def _only(self, kind: Kind) -> str:
        try:
            return only(self._name, self._topics, kind.name, self._preferred)
        except UnnamedTopicError as error:
            first = error.topics[0]
            how = f"read one, as in moment[{first!r}], or choose one, as in topics={[first]!r}"
            raise UnnamedTopicError(error.there, error.topics, kind.name, how) from None
        except UnknownTopicError as error:
            raise AttributeError(f"{error} among the topics that are read") from None


class OneSample:
    """A moment with one sample, for a widget that shows no other.

    Args:
        sample: a `Scan`, `Speed`, `Touch`, or a sample of another kind.
    """

    def __init__(self, sample: Any) -> None:
        self._sample = sample

    def __getattr__(self, name: str) -> Any:
        kind = kind_of_sample(self._sample)
        if kind is not None and name != kind.sample_name:
            raise AttributeError(f"no {name!r} here: this is one {kind.sample_name}")
        return self._sample

    def __getitem__(self, topic: str) -> Any:
        return self._sample


def together(topics: dict[str, Iterator[tuple[int, Make]]]) -> Iterator[tuple[int, dict[str, Make]]]:
    """Yield the samples of all topics in the order of time, grouped by time.

    If topics have several samples at one time, the first group contains the first of each, the next the second of each.
    """
    heads = {topic: head for topic, samples in topics.items() if (head := next(samples, None))}
    while heads:
        now = min(time_ns for time_ns, _ in heads.values())
        came = {topic: make for topic, (time_ns, make) in heads.items() if time_ns == now}
        yield now, came
        for topic in came:
            if head := next(topics[topic], None):
                heads[topic] = head
            else:
                del heads[topic]


def samples_of(recording: RecordingData, topic: str) -> Iterator[tuple[int, Make]]:
    """Yield the times of a topic, each with the function that makes its sample."""
    for chunk in recording.series(topic).chunks():
        for i, time_ns in enumerate(chunk.times_ns.tolist()):
            yield time_ns, partial(chunk.sample, i)
