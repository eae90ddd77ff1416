"""`update` of a widget as the callback of a subscription in the user's own node, without a feed."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
import roslibpy

from robowidgets import LaserWidget, Validity

from ..waiting import wait_for
from .bridge import Rosbridge
from .fake_rclpy import QoSProfile, SingleThreadedExecutor, get_message, install


@pytest.fixture
def laser() -> Iterator[LaserWidget]:
    widget = LaserWidget()
    yield widget
    widget.close()


def shown(laser: LaserWidget) -> list[Validity]:
    return [Validity(kind) for kind in laser.scan.validity] if laser.scan else []


def test_of_roslibpy(laser: LaserWidget) -> None:
    limits = {"angle_min": -1.0, "angle_max": 1.0, "angle_increment": 1.0, "range_min": 0.1, "range_max": 10.0}
    header = {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "laser"}
    with Rosbridge({"/scan": "sensor_msgs/LaserScan"}) as server:
        ros = roslibpy.Ros("127.0.0.1", server.port)
        ros.run(timeout=240)
        try:
            roslibpy.Topic(ros, "/scan", "sensor_msgs/LaserScan").subscribe(laser.update)
            wait_for(lambda: "/scan" in server.subscribed, "it subscribed")
            server.publish("/scan", {"header": header, **limits, "ranges": [1.5, math.nan, 0.01], "intensities": []})
            wait_for(lambda: shown(laser), "the laser shows the scan")
            assert shown(laser) == [Validity.READING, Validity.NO_MEASUREMENT, Validity.OUTSIDE_LIMITS]
            assert laser.scan is not None
            assert (laser.scan.frame_id, laser.scan.stamp_ns) == ("laser", 1_000_000_002)
        finally:
            ros.close()


def test_of_rclpy(laser: LaserWidget, monkeypatch: pytest.MonkeyPatch) -> None:
    graph, qos = install(monkeypatch), QoSProfile(depth=5)
    make = get_message("sensor_msgs/msg/LaserScan")
    mine = graph.node()
    executor = SingleThreadedExecutor(context=mine.context)
    executor.add_node(mine)
    mine.create_subscription(make, "/scan", laser.update, qos)
    publisher = graph.node().create_publisher(make, "/scan", qos)
    wait_for(publisher.get_subscription_count, "they know each other")
    message = make()
    message.angle_increment, message.range_min, message.range_max = 0.5, 0.1, 10.0
    message.ranges = np.array([1.0, 2.0], np.float32)
    publisher.publish(message)
    executor.spin_once(1.0)
    assert shown(laser) == [Validity.READING, Validity.READING]
