"""Rewriting a function so that it notes the values that its lines compute, and does all else as before.

The source of the function is parsed, each value is wrapped in a call that notes it and returns it, and the whole is
compiled again in its own place: within its class, its outer function and its file. So line numbers,
columns, closures, names of private members and ``super()`` stay what they were. The call is a constant of the code, no
name: ``globals()`` and ``locals()`` have nothing new.

Nothing is computed twice or in another order. After a comparison its local variables are read once more, which has no
effect. Inner functions, lambdas, comprehensions, f-strings and the targets of assignments stay as they are.
"""

from __future__ import annotations
import __future__

import ast
import copy
import functools
import linecache
import re
import textwrap
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import CodeType, FunctionType, MethodType
from typing import Any, NamedTuple

from .places import (
    CHANGE,
    COMPARE,
    EFFECT,
    MARK,
    OPERAND,
    PASS,
    RAYS,
    TEST,
    VALUE,
    FunctionSource,
    Loop,
    NotedPlace,
    Operand,
)

READS_RAYS = ("distance", "nearest", "at")
"""Methods of a scan that look at some of its rays."""

MOST_EXTRAS = 2
_NOTES = tuple(f"\0robowidgets note {number}\0" for number in range(2 * (MOST_EXTRAS + 1)))
"""Constants that stand for the functions that note, in the order of `Notes`, until the code is bound to them."""
_MOST_PARSES = 5
_SEVERAL = "several functions of its name are on its line"
HOOKS = "\0robowidgets method\0", "\0robowidgets function\0"
"""Constants that stand for two more functions of `Notes`."""
_FUTURES = sum({getattr(__future__, name).compiler_flag for name in __future__.all_feature_names} - {0x10, 0})
"""The flags of code that say which ``from __future__`` imports are in force."""
_GENERATOR, _COROUTINE, _ASYNC_GENERATOR = 0x20, 0x80, 0x200
_RELATIONS: dict[type[ast.cmpop], str] = {
    ast.Lt: "<", ast.LtE: "≤", ast.Gt: ">", ast.GtE: "≥", ast.Eq: "=", ast.NotEq: "≠", ast.Is: "is",
    ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in",
}  # fmt: skip
_OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%", ast.Pow: "**",
    ast.MatMult: "@", ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^", ast.LShift: "<<", ast.RShift: ">>",
}  # fmt: skip
_WITHOUT_VALUE = (
    ast.Pass, ast.Break, ast.Continue, ast.Delete, ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef,
    ast.ClassDef,
)  # fmt: skip
_LEFT_ALONE = (
    ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.JoinedStr, ast.FunctionDef,
    ast.AsyncFunctionDef, ast.ClassDef, ast.Constant,
)  # fmt: skip
"""Expressions and definitions whose parts are not noted."""

NoteCall = Callable[..., Any]
Notes = Sequence[NoteCall]
"""The functions that take a place and a value, and 0, 1 or 2 more values, and return the value; then those for places
in a loop. A `Rewriter` that uses `HOOKS` needs two more, which take the place and a method, and a function to call."""


class NotRewrittenError(Exception):
    """A function cannot be rewritten. The text gives the reason: "its source is not known"."""


@dataclass(frozen=True)
class Rewritten:
    """A function that was rewritten.

    Attributes:
        source: its source.
        code: its code, with constants that stand for the functions that note.
        function: the function as it was.
    """

    source: FunctionSource
    code: CodeType
    function: Callable[..., Any]

    def bind(self, notes: Notes) -> Callable[..., Any]:
        """Return the rewritten function, whose values go to these functions."""
        inner = function_in(self.function)
        code = _bound(self.code, dict(zip((*_NOTES, *HOOKS), notes, strict=False)))
        return with_function(self.function, like(inner, code))


def _bound(code: CodeType, by_name: Mapping[str, Any]) -> CodeType:
    """Return code that calls the functions that note, as do the functions in it."""

    def constant(one: Any) -> Any:
        if type(one) is str:
            return by_name.get(one, one)
        return _bound(one, by_name) if isinstance(one, CodeType) and _is_noting(one) else one

    return code.replace(co_consts=tuple(map(constant, code.co_consts)))


