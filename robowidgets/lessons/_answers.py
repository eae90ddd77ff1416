"""A process that runs the answers of one submission, but does not judge them.

It reads messages of the grader from standard input, and replies to each with one line of JSON. A reply contains an
answer, never a mark.
"""

from __future__ import annotations

import ast
import contextlib
import json
import os
import pickle
import re
import sys
from collections.abc import Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

from ..behaviors.drive import Drive
from ..behaviors.simulation import ProgramRun
from ..runtime.user_function import error_in

OWN = ("state", "variables")
"""The inputs of a program that stay in this process."""

_PAGE = re.compile(r"^(feeds|lessons|robot|display|\w*Widget|show)$")
"""Names whose calls show or connect something. Cells that define answers do not need them."""
_USED = ("behaviors", "recordings.search.conditions", "feeds", "lessons", "simulator")
"""Modules that lessons import."""

_MOST_MEMORY, _MOST_FILE, _MOST_SECONDS = 4 << 30, 1 << 20, 600
"""The limits of a submission: bytes of memory, bytes of a file, and seconds of processor time."""


def serve(ids: tuple[int, int] | None = None) -> None:
    """Answer messages until standard input ends.

    Args:
        ids: the ids of the user and the group that run the answers, or None for the user who started this process. The
            process becomes that user after its imports, so that the user need not have access to the installation.
    """
    given, replies = sys.stdin.buffer, os.fdopen(os.dup(1), "w", encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (1, 2):
        os.dup2(nothing, number)
    sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: SIM115
    _limit()
    for name in _USED:
        import_module(f"robowidgets.{name}")
    if ids is not None and os.geteuid() != ids[0]:
        os.setgroups([])
        os.setgid(ids[1])
        os.setuid(ids[0])
    answers, run = dict[str, Any](), None
    while True:
        try:
            act, *rest = pickle.load(given)
        except EOFError:
            return
        try:
            if act == "load":
                answers = _load(*rest)
                reply: Any = sorted(answers)
            elif act == "begin":
                run = _Run(answers[rest[0]], is_program=rest[1])
                reply = run.asks_for
            else:
                assert run is not None
                reply = _plain(run(rest[0]))
        except BaseException as error:
            reply = {"error": _text_of(error, with_line=act != "begin")[:500]}
        replies.write(json.dumps(reply, default=repr).replace("\n", " ") + "\n")
        replies.flush()


class _Run:
    """An answer in one case: a function, or a program with its state."""

    def __init__(self, answer: Any, *, is_program: bool) -> None:
        self._answer = answer
        self._run: ProgramRun | None = None
        self.asks_for: list[str] = []
        if is_program:
            self._run = ProgramRun(answer)
            self.asks_for = [name for name in self._run.asks_for if name not in OWN]

    def __call__(self, values: Any) -> Any:
        return self._answer(values) if self._run is None else self._run.call(values)


def _load(cells: list[str], checks: list[list[tuple[str, str]]]) -> dict[str, Any]:
    """Run the definitions of each cell, and return the last answer to each task."""
    module = sys.modules["answers"] = ModuleType("answers")  # a state machine looks for its events in it
    names = vars(module)
    found: dict[str, Any] = {}
    for number, (cell, asked) in enumerate(zip(cells, checks, strict=True)):
        for part in _definitions(cell):
            with contextlib.suppress(BaseException):  # the answers may not need this definition
                exec(compile(ast.Module([part], []), f"<cell {number}>", "exec"), names)
        found.update({task: names[name] for name, task in asked if name in names})
    return found


def _definitions(cell: str) -> Iterator[ast.stmt]:
    """Yield the imports, functions, classes and values of a cell, but not the calls that show, connect or check."""
    lines = (re.sub(r"^[%!?].*", "pass", line) for line in cell.split("\n"))
    try:
        module = ast.parse("\n".join(lines))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for part in module.body:
        if isinstance(part, (ast.FunctionDef, ast.ClassDef)):
            part.decorator_list = []  # such as @robot.program
            yield part
        elif isinstance(part, (ast.Import, ast.ImportFrom)) or (
            isinstance(part, (ast.Assign, ast.AnnAssign))
            and not any(isinstance(inner, ast.Name) and _PAGE.match(inner.id) for inner in ast.walk(part))
        ):
            yield part


def _text_of(error: BaseException, *, with_line: bool) -> str:
    try:
        return error_in(error) if with_line else str(error)
    except BaseException:  # raised by an exception class that the answer defines
        return type(error).__name__


def _plain(value: Any) -> Any:
    """Return an answer and its kind as values for JSON."""
    if value is None:
        return {"kind": "none"}
    if isinstance(value, Drive):
        return {"kind": "drive", "values": [float(value.linear), float(value.angular), float(value.lateral)]}
    if isinstance(value, (str, bytes)):
        return {"kind": "other", "text": repr(value)[:70]}
    if isinstance(value, bool) or type(value).__name__ in ("bool", "bool_"):
        return {"kind": "bool", "value": bool(value)}
    with contextlib.suppress(Exception):
        return {"kind": "number", "value": float(value)}
    with contextlib.suppress(Exception):
        first, second = value
        return {"kind": "pair", "values": [float(first), float(second)]}
    try:
        return {"kind": "other", "text": repr(value)[:70]}
    except Exception:
        return {"kind": "other", "text": f"an object of {type(value).__name__}"[:70]}


def _limit() -> None:
    """Limit the resources of this process, if the system supports it."""
    try:
        import resource
    except ImportError:  # Windows
        return
    for name, most in (("RLIMIT_AS", _MOST_MEMORY), ("RLIMIT_FSIZE", _MOST_FILE), ("RLIMIT_CPU", _MOST_SECONDS)):
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(getattr(resource, name), (most, most))
