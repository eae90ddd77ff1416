"""Readings of other sensors over the pictures of a camera."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import traitlets

from ..camera import BesidePictures, OnScan, Overlay, PictureView, about_overlay, pose_by_hand
from ..kinds import info_of, kind_of_class, kind_of_message, sensor_of
from ..messages import to_camera_info, to_range, to_scan
from ..messages.fields import unwrap
from ..poses.live_frames import LiveFrames
from ..poses.transforms import STATIC, transforms_of
from ..samples import Image, Pose, Range
from ..samples.age import arrival_of
from ..widget.large_frames import LargeFrameWidget
from ..widget.traits import Flag

SCAN = "sensor_msgs/msg/LaserScan"
RANGE = "sensor_msgs/msg/Range"

_DRAWN = ("_sectors", "angle_offset", "_edition", "_robot")
"""Traits of a laser widget that change the overlay."""

_RECTIFIED = re.compile(r"rect|registered", re.IGNORECASE)


class HasOverlay(LargeFrameWidget[Image]):
    """An image widget that shows the readings of a laser and of sonars in its pictures."""

    frame_traits = ("rectified", "_edition")

    overlay = Flag(True, help="True to show readings over the picture.").tag(sync=True)
    rectified = traitlets.Bool(
        None, allow_none=True, help="True if the picture is rectified, or None to decide by the name of its topic."
    )
    _lasers = traitlets.List(traitlets.Unicode(), help="Titles of the laser widgets that are frozen with it.")

    def __init__(self, **kwargs: Any) -> None:
        self._beside = BesidePictures()
        self._scan_topic = ""
        """The topic of the scans from a feed or a player, or empty."""
        self._followed: list[Any] = []
        """The laser widgets whose sectors and shapes may be drawn over the pictures of a player."""
        self._camera_pose: tuple[Any, ...] | None = None
        camera_pose = kwargs.pop("camera_pose", None)
        super().__init__(**kwargs)
        self.camera_pose = camera_pose

    @property
    def beside(self) -> BesidePictures:
        """The calibration, scans and ranges that came with the pictures."""
        return self._beside

    @property
    def camera_pose(self) -> tuple[Any, ...] | None:
        """The pose of the camera in the frame of the scanner: x, y, z, roll, pitch, yaw, or None to use tf.

        Numbers are in metres, and in radians or text like "20deg", for a camera that looks along x; a pitch above 0
        looks down.

        Raises:
            TypeError: these are not six numbers. ValueError: one is not finite.
        """
        return self._camera_pose

    @camera_pose.setter
    def camera_pose(self, pose: Any) -> None:
        self._beside.by_hand = None if pose is None else pose_by_hand(pose)
        self._camera_pose = None if pose is None else tuple(pose)
        self._renew_frames()

    def calibrate(self, message: Any) -> None:
        """Take the calibration of the camera, a sensor_msgs/CameraInfo.

        Raises:
            TypeError: the message has another type. ValueError: its numbers are invalid.
        """
        self._beside.info = to_camera_info(message)

    def take_scan(self, message: Any) -> None:
        """Take a scan. The scan nearest to a picture by its stamp is drawn over that picture.

        Raises:
            TypeError: the message has another type. ValueError: its numbers cannot be shown. In a callback nothing is
                raised; the widget and the log show the error.
        """
        try:
            scan = to_scan(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
            return
        with self._newest.lock:
            self._beside.scans.append((scan, round(arrival_of(scan) * 1e9)))

    def take_range(self, sensor: str, message: Any) -> None:
        """Take a range of a sonar. The newest range of each is drawn over the picture. Raise errors as `take_scan`."""
        try:
            one = to_range(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
            return
        with self._newest.lock:
            self._beside.ranges[sensor] = one, round(arrival_of(one) * 1e9)

    def _take_beside(self, sensor: str, message: Any) -> None:
        """Take a Range of another topic; a touch sensor is ignored."""
        if kind_of_message(message, RANGE) is kind_of_class(Range):
            self.take_range(sensor, message)

    @property
    def seen(self) -> Overlay | None:
        """The overlay of the picture on show: ``seen.scan``, and ``seen.pixels`` with column and row of each reading.

        Column and row are NaN for a ray without a reading, or outside the picture. ``seen.missing`` has the reasons why
        something is not shown. None before a picture and readings came, and in the player of a recording, which sends
        the overlay only to the page.
        """
        image = self._sample_on_show()
        with self._newest.lock:
            return None if image is None else self._over(image, round(arrival_of(image) * 1e9), self._beside)

    @property
    def frame_topics(self) -> str:
        """See `TakesFrames` in `poses.live_frames`."""
        return "both" if self.overlay and not self.driven_by_player else ""

    def take_frames(self, message: Any) -> None:
        """Take a message of tf or of odometry."""
        self._take_frames(message, "")

    def take_static_frames(self, message: Any) -> None:
        """Take a message of static tf."""
        self._take_frames(message, STATIC)

    def _take_frames(self, message: Any, topic: str) -> None:
        inner, now = unwrap(message), round(time.monotonic() * 1e9)
        frames = self._beside.frames
        if not isinstance(frames, LiveFrames):
            return
        with self._newest.lock, suppress(ValueError):
            for one in transforms_of(inner, topic, now):
                frames.add(one)

    def topics_beside(self, topics: Mapping[str, str]) -> list[tuple[str, Callable[[Any], object]]]:
        """See `TakesTopics` in `poses.live_frames`: calibration, scans and ranges."""
        if not self.overlay or self.driven_by_player:
            return []
        found: list[tuple[str, Callable[[Any], object]]] = []
        near = info_of(str(self._source.get("topic") or self.title), topics)
        found += [(near, self.calibrate)] if near else []
        scans = sorted(name for name, kind in topics.items() if kind == SCAN)
        found += [(name, self.take_scan) for name in self.choose_scan(scans)]
        ranges = sorted(name for name, kind in topics.items() if kind == RANGE)
        found += [(name, partial(self._take_beside, sensor_of(name))) for name in ranges]
        return found

    def choose_scan(self, topics: Sequence[str]) -> list[str]:
        """Return the topic whose scans are drawn over the picture: of a laser widget in its group, else the first."""
        chosen = next((name for name in topics if name in self._lasers), next(iter(topics), ""))
        with self._newest.lock:
            if chosen != self._scan_topic:
                self._scan_topic = chosen
                self._beside.scans.clear()
        return [chosen] if chosen else []

    def on_group(self) -> None:
        """See `FreezableWidget`: in a player, pictures are sent again when their overlay changes."""
        super().on_group()
        lasers = self._lasers_in_group()
        self._lasers = [str(one.title) for one in lasers]
        if self.driven_by_player:
            for widget in self._followed:
                widget.unobserve(self._draw_anew, _DRAWN)
            for widget in lasers:
                widget.observe(self._draw_anew, _DRAWN)
            self._followed = lasers

    def _lasers_in_group(self) -> list[Any]:
        """Return the laser widgets in its group."""
        return [one for one in self._group if one.sample_name == "scan"]

    def _draw_anew(self, _change: Any) -> None:
        self._renew_frames()

    @property
    def _laser(self) -> Any:
        """The laser widget in its group with the scans that are drawn over the picture, or None."""
        lasers = self._lasers_in_group()
        return next((one for one in lasers if self._scan_topic in ("", one.title)), None)

    def _over_live(self, sample: Image) -> dict[str, Any]:
        """Return the overlay of a new picture for the page; empty in a player, which sends it itself."""
        return {} if self.driven_by_player else self.over_of(sample, round(arrival_of(sample) * 1e9))

    def over_of(self, sample: Image, time_ns: int, beside: BesidePictures | None = None) -> dict[str, Any]:
        """Return the overlay of a picture for the page.

        Args:
            sample: the picture.
            time_ns: the time of its arrival.
            beside: the readings to draw, or None for the readings of this widget if its overlay is on. A player passes
                its own readings and always gets the overlay, because the page may switch it on without Python.
        """
        if beside is None and not self.overlay:
            return {}
        overlay = self._over(sample, time_ns, beside or self._beside)
        if overlay is None:
            return {}
        laser = self._laser
        return {"over": {**about_overlay(overlay), **({} if laser is None else {"laser": laser.model_id})}}

    def _over(self, sample: Image, time_ns: int, beside: BesidePictures) -> Overlay | None:
        """Return the overlay of a picture, or None without readings."""
        rows, columns = sample.shape
        topic = str(self._source.get("topic") or self.title)
        rectified = bool(_RECTIFIED.search(topic)) if self.rectified is None else self.rectified
        laser = self._laser
        drawn = (
            OnScan()
            if laser is None
            else OnScan(dict(laser.sectors), laser.forms(), laser.angle_offset, mounted=laser.mounted)
        )
        for ring in [one for one in self._group if one.sample_name == "sonars"]:
            drawn = drawn._replace(mounts={**drawn.mounts, **{name: Pose(*at) for name, at in ring.poses.items()}})
        view = PictureView((columns, rows), sample.frame_id, sample.stamp_ns, time_ns, rectified)
        return beside.over(view, drawn)
