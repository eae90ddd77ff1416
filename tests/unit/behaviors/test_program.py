"""Programs: the arguments of a step, the use of its return value, and the values that the user sees and sets."""

from __future__ import annotations

import gc
import logging
import re
import sys
import threading
import time
import weakref
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from math import cos, hypot, inf, pi, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robowidgets import SAMPLE, feeds
from robowidgets.behaviors import Drive
from robowidgets.behaviors.robot import NotReadyError
from robowidgets.behaviors.variables import ProgramState
from robowidgets.driving import command_watchdog
from robowidgets.driving.command_watchdog import Velocity
from robowidgets.feeds import Advert, Feed, FeedError
from robowidgets.feeds._program_inputs import FeedInputs
from robowidgets.samples import Pose, Scan, Speed, Touch
from robowidgets.samples.staleness import SilenceRule

from ..clocks import ManualClock
from ..feeds.scripted import CMD_VEL, IMU, ODOM, SCAN, Scripted, scan, twist
from ..waiting import wait_for

# ruff: noqa: N805

BUMPER = Advert("/bumper", "kobuki_msgs/msg/BumperEvent")


@pytest.fixture
def script() -> Scripted:
    return Scripted(SCAN, ODOM, BUMPER, IMU, CMD_VEL)


@pytest.fixture
def robot(script: Scripted) -> Iterator[Feed]:
    with Feed(script) as feed:
        yield feed


def test_a_step_gets_what_it_names_and_its_speed_is_sent(robot: Feed, script: Scripted) -> None:
    got: list[tuple[Any, ...]] = []

    @robot.program(rate=100, imu="/imu")
    def look(scan, speed, touch, imu, time, state, variables, kept=3):  # type: ignore[no-untyped-def]
        got.append((scan, speed, touch, imu, time, kept))
        return Drive(0.2, -0.1)

    messages: dict[str, Any] = {"/scan": scan(1.5), "/odom": twist(0.2), "/bumper": {"bumper": 0, "state": 1}}
    for topic, message in messages.items():
        script.listener.on_message(topic, message)
    wait_for(lambda: look.waiting == "waiting for /imu", "it says what is missing")
    script.listener.on_message("/imu", {"w": 1.0})
    wait_for(lambda: script.speeds[:1] == [(0.2, -0.1)], "its speed is sent")
    assert [type(one) for one in got[0]] == [Scan, Speed, Touch, dict, float, int]
    assert look(1, 2, 3, 4, 5, 6, 7) == Drive(0.2, -0.1)


def test_state_and_time_go_on_after_another_program(robot: Feed) -> None:
    seen: list[tuple[float, float]] = []

    def go(state, time):  # type: ignore[no-untyped-def]
        state.since = state.get("since", time)
        seen.append((state.since, time))

    robot.program(go, rate=100)
    wait_for(lambda: len(seen) > 20, "it steps")
    robot.program(lambda: Drive())
    steps, last = len(seen), seen[-1]
    robot.program(go, rate=100)
    wait_for(lambda: len(seen) > steps, "it steps again")
    assert seen[-1][0] == last[0]
    assert seen[-1][1] > last[1]


def test_on_a_topic_there_is_one_step_for_each_message(robot: Feed, script: Scripted) -> None:
    got: list[float] = []

    @robot.program(on="/scan")
    def look(scan):  # type: ignore[no-untyped-def]
        got.append(float(scan.ranges[0]))

    for distance in (1.0, 2.0, 3.0):
        script.listener.on_message("/scan", scan(distance))
        wait_for(lambda d=distance: got[-1:] == [d], "it steps")  # type: ignore[misc]
    assert got == [1.0, 2.0, 3.0]
    assert look.steps == 3


def test_a_program_on_a_topic_without_messages_says_so(robot: Feed, script: Scripted) -> None:
    @robot.program(on="/scna")
    def look(scan):  # type: ignore[no-untyped-def]
        return Drive(0.1)

    wait_for(lambda: "did you mean /scan?" in look.waiting, "it says that there is no such topic")

    @robot.program(on="/scan")
    def look(scan):  # type: ignore[no-untyped-def]  # noqa: F811
        return Drive(0.1)

    script.listener.on_message("/scan", scan())
    wait_for(lambda: look.steps == 1 and not look.waiting, "it steps")
    wait_for(lambda: look.waiting == "waiting for /scan", "it says that no more came")
    assert look.returned == Drive()
    script.listener.on_message("/scan", scan())
    wait_for(lambda: look.steps == 2 and not look.waiting, "it goes on")


