"""The fields of the messages of a recording, for its player."""

from __future__ import annotations

from collections.abc import Mapping

from ..recordings.topics import Moment
from ..tracks import MessageFrames
from ..widget.timed_frame import FRAME_HEADER, TimedFrame

OF_TOPIC = "recorded"
"""The key of the topic in the texts on a frame of `TreeFrames`. Its time of arrival is in seconds from the start."""


class TreeFrames(MessageFrames):
    """A `Track` of the fields of messages. They can be copied as the code that reads them; see `MessageFrames`."""

    def _shown(self, seconds: float, now: Mapping[str, Moment | None]) -> TimedFrame:
        timed = super()._shown(seconds, now)
        sequence, rate, stamp, _ = FRAME_HEADER.unpack_from(timed.frame)
        head = FRAME_HEADER.pack(sequence, rate, stamp, seconds)
        about = {**timed.about, OF_TOPIC: self._choice.topic}
        return TimedFrame(seconds, about, head + timed.frame[FRAME_HEADER.size :])
