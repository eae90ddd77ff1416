"""Conversion of Image and CompressedImage messages, and of arrays, to pictures."""

from __future__ import annotations

import io
import re
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples.image import BAYER, CHANNELS, Image
from ._rvl import from_rvl
from .byte_fields import byte_array
from .fields import describe, frame_id, get, has, stamp_ns, unwrap

IMAGE_TYPES = frozenset({"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"})

ENCODINGS = (
    *("rgb8", "bgr8", "rgba8", "bgra8", "mono8", "mono16", "rgb16", "bgr16", "rgba16", "bgra16"),
    *("bayer_*8", "bayer_*16", "yuv422", "yuv422_yuy2", "8UC1 to 64FC4"),
)
"""Encodings as errors list them."""

NO_PILLOW = "its pixels need Pillow: pip install 'robowidgets[images]'"

MILLIMETRES, METRES = 0.001, 1.0

_BITS = re.compile(r"(?:rgb|bgr|rgba|bgra|mono|bayer_[a-z]{4})(8|16)")
_GENERIC = re.compile(r"(8|16|32|64)([USF])C([1-4])")
_KINDS = {"U": "u", "S": "i", "F": "f"}
_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8"
_DEPTH_CONFIG = struct.Struct("<iff")
"""The header before the PNG of a compressedDepth: the format, and the two numbers of an inverse depth."""
_NOT_A_SIZE = {0xC4, 0xC8, 0xCC}
"""Markers of a JPEG from C0 to CF that do not start a frame."""


def to_image(message: Any, encoding: str = "") -> Image:
    """Return the picture in an Image-like message or in an array.

    Args:
        message: an object or dictionary with the fields of sensor_msgs/Image or sensor_msgs/CompressedImage; an array
            of shape (rows, columns) or (rows, columns, channels); an `Image` is returned as it is.
        encoding: the encoding of an array. By default uint8 is mono8, rgb8 or rgba8; uint16 and float are a depth
            image, 16UC1 in millimetres or 32FC1 in metres; bool is black and white.

    Raises:
        TypeError: the message has another type; the text says what came and what was expected.
        ValueError: its encoding is unknown, or its size does not fit its data.
    """
    message = unwrap(message)
    if isinstance(message, Image):
        return message
    if isinstance(message, np.ndarray):
        return _of_array(message, encoding)
    if has(message, "format", "data") and not has(message, "encoding"):
        return _of_compressed(message)
    missing = [name for name in ("height", "width", "encoding", "step", "data") if not has(message, name)]
    if missing:
        raise TypeError(
            "expected a message like sensor_msgs/Image or sensor_msgs/CompressedImage, or an array; "
            f"got {describe(message)} (missing: {', '.join(missing)})"
        )
    name = str(get(message, "encoding"))
    values = _of_rows(message, name)
    step = int(get(message, "step"))
    return Image(values, name, stamp_ns(message), frame_id(message), depth_scale=_depth_scale(name), step=step)


def layout_of(encoding: str) -> tuple[np.dtype[Any], int]:
    """Return the type of the numbers of an encoding, in native byte order, and their count per pixel.

    Raises:
        ValueError: the encoding is unknown.
    """
    if encoding in CHANNELS and CHANNELS[encoding] == "yuv":
        return np.dtype(np.uint8), 2
    generic, bits = _GENERIC.fullmatch(encoding), _BITS.fullmatch(encoding)
    if generic:
        size, kind = int(generic[1]) // 8, _KINDS[generic[2]]
        if f"{kind}{size}" not in ("f1", "u8", "i8", "u4"):
            return np.dtype(f"{kind}{size}"), int(generic[3])
    elif bits and (not encoding.startswith("bayer") or encoding.startswith(BAYER)):
        return np.dtype(f"u{int(bits[1]) // 8}"), len(CHANNELS.get(encoding, "m"))
    known = ", ".join(ENCODINGS)
    raise ValueError(f"encoding: expected one of {known}; got {encoding[:40]!r}")


def _depth_scale(encoding: str) -> float:
    return {"16UC1": MILLIMETRES, "32FC1": METRES, "64FC1": METRES}.get(encoding, 0.0)


