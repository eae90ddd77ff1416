"""CARMEN logs: text, a message a line, in the order in which they were logged."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Collection, Iterator
from functools import partial
from heapq import merge

from ..poses.transforms import Joint
from ..recordings.endings import LEAST, about_end
from ..recordings.timeline import Moment, Sample, Topic
from ._carmen_clock import steady
from ._carmen_feed import CarmenFeed
from ._carmen_lines import (
    ESTIMATE,
    NEW_SCANS,
    OLD_SCANS,
    SPEEDS,
    new_scan,
    old_scan,
    pose,
    range_max_of,
    speed,
    time_of,
    word_of,
)

_SHOWN = frozenset((*SPEEDS, *OLD_SCANS, *NEW_SCANS))


class CarmenLog:
    """The `Timeline` of a CARMEN log. Its topics are the names of the messages: FLASER, ROBOTLASER1, ODOM, ...

    A program that makes maps writes ODOM lines of its own into a log, each before a line NEFF: poses that it estimates,
    with a speed of 0 and mostly without a time. They are no measurement, and are counted as NEFF.

    Args:
        text: the whole log.
        problems: what was wrong with the file that held it, one line each.
    """

    def __init__(self, text: bytes, problems: Collection[str] = ()) -> None:
        words: list[str] = []
        lines: list[bytes] = []
        estimates = 0
        for line in text.splitlines():
            word = word_of(line)
            if word in _SHOWN:
                words.append(word)
                lines.append(line)
            elif word == ESTIMATE:
                estimates += 1
                if words and words[-1] == "ODOM":
                    del words[-1], lines[-1]
        self._lines = lines
        self._times, timed, about_times = steady([time_of(line) for line in lines])
        self._places: dict[str, list[int]] = {word: [] for word in words}
        for place, word in enumerate(words):
            self._places[word].append(place)
        self._reads: dict[str, Callable[[bytes], Sample]] = {word: self._reader(word) for word in self._places}
        self._left_out: dict[str, str] = {}
        self.start_ns = self._times[0] if lines else None
        self.end_ns = self._times[-1] if lines else None
        seconds = (self._times[-1] - self._times[0]) / 1e9 if timed and lines else 0.0
        self.topics = tuple(_topic(word, len(places), seconds) for word, places in self._places.items())
        ends = (
            about_end(word, len(places), self._times[places[-1]], self._times[0], self._times[-1])
            for word, places in self._places.items()
            if timed and len(places) >= LEAST
        )
        self._problems = tuple(filter(None, (*problems, about_times, *ends)))
        if estimates:
            self.topics += (Topic(ESTIMATE, f"CARMEN {ESTIMATE}", estimates, None, None, False, ""),)

    @property
    def problems(self) -> tuple[str, ...]:
        """See `Timeline`."""
        return (*self._problems, *self._left_out.values())

    def moments(self, topics: Collection[str], start_ns: int | None, stop_ns: int | None) -> Iterator[Moment]:
        """See `Timeline`."""
        first = 0 if start_ns is None else bisect_left(self._times, start_ns)
        end = len(self._lines) if stop_ns is None else bisect_left(self._times, stop_ns)
        asked = [self._part(topic, first, end) for topic in topics if topic in self._places]
        for place, topic in merge(*asked):
            moment = self._moment(topic, place)
            if moment:
                yield moment

    def last(self, topic: str, time_ns: int) -> Moment | None:
        """See `Timeline`."""
        places = self._places.get(topic, [])
        end = bisect_left(places, bisect_right(self._times, time_ns))
        return next(filter(None, (self._moment(topic, place) for place in reversed(places[:end]))), None)

    def feed(self, topic: str) -> CarmenFeed:
        """See `Timeline`."""
        return CarmenFeed(topic, self._places.get(topic, []), lambda place: self._moment(topic, place))

    def joints(self) -> Iterator[Joint]:
        """See `Timeline`. Its scans stand at the robot: a log does not tell where its scanners are on it."""
        for topic in SPEEDS:
            for place in self._places.get(topic, []):
                if (moment := self._moment(topic, place)) and (at := pose(self._lines[place])):
                    yield Joint("odom", "base_link", moment.time_ns, moment.sample.stamp_ns or 0, at, odometry=True)

    def close(self) -> None:
        """See `Timeline`: the file is closed already."""

    def _part(self, topic: str, first: int, end: int) -> list[tuple[int, str]]:
        places = self._places[topic]
        return [(place, topic) for place in places[bisect_left(places, first) : bisect_left(places, end)]]

    def _reader(self, word: str) -> Callable[[bytes], Sample]:
        if word in SPEEDS:
            return speed
        if word in NEW_SCANS:
            return new_scan
        return partial(old_scan, range_max=range_max_of([self._lines[place] for place in self._places[word]]))

    def _moment(self, topic: str, place: int) -> Moment | None:
        time_ns = self._times[place]
        try:
            return Moment(topic, time_ns, self._reads[topic](self._lines[place]), (time_ns - self._times[0]) / 1e9)
        except (TypeError, ValueError) as error:
            self._left_out.setdefault(topic, f"{topic}: lines that cannot be shown are left out, such as: {error}")
            return None


def _topic(word: str, count: int, seconds: float) -> Topic:
    rate = (count - 1) / seconds if seconds and count > 1 else None
    return Topic(word, f"CARMEN {word}", count, rate, "speed" if word in SPEEDS else "laser", False, "")
