"""The parts of a scanogram that a page gets: a coarse overview at once, and details of the span that it shows."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .levels import FEW, NEAREST, Levels, folded
from .scan_times import ScanTimes

OVERVIEW_BYTES = 1_000_000
"""The maximum size of the overview, which is sent at once and kept in a saved notebook."""

DETAIL_BYTES = 3_000_000
"""The maximum size of a detail."""

MOST_RAYS = 2048
"""The maximum number of rows that a page gets, because no picture has more; with more rays, neighbours share a row."""

MOST_COLUMNS = 8192
_MARGIN = 0.5
_LENGTH = struct.Struct("<I")


class Part(NamedTuple):
    """Neighbouring cells of a level.

    ``level``: a cell contains ``2 ** level`` scans. ``first``: number of the first scan. ``ray_step``: rays per row.
    ``starts``, ``ends``: seconds. ``cells``: shape (cells, rows), codes; at level 0, if they fit, the ranges
    themselves as float32.
    """

    level: int
    first: int
    ray_step: int
    starts: NDArray[np.float64]
    ends: NDArray[np.float64]
    cells: NDArray[Any]

    def pack(self, facts: Mapping[str, Any], **arrays: NDArray[Any]) -> bytes:
        """Return the bytes of the part, with more facts and arrays: see `pack`."""
        own = {"level": self.level, "first": self.first, "ray_step": self.ray_step}
        return pack({**facts, **own}, starts=self.starts, ends=self.ends, cells=self.cells, **arrays)


def most_single(rays: int) -> int:
    """Return the number of scans of so many rays up to which the overview has a cell for each, at level 0."""
    in_overview = OVERVIEW_BYTES // (2 * -(-rays // _ray_step(rays))) - 2
    return max(1, min(in_overview, FEW // (4 * rays)))


def overview(levels: Levels, clock: ScanTimes, pixel: str = NEAREST) -> Part:
    """Return the whole scanogram, as finely as `OVERVIEW_BYTES` allow."""
    return _part(levels, clock, pixel, 0, len(clock), 0, OVERVIEW_BYTES)


def detail(levels: Levels, clock: ScanTimes, start: float, end: float, columns: int, pixel: str = NEAREST) -> Part:
    """Return the part between two times in seconds with a margin, in ``columns`` cells or more if possible."""
    first, stop = clock.between(start, end)
    wanted = min(levels.last, max(0, ((stop - first) // max(1, min(columns, MOST_COLUMNS))).bit_length() - 1))
    margin = _MARGIN * (end - start)
    wide = _part(levels, clock, pixel, *clock.between(start - margin, end + margin), wanted, DETAIL_BYTES)
    return wide if wide.level == wanted else _part(levels, clock, pixel, first, stop, wanted, DETAIL_BYTES)


def pack(facts: Mapping[str, Any], **arrays: NDArray[Any]) -> bytes:
    """Pack facts and arrays: the length of a JSON text, the text, then the arrays, little-endian one after the other.

    The text contains the facts, and as ``arrays`` the name, type and number of elements of each array.
    """
    little = {name: np.ascontiguousarray(a, a.dtype.newbyteorder("<")) for name, a in arrays.items()}
    listed = [[name, a.dtype.str[1:], a.size] for name, a in little.items()]
    text = json.dumps({**facts, "arrays": listed}, allow_nan=False).encode()
    return b"".join((_LENGTH.pack(len(text)), text, *(a.data for a in little.values())))


def _part(levels: Levels, clock: ScanTimes, pixel: str, first: int, stop: int, level: int, most: int) -> Part:
    """Return the scans ``first`` to ``stop - 1``, at the level or the first coarser one that fits in ``most`` bytes."""
    ray_step = _ray_step(levels.sweep.ray_count)
    rays = -(-levels.sweep.ray_count // ray_step)
    while level < levels.last and 2 * rays * (((stop - first) >> level) + 2) > most:
        level += 1
    start, end = first >> level, -(-stop >> level)
    starts, ends = clock.cells(level, start, end)
    exact = level == 0 and ray_step == 1 and 4 * rays * (stop - first) <= most
    if exact:
        return Part(level, start << level, ray_step, starts, ends, levels.scans.read(first, stop))
    cells = folded(levels.codes(level, start, end, pixel), ray_step, pixel, axis=1)
    return Part(level, start << level, ray_step, starts, ends, cells)


def _ray_step(rays: int) -> int:
    """Return the number of rays that share a row."""
    return max(1, -(-rays // MOST_RAYS))
