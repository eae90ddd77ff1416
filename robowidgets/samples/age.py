"""The age of a sample."""

from __future__ import annotations

import time


class HasAge:
    """A sample that knows when it arrived. Not a field: two samples with the same content stay equal.

    A dataclass that has a `__post_init__` of its own calls `note_arrival` in it.
    """

    _arrived: float

    def __post_init__(self) -> None:
        note_arrival(self)

    @property
    def age(self) -> float:
        """Seconds since it arrived here, in this process; of a sample of a recording, since it was read.

        The clock is this computer's own and never set, so the age holds whatever the robot's clock says.
        """
        return time.monotonic() - self._arrived


def note_arrival(sample: HasAge, when: float | None = None) -> None:
    """Note that a sample arrived now, or at another time of the monotonic clock, in seconds."""
    object.__setattr__(sample, "_arrived", time.monotonic() if when is None else when)


def arrival_of(sample: HasAge) -> float:
    """Seconds of the monotonic clock at which a sample arrived."""
    return sample._arrived  # noqa: SLF001  # no field of a sample, and no attribute for users, who ask for its age
