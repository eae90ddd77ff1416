"""Runs of a robot through one corridor, written for a test: to the wall at its end, and back."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

from robowidgets.samples import Pose

from . import recorded, sweeps
from .recorded import START_NS, stamped

WALL = 5.0
"""Metres from the start."""
BACK = 5.0
"""Time at which the first run turns back, in seconds."""


def write(folder: Path, speed: float = 0.8, origin: Pose | None = None, odometry: bool = True) -> Path:
    """Ten seconds at 10 Hz: 5 s forth and 5 s back; all readings are the distance from the wall, or from the start.

    Args:
        folder: is made, with an MCAP file in it.
        speed: in m/s; at 0.4 m/s or less it drives forth all the time.
        origin: start of its odometry in the corridor, or None for the start of the corridor.
        odometry: True to write odometry.
    """
    messages = []
    ox, oy, turn = origin or Pose(0.0, 0.0, 0.0)
    for i in range(101):
        seconds = i / 10
        is_back = speed > 0.4 and seconds > BACK
        x = speed * (2 * BACK - seconds if is_back else seconds)
        yaw = (pi if is_back else 0.0) - turn
        own = cos(turn) * (x - ox) - sin(turn) * oy, -sin(turn) * (x - ox) - cos(turn) * oy
        pose = {
            "position": dict(zip("xy", own, strict=True)),
            "orientation": {"z": sin(yaw / 2), "w": cos(yaw / 2)},
        }
        header = stamped(START_NS + i * 10**8, "odom")
        if odometry:
            messages.append((seconds, "/odom", {"header": header, "pose": {"pose": pose}}))
        scan = sweeps.scan(START_NS + i * 10**8, [x if is_back else WALL - x] * 11)
        messages.append((seconds, "/scan", scan))
    types = {"/scan": sweeps.TYPE, **({"/odom": "nav_msgs/msg/Odometry"} if odometry else {})}
    return recorded.write(folder, types, messages)
