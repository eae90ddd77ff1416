"""The numbers in the source of a function, and the function with another number in it."""

from __future__ import annotations

import ast
import linecache
import re
import textwrap
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from types import CodeType, FunctionType
from typing import Any, NamedTuple

from ...reasons.rewriting import (
    NotRewrittenError,
    codes_like,
    compiled,
    definition_of,
    function_in,
    like,
    parsed,
    source_of,
    statement_at,
    with_function,
    without_warnings,
)

LARGEST = 1e9
"""The largest number that has a slider."""

_PLAIN = re.compile(r"\d[\d_]*(\.[\d_]*)?([eE][+-]?\d+)?|\.\d[\d_]*([eE][+-]?\d+)?")
_GIVEN = re.compile(r"-?\d{1,10}(\.\d{1,12})?")
"""The numbers that a page may ask for."""
_MOST_FILES = 50
"""Sources of changed functions that tracebacks can show."""

_files: deque[str] = deque()


class NotChangedError(ValueError):
    """A number cannot be changed. The text gives the reason."""


class Number(NamedTuple):
    """A number that stands in the source of a function.

    Attributes:
        line: the number of its line in the function, from 0.
        column: its first character in the line as views show it.
        text: its source, with its sign.
        why: the reason why it cannot be changed; empty if it can.
    """

    line: int
    column: int
    text: str
    why: str = ""


class Changed(NamedTuple):
    """A function with another number in it.

    Attributes:
        function: the callable.
        text: the changed text of the whole cell or file.
        before: the text as it was.
    """

    function: Callable[..., Any]
    text: str
    before: str


class _Found(NamedTuple):
    """A number with its node, its line in the file, its bytes there, and its default.

    ``default`` is the position among the defaults, the name of a parameter that is only given by name, or None.
    """

    number: Number
    node: ast.expr
    lineno: int
    start: int
    end: int
    default: int | str | None = None


def numbers_in(function: Callable[..., Any]) -> list[Number]:
    """Return the numbers in the source of a function, from top to bottom, or an empty list without a source."""
    try:
        code, lines = source_of(function)
        with without_warnings(code.co_filename):
            node = definition_of(code, lines).node
            return [found.number for found in _numbers(function, code, lines, node)]
    except NotRewrittenError:
        return []


def with_number(function: Callable[..., Any], line: int, column: int, text: str, file: str = "") -> Changed:
    """Return a function with another number in its source. It has the same globals, closure and other defaults.

    Args:
        function: the function.
        line: the number of its line, as in `Number`.
        column: its column, as in `Number`.
        text: the new number.
        file: the name under which tracebacks find the changed source, or empty to compile only.

    Raises:
        NotChangedError: the number cannot be changed, or not to this one; the text says why.
    """
    if not _GIVEN.fullmatch(text):
        raise NotChangedError(f"expected a number such as 0.6, got {text[:40]!r}")
    try:
        code, lines = source_of(function)
        with without_warnings(code.co_filename):
            return _changed(function, code, lines, (line, column), text, file)
    except NotRewrittenError as error:
        raise NotChangedError(str(error)) from None


def _changed(
    function: Callable[..., Any], code: CodeType, lines: list[str], place: tuple[int, int], text: str, file: str
) -> Changed:
    tree, node, same, number, is_alone = definition_of(code, lines)
    for found in _numbers(function, code, lines, node):
        if (found.number.line, found.number.column) == place:
            break
    else:
        raise NotChangedError(
            f"expected a number in line {code.co_firstlineno + place[0]} at column {place[1] + 1}; run the cell again"
        )
    if found.number.why:
        raise NotChangedError(found.number.why)
    is_whole = isinstance(ast.literal_eval(found.number.text), int)
    if is_whole and "." in text:
        raise NotChangedError(f"{found.number.text} is a whole number: expected another one, got {text}")
    meant = ast.dump(_Exchanged(found.node, text).visit(tree))
    for written in (text, f"({text})"):  # -1 ** 2 is not (-1) ** 2
        made = _with_text(lines, found, written)
        try:
            whole = parsed(made, code.co_filename)
        except (SyntaxError, ValueError):
            continue
        after = statement_at(whole, code.co_firstlineno) if is_alone else whole
        if ast.dump(after) == meant:
            break
    else:
        raise NotChangedError(f"{text} would give its line another meaning; write it in the cell")
    name = file or code.co_filename
    there = codes_like(code, compiled(after, code, name))
    which = same[0] if number is None else number
    if which >= len(there) or there[which].co_freevars != code.co_freevars:
        raise NotChangedError("several functions are on its line; write each on a line of its own")
    if file:
        _remember(file, made)
    inner = like(function_in(function), there[which])
    _set_default(inner, found.default, ast.literal_eval(text))
    return Changed(with_function(function, inner), "".join(made), "".join(lines))


