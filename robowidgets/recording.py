"""A recording of a robot, opened for reading."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from .kinds import Widget
from .recordings.all_series import AllSeries, AnySeries
from .recordings.scan_series import Scans
from .recordings.speed_series import Speeds
from .recordings.stretch import Stretch
from .recordings.table import as_html, as_text, heading
from .recordings.timeline import Moment, Timeline, Topic
from .recordings.times import seconds_at, to_ns
from .recordings.topics import check, shown
from .recordings.touch_series import Touches
from .repair.source import RecordingError

if TYPE_CHECKING:
    from .find._function import Instant
    from .find.conditions import Condition
    from .in_rerun.widget import RerunWidget
    from .player.player import Player
    from .recordings.spans import Spans
    from .scanogram_widget import ScanogramWidget


def open(path: str | os.PathLike[str]) -> Recording:  # noqa: A001  # the one word for it: robowidgets.open()
    """Open a recording.

    Args:
        path: a ROS bag (``.bag``), a rosbag2 folder, a lone ``.db3`` or ``.mcap``, or a CARMEN log (``.log``, ``.clf``,
            gzipped or not). Of a damaged file what can be saved is read, and `Recording.problems` says what was wrong.

    Raises:
        RecordingError: nothing of it can be read; the text says why.

    Example:
        >>> recording = robowidgets.open("drive.bag")  # doctest: +SKIP
        >>> recording.at("/scan", 12.5).sample.distance()  # doctest: +SKIP
    """
    # Here, because it takes longer than all the rest of robowidgets, and who opens no recording need not wait for it.
    from .recordings.files import open_timeline

    where = Path(os.fsdecode(path)).expanduser().absolute()  # who shows it later may have gone elsewhere
    return Recording(where, open_timeline(where))


class Recording:
    """What `open` gives: the topics of a recording and their samples.

    Printed, it is a table of its topics. As a context manager it closes the file. One thread at a time may read it.

    Args:
        path: the file or folder it came from.
        timeline: what it reads.
    """

    def __init__(self, path: Path, timeline: Timeline) -> None:
        self._path = path
        self._timeline = timeline
        self._closed = False
        self._series = AllSeries(path.name, timeline)

    @property
    def path(self) -> Path:
        """The file or folder it was opened from."""
        return self._path

    @property
    def topics(self) -> tuple[Topic, ...]:
        """Every topic in it, in the order of the file, with type, count, rate and the widget that shows it."""
        return self._timeline.topics

    @property
    def start_ns(self) -> int | None:
        """Time of the first message in nanoseconds since the epoch; None when there is no message."""
        return self._timeline.start_ns

    @property
    def end_ns(self) -> int | None:
        """Time of the last message in nanoseconds since the epoch; None when there is no message."""
        return self._timeline.end_ns

    @property
    def duration(self) -> float:
        """Seconds from the first message to the last; 0 when there is no message."""
        return 0.0 if self.start_ns is None or self.end_ns is None else (self.end_ns - self.start_ns) / 1e9

    @property
    def problems(self) -> tuple[str, ...]:
        """What was wrong so far, one line each: with the file, with a topic, with messages that could not be shown.

        With the clock of a topic, too, once its `scans` or measured `speeds` were read.
        """
        if self.start_ns is None:
            return (*self._timeline.problems, "there is no message in it: nothing was recorded")
        if not self._shown():
            return (*self._timeline.problems, "none of its topics has a widget that shows it")
        return (*self._timeline.problems, *self._series.problems)

    def samples(
        self, topics: str | Iterable[str] | None = None, start: float | None = None, end: float | None = None
    ) -> Iterator[Moment]:
        """The samples in the order of their times, each read when its turn comes.

        A message that cannot be shown is left out, and told in `problems`.

        Args:
            topics: one topic or several; None for all that a widget shows.
            start: seconds from the start of the recording; None for the start.
            end: the same, not included; None for the end, included.

        Raises:
            UnknownTopicError: it has no such topic, or one that no widget shows.
            RecordingError: it is closed.
        """
        names = [topics] if isinstance(topics, str) else list(topics) if topics is not None else list(self._shown())
        for name in names:
            self.check(name)
        times = (
            None if seconds is None else to_ns(self.start_ns, name, seconds)
            for name, seconds in (("start", start), ("end", end))
        )
        self._check_open()
        return self._timeline.moments(list(dict.fromkeys(names)), *times)

    def at(self, topic: str, seconds: float) -> Moment | None:
        """The last sample of a topic at a time, or before it; None when there is none yet.

        Args:
            topic: the name of the topic.
            seconds: seconds from the start of the recording.

        Raises:
            UnknownTopicError: it has no such topic, or one that no widget shows.
            RecordingError: it is closed.
        """
        self.check(topic)
        self._check_open()
        return self._timeline.last(topic, to_ns(self.start_ns, "seconds", seconds))

    def seconds_at(self, when: datetime | str) -> float:
        """Seconds from the start of the recording at a date and time of day, as `at` and a player's `seek` take them.

        Args:
            when: such as ``"2024-05-03T14:32:05"``, or a datetime; in UTC, unless it tells its time zone.

        Raises:
            ValueError: the recording was not running then; or the text is no date and time.
            TypeError: it is neither.
            RecordingError: the recording has no date, because its clock is that of a simulation, say.
        """
        return seconds_at(when, self.path.name, self.start_ns, self.end_ns)

    @property
    def memory(self) -> int:
        """Bytes that `scans`, `speeds` and `touches` may hold at most of what they decoded; 1 GiB, settable.

        An array that would be larger is refused, with an error that says what to do.

        Raises:
            TypeError: it is set to what is no whole number.
            ValueError: it is set to 0 or less.
        """
        return self._series.memory.limit

    @memory.setter
    def memory(self, limit: int) -> None:
        self._series.memory.limit = limit

    def scans(self, topic: str | None = None) -> Scans:
        """The scans of a topic as columns: times, ranges (N, R), intensities, geometry.

        Args:
            topic: may be left out where there is just one of them.

        Raises:
            UnknownTopicError: there is no such topic with scans; or none was named, and there is not just one.
            RecordingError: it is closed.
        """
        return self._columns(topic, "laser", Scans)

    def speeds(self, topic: str | None = None) -> Speeds:
        """The speeds of a topic as columns: times, linear (N, 3), angular (N, 3).

        Args:
            topic: may be left out where just one is measured, or there is just one.

        Raises:
            UnknownTopicError: as `scans`.
            RecordingError: it is closed.
        """
        return self._columns(topic, "speed", Speeds)

    def touches(self, topic: str | None = None) -> Touches:
        """The touches of a topic as columns: times, and the state of each sensor (N, L).

        Args:
            topic: may be left out where there is just one of them.

        Raises:
            UnknownTopicError: as `scans`.
            RecordingError: it is closed.
        """
        return self._columns(topic, "touch", Touches)

    def series(self, topic: str) -> Any:
        """The samples of a topic, of any kind, as a series."""
        self.check(topic)
        return {"laser": self.scans, "speed": self.speeds, "touch": self.touches}[self._shown()[topic].widget or ""](
            topic
        )

    def scanogram(
        self, topic: str | None = None, beside: Collection[str] | None = None, **options: Any
    ) -> ScanogramWidget:
        """All its scans in one picture, with speed and touch under them: see `ScanogramWidget.of`."""
        # Imported lazily: reading recordings needs no widgets.
        from .player._scanogram import scanogram

        return scanogram(self, topic, beside, **options)

    def find(self, condition: Condition | Callable[[Instant], Any], topics: str | Iterable[str] | None = None) -> Spans:
        """From when to when a condition holds, as a table.

        A condition is one of `robowidgets.conditions`, several of them joined by ``&``, ``|`` and ``~``, or a function
        of one moment: of an `Instant` with the ``scan``, ``speed`` and ``touch`` of the same time, each the last up to
        then. Where a function asks for a sample and there is none yet, nothing is known and nothing found.

        What holds at a sample goes on holding until the next one says otherwise; what scans and speeds said, one usual
        step into a silence at most. Conditions look at whole columns while both cores read and decompress the file; a
        function is called in this process, while the file is read ahead on the other core, so it may be a lambda. An
        interrupt (stop the cell, Ctrl-C) ends the search: what was found up to there is given, and says so.

        Args:
            condition: what to look for.
            topics: those that a function may look at; None: all that a widget shows.

        Raises:
            TypeError: it is no condition.
            ValueError: a condition asks for a touch sensor that there is not.
            UnknownTopicError: a condition needs a topic that there is not, or one to be named where there are several.
            RecordingError: the recording is closed; or the function failed, and at which time.

        Example:
            >>> recording.find(lambda moment: moment.touch.touched["left"] and moment.speed.linear[0] > 0.1)
            ... # doctest: +SKIP
        """
        # Here, so that who only reads samples waits for none of it.
        from .find._search import find

        self._check_open()
        return find(self, condition, topics)

    def show(self, *topics: str, scanogram: bool | None = None, rerun: bool = False) -> Player:
        """The widgets that fit its topics, with a player for its time, for the page.

        They read the file by themselves: this recording may be read on, or closed.

        Args:
            *topics: names of the topics to show; none: all that have a widget.
            scanogram: whether the whole drive stands above them as one picture; None: if that is ready in a moment.
            rerun: whether Rerun stands beside them, with what was seen in the world (extra ``rerun``).

        Raises:
            UnknownTopicError: it has no such topic, or one that no widget shows.
            RecordingError: the file is not there any more.
            TypeError: a name is no text, but a list of them, say.

        Example:
            >>> recording.show("/scan", "/odom")  # doctest: +SKIP
        """
        # Here, so that who only reads recordings needs no page.
        from .player.player import Player

        again = open(self.path)
        again.memory = self.memory
        return Player(again, topics, scanogram, rerun)

    def to_rerun(self, path: str | os.PathLike[str] | None = None, *topics: str) -> Path | RerunWidget:
        """Write a file for Rerun, and return its path; without a path, the viewer for the page: see `RerunWidget`.

        Args:
            path: such as ``"drive.rrd"``; what was there is replaced.
            *topics: as for `show`.

        Raises:
            ImportError: Rerun is not installed (extra ``rerun``); and as `show`, and OSError.
        """
        from .in_rerun.export import to_rerun  # Here, so that who does without Rerun needs none of it.

        self._check_open()
        return to_rerun(self, path, topics)

    def info(self) -> str:
        """The table of its topics, as text."""
        return as_text(self._heading(), self.topics, self.problems)

    def close(self) -> None:
        """Close the file; doing it again does nothing."""
        self._closed = True
        self._series.clear()
        self._timeline.close()

    def __enter__(self) -> Recording:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __getitem__(self, which: slice | Sequence[float]) -> Stretch:
        """The samples of a stretch of time: ``recording[2:5]`` in seconds, a selection, or a span of `find`."""
        return Stretch(self, which)

    def __iter__(self) -> Iterator[Moment]:
        return self.samples()

    def __repr__(self) -> str:
        return self.info()

    def _repr_html_(self) -> str:
        return as_html(self._heading(), self.topics, self.problems)

    def _heading(self) -> str:
        return heading(str(self.path), self.topics, self.duration, self.start_ns)

    def _shown(self) -> dict[str, Topic]:
        return shown(self.topics)

    def _columns(self, topic: str | None, widget: Widget, kind: type[AnySeries]) -> AnySeries:
        name = self._series.only(widget) if topic is None else topic
        self.check(name)
        self._check_open()
        return self._series.of(self._shown()[name], widget, kind)

    def check(self, name: str) -> None:
        """Nothing, if it has a topic of this name that a widget shows.

        Raises:
            UnknownTopicError: it has not.
            TypeError: the name is no text.
        """
        check(name, self.topics, self.path.name)

    def _check_open(self) -> None:
        if self._closed:
            raise RecordingError(f"{self.path.name} is closed: open it again")
