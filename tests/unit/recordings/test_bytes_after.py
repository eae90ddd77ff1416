"""Bytes after the last field of messages, and the early notes on unreadable messages in the table of topics."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets.messages.encoding import encode

from . import recorded
from .test_mcap_dialects import SCAN, text_of
from .test_mcap_dialects import write as write_mcap

IGNORED = "4 bytes after each message that its definition does not describe, ignored"
IMAGE = {"height": 2, "width": 3, "encoding": "mono8", "step": 3, "data": np.arange(6, dtype=np.uint8)}


def write_bag(path: Path, after: bytes = b"\1\2\3\4") -> Path:
    """A bag with ten scans and ten pictures, each followed by bytes."""
    store = get_typestore(Stores.ROS1_NOETIC)
    types: dict[str, tuple[str, dict[str, Any]]] = {
        "/scan": ("sensor_msgs/msg/LaserScan", SCAN),
        "/image": ("sensor_msgs/msg/Image", IMAGE),
    }
    with BagWriter(path) as writer:
        for topic, (name, fields) in types.items():
            connection = writer.add_connection(topic, name, typestore=store)
            for i in range(10):
                writer.write(connection, recorded.START_NS + i * 10**8, encode("ros1", name, fields) + after)
    return path


def test_bytes_after_the_last_field_in_a_bag_are_ignored_and_reported_once(tmp_path: Path) -> None:
    with robowidgets.open(write_bag(tmp_path / "x.bag")) as recording:
        assert f"! /scan, /image: {IGNORED}" in recording.info()
        assert recording.scans().ranges.shape == (10, 21)
        assert len(list(recording.samples("/scan"))) == 10
        assert [one.message.data.tolist() for one in recording.messages("/image")] == [list(range(6))] * 10
        assert recording.fields("/image")["width"].tolist() == [3] * 10
        assert recording.problems == (f"/scan, /image: {IGNORED}",)
        assert [str(one) for one in recording.doctor().problems if IGNORED in str(one)]


def test_bytes_after_the_last_field_in_cdr_are_ignored_and_reported(tmp_path: Path) -> None:
    raw = encode("cdr", "sensor_msgs/msg/LaserScan", SCAN) + bytes(4)
    kind = ("sensor_msgs/msg/LaserScan", "ros2msg", text_of("sensor_msgs/msg/LaserScan"), "cdr")
    path = write_mcap(tmp_path / "x.mcap", {"/scan": kind}, [(i / 10, "/scan", raw) for i in range(10)])
    with robowidgets.open(path) as recording:
        assert f"! /scan: {IGNORED}" in recording.info()
        assert recording.scans().ranges.shape == (10, 21)


def test_a_camera_makers_bag_is_read(data: Path) -> None:
    with robowidgets.open(data / "reports/bag_bytes_after_message/trailing.bag") as recording:
        assert IGNORED in recording.info()
        assert len(recording.scans()) == len(list(recording.messages("/device_0/sensor_0/Depth_0/image/data"))) == 10


def test_a_definition_that_is_not_of_the_file_describes_all_bytes_or_nothing(tmp_path: Path) -> None:
    """Bytes left over suggest that the fields before belong to another version."""
    raw = encode("cdr", "sensor_msgs/msg/LaserScan", SCAN) + bytes(4)
    folder = recorded.write(
        tmp_path / "x",
        {"/scan": "sensor_msgs/msg/LaserScan"},
        [(i / 10, "/scan", raw) for i in range(10)],
        recorded.StoragePlugin.SQLITE3,
    )
    with robowidgets.open(recorded.forget_definitions(folder)) as recording:
        assert "/scan: messages that cannot be shown are left out, the first at 0.00 s" in recording.info()


@pytest.mark.parametrize("name", ["std_msgs/msg/Float64", "sensor_msgs/msg/LaserScan"])
def test_the_table_of_topics_reports_at_once_that_messages_are_invalid(tmp_path: Path, name: str) -> None:
    path = write_mcap(tmp_path / "x.mcap", {"/x": (name, "ros2msg", text_of(name), "cdr")}, [(0, "/x", b"\0\1\0\0x")])
    with robowidgets.open(path) as recording:
        assert "! /x: messages that cannot be shown are left out, the first at 0.00 s: 5 bytes" in recording.info()


def test_the_table_of_topics_says_at_once_that_a_type_is_not_known(tmp_path: Path) -> None:
    """A package whose types are all known may have one more in a future version."""
    path = write_mcap(tmp_path / "x.mcap", {"/x": ("std_msgs/msg/New", "", b"", "cdr")}, [(0, "/x", b"\0\1\0\0x")])
    with robowidgets.open(path) as recording:
        assert "! /x: no definition of its messages in the file" in recording.info()
        assert recording.topics[0].problem
