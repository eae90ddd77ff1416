"""The limits of the motors for speed and acceleration."""

from __future__ import annotations

from dataclasses import dataclass, fields

from ..samples.checks import finite

BodyVelocity = tuple[float, float, float]
"""Forward in m/s, counter-clockwise in rad/s, and to the left in m/s."""


@dataclass(frozen=True)
class Motors:
    """The limits of a differential drive.

    Args:
        max_linear: m/s, forward and backward.
        max_angular: rad/s, both ways.
        linear_acceleration: m/s², speeding up and slowing down.
        angular_acceleration: rad/s², as above.
        max_lateral: m/s, both ways, for a base that drives sideways, with the acceleration of driving forward.

    Raises:
        TypeError: something is not a number.
        ValueError: a limit is not finite and above 0.
    """

    max_linear: float = 1.2
    max_angular: float = 2.0
    linear_acceleration: float = 1.0
    angular_acceleration: float = 4.0
    max_lateral: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = finite(field.name, getattr(self, field.name), "SI units")
            if value <= 0 and (field.name != "max_lateral" or value < 0):
                raise ValueError(f"{field.name}: expected a limit above 0, got {value!r}")

    def toward(self, speeds: BodyVelocity, command: BodyVelocity, dt: float) -> BodyVelocity:
        """Return the speeds after dt seconds of accelerating toward a command within the limits."""
        return (
            _approach(speeds[0], _clip(command[0], self.max_linear), self.linear_acceleration * dt),
            _approach(speeds[1], _clip(command[1], self.max_angular), self.angular_acceleration * dt),
            _approach(speeds[2], _clip(command[2], self.max_lateral), self.linear_acceleration * dt),
        )


def _clip(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _approach(value: float, target: float, most: float) -> float:
    return value + _clip(target - value, most)
