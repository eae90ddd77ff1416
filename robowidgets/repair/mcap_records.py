"""The records of MCAP files: their numbers, sizes and layouts.

Source: https://mcap.dev/spec
"""

from __future__ import annotations

from base64 import b64encode
from struct import Struct, error, unpack_from
from typing import NamedTuple

import numpy as np

from ..messages.channel import Channel, definition_text, full_type

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(2, 9)
SUMMARY_OFFSET = 14
RECORD_HEAD = Struct("<BQ")
"""The type of a record and the number of bytes that follow."""
INDEX_HEAD = Struct("<BQHI")
"""The head of a message index, which has the messages of one channel in a chunk."""
INDEX_ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
"""A message in a message index."""
USED_METADATA = ("offered_qos_profiles", "latching")
"""The names of `Channel.metadata`."""


class McapSchema(NamedTuple):
    """A schema. The text is in base64 for protobuf, whose schemas are bytes."""

    name: str = ""
    encoding: str = ""
    text: str = ""


class McapChannel(NamedTuple):
    """A channel, with the number of its schema."""

    schema: int
    topic: str
    encoding: str
    metadata: tuple[tuple[str, str], ...]

    def with_schema(self, number: int, schema: McapSchema) -> Channel:
        """Return the channel with a number and its schema, and without the number of its messages."""
        text = definition_text(schema.encoding, schema.name, schema.text)
        return Channel(number, self.topic, full_type(schema.name), self.encoding, text, 0, (), self.metadata)


def parse_schema(raw: bytes) -> tuple[int, McapSchema]:
    """Return the number and the schema of a record; raise struct.error if a part is missing."""
    name, encoding, text = _strings(raw[2:], 3)
    # The text of protobuf is bytes.
    shown = b64encode(text).decode() if encoding == b"protobuf" else _text(text)
    return unpack_from("<H", raw)[0], McapSchema(_text(name), _text(encoding), shown)


def parse_channel(raw: bytes) -> tuple[int, McapChannel]:
    """Return the number and the channel of a record; raise struct.error if a part is missing."""
    number, schema = unpack_from("<HH", raw)
    topic, encoding = _strings(raw[4:], 2)
    metadata = _used(raw[4 + sum(4 + len(one) for one in (topic, encoding)) :])
    return number, McapChannel(schema, _text(topic), _text(encoding), metadata)


def _used(raw: bytes) -> tuple[tuple[str, str], ...]:
    """Return the used pairs of a map, or no pairs if it is damaged: messages can be read without it."""
    size = int.from_bytes(raw[:4], "little")
    pairs: list[tuple[str, str]] = []
    pos, end = 4, 4 + size
    while pos < end <= len(raw):
        try:
            name, value = values = _strings(raw[pos:end], 2)
        except error:
            return ()
        pairs.append((_text(name), _text(value)))
        pos += sum(4 + len(one) for one in values)
    return tuple(pair for pair in pairs if pair[0] in USED_METADATA)


def _strings(raw: bytes, count: int) -> list[bytes]:
    """Return the first strings of a record as bytes; raise struct.error if some are missing."""
    values: list[bytes] = []
    pos = 0
    for _ in range(count):
        (size,) = unpack_from("<I", raw, pos)
        values += unpack_from(f"{size}s", raw, pos + 4)
        pos += 4 + size
    return values


def _text(raw: bytes) -> str:
    return raw.decode("utf-8", errors="replace")
