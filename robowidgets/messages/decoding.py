"""Decoding of messages: the definitions of their types, and readers for them.

Only this module, `encoding` and `recordings.files` read and write with rosbags. It is imported with the first
definition: it takes longer than all other imports of a feed, and the simulated robot does not need it.
"""

from __future__ import annotations

import re
import struct
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
"""Type names to constants and fields, as rosbags represents them."""

_DEFAULTS = {"cdr": "ROS2_HUMBLE", "ros1": "ROS1_NOETIC"}
ENCODINGS = tuple(_DEFAULTS)
_MOST_FIELDS = 10_000
_MOST_KEPT = 256
"""Types that the process caches: rosbags takes milliseconds to parse a definition and compile it."""
_LONGEST_KEPT = 1 << 16
"""The longest definition to cache, in characters."""
_IDL_HEAD = re.compile(r"^=+\nIDL: .*\n", re.MULTILINE)
_IDL_DIRECTIVE = re.compile(r"^[ \t]*#.*$", re.MULTILINE)
"""A line for the preprocessor of IDL, such as ``#include``, which rosbags rejects."""

# Comments and constants do not affect the bytes and cost time. And rosbags mistakes a constant whose name is not in
# capitals (Button0 of kobuki_msgs/ButtonEvent) for a field.
_NEEDLESS = re.compile(r"^[ \t]*(#.*|[a-z0-9]+(<=\d+)?[ \t]+\w+[ \t]*=.*)?\n", re.MULTILINE)


class DecodeError(ValueError):
    """The type is unknown, or the bytes are not a valid message. The text is one line for users."""


class UnknownTypeError(DecodeError):
    """The type has no known definition. The text is the remedy after a colon, or empty.

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
    """Return the fields of a channel's messages; raise DecodeError if they are unknown."""
    return shape_in(store_of(channel).fielddefs, channel.type)


def decoder_of(channel: Channel) -> Decode:
    """Return a function that decodes the messages of a channel.

    Raises:
        DecodeError: the type or the encoding is unknown; the returned function raises it for invalid bytes.
    """
    store, type_name, encoding = store_of(channel), channel.type, channel.encoding
    _read_from[store.types[type_name]] = channel
    read = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr
    if may_go_on(channel):
        read = partial(_read_start, store, encoding)

    def decode(raw: bytes) -> Any:
        try:
            return read(memoryview(raw), type_name)
        except Exception as error:  # rosbags raises many types, such as KeyError and IndexError
            why = "they end within a field" if isinstance(error.__cause__, struct.error) else one_line(error)
            raise DecodeError(f"{len(raw)} bytes are not a valid {type_name}: {why}") from error

    return decode


def may_go_on(channel: Channel) -> bool:
    """Return True if the bytes of a message may go on after its last field.

    Nodes read the fields of the definition and ignore further bytes. But a definition from outside the file may be
    another version of the type: then bytes after the last field mean that the other fields may be wrong too.
    """
    return bool(channel.definition.strip())


def _read_start(store: Typestore, encoding: str, raw: memoryview, type_name: str) -> Any:
    """Return the message at the start of some bytes. Raise any exception of rosbags and struct."""
    definition = store.get_msgdef(type_name)
    if encoding == "ros1":
        return definition.deserialize_ros1(raw, 0, definition.cls, store)[0]
    if len(raw) < _CDR_HEAD or bytes(raw[:2]) not in (b"\0\0", b"\0\1"):
        raise DecodeError("they do not begin with a header of CDR")
    read = definition.deserialize_cdr_le if raw[1] else definition.deserialize_cdr_be
    return read(raw[_CDR_HEAD:], 0, definition.cls, store)[0]


_CDR_HEAD = 4
_read_from: WeakKeyDictionary[type, Channel] = WeakKeyDictionary()
"""The classes of decoded messages, each with a channel that has such messages."""


def channel_of(message: Any) -> Channel | None:
    """Return a channel with the type and definition from which a message was decoded, or None for other objects."""
    return _read_from.get(type(message))