def rewritten(
    function: Callable[..., Any], rewriter: Callable[[CodeType, Sequence[str]], Rewriter] | None = None
) -> Rewritten:
    """Rewrite a function, a method, or a `functools.partial` of one.

    Args:
        function: the function.
        rewriter: makes the rewriter for its code and the lines of its file, or None for `Rewriter`.

    Raises:
        NotRewrittenError: it cannot be rewritten; the text says why.
    """
    code, lines = source_of(function, may_be_wrapped=rewriter is not None)
    with without_warnings(code.co_filename):
        return _rewritten(function, code, lines, (rewriter or Rewriter)(code, lines))


def source_of(function: Callable[..., Any], *, may_be_wrapped: bool = False) -> tuple[CodeType, list[str]]:
    """Return the code of a function, and the lines of its cell or file.

    Args:
        function: the function.
        may_be_wrapped: True to accept the function that a decorator made, whose own lines say nothing.

    Raises:
        NotRewrittenError: the source does not belong to the function; the text says why.
    """
    inner = function_in(function)
    code = inner.__code__
    if code.co_flags & (_GENERATOR | _COROUTINE | _ASYNC_GENERATOR):
        what = "async" if code.co_flags & (_COROUTINE | _ASYNC_GENERATOR) else "a generator"
        raise NotRewrittenError(f"it is {what}")
    if not may_be_wrapped and hasattr(inner, "__wrapped__"):
        raise NotRewrittenError("a decorator wraps it in another function")
    linecache.checkcache(code.co_filename)
    lines = linecache.getlines(code.co_filename, inner.__globals__)
    if not lines or code.co_filename == "<string>":  # by this name Python 3.13 knows the text of `python -c`
        raise NotRewrittenError("its source is not known")
    return code, lines


@contextmanager
def without_warnings(file: str) -> Iterator[None]:
    """Ignore the warnings about the source of a file: Python has warned when the user's own code was compiled.

    `warnings.catch_warnings` restores all filters at its end. If another thread uses it at the same time, the filters
    of one of them may stay in force for ever.
    """
    filters: Any = warnings.filters
    ours = ("ignore", None, Warning, re.compile(re.escape(file.removesuffix(".py")) + r"\Z"), 0)
    filters.insert(0, ours)
    try:
        yield
    finally:
        in_force: Any = warnings.filters  # another thread may have put a copy in force
        for each in (filters, *([in_force] if in_force is not filters else [])):
            if ours in each:  # another thread may have an equal one
                each.remove(ours)


def shown_lines(lines: Iterable[str]) -> tuple[str, ...]:
    """Return lines of a source as views show them, without their common indentation."""
    # Not splitlines(), for which a line ends at a form feed, too.
    return tuple(textwrap.dedent("".join(lines)).expandtabs(4).rstrip("\n").split("\n"))


class Definition(NamedTuple):
    """The definition of a function in the parsed source of its cell or file.

    Attributes:
        tree: the parsed source.
        node: the definition, or a lambda.
        same: among the codes of its name on its line, the positions of the codes that do the same.
        number: the position of its own code, known by its columns, or None.
        is_alone: True if the tree has only its statement.
    """

    tree: ast.Module
    node: Any
    same: list[int]
    number: int | None
    is_alone: bool


def parsed(lines: Sequence[str], file: str) -> ast.Module:
    """Return a parsed source. Python 3.11 raises SystemError if two threads parse at once, so it is tried again."""
    for _ in range(_MOST_PARSES - 1):
        try:
            return ast.parse("".join(lines), file)
        except SystemError:  # noqa: PERF203
            continue
    return ast.parse("".join(lines), file)


