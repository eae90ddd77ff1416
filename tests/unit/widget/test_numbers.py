"""Numbers that a program plots on a widget."""

from __future__ import annotations

from math import inf, nan
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import LaserWidget, SpeedWidget, conditions
from robowidgets.widget.pacer import pacer

from ..senders import turn_of


def scan(laser: LaserWidget) -> None:
    laser.update(ranges=[1.0, 2.0], angle_min=0.0, angle_increment=0.1, range_min=0.1, range_max=9.0)


def said(widget: Any) -> Any:
    """The numbers that the page gets with the newest sample."""
    return widget.get_state()["_about"].get("numbers")


@pytest.fixture
def laser() -> LaserWidget:
    widget = LaserWidget(title="/scan")
    scan(widget)
    return widget


def test_a_number_stands_on_the_newest_sample_and_is_given_back(laser: LaserWidget) -> None:
    assert said(laser) is None
    assert laser.watch("r", 0.42) == 0.42
    assert laser.watch("q", np.float32(0.5)) == 0.5
    assert said(laser) == {"r": 0.42, "q": 0.5}
    laser.watch("r", 7)
    assert said(laser) == {"r": 7.0, "q": 0.5}, "of several on one sample, the last counts"
    scan(laser)
    assert said(laser) == {"r": None, "q": None}, "the next sample has none until it gets one"


def test_a_number_for_a_sample_that_was_not_shown_stands_on_the_next_one_that_is(laser: LaserWidget) -> None:
    laser.watch("r", 1.0)
    said(laser)
    with turn_of(pacer):
        scan(laser)
        laser.watch("r", 2.0)
        scan(laser)
    assert said(laser) == {"r": 2.0}
    scan(laser)
    assert said(laser) == {"r": None}


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_what_is_not_finite_is_a_gap(laser: LaserWidget, value: float) -> None:
    laser.watch("r", value)
    assert said(laser) == {"r": None}


def test_unwatch_removes_it(laser: LaserWidget) -> None:
    laser.watch("r", 1.0)
    laser.unwatch("r")
    assert said(laser) is None
    with pytest.raises(KeyError, match="no watch 'r'"):
        laser.unwatch("r")


def test_every_widget_of_samples_has_it() -> None:
    speed = SpeedWidget()
    speed.update(linear=(1, 0, 0))
    speed.watch("error", -0.25)
    assert said(speed) == {"error": -0.25}


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (
            lambda w: w.watch("r"),
            TypeError,
            r"watch\('r'\): expected a number after its name, as watch\('r', 0.42\), or a",
        ),
        (lambda w: w.watch("r", "wall"), TypeError, "or a condition before it; got 'wall'"),
        (lambda w: w.watch("r", [1.0]), TypeError, r"watch\('r'\): expected a number, got \[1.0\]"),
        (lambda w: w.watch(0.42, "r"), TypeError, r"expected a function of one scan.*got 0.42"),
        (lambda w: w.watch(conditions.nearest_below(1), 0.42), TypeError, r'after its name: watch\("r", 0.42\)'),
        (lambda w: w.watch("", 1.0), ValueError, "name: expected 1 to 40 characters, got ''"),
        (lambda w: w.watch("wall", 1.0), ValueError, r"watch\('wall'\): a condition has this name; unwatch\('wall'\)"),
    ],
)
def test_what_cannot_be_is_refused_with_the_next_step(
    laser: LaserWidget, call: Any, error: type[Exception], text: str
) -> None:
    laser.watch(conditions.nearest_below(0.5), name="wall")
    with pytest.raises(error, match=text):
        call(laser)
    laser.unwatch("wall")


def test_a_condition_does_not_take_the_name_of_a_number_and_there_are_at_most_eight(laser: LaserWidget) -> None:
    laser.watch("wall", 1.0)
    with pytest.raises(ValueError, match="'wall' is the name of a number"):
        laser.watch(conditions.nearest_below(0.5), name="wall")
    for i in range(7):
        laser.watch(f"n{i}", i)
    with pytest.raises(ValueError, match=r"watch\('one more'\): expected at most 8 names"):
        laser.watch("one more", 1.0)


def test_a_widget_of_a_player_has_no_warning() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        player = recording.show("/scan", scanogram=False)
    with pytest.raises(ValueError, match="a player moves this widget"):
        player.views[0].widget.watch("r", 1.0)
    player.close()
