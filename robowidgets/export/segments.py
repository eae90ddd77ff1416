"""The segments of tracks, packed for the page that holds them."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core.timed_frame import TimedFrame, table_of
from ._floats import pack_floats, planes

_LENGTH = struct.Struct("<I")
_COLUMN = 8


ArraysOf = Callable[[bytes], tuple[int, int]]
"""`RobotWidget.arrays_of`."""


def segment(number: int, tracks: Iterable[tuple[Sequence[TimedFrame], ArraysOf]]) -> bytes:
    """One segment as text for the page: see docs/frames.md.

    Args:
        number: of the segment.
        tracks: for each widget its frames, and its `RobotWidget.arrays_of`.
    """
    facts: list[dict[str, Any]] = []
    parts: list[bytes] = []
    for frames, arrays_of in tracks:
        described, packed = pack_track(frames, arrays_of)
        facts.append(described)
        parts += packed
    # Noise takes long to pack as small as it gets, and gets no smaller.
    is_noise = any(not array["step"] for track in facts for array in track.get("floats", ()))
    return compressed({"segment": number, "tracks": facts}, parts, level=6 if is_noise else 9)


def compressed(facts: dict[str, Any], parts: Iterable[bytes], level: int = 9) -> bytes:
    """Facts and bytes as text: the length of a JSON text, that text, and the bytes, deflated, in `in_text`."""
    text = json.dumps(facts, separators=(",", ":"), allow_nan=False).encode()
    packer = zlib.compressobj(level, zlib.DEFLATED, 15, 9)
    packed = [packer.compress(part) for part in (_LENGTH.pack(len(text)), text, *parts)]
    return in_text(b"".join([*packed, packer.flush()]))


def in_text(data: bytes) -> bytes:
    """Bytes as text that ends no script element: base85 with a comma for ``<``, which takes 6 % less than base64."""
    return base64.b85encode(data).replace(b"<", b",")


def pack_track(frames: Sequence[TimedFrame], arrays_of: ArraysOf) -> tuple[dict[str, Any], list[bytes]]:
    """Facts and parts, of which the page makes the frames of a track again (js/export/tracks.ts)."""
    abouts, rows = table_of(frames)
    end = sum(len(timed.frame) for timed in frames)
    facts: dict[str, Any] = {"count": len(frames), "bytes": end, "abouts": abouts}
    parts = [planes(rows)]
    whole = [timed.frame for timed in frames]
    layouts = [arrays_of(frame) for frame in whole]
    heads, counts = {head for head, _ in layouts}, {count for _, count in layouts if count}
    if len(heads) == len(counts) == 1:
        head, count = heads.pop(), counts.pop()
        columns, start = _columns(b"".join(frame[:head] for frame in whole), len(frames))
        arrays = [pack_floats(_array(whole, head, count, number)) for number in range(count)]
        packed = [part for _, parts_of in arrays for part in parts_of]
        return {**facts, "columns": columns, "floats": [fact for fact, _ in arrays]}, [*parts, start, *packed]
    if len({len(frame) for frame in whole}) == 1 and end % (_COLUMN * len(frames)) == 0:
        columns, rows_of = _columns(b"".join(whole), len(frames))
        return {**facts, "columns": columns}, [*parts, rows_of]
    return facts, [*parts, *whole]


def _array(frames: Sequence[bytes], head: int, count: int, number: int) -> NDArray[np.float32]:
    """One of the arrays of all frames, one after the other."""
    numbers = [np.frombuffer(frame, "<f4", offset=head) for frame in frames]
    return np.concatenate([of[number * (len(of) // count) : (number + 1) * (len(of) // count)] for of in numbers])


def _columns(rows: bytes, count: int) -> tuple[list[int], bytes]:
    """Rows of 8-byte numbers by columns, each column once, its bytes sorted by their places; and which column is where.

    The page rarely needs all: what was not commanded is the same in each row, and an extreme is often the value itself.
    """
    numbers = np.frombuffer(rows, "<u8").reshape(count, -1).T
    kept: dict[bytes, int] = {}
    places = [kept.setdefault(column.tobytes(), len(kept)) for column in numbers]
    return places, b"".join(planes(np.frombuffer(column, "<u8")) for column in kept)
