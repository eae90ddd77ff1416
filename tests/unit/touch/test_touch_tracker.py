"""`TouchTracker` keeps states, counts and timed releases, at times that the tests name."""

from __future__ import annotations

from math import inf, nan
from pathlib import Path

import pytest

from robowidgets.messages import to_touch
from robowidgets.samples import Touch, TouchMode, TouchState
from robowidgets.samples.touch_tracker import TouchSensor, TouchTracker

MS = 1_000_000
S = 1_000 * MS
FREE, TOUCHED, UNKNOWN = TouchState.FREE, TouchState.TOUCHED, TouchState.UNKNOWN


def event(name: str, touched: bool | None) -> Touch:
    return Touch({name: touched}, TouchMode.EVENT, ("left", "center", "right"))


def level(**touched: bool | None) -> Touch:
    return Touch(touched)


def presence(*touched: str, sensors: tuple[str, ...] = ("left", "right")) -> Touch:
    return Touch(dict.fromkeys(touched, True), TouchMode.PRESENCE, sensors)


def said(tracker: TouchTracker, now_ns: int) -> dict[str, TouchState]:
    return {name: sensor.state for name, sensor in tracker.states(now_ns).items()}


def test_nothing_is_known_before_the_first_word() -> None:
    assert TouchTracker().states(0) == {}
    assert TouchTracker().next_change_ns(0) is None


class TestEvents:
    def test_a_sensor_is_unknown_until_its_first_event(self) -> None:
        tracker = TouchTracker()
        tracker.apply(event("center", True), 5 * S)
        assert said(tracker, 5 * S) == {"left": UNKNOWN, "center": TOUCHED, "right": UNKNOWN}
        assert tracker.states(5 * S)["left"] == TouchSensor()

    def test_a_state_holds_until_the_next_event_of_that_sensor(self) -> None:
        tracker = TouchTracker()
        tracker.apply(event("left", True), 0)
        tracker.apply(event("right", False), 1 * S)
        assert said(tracker, 10_000 * S) == {"left": TOUCHED, "center": UNKNOWN, "right": FREE}
        assert tracker.next_change_ns(10_000 * S) is None

    def test_touches_are_counted_and_timed_from_their_change(self) -> None:
        tracker = TouchTracker()
        for at, touched in [(1, True), (2, True), (3, False), (4, False), (5, True)]:
            tracker.apply(event("left", touched), at * S)
        assert tracker.states(9 * S)["left"] == TouchSensor(TOUCHED, touches=2, since_ns=5 * S)
        tracker.apply(event("left", False), 6 * S)
        assert tracker.states(9 * S)["left"] == TouchSensor(FREE, touches=2, since_ns=6 * S)


class TestLevels:
    def test_the_first_word_counts_when_it_is_a_touch(self) -> None:
        tracker = TouchTracker()
        tracker.apply(level(left=True, right=False), 1 * S)
        assert tracker.states(1 * S) == {
            "left": TouchSensor(TOUCHED, touches=1, since_ns=1 * S),
            "right": TouchSensor(FREE, touches=0, since_ns=1 * S),
        }

    def test_none_makes_a_sensor_unknown_again(self) -> None:
        tracker = TouchTracker()
        tracker.apply(level(left=True), 1 * S)
        tracker.apply(level(left=None), 2 * S)
        assert tracker.states(2 * S)["left"] == TouchSensor(UNKNOWN, touches=1, since_ns=2 * S)
        tracker.apply(level(left=True), 3 * S)
        assert tracker.states(3 * S)["left"].touches == 2

    def test_none_at_first_is_not_a_change(self) -> None:
        tracker = TouchTracker()
        tracker.apply(level(left=None), 1 * S)
        assert tracker.states(1 * S)["left"] == TouchSensor()

    def test_sensors_stand_in_the_order_of_their_first_mention(self) -> None:
        tracker = TouchTracker()
        tracker.apply(level(right=True), 0)
        tracker.apply(event("left", True), 1)
        assert list(tracker.states(1)) == ["right", "left", "center"]


