"""Write robowidgets/data/sample.mcap: a simulated robot drives through a house and bumps into things.

The file is like a recording by `ros2 bag record -s mcap`, with /scan, /odom, /cmd_vel and /bumper.

    python scripts/make_sample.py [FILE]
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.enums import CompressionFormat
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from robowidgets.messages.definitions import definitions
from robowidgets.samples import Scan, Speed
from robowidgets.simulator import Pose, Robot, Scanner, World, wander

SAMPLE = Path(__file__).parents[1] / "robowidgets" / "data" / "sample.mcap"
DURATION = 58.0
STEP = 0.05
FORWARD = 0.6
START_NS = 1_750_000_000 * 1_000_000_000
"""The start of header stamps and log times (a day in June 2025), fixed so that the file is always the same."""

BUMPER_EVENT = "kobuki_ros_interfaces/msg/BumperEvent"
BUMPERS = ("left", "center", "right")
"""The bumpers in the order of the constants LEFT, CENTER and RIGHT."""
TOPICS = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/odom": "nav_msgs/msg/Odometry",
    "/cmd_vel": "geometry_msgs/msg/TwistStamped",
    "/bumper": BUMPER_EVENT,
}

STORE = get_typestore(Stores.ROS2_HUMBLE)
STORE.register(get_types_from_msg(definitions("kobuki_ros_interfaces")[BUMPER_EVENT], BUMPER_EVENT))


def main(target: Path = SAMPLE) -> None:
    """Write the recording, replacing an older one."""
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "sample"
        writer = Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP)
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        with writer:
            connections = {topic: writer.add_connection(topic, kind, typestore=STORE) for topic, kind in TOPICS.items()}
            for topic, time_ns, message in drive():
                writer.write(connections[topic], time_ns, STORE.serialize_cdr(message, TOPICS[topic]))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(bag / "sample.mcap", target)
    print(f"{target}: {target.stat().st_size / 1e3:.0f} kB")


def drive() -> Iterator[tuple[str, int, Any]]:
    """Yield the topic, time and message of everything that the robot publishes on its path."""
    robot = Robot(World.rooms(), pose=(0.2, -0.85, 0.5), scanner=Scanner(ray_count=451, intensities=True), seed=7)
    touched: dict[str, bool | None] = dict.fromkeys(BUMPERS, False)
    scan = None
    for _ in wander(robot, linear=FORWARD):
        now = START_NS + round(robot.time * 1e9)
        if robot.scan() is not scan:
            scan = robot.scan()
            yield "/scan", now, laser_scan(scan, 1 / robot.scanner.rate)
        yield "/odom", now, odometry(robot.speed(), robot.pose)
        yield "/cmd_vel", now, twist_stamped(robot.command())
        for number, name in enumerate(BUMPERS):
            state = robot.touch().touched[name]
            if state != touched[name]:
                touched[name] = state
                yield "/bumper", now, STORE.types[BUMPER_EVENT](bumper=number, state=int(bool(state)))
        if robot.time >= DURATION:
            return
        robot.step(STEP)


def laser_scan(scan: Scan, scan_time: float) -> Any:
    """Return a sensor_msgs/LaserScan."""
    return STORE.types[TOPICS["/scan"]](
        header=header(scan.stamp_ns, scan.frame_id),
        angle_min=scan.angle_min,
        angle_max=float(scan.angles[-1]),
        angle_increment=scan.angle_increment,
        time_increment=0.0,
        scan_time=scan_time,
        range_min=scan.range_min,
        range_max=scan.range_max,
        ranges=scan.ranges,
        intensities=scan.intensities,
    )


def odometry(speed: Speed, pose: Pose) -> Any:
    """Return a nav_msgs/Odometry: the pose in the frame odom, the speed in the frame of the body."""
    types = STORE.types
    where = types["geometry_msgs/msg/Pose"](
        position=types["geometry_msgs/msg/Point"](x=pose.x, y=pose.y, z=0.0),
        orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=sin(pose.yaw / 2), w=cos(pose.yaw / 2)),
    )
    unknown = np.zeros(36)
    return types[TOPICS["/odom"]](
        header=header(speed.stamp_ns, "odom"),
        child_frame_id=speed.frame_id,
        pose=types["geometry_msgs/msg/PoseWithCovariance"](pose=where, covariance=unknown),
        twist=types["geometry_msgs/msg/TwistWithCovariance"](twist=twist(speed), covariance=unknown),
    )


def twist_stamped(speed: Speed) -> Any:
    """Return a geometry_msgs/TwistStamped."""
    return STORE.types[TOPICS["/cmd_vel"]](header=header(speed.stamp_ns, speed.frame_id), twist=twist(speed))


def twist(speed: Speed) -> Any:
    """Return a geometry_msgs/Twist."""
    vector = STORE.types["geometry_msgs/msg/Vector3"]
    linear, angular = (vector(**dict(zip("xyz", values, strict=True))) for values in (speed.linear, speed.angular))
    return STORE.types["geometry_msgs/msg/Twist"](linear=linear, angular=angular)


def header(stamp_ns: int | None, frame_id: str) -> Any:
    """Return a std_msgs/Header for a simulated time."""
    sec, nanosec = divmod(START_NS + (stamp_ns or 0), 1_000_000_000)
    stamp = STORE.types["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
    return STORE.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame_id)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
