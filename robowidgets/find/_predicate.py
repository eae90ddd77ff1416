"""Conditions that are functions of one moment."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kinds import KINDS, Kind
from ..messages.decoding import one_line
from ..recordings.topics import Topic, UnknownTopicError, UnnamedTopicError, only, shown
from ..repair import RecordingError
from ..samples import HasAge, Scan, Speed, Touch
from ..samples.verdict import Trace, Verdict
from ._steps import NO, UNKNOWN, YES, Steps, steps
from .silence import mark_stale

if TYPE_CHECKING:
    from ..recordings import RecordingData
    from .search import Search

_TIME = ""
_BAR_EVERY = 500

Make = Callable[[], Any]


class NotYetError(LookupError):
    """There is no sample of a topic yet: the condition is unknown."""


class Instant:
    """The last sample of each topic at one time.

    ``moment.scan``, ``moment.speed`` and ``moment.touch`` are the samples of the only topic of their kind (for speeds,
    of the measured one); a sample of another kind has the name `Kind.sample_name`. ``moment["/cmd_vel"]`` is the sample
    of any topic. ``moment.seconds`` counts from the start of the recording, ``moment.time_ns`` is by its clock.

    Raises:
        UnknownTopicError: the recording has several topics of a kind, so one must be named.
    """

    scan: Scan
    """The last scan."""
    speed: Speed
    """The last measured speed."""
    touch: Touch
    """The last known state of the touch sensors."""

    def __init__(self, name: str, topics: list[Topic], start_ns: int) -> None:
        self._name = name
        self._topics = topics
        self._names = [topic.name for topic in topics]
        self._topic_of: dict[str, str] = {}
        """The only topic of each kind, by the kind."""
        self._start_ns = start_ns
        self._now = start_ns
        self._samples: dict[str, Any] = {}
        """The last sample of each topic, or the function that makes it."""
        self._used: set[str] = set()
        """The topics that the function has read."""

    @property
    def time_ns(self) -> int:
        """Nanoseconds since the epoch."""
        self._used.add(_TIME)
        return self._now

    @property
    def seconds(self) -> float:
        """Seconds from the start of the recording."""
        return (self.time_ns - self._start_ns) / 1e9

    def __getattr__(self, name: str) -> Any:
        kind = next((kind for kind in KINDS.values() if kind.sample_name == name), None)
        if kind is None:
            raise AttributeError(f"no {name!r} here: there are {', '.join(self._attributes())} and moment[topic]")
        if kind.name not in self._topic_of:
            self._topic_of[kind.name] = self._only(kind)
        return self[self._topic_of[kind.name]]

    def __dir__(self) -> list[str]:
        return self._attributes()

    def __getitem__(self, topic: str) -> Any:
        if topic not in self._names:
            raise KeyError(f"no topic {topic!r} is looked at here: those that are: {', '.join(self._names)}")
        self._used.add(topic)
        if topic not in self._samples:
            raise NotYetError(topic)
        sample = self._samples[topic]
        if callable(sample):
            sample = self._samples[topic] = sample()
        return sample

    @staticmethod
    def _attributes() -> list[str]:
        return [*(kind.sample_name for kind in KINDS.values()), "seconds", "time_ns"]

    def _only(self, kind: Kind) -> str:
        try:
            return only(self._name, self._topics, kind.name)
        except UnnamedTopicError as error:
            first = error.topics[0]
            how = f"ask for one, as in moment[{first!r}], or have one of them looked at, as in topics={[first]!r}"
            raise UnnamedTopicError(error.there, error.topics, kind.name, how) from None
        except UnknownTopicError as error:
            raise AttributeError(f"{error} among those that are looked at") from None


class OneSample:
    """A moment at which there is one sample, of a widget that shows no other.

    Args:
        sample: a `Scan`, `Speed`, `Touch`, or a sample of another kind.
    """

    def __init__(self, sample: Any) -> None:
        self._sample = sample

    def __getattr__(self, name: str) -> Any:
        there = next(kind.sample_name for kind in KINDS.values() if isinstance(self._sample, kind.sample))
        if name != there:
            raise AttributeError(f"no {name!r} here: this is one {there}")
        return self._sample

    def __getitem__(self, topic: str) -> Any:
        return self._sample


class _TracedMoment:
    """A moment whose scans note what is read in them."""

    def __init__(self, moment: Any, trace: Trace) -> None:
        self._moment, self._trace = moment, trace

    def __getattr__(self, name: str) -> Any:
        return self._trace.of(getattr(self._moment, name))

    def __getitem__(self, topic: str) -> Any:
        return self._trace.of(self._moment[topic])

    def __dir__(self) -> list[str]:
        return dir(self._moment)


def sample_names(function: Callable[..., Any]) -> tuple[str, ...]:
    """The samples that a function takes, by the names of its parameters: ``lambda scan, speed: ...``.

    None where it takes a moment: where its one parameter has another name, or it tells of no parameters.

    Raises:
        TypeError: it takes several things, and not all of them are samples.
    """
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return ()
    given = [
        p.name for p in parameters if p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)
    ]
    known = [kind.sample_name for kind in KINDS.values()]
    if given and set(given) <= set(known):
        return tuple(given)
    if len(given) > 1:
        raise TypeError(
            f"condition: expected a function of one moment, or of samples by name ({', '.join(known)}); "
            f"it takes {', '.join(given)}"
        )
    return ()


class Function:
    """A condition that is true while a function returns a true value, until a sample that it read is stale.

    Args:
        function: takes an `Instant`, or the samples that its parameters name. It is called again only after a change of
            a value that it read last time.
        names: the names of the samples that it takes, where its parameters have other names.
    """

    def __init__(self, function: Callable[..., Any], names: Sequence[str] | None = None) -> None:
        self._function = function
        self._names = sample_names(function) if names is None else tuple(names)

    @property
    def reads(self) -> frozenset[str]:
        """See `Condition`."""
        return frozenset(self._names)

    def judge(self, moment: Any) -> Verdict:
        """See `Condition`."""
        trace = Trace()
        try:
            result = self._result(OneSample(moment) if isinstance(moment, HasAge) else moment, trace)
        except NotYetError:
            return Verdict(None)
        return trace.verdict(result)

    def _result(self, moment: Any, trace: Trace) -> Any:
        """What the function returns; NotYetError where a sample is not there yet."""
        if not self._names:
            return self._function(_TracedMoment(moment, trace))
        samples = [getattr(moment, name) for name in self._names]
        for name, sample in zip(self._names, samples, strict=True):
            if sample is None:
                raise NotYetError(name)
        return self._function(*map(trace.of, samples))

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:
        """See `Condition`."""
        return [topic.name for topic in _topics(recording, asked)]

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""
        recording = search.recording
        topics = _topics(recording, search.topics)
        instant = Instant(recording.path.name, topics, recording.start_ns or 0)
        times: list[int] = []
        values: list[int] = []
        used_at: list[frozenset[str]] = []
        going_stale: dict[str, list[int]] = {t.name: [] for t in topics if t.widget and KINDS[t.widget].goes_stale}
        value = UNKNOWN
        used: frozenset[str] = frozenset()
        now = instant._now
        looked = 0
        try:
            for time_ns, samples in _together({topic.name: _samples(recording, topic.name) for topic in topics}):
                if time_ns > search.end_ns and search.is_cut:
                    break
                instant._now = time_ns
                instant._samples.update(samples)
                if not times or _TIME in instant._used or not instant._used.isdisjoint(samples):
                    value = self._call(instant, search)
                    used = frozenset(instant._used)
                for topic in going_stale.keys() & samples:
                    going_stale[topic].append(time_ns)
                # In this order, so that an interrupt in between leaves no time without a value.
                values.append(value)
                used_at.append(used)
                times.append(time_ns)
                now, looked = time_ns, looked + len(samples)
                if looked >= _BAR_EVERY:
                    search.looked_at(looked)
                    looked = 0
        except KeyboardInterrupt:
            search.cut(now)
        search.looked_at(looked)
        rests_on = (
            (np.array(came, np.int64), np.array([name in names for names in used_at[: len(times)]], bool))
            for name, came in going_stale.items()
        )
        return mark_stale(steps(times, values[: len(times)]), rests_on, search.end_ns)

    def _call(self, instant: Instant, search: Search) -> int:
        instant._used.clear()
        trace = Trace()
        try:
            value = trace.value(self._result(instant, trace))
            if value and (ray := trace.nearest()):
                search.met(
                    np.array([instant._now]), np.array([ray.range]), np.array([ray.index]), np.array([ray.angle])
                )
            return UNKNOWN if value is None else YES if value else NO
        except NotYetError:
            return UNKNOWN
        except UnnamedTopicError:
            raise
        except Exception as error:
            seconds = (instant._now - instant._start_ns) / 1e9
            raise RecordingError(
                f"the condition {self} failed at {seconds:.2f} s: {type(error).__name__}: {one_line(error)}"
            ) from error

    def __str__(self) -> str:
        return str(getattr(self._function, "__name__", type(self._function).__name__))


def _topics(recording: RecordingData, asked: Any) -> list[Topic]:
    there = shown(recording.topics)
    if asked is None:
        return list(there.values())
    names = [asked] if isinstance(asked, str) else list(asked)
    for name in names:
        recording.check(name)
    return [there[name] for name in dict.fromkeys(names)]


def _together(topics: dict[str, Iterator[tuple[int, Make]]]) -> Iterator[tuple[int, dict[str, Make]]]:
    """The samples of all topics in the order of time, grouped by time.

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


def _samples(recording: RecordingData, topic: str) -> Iterator[tuple[int, Make]]:
    """The times of a topic, none before the previous one, each with the function that makes its sample."""
    latest = 0
    for chunk in recording.series(topic).chunks():
        for i, time_ns in enumerate(chunk.times_ns.tolist()):
            latest = max(latest, time_ns)
            yield latest, partial(chunk.sample, i)
