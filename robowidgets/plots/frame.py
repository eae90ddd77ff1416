"""The bytes of a plot for the page; docs/developers/frames.md describes them."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from ._thin import thinned
from .line import Floats

_FLOAT = np.dtype("<f8")

Lines = Sequence[tuple[Floats, Floats]]
"""Times and values of each line."""


def ends(lines: Lines) -> tuple[float, float]:
    """Return the first and the last time of all lines, or 0 and 0 without any."""
    times = [times for times, _ in lines if len(times)]
    first = min((float(one[0]) for one in times), default=inf)
    return (first, max(float(one[-1]) for one in times)) if times else (0.0, 0.0)


def pack(edition: int, lines: Lines, span: tuple[float, float], columns: int) -> bytes:
    """Return the lines, thinned to so many columns, as bytes for a span."""
    parts = [np.array([edition, *ends(lines), *span, columns, len(lines)], _FLOAT)]
    for times, values in lines:
        rows = thinned(times, values, *span, columns)
        parts += [np.array([len(times), len(rows.times)], _FLOAT), *(column.astype(_FLOAT) for column in rows)]
    return b"".join(part.tobytes() for part in parts)
