"""The age of a sample."""

from __future__ import annotations

import time


class HasAge:
    """A sample that knows when it arrived. Not a field: two samples with the same content stay equal.

    A dataclass that has a `__post_init__` of its own calls `_arrive` in it.
    """

    _arrived: float
    """Seconds of the monotonic clock."""

    def __post_init__(self) -> None:
        self._arrive()

    @property
    def age(self) -> float:
        """Seconds since it arrived here, in this process; of a sample of a recording, since it was read.

        The clock is this computer's own and never set, so the age holds whatever the robot's clock says.
        """
        return time.monotonic() - self._arrived

    def _arrive(self, when: float | None = None) -> None:
        """Note that it arrived now, or at another time of the monotonic clock."""
        object.__setattr__(self, "_arrived", time.monotonic() if when is None else when)
