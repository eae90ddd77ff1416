"""What a recording has beside the pictures of a camera, for what lies over them."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import Any

from .._core.progress import without_bars
from ..image_widget import ImageWidget
from ..imaging.overlay import RANGE, SCAN, info_of
from ..kinds import sensor_of
from ..poses.frame_tree import FrameTree
from ..recordings import RecordingData

AROUND = 1.0
"""Seconds round a picture in which the nearest scan is looked for."""


class BesidePicturesOf:
    """Gives an image widget the calibration, the scans, the ranges and the frames of a recording.

    Args:
        recording: the recording.
        topic: of the pictures.
        widget: shows them.
    """

    def __init__(self, recording: RecordingData, topic: str, widget: ImageWidget) -> None:
        self._recording, self._widget = recording, widget
        types = {one.name: one.type for one in recording.topics if not one.problem}
        self._scans = sorted(name for name, kind in types.items() if kind == SCAN)[:1]
        self._ranges = sorted(one.name for one in recording.topics if one.type == RANGE and one.widget == "sonar")
        self._tree: FrameTree | None = None
        info = info_of(topic, types)
        first = next(iter(recording.messages(info)), None) if info else None
        if first is not None and widget.beside.info is None:
            with suppress(TypeError, ValueError):
                widget.calibrate(first.message)

    def load(self, start: float, end: float) -> None:
        """Take the scans round a span."""
        beside = self._widget.beside
        if not self._widget.overlay or not (self._scans or self._ranges):
            return
        if self._tree is None:
            with without_bars():
                self._tree = beside.frames = FrameTree(self._recording.transforms())
        if self._scans:
            moments = self._recording.samples(self._scans, max(0.0, start - AROUND), end + AROUND)
            beside.scans = deque((moment.sample, moment.time_ns) for moment in moments)

    def about(self, seconds: float, picture: Any) -> dict[str, Any]:
        """What the page is told of what lies over a picture at a time."""
        beside = self._widget.beside
        found = {name: self._recording.at(name, seconds) for name in self._ranges if self._widget.overlay}
        beside.ranges = {sensor_of(name): (one.sample, one.time_ns) for name, one in found.items() if one}
        return self._widget.over_of(picture, (self._recording.start_ns or 0) + round(seconds * 1e9))
