"""Which widget shows which messages: by the name of their type, and by their fields where nobody knows the name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from .messages.touch import TOUCH_TYPES

Widget = Literal["laser", "speed", "touch"]

Shape = Mapping[str, Any]
"""Field names to ``"float32"``, ``"float32[]"``, or the shape of the message in them."""

_BY_TYPE: dict[str, Widget] = {
    "sensor_msgs/msg/LaserScan": "laser",
    "geometry_msgs/msg/Twist": "speed",
    "geometry_msgs/msg/TwistStamped": "speed",
    "geometry_msgs/msg/TwistWithCovariance": "speed",
    "geometry_msgs/msg/TwistWithCovarianceStamped": "speed",
    "nav_msgs/msg/Odometry": "speed",
    **dict.fromkeys(TOUCH_TYPES, "touch"),
    "robowidgets/msg/Touch": "touch",  # of our own simulator, in no message
}

_STANDARD = frozenset(
    (
        *("actionlib_msgs", "action_msgs", "builtin_interfaces", "diagnostic_msgs", "geometry_msgs", "lifecycle_msgs"),
        *("map_msgs", "nav_msgs", "rcl_interfaces", "rosgraph_msgs", "sensor_msgs", "shape_msgs", "std_msgs"),
        *("stereo_msgs", "tf", "tf2_msgs", "trajectory_msgs", "unique_identifier_msgs", "visualization_msgs"),
    )
)

_NUMBERS = ("float32", "float64")


def widget_by_type(type_name: str) -> Widget | None:
    """The widget for a type that we know by name."""
    return _BY_TYPE.get(type_name)


def is_standard(type_name: str) -> bool:
    """Whether a type is of a ROS package that we know: if no widget is known for it, its fields need no look.

    A geometry_msgs/Accel, say, has the fields of a Twist and is no speed.
    """
    return type_name.split("/")[0] in _STANDARD


def widget_by_shape(shape: Shape) -> Widget | None:
    """The widget for a message with these fields: a scan of its own package, or a twist within a larger message."""
    limits = ("angle_min", "angle_increment", "range_min", "range_max")
    if all(shape.get(name) in _NUMBERS for name in limits) and shape.get("ranges") in ("float32[]", "float64[]"):
        return "laser"
    twist: Any = shape
    while isinstance(twist, Mapping):
        if all(_is_vector(twist.get(part)) for part in ("linear", "angular")):
            return "speed"
        twist = twist.get("twist")
    return None


def is_command(topic: str) -> bool:
    """Whether a speed on this topic was asked for, not measured: its name holds ``cmd`` or ``command``."""
    return "cmd" in topic.lower() or "command" in topic.lower()


def _is_vector(shape: Any) -> bool:
    return isinstance(shape, Mapping) and all(shape.get(axis) in _NUMBERS for axis in "xyz")
