"""The scans of a recording for its player, measured or made of clouds and depth images."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from ..kinds.choice import WidgetChoice
from ..laser_widget import LaserWidget
from ..notebook.progress import without_bars
from ..poses.frame_tree import FrameTree
from ..poses.recent import FARTHEST, RecentPoses
from ..recordings import RecordingData
from ..recordings.calibration import first_info
from ..recordings.odometry import odometry
from ..tracks import MessageFrames, SampleFrames
from ..widget.timed_frame import TimedFrame
from .trail import scanner_in


class ScanFrames(SampleFrames):
    """A `Track` of scans. With a trail, each has its pose by the first topic of odometry, or else by tf."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: LaserWidget) -> None:
        super().__init__(recording, choice, widget)
        self._laser = widget
        self._odometry = odometry(recording.topics)
        self._poses = RecentPoses(None)
        self._tree: FrameTree | None = None

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        self._poses = RecentPoses(None)
        if self._odometry and self._laser.trail:
            for moment in self._recording.samples(self._odometry, max(0.0, start - FARTHEST), end + FARTHEST):
                self._poses.add(moment.sample.pose, moment.seconds, moment.sample.stamp_ns)
        elif self._laser.trail and self._tree is None:
            with without_bars():
                self._tree = FrameTree(self._recording.transforms())
        return super().frames(start, end)

    def _frame(self, seconds: float, sample: Any, **_: Any) -> TimedFrame:
        timed = super()._frame(seconds, sample)
        if self._tree is not None:
            time_ns = (self._recording.start_ns or 0) + round(seconds * 1e9)
            return timed._replace(about=timed.about | scanner_in(self._tree, sample, time_ns))
        robot = self._poses.at(seconds, sample.stamp_ns)
        return timed._replace(about=timed.about | self._laser.scanner_at(robot))


class MadeScanFrames(MessageFrames):
    """A `Track` of scans that are made of clouds or depth images; see `MessageFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: LaserWidget) -> None:
        super().__init__(recording, choice, widget)
        info = first_info(recording, choice.topic)
        if info is not None:
            widget.calibrate(info)
        self._laser = widget

    def _content(self, message: Any) -> Any:
        """Return the scan that is made of a message, in the angles of the robot, or the message if that fails.

        The mount is taken from this track's recording: each thread, and a page in a file, opens a separate one.
        """
        with suppress(TypeError, ValueError):  # the widget shows the error
            return self._recording.mounted(self._laser.scan_in(message))
        return message
