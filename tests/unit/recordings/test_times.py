"""Dates of a recording's times."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets.recordings import RecordingError
from robowidgets.recordings.times import seconds_at

from . import robot

S = 1_000_000_000
START = datetime(2023, 11, 14, 22, 13, 20, tzinfo=timezone.utc)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return robot.write(tmp_path_factory.mktemp("recordings") / "drive")


@pytest.mark.parametrize(
    ("when", "seconds"),
    [
        ("2023-11-14T22:13:22.500", 2.5),
        ("2023-11-14 22:13:22", 2.0),
        ("2023-11-14 22:13:22 UTC", 2.0),
        ("2023-11-14T22:13:22Z", 2.0),
        ("2023-11-15T00:13:22+02:00", 2.0),
        (datetime(2023, 11, 14, 22, 13, 22), 2.0),
        (START + timedelta(seconds=10), 10.0),
        ((START + timedelta(seconds=3)).astimezone(timezone(timedelta(hours=-7))), 3.0),
    ],
    ids=str,
)
def test_a_date_and_time_of_day_is_a_time_from_the_start(path: Path, when: Any, seconds: float) -> None:
    with robowidgets.open(path) as recording:
        assert recording.seconds_at(when) == seconds


def test_every_sample_lies_at_the_date_of_its_time() -> None:
    start_ns, end_ns = 1_758_738_537_706_249_237, 1_758_738_569_904_372_808
    for time_ns in range(start_ns, end_ns, S // 7):
        when = datetime(1970, 1, 1) + timedelta(microseconds=time_ns // 1000)
        assert seconds_at(when, "drive", start_ns, end_ns) == pytest.approx((time_ns - start_ns) / S, abs=1e-6)


def test_the_second_in_which_it_starts_is_its_start() -> None:
    start_ns = robot.START_NS + 900_000_000
    assert seconds_at("2023-11-14T22:13:20", "drive", start_ns, start_ns + S) == 0.0


@pytest.mark.parametrize(
    ("when", "lies"),
    [
        ("2023-11-14T22:13", "2023-11-14 22:13:00 UTC lies before"),
        ("2023-11-14T22:13:19.999999", "2023-11-14 22:13:19 UTC lies before"),
        (START + timedelta(seconds=10, microseconds=1), "2023-11-14 22:13:30 UTC lies after"),
        ("2023-11-14T22:13:22+02:00", "2023-11-14 20:13:22 UTC lies before"),
    ],
    ids=str,
)
def test_a_date_outside_of_the_recording_is_refused(path: Path, when: Any, lies: str) -> None:
    with robowidgets.open(path) as recording, pytest.raises(ValueError) as error:  # noqa: PT011  # the text is below
        recording.seconds_at(when)
    held = "from 2023-11-14 22:13:20 UTC to 2023-11-14 22:13:30 UTC"
    assert str(error.value) == f"when: {lies} the recording drive, which is {held}"


@pytest.mark.parametrize(
    ("when", "kind", "got"),
    [("14:32", ValueError, "'14:32'"), ("", ValueError, "''"), (12.5, TypeError, "12.5"), (None, TypeError, "None")],
    ids=str,
)
def test_what_is_not_a_date_is_refused(path: Path, when: Any, kind: type[Exception], got: str) -> None:
    expected = f'^when: expected a datetime, or text such as "2024-05-03T14:32:05"; got {got}$'
    with robowidgets.open(path) as recording, pytest.raises(kind, match=expected):
        recording.seconds_at(when)


@pytest.mark.parametrize(
    ("start_ns", "why"),
    [
        (112_540_000_000, "drive has no date: its clock begins at 112.54 s"),
        (631_151_999 * S, "drive has no date: its clock begins at 6.31152e+08 s"),
        (None, "drive holds no message"),
    ],
    ids=str,
)
def test_a_recording_without_a_date_has_none(start_ns: int | None, why: str) -> None:
    with pytest.raises(RecordingError) as error:
        seconds_at("2024-05-03T14:32", "drive", start_ns, start_ns)
    assert str(error.value) == f"{why}; its times are seconds from the start, 0 to its duration"
