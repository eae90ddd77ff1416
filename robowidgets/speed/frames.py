"""The speeds of a recording, for its player."""

from __future__ import annotations

from typing import Any

from ..speed_widget import Reading
from ..tracks import SampleFrames, frame_header
from ..widget.timed_frame import TimedFrame


class SpeedFrames(SampleFrames):
    """A `Track` of measured and commanded speeds, without peaks, because a player shows times in any order."""

    def _frame(self, seconds: float, sample: Any, commanded: Any = None, **_: Any) -> TimedFrame:
        _, frame = self._widget.frame_of(Reading(sample, commanded))
        return TimedFrame(seconds, {"frame_id": sample.frame_id}, frame_header(sample) + frame)
