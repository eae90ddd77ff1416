"""A span of time, with rays or without: the value of a selection on a picture of a recording."""

from __future__ import annotations

from math import isfinite
from numbers import Real
from typing import Any


def time_span(name: str, value: Any, *, rays: bool = False, optional: bool = True) -> tuple[Any, ...]:
    """Return (start, end) in seconds, 0 <= start < end, also from a span of `Recording.find`.

    Args:
        name: the name of the argument, for errors.
        value: two numbers, or four with rays.
        rays: True if (start, end, first, stop) is valid too, with rays from index ``first`` up to, but not including,
            ``stop``.
        optional: True if the text of an error names None as a value.

    Raises:
        ValueError: the value is not a span.
    """
    expected = f"expected {'None or ' if optional else ''}(start, end) in seconds, 0 <= start < end"
    if rays:
        expected += ", with rays (start, end, first, stop)"
    parts = value[:2] if isinstance(value, tuple) and hasattr(value, "start_ns") else value
    if not isinstance(parts, (tuple, list)) or len(parts) not in ((2, 4) if rays else (2,)):
        raise ValueError(f"{name}: {expected}; got {value!r}")
    if not all(isinstance(part, Real) and not isinstance(part, bool) and isfinite(part) for part in parts):
        raise ValueError(f"{name}: {expected}; got {value!r}")
    start, end = (float(part) for part in parts[:2])
    if not 0 <= start < end:
        raise ValueError(f"{name}: {expected}; got {value!r}")
    if len(parts) == 2:
        return start, end
    first, stop = (int(part) for part in parts[2:])
    if (first, stop) != tuple(parts[2:]) or not 0 <= first < stop:
        raise ValueError(f"{name}: expected rays as whole numbers, 0 <= first < stop; got {value!r}")
    return start, end, first, stop
