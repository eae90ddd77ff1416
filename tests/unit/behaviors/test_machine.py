"""State machines: their active states, their actions, and the states that a new version keeps. In simulated time."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from robowidgets import conditions
from robowidgets.behaviors import Drive, Machine, Variables
from robowidgets.behaviors.variables import ProgramState
from robowidgets.feeds import Feed
from robowidgets.samples import Scan, Speed

from ..feeds.scripted import CMD_VEL, Scripted
from ..waiting import wait_for

# ruff: noqa: E731, N801, N805


class Run:
    """A machine and its steps."""

    def __init__(self, cls: type) -> None:
        self.machine = Machine(cls)
        self.variables = Variables()
        self.state = ProgramState(log=[])

    def at(self, time: float, **values: Any) -> tuple[str, ...]:
        """Make a step; return the active states."""
        known = {"time": time, "variables": self.variables, "state": self.state, **values}
        self.drive = self.machine(**{name: known[name] for name in self.machine.asks_for})
        return self.machine.active


def test_moves_after_a_time_at_once_on_an_event_and_from_any_state() -> None:
    class Walker:
        def halted(variables):
            return variables.halt

        forward = pause = halt = turn = None
        moves = """
            forward -> pause after 0.5   # seconds
            pause -> turn at once
            turn -> forward after wait
            * -> halt on halted
        """

    run = Run(Walker)
    run.variables.halt, run.variables.wait = False, 1.0
    assert [run.at(t)[0] for t in (0.0, 0.4, 0.5, 0.6, 1.5)] == ["forward", "forward", "turn", "turn", "forward"]
    run.variables.halt = True
    assert run.at(1.6) == run.at(9.0) == ("halt",)
    assert [(m.source, m.target, m.why) for m in run.machine.fired] == [
        ("forward", "pause", "after 0.5"),
        ("pause", "turn", "at once"),
        ("turn", "forward", "after wait"),
        ("forward", "halt", "on halted"),
    ]


@pytest.mark.parametrize("rate", [3, 10, 30])
def test_a_time_that_ends_exactly_at_a_step_is_not_missed_by_rounding(rate: int) -> None:
    class Clock:
        tick = tock = None
        moves = "tick -> tock after 1", "tock -> tick after 1"

    run = Run(Clock)
    active = [run.at(0.1 + number / rate) for number in range(60 * rate)]
    assert active == [("tick" if number // rate % 2 == 0 else "tock",) for number in range(60 * rate)]


def test_entry_running_and_exit_run_outer_states_first_and_inner_ones_are_left_first() -> None:
    def note(word: str) -> Any:
        return lambda state: state.log.append(word)

    class Walker:
        class a:
            entry, running, exit = note("enter a"), note("a"), note("leave a")

            class inner:
                entry, running, exit = note("enter inner"), note("inner"), note("leave inner")

            rest = None
            moves = "inner -> rest after 1e9"

        b = note("b")
        moves = "a -> b after 1"

    run = Run(Walker)
    run.at(0.0)
    run.at(1.0)
    assert run.state.log == ["enter a", "enter inner", "a", "inner", "leave inner", "leave a", "b"]


def test_machines_run_side_by_side_and_done_waits_for_all() -> None:
    class Walker:
        class both:
            class one:
                a = b = None
                moves = "a -> b after 1"

            class two:
                c = d = None
                moves = "c -> d after 2"

        after = None
        moves = "both -> after on done"

    run = Run(Walker)
    assert run.at(0.0) == ("both", "both.one.a", "both.two.c")
    assert run.at(1.0) == ("both", "both.one.b", "both.two.c")
    assert run.at(2.0) == ("both", "both.one.b", "both.two.d")
    assert run.at(2.1) == ("after",)


def test_the_last_speed_that_a_state_returns_is_sent_and_none_keeps_it() -> None:
    class Walker:
        def running():
            return Drive(0.1)

        class a:
            def running():
                return None

        def b(since):
            return Drive(since)

        moves = "a -> b after 1"

    run = Run(Walker)
    run.at(0.0)
    assert run.drive == Drive(0.1)
    run.at(1.0)
    run.at(1.5)
    assert run.drive == Drive(0.5)


def test_a_condition_may_be_an_event() -> None:
    class Walker:
        near = conditions.nearest_below(0.5)
        forward = stop = None
        moves = "forward -> stop on near"

    run = Run(Walker)
    assert run.machine.asks_for == ["time", "variables", "scan"]
    assert run.at(0.0, scan=Scan([1.0], 0.0, 0.1, 0.1, 9.0)) == ("forward",)
    assert run.at(0.1, scan=Scan([0.4], 0.0, 0.1, 0.1, 9.0)) == ("stop",)
    said = run.machine.last_step.judged["Walker", "near"]
    assert (said.value, said.text) == (True, "0.40 < 0.50 m")


def test_an_event_without_a_distance_is_unknown_unless_it_moves_the_machine() -> None:
    class Walker:
        def near(scan):
            return scan.distance() < 0.5

        def not_free(scan):
            return not scan.distance() > 0.5

        forward = stop = None
        moves = "forward -> stop on near", "forward -> stop on not_free"

    run = Run(Walker)
    assert run.at(0.0, scan=Scan([float("nan")], 0.0, 0.1, 0.1, 9.0)) == ("stop",)
    said = run.machine.last_step.judged
    assert (said["Walker", "near"].value, said["Walker", "not_free"].value) == (None, True)


def test_a_new_version_keeps_what_is_active_and_still_exists() -> None:
    class Walker:
        forward = None

        class avoid:
            stop = turn = None
            moves = "stop -> turn after 1"

        moves = "forward -> avoid after 1"

    entered: list[str] = []

    class Newer:
        forward = None

        class avoid:
            def entry():
                entered.append("avoid")

            turn = wait = None
            moves = "turn -> wait after 3"

        moves = "forward -> avoid after 1"

    Newer.__name__ = "Walker"

    class Newest:
        forward = rest = None
        moves = "forward -> rest after 1"

    Newest.__name__ = "Walker"
    run = Run(Walker)
    assert [run.at(t) for t in (0.0, 1.0, 2.0)][-1] == ("avoid", "avoid.turn")
    for cls, time, active in ((Newer, 3.0, ("avoid", "avoid.turn")), (Newest, 3.5, ("forward",))):
        machine = Machine(cls)
        machine.adopt(run.machine)
        run.machine = machine
        assert run.at(time) == active
        if cls is Newer:
            assert machine.note == ""
            assert run.at(4.9) == ("avoid", "avoid.turn")
            assert run.at(5.0) == ("avoid", "avoid.wait")
    assert entered == []
    assert run.machine.note == "the state avoid is gone: forward takes over"
    step = run.machine.last_step
    assert step.states == {"Walker": ("forward", 3.5)}, "what was active in a state that is gone is gone, too"
    assert {span.path for span in step.left} >= {"Walker.forward", "Walker.avoid", "Walker.avoid.wait"}
    assert (1.0, 3.5, "Walker.avoid") in step.left


def test_versions_that_make_no_step_lose_nothing() -> None:
    class Walker:
        a = b = None
        moves = "a -> b after 1"

    run = Run(Walker)
    assert [run.at(t) for t in (0.0, 1.0)] == [("a",), ("b",)]
    for _ in range(3):
        before, run.machine = run.machine, Machine(Walker)
        run.machine.adopt(before)
    assert run.machine.active == run.at(2.0) == ("b",)
    assert [move.target for move in run.machine.fired] == ["b"]


def test_a_function_that_no_move_names_is_a_state_and_the_first_one_is_the_initial_one() -> None:
    class Walker:
        def forced(variables):
            return variables.stop

        def forward():
            return Drive(0.2)

        def stop():
            return Drive()

        moves = "* -> stop on forced"

    run = Run(Walker)
    run.variables.stop = False
    assert (run.at(0.0), run.drive) == (("forward",), Drive(0.2))
    run.variables.stop = True
    assert (run.at(0.1), run.drive) == (("stop",), Drive())
    assert run.machine.note == ""


def test_a_state_stays_active_when_the_only_move_that_named_it_is_taken_out() -> None:
    class Walker:
        def rest():
            return Drive()

        def forward():
            return Drive(0.2)

        moves = "rest -> forward after 1"

    class Edited(Walker):
        moves = "* -> rest on near"

        def near(variables):
            return variables.near

    Edited.__name__ = "Walker"
    run = Run(Walker)
    run.variables.near = False
    assert [run.at(t)[0] for t in (0.0, 1.0)] == ["rest", "forward"]
    before, run.machine = run.machine, Machine(Edited)
    run.machine.adopt(before)
    assert run.at(1.1) == ("forward",)


def test_a_class_with_actions_that_no_move_names_is_a_state_and_events_of_inner_machines_are_not() -> None:
    class Walker:
        def near(variables):
            return variables.near

        def _far(x):
            return x

        class forward:
            def running():
                return Drive(0.3)

        class avoid:
            turn = back = None
            moves = "turn -> back on near"

        moves = "* -> avoid after 2"

    run = Run(Walker)
    run.variables.near = True
    assert (run.at(0.0), run.drive) == (("forward",), Drive(0.3))
    assert run.at(2.0) == ("avoid", "avoid.turn")
    assert run.at(2.1) == ("avoid", "avoid.back")


def test_what_no_move_names_is_reported() -> None:
    class Walker:
        free = lambda scan: scan.distance() > 1

        def forward():
            return Drive(0.2)

        def near(scan):
            return scan.distance() < 1

        stop = None
        moves = "forward -> stop after 1"

    machine = Machine(Walker)
    assert machine.note == (
        "no move leads to the state Walker › near; no move names Walker.free: a lambda is an event, def free() a state"
    )
    assert machine.root.machines[0].initial == "forward"


def test_a_helper_that_is_first_is_not_the_initial_state_if_no_move_leads_out_of_it() -> None:
    class Walker:
        def slow(time):
            return Drive(0.1)

        def forward():
            return Drive(0.2)

        stop = None
        moves = "forward -> stop after 1"

    run = Run(Walker)
    assert (run.at(0.0), run.drive) == (("forward",), Drive(0.2))
    assert run.machine.note == "no move leads to the state Walker › slow"


def test_an_event_that_no_move_names_gets_its_own_error_when_it_is_taken_for_the_initial_state() -> None:
    class Walker:
        def near(scan):
            return scan.distance() < 1

        stop = go = None
        moves = "* -> go after 1"

    words = r"Walker › near returned True: expected a Drive, .*; a function is an event where a move names it"
    with pytest.raises(TypeError, match=words):
        Run(Walker).at(0.0, scan=Scan([0.4], 0.0, 0.1, 0.1, 9.0))


def test_an_event_that_asks_for_something_new_names_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    class Walker:
        a = b = None
        moves = "a -> b on bumped"

    run = Run(Walker)
    for event in (lambda touch: touch.touched["left"], conditions.touched("left")):
        monkeypatch.setitem(globals(), "bumped", event)
        with pytest.raises(TypeError, match=r"asks for 'touch', which it did not .*: run the machine's cell again"):
            run.at(0.0)


def bumped(time: float) -> bool:
    """An event of the notebook that a test redefines."""
    return time < 0


def test_after_an_error_it_goes_on_in_its_states() -> None:
    class Walker:
        a = None

        class b:
            def entry(variables):
                return 1 / variables.x

            c = d = None
            moves = "c -> d after 1"

        moves = "a -> b after 1"

    run = Run(Walker)
    run.variables.x = 0
    run.at(0.0)
    with pytest.raises(ZeroDivisionError):
        run.at(1.0)
    assert run.at(1.1) == ("b", "b.c")
    assert run.at(2.1) == ("b", "b.d")


def test_a_machine_may_inherit_from_another() -> None:
    class Walker:
        def a():  # type: ignore[no-untyped-def, misc]
            return Drive(0.1)

        b = None
        moves = "a -> b after 1"

    class Faster(Walker):
        def a():  # type: ignore[no-untyped-def, misc]
            return Drive(0.2)

    run = Run(Faster)
    assert (run.at(0.0), run.drive) == (("a",), Drive(0.2))
    assert run.at(1.0) == ("b",)


def test_a_missing_time_is_named() -> None:
    class Walker:
        a = b = None
        moves = "a -> b after pause"

    with pytest.raises(LookupError, match="'pause' is not in class Walker, around it, or in the notebook; define it"):
        Run(Walker).at(0.0)


class Leaf:
    """A state with a misspelt action."""

    def entri() -> None:  # type: ignore[misc]
        """Never called."""

    def running() -> None:  # type: ignore[misc]
        """Called at each step."""


class Inner:
    """A machine."""

    c = d = None
    moves = "c -> d after 1"


def forward() -> Drive:
    """A state."""
    return Drive(0.2)


def clip(value: float) -> float:
    """Neither a state nor an event."""
    return max(value, 1)


@pytest.mark.parametrize(
    ("members", "error", "words"),
    [
        (
            {"moves": "a -> b on"},
            ValueError,
            r"moves of Walker: expected 'state -> state on event', .*; got 'a -> b on'",
        ),
        ({"a": None, "moves": "a -> b"}, ValueError, "got 'a -> b'"),
        ({"a": None, "turn": None, "moves": "a -> trun after 1"}, TypeError, "no state 'trun' .*did you mean turn?"),
        ({"a": None, "b": None, "moves": "a -> b on near"}, TypeError, "'near' is not in class Walker, around it"),
        ({"a": 3, "b": None, "moves": "a -> b after 1"}, TypeError, "state Walker.a: expected a function, a class"),
        ({"a": None, "b": None, "x": 1, "moves": "a -> b on x"}, TypeError, "expected a function or a condition"),
        ({"a": None}, TypeError, "class Walker has no 'moves' between its states; expected a text such as 'state -> "),
        ({"a": forward, "move": "a -> a after 1"}, TypeError, "did you mean moves by move?"),
        ({"a": forward, "b": Inner}, TypeError, "has no 'moves', so a is neither a state nor an event of its machines"),
        ({"b": Leaf, "c": Inner}, TypeError, "class Walker.b has no 'moves'"),
        ({"a": forward, "b": lambda: True, "moves": "a -> b on b"}, TypeError, "'b' is a state and an event; give one"),
        (
            {"a": None, "b": None, "clip": clip, "moves": "a -> b after 1"},
            TypeError,
            r"^Walker.clip, a state because no move names it as an event, asks for 'value'; there are ",
        ),
        (
            {"a": Leaf, "b": None, "moves": "a -> b after 1"},
            TypeError,
            "class Walker.a: expected entry,.*'entri'",
        ),
        ({"moves": " "}, ValueError, "expected at least one"),
        ({"a": None, "b": None, "moves": "a -> b after 5s"}, ValueError, "got 'a -> b after 5s'"),
        ({"a": None, "running": None, "moves": "a -> running after 1"}, TypeError, "'running' is an action"),
        ({"a": None, "b": None, "moves": "a -> b on done"}, TypeError, "in a state have ended; a has no machines"),
        (
            {"a": None, "b": None, "done": lambda: True, "moves": "* -> b on done"},
            TypeError,
            "give your event another name",
        ),
        ({"a": lambda scn: scn, "b": None, "moves": "a -> b after 1"}, TypeError, "asks for 'scn'"),
        ({"a": lambda self: self, "b": None, "moves": "a -> b after 1"}, TypeError, "takes no self: remove it"),
    ],
)
def test_a_class_that_describes_no_machine_is_refused(
    members: dict[str, Any], error: type[Exception], words: str
) -> None:
    cls = type("Walker", (), {"__module__": __name__, **members})
    with Feed(Scripted(CMD_VEL)) as robot:
        with pytest.raises(error, match=words):
            robot.program(cls)
        assert robot.programs.current is None


def test_moves_that_go_round_at_once_and_events_that_are_neither_true_nor_false_are_errors() -> None:
    class Round:
        a = b = None
        moves = "a -> b at once", "b -> a at once"

    with pytest.raises(
        RuntimeError, match=r"the moves of Round go round without end, .*: give one of them an event or a time"
    ):
        Run(Round).at(0.0)

    class Odd:
        def near():
            return 0.3

        a = b = None
        moves = "a -> b on near"

    with pytest.raises(TypeError, match=r"the event near returned 0\.3: expected True or False"):
        Run(Odd).at(0.0)


def test_a_machine_drives_a_feed_names_the_line_of_an_error_and_goes_on_in_its_next_version() -> None:
    class Walker:
        def forward(variables):
            return Drive(0.2 / variables.x)

        back = None
        moves = "forward -> back after 99"

    with Feed(script := Scripted(CMD_VEL)) as robot:
        robot.variables.x = 1
        program = robot.program(Walker, rate=100)
        wait_for(lambda: script.speeds[-1:] == [(0.2, 0.0)], "it drives")
        robot.variables.x = 0
        wait_for(lambda: program.mode == "failed", "it raises")
        assert (
            program.error
            == f"line {Walker.forward.__code__.co_firstlineno + 1}: ZeroDivisionError: float division by zero"
        )
        wait_for(lambda: script.speeds[-1:] == [(0.0, 0.0)], "zero is sent")
        robot.variables.x = 2
        assert robot.program(Walker, rate=100) is program
        wait_for(lambda: script.speeds[-1:] == [(0.1, 0.0)], "it drives on")
        assert program.version.function.active == ("forward",)


def test_an_event_tells_every_number_that_it_compares_with_its_limit() -> None:
    class Walker:
        far = lambda state: state.way >= 0.1
        late = lambda since, variables: since > variables.most
        near = lambda scan: scan.distance() < 0.5
        fast = lambda speed: abs(speed.linear[0]) > 0.3
        often = lambda state: state["count"] == 3
        asked = lambda state, variables: state.is_asked or variables.name == "go"
        a = b = None
        moves = tuple(f"a -> b on {event}" for event in ("far", "late", "near", "fast", "often", "asked"))

    run = Run(Walker)
    run.state.update(way=0.04, count=2, is_asked=False)
    run.variables.most, run.variables.name = 2.0, "stop"
    scan = Scan([1.0, 0.8], angle_min=0.0, angle_increment=0.1, range_min=0.1, range_max=4.0)
    values: dict[str, Any] = {"scan": scan, "speed": Speed((-0.25, 0.0, 0.0))}
    run.at(0.0, **values)
    run.at(0.5, **values)
    assert {name: one.text for (_, name), one in run.machine.last_step.judged.items()} == {
        "far": "way 0.04 < 0.10",
        "late": "since 0.50 \u2264 2.00 s",
        "near": "0.80 \u2265 0.50 m",
        "fast": "|linear[0]| 0.25 \u2264 0.30",
        "often": "count 2 \u2260 3",
        "asked": "",
    }
    compares = {move["event"]: move["compares"] for move in run.machine.describe()[0]["moves"]}
    assert compares.pop("asked") is True  # it compares a text
    assert set(compares.values()) == {True}
    run.state.way = 0.12
    run.at(0.6, **values)
    assert run.machine.fired[-1].text == "way 0.12 \u2265 0.10"
    assert type(run.state.way) is float


def test_what_an_event_stores_and_calculates_are_plain_numbers() -> None:
    def count(state, variables):
        state.total = 2 * state.total + variables.more
        state["twice"] = 2 * state.get("total", 0.0)
        return 1.0 < state.total - state.start <= 5.0

    class Walker:
        a = b = None
        full = count
        moves = "a -> b on full"

    run = Run(Walker)
    run.variables.more = 1.5
    run.state.update(total=1, start=0.5)
    run.at(0.0)
    assert (run.state.total, run.state.twice) == (3.5, 7.0)
    assert {type(run.state.total), type(run.state.twice)} == {float}
    assert run.machine.fired[-1].text == "total \u2212 start 3.00 > 1.00 \u00b7 total \u2212 start 3.00 \u2264 5.00"


def test_a_machine_has_its_own_variables_which_its_entry_resets() -> None:
    class Walker:
        class search:
            aligned, seen = False, []

            def look(state):
                state.seen.append(1)
                state.aligned = len(state.seen) == 2

            ready = None
            moves = "look -> ready on aligned"

        class rest:
            tired = True

            def running(state):
                state.log.append(state.tired)

        moves = "search -> rest on done", "rest -> search after 1"

    run = Run(Walker)
    assert run.at(0.0)[-1] == "search.look"
    assert run.at(0.1)[-1] == "search.look"
    assert (run.state.aligned, run.state.seen) == (True, [1, 1])
    assert run.at(0.2)[-1] == "search.ready"
    assert run.at(0.3) == ("rest",)
    assert run.state.log == [True]
    assert run.at(1.4)[-1] == "search.look"
    assert (run.state.aligned, run.state.seen) == (False, [1])


def test_metres_and_radians_count_from_the_entry_of_a_state() -> None:
    class Square:
        far = lambda driven: driven >= 0.5
        around = lambda turned: turned >= 1.5
        forward = turn = None
        moves = "forward -> turn on far", "turn -> forward on around"

    run = Run(Square)
    assert {"driven", "turned"} <= set(run.machine.asks_for)
    ways = [(0.0, 0.0), (0.4, 0.1), (0.5, 0.1), (0.6, 1.4), (0.6, 1.6), (1.0, 1.6), (1.1, 1.6)]
    states = [run.at(0.1 * i, driven=way, turned=turn)[0] for i, (way, turn) in enumerate(ways)]
    assert states == ["forward", "forward", "turn", "turn", "forward", "forward", "turn"]
    assert run.machine.fired[-1].text == "driven 0.50 \u2265 0.50 m"


def test_metres_count_on_through_a_version_that_does_not_ask_for_them() -> None:
    far = lambda driven: driven >= 0.5

    class Walker:
        forward = turn = None
        moves = "forward -> turn on far", "turn -> forward after 1"

    class Timed:
        forward = turn = None
        moves = "forward -> turn after 0.2", "turn -> forward after 1"

    def install(cls: type) -> None:
        before, run.machine = run.machine, Machine(cls)
        run.machine.adopt(before)

    Walker.far = far  # type: ignore[attr-defined]
    Timed.__name__ = "Walker"
    run = Run(Walker)
    assert [run.at(t, driven=way) for t, way in ((0.0, 0.0), (0.1, 0.5), (1.1, 2.0))] == [
        ("forward",),
        ("turn",),
        ("forward",),
    ]
    install(Timed)
    assert [run.at(t) for t in (1.2, 1.4, 2.4)] == [("forward",), ("turn",), ("forward",)]
    install(Walker)
    assert [run.at(t, driven=way) for t, way in ((2.5, 2.0), (2.6, 2.4), (2.7, 2.5))] == [
        ("forward",),
        ("forward",),
        ("turn",),
    ]


def test_the_user_sends_a_machine_to_a_state_which_is_entered_at_the_next_step() -> None:
    def note(word: str) -> Any:
        return lambda state: state.log.append(word)

    class Walker:
        class forward:
            exit = note("leave forward")

        class avoid:
            entry = note("enter avoid")
            stop = None

            class turn:
                entry = note("enter turn")

            moves = "stop -> turn after 60"

        moves = "forward -> avoid after 60", "avoid -> forward after 60"

    run = Run(Walker)
    assert run.at(0.0) == ("forward",)
    run.machine.go_to("avoid.turn")
    assert run.machine.active == ("forward",)
    assert run.at(0.1) == ("avoid", "avoid.turn")
    assert run.state.log == ["leave forward", "enter avoid", "enter turn"]
    assert [(fired.source, fired.target, fired.why) for fired in run.machine.fired] == [
        ("forward", "avoid", "by hand"),
        ("stop", "turn", "by hand"),
    ]
    assert run.at(0.2) == ("avoid", "avoid.turn")
    run.machine.go_to("avoid › stop")
    assert run.at(0.3) == ("avoid", "avoid.stop")
    with pytest.raises(ValueError, match=r"has no state 'fly'; there are forward, avoid, avoid\.stop, avoid\.turn"):
        run.machine.go_to("fly")


def test_a_state_that_the_user_chose_runs_although_its_events_hold_and_other_machines_go_on() -> None:
    class Walker:
        free = lambda: True

        class drive:
            class way:
                forward = None

                class avoid:
                    stop = None

                    def turn(state):
                        state.log.append("turn")

                    moves = "stop -> turn at once", "turn -> stop on free"

                moves = "forward -> avoid after 60", "avoid -> forward on free"

            class lamp:
                dark = light = None
                moves = "dark -> light after 0.1"

        rest = None
        moves = "drive -> rest after 60", "drive -> rest on never", "rest -> drive on free"
        never = lambda: False

    run = Run(Walker)
    run.at(0.0)
    run.machine.go_to("drive.way.avoid.turn")
    assert run.at(0.1) == ("drive", "drive.way.avoid", "drive.way.avoid.turn", "drive.lamp.light")
    assert run.state.log == ["turn"]
    assert run.at(0.2) == ("drive", "drive.way.forward", "drive.lamp.light")
    run.machine.go_to("drive.way.avoid.stop")
    assert run.at(0.3)[1:3] == ("drive.way.avoid", "drive.way.avoid.stop")
    run.machine.go_to("rest")
    assert run.at(0.4) == ("rest",)
    assert run.at(0.5) == ("drive", "drive.way.forward", "drive.lamp.dark")


def test_a_machine_starts_in_its_first_state_also_if_that_is_none_and_no_move_names_it() -> None:
    class Walker:
        idle = None
        alarm = None
        bumped = lambda variables: variables.bumped
        moves = "* -> alarm on bumped"

    run = Run(Walker)
    run.variables.bumped = False
    assert run.at(0.0) == run.at(0.1) == ("idle",)
    run.variables.bumped = True
    assert run.at(0.2) == ("alarm",)


def test_a_nested_state_is_written_as_in_the_picture_in_every_message() -> None:
    class Walker:
        class avoid:
            class turn:
                left = None
                moves = "left -> left after 60"

            class look:
                up = None
                moves = "up -> up after 60"

        forward = None
        moves = "avoid -> forward after 60"

    class Newer:
        class avoid:
            class turn:
                right = None
                moves = "right -> right after 60"

        forward = None
        moves = "avoid -> forward after 60"

    run = Run(Walker)
    run.at(0.0)
    assert run.machine.active_text == "avoid › left + up"
    Newer.__name__ = "Walker"
    machine = Machine(Newer)
    machine.adopt(run.machine)
    assert machine.active_text == "avoid › left + up", "while the version before continues"
    run.machine = machine
    run.at(0.1)
    assert machine.note == "the state avoid › turn › left is gone: right takes over"
    assert machine.active_text == "avoid › right"


def test_two_moves_that_take_turns_at_every_step_are_reported_while_they_do(caplog: pytest.LogCaptureFixture) -> None:
    class Walker:
        near = lambda variables: variables.way < 0.5
        free = lambda variables: variables.way < 0.6
        forward = avoid = None
        moves = "forward -> avoid on near", "avoid -> forward on free"

    caplog.set_level(logging.INFO, "robowidgets")
    run = Run(Walker)
    run.variables.way = 1.0
    for i in range(10):
        run.at(0.1 * i)
    assert run.machine.turns == ""
    run.variables.way = 0.4
    for i in range(10, 20):
        run.at(0.1 * i)
    told = "avoid and forward take turns at every step: leave a gap between the limits of their events"
    assert run.machine.turns == told
    assert caplog.messages == [f"program Walker: {told}"]
    run.variables.way = 1.0
    run.at(2.0)
    assert run.machine.turns == ""


@pytest.mark.parametrize("where", ["event", "entry", "running"])
def test_the_state_in_which_a_step_failed_is_known_and_shown_as_the_active_one(where: str) -> None:
    def fail(state):
        raise ZeroDivisionError

    class Walker:
        a = None

        class b:
            entry = fail if where == "entry" else lambda: None
            running = fail if where == "running" else lambda: None

        bad = fail if where == "event" else lambda: False
        moves = "a -> b after 0.1", "b -> a on bad"

    run = Run(Walker)
    run.at(0.0)
    run.at(0.05)
    if where == "event":
        run.at(0.1)
    with pytest.raises(ZeroDivisionError):
        run.at(0.2)
    assert run.machine.at == "Walker.b"
    assert run.machine.last_step.states["Walker"][0] == "b"
