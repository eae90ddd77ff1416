"""Functions that are connected to topics: their arguments, and functions that sleep, hang or raise."""

from __future__ import annotations

import importlib
import re
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from robowidgets import LaserWidget, Scan, Speed, SpeedWidget, Touch
from robowidgets.feeds import Advert, Driving, Feed, FeedError

from ..waiting import Clock, wait_for
from .scripted import CMD_VEL, IMU, ODOM, SCAN, Scripted, scan, set_discovery_timeout, twist

BUMPER = Advert("/bumper", "kobuki_msgs/msg/BumperEvent")
Opened = Callable[..., tuple[Feed, Scripted]]


@pytest.fixture
def gate() -> Iterator[threading.Event]:
    """An event that hanging functions wait for; it is set at the end."""
    event = threading.Event()
    yield event
    event.set()


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Iterator[Opened]:
    """Opens feeds on a script, and closes them."""
    set_discovery_timeout(monkeypatch, 0.02)
    there: list[Feed] = []

    def open_one(*topics: Advert) -> tuple[Feed, Scripted]:
        script = Scripted(*topics)
        there.append(Feed(script))
        return there[-1], script

    yield open_one
    for feed in there:
        feed.close()


def source(widget: LaserWidget) -> dict[str, str]:
    return widget.get_state()["_source"]


def in_notebook(function: Any, name: str) -> Any:
    """A function as if a cell defined it."""
    function.__module__, function.__qualname__, function.__name__ = "__main__", name, name
    return function


def test_functions_get_samples_whatever_the_middleware_hands_over_and_messages_on_request(opened: Opened) -> None:
    feed, script = opened(SCAN, ODOM, BUMPER, IMU)
    got: list[Any] = []
    for topic in ("/scan", "/odom", "/bumper", "/imu"):
        feed.connect(topic, got.append)
    messages = {
        "/scan": scan(1.5),
        "/odom": twist(0.2),
        "/bumper": {"bumper": 0, "state": 1},
        "/imu": {"orientation": {"w": 1.0}},
    }
    for topic, message in messages.items():
        script.listener.on_message(topic, message)
    wait_for(lambda: len(got) == 4, "all are called")
    assert [type(sample) for sample in got] == [Scan, Speed, Touch, dict]
    raw: list[Any] = []
    feed.connect("/scan", raw.append, raw=True)
    script.listener.on_message("/scan", messages["/scan"])
    wait_for(lambda: raw == [messages["/scan"]], "it gets the message as it came")


def test_a_function_of_two_arguments_gets_the_time_at_which_a_message_of_any_type_came(opened: Opened) -> None:
    feed, script = opened(IMU, SCAN)
    got: list[tuple[Any, int]] = []

    def take(message: Any, time_ns: int) -> None:
        got.append((message, time_ns))

    feed.connect("/imu", take)
    feed.connect("/scan", lambda scan, time_ns, _near=0.3: got.append((scan, time_ns)))
    before = time.time_ns()
    script.listener.on_message("/imu", {"orientation": {"w": 1.0}})
    script.listener.on_message("/scan", scan(1.5))
    wait_for(lambda: len(got) == 2, "both are called")
    assert [type(message) for message, _ in got] == [dict, Scan]
    assert all(before <= time_ns <= time.time_ns() for _, time_ns in got)


def test_a_function_may_get_each_message_in_its_order(opened: Opened, gate: threading.Event) -> None:
    feed, script = opened(IMU)
    each: list[int] = []
    newest: list[int] = []
    entered = threading.Event()

    def slow(message: Any) -> None:
        each.append(message["number"])
        entered.set()
        gate.wait()

    feed.connect("/imu", slow, each=True)
    feed.connect("/imu", lambda message: newest.append(message["number"]))
    assert script.each == {"/imu"}
    for number in range(100):
        script.listener.on_message("/imu", {"number": number}, newest=number % 10 == 9, each=True)
    assert entered.wait(120)
    gate.set()
    wait_for(lambda: len(each) == 100 and newest[-1:] == [99], "all came")
    assert each == list(range(100))
    assert set(newest) <= {9, 19, 29, 39, 49, 59, 69, 79, 89, 99}
    assert "slow" in repr(feed)
    assert "did not get" not in repr(feed)
    feed.disconnect("/imu", slow)
    assert script.each == frozenset()


