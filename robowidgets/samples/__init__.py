"""Samples: the data that every source makes and every widget shows.

A sample is immutable, in SI units and in the body frame of REP-103 (x forward, y left, z up; yaw grows
counter-clockwise). It depends neither on ROS nor on a page.
"""

from .age import HasAge
from .camera_info import CameraInfo
from .cloud import Cloud
from .event import Event, Level
from .image import Image
from .map_grid import MapGrid
from .mount import Mount
from .pose import Pose, yaw_of
from .problem import Problem
from .range import Range
from .ranges import Ranges
from .ray import Ray, Validity
from .scan import Scan
from .sector import Sector
from .speed import AXES, Speed
from .spread import spread
from .touch import Touch, TouchMode, TouchState

__all__ = [
    "AXES",
    "CameraInfo",
    "Cloud",
    "Event",
    "HasAge",
    "Image",
    "Level",
    "MapGrid",
    "Mount",
    "Pose",
    "Problem",
    "Range",
    "Ranges",
    "Ray",
    "Scan",
    "Sector",
    "Speed",
    "Touch",
    "TouchMode",
    "TouchState",
    "Validity",
    "spread",
    "yaw_of",
]
