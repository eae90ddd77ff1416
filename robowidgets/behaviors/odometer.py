"""How far a robot has driven and turned, by its odometry."""

from __future__ import annotations

from math import hypot, isfinite, pi

from ..samples import Pose


class Odometer:
    """Adds up poses of odometry.

    Attributes:
        pose: the newest one; None before the first.
        driven: metres of the way, whichever way the robot looks.
        turned: radians, counter-clockwise; beyond a full turn, too.
    """

    def __init__(self) -> None:
        self.pose: Pose | None = None
        self.driven = self.turned = 0.0

    def add(self, pose: Pose) -> None:
        """Note the next pose; one that is no number is left out."""
        if not all(map(isfinite, pose)):
            return
        if self.pose is not None:
            self.driven += hypot(pose.x - self.pose.x, pose.y - self.pose.y)
            self.turned += (pose.yaw - self.pose.yaw + pi) % (2 * pi) - pi
        self.pose = pose

    def leave_out(self) -> None:
        """Count nothing from the newest pose to the next, which another topic may give."""
        self.pose = None
