"""The coordinate frames of a robot through a recording, and the pose of one in another at any time."""

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

Floats = NDArray[np.float64]
Times = NDArray[np.int64]


class Poses(NamedTuple):
    """Poses of a frame in another: metres, shape (N, 3), and quaternions x, y, z, w of length 1, shape (N, 4)."""

    positions: Floats
    orientations: Floats

    @classmethod
    def identity(cls, count: int) -> Poses:
        """The poses of a frame in itself."""
        return cls(np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))

    def of(self, inner: Poses) -> Poses:
        """The poses in the outer frame of something at ``inner`` in the inner one."""
        positions = self.positions + _rotated(self.orientations, inner.positions)
        return Poses(positions, _product(self.orientations, inner.orientations))

    def moved(self, points: Floats) -> Floats:
        """Points in the inner frame, shape (M, 3), in the outer one, of a single pose."""
        return np.asarray(self.positions + _rotated(np.repeat(self.orientations, len(points), axis=0), points))

    def inverse(self) -> Poses:
        """The poses of the outer frame in the inner one."""
        back = self.orientations * [-1.0, -1.0, -1.0, 1.0]
        return Poses(-_rotated(back, self.positions), back)


@dataclass(frozen=True)
class TransformHistory:
    """The poses of one frame in its parent through a recording.

    Args:
        parent: the name of the parent.
        times_ns: log times, shape (N,), N > 0.
        stamps_ns: stamps of the messages, shape (N,); 0 for messages without one.
        poses: the poses at these times.
        static: whether the last pose is valid at all times.
    """

    parent: str
    times_ns: Times
    stamps_ns: Times
    poses: Poses
    static: bool = False

    def at(self, times_ns: Times, stamps_ns: Times) -> Poses:
        """The poses at some log times and stamps, shape (N,) each: interpolated, and at the ends the nearest.

        By stamps if both have stamps of the same clock, else by log times.
        """
        if self.static:
            return Poses(*(np.tile(column[-1], (len(times_ns), 1)) for column in self.poses))
        given, order = self._by_stamp
        asked = stamps_ns
        if not (given[0] and stamps_ns.all() and stamps_ns.max() >= given[0] and stamps_ns.min() <= given[-1]):
            given, order = self._by_time
            asked = times_ns
        after = np.searchsorted(given, asked).clip(1, max(len(given) - 1, 1))
        before = after - 1
        after = np.minimum(after, len(given) - 1)
        span = np.maximum(given[after] - given[before], 1)
        share = ((asked - given[before]) / span).clip(0.0, 1.0)[:, None]
        one, other = (Poses(*(column[order[rows]] for column in self.poses)) for rows in (before, after))
        start, end = one.orientations, other.orientations
        # q and -q are the same orientation: take the nearer. Between two messages linear interpolation is close enough.
        end = np.where((start * end).sum(axis=1, keepdims=True) < 0, -1.0, 1.0) * end
        orientations = start + share * (end - start)
        orientations /= np.linalg.norm(orientations, axis=1, keepdims=True)
        return Poses(one.positions + share * (other.positions - one.positions), orientations)

    @cached_property
    def _by_time(self) -> tuple[Times, Times]:
        return _sorted(self.times_ns)

    @cached_property
    def _by_stamp(self) -> tuple[Times, Times]:
        return _sorted(self.stamps_ns)


class _Collected:
    """The transforms of a frame to its parent, collected one by one."""

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
        """The history of these transforms."""
        poses = np.array(self._poses).reshape(-1, 7)
        times, stamps = (np.array(column, np.int64) for column in (self._times, self._stamps))
        return TransformHistory(parent, times, stamps, Poses(poses[:, :3], poses[:, 3:]), self._static)


class FrameTree:
    """The tree of all coordinate frames of a recording.

    Odometry is added to the tree unless tf contains the same transform, so that robots without tf have poses too.

    Args:
        transforms: all of the recording, in any order.
    """

    odometry: tuple[str, str] | None
    """The parent and the child frame of the odometry that came first; None without odometry."""

    def __init__(self, transforms: Iterable[Transform]) -> None:
        by_tf: defaultdict[tuple[str, str], _Collected] = defaultdict(_Collected)
        by_odometry: defaultdict[tuple[str, str], _Collected] = defaultdict(_Collected)
        parents: dict[str, str] = {}
        for transform in transforms:
            (by_odometry if transform.odometry else by_tf)[transform.parent, transform.child].add(transform)
            if not transform.odometry:
                parents[transform.child] = transform.parent
        # If messages name different parents of a frame, the parent in the last message counts.
        self._histories = {child: by_tf[parent, child].history(parent) for child, parent in parents.items()}
        self.odometry = next(iter(by_odometry), None)
        if self.odometry:
            self._join(*self.odometry, by_odometry[self.odometry].history(self.odometry[0]))

    def chain(self, frame: str) -> list[str]:
        """The frame, its parent, the parent of that, up to the root."""
        chain = [frame]
        while (history := self._histories.get(chain[-1])) and history.parent not in chain:
            chain.append(history.parent)
        return chain

    def history(self, frame: str) -> TransformHistory | None:
        """The history of a frame; None if no message names its parent."""
        return self._histories.get(frame)

    def poses(self, frame: str, world: str, times_ns: Times, stamps_ns: Times) -> Poses:
        """The poses of a frame in one above it in its `chain`, at some log times and stamps, shape (N,) each."""
        chain = self.chain(frame)
        poses = Poses.identity(len(times_ns))
        for name in chain[: chain.index(world)]:
            poses = self._histories[name].at(times_ns, stamps_ns).of(poses)
        return poses

    def _join(self, world: str, base: str, odometry: TransformHistory) -> None:
        chain = self.chain(base)
        if world in chain:
            return
        # The child of odometry may have parents in tf: then their root moves in the world.
        below = self.poses(base, chain[-1], odometry.times_ns, odometry.stamps_ns)
        poses = odometry.poses.of(below.inverse())
        self._histories[chain[-1]] = TransformHistory(world, odometry.times_ns, odometry.stamps_ns, poses)


def _sorted(times: Times) -> tuple[Times, Times]:
    order = np.argsort(times, kind="stable")
    return times[order], order


def _rotated(orientations: Floats, positions: Floats) -> Floats:
    axis, real = orientations[:, :3], orientations[:, 3:]
    across = 2.0 * _cross(axis, positions)
    return np.asarray(positions + real * across + _cross(axis, across))


_AFTER, _BEFORE = np.array([1, 2, 0]), np.array([2, 0, 1])


def _cross(one: Floats, other: Floats) -> Floats:
    """Cross products, shape (N, 3). That of NumPy takes ten times as long for a few."""
    product: Floats = one[:, _AFTER] * other[:, _BEFORE] - one[:, _BEFORE] * other[:, _AFTER]
    return product


def _product(one: Floats, other: Floats) -> Floats:
    (a, b), (c, d) = ((part[:, :3], part[:, 3:]) for part in (one, other))
    axis = b * c + d * a + _cross(a, c)
    return np.hstack([axis, b * d - (a * c).sum(axis=1, keepdims=True)])
