from __future__ import annotations

import numpy as np

from robowidgets.samples import AXES
from robowidgets.scanogram.scan_times import ScanTimes
from robowidgets.scanogram.strips import MOST_SPEEDS, MOST_TOUCHES, SpeedStrip, TouchStrip

LIMITS = dict.fromkeys(AXES, (-1.0, 1.0))


def strip(values: np.ndarray) -> SpeedStrip:
    return SpeedStrip("/odom", ScanTimes(np.arange(len(values)) * 10_000_000, 0), values, LIMITS)


def test_sideways_speed_has_a_strip_only_if_there_is_any() -> None:
    values = np.zeros((10, 6))
    assert strip(values).axes == ["linear.x", "angular.z"]
    values[3, 1] = 0.1
    assert strip(values).axes == ["linear.x", "linear.y", "angular.z"]


def test_a_strip_has_limits_only_if_they_were_set() -> None:
    values = np.zeros((10, 6))
    values[5, 0], values[6, 2] = 3.0, 1.5
    speeds = SpeedStrip("/odom", ScanTimes(np.arange(10), 0), values, {"angular.z": (-1.0, 1.0)})
    assert speeds.axes == ["linear.x", "linear.z", "angular.z"], "an axis that is fast has a strip without limits too"
    assert speeds.limits == [None, None, (-1.0, 1.0)]


def test_any_other_axis_has_a_strip_only_if_it_is_past_its_limit() -> None:
    values = np.full((10, 6), 0.9)
    values[4, 3] = np.nan
    assert strip(values).axes == ["linear.x", "linear.y", "angular.z"]
    values[3, 2], values[5, 4] = 1.1, -1.1
    assert strip(values).axes == ["linear.x", "linear.y", "linear.z", "angular.y", "angular.z"]


def test_one_peak_among_a_million_speeds_is_kept_and_found_closer_by() -> None:
    values = np.zeros((1_000_000, 6))
    values[654_321, 0], values[654_322, 5] = 1.5, -2.5
    speeds = strip(values)
    part = speeds.part(0, 10_000)
    assert len(part.starts) <= MOST_SPEEDS
    assert (part.extremes[0, 1].max(), part.extremes[1, 0].min()) == (1.5, -2.5)
    close = speeds.part(6543.0, 6544.0)
    assert len(close.starts) < 200
    assert close.starts[close.extremes[0, 1].argmax()] == 6543.21


def test_no_value_is_not_a_speed_of_zero() -> None:
    values = np.full((10, 6), np.nan)
    values[5, 0] = 0.3
    part = strip(values).part(0, 1)
    assert np.isnan(part.extremes[0, 0]).sum() == 9
    assert np.isnan(part.extremes[1]).all()


def test_touches_that_are_too_many_are_joined_and_none_is_lost() -> None:
    starts = np.arange(10_000) * 0.1
    spans = np.column_stack((starts, starts + 0.01, np.arange(10_000) % 2))
    touches = TouchStrip("/bumper", ["left", "right"], spans)
    assert len(touches.spans) <= MOST_TOUCHES
    for sensor in (0, 1):
        own = touches.spans[touches.spans[:, 2] == sensor]
        inside = (own[:, 0] <= spans[sensor::2, 0, None]) & (own[:, 1] >= spans[sensor::2, 1, None])
        assert inside.any(axis=1).all()
