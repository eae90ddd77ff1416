"""Checks of numbers that users give, and read-only arrays."""

from __future__ import annotations

import re
from decimal import ROUND_HALF_UP, Decimal
from math import floor, isfinite, log10, pi, radians
from typing import Any, SupportsFloat, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

OF_DEGREES = "math.radians() makes them of degrees"

ANGLE_ROUNDING = 1e-6
"""Radians."""

_FULL_TURN = 2 * pi + 0.01
"""Radians, with a margin for angles typed with few digits."""

DEGREES = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*(?:deg|°)\s*")
"""Degrees as text: ``"20deg"``, ``"-7.5°"``."""

_FLOAT32 = np.dtype(np.float32)


def number(name: str, value: Any) -> float:
    """Return a float, NaN and inf included, or raise TypeError if the value is not a number."""
    if type(value) is float:
        return value
    if isinstance(value, (str, bytes, bool)):
        raise TypeError(f"{name}: expected a number, got {value!r}")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected a number, got {_short(value)}") from None


def finite(name: str, value: Any, unit: str) -> float:
    """Return a finite float, or raise ValueError if the value is NaN or infinite."""
    result = number(name, value)
    if not isfinite(result):
        raise ValueError(f"{name}: expected a finite number of {unit}, got {result!r}")
    return result


def not_negative(name: str, value: Any, unit: str) -> float:
    """Return a finite float that is 0 or more, or raise ValueError."""
    result = finite(name, value, unit)
    if result < 0:
        raise ValueError(f"{name}: expected {unit}, 0 or more, got {result!r}")
    return result


def to_radians(name: str, value: Any) -> float:
    """Return radians, NaN and inf included, from a number or from degrees as text (``"20deg"``), or raise TypeError."""
    if not isinstance(value, str):
        return number(name, value)
    degrees = DEGREES.fullmatch(value)
    if not degrees:
        raise TypeError(f'{name}: expected radians, or degrees as in "20deg", got {value!r}')
    return radians(float(degrees[1]))


def in_radians(name: str, value: Any) -> float:
    """Return radians within ±2 pi from a value for `to_radians`; raise ValueError beyond, which suggests degrees."""
    given = finite(name, to_radians(name, value), "radians")
    if not is_angle(given):
        raise ValueError(f"{name}: expected radians within ±2 pi, got {given!r}; {OF_DEGREES}")
    return given


def is_angle(value: float) -> bool:
    """Return True if the value is within ±2 pi, as radians are."""
    return abs(value) <= _FULL_TURN


def floats(name: str, values: ArrayLike | Any) -> NDArray[np.float32]:
    """Return a read-only float32 copy of a one-dimensional array."""
    array: NDArray[np.float32] | None
    if type(values) is np.ndarray and values.dtype is _FLOAT32 and values.ndim == 1:
        array = values.copy()  # the usual case: no checks needed
        array.setflags(write=False)
        return array
    try:
        given = np.asarray(_unmasked(values) if is_masked(values) else values)
        with np.errstate(over="ignore"):
            array = given.astype(np.float32) if given.dtype.kind in "fiuO" else None
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None:
        raise TypeError(f"{name}: expected a one-dimensional array of numbers, got {_short(values)}")
    if array.ndim != 1:
        raise ValueError(f"{name}: expected a one-dimensional array, got shape {array.shape}")
    return frozen(array)


def is_masked(values: Any) -> TypeGuard[np.ma.MaskedArray[Any, Any]]:
    """Return True for a masked array. For other values this does not import numpy.ma, which takes 20 ms."""
    is_subclass = isinstance(values, np.ndarray) and type(values) is not np.ndarray
    return is_subclass and isinstance(values, np.ma.MaskedArray)


def _unmasked(values: np.ma.MaskedArray[Any, Any]) -> NDArray[np.float32]:
    """Return the array with NaN for masked values, because they are not measurements."""
    return np.ma.filled(values.astype(np.float32), np.nan)


def is_frozen(values: Any) -> TypeGuard[NDArray[np.float32]]:
    """Return True if this is a read-only one-dimensional array of float32."""
    return type(values) is np.ndarray and values.dtype is _FLOAT32 and values.ndim == 1 and not values.flags.writeable


def shortest(value: SupportsFloat) -> float:
    """Return a float32 as the float with the fewest decimals: 2.54, not 2.5399999618530273."""
    return float(str(np.float32(float(value))))


def decimals(value: float, most: int) -> str:
    """Return a finite number as text with at most that many decimals, without trailing zeros: "0.35", "-20", "0".

    Ties round away from zero, as in the page, so that both write the same text.
    """
    text = f"{Decimal(value).quantize(Decimal(1).scaleb(-most), ROUND_HALF_UP):f}"
    text = text.rstrip("0").rstrip(".") if most else text
    return "0" if text == "-0" else text


def metres(value: float, reach: float) -> str:
    """Return a distance as the page writes it in a picture with this reach in metres: ``"2.54 m"``, ``"1.235 km"``."""
    if value >= 1000:
        return f"{value / 1000:.3f} km"
    text = f"{value:.{min(6, max(2, 1 - floor(log10(reach))))}f}"
    return f"{value:.2g} m" if value and not float(text) else f"{text} m"


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Make an array read-only and return it."""
    array.setflags(write=False)
    return array


def _short(value: object) -> str:
    text = repr(value)
    return f"{text[:60]}…" if len(text) > 60 else text
