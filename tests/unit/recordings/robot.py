"""A small recording of a robot, written for a test: scans, speeds, commands, bumps, and topics that no widget shows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import recorded
from .recorded import START_NS, stamped

SECONDS = 10

_TYPES = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/odom": "nav_msgs/msg/Odometry",
    "/cmd_vel": "geometry_msgs/msg/Twist",
    "/bumper": "kobuki_ros_interfaces/msg/BumperEvent",
    "/log": "std_msgs/msg/String",
}
_AT_ORIGIN = {"pose": {"orientation": {"w": 1.0}}}


def write(
    folder: Path,
    bad_scan_at: int | None = None,
    silence: int = 0,
    robots: Sequence[str] = ("",),
    climb: float = 0.0,
    second_frame: str = "base_link",
) -> Path:
    """Ten seconds at 10 Hz: scan i has the one range 1 + i / 100, speed and command are i / 100.

    Commands begin at 5 s. The left bumper is pressed at 2 and 6 s, and released at 3 and 7 s.

    Args:
        folder: is made, with an MCAP file in it.
        bad_scan_at: number of a scan whose limits are the wrong way round.
        silence: seconds without a message in the middle.
        robots: namespaces, each with all the topics.
        climb: speed upwards of the last command.
        second_frame: frame of the speeds in the second half.
    """
    messages: list[tuple[float, str, dict[str, Any]]] = []
    for i in range(10 * SECONDS):
        at = i / 10 + (i >= 5 * SECONDS) * silence
        header = stamped(START_NS + round(at * 1e9), "laser")
        frame = "base_link" if i < 50 else second_frame
        messages.append((at, "/scan", _scan(header, 1 + i / 100, swapped=i == bad_scan_at)))
        twist = {"linear": {"x": i / 100}}
        messages.append(
            (at, "/odom", {"header": header, "child_frame_id": frame, "pose": _AT_ORIGIN, "twist": {"twist": twist}})
        )
        if i >= 50:
            up = climb if i == 10 * SECONDS - 1 else 0.0
            messages.append((at, "/cmd_vel", {"linear": {"x": i / 100, "z": up}}))
        if i in (20, 30, 60, 70):
            messages.append((at, "/bumper", {"state": int(i in (20, 60))}))
    messages.append((SECONDS + silence, "/log", {"data": "done"}))
    types = {robot + topic: name for robot in robots for topic, name in _TYPES.items()}
    of_all = ((at, robot + topic, fields) for at, topic, fields in messages for robot in robots)
    return recorded.write(folder, types, of_all)


def _scan(header: dict[str, Any], distance: float, swapped: bool) -> dict[str, Any]:
    low, high = (30.0, 0.1) if swapped else (0.1, 30.0)
    limits = {"range_min": low, "range_max": high}
    return {"header": header, "angle_increment": 0.1, **limits, "ranges": [distance]}
