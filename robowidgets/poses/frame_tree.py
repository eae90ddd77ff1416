"""The coordinate frames of a robot in a recording, and the pose of a frame in another at any time."""

from __future__ import annotations

from array import array
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .transforms import Transform

HELD_S = 10.0
"""Seconds after which a transform is old, as in tf2, which drops it. Over a longer gap it is held, not interpolated."""

Floats = NDArray[np.float64]
Times = NDArray[np.int64]


class Poses(NamedTuple):
    """Poses of a frame in another: metres, shape (N, 3), and quaternions x, y, z, w of length 1, shape (N, 4)."""

    positions: Floats
    orientations: Floats

    @classmethod
    def identity(cls, count: int) -> Poses:
        """Return the poses of a frame in itself."""
        return cls(np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))

    def of(self, inner: Poses) -> Poses:
        """Return the poses in the outer frame for ``inner``, poses in the inner frame."""
        positions = self.positions + _rotated(self.orientations, inner.positions)
        return Poses(positions, _product(self.orientations, inner.orientations))

    def moved(self, points: Floats) -> Floats:
        """Return points in the outer frame for points in the inner frame, shape (M, 3), by a single pose."""
        return np.asarray(self.positions + _rotated(np.repeat(self.orientations, len(points), axis=0), points))

    def inverse(self) -> Poses:
        """Return the poses of the outer frame in the inner frame."""
        back = self.orientations * [-1.0, -1.0, -1.0, 1.0]
        return Poses(-_rotated(back, self.positions), back)


@dataclass(frozen=True)
class TransformHistory:
    """The poses of a frame in its parent in a recording.

    Args:
        parent: the name of the parent.
        times_ns: log times, shape (N,), N > 0.
        stamps_ns: stamps of the messages, shape (N,); 0 for messages without a stamp.
        poses: the poses at these times.
        static: True if the last pose is valid at all times.
    """

    parent: str
    times_ns: Times
    stamps_ns: Times
    poses: Poses
    static: bool = False

    def at(self, times_ns: Times, stamps_ns: Times) -> Poses:
        """Return the poses at some log times and stamps, shape (N,) each: interpolated, or the nearest at the ends.

        Times are compared by stamps if both have stamps of the same clock, else by log times. In a gap longer than
        `HELD_S` the pose before the gap is held.
        """
        if self.static:
            return Poses(*(np.tile(column[-1], (len(times_ns), 1)) for column in self.poses))
        given, order, asked = self._clock(times_ns, stamps_ns)
        before, after = _neighbours(given, asked)
        gap = given[after] - given[before]
        share = ((asked - given[before]) / np.maximum(gap, 1)).clip(0.0, 1.0)
        share = np.where((gap > HELD_S * 1e9) & (asked < given[after]), 0.0, share)[:, None]
        one, other = (Poses(*(column[order[rows]] for column in self.poses)) for rows in (before, after))
        positions = one.positions + share * (other.positions - one.positions)
        return Poses(positions, _slerp(one.orientations, other.orientations, share))

    def held_s(self, times_ns: Times, stamps_ns: Times) -> Floats:
        """Return the seconds since the message whose pose is held at each time, or minus the seconds until the first.

        They are 0 if the pose is static or interpolated between two messages.
        """
        if self.static:
            return np.zeros(len(times_ns))
        given, _, asked = self._clock(times_ns, stamps_ns)
        before, after = _neighbours(given, asked)
        is_near = (asked >= given[before]) & (asked <= given[after]) & (given[after] - given[before] <= HELD_S * 1e9)
        is_at = asked == given[after]
        since = np.where(asked > given[after], asked - given[after], asked - given[before])
        return np.where(is_near | is_at, 0.0, since / 1e9)

    def _clock(self, times_ns: Times, stamps_ns: Times) -> tuple[Times, Times, Times]:
        """Return the sorted times of the messages, their order, and the requested times, all by the same clock."""
        given, order = self._by_stamp
        if given[0] and stamps_ns.all() and stamps_ns.max() >= given[0] and stamps_ns.min() <= given[-1]:
            return given, order, stamps_ns
        return (*self._by_time, times_ns)

    @cached_property
    def _by_time(self) -> tuple[Times, Times]:
        return _sorted(self.times_ns)

    @cached_property
    def _by_stamp(self) -> tuple[Times, Times]:
        return _sorted(self.stamps_ns)


class _Collected:
    """The transforms from a frame to its parent, collected one by one."""

    def __init__(self) -> None:
        self._times, self._stamps, self._poses = array("q"), array("q"), array("d")
        self._static = False

    def add(self, transform: Transform) -> None:
        """Append a transform."""
        self._times.append(transform.time_ns)
        self._stamps.append(transform.stamp_ns)
        self._poses.extend(transform.pose)
        self._static = transform.static

    def history(self, parent: str) -> TransformHistory:
        """Return the history of these transforms."""
        poses = np.array(self._poses).reshape(-1, 7)
        times, stamps = (np.array(column, np.int64) for column in (self._times, self._stamps))
        return TransformHistory(parent, times, stamps, Poses(poses[:, :3], poses[:, 3:]), self._static)


