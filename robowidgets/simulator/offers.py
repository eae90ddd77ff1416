"""The topics of the simulated robot. The row of each kind of sensor makes its topics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from ..messages.standard import (
    CAMERA_INFO,
    IMAGE,
    TF,
    camera_info_fields,
    image_fields,
    transform_fields,
    turn_of,
)
from ..samples import Image
from .camera import SCANNER_UP
from .robot import Robot


class Offer(NamedTuple):
    """A topic of the simulated robot.

    Attributes:
        topic: its name.
        type: the type of its messages.
        read: returns the newest sample, or the same object as before if no newer sample exists.
        to_message: converts a sample to a message of the robot's model, or None to send the sample.
        obeyed: True if the robot obeys messages on this topic. Received messages are not sent again.
    """

    topic: str
    type: str
    read: Callable[[], Any]
    to_message: Callable[[Any], Any] | None = None
    obeyed: bool = False

    def message(self, sample: Any) -> Any:
        """Return the message to send for a sample."""
        return sample if self.to_message is None else self.to_message(sample)


MakeOffers = Callable[[Robot], Sequence[Offer]]
"""Returns the topics of a robot for one kind of sensor. It is also called in the process that simulates the robot."""


def cameras(robot: Robot) -> list[Offer]:
    """Return the topics of the camera: pictures, depth, calibration, and transforms of all sensors; or none."""
    camera = robot.camera
    if camera is None:
        return []

    def calibration(image: Image) -> dict[str, Any]:
        return camera_info_fields(camera.info, image.stamp_ns or 0)

    return [
        Offer("/camera/image_raw", IMAGE, robot.image, image_fields),
        Offer("/camera/depth/image_rect_raw", IMAGE, robot.depth_image, image_fields),
        Offer("/camera/camera_info", CAMERA_INFO, robot.image, calibration),
        Offer("/tf", TF, robot.image, partial(_transforms, robot)),
    ]


def _transforms(robot: Robot, image: Image) -> dict[str, Any]:
    """Return the transforms of the robot at the time of a picture, and of its sensors on the robot."""
    assert robot.camera is not None
    x, y, yaw = robot.odometry
    placed = {
        "base_link": ("odom", x, y, 0.0, yaw),
        robot.scanner.frame_id: ("base_link", *_raised(robot.scanner.mount, SCANNER_UP)),
        "camera_link": ("base_link", *_raised(robot.camera.mount, robot.camera.up)),
        **{f"sonar_{name}": ("base_link", *_raised(pose, SCANNER_UP)) for name, pose in robot.sonars.poses.items()},
    }
    stamp_ns = image.stamp_ns or 0
    hanging = {robot.scanner.frame_id} if robot.scanner.upside_down else set()
    upright = [
        transform_fields(parent, child, (x, y, z), turn_of(yaw, upside_down=child in hanging), stamp_ns)
        for child, (parent, x, y, z, yaw) in placed.items()
    ]
    # An optical frame looks along z, with x to the right and y down (REP-103).
    optical = transform_fields("camera_link", robot.camera.frame_id, (0.0, 0.0, 0.0), (-0.5, 0.5, -0.5, 0.5), stamp_ns)
    return {"transforms": [*upright, optical]}


def _raised(pose: tuple[float, float, float], up: float) -> tuple[float, float, float, float]:
    x, y, yaw = pose
    return x, y, up, yaw
