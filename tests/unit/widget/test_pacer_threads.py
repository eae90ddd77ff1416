"""The pacer never makes a caller wait, from any thread, and sends the rest at the end of a cell."""

from __future__ import annotations

import logging
import os
import select
import threading
import time
from types import SimpleNamespace
from typing import Any

import pytest

from robowidgets.widget.pacer import Pacer
from robowidgets.widget.pacer import pacer as global_pacer

from ..senders import MOST_IN_A_SECOND, ByHand, Failing, Gated, Restless, Sender, most_in_a_second
from ..shells import put_in_place
from ..waiting import wait_for


class TestThreads:
    def test_mark_returns_while_a_send_takes_its_time(self, pacer: Pacer) -> None:
        slow, other = Gated(), Sender()
        pacer.mark(slow)
        assert slow.begun.wait(120)
        done = threading.Event()

        def flood() -> None:
            for value in range(1, 10_001):
                slow.newest = other.newest = value
                pacer.mark(slow)
                pacer.mark(other)
                pacer.mark_at(other, time.monotonic() + 0.01)
            done.set()

        threading.Thread(target=flood, daemon=True).start()
        assert done.wait(120)
        assert slow.sent == other.sent == []
        slow.gate.set()
        wait_for(lambda: slow.sent[-1:] == other.sent[-1:] == [10_000], "the last ones went out")
        assert len(slow.sent) <= 2

    @pytest.mark.slow
    def test_flooded_from_many_threads_the_budget_holds_and_the_last_go_out(self, pacer: Pacer) -> None:
        senders = [Sender() for _ in range(10)]
        end = time.monotonic() + 1.3

        def flood(mine: list[Sender]) -> None:
            while time.monotonic() < end or min(len(sender.sent) for sender in senders) < 5:
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
        assert all(sender.sent == sorted(sender.sent) for sender in senders)
        assert all(sender.newest > 2 * len(sender.sent) for sender in senders), "it was not a flood"

    def test_an_error_while_sending_is_logged_and_stops_nothing(
        self, pacer: Pacer, caplog: pytest.LogCaptureFixture
    ) -> None:
        broken, sender = Failing(), Sender()
        with caplog.at_level(logging.ERROR, "robowidgets"):
            pacer.mark(broken)
            wait_for(lambda: caplog.records, "the error was logged")
            pacer.mark(sender)
            wait_for(lambda: sender.sent, "the other one was sent")
        (record,) = caplog.records
        assert str(record.exc_info[1]) == "the wire is cut"

    def test_an_appointment_in_a_thousand_years_ends_no_thread(self, pacer: Pacer) -> None:
        far, sender = Sender(), Sender()
        pacer.mark_at(far, time.monotonic() + 3e10)
        pacer.mark(sender)
        wait_for(lambda: sender.sent and pacer._thread._signal._lock.locked(), "the thread was waiting")
        first = pacer._thread
        pacer.mark(sender)
        wait_for(lambda: len(sender.sent) == 2, "it was sent again")
        assert first is not None
        assert pacer._thread is first

    @pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
    def test_a_thread_that_died_is_replaced(self, pacer: Pacer) -> None:
        class Deadly(Sender):
            def send_newest(self) -> int:
                super().send_newest()
                if len(self.sent) == 1:
                    raise SystemExit
                return 0

        deadly, sender = Deadly(), Sender()
        pacer.mark(deadly)
        wait_for(lambda: deadly.sent and pacer._thread is None, "the thread was dead")
        pacer.mark(sender)
        wait_for(lambda: sender.sent, "a new thread sent it")

    @pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
    def test_a_forked_process_sends_its_own_though_locks_were_held(self) -> None:
        slow, waiting, own = Gated(), Sender(), Sender()
        global_pacer.mark(slow)
        assert slow.begun.wait(120)
        global_pacer.mark(waiting)
        holds, leave = threading.Event(), threading.Event()

        def hold() -> None:
            with global_pacer._lock:
                holds.set()
                leave.wait(120)

        holder = threading.Thread(target=hold)
        holder.start()
        assert holds.wait(120)
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                global_pacer.mark(own)
                wait_for(lambda: own.sent == [0], "the child sent its own")
                global_pacer.flush()
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
        senders = [Sender(pacer.clock.now) for _ in range(20)]
        for sender in senders:
            pacer.mark(sender)
        pacer.flush()
        assert all(sender.times == [1000.0] for sender in senders)
        pacer.run(1)
        assert all(len(sender.sent) == 1 for sender in senders)

    def test_its_messages_count_towards_the_budget(self) -> None:
        pacer = ByHand()
        restless = [Restless(pacer, clock=pacer.clock.now) for _ in range(10)]
        for sender in restless:
            pacer.mark(sender)
        for _ in range(20):
            pacer.run(0.25)
            pacer.flush()
        times = [when for sender in restless for when in sender.times]
        assert most_in_a_second(times) <= MOST_IN_A_SECOND

    def test_it_waits_for_what_the_thread_is_sending(self, pacer: Pacer) -> None:
        slow = Gated()
        pacer.mark(slow)
        assert slow.begun.wait(120)
        opener = threading.Timer(0.05, slow.gate.set)
        opener.start()
        pacer.flush()
        assert slow.sent == [0]

    def test_it_gives_up_on_a_send_that_hangs(self, pacer: Pacer) -> None:
        slow, sender = Gated(), Sender()
        pacer.mark(slow)
        assert slow.begun.wait(120)
        pacer.mark(sender)
        pacer.flush()
        assert slow.sent == sender.sent == []
        slow.gate.set()
        wait_for(lambda: sender.sent, "it was sent after all")

    def test_it_gives_up_on_a_send_that_begins_and_hangs_just_before_its_turn(
        self, pacer: Pacer, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        class Free:
            """A turn that seems free: the thread takes it after the check."""

            def __init__(self, turn: Any) -> None:
                self._turn = turn

            def locked(self) -> bool:
                return False

            def __enter__(self) -> Any:
                return self._turn.__enter__()

            def __exit__(self, *error: object) -> None:
                self._turn.__exit__(*error)

            def __getattr__(self, name: str) -> Any:
                return getattr(self._turn, name)

        monkeypatch.setattr("robowidgets.widget.pacer.PATIENCE", 0.01)
        slow, sender = Gated(), Sender()
        pacer.mark(slow)
        assert slow.begun.wait(120)
        pacer.mark(sender)
        monkeypatch.setattr(pacer, "_turn", Free(pacer._turn))
        flusher = threading.Thread(target=pacer.flush)
        flusher.start()
        flusher.join(60)
        hangs = flusher.is_alive()
        slow.gate.set()
        flusher.join(60)
        assert not hangs

    def test_interrupted_it_loses_nothing_of_the_others(self) -> None:
        class Interrupted(Sender):
            def send_newest(self) -> int:
                super().send_newest()
                if len(self.sent) == 1:
                    raise KeyboardInterrupt
                return 0

        pacer = ByHand()
        interrupted, sender = Interrupted(pacer.clock.now), Sender(pacer.clock.now)
        pacer.mark(interrupted)
        pacer.mark(sender)
        with pytest.raises(KeyboardInterrupt):
            pacer.flush()
        pacer.run(10)
        assert sender.sent == [0]
        assert interrupted.sent == [0, 0]

    def test_one_that_fails_does_not_keep_back_the_others(self, caplog: pytest.LogCaptureFixture) -> None:
        pacer = ByHand()
        sender = Sender(pacer.clock.now)
        pacer.mark(Failing(pacer.clock.now))
        pacer.mark(sender)
        pacer.flush()
        assert sender.sent == [0]
        assert len(caplog.records) == 1

    def test_a_flood_cannot_keep_it(self) -> None:
        pacer = ByHand()
        sender = Restless(pacer, clock=pacer.clock.now)
        pacer.mark(sender)
        pacer.flush()
        assert len(sender.sent) == 1

    def test_the_end_of_a_cell_flushes(self, pacer: Pacer, monkeypatch: pytest.MonkeyPatch) -> None:
        registered = []
        events = SimpleNamespace(register=lambda name, callback: registered.append((name, callback)))
        put_in_place(monkeypatch, events=events)
        slow = Gated()
        pacer.mark(slow)
        assert slow.begun.wait(120)
        slow.gate.set()
        pacer.mark(slow)
        assert registered == [("post_execute", pacer.flush)]
