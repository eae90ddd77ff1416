"""The calibration of a camera in a recording."""

from __future__ import annotations

from typing import Any

from ..kinds import info_of
from ._readable import ReadableRecording


def first_info(recording: ReadableRecording, topic: str) -> Any:
    """Return the first message with the calibration of the camera of a topic, or None if it is missing."""
    types = {one.name: one.type for one in recording.topics if not one.problem}
    info = info_of(topic, types)
    first = next(iter(recording.messages(info)), None) if info else None
    return first and first.message