def definition_of(code: CodeType, lines: Sequence[str]) -> Definition:
    """Return the definition of a function in the lines of its cell or file; NotRewrittenError if it is not there."""
    changed = NotRewrittenError("its source has changed since it was defined")
    try:
        whole = parsed(lines, code.co_filename)
    except (SyntaxError, ValueError, RecursionError):
        raise changed from None
    # A notebook compiles each statement of a cell by itself, and what Python makes of a call depends on imports.
    for tree in (statement_at(whole, code.co_firstlineno), whole):
        there = codes_like(code, compiled(tree, code, code.co_filename))
        if same := [i for i, one in enumerate(there) if _is_same(one, code)]:
            break
    else:
        raise changed
    nodes: list[Any] = [node for node in ast.walk(tree) if _is_at(node, code)]
    nodes.sort(key=lambda node: (node.lineno, node.col_offset))
    exact = [i for i in same if (columns := _columns(code)) and columns == _columns(there[i])]
    number = exact[0] if len(exact) == 1 else None
    if len(nodes) > 1 and number is not None:
        nodes = _innermost(nodes, code)
    if len(nodes) > 1 and len(nodes) != len(there):
        raise NotRewrittenError(_SEVERAL)
    return Definition(tree, nodes[0] if len(nodes) == 1 else nodes[same[0]], same, number, tree is not whole)


def _rewritten(function: Callable[..., Any], code: CodeType, lines: Sequence[str], rewriter: Rewriter) -> Rewritten:
    tree, node, same, number, _ = definition_of(code, lines)
    rewriter.rewrite(node)
    ast.fix_missing_locations(tree)
    again = codes_like(code, compiled(tree, code, code.co_filename))
    if number is None:
        # A function without any place, such as one that only has a docstring, is as it was.
        number = next((i for i, one in enumerate(again) if _is_noting(one)), same[0])
        # A lambda in the defaults of another one is compiled first, and stands after its beginning.
        if number not in same:
            raise NotRewrittenError(_SEVERAL)
    made = again[number]
    if rewriter.places and not _is_noting(made):
        raise NotRewrittenError(_SEVERAL)
    if made.co_freevars != code.co_freevars or made.co_varnames != code.co_varnames:
        raise NotRewrittenError("its variables would change")
    first, end = code.co_firstlineno, node.end_lineno or code.co_firstlineno
    texts = shown_lines(lines[first - 1 : end])
    source = FunctionSource(
        code.co_name,
        code.co_filename,
        first,
        texts,
        tuple(rewriter.places),
        tuple(rewriter.loops),
        rewriter.reach_of_lines(first, end, lines),
        node.col_offset,
    )
    return Rewritten(source, made, function)


def function_in(function: Any) -> FunctionType:
    """Return the Python function in a callable. Raise NotRewrittenError if it has none."""
    if isinstance(function, functools.partial):
        return function_in(function.func)
    if isinstance(function, MethodType):
        return function_in(function.__func__)
    if isinstance(function, FunctionType):
        return function
    called = next((vars(kind)["__call__"] for kind in type(function).__mro__ if "__call__" in vars(kind)), None)
    if isinstance(called, FunctionType):
        return called
    raise NotRewrittenError("it is not written in Python")


def like(inner: FunctionType, code: CodeType) -> FunctionType:
    """Return a function with another code, and otherwise as a function is: its globals, defaults and closure."""
    made = FunctionType(code, inner.__globals__, inner.__name__, inner.__defaults__, inner.__closure__)
    made.__kwdefaults__ = inner.__kwdefaults__
    made.__qualname__, made.__module__, made.__doc__ = inner.__qualname__, inner.__module__, inner.__doc__
    vars(made).update(vars(inner))
    return made


def with_function(function: Any, made: FunctionType) -> Callable[..., Any]:
    """Return the callable with another Python function in it."""
    if isinstance(function, functools.partial):
        return functools.partial(with_function(function.func, made), *function.args, **function.keywords)
    if isinstance(function, MethodType):
        return MethodType(made, function.__self__)
    return made if isinstance(function, FunctionType) else MethodType(made, function)


def statement_at(tree: ast.Module, line: int) -> ast.Module:
    """Return the statement at a line of a file, with the imports from ``__future__``."""

    def is_kept(node: ast.stmt) -> bool:
        is_future = isinstance(node, ast.ImportFrom) and node.module == "__future__"
        return is_future or _first_line(node) <= line <= (node.end_lineno or line)

    return ast.Module([node for node in tree.body if is_kept(node)], [])


