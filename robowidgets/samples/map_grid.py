"""A map of a floor as a grid of cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .age import HasAge
from .checks import finite, frozen
from .pose import Pose

MOST_CELLS = 100_000_000
UNKNOWN = 255
"""The cell of which nothing is known, as a byte; the value is -1."""


_CORNER = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class MapGrid(HasAge):
    """A floor in square cells: which are free, occupied or unknown, or what it costs to drive there.

    Cell [0, 0] lies at the origin; rows lie in the direction of y, columns in that of x (nav_msgs/OccupancyGrid).

    Args:
        cells: shape (rows, columns), whole numbers: 0 free to `most`, 255 or -1 unknown; kept as bytes.
        resolution: metres from cell to cell.
        origin: where the outer corner of cell [0, 0] is, in its frame.
        most: the value of what is surely occupied: 100 for occupancy, 254 for costs.
        stamp_ns: nanoseconds since the epoch, or None.
        frame_id: the coordinate frame of the origin.

    Raises:
        ValueError: it has no cells, too many of them, or a resolution or an origin that cannot be.

    Examples:
        >>> grid = MapGrid(np.array([[0, 100], [255, 0]], np.uint8), 0.05, Pose(-1.0, 0.0, 0.0))
        >>> grid[0, 1], grid[1, 0]
        (100, -1)
    """

    cells: NDArray[np.uint8]
    resolution: float
    origin: Pose = _CORNER
    most: int = 100
    stamp_ns: int | None = None
    frame_id: str = ""

    def __post_init__(self) -> None:
        given = np.asarray(self.cells)
        if not np.issubdtype(given.dtype, np.integer) or (
            given.size and not -1 <= given.min() <= given.max() <= UNKNOWN
        ):
            raise ValueError(f"cells: expected whole numbers from 0 to {self.most}, and 255 or -1 for unknown")
        cells = np.where(given < 0, UNKNOWN, given).astype(np.uint8)
        if cells.ndim != 2 or not 0 < cells.size <= MOST_CELLS:
            raise ValueError(f"cells: expected rows and columns, 1 to {MOST_CELLS:,} cells, got shape {cells.shape}")
        if finite("resolution", self.resolution, "metres") <= 0:
            raise ValueError(f"resolution: expected metres above 0, got {self.resolution!r}")
        x, y, yaw = (finite("origin", value, "metres and radians") for value in self.origin)
        object.__setattr__(self, "cells", frozen(cells))
        object.__setattr__(self, "origin", Pose(x, y, yaw))
        super().__post_init__()

    def __getitem__(self, index: tuple[int, int]) -> int:
        """The value of a cell, by row and column; -1: unknown."""
        return int(self.values[index])

    def __repr__(self) -> str:
        rows, columns = self.cells.shape
        return (
            f"<MapGrid {columns} x {rows} cells of {self.resolution:g} m{f' in {self.frame_id}' * bool(self.frame_id)}>"
        )

    @property
    def values(self) -> NDArray[np.int16]:
        """The cells as messages tell them, shape (rows, columns); -1: unknown."""
        if self.most <= 127:
            return self.cells.view(np.int8).astype(np.int16)
        return np.where(self.cells == UNKNOWN, np.int16(-1), self.cells)

    def thinned(self, most: int) -> tuple[MapGrid, int]:
        """The grid in at most so many cells, and how many cells wide each of them is.

        A cell has the greatest value of those in it, so that no obstacle is lost; it is unknown where all are.
        """
        rows, columns = self.cells.shape
        step = 1
        while -(-rows // step) * -(-columns // step) > most:
            step += 1
        if step == 1:
            return self, 1
        padded = np.full((-(-rows // step) * step, -(-columns // step) * step), UNKNOWN, np.uint8)
        padded[:rows, :columns] = self.cells
        # Plus one, unknown is 0: the least.
        blocks = (padded + np.uint8(1)).reshape(padded.shape[0] // step, step, padded.shape[1] // step, step)
        cells = blocks.max(axis=(1, 3)) - np.uint8(1)
        return MapGrid(cells, self.resolution * step, self.origin, self.most, self.stamp_ns, self.frame_id), step
