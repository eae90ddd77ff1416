"""The ring of sonars of a recording, for its player."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from itertools import islice

from ..kinds import sensor_of
from ..kinds.choice import WidgetChoice
from ..poses.mounts import mounts_of
from ..poses.transforms import STATIC, TRANSFORMS, Transform, transforms_of
from ..recordings import RecordingData
from ..recordings.topics import Moment
from ..sonar_widget import SonarWidget
from ..tracks import LOOKED_AT, SampleFrames, silent_after


class SonarFrames(SampleFrames):
    """A `Track` of a ring of sonars, each at its pose by tf, and stale by its own rate; see `SampleFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: SonarWidget) -> None:
        super().__init__(recording, choice, widget)
        first: dict[str, list[Moment]] = {sensor_of(name): [] for name in choice.own}
        for moment in islice(recording.samples(choice.own), LOOKED_AT * len(choice.own)):
            first[sensor_of(moment.topic)].append(moment)
        silences = {sensor: silent_after(moments) for sensor, moments in first.items()}
        widget.be_silent_after({sensor: seconds for sensor, seconds in silences.items() if seconds})
        if not widget.poses:
            mounts = mounts_of(_static_transforms(recording))
            frames = {sensor: moments[0].sample.frame_id.lstrip("/") for sensor, moments in first.items() if moments}
            widget.poses = {sensor: mounts[frame] for sensor, frame in frames.items() if frame in mounts}


def _static_transforms(recording: RecordingData) -> Iterator[Transform]:
    """Yield the static transforms of tf, without messages that contain no pose."""
    for topic in recording.topics:
        if topic.type in TRANSFORMS and topic.name.rpartition("/")[2] == STATIC and not topic.problem:
            for moment in recording.messages(topic.name):
                with suppress(ValueError):
                    yield from transforms_of(moment.message, topic.name, moment.time_ns)