def compiled(tree: ast.Module, code: CodeType, file: str) -> CodeType:
    """Compile a source as the source of a code was compiled, as a file of this name."""
    flags = code.co_flags & _FUTURES | ast.PyCF_ALLOW_TOP_LEVEL_AWAIT
    try:
        compiled: CodeType = compile(tree, file, "exec", flags, dont_inherit=True)
    except (SyntaxError, ValueError, RecursionError) as error:
        raise NotRewrittenError(f"its source does not compile by itself: {error}") from None
    return compiled


def _is_at(node: ast.AST, code: CodeType) -> bool:
    """Return True if a node is the definition of a code's function, by its name and its first line."""
    if isinstance(node, ast.FunctionDef):
        first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
        return node.name == code.co_name and first == code.co_firstlineno
    return isinstance(node, ast.Lambda) and code.co_name == "<lambda>" and node.lineno == code.co_firstlineno


def _columns(code: CodeType) -> list[tuple[int, int, int, int]]:
    """Return first line, column, last line and column of the parts of a code, or none in Python 3.10."""
    positions = code.co_positions() if hasattr(code, "co_positions") else ()
    found: Any = ((line, start, last, end) for line, last, start, end in positions)
    return [one for one in found if None not in one and one[:2] < one[2:]]


def _innermost(nodes: list[Any], code: CodeType) -> list[Any]:
    """Return the innermost lambda that contains all columns of a code, or all nodes if they are not lambdas."""
    columns = _columns(code)
    around = []
    for node in nodes:
        body = getattr(node, "body", None)
        if isinstance(body, ast.expr):
            first, last = (body.lineno, body.col_offset), (body.end_lineno, body.end_col_offset)
            if all(first <= one[:2] and one[2:] <= last for one in columns):
                around.append(node)
    return around[-1:] or nodes


def codes_like(code: CodeType, within: CodeType) -> list[CodeType]:
    """Return the code objects with the same name and first line, from top to bottom."""
    found = []
    for one in within.co_consts:
        if isinstance(one, CodeType):
            if (one.co_name, one.co_firstlineno) == (code.co_name, code.co_firstlineno):
                found.append(one)
            found += codes_like(code, one)
    return found


def is_bound(code: CodeType) -> bool:
    """Return True for the code of a rewritten function, or of a function in one, that notes something."""
    return any(is_bound(one) if isinstance(one, CodeType) else isinstance(one, FunctionType) for one in code.co_consts)


def _is_noting(code: CodeType) -> bool:
    """Return True if a code notes something, or a function in it does."""
    return any(
        _is_noting(one) if isinstance(one, CodeType) else type(one) is str and one in (*_NOTES, *HOOKS)
        for one in code.co_consts
    )


def _is_same(one: Any, other: Any) -> bool:
    """Return True if two codes, or two of their constants, do the same."""
    if type(one) is not type(other):
        return False
    if isinstance(one, CodeType):
        names = ("co_code", "co_names", "co_varnames", "co_freevars", "co_cellvars", "co_argcount", "co_name")
        return (
            all(getattr(one, name) == getattr(other, name) for name in names)
            and _is_same(one.co_consts, other.co_consts)
            and [*one.co_lines()] == [*other.co_lines()]  # else its values would be shown on other lines
        )
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(_is_same, one, other))
    return bool(one == other) or repr(one) == repr(other)