def test_samples_that_cannot_be_taken_end_it_with_a_word_and_its_next_version_drives(
    robot: Feed, script: Scripted
) -> None:
    def go() -> Drive:
        return Drive(0.1)

    program = robot.program(go, rate=100)
    wait_for(lambda: script.speeds[-1:] == [(0.1, 0.0)], "it drives")
    inputs: Any = program._inputs
    take, inputs.take = inputs.take, lambda: {}["/scan"]
    wait_for(lambda: (program.mode, program.error) == ("failed", "KeyError: '/scan'"), "it says why")
    wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "the robot stands")
    inputs.take = take
    robot.program(go, rate=100)
    wait_for(lambda: script.speeds[-1] == (0.1, 0.0), "it drives again")


def test_a_version_may_choose_other_samples_while_the_last_version_takes_its_own(robot: Feed, script: Scripted) -> None:
    inputs, is_over, seen = FeedInputs(robot.connection, lambda: None), threading.Event(), set()

    def take() -> None:
        while not is_over.is_set():
            with suppress(NotReadyError):
                seen.add(tuple(inputs.take()))

    inputs.choose({"scan": None}, None)
    thread = threading.Thread(target=take)
    thread.start()
    until = time.monotonic() + 0.5
    while time.monotonic() < until or not seen:
        inputs.choose({"scan": None, "touch": None, "speed": None}, None)
        script.listener.on_message("/scan", scan())
        inputs.choose({"scan": None}, None)
        script.listener.on_message("/scan", scan())
    assert thread.is_alive()
    is_over.set()
    thread.join()
    assert seen == {("scan",)}
    inputs.close()
    assert not robot.connection.by_topic


def test_a_bump_between_two_steps_is_not_lost(robot: Feed, script: Scripted) -> None:
    got: list[Any] = []

    @robot.program(rate=100)
    def look(touch):  # type: ignore[no-untyped-def]
        got.append(touch.touched["left"])

    for state in (0, 1, 0):
        script.listener.on_message("/bumper", {"bumper": 0, "state": state})
    wait_for(lambda: True in got and got[-1] is False, "the touch is seen once, and then the release")


@pytest.mark.parametrize("missing", ["scan", "pose"])
def test_a_bump_while_another_sample_is_missing_is_seen_by_the_next_step(
    robot: Feed, script: Scripted, missing: str
) -> None:
    inputs = FeedInputs(robot.connection, lambda: None)
    inputs.choose({"touch": None, missing: None}, None)
    for state in (1, 0):
        script.listener.on_message("/bumper", {"bumper": 0, "state": state})
    for _ in range(2):
        with pytest.raises(NotReadyError):
            inputs.take()
    script.listener.on_message("/scan", scan())
    script.listener.on_message("/odom", odometry(0.0, 0.0, 0.0))
    assert [inputs.take()["touch"].touched["left"] for _ in range(2)] == [True, False]
    inputs.close()


def test_no_step_goes_by_what_came_before_a_message_that_cannot_be_read(robot: Feed, script: Scripted) -> None:
    inputs = FeedInputs(robot.connection, lambda: None)
    inputs.choose({"scan": None}, None)
    unread = pytest.raises(NotReadyError, match=r"^a message of /scan cannot be read: angle_increment: ")
    for _ in range(2):
        script.listener.on_message("/scan", scan() | {"angle_increment": float("nan")})
        for _ in range(2):
            with unread:
                inputs.take()
        script.listener.on_message("/scan", scan())
        assert inputs.take()["scan"].ranges.size
    inputs.choose({"touch": None}, None)
    script.listener.on_message("/bumper", {"bumper": 0, "state": 0})
    inputs.take()
    for message in ({"bumper": 7, "state": 9}, {"bumper": 1, "state": 1}, {"bumper": 1, "state": 0}):
        script.listener.on_message("/bumper", message)
    assert [inputs.take()["touch"].touched["center"] for _ in range(2)] == [True, False]
    inputs.close()


