"""The tracks of a recording: the frames of each widget at every time, packed for the page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from heapq import merge
from math import inf, nan
from typing import Any, Protocol

import numpy as np

from .kinds import OnDemandWidget, sensor_of
from .kinds.choice import WidgetChoice
from .messages.fields import stamp_ns
from .recordings import RecordingData
from .recordings.topics import Moment
from .samples.age import arrival_of
from .samples.staleness import RECORDED, usual_step
from .widget.sample_widget import SampleWidget
from .widget.timed_frame import FRAME_HEADER, TimedFrame, table_of

BEFORE = -1.0
"""The ``seconds`` of a frame that shows that nothing was measured yet."""

LOOKED_AT = 20
"""Samples of a topic from which its usual rate is computed."""

NEW = "new"
"""The key of the roles with new samples in the texts on a frame: empty without a message. Without this key, all are
new."""

TOGETHER = 0.01
"""Seconds within which the readings of the sensors of a ring are shown in one frame: they often measure together."""


class Track(Protocol):
    """The frames of one widget of a player during the recording."""

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """Yield the frame at ``start``, whose sample may be much older, and all up to ``end``, in seconds."""

    def seek(self, seconds: float) -> None:
        """Make the widget show a time, for programs that read its sample."""


class MessageFrames:
    """A `Track` of the last message of each topic of a widget at each time, of any type.

    Its widget packs a message with `frame_of`; a shared widget gets the newest message of each topic by name. For
    a topic without a message yet, it gets the row's ``nothing``.

    Args:
        recording: the recording.
        choice: the topics, and the row of the widget.
        widget: the widget that packs the messages.
    """

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: SampleWidget) -> None:
        self._recording, self._choice, self._widget = recording, choice, widget
        self._before: dict[str, int | None] = {}

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        topics = self._choice.topics
        now: dict[str, Moment | None] = {name: self._recording.message_at(name, start) for name in topics}
        seconds = max(moment.seconds if moment else BEFORE for moment in now.values())
        for moment in moments_of(self._recording, self._choice, topics, start, end):
            yield self._shown(seconds, now)
            now[moment.topic] = moment
            seconds = moment.seconds
        yield self._shown(seconds, now)

    def seek(self, seconds: float) -> None:
        """See `Track`."""
        for name in self._choice.topics:
            moment = self._recording.message_at(name, seconds)
            time_ns = moment and moment.time_ns
            if name not in self._before or self._before[name] != time_ns:
                self._before[name] = time_ns
                message = self._content(moment.message) if moment else self._choice.shown.nothing
                with suppress(TypeError, ValueError):  # the frame of that time shows the error
                    self._widget.update(*([name] if self._choice.shared else []), message)

    def _content(self, message: Any) -> Any:
        """Return the content that the widget shows of a message: the message itself."""
        return message

    def _shown(self, seconds: float, now: Mapping[str, Moment | None]) -> TimedFrame:
        nothing = self._choice.shown.nothing
        contents = {name: self._content(moment.sample) if moment else nothing for name, moment in now.items()}
        newest = now[self._choice.topic]
        about, frame = self._widget.frame_of(contents if self._choice.shared else contents[self._choice.topic])
        stamp = stamp_ns(newest.sample) if newest else None
        return TimedFrame(seconds, about, FRAME_HEADER.pack(0.0, nan, stamp or 0, 0.0) + frame)


class SampleFrames:
    """A `Track` of the last sample of each topic of a widget at each time.

    Args:
        recording: the recording.
        choice: the topics in their roles, and their kind.
        widget: the widget that packs the samples.
    """

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: SampleWidget) -> None:
        self._recording, self._choice, self._widget = recording, choice, widget
        self._nothing = {name: (role.kind or choice.shown).nothing for role, name in choice.parts}
        self._roles = {name: role.name for role, name in choice.parts}
        goes_with = choice.parts[len(choice.own) :]
        shows = [(choice.own, widget.update), *(((name,), getattr(widget, role.take)) for role, name in goes_with)]
        self._seeks = [self._seek(topics, show) for topics, show in shows]

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        topics = self._choice.topics
        now = {name: self._recording.at(name, start) for name in topics}
        seconds, newest = max((moment.seconds if moment else BEFORE, name) for name, moment in now.items())
        began = -inf
        for moment in self._recording.samples(topics, start, end):
            if not self._choice.role.combine or moment.seconds - began >= TOGETHER:
                yield self._shown(seconds, now, newest)
                began = moment.seconds
            now[moment.topic] = moment
            seconds, newest = moment.seconds, moment.topic
        yield self._shown(seconds, now, newest)

    def seek(self, seconds: float) -> None:
        """See `Track`."""
        for seek in self._seeks:
            seek(seconds)

    def _seek(self, topics: Sequence[str], show: Callable[[Any], None]) -> Callable[[float], None]:
        """Return a function that shows the last moments of some topics at a time, unless they were shown last."""
        before: list[Any] = [None]

        def seek(seconds: float) -> None:
            now = {topic: self._recording.at(topic, seconds) for topic in topics}
            times = [moment and moment.time_ns for moment in now.values()]
            if times != before[0]:
                before[0] = times
                alone = now[topics[0]] if len(topics) == 1 and self._choice.role.combine is None else None
                show(alone or self._sample(topics, now))

        return seek

    def _sample(self, topics: Sequence[str], now: Mapping[str, Moment | None]) -> Any:
        """Return the last sample of a topic, or the joined sample of all topics of a namespace."""
        samples = {name: moment.sample if (moment := now[name]) else self._nothing[name] for name in topics}
        combine = self._choice.role.combine
        if combine is None or topics != self._choice.own:
            return samples[topics[0]]
        came = {sensor_of(name): moment.seconds if (moment := now[name]) else -inf for name in topics}
        return combine({sensor_of(name): sample for name, sample in samples.items()}, came)

    def _shown(self, seconds: float, now: Mapping[str, Moment | None], newest: str) -> TimedFrame:
        """Return the frame of the last moment of each topic. If it has several roles, it names the new one."""
        own = self._choice.own
        others = {role.name: self._sample((name,), now) for role, name in self._choice.parts[len(own) :]}
        timed = self._frame(seconds, self._sample(own, now), **others)
        return timed._replace(about=timed.about | {NEW: [self._roles[newest]]}) if others else timed

    def _frame(self, seconds: float, sample: Any, **others: Any) -> TimedFrame:
        about, frame = self._widget.frame_of(sample, **others)
        return TimedFrame(seconds, about, frame_header(sample) + frame)


def track_of(recording: RecordingData, choice: WidgetChoice, widget: SampleWidget) -> Track:
    """Return the frames of a chosen widget in a recording."""
    row = choice.shown
    make: Callable[..., Track] = MessageFrames if isinstance(row, OnDemandWidget) else SampleFrames
    if row.frames is not None:
        make = row.frames()
    return make(recording, choice, widget)


def pack(frames: list[TimedFrame]) -> tuple[list[dict[str, Any]], bytes]:
    """Pack frames in the format of the page: each text once, and a table of times before the bytes."""
    abouts, rows = table_of(frames)
    return abouts, b"".join([np.float64(len(frames)).tobytes(), rows.tobytes(), *(timed.frame for timed in frames)])


def moments_of(
    recording: RecordingData,
    choice: WidgetChoice,
    topics: Sequence[str],
    start: float | None = None,
    end: float | None = None,
) -> Iterator[Moment]:
    """Yield the samples, or the messages, that a widget takes from some of its topics, in the order of time."""
    if not choice.takes_messages:
        return recording.samples(topics, start, end)
    each = (recording.messages(topic, start, end) for topic in topics)
    return merge(*each, key=lambda moment: moment.time_ns)


def moment_at(recording: RecordingData, choice: WidgetChoice, topic: str, seconds: float) -> Moment | None:
    """Return the last of these at a time or before it, or None before the first."""
    return recording.message_at(topic, seconds) if choice.takes_messages else recording.at(topic, seconds)


def silent_after(first: Iterable[Moment]) -> float:
    """Return the seconds after which a sample is stale, from the first moments of its topic; 0 if unknown.

    Silences would distort the mean rate of the whole topic.
    """
    times = [moment.time_ns for moment in first]
    return RECORDED.after(usual_step(np.array(times, np.int64)), 1e9) / 1e9 if len(times) > 1 else 0.0


def frame_header(sample: Any) -> bytes:
    """Return the header of a frame without sequence number and rate: the page numbers the frames of a player."""
    return FRAME_HEADER.pack(0.0, nan, sample.stamp_ns or 0, arrival_of(sample))
