import pickle
from math import cos, hypot, inf, nan, pi, sin

import numpy as np
import pytest

from robowidgets import Speed, TouchMode
from robowidgets.simulator import Motors, Robot, Scanner, World, wander

WALL = World(walls=[(2.0, -50.0, 2.0, 50.0)])
SPARSE = Scanner(ray_count=8)


def touched(robot):
    return {name for name, state in robot.touch().touched.items() if state}


def run(robot, seconds, dt=0.05):
    for _ in range(round(seconds / dt)):
        robot.step(dt)


def gap_to_nearest(world, x, y):
    """Metres to the nearest wall or obstacle, one by one."""
    gaps = [hypot(cx - x, cy - y) - radius for cx, cy, radius in world.obstacles]
    for x1, y1, x2, y2 in world.walls:
        t = ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / hypot(x2 - x1, y2 - y1) ** 2
        t = min(1.0, max(0.0, t))
        gaps.append(hypot(x1 + t * (x2 - x1) - x, y1 + t * (y2 - y1) - y))
    return min(gaps)


def test_time_passes_in_steps_only():
    robot = Robot(World(), scanner=SPARSE)
    robot.scan(), robot.speed(), robot.touch()
    assert robot.time == 0.0
    run(robot, 1.0, dt=0.025)
    assert robot.time == 1.0


def test_a_pickled_robot_goes_on_alike_and_one_that_is_restored_sees_the_same():
    robot = Robot(World.rooms(), seed=3, model="kobuki")
    robot.drive(0.4, 0.5)
    run(robot, 1.0)
    first = robot.scan().ranges.tobytes()
    copied = pickle.loads(pickle.dumps(robot))
    assert copied.scan().ranges.tobytes() == first
    assert copied.model is robot.model
    follower = Robot(World.rooms(), seed=3, model="kobuki")
    follower.scan()
    told = []
    follower.observe(lambda: told.append(follower.pose))
    for one in (robot, copied):
        run(one, 1.0)
    follower.restore(robot.snapshot())
    assert robot.pose == copied.pose == follower.pose == told[0]
    seen = {one.scan().ranges.tobytes() for one in (robot, copied, follower)}
    assert len(seen) == 1
    assert first not in seen
    assert not copied.scan().ranges.flags.writeable


def test_driving_straight_covers_what_the_acceleration_allows():
    robot = Robot(World(), (1.0, 2.0, pi / 2), motors=Motors(linear_acceleration=0.5))
    robot.drive(0.5, 0.0)
    run(robot, 3.0)
    assert robot.pose.x == pytest.approx(1.0)
    assert robot.pose.y - 2.0 == pytest.approx(0.5 * 0.5 * 1.0**2 + 0.5 * 2.0, abs=0.005)
    assert robot.speed() == Speed((0.5, 0, 0), (0, 0, 0), 3_000_000_000, "base_link", robot.odometry)


def test_turning_is_counter_clockwise_and_yaw_stays_within_half_a_turn():
    robot = Robot(World())
    robot.drive(0.0, 1.0)
    run(robot, 1.0)
    assert robot.pose.yaw == pytest.approx(1.0 - 0.5 / 4, abs=0.01)
    run(robot, 4.0)
    assert robot.pose.yaw == pytest.approx(5.0 - 0.5 / 4 - 2 * pi, abs=0.01)
    assert robot.pose[:2] == (0.0, 0.0)


def test_a_curve_is_a_circle_of_speed_over_turn_rate():
    robot = Robot(World(), motors=Motors(linear_acceleration=1e6, angular_acceleration=1e6))
    robot.drive(0.5, 1.0)
    run(robot, pi, dt=pi / 100)
    assert robot.pose.x == pytest.approx(0.0, abs=1e-3)
    assert robot.pose.y == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("seed", range(5))
def test_acceleration_limits_hold_in_every_step(seed):
    rng = np.random.default_rng(seed)
    robot = Robot(World(), motors=Motors(linear_acceleration=0.7, angular_acceleration=2.0))
    before = robot.speed().values
    for _ in range(200):
        if rng.random() < 0.2:
            robot.drive(*rng.uniform(-3, 3, 2))
        dt = rng.uniform(0.001, 0.2)
        robot.step(dt)
        now = robot.speed().values
        assert abs(now[0] - before[0]) <= 0.7 * dt + 1e-9
        assert abs(now[5] - before[5]) <= 2.0 * dt + 1e-9
        assert abs(now[0]) <= robot.motors.max_linear
        assert abs(now[5]) <= robot.motors.max_angular
        before = now


def test_the_command_is_what_was_asked_for_even_when_it_is_too_much():
    robot = Robot(World())
    robot.drive(9.0, -9.0)
    run(robot, 3.0)
    assert robot.command().values == (9.0, 0, 0, 0, 0, -9.0)
    assert robot.speed().values == (1.2, 0, 0, 0, 0, -2.0)


