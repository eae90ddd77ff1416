"""The pacer sends the newest of each sender, within one budget for all, and never makes a caller wait."""

from __future__ import annotations

import gc
import logging
import os
import select
import sys
import threading
import time
import weakref
from types import SimpleNamespace

import pytest

from robowidgets._pacer import BYTES_PER_SECOND, INTERVAL, MESSAGES_PER_SECOND, Pacer, pacer

from .waiting import wait_for

MOST_IN_A_SECOND = 300


class Sender:
    """Stores a newest value and notes what was sent, and when."""

    def __init__(self, clock=time.monotonic, size: int = 0) -> None:
        self.clock = clock
        self.size = size
        self.newest = 0
        self.sent: list[int] = []
        self.times: list[float] = []

    def send_newest(self) -> int:
        self.sent.append(self.newest)
        self.times.append(self.clock())
        return self.size


class Restless(Sender):
    """Has something newer whenever it was sent: a source that floods."""

    def __init__(self, pacer: Pacer, **more: object) -> None:
        super().__init__(**more)
        self.pacer = pacer

    def send_newest(self) -> int:
        size = super().send_newest()
        self.newest += 1
        self.pacer.mark(self)
        return size


class Gated(Sender):
    """Is sent only when the gate opens."""

    def __init__(self) -> None:
        super().__init__()
        self.gate = threading.Event()
        self.begun = threading.Event()

    def send_newest(self) -> int:
        self.begun.set()
        assert self.gate.wait(20)
        return super().send_newest()


class ByHand(Pacer):
    """A pacer without a thread, whose time passes when the test says so."""

    def __init__(self) -> None:
        self.now = 1000.0
        super().__init__(clock=lambda: self.now)

    def _start(self) -> None:
        pass

    def run(self, seconds: float) -> None:
        """What the thread does, for some seconds of its clock."""
        end = self.now + seconds
        while (wait := self._wait()) is not None and self.now + wait <= end:
            # Floating point may end a wait a hair early, as a real clock may.
            self.now += max(wait, 1e-9)
            self._send_one()
        self.now = end


def most_in_a_second(times: list[float]) -> int:
    times = sorted(times)
    most = first = 0
    for last, when in enumerate(times):
        while times[first] <= when - 1:
            first += 1
        most = max(most, last - first + 1)
    return most


