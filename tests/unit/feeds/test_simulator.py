"""The built-in robot as a feed."""

from __future__ import annotations

import threading
import time

import pytest

from robowidgets import Scan, Speed, Touch, feeds
from robowidgets.feeds import FeedError
from robowidgets.simulator import Robot, World, real_time
from robowidgets.simulator.offers import speeds

from ..clocks import ManualClock
from ..waiting import wait_for


def test_it_tells_its_scans_speeds_and_bumpers_in_real_time() -> None:
    got: dict[str, list[object]] = {"/scan": [], "/odom": [], "/cmd_vel": [], "/bumper": []}
    began = time.monotonic()
    with feeds.simulator(hz=50.0) as feed:
        for topic, messages in got.items():
            feed.connect(topic, messages.append)
        wait_for(lambda: len(got["/scan"]) >= 5, "five scans have come")
        passed = time.monotonic() - began
    assert {topic: {type(m) for m in messages} for topic, messages in got.items()} == {
        "/scan": {Scan},
        "/odom": {Speed},
        "/cmd_vel": {Speed},
        "/bumper": {Touch},
    }
    stamps = [(scan.stamp_ns or 0) / 1e9 for scan in got["/scan"][:5] if isinstance(scan, Scan)]
    assert stamps[4] - stamps[0] == pytest.approx(0.4)
    assert stamps[4] <= passed + 0.02
    assert len(got["/odom"]) > 2 * len(got["/scan"])


def test_it_wanders_until_somebody_drives_and_again_when_nobody_does(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(real_time, "LET_GO", 0.2)
    robot = Robot(World([]))
    with feeds.simulator(robot, hz=100.0) as feed:
        wait_for(lambda: robot.command().linear[0] == 0.5, "it wanders")
        feed.driving = feeds.Driving(hold=0.1)
        feed.drive(-0.25, 0.5)
        wait_for(lambda: robot.command().values[::5] == (-0.25, 0.5), "it obeys")
        wait_for(lambda: robot.command().values[::5] == (0.0, 0.0), "it stops when nobody renews the speed")
        wait_for(lambda: robot.command().linear[0] == 0.5, "it wanders again")


def test_a_speed_that_is_sent_is_shown_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(real_time, "QUIET", 3600.0)
    robot, shown = Robot(World([])), list[float]()
    with feeds.simulator(robot, hz=100.0, wander=False) as feed:
        feed.connect("/cmd_vel", lambda speed: shown.append(speed.linear[0]))
        feed.driving = feeds.Driving(hold=0.2)
        feed.drive(0.25)
        assert feed.drive_status == ""
        wait_for(lambda: 0.25 in shown and shown[-1] == 0.0, "it stops")
    assert shown.count(0.25) == 1


def test_it_stands_still_until_somebody_drives_if_it_is_not_to_wander(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(real_time, "LET_GO", 0.05)
    robot = Robot(World([]))
    with feeds.simulator(robot, hz=100.0, wander=False) as feed:
        wait_for(lambda: robot.time > 0.5, "time passes")
        assert robot.pose == Robot(World([])).pose
        feed.drive(0.2)
        wait_for(lambda: robot.command().linear[0] == 0.2, "it obeys")
        wait_for(lambda: robot.command().linear[0] == 0.0, "it stops")
        since = robot.time
        wait_for(lambda: robot.time > since + 0.2, "time passes")
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


def test_what_nobody_asked_for_is_not_handed_on() -> None:
    scans: list[Scan] = []
    with feeds.simulator(hz=100.0) as feed:
        feed.connect("/scan", scans.append)
        wait_for(lambda: scans, "a scan has come")
        feed.disconnect("/scan")
        other: list[Speed] = []
        feed.connect("/odom", other.append)
        wait_for(lambda: other, "a speed has come")
        count = len(scans)
        wait_for(lambda: len(other) > 30, "time has passed")
        assert len(scans) == count


def test_it_may_be_closed_in_a_callback() -> None:
    feed = feeds.simulator(hz=100.0)
    feed.connect("/scan", lambda _: feed.close())
    wait_for(lambda: "robowidgets-simulator" not in {t.name for t in threading.enumerate()}, "its thread has ended")
    wait_for(lambda: feed.status == "the feed is closed", "it says so")


def test_a_robot_whose_listener_was_held_up_catches_up_with_a_second_and_no_more() -> None:
    clock, robot, held = ManualClock(), Robot(World([])), threading.Event()
    live = real_time.RealTime(robot, 50.0, False, [speeds], clock)
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
