"""Fields of topics with different rates as one table."""

from __future__ import annotations

import sys
from math import isclose, isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as parquet
import pytest

import robowidgets
from robowidgets import Recording, RecordingError

from . import recorded, robot

SPEED, SCAN = "/odom.twist.twist.linear.x", "/scan.front"


def value_of(message: Any, field: str) -> Any:
    for name in field.split("."):
        plain, _, index = name.partition("[")
        message = getattr(message, plain)
        message = message[int(index[:-1])] if index else message
    return message


def plain_loop(recording: Recording, topic: str, field: str, times: list[int], how: str) -> list[Any]:
    """The values of a column, by loops over all messages."""
    if field in ("front", "nearest"):
        sectors = ("front",) if field == "front" else ()
        own = [(one.time_ns, float(one.sample.distance(*sectors))) for one in recording.samples(topic)]
    else:
        own = [(one.time_ns, value_of(one.message, field)) for one in recording.messages(topic)]
    if [time_ns for time_ns, _ in own] == times:
        return [value for _, value in own]
    found: list[Any] = []
    for time_ns in times:
        before = next((one for one in reversed(own) if one[0] <= time_ns), None)
        after = next((one for one in own if one[0] > time_ns), None)
        if how == "last" or isinstance(own[0][1], (str, bool)) or (before and before[0] == time_ns):
            found.append(before[1] if before else None)
        elif before is None or after is None:
            found.append(None)
        elif before[1] == after[1]:
            found.append(before[1])
        else:
            value = before[1] + (after[1] - before[1]) * (time_ns - before[0]) / (after[0] - before[0])
            found.append(value if np.isfinite(value) else nan)
    return found


def assert_equal(column: np.ndarray[Any, Any], plain: list[Any]) -> None:
    values = np.ma.asarray(column).tolist()
    assert len(values) == len(plain)
    for one, other in zip(values, plain, strict=True):
        if other is None or (isinstance(other, float) and isnan(other)):
            assert one is None or isnan(one)
        elif isinstance(other, float):
            assert isclose(one, other, rel_tol=1e-6, abs_tol=1e-9), (one, other)
        else:
            assert one == other


@pytest.fixture
def drive(tmp_path: Path) -> Recording:
    """See `robot.write`: 10 Hz for 10 s, commands from 5 s on, and presses at 2 and 6 s."""
    return robowidgets.open(robot.write(tmp_path / "drive"))


@pytest.mark.parametrize("how", ["last", "linear"])
@pytest.mark.parametrize("at", ["/scan", "/bumper", "/cmd_vel", 0.25])
def test_rows_equal_those_of_loops(how: str, at: str | float, drive: Recording) -> None:
    names = [SCAN, SPEED, "/cmd_vel.linear.x", "/bumper.state", "/odom.child_frame_id", "/log.data"]
    table = drive.table(*names, at=at, how=how)
    times = table.times_ns.tolist()
    if isinstance(at, str):
        assert times == [one.time_ns for one in drive.messages(at)]
    else:
        assert table.seconds.tolist() == [i / 4 for i in range(41)]
    assert table.names == tuple(names)
    for name in names:
        topic, _, field = name.partition(".")
        assert_equal(table[name], plain_loop(drive, topic, field, times, how))


def test_several_messages_at_one_time_are_a_row_each(tmp_path: Path) -> None:
    rows = [
        (0.0, "/a", {"data": 1.0}),
        (1.0, "/a", {"data": 2.0}),
        (1.0, "/a", {"data": 3.0}),
        (1.0, "/b", {"data": 5.0}),
    ]
    recording = robowidgets.open(
        recorded.write(tmp_path / "x", dict.fromkeys(("/a", "/b"), "std_msgs/msg/Float64"), rows)
    )
    for how in ("last", "linear"):
        table = recording.table("/a.data", "/b.data", how=how)
        assert table["/a.data"].tolist() == [1, 2, 3]
        assert_equal(table["/b.data"], [None, 5.0, 5.0])
        assert recording.table("/a.data", at="/b", how=how)["/a.data"].tolist() == [3]


def test_nothing_in_range_is_not_interpolated_into_a_number(tmp_path: Path) -> None:
    values = [1.0, np.inf, np.inf, np.nan, 2.0]
    rows = [(float(i), "/a", {"data": value}) for i, value in enumerate(values)]
    recording = robowidgets.open(recorded.write(tmp_path / "x", {"/a": "std_msgs/msg/Float64"}, rows))
    found = recording.table("/a.data", at=0.5, how="linear")["/a.data"]
    assert_equal(found, [1.0, nan, np.inf, np.inf, np.inf, nan, nan, nan, 2.0])


