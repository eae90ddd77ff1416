"""Which topic is meant where nobody names one."""

from __future__ import annotations

import pytest

from robowidgets.recordings.topics import Topic, UnnamedTopicError, likeliest, only


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
