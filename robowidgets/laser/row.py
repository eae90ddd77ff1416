"""The rows of scans: of scanners, and made of clouds and depth images."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..kinds import Kind, OnDemandWidget
from ..messages import to_scan
from ..messages.cloud import CLOUD_TYPES
from ..messages.fields import FLOATS, MessageShape
from ..messages.image import IMAGE_TYPES
from ..messages.standard import LASER_SCAN, scan_message
from ..samples import Problem, Scan

if TYPE_CHECKING:
    from ..laser_widget import LaserWidget
    from ..recordings.columns.scans import Scans
    from ..simulator import Robot
    from ..simulator.offers import Offer
    from .frames import MadeScanFrames, ScanFrames
    from .rerun_log import ScanLog


def _widget() -> type[LaserWidget]:
    from ..laser_widget import LaserWidget

    return LaserWidget


def _columns() -> type[Scans]:
    from ..recordings.columns.scans import Scans

    return Scans


def _frames() -> type[ScanFrames]:
    from .frames import ScanFrames

    return ScanFrames


def _made_frames() -> type[MadeScanFrames]:
    from .frames import MadeScanFrames

    return MadeScanFrames


def _rerun() -> type[ScanLog]:
    from .rerun_log import ScanLog

    return ScanLog


def _simulated(robot: Robot) -> list[Offer]:
    """Return the topic of the scans, at the rate of the scanner."""
    from ..simulator.offers import Offer

    return [Offer("/scan", LASER_SCAN, robot.scan)]


_LIMITS = ("angle_min", "angle_increment", "range_min", "range_max")


def _is_scan(shape: MessageShape) -> bool:
    limits = all(shape.get(name) in FLOATS for name in _LIMITS)
    return limits and shape.get("ranges") in ("float32[]", "float64[]")


LASER = Kind(
    name="laser",
    sample_name="scan",
    noun="laser scans",
    sample=Scan,
    read=to_scan,
    types=frozenset({LASER_SCAN, "sensor_msgs/msg/MultiEchoLaserScan"}),
    widget=_widget,
    nothing=Scan(
        np.empty(0, np.float32),
        0.0,
        0.0,
        0.0,
        10.0,
        header_problems=(Problem("no scan up to this time of the recording", ""),),
    ),
    has_shape=_is_scan,
    columns=_columns,
    frames=_frames,
    rerun=_rerun,
    to_message=lambda: scan_message,
    simulated=_simulated,
    # A room is much smaller than the range of many scanners.
    options={"view_range": "auto"},
)
SCAN = OnDemandWidget(
    name="scan",
    types=CLOUD_TYPES | IMAGE_TYPES,
    widget=_widget,
    nothing=LASER.nothing,
    frames=_made_frames,
    options=LASER.options,
    instead_of=LASER.name,
)
"""A band of heights of a cloud, or rows of a depth image, as a laser scan: "/points as scan", or "as laser"."""
