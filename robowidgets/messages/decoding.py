"""Messages from bytes: the definitions of their types, and the readers made of them.

Only this module, `encoding` and `recordings.files` read and write with rosbags. That is imported with the first
definition: it takes longer than all else that a feed imports, and the simulated robot has no need of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from .channel import Channel
from .definitions import added, elsewhere, version
from .fields import MessageShape

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

Decode = Callable[[bytes], Any]
Types = dict[str, Any]
"""Type names to their constants and fields, as rosbags holds them."""

_DEFAULTS = {"cdr": "ROS2_HUMBLE", "ros1": "ROS1_NOETIC"}
ENCODINGS = tuple(_DEFAULTS)
_MOST_FIELDS = 10_000
_MOST_KEPT = 256
"""Types that the process keeps ready: to parse a definition and make code of it takes rosbags milliseconds."""
_LONGEST_KEPT = 1 << 16
"""Characters of a definition that is kept."""
_IDL_HEAD = re.compile(r"^=+\nIDL: .*\n", re.MULTILINE)
_IDL_DIRECTIVE = re.compile(r"^[ \t]*#.*$", re.MULTILINE)
"""A line for the preprocessor of IDL, such as ``#include``, which rosbags takes for a mistake."""

# Comments and constants say nothing about bytes and cost time; and a constant whose name is not in capitals (Button0 of
# kobuki_msgs/ButtonEvent) rosbags takes for a field.
_NEEDLESS = re.compile(r"^[ \t]*(#.*|[a-z0-9]+(<=\d+)?[ \t]+\w+[ \t]*=.*)?\n", re.MULTILINE)


class DecodeError(ValueError):
    """A type that is not known, or bytes that are no message of it. The text is one line for a person."""


class UnknownTypeError(DecodeError):
    """A type of which no definition is known. The text is the remedy, after a colon, or empty.

    Attributes:
        type_name: the type.
    """

    def __init__(self, type_name: str) -> None:
        found = re.fullmatch(r"(\w+)/(msg|action)/\w+", type_name)
        super().__init__(
            f": robowidgets.messages.add_definitions(folder) takes the .{found[2]} files of {found[1]}" if found else ""
        )
        self.type_name = type_name


def shape_of(channel: Channel) -> MessageShape:
    """The fields of a channel's messages; DecodeError when they are not known."""
    return shape_in(store_of(channel).fielddefs, channel.type)


def decoder_of(channel: Channel) -> Decode:
    """A function that decodes the messages of a channel.

    Raises:
        DecodeError: the type or the encoding is unknown; the returned function raises it for bytes that are no such
            message.
    """
    store, type_name, encoding = store_of(channel), channel.type, channel.encoding
    _read_from[store.types[type_name]] = channel
    read = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr
    if may_go_on(channel):
        read = partial(_read_start, store, encoding)

    def decode(raw: bytes) -> Any:
        try:
            return read(memoryview(raw), type_name)
        except Exception as error:  # whatever rosbags stumbles over: its own errors, KeyError, IndexError
            raise DecodeError(f"{len(raw)} bytes that are no {type_name}: {one_line(error)}") from error

    return decode


def may_go_on(channel: Channel) -> bool:
    """Return True if the bytes of a message may go on after its last field.

    Nodes read what the definition says and ignore the rest. A definition that is not from the file itself may be of
    another version of the type: bytes after the last field then say that the fields before are perhaps others.
    """
    return bool(channel.definition.strip())


def _read_start(store: Typestore, encoding: str, raw: memoryview, type_name: str) -> Any:
    """Return the message at the start of some bytes. Raises whatever rosbags and struct raise."""
    definition = store.get_msgdef(type_name)
    if encoding == "ros1":
        return definition.deserialize_ros1(raw, 0, definition.cls, store)[0]
    if len(raw) < _CDR_HEAD or bytes(raw[:2]) not in (b"\0\0", b"\0\1"):
        raise DecodeError("they begin with no encapsulation of CDR")
    read = definition.deserialize_cdr_le if raw[1] else definition.deserialize_cdr_be
    return read(raw[_CDR_HEAD:], 0, definition.cls, store)[0]


_CDR_HEAD = 4
_read_from: WeakKeyDictionary[type, Channel] = WeakKeyDictionary()
"""The classes of messages that were decoded, each with a channel that has them."""


def channel_of(message: Any) -> Channel | None:
    """A channel of the type and the definition from which a message was decoded; None for any other object."""
    return _read_from.get(type(message))


