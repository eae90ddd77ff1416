"""What scanners send in place of distances."""

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
"""What the rays of a scan say in place of what was measured, from the first on, over and over."""

MET = ("nothing is met", "too close", "nothing measured", "all of it")
"""Those of which a distance is infinite, 0 or NaN, and one with all there is: others answer as one of these."""


def odd_ranges(values: tuple[float, ...], ranges: Any) -> Any:
    """Ranges with these values in them."""
    said = np.resize(np.float32(values), len(ranges))
    return np.where(said == MEASURED, ranges, said)
