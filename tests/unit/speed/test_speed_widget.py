"""`SpeedWidget`: its Python interface, without a page."""

from __future__ import annotations

import logging
import struct
import threading
from collections.abc import Callable
from math import inf, isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from traitlets import TraitError

from robowidgets import Speed
from robowidgets.samples import AXES
from robowidgets.speed_widget import SpeedWidget
from robowidgets.widget.timed_frame import FRAME_HEADER

from ... import vectors
from ..forms import FORMS

TWIST = {
    "linear": {"x": 0.5, "y": 0.0, "z": 0.0},
    "angular": {"x": 0.0, "y": 0.0, "z": -0.25},
}
STAMPED = {"header": {"stamp": {"sec": 3, "nanosec": 4}, "frame_id": "base_link"}, "twist": TWIST}


def sent(speed: SpeedWidget) -> tuple[int, list[float], list[float], list[float], list[float]]:
    """The data for a newly opened page: axes in use, measured, commanded, least, greatest."""
    frame = speed.get_state()["_frame"]
    there, _, _, _, *values = struct.unpack_from("<ddqd26d", frame, FRAME_HEADER.size)
    assert len(frame) == FRAME_HEADER.size + struct.calcsize("<ddqd26d")
    return (int(there), *(values[i : i + 6] for i in range(0, 24, 6)))


def test_nothing_is_known_before_the_first_speed() -> None:
    speed = SpeedWidget()
    assert speed.speed is None
    assert speed.commanded is None
    assert speed.over_limits == {}
    assert all(isnan(v) for pair in speed.peaks.values() for v in pair)
    assert speed.get_state()["_frame"] == b""


class TestUpdate:
    @pytest.mark.parametrize("form", FORMS)
    def test_every_form_of_a_message_is_shown(self, form: Callable[..., Any]) -> None:
        speed = SpeedWidget()
        speed.update(form("geometry_msgs/TwistStamped", STAMPED))
        speed.command(form("geometry_msgs/Twist", TWIST))
        assert speed.speed == Speed((0.5, 0, 0), (0, 0, -0.25), 3_000_000_004, "base_link")
        assert speed.commanded == Speed((0.5, 0, 0), (0, 0, -0.25))
        assert sent(speed)[:3] == (3, [0.5, 0, 0, 0, 0, -0.25], [0.5, 0, 0, 0, 0, -0.25])

    def test_plain_arrays_are_shown_and_what_is_left_out_has_no_value(self) -> None:
        speed = SpeedWidget()
        speed.update(linear=np.array([0.5, 0, 0], np.float32))
        assert speed.speed is not None
        assert speed.speed.linear == (0.5, 0, 0)
        assert all(isnan(v) for v in speed.speed.angular)

    def test_bars_show_measured_or_commanded_speeds(self) -> None:
        assert SpeedWidget().bars == "measured"
        assert SpeedWidget(bars="commanded").get_state()["bars"] == "commanded"
        with pytest.raises(
            TraitError, match=r"'bars' trait.* expected any of \['measured', 'commanded'\], not .*'wanted'"
        ):
            SpeedWidget(bars="wanted")

    def test_a_command_may_come_alone(self) -> None:
        speed = SpeedWidget()
        speed.command(linear=(2, 0, 0), angular=(0, 0, 0))
        assert speed.speed is None
        assert speed.over_limits == {}
        assert sent(speed)[0] == 2

    def test_the_page_gets_the_frame_of_an_odometry(self) -> None:
        speed = SpeedWidget()
        speed.update({"child_frame_id": "base_footprint", "twist": {"twist": TWIST}})
        speed.command(TWIST)
        assert speed.get_state()["_about"] == {"frame_id": "base_footprint"}

    def test_commands_count_only_while_nothing_is_measured(self) -> None:
        speed = SpeedWidget()
        speed.command(TWIST)
        speed.command(TWIST)
        assert FRAME_HEADER.unpack_from(speed.get_state()["_frame"])[0] == 2
        speed.update(TWIST)
        speed.command(TWIST)
        assert FRAME_HEADER.unpack_from(speed.get_state()["_frame"])[0] == 3

    @pytest.mark.slow
    def test_a_real_recording_is_shown(self, data: Path) -> None:
        speed = SpeedWidget(linear_limits=0.2)
        greatest = 0.0
        with AnyReader([data / "good" / "turtlebot3_gazebo.bag"]) as reader:
            connections = [c for c in reader.connections if c.topic in ("/odom", "/cmd_vel")]
            for connection, _, raw in reader.messages(connections):
                message = reader.deserialize(raw, connection.msgtype)
                if connection.topic == "/odom":
                    speed.update(message)
                    greatest = max(greatest, message.twist.twist.linear.x)
                else:
                    speed.command(message)
        assert greatest > 0.1
        assert speed.peaks["linear.x"][1] == greatest
        assert speed.speed is not None
        assert speed.speed.frame_id == "base_footprint"
        assert speed.commanded is not None


