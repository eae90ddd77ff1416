"""Numbers as they are given, checked, and arrays that nobody changes."""

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
"""And what is lost when it is typed with few digits."""

DEGREES = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*(?:deg|°)\s*")
"""Degrees as text: ``"20deg"``, ``"-7.5°"``."""

_FLOAT32 = np.dtype(np.float32)


def number(name: str, value: Any) -> float:
    """A float, NaN and inf included; TypeError when it is no number."""
    if type(value) is float:
        return value
    if isinstance(value, (str, bytes, bool)):
        raise TypeError(f"{name}: expected a number, got {value!r}")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected a number, got {_short(value)}") from None


def finite(name: str, value: Any, unit: str) -> float:
    """A finite float; ValueError when it is NaN or infinite."""
    result = number(name, value)
    if not isfinite(result):
        raise ValueError(f"{name}: expected a finite number of {unit}, got {result!r}")
    return result


def not_negative(name: str, value: Any, unit: str) -> float:
    """A finite float that is 0 or more; ValueError for any other."""
    result = finite(name, value, unit)
    if result < 0:
        raise ValueError(f"{name}: expected {unit}, 0 or more, got {result!r}")
    return result


def to_radians(name: str, value: Any) -> float:
    """Radians, NaN and inf included, also of degrees as text (``"20deg"``); TypeError when it is neither."""
    if not isinstance(value, str):
        return number(name, value)
    degrees = DEGREES.fullmatch(value)
    if not degrees:
        raise TypeError(f'{name}: expected radians, or degrees as in "20deg", got {value!r}')
    return radians(float(degrees[1]))


def in_radians(name: str, value: Any) -> float:
    """An angle within ±2 pi, as `to_radians` takes it; ValueError beyond it, where it is in degrees."""
    given = finite(name, to_radians(name, value), "radians")
    if not is_angle(given):
        raise ValueError(f"{name}: expected radians within ±2 pi, got {given!r}; {OF_DEGREES}")
    return given


def is_angle(value: float) -> bool:
    """Whether this is within ±2 pi, as radians are."""
    return abs(value) <= _FULL_TURN


def floats(name: str, values: ArrayLike | Any) -> NDArray[np.float32]:
    """A read-only float32 copy of a one-dimensional array."""
    array: NDArray[np.float32] | None
    if type(values) is np.ndarray and values.dtype is _FLOAT32 and values.ndim == 1:
        array = values.copy()  # as scanners send it: nothing to guard against
        array.setflags(write=False)
        return array
    try:
        given = np.asarray(_unmasked(values) if isinstance(values, np.ma.MaskedArray) else values)
        with np.errstate(over="ignore"):
            array = given.astype(np.float32) if given.dtype.kind in "fiuO" else None
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None:
        raise TypeError(f"{name}: expected a one-dimensional array of numbers, got {_short(values)}")
    if array.ndim != 1:
        raise ValueError(f"{name}: expected a one-dimensional array, got shape {array.shape}")
    return frozen(array)


def _unmasked(values: np.ma.MaskedArray[Any, Any]) -> NDArray[np.float32]:
    """Masked values as NaN, because they are no measurements."""
    return np.ma.filled(values.astype(np.float32), np.nan)


def is_frozen(values: Any) -> TypeGuard[NDArray[np.float32]]:
    """Whether this is a read-only one-dimensional array of float32."""
    return type(values) is np.ndarray and values.dtype is _FLOAT32 and values.ndim == 1 and not values.flags.writeable


def shortest(value: SupportsFloat) -> float:
    """A float32 as the float that a person would write: 2.54, not 2.5399999618530273."""
    return float(str(np.float32(float(value))))


def decimals(value: float, most: int) -> str:
    """A finite number with at most so many decimals, and none that is not needed: "0.35", "-20", "0".

    A tie goes away from zero, as in the page, so that both write the same.
    """
    text = f"{Decimal(value).quantize(Decimal(1).scaleb(-most), ROUND_HALF_UP):f}"
    text = text.rstrip("0").rstrip(".") if most else text
    return "0" if text == "-0" else text


def metres(value: float, reach: float) -> str:
    """A distance in a picture that reaches so far in metres, as the page writes it: ``"2.54 m"``, ``"1.235 km"``."""
    if value >= 1000:
        return f"{value / 1000:.3f} km"
    text = f"{value:.{min(6, max(2, 1 - floor(log10(reach))))}f}"
    return f"{value:.2g} m" if value and not float(text) else f"{text} m"


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """The same array, read-only."""
    array.setflags(write=False)
    return array


def _short(value: object) -> str:
    text = repr(value)
    return f"{text[:60]}…" if len(text) > 60 else text
