"""The fields of a sensor_msgs/LaserScan straight from its bytes.

Before rosbags reads its first message of a type it writes and compiles code for it, which takes longer than to read all
scans of a short recording. What is unusual in any way is left to it.
"""

from __future__ import annotations

from struct import Struct
from types import SimpleNamespace

import numpy as np

from ..messages.fields import Shape

_SETTINGS = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")
_FIELDS = [*((name, "float32") for name in _SETTINGS), ("ranges", "float32[]"), ("intensities", "float32[]")]
_STAMPED = {"cdr": ["stamp", "frame_id"], "ros1": ["seq", "stamp", "frame_id"]}

# In CDR four bytes say how it is encoded, these two that it is little-endian; ROS 1 has the four of `seq` there.
_LITTLE_ENDIAN = b"\0\1"
_HEAD = Struct("<4xiII")
_FLOATS = Struct("<7f")
_COUNT = Struct("<I")


def is_usual(shape: Shape, encoding: str) -> bool:
    """Whether messages of a type are laid out as those of sensor_msgs/LaserScan are."""
    header = shape.get("header")
    return (
        list(shape.items()) == [("header", header), *_FIELDS]
        and encoding in _STAMPED
        and isinstance(header, dict)
        and list(header) == _STAMPED[encoding]
        and (header["stamp"], header["frame_id"]) == ("Time", "string")
    )


def read(raw: bytes, encoding: str) -> SimpleNamespace | None:
    """A message of such a type, its arrays views of the bytes; None when there is anything unusual about it."""
    is_cdr = encoding == "cdr"
    if len(raw) < _HEAD.size or (is_cdr and not raw.startswith(_LITTLE_ENDIAN)):
        return None
    seconds, nanoseconds, length = _HEAD.unpack_from(raw)
    at = _HEAD.size + length
    frame_id = raw[_HEAD.size : at]
    if is_cdr:
        # The text ends with a zero, and what follows is aligned.
        if frame_id[-1:] != b"\0":
            return None
        frame_id, at = frame_id[:-1], -(-at // 4) * 4
    if len(raw) < at + _FLOATS.size + 2 * _COUNT.size or not frame_id.isascii():
        return None
    settings = dict(zip(_SETTINGS, _FLOATS.unpack_from(raw, at), strict=True))
    at += _FLOATS.size
    arrays = []
    for _ in ("ranges", "intensities"):
        if len(raw) < at + _COUNT.size:
            return None
        (count,) = _COUNT.unpack_from(raw, at)
        at += _COUNT.size
        if len(raw) < at + 4 * count:
            return None
        arrays.append(np.frombuffer(raw, "<f4", count, at))
        at += 4 * count
    if at != len(raw):
        return None
    header = SimpleNamespace(stamp=SimpleNamespace(sec=seconds, nanosec=nanoseconds), frame_id=frame_id.decode("ascii"))
    return SimpleNamespace(header=header, ranges=arrays[0], intensities=arrays[1], **settings)
