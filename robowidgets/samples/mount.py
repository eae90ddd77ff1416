"""The mount of a scanner: the part of its pose on the robot that changes its angles."""

from __future__ import annotations

from math import copysign, degrees, pi, radians
from typing import Any, NamedTuple

from .checks import ANGLE_ROUNDING, decimals, in_radians
from .problem import Problem

LEAST = radians(0.05)
"""Radians. A smaller turn is shown as 0.0° and ignored."""

TOLD_TILT = radians(5)
"""Radians. A larger tilt is reported."""

MOST_TILT = radians(45)
"""Radians. With a larger tilt the rays have no angle on the floor: the scanner's angles are kept."""


class Mount(NamedTuple):
    """The mount of a scanner: its angle ``a`` is ``yaw + a`` on the robot, or ``yaw - a`` if it is upside down.

    The position of the scanner is not part of it: distances and angles are measured from the scanner.

    Attributes:
        yaw: radians from the robot's forward direction to the scanner's, counter-clockwise.
        upside_down: True if the scanner is upside down, so that its angles run clockwise.
        by: the origin of the mount: ``"tf"`` or ``"hand"``.
        tilt: radians between the plane of the scanner and the floor.
        turns: full turns subtracted from the angles of a mounted scan, so that they stay within ±2 pi.

    Examples:
        >>> Mount(radians(90)).words
        'turned 90.0° by tf'
        >>> round(degrees(Mount(radians(90), upside_down=True).to_robot(radians(30))), 1)
        60.0
    """

    yaw: float = 0.0
    upside_down: bool = False
    by: str = "tf"
    tilt: float = 0.0
    turns: int = 0

    @classmethod
    def by_hand(cls, yaw: float | str = 0.0, *, upside_down: bool = False) -> Mount:
        """Return the mount that a user gives.

        Args:
            yaw: radians, or degrees as text (``"90deg"``).
            upside_down: True if the scanner is upside down.

        Raises:
            TypeError: yaw is not an angle, or upside_down neither True nor False. ValueError: yaw is beyond ±2 pi.
        """
        if not isinstance(upside_down, bool):
            raise TypeError(f"upside_down: expected True or False, got {upside_down!r}")
        return cls(within_half_turn(in_radians("yaw", yaw)), upside_down, "hand")

    @property
    def turns_angles(self) -> bool:
        """True if the robot's angles differ from the scanner's."""
        return self.upside_down or abs(self.yaw) >= LEAST

    @property
    def problems(self) -> tuple[Problem, ...]:
        """The problem of a tilted scanner, or none."""
        if self.tilt <= TOLD_TILT:
            return ()
        angles = "its own angles are shown" if self.tilt > MOST_TILT else "distances are along its rays"
        return (
            Problem(
                f"the scanner is tilted by {decimals(degrees(self.tilt), 1)}° by {self.by}: {angles}, not on the floor",
                "a map or a cloud shows where its rays go; if it is not tilted, correct tf",
            ),
        )

    @property
    def words(self) -> str:
        """The mount as text: ``"turned 90.0° by tf"``, or empty if it turns nothing."""
        if not self.turns_angles:
            return ""
        turned = f"turned {degrees(within_half_turn(self.yaw)):.1f}°" if abs(self.yaw) >= LEAST else ""
        return f"{' and '.join(filter(None, ('upside down' * self.upside_down, turned)))} by {self.by}"

    def to_robot(self, angle: float) -> float:
        """Return an angle of the scanner as an angle of the robot, in radians."""
        return self.yaw - 2 * pi * self.turns + (-angle if self.upside_down else angle)

    def to_scanner(self, angle: float) -> float:
        """Return an angle of the robot as an angle of the scanner, in radians."""
        own = angle - (self.yaw - 2 * pi * self.turns)
        return -own if self.upside_down else own

    def wound(self, first: float, last: float) -> Mount:
        """Return the mount with `turns` that keep the angles of a sweep within ±2 pi.

        Args:
            first: the angle of the scanner's first ray, in radians.
            last: the angle of its last ray.
        """
        plain = self._replace(turns=0)
        far = max(plain.to_robot(first), plain.to_robot(last), key=abs)
        return plain if abs(far) <= 2 * pi + ANGLE_ROUNDING else plain._replace(turns=int(copysign(1, far)))

    def to_json(self) -> dict[str, Any]:
        """Return the values for the page; ``Mount(**values)`` restores the mount."""
        return {name: value for name, value in self._asdict().items() if value != self._field_defaults[name]}


def within_half_turn(angle: float) -> float:
    """Return the same direction within ±pi."""
    return (angle + pi) % (2 * pi) - pi if abs(angle) > pi + ANGLE_ROUNDING else angle
