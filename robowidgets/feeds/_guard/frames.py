"""What goes between a kernel and its guard: messages in frames with a length and a checksum."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from struct import Struct
from typing import Any
from zlib import crc32

_HEAD = Struct(">II")
_encode = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode  # `json.dumps` makes one for each call

LARGEST = 60_000
"""Bytes of the largest message."""

TO_GUARD: dict[str, tuple[Any, ...]] = {
    "open": (str, dict),
    "beat": (),
    "drive": (int, int, str, list, float, float, int, list),
    "zero": (int, int, str, list),
    "again": (),
    "close": (int,),
}
"""By the name of a message to a guard: the types of its parts.

- ``open``: middleware, what to make it of.
- ``beat``: the kernel is alive.
- ``drive``: feed, number, topic, speed, the monotonic time at which it expires, the time at which it was sent by a
  clock that goes on while the computer sleeps, count of stops of the guard that the kernel knows of, adverts of the
  topic.
- ``zero``: feed, number, topic, adverts of the topic.
- ``again``: the robot can be reached; a pause before the next attempt is over.
- ``close``: a feed that sends no more.
"""

FROM_GUARD: dict[str, tuple[Any, ...]] = {
    "ready": (),
    "failed": (str,),
    "up": (),
    "down": (str, float),
    "unheard": (str, str),
    "slow": (),
    "done": (int, int, str, str, str, list),
    "stopped": (int, float, str),
}
"""By the name of a message from a guard: the types of its parts.

- ``ready``: it is there. ``failed``: it cannot work, and why.
- ``up``, ``down``: the robot can be reached, or not: why, and seconds until the next attempt.
- ``unheard``: topic, and why a subscriber does not receive it.
- ``slow``: the robot took long for one message of a speed, which may have others; each is waited for for a while.
- ``done``: feed, number, class and text of the error or empty, for whom it was refused, types in which it was sent.
- ``stopped``: count of its stops, seconds for which the kernel was silent, text for a standstill of the guard itself or
  empty.
"""


class DamagedError(Exception):
    """Bytes that are no message; the text says why."""


def packed(name: str, *parts: Any) -> bytes:
    """The frame of a message."""
    text = _encode([name, *parts]).encode()
    if len(text) > LARGEST:
        raise ValueError(f"a message of {len(text)} bytes is too large for a guard")
    return _HEAD.pack(len(text), crc32(text)) + text


class Unpacker:
    """Finds the messages in what came.

    Args:
        known: the messages that may come, as `TO_GUARD`.
    """

    def __init__(self, known: dict[str, tuple[Any, ...]]) -> None:
        self._known = known
        self._rest = b""

    def take(self, data: bytes) -> Iterator[tuple[str, Sequence[Any]]]:
        """The messages that are complete with these bytes: their names and parts.

        Raises:
            DamagedError: the bytes are no message. What follows them cannot be read either.
        """
        self._rest += data
        while len(self._rest) >= _HEAD.size:
            length, checksum = _HEAD.unpack_from(self._rest)
            if length > LARGEST:
                raise DamagedError(f"a message of {length} bytes was announced")
            end = _HEAD.size + length
            if len(self._rest) < end:
                return
            text, self._rest = self._rest[_HEAD.size : end], self._rest[end:]
            if crc32(text) != checksum:
                raise DamagedError("a message does not fit its checksum")
            yield self._message(text)

    def _message(self, text: bytes) -> tuple[str, Sequence[Any]]:
        try:
            name, *parts = json.loads(text)
            types = self._known[name]
        except (ValueError, TypeError, KeyError):
            raise DamagedError(f"a message is not known: {text[:80]!r}") from None
        if len(parts) != len(types) or not all(map(_is, parts, types)):
            raise DamagedError(f"a message has the wrong parts: {text[:80]!r}")
        return name, parts


def _is(part: Any, kind: type) -> bool:
    """Whether a part has a type; JSON has whole numbers for some others."""
    return isinstance(part, (float, int) if kind is float else kind) and not isinstance(part, bool)
