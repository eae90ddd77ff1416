"""Another version is tried on kept inputs: without a trace in the running program, and in a thread that may hang."""

from __future__ import annotations

import random
import re
import threading
from collections import deque
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from robowidgets.behaviors import Drive
from robowidgets.behaviors.exchange import exchanged
from robowidgets.behaviors.kept_steps import KEPT_S, MOST_BYTES, KeptSteps
from robowidgets.behaviors.machine import Machine
from robowidgets.behaviors.trial import ComparedSteps, compared, steps_to_try, tried, why_not_tried
from robowidgets.behaviors.trials import TrialJob, Trials
from robowidgets.behaviors.variables import ProgramState, Variables
from robowidgets.runtime.clock import Threads
from robowidgets.runtime.user_threads import why_refused

from ..clocks import ManualClock
from ..waiting import wait_for
from .test_rewriting import made

OF = ("go", 1)


class Kept:
    """Steps that are kept by a clock of the test."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.steps = KeptSteps(self.clock.now)

    def add(self, function: Any = None, **values: Any) -> None:
        self.steps.add(OF, self.clock.now() - 1000.0, function, values)
        self.clock.set(self.clock.now() + 0.1)

    def all(self) -> list[Any]:
        return self.steps.last("go", 1e9)


@pytest.fixture
def kept() -> Kept:
    return Kept()


def drives(found: Iterator[Any]) -> list[Any]:
    return [one.error or (one.drive and one.drive.linear) for one in found]


def test_a_minute_of_inputs_is_kept_and_large_samples_for_less(kept: Kept) -> None:
    for number in range(1000):
        kept.add(time=float(number))
    assert kept.clock.now() - kept.all()[0].at <= KEPT_S + 0.11
    for _ in range(100):
        kept.add(message={"data": np.zeros(1_000_000, np.uint8)})
    assert MOST_BYTES - 2_000_000 < 1_000_000 * len(kept.all()) <= MOST_BYTES
    kept.steps.add(("other", 1), 0.0, len, {})
    assert all(step.program[0] == "go" for step in kept.all())


def test_a_state_is_copied_and_a_trial_changes_neither_the_program_nor_the_copy(kept: Kept) -> None:
    def step(state: Any) -> Drive:
        state.path.append(state.count)
        state.count += 1
        return Drive(state.count)

    state, variables = ProgramState(count=3, path=[1, {"a": deque([2], 5)}]), Variables()
    variables.near = 0.5
    for _ in range(2):
        kept.add(state=state, variables=variables)
        step(state)
    variables.near = 0.7
    for _ in range(2):
        assert drives(tried(step, ("state",), kept.all())) == [4.0, 5.0]
    assert state.path == [1, {"a": deque([2])}, 3, 4]
    assert [step.state["count"] for step in kept.all()] == [3, 4]
    near = drives(tried(lambda variables: Drive(variables.near), ("variables",), kept.all()))
    assert near == [0.5, 0.5]


def test_a_state_that_cannot_be_copied_gives_the_reason(kept: Kept) -> None:
    class Own:
        def __deepcopy__(self, memo: Any) -> Any:
            raise AssertionError("code of a user is called")

    kept.add(state=ProgramState(own=Own()))
    steps, why = steps_to_try(kept.all(), ("state",), 100)
    assert (steps, why) == ([], "state.own is an Own, which cannot be copied at each step")
    kept.add(state=ProgramState(own=[0] * 1000))
    assert "too large" in kept.all()[-1].why
    ring: list[Any] = []
    ring.append(ring)
    kept.add(state=ProgramState(own=ring), message=ring)
    assert kept.all()[-1].why, "no error, which would end the step that is about to be made"
    kept.add(state=ProgramState(own=1))
    assert len(steps_to_try(kept.all(), ("state",), 100)[0]) == 1
    assert steps_to_try(kept.all(), ("scan",), 100)[1] == "the version before did not read scan"


def test_two_versions_are_compared_with_the_first_line_that_was_otherwise(kept: Kept) -> None:
    source = (
        "def step(time):\n    near = time < {}\n    if near:\n        return do(0.2)\n    return 1 / (time - 0.85)\n"
    )
    old, new = (made(source.format(limit)) for limit in ("0.25", "0.45"))
    for one in (old, new):
        one.__globals__["do"] = Drive
    for number in range(8):
        kept.add(time=number / 10)
    found = ComparedSteps()
    for _ in compared((old, ("time",)), (new, ("time",)), kept.all(), found):
        pass
    assert (found.steps, found.otherwise, found.failed) == (8, 2, 0)
    (span,) = found.spans
    assert (span.first, span.last, span.line) == (3, 4, 2)
    assert span.old_value.startswith("False")
    assert span.new_value.startswith("True")
    assert span.old.startswith("! TypeError: expected a step to return Drive")
    assert span.new == "Drive(0.2)"


def test_a_state_machine_is_tried_from_the_state_that_it_had(kept: Kept) -> None:
    class Wall:
        moves = "go -> turn on near", "turn -> go after 5"

        def near(time):  # type: ignore[no-untyped-def]  # noqa: N805
            return time > 0.25

        def go():  # type: ignore[no-untyped-def]
            return Drive(0.2)

        def turn():  # type: ignore[no-untyped-def]
            return Drive(0.0, 0.5)

    machine = Machine(Wall)
    for number in range(6):
        values = {"time": number / 10, "variables": Variables()}
        kept.add(machine, **values)
        machine(**values)
    assert machine.active == ("turn",)

    def sideways():  # type: ignore[no-untyped-def]
        return Drive(0.0, 0.9)

    other = exchanged(machine, vars(Wall)["turn"], sideways)
    turns = [one.drive.angular for one in tried(other, ("time", "variables"), kept.all()[4:]) if one.drive]
    assert turns == [0.9, 0.9]
    assert machine.active == ("turn",)
    assert vars(Wall)["turn"] is not sideways
    with pytest.raises(LookupError, match="is not in class Wall"):
        exchanged(machine, len, sideways)


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ("global known\n    known = 2", "changes known"),
        ("numbers.append(do)", r"uses numbers.append, which"),
        ("x = numbers.close()", r"uses numbers.close, which"),
        ("other = numbers\n    x = other.close()", r"uses numbers, which"),
        ("do.append(3)", r"calls do.append\(\), which"),
        ("do.ranges[0] = 3", "changes do, which"),
        ("import os\n    x = os.getpid()", "imports os"),
        ("x = missing(3)", "uses missing, which is not defined"),
        ("x = random.random()", "uses random.random, which"),
        ("x = np.random.rand()", "uses np.random.rand, which"),
        ("x = np.save('a', [])", "uses np.save, which"),
        ("x = helper(3)", "uses helper: it uses numbers, which"),
        ("x = points", "uses points, which"),
        ("x = (lambda: numbers.pop())()", "uses numbers.pop, which"),
        ("x = helper.cache", "uses helper"),
        ("import math\n    x = [math.pi * np.hypot(a, b) for a, b in points] + [points[0], len(points)]", ""),
        ("def inner(a):\n        return max(a, limit)\n    x = inner(3) + clear(2) + clear(1)", ""),
        ("x = np.array([1.0])\n    x[0] = grid[0] + (grid * 2)[1]", ""),
        ("known.x = 3", "changes known"),
        ("known[0] += 3", "changes known"),
        ("x = open('a.txt')", "uses open, which"),
        ("print(do)\n    state.path.append(3)\n    x = {}\n    x['a'] = len([3])", ""),
    ],
)
def test_a_version_that_changes_something_outside_is_not_tried(body: str, why: str) -> None:
    function = made(
        "limit, points = 0.5, [(1, 2), (3, 4)]\n"
        "def helper(a):\n    return next(numbers)\n"
        "def clear(a):\n    return clear(a - 1) if a else limit\n"
        f"def step(do, state):\n    {body}\n    return 1\n"
    )
    function.__globals__.update(np=np, random=random, grid=np.zeros(3))
    assert re.search(why, found := why_not_tried(function))
    assert bool(found) == bool(why)


class Bench:
    """Trials by a clock of the test."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.trials = Trials(Threads(self.clock))
        self.over: list[TrialJob] = []

    def ask(self, name: str, work: Iterator[object], function: Any = len) -> TrialJob:
        job = TrialJob(work, function, self.over.append)
        self.trials.ask(name, job)
        return job


