"""Traits for limits around zero, such as limits of speeds."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from math import isfinite
from numbers import Real
from types import MappingProxyType
from typing import Any

import traitlets

from ..samples import AXES

LARGEST = 1e6
"""The largest absolute limit, in m/s or rad/s."""

Pair = tuple[float, float]


def is_past(value: float, limits: Pair | None) -> bool:
    """Return True if a value lies outside its limits by more than rounding (1e-6). NaN is never outside."""
    if limits is None:
        return False
    low, high = limits
    return value < low - _slack(low) or value > high + _slack(high)


def _slack(limit: float) -> float:
    return 1e-6 * max(1.0, abs(limit))


def unit_of(axis: str) -> str:
    """Return the unit of an axis of `AXES`: m/s or rad/s."""
    return "m/s" if axis.startswith("linear") else "rad/s"


class Limits(traitlets.TraitType[Any, Any]):
    """A pair (min, max) of floats with min <= 0 <= max and min < max, one number for both, or None without limits."""

    def __init__(self, default: Pair, unit: str, **more: Any) -> None:
        super().__init__(default, allow_none=True, **more)
        self.unit = unit

    def validate(self, _obj: Any, value: Any) -> Pair | None:
        """Return the pair, or None. Raise TraitError for other values."""
        return None if value is None else _to_pair(str(self.name), value, self.unit)


class AxisLimits(traitlets.TraitType[Any, Any]):
    """Limits by the name of an axis; read-only once set."""

    def __init__(self, **more: Any) -> None:
        super().__init__(MappingProxyType({}), **more)

    def validate(self, _obj: Any, value: Any) -> Mapping[str, Pair]:
        """Return the pairs by axis. Raise TraitError for other values."""
        if not isinstance(value, Mapping):
            raise traitlets.TraitError(
                f"{self.name}: expected a dictionary of limits by axis, like {{'linear.x': (-0.2, 0.5)}}; got {value!r}"
            )
        for axis in value:
            if axis not in AXES:
                near = difflib.get_close_matches(str(axis).lower(), AXES, n=1)
                hint = f"; did you mean {near[0]!r}?" if near else "."
                raise traitlets.TraitError(f"{self.name}: no axis {axis!r}{hint} The axes are: {', '.join(AXES)}")
        return MappingProxyType(
            {axis: _to_pair(f"{self.name}[{axis!r}]", pair, unit_of(axis)) for axis, pair in value.items()}
        )


def _to_pair(name: str, value: Any, unit: str) -> Pair:
    expected = f"expected a number above 0, or a pair (min, max) with min <= 0 <= max, in {unit}"
    numbers = _numbers(value)
    if numbers is None or len(numbers) not in (1, 2):
        raise traitlets.TraitError(f"{name}: {expected}; got {value!r}")
    if len(numbers) == 1:
        numbers = [-numbers[0], numbers[0]]
        if numbers[1] <= 0:
            raise traitlets.TraitError(f"{name}: {expected}; got {value!r}")
    low, high = numbers
    if not (isfinite(low) and isfinite(high)) or max(-low, high) > LARGEST:
        raise traitlets.TraitError(f"{name}: expected finite limits of at most {LARGEST:g} {unit}; got {value!r}")
    if low > high:
        raise traitlets.TraitError(
            f"{name}: the limits are the wrong way round: expected (min, max), got {value!r}; write ({high:g}, {low:g})"
        )
    if low > 0 or high < 0:
        raise traitlets.TraitError(
            f"{name}: expected min <= 0 <= max, because bars start at zero; got {value!r}; "
            f"write ({min(low, 0):g}, {max(high, 0):g})"
        )
    if low == high:
        raise traitlets.TraitError(f"{name}: expected min below max, got {value!r}")
    return low, high


def _numbers(value: Any) -> list[float] | None:
    """Return the floats in a number or a sequence of numbers, or None if it holds something else."""
    try:
        values = [value] if isinstance(value, Real) else list(value)
        if any(isinstance(v, bool) or not isinstance(v, Real) for v in values):
            return None
        return [float(v) for v in values]
    except (TypeError, OverflowError):
        return None
