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

from ..files import in_ros
from ..files.remote import is_url, opened, opened_here
from ..kinds import KINDS, add_installed, kind_of_class
from ..poses.places import WITHIN, Places, to_place
from ..repair import RecordingError, Source
from ..runtime.tables import HasTable, Table
from ..runtime.text import megabytes
from ..samples import Mount, Problem, Scan, Speed, Touch
from ..samples.checks import not_negative
from ..samples.event import Event, holds, to_level, to_words
from ..samples.state_span import StateSpan
from ._info import heading, table_of
from ._sample_reader import Messages
from .columns._clock_problems import TopicClock, about_clocks, clock_of
from .columns._fields import Fields
from .columns._memory import Memory
from .columns.chunks import ScanChunk
from .columns.scans import Scans
from .columns.series import Series
from .columns.speeds import Speeds
from .columns.touches import Touches
from .events import Events, RecordedEvent, has_events
from .field_table import FieldTable, field_table
from .labels import Label, LabelFile, LabelledSpan, labelled_span, with_clock
from .odometry import places_of
from .program_log import PROGRAM, STATES, ProgramVersion, spans_of, version_of
from .time_slice import TimeSlice
from .times import seconds_at, span_ns, to_ns
from .topics import Moment, TimedMessage, Topic, UnknownTopicError, check, check_known, named, only, shown, wanted

if TYPE_CHECKING:
    from typing_extensions import Self

    from ..poses.transforms import Transform

_EVENT_BYTES = 500
"""Approximate bytes of an event in memory, without its text."""

MOST_FETCHED, MOST_READ = 64 << 20, 4 << 30
"""Bytes of a topic on a server and on a disk up to which all of it is read without a request."""

THINNED_FETCHED, THINNED_READ = (64 << 20, 100), (512 << 20, 500)
"""Bytes and parts, on a server and on a disk, that are read of a larger topic to show it in parts."""

_NOTHING = "record again; did any node publish, in the same ROS domain?"
NO_SENSOR = "none of its topics has a widget for its kind of sensor"
"""The problem of a recording that no widget shows unless the user names a topic."""

_NO_WIDGET = "its messages are shown as they are; record laser scans, odometry, speeds or bumpers too"
_CLOCKS = "check sensor, cable and network; set the clock before recording starts, and not during a drive"

AnySeries = TypeVar("AnySeries", Scans, Speeds, Touches)


