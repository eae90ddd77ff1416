from math import inf

import pytest

from robowidgets.simulator import Motors

MOTORS = Motors(max_linear=1.0, max_angular=2.0, linear_acceleration=0.5, angular_acceleration=4.0)


def test_speed_approaches_the_command_by_the_acceleration():
    assert MOTORS.toward((0.0, 0.0, 0.0), (1.0, -1.0, 0.0), 0.1) == pytest.approx((0.05, -0.4, 0.0))


def test_slowing_down_takes_as_long_as_speeding_up():
    assert MOTORS.toward((0.3, -1.0, 0.0), (0.0, 0.0, 0.0), 0.1) == pytest.approx((0.25, -0.6, 0.0))


def test_the_command_is_reached_and_not_passed():
    assert MOTORS.toward((0.98, 1.9, 0.0), (0.99, 1.8, 0.0), 0.1) == pytest.approx((0.99, 1.8, 0.0))


def test_more_than_the_motors_can_do_is_cut():
    assert MOTORS.toward((1.0, -2.0, 0.0), (50.0, -50.0, 5.0), 1.0) == (1.0, -2.0, 0.0)


@pytest.mark.parametrize(
    ("limits", "error", "text"),
    [
        ({"max_linear": 0}, ValueError, "max_linear: expected a limit above 0, got 0.0"),
        ({"angular_acceleration": -1}, ValueError, "angular_acceleration: expected a limit above 0, got -1.0"),
        ({"max_angular": inf}, ValueError, "max_angular: expected a finite number of SI units, got inf"),
        ({"linear_acceleration": "fast"}, TypeError, "linear_acceleration: expected a number, got 'fast'"),
    ],
)
def test_motors_that_cannot_be_are_refused(limits, error, text):
    with pytest.raises(error, match=text):
        Motors(**limits)
