"""The touches of a recording, for its player."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..kinds.choice import WidgetChoice
from ..recordings import RecordingData
from ..recordings.topics import Moment
from ..samples import Touch
from ..touch_widget import TouchWidget, about_touch, pack_states
from ..tracks import NEW, frame_header
from ..widget.timed_frame import TimedFrame
from .history import TouchHistory

TICK = 0.1
"""The maximum number of seconds between two frames of touches: their durations grow without a message."""

_LEAST = 1e-3
"""The minimum number of seconds between them."""


class TouchFrames:
    """A `Track` of the states of touch sensors, which also change without a message; see `SampleFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: TouchWidget) -> None:
        self._recording, self._topic, self._widget = recording, choice.topic, widget
        self._start_ns = recording.start_ns or 0
        self._known: tuple[tuple[float, float | None], TouchHistory] | None = None

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        moments: list[Moment | None] = [*self._recording.samples(self._topic, start, end), None]
        tracker = self._history().at(self._time_ns(start) - 1)
        seconds, end = start, max(end, start + _LEAST)  # so that the span has a frame
        unchanged: dict[str, Any] = {NEW: []}
        came = unchanged
        for moment in moments:
            until = end if moment is None else max(moment.seconds, seconds)
            while seconds < until or came is not unchanged:
                now_ns = self._time_ns(seconds)
                newest = tracker.newest or Touch({})
                frame = frame_header(newest) + pack_states(tracker, now_ns)
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
        self._widget.show(self._history().at(time_ns), time_ns)

    def _history(self) -> TouchHistory:
        """Return the touches with the hold and the timeout of the widget, which may have changed."""
        known, times = self._known, (self._widget.hold, self._widget.timeout)
        if known is None or known[0] != times:
            known = self._known = times, TouchHistory(self._recording, self._topic, *times)
        return known[1]

    def _time_ns(self, seconds: float) -> int:
        return self._start_ns + round(seconds * 1e9)
