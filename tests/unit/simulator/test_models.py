"""Robots and scanners with the sizes, limits, messages and quirks of real ones."""

from __future__ import annotations

from dataclasses import replace
from math import cos, inf, nan, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import Validity, feeds
from robowidgets.feeds import FeedError
from robowidgets.messages import to_touch
from robowidgets.simulator import Robot, Scanner, View, World, room, wander
from robowidgets.simulator._models import MODELS
from robowidgets.simulator._scanners import SCANNERS
from robowidgets.simulator.view import HEADER

from ..waiting import wait_for

FRONT = World([(2.0, -9.0, 2.0, 9.0)])
"""A wall 2 m ahead of (0, 0), and nothing else."""
EXACT: dict[str, Any] = {"noise": 0.0, "noise_share": 0.0, "resolution": 0.0, "dropout": 0.0}


@pytest.mark.parametrize("name", ["turtlebot3", "kobuki", "create3", "pr2"])
def test_a_robot_keeps_its_limits_and_finds_its_way(name: str) -> None:
    robot, motors = Robot(room("house"), model=name), MODELS[name].motors
    robot.drive(9.0, 9.0)
    robot.step(5.0)
    assert robot.speed().angular[2] == motors.max_angular
    places = set()
    for _ in wander(robot, linear=9.0):
        robot.step(0.1)
        assert abs(robot.speed().linear[0]) <= motors.max_linear
        places.add((round(robot.pose.x), round(robot.pose.y)))
        if robot.time > 40:
            break
    assert len(places) > 2
    assert robot.radius == MODELS[name].radius


@pytest.mark.parametrize(("name", "angle", "sensor"), [
    ("turtlebot3", 0, "front"), ("turtlebot3", 180, "back"), ("kobuki", 60, "left"), ("kobuki", 0, "center"),
    ("kobuki", -60, "right"), ("create3", 70, "left"), ("create3", 35, "front left"), ("create3", 0, "front center"),
    ("create3", -35, "front right"), ("create3", -70, "right"),
])  # fmt: skip
def test_a_bumper_is_reported_in_the_messages_of_the_robot(name: str, angle: float, sensor: str) -> None:
    model = MODELS[name]
    reach = model.radius + 0.301
    post = (reach * cos(radians(angle)), reach * sin(radians(angle)), 0.3)
    robot = Robot(World(obstacles=[post]), model=name)
    touch = to_touch(model.to_message(robot.touch()))
    assert [name for name, state in touch.touched.items() if state] == [sensor]
    free = to_touch(model.to_message(Robot(World(), model=name).touch()))
    assert not any(free.touched.values())


def test_the_base_of_the_pr2_drives_sideways_and_others_do_not() -> None:
    robot = Robot(World(), model="pr2")
    robot.drive(0.0, 0.0, 0.5)
    robot.step(3.0)
    assert robot.speed().linear[1] == pytest.approx(0.5)
    assert robot.pose.y > 1.0
    words = r"^lateral: 0.5 m/s, but this robot does not move sideways; model='pr2' does$"
    with pytest.raises(ValueError, match=words):
        Robot(World(), model="kobuki").drive(0.0, 0.0, 0.5)
    robot = Robot(World([(-9.0, 0.6, 9.0, 0.6)]), model="pr2")
    robot.drive(0.3, 0.0, 1.0)
    robot.step(2.0)
    assert robot.pose.y == pytest.approx(0.6 - robot.radius)
    assert robot.speed().linear[:2] == pytest.approx((0.3, 0.0)), "it slides along a wall"


def test_each_scanner_has_the_geometry_of_its_headers() -> None:
    rng = np.random.default_rng(1)
    scans = {name: scanner.measure(FRONT, 0.0, 0.0, 0.0, rng) for name, scanner in SCANNERS.items()}
    pr2, lds, urg, neato = (scans[name] for name in ("utm30lx", "lds01", "urg04lx", "neato"))
    assert (len(pr2), pr2.angles[635]) == (1040, pytest.approx(radians(28.75)))
    assert (len(lds), lds.angles[0], lds.angles[90]) == (360, 0.0, pytest.approx(pi / 2))
    assert (len(urg), urg.angle_increment) == (681, pytest.approx(0.006135923, abs=2e-6))
    assert neato.angles[360] - neato.angles[0] == pytest.approx(2 * pi, abs=1e-4)
    for scan in scans.values():
        assert scan.distance(("-2deg", "2deg"), percentile=50) == pytest.approx(2.0, abs=0.1)


