"""`CommandWatchdog`: at most 50 speeds per second, zero when none holds, a latch, and a hand before programs."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from itertools import pairwise

import pytest

from robowidgets.driving.command_watchdog import (
    ASSISTANT,
    HOLD,
    INTERVAL,
    PROGRAM,
    SETTLE,
    ZERO,
    CommandWatchdog,
    RefusedError,
    Velocity,
)
from robowidgets.driving.stop_all import running, stop_all, stop_driven_by_cell

from ..clocks import ManualClock
from ..waiting import wait_for

FORWARD = Velocity(0.3)
LEFT = Velocity(angular=0.5)


class Sink:
    """Takes the speeds of a test; it hangs while its gate is shut, and raises the error that a test sets."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self.now = now
        self.got: list[tuple[float, Velocity]] = []
        self.error: BaseException | None = None
        self.gate = threading.Event()
        self.gate.set()

    def __call__(self, *speeds: float) -> None:
        self.got.append((self.now(), Velocity(*speeds)))
        self.gate.wait(120)
        if self.error is not None:
            raise self.error

    @property
    def speeds(self) -> list[Velocity]:
        return [velocity for _, velocity in self.got]


@pytest.fixture
def sink() -> Sink:
    return Sink()


@pytest.fixture
def watchdog(sink: Sink) -> Iterator[CommandWatchdog]:
    made = CommandWatchdog(sink, not_sent=OSError)
    yield made
    sink.error = None
    sink.gate.set()
    made.close()
    wait_for(lambda: threads() == [], "its thread ends")


def threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "robowidgets-drive"]


def drive(watchdog: CommandWatchdog, velocity: Velocity, driver: str = PROGRAM) -> None:
    watchdog.sent_in_time(watchdog.drive(velocity, hold=60.0, driver=driver))


def test_a_loop_without_a_pause_sends_at_most_50_speeds_a_second_the_newest_last(
    watchdog: CommandWatchdog, sink: Sink
) -> None:
    began, count = time.monotonic(), 0
    while time.monotonic() < began + 0.5 or count <= 100:
        count += 1
        watchdog.drive(Velocity(0.1, count))
    watchdog.sent_in_time(watchdog.stop())
    passed = time.monotonic() - began
    assert len([velocity for velocity in sink.speeds if velocity.linear]) <= passed / INTERVAL + 2
    assert sink.speeds[-1] == ZERO
    watchdog.drive(FORWARD, hold=60.0)
    watchdog.drive(LEFT, hold=60.0)
    wait_for(lambda: sink.speeds[-1] == LEFT, "the newest is sent")


def test_zero_goes_out_at_once_but_not_again_and_again(watchdog: CommandWatchdog, sink: Sink) -> None:
    drive(watchdog, FORWARD)
    began = time.monotonic()
    requests = [watchdog.stop() for _ in range(1000)]
    watchdog.sent_in_time(requests[-1])
    passed = time.monotonic() - began
    assert sink.speeds[1] == ZERO
    assert len(sink.got) <= 3 + passed / INTERVAL
    assert all(request.done for request in requests)


def test_what_a_slow_sink_kept_waiting_too_long_is_not_sent(watchdog: CommandWatchdog, sink: Sink) -> None:
    sink.gate.clear()
    first = watchdog.drive(FORWARD, hold=60.0)
    wait_for(lambda: sink.got, "the sink is at work")
    late = watchdog.drive(LEFT, hold=0.05)
    time.sleep(0.06)
    sink.gate.set()
    watchdog.sent_in_time(first)
    with pytest.raises(TimeoutError, match="sending the speed before took longer than this one holds"):
        watchdog.sent_in_time(late)
    wait_for(lambda: sink.speeds == [FORWARD, ZERO], "zero follows")


