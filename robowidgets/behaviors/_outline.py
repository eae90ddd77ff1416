"""The outline of a state machine: its states, nested machines and moves, read from a class."""

from __future__ import annotations

import difflib
import dis
import inspect
import re
import sys
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any

from ..samples.state_span import spelled

ACTIONS = ("entry", "running", "exit")
DONE = "done"
"""The event that is true when the nested machines of a state are in a state that no move leaves."""

_VALUES = (bool, int, float, str, tuple, list, dict)
"""The types of class members that are variables."""
_SECONDS = r"(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|[^\W\d]\w*"
_MOVE = re.compile(rf"(\w+|\*)\s*->\s*(\w+)(?:\s+on\s+(\w+)|\s+after\s+({_SECONDS})(?:\s+s)?|\s+at\s+once)")
_FORMS = "'state -> state on event', 'state -> state after 0.5', 'state -> state at once', '* -> state on event'"


@dataclass(frozen=True)
class Move:
    """A transition: on an event, after some seconds (a number, or the name of a number), or at once without either.

    ``source`` is ``*`` for any state of the machine.
    """

    source: str
    target: str
    event: str | None
    after: str | None

    @property
    def why(self) -> str:
        """The trigger of the move: "on near", "after 0.5" or "at once"."""
        return f"on {self.event}" if self.event else f"after {self.after}" if self.after else "at once"

    def __str__(self) -> str:
        return f"{self.source} -> {self.target} {self.why}"


@dataclass(frozen=True, eq=False)
class Node:
    """A state: its actions, the machines that run in parallel while it is active, and the variables that it sets."""

    name: str
    path: str
    actions: Mapping[str, Callable[..., Any]]
    machines: tuple[Outline, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)

    def nodes(self) -> Iterator[Node]:
        """Yield the state and all states within it."""
        yield self
        for machine in self.machines:
            for state in machine.states.values():
                yield from state.nodes()


@dataclass(frozen=True, eq=False)
class Outline:
    """A machine: its states, beginning with the initial state, and its moves, beginning with the moves from any state.

    ``unnamed`` are the states that no move names, and ``unused`` the lambdas that are neither a state nor an event.
    """

    path: str
    states: Mapping[str, Node]
    moves: tuple[Move, ...]
    scopes: tuple[Mapping[str, Any], ...]
    unnamed: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()

    @property
    def initial(self) -> str:
        """The name of the first state."""
        return next(iter(self.states))

    def look_up(self, name: str) -> Any:
        """Return the current value of a name in the enclosing classes or the notebook; LookupError if not found."""
        for scope in self.scopes:
            if name in scope:
                return _plain(scope[name])
        raise LookupError(f"{name!r} is not in class {self.path}, around it, or in the notebook; define it")

    @property
    def notes(self) -> tuple[str, ...]:
        """Hints on likely mistakes of the author, one line each."""
        lost = [name for name in self.unnamed if name != self.initial]
        return (
            *(f"no move leads to the state {spelled(self.path)} › {name}" for name in lost),
            *(f"no move names {self.path}.{name}: a lambda is an event, def {name}() a state" for name in self.unused),
        )

    def is_last(self, state: str) -> bool:
        """Return True if no move leaves the state, except moves from any state."""
        return all(move.source != state for move in self.moves)


def described(machine: Outline) -> dict[str, Any]:
    """Return a machine and everything in it as plain values: `Outline` in js/machine/traits.ts."""
    states = [
        {"name": name, "path": node.path, "machines": [described(inner) for inner in node.machines]}
        for name, node in machine.states.items()
    ]
    moves = [{**vars(move), "why": move.why, "compares": _compares(machine, move.event)} for move in machine.moves]
    return {"path": machine.path, "states": states, "moves": moves}


