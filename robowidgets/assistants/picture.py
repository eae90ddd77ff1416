"""Pictures for assistants, as PNG: a scan from above, drawn from its numbers, and the pixels of a camera."""

from __future__ import annotations

import struct
import zlib
from math import ceil, floor, log10
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..image.packing import as_numbers
from ..samples import Image, Scan, Validity
from .answer import AnswerError

Pixels = NDArray[np.uint8]

SIDE = 640
"""Rows and columns of the picture of a scan."""

MAX_PIXELS = 640 * 480
"""The most pixels of a picture of a camera. A larger one is thinned: every second row and column, and so on."""

MAX_PNG = 1_500_000
"""The most bytes of a PNG."""

_MARGIN = 24
_WHITE, _GRAY, _LABEL, _BLACK, _RED, _BLUE = (
    (255, 255, 255), (222, 222, 222), (120, 120, 120), (20, 20, 20), (208, 32, 32), (40, 90, 200),
)  # fmt: skip
_GLYPHS = {
    "0": (7, 5, 5, 5, 7), "1": (2, 6, 2, 2, 7), "2": (7, 1, 7, 4, 7), "3": (7, 1, 7, 1, 7), "4": (5, 5, 7, 1, 1),
    "5": (7, 4, 7, 1, 7), "6": (7, 4, 7, 5, 7), "7": (7, 1, 2, 2, 2), "8": (7, 5, 7, 5, 7), "9": (7, 5, 7, 1, 7),
    ".": (0, 0, 0, 0, 2), "m": (0, 7, 7, 5, 5), " ": (0, 0, 0, 0, 0),
}  # fmt: skip
"""Rows of three bits."""


