"""`DriveWidget`: the messages it takes from the page, and the speeds that reach the robot."""

from __future__ import annotations

import gc
import logging
import threading
import time
from collections.abc import Iterator
from itertools import groupby, pairwise
from math import inf, nan
from types import SimpleNamespace
from typing import Any

import pytest
import traitlets

from robowidgets import DriveWidget, Speed
from robowidgets.driving import command_watchdog, driving_widget
from robowidgets.driving.command_watchdog import HOLD, PROGRAM, CommandWatchdog, Velocity
from robowidgets.driving.driving_widget import ALLOW_LIFETIME
from robowidgets.driving.press import PressLease, Tokens
from robowidgets.feeds import Driving, Feed, FeedError
from robowidgets.widget.pacer import Pacer

from ..clocks import ManualClock
from ..feeds.scripted import CMD_VEL, Scripted
from ..pages import Page, from_page, get_observers
from ..waiting import wait_for

ZERO = (0.0, 0.0)
"""A speed as a function of two speeds gets it, and as the middleware of a test records it."""


class Pad(DriveWidget):
    """A pad whose answers to the page are kept, and whose robot remembers.

    What it hears is fresh until `now` is set: a test has no page whose messages a busy machine could delay.
    """

    answers: list[dict[str, Any]] = []  # noqa: RUF012
    heard: list[tuple[float, float]] = []  # noqa: RUF012
    now = 100.0
    clock: ManualClock | None = None
    """The clock of its watchdogs, if it is moved by hand."""

    def __init__(self, **kwargs: Any) -> None:
        self.answers = []
        self.heard = []
        super().__init__(**{"send": lambda *speed: self.heard.append(speed), **kwargs})
        self._lease = PressLease(lambda: self.now)

    def send(self, content: Any) -> None:
        self.answers.append(content)

    def from_page(self, act: str, press: str = "p", **more: Any) -> dict[str, Any]:
        """Send a message of the page, and return the answer."""
        from_page(self, {"act": act, "press": press, **more})
        return self.answers[-1]

    def press(self, press: str = "p") -> int:
        token: int = self.from_page("press", press)["token"]
        return token

    def hold(self, press: str = "p", **knob: float) -> int:
        """A press that drives at once; return its next token."""
        token: int = self.from_page("hold", press, token=self.press(press), **knob)["token"]
        return token

    @property
    def told(self) -> dict[str, Any]:
        """The state that a page has."""
        state: dict[str, Any] = self.get_state()["_state"]
        return state

    def rests(self) -> None:
        wait_for(lambda: self._watchdog._thread is None or (self.clock and self.clock.advance(1 / 64)), "the pad rests")


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> ManualClock:
    """The clock of the watchdogs of pads."""
    made = ManualClock()
    monkeypatch.setitem(CommandWatchdog.__init__.__kwdefaults__, "clock", made)  # type: ignore[index]
    return made


@pytest.fixture
def pad(clock: ManualClock) -> Iterator[Pad]:
    made = Pad()
    made.clock = clock
    yield made
    closing = clock.beside(made.close)
    wait_for(lambda: not closing.is_alive() or clock.advance(1 / 64), "it is closed")
    made.rests()