def _compares(machine: Outline, name: str | None) -> bool:
    """Return True if an event may report the numbers that it compares."""
    event = None if name in (None, DONE) else machine.look_up(str(name))
    if event is None or isinstance(event, bool):
        return False
    if hasattr(event, "judge") or "scan" in inspect.signature(event).parameters:
        return True
    code = getattr(event, "__code__", None)
    return code is not None and any(step.opname == "COMPARE_OP" for step in dis.get_instructions(code))


def outline_of(cls: type) -> Node:
    """Return the root state of the machine that a class describes.

    Raises:
        TypeError, ValueError: a member of the class is not a state, an action or a move; the text names it.
    """
    module = vars(sys.modules[cls.__module__])
    body = _body(cls)
    if "moves" not in body and not _classes_in(body):
        raise _without_moves(cls.__name__, body)
    return _node(cls.__name__, cls, cls.__name__, (module,))


def _node(name: str, value: Any, path: str, scopes: tuple[Mapping[str, Any], ...]) -> Node:
    value = _plain(value)
    if value is None:
        return Node(name, path, {})
    if not isinstance(value, type):
        if not callable(value):
            raise TypeError(f"state {path}: expected a function, a class or None, got {value!r}")
        return Node(name, path, {"running": value})
    body = _body(value)
    actions = {action: _plain(body[action]) for action in ACTIONS if action in body}
    values = {key: part for key, part in body.items() if _is_value(key, part)}
    if "moves" in body:
        return Node(name, path, actions, (_machine(value, path, scopes),), values)
    inner = _classes_in(body)
    if inner:
        still = [key for key, part in inner.items() if "moves" not in _body(part)]
        if len(still) == len(inner):
            raise _without_moves(path, body)
        if still:
            raise _without_moves(f"{path}.{still[0]}", _body(inner[still[0]]))
        events = _events_within(body)
        if lost := [key for key, part in body.items() if key not in inner and _is_state(key, part, events)]:
            raise TypeError(
                f"class {path} has no 'moves', so {lost[0]} is neither a state nor an event of its machines"
            )
    others = [key for key in body if not (key.startswith("_") or key in ACTIONS or key in values)]
    if not inner and (others or not actions):
        got = f"; got {others[0]!r}" if others else ""
        raise TypeError(f"class {path}: expected entry, running, exit, or states and moves{got}")
    machines = tuple(_machine(part, f"{path}.{key}", (body, *scopes)) for key, part in inner.items())
    return Node(name, path, actions, machines, values)


def _machine(cls: type, path: str, scopes: tuple[Mapping[str, Any], ...]) -> Outline:
    body = _body(cls)
    given = body["moves"]
    lines = given.split("\n") if isinstance(given, str) else list(given)
    moves = [_move(line, path) for line in lines if line.split("#")[0].strip()]
    if not moves:
        raise ValueError(f"moves of {path}: expected at least one, as {_FORMS}")
    names = dict.fromkeys(name for move in moves for name in (move.source, move.target) if name != "*")
    for name in names:
        if name in ACTIONS:
            raise TypeError(f"moves of {path}: {name!r} is an action of the state around; give the state another name")
    missing = [name for name in names if name not in body]
    if missing:
        near = difflib.get_close_matches(missing[0], [key for key in body if not key.startswith("_")], n=1)
        hint = f"; did you mean {near[0]}?" if near else f"; {missing[0]} = None makes one without actions"
        raise TypeError(f"moves of {path}: no state {missing[0]!r} in its class{hint}")
    events = _events_within(body)
    for name in names:
        if name in events:
            raise TypeError(f"moves of {path}: {name!r} is a state and an event; give one of them another name")
    unnamed = tuple(key for key, part in body.items() if key not in names and _is_state(key, part, events))
    unused = tuple(key for key, part in body.items() if key not in {*names, *events} and _is_lambda(key, part))
    ordered = [key for key in body if key in names or key in unnamed]
    if not any(move.source == "*" for move in moves):  # in this case no move leads out of an unnamed state
        ordered.sort(key=lambda key: key in unnamed)
    outline = Outline(
        path,
        {name: _node(name, body[name], f"{path}.{name}", (body, *scopes)) for name in ordered},
        tuple(sorted(moves, key=lambda move: move.source != "*")),
        (body, *scopes),
        unnamed,
        unused,
    )
    for move in moves:
        _check(outline, move)
    return outline


