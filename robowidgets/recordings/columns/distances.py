"""Distances of a sonar as columns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...samples import Range
from .series import Series


class Distances(Series[Range]):
    """The ranges of a sonar as columns; see `Series` for the ways to select from them.

    Examples:
        >>> front = recording.series("/sonar/front")  # doctest: +SKIP
        >>> np.nanmin(front.distances)  # doctest: +SKIP
    """

    @property
    def ranges(self) -> NDArray[np.float32]:
        """Metres as measured, shape (N,): -inf too close, +inf nothing in range, NaN no measurement (REP-117)."""
        return self._column("ranges", lambda sample: sample.range)

    @property
    def distances(self) -> NDArray[np.float32]:
        """Distances for programs in metres, shape (N,), as in `Range.distance`: 0 too close, inf nothing in range."""
        return self._column("distances", lambda sample: sample.distance)

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the times, and both columns as ``range`` and ``distance``."""
        return {**super().to_numpy(), "range": self.ranges, "distance": self.distances}

    def _column(self, name: str, number: Any) -> NDArray[np.float32]:
        def column(chunk: Any) -> NDArray[np.float32]:
            return np.array([[number(chunk.sample(row))] for row in range(len(chunk))], np.float32)

        return self._array(name, 1, np.float32, column)[:, 0]
