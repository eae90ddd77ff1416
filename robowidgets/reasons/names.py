"""Short names and units of compared expressions, made of their source."""

from __future__ import annotations

import ast
from functools import lru_cache

UNITS = {"time": "s", "since": "s", "driven": "m", "turned": "rad"}
"""Units of the numbers that a program's step gets, by parameter."""
MIRRORED = {"<": ">", "≤": "≥", ">": "<", "≥": "≤", "=": "=", "≠": "≠"}
"""Relations by the same relation with its sides swapped."""

_SIGNS: dict[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "\N{MINUS SIGN}",
    ast.Mult: "·",
    ast.Div: "/",
    ast.Mod: "%",
}
_LONGEST_NAME = 24


@lru_cache(maxsize=1000)
def name_and_unit(expression: str) -> tuple[str, str]:
    """Return the name of a number, empty if it would be long, and its unit: ``state.way`` is ``("way", "")``."""
    try:
        node = ast.parse(expression, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return "", ""
    name = _name(node)
    return name if len(name) <= _LONGEST_NAME else "", _unit(node)


def _name(node: ast.expr) -> str:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return node.attr
    if isinstance(node, ast.Constant):
        return f"{node.value:g}" if isinstance(node.value, (int, float)) else ""
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
        key = node.slice.value
        of = "" if isinstance(key, str) else _name(node.value)
        return key if isinstance(key, str) else f"{of}[{key!r}]" * bool(of)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = _name(node.operand)
        return f"\N{MINUS SIGN}{_in_brackets(inner)}" * bool(inner)
    if isinstance(node, ast.Call) and node.args:
        first = node.args[0]
        if isinstance(node.func, ast.Name) and node.func.id == "abs":
            return f"|{_name(first)}|" * bool(_name(first))
        if isinstance(node.func, ast.Attribute) and node.func.attr in ("get", "setdefault"):
            return first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else ""
    if isinstance(node, ast.BinOp) and (sign := _SIGNS.get(type(node.op))):
        sides = [_name(node.left), _name(node.right)]
        if isinstance(node.op, (ast.Mult, ast.Div, ast.Mod)):
            sides = [*map(_in_brackets, sides)]
        return f" {sign} ".join(sides) if all(sides) else ""
    return ""


def _unit(node: ast.expr) -> str:
    if isinstance(node, ast.Name):
        return UNITS.get(node.id, "")
    if isinstance(node, ast.UnaryOp):
        return _unit(node.operand)
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "abs" and node.args:
        return _unit(node.args[0])
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)):
        return _unit(node.left)
    return ""


def _in_brackets(name: str) -> str:
    return f"({name})" if " " in name else name
