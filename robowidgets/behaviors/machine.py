"""State machines: programs whose behaviour depends on the state that they are in.

Not built on `python-statemachine`: with release 3.2, this and `_outline.py` had 594 lines in place of 536, and a step
of three levels took 0.12 ms in place of 0.03. It would enter and leave states. The rest stays here in any case:
events judged from the outermost machine inwards, times, the lists of moves and spans. So do the active states,
because it takes back a move whose entry raises, and has no way on from an active state that is gone.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import deepcopy
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from .._core.inform import inform
from ..kinds import KINDS
from ..samples import Ray
from ..samples.checks import finite
from ..samples.state_span import StateSpan, spelled
from ..samples.verdict import Trace, Verdict
from ._outline import DONE, Move, Node, Outline, described, outline_of
from ._parameters import asked_by
from .drive import Drive
from .robot import DRIVEN, GIVEN, ODOMETRY, TURNED

ROUNDS = 20
"""Moves at once in one step, after which they are taken to go round for ever."""

KEPT = 100
"""Moves that are kept in `Machine.fired`, and spans of states beside them."""

TURNS = 5
"""Steps one after the other in which two moves take turns, after which the machine says so."""

SINCE = "since"
BY_HAND = "by hand"
"""Why a machine is in a state that a person chose."""


class Fired(NamedTuple):
    """A move that was made: seconds, the machine, both states, and why.

    ``event`` is the name of its event, empty for other moves. ``text`` says what its event compared, and ``nearest`` is
    the nearest ray that it looked at, where it looked at any.
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
    """What an event said: whether it holds, None for unknown, and what it looked at; None for `done`."""

    value: bool | None
    saw: Verdict | Trace | None = None

    @property
    def text(self) -> str:
        """What was compared, such as ``"0.43 < 0.55 m"``; formatted only where somebody asks."""
        return self.saw.text if self.saw is not None else ""

    @property
    def nearest(self) -> Ray | None:
        """The nearest ray that was looked at."""
        return self.saw.nearest() if isinstance(self.saw, Trace) else self.saw.nearest if self.saw else None


class MachineStep(NamedTuple):
    """What there is to know of a machine after a step; it does not change any more.

    ``states`` has, by path of a machine, its active state and the time at which it was entered. ``judged`` has what
    the events said in this step, by path and name, and ``seconds`` what time-outs last, by path and their text.
    ``left`` has the last states that were left, the first to be left first.
    """

    time: float = 0.0
    states: Mapping[str, tuple[str, float]] = {}
    judged: Mapping[tuple[str, str], EventVerdict] = {}
    seconds: Mapping[tuple[str, str], float] = {}
    fired: tuple[Fired, ...] = ()
    left: tuple[StateSpan, ...] = ()


class MachineProgress(NamedTuple):
    """How far a machine has come: what a version that goes on from there needs."""

    states: dict[str, tuple[str, float]]
    fired: deque[Fired]
    left: deque[StateSpan]
    marks: dict[str, tuple[float, float]]
    is_new: bool


