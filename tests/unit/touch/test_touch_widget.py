"""`TouchWidget`: its Python interface, without a page."""

from __future__ import annotations

import json
import logging
import threading
from collections.abc import Callable, Iterator
from math import inf, nan
from pathlib import Path
from queue import Queue

import numpy as np
import pytest
from comm.base_comm import BaseComm
from traitlets import TraitError

import robowidgets
from robowidgets import Touch, TouchMode, TouchState, TouchWidget
from robowidgets.samples.touch_tracker import TouchTracker
from robowidgets.widget.pacer import pacer
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..pages import synced
from ..recordings import hazards
from ..senders import get_timers

FREE, TOUCHED, UNKNOWN = TouchState.FREE, TouchState.TOUCHED, TouchState.UNKNOWN
S = 1_000_000_000
Rows = dict[str, tuple[str, int, float | None]]


def contact(*names: str) -> dict:
    return {"contacts": [{"collision1": {"name": name}, "collision2": {"name": "wall"}} for name in names]}


def rows(frame: bytes) -> Rows:
    return {name: (state, touches, seconds) for name, state, touches, seconds in json.loads(frame[FRAME_HEADER.size :])}


def sent(touch: TouchWidget) -> Rows:
    """The data for a newly opened page."""
    return rows(touch.get_state()["_frame"])


@pytest.fixture
def next_frame(monkeypatch: pytest.MonkeyPatch) -> Callable[[TouchWidget], Rows]:
    """Waits for the next messages of a widget to the page, one by one."""
    frames: Queue[tuple[BaseComm, bytes]] = Queue()

    def send(comm: BaseComm, data: dict, metadata: object = None, buffers: list[bytes] = ()) -> None:
        if ["_frame"] in data.get("buffer_paths", ()):  # a question to the page has none
            frames.put((comm, bytes(buffers[data["buffer_paths"].index(["_frame"])])))

    def receive(widget: TouchWidget) -> Rows:
        while True:
            comm, frame = frames.get(timeout=60)
            if comm is widget.comm:
                return rows(frame)

    monkeypatch.setattr(BaseComm, "send", send)
    return receive


@pytest.fixture
def touch() -> Iterator[TouchWidget]:
    widget = TouchWidget(title="/bumper")
    yield widget
    widget.close()


class TestStates:
    def test_are_none_before_the_first_message(self, touch: TouchWidget) -> None:
        assert touch.states == {}
        assert touch.touches == {}

    def test_follow_the_messages_and_are_counted(self, touch: TouchWidget) -> None:
        for state in (1, 0, 1):
            touch.update({"bumper": 0, "state": state})
        touch.update({"bumper": 2, "state": 0})
        assert touch.states == {"left": TOUCHED, "center": UNKNOWN, "right": FREE}
        assert touch.touches == {"left": 2, "center": 0, "right": 0}

    def test_may_be_given_by_name(self, touch: TouchWidget) -> None:
        touch.update(left=True, right=None)
        touch.update(left=False)
        assert touch.states == {"left": FREE, "right": UNKNOWN}

    def test_cover_the_selected_sensors_known_or_not(self, touch: TouchWidget) -> None:
        touch.update(left=True, right=False)
        touch.sensors = ["right", "tail"]
        assert touch.states == {"right": FREE, "tail": UNKNOWN}
        assert touch.touches == {"right": 0, "tail": 0}

    def test_hold_still_while_frozen(self, touch: TouchWidget) -> None:
        touch.update(left=True)
        assert touch.frozen is None
        touch.paused = True
        touch.update(left=False, right=True)
        assert touch.states == touch.frozen == {"left": TOUCHED}
        assert touch.touches == {"left": 1}
        touch.paused = False
        assert touch.states == {"left": FREE, "right": TOUCHED}
        assert touch.frozen is None

    def test_are_none_while_frozen_before_the_first_message(self) -> None:
        touch = TouchWidget(paused=True)
        touch.update(left=True)
        assert touch.states == {}
        touch.sensors = ["left"]
        assert touch.states == {"left": UNKNOWN}
        touch.paused = False
        assert touch.states == {"left": TOUCHED}

    def test_are_unknown_after_a_reset(self, touch: TouchWidget) -> None:
        touch.update(left=True, right=False)
        touch.reset()
        assert touch.states == {"left": UNKNOWN, "right": UNKNOWN}
        assert touch.touches == {"left": 0, "right": 0}
        touch.update(left=True)
        assert touch.touches["left"] == 1

    def test_of_contacts_are_on_the_robots_own_side(self) -> None:
        touch = TouchWidget(sensors=["bumper", "arm"])
        touch.update({"states": [{"collision1_name": "wall", "collision2_name": "bumper"}]})
        assert touch.states == {"bumper": TOUCHED, "arm": FREE}


