"""Maps of robots as floors of cells: nav_msgs/OccupancyGrid, and the files of map_server."""

from __future__ import annotations

from os import PathLike
from typing import Any

from ..messages.map_grid import load_map, to_map_grid
from ._grid import Grid

_OCCUPIED = 65
"""Percent from which a cell of a message is a wall, as map_server has it."""


def grid_of_map(source: Any) -> Grid:
    """A map as `World.from_map` takes it."""
    if isinstance(source, (str, PathLike)):
        found = load_map(source)
        occupied, free = found.values == 100, found.values == 0
    else:
        found = to_map_grid(source)
        occupied, free = found.values >= _OCCUPIED, (found.values >= 0) & (found.values < _OCCUPIED)
    grid = Grid(occupied, free, found.resolution, (found.origin.x, found.origin.y, found.origin.yaw))
    if not grid.free.any():
        raise ValueError("map: expected free cells; all are occupied or unknown")
    return grid