def test_what_a_function_that_gets_each_message_does_not_get_is_counted(opened: Opened, gate: threading.Event) -> None:
    feed, script = opened(IMU)
    entered = threading.Event()

    def slow(_message: Any) -> None:
        entered.set()
        gate.wait()

    feed.connect("/imu", slow, each=True)
    script.listener.on_message("/imu", {})
    assert entered.wait(120)
    for _ in range(1003):
        script.listener.on_message("/imu", {})
    script.listener.on_missed("/imu", 4)
    assert "slow` did not get 7 messages, which came too fast" in repr(feed)
    with pytest.raises(TypeError, match="each: expected True or False, got 'all'"):
        feed.connect("/imu", slow, each="all")  # type: ignore[arg-type]


def test_a_function_that_hangs_holds_back_no_speed_no_zero_and_no_widget(opened: Opened, gate: threading.Event) -> None:
    feed, script = opened(SCAN, CMD_VEL)
    laser, entered = LaserWidget(), threading.Event()

    def behave(_scan: Scan) -> None:
        feed.drive(0.3)
        entered.set()
        gate.wait()  # so that a wait for it would never end

    feed.connect("/scan", behave, laser)
    script.listener.on_message("/scan", scan(1.0))
    assert entered.wait(120)
    assert script.speeds == [(0.3, 0.0)]
    wait_for(lambda: script.speeds == [(0.3, 0.0), (0.0, 0.0)], "the hold ends by itself")
    feed.drive(0.1)
    feed.stop()
    assert script.speeds[-1] == (0.0, 0.0)
    script.listener.on_message("/scan", scan(2.0))
    assert laser.scan is not None
    assert laser.scan.ranges[0] == 2.0
    feed.close()


def test_a_widget_of_a_user_s_class_that_hangs_on_what_is_sent_holds_back_no_zero(
    opened: Opened, gate: threading.Event
) -> None:
    feed, script = opened(CMD_VEL)

    class Slow(SpeedWidget):
        def command(self, message: Any) -> None:
            gate.wait(120)
            super().command(message)

    speed, told = Slow(), []
    feed.connect("/cmd_vel", speed.command)
    feed.connect("/cmd_vel", told.append, raw=True)
    feed.drive(0.3)
    wait_for(lambda: script.speeds == [(0.3, 0.0), (0.0, 0.0)], "zero follows")
    gate.set()
    wait_for(lambda: speed.commanded is not None and speed.commanded.linear[0] == 0.0, "it shows what was sent last")
    assert told == [], "no other node sends messages"


def test_a_bump_and_turn_function_sends_each_of_its_speeds_while_it_sleeps(opened: Opened) -> None:
    feed, script = opened(BUMPER, CMD_VEL)
    feed.driving = Driving(hold=3600.0)

    def bump_and_turn(_touch: Touch) -> None:
        feed.drive(-0.2)
        time.sleep(0.1)
        feed.drive(0.0, 0.8)
        time.sleep(0.1)
        feed.drive(0.2)

    feed.connect("/bumper", bump_and_turn)
    script.listener.on_message("/bumper", {"bumper": 0, "state": 1})
    wait_for(lambda: script.speeds[:3] == [(-0.2, 0.0), (0.0, 0.8), (0.2, 0.0)], "each is sent")


def test_what_has_not_come_back_for_a_second_is_named_with_its_line_on_widget_and_feed(
    opened: Opened, gate: threading.Event
) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()

    def behave(_scan: Scan) -> None:
        gate.wait(120)

    in_notebook(behave, "behave")
    line = behave.__code__.co_firstlineno + 1
    feed.connect("/scan", behave, laser)
    script.listener.on_message("/scan", scan())
    words = f"your function `behave`, line {line}, has not returned for"
    wait_for(lambda: source(laser)["error"].startswith(f"{words} 2 s"), "the widget counts the seconds")
    assert words in repr(feed)
    assert words in feed.connection.status_of("/scan")
    gate.set()
    wait_for(lambda: source(laser)["error"] == "", "it came back")


def test_of_a_scanner_the_newest_waits_for_a_slow_function_of_a_bumper_every_message(
    opened: Opened, gate: threading.Event
) -> None:
    feed, script = opened(SCAN, BUMPER)
    got: list[Any] = []

    def slow(sample: Any) -> None:
        gate.wait(120)
        got.append(sample)

    feed.connect("/scan", slow)
    feed.connect("/bumper", slow)
    for i in range(1, 6):
        script.listener.on_message("/scan", scan(float(i)))
        script.listener.on_message("/bumper", {"bumper": i % 3, "state": 1})
    gate.set()
    wait_for(lambda: len([s for s in got if isinstance(s, Touch)]) == 5, "every bump is handed on")
    scans = [sample.ranges[0] for sample in got if isinstance(sample, Scan)]
    assert len(scans) <= 2
    assert scans[-1] == 5.0


