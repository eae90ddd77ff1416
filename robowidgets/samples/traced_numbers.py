"""Numbers that record their comparisons, and values with such numbers."""

from __future__ import annotations

import operator
from collections.abc import Callable
from copy import copy
from math import isnan
from typing import Any, NamedTuple

import numpy as np

OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt, "≤": operator.le, ">": operator.gt, "≥": operator.ge, "=": operator.eq, "≠": operator.ne,
}  # fmt: skip
_OPPOSITE = {"<": "≥", "≤": ">", ">": "≤", "≥": "<", "=": "≠", "≠": "="}
_ARITHMETIC = {
    "add": (operator.add, "+"), "sub": (operator.sub, "\N{MINUS SIGN}"), "mul": (operator.mul, "·"),
    "truediv": (operator.truediv, "/"),
}  # fmt: skip
_LONGEST_NAME = 24
UNITS = {"time": "s", "since": "s", "driven": "m", "turned": "rad"}
"""Units of the numbers that a program's step gets."""


def fact(value: float, relation: str, limit: float, unit: str = "m") -> str:
    """Return the outcome of a comparison: ``"1.24 < 1.50 m"``, with the opposite relation if it did not hold."""
    shown = relation if OPERATORS[relation](value, limit) else _OPPOSITE[relation]
    decimals = 0
    if not (isinstance(value, int) and isinstance(limit, int)):
        decimals = next((n for n in range(2, 6) if f"{value:.{n}f}" != f"{limit:.{n}f}"), 2)
    text = f"{value:.{decimals}f} {shown} {limit:.{decimals}f} {unit}".rstrip()
    return text.replace("-", "\N{MINUS SIGN}")


class NumberComparison(NamedTuple):
    """A comparison of a number with a limit. ``name`` names the number, and is empty if the name would be long."""

    name: str
    value: float
    relation: str
    limit: float
    unit: str
    holds: bool

    @property
    def is_known(self) -> bool:
        """True if the number is not NaN."""
        return not isnan(self.value)

    @property
    def text(self) -> str:
        """The outcome of the comparison: ``"way 0.04 ≤ 0.10"``."""
        return f"{self.name} {fact(self.value, self.relation, self.limit, self.unit)}".strip()


Note = Callable[[NumberComparison], None]


class _Traced:
    """A number that records its comparisons, as do its sums and products with others."""

    _name: str
    _unit: str
    _note: Note
    _plain: Any

    def _compare(self, relation: str, other: Any) -> Any:
        limit = plain(other)
        if hasattr(limit, "_note"):
            return NotImplemented  # a distance, which records the comparison itself
        try:
            outcome = OPERATORS[relation](self._plain, limit)
        except TypeError:
            return NotImplemented  # Python then raises the error on the line that compares
        if _is_number(limit):
            self._note(NumberComparison(self._name, self._plain, relation, limit, self._unit, bool(outcome)))
        return outcome

    def __lt__(self, other: Any) -> Any:
        return self._compare("<", other)

    def __le__(self, other: Any) -> Any:
        return self._compare("≤", other)

    def __gt__(self, other: Any) -> Any:
        return self._compare(">", other)

    def __ge__(self, other: Any) -> Any:
        return self._compare("≥", other)

    def __eq__(self, other: Any) -> Any:
        return self._compare("=", other)

    def __ne__(self, other: Any) -> Any:
        return self._compare("≠", other)

    def __hash__(self) -> int:
        return hash(self._plain)

    def __neg__(self) -> Any:
        return self._made(-self._plain, f"\N{MINUS SIGN}{_in_brackets(self._name)}", self._unit)

    def __abs__(self) -> Any:
        return self._made(abs(self._plain), f"|{self._name}|", self._unit)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._plain, name)  # such as a method of NumPy's numbers

    def __reduce__(self) -> Any:
        return copy, (self._plain,)

    def _made(self, value: Any, name: str, unit: str) -> Any:
        return traced(value, name if len(name) <= _LONGEST_NAME else "", self._note, unit)

    def _calculate(self, name: str, other: Any, *, is_left: bool) -> Any:
        operation, sign = _ARITHMETIC[name]
        number = plain(other)
        if not _is_number(number):
            return NotImplemented
        other_name = getattr(other, "_name", "") if isinstance(other, _Traced) else f"{number:g}"
        names, values = [self._name, other_name], [self._plain, number]
        if not is_left:
            names.reverse()
            values.reverse()
        if sign not in "+\N{MINUS SIGN}":
            names = [_in_brackets(one) for one in names]
        unit = self._unit if sign in "+\N{MINUS SIGN}" else ""
        return self._made(operation(*values), f" {sign} ".join(names) if all(names) else "", unit)


