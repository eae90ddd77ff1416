"""`DriveWidget`: what it takes from the page, and what reaches the robot."""

from __future__ import annotations

import gc
import logging
import threading
from collections.abc import Iterator
from math import inf, nan
from types import SimpleNamespace
from typing import Any

import pytest
import traitlets

from robowidgets import DriveWidget, Speed
from robowidgets._dead_man import HOLD, ZERO
from robowidgets._grip import Grip
from robowidgets.feeds import Driving, Feed

from .feeds.scripted import CMD_VEL, SCAN, Scripted
from .waiting import wait_for


class Pad(DriveWidget):
    """A pad whose answers to the page are kept, and whose robot remembers."""

    answers: list[dict[str, Any]] = []  # noqa: RUF012
    heard: list[tuple[float, float]] = []  # noqa: RUF012

    def __init__(self, **kwargs: Any) -> None:
        self.answers = []
        self.heard = []
        super().__init__(**{"send": lambda *speed: self.heard.append(speed), **kwargs})

    def send(self, content: Any) -> None:
        self.answers.append(content)

    def hear(self, act: str, press: str = "p", **more: Any) -> dict[str, Any]:
        """A message of the page; the answer."""
        self._handle_custom_msg({"act": act, "press": press, **more}, [])
        return self.answers[-1]

    def press(self, press: str = "p") -> int:
        token: int = self.hear("press", press)["token"]
        return token

    def rests(self) -> None:
        wait_for(lambda: self._dead_man is None or self._dead_man._thread is None, "the pad rests")


@pytest.fixture
def pad() -> Iterator[Pad]:
    made = Pad()
    yield made
    made.close()


@pytest.fixture
def now(pad: Pad) -> list[float]:
    """The time by which the pad judges what is fresh."""
    time = [100.0]
    pad._grip = Grip(lambda: time[0])
    return time


class TestFromThePage:
    def test_a_press_that_is_held_drives_by_shares_of_the_limits_until_it_is_let_go(self, pad: Pad) -> None:
        pad.linear_limit, pad.angular_limit = 0.4, 2
        token = pad.press()
        assert pad.heard == []
        answer = pad.hear("hold", token=token, forward=0.5, turn=-1)
        assert answer["token"] > token
        wait_for(lambda: pad.commanded == Speed((0.2, 0, 0), (0, 0, -2.0)), "it was told")
        assert pad.hear("release") == {"press": "p", "over": "released"}
        pad.rests()
        assert pad.heard == [(0.2, -2.0), ZERO]
        assert pad.commanded == Speed((0, 0, 0), (0, 0, 0))

    def test_a_page_that_vanishes_stops_it(self, pad: Pad) -> None:
        pad.hear("hold", token=pad.press(), forward=1)
        pad.rests()
        assert pad.heard == [(0.5, 0.0), ZERO]

    def test_a_queue_of_messages_that_waited_moves_nothing(self, pad: Pad, now: list[float]) -> None:
        token = pad.press()
        pad.hear("hold", token=token, forward=0.1)
        wait_for(lambda: pad.heard, "it drove")
        newest = pad.answers[-1]["token"]
        now[0] += HOLD + 0.01
        for i in range(20):
            assert pad.hear("hold", token=newest, forward=1 - i / 100) == {"press": "p", "over": "late"}
        pad.rests()
        assert pad.heard == [(0.05, 0.0), ZERO]

    def test_a_press_that_went_stale_stays_over_though_a_fresh_token_is_guessed(
        self, pad: Pad, now: list[float]
    ) -> None:
        token = pad.press()
        now[0] += HOLD + 0.01
        pad.hear("hold", token=token, forward=1)
        assert pad.hear("hold", token=token + 1, forward=1)["over"] == "late"
        pad.rests()
        assert (0.5, 0.0) not in pad.heard

    def test_a_message_that_is_a_little_old_counts(self, pad: Pad, now: list[float]) -> None:
        token = pad.press()
        now[0] += HOLD - 0.1
        assert "token" in pad.hear("hold", token=token, forward=1)

    def test_nothing_moves_without_a_press_or_after_it(self, pad: Pad) -> None:
        assert pad.hear("hold", token=0, forward=1)["over"] == "late"
        token = pad.press()
        pad.hear("release")
        assert pad.hear("hold", token=token, forward=1)["over"] == "late"
        pad.rests()
        assert set(pad.heard) <= {ZERO}

    def test_the_newest_press_wins_and_another_page_is_told(self, pad: Pad) -> None:
        old = pad.press("old")
        new = pad.press("new")
        assert pad.hear("hold", "old", token=old, forward=1) == {"press": "old", "over": "taken"}
        assert pad.hear("release", "old") == {"press": "old", "over": "released"}
        assert "token" in pad.hear("hold", "new", token=new, forward=-1)
        pad.rests()
        assert pad.heard == [(-0.5, 0.0), ZERO]

    @pytest.mark.parametrize(
        ("message", "text"),
        [
            ({"forward": None}, "forward: expected a share of the limit within -1 and 1, got None"),
            ({"forward": nan}, "forward: expected a share of the limit within -1 and 1, got nan"),
            ({"turn": -inf}, "turn: expected a share of the limit within -1 and 1, got -inf"),
            ({"turn": 1e300}, "turn: expected a share of the limit within -1 and 1, got 1e+300"),
            ({"forward": True}, "forward: expected a share of the limit within -1 and 1, got True"),
            ({"turn": 10**400}, "turn: expected a share of the limit within -1 and 1, got 1"),
            ({"token": "1"}, "token: expected a whole number, got '1'"),
            ({"press": 7}, "press: expected the name of a press, got 7"),
            ({"press": "p" * 65}, "press: expected the name of a press, got 'ppp"),
            ({"act": "fly"}, "act: expected press, hold or release, got 'fly'"),
            ({"speed": 3}, "expected a message of the pad, got {"),
        ],
    )
    def test_what_is_no_speed_stops_and_is_logged(
        self, pad: Pad, message: dict[str, Any], text: str, caplog: pytest.LogCaptureFixture
    ) -> None:
        token = pad.press()
        pad._handle_custom_msg({"act": "hold", "press": "p", "token": token, "forward": 1, **message}, [])
        assert f"the page sent what is no speed: {text}" in caplog.text
        assert pad.hear("hold", token=token, forward=1)["over"] == "late"
        pad.rests()
        assert pad.heard
        assert set(pad.heard) == {ZERO}

    @pytest.mark.parametrize("content", [None, 3, [1, 2], "drive", {}])
    def test_what_is_no_message_is_logged(self, pad: Pad, content: Any, caplog: pytest.LogCaptureFixture) -> None:
        pad._handle_custom_msg(content, [])
        assert "the page sent what is no speed: expected a message of the pad" in caplog.text


