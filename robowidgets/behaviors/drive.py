"""The speed that a step of a program returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..samples.checks import finite


@dataclass(frozen=True)
class Drive:
    """A speed, for a robot that moves in the plane.

    Args:
        linear: forward, m/s.
        angular: counter-clockwise, rad/s.

    Raises:
        TypeError: no number. ValueError: NaN or infinite.

    Example:
        >>> Drive(0.2)
        Drive(linear=0.2, angular=0.0)
    """

    linear: float = 0.0
    angular: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("linear", "m/s"), ("angular", "rad/s")):
            object.__setattr__(self, name, finite(name, getattr(self, name), unit))


STANDSTILL = Drive()


def drive_of(result: Any, before: Drive) -> Drive:
    """The speed that a step returned; None keeps the one before."""
    if result is None:
        return before
    if not isinstance(result, Drive):
        raise TypeError(f"expected a step to return Drive(linear, angular), or None to keep the speed, got {result!r}")
    return result
