"""Conversion of any message to a sample, by duck typing.

Objects of rclpy, rospy and rosbags, dictionaries of rosbridge and plain mappings all work. ROS is not imported.
"""

from __future__ import annotations

import os

from .camera_info import to_camera_info
from .cloud import to_cloud
from .image import to_image
from .pose import to_pose
from .range import to_range
from .scan import to_scan
from .speed import to_speed
from .touch import to_touch

__all__ = [
    "add_definitions",
    "to_camera_info",
    "to_cloud",
    "to_image",
    "to_pose",
    "to_range",
    "to_scan",
    "to_speed",
    "to_touch",
]


def add_definitions(*sources: str | os.PathLike[str]) -> tuple[str, ...]:
    r"""Add custom message definitions, for all recordings and feeds that are opened from now on.

    They take precedence over all other definitions except the definitions in a recording.

    Args:
        *sources: folders with ``.msg`` files, such as a ROS package or a workspace, single ``.msg`` files, or texts
            with a line such as ``MSG: my_msgs/Status`` before each definition. ``.action`` files define the feedback
            of actions.

    Returns:
        The names of the types, such as ``my_msgs/msg/Status``.

    Raises:
        ValueError: a source has no definition, a definition is invalid, or it uses an unknown type. Then no definition
            is added.
        TypeError: a source is neither a path nor a text.

    Examples:
        >>> add_definitions("MSG: my_msgs/Status\nstd_msgs/Header header\nfloat32 charge\n")
        ('my_msgs/msg/Status',)
    """
    from .adding import add_all  # Imported lazily: rosbags takes longer to import than all the rest.

    return add_all(sources)
