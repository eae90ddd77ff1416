"""The pacer sends the newest value of each sender, within one budget for all."""

from __future__ import annotations

import gc
import threading
import time
import weakref

import pytest

from robowidgets.widget.pacer import BYTES_PER_SECOND, FIRST_PAUSE, INTERVAL, LONGEST_PAUSE, MESSAGES_PER_SECOND, Pacer

from ..senders import MOST_IN_A_SECOND, ByHand, Failing, Restless, Sender, most_in_a_second
from ..waiting import wait_for


class TestPace:
    def test_a_lone_sample_goes_out_at_once(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        pacer.mark(sender)
        pacer.run(0.001)
        assert sender.times == [pytest.approx(1000.0, abs=1e-6)]

    def test_what_came_last_is_sent_though_it_came_within_an_interval(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        for value in range(1, 100):
            sender.newest = value
            pacer.mark(sender)
            pacer.run(0.0001)
        pacer.run(1)
        assert sender.sent == [1, 99]

    def test_a_sender_is_sent_once_an_interval_at_most(self) -> None:
        pacer = ByHand()
        sender = Restless(pacer, clock=pacer.clock.now)
        pacer.mark(sender)
        pacer.run(10)
        assert len(sender.times) == pytest.approx(10 / INTERVAL, abs=2)
        gaps = [b - a for a, b in zip(sender.times, sender.times[1:], strict=False)]
        assert min(gaps) >= INTERVAL - 1e-6

    def test_a_thread_that_wakes_late_keeps_the_pace(self) -> None:
        pacer = ByHand()
        sender = Restless(pacer, clock=pacer.clock.now)
        pacer.mark(sender)
        while pacer.now < 1010.0:
            wait = pacer._send_one()
            pacer.now += wait + 0.008 if wait else 0
        assert len(sender.times) == pytest.approx(10 / INTERVAL, abs=2)

    @pytest.mark.parametrize("count", [4, 5, 10, 50])
    def test_all_senders_share_one_budget_evenly_and_use_it(self, count: int) -> None:
        pacer = ByHand()
        senders = [Restless(pacer, clock=pacer.clock.now) for _ in range(count)]
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
            pacer.mark(Restless(pacer, clock=pacer.clock.now))
        seldom = Sender(pacer.clock.now)
        pacer.run(1)
        marked = pacer.now
        pacer.mark(seldom)
        pacer.run(1)
        assert len(seldom.times) == 1
        assert seldom.times[0] - marked <= 51 / MESSAGES_PER_SECOND

    def test_large_samples_share_one_budget_of_bytes(self) -> None:
        pacer = ByHand()
        senders = [Restless(pacer, clock=pacer.clock.now, size=1_000_000) for _ in range(3)]
        for sender in senders:
            pacer.mark(sender)
        pacer.run(10)
        assert sum(len(sender.times) for sender in senders) == pytest.approx(10 * BYTES_PER_SECOND / 1e6, abs=3)

    def test_rest_saves_up_no_more_than_a_short_burst(self) -> None:
        pacer = ByHand()
        pacer.run(60)
        senders = [Sender(pacer.clock.now) for _ in range(400)]
        for sender in senders:
            pacer.mark(sender)
        pacer.run(1)
        assert MESSAGES_PER_SECOND <= sum(len(sender.sent) for sender in senders) <= MESSAGES_PER_SECOND + 15


class TestFailure:
    def test_what_could_not_be_sent_is_tried_again_after_growing_pauses(self) -> None:
        pacer = ByHand()
        sender = Failing(pacer.clock.now)
        pacer.mark(sender)
        pacer.run(125)
        pauses = [later - earlier for earlier, later in zip(sender.times, sender.times[1:], strict=False)]
        assert pauses == pytest.approx([FIRST_PAUSE, 2, 4, 8, 16, LONGEST_PAUSE, LONGEST_PAUSE, LONGEST_PAUSE])

    def test_marking_does_not_shorten_a_pause(self) -> None:
        pacer = ByHand()
        sender = Failing(pacer.clock.now)
        for _ in range(500):
            pacer.mark(sender)
            pacer.run(0.01)
        assert sender.times == pytest.approx([1000.0, 1001.0, 1003.0])

    def test_the_pause_is_short_again_after_a_success(self) -> None:
        pacer = ByHand()
        sender = Failing(pacer.clock.now)
        pacer.mark(sender)
        pacer.run(20)
        sender.error = None
        pacer.run(20)
        assert sender.sent == [0]
        sender.error = OSError("the wire is cut")
        sender.times.clear()
        pacer.mark(sender)
        pacer.run(2.5)
        assert sender.times[1] - sender.times[0] == pytest.approx(FIRST_PAUSE)

    def test_the_same_error_is_logged_once_however_long_it_lasts(self, caplog: pytest.LogCaptureFixture) -> None:
        pacer = ByHand()
        pacer.mark(Failing(pacer.clock.now))
        pacer.run(10_000)
        (record,) = caplog.records
        assert (record.name, record.levelname) == ("robowidgets", "ERROR")
        assert record.getMessage() == (
            "robowidgets: could not send to the page; trying again, and not logging this error again"
        )
        assert str(record.exc_info[1]) == "the wire is cut"

    def test_an_error_that_comes_and_goes_is_logged_once(self, caplog: pytest.LogCaptureFixture) -> None:
        pacer = ByHand()
        sender = Failing(pacer.clock.now)
        for _ in range(1000):
            sender.error = OSError("the wire is cut") if sender.error is None else None
            pacer.mark(sender)
            pacer.run(2)
        assert len(sender.sent) == 500
        assert len(caplog.records) == 1

    def test_another_error_is_logged(self, caplog: pytest.LogCaptureFixture) -> None:
        pacer = ByHand()
        sender = Failing(pacer.clock.now)
        pacer.mark(sender)
        for error in (OSError("the wire is cut"), OSError("the wire is gone"), ValueError("the wire is gone")):
            sender.error = error
            pacer.run(100)
        assert [str(record.exc_info[1]) for record in caplog.records] == [
            "the wire is cut",
            "the wire is gone",
            "the wire is gone",
        ]

    def test_the_same_error_is_logged_again_when_sending_worked_for_long(
        self, caplog: pytest.LogCaptureFixture
    ) -> None:
        pacer = ByHand()
        sender = Failing(pacer.clock.now)
        for error in (OSError("the wire is cut"), None, OSError("the wire is cut")):
            sender.error = error
            pacer.mark(sender)
            pacer.run(300)
        assert len(caplog.records) == 2

    def test_each_sender_has_pauses_of_its_own(self) -> None:
        pacer = ByHand()
        broken, other = Failing(pacer.clock.now), Failing(pacer.clock.now)
        pacer.mark(broken)
        pacer.run(100)
        pacer.mark(other)
        pacer.run(1.5)
        assert other.times[1] - other.times[0] == pytest.approx(FIRST_PAUSE)

    def test_nothing_is_kept_of_a_failure_once_its_sender_is_forgotten(self) -> None:
        pacer = ByHand()
        sender = Failing(pacer.clock.now)
        pacer.mark(sender)
        pacer.run(10)
        pacer.forget(sender)
        assert not pacer._due
        assert not pacer._failures
        assert not pacer._earliest


class TestAppointments:
    def test_a_sender_is_sent_at_the_time_and_not_before(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        pacer.mark_at(sender, pacer.now + 0.5)
        pacer.run(0.499)
        assert sender.sent == []
        pacer.run(10)
        assert sender.times == [pytest.approx(1000.5, abs=1e-6)]

    def test_the_last_appointment_holds(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        for later in (0.5, 3.0, 2.0):
            pacer.mark_at(sender, pacer.now + later)
        pacer.run(10)
        assert sender.times == [pytest.approx(1002.0, abs=1e-6)]

    def test_none_takes_it_back(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        pacer.mark_at(sender, pacer.now + 0.5)
        pacer.mark_at(sender, None)
        pacer.mark_at(sender, None)
        pacer.run(10)
        assert sender.sent == []

    def test_one_in_the_past_is_now(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        pacer.mark_at(sender, pacer.now - 5)
        pacer.run(0.001)
        assert len(sender.sent) == 1

    def test_it_keeps_to_the_pace(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        pacer.mark(sender)
        pacer.run(0.001)
        pacer.mark_at(sender, pacer.now)
        pacer.run(1)
        assert len(sender.times) == 2
        assert sender.times[1] - sender.times[0] >= INTERVAL - 1e-6

    def test_a_thread_that_waits_for_nothing_wakes_for_one(self, pacer: Pacer) -> None:
        sender = Sender()
        pacer.mark(sender)
        wait_for(lambda: sender.sent == [0], "the thread had nothing left")
        pacer.mark_at(sender, time.monotonic() + 0.05)
        wait_for(lambda: len(sender.sent) == 2, "the appointment came")


class TestForget:
    def test_nothing_more_is_sent(self) -> None:
        pacer = ByHand()
        sender, other = Sender(pacer.clock.now), Sender(pacer.clock.now)
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
        thread = threading.Thread(target=pacer.mark, args=(Pressed(pacer.clock.now),), daemon=True)
        thread.start()
        thread.join(120)
        assert not thread.is_alive()

    def test_a_sender_that_was_sent_is_not_kept_alive(self) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        pacer.mark(sender)
        pacer.run(1)
        gone = weakref.ref(sender)
        del sender
        gc.collect()
        assert gone() is None
