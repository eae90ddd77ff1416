"""The part of a scanner's pose on its robot on which its angles depend."""

from __future__ import annotations

from math import copysign, degrees, pi, radians
from typing import Any, NamedTuple

from .checks import ANGLE_ROUNDING, decimals, in_radians
from .problem import Problem

LEAST = radians(0.05)
"""A smaller turn is shown as 0.0° and counts as none."""

TOLD_TILT = radians(5)
"""A larger tilt is reported."""

MOST_TILT = radians(45)
"""With a larger tilt the rays have no angle on the floor: the angles stay those of the scanner."""


class Mount(NamedTuple):
    """How a scanner stands on its robot: an angle ``a`` of the scanner is ``yaw + a`` of the robot, or ``yaw - a``.

    The place of the scanner is not part of it: distances and angles are measured from the scanner.

    Attributes:
        yaw: radians by which the scanner's forward is turned from the robot's, counter-clockwise.
        upside_down: True if the scanner stands on its head, so that its angles run clockwise.
        by: where this is from: ``"tf"`` or ``"hand"``.
        tilt: radians between the plane of the scanner and the floor.
        turns: full turns by which the angles of a mounted scan are less, so that they stay within ±2 pi.

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
        """The mount that a user gives.

        Args:
            yaw: radians, or degrees as text (``"90deg"``).
            upside_down: True if the scanner stands on its head.

        Raises:
            TypeError: yaw is not an angle, or upside_down neither True nor False. ValueError: yaw is beyond ±2 pi.
        """
        if not isinstance(upside_down, bool):
            raise TypeError(f"upside_down: expected True or False, got {upside_down!r}")
        return cls(within_half_turn(in_radians("yaw", yaw)), upside_down, "hand")

    @property
    def turns_angles(self) -> bool:
        """True if angles of the robot differ from those of the scanner."""
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
        """The mount for a person: ``"turned 90.0° by tf"``, or an empty text if it turns nothing."""
        if not self.turns_angles:
            return ""
        turned = f"turned {degrees(within_half_turn(self.yaw)):.1f}°" if abs(self.yaw) >= LEAST else ""
        return f"{' and '.join(filter(None, ('upside down' * self.upside_down, turned)))} by {self.by}"

    def to_robot(self, angle: float) -> float:
        """An angle of the scanner as one of the robot, in radians."""
        return self.yaw - 2 * pi * self.turns + (-angle if self.upside_down else angle)

    def to_scanner(self, angle: float) -> float:
        """An angle of the robot as one of the scanner, in radians."""
        own = angle - (self.yaw - 2 * pi * self.turns)
        return -own if self.upside_down else own

    def wound(self, first: float, last: float) -> Mount:
        """The mount whose `turns` keep the angles of a sweep within ±2 pi.

        Args:
            first: the angle of the scanner's first ray, in radians.
            last: the angle of its last one.
        """
        plain = self._replace(turns=0)
        far = max(plain.to_robot(first), plain.to_robot(last), key=abs)
        return plain if abs(far) <= 2 * pi + ANGLE_ROUNDING else plain._replace(turns=int(copysign(1, far)))

    def to_json(self) -> dict[str, Any]:
        """The mount as the page reads it; ``Mount(**values)`` makes it again."""
        return {name: value for name, value in self._asdict().items() if value != self._field_defaults[name]}


def within_half_turn(angle: float) -> float:
    """The same direction within ±pi."""
    return (angle + pi) % (2 * pi) - pi if abs(angle) > pi + ANGLE_ROUNDING else angle
