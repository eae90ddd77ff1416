"""Twist and TwistStamped as bytes, by a module that imports nothing of robowidgets: a guard is to start soon."""

from __future__ import annotations

from collections.abc import Mapping
from struct import Struct
from typing import Any

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"

_CDR = b"\x00\x01\x00\x00"
"""Says that little-endian CDR follows."""
_TWIST = Struct("<6d")
_STAMP = Struct("<iI")
_LENGTH = Struct("<I")


def encode_twist(encoding: str, message_type: str, message: Mapping[str, Any]) -> bytes:
    """The bytes of a Twist or TwistStamped in ``cdr`` or ``ros1``, given as its fields; one that is left out is zero.

    `encoding.encode` writes every type, and takes a tenth of a second to be imported and to write its first message.
    """
    head = b""
    if message_type == TWIST_STAMPED:
        head, message = _header(encoding, message.get("header", {})), message.get("twist", {})
    parts = [message.get(name, {}) for name in ("linear", "angular")]
    body = head + _TWIST.pack(*(part.get(axis, 0.0) for part in parts for axis in "xyz"))
    return _CDR + body if encoding == "cdr" else body


def _header(encoding: str, header: Mapping[str, Any]) -> bytes:
    stamp, name = header.get("stamp", {}), str(header.get("frame_id", "")).encode()
    time = _STAMP.pack(stamp.get("sec", 0), stamp.get("nanosec", 0))
    if encoding == "ros1":  # it begins with a number that nobody uses
        return _LENGTH.pack(0) + time + _LENGTH.pack(len(name)) + name
    head = time + _LENGTH.pack(len(name) + 1) + name + b"\x00"
    return head + bytes(-len(head) % 8)
