"""The coordinate frames of a running robot by its transforms, and the pose of a frame in another."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from .frame_tree import HELD_S, Poses, Times, TransformHistory
from .transforms import Transform

KEPT = 500
"""Transforms to keep for each frame: ten seconds at 50 Hz."""


class Frames(Protocol):
    """A tree of coordinate frames: a `FrameTree` of a recording, or the `LiveFrames` of a running robot."""

    def chain(self, frame: str) -> list[str]:
        """Return the frame and its ancestors up to the root."""

    def poses(self, frame: str, world: str, times_ns: Times, stamps_ns: Times) -> Poses:
        """Return the poses of a frame in one of its `chain`, at some times."""

    def history(self, frame: str) -> TransformHistory | None:
        """Return the history of a frame, or None if no message names its parent."""


class TakesFrames(Protocol):
    """A widget that gets the poses of the robot and its sensors from a feed."""

    @property
    def frame_topics(self) -> str:
        """The topics to take: "odometry" (the first topic, or tf without odometry), "tf", "both", or empty for none."""

    def take_frames(self, message: Any) -> None:
        """Take a message of odometry or tf, from any thread. Invalid messages are ignored."""

    def take_static_frames(self, message: Any) -> None:
        """Take a message of static tf, from any thread. Invalid messages are ignored."""


@runtime_checkable
class TakesTopics(Protocol):
    """A widget that gets messages of further topics from a feed."""

    def topics_beside(self, topics: Mapping[str, str]) -> Sequence[tuple[str, Callable[[Any], object]]]:
        """Return the names of the topics that it needs, each with a function that takes its messages.

        Args:
            topics: the types of all topics by name.
        """


class LiveFrames:
    """The frames of a running robot, with the last transforms from each frame to its parent.

    Odometry counts for a frame without a parent in tf.
    """

    def __init__(self) -> None:
        self.edition = 0
        """The number of times that a frame got another parent."""
        self._parents: dict[str, str] = {}
        self._rows: dict[str, deque[Transform]] = {}
        self._by_odometry: set[str] = set()
        self._histories: dict[str, TransformHistory] = {}

    def add(self, one: Transform) -> None:
        """Take the newest transform of a frame. Its ``time_ns`` is its time of arrival."""
        child = one.child
        if one.odometry and child in self._parents and child not in self._by_odometry:
            return
        is_other = self._parents.get(child) != one.parent or (child in self._by_odometry) != one.odometry
        rows = self._rows.get(child)
        if rows is None or is_other or one.static or one.stamp_ns < rows[-1].stamp_ns:
            rows = self._rows[child] = deque(maxlen=KEPT)
        rows.append(one)
        self.edition += self._parents.get(child) != one.parent
        self._parents[child] = one.parent
        (self._by_odometry.add if one.odometry else self._by_odometry.discard)(child)
        self._histories.pop(child, None)

    def chain(self, frame: str) -> list[str]:
        """See `Frames`."""
        chain = [frame]
        while (parent := self._parents.get(chain[-1])) and parent not in chain:
            chain.append(parent)
        return chain

    def poses(self, frame: str, world: str, times_ns: Times, stamps_ns: Times) -> Poses:
        """See `Frames`."""
        chain = self.chain(frame)
        poses = Poses.identity(len(times_ns))
        for name in chain[: chain.index(world)]:
            poses = self._history(name).at(times_ns, stamps_ns).of(poses)
        return poses

    def is_static(self, frame: str, world: str) -> bool:
        """Return True if only static transforms lead from a frame to one of its `chain`."""
        chain = self.chain(frame)
        return all(self._rows[name][-1].static for name in chain[: chain.index(world)])

    def _history(self, frame: str) -> TransformHistory:
        if frame not in self._histories:
            rows = self._rows[frame]
            numbers = np.array([one.pose for one in rows])
            times, stamps = (
                np.array([getattr(one, name) for one in rows], np.int64) for name in ("time_ns", "stamp_ns")
            )
            poses = Poses(numbers[:, :3], numbers[:, 3:])
            self._histories[frame] = TransformHistory(self._parents[frame], times, stamps, poses, rows[-1].static)
        return self._histories[frame]

    def history(self, frame: str) -> TransformHistory | None:
        """See `Frames`."""
        return self._history(frame) if frame in self._rows else None


class OldTransform(NamedTuple):
    """A transform that was old when it was used, with the seconds since its last message.

    Negative seconds are the time until its first message.
    """

    parent: str
    child: str
    seconds: float


def are_joined(frames: Frames, one: str, other: str) -> bool:
    """Return True if transforms lead from one frame to the other."""
    return one == other or not set(frames.chain(one)).isdisjoint(frames.chain(other))


def joined(frames: Frames, frame: str, world: str, times_ns: Times, stamps_ns: Times) -> Poses | None:
    """Return the poses of a frame in another at log times and stamps, shape (N,), or None if they are not joined."""
    if frame == world:
        return Poses.identity(len(times_ns))
    up, down = frames.chain(frame), frames.chain(world)
    common = next((name for name in up if name in down), None)
    if common is None:
        return None
    inner = frames.poses(frame, common, times_ns, stamps_ns)
    return inner if common == world else frames.poses(world, common, times_ns, stamps_ns).inverse().of(inner)


def held_between(frames: Frames, frame: str, world: str, time_ns: int, stamp_ns: int | None) -> OldTransform | None:
    """Return the oldest transform between two frames at a time, or None if all are newer than `HELD_S`."""
    up, down = frames.chain(frame), frames.chain(world)
    moving = [name for name in (*up, *down) if (name in up) != (name in down)]
    times, stamps = np.array([time_ns], np.int64), np.array([stamp_ns or 0], np.int64)
    found = [
        OldTransform(history.parent, name, float(history.held_s(times, stamps)[0]))
        for name in moving
        if (history := frames.history(name)) is not None
    ]
    oldest = max(found, key=lambda one: abs(one.seconds), default=None)
    return oldest if oldest is not None and abs(oldest.seconds) > HELD_S else None


def notes_on(held: Iterable[OldTransform | None]) -> list[str]:
    """Return a note for users for each transform that was old."""
    oldest: dict[tuple[str, str], OldTransform] = {}
    for one in held:
        if one is not None:
            known = oldest.setdefault((one.parent, one.child), one)
            oldest[one.parent, one.child] = max(known, one, key=lambda each: abs(each.seconds))
    return [
        f"tf {one.parent} → {one.child} "
        + (f"is {one.seconds:.0f} s old" if one.seconds > 0 else f"begins {-one.seconds:.0f} s later")
        for one in oldest.values()
    ]