@pytest.fixture
def holds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make a press drive until something ends it, instead of half a second at most."""
    monkeypatch.setattr(command_watchdog, "HOLD", 3600.0)


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> float:
    """Seconds after which the page gets the same state again, instead of one second."""
    monkeypatch.setattr(driving_widget, "BEAT", 0.05)
    return 0.05


class TestFromThePage:
    @pytest.mark.usefixtures("holds")
    def test_a_press_that_is_held_drives_by_shares_of_the_limits_until_it_is_let_go(self, pad: Pad) -> None:
        pad.linear_limit, pad.angular_limit = 0.4, 2
        token = pad.press()
        assert pad.heard == []
        answer = pad.from_page("hold", token=token, forward=0.5, turn=-1)
        assert answer["token"] > token
        wait_for(lambda: pad.commanded == Speed((0.2, 0, 0), (0, 0, -2.0)), "it was reported")
        assert pad.from_page("release") == {"press": "p", "over": "released"}
        pad.rests()
        assert pad.heard == [(0.2, -2.0), ZERO]
        assert pad.commanded == Speed((0, 0, 0), (0, 0, 0))

    def test_a_page_that_vanishes_stops_it(self, pad: Pad) -> None:
        pad.from_page("hold", token=pad.press(), forward=1)
        pad.rests()
        assert pad.heard == [(0.5, 0.0), ZERO]

    def test_a_queue_of_messages_that_waited_moves_nothing(self, pad: Pad) -> None:
        token = pad.press()
        pad.from_page("hold", token=token, forward=0.1)
        wait_for(lambda: pad.heard, "it drove")
        newest = pad.answers[-1]["token"]
        pad.now += HOLD + 0.01
        for i in range(20):
            assert pad.from_page("hold", token=newest, forward=1 - i / 100) == {"press": "p", "over": "late"}
        pad.rests()
        assert pad.heard == [(0.05, 0.0), ZERO]

    def test_a_press_that_went_stale_stays_over_though_a_fresh_token_is_guessed(self, pad: Pad) -> None:
        token = pad.press()
        pad.now += HOLD + 0.01
        pad.from_page("hold", token=token, forward=1)
        assert pad.from_page("hold", token=token + 1, forward=1)["over"] == "late"
        pad.rests()
        assert (0.5, 0.0) not in pad.heard

    def test_a_message_that_is_a_little_old_counts(self, pad: Pad) -> None:
        token = pad.press()
        pad.now += HOLD - 0.1
        assert "token" in pad.from_page("hold", token=token, forward=1)

    def test_nothing_moves_without_a_press_or_after_it(self, pad: Pad) -> None:
        assert pad.from_page("hold", token=0, forward=1)["over"] == "late"
        token = pad.press()
        pad.from_page("release")
        assert pad.from_page("hold", token=token, forward=1)["over"] == "released"
        pad.rests()
        assert set(pad.heard) <= {ZERO}

    def test_the_newest_press_wins_and_another_page_is_notified(self, pad: Pad) -> None:
        old = pad.press("old")
        new = pad.press("new")
        assert pad.from_page("hold", "old", token=old, forward=1) == {"press": "old", "over": "taken"}
        assert pad.from_page("release", "old") == {"press": "old", "over": "released"}
        assert "token" in pad.from_page("hold", "new", token=new, forward=-1)
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
            ({"act": "fly"}, "act: expected press, hold, release, stop, allow or beat, got 'fly'"),
            ({"press": ""}, "press: expected the name of a press, got ''"),
            ({"press": "program"}, "press: expected the name of a press, got 'program'"),
            ({"speed": 3}, "expected a message of the pad, got {"),
        ],
    )
    def test_what_is_not_a_speed_stops_and_is_logged(
        self, pad: Pad, message: dict[str, Any], text: str, caplog: pytest.LogCaptureFixture
    ) -> None:
        token = pad.press()
        from_page(pad, {"act": "hold", "press": "p", "token": token, "forward": 1, **message})
        wait_for(lambda: f"the page sent an invalid message: {text}" in caplog.text, "it is logged")
        assert pad.from_page("hold", token=token, forward=1)["over"] == "released"
        pad.rests()
        assert pad.heard
        assert set(pad.heard) == {ZERO}

    @pytest.mark.parametrize("content", [None, 3, [1, 2], "drive", {}])
    def test_what_is_not_a_message_is_logged(self, pad: Pad, content: Any, caplog: pytest.LogCaptureFixture) -> None:
        from_page(pad, content)
        words = "the page sent an invalid message: expected a message of the pad"
        wait_for(lambda: words in caplog.text, "it is logged")


class TestSink:
    def test_without_one_a_press_hears_so(self) -> None:
        pad = Pad(send=None)
        assert pad.from_page("press") == {"press": "p", "over": "nothing"}
        assert pad.told["ready"] is False
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
        pad.from_page("hold", token=pad.press(), turn=1)
        wait_for(lambda: first.heard, "the first was driven")
        pad.connect(second)
        assert first.heard == [(0.0, 1.0), "stop"]
        pad.from_page("hold", token=pad.press(), forward=1)
        wait_for(lambda: second.heard, "the second was driven")
        pad.disconnect()
        assert second.heard == [(0.5, 0.0), "stop"]
        assert pad.from_page("press")["over"] == "nothing"
        assert pad.heard == []

    def test_a_function_with_lateral_is_driven_sideways_by_name_and_others_know_nothing_of_it(self) -> None:
        heard: list[tuple[float, float, float]] = []

        def send(linear: float, angular: float, *, lateral: float) -> None:
            heard.append((linear, angular, lateral))

        pad = Pad(send=send, lateral_limit=0.2)
        assert pad.told["lateral_limit"] == 0.2
        pad.from_page("hold", token=pad.press(), forward=0.2, lateral=-0.5)
        wait_for(lambda: pad.commanded == Speed((0.1, -0.1, 0), (0, 0, 0)), "it was reported")
        pad.from_page("release")
        pad.rests()
        assert heard == [(0.1, 0.0, -0.1), Velocity()]
        pad.close()

    def test_a_limit_for_sideways_needs_something_that_takes_it(self, pad: Pad) -> None:
        def planar(linear: float, angular: float) -> None:
            raise AssertionError(f"it was driven: {linear}, {angular}")

        words = r"^lateral_limit: what drives the robot has no parameter lateral: drive\(linear, angular, lateral\)$"
        with pytest.raises(traitlets.TraitError, match=words):
            DriveWidget(send=planar, lateral_limit=0.2)
        with pytest.raises(traitlets.TraitError, match=words):
            pad.lateral_limit = 0.2
        pad.from_page("hold", token=pad.press(), lateral=1)
        pad.rests()
        assert set(pad.heard) <= {ZERO}, "without a limit its share is nothing"
        sideways = Pad(send=None, lateral_limit=0.2)
        with pytest.raises(TypeError, match=r"^connect\(\): lateral_limit: what drives the robot has no parameter"):
            sideways.connect(SimpleNamespace(drive=planar))
        sideways.close()

    def test_a_simulated_robot_can_be_connected(self, pad: Pad) -> None:
        from robowidgets.simulator import Robot, World

        robot = Robot(World.rooms())
        pad.connect(robot)
        pad.from_page("hold", token=pad.press(), forward=0.5)
        wait_for(lambda: robot.command().linear[0] == 0.25, "it drives")
        pad.from_page("release")
        wait_for(lambda: robot.command().linear[0] == 0, "it stops")

    @pytest.mark.parametrize("robot", [None, 3, print])
    def test_what_cannot_drive_is_refused(self, pad: Pad, robot: Any) -> None:
        with pytest.raises(
            TypeError, match=r"^connect\(\): expected a feed, or something with drive\(linear, angular\)"
        ):
            pad.connect(robot)
        assert "token" in pad.from_page("press")

    def test_what_it_raises_is_reported_and_logged_and_ends_the_press(self, caplog: pytest.LogCaptureFixture) -> None:
        def send(linear: float, angular: float) -> None:
            if linear:
                raise OSError("no route to the robot")
            heard.append(linear)

        heard: list[float] = []
        pad = Pad(send=send)
        token = pad.press()
        pad.from_page("hold", token=token, forward=1)
        wait_for(lambda: heard, "it was asked to stop")
        text = "The robot could not be driven: OSError: no route to the robot"
        assert pad.told["error"] == text
        wait_for(lambda: text in caplog.text, "it is logged")
        assert pad.from_page("hold", token=pad.answers[-1]["token"], forward=1)["over"] == "failed"
        assert pad.told["cause"] == "no route to the robot"
        token = pad.press("q")
        assert (pad.told["error"], pad.told["cause"]) == ("", "")
        pad.from_page("release", "q")
        assert pad.from_page("hold", "q", token=token, forward=1)["over"] == "released"
        pad.close()

    def test_what_it_raises_ends_the_press_also_where_the_log_hangs(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def send(linear: float, angular: float) -> None:
            if linear:
                raise OSError("no route to the robot")
            heard.append(linear)

        gate, heard = threading.Event(), list[float]()
        monkeypatch.setattr(logging.getLogger("robowidgets"), "error", lambda *_, **__: gate.wait(120))
        pad = Pad(send=send)
        pad.hold(forward=1)
        wait_for(lambda: heard, "it is asked to stop")
        gate.set()

    def test_what_it_raises_at_every_speed_is_reported_with_the_first_error(self) -> None:
        def send(linear: float) -> None: ...

        pad = Pad(send=send)
        pad.from_page("hold", token=pad.press(), forward=1)
        wait_for(lambda: pad.told["error"].endswith(". Sending zero failed, too"), "both are reported")
        assert pad.told["error"].startswith("The robot could not be driven: TypeError: ")
        assert pad.told["cause"].endswith("takes 1 positional argument but 2 were given")
        pad.close()

    def test_one_that_hangs_ends_the_press(self) -> None:
        back = threading.Event()
        pad = Pad(send=lambda *_: back.wait())
        pad.from_page("hold", token=pad.press(), forward=1)
        wait_for(lambda: pad._watchdog.busy_for > HOLD, "it hangs")
        assert pad.from_page("press")["over"] == "hangs"
        assert pad.told["error"] == "The function that drives the robot has not returned for 1 s"
        back.set()
        pad.rests()
        assert "token" in pad.from_page("press")
        assert pad.told["error"] == ""
        pad.close()


@pytest.fixture
def feed(script: Scripted) -> Iterator[Feed]:
    with Feed(script) as opened:
        yield opened


@pytest.fixture
def other(feed: Feed) -> Iterator[Pad]:
    """A second pad on the feed."""
    made = Pad(send=None)
    made.connect(feed)
    yield made
    made.close()


class TestFeed:
    @pytest.fixture
    def pad(self, feed: Feed) -> Iterator[Pad]:
        made = Pad(send=None)
        made.connect(feed)
        yield made
        made.close()

    def test_its_own_thread_carries_the_speeds_of_a_pad(self, pad: Pad, script: Scripted) -> None:
        pad.hold(forward=0.2, turn=-1)
        wait_for(lambda: script.speeds == [(0.1, -1.0)], "it drives")
        assert [t.name for t in threading.enumerate()].count("robowidgets-drive") == 1
        wait_for(lambda: pad.commanded == Speed((0.1, 0, 0), (0, 0, -1.0)), "it is reported")
        pad.from_page("release")
        wait_for(lambda: script.speeds == [(0.1, -1.0), ZERO], "it stops")
        assert pad.title == "/cmd_vel"

    def test_sideways_it_drives_as_fast_as_the_feed_allows_or_less(
        self, pad: Pad, feed: Feed, script: Scripted
    ) -> None:
        page = Page(pad)
        assert page.state["_state"]["lateral_limit"] == 0.0
        feed.driving = Driving(max_lateral=0.4)
        wait_for(lambda: page.state["_state"]["lateral_limit"] == 0.4, "the page gets a knob for it")
        pad.hold(lateral=0.5)
        wait_for(lambda: pad.told["speed"] == (0.0, 0.0, 0.2), "it drives to the left")
        assert script.sent[-1][2]["linear"] == {"x": 0.0, "y": 0.2, "z": 0.0}
        pad.from_page("release")
        pad.lateral_limit = 0.1
        wait_for(lambda: page.state["_state"]["lateral_limit"] == 0.1, "its own limit comes first")
        pad.hold(lateral=-1)
        wait_for(lambda: pad.told["speed"] == (0.0, 0.0, -0.1), "it drives to the right")

    def test_it_tells_the_speed_that_was_published_and_why_the_robot_would_not_move(
        self, pad: Pad, feed: Feed, script: Scripted
    ) -> None:
        feed.driving = Driving("/base/cmd_vel", max_linear=0.2)
        pad.connect(feed)
        pad.hold(forward=1, turn=1)
        wait_for(lambda: pad.told["speed"] == (0.2, 1.0, 0.0), "it drives")
        assert pad.told["topic"] == pad.title == "/base/cmd_vel"
        unheard = "/base/cmd_vel has no subscriber, unlike /cmd_vel"
        assert pad.told["status"] == f"{unheard}; 0.5 m/s is cut to 0.2"
        script.listener.on_topics([CMD_VEL._replace(name="/base/cmd_vel")])
        assert pad.told["status"] == "0.5 m/s is cut to 0.2"
        pad.hold("q", forward=0.2)
        assert pad.told["status"] == ""

    def test_while_a_program_runs_the_hand_drives_and_the_program_is_refused(
        self, pad: Pad, feed: Feed, script: Scripted
    ) -> None:
        feed.drive(0.2, 0.5)
        wait_for(lambda: pad.told["speed"] == (0.2, 0.5, 0.0), "the program drives")
        assert pad.told["driver"] == PROGRAM
        token = pad.hold(turn=1)
        for _ in range(5):
            with pytest.raises(FeedError, match="a hand drives from a pad"):
                feed.drive(0.2, 0.5)
            token = pad.from_page("hold", token=token, turn=1)["token"]
        wait_for(lambda: script.speeds[-1] == (0.0, 1.0), "the hand drives")
        assert pad.told["driver"] == "p"
        assert (0.2, 0.5) not in script.speeds[1:]
        pad.from_page("release")
        feed.drive(0.2, 0.5)
        wait_for(lambda: script.speeds[-2:] == [ZERO, (0.2, 0.5)], "the program drives again")

    def test_a_press_that_waited_for_the_kernel_does_not_get_in_a_programs_way(self, pad: Pad, feed: Feed) -> None:
        feed.drive(0.2, 0.5)
        pad.press()
        feed.drive(0.2, 0.5)
        assert "over" in pad.from_page("hold", token=77, forward=1)
        feed.drive(0.2, 0.5)
        assert pad.told["driver"] == PROGRAM

    def test_of_two_pads_the_newest_press_wins_and_the_other_is_notified(
        self, pad: Pad, other: Pad, script: Scripted
    ) -> None:
        token = pad.hold(forward=0.2)
        wait_for(lambda: script.speeds == [(0.1, 0.0)], "the first drives")
        newer = other.hold("q", turn=0.5)
        assert pad.from_page("hold", token=token, forward=0.2) == {"press": "p", "over": "taken"}
        assert other.from_page("hold", "q", token=newer, turn=0.5)["token"]
        assert pad.told["driver"] == other.told["driver"] == "q"
        pad.from_page("release")
        wait_for(lambda: script.speeds[-1:] == [(0.0, 0.5)], "the second drives on")
        assert pad.from_page("hold", token=token, forward=0.2)["over"] == "taken"
        assert pad.told["error"] == other.told["error"] == ""
        other.from_page("release", "q")
        wait_for(lambda: script.speeds[-1:] == [ZERO], "it stops")
        assert (0.1, 0.0) not in script.speeds[1:]

    def test_stop_of_one_pad_ends_the_press_of_another(self, pad: Pad, other: Pad, script: Scripted) -> None:
        token = pad.hold(forward=0.2)
        other.stop()
        assert pad.from_page("hold", token=token, forward=0.2)["over"] == "late"
        wait_for(lambda: script.speeds[-1:] == [ZERO], "it stops")

    def test_a_pad_that_is_switched_off_or_taken_away_leaves_a_program_alone(
        self, pad: Pad, other: Pad, feed: Feed, script: Scripted
    ) -> None:
        feed.drive(0.2, 0.5)
        pad.enabled = False
        pad.disconnect()
        other.close()
        feed.drive(0.2, 0.5)
        wait_for(lambda: script.speeds == [(0.2, 0.5), (0.2, 0.5)], "it drives on")
        assert get_observers(feed.connection) == []

    @pytest.mark.usefixtures("holds")
    def test_what_could_not_be_published_ends_the_press_and_is_reported_until_it_can(
        self, pad: Pad, script: Scripted, caplog: pytest.LogCaptureFixture
    ) -> None:
        token = pad.hold(forward=0.2)
        wait_for(lambda: pad.told["speed"] == (0.1, 0.0, 0.0), "it drives")
        script.broken = "no room"
        token = pad.from_page("hold", token=token, forward=0.2)["token"]
        words = "The robot could not be driven: no room"
        both = f"{words}. Sending zero failed, too"
        wait_for(lambda: pad.told["error"] == both, "both are reported")
        assert pad.told["cause"] == "no room"
        assert pad.told["speed"] == (0.1, 0.0, 0.0), "it is assumed to move"
        assert pad.from_page("hold", token=token, forward=0.2)["over"] == "failed"
        wait_for(lambda: words in caplog.text, "it is logged")
        script.broken = ""
        wait_for(lambda: pad.told["error"] == words, "the zero that was owed was sent")
        assert script.speeds[-1] == ZERO
        pad.hold("q", forward=0.2)
        assert pad.told["error"] == ""

    @pytest.mark.usefixtures("holds")
    def test_a_connection_that_is_lost_ends_the_press_and_is_reported(self, pad: Pad, script: Scripted) -> None:
        token = pad.hold(forward=0.2)
        wait_for(lambda: pad.told["speed"] == (0.1, 0.0, 0.0), "it drives")
        script.lose()
        assert pad.from_page("hold", token=token, forward=0.2)["over"] == "failed"
        assert "could not be driven: cannot drive: connection lost" in pad.told["error"]
        assert pad.told["cause"].startswith("cannot drive: connection lost")

    @pytest.mark.parametrize("held", [False, True])
    def test_a_closed_one_is_reported_at_once_and_again_on_a_press(
        self, pad: Pad, feed: Feed, script: Scripted, held: bool
    ) -> None:
        if held:
            token = pad.hold(forward=1)
            wait_for(lambda: pad.commanded.linear[0], "it drives")
        feed.close()
        wait_for(
            lambda: pad.told["cause"] == "the feed is closed", "it is reported"
        )  # perhaps by the thread that sends
        assert (pad.told["ready"], pad.told["driver"]) == (False, "")
        if held:
            assert script.speeds[-1] == ZERO
            assert pad.from_page("hold", token=token, forward=1)["over"] == "nothing"
        assert pad.from_page("press", "q")["over"] == "nothing"
        with Feed(Scripted(CMD_VEL)) as again:
            pad.connect(again)
            assert (pad.told["ready"], pad.told["cause"]) == (True, "")
            assert "token" in pad.from_page("press", "r")
        pad.connect(feed)
        assert (pad.told["ready"], pad.told["cause"]) == (False, "the feed is closed")
        pad.disconnect()
        assert pad.told["cause"] == ""

    def test_one_that_it_left_may_close_without_a_word(self, pad: Pad, feed: Feed) -> None:
        with Feed(Scripted(CMD_VEL)) as another:
            pad.connect(another)
            feed.close()
            assert (pad.told["ready"], pad.told["cause"]) == (True, "")

    @pytest.mark.usefixtures("soon")
    def test_a_feed_that_needs_a_page_is_driven_while_one_is_there_and_asks_for_it(self, pad: Pad, feed: Feed) -> None:
        page = Page(pad)
        feed.driving = Driving(needs_page=True, hold=3600.0)
        with pytest.raises(FeedError, match="no page"):
            feed.drive(0.1)
        pad.from_page("beat")
        feed.drive(0.1)
        feed.stop()
        wait_for(
            lambda: page.state["_state"]["speed"] == Velocity() and len(page.sent("_state")) > 4, "it is asked again"
        )


class TestStop:
    def test_it_latches_until_it_is_allowed_from_the_page(self, pad: Pad) -> None:
        token = pad.hold(forward=1)
        wait_for(lambda: pad.heard, "it drives")
        from_page(pad, {"act": "stop", "press": "view"})
        wait_for(lambda: pad.heard[-1] == ZERO, "it stops")
        assert (pad.stopped, pad.told["stopped"], pad.told["driver"]) == (True, True, "")
        assert pad.from_page("hold", token=token, forward=1) == {"press": "p", "over": "stopped"}
        assert pad.from_page("press", "q")["over"] == "stopped"
        fresh = pad.from_page("beat", "view")
        assert fresh.keys() == {"beat", "token"}
        from_page(pad, {"act": "allow", "press": "view", "token": fresh["token"]})
        assert pad.stopped is False
        assert "token" in pad.from_page("press", "r")
        pad.rests()
        assert pad.heard[-1] == ZERO

    def test_an_allow_that_waited_or_was_made_up_is_refused(self, pad: Pad) -> None:
        now = [100.0]
        pad._tokens = Tokens(ALLOW_LIFETIME, lambda: now[0])
        pad.stopped = True
        token = pad.from_page("beat", "view")["token"]
        assert pad.from_page("allow", "view", token=token + 1) == {"refused": "view"}
        now[0] += ALLOW_LIFETIME + 0.1
        assert pad.from_page("allow", "view", token=token) == {"refused": "view"}
        assert pad.stopped is True

    def test_tokens_that_no_page_returns_are_forgotten(self) -> None:
        now = [100.0]
        tokens = Tokens(ALLOW_LIFETIME, lambda: now[0])
        for _ in range(1000):
            last = tokens.issue()
            now[0] += 1.0
        assert len(tokens._issued) < 10
        assert tokens.is_fresh(last)

    def test_it_is_set_and_released_by_code(self, pad: Pad) -> None:
        token = pad.hold(forward=1)
        pad.stopped = True
        pad.stopped = False
        assert pad.from_page("hold", token=token, forward=1)["over"] == "late"
        pad.rests()
        assert pad.heard[-1] == ZERO
        pad.hold("q", forward=1)
        wait_for(lambda: pad.heard[-1] == (0.5, 0.0), "it drives again")

    def test_stopping_in_code_latches_nothing(self, pad: Pad) -> None:
        pad.hold(forward=1)
        pad.stop()
        assert pad.stopped is False
        assert "token" in pad.from_page("press", "q")

    def test_a_feeds_latch_is_the_pads_and_stops_its_program(self, feed: Feed, script: Scripted, other: Pad) -> None:
        feed.drive(0.2, 0.5)
        from_page(other, {"act": "stop", "press": "view"})
        assert feed.stopped is True
        with pytest.raises(FeedError, match="Stop is pressed"):
            feed.drive(0.2, 0.5)
        wait_for(lambda: script.speeds == [(0.2, 0.5), ZERO], "it stops")
        feed.stopped = False
        assert other.stopped is False


class TestToThePage:
    def test_speeds_at_any_rate_reach_the_page_at_the_pacers_pace_and_the_last_is_reported(
        self, feed: Feed, script: Scripted, other: Pad
    ) -> None:
        page, began = Page(other), time.monotonic()
        feed.driving = Driving(hold=3600.0)
        for count in range(1, 26):
            feed.drive(0.2, 0.5)
            wait_for(lambda count=count: len(script.speeds) == count, "it was sent")  # type: ignore[misc]
        wait_for(lambda: page.state["_state"]["speed"] == Velocity(0.2, 0.5), "it is reported")
        most = 6 + time.monotonic() - began
        assert len(page.sent("_state")) < most, "a constant speed is reported at a low rate, not each second"
        feed.drive(0.0)
        wait_for(lambda: page.state["_state"]["speed"] == Velocity(), "the last is reported")
        assert set(page.threads) == {"robowidgets-pacer"}

    def test_while_it_is_driven_the_page_hears_so_each_second(
        self, feed: Feed, other: Pad, soon: float, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        page, mark_at, times = Page(other), Pacer.mark_at, []

        def noted(pacer: Pacer, sender: Any, when: float | None) -> None:
            if sender is other and when is not None and when not in times:
                times.append(when)
            mark_at(pacer, sender, when)

        monkeypatch.setattr(Pacer, "mark_at", noted)
        feed.watchdog.drive(Velocity(0.2, 0.5), 3600.0)

        def numbers() -> set[int]:
            return {
                state["number"] for state in page.sent("_state") if state["driver"] and state["speed"] != Velocity()
            }

        wait_for(lambda: len(numbers()) >= 4 and len(times) >= 4, "it is reported again and again")
        # The first is renewed when the state changes, too.
        assert all(after - before >= soon for before, after in pairwise(times[1:]))

    def test_a_message_that_could_not_be_sent_is_sent_again(self, other: Pad, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robowidgets.widget.pacer.FIRST_PAUSE", 0.02)
        page = Page(other)
        send, fails = page.send, [True]

        def once(*args: Any, **kwargs: Any) -> None:
            if fails and fails.pop():
                raise OSError("no room")
            send(*args, **kwargs)

        page.send = once  # type: ignore[method-assign]
        other.stopped = True
        wait_for(lambda: page.sent("_state"), "it came")
        assert page.state["_state"]["stopped"] is True


class TestProgram:
    @pytest.mark.usefixtures("holds")
    def test_stop_ends_the_press(self, pad: Pad) -> None:
        pad.from_page("hold", token=pad.press(), forward=1)
        wait_for(lambda: pad.heard, "it drives")
        pad.stop()
        pad.rests()
        assert [speed for speed, _ in groupby(pad.heard)] == [(0.5, 0.0), ZERO]  # zero may come twice
        assert pad.from_page("hold", token=pad.answers[-1]["token"], forward=1)["over"] == "released"

    @pytest.mark.usefixtures("holds")
    def test_switched_off_it_stops_and_drives_no_more(self, pad: Pad) -> None:
        pad.from_page("hold", token=pad.press(), forward=1)
        wait_for(lambda: pad.heard, "it drives")
        pad.enabled = False
        pad.rests()
        assert [speed for speed, _ in groupby(pad.heard)] == [(0.5, 0.0), ZERO]  # zero may come twice
        assert pad.from_page("press") == {"press": "p", "over": "disabled"}
        pad.enabled = True
        assert "token" in pad.from_page("press")

    @pytest.mark.usefixtures("holds")
    def test_closed_it_has_stopped_the_robot_and_left_no_thread(self) -> None:
        for _ in range(20):
            pad = Pad()
            pad.from_page("hold", token=pad.press(), forward=1)
            wait_for(lambda pad=pad: pad.heard, "it drives")
            pad.close()
            assert pad.heard == [(0.5, 0.0), ZERO]
        assert [t.name for t in threading.enumerate() if t.name == "robowidgets-drive"] == []

    @pytest.mark.parametrize("value", [0, -1, nan, inf, 1e7, "fast", True, [1.0]])
    @pytest.mark.parametrize(
        ("name", "unit"), [("linear_limit", "m/s"), ("angular_limit", "rad/s"), ("lateral_limit", "m/s")]
    )
    def test_limits_are_numbers_above_zero(self, pad: Pad, name: str, unit: str, value: Any) -> None:
        with pytest.raises(traitlets.TraitError) as refusal:
            setattr(pad, name, value)
        assert str(refusal.value) == f"{name}: expected a number above 0 and at most 1e+06, in {unit}; got {value!r}"

    def test_a_send_that_is_not_a_function_is_refused(self) -> None:
        with pytest.raises(TypeError, match=r"^send: expected a function of linear and angular speed, got 3$"):
            DriveWidget(send=3)

    def test_a_coroutine_function_is_refused_with_what_to_do(self, pad: Pad) -> None:
        async def move(*speeds: float) -> None:
            raise AssertionError(speeds)

        class Base:
            drive = staticmethod(move)

        class Called:
            async def __call__(self, *speeds: float) -> None:
                raise AssertionError(speeds)

        words = (
            r": expected a plain function, got the coroutine function {}, whose call alone sends nothing; give one "
            r"that runs it to its end: lambda linear, angular: asyncio.run\({}\(linear, angular\)\)$"
        )
        with pytest.raises(TypeError, match="^send" + words.format("move", "move")):
            DriveWidget(send=move)
        with pytest.raises(TypeError, match="^send" + words.format("Called", "Called")):
            DriveWidget(send=Called())
        with pytest.raises(TypeError, match=r"^connect\(\): drive" + words.format("move", "move")):
            pad.connect(Base())

    def test_an_unknown_keyword_is_refused_with_those_there_are(self) -> None:
        with pytest.raises(TypeError) as refusal:
            DriveWidget(sned=print)
        assert str(refusal.value) == (
            "DriveWidget() has no keyword 'sned'; did you mean 'send'? "
            "It takes: angular_limit, enabled, header, lateral_limit, layout, linear_limit, send, tabbable, theme, "
            "title, tooltip"
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
        state = pad.told
        assert state.pop("number") > 0
        assert state == {
            "ready": True,
            "driver": "",
            "left": 0,
            "speed": Velocity(),
            "lateral_limit": 0.0,
            "stopped": False,
            "error": "",
            "cause": "",
            "status": "",
            "idle": "",
            "topic": "",
            "sender": "",
        }


def test_nothing_of_a_usual_drive_is_logged(pad: Pad, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, "robowidgets"):
        pad.from_page("hold", token=pad.press(), forward=1)
        pad.from_page("release")
        pad.rests()
    assert caplog.records == []
