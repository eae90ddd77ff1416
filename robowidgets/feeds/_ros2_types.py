"""Types of ROS 2 on the wire: their names in DDS and Zenoh, their definitions, and the hashes of these (REP 2016)."""

from __future__ import annotations

import re
from contextlib import suppress
from functools import lru_cache
from typing import Any

from rosbags.typesys import Stores, get_typestore

from ..messages.channel import Channel
from ..messages.decoding import Decode, DecodeError, decoder_of, definition_of, store_of
from ..messages.definitions import added, version

_TYPE = re.compile(r"(\w+)::msg::dds_::(\w+)_")


def ros_type(name: str) -> str:
    """Return ``sensor_msgs/msg/LaserScan`` for ``sensor_msgs::msg::dds_::LaserScan_``, or empty if not a message."""
    found = _TYPE.fullmatch(name)
    return f"{found[1]}/msg/{found[2]}" if found else ""


def dds_type(type_name: str) -> str:
    """Return ``sensor_msgs::msg::dds_::LaserScan_`` for ``sensor_msgs/msg/LaserScan``."""
    package, _, name = type_name.partition("/msg/")
    return f"{package}::msg::dds_::{name}_"


def channel_of(type_name: str, definition: str) -> Channel:
    """Return a channel with messages of a type in CDR, for the functions of `messages.decoding`."""
    return Channel(0, "", type_name, "cdr", definition, 0)


def hash_of(type_name: str, definition: str = "") -> str:
    """Return the hash of a type by one of its definitions, as ``RIHS01_...``. Raise DecodeError for an unknown type."""
    return store_of(channel_of(type_name, definition)).hash_rihs01(type_name)


def decoder_for(type_name: str, definition: str = "") -> Decode:
    """Return a function that decodes messages by a definition of the type, or by another definition if that one fails.

    Raises:
        DecodeError: the type is unknown. The returned function raises it for bytes that are not such a message.
    """
    others = [decoder_of(channel_of(type_name, text)) for text in definitions_of(type_name) if text != definition]
    first = decoder_of(channel_of(type_name, definition))

    def decode(raw: bytes) -> Any:
        try:
            return first(raw)
        except DecodeError:
            for other in others:
                with suppress(DecodeError):
                    return other(raw)
            raise

    return decode if others else first


def definitions_of(type_name: str) -> tuple[str, ...]:
    """Return the definitions of a type as texts, best first. An empty text stands for the definition of `store_of`.

    A definition of the user is best, then the newest: ``sensor_msgs/Range``, for example, got the field ``variance``
    after Humble.
    """
    return _known_definitions(type_name, version())


@lru_cache
def _known_definitions(type_name: str, _version: int) -> tuple[str, ...]:
    newest = get_typestore(Stores.LATEST)
    # The user's definition is needed as a text, because the result for an empty text is cached forever.
    texts = [definition_of(channel_of(type_name, ""))] if added(type_name) else []
    texts += [newest.generate_msgdef(type_name, ros_version=2)[0]] if type_name in newest.fielddefs else []
    by_hash: dict[str, str] = {}
    for text in (*texts, ""):
        with suppress(DecodeError):
            by_hash[hash_of(type_name, text)] = text
    return tuple(by_hash.values())
