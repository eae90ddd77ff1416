"""The topic that is meant if the call names none."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets.fleet import find
from robowidgets.recordings.topics import Topic, UnknownTopicError, UnnamedTopicError, likeliest, only

from ..recordings import recorded
from .executors import Here


def scans(**counts: int) -> list[Topic]:
    return [Topic(f"/{name}", "sensor_msgs/msg/LaserScan", n, 10.0, "laser", False, "") for name, n in counts.items()]


def test_of_several_scanners_the_one_that_is_made_of_others_is_not_meant() -> None:
    assert only("drive.bag", scans(scan=100, scan_filtered=100), "laser") == "/scan"
    with pytest.raises(UnnamedTopicError, match=r"several topics of laser scans \(/front, /rear\)"):
        only("drive.bag", scans(front=100, rear=100), "laser")
    with pytest.raises(UnnamedTopicError):
        only("drive.bag", scans(scan_filtered=100, scan_merged=100), "laser")


def test_the_one_that_is_preferred_is_meant() -> None:
    assert only("drive.bag", scans(front=100, rear=100), "laser", {"/rear", "/odom"}) == "/rear"


@pytest.mark.parametrize(
    ("topics", "meant"),
    [
        (scans(scan_merged=900, front=100, rear=90), "/front"),
        (scans(rear=100, front_laser=100), "/rear"),
        (scans(b=100, a=100), "/a"),
    ],
)
def test_the_likeliest_was_measured_has_most_messages_and_the_shortest_name(topics: list[Topic], meant: str) -> None:
    assert likeliest(topics).name == meant


@pytest.fixture
def with_pressure(tmp_path: Path) -> Callable[..., Path]:
    """Writes a recording with pressures, which no widget shows, and with other topics of speeds."""

    def written(*speeds: str) -> Path:
        types = {"/pressure": "std_msgs/msg/Float32", **dict.fromkeys(speeds, "geometry_msgs/msg/Twist")}
        messages = [
            (i / 10, topic, {"data": float(i)} if topic == "/pressure" else {}) for i in range(15) for topic in types
        ]
        return recorded.write(tmp_path / "run", types, messages)

    return written


def is_late(moment: Any) -> bool:
    return bool(moment["/pressure"].data > 11)


@pytest.mark.parametrize("topics", ["/pressure", "/press*", ["/pressure", "/cmd_vel"]])
def test_a_function_reads_a_topic_without_a_widget_that_is_named(
    with_pressure: Callable[..., Path], topics: str | list[str]
) -> None:
    path = with_pressure("/cmd_vel")
    hits = find(is_late, path, topics=topics, executor=Here())
    assert [(hit.start, hit.topic) for hit in hits] == [(1.2, "/pressure")]
    both = find(lambda moment: is_late(moment) and moment.speed.linear[0] == 0, path, topics=topics, executor=Here())
    assert [hit.start for hit in both] == [1.2]


def test_a_function_without_a_topic_to_read_is_reported(with_pressure: Callable[..., Path]) -> None:
    path = with_pressure()
    hits = find(is_late, path, executor=Here())
    why = "run has no topic that a widget shows: name the topics that the function reads, as in topics=['/pressure']"
    assert [one.problem for one in hits.unread] == [why]
    assert [hit.start for hit in find(is_late, path, topics="/pressure", executor=Here())] == [1.2]
    with (
        robowidgets.open(path) as recording,
        pytest.raises(UnknownTopicError, match="topics is empty: name the topics that the function reads"),
    ):
        recording.find(is_late, topics=[])