class TestPresence:
    def test_a_sensor_absent_at_first_is_free_and_not_unknown(self) -> None:
        tracker = TouchTracker()
        tracker.apply(presence(), 3 * S)
        assert tracker.states(3 * S)["left"] == TouchSensor(FREE, since_ns=3 * S)

    def test_a_gap_shorter_than_the_hold_is_not_a_release(self) -> None:
        tracker = TouchTracker(hold=0.15)
        tracker.apply(presence("left"), 0)
        for at in (16, 32, 149):
            tracker.apply(presence(), at * MS)
        tracker.apply(presence("left"), 149 * MS)
        tracker.apply(presence(), 150 * MS)
        assert tracker.states(298 * MS)["left"].state is TOUCHED
        assert tracker.states(298 * MS)["left"].touches == 1
        assert tracker.states(298 * MS)["left"].since_ns == 0

    def test_the_release_comes_when_the_hold_is_over_and_not_a_nanosecond_before(self) -> None:
        tracker = TouchTracker(hold=0.15)
        tracker.apply(presence("left", "right"), 0)
        tracker.apply(presence("right"), 100 * MS)
        assert tracker.next_change_ns(100 * MS) == 150 * MS
        assert said(tracker, 150 * MS - 1) == {"left": TOUCHED, "right": TOUCHED}
        assert said(tracker, 150 * MS) == {"left": FREE, "right": TOUCHED}
        assert tracker.states(10 * S)["left"].since_ns == 150 * MS
        assert tracker.next_change_ns(150 * MS) == 250 * MS
        assert said(tracker, 250 * MS) == {"left": FREE, "right": FREE}
        assert tracker.next_change_ns(250 * MS) is None

    def test_an_unread_release_still_ends_the_touch(self) -> None:
        tracker = TouchTracker(hold=0.15)
        tracker.apply(presence("left"), 0)
        tracker.apply(presence("left"), 150 * MS)
        assert tracker.states(150 * MS)["left"].touches == 2
        assert tracker.states(150 * MS)["left"].since_ns == 150 * MS

    def test_without_a_hold_the_next_message_releases(self) -> None:
        tracker = TouchTracker(hold=0, timeout=inf)
        tracker.apply(presence("left"), 0)
        assert said(tracker, 5 * S)["left"] is TOUCHED
        tracker.apply(presence(), 5 * S)
        assert said(tracker, 5 * S)["left"] is FREE

    def test_silence_releases_after_the_hold_when_no_timeout_is_set(self) -> None:
        tracker = TouchTracker(hold=0.2)
        tracker.apply(presence("bumper", sensors=()), 0)
        assert tracker.next_change_ns(0) == 200 * MS
        assert said(tracker, 200 * MS) == {"bumper": FREE}

    def test_silence_releases_after_the_timeout_and_absence_after_the_hold(self) -> None:
        tracker = TouchTracker(hold=0.1, timeout=2.0)
        tracker.apply(presence("left"), 0)
        assert tracker.next_change_ns(0) == 2 * S
        assert said(tracker, 2 * S - 1)["left"] is TOUCHED
        assert said(tracker, 2 * S)["left"] is FREE
        tracker.apply(presence(), 50 * MS)
        assert tracker.next_change_ns(50 * MS) == 100 * MS

    def test_an_infinite_timeout_waits_for_a_word(self) -> None:
        tracker = TouchTracker(hold=0.1, timeout=inf)
        tracker.apply(presence("left"), 0)
        assert tracker.next_change_ns(0) is None
        assert said(tracker, 10**6 * S)["left"] is TOUCHED
        tracker.apply(presence(), 10**6 * S)
        assert said(tracker, 10**6 * S)["left"] is FREE

    def test_a_changed_hold_is_in_force_at_once(self) -> None:
        tracker = TouchTracker(hold=0.1)
        tracker.apply(presence("left"), 0)
        tracker.hold = 1.0
        assert tracker.next_change_ns(0) == 1 * S
        tracker.timeout = 3.0
        assert tracker.next_change_ns(0) == 3 * S

    def test_a_sensor_that_came_by_name_only_is_released_too(self) -> None:
        tracker = TouchTracker(hold=0.1, timeout=inf)
        tracker.apply(presence("bumper", sensors=()), 0)
        tracker.apply(presence(sensors=()), 20 * MS)
        assert said(tracker, 100 * MS) == {"bumper": FREE}

    def test_a_level_overrules_the_hold(self) -> None:
        tracker = TouchTracker()
        tracker.apply(presence("left"), 0)
        tracker.apply(level(left=True), 1 * MS)
        assert tracker.next_change_ns(1 * MS) is None
        assert said(tracker, 10 * S)["left"] is TOUCHED

    def test_a_level_of_one_sensor_is_left_alone_by_the_absence_of_others(self) -> None:
        tracker = TouchTracker()
        tracker.apply(level(button=True), 0)
        tracker.apply(presence(), 1 * S)
        assert said(tracker, 10 * S) == {"button": TOUCHED, "left": FREE, "right": FREE}


