"""Values that scanners send instead of distances."""

from __future__ import annotations

from typing import Any

import numpy as np

INF, NAN, MEASURED = float("inf"), float("nan"), -7.0
ODD = {
    "nothing is met": (INF,),
    "a Neato's zeros for nothing": (0.0, 0.0, 0.0, MEASURED),
    "zeros alone": (0.0,),
    "too close": (-INF,),
    "nothing measured": (NAN,),
    "all of it": (MEASURED, 0.0, NAN, INF, -INF, 0.05, 1e3),
}
"""Values that the rays of a scan get instead of their measurements, from the first ray on, repeated."""

MET = ("nothing is met", "too close", "nothing measured", "all of it")
"""The kinds with an infinite distance, 0 or NaN, and one with all of them; the others give the same answers."""


def odd_ranges(values: tuple[float, ...], ranges: Any) -> Any:
    """Ranges with these values in them."""
    said = np.resize(np.float32(values), len(ranges))
    return np.where(said == MEASURED, ranges, said)
