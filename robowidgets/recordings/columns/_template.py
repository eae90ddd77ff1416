"""The fast path from bytes to columns: most messages repeat the previous one with other numbers at the same offsets.

A message that was read in full is the template for later ones. If a later message has the same length and differs only
in times and numbers, its numbers are copied from these offsets. Any other message is read in full.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from struct import Struct
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...messages.fields import MessageShape
from ...messages.scan import LONGEST_SCAN
from ...samples import Scan, Speed

Rows = NDArray[np.uint8]
"""Messages of one size as rows, shape (N, size)."""

# In CDR a stamp at the start follows the four bytes of encapsulation, in ROS 1 the four of `seq`.
_STAMP = np.dtype([("seconds", "<i4"), ("nanoseconds", "<u4")])
_STAMP_AT, _STAMP_END = 4, 12
_SIX = Struct("<6d")
_POSE = [*(f"position.{axis}" for axis in "xyz"), *(f"orientation.{axis}" for axis in "xyzw")]
_FLOAT = np.dtype("<f4")
_SETTINGS = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")
# The ranges follow their count; in a LaserScan range_max, range_min and the two times come before it, last to first.
_TIMES_START, _TIMES_END = 20, 12


class MessageTemplate(NamedTuple):
    """The layout of the last message that was read in full. Later messages may share it.

    ``size``: bytes of the message. ``fixed``: the offsets of the parts that must be equal, and their bytes. ``times``:
    the offsets of time_increment and scan_time, which may change within the limits of real scanners. ``numbers``: the
    offsets of the ranges, or of the six numbers of a twist. ``more``: the offsets of the intensities, or of the seven
    numbers of a pose, if there are any. ``is_stamped``: True if the message starts with a header. ``sample``: the
    sample in the message.
    """

    size: int
    fixed: tuple[tuple[slice, NDArray[np.uint8]], ...]
    times: slice | None
    numbers: slice
    more: slice | None
    is_stamped: bool
    sample: Any

    def count_alike(self, rows: Rows) -> int:
        """Return the number of rows, from the first one on, that differ from the template only in their numbers."""
        same = np.ones(len(rows), bool)
        for part, expected in self.fixed:
            same &= (rows[:, part] == expected).all(axis=1)
        if self.times:
            times = self.cut(rows, self.times, _FLOAT)
            same &= ((times >= 0) & (times <= LONGEST_SCAN)).all(axis=1)
        return len(rows) if same.all() else int(same.argmin())

    def cut(self, rows: Rows, part: slice | None, kind: np.dtype[Any]) -> NDArray[Any]:
        """Return the numbers in one part of all rows as a view, or shape (N, 0) without a part."""
        return rows[:, part].view(kind) if part else np.empty((len(rows), 0), kind)

    def stamps(self, rows: Rows) -> NDArray[np.int64]:
        """Return the stamps of all rows in nanoseconds, 0 if the message has none."""
        if not self.is_stamped:
            return np.zeros(len(rows), np.int64)
        stamps = np.ascontiguousarray(rows[:, _STAMP_AT:_STAMP_END]).view(_STAMP)[:, 0]
        nanoseconds: NDArray[np.int64] = stamps["seconds"].astype(np.int64) * 1_000_000_000 + stamps["nanoseconds"]
        return nanoseconds


def scan_template(raw: bytes, message: Any, scan: Scan, shape: MessageShape, encoding: str) -> MessageTemplate | None:
    """Return the template of a LaserScan-like message, or None if its numbers have no fixed offsets."""
    if scan.echoes:
        return None
    ranges = _place(raw, message.ranges)
    intensities = _place(raw, message.intensities) if len(scan.intensities) else None
    if not _is_stamped(shape) or ranges is None or (intensities is None and len(scan.intensities)):
        return None
    names = list(shape)
    has_times = names[1 : names.index("ranges")] == list(_SETTINGS) and all(
        0 <= time <= LONGEST_SCAN for time in (message.time_increment, message.scan_time)
    )
    times = slice(ranges.start - _TIMES_START, ranges.start - _TIMES_END) if has_times else None
    gaps = sorted((part.start, part.stop) for part in (times, ranges, intensities) if part)
    edges = [_STAMP_END, *(edge for gap in gaps for edge in gap), len(raw)]
    fixed = [_lead(encoding), *(slice(*pair) for pair in zip(edges[::2], edges[1::2], strict=True))]
    return MessageTemplate(len(raw), _parts(raw, fixed), times, ranges, intensities, True, scan)


def speed_template(raw: bytes, speed: Speed, shape: MessageShape, encoding: str) -> MessageTemplate | None:
    """Return the template of a Twist or Odometry-like message, or None if its numbers have no fixed offsets."""
    names = _doubles(shape)
    is_stamped, lead = _is_stamped(shape), _lead(encoding)
    tail = len(raw) - 8 * len(names)
    start = _STAMP_END if is_stamped else lead.stop
    six = _run(names, "twist", [f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"], tail)
    pose = _run(names, "pose", _POSE, tail) if speed.pose else None
    if tail < start or (lead.stop and (tail - lead.stop) % 8) or six is None or (speed.pose and pose is None):
        return None
    if raw[six] != _SIX.pack(*speed.values):
        return None
    return MessageTemplate(len(raw), _parts(raw, [lead, slice(start, tail)]), None, six, pose, is_stamped, speed)


def _lead(encoding: str) -> slice:
    return slice(0, 4 if encoding == "cdr" else 0)


def _parts(raw: bytes, parts: list[slice]) -> tuple[tuple[slice, NDArray[np.uint8]], ...]:
    return tuple((part, np.frombuffer(raw[part], np.uint8)) for part in parts if raw[part])


def _is_stamped(shape: MessageShape) -> bool:
    """Return True if the message starts with a header, so that its stamp has a fixed offset."""
    first = next(iter(shape), "")
    header = shape.get(first)
    names = [name for name in header if name != "seq"] if isinstance(header, Mapping) else []
    return first == "header" and names == ["stamp", "frame_id"]


def _place(raw: bytes, array: NDArray[Any]) -> slice | None:
    """Return the offsets of an array in the bytes from which it was read, or None if it is not a view of them."""
    if array.dtype is not _FLOAT or not array.size:
        return None
    start = _address(array) - _address(np.frombuffer(raw, np.uint8))
    return slice(start, start + array.nbytes) if 0 <= start <= len(raw) - array.nbytes else None


def _address(array: NDArray[Any]) -> int:
    return int(array.__array_interface__["data"][0])


def _doubles(shape: MessageShape) -> list[str]:
    """Return the names of the float64 values at the end of a message, in their order."""
    names: list[str] = []
    for name, kind in reversed(list(_leaves(shape))):
        base, _, count = str(kind).rstrip("]").partition("[")
        if base != "float64" or str(kind).endswith("[]"):
            break
        names[:0] = [name] * int(count or 1)
    return names


def _run(names: Sequence[str], part: str, inner: Sequence[str], tail: int) -> slice | None:
    """Return the offsets of a part's numbers (``twist.twist.linear.x`` ...), or None if they are not consecutive."""
    for prefix in (f"{part}.{part}.", f"{part}.", ""):
        if f"{prefix}{inner[0]}" in names:
            before = names.index(f"{prefix}{inner[0]}")
            is_run = [*names[before : before + len(inner)]] == [f"{prefix}{name}" for name in inner]
            return slice(tail + 8 * before, tail + 8 * (before + len(inner))) if is_run else None
    return None


def _leaves(shape: MessageShape, prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, kind in shape.items():
        if isinstance(kind, Mapping):
            yield from _leaves(kind, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", kind
