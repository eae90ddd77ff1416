"""The rewriting of a condition: it notes only what the condition reads from samples and compares, to be fast."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator, Sequence
from types import CodeType
from typing import Any

from .places import CHANGE, EFFECT, MARK, OPERAND, PASS, RAYS, TEST, VALUE, Operand
from .rewriting import HOOKS, READS_RAYS, Rewriter

PART, ALL, EACH = "part", "all", "each"
"""Relations of places in addition to the names in `READS_RAYS`: a part of the ranges or one ray, a call that takes all
ranges and reads them if it returns a number, and a loop over all ranges."""

_WHOLE_LINES = (VALUE, TEST, EFFECT, CHANGE, MARK, PASS)
_NO_RELATIONS = (ast.Is, ast.IsNot, ast.In, ast.NotIn)
_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
_READ_NO_RANGES = ("id", "isinstance", "len", "print", "repr", "str", "type")
_READ_EACH = ("enumerate", "filter", "iter", "list", "map", "reversed", "set", "sorted", "tuple", "zip")


class Looker(Rewriter):
    """Rewrites the reads of rays and ranges, also in inner functions, and comparisons.

    In loops only comparisons of distances are noted. Methods that read rays, as in ``map(scan.distance, sectors)``, and
    functions that are called by name, or as an attribute, go through `HOOKS`.
    """

    def __init__(self, code: CodeType, lines: Sequence[str]) -> None:
        super().__init__(code, lines)
        self._parameters = {*code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]}
        self._distances: set[str] = set()
        """Names of values that were computed from reads of rays."""
        self._ranges: set[str] = set()
        """Names of arrays of ranges."""
        self._each: set[int] = set()
        """The ids of nodes with all ranges that a loop iterates."""

    def rewrite(self, node: Any) -> None:
        """See `Rewriter`."""
        given = [*_assigned(node)]
        before = -1
        while before != (before := len(self._distances) + len(self._ranges)):
            for names, value in given:
                self._distances |= names if self._reads(value) else set()
                self._ranges |= names if self._is_ranges(value) else set()
        super().rewrite(node)

    def _reads(self, node: ast.AST) -> bool:
        """Return True if an expression contains a read of rays, or the value of one."""
        return any(
            one.id in self._distances
            if isinstance(one, ast.Name)
            else one.attr in READS_RAYS
            if isinstance(one, ast.Attribute)
            else isinstance(one, ast.Subscript) and self._is_ranges(one.value)
            for one in ast.walk(node)
        )

    def _is_ranges(self, node: ast.AST) -> bool:
        if isinstance(node, ast.Attribute):
            return node.attr == "ranges"
        return isinstance(node, ast.Name) and node.id in self._ranges

    def _is_own(self, node: Any) -> bool:
        if isinstance(node, ast.Compare):
            compares = not all(isinstance(one, _NO_RELATIONS) for one in node.ops)
            return compares and (self._reads(node) or (self._loop is None and not self._is_inner))
        if isinstance(node, ast.Subscript):
            is_known = self._is_ranges(node.value) or (
                isinstance(node.value, ast.Name) and node.value.id in self._parameters
            )
            return isinstance(node.ctx, ast.Load) and is_known
        return super()._is_own(node) or id(node) in self._each or self._taken(node) is not None

    def _taken(self, node: Any) -> Any:
        """Return all ranges that a call takes, or None."""
        if not isinstance(node, ast.Call) or getattr(node.func, "id", "") in _READ_NO_RANGES:
            return None
        given = [*node.args, *(one.value for one in node.keywords)]
        given += [node.func.value] if isinstance(node.func, ast.Attribute) else []
        given = [one.value if isinstance(one, ast.Starred) else one for one in given]
        return next((one for one in given if self._is_ranges(one)), None)

    def _notes_lines(self) -> bool:
        """Return True if the values of whole lines are noted, too."""
        return False

    # -- what is noted -------------------------------------------------------------------------------------------------

    def _wrap(self, node: Any, kind: str, **more: Any) -> ast.expr:
        is_noted = self._notes_lines() or kind not in _WHOLE_LINES or more.get("relation") or more.get("chain")
        return super()._wrap(node, kind, **more) if is_noted else node

    def _note_names(self, at: Any, kind: str, value: ast.expr, names: tuple[str, ...]) -> ast.stmt:
        if self._notes_lines():
            return super()._note_names(at, kind, value, names)
        return ast.copy_location(ast.Pass(), at)

    def _part(self, node: Any) -> Any:
        return super()._part(node) if self._notes_lines() else self._sub(node)

    def _statement(self, node: ast.stmt) -> Iterator[ast.stmt]:
        if isinstance(node, ast.FunctionDef):
            with_text = ast.get_docstring(node, clean=False) is not None
            self._within(lambda: setattr(node, "body", [*node.body[:with_text], *self._block(node.body[with_text:])]))
        elif isinstance(node, ast.For) and self._is_ranges(node.iter):
            self._each.add(id(node.iter))
        yield from super()._statement(node)

    def _within(self, rewrite: Any) -> None:
        around, self._is_inner = self._is_inner, True
        rewrite()
        self._is_inner = around

    def _parts(self, node: Any) -> Any:
        if isinstance(node, ast.Lambda):
            self._within(lambda: setattr(node, "body", self._sub(node.body)))
            return node
        if isinstance(node, _COMPREHENSIONS):
            self._within(lambda: self._comprehension(node))
            return node
        if isinstance(node, ast.NamedExpr):
            node.value = self._sub(node.value)
            return node
        made = super()._parts(node)
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            if node.attr == "ranges":
                node.value = self._wrap(node.value, OPERAND)  # the scan
            elif node.attr in READS_RAYS:
                return self._hooked(0, node)
        elif isinstance(node, ast.Call) and _may_be_users(node.func):
            node.func = self._hooked(1, node.func)
        return made

    def _comprehension(self, node: Any) -> None:
        for one in node.generators:
            if self._is_ranges(one.iter):
                self._each.add(id(one.iter))
            one.iter = self._sub(one.iter)
            one.ifs = [self._sub(test) for test in one.ifs]
        for name in ("elt", "key", "value"):
            if hasattr(node, name):
                setattr(node, name, self._sub(getattr(node, name)))

    def _hooked(self, which: int, node: ast.expr) -> ast.expr:
        """Return a call of a hook. The place of a method has no value of its own."""
        if which == 0:
            self._wrap(node, RAYS, relation=node.attr)  # type: ignore[attr-defined]
        number = ast.copy_location(ast.Constant(len(self.places) - 1), node)
        hook = ast.copy_location(ast.Constant(HOOKS[which]), node)
        return ast.copy_location(ast.Call(hook, [number, node], []), node)

    def _noted(self, node: Any, kind: str = "", names: tuple[str, ...] = ()) -> Any:
        if isinstance(node, ast.Subscript):
            return self._noted_part(node, kind or RAYS, names)
        if isinstance(node, ast.Compare) or super()._is_own(node):
            return super()._noted(node, kind, names)
        if id(node) in self._each:
            return self._wrap(self._parts(node), kind or RAYS, names=names, relation=EACH)
        taken = self._taken(node)
        is_each = getattr(node.func, "id", "") in _READ_EACH
        extras: list[ast.expr] = []
        if isinstance(taken, ast.Attribute):
            base, taken.value, extras = self._operand(taken.value, 0, is_read=True)
            made = self._parts(node)
        else:
            made = self._parts(node)
            _replace(made, taken, self._wrap(taken, OPERAND))
            base = Operand("", place=len(self.places) - 1)
        relation = EACH if is_each else ALL
        return self._wrap(made, kind or RAYS, names=names, extras=extras, relation=relation, operands=[base])

    def _noted_rays(self, node: Any, kind: str, names: tuple[str, ...]) -> Any:
        if node.func.attr == "distance" or self._notes_lines():
            return super()._noted_rays(node, kind, names)
        # The arguments are not noted: the ray that a method returns has its index.
        has_walrus = any(isinstance(one, ast.NamedExpr) for one in ast.walk(node))
        scan, node.func.value, extras = self._operand(node.func.value, 0, is_read=not has_walrus)
        node.args = [self._sub(one) for one in node.args]
        for keyword in node.keywords:
            keyword.value = self._sub(keyword.value)
        return self._wrap(node, kind, names=names, extras=extras, relation=node.func.attr, operands=[scan])

    def _noted_part(self, node: ast.Subscript, kind: str, names: tuple[str, ...]) -> Any:
        if isinstance(node.value, ast.Attribute):  # the ranges of a scan
            base, node.value.value, extras = self._operand(node.value.value, 0, is_read=True)
        else:
            base, node.value, extras = self._operand(node.value, 0, is_read=True)
        operands, key = [base], node.slice
        if isinstance(key, ast.Slice):
            for name in ("lower", "upper", "step"):
                if (bound := getattr(key, name)) is None:
                    operands.append(Operand(""))
                    continue
                operand, bound, _ = self._operand(bound, 0, is_read=False)
                setattr(key, name, bound)
                operands.append(operand)
        else:
            operand, node.slice, _ = self._operand(key, 0, is_read=False)
            operands.append(operand)
        return self._wrap(node, kind, names=names, extras=extras, relation=PART, operands=operands)


class LineLooker(Looker):
    """Rewrites an event so that its lines have their values, too, as `Rewriter` does."""

    def _is_own(self, node: Any) -> bool:
        return super()._is_own(node) or (isinstance(node, ast.Compare) and not self._is_inner)

    def _notes_lines(self) -> bool:
        return not self._is_inner


def _may_be_users(function: ast.expr) -> bool:
    """Return True for the expression of a called function that may be the user's."""
    return isinstance(function, ast.Attribute) or (
        isinstance(function, ast.Name) and not hasattr(builtins, function.id)
    )


def _replace(call: Any, old: ast.expr, new: ast.expr) -> None:
    """Replace an argument of a call, or the object of its method."""
    for one in ast.walk(call):
        for name, value in ast.iter_fields(one):
            if value is old:
                setattr(one, name, new)
                return
            if isinstance(value, list) and any(each is old for each in value):
                value[:] = [new if each is old else each for each in value]
                return


def _assigned(node: ast.AST) -> Iterator[tuple[set[str], ast.AST]]:
    """Yield the names that a function assigns, with the value of each assignment."""
    for one in ast.walk(node):
        value = getattr(one, "value", None) or getattr(one, "iter", None) or getattr(one, "context_expr", None)
        targets = getattr(one, "targets", None) or [getattr(one, "target", None) or getattr(one, "optional_vars", None)]
        if value is not None and targets[0] is not None:
            yield {name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)}, value
