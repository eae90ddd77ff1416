"""A process with this folder on its path imports this instead of rclpy: the stand-in, with a robot base in its network.

The base writes each speed that leaves the process into the file that ROBOT_LOG names, with the monotonic time.
"""

import os
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

sys.path.append(str(Path(__file__).parents[4]))
from tests.unit.feeds.fake_rclpy import get_message, install

graph = install(pytest.MonkeyPatch())


def note(message: Any) -> None:
    with open(os.environ["ROBOT_LOG"], "a") as log:
        print(time.monotonic(), message.linear.x, message.angular.z, file=log)


def scans() -> None:
    scan = get_message("sensor_msgs/msg/LaserScan")()
    scan.range_max = 10.0
    while True:
        scanner.publish(scan)
        time.sleep(0.1)


base = graph.node("base")
base.create_subscription(get_message("geometry_msgs/msg/Twist"), "/cmd_vel", print, 10).receive = note
scanner = base.create_publisher(get_message("sensor_msgs/msg/LaserScan"), "/scan", 10)
threading.Thread(target=scans, daemon=True).start()