class TestSink:
    def test_without_one_a_press_hears_so(self) -> None:
        pad = Pad(send=None)
        assert pad.hear("press") == {"press": "p", "over": "nothing"}
        assert pad.get_state()["_ready"] is False
        pad.close()

    def test_what_is_connected_is_driven_and_stopped_its_own_way(self, pad: Pad) -> None:
        class Feed:
            def __init__(self) -> None:
                self.heard: list[object] = []

            def drive(self, linear: float, angular: float) -> None:
                self.heard.append((linear, angular))

            def stop(self) -> None:
                self.heard.append("stop")

        first, second = Feed(), Feed()
        pad.connect(first)
        pad.hear("hold", token=pad.press(), turn=1)
        wait_for(lambda: first.heard, "the first was driven")
        pad.connect(second)
        assert first.heard == [(0.0, 1.0), "stop"]
        pad.hear("hold", token=pad.press(), forward=1)
        wait_for(lambda: second.heard, "the second was driven")
        pad.disconnect()
        assert second.heard == [(0.5, 0.0), "stop"]
        assert pad.hear("press")["over"] == "nothing"
        assert pad.heard == []

    def test_a_simulated_robot_can_be_connected(self, pad: Pad) -> None:
        from robowidgets.simulator import Robot, World

        robot = Robot(World.rooms())
        pad.connect(robot)
        pad.hear("hold", token=pad.press(), forward=0.5)
        wait_for(lambda: robot.command().linear[0] == 0.25, "it drives")
        pad.hear("release")
        wait_for(lambda: robot.command().linear[0] == 0, "it stops")

    def test_of_a_feed_it_tells_the_speed_that_was_published_and_why_the_robot_would_not_move(self, pad: Pad) -> None:
        script = Scripted(SCAN, CMD_VEL._replace(name="/base/cmd_vel"))
        with Feed(script) as feed:
            feed.driving = Driving(max_linear=0.2)
            pad.connect(feed)
            assert pad.title == "/cmd_vel"
            pad.connect(SimpleNamespace(drive=feed.drive, driving=Driving(topic="/base/cmd_vel")))
            assert pad.title == "/base/cmd_vel"
            pad.connect(feed)
            pad.hear("hold", token=pad.press(), forward=1, turn=1)
            wait_for(lambda: pad.commanded == Speed((0.2, 0.0, 0.0), (0.0, 0.0, 1.0)), "it is told")
            assert script.speeds[0] == (0.2, 1.0)
            unheard = "nobody listens to /cmd_vel; speeds go to /base/cmd_vel"
            assert pad.get_state()["_state"]["error"] == f"{unheard}; 0.5 m/s is cut to 0.2"
            pad.hear("release")
            wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "it stops")
            pad.rests()
            script.listener.on_topics([CMD_VEL])
            answer = pad.hear("hold", token=pad.press(), forward=1)
            wait_for(lambda: pad.commanded.linear[0] == 0.2, "it drives")
            assert pad.get_state()["_state"]["error"] == "0.5 m/s is cut to 0.2"
            pad.hear("hold", token=answer["token"], forward=0.4)
            wait_for(lambda: script.speeds[-1][0] == 0.2, "it drives on")
            wait_for(lambda: pad.get_state()["_state"]["error"] == "", "nothing is cut any more")

    @pytest.mark.parametrize("held", [False, True])
    def test_of_a_feed_that_is_closed_it_says_so_at_once_and_again_on_a_press(self, pad: Pad, held: bool) -> None:
        feed = Feed(Scripted(CMD_VEL))
        pad.connect(feed)
        token = pad.press()
        if held:
            answer = pad.hear("hold", token=token, forward=1)
            wait_for(lambda: pad.commanded.linear[0], "it drives")
        else:
            pad.hear("release")
        feed.close()
        told = {"speed": ZERO, "press": "", "error": "", "cause": "the feed is closed"}
        assert (pad.get_state()["_ready"], pad.get_state()["_state"]) == (False, told)
        if held:
            assert pad.hear("hold", token=answer["token"], forward=1)["over"] == "nothing"
        assert pad.hear("press", "q")["over"] == "nothing"
        with Feed(Scripted(CMD_VEL)) as other:
            pad.connect(other)
            assert (pad.get_state()["_ready"], pad.get_state()["_state"]["cause"]) == (True, "")
            assert "token" in pad.hear("press", "r")
        pad.connect(feed)
        assert (pad.get_state()["_ready"], pad.get_state()["_state"]["cause"]) == (False, "the feed is closed")
        pad.disconnect()
        assert pad.get_state()["_state"]["cause"] == ""

    def test_a_feed_that_it_left_may_close_without_a_word(self, pad: Pad) -> None:
        with Feed(Scripted(CMD_VEL)) as left:
            pad.connect(left)
            pad.connect(SimpleNamespace(drive=lambda *_: None))
        assert pad.get_state()["_ready"] is True
        assert pad.get_state()["_state"]["cause"] == ""
        assert left._watchers == []

    @pytest.mark.parametrize("robot", [None, 3, print])
    def test_what_cannot_drive_is_refused(self, pad: Pad, robot: Any) -> None:
        with pytest.raises(
            TypeError, match=r"^connect\(\): expected a feed, or something with drive\(linear, angular\)"
        ):
            pad.connect(robot)
        assert "token" in pad.hear("press")

    def test_what_it_raises_is_said_and_logged_and_ends_the_press(self, caplog: pytest.LogCaptureFixture) -> None:
        def send(linear: float, angular: float) -> None:
            if linear:
                raise OSError("no route to the robot")
            heard.append(linear)

        heard: list[float] = []
        pad = Pad(send=send)
        token = pad.press()
        pad.hear("hold", token=token, forward=1)
        wait_for(lambda: heard, "it was asked to stop")
        text = "The robot could not be driven: OSError: no route to the robot"
        assert pad.get_state()["_state"]["error"] == text
        assert text in caplog.text
        assert pad.hear("hold", token=pad.answers[-1]["token"], forward=1)["over"] == "failed"
        assert pad.get_state()["_state"]["cause"] == "no route to the robot"
        token = pad.press("q")
        assert (pad.get_state()["_state"]["error"], pad.get_state()["_state"]["cause"]) == ("", "")
        pad.hear("release", "q")
        assert pad.hear("hold", "q", token=token, forward=1)["over"] == "late"
        pad.close()

    def test_what_it_raises_at_every_speed_is_said_with_the_first_error(self) -> None:
        def send(linear: float) -> None: ...

        pad = Pad(send=send)
        pad.hear("hold", token=pad.press(), forward=1)
        wait_for(lambda: pad.get_state()["_state"]["error"].endswith(". Nor could it be told to stop"), "both are said")
        assert pad.get_state()["_state"]["error"].startswith("The robot could not be driven: TypeError: ")
        assert pad.get_state()["_state"]["cause"].endswith("takes 1 positional argument but 2 were given")
        pad.close()

    def test_one_that_hangs_ends_the_press(self) -> None:
        back = threading.Event()
        pad = Pad(send=lambda *_: back.wait())
        pad.hear("hold", token=pad.press(), forward=1)
        dead_man = pad._dead_man
        assert dead_man is not None
        wait_for(lambda: dead_man.hangs_for, "it hangs")
        assert pad.hear("press")["over"] == "hangs"
        back.set()
        pad.rests()
        assert "token" in pad.hear("press")
        pad.close()