def test_a_speed_that_a_stop_replaces_while_it_is_sent_is_not_an_error(watchdog: CommandWatchdog, sink: Sink) -> None:
    sink.gate.clear()
    sink.error = OSError("the speed came too late")
    speed = watchdog.drive(FORWARD, hold=60.0)
    wait_for(lambda: sink.got, "the sink is at work")
    zero = watchdog.stop()
    seen: list[BaseException | None] = []
    watchdog.observe(lambda: seen.append(watchdog.error))
    watchdog.observe(lambda: setattr(sink, "error", None))  # the zero reaches the robot
    sink.gate.set()
    watchdog.sent_in_time(speed, 120.0)
    watchdog.sent_in_time(zero, 120.0)
    wait_for(lambda: len(seen) == 2, "observers know of both")
    assert (seen, watchdog.sent) == ([None, None], ZERO)


def test_a_hanging_sink_is_reported_to_waiting_callers_and_blocks_none_for_ever(
    watchdog: CommandWatchdog, sink: Sink
) -> None:
    sink.gate.clear()
    watchdog.drive(FORWARD, hold=60.0)
    wait_for(lambda: sink.got, "the sink is at work")
    with pytest.raises(TimeoutError, match=r"the function that sends speeds has not returned for \d+\.\d s"):
        watchdog.sent_in_time(watchdog.stop(), 0.2)
    assert watchdog.busy_for > 0.1
    with pytest.raises(TimeoutError):
        watchdog.close(0.1)
    sink.gate.set()
    wait_for(lambda: sink.speeds == [FORWARD, ZERO], "zero is sent all the same")


