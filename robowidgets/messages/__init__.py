"""From a message in anybody's hands to a sample, by duck typing.

rclpy, rospy and rosbags objects, rosbridge dictionaries and plain mappings all work. Nothing of ROS is imported.
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
    r"""Add message definitions of your own, for all recordings and feeds that are opened from now on.

    Definitions in a file come before them; they come before all others.

    Args:
        *sources: folders with ``.msg`` files, such as a ROS package or a workspace, single ``.msg`` files, or texts in
            which a line such as ``MSG: my_msgs/Status`` stands before each definition. ``.action`` files define the
            feedback of actions.

    Returns:
        The names of the types, such as ``my_msgs/msg/Status``.

    Raises:
        ValueError: there is no definition, one cannot be understood, or one uses a type that is not known. None is
            added then.
        TypeError: neither a path nor a text.

    Examples:
        >>> add_definitions("MSG: my_msgs/Status\nstd_msgs/Header header\nfloat32 charge\n")
        ('my_msgs/msg/Status',)
    """
    from .adding import add_all  # Imported lazily: rosbags takes longer to import than everything else.

    return add_all(sources)
