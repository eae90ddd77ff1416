"""The data of a recording: its topics, and their samples one by one or as columns."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from .._core.tables import Table
from .._core.text import megabytes
from ..kinds import KINDS, LASER, SPEED, TOUCH, Kind
from ..poses.places import WITHIN, Places, to_place
from ..repair import RecordingError
from ..samples import Mount, Problem, Scan
from ..samples.checks import not_negative
from ..samples.event import Event, holds, to_level, to_words
from ..samples.state_span import StateSpan
from ._info import heading, table_of
from ._sample_reader import Messages
from .columns._clock_problems import TopicClock, about_clocks, clock_of
from .columns._fields import Fields
from .columns._memory import Memory
from .columns.scans import Scans
from .columns.series import Series
from .columns.speeds import Speeds
from .columns.touches import Touches
from .events import Events, RecordedEvent, has_events
from .files import open_as_ros
from .labels import Label, LabelFile, LabelledSpan, labelled_span, with_clock
from .odometry import places_of
from .program_log import PROGRAM, STATES, ProgramVersion, spans_of, version_of
from .remote import fetch, held, is_url
from .time_slice import TimeSlice
from .times import seconds_at, span_ns, to_ns
from .topics import Moment, TimedMessage, Topic, UnknownTopicError, check, check_known, named, only, shown, wanted

if TYPE_CHECKING:
    from typing_extensions import Self

    from ..poses.transforms import Transform

_EVENT_BYTES = 500
"""About what an event takes in memory, without its text."""

_NOTHING = "record again; did any node publish, in the same ROS domain?"
NO_SENSOR = "none of its topics has a widget for its kind of sensor"
"""What a recording says of which no widget shows anything unless it is asked for it."""

_NO_WIDGET = "its messages are shown as they are; record laser scans, odometry, speeds or bumpers too"
_CLOCKS = "check sensor, cable and network; set the clock before recording starts, and not during a drive"

AnySeries = TypeVar("AnySeries", Scans, Speeds, Touches)


class RecordingData:
    """The topics of a recording and their samples, without any widget.

    Printed, it is a table of its topics. As a context manager it closes the file. One thread at a time may read it.

    Args:
        path: the file, the folder or the URL, as for `robowidgets.open`.

    Raises:
        RecordingError: nothing of it can be read. The text gives the reason.
        TypeError: ``path`` is no path.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        if not isinstance(path, (str, bytes, os.PathLike)):
            raise TypeError(f"path: expected the path of a recording, as text or as a pathlib.Path, got {path!r}")
        self._file = fetch(path) if is_url(path) else held(Path(os.fsdecode(path)).expanduser())
        self._path, self._url = self._file.path, self._file.url
        try:
            self._messages = Messages(open_as_ros(self._path))
        except BaseException:
            self._file.close()
            raise
        self._closed = False
        self.preferred: frozenset[str] = frozenset()
        """Names of topics that are meant where a kind has several and none is named."""
        self._memory = Memory()
        self._series: dict[str, Series[Any]] = {}
        self._clocks: dict[str, TopicClock] = {}
        self._label_problems: list[Problem] = []
        self._fields: dict[str, Fields] = {}
        """Of the topics that were read from start to end, and are not silent for long in a sound recording."""

    @property
    def path(self) -> Path:
        """The file or folder of the recording; of one behind a URL, its copy."""
        return self._path

    @property
    def url(self) -> str | None:
        """The URL that it was fetched from; None for a file of this machine.

        It has no password, signature or token. While this process runs, it opens what was opened with them.
        """
        return self._url

    @property
    def topics(self) -> tuple[Topic, ...]:
        """All topics, in the order of the file, with type, count, rate and the widget that shows them."""
        return self._messages.topics

    @property
    def publishers(self) -> dict[str, tuple[str, ...]]:
        """The names of the nodes that published each topic: bags of ROS 1 hold them, other files do not."""
        return self._messages.publishers

    @property
    def start_ns(self) -> int | None:
        """Time of the first message in nanoseconds since the epoch; None if there is no message."""
        return self._messages.start_ns

    @property
    def end_ns(self) -> int | None:
        """Time of the last message in nanoseconds since the epoch; None if there is no message."""
        return self._messages.end_ns

    @property
    def duration(self) -> float:
        """Seconds from the first message to the last; 0 if there is no message."""
        return 0.0 if self.start_ns is None or self.end_ns is None else (self.end_ns - self.start_ns) / 1e9

    @property
    def problems(self) -> tuple[str, ...]:
        """The problems found so far: of the file, of topics, of messages that could not be shown.

        Each is a line of at most 200 characters.
        Problems of the clock of a topic are found when its `scans` or measured `speeds` are read, and several frames on
        one topic when its messages are.
        """
        return tuple(str(problem._replace(remedy="")) for problem in self._with_remedies())

    def samples(
        self, topics: str | Iterable[str] | None = None, start: float | None = None, end: float | None = None
    ) -> Iterator[Moment]:
        """The samples in the order of their times, read one by one.

        A message that cannot be shown is left out and named in `problems`.

        Args:
            topics: one topic or several; None: all that a widget shows.
            start: seconds from the start of the recording; None: its start.
            end: seconds from the start, not included; None: the end of the recording, included.

        Raises:
            UnknownTopicError: the recording has no such topic, or no widget shows it.
            RecordingError: the recording is closed.
        """
        names = list(shown(self.topics) if topics is None else [topics] if isinstance(topics, str) else topics)
        for name in names:
            self.check(name)
        times = span_ns(self.start_ns, start, end)
        self._check_open()
        return self._messages.moments(list(dict.fromkeys(names)), *times)

    def at(self, topic: str, seconds: float) -> Moment | None:
        """The last sample of a topic at a time or before it; None if there is none yet.

        Args:
            topic: the name of the topic.
            seconds: seconds from the start of the recording.

        Raises:
            UnknownTopicError: the recording has no such topic, or no widget shows it.
            RecordingError: the recording is closed.
        """
        self.check(topic)
        self._check_open()
        return self._messages.last(topic, to_ns(self.start_ns, "seconds", seconds))

    def messages(self, topic: str, start: float | None = None, end: float | None = None) -> Iterator[TimedMessage]:
        """The messages of a topic of any type, in the order of their times, read one by one.

        Each has the fields of its definition in ``message``, beside ``seconds`` and ``time_ns``. A message that cannot
        be read is left out and named in `problems`.

        Args:
            topic: the name of the topic, whether a widget shows it or not.
            start: seconds from the start of the recording; None: its start.
            end: seconds from the start, not included; None: the end of the recording, included.

        Raises:
            UnknownTopicError: the recording has no such topic, or its messages cannot be read; the text says why.
            RecordingError: the recording is closed.

        Examples:
            >>> for moment in recording.messages("/imu", 2, 5):  # doctest: +SKIP
            ...     print(moment.seconds, moment.message.linear_acceleration.x)
        """
        self._check_readable(topic)
        return self._messages.messages([topic], *span_ns(self.start_ns, start, end))

    def thinned_messages(self, topic: str, every: int) -> Iterator[TimedMessage]:
        """The messages of a topic of which about every second, third and so on is read, with the first and the last.

        Raises:
            UnknownTopicError, RecordingError: as `messages`.
        """
        self._check_readable(topic)
        return self._messages.messages([topic], None, None, every=every)

    def message_at(self, topic: str, seconds: float) -> TimedMessage | None:
        """The last message of a topic of any type, at a time or before it; None if there is none yet.

        Args:
            topic: the name of the topic.
            seconds: seconds from the start of the recording.

        Raises:
            UnknownTopicError, RecordingError: as `messages`.
        """
        self._check_readable(topic)
        found = self._messages.last(topic, to_ns(self.start_ns, "seconds", seconds), as_messages=True)
        return found if isinstance(found, TimedMessage) else None

    def events(
        self,
        *topics: str,
        level: str | int | None = None,
        text: str | None = None,
        start: float | None = None,
        end: float | None = None,
    ) -> Events:
        """What happened, as a table: lines of logs, changes of status, texts, buttons, touches, states of programs.

        Of DiagnosticArray, Joy and touch sensors each change is an event, of rosout and String each message. States and
        versions of programs are in recordings that `Feed.record` wrote.

        Args:
            *topics: names of topics; none: all that tell of events.
            level: only those of a level or a higher one: ``"DEBUG"``, ``"INFO"``, ``"WARN"``, ``"ERROR"``, ``"FATAL"``.
            text: only those with these words in their text or their source, in any case.
            start: seconds from the start of the recording; None: its start.
            end: seconds from the start, not included; None: the end of the recording, included.

        Raises:
            UnknownTopicError: the recording has no such topic, or it tells of no events; the text says which do.
            TypeError, ValueError: no level, no text, or no time.
            RecordingError: the recording is closed, or the events would take more than `memory`.

        Examples:
            >>> recording.events("/rosout", level="WARN").to_pandas()  # doctest: +SKIP
        """
        least, words = None if level is None else to_level("level", level), to_words("text", text)
        first_ns, stop_ns = span_ns(self.start_ns, start, end)
        found, size = [], 0
        for time_ns, event in self.timed_events(topics, stop_ns):
            if not holds(event, least, words) or (first_ns is not None and time_ns < first_ns):
                continue
            size += _EVENT_BYTES + len(event.text)
            if size > self.memory:
                raise RecordingError(
                    f"{self.path.name}: its events up to {self._seconds(time_ns):.1f} s take more than the "
                    f"{megabytes(self.memory)} of recording.memory: take a span of them (start=, end=), those of a "
                    "level, or those with some words; or set it higher, in bytes"
                )
            found.append(
                RecordedEvent(
                    self._seconds(time_ns),
                    event.level,
                    event.source,
                    event.text,
                    event.topic,
                    time_ns,
                    event.stamp_ns or 0,
                )
            )
        what = (f" of {least.name} or more" if least else "") + (f" with {words!r}" if words else "")
        return Events(sorted(found, key=lambda one: one.time_ns), what)

    def timed_events(
        self, topics: Collection[str] = (), stop_ns: int | None = None, *, every_line: int = 1
    ) -> Iterator[tuple[int, Event]]:
        """The events on topics, or on all that tell of any, about in the order of their times in nanoseconds.

        Args:
            topics: names of topics.
            stop_ns: the time at which to stop, not included; None: the end.
            every_line: of lines of logs below a warning only every second, third and so on; 0: none of them.
        """
        self._check_open()
        telling = [topic.name for topic in self.topics if has_events(topic)]
        by_name = [topic.name for topic in self.topics if has_events(topic, by_name=True)]
        for name in topics:
            self._check_readable(name)
            if name not in by_name:
                there = ", ".join(by_name) or "none"
                raise UnknownTopicError(f"{self.path.name}: {name!r} tells of no events: those that do are {there}")
        end_ns = stop_ns if stop_ns is not None else (self.end_ns or 0) + 1
        found = self._messages.events(list(topics) or telling, stop_ns, every_line)
        return ((time_ns, event) for time_ns, event in found if time_ns < end_ns)

    def _seconds(self, time_ns: int) -> float:
        return (time_ns - (self.start_ns or 0)) / 1e9

    def seconds_at(self, when: datetime | str) -> float:
        """Seconds from the start of the recording at a date and time of day, as `at` and a player's `seek` take them.

        Args:
            when: a datetime, or a text such as ``"2024-05-03T14:32:05"``; in UTC unless it has a time zone.

        Raises:
            ValueError: the recording does not contain that time, or the text is no date and time.
            TypeError: ``when`` is neither a datetime nor a text.
            RecordingError: the recording has no date, for example because its clock is that of a simulation.
        """
        return seconds_at(when, self.path.name, self.start_ns, self.end_ns)

    def seconds_near(self, pose: Sequence[float], within: float = WITHIN) -> float | None:
        """Seconds from the start at which the robot was nearest to a pose when it scanned; None if it never came near.

        ``run_b.seconds_near(run_a.at("/odom", 12.0).sample.pose)`` is the same place in another run, if the odometry of
        both began at the same place. Of several topics of odometry the first by name counts.

        Args:
            pose: x and y in metres and yaw in radians, in the frame of the odometry.
            within: most metres between both; a radian of heading counts as a metre.

        Raises:
            UnknownTopicError: the recording has no odometry.
            TypeError: ``pose`` is no pose. ValueError: it is not finite, or ``within`` is below 0 or not finite.
        """
        within = not_negative("within", within, "metres")
        place = Places(np.zeros(1), np.array([to_place("pose", pose)]))
        (seconds,), (apart,) = places_of(self).nearest(place)
        return float(seconds) if apart <= within else None

    @property
    def memory(self) -> int:
        """Most bytes of decoded samples that `scans`, `speeds` and `touches` keep; 1 GiB, settable.

        A larger array is refused, with an error that gives the next step.

        Raises:
            TypeError: the new value is no whole number.
            ValueError: the new value is 0 or less.
        """
        return self._memory.limit

    @memory.setter
    def memory(self, limit: int) -> None:
        self._memory.limit = limit

    def series(self, topic: str) -> Series[Any]:
        """A topic of any type as columns.

        Topics of scans, speeds and touches are as `scans`, `speeds` and `touches` return them, all others as `fields`.

        Raises:
            UnknownTopicError: the recording has no such topic, or its messages cannot be read; the text says why.
            RecordingError: the recording is closed.
        """
        if check_known(topic, self.topics, self.path.name).name not in shown(self.topics):
            return self.fields(topic)
        self._check_open()
        if topic not in self._series:
            self._series[topic] = self._messages.series(topic, self._memory)
        return self._series[topic]

    def fields(self, topic: str) -> Fields:
        """The messages of a topic of any type with each of their fields as a column, also of scans and speeds.

        Raises:
            UnknownTopicError: the recording has no such topic, or its messages cannot be read; the text says why.
            RecordingError: the recording is closed.

        Examples:
            >>> import robowidgets
            >>> fields = robowidgets.open(robowidgets.SAMPLE).fields("/odom")
            >>> fields["pose.pose.position.x"].shape == fields.seconds.shape
            True
        """
        self._check_readable(topic)
        if topic not in self._fields:
            self._fields[topic] = self._messages.fields(topic, self._memory)
        return self._fields[topic]

    def scans(self, topic: str | None = None) -> Scans:
        """The scans of a topic as columns: times, ranges (N, R), intensities, geometry.

        Args:
            topic: may be omitted if only one topic has this kind.

        Raises:
            UnknownTopicError: no such topic has scans, or no topic was named and there is not exactly one.
            RecordingError: the recording is closed.
        """
        return self._of_kind(topic, LASER, Scans)

    def speeds(self, topic: str | None = None) -> Speeds:
        """The speeds of a topic as columns: times, linear (N, 3), angular (N, 3).

        Args:
            topic: may be omitted if only one topic has measured speeds, or any speeds.

        Raises:
            UnknownTopicError: as `scans`.
            RecordingError: the recording is closed.
        """
        return self._of_kind(topic, SPEED, Speeds)

    def touches(self, topic: str | None = None) -> Touches:
        """The touches of a topic as columns: times, and the state of each sensor (N, L).

        Args:
            topic: may be omitted if only one topic has this kind.

        Raises:
            UnknownTopicError: as `scans`.
            RecordingError: the recording is closed.
        """
        return self._of_kind(topic, TOUCH, Touches)

    def transforms(self, every: int = 1, *, odometry: bool = True) -> Iterator[Transform]:
        """The transforms of odometry and tf, in the order of time.

        Args:
            every: about every second, third and so on of the messages of each topic is read, and its first ones.
            odometry: whether those of odometry are among them.
        """
        self._check_open()
        return self._messages.transforms(every, odometry)

    @property
    def transform_count(self) -> int:
        """The number of messages that `transforms` reads."""
        return self._messages.transform_count

    def mount_of(self, frame_id: str, seconds: float | None = None) -> Mount | None:
        """How a scanner stands on the robot: as `mount` says, else by tf; None if neither tells it.

        Args:
            frame_id: the coordinate frame of its scans.
            seconds: when, for a scanner that moves on its robot; None: at the start.

        Raises:
            TypeError: frame_id is not a text. RecordingError: the recording is closed.
        """
        self._check_open()
        if not isinstance(frame_id, str):
            raise TypeError(f"frame_id: expected the name of a coordinate frame, got {frame_id!r}")
        return self._messages.mounts.of(frame_id, None if seconds is None else to_ns(self.start_ns, "seconds", seconds))

    def mounted(self, scan: Scan) -> Scan:
        """A scan that was made of a message of this recording, with the angles of the robot if its mount is known."""
        return self._messages.mounts.mounted(scan)

    def mount(self, frame_id: str, yaw: float | str | None, *, upside_down: bool = False) -> None:
        """Say how a scanner stands on the robot, in place of tf: angles of its scans are the robot's from now on.

        Columns that were taken before keep their angles, and so do pictures on show.

        Args:
            frame_id: the coordinate frame of its scans.
            yaw: radians, or degrees as text (``"90deg"``), by which its forward is turned from the robot's,
                counter-clockwise, or None to use tf again.
            upside_down: True if it stands on its head.

        Raises:
            TypeError: frame_id is not a text, or yaw is not an angle. ValueError: yaw is beyond ±2 pi.
            RecordingError: the recording is closed.

        Examples:
            >>> recording.mount("rplidar_link", "90deg")  # doctest: +SKIP
        """
        self.mount_of(frame_id)
        mount = None if yaw is None else Mount.by_hand(yaw, upside_down=upside_down)
        self._messages.mounts.put(frame_id, mount)
        self._messages.forget_scans()
        self._series.clear()

    @property
    def labels(self) -> tuple[Label, ...]:
        """The spans that people gave a name, by `label` or on a contact sheet: label, start and end in seconds."""
        found, problems = LabelFile(self.path.parent).read()
        self._label_problems = [
            Problem(line, "the others are read; mend the line, or take it out") for line in problems
        ]
        return tuple(with_clock(one, self.start_ns or 0) for one in found.get(self.path.name, ()))

    def label(self, name: str, start: float, end: float) -> Label:
        """Give a span a name. It is kept in ``labels.jsonl`` beside the recording, a line of JSON for each.

        Args:
            name: such as ``"door"``.
            start: seconds from the start of the recording.
            end: seconds from its start.

        Raises:
            TypeError, ValueError: no name, or no span. RecordingError: the labels cannot be written there.
        """
        span = labelled_span(name, start, end)
        with self._writing_labels("kept") as file:
            file.add(self.path.name, span)
        return with_clock(span, self.start_ns or 0)

    def remove_label(self, label: Label) -> None:
        """Take a name from a span. The file says so in a line of its own, so that the earlier line is not lost.

        Args:
            label: one of `labels`.

        Raises:
            ValueError: the recording has no such label. RecordingError: the labels cannot be written there.
        """
        if label not in self.labels:
            raise ValueError(f"label: {self.path.name} has no {label!r}")
        with self._writing_labels("taken away") as file:
            file.remove(self.path.name, LabelledSpan(*label[:3]))

    @contextmanager
    def _writing_labels(self, done: str) -> Iterator[LabelFile]:
        """The file of the labels; what keeps it from being written becomes a RecordingError."""
        if self.url is not None:
            raise RecordingError(f"{self.path.name} is a copy of {self.url}, which has no place for labels beside it")
        try:
            yield LabelFile(self.path.parent)
        except OSError as error:
            raise RecordingError(f"{self.path.name}: the label is not {done}: {error.strerror or error}") from None

    @property
    def states(self) -> tuple[StateSpan, ...]:
        """The spans in which states of a program were active, by start; none unless `Feed.record` wrote the file.

        Raises:
            RecordingError: the recording is closed.
        """
        self._check_open()
        return spans_of(self._messages.texts(lambda topic: topic.startswith(STATES)), self.duration)

    @property
    def programs(self) -> tuple[ProgramVersion, ...]:
        """The versions of the programs that drove, with their text; none unless `Feed.record` wrote the file.

        Raises:
            RecordingError: the recording is closed.
        """
        self._check_open()
        said = self._messages.texts(lambda topic: topic == PROGRAM)
        return tuple(version_of(seconds, text) for _, seconds, text in said)

    def info(self) -> str:
        """The table of the topics, as text."""
        return self._table().to_text()

    def reopened(self) -> Self:
        """Return the same recording, opened again, for example in another thread: with its mounts by hand and memory.

        Raises:
            RecordingError: the file does not exist any more.
        """
        other = type(self)(self.path if self.url is None or self.path.exists() else self.url)
        for frame_id, mount in self._messages.mounts.by_hand.items():
            other.mount(frame_id, mount.yaw, upside_down=mount.upside_down)
        other.memory = self.memory
        return other

    def close(self) -> None:
        """Close the file; doing it again does nothing."""
        self._closed = True
        self._note_clocks()
        self._series.clear()
        self._fields.clear()
        self._messages.close()
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __getitem__(self, which: slice | Sequence[float]) -> TimeSlice:
        """The slice of a span: ``recording[2:5]`` in seconds, a selection, or a span of `find`."""
        return TimeSlice(self, which)

    def __iter__(self) -> Iterator[Moment]:
        return self.samples()

    def __repr__(self) -> str:
        return self.info()

    def _repr_html_(self) -> str:
        return self._table().to_html()

    def _table(self) -> Table:
        self.check_topics()
        return table_of(self._heading(), self.topics, self.problems)

    def _heading(self) -> str:
        return heading(self._url or str(self.path), self.topics, self.duration, self.start_ns)

    def check(self, name: str) -> None:
        """Check that the recording has a topic of this name that a widget shows.

        Raises:
            UnknownTopicError: it has none.
            TypeError: the name is no text.
        """
        check(name, self.topics, self.path.name)

    def only(self, widget: str) -> str:
        """The topic that is meant where none of a kind is named: the only one, or the one in `preferred`.

        Raises:
            UnknownTopicError: there is none; or there are several, as `UnnamedTopicError`.
        """
        return only(self.path.name, self.topics, widget, self.preferred)

    def check_topics(self) -> None:
        """Read the first message of each topic, once: what makes a topic unreadable is in `problems` then.

        `info` and `doctor` begin with it.
        """
        if not self._closed:
            self._messages.check_topics()

    def why_unreadable(self, name: str) -> str:
        """Why no message of a topic can be read; empty if they can be, whether a widget shows them or not."""
        return self._messages.why_unreadable(name)

    def _with_remedies(self) -> tuple[Problem, ...]:
        found = (*self._messages.problems, *self._label_problems)
        if self.start_ns is None:
            return (*found, Problem("there is no message in it: nothing was recorded", _NOTHING))
        if not shown(self.topics):
            return (*found, Problem(NO_SENSOR, _NO_WIDGET))
        if not wanted(shown(self.topics).values(), ()):
            return (*found, Problem("no message came on its topics that a widget shows", _NOTHING))
        return (*found, *(Problem(line, _CLOCKS) for line in about_clocks(self._note_clocks())))

    def _check_readable(self, name: str) -> None:
        """Check that the recording is open and has messages of a topic that can be read."""
        check_known(name, self.topics, self.path.name)
        self._check_open()
        if why := self._messages.why_unreadable(name):
            raise UnknownTopicError(f"{self.path.name}: topic {name!r} cannot be read: {why}")

    def _check_open(self) -> None:
        if self._closed:
            raise RecordingError(f"{self.path.name} is closed: open it again")

    def _of_kind(self, topic: str | None, kind: Kind, series: type[AnySeries]) -> AnySeries:
        name = self.only(kind.name) if topic is None else topic
        found = self.series(name)
        if not isinstance(found, series):
            there = ", ".join(named(self.topics, kind.name)) or "none"
            noun = KINDS[shown(self.topics)[name].widget or ""].noun
            raise UnknownTopicError(
                f"{self.path.name}: {name!r} is a topic of {noun}: those of {kind.noun} are {there}"
            )
        return found

    def _note_clocks(self) -> dict[str, TopicClock]:
        """Store the clocks of topics that were read from start to end, so that they outlive `close`; returns them."""
        for name, series in self._series.items():
            topic = shown(self.topics)[name]
            grows_stale = KINDS[topic.widget or ""].goes_stale and not topic.commanded
            if grows_stale and series.is_read and name not in self._clocks:
                self._clocks[name] = clock_of(series.times_ns, self.start_ns or 0)
        return self._clocks