def test_the_log_has_the_traceback_of_a_function_that_raises_without_our_frames(
    opened: Opened, caplog: pytest.LogCaptureFixture
) -> None:
    def look(scan: Scan) -> None:
        raise RuntimeError(f"{len(scan)} rays")

    feed, script = opened(SCAN)
    feed.connect("/scan", look)
    script.listener.on_message("/scan", scan())
    wait_for(lambda: "Traceback" in caplog.text, "the error is logged with its traceback")
    assert re.findall(r'File "(.+)", line', caplog.text) == [__file__]


@pytest.mark.parametrize("error", [ZeroDivisionError, SystemExit])
def test_an_error_names_the_function_and_its_line_and_is_reported_until_it_comes_back_well(
    opened: Opened, caplog: pytest.LogCaptureFixture, error: type[BaseException]
) -> None:
    feed, script = opened(SCAN)
    laser, runs = LaserWidget(), []

    def behave(_scan: Scan) -> None:
        runs.append(1)
        if len(runs) < 4:
            raise error("no room")

    in_notebook(behave, "behave")
    feed.connect("/scan", behave, laser)
    words = f"your function `behave`, line {behave.__code__.co_firstlineno + 3}: {error.__name__}: no room"
    for i in range(3):
        script.listener.on_message("/scan", scan())
        wait_for(lambda i=i: len(runs) == i + 1, "it is called")  # type: ignore[misc]
    wait_for(lambda: source(laser)["error"] == words, "the widget says so")
    assert laser.scan is not None
    assert [record.message for record in caplog.records] == [words]
    head, row = repr(feed).splitlines()[-2:]
    assert head.split() == ["function", "topic", "runs", "last", "error"]
    assert row.split(maxsplit=3) == ["behave", "/scan", "3", words]
    script.listener.on_message("/scan", scan())
    wait_for(lambda: source(laser)["error"] == "", "all is well again")


def test_a_function_of_the_same_name_in_the_notebook_takes_the_place_of_the_one_before(opened: Opened) -> None:
    feed, script = opened(SCAN, CMD_VEL)
    got: list[str] = []
    feed.connect("/scan", in_notebook(lambda _: got.append("first"), "behave"))
    feed.connect("/scan", in_notebook(lambda _: got.append("second"), "behave"))
    feed.connect("/scan", in_notebook(lambda _: got.append("other"), "other"))
    script.listener.on_message("/scan", scan())
    wait_for(lambda: got == ["second", "other"], "the newest is called")
    assert [function.name for function in feed.functions] == ["behave", "other"]


