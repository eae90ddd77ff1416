"""Finding the times at which a program would have stopped the robot of a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from cloudpickle import dumps, loads

import robowidgets
from robowidgets import RecordingError, conditions
from robowidgets.behaviors import Drive
from robowidgets.recordings import UnknownTopicError

from . import robot
from .test_find import found


@pytest.fixture
def drive(tmp_path: Path) -> robowidgets.Recording:
    """See `robot.write`: scan i of 10 Hz sees 1 + i / 100 m, the speed is i / 100 m/s."""
    return robowidgets.open(robot.write(tmp_path / "drive"))


def before(limit: float) -> Any:
    def program(scan: Any) -> Drive:
        return Drive(0.0 if scan.distance() < limit else 0.2)

    return program


def test_where_a_new_program_would_have_stopped_and_the_old_one_not(drive: robowidgets.Recording) -> None:
    old, new = conditions.stops(before(1.205), rate=10), conditions.stops(before(1.505), rate=10)
    assert found(drive, old) == [(0, 2.1)]
    assert found(drive, new) == [(0, 5.1)]
    assert found(drive, new & ~old) == [(2.1, 5.1)]
    assert str(new & ~old) == "(program stops & ~program stops)"
    assert found(drive, loads(dumps(new))) == [(0, 5.1)]  # as it is sent to another process


def test_a_program_keeps_its_state_and_speed_between_steps_and_each_search_restarts(
    drive: robowidgets.Recording,
) -> None:
    class Waits:
        name = "waits"

        def __init__(self) -> None:
            self.steps = 0

        def __call__(self, time: float, speed: Any, state: Any) -> Drive | None:
            state.steps = getattr(state, "steps", 0) + 1
            if state.steps == 11:
                assert (time, speed.linear[0]) == (2.0, 0.2)
                return Drive(0.1)
            return Drive() if state.steps == 1 else None  # keeps its state

    condition = conditions.stops(Waits(), rate=5)
    assert found(drive, condition) == found(drive, condition) == [(0, 2.0)]


def test_poses_of_odometry_count(drive: robowidgets.Recording) -> None:
    assert found(drive, conditions.stops(lambda driven: Drive(1.0 if driven == 0 else 0.0))) == []
    assert found(drive, conditions.stops(lambda pose, turned: Drive(pose.x + turned))) == [(0, 10)]


def test_nothing_is_known_before_the_first_sample_and_while_one_is_too_old_to_drive_by(tmp_path: Path) -> None:
    with robowidgets.open(robot.write(tmp_path / "drive", silence=5)) as silent:
        assert found(silent, conditions.stops(lambda scan: Drive(0 * len(scan)), rate=10)) == [(0, 5.4), (10, 15.0)]
        assert found(silent, conditions.stops(lambda touch: Drive(0 * len(touch.sensors)), rate=10))[0][0] == 2
        assert found(silent, conditions.stops(lambda: Drive())) == [(0, 15)]


def test_what_fails_is_named_with_the_time(drive: robowidgets.Recording) -> None:
    def fails(time: float) -> Drive:
        return Drive(1 / (time - 1.0))

    with pytest.raises(RecordingError, match=r"the program fails failed at 1\.00 s: ZeroDivisionError"):
        drive.find(conditions.stops(fails, rate=10))
    with pytest.raises(UnknownTopicError, match=r"has no .*sonar"):
        drive.find(conditions.stops(lambda sonars: sonars))
    with pytest.raises(TypeError, match="asks for 'laser'"):
        conditions.stops(lambda laser: laser)
    with pytest.raises(TypeError, match=r"only Recording.find finds it"):
        conditions.stops(lambda scan: Drive(0 * len(scan))).judge(None)
