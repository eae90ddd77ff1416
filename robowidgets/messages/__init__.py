"""From a message in anybody's hands to a sample, by duck typing.

rclpy, rospy and rosbags objects, rosbridge dictionaries and plain mappings all work. Nothing of ROS is imported.
"""

from .pose import to_pose
from .range import to_range
from .scan import to_scan
from .speed import to_speed
from .touch import to_touch

__all__ = ["to_pose", "to_range", "to_scan", "to_speed", "to_touch"]
