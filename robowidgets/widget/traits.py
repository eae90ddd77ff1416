"""Trait types that all widgets use."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite
from typing import Any

import numpy as np
import traitlets

from ..samples.checks import in_radians
from ..samples.cloud import to_band

LONGEST_HISTORY = 600
"""The longest history, in seconds. A recording holds more."""

_MOST_ANGLES = 360


class Flag(traitlets.Bool[Any, Any]):
    """True or False, including NumPy's, which its comparisons return."""

    def validate(self, obj: Any, value: Any) -> bool:
        """Return the flag as a bool of Python."""
        flag: bool = super().validate(obj, bool(value) if isinstance(value, np.bool_) else value)
        return flag


class HistorySeconds(traitlets.Float[Any, Any]):
    """Seconds of earlier samples, from 0 (none) to 600.

    Args:
        why: the end of the error text, after the wrong value.
    """

    def __init__(self, default: float, *, why: str = "", **more: Any) -> None:
        super().__init__(default, **more)
        self._why = why

    def validate(self, obj: Any, value: Any) -> float:
        """Return the seconds. Raise TraitError if they are below 0 or too many."""
        seconds = float(super().validate(obj, value))
        if not 0 <= seconds <= LONGEST_HISTORY:
            raise traitlets.TraitError(
                f"{self.name}: expected seconds from 0 (none) to {LONGEST_HISTORY}, got {seconds!r}{self._why}"
            )
        return seconds


class Angle(traitlets.TraitType[Any, Any]):
    """Radians within ±2 pi. A text like "20deg" is accepted, too."""

    def validate(self, _obj: Any, value: Any) -> float:
        """Return the radians. Raise TraitError for other values."""
        try:
            return in_radians(str(self.name), value)
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None


class BandTrait(traitlets.TraitType[Any, Any]):
    """Two finite bounds, the lower one first."""

    info_text = "a lower and an upper bound, both finite"

    def validate(self, obj: Any, value: Any) -> tuple[float, float]:
        """Return the bounds as floats."""
        try:
            low, high = to_band(str(self.name), value)
        except ValueError as error:
            raise traitlets.TraitError(str(error)) from None
        if not (isfinite(low) and isfinite(high)):
            self.error(obj, value)
        return low, high


class Angles(traitlets.TraitType[Any, Any]):
    """Up to 360 angles in radians within ±2 pi. Texts like "20deg" are accepted, too."""

    def validate(self, _obj: Any, value: Any) -> tuple[float, ...]:
        """Return the radians. Raise TraitError for other values."""
        expected = f'{self.name}: expected up to {_MOST_ANGLES} angles, in radians or as text like "20deg"'
        if isinstance(value, str) or not isinstance(value, Iterable):
            raise traitlets.TraitError(f"{expected}; got {value!r}")
        given = list(value)
        if len(given) > _MOST_ANGLES:
            raise traitlets.TraitError(f"{expected}; got {len(given):,}")
        try:
            return tuple(in_radians(f"{self.name}[{i}]", angle) for i, angle in enumerate(given))
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None


def bytes_trait(**tags: Any) -> Any:
    """Return a trait of bytes, which converts the memoryviews that the page sends."""
    return traitlets.Bytes().tag(sync=True, from_json=lambda value, _: bytes(value or b""), **tags)
