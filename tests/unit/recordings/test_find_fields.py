"""Conditions on a field of the messages of any topic in a recording."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.command import main
from robowidgets.recordings import UnknownTopicError
from robowidgets.recordings.columns._fields import UnknownFieldError
from robowidgets.recordings.search.base import Condition

from . import recorded

field = conditions.field
NAN, INF = float("nan"), float("inf")
TYPES = {
    "/imu": "sensor_msgs/msg/Imu",
    "/status.new": "std_msgs/msg/String",
    "/ready": "std_msgs/msg/Bool",
    "/joints": "sensor_msgs/msg/JointState",
    "/count": "std_msgs/msg/Int64",
}
X = "/imu.linear_acceleration.x"


@pytest.fixture
def recording(tmp_path: Path) -> robowidgets.Recording:
    """At second i the acceleration is i, NaN at 5; with texts, flags, and joints whose number changes."""
    messages: list[tuple[float, str, Any]] = [
        (float(i), "/imu", {"linear_acceleration": {"x": NAN if i == 5 else float(i), "y": -float(i)}})
        for i in range(10)
    ]
    messages += [(1.0, "/status.new", {"data": "docked"}), (6.0, "/status.new", {"data": "under way"})]
    messages += [(2.0, "/ready", {"data": True}), (2.5, "/ready", {"data": False}), (8.0, "/ready", {"data": True})]
    messages += [(3.0, "/joints", {"position": [1.0, 2.0]}), (4.0, "/joints", {"position": [5.0]})]
    messages += [(0.0, "/count", {"data": 2**53 + 1}), (7.0, "/count", {"data": 2**53})]
    return robowidgets.open(recorded.write(tmp_path / "x", TYPES, sorted(messages, key=lambda one: one[0])))


def found(recording: robowidgets.Recording, condition: Condition) -> list[tuple[float, float]]:
    return [(span.start, span.end) for span in recording.find(condition)]


@pytest.mark.parametrize(
    ("condition", "spans"),
    [
        (field(X) > 7, [(8, 9)]),
        (field(X) >= 7, [(7, 9)]),
        (field(X) < 2, [(0, 2)]),
        (field(X) <= 2, [(0, 3)]),
        (field(X) == 3, [(3, 4)]),
        (field(X) != 3, [(0, 3), (4, 5), (6, 9)]),
        (field(X).between(3, 4), [(3, 5)]),
        (abs(field("/imu.linear_acceleration.y")) > 7, [(8, 9)]),
        (field("/status.new.data") == "docked", [(1, 6)]),
        (field("/ready.data") == True, [(2, 2.5), (8, 9)]),  # noqa: E712
        (field("/joints.position[1]") > 1, [(3, 4)]),
        (field("/count.data") == 2**53 + 1, [(0, 7)]),
    ],
)
def test_a_field_of_any_topic_compares_to_a_number_a_flag_or_a_text(
    recording: robowidgets.Recording, condition: Condition, spans: list[tuple[float, float]]
) -> None:
    assert found(recording, condition) == spans


def test_the_numbers_that_were_found_keep_their_digits_as_text(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    types = {"/fix": "sensor_msgs/msg/NavSatFix", "/ticks": "std_msgs/msg/Int64"}
    messages = [(0.0, "/fix", {"latitude": 48.123456789}), (1.0, "/ticks", {"data": 12_345_678})]
    path = recorded.write(tmp_path / "x", types, messages)
    recording = robowidgets.open(path)
    assert "48.12346" in str(recording.find(field("/fix.latitude") > 48.1))
    assert "12345678" in str(recording.find(field("/ticks.data") > 1))
    for words, value in [("/fix.latitude > 48.1", "48.12345679"), ("/ticks.data > 1", "12345678")]:
        assert main(["find", str(path), "--field", words]) == 0
        assert capsys.readouterr().out.split()[-1] == value


@pytest.mark.filterwarnings("error")
def test_a_field_can_be_compared_to_infinity(tmp_path: Path) -> None:
    messages = [(0.0, "/range", {"data": 1.0}), (1.0, "/range", {"data": INF}), (2.0, "/range", {"data": -INF})]
    recording = robowidgets.open(recorded.write(tmp_path / "x", {"/range": "std_msgs/msg/Float64"}, messages))
    assert [(span.start, span.value) for span in recording.find(field("/range.data") == INF)] == [(1.0, INF)]
    assert [(span.start, span.value) for span in recording.find(field("/range.data") != INF)] == [
        (0.0, 1.0),
        (2.0, -INF),
    ]


def test_a_topic_without_a_widget_is_no_problem_of_its_answers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows: list[tuple[float, str, Any]] = [(float(i), "/count", {"data": i}) for i in range(4)]
    path = recorded.write(tmp_path / "x", {"/count": "std_msgs/msg/Int64"}, rows)
    above = field("/count.data") > 1
    with robowidgets.open(path) as recording:
        assert recording.problems == ("none of its topics has a widget for its kind of sensor",)
        assert recording.find(above).problems == ()
    assert main(["find", str(path), "--field", "/count.data > 1"]) == 0
    assert "widget" not in capsys.readouterr().err
    assert robowidgets.find(above, path).problems == {}
    drives = robowidgets.index(path, output=tmp_path / "drives.parquet")
    assert drives.statistics("/count.data").problems == {}
    table = drives.table("/count.data")
    assert len(table.to_arrow()) == 4
    assert table.problems == {}


def test_they_are_joined_as_others_are(recording: robowidgets.Recording) -> None:
    both = (field(X) > 3) & (field("/status.new.data") == "docked")
    assert found(recording, both) == [(4, 5)]
    assert found(recording, both | (field(X) < 1)) == [(0, 1), (4, 5)]
    assert str(both) == "(/imu.linear_acceleration.x > 3 & /status.new.data == 'docked')"


def test_neither_nan_nor_a_missing_value_makes_it_true_or_false(recording: robowidgets.Recording) -> None:
    assert found(recording, ~(field(X) < 100)) == []
    assert found(recording, ~(field("/joints.position[1]") < 100)) == []
    assert found(recording, field("/ready.data") != True) == [(2.5, 8)]  # noqa: E712  # not from 0 on


def test_a_silence_of_a_steady_topic_is_unknown_while_events_hold(tmp_path: Path) -> None:
    steady = [(0.1 * i, "/imu", {"linear_acceleration": {"x": 1.0}}) for i in range(20)]
    again = [(30.0, "/imu", {"linear_acceleration": {"x": 1.0}})]
    events = [(0.3, "/ready", {"data": True}), (2.0, "/ready", {"data": False}), (2.7, "/ready", {"data": True})]
    path = recorded.write(tmp_path / "y", TYPES, sorted([*steady, *again, *events], key=lambda one: one[0]))
    with robowidgets.open(path) as recording:
        assert found(recording, field(X) > 0) == [(0, 2.0), (30, 30)]
        assert found(recording, field("/ready.data") == True) == [(0.3, 2.0), (2.7, 30)]  # noqa: E712


@pytest.mark.parametrize(
    ("condition", "error", "text"),
    [
        (field("/imu.linear_acceleration.w") > 1, UnknownFieldError, "did you mean 'linear_acceleration."),
        (field("/imu.linear_acceleration") > 1, UnknownFieldError, "is not a single field but a message"),
        (field("/imx.linear_acceleration.x") > 1, UnknownTopicError, "did you mean '/imu'?"),
        (field("/imu.orientation_covariance") > 1, TypeError, "name one of its numbers"),
        (field("/joints.position") > 1, TypeError, "name one of its numbers"),
        (field("/imu.header.stamp") > 1, TypeError, "name a part of it, such as /imu.header.stamp.sec"),
        (field("/status.new.data") > 1, TypeError, "/status.new.data is text, and cannot be compared to 1"),
        (field(X) == "fast", TypeError, "is a number, and cannot be compared to 'fast'"),
        (field("/status.new") == "docked", UnknownTopicError, "is a topic without a field"),
    ],
)
def test_what_is_not_there_or_does_not_compare_is_an_error_that_says_what_does(
    recording: robowidgets.Recording, condition: Condition, error: type[Exception], text: str
) -> None:
    with pytest.raises(error) as raised:
        recording.find(condition)
    assert text in str(raised.value)


@pytest.mark.parametrize(
    ("make", "error", "text"),
    [
        (lambda: field(3), TypeError, "expected a topic with a field"),
        (lambda: field("/imu"), ValueError, "expected a topic with a field"),
        (lambda: field(X) > "fast", TypeError, "can only be equal to 'fast' or not"),
        (lambda: field(X) > True, TypeError, "can only be equal to True or not"),
        (lambda: field(X) > None, TypeError, "expected a number, got None"),
        (lambda: field(X) == NAN, ValueError, "NaN, which nothing is equal to"),
        (lambda: field(X) > field("/imu.y"), TypeError, "not to another field"),
        (lambda: field(X).between(2, 1), ValueError, "between: expected the lower limit first, got 2 and 1"),
        (lambda: field(X).between(None, 1), TypeError, "expected a number, got None"),
        (lambda: 1 < field(X) < 3, TypeError, "a range is field.between(1, 3)"),
        (lambda: bool(field(X)), TypeError, "compare it, as in field('/imu.linear_acceleration.x') == True"),
    ],
)
def test_what_makes_no_condition_is_refused(make: Callable[[], Any], error: type[Exception], text: str) -> None:
    with pytest.raises(error) as raised:
        make()
    assert text in str(raised.value)


def test_a_message_is_judged_as_in_a_recording() -> None:
    condition = field("/imu.linear_acceleration.x") > 12

    def verdict(x: Any) -> Any:
        return condition.judge({"/imu": {"linear_acceleration": {"x": x}}})

    assert (verdict(13.0).value, verdict(12).value, verdict(NAN).value) == (True, False, None)
    assert verdict(13.0).text == "13.00 > 12.00 m/s²"
    assert condition.judge({}).value is None
    assert (field("/joints.position[3]") > 1).judge({"/joints": {"position": [1.0]}}).value is None
    with pytest.raises(ValueError, match="no field 'x'; linear_acceleration is a dict with the keys y"):
        condition.judge({"/imu": {"linear_acceleration": {"y": 1}}})


def test_a_function_gets_the_messages_of_topics_that_are_named(recording: robowidgets.Recording) -> None:
    spans = recording.find(lambda moment: moment["/imu"].linear_acceleration.x > 6, topics="/imu")
    assert [(span.start, span.end) for span in spans] == [(7, 9)]


@pytest.mark.parametrize(
    ("words", "code", "line"),
    [
        ("/imu.linear_acceleration.x > 7", 0, "8.000\t9.000\t1.000\t9"),
        ("abs(/imu.linear_acceleration.y)>7", 0, "8.000\t9.000\t1.000\t9"),
        ("/status.new.data == 'under way'", 0, "6.000\t9.000\t3.000\t"),
        ("/ready.data == true", 0, "2.000\t2.500\t0.500\t"),
        ("/imu.linear_acceleration.x > 70", 1, None),
        ("/imu.linear_acceleration.x", 2, None),
        ("/imu.linear_acceleration.x > fast", 2, None),
        ("/imu.nothing > 1", 2, None),
    ],
)
def test_the_command_takes_comparisons(
    recording: robowidgets.Recording, words: str, code: int, line: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["find", str(recording.path), "--field", words]) == code
    said = capsys.readouterr()
    assert (code == 2) == (said.err.count("\n") == 1)
    if line is not None:
        assert line in said.out.splitlines()


@pytest.mark.parametrize(
    ("name", "values", "condition"),
    [
        ("Int8", [0, -128, 100, 101], abs(field("/raw.data")) > 100),
        ("Int16", [0, -32768, 32767, 29999], abs(field("/raw.data")) > 30000),
        ("Int32", [0, -(2**31), 5], abs(field("/raw.data")) >= 2**31),
        ("Int64", [0, -(2**63), 2**63 - 1], abs(field("/raw.data")) == 2**63),
        ("UInt8", [0, 255], abs(field("/raw.data")) > 30),
        ("Float32", [0.7, 0.6, 0.8], field("/raw.data") >= 0.7),
        ("Float32", [0.1, 0.125], field("/raw.data") == 0.1),
        ("Float32", [0.7, -0.7, -0.8], abs(field("/raw.data")) >= 0.7),
    ],
)
def test_a_recording_is_judged_as_each_message_is(
    tmp_path: Path, name: str, values: list[float], condition: Condition
) -> None:
    messages = [(float(i), "/raw", {"data": value}) for i, value in enumerate(values)]
    with robowidgets.open(recorded.write(tmp_path / "x", {"/raw": f"std_msgs/msg/{name}"}, messages)) as recording:
        judged = [condition.judge({"/raw": one.message}).value for one in recording.messages("/raw")]
        spans = recording.find(condition)
        in_recording = [
            any(span.start <= i < span.end or span.start == i for span in spans) for i in range(len(values))
        ]
    assert in_recording == judged
