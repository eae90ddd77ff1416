"""The tracks of a recording: the frames of each widget at every time, packed for the page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from heapq import merge
from itertools import islice
from math import inf, nan
from typing import Any, Protocol

import numpy as np

from .._core.progress import without_bars
from .._core.sample_widget import SampleWidget
from .._core.timed_frame import FRAME_HEADER, TimedFrame, table_of
from .._widget_choice import WidgetChoice
from ..kinds import sensor_of
from ..laser.trail import scanner_in
from ..laser_widget import LaserWidget
from ..messages.fields import stamp_ns
from ..path_widget import PathPoint, PathWidget
from ..poses.frame_tree import FrameTree
from ..poses.mounts import mounts_of
from ..poses.path import Path
from ..poses.recent import FARTHEST, RecentPoses
from ..poses.transforms import STATIC, TRANSFORMS, Transform, transforms_of
from ..recordings import RecordingData
from ..recordings.odometry import odometry
from ..recordings.topics import Moment
from ..samples import Pose, Touch
from ..samples.age import arrival_of
from ..samples.staleness import RECORDED, usual_step
from ..sonar_widget import SonarWidget
from ..speed_widget import Reading
from ..touch_widget import TouchWidget, about_touch, pack_states
from ._touch_history import TouchHistory

TICK = 0.1
"""The maximum number of seconds between two frames of touches: their durations grow without a message."""

_LEAST = 1e-3
"""The minimum number of seconds between them."""

BEFORE = -1.0
"""The ``seconds`` of a frame that shows that nothing was measured yet."""

MOST_POSES = 200_000
"""The maximum number of poses of a path; of more, evenly chosen ones."""

LOOKED_AT = 20
"""Samples of a topic from which its usual rate is computed."""

OF_TOPIC = "recorded"
"""The key of the topic in the texts on a frame of `TreeFrames`. Its time of arrival is in seconds from the start."""

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


class TreeFrames(MessageFrames):
    """A `Track` of the fields of messages. They can be copied as the code that reads them; see `MessageFrames`."""

    def _shown(self, seconds: float, now: Mapping[str, Moment | None]) -> TimedFrame:
        timed = super()._shown(seconds, now)
        sequence, rate, stamp, _ = FRAME_HEADER.unpack_from(timed.frame)
        head = FRAME_HEADER.pack(sequence, rate, stamp, seconds)
        about = {**timed.about, OF_TOPIC: self._choice.topic}
        return TimedFrame(seconds, about, head + timed.frame[FRAME_HEADER.size :])


class SampleFrames:
    """A `Track` of the last sample of each topic of a widget at each time.

    Args:
        recording: the recording.
        choice: the topics in their roles, and their kind.
        widget: the widget that packs the samples.
    """

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: SampleWidget) -> None:
        self._recording, self._choice, self._widget = recording, choice, widget
        self._nothing = choice.shown.nothing
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
        samples = {name: moment.sample if (moment := now[name]) else self._nothing for name in topics}
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

    def _frame(self, seconds: float, sample: Any) -> TimedFrame:
        about, frame = self._widget.frame_of(sample)
        return TimedFrame(seconds, about, _header(sample) + frame)


class ScanFrames(SampleFrames):
    """A `Track` of scans. With a trail, each has its pose by the first topic of odometry, or else by tf."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: LaserWidget) -> None:
        super().__init__(recording, choice, widget)
        self._laser = widget
        self._odometry = odometry(recording.topics)
        self._poses = RecentPoses(None)
        self._tree: FrameTree | None = None

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        self._poses = RecentPoses(None)
        if self._odometry and self._laser.trail:
            for moment in self._recording.samples(self._odometry, max(0.0, start - FARTHEST), end + FARTHEST):
                self._poses.add(moment.sample.pose, moment.seconds, moment.sample.stamp_ns)
        elif self._laser.trail and self._tree is None:
            with without_bars():
                self._tree = FrameTree(self._recording.transforms())
        return super().frames(start, end)

    def _frame(self, seconds: float, sample: Any) -> TimedFrame:
        timed = super()._frame(seconds, sample)
        if self._tree is not None:
            time_ns = (self._recording.start_ns or 0) + round(seconds * 1e9)
            return timed._replace(about=timed.about | scanner_in(self._tree, sample, time_ns))
        robot = self._poses.at(seconds, sample.stamp_ns)
        return timed._replace(about=timed.about | self._laser.scanner_at(robot))


