"""The calibration, scans, ranges and frames of a recording that are drawn over the pictures of a camera."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import Any

from ..camera import BesidePictures
from ..image_widget import ImageWidget
from ..kinds import sensor_of
from ..notebook.progress import without_bars
from ..poses.frame_tree import FrameTree
from ..recordings import RecordingData
from ..recordings.calibration import first_info
from .overlay import RANGE, SCAN

AROUND = 1.0
"""Seconds around a picture in which the nearest scan is searched."""


class BesidePicturesOf:
    """A source for an image widget of the calibration, the scans, the ranges and the frames of a recording.

    Args:
        recording: the recording.
        topic: the topic of the pictures.
        widget: the widget that shows the pictures.
    """

    def __init__(self, recording: RecordingData, topic: str, widget: ImageWidget) -> None:
        self._recording, self._widget = recording, widget
        # A separate one for each track: the player's thread and a page in a file read different times.
        self._beside = BesidePictures()
        types = {one.name: one.type for one in recording.topics if not one.problem}
        self._scans = sorted(name for name, kind in types.items() if kind == SCAN)
        self._ranges = sorted(one.name for one in recording.topics if one.type == RANGE and one.widget == "sonar")
        self._tree: FrameTree | None = None
        info = first_info(recording, topic)
        if info is not None and widget.beside.info is None:
            with suppress(TypeError, ValueError):
                widget.calibrate(info)
        self._beside.info = widget.beside.info

    def load(self, start: float, end: float) -> None:
        """Read the scans around a span."""
        beside = self._beside
        if not (self._scans or self._ranges):
            return
        if self._tree is None:
            with without_bars():
                self._tree = beside.frames = FrameTree(self._recording.transforms())
        if self._scans:
            chosen = self._widget.choose_scan(self._scans)
            moments = self._recording.samples(chosen, max(0.0, start - AROUND), end + AROUND)
            beside.scans = deque((moment.sample, moment.time_ns) for moment in moments)

    def about(self, seconds: float, picture: Any) -> dict[str, Any]:
        """Return the data for the page on the overlay of a picture at a time."""
        beside = self._beside
        beside.by_hand = self._widget.beside.by_hand
        found = {name: self._recording.at(name, seconds) for name in self._ranges}
        beside.ranges = {sensor_of(name): (one.sample, one.time_ns) for name, one in found.items() if one}
        return self._widget.over_of(picture, (self._recording.start_ns or 0) + round(seconds * 1e9), beside)
