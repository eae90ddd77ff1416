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

    def add(self, pose: Pose) -> None:
        """Add the next pose. A pose that is not finite is ignored."""
        if not all(map(isfinite, pose)):
            return
        if self.pose is not None:
            self.driven += hypot(pose.x - self.pose.x, pose.y - self.pose.y)
            self.turned += (pose.yaw - self.pose.yaw + pi) % (2 * pi) - pi
        self.pose = pose

    def leave_out(self) -> None:
        """Ignore the movement from the newest pose to the next pose, which may come from another topic."""
        self.pose = None