def test_a_wall_ahead_stops_the_robot_and_its_wheels():
    robot = Robot(WALL)
    robot.drive(0.5, 0.0)
    run(robot, 8.0)
    assert robot.pose.x == pytest.approx(2.0 - robot.radius, abs=1e-6)
    assert robot.speed().linear[0] == 0.0
    assert touched(robot) == {"center"}


def test_a_pressed_bumper_stays_pressed_until_the_robot_backs_up():
    robot = Robot(WALL, (1.5, 0.0, 0.0))
    robot.drive(0.5, 0.0)
    run(robot, 3.0)
    robot.drive(0.0, 0.0)
    run(robot, 2.0)
    assert touched(robot) == {"center"}
    robot.drive(-0.2, 0.0)
    run(robot, 0.3)
    assert touched(robot) == set()


@pytest.mark.parametrize(("yaw", "bumper"), [(0.8, "right"), (-0.8, "left")])
def test_a_slanting_hit_presses_that_side_and_slides_along(yaw, bumper):
    robot = Robot(WALL, (1.5, 0.0, yaw))
    robot.drive(0.4, 0.0)
    run(robot, 3.0)
    assert touched(robot) == {bumper}
    assert robot.pose.x == pytest.approx(2.0 - robot.radius, abs=1e-6)
    assert robot.pose.y * yaw > 0.2
    assert 0 < robot.speed().linear[0] < 0.4


def test_driving_backward_into_a_wall_stops_without_a_bumper():
    robot = Robot(WALL, (1.0, 0.0, pi))
    robot.drive(-0.5, 0.0)
    run(robot, 5.0)
    assert robot.pose.x == pytest.approx(2.0 - robot.radius, abs=1e-6)
    assert robot.speed().linear[0] == pytest.approx(0.0, abs=1e-9)
    assert touched(robot) == set()


@pytest.mark.parametrize("max_linear", [1.0, 30.0])
@pytest.mark.parametrize("dt", [0.01, 1.0, 20.0])
def test_no_wall_is_passed_at_full_speed_however_long_the_step(max_linear, dt):
    robot = Robot(WALL, motors=Motors(max_linear=max_linear, linear_acceleration=1e6))
    robot.drive(max_linear, 0.0)
    for _ in range(max(1, round(3 / dt))):
        robot.step(dt)
    assert robot.pose.x == pytest.approx(1.82, abs=1e-6)


def test_a_gap_too_narrow_holds_the_robot_and_presses_both_sides():
    robot = Robot(World(obstacles=[(1.0, 0.25, 0.15), (1.0, -0.25, 0.15)]))
    robot.drive(1.0, 0.0)
    run(robot, 5.0)
    assert robot.pose.x < 1.0
    assert touched(robot) == {"left", "right"}


@pytest.mark.parametrize("seed", range(8))
def test_a_robot_is_never_inside_anything_and_never_out_of_the_house(seed):
    rng = np.random.default_rng(seed)
    house = World.rooms()
    robot = Robot(house, (0.0, 0.0, rng.uniform(-pi, pi)), scanner=SPARSE, seed=seed)
    contacts = 0
    for _ in range(300):
        if rng.random() < 0.05:
            robot.drive(rng.uniform(-0.6, 1.2), rng.uniform(-1.0, 1.0))
        robot.step(rng.choice([0.01, 0.05, 0.3]))
        gap = gap_to_nearest(house, *robot.pose[:2]) - robot.radius
        assert gap > -1e-8
        assert abs(robot.pose.x) < 7
        assert abs(robot.pose.y) < 4.5
        contacts += gap < 1e-3
    assert contacts > 5


@pytest.mark.parametrize("seed", range(4))
def test_a_collision_never_gives_speed(seed):
    rng = np.random.default_rng(seed)
    robot = Robot(World.rooms(), (0.0, 0.0, rng.uniform(-pi, pi)), scanner=SPARSE)
    robot.drive(0.8, 0.1)
    before = 0.0
    for _ in range(1000):
        x, y, _ = robot.pose
        robot.step(0.01)
        assert hypot(robot.pose.x - x, robot.pose.y - y) <= 0.8 * 0.01 + 1e-9
        assert 0 <= robot.speed().linear[0] <= before + 1.0 * 0.01 + 1e-9
        before = robot.speed().linear[0]


def test_scans_come_at_the_scanners_rate():
    robot = Robot(World.rooms(), scanner=Scanner(rate=10.0))
    robot.drive(0.5, 0.5)
    scans = [robot.scan()]
    for _ in range(100):
        robot.step(0.01)
        if robot.scan() is not scans[-1]:
            scans.append(robot.scan())
    assert [scan.stamp_ns for scan in scans] == [i * 100_000_000 for i in range(11)]
    assert robot.scan() is robot.scan()


def test_a_scan_shows_the_world_from_where_the_robot_was_at_its_stamp():
    robot = Robot(WALL, scanner=Scanner(ray_count=1, field_of_view=0, rate=2.0, noise=0, resolution=0, dropout=0))
    robot.drive(1.0, 0.0)
    robot.step(0.5)
    there = robot.pose.x
    robot.step(0.4)
    assert robot.scan().stamp_ns == 500_000_000
    assert robot.scan().ranges[0] == pytest.approx(2.0 - there, abs=1e-6)