class TestLimits:
    def test_they_are_one_and_one_by_default(self) -> None:
        speed = SpeedWidget()
        assert {speed.limits_of(axis) for axis in AXES} == {(-1.0, 1.0)}

    def test_a_number_stands_for_both_sides_and_an_axis_may_have_its_own(self) -> None:
        speed = SpeedWidget(linear_limits=0.5, angular_limits=[-1, np.float64(2)], limits={"linear.x": (-0.2, 0.4)})
        assert [speed.limits_of(axis) for axis in AXES] == [
            (-0.2, 0.4), (-0.5, 0.5), (-0.5, 0.5), (-1.0, 2.0), (-1.0, 2.0), (-1.0, 2.0),
        ]  # fmt: skip
        assert speed.get_state()["limits"] == {"linear.x": (-0.2, 0.4)}

    def test_speeds_past_them_are_named_below_and_above_hidden_or_not(self) -> None:
        speed = SpeedWidget(planar=True, limits={"linear.z": 0.1, "angular.z": (-0.3, 2)})
        speed.update(linear=(1.0, nan, 0.2), angular=(inf, 0, -0.4))
        assert speed.over_limits == {"linear.z": 0.2, "angular.x": inf, "angular.z": -0.4}

    def test_they_apply_to_what_is_on_show_when_they_change(self) -> None:
        speed = SpeedWidget()
        speed.update(linear=(0.5, 0, 0))
        speed.linear_limits = 0.4
        assert speed.over_limits == {"linear.x": 0.5}
        speed.limits = {"linear.x": 0.6}
        assert speed.over_limits == {}

    @pytest.mark.parametrize(("value", "limits", "state"), vectors.read()["limits"])
    def test_a_speed_is_past_them_by_more_than_rounding(self, value: Any, limits: Any, state: str) -> None:
        speed = SpeedWidget(linear_limits=limits)
        speed.update(linear=(float(value), 0, 0))
        assert (speed.over_limits == {"linear.x": float(value)}) == (state in ("over", "under"))

    def test_they_cannot_be_changed_unseen(self) -> None:
        speed = SpeedWidget(limits={"linear.x": 0.5})
        with pytest.raises(TypeError, match="does not support item assignment"):
            speed.limits["linear.x"] = 3

    @pytest.mark.parametrize(
        ("given", "said"),
        [
            ((1, -1), r"linear_limits: the limits are the wrong way round: .* got \(1, -1\); write \(-1, 1\)"),
            ((0.5, 1), r"min <= 0 <= max, because bars start at zero; got \(0.5, 1\); write \(0, 1\)"),
            ((-2, -1), r"got \(-2, -1\); write \(-2, 0\)"),
            ((0, 0), r"linear_limits: expected min below max, got \(0, 0\)"),
            ((0, nan), r"linear_limits: expected finite limits of at most 1e\+06 m/s; got \(0, nan\)"),
            (inf, r"linear_limits: expected finite limits of at most 1e\+06 m/s; got inf"),
            (1e9, r"of at most 1e\+06 m/s; got 1000000000.0"),
            (-1, r"linear_limits: expected a number above 0, or a pair .* with min <= 0 <= max, in m/s; got -1"),
            (0, r"expected a number above 0, or a pair .* got 0"),
            ((-1, 0, 1), r"expected a number above 0, or a pair .* got \(-1, 0, 1\)"),
            ("fast", r"expected a number above 0, or a pair .* got 'fast'"),
            (("-1", "1"), r"expected a number above 0, or a pair .* got \('-1', '1'\)"),
            (True, r"expected a number above 0, or a pair .* got True"),
        ],
    )  # fmt: skip
    def test_what_is_not_a_pair_around_zero_is_refused(self, given: Any, said: str) -> None:
        with pytest.raises(TraitError, match=said):
            SpeedWidget(linear_limits=given)
        speed = SpeedWidget()
        with pytest.raises(TraitError, match=r"^limits\['angular.z'\]: "):
            speed.limits = {"angular.z": given}
        assert speed.limits == {}

    def test_none_stands_for_no_limits_of_a_group_and_an_axis_is_left_out_instead(self) -> None:
        speed = SpeedWidget(linear_limits=None, limits={"linear.z": 0.1})
        speed.update(linear=(9, 0, 0.2), angular=(0, 0, 2))
        assert speed.over_limits == {"linear.z": 0.2, "angular.z": 2.0}
        with pytest.raises(TraitError, match=r"^limits\['linear.x'\]: expected a number above 0, .* got None"):
            speed.limits = {"linear.x": None}

    def test_angular_limits_are_named_with_their_unit(self) -> None:
        with pytest.raises(TraitError, match=r"angular_limits: expected .* in rad/s; got 'x'"):
            SpeedWidget(angular_limits="x")

    @pytest.mark.parametrize(
        ("given", "said"),
        [
            ({"linear.q": 1}, r"limits: no axis 'linear.q'; did you mean 'linear.\w'\? The axes are: linear.x"),
            ({"Linear.X": 1}, "limits: no axis 'Linear.X'; did you mean 'linear.x'"),
            ({3: 1}, r"limits: no axis 3\. The axes are: linear.x"),
            (1, r"limits: expected a dictionary of limits by axis, like \{'linear.x': \(-0.2, 0.5\)\}; got 1"),
        ],
    )  # fmt: skip
    def test_an_unknown_axis_is_refused_with_the_list(self, given: Any, said: str) -> None:
        with pytest.raises(TraitError, match=said):
            SpeedWidget(limits=given)


