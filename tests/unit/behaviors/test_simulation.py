"""Programs on the simulated robot, without a feed."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from robowidgets import feeds
from robowidgets.behaviors import Drive, simulate
from robowidgets.feeds import Feed
from robowidgets.simulator import Robot, World


@pytest.fixture
def feed() -> Iterator[Feed]:
    with feeds.simulator(wander=False) as opened:
        yield opened


def test_a_program_gets_the_topics_that_it_names(feed: Feed) -> None:
    seen: list[object] = []

    @feed.program(front="/scan", odometry="/odom")
    def go(front, odometry, scan):  # type: ignore[no-untyped-def]
        seen.append((len(front), odometry.pose is not None, len(scan)))
        return Drive(0.1)

    go.close()
    seen.clear()
    list(simulate(go, Robot(World.rooms(), seed=1), 1.0))
    assert set(seen) == {(541, True, 541)}


def test_a_topic_that_the_simulated_robot_does_not_have_is_refused(feed: Feed) -> None:
    @feed.program(imu="/imu")
    def go(imu):  # type: ignore[no-untyped-def]
        return Drive(imu.x)

    with pytest.raises(ValueError, match="asks for imu on /imu, but the simulated robot sends only /scan, /odom"):
        list(simulate(go, Robot(World.rooms(), seed=1), 1.0))
