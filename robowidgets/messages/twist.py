"""Encoding of Twist and TwistStamped, in a module without imports from robowidgets, so that a guard starts fast."""

from __future__ import annotations

from collections.abc import Mapping
from struct import Struct
from typing import Any

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"

_CDR = b"\x00\x01\x00\x00"
"""The header of little-endian CDR."""
_TWIST = Struct("<6d")
_STAMP = Struct("<iI")
_LENGTH = Struct("<I")


def encode_twist(encoding: str, message_type: str, message: Mapping[str, Any]) -> bytes:
    """Return the bytes of a Twist or TwistStamped in ``cdr`` or ``ros1`` from its fields; omitted fields are zero.

    `encoding.encode` writes every type, but takes a tenth of a second for its import and its first message.
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
    if encoding == "ros1":  # it begins with an unused number
        return _LENGTH.pack(0) + time + _LENGTH.pack(len(name)) + name
    head = time + _LENGTH.pack(len(name) + 1) + name + b"\x00"
    return head + bytes(-len(head) % 8)