class TestPage:
    def test_gets_every_sensor_whatever_is_selected(self, touch: TouchWidget) -> None:
        touch.sensors = ["right"]
        touch.update({"left": True, "right": False, "tail": None})
        state = sent(touch)
        assert {name: row[:2] for name, row in state.items()} == {
            "left": ("touched", 1),
            "right": ("free", 0),
            "tail": ("unknown", 0),
        }
        assert state["left"][2] >= 0
        assert state["tail"][2] is None

    def test_gets_durations_of_now_when_it_opens_later(self, touch: TouchWidget) -> None:
        touch.update(left=True)
        first = sent(touch)["left"][2]
        assert sent(touch)["left"][2] > first

    def test_knows_the_dialect_of_its_source(self, touch: TouchWidget) -> None:
        touch.update({"bumper": 0, "state": 1})
        assert touch.get_state()["_about"] == {"dialect": "kobuki_msgs/BumperEvent", "mode": "event"}

    def test_gets_numbers_only_that_json_has(self) -> None:
        touch = TouchWidget(timeout=inf)
        touch.update(left=None)
        json.dumps({k: v for k, v in touch.get_state().items() if not isinstance(v, bytes)}, allow_nan=False)

    def test_gets_a_release_when_it_is_due_without_another_message(
        self, next_frame: Callable[[TouchWidget], Rows]
    ) -> None:
        touch = TouchWidget(hold=1.0)
        touch.update(contact("bumper"))
        states = []
        while "free" not in states:
            states.append(next_frame(touch)["bumper"][0])
        assert states[0] == "touched"
        assert touch.states == {"bumper": FREE}
        assert touch.touches == {"bumper": 1}

    def test_gets_a_release_sooner_when_the_hold_is_cut(self, next_frame: Callable[[TouchWidget], Rows]) -> None:
        touch = TouchWidget(hold=3600.0)
        touch.update(contact("bumper"))
        assert next_frame(touch)["bumper"][0] == "touched"
        touch.hold = 0.0
        assert next_frame(touch)["bumper"][0] == "free"

    def test_gets_states_when_they_change_and_no_further_sample_with_each_beat(self, touch: TouchWidget) -> None:
        touch.update(left=True)
        pacer.flush()
        frame = synced(touch, "_frame")
        touch._beat_at = 0.0
        touch.send_newest()
        assert (synced(touch, "_frame"), touch._beat_at > 0.0) == (frame, True)

    def test_gets_a_reset(self, touch: TouchWidget, next_frame: Callable[[TouchWidget], Rows]) -> None:
        touch.update(left=True)
        assert next_frame(touch)["left"][:2] == ("touched", 1)
        touch.reset()
        assert next_frame(touch)["left"] == ("unknown", 0, None)

    def test_has_no_appointment_with_a_closed_widget(self, next_frame: Callable[[TouchWidget], Rows]) -> None:
        touch = TouchWidget(hold=3600.0)
        touch.update(contact("bumper"))
        next_frame(touch)
        touch.close()
        assert touch not in get_timers(pacer)

    def test_makes_no_appointment_while_it_is_closed(self, monkeypatch: pytest.MonkeyPatch) -> None:
        touch = TouchWidget(hold=3600.0)
        closing = threading.Thread(target=touch.close)

        def send(*_: object, **__: object) -> None:
            if closing.ident is None:  # the pacer may send, too
                closing.start()
            closing.join(0.05)  # the part that comes while something is being sent

        touch.update(contact("bumper"))
        pacer.flush()
        monkeypatch.setattr(BaseComm, "send", send)
        touch.update(contact("bumper"))
        pacer.flush()
        closing.join()
        assert touch not in get_timers(pacer)