def _operator(name: str, *, is_left: bool) -> Callable[[_Traced, Any], Any]:
    return lambda self, other: self._calculate(name, other, is_left=is_left)


for _name in _ARITHMETIC:
    setattr(_Traced, f"__{_name}__", _operator(_name, is_left=True))
    setattr(_Traced, f"__r{_name}__", _operator(_name, is_left=False))


class _TracedFloat(_Traced, float):
    pass


class _TracedInt(_Traced, int):
    pass


# For errors in the user's function, such as a comparison with a text.
_TracedFloat.__name__, _TracedInt.__name__ = "float", "int"


class _Values:
    """Values by name, such as a program's state, whose numbers record their comparisons."""

    __slots__ = ("_note", "_of")

    def __init__(self, of: Any, note: Note) -> None:
        object.__setattr__(self, "_of", of)
        object.__setattr__(self, "_note", note)

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._of, name)
        if name in ("get", "setdefault") and isinstance(self._of, dict):
            return lambda key, default=None: traced(value(key, default), str(key), self._note)
        return traced(value, name, self._note)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._of, name, plain(value))

    def __delattr__(self, name: str) -> None:
        delattr(self._of, name)

    def __getitem__(self, key: Any) -> Any:
        return traced(self._of[key], str(key), self._note)

    def __setitem__(self, key: Any, value: Any) -> None:
        self._of[key] = plain(value)

    def __delitem__(self, key: Any) -> None:
        del self._of[key]

    def __contains__(self, key: Any) -> bool:
        return key in self._of

    def __iter__(self) -> Any:
        return iter(self._of)

    def __len__(self) -> int:
        return len(self._of)

    def __repr__(self) -> str:
        return repr(self._of)


def plain(value: Any) -> Any:
    """Return the plain number of a traced one, or another value as it is."""
    return vars(value)["_plain"] if isinstance(value, _Traced) else value


def traced(value: Any, name: str, note: Note, unit: str = "") -> Any:
    """Return a number, or a tuple of numbers, that records its comparisons, or another value as it is."""
    if _is_number(value) and not isinstance(value, _Traced):
        number: Any = _TracedInt(value) if isinstance(value, (int, np.integer)) else _TracedFloat(value)
        vars(number).update(_name=name, _unit=unit, _note=note, _plain=value)
        return number
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return type(value)(*(traced(one, key, note) for one, key in zip(value, value._fields, strict=True)))
    if type(value) is tuple:
        return tuple(traced(one, f"{name}[{i}]", note) for i, one in enumerate(value))
    return value


def traced_fields(sample: Any, names: tuple[str, ...], note: Note) -> Any:
    """Return a copy of a sample in which some fields record their comparisons."""
    result = copy(sample)
    vars(result).update({name: traced(getattr(sample, name), name, note) for name in names})
    return result


def traced_values(values: Any, note: Note) -> Any:
    """Return a wrapper of values by name, such as a program's state, whose numbers record their comparisons."""
    return _Values(values, note)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def _in_brackets(name: str) -> str:
    return f"({name})" if " " in name else name
