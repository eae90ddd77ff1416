"""Single bytes and arrays of bytes in messages; rosbridge sends both as text in base64."""

from __future__ import annotations

import reprlib
from base64 import b64decode
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples.checks import frozen


def bytes_in(name: str, value: Any) -> Any:
    """Return the bytes that rosbridge sends as text in base64, or another value as it is.

    Raises:
        ValueError: the text is not base64.
    """
    if not isinstance(value, str):
        return value
    try:
        return b64decode(value, validate=True)
    except ValueError:
        raise ValueError(f"{name}: expected bytes, or text in base64, got other text") from None


def byte(name: str, value: Any) -> int:
    """Return the number of a byte, which rclpy has as bytes and rosbridge sends in base64, or raise ValueError."""
    try:
        inner = value if isinstance(value, str) and value.isdecimal() else bytes_in(name, value)
        if isinstance(inner, (bytes, bytearray, list)):
            (inner,) = inner
        return int(inner)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: expected a whole number, got {reprlib.repr(value)}") from None


def byte_array(name: str, given: Any) -> NDArray[np.uint8]:
    """Return an array of bytes: a view if the memory is read-only, else a copy.

    Raises:
        TypeError: the value is not bytes. ValueError: the text is not base64.
    """
    data = bytes_in(name, given)
    if isinstance(data, (bytes, bytearray, memoryview)) or hasattr(data, "buffer_info"):
        return owned(np.frombuffer(data, np.uint8))
    try:
        array = np.asarray(data)
        if array.dtype == np.uint8 and array.ndim == 1:
            return owned(array)
        if array.ndim != 1 or (
            array.size and (array.dtype.kind not in "iu" or not 0 <= array.min() <= array.max() < 256)
        ):
            raise TypeError
        return frozen(array.astype(np.uint8))
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected bytes, got {repr(data)[:60]}") from None


def owned(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array itself if its memory is read-only, else a copy."""
    base: Any = array
    while isinstance(base, np.ndarray):
        if base.flags.writeable:
            return frozen(array.copy())
        base = base.base
    is_safe = base is None or isinstance(base, bytes) or (isinstance(base, memoryview) and base.readonly)
    return np.ascontiguousarray(array) if is_safe else frozen(array.copy())
