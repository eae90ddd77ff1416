"""Oddities in tf: a transform of two publishers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from ..poses.transforms import Transform
from ..recordings.times import has_date
from ..samples import Problem

_LEAST = 20
"""Poses of a frame that a judgement needs."""

_OFTEN = 0.1
"""Share of the poses that lie near an earlier one and far from the last: a single publisher has fewer."""

_APART, _NEARER = 0.02, 5.0
"""Metres, and how many times nearer: the noise of a single publisher is smaller."""

_ALIKE = 0.3
"""Share of a jump by which the next one differs at most: noise jumps by another distance each time."""

_BEFORE = 4
"""Earlier poses that are looked at."""


class TransformCheck:
    """The frames of a robot by tf.

    Args:
        transforms: all of the recording, in the order of time.
    """

    def __init__(self, transforms: Iterable[Transform]) -> None:
        self._places: defaultdict[str, list[tuple[float, ...]]] = defaultdict(list)
        self._parents: defaultdict[str, dict[str, int]] = defaultdict(dict)
        self.is_dated = False
        """True if a stamp that tf has is a date."""
        for one in transforms:
            self.is_dated = self.is_dated or (has_date(one.stamp_ns) and not one.static)
            if not one.odometry and not one.static:
                parents = self._parents[one.child]
                parents[one.parent] = parents.get(one.parent, 0) + 1
                self._places[one.child].append(one.pose[:3])

    def problems(self) -> Iterator[Problem]:
        """The frames that two nodes place."""
        for child, parents in self._parents.items():
            steady = [name for name, count in parents.items() if count >= _LEAST]
            if len(steady) > 1:
                yield Problem(
                    f"{child} has {len(steady)} parents in tf: {', '.join(steady)}",
                    "let one node alone publish where it is",
                )
                continue
            if apart := _alternates(np.array(self._places[child])):
                parent = max(parents, key=parents.__getitem__)
                yield Problem(
                    f"tf: two publishers of {parent}->{child}, {apart:.2f} m apart: it jumps between them",
                    "let one node publish it: publish_tf: false of the other",
                )


def _alternates(places: NDArray[np.float64]) -> float:
    """Return how far places lie from the one before, in metres, if they often lie near an earlier one; else 0.

    Turns do not count: a wheel turns by nearly a whole turn from one message to the next.
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
