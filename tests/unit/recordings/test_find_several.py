"""Finding in a recording with several topics of a kind: the search has to name one."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.command import main
from robowidgets.recordings import UnknownTopicError

from . import topics

WRITTEN = {
    "/front_scan": [(0, 1), (1, 2)],
    "/rear_scan": [(0, 5), (1, 0.2)],
    "/odom": [(0, 0), (1, 1)],
    "/wheels": [(0, 0), (1, 1)],
    "/cmd_vel": [(0, 0), (1, 2)],
    "/left_bump": [(0, 0), (1, 1)],
    "/right_bump": [(0, 0), (1, 0)],
}


@pytest.fixture
def recording(tmp_path: Path) -> robowidgets.Recording:
    return robowidgets.open(topics.write(tmp_path / "x", WRITTEN))


def starts(recording: robowidgets.Recording, condition: Any, **more: Any) -> list[float]:
    return [span.start for span in recording.find(condition, **more)]


SCANS = "x has several topics of laser scans (/front_scan, /rear_scan): "
SPEEDS = "x has several topics of speeds (/odom, /wheels, /cmd_vel): "
TOUCHES = "x has several topics of touch sensors (/left_bump, /right_bump): "


@pytest.mark.parametrize(
    ("condition", "text"),
    [
        (conditions.nearest_below(1), SCANS + "name the topic, as in topic='/front_scan'"),
        (conditions.speed_above(1), SPEEDS + "name the topic, as in topic='/odom'"),
        (conditions.touched(), TOUCHES + "name the topic, as in topic='/left_bump'"),
        (
            lambda moment: moment.scan,
            SCANS + "read one, as in moment['/front_scan'], or choose one, as in topics=['/front_scan']",
        ),
        (lambda moment: moment.speed, SPEEDS + "read one, as in moment['/odom']"),
        (lambda moment: moment.touch, TOUCHES + "read one, as in moment['/left_bump']"),
    ],
)
def test_one_of_several_is_not_picked_for_you(recording: robowidgets.Recording, condition: Any, text: str) -> None:
    with pytest.raises(UnknownTopicError, match=f"^{re.escape(text)}"):
        recording.find(condition)


def test_one_that_is_named_is_looked_at(recording: robowidgets.Recording) -> None:
    assert starts(recording, conditions.nearest_below(0.3, topic="/rear_scan")) == [1]
    assert starts(recording, lambda moment: moment["/rear_scan"].nearest().range < 0.3) == [1]
    assert starts(recording, lambda moment: moment["/front_scan"].nearest().range < 0.3) == []


def test_one_of_a_kind_among_those_that_are_looked_at_is_meant(recording: robowidgets.Recording) -> None:
    def near(moment: Any) -> bool:
        return bool(moment.scan.nearest().range < 0.3)

    assert starts(recording, near, topics="/rear_scan") == [1]
    assert starts(recording, near, topics=["/front_scan", "/odom"]) == []
    assert starts(recording, lambda moment: moment.speed.linear[0] > 1, topics="/cmd_vel") == [1]
    with pytest.raises(UnknownTopicError, match="several topics of laser scans"):
        recording.find(near, topics=["/front_scan", "/rear_scan"])


def test_a_speed_that_is_measured_goes_before_those_that_are_commanded(recording: robowidgets.Recording) -> None:
    def fast(moment: Any) -> bool:
        return bool(moment.speed.linear[0] > 1)

    assert starts(recording, fast, topics=["/cmd_vel", "/odom"]) == []


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        (["--nearest-below", "1"], SCANS + "name the topic, as in --scan /front_scan"),
        (["--speed-above", "1"], SPEEDS + "name the topic, as in --speed /odom"),
        (["--touched"], TOUCHES + "name the topic, as in --touch /left_bump"),
    ],
)
def test_the_shell_says_which_option_names_one(
    tmp_path: Path, asked: list[str], text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["find", str(topics.write(tmp_path / "x", WRITTEN)), *asked]) == 2
    assert capsys.readouterr().err == f"robowidgets: {text}\n"
