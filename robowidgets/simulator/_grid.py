"""Floors of square cells: their walls as a small number of segments, and a start pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin
from textwrap import dedent

import numpy as np
from numpy.typing import NDArray

from ..samples.checks import finite

Cells = NDArray[np.bool_]

_ROOM = 0.4
"""Metres from the start of a robot to the nearest cell that is not free."""

_HEADINGS = {">": 0.0, "^": pi / 2, "<": pi, "v": -pi / 2}
_SHARE = 0.35
"""The radius of a round obstacle over the size of a cell."""


@dataclass(frozen=True)
class Grid:
    """A floor of square cells.

    Args:
        occupied: shape (rows, columns), row 0 at the bottom; True for a wall.
        free: the same shape; True for free floor. A cell may be neither.
        cell: the side of a cell in metres.
        origin: (x, y, yaw) of the bottom left corner.
        obstacles: discs as (x, y, radius) in metres, in the world's frame.
        drops: rectangles without floor, as (x1, y1, x2, y2) in metres, in the world's frame.
        marked: the start pose of the robot in the drawing, or None.
    """

    occupied: Cells
    free: Cells
    cell: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    obstacles: Sequence[tuple[float, float, float]] = ()
    drops: Sequence[tuple[float, float, float, float]] = ()
    marked: tuple[float, float, float] | None = None

    def walls(self) -> NDArray[np.float64]:
        """Return the edges between occupied and free cells, joined along each line: shape (W, 4), metres."""
        occupied, free = (np.pad(cells, 1) for cells in (self.occupied, self.free))
        vertical = _runs(occupied[:, :-1] & free[:, 1:] | free[:, :-1] & occupied[:, 1:])
        horizontal = _runs((occupied[:-1] & free[1:] | free[:-1] & occupied[1:]).T)
        upright = [(line, start, line, stop) for line, start, stop in vertical]
        flat = [(start, line, stop, line) for line, start, stop in horizontal]
        ends = np.array(upright + flat, dtype=np.float64).reshape(-1, 2)
        return self._placed(ends).reshape(-1, 4)

    def start(self) -> tuple[float, float, float]:
        """Return the start pose of a robot: the marked pose, or the roomy place nearest to the middle."""
        if self.marked is not None:
            return self.marked
        roomy = np.pad(self.free, 1)
        for x, y, _ in self.obstacles:
            roomy[int(y / self.cell) + 1, int(x / self.cell) + 1] = False
        for corners in self.drops:
            left, bottom, right, top = (round(edge / self.cell) + 1 for edge in corners)
            roomy[bottom:top, left:right] = False
        for _ in range(round(_ROOM / self.cell)):
            inner = roomy.copy()
            for axis in (0, 1):
                inner &= np.roll(roomy, 1, axis) & np.roll(roomy, -1, axis)
            if not inner.any():
                break
            roomy = inner
        rows, columns = np.nonzero(roomy[1:-1, 1:-1])
        nearest = np.hypot(rows - rows.mean(), columns - columns.mean()).argmin()
        x, y = self._placed(np.array([[columns[nearest] + 0.5, rows[nearest] + 0.5]]))[0]
        return float(x), float(y), 0.0

    def _placed(self, cells: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert places counted in cells, shape (N, 2), to metres in the world's frame."""
        x, y, yaw = self.origin
        turn = np.array(((cos(yaw), sin(yaw)), (-sin(yaw), cos(yaw))))
        return np.asarray(cells * self.cell @ turn + (x, y))


def _runs(edges: Cells) -> list[tuple[int, int, int]]:
    """Return the runs of True along each column: column, first cell and stop, counted without the padding cell."""
    padded = np.pad(edges.T, ((0, 0), (1, 1))).astype(np.int8)
    steps = np.diff(padded, axis=1)
    columns, starts = np.nonzero(steps == 1)
    _, stops = np.nonzero(steps == -1)
    return list(zip(columns.tolist(), (starts - 1).tolist(), (stops - 1).tolist(), strict=True))


def _rectangles(cells: Cells) -> list[tuple[int, int, int, int]]:
    """Return rectangles that cover the cells, (x1, y1, x2, y2) counted in cells: equal runs in consecutive rows."""
    bottoms: dict[tuple[int, int, int], int] = {}
    for row, start, stop in _runs(np.pad(cells.T, 1)):
        bottoms[start, stop, row] = bottoms.pop((start, stop, row - 1), row - 1)
    return [(start, bottom, stop, top) for (start, stop, top), bottom in bottoms.items()]


def grid_of_text(text: str, cell: float) -> Grid:
    """Return the grid of a drawing as in `World.from_text`."""
    if not isinstance(text, str):
        raise TypeError(f"text: expected the lines of a room, such as '####', got {text!r}")
    if finite("cell", cell, "metres") <= 0:
        raise ValueError(f"cell: expected metres above 0, got {cell!r}")
    lines = [line.rstrip() for line in dedent(text.expandtabs()).split("\n")]
    while lines and not lines[-1]:
        lines.pop()
    skipped = next((i for i, line in enumerate(lines) if line), 0)
    drawn = lines[skipped:]
    for number, line in enumerate(lines, 1):
        for column, character in enumerate(line, 1):
            if character not in "# .o=" and character not in _HEADINGS:
                raise ValueError(
                    f"text: expected # for a wall, a space or . for floor, o for an obstacle, = for a drop, or one of "
                    f"> < ^ v for the robot; got {character!r} in line {number}, column {column}"
                )
    width = max(map(len, drawn), default=0)
    cells = np.array([list(line.ljust(width)) for line in reversed(drawn)], dtype="U1").reshape(len(drawn), width)
    marks = np.argwhere(np.isin(cells, list(_HEADINGS)))
    if len(marks) > 1:
        raise ValueError(f"text: expected one robot, as one of > < ^ v; got {len(marks)}")
    obstacles = [
        (float(column + 0.5) * cell, float(row + 0.5) * cell, _SHARE * cell)
        for row, column in np.argwhere(cells == "o")
    ]
    marked = None
    for row, column in marks:
        marked = (float(column + 0.5) * cell, float(row + 0.5) * cell, _HEADINGS[str(cells[row, column])])
    occupied, is_drawn = cells == "#", cells != " "
    inside = np.maximum.accumulate(is_drawn, axis=1) & np.maximum.accumulate(is_drawn[:, ::-1], axis=1)[:, ::-1]
    if not np.isin(cells[inside], [" ", ".", *_HEADINGS]).any():
        raise ValueError(
            "text: expected free floor, as spaces or dots, got none; spaces at the ends of a line are outside"
        )
    drops = [(x1 * cell, y1 * cell, x2 * cell, y2 * cell) for x1, y1, x2, y2 in _rectangles(cells == "=")]
    return Grid(occupied, inside & ~occupied, cell, obstacles=obstacles, drops=drops, marked=marked)
