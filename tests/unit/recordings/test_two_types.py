"""Recordings with messages of several types under one topic name."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets import conditions

from .sweeps import START_NS, scan

SCAN, TWIST, TEXT = "sensor_msgs/msg/LaserScan", "geometry_msgs/msg/Twist", "std_msgs/msg/String"


def write(folder: Path, *kinds: str, empty: str = "") -> Path:
    """Three seconds of /data, with a message of each type in each; messages of one type may be missing."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    zero = store.types["geometry_msgs/msg/Vector3"](1.0, 0.0, 0.0)
    raws = {
        SCAN: scan(START_NS, [0.2, 5.0]),
        TWIST: store.serialize_cdr(store.types[TWIST](zero, zero), TWIST),
        TEXT: store.serialize_cdr(store.types[TEXT]("hello"), TEXT),
    }
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {kind: writer.add_connection("/data", kind, typestore=store) for kind in kinds}
        for second in range(3):
            for kind in kinds:
                if kind != empty:
                    writer.write(connections[kind], START_NS + second * 10**9, raws[kind])
    return folder


@pytest.mark.parametrize(("first", "second"), [(SCAN, TWIST), (TWIST, SCAN)])
def test_the_first_type_is_shown_and_the_other_left_out_with_a_line(tmp_path: Path, first: str, second: str) -> None:
    with robowidgets.open(write(tmp_path / "x", first, second)) as recording:
        widget = "laser" if first == SCAN else "speed"
        assert [(topic.type, topic.widget) for topic in recording.topics] == [(first, widget), (second, None)]
        assert recording.problems == (f"/data: its messages of {first} are shown, messages of {second} are left out",)
        assert len(list(recording.samples("/data"))) == 3
        assert len({type(moment.sample) for moment in recording.samples()}) == 1
        player = recording.show()
        assert [view.choice.kind.name for view in player.views] == [widget]
        player.close()


def test_rerun_takes_the_first_type(tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    with robowidgets.open(write(tmp_path / "x", SCAN, TWIST)) as recording:
        assert Path(str(recording.to_rerun(tmp_path / "x.rrd"))).stat().st_size


def test_a_type_without_a_message_is_not_the_first(tmp_path: Path) -> None:
    with robowidgets.open(write(tmp_path / "x", TWIST, SCAN, empty=TWIST)) as recording:
        assert recording.problems == ()
        assert len(recording.scans()) == 3


def test_a_topic_is_searched_by_the_type_that_is_shown(tmp_path: Path) -> None:
    with robowidgets.open(write(tmp_path / "x", TEXT, TWIST)) as recording:
        for topics in (None, "/data"):
            found = recording.find(lambda moment: moment.speed.linear[0] > 0, topics)
            assert [span[:2] for span in found] == [(0, 2)]
        assert [span[:2] for span in recording.find(conditions.gap(0.5, topic="/data"))] == [
            (0, 1),
            (pytest.approx(1), 2),
        ]