class TestProgram:
    def test_stop_ends_the_press(self, pad: Pad) -> None:
        pad.hear("hold", token=pad.press(), forward=1)
        wait_for(lambda: pad.heard, "it drives")
        pad.stop()
        pad.rests()
        assert pad.heard == [(0.5, 0.0), ZERO]
        assert pad.hear("hold", token=pad.answers[-1]["token"], forward=1)["over"] == "late"

    def test_switched_off_it_stops_and_drives_no_more(self, pad: Pad) -> None:
        pad.hear("hold", token=pad.press(), forward=1)
        wait_for(lambda: pad.heard, "it drives")
        pad.enabled = False
        pad.rests()
        assert pad.heard == [(0.5, 0.0), ZERO]
        assert pad.hear("press") == {"press": "p", "over": "disabled"}
        pad.enabled = True
        assert "token" in pad.hear("press")

    def test_closed_it_has_stopped_the_robot_and_left_no_thread(self) -> None:
        for _ in range(20):
            pad = Pad()
            pad.hear("hold", token=pad.press(), forward=1)
            wait_for(lambda pad=pad: pad.heard, "it drives")
            pad.close()
            assert pad.heard == [(0.5, 0.0), ZERO]
        assert [t.name for t in threading.enumerate() if t.name == "robowidgets-drive"] == []

    @pytest.mark.parametrize("value", [0, -1, nan, inf, 1e7, "fast", True, None])
    @pytest.mark.parametrize(("name", "unit"), [("linear_limit", "m/s"), ("angular_limit", "rad/s")])
    def test_limits_are_numbers_above_zero(self, pad: Pad, name: str, unit: str, value: Any) -> None:
        with pytest.raises(traitlets.TraitError) as refusal:
            setattr(pad, name, value)
        assert str(refusal.value) == f"{name}: expected a number above 0 and at most 1e+06, in {unit}; got {value!r}"

    def test_a_send_that_is_no_function_is_refused(self) -> None:
        with pytest.raises(TypeError, match=r"^send: expected a function of linear and angular speed, got 3$"):
            DriveWidget(send=3)

    def test_an_unknown_keyword_is_refused_with_those_there_are(self) -> None:
        with pytest.raises(TypeError) as refusal:
            DriveWidget(sned=print)
        assert str(refusal.value) == (
            "DriveWidget() has no keyword 'sned'; did you mean 'send'? "
            "It takes: angular_limit, enabled, header, layout, linear_limit, send, tabbable, title, tooltip"
        )

    @pytest.mark.parametrize("wrong", [{"send": 3}, {"sned": print}, {"linear_limit": -1}])
    def test_a_pad_that_could_not_be_made_leaves_no_complaint_behind(
        self, wrong: dict[str, Any], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        complaints: list[object] = []
        monkeypatch.setattr("sys.unraisablehook", complaints.append)
        with pytest.raises((TypeError, traitlets.TraitError)):
            DriveWidget(**wrong)
        gc.collect()
        assert complaints == []

    def test_a_new_view_finds_how_it_stands(self, pad: Pad) -> None:
        state = pad.get_state()
        assert (state["_ready"], state["_state"]) == (True, {"speed": ZERO, "press": "", "error": "", "cause": ""})


def test_nothing_of_a_usual_drive_is_logged(pad: Pad, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, "robowidgets"):
        pad.hear("hold", token=pad.press(), forward=1)
        pad.hear("release")
        pad.rests()
    assert caplog.records == []
