"""The sonars of the simulated robot measure the nearest thing in their cones, one after the other."""

from __future__ import annotations

import pickle
from math import cos, degrees, inf, pi, radians, sin

import numpy as np
import pytest

from robowidgets.samples import Pose, Validity
from robowidgets.simulator import Robot, Sonars, World
from robowidgets.simulator._raycast import cast_rays
from robowidgets.sonar.row import SONAR

ONE = Sonars({"front": (0.0, 0.0, 0.0)}, field_of_view="30deg", noise=0.0, noise_share=0.0)
HERE = Pose(0.0, 0.0, 0.0)


def wall_at(distance: float, angle: float, half: float = 0.01) -> World:
    """A wall across a direction."""
    x, y = distance * cos(angle), distance * sin(angle)
    return World(walls=[(x - half * sin(angle), y + half * cos(angle), x + half * sin(angle), y - half * cos(angle))])


class TestNearest:
    def test_covers_all_rays_in_the_cone(self) -> None:
        rng = np.random.default_rng(7)
        for _ in range(60):
            walls = rng.uniform(-4, 4, (6, 4))
            discs = np.column_stack((rng.uniform(-4, 4, (4, 2)), rng.uniform(0.05, 0.6, 4)))
            world = World(walls=walls, obstacles=discs)
            robot = Pose(*rng.uniform(-1, 1, 2), rng.uniform(-pi, pi))
            rays = robot.yaw + np.linspace(-1, 1, 20_001) * ONE.field_of_view / 2
            dense = float(np.min(np.minimum(*cast_rays(world, robot.x, robot.y, rays))))
            assert ONE.nearest(world, robot, "front") == pytest.approx(dense, abs=2e-3)

    @pytest.mark.parametrize(
        ("angle", "is_seen"), [(0.0, True), (14.0, True), (-14.0, True), (16.5, False), (180, False)]
    )
    def test_is_anywhere_in_the_width_of_the_cone_and_nowhere_else(self, angle: float, is_seen: bool) -> None:
        nearest = ONE.nearest(wall_at(1.5, radians(angle)), HERE, "front")
        assert nearest == (pytest.approx(1.5, abs=1e-3) if is_seen else inf)

    def test_counts_from_where_the_sensor_is_mounted(self) -> None:
        ring = Sonars({"left": (0.1, 0.2, pi / 2)})
        world = World(walls=[(-5, 2, 5, 2)])
        assert ring.nearest(world, HERE, "left") == pytest.approx(1.8)
        assert ring.nearest(world, Pose(0.0, 0.0, pi), "left") == inf
        assert ring.nearest(world, Pose(0.0, 0.5, 0.0), "left") == pytest.approx(1.3)


@pytest.mark.parametrize(
    ("distance", "measured", "validity"),
    [
        (0.05, -inf, Validity.TOO_CLOSE),
        (0.5, 0.5, Validity.READING),
        (4.9, 4.9, Validity.READING),
        (5.5, inf, Validity.NOTHING_IN_RANGE),
    ],
)
def test_values_that_are_not_distances_follow_rep_117(distance: float, measured: float, validity: Validity) -> None:
    reading = ONE.measure(wall_at(distance, 0.0, 1.0), HERE, "front", np.random.default_rng(0), 7)
    assert (reading.range, reading.validity, reading.stamp_ns) == (measured, validity, 7)
    assert (reading.radiation, reading.frame_id, reading.pose) == ("ultrasound", "sonar_front", HERE)
    assert degrees(reading.field_of_view) == pytest.approx(30)


class TestPioneer:
    def test_has_sixteen_at_its_two_ends(self) -> None:
        ring = Robot(World(), model="pioneer").sonars.poses
        assert [*ring] == [f"{end}_{i}" for end in ("front", "rear") for i in range(8)]
        yaws = [round(degrees(yaw)) for _, _, yaw in ring.values()]
        assert yaws == [90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90]
        assert all((x > 0) == name.startswith("front") for name, (x, _, _) in ring.items())
        assert all(x * x + y * y <= Robot(World(), model="pioneer").radius ** 2 for x, y, _ in ring.values())

    def test_measures_the_room_round_it(self) -> None:
        square = [(-2, -2, 2, -2), (2, -2, 2, 2), (2, 2, -2, 2), (-2, 2, -2, -2)]
        robot = Robot(World(walls=square), model="pioneer", seed=2)
        away = {name: robot.sonar(name).distance for name in robot.sonars.poses}
        assert away["front_0"] == pytest.approx(2 - 0.136, abs=0.05)
        assert away["front_3"] == pytest.approx(2 - 0.166, abs=0.05)
        assert away["rear_4"] == pytest.approx(2 - 0.254, abs=0.05)

    def test_each_has_its_turn_about_three_times_a_second(self) -> None:
        robot = Robot(World.rooms(), model="pioneer", seed=3)
        readings: dict[str, list[object]] = {name: [] for name in robot.sonars.poses}
        for _ in range(160):
            robot.step(0.02)
            fresh = 0
            for name, seen in readings.items():
                reading = robot.sonar(name)
                if not seen or seen[-1] is not reading:
                    seen.append(reading)
                    fresh += len(seen) > 1
            assert fresh <= 2, "they measure one after the other"
        assert {len(seen) for seen in readings.values()} <= {10, 11}

    def test_the_same_seed_gives_the_same_readings_also_after_a_pickle(self) -> None:
        def readings(seed: int) -> list[float]:
            robot = pickle.loads(pickle.dumps(Robot(World.rooms(), model="pioneer", seed=seed)))
            found = []
            for _ in range(10):
                robot.step(0.1)
                found += [robot.sonar(name).range for name in robot.sonars.poses]
            return found

        assert readings(1) == readings(1)
        assert readings(1) != readings(2)

    def test_offers_a_topic_for_each(self) -> None:
        robot = Robot(World.rooms(), model="pioneer")
        offers = SONAR.simulated(robot)
        assert [offer.topic for offer in offers[::8]] == ["/sonar/front_0", "/sonar/rear_0"]
        assert {offer.type for offer in offers} == {"sensor_msgs/msg/Range"}
        assert offers[3].read() is robot.sonar("front_3")
        assert SONAR.simulated(Robot(World.rooms())) == []


def test_a_missing_sonar_is_named_with_the_existing_ones() -> None:
    with pytest.raises(KeyError, match="the robot has no sonar 'front_0'; it has none; the model 'pioneer' has some"):
        Robot(World()).sonar("front_0")
    with pytest.raises(KeyError, match="the robot has no sonar 'left'; there are: front_0, "):
        Robot(World(), model="pioneer").sonar("left")


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"poses": {"a": (1, 2)}}, ValueError, r"^poses\['a'\]: expected \(x, y, yaw\), got 2 values"),
        ({"field_of_view": 0}, ValueError, r"^field_of_view: expected radians above 0, at most pi, got 0.0"),
        ({"max_range": 0.05}, ValueError, r"^max_range: expected metres above min_range \(0.1\), got 0.05"),
        ({"rate": 0}, ValueError, r"^rate: expected readings per second, above 0 and at most 1000, got 0"),
        ({"noise": "much"}, TypeError, r"^noise: expected a number, got 'much'"),
    ],
)
def test_values_of_no_use_are_refused(given: dict, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        Sonars(**given)
