"""The guard: its reactions to the kernel, and to the kernel's silence."""

from __future__ import annotations

import ctypes
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import ExitStack, closing, nullcontext, suppress
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from robowidgets import DriveWidget, feeds
from robowidgets.behaviors import Drive
from robowidgets.driving.command_watchdog import HOLD, ZERO, Velocity
from robowidgets.feeds import Driving, FeedError
from robowidgets.feeds._guard import guard as kernel_side
from robowidgets.feeds._guard import link
from robowidgets.feeds._guard.frames import FROM_GUARD, LARGEST, TO_GUARD, DamagedError, Unpacker, packed
from robowidgets.feeds._guard.process import GRACE, LAST_ZERO, SILENCE, Guarding
from robowidgets.feeds.middleware import SEND_TIMEOUT
from robowidgets.runtime.import_path import import_path

from ..clocks import ManualClock
from ..waiting import Clock, threads_named, wait_for
from .bridge import Rosbridge
from .scripted import CMD_VEL, Scripted
from .test_feed import in_other_hands

TOPIC = [["/cmd_vel", CMD_VEL.type, False, True]]
FORWARD = [0.3, 0.0, 0.0]


def test_messages_come_whole_however_their_bytes_come() -> None:
    frames = Unpacker(TO_GUARD)
    data = packed("beat") + packed("drive", 1, 2, "/cmd_vel", FORWARD, 3.5, 3.0, 0, TOPIC)
    got = [message for byte in data for message in frames.take(bytes([byte]))]
    assert got == [("beat", []), ("drive", [1, 2, "/cmd_vel", FORWARD, 3.5, 3.0, 0, TOPIC])]


@pytest.mark.parametrize(
    "data",
    [
        packed("beat")[:-1] + b"?",
        packed("beat").replace(b"\x00\x00\x00\x08", (LARGEST + 1).to_bytes(4, "big")),
        packed("beep"),
        packed("drive", 1, 2, "/cmd_vel", FORWARD),
        packed("drive", 1, 2, "/cmd_vel", FORWARD, "soon", 3.0, 0, TOPIC),
        packed("close", True),
        b"not at all a message",
    ],
    ids=["checksum", "length", "name", "parts", "type", "flag", "text"],
)
def test_a_damaged_message_is_not_a_message(data: bytes) -> None:
    with pytest.raises(DamagedError):
        list(Unpacker(TO_GUARD).take(data))


