"""What came beside the pictures of a camera, and what lies over one of them by that."""

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
"""Scans of which the one nearest to a picture is looked for."""

FARTHEST_APART = 1.0
"""Seconds between a picture and what lies over it."""

BEAM = radians(15)
"""Of sonars that do not tell theirs."""


class PictureView(NamedTuple):
    """A picture, as far as an overlay needs to know it.

    Attributes:
        size: its width and height in pixels.
        frame_id: of the camera; empty: that of the calibration.
        stamp_ns: nanoseconds since the epoch, or None.
        time_ns: when it came.
        rectified: whether what is straight is straight in it.
    """

    size: tuple[int, int]
    frame_id: str
    stamp_ns: int | None
    time_ns: int
    rectified: bool


class OnScan(NamedTuple):
    """What the widgets beside the picture know of scans and ranges.

    Attributes:
        sectors: by name.
        forms: the shapes of a program, as the page reads them.
        offset: radians that are added to all angles.
        mounts: where a person says that sonars are on the robot, by name.
        mounted: makes a scan one with the angles of the robot, as those of the sectors and shapes are.
    """

    sectors: Mapping[str, Sector] = {}
    forms: Iterable[Mapping[str, Any]] = ()
    offset: float = 0.0
    mounts: Mapping[str, Pose] = {}
    mounted: Callable[[Scan], Scan] = lambda scan: scan


class BesidePictures:
    """The calibration of a camera, the scans and ranges of its robot, and where these sensors are.

    Attributes:
        info: the calibration; None before it came.
        frames: the frames of the robot.
        by_hand: the pose of the scanner in the frame of the camera, in place of tf.
        scans: the last ones, each with when it came in nanoseconds.
        ranges: the newest by the name of its sensor.
    """

    def __init__(self) -> None:
        self.info: CameraInfo | None = None
        self.frames: Frames = LiveFrames()
        self.by_hand: Poses | None = None
        self.scans: deque[tuple[Scan, int]] = deque(maxlen=KEPT)
        self.ranges: dict[str, tuple[Range, int]] = {}
        self._model: tuple[Any, CameraModel] | None = None

    def over(self, view: PictureView, drawn: OnScan = OnScan()) -> Overlay | None:  # noqa: B008  # it does not change
        """What lies over a picture, and why other things do not; None where nothing came that could."""
        if not self.scans and not self.ranges:
            return None
        if self.info is None:
            return Overlay(missing=("no camera_info: where readings are in the picture is not known",))
        try:
            model = self._model_of(self.info, view)
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
        """By sensor its range, and its pose in the frame of the camera; and why others have no pose."""
        placed: dict[str, tuple[Range, Poses]] = {}
        lost: list[str] = []
        robot = next((name for name in ROBOT if name in self.frames.chain(camera)), ROBOT[0])
        for name, (one, came) in self.ranges.items():
            mount = mounts.get(name) or one.pose
            if not (one.frame_id or mount):
                continue  # nobody says where it is
            try:
                # By tf, which knows how high it is.
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
        """The scan that was measured nearest to a picture, and by how many seconds it is younger."""
        by_stamp = view.stamp_ns is not None and all(scan.stamp_ns is not None for scan, _ in self.scans)

        def apart(one: tuple[Scan, int]) -> int:
            scan, came = one
            return (scan.stamp_ns or 0) - (view.stamp_ns or 0) if by_stamp else came - view.time_ns

        found = min(self.scans, key=lambda one: abs(apart(one)))
        return found, apart(found) / 1e9

    def _model_of(self, info: CameraInfo, view: PictureView) -> CameraModel:
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
"""Parts of a pixel that the page is told."""


def about_overlay(overlay: Overlay) -> dict[str, Any]:
    """An overlay as the page reads it: places in quarters of a pixel, distances in millimetres."""
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
    """Places in quarters of a pixel, without those on the one before."""
    fine = np.round(FINE * np.clip(places, -1e5, 1e5)).astype(int)
    keeps = np.ones(len(fine), bool)
    keeps[1:] = np.abs(np.diff(fine, axis=0)).max(axis=1) >= FINE // 2
    kept: list[int] = fine[keeps].ravel().tolist()
    return kept