def _with_text(lines: Sequence[str], found: _Found, text: str) -> list[str]:
    line = lines[found.lineno - 1].encode()
    changed = line[: found.start] + text.encode() + line[found.end :]
    return [*lines[: found.lineno - 1], changed.decode(), *lines[found.lineno :]]


def _set_default(inner: FunctionType, default: int | str | None, value: float) -> None:
    if isinstance(default, int):
        values = [*(inner.__defaults__ or ())]
        values[default] = value
        inner.__defaults__ = tuple(values)
    elif default is not None:
        inner.__kwdefaults__ = {**(inner.__kwdefaults__ or {}), default: value}


def _remember(file: str, lines: list[str]) -> None:
    """Store a source for tracebacks, `inspect` and the rewriting of lines. Later ones replace the oldest."""
    linecache.cache[file] = sum(map(len, lines)), None, lines, file
    if file not in _files:
        _files.append(file)
    while len(_files) > _MOST_FILES:
        linecache.cache.pop(_files.popleft(), None)


class _Exchanged(ast.NodeTransformer):
    """Puts a number in the place of a node."""

    def __init__(self, node: ast.expr, text: str) -> None:
        self._node, self._made = node, ast.parse(text, mode="eval").body

    def visit(self, node: ast.AST) -> Any:
        return self._made if node is self._node else self.generic_visit(node)


def _numbers(function: Callable[..., Any], code: CodeType, lines: Sequence[str], node: Any) -> Iterator[_Found]:
    """Yield the numbers of a definition, from top to bottom."""
    first, end = code.co_firstlineno, node.end_lineno
    own = lines[first - 1 : end]
    margin = len(own[0].rstrip("\n")) - len(textwrap.dedent("".join(own)).split("\n")[0])
    found: list[_Found] = []

    def add(at: ast.expr, why: str = "", default: int | str | None = None) -> None:
        line = lines[at.lineno - 1].encode()
        start, stop = at.col_offset, at.end_col_offset or 0
        text = line[start:stop].decode(errors="replace")
        column = len(line[:start].decode(errors="replace")[margin:].expandtabs(4))
        number = Number(at.lineno - first, column, text, why or _why_not(text))
        found.append(_Found(number, at, at.lineno, start, stop, default))

    def look(at: Any, why: str = "") -> None:
        if _is_number(at):
            add(at, why)
        elif not isinstance(at, ast.JoinedStr):  # before Python 3.12, their parts have wrong columns
            for child in ast.iter_child_nodes(at):
                look(child, why)

    if isinstance(node, ast.Lambda):
        look(node.body)
    else:
        for decorator in node.decorator_list:
            look(decorator, "the decorator was called when its cell ran: change it in the cell")
        for statement in node.body:
            look(statement)
    inner, arguments = function_in(function), node.args
    by_name = [(each.arg, default) for each, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)]
    for key, default in (*enumerate(arguments.defaults), *by_name):
        values: Any = inner.__kwdefaults__ if isinstance(key, str) else inner.__defaults__
        if default is not None and _is_number(default):
            is_as_written = values[key] == ast.literal_eval(default)
            add(default, "" if is_as_written else "its default was changed since its cell ran", key)
        elif default is not None:
            look(default, "the default was computed when its cell ran: change it in the cell")
    yield from sorted(found, key=lambda one: (one.lineno, one.start))


def _is_number(node: Any) -> bool:
    """Return True for a number, or a number with a minus sign, on one line."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return isinstance(node.operand, ast.Constant) and _is_number(node.operand) and node.lineno == node.end_lineno
    return isinstance(node, ast.Constant) and type(node.value) in (int, float, complex)


def _why_not(text: str) -> str:
    """Return the reason why a number has no slider, or an empty text."""
    if not _PLAIN.fullmatch(text.removeprefix("-").strip()):
        return f"{text[:40]} is not a plain decimal number: change it in the cell"
    if not abs(ast.literal_eval(text)) <= LARGEST:
        return "it is too large for a slider: change it in the cell"
    return ""
