"""The bytes of a picture for the page."""

from __future__ import annotations

import io
import struct
from enum import IntEnum
from math import ceil, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples import Image
from ..samples.image import BAYER, CHANNELS

HEADER = struct.Struct("<6d")
"""Form, rows and columns of the picture, step between the rows and columns that are sent, metres per unit of a depth
image (0 for other images), and 1 if the numbers are the exact pixels, else 0."""

MOST_BYTES = 1_250_000
"""The most bytes of a picture to the page. A picture of 640 x 480 with four bytes per pixel has 1,228,800."""

MOST_PIXELS = 2_000_000
"""The most pixels of a picture that is sent to the page as a JPEG."""

MOST_FILE, MOST_FILE_PIXELS = 4_000_000, 10_000_000
"""The most bytes and pixels of a JPEG or PNG that is passed on as it came."""

WORTHWHILE = 4
"""If pictures come often, a JPEG replaces pixels that have at least this many times its bytes."""

NO_PICTURE = Image(np.zeros((1, 1), np.uint8), "mono8")
"""The picture that a player shows before the first one."""

_QUALITY = 90
_BLUE_U, _GREEN_U, _GREEN_V, _RED_V = 1.772, 0.344136, 0.714136, 1.402
"""ITU-R BT.601, as in JPEG."""


class Form(IntEnum):
    """The format of the bytes of a picture."""

    FILE = 0
    RGB = 1
    RGBA = 2
    GRAY = 3
    UINT16 = 4
    FLOAT32 = 5


class Packed(NamedTuple):
    """The bytes of a picture with their header, and the step between its rows and columns."""

    data: bytes
    every: int


