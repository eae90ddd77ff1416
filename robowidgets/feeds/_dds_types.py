"""Topics and types of ROS 2 in DDS: their names, hashes, and classes whose messages Cyclone DDS returns as bytes."""

from __future__ import annotations

import re
import threading
from collections.abc import Collection
from contextlib import suppress
from functools import lru_cache
from typing import Any

from cyclonedds.idl import make_idl_struct, types
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from ..messages.channel import Channel
from ..messages.decoding import Decode, DecodeError, decoder_of, store_of
from ..messages.decoding import definition_of as definition_text
from ..messages.definitions import added, version

NODES = "ros_discovery_info"
"""The DDS topic on which ROS 2 announces its nodes and their endpoints. It is not a ROS topic."""

_TYPE = re.compile(r"(\w+)::msg::dds_::(\w+)_")
_BASES = {
    "bool": bool,
    "octet": types.byte,
    "byte": types.byte,
    "char": types.uint8,
    "string": str,
    **{name: getattr(types, name) for name in ("int8", "int16", "int32", "int64", "float32", "float64")},
    **{name: getattr(types, name) for name in ("uint8", "uint16", "uint32", "uint64")},
}


_making = threading.Lock()  # Cyclone DDS uses a global variable while it makes a type


def ros_topic(name: str) -> str:
    """Return ``/scan`` for ``rt/scan``, `NODES` unchanged, or empty for anything else, such as a service."""
    return name[2:] if name.startswith("rt/") else name if name == NODES else ""


def dds_topic(name: str) -> str:
    """Return ``rt/scan`` for ``/scan``, or `NODES` unchanged."""
    return name if name == NODES else f"rt{name}"


def ros_type(name: str) -> str:
    """Return ``sensor_msgs/msg/LaserScan`` for ``sensor_msgs::msg::dds_::LaserScan_``, or empty if not a message."""
    found = _TYPE.fullmatch(name)
    return f"{found[1]}/msg/{found[2]}" if found else ""


def definition_of(type_name: str, user_data: Collection[bytes], type_ids: Collection[Any]) -> str:
    """Return the definition of a type that its publishers use, for `decoder`, `struct` and `type_hash`.

    The hash in their user data or the type identifier of DDS selects it. Otherwise it is the newest definition.
    """
    texts = _definitions(type_name)
    for text in texts if len(texts) > 1 else ():
        if any(type_hash(type_name, text) in data for data in user_data):
            return text
        if type_ids and struct(type_name, text).__idl__.get_type_id() in type_ids:
            return text
    return texts[0] if texts else ""


def decoder(type_name: str, definition: str = "") -> Decode:
    """Return a function that decodes messages by a definition of the type, or by another definition if that one fails.

    Raises:
        DecodeError: the type is unknown. The returned function raises it for bytes that are not such a message.
    """
    others = [decoder_of(_channel(type_name, text)) for text in _definitions(type_name) if text != definition]
    first = decoder_of(_channel(type_name, definition))

    def decode(raw: bytes) -> Any:
        try:
            return first(raw)
        except DecodeError:
            for other in others:
                with suppress(DecodeError):
                    return other(raw)
            raise

    return decode if others else first


@lru_cache(None)  # Cyclone DDS never frees a type, so each type is made once
def struct(type_name: str, definition: str = "") -> Any:
    """Return the type with its fields, which Cyclone DDS compares with the fields that a publisher describes.

    Raises:
        DecodeError: the type is unknown.
    """
    store = store_of(_channel(type_name, definition))
    with _making:
        return _as_bytes(_struct(store, type_name))


def type_hash(type_name: str, definition: str = "") -> bytes:
    """Return the hash of a type as ROS 2 puts it into user data. Raises DecodeError as `struct` does."""
    return f"typehash={store_of(_channel(type_name, definition)).hash_rihs01(type_name)};".encode()


@lru_cache(None)
def opaque(type_name: str) -> Any:
    """Return a type that accepts any bytes, for publishers that do not describe their type and so match by name.

    With a full type, Cyclone DDS would silently drop messages that do not match it.
    """
    with _making:
        return _as_bytes(make_idl_struct("Opaque", _dds_type(type_name), {"first": types.uint8}))


def _definitions(type_name: str) -> tuple[str, ...]:
    """Return the definitions of a type as texts, best first. An empty text stands for the definition of `store_of`.

    A definition of the user is best, then the newest: ``sensor_msgs/Range``, for example, got the field ``variance``
    after Humble.
    """
    return _known_definitions(type_name, version())


@lru_cache
def _known_definitions(type_name: str, _version: int) -> tuple[str, ...]:
    newest = get_typestore(Stores.LATEST)
    # The user's definition is needed as a text, because the result for an empty text is cached forever.
    texts = [definition_text(_channel(type_name, ""))] if added(type_name) else []
    texts += [newest.generate_msgdef(type_name, ros_version=2)[0]] if type_name in newest.fielddefs else []
    by_hash: dict[bytes, str] = {}
    for text in (*texts, ""):
        with suppress(DecodeError):
            by_hash[type_hash(type_name, text)] = text
    return tuple(by_hash.values())


def _as_bytes(struct: Any) -> Any:
    """Return the same type, but its instances hold raw bytes, with the 4-byte encapsulation header, and no fields."""

    def start(self: Any, raw: bytes) -> None:
        self.raw = raw

    def load(cls: Any, /, data: bytes, **_: Any) -> Any:
        return cls(data)

    struct.__init__ = start
    struct.serialize = lambda self, **_: self.raw
    struct.deserialize = struct.deserialize_key = classmethod(load)
    struct.__idl__.fill_type_data()
    return struct


def _struct(store: Typestore, type_name: str) -> Any:
    fields = {name: _field(store, kind, what) for name, (kind, what) in store.fielddefs[type_name][1]}
    return make_idl_struct(type_name.rpartition("/")[2], _dds_type(type_name), fields)


def _field(store: Typestore, kind: int, what: Any) -> Any:
    if kind == Nodetype.NAME:
        return _struct(store, what)
    if kind == Nodetype.BASE:
        if what[0] not in _BASES:
            raise DecodeError(f"a field of type {what[0]} cannot be described to DDS")
        return _BASES[what[0]]
    (inner, name), count = what
    items = _field(store, inner, name)
    return types.array[items, count] if kind == Nodetype.ARRAY else types.sequence[items]


def _dds_type(type_name: str) -> str:
    package, _, name = type_name.partition("/msg/")
    return f"{package}::msg::dds_::{name}_"


def _channel(type_name: str, definition: str) -> Channel:
    return Channel(0, "", type_name, "cdr", definition, 0)