def definition_of(channel: Channel) -> str:
    """The text of a channel's definition; where the file holds none, of the type that is known; else empty."""
    if channel.definition.strip() or channel.encoding not in ENCODINGS:
        return channel.definition
    try:
        return store_of(channel).generate_msgdef(channel.type, ros_version=1 if channel.encoding == "ros1" else 2)[0]
    except DecodeError:
        return ""


def store_of(channel: Channel) -> Typestore:
    """The store that has the type of a channel; DecodeError if none has."""
    find = _find if len(channel.definition) <= _LONGEST_KEPT else _find.__wrapped__
    return find(channel.type, channel.definition, channel.encoding, version())


@lru_cache(_MOST_KEPT)
def _find(type_name: str, definition: str, encoding: str, _version: int) -> Typestore:
    """A store of its own for what a file defines: another file may define a type of the same name in another way."""
    why = "no definition of its messages in the file"
    if definition.strip():
        try:
            return _store(type_name, parsed(type_name, definition), encoding)
        except Exception:  # whatever rosbags stumbles over; what follows tells it
            why = "the definition of its messages in the file is not one that can be understood"
    if not added(type_name) and type_name in _default(encoding).fielddefs:
        return _default(encoding)
    try:
        return _store(type_name, _known(type_name, encoding), encoding)
    except UnknownTypeError as error:
        raise DecodeError(f"{why}, nor among those that are known{error}") from None


@lru_cache
def _default(encoding: str) -> Typestore:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores[_DEFAULTS[encoding]])


def _store(type_name: str, types: Types, encoding: str) -> Typestore:
    """A store of some types, with those that they use."""
    from rosbags.typesys import Stores, get_typestore

    types = complete(types, encoding)
    shape_in(types, type_name)
    store = get_typestore(Stores.EMPTY)
    store.register(types)
    return store


def complete(types: Types, encoding: str = "cdr") -> Types:
    """The types, with those that they use and that are known; UnknownTypeError for one that is not."""
    missing = {used for name in types for used in _used(types[name]) if used not in types}
    missing -= {"builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"}
    if not missing:
        return types
    for name in sorted(missing):
        types = types | _known(name, encoding)
    return complete(types, encoding)


def _known(type_name: str, encoding: str) -> Types:
    """A type that was added, or that rosbags, an installed ROS or we know."""
    text = added(type_name)
    if not text and type_name in (standard := _default(encoding).fielddefs):
        return {type_name: standard[type_name]}
    text = text or elsewhere(type_name)
    if not text:
        raise UnknownTypeError(type_name)
    return parsed(type_name, text)


def one_line(error: BaseException) -> str:
    """The text of an error as one line for a person."""
    text = next((line.strip() for line in str(error).splitlines() if line.strip()), "")
    return (text if len(text) <= 120 else f"{text[:119]}…") or type(error).__name__


def parsed(type_name: str, definition: str) -> Types:
    """The types in the text of a definition; raises whatever rosbags stumbles over."""
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    if not _IDL_HEAD.match(definition):
        return dict(get_types_from_msg(_NEEDLESS.sub("", definition.replace("\r", "") + "\n"), type_name))
    types: Types = {}
    for part in _IDL_HEAD.split(definition)[1:]:
        types.update(get_types_from_idl(_IDL_DIRECTIVE.sub("", part)))
    return types


def _used(definition: Any) -> Iterator[str]:
    """The types that the fields of a definition name."""
    from rosbags.interfaces import Nodetype

    for _, (kind, what) in definition[1]:
        inner, name = (kind, what) if kind in (Nodetype.BASE, Nodetype.NAME) else what[0]
        if inner == Nodetype.NAME:
            yield name


def shape_in(types: Types, type_name: str, room: Iterator[int] | None = None) -> dict[str, Any]:
    """The fields of one of some types; DecodeError for too many, RecursionError for a message that contains itself."""
    # Types within types double with every level: few lines can say more fields than fit in any memory.
    room = iter(range(_MOST_FIELDS)) if room is None else room
    return {name: _kind(types, kind, what, room) for name, (kind, what) in types[type_name][1]}


def _kind(types: Types, kind: int, what: Any, room: Iterator[int]) -> Any:
    from rosbags.interfaces import Nodetype

    if next(room, None) is None:
        raise DecodeError(f"the definition of its messages has more than {_MOST_FIELDS:,} fields")
    if kind == Nodetype.BASE:
        return what[0]
    if kind == Nodetype.NAME:
        return what.rpartition("/")[2] if what.startswith("builtin_interfaces/") else shape_in(types, what, room)
    (inner, name), count = what
    return f"{name[0] if inner == Nodetype.BASE else name}[{count if kind == Nodetype.ARRAY else ''}]"
