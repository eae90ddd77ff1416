"""A recording of a robot, opened for reading."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .recordings.data import RecordingData
from .recordings.topics import shown

if TYPE_CHECKING:
    from .in_rerun.widget import RerunWidget
    from .recordings.doctor.report import Report
    from .recordings.search.base import Condition
    from .recordings.search.instant import Instant
    from .recordings.search.lines import RecordedLines
    from .recordings.search.spans import Spans
    from .scanogram_widget import ScanogramWidget
    from .screens.player import Player
    from .wires_widget import WiresView


def open(path: str | os.PathLike[str]) -> Recording:  # noqa: A001  # the name that users expect: robowidgets.open()
    """Open a recording.

    Args:
        path: a ROS bag (``.bag``), a rosbag2 folder, a lone ``.db3`` or ``.mcap``, or a CARMEN log (``.log``, ``.clf``,
            gzipped or not). The readable parts of a damaged file are read, and `Recording.problems` lists the damage.
            Or its URL as text, such as ``"s3://bucket/drive.mcap"``, of any kind that fsspec reads (extra ``remote``):
            an MCAP file of more than 32 MB with an index is read in parts, which take up to 64 MB of memory. All others
            are fetched once, and fetched again after they have changed. Copies take up to 10 GB, or the size in the
            environment variable ``ROBOWIDGETS_CACHE_SIZE``, in the folder that ``ROBOWIDGETS_CACHE`` names.

    Raises:
        RecordingError: the recording cannot be fetched, or no part of it can be read. The text gives the reason.

    Examples:
        >>> recording = robowidgets.open("drive.bag")  # doctest: +SKIP
        >>> recording.at("/scan", 12.5).sample.distance()  # doctest: +SKIP
    """
    return Recording(path)


class Recording(RecordingData):
    """A recording, as `open` returns it: its data, and the methods that show, search and export it.

    Printed, it is a table of its topics. As a context manager it closes the file. One thread at a time may read it.

    Args:
        path: the file or folder of the recording.
    """

    def scanogram(
        self, topic: str | None = None, beside: Collection[str] | None = None, **options: Any
    ) -> ScanogramWidget:
        """Show all scans of a topic in one picture, with speeds and touches below; see `ScanogramWidget.of`."""
        # Imported lazily: reading recordings needs no widgets.
        from .scanogram.of_recording import scanogram

        return scanogram(self, topic, beside, **options)

    def find(self, condition: Condition | Callable[[Instant], Any], topics: str | Iterable[str] | None = None) -> Spans:
        """Find the spans in which a condition is true, and return them as a table.

        A condition is one of `robowidgets.conditions`, several of them joined by ``&``, ``|`` and ``~``, or a function
        of one moment. The function gets an `Instant` with the last ``scan``, ``speed`` and ``touch`` up to that moment.
        If it reads a sample before the first one, the condition is unknown, and nothing is found.

        A condition keeps its value until the next sample, but scans and speeds become stale one usual step after the
        topic falls silent. Ready-made conditions are computed on whole columns. A function is called in this process,
        so it may be a lambda. An interrupt (stop the cell, Ctrl-C) ends the search: the result then has the spans up to
        that time, and its `is_complete` is False.

        Args:
            condition: the condition or function.
            topics: the topics that a function may read, or None for all topics with a widget.

        Raises:
            TypeError: ``condition`` is not a condition.
            ValueError: a condition names a missing touch sensor.
            UnknownTopicError: a condition needs a missing topic, or does not name one of several.
            RecordingError: the recording is closed, or the function failed; the text gives the time.

        Examples:
            >>> recording.find(lambda moment: moment.touch.touched["left"] and moment.speed.linear[0] > 0.1)
            ... # doctest: +SKIP
        """
        # Imported lazily: reading samples needs no player.
        from .recordings.search.search import find

        self._check_open()
        found = find(self, condition, topics)
        found.shown_by = self.show
        return found

    def lines(self, function: Any, *, rate: float = 10.0, topics: str | Iterable[str] | None = None) -> RecordedLines:
        """The lines of a function over the recording: their values at any moment, and when each was true, or reached.

        A function of samples (``scan``, ``speed``, ...) or of one moment, as for `find`, is called at each of them. A
        program, a state machine, or a function that also takes ``time``, ``state`` or ``variables`` is stepped through
        time. What the robot did is what was recorded.

        Args:
            function: the function, or a program.
            rate: steps a second of a function that is stepped through time; a program has its own.
            topics: the topics that a function of one moment may read, or None for all that a widget shows.

        Raises:
            TypeError, UnknownTopicError: as `find`. RecordingError: the recording is closed.

        Examples:
            >>> lines = recording.lines(avoid)  # doctest: +SKIP
            >>> lines.at(12.5), lines.when(3)  # doctest: +SKIP
        """
        # Imported lazily: reading samples needs no programs.
        from .recordings.search.lines import RecordedLines

        self._check_open()
        return RecordedLines(self, function, rate, topics)

    def doctor(self) -> Report:
        """Check the recording: its topics (rays, angles, limits, frames, rate, jitter, lost scans), and its problems.

        It reads all scans and speeds. It finds the problems that `Scan.problems` finds in any scan, falling rates,
        pauses, stamps from another clock, and topics without messages. Each problem names a remedy.

        Raises:
            RecordingError: the recording is closed.

        Examples:
            >>> import robowidgets
            >>> robowidgets.open(robowidgets.SAMPLE).doctor().problems
            ()
        """
        # Imported lazily: reading samples needs no check-up.
        from .recordings.doctor.report import examine

        self.check_topics()
        series = {name: self.series(name) for name in shown(self.topics)}
        for one in series.values():
            len(one)  # Reads the samples, which finds the problems of the clock and of the messages.
        silences = {name: clock.silences for name, clock in self._note_clocks().items()}
        transforms = list(self.transforms(odometry=False))
        return examine(self._heading(), self.topics, series, self._with_remedies(), silences, transforms)

    def show(
        self,
        *topics: str,
        scanogram: bool | None = None,
        rerun: bool = False,
        arrangement: Any = None,
        lines: Any = None,
    ) -> Player:
        """Show the recording: a player, and one widget for each topic that has one.

        The player opens the file again, so this recording may be read or closed meanwhile.

        Args:
            *topics: names of the topics to show, of any type, or of fields: ``"/odom.twist.twist.linear.x"``;
                ``"/points as laser"`` chooses the widget. Without names, all topics with a widget and a message;
                without such topics, a few general widgets.
            scanogram: True to show a scanogram of the whole drive above the widgets, or None to show it only if that is
                quick. Of a drive that is too large, None shows a few parts of the file, evenly spread.
            rerun: True to show the Rerun viewer next to the widgets, with the scans in the world (extra ``rerun``).
            arrangement: the topics, and the cards that were arranged by hand, as returned by `Player.arrangement` of an
                earlier player.
            lines: a function or a program, whose lines are shown with their values at the shown time. Without it, a
                recorded program shows its lines, once the user asks for them.

        Raises:
            UnknownTopicError: the recording has no such topic, or its messages cannot be read; the text gives the
                reason.
            KeyError: a topic has no such field; the text names the nearest ones.
            RecordingError: the file does not exist any more.
            TypeError: a name is not a text, for example a list of names.

        Examples:
            >>> recording.show("/scan", "/odom")  # doctest: +SKIP
        """
        # Imported lazily: reading samples needs no widget.
        from .screens.player import Player

        again = self.reopened()
        try:
            return Player(again, topics, scanogram, rerun, arrangement, lines)
        except BaseException:
            again.close()
            raise

    def wires(self, **options: Any) -> WiresView:
        """Show the topics as a graph with the nodes that published them, if the file names any; see `WiresWidget`.

        A ROS 1 bag names the publishers. In other files, the log on /rosout names the nodes that wrote to it.

        Args:
            **options: keywords of `WiresWidget`.

        Raises:
            TypeError: an unknown keyword.
            RecordingError: the recording is closed.

        Examples:
            >>> import robowidgets
            >>> robowidgets.open(robowidgets.SAMPLE).wires()
            <WiresView: <WiresWidget sample.mcap: 4 topics, 0 parts of the notebook>>
        """
        # Imported lazily: reading samples needs no widget.
        from .wires.recorded import RecordedWires
        from .wires_widget import WiresView

        self._check_open()
        return WiresView(RecordedWires(self), **options)

    def to_html(
        self,
        path: str | os.PathLike[str],
        *,
        start: float | None = None,
        end: float | None = None,
        topics: Sequence[str] = (),
        marks: Any = None,
        title: str = "",
        note: str = "",
        every: int = 1,
        scanogram: bool | None = None,
        max_size: int | None = 50_000_000,
    ) -> Path:
        """Write a page that plays the recording: one file for any browser, without a kernel, a server or the web.

        The page has the player with its keys, the widgets that `show` would show, and the exact samples as CSV. Its
        times are the times of the recording. The file appears when it is complete, and replaces an existing one.

        Args:
            path: the file, such as ``"bump.html"``.
            start: seconds from the start of the recording, or None for its start.
            end: seconds from its start, or None for its end.
            topics: names of the topics and fields, as for `show`; without names, all topics with a widget and a
                message.
            marks: (start, end, text) in seconds, or the result of `find`, or None to mark the touches.
            title: title of the page, or empty for the name of the recording.
            note: a text under the title, which is shown as it is.
            every: 2 to write every second scan, and so on; speeds and touches are always complete.
            scanogram: True to add a scanogram, or None to add one only if that is quick.
            max_size: maximum size of the file in bytes, or None for no limit.

        Returns:
            The path of the file.

        Raises:
            UnknownTopicError: the recording has no such topic, or no widget shows it.
            ValueError: the span is not in the recording, or the page would be too large; the text says how to make it
                smaller.
            TypeError: a time is not a number, or a title is not a text. OSError: the file cannot be written.

        Examples:
            >>> recording.to_html("bump.html", start=10, end=20, note="It turns too late.")  # doctest: +SKIP
        """
        with self._shown(topics, marks) as player:
            return player.to_html(
                path, start=start, end=end, title=title, note=note, every=every, scanogram=scanogram, max_size=max_size
            )

    def html_size(
        self,
        *,
        start: float | None = None,
        end: float | None = None,
        topics: Sequence[str] = (),
        every: int = 1,
        scanogram: bool | None = None,
    ) -> int:
        """Return about how many bytes `to_html` would write. It takes the same arguments and raises the same errors."""
        with self._shown(topics) as player:
            return player.html_size(start=start, end=end, every=every, scanogram=scanogram)

    @contextmanager
    def _shown(self, topics: Sequence[str], marks: Any = None) -> Iterator[Player]:
        """Open a player without a scanogram, and close it afterwards."""
        if isinstance(topics, str):
            raise TypeError(f"topics: expected a list of names, got {topics!r}; write [{topics!r}]")
        self._check_open()
        player = self.show(*topics, scanogram=False)
        try:
            if marks is not None:
                player.marks = marks
            yield player
        finally:
            player.close()

    def to_rerun(self, path: str | os.PathLike[str] | None = None, *topics: str) -> Path | RerunWidget:
        """Write a file for Rerun and return its path; without a path, return the viewer for the page, a `RerunWidget`.

        Args:
            path: the file, such as ``"drive.rrd"``; an existing file is replaced when the new one is complete.
            *topics: as for `show`.

        Raises:
            ImportError: Rerun is not installed (extra ``rerun``). ValueError: the name does not end in ``.rrd``.
                OSError: the file cannot be written.
        """
        from .in_rerun.export import to_rerun  # Imported lazily: Rerun is optional.

        self._check_open()
        return to_rerun(self, path, topics)
