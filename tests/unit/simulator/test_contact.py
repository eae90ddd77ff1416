from math import cos, pi, radians, sin

import numpy as np
import pytest

from robowidgets.simulator import World
from robowidgets.simulator._contact import contact_angles, pressed, push_out
from robowidgets.simulator._models import MODELS

BUMPERS = MODELS["plain"].bumpers


@pytest.mark.parametrize(
    ("degrees", "bumpers"),
    [
        (0, {"center"}),
        (14, {"center"}),
        (20, {"left", "center"}),
        (-20, {"center", "right"}),
        (31, {"left"}),
        (79, {"left"}),
        (-31, {"right"}),
        (-79, {"right"}),
        (90, set()),
        (-90, set()),
        (180, set()),
    ],
)
@pytest.mark.parametrize("yaw", [0.0, 2.5, -3.1])
def test_the_contact_angle_decides_which_bumper_is_pressed(degrees, bumpers, yaw):
    angle = radians(degrees)
    post = (0.5 * cos(yaw + angle), 0.5 * sin(yaw + angle), 0.3)
    angles = contact_angles(World(obstacles=[post]), 0.0, 0.0, yaw, 0.2)
    assert np.cos(angles[0] - angle) == pytest.approx(1.0)
    assert {name for name, state in pressed(angles, BUMPERS).items() if state} == bumpers


def test_nothing_is_pressed_two_millimetres_away():
    wall = World(walls=[(0.2025, -1, 0.2025, 1)])
    assert contact_angles(wall, 0.0, 0.0, 0.0, 0.2) == []
    assert contact_angles(wall, 0.001, 0.0, 0.0, 0.2) == [0.0]


def test_two_things_press_two_bumpers():
    gap = World(walls=[(0.2, -1, 0.2, 1)], obstacles=[(0.0, 0.5, 0.3), (0.5 * cos(1), 0.5 * sin(1), 0.3)])
    assert pressed(contact_angles(gap, 0.0, 0.0, 0.0, 0.2), BUMPERS) == {"left": True, "center": True, "right": False}


def test_a_free_body_stays_where_it_is():
    assert push_out(World.rooms(), 0.0, 0.0, 0.18) == (0.0, 0.0)
    assert push_out(World(), 1.0, 2.0, 0.18) == (1.0, 2.0)


def test_a_wall_pushes_straight_back_and_keeps_what_goes_along_it():
    assert push_out(World(walls=[(1, -5, 1, 5)]), 0.9, 0.3, 0.2) == pytest.approx((0.8, 0.3))


def test_a_corner_pushes_from_both_sides():
    corner = World(walls=[(1, -5, 1, 1), (-5, 1, 1, 1)])
    assert push_out(corner, 0.95, 0.9, 0.2) == pytest.approx((0.8, 0.8))


def test_a_gap_that_is_too_narrow_has_no_place():
    gap = World(walls=[(-5, 0.1, 5, 0.1), (-5, -0.1, 5, -0.1)])
    assert push_out(gap, 0.0, 0.0, 0.2) is None
    assert push_out(World(walls=[(-1, 0, 1, 0)]), 0.0, 0.0, 0.2) is None


def test_angles_are_within_half_a_turn():
    angles = contact_angles(World(walls=[(-0.2, -1, -0.2, 1)]), 0.0, 0.0, 3.0, 0.2)
    assert angles == pytest.approx([pi - 3.0])
