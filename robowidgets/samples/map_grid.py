"""A map of the floor as a grid of cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .age import HasAge
from .checks import finite, frozen
from .pose import Pose

MOST_CELLS = 100_000_000
UNKNOWN = 255
"""The byte of an unknown cell; its value is -1."""


_CORNER = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class MapGrid(HasAge):
    """A floor in square cells, which are free, occupied or unknown, or have a cost.

    Cell [0, 0] lies at the origin; rows follow y and columns follow x (nav_msgs/OccupancyGrid).

    Args:
        cells: shape (rows, columns), whole numbers from 0 (free) to `most`; 255 or -1 is unknown. Kept as bytes.
        resolution: width of a cell in metres.
        origin: the pose of the outer corner of cell [0, 0] in its frame.
        most: the value of a cell that is surely occupied: 100 for occupancy, 254 for costs.
        stamp_ns: nanoseconds since the epoch, or None.
        frame_id: the coordinate frame of the origin.

    Raises:
        ValueError: the grid has no cells or too many, or its resolution or origin is invalid.

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
        """Return the value of a cell by row and column, or -1 if it is unknown."""
        return int(self.values[index])

    def __repr__(self) -> str:
        rows, columns = self.cells.shape
        return (
            f"<MapGrid {columns} x {rows} cells of {self.resolution:g} m{f' in {self.frame_id}' * bool(self.frame_id)}>"
        )

    @property
    def values(self) -> NDArray[np.int16]:
        """The cells as in messages, shape (rows, columns), with -1 for unknown."""
        if self.most <= 127:
            return self.cells.view(np.int8).astype(np.int16)
        return np.where(self.cells == UNKNOWN, np.int16(-1), self.cells)

    def thinned(self, most: int) -> tuple[MapGrid, int]:
        """Return the grid in at most that many cells, and the number of cells along the side of each new cell.

        A new cell has the greatest value of its cells, so that no obstacle is lost. It is unknown if all of them are.
        """
        rows, columns = self.cells.shape
        step = 1
        while -(-rows // step) * -(-columns // step) > most:
            step += 1
        if step == 1:
            return self, 1
        padded = np.full((-(-rows // step) * step, -(-columns // step) * step), UNKNOWN, np.uint8)
        padded[:rows, :columns] = self.cells
        # Plus one as a byte, unknown becomes 0, the least.
        blocks = (padded + np.uint8(1)).reshape(padded.shape[0] // step, step, padded.shape[1] // step, step)
        cells = blocks.max(axis=(1, 3)) - np.uint8(1)
        return MapGrid(cells, self.resolution * step, self.origin, self.most, self.stamp_ns, self.frame_id), step
