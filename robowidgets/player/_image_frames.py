"""The pictures of a recording, as small as a player can send them ahead."""

from __future__ import annotations

from contextlib import suppress

from .._widget_choice import WidgetChoice
from ..image_widget import ImageWidget
from ..kinds import namespace_of
from ..recordings import RecordingData
from ._frames import MessageFrames

BYTES_PER_SECOND = 2_000_000
"""Of one topic. A page plays as much beside its other widgets."""

_LEAST, _MOST = 20_000, 1_000_000

_INFO = "sensor_msgs/msg/CameraInfo"


class ImageFrames(MessageFrames):
    """A `Track` of pictures, with the calibration of their camera; see `MessageFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: ImageWidget) -> None:
        super().__init__(recording, choice, widget)
        topic = next(topic for topic in recording.topics if topic.name == choice.topic)
        rate = topic.rate or 1.0
        widget.most_bytes = int(min(_MOST, max(_LEAST, BYTES_PER_SECOND / rate)))
        if widget.camera is None:
            _calibrate(recording, choice.topic, widget)


def _calibrate(recording: RecordingData, topic: str, widget: ImageWidget) -> None:
    """Take the calibration from the first message of the topic beside that of the pictures, if there is one."""
    space = namespace_of(topic)
    beside = [space, namespace_of(space)]  # "/camera/image_raw/compressed" has another part
    for info in recording.topics:
        if info.type == _INFO and not info.problem and namespace_of(info.name) in beside:
            with suppress(ValueError, TypeError):
                for moment in recording.messages(info.name):
                    widget.calibrate(moment.message)
                    return
