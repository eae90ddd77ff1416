"""The effects of a function beyond its return value: with them, another version cannot be tried without a trace."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable, Iterator, Mapping
from enum import Enum
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from ...reasons.rewriting import NotRewrittenError, definition_of, source_of, without_warnings
from ...samples.ray import Ray
from ...samples.scan import Scan
from ...samples.sector import Sector
from ..drive import Drive

_PURE_MODULES = frozenset(
    ("math", "cmath", "numpy", "time", "collections", "itertools", "functools", "operator", "statistics", "enum")
)
_IMPURE = frozenset((
    "save", "savez", "savez_compressed", "savetxt", "load", "loadtxt", "fromfile", "memmap", "copyto", "put", "place",
    "putmask", "seterr", "setbufsize", "set_printoptions",
))  # fmt: skip
"""Names in these modules that change something, or read a file."""
_PURE_BUILTINS = frozenset((
    "abs", "all", "any", "bool", "bytes", "complex", "dict", "divmod", "enumerate", "filter", "float", "format",
    "frozenset", "int", "isinstance", "issubclass", "iter", "len", "list", "map", "max", "min", "next", "pow", "print",
    "range", "repr", "reversed", "round", "set", "slice", "sorted", "str", "sum", "tuple", "type", "zip",
))  # fmt: skip
_CLASSES = (Drive, Ray, Scan, Sector)
_COPIED = ("state", "variables")
"""Parameters that a trial gets as copies."""
_MISSING = object()
_MOST_ENTRIES = 1000
"""Entries of a list outside of a function that are looked at."""


def effect_of(function: Callable[..., Any]) -> str:
    """Return the first possible effect of a function on something outside, as text, or an empty one.

    It may use numbers, texts, mathematics, the classes of samples, and functions of the user for which the same is
    true. All else may have an effect, such as an object with methods.
    """
    return _effect_of(function, set())


def _effect_of(function: Callable[..., Any], seen: set[CodeType]) -> str:
    if type(function) is not FunctionType:
        return "it belongs to an object"
    if function.__code__ in seen:
        return ""
    seen.add(function.__code__)
    try:
        code, lines = source_of(function)
        with without_warnings(code.co_filename):
            node = definition_of(code, lines).node
    except NotRewrittenError as error:
        return str(error)
    defaults = [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()]
    if not all(map(_is_plain, defaults)):
        return "one of its defaults is an object"
    body = node.body if isinstance(node.body, list) else [node.body]
    return next(_Reading(function, seen).effects(body), "")


class _Reading:
    """Reads the body of a function.

    Args:
        function: the function.
        seen: the codes of the functions that were read.
    """

    def __init__(self, function: FunctionType, seen: set[CodeType]) -> None:
        code = function.__code__
        self._seen = seen
        self._own = _names_of(code)
        self._given = {*code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]} - {*_COPIED}
        self._outside = _names_outside(function)
        self._parents: dict[ast.AST, ast.AST] = {}

    def effects(self, body: list[ast.AST]) -> Iterator[str]:
        for node in (inner for statement in body for inner in ast.walk(statement)):
            for child in ast.iter_child_nodes(node):
                self._parents[child] = node
            if isinstance(node, (ast.Global, ast.Nonlocal)):
                yield f"it changes {', '.join(node.names)}, which is outside of it"
            elif isinstance(node, (ast.Import, ast.ImportFrom)):
                names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [each.name for each in node.names]
                yield from (f"it imports {name}" for name in names if not _is_pure(name))
            elif isinstance(node, (ast.Attribute, ast.Subscript)) and not isinstance(node.ctx, ast.Load):
                name = _root(node)
                if name is None or name in self._given or name not in self._own:
                    yield f"it changes {name or ast.unparse(node)[:60]}, which is outside of it"
            elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and _root(node.value) in self._given:
                yield f"it calls {ast.unparse(node.value.func)[:60]}(), which may change something outside of it"
            elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id not in self._own:
                yield from self._use(node)

    def _use(self, name: ast.Name) -> Iterator[str]:
        """Yield the effect of a use of something outside, if it may have one."""
        node: ast.AST = name
        if name.id not in self._outside:
            yield f"it uses {name.id}, which is not defined"
            return
        value = self._outside[name.id]
        while isinstance(value, ModuleType) and isinstance(parent := self._parents.get(node), ast.Attribute):
            node, value = parent, getattr(value, parent.attr, _MISSING)
        if self._is_read_only(value, node):
            return
        if type(value) is FunctionType and not _is_pure(value.__module__):
            if why := _effect_of(value, self._seen):
                yield f"it uses {name.id}: {why}"
            return
        parent = self._parents.get(node)
        text = ast.unparse(parent if isinstance(parent, ast.Attribute) else node)[:60]
        yield f"it uses {text}, which may change something outside of it"

    def _is_read_only(self, value: Any, node: ast.AST) -> bool:
        """Return True if a use cannot change a value."""
        if _is_plain(value) or any(value is each for each in _CLASSES):
            return True
        if isinstance(value, type) and issubclass(value, (Enum, BaseException)):
            return True
        name = getattr(value, "__name__", None) if callable(value) else None
        if isinstance(name, str) and getattr(builtins, name, None) is value:
            return name in _PURE_BUILTINS
        if isinstance(value, np.ufunc):  # before NumPy 2 it has no module, and a function of the user may be in one
            return getattr(np, value.__name__, None) is value
        if isinstance(name, str) and _is_pure(getattr(value, "__module__", None) or ""):
            return name not in _IMPURE
        # A list of numbers may be read, but not be given a second name, by which it could be changed.
        parent = self._parents.get(node)
        if isinstance(parent, ast.Call):
            called = parent.func.id if isinstance(parent.func, ast.Name) else ""
            is_read = node in parent.args and called in _PURE_BUILTINS - self._own
        else:
            is_item = isinstance(parent, ast.Subscript) and parent.value is node
            is_loop = isinstance(parent, (ast.For, ast.comprehension)) and parent.iter is node
            is_read = is_item or is_loop or isinstance(parent, (ast.Compare, ast.BinOp))
        return is_read and _is_list_of_plain(value)


def _names_of(code: CodeType) -> set[str]:
    """Return the local names of a function, and of the functions within."""
    inner = [const for const in code.co_consts if isinstance(const, CodeType)]
    return {*code.co_varnames, *code.co_cellvars}.union(*map(_names_of, inner))


def _names_outside(function: FunctionType) -> Mapping[str, Any]:
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    empty = CellType()
    closed = {name: cell.cell_contents for name, cell in cells if cell != empty}  # equal if not assigned yet
    return {**vars(builtins), **function.__globals__, **closed}


def _is_pure(module: str) -> bool:
    return module.partition(".")[0] in _PURE_MODULES and not module.startswith("numpy.random")


def _is_plain(value: Any) -> bool:
    kind = type(value)
    if kind is tuple or kind is frozenset:
        return all(map(_is_plain, value))
    return value is None or kind in (bool, int, float, complex, str, bytes) or isinstance(value, (Enum, np.generic))


def _is_list_of_plain(value: Any) -> bool:
    if type(value) is np.ndarray:
        return value.dtype.kind in "biufc"
    if type(value) not in (list, dict, set) or len(value) > _MOST_ENTRIES:
        return False
    return all(map(_is_plain, value.values() if type(value) is dict else value))


def _root(node: ast.AST) -> str | None:
    """Return the name that an attribute, an item or a call begins with."""
    while isinstance(node, (ast.Attribute, ast.Subscript, ast.Call)):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node.id if isinstance(node, ast.Name) else None
