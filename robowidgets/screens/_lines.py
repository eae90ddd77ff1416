"""The lines of a function, or of the recorded programs, below the other widgets of a player."""

from __future__ import annotations

from typing import Any

from ..lines.recorded_lines import RecordedLinesWidget
from ..player_widget import PlayerWidget
from ..recordings import RecordingData
from ..recordings.program_log import PROGRAM
from ..recordings.search.spans import Spans


class PlayerLines:
    """Makes the widget of lines follow the time of a player, and marks the spans of the chosen line on its slider.

    Args:
        recording: the recording.
        bar: the bar of the player.
        given: a function or a program, or the result of `Recording.find`, or None for the programs whose text is in
            the recording.

    Attributes:
        widget: the widget, or None without a function and without a recorded program.
    """

    def __init__(self, recording: RecordingData, bar: PlayerWidget, given: Any = None) -> None:
        self._bar = bar
        self._before: tuple[Any, Any] | None = None
        """The marks of the chosen line, and the marks that they replaced."""
        function = given
        if isinstance(given, Spans):
            function = given.function
            bar.marks = given
            bar.time = given[0].start if given else bar.time
        self.widget: RecordedLinesWidget | None = None
        if function is None and not any(topic.name == PROGRAM for topic in recording.topics):
            return
        self.widget = RecordedLinesWidget(recording, function, on_spans=self._mark, folded=function is None)
        self.widget.ask(bar.time)
        bar.observe(self._on_time, ["time", "_shown"])

    def join(self, group: str) -> None:
        """Light rays in the pictures of the player, which is a group in the page."""
        if self.widget is not None:
            self.widget.set_source({"robot": group})

    def close(self) -> None:
        """End the thread of the widget."""
        widget, self.widget = self.widget, None
        if widget is not None:
            self._bar.unobserve(self._on_time, ["time", "_shown"])
            widget.close()

    def _on_time(self, change: Any) -> None:
        bar = self._bar
        if self.widget is None:
            return
        # The page sends the moment on show, such as the frozen one. After a time from Python, it is outdated.
        is_from_page = change["name"] in bar._property_lock
        self.widget.ask(bar.moment if is_from_page else bar.time)

    def _mark(self, spans: Spans | None) -> None:
        """Mark the spans of a line in place of other marks, which come back with the next choice of no line."""
        bar = self._bar
        marked, before = self._before or (None, bar.marks)
        if marked != bar.marks:  # set by a program meanwhile
            before = bar.marks
        if spans is None:
            if self._before is not None:
                bar.marks, self._before = before, None
            return
        bar.marks = spans
        self._before = bar.marks, before
