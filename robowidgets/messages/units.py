"""The units of fields, by their names in the common packages and REP-103."""

from __future__ import annotations

import re

_UNITS = (
    (r"linear_acceleration\.[xyz]", "m/s²"),
    (r"angular_velocity\.[xyz]|angular(\.[xyz]|\[\d\])", "rad/s"),
    (r"linear(\.[xyz]|\[\d\])|speed", "m/s"),
    (
        r"point\.[xyz]|position\.[xyz]|translation\.[xyz]|range|min_range|max_range|range_min|range_max|ranges\[\d+\]",
        "m",
    ),
    (r"steering_angle|angle_min|angle_max|angle_increment|field_of_view|theta|yaw", "rad"),
    (r"voltage|cell_voltage\[\d+\]", "V"),
    (r"current", "A"),
    (r"force\.[xyz]", "N"),
    (r"torque\.[xyz]", "N·m"),
    (r"magnetic_field\.[xyz]", "T"),
    (r"latitude|longitude", "°"),
    (r"altitude", "m"),
    (r"fluid_pressure", "Pa"),
    (r"illuminance", "lx"),
    (r"time_increment|scan_time", "s"),
)
_BATTERY = ((r"charge|capacity|design_capacity", "Ah"), (r"temperature|cell_temperature\[\d+\]", "°C"))
_PLACE = ((r"[xyz]", "m"),)
_OF_TYPE = {
    "sensor_msgs/msg/BatteryState": _BATTERY,
    "sensor_msgs/msg/Temperature": ((r"temperature", "°C"),),
    "geometry_msgs/msg/Point": _PLACE,
    "geometry_msgs/msg/Point32": _PLACE,
    "geometry_msgs/msg/Pose2D": _PLACE,
}
"""Units of fields whose names have another meaning in other messages."""

_ACCELERATIONS = ("geometry_msgs/msg/Accel", "geometry_msgs/msg/AccelStamped")


def unit_of(message: str, field: str) -> str:
    """Return the unit of a field of a message of this type, or empty if its name does not imply one."""
    if message in _ACCELERATIONS:
        return "rad/s²" if "angular." in field else "m/s²"
    known = (*_OF_TYPE.get(message, ()), *_UNITS)
    return next((unit for name, unit in known if re.search(rf"(^|\.)({name})$", field)), "")
