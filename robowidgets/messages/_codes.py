"""Numbers in messages with a meaning: codes, bits and flags."""

from __future__ import annotations

from collections.abc import Mapping
from operator import index
from typing import Any

import numpy as np

from .fields import get


def is_flag(value: Any) -> bool:
    """Return True if a value is True or False, not the number 1 or 0."""
    return isinstance(value, (bool, np.bool_))


def flag(message: Any, name: str) -> bool:
    """Return a field that is True or False, or raise TypeError."""
    value = get(message, name)
    if not is_flag(value):
        raise TypeError(f"{name}: expected True or False, got {value!r}")
    return bool(value)


def integer(message: Any, name: str) -> int:
    """Return a field as a whole number, or raise TypeError if it is not one."""
    value = get(message, name)
    try:
        return index(value)
    except TypeError:
        raise TypeError(f"{name}: expected a whole number, got {value!r}") from None


def code(message: Any, name: str, words: tuple[str, ...]) -> int:
    """Return a field that is an index into some words, or raise ValueError: a guess would be shown as a fact."""
    value = integer(message, name)
    if not 0 <= value < len(words):
        raise ValueError(f"{name}: expected {_listed(dict(enumerate(words)), ' or ')}, got {value}")
    return value


def bits(message: Any, name: str, words: Mapping[int, str]) -> dict[str, bool]:
    """Return each named bit of a field, or raise ValueError if a bit without a name is set."""
    value = integer(message, name)
    if value & ~sum(words):
        raise ValueError(f"{name}: expected a sum of {_listed(words, ' and ')}, got {value}")
    return {word: bool(value & bit) for bit, word in words.items()}


def _listed(words: Mapping[int, str], last: str) -> str:
    *others, end = [f"{number} ({word})" for number, word in words.items()]
    return f"{', '.join(others)}{last}{end}" if others else end
