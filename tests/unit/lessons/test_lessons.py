"""The checks of the tasks: a right answer passes, and a wrong one gets a hint about its fault."""

from __future__ import annotations

import builtins
import getpass
import inspect
import itertools
import math
import re
import threading
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from robowidgets import Scan, Touch, feeds, lessons
from robowidgets.behaviors import Drive
from robowidgets.lessons._bounded import Bounded, beyond
from robowidgets.lessons._check import TASKS, judged
from robowidgets.lessons._programs import stop_before_wall
from tests.unit.waiting import wait_for

from ..pages import display_html

NAMES = ["nearest_on_the_left", "fits_through", "stop_at_wall", "bumper_reflex", "slow_in_doorway"]


def check(name: str, answer: Callable[[Any], Any]) -> lessons.Result:
    """The check of an answer under the name of a task."""

    def named(sample: Any) -> Any:
        return answer(sample)

    named.__name__ = name
    return lessons.check(named)


def first_case(answer: Callable[..., Any], task: str, said: str) -> lessons.Result:
    """Return the first result of a task that has this text for an answer; the cases after it take long."""
    results = (judged(answer, task, [case], Bounded()) for case in TASKS[task]())
    found = next((result for result in results if any(said in line for line in result.wrong)), None)
    assert found is not None, lessons.check(answer, task)
    return found


def turn_in_degrees(touch: Touch) -> tuple[float, float]:
    touched = touch.touched
    if None in touched.values():
        return 0.0, 0.0
    return (-0.2, -90 if touched["left"] else 90) if any(touched.values()) else (0.3, 0.0)


def keep_distance(scan: Scan, metres: float = 0.4) -> float:
    """Backs off if it is too close, and if it sees nothing."""
    distance = ahead(scan)
    return 0.2 if distance > metres + 0.05 else 0.0 if distance > metres - 0.05 else -0.3


