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


@pytest.mark.parametrize("rate", [3, 7, 10, 30])
def test_steps_come_at_their_rate_also_after_many_and_on_a_robot_that_has_run_before(rate: int) -> None:
    robot = Robot(World(), seed=1)
    robot.run(12.3)
    times = [step.time for step in simulate(lambda: Drive(0.1), robot, 20.0, rate=rate)]
    assert times == [round(number / rate, 9) for number in range(20 * rate)]
    assert robot.time == pytest.approx(32.3, abs=1e-9)