class SonarFrames(SampleFrames):
    """A `Track` of a ring of sonars, each at its pose by tf, and stale by its own rate; see `SampleFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: SonarWidget) -> None:
        super().__init__(recording, choice, widget)
        first: dict[str, list[Moment]] = {sensor_of(name): [] for name in choice.own}
        for moment in islice(recording.samples(choice.own), LOOKED_AT * len(choice.own)):
            first[sensor_of(moment.topic)].append(moment)
        silences = {sensor: silent_after(moments) for sensor, moments in first.items()}
        widget.be_silent_after({sensor: seconds for sensor, seconds in silences.items() if seconds})
        if not widget.poses:
            mounts = mounts_of(_static_transforms(recording))
            frames = {sensor: moments[0].sample.frame_id for sensor, moments in first.items() if moments}
            widget.poses = {sensor: mounts[frame] for sensor, frame in frames.items() if frame in mounts}


class SpeedFrames(SampleFrames):
    """A `Track` of measured and commanded speeds, without peaks, because a player shows times in any order."""

    def _frame(self, seconds: float, sample: Any, commanded: Any = None) -> TimedFrame:
        _, frame = self._widget.frame_of(Reading(sample, commanded))
        return TimedFrame(seconds, {"frame_id": sample.frame_id}, _header(sample) + frame)


class PathFrames(SampleFrames):
    """A `Track` of the odometry poses, on the path of the whole recording; see `SampleFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: PathWidget) -> None:
        super().__init__(recording, choice, widget)
        if not len(widget.points):
            widget.show_whole(_path_of(recording, choice.topic))

    def _frame(self, seconds: float, sample: Any) -> TimedFrame:
        x, y, yaw = sample.pose
        return super()._frame(seconds, PathPoint(seconds, x, y, yaw, sample.stamp_ns))


class TouchFrames:
    """A `Track` of the states of touch sensors, which also change without a message; see `SampleFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: TouchWidget) -> None:
        self._recording, self._topic, self._widget = recording, choice.topic, widget
        self._start_ns = recording.start_ns or 0
        self._history = TouchHistory(recording, choice.topic)

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        moments: list[Moment | None] = [*self._recording.samples(self._topic, start, end), None]
        tracker = self._history.at(self._time_ns(start) - 1)
        seconds, end = start, max(end, start + _LEAST)  # so that the span has a frame
        unchanged: dict[str, Any] = {NEW: []}
        came = unchanged
        for moment in moments:
            until = end if moment is None else max(moment.seconds, seconds)
            while seconds < until or came is not unchanged:
                now_ns = self._time_ns(seconds)
                newest = tracker.newest or Touch({})
                frame = _header(newest) + pack_states(tracker, now_ns)
                yield TimedFrame(seconds, {**about_touch(newest), "still": True, **came}, frame)
                came = unchanged
                change_ns = tracker.next_change_ns(now_ns)
                change = until if change_ns is None else (change_ns - self._start_ns) / 1e9
                seconds = min(seconds + TICK, max(change, seconds + _LEAST), until)
            if moment is not None and isinstance(moment.sample, Touch):
                tracker.apply(moment.sample, moment.time_ns)
                came = {}

    def seek(self, seconds: float) -> None:
        """See `Track`."""
        time_ns = self._time_ns(seconds)
        self._widget.show(self._history.at(time_ns), time_ns)

    def _time_ns(self, seconds: float) -> int:
        return self._start_ns + round(seconds * 1e9)


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


def _static_transforms(recording: RecordingData) -> Iterator[Transform]:
    """Yield the static transforms of tf, without messages that contain no pose."""
    for topic in recording.topics:
        if topic.type in TRANSFORMS and topic.name.rpartition("/")[2] == STATIC and not topic.problem:
            for moment in recording.messages(topic.name):
                with suppress(ValueError):
                    yield from transforms_of(moment.message, topic.name, moment.time_ns)


def _path_of(recording: RecordingData, topic: str) -> Path:
    """Return the path of a topic of odometry, from all of its poses, or from evenly chosen ones if there are many."""
    path, start_ns = Path(), recording.start_ns or 0
    speeds = recording.speeds(topic)
    step = -(-len(speeds) // MOST_POSES) or 1
    for chunk in speeds.chunks():
        times, poses = chunk.times_ns, chunk.poses
        # The last pose of each chunk, too: the path must end at the robot.
        chosen = np.unique(np.append(np.arange(0, len(times), step), np.arange(len(times))[-1:]))
        for time_ns, pose in zip(times[chosen].tolist(), poses[chosen].tolist(), strict=True):
            path.add((time_ns - start_ns) / 1e9, Pose(*pose), clock=time_ns / 1e9)
    return path


def _header(sample: Any) -> bytes:
    """Return the header of a frame without sequence number and rate: the page numbers the frames of a player."""
    return FRAME_HEADER.pack(0.0, nan, sample.stamp_ns or 0, arrival_of(sample))