class Guarded:
    """A guard by a clock that is moved by hand, and its reports."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.robot = Scripted(CMD_VEL)
        self.told: list[Any] = []
        self.guarding = Guarding(lambda *told: self.told.append(told), self.clock, lambda *_: self.robot)
        self.guarding.take("open", ["the script", {}])
        self.stops = 0
        self._number = 0

    @property
    def speeds(self) -> list[float]:
        return [message["linear"]["x"] for _, _, message in self.robot.sent]

    def drive(self, hold: float = HOLD, **changed: Any) -> Any:
        """Drive forward; return the reports."""
        self._number += 1
        now = self.clock.now()
        asked = {"speed": FORWARD, "expires": now + hold, "sent_at": now + self.clock.slept(), "stops": self.stops}
        asked.update(changed)
        self.guarding.take("drive", [1, self._number, "/cmd_vel", *asked.values(), TOPIC])
        self.clock.settle()
        return self.told[-1]

    def pass_time(self, seconds: float) -> None:
        """Advance the time as the process does: it checks when a check is due."""
        end = self.clock.now() + seconds
        while (left := end - self.clock.now()) > 0:
            self.clock.advance(min(left, self.guarding.look()))
        self.guarding.look()
        self.clock.settle()


@pytest.fixture
def guarded(user_limits: None) -> Iterator[Guarded]:
    made = Guarded()
    yield made
    made.robot.broken = ""
    for feed in made.guarding._all:
        made.clock.beside(feed.watchdog.close)
    made.clock.advance(LAST_ZERO)


def test_zero_follows_a_speed_that_is_not_renewed_within_its_hold(guarded: Guarded) -> None:
    assert guarded.drive()[3:5] == ("", "")
    guarded.pass_time(HOLD / 2)
    guarded.guarding.take("beat", [])
    guarded.pass_time(HOLD / 2 + GRACE - 0.001)
    assert guarded.speeds == [0.3]
    guarded.pass_time(0.001)
    assert guarded.speeds == [0.3, 0.0]


def test_zero_comes_when_the_kernel_is_silent_and_not_before(guarded: Guarded) -> None:
    guarded.drive(hold=60.0)
    guarded.pass_time(SILENCE - 0.001)
    guarded.guarding.take("beat", [])
    guarded.pass_time(SILENCE - 0.001)
    assert guarded.speeds == [0.3]
    guarded.pass_time(0.001)
    assert guarded.speeds == [0.3, 0.0]


def test_a_silent_kernel_is_told_the_duration_and_must_confirm_it_before_it_drives_on(guarded: Guarded) -> None:
    guarded.drive(hold=60.0)
    guarded.pass_time(10.0)
    assert guarded.drive(hold=60.0)[3:5] == ("FeedError", "the guard has stopped the robot meanwhile")
    assert ("stopped", 1, pytest.approx(10.0), "") in guarded.told
    assert guarded.speeds == [0.3, 0.0]
    guarded.stops = 1
    assert guarded.drive()[3] == ""
    assert guarded.speeds == [0.3, 0.0, 0.3]


def test_a_robot_at_rest_needs_no_sign_of_life(guarded: Guarded) -> None:
    guarded.drive()
    guarded.guarding.take("zero", [1, 7, "/cmd_vel", TOPIC])
    guarded.pass_time(10.0)
    assert guarded.speeds == [0.3, 0.0]
    guarded.guarding.take("beat", [])
    assert not [told for told in guarded.told if told[0] == "stopped"]


def test_a_zero_that_cannot_be_sent_needs_no_sign_of_life_and_the_robot_can_be_driven_once_it_is_there(
    guarded: Guarded,
) -> None:
    guarded.robot.broken = "the robot is off"
    assert guarded.drive()[3:5] == ("FeedError", "the robot is off")
    guarded.pass_time(10.0)
    guarded.guarding.take("zero", [1, 7, "/cmd_vel", TOPIC])
    for _ in range(3):
        guarded.pass_time(10.0)
        guarded.guarding.take("beat", [])
    assert not [told for told in guarded.told if told[0] == "stopped"]
    guarded.robot.broken = ""
    guarded.pass_time(10.0)
    assert guarded.drive()[3:5] == ("", "")
    assert guarded.speeds == [0.0, 0.3]


@pytest.mark.parametrize("how", ["pause", "sleep"])
def test_after_a_standstill_of_its_own_a_guard_sends_zero_and_refuses_what_was_requested_before(
    guarded: Guarded, how: str
) -> None:
    guarded.drive(hold=60.0)
    sent_at = guarded.clock.now()
    if how == "sleep":
        guarded.clock.asleep += 3.0
    else:
        guarded.clock.jump(3.0)
    refused = {"hold": 60.0, "sent_at": guarded.clock.now() + guarded.clock.slept()}
    assert guarded.drive(**refused)[3:5] == ("FeedError", "the guard has stopped the robot meanwhile")
    told = next(told for told in guarded.told if told[0] == "stopped")
    assert told == (
        "stopped",
        1,
        0.0,
        "the computer has slept" if how == "sleep" else "the guard stood still for 3.0 s",
    )
    guarded.clock.advance(0.1)
    assert guarded.speeds == [0.3, 0.0]
    guarded.stops = 1
    assert guarded.drive(hold=60.0, sent_at=sent_at)[3:5] == ("FeedError", "the speed came too late")
    assert guarded.drive()[3] == ""
    assert guarded.speeds == [0.3, 0.0, 0.3]


def test_a_speed_that_comes_too_late_is_not_sent(guarded: Guarded) -> None:
    assert guarded.drive(hold=0.0)[3:5] == ("FeedError", "the speed came too late")
    assert guarded.speeds == []


def test_a_robot_that_is_not_reached_yet_or_not_discovered_is_reported() -> None:
    guarded = Guarded()
    guarded.robot = Scripted(CMD_VEL._replace(wanted=False))
    guarded.guarding = Guarding(lambda *told: guarded.told.append(told), guarded.clock, lambda *_: guarded.robot)
    assert guarded.drive()[3:5] == ("NotConnectedYetError", "the guard that sends speeds has not reached the robot yet")
    guarded.guarding.take("open", ["the script", {}])
    kind, text = guarded.drive()[3:5]
    assert (kind, "has not discovered the subscriber of /cmd_vel" in text) == ("NotConnectedYetError", True)
    guarded.clock.advance(10.0)
    assert guarded.drive()[3] == ""
    guarded.clock.advance(10.0)
    assert guarded.speeds == [0.3, 0.0]


def test_the_end_sends_zero_again_until_the_robot_has_it(guarded: Guarded) -> None:
    guarded.drive(hold=60.0)
    guarded.robot.broken = "the network is gone"
    guarded.clock.beside(guarded.guarding.finish)
    guarded.clock.advance(LAST_ZERO / 2)
    assert (guarded.speeds, guarded.robot.closed) == ([0.3], 0)
    guarded.robot.broken = ""
    guarded.clock.advance(2.0)
    assert (guarded.speeds, guarded.robot.closed) == ([0.3, 0.0], 1)


@pytest.mark.parametrize("then", ["the guard ends", "the robot is back"])
def test_a_feed_that_is_closed_while_the_robot_is_away_still_owes_it_a_zero(guarded: Guarded, then: str) -> None:
    guarded.drive(hold=60.0)
    guarded.robot.broken = "the network is gone"
    guarded.guarding.take("zero", [1, 7, "/cmd_vel", TOPIC])
    guarded.clock.settle()
    guarded.guarding.take("close", [1])
    guarded.clock.settle()
    if then == "the guard ends":
        guarded.clock.beside(guarded.guarding.finish)
        guarded.clock.advance(0.8)
        assert (guarded.speeds, guarded.robot.closed) == ([0.3], 0)
    guarded.robot.broken = ""
    if then == "the robot is back":
        guarded.robot.connect()
    guarded.clock.advance(0.1 if then == "the robot is back" else 2.0)
    assert guarded.speeds[:2] == [0.3, 0.0]
    assert guarded.robot.closed == (then == "the guard ends")
    assert not any(feed.moves for feed in guarded.guarding._all)


def test_the_end_gives_up_a_robot_that_cannot_be_reached(guarded: Guarded) -> None:
    guarded.drive(hold=60.0)
    guarded.robot.broken = "the network is gone"
    guarded.clock.beside(guarded.guarding.finish)
    guarded.clock.advance(LAST_ZERO + 1.0)
    assert guarded.robot.closed == 1


def test_a_robot_that_takes_long_for_each_of_several_messages_is_reported_as_slow(guarded: Guarded) -> None:
    guarded.drive(hold=60.0)
    other = [["/cmd_vel", "geometry_msgs/msg/TwistStamped", False, True]]
    publish = guarded.robot.publish

    def publish_slowly(*what: Any) -> None:
        guarded.clock.sleep(SEND_TIMEOUT)
        publish(*what)

    guarded.robot.publish = publish_slowly  # type: ignore[method-assign]
    guarded.told.clear()
    guarded.guarding.take("zero", [1, 7, "/cmd_vel", [*TOPIC, *other]])
    guarded.clock.advance(1.9 * SEND_TIMEOUT)
    assert guarded.told == [("slow",)]
    guarded.clock.advance(0.1 * SEND_TIMEOUT)
    assert [told[0] for told in guarded.told] == ["slow", "slow", "done"]


# -- the kernel's side -------------------------------------------------------------------------------------------------


class Played:
    """A guard that a test plays: the messages of the kernel, and its answers."""

    def __init__(self) -> None:
        self._ours, its = socket.socketpair()
        self.link = link.GuardLink("the robot")
        self._frames = Unpacker(TO_GUARD)
        self._heard: list[tuple[str, Sequence[Any]]] = []
        self._listening = threading.Thread(target=self.link.listen, args=(its, "open", "a robot", {}), daemon=True)
        self._listening.start()
        assert self.hear("open")
        self.say("ready")
        wait_for(lambda: self.link.is_there, "it is ready")

    def hear(self, name: str) -> Sequence[Any]:
        """Wait for a message of a name; return its parts."""
        while True:
            while self._heard:
                came, parts = self._heard.pop(0)
                if came == name:
                    return parts
            data = self._ours.recv(1 << 16)
            assert data, f"it hung up before {name} came"
            self._heard += self._frames.take(data)

    def say(self, name: str, *parts: Any) -> None:
        self._ours.sendall(packed(name, *parts))

    def answer(self, to: Sequence[Any], kind: str = "", text: str = "") -> None:
        feed, number, *_ = to
        self.say("done", feed, number, kind, text, "", [])

    def asked(self, feed: int, velocity: Velocity) -> Future[Any]:
        """Make a feed request a speed in its own thread; collect the result."""
        future: Future[Any] = Future()

        def send() -> None:
            try:
                future.set_result(self.link.send(feed, "/cmd_vel", velocity, time.monotonic() + 60.0, [CMD_VEL]))
            except Exception as error:
                future.set_exception(error)

        threading.Thread(target=send, daemon=True).start()
        return future

    def close(self) -> None:
        self.link.close()
        self._listening.join()
        self._ours.close()


@pytest.fixture
def played() -> Iterator[Played]:
    with closing(Played()) as guard:
        yield guard


def test_a_guard_hears_of_the_kernel_while_it_sends_the_first_speed(played: Played) -> None:
    asked = played.asked(1, Velocity(0.3))
    drive = played.hear("drive")
    for _ in range(3):
        played.hear("beat")
    played.answer(drive)
    assert asked.result(120).refused == ""


def test_a_guard_that_waits_for_a_slow_robot_again_and_again_is_at_work(
    played: Played, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = Clock()
    clock.process_time = time.process_time
    monkeypatch.setattr(link, "time", clock)
    monkeypatch.setattr(link, "LOOK", 0.005)
    asked = played.asked(1, ZERO)
    zero = played.hear("zero")
    while clock.now < 104.0:
        played.hear("beat")
        played.say("slow")
        clock.now += 0.01
    played.answer(zero)
    assert asked.result(120).refused == ""
    assert played.link.ends == 0


def test_a_guard_that_says_nothing_is_ended(played: Played, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link, "ANSWER", 0.1)
    asked = played.asked(1, ZERO)
    with pytest.raises(TimeoutError, match=r"the guard that sends speeds has not answered for 0\.1 s"):
        asked.result(120)
    wait_for(lambda: played.link.ends == 1, "it is ended")


def test_a_feed_drives_at_the_same_time_as_another_unless_its_first_speed_is_refused(played: Played) -> None:
    for refused, drives in ((True, False), (False, True), (True, True)):
        asked = played.asked(1, Velocity(0.3))
        played.answer(played.hear("drive"), *(("FeedError", "/cmd_vel is no topic of speeds") if refused else ()))
        assert bool(asked.exception(120)) == refused
        assert played.link.is_driven_beside(2) == drives
    asked = played.asked(1, ZERO)
    played.answer(played.hear("zero"))
    asked.result(120)
    assert not played.link.is_driven_beside(2)


# -- the process -------------------------------------------------------------------------------------------------------


@pytest.fixture
def robot() -> Iterator[Rosbridge]:
    with Rosbridge({"/cmd_vel": "geometry_msgs/msg/Twist"}) as server:
        server.listeners["/cmd_vel"], server.publishers["/cmd_vel"] = ["/base"], []
        yield server


@pytest.fixture
def with_guards() -> Iterator[ExitStack]:
    """Closes the opened feeds, and waits for the end of their guards."""
    with ExitStack() as opened:
        yield opened
    wait_for(lambda: not threads_named("robowidgets-guard"), "no guard is left")


def opened(stack: ExitStack, robot: Rosbridge) -> tuple[feeds.Feed, kernel_side.Guard]:
    feed = feeds.rosbridge(robot.address)
    stack.callback(feed.close)
    feed.driving = Driving(hold=60.0)
    guard = feed.driver._guard
    assert guard is not None
    wait_for(lambda: not guard.down, "the guard stands")
    return feed, guard


ENDS_WHEN_READY = kernel_side.START.replace(
    "main({server})",
    """from robowidgets.feeds._guard.frames import packed