class TestPeaks:
    def test_no_change_is_missed_between_two_messages_to_the_page(self) -> None:
        speed = SpeedWidget()
        for x in [*np.linspace(0, 0.5, 500), 3.0, -2.0, *np.linspace(0.5, 0, 500)]:
            speed.update(linear=(x, 0, 0))
        assert speed.peaks["linear.x"] == (-2.0, 3.0)
        assert [values[0] for values in sent(speed)[3:]] == [-2.0, 3.0]

    def test_a_missing_value_leaves_them_and_infinity_is_one(self) -> None:
        speed = SpeedWidget()
        for x in [nan, 0.5, nan, inf]:
            speed.update(linear=(x, nan, 0))
        assert speed.peaks["linear.x"] == (0.5, inf)
        assert all(isnan(v) for v in speed.peaks["linear.y"])

    def test_a_reset_lets_them_start_from_the_speed_measured_last(self) -> None:
        speed = SpeedWidget()
        for x in (0.9, -0.9, 0.1):
            speed.update(linear=(x, 0, 0))
        speed.reset_peaks()
        assert speed.peaks["linear.x"] == (0.1, 0.1)
        speed.update(linear=(0.3, 0, 0))
        assert speed.peaks["linear.x"] == (0.1, 0.3)

    def test_a_reset_from_the_page_is_one_too(self) -> None:
        speed = SpeedWidget()
        for x in (0.9, 0.1):
            speed.update(linear=(x, 0, 0))
        speed.set_state({"_resets": 1})
        assert speed.peaks["linear.x"] == (0.1, 0.1)
        assert sent(speed)[4][0] == 0.1

    def test_a_reset_before_the_first_speed_shows_nothing(self) -> None:
        speed = SpeedWidget()
        speed.reset_peaks()
        assert speed.get_state()["_frame"] == b""

    def test_threads_miss_none(self) -> None:
        speed = SpeedWidget()
        start = threading.Barrier(4)

        def drive(sign: int) -> None:
            start.wait()
            for step in range(500):
                speed.update(linear=(sign * step, 0, 0))
                speed.command(linear=(sign, 0, 0))

        threads = [threading.Thread(target=drive, args=(sign,)) for sign in (-2, -1, 1, 3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert speed.peaks["linear.x"] == (-998.0, 1497.0)


class TestFreezing:
    def test_what_is_on_show_holds_still_and_the_newest_comes_back(self) -> None:
        speed = SpeedWidget()
        speed.update({**STAMPED, "twist": {**TWIST, "linear": {"x": 1.5, "y": nan, "z": 0}}})
        speed.command(TWIST)
        shown, peaks = speed.speed, speed.peaks
        speed.paused = True
        speed.update(linear=(0, 0, 0), angular=(9, 9, 9))
        speed.command(linear=(7, 0, 0))
        assert str(speed.speed) == str(speed.frozen) == str(shown)  # NaN is not equal to itself
        assert str(speed.peaks) == str(peaks)
        assert speed.over_limits == {"linear.x": 1.5}
        assert speed.commanded is not None
        assert speed.commanded.linear == (0.5, 0, 0)
        speed.paused = False
        assert speed.speed == Speed((0, 0, 0), (9, 9, 9))
        assert speed.frozen is None
        assert speed.commanded.linear[0] == 7.0
        assert speed.peaks["angular.x"] == (0.0, 9.0)

    def test_a_command_alone_is_frozen_as_a_command_alone(self) -> None:
        speed = SpeedWidget()
        speed.command(TWIST)
        speed.paused = True
        speed.update(TWIST)
        assert speed.speed is None
        assert speed.commanded == Speed((0.5, 0, 0), (0, 0, -0.25))

    def test_before_the_first_speed_there_is_none_until_it_is_released(self) -> None:
        speed = SpeedWidget(paused=True)
        speed.update(TWIST)
        assert (speed.speed, speed.commanded, speed.over_limits) == (None, None, {})
        speed.paused = False
        assert speed.speed == Speed((0.5, 0, 0), (0, 0, -0.25))


class TestErrors:
    @pytest.mark.parametrize(
        ("method", "messages", "fields", "error", "said"),
        [
            ("update", [{"ranges": []}], {}, TypeError, "^expected a message like geometry_msgs/Twist.* got a dict"),
            ("command", [{"ranges": []}], {}, TypeError, r"^command\(\): expected a message like geometry_msgs/Twist"),
            ("update", [], {}, TypeError, r"^update\(\) needs a message, or linear and angular \(three numbers each\)"),
            ("command", [], {}, TypeError, r"^command\(\) needs a message, or linear and angular"),
            ("update", [], {"speed": 3}, TypeError, r"^update\(\) has no field 'speed'; it takes a message, or linear"),
            ("update", [], {"liner": 3}, TypeError, r"has no field 'liner'; did you mean 'linear'\? It takes"),
            ("update", [TWIST], {"linear": 1}, TypeError, "takes a message or fields, not both; got .* and linear"),
            ("update", [], {"linear": (1, 2)}, ValueError, r"^linear: expected three numbers \(x, y, z\), got 2"),
            ("update", [], {"linear": 0.5}, TypeError, r"^linear: expected three numbers \(x, y, z\), got 0.5"),
            ("command", [], {"angular": "abc"}, TypeError, r"^command\(\): angular: expected three .*, got 'abc'$"),
        ],
    )  # fmt: skip
    def test_what_is_not_a_speed_is_refused_and_the_last_one_stays(
        self, method: str, messages: list[Any], fields: dict[str, Any], error: type[Exception], said: str
    ) -> None:
        speed = SpeedWidget()
        speed.update(TWIST)
        with pytest.raises(error, match=said):
            getattr(speed, method)(*messages, **fields)
        assert speed.speed == Speed((0.5, 0, 0), (0, 0, -0.25))
        assert speed.get_state()["_about"]["error"]

    def test_an_error_in_the_commands_stays_on_show_while_good_speeds_come(self) -> None:
        speed = SpeedWidget()
        with pytest.raises(TypeError):
            speed.command("stop")
        speed.update(TWIST)
        assert speed.get_state()["_about"]["error"].startswith("command(): expected a message")
        speed.command(TWIST)
        assert "error" not in speed.get_state()["_about"]

    def test_in_a_thread_it_is_reported_and_logged_instead_of_raised(self, caplog: pytest.LogCaptureFixture) -> None:
        speed = SpeedWidget(title="/odom")
        with caplog.at_level(logging.ERROR, "robowidgets"):
            thread = threading.Thread(target=speed.update, args=("stop",))
            thread.start()
            thread.join()
        assert "SpeedWidget /odom: a message could not be shown: expected a message like" in caplog.text
        assert speed.get_state()["_about"]["error"].startswith("expected a message like")

    def test_an_unknown_keyword_is_refused_by_name(self) -> None:
        with pytest.raises(TypeError, match=r"SpeedWidget\(\) has no keyword 'limit'; did you mean 'limits'\?"):
            SpeedWidget(limit=1)
        with pytest.raises(AttributeError, match="SpeedWidget has no trait 'planer'; did you mean 'planar'"):
            SpeedWidget().planer = True


@pytest.mark.parametrize("numbers", [(1.0, 0.5), (1.0,), ((1, 0, 0), (0, 0, 0.5))])
@pytest.mark.parametrize("method", ["update", "command"])
def test_numbers_without_names_are_refused_with_the_call_that_works(method: str, numbers: tuple[Any, ...]) -> None:
    words = rf"^{method}\(\) takes one message, or numbers by name: {method}\(linear=\(0.2, 0, 0\), angular="
    with pytest.raises(TypeError, match=words):
        getattr(SpeedWidget(), method)(*numbers)


@pytest.mark.parametrize(("word", "meant"), [("max_speed", "linear_limits"), ("freeze", "paused")])
def test_what_people_call_a_setting_leads_to_its_name(word: str, meant: str) -> None:
    with pytest.raises(TypeError, match=rf"^SpeedWidget\(\) has no keyword '{word}'; did you mean '{meant}'\?"):
        SpeedWidget(**{word: 1})


def test_a_widget_prints_the_speeds_on_show() -> None:
    speed = SpeedWidget(title="/odom")
    assert repr(speed) == "<SpeedWidget /odom: nothing yet>"
    speed.update(linear=(0.5, 0, 0), angular=(0, 0, -0.25))
    speed.command(linear=(0, 0, 0))
    assert repr(speed) == "<SpeedWidget /odom: measured linear.x 0.50 m/s, angular.z -0.25 rad/s; commanded at rest>"
    speed.close()


class TestOverTime:
    def test_is_seconds_from_none_to_the_longest_history(self) -> None:
        assert SpeedWidget().over_time == 0
        assert SpeedWidget(over_time=10).over_time == 10.0
        for wrong in (-1, 601, float("nan")):
            with pytest.raises(TraitError, match=r"over_time: expected seconds from 0 \(none\) to 600, got"):
                SpeedWidget(over_time=wrong)