class FrameTree:
    """The tree of all coordinate frames of a recording.

    Odometry is added to the tree unless tf contains the same transform, so that robots without tf have poses too.

    Args:
        transforms: all transforms of the recording, in any order.
    """

    odometry: tuple[str, str] | None
    """The parent and the child frame of the first odometry, or None without odometry."""

    def __init__(self, transforms: Iterable[Transform]) -> None:
        by_tf: defaultdict[tuple[str, str], _Collected] = defaultdict(_Collected)
        by_odometry: defaultdict[tuple[str, str], _Collected] = defaultdict(_Collected)
        parents: dict[str, str] = {}
        for transform in transforms:
            (by_odometry if transform.odometry else by_tf)[transform.parent, transform.child].add(transform)
            if not transform.odometry:
                parents[transform.child] = transform.parent
        # If messages name different parents of a frame, the last one counts.
        self._histories = {child: by_tf[parent, child].history(parent) for child, parent in parents.items()}
        self.odometry = next(iter(by_odometry), None)
        if self.odometry:
            self._join(*self.odometry, by_odometry[self.odometry].history(self.odometry[0]))

    def chain(self, frame: str) -> list[str]:
        """Return the frame and its ancestors up to the root."""
        chain = [frame]
        while (history := self._histories.get(chain[-1])) and history.parent not in chain:
            chain.append(history.parent)
        return chain

    def history(self, frame: str) -> TransformHistory | None:
        """Return the history of a frame, or None if no message names its parent."""
        return self._histories.get(frame)

    def poses(self, frame: str, world: str, times_ns: Times, stamps_ns: Times) -> Poses:
        """Return the poses of a frame in one of its `chain`, at some log times and stamps, shape (N,) each."""
        chain = self.chain(frame)
        poses = Poses.identity(len(times_ns))
        for name in chain[: chain.index(world)]:
            poses = self._histories[name].at(times_ns, stamps_ns).of(poses)
        return poses

    def _join(self, world: str, base: str, odometry: TransformHistory) -> None:
        chain = self.chain(base)
        if world in chain:
            return
        # If the child of odometry has ancestors in tf, their root gets the pose in the world.
        below = self.poses(base, chain[-1], odometry.times_ns, odometry.stamps_ns)
        poses = odometry.poses.of(below.inverse())
        self._histories[chain[-1]] = TransformHistory(world, odometry.times_ns, odometry.stamps_ns, poses)


def _sorted(times: Times) -> tuple[Times, Times]:
    order = np.argsort(times, kind="stable")
    return times[order], order


def _neighbours(given: Times, asked: Times) -> tuple[Times, Times]:
    """Return the indices of the messages before and after some times, or of the two nearest messages at the ends."""
    after = np.searchsorted(given, asked).clip(1, max(len(given) - 1, 1))
    return after - 1, np.minimum(after, len(given) - 1)


def _slerp(start: Floats, end: Floats, share: Floats) -> Floats:
    """Return the quaternions at a share of the shortest turn from one to another, shape (N, 4), as tf2 does."""
    along = (start * end).sum(axis=1, keepdims=True)
    # q and -q are the same orientation: take the nearer one.
    end = np.where(along < 0, -1.0, 1.0) * end
    angle = np.arccos(np.abs(along).clip(max=1.0))
    sine = np.sin(angle)
    is_turn = sine > 1e-6
    divisor = np.where(is_turn, sine, 1.0)
    first = np.where(is_turn, np.sin((1 - share) * angle) / divisor, 1 - share)
    second = np.where(is_turn, np.sin(share * angle) / divisor, share)
    turned = first * start + second * end
    return np.asarray(turned / np.linalg.norm(turned, axis=1, keepdims=True))


def _rotated(orientations: Floats, positions: Floats) -> Floats:
    axis, real = orientations[:, :3], orientations[:, 3:]
    across = 2.0 * _cross(axis, positions)
    return np.asarray(positions + real * across + _cross(axis, across))


_AFTER, _BEFORE = np.array([1, 2, 0]), np.array([2, 0, 1])


def _cross(one: Floats, other: Floats) -> Floats:
    """Return cross products, shape (N, 3). `np.cross` takes ten times as long for a few."""
    product: Floats = one[:, _AFTER] * other[:, _BEFORE] - one[:, _BEFORE] * other[:, _AFTER]
    return product


def _product(one: Floats, other: Floats) -> Floats:
    (a, b), (c, d) = ((part[:, :3], part[:, 3:]) for part in (one, other))
    axis = b * c + d * a + _cross(a, c)
    return np.hstack([axis, b * d - (a * c).sum(axis=1, keepdims=True)])