class Rewriter:
    """Rewrites the body of one function."""

    def __init__(self, code: CodeType, lines: Sequence[str]) -> None:
        self.places: list[NotedPlace] = []
        self.loops: list[Loop] = []
        self._lines = [line.encode() for line in lines]
        self._plain = frozenset(code.co_varnames) - {*code.co_cellvars, *code.co_freevars}
        """The local variables that no inner function uses: to read one has no effect."""
        self._loop: int | None = None
        self._is_inner = False
        """True in a comprehension or an inner function, which may run often."""
        self._line = self._body_line = 0
        """The line of the statement, and of the first one."""
        self._raises = 0
        """The number of blocks around it that may catch its exceptions."""
        self._spans: list[tuple[int, int, tuple[int, ...]]] = []
        """Lines of statements, first and last, with their places; inner ones later."""

    def rewrite(self, node: Any) -> None:
        """Rewrite a definition or a lambda."""
        if isinstance(node, ast.Lambda):
            self._line = node.body.lineno
            before = len(self.places)
            node.body = self._value(node.body)
            self._close(node, before)
            return
        body = node.body
        self._body_line = _first_line(body[0])
        if ast.get_docstring(node, clean=False) is not None:
            node.body = [body[0], *self._block(body[1:])]
        else:
            node.body = self._block(body)

    def reach_of_lines(self, first: int, end: int, lines: Sequence[str]) -> dict[int, tuple[int, ...]]:
        """Return for each line of code the places that prove that it was reached."""
        reach: dict[int, tuple[int, ...]] = {}
        for start, last, places in self._spans:
            for line in range(start, last + 1):
                reach[line] = reach.get(line, ()) + places
        # What stands between statements, such as else and try, belongs to the statement after it.
        after: tuple[int, ...] = ()
        for line in range(end, max(first, self._body_line - 1), -1):
            if line in reach:
                after = reach[line]
            elif lines[line - 1].strip() and not lines[line - 1].lstrip().startswith("#") and after:
                reach[line] = after
        return {line: places for line, places in sorted(reach.items()) if line >= first and lines[line - 1].strip()}

    # -- statements ----------------------------------------------------------------------------------------------------

    def _block(self, body: Iterable[ast.stmt], begin: Sequence[ast.stmt] = ()) -> list[ast.stmt]:
        made = list(begin)
        for statement in body:
            made += self._statement(statement)
        return made

    def _statement(self, node: ast.stmt) -> Iterator[ast.stmt]:
        self._line = line = node.lineno
        before = len(self.places)
        if isinstance(node, (ast.Global, ast.Nonlocal)) or (isinstance(node, ast.AnnAssign) and node.value is None):
            yield node  # Python does nothing there.
            return
        if self._raises or _has_no_value(node):
            yield self._mark(node)
        more: list[ast.stmt] = []
        inner: list[tuple[Any, str, list[ast.stmt], int | None]] = []
        """Yield the blocks in a statement: node, field, first statements, and loop."""
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if (pair := _parts_of(targets, node.value)) is not None:
                values, names_of_each = pair
                for i, names in enumerate(names_of_each):
                    values[i] = self._value(values[i], names)
            else:
                node.value = self._value(node.value, _names_of(targets))
        elif isinstance(node, ast.AugAssign):
            node.value = self._sub(node.value)
            text = ast.unparse(node.target)
            if isinstance(node.target, ast.Name):
                more.append(self._note_names(node.target, VALUE, ast.Name(text, ast.Load()), (text,)))
            else:
                operator = Operand(_OPERATORS[type(node.op)] + "=")
                node.value = self._wrap(node.value, CHANGE, names=(text,), operands=[operator])
        elif isinstance(node, (ast.Return, ast.Expr)) and not _has_no_value(node):
            node.value = self._value(node.value, kind=EFFECT if isinstance(node, ast.Expr) else VALUE)
        elif isinstance(node, ast.Assert):
            node.test = self._test(node.test)
        elif isinstance(node, ast.Raise) and node.exc is not None:
            node.exc = self._value(node.exc)
        elif isinstance(node, ast.If):
            node.test = self._test(node.test)
            inner += [(node, "body", [], None), (node, "orelse", [], None)]
        elif isinstance(node, (ast.While, ast.For)):
            loop = len(self.loops)
            self.loops.append(Loop(line, self._loop))
            if isinstance(node, ast.For):
                node.iter = self._value(node.iter)
                first = self._in_loop(loop, functools.partial(self._pass, node.target, node.target))
            else:
                node.test = self._in_loop(loop, functools.partial(self._test, node.test))
                first = self._in_loop(loop, functools.partial(self._pass, node.body[0], None))
            inner += [(node, "body", [first], loop), (node, "orelse", [], None)]
        elif isinstance(node, ast.With):
            for item in node.items:
                item.context_expr = self._value(item.context_expr)
            inner.append((node, "body", [], None))
        elif isinstance(node, ast.Try) or type(node).__name__ == "TryStar":
            handlers: list[ast.ExceptHandler] = node.handlers  # type: ignore[attr-defined]
            inner.append((node, "body", [], None))
            inner += [(handler, "body", [self._begin(handler)], None) for handler in handlers]
            inner += [(node, "orelse", [], None), (node, "finalbody", [], None)]
        elif isinstance(node, ast.Match):
            node.subject = self._value(node.subject)
            for case in node.cases:
                self._line = case.pattern.lineno
                case.guard = None if case.guard is None else self._test(case.guard)
                inner.append((case, "body", [self._begin(case)], None))
        self._close(node, before)
        for of, field, begin, own in inner:
            catches = isinstance(node, ast.With) or (
                of is node and field in ("body", "orelse") and hasattr(of, "handlers")
            )
            self._raises += catches
            around, self._loop = self._loop, self._loop if own is None else own
            setattr(of, field, self._block(getattr(of, field), begin) if getattr(of, field) else [])
            self._loop = around
            self._raises -= catches
        yield node
        yield from more

    def _close(self, node: Any, before: int) -> None:
        """Note the lines of a statement without its blocks. Its places begin at a number."""
        places = tuple(number for number in range(before, len(self.places)) if not self.places[number].is_inner)
        blocks = [getattr(node, name, None) for name in ("body", "orelse", "finalbody", "handlers", "cases")]
        is_open = not isinstance(node, (ast.Lambda, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef))
        inner = [block[0] for block in blocks if isinstance(block, list) and block] if is_open else []
        first = min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", ()))])
        last = min([_first_line(one) - 1 for one in inner], default=node.end_lineno or node.lineno)
        if isinstance(node, ast.Match):
            own = [number for number in places if self.places[number].line == node.lineno]
            self._spans.append((first, max(first, last), tuple(own)))
            for case in node.cases:
                line = case.pattern.lineno
                found = [number for number in places if self.places[number].line == line and number not in own]
                self._spans.append((line, max(line, case.body[0].lineno - 1), tuple(found)))
        elif places and not hasattr(node, "handlers"):
            self._spans.append((first, max(first, last), places))
        for handler in getattr(node, "handlers", ()):
            found = [number for number in places if self.places[number].line == handler.lineno]
            self._spans.append((handler.lineno, max(handler.lineno, handler.body[0].lineno - 1), tuple(found)))

    def _begin(self, node: Any) -> ast.stmt:
        """Return the note at the beginning of an ``except`` or a ``case``, which proves that it was reached."""
        at = node if isinstance(node, ast.ExceptHandler) else node.pattern
        self._line = at.lineno
        return self._mark(node.body[0])

    def _in_loop(self, loop: int, make: Callable[[], Any]) -> Any:
        around, self._loop = self._loop, loop
        made = make()
        self._loop = around
        return made

    def _pass(self, at: Any, target: Any) -> ast.stmt:
        """Return the note at the beginning of a pass of a loop, with its variables if they are local."""
        if target is None or not all(
            one.id in self._plain
            if isinstance(one, ast.Name)
            else isinstance(one, (ast.Tuple, ast.List, ast.expr_context))
            for one in ast.walk(target)
        ):
            return self._mark(at, PASS)
        value = copy.deepcopy(target)
        for one in ast.walk(value):
            if hasattr(one, "ctx"):
                one.ctx = ast.Load()
        return self._note_names(at, PASS, value, _names_of([target]))

    def _mark(self, node: Any, kind: str = MARK) -> ast.stmt:
        return self._note_names(node, kind, ast.Constant(None), ())

    def _note_names(self, at: Any, kind: str, value: ast.expr, names: tuple[str, ...]) -> ast.stmt:
        """Return a statement that notes a value, on the line of a node."""
        if isinstance(at, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)) and at.decorator_list:
            at = at.decorator_list[0]
        here = ast.Constant(None, lineno=at.lineno, col_offset=at.col_offset)
        here.end_lineno, here.end_col_offset = at.lineno, at.col_offset
        for one in ast.walk(value):
            if hasattr(one, "lineno") or isinstance(one, ast.expr):
                ast.copy_location(one, here)
        call = self._wrap(value, kind, names=names, at=here)
        return ast.copy_location(ast.Expr(call), here)

    # -- expressions ---------------------------------------------------------------------------------------------------

    def _value(self, node: Any, names: tuple[str, ...] = (), kind: str = VALUE) -> Any:
        """Return the rewritten value of a statement."""
        if self._is_own(node):
            return self._noted(node, kind, names)
        return self._wrap(self._parts(node), kind, names=names)

    def _test(self, node: Any) -> Any:
        if isinstance(node, ast.Constant):
            return node  # Python leaves out the test of "while True".
        return self._noted(node, kind=TEST) if self._is_own(node) else self._wrap(self._parts(node), TEST)

    def _is_own(self, node: Any) -> bool:
        """Return True for a comparison, or what reads rays: its note has more than its value."""
        return isinstance(node, ast.Compare) or _reads_rays(node)

    def _parts(self, node: Any) -> Any:
        """Return an expression with notes of the parts that decide something or read rays."""
        if isinstance(node, _LEFT_ALONE) or type(node).__name__ == "TemplateStr":
            return node
        if isinstance(node, ast.BoolOp):
            node.values = [self._part(value) for value in node.values]
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            node.operand = self._part(node.operand)
        elif isinstance(node, ast.IfExp):
            # In this order, in which they are computed.
            node.test = self._part(node.test)
            node.body, node.orelse = self._sub(node.body), self._sub(node.orelse)
        elif isinstance(node, ast.NamedExpr):
            node.value = self._wrap(self._sub(node.value), OPERAND, names=(node.target.id,))
        else:
            for name, value in ast.iter_fields(node):
                if isinstance(value, ast.expr):
                    setattr(node, name, self._sub(value))
                elif isinstance(value, list):
                    for i, one in enumerate(value):
                        if isinstance(one, ast.keyword):
                            one.value = self._sub(one.value)
                        elif isinstance(one, ast.expr):
                            value[i] = self._sub(one)
        return node

    def _sub(self, node: Any) -> Any:
        return self._noted(node) if self._is_own(node) else self._parts(node)

    def _part(self, node: Any) -> Any:
        """Return a rewritten part of a condition."""
        if self._is_own(node):
            return self._noted(node)
        if isinstance(node, (ast.BoolOp, ast.Constant)) or (
            isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
        ):
            return self._parts(node)
        return self._wrap(self._parts(node), OPERAND)

    def _noted(self, node: Any, kind: str = "", names: tuple[str, ...] = ()) -> Any:
        """Return a noted comparison with its sides, or a noted call that reads rays with its scan and sector."""
        if not isinstance(node, ast.Compare):
            return self._noted_rays(node, kind or RAYS, names)
        has_walrus = any(isinstance(one, ast.NamedExpr) for one in ast.walk(node))
        sides = [node.left, *node.comparators]
        made: list[ast.expr] = []
        operands: list[Operand] = []
        extras: list[ast.expr] = []
        for i, side in enumerate(sides):
            operand, side, extra = self._operand(side, len(extras), is_read=i < 2 and not has_walrus)
            operands.append(operand)
            made.append(side)
            extras += extra
        node.left, node.comparators = made[0], made[1:]
        chain = tuple(_RELATIONS[type(one)] for one in node.ops)
        noted: dict[str, Any] = {"extras": extras, "chain": chain, "operands": operands}
        return self._wrap(node, kind or COMPARE, names=names, relation=chain[0] * (len(chain) == 1), **noted)

    def _noted_rays(self, node: Any, kind: str, names: tuple[str, ...]) -> Any:
        has_walrus = any(isinstance(one, ast.NamedExpr) for one in ast.walk(node))
        scan, node.func.value, extras = self._operand(node.func.value, 0, is_read=not has_walrus)
        operands = [scan]
        for i, argument in enumerate(node.args):
            if i == 0 and not isinstance(argument, ast.Starred):
                sector, node.args[0], more = self._operand(argument, len(extras), is_read=not has_walrus)
                operands.append(sector)
                extras += more
            else:
                node.args[i] = self._sub(argument)
        for keyword in node.keywords:
            if keyword.arg == "sector" and not node.args:
                sector, keyword.value, more = self._operand(keyword.value, len(extras), is_read=not has_walrus)
                operands.append(sector)
                extras += more
            else:
                keyword.value = self._sub(keyword.value)
        noted: dict[str, Any] = {"extras": extras, "relation": node.func.attr, "operands": operands}
        return self._wrap(node, kind, names=names, **noted)

    def _operand(self, node: Any, extras: int, *, is_read: bool) -> tuple[Operand, Any, list[ast.expr]]:
        """Return a side of a comparison and its node; for a local variable, also expressions that read it."""
        text = self._text_of(node)
        try:
            return Operand(text, constant=ast.literal_eval(node)), node, []
        except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
            pass
        if is_read and isinstance(node, ast.Name) and node.id in self._plain:
            return Operand(text, extra=extras), node, [ast.copy_location(ast.Name(node.id, ast.Load()), node)]
        if self._is_own(node):
            made = self._noted(node)
            return Operand(text, place=len(self.places) - 1), made, []
        made = self._wrap(self._parts(node), OPERAND)
        return Operand(text, place=len(self.places) - 1), made, []

    def _wrap(
        self,
        node: Any,
        kind: str,
        *,
        names: tuple[str, ...] = (),
        extras: Sequence[ast.expr] = (),
        relation: str = "",
        chain: tuple[str, ...] = (),
        operands: Sequence[Operand] = (),
        at: Any = None,
    ) -> ast.expr:
        """Return a call that notes the value of an expression."""
        at = node if at is None else at
        is_shown_there = kind in (COMPARE, OPERAND, RAYS)
        line: int = at.lineno if is_shown_there else self._line
        text = "" if kind in (MARK, PASS) else self._text_of(at)
        what = kind, line, text, len(extras), names, relation, tuple(operands), self._loop, chain, self._is_inner
        self.places.append(NotedPlace(*what))
        number = ast.copy_location(ast.Constant(len(self.places) - 1), at)
        which = len(extras) + (MOST_EXTRAS + 1 if self._is_inner or self._loop is not None else 0)
        function = ast.copy_location(ast.Constant(_NOTES[which]), at)
        return ast.copy_location(ast.Call(function, [number, node, *extras], []), at)

    def _text_of(self, node: Any) -> str:
        """Return the source of an expression in one line. Columns of nodes count bytes."""
        lines = self._lines[node.lineno - 1 : node.end_lineno]
        if not lines:
            return ""
        lines[-1] = lines[-1][: node.end_col_offset]
        lines[0] = lines[0][node.col_offset :]
        return " ".join(b"".join(lines).decode(errors="replace").split())