@pytest.mark.parametrize(
    ("pauses", "until"),
    [
        ([0.1] * 9, 0.4),
        ([0.1] * 8, inf),
        ([0.3] * 9, 0.6),
        ([5.0] * 9, 10.0),
        ([0.1, 4, 0.7, 2, 30, 0.2] * 3, inf),
        ([], inf),
    ],
    ids=["10 Hz", "too few", "slow", "very slow", "events", "one"],
)
def test_a_message_that_a_program_names_is_too_old_where_they_came_at_a_steady_pace(
    robot: Feed, script: Scripted, monkeypatch: pytest.MonkeyPatch, pauses: list[float], until: float
) -> None:
    clock = ManualClock()
    monkeypatch.setattr("robowidgets.feeds._program_inputs.time", SimpleNamespace(monotonic=clock.now))
    inputs = FeedInputs(robot.connection, lambda: None)
    inputs.choose({"imu": "/imu"}, None)
    for pause in [0.0, *pauses]:
        clock.set(clock.now() + pause)
        script.listener.on_message("/imu", {"orientation": {"z": 0.5}})
    last = clock.now()
    clock.set(last + min(until, 1000.0) - 0.01)
    assert inputs.take()["imu"] == {"orientation": {"z": 0.5}}
    assert inputs.why_not_ready() == ""
    if until < inf:
        clock.set(last + until + 0.01)
        with pytest.raises(NotReadyError, match=r"^no imu comes on /imu any more$"):
            inputs.take()
    inputs.close()


def test_none_keeps_the_speed_and_zero_follows_the_last_scan(
    robot: Feed, script: Scripted, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot.driving = feeds.Driving(hold=60.0)
    returned: list[Any] = [Drive(0.2), None]

    @robot.program(rate=100)
    def go(scan):  # type: ignore[no-untyped-def]
        return returned.pop(0) if len(returned) > 1 else None

    with monkeypatch.context() as patch:
        patch.setattr("robowidgets.feeds._program_inputs.TO_DRIVE_BY", SilenceRule(2, 1000.0))
        script.listener.on_message("/scan", scan(1.0))
        wait_for(lambda: len(script.speeds) > 20, "it steps on")
        assert set(script.speeds) == {(0.2, 0.0)}
    wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "no scan comes any more")
    wait_for(lambda: go.waiting == "no scan comes on /scan any more", "the reason, which follows the zero")
    assert go.mode == "running"


def test_a_hand_outranks_a_program_which_goes_on_after_it(
    robot: Feed, script: Scripted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command_watchdog, "HOLD", 3600.0)  # a press ends when it is released

    @robot.program(rate=50)
    def go():  # type: ignore[no-untyped-def]
        return Drive(0.2)

    wait_for(lambda: (0.2, 0.0) in script.speeds, "it drives")
    robot.watchdog.take("press")
    wait_for(lambda: "a hand drives" in go.waiting, "it shows the driver")
    count = len(script.speeds)
    robot.driver.drive_by_hand(Velocity(0.1), "press")
    wait_for(lambda: (0.1, 0.0) in script.speeds[count:], "the hand drives")
    assert set(script.speeds[count:]) <= {(0.0, 0.0), (0.1, 0.0)}  # zero comes where the hand takes over
    robot.watchdog.let_go("press")
    wait_for(lambda: script.speeds[-1] == (0.2, 0.0), "it drives again")


def test_paused_it_makes_single_steps(robot: Feed, script: Scripted) -> None:
    @robot.program(rate=100)
    def count(state):  # type: ignore[no-untyped-def]
        state.n = state.get("n", 0) + 1
        return Drive(state.n / 1000)

    wait_for(lambda: count.steps > 3, "it runs")
    wait_for(lambda: script.speeds, "it drives")
    count.pause()
    wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "zero is sent")
    before = count.state.n
    count.step()
    wait_for(lambda: ((before + 1) / 1000, 0.0) in script.speeds, "one step drives")
    wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "its speed ends with the hold")
    assert (count.mode, count.state.n) == ("paused", before + 1)
    count.run()
    wait_for(lambda: count.state.n > before + 3, "it goes on")


def test_a_replaced_step_that_comes_back_late_moves_nothing(robot: Feed, script: Scripted) -> None:
    gate, entered, refused = threading.Event(), threading.Event(), []

    def go():  # type: ignore[no-untyped-def]
        entered.set()
        gate.wait(120)
        try:
            robot.drive(0.4)
        except FeedError as error:
            refused.append(str(error))
        return Drive(0.5)

    robot.program(go)
    assert entered.wait(120)

    def newer():  # type: ignore[no-untyped-def]
        return Drive(0.1)

    newer.__name__ = go.__name__
    program = robot.program(newer)
    wait_for(lambda: script.speeds[-1:] == [(0.1, 0.0)], "the new version drives")
    gate.set()
    wait_for(lambda: refused, "the old one comes back")
    steps = program.steps
    wait_for(lambda: program.steps > steps + 2, "a few steps later")
    assert set(script.speeds) == {(0.1, 0.0)}
    assert program.version.number == 2