@pytest.fixture
def bench() -> Iterator[Bench]:
    made_ = Bench()
    yield made_
    made_.trials.close()
    made_.clock.advance(5.0)


def test_a_trial_that_hangs_is_abandoned_with_its_line_and_the_next_one_is_done(bench: Bench) -> None:
    gate, began = threading.Event(), threading.Event()

    def hangs() -> None:
        began.set()
        gate.wait(120)

    def work() -> Iterator[None]:
        hangs()
        yield

    hung = bench.ask("number", work(), hangs)
    assert began.wait(120)
    bench.clock.advance(1.6, hangs=("robowidgets-trial",))
    wait_for(lambda: bench.over == [hung], "the trial is over")
    after = bench.ask("number", iter([1, 2]))
    wait_for(lambda: bench.over == [hung, after], "the next trial is done")
    gate.set()
    assert "line" in hung.error
    assert "has not returned for 1.5 s" in hung.error
    assert after.error == ""


def test_the_newest_trial_of_a_name_wins_and_an_error_ends_one(bench: Bench) -> None:
    gate, began = threading.Event(), threading.Event()

    def waits() -> Iterator[None]:
        began.set()
        gate.wait(120)
        yield

    bench.ask("number", waits())
    assert began.wait(120)
    dropped = bench.ask("number", iter([1]))
    newest = bench.ask("number", iter([1]))
    failing = bench.ask("versions", (1 / 0 for _ in [1]))
    gate.set()
    bench.clock.advance(1.0)
    assert dropped not in bench.over
    assert {*bench.over} == {newest, failing}
    assert "ZeroDivisionError" in failing.error


def test_a_trial_neither_drives_nor_prints_nor_asks(bench: Bench, capsys: pytest.CaptureFixture[str]) -> None:
    found: list[str] = []

    def work() -> Iterator[None]:
        print("from a trial")  # noqa: T201
        found.append(why_refused(object()))
        yield
        input("?")

    job = bench.ask("number", work())
    bench.clock.advance(1.0)
    assert found == ["another version is only tried, and does not drive"]
    assert "EOFError" in job.error
    assert "from a trial" not in capsys.readouterr().out
