"""The distance and the angle that a robot has driven and turned, from its odometry."""

from __future__ import annotations

from math import hypot, isfinite, pi

from ..samples import Pose


class Odometer:
    """A sum of the movements between poses of odometry.

    Attributes:
        pose: the newest pose, or None before the first.
        driven: the length of the path in metres, also for driving backward or sideways.
        turned: radians, counter-clockwise; may exceed a full turn.
    """

    def __init__(self) -> None:
        self.pose: Pose | None = None
        self.driven = self.turned = 0.0
        self._put_to: Pose | None = None
        """The pose to which odometry was set, until a pose near it comes; else None."""

    def add(self, pose: Pose) -> None:
        """Add the next pose. A pose that is not finite is ignored."""
        if not all(map(isfinite, pose)):
            return
        if self.pose is not None:
            driven, turned = _movement(self.pose, pose)
            if self._put_to is not None and hypot(*_movement(self._put_to, pose)) <= hypot(driven, turned):
                self._put_to = None
            else:
                self.driven, self.turned = self.driven + driven, self.turned + turned
        self.pose = pose

    def put_to(self, pose: Pose) -> None:
        """Ignore the movement to a pose to which odometry was set. Poses from before may still come."""
        self._put_to = pose

    def leave_out(self) -> None:
        """Ignore the movement from the newest pose to the next pose, which may come from another topic."""
        self.pose = self._put_to = None


def _movement(before: Pose, after: Pose) -> tuple[float, float]:
    """Return the metres and the radians between two poses."""
    turned = (after.yaw - before.yaw + pi) % (2 * pi) - pi
    return hypot(after.x - before.x, after.y - before.y), turned
