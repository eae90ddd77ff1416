"""The functions of steps are rewritten once for each version, and whatever cannot be rewritten runs as it is."""

from __future__ import annotations

import gc
import linecache
import threading
import weakref
from threading import current_thread
from typing import Any

import numpy as np
import pytest

from robowidgets import Scan
from robowidgets.behaviors import Drive
from robowidgets.behaviors.lines import watch
from robowidgets.behaviors.lines.packed import calls_by_function
from robowidgets.behaviors.lines.texts import line_texts
from robowidgets.behaviors.lines.watch import LineWatch
from robowidgets.behaviors.machine import Machine
from robowidgets.behaviors.variables import Variables
from robowidgets.feeds import Feed
from robowidgets.reasons.rewriting import rewritten
from robowidgets.runtime.policies import NO_RETURN
from robowidgets.runtime.user_threads import UserThread

from ..waiting import wait_for
from .test_rewriting import made


def watch_step(watch: LineWatch, function: Any, version: int = 1, **values: Any) -> Any:
    return watch.step(("p", version), (1, 0.0), function, values)


def test_a_function_that_is_changed_in_place_runs_in_its_new_form() -> None:
    """As autoreload does it."""
    function, other = made("def step(x=1):\n    return x\n"), made("def step(x=2):\n    return 10 * x\n")
    watch = LineWatch()
    assert watch_step(watch, function) == 1
    function.__code__ = other.__code__
    assert watch_step(watch, function) == 10
    function.__defaults__ = other.__defaults__
    assert watch_step(watch, function) == 20


def test_the_functions_of_a_former_version_are_let_go() -> None:
    function = made("def step():\n    return 1\n")
    gone = weakref.ref(function)
    watch = LineWatch()
    watch_step(watch, function)
    linecache.cache.pop(function.__code__.co_filename)
    function.__globals__.clear()
    del function
    watch_step(watch, made("def step():\n    return 2\n"), version=2)
    gc.collect()
    assert gone() is None


def test_a_function_is_rewritten_before_its_first_step(robot: Feed, monkeypatch: pytest.MonkeyPatch) -> None:
    """A step of a long source would be late, and the robot stopped."""
    where: list[str] = []
    monkeypatch.setattr(
        watch, "rewritten", lambda function: (where.append(current_thread().name), rewritten(function))[1]
    )

    @robot.program(rate=50)
    def keep(state):  # type: ignore[no-untyped-def]
        state.made = True

    wait_for(lambda: robot.programs.current.steps, "it makes steps")
    queue = robot.programs.watch_lines()
    wait_for(lambda: queue, "a step is watched")

    @robot.program(rate=50)
    def other(state):  # type: ignore[no-untyped-def]
        state.made = True

    wait_for(lambda: queue and queue[-1].program == ("other", 1), "a step of the next program is watched")
    assert where == ["MainThread", "MainThread"]
    assert not any(call.why for step in queue for call in step.calls)


def test_without_a_view_nothing_is_kept() -> None:
    watch = LineWatch()
    view = watch.add_view()
    watch_step(watch, made("def step():\n    return 1\n"))
    assert watch.newest is not None
    watch.remove_view(view)
    assert watch.newest is None


def test_two_functions_of_one_name_on_the_same_line_of_two_cells_are_two() -> None:
    near, far = made("step = lambda x: x < 1\n"), made("step = lambda x: x > 5\n")

    class Both:
        calls_functions = True
        lines: LineWatch

        def __call__(self, x: int) -> None:
            for function in (near, far):
                self.lines.call(function, {"x": x})

    watch = LineWatch()
    watch_step(watch, Both(), x=0)
    assert watch.newest is not None
    assert len(calls_by_function(watch.newest)) == 2


def test_two_functions_on_one_line_are_two() -> None:
    both = made("step = [lambda x: x < 1, lambda x: x > 5]\n")
    watch = LineWatch()
    keys = set()
    for function in both:
        watch_step(watch, function, x=0)
        assert watch.newest is not None
        keys |= {call.source.key for call in watch.newest.calls}
    assert len(keys) == 2


def test_a_step_that_was_left_behind_is_not_shown_after_a_newer_one() -> None:
    watch = LineWatch()
    queue = watch.add_view()
    began, goes_on = threading.Event(), threading.Event()

    def late() -> None:
        began.set()
        goes_on.wait()

    thread = threading.Thread(target=watch_step, args=(watch, late))
    thread.start()
    began.wait()
    watch_step(watch, made("def step():\n    return 1\n"), version=2)
    goes_on.set()
    thread.join()
    assert [step.program for step in queue] == [("p", 2)]


def test_a_source_that_is_too_deep_to_be_rewritten_runs_as_it_is() -> None:
    watch = LineWatch()
    function = made(f"def step(a):\n    return {' + '.join(['a'] * 900)}\n")
    assert watch_step(watch, function, a=1) == 900
    assert watch.newest is not None
    (call,) = watch.newest.calls
    assert "RecursionError" in call.why


def test_an_object_that_has_every_attribute_is_only_called() -> None:
    class Odd:
        def __getattr__(self, name: str) -> Any:
            return name

        def __call__(self) -> int:
            return 3

    function = Odd()
    assert watch_step(LineWatch(), function) == 3
    assert vars(function) == {}


