"""Conversion of CameraInfo messages."""

from __future__ import annotations

from typing import Any

from ..samples.camera_info import CameraInfo, PixelBox
from .fields import MISSING, describe, frame_id, get, has, stamp_ns, unwrap


def to_camera_info(message: Any) -> CameraInfo:
    """Return the calibration in a CameraInfo-like message.

    Args:
        message: an object or dictionary with the fields of sensor_msgs/CameraInfo of ROS 2 (``k``) or ROS 1 (``K``);
            a `CameraInfo` is returned as it is.

    Raises:
        TypeError: the message has another type; the text says what came and what was expected.
        ValueError: its numbers are invalid.
    """
    message = unwrap(message)
    if isinstance(message, CameraInfo):
        return message
    k = _either(message, "k")
    if k is MISSING or not has(message, "width", "height"):
        raise TypeError(
            f"expected a message like sensor_msgs/CameraInfo, with width, height and k; got {describe(message)}"
        )
    more = {name: value for name in "drp" if (value := _either(message, name)) is not MISSING and value is not None}
    return CameraInfo(
        get(message, "width"),
        get(message, "height"),
        k,
        **more,
        distortion_model=str(get(message, "distortion_model", "") or ""),
        binning=(get(message, "binning_x", 1) or 1, get(message, "binning_y", 1) or 1),
        roi=PixelBox(*(get(message, f"roi.{name}", 0) or 0 for name in PixelBox._fields)),
        stamp_ns=stamp_ns(message),
        frame_id=frame_id(message).lstrip("/"),
    )


def _either(message: Any, name: str) -> Any:
    """Return a field whose name is in capitals in ROS 1."""
    return get(message, name, get(message, name.upper()))
