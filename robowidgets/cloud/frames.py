"""The clouds of a recording, with as many points as a player can send ahead."""

from __future__ import annotations

from ..cloud_widget import CloudWidget
from ..kinds.choice import WidgetChoice
from ..recordings import RecordingData
from ..tracks import MessageFrames

BYTES_PER_SECOND = 4_000_000
"""The maximum for one topic. A page can play this in addition to its other widgets."""

_MOST = 2_000_000


class CloudFrames(MessageFrames):
    """A `Track` of clouds, thinned more if they come more often; see `MessageFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: CloudWidget) -> None:
        super().__init__(recording, choice, widget)
        topic = next(topic for topic in recording.topics if topic.name == choice.topic)
        widget.most_bytes = int(min(_MOST, BYTES_PER_SECOND / max(1.0, topic.rate or 0.0)))
