"""The fast path from bytes to columns: most messages repeat the previous one with other numbers at the same offsets.

A message that was read in full is the template for later ones. If a later message has the same length and differs only
in times and numbers, its numbers are copied from these offsets. Any other message is read in full.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from struct import Struct
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...messages.layout import Layout, Rows
from ...messages.scan import LONGEST_SCAN
from ...samples import Scan, Speed

_SIX = Struct("<6d")
_TWIST = [f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"]
_POSE = [*(f"position.{axis}" for axis in "xyz"), *(f"orientation.{axis}" for axis in "xyzw")]


class MessageTemplate(NamedTuple):
    """The offsets in the last message that was read in full. Later messages may share them.

    ``size``: bytes of the message. ``fixed``: the offsets of the parts that must be equal, and their bytes. ``parts``:
    the offsets of the numbers to copy, by name, without the parts that the message does not have. ``sample``: the
    sample in the message.
    """

    size: int
    fixed: list[tuple[slice, NDArray[np.uint8]]]
    parts: Mapping[str, slice]
    sample: Any

    def count_alike(self, rows: Rows) -> int:
        """Return the number of rows, from the first one on, that differ from the template only in their numbers."""
        same = np.ones(len(rows), bool)
        for part, expected in self.fixed:
            same &= (rows[:, part] == expected).all(axis=1)
        times = self.cut(rows, "times", "<f4")  # they may change within the limits of real scanners
        same &= ((times >= 0) & (times <= LONGEST_SCAN)).all(axis=1)
        return len(rows) if same.all() else int(same.argmin())

    def cut(self, rows: Rows, name: str, dtype: str) -> NDArray[Any]:
        """Return the numbers in one part of all rows as a view, or shape (N, 0) without the part."""
        return rows[:, self.parts[name]].view(dtype) if name in self.parts else np.empty((len(rows), 0), dtype)

    def stamps(self, rows: Rows) -> NDArray[np.int64]:
        """Return the stamps of all rows in nanoseconds, 0 if the message has none."""
        if "stamp" not in self.parts:
            return np.zeros(len(rows), np.int64)
        seconds, nanoseconds = self.cut(rows, "stamp", "<i4")[:, 0], self.cut(rows, "stamp", "<u4")[:, 1]
        stamps: NDArray[np.int64] = seconds.astype(np.int64) * 1_000_000_000 + nanoseconds
        return stamps


def scan_template(raw: bytes, scan: Scan, layout: Layout) -> MessageTemplate | None:
    """Return the template of a LaserScan-like message, or None if its numbers have no fixed offsets."""
    times = layout.span("float32", "time_increment", "scan_time")
    if times and not all(0 <= time <= LONGEST_SCAN for time in np.frombuffer(raw[times], "<f4")):
        times = None
    parts = {"times": times, "stamp": layout.span("time", "header.stamp"), "ranges": layout.span("float32", "ranges")}
    needed = ["stamp", "ranges"]
    if len(scan.intensities):
        parts["intensities"] = layout.span("float32", "intensities")
        needed.append("intensities")
    return _template(raw, scan, layout, parts, needed)


def speed_template(raw: bytes, speed: Speed, layout: Layout) -> MessageTemplate | None:
    """Return the template of a Twist or Odometry-like message, or None if its numbers have no fixed offsets."""
    parts = {"stamp": layout.span("time", "header.stamp"), "twist": _within(layout, "twist", _TWIST)}
    if speed.pose:
        parts["pose"] = _within(layout, "pose", _POSE)
    if parts["twist"] and raw[parts["twist"]] != _SIX.pack(*speed.values):
        return None
    unread = [layout.span(type_name, name) for name, type_name in layout.fields if type_name == "float64"]
    return _template(raw, speed, layout, parts, parts.keys() - {"stamp"}, unread)


def _template(
    raw: bytes,
    sample: Any,
    layout: Layout,
    parts: Mapping[str, slice | None],
    needed: Iterable[str],
    unread: Iterable[slice | None] = (),
) -> MessageTemplate | None:
    """Return a template, or None for a big-endian message or without a needed part. Bytes ``unread`` may change too."""
    if layout.is_big_endian or not all(parts[name] for name in needed):
        return None
    is_fixed = np.ones(len(raw), bool)
    for part in (*parts.values(), layout.span("uint32", "header.seq"), *unread):
        if part:
            is_fixed[part] = False
    edges = np.flatnonzero(np.diff(is_fixed, prepend=False, append=False)).reshape(-1, 2).tolist()
    fixed = [(slice(*pair), np.frombuffer(raw[slice(*pair)], np.uint8)) for pair in edges]
    return MessageTemplate(len(raw), fixed, {name: part for name, part in parts.items() if part}, sample)


def _within(layout: Layout, part: str, names: Iterable[str]) -> slice | None:
    """Return the offsets of the numbers in a part (``twist.twist.linear.x`` ...), or None if not consecutive."""
    prefixes = (f"{part}.{part}.", f"{part}.", "")
    return next(filter(None, (layout.span("float64", *(before + name for name in names)) for before in prefixes)), None)
