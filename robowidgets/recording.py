"""A recording of a robot, opened for reading."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .recordings.data import RecordingData

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
    return Recording(path)


class Recording(RecordingData):
    """A recording, as `open` gives it: its data, and what can be done with them.

    Printed, it is a table of its topics. As a context manager it closes the file. One thread at a time may read it.

    Args:
        path: the file or folder it came from.
    """

    def scanogram(
        self, topic: str | None = None, beside: Collection[str] | None = None, **options: Any
    ) -> ScanogramWidget:
        """All its scans in one picture, with speed and touch under them: see `ScanogramWidget.of`."""
        # Imported lazily: reading recordings needs no widgets.
        from .player.scanogram import scanogram

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
        from .find.search import find

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