def test_no_speed_follows_the_zero_on_a_topic_that_is_left(
    robot: Feed, script: Scripted, monkeypatch: pytest.MonkeyPatch
) -> None:
    publish = script.publish

    def slow_zero(topic: str, message_type: str, message: Any) -> None:
        publish(topic, message_type, message)
        time.sleep(0.05 if message["linear"]["x"] == 0.0 else 0.0)

    monkeypatch.setattr(script, "publish", slow_zero)

    @robot.program(rate=200)
    def go():  # type: ignore[no-untyped-def]
        return Drive(0.2)

    wait_for(lambda: (0.2, 0.0) in script.speeds, "it drives")
    robot.driving = feeds.Driving(topic="/other")
    wait_for(lambda: script.sent[-1][0] == "/other", "it drives on the other topic")
    left = [message["linear"]["x"] for topic, _, message in script.sent if topic == "/cmd_vel"]
    assert (left[-1], left.count(0.0)) == (0.0, 1)


@pytest.fixture
def hanging_log() -> Iterator[threading.Event]:
    """Yield while every logging thread hangs; set the event to end that."""
    gate, handler = threading.Event(), logging.Handler()
    handler.emit = lambda record: None if gate.wait(120) else record  # type: ignore[method-assign]
    logging.getLogger("robowidgets").addHandler(handler)
    yield gate
    gate.set()
    logging.getLogger("robowidgets").removeHandler(handler)


@pytest.mark.parametrize("fault", ["raises", "hangs", "is interrupted"])
def test_a_log_that_hangs_keeps_no_zero_from_the_robot(
    user_limits: None, robot: Feed, script: Scripted, hanging_log: threading.Event, fault: str
) -> None:
    robot.driving = feeds.Driving(hold=60.0)
    faults: list[str] = []

    @robot.program(rate=50)
    def go():  # type: ignore[no-untyped-def]
        if "raises" in faults:
            raise ValueError(faults)
        return Drive(0.2) if "hangs" not in faults or hanging_log.wait(120) else None

    wait_for(lambda: (0.2, 0.0) in script.speeds, "it drives")
    faults.append(fault)
    if fault == "is interrupted":
        go.interrupt()
        wait_for(lambda: go.mode == "paused", "it pauses")
    wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "zero is sent")


def test_what_it_prints_is_kept_and_what_others_print_is_not(robot: Feed, capsys: pytest.CaptureFixture[str]) -> None:
    stdout = sys.stdout

    @robot.program(rate=100)
    def talk(state):  # type: ignore[no-untyped-def]
        state.n = state.get("n", 0) + 1
        if state.n <= 4:
            sys.stdout.write(f"step {state.n}\n")

    wait_for(lambda: talk.steps > 5, "it runs")
    sys.stdout.write("from outside\n")
    assert [text for _, text in talk.prints.lines] == ["step 2", "step 3", "step 4"]
    assert {"step 4", "from outside"} <= set(capsys.readouterr().out.splitlines())
    assert sys.stdout is not stdout
    between = weakref.ref(sys.stdout)
    talk.pause()
    wait_for(lambda: sys.stdout is stdout, "nothing stands between after its end")
    gc.collect()
    assert between() is not None, "another thread may still be writing there, by a print without a reference to it"


def test_a_loop_that_is_abandoned_or_replaced_is_ended(user_limits: None, robot: Feed, script: Scripted) -> None:
    ended: list[int] = []

    def loop(state):  # type: ignore[no-untyped-def]
        state.n = state.get("n", 0) + 1
        number = state.n
        try:
            while True:
                pass
        finally:
            ended.append(number)

    program = robot.program(loop)
    wait_for(lambda: "abandoned" in program.error, "it is found")
    wait_for(lambda: ended == [1], "it is ended")
    program.run()
    wait_for(lambda: program.state.n == 2, "it loops again")
    robot.program(loop)
    wait_for(lambda: program.state.n == 3, "the next version loops, too")
    wait_for(lambda: sorted(ended) == [1, 2, 3], "both are ended")
    assert set(script.speeds) <= {(0.0, 0.0)}