def pack(image: Image, most: int = MOST_BYTES, *, often: bool = False) -> Packed:
    """Return a picture for the page in at most that many bytes: unchanged, thinned, or as a JPEG.

    Colours and grays become a JPEG if they are large and Pillow is installed. If pictures come often, smaller ones do
    too, so that other frames arrive in time.

    Raises:
        ValueError: a JPEG or PNG is too large for the page, and cannot be unpacked.
    """
    rows, columns = image.shape
    if image.compressed and len(image.compressed) <= MOST_FILE and rows * columns <= MOST_FILE_PIXELS:
        return _packed(image, Form.FILE, 1, image.compressed, is_exact=image.encoding == "png")
    values, first = image.pixels, 2 if image.encoding.startswith(BAYER) else 1
    form, size, is_exact = _get_form(image, values)
    every = _every(rows * columns * size, most, first)
    is_large = every > first
    if form in (Form.RGB, Form.GRAY) and (is_large or often):
        every_th = _every(rows * columns, MOST_PIXELS, first)
        file = _jpeg(_shown(image, values, every_th, form))
        limit = max(most, MOST_BYTES // 4) if is_large else rows * columns * size // WORTHWHILE
        if file is not None and len(file) <= limit:
            return _packed(image, Form.FILE, every_th, file, is_exact=False)
    shown = _shown(image, values, every, form)
    return _packed(image, form, every, shown.tobytes(), is_exact=is_exact)


def as_numbers(image: Image) -> NDArray[Any]:
    """Return all pixels as drawn: colours of 8 bits, shape (rows, columns, 3 or 4), or numbers, shape (rows, columns).

    Numbers are uint8, uint16 or float32. In a depth image, whole numbers are millimetres and others metres.

    Raises:
        ValueError: a JPEG or PNG cannot be unpacked.
    """
    values = image.pixels
    form, _, _ = _get_form(image, values)
    if image.encoding.startswith(BAYER):
        rows, columns = image.shape
        return _shown(image, values, 2, form).repeat(2, axis=0).repeat(2, axis=1)[:rows, :columns]
    return np.ascontiguousarray(_shown(image, values, 1, form))


def is_recolored(image: Image) -> bool:
    """Return True if the page gets colours that were converted from the pixels, instead of their channels."""
    if image.compressed:
        return False
    form, _, is_exact = _get_form(image, image.pixels)
    return form in (Form.RGB, Form.RGBA) and not is_exact


def _packed(image: Image, form: Form, every: int, data: bytes, *, is_exact: bool) -> Packed:
    head = HEADER.pack(form, *image.shape, every, image.depth_scale, is_exact)
    return Packed(head + data, every)


def _every(size: int, most: int, first: int) -> int:
    return first * max(1, ceil(sqrt(size / (first * first) / most)))


def _get_form(image: Image, values: NDArray[Any]) -> tuple[Form, int, bool]:
    """Return the form of the pixels of a picture, the bytes per pixel, and True if they are exact."""
    kind, size = values.dtype.kind, values.dtype.itemsize
    if image.encoding.startswith(BAYER):
        return Form.RGB, 3, False
    if values.ndim == 3:
        letters = CHANNELS.get(image.encoding, "")
        is_exact = kind == "u" and size == 1 and letters != "yuv"
        channels = values.shape[2]
        if channels in (2, 3) or letters == "yuv":
            return Form.RGB, 3, is_exact and channels == 3
        return Form.RGBA, 4, is_exact
    if values.dtype == np.uint8:
        return Form.GRAY, 1, True
    if values.dtype == np.uint16:
        return Form.UINT16, 2, True
    return Form.FLOAT32, 4, size <= 2 or values.dtype == np.float32


def _shown(image: Image, values: NDArray[Any], every: int, form: Form) -> NDArray[Any]:
    """Return every n-th row and column of a picture, as the page shows them."""
    if image.encoding.startswith(BAYER):
        return _of_mosaic(values, image.encoding[6:10], every)
    part = values[::every, ::every]
    if form is Form.FLOAT32:
        return part.astype("<f4")
    if form is Form.UINT16:
        return part.astype("<u2", copy=False)
    letters = CHANNELS.get(image.encoding, "")
    if letters == "yuv":
        return _of_yuv(part)
    part = _to_bytes(part)
    if part.ndim == 3 and part.shape[2] == 2:
        part = np.dstack([part, np.zeros_like(part[..., 0])])
    if letters[:3] == "bgr":
        part = part[..., [2, 1, 0, *range(3, part.shape[2])]]
    return part


def _to_bytes(part: NDArray[Any]) -> NDArray[np.uint8]:
    """Return channels of any type as 8 bits: the upper bits of whole numbers, and floats from 0 to 1 as 0 to 255."""
    if part.dtype.kind == "f":
        return np.asarray(np.nan_to_num(part).clip(0, 1) * 255).astype(np.uint8)
    if part.dtype.kind == "i":
        part = (part.astype(np.int64) >> (8 * part.dtype.itemsize - 8)) + 128
        return np.asarray(part, np.uint8)
    shift = 8 * part.dtype.itemsize - 8
    shifted: NDArray[np.uint8] = (part >> shift).astype(np.uint8) if shift else part
    return shifted


def _of_yuv(part: NDArray[np.uint8]) -> NDArray[np.uint8]:
    y, u, v = (part[..., channel].astype(np.float32) - offset for channel, offset in enumerate((0, 128, 128)))
    rgb = (y + _RED_V * v, y - _GREEN_U * u - _GREEN_V * v, y + _BLUE_U * u)
    return np.dstack(rgb).clip(0, 255).round().astype(np.uint8)


def _of_mosaic(values: NDArray[Any], pattern: str, every: int) -> NDArray[np.uint8]:
    """Return one colour for each block of 2 x 2 pixels, which measured red, blue, and green twice."""
    # An odd number of rows or columns is padded with a copy of the row or column before the last.
    values = np.pad(values, [(0, size % 2) for size in values.shape], "reflect")
    corner = {"r": [], "g": [], "b": []}  # type: dict[str, list[NDArray[Any]]]
    for number, letter in enumerate(pattern):
        corner[letter].append(values[number // 2 :: every, number % 2 :: every])
    green = (corner["g"][0].astype(np.uint32) + corner["g"][1]) // 2
    return np.dstack([_to_bytes(one) for one in (corner["r"][0], green.astype(values.dtype), corner["b"][0])])


def _jpeg(shown: NDArray[np.uint8]) -> bytes | None:
    """Return a JPEG of these pixels, or None without Pillow."""
    try:
        import PIL.Image  # Imported lazily, and optional: without it large pictures are thinned.
    except ImportError:
        return None
    file = io.BytesIO()
    PIL.Image.fromarray(np.ascontiguousarray(shown)).save(file, "JPEG", quality=_QUALITY)
    return file.getvalue()
