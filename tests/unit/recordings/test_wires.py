"""The wires of a recording: its topics, and the nodes that published them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets import RecordingError
from robowidgets.wires_widget import Wire

STORE = get_typestore(Stores.ROS1_NOETIC)
TEXT, LOG = "std_msgs/msg/String", "rosgraph_msgs/msg/Log"
SECOND = 1_000_000_000


def log(name: str, text: str) -> Any:
    header = STORE.types["std_msgs/msg/Header"](0, STORE.types["builtin_interfaces/msg/Time"](1, 0), "")
    return STORE.types[LOG](header, 2, name, text, "main.cpp", "main", 1, [])


def write_bag(path: Path, callers: dict[str, str | None]) -> Path:
    """A bag with a text every second on each of these topics, and a log."""
    with Writer(path) as bag:
        for topic, caller in callers.items():
            name = topic.partition(" ")[0]
            channel = bag.add_connection(name, TEXT, typestore=STORE, callerid=caller)
            for i in range(5):
                raw = STORE.serialize_ros1(STORE.types[TEXT](f"{i} of {caller}"), TEXT)
                bag.write(channel, (10 + i) * SECOND, raw)
        channel = bag.add_connection("/rosout", LOG, typestore=STORE, callerid="/record_1")
        for name in ("/planner", "/base"):
            bag.write(channel, 11 * SECOND, STORE.serialize_ros1(log(name, "started"), LOG))
    return path


def wire(recording: robowidgets.Recording, name: str) -> Wire:
    widget = recording.wires().wires
    found: Wire = next(one for one in widget.wait().wires if one.name == name)
    widget.close()
    return found


def test_a_bag_of_ros_1_names_the_nodes_that_published(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "two.bag", {"/status": "/planner", "/status again": "/base", "/mode": None})
    with robowidgets.open(path) as recording:
        assert recording.publishers == {"/status": ("/base", "/planner"), "/mode": (), "/rosout": ("/record_1",)}
        status = wire(recording, "/status")
        assert (status.publishers, status.type, status.count) == (("/base", "/planner"), TEXT, 10)
        assert status.value == f'"4 of {"/base" if "base" in status.value else "/planner"}"'
        assert (wire(recording, "/mode").publishers, wire(recording, "/mode").rate) == ((), 1.0)
        assert wire(recording, "/rosout").publishers == ("/base", "/planner", "/record_1")
        widget = recording.wires().wires
        assert (widget.title, widget.wait().tells_nodes, widget.wait().note) == ("two.bag", True, "")
        assert repr(widget) == "<WiresWidget two.bag: 3 nodes, 3 topics, 0 parts of the notebook>"
        widget.close()


def test_a_damaged_bag_names_them_too(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "cut.bag", {"/status": "/planner"})
    path.write_bytes(path.read_bytes()[:-200])
    with robowidgets.open(path) as recording:
        assert recording.publishers["/status"] == ("/planner",)


def test_a_recording_without_names_says_so_and_shows_topics_alone() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        wiring = recording.wires().wires.wait()
        assert (wiring.nodes, wiring.note) == ((), "the recording has no names of nodes: it shows only topics")
        scan = next(one for one in wiring.wires if one.name == "/scan")
        assert scan.rate == pytest.approx(10, abs=0.1)
        assert scan.value.startswith("nearest ")


def test_the_last_message_of_a_topic_is_opened(tmp_path: Path) -> None:
    with robowidgets.open(write_bag(tmp_path / "one.bag", {"/status": "/planner"})) as recording:
        view = recording.wires()
        view.toggle("/status")
        assert view.messages["/status"]["data"] == "4 of /planner"
        view.close()


def test_a_closed_recording_has_no_wires() -> None:
    recording = robowidgets.open(robowidgets.SAMPLE)
    recording.close()
    with pytest.raises(RecordingError, match="closed"):
        recording.wires()
