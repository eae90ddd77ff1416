"""Values as they were when they were noted, without any call of a user's code, and their texts, which are short.

A value that cannot change is kept. Of any other one a `Glimpse` is kept: its first parts. Only methods of built-in
types are called, by their type, since a class may override them: neither ``repr``, ``isinstance`` nor an attribute of
a user's object is used.
"""

from __future__ import annotations

import enum
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from gc import get_referents
from itertools import islice
from types import BuiltinFunctionType, FunctionType, MappingProxyType, ModuleType
from typing import Any

import numpy as np

from ...samples import Ray, Scan, Sector

MOST_PARTS = 4
"""Parts of a list, or of another value of many parts, that are kept."""
LONGEST = 60
"""Characters of a text that are kept."""
_MOST_BITS = 200
"""Bits of an integer whose digits are shown."""
_MOST_FLAGS = 100_000
"""Entries of an array whose True are counted."""
_DEEPEST = 2

_name_of_class: Callable[[type], str] = type.__dict__["__name__"].__get__


@dataclass(slots=True)  # not frozen: it would take longer to make
class Glimpse:
    """The part of a value that is kept: the name of its type, its first parts, their number, and brackets around them.

    ``brackets`` is empty for a value without parts, ``::`` for a dict, and ``word`` if the name is the whole text.
    """

    name: str
    parts: tuple[Any, ...] = ()
    count: int = 0
    brackets: str = ""


_NUMPY_SCALARS = tuple(
    kind for kind in {*np.sctypeDict.values()} if issubclass(kind, (np.bool_, np.integer, np.floating))
)
_KEPT: set[int] = {id(kind) for kind in (float, int, bool, type(None), complex, Scan, Ray, Sector)}
_PLAIN = {id(kind) for kind in (float, int, bool, type(None), complex)}
_TEXTS: dict[int, Callable[[Any], str]] = {}
_RESULTS: set[int] = set()
_SCALARS = {id(kind) for kind in _NUMPY_SCALARS}


def keep(kind: type, text: Callable[[Any], str] = repr, *, is_result: bool = False) -> None:
    """Keep values of a class of this package as they are, because they cannot change.

    Args:
        kind: the class.
        text: makes their text.
        is_result: True if a step returns them, and does nothing else with them.
    """
    _KEPT.add(id(kind))
    _TEXTS[id(kind)] = text
    if is_result:
        _RESULTS.add(id(kind))


def is_result(value: Any) -> bool:
    """Return True for a value that has an effect only if a step returns it."""
    return id(type(value)) in _RESULTS


def is_kept(kind: type, *, numbers_only: bool = False) -> bool:
    """Return True for a class whose values are kept as they are, as they cannot change."""
    number = id(kind)
    return number in (_PLAIN if numbers_only else _KEPT) or number in _SCALARS


def glimpse(value: Any, depth: int = 0) -> Any:
    """Return what is kept of a value. It never raises, and takes a microsecond or two."""
    kind = type(value)
    if id(kind) in _KEPT:
        return value
    if kind is str:
        return value if len(value) <= LONGEST else value[:LONGEST] + "…"
    if id(kind) in _SCALARS:
        return value.item()
    if kind is tuple and depth < _DEEPEST:
        return Glimpse("", tuple([glimpse(one, depth + 1) for one in value[:MOST_PARTS]]), len(value), "()")
    try:
        return _glimpse(value, kind, depth)
    except Exception:  # another thread changes it
        return Glimpse(_name_of_class(kind))


