"""The approximate bytes of messages and samples in memory."""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import numpy as np

_SMALL = frozenset({float, int, bool, type(None)})
_DEEPEST = 3
_MOST_LOOKED = 10
"""The number of entries of a list that are looked at."""


def approximate_bytes(value: Any, each: int = 0, depth: int = 0) -> int:
    """Return roughly the bytes of a message or a sample, in a few microseconds. No code of a user is called.

    Args:
        value: the message or the sample.
        each: the bytes that each of its objects has in addition to its arrays and texts.
        depth: of a part.
    """
    kind = type(value)
    if kind is np.ndarray:
        return int(value.nbytes)
    if kind in (bytes, bytearray, memoryview, str):
        return len(value)
    if kind is array:
        return len(value) * int(value.itemsize)
    if kind is list or isinstance(value, tuple):
        size, parts = 8 * len(value), value[:_MOST_LOOKED]
        if depth > _DEEPEST:
            return size
        return size + sum(approximate_bytes(one, each, depth + 1) for one in parts) * max(1, len(value) // _MOST_LOOKED)
    if depth > _DEEPEST:
        return 0
    size = each
    for part in _parts(value):
        if type(part) not in _SMALL:  # a call for each number would take longer than all the rest
            size += approximate_bytes(part, each, depth + 1)
    return size


def _parts(value: Any) -> Iterable[Any]:
    """Return the values of a dictionary, or of the fields of an object; messages of ROS have their fields in slots."""
    if type(value) is dict:
        return list(value.values())
    field = object.__getattribute__  # calls no `__getattr__` of a user
    with suppress(AttributeError):
        return list(field(value, "__dict__").values())
    slots, found = getattr(type(value), "__slots__", ()), []
    for name in slots if isinstance(slots, (list, tuple)) else ():
        with suppress(AttributeError):  # it is not set
            found.append(field(value, name))
    return found
