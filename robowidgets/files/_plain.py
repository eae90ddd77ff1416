"""Messages in JSON and in protobuf, converted to ROS 2 messages, so that every part of a recording can read them."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import suppress
from itertools import islice
from typing import Any

from ..messages.channel import Channel, full_type
from ..messages.decoding import DecodeError, store_of
from ..messages.encoding import encode
from ..messages.foxglove import as_ros
from ..messages.json_shape import JsonShape
from ..messages.protobuf import has_protobuf, reader_of
from ..repair import Message, RecordingError, RemoteError, Source

_PLAIN = ("json", "protobuf")
_LOOKED_AT = 100
"""Messages of a topic of a custom type from which its fields are found."""

Encode = Callable[[bytes], bytes]


def in_ros(source: Source) -> Source:
    """Return a source whose JSON messages, and protobuf messages if protobuf is installed, are messages of ROS 2."""
    return PlainSource(source) if is_plain(source) else source


def is_plain(source: Source) -> bool:
    """Return True if a source has messages in JSON or protobuf."""
    return any(channel.encoding in _PLAIN for channel in source.channels)


class PlainSource:
    """A `Source` whose messages are encoded as ROS 2 messages when they are read.

    A message that cannot be converted is passed on unchanged; its decoder then raises the error.

    Args:
        source: the messages as the file has them. It is closed with this object.
    """

    def __init__(self, source: Source) -> None:
        self._source = source
        self.start_ns, self.end_ns = source.start_ns, source.end_ns
        self._inner = {channel.id: channel for channel in source.channels}
        self._encodes: dict[int, Encode] = {}
        self.channels = tuple(self._understood(channel) for channel in source.channels)

    @property
    def problems(self) -> tuple[str, ...]:
        """See `Source`."""
        return self._source.problems

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """See `Source`."""
        asked = {channel.id: channel for channel in channels}
        inner = [self._inner[number] for number in asked]
        for channel, time_ns, raw in self._source.messages(inner, start_ns, stop_ns):
            yield asked[channel.id], time_ns, self._encode(channel, raw)

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """See `Source`."""
        return self._source.span_ns(self._inner[channel.id])

    def size_of(self, channels: Collection[Channel]) -> int:
        """See `Source`."""
        return self._source.size_of([self._inner[channel.id] for channel in channels])

    def thinned(self, channels: Collection[Channel], most_bytes: int, most_parts: int) -> Iterator[list[Message]]:
        """See `Source`."""
        asked = {channel.id: channel for channel in channels}
        inner = [self._inner[number] for number in asked]
        for part in self._source.thinned(inner, most_bytes, most_parts):
            yield [(asked[channel.id], time_ns, self._encode(channel, raw)) for channel, time_ns, raw in part]

    def _encode(self, channel: Channel, raw: bytes) -> bytes:
        encode_one = self._encodes.get(channel.id)
        return encode_one(raw) if encode_one else raw

    def close(self) -> None:
        """See `Source`."""
        self._source.close()

    def _understood(self, channel: Channel) -> Channel:
        """Return the channel as a ROS 2 channel and store its encoder, or return it unchanged if that is impossible."""
        if channel.encoding not in _PLAIN or (channel.encoding == "protobuf" and not has_protobuf()):
            return channel
        try:
            is_json = channel.encoding == "json"
            read = _from_json if is_json else reader_of(channel.type, channel.definition)
            ros = as_ros(channel.type)
            if ros is not None:
                type_name, convert = ros
                definition = ""
            else:
                type_name, definition, convert = self._own(channel, read)
        except RemoteError:
            raise
        except (ValueError, RecordingError):  # the reader of the unchanged channel reports the reason
            return channel

        def encode_one(raw: bytes) -> bytes:
            try:
                return encode("cdr", type_name, convert(read(raw)), definition)
            except (ArithmeticError, LookupError, TypeError, ValueError):
                return raw

        self._encodes[channel.id] = encode_one
        return channel._replace(type=type_name, encoding="cdr", definition=definition)

    def _own(self, channel: Channel, read: Callable[[bytes], Any]) -> tuple[str, str, Callable[[Any], dict[str, Any]]]:
        """Return type and definition for a channel without Foxglove schema, and a function from messages to fields."""
        if channel.encoding == "json" and _is_known(channel.type):
            return channel.type, "", dict
        raws = [raw for _, _, raw in islice(self._source.messages([channel]), _LOOKED_AT)]
        shape = JsonShape(_read_all(read, raws))
        package, _, name = re.sub(r"\W+", ".", channel.type).strip(".").rpartition(".")
        package = re.sub(r"\W+", "_", package.lower()) or channel.encoding
        return f"{package}/msg/{name or 'Message'}", shape.definition(package), shape.fields_of


def _read_all(read: Callable[[bytes], Any], raws: Iterable[bytes]) -> Iterator[Any]:
    """Yield the messages that can be read. The others are reported when their samples are read."""
    for raw in raws:
        with suppress(ValueError):
            yield read(raw)


def _is_known(type_name: str) -> bool:
    """Return True if a ROS type is known without definitions from a file."""
    try:
        store_of(Channel(0, "", full_type(type_name), "cdr", "", 0))
    except DecodeError:
        return False
    return True


def _from_json(raw: bytes) -> Any:
    try:
        return json.loads(raw)
    except RecursionError:
        raise ValueError("JSON that is too deep") from None
