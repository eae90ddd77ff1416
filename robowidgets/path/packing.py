"""The bytes of a map's layers for the page; docs/developers/frames.md describes them."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Iterator
from itertools import count
from math import isnan, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples import MapGrid, Pose
from ..samples.map_item import Scatter
from .placing import Placed

_RECORD = struct.Struct("<13d")
"""Number of the layer; seconds; x, y, yaw; covariances xx, xy, yy (NaN if unknown); points in the message; version of
its large grid (0 without one); metres of a cell of the grid that follows (NaN without one); rows and columns of the
points or cells that follow."""
_GRID = struct.Struct("<7d")
"""Number of the layer, version, rows, columns, metres of a cell, map cells along its side, bytes that follow."""
_TRACK = struct.Struct("<2d")

CELLS_IN_FRAME = 10_000
"""Grids of up to this many cells, such as a rolling costmap, come with each frame, as scans do."""

MOST_CELLS = 4_000_000
"""The most cells of a grid for the page."""

_versions = count(1)
"""Shared by all widgets, because the page keeps earlier grids while layers and maps start again."""


class PackedGrid(NamedTuple):
    """A large grid, which the page gets once; frames refer to it by its unique version."""

    version: int
    data: bytes


def pack_layers(layers: Iterable[Placed]) -> bytes:
    """Return the bytes of the layers at a time."""
    parts = []
    for one in layers:
        grid = one.grid if one.grid is not None and is_small(one.grid) else None
        rows, columns = grid.cells.shape if grid else one.points.shape
        scatter = one.scatter or (nan,) * 3
        size = grid.resolution if grid else nan
        head = (one.number, one.seconds, *one.pose, *scatter, one.total, one.version, size, rows, columns)
        parts.append(_RECORD.pack(*head))
        if grid:
            parts.append(grid.cells.tobytes())
        else:
            # Relative to the first point, because float32 is coarse far from the origin.
            first = np.zeros(columns)
            first[:2] = one.points[0, :2] if rows else 0.0
            parts += [first[:2].astype("<f8").tobytes(), (one.points - first).astype("<f4").tobytes()]
    return b"".join(parts)


def unpack_layers(data: bytes) -> Iterator[Placed]:
    """Yield the layers from the bytes of a frame."""
    at = 0
    while at < len(data):
        number, seconds, x, y, yaw, xx, xy, yy, total, version, size, rows, columns = _RECORD.unpack_from(data, at)
        at += _RECORD.size
        shape = int(rows), int(columns)
        grid, points = None, np.empty((0, 2))
        if isnan(size):
            first = np.zeros(shape[1])
            first[:2] = np.frombuffer(data, "<f8", 2, at)
            near = np.frombuffer(data, "<f4", shape[0] * shape[1], at + 16).reshape(shape)
            points = near + first
            at += 16 + near.nbytes
        else:
            cells = np.frombuffer(data, np.uint8, shape[0] * shape[1], at).reshape(shape)
            grid = MapGrid(cells, size, Pose(x, y, yaw))
            at += cells.nbytes
        scatter = None if isnan(xx) else Scatter(xx, xy, yy)
        yield Placed(int(number), seconds, Pose(x, y, yaw), scatter, points, int(total), grid, int(version))


def is_small(grid: MapGrid) -> bool:
    """Return True if a grid comes with each frame."""
    return grid.cells.size <= CELLS_IN_FRAME


def pack_grid(number: int, grid: MapGrid) -> PackedGrid:
    """Return a large grid of a layer, with a new version."""
    shown, step = grid.thinned(MOST_CELLS)
    rows, columns = shown.cells.shape
    packed = zlib.compress(shown.cells.tobytes(), 6)
    version = next(_versions)
    head = _GRID.pack(number, version, rows, columns, shown.resolution, step, len(packed))
    return PackedGrid(version, head + packed)


def pack_tracks(tracks: Iterable[tuple[int, NDArray[np.float64]]]) -> bytes:
    """Return the bytes of tracks by layer number: rows of seconds, x, y, yaw and metres so far."""
    return b"".join(_TRACK.pack(number, len(points)) + points.astype("<f8").tobytes() for number, points in tracks)


def pack_grids(grids: Iterable[PackedGrid]) -> bytes:
    """Return the bytes of the large grids of all layers."""
    return b"".join(grid.data for grid in grids)
