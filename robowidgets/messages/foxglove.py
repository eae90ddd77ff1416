"""Conversion of Foxglove's schemas of sensors to messages of ROS with the same content.

Source: https://docs.foxglove.dev/docs/sdk/schemas
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import Any

PlainFields = Mapping[str, Any]

_POINT_FIELDS = {1: 2, 2: 1, 3: 4, 4: 3, 5: 6, 6: 5, 7: 7, 8: 8}
"""Numbers of foxglove.PackedElementField to numbers of sensor_msgs/PointField."""
_TYPES = ("UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64")
_LEVELS = ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL")
_COVARIANCES = ("UNKNOWN", "APPROXIMATED", "DIAGONAL_KNOWN", "KNOWN")


def time_of(value: Any) -> dict[str, int]:
    """Return the fields of a stamp of ROS 2 for a time with ``nsec`` or ``nanosec``, or 0 for other values."""
    if not isinstance(value, Mapping):
        return {"sec": 0, "nanosec": 0}
    return {"sec": int(value.get("sec", 0)), "nanosec": int(value.get("nanosec", value.get("nsec", 0)))}


def _header(fields: PlainFields, frame: str = "frame_id") -> dict[str, Any]:
    return {"stamp": time_of(fields.get("timestamp")), "frame_id": str(fields.get(frame, ""))}


def _number(value: Any, names: Sequence[str]) -> int:
    """Return the number of an enum value, which JSON may have as a name."""
    return names.index(value) if isinstance(value, str) and value in names else int(value or 0)


def _scan(fields: PlainFields) -> dict[str, Any]:
    ranges = fields.get("ranges") or ()
    start, end = (float(fields.get(name) or 0.0) for name in ("start_angle", "end_angle"))
    return {
        "header": _header(fields),
        "angle_min": start,
        "angle_max": end,
        "angle_increment": (end - start) / (len(ranges) - 1) if len(ranges) > 1 else 0.0,
        "range_max": inf,
        "ranges": ranges,
        "intensities": fields.get("intensities") or (),
    }


def _log(fields: PlainFields) -> dict[str, Any]:
    same = {name: fields.get(name, "") for name in ("name", "file")}
    level = 10 * _number(fields.get("level"), _LEVELS)
    return {"stamp": time_of(fields.get("timestamp")), "level": level, "msg": fields.get("message", ""), **same}


def _image(fields: PlainFields) -> dict[str, Any]:
    return {"header": _header(fields), **_same(fields, "height", "width", "encoding", "step", "data")}


def _cloud(fields: PlainFields) -> dict[str, Any]:
    step, data = int(fields.get("point_stride") or 0), fields.get("data") or b""
    size = len(data) if isinstance(data, (bytes, bytearray)) else len(data) * 3 // 4 - str(data)[-2:].count("=")
    width = size // step if step else 0
    columns = [
        {
            "name": one.get("name", ""),
            "offset": one.get("offset", 0),
            "datatype": _POINT_FIELDS.get(_number(one.get("type"), _TYPES), 0),
            "count": 1,
        }
        for one in fields.get("fields") or ()
    ]
    layout = {"height": 1, "width": width, "point_step": step, "row_step": width * step, "is_dense": False}
    return {"header": _header(fields), "fields": columns, "data": data, **layout}


def _fix(fields: PlainFields) -> dict[str, Any]:
    kind = _number(fields.get("position_covariance_type"), _COVARIANCES)
    more = {"position_covariance": fields["position_covariance"]} if fields.get("position_covariance") else {}
    place = _same(fields, "latitude", "longitude", "altitude")
    return {"header": _header(fields), **place, "position_covariance_type": kind, **more}


def _transform(fields: PlainFields) -> dict[str, Any]:
    return {
        "header": _header(fields, "parent_frame_id"),
        "child_frame_id": str(fields.get("child_frame_id", "")),
        "transform": _same(fields, "translation", "rotation"),
    }


def _calibration(fields: PlainFields) -> dict[str, Any]:
    # Empty matrices are left out.
    matrices = {name.lower(): fields[name] for name in "DKRP" if fields.get(name)}
    return {"header": _header(fields), **_same(fields, "height", "width", "distortion_model"), **matrices}


def _same(fields: PlainFields, *names: str) -> dict[str, Any]:
    return {name: fields[name] for name in names if fields.get(name) is not None}


_MESSAGES: dict[str, tuple[str, Callable[[PlainFields], dict[str, Any]]]] = {
    "LaserScan": ("sensor_msgs/msg/LaserScan", _scan),
    "PoseInFrame": ("geometry_msgs/msg/PoseStamped", lambda one: {"header": _header(one), **_same(one, "pose")}),
    "PosesInFrame": ("geometry_msgs/msg/PoseArray", lambda one: {"header": _header(one), **_same(one, "poses")}),
    "Log": ("rcl_interfaces/msg/Log", _log),
    "RawImage": ("sensor_msgs/msg/Image", _image),
    "CompressedImage": (
        "sensor_msgs/msg/CompressedImage",
        lambda one: {"header": _header(one), **_same(one, "format", "data")},
    ),
    "PointCloud": ("sensor_msgs/msg/PointCloud2", _cloud),
    "LocationFix": ("sensor_msgs/msg/NavSatFix", _fix),
    "FrameTransform": ("tf2_msgs/msg/TFMessage", lambda one: {"transforms": [_transform(one)]}),
    "FrameTransforms": (
        "tf2_msgs/msg/TFMessage",
        lambda one: {"transforms": [_transform(part) for part in one.get("transforms") or ()]},
    ),
    "CameraCalibration": ("sensor_msgs/msg/CameraInfo", _calibration),
}


def as_ros(schema: str) -> tuple[str, Callable[[PlainFields], dict[str, Any]]] | None:
    """Return the ROS type for a schema of Foxglove and a function that returns its fields, or None.

    Args:
        schema: its name, such as ``foxglove.LaserScan``.
    """
    package, _, name = schema.partition(".")
    return _MESSAGES.get(name) if package == "foxglove" else None
