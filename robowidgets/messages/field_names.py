"""The names of the fields of a message type as users write them, and error texts for unknown names."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence

from .layout import TIMES, FieldPath, Leaf

_INDEX = re.compile(r"\[(\d*)\]")
_TIME_PARTS = ("sec", "nanosec")
_NEAREST = 3
_LONGEST_TREE = 600
"""The most characters of a tree in an error: definitions may have thousands of fields."""


def find(leaves: Sequence[Leaf], name: str) -> FieldPath | None:
    """Return the path of a field, such as ``position[2]`` or ``transforms[0].header.stamp.sec``, or None.

    An index in brackets stands for one value, empty brackets or no brackets stand for all.
    """
    which = [int(text) if text else None for text in _INDEX.findall(name)]
    plain = _INDEX.sub("[]", name)
    numbers = {leaf.name: number for number, leaf in enumerate(leaves)}
    for path, part in ((plain, ""), tuple(plain.rpartition(".")[::2])):
        number = numbers.get(path, numbers.get(path.removesuffix("[]")))
        if number is None or (part and (part not in _TIME_PARTS or leaves[number].type not in TIMES)):
            continue
        leaf = leaves[number]
        is_indexed = path not in numbers
        if is_indexed and not leaf.is_array:
            continue
        value = which[-1] if is_indexed else None
        outer = which[:-1] if is_indexed else which
        if leaf.is_array and leaf.dtype is None:  # an array of text is the last of its arrays
            return FieldPath(number, (*outer, value), None, part)
        return FieldPath(number, tuple(outer), value, part)
    return None


def within(leaves: Sequence[Leaf], name: str) -> list[Leaf]:
    """Return the field of a name, or all fields in the message or the array of messages of that name."""
    return [leaf for leaf in leaves if leaf.name == name or leaf.name.startswith((f"{name}.", f"{name}[]."))]


def type_of(leaf: Leaf) -> str:
    """Return the type of a field as definitions write it: ``float64[36]``, ``string[]``."""
    return f"{leaf.type}{_brackets(leaf)}"


def no_such_field(leaves: Sequence[Leaf], name: str) -> str:
    """Return an error text for a field that does not exist, with the nearest names and all names."""
    if inner := within(leaves, name):
        names = ", ".join(repr(leaf.name) for leaf in inner[:_NEAREST])
        return f"{name!r} is not a single field but a message: name fields in it, such as {names}"
    every = [leaf.name for leaf in leaves]
    last = name.rpartition(".")[2]
    alike = [other for other in every if other.rpartition(".")[2] == last]
    near = difflib.get_close_matches(name[:100], every, _NEAREST) or alike[:_NEAREST]
    hint = f"; did you mean {' or '.join(map(repr, near))}?" if near else "."
    return f"no field {name[:100]!r}{hint} Its fields are {tree(leaves) or '(none)'}"


def tree(leaves: Sequence[Leaf]) -> str:
    """Return all fields in one line: ``header{stamp, frame_id}, orientation{x, y, z, w}, covariance[9]``."""
    text = ""
    open_parts: list[str] = []
    for leaf in leaves:
        *outer, last = leaf.name.split(".")
        same = 0
        while same < min(len(outer), len(open_parts)) and outer[same] == open_parts[same]:
            same += 1
        text += "}" * (len(open_parts) - same)
        text += ", " if text else ""
        text += "".join(f"{part}{{" for part in outer[same:]) + last + _brackets(leaf)
        open_parts = outer
        if len(text) > _LONGEST_TREE:
            return f"{text[:_LONGEST_TREE]}… ({len(leaves):,} fields)"
    return text + "}" * len(open_parts)


def _brackets(leaf: Leaf) -> str:
    if not leaf.is_array:
        return ""
    return "[]" if leaf.count is None or leaf.dtype is None else f"[{leaf.count}]"
