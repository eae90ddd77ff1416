"""Values that a program keeps, and values that the user sets while it runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np

from ..samples.checks import finite, number
from ..widget.observed import Observed


class ProgramState(dict[str, Any]):
    """The values that a program keeps from step to step and from version to version: a dictionary with attributes."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            hint = f"state.setdefault({name!r}, ...) gives it a first value"
            raise AttributeError(f"the state has no {name!r} yet: {hint}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        if hasattr(dict, name):
            raise AttributeError(f"state.{name} is a method of a dictionary; write state[{name!r}], or choose a name")
        self[name] = value

    def __delattr__(self, name: str) -> None:
        self.pop(name, None)


@dataclass(frozen=True)
class Variable:
    """A variable: its value, and how the user sets it on the page.

    ``first`` is the value in the code, and ``before`` the value in the previous version. ``low`` and ``high`` are the
    ends of a slider, or None without a slider. ``whole`` is True for an integer and for a slider of integers.
    """

    value: bool | float | str
    first: bool | float | str
    before: bool | float | str
    low: float | None = None
    high: float | None = None
    unit: str = ""
    whole: bool = False


class Variables(Observed):
    """The variables of a robot's programs. The page shows them live, and the user sets them while a program runs.

    They are numbers (a distance may be inf or NaN), switches (True and False) and texts. Any thread may read and set
    them.

    Examples:
        >>> variables = Variables()
        >>> variables.slider("near", 0.6, 0.2, 2.0, "m")
        >>> variables.go = True
        >>> variables.near
        0.6
    """

    def __init__(self) -> None:
        object.__setattr__(self, "_table", {})
        object.__setattr__(self, "_observers", [])
        object.__setattr__(self, "_edited", set())

    _table: dict[str, Variable]
    _edited: set[str]
    """The sliders whose first value has changed since the newest version of a program."""

    @classmethod
    def restored(cls, table: Mapping[str, Variable]) -> Variables:
        """Return variables that are as they were when their `table` was read."""
        made = cls()
        made._table.update(table)
        return made

    def slider(self, name: str, value: float, low: float, high: float, unit: str = "") -> None:
        """Declare a number with a slider.

        If it is declared again with the same first value, it keeps the value set in the meantime. If value, low and
        high are integers, the slider has only integers: write 1.0 for a number with decimals.

        Args:
            name: an identifier.
            value: its first value.
            low: the left end of the slider.
            high: the right end.
            unit: the unit shown after the number.

        Raises:
            TypeError: not a number. ValueError: not low <= value <= high, or not an identifier.
        """
        named = (("value", value), ("low", low), ("high", high))
        first, least, most = (finite(key, given, unit or "any unit") for key, given in named)
        if not least <= first <= most or least == most:
            raise ValueError(f"{name}: expected low <= value <= high, got {least:g}, {first:g}, {most:g}")
        whole = all(_is_whole(given) for _, given in named)
        if whole:
            first, least, most = int(first), int(least), int(most)
        known = self._table.get(name, Variable(first, first, first))
        now, before = first, known.before
        if known.first == first and _is_number(known.value):
            now = _as(whole, min(max(float(known.value), least), most))
        elif name not in self._edited:
            self._edited.add(name)
            before = known.value  # the value of the version that runs until the end of this cell
        self._put(name, Variable(now, first, before, least, most, unit, whole))

    def set(self, name: str, value: Any) -> None:
        """Set a variable as the page does: to a value of the same kind, within the ends of its slider.

        A whole number stays an integer as long as it is set to an integer.

        Raises:
            KeyError: no variable has that name. TypeError, ValueError: not a possible value of the variable.
        """
        known, checked = self._table[name], _checked(name, value)
        if _KINDS[type(checked)] != _KINDS[type(known.value)]:
            raise TypeError(f"{name}: expected {_KINDS[type(known.value)]}, got {value!r}")
        if _is_number(checked):
            checked = finite(name, checked, known.unit or "any unit")
            if known.low is not None and known.high is not None:
                checked = _as(known.whole, min(max(checked, known.low), known.high))
            elif known.whole and checked.is_integer():
                checked = int(checked)
        self._put(name, replace(known, value=checked))

    def begin_version(self) -> None:
        """Record the present values as `Variable.before`, except for sliders that the new version has changed."""
        for name, known in self.table.items():
            if name not in self._edited:
                self._table[name] = replace(known, before=known.value)
        self._edited.clear()
        self._call_observers()

    def take_first_values(self) -> None:
        """Reset every variable to its first value, as in the code."""
        for name, known in self.table.items():
            self._table[name] = replace(known, value=known.first)
        self._call_observers()

    @property
    def table(self) -> dict[str, Variable]:
        """All variables, by name."""
        return dict(self._table)

    def __getattr__(self, name: str) -> Any:
        known = self._table.get(name)
        if known is None:
            names = ", ".join(self._table) or "none yet"
            raise AttributeError(f"no variable {name!r}: there are {names}; variables.{name} = 0.5 makes one")
        return known.value

    def __setattr__(self, name: str, value: Any) -> None:
        checked = _checked(name, value)
        known = self._table.get(name, Variable(checked, checked, checked))
        if known.low is None:
            known = replace(known, whole=_is_whole(checked))
        elif _is_number(checked) and not known.whole:
            checked = float(checked)
        self._put(name, replace(known, value=checked))

    def __delattr__(self, name: str) -> None:
        self._table.pop(name, None)
        self._call_observers()

    def __iter__(self) -> Iterator[str]:
        return iter(dict(self._table))

    def __repr__(self) -> str:
        return f"Variables({', '.join(f'{name}={one.value!r}' for name, one in self.table.items())})"

    def _put(self, name: str, variable: Variable) -> None:
        if not name.isidentifier() or name.startswith("_") or hasattr(type(self), name):
            raise ValueError(f"expected a name such as 'near' for a variable, got {name!r}")
        self._table[name] = variable
        self._call_observers()


_KINDS = {bool: "True or False", int: "a number", float: "a number", str: "a text"}


def _checked(name: str, value: Any) -> bool | float | str:
    """Return a value that a variable may have; TypeError otherwise."""
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, str):
        return str(value)
    return int(value) if _is_whole(value) else number(name, value)


def _is_whole(value: Any) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _as(whole: bool, value: float) -> float:
    """Return a number of a slider, rounded if the slider has only integers."""
    return round(value) if whole else value