def test_variables_keep_what_was_set_by_hand_until_their_first_value_changes(robot: Feed) -> None:
    variables = robot.variables
    variables.slider("near", 0.6, 0.2, 2.0, "m")
    variables.go = True
    variables.set("near", 5)
    assert variables.near == 2.0
    variables.slider("near", 0.6, 0.2, 1.5, "m")
    assert variables.near == 1.5
    variables.slider("near", 0.7, 0.2, 1.5)
    assert variables.near == 0.7
    with pytest.raises(TypeError, match="go: expected True or False"):
        variables.set("go", 1)
    with pytest.raises(ValueError, match="near: expected a finite number"):
        variables.set("near", float("nan"))
    with pytest.raises(TypeError, match="near: expected a number, got 'far'"):
        variables.set("near", "far")
    with pytest.raises(AttributeError, match=r"no variable 'far': there are near, go; variables.far = 0.5 makes one"):
        _ = variables.far
    with pytest.raises(ValueError, match="expected low <= value <= high, got 1, 3, 2"):
        variables.slider("wide", 3, 1, 2)


def test_the_log_has_its_error_without_our_frames_and_no_false_warning(
    robot: Feed, caplog: pytest.LogCaptureFixture
) -> None:
    def first():  # type: ignore[no-untyped-def]
        return Drive()

    def second():  # type: ignore[no-untyped-def]
        try:
            return Drive("fast")  # type: ignore[arg-type]
        except TypeError as error:
            raise ValueError("no speed") from error

    with caplog.at_level(logging.INFO, "robowidgets"):
        robot.program(first)
        program = robot.program(second)
        wait_for(lambda: "Traceback" in caplog.text, "the error is logged")
    assert program.mode == "failed"
    replaces = next(record for record in caplog.records if "replaces" in record.message)
    assert replaces.levelno == logging.INFO
    files = re.findall(r'File "(.+)", line', caplog.text)
    assert files == [__file__, __file__]
    assert caplog.text.count("Traceback") == 2


def test_a_step_that_returns_no_drive_is_reported_in_one_line_without_a_traceback_of_ours(
    robot: Feed, caplog: pytest.LogCaptureFixture
) -> None:
    program = robot.program(lambda: 0.2)
    wait_for(lambda: caplog.messages, "the error is logged")
    (said,) = caplog.messages
    words = "expected a step to return Drive(linear, angular), or None to keep the speed, got 0.2"
    assert said == f"program {program.name}: TypeError: {words}"
    assert (program.mode, caplog.records[0].exc_info) == ("failed", None)


def test_integers_stay_integers_in_variables(robot: Feed) -> None:
    variables = robot.variables

    def value(name: str) -> tuple[type, Any]:
        return type(getattr(variables, name)), getattr(variables, name)

    variables.turns, variables.way, variables.index = 3, 3.0, np.int64(7)
    assert (value("turns"), value("way"), value("index")) == ((int, 3), (float, 3.0), (int, 7))
    variables.set("turns", 4.0)
    variables.set("way", 4)
    assert (value("turns"), value("way")) == ((int, 4), (float, 4.0))
    variables.set("turns", 0.5)
    assert value("turns") == (float, 0.5)
    variables.set("turns", 2)
    assert value("turns") == (int, 2), "a number that was whole is whole again"
    with pytest.raises(TypeError, match="turns: expected a number, got True"):
        variables.set("turns", True)
    variables.slider("rooms", 3, 1, 9)
    variables.slider("near", 1.0, 0, 2)
    variables.set("rooms", 4.4)
    variables.set("near", 2)
    variables.near = 1
    assert (value("rooms"), value("near")) == ((int, 4), (float, 1.0))
    variables.slider("rooms", 3, 1, 3)
    assert value("rooms") == (int, 3)
    assert range(variables.rooms) == range(3)


def test_a_program_shows_a_distance_that_may_be_inf_and_a_truth_of_numpy(robot: Feed) -> None:
    robot.variables.front, robot.variables.is_near = inf, np.bool_(True)
    assert str(robot.variables) == "Variables(front=inf, is_near=True)"


def test_what_is_called_without_a_name_has_the_same_one_in_each_version(robot: Feed) -> None:
    class Forward:
        def __call__(self) -> Drive:
            return Drive(0.1)

    robot.program(Forward())
    assert str(robot.program(Forward())).startswith("program Forward, version 2")
    assert robot.program(partial(lambda speed: Drive(speed), 0.1)).name == "<lambda>"


def test_a_state_takes_no_name_of_a_method() -> None:
    state = ProgramState()
    with pytest.raises(AttributeError, match=r"state.values is a method of a dictionary; write state\['values'\]"):
        state.values = [1]  # type: ignore[method-assign, assignment]