def _classes_in(body: Mapping[str, Any]) -> dict[str, type]:
    return {key: part for key, part in body.items() if isinstance(part, type) and not key.startswith("_")}


def _without_moves(path: str, body: Mapping[str, Any]) -> TypeError:
    keys = {key.lower(): key for key in body if not key.startswith("_")}
    near = difflib.get_close_matches("moves", keys, n=1)
    hint = f"; did you mean moves by {keys[near[0]]}?" if near else ""
    return TypeError(f"class {path} has no 'moves' between its states; expected a text such as {_FORMS}{hint}")


def _events_within(body: Mapping[str, Any]) -> set[str]:
    """Return the events named by the moves of a class, and by its inner classes if those do not define them."""
    given = body.get("moves", ())
    lines = given.split("\n") if isinstance(given, str) else given
    found = {match[3] for line in lines if (match := _MOVE.fullmatch(line.split("#")[0].strip())) and match[3]}
    for part in body.values():
        if isinstance(part, type):
            inner = _body(part)
            found |= _events_within(inner) - set(inner)
    return found


def _is_state(name: str, value: Any, events: set[str]) -> bool:
    """Return True if a member of a class is a state even if no move names it."""
    if name.startswith("_") or name in ACTIONS or name in events:
        return False
    value = _plain(value)
    if isinstance(value, type):
        body = _body(value)
        return any(key in body for key in (*ACTIONS, "moves")) or any(
            _is_state(key, part, set()) for key, part in body.items() if isinstance(part, type)
        )
    return value is None or (isinstance(value, FunctionType) and not _is_lambda(name, value))


def _is_value(name: str, value: Any) -> bool:
    """Return True if a member of a class is a variable with its initial value."""
    return not name.startswith("_") and name != "moves" and isinstance(value, _VALUES)


def _is_lambda(name: str, value: Any) -> bool:
    """Return True if a member of a class is a lambda."""
    value = _plain(value)
    return (
        not name.startswith("_")
        and name not in ACTIONS
        and isinstance(value, FunctionType)
        and value.__name__ == "<lambda>"
    )


def _move(line: str, path: str) -> Move:
    text = line.split("#")[0].strip()
    found = _MOVE.fullmatch(text)
    if not found:
        raise ValueError(f"moves of {path}: expected {_FORMS}; got {text!r}")
    return Move(found[1], found[2], found[3], found[4])


def _check(outline: Outline, move: Move) -> None:
    """Raise TypeError if the event of a move is missing or cannot be an event."""
    if move.event == DONE:
        says = f"{move}: {DONE} means that the machines in a state have ended"
        if any(DONE in scope for scope in outline.scopes[:-1]):
            raise TypeError(f"{says}; give your event another name")
        if move.source != "*" and not outline.states[move.source].machines:
            raise TypeError(f"{says}; {move.source} has no machines")
        return
    if move.event is None:
        return
    try:
        event = outline.look_up(move.event)
    except LookupError as error:
        raise TypeError(f"{move}: {error}") from None
    if not callable(event) and not hasattr(event, "judge") and not isinstance(event, bool):
        raise TypeError(
            f"{move}: expected a function or a condition as event, got {event!r}; "
            "a function is, for example, lambda scan: scan.distance() < 0.5"
        )


def _body(cls: type) -> Mapping[str, Any]:
    """Return a live view of the members of a class, including inherited members."""
    if cls.__bases__ == (object,):
        return vars(cls)  # a faster lookup at each step
    return ChainMap(*(vars(base) for base in cls.__mro__[:-1]))  # type: ignore[arg-type]  # it is only read


def _plain(value: Any) -> Any:
    return value.__func__ if isinstance(value, (staticmethod, classmethod)) else value