def test_nothing_and_failures_are_encoded_as_each_scanner_does() -> None:
    rng = np.random.default_rng(1)
    found = {
        name: {
            round(float(value), 4)
            for value in replace(scanner, dropout=0.2).measure(World(), 0.0, 0.0, 0.0, rng).ranges
        }
        for name, scanner in SCANNERS.items()
    }
    assert found["utm30lx"] == {0.001}
    assert found["lds01"] == {0.0}
    assert found["urg04lx"] == {0.0, 0.006, 0.007}
    assert found["rplidar_a1"] == found["neato"] == {inf}
    close = Scanner(ray_count=1, field_of_view=0.0, range_min=3.0, too_close=0.0, **EXACT)
    assert close.measure(FRONT, 0.0, 0.0, 0.0, rng).ranges.tolist() == [0.0]


def test_counts_and_times_of_a_scanner_change_but_follow_from_the_seed() -> None:
    def drive(seed: int) -> list[tuple[int, int]]:
        robot = Robot(FRONT, scanner="rplidar_a1", seed=seed)
        seen: dict[int, int] = {}
        for _ in range(40):
            robot.step(0.1)
            seen[robot.scan().stamp_ns or 0] = len(robot.scan())
        return list(seen.items())

    stamps, counts = zip(*drive(1), strict=True)
    assert len(set(counts)) > 5
    assert all(705 <= count <= 735 for count in counts)
    periods = np.diff(stamps) / 1e9 * 5.5
    assert periods.min() < 0.98
    assert periods.max() > 1.02
    assert drive(1) == drive(1) != drive(2)


def test_noise_may_grow_with_distance() -> None:
    flat = Scanner(ray_count=20_000, field_of_view=1e-6, noise=0.0, noise_share=0.05, resolution=0.0, dropout=0.0)
    ranges = flat.measure(FRONT, 0.0, 0.0, 0.0, np.random.default_rng(1)).ranges.astype(float)
    assert ranges.std() == pytest.approx(0.1, rel=0.03)


def test_a_scanner_has_the_given_mount_and_may_hang_upside_down() -> None:
    rng = np.random.default_rng(1)
    ahead = Scanner(ray_count=1, field_of_view=0.0, mount=(0.5, 0.0, 0.0), **EXACT)
    assert ahead.measure(FRONT, 0.0, 0.0, 0.0, rng).ranges.tolist() == [1.5]
    behind = replace(ahead, mount=(0.0, 0.0, pi))
    assert behind.measure(FRONT, 0.0, 0.0, pi, rng).ranges.tolist() == [2.0]
    post = World(obstacles=[(0.0, 2.0, 0.5)])
    upright = Scanner(ray_count=5, field_of_view=pi, **EXACT)
    hanging = replace(upright, upside_down=True)
    assert upright.measure(post, 0.0, 0.0, 0.0, rng).nearest().index == 4
    assert hanging.measure(post, 0.0, 0.0, 0.0, rng).nearest().index == 0
    robot = Robot(post, scanner=replace(hanging, mount=(0.1, 0.0, 0.0)))
    header = HEADER.unpack_from(View(robot).get_state()["_frame"])
    assert header[5:10] == pytest.approx((0.1, 0.0, 0.0, pi / 2, -pi / 4)), "the view shows the true ray directions"


def test_a_scan_of_a_robot_has_the_angles_of_the_robot_however_its_scanner_stands() -> None:
    post = World(obstacles=[(0.0, 2.0, 0.5)])
    upright = Scanner(ray_count=72, field_of_view=2 * pi, **EXACT)
    expected = Robot(post, scanner=upright).scan()
    for scanner in (replace(upright, mount=(0.0, 0.0, 2.0)), replace(upright, mount=(0.0, 0.0, 2.0), upside_down=True)):
        scan = Robot(post, scanner=scanner).scan()
        assert scan.nearest().index != expected.nearest().index
        assert scan.distance("left") == pytest.approx(expected.distance("left"), abs=0.02)
        assert scan.distance("front") == inf
        assert scan.unmounted().angle_min == pytest.approx(-pi), "a message has the scanner's angles"


