"""Conversion of messages with a place on a map."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, nan, radians
from typing import Any

import numpy as np

from ..samples import MapGrid, Pose, Range, Scan, Speed, Validity, yaw_of
from ..samples.map_item import NO_FIX, NOWHERE, MapItem, Scatter
from .fields import describe, frame_id, get, has, stamp_ns, unwrap
from .map_grid import is_map_grid, to_map_grid
from .pose import pose_of
from .range import to_range
from .scan import to_scan

TAKEN = (
    "nav_msgs/Odometry, Path or OccupancyGrid, geometry_msgs/Pose, PoseStamped, PoseWithCovarianceStamped, PoseArray, "
    "Pose2D, PointStamped or TransformStamped, nav2_msgs/Costmap, sensor_msgs/NavSatFix, LaserScan or Range, "
    "gps_msgs/GPSFix, turtlesim/Pose"
)

_BEAM, _THIN, _TURN = radians(15), radians(3), radians(4)
"""Default opening angles of a sonar and of an infrared sensor, and the angle of a straight piece of their arcs."""

_NO_FIX = -1
"""The status of a receiver without a fix (sensor_msgs/NavSatStatus)."""


def to_map_item(message: Any) -> MapItem:
    """Return the item of a map for a message.

    Args:
        message: an object or a dictionary of one of the types in `TAKEN`; a moment of a recording; or a `Scan`, a
            `Range`, a `MapGrid`, or a `Speed` from odometry.

    Raises:
        TypeError: the message has no place on a map. ValueError: its numbers are invalid.
    """
    message = unwrap(message)
    if hasattr(message, "seconds") and hasattr(message, "message"):  # a `TimedMessage`
        message = message.message
    if isinstance(message, MapItem):
        return message
    if isinstance(message, MapGrid) or is_map_grid(message):
        grid = to_map_grid(message)
        return MapItem("grid", _clean(grid.frame_id), grid.stamp_ns, grid=grid)
    if isinstance(message, Scan) or has(message, "ranges", "angle_min", "angle_increment"):
        scan = to_scan(message).unmounted()  # frame_id, and so tf, is for the scanner
        return MapItem("scan", _clean(scan.frame_id), scan.stamp_ns, points=scan.xy)
    if isinstance(message, Range) or has(message, "range", "min_range", "max_range"):
        return _cone(to_range(message))
    if isinstance(message, Speed):
        # The frame of a speed is the robot's, not the frame of the pose.
        return MapItem("pose", "", message.stamp_ns, _known(message))
    frame, stamp = _clean(frame_id(message)), stamp_ns(message)
    poses = get(message, "poses", None)
    if poses is not None and not isinstance(poses, (str, bytes)):
        return _of_poses(poses, frame, stamp)
    if has(message, "latitude", "longitude"):
        return _of_fix(message, frame, stamp)
    if has(message, "x", "y", "theta"):
        return MapItem("pose", frame, stamp, Pose(*(_number(message, name) for name in ("x", "y", "theta"))))
    if has(message, "point.x", "point.y"):
        point = Pose(_number(message, "point.x"), _number(message, "point.y"), nan)
        return MapItem("pose", frame, stamp, _placed(point))
    if has(message, "transform.translation", "transform.rotation"):
        at = {"position": get(message, "transform.translation"), "orientation": get(message, "transform.rotation")}
        if (pose := pose_of(at)) is not None:
            return MapItem("pose", frame, stamp, _placed(pose))
    if (pose := pose_of(message)) is None:
        raise TypeError(f"expected a message like {TAKEN}; got {describe(message)}")
    child = _clean(str(get(message, "child_frame_id", "")))
    return MapItem(
        "pose", frame, stamp, _placed(pose), _scatter(get(message, "pose.covariance", None)), child_frame_id=child
    )


def _cone(one: Range) -> MapItem:
    """Return the cone of a sonar up to its reading, to its min_range if something is too close, or to its max_range.

    It has no points if the distance is unknown.
    """
    is_met = one.distance < inf
    reach = max(one.distance, one.min_range) if is_met else one.max_range
    points = np.empty((0, 2))
    if isfinite(reach) and (is_met or one.validity is Validity.NOTHING_IN_RANGE):
        beam = one.field_of_view or (_THIN if one.radiation == "infrared" else _BEAM)
        angles = np.linspace(-beam / 2, beam / 2, max(2, int(beam / _TURN) + 1))
        arc = reach * np.column_stack([np.cos(angles), np.sin(angles)])
        points = np.vstack([np.zeros((1, 2)), arc])
    return MapItem(
        "cone", _clean(one.frame_id), one.stamp_ns, Pose(0.0, 0.0, 0.0) if is_met else NOWHERE, points=points
    )


def _of_poses(poses: Sequence[Any], frame: str, stamp: int | None) -> MapItem:
    """Return the places of a Path, whose poses have headers, or of a PoseArray."""
    inner = [get(pose, "pose", pose) for pose in poses]
    columns = np.array([[_number(pose, f"position.{axis}") for axis in "xy"] for pose in inner], np.float64).reshape(
        -1, 2
    )
    if poses and has(poses[0], "pose"):
        frame = frame or _clean(frame_id(poses[0]))
        return MapItem("path", frame, stamp, points=_finite(columns))
    turns = np.array([[_number(pose, f"orientation.{axis}") for axis in "xyzw"] for pose in inner], np.float64).reshape(
        -1, 4
    )
    return MapItem("poses", frame, stamp, points=_finite(np.column_stack([columns, yaw_of(*turns.T)])))


def _of_fix(message: Any, frame: str, stamp: int | None) -> MapItem:
    latitude, longitude, altitude = (_number(message, name) for name in ("latitude", "longitude", "altitude"))
    status = get(message, "status.status", 0)
    known = isfinite(latitude) and isfinite(longitude) and status is not None and status > _NO_FIX
    known = known and not latitude == longitude == 0  # sent by receivers before their first fix
    if known and not (abs(latitude) <= 90 and abs(longitude) <= 360):
        raise ValueError(f"expected a latitude within ±90 degrees, got {latitude:g}, longitude {longitude:g}")
    fix = (latitude, longitude, altitude if isfinite(altitude) else 0.0) if known else NO_FIX
    has_covariance = get(message, "position_covariance_type", 0) not in (0, None)
    # A 3 x 3 matrix of east, north and up.
    covariance = get(message, "position_covariance", None) if has_covariance else None
    return MapItem("pose", frame, stamp, scatter=_scatter(covariance, 3), fix=fix)


def _scatter(covariance: Any, size: int = 6) -> Scatter | None:
    """Return the covariance of x and y from a covariance by rows, or None if it is all 0 or invalid."""
    if covariance is None or len(covariance) != size * size:
        return None
    try:
        xx, xy, yy = (float(covariance[i]) for i in (0, 1, size + 1))
    except (TypeError, ValueError):
        return None
    sure = isfinite(xx) and isfinite(xy) and isfinite(yy) and xx >= 0 and yy >= 0 and xx + yy > 0
    return Scatter(xx, xy, yy) if sure and xy * xy <= xx * yy * (1 + 1e-9) else None


def _known(speed: Speed) -> Pose:
    if speed.pose is None:
        raise TypeError(f"expected a message like {TAKEN}; got a speed without odometry")
    return _placed(speed.pose)


def _placed(pose: Pose) -> Pose:
    """Return the pose, or `NOWHERE` if its place is not finite."""
    return pose if isfinite(pose.x) and isfinite(pose.y) else NOWHERE


def _finite(rows: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    return rows[np.isfinite(rows[:, :2]).all(axis=1)]


def _number(message: Any, path: str) -> float:
    value = get(message, path, None)
    return nan if value is None else float(value)


def _clean(frame: str) -> str:
    """Return the name of a frame without the leading slash that ROS 1 may write."""
    return frame.lstrip("/")