def test_a_message_has_a_column_for_each_of_its_fields(drive: Recording) -> None:
    table = drive.table("/odom.twist.twist", "/bumper")
    assert table.names[:6] == tuple(
        f"/odom.twist.twist.{way}.{axis}" for way in ("linear", "angular") for axis in "xyz"
    )
    assert {"/bumper.bumper", "/bumper.state"} <= {*table.names}
    assert table.times_ns.tolist() == [one.time_ns for one in drive.messages("/odom")], "at the times of the first name"


def test_tables_of_other_libraries_have_types_that_do_not_depend_on_the_values(
    drive: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arrows = [drive.table(SCAN, SPEED, "/bumper.state", "/log.data", at=at).to_arrow() for at in ("/scan", "/log")]
    assert arrows[0].schema == arrows[1].schema
    table = drive.table(SCAN, SPEED, "/bumper.state", "/log.data")
    pandas = table.to_pandas()
    assert pandas.index.name == "seconds"
    assert pandas["/bumper.state"].isna().sum() == 20
    polars = table.to_polars()
    assert polars["/bumper.state"].null_count() == 20
    assert polars["/log.data"].null_count() == 100
    assert parquet.read_table(table.to_parquet(tmp_path / "table.parquet")).equals(table.to_arrow())
    assert repr(table).startswith(f"FieldTable of {SCAN}, {SPEED}, /bumper.state, /log.data: 100 rows, 0.00 to 9.90 s")
    with pytest.raises(KeyError, match=r"no column 'x'; there are /scan\.front"):
        table["x"]
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(ImportError, match=r"pip install pyarrow$"):
        table.to_parquet(tmp_path / "table.parquet")


def test_wrong_requests_name_what_was_expected(drive: Recording) -> None:
    for names, options, error, text in (
        ((), {}, TypeError, "expected topics with fields"),
        ((3,), {}, TypeError, "got 3"),
        ((SPEED,), {"how": "next"}, ValueError, "how: expected one of 'last', 'linear', got 'next'"),
        ((SPEED,), {"at": 0}, ValueError, "seconds between two rows, above 0"),
        ((SPEED,), {"at": "/none"}, RecordingError, "has no topic '/none'"),
        ((SPEED,), {"at": 1e-9}, RecordingError, "give more seconds to at="),
        (("/none.x",), {}, RecordingError, "has no topic '/none'"),
        (("/odom.twist.twist.linear.w",), {}, KeyError, "no field"),
        (("/scan.ranges",), {}, TypeError, r"several values in a message: name one, such as '/scan.ranges\[0\]'"),
    ):
        with pytest.raises(error, match=text):
            drive.table(*names, **options)  # type: ignore[arg-type]
    drive.close()
    with pytest.raises(RecordingError, match="is closed"):
        drive.table(SPEED)


@pytest.mark.slow
@pytest.mark.parametrize("how", ["last", "linear"])
def test_rows_of_real_recordings_equal_those_of_loops(how: str, data: Path) -> None:
    for path, at, names in (
        (
            "good/turtlebot3_gazebo.bag",
            "/scan",
            ["/scan.front", SPEED, "/cmd_vel.linear.x", "/odom.pose.covariance[0]"],
        ),
        ("good/neato_fsm", "/bump", ["/stable_scan.nearest", SPEED, "/cmd_vel.angular.z"]),
        ("topics/scitos_amcl.bag", "/amcl_pose", ["/scan.front", SPEED, "/odom.child_frame_id"]),
        ("topics/car_ins", 0.5, ["/ins/imu.angular_velocity.z", "/ins/nav_sat_fix.latitude"]),
    ):
        with robowidgets.open(data / path) as recording:
            table = recording.table(*names, at=at, how=how)
            rows = slice(0, len(table), max(1, len(table) // 50))
            for name in names:
                topic = next(one.name for one in recording.topics if name.startswith(f"{one.name}."))
                field = name.removeprefix(f"{topic}.")
                plain = plain_loop(recording, topic, field, table.times_ns.tolist(), how)
                assert_equal(table[name][rows], plain[rows])
