"""One Stop for several robots: on DDS, on Foxglove and simulated, and one that cannot be reached."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from robowidgets import feeds
from robowidgets.behaviors import Drive
from robowidgets.driving.command_watchdog import CommandWatchdog
from robowidgets.feeds import Driving, Feed

from ..pages import display
from ..waiting import threads_named, wait_for
from .scripted import CMD_VEL, Scripted


@pytest.fixture
def opened() -> Iterator[ExitStack]:
    """Closes what a test opens."""
    with ExitStack() as stack:
        yield stack


def scripted(opened: ExitStack, **options: Any) -> tuple[Feed, Scripted]:
    script = Scripted(CMD_VEL, **options)
    return opened.enter_context(Feed(script)), script


class Hangs(Scripted):
    """A middleware whose `publish` does not return until it is released."""

    def __init__(self) -> None:
        super().__init__(CMD_VEL)
        self.go = threading.Event()

    def publish(self, *message: Any) -> None:
        self.go.wait(60)
        super().publish(*message)


class TestStopAll:
    def test_a_robot_that_is_lost_or_hangs_is_reported_and_delays_no_other(self, opened: ExitStack) -> None:
        red, red_script = scripted(opened)
        lost, _ = scripted(opened, connected=False)
        hanging = Hangs()
        opened.callback(hanging.go.set)
        closed, _ = scripted(opened)
        closed.close()
        red.drive(0.2)
        everybody = feeds.StopAll({"red": red, "lost": lost, "<b>hangs</b>": Feed(hanging), "closed": closed})
        opened.callback(everybody.release)
        said = everybody.stop(timeout=0)
        assert said["<b>hangs</b>"] == "zero was not sent within 0 s; sending is tried again"
        said = everybody.stop(timeout=60)
        assert said["red"] == ""
        assert said["lost"].startswith("cannot stop: ")
        assert said["<b>hangs</b>"].startswith("cannot stop: ")
        assert said["closed"] == "cannot stop: its feed is closed; open it again"
        assert red_script.speeds[-1] == (0.0, 0.0)
        assert "red: is sent zero\n" in repr(everybody)
        display(everybody)
        assert "&lt;b&gt;hangs&lt;/b&gt;" in everybody._box.children[3].value
        hanging.go.set()
        wait_for(lambda: everybody.problems["<b>hangs</b>"] == "", "it is stopped as soon as it can be")

    def test_zero_is_sent_again_until_it_is_released_and_nothing_drives_until_then(self, opened: ExitStack) -> None:
        red, script = scripted(opened)
        everybody = feeds.StopAll({"red": red})
        everybody.stop()
        first = len(script.speeds)
        with pytest.raises(feeds.FeedError, match="stop"):
            red.drive(0.2)
        wait_for(lambda: len(script.speeds) > first + 1, "zeros go on")
        assert set(script.speeds) == {(0.0, 0.0)}
        display(everybody)
        buttons, line = everybody._box.children
        stop, release = buttons.children
        assert line.value == "■ <b>red</b> is sent zero"
        release.click()
        assert not everybody.stopped
        assert line.value == "○ <b>red</b> is not stopped from here"
        red.drive(0.2)
        assert script.speeds[-1] == (0.2, 0.0)
        stop.click()
        assert script.speeds[-1] == (0.0, 0.0)
        everybody.release()

    def test_a_release_keeps_a_stop_that_was_pressed_meanwhile(self, opened: ExitStack) -> None:
        red, script = scripted(opened)
        everybody, others = feeds.StopAll({"red": red}), feeds.StopAll({"red": red})
        everybody.stop(60)
        others.stop(60)
        red.stopped = True  # as the button of the robot does
        everybody.release()
        others.release()
        assert red.stopped
        with pytest.raises(feeds.FeedError, match="Stop is pressed"):
            red.drive(0.2)
        red.stopped = False
        red.drive(0.2)
        assert script.speeds[-1] == (0.2, 0.0)

    def test_a_program_stays_paused_after_the_release_and_a_latch_that_was_there_stays(self, opened: ExitStack) -> None:
        red, script = scripted(opened)
        blue, _ = scripted(opened)
        blue.stopped = True
        everybody = feeds.StopAll({"red": red, "blue": blue})

        @red.program
        def go() -> Drive:
            return Drive(0.2)

        wait_for(lambda: (0.2, 0.0) in script.speeds, "it drives")
        everybody.stop(60)
        assert (go.mode, go.note) == ("paused", "paused, because all robots were stopped")
        go.run()  # while all are stopped
        everybody.release()
        assert (go.mode, red.stopped, blue.stopped) == ("paused", False, True)
        assert script.speeds[-1] == (0.0, 0.0)
        sent = len(script.speeds)
        go.run()
        wait_for(lambda: (0.2, 0.0) in script.speeds[sent:], "it drives again when the user runs it")

    def test_a_feed_that_is_released_while_it_is_being_stopped_may_drive(
        self, opened: ExitStack, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        red, script = scripted(opened)
        everybody = feeds.StopAll({"red": red})
        there, go = threading.Event(), threading.Event()

        def latch(owner: object) -> None:
            there.set()
            go.wait(240)
            CommandWatchdog.latch(red.watchdog, owner)

        with monkeypatch.context() as patched:
            patched.setattr(red.watchdog, "latch", latch)
            everybody.stop(timeout=0)
            assert there.wait(240)
            everybody.release()
            go.set()
            wait_for(lambda: not threads_named("robowidgets-standstill"), "its turn is over")
        assert (red.stopped, repr(everybody)) == (False, "red: is not stopped from here")
        red.drive(0.2)
        assert script.speeds[-1] == (0.2, 0.0)

    def test_it_takes_feeds_with_names(self) -> None:
        with pytest.raises(TypeError, match=r"expected feeds by name, as StopAll\(\{'red': robot\}\), got \[1\]"):
            feeds.StopAll([1])  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="expected one robot or more, got none"):
            feeds.StopAll({})


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="Cyclone DDS is installed on Linux alone")
def test_robots_of_dds_and_foxglove_and_a_simulated_one_stand_at_once_while_one_is_lost(
    opened: ExitStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    from foxglove.websocket import Capability

    from robowidgets.feeds import _dds_session

    from .test_dds import DOMAIN, Robot
    from .test_foxglove import Real, Taken

    monkeypatch.setattr(_dds_session, "_CONFIRMING", 120.0)  # for a busy machine
    robot = Robot()
    opened.callback(robot.kill)
    robot.hear("/cmd_vel", "Twist")
    taken = Taken()
    real = Real(capabilities=[Capability.ClientPublish], supported_encodings=["cdr"], server_listener=taken)
    opened.callback(real.server.stop)
    simulated = opened.enter_context(feeds.simulator(wander=False))
    over_dds = opened.enter_context(feeds.dds(DOMAIN, interface="lo"))
    over_foxglove = opened.enter_context(feeds.foxglove(real.address))
    lost = opened.enter_context(feeds.foxglove("ws://127.0.0.1:9"))
    wait_for(lambda: over_dds.topics and not over_foxglove.status, "they are connected")
    simulated.driving = Driving(hold=3600.0)  # otherwise it may stand again before this test looks
    simulated.drive(0.3)
    wait_for(lambda: simulated.robot.speed().linear[0] > 0.1, "it drives")
    everybody = feeds.StopAll({"dds": over_dds, "fox": over_foxglove, "sim": simulated, "lost": lost})
    opened.callback(everybody.release)
    said = everybody.stop(120)
    assert (said["dds"], said["sim"]) == ("", "")
    assert said["lost"].startswith("cannot stop: cannot reach ws://127.0.0.1:9, ")
    wait_for(lambda: simulated.robot.speed().linear[0] == 0, "it stands")
    zero = robot.heard()
    assert (zero["linear"]["x"], zero["angular"]["z"]) == (0.0, 0.0)
    wait_for(lambda: taken.payloads, f"the robot of Foxglove hears zero, too: {said}")
