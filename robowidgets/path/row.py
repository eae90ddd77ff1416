"""The row of a map."""

from __future__ import annotations

from collections.abc import Callable
from math import nan
from typing import TYPE_CHECKING

from ..kinds import OnDemandWidget
from ..messages.standard import LASER_SCAN, ODOMETRY
from ..poses.transforms import TRANSFORMS
from ..samples import Pose, Speed

if TYPE_CHECKING:
    from ..path_widget import PathWidget
    from ..tracks import Track


def _widget() -> type[PathWidget]:
    from ..path_widget import PathWidget

    return PathWidget


def _frames() -> Callable[..., Track]:
    from .frames import path_track

    return path_track


PATH = OnDemandWidget(
    name="path",
    types=frozenset(TRANSFORMS)
    | {f"geometry_msgs/msg/Pose{suffix}" for suffix in ("", "Stamped", "WithCovariance", "Array", "2D")}
    | {f"geometry_msgs/msg/{name}" for name in ("PoseWithCovarianceStamped", "PointStamped", "TransformStamped")}
    | {"nav2_msgs/msg/Costmap", "sensor_msgs/msg/NavSatFix", "gps_msgs/msg/GPSFix", "gps_common/msg/GPSFix"}
    | {"turtlesim/msg/Pose", ODOMETRY}
    | {f"nav_msgs/msg/{name}" for name in ("Path", "OccupancyGrid")},
    widget=_widget,
    nothing=Speed((nan, nan, nan), (nan, nan, nan), pose=Pose(nan, nan, nan)),
    frames=_frames,
    shared=True,
    companion_types=frozenset({*TRANSFORMS, LASER_SCAN}),
    # Each message of tf may contain other frames.
    every_message=True,
)
"""Odometry contains the position of the robot, so it has a path. Other positions are shown on demand, on one map."""