class TestClockGoingBack:
    def test_states_and_counts_stay_and_durations_begin_again(self) -> None:
        tracker = TouchTracker()
        tracker.apply(event("left", True), 100 * S)
        tracker.apply(event("right", False), 2 * S)
        left = tracker.states(3 * S)["left"]
        assert left == TouchSensor(TOUCHED, touches=1, since_ns=2 * S)

    def test_a_touch_is_held_no_longer_than_its_hold(self) -> None:
        tracker = TouchTracker(hold=0.15)
        tracker.apply(presence("left"), 100 * S)
        tracker.apply(presence(), 2 * S)
        assert tracker.next_change_ns(2 * S) == 2 * S + 150 * MS
        assert said(tracker, 2 * S + 150 * MS)["left"] is FREE


def test_a_reset_forgets_counts_and_states_and_keeps_the_names() -> None:
    tracker = TouchTracker()
    tracker.apply(presence("right"), 1 * S)
    tracker.reset()
    assert tracker.states(1 * S) == {"left": TouchSensor(), "right": TouchSensor()}
    assert tracker.next_change_ns(1 * S) is None


def test_asking_changes_nothing() -> None:
    tracker = TouchTracker()
    tracker.apply(presence("left"), 0)
    assert said(tracker, 10 * S)["left"] is FREE
    assert said(tracker, 0)["left"] is TOUCHED


@pytest.mark.parametrize(
    ("times", "error", "text"),
    [
        ({"hold": -0.1}, ValueError, r"^hold: expected seconds, 0 or more, got -0.1$"),
        ({"hold": nan}, ValueError, r"^hold: expected seconds, 0 or more, got nan$"),
        ({"hold": inf}, ValueError, r"^hold: expected seconds, 0 or more, got inf$"),
        ({"hold": "long"}, TypeError, r"^hold: expected a number, got 'long'$"),
        ({"timeout": -1}, ValueError, r"^timeout: expected seconds, 0 or more, or None, got -1.0$"),
        ({"timeout": nan}, ValueError, r"^timeout: expected seconds, 0 or more, or None, got nan$"),
        ({"timeout": True}, TypeError, r"^timeout: expected a number, got True$"),
    ],
)
def test_times_out_of_range_are_refused(times: dict, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        TouchTracker(**times)


def test_a_real_neato_bumps_once(data: Path) -> None:
    from rosbags.highlevel import AnyReader

    tracker = TouchTracker()
    with AnyReader([data / "good" / "neato_fsm_zstd.mcap"]) as reader:
        start = reader.start_time
        bump = [c for c in reader.connections if c.topic == "/bump"]
        for connection, at, raw in reader.messages(bump):
            tracker.apply(to_touch(reader.deserialize(raw, connection.msgtype)), at)
    sensors = tracker.states(at)
    assert {name: sensor.touches for name, sensor in sensors.items()} == {
        "left side": 0,
        "left front": 1,
        "right front": 1,
        "right side": 0,
    }
    assert all(sensor.state is FREE for sensor in sensors.values())
    assert (sensors["left front"].since_ns - start) / 1e9 == pytest.approx(24.07, abs=0.01)