class TestPace:
    def test_a_lone_sample_goes_out_at_once(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        pacer.mark(sender)
        pacer.run(0.001)
        assert sender.times == [pytest.approx(1000.0, abs=1e-6)]

    def test_what_came_last_is_sent_though_it_came_within_an_interval(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        for value in range(1, 100):
            sender.newest = value
            pacer.mark(sender)
            pacer.run(0.0001)
        pacer.run(1)
        assert sender.sent == [1, 99]

    def test_a_sender_is_sent_sixty_times_a_second_at_most(self) -> None:
        pacer = ByHand()
        sender = Restless(pacer, clock=pacer._clock)
        pacer.mark(sender)
        pacer.run(10)
        assert len(sender.times) == pytest.approx(600, abs=2)
        gaps = [b - a for a, b in zip(sender.times, sender.times[1:], strict=False)]
        assert min(gaps) >= INTERVAL - 1e-6

    def test_a_thread_that_wakes_late_keeps_the_pace(self) -> None:
        pacer = ByHand()
        sender = Restless(pacer, clock=pacer._clock)
        pacer.mark(sender)
        while pacer.now < 1010.0:
            pacer.now += pacer._wait() + 0.008
            pacer._send_one()
        assert len(sender.times) == pytest.approx(600, abs=2)

    @pytest.mark.parametrize("count", [4, 5, 10, 50])
    def test_all_senders_share_one_budget_evenly_and_use_it(self, count: int) -> None:
        pacer = ByHand()
        senders = [Restless(pacer, clock=pacer._clock) for _ in range(count)]
        for sender in senders:
            pacer.mark(sender)
        pacer.run(10)
        times = [when for sender in senders for when in sender.times]
        assert most_in_a_second(times) <= MOST_IN_A_SECOND
        assert len(times) == pytest.approx(10 * MESSAGES_PER_SECOND, rel=0.02)
        counts = [len(sender.times) for sender in senders]
        assert max(counts) - min(counts) <= 1

    def test_one_that_speaks_seldom_need_not_wait_behind_those_that_flood(self) -> None:
        pacer = ByHand()
        for _ in range(50):
            pacer.mark(Restless(pacer, clock=pacer._clock))
        seldom = Sender(pacer._clock)
        pacer.run(1)
        marked = pacer.now
        pacer.mark(seldom)
        pacer.run(1)
        assert len(seldom.times) == 1
        assert seldom.times[0] - marked <= 51 / MESSAGES_PER_SECOND

    def test_large_samples_share_one_budget_of_bytes(self) -> None:
        pacer = ByHand()
        senders = [Restless(pacer, clock=pacer._clock, size=1_000_000) for _ in range(3)]
        for sender in senders:
            pacer.mark(sender)
        pacer.run(10)
        assert sum(len(sender.times) for sender in senders) == pytest.approx(10 * BYTES_PER_SECOND / 1e6, abs=3)

    def test_rest_saves_up_no_more_than_a_short_burst(self) -> None:
        pacer = ByHand()
        pacer.run(60)
        senders = [Sender(pacer._clock) for _ in range(400)]
        for sender in senders:
            pacer.mark(sender)
        pacer.run(1)
        assert MESSAGES_PER_SECOND <= sum(len(sender.sent) for sender in senders) <= MESSAGES_PER_SECOND + 15


class TestAppointments:
    def test_a_sender_is_sent_at_the_time_and_not_before(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        pacer.mark_at(sender, pacer.now + 0.5)
        pacer.run(0.499)
        assert sender.sent == []
        pacer.run(10)
        assert sender.times == [pytest.approx(1000.5, abs=1e-6)]

    def test_the_last_appointment_holds(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        for later in (0.5, 3.0, 2.0):
            pacer.mark_at(sender, pacer.now + later)
        pacer.run(10)
        assert sender.times == [pytest.approx(1002.0, abs=1e-6)]

    def test_none_takes_it_back(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        pacer.mark_at(sender, pacer.now + 0.5)
        pacer.mark_at(sender, None)
        pacer.mark_at(sender, None)
        pacer.run(10)
        assert sender.sent == []

    def test_one_in_the_past_is_now(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        pacer.mark_at(sender, pacer.now - 5)
        pacer.run(0.001)
        assert len(sender.sent) == 1

    def test_it_keeps_to_the_pace(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        pacer.mark(sender)
        pacer.run(0.001)
        pacer.mark_at(sender, pacer.now)
        pacer.run(1)
        assert len(sender.times) == 2
        assert sender.times[1] - sender.times[0] >= INTERVAL - 1e-6

    def test_a_thread_that_waits_for_nothing_wakes_for_one(self) -> None:
        pacer = Pacer()
        sender = Sender()
        pacer.mark(sender)
        wait_for(lambda: sender.sent == [0], "the thread had nothing left")
        pacer.mark_at(sender, time.monotonic() + 0.05)
        wait_for(lambda: len(sender.sent) == 2, "the appointment came")


class TestForget:
    def test_nothing_more_is_sent(self) -> None:
        pacer = ByHand()
        sender, other = Sender(pacer._clock), Sender(pacer._clock)
        for one in (sender, other):
            pacer.mark(one)
            pacer.mark_at(one, pacer.now + 0.5)
        pacer.forget(sender)
        pacer.forget(sender)
        pacer.run(10)
        assert sender.sent == []
        assert len(other.sent) == 2

    def test_the_collector_may_ask_for_it_in_the_middle_of_a_mark(self) -> None:
        collected = Sender()

        class Pressed(Sender):
            def __hash__(self) -> int:
                pacer.forget(collected)
                return 1

        pacer = ByHand()
        thread = threading.Thread(target=pacer.mark, args=(Pressed(pacer._clock),), daemon=True)
        thread.start()
        thread.join(20)
        assert not thread.is_alive()

    def test_a_sender_that_was_sent_is_not_kept_alive(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer._clock)
        pacer.mark(sender)
        pacer.run(1)
        gone = weakref.ref(sender)
        del sender
        gc.collect()
        assert gone() is None


class TestThreads:
    def test_mark_returns_while_a_send_takes_its_time(self) -> None:
        pacer = Pacer()
        slow, other = Gated(), Sender()
        pacer.mark(slow)
        assert slow.begun.wait(20)
        done = threading.Event()

        def flood() -> None:
            for value in range(1, 10_001):
                slow.newest = other.newest = value
                pacer.mark(slow)
                pacer.mark(other)
                pacer.mark_at(other, time.monotonic() + 0.01)
            done.set()

        threading.Thread(target=flood, daemon=True).start()
        assert done.wait(20)
        assert slow.sent == other.sent == []
        slow.gate.set()
        wait_for(lambda: slow.sent[-1:] == other.sent[-1:] == [10_000], "the last ones went out")
        assert len(slow.sent) <= 2

    def test_flooded_from_many_threads_the_budget_holds_and_the_last_go_out(self) -> None:
        pacer = Pacer()
        senders = [Sender() for _ in range(10)]
        end = time.monotonic() + 1.3

        def flood(mine: list[Sender]) -> None:
            while time.monotonic() < end:
                for sender in mine:
                    sender.newest += 1
                    pacer.mark(sender)

        threads = [threading.Thread(target=flood, args=(senders[i::2],)) for i in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        wait_for(lambda: all(sender.sent[-1:] == [sender.newest] for sender in senders), "each showed its newest")
        times = [when for sender in senders for when in sender.times]
        assert most_in_a_second(times) <= MOST_IN_A_SECOND
        assert min(len(sender.sent) for sender in senders) >= 5
        assert all(sender.sent == sorted(sender.sent) for sender in senders)
        assert all(sender.newest > 2 * len(sender.sent) for sender in senders), "it was no flood"

    def test_an_error_while_sending_is_logged_and_stops_nothing(self, caplog: pytest.LogCaptureFixture) -> None:
        class Broken(Sender):
            def send_newest(self) -> int:
                super().send_newest()
                raise RuntimeError("the wire is cut")

        pacer = Pacer()
        broken, sender = Broken(), Sender()
        with caplog.at_level(logging.ERROR, "robowidgets"):
            pacer.mark(broken)
            wait_for(lambda: caplog.records, "the error was logged")
            pacer.mark(sender)
            wait_for(lambda: sender.sent, "the other one was sent")
        (record,) = caplog.records
        assert record.name == "robowidgets"
        assert record.getMessage() == "robowidgets: could not send to the page"
        assert str(record.exc_info[1]) == "the wire is cut"

    @pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
    def test_a_thread_that_died_is_replaced(self) -> None:
        class Deadly(Sender):
            def send_newest(self) -> int:
                super().send_newest()
                raise SystemExit

        pacer = Pacer()
        deadly, sender = Deadly(), Sender()
        pacer.mark(deadly)
        wait_for(lambda: deadly.sent and pacer._thread is None, "the thread was dead")
        pacer.mark(sender)
        wait_for(lambda: sender.sent, "a new thread sent it")

    @pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
    def test_a_forked_process_sends_its_own_though_locks_were_held(self) -> None:
        slow, waiting, own = Gated(), Sender(), Sender()
        pacer.mark(slow)
        assert slow.begun.wait(20)
        pacer.mark(waiting)
        holds, leave = threading.Event(), threading.Event()

        def hold() -> None:
            with pacer._lock:
                holds.set()
                leave.wait(20)

        holder = threading.Thread(target=hold)
        holder.start()
        assert holds.wait(20)
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                pacer.mark(own)
                wait_for(lambda: own.sent == [0], "the child sent its own")
                pacer.flush()
                os.write(writing, b"sent" if waiting.sent == slow.sent == [] else b"sent what is the parent's")
            finally:
                os._exit(0)
        leave.set()
        slow.gate.set()
        holder.join()
        os.close(writing)
        ready, _, _ = select.select([reading], [], [], 30)
        answer = os.read(reading, 100) if ready else b"nothing came"
        os.close(reading)
        if not ready:
            os.kill(child, 9)
        os.waitpid(child, 0)
        assert answer == b"sent"
        wait_for(lambda: waiting.sent == [0] and slow.sent == [0], "the parent sent its own")


class TestFlush:
    def test_all_that_is_marked_goes_out_in_the_callers_thread(self) -> None:
        pacer = ByHand()
        senders = [Sender(pacer._clock) for _ in range(20)]
        for sender in senders:
            pacer.mark(sender)
        pacer.flush()
        assert all(sender.times == [1000.0] for sender in senders)
        pacer.run(1)
        assert all(len(sender.sent) == 1 for sender in senders)

    def test_its_messages_count_towards_the_budget(self) -> None:
        pacer = ByHand()
        restless = [Restless(pacer, clock=pacer._clock) for _ in range(10)]
        for sender in restless:
            pacer.mark(sender)
        for _ in range(20):
            pacer.run(0.25)
            pacer.flush()
        times = [when for sender in restless for when in sender.times]
        assert most_in_a_second(times) <= MOST_IN_A_SECOND

    def test_it_waits_for_what_the_thread_is_sending(self) -> None:
        pacer = Pacer()
        slow = Gated()
        pacer.mark(slow)
        assert slow.begun.wait(20)
        opener = threading.Timer(0.05, slow.gate.set)
        opener.start()
        pacer.flush()
        assert slow.sent == [0]

    def test_it_gives_up_on_a_send_that_hangs(self) -> None:
        pacer = Pacer()
        slow, sender = Gated(), Sender()
        pacer.mark(slow)
        assert slow.begun.wait(20)
        pacer.mark(sender)
        pacer.flush()
        assert slow.sent == sender.sent == []
        slow.gate.set()
        wait_for(lambda: sender.sent, "it was sent after all")

    def test_interrupted_it_loses_nothing_of_the_others(self) -> None:
        class Interrupted(Sender):
            def send_newest(self) -> int:
                super().send_newest()
                raise KeyboardInterrupt

        pacer = ByHand()
        interrupted, sender = Interrupted(pacer._clock), Sender(pacer._clock)
        pacer.mark(interrupted)
        pacer.mark(sender)
        with pytest.raises(KeyboardInterrupt):
            pacer.flush()
        pacer.run(1)
        assert sender.sent == [0]

    def test_one_that_fails_does_not_keep_back_the_others(self, caplog: pytest.LogCaptureFixture) -> None:
        class Broken(Sender):
            def send_newest(self) -> int:
                raise RuntimeError("the wire is cut")

        pacer = ByHand()
        sender = Sender(pacer._clock)
        pacer.mark(Broken(pacer._clock))
        pacer.mark(sender)
        pacer.flush()
        assert sender.sent == [0]
        assert len(caplog.records) == 1

    def test_a_flood_cannot_keep_it(self) -> None:
        pacer = ByHand()
        sender = Restless(pacer, clock=pacer._clock)
        pacer.mark(sender)
        pacer.flush()
        assert len(sender.sent) == 1

    def test_the_end_of_a_cell_flushes(self, monkeypatch: pytest.MonkeyPatch) -> None:
        registered = []
        events = SimpleNamespace(register=lambda name, callback: registered.append((name, callback)))
        shell = SimpleNamespace(events=events)
        monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
        pacer = Pacer()
        slow = Gated()
        pacer.mark(slow)
        assert slow.begun.wait(20)
        slow.gate.set()
        pacer.mark(slow)
        assert registered == [("post_execute", pacer.flush)]
