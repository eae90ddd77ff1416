"""Depth images compressed as RVL, which compressed_depth_image_transport sends with the format ``rvl``.

Source: A. D. Wilson, Fast Lossless Depth Image Compression, ISS 2017.
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

_SIZE = struct.Struct("<II")
_MOST_PIXELS = 1 << 26
_LONGEST = 11
"""Nibbles of a number: three bits in each make 33, more than any count of pixels or step of depth needs."""


def from_rvl(data: bytes) -> NDArray[np.uint16]:
    """Return the pixels of an image, shape (rows, columns).

    Args:
        data: columns and rows as uint32, and the words of the packed image.

    Raises:
        ValueError: the data is cut off or damaged.
    """
    if len(data) < _SIZE.size:
        raise ValueError(f"data: expected the size of an image in RVL, got {len(data)} bytes")
    columns, rows = _SIZE.unpack_from(data)
    count = columns * rows
    if not 0 < count <= _MOST_PIXELS:
        raise ValueError(f"the picture is empty or damaged: {rows:,} rows of {columns:,} pixels in RVL")
    numbers = _numbers(data[_SIZE.size :])
    pixels = np.zeros(count, np.int64)
    at = place = depth = 0
    while place < count:
        # The count of pixels without depth, the count of pixels with depth, and the depth step to each of the latter.
        empty, full = numbers[at : at + 2].tolist() if at + 2 <= len(numbers) else (0, 0)
        at += 2
        place += empty
        steps = numbers[at : at + full]
        if empty + full == 0 or place + full > count or len(steps) < full:
            raise ValueError(f"the picture is damaged or cut off: {place:,} of {count:,} pixels in RVL")
        if full:
            found = depth + np.cumsum((steps >> 1) ^ -(steps & 1))
            pixels[place : place + full] = found
            depth = int(found[-1])
        at, place = at + full, place + full
    if pixels.min() < 0 or pixels.max() > np.iinfo(np.uint16).max:
        raise ValueError("the picture is damaged: depths beyond 16 bits in RVL")
    return pixels.astype(np.uint16).reshape(rows, columns)


def _numbers(data: bytes) -> NDArray[np.int64]:
    """Return the numbers in words of 32 bits, which consist of nibbles, the highest nibble of a word first.

    A nibble has three bits of a number, the lowest bits first. Its fourth bit is set if the number goes on.
    """
    words = np.frombuffer(data[: len(data) // 4 * 4], "<u4").astype(">u4").view(np.uint8)
    nibbles = np.stack([words >> 4, words & 15], axis=1).ravel()
    ends = np.flatnonzero(nibbles < 8)
    if not ends.size:
        return np.empty(0, np.int64)
    starts = np.append(0, ends[:-1] + 1)
    nibbles = nibbles[: ends[-1] + 1].astype(np.int64)
    within = np.arange(len(nibbles)) - np.repeat(starts, ends - starts + 1)
    if within.max() >= _LONGEST:
        raise ValueError("the picture is damaged: a number without an end in RVL")
    return np.add.reduceat((nibbles & 7) << (3 * within), starts)