def _glimpse(value: Any, kind: type, depth: int) -> Any:
    name = _name_of_class(kind)
    if issubclass(kind, (float, int)) and not issubclass(kind, enum.Enum):
        return float.__float__(value) if issubclass(kind, float) else int.__int__(value)
    if kind is np.ndarray:
        return _glimpse_of_array(value)
    if kind is range:
        return Glimpse(repr(value)[:LONGEST], brackets="word")
    if depth < _DEEPEST:
        for base, brackets in ((list, "[]"), (tuple, "()"), (set, "{}"), (frozenset, "{}"), (deque, "[]")):
            if issubclass(kind, base):
                parts = tuple(glimpse(one, depth + 1) for one in islice(base.__iter__(value), MOST_PARTS))
                is_own = kind in (list, tuple, set)
                return Glimpse("" if is_own else name, parts, base.__len__(value), brackets)
        if issubclass(kind, dict):
            items = islice(dict.items(value), MOST_PARTS)
            pairs = tuple((glimpse(key, depth + 1), glimpse(one, depth + 1)) for key, one in items)
            return Glimpse("" if kind is dict else name, pairs, dict.__len__(value), "::")
    if kind is MappingProxyType and type(inner := get_referents(value)[0]) is dict:  # without a call of its methods
        return glimpse(inner, depth)
    if issubclass(kind, enum.Enum):
        member = object.__getattribute__(value, "_name_")
        return Glimpse(f"{name}.{member[:LONGEST]}" if type(member) is str else name, brackets="word")
    if issubclass(kind, BaseException):
        arguments: tuple[Any, ...] = BaseException.__dict__["args"].__get__(value)
        said = arguments[0] if arguments else ""
        return Glimpse(name, (glimpse(said, depth + 1),) if type(said) is str and said else (), 0, "()")
    if kind is FunctionType or kind is BuiltinFunctionType:
        return Glimpse(f"function {value.__name__}"[:LONGEST])
    if kind is ModuleType:
        return Glimpse("module")
    if issubclass(kind, type):
        return Glimpse(f"class {_name_of_class(value)}"[:LONGEST])
    if kind is bytes or kind is bytearray:
        return Glimpse(f"{len(value)} bytes", brackets="word")
    return Glimpse(name)


def _glimpse_of_array(value: Any) -> Glimpse:
    if value.dtype == bool and value.ndim == 1 and value.size <= _MOST_FLAGS:
        return Glimpse(f"{np.count_nonzero(value)} of {value.size} True", brackets="word")
    if value.ndim == 1 and value.size <= MOST_PARTS and value.dtype.kind in "fiub":
        return Glimpse("array", tuple(value.tolist()), value.size, "[]")
    return Glimpse(f"array of {' × '.join(map(str, value.shape)) or 'one'}", brackets="word")


def text_of(value: Any, unit: str = "") -> str:
    """Return the text of a value that was kept, on one line."""
    kind = type(value)
    if kind is float:
        return number_text(value, unit)
    if kind is bool or value is None:
        return str(value)
    if kind is int:
        return _integer(value) + f" {unit}" * bool(unit)
    if kind is str:
        return repr(value)
    if kind is Scan:
        return f"Scan of {len(value)} rays"
    if kind is Ray:
        return f"ray [{value.index}]"
    if kind is Glimpse:
        return _text_of_glimpse(value)
    return _TEXTS.get(id(kind), repr)(value)[: 2 * LONGEST]  # of one of our classes, or a complex number


def number_text(value: float, unit: str = "", decimals: int | None = None) -> str:
    """Return a number as it is read: two decimals with a unit, else four digits; with a real minus sign."""
    if value != value or value in (float("inf"), float("-inf")):
        text = "NaN" if value != value else "inf" if value > 0 else "-inf"
    elif decimals is not None or unit:
        text = f"{value:.{2 if decimals is None else decimals}f}"
    else:
        text = repr(value) if len(repr(value)) <= 6 else f"{value:.4g}"
    return text.replace("-", "\N{MINUS SIGN}").replace("e\N{MINUS SIGN}", "e-") + f" {unit}" * bool(unit)


def _integer(value: int) -> str:
    if value.bit_length() > _MOST_BITS:
        return f"an integer of {value.bit_length()} bits"
    return str(value).replace("-", "\N{MINUS SIGN}")


def _text_of_glimpse(value: Glimpse) -> str:
    if value.brackets == "word":
        return value.name
    if not value.brackets:
        return f"<{value.name}>"
    more = ["…"] if value.count > len(value.parts) else []
    of = f" of {value.count}" * bool(more)
    if value.brackets == "::":
        body = ", ".join([f"{text_of(key)}: {text_of(one)}" for key, one in value.parts] + more)
        return f"{value.name}{{{body}}}{of}"
    body = ", ".join([*map(text_of, value.parts), *more])
    if value.brackets == "()" and not value.name and value.count == 1:
        body += ","
    brackets = value.brackets if not value.name or value.name == "array" else "()"
    return f"{value.name}{brackets[0]}{body}{brackets[1]}{of}"
