"""The age of a sample."""

from __future__ import annotations

import time


class HasAge:
    """A sample that knows its time of arrival. This time is not a field, so samples with the same content are equal.

    A dataclass that defines `__post_init__` calls `note_arrival` in it.
    """

    _arrived: float

    def __post_init__(self) -> None:
        note_arrival(self)

    @property
    def age(self) -> float:
        """Seconds since the sample arrived in this process, or since it was read from a recording.

        The clock is this computer's monotonic clock, so the age does not depend on the robot's clock.
        """
        return time.monotonic() - self._arrived


def note_arrival(sample: HasAge, when: float | None = None) -> None:
    """Note that a sample arrived now, or at another time of the monotonic clock, in seconds."""
    object.__setattr__(sample, "_arrived", time.monotonic() if when is None else when)


def arrival_of(sample: HasAge) -> float:
    """Return the time of the monotonic clock in seconds at which a sample arrived."""
    return sample._arrived  # noqa: SLF001  # neither a field nor public: users read the age
