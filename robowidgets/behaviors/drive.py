"""The speed that a step of a program returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ..samples.checks import finite
from .lines import keep, number_text


@dataclass(frozen=True)
class Drive:
    """The speed of a robot that moves in the plane.

    Args:
        linear: forward, m/s.
        angular: counter-clockwise, rad/s.
        lateral: to the left, m/s, for a robot that can move sideways.

    Raises:
        TypeError: not a number. ValueError: NaN or infinite.

    Examples:
        >>> Drive(0.2)
        Drive(linear=0.2, angular=0.0)
        >>> Drive(lateral=-0.07)
        Drive(linear=0.0, angular=0.0, lateral=-0.07)
    """

    linear: float = 0.0
    angular: float = 0.0
    lateral: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        for name, unit in (("linear", "m/s"), ("angular", "rad/s"), ("lateral", "m/s")):
            object.__setattr__(self, name, finite(name, getattr(self, name), unit))

    def __repr__(self) -> str:
        sideways = f", lateral={self.lateral!r}" if self.lateral else ""
        return f"Drive(linear={self.linear!r}, angular={self.angular!r}{sideways})"


def _short_text(drive: Drive) -> str:
    """A speed as a program writes it."""
    linear, angular, lateral = (
        number_text(one).removesuffix(".0") for one in (drive.linear, drive.angular, drive.lateral)
    )
    sideways = f", lateral={lateral}" if drive.lateral else ""
    return f"Drive({linear}{f', {angular}' if drive.angular or sideways else ''}{sideways})"


keep(Drive, _short_text, is_result=True)  # as a value of a line

STANDSTILL = Drive()


class NoDriveError(TypeError):
    """A step returned neither a `Drive` nor None.

    Args:
        result: what it returned.
    """

    def __init__(self, result: Any) -> None:
        super().__init__(f"expected a step to return Drive(linear, angular), or None to keep the speed, got {result!r}")
        self.result = result


NoDriveError.__name__ = "TypeError"  # the name that users see


def drive_of(result: Any, before: Drive) -> Drive:
    """Return the speed that a step returned, or the previous speed for None."""
    if result is None:
        return before
    if not isinstance(result, Drive):
        raise NoDriveError(result)
    return result