def test_a_long_step_skips_scans_and_keeps_the_newest():
    robot = Robot(World.rooms(), scanner=Scanner(rate=40.0))
    robot.step(1.0)
    assert robot.scan().stamp_ns == 1_000_000_000


def diary(seed, ask=True):
    robot = Robot(World.rooms(), (0.2, -0.85, 0.5), seed=seed)
    said = []
    for _ in wander(robot, linear=0.8):
        robot.step(0.05)
        if ask or robot.time > 14.9:
            said = [
                robot.scan().ranges.tobytes(),
                robot.speed(),
                robot.command(),
                dict(robot.touch().touched),
                robot.pose,
            ]
        if robot.time > 15:
            return said
    return None


def test_the_same_seed_gives_the_same_bytes():
    assert diary(3) == diary(3)


def test_what_a_scan_shows_does_not_depend_on_how_often_it_was_asked_for():
    assert diary(3) == diary(3, ask=False)


def test_another_seed_gives_other_noise():
    assert diary(3)[0] != diary(4)[0]


def test_touch_says_how_every_bumper_stands():
    touch = Robot(World()).touch()
    assert touch.mode is TouchMode.LEVEL
    assert touch.sensors == ("left", "center", "right")
    assert dict(touch.touched) == {"left": False, "center": False, "right": False}


@pytest.mark.parametrize(
    ("arguments", "settings", "error", "text"),
    [
        (("house",), {}, TypeError, "world: expected World, got 'house'"),
        ((World(),), {"scanner": 360}, TypeError, "scanner: expected Scanner, got 360"),
        ((World(),), {"motors": "fast"}, TypeError, "motors: expected Motors, got 'fast'"),
        ((World(),), {"seed": 0.5}, TypeError, "seed: expected int, got 0.5"),
        ((World(),), {"seed": -1}, ValueError, "seed: expected 0 or more, got -1"),
        ((World(),), {"radius": 0}, ValueError, "radius: expected metres above 0, got 0"),
        ((World(), (0.0, 0.0)), {}, ValueError, r"pose: expected \(x, y, yaw\), got 2 values"),
        ((World(), (0.0, 0.0, inf)), {}, ValueError, r"pose.yaw: expected a finite number of radians, got inf"),
        ((World(), (nan, 0.0, 0.0)), {}, ValueError, r"pose.x: expected a finite number of m, got nan"),
        (
            (World(), (0.0, 0.0, 90)),
            {},
            ValueError,
            r"pose.yaw: expected radians within ±2 pi, got 90.0; math.radians\(\) makes them of degrees",
        ),
        (
            (WALL, (1.9, 0.0, 0.0)),
            {},
            ValueError,
            r"pose: expected a place with 0.18 m of room, got \(1.9, 0\), 0.100 m from the nearest wall or obstacle",
        ),
    ],
)
def test_a_robot_that_cannot_be_is_refused(arguments, settings, error, text):
    with pytest.raises(error, match=text):
        Robot(*arguments, **settings)


@pytest.mark.parametrize("dt", [0.0, -0.1, 61.0])
def test_time_runs_forward_in_steps_of_a_minute_at_most(dt):
    with pytest.raises(ValueError, match="dt: expected seconds, above 0 and at most 60, got"):
        Robot(World()).step(dt)


def test_a_command_that_is_not_a_number_is_refused_and_the_last_one_stays():
    robot = Robot(World())
    robot.drive(0.3, 0.1)
    with pytest.raises(ValueError, match="angular: expected a finite number of rad/s, got nan"):
        robot.drive(0.5, float("nan"))
    with pytest.raises(TypeError, match="linear: expected a number, got 'ahead'"):
        robot.drive("ahead", 0.0)
    assert robot.command().values == (0.3, 0, 0, 0, 0, 0.1)


def test_a_robot_comes_back_to_where_a_square_began():
    robot = Robot(World(), motors=Motors(linear_acceleration=1e6, angular_acceleration=1e6))
    for _ in range(4):
        robot.drive(0.5, 0.0)
        run(robot, 2.0)
        robot.drive(0.0, pi / 4)
        run(robot, 2.0)
    x, y, yaw = robot.pose
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert (cos(yaw), sin(yaw)) == pytest.approx((1.0, 0.0), abs=1e-6)


def test_a_reset_sets_the_odometry_back_and_carrying_the_robot_does_not() -> None:
    robot = Robot(World([(5.0, -2.0, 5.0, 2.0)]), (1.0, 0.5, 0.2), seed=1)
    start = robot.pose
    robot.drive(0.3, 0.4)
    robot.step(1.0)
    driven = robot.odometry
    robot.move_to(0.0, 0.0, 0.0)
    assert robot.odometry == driven
    robot.reset()
    assert driven != start
    assert robot.pose == robot.odometry == start
