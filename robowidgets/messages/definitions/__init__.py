"""Message definitions that the robots of our users need and that neither their files nor rosbags hold.

A file each, ``<package>/msg/<Name>.msg``: the fields, in their order, are those of the package of that name, the same
for ROS 1 and ROS 2. Sources: kobuki_msgs, create_msgs, ca_msgs, irobot_create_msgs, turtlebot3_msgs,
neato2_interfaces, neato_node, gazebo_msgs, ros_gz_interfaces.
"""

from __future__ import annotations

from importlib.resources import files

SAME_AS = {"kobuki_ros_interfaces": "kobuki_msgs", "ros_ign_interfaces": "ros_gz_interfaces"}
"""Packages that hold the messages of another under their own name."""


def definitions(package: str) -> dict[str, str]:
    """Type name (``kobuki_msgs/msg/BumperEvent``) to text, for each message of a package; none for an unknown one."""
    held_as = SAME_AS.get(package, package)
    folder = files(__name__) / held_as / "msg"
    if not folder.is_dir():
        return {}
    return {
        f"{package}/msg/{file.name.removesuffix('.msg')}": file.read_text(encoding="utf-8").replace(
            f"{held_as}/", f"{package}/"
        )
        for file in folder.iterdir()
    }
