"""Problems of tf: a transform with two publishers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from ...poses.transforms import Transform
from ...samples import Problem
from ..times import has_date

_LEAST = 20
"""The minimum number of poses of a frame for a judgement."""

_OFTEN = 0.1
"""The share of the poses that lie near an earlier one and far from the last: a single publisher has fewer."""

_APART, _NEARER = 0.02, 5.0
"""Metres, and a factor of nearness: the noise of a single publisher is smaller."""

_ALIKE = 0.3
"""The maximum difference of successive jumps as a share of a jump: noise jumps by another distance each time."""

_BEFORE = 4
"""The number of earlier poses that are compared."""


class TransformCheck:
    """A check of the frames of a robot in tf.

    Args:
        transforms: all transforms of the recording, in the order of time.
    """

    def __init__(self, transforms: Iterable[Transform]) -> None:
        self._places: defaultdict[str, list[tuple[float, ...]]] = defaultdict(list)
        self._parents: defaultdict[str, dict[str, int]] = defaultdict(dict)
        self.is_dated = False
        """True if a stamp of tf is a date."""
        for one in transforms:
            self.is_dated = self.is_dated or (has_date(one.stamp_ns) and not one.static)
            if not one.odometry and not one.static:
                parents = self._parents[one.child]
                parents[one.parent] = parents.get(one.parent, 0) + 1
                self._places[one.child].append(one.pose[:3])

    def problems(self) -> Iterator[Problem]:
        """Yield the problems of frames with two publishers."""
        for child, parents in self._parents.items():
            steady = [name for name, count in parents.items() if count >= _LEAST]
            if len(steady) > 1:
                yield Problem(
                    f"{child} has {len(steady)} parents in tf: {', '.join(steady)}",
                    "let only one node publish its transform",
                )
                continue
            if apart := _alternates(np.array(self._places[child])):
                parent = max(parents, key=parents.__getitem__)
                yield Problem(
                    f"tf: two publishers of {parent}->{child}, {apart:.2f} m apart: it jumps between them",
                    "let one node publish it: set publish_tf: false in the other",
                )


def _alternates(places: NDArray[np.float64]) -> float:
    """Return the distance in metres between the places of two publishers, or 0 if the places do not alternate.

    The places alternate if they often lie near an earlier place and far from the last one. Turns do not count: a wheel
    may turn nearly once from one message to the next.
    """
    if len(places) < _LEAST:
        return 0.0
    now = places[_BEFORE:]
    away = [np.linalg.norm(now - places[_BEFORE - k : len(places) - k], axis=1) for k in range(1, _BEFORE + 1)]
    last, earlier = away[0], np.min(away[1:], axis=0)
    is_off = last > _NEARER * earlier + _APART
    if is_off.mean() <= _OFTEN:
        return 0.0
    jumps = last[is_off]
    apart = float(np.median(jumps))
    return apart if np.median(np.abs(np.diff(jumps))) < _ALIKE * apart else 0.0
