"""Functions of a user that hang, raise and are detached, by a clock that the test moves."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from robowidgets.runtime.clock import Threads
from robowidgets.runtime.policies import Policy
from robowidgets.runtime.runner import LINGER, Call, Outcome, Runner
from robowidgets.runtime.user_threads import UserThread, is_abandoned

from ..clocks import ManualClock, end_timers
from ..waiting import wait_for

NAME = "robowidgets-test"
POLICY = Policy(late=0.1, look=0.1)


class Owner:
    """Lets a runner call queued functions, and notes their results and the times of looking at them."""

    def __init__(self, clock: ManualClock, policy: Policy) -> None:
        self.clock, self.threads = clock, Threads(clock)
        self.lock = threading.RLock()
        self.waiting: list[Callable[[], Any]] = []
        self.outcomes: list[Outcome] = []
        self.looks: list[tuple[float, float]] = []
        self.gates: list[threading.Event] = []
        self.runner = Runner(self.turn, self.lock, NAME, policy, on_look=self.look, scheduler=self.threads)

    def turn(self, call: Call) -> float | None:
        with self.lock:
            if not self.waiting:
                return None
            function = self.waiting.pop(0)
        self.outcomes.append(call(function, of=function))
        return 0.0

    def look(self) -> None:
        self.looks.append((self.clock.now(), self.runner.busy_for))

    def run(self, *functions: Callable[[], Any]) -> None:
        with self.lock:
            self.waiting += functions
            self.runner.wake()

    def hang(self) -> Callable[[], Any]:
        """A function that does not return before the end of the test."""
        gate = threading.Event()
        self.gates.append(gate)
        return lambda: gate.wait(120) and is_abandoned()

    def settle_hung(self) -> None:
        wait_for(lambda: self.runner.current is not None, "a function hangs")


@pytest.fixture
def owner(request: pytest.FixtureRequest) -> Iterator[Owner]:
    owner = Owner(ManualClock(), getattr(request, "param", POLICY))
    yield owner
    owner.runner.detach()
    for gate in owner.gates:
        gate.set()
    end_timers(owner.threads)


def test_functions_are_called_one_after_the_other_and_what_they_raise_ends_nothing(owner: Owner) -> None:
    error = SystemExit("mine")

    def fail() -> None:
        raise error

    owner.run(lambda: 1, fail, lambda: 2)
    owner.clock.settle()
    assert owner.outcomes == [Outcome(1, None), Outcome(None, error), Outcome(2, None)]


def test_a_turn_that_calls_functions_is_looked_at_and_once_more_when_it_is_over(owner: Owner) -> None:
    owner.run(owner.hang())
    owner.settle_hung()
    owner.clock.advance(0.25, hangs=(NAME,))
    assert owner.looks == [(pytest.approx(1000.1), pytest.approx(0.1)), (pytest.approx(1000.2), pytest.approx(0.2))]
    owner.gates[0].set()
    owner.clock.advance(1.0)
    assert owner.looks[2:] == [(pytest.approx(1000.3), 0.0)]


def test_the_look_is_for_the_turn_that_is_under_way(owner: Owner) -> None:
    owner.run(lambda: 1)
    owner.clock.advance(0.07)
    owner.run(owner.hang())
    owner.settle_hung()
    owner.clock.advance(0.1, hangs=(NAME,))
    assert owner.looks == [(pytest.approx(1000.17), pytest.approx(0.1))]


def test_a_function_that_was_left_goes_on_alone_abandoned_and_what_it_returns_is_not_taken(owner: Owner) -> None:
    told: list[bool] = []
    hangs = owner.hang()
    owner.run(lambda: told.append(hangs()), lambda: 2)
    owner.settle_hung()
    detached = owner.runner.detach()
    assert detached is not None
    assert owner.runner.current is None
    owner.runner.wake()
    owner.clock.settle(hangs=(NAME,))
    wait_for(lambda: owner.outcomes == [Outcome(2, None)], "another thread goes on")
    owner.gates[0].set()
    detached.join(120)
    assert told == [True]
    assert owner.outcomes == [Outcome(2, None)]


def test_a_function_in_the_turn_cannot_detach_it(owner: Owner) -> None:
    owner.run(lambda: owner.runner.detach(), lambda: 2)
    owner.clock.settle()
    assert owner.outcomes == [Outcome(None, None), Outcome(2, None)]


def test_the_thread_ends_when_there_is_nothing_to_do_and_another_one_starts(owner: Owner) -> None:
    for _ in range(2):
        owner.run(threading.current_thread)
        owner.clock.advance(LINGER - 0.01)
    first, again = (outcome.value for outcome in owner.outcomes)
    assert first is again
    assert owner.runner.is_at_work
    owner.clock.advance(0.02)
    assert not owner.runner.is_at_work
    wait_for(lambda: not first.is_alive(), "it ends")
    owner.run(threading.current_thread)
    owner.clock.settle()
    assert owner.outcomes[-1].value is not first


def test_it_tells_the_line_at_which_a_function_hangs(owner: Owner) -> None:
    gate = threading.Event()
    owner.gates.append(gate)

    def wait_here() -> None:
        gate.wait(120)

    owner.run(wait_here)
    owner.settle_hung()
    line = wait_here.__code__.co_firstlineno + 1
    wait_for(lambda: owner.runner.where(wait_here) == f", line {line}", "it is at its line")


@pytest.mark.parametrize("owner", [POLICY._replace(grace=0.35)], indirect=True)
def test_a_function_that_was_left_is_ended_when_its_grace_is_over_and_one_that_returned_is_not(
    owner: Owner, monkeypatch: pytest.MonkeyPatch
) -> None:
    ends: list[float] = []
    monkeypatch.setattr(UserThread, "end", lambda _thread: ends.append(round(owner.clock.now(), 6)))
    owner.run(owner.hang())
    owner.settle_hung()
    owner.runner.detach()
    owner.clock.advance(0.6, hangs=(NAME,))
    assert ends == [1000.35, 1000.45, 1000.55], "again: a try may take one"
    owner.clock.advance(9.0, hangs=(NAME,))
    assert len(ends) == 20
    assert not owner.runner._has_look
    owner.run(owner.hang())
    owner.settle_hung()
    owner.runner.detach()
    for gate in owner.gates:
        gate.set()
    owner.clock.advance(1.0)
    assert len(ends) == 20


def test_a_turn_may_detach_itself_and_the_next_one_is_in_another_thread(owner: Owner) -> None:
    threads: list[threading.Thread] = []

    def detach() -> bool:
        threads.append(threading.current_thread())
        owner.runner.detach(even_if_current=True)
        owner.runner.wake()
        return is_abandoned()

    owner.run(detach, lambda: threads.append(threading.current_thread()))
    owner.clock.settle()
    assert owner.outcomes == [Outcome(None, None)], "its return value is not taken"
    assert len(set(threads)) == 2


def test_an_interrupt_takes_no_lock_and_no_turn_follows_until_it_is_left_and_woken(owner: Owner) -> None:
    told: list[bool] = []
    hangs = owner.hang()
    owner.run(lambda: told.append(hangs()), lambda: 2)
    owner.settle_hung()
    is_held, release = threading.Event(), threading.Event()

    def hold() -> None:
        with owner.lock:
            is_held.set()
            release.wait(120)

    holder = threading.Thread(target=hold)
    holder.start()
    assert is_held.wait(120)
    assert owner.runner.interrupt()
    release.set()
    holder.join()
    owner.gates[0].set()
    wait_for(lambda: told == [True], "what was at work is abandoned")
    owner.clock.settle()
    owner.runner.wake()
    owner.clock.settle()
    assert not owner.outcomes
    owner.runner.detach()
    assert not owner.runner.interrupt()
    owner.runner.wake()
    owner.clock.settle()
    assert owner.outcomes == [Outcome(2, None)]


@pytest.mark.parametrize("owner", [POLICY._replace(late=0.3, max_gap=0.2)], indirect=True)
def test_a_gap_between_looks_counts_as_the_policy_says_and_the_rest_was_unseen(owner: Owner) -> None:
    owner.run(owner.hang())
    owner.settle_hung()
    owner.clock.stand_still(100.0, hangs=(NAME,))
    assert owner.runner.busy_for == pytest.approx(0.2)
    assert not owner.runner.is_late
    owner.clock.advance(0.1, hangs=(NAME,))
    assert owner.runner.is_late
    owner.gates[0].set()
    owner.clock.settle()
    assert owner.outcomes[0].unseen == pytest.approx(99.8)
