"""The function of a recorded program, made from the text of its cell or file."""

from __future__ import annotations

import ast
import linecache
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any

from .version import RATE, to_rate

_DEFINITIONS = (ast.FunctionDef, ast.ClassDef)
_PLAIN = (
    ast.Constant, ast.Name, ast.Tuple, ast.List, ast.Dict, ast.Set, ast.UnaryOp, ast.BinOp, ast.operator, ast.unaryop,
    ast.expr_context,
)  # fmt: skip
"""Parts of expressions that can do nothing but compute."""
_OF_NOTEBOOK = (ModuleType, type, FunctionType, BuiltinFunctionType, float, int, str, bytes, tuple, type(None))
"""Types of values of the notebook that a recorded program may use: no feed, through which it could drive."""


class RecordedProgramError(ValueError):
    """No function can be made of the text. The error gives the reason."""


@dataclass(frozen=True)
class RecordedProgram:
    """The text of a recorded program, of which nothing has run yet.

    Attributes:
        name: the name of its function or class.
        file: a name for the text, as in tracebacks.
        text: its definitions, imports and constants; other lines are empty, so that numbers of lines stay the same.
        first: the number of the first line of the function or class.
        lines: the lines of the function or class.
        rate: steps per second.
        topics: the topics that were named for parameters.
    """

    name: str
    file: str
    text: str
    first: int
    lines: tuple[str, ...]
    rate: float = RATE
    topics: Mapping[str, str] = field(default_factory=dict)

    def make(self, notebook: Mapping[str, Any]) -> Any:
        """Run the definitions, and return the function or the class.

        Decorators are left out, since they would start the program on the robot. Names that the text does not define
        are functions, classes, modules and constants of the notebook.
        """
        names = {name: value for name, value in notebook.items() if isinstance(value, _OF_NOTEBOOK)}
        names["__name__"] = "robowidgets_recorded_program"
        # Without a time, linecache never looks for a file of this name. The lines of the function are noted by them.
        linecache.cache[self.file] = (len(self.text), None, self.text.splitlines(keepends=True), self.file)
        exec(compile(self.text, self.file, "exec", dont_inherit=True), names)
        return names[self.name]


def recorded_program(name: str, text: str, file: str) -> RecordedProgram:
    """Return the program of this name in a text, without running any of it.

    Args:
        name: the name of the function or class.
        text: the text of a cell or file.
        file: a name for the text, as in tracebacks.

    Raises:
        RecordedProgramError: the text does not define the program, or cannot be parsed.
    """
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError) as error:
        raise RecordedProgramError(f"its text is not Python: {error}") from None
    found = [node for node in tree.body if isinstance(node, _DEFINITIONS) and node.name == name]
    if not found:
        what = "the text of its cell is not in the recording" if not text else "its cell does not define it"
        raise RecordedProgramError(what)
    definition = found[-1]
    lines = text.splitlines(keepends=True)
    rate, topics = _options(tree, definition)
    own = range(definition.lineno, (definition.end_lineno or definition.lineno) + 1)
    return RecordedProgram(
        name,
        file,
        _reduced(tree, lines),
        definition.lineno,
        tuple(lines[number - 1].rstrip("\r\n") for number in own),
        rate,
        topics,
    )


def _reduced(tree: ast.Module, lines: list[str]) -> str:
    """Return the text with empty lines for the decorators, and for all that is no definition, import or constant."""
    kept: set[int] = set()
    for node in tree.body:
        if _only_defines(node):
            kept.update(_lines_of(node))
    for node in tree.body:
        if not _only_defines(node):  # several statements may share a line
            kept.difference_update(_lines_of(node))
        elif isinstance(node, _DEFINITIONS):
            for decorator in node.decorator_list:
                kept.difference_update(range(decorator.lineno, (decorator.end_lineno or decorator.lineno) + 1))
    return "".join(line if number in kept else "\n" for number, line in enumerate(lines, 1))


def _lines_of(node: ast.stmt) -> range:
    first = min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", []))])
    return range(first, (node.end_lineno or node.lineno) + 1)


def _only_defines(node: ast.stmt) -> bool:
    if isinstance(node, (ast.Import, ast.ImportFrom, *_DEFINITIONS)):
        return True
    if isinstance(node, (ast.Assign, ast.AnnAssign)):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        names = [part for one in targets for part in (one.elts if isinstance(one, ast.Tuple) else [one])]
        return node.value is not None and _is_plain(node.value) and all(isinstance(one, ast.Name) for one in names)
    return False


def _is_plain(value: ast.expr) -> bool:
    if isinstance(value, ast.Call):
        of = value.func.value if isinstance(value.func, ast.Attribute) else None
        is_math = isinstance(of, ast.Name) and of.id in ("math", "np", "numpy")
        return is_math and not value.keywords and all(map(_is_plain, value.args))
    if isinstance(value, ast.Attribute):
        return isinstance(value.value, ast.Name) and value.value.id in ("math", "np", "numpy")
    return isinstance(value, _PLAIN) and all(
        _is_plain(part) if isinstance(part, ast.expr) else isinstance(part, _PLAIN)
        for part in ast.iter_child_nodes(value)
    )


def _options(tree: ast.Module, definition: ast.FunctionDef | ast.ClassDef) -> tuple[float, dict[str, str]]:
    """Return the rate and the topics that were given with the program, if they are written as constants."""
    rate, topics = RATE, {}
    for call in _calls(tree, definition):
        for keyword in call.keywords:
            value = keyword.value.value if isinstance(keyword.value, ast.Constant) else None
            if keyword.arg == "rate" and isinstance(value, (int, float)):
                rate = float(value)
            elif keyword.arg not in (None, "on") and isinstance(value, str):
                topics[str(keyword.arg)] = value
    try:
        return to_rate(rate), topics
    except ValueError:
        return RATE, topics


def _calls(tree: ast.Module, definition: ast.FunctionDef | ast.ClassDef) -> Iterator[ast.Call]:
    """Yield the calls of `program` of a feed with this function, also as a decorator."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "program":
            is_given = bool(node.args) and isinstance(node.args[0], ast.Name) and node.args[0].id == definition.name
            if is_given or node in definition.decorator_list:
                yield node