class TestRecordings:
    def test_a_tracker_is_shown_at_a_time_that_stands_still(self, touch: TouchWidget) -> None:
        tracker = TouchTracker()
        tracker.apply(Touch({"left": True}, TouchMode.PRESENCE, ("left",), dialect="a/B"), 100 * S)
        touch.show(tracker, 100 * S + S // 10)
        assert touch.states == {"left": TOUCHED}
        assert sent(touch) == sent(touch) == {"left": ("touched", 1, 0.1)}
        assert touch.get_state()["_about"] == {"dialect": "a/B", "mode": "presence", "still": True}
        touch.show(tracker, 101 * S)
        assert touch.states == {"left": FREE}

    def test_only_messages_count_and_not_looks_at_them(self, touch: TouchWidget) -> None:
        tracker = TouchTracker()
        for now in (1, 2, 3):
            touch.show(tracker, now)
        assert sent(touch) == {}
        assert FRAME_HEADER.unpack_from(synced(touch, "_frame"))[0] == 0
        tracker.apply(Touch({"left": True}), 4)
        for now in (5, 6):
            touch.show(tracker, now)
        sent(touch)
        assert FRAME_HEADER.unpack_from(synced(touch, "_frame"))[0] == 1

    def test_no_release_is_awaited(self, touch: TouchWidget, next_frame: Callable[[TouchWidget], Rows]) -> None:
        tracker = TouchTracker(hold=3600.0)
        tracker.apply(Touch({"left": True}, TouchMode.PRESENCE), 0)
        touch.show(tracker, 1)
        next_frame(touch)
        assert touch not in get_timers(pacer)

    def test_a_live_message_sets_the_clock_going_again(self, touch: TouchWidget) -> None:
        tracker = TouchTracker()
        tracker.apply(Touch({"left": True}), 100 * S)
        touch.show(tracker, 200 * S)
        touch.update(right=True)
        assert touch.states == {"left": TOUCHED, "right": TOUCHED}
        assert "still" not in touch.get_state()["_about"]
        assert sent(touch)["right"][2] < 100


class TestErrors:
    @pytest.mark.parametrize(
        ("arguments", "error", "text"),
        [
            (({"bumper": 9, "state": 1},), ValueError, r"^bumper: expected 0 \(left\), .*, got 9$"),
            ((["left"],), TypeError, r"^expected sensor names with True, False or None, .*; got a list: "),
            ((), TypeError, r"^update\(\) needs a message, or sensors by name, like update\(left=True, right=False\)$"),
        ],
    )
    def test_are_raised_to_the_caller_and_shown(
        self, touch: TouchWidget, arguments: tuple, error: type[Exception], text: str
    ) -> None:
        touch.update(left=True)
        with pytest.raises(error, match=text):
            touch.update(*arguments)
        assert touch.states == {"left": TOUCHED}
        assert touch.get_state()["_about"]["error"].startswith(text[1:8].replace("\\", ""))

    def test_one_and_zero_are_states_by_name(self, touch: TouchWidget) -> None:
        touch.update(left=1, right=np.int64(0), center=np.True_)
        assert touch.states == {"left": TouchState.TOUCHED, "right": TouchState.FREE, "center": TouchState.TOUCHED}

    def test_several_arguments_are_refused_with_the_call_that_works(self, touch: TouchWidget) -> None:
        words = r"^update\(\) takes one message, or numbers by name: update\(left=True, right=False\); got False$"
        with pytest.raises(TypeError, match=words):
            touch.update(True, False)

    def test_a_message_and_sensors_are_too_much(self, touch: TouchWidget) -> None:
        with pytest.raises(
            TypeError, match=r"^update\(\) takes a message or sensors, not both; got a message and left$"
        ):
            touch.update({"right": True}, left=True)

    def test_an_invalid_state_is_refused_by_name(self, touch: TouchWidget) -> None:
        with pytest.raises(TypeError, match=r"^left: expected True, False or None in a mapping of .*, got 'yes'$"):
            touch.update(left="yes")
        with pytest.raises(TypeError, match=r"^left: expected True, False or None in a mapping of .*, got 2; "):
            touch.update(left=2)
        with pytest.raises(TypeError, match=r"^left: expected True, False or None in a mapping of .*, got 1.0; "):
            touch.update(left=1.0)

    def test_go_away_with_the_next_good_message(self, touch: TouchWidget) -> None:
        with pytest.raises(ValueError, match="got 9"):
            touch.update({"bumper": 9, "state": 1})
        touch.update(left=True)
        assert "error" not in touch.get_state()["_about"]

    def test_are_logged_in_a_callback(self, touch: TouchWidget, caplog: pytest.LogCaptureFixture) -> None:
        with caplog.at_level(logging.ERROR, "robowidgets"):
            thread = threading.Thread(target=touch.update, args=({"bumper": 9, "state": 1},))
            thread.start()
            thread.join()
        assert "TouchWidget /bumper: a message could not be shown: bumper: expected 0 (left)" in caplog.text
        assert touch.get_state()["_about"]["error"].startswith("bumper: expected 0 (left)")

    @pytest.mark.parametrize(
        ("option", "text"),
        [
            ({"hold": -1.0}, r"^hold: expected seconds, 0 or more, got -1.0$"),
            ({"hold": inf}, r"^hold: expected seconds, 0 or more, got inf$"),
            ({"timeout": nan}, r"^timeout: expected seconds, 0 or more, or None, got nan$"),
            ({"angles": {"left": inf}}, r"^angles\['left'\]: expected a finite number of radians, got inf$"),
            (
                {"angles": {"left": 0.9, "back": 180}},
                r"^angles\['back'\]: expected radians within ±2 pi, got 180.0; math.radians\(\) makes them of degrees$",
            ),
            ({"angles": {"left": "front"}}, r"^angles\['left'\]: expected radians, or degrees as in .*, got 'front'$"),
            ({"sensors": ["left", "right", "left"]}, r"^sensors: expected each name once, got 'left' more than once$"),
            ({"labels": {"left": 5}}, r"'labels'.*unicode string.*5"),
            ({"hold": "long"}, r"'hold'.*float.*'long'"),
        ],
    )
    def test_of_options_are_reported_by_name_and_leave_the_old_value(
        self, touch: TouchWidget, option: dict, text: str
    ) -> None:
        (name, value) = next(iter(option.items()))
        before = getattr(touch, name)
        with pytest.raises(TraitError, match=text):
            setattr(touch, name, value)
        assert getattr(touch, name) == before
        with pytest.raises(TraitError, match=text):
            TouchWidget(**option)

    def test_of_unknown_keywords_name_a_near_one(self) -> None:
        with pytest.raises(TypeError, match=r"has no keyword 'label'; did you mean 'labels'\?"):
            TouchWidget(label={"left": "L"})


def test_updates_from_many_threads_all_count(touch: TouchWidget) -> None:
    def bump(name: str) -> None:
        for pressed in [True, False] * 50:
            touch.update({name: pressed})

    threads = [threading.Thread(target=bump, args=(name,)) for name in ("a", "b", "c", "d")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert touch.touches == {"a": 50, "b": 50, "c": 50, "d": 50}


def test_a_widget_prints_the_states_on_show(touch: TouchWidget) -> None:
    assert repr(touch) == "<TouchWidget /bumper: nothing yet>"
    touch.update(left=True, center=False, right=None)
    assert repr(touch) == "<TouchWidget /bumper: left touched, center free, right unknown>"


def test_a_player_holds_touches_for_as_long_as_its_widget_says(tmp_path: Path) -> None:
    touched = {0.0: True, 0.1: False, 2.0: False}
    with robowidgets.open(hazards.write(tmp_path / "drive", touched)) as recording:
        player = recording.show(scanogram=False)
        (view,) = player.views

        def at(seconds: float) -> tuple[str, TouchState]:
            (frame,) = view.track.frames(seconds, seconds)
            view.track.seek(seconds)
            return rows(frame.frame)["left"][0], view.widget.states["left"]

        assert at(0.5) == ("free", FREE)
        view.widget.hold = 1.0
        assert at(0.5) == ("touched", TOUCHED)
        assert at(1.0) == ("free", FREE), "a second after the message that listed it"
        view.widget.hold = 0.15
        assert at(0.5) == ("free", FREE)
        player.close()
