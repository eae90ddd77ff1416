"""The segments of tracks, packed for a page in a file."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..widget.timed_frame import TimedFrame, table_of
from ._floats import folded_changes, pack_floats, planes

_LENGTH = struct.Struct("<I")
_COLUMN = 8

_SCALES = (10**6, 10**9)
"""Inverse steps of numbers with six decimals, and of times in seconds."""

_EXACT = 2.0**53
"""Whole numbers below this are exact as float64."""

ArraysOf = Callable[[bytes], tuple[int, int]]
"""`RobotWidget.arrays_of`."""


def segment(number: int, tracks: Iterable[tuple[Sequence[TimedFrame], ArraysOf]]) -> bytes:
    """Return a segment as text for the page: see docs/developers/frames.md.

    Args:
        number: the number of the segment.
        tracks: the frames of each widget, and its `RobotWidget.arrays_of`.
    """
    facts, parts = pack_tracks(tracks)
    # Noise takes much longer to compress at a high level, and gets no smaller.
    is_noise = any(not array["step"] for track in facts["tracks"] for array in track.get("floats", ()))
    return compressed({"segment": number, **facts}, parts, level=6 if is_noise else 9)


def compressed(facts: dict[str, Any], parts: Iterable[bytes], level: int = 9) -> bytes:
    """Return facts and bytes as text: the length of a JSON text, the JSON and the bytes, deflated, by `in_text`."""
    text = json.dumps(facts, separators=(",", ":"), allow_nan=False).encode()
    packer = zlib.compressobj(level, zlib.DEFLATED, 15, 9)
    packed = [packer.compress(part) for part in (_LENGTH.pack(len(text)), text, *parts)]
    return in_text(b"".join([*packed, packer.flush()]))


def in_text(data: bytes) -> bytes:
    """Return bytes as text that cannot end a script element: base85 with a comma for ``<``, 6 % smaller than base64."""
    return base64.b85encode(data).replace(b"<", b",")


def pack_tracks(tracks: Iterable[tuple[Sequence[TimedFrame], ArraysOf]]) -> tuple[dict[str, Any], list[bytes]]:
    """Return facts and parts from which the page restores the frames of tracks (js/export/tracks.ts)."""
    columns: dict[bytes, int] = {}
    facts: list[dict[str, Any]] = []
    parts: list[bytes] = []
    for frames, arrays_of in tracks:
        abouts, table = table_of(frames)
        whole = [timed.frame for timed in frames]
        size = sum(map(len, whole))
        times = _places(table.tobytes(), frames, columns)
        fact: dict[str, Any] = {"count": len(frames), "bytes": size, "abouts": abouts, "table": times}
        facts.append(fact)
        layouts = [arrays_of(frame) for frame in whole]
        heads, counts = {head for head, _ in layouts}, {count for _, count in layouts if count}
        if len(heads) == len(counts) == 1:
            head, count = heads.pop(), counts.pop()
            fact["columns"] = _places(b"".join(frame[:head] for frame in whole), frames, columns)
            arrays = [pack_floats(_array(whole, head, count, number)) for number in range(count)]
            fact["floats"] = [packed for packed, _ in arrays]
            parts += [part for _, packed in arrays for part in packed]
        elif len({len(frame) for frame in whole}) == 1 and size % (_COLUMN * len(frames)) == 0:
            fact["columns"] = _places(b"".join(whole), frames, columns)
        else:
            parts += whole
    shared = [_pack_column(np.frombuffer(column)) for column in columns]
    described = [[len(column) // _COLUMN, scale] for column, (scale, _) in zip(columns, shared, strict=True)]
    return {"columns": described, "tracks": facts}, [*(packed for _, packed in shared), *parts]


def _pack_column(values: NDArray[np.float64]) -> tuple[int, bytes]:
    """Return a scale that makes all numbers whole and the changes of these, or 0 and the bits; sorted by bytes.

    Times are whole nanoseconds, but float64 hides the pattern, and logs have numbers with few decimals.
    """
    for scale in _SCALES:
        with np.errstate(invalid="ignore", over="ignore"):
            whole = np.rint(values * scale)
        if np.all(np.abs(whole) < _EXACT) and np.array_equal(
            (whole.astype(np.int64) / scale).view("<u8"), values.view("<u8")
        ):
            return scale, planes(folded_changes(whole.astype(np.int64)))
    return 0, planes(values)


def _array(frames: Sequence[bytes], head: int, count: int, number: int) -> NDArray[np.float32]:
    """Return the arrays of one number in all frames, one after the other."""
    numbers = [np.frombuffer(frame, "<f4", offset=head) for frame in frames]
    return np.concatenate([of[number * (len(of) // count) : (number + 1) * (len(of) // count)] for of in numbers])


def _places(rows: bytes, frames: Sequence[TimedFrame], columns: dict[bytes, int]) -> list[int]:
    """Return the columns of the 8-byte numbers of rows, one row for each frame, and add missing columns.

    Many columns are equal: odometry has speeds and poses at the same times, speeds that were not commanded are the same
    in each row, and an extreme is often the value itself.
    """
    numbers = np.frombuffer(rows, "<u8").reshape(len(frames), -1).T
    return [columns.setdefault(column.tobytes(), len(columns)) for column in numbers]