class Machine:
    """A state machine, as the function of a program: each step judges events, moves, and runs the active states.

    A class describes it. Its ``moves`` name states and events, which are members of the class. A state is a function,
    which runs at each step while it is active; a class with ``entry``, ``running``, ``exit``, or a machine of its own;
    or None. A class without moves runs the machines in it side by side. An event is a function that returns True or
    False, or a condition of `robowidgets.conditions`; it may also be a member of a class around, or stand in the
    notebook, where it may be redefined. The event ``done`` is true when the machines in a state have come to an end.

    Per step, each machine makes one move on an event or after a time, of an outer machine before those within, and
    after it those at once. Functions take the parameters of a program, and ``since``, the seconds in their state, from
    whose beginning on ``driven`` and ``turned`` count, too. The last `Drive` that one of them returns is the speed;
    without one the speed stays. A value in a class, such as ``aligned = False``, is put into the program's ``state``
    each time that the machine or the state of that class is entered; one that is True or False may be an event.

    Args:
        cls: the class.

    Attributes:
        cls: the class.
        fired: the last moves, oldest first.
        last_step: what the last step left, for other threads; at first, what the version before left.
        before: the version whose states are taken over at the first step, and which may still make moves until then.
        note: what a new version could not keep, and what no move names; empty if there is nothing to say.
        turns: which two moves take turns at every step now; empty if none do.
        current: the function that runs now, or ran last.
        at: the path of the state to which it belongs.
        asking: by what it asks for, which of its functions does.

    Raises:
        TypeError, ValueError: the class describes no machine; the text says why.

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

    def __init__(self, cls: type) -> None:
        self.name, self.cls = cls.__name__, cls
        self.root = outline_of(cls)
        self.fired: deque[Fired] = deque(maxlen=KEPT)
        self._left: deque[StateSpan] = deque(maxlen=KEPT)
        self.last_step = MachineStep()
        self.note = "; ".join(note for node in self.root.nodes() for machine in node.machines for note in machine.notes)
        self.turns = self.at = ""
        self.current: Callable[..., Any] = self.__call__
        self.asking = _asked_for(self.root)
        self.asks_for = list(self.asking)
        self._states: dict[str, tuple[str, float]] = {}
        """By path of a machine: its active state, and the time at which it was entered."""
        self._marks: dict[str, tuple[float, float]] = {}
        """By path of a machine: metres driven and radians turned when that state was entered."""
        self._odometer = 0.0, 0.0
        self._chosen: tuple[tuple[Outline, str], ...] = ()
        """The states that a person chose, outer ones first, until the next step."""
        self._steps = 0
        self._last_moves: dict[str, tuple[int, tuple[str, str], int]] = {}
        """By path of a machine: the step of its last move on an event, its states, and how often it undid the last."""
        self._is_whole = False
        """Whether the active states are known down to the leaves: not at first, nor after an error."""
        self._is_new = True
        self.before: Machine | None = None
        self._values: dict[str, Any] = {}
        self._judged: dict[tuple[str, str], EventVerdict] = {}
        self._seconds: dict[tuple[str, str], float] = {}
        self._drive: Drive | None = None

    @property
    def active(self) -> tuple[str, ...]:
        """The paths of the active states below the root, outer ones first."""
        if self.before is not None:
            return self.before.active
        start = len(self.root.path) + 1
        return tuple(node.path[start:] for node, _ in self._active_nodes(self.root))

    @property
    def active_text(self) -> str:
        """The active states as the picture writes them: inner ones behind outer ones, ``avoid › turn + look``."""
        return self.before.active_text if self.before is not None else self._text_of(self.root)

    def describe(self) -> list[dict[str, Any]]:
        """Its machines, with their states and moves, as plain values."""
        return [described(machine) for machine in self.root.machines]

    def adopt(self, before: Machine) -> None:
        """Go on in the states of another version that still exist; where one is gone, in the initial state."""
        self.before, self.last_step = before, before.last_step

    def hand_on(self) -> MachineProgress:
        """How far it has come, for a version that goes on from here."""
        return MachineProgress(dict(self._states), self.fired, self._left, dict(self._marks), self._is_new)

    def fresh(self) -> Machine:
        """The machine of the same class, in its initial state."""
        return Machine(self.cls)

    def go_to(self, path: str) -> None:
        """Go to a state at the next step, named as in `active`, ``"avoid.turn"``, or the picture: ``"avoid › turn"``.

        Raises:
            ValueError: there is no such state.
        """
        wanted, start = path.replace(" › ", ".").removeprefix(f"{self.root.path}."), len(self.root.path) + 1
        ways = {node.path[start:]: way for way, node in _ways_to_states(self.root)}
        if wanted not in ways:
            raise ValueError(f"{self.name} has no state {wanted!r}; there are {', '.join(ways)}")
        self._chosen = ways[wanted]

    def __call__(self, **values: Any) -> Drive | None:
        """Make a step; returns the speed, None to keep it."""
        self._values, self._drive = values, None
        self._judged, self._seconds = {}, {}
        now: float = values["time"]
        self._odometer = values.get(DRIVEN, 0.0), values.get(TURNED, 0.0)
        self._steps += 1
        if self.before is not None:
            before, self.before = self.before, None
            while before.before is not None:  # a version that made no step has no states of its own
                before = before.before
            self._states, self.fired, self._left, self._marks, self._is_new = before.hand_on()
            for node in (self.root, *(node for node, _ in self._active_nodes(self.root))):
                self._set_values(node, anew=False)
        try:
            self._make_step(now)
        finally:  # after an error the states in which it came are shown
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
        self._step(self.root, now)
        self._act(self.root, "running", 0.0)
        for node, entered in list(self._active_nodes(self.root)):
            self._act(node, "running", now - entered)
        self._is_whole = True
        self._look_for_turns()

    def _set_values(self, node: Node, *, anew: bool = True) -> None:
        """Give the variables of a class their initial values; or only those that have no value yet."""
        for name, value in node.values.items():
            if anew or name not in self._values["state"]:
                self._values["state"][name] = deepcopy(value)

    def _note_move(self, machine: Outline, source: str, move: Move) -> None:
        """Note a move on an event, to find two that take turns at every step."""
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
        """Forget the states of machines that are gone."""
        nodes = (self.root, *(node for node, _ in self._active_nodes(self.root)))
        for path in self._states.keys() - {machine.path for node in nodes for machine in node.machines}:
            self._note_left(path, now)

    def _note_left(self, path: str, now: float) -> None:
        name, entered = self._states.pop(path)
        self._left.append(StateSpan(entered, now, f"{path}.{name}"))

    def _step(self, node: Node, now: float) -> None:
        for machine in node.machines:
            name, entered = self._states[machine.path]
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
        raise RuntimeError(f"the moves of {machine.path} go round at once, last {move}")

    def _find_move(self, machine: Outline, name: str, since: float) -> Move | None:
        """The first move that a machine can make now. All events are judged, so that all may be shown."""
        found = None
        for move in machine.moves:
            if move.source == name or (move.source == "*" and move.target != name):
                holds = self._holds(machine, move, machine.states[name], since)
                found = move if holds and found is None else found
        return found

    def _holds(self, machine: Outline, move: Move, node: Node, since: float) -> bool:
        if move.after is not None:
            return since >= self._seconds_of(machine, move, move.after)
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
        trace = Trace()
        result = self._call(event, since, owner, trace.named)
        if isinstance(result, (bool, np.bool_)) or result is None:
            # True moves the machine, whatever it rests on. A False of unknown distances is shown as unknown.
            return EventVerdict(bool(result) or trace.value(result), trace)
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

    def _call(
        self,
        function: Callable[..., Any],
        since: float,
        owner: str,
        wrap: Callable[[str, Any], Any] = lambda _, value: value,
    ) -> Any:
        """Call a function of the user with what it asks for.

        ``owner`` is the path of the machine to whose active state it belongs, empty for the root. ``wrap`` makes what
        it is given, of a name and a value.
        """
        self.current = function
        began, now = self._marks.get(owner, (0.0, 0.0)), self._odometer
        self._values |= {SINCE: since, DRIVEN: now[0] - began[0], TURNED: now[1] - began[1]}
        given = self._given(_parameters(function), function.__name__)
        return function(**{name: wrap(name, value) for name, value in given.items()})

    def _given(self, asked: Iterable[str], name: str) -> dict[str, Any]:
        """The values that a function or a condition asks for; TypeError if it was redefined, and asks for others."""
        try:
            return {one: self._values[one] for one in asked}
        except KeyError as missing:
            raise TypeError(
                f"{name} asks for {missing}, which it did not when the machine was made: run the machine's cell again"
            ) from None


_KNOWN = (*(kind.parameter for kind in KINDS.values()), *GIVEN, *ODOMETRY, SINCE)


@lru_cache(maxsize=500)
def _parameters(function: Callable[..., Any]) -> tuple[str, ...]:
    return tuple(asked_by(function, getattr(function, "__name__", "an action"), _KNOWN))


def _ways_to_states(
    node: Node, way: tuple[tuple[Outline, str], ...] = ()
) -> Iterator[tuple[tuple[tuple[Outline, str], ...], Node]]:
    """All states below one, each with the states to choose on the way to it, outer ones first."""
    for machine in node.machines:
        for name, state in machine.states.items():
            yield (*way, (machine, name)), state
            yield from _ways_to_states(state, (*way, (machine, name)))


def _asked_for(root: Node) -> dict[str, str]:
    """What the functions of a machine ask for, by name, with one that does; and what its moves need."""
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
