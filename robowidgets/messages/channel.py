"""One stream of messages of one type, as listed in a file."""

from __future__ import annotations

import re
from base64 import b64decode
from collections.abc import Iterable
from typing import NamedTuple


class Channel(NamedTuple):
    """One stream of messages of one type.

    ``id`` is unique within a source only. ``type`` is written as ``sensor_msgs/msg/LaserScan``, for ROS 1 too.
    ``encoding`` is ``"ros1"`` or ``"cdr"``; messages in any other encoding are listed but cannot be read.
    ``definition`` is the text of the message definition: in ROS's ``.msg`` syntax, with its dependencies after lines of
    80 ``=``, or in IDL, after such a line and ``IDL: `` with the type. It is empty if the file has none. ``count`` is
    the number of messages. ``callers`` are the names of the nodes that published them, if the file has any.
    ``metadata`` are names and values as an MCAP file has them: ``offered_qos_profiles`` in YAML, or ``latching``.
    """

    id: int
    topic: str
    type: str
    encoding: str
    definition: str
    count: int  # type: ignore[assignment]  # hides tuple.count, which a channel does not need
    callers: tuple[str, ...] = ()
    metadata: tuple[tuple[str, str], ...] = ()

    @property
    def is_latched(self) -> bool:
        """True if a node that subscribes later gets the last message too: latched, or with transient local QoS."""
        about = dict(self.metadata)
        return (
            about.get("latching") == "1" or _TRANSIENT_LOCAL.search(about.get("offered_qos_profiles", "")) is not None
        )


def merged(files: Iterable[Iterable[Channel]]) -> tuple[tuple[Channel, ...], list[dict[int, int]]]:
    """Return the channels of one recording in several files, numbered from 0, and for each file its ids to new ids.

    Channels with the same topic, type, encoding and definition become one.
    """
    found: dict[Channel, Channel] = {}
    ids: list[dict[int, int]] = []
    for channels in files:
        ids.append({})
        for channel in channels:
            same = channel._replace(id=0, count=0, callers=(), metadata=())
            one = found.get(same) or same._replace(id=len(found))
            callers = tuple(dict.fromkeys((*one.callers, *channel.callers)))
            metadata = tuple({**dict(one.metadata), **dict(channel.metadata)}.items())
            found[same] = one._replace(count=one.count + channel.count, callers=callers, metadata=metadata)
            ids[-1][channel.id] = one.id
    return tuple(found.values()), ids


_MESSAGE = ("ros1msg", "ros2msg")
_IDL = ("ros2idl", "omgidl")
_OTHERS = ("protobuf", "jsonschema")
_TRANSIENT_LOCAL = re.compile(r"durability:\s*(1\b|transient_local)")
_LINE = "=" * 80


def full_type(name: str) -> str:
    """Return a type in the spelling of ROS 2: ``sensor_msgs/msg/LaserScan`` for ``sensor_msgs/LaserScan``."""
    package, slash, rest = name.partition("/")
    return f"{package}/msg/{rest}" if slash and "/" not in rest else name


def definition_text(encoding: str, type_name: str, text: str) -> str:
    """Return the text of a definition for a `Channel`, or an empty text for an unsupported language.

    A definition of protobuf is bytes in base64.
    """
    text = text.replace("\r\n", "\n")
    if encoding in _IDL and text and not text.startswith(_LINE):
        return f"{_LINE}\nIDL: {type_name}\n{text}"
    return text if encoding in (*_MESSAGE, *_IDL, *_OTHERS) else ""


def is_idl(definition: str) -> bool:
    """Return True if the definition of a `Channel` is in IDL."""
    return definition.startswith(f"{_LINE}\nIDL: ")


def schema_of(channel: Channel, definition: str) -> tuple[str, str, bytes]:
    """Return name, encoding and data of the schema that an MCAP file has for a channel with this definition."""
    if not definition.strip():
        return channel.type, "", b""
    if channel.encoding == "ros1":
        return channel.type.replace("/msg/", "/"), "ros1msg", definition.encode()
    if channel.encoding == "protobuf":
        return channel.type, "protobuf", b64decode(definition)
    if channel.encoding == "json" and definition.lstrip().startswith("{"):
        return channel.type, "jsonschema", definition.encode()
    return channel.type, "ros2idl" if is_idl(definition) else "ros2msg", definition.encode()
