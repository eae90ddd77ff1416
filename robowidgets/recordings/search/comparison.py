"""A comparison of a field, written as text: ``/imu.linear_acceleration.x > 12``."""

from __future__ import annotations

import operator
import re
from contextlib import suppress
from typing import Any

from . import conditions
from .base import Condition

_SIGNS = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip
_COMPARISON = re.compile(r"\s*(?:abs\(\s*(\S+?)\s*\)|(\S+?))\s*(<=|>=|==|!=|<|>)\s*(\S.*?)\s*")


def compared(words: str) -> Condition:
    """Return the condition of a comparison. It is only parsed: no part of the text is run.

    Args:
        words: a field, or ``abs(`` field ``)``; a sign, one of <, <=, >, >=, == and !=; and a number, true, false or a
            text.

    Raises:
        ValueError: the text is not a comparison.
    """
    found = _COMPARISON.fullmatch(words)
    if found is None:
        raise ValueError(f"expected a comparison, such as '/imu.linear_acceleration.x > 12', got {words!r}")
    size, name, sign, value = found.groups()
    field = conditions.field(size or name)
    made: Condition = _SIGNS[sign](abs(field) if size else field, _value(value))
    return made


def _value(word: str) -> Any:
    """Return a word as a number, a flag, or a text without its quotes."""
    with suppress(ValueError):
        return int(word)
    with suppress(ValueError):
        return float(word)
    if word.lower() in ("true", "false"):
        return word.lower() == "true"
    return word[1:-1] if word[0] == word[-1] and word[0] in "'\"" and len(word) > 1 else word
