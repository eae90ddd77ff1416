"""What other sensors measure, over the pictures of a camera."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import traitlets

from .._core.large_frames import LargeFrameWidget
from .._core.traits import Flag
from ..camera import BesidePictures, OnScan, PictureView, about_overlay, pose_by_hand
from ..kinds import namespace_of
from ..messages import to_camera_info, to_range, to_scan
from ..messages.fields import get, unwrap
from ..poses.live_frames import LiveFrames
from ..poses.transforms import transforms_in, transforms_of
from ..samples import Image
from ..samples.age import arrival_of

CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
SCAN = "sensor_msgs/msg/LaserScan"
RANGE = "sensor_msgs/msg/Range"

_RECTIFIED = re.compile(r"rect|registered", re.IGNORECASE)


class HasOverlay(LargeFrameWidget[Image]):
    """An image widget that shows where the readings of a laser and of sonars are in its pictures."""

    overlay = Flag(True, help="Whether readings lie over the picture.").tag(sync=True)
    rectified = traitlets.Bool(
        None, allow_none=True, help="Whether what is straight is so in the picture; None: by the name of its topic."
    )

    def __init__(self, **kwargs: Any) -> None:
        self._beside = BesidePictures()
        self._camera_pose: tuple[Any, ...] | None = None
        camera_pose = kwargs.pop("camera_pose", None)
        super().__init__(**kwargs)
        self.camera_pose = camera_pose

    @property
    def beside(self) -> BesidePictures:
        """What came beside the pictures."""
        return self._beside

    @property
    def camera_pose(self) -> tuple[Any, ...] | None:
        """Where the camera is in the frame of the scanner, in place of tf: x, y, z, roll, pitch, yaw; None: by tf.

        In metres, and radians or text like "20deg", of a camera that looks along x; a pitch above 0 looks down.

        Raises:
            TypeError: not six numbers. ValueError: one is not finite.
        """
        return self._camera_pose

    @camera_pose.setter
    def camera_pose(self, pose: Any) -> None:
        self._beside.by_hand = None if pose is None else pose_by_hand(pose)
        self._camera_pose = None if pose is None else tuple(pose)

    def calibrate(self, message: Any) -> None:
        """Take the calibration of the camera, a sensor_msgs/CameraInfo.

        Raises:
            TypeError: no such message. ValueError: its numbers cannot be.
        """
        self._beside.info = to_camera_info(message)

    def take_scan(self, message: Any) -> None:
        """Take a scan, of which the one nearest to a picture by its stamp lies over that.

        Raises:
            TypeError: no such message. ValueError: its numbers cannot be shown. In a callback nothing is raised.
        """
        try:
            scan = to_scan(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
            return
        with self._newest.lock:
            self._beside.scans.append((scan, round(arrival_of(scan) * 1e9)))

    def take_range(self, sensor: str, message: Any) -> None:
        """Take what a sonar measured; the newest of each lies over the picture. Raises as `take_scan`."""
        try:
            one = to_range(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
            return
        with self._newest.lock:
            self._beside.ranges[sensor] = one, round(arrival_of(one) * 1e9)

    @property
    def frame_topics(self) -> str:
        """See `TakesFrames` in `poses.live_frames`."""
        return "both" if self.overlay and not self.driven_by_player else ""

    def take_frames(self, message: Any) -> None:
        """Take a message of tf or of odometry."""
        inner, now = unwrap(message), round(time.monotonic() * 1e9)
        frames = self._beside.frames
        if not isinstance(frames, LiveFrames):
            return
        with self._newest.lock, suppress(TypeError, ValueError, AttributeError):
            is_tf = get(inner, "transforms", None) is not None
            for one in transforms_in(inner, False, now) if is_tf else transforms_of(inner, "", now):
                frames.add(one)

    def topics_beside(self, topics: Mapping[str, str]) -> list[tuple[str, Callable[[Any], object]]]:
        """The topics of a robot that it needs beside its pictures, and what takes their messages.

        Args:
            topics: the type of each topic.
        """
        if not self.overlay or self.driven_by_player:
            return []
        found: list[tuple[str, Callable[[Any], object]]] = []
        near = info_of(str(self._source.get("topic") or self.title), topics)
        found += [(near, self.calibrate)] if near else []
        scans = sorted(name for name, kind in topics.items() if kind == SCAN)
        found += [(name, self.take_scan) for name in scans[:1]]
        return found

    def _over_live(self, sample: Image) -> dict[str, Any]:
        """What the page is told of a picture that came; a player tells it itself."""
        return {} if self.driven_by_player else self.over_of(sample, round(arrival_of(sample) * 1e9))

    def over_of(self, sample: Image, time_ns: int) -> dict[str, Any]:
        """What the page is told of what lies over a picture."""
        if not self.overlay:
            return {}
        rows, columns = sample.shape
        topic = str(self._source.get("topic") or self.title)
        rectified = bool(_RECTIFIED.search(topic)) if self.rectified is None else self.rectified
        laser = next((one for one in self._group if one.sample_name == "scan"), None)
        drawn = OnScan() if laser is None else OnScan(dict(laser.sectors), laser.forms(), laser.angle_offset)
        view = PictureView((columns, rows), sample.frame_id, sample.stamp_ns, time_ns, rectified)
        overlay = self._beside.over(view, drawn)
        if overlay is None:
            return {}
        told = about_overlay(overlay)
        return {"over": {**told, **({} if laser is None else {"laser": laser.model_id})}}


def info_of(topic: str, topics: Mapping[str, str]) -> str:
    """The topic with the calibration of a camera, beside that of its pictures; empty without one."""
    space = namespace_of(topic)
    # "/camera/image_raw/compressed" has another part.
    near = [name for name, kind in topics.items() if kind == CAMERA_INFO]
    return next((name for beside in (space, namespace_of(space)) for name in near if namespace_of(name) == beside), "")
