"""The mounts of the scanners of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from math import cos, radians, sin

from ..messages.channel import Channel
from ..poses.frame_tree import FrameTree
from ..poses.live_frames import Frames, LiveFrames
from ..poses.mounts import robot_frame, scanner_mount
from ..poses.transforms import STATIC, TRANSFORMS, Transform
from ..samples import Mount, Scan

MOST_READ = 500
"""Transforms of tf that are read to find a scanner: by then all publishers have sent some."""

LOOK_NS = 2_000_000_000
"""Nanoseconds of tf that are read in the middle and at the end, to see if the scanner moves on its robot."""

MOVED = radians(1)

ReadTransforms = Callable[["Sequence[Channel]", "int | None", "int | None"], "Iterator[Transform]"]


class RecordedMounts:
    """The mounts of scanners by their frames: given by hand, or found in tf when the first scan is read.

    Transforms that are not static are read at the beginning, in the middle and at the end; if the mount differs between
    them, the scanner moves on its robot, and all are read.

    Args:
        channels: all channels of the recording.
        read: returns the transforms of some channels between two times in nanoseconds; None means no limit.
        span_ns: the times of the first and the last message.
    """

    def __init__(self, channels: Sequence[Channel], read: ReadTransforms, span_ns: tuple[int, int]) -> None:
        tf = [channel for channel in channels if channel.type in TRANSFORMS and channel.count]
        self._static = [channel for channel in tf if channel.topic.rpartition("/")[2] == STATIC]
        self._moving = [channel for channel in tf if channel not in self._static]
        self._read, self._span_ns = read, span_ns
        self.by_hand: dict[str, Mount] = {}
        """The mounts that are given by hand, by frame."""
        self._found: dict[str, Mount | None] = {}
        self._trees: dict[str, Frames] = {}
        """All transforms, by the frame of a scanner that moves on its robot."""
        self._known: list[Transform] | None = None

    def put(self, frame_id: str, mount: Mount | None) -> None:
        """Set a mount by hand, or None to use tf again."""
        self.by_hand.pop(frame_id.lstrip("/"), None)
        if mount is not None:
            self.by_hand[frame_id.lstrip("/")] = mount

    def of(self, frame_id: str, time_ns: int | None = None, stamp_ns: int | None = None) -> Mount | None:
        """Return the mount of a scanner, at a time if it moves on its robot, or None if it is unknown."""
        frame = frame_id.lstrip("/")
        if frame in self.by_hand:
            return self.by_hand[frame]
        if frame not in self._found:
            self._found[frame] = self._find(frame)
        if frame in self._trees and time_ns is not None:
            return scanner_mount(self._trees[frame], frame, time_ns, stamp_ns)
        return self._found[frame]

    def moves(self, frame_id: str) -> bool:
        """Return True if the scanner moves on its robot. Call `of` before."""
        frame = frame_id.lstrip("/")
        return frame in self._trees and frame not in self.by_hand

    def mounted(self, scan: Scan, time_ns: int | None = None) -> Scan:
        """Return a scan of the recording with its angles in the frame of the robot, if its mount is known."""
        mount = self.of(scan.frame_id, time_ns, scan.stamp_ns)
        return scan if mount is None else scan.mounted(mount)

    def _find(self, frame: str) -> Mount | None:
        if not frame or not (self._static or self._moving):
            return None
        if self._known is None:
            self._known = list(self._read(self._static, None, None)) if self._static else []
        mount = scanner_mount(FrameTree(self._known), frame)
        if mount is not None or not self._moving:
            return mount
        first = self._look(frame, None, None)
        if first is None:
            return None
        begin, end = self._span_ns
        later = [self._look(frame, at, at + LOOK_NS) for at in ((begin + end) // 2, end - LOOK_NS)]
        if any(other is not None and _apart(first, other) for other in later):
            self._trees[frame] = FrameTree([*self._known, *self._read(self._moving, None, None)])
        return first

    def _look(self, frame: str, start_ns: int | None, stop_ns: int | None) -> Mount | None:
        """Return the mount from the first sufficient transforms between two times."""
        frames = LiveFrames()
        for one in self._known or ():
            frames.add(one)
        edition = -1
        for one in islice(self._read(self._moving, start_ns, stop_ns), MOST_READ):
            frames.add(one)
            if frames.edition != edition and robot_frame(frames, frame):
                return scanner_mount(frames, frame, one.time_ns, one.stamp_ns)
            edition = frames.edition
        return None


def _apart(one: Mount, other: Mount) -> bool:
    """Return True if two mounts differ by more than the noise of tf."""
    turned = abs(one.yaw - other.yaw)
    return (
        one.upside_down != other.upside_down
        or 2 - 2 * cos(turned) > (2 * sin(MOVED / 2)) ** 2
        or abs(one.tilt - other.tilt) > MOVED
    )
