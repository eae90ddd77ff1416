"""Frames of a rosbridge server: JSON text, or CBOR with typed arrays.

The topic of a message is at the start of its frame, so it is read without decoding the rest.
"""

from __future__ import annotations

import json
import re
from typing import Any

from ._bridge import UnreadableError
from ._websocket import Frame, one_line

_TEXT_START = re.compile(r'\s*\{\s*"op"\s*:\s*"publish"\s*,\s*"topic"\s*:\s*("(?:[^"\\]|\\.){0,500}")')
_CBOR_START = re.compile(rb"\xa3\x62op\x67publish\x65topic([\x60-\x77]|\x78.|\x79..)", re.DOTALL)

# Typed arrays by their tags: https://www.rfc-editor.org/rfc/rfc8746
_ARRAYS = {69: "<u2", 70: "<u4", 71: "<u8", 72: "i1", 77: "<i2", 78: "<i4", 79: "<i8", 85: "<f4", 86: "<f8"}


def topic_of(frame: Frame) -> str | None:
    """Return the topic of a message in the usual layout of servers, or None if the frame must be decoded to know it."""
    if isinstance(frame, str):
        start = _TEXT_START.match(frame)
        return _text(start[1]) if start else None
    head = _CBOR_START.match(frame)
    if head is None:
        return None
    size = head[1][0] - 0x60 if len(head[1]) == 1 else int.from_bytes(head[1][1:], "big")
    try:
        return frame[head.end() : head.end() + size].decode()
    except UnicodeDecodeError:
        return None


def read(frame: Frame) -> dict[str, Any]:
    """Return the operation in a frame. Raise UnreadableError if it contains none."""
    try:
        operation = json.loads(frame) if isinstance(frame, str) else _from_cbor(frame)
    except UnreadableError:
        raise
    except Exception as error:  # cbor2 raises errors of many classes for malformed CBOR
        kind = "JSON" if isinstance(frame, str) else "CBOR"
        raise UnreadableError(f"{len(frame)} bytes came that are not {kind}: {one_line(str(error))}") from None
    if not isinstance(operation, dict):
        raise UnreadableError(f"expected a rosbridge message, got {one_line(repr(operation)[:80])}")
    return operation


def has_cbor() -> bool:
    """Return True if cbor2 is installed."""
    try:
        import cbor2  # noqa: F401
    except ImportError:
        return False
    return True


def _text(quoted: str) -> str | None:
    try:
        return str(json.loads(quoted))
    except ValueError:
        return None


def _from_cbor(frame: bytes) -> Any:
    try:
        from cbor2 import CBORTag, loads
    except ImportError:
        raise UnreadableError("unrequested binary data came, and reading it needs cbor2") from None
    import numpy as np  # Imported lazily: a guard reads no topic.

    def array(*given: Any) -> Any:
        # The position of the tag among the arguments depends on the version of cbor2.
        tag = next(one for one in given if isinstance(one, CBORTag))
        kind = _ARRAYS.get(tag.tag)
        return np.frombuffer(tag.value, kind) if kind and isinstance(tag.value, bytes) else tag

    return loads(frame, tag_hook=array)