def test_a_slider_knows_its_value_in_the_version_before(robot: Feed) -> None:
    variables = robot.variables

    def before() -> object:
        return variables.table["near"].before

    def go():  # type: ignore[no-untyped-def]
        return Drive()

    variables.slider("near", 0.6, 0.2, 2.0, "m")
    robot.program(go)
    variables.set("near", 0.9)
    assert before() == 0.6
    variables.slider("near", 0.6, 0.2, 2.0, "m")
    robot.program(go)
    assert before() == 0.9
    variables.slider("near", 1.2, 0.2, 2.0, "m")
    robot.program(go)
    assert (before(), variables.near) == (0.9, 1.2)


async def _waits() -> Drive:
    return Drive()


@pytest.mark.parametrize(
    ("define", "error", "words"),
    [
        (lambda robot: robot.program(lambda scn: scn), TypeError, "asks for 'scn'; .* did you mean scan"),
        (lambda robot: robot.program(lambda *a: a), TypeError, "expected parameters with names, such as scan"),
        (lambda robot: robot.program(3), TypeError, "expected a function that returns a Drive, got 3"),
        (lambda robot: robot.program(lambda: None, rate=0), ValueError, "rate: expected steps a second, above 0"),
        (lambda robot: robot.program(lambda: None, rate=1, on="/scan"), TypeError, "got both"),
        (lambda robot: robot.program(lambda: None, imu="/imu"), TypeError, "no parameter 'imu' for it"),
        (
            lambda robot: robot.program(lambda: None, rtae=10),
            TypeError,
            "rtae=10: .* the other arguments are rate= and on=",
        ),
        (lambda robot: robot.program(_waits), TypeError, r"_waits\(\) may await: let a step return at once"),
        (lambda robot: robot.program(lambda: (yield Drive())), TypeError, r"<lambda>\(\) may yield: let a step return"),
    ],
)
def test_a_program_that_can_never_run_is_refused(robot: Feed, define: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        define(robot)
    assert robot.programs.current is None


def test_a_topic_of_another_kind_is_not_a_scan(robot: Feed, script: Scripted) -> None:
    program = robot.program(lambda scan: Drive(scan.distance()), scan="/odom")
    script.listener.on_message("/odom", odometry(0.0, 0.0, 0.0))
    wait_for(lambda: "scan='/odom': expected a topic of laser scans, got one of speeds" in repr(program), "it says so")
    assert program.error == ""


def test_of_several_scanners_one_must_be_named(script: Scripted) -> None:
    script = Scripted(SCAN, SCAN._replace(name="/rear"), CMD_VEL)
    with Feed(script) as robot:

        @robot.program(rate=100)
        def go(scan):  # type: ignore[no-untyped-def]
            return Drive(0.1)

        words = "2 topics have a scan: /scan, /rear; name one: program(scan='/scan')"
        wait_for(lambda: go.waiting == words, "it asks")
        script.listener.on_message("/rear", scan(1.0))
        robot.program(go.version.function, rate=100, scan="/rear")
        script.listener.on_message("/rear", scan(1.0))
        wait_for(lambda: script.speeds[-1:] == [(0.1, 0.0)], "it drives by the one that was named")


def test_the_same_program_runs_on_a_recording_next_to_the_recorded_speeds() -> None:
    with feeds.recording(SAMPLE, speed=4) as robot:
        view = robot.show()

        @robot.program(rate=20)
        def avoid(scan, touch, speed):  # type: ignore[no-untyped-def]
            return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)

        wait_for(lambda: avoid.steps > 3, "it steps")
        wait_for(lambda: any("your program" in topic.name for topic in robot.topics), "its speeds are listed")
        assert "/odom" in view.widgets
        wait_for(lambda: avoid.error == "" and robot.watchdog.sent != Velocity(), "it drives")