@pytest.mark.parametrize(("given", "error", "words"), [
    ({"failed": ()}, ValueError, "failed: expected one number or more, got none"),
    ({"failed": ("x",)}, TypeError, "failed: expected a number, got 'x'"),
    ({"nothing": "inf"}, TypeError, "nothing: expected a number, got 'inf'"),
    ({"count_spread": 541}, ValueError, "count_spread: expected fewer rays than ray_count, got 541"),
    ({"period_spread": 0.6}, ValueError, "period_spread: expected a share from 0 to 0.5, got 0.6"),
    ({"noise_share": -1}, ValueError, "noise_share: expected a share of the distance, 0 or more, got -1"),
    ({"mount": (0, 0)}, ValueError, "mount: expected .x, y, yaw., got 2 values"),
    ({"first_angle": nan}, ValueError, "first_angle: expected a finite number of radians, got nan"),
])  # fmt: skip
def test_words_for_a_scanner_that_cannot_be(given: dict[str, Any], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        Scanner(**given)


def test_words_for_names_that_there_are_not() -> None:
    with pytest.raises(ValueError, match=r"scanner: expected a Scanner, or utm30lx, lds01, .*, got 'sick'"):
        Robot(FRONT, scanner="sick")
    with pytest.raises(ValueError, match="model: expected plain, turtlebot3, kobuki, create3, pioneer, pr2, got 'nao'"):
        Robot(FRONT, model="nao")


def test_the_feed_of_a_robot_speaks_its_dialect_and_a_widget_reads_it() -> None:
    raw: list[Any] = []
    with feeds.simulator("create3", scanner="lds01", hz=100.0) as feed:
        assert {topic.name: topic.widget for topic in feed.topics}["/bumper"] == "touch"
        feed.connect("/bumper", raw.append, raw=True)
        wait_for(lambda: raw, "a message has come")
        scan = next(feed.scans("/scan", timeout=60))
    assert raw[0].keys() == {"detections"}
    assert len(scan) == 360
    assert scan.counts[Validity.NOTHING_IN_RANGE] == 0
    with feeds.simulator("pr2", hz=100.0, wander=False) as feed:
        assert "/bumper" not in [topic.name for topic in feed.topics]
        twist = {"linear": {"x": 0.0, "y": 0.4, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
        feed.connection.middleware.publish("/cmd_vel", "geometry_msgs/msg/Twist", twist)
        wait_for(lambda: feed.robot.speed().linear[1] > 0.1, "it drives sideways")


def test_a_feed_of_the_pr2_drives_sideways_and_feeds_of_other_robots_refuse(tmp_path: Path) -> None:
    with feeds.simulator("pr2", hz=100.0, wander=False) as feed:
        assert feed.driving.max_lateral == 0.5
        feed.driving = feeds.Driving(max_lateral=0.5, hold=3600.0)
        with feed.record(tmp_path / "run.mcap") as recorder:
            feed.drive(lateral=-0.3)
            wait_for(lambda: feed.robot.speed().linear[1] < -0.1, "it drives to the right")
            wait_for(lambda: recorder.written["/cmd_vel"], "the speed is written")
    with robowidgets.open(tmp_path / "run.mcap") as recording:
        assert -0.3 in recording.speeds("/cmd_vel").values[:, 1]
    with feeds.simulator("turtlebot3", wander=False) as feed:
        with pytest.raises(FeedError, match=r"lateral is 0.07 m/s, but this robot is not known to move sideways"):
            feed.drive(0.1, lateral=0.07)
        feed.driving = feeds.Driving(max_lateral=0.3, hold=3600.0)
        with pytest.raises(
            FeedError, match=r"the simulated robot does not move sideways; feeds.simulator\('pr2'\) does"
        ):
            feed.drive(0.1, lateral=0.07)
        assert not any(feed.robot.command().values)
