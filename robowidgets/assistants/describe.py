"""Samples as small objects in SI units, with what is unknown."""

from __future__ import annotations

from math import inf, isnan
from typing import Any

from ..samples import Range, Ray, Scan, Speed, Touch
from ..samples.pose import Pose
from .answer import exact, name, number, plain

NOTHING, TOO_CLOSE, UNKNOWN = "nothing in range", "too close to measure", "unknown: no ray has a reading"


def describe(sample: Any) -> dict[str, Any]:
    """Return the data of a sample, or the fields of a message of any other type."""
    if isinstance(sample, Scan):
        return {
            "kind": "scan",
            **distance(sample),
            "rays": len(sample),
            "rays_by_class": {validity.name.lower(): count for validity, count in sample.counts.items() if count},
            "angle_min_rad": number(sample.angle_min),
            "angle_increment_rad": number(sample.angle_increment),
            "range_min_m": number(sample.range_min),
            "range_max_m": number(sample.range_max),
            **_about(sample),
        }
    if isinstance(sample, Speed):
        unknown = [
            f"{part}.{axis}"
            for part in ("linear", "angular")
            for axis, value in zip("xyz", getattr(sample, part), strict=True)
            if isnan(value)
        ]
        return {
            "kind": "speed",
            "linear_m_s": [number(value) for value in sample.linear],
            "angular_rad_s": [number(value) for value in sample.angular],
            **({"unknown": unknown} if unknown else {}),
            **({"pose": pose(sample.pose)} if sample.pose is not None else {}),
            **_about(sample),
        }
    if isinstance(sample, Touch):
        states = [{"sensor": name(sensor), "touched": state} for sensor, state in sample.touched.items()]
        missing = [name(sensor) for sensor in sample.sensors if sensor not in sample.touched]
        listed = {"not_in_this_message": missing} if missing else {}
        return {"kind": "touch", "mode": sample.mode.value, "sensors": states, **listed, **_about(sample)}
    if isinstance(sample, Range):
        return {
            "kind": "range",
            **_distance(sample.distance),
            "min_range_m": number(sample.min_range),
            "max_range_m": number(sample.max_range),
            **_about(sample),
        }
    return {"kind": "message", "fields": plain(sample)}


def distance(scan: Scan, sector: Any = None) -> dict[str, Any]:
    """Return the distance to the nearest thing in a sector, None if it is not a number of metres, and its ray."""
    of_sector = () if sector is None else (sector,)
    nearest = scan.nearest(*of_sector)
    return _distance(scan.distance(*of_sector)) | ({} if nearest is None else {"nearest": ray(nearest)})


def ray(one: Ray) -> dict[str, Any]:
    """Return a ray: its index in ``ranges``, its angle counter-clockwise from forward, and its range."""
    return {
        "index": one.index,
        "angle_rad": number(one.angle),
        "range_m": number(one.range),
        "x_m": None if one.x is None else number(one.x),
        "y_m": None if one.y is None else number(one.y),
        "class": one.validity.name.lower(),
    }


def pose(of_robot: Pose) -> dict[str, Any]:
    """Return a pose of odometry."""
    return {"x_m": exact(of_robot.x), "y_m": exact(of_robot.y), "yaw_rad": number(of_robot.yaw)}


def _distance(metres: float) -> dict[str, Any]:
    meaning = UNKNOWN if isnan(metres) else NOTHING if metres == inf else TOO_CLOSE if metres <= 0 else ""
    return {"distance_m": number(metres)} | ({"meaning": meaning} if meaning else {})


def said(metres: float) -> str:
    """Return a distance as text."""
    if isnan(metres) or metres == inf or metres <= 0:
        return str(_distance(metres)["meaning"])
    return f"{metres:.3g} m"


def frame(sample: Any) -> dict[str, Any]:
    """Return the frame of a sample, and for a scanner that is turned on its robot, that angles are the robot's."""
    named, mount = getattr(sample, "frame_id", None), getattr(sample, "mount", None)
    if named is None:
        return {}
    turned = "" if mount is None else mount.words
    return {"frame": name(named) if named else "unknown"} | (
        {"angles": f"of the robot, not of this frame: the scanner is {turned}"} if turned else {}
    )


def _about(sample: Any) -> dict[str, Any]:
    stamp = getattr(sample, "stamp_ns", None)
    return frame(sample) | ({"stamp": "unknown"} if stamp is None else {"stamp_ns": stamp})
