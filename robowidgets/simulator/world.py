"""The world of the robot: straight walls, round obstacles, and drops that a robot can fall into."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import floor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..samples.checks import finite, in_radians
from ._grid import Grid, grid_of_text
from ._maps import grid_of_map

Floats = NDArray[np.float64]

_FEW = 64
"""The number of walls up to which testing all is faster than a cache of the near walls."""
_SQUARE = 1.0
"""The side of the squares of that cache in metres."""


class World:
    """Straight walls and round obstacles on a flat floor, which may have drops, such as stairwells.

    The frame is fixed to the floor: x and y in metres, yaw counter-clockwise from x (REP-103). A wall has no thickness
    and stops a robot from both sides. Scanners do not see a drop.

    Args:
        walls: W segments as (x1, y1, x2, y2) in metres.
        obstacles: O discs as (x, y, radius) in metres.
        start: the default start pose of a robot: (x, y, yaw), metres and radians.
        drops: D rectangles without floor, as two opposite corners (x1, y1, x2, y2) in metres.

    Raises:
        TypeError: something is not a number.
        ValueError: wrong shape, a value that is not finite, a wall without length, a drop without area, or a radius
            that is not above 0.

    Examples:
        >>> world = World(walls=[(3.0, -2.0, 3.0, 2.0)], obstacles=[(1.0, 1.0, 0.2)])
        >>> world.clearance(1.0, -1.0)
        1.8
    """

    def __init__(
        self,
        walls: ArrayLike = (),
        obstacles: ArrayLike = (),
        start: Sequence[float] = (0.0, 0.0, 0.0),
        drops: ArrayLike = (),
    ) -> None:
        self.walls: Floats = _table("walls", walls, ("x1", "y1", "x2", "y2"))
        self.obstacles: Floats = _table("obstacles", obstacles, ("x", "y", "radius"))
        self.drops: Floats = _table("drops", drops, ("x1", "y1", "x2", "y2"))
        self.start = to_pose("start", start)
        self._near: dict[tuple[int, int, float], World] = {}
        for i in np.flatnonzero((self.walls[:, :2] == self.walls[:, 2:]).all(axis=1))[:1]:
            x, y = self.walls[i, :2]
            raise ValueError(f"walls[{i}]: expected two different ends, got ({x:g}, {y:g}) twice")
        for i in np.flatnonzero((self.drops[:, :2] == self.drops[:, 2:]).any(axis=1))[:1]:
            raise ValueError(f"drops[{i}]: expected two opposite corners, got {self.drops[i].tolist()}")
        for i in np.flatnonzero(self.obstacles[:, 2] <= 0)[:1]:
            raise ValueError(f"obstacles[{i}]: expected a radius above 0 m, got {self.obstacles[i, 2]:g}")
        self._drop_edges = np.sort(self.drops.reshape(-1, 2, 2), axis=1).reshape(-1, 4).tolist()

    @classmethod
    def from_text(cls, text: str, cell: float = 0.5) -> World:
        """Return a room that is drawn as text, a character for each square of the floor.

        ``#`` is a wall, a space or ``.`` is free floor, ``o`` is a round obstacle, ``=`` is a drop, and one of
        ``> < ^ v`` is the start of the robot with its heading. Spaces at the ends of a line are outside of the room.
        The bottom left corner is (0, 0).

        Args:
            text: the lines, from top to bottom.
            cell: the side of a square in metres.

        Raises:
            TypeError: the text is not a text, or the cell is not a number.
            ValueError: another character, two starts, no free floor, or a cell that is not above 0.

        Examples:
            >>> world = World.from_text('''
            ...     ########
            ...     #>...o.#
            ...     ########
            ... ''')
            >>> world.start
            (0.75, 0.75, 0.0)
        """
        return cls._of(grid_of_text(text, cell))

    @classmethod
    def from_map(cls, source: Any, start: Sequence[float] | None = None) -> World:
        """Return the room of a map that a robot has made.

        Occupied cells are walls: cells of at least 65 % in a message, or above ``occupied_thresh`` in a file. Unknown
        cells and the area outside of the map do not stop a robot.

        Args:
            source: a nav_msgs/OccupancyGrid, as a message or a dict; or the path of a YAML file of map_server, with its
                image in PGM.
            start: the start pose of a robot, (x, y, yaw), or None for the roomy place nearest to the middle.

        Raises:
            TypeError: the source is neither. OSError: a file cannot be read.
            ValueError: something in the map is missing or out of range, or no cell is free.

        Examples:
            >>> info = {"width": 3, "height": 2, "resolution": 0.5}
            >>> World.from_map({"info": info, "data": [100, 0, 0, 100, 0, 0]}).walls.tolist()
            [[0.5, 0.0, 0.5, 1.0]]
        """
        world = cls._of(grid_of_map(source))
        if start is not None:
            world.start = to_pose("start", start)
        return world

    @classmethod
    def _of(cls, grid: Grid) -> World:
        return cls(grid.walls(), grid.obstacles, grid.start(), grid.drops)

    def with_obstacles(self, obstacles: ArrayLike) -> World:
        """Return a world with the same walls and drops and other obstacles."""
        world = World((), obstacles, self.start, self.drops)
        world.walls = self.walls
        return world

    @classmethod
    def rooms(cls) -> World:
        """Return a house of 14 m by 9 m: a large hall around (0, 0), a kitchen, a bedroom, a study and a bath.

        Doors are 1.1 m wide and open. Tables, chairs, plants and a pillar are the round obstacles.
        """
        outside = [(-7.0, -4.5, 7.0, -4.5), (7.0, -4.5, 7.0, 4.5), (7.0, 4.5, -7.0, 4.5), (-7.0, 4.5, -7.0, -4.5)]
        hall_to_study_and_bath = [(-7.0, 1.2, -5.0, 1.2), (-3.9, 1.2, -0.4, 1.2), (0.7, 1.2, 2.4, 1.2)]
        hall_to_kitchen_and_bedroom = [(2.4, -4.5, 2.4, -2.8), (2.4, -1.7, 2.4, -0.1), (2.4, 1.0, 2.4, 4.5)]
        kitchen_to_bedroom = [(2.4, -0.6, 4.9, -0.6), (6.0, -0.6, 7.0, -0.6)]
        study_to_bath = [(-2.2, 1.2, -2.2, 4.5)]
        return cls(
            walls=outside + hall_to_study_and_bath + hall_to_kitchen_and_bedroom + kitchen_to_bedroom + study_to_bath,
            obstacles=[
                (-3.4, -2.9, 0.60),
                (-2.5, -3.2, 0.22),
                (-4.3, -3.1, 0.22),
                (0.9, -1.6, 0.18),
                (-6.5, 0.7, 0.25),
                (1.9, -4.0, 0.25),
                (4.6, -3.3, 0.50),
                (6.5, -4.0, 0.35),
                (4.4, 2.6, 0.70),
                (6.6, 4.1, 0.25),
                (-4.6, 3.6, 0.45),
                (-6.5, 4.0, 0.30),
                (1.8, 3.9, 0.35),
                (-1.4, 3.7, 0.40),
            ],
        )

    def nearest_points(self, x: float, y: float) -> Floats:
        """Return the nearest point to (x, y) of each wall, then of each obstacle: shape (W + O, 2), metres."""
        start, edge, length_squared = self._edges
        here = np.array((x, y))
        along = np.clip(((here - start) * edge).sum(axis=1) / length_squared, 0.0, 1.0)
        on_walls = start + along[:, None] * edge
        centre, radius = self.obstacles[:, :2], self.obstacles[:, 2:]
        outward = here - centre
        distance = np.hypot(outward[:, :1], outward[:, 1:])
        on_obstacles = centre + outward * (radius / np.maximum(distance, 1e-12))
        return np.concatenate((on_walls, on_obstacles))

    def near(self, x: float, y: float, reach: float) -> World:
        """Return a part of the world with all walls and obstacles within `reach` metres of (x, y), and some more.

        The parts are cached: a map may have thousands of walls, but only a few of them are near.
        """
        if len(self.walls) <= _FEW:
            return self
        key = (floor(x / _SQUARE), floor(y / _SQUARE), reach)
        if key not in self._near:
            middle = ((key[0] + 0.5) * _SQUARE, (key[1] + 0.5) * _SQUARE)
            points = self.nearest_points(*middle)[: len(self.walls)]
            close = np.hypot(*(points - middle).T) <= reach + _SQUARE
            self._near[key] = World(self.walls[close], self.obstacles)
        return self._near[key]

    def clearance(self, x: float, y: float) -> float:
        """Return metres from (x, y) to the nearest wall or obstacle: negative in an obstacle, inf in an empty world."""
        to_points = np.hypot(*(self.nearest_points(x, y)[: len(self.walls)] - (x, y)).T)
        to_obstacles = np.hypot(self.obstacles[:, 0] - x, self.obstacles[:, 1] - y) - self.obstacles[:, 2]
        return float(np.min(np.concatenate((to_points, to_obstacles)), initial=np.inf))

    def has_drop(self, x: float, y: float) -> bool:
        """Return True if the floor is missing at (x, y)."""
        return any(west <= x <= east and south <= y <= north for west, south, east, north in self._drop_edges)

    @cached_property
    def _edges(self) -> tuple[Floats, Floats, Floats]:
        start, edge = self.walls[:, :2], self.walls[:, 2:] - self.walls[:, :2]
        return start, edge, (edge**2).sum(axis=1)


def to_pose(name: str, pose: Sequence[float]) -> tuple[float, float, float]:
    """Return a pose as three floats; TypeError or ValueError unless it is (x, y, yaw)."""
    if len(pose) != 3:
        raise ValueError(f"{name}: expected (x, y, yaw), got {len(pose)} values")
    x, y = (finite(f"{name}.{axis}", value, "m") for axis, value in zip("xy", pose[:2], strict=True))
    return x, y, in_radians(f"{name}.yaw", pose[2])


def _table(name: str, rows: Any, columns: tuple[str, ...]) -> Floats:
    """Return a read-only array of shape (N, number of columns)."""
    expected = f"{name}: expected rows of ({', '.join(columns)}) in metres"
    try:
        table = np.array(rows, dtype=np.float64)
    except TypeError:
        raise TypeError(f"{expected}, got {rows!r}") from None
    except ValueError as error:
        raise ValueError(f"{expected}: {error}") from None
    if table.size == 0:
        table = np.empty((0, len(columns)))
    if table.ndim != 2 or table.shape[1] != len(columns):
        raise ValueError(f"{expected}, got an array of shape {table.shape}")
    if not np.isfinite(table).all():
        raise ValueError(f"{expected}, all finite, got {table[~np.isfinite(table).all(axis=1)][0].tolist()}")
    table.flags.writeable = False
    return table
