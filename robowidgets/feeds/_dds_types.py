"""What DDS calls the topics and types of ROS 2, and types whose messages Cyclone DDS hands over as bytes."""

from __future__ import annotations

import re
from typing import Any

from cyclonedds.idl import make_idl_struct, types
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

from ..recordings.ros_types import Decode, decoder_of, store_of
from ..recordings.source import Channel, RecordingError

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


def ros_topic(name: str) -> str:
    """``/scan`` for ``rt/scan``; empty for what is no topic of ROS 2, such as a service."""
    return name[2:] if name.startswith("rt/") else ""


def ros_type(name: str) -> str:
    """``sensor_msgs/msg/LaserScan`` for ``sensor_msgs::msg::dds_::LaserScan_``; empty for what is no message."""
    found = _TYPE.fullmatch(name)
    return f"{found[1]}/msg/{found[2]}" if found else ""


def decoder(type_name: str) -> Decode:
    """What makes messages of bytes.

    Raises:
        RecordingError: nobody defines the type; what is returned raises it for bytes that are no such message.
    """
    return decoder_of(_channel(type_name))


def struct(type_name: str) -> Any:
    """The type with its fields: Cyclone DDS compares them with those of a publisher that describes its own.

    Raises:
        RecordingError: nobody defines the type.
    """
    return _as_bytes(_struct(store_of(_channel(type_name)), type_name))


def type_hash(type_name: str) -> bytes:
    """What a publisher of ROS 2 says of its type beside the name; raises as `struct`."""
    return f"typehash={store_of(_channel(type_name)).hash_rihs01(type_name)};".encode()


def opaque(type_name: str) -> Any:
    """A type of that name that fits any bytes: for publishers that do not describe theirs, and so match by name.

    Cyclone DDS drops what does not fit a type without a word.
    """
    return _as_bytes(make_idl_struct("Opaque", _dds_type(type_name), {"first": types.uint8}))


def _as_bytes(struct: Any) -> Any:
    """The same type, whose instances hold their bytes, with the four of encapsulation, in place of fields."""

    def start(self: Any, raw: bytes) -> None:
        self.raw = raw

    def load(cls: Any, /, data: bytes, **_: Any) -> Any:
        return cls(data)

    struct.__init__ = start
    struct.serialize = lambda self, **_: self.raw
    struct.deserialize = struct.deserialize_key = classmethod(load)
    return struct


def _struct(store: Typestore, type_name: str) -> Any:
    fields = {name: _field(store, kind, what) for name, (kind, what) in store.fielddefs[type_name][1]}
    return make_idl_struct(type_name.rpartition("/")[2], _dds_type(type_name), fields)


def _field(store: Typestore, kind: int, what: Any) -> Any:
    if kind == Nodetype.NAME:
        return _struct(store, what)
    if kind == Nodetype.BASE:
        if what[0] not in _BASES:
            raise RecordingError(f"a field of type {what[0]} cannot be described to DDS")
        return _BASES[what[0]]
    (inner, name), count = what
    items = _field(store, inner, name)
    return types.array[items, count] if kind == Nodetype.ARRAY else types.sequence[items]


def _dds_type(type_name: str) -> str:
    package, _, name = type_name.partition("/msg/")
    return f"{package}::msg::dds_::{name}_"


def _channel(type_name: str) -> Channel:
    return Channel(0, "", type_name, "cdr", "", 0)
