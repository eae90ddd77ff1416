"""Types of ROS 2 in DDS: classes whose messages Cyclone DDS returns as bytes."""

from __future__ import annotations

import threading
from collections.abc import Collection
from functools import lru_cache
from typing import Any

from cyclonedds.idl import make_idl_struct, types
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

from ..messages.decoding import DecodeError, store_of
from ._ros2_types import channel_of, dds_type, definitions_of, hash_of

NODES = "ros_discovery_info"
"""The DDS topic on which ROS 2 announces its nodes and their endpoints. It is not a ROS topic."""

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


def definition_of(type_name: str, user_data: Collection[bytes], type_ids: Collection[Any]) -> str:
    """Return the definition of a type that its publishers use, for `decoder_for`, `struct` and `type_hash`.

    The hash in their user data or the type identifier of DDS selects it. Otherwise it is the newest definition.
    """
    texts = definitions_of(type_name)
    for text in texts if len(texts) > 1 else ():
        if any(type_hash(type_name, text) in data for data in user_data):
            return text
        if type_ids and struct(type_name, text).__idl__.get_type_id() in type_ids:
            return text
    return texts[0] if texts else ""


@lru_cache(None)  # Cyclone DDS never frees a type, so each type is made once
def struct(type_name: str, definition: str = "") -> Any:
    """Return the type with its fields, which Cyclone DDS compares with the fields that a publisher describes.

    Raises:
        DecodeError: the type is unknown.
    """
    store = store_of(channel_of(type_name, definition))
    with _making:
        return _as_bytes(_struct(store, type_name))


def type_hash(type_name: str, definition: str = "") -> bytes:
    """Return the hash of a type as ROS 2 puts it into user data. Raises DecodeError as `struct` does."""
    return f"typehash={hash_of(type_name, definition)};".encode()


@lru_cache(None)
def opaque(type_name: str) -> Any:
    """Return a type that accepts any bytes, for publishers that do not describe their type and so match by name.

    With a full type, Cyclone DDS would silently drop messages that do not match it.
    """
    with _making:
        return _as_bytes(make_idl_struct("Opaque", dds_type(type_name), {"first": types.uint8}))


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
    return make_idl_struct(type_name.rpartition("/")[2], dds_type(type_name), fields)


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
