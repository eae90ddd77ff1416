"""State machines: programs whose behaviour depends on their active state.

They do not use `python-statemachine`: with release 3.2, this module and `_outline.py` had 594 lines instead of 536, and
a step of three levels took 0.12 ms instead of 0.03 ms. The library would only enter and leave states. Everything else
would stay here: judging events from the outermost machine inwards, time-outs, and the lists of moves and spans. The
active states would stay here, too, because the library undoes a move if an entry action raises, and cannot continue
from an active state that a new version has removed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from ..kinds import KINDS
from ..reasons.look import Look, Reasons
from ..runtime.inform import inform
from ..samples import Ray
from ..samples.checks import finite
from ..samples.state_span import StateSpan, spelled
from ..samples.verdict import Verdict
from ._outline import DONE, Move, Node, Outline, described, outline_of
from ._parameters import asked_by
from .drive import Drive
from .lines.watch import LineWatch
from .robot import DRIVEN, GIVEN, ODOMETRY, TURNED

ROUNDS = 20
"""The number of moves at once in one step from which they count as an endless loop."""

KEPT = 100
"""The number of moves in `Machine.fired`, and of the latest spans of states."""

TURNS = 5
"""The number of consecutive steps in which two moves undo each other, from which the machine reports it."""

ROUNDING = 1e-6
"""Seconds by which a time-out may be early, because a difference of times may be less than the number that is meant."""

SINCE = "since"
BY_HAND = "by hand"
"""The reason of a move to a state that the user chose."""


class Fired(NamedTuple):
    """A move that was made: its time in seconds, the machine, both states, and the reason.

    ``event`` is the name of its event, empty for other moves. ``text`` shows what the event compared. ``nearest`` is
    the nearest ray that the event looked at, or None if it looked at no rays.
    """

    time: float
    machine: str
    source: str
    target: str
    why: str
    event: str = ""
    text: str = ""
    nearest: Ray | None = None


class EventVerdict(NamedTuple):
    """The result of an event: True, False or None for unknown, and the values that it read (None for `done`)."""

    value: bool | None
    saw: Verdict | Reasons | None = None

    @property
    def text(self) -> str:
        """The comparison, such as ``"0.43 < 0.55 m"``. It is formatted on access."""
        return self.saw.text if self.saw is not None else ""

    @property
    def nearest(self) -> Ray | None:
        """The nearest ray that was looked at."""
        return self.saw.nearest() if isinstance(self.saw, Reasons) else self.saw.nearest if self.saw else None


class MachineStep(NamedTuple):
    """An immutable record of a machine after a step.

    ``states`` maps the path of a machine to its active state and the time when it was entered. ``judged`` maps the path
    of a machine and an event to the result of the event in this step. ``seconds`` maps the path of a machine and the
    text of a time-out to its seconds. ``left`` contains the last states that were left, oldest first.
    """

    time: float = 0.0
    states: Mapping[str, tuple[str, float]] = {}
    judged: Mapping[tuple[str, str], EventVerdict] = {}
    seconds: Mapping[tuple[str, str], float] = {}
    fired: tuple[Fired, ...] = ()
    left: tuple[StateSpan, ...] = ()


class MachineProgress(NamedTuple):
    """The progress of a machine that its next version takes over."""

    states: dict[str, tuple[str, float]]
    fired: deque[Fired]
    left: deque[StateSpan]
    marks: dict[str, tuple[float, float]]
    odometer: tuple[float, float]
    is_new: bool


class Machine:
    """A state machine, used as the function of a program: each step judges events, moves, and runs the active states.

    A class describes the machine. Its ``moves`` name states and events, which are members of the class. A state is a
    function that runs at each step while the state is active, a class with ``entry``, ``running`` and ``exit``, a class
    with an inner machine, or None. A class without moves runs its inner machines in parallel. An event is a function
    that returns True or False, or a condition of `robowidgets.conditions`. It may also be a member of an enclosing
    class, or a name in the notebook, where the user may redefine it. The event ``done`` is true when the machines in a
    state have ended.

    Per step, each machine makes one move on an event or after a time, and then its moves at once. Outer machines move
    before inner machines. Functions take the parameters of a program, and ``since``: the seconds since their state was
    entered. ``driven`` and ``turned`` count from that time, too. The last `Drive` that a function returns is the speed;
    without a `Drive`, the speed stays the same. A value in a class, such as ``aligned = False``, is written to the
    program's ``state`` each time the machine or the state of that class is entered. A value that is True or False may
    be an event.

    Args:
        cls: the class.

    Attributes:
        cls: the class.
        fired: the last moves, oldest first.
        last_step: the record of the last step, for other threads; before the first step, the record of the previous
            version.
        before: the previous version, whose states are taken over at the first step. It may still make moves until then.
        note: notes on what a new version could not keep, and on what no move names; empty without notes.
        turns: a note on two moves that undo each other at every step; empty otherwise.
        current: the function that runs now, or ran last.
        at: the path of the state of that function.
        lines: notes the values of the lines of each function that it calls; None if no widget shows them.
        asking: maps each parameter to a function that asks for it.

    Raises:
        TypeError, ValueError: the class does not describe a machine; the text says why.

    Examples:
        >>> class Escapement:
        ...     tick = tock = None
        ...     moves = "tick -> tock after 0.5", "tock -> tick after 0.5"
        >>> machine = Machine(Escapement)
        >>> for time in (0.0, 0.6):
        ...     machine(time=time)
        >>> machine.active
        ('tock',)
    """

    calls_functions = True
    """True for a program that is made of several functions, which it calls by its `lines` if it has any."""

    def __init__(self, cls: type) -> None:
        self.name, self.cls = cls.__name__, cls
        self.root = outline_of(cls)
        self.fired: deque[Fired] = deque(maxlen=KEPT)
        self._left: deque[StateSpan] = deque(maxlen=KEPT)
        self.last_step = MachineStep()
        self.lines: LineWatch | None = None
        self.note = "; ".join(note for node in self.root.nodes() for machine in node.machines for note in machine.notes)
        self.turns = self.at = ""
        self.current: Callable[..., Any] = self.__call__
        self.asking = _asked_for(self.root)
        for function, is_event in self.functions:  # not in the first step, which would be late
            if is_event:
                _look(function).prepare()
        self.asks_for = list(self.asking)
        self._states: dict[str, tuple[str, float]] = {}
        """By path of a machine: its active state, and the time when that was entered."""
        self._marks: dict[str, tuple[float, float]] = {}
        """By path of a machine: metres driven and radians turned when that state was entered."""
        self._odometer = 0.0, 0.0
        self._chosen: tuple[tuple[Outline, str], ...] = ()
        """The states that the user chose for the next step, outermost first."""
        self._steps = 0
        self._last_moves: dict[str, tuple[int, tuple[str, str], int]] = {}
        """By path of a machine: the step and the states of its last move on an event, and the count of undone moves."""
        self._is_whole = False
        """True if the active states are known down to the innermost: neither at first nor after an error."""
        self._is_new = True
        self.before: Machine | None = None
        self._values: dict[str, Any] = {}
        self._judged: dict[tuple[str, str], EventVerdict] = {}
        self._seconds: dict[tuple[str, str], float] = {}
        self._drive: Drive | None = None

    @property
    def active(self) -> tuple[str, ...]:
        """The paths of the active states below the root, outermost first."""
        if self.before is not None:
            return self.before.active
        start = len(self.root.path) + 1
        return tuple(node.path[start:] for node, _ in self._active_nodes(self.root))

    @property
    def active_text(self) -> str:
        """The active states as in the picture, inner states after outer states: ``avoid › turn + look``."""
        return self.before.active_text if self.before is not None else self._text_of(self.root)

    @property
    def functions(self) -> list[tuple[Callable[..., Any], bool]]:
        """The functions of the user that it calls, each once, with True for an event."""
        found: dict[tuple[int, bool], tuple[Callable[..., Any], bool]] = {}
        for node in self.root.nodes():
            named = [(machine, move.event) for machine in node.machines for move in machine.moves]
            events = [machine.look_up(name) for machine, name in named if name is not None and name != DONE]
            called = [event for event in events if not isinstance(event, bool) and not hasattr(event, "judge")]
            for one in (*((action, False) for action in node.actions.values()), *((event, True) for event in called)):
                found[id(one[0]), one[1]] = one
        return list(found.values())

    def describe(self) -> list[dict[str, Any]]:
        """Return the machines with their states and moves, as plain values."""
        return [described(machine) for machine in self.root.machines]

    def adopt(self, before: Machine) -> None:
        """Continue in the states of another version, or in the initial state if a state no longer exists."""
        self.before, self.last_step = before, before.last_step

    def hand_on(self) -> MachineProgress:
        """Return the progress of the machine, for its next version."""
        marks = dict(self._marks)
        return MachineProgress(dict(self._states), self.fired, self._left, marks, self._odometer, self._is_new)

    def continue_from(self, progress: MachineProgress) -> None:
        """Continue in the states of another machine of the same class, which goes on by itself."""
        self._states, self._marks = {**progress.states}, {**progress.marks}
        self._odometer, self._is_new = progress.odometer, progress.is_new

    def fresh(self) -> Machine:
        """Return a new machine of the same class, in its initial state."""
        return Machine(self.cls)

    def go_to(self, path: str) -> None:
        """Go to a state at the next step.

        The state is named as in `active`, ``"avoid.turn"``, or as in the picture, ``"avoid › turn"``.

        Raises:
            ValueError: the machine has no such state.
        """
        wanted, start = path.replace(" › ", ".").removeprefix(f"{self.root.path}."), len(self.root.path) + 1
        ways = {node.path[start:]: way for way, node in _ways_to_states(self.root)}
        if wanted not in ways:
            raise ValueError(f"{self.name} has no state {wanted!r}; there are {', '.join(ways)}")
        self._chosen = ways[wanted]

    def __call__(self, **values: Any) -> Drive | None:
        """Make a step. Return the new speed, or None to keep the speed."""
        self._values, self._drive = values, None
        self._judged, self._seconds = {}, {}
        now: float = values["time"]
        self._steps += 1
        if self.before is not None:
            before, self.before = self.before, None
            while before.before is not None:  # a version that made no step has no states
                before = before.before
            self._states, self.fired, self._left, self._marks, self._odometer, self._is_new = before.hand_on()
            for node in (self.root, *(node for node, _ in self._active_nodes(self.root))):
                self._set_values(node, anew=False)
        driven, turned = self._odometer  # of a version that asks for neither, so that a later version counts from there
        self._odometer = values.get(DRIVEN, driven), values.get(TURNED, turned)
        try:
            self._make_step(now)
        finally:  # after an error, widgets show the states in which it occurred
            self.last_step = MachineStep(
                now, dict(self._states), self._judged, self._seconds, tuple(self.fired), tuple(self._left)
            )
        return self._drive

    # -- within --------------------------------------------------------------------------------------------------------

    def _make_step(self, now: float) -> None:
        if not self._is_whole:
            if self._is_new:
                self._set_values(self.root)
                self._act(self.root, "entry", now)
            self._resume(self.root, now)
            self._forget_gone(now)
        self._is_whole = self._is_new = False
        chosen, self._chosen = self._chosen, ()
        for machine, name in chosen:
            if self._states[machine.path][0] != name:
                self._make(machine, Move("*", name, None, None), now, BY_HAND)
        self._step(self.root, now, chosen)
        self._act(self.root, "running", 0.0)
        for node, entered in list(self._active_nodes(self.root)):
            self._act(node, "running", now - entered)
        self._is_whole = True
        self._look_for_turns()

    def _set_values(self, node: Node, *, anew: bool = True) -> None:
        """Set the variables of a class to their initial values, or only the variables that have no value yet."""
        for name, value in node.values.items():
            if anew or name not in self._values["state"]:
                self._values["state"][name] = deepcopy(value)

    def _note_move(self, machine: Outline, source: str, move: Move) -> None:
        """Record a move on an event, to find two moves that undo each other at every step."""
        step, before, count = self._last_moves.get(machine.path, (0, ("", ""), 0))
        undoes = step == self._steps - 1 and before == (move.target, source)
        self._last_moves[machine.path] = self._steps, (source, move.target), count + 1 if undoes else 0

    def _look_for_turns(self) -> None:
        now = [(states, count) for step, states, count in self._last_moves.values() if step == self._steps]
        states = next((states for states, count in now if count >= TURNS), None)
        before, self.turns = self.turns, ""
        if states is not None:
            names = " and ".join(sorted(states))
            self.turns = f"{names} take turns at every step: leave a gap between the limits of their events"
            if not before:
                inform(f"program {self.name}: {self.turns}")

    def _active_nodes(self, node: Node) -> Iterator[tuple[Node, float]]:
        for machine in node.machines:
            if machine.path in self._states:
                name, entered = self._states[machine.path]
                if name in machine.states:
                    yield machine.states[name], entered
                    yield from self._active_nodes(machine.states[name])

    def _text_of(self, node: Node) -> str:
        parts = []
        for machine in node.machines:
            name, _ = self._states.get(machine.path, ("", 0.0))
            if name in machine.states:
                parts.append(" › ".join(filter(None, (name, self._text_of(machine.states[name])))))
        return " + ".join(parts)

    def _resume(self, node: Node, now: float) -> None:
        """Enter the initial state of each machine without an active state."""
        for machine in node.machines:
            known = self._states.get(machine.path)
            if known is None or known[0] not in machine.states:
                if known is not None:
                    gone = spelled(f"{machine.path}.{known[0]}"[len(self.root.path) + 1 :])
                    self.note = f"the state {gone} is gone: {machine.initial} takes over"
                    inform(f"program {self.name}: {self.note}")
                    self._note_left(machine.path, now)
                self._enter(machine, machine.initial, now)
                self._settle(machine, now)
            else:
                self._resume(machine.states[known[0]], now)

    def _forget_gone(self, now: float) -> None:
        """Forget the states of machines that no longer exist."""
        nodes = (self.root, *(node for node, _ in self._active_nodes(self.root)))
        for path in self._states.keys() - {machine.path for node in nodes for machine in node.machines}:
            self._note_left(path, now)

    def _note_left(self, path: str, now: float) -> None:
        name, entered = self._states.pop(path)
        self._left.append(StateSpan(entered, now, f"{path}.{name}"))

    def _step(self, node: Node, now: float, chosen: Sequence[tuple[Outline, str]] = ()) -> None:
        """Make at most one move of each machine in a state, none of those in which the user chose a state."""
        for machine in node.machines:
            name, entered = self._states[machine.path]
            if chosen and machine is chosen[0][0]:
                if inner := chosen[1:]:
                    self._step(machine.states[name], now, inner)
                continue
            move = self._find_move(machine, name, now - entered)
            if move is None:
                self._step(machine.states[name], now)
                continue
            self._make(machine, move, now)
            if move.event is not None:
                self._note_move(machine, name, move)
            self._settle(machine, now)

    def _settle(self, machine: Outline, now: float) -> None:
        """Make the moves at once."""
        for _ in range(ROUNDS):
            name = self._states[machine.path][0]
            at_once = (move for move in machine.moves if move.source == name and move.event is move.after is None)
            if (move := next(at_once, None)) is None:
                return
            self._make(machine, move, now)
        raise RuntimeError(
            f"the moves of {machine.path} go round without end, last {move}: give one of them an event or a time"
        )

    def _find_move(self, machine: Outline, name: str, since: float) -> Move | None:
        """Return the first move that the machine can make now. All events are judged, so that widgets can show them."""
        found = None
        for move in machine.moves:
            if move.source == name or (move.source == "*" and move.target != name):
                holds = self._holds(machine, move, machine.states[name], since)
                found = move if holds and found is None else found
        return found

    def _holds(self, machine: Outline, move: Move, node: Node, since: float) -> bool:
        if move.after is not None:
            return since >= self._seconds_of(machine, move, move.after) - ROUNDING
        if move.event is None:
            return True
        if move.event == DONE:
            judged = EventVerdict(
                bool(node.machines) and all(m.is_last(self._states[m.path][0]) for m in node.machines)
            )
        else:
            self.at = node.path
            judged = self._judge(machine.look_up(move.event), move.event, since, machine.path)
        self._judged[machine.path, move.event] = judged
        return judged.value is True

    def _judge(self, event: Any, name: str, since: float, owner: str) -> EventVerdict:
        if isinstance(event, bool):
            return EventVerdict(bool(self._values["state"].get(name, event)))
        if hasattr(event, "judge"):
            verdict: Verdict = event.judge(SimpleNamespace(**self._given(event.reads, name)))
            return EventVerdict(verdict.value, verdict)
        given = self._enter_call(event, since, owner)
        if self.lines is None:
            result, reasons = _look(event)(**given)
        else:
            result, reasons = self.lines.call_event(event, given)
        if isinstance(result, (bool, np.bool_)) or result is None:
            # True moves the machine in any case. A False that depends on unknown distances is shown as unknown.
            return EventVerdict(bool(result) or reasons.value(result), reasons)
        raise TypeError(f"the event {name} returned {result!r}: expected True or False")

    def _seconds_of(self, machine: Outline, move: Move, after: str) -> float:
        try:
            seconds = float(after)
        except ValueError:
            variables = self._values["variables"]
            value = getattr(variables, after) if after in variables else machine.look_up(after)
            seconds = finite(f"{move}", value, "seconds")
        self._seconds[machine.path, after] = seconds
        return seconds

    def _make(self, machine: Outline, move: Move, now: float, why: str = "") -> None:
        source, _ = self._states[machine.path]
        saw = self._judged.get((machine.path, str(move.event)), EventVerdict(None))
        self._leave(machine, now)
        why, event = why or move.why, move.event or ""
        self.fired.append(Fired(now, machine.path, source, move.target, why, event, saw.text, saw.nearest))
        self._enter(machine, move.target, now)

    def _enter(self, machine: Outline, name: str, now: float) -> None:
        self._states[machine.path] = name, now
        self._marks[machine.path] = self._odometer
        node = machine.states[name]
        self._set_values(node)
        self._act(node, "entry", 0.0)
        for inner in node.machines:
            self._enter(inner, inner.initial, now)
            self._settle(inner, now)

    def _leave(self, machine: Outline, now: float) -> None:
        name, entered = self._states[machine.path]
        node = machine.states[name]
        for inner in node.machines:
            self._leave(inner, now)
        self._act(node, "exit", now - entered)
        self._note_left(machine.path, now)

    def _act(self, node: Node, action: str, since: float) -> None:
        function = node.actions.get(action)
        if function is None:
            return
        self.at = node.path
        result = self._call(function, since, node.path.rpartition(".")[0])
        if isinstance(result, Drive):
            self._drive = result
        elif result is not None:
            hint = (
                "" if not isinstance(result, bool) else "; a function is an event where a move names it: a -> b on it"
            )
            raise TypeError(
                f"{spelled(node.path)} returned {result!r}: expected a Drive, or None to keep the speed{hint}"
            )

    def _call(self, function: Callable[..., Any], since: float, owner: str) -> Any:
        """Call a function of the user with the values that it asks for."""
        given = self._enter_call(function, since, owner)
        return function(**given) if self.lines is None else self.lines.call(function, given)

    def _enter_call(self, function: Callable[..., Any], since: float, owner: str) -> dict[str, Any]:
        """Return the values that a function of the user asks for, which is called next.

        ``owner`` is the path of the machine whose active state has the function, empty for the root.
        """
        self.current = function
        began, now = self._marks.get(owner, (0.0, 0.0)), self._odometer
        self._values |= {SINCE: since, DRIVEN: now[0] - began[0], TURNED: now[1] - began[1]}
        return self._given(_parameters(function), function.__name__)

    def _given(self, asked: Iterable[str], name: str) -> dict[str, Any]:
        """Return the values that a function or a condition asks for; TypeError if a redefinition asks for new ones."""
        try:
            return {one: self._values[one] for one in asked}
        except KeyError as missing:
            raise TypeError(
                f"{name} asks for {missing}, which it did not when the machine was made: run the machine's cell again"
            ) from None


_look = lru_cache(maxsize=500)(Look)
"""Returns the rewritten form of an event."""


@lru_cache(maxsize=500)
def _parameters(function: Callable[..., Any]) -> tuple[str, ...]:
    known = (*(kind.parameter for kind in KINDS.values()), *GIVEN, *ODOMETRY, SINCE)
    return tuple(asked_by(function, getattr(function, "__name__", "an action"), known))


def _ways_to_states(
    node: Node, way: tuple[tuple[Outline, str], ...] = ()
) -> Iterator[tuple[tuple[tuple[Outline, str], ...], Node]]:
    """Yield all states below a state, each with the states on the way to it, outermost first."""
    for machine in node.machines:
        for name, state in machine.states.items():
            yield (*way, (machine, name)), state
            yield from _ways_to_states(state, (*way, (machine, name)))


def _asked_for(root: Node) -> dict[str, str]:
    """Map each parameter that the functions and moves of a machine need to a function that asks for it."""
    asked = dict.fromkeys(("time", "variables"), root.path)
    machines = [machine for node in root.nodes() for machine in node.machines]
    unnamed = {f"{machine.path}.{name}" for machine in machines for name in machine.unnamed}
    for node in root.nodes():
        if node.values:
            asked.setdefault("state", node.path)
        who = f"{node.path}, a state because no move names it as an event," if node.path in unnamed else node.path
        for one in (one for action in node.actions.values() for one in _parameters(action)):
            asked.setdefault(one, who)
    for machine in machines:
        for name in dict.fromkeys(move.event for move in machine.moves):
            if name is not None and name != DONE:
                event = machine.look_up(name)
                if isinstance(event, bool):
                    continue
                reads = event.reads if hasattr(event, "judge") else _parameters(event)
                for one in reads:
                    asked.setdefault(one, f"the event {name}")
    asked.pop(SINCE, None)
    return asked