def definition_of(channel: Channel) -> str:
    """Return the definition of a channel: from the file, else the known definition of its type, else empty."""
    if channel.definition.strip() or channel.encoding not in ENCODINGS:
        return channel.definition
    try:
        return store_of(channel).generate_msgdef(channel.type, ros_version=1 if channel.encoding == "ros1" else 2)[0]
    except DecodeError:
        return ""


def store_of(channel: Channel) -> Typestore:
    """Return a store with the type of a channel; raise DecodeError if the type is unknown."""
    find = _find if len(channel.definition) <= _LONGEST_KEPT else _find.__wrapped__
    return find(channel.type, channel.definition, channel.encoding, version())


@lru_cache(_MOST_KEPT)
def _find(type_name: str, definition: str, encoding: str, _version: int) -> Typestore:
    """Return a store; definitions from a file get a separate one, because files may define a type differently."""
    why = "no definition of its messages in the file, nor among those that are known"
    if definition.strip():
        try:
            return _store(type_name, parsed(type_name, definition), encoding)
        except Exception:  # rosbags raises many types; the error below has the reason
            why = "the definition of its messages in the file cannot be understood, and no other is known"
    if not added(type_name) and type_name in _default(encoding).fielddefs:
        return _default(encoding)
    try:
        return _store(type_name, _known(type_name, encoding), encoding)
    except UnknownTypeError as error:
        raise DecodeError(f"{why}{error}") from None


@lru_cache
def _default(encoding: str) -> Typestore:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores[_DEFAULTS[encoding]])


def _store(type_name: str, types: Types, encoding: str) -> Typestore:
    """Return a store of some types, and of the types that they use."""
    from rosbags.typesys import Stores, get_typestore

    types = complete(types, encoding)
    shape_in(types, type_name)
    store = get_typestore(Stores.EMPTY)
    store.register(types)
    return store


def complete(types: Types, encoding: str = "cdr") -> Types:
    """Return the types and all types that they use; raise UnknownTypeError if one is unknown."""
    missing = {used for name in types for used in _used(types[name]) if used not in types}
    missing -= {"builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"}
    if not missing:
        return types
    for name in sorted(missing):
        types = types | _known(name, encoding)
    return complete(types, encoding)


def _known(type_name: str, encoding: str) -> Types:
    """Return a type that was added, or that rosbags, an installed ROS or robowidgets defines."""
    text = added(type_name)
    if not text and type_name in (standard := _default(encoding).fielddefs):
        return {type_name: standard[type_name]}
    text = text or elsewhere(type_name)
    if not text:
        raise UnknownTypeError(type_name)
    return parsed(type_name, text)


def one_line(error: BaseException) -> str:
    """Return the text of an error as one line for users."""
    text = next((line.strip() for line in str(error).splitlines() if line.strip()), "")
    return (text if len(text) <= 120 else f"{text[:119]}…") or type(error).__name__


def parsed(type_name: str, definition: str) -> Types:
    """Return the types in the text of a definition; raise any exception of rosbags."""
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    if not _IDL_HEAD.match(definition):
        return dict(get_types_from_msg(_NEEDLESS.sub("", definition.replace("\r", "") + "\n"), type_name))
    types: Types = {}
    for part in _IDL_HEAD.split(definition)[1:]:
        types.update(get_types_from_idl(_IDL_DIRECTIVE.sub("", part)))
    return types


def _used(definition: Any) -> Iterator[str]:
    """Yield the types that the fields of a definition name."""
    from rosbags.interfaces import Nodetype

    for _, (kind, what) in definition[1]:
        inner, name = (kind, what) if kind in (Nodetype.BASE, Nodetype.NAME) else what[0]
        if inner == Nodetype.NAME:
            yield name


def shape_in(types: Types, type_name: str, room: Iterator[int] | None = None) -> dict[str, Any]:
    """Return the fields of a type.

    Raises:
        DecodeError: there are too many. RecursionError: a message contains itself.
    """
    # Nested types may double with every level: a few lines can define more fields than fit into memory.
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
