"""Calibration, scans and ranges for the pictures of a camera, and the overlay of a picture."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from math import radians
from typing import Any, NamedTuple

import numpy as np

from ..messages.standard import turn_of
from ..poses.frame_tree import Poses
from ..poses.live_frames import Frames, LiveFrames, are_joined
from ..poses.mounts import ROBOT, scanner_mount
from ..samples import CameraInfo, Mount, Pose, Range, Scan, Sector
from .model import CameraModel
from .overlay import Overlay, ScanOnPicture, Seen, cones
from .place import NoTransformError, ground_frame, place_in_camera

KEPT = 100
"""Scans to keep, among which the scan nearest to a picture is chosen."""

FARTHEST_APART = 1.0
"""The most seconds between a picture and the scan over it."""

BEAM = radians(15)
"""Radians. The opening angle of sonars that do not report it."""


class PictureView(NamedTuple):
    """The data of a picture that an overlay needs.

    Attributes:
        size: its width and height in pixels.
        frame_id: the frame of the camera, or empty for the frame of the calibration.
        stamp_ns: nanoseconds since the epoch, or None.
        time_ns: its time of arrival.
        rectified: True if straight lines are straight in it.
    """

    size: tuple[int, int]
    frame_id: str
    stamp_ns: int | None
    time_ns: int
    rectified: bool


class OnScan(NamedTuple):
    """The settings of laser and sonar widgets in the group of the picture, for scans and ranges.

    Attributes:
        sectors: sectors by name.
        forms: the shapes of a program, as sent to the page.
        offset: radians to add to all angles.
        mounts: poses of sonars on the robot that the user gives, by name.
        mounted: returns a scan with the robot's angles, which sectors and shapes have too.
    """

    sectors: Mapping[str, Sector] = {}
    forms: Iterable[Mapping[str, Any]] = ()
    offset: float = 0.0
    mounts: Mapping[str, Pose] = {}
    mounted: Callable[[Scan], Scan] = lambda scan: scan


class BesidePictures:
    """The calibration of a camera, the scans and ranges of its robot, and the poses of these sensors.

    Attributes:
        info: the calibration, or None before it came.
        frames: the frames of the robot.
        by_hand: the pose of the scanner in the frame of the camera, or None to use tf.
        scans: the last scans, each with its time of arrival in nanoseconds.
        ranges: the newest range by sensor name, with its time of arrival in nanoseconds.
    """

    def __init__(self) -> None:
        self.info: CameraInfo | None = None
        self.frames: Frames = LiveFrames()
        self.by_hand: Poses | None = None
        self.scans: deque[tuple[Scan, int]] = deque(maxlen=KEPT)
        self.ranges: dict[str, tuple[Range, int]] = {}
        self._model: tuple[Any, CameraModel] | None = None

    def over(self, view: PictureView, drawn: OnScan = OnScan()) -> Overlay | None:  # noqa: B008  # immutable
        """Return the overlay of a picture, with reasons for missing parts, or None if no scans and ranges came."""
        if not self.scans and not self.ranges:
            return None
        if self.info is None:
            return Overlay(missing=("no camera_info: the place of readings in the picture is unknown",))
        try:
            model = self._get_model(self.info, view)
        except ValueError as error:
            return Overlay(missing=(str(error),))
        camera = view.frame_id.lstrip("/") or self.info.frame_id
        missing: list[str] = []
        seen: list[Seen] = []
        scan, apart, pixels = None, None, np.empty((0, 2))
        if self.scans:
            (scan, came), apart = self._nearest(view)
            if apart is not None and abs(apart) > FARTHEST_APART:
                missing.append(f"no scan within {FARTHEST_APART:g} s of the picture: the nearest is {_apart(apart)}")
                scan = None
        if scan is not None:
            try:
                scan = self._mounted(drawn.mounted(scan), came).turned(drawn.offset)
                on_picture = self._scan(model, scan, came, camera, view)
                pixels = on_picture.pixels()
                seen += [on_picture.area(), *on_picture.sectors(drawn.sectors), *on_picture.shapes(drawn.forms)]
            except NoTransformError as error:
                missing.append(str(error))
                scan = None
        placed, lost = self._placed(camera, view, drawn.mounts)
        if lost:
            missing.append(f"{lost[0]} and {len(lost) - 1} more" if len(lost) > 1 else lost[0])
        seen += cones(model, placed, BEAM)
        return Overlay(scan, pixels, tuple(seen), tuple(dict.fromkeys(missing)), apart)

    def _placed(
        self, camera: str, view: PictureView, mounts: Mapping[str, Pose]
    ) -> tuple[dict[str, tuple[Range, Poses]], list[str]]:
        """Return range and pose in the frame of the camera by sensor, and reasons why other sensors have no pose."""
        placed: dict[str, tuple[Range, Poses]] = {}
        lost: list[str] = []
        robot = next((name for name in ROBOT if name in self.frames.chain(camera)), ROBOT[0])
        for name, (one, came) in self.ranges.items():
            mount = mounts.get(name) or one.pose
            if not (one.frame_id or mount):
                continue  # its pose is unknown
            try:
                # Prefer tf, which has the height of the sensor.
                if mount and not are_joined(self.frames, one.frame_id.lstrip("/"), camera):
                    placed[name] = one, self._at(robot, came, one.stamp_ns, camera, view).of(_flat_pose(mount))
                else:
                    placed[name] = one, self._at(one.frame_id, came, one.stamp_ns, camera, view)
            except NoTransformError as error:
                lost.append(str(error))
        return placed, lost

    def _scan(self, model: CameraModel, scan: Scan, came: int, camera: str, view: PictureView) -> ScanOnPicture:
        mount = scan.mount or Mount()
        turn = turn_of(mount.yaw, upside_down=mount.upside_down)
        axes = Poses(np.zeros((1, 3)), np.array([turn])).inverse()
        if self.by_hand is not None:
            return ScanOnPicture(model, self.by_hand.of(axes), scan)
        frame = scan.frame_id.lstrip("/")
        at = self._at(frame, came, scan.stamp_ns, camera, view).of(axes)
        ground = ground_frame(self.frames, frame)
        below = self._at(ground, came, scan.stamp_ns, camera, view) if ground else None
        return ScanOnPicture(model, at, scan, below)

    def _mounted(self, scan: Scan, came: int) -> Scan:
        if scan.mount is not None:
            return scan
        mount = scanner_mount(self.frames, scan.frame_id, came, scan.stamp_ns)
        return scan if mount is None else scan.mounted(mount)

    def _at(self, frame: str, came: int, stamp_ns: int | None, camera: str, view: PictureView) -> Poses:
        then = view.time_ns, view.stamp_ns
        return place_in_camera(self.frames, frame.lstrip("/"), camera, when=(came, stamp_ns), then=then)

    def _nearest(self, view: PictureView) -> tuple[tuple[Scan, int], float]:
        """Return the scan nearest to a picture in time, and the seconds by which it is younger than the picture."""
        by_stamp = view.stamp_ns is not None and all(scan.stamp_ns is not None for scan, _ in self.scans)

        def apart(one: tuple[Scan, int]) -> int:
            scan, came = one
            return (scan.stamp_ns or 0) - (view.stamp_ns or 0) if by_stamp else came - view.time_ns

        found = min(self.scans, key=lambda one: abs(apart(one)))
        return found, apart(found) / 1e9

    def _get_model(self, info: CameraInfo, view: PictureView) -> CameraModel:
        key = info.k.tobytes(), info.d.tobytes(), info.p.tobytes(), info.roi, info.binning, view.size, view.rectified
        if self._model is None or self._model[0] != key:
            self._model = key, CameraModel(info, rectified=view.rectified, size=view.size)
        return self._model[1]


def _flat_pose(pose: Pose) -> Poses:
    x, y, yaw = pose
    return Poses(np.array([[x, y, 0.0]]), np.array([[0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)]]))


def _apart(seconds: float) -> str:
    return f"{abs(seconds):.1f} s {'younger' if seconds > 0 else 'older'}"


FINE = 4
"""Steps per pixel in the places for the page."""


def about_overlay(overlay: Overlay) -> dict[str, Any]:
    """Return an overlay for the page: places in quarters of a pixel, distances in millimetres."""
    about: dict[str, Any] = {"missing": list(overlay.missing)} if overlay.missing else {}
    if overlay.apart is not None:
        about["apart"] = round(overlay.apart, 3)
    scan = overlay.scan
    if scan is not None:
        rays = np.flatnonzero(np.isfinite(overlay.pixels).all(axis=1))
        far = np.round(1000 * scan.ranges[rays].astype(np.float64))
        columns = (rays, *np.round(FINE * overlay.pixels[rays]).T, far)
        about["dots"] = np.column_stack(columns).astype(int).ravel().tolist()
        about |= {"angle_min": scan.angle_min, "angle_increment": scan.angle_increment}
    about["drawn"] = [
        {
            "kind": one.kind,
            "name": one.name,
            "pieces": [piece for places in one.pieces if (piece := _thinned(places))],
            **({"words": one.words} if one.words else {}),
            **({"color": one.color} if one.color else {}),
            **({"dashed": True} if one.dashed else {}),
        }
        for one in overlay.drawn
        if any(len(piece) for piece in one.pieces)
    ]
    return about


def _thinned(places: Any) -> list[int]:
    """Return places in quarters of a pixel, without places that repeat the one before."""
    fine = np.round(FINE * np.clip(places, -1e5, 1e5)).astype(int)
    keeps = np.ones(len(fine), bool)
    keeps[1:] = np.abs(np.diff(fine, axis=0)).max(axis=1) >= FINE // 2
    kept: list[int] = fine[keeps].ravel().tolist()
    return kept
