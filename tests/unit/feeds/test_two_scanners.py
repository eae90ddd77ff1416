"""Two scanners on one topic."""

import pytest

from robowidgets import Scan
from robowidgets.feeds._two_scanners import FORGET, TwoScanners

from .scripted import scan, twist

FEW, MANY = scan(1.0, 1.0), scan(1.0, 1.0, 1.0)


def test_a_scanner_that_is_set_up_again_is_one():
    watch = TwoScanners()
    for message in (FEW, FEW, MANY, MANY, MANY):
        watch.see(message)
        assert watch.status == ""


def test_two_that_take_turns_are_two_whatever_their_messages_are_made_of():
    watch = TwoScanners()
    other = Scan([1.0, 1.0, 1.0], angle_min=0.5, angle_increment=0.1, range_min=0.1, range_max=10.0)
    for message in (FEW, other, FEW, other):
        watch.see(message)
    few, many = "2 rays from 0.0° in steps of 5.73°", "3 rays from 28.6° in steps of 5.73°"
    assert watch.status == f"two scanners take turns on this topic, or one changes its rays: {few}, and {many}"


def test_two_of_one_make_are_distinguished_by_their_frames():
    watch = TwoScanners()
    for frame in ("front", "rear", "front", "rear"):
        watch.see({**FEW, "header": {"frame_id": frame}})
    rays = "2 rays from 0.0° in steps of 5.73°"
    assert watch.status == f"two scanners take turns on this topic: front: {rays}, and rear: {rays}"


def test_it_is_over_when_one_of_them_has_ended_for_a_while():
    now = [0.0]
    watch = TwoScanners(lambda: now[0])
    for message in (FEW, MANY, FEW):
        watch.see(message)
    now[0] = FORGET / 2
    watch.see(FEW)
    assert watch.status
    now[0] = FORGET + 0.1
    watch.see(FEW)
    assert watch.status == ""


def test_a_change_back_after_a_long_time_is_not_a_second_scanner():
    now = [0.0]
    watch = TwoScanners(lambda: now[0])
    for message in (FEW, MANY, FEW):
        watch.see(message)
        now[0] += FORGET + 1
    assert watch.status == ""


def test_what_is_not_a_scan_does_not_count():
    watch = TwoScanners()
    for message in (FEW, twist(0.1), {"ranges": 3}, "scan", FEW):
        watch.see(message)
    assert watch.status == ""


def test_one_scanner_whose_turns_differ_a_little_is_one():
    watch = TwoScanners()
    for turn in range(30):
        rays, first = (359, 360, 361, 360)[turn % 4], (0.0, 0.1, 0.004, 0.1)[turn % 4]
        step = 6.283 / rays
        watch.see(Scan([1.0] * rays, angle_min=first, angle_increment=step, range_min=0.1, range_max=10.0))
        assert watch.status == ""


@pytest.mark.parametrize(
    "other", [{"rays": 400}, {"angle_min": 0.7}, {"angle_increment": 0.012}, {"angle_increment": -0.01}]
)
def test_two_that_differ_in_one_thing_are_two(other: dict[str, float]):
    watch = TwoScanners()
    for changed in ({}, other, {}):
        shape = {"rays": 360, "angle_min": 0.0, "angle_increment": 0.01, **changed}
        watch.see(Scan([1.0] * int(shape.pop("rays")), range_min=0.1, range_max=10.0, **shape))
    assert "two scanners take turns" in watch.status


def test_an_angle_beyond_all_numbers_does_not_count():
    watch = TwoScanners()
    watch.see({"ranges": [1.0], "angle_min": 10**400, "angle_increment": 0.1})
    assert watch.status == ""
