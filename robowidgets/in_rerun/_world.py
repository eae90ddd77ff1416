"""Where the scans of a recording stand in the world."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..poses.tracks import Frames, Poses
from ..recordings import RecordingData

_BASES = ("base_footprint", "base_link")


class World:
    """The frame in which odometry is expressed, or the root of tf where there is none, and the robot in it.

    Args:
        recording: whose.
        scanners: the frames of its scans.
    """

    def __init__(self, recording: RecordingData, scanners: Sequence[str]) -> None:
        self._frames = frames = Frames(recording.transforms())
        chains = [frames.chain(_plain(scanner)) for scanner in scanners]
        if frames.odometry:
            self.name, self.robot = frames.odometry
        else:
            chain = max(chains, key=len, default=["world"])
            moving = [name for name in chain if (track := frames.track(name)) and not track.static]
            named = [base for base in _BASES if base in chain]
            self.name, self.robot = chain[-1], [*named, *moving, chain[0]][0]
        lost = sorted({chain[0] for chain in chains if self.name not in chain})
        self.notes = [
            f"Nothing says where {frame or 'the scanner'} is on the robot: its scans stand at {self.robot}."
            for frame in lost
        ]
        """What is not known, a line each, for a person."""
        if scanners and self.robot == self.name:
            self.notes.append("Neither odometry nor tf says where the robot was: all scans stand at one place.")

    def path(self) -> tuple[NDArray[np.int64], Poses] | None:
        """Log times, and where the robot was at them; None when it is not known."""
        chain = self._frames.chain(self.robot)
        tracks = [track for name in chain[: chain.index(self.name)] if (track := self._frames.track(name))]
        if not tracks:
            return None
        track = max(tracks, key=lambda track: len(track.times_ns))
        return track.times_ns, self._frames.poses(self.robot, self.name, track.times_ns, track.stamps_ns)

    def poses(self, frame: str, times_ns: NDArray[np.int64], stamps_ns: NDArray[np.int64]) -> Poses:
        """Where a scanner was, at some log times and stamps: where the robot was, if nothing says where on it."""
        name = _plain(frame)
        if self.name not in self._frames.chain(name):
            name = self.robot
        return self._frames.poses(name, self.name, times_ns, stamps_ns)


def _plain(frame: str) -> str:
    return frame.lstrip("/")
