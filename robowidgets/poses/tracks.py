"""The frames of a robot through a recording, and where one was in another at any time."""

from __future__ import annotations

from array import array
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .transforms import Joint

Floats = NDArray[np.float64]
Times = NDArray[np.int64]


class Poses(NamedTuple):
    """Where a frame is in another: metres, shape (N, 3), and quaternions x, y, z, w of length 1, shape (N, 4)."""

    places: Floats
    turns: Floats

    @classmethod
    def still(cls, count: int) -> Poses:
        """Those of a frame that is the other one."""
        return cls(np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))

    def of(self, inner: Poses) -> Poses:
        """Those in the outer frame of what is at ``inner`` in this one."""
        return Poses(self.places + _turned(self.turns, inner.places), _product(self.turns, inner.turns))

    def inverse(self) -> Poses:
        """Those of the other frame in this one."""
        back = self.turns * [-1.0, -1.0, -1.0, 1.0]
        return Poses(-_turned(back, self.places), back)


@dataclass(frozen=True)
class Track:
    """One frame in its parent through all times.

    Args:
        parent: the name of that.
        times_ns: log times of what was said, shape (N,), N > 0.
        stamps_ns: the messages' own times, shape (N,); 0 where they bear none.
        poses: what was said.
        static: whether the last of it holds for all times.
    """

    parent: str
    times_ns: Times
    stamps_ns: Times
    poses: Poses
    static: bool = False

    def at(self, times_ns: Times, stamps_ns: Times) -> Poses:
        """Between what was said, and before and after it the nearest.

        By the messages' own times, where both have such, from the same clock; else by when they were recorded.
        """
        if self.static:
            return Poses(*(np.tile(column[-1], (len(times_ns), 1)) for column in self.poses))
        known, order = self._by_stamp
        asked = stamps_ns
        if not (known[0] and stamps_ns.all() and stamps_ns.max() >= known[0] and stamps_ns.min() <= known[-1]):
            known, order = self._by_time
            asked = times_ns
        after = np.searchsorted(known, asked).clip(1, max(len(known) - 1, 1))
        before = after - 1
        after = np.minimum(after, len(known) - 1)
        span = np.maximum(known[after] - known[before], 1)
        share = ((asked - known[before]) / span).clip(0.0, 1.0)[:, None]
        one, other = (Poses(*(column[order[rows]] for column in self.poses)) for rows in (before, after))
        # Of two quaternions for the same turn the near one; between two messages a chord is as good as an arc.
        near = np.where((one.turns * other.turns).sum(axis=1, keepdims=True) < 0, -1.0, 1.0) * other.turns
        turns = one.turns + share * (near - one.turns)
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        return Poses(one.places + share * (other.places - one.places), turns)

    @cached_property
    def _by_time(self) -> tuple[Times, Times]:
        return _sorted(self.times_ns)

    @cached_property
    def _by_stamp(self) -> tuple[Times, Times]:
        return _sorted(self.stamps_ns)


class _Said:
    """What was said of a frame in its parent, as it comes."""

    def __init__(self) -> None:
        self._times, self._stamps, self._poses = array("q"), array("q"), array("d")
        self._static = False

    def add(self, joint: Joint) -> None:
        """Take in what one message says."""
        self._times.append(joint.time_ns)
        self._stamps.append(joint.stamp_ns)
        self._poses.extend(joint.pose)
        self._static = joint.static

    def track(self, parent: str) -> Track:
        """All of it."""
        poses = np.array(self._poses).reshape(-1, 7)
        times, stamps = (np.array(column, np.int64) for column in (self._times, self._stamps))
        return Track(parent, times, stamps, Poses(poses[:, :3], poses[:, 3:]), self._static)


class Frames:
    """All frames of a recording.

    Odometry is one of the joints where tf does not say the same: so robots that record no tf have poses too.

    Args:
        joints: all that was said, in any order.
    """

    odometry: tuple[str, str] | None
    """The frame in which it is expressed and the one that it moves, of the odometry that came first; None without."""

    def __init__(self, joints: Iterable[Joint]) -> None:
        told: defaultdict[tuple[str, str], _Said] = defaultdict(_Said)
        moved: defaultdict[tuple[str, str], _Said] = defaultdict(_Said)
        parents: dict[str, str] = {}
        for joint in joints:
            (moved if joint.odometry else told)[joint.parent, joint.child].add(joint)
            if not joint.odometry:
                parents[joint.child] = joint.parent
        # Where messages differ on the parent of a frame, those like the last hold.
        self._tracks = {child: told[parent, child].track(parent) for child, parent in parents.items()}
        self.odometry = next(iter(moved), None)
        if self.odometry:
            self._join(*self.odometry, moved[self.odometry].track(self.odometry[0]))

    def chain(self, frame: str) -> list[str]:
        """The frame, its parent, the parent of that, up to the root."""
        chain = [frame]
        while (track := self._tracks.get(chain[-1])) and track.parent not in chain:
            chain.append(track.parent)
        return chain

    def track(self, frame: str) -> Track | None:
        """A frame in its parent; None when that is not known."""
        return self._tracks.get(frame)

    def poses(self, frame: str, world: str, times_ns: Times, stamps_ns: Times) -> Poses:
        """Where a frame was in one that is above it in its `chain`, at some times and stamps, shape (N,) each."""
        chain = self.chain(frame)
        poses = Poses.still(len(times_ns))
        for name in chain[: chain.index(world)]:
            poses = self._tracks[name].at(times_ns, stamps_ns).of(poses)
        return poses

    def _join(self, world: str, base: str, odometry: Track) -> None:
        chain = self.chain(base)
        if world in chain:
            return
        # The root of what tf knows is what moves, though odometry may speak of a frame below it.
        below = self.poses(base, chain[-1], odometry.times_ns, odometry.stamps_ns)
        poses = odometry.poses.of(below.inverse())
        self._tracks[chain[-1]] = Track(world, odometry.times_ns, odometry.stamps_ns, poses)


def _sorted(times: Times) -> tuple[Times, Times]:
    order = np.argsort(times, kind="stable")
    return times[order], order


def _turned(turns: Floats, places: Floats) -> Floats:
    axis, real = turns[:, :3], turns[:, 3:]
    across = 2.0 * np.cross(axis, places)
    return np.asarray(places + real * across + np.cross(axis, across))


def _product(one: Floats, other: Floats) -> Floats:
    (a, b), (c, d) = ((turns[:, :3], turns[:, 3:]) for turns in (one, other))
    axis = b * c + d * a + np.cross(a, c)
    return np.hstack([axis, b * d - (a * c).sum(axis=1, keepdims=True)])
