"""The units of fields, by their names in the common packages and REP-103."""

from __future__ import annotations

import re

_UNITS = (
    (r"linear_acceleration\.[xyz]", "m/s²"),
    (r"angular_velocity\.[xyz]|angular(\.[xyz]|\[\d\])", "rad/s"),
    (r"linear(\.[xyz]|\[\d\])|speed", "m/s"),
    (r"position\.[xyz]|translation\.[xyz]|range|min_range|max_range|range_min|range_max|ranges\[\d+\]", "m"),
    (r"steering_angle|angle_min|angle_max|angle_increment|field_of_view|theta|yaw", "rad"),
    (r"voltage", "V"),
    (r"current", "A"),
    (r"force\.[xyz]", "N"),
    (r"torque\.[xyz]", "N·m"),
    (r"magnetic_field\.[xyz]", "T"),
    (r"latitude|longitude", "°"),
    (r"altitude", "m"),
    (r"fluid_pressure", "Pa"),
    (r"illuminance", "lx"),
)

_ACCELERATIONS = ("geometry_msgs/msg/Accel", "geometry_msgs/msg/AccelStamped")


def unit_of(message: str, field: str) -> str:
    """The unit of a field of a message of this type; empty where the name does not tell."""
    if message in _ACCELERATIONS:
        return "rad/s²" if "angular." in field else "m/s²"
    return next((unit for name, unit in _UNITS if re.search(rf"(^|\.)({name})$", field)), "")