NAN, INF = float("nan"), float("inf")
RANGES = Scan([0.3, 1.0, 0.4, 0.45, INF], angle_min=-0.4, angle_increment=0.2, range_min=0.1, range_max=4.0)
UNKNOWN = RANGES.again(np.full(5, NAN), None, None)


def wall_ahead(scan: Scan) -> float:
    return scan.distance(("-20deg", "20deg"))


def is_wall(scan: Scan) -> bool:
    return wall_ahead(scan) < 0.2


class Walker:
    direct = lambda scan: scan.distance() < 0.2  # noqa: E731
    called = lambda scan: wall_ahead(scan) < 0.2  # noqa: E731
    called_twice = lambda scan: is_wall(scan)  # noqa: E731
    passed_on = lambda scan: min(map(scan.distance, (("-25deg", "0deg"), ("0deg", "10deg")))) < 0.2  # noqa: E731
    each = lambda scan: any(scan.ranges[i] < 0.2 for i in range(5))  # noqa: E731
    part = lambda scan: min(scan.ranges[2:]) < 0.2  # noqa: E731

    def with_lines(scan: Scan) -> bool:  # type: ignore[misc]  # noqa: N805
        def near(angle: float) -> bool:
            for each in (angle, angle + 0.2):
                while (ray := scan.at(each)) is not None:
                    return ray.range < 0.2
            return False

        ranges = scan.ranges
        least = ranges.min()
        if least < 0.2:
            return True
        return near(0.0)

    def forward() -> Drive:  # type: ignore[misc]
        return Drive(0.2)

    def at_wall() -> Drive:  # type: ignore[misc]
        return Drive()

    moves = "\n".join(
        f"forward -> at_wall on {name}"
        for name in ("direct", "called", "called_twice", "passed_on", "each", "part", "with_lines")
    )


@pytest.mark.parametrize("scan", [RANGES, UNKNOWN])
def test_events_have_the_same_reasons_while_their_lines_are_watched(scan: Scan) -> None:
    judged = []
    for watched in (False, True):
        machine, line_watch = Machine(Walker), LineWatch()
        given = {"time": 0.0, "variables": Variables(), "scan": scan}
        for _ in range(2):
            if watched:
                line_watch.step(("Walker", 0), (1, 0.0), machine, given)
            else:
                machine(**given)
        judged.append({name: (one.value, one.text, one.nearest) for name, one in machine.last_step.judged.items()})
    assert judged[0] == judged[1]
    assert len(judged[0]) == 7
    if scan is RANGES:
        assert all(value is False and text and nearest for value, text, nearest in judged[0].values())
    else:
        assert {value for value, _, _ in judged[0].values()} == {None}


def test_the_functions_of_a_machine_are_rewritten_before_its_first_step(monkeypatch: pytest.MonkeyPatch) -> None:
    machine, line_watch = Machine(Walker), LineWatch()
    line_watch.prepare(("Walker", 0), machine)
    monkeypatch.setattr(watch, "rewritten", pytest.fail)
    line_watch.step(("Walker", 0), (1, 0.0), machine, {"time": 0.0, "variables": Variables(), "scan": RANGES})
    assert line_watch.newest
    names = [one.source.name for one in line_watch.newest.calls]
    assert (len(names), names[-2:]) == (8, ["with_lines", "forward"])
    assert all(one.notes for one in line_watch.newest.calls)
    assert line_watch.prepared(("Walker", 0)) is None


def test_the_lines_of_an_event_are_those_of_any_function() -> None:
    machine, line_watch = Machine(Walker), LineWatch()
    line_watch.step(("Walker", 0), (1, 0.0), machine, {"time": 0.0, "variables": Variables(), "scan": RANGES})
    assert line_watch.newest
    call = next(one for one in line_watch.newest.calls if one.source.name == "with_lines")
    lines = {line.code.strip(): line for line in line_texts(call)}
    assert lines["least = ranges.min()"].value == "0.3"
    assert lines["if least < 0.2:"].value == "False  0.30 < 0.20"
    assert lines["return True"].is_reached is False
    assert lines["return near(0.0)"].is_reached
    assert lines["return False"].is_reached  # as all lines of its definition


def test_a_step_that_was_ended_after_it_was_abandoned_says_so_on_its_line() -> None:
    function = made("def step(begun):\n    begun.set()\n    while True:\n        pass\n")
    watch, begun = LineWatch(), threading.Event()
    thread = UserThread(lambda: watch_step(watch, function, begun=begun), "step")
    thread.start()
    begun.wait()
    thread.abandon()
    thread.end()
    thread.join()
    assert watch.newest
    (call,) = watch.newest.calls
    assert call.error == NO_RETURN
    assert call.error_line in (2, 3, 4)


def test_a_step_that_exits_by_itself_says_so_on_its_line() -> None:
    watch = LineWatch()
    with pytest.raises(SystemExit):
        watch_step(watch, made("def step():\n    raise SystemExit('enough')\n"))
    assert watch.newest
    assert watch.newest.calls[0].error == "SystemExit: enough"
