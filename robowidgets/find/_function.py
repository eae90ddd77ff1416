"""A condition that is a function of one moment."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kinds import Widget
from ..messages.decoding import one_line
from ..recordings._silence import until_old
from ..recordings.kinds import only
from ..recordings.timeline import Sample, Topic
from ..recordings.topics import shown
from ..repair.source import RecordingError, UnknownTopicError, UnnamedTopicError
from ..samples import Scan, Speed, Touch
from ._steps import NO, UNKNOWN, YES, Steps, steps
from .conditions import Condition

if TYPE_CHECKING:
    from ..recording import Recording
    from ._search import Search

_TIME = ""
_BAR_EVERY = 500

Make = Callable[[], Sample]


class NotYetError(LookupError):
    """A topic has not said anything yet. Whatever depends on it is unknown."""


class Instant:
    """All that is known at one moment: of each topic the last sample up to then.

    ``moment.scan``, ``moment.speed`` and ``moment.touch`` are those of the one topic of their kind (of speeds, the one
    that is measured); ``moment["/cmd_vel"]`` is that of any topic. ``moment.seconds`` counts from the start of the
    recording, ``moment.time_ns`` is by its clock.

    Raises:
        UnknownTopicError: there are several topics of a kind, so that one has to be named.
    """

    def __init__(self, name: str, topics: list[Topic], start_ns: int) -> None:
        self._name = name
        self._topics = topics
        self._all = [topic.name for topic in topics]
        self._meant: dict[Widget, str] = {}
        self._start_ns = start_ns
        self._now = start_ns
        self._samples: dict[str, Callable[[], Sample] | Sample] = {}
        self._asked: set[str] = set()

    @property
    def scan(self) -> Scan:
        """The last scan."""
        return self._of("laser")  # type: ignore[no-any-return]

    @property
    def speed(self) -> Speed:
        """The last measured speed."""
        return self._of("speed")  # type: ignore[no-any-return]

    @property
    def touch(self) -> Touch:
        """What is known of the touch sensors."""
        return self._of("touch")  # type: ignore[no-any-return]

    @property
    def time_ns(self) -> int:
        """Nanoseconds since the epoch."""
        self._asked.add(_TIME)
        return self._now

    @property
    def seconds(self) -> float:
        """Seconds from the start of the recording."""
        return (self.time_ns - self._start_ns) / 1e9

    def __getitem__(self, topic: str) -> Any:
        if topic not in self._all:
            raise KeyError(f"no topic {topic!r} is looked at here: those that are: {', '.join(self._all)}")
        self._asked.add(topic)
        if topic not in self._samples:
            raise NotYetError(topic)
        sample = self._samples[topic]
        if callable(sample):
            sample = self._samples[topic] = sample()
        return sample

    def _of(self, widget: Widget) -> Any:
        if widget not in self._meant:
            self._meant[widget] = self._only(widget)
        return self[self._meant[widget]]

    def _only(self, widget: Widget) -> str:
        try:
            return only(self._name, self._topics, widget)
        except UnnamedTopicError as error:
            first = error.topics[0]
            how = f"ask for one, as in moment[{first!r}], or have one of them looked at, as in topics={[first]!r}"
            raise UnnamedTopicError(error.there, error.topics, widget, how) from None
        except UnknownTopicError as error:
            raise AttributeError(f"{error} among those that are looked at") from None


class Function(Condition):
    """Holds from each moment on at which a function returns something true, until a scan or speed that it saw is old.

    Args:
        function: takes an `Instant`. It is called again only when something changes that it looked at last time.
    """

    def __init__(self, function: Callable[[Instant], Any]) -> None:
        self._function = function

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""
        recording = search.recording
        topics = _topics(recording, search.topics)
        instant = Instant(recording.path.name, topics, recording.start_ns or 0)
        times: list[int] = []
        values: list[int] = []
        looked_at: list[frozenset[str]] = []
        # What is said of touches holds until a message says otherwise.
        grow_old: dict[str, list[int]] = {topic.name: [] for topic in topics if topic.widget != "touch"}
        value = UNKNOWN
        asked: frozenset[str] = frozenset()
        now = instant._now
        looked = 0
        try:
            for time_ns, samples in _together({topic.name: _samples(recording, topic) for topic in topics}):
                if time_ns > search.end_ns and search.is_cut:
                    break
                instant._now = time_ns
                instant._samples.update(samples)
                if not times or _TIME in instant._asked or not instant._asked.isdisjoint(samples):
                    value = self._call(instant)
                    asked = frozenset(instant._asked)
                for topic in grow_old.keys() & samples:
                    grow_old[topic].append(time_ns)
                # In this order, so that an interrupt in between leaves no time without a value.
                values.append(value)
                looked_at.append(asked)
                times.append(time_ns)
                now, looked = time_ns, looked + len(samples)
                if looked >= _BAR_EVERY:
                    search.looked_at(looked)
                    looked = 0
        except KeyboardInterrupt:
            search.cut(now)
        search.looked_at(looked)
        depends = (
            (np.array(said, np.int64), np.array([name in there for there in looked_at[: len(times)]], bool))
            for name, said in grow_old.items()
        )
        return until_old(steps(times, values[: len(times)]), depends, search.end_ns)

    def _call(self, instant: Instant) -> int:
        instant._asked.clear()
        try:
            return YES if self._function(instant) else NO
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


def _topics(recording: Recording, asked: Any) -> list[Topic]:
    there = shown(recording.topics)
    if asked is None:
        return list(there.values())
    names = [asked] if isinstance(asked, str) else list(asked)
    for name in names:
        recording.check(name)
    return [there[name] for name in dict.fromkeys(names)]


def _together(topics: dict[str, Iterator[tuple[int, Make]]]) -> Iterator[tuple[int, dict[str, Make]]]:
    """The samples of all topics in the order of time, those of one time together.

    Where topics have several at one time, first the first of each come together, then the second, and so on.
    """
    heads = {topic: head for topic, samples in topics.items() if (head := next(samples, None))}
    while heads:
        now = min(time_ns for time_ns, _ in heads.values())
        said = {topic: make for topic, (time_ns, make) in heads.items() if time_ns == now}
        yield now, said
        for topic in said:
            if head := next(topics[topic], None):
                heads[topic] = head
            else:
                del heads[topic]


def _samples(recording: Recording, topic: Topic) -> Iterator[tuple[int, Make]]:
    """Times that never go back, and what makes the sample of each."""
    if topic.widget == "touch":
        touches = recording.touches(topic.name)
        held = accumulate(touches.times_ns.tolist(), max)
        yield from ((time_ns, partial(touches.sample, i)) for i, time_ns in enumerate(held))
        return
    latest = 0
    series: Any = recording.scans(topic.name) if topic.widget == "laser" else recording.speeds(topic.name)
    for chunk in series.chunks():
        for i, time_ns in enumerate(chunk.times_ns.tolist()):
            latest = max(latest, time_ns)
            yield latest, partial(chunk.sample, i)