def _of_rows(message: Any, encoding: str) -> NDArray[Any]:
    """Return the pixels of an Image, without the padding of its rows."""
    dtype, channels = layout_of(encoding)
    rows, columns, step = (_whole(name, get(message, name)) for name in ("height", "width", "step"))
    if not rows * columns:
        raise ValueError(f"the picture is empty: height {rows}, width {columns}")
    data = byte_array("data", get(message, "data"))
    needed = columns * channels * dtype.itemsize
    if step < needed:
        raise ValueError(
            f"step: expected at least {needed} bytes for {columns} pixels of {encoding}, got {step}; "
            "the driver fills in a wrong step, width or encoding"
        )
    if len(data) < step * (rows - 1) + needed:
        raise ValueError(
            f"data: expected {step * rows:,} bytes, {rows} rows of {step}, got {len(data):,}; the message is cut off, "
            "or the driver fills in a wrong height or step"
        )
    if len(data) < step * rows:  # the last row may lack its padding
        data = np.concatenate([data, np.zeros(step * rows - len(data), np.uint8)])
    lines = data[: step * rows].reshape(rows, step)[:, :needed]
    if get(message, "is_bigendian", 0) and dtype.itemsize > 1:
        dtype = dtype.newbyteorder(">")
    values = np.ascontiguousarray(lines).view(dtype).reshape(rows, columns, channels)
    values = values.astype(dtype.newbyteorder("="), copy=False)
    if CHANNELS.get(encoding) == "yuv":
        return _yuv(values, encoding)
    return values[..., 0] if channels == 1 else values


def _yuv(pairs: NDArray[np.uint8], encoding: str) -> NDArray[np.uint8]:
    """Return y, u and v of each pixel; two neighbours share u and v."""
    rows, columns, _ = pairs.shape
    if columns % 2:
        raise ValueError(f"width: expected an even number of pixels in {encoding}, got {columns}")
    y, uv = (1, 0) if encoding in ("yuv422", "uyvy") else (0, 1)
    shared = pairs[..., uv].reshape(rows, columns // 2, 2).repeat(2, axis=1)
    return np.dstack([pairs[..., y], shared[..., 0], shared[..., 1]])


def _of_array(array: NDArray[Any], encoding: str) -> Image:
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] not in (1, 3, 4)):
        raise ValueError(f"expected an array of shape (rows, columns) or (rows, columns, 3 or 4), got {array.shape}")
    values = array[..., 0] if array.ndim == 3 and array.shape[2] == 1 else array
    channels = 1 if values.ndim == 2 else values.shape[2]
    if not encoding and values.dtype == bool:
        values = values.astype(np.uint8) * np.uint8(255)
    guessed = {
        ("u", 1, 1): "mono8",
        ("u", 1, 3): "rgb8",
        ("u", 1, 4): "rgba8",
        ("u", 2, 1): "16UC1",
        ("f", 2, 1): "32FC1",
        ("f", 4, 1): "32FC1",
        ("f", 8, 1): "64FC1",
        ("i", 1, 1): "8SC1",
        ("i", 2, 1): "16SC1",
        ("i", 4, 1): "32SC1",
    }
    name = encoding or guessed.get((values.dtype.kind, values.dtype.itemsize, channels), "")
    if not name:
        raise ValueError(
            "expected an array of uint8 (mono, rgb or rgba), uint16 (millimetres) or float32 (metres), "
            f"got {values.dtype} with {channels} channel{'s' * (channels > 1)}"
        )
    dtype, needed = layout_of(name)
    needed = 3 if CHANNELS.get(name) == "yuv" else needed
    is_widened = not encoding and values.dtype.kind == "f" and values.dtype.itemsize == 2
    if needed != channels or (values.dtype != dtype and not is_widened):
        raise ValueError(
            f"expected {needed} channel{'s' * (needed > 1)} of {dtype} for encoding {name!r}, "
            f"got {channels} of {values.dtype}"
        )
    # Copied, because the caller may change the array.
    return Image(values.astype(dtype, copy=True), name, depth_scale=_depth_scale(name))


# -- compressed --------------------------------------------------------------------------------------------------------


