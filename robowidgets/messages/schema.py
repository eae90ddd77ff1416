"""The fields of a message by its definition: their types, and the names of their numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from rosbags.interfaces import Nodetype

from .channel import Channel
from .decoding import DecodeError, channel_of, store_of
from .definitions import added, elsewhere
from .fields import type_name
from .layout import NO_FIELD

_INTEGERS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
_SMALL = {"byte": "uint8", "char": "uint8", "int8": "uint8"}
"""All types of one byte count as the same: rcl_interfaces/Log has constants of ``byte`` for its field of ``uint8``."""
_NUMBERED = frozenset(("id", "seq", "line", "count", "index"))
"""Names of fields whose numbers rarely have names."""

_PART = re.compile(r"^=+\nMSG:[ \t]*(\S+)[ \t]*\n", re.MULTILINE)
_CONSTANT = re.compile(r"^[ \t]*(\w+)[ \t]+(\w+)[ \t]*=[ \t]*([+-]?\w+)[ \t]*(?:#.*)?$", re.MULTILINE)

Constant = tuple[str, str, int]
"""Name, type and value."""


class FieldType(NamedTuple):
    """The type of a field: ``float32``, ``string``, ``time``, ``duration``, or the type of a message.

    ``names`` maps its numbers, as text, to the names of constants in the definition.
    """

    type: str
    is_message: bool
    is_array: bool
    names: Mapping[str, str]


class Schema:
    """The types of the fields of a message and of its inner messages.

    Args:
        channel: a channel of its type, with the definition if that is known.

    Raises:
        DecodeError: the type is unknown.
    """

    def __init__(self, channel: Channel) -> None:
        self.type = channel.type
        self._types: Mapping[str, Any] = store_of(channel).fielddefs
        self._texts = _parts(channel)
        self._known: dict[str, dict[str, FieldType]] = {}

    def fields(self, of_type: str) -> Mapping[str, FieldType]:
        """Return the fields of a type, in the order of the definition, or an empty mapping for an unknown type."""
        if of_type not in self._known:
            self._known[of_type] = self._read(of_type)
        return self._known[of_type]

    def _read(self, of_type: str) -> dict[str, FieldType]:
        constants, defined = self._types.get(of_type, ((), ()))
        text = self._texts.get(of_type) or added(of_type) or elsewhere(of_type)
        fields: dict[str, FieldType] = {}
        for name, (kind, what) in defined:
            if name == NO_FIELD:
                continue
            is_array = kind not in (Nodetype.BASE, Nodetype.NAME)
            if is_array:
                kind, what = what[0]
            inner = what if kind == Nodetype.NAME else what[0]
            if inner.startswith("builtin_interfaces/"):
                kind, inner = Nodetype.BASE, inner.rpartition("/")[2].lower()
            fields[name] = FieldType(inner, kind == Nodetype.NAME, is_array, {})
        named = names_of(constants_in(text) or constants, {name: one.type for name, one in fields.items()})
        return {
            name: one._replace(names={str(number): text for number, text in named.get(name, {}).items()})
            for name, one in fields.items()
        }


def schema_of(message: Any, type_hint: str = "") -> Schema | None:
    """Return the schema of a message, or None if its type is unknown.

    Args:
        message: a message of rosbags, rclpy or rospy, or another object.
        type_hint: the type of an object that does not contain its type, such as ``sensor_msgs/msg/Imu``.
    """
    channel = channel_of(message)
    if channel is None:
        name = _ros_name(getattr(message, "__msgtype__", "") or type_name(message)) or _ros_name(type_hint)
        if not name:
            return None
        text = getattr(message, "_full_text", "")  # from rospy
        channel = Channel(0, "", name, "ros1" if text else "cdr", text if isinstance(text, str) else "", 0)
    try:
        return Schema(channel)
    except DecodeError:
        return None


def constants_in(text: str) -> list[Constant]:
    """Return the constants in the text of a definition that are whole numbers."""
    found = []
    for kind, name, value in _CONSTANT.findall(text):
        if _plain(kind) in _INTEGERS:
            try:
                found.append((name, kind, int(value, 0)))
            except ValueError:  # leading zeros
                continue
    return found


def names_of(constants: Iterable[Constant], types: Mapping[str, str]) -> dict[str, dict[int, str]]:
    """Return the names by number, for each field whose numbers have names.

    A definition does not say which constants belong to which field. Constants that begin with the name of a field, or
    with its last words, belong to it, and lose that prefix: ``POWER_SUPPLY_STATUS_FULL``. The others form groups; a new
    group begins if a number is lower than the one before. Each group belongs to one field of its type, if there are as
    many such fields as groups.
    """
    left = [(name, kind, int(value)) for name, kind, value in constants if _plain(kind) in _INTEGERS]
    fields = {name: _plain(kind) for name, kind in types.items() if _plain(kind) in _INTEGERS}
    found: dict[str, dict[int, str]] = {}
    taken: set[str] = set()
    for field in fields:
        if own := _with_prefix(left, field):
            found[field] = _by_number((short, value) for _, short, value in own)
            taken |= {name for name, _, _ in own}
    left = [one for one in left if one[0] not in taken]
    for kind in dict.fromkeys(fields.values()):
        groups = _groups([one for one in left if _plain(one[1]) == kind])
        free = [name for name, one in fields.items() if one == kind and name not in found]
        if len(groups) != len(free):
            free = [name for name in free if name not in _NUMBERED]
        if len(groups) == len(free) and all(len(group) > 1 for group in groups):
            for name, group in zip(free, groups, strict=True):
                found[name] = _by_number((constant, value) for constant, _, value in group)
    return found


def _with_prefix(constants: Iterable[Constant], field: str) -> list[tuple[str, str, int]]:
    """Return the constants with the name of a field as a prefix: names, names without the prefix, and values."""
    words = re.sub(r"(?<=[a-z\d])(?=[A-Z])", "_", field).upper().split("_")
    listed = list(constants)
    for first in range(len(words)):
        prefix = "_".join(words[first:]) + "_"
        own = [(name, name[len(prefix) :], value) for name, _, value in listed if name.upper().startswith(prefix)]
        if own:
            return own
    return []


def _by_number(named: Iterable[tuple[str, int]]) -> dict[int, str]:
    listed = list(named)
    start = _common_words([name for name, _ in listed])
    names: dict[int, str] = {}
    for name, value in listed:
        names.setdefault(value, name[start:])
    return names


def _common_words(names: list[str]) -> int:
    """Return the length of the words with which all names begin; at least one word of each name is left."""
    if len(names) < 2:
        return 0
    words = [name.split("_") for name in names]
    count = 0
    while all(len(one) > count + 1 and one[count] == words[0][count] for one in words):
        count += 1
    return sum(len(word) + 1 for word in words[0][:count])


def _groups(constants: list[Constant]) -> list[list[Constant]]:
    groups: list[list[Constant]] = []
    for one in constants:
        if not groups or one[2] < groups[-1][-1][2]:
            groups.append([])
        groups[-1].append(one)
    return groups


def _plain(kind: str) -> str:
    return _SMALL.get(kind, kind)


def _parts(channel: Channel) -> dict[str, str]:
    """Return the texts in the definition of a channel, by type; a definition in IDL is not split."""
    first, *parts = _PART.split(channel.definition.replace("\r", ""))
    names = [_ros_name(name) for name in parts[::2]]
    return {channel.type: first, **dict(zip(names, parts[1::2], strict=True))}


def _ros_name(name: str) -> str:
    """Return a type as ``sensor_msgs/msg/Imu``, or an empty text if it is not a type of ROS."""
    found = re.fullmatch(r"(\w+)/(?:msg/)?(\w+)", name)
    return f"{found[1]}/msg/{found[2]}" if found else ""
