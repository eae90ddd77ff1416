"""Ready-made rooms, by name."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

from .world import World

_CORRIDOR = """
    #########################################
    #.......................o...............#
    #.>.....................................#
    #...............o.......................#
    #####..####..######..#######..####......#
    #.......#.......##.......#.......#......#
    #.......#.......##.......#..o....#....o.#
    #.o.....#.....o.##.......#.......#......#
    ##################################......#
                                     #......#
                                     #.o....#
                                     #......#
                                     ########
"""

_OFFICE = """
    ###################################
    #..##......#..##......#..##.......#
    #..##......#..##......#..##.....o.#
    #.......o..#.......o..#...........#
    #..........#..........#...........#
    ####...########...########...######
    #.................................#
    #.>............................o..#
    #.................................#
    #####...#########...#######...#####
    #...........#...........#.........#
    #.....###...#.o.###.....#..o......#
    #.....###...#...###.....#......##.#
    #...........#...........#......##.#
    ###################################
"""

_MAZE_SIZE = (7, 5)
"""Cells across and up."""


def room(name: str, seed: int = 1) -> World:
    """Return a ready-made room.

    ``"house"`` is `World.rooms`. ``"corridor"`` is 20 m long, with a corner and doors to four chambers. ``"office"``
    has six rooms with desks on both sides of an aisle. ``"maze"`` is different for each seed, without loops, with
    passages of 0.9 m.

    Args:
        name: house, corridor, office or maze.
        seed: the seed of the maze, a whole number of 0 or more.

    Raises:
        TypeError: the name is not a text, or the seed is not a whole number.
        ValueError: no room has this name, or the seed is below 0.

    Examples:
        >>> from robowidgets.simulator import Robot
        >>> Robot(room("corridor")).pose
        Pose(x=1.25, y=5.25, yaw=0.0)
    """
    if not isinstance(name, str):
        raise TypeError(f"room: expected a name such as 'maze', or a World, got {name!r}")
    if name not in _ROOMS:
        raise ValueError(f"room: expected {', '.join(_ROOMS)}, got {name!r}")
    if not isinstance(seed, int):
        raise TypeError(f"seed: expected a whole number, got {seed!r}")
    if seed < 0:
        raise ValueError(f"seed: expected 0 or more, got {seed}")
    return _ROOMS[name](seed)


def _house(_seed: int) -> World:
    house = World.rooms()
    return World(house.walls, house.obstacles, (0.2, -0.85, 0.5))


def _maze(seed: int) -> World:
    """Return a maze by a random walk that steps back at dead ends. Floors are 2 by 2 squares, and walls one square."""
    rng = np.random.default_rng(seed)
    (across, up), cell = _MAZE_SIZE, 0.45
    rows = [["#"] * (3 * across + 1) for _ in range(3 * up + 1)]

    def open_floor(left: int, top: int, width: int, height: int) -> None:
        for row in range(top, top + height):
            rows[row][left : left + width] = "." * width

    way, seen = [(0, 0)], {(0, 0)}
    open_floor(1, 1, 2, 2)
    while way:
        x, y = way[-1]
        neighbours = [(x + dx, y + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        free = [(i, j) for i, j in neighbours if 0 <= i < across and 0 <= j < up and (i, j) not in seen]
        if not free:
            way.pop()
            continue
        i, j = free[rng.integers(len(free))]
        open_floor(3 * min(x, i) + 1, 3 * min(y, j) + 1, 2 + 3 * abs(i - x), 2 + 3 * abs(j - y))
        way.append((i, j))
        seen.add((i, j))
    world = World.from_text("\n".join(map("".join, rows)), cell=cell)
    is_open_ahead = rows[1][3] == "."
    return World(world.walls, (), (2 * cell, (3 * up - 1) * cell, 0.0 if is_open_ahead else -pi / 2))


_ROOMS: dict[str, Callable[[int], World]] = {
    "house": _house,
    "corridor": lambda _seed: World.from_text(_CORRIDOR),
    "office": lambda _seed: World.from_text(_OFFICE, cell=0.4),
    "maze": _maze,
}