def _of_compressed(message: Any) -> Image:
    stated = str(get(message, "format"))
    data = byte_array("data", get(message, "data")).tobytes()
    common: dict[str, Any] = {"stamp_ns": stamp_ns(message), "frame_id": frame_id(message)}
    named, _, how = (part.strip() for part in stated.partition(";"))
    if not data:
        raise ValueError("the picture is empty: no bytes in data")
    if "compressedDepth" in how:
        return _of_compressed_depth(data, named, how, common)
    if data.startswith(_PNG):
        rows, columns, bits, color = _png_size(data)
        if bits == 16 and color == 0:
            # Browsers keep only 8 of 16 bits.
            name = named if named in ("mono16", "16UC1") else "16UC1"
            return Image(unpacked(data), name, **common, depth_scale=_depth_scale(name))
        # `unpacked` converts single bits to colours.
        common |= {"size": (rows, columns), "is_gray": color == 0 and bits > 1}
        return Image(None, "png", **common, compressed=data, unpack=unpacked)
    if data.startswith(_JPEG):
        rows, columns, channels = _jpeg_size(data)
        common |= {"size": (rows, columns), "is_gray": channels == 1}
        return Image(None, "jpeg", **common, compressed=data, unpack=unpacked)
    raise ValueError(
        f"data: expected a JPEG or PNG, as format {stated[:40]!r} says, got bytes that begin with {data[:8].hex(' ')}; "
        "other formats are not unpacked"
    )


def _of_compressed_depth(data: bytes, named: str, how: str, common: dict[str, Any]) -> Image:
    """Return a depth image of image_transport: 12 bytes, and a PNG with 16 bits or data in RVL."""
    packed = data[_DEPTH_CONFIG.size :]
    is_png = packed.startswith(_PNG)
    if not is_png and "rvl" not in how.lower():
        raise ValueError(f"data: expected 12 bytes and a PNG for {how!r}, got another packing")
    values = unpacked(packed) if is_png else from_rvl(packed)
    if values.dtype != np.uint16 or values.ndim != 2:
        raise ValueError(f"data: expected a PNG of 16 bit in one channel, got {values.dtype}, shape {values.shape}")
    if not named.startswith("32FC1"):
        return Image(values, "16UC1", **common, depth_scale=MILLIMETRES)
    _, quantum, offset = _DEPTH_CONFIG.unpack_from(data)
    metres = np.full(values.shape, np.nan, np.float32)
    with np.errstate(divide="ignore", invalid="ignore"):  # a value equal to the offset is infinitely far
        np.divide(np.float32(quantum), values - np.float32(offset), out=metres, where=values > 0)
    return Image(metres, "32FC1", **common, depth_scale=METRES)


def unpacked(data: bytes) -> NDArray[Any]:
    """Return the pixels of a JPEG or PNG.

    Raises:
        ValueError: Pillow is not installed, or cannot read the picture.
    """
    try:
        # Imported lazily, and optional: browsers unpack pictures with 8 bits. No other package is as common.
        import PIL.Image
    except ImportError:
        raise ValueError(NO_PILLOW) from None
    try:
        with PIL.Image.open(io.BytesIO(data)) as picture:
            has_alpha = "transparency" in picture.info or "A" in picture.mode
            is_plain = picture.mode not in ("P", "CMYK", "YCbCr", "1", "LA", "PA")
            values = np.asarray(picture if is_plain else picture.convert("RGBA" if has_alpha else "RGB"))
    except PIL.UnidentifiedImageError:
        raise ValueError("the picture is damaged: nothing in it can be read") from None
    except (OSError, SyntaxError, ValueError, PIL.Image.DecompressionBombError) as error:
        raise ValueError(f"the picture is damaged: {error}") from None
    # Some versions of Pillow open 16 bits as int32.
    return values.astype(np.uint16) if values.dtype == np.int32 else values


def _png_size(data: bytes) -> tuple[int, int, int, int]:
    """Return rows, columns, bits of a channel, and the colour type of a PNG."""
    if len(data) < 26:
        raise ValueError(f"the picture is damaged: a PNG of {len(data)} bytes")
    columns, rows, bits, color = struct.unpack_from(">IIBB", data, 16)
    return rows, columns, bits, color


def _jpeg_size(data: bytes) -> tuple[int, int, int]:
    """Return rows, columns and channels from the first frame of a JPEG."""
    at = 2
    while at + 10 <= len(data) and data[at] == 0xFF:
        marker, (length,) = data[at + 1], struct.unpack_from(">H", data, at + 2)
        if 0xC0 <= marker <= 0xCF and marker not in _NOT_A_SIZE:
            rows, columns, channels = struct.unpack_from(">HHB", data, at + 5)
            return rows, columns, channels
        # Bytes of FF before a marker are padding.
        at += 1 if marker == 0xFF else 2 + length
    raise ValueError("the picture is damaged: a JPEG without a size")


# -- fields ------------------------------------------------------------------------------------------------------------


def _whole(name: str, value: Any) -> int:
    try:
        whole = int(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a whole number, got {value!r}") from None
    if whole != value or whole < 0:
        raise ValueError(f"{name}: expected a whole number, 0 or more, got {value!r}")
    return whole