def test_zero_is_sent_again_until_the_sink_takes_it(
    watchdog: CommandWatchdog, sink: Sink, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("robowidgets.driving.command_watchdog.RETRY", 0.02)
    drive(watchdog, FORWARD)
    sink.error = OSError("the wire is cut")
    with pytest.raises(OSError, match="the wire is cut"):
        watchdog.sent_in_time(watchdog.stop())
    sink.error = OSError("the wire is cut, for longer now")
    wait_for(lambda: len(sink.got) > 4, "it is tried again")
    assert watchdog.owes_zero
    sink.error = None
    wait_for(lambda: not watchdog.owes_zero, "it is sent")
    text = "sending zero to the robot failed: the wire is cut"
    wait_for(lambda: [record.message for record in caplog.records] == [text], "it is logged, once")


def test_zero_is_sent_again_also_where_the_log_hangs(
    watchdog: CommandWatchdog, sink: Sink, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.driving.command_watchdog.RETRY", 0.02)
    gate = threading.Event()
    monkeypatch.setattr("robowidgets.runtime.log_once.log.error", lambda *_, **__: gate.wait(120))
    drive(watchdog, FORWARD)
    sink.error = OSError("the wire is cut")
    watchdog.stop()
    wait_for(lambda: len(sink.got) > 4, "it is tried again")
    sink.error = None
    wait_for(lambda: not watchdog.owes_zero, "it is sent")
    gate.set()


def test_zero_is_sent_again_also_at_the_end_of_a_process_that_starts_no_thread(
    watchdog: CommandWatchdog, sink: Sink, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("robowidgets.driving.command_watchdog.RETRY", 0.02)
    drive(watchdog, FORWARD)
    sink.error = OSError("the wire is cut")

    def refuse(_thread: threading.Thread) -> None:
        raise RuntimeError("can't create new thread at interpreter shutdown")

    monkeypatch.setattr(threading.Thread, "start", refuse)
    with pytest.raises(OSError, match="the wire is cut"):
        watchdog.sent_in_time(watchdog.stop())
    sink.error = None
    wait_for(lambda: not watchdog.owes_zero, "it is sent again")
    assert [record.message for record in caplog.records] == ["sending zero to the robot failed: the wire is cut"]


def test_zeros_that_follow_each_other_are_sent_by_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robowidgets.driving.command_watchdog.LINGER", 60.0)
    threads: list[threading.Thread] = []
    watchdog = CommandWatchdog(lambda *_: threads.append(threading.current_thread()))
    for _ in range(3):
        watchdog.sent_in_time(watchdog.drive(ZERO))
    assert len(threads) == 3
    assert len({*threads}) == 1
    watchdog.close()
    wait_for(lambda: not threads[0].is_alive(), "it ends when it is closed")


def test_a_speed_that_waits_for_its_turn_owes_a_zero(
    watchdog: CommandWatchdog, sink: Sink, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.driving.command_watchdog.INTERVAL", 1.0)
    drive(watchdog, FORWARD)
    watchdog.sent_in_time(watchdog.stop())
    watchdog.drive(LEFT, hold=60.0)
    assert watchdog.owes_zero
    stop_all()
    assert LEFT not in sink.speeds


@pytest.mark.parametrize("error", [ValueError("no"), SystemExit("no")])
def test_after_an_error_at_a_speed_zero_is_due_at_once(
    watchdog: CommandWatchdog, sink: Sink, error: BaseException
) -> None:
    sink.error = error
    with pytest.raises(type(error)):
        drive(watchdog, FORWARD)
    sink.error = None
    wait_for(lambda: sink.speeds[:2] == [FORWARD, ZERO], "zero is sent")


def test_a_speed_known_as_unsent_needs_no_zero(watchdog: CommandWatchdog, sink: Sink) -> None:
    sink.error = OSError("no route")
    with pytest.raises(OSError, match="no route"):
        drive(watchdog, FORWARD)
    assert not watchdog.owes_zero
    assert sink.speeds == [FORWARD]


def test_a_latched_stop_sends_zero_and_refuses_all_until_it_is_released(watchdog: CommandWatchdog, sink: Sink) -> None:
    drive(watchdog, FORWARD)
    watchdog.stopped = True
    for refused in (lambda: watchdog.drive(FORWARD), lambda: watchdog.take("hand")):
        with pytest.raises(RefusedError, match="Stop is pressed: press Allow driving"):
            refused()
    watchdog.sent_in_time(watchdog.drive(ZERO))
    assert set(sink.speeds[1:]) == {ZERO}
    watchdog.stopped = False
    drive(watchdog, LEFT)
    wait_for(lambda: sink.speeds[-1] == LEFT, "it is sent")


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def timed(user_limits: None, clock: ManualClock) -> Iterator[tuple[CommandWatchdog, Sink]]:
    """A watchdog and its sink by a clock that the test moves."""
    sink = Sink(clock.now)
    made = CommandWatchdog(sink, not_sent=OSError, clock=clock)
    yield made, sink
    made.close()
    clock.advance(1.0)


def test_while_a_hand_drives_a_program_is_refused_but_for_stop(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    drive(watchdog, FORWARD)
    assert watchdog.driver == PROGRAM
    watchdog.take("hand")
    clock.advance(INTERVAL)
    assert sink.speeds == [FORWARD, ZERO]
    drive(watchdog, LEFT, "hand")
    clock.advance(INTERVAL)
    for refused in (FORWARD, ZERO):
        with pytest.raises(RefusedError, match="a hand drives from a pad"):
            watchdog.drive(refused)
    assert watchdog.driver == "hand"
    assert sink.speeds[-1] == LEFT
    watchdog.sent_in_time(watchdog.stop())
    drive(watchdog, LEFT, "hand")
    clock.advance(INTERVAL)
    watchdog.let_go("hand")
    clock.advance(INTERVAL)
    assert sink.speeds[-3:] == [ZERO, LEFT, ZERO]
    with pytest.raises(RefusedError, match="the press on the pad is over"):
        watchdog.drive(LEFT, driver="hand")
    drive(watchdog, FORWARD)


def test_the_newest_hand_drives(timed: tuple[CommandWatchdog, Sink]) -> None:
    watchdog, _ = timed
    watchdog.take("one")
    watchdog.take("other")
    with pytest.raises(RefusedError):
        watchdog.drive(LEFT, driver="one")
    watchdog.let_go("one")
    assert watchdog.driver == "other"


def test_a_hand_that_is_not_renewed_lets_programs_drive_again(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    watchdog.take("hand")
    drive(watchdog, LEFT, "hand")
    clock.advance(HOLD - 0.001)
    assert sink.got == [(1000.0, LEFT)]
    clock.advance(0.001)
    assert sink.got == [(1000.0, LEFT), (1000.0 + HOLD, ZERO)]
    drive(watchdog, FORWARD)


def test_a_speed_of_a_hand_holds_for_half_a_second_at_most_because_its_page_may_be_gone(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    watchdog.take("hand")
    watchdog.sent_in_time(watchdog.drive(FORWARD, hold=60.0, driver="hand"))
    clock.advance(HOLD)
    assert sink.got == [(1000.0, FORWARD), (1000.0 + HOLD, ZERO)]
    assert watchdog.driver == ""


def test_by_hand_a_loop_sends_at_most_50_speeds_a_second_the_newest_last(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    for count in range(500):
        watchdog.drive(Velocity(0.1, count))
        clock.advance(0.001)
    watchdog.sent_in_time(watchdog.stop())
    moves = [at for at, velocity in sink.got if velocity.linear]
    assert len(moves) == 0.5 / INTERVAL
    assert all(later - before == pytest.approx(INTERVAL) for before, later in pairwise(moves))
    assert sink.speeds[-1] == ZERO


def test_by_hand_what_a_slow_sink_kept_waiting_too_long_is_not_sent(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    sink.gate.clear()
    first = watchdog.drive(FORWARD, hold=0.05)
    wait_for(lambda: sink.got, "the sink is at work")
    late = watchdog.drive(LEFT, hold=0.05)
    clock.advance(0.05, hangs=("robowidgets-drive",))
    sink.gate.set()
    watchdog.sent_in_time(first)
    with pytest.raises(TimeoutError, match="sending the speed before took longer than this one holds"):
        watchdog.sent_in_time(late)
    clock.settle()
    assert sink.speeds == [FORWARD, ZERO]


def stand(clock: ManualClock, how: str) -> None:
    """Pause the process for longer than a speed may hold; waiting threads have not noticed yet."""
    clock.settle()
    if how == "sleep":
        clock.asleep += HOLD + 0.1
    else:
        clock.jump(HOLD + 0.1)


@pytest.mark.parametrize("how", ["pause", "sleep"])
@pytest.mark.parametrize("first", ["the thread", "a caller"])
def test_after_a_standstill_zero_is_sent_and_no_speed_for_a_while(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink], how: str, first: str
) -> None:
    watchdog, sink = timed
    watchdog.drive(FORWARD, hold=60.0)
    clock.advance(1.0)
    stand(clock, how)
    if first == "the thread":
        clock.advance(0.2)
    for _ in range(2):
        with pytest.raises(RefusedError, match=r"stood still for 0\.7 s|the computer has slept") as refused:
            watchdog.drive(FORWARD, hold=60.0)
        assert str(refused.value).endswith("the speed may be based on data from before that; drive again in 2 s")
        clock.advance(0.2)
        assert sink.speeds == [FORWARD, ZERO]
    assert watchdog.standstills == 1
    clock.advance(SETTLE)
    watchdog.drive(LEFT)
    clock.settle()
    assert sink.speeds == [FORWARD, ZERO, LEFT]


def test_a_speed_that_was_requested_before_a_standstill_is_not_sent_after_it(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    watchdog.drive(FORWARD, hold=60.0)
    clock.settle()
    with watchdog._lock:  # its thread cannot send meanwhile
        waiting = watchdog.drive(LEFT, hold=60.0)
        clock.jump(3.0)
        stops = watchdog.stops
    clock.advance(0.1)
    assert waiting.done
    assert sink.speeds == [FORWARD, ZERO]
    assert watchdog.stops > stops, "a waiting caller with a speed is refused"


def test_a_press_is_over_after_a_standstill(clock: ManualClock, timed: tuple[CommandWatchdog, Sink]) -> None:
    watchdog, sink = timed
    watchdog.take("pad")
    watchdog.drive(FORWARD, driver="pad")
    clock.advance(0.1)
    stand(clock, "pause")
    clock.advance(SETTLE + 0.2)
    with pytest.raises(RefusedError, match="the press on the pad is over"):
        watchdog.drive(FORWARD, driver="pad")
    assert sink.speeds == [FORWARD, ZERO]


@pytest.mark.parametrize("moves", [True, False])
def test_neither_a_slow_sink_nor_a_pause_at_rest_is_a_standstill(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink], moves: bool
) -> None:
    watchdog, sink = timed
    if moves:
        sink.gate.clear()
        watchdog.drive(FORWARD, hold=60.0)
        wait_for(lambda: sink.got, "the sink is called")
        clock.advance(3.0, hangs=("robowidgets-drive",))
        sink.gate.set()
    else:
        watchdog.stop()
        stand(clock, "pause")
    clock.settle()
    watchdog.drive(LEFT, hold=60.0)
    clock.advance(INTERVAL)
    assert (watchdog.standstills, sink.speeds[-1]) == (0, LEFT)


def test_a_latch_is_released_by_its_owner_and_each_by_the_user(watchdog: CommandWatchdog, sink: Sink) -> None:
    one, other = object(), object()
    for owner in (one, other):
        watchdog.latch(owner)
    watchdog.stopped = True
    watchdog.release(one)
    watchdog.release(other)
    with pytest.raises(RefusedError, match="Stop is pressed"):
        watchdog.drive(FORWARD)
    watchdog.latch(one)
    watchdog.stopped = False
    drive(watchdog, FORWARD)
    assert sink.speeds[-1] == FORWARD


def test_an_interrupt_while_its_thread_starts_stops_it_and_starts_no_second_one(
    watchdog: CommandWatchdog, sink: Sink, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = threading.Thread.start

    def interrupted(thread: threading.Thread) -> None:
        monkeypatch.undo()
        start(thread)
        watchdog.stop()
        raise KeyboardInterrupt

    monkeypatch.setattr(threading.Thread, "start", interrupted)
    with pytest.raises(KeyboardInterrupt):
        watchdog.drive(FORWARD, hold=60.0)
    wait_for(lambda: sink.speeds == [ZERO], "zero is sent, and no speed")
    assert len(threads()) == 1


def test_observers_get_every_change_and_none_of_them_prevents_zero(watchdog: CommandWatchdog, sink: Sink) -> None:
    told: list[tuple[float, float]] = []

    def fail() -> None:
        told.append(watchdog.sent)
        raise RuntimeError("no room")

    watchdog.observe(fail)
    drive(watchdog, FORWARD)
    wait_for(lambda: told == [FORWARD], "it is reported")
    watchdog.stop()
    wait_for(lambda: told == [FORWARD, ZERO], "both are reported")
    watchdog.unobserve(fail)
    drive(watchdog, FORWARD)
    watchdog.sent_in_time(watchdog.stop())
    assert len(told) == 2


def test_at_the_end_zero_goes_to_all_at_once_though_one_of_them_hangs(watchdog: CommandWatchdog, sink: Sink) -> None:
    hanging = Sink()
    other = CommandWatchdog(hanging)
    drive(watchdog, FORWARD)
    drive(other, FORWARD)
    hanging.gate.clear()
    other.drive(LEFT)
    wait_for(lambda: hanging.speeds[-1] == LEFT, "one hangs")
    stop_all(0.1)
    assert sink.speeds == [FORWARD, ZERO]
    hanging.gate.set()
    wait_for(lambda: hanging.speeds[-1] == ZERO, "the other is notified when it comes back")


def test_a_failed_cell_stops_its_robot_while_others_begin_and_end(monkeypatch: pytest.MonkeyPatch) -> None:
    others, ended = [CommandWatchdog(Sink()) for _ in range(50)], threading.Event()

    def begin_and_end() -> None:
        while not ended.is_set():
            for change in (running.add, running.discard):
                for other in others:
                    change(other)

    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    thread = threading.Thread(target=begin_and_end)
    thread.start()
    try:
        for _ in range(3000):
            stop_driven_by_cell()
    finally:
        ended.set()
        thread.join()
        sys.setswitchinterval(before)


@pytest.mark.slow
def test_the_end_of_the_process_sends_zero(tmp_path: object) -> None:
    program = (
        "import sys\n"
        "from robowidgets.driving.command_watchdog import CommandWatchdog, Velocity\n"
        "watchdog = CommandWatchdog(lambda linear, *_: (sys.stdout.write(f'{linear}\\n'), sys.stdout.flush()))\n"
        "watchdog.sent_in_time(watchdog.drive(Velocity(0.3), hold=60.0))\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout.split(), ended.stderr) == (0, ["0.3", "0.0"], "")


def test_the_speed_of_an_assistant_ends_with_its_lease_however_often_it_is_renewed(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    lease = watchdog.lend(1.0, watchdog.stops)
    for _ in range(5):
        watchdog.drive(FORWARD, driver=ASSISTANT, lease=lease)
        assert (watchdog.driver, watchdog.lease_left > 0) == (ASSISTANT, True)
        clock.advance(0.2)
    assert (sink.speeds[-1], sink.got[-1][0]) == (ZERO, lease.ends)
    assert (watchdog.driver, watchdog.lease_left) == ("", 0.0)
    with pytest.raises(RefusedError, match="the lease has ended"):
        watchdog.drive(FORWARD, driver=ASSISTANT, lease=lease)


@pytest.mark.parametrize(
    ("act", "why"),
    [
        (lambda watchdog: watchdog.stop(), "another call or Stop has stopped the robot"),
        (lambda watchdog: watchdog.take("hand"), "a hand drives from a pad"),
        (lambda watchdog: (watchdog.take("hand"), watchdog.let_go("hand")), "the lease has ended"),
        (lambda watchdog: setattr(watchdog, "stopped", True), "Stop is pressed"),
        (
            lambda watchdog: (setattr(watchdog, "stopped", True), setattr(watchdog, "stopped", False)),
            "the lease has ended",
        ),
        (lambda watchdog: watchdog.drive(LEFT), "the lease has ended"),
        (lambda watchdog: watchdog.drive(ZERO), "another call or Stop has stopped the robot"),
        (lambda watchdog: watchdog.lend(9.0, watchdog.stops), "the lease has ended"),
    ],
    ids=["stop", "hand", "hand let go", "latch", "latch released", "program", "zero of a program", "next command"],
)
def test_whatever_a_person_does_ends_the_lease_of_an_assistant(
    act: Callable[[CommandWatchdog], object], why: str, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, _ = timed
    lease = watchdog.lend(60.0, watchdog.stops)
    watchdog.sent_in_time(watchdog.drive(FORWARD, driver=ASSISTANT, lease=lease))
    act(watchdog)
    with pytest.raises(RefusedError, match=why):
        watchdog.drive(FORWARD, driver=ASSISTANT, lease=lease)


def test_an_assistant_cannot_take_over_from_a_program(timed: tuple[CommandWatchdog, Sink]) -> None:
    watchdog, _ = timed
    drive(watchdog, FORWARD)
    with pytest.raises(RefusedError, match="a program drives"):
        watchdog.drive(LEFT, driver=ASSISTANT, lease=watchdog.lend(5.0, watchdog.stops))
    assert watchdog.driver == PROGRAM


def test_the_end_of_a_lease_sends_zero_and_that_of_an_earlier_one_does_nothing(
    clock: ManualClock, timed: tuple[CommandWatchdog, Sink]
) -> None:
    watchdog, sink = timed
    before, lease = (watchdog.lend(60.0, watchdog.stops) for _ in range(2))
    watchdog.drive(FORWARD, 60.0, driver=ASSISTANT, lease=lease)
    clock.advance(INTERVAL)
    assert not watchdog.end_lease(before)
    assert sink.speeds == [FORWARD]
    assert watchdog.end_lease(lease)
    clock.advance(INTERVAL)
    assert sink.speeds == [FORWARD, ZERO]