class TestWrongAnswers:
    @pytest.mark.parametrize("name", NAMES)
    def test_none_is_reported_once_with_the_probable_mistake(self, name: str) -> None:
        result = check(name, lambda _sample: None)
        assert not result
        assert len(result.wrong) == 1
        assert result.wrong[0].endswith("it returned None: does every path through it end with a return?")

    @pytest.mark.parametrize("name", NAMES)
    def test_an_error_is_reported_once_with_its_line_and_not_raised(self, name: str) -> None:
        (line,) = check(name, lambda _sample: 1 / 0).wrong
        assert "it raised an error, line " in line
        assert line.endswith("ZeroDivisionError: division by zero")

    @pytest.mark.parametrize("name", NAMES)
    def test_what_never_returns_is_given_up_and_ended(self, name: str) -> None:
        def forever(_sample: Any) -> float:
            while True:
                pass

        (line,) = check(name, forever).wrong
        assert "a step has not returned for half a second, and was abandoned. A step returns at once: " in line
        wait_for(lambda: all(t.name != "lesson" for t in threading.enumerate()), "no thread is left at work")

    def test_a_loop_that_catches_all_errors_is_ended_too(self) -> None:
        def forever(scan: Scan) -> float:
            while True:
                try:  # noqa: SIM105
                    scan.distance("left")
                except:  # noqa: E722, PERF203
                    pass

        (line,) = check("nearest_on_the_left", forever).wrong
        assert "a step has not returned for half a second, and was abandoned. A step returns at once: " in line
        wait_for(lambda: all(t.name != "lesson" for t in threading.enumerate()), "no thread is left at work")

    @pytest.mark.parametrize("name", NAMES)
    @pytest.mark.parametrize("answer", ["0.4", [], {}, np.zeros(3), object()])
    def test_what_is_not_an_answer_is_reported_once_with_what_was_expected(self, name: str, answer: Any) -> None:
        (line,) = check(name, lambda _sample: answer).wrong
        assert "it returned " in line
        assert "expected " in line

    def test_what_raises_only_when_it_is_looked_at_is_reported_too(self) -> None:
        class Odd:
            def __repr__(self) -> str:
                raise KeyError

            __iter__ = __float__ = __eq__ = __repr__  # type: ignore[assignment]

        def yields(_touch: Touch) -> Any:
            yield 1 / 0

        for answer in (Odd(), 10**400, 10**5000):
            for name in NAMES:
                (line,) = check(name, lambda _sample, answer=answer: answer).wrong
                assert "it returned " in line
                assert "expected " in line
        assert "it returned <generator object " in check("bumper_reflex", yields).wrong[0]

    def test_a_misspelt_name_is_reported_with_the_right_one(self) -> None:
        (line,) = check("nearest_on_the_left", lambda scan: scan.distence("left")).wrong
        assert line.endswith("AttributeError: 'Scan' object has no attribute 'distence'; did you mean 'distance'?")

    def test_a_notebook_gets_a_list_in_which_texts_are_not_markup(self) -> None:
        shown = display_html(check("nearest_on_the_left", lambda _scan: "<b>2</b>"))
        assert shown.startswith("<div>nearest_on_the_left: right in 0 of 8 cases. Still wrong:</div><ul><li>a hall: ")
        assert "&lt;b&gt;2&lt;/b&gt;" in shown

    def test_an_answer_that_asks_for_input_gets_an_error_and_shows_no_prompt(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        asked: list[str] = []

        def ask(prompt: str = "") -> str:
            asked.append(prompt)
            return "0.5"

        monkeypatch.setattr(builtins, "input", ask)
        monkeypatch.setattr(getpass, "getpass", ask)
        for question in (lambda _scan: float(input("metres? ")), lambda _scan: float(getpass.getpass())):
            (line,) = check("nearest_on_the_left", question).wrong
            assert line.endswith("input() cannot ask while a robot waits: write the value into the code")
        assert asked == []
        assert (builtins.input, getpass.getpass) == (ask, ask)

    def test_what_exits_or_interrupts_itself_is_an_error_too(self) -> None:
        def leave(_sample: Any) -> float:
            raise SystemExit(3)

        (line,) = check("fits_through", leave).wrong
        assert "SystemExit" in line

    @pytest.mark.parametrize(
        ("name", "answer", "said"),
        [
            ("nearest_on_the_left", lambda scan: scan.ranges.min(), "you returned nan; it is "),
            ("nearest_on_the_left", lambda scan: scan.distance(), "Look only on the left"),
            ("nearest_on_the_left", lambda scan: scan.ranges[269], "That is ranges[269], at 0°"),
            (
                "nearest_on_the_left",
                lambda scan: float(np.nanmin(scan.ranges[len(scan) * 2 // 3 : len(scan) * 5 // 6], initial=np.inf)),
                "ask for angles, not for a slice",
            ),
            ("fits_through", lambda _scan: True, "you returned True, and the robot would get stuck"),
            ("fits_through", lambda _scan: False, "you returned False, and the robot would fit"),
            ("stop_at_wall", lambda _scan: 0.3, "it hit what is ahead at "),
            ("stop_at_wall", lambda scan: 0.3 * (scan.distance("front") > 0.4), "take a narrower sector"),
            ("stop_at_wall", lambda scan: 0 if scan.distance((-0.3, 0.3)) < 0.4 else 0.3, "no comparison with NaN"),
            ("stop_at_wall", keep_distance, "you returned -0.3 m/s, and the robot drives blind"),
            ("stop_at_wall", lambda _scan: math.nan, "it returned nan m/s"),
            ("slow_in_doorway", lambda scan: 0.3 * scan.distance("front"), "it returned inf m/s"),
            ("stop_at_wall", lambda _scan: 0.05, "after 25 s it still drives at 0.05 m/s"),
            ("stop_at_wall", lambda _scan: 0, "one close on the left: it did not move in 25 s: return a speed above 0"),
            (
                "stop_at_wall",
                lambda scan: 0.3 * (scan.ranges[len(scan) // 2] > 0.5),
                "and the ray straight ahead misses it: one ray is not enough, take a sector as wide as the robot",
            ),
            (
                "stop_at_wall",
                lambda scan: 0.3 * (scan.at("5deg").range > 0.5),
                "a chair leg ahead, to the right: it hit what is ahead",
            ),
            ("bumper_reflex", turn_in_degrees, "14.3 turns per second. Is this number in degrees? math.radians(90)"),
            ("bumper_reflex", lambda _touch: (20.0, 0.0), "20 m/s are 72 km/h. Is this number in centimetres?"),
            ("bumper_reflex", lambda _touch: (math.nan, 0.0), "a speed is a finite number"),
            (
                "nearest_on_the_left",
                lambda scan: scan.distance("left") * 1000,
                "No ray has the range 1985. Is it in millimetres? The answer is in metres",
            ),
            ("nearest_on_the_left", lambda _scan: 0.0, "No ray has the range 0. Is it computed from the scan?"),
            ("bumper_reflex", lambda _touch: (0.3, 0.0), "back up and turn right"),
            ("bumper_reflex", lambda touch: (-0.3 * any(touch.touched.values()), 0.0), "drive forward"),
            ("bumper_reflex", lambda touch: (-0.3 if any(touch.touched.values()) else 0.3, 0), "None means unknown"),
            ("slow_in_doorway", lambda _scan: 0.5, "it drives through the door at 0.50 m/s"),
            ("slow_in_doorway", lambda _scan: 0.2, "in the open it drives at 0.20 m/s"),
            ("slow_in_doorway", lambda scan: 0.2 if scan.distance() < 0.8 else 0.5, "next to a single wall"),
            ("slow_in_doorway", lambda _scan: 0.0, "after 40 s it has come only 0.0 m of 5.5 m"),
        ],
    )  # fmt: skip
    def test_a_usual_mistake_is_distinguished(self, name: str, answer: Callable[[Any], Any], said: str) -> None:
        result = first_case(answer, name, said)
        assert not result
        assert result.sample is not None


def drive_on() -> Drive:
    return Drive(0.2)


def ahead(scan: Scan) -> float:
    return float(scan.distance(("-20deg", "20deg")))


def stop(scan: Scan) -> Drive:
    return Drive(0.2) if ahead(scan) > 0.5 else Drive()


def follow(scan: Scan) -> Drive:
    side = scan.distance(("-60deg", "-40deg"))
    if not ahead(scan) > 0.5:
        return Drive(0, 1.0)
    return Drive(0.2, 0.0 if side > 1.0 else -0.5 if side > 0.6 else 0.5)


def follow_blindly(scan: Scan) -> Drive:
    return Drive(0.2, 0.5) if math.isnan(ahead(scan)) else follow(scan)


class WalksBlindly:
    """Stands still while it sees nothing, but only at first."""

    near = lambda scan: ahead(scan) <= 0.5  # noqa: E731
    clear = lambda scan: ahead(scan) > 0.8  # noqa: E731

    def forward(scan) -> Drive:  # type: ignore[no-untyped-def,misc]  # noqa: N805
        return Drive(0.2 * (ahead(scan) > 0.5))

    def at_wall() -> Drive:  # type: ignore[misc]
        return Drive(0, 1.0)

    def along(scan) -> Drive:  # type: ignore[no-untyped-def,misc]  # noqa: N805
        return Drive(0.2, -0.5 if scan.distance(("-60deg", "-40deg")) > 0.6 else 0.5)

    moves = "forward -> at_wall on near", "at_wall -> along on clear", "along -> at_wall on near"


class WithoutMoves:
    """A machine that lacks something."""

    def forward() -> Drive:  # type: ignore[misc]
        return Drive(0.2)


def back_and_on(scan: Scan, touch: Touch, time: float, state: Any) -> Drive:
    if any(touch.touched.values()):
        state.bumped = time
    since = time - state.get("bumped", -10)
    if since < 2:
        return Drive(-0.2) if since < 1 else Drive(0, 1.0)
    return follow(scan)


def back_alone(touch: Touch, time: float, state: Any) -> Drive:
    if any(touch.touched.values()):
        state.bumped = time
    return Drive(-0.2 if time - state.get("bumped", -10) < 0.5 else 0.2)


def turn_back(touch: Touch, time: float, state: Any) -> Drive:
    """Drive back, turn, turn back, and drive on as before."""
    if any(touch.touched.values()):
        state.bumped = time
    since = time - state.get("bumped", -10)
    return Drive(-0.2) if since < 0.5 else Drive(0, 1) if since < 1.1 else Drive(0, -1) if since < 1.7 else Drive(0.2)


def stay_after_touch(touch: Touch, time: float, state: Any) -> Drive:
    if any(touch.touched.values()):
        state.bumped = time
    since = time - state.get("bumped", -10)
    return Drive(-0.2) if since < 1 else Drive(0.2 * ("bumped" not in state))


def turn_right(scan: Scan) -> Drive:
    """The wall on the left, instead of the right."""
    side = scan.distance(("40deg", "60deg"))
    if not ahead(scan) > 0.5:
        return Drive(0, -1.0)
    return Drive(0.2, 0.0 if side > 1.0 else 0.5 if side > 0.6 else -0.5)


class Stop:
    near = lambda scan: not ahead(scan) > 0.5  # noqa: E731

    def forward() -> Drive:  # type: ignore[misc]
        return Drive(0.2)

    def at_wall() -> Drive:  # type: ignore[misc]
        return Drive()

    moves = "forward -> at_wall on near"


class Misspelt:
    def forward(scann) -> Drive:  # type: ignore[no-untyped-def,misc]  # noqa: N805
        return Drive(scann)

    moves = "forward -> forward after 1"


class TestPrograms:
    """Answers that drive the simulated robot: functions, machines, and either of them at work on a live robot."""

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("task", "answer"),
        [
            ("wall_ahead", ahead),
            ("stop_before_wall", stop),
            ("stop_before_wall", Stop),
            ("follow_wall", follow),
            ("back_off", back_and_on),
        ],
    )
    def test_a_right_answer_is_confirmed(self, task: str, answer: Any) -> None:
        assert str(lessons.check(answer, task)).endswith("Well done!")

    @pytest.mark.parametrize(
        ("task", "answer", "said"),
        [
            ("wall_ahead", lambda scan: scan.distance("front"), "a wall close on the left: you returned "),
            ("wall_ahead", lambda scan: scan.ranges[len(scan) // 2], "One ray is not enough"),
            ("wall_ahead", lambda scan: scan.ranges[200:340].min(), "nan is not a distance"),
            ("stop_before_wall", drive_on, "return Drive() if something is near"),
            ("stop_before_wall", lambda scan: Drive(0.2 * (scan.distance("front") > 0.5)), "take a narrower sector"),
            ("stop_before_wall", lambda scan: Drive(0.2 * (not ahead(scan) < 0.5)), "it drives blind"),
            ("stop_before_wall", lambda scan: Drive(keep_distance(scan, 0.5)), "it drives blind"),
            ("stop_before_wall", lambda time: Drive(0.2 * (time < 2)), "drive closer"),
            ("stop_before_wall", lambda: Drive(0.03), "after 25 s it still drives at 0.03 m/s"),
            ("stop_before_wall", lambda scan: Drive(0.2 * (scan.at(0).range > 0.5)), "one ray is not enough, take a"),
            ("follow_wall", follow_blindly, "a covered scanner, which sends only NaN: it drives blind"),
            ("follow_wall", WalksBlindly, "that is covered on the way: at 21.1 s it drives blind"),
            ("follow_wall", drive_on, "turn left sooner"),
            ("follow_wall", stop, "turn left, and drive on"),
            ("follow_wall", lambda: Drive(0.01), "it has not reached the wall"),
            ("follow_wall", lambda scan: Drive(0.2) if ahead(scan) > 0.5 else Drive(0, 1.0), "turn left when it is"),
            ("follow_wall", lambda time: Drive(0.2) if not 9.5 < time < 11.75 else Drive(0, 1), "turn right when it"),
            ("back_off", follow, "it still pushes 1 s after"),
            ("back_off", back_alone, "it did not turn after it bumped into the box"),
            ("back_off", turn_back, "for the fourth time"),
            ("back_off", lambda time: Drive(0.2 if time < 4 else 0.0), "it did not reach the box"),
            ("back_off", stay_after_touch, "it did not turn after it bumped into the box"),
            ("follow_wall", turn_right, "the wall is not on its right"),
            ("follow_wall", lambda: None, "it did not move in 30 s: does it return a Drive with a speed?"),
            ("follow_wall", lambda: 0.2, "expected a step to return Drive(linear, angular), or None"),
            ("follow_wall", lambda scn: scn, "did you mean scan?"),
            ("follow_wall", Misspelt, "Misspelt.forward asks for 'scann'; "),
            ("follow_wall", lambda: Drive(1 / 0), "ZeroDivisionError"),
            ("follow_wall", int, "class int has no 'moves'"),
            ("follow_wall", WithoutMoves, "class WithoutMoves has no 'moves' between its states; "),
        ],
    )  # fmt: skip
    def test_a_usual_mistake_is_distinguished(self, task: str, answer: Any, said: str) -> None:
        assert not first_case(answer, task, said)

    @pytest.mark.slow
    @pytest.mark.parametrize("answer", [stop, Stop])
    def test_one_that_drives_a_live_robot_is_checked_on_another(self, answer: Any) -> None:
        with feeds.simulator(wander=False) as robot:
            program = robot.program(answer)
            assert lessons.check(program, "stop_before_wall")
            assert program.mode == "running"

    @pytest.mark.slow
    def test_a_speed_beyond_the_limits_of_a_live_robot_is_cut_as_there(self) -> None:
        def fast(scan: Scan) -> Drive:  # from 1.2 m/s, the top speed of the motors, it would take 0.7 m to stop
            return Drive(9.0) if scan.distance("front") > 0.66 else Drive()

        result = lessons.check(fast, "stop_before_wall")
        assert not [line for line in result.wrong if "it hit" in line], result

    @pytest.mark.slow
    def test_a_wrong_limit_is_not_blamed_on_the_obstacle_ahead(self) -> None:
        for limit in (0.62, 0.65):
            result = lessons.check(lambda scan, limit=limit: Drive(0.2 * (ahead(scan) > limit)), "stop_before_wall")
            assert result.wrong
            for line in result.wrong:
                assert "m: drive closer; or, if it stopped for" in line or line.endswith("m: drive closer")
                assert " 0°" not in line

    def test_a_machine_stuck_in_its_first_state_gets_that_hint_and_not_one_about_speed(self) -> None:
        class Backwards:
            near = Stop.near

            def at_wall() -> Drive:  # type: ignore[misc]
                return Drive()

            def forward() -> Drive:  # type: ignore[misc]
                return Drive(0.2)

            moves = Stop.moves

        (line,) = lessons.check(Backwards, "stop_before_wall").wrong
        assert "it begins in the state at_wall, the first in its class, and never left this state" in line
        assert "speed" not in line

    @pytest.mark.slow
    def test_a_helper_that_is_first_in_a_machine_is_not_its_first_state(self) -> None:
        class Helped:
            def straight() -> Drive:  # type: ignore[misc]
                return Drive()

            near, forward, at_wall = Stop.near, Stop.forward, Stop.at_wall
            moves = Stop.moves

        assert lessons.check(Helped, "stop_before_wall")
        Helped.forward = lambda: Drive(0.2)  # type: ignore[method-assign]
        Helped.at_wall = lambda: Drive(0.2)  # type: ignore[method-assign]
        assert "no move leads to the state Helped › straight" in lessons.check(Helped, "stop_before_wall").wrong[0]

    def test_an_endless_loop_is_given_up_with_its_line(self) -> None:
        class Waits:
            def forever() -> None:  # type: ignore[misc]
                while True:
                    pass

            moves = "forever -> forever after 1"

        (line,) = lessons.check(Waits, "back_off").wrong
        first = Waits.forever.__code__.co_firstlineno
        assert re.search(rf": line {first + 1}|{first + 2}: a step has not returned for half a second", line)

    def test_steps_that_each_return_in_time_may_not_take_longer_than_a_case(self) -> None:
        now = [0.0]

        def slow(scan: Scan) -> Drive:
            now[0] += 0.0625
            return stop(scan)

        bounded = Bounded(lambda: now[0])
        result = judged(slow, "stop_before_wall", stop_before_wall(), bounded)
        (line,) = result.wrong
        assert "a wall ahead: its 161 steps took 10 s, 0.062 s each. A step returns at once" in line

    @pytest.mark.slow
    def test_a_busy_computer_that_delays_most_steps_is_not_blamed_on_the_answer(self) -> None:
        now, steps = [0.0], itertools.count()

        def held_up(scan: Scan) -> Drive:
            now[0] += 0.25 if next(steps) % 8 else 0.0
            return stop(scan)

        assert judged(held_up, "stop_before_wall", stop_before_wall(), Bounded(lambda: now[0]))

    def test_a_step_that_waits_is_given_up_after_half_a_second_of_the_clock_and_no_sooner(self) -> None:
        waits, ends, now = threading.Event(), threading.Event(), [0.0]

        def clock() -> float:
            if waits.is_set():
                now[0] += 0.05
            return now[0]

        def sleep() -> Drive:
            waits.set()
            ends.wait(60)
            return Drive(0.2)

        result = judged(sleep, "stop_before_wall", stop_before_wall(), Bounded(clock))
        ends.set()
        assert "a step has not returned for half a second" in result.wrong[0]
        assert 0.45 <= now[0] <= 0.55

    @pytest.mark.slow
    def test_swapped_angles_are_named_once_instead_of_other_advice(self) -> None:
        def swapped(scan: Scan) -> float:
            return scan.distance(("20deg", "-20deg"))

        with warnings.catch_warnings():
            warnings.simplefilter("error")
            first, *others = lessons.check(swapped, "wall_ahead").wrong
        assert '("20deg", "-20deg") covers 320°' in first
        assert len(others) == 7
        assert not any("covers" in line or "One ray" in line or "for angles" in line for line in others)

        def drive(scan: Scan) -> Drive:
            return Drive(0.2 * (swapped(scan) > 0.5))

        assert not first_case(drive, "stop_before_wall", "are the two swapped?")

    @pytest.mark.parametrize(
        ("value", "low", "high", "shown"),
        [
            (0.2951, 0.3, 0.7, "0.295"),
            (0.7049, 0.3, 0.7, "0.705"),
            (0.29999, 0.3, 0.7, "0.29999"),
            (1.0, 0.3, 0.7, "1.00"),
        ],
    )
    def test_a_number_beyond_a_limit_has_the_decimals_that_show_it(
        self, value: float, low: float, high: float, shown: str
    ) -> None:
        assert beyond(value, low, high) == shown


class TestResult:
    def test_a_right_answer_is_true_and_says_so(self) -> None:
        result = check("nearest_on_the_left", lambda scan: scan.distance("left"))
        assert result
        assert (result.wrong, result.sample) == ((), None)
        assert repr(result) == "nearest_on_the_left: right in all 8 cases. Well done!"

    def test_a_wrong_one_has_a_line_for_each_case_and_the_first_scan(self) -> None:
        result = check("fits_through", lambda _scan: True)
        head, *lines = repr(result).splitlines()
        assert head == "fits_through: right in 4 of 9 cases. Still wrong:"
        assert [line[:4] for line in lines[:6]] == [*["  - "] * 5, "a ga"]
        assert isinstance(result.sample, Scan)

    def test_a_task_is_found_by_the_name_of_the_function(self) -> None:
        with pytest.raises(ValueError, match=r"no task is called 'stop'; .*; name the task, as in check\(stop, '"):
            check("stop", lambda _scan: 0.0)
        with pytest.raises(ValueError, match=r"check: no task is called 'stop_wall'; the tasks are .*, back_off$"):
            lessons.check(stop, "stop_wall")
        with pytest.raises(TypeError, match=r"expected the function that answers a task, without brackets, got 0\.4"):
            lessons.check(0.4)  # type: ignore[arg-type]

    def test_an_example_is_what_the_answer_gets(self) -> None:
        assert isinstance(lessons.example("stop_at_wall"), Scan)
        assert isinstance(lessons.example("bumper_reflex"), Touch)
        with pytest.raises(ValueError, match="example: no task is called 'none'"):
            lessons.example("none")

    def test_the_last_three_lines_that_a_function_prints_are_shown_with_the_result(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        printed: list[str] = []

        def answer(_touch: Touch) -> tuple[float, float]:
            printed.append(f"<{len(printed)}>")
            print(printed[-1])  # noqa: T201
            return 0.0, 0.0

        result = check("bumper_reflex", answer)
        assert len(printed) == 11
        assert result.prints == ("<8>", "<9>", "<10>")
        assert repr(result).endswith("\nIt printed last:\n  <8>\n  <9>\n  <10>")
        assert display_html(result).endswith("<div>It printed last:</div><pre>&lt;8&gt;\n&lt;9&gt;\n&lt;10&gt;</pre>")
        assert capsys.readouterr().out == ""

    def test_what_a_function_prints_without_an_end_of_its_line_is_shown_too(self) -> None:
        def answer(touch: Touch) -> tuple[float, float]:
            for name in touch.touched:
                print(name, end=" ")  # noqa: T201
            return 0.0, 0.0

        assert check("bumper_reflex", answer).prints == ("left center right ",) * 3


def blind_drive(scan: Scan) -> Drive:
    front = scan.distance("front")
    if front < 0.1:
        return Drive()
    return Drive(0.2)


class Walker:
    near = lambda scan: scan.distance("front") < 0.1  # noqa: E731

    def forward() -> Drive:  # type: ignore[misc]
        return Drive(0.2)

    def at_wall() -> Drive:  # type: ignore[misc]
        return Drive()

    moves = "forward -> at_wall on near"


def line_in(function: Callable[..., Any], text: str) -> int:
    """The number of the line in this file with a text, in a function."""
    lines, first = inspect.getsourcelines(function)
    return next(first + i for i, line in enumerate(lines) if text in line)


class TestLines:
    def test_the_first_wrong_case_is_shown_on_the_lines_of_the_answer(self) -> None:
        def fits_through(scan: Scan) -> bool:
            front = scan.distance(("-1deg", "1deg"))
            if front > 5.0:
                return False
            return front > 1.5

        result = lessons.check(fits_through)
        heading, *lines = str(result.lines).splitlines()
        missed = f"line {line_in(fits_through, 'return False')} was not reached"
        assert heading == f"a gap of 0.4 m, line by line: in this scan `front` was 2.99 m, {missed}"
        assert re.fullmatch(r" *\d+ +front = scan\.distance\(.* 2\.99 m  \[271\]", lines[1])
        assert re.fullmatch(r" *\d+ +if front > 5\.0: +False  2\.99 > 5\.00", lines[2])
        assert lines[3].endswith("not reached")
        assert lines[4].endswith("True  2.99 > 1.50")
        assert repr(result).endswith(f"\n{result.lines}")
        shown = display_html(result)
        assert "<code>front</code> was 2.99 m" in shown
        assert "front &gt; 5.0" in shown

    def test_a_line_that_only_late_rays_reach_is_shown_with_its_last_value(self) -> None:
        def wall_ahead(scan: Scan) -> float:
            nearest = scan.ranges[0]
            for i in range(len(scan.ranges)):
                if scan.ranges[i] < nearest:
                    nearest = scan.ranges[i]
            return float(nearest)

        result = lessons.check(wall_ahead)
        assert result.wrong
        (line,) = (row for row in str(result.lines).splitlines() if re.search(r" nearest = scan\.ranges\[i\] ", row))
        assert re.search(r"  [\d.]+  \N{MULTIPLICATION SIGN}\d+$", line)

    def test_each_name_and_each_test_of_a_line_has_its_own_value(self) -> None:
        def wall_ahead(scan: Scan) -> float:
            left, right = scan.distance("left"), scan.distance("right")
            half = left / 2; return right if half else left  # noqa: E702  # fmt: skip

        def tested(scan: Scan) -> float:
            if scan.distance("left") > 0.3: return 5.0  # noqa: E701  # fmt: skip
            return 4.0

        lines = lessons.check(wall_ahead).lines
        assert lines
        assert lines.summary == "in this scan `left` was 3.51 m, `right` was 3.54 m, `half` was 1.757"
        lines = lessons.check(tested, "wall_ahead").lines
        assert lines
        assert lines.summary.startswith('in this scan `scan.distance("left") > 0.3` was True (3.51 > 0.30), line')

    def test_of_a_drive_the_last_step_is_shown_with_its_time(self) -> None:
        result = lessons.check(blind_drive, "stop_before_wall")
        found = re.match(r"a wall ahead: it hit what is ahead at ([\d.]+) s", result.wrong[0])
        assert found
        assert result.lines
        assert f"at {float(found[1]) - 0.1:.1f} s `front` was 0.1" in result.lines.summary
        assert result.lines.summary.endswith(f"line {line_in(blind_drive, 'return Drive()')} was not reached")

    def test_of_a_drive_the_step_with_the_fault_is_shown_and_not_the_last(self) -> None:
        result = check("slow_in_doorway", lambda scan: 0.2 if scan.distance("front") < 0.01 else 0.5)
        assert result.lines
        assert re.match(r"at [56]\.\d s ", result.lines.summary)  # in the door, 3 m away

    def test_of_a_machine_the_events_and_the_active_state_are_shown(self) -> None:
        lines = str(lessons.check(Walker, "stop_before_wall").lines).splitlines()
        near, state = (next(line for line in lines if text in line) for text in ("near = lambda", "return Drive(0.2)"))
        assert re.search(r"False  \[\d+\]  0\.1\d < 0\.10$", near)
        assert state.endswith("  Drive(0.2)")
        assert not any("at_wall()" in line for line in lines)

    def test_an_error_and_a_call_that_does_not_return_are_shown_on_their_lines(self) -> None:
        def raises(scan: Scan) -> float:
            number = len(scan) - 541
            return 1 / number

        def forever(scan: Scan) -> float:
            number = len(scan)
            while True:
                number += 1

        lines = str(check_named(raises).lines)
        assert "`number` was 0" in lines
        assert lines.endswith("! ZeroDivisionError: division by zero")
        lines = str(check_named(forever).lines)
        assert re.search(r"\.\.\. and \d+ more passes", lines)
        assert "it was still here" in lines
        assert "SystemExit" not in lines

    def test_texts_are_not_markup(self) -> None:
        def answer(_scan: Scan) -> Any:
            text = "<b>2</b>"
            return [text]

        shown = display_html(check_named(answer))
        assert "<b>" not in shown
        assert "<code>text</code> was &#x27;&lt;b&gt;2&lt;/b&gt;&#x27;" in shown

    def test_an_answer_without_a_source_says_why_it_has_no_lines(self) -> None:
        lines = lessons.check(eval("lambda scan: 2"), "wall_ahead").lines
        assert str(lines) == "a wall ahead, line by line\n  <lambda> shows no values: its source is not known"

    def test_a_right_answer_has_no_lines_nor_has_one_that_was_never_called(self) -> None:
        assert check("nearest_on_the_left", lambda scan: scan.distance("left")).lines is None
        assert lessons.check(lambda scam: scam, "stop_before_wall").lines is None


def check_named(answer: Callable[..., Any]) -> lessons.Result:
    return lessons.check(answer, "nearest_on_the_left")
