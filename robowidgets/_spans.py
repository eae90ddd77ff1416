"""Traits for stretches of time."""

from __future__ import annotations

from math import isfinite
from numbers import Real
from typing import Any

import traitlets


class TimeSpan(traitlets.TraitType[Any, Any]):
    """None, or (start, end) in seconds from the start, 0 <= start < end.

    Args:
        rays: whether (start, end, first, stop) may say as well which rays are meant: from index ``first`` up to, not
            including, ``stop``.
    """

    def __init__(self, *, rays: bool = False, **more: Any) -> None:
        super().__init__(None, allow_none=True, **more)
        self._rays = rays

    def validate(self, _obj: Any, value: Any) -> Any:
        """The span as a tuple, or None; TraitError says what is wrong with it."""
        expected = "expected None or (start, end) in seconds, 0 <= start < end"
        if self._rays:
            expected += ", with rays (start, end, first, stop)"
        if value is None:
            return None
        parts = value
        if not isinstance(parts, (tuple, list)) or len(parts) not in ((2, 4) if self._rays else (2,)):
            raise traitlets.TraitError(f"{self.name}: {expected}; got {value!r}")
        if not all(isinstance(part, Real) and not isinstance(part, bool) and isfinite(part) for part in parts):
            raise traitlets.TraitError(f"{self.name}: {expected}; got {value!r}")
        start, end = (float(part) for part in parts[:2])
        if not 0 <= start < end:
            raise traitlets.TraitError(f"{self.name}: {expected}; got {value!r}")
        if len(parts) == 2:
            return start, end
        first, stop = (int(part) for part in parts[2:])
        if (first, stop) != tuple(parts[2:]) or not 0 <= first < stop:
            raise traitlets.TraitError(f"{self.name}: expected rays as whole numbers, 0 <= first < stop; got {value!r}")
        return start, end, first, stop
