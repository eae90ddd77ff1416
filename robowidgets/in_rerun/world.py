"""The poses of a recording's scanners in the world frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..poses.frame_tree import FrameTree, Poses
from ..recordings import RecordingData

_BASES = ("base_footprint", "base_link")


class WorldFrame:
    """The world frame (the parent frame of odometry, or else the root of tf) and the frame of the robot in it.

    Args:
        recording: the recording.
        scanners: the frames of the sensors that are drawn at the robot if their pose is unknown.
        others: the frames of the sensors that are drawn apart from the world if their pose is unknown.
    """

    def __init__(self, recording: RecordingData, scanners: Sequence[str], others: Sequence[str] = ()) -> None:
        self._frames = frames = FrameTree(recording.transforms())
        chains = [frames.chain(_plain(name)) for name in (*scanners, *others)]
        if frames.odometry:
            self.name, self.robot = frames.odometry
        else:
            chain = max(chains, key=len, default=["world"])
            moving = [name for name in chain if (history := frames.history(name)) and not history.static]
            named = [base for base in _BASES if base in chain]
            self.name, self.robot = chain[-1], [*named, *moving, chain[0]][0]
        lost = sorted({chain[0] for chain in chains[: len(scanners)] if self.name not in chain})
        self.notes = [
            f"The pose of {frame or 'the scanner'} on the robot is unknown: its scans are drawn at {self.robot}."
            for frame in lost
        ]
        """One line for each unknown pose, for the user."""
        if scanners and self.robot == self.name:
            self.notes.append("Neither odometry nor tf has the pose of the robot: all scans are drawn at one place.")

    def has(self, frame: str) -> bool:
        """Return True if the pose of a frame in the world is known."""
        return self.name in self._frames.chain(_plain(frame))

    def path(self) -> tuple[NDArray[np.int64], Poses] | None:
        """Return log times, shape (N,), and the poses of the robot at these times, or None if they are unknown."""
        chain = self._frames.chain(self.robot)
        histories = [history for name in chain[: chain.index(self.name)] if (history := self._frames.history(name))]
        if not histories:
            return None
        history = max(histories, key=lambda history: len(history.times_ns))
        return history.times_ns, self._frames.poses(self.robot, self.name, history.times_ns, history.stamps_ns)

    def poses(self, frame: str, times_ns: NDArray[np.int64], stamps_ns: NDArray[np.int64]) -> Poses:
        """Return the poses of a scanner, or of the robot if they are unknown, at some log times and stamps."""
        name = _plain(frame)
        if self.name not in self._frames.chain(name):
            name = self.robot
        return self._frames.poses(name, self.name, times_ns, stamps_ns)


def _plain(frame: str) -> str:
    return frame.lstrip("/")
