"""The track of a plot: all of its lines at once, and the times of their values."""

from __future__ import annotations

from collections.abc import Iterator
from math import nan

import numpy as np

from ..kinds.choice import WidgetChoice
from ..plot_widget import MOST_LINES, PlotWidget
from ..recordings import RecordingData
from ..recordings.field_lines import choices, field_lines
from ..samples.state_span import rows_of
from ..tracks import BEFORE
from ..widget.timed_frame import FRAME_HEADER, TimedFrame

_FRAME = FRAME_HEADER.pack(0.0, nan, 0, 0.0)


class PlotFrames:
    """A `Track` of the times of a plot's values. The widget has the lines themselves.

    Args:
        recording: the recording.
        choice: the fields of the plot.
        widget: the plot, which gets the lines unless it has them already.
    """

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: PlotWidget) -> None:
        self._recording, self._widget = recording, widget
        if not widget.names:
            widget.states = rows_of(recording.states)
            for field in choice.fields:
                self._add(field)
            widget.offer(choices(recording), self._add)
        times = [widget[name][0] for name in widget.names]
        self._times = np.unique(np.concatenate(times)) if times else np.empty(0)

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        first, stop = np.searchsorted(self._times, start, "right"), np.searchsorted(self._times, end, "left")
        before = self._times[first - 1] if first else BEFORE
        yield from (TimedFrame(seconds, {}, _FRAME) for seconds in (float(before), *self._times[first:stop].tolist()))

    def seek(self, seconds: float) -> None:
        """See `Track`: the page shows the time in its lines."""

    def _add(self, field: str) -> None:
        for name, seconds, values, unit in field_lines(self._recording, field, MOST_LINES):
            if unit:
                self._widget.units = {**self._widget.units, name: unit}
            self._widget.set_line(name, seconds, values)
