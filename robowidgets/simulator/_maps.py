"""Maps of robots as floors of cells: nav_msgs/OccupancyGrid, and the files of map_server."""

from __future__ import annotations

from os import PathLike
from typing import Any

from ..messages.map_grid import load_map, to_map_grid
from ._grid import Grid

_OCCUPIED = 65
"""The percentage from which a cell of a message is a wall, as in map_server."""


def grid_of_map(source: Any) -> Grid:
    """Return the grid of a map as in `World.from_map`."""
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