def _has_no_value(node: Any) -> bool:
    """Return True for a statement that computes nothing that is noted."""
    if isinstance(node, ast.Raise):
        return node.exc is None
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant)
    if isinstance(node, (ast.If, ast.Assert)):
        return isinstance(node.test, ast.Constant)
    return isinstance(node, _WITHOUT_VALUE) or (isinstance(node, ast.Return) and node.value is None)


def _reads_rays(node: Any) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in READS_RAYS


def _names_of(targets: Sequence[Any]) -> tuple[str, ...]:
    """Return the texts of the targets that get one part of a value each, or one text if all get the whole value."""
    if len(targets) == 1 and isinstance(targets[0], (ast.Tuple, ast.List)):
        return tuple(map(ast.unparse, targets[0].elts))
    return (" = ".join(map(ast.unparse, targets)),)


def _parts_of(targets: Sequence[ast.expr], value: ast.expr) -> tuple[list[ast.expr], list[tuple[str, ...]]] | None:
    """Return the values of ``a, b = c, d`` and the names of each, or None for any other assignment."""
    target = targets[0]
    if len(targets) > 1 or not isinstance(target, (ast.Tuple, ast.List)) or not isinstance(value, ast.Tuple):
        return None
    both = [*target.elts, *value.elts]
    if len(target.elts) != len(value.elts) or any(isinstance(one, ast.Starred) for one in both):
        return None
    return value.elts, [_names_of([one]) for one in target.elts]


def _first_line(node: Any) -> int:
    if hasattr(node, "pattern"):
        return int(node.pattern.lineno)
    return int(min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", ()))]))
