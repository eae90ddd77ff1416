"""The pictures of a recording, small enough to be sent ahead."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress

from ..image_widget import ImageWidget
from ..kinds.choice import WidgetChoice
from ..messages import to_image
from ..recordings import RecordingData
from ..recordings.topics import Moment
from ..tracks import MessageFrames
from ..widget.timed_frame import TimedFrame
from .recorded_overlay import BesidePicturesOf

BYTES_PER_SECOND = 2_000_000
"""The maximum for one topic. A page can play this in addition to its other widgets."""

_LEAST, _MOST = 20_000, 1_000_000


class ImageFrames(MessageFrames):
    """A `Track` of pictures, with the calibration of their camera; see `MessageFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: ImageWidget) -> None:
        super().__init__(recording, choice, widget)
        topic = next(topic for topic in recording.topics if topic.name == choice.topic)
        rate = topic.rate or 1.0
        widget.most_bytes = int(min(_MOST, max(_LEAST, BYTES_PER_SECOND / rate)))
        self._beside = BesidePicturesOf(recording, choice.topic, widget)

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        self._beside.load(start, end)
        return super().frames(start, end)

    def _shown(self, seconds: float, now: Mapping[str, Moment | None]) -> TimedFrame:
        timed, moment = super()._shown(seconds, now), now[self._choice.topic]
        about = timed.about
        if moment is not None and "nothing" not in about:
            with suppress(TypeError, ValueError):  # the note of the widget shows the error
                about = about | self._beside.about(seconds, to_image(moment.sample))
        return timed._replace(about=about)