def test_a_function_of_a_module_that_is_loaded_again_takes_the_place_of_the_one_before(
    opened: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = opened(SCAN, CMD_VEL)
    file = tmp_path / "mine_to_reload.py"
    file.write_text("got = []\ndef behave(scan): got.append('first')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    module = importlib.import_module(file.stem)
    feed.connect("/scan", module.behave)
    file.write_text("got = []\ndef behave(scan): got.append('second version')\n")
    importlib.reload(module)
    feed.connect("/scan", module.behave)
    script.listener.on_message("/scan", scan())
    wait_for(lambda: module.got == ["second version"], "only the newest is called")
    assert len(feed.functions) == 1
    feed.disconnect("/scan", module.behave)
    assert feed.functions == ()


def test_no_observer_of_a_widget_runs_in_the_thread_that_carries_speeds(opened: Opened) -> None:
    feed, script = opened(SCAN, CMD_VEL)
    laser, speed, names = LaserWidget(), SpeedWidget(), []
    for widget in (laser, speed):
        widget.observe(lambda change: names.append(change["name"]))
    feed.connect("/scan", laser)
    feed.connect("/cmd_vel", speed.command)
    names.clear()
    feed.drive(0.1)
    script.listener.on_message("/scan", scan())
    script.lose()
    assert "lost" in source(laser)["status"]
    assert names == []


def test_a_cell_that_is_run_again_replaces_all_that_it_connected(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = opened(SCAN, ODOM)
    cell = ["cell", "run 1"]
    monkeypatch.setattr("robowidgets.feeds._callbacks.running_cell", lambda: tuple(cell))
    got: list[str] = []
    feed.connect("/scan", lambda _: got.append("one"), lambda _: got.append("two"))
    feed.connect("/odom", lambda _: got.append("odom"))
    cell[1] = "run 2"
    feed.connect("/scan", lambda _: got.append("three"), lambda _: got.append("four"))
    script.listener.on_message("/odom", twist(0.1))
    script.listener.on_message("/scan", scan())
    wait_for(lambda: got == ["three", "four"], "functions of the newest run are called")
    assert script.asked[-1] == ("unsubscribe", "/odom")


def test_what_a_cell_connects_again_when_it_is_run_again_stays_connected(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = opened(SCAN)
    cell = ["cell", "run 1"]
    monkeypatch.setattr("robowidgets.feeds._callbacks.running_cell", lambda: tuple(cell))
    got: list[float] = []

    class Mine(LaserWidget):
        def update(self, message: Any) -> None:
            super().update(message)
            got.append(1.0)

    laser = Mine()
    for run in ("run 1", "run 2"):
        cell[1] = run
        feed.connect("/scan", laser)
        feed.connect("/scan", lambda _: got.append(2.0))
    script.listener.on_message("/scan", scan())
    wait_for(lambda: got == [1.0, 2.0], "both are called")


def test_a_function_that_was_replaced_while_it_hung_drives_no_more_and_the_next_version_runs(
    opened: Opened, gate: threading.Event
) -> None:
    feed, script = opened(SCAN, CMD_VEL)
    entered, ended = threading.Event(), threading.Event()
    refused: list[str] = []

    def old(_scan: Scan) -> None:
        entered.set()
        gate.wait(120)
        try:
            feed.drive(0.5)
        except FeedError as error:
            refused.append(str(error))
        ended.set()

    feed.connect("/scan", in_notebook(old, "behave"))
    script.listener.on_message("/scan", scan())
    assert entered.wait(120)
    feed.connect("/scan", in_notebook(lambda _: feed.drive(0.1), "behave"))
    script.listener.on_message("/scan", scan())
    wait_for(lambda: script.speeds == [(0.1, 0.0)], "the next version drives")
    gate.set()
    assert ended.wait(120)
    assert refused == ["cannot drive: this function was disconnected, replaced or ended while it was at work"]
    assert (0.5, 0.0) not in script.speeds


def test_a_feed_that_was_reopened_says_which_functions_of_other_cells_it_dropped(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    cell = ["feed", "run 1"]
    for module in ("notebook.cells", "feeds._callbacks", "feeds._connection"):
        monkeypatch.setattr(f"robowidgets.{module}.running_cell", lambda: tuple(cell))
    monkeypatch.setattr("robowidgets.notebook.cells._made", {})
    first = Feed(Scripted(SCAN))
    first.connect("/scan", in_notebook(lambda _: None, "of_the_same_cell"))
    cell[:] = "behavior", "run 2"
    first.connect("/scan", in_notebook(lambda _: None, "behave"))
    cell[:] = "feed", "run 3"
    with Feed(Scripted(SCAN)):
        words = "the feed was opened again; no longer connected: `behave` (/scan). Run their cells again"
        assert [record.message for record in caplog.records] == [words]
        assert first.connection.is_closed


def test_the_age_of_a_sample_counts_while_it_waits_for_a_function(opened: Opened, gate: threading.Event) -> None:
    feed, script = opened(SCAN)
    ages: list[float] = []

    def behave(scan: Scan) -> None:
        gate.wait(120)
        ages.append(scan.age)

    feed.connect("/scan", behave)
    script.listener.on_message("/scan", scan(1.0))
    wait_for(lambda: feed.connection.functions.functions[0].entered, "it runs")
    script.listener.on_message("/scan", scan(2.0))
    waits = Speed((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    wait_for(lambda: waits.age > 0.1, "it has waited")
    gate.set()
    wait_for(lambda: len(ages) == 2, "it got both")
    assert ages[1] >= 0.1


class TestScans:
    @pytest.fixture(autouse=True)
    def clock(self, monkeypatch: pytest.MonkeyPatch) -> Clock:
        """The clock by which scans come and grow old. Waits for scans that do not come take real time."""
        made = Clock()
        for module in ("widget.newest_sample", "samples.age"):
            monkeypatch.setattr(f"robowidgets.{module}.time", made)
        monkeypatch.setattr("robowidgets.feeds._scan_iterator.FIRST_TIMEOUT", 240.0)
        return made

    def test_a_loop_gets_each_scan_once_and_the_newest(self, opened: Opened) -> None:
        feed, script = opened(SCAN)
        scans = feed.scans("/scan", timeout=0.2)
        got = []
        sender = threading.Timer(0.05, lambda: script.listener.on_message("/scan", scan(1.0)))
        sender.start()
        got.append(next(scans).ranges[0])
        script.listener.on_message("/scan", scan(2.0))
        script.listener.on_message("/scan", scan(3.0))
        got.append(next(scans).ranges[0])
        assert got == [1.0, 3.0]
        with pytest.raises(TimeoutError, match=r"^no scan of /scan for 0\.2 s$"):
            next(scans)
        assert script.asked == [("subscribe", "/scan"), ("unsubscribe", "/scan")]

    def test_a_scan_that_came_long_before_the_loop_asks_is_not_handed_out(self, opened: Opened, clock: Clock) -> None:
        feed, script = opened(SCAN)
        patient, hasty = feed.scans("/scan", timeout=240), feed.scans("/scan", timeout=0.2)
        for scans in (patient, hasty):
            sender = threading.Timer(0.05, lambda: script.listener.on_message("/scan", scan(1.0)))
            sender.start()
            next(scans)
        script.listener.on_message("/scan", scan(2.0))
        clock.now += 0.25  # in the body of the loop
        second = next(patient)
        assert (second.ranges[0], second.age) == (2.0, 0.25)
        with pytest.raises(TimeoutError, match=r"^no scan of /scan for 0\.2 s$"):
            next(hasty)

    def test_if_none_ever_came_the_error_has_the_reason(self, opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robowidgets.feeds._scan_iterator.FIRST_TIMEOUT", 0.1)
        feed, _ = opened(SCAN)
        with pytest.raises(TimeoutError, match=r"no scan of /scna for 0.1 s: no such topic /scna; there are /scan"):
            next(feed.scans("/scna", timeout=0.1))

    @pytest.mark.parametrize("how", ["scans", "wait"])
    def test_a_missing_topic_is_reported_while_it_is_awaited_and_may_come_late(
        self, opened: Opened, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, how: str
    ) -> None:
        set_discovery_timeout(monkeypatch, 0.02)
        monkeypatch.setattr("robowidgets.widget.robot_widget.PATIENCE", 0.02)
        feed, script = opened(SCAN, ODOM)
        laser, got = LaserWidget(), []
        feed.connect("/scna", laser)
        loop = {"scans": lambda: next(feed.scans("/scna")), "wait": lambda: laser.wait(240.0)}[how]
        thread = threading.Thread(target=lambda: got.append(loop()))
        thread.start()
        wait_for(lambda: caplog.records, "it is reported")
        assert thread.is_alive()
        (record,) = caplog.records
        assert "no such topic /scna; there are /scan, /odom; did you mean /scan?; waiting for " in record.message
        script.listener.on_topics([SCAN, ODOM, SCAN._replace(name="/scna")])
        script.listener.on_message("/scna", scan(1.0))
        thread.join()
        assert got[0].ranges[0] == 1.0
        assert len(caplog.records) == 1

    def test_a_feed_that_is_closed_ends_the_wait(self, opened: Opened) -> None:
        feed, _ = opened(SCAN)
        closer = threading.Timer(0.05, feed.close)
        closer.start()
        with pytest.raises(TimeoutError, match="the feed is closed"):
            next(feed.scans("/scan"))
        with pytest.raises(FeedError, match="is closed: open it again"):
            feed.scans("/scan")

    def test_a_function_that_hangs_does_not_hold_it_up(self, opened: Opened, gate: threading.Event) -> None:
        feed, script = opened(SCAN)
        feed.connect("/scan", lambda _: gate.wait(120))
        scans = feed.scans("/scan")
        sender = threading.Timer(0.05, lambda: script.listener.on_message("/scan", scan(1.0)))
        sender.start()
        assert next(scans).ranges[0] == 1.0

    @pytest.mark.parametrize("bad", [0, -1.0, float("nan")])
    def test_a_timeout_must_make_sense(self, opened: Opened, bad: float) -> None:
        feed, _ = opened(SCAN)
        with pytest.raises(ValueError, match="timeout"):
            feed.scans("/scan", timeout=bad)