import os
os.write(0, packed("ready"))
print("no room")
sys.exit(3)
""",
)
"""Starts a guard that ends as soon as it has reported that it is ready."""


def shown_by(feed: feeds.Feed) -> list[float]:
    """The speeds that a widget of a feed gets."""
    shown: list[float] = []
    feed.connection.attach("/cmd_vel", lambda speed: shown.append(speed.linear[0]))
    # Until it is known that no other node publishes them, they would come through the robot.
    wait_for(lambda: [one.offered for one in feed.connection.adverts] == [False], "the publishers are known")
    return shown


def wait_for_speeds(robot: Rosbridge, *speeds: float) -> None:
    """Wait until the last speeds of the robot are these; a zero may come again."""
    wait_for(lambda: tuple(_changes(robot)[-len(speeds) :]) == speeds, f"{speeds} come")


def _changes(robot: Rosbridge) -> list[float]:
    return [speed for speed, _ in groupby(message["linear"]["x"] for _, message in robot.published)]


@pytest.mark.slow
def test_a_guard_publishes_by_a_connection_of_its_own_and_confirms_zero(
    robot: Rosbridge, with_guards: ExitStack
) -> None:
    feed, guard = opened(with_guards, robot)
    assert guard.pid not in (0, os.getpid())
    wait_for(lambda: robot.opened == 2, "the server has opened both connections")
    feed.drive(0.3)
    feed.stop()
    wait_for_speeds(robot, 0.3, 0.0)
    assert feed.drive_status == ""
    assert "a guard next to the kernel sends speeds" in repr(feed)


@pytest.mark.slow
def test_feeds_of_one_robot_share_a_guard_that_ends_with_the_last_and_see_each_other_s_speeds(
    robot: Rosbridge, with_guards: ExitStack
) -> None:
    feed, guard = opened(with_guards, robot)
    other, same = opened(with_guards, robot)
    assert same is guard
    pid = guard.pid
    shown = shown_by(other)
    told = ("another feed of this kernel drives the robot, too", "")

    def is_seen() -> bool:
        if feed.drive_status:  # this process was paused for so long that the guard stopped the robot
            feed.stop()
        with suppress(FeedError):
            feed.drive(0.1)
        return shown[-1:] == [0.1] and (other.drive_status, feed.drive_status) == told

    wait_for(is_seen, "the other one shows it")
    feed.stop()
    wait_for(lambda: shown[-1] == 0.0 and other.drive_status == "", "the other one shows zero")
    feed.close()
    other.drive(0.3)
    other.close()
    wait_for_speeds(robot, 0.3, 0.0)
    wait_for(lambda: not Path(f"/proc/{pid}").exists(), "the process is gone")


@pytest.mark.slow
def test_a_guard_that_dies_is_reported_the_kernel_sends_zero_and_another_one_drives(
    robot: Rosbridge, with_guards: ExitStack, caplog: pytest.LogCaptureFixture
) -> None:
    feed, guard = opened(with_guards, robot)
    feed.drive(0.3)
    wait_for_speeds(robot, 0.3)
    pid = guard.pid
    os.kill(pid, signal.SIGKILL)
    wait_for_speeds(robot, 0.3, 0.0)
    wait_for(lambda: "the guard that sends speeds has ended (code -9)" in caplog.text, "it is reported")
    feed.drive(0.2)
    assert guard.pid not in (0, pid)
    feed.stop()
    wait_for_speeds(robot, 0.2, 0.0)


@pytest.mark.slow
def test_a_drive_waits_for_the_guard_that_follows_one_that_has_died(
    robot: Rosbridge, with_guards: ExitStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, guard = opened(with_guards, robot)
    seen, go_on = threading.Event(), threading.Event()

    def hold(*_: object) -> None:
        seen.set()
        assert go_on.wait(120)

    monkeypatch.setattr(guard, "_say", hold)
    feed.drive(0.3)
    os.kill(guard.pid, signal.SIGKILL)
    assert seen.wait(120)
    assert (guard.pid, guard.is_starting) == (0, True)
    go_on.set()
    feed.drive(0.2)
    assert guard.pid != 0
    wait_for(lambda: 0.2 in _changes(robot), "it drives")


@pytest.mark.slow
def test_a_guard_that_stands_still_is_ended_and_the_kernel_sends_zero_which_other_feeds_show(
    robot: Rosbridge, with_guards: ExitStack
) -> None:
    feed, guard = opened(with_guards, robot)
    other, _ = opened(with_guards, robot)
    shown = shown_by(other)
    feed.drive(0.3)
    wait_for_speeds(robot, 0.3)
    wait_for(lambda: shown == [0.3], "the other one shows it")
    pid = guard.pid
    os.kill(pid, signal.SIGSTOP)
    os.waitid(os.P_PID, pid, os.WSTOPPED | os.WNOWAIT)
    with suppress(FeedError):  # "zero follows", if it takes more than a second
        feed.stop()
    wait_for_speeds(robot, 0.3, 0.0)
    wait_for(lambda: shown[-1] == 0.0, "the other one shows zero")
    wait_for(lambda: not Path(f"/proc/{pid}").exists(), "the process is gone")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("error", "is_sent_here"),
    [(TimeoutError("nobody has confirmed zero"), False), (link.NoAnswerError("the guard does not answer"), True)],
    ids=["not confirmed", "no answer"],
)
def test_the_kernel_sends_a_zero_that_its_guard_cannot_but_not_one_that_is_not_confirmed(
    robot: Rosbridge,
    with_guards: ExitStack,
    monkeypatch: pytest.MonkeyPatch,
    error: Exception,
    is_sent_here: bool,
) -> None:
    feed, guard = opened(with_guards, robot)
    feed.drive(0.3)
    sent_here: list[str] = []
    publish = feed.connection.middleware.publish

    def note(topic: str, *message: Any) -> None:
        sent_here.append(topic)
        publish(topic, *message)

    def fail(*_: Any) -> None:
        raise error

    with monkeypatch.context() as broken:
        broken.setattr(feed.connection.middleware, "publish", note)
        broken.setattr(guard, "send", fail)
        with (
            nullcontext() if is_sent_here else pytest.raises(FeedError, match="nobody has confirmed zero; zero follows")
        ):
            feed.stop()
        assert sent_here == (["/cmd_vel"] if is_sent_here else [])
    wait_for_speeds(robot, 0.3, 0.0)


@pytest.mark.slow
def test_drives_are_refused_when_guards_die_again_and_again(
    robot: Rosbridge, with_guards: ExitStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, guard = opened(with_guards, robot)
    monkeypatch.setattr(kernel_side, "START", ENDS_WHEN_READY)
    os.kill(guard.pid, signal.SIGKILL)
    wait_for(lambda: "open the feed again" in guard.down, "no other one is started")
    with pytest.raises(FeedError, match=r"cannot drive: .*ended \(code 3; no room\); it has ended 3 times"):
        feed.drive(0.3)
    feed.stop()
    wait_for_speeds(robot, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("start", "why"),
    [
        ("import sys; print('no room'); sys.exit(3)", r"its process does not start: (code 3; no room)"),
        ("import time\nwhile True: time.sleep(60)", "its process does not start: it is not ready after 0.1 s"),
    ],
    ids=["ends", "hangs"],
)
def test_where_a_guard_does_not_start_the_kernel_sends_and_says_so(
    robot: Rosbridge,
    with_guards: ExitStack,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    start: str,
    why: str,
) -> None:
    monkeypatch.setattr(kernel_side, "START", start)
    monkeypatch.setattr(kernel_side, "READY_TIMEOUT", 0.1)
    feed = with_guards.enter_context(feeds.rosbridge(robot.address))
    feed.drive(0.3)
    feed.stop()
    wait_for_speeds(robot, 0.3, 0.0)
    assert f"the kernel itself sends speeds ({why}" in repr(feed)
    wait_for(lambda: "the kernel sends speeds by itself: its process does not start" in caplog.text, "it is logged")


@pytest.mark.slow
def test_a_guard_imports_the_standard_library_whatever_lies_in_the_folder_of_the_notebook(
    robot: Rosbridge, with_guards: ExitStack, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("types", "json", "selectors"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('of the user')")
    monkeypatch.syspath_prepend(tmp_path)  # as hosts do that name the folder
    feed, guard = opened(with_guards, robot)
    monkeypatch.chdir(tmp_path)
    os.kill(guard.pid, signal.SIGKILL)
    wait_for(lambda: guard.ends == 1 and not guard.down, "another guard stands, in this folder")
    feed.drive(0.3)
    assert not guard.unavailable
    wait_for_speeds(robot, 0.3)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_a_forked_process_refuses_to_drive_whatever_locks_were_held(robot: Rosbridge, with_guards: ExitStack) -> None:
    feed, guard = opened(with_guards, robot)
    feed.drive(0.3)
    reading, writing = os.pipe()
    with in_other_hands(guard._lock), in_other_hands(kernel_side._sharing), in_other_hands(feed.driver._changing):
        child = os.fork()
        if child == 0:
            try:
                signal.alarm(20)
                for use in (lambda: feed.drive(0.2), feed.stop, lambda: feed.program(print)):
                    with pytest.raises(FeedError, match="belongs to the parent of this forked process"):
                        use()
                feed.driving = Driving(hold=1.0)
                feed.stopped = True
                feed.close()
                kernel_side.guard_for(0, kernel_side.Outlet("rosbridge", {}), "a robot")
                os.write(writing, b"refused")
            finally:
                os._exit(0)
    os.close(writing)
    with open(reading) as answer:
        assert answer.read() == "refused"
    os.waitpid(child, 0)
    feed.stop()
    wait_for_speeds(robot, 0.3, 0.0)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="this system tells nobody of the end of a process")
def test_the_end_of_the_server_ends_the_guard_and_no_other_one_drives(
    robot: Rosbridge, with_guards: ExitStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    server = with_guards.enter_context(subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE))
    monkeypatch.setattr(kernel_side, "_server", lambda: server.pid)
    feed, guard = opened(with_guards, robot)
    feed.drive(0.3)
    wait_for_speeds(robot, 0.3)
    server.kill()
    wait_for_speeds(robot, 0.3, 0.0)
    wait_for(lambda: "open the feed again" in guard.down, "no other one is started")
    with pytest.raises(FeedError, match="the server that started this kernel has ended, and so will the kernel"):
        feed.drive(0.3)
    assert _changes(robot)[-1] == 0.0


@pytest.mark.parametrize(
    ("where", "is_so", "why"),
    [
        (kernel_side.sys, {"executable": "/nowhere/python"}, "no process can be started here: "),
        (kernel_side, {"NONE_HERE": "on Windows there is no guard"}, "on Windows there is no guard)"),
    ],
    ids=["a host that forbids it", "Windows"],
)
@pytest.mark.slow
def test_if_no_process_can_be_started_the_kernel_sends_and_reports_it(
    robot: Rosbridge,
    with_guards: ExitStack,
    monkeypatch: pytest.MonkeyPatch,
    where: Any,
    is_so: dict[str, str],
    why: str,
) -> None:
    for name, value in is_so.items():
        monkeypatch.setattr(where, name, value)
    feed = with_guards.enter_context(feeds.rosbridge(robot.address))
    feed.drive(0.3)
    feed.stop()
    wait_for_speeds(robot, 0.3, 0.0)
    assert f"the kernel itself sends speeds ({why}" in repr(feed)


@pytest.mark.slow
def test_a_damaged_message_ends_a_guard_with_zero(
    robot: Rosbridge, with_guards: ExitStack, caplog: pytest.LogCaptureFixture
) -> None:
    feed, guard = opened(with_guards, robot)
    feed.drive(0.3)
    wait_for_speeds(robot, 0.3)
    with guard._lock:
        guard._write(b"\x00" * 100)
    wait_for_speeds(robot, 0.3, 0.0)
    wait_for(lambda: "a message is not known" in caplog.text, "it is reported")


@pytest.mark.slow
def test_a_guard_survives_the_signals_of_a_terminal_and_ends_with_zero_on_request(
    robot: Rosbridge, with_guards: ExitStack
) -> None:
    feed, guard = opened(with_guards, robot)
    pid = guard.pid
    for number in (signal.SIGINT, signal.SIGHUP):
        os.kill(pid, number)
    feed.drive(0.3)
    wait_for_speeds(robot, 0.3)
    assert (guard.pid, os.getsid(pid)) == (pid, pid)
    os.kill(pid, signal.SIGTERM)
    wait_for_speeds(robot, 0.3, 0.0)


@pytest.mark.slow
def test_a_step_that_held_the_gil_says_that_the_guard_stopped_the_robot_and_so_does_the_feed(
    user_limits: None, robot: Rosbridge, with_guards: ExitStack
) -> None:
    feed, _ = opened(with_guards, robot)

    def go(state):  # type: ignore[no-untyped-def]
        state.steps = state.get("steps", 0) + 1
        if state.steps == 20:
            ctypes.PyDLL(None).usleep(1_500_000)
        return Drive(0.3)

    program = feed.program(go, rate=50)
    wait_for(lambda: program.mode == "failed", "it failed")
    assert program.error.startswith("a step took ")
    assert program.error.endswith("held the GIL: nothing else could run, and the guard stopped the robot meanwhile")
    wait_for(lambda: "the kernel was silent for " in feed.drive_status, "the feed says so")
    assert feed.drive_status.endswith("the guard stopped the robot meanwhile")
    wait_for_speeds(robot, 0.3, 0.0)
    wait_for(lambda: not feed.stop() and not feed.drive_status, "it has reported it")


@pytest.mark.slow
def test_a_pad_says_what_sends_the_speeds(robot: Rosbridge, with_guards: ExitStack) -> None:
    feed, _ = opened(with_guards, robot)
    pad = DriveWidget()
    pad.connect(feed)
    assert pad.get_state()["_state"]["sender"].startswith("a guard next to the kernel sends speeds")
    pad.close()
    alone = DriveWidget(send=lambda *_: None)
    assert alone.get_state()["_state"]["sender"] == ""
    alone.close()


@pytest.mark.slow
def test_a_guard_opens_no_port(robot: Rosbridge, with_guards: ExitStack) -> None:
    _, guard = opened(with_guards, robot)
    links = [os.readlink(link) for link in Path(f"/proc/{guard.pid}/fd").iterdir()]
    listening = {
        f"socket:[{line.split()[9]}]"
        for name in ("tcp", "tcp6")
        for line in Path(f"/proc/{guard.pid}/net/{name}").read_text().splitlines()[1:]
        if line.split()[3] == "0A"
    }
    assert listening
    assert not listening.intersection(links)


@pytest.mark.slow
def test_a_guard_finds_modules_where_python_does_whatever_else_is_in_the_path(monkeypatch: pytest.MonkeyPatch) -> None:
    class Text(str):
        def __repr__(self) -> str:
            return "Text()"

    paths = ["", "/usr/lib/one", Path("/usr/lib/two"), 1, None, Text("/usr/lib/three"), str(Path.cwd())]
    monkeypatch.setattr(sys, "path", paths)
    assert repr(kernel_side._path()) == "['/usr/lib/one', '/usr/lib/three']"
    assert repr(import_path()) == f"['', '/usr/lib/one', '/usr/lib/three', {str(Path.cwd())!r}]"


def test_a_guard_imports_neither_jupyter_nor_widgets() -> None:
    code = kernel_side._code(0).replace(
        "\nmain(0)\n", "\nfrom robowidgets.feeds import dds, foxglove, ros1, ros2, rosbridge\n"
    )
    code += "from robowidgets.feeds import _dds_session\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-S", "-c", code], capture_output=True, text=True, check=True)
    loaded = done.stdout.split()
    assert "robowidgets.feeds.rosbridge" in loaded
    unwanted = ("IPython", "ipykernel", "ipywidgets", "traitlets", "anywidget", "jupyter_client", "numpy")
    assert not [name for name in loaded if name.split(".")[0] in unwanted or name.endswith("_widget")]


def test_what_a_guard_says_is_checked() -> None:
    with pytest.raises(DamagedError):
        list(Unpacker(FROM_GUARD).take(packed("up", 1)))
