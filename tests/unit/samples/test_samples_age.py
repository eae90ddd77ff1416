"""Samples know their age, whatever the robot's clock says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import LaserWidget, Range, Scan, Speed, SpeedWidget, Touch
from robowidgets.samples import age
from robowidgets.samples import scan as scan_module
from robowidgets.widget import newest_sample

from ..waiting import Clock

MAKES: dict[str, Callable[[], Any]] = {
    "scan": lambda: Scan([1.0, 2.0], -0.5, 0.5, 0.1, 30.0, stamp_ns=5),
    "speed": lambda: Speed((0.5, 0.0, 0.0), (0.0, 0.0, 0.1), stamp_ns=5),
    "touch": lambda: Touch({"left": True}, stamp_ns=5),
    "range": lambda: Range(0.42, 0.1, 5.0, stamp_ns=5),
}


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    for module in (age, scan_module, newest_sample):
        monkeypatch.setattr(module, "time", made)
    return made


@pytest.mark.parametrize("make", MAKES.values(), ids=MAKES)
class TestEverySample:
    def test_is_as_old_as_the_time_since_it_was_made(self, make: Callable[[], Any], clock: Clock) -> None:
        sample = make()
        assert sample.age == 0
        clock.now += 2.5
        assert sample.age == 2.5

    def test_says_the_same_however_old_it_is(self, make: Callable[[], Any], clock: Clock) -> None:
        first = make()
        clock.now += 1
        second = make()
        assert repr(first) == repr(second)
        assert not [field for field in fields(first) if "age" in field.name or "arrived" in field.name]
        if isinstance(first, (Speed, Range)):
            assert first == second
            assert hash(first) == hash(second)

    def test_is_new_where_something_in_it_is_replaced(self, make: Callable[[], Any], clock: Clock) -> None:
        first = make()
        clock.now += 1
        assert replace(first, stamp_ns=7).age == 0


def test_the_next_sweep_is_new_and_a_turned_one_is_not(clock: Clock) -> None:
    scan = MAKES["scan"]()
    clock.now += 1
    assert scan.again(np.ones(2, np.float32), None, 6).age == 0
    assert scan.turned(0.25).age == 1


def test_a_sample_of_a_recording_is_as_old_as_the_time_since_it_was_read(clock: Clock) -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        clock.now += 1
        scan = recording.at("/scan", 1.0).sample
        clock.now += 0.5
        assert scan.age == 0.5


def test_a_scan_is_as_old_when_it_is_frozen_or_turned(clock: Clock) -> None:
    laser = LaserWidget()
    laser.update(MAKES["scan"]())
    laser.paused = True
    clock.now += 1
    laser.update(MAKES["scan"]())
    clock.now += 0.5
    laser.angle_offset = 0.5
    assert laser.frozen.age == 1.5
    laser.paused = False
    assert laser.scan.age == 0.5


def test_speeds_are_as_old_when_they_are_frozen(clock: Clock) -> None:
    speed = SpeedWidget()
    speed.command(linear=(0.4, 0, 0))
    clock.now += 1
    speed.update(linear=(0.5, 0, 0))
    clock.now += 1
    speed.paused = True
    speed.update(linear=(0.6, 0, 0))
    assert (speed.frozen.age, speed.commanded.age) == (1, 2)
