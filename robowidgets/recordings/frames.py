"""The frames of a robot through a recording, and where one was in another at any time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .joints import Joint

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

    @classmethod
    def of(cls, joints: Sequence[Joint]) -> Track:
        """What some messages say of one frame: if they differ on its parent, those like the last."""
        last = joints[-1]
        same = [joint for joint in joints if joint.parent == last.parent]
        poses = np.array([joint.pose for joint in same])
        times, stamps = (np.array([getattr(j, name) for j in same], np.int64) for name in ("time_ns", "stamp_ns"))
        return cls(last.parent, times, stamps, Poses(poses[:, :3], poses[:, 3:]), last.static)

    def at(self, times_ns: Times, stamps_ns: Times) -> Poses:
        """Between what was said, by the messages' own times where both have such; before and after it the nearest."""
        if self.static:
            return Poses(*(np.tile(column[-1], (len(times_ns), 1)) for column in self.poses))
        stamped = bool(self.stamps_ns.all() and stamps_ns.all())
        known, asked = (self.stamps_ns, stamps_ns) if stamped else (self.times_ns, times_ns)
        order = np.argsort(known, kind="stable")
        known = known[order]
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


class Frames:
    """All frames of a recording.

    Odometry is one of the joints where tf does not say the same: so robots that record no tf have poses too.

    Args:
        joints: all that was said, in any order.
    """

    odometry: tuple[str, str] | None
    """The frame in which it is expressed and the one that it moves, of the odometry that came first; None without."""

    def __init__(self, joints: Iterable[Joint]) -> None:
        told: dict[str, list[Joint]] = {}
        moved: dict[tuple[str, str], list[Joint]] = {}
        for joint in joints:
            if joint.odometry:
                moved.setdefault((joint.parent, joint.child), []).append(joint)
            else:
                told.setdefault(joint.child, []).append(joint)
        self._tracks = {child: Track.of(some) for child, some in told.items()}
        self.odometry = next(iter(moved), None)
        if self.odometry:
            self._join(*self.odometry, Track.of(moved[self.odometry]))

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


def _turned(turns: Floats, places: Floats) -> Floats:
    axis, real = turns[:, :3], turns[:, 3:]
    across = 2.0 * np.cross(axis, places)
    return np.asarray(places + real * across + np.cross(axis, across))


def _product(one: Floats, other: Floats) -> Floats:
    (a, b), (c, d) = ((turns[:, :3], turns[:, 3:]) for turns in (one, other))
    axis = b * c + d * a + np.cross(a, c)
    return np.hstack([axis, b * d - (a * c).sum(axis=1, keepdims=True)])
