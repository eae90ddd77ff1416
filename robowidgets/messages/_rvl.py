"""Depth images that are packed as RVL, as compressed_depth_image_transport sends them with the format ``rvl``.

Source: A. D. Wilson, Fast Lossless Depth Image Compression, ISS 2017.
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

_SIZE = struct.Struct("<II")
_MOST_PIXELS = 1 << 26
_LONGEST = 11
"""Nibbles of a number: three bits in each make 33, more than any number of pixels or step of depth takes."""


def from_rvl(data: bytes) -> NDArray[np.uint16]:
    """Return the pixels of an image, shape (rows, columns).

    Args:
        data: columns and rows as uint32, and the words of the packed image.

    Raises:
        ValueError: they are cut off or damaged.
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
        # Pixels without depth, pixels with one, and the steps from each of these to the next.
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
    """Return the numbers in some words of 32 bits: nibbles, the highest first, with three bits each, the lowest first.

    The fourth bit of a nibble says that the number goes on.
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