def odometry(x: float, y: float, yaw: float) -> dict[str, Any]:
    return {
        "pose": {
            "pose": {
                "position": {"x": x, "y": y, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": sin(yaw / 2), "w": cos(yaw / 2)},
            }
        },
        "twist": twist(0.1),
    }


def test_pose_and_the_way_since_the_program_began_come_from_all_messages_of_odometry(
    robot: Feed, script: Scripted
) -> None:
    got: list[tuple[Any, float, float]] = []

    @robot.program(on="/scan")
    def go(pose, driven, turned):  # type: ignore[no-untyped-def]
        got.append((pose, driven, turned))

    script.listener.on_message("/scan", scan())
    wait_for(lambda: go.waiting == "waiting for /odom", "it says what is missing")
    script.listener.on_message("/odom", odometry(1.0, 2.0, 3.0))
    script.listener.on_message("/scan", scan())
    wait_for(lambda: got, "it steps")
    assert got[-1] == (pytest.approx((1.0, 2.0, 3.0)), 0.0, 0.0)
    for pose in ((1.3, 2.0, 3.1), (1.0, 2.0, -3.1), (1.0, 2.4, -2.9)):  # there and back, and across the seam
        script.listener.on_message("/odom", odometry(*pose))
    script.listener.on_message("/scan", scan())
    wait_for(lambda: len(got) > 1, "it steps again")
    assert got[-1] == (
        pytest.approx((1.0, 2.4, -2.9)),
        pytest.approx(1.0),
        pytest.approx(2 * pi - 5.9),
    )
    go.restart()
    script.listener.on_message("/scan", scan())
    wait_for(lambda: len(got) > 2, "it restarts")
    assert got[-1][1:] == (0.0, 0.0)


def test_the_way_goes_on_with_the_state_after_another_program(robot: Feed, script: Scripted) -> None:
    got: list[tuple[float, float]] = []

    def go(driven, turned):  # type: ignore[no-untyped-def]
        got.append((driven, turned))

    def step(x: float, yaw: float) -> None:
        script.listener.on_message("/odom", odometry(x, 0.0, yaw))
        seen = len(got)
        script.listener.on_message("/scan", scan())
        wait_for(lambda: len(got) > seen, "it steps")

    robot.program(go, on="/scan")
    for x, yaw in ((0.0, 0.0), (5.0, 1.0)):
        step(x, yaw)
    robot.program(lambda: Drive())
    program = robot.program(go, on="/scan")
    for x, yaw in ((7.0, 2.0), (7.5, 2.5)):  # the other program drove from 5 m to 7 m
        step(x, yaw)
    assert got[-2:] == [pytest.approx((5.0, 1.0)), pytest.approx((5.5, 1.5))]
    program.restart()
    step(8.0, 2.5)
    assert got[-1] == (0.0, 0.0)


def test_a_reset_of_odometry_is_no_way_even_if_a_pose_from_before_still_comes(robot: Feed, script: Scripted) -> None:
    got: list[tuple[float, float]] = []

    @robot.program(on="/scan")
    def go(driven, turned):  # type: ignore[no-untyped-def]
        got.append((driven, turned))

    def step(*ways: tuple[float, float]) -> None:
        for x, yaw in ways:
            script.listener.on_message("/odom", odometry(x, 0.0, yaw))
        seen = len(got)
        script.listener.on_message("/scan", scan())
        wait_for(lambda: len(got) > seen, "it steps")

    step((0.0, 0.0))
    for x, yaw in ((0.0, 0.0), (2.0, 1.0), (3.0, 1.0)):  # not read by a step before the reset
        script.listener.on_message("/odom", odometry(x, 0.0, yaw))
    go.restart(Pose(0.0, 0.0, 0.0))
    step((3.1, 1.0))
    step((0.0, 0.0))
    step((0.5, 0.2))
    assert got[-3:] == [(0.0, 0.0), (0.0, 0.0), pytest.approx((0.5, 0.2))]


def test_without_odometry_it_says_what_is_missing() -> None:
    with Feed(Scripted(SCAN, CMD_VEL)) as robot:

        @robot.program(rate=100)
        def go(driven):  # type: ignore[no-untyped-def]
            return Drive()

        wait_for(lambda: go.waiting == "waiting for a topic with odometry", "it says so")


@pytest.mark.parametrize(
    ("rate", "hold", "words"),
    [
        (
            1,
            0.5,
            "a step each 1 s, but a speed holds for 0.5 s, so the robot stands before the next one; "
            "choose a rate above 2",
        ),
        (2, 0.5, "a step each 0.5 s, "),
        (2.1, 0.5, ""),
        (1, 1.5, ""),
    ],
)
def test_a_program_whose_speeds_end_before_its_next_step_says_so(
    robot: Feed, caplog: pytest.LogCaptureFixture, rate: float, hold: float, words: str
) -> None:
    robot.driving = feeds.Driving(hold=hold)
    with caplog.at_level(logging.INFO, "robowidgets"):
        robot.program(lambda: Drive(), rate=rate).pause()
        robot.program(lambda: Drive(), on="/scan").pause()
    said = [record.message for record in caplog.records if "a step each" in record.message]
    assert len(said) == bool(words)
    assert not words or words in said[0]


def test_restart_begins_with_an_empty_state_at_time_zero_in_the_initial_state(robot: Feed) -> None:
    seen: list[int] = []

    class Walker:
        def first(state, time):
            state.at = time

        def second(state):
            state.n = state.get("n", 0) + 1
            seen.append(state.n)
            return Drive(0.1)

        moves = "first -> second after 0.05"

    program = robot.program(Walker, rate=100)
    before = program.version.function
    wait_for(lambda: program.state.get("n", 0) > 3, "it has been in the second state")
    program.pause()
    seen.clear()
    program.restart()
    assert program.mode == "running"
    wait_for(lambda: 1 in seen, "it restarts")
    fired = program.version.function.fired  # type: ignore[attr-defined]
    assert program.version.function is not before
    assert [(move.source, move.target) for move in fired] == [("first", "second")]
    assert fired[0].time < 1
    assert program.version.number == 1


def test_a_program_goes_to_a_state_at_its_next_step_also_after_a_pause(robot: Feed) -> None:
    class Walker:
        first = second = None
        moves = "first -> second after 600"

    program = robot.program(Walker, rate=100)
    machine: Any = program.version.function
    wait_for(lambda: machine.active == ("first",), "it runs")
    program.pause()
    program.go_to("second")
    assert program.note == "goes to second at its next step"
    assert repr(program).startswith("program Walker, version 1, paused in first")
    assert machine.active == ("first",)
    program.step()
    wait_for(lambda: machine.active == ("second",), "it has gone there")
    with pytest.raises(ValueError, match="no state 'third'"):
        program.go_to("third")
    with pytest.raises(TypeError, match="go is not a state machine"):
        robot.program(function("go")).go_to("first")


def function(name: str) -> Any:
    def step() -> Drive:
        return Drive()

    step.__name__ = name
    return step


def test_a_program_that_was_closed_has_forgotten_its_state_and_can_only_be_run_by_its_cell(robot: Feed) -> None:
    def go(state):  # type: ignore[no-untyped-def]
        state.n = state.get("n", 0) + 1

    program = robot.program(go, rate=100)
    wait_for(lambda: program.state.get("n", 0) > 3, "it counts")
    program.close()
    assert program.state == {}
    for act in (program.restart, partial(program.go_to, "a")):
        with pytest.raises(RuntimeError, match="the program go has ended: run its cell again"):
            act()
    again = robot.program(go, rate=1)
    wait_for(lambda: again.state.get("n") == 1, "it counts from the beginning")


def test_a_simulation_is_reset_with_its_room_its_variables_and_its_program() -> None:
    with feeds.simulator(wander=False) as robot:
        robot.variables.slider("near", 0.5, 0.0, 1.0)

        @robot.program(rate=50)
        def go(state):  # type: ignore[no-untyped-def]
            state.n = state.get("n", 0) + 1
            return Drive(0, 0.5)

        world, pose = robot.robot.world, robot.robot.pose
        wait_for(lambda: robot.robot.pose != pose, "it turns")
        robot.variables.near = 0.9
        robot.robot.move_to(pose.x + 0.1, pose.y, 1.0)
        robot.robot.world = world.with_obstacles([])
        program = robot.programs.current
        assert program is not None
        go.pause()
        n = go.state.n
        wait_for(lambda: robot.robot.speed().angular[2] == 0, "it stands")
        robot.reset()
        assert robot.robot.world is world
        assert hypot(robot.robot.pose.x - pose.x, robot.robot.pose.y - pose.y) < 0.01
        assert robot.variables.near == 0.5
        wait_for(lambda: 0 < go.state.get("n", 0) <= n + 1, "the program counts from the beginning")


def test_the_way_begins_at_zero_when_a_simulation_is_reset() -> None:
    with feeds.simulator(wander=False) as robot:
        start = robot.robot.pose
        began: list[float] = []

        @robot.program(rate=50)
        def go(pose, driven, state):  # type: ignore[no-untyped-def]
            state.driven = driven
            if hypot(pose.x - start.x, pose.y - start.y) < 0.05:
                began.append(driven)
            return Drive(0.5)

        wait_for(lambda: go.state.get("driven", 0) > 0.3, "it drives")
        began.clear()
        robot.reset()
        wait_for(lambda: began, "it is at its start")
        assert max(began) < 0.1
