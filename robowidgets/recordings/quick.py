"""Samples from bytes, quickly: most messages of a topic are the one before with other numbers in the same places.

So a message is read in full once. A later one that is as long, and the same wherever nothing but a time or a number may
stand, gives its numbers straight from their places; any other is read in full again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from struct import Struct
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..messages import to_scan, to_speed
from ..messages.fields import Shape
from ..repair._inflate import plain
from ..samples import Scan, Speed

Decode = Callable[[bytes], Any]

# In CDR a stamp at the start follows the four bytes of encapsulation, in ROS 1 the four of `seq`.
_STAMP = Struct("<iI")
_STAMP_AT, _STAMP_END = 4, 12
_SIX = Struct("<6d")
_FLOAT = np.dtype("<f4")


class Alike(NamedTuple):
    """What later messages share with the one that was read in full last.

    ``size``: bytes of the message. ``fixed``: the parts that are the same, and what stands there. ``numbers``: where
    the ranges lie, or the six numbers of a twist. ``more``: where intensities lie, if there are any. ``stamped``:
    whether it starts with a header. ``sample``: what the message was.
    """

    size: int
    fixed: tuple[tuple[slice, bytes], ...]
    numbers: slice
    more: slice | None
    stamped: bool
    sample: Any


class ScanReader:
    """Makes scans of the bytes of one channel of LaserScan-like messages."""

    def __init__(self, decode: Decode, shape: Shape, encoding: str) -> None:
        self._decode = decode
        self._lead = slice(0, 4 if encoding == "cdr" else 0)
        self._stamped = _is_stamped(shape)
        self._like: Scan | None = None
        self._size = 0
        self._fixed: tuple[tuple[slice, bytes], ...] = ()
        self._ranges = (0, 0)
        self._intensities: tuple[int, int] | None = None

    def __call__(self, raw: bytes) -> Scan:
        """The scan in a message. Raises as the decoder and `to_scan` do."""
        if self._like is not None and len(raw) == self._size:
            for part, expected in self._fixed:
                if raw[part] != expected:
                    break
            else:
                intensities = np.frombuffer(raw, _FLOAT, *self._intensities) if self._intensities else None
                ranges = np.frombuffer(raw, _FLOAT, *self._ranges)
                return self._like.again(ranges, intensities, _stamp_ns(raw), keep=True)
        raw = plain(raw)
        message = self._decode(raw)
        scan = to_scan(message)
        self._learn(raw, message, scan)
        return scan

    @property
    def alike(self) -> Alike | None:
        """What the message that was read in full last has to share with others; None when it has no fixed places."""
        if self._like is None:
            return None
        more = _bytes(*self._intensities) if self._intensities else None
        return Alike(self._size, self._fixed, _bytes(*self._ranges), more, True, self._like)

    def _learn(self, raw: bytes, message: Any, scan: Scan) -> None:
        self._like = None
        first = _place(raw, message.ranges)
        second = _place(raw, message.intensities) if len(scan.intensities) else None
        if not self._stamped or first is None or (second is None and len(scan.intensities)):
            return
        (_, start), end = first, first[1] + 4 * first[0]
        parts = [self._lead, slice(_STAMP_END, start)]
        parts += [slice(end, second[1]), slice(second[1] + 4 * second[0], None)] if second else [slice(end, None)]
        self._like, self._size = scan, len(raw)
        self._fixed = tuple((part, raw[part]) for part in parts if raw[part])
        self._ranges, self._intensities = first, second


class SpeedReader:
    """Makes speeds of the bytes of one channel of Twist or Odometry-like messages."""

    def __init__(self, decode: Decode, shape: Shape, encoding: str) -> None:
        self._decode = decode
        self._lead = 4 if encoding == "cdr" else 0
        self._stamped = _is_stamped(shape)
        self._doubles = _doubles(shape)
        self._like: Speed | None = None
        self._size = 0
        self._fixed: tuple[tuple[slice, bytes], ...] = ()
        self._at = 0

    def __call__(self, raw: bytes) -> Speed:
        """The speed in a message. Raises as the decoder and `to_speed` do."""
        if self._like is not None and len(raw) == self._size:
            for part, expected in self._fixed:
                if raw[part] != expected:
                    break
            else:
                six = _SIX.unpack_from(raw, self._at)
                return Speed(six[:3], six[3:], _stamp_ns(raw) if self._stamped else None, self._like.frame_id)
        raw = plain(raw)
        speed = to_speed(self._decode(raw))
        self._learn(raw, speed)
        return speed

    @property
    def alike(self) -> Alike | None:
        """See `ScanReader.alike`."""
        if self._like is None:
            return None
        return Alike(self._size, self._fixed, slice(self._at, self._at + _SIX.size), None, self._stamped, self._like)

    def _learn(self, raw: bytes, speed: Speed) -> None:
        self._like = None
        if self._doubles is None:
            return
        before, all_of_them = self._doubles
        tail = len(raw) - 8 * all_of_them
        start = _STAMP_END if self._stamped else self._lead
        at = tail + 8 * before
        if tail < start or (self._lead and (tail - self._lead) % 8) or raw[at : at + 48] != _SIX.pack(*speed.values):
            return
        self._like, self._size, self._at = speed, len(raw), at
        parts = (slice(0, self._lead), slice(start, tail))
        self._fixed = tuple((part, raw[part]) for part in parts if raw[part])


def _bytes(count: int, offset: int) -> slice:
    return slice(offset, offset + _FLOAT.itemsize * count)


def _stamp_ns(raw: bytes) -> int | None:
    seconds, nanoseconds = _STAMP.unpack_from(raw, _STAMP_AT)
    return (seconds * 1_000_000_000 + nanoseconds) or None


def _is_stamped(shape: Shape) -> bool:
    """Whether the message starts with a header, so that its stamp is where we look for it."""
    first = next(iter(shape), "")
    header = shape.get(first)
    return (
        first == "header" and isinstance(header, Mapping) and [n for n in header if n != "seq"] == ["stamp", "frame_id"]
    )


def _place(raw: bytes, array: NDArray[Any]) -> tuple[int, int] | None:
    """Count and offset of an array within the bytes it was read from; None when it is not a view of them."""
    if array.dtype is not _FLOAT or not array.size:
        return None
    offset = _address(array) - _address(np.frombuffer(raw, np.uint8))
    return (array.size, offset) if 0 <= offset <= len(raw) - array.nbytes else None


def _address(array: NDArray[Any]) -> int:
    return int(array.__array_interface__["data"][0])


def _doubles(shape: Shape) -> tuple[int, int] | None:
    """Of the float64 values that end a message: how many come before the six of its twist, and how many there are."""
    names: list[str] = []
    for name, kind in reversed(list(_leaves(shape))):
        base, _, count = str(kind).rstrip("]").partition("[")
        if base != "float64" or str(kind).endswith("[]"):
            break
        names[:0] = [name] * int(count or 1)
    prefix = ""
    twist: Any = shape
    while isinstance(twist, Mapping) and "linear" not in twist:
        prefix, twist = f"{prefix}twist.", twist.get("twist")
    six = [f"{prefix}{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"]
    if six[0] not in names:
        return None
    before = names.index(six[0])
    return (before, len(names)) if names[before : before + 6] == six else None


def _leaves(shape: Shape, prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, kind in shape.items():
        if isinstance(kind, Mapping):
            yield from _leaves(kind, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", kind
