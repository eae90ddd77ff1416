import pytest

from robowidgets.simulator import Robot, Scanner, World, wander

BOX = World(walls=[(-2, -2, 2, -2), (2, -2, 2, 2), (2, 2, -2, 2), (-2, 2, -2, -2)])


def commands(robot, seconds, **speeds):
    """Each new command, with the bumpers that were pressed."""
    given = []
    for _ in wander(robot, **speeds):
        now = (robot.command().linear[0], robot.command().angular[2])
        if not given or given[-1][0] != now:
            given.append((now, {name for name, state in robot.touch().touched.items() if state}))
        robot.step(0.05)
        if robot.time > seconds:
            return given
    return given


def test_it_stops_backs_up_and_turns_after_a_bump():
    got = [command for command, _ in commands(Robot(BOX), 10)]
    assert got[:5] == [(0.5, 0.0), (0.0, 0.0), (-0.25, 0.0), (0.0, -1.2), (0.5, 0.0)]


@pytest.mark.parametrize(("yaw", "bumper", "turn"), [(0.8, "right", 1.2), (-0.8, "left", -1.2)])
def test_it_turns_away_from_the_side_that_was_hit(yaw, bumper, turn):
    got = commands(Robot(BOX, (1.0, 0.0, yaw)), 8)
    assert got[1] == ((0.0, 0.0), {bumper})
    assert got[3][0] == (0.0, turn)


def test_it_does_not_get_stuck_in_the_house():
    robot = Robot(World.rooms(), (0.2, -0.85, 0.5), scanner=Scanner(ray_count=2))
    places = set()
    for _ in wander(robot, linear=0.6):
        robot.step(0.05)
        places.add((round(robot.pose.x), round(robot.pose.y)))
        if robot.time > 120:
            break
    assert len(places) > 20


def test_it_drives_at_the_commanded_speed():
    got = [command for command, _ in commands(Robot(BOX), 8, linear=0.8, angular=0.4)]
    assert got[:4] == [(0.8, 0.0), (0.0, 0.0), (-0.4, 0.0), (0.0, -0.4)]
