"""A part of a picture: its rows and columns, and its statistics."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples import Image
from ..samples.image import to_depth

Region = tuple[int, int, int, int]
"""First row, row after the last, first column, column after the last."""


def checked_region(given: Any) -> Region:
    """Return a region from four whole numbers, or from slices of rows and columns.

    Raises:
        TypeError: the value is something else. ValueError: the region is empty.
    """
    expected = "region: expected (first row, row after the last, first column, column after the last)"
    try:
        parts = [*given]
        if len(parts) == 2 and all(isinstance(part, slice) for part in parts):
            parts = [end for part in parts for end in (part.start, part.stop)]
        whole = [int(part) for part in parts]
    except (TypeError, ValueError):
        raise TypeError(f"{expected}, got {given!r}") from None
    if len(whole) != 4 or whole != parts:
        raise TypeError(f"{expected}, got {given!r}")
    top, bottom, left, right = whole
    if not (0 <= top < bottom and 0 <= left < right):
        raise ValueError(f"{expected}, the ends above the starts; got {given!r}")
    return top, bottom, left, right


def statistics(image: Image, region: Region) -> dict[str, Any]:
    """Return least, mean, median and greatest value in a part of a picture, for each channel or for the distances.

    ``count`` is the number of pixels with a value, ``of`` the number of all pixels. A region outside the picture has
    no pixels.
    """
    top, bottom, left, right = region
    part = image.pixels[top:bottom, left:right]
    if image.is_depth:
        part = to_depth(part, image.depth_scale)
    channels = part[..., np.newaxis] if part.ndim == 2 else part
    rows = [_row(channels[..., number]) for number in range(channels.shape[2])]
    counted = int(np.isfinite(channels).all(axis=2).sum()) if part.size else 0
    return {"of": int(part.shape[0] * part.shape[1]), "count": counted, "channels": rows}


def _row(values: NDArray[Any]) -> list[float] | None:
    """Return least, mean, median and greatest of the finite values, or None without finite values."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return None
    return [float(of(finite)) for of in (np.min, np.mean, np.median, np.max)]
