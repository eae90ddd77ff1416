"""The built-in robot as a feed."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from robowidgets import Scan, Speed, Touch, feeds
from robowidgets.feeds import Feed, FeedError
from robowidgets.feeds.simulator import Simulated
from robowidgets.simulator import Robot, World, real_time
from robowidgets.speed.row import SPEED

from ..clocks import ManualClock
from ..waiting import wait_for


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@contextmanager
def simulated(clock: ManualClock, wander: bool = False) -> Iterator[tuple[Robot, Feed]]:
    """A robot in an empty world, and its feed: 50 steps a second of a clock that is moved by hand."""
    robot = Robot(World([]))
    with Feed(Simulated(robot, 50.0, wander, False, clock), clock=clock) as feed:
        yield robot, feed


def test_it_tells_its_scans_speeds_and_bumpers_as_time_passes(clock: ManualClock) -> None:
    got: dict[str, list[Any]] = {}
    with simulated(clock, wander=True) as (_, feed):
        for topic in ("/scan", "/odom", "/cmd_vel", "/bumper"):
            got[topic] = []
            feed.connection.attach(topic, got[topic].append, lambda _: None)
        clock.advance(1.01)
    assert {topic: {type(m) for m in messages} for topic, messages in got.items()} == {
        "/scan": {Scan},
        "/odom": {Speed},
        "/cmd_vel": {Speed},
        "/bumper": {Touch},
    }
    assert len(got["/odom"]) == pytest.approx(50, abs=1)
    stamps = [scan.stamp_ns / 1e9 for scan in got["/scan"]]
    assert len(stamps) == pytest.approx(10, abs=1)
    assert stamps[4] - stamps[0] == pytest.approx(0.4)


def test_it_wanders_until_it_is_driven_and_again_afterwards(clock: ManualClock) -> None:
    with simulated(clock, wander=True) as (robot, feed):
        clock.advance(0.1)
        assert robot.command().linear[0] == 0.5
        feed.driving = feeds.Driving(hold=0.1)
        feed.drive(-0.25, 0.5)
        clock.advance(0.05)
        assert robot.command().values[::5] == (-0.25, 0.5)
        clock.advance(0.1)
        assert robot.command().values[::5] == (0.0, 0.0), "no program renews the speed"
        clock.advance(real_time.LET_GO - 0.1)
        assert robot.command().values[::5] == (0.0, 0.0)
        clock.advance(0.1)
        assert robot.command().linear[0] == 0.5, "it wanders again"


@pytest.mark.parametrize("process", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_it_does_not_wander_while_stop_is_latched(process: bool) -> None:
    with feeds.simulator(Robot(World([])), process=process, hz=50.0) as feed:
        wait_for(lambda: feed.robot.command().linear[0] == 0.5, "it wanders")
        feed.stopped = True
        wait_for(lambda: feed.robot.command().linear[0] == 0.0, "it stops")
        until = feed.robot.time + real_time.LET_GO + 0.5
        wait_for(lambda: feed.robot.time > until, "it would wander again")
        assert feed.robot.command().linear[0] == 0.0
        feed.stopped = False
        wait_for(lambda: feed.robot.command().linear[0] == 0.5, "it wanders again")


def test_a_speed_that_is_sent_is_shown_once(clock: ManualClock) -> None:
    shown = list[float]()
    with simulated(clock) as (_, feed):
        feed.connection.attach("/cmd_vel", lambda speed: shown.append(speed.linear[0]), lambda _: None)
        feed.driving = feeds.Driving(hold=0.2)
        clock.advance(0.1)
        shown.clear()
        feed.drive(0.25)
        assert feed.drive_status == ""
        clock.advance(0.2 + real_time.QUIET - 0.1)
    assert shown == [0.25, 0.0]


def test_it_stands_still_until_it_is_driven_if_it_does_not_wander(clock: ManualClock) -> None:
    with simulated(clock) as (robot, feed):
        clock.advance(0.5)
        assert robot.time > 0.4
        assert robot.pose == Robot(World([])).pose
        feed.driving = feeds.Driving(hold=0.5)
        feed.drive(0.2)
        clock.advance(0.1)
        assert robot.command().linear[0] == 0.2
        clock.advance(0.5)
        assert robot.command().linear[0] == 0.0
        clock.advance(2 * real_time.LET_GO)
        assert robot.command().linear[0] == 0.0
    with pytest.raises(TypeError, match="wander: expected True or False, got 1"):
        feeds.simulator(wander=1)  # type: ignore[arg-type]


def test_it_bumps_into_things() -> None:
    wall = World([(0.5, -2.0, 0.5, 2.0)])
    touches: list[Touch] = []
    with feeds.simulator(Robot(wall), hz=100.0) as feed:
        feed.connect("/bumper", touches.append)
        wait_for(lambda: any(touch.touched["center"] for touch in touches), "it bumps into the wall")


def test_its_topics_are_there_at_once() -> None:
    for _ in range(20):
        with feeds.simulator() as feed:
            assert [topic.name for topic in feed.topics] == ["/scan", "/odom", "/cmd_vel", "/bumper"]


def test_a_robot_whose_listener_was_held_up_catches_up_with_a_second_and_no_more() -> None:
    clock, robot, held = ManualClock(), Robot(World([])), threading.Event()
    live = real_time.RealTime(robot, 50.0, False, [SPEED.simulated], clock)
    live.want({"/odom"})
    held.set()
    running = clock.beside(lambda: live.run(lambda *_: held.wait()), "running")
    clock.advance(2.0)
    assert robot.time == pytest.approx(2.0, abs=0.03)
    held.clear()
    clock.advance(10.0, hangs=("running",))
    before = robot.time
    held.set()
    clock.settle()
    assert robot.time == pytest.approx(before + 1.0, abs=0.05)
    clock.advance(2.0)
    assert robot.time == pytest.approx(before + 3.0, abs=0.05)
    live.end()
    running.join()


def test_words_for_what_it_cannot_do() -> None:
    with feeds.simulator() as feed:
        feed.driving = feeds.Driving(topic="/base")
        with pytest.raises(FeedError, match="the simulated robot listens to /cmd_vel, not to /base"):
            feed.drive(0.1)
    with pytest.raises(TypeError, match="robot: expected a name such as 'turtlebot3', or a Robot, got 2"):
        feeds.simulator(2)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="model: expected plain, turtlebot3, kobuki, create3, pioneer, pr2, got 'R2'"):
        feeds.simulator("R2")
    with pytest.raises(ValueError, match="hz: expected steps a second, above 0 and at most 1000, got 0"):
        feeds.simulator(hz=0)
