"""The verdict of a condition on one sample, and comparisons as facts."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .checks import frozen
from .ray import Ray

NO_RAYS: NDArray[np.intp] = frozen(np.empty(0, np.intp))

OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt, "≤": operator.le, ">": operator.gt, "≥": operator.ge, "=": operator.eq, "≠": operator.ne,
}  # fmt: skip
OPPOSITE = {"<": "≥", "≤": ">", ">": "≤", "≥": "<", "=": "≠", "≠": "="}


class Verdict(NamedTuple):
    """The verdict of a condition on one sample.

    ``value`` is True, False, or None if unknown. ``text`` is the comparison as a fact, such as ``"1.24 < 1.50 m"``.
    ``rays`` are the indices of the rays that made it true, shape (M,), ascending; empty if it is not true, or if no ray
    decided it. ``nearest`` is the ray to the nearest thing if the condition is true, or None if it read no distance.
    """

    value: bool | None
    text: str = ""
    rays: NDArray[np.intp] = NO_RAYS
    nearest: Ray | None = None


UNKNOWN = Verdict(None)


def fact(value: float, relation: str, limit: float, unit: str = "m") -> str:
    """Return the outcome of a comparison: ``"1.24 < 1.50 m"``, with the opposite relation if it did not hold."""
    shown = relation if OPERATORS[relation](value, limit) else OPPOSITE[relation]
    decimals = 0
    if not (isinstance(value, int) and isinstance(limit, int)):
        decimals = next((n for n in range(2, 6) if f"{value:.{n}f}" != f"{limit:.{n}f}"), 2)
    text = f"{value:.{decimals}f} {shown} {limit:.{decimals}f} {unit}".rstrip()
    return text.replace("-", "\N{MINUS SIGN}")