def png(pixels: NDArray[Any]) -> bytes:
    """Return a PNG of 8 or 16 bits: gray of shape (rows, columns), or colours of shape (rows, columns, 3 or 4).

    It keeps every pixel exactly.
    """
    rows, columns = pixels.shape[:2]
    bits = 8 * pixels.dtype.itemsize
    kind = 0 if pixels.ndim == 2 else {3: 2, 4: 6}[pixels.shape[2]]
    lines = pixels.astype(pixels.dtype.newbyteorder(">")).reshape(rows, -1).view(np.uint8)
    raw = np.hstack([np.zeros((rows, 1), np.uint8), lines]).tobytes()
    head = struct.pack(">IIBBBBB", columns, rows, bits, kind, 0, 0, 0)
    parts = ((b"IHDR", head), (b"IDAT", zlib.compress(raw, 6)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in parts
    )


def picture_of(sample: Any) -> tuple[bytes, str]:
    """Return a PNG of a sample, and a text that says how it was made.

    Raises:
        AnswerError: it is neither a scan nor a picture, or has nothing to draw.
    """
    if isinstance(sample, Scan):
        return of_scan(sample)
    if isinstance(sample, Image):
        return of_image(sample)
    raise AnswerError(
        "picture: expected a topic of scans or of camera pictures; ask `at` for the numbers of any other, and the user "
        "for the page, which shows all widgets"
    )


def of_scan(scan: Scan) -> tuple[bytes, str]:
    """Draw a scan from above, forward up: a point for each reading, and a line to the nearest one."""
    is_reading = scan.validity == Validity.READING
    x, y = np.asarray(scan.x)[is_reading], np.asarray(scan.y)[is_reading]
    if not len(x):
        raise AnswerError("picture: no ray of this scan has a reading, so there is nothing to draw")
    reach = max(float(np.hypot(x, y).max()), 0.1)
    scale = (SIDE / 2 - _MARGIN) / reach
    canvas = np.full((SIDE, SIDE, 3), _WHITE, np.uint8)
    step = _nice(reach / 3)
    for number in range(1, floor(reach / step + 1e-9) + 1):
        _ring(canvas, number * step * scale)
        _write(canvas, round(SIDE / 2 - number * step * scale) + 3, SIDE // 2 + 4, f"{number * step:g} m")
    nearest = scan.nearest()
    if nearest is not None and nearest.x is not None and nearest.y is not None:
        _line(canvas, nearest.x * scale, nearest.y * scale, _RED)
    _points(canvas, x * scale, y * scale, 1, _BLACK)
    if nearest is not None and nearest.x is not None and nearest.y is not None:
        _points(canvas, np.array([nearest.x * scale]), np.array([nearest.y * scale]), 3, _RED)
    for ahead in np.arange(-8, 9, 0.5):  # the robot, as an arrow that points forward
        half = (9 - ahead) / 3
        across = np.arange(-half, half + 0.5, 0.5)
        _points(canvas, np.full(len(across), ahead), across, 0, _BLUE)
    text = (
        f"The picture was drawn here from the {len(x):,} readings, without a page: the robot in the middle, forward is "
        f"up, left is left, {1 / scale:.3g} m per pixel, a ring every {step:g} m, the nearest ray in red. Rays without "
        "a reading are not drawn. Take numbers from `at`, not from the pixels."
    )
    return png(canvas), text


def of_image(image: Image) -> tuple[bytes, str]:
    """Return the pixels of a camera, thinned if there are too many."""
    values = as_numbers(image)
    rows, columns = image.shape
    every = max(1, ceil((rows * columns / MAX_PIXELS) ** 0.5))
    how = "every pixel, exactly" if every == 1 else f"one pixel in {every} of each row and column, exactly"
    while True:
        part = np.ascontiguousarray(values[::every, ::every])
        if part.dtype.kind == "f":
            unit = 0.001 / (image.depth_scale or 0.001)
            with np.errstate(invalid="ignore"):
                part = np.nan_to_num(part / unit, nan=0, posinf=0, neginf=0).clip(0, 65535).round().astype(np.uint16)
            how = f"one pixel in {every} of each row and column, rounded to thousandths of the unit; 0 is unknown"
        made = png(part)
        if len(made) <= MAX_PNG:
            break
        every += 1
        how = f"one pixel in {every} of each row and column, exactly"
    if values.dtype == np.uint16 and image.is_depth:
        how += "; the numbers are millimetres"
    if image.compressed:
        how += ", as unpacked from the compressed picture"
    return made, f"{columns} x {rows} pixels of {image.encoding[:40]!r}: {how}."


def _nice(step: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten that is not above a step."""
    power = 10.0 ** floor(log10(step))
    return float(next(power * one for one in (5, 2, 1) if power * one <= step * (1 + 1e-9)))


def _points(canvas: Pixels, forward: Any, left: Any, size: int, color: tuple[int, int, int]) -> None:
    row = np.round(SIDE / 2 - np.asarray(forward)).astype(int)
    column = np.round(SIDE / 2 - np.asarray(left)).astype(int)
    for down in range(-size, size + 1):
        for right in range(-size, size + 1):
            canvas[np.clip(row + down, 0, SIDE - 1), np.clip(column + right, 0, SIDE - 1)] = color


def _line(canvas: Pixels, forward: float, left: float, color: tuple[int, int, int]) -> None:
    share = np.linspace(0, 1, 2 * SIDE)
    _points(canvas, forward * share, left * share, 0, color)


def _ring(canvas: Pixels, radius: float) -> None:
    angle = np.linspace(0, 2 * np.pi, ceil(8 * radius))
    _points(canvas, radius * np.cos(angle), radius * np.sin(angle), 0, _GRAY)


def _write(canvas: Pixels, top: int, left: int, text: str) -> None:
    for number, letter in enumerate(text):
        for row, bits in enumerate(_GLYPHS[letter]):
            for column in range(3):
                if bits >> (2 - column) & 1:
                    y, x = top + 2 * row, left + 8 * number + 2 * column
                    canvas[y : y + 2, x : x + 2] = _LABEL