class RecordingData(HasTable):
    """The topics of a recording and their samples, without any widget.

    Printed, it is a table of its topics. As a context manager it closes the file. One thread at a time may read it.

    Args:
        path: the file, the folder or the URL, as for `robowidgets.open`.

    Raises:
        RecordingError: no part of it can be read. The text gives the reason.
        TypeError: ``path`` is not a path.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        if not isinstance(path, (str, bytes, os.PathLike)):
            raise TypeError(f"path: expected the path of a recording, as text or as a pathlib.Path, got {path!r}")
        if not os.fspath(path):
            raise RecordingError('path: expected the path of a recording, got an empty text; "." is this folder')
        add_installed()
        if is_url(path):
            self._file, self._source = opened(path)
        else:
            self._file, self._source = opened_here(Path(os.fsdecode(path)).expanduser())
        self._path, self._url = self._file.path, self._file.url
        try:
            self._messages = Messages(in_ros(self._source))
        except BaseException:
            self._source.close()
            self._file.close()
            raise
        self._closed = False
        self.preferred: frozenset[str] = frozenset()
        """Names of topics that are preferred if a kind has several topics and the user names none."""
        self._memory = Memory()
        self._series: dict[str, Series[Any]] = {}
        self._clocks: dict[str, TopicClock] = {}
        """The clocks of topics that were read from start to end, except topics that may be silent for long."""
        self._label_problems: list[Problem] = []
        self._fields: dict[str, Fields] = {}

    @property
    def path(self) -> Path:
        """The file or folder of the recording, or the local copy of a remote one, missing if it is read in parts."""
        return self._path

    @property
    def url(self) -> str | None:
        """The URL that the recording was fetched from, or None for a local file.

        It has no password, signature or token. While this process runs, it opens the same recording as the full URL.
        """
        return self._url

    @property
    def source(self) -> Source:
        """The messages as the file has them: bytes, on all channels.

        Raises:
            RecordingError: the recording is closed.
        """
        self._check_open()
        return self._source

    @property
    def topics(self) -> tuple[Topic, ...]:
        """All topics, in the order of the file, with type, count, rate and the widget that shows them."""
        return self._messages.topics

    @property
    def publishers(self) -> dict[str, tuple[str, ...]]:
        """The names of the nodes that published each topic: ROS 1 bags contain them, other files do not."""
        return self._messages.publishers

    @property
    def start_ns(self) -> int | None:
        """Time of the first message in nanoseconds since the epoch, or None without messages."""
        return self._messages.start_ns

    @property
    def end_ns(self) -> int | None:
        """Time of the last message in nanoseconds since the epoch, or None without messages."""
        return self._messages.end_ns

    @property
    def duration(self) -> float:
        """Seconds from the first message to the last, or 0 without messages."""
        return 0.0 if self.start_ns is None or self.end_ns is None else (self.end_ns - self.start_ns) / 1e9

    @property
    def problems(self) -> tuple[str, ...]:
        """The problems found so far: of the file, of topics, and of messages that could not be shown.

        Each is one line of at most 200 characters. Problems of a topic's clock are found when its `scans` or measured
        `speeds` are read, and several frames on one topic when its messages are read.
        """
        return tuple(str(problem._replace(remedy="")) for problem in self._with_remedies())

    @property
    def losses(self) -> tuple[str, ...]:
        """The problems by which an answer may lack something: a topic without a widget is read as any other."""
        return tuple(line for line in self.problems if line != NO_SENSOR)

    def samples(
        self, topics: str | Iterable[str] | None = None, start: float | None = None, end: float | None = None
    ) -> Iterator[Moment]:
        """Yield the samples in the order of their times, read one by one.

        A message that cannot be shown is left out and listed in `problems`.

        Args:
            topics: one topic or several, or None for all topics with a widget.
            start: seconds from the start of the recording, or None for its start.
            end: seconds from the start, not included, or None for the end of the recording, included.

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
        """Return the last sample of a topic at a time or before it, or None before the first.

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
        """Yield the messages of a topic of any type, in the order of their times, read one by one.

        Each has ``seconds``, ``time_ns``, and the fields of its definition in ``message``. A message that cannot be
        read is left out and listed in `problems`.

        Args:
            topic: the name of the topic, with or without a widget.
            start: seconds from the start of the recording, or None for its start.
            end: seconds from the start, not included, or None for the end of the recording, included.

        Raises:
            UnknownTopicError: the recording has no such topic, or its messages cannot be read; the text gives the
                reason.
            RecordingError: the recording is closed.

        Examples:
            >>> for moment in recording.messages("/imu", 2, 5):  # doctest: +SKIP
            ...     print(moment.seconds, moment.message.linear_acceleration.x)
        """
        self._check_readable(topic)
        return self._messages.messages([topic], *span_ns(self.start_ns, start, end))

    def thinned_messages(self, topic: str, every: int) -> Iterator[TimedMessage]:
        """Yield about every second, third and so on of the messages of a topic, with the first and the last.

        Raises:
            UnknownTopicError, RecordingError: as `messages`.
        """
        self._check_readable(topic)
        return self._messages.messages([topic], None, None, every=every)

    def message_at(self, topic: str, seconds: float) -> TimedMessage | None:
        """Return the last message of a topic of any type at a time or before it, or None before the first.

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
        """Return the events as a table: log lines, changes of status, texts, buttons, touches, states of programs.

        Each change in a DiagnosticArray, a Joy or a touch sensor is an event, and each message of rosout and String.
        Recordings that `Feed.record` wrote contain states and versions of programs, too.

        Args:
            *topics: names of topics; without names, all topics with events.
            level: only events of this level or a higher one: ``"DEBUG"``, ``"INFO"``, ``"WARN"``, ``"ERROR"``,
                ``"FATAL"``.
            text: only events with this text in their text or their source, in any case.
            start: seconds from the start of the recording, or None for its start.
            end: seconds from the start, not included, or None for the end of the recording, included.

        Raises:
            UnknownTopicError: the recording has no such topic, or it has no events; the text names the topics that
                have.
            TypeError, ValueError: an argument is not a level, a text, or a time.
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
                    f"{megabytes(self.memory)} of recording.memory: select a span (start=, end=), a "
                    "level or some text, or set it higher, in bytes"
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
        """Yield the events of topics, or of all topics with events, roughly in the order of their times in nanoseconds.

        Args:
            topics: names of topics.
            stop_ns: the time at which to stop, not included, or None for the end.
            every_line: 2 for only every second log line below a warning, and so on; 0 for none of them.
        """
        self._check_open()
        telling = [topic.name for topic in self.topics if has_events(topic)]
        by_name = [topic.name for topic in self.topics if has_events(topic, by_name=True)]
        for name in topics:
            self._check_readable(name)
            if name not in by_name:
                there = ", ".join(by_name) or "none"
                raise UnknownTopicError(f"{self.path.name}: {name!r} has no events; topics with events: {there}")
        end_ns = stop_ns if stop_ns is not None else (self.end_ns or 0) + 1
        found = self._messages.events(list(topics) or telling, stop_ns, every_line)
        return ((time_ns, event) for time_ns, event in found if time_ns < end_ns)

    def _seconds(self, time_ns: int) -> float:
        return (time_ns - (self.start_ns or 0)) / 1e9

    def seconds_at(self, when: datetime | str) -> float:
        """Return the seconds from the start at a date and time of day, for `at` and a player's `seek`.

        Args:
            when: a datetime, or a text such as ``"2024-05-03T14:32:05"``; in UTC unless it has a time zone.

        Raises:
            ValueError: the recording does not contain that time, or the text is not a date and time.
            TypeError: ``when`` is neither a datetime nor a text.
            RecordingError: the recording has no date, for example because its clock is simulated.
        """
        return seconds_at(when, self.path.name, self.start_ns, self.end_ns)

    def seconds_near(self, pose: Sequence[float], within: float = WITHIN) -> float | None:
        """Return the seconds from the start at which the robot scanned nearest to a pose, or None if never near.

        ``run_b.seconds_near(run_a.at("/odom", 12.0).sample.pose)`` finds the same place in another run, if the odometry
        of both began at the same place. If there are several topics of odometry, the first by name counts.

        Args:
            pose: x and y in metres and yaw in radians, in the frame of the odometry.
            within: the maximum distance in metres; a radian of heading counts as a metre.

        Raises:
            UnknownTopicError: the recording has no odometry.
            TypeError: ``pose`` is not a pose. ValueError: it is not finite, or ``within`` is below 0 or not finite.
        """
        within = not_negative("within", within, "metres")
        place = Places(np.zeros(1), np.array([to_place("pose", pose)]))
        (seconds,), (apart,) = places_of(self).nearest(place)
        return float(seconds) if apart <= within else None

    @property
    def memory(self) -> int:
        """The maximum bytes of decoded samples that `scans`, `speeds` and `touches` keep; 1 GiB, settable.

        A larger array raises an error that says what to do instead.

        Raises:
            TypeError: the new value is not a whole number.
            ValueError: the new value is 0 or less.
        """
        return self._memory.limit

    @memory.setter
    def memory(self, limit: int) -> None:
        self._memory.limit = limit

    def series(self, topic: str) -> Series[Any]:
        """Return a topic of any type as columns.

        Scans, speeds and touches are returned as `scans`, `speeds` and `touches` do, all others as `fields` does.

        Raises:
            UnknownTopicError: the recording has no such topic, or its messages cannot be read; the text gives the
                reason.
            RecordingError: the recording is closed.
        """
        if check_known(topic, self.topics, self.path.name).name not in shown(self.topics):
            return self.fields(topic)
        self._check_open()
        if topic not in self._series:
            self._series[topic] = self._messages.series(topic, self._memory)
        return self._series[topic]

    def fields(self, topic: str) -> Fields:
        """Return the messages of a topic of any type, also of scans and speeds, with each of their fields as a column.

        Raises:
            UnknownTopicError: the recording has no such topic, or its messages cannot be read; the text gives the
                reason.
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

    def table(self, *names: str, at: str | float | None = None, how: str = "last") -> FieldTable:
        """Return fields of topics with different rates as one table, with a row for each message of one topic.

        Args:
            *names: topics with fields, such as ``"/odom.twist.twist.linear.x"``, or messages in them, for a column of
                each field. Scans also have ``"/scan.front"``, ``left``, ``back``, ``right`` and ``nearest``, in metres.
            at: the topic whose messages have a row each, or the seconds between two rows, or None for the topic of the
                first name.
            how: the value between two messages of a field: ``"last"``, the last one before, or ``"linear"``,
                interpolated, and unknown after the last one. Texts, flags and times are always the last ones.

        Raises:
            UnknownTopicError, UnknownFieldError: the topic or field is missing, or it cannot be read. TypeError: a
                field has several values. ValueError: ``how`` or ``at`` is unknown. RecordingError: the recording is
                closed, or the table would be larger than `memory`.

        Examples:
            >>> import robowidgets
            >>> table = robowidgets.open(robowidgets.SAMPLE).table("/scan.front", "/odom.twist.twist.linear.x")
            >>> table
            FieldTable of /scan.front, /odom.twist.twist.linear.x: 581 rows, 0.00 to 58.00 s
        """
        self._check_open()
        return field_table(self, names, at, how)

    def scans(self, topic: str | None = None) -> Scans:
        """Return the scans of a topic as columns: times, ranges (N, R), intensities, geometry.

        Args:
            topic: may be omitted if only one topic has this kind.

        Raises:
            UnknownTopicError: the topic has no scans, or no topic was named and there is not exactly one.
            RecordingError: the recording is closed.
        """
        return self._of_kind(topic, Scan, Scans)

    def speeds(self, topic: str | None = None) -> Speeds:
        """Return the speeds of a topic as columns: times, linear (N, 3), angular (N, 3).

        Args:
            topic: may be omitted if only one topic has measured speeds, or any speeds.

        Raises:
            UnknownTopicError: as `scans`.
            RecordingError: the recording is closed.
        """
        return self._of_kind(topic, Speed, Speeds)

    def touches(self, topic: str | None = None) -> Touches:
        """Return the touches of a topic as columns: times, and the state of each sensor (N, L).

        Args:
            topic: may be omitted if only one topic has this kind.

        Raises:
            UnknownTopicError: as `scans`.
            RecordingError: the recording is closed.
        """
        return self._of_kind(topic, Touch, Touches)

    def why_long(self, topic: str) -> str:
        """Return the reason why reading a whole topic takes long: the number of bytes, or an empty text."""
        size = self._messages.size_of(topic)
        if size <= (MOST_FETCHED if self._file.is_in_parts else MOST_READ):
            return ""
        return f"its messages lie in {megabytes(size)}{' on a server' * self._file.is_in_parts}"

    def thinned_scans(self, topic: str) -> list[list[ScanChunk]]:
        """Return scans of a topic from a few parts of the file, evenly spread over its time, part by part.

        Few bytes and requests are needed; see `THINNED_FETCHED` and `THINNED_READ`.

        Raises:
            UnknownTopicError: as `scans`.
            RecordingError: the recording is closed, or a part cannot be read.
        """
        limits = THINNED_FETCHED if self._file.is_in_parts else THINNED_READ
        parts = [chunks for chunks in self.scans(topic).thinned(*limits) if chunks]
        return sorted(parts, key=lambda chunks: int(chunks[0].times_ns[0]))

    def transforms(self, every: int = 1, *, odometry: bool = True) -> Iterator[Transform]:
        """Return the transforms of odometry and tf, in the order of time.

        Args:
            every: 2 to read about every second message of each topic, and so on; its first ones are always read.
            odometry: True to include transforms of odometry.
        """
        self._check_open()
        return self._messages.transforms(every, odometry)

    @property
    def transform_count(self) -> int:
        """The number of messages that `transforms` reads."""
        return self._messages.transform_count

    def mount_of(self, frame_id: str, seconds: float | None = None) -> Mount | None:
        """Return the mount of a scanner on the robot: as set with `mount`, else from tf, or None if neither gives it.

        Args:
            frame_id: the coordinate frame of its scans.
            seconds: the time, for a scanner that moves on its robot, or None for the start.

        Raises:
            TypeError: frame_id is not a text. RecordingError: the recording is closed.
        """
        self._check_open()
        if not isinstance(frame_id, str):
            raise TypeError(f"frame_id: expected the name of a coordinate frame, got {frame_id!r}")
        return self._messages.mounts.of(frame_id, None if seconds is None else to_ns(self.start_ns, "seconds", seconds))

    def mounted(self, scan: Scan) -> Scan:
        """Return a scan from a message of this recording with the angles of the robot, if its mount is known."""
        return self._messages.mounts.mounted(scan)

    def mount(self, frame_id: str, yaw: float | str | None, *, upside_down: bool = False) -> None:
        """Set the mount of a scanner on the robot instead of tf. From now on its scans have the angles of the robot.

        Columns that were read before keep their angles, and so do pictures that are already shown.

        Args:
            frame_id: the coordinate frame of its scans.
            yaw: radians, or degrees as text (``"90deg"``), by which its forward is turned from the robot's,
                counter-clockwise, or None to use tf again.
            upside_down: True if it is mounted upside down.

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
        """The named spans, set with `label` or on a contact sheet: label, start and end in seconds."""
        file = LabelFile(self.path.parent)
        found = file.of(self.path, self._source)
        self._label_problems = [
            Problem(line, "the other labels are read; correct the line, or delete it") for line in file.problems
        ]
        return tuple(with_clock(one, self.start_ns or 0) for one in found)

    def label(self, name: str, start: float, end: float) -> Label:
        """Give a span a name. It is stored in ``labels.jsonl`` next to the recording, one line of JSON for each.

        The label follows the recording if that is renamed in its folder.

        Args:
            name: such as ``"door"``.
            start: seconds from the start of the recording.
            end: seconds from its start.

        Raises:
            TypeError, ValueError: the name is not a name, or the span is not a span. RecordingError: the labels cannot
                be written.
        """
        span = labelled_span(name, start, end)
        if span.start > self.duration:
            raise ValueError(
                f"label: expected a start within the {self.duration:.2f} s of the recording, in seconds, got {start!r}"
            )
        with self._writing_labels("saved") as file:
            file.add(self.path, self._source, span)
        return with_clock(span, self.start_ns or 0)

    def remove_label(self, label: Label) -> None:
        """Remove the name of a span. This adds a line to the file, so that the earlier line is not lost.

        Args:
            label: one of `labels`.

        Raises:
            ValueError: the recording has no such label. RecordingError: the labels cannot be written.
        """
        if label not in self.labels:
            raise ValueError(f"label: {self.path.name} has no {label!r}; expected one of recording.labels")
        with self._writing_labels("removed") as file:
            file.remove(self.path, self._source, LabelledSpan(*label[:3]))

    @contextmanager
    def _writing_labels(self, done: str) -> Iterator[LabelFile]:
        """Give the file of the labels; an OSError while writing becomes a RecordingError."""
        if self.url is not None:
            raise RecordingError(f"{self.path.name} is a copy of {self.url}, and labels cannot be stored with a copy")
        try:
            yield LabelFile(self.path.parent)
        except OSError as error:
            raise RecordingError(f"{self.path.name}: the label cannot be {done}: {error.strerror or error}") from None

    @property
    def states(self) -> tuple[StateSpan, ...]:
        """The spans in which states of a program were active, by start, if `Feed.record` wrote the recording.

        Raises:
            RecordingError: the recording is closed.
        """
        self._check_open()
        return spans_of(self._messages.texts(lambda topic: topic.startswith(STATES)), self.duration)

    @property
    def programs(self) -> tuple[ProgramVersion, ...]:
        """The versions of the programs that drove, with their text. Only recordings that `Feed.record` wrote have them.

        Raises:
            RecordingError: the recording is closed.
        """
        self._check_open()
        said = self._messages.texts(lambda topic: topic == PROGRAM)
        return tuple(version_of(seconds, text) for _, seconds, text in said)

    def info(self) -> str:
        """Return the table of the topics as text."""
        return self._table().to_text()

    def reopened(self) -> Self:
        """Open the same recording again, for example in another thread, with its memory limit and mounts set by hand.

        Raises:
            RecordingError: the file does not exist any more.
        """
        other = type(self)(self.path if self.url is None or self.path.exists() else self.url)
        for frame_id, mount in self._messages.mounts.by_hand.items():
            other.mount(frame_id, mount.yaw, upside_down=mount.upside_down)
        other.memory = self.memory
        return other

    def close(self) -> None:
        """Close the file; closing it again does nothing."""
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
        """Return the slice of a span: ``recording[2:5]`` in seconds, a selection, or a span of `find`."""
        return TimeSlice(self, which)

    def __iter__(self) -> Iterator[Moment]:
        return self.samples()

    def _table(self) -> Table:
        self.check_topics()
        return table_of(self._heading(), self.topics, self.problems)

    def _heading(self) -> str:
        return heading(self._url or str(self.path), self.topics, self.duration, self.start_ns)

    def check(self, name: str) -> None:
        """Check that the recording has a topic of this name that a widget shows.

        Raises:
            UnknownTopicError: the recording has no such topic.
            TypeError: the name is not a text.
        """
        check(name, self.topics, self.path.name)

    def only(self, widget: str) -> str:
        """Return the topic of a kind if the user names none: the only one, or the one in `preferred`.

        Raises:
            UnknownTopicError: the recording has no such topic. `UnnamedTopicError`: there are several.
        """
        return only(self.path.name, self.topics, widget, self.preferred)

    def check_topics(self) -> None:
        """Read the first message of each topic once, so that `problems` has the reasons for unreadable topics.

        `info` and `doctor` begin with it.
        """
        if not self._closed:
            self._messages.check_topics()

    def why_unreadable(self, name: str) -> str:
        """Return the reason why no message of a topic can be read, or an empty text if they can be read."""
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

    def _of_kind(self, topic: str | None, sample: type, series: type[AnySeries]) -> AnySeries:
        kind = kind_of_class(sample)
        name = self.only(kind.name) if topic is None else topic
        found = self.series(name)
        if not isinstance(found, series):
            there = ", ".join(named(self.topics, kind.name)) or "none"
            noun = KINDS[shown(self.topics)[name].widget or ""].noun
            raise UnknownTopicError(f"{self.path.name}: {name!r} is a topic of {noun}; topics of {kind.noun}: {there}")
        return found

    def _note_clocks(self) -> dict[str, TopicClock]:
        """Store the clocks of topics that were read from start to end, so that they outlive `close`; return them."""
        for name, series in self._series.items():
            topic = shown(self.topics)[name]
            grows_stale = KINDS[topic.widget or ""].goes_stale and not topic.commanded
            if grows_stale and series.is_read and name not in self._clocks:
                self._clocks[name] = clock_of(series.times_ns, self.start_ns or 0)
        return self._clocks
