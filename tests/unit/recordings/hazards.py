"""A recording of bumps only, written for a test, by a robot that lists only touched sensors."""

from __future__ import annotations

from pathlib import Path

from . import recorded


def write(folder: Path, touched: dict[float, bool]) -> Path:
    """A recording of a Create 3 whose left bumper is listed, or not, at some times."""
    topic = "/hazard_detection"
    bump = {"header": {"frame_id": "bump_left"}, "type": 1}
    messages = [(at, topic, {"detections": [bump] if is_touched else []}) for at, is_touched in touched.items()]
    return recorded.write(folder, {topic: "irobot_create_msgs/msg/HazardDetectionVector"}, messages)
