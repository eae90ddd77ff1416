"""The lines of functions over a recording, and where two versions decide otherwise."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import pytest

import robowidgets
from robowidgets import SAMPLE
from robowidgets.behaviors import Drive
from robowidgets.recording import Recording


@pytest.fixture(scope="module")
def recording() -> Iterator[Recording]:
    with robowidgets.open(SAMPLE) as opened:
        yield opened


def near(scan):  # type: ignore[no-untyped-def]
    front = scan.distance("front")
    if front < 0.6:  # noqa: SIM103
        return True
    return False


FIRST = near.__code__.co_firstlineno


def nearer(scan):  # type: ignore[no-untyped-def]
    front = scan.distance("front")
    if front < 0.9:  # noqa: SIM103
        return True
    return False


def program(scan, state, time):  # type: ignore[no-untyped-def]
    state.n = state.setdefault("n", 0) + 1
    if scan.distance() < 0.5:
        return Drive(0, 0.5)
    return None


def test_a_line_was_true_when_find_says_so(recording: Recording) -> None:
    lines = recording.lines(near)
    found = recording.find(lambda scan: scan.distance("front") < 0.6)
    spans = lines.when(FIRST + 2)
    assert spans.condition == f"line {FIRST + 2} was true"
    assert [(span.start_ns, span.end_ns) for span in spans] == [(span.start_ns, span.end_ns) for span in found]
    assert [span.start for span in lines.when(FIRST + 3)] == [span.start for span in spans]
    assert lines.when(FIRST + 1).condition == f"line {FIRST + 1} was reached"


def test_the_values_of_a_moment_are_those_of_its_scan(recording: Recording) -> None:
    lines = recording.lines(near)
    for seconds in (0.5, 12.34, 50):
        step = lines.at(seconds)
        scan = recording.at("/scan", seconds).sample
        assert step[FIRST + 1] == f"{scan.distance('front'):.2f} m"
        assert step.returned == (scan.distance("front") < 0.6)
    assert "front = scan.distance(" in repr(lines.at(1))
    assert "not reached" in repr(lines.at(1))


def test_a_line_that_only_late_passes_of_a_loop_reach_has_its_value(recording: Recording) -> None:
    def late(scan):  # type: ignore[no-untyped-def]
        for i in range(len(scan.ranges)):
            if i > 300:
                k = i
        return k

    step = recording.lines(late).at(10)
    last = len(recording.at("/scan", 10).sample) - 1
    assert step[late.__code__.co_firstlineno + 3] == str(last)
    assert f" {last}  \N{MULTIPLICATION SIGN}{last - 300}\n" in repr(step)


def test_a_program_is_stepped_through_time_with_its_state(recording: Recording) -> None:
    lines = recording.lines(program, rate=5)
    count = program.__code__.co_firstlineno + 1
    at = [int(lines.at(seconds)[count]) for seconds in (2, 3, 2)]
    assert at == [at[0], at[0] + 5, at[0]]
    assert lines.error == ""


def test_a_function_of_one_moment_has_lines_too(recording: Recording) -> None:
    lines = recording.lines(lambda moment: moment.scan.distance() < 0.5 and moment.speed.linear[0] > 0)
    assert len(lines) > 500
    assert "< 0.50" in repr(lines.at(9))
    assert str(len(lines)) in repr(lines)


def test_what_fails_says_when_and_where(recording: Recording) -> None:
    def fails(scan, time):  # type: ignore[no-untyped-def]
        later = 1 if time < 3 else 0
        return Drive(1 / later)

    lines = recording.lines(fails)
    assert lines.error == "ZeroDivisionError: division by zero at 3.00 s"
    step = lines.at(50)
    assert (step.error, step.seconds) == ("ZeroDivisionError: division by zero", 3.0)
    assert step[fails.__code__.co_firstlineno + 1] == "0"
    assert "! ZeroDivisionError" in repr(step)


def test_a_step_that_returns_no_speed_says_so(recording: Recording) -> None:
    def wrong(scan, time):  # type: ignore[no-untyped-def]
        return 3 if time > 2 else Drive(0.1)

    lines = recording.lines(wrong)
    assert lines.error.startswith("TypeError: expected a step to return Drive(linear, angular)")
    assert lines.at(50).error in lines.error
    assert repr(lines.at(50)).endswith("got 3")


def test_all_functions_of_a_machine_have_their_lines(recording: Recording) -> None:
    class Walker:
        def forward(scan):  # type: ignore[no-untyped-def] # noqa: N805
            return Drive(0.1)

        def turn(time):  # type: ignore[no-untyped-def] # noqa: N805
            return Drive(0, 0.3)

        moves = "forward -> turn after 2"

    lines = recording.lines(Walker)
    forward, turn = Walker.forward.__code__.co_firstlineno, Walker.turn.__code__.co_firstlineno
    assert [round(lines.when(line + 1)[0].start) for line in (forward, turn)] == [0, 2]
    assert "Drive(0.1)" in repr(lines)
    assert "Drive(0, 0.3)" in repr(lines)


def test_a_line_without_code_and_a_time_before_the_first_step_are_refused(recording: Recording) -> None:
    lines = recording.lines(near)
    with pytest.raises(ValueError, match=f"line with code, {FIRST + 1} to {FIRST + 4}, got 1"):
        lines.when(1)
    with pytest.raises(ValueError, match=r"no step was made up to -1 s; the first one is at"):
        lines.at(-1)
    with pytest.raises(TypeError):
        lines.at("now")  # type: ignore[arg-type]


def test_something_else_than_a_function_or_a_recording_is_refused(recording: Recording) -> None:
    show = partial(recording.show, lines=3)
    for call, given in ((recording.lines, None), (recording.lines, "near"), (show, "/scan")):
        with pytest.raises(TypeError, match=r"lines: expected a program, or a function of .*, got (None|'near'|3)$"):
            call(given)
    for given in (None, robowidgets.SAMPLE, near):
        with pytest.raises(TypeError, match=r"a recording, as from robowidgets.open\(path\), got .* as the recording"):
            robowidgets.decisions(near, near, given)  # type: ignore[arg-type]


def test_a_function_without_a_source_says_so(recording: Recording) -> None:
    namespace: dict[str, object] = {}
    exec("def hidden(scan):\n    return scan.distance() < 0.5", namespace)
    assert "its source is not known" in repr(recording.lines(namespace["hidden"]))


def test_two_versions_differ_where_only_the_new_limit_is_met(recording: Recording) -> None:
    found = robowidgets.decisions(near, nearer, recording)
    first = found[0]
    assert (first.old, first.new) == (False, True)
    assert first.line == nearer.__code__.co_firstlineno + 2
    assert first.old_value.startswith("False ")
    assert first.new_value.startswith("True ")
    both = recording.find(lambda scan: 0.6 <= scan.distance("front") < 0.9)
    assert [span.start_ns for span in found.spans] == [span.start_ns for span in both]
    assert "old value" in repr(found)


def test_two_programs_are_compared_by_the_speeds_in_force(recording: Recording) -> None:
    def stays(scan, state, time):  # type: ignore[no-untyped-def]
        state.n = 0
        if scan.distance() < 0.5:
            return Drive(0, 0.5)
        return None

    assert len(robowidgets.decisions(program, stays, recording)) == 0
    found = robowidgets.decisions(program, lambda time: Drive(0.2 if time < 5 else 0), recording)
    assert found.steps[1] > 0
    assert found.spans[0].start == found[0].start
