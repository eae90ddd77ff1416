"""The messages between a kernel and its guard, in frames with a length and a checksum."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from struct import Struct
from typing import Any
from zlib import crc32

_HEAD = Struct(">II")
_encode = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode  # `json.dumps` would make one per call

LARGEST = 60_000
"""The size of the largest message, in bytes."""

TO_GUARD: dict[str, tuple[Any, ...]] = {
    "open": (str, dict),
    "beat": (),
    "drive": (int, int, str, list, float, float, int, list),
    "zero": (int, int, str, list),
    "again": (),
    "close": (int,),
}
"""The messages to a guard by name, with the types of their parts.

- ``open``: name of the middleware, its arguments.
- ``beat``: the kernel is alive.
- ``drive``: feed, number, topic, speed, the monotonic time at which the speed expires, the time at which it was sent by
  a clock that continues while the computer sleeps, the number of stops of the guard that the kernel knows, adverts of
  the topic.
- ``zero``: feed, number, topic, adverts of the topic.
- ``again``: the robot can be reached; the guard must not wait for the next attempt.
- ``close``: a feed that sends nothing any more.
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
"""The messages from a guard by name, with the types of their parts.

- ``ready``: the process is ready. ``failed``: it cannot work; the reason.
- ``up``: the robot can be reached. ``down``: it cannot; the reason, and seconds until the next attempt.
- ``unheard``: topic, and the reason why a subscriber does not receive it.
- ``slow``: the robot took long for one message of a speed, which may consist of several. The kernel waits for each.
- ``done``: feed, number, class and text of the error or empty, subscribers that refused it, types in which it was sent.
- ``stopped``: number of stops, seconds for which the kernel was silent, text for a standstill of the guard itself or
  empty.
"""


class DamagedError(Exception):
    """Bytes that are not a valid message. The text gives the reason."""


def packed(name: str, *parts: Any) -> bytes:
    """Return the frame of a message."""
    text = _encode([name, *parts]).encode()
    if len(text) > LARGEST:
        raise ValueError(f"a message of {len(text)} bytes is too large for a guard")
    return _HEAD.pack(len(text), crc32(text)) + text


class Unpacker:
    """A decoder of the messages in a stream of bytes.

    Args:
        known: the valid messages, as `TO_GUARD`.
    """

    def __init__(self, known: dict[str, tuple[Any, ...]]) -> None:
        self._known = known
        self._rest = b""

    def take(self, data: bytes) -> Iterator[tuple[str, Sequence[Any]]]:
        """Yield the name and parts of each message that is complete with these bytes.

        Raises:
            DamagedError: the bytes are not a message. The bytes after them cannot be read either.
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
    """Return True if a part has a type. A whole number is valid for a float, because JSON may write it so."""
    return isinstance(part, (float, int) if kind is float else kind) and not isinstance(part, bool)
